//! How bright the ground is all about a place: what lights the air over it.

use super::maps::{Decode, FullMaps};
use glam::DVec3;
use terrella_imagery::tile::MapLayer;

/// Reflectance of open water with foam and reflections.
const SEA_ALBEDO: f64 = 0.05;

/// Cells round the Earth and from pole to pole: some 300 km.
const COLUMNS: usize = 128;
const ROWS: usize = 64;
/// Places along each side of a cell that it is the mean of.
const PLACES: usize = 12;

/// Mean reflectance in cells of latitude and longitude, linear light.
#[derive(Debug)]
pub(super) struct Surroundings {
    /// Of ground and clouds.
    pub all: Cells,
    /// Of the ground without clouds.
    pub ground: Cells,
}

/// Of each cell its mean.
#[derive(Debug)]
pub(super) struct Cells(Vec<DVec3>);

impl Surroundings {
    /// Of maps, clouds being of this albedo.
    pub fn new(maps: &FullMaps, decode: &Decode, cloud_albedo: f64) -> Self {
        let reflectance = |u: f64, v: f64| {
            let day = maps
                .get(MapLayer::Day)
                .map(|map| DVec3::from_array(map.at(u, v, &decode.srgb)));
            let water = maps.get(MapLayer::Water).map_or(0.0, |map| {
                let [water] = map.at(u, v, &decode.unorm);
                water
            });
            let cover = maps.get(MapLayer::Clouds).map_or(0.0, |map| {
                let [cover] = map.at(u, v, &decode.unorm);
                cover
            });
            let ground = day.unwrap_or(DVec3::ZERO);
            let ground = ground.lerp(DVec3::splat(SEA_ALBEDO), water);
            [ground.lerp(DVec3::splat(cloud_albedo), cover), ground]
        };
        let cell = |at: usize| {
            let (column, row) = ((at % COLUMNS) as f64, (at / COLUMNS) as f64);
            let mut sums = [DVec3::ZERO; 2];
            for place in 0..PLACES * PLACES {
                let [x, y] =
                    [place % PLACES, place / PLACES].map(|i| (i as f64 + 0.5) / PLACES as f64);
                let of = reflectance((column + x) / COLUMNS as f64, (row + y) / ROWS as f64);
                sums[0] += of[0];
                sums[1] += of[1];
            }
            sums.map(|sum| sum / (PLACES * PLACES) as f64)
        };
        let (all, ground) = (0..COLUMNS * ROWS).map(cell).map(<(_, _)>::from).unzip();
        Self {
            all: Cells(all),
            ground: Cells(ground),
        }
    }
}

impl Cells {
    /// The reflectance about a place, between the means of the cells about it: `u` 0…1 from 180° W eastwards, `v` 0…1 from the
    /// north pole.
    pub fn at(&self, u: f64, v: f64) -> DVec3 {
        let (x, y) = (u * COLUMNS as f64 - 0.5, v * ROWS as f64 - 0.5);
        let cell = |dx: f64, dy: f64| {
            let column = (x.floor() + dx).rem_euclid(COLUMNS as f64) as usize % COLUMNS;
            let row = (y.floor() + dy).clamp(0.0, (ROWS - 1) as f64) as usize;
            self.0[row * COLUMNS + column]
        };
        let (right, down) = (x - x.floor(), y - y.floor());
        cell(0.0, 0.0)
            .lerp(cell(1.0, 0.0), right)
            .lerp(cell(0.0, 1.0).lerp(cell(1.0, 1.0), right), down)
    }
}
