//! Which levels a map gets.

use super::error::BuildError;
use std::fmt;
use terrella_ground::globe::COLUMNS;
use terrella_imagery::tile::{
    MAX_COARSEST_PIXELS, MAX_LEVELS, MAX_PART_PIXELS, MAX_PARTS, MIN_PIXELS, MapLayer, TileShape,
};

/// Levels of a map, and the default levels that are left out.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Ladder {
    /// The finest first.
    pub levels: Vec<TileShape>,
    pub left_out: Vec<u32>,
    /// Detail of the map that no level holds.
    pub dropped: Option<Dropped>,
}

/// A map that is finer than its finest level by more than a tenth.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Dropped {
    layer: MapLayer,
    /// Width of the map in texels, and that of its finest level.
    source_width: u32,
    finest_width: u32,
    /// Levels that hold more, if there can be any.
    finer: Option<Vec<u32>>,
}

impl fmt::Display for Dropped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            layer,
            source_width,
            finest_width,
            finer,
        } = self;
        let name = layer.name();
        write!(
            f,
            "has {source_width} texels round the Earth and the finest {name} level {finest_width}; finer detail is averaged, "
        )?;
        match finer {
            Some(finer) => {
                let words: Vec<_> = finer.iter().map(u32::to_string).collect();
                let width = finer.first().map_or(0, |pixels| pixels * COLUMNS);
                write!(f, "--pixels {name}={} keeps {width}", words.join(","))
            }
            None => write!(f, "no pack holds more of it"),
        }
    }
}

/// Whether the map fills a level of this width sufficiently: at most a tenth may be without detail.
fn is_filled(level_width: u64, source_width: u32) -> bool {
    10 * level_width <= 11 * u64::from(source_width)
}

/// The levels for a map of this width: the requested ones; by default the paper's up to the first that holds all its detail, and for a finer map
/// also those that are cut into 2, 4, 8 and 16 parts, as far as the map fills them.
///
/// Levels of more than `most_pixels` texels per block are cut into parts: [`MAX_PART_PIXELS`], fewer in tests.
pub(super) fn ladder(
    layer: MapLayer,
    source_width: u32,
    asked: Option<&[u32]>,
    most_pixels: u32,
) -> Result<Ladder, BuildError> {
    let (levels, left_out) = match asked {
        Some(pixels) => (check_pixels(layer, pixels, most_pixels)?, Vec::new()),
        None => usual(layer, source_width)?,
    };
    let dropped = dropped(layer, source_width, &levels, most_pixels);
    Ok(Ladder {
        levels,
        left_out,
        dropped,
    })
}

fn usual(layer: MapLayer, source_width: u32) -> Result<(Vec<TileShape>, Vec<u32>), BuildError> {
    let paper = layer.paper_pixels();
    let finest = paper
        .iter()
        .rposition(|pixels| pixels * COLUMNS >= source_width)
        .unwrap_or(0);
    let cut = (1..=MAX_PARTS.ilog2()).rev();
    let mut levels: Vec<TileShape> = cut
        .filter_map(|power| TileShape::cut(paper[0], 1 << power))
        .filter(|shape| is_filled(u64::from(shape.map_width()), source_width))
        .collect();
    levels.extend(check_pixels(layer, &paper[finest..], MAX_PART_PIXELS)?);
    Ok((levels, paper[..finest].to_vec()))
}

/// Detail of a map that these levels lose, and the next levels that would keep it.
fn dropped(
    layer: MapLayer,
    source_width: u32,
    levels: &[TileShape],
    most_pixels: u32,
) -> Option<Dropped> {
    let finest = levels.first()?;
    // By more than a tenth.
    if 10 * u64::from(source_width) <= 11 * u64::from(finest.map_width()) {
        return None;
    }
    // Of tiles that may be cut.
    let base = levels
        .iter()
        .find(|shape| shape.parts == 1 && shape.pixels <= most_pixels)?;
    let finer = (1..=MAX_PARTS.ilog2())
        .filter_map(|power| TileShape::cut(base.pixels, 1 << power))
        .filter(|shape| shape.block_pixels() > finest.block_pixels());
    // Up to the first that holds all.
    let mut kept = Vec::new();
    for shape in finer {
        kept.push(shape.block_pixels());
        if shape.map_width() >= source_width {
            break;
        }
    }
    kept.reverse();
    kept.extend(levels.iter().map(|shape| shape.block_pixels()));
    let may_be = kept.len() > levels.len() && check_pixels(layer, &kept, most_pixels).is_ok();
    Some(Dropped {
        layer,
        source_width,
        finest_width: finest.map_width(),
        finer: may_be.then_some(kept),
    })
}

