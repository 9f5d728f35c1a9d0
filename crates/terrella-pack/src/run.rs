//! One map, from its file to its tiles: a thread reads and resamples, a pool of threads encodes and writes.

use super::bands::{Band, Bands, first_texel, polar_rows, row_texels, tile_columns};
use super::bc;
use super::cut::cut;
use super::error::BuildError;
use super::folder::BuildFolder;
use super::input::MapInput;
use super::memory::Pool;
use super::plan::Plan;
use super::resample::{Resampler, Sizes};
use super::tile_name::TileName;
use super::values::{Meaning, ValueRows};
use super::{BuildProgress, source};
use rayon::Scope;
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use terrella_imagery::pack::write_ktx2;
use terrella_imagery::tile::{MapLayer, Storage, TileShape};

/// One map and its outputs.
pub(super) struct Job<'a> {
    pub layer: MapLayer,
    pub path: &'a Path,
    pub input: &'a MapInput,
    pub meaning: Meaning,
    pub info: source::SourceInfo,
    pub limits: source::SourceLimits,
    /// The finest first.
    pub levels: &'a [TileShape],
    pub storages: &'a [Storage],
    pub plan: Plan,
    /// The columns of blocks that are made.
    pub columns: Range<u32>,
    pub folder: &'a BuildFolder<'a>,
    pub progress: &'a dyn BuildProgress,
}

/// The first thing that went wrong in any thread.
#[derive(Default)]
struct Failure(Mutex<Option<BuildError>>);

impl Failure {
    fn set(&self, error: BuildError) {
        let mut first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert(error);
    }
}

/// Result of a pass.
struct PassDone {
    /// Slopes beyond what can be stored.
    saturated_texels: u64,
    /// Remarks about omitted parts of the map.
    notes: Vec<String>,
}

/// State that the threads of a pass share.
struct SharedRun<'a> {
    job: &'a Job<'a>,
    pool: Pool,
    failure: Failure,
}

impl SharedRun<'_> {
    fn fail(&self, error: BuildError) {
        self.failure.set(error);
        self.pool.stop();
    }
}

