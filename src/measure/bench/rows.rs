//! One height along one path: frames, their floor, the times of the passes, the counts.

use super::blocks::BlockCounts;
use super::report::BenchRow;
use crate::globe::Meshes;
use crate::gpu::GpuTimer;
use crate::imagery::tile::MAX_LEVELS;
use crate::measure::{EyeHeight, FrameTimer, GroundPath, Quantiles, jank, median};
use crate::play::{PlayError, Progress};
use crate::scene::Scene;
use crate::{EyeView, FrameStats, Sky};
use std::collections::BTreeMap;

/// Frames drawn before the first that counts: caches fill, and drivers compile what they compile late.
const WARM_UP: u32 = 3;
/// Most frames in which the device's own times are taken. They are frames apart from those that are timed as a whole.
const TIMED_PASSES: u32 = 8;

/// What all rows have in common.
pub(super) struct RowMeter<'a> {
    pub scene: &'a Scene,
    pub timer: &'a mut FrameTimer,
    pub gpu_timer: Option<&'a GpuTimer>,
    pub meshes: Meshes,
    pub sky: Sky,
    pub frames: u32,
    pub progress: &'a dyn Progress,
}

/// A row, and what the report as a whole needs of it.
pub(super) struct MeasuredRow {
    pub row: BenchRow,
    /// Median of the bare clear, milliseconds.
    pub clear_ms: f64,
    /// Most tiles that a frame had to do without.
    pub missing_tiles: usize,
}

/// Largest counts so far.
#[derive(Default)]
struct Counts {
    stats: FrameStats,
    blocks: BlockCounts,
}

impl RowMeter<'_> {
    /// Measures a row; `None` where the work is no longer wanted.
    pub fn measure(
        &mut self,
        height: &EyeHeight,
        path: GroundPath,
    ) -> Result<Option<MeasuredRow>, PlayError> {
        let wait = self.scene.output.wait();
        let (mut prepare, mut frame, mut floor) = (Vec::new(), Vec::new(), Vec::new());
        let (mut clear, mut ratios) = (Vec::new(), Vec::new());
        let mut counts = Counts::default();
        let mut missing_tiles = 0;
        let first = self.view(height, path, 0, self.frames);
        for _ in 0..WARM_UP {
            self.timer.wait_for_tiles(&first, &self.sky, wait);
            self.timer.time_frame_and_floor(&first, &self.sky)?;
        }
        for n in 0..self.frames {
            if self.progress.cancelled() {
                return Ok(None);
            }
            let view = self.view(height, path, n, self.frames);
            // Rows are compared as they look once all tiles are there.
            missing_tiles = missing_tiles.max(self.timer.wait_for_tiles(&view, &self.sky, wait));
            let times = self.timer.time_frame_and_floor(&view, &self.sky)?;
            clear.push(self.timer.clear_ms()?);
            prepare.push(times.prepare_ms);
            frame.push(times.frame_ms);
            floor.push(times.floor_ms);
            ratios.push(times.frame_ms / times.floor_ms.max(1e-6));
            counts.add(&times.stats);
            let eye_itrf_m = view.to_itrf().0;
            let drawn = self.meshes.with_cells(times.stats.subdivision);
            let grid = drawn.unwrap_or(self.meshes.grid());
            let blocks = BlockCounts::of(grid, self.scene.earth.visibility, eye_itrf_m);
            counts.blocks = counts.blocks.max(blocks);
        }
        let gpu_ms = self.passes(height, path)?;
        let (stats, blocks) = (&counts.stats, &counts.blocks);
        let frame_ms = quantiles(&frame);
        let used = stats.day_levels.iter().rposition(|blocks| *blocks > 0);
        Ok(Some(MeasuredRow {
            row: BenchRow {
                height_km: height.height_km,
                path,
                blocks_visible: stats.blocks_visible,
                blocks_drawn: stats.blocks_drawn,
                blocks_paper_rule: blocks.paper_rule,
                blocks_exact: blocks.exact,
                blocks_lost: blocks.lost,
                blocks_lost_paper_rule: blocks.lost_paper_rule,
                levels: stats.day_levels[..used.map_or(0, |last| last + 1)].to_vec(),
                triangles: stats.triangles,
                draw_calls: stats.draw_calls,
                uploaded_bytes: stats.uploaded_bytes,
                prepare_ms: quantiles(&prepare),
                gpu_ms,
                frame_ms,
                jank_ms: rounded(jank(&frame)),
                floor_ms: rounded(median(&floor)),
                // More than nothing, as a baseline must be.
                floor_ratio: rounded(median(&ratios)).max(1e-3),
                frames_per_s: rounded(1e3 / median(&frame).max(1e-6)),
                paper_frames_per_s: height.paper_frames_per_s,
            },
            clear_ms: median(&clear),
            missing_tiles,
        }))
    }

    /// Median time of each pass on the device, milliseconds.
    fn passes(
        &mut self,
        height: &EyeHeight,
        path: GroundPath,
    ) -> Result<BTreeMap<String, f64>, PlayError> {
        let mut times: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        let Some(gpu_timer) = self.gpu_timer else {
            return Ok(BTreeMap::new());
        };
        let frames = self.frames.min(TIMED_PASSES);
        for n in 0..frames {
            let view = self.view(height, path, n, frames);
            self.timer
                .wait_for_tiles(&view, &self.sky, self.scene.output.wait());
            for (name, time) in self.timer.time_passes(&view, &self.sky, gpu_timer)? {
                times.entry(name.to_owned()).or_default().push(time);
            }
        }
        let medians = times.into_iter();
        Ok(medians
            .map(|(name, times)| (name, rounded(median(&times))))
            .collect())
    }

    /// The `n`-th of `frames` views, spread evenly over one turn.
    fn view(&self, height: &EyeHeight, path: GroundPath, n: u32, frames: u32) -> EyeView {
        let camera = &self.scene.camera;
        path.view(
            &self.meshes.grid().ellipsoid(),
            height.height_km * 1e3,
            f64::from(n) / f64::from(frames),
            camera.mode,
            camera.fov_deg.to_radians(),
            self.timer.picture().aspect(),
        )
    }
}

impl Counts {
    fn add(&mut self, stats: &FrameStats) {
        let max = &mut self.stats;
        max.blocks_visible = max.blocks_visible.max(stats.blocks_visible);
        max.blocks_drawn = max.blocks_drawn.max(stats.blocks_drawn);
        max.triangles = max.triangles.max(stats.triangles);
        max.draw_calls = max.draw_calls.max(stats.draw_calls);
        max.uploaded_bytes = max.uploaded_bytes.max(stats.uploaded_bytes);
        for level in 0..MAX_LEVELS {
            max.day_levels[level] = max.day_levels[level].max(stats.day_levels[level]);
        }
    }
}

fn quantiles(times: &[f64]) -> Quantiles {
    let exact = Quantiles::of(times);
    Quantiles {
        median: rounded(exact.median),
        p95: rounded(exact.p95),
        p99: rounded(exact.p99),
    }
}

/// To a thousandth, of milliseconds a microsecond: more digits would be noise.
pub(super) fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}