/// Levels of so many texels a block: those that no part can have are cut into parts of the finest other one.
fn check_pixels(
    layer: MapLayer,
    pixels: &[u32],
    most_pixels: u32,
) -> Result<Vec<TileShape>, BuildError> {
    let reject = |cause: String| {
        let words: Vec<_> = pixels.iter().map(u32::to_string).collect();
        Err(BuildError::Pixels {
            layer,
            pixels: words.join(","),
            cause,
        })
    };
    if pixels.is_empty() || pixels.len() > MAX_LEVELS {
        return reject(format!("give 1 to {MAX_LEVELS} levels"));
    }
    if pixels.windows(2).any(|pair| pair[0] <= pair[1]) {
        return reject("levels must fall, the finest first".to_string());
    }
    let most = MAX_PARTS * most_pixels;
    if pixels.iter().any(|n| !(MIN_PIXELS..=most).contains(n)) {
        return reject(format!(
            "a level has {MIN_PIXELS} to {most} pixels per block"
        ));
    }
    if pixels
        .last()
        .is_some_and(|last| *last > MAX_COARSEST_PIXELS)
    {
        return reject(format!(
            "the coarsest level is always held and may have at most {MAX_COARSEST_PIXELS} pixels per block: add one"
        ));
    }
    // The coarsest is one.
    let base = pixels.iter().copied().find(|n| *n <= most_pixels);
    let base = base.unwrap_or(MAX_COARSEST_PIXELS);
    if pixels[0] > most_pixels && pixels.last() == Some(&base) {
        let finest = pixels[0];
        return reject(format!(
            "a level of more than {most_pixels} pixels per block is cut into parts of the finest other level, which may not be the \
             coarsest{}",
            level_below(finest, most_pixels).map_or(String::new(), |n| format!(": add {n}"))
        ));
    }
    let mut shapes = Vec::new();
    for n in pixels {
        let parts = if *n <= most_pixels { 1 } else { n / base };
        let shape = (parts * base == *n || parts == 1)
            .then(|| TileShape::cut(n / parts, parts))
            .flatten();
        match shape {
            Some(shape) => shapes.push(shape),
            None => return reject(cannot_be_cut(*n, base, most_pixels)),
        }
    }
    Ok(shapes)
}

/// Why a level cannot be cut into parts of `base`, and which numbers would do.
fn cannot_be_cut(pixels: u32, base: u32, most_pixels: u32) -> String {
    let levels: Vec<_> = (1..=MAX_PARTS.ilog2())
        .map(|power| base << power)
        .filter(|n| *n > most_pixels)
        .map(|n| n.to_string())
        .collect();
    let or = match level_below(pixels, most_pixels) {
        Some(below) => format!(", or add {below} below it"),
        None => String::new(),
    };
    let levels = match levels.as_slice() {
        [] => format!("that of {base} is too small to be cut"),
        levels => format!("of {base} these can be made: {}", levels.join(", ")),
    };
    format!(
        "a level of more than {most_pixels} pixels per block is cut into 2, 4, 8 or 16 parts of the finest other level a side, and \
         {pixels} is none of those times {base}; {levels}{or}"
    )
}

