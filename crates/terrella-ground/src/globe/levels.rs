//! Level of detail (LOD) of maps: which level of a map a block is drawn with. Free functions over plain data.
//!
//! Levels are counted from the finest, 0. Both rules use the distance between the eye and the block's nearest point. Far blocks of the same
//! image are therefore drawn with coarser levels.

use super::COLUMNS;
use std::f64::consts::TAU;

/// How the level of a block is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize, serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum LevelRule {
    /// The coarsest level whose texels are small enough on screen: [`screen_level`].
    #[default]
    Screen,
    /// The paper's Table 1: [`paper_level`].
    Paper,
}

/// Upper ends of the paper's distance bands (Table 1), metres: level 0 up to 200 km … level 3 up to 7 000 km.
pub const PAPER_BANDS_M: [f64; 4] = [200e3, 1_000e3, 2_000e3, 7_000e3];

/// A coarser level is selected only once its texels are smaller than the limit by this factor.
pub const HYSTERESIS: f64 = 0.8;

/// The paper's Table 1: the level at a distance, of a map with `levels` levels.
///
/// The last five levels are the paper's. If a map has fewer, its finest level replaces the missing ones; levels finer than the paper's are
/// not used. The paper selects by the height of the eye. Here the distance of each block from the eye is used, which equals the height for
/// the block below.
pub fn paper_level(distance_m: f64, levels: usize) -> usize {
    let band = PAPER_BANDS_M.partition_point(|end| *end < distance_m);
    (band + levels).saturating_sub(PAPER_BANDS_M.len() + 1)
}

/// The coarsest level whose texel, seen face on at this distance, covers at most `max_px` screen pixels. If there is none, the finest.
///
/// `pixels` are texels per block side, the finest level first; `radius_m` is the Earth's radius; `pixel_rad` is the angle of a screen
/// pixel. `current` is the level that the block had in the frame before. With it, a coarser level is selected only once it covers
/// [`HYSTERESIS`] × `max_px`, so that an eye near a limit does not toggle.
pub fn screen_level(
    pixels: &[u32],
    radius_m: f64,
    distance_m: f64,
    pixel_rad: f64,
    max_px: f64,
    current: Option<usize>,
) -> usize {
    let coarsest_within = |max_px: f64| {
        pixels
            .iter()
            .rposition(|n| texels_per_pixel(*n, radius_m, distance_m, pixel_rad) * max_px >= 1.0)
            .unwrap_or(0)
    };
    let target = coarsest_within(max_px);
    match current {
        Some(current) if target > current => {
            coarsest_within(max_px * HYSTERESIS).clamp(current, target)
        }
        _ => target,
    }
}

/// Texels per screen pixel along a meridian, seen face on at this distance. 0 at distance 0, where nothing is sharp.
pub fn texels_per_pixel(pixels: u32, radius_m: f64, distance_m: f64, pixel_rad: f64) -> f64 {
    let texel_m = TAU * radius_m / f64::from(COLUMNS * pixels.max(1));
    distance_m * pixel_rad / texel_m
}

#[cfg(test)]
mod tests {
    use super::*;

    const LADDER: [u32; 5] = [1350, 675, 450, 270, 135];
    const RADIUS_M: f64 = 6_378_137.0;
    const PIXEL_RAD: f64 = 1e-3;

    #[test]
    fn the_paper_s_table() {
        for (km, level) in [
            (0.0, 0),
            (199.0, 0),
            (200.0, 0),
            (201.0, 1),
            (1_000.0, 1),
            (1_001.0, 2),
            (2_000.0, 2),
            (6_999.0, 3),
            (7_001.0, 4),
            (384_400.0, 4),
        ] {
            assert_eq!(paper_level(km * 1e3, 5), level, "{km} km");
        }
        // A map without the two finest levels, and one with two finer ones.
        let of_3 = [1e5, 5e5, 1.5e6, 5e6, 1e7].map(|distance_m| paper_level(distance_m, 3));
        assert_eq!(of_3, [0, 0, 0, 1, 2]);
        assert_eq!((paper_level(1e5, 7), paper_level(1e9, 7)), (2, 6));
        assert_eq!(paper_level(1e9, 1), 0);
    }

    #[test]
    fn the_coarsest_level_that_is_sharp_is_taken() {
        for distance_m in [1.0, 1e5, 1e6, 2e6, 5e6, 1e7, 4e8] {
            let level = screen_level(&LADDER, RADIUS_M, distance_m, PIXEL_RAD, 1.0, None);
            let sharp =
                |n: usize| texels_per_pixel(LADDER[n], RADIUS_M, distance_m, PIXEL_RAD) >= 1.0;
            assert!(sharp(level) || level == 0, "{distance_m}: {level}");
            assert!(level == 4 || !sharp(level + 1), "{distance_m}: {level}");
        }
        // 40 075 km / 21 600 = 1.855 km a texel: one pixel of 1 mrad at 1 855 km.
        let at = |distance_m| screen_level(&LADDER, RADIUS_M, distance_m, PIXEL_RAD, 1.0, None);
        assert_eq!((at(3_700e3), at(3_715e3)), (0, 1));
        // A limit of two pixels is met from half as far.
        let coarse = screen_level(&LADDER, RADIUS_M, 1_860e3, PIXEL_RAD, 2.0, None);
        assert_eq!(coarse, 1);
    }

    #[test]
    fn a_hovering_eye_does_not_toggle() {
        let limit_m = 3_711e3;
        let mut level = screen_level(&LADDER, RADIUS_M, limit_m * 0.99, PIXEL_RAD, 1.0, None);
        let mut changes = 0;
        for step in 0..1_000 {
            let distance_m = limit_m * (1.0 + 0.05 * f64::from(step).sin());
            let next = screen_level(&LADDER, RADIUS_M, distance_m, PIXEL_RAD, 1.0, Some(level));
            changes += usize::from(next != level);
            level = next;
        }
        assert_eq!((level, changes), (0, 0));
        // At a large enough distance it does change, in one step over several levels too, and back at once.
        let far = screen_level(&LADDER, RADIUS_M, 1e9, PIXEL_RAD, 1.0, Some(0));
        let near = screen_level(&LADDER, RADIUS_M, 1e5, PIXEL_RAD, 1.0, Some(4));
        assert_eq!((far, near), (4, 0));
    }

    #[test]
    fn nothing_and_nonsense_give_the_finest() {
        assert_eq!(screen_level(&[], RADIUS_M, 1e6, PIXEL_RAD, 1.0, None), 0);
        assert_eq!(
            screen_level(&LADDER, RADIUS_M, f64::NAN, PIXEL_RAD, 1.0, Some(2)),
            0
        );
        assert_eq!(
            screen_level(&LADDER, RADIUS_M, 0.0, PIXEL_RAD, 1.0, None),
            0
        );
    }
}
