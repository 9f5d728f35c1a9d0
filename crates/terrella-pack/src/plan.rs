//! How the work on a map is divided so that it fits into the memory allowed.

use super::bands::{band_bytes, row_texels, tile_columns};
use super::error::BuildError;
use super::resample::Resampler;
use super::source::SourceInfo;
use std::ops::Range;
use terrella_imagery::tile::{MapLayer, Storage, TileShape};

/// Memory of the program itself, and of freed blocks that the allocator keeps.
pub(super) const BASE_BYTES: u64 = 48 << 20;

/// Memory for each existing tile: its line of the journal, its name and its file.
const NOTED_BYTES: u64 = 250;

/// How much may be held and by how many.
#[derive(Clone, Copy, Debug)]
pub(super) struct Means {
    /// Most bytes of the process.
    pub memory_bytes: u64,
    /// Most encoder threads, at least 1.
    pub threads: usize,
}

impl Means {
    /// Most bytes that reading may hold beside a row.
    pub(super) fn source_bytes(self) -> u64 {
        self.memory_bytes.saturating_sub(BASE_BYTES) / 2
    }
}

/// How the work on one map is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Plan {
    /// Columns of blocks that a pass over the source makes: 1, 2, 4, 8 or 16.
    pub columns: u32,
    /// Encoder threads.
    pub threads: usize,
    pub band_bytes: u64,
}

impl Plan {
    /// The ranges of columns of which `wanted` is made, from the west.
    pub(super) fn passes(self, wanted: &Range<u32>) -> impl Iterator<Item = Range<u32>> {
        let end = wanted.end;
        wanted
            .clone()
            .step_by(self.columns as usize)
            .map(move |start| start..(start + self.columns).min(end))
    }
}

/// The fewest passes that fit; rather a few passes more than a thread less.
pub(super) fn plan<const C: usize>(
    layer: MapLayer,
    info: &SourceInfo,
    levels: &[TileShape],
    storages: &[Storage],
    means: Means,
) -> Result<Plan, BuildError> {
    let most = means.threads.max(1);
    let few_passes = [16, 8, 4].map(|columns| (columns, most));
    let all = (1..=most)
        .rev()
        .flat_map(|threads| [16, 8, 4, 2, 1].map(|columns| (columns, threads)));
    let mut needed = u64::MAX;
    for (columns, threads) in few_passes.into_iter().chain(all) {
        let fixed = BASE_BYTES
            + noted_bytes(levels, storages)
            + reading_bytes::<C>(info, levels, columns)
            + threads as u64 * encoding_bytes(layer, levels, storages);
        let bands: u64 = levels
            .iter()
            .map(|shape| band_bytes::<C>(*shape, &tile_columns(*shape, &(0..columns))))
            .sum();
        let total = fixed.saturating_add(bands);
        needed = needed.min(total);
        if total <= means.memory_bytes {
            return Ok(Plan {
                columns,
                threads,
                // More than twice the bands would never be used.
                band_bytes: (means.memory_bytes - fixed).min(2 * bands),
            });
        }
    }
    let megabytes = |bytes: u64| bytes.div_ceil(1_000_000);
    Err(BuildError::Memory {
        layer,
        allowed_mb: means.memory_bytes / 1_000_000,
        needed_mb: megabytes(needed),
    })
}

/// Memory for the records of a map's tiles, bytes.
fn noted_bytes(levels: &[TileShape], storages: &[Storage]) -> u64 {
    let tiles = levels
        .iter()
        .map(|shape| u64::from(shape.tile_columns()) * u64::from(shape.tile_rows()));
    tiles.sum::<u64>() * storages.len() as u64 * NOTED_BYTES
}

/// Memory for the source, its rows and the rows of all levels, bytes.
fn reading_bytes<const C: usize>(info: &SourceInfo, levels: &[TileShape], columns: u32) -> u64 {
    // The row as read, as numbers, and a few rows of elevations.
    let rows = info.row_bytes() as u64 + u64::from(info.width) * (4 * C as u64 + 48);
    let of_level = |shape: &TileShape| {
        let texels = row_texels(*shape, &tile_columns(*shape, &(0..columns)));
        let carried = u64::from(shape.side() - shape.pixels) * 2 * (texels * C) as u64;
        Resampler::<C>::bytes(texels) + carried
    };
    info.buffer_bytes + rows + levels.iter().map(of_level).sum::<u64>()
}

