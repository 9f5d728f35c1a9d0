//! Which levels a map gets, and how its work is divided so that it fits into the memory allowed.

use super::bands::{band_bytes, row_texels};
use super::error::BuildError;
use super::resample::Resampler;
use super::source::SourceInfo;
use crate::globe::COLUMNS;
use crate::imagery::tile::{
    MAX_COARSEST_PIXELS, MAX_LEVELS, MAX_PIXELS, MIN_PIXELS, MapLayer, Storage, TileShape,
};
use std::ops::Range;

/// What the program itself takes, and what the allocator keeps of what was given back.
const BASE_BYTES: u64 = 48 << 20;

/// Levels of a map and those of the usual ladder that are left out.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Ladder {
    /// The finest first.
    pub levels: Vec<TileShape>,
    pub left_out: Vec<u32>,
}

/// The levels for a map of this width: those asked for, or the paper's up to the first that holds all its detail.
pub(super) fn ladder(
    layer: MapLayer,
    source_width: u32,
    asked: Option<&[u32]>,
) -> Result<Ladder, BuildError> {
    if let Some(pixels) = asked {
        return Ok(Ladder {
            levels: check_pixels(layer, pixels)?,
            left_out: Vec::new(),
        });
    }
    let paper = layer.paper_pixels();
    let finest = paper
        .iter()
        .rposition(|pixels| pixels * COLUMNS >= source_width)
        .unwrap_or(0);
    Ok(Ladder {
        levels: check_pixels(layer, &paper[finest..])?,
        left_out: paper[..finest].to_vec(),
    })
}

fn check_pixels(layer: MapLayer, pixels: &[u32]) -> Result<Vec<TileShape>, BuildError> {
    let refuse = |cause: String| {
        let words: Vec<_> = pixels.iter().map(u32::to_string).collect();
        Err(BuildError::Pixels {
            layer,
            pixels: words.join(","),
            cause,
        })
    };
    if pixels.is_empty() || pixels.len() > MAX_LEVELS {
        return refuse(format!("give 1 to {MAX_LEVELS} levels"));
    }
    let mut shapes = Vec::new();
    for pixels in pixels {
        match TileShape::new(*pixels) {
            Some(shape) => shapes.push(shape),
            None => {
                return refuse(format!(
                    "a level has {MIN_PIXELS} to {MAX_PIXELS} pixels per block"
                ));
            }
        }
    }
    if pixels.windows(2).any(|pair| pair[0] <= pair[1]) {
        return refuse("levels must fall, the finest first".to_string());
    }
    if pixels
        .last()
        .is_some_and(|last| *last > MAX_COARSEST_PIXELS)
    {
        return refuse(format!(
            "the coarsest level is always held and may have at most {MAX_COARSEST_PIXELS} pixels per block: add one"
        ));
    }
    Ok(shapes)
}

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
    /// Bytes for bands.
    pub band_bytes: u64,
}

impl Plan {
    /// The ranges of columns, from the west.
    pub(super) fn passes(self) -> impl Iterator<Item = Range<u32>> {
        (0..COLUMNS)
            .step_by(self.columns as usize)
            .map(move |start| start..start + self.columns)
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
            + reading_bytes::<C>(info, levels, columns)
            + threads as u64 * encoding_bytes(layer, levels, storages);
        let bands: u64 = levels
            .iter()
            .map(|shape| band_bytes::<C>(*shape, &(0..columns)))
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

/// Bytes for the source, its rows and the rows of all levels.
fn reading_bytes<const C: usize>(info: &SourceInfo, levels: &[TileShape], columns: u32) -> u64 {
    // The row as it is read, as numbers, and a few rows of heights.
    let rows = info.row_bytes() as u64 + u64::from(info.width) * (4 * C as u64 + 48);
    let of_level = |shape: &TileShape| {
        let texels = row_texels(*shape, &(0..columns));
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
    use crate::imagery::build::source::{FileKind, SampleKind};

    fn pixels(shapes: &[TileShape]) -> Vec<u32> {
        shapes.iter().map(|shape| shape.pixels).collect()
    }

    #[test]
    fn the_ladder_ends_at_the_first_level_that_holds_the_source() {
        let of = |width| {
            let ladder = ladder(MapLayer::Day, width, None).expect("good");
            (pixels(&ladder.levels), ladder.left_out)
        };
        assert_eq!(of(21_600), (vec![1350, 675, 450, 270, 135], vec![]));
        assert_eq!(of(86_400), (vec![1350, 675, 450, 270, 135], vec![]));
        assert_eq!(of(10_800), (vec![675, 450, 270, 135], vec![1350]));
        assert_eq!(of(5_400), (vec![450, 270, 135], vec![1350, 675]));
        assert_eq!(of(64), (vec![135], vec![1350, 675, 450, 270]));
    }

    #[test]
    fn bad_ladders_are_refused_with_what_is_allowed() {
        for (asked, word) in [
            (&[][..], "1 to 8"),
            (&[2000; 9][..], "1 to 8"),
            (&[9000, 100][..], "8184"),
            (&[300, 100, 15][..], "16 to"),
            (&[100, 100][..], "fall"),
            (&[100, 200][..], "fall"),
            (&[1350, 257][..], "256"),
        ] {
            let error = ladder(MapLayer::Clouds, 100, Some(asked)).expect_err("bad");
            assert!(error.to_string().contains(word), "{error}");
            assert!(error.to_string().contains("--pixels clouds="), "{error}");
        }
        let good = ladder(MapLayer::Day, 64, Some(&[5400, 256])).expect("good");
        assert_eq!(pixels(&good.levels), [5400, 256]);
    }

    fn info(width: u32) -> SourceInfo {
        SourceInfo {
            file: FileKind::Jpeg,
            width,
            height: width / 2,
            channels: 3,
            sample: SampleKind::U8,
            buffer_bytes: 4 << 20,
        }
    }

    fn plan_of(asked: &[u32], memory_mb: u64) -> Result<Plan, BuildError> {
        let levels = ladder(MapLayer::Day, 16, Some(asked))?.levels;
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
        assert_eq!(plan.passes().count(), 1);
        let small = plan_of(&paper, 220).expect("fits");
        assert!(small.columns < 16, "{small:?}");
        let large = plan_of(&[5400, 1350, 256], 1024).expect("fits");
        assert!(large.columns < 16, "{large:?}");
        let places: Vec<u32> = large.passes().flatten().collect();
        assert_eq!(places, (0..16).collect::<Vec<_>>());
    }

    #[test]
    fn too_little_memory_is_told_with_what_is_needed() {
        let error = plan_of(&[1350, 256], 60).expect_err("too little");
        let BuildError::Memory { needed_mb, .. } = error else {
            panic!("{error}");
        };
        assert!(plan_of(&[1350, 256], needed_mb).is_ok());
        assert!(plan_of(&[1350, 256], needed_mb - 1).is_err());
    }
}
