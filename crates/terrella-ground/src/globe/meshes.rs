//! Level of detail (LOD) of the smooth globe's mesh: as fine as the limb needs in this image, and no finer.

use super::blocks::{BlockGrid, SubdivisionError};
use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;
use terrella_frames::Ellipsoid;

/// Number of cells along a block's edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Subdivision {
    /// Chosen for each image from 2, 4, 6, 12, 24 and 48: the fewest that keep the drawn limb within [`LIMB_PX`] of the true one. With
    /// tiles at least 24.
    #[default]
    Auto,
    /// A fixed number, 1…48; the paper's is 6.
    Cells(u32),
}

impl fmt::Display for Subdivision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Cells(cells) => cells.fmt(f),
        }
    }
}

/// Largest distance by which [`Subdivision::Auto`] lets the drawn limb be inside the true one, pixels.
pub const LIMB_PX: f64 = 0.4;

/// The choices of [`Subdivision::Auto`].
const AUTO_CELLS: [u32; 6] = [2, 4, 6, 12, 24, 48];
/// Fewest cells for an eye that is not above the ground: a coarser mesh would be far below it.
const CELLS_BELOW_GROUND: u32 = 6;

/// Upper bound of how far a mesh's limb is inside the true one, in pixels of `pixel_rad`, for an eye `height_m` above the ground. At and
/// below the ground there is no limb, and the result is 0.
///
/// Facets are inscribed: the middle of a cell is δ = R(1 − cos(11.25°/n)) below the sphere along either edge, so up to 2δ in all. The limb
/// is √(h(2R + h)) away.
pub fn limb_error_px(cells: u32, radius_m: f64, height_m: f64, pixel_rad: f64) -> f64 {
    if height_m <= 0.0 {
        return 0.0;
    }
    let limb_m = height_m.sqrt() * (2.0 * radius_m + height_m).sqrt();
    sagitta(cells) * radius_m / (limb_m * pixel_rad)
}

/// Largest depth of a facet's middle below a sphere of radius 1, for blocks with `cells` cells an edge: 2δ.
pub fn sagitta(cells: u32) -> f64 {
    let half_cell_rad = PI / (16.0 * f64::from(cells.max(1)));
    // 1 − cos x = 2 sin²(x/2).
    4.0 * (0.5 * half_cell_rad).sin().powi(2)
}

/// The grids that an Earth is drawn with, coarsest first, one at a time. Clones share the grids, and each clone makes its own choice.
#[derive(Clone)]
pub struct Meshes {
    grids: Arc<[BlockGrid]>,
    current: usize,
}

impl Meshes {
    /// All grids of a subdivision. `Auto` includes none with fewer than `least` cells.
    ///
    /// # Errors
    /// Cells outside 1…48.
    pub fn new(
        ellipsoid: Ellipsoid,
        subdivision: Subdivision,
        least: u32,
    ) -> Result<Self, SubdivisionError> {
        let cells = match subdivision {
            Subdivision::Cells(cells) => vec![cells],
            Subdivision::Auto => {
                let cells = AUTO_CELLS.into_iter();
                cells.filter(|cells| *cells >= least).collect()
            }
        };
        let grids = cells.into_iter().map(|n| BlockGrid::new(ellipsoid, n));
        Ok(Self {
            grids: grids.collect::<Result<_, _>>()?,
            current: 0,
        })
    }

    /// Selects the coarsest grid that keeps the limb within [`LIMB_PX`] and has at least `least_cells` cells, or else the finest. Returns
    /// its index in [`Self::grids`].
    pub fn select_lod(&mut self, height_m: f64, pixel_rad: f64, least_cells: u32) -> usize {
        let keeps_limb = |grid: &BlockGrid| {
            let radius_m = grid.ellipsoid().equatorial_radius_m;
            let cells = grid.subdivision();
            let is_sound = height_m > 0.0 || cells >= CELLS_BELOW_GROUND;
            let keeps = limb_error_px(cells, radius_m, height_m, pixel_rad) <= LIMB_PX;
            is_sound && cells >= least_cells && keeps
        };
        let finest = self.grids.len() - 1;
        self.current = self.grids.iter().position(keeps_limb).unwrap_or(finest);
        self.current
    }

    /// The grid of the last selection.
    pub fn grid(&self) -> &BlockGrid {
        &self.grids[self.current]
    }

    /// The grid with `cells` cells a block edge, if there is one.
    pub fn with_cells(&self, cells: u32) -> Option<&BlockGrid> {
        self.grids.iter().find(|grid| grid.subdivision() == cells)
    }

    /// All grids, coarsest first.
    pub fn grids(&self) -> &[BlockGrid] {
        &self.grids
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS_M: f64 = 6_378_137.0;

    #[test]
    fn the_error_is_that_of_the_sagitta() {
        // Cells of 22.5°/6: 6378 km (1 − cos 1.875°) = 3.415 km, twice, over a limb 1134 km away in pixels of a milliradian.
        let error = limb_error_px(6, RADIUS_M, 1e5, 1e-3);
        assert!((error - 2.0 * 3414.9 / 1133.8).abs() < 0.01, "{error}");
        // Twice as many cells, a quarter of the error; no limb on the ground.
        assert!((limb_error_px(12, RADIUS_M, 1e5, 1e-3) / error - 0.25).abs() < 1e-3);
        assert_eq!(limb_error_px(6, RADIUS_M, 0.0, 1e-3), 0.0);
        assert_eq!(limb_error_px(6, RADIUS_M, -1.0, 1e-3), 0.0);
    }

    #[test]
    fn the_mesh_is_finer_near_the_ground_and_in_narrow_views() {
        let mut meshes = Meshes::new(Ellipsoid::WGS84, Subdivision::Auto, 1).expect("sound");
        let mut cells = |height_m, pixel_rad| {
            meshes.select_lod(height_m, pixel_rad, 0);
            meshes.grid().subdivision()
        };
        let pixel_rad = 1.6e-3;
        assert_eq!(cells(3.8e8, pixel_rad), 2);
        assert_eq!(cells(2e7, pixel_rad), 4);
        assert_eq!(cells(7e6, pixel_rad), 6);
        assert_eq!(cells(4e5, pixel_rad), 24);
        assert_eq!(cells(1e3, pixel_rad), 48);
        assert_eq!(cells(2e7, 1e-6), 48);
        assert_eq!(cells(-5.0, pixel_rad), 6);
        let tiled = Meshes::new(Ellipsoid::WGS84, Subdivision::Auto, 24).expect("sound");
        assert_eq!(tiled.grids().len(), 2);
        assert!(Meshes::new(Ellipsoid::WGS84, Subdivision::Cells(49), 6).is_err());
    }
}
