//! The pyramid of height tiles: the choice of level and tiles, and a bounded cache of them for the GPU form.
//!
//! Level l ≥ 1 has 2^l × 2^(l−1) tiles of latitude and longitude, each of 64 × 64 cells, 65 × 65 samples; neighbours share their edges.
//! Samples per square radian: d_l = 4^(l−1) d₁. A region of area s (latitude × longitude, as in the paper) is loaded at level
//! ⌊log₄(m/(d₁ s)) + 1⌋. It then needs at most m samples.
//!
//! The paper loads one level for the whole image, which is too coarse near the eye when the horizon is in view. The rule is therefore
//! applied to nested windows. Level l is wanted where samples of the grid are close enough to need it. That window is cut about the closest
//! of them until the rule gives it l.
//!
//! Near a pole a window of all longitudes has many tiles, and is cut: a coarser level covers the rest of the 360°.

use super::{Caster, GridFrame};
use crate::elevation::{Bounds, Elevation, HeightChange};
use crate::globe::culling::is_within_angle;
use crate::globe::surface::{LEVELS, NO_SLOT, TILE_CELLS, TILE_SAMPLES, WINDOW_TILES};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use terrella_frames::Ellipsoid;

/// m of the paper: largest number of samples that a window may need.
pub const WINDOW_SAMPLES: f64 = 36.0 * (TILE_CELLS * TILE_CELLS) as f64;

/// Angle between samples of a level (from 1), radians.
pub fn level_spacing_rad(level: u32) -> f64 {
    PI / f64::from(TILE_CELLS) / f64::from(level.saturating_sub(1).min(60)).exp2()
}

/// d₁: samples of level 1 per square radian.
pub fn first_density() -> f64 {
    level_spacing_rad(1).powi(-2)
}

/// ⌊log₄(m/(d₁ s)) + 1⌋, from 1 to `finest`: the level at which an area of s square radians needs at most m samples.
pub fn pyramid_level(samples: f64, first_density: f64, area: f64, finest: u32) -> u32 {
    let level = (samples / (first_density * area)).log2() * 0.5 + 1.0;
    // Zero area needs the finest level; NaN gives the coarsest.
    (level.floor().max(1.0) as u32).min(finest.max(1))
}

/// A tile of the pyramid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeightTile {
    /// Level, from 1.
    pub level: u32,
    /// Column, from 180° W eastwards.
    pub column: u32,
    /// Row, from the south pole northwards.
    pub row: u32,
}

/// The part of a level that is searched for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileWindow {
    /// Its first column, 0…2^l − 1, and row.
    pub first: (u32, u32),
    /// Columns and rows; columns continue across the date line.
    pub size: (u32, u32),
    /// Slot of each tile, row by row, or [`NO_SLOT`].
    pub slots: [u32; WINDOW_TILES],
}

impl TileWindow {
    const NONE: Self = Self {
        first: (0, 0),
        size: (0, 0),
        slots: [NO_SLOT; WINDOW_TILES],
    };
}

/// Counts of an update.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileCounts {
    /// Tiles that the view needs.
    pub wanted: u32,
    /// Wanted tiles that this update loaded.
    pub loaded: u32,
    /// Wanted tiles that are still missing; a later update loads them.
    pub missing: u32,
    /// Wanted tiles that are drawn with outdated heights; a later update loads them again.
    pub stale: u32,
    /// Evicted tiles.
    pub evicted: u32,
}

#[derive(Clone, Copy, Debug)]
struct Slot {
    tile: Option<HeightTile>,
    used: u64,
    /// Heights have changed since the tile was loaded.
    is_stale: bool,
}

/// Height tiles in a bounded number of slots.
#[derive(Debug)]
pub struct HeightTiles {
    slots: Vec<Slot>,
    /// By slot, the update that loaded the tile.
    written: Vec<u64>,
    heights: Vec<f32>,
    windows: [TileWindow; LEVELS],
    changed: Vec<u32>,
    update: u64,
}

/// A place where the grid needs heights.
#[derive(Clone, Copy)]
struct Need {
    lat_rad: f64,
    /// Longitude from the eye's, −π…π.
    east_rad: f64,
    level: u32,
}

/// Tiles are averaged over less than requested, because interpolation between their samples averages once more. A box of half the width s
/// has the variance s²/3. With interpolation between samples 2s apart it becomes s², and with this factor s²/2.
pub const SHARPER: f64 = 0.7;

/// Stride of the grid samples that are tested, each way.
const STRIDE: usize = 4;

