//! The lattice of 16 × 8 blocks, each of n × n cells.

use super::culling::ScaledRect;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_8, PI};
use terrella_frames::Ellipsoid;

/// Blocks around the equator, from 180° W eastwards.
pub const COLUMNS: u32 = 16;
/// Blocks from the north pole to the south pole.
pub const ROWS: u32 = 8;
pub const BLOCK_COUNT: u32 = COLUMNS * ROWS;

/// Largest number of cells per block edge.
const FINEST: u32 = 48;

/// Longitude and latitude span of a block: 22.5°, radians.
pub(super) const SPAN_RAD: f64 = FRAC_PI_8;

/// The requested subdivision is outside 1…48.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("subdivision is {0}; it must be from 1 to 48")]
pub struct SubdivisionError(pub u32);

/// One block's place in the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Block {
    /// 0…15, from 180° W eastwards.
    pub column: u32,
    /// 0…7, from the north pole southwards.
    pub row: u32,
}

impl Block {
    /// All 128 blocks, row by row.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..BLOCK_COUNT).map(Self::of_index)
    }

    /// The block of an index, 0…127.
    pub fn of_index(index: u32) -> Self {
        Self {
            column: index % COLUMNS,
            row: index / COLUMNS,
        }
    }

    /// 0…127, row by row.
    pub fn index(self) -> u32 {
        self.row * COLUMNS + self.column
    }

    /// Latitude of the centre, radians.
    pub fn center_lat_rad(self) -> f64 {
        (3.5 - f64::from(self.row)) * SPAN_RAD
    }

    /// Longitude of the centre, radians, −π … π.
    pub fn center_lon_rad(self) -> f64 {
        (f64::from(self.column) - 7.5) * SPAN_RAD
    }

    /// Texture coordinates of the centre on the whole map, u east from 180° W, v south from the north pole.
    pub fn center_uv(self) -> DVec2 {
        DVec2::new(
            (f64::from(self.column) + 0.5) / f64::from(COLUMNS),
            (f64::from(self.row) + 0.5) / f64::from(ROWS),
        )
    }

    /// The index list that the block is drawn with.
    pub fn kind(self) -> BlockRow {
        match self.row {
            0 => BlockRow::North,
            r if r == ROWS - 1 => BlockRow::South,
            _ => BlockRow::Middle,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlockSet(pub u128);

impl BlockSet {
    /// All 128 blocks.
    pub const ALL: Self = Self(u128::MAX);

    /// Whether a block, by its index, is in the set.
    pub fn contains(self, block: u8) -> bool {
        u32::from(block) < BLOCK_COUNT && self.0 >> block & 1 == 1
    }

    /// Adds a block by its index; indices beyond 127 are skipped.
    pub fn insert(&mut self, block: u8) {
        if u32::from(block) < BLOCK_COUNT {
            self.0 |= 1 << block;
        }
    }

    /// Number of blocks.
    pub fn len(self) -> u32 {
        self.0.count_ones()
    }

    /// Whether the set is empty.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// Blocks at a pole have one triangle, not two, in each cell that touches it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockRow {
    /// Touches the north pole.
    North,
    /// Touches no pole.
    Middle,
    /// Touches the south pole.
    South,
}

/// One row of cells as a band of planes in scaled space, all with the same tilt: n_ρ·ρ cos Δλ + n_z·z > d, where Δλ is measured from a
/// cell's middle meridian.
#[derive(Clone, Copy, Debug)]
pub(super) struct FacetBand {
    pub n_rho: f64,
    pub n_z: f64,
    pub d: f64,
}

/// The lattice in f64, with everything needed to choose and draw blocks.
///
/// Latitudes are geodetic, so that a cell's corners meet the texels of an equirectangular map; the paper's sphere is the case a = b.
/// Vertices on shared edges have identical bits, also across ±180°, and so do all vertices at a pole.
pub struct BlockGrid {
    ellipsoid: Ellipsoid,
    subdivision: u32,
    /// (8n + 1) rows of (16n + 1) positions, ITRF metres, north row first, the last column a copy of the first.
    lattice_itrf_m: Vec<DVec3>,
    pub(super) rects: Vec<ScaledRect>,
    pub(super) bands: Vec<FacetBand>,
}

/// (cos, sin) of `steps` × 22.5°/n, exact at multiples of 90°.
fn cos_sin(steps: i64, n: i64) -> DVec2 {
    let quarter = 4 * n;
    let (turns, rest) = (steps.div_euclid(quarter), steps.rem_euclid(quarter));
    let (s, c) = if rest == 0 {
        (0.0, 1.0)
    } else {
        (rest as f64 * SPAN_RAD / n as f64).sin_cos()
    };
    match turns.rem_euclid(4) {
        0 => DVec2::new(c, s),
        1 => DVec2::new(-s, c),
        2 => DVec2::new(-c, -s),
        _ => DVec2::new(s, -c),
    }
}

impl BlockGrid {
    /// The lattice with `subdivision` × `subdivision` cells a block (1…48; the paper's is 6).
    pub fn new(ellipsoid: Ellipsoid, subdivision: u32) -> Result<Self, SubdivisionError> {
        if !(1..=FINEST).contains(&subdivision) {
            return Err(SubdivisionError(subdivision));
        }
        Ok(Self::of_cells(ellipsoid, subdivision))
    }

    /// The lattice with the largest number of cells.
    pub fn finest(ellipsoid: Ellipsoid) -> Self {
        Self::of_cells(ellipsoid, FINEST)
    }

    fn of_cells(ellipsoid: Ellipsoid, subdivision: u32) -> Self {
        let n = i64::from(subdivision);
        let lons: Vec<DVec2> = (0..=16 * n)
            .map(|c| cos_sin(c % (16 * n) - 8 * n, n))
            .collect();
        let lats: Vec<DVec2> = (0..=8 * n).map(|r| cos_sin(4 * n - r, n)).collect();
        let mut lattice_itrf_m = Vec::with_capacity(lons.len() * lats.len());
        for lat in &lats {
            for lon in &lons {
                let normal = DVec3::new(lat.x * lon.x, lat.x * lon.y, lat.y);
                lattice_itrf_m.push(ellipsoid.surface_point(normal));
            }
        }
        // Parametric latitude of each lattice row: tan β = (b/a) tan φ.
        let parametric: Vec<DVec2> = lats
            .iter()
            .map(|lat| {
                DVec2::new(
                    ellipsoid.equatorial_radius_m * lat.x,
                    ellipsoid.polar_radius_m * lat.y,
                )
                .normalize()
            })
            .collect();
        let row_edge = |row: u32| parametric[(row * subdivision) as usize];
        let rects = Block::all()
            .map(|block| {
                let (sin, cos) = block.center_lon_rad().sin_cos();
                ScaledRect {
                    lon: DVec2::new(cos, sin),
                    half_width_rad: 0.5 * SPAN_RAD,
                    north: row_edge(block.row),
                    south: row_edge(block.row + 1),
                }
            })
            .collect();
        let h = (0.5 * SPAN_RAD / f64::from(subdivision)).cos();
        let bands = parametric
            .windows(2)
            .map(|pair| {
                let (a, b) = (pair[0], pair[1]);
                let (n_rho, n_z) = (a.y - b.y, (b.x - a.x) * h);
                FacetBand {
                    n_rho,
                    n_z,
                    d: n_rho * a.x * h + n_z * a.y,
                }
            })
            .collect();
        Self {
            ellipsoid,
            subdivision,
            lattice_itrf_m,
            rects,
            bands,
        }
    }

    /// Figure of the blocks.
    pub fn ellipsoid(&self) -> Ellipsoid {
        self.ellipsoid
    }

    /// Cells per block edge.
    pub fn subdivision(&self) -> u32 {
        self.subdivision
    }

    /// Latitude span of a cell, radians; its longitude span is the same.
    pub fn cell_rad(&self) -> f64 {
        SPAN_RAD / f64::from(self.subdivision)
    }

    /// Vertices of one block, (n + 1)².
    pub fn vertices_per_block(&self) -> u32 {
        (self.subdivision + 1) * (self.subdivision + 1)
    }

    pub fn triangles(&self, kind: BlockRow) -> u32 {
        let n = self.subdivision;
        2 * n * n - if kind == BlockRow::Middle { 0 } else { n }
    }

    /// One of a block's n + 1 vertex rows, west to east, ITRF metres. `row` counts from the north, 0…n.
    pub fn vertex_row(&self, block: Block, row: u32) -> &[DVec3] {
        let n = self.subdivision;
        let start = ((block.row * n + row) * (COLUMNS * n + 1) + block.column * n) as usize;
        &self.lattice_itrf_m[start..=start + n as usize]
    }

    /// A vertex: `i` from the west and `j` from the north, both 0…n. ITRF metres.
    pub fn vertex_itrf_m(&self, block: Block, i: u32, j: u32) -> DVec3 {
        self.vertex_row(block, j)[i as usize]
    }

    /// Geodetic latitude and longitude of a vertex, radians; the exact place of its texel.
    pub fn vertex_lat_lon_rad(&self, block: Block, i: u32, j: u32) -> (f64, f64) {
        let n = f64::from(self.subdivision);
        let lat = (4.0 - f64::from(block.row) - f64::from(j) / n) * SPAN_RAD;
        let lon = (f64::from(block.column) + f64::from(i) / n - 8.0) * SPAN_RAD;
        (lat, lon)
    }

    /// Outward unit normal of a vertex.
    pub fn vertex_normal(&self, block: Block, i: u32, j: u32) -> DVec3 {
        let (lat, lon) = self.vertex_lat_lon_rad(block, i, j);
        Ellipsoid::normal(lat, lon)
    }

    /// Texture coordinates of a vertex on the whole map: u = ½ + λ/2π, v = ½ − φ/π.
    pub fn vertex_uv(&self, block: Block, i: u32, j: u32) -> DVec2 {
        let (lat, lon) = self.vertex_lat_lon_rad(block, i, j);
        DVec2::new(0.5 + lon / (2.0 * PI), 0.5 - lat / PI)
    }

    /// Triangle list over a block's (n + 1)² vertices (row-major from the north-west), counter-clockwise from outside.
    pub fn indices(&self, kind: BlockRow) -> Vec<u16> {
        let n = self.subdivision;
        let mut out = Vec::with_capacity(3 * self.triangles(kind) as usize);
        for j in 0..n {
            for i in 0..n {
                self.push_cell(kind, (i, j), &mut out);
            }
        }
        out
    }

    /// Appends the triangles of one cell, `i` from the west and `j` from the north, to a list as [`Self::indices`] returns: two, or one at
    /// a pole.
    pub fn push_cell(&self, kind: BlockRow, (i, j): (u32, u32), out: &mut Vec<u16>) {
        let n = self.subdivision;
        let at = |i: u32, j: u32| (j * (n + 1) + i) as u16;
        let [nw, ne, sw, se] = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
        let is_south_pole = kind == BlockRow::South && j == n - 1;
        if !is_south_pole {
            out.extend([nw, sw, se]);
        }
        if !(kind == BlockRow::North && j == 0) {
            out.extend([nw, if is_south_pole { sw } else { se }, ne]);
        }
    }
}
