//! The elevation data of a scene: stacked grids over the sea or over tiles of a source.

use super::Joins;
use super::basins;
use super::land::LandShares;
use super::tiles::TilePyramid;
use super::{Bounds, Elevation, HeightGrid, HeightRange};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt;
use std::sync::Arc;

/// Cells of the Earth used to find the grids of a place, along a parallel and along a meridian.
const COLUMNS: usize = 72;
const ROWS: usize = 36;

/// Stacked grids, the finest on top, over a flat sea at height 0 or over the tiles of a [`StreamedGround`](super::StreamedGround).
///
/// **Overlaps**: of two grids the one with the finer [`HeightGrid::finest_spacing_rad`] is on top. Of equal ones, the first given is on top. A grid
/// that does not cover the whole Earth is feathered. Over its outermost samples it blends smoothly into the source beneath. The feather is a
/// sixteenth of the width and height, and at least [`FEATHER_SAMPLES`](super::FEATHER_SAMPLES). The same applies around unfilled holes. Heights are
/// therefore continuous everywhere. Where another grid of similar spacing (within a factor of 2) continues, a grid is not feathered. Tiles that share
/// their outermost posts, that touch, or that are up to a sample apart form one ground. Of two grids of cells, the nearer one determines the height
/// between their outermost samples.
///
/// **Spacings**: each grid averages its own samples; an average does not extend over a grid's border.
///
/// A query costs one grid lookup plus a few nanoseconds for each grid over the same part (5° × 5°) of the Earth.
#[derive(Clone)]
pub struct Ground {
    /// From the top down.
    grids: Arc<[Arc<HeightGrid>]>,
    /// Joins of each grid with others.
    joins: Arc<[Joins]>,
    /// Indices of the grids that overlap each part, from the top down.
    parts: Arc<[Vec<u32>]>,
    /// Whether heights of grids of the whole Earth stay at or above the sea.
    has_sea_surface: bool,
    /// Map of the land that may be slightly below the sea.
    land: Option<Arc<LandShares>>,
    /// Tiles beneath the grids in place of the sea.
    tiles: Option<Arc<TilePyramid>>,
}

impl fmt::Debug for Ground {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Ground")
            .field("grids", &self.grids)
            .field("has_sea_surface", &self.has_sea_surface)
            .field("has_tiles", &self.tiles.is_some())
            .finish()
    }
}

impl Ground {
    /// Grids in any order; none for a sea only.
    pub fn new(grids: impl IntoIterator<Item = Arc<HeightGrid>>) -> Self {
        let mut grids: Vec<_> = grids.into_iter().collect();
        // Stable: equal grids keep their order.
        grids.sort_by(|a, b| a.finest_spacing_rad().total_cmp(&b.finest_spacing_rad()));
        let placements: Vec<_> = grids.iter().map(|grid| grid.placement()).collect();
        let joins = Joins::of(&placements);
        let mut parts = vec![Vec::new(); COLUMNS * ROWS];
        for (number, grid) in grids.iter().enumerate() {
            let bounds = grid.bounds();
            for (part, numbers) in parts.iter_mut().enumerate() {
                if bounds.overlaps(&part_bounds(part)) {
                    numbers.push(number as u32);
                }
            }
        }
        Self {
            grids: grids.into(),
            joins: joins.into(),
            parts: parts.into(),
            has_sea_surface: false,
            land: None,
            tiles: None,
        }
    }

    /// The same grids over tiles in place of the sea or of earlier tiles.
    pub(super) fn over_tiles(&self, tiles: Arc<TilePyramid>) -> Self {
        Self {
            tiles: Some(tiles),
            ..self.clone()
        }
    }

    /// The same with the sea surface in place of the sea floor. Heights of tiles and of grids of the whole Earth are then at least 0.
    /// Known basins of dry land, such as Turpan and the Jordan valley, are excepted. Other grids keep their heights. With the map `land`,
    /// heights down to −10 m stay where the map has land: polders, deltas and others.
    pub fn with_sea_surface(mut self, land: Option<Arc<LandShares>>) -> Self {
        self.has_sea_surface = true;
        self.land = land;
        self
    }