impl HeightTiles {
    /// Makes a cache of `slots` tiles (at least 16) and allocates all memory at once: 16.9 kB each.
    pub fn new(slots: u32) -> Self {
        let slots = slots.clamp(16, 65_535) as usize;
        Self {
            slots: vec![
                Slot {
                    tile: None,
                    used: 0,
                    is_stale: false,
                };
                slots
            ],
            written: vec![0; slots],
            heights: vec![0.0; slots * (TILE_SAMPLES * TILE_SAMPLES) as usize],
            windows: [TileWindow::NONE; LEVELS],
            changed: Vec::with_capacity(slots),
            update: 0,
        }
    }

    /// Bytes of heights and tables.
    pub fn resident_bytes(&self) -> usize {
        size_of_val(self.heights.as_slice())
            + size_of_val(self.slots.as_slice())
            + size_of_val(self.written.as_slice())
            + self.changed.capacity() * 4
            + size_of::<Self>()
    }

    /// Number of slots, equal to the layers of an array texture.
    pub fn slot_count(&self) -> u32 {
        self.slots.len() as u32
    }

    /// Slots written by the last update.
    pub fn changed(&self) -> &[u32] {
        &self.changed
    }

    /// Number of the update that last wrote each slot, 0 for none.
    pub fn written(&self) -> &[u64] {
        &self.written
    }

    /// Heights of all slots, metres.
    pub fn heights_m(&self) -> &[f32] {
        &self.heights
    }

    /// Heights of a slot, metres: 65 rows from the south, each from the west.
    pub fn slot(&self, slot: u32) -> &[f32] {
        let size = (TILE_SAMPLES * TILE_SAMPLES) as usize;
        &self.heights[slot as usize * size..][..size]
    }

    /// The window of each level, the coarsest first.
    pub fn windows(&self) -> &[TileWindow; LEVELS] {
        &self.windows
    }

    /// Finds the tiles that a frame needs and loads missing ones, the coarsest first, at most `max_loads`.
    pub fn update(
        &mut self,
        frame: &GridFrame,
        ground: &dyn Elevation,
        max_loads: u32,
    ) -> TileCounts {
        self.update += 1;
        self.changed.clear();
        self.choose_windows(frame, ground);
        let mut counts = TileCounts::default();
        for level in 1..=LEVELS as u32 {
            let index = level as usize - 1;
            let TileWindow { first, size, .. } = self.windows[index];
            for k in 0..size.0 * size.1 {
                let tile = HeightTile {
                    level,
                    column: (first.0 + k % size.0) % (1 << level),
                    row: first.1 + k / size.0,
                };
                if level > 1 && !may_show(&tile, frame) {
                    continue;
                }
                counts.wanted += 1;
                let may_load = counts.loaded < max_loads;
                self.windows[index].slots[k as usize] =
                    self.find_or_load(tile, ground, may_load, &mut counts);
            }
        }
        counts
    }

    fn find_or_load(
        &mut self,
        tile: HeightTile,
        ground: &dyn Elevation,
        may_load: bool,
        counts: &mut TileCounts,
    ) -> u32 {
        if let Some(slot) = self.slots.iter().position(|slot| slot.tile == Some(tile)) {
            self.slots[slot].used = self.update;
            // The old heights are drawn until there is time to load the tile again.
            if self.slots[slot].is_stale && may_load {
                counts.loaded += 1;
                self.load(slot, tile, ground);
            } else {
                counts.stale += u32::from(self.slots[slot].is_stale);
            }
            return slot as u32;
        }
        // The least recently used slot, if it is not needed now.
        let oldest = self
            .slots
            .iter()
            .enumerate()
            .min_by_key(|(_, slot)| slot.used);
        let Some((slot, _)) = oldest.filter(|(_, slot)| may_load && slot.used < self.update) else {
            counts.missing += 1;
            return NO_SLOT;
        };
        counts.evicted += u32::from(self.slots[slot].tile.is_some());
        counts.loaded += 1;
        self.load(slot, tile, ground);
        slot as u32
    }

    /// Marks the tiles whose heights may have changed.
    pub fn heights_changed(&mut self, changes: &[HeightChange]) {
        for slot in &mut self.slots {
            let Some(tile) = slot.tile else {
                continue;
            };
            let step_rad = level_spacing_rad(tile.level);
            let side_rad = step_rad * f64::from(TILE_CELLS);
            let south_rad = f64::from(tile.row) * side_rad - FRAC_PI_2;
            let bounds = Bounds {
                south_rad,
                north_rad: south_rad + side_rad,
                west_rad: f64::from(tile.column) * side_rad - PI,
                width_rad: side_rad,
            };
            slot.is_stale |= changes
                .iter()
                .any(|change| change.touches(&bounds, 0.0, 0.5 * step_rad));
        }
    }

