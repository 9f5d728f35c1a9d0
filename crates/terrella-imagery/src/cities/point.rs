//! Points of light, and the cells that they are sorted into.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

/// The Earth's radius for distances within towns and texels, metres.
pub const EARTH_M: f64 = 6.371e6;
/// Mean light of a texel below which it has no point: six ten-thousandths of the starter pack's light are in such texels.
pub const LEAST_LIGHT: f32 = 2e-4;

/// A point light: a place, a district, a piece of road, or the sum of one or more texels. GPUs read this layout directly.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct CityLight {
    /// Normal of the ellipsoid there, unit, ITRF axes.
    pub up: Vec3,
    /// Square equatorial radii of ground that sends as much light up if it is as bright as the brightest lamps and of this colour.
    pub light: f32,
    /// Linear RGB of its lamps, 0…255, all of the luminance ½.
    pub color: [u8; 3],
    /// How far its lamps are spread, 0…255 meaning 0…[`Self::MOST_RADIUS_M`].
    pub radius: u8,
}

impl CityLight {
    /// Most that lamps of a point are spread, metres.
    pub const MOST_RADIUS_M: f64 = 2550.0;

    /// A point with these lamps, linear RGB of 0…1, spread so far.
    pub fn new(up: Vec3, light: f32, color: Vec3, radius_m: f64) -> Self {
        let byte = |part: f32| (255.0 * part).round().clamp(0.0, 255.0) as u8;
        Self {
            up,
            light,
            color: color.to_array().map(byte),
            radius: byte((radius_m / Self::MOST_RADIUS_M) as f32),
        }
    }
}

/// Columns and rows of cells.
pub const CELL_COLUMNS: usize = 64;
pub const CELL_ROWS: usize = 32;
/// How many cells there are.
pub const CITY_CELLS: usize = CELL_COLUMNS * CELL_ROWS;

/// Location of a cell's points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CityCell {
    /// Its number.
    pub index: usize,
    /// Normal of the ellipsoid in its middle, unit, ITRF axes.
    pub up: DVec3,
    /// Normals of its places are at most so far from that, radians.
    pub radius_rad: f64,
}

impl CityCell {
    /// All cells, by their numbers. They are computed on first use.
    pub fn all() -> &'static [Self] {
        static ALL: LazyLock<Box<[CityCell]>> =
            LazyLock::new(|| (0..CITY_CELLS).map(CityCell::of).collect());
        &ALL
    }

    fn of(index: usize) -> Self {
        let (row, column) = (index / CELL_COLUMNS, index % CELL_COLUMNS);
        let (height_rad, width_rad) = (PI / CELL_ROWS as f64, TAU / CELL_COLUMNS as f64);
        let lat_rad = 0.5 * PI - (row as f64 + 0.5) * height_rad;
        let nearest_equator = (lat_rad.abs() - 0.5 * height_rad).cos();
        Self {
            index,
            up: up_at(
                (column as f64 + 0.5) / CELL_COLUMNS as f64,
                (row as f64 + 0.5) / CELL_ROWS as f64,
            ),
            radius_rad: 0.5 * height_rad.hypot(width_rad * nearest_equator),
        }
    }
}

/// The cell of a place on a map, by the parts of its width from the west and of its height from the north.
pub fn cell_of(u: f64, v: f64) -> u32 {
    let (row, column) = (
        (v * CELL_ROWS as f64) as usize,
        (u * CELL_COLUMNS as f64) as usize,
    );
    (row.min(CELL_ROWS - 1) * CELL_COLUMNS + column.min(CELL_COLUMNS - 1)) as u32
}

/// The normal of the ellipsoid there.
pub fn up_at(u: f64, v: f64) -> DVec3 {
    let (sin_lat, cos_lat) = ((0.5 - v) * PI).sin_cos();
    let (sin_lon, cos_lon) = ((u - 0.5) * TAU).sin_cos();
    DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat)
}
