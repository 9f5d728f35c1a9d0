//! A grid of heights and the positions of its samples in space.

use crate::elevation::{Bounds, HeightRange};
use glam::{DVec2, DVec3};
use terrella_frames::Ellipsoid;

/// Largest number of samples of a grid: 16 385 × 16 385.
pub const MAX_SAMPLES: u64 = 16_385 * 16_385;

/// Heights or sizes that are rejected.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DemError {
    /// The sizes do not match the number of heights, are 0, or too large.
    #[error(
        "a DEM of {columns} × {rows} samples came with {heights} heights; it needs 1 to 268 468 225 and as many as it says"
    )]
    Size {
        columns: u32,
        rows: u32,
        /// Number of heights given.
        heights: usize,
    },
    /// A height is not finite, or beyond ±10⁶ m.
    #[error(
        "the DEM's height in column {column}, row {row} is {height_m}; it must be within ±1 000 000 m (fill voids first)"
    )]
    Height {
        /// Column, from the west, starting at 0.
        column: u32,
        /// Row, from the south, starting at 0.
        row: u32,
        /// The given height.
        height_m: f32,
    },
    /// Steps of a flat grid are not positive, or bounds are wider than 90° or empty.
    #[error(
        "the DEM's bounds are invalid: steps must be positive and bounds less than a quarter turn each way"
    )]
    Place,
}

/// How columns, rows and heights become positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DemFrame {
    /// x east, y north, z up, metres, the south-west sample at x = y = 0.
    Flat {
        /// Distances between columns and between rows, metres.
        step_m: DVec2,
    },
    /// On the ellipsoid, heights along its normal. Positions are ITRF metres from [`Dem::origin_m`].
    Geodetic {
        /// Figure of the Earth that heights are measured from.
        ellipsoid: Ellipsoid,
        /// From the first to the last sample, both ways.
        bounds: Bounds,
    },
}

/// Half-space: the points p with n·p ≥ d.
pub type HalfSpace = (DVec3, f64);

/// Samples `[west, east, south, north]`, the last ones inclusive.
pub type Span = [u32; 4];

/// A grid of heights, metres, row by row from the south, each from the west.
#[derive(Clone, Debug, PartialEq)]
pub struct Dem {
    columns: u32,
    rows: u32,
    heights_m: Vec<f32>,
    frame: DemFrame,
    range: HeightRange,
    origin_m: DVec3,
    up: DVec3,
    /// (cos, sin) of each column's longitude.
    meridians: Vec<DVec2>,
    /// (cos, sin) of each row's latitude and (distance from the axis, z) of its surface points.
    parallels: Vec<(DVec2, DVec2)>,
}

impl Dem {
    /// Makes a grid of 1 × 1 or more. Rows run from the south northwards.
    pub fn new(
        columns: u32,
        rows: u32,
        heights_m: Vec<f32>,
        frame: DemFrame,
    ) -> Result<Self, DemError> {
        let samples = u64::from(columns) * u64::from(rows);
        if samples == 0 || samples > MAX_SAMPLES || samples != heights_m.len() as u64 {
            return Err(DemError::Size {
                columns,
                rows,
                heights: heights_m.len(),
            });
        }
        let mut range = HeightRange {
            low_m: f64::INFINITY,
            high_m: f64::NEG_INFINITY,
        };
        for (k, height_m) in heights_m.iter().enumerate() {
            if !(-1e6..=1e6).contains(height_m) {
                return Err(DemError::Height {
                    column: k as u32 % columns,
                    row: k as u32 / columns,
                    height_m: *height_m,
                });
            }
            range.low_m = range.low_m.min(f64::from(*height_m));
            range.high_m = range.high_m.max(f64::from(*height_m));
        }
        let mut dem = Self {
            columns,
            rows,
            heights_m,
            frame,
            range,
            origin_m: DVec3::ZERO,
            up: DVec3::Z,
            meridians: Vec::new(),
            parallels: Vec::new(),
        };
        match frame {
            DemFrame::Flat { step_m } => {
                let usable = |step: f64| (1e-6..=1e7).contains(&step);
                if !usable(step_m.x) || !usable(step_m.y) {
                    return Err(DemError::Place);
                }
            }
            DemFrame::Geodetic { ellipsoid, bounds } => dem.place(&ellipsoid, &bounds)?,
        }
        Ok(dem)
    }

