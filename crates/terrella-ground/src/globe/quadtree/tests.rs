//! The forest over synthetic ground.

mod budget;
mod cracks;
mod culling;
mod errors;
mod extremes;
mod work;

use super::{Quadtree, QuadtreeOptions};
use crate::elevation::{Bounds, Elevation, HeightRange};
use crate::globe::surface::{GroundView, Patch, Surface};
use glam::{DVec3, dcamera};
use std::f64::consts::{PI, TAU};
use terrella_frames::{Ellipsoid, Geodetic};

/// Heights on the posts of a grid over the whole Earth, bilinear between them; one height at each pole.
pub struct Posts {
    columns: usize,
    rows: usize,
    heights_m: Vec<f64>,
}

impl Posts {
    /// A grid of `rows` steps from pole to pole, and twice as many around; `height` takes a column and a row.
    pub fn new(rows: usize, height: impl Fn(usize, usize) -> f64) -> Self {
        let columns = 2 * rows;
        let mut heights_m = Vec::new();
        for row in 0..=rows {
            for column in 0..columns {
                let column = if row == 0 || row == rows { 0 } else { column };
                heights_m.push(height(column, row));
            }
        }
        Self {
            columns,
            rows,
            heights_m,
        }
    }

    /// Rough ground: every octave half as high, between about −`height_m` and `height_m`.
    pub fn rough(rows: usize, height_m: f64, seed: u64) -> Self {
        let noise = |x: u64, y: u64, octave: u64| {
            let mut h =
                seed ^ x.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ y.rotate_left(32) ^ octave << 60;
            h = (h ^ h >> 31).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            h = (h ^ h >> 29).wrapping_mul(0x94d0_49bb_1331_11eb);
            (h >> 40) as f64 / f64::from(1 << 23) - 1.0
        };
        Self::new(rows, |column, row| {
            let mut sum = 0.0;
            for octave in 0..5_u64 {
                let cell = 16 >> octave;
                let (x, y) = (column / cell, row / cell);
                let (u, v) = (
                    (column % cell) as f64 / cell as f64,
                    (row % cell) as f64 / cell as f64,
                );
                let around = (2 * rows).div_ceil(cell);
                let at =
                    |i: usize, j: usize| noise(((x + i) % around) as u64, (y + j) as u64, octave);
                let top = at(0, 0) * (1.0 - u) + at(1, 0) * u;
                let bottom = at(0, 1) * (1.0 - u) + at(1, 1) * u;
                sum += 0.5_f64.powi(octave as i32 + 1) * (top * (1.0 - v) + bottom * v);
            }
            height_m * sum
        })
    }

    fn post(&self, column: usize, row: usize) -> f64 {
        self.heights_m[row.min(self.rows) * self.columns + column % self.columns]
    }

    fn place(&self, lat_rad: f64, lon_rad: f64) -> (f64, f64) {
        let lat = lat_rad.clamp(-0.5 * PI, 0.5 * PI);
        (
            (lon_rad + PI).rem_euclid(TAU) / TAU * self.columns as f64,
            (0.5 * PI - lat) / PI * self.rows as f64,
        )
    }
}

impl Elevation for Posts {
    fn height_m(&self, lat_rad: f64, lon_rad: f64, _spacing_rad: f64) -> f64 {
        let (x, y) = self.place(lat_rad, lon_rad);
        let (i, j) = (x as usize, (y as usize).min(self.rows - 1));
        let (u, v) = (x - i as f64, y - j as f64);
        let top = self.post(i, j) * (1.0 - u) + self.post(i + 1, j) * u;
        let bottom = self.post(i, j + 1) * (1.0 - u) + self.post(i + 1, j + 1) * u;
        top * (1.0 - v) + bottom * v
    }

    fn range_m(&self, bounds: &Bounds) -> HeightRange {
        let (x, y0) = self.place(bounds.north_rad, bounds.west_rad);
        let (_, y1) = self.place(bounds.south_rad, bounds.west_rad);
        let width = bounds.width_rad / TAU * self.columns as f64;
        let (mut low_m, mut high_m) = (f64::INFINITY, f64::NEG_INFINITY);
        let first = x.floor() as usize;
        let last = ((x + width).ceil() as usize).min(first + self.columns);
        for row in y0.floor() as usize..=y1.ceil() as usize {
            for column in first..=last {
                let height_m = self.post(column, row);
                (low_m, high_m) = (low_m.min(height_m), high_m.max(height_m));
            }
        }
        HeightRange { low_m, high_m }
    }

    fn finest_spacing_rad(&self, _lat_rad: f64, _lon_rad: f64) -> f64 {
        PI / self.rows as f64
    }
}

/// A view from an eye over a place, tilted from straight down by `tilt_rad` towards the north.
pub fn view(lat_deg: f64, lon_deg: f64, height_m: f64, tilt_rad: f64) -> GroundView {
    let place = Geodetic::from_degrees(lat_deg, lon_deg, height_m);
    let eye_itrf_m = Ellipsoid::WGS84.itrf_from_geodetic(place);
    let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let north = DVec3::new(
        -place.lat_rad.sin() * place.lon_rad.cos(),
        -place.lat_rad.sin() * place.lon_rad.sin(),
        place.lat_rad.cos(),
    );
    let ahead = north * tilt_rad.sin() - up * tilt_rad.cos();
    let above = north * tilt_rad.cos() + up * tilt_rad.sin();
    let height_px = 720.0;
    let half_rad = 0.5_f64;
    let projection =
        dcamera::rh::proj::directx::perspective_infinite_reverse(2.0 * half_rad, 16.0 / 9.0, 0.1);
    GroundView {
        eye_itrf_m,
        clip_from_eye: projection * dcamera::rh::view::look_to_mat4(DVec3::ZERO, ahead, above),
        pixel_rad: 2.0 * half_rad.tan() / height_px,
        tolerance_px: 1.0,
    }
}

/// A surface with few leaves and no culling.
pub fn whole(max_leaves: u32) -> Quadtree {
    Quadtree::new(QuadtreeOptions {
        max_leaves,
        is_culled: false,
        ..QuadtreeOptions::default()
    })
}

/// Position of a vertex, ITRF metres.
pub fn placed(patch: &Patch, place: u32) -> DVec3 {
    patch.origin_itrf_m + patch.vertices[place as usize].from_origin_m.as_dvec3()
}

/// Calls `call` for each drawn triangle.
pub fn for_each_triangle(surface: &Quadtree, mut call: impl FnMut([DVec3; 3])) {
    surface.for_each_patch(&mut |patch| {
        for corners in patch.indices.triangles.as_chunks::<3>().0 {
            call(corners.map(|place| placed(patch, place)));
        }
    });
}