    fn load(&mut self, slot: usize, tile: HeightTile, ground: &dyn Elevation) {
        self.slots[slot] = Slot {
            tile: Some(tile),
            used: self.update,
            is_stale: false,
        };
        self.written[slot] = self.update;
        self.changed.push(slot as u32);
        let step = level_spacing_rad(tile.level);
        let size = TILE_SAMPLES as usize;
        let heights = &mut self.heights[slot * size * size..][..size * size];
        for (k, height) in heights.iter_mut().enumerate() {
            let at = |tile: u32, k: usize| f64::from(tile * TILE_CELLS + k as u32) * step;
            let lat_rad = at(tile.row, k / size) - FRAC_PI_2;
            let lon_rad = at(tile.column, k % size) - PI;
            *height = ground.height_m(lat_rad, lon_rad, 0.5 * step) as f32;
        }
    }

    fn choose_windows(&mut self, frame: &GridFrame, ground: &dyn Elevation) {
        self.windows = [TileWindow::NONE; LEVELS];
        let (_, lon_eye) = eye_place(&frame.caster);
        // Samples of tiles differ from those of the data, whose surface may bend between its samples. With eight times as many samples, a
        // sixty-fourth of the bend is lost.
        let finest = |lat_rad, lon_rad| {
            let finest_rad = ground.finest_spacing_rad(lat_rad, lon_rad);
            (level_of(0.125 * finest_rad).ceil() + 1.0).clamp(1.0, LEVELS as f64)
        };
        let finest = &finest;
        let needs = || {
            let (columns, rows) = frame.samples;
            (0..rows).step_by(STRIDE).flat_map(move |row| {
                (0..columns).step_by(STRIDE).map(move |column| {
                    let sample = frame.sample(column, row);
                    let normal = (sample.place / frame.caster.radii_m).normalize();
                    let lon_rad = normal.y.atan2(normal.x);
                    let lat_rad = normal.z.atan2(normal.truncate().length());
                    let level = level_of(SHARPER * sample.spacing_rad).ceil().max(1.0);
                    Need {
                        lat_rad,
                        east_rad: (lon_rad - lon_eye + PI).rem_euclid(TAU) - PI,
                        level: level.min(finest(lat_rad, lon_rad)) as u32,
                    }
                })
            })
        };
        let mut low = [DVec2::INFINITY; LEVELS];
        let mut high = [DVec2::NEG_INFINITY; LEVELS];
        let mut focus = (0, DVec2::ZERO);
        for need in needs() {
            let at = DVec2::new(need.east_rad, need.lat_rad);
            for level in 0..need.level as usize {
                low[level] = low[level].min(at);
                high[level] = high[level].max(at);
            }
            if need.level > focus.0 {
                focus = (need.level, at);
            }
        }
        for level in 1..=LEVELS as u32 {
            let index = level as usize - 1;
            if low[index].x > high[index].x {
                break;
            }
            let step = level_spacing_rad(level);
            // A margin for the samples between the tested ones.
            let (mut from, mut to) = (low[index] - 2.0 * step, high[index] + 2.0 * step);
            let area = (to - from).element_product();
            if pyramid_level(WINDOW_SAMPLES, first_density(), area, LEVELS as u32) < level {
                // The side of a square of m samples, at most as long as the window.
                let side = WINDOW_SAMPLES.sqrt() * step;
                let half = (0.5 * (to - from)).min(DVec2::splat(0.5 * side));
                let center = focus.1.clamp(from + half, to - half);
                (from, to) = (center - half, center + half);
            }
            self.windows[index] = window(level, from, to, lon_eye);
        }
        // Level 1 is the whole Earth, so that every place has a height.
        self.windows[0] = TileWindow {
            first: (0, 0),
            size: (2, 1),
            slots: [NO_SLOT; WINDOW_TILES],
        };
    }