/// Bytes that the encoding of one tile holds at most: the tile with its mip levels, its compressed levels and the file.
fn encoding_bytes(layer: MapLayer, levels: &[TileShape], storages: &[Storage]) -> u64 {
    let bytes = |storage| {
        let format = layer.tile_format(storage);
        levels
            .iter()
            .map(|shape| shape.bytes(format) as u64)
            .max()
            .unwrap_or(0)
    };
    let largest = storages
        .iter()
        .map(|storage| bytes(*storage))
        .max()
        .unwrap_or(0);
    bytes(Storage::Plain) + 3 * largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ladder::ladder;
    use crate::source::{FileKind, SampleKind};
    use terrella_ground::globe::COLUMNS;
    use terrella_imagery::tile::MAX_PART_PIXELS;

    fn info(width: u32) -> SourceInfo {
        SourceInfo {
            file: FileKind::Jpeg,
            width,
            height: width / 2,
            channels: 3,
            sample: SampleKind::U8,
            opacity: None,
            buffer_bytes: 4 << 20,
        }
    }

    fn plan_of(asked: &[u32], memory_mb: u64) -> Result<Plan, BuildError> {
        let levels = ladder(MapLayer::Day, asked[0] * 16, Some(asked), MAX_PART_PIXELS)?.levels;
        let means = Means {
            memory_bytes: memory_mb * 1_000_000,
            threads: 2,
        };
        plan::<3>(
            MapLayer::Day,
            &info(asked[0] * 16),
            &levels,
            &Storage::ALL,
            means,
        )
    }

    #[test]
    fn the_paper_s_ladder_takes_one_pass_and_larger_ones_more() {
        let paper = [1350, 675, 450, 270, 135];
        let plan = plan_of(&paper, 512).expect("fits");
        assert_eq!((plan.columns, plan.threads), (16, 2));
        assert_eq!(plan.passes(&(0..COLUMNS)).count(), 1);
        let small = plan_of(&paper, 220).expect("fits");
        assert!(small.columns < 16, "{small:?}");
        let large = plan_of(&[1920, 900, 256], 256).expect("fits");
        assert!(large.columns < 16, "{large:?}");
        let places: Vec<u32> = large.passes(&(0..COLUMNS)).flatten().collect();
        let some: Vec<_> = large.passes(&(8..12)).flatten().collect();
        assert_eq!(some, [8, 9, 10, 11]);
        assert_eq!(places, (0..16).collect::<Vec<_>>());
    }

    /// 86 400 and 345 600 texels round the Earth within the usual memory.
    #[test]
    fn parts_of_blocks_take_more_passes_and_no_more_memory() {
        for (ladder, most_passes) in [
            (&[5400, 2700, 1350, 675, 450, 270, 135][..], 4),
            (&[21_600, 10_800, 5400, 2700, 1350, 675, 450, 270, 135], 16),
        ] {
            let plan = plan_of(ladder, 512).expect("fits");
            assert!(
                plan.threads == 2 && plan.passes(&(0..COLUMNS)).count() <= most_passes,
                "{plan:?}"
            );
            let BuildError::Memory { needed_mb, .. } = plan_of(ladder, 60).expect_err("too little")
            else {
                panic!("another error");
            };
            assert!(needed_mb < 400, "{needed_mb} MB");
        }
    }

    #[test]
    fn too_little_memory_is_reported_with_what_is_needed() {
        let error = plan_of(&[1350, 256], 60).expect_err("too little");
        let BuildError::Memory { needed_mb, .. } = error else {
            panic!("{error}");
        };
        assert!(plan_of(&[1350, 256], needed_mb).is_ok());
        assert!(plan_of(&[1350, 256], needed_mb - 1).is_err());
    }
}
