//! Levels of elevation data, and their existing tiles.

use crate::BuildError;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use terrella_ground::elevation::{Bounds, PlacedBounds};
use terrella_imagery::pack::{HeightPlace, HeightsEntry, MAX_HEIGHT_TILES};

/// Most samples of a tile's side.
pub(super) const MOST_SIDE: u32 = 384;

/// Columns of tiles of the coarsest level.
const COLUMNS: u32 = 16;

/// Most samples round the Earth.
const MOST_ROUND: u64 = 1 << 30;

/// A level may be coarser than a file by so much and still hold it.
const COARSER: f64 = 1.1;

/// Whether a file is too fine for a level: it then has a finer level everywhere.
pub(super) fn is_finer(step_rad: f64, spacing_rad: f64) -> bool {
    step_rad * COARSER < spacing_rad
}

/// Number of levels and side of their tiles, so that the samples of the finest level are at most `finest_rad` apart, and closer only by the
/// rounding of the side; `None` if there would be too many samples.
pub(super) fn levels_for(finest_rad: f64) -> Option<(u8, u32)> {
    // A little less, so that a division that comes out even stays so.
    let round = (TAU / finest_rad - 1e-6).ceil().max(1.0);
    let mut levels = 1_u8;
    let mut side = round / f64::from(COLUMNS);
    while side > f64::from(MOST_SIDE) && levels < 32 {
        side *= 0.5;
        levels += 1;
    }
    let side = (side.ceil() as u32)
        .next_multiple_of(2)
        .clamp(16, MOST_SIDE);
    let all = (u64::from(COLUMNS) << (levels - 1)) * u64::from(side);
    (all <= MOST_ROUND).then_some((levels, side))
}

/// The tiles of each level, the finest first, row by row: all of the coarsest, and of the others those whose coarser tile is too coarse for a
/// file that reaches into them. `files` are bounds and spacings, radians.
pub(super) fn tiles(
    entry: &HeightsEntry,
    files: &[(Bounds, f64)],
) -> Result<Vec<Vec<HeightPlace>>, BuildError> {
    let coarsest = entry.coarsest();
    let columns = entry.columns_of(coarsest);
    let all = (0..columns / 2).flat_map(|row| {
        (0..columns).map(move |column| HeightPlace {
            level: coarsest,
            row,
            column,
        })
    });
    let mut levels: Vec<Vec<HeightPlace>> = vec![all.collect()];
    let mut count = levels[0].len();
    for level in (0..coarsest).rev() {
        let spacing_rad = TAU / f64::from(entry.round(level + 1));
        let finer: Vec<_> = files
            .iter()
            .filter(|(_, step_rad)| is_finer(*step_rad, spacing_rad))
            .map(|(bounds, _)| *bounds)
            .collect();
        let placed = PlacedBounds::new(finer.iter().copied());
        let mut places = Vec::new();
        for parent in levels.last().into_iter().flatten() {
            for quarter in 0..4 {
                let place = HeightPlace {
                    level,
                    row: 2 * parent.row + quarter / 2,
                    column: 2 * parent.column + quarter % 2,
                };
                let area = area(entry, place);
                let near = placed.near(&area);
                if near.iter().any(|n| reaches(&finer[*n], &area)) {
                    places.push(place);
                }
            }
            if count + places.len() > MAX_HEIGHT_TILES as usize {
                return Err(BuildError::Option {
                    option: "--heights",
                    cause: format!(
                        "these files need more than {MAX_HEIGHT_TILES} tiles of {} samples; give fewer or coarser ones",
                        entry.side
                    ),
                });
            }
        }
        count += places.len();
        places.sort();
        levels.push(places);
    }
    levels.reverse();
    Ok(levels)
}

/// Bounds of a tile, its border included; beyond a pole it has no limit.
fn area(entry: &HeightsEntry, place: HeightPlace) -> Bounds {
    let round = f64::from(entry.round(place.level));
    let border_rad = f64::from(entry.border) * TAU / round;
    let side_rad = TAU / f64::from(entry.columns_of(place.level));
    let north_rad = FRAC_PI_2 - f64::from(place.row) * side_rad + border_rad;
    Bounds {
        south_rad: north_rad - side_rad - 2.0 * border_rad,
        north_rad,
        west_rad: f64::from(place.column) * side_rad - PI - border_rad,
        width_rad: side_rad + 2.0 * border_rad,
    }
}

/// Whether a file overlaps a tile.
fn reaches(bounds: &Bounds, area: &Bounds) -> bool {
    let from_file = (area.west_rad - bounds.west_rad).rem_euclid(TAU);
    let from_tile = (bounds.west_rad - area.west_rad).rem_euclid(TAU);
    let along = from_file < bounds.width_rad || from_tile < area.width_rad;
    along && area.south_rad < bounds.north_rad && bounds.south_rad < area.north_rad
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_as_fine_as_the_finest_file_and_hardly_finer() {
        let of = |round: f64| levels_for(TAU / round);
        assert_eq!(of(6144.0), Some((1, 384)));
        assert_eq!(of(6145.0), Some((2, 194)));
        assert_eq!(of(21_600.0), Some((3, 338)));
        assert_eq!(of(86_400.0), Some((5, 338)));
        assert_eq!(of(1_296_000.0), Some((9, 318)));
        assert_eq!(of(64.0), Some((1, 16)));
        assert_eq!(of(f64::from(1 << 30)), Some((19, 256)));
        assert_eq!(of(f64::from(1 << 30) * 1.01), None);
        for round in (100..5_000_000).step_by(7919) {
            let (levels, side) = of(f64::from(round)).expect("possible");
            let all = (16_u32 << (levels - 1)) * side;
            let more = f64::from(all) / f64::from(round);
            assert!(
                all >= round && (more < 1.011 || round < 6144),
                "{round}: {all}"
            );
        }
    }
}
