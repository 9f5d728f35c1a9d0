//! Cells of the forest: 16 × 8 blocks of 22.5°, each a quadtree.

use crate::elevation::Bounds;
use crate::globe::{Block, COLUMNS, ROWS};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_8, PI};
use terrella_frames::Ellipsoid;

/// Deepest level: cells of 2.4 m.
pub const MAX_LEVEL: u8 = 20;
/// Segments along an edge of a cell.
pub const SEGMENTS: u32 = 8;
/// Bicubic patches along an edge of a cell: two segments each.
pub const PIECES: u32 = 4;
/// Lattice steps in a block: one for each vertex of the deepest cells.
const BLOCK_STEPS: u32 = SEGMENTS << MAX_LEVEL;
/// Lattice steps around the equator and from pole to pole.
pub const AROUND: u32 = COLUMNS * BLOCK_STEPS;
/// See [`AROUND`].
pub const TALL: u32 = ROWS * BLOCK_STEPS;
/// Angle of a lattice step.
pub const STEP_RAD: f64 = FRAC_PI_8 / BLOCK_STEPS as f64;

/// A cell. x from 180° W eastwards, y from the south pole northwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// 0 is a block.
    pub level: u8,
    /// 0…16·2^level − 1.
    pub x: u32,
    /// 0…8·2^level − 1.
    pub y: u32,
}

impl Cell {
    /// Level and place as one number: the key of maps of cells.
    pub fn key(self) -> u64 {
        u64::from(self.level) << 56 | u64::from(self.y) << 28 | u64::from(self.x)
    }

    /// The cell of a [`Self::key`].
    pub fn of_key(key: u64) -> Self {
        Self {
            level: (key >> 56) as u8,
            x: (key & 0xfff_ffff) as u32,
            y: (key >> 28 & 0xfff_ffff) as u32,
        }
    }

    /// Angle of the cell's side, radians.
    pub fn side_rad(self) -> f64 {
        f64::from(self.steps()) * STEP_RAD
    }

    /// All 128 blocks.
    pub fn roots() -> impl Iterator<Item = Self> {
        (0..COLUMNS * ROWS).map(|k| Self {
            level: 0,
            x: k % COLUMNS,
            y: k / COLUMNS,
        })
    }

    /// South-west, south-east, north-west, north-east.
    pub fn children(self) -> [Self; 4] {
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| Self {
            level: self.level + 1,
            x: 2 * self.x + x,
            y: 2 * self.y + y,
        })
    }

    /// The parent cell; a block is its own parent.
    pub fn parent(self) -> Self {
        if self.level == 0 {
            return self;
        }
        Self {
            level: self.level - 1,
            x: self.x / 2,
            y: self.y / 2,
        }
    }

    /// The adjacent cell at the same level, also across the date line; `None` beyond a pole.
    pub fn beside(self, dx: i32, dy: i32) -> Option<Self> {
        let (around, tall) = (COLUMNS << self.level, ROWS << self.level);
        let y = self.y.checked_add_signed(dy).filter(|y| *y < tall)?;
        let x = (self.x + around).wrapping_add_signed(dx) % around;
        Some(Self { x, y, ..self })
    }

    /// Lattice steps along an edge.
    pub fn steps(self) -> u32 {
        BLOCK_STEPS >> self.level
    }

    /// Lattice point of vertex (i, j), 0…[`SEGMENTS`] from the south-west.
    pub fn vertex(self, i: u32, j: u32) -> [u32; 2] {
        let step = self.steps() / SEGMENTS;
        [
            (self.x * self.steps() + i * step) % AROUND,
            self.y * self.steps() + j * step,
        ]
    }

    /// Lattice point of a corner: 0…3 as in [`Self::children`].
    pub fn corner(self, k: usize) -> [u32; 2] {
        self.vertex((k as u32 & 1) * SEGMENTS, (k as u32 >> 1) * SEGMENTS)
    }

    /// Rectangle of longitude and latitude that the cell covers.
    pub fn bounds(self) -> Bounds {
        let [x, y] = self.vertex(0, 0);
        let width_rad = f64::from(self.steps()) * STEP_RAD;
        Bounds {
            south_rad: lat_rad(y),
            north_rad: lat_rad(y + self.steps()),
            west_rad: lon_rad(x),
            width_rad,
        }
    }

    /// The block that contains the cell.
    pub fn block(self) -> Block {
        Block {
            column: self.x >> self.level,
            row: ROWS - 1 - (self.y >> self.level),
        }
    }

    /// A power of two, metres. Positions that only this cell holds are multiples of it. The origin is a multiple too, within
    /// [`ORIGIN_STEP_M`] of [`ORIGIN_HEIGHT_M`]. Relative to it, the positions fit into the 24 bits of an f32 for all ground from −13 to
    /// +11 km. The grain is 12 cm for a block, and 1 mm from level 10 on.
    pub fn grain_m(self) -> f64 {
        let reach_m = 2e6 / f64::from(1u32 << self.level) + 12e3 + ORIGIN_STEP_M;
        (reach_m / f64::from(1u32 << 24)).log2().ceil().exp2()
    }
}