/// The largest tile that a level can be cut into.
fn level_below(pixels: u32, most_pixels: u32) -> Option<u32> {
    let parts = (1..=MAX_PARTS.ilog2()).map(|power| 1 << power);
    let mut tiles = parts.filter(|parts| pixels.is_multiple_of(*parts));
    tiles
        .find(|parts| pixels / parts <= most_pixels)
        .map(|parts| pixels / parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes(shapes: &[TileShape]) -> Vec<(u32, u32)> {
        shapes
            .iter()
            .map(|shape| (shape.block_pixels(), shape.parts))
            .collect()
    }

    fn pixels(shapes: &[TileShape]) -> Vec<u32> {
        shapes.iter().map(|shape| shape.block_pixels()).collect()
    }

    #[test]
    fn the_ladder_ends_at_the_first_level_that_holds_the_source() {
        let of = |width| {
            let ladder = ladder(MapLayer::Day, width, None, MAX_PART_PIXELS).expect("good");
            assert_eq!(ladder.dropped, None, "{width}");
            (pixels(&ladder.levels), ladder.left_out)
        };
        assert_eq!(of(21_600), (vec![1350, 675, 450, 270, 135], vec![]));
        assert_eq!(of(23_000), (vec![1350, 675, 450, 270, 135], vec![]));
        assert_eq!(of(10_800), (vec![675, 450, 270, 135], vec![1350]));
        assert_eq!(of(5_400), (vec![450, 270, 135], vec![1350, 675]));
        assert_eq!(of(64), (vec![135], vec![1350, 675, 450, 270]));
    }

    #[test]
    fn finer_maps_get_levels_that_are_cut_as_far_as_they_fill_them() {
        let paper = [(1350, 1), (675, 1), (450, 1), (270, 1), (135, 1)];
        for (width, cut) in [
            (86_400, &[(5400, 4), (2700, 2)][..]),
            // The finest public Blue Marble.
            (81_920, &[(5400, 4), (2700, 2)]),
            // 86 400 / 1.1 = 78 545.5.
            (78_546, &[(5400, 4), (2700, 2)]),
            (43_200, &[(2700, 2)]),
            (172_800, &[(10_800, 8), (5400, 4), (2700, 2)]),
            (262_144, &[(10_800, 8), (5400, 4), (2700, 2)]),
        ] {
            let ladder = ladder(MapLayer::Day, width, None, MAX_PART_PIXELS).expect("good");
            assert_eq!(shapes(&ladder.levels), [cut, &paper].concat(), "{width}");
            assert_eq!(ladder.dropped.is_some(), width == 262_144, "{width}");
        }
        let clouds = ladder(MapLayer::Clouds, 43_200, None, MAX_PART_PIXELS).expect("good");
        assert_eq!(shapes(&clouds.levels)[..2], [(1500, 2), (750, 1)]);
    }

    #[test]
    fn detail_that_is_dropped_is_reported_with_the_levels_that_keep_it() {
        let reported = |layer, width, asked: Option<&[u32]>| {
            let ladder = ladder(layer, width, asked, MAX_PART_PIXELS).expect("good");
            ladder.dropped.map(|dropped| dropped.to_string())
        };
        let said = reported(MapLayer::Day, 78_545, None).expect("dropped");
        assert!(
            said.contains("78545 texels") && said.contains("level 43200;"),
            "{said}"
        );
        let kept = "--pixels day=5400,2700,1350,675,450,270,135 keeps 86400";
        assert!(said.ends_with(kept), "{said}");
        assert_eq!(reported(MapLayer::Day, 23_760, None), None);
        let said = reported(MapLayer::Clouds, 21_600, None).expect("dropped");
        assert!(said.contains("clouds=1500,750,"), "{said}");
        // Levels that are named may be whole.
        let said = reported(MapLayer::Day, 86_400, Some(&[675, 135])).expect("dropped");
        let kept = "--pixels day=5400,2700,1350,675,135 keeps 86400";
        assert!(said.ends_with(kept), "{said}");
        assert_eq!(
            reported(MapLayer::Day, 262_144, Some(&[32_640, 2040, 16])),
            None
        );
        let said = reported(MapLayer::Day, 21_600, Some(&[16])).expect("dropped");
        assert!(
            said.ends_with("--pixels day=256,128,64,32,16 keeps 4096"),
            "{said}"
        );
    }

    #[test]
    fn bad_ladders_are_rejected_with_what_is_allowed() {
        for (asked, words) in [
            (&[][..], &["1 to 10"][..]),
            (&[2000; 11][..], &["1 to 10"]),
            (&[32_641, 100][..], &["16 to 32640"]),
            (&[300, 100, 15][..], &["16 to"]),
            (&[100, 100][..], &["fall"]),
            (&[100, 200][..], &["fall"]),
            (&[1350, 257][..], &["256"]),
            (
                &[5120, 1350, 256][..],
                &["5120 is none", "2700, 5400, 10800, 21600", "add 1280 below"],
            ),
            (
                &[4050, 1350, 256][..],
                &["4050 is none of those times 1350"],
            ),
            (&[2041, 100][..], &["may not be the coarsest"]),
            (&[2041, 101, 100][..], &["too small to be cut"]),
            (&[43_200, 1350, 100][..], &["16 to"]),
            (&[5400, 256][..], &["may not be the coarsest: add 1350"]),
            (
                &[5400, 256, 100][..],
                &["of 256 these can be made: 2048, 4096", "add 1350 below"],
            ),
        ] {
            let error =
                ladder(MapLayer::Clouds, 100, Some(asked), MAX_PART_PIXELS).expect_err("bad");
            for word in words {
                assert!(error.to_string().contains(word), "{error}");
            }
            assert!(error.to_string().contains("--pixels clouds="), "{error}");
        }
        let good =
            ladder(MapLayer::Day, 64, Some(&[5400, 1350, 256]), MAX_PART_PIXELS).expect("good");
        assert_eq!(shapes(&good.levels), [(5400, 4), (1350, 1), (256, 1)]);
    }
}