    /// The lowest height drawn at a place where the sea surface replaces the floor, metres.
    #[inline]
    fn lowest_m(&self, lat_rad: f64, lon_rad: f64) -> f64 {
        let of_basins_m = basins::lowest_m(lat_rad, lon_rad);
        match &self.land {
            Some(land) => of_basins_m.min(land.lowest_m(lat_rad, lon_rad)),
            None => of_basins_m,
        }
    }

    /// A lower bound of the same within bounds.
    fn lowest_in_m(&self, bounds: &Bounds) -> f64 {
        let of_land_m = self
            .land
            .as_ref()
            .map_or(0.0, |land| land.lowest_in_m(bounds));
        basins::lowest_in_m(bounds).min(of_land_m)
    }

    /// Whether heights of a grid below the sea are hidden.
    #[inline]
    fn hides_floor_of(&self, grid: &HeightGrid) -> bool {
        self.has_sea_surface && grid.bounds().width_rad >= TAU - 1e-9
    }

    /// A grid's height as drawn.
    #[inline]
    fn drawn_m(&self, grid: &HeightGrid, height_m: f64, lat_rad: f64, lon_rad: f64) -> f64 {
        if height_m > 0.0 || !self.hides_floor_of(grid) {
            return height_m;
        }
        height_m.max(self.lowest_m(lat_rad, lon_rad))
    }

    /// The height of the source beneath all grids.
    #[inline]
    fn beneath_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
        match &self.tiles {
            Some(tiles) => {
                let height_m = tiles.height_m(lat_rad, lon_rad, spacing_rad);
                if height_m > 0.0 || !self.has_sea_surface {
                    return height_m;
                }
                height_m.max(self.lowest_m(lat_rad, lon_rad))
            }
            None => 0.0,
        }
    }

    /// The grids, from the top down.
    pub fn grids(&self) -> &[Arc<HeightGrid>] {
        &self.grids
    }

    /// Bytes of all grids.
    pub fn bytes(&self) -> u64 {
        self.grids.iter().map(|grid| grid.stats().bytes).sum()
    }

    /// The grids that may cover a place, from the top down.
    #[inline]
    fn at(&self, lat_rad: f64, lon_rad: f64) -> impl Iterator<Item = (&HeightGrid, &Joins)> {
        let part = self.parts.get(part_of(lat_rad, lon_rad));
        let numbers = part.map_or(&[][..], Vec::as_slice);
        numbers
            .iter()
            .map(|number| *number as usize)
            .map(|number| (self.grids[number].as_ref(), &self.joins[number]))
    }
}

impl From<HeightGrid> for Ground {
    fn from(grid: HeightGrid) -> Self {
        Self::new([Arc::new(grid)])
    }
}