/// Origins of patches are multiples of this, metres, so that a GPU represents them exactly up to 16 000 km from the eye. A power of two, no
/// finer than any grain.
pub const ORIGIN_STEP_M: f64 = 1.0;

/// Height of the origins of patches, in the middle of the Earth's range of heights.
pub const ORIGIN_HEIGHT_M: f64 = -1_000.0;

/// Latitude of a lattice row, radians; exact at the poles.
pub fn lat_rad(y: u32) -> f64 {
    if y >= TALL {
        return FRAC_PI_2;
    }
    f64::from(y) * STEP_RAD - FRAC_PI_2
}

/// Longitude of a lattice column, radians.
pub fn lon_rad(x: u32) -> f64 {
    f64::from(x % AROUND) * STEP_RAD - PI
}

/// (cos, sin) of a row's latitude; the cosine is exactly 0 at the poles.
pub fn cos_sin_lat(y: u32) -> (f64, f64) {
    match y {
        0 => (0.0, -1.0),
        TALL => (0.0, 1.0),
        _ => {
            let (s, c) = lat_rad(y).sin_cos();
            (c, s)
        }
    }
}

/// Depth of the middle of a square below its corners from the Earth's curvature alone, metres: the chord of each side below its arc, both
/// ways.
pub fn chord_m(ellipsoid: &Ellipsoid, arc_rad: f64) -> f64 {
    0.25 * arc_rad * arc_rad * ellipsoid.equatorial_radius_m
}

/// A cell as a ball, for culling and distances.
pub fn ball(ellipsoid: &Ellipsoid, cell: Cell, low_m: f64, high_m: f64) -> (DVec3, f64) {
    let half = SEGMENTS / 2;
    let at = |i: u32, j: u32, height_m: f64| {
        let [x, y] = cell.vertex(i, j);
        let (c, s) = cos_sin_lat(y);
        let (lon_s, lon_c) = lon_rad(x).sin_cos();
        let n = DVec3::new(c * lon_c, c * lon_s, s);
        ellipsoid.surface_point(n) + n * height_m
    };
    let center = at(half, half, 0.5 * (low_m + high_m));
    let mut radius_m = 0.0f64;
    for j in [0, half, SEGMENTS] {
        for i in [0, half, SEGMENTS] {
            for height_m in [low_m, high_m] {
                radius_m = radius_m.max(center.distance(at(i, j, height_m)));
            }
        }
    }
    // Between the nine points an edge bulges by at most the sagitta of a quarter of it.
    let quarter = 0.25 * f64::from(cell.steps()) * STEP_RAD;
    (
        center,
        radius_m + 0.5 * quarter * quarter * ellipsoid.equatorial_radius_m,
    )
}