    fn place(&mut self, ellipsoid: &Ellipsoid, bounds: &Bounds) -> Result<(), DemError> {
        let quarter = std::f64::consts::FRAC_PI_2;
        let tall = bounds.north_rad - bounds.south_rad;
        let usable = bounds.south_rad.abs() <= quarter
            && bounds.north_rad.abs() <= quarter
            && (0.0..=quarter).contains(&tall)
            && (0.0..=quarter).contains(&bounds.width_rad)
            && bounds.west_rad.is_finite();
        if !usable {
            return Err(DemError::Place);
        }
        let part = |k: u32, n: u32| f64::from(k) / f64::from((n - 1).max(1));
        self.meridians = (0..self.columns)
            .map(|i| {
                let lon = bounds.west_rad + bounds.width_rad * part(i, self.columns);
                DVec2::new(lon.cos(), lon.sin())
            })
            .collect();
        self.parallels = (0..self.rows)
            .map(|j| {
                let lat = bounds.south_rad + tall * part(j, self.rows);
                let surface = ellipsoid.surface_point(Ellipsoid::normal(lat, 0.0));
                (
                    DVec2::new(lat.cos(), lat.sin()),
                    DVec2::new(surface.x, surface.z),
                )
            })
            .collect();
        let lat = bounds.south_rad + 0.5 * tall;
        self.up = Ellipsoid::normal(lat, bounds.west_rad + 0.5 * bounds.width_rad);
        self.origin_m = ellipsoid.surface_point(self.up);
        Ok(())
    }

    /// Extends the columns so that they contain their corners at these heights too. Neighbours with the same extension overlap there,
    /// whatever their own heights.
    pub fn reaching(mut self, heights: HeightRange) -> Self {
        self.range.low_m = self.range.low_m.min(heights.low_m);
        self.range.high_m = self.range.high_m.max(heights.high_m);
        self
    }

    /// Lowest and highest of the heights, including those of [`Self::reaching`].
    pub fn range_m(&self) -> HeightRange {
        self.range
    }

    /// Origin of positions: 0 for a flat grid, otherwise ITRF metres.
    pub fn origin_m(&self) -> DVec3 {
        self.origin_m
    }

    /// Unit vector upwards at the grid's middle.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// All samples.
    pub fn span(&self) -> Span {
        [0, self.columns - 1, 0, self.rows - 1]
    }

    /// A height, metres; indices beyond the edge are clamped.
    pub fn height_m(&self, i: i64, j: i64) -> f64 {
        let i = i.clamp(0, i64::from(self.columns) - 1) as usize;
        let j = j.clamp(0, i64::from(self.rows) - 1) as usize;
        f64::from(self.heights_m[j * self.columns as usize + i])
    }

    /// Position of column i and row j at a height, metres from [`Self::origin_m`].
    pub fn lifted_m(&self, i: u32, j: u32, height_m: f64) -> DVec3 {
        match self.frame {
            DemFrame::Flat { step_m } => {
                DVec3::new(f64::from(i) * step_m.x, f64::from(j) * step_m.y, height_m)
            }
            DemFrame::Geodetic { .. } => {
                let (lon, (lat, surface)) =
                    (self.meridians[i as usize], self.parallels[j as usize]);
                let rho = surface.x + height_m * lat.x;
                DVec3::new(rho * lon.x, rho * lon.y, surface.y + height_m * lat.y) - self.origin_m
            }
        }
    }

