//! Drawn terrain is within the reported error of the data.

use super::{Posts, for_each_triangle, placed, view, whole};
use crate::elevation::Elevation;
use crate::globe::quadtree::{Quadtree, QuadtreeOptions};
use crate::globe::surface::{GroundView, Surface};
use glam::DVec3;
use terrella_frames::{Ellipsoid, Geodetic};

/// Largest distance, metres and pixels, between a drawn point and its point of the data. The latter has the same share of latitude and
/// longitude in its triangle. Triangles at a pole or over the date line are skipped.
fn largest_error(surface: &Quadtree, view: &GroundView, ground: &dyn Elevation) -> (f64, f64) {
    let weights = [
        [0.34, 0.33, 0.33],
        [0.5, 0.5, 0.0],
        [0.0, 0.5, 0.5],
        [0.6, 0.15, 0.25],
        [0.1, 0.1, 0.8],
    ];
    let (mut error_m, mut error_px) = (0.0_f64, 0.0_f64);
    for_each_triangle(surface, |corners| {
        let places = corners.map(|p| Ellipsoid::WGS84.geodetic_from_itrf(p));
        let lons = places.map(|g| g.lon_rad);
        let spread = lons
            .iter()
            .fold(0.0_f64, |most, lon| most.max((lon - lons[0]).abs()));
        if spread > 3.0 || corners.iter().any(|p| p.x.hypot(p.y) < 1e3) {
            return;
        }
        for w in weights {
            let mix =
                |f: fn(&Geodetic) -> f64| -> f64 { (0..3).map(|k| w[k] * f(&places[k])).sum() };
            let (lat_rad, lon_rad) = (mix(|g| g.lat_rad), mix(|g| g.lon_rad));
            let drawn: DVec3 = (0..3).map(|k| corners[k] * w[k]).sum();
            let data = Ellipsoid::WGS84.itrf_from_geodetic(Geodetic {
                lat_rad,
                lon_rad,
                height_m: ground.height_m(lat_rad, lon_rad, 0.0),
            });
            let off_m = drawn.distance(data);
            error_m = error_m.max(off_m);
            error_px = error_px.max(off_m / (drawn.distance(view.eye_itrf_m) * view.pixel_rad));
        }
    });
    (error_m, error_px)
}

#[test]
fn the_error_is_no_larger_than_is_said() {
    let spike = Posts::new(256, |i, j| if (i, j) == (300, 100) { 9e3 } else { 0.0 });
    let cliffs = Posts::new(
        128,
        |i, j| if (i / 3 + j / 5) % 2 == 0 { 9e3 } else { -11e3 },
    );
    let grounds = [Posts::rough(512, 9e3, 5), spike, cliffs];
    for (which, ground) in grounds.iter().chain(&grounds).enumerate() {
        let is_certain = which < grounds.len();
        for (lat, lon, height_m, tilt) in [
            (20.0, 30.0, 2e7, 0.0),
            (19.7, 31.0, 4e5, 0.5),
            (80.0, -60.0, 1e5, 1.2),
            (19.7, 31.0, 1.5e4, 1.3),
        ] {
            let mut surface = Quadtree::new(QuadtreeOptions {
                is_certain,
                is_culled: false,
                ..QuadtreeOptions::default()
            });
            let view = view(lat, lon, height_m, tilt);
            let stats = surface.settle(&view, ground);
            let (error_m, error_px) = largest_error(&surface, &view, ground);
            let (said_m, said_px) = (stats.error_m.unwrap(), stats.error_px.unwrap());
            let what = format!(
                "{which} from {height_m} m: {error_m} m of {said_m}, {error_px} px of {said_px}"
            );
            assert!(error_m <= said_m && error_px <= said_px, "{what}");
            // The bound is not idle either.
            assert!(error_m > 0.02 * said_m, "{what}");
        }
    }
}