    /// The height at a place, averaged over about `spacing_rad` to each side, from the loaded tiles. It interpolates between the two levels
    /// whose samples are averaged over less and over more. The shader computes the same; this is in f64.
    pub fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
        let level = level_of(SHARPER * spacing_rad).clamp(1.0, LEVELS as f64);
        let (coarse, part) = (level.floor(), level.fract());
        let at = |level: f64| {
            (1..=level as u32)
                .rev()
                .find_map(|level| self.bilinear(level, lat_rad, lon_rad))
                .unwrap_or(0.0)
        };
        let height_m = at(coarse);
        if part > 0.0 {
            height_m + (at(coarse + 1.0) - height_m) * part
        } else {
            height_m
        }
    }

    fn bilinear(&self, level: u32, lat_rad: f64, lon_rad: f64) -> Option<f64> {
        let window = &self.windows[level as usize - 1];
        let step = level_spacing_rad(level);
        let cells = f64::from(TILE_CELLS);
        let period = (f64::from(level)).exp2() * cells;
        let west = f64::from(window.first.0) * cells;
        let south = f64::from(window.first.1) * cells;
        let x = ((lon_rad + PI) / step - west).rem_euclid(period);
        let y = ((lat_rad + FRAC_PI_2) / step - south).min(f64::from(window.size.1) * cells - 1e-3);
        let (column, row) = ((x / cells).floor(), (y / cells).floor());
        let inside = column < f64::from(window.size.0) && y >= 0.0;
        let at = (row * f64::from(window.size.0) + column) as usize;
        let slot = *window
            .slots
            .get(at)
            .filter(|slot| inside && **slot != NO_SLOT)?;
        let heights = self.slot(slot);
        let (x, y) = (x - column * cells, y - row * cells);
        let (i, j) = (x.floor() as usize, y.floor() as usize);
        let height = |i: usize, j: usize| f64::from(heights[j * TILE_SAMPLES as usize + i]);
        let mix = |a: f64, b: f64, part: f64| a + (b - a) * part;
        let south = mix(height(i, j), height(i + 1, j), x.fract());
        let north = mix(height(i, j + 1), height(i + 1, j + 1), x.fract());
        Some(mix(south, north, y.fract()))
    }
}

/// The level (from 1, with a fraction) whose samples are averaged over `spacing_rad` to each side.
pub fn level_of(spacing_rad: f64) -> f64 {
    1.0 + (level_spacing_rad(1) / (2.0 * spacing_rad).max(1e-12)).log2()
}

/// Latitude and longitude of the ground on the eye's radius.
pub fn eye_place(caster: &Caster) -> (f64, f64) {
    let normal = (caster.up / caster.radii_m).normalize();
    (
        normal.z.atan2(normal.truncate().length()),
        normal.y.atan2(normal.x),
    )
}

/// The tiles of a level over a rectangle of (longitude from the eye's, latitude), at most [`WINDOW_TILES`].
fn window(level: u32, from: DVec2, to: DVec2, lon_eye: f64) -> TileWindow {
    let side = level_spacing_rad(level) * f64::from(TILE_CELLS);
    let columns_in_all = 1_u32 << level;
    let rows_in_all = 1_u32 << (level - 1);
    let west = ((from.x + lon_eye + PI) / side).floor();
    let east = ((to.x + lon_eye + PI) / side).floor();
    let row = |lat: f64| {
        ((lat + FRAC_PI_2) / side)
            .floor()
            .clamp(0.0, f64::from(rows_in_all - 1))
    };
    let (south, north) = (row(from.y), row(to.y));
    let mut columns = ((east - west + 1.0) as u32).min(columns_in_all);
    let mut rows = ((north - south + 1.0) as u32).min(rows_in_all);
    let (mut first_column, mut first_row) = (west, south as u32);
    // Cut evenly on both sides, the longer dimension first.
    while (columns * rows) as usize > WINDOW_TILES {
        if columns >= rows {
            first_column += f64::from(columns % 2);
            columns -= 1;
        } else {
            first_row += rows % 2;
            rows -= 1;
        }
    }
    TileWindow {
        first: (
            first_column.rem_euclid(f64::from(columns_in_all)) as u32,
            first_row,
        ),
        size: (columns, rows),
        slots: [NO_SLOT; WINDOW_TILES],
    }
}

/// Whether any ground of a tile can be visible: the visible region's test for a cap about the tile.
fn may_show(tile: &HeightTile, frame: &GridFrame) -> bool {
    let side = level_spacing_rad(tile.level) * f64::from(TILE_CELLS);
    let place = |column: f64, row: f64| -> DVec3 {
        let normal = Ellipsoid::normal(row * side - FRAC_PI_2, column * side - PI);
        (normal * frame.caster.radii_m).normalize()
    };
    let (column, row) = (f64::from(tile.column), f64::from(tile.row));
    let center = place(column + 0.5, row + 0.5);
    // The farthest point of a rectangle of latitude and longitude is at most half the sum of its sides away.
    let reach = 1.01 * side;
    is_within_angle(center, frame.caster.up, frame.caster.far_rad + reach)
}
