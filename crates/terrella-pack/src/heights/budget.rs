//! Decides which elevation files are held in memory, and which are read in parts.

use super::layout::MOST_SIDE;
use crate::BuildError;
use crate::plan::{BASE_BYTES, Means};
use std::path::PathBuf;
use terrella_ground::elevation::spool::{SpoolNeeds, look};
use terrella_ground::elevation::{GridLimits, PlacedBounds};

/// Peak memory while a grid is created, relative to its final size: elevations as read, a mask of holes, means.
const MAKING: f64 = 1.85;

/// Size of a window of one file around one tile: 466² samples with their holes, from which the 430² of the tile are computed.
const WINDOW_BYTES: u64 = 4 << 20;

/// Bytes that are kept of tiles for each sample of a file.
const NOTED_BYTES: f64 = 0.004;

/// Finer tiles that are kept for each thread: the 16 that a tile with its border reaches, and some for its neighbours.
pub(super) const KEPT_A_THREAD: usize = 24;

/// Bytes of tiles that so many threads hold at most.
fn working_bytes(threads: usize) -> u64 {
    let side = u64::from(MOST_SIDE) + 2;
    // Kept tiles, one being made and one being decoded, of floats; and its compressed bytes.
    side * side * 4 * threads as u64 * (KEPT_A_THREAD as u64 + 4)
}

/// Memory budget.
pub(super) struct Budget {
    /// Threads that make tiles.
    pub threads: usize,
    allowed: u64,
    /// Memory of everything except held files.
    fixed: u64,
    held: u64,
}

impl Budget {
    /// Examines all files. Memory for reading the largest of them in parts is always reserved.
    pub(super) fn of(paths: &[PathBuf], means: Means) -> Result<Self, BuildError> {
        let mut files = Vec::new();
        for path in paths {
            files.push((path, look(path)?));
        }
        // The largest number of files that may overlap one tile.
        let placed = PlacedBounds::new(files.iter().map(|(_, file)| file.bounds));
        let beside = |file: &SpoolNeeds| {
            let near = placed.near(&file.bounds).into_iter();
            near.filter(|n| file.bounds.overlaps(&files[*n].1.bounds))
                .count() as u64
        };
        let windows = files
            .iter()
            .map(|(_, file)| beside(file))
            .max()
            .unwrap_or(0);
        let of_threads = |threads: usize| {
            BASE_BYTES + working_bytes(threads) + threads as u64 * windows * WINDOW_BYTES
        };
        let fits = |threads: &usize| of_threads(*threads) <= means.memory_bytes / 2;
        let threads = (1..=means.threads.max(1)).rev().find(fits).unwrap_or(1);
        let samples = |file: &SpoolNeeds| f64::from(file.size.0) * f64::from(file.size.1);
        let noted: f64 = files.iter().map(|(_, file)| samples(file)).sum();
        let mut fixed = of_threads(threads) + (NOTED_BYTES * noted) as u64;
        let greediest = files.iter().max_by_key(|(_, file)| file.working_bytes);
        if let Some((path, file)) = greediest {
            fixed += file.working_bytes;
            if fixed > means.memory_bytes {
                return Err(BuildError::HeightsMemory {
                    path: path.to_path_buf(),
                    columns: file.size.0,
                    rows: file.size.1,
                    allowed_mb: means.memory_bytes / 1_000_000,
                    needed_mb: fixed.div_ceil(1_000_000),
                });
            }
        }
        Ok(Self {
            threads,
            allowed: means.memory_bytes,
            fixed,
            held: 0,
        })
    }

    /// Memory available to the next file.
    pub(super) fn limits(&self) -> GridLimits {
        let left = self.allowed.saturating_sub(self.fixed + self.held);
        GridLimits {
            bytes: (left as f64 / (1.0 + MAKING)) as u64,
        }
    }

    /// A file is held.
    pub(super) fn hold(&mut self, bytes: u64) {
        self.held += bytes;
    }
}