    /// Position of a sample, metres from [`Self::origin_m`].
    pub fn point_m(&self, i: u32, j: u32) -> DVec3 {
        self.lifted_m(i, j, self.height_m(i64::from(i), i64::from(j)))
    }

    /// The column of space over a span: west, east, south, north.
    ///
    /// Flat grid: its four walls. On the ellipsoid meridians are planes, which contain all their normals. Parallels are cones; each is
    /// replaced by the plane along the normal at the edge's middle. That plane is moved out until the column contains its corners at every
    /// height of the grid. Columns of neighbours in latitude then overlap by the sagitta of their edge, w² tan φ/8R: 2 cm for 1 km at 45°.
    pub fn column(&self, [west, east, south, north]: Span) -> [HalfSpace; 4] {
        match self.frame {
            DemFrame::Flat { step_m } => {
                let (x, y) = (step_m.x, step_m.y);
                [
                    (DVec3::X, f64::from(west) * x),
                    (-DVec3::X, -f64::from(east) * x),
                    (DVec3::Y, f64::from(south) * y),
                    (-DVec3::Y, -f64::from(north) * y),
                ]
            }
            DemFrame::Geodetic { .. } => {
                let (w, e) = (self.meridians[west as usize], self.meridians[east as usize]);
                let middle = (w + e).normalize_or(w);
                let side = |n: DVec3| (n, -n.dot(self.origin_m));
                let cross = |j: u32, sign: f64| {
                    let (lat, _) = self.parallels[j as usize];
                    let n = DVec3::new(-lat.y * middle.x, -lat.y * middle.y, lat.x) * sign;
                    let mut d = f64::INFINITY;
                    for i in [west, east] {
                        for height in [self.range.low_m, self.range.high_m] {
                            d = d.min(n.dot(self.lifted_m(i, j, height)));
                        }
                    }
                    let (_, s) = self.parallels[j as usize];
                    let on = DVec3::new(s.x * middle.x, s.x * middle.y, s.y) - self.origin_m;
                    (n, d.min(n.dot(on)))
                };
                [
                    side(DVec3::new(-w.y, w.x, 0.0)),
                    side(DVec3::new(e.y, -e.x, 0.0)),
                    cross(south, 1.0),
                    cross(north, -1.0),
                ]
            }
        }
    }
}

/// Properties of whole grids that are measured.
impl Dem {
    /// Samples from west to east.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Samples from south to north.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// All heights, metres, row by row from the south.
    pub fn heights_m(&self) -> &[f32] {
        &self.heights_m
    }

    /// How columns, rows and heights become positions.
    pub fn frame(&self) -> DemFrame {
        self.frame
    }
}

/// Cells of a span; a direction without width counts as one.
pub fn cells([west, east, south, north]: Span) -> u64 {
    u64::from(east - west).max(1) * u64::from(north - south).max(1)
}

/// Divides a span at its middle sample: one to four spans that share their edges, south-west first. A direction with one cell is not cut;
/// `None` if neither can be.
///
/// The cut of a range of cells depends on the range alone, so neighbours at one depth have the same cuts whatever the grid's size.
pub fn quarters([west, east, south, north]: Span) -> Option<([Span; 4], usize)> {
    let (x, y) = (west + (east - west) / 2, south + (north - south) / 2);
    let mut out = [[0; 4]; 4];
    let mut count = 0;
    let halves = |low: u32, cut: u32, high: u32| {
        if cut > low {
            ([(low, cut), (cut, high)], 2)
        } else {
            ([(low, high); 2], 1)
        }
    };
    let ((xs, nx), (ys, ny)) = (halves(west, x, east), halves(south, y, north));
    if nx * ny == 1 {
        return None;
    }
    for (s, n) in &ys[..ny] {
        for (w, e) in &xs[..nx] {
            out[count] = [*w, *e, *s, *n];
            count += 1;
        }
    }
    Some((out, count))
}
