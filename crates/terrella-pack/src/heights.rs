//! Heights of a pack: from files to tiles at several levels, the finest only where a file is as fine.
//!
//! | file | what |
//! |---|---|
//! | `files.rs` | the files, one over another |
//! | `budget.rs` | which of them are held, and which are read part by part, within the memory allowed |
//! | `layout.rs` | levels, and which tiles there are |
//! | `samples.rs` | the samples of a tile: from the files, or means of finer tiles |

mod budget;
mod files;
mod layout;
mod samples;
#[cfg(test)]
mod spooled_tests;
#[cfg(test)]
mod tests;

use super::folder::BuildFolder;
use super::plan::Means;
use super::{BuildError, BuildProgress};
use files::HeightFiles;
use rayon::prelude::*;
use samples::TileMaker;
use std::path::PathBuf;
use terrella_ground::elevation::geoid::VerticalDatum;
use terrella_ground::elevation::height_set;
use terrella_imagery::pack::{
    HeightPlace, HeightRecord, HeightValues, HeightsEntry, TileFile, encode_heights, encode_index,
};

pub(super) struct BuiltHeights {
    /// Their entry in the manifest.
    pub entry: HeightsEntry,
    /// Whom to name for them.
    pub attribution: Vec<String>,
}

/// Makes all missing tiles of files, folders and patterns, the finest level first, and their index.
pub(super) fn build(
    paths: &[PathBuf],
    above: Option<VerticalDatum>,
    means: Means,
    folder: &BuildFolder<'_>,
    progress: &dyn BuildProgress,
) -> Result<BuiltHeights, BuildError> {
    let mut all = Vec::new();
    for path in paths {
        all.extend(height_set(path)?);
    }
    let files = HeightFiles::open(&all, above, means, folder, progress)?;
    let mut entry = files.layout()?;
    let levels = layout::tiles(&entry, &files.steps())?;
    folder.take_over_heights(&entry);
    let threads = rayon::ThreadPoolBuilder::new()
        .num_threads(files.threads)
        .thread_name(|n| format!("terrella heights {n}"))
        .build()
        .map_err(|error| BuildError::Threads(error.to_string()))?;
    for (level, places) in levels.iter().enumerate() {
        let what = format!("heights {}/{}", level + 1, levels.len());
        progress.begin(&what, Some(places.len() as u64));
        let maker = TileMaker::new(&files, &entry, folder, files.threads);
        let mut rows = places.chunk_by(|one, next| one.row == next.row);
        let done = rows.try_for_each(|row| {
            threads.install(|| {
                row.par_iter()
                    .try_for_each(|place| make(&maker, *place, progress))
            })?;
            folder.sync()
        });
        progress.end();
        done?;
    }
    let mut records = Vec::new();
    for place in levels.iter().flatten() {
        records.extend(folder.height(*place));
    }
    records.sort_by_key(|record: &HeightRecord| record.place);
    let index = encode_index(&records);
    folder.put_height_index(&index)?;
    entry.tiles = records.len() as u32;
    entry.index = TileFile::of(&index);
    Ok(BuiltHeights {
        entry,
        attribution: files.attribution(),
    })
}

fn make(
    maker: &TileMaker<'_>,
    place: HeightPlace,
    progress: &dyn BuildProgress,
) -> Result<(), BuildError> {
    if progress.cancelled() {
        return Err(BuildError::Cancelled);
    }
    if maker.folder.height(place).is_none() {
        let values = maker.tile(place)?;
        write(maker, place, &values)?;
    }
    progress.step();
    Ok(())
}

/// Writes a tile and records it, with the elevation range of itself and all tiles beneath it.
fn write(
    maker: &TileMaker<'_>,
    place: HeightPlace,
    values: &HeightValues,
) -> Result<(), BuildError> {
    let entry = maker.entry;
    let (mut low_m, mut high_m) = values.range_m(entry.kind).unwrap_or((0.0, 0.0));
    for record in maker.beneath(place) {
        low_m = low_m.min(f64::from(record.low_m));
        high_m = high_m.max(f64::from(record.high_m));
    }
    let path = entry.path(place);
    let bytes = encode_heights(values, entry.row_samples())
        .map_err(|source| BuildError::Write { path, source })?;
    let record = HeightRecord {
        place,
        file: TileFile::of(&bytes),
        low_m: at_most(low_m),
        high_m: -at_most(-high_m),
    };
    maker.folder.put_height(entry, record, &bytes)
}

/// The greatest f32 that is not above a number.
fn at_most(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) > value {
        near.next_down()
    } else {
        near
    }
}
