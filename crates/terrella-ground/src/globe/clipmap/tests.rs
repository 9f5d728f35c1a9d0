//! Tests of the clipmap, with the grounds and checks that they share.

mod border;
mod motion;
mod surface;

use super::*;
use crate::elevation::{Bounds, HeightRange};
use glam::{DMat4, DVec3};
use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};
use std::sync::Arc;
use terrella_frames::Geodetic;

/// Ground given by a function.
pub struct Rule {
    /// Height at an outward normal, averaged over a spacing in radians.
    height: fn(DVec3, f64) -> f64,
    finest_rad: f64,
}

impl Elevation for Rule {
    fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
        (self.height)(Ellipsoid::normal(lat_rad, lon_rad), spacing_rad)
    }

    fn range_m(&self, _: &Bounds) -> HeightRange {
        HeightRange {
            low_m: -12_000.0,
            high_m: 12_000.0,
        }
    }

    fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
        self.finest_rad
    }
}

/// Waves of many lengths; each fades out where the average is longer than the wave.
pub const HILLS: Rule = Rule {
    height: |n, spacing| {
        let wave = |k: f64, amplitude: f64| {
            let phase = k * (n.x * 1.1 + n.y * 0.7 + (n.z * 0.9 + n.x * n.y).sin());
            amplitude * (-(k * spacing).powi(2)).exp() * phase.sin()
        };
        wave(9.0, 3000.0) + wave(90.0, 900.0) + wave(900.0, 200.0) + wave(9000.0, 40.0)
    },
    finest_rad: 1e-6,
};

/// The bare ellipsoid.
pub const FLAT: Rule = Rule {
    height: |_, _| 0.0,
    finest_rad: f64::INFINITY,
};

/// Not averaged: steps from −11 000 m to 9 000 m.
pub const CLIFFS: Rule = Rule {
    height: |n, _| {
        if (n.x * 40.0).sin() * (n.z * 30.0).sin() > 0.0 {
            9000.0
        } else {
            -11_000.0
        }
    },
    finest_rad: 1e-6,
};

/// A needle of 8 km at 10° N 20° E.
pub const SPIKE: Rule = Rule {
    height: |n, _| {
        let top = Ellipsoid::normal(10_f64.to_radians(), 20_f64.to_radians());
        (8000.0 * (1.0 - n.distance(top) / 1e-4)).max(0.0)
    },
    finest_rad: 1e-5,
};

/// Options for small levels that all appear at once.
pub fn at_once(levels: u32, trim: Trim) -> ClipmapOptions {
    ClipmapOptions {
        samples: 65,
        levels,
        samples_per_prepare: u64::MAX,
        fade_prepares: 0,
        trim,
        ..ClipmapOptions::default()
    }
}

pub fn clipmap(options: ClipmapOptions) -> Clipmap {
    Clipmap::new(options).expect("sound")
}

/// A view from a place in any direction: levels do not depend on it.
pub fn over(lat_deg: f64, lon_deg: f64, height_m: f64) -> GroundView {
    view_from(
        Ellipsoid::WGS84.itrf_from_geodetic(Geodetic::from_degrees(lat_deg, lon_deg, height_m)),
    )
}

pub fn view_from(eye_itrf_m: DVec3) -> GroundView {
    GroundView {
        eye_itrf_m,
        clip_from_eye: DMat4::IDENTITY,
        pixel_rad: 1e-3,
        tolerance_px: 0.0,
    }
}

/// Prepares until all levels are there.
pub fn settle(map: &mut Clipmap, view: &GroundView, ground: &dyn Elevation) {
    for _ in 0..150 {
        map.prepare(view, ground);
    }
}

pub type Point = [u64; 3];

fn bits(point: DVec3) -> Point {
    // −0 and 0 are the same place.
    (point + DVec3::ZERO).to_array().map(f64::to_bits)
}

fn place(point: Point) -> DVec3 {
    DVec3::from_array(point.map(f64::from_bits))
}