impl Elevation for Ground {
    #[inline]
    fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
        if !(lat_rad.is_finite() && lon_rad.is_finite()) {
            return 0.0;
        }
        if let [grid] = &*self.grids {
            return match grid.weighted(lat_rad, lon_rad, spacing_rad, &self.joins[0]) {
                Some((height_m, weight)) if self.tiles.is_none() || weight >= 1.0 => {
                    weight * self.drawn_m(grid, height_m, lat_rad, lon_rad)
                }
                Some((height_m, weight)) => {
                    let beneath_m = self.beneath_m(lat_rad, lon_rad, spacing_rad);
                    weight * self.drawn_m(grid, height_m, lat_rad, lon_rad)
                        + (1.0 - weight) * beneath_m
                }
                None => self.beneath_m(lat_rad, lon_rad, spacing_rad),
            };
        }
        if self.grids.is_empty() {
            // As below: avoids a negative zero.
            return 0.0 + self.beneath_m(lat_rad, lon_rad, spacing_rad);
        }
        let (mut height_m, mut beneath) = (0.0, 1.0);
        for (grid, joins) in self.at(lat_rad, lon_rad) {
            if let Some((of_grid_m, weight)) = grid.weighted(lat_rad, lon_rad, spacing_rad, joins) {
                let drawn_m = self.drawn_m(grid, of_grid_m, lat_rad, lon_rad);
                height_m += beneath * weight * drawn_m;
                beneath *= 1.0 - weight;
                if beneath <= 0.0 {
                    return height_m;
                }
            }
        }
        if self.tiles.is_some() {
            height_m += beneath * self.beneath_m(lat_rad, lon_rad, spacing_rad);
        }
        height_m
    }

    fn range_m(&self, bounds: &Bounds) -> HeightRange {
        self.range_of(bounds, f64::INFINITY, true)
    }

    fn range_up_to_m(&self, bounds: &Bounds, coarsest_rad: f64) -> HeightRange {
        self.range_of(bounds, coarsest_rad, false)
    }

    fn finest_spacing_rad(&self, lat_rad: f64, lon_rad: f64) -> f64 {
        if !(lat_rad.is_finite() && lon_rad.is_finite()) {
            return f64::INFINITY;
        }
        for (grid, joins) in self.at(lat_rad, lon_rad) {
            let weight = grid.joined_weight(lat_rad, lon_rad, joins);
            if weight >= 1.0 {
                return grid.detail_rad();
            }
            if weight > 0.0 {
                return match &self.tiles {
                    Some(tiles) => {
                        let beneath_rad = tiles.finest_spacing_rad(lat_rad, lon_rad);
                        grid.finest_spacing_rad().min(beneath_rad)
                    }
                    None => grid.finest_spacing_rad(),
                };
            }
        }
        match &self.tiles {
            Some(tiles) => tiles.finest_spacing_rad(lat_rad, lon_rad),
            None => f64::INFINITY,
        }
    }

    fn finest_spacing_in(&self, bounds: &Bounds) -> f64 {
        let beneath_rad = || match &self.tiles {
            Some(tiles) => tiles.finest_spacing_in(bounds),
            None => f64::INFINITY,
        };
        for grid in self.grids.iter() {
            if !grid.bounds().overlaps(bounds) {
                continue;
            }
            return match grid.rules(bounds) {
                true => grid.detail_rad(),
                false => grid.finest_spacing_rad().min(beneath_rad()),
            };
        }
        beneath_rad()
    }
}

impl Ground {
    /// The range of the current heights, or of all heights at any later time.
    fn range_of(&self, bounds: &Bounds, coarsest_rad: f64, is_ever: bool) -> HeightRange {
        let (mut low_m, mut high_m) = (f64::INFINITY, f64::NEG_INFINITY);
        for grid in self.grids.iter() {
            if !grid.bounds().overlaps(bounds) {
                continue;
            }
            let range = grid.range_m(bounds, coarsest_rad);
            let floor_m = match self.hides_floor_of(grid) {
                true => self.lowest_in_m(bounds),
                false => f64::NEG_INFINITY,
            };
            low_m = low_m.min(range.low_m.max(floor_m));
            high_m = high_m.max(range.high_m.max(floor_m));
            if grid.rules(bounds) {
                return HeightRange { low_m, high_m };
            }
        }
        let beneath = match &self.tiles {
            Some(tiles) => tiles.range_m(bounds, coarsest_rad, is_ever),
            None => HeightRange {
                low_m: 0.0,
                high_m: 0.0,
            },
        };
        let floor_m = match self.has_sea_surface {
            true => self.lowest_in_m(bounds),
            false => f64::NEG_INFINITY,
        };
        HeightRange {
            low_m: low_m.min(beneath.low_m.max(floor_m)),
            high_m: high_m.max(beneath.high_m.max(floor_m)),
        }
    }
}

/// The part of the Earth that contains a place.
#[inline]
fn part_of(lat_rad: f64, lon_rad: f64) -> usize {
    // Negative numbers saturate at 0.
    let row = ((FRAC_PI_2 - lat_rad) * (ROWS as f64 / std::f64::consts::PI)) as usize;
    let turns = lon_rad * (1.0 / TAU);
    let column = ((turns - turns.floor()) * COLUMNS as f64) as usize;
    row.min(ROWS - 1) * COLUMNS + column.min(COLUMNS - 1)
}

/// Bounds of a part with a margin for rounding.
fn part_bounds(part: usize) -> Bounds {
    const MORE: f64 = 1e-9;
    let height = std::f64::consts::PI / ROWS as f64;
    let width = TAU / COLUMNS as f64;
    let north_rad = FRAC_PI_2 - (part / COLUMNS) as f64 * height;
    Bounds {
        south_rad: north_rad - height - MORE,
        north_rad: north_rad + MORE,
        west_rad: (part % COLUMNS) as f64 * width - MORE,
        width_rad: width + 2.0 * MORE,
    }
}
