//! Visibility above the horizon, from a height of a millimetre.

use glam::{DMat4, DVec3, DVec4};
use std::f64::consts::PI;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella_ground::globe::{Block, BlockGrid, Visibility, select_blocks};
use terrella_measure::numeric::log_spaced;
use terrella_measure::numeric::oracle::{Real, dot, real3};

const R: f64 = 6_378_164.0;

/// Everything is in front: no frustum.
fn all_round() -> DMat4 {
    DMat4::from_cols(DVec4::ZERO, DVec4::ZERO, DVec4::ZERO, DVec4::W)
}

/// Distance along the ground, metres, between the exact horizon and the last ground that a test calls visible: the test
/// is bisected over the angle at the centre.
fn off_m(height_m: f64, is_above: impl Fn(DVec3, DVec3) -> bool) -> f64 {
    let eye = DVec3::new(R + height_m, 0.0, 0.0);
    let (mut seen, mut hidden) = (0.0, 0.5 * PI);
    for _ in 0..90 {
        let middle: f64 = 0.5 * (seen + hidden);
        let ground = DVec3::new(middle.cos(), middle.sin(), 0.0) * R;
        if is_above(eye, ground) {
            seen = middle;
        } else {
            hidden = middle;
        }
    }
    let (r, l) = (Real::from(R), Real::from(eye.x));
    let exact = ((&l - &r) * (&l + &r)).sqrt().atan2(&r);
    exact.absolute_error(seen) * R
}

#[test]
fn the_horizon_is_where_it_is_from_a_millimetre_up() {
    let scaled = |eye: DVec3, ground: DVec3| (ground / R).dot(eye / R) >= 1.0;
    let angles = |eye: DVec3, ground: DVec3| ground.angle_between(eye) <= (R / eye.length()).acos();
    let normals = |eye: DVec3, ground: DVec3| (eye - ground).dot(ground / R) > 0.0;
    let mut worst = [0.0_f64; 3];
    for height_m in log_spaced(1e-3, 1e12, 2) {
        let off = [
            off_m(height_m, scaled),
            off_m(height_m, angles),
            off_m(height_m, normals),
        ];
        // An f64's rounding of the eye's distance moves the horizon by as much, and more the lower the eye.
        let rounding_m = f64::EPSILON * R * (R / height_m).sqrt().max(1.0);
        assert!(off[0] <= 2.0 * rounding_m, "{height_m} m: {off:?} m");
        worst = std::array::from_fn(|k| worst[k].max(off[k]));
    }
    println!("P'·e' ≥ 1, angles, (e − v)·n > 0: horizon off by at most {worst:?} m");
    assert!(worst[0] < 1e-3);
}

#[test]
fn a_block_is_kept_from_a_millimetre_above_its_corner() {
    // The eye is above the common corner of four blocks: all four must be drawn, at any height, and their neighbours' neighbours need not. The
    // paper's rule only tests corners and keeps these too.
    for figure in [Ellipsoid::WGS84, Ellipsoid::PAPER_SPHERE] {
        let grid = BlockGrid::new(figure, 6).unwrap();
        for height_m in [1e-3, 1e-2, 1.0, 100.0] {
            for (lat, lon) in [(0.0, 0.0), (45.0, -180.0), (-67.5, 90.0), (22.5, 157.5)] {
                let eye = figure.itrf_from_geodetic(Geodetic::from_degrees(lat, lon, height_m));
                let mut drawn = Vec::new();
                select_blocks(
                    &grid,
                    Visibility::Conservative,
                    eye,
                    &all_round(),
                    &mut drawn,
                );
                let touching = Block::all().filter(|block| {
                    let (n, corner) = (grid.subdivision(), Geodetic::from_degrees(lat, lon, 0.0));
                    let corner = figure.itrf_from_geodetic(corner);
                    [(0, 0), (n, 0), (0, n), (n, n)]
                        .into_iter()
                        .any(|(i, j)| grid.vertex_itrf_m(*block, i, j).distance(corner) < 1.0)
                });
                let touching: Vec<_> = touching.collect();
                assert_eq!(touching.len(), 4);
                let lost = touching.iter().find(|block| !drawn.contains(block));
                assert_eq!(lost, None, "{height_m} m over {lat}°, {lon}°");
                assert!(
                    drawn.len() <= 12,
                    "{} blocks from {height_m} m",
                    drawn.len()
                );
            }
        }
    }
}

#[test]
fn a_block_s_distance_is_good_to_decimetres_on_a_sphere() {
    // Against the nearest point of the block in the oracle, for an eye above the block: L − R.
    let grid = BlockGrid::new(Ellipsoid::PAPER_SPHERE, 6).unwrap();
    for height_m in log_spaced(1e-3, 1e12, 2) {
        for block in Block::all() {
            let normal = Ellipsoid::normal(block.center_lat_rad(), block.center_lon_rad());
            let eye = normal * (R + height_m);
            let e = real3(eye);
            let exact = dot(&e, &e).sqrt() - Real::from(R);
            let off = exact.absolute_error(grid.distance_m(block, eye));
            // Rounding of positions, and its root where "beside" is a rounding: 2(|e| − m) = ε gives √ε R = 0.1 m.
            let rounding_m = 0.3 * (1.0 + height_m / R);
            assert!(off < rounding_m, "{block:?} from {height_m} m: {off} m");
        }
    }
}
