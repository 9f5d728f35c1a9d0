//! Files of heights, one over another.

use super::layout::{MOST_SIDE, levels_for};
use crate::elevation::{
    Bounds, GridError, GridLimits, Ground, HeightFileError, HeightGrid, open_heights,
};
use crate::imagery::build::plan::{BASE_BYTES, Means};
use crate::imagery::build::{BuildError, BuildProgress};
use crate::imagery::pack::{HeightKind, HeightsEntry, TileFile};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Bytes beside each byte that a grid holds while it is made: its heights as they are read, which of them are holes, means.
const MAKING: f64 = 1.85;

/// Bytes that a grid of floats holds for each, its pyramids included, and a little more for odd sizes.
const FLOAT_BYTES: f64 = 8.3;

/// Steps of 16-bit samples that are used: a few are left for rounding.
const STEPS: f64 = 65_500.0;

/// Most that rounding may take from a file that is finer, metres.
const MOST_LOSS_M: f64 = 0.05;

/// Files of heights.
pub(super) struct HeightFiles {
    pub ground: Ground,
    /// Whom to name for them.
    pub attribution: Vec<String>,
    sources: Vec<String>,
}

impl HeightFiles {
    /// Reads all of them. Together they stay within the memory allowed, the making of the last one included.
    pub(super) fn open(
        paths: &[PathBuf],
        means: Means,
        progress: &dyn BuildProgress,
    ) -> Result<Self, BuildError> {
        let fixed = BASE_BYTES + super::samples::working_bytes(means.threads);
        let (mut grids, mut attribution, mut sources) = (Vec::new(), Vec::new(), Vec::new());
        let mut held = 0;
        progress.begin("heights", Some(paths.len() as u64));
        for path in paths {
            if progress.cancelled() {
                progress.end();
                return Err(BuildError::Cancelled);
            }
            let left = means.memory_bytes.saturating_sub(fixed + held);
            let limits = GridLimits {
                bytes: (left as f64 / (1.0 + MAKING)) as u64,
            };
            let too_large = |columns: u32, rows: u32, needed: f64| {
                let needed = fixed + held + (needed * (1.0 + MAKING)) as u64;
                BuildError::HeightsMemory {
                    path: path.clone(),
                    columns,
                    rows,
                    allowed_mb: means.memory_bytes / 1_000_000,
                    needed_mb: needed.div_ceil(1_000_000) + 1,
                }
            };
            let told = |error| match error {
                HeightFileError::Grid {
                    source:
                        GridError::Memory {
                            columns,
                            rows,
                            needed_mb,
                            ..
                        },
                    ..
                } => too_large(columns, rows, needed_mb as f64 * 1e6),
                other => BuildError::Heights(other),
            };
            let file = open_heights(path, &limits).map_err(told)?;
            let (stats, (columns, rows)) = (file.grid.stats(), file.grid.size());
            // Rounded so as to fit: no reason to lose any of them.
            if stats.quantum_m > 0.0 && stats.quantum_m != 1.0 {
                let samples = f64::from(columns) * f64::from(rows);
                return Err(too_large(columns, rows, samples * FLOAT_BYTES));
            }
            held += stats.bytes;
            attribution.extend(file.attribution.filter(|line| !attribution.contains(line)));
            sources.push(source_text(path, columns, rows));
            grids.push(Arc::new(file.grid));
            progress.step();
        }
        progress.end();
        Ok(Self {
            ground: Ground::new(grids),
            attribution,
            sources,
        })
    }

    /// What each file covers, and the angle between its samples along a meridian or a parallel, whichever is less, radians.
    pub(super) fn steps(&self) -> Vec<(Bounds, f64)> {
        let grids = self.ground.grids().iter();
        grids.map(|grid| (grid.bounds(), step_rad(grid))).collect()
    }

    /// Levels fine enough for the finest file, and how samples are kept. Index and number of tiles are not known yet.
    pub(super) fn layout(&self) -> Result<HeightsEntry, BuildError> {
        let steps = self.steps();
        let finest = steps.iter().map(|(_, step)| *step).fold(TAU, f64::min);
        let (levels, side) = levels_for(finest).ok_or_else(|| BuildError::Option {
            option: "--heights",
            cause: format!(
                "samples {:.1e}° apart are finer than a pack of heights can be, 2^30 round the Earth in tiles of {MOST_SIDE}; make them coarser",
                finest.to_degrees()
            ),
        })?;
        Ok(HeightsEntry {
            // As many as a manifest may name.
            sources: self.sources.iter().take(64).cloned().collect(),
            levels,
            columns: 16,
            side,
            border: 1,
            kind: self.kind(),
            tiles: 0,
            index: TileFile {
                bytes: 0,
                checksum: [0; 16],
            },
        })
    }

    /// Steps of 16 bits where they lose nothing that a file holds but 5 cm, else floats.
    fn kind(&self) -> HeightKind {
        let stats: Vec<_> = self
            .ground
            .grids()
            .iter()
            .map(|grid| grid.stats())
            .collect();
        // Beneath all lies the sea.
        let low_m = stats.iter().map(|s| s.range.low_m).fold(0.0, f64::min);
        let high_m = stats.iter().map(|s| s.range.high_m).fold(0.0, f64::max);
        // Parts of a metre, so that whole metres come through as they are; a metre more for an offset of whole metres.
        let parts = (STEPS / (high_m - low_m + 1.0)).floor().clamp(1.0, 1000.0);
        let scale_m = 1.0 / parts;
        let is_kept = |quantum_m: f64| 0.5 * scale_m <= MOST_LOSS_M || quantum_m >= scale_m;
        if stats.iter().all(|s| is_kept(s.quantum_m)) {
            HeightKind::I16 {
                offset_m: (0.5 * (low_m + high_m)).round(),
                scale_m,
            }
        } else {
            HeightKind::F32
        }
    }
}

fn step_rad(grid: &HeightGrid) -> f64 {
    let (columns, rows) = grid.size();
    let bounds = grid.sample_bounds();
    let step = |width_rad: f64, samples: u32| match samples {
        0 | 1 => f64::INFINITY,
        samples => width_rad / f64::from(samples - 1),
    };
    let along = step(bounds.width_rad, columns);
    let step_rad = along.min(step(bounds.north_rad - bounds.south_rad, rows));
    // A file of one height has no more detail than its edge.
    step_rad.max(if grid.is_flat() {
        grid.detail_rad()
    } else {
        0.0
    })
}

/// Name and size, in characters that a manifest can hold.
fn source_text(path: &Path, columns: u32, rows: u32) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name: String = name
        .chars()
        .map(|c| if c.is_control() { '?' } else { c })
        .take(500)
        .collect();
    format!("{name}, {columns} x {rows}")
}
