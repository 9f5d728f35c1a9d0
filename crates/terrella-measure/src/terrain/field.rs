//! Heights that are measured: of a file, or synthetic.

use super::TerrainError;
use super::contours::{Dem, DemError, DemFrame};
use glam::DVec2;
use std::path::Path;
use terrella::frames::Ellipsoid;
use terrella_ground::elevation::{Bounds, GridLimits, fractal_heights_m, open_heights};

/// A fractal ground made by midpoint displacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SyntheticGround {
    /// Posts of a side: one more than a power of two.
    pub side: u32,
    /// Another one is another ground.
    pub seed: u64,
}

/// Of a synthetic ground, metres between posts.
const SYNTHETIC_SPACING_M: f64 = 90.0;
/// Of a synthetic terrain: the displacement of its last midpoints, metres, and its ratio to that of the previous subdivision: 2^-0.8, as rough as
/// mountains. A larger terrain has the same roughness: 1 500 m for 2049 posts.
const DISPLACEMENT: (f64, f64) = (3.4, 0.574_349_177_498_517_5);

/// An elevation grid, its rows from the north.
#[derive(Clone, Debug)]
pub(super) struct HeightField {
    /// As in tables and names of files.
    pub name: String,
    pub columns: u32,
    pub rows: u32,
    pub heights_m: Vec<f32>,
    pub extent: Extent,
}

/// Position of a field.
#[derive(Clone, Copy, Debug)]
pub(super) enum Extent {
    /// On a plane, so many metres between samples.
    Plane(f64),
    /// On the ellipsoid, from the first to the last sample each way.
    Earth(Bounds),
}

impl HeightField {
    /// All samples of a file.
    pub fn open(path: &Path) -> Result<Self, TerrainError> {
        let file = open_heights(path, &GridLimits::default())?;
        let grid = file.grid;
        let (columns, rows) = grid.size();
        let holes = grid.stats().holes;
        if holes > 0 {
            tracing::warn!(
                "{}: {holes} samples have no data; heights from about them are taken",
                path.display()
            );
        }
        let samples = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let heights_m = samples.map(|(column, row)| grid.sample_m(column, row) as f32);
        let field = Self {
            name: name_of(path),
            columns,
            rows,
            heights_m: heights_m.collect(),
            extent: Extent::Earth(grid.sample_bounds()),
        };
        // A field that is too wide is reported before anything is built.
        field.dem().map_err(|error| TerrainError::Field {
            path: path.to_owned(),
            error,
        })?;
        Ok(field)
    }

    /// A synthetic ground, in whole metres as files mostly are.
    pub fn synthetic(ground: SyntheticGround) -> Self {
        let SyntheticGround { side, seed } = ground;
        let (last_m, factor) = DISPLACEMENT;
        let halvings = side.saturating_sub(1).max(1).ilog2();
        let first_m = last_m / factor.powi(halvings as i32);
        let heights_m = fractal_heights_m(side, seed, first_m, factor);
        Self {
            name: format!("made-{seed}"),
            columns: side,
            rows: side,
            heights_m: heights_m.into_iter().map(|z| z.round() as f32).collect(),
            extent: Extent::Plane(SYNTHETIC_SPACING_M),
        }
    }

    /// Every `step`-th sample each way, from the north-western one.
    pub fn subsampled(&self, step: u32) -> Self {
        let (columns, rows) = ((self.columns - 1) / step + 1, (self.rows - 1) / step + 1);
        let row = |j: u32| {
            let from = (j * step) as usize * self.columns as usize;
            (0..columns).map(move |i| self.heights_m[from + (i * step) as usize])
        };
        let part = |kept: u32, all: u32| {
            f64::from((kept - 1) * step) / f64::from(all.saturating_sub(1).max(1))
        };
        let extent = match self.extent {
            Extent::Plane(spacing_m) => Extent::Plane(spacing_m * f64::from(step)),
            Extent::Earth(bounds) => {
                let tall_rad = bounds.north_rad - bounds.south_rad;
                Extent::Earth(Bounds {
                    south_rad: bounds.north_rad - tall_rad * part(rows, self.rows),
                    width_rad: bounds.width_rad * part(columns, self.columns),
                    ..bounds
                })
            }
        };
        Self {
            name: self.name.clone(),
            columns,
            rows,
            heights_m: (0..rows).flat_map(row).collect(),
            extent,
        }
    }

