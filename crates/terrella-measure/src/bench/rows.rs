//! One height along one path: frames, their floor, the times of the passes, the counts.

use super::blocks::BlockCounts;
use super::report::{BenchRow, RowTimes, ratios, spread};
use crate::{EyeHeight, FrameTimer, GroundPath, Quantiles, jank, median};
use std::collections::BTreeMap;
use terrella::internals::gpu::GpuTimer;
use terrella::{EyeView, FrameStats, Sky};
use terrella_ground::globe::Meshes;
use terrella_imagery::tile::MAX_LEVELS;
use terrella_play::scene::Scene;
use terrella_play::{PlayError, Progress};

/// Frames drawn before the first that counts: caches fill, and drivers compile what they compile late.
const WARM_UP: u32 = 3;
/// Most frames in which the device's own times are taken. They are frames apart from those that are timed as a whole.
const TIMED_PASSES: u32 = 8;

/// State common to all rows.
pub(super) struct RowMeter<'a> {
    pub scene: &'a Scene,
    pub timer: &'a mut FrameTimer,
    pub gpu_timer: Option<&'a GpuTimer>,
    pub meshes: Meshes,
    pub sky: Sky,
    pub frames: u32,
    pub progress: &'a dyn Progress,
}

/// A row that is measured, run after run.
pub(super) struct RowRuns {
    height: EyeHeight,
    path: GroundPath,
    counts: Counts,
    passes: BTreeMap<String, Vec<f64>>,
    runs: Vec<RowTimes>,
    /// Largest number of tiles missing from a frame.
    pub missing_tiles: usize,
}

/// Largest counts so far.
#[derive(Default)]
struct Counts {
    stats: FrameStats,
    blocks: BlockCounts,
}

impl RowRuns {
    /// A row without any run.
    pub fn new(height: &EyeHeight, path: GroundPath) -> Self {
        Self {
            height: *height,
            path,
            counts: Counts::default(),
            passes: BTreeMap::new(),
            runs: Vec::new(),
            missing_tiles: 0,
        }
    }

    /// The last run in a line, for people who wait.
    pub fn progress(&self) -> String {
        let (frame, ratio) = match self.runs.last() {
            Some(run) => (
                median(&run.frame_ms),
                median(&ratios(&run.frame_ms, &run.floor_ms)),
            ),
            None => (0.0, 0.0),
        };
        let (height_km, path) = (self.height.height_km, self.path.name());
        format!("{height_km} km, {path}: {frame:.2} ms, {ratio:.2} x its floor")
    }

    /// The row of all runs; `None` if none was completed.
    pub fn row(self) -> Option<BenchRow> {
        if self.runs.is_empty() {
            return None;
        }
        let all = |of: fn(&RowTimes) -> &Vec<f64>| -> Vec<f64> {
            self.runs.iter().flat_map(of).copied().collect()
        };
        let frame = all(|run| &run.frame_ms);
        let floor = all(|run| &run.floor_ms);
        let by_run = self.runs.iter();
        let by_run: Vec<_> = by_run
            .map(|run| ratios(&run.frame_ms, &run.floor_ms))
            .collect();
        let ratio = median(&by_run.concat());
        let (stats, blocks) = (&self.counts.stats, &self.counts.blocks);
        let used = stats.day_levels.iter().rposition(|blocks| *blocks > 0);
        let passes = self.passes.into_iter();
        Some(BenchRow {
            height_km: self.height.height_km,
            path: self.path,
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
            prepare_ms: quantiles(&all(|run| &run.prepare_ms)),
            gpu_ms: passes
                .map(|(name, times)| (name, rounded(median(&times))))
                .collect(),
            frame_ms: quantiles(&frame),
            jank_ms: rounded(jank(&frame)),
            floor_ms: rounded(median(&floor)),
            clear_ms: rounded(median(&all(|run| &run.clear_ms))),
            // More than nothing, as a baseline must be.
            floor_ratio: rounded(ratio).max(1e-3),
            floor_ratio_spread: spread(&by_run, ratio).map(rounded),
            frames_per_s: rounded(1e3 / median(&frame).max(1e-6)),
            paper_frames_per_s: self.height.paper_frames_per_s,
            runs: self.runs,
        })
    }
}

impl RowMeter<'_> {
    /// Measures one more run of a row; `false` where the work is no longer wanted, and the run is left out.
    pub fn measure(&mut self, row: &mut RowRuns) -> Result<bool, PlayError> {
        let wait = self.scene.output.wait();
        let mut times = RowTimes::default();
        let first = self.view(row, 0, self.frames);
        for _ in 0..WARM_UP {
            self.timer.wait_for_tiles(&first, &self.sky, wait);
            self.timer.time_frame_and_floor(&first, &self.sky)?;
        }
        for n in 0..self.frames {
            if self.progress.cancelled() {
                return Ok(false);
            }
            let view = self.view(row, n, self.frames);
            // Rows are compared as they look once all tiles are there.
            let missing = self.timer.wait_for_tiles(&view, &self.sky, wait);
            row.missing_tiles = row.missing_tiles.max(missing);
            let measured = self.timer.time_frame_and_floor(&view, &self.sky)?;
            times.clear_ms.push(precise(self.timer.clear_ms()?));
            times.prepare_ms.push(precise(measured.prepare_ms));
            times.frame_ms.push(precise(measured.frame_ms));
            times.floor_ms.push(precise(measured.floor_ms));
            row.counts.add(&measured.stats);
            let eye_itrf_m = view.to_itrf().0;
            let drawn = self.meshes.with_cells(measured.stats.subdivision);
            let grid = drawn.unwrap_or(self.meshes.grid());
            let blocks = BlockCounts::of(grid, self.scene.earth.visibility, eye_itrf_m);
            row.counts.blocks = row.counts.blocks.max(blocks);
        }
        self.time_passes(row)?;
        row.runs.push(times);
        Ok(true)
    }

    /// Times each pass on the device, in frames apart from those that are timed as a whole.
    fn time_passes(&mut self, row: &mut RowRuns) -> Result<(), PlayError> {
        let Some(gpu_timer) = self.gpu_timer else {
            return Ok(());
        };
        let frames = self.frames.min(TIMED_PASSES);
        for n in 0..frames {
            let view = self.view(row, n, frames);
            self.timer
                .wait_for_tiles(&view, &self.sky, self.scene.output.wait());
            for (name, time) in self.timer.time_passes(&view, &self.sky, gpu_timer)? {
                row.passes.entry(name.to_owned()).or_default().push(time);
            }
        }
        Ok(())
    }

    /// The `n`-th of `frames` views, spread evenly over one turn.
    fn view(&self, row: &RowRuns, n: u32, frames: u32) -> EyeView {
        let camera = &self.scene.camera;
        row.path.view(
            &self.meshes.grid().ellipsoid(),
            row.height.height_km * 1e3,
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
        p95: exact.p95.map(rounded),
        p99: exact.p99.map(rounded),
    }
}

/// Single times, to a tenth of a microsecond.
pub(super) fn precise(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

/// To a thousandth, of milliseconds a microsecond: more digits would be noise.
pub(super) fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}