impl Job<'_> {
    /// Makes all tiles that are not there yet. Gives the number of slopes beyond what can be stored.
    pub(super) fn run<const C: usize>(&self) -> Result<u64, BuildError> {
        let passes: Vec<Range<u32>> = self.plan.passes(&self.columns).collect();
        let threads = rayon::ThreadPoolBuilder::new()
            .num_threads(self.plan.threads)
            .thread_name(|n| format!("terrella encode {n}"))
            .build()
            .map_err(|error| BuildError::Threads(error.to_string()))?;
        let (mut saturated_texels, mut reported) = (0, BTreeSet::new());
        for (n, columns) in passes.iter().enumerate() {
            let levels = self.missing_levels(columns);
            if levels.is_empty() {
                continue;
            }
            let what = if passes.len() == 1 {
                self.layer.name().to_string()
            } else {
                format!("{} {}/{}", self.layer.name(), n + 1, passes.len())
            };
            self.progress
                .begin(&what, Some(u64::from(self.info.height)));
            let done = self.pass::<C>(&threads, columns, &levels);
            self.progress.end();
            let done = done?;
            saturated_texels = done.saturated_texels;
            for note in done.notes {
                // Every pass finds the same.
                if reported.insert(note.clone()) {
                    self.progress.note(&note);
                }
            }
        }
        Ok(saturated_texels)
    }

    /// How many tiles are not there yet.
    pub(super) fn missing_tiles(&self) -> u64 {
        let storages = |shape: &TileShape, row, column| {
            self.missing_storages(*shape, row, column).len() as u64
        };
        let of_level = |shape: &TileShape| -> u64 {
            (0..shape.tile_rows())
                .flat_map(|row| {
                    tile_columns(*shape, &self.columns).map(move |column| (row, column))
                })
                .map(|(row, column)| storages(shape, row, column))
                .sum()
        };
        self.levels.iter().map(of_level).sum()
    }

    /// Levels of which a tile in these columns is missing.
    fn missing_levels(&self, columns: &Range<u32>) -> Vec<TileShape> {
        let is_missing = |shape: &&TileShape| {
            (0..shape.tile_rows()).any(|row| {
                tile_columns(**shape, columns)
                    .any(|column| !self.missing_storages(**shape, row, column).is_empty())
            })
        };
        self.levels.iter().filter(is_missing).copied().collect()
    }

    fn name(&self, storage: Storage, shape: TileShape, row: u32, column: u32) -> TileName {
        TileName::new(storage, self.layer, shape, row, column)
    }

    fn missing_storages(&self, shape: TileShape, row: u32, column: u32) -> Vec<Storage> {
        let is_missing =
            |storage: &&Storage| !self.folder.has(self.name(**storage, shape, row, column));
        self.storages.iter().filter(is_missing).copied().collect()
    }

    /// Reads the whole source for some columns.
    fn pass<const C: usize>(
        &self,
        threads: &rayon::ThreadPool,
        columns: &Range<u32>,
        levels: &[TileShape],
    ) -> Result<PassDone, BuildError> {
        let shared = SharedRun {
            job: self,
            pool: Pool::new(self.plan.band_bytes),
            failure: Failure::default(),
        };
        // The calling thread reads; what it spawns runs in the pool and is over when the scope ends.
        let read = threads.in_place_scope(|scope| {
            let read = self.read::<C>(&shared, scope, columns, levels);
            if read.is_err() {
                shared.pool.stop();
            }
            read
        });
        let failure = shared
            .failure
            .0
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner);
        match failure {
            Some(error) => Err(error),
            None => read,
        }
    }

    fn read<'s, const C: usize>(
        &'s self,
        shared: &'s SharedRun<'s>,
        scope: &Scope<'s>,
        columns: &Range<u32>,
        levels: &[TileShape],
    ) -> Result<PassDone, BuildError> {
        let opened = self.input.rows(self.limits)?;
        if opened.info() != self.info {
            return Err(
                source::FileContext::new(self.path).damaged("it has changed while it was read")
            );
        }
        let mut rows = ValueRows::new(opened, self.meaning, self.path)?;
        let (width, height) = (self.info.width, self.info.height);
        let mut work = Vec::with_capacity(levels.len());
        for shape in levels {
            let sizes = Sizes {
                source: (width, height),
                level: (shape.map_width(), shape.map_height()),
            };
            let columns = tile_columns(*shape, columns);
            let resampler = Resampler::<C>::new(
                sizes,
                first_texel(*shape, &columns),
                row_texels(*shape, &columns),
                polar_rows(*shape),
            );
            let bands = Bands::<C>::new(*shape, columns, &shared.pool);
            work.push((resampler, bands.ok_or(BuildError::Cancelled)?));
        }
        let mut give = |band: Band| encode_band::<C>(shared, scope, band);
        let mut row = vec![0.0; width as usize * C];
        for y in 0..height {
            if self.progress.cancelled() || shared.pool.is_stopped() {
                return Err(BuildError::Cancelled);
            }
            rows.next_row(&mut row)?;
            for (resampler, bands) in &mut work {
                resampler.push(y, &row, &mut |lane, y, values: &[f32]| {
                    let goes_on = bands.put(lane, y, values, &mut give);
                    goes_on.then_some(()).ok_or(BuildError::Cancelled)
                })?;
            }
            self.progress.step();
        }
        for (_, bands) in work {
            bands.finish(&mut give);
        }
        Ok(PassDone {
            saturated_texels: rows.saturated_texels(),
            notes: rows.notes(),
        })
    }
}

/// Starts the encoding of a band's tiles, and notes durably when all are written.
fn encode_band<'s, const C: usize>(shared: &'s SharedRun<'s>, scope: &Scope<'s>, band: Band) {
    let tiles: Vec<_> = band
        .columns
        .clone()
        .map(|column| {
            (
                column,
                shared
                    .job
                    .missing_storages(band.shape, band.tile_row, column),
            )
        })
        .filter(|(_, storages)| !storages.is_empty())
        .collect();
    let left = Arc::new(AtomicU32::new(tiles.len() as u32));
    let band = Arc::new(band);
    for (column, storages) in tiles {
        let (band, left) = (Arc::clone(&band), Arc::clone(&left));
        scope.spawn(move |_| {
            if shared.pool.is_stopped() {
                return;
            }
            let done = encode_tile::<C>(shared.job, &band, column, &storages).and_then(|()| {
                let is_last = left.fetch_sub(1, Ordering::AcqRel) == 1;
                if is_last {
                    shared.job.folder.sync()
                } else {
                    Ok(())
                }
            });
            if let Err(error) = done {
                shared.fail(error);
            }
        });
    }
}

fn encode_tile<const C: usize>(
    job: &Job<'_>,
    band: &Band,
    column: u32,
    storages: &[Storage],
) -> Result<(), BuildError> {
    let plain = cut::<C>(band, job.layer, column);
    for storage in storages {
        let file = match storage {
            Storage::Plain => write_ktx2(&plain),
            Storage::Bc => write_ktx2(&bc::compress(&plain, job.layer)),
        };
        job.folder
            .put(job.name(*storage, band.shape, band.tile_row, column), &file)?;
    }
    Ok(())
}