    /// Itself and each half of the one before, down to 129 samples on the shorter side; at least itself.
    pub fn sizes(&self) -> Vec<Self> {
        let mut sizes = vec![self.clone()];
        let mut step = 2;
        while (self.columns.min(self.rows) - 1) / step >= MIN_SIDE - 1 {
            sizes.push(self.subsampled(step));
            step *= 2;
        }
        sizes
    }

    /// `1025x1025`.
    pub fn size(&self) -> String {
        format!("{}x{}", self.columns, self.rows)
    }

    /// Between neighbouring samples of the tree on a plane, metres: of a file the mean of both ways, by their product.
    pub fn spacing_m(&self) -> f64 {
        match self.extent {
            Extent::Plane(spacing_m) => spacing_m,
            Extent::Earth(bounds) => {
                let gaps = |count: u32| f64::from(count.saturating_sub(1).max(1));
                let lat_rad = 0.5 * (bounds.north_rad + bounds.south_rad);
                let tall_rad = (bounds.north_rad - bounds.south_rad) / gaps(self.rows);
                let wide_rad = bounds.width_rad * lat_rad.cos() / gaps(self.columns);
                let metres = Ellipsoid::WGS84.equatorial_radius_m * (tall_rad * wide_rad).sqrt();
                metres.max(1e-3)
            }
        }
    }

    /// For contours and patches: rows from the south.
    pub fn dem(&self) -> Result<Dem, DemError> {
        let rows = self.heights_m.chunks_exact(self.columns as usize).rev();
        let heights_m = rows.flatten().copied().collect();
        let frame = match self.extent {
            Extent::Plane(spacing_m) => DemFrame::Flat {
                step_m: DVec2::splat(spacing_m),
            },
            Extent::Earth(bounds) => DemFrame::Geodetic {
                ellipsoid: Ellipsoid::WGS84,
                bounds,
            },
        };
        Dem::new(self.columns, self.rows, heights_m, frame)
    }
}

/// A field is not halved below this.
const MIN_SIDE: u32 = 129;

/// The file's name without its extension, safe in names of other files.
fn name_of(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let safe = |c: char| {
        if c.is_alphanumeric() || "-_".contains(c) {
            c
        } else {
            '_'
        }
    };
    stem.chars().map(safe).take(80).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_every_second_sample_at_the_same_place() {
        let bounds = Bounds {
            south_rad: 0.5,
            north_rad: 0.6,
            west_rad: 0.1,
            width_rad: 0.2,
        };
        let field = HeightField {
            name: "f".into(),
            columns: 300,
            rows: 261,
            heights_m: (0..300 * 261).map(|k| k as f32).collect(),
            extent: Extent::Earth(bounds),
        };
        let sizes = field.sizes();
        let said: Vec<_> = sizes.iter().map(HeightField::size).collect();
        assert_eq!(said, ["300x261", "150x131"]);
        let half = &sizes[1];
        assert_eq!(half.heights_m[151], 602.0);
        let Extent::Earth(of_half) = half.extent else {
            panic!("no place")
        };
        assert!((of_half.south_rad - 0.5).abs() < 1e-12);
        assert!((of_half.width_rad - 0.2 * 298.0 / 299.0).abs() < 1e-12);
        // The same sample has the same position, and the spacing is twice as large.
        let (fine, coarse) = (field.dem().unwrap(), half.dem().unwrap());
        let place = |dem: &Dem, i, j| dem.point_m(i, j) + dem.origin_m();
        assert!(place(&fine, 20, 260 - 40).distance(place(&coarse, 10, 130 - 20)) < 1e-6);
        assert!((half.spacing_m() / field.spacing_m() - 2.0).abs() < 1e-3);
        assert_eq!(name_of(Path::new("a/b c.ü.tif")), "b_c_ü");
    }
}