/// All drawn triangles, including those outside the image, as exact positions.
pub fn triangles(map: &Clipmap) -> Vec<[Point; 3]> {
    let finest = map.counts.finest as usize;
    let mut all = Vec::new();
    for level in &map.levels[..=finest] {
        for buffer in &level.buffers {
            let patch = &buffer.patch;
            let at = |index: u32| {
                let offset = patch.vertices[index as usize].from_origin_m.as_dvec3();
                bits(patch.origin_itrf_m + offset)
            };
            let corners = patch.indices.triangles.chunks_exact(3);
            all.extend(corners.map(|t| [at(t[0]), at(t[1]), at(t[2])]));
        }
    }
    all
}

/// Each edge has two triangles, one in each direction. The surface is closed, topologically a sphere, and faces outwards.
pub fn assert_closed(map: &Clipmap, what: &str) {
    let all = triangles(map);
    let mut points = all.concat();
    points.sort_unstable();
    points.dedup();
    let mut number = HashMap::with_capacity_and_hasher(points.len(), Default::default());
    number.extend(points.iter().copied().zip(0_u32..));
    let at = |number: u32| place(points[number as usize]);
    let mut edges = Vec::with_capacity(all.len() * 3);
    let mut volume = 0.0;
    for triangle in &all {
        let [a, b, c] = triangle.map(|point| number[&point]);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let at = at(from);
            assert_ne!(from, to, "{what}: a triangle without area at {at:?}");
            edges.push((from, to));
        }
        volume += at(a).dot(at(b).cross(at(c))) / 6.0;
    }
    edges.sort_unstable();
    let twice = edges.windows(2).find(|pair| pair[0] == pair[1]);
    if let Some([(from, _), _]) = twice {
        panic!("{what}: an edge twice at {:?}", at(*from));
    }
    let mut back: Vec<_> = edges.iter().map(|(from, to)| (*to, *from)).collect();
    back.sort_unstable();
    let crack = edges.iter().zip(&back).find(|(edge, back)| edge != back);
    if let Some(((from, _), _)) = crack {
        panic!("{what}: a crack at {:?}", at(*from));
    }
    let euler = points.len() as i64 - edges.len() as i64 / 2 + all.len() as i64;
    assert_eq!(euler, 2, "{what}: not one sphere");
    assert!(
        (1.05e21..1.11e21).contains(&volume),
        "{what}: volume {volume}"
    );
}

/// A closed surface after a change of the triangles of one patch.
fn with_triangles(change: impl FnOnce(&mut Vec<u32>)) -> Clipmap {
    let mut map = clipmap(at_once(5, Trim::Diamond));
    map.prepare(&over(47.0, 11.0, 3000.0), &HILLS);
    let indices = &mut map.levels[3].buffers[0].patch.indices;
    change(&mut Arc::make_mut(indices).triangles);
    map
}

#[test]
#[should_panic(expected = "a crack at")]
fn a_missing_triangle_is_a_crack() {
    let map = with_triangles(|triangles| triangles.truncate(triangles.len() - 3));
    assert_closed(&map, "less one");
}

#[test]
#[should_panic(expected = "an edge twice at")]
fn a_triangle_drawn_twice_is_no_surface() {
    let map = with_triangles(|triangles| triangles.extend_from_within(..3));
    assert_closed(&map, "one more");
}

/// The twelve corners of the icosahedron and places between them, degrees.
pub fn odd_places() -> Vec<(f64, f64)> {
    let mut places = vec![
        (90.0, 0.0),
        (-90.0, 0.0),
        (0.0, 180.0),
        (0.0, -180.0),
        (51.3, -179.9999),
    ];
    for k in 0..5 {
        let k = f64::from(k);
        places.extend([(26.565, 72.0 * k), (-26.565, 36.0 + 72.0 * k)]);
        // Places on edges, beside corners, and in the middle of faces.
        places.extend([
            (60.0, 72.0 * k),
            (26.0, 72.0 * k + 1.0),
            (-60.0, 36.0 + 72.0 * k),
        ]);
        places.extend([
            (0.0, 18.0 + 36.0 * k),
            (52.6, 36.0 + 72.0 * k),
            (88.0, 72.0 * k + 20.0),
        ]);
    }
    places
}
