//! The choice of a level, to the last bit of a distance.

use proptest::prelude::*;
use terrella_ground::globe::{COLUMNS, HYSTERESIS, PAPER_BANDS_M, paper_level, screen_level};
use terrella_measure::numeric::oracle::Real;

const LADDER: [u32; 5] = [1350, 675, 450, 270, 135];
const R: f64 = 6_378_137.0;

#[test]
fn the_papers_bands_end_at_their_last_float() {
    for (band, end) in PAPER_BANDS_M.into_iter().enumerate() {
        assert_eq!(paper_level(end.next_down(), 5), band);
        assert_eq!(paper_level(end, 5), band);
        assert_eq!(paper_level(end.next_up(), 5), band + 1);
    }
    assert_eq!(PAPER_BANDS_M[0], 200_000.0);
    assert_eq!((paper_level(0.0, 5), paper_level(f64::INFINITY, 5)), (0, 4));
    for levels in 0..8 {
        for distance_m in [f64::NAN, f64::NEG_INFINITY, -1.0, f64::MAX] {
            assert!(paper_level(distance_m, levels) < levels.max(1));
        }
    }
}

fn level(distance_m: f64, pixel_rad: f64, most_px: f64, current: Option<usize>) -> usize {
    screen_level(&LADDER, R, distance_m, pixel_rad, most_px, current)
}

/// The last distance at which `is_fine` holds, by bisection over the floats.
fn last(is_fine: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (1.0_f64.to_bits(), 1e15_f64.to_bits());
    assert!(is_fine(1.0) && !is_fine(1e15));
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if is_fine(f64::from_bits(middle)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::from_bits(low)
}

/// Texels per pixel × `most_px` − 1, exactly.
fn surplus(texels: u32, distance_m: f64, pixel_rad: f64, most_px: f64) -> f64 {
    let round = Real::pi() * Real::from(2.0) * Real::from(R);
    let texel = round / Real::from(f64::from(COLUMNS * texels));
    let covered = Real::from(distance_m) * Real::from(pixel_rad) / texel;
    (covered * Real::from(most_px) - Real::from(1.0)).to_f64()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 64, ..ProptestConfig::default() })]

    /// The level changes within four roundings of the distance at which it should.
    #[test]
    fn a_level_begins_where_its_texels_are_small_enough(finer in 0..4_usize, pixel_rad in 1e-9..1e-2_f64, most_px in 0.25..8.0_f64) {
        let end = last(|d| level(d, pixel_rad, most_px, None) <= finer);
        let coarser = LADDER[finer + 1];
        let (before, after) = (surplus(coarser, end, pixel_rad, most_px), surplus(coarser, end.next_up(), pixel_rad, most_px));
        prop_assert!(before < 4.0 * f64::EPSILON && after > -4.0 * f64::EPSILON, "{} {}", before, after);
    }

    /// An eye that trembles by one float about either limit changes the level once at most.
    #[test]
    fn no_tremble_toggles_a_level(finer in 0..4_usize, pixel_rad in 1e-9..1e-2_f64, most_px in 0.25..8.0_f64) {
        let limit = last(|d| level(d, pixel_rad, most_px, None) <= finer);
        let late = last(|d| level(d, pixel_rad, most_px, Some(finer)) <= finer);
        prop_assert!((late * HYSTERESIS / limit - 1.0).abs() < 1e-15, "{} {}", limit, late);
        for centre in [limit, late] {
            let around = [centre.next_down(), centre, centre.next_up(), centre.next_up().next_up()];
            let mut current = finer;
            let mut changes = 0;
            for step in 0..40 {
                let next = level(around[(7 * step) % 4], pixel_rad, most_px, Some(current));
                changes += usize::from(next != current);
                current = next;
            }
            prop_assert!(changes <= 1, "{} changes about {}", changes, centre);
        }
    }
}