#[test]
fn the_tolerance_is_kept() {
    let ground = Posts::rough(512, 5e3, 6);
    for height_m in [1e7, 4e5, 5e4] {
        for tolerance_px in [0.7, 2.0, 8.0] {
            let mut surface = whole(60_000);
            let view = GroundView {
                tolerance_px,
                ..view(20.0, 30.0, height_m, 0.3)
            };
            let stats = surface.settle(&view, &ground);
            let (_, error_px) = largest_error(&surface, &view, &ground);
            let said_px = stats.error_px.unwrap();
            let what = format!(
                "{height_m} m: {error_px} px, said {said_px}, {} leaves",
                surface.leaves()
            );
            assert!(
                said_px <= tolerance_px && error_px <= tolerance_px,
                "{what}"
            );
        }
    }
}

#[test]
fn frames_of_little_work_reach_the_tolerance_too() {
    // Leaves outside the image and behind the horizon must not delay visible ones.
    for (rows, seed) in [(512, 5), (1024, 6)] {
        let ground = Posts::rough(rows, 9e3, seed);
        for (work, frames) in [(3_200, 100), (1_000, 200)] {
            for tilt in [0.0, 0.5] {
                let mut surface = Quadtree::new(QuadtreeOptions {
                    work,
                    ..QuadtreeOptions::default()
                });
                let view = view(75.0, 31.0, 3e4, tilt);
                let mut error_px = None;
                for _ in 0..frames {
                    error_px = surface.prepare(&view, &ground).error_px;
                }
                let what = format!("{rows} rows, {work} a frame, {tilt}: {error_px:?} px");
                assert!(error_px.unwrap() <= 1.0, "{what}");
            }
        }
    }
}

#[test]
fn flat_ground_is_divided_for_its_curve_alone() {
    let flat = Posts::new(64, |_, _| 100.0);
    let rough = Posts::rough(1024, 2e4, 6);
    let leaves = |ground: &Posts| {
        let mut surface = Quadtree::new(Default::default());
        surface.settle(&view(20.0, 30.0, 5e4, 0.3), ground);
        surface.leaves()
    };
    let (flat, rough) = (leaves(&flat), leaves(&rough));
    assert!(
        4 * flat < 3 * rough,
        "{flat} leaves on flat ground, {rough} on rough"
    );
}

/// Single precision in metres from the Earth's centre would lose the precision that patches with origins keep.
#[test]
fn earth_centred_single_precision_would_shake() {
    let ground = Posts::rough(512, 5e3, 6);
    let mut surface = whole(20_000);
    let height_m = ground.height_m(0.35, 0.52, 0.0);
    let view = view(
        0.35_f64.to_degrees(),
        0.52_f64.to_degrees(),
        height_m + 2.0,
        1.2,
    );
    surface.settle(&view, &ground);
    let (mut with_origin_px, mut centred_px) = (0.0_f64, 0.0_f64);
    for built in &surface.patches {
        for place in &built.patch.indices.triangles {
            let vertex = &built.patch.vertices[*place as usize];
            let exact = placed(&built.patch, *place);
            let distance_m = exact.distance(view.eye_itrf_m);
            let pixel_m = distance_m * view.pixel_rad;
            // As in the shader: (origin − eye) is rounded once, and the vertex added in single precision.
            let from_eye =
                (built.patch.origin_itrf_m - view.eye_itrf_m).as_vec3() + vertex.from_origin_m;
            let off_m = from_eye.as_dvec3().distance(exact - view.eye_itrf_m);
            with_origin_px = with_origin_px.max(off_m / pixel_m);
            let centred = exact.as_vec3() - view.eye_itrf_m.as_vec3();
            let off_m = centred.as_dvec3().distance(exact - view.eye_itrf_m);
            centred_px = centred_px.max(off_m / pixel_m);
        }
    }
    assert!(with_origin_px < 0.05, "{with_origin_px} px");
    assert!(centred_px > 5.0, "{centred_px} px");
}
