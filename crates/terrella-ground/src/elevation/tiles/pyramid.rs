//! A snapshot of the resident tiles, and the heights that follow from them.
//!
//! # Continuity in every state
//!
//! Let h_k be the heights of level k. Let D_k(p) be the distance of a place from the nearest non-resident tile of level k, in tiles of that level.
//! The heights down to level k are g_k = g_(k+1) + w_k (h_k − g_(k+1)). The weight is w_k = s(D_k / [`FEATHER`]), with s smooth from 0 to 1. The
//! coarsest level is always resident and unchanged.
//!
//! h_k is continuous where tiles of level k are resident, because tiles repeat samples of their neighbours. w_k is continuous everywhere, and 0 where
//! a tile ends. By induction g_k is continuous. D_k is not continuous towards the poles, where all meridians meet. All h_k therefore blend into one
//! height there.
//!
//! A tile is resident only if its parent is. The path down from the coarsest level therefore finds all tiles.

use super::held::HeldTile;
use super::{HeightTileKey, HeightTileLayout, HeightTileSource, Wants};
use crate::elevation::floor::floor;
use crate::elevation::{Bounds, HeightGrid, HeightRange};
use crate::step::smooth_step;
use std::cell::Cell;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

/// Fraction of a tile over which its heights blend into coarser ones beside a missing tile.
pub(in crate::elevation) const FEATHER: f64 = 0.25;

/// Marks an absent node.
pub(in crate::elevation) const NONE: u32 = u32::MAX;

/// Offsets of neighbouring tiles, eastwards and southwards, in bit order of [`Node::missing`].
pub(in crate::elevation) const BESIDE: [(i32, i32); 8] = [
    (-1, -1),
    (0, -1),
    (1, -1),
    (-1, 0),
    (1, 0),
    (-1, 1),
    (0, 1),
    (1, 1),
];

/// A range query visits tiles down to this fraction of the bounds, and uses the stored ranges below that.
const PART: f64 = 1.0 / 4.0;

/// Maximum tiles visited by a search for the finest data.
const MOST_SEARCHED: usize = 256;

/// A resident tile, or one of the coarsest level, whose heights are the grid's.
#[derive(Clone)]
pub(in crate::elevation) struct Node {
    pub key: HeightTileKey,
    /// `None` at the coarsest level.
    pub tile: Option<Arc<HeldTile>>,
    /// The parent node; [`NONE`] at the coarsest level.
    pub parent: u32,
    /// Nodes of its resident children.
    pub children: [u32; 4],
    /// Children that the source has, one bit each.
    pub exists: u8,
    /// Ranges of the source for those children, including all finer tiles.
    pub below: [[f32; 2]; 4],
    /// Non-resident neighbours, one bit each of [`BESIDE`]. A neighbour beyond a pole does not count.
    pub missing: u8,
    /// Requested children that are missing: bits 0…3 with an explicit spacing, 4…7 as the finest data.
    pub wanted: Arc<AtomicU8>,
}

/// A place in level coordinates.
#[derive(Clone, Copy)]
struct PyramidPoint {
    lat_rad: f64,
    lon_rad: f64,
    /// Sample steps of the finest level from 180° W and from the north pole.
    x: f64,
    y: f64,
}

impl PyramidPoint {
    /// The same in steps of a coarser level's samples: exact.
    #[inline]
    fn at(&self, level: u8) -> (f64, f64) {
        let scale = power_of_half(level);
        (self.x * scale, self.y * scale)
    }
}

/// All resident tiles. Immutable: a new pyramid replaces it when tiles load or are evicted.
#[derive(Clone)]
pub(in crate::elevation) struct TilePyramid {
    pub layout: HeightTileLayout,
    pub source: Arc<dyn HeightTileSource>,
    /// The coarsest level.
    pub base: Arc<HeightGrid>,
    /// The coarsest level's tiles first, row by row.
    pub nodes: Vec<Node>,
    /// Whether a missing tile was requested.
    pub has_wants: Arc<AtomicBool>,
    /// Requests for tiles below those.
    pub wants: Arc<Wants>,
    pub poles_m: [f64; 2],
    /// Range of all heights, now and later.
    pub range: HeightRange,
    /// Angle between samples of the finest level, radians.
    pub finest_rad: f64,
}

thread_local! {
    /// Node where [`TilePyramid::finest_over`] ended last. It may belong to any pyramid, because it
    /// is only a starting point.
    static LAST: Cell<u32> = const { Cell::new(0) };
}

/// 2^−`level`, exactly.
#[inline]
fn power_of_half(level: u8) -> f64 {
    f64::from_bits((1023 - u64::from(level)) << 52)
}

impl TilePyramid {
    #[inline]
    fn place(&self, lat_rad: f64, lon_rad: f64) -> PyramidPoint {
        let turns = (lon_rad + PI) * (1.0 / TAU);
        let turns = turns - floor(turns);
        // For a small negative number the difference from −1 rounds to 1.
        let turns = if turns >= 1.0 { 0.0 } else { turns };
        let down = ((FRAC_PI_2 - lat_rad) * (1.0 / PI)).clamp(0.0, 1.0);
        let side = f64::from(self.layout.side());
        PyramidPoint {
            lat_rad,
            lon_rad,
            x: turns * (f64::from(self.layout.columns(0)) * side),
            y: down * (f64::from(self.layout.rows(0)) * side),
        }
    }

    /// The tile of a level that contains a place.
    #[inline]
    fn key_at(&self, place: &PyramidPoint, level: u8) -> HeightTileKey {
        let (x, y) = place.at(level);
        let side = self.layout.side();
        HeightTileKey {
            level,
            column: (x as u32 / side).min(self.layout.columns(level) - 1),
            row: (y as u32 / side).min(self.layout.rows(level) - 1),
        }
    }

    pub(in crate::elevation) fn root(&self, key: HeightTileKey) -> u32 {
        key.row * self.layout.columns(key.level) + key.column
    }

    /// The height at a finite place; see [`crate::elevation::Elevation::height_m`].
    #[inline]
    pub fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
        let coarsest = self.layout.coarsest();
        let steps = spacing_rad / self.finest_rad;
        // True also for a NaN spacing.
        let (level, part) = if steps.is_nan() || steps <= 1.0 {
            (0, 0.0)
        } else {
            // steps = 2^level·(1 + part), read from the bits of the number.
            let level = (steps.to_bits() >> 52).saturating_sub(1023);
            let level = level.min(u64::from(coarsest)) as u8;
            (level, steps * power_of_half(level) - 1.0)
        };
        if level >= coarsest {
            let base_rad = spacing_rad / self.layout.spacing_rad(coarsest);
            return self
                .base
                .height_m(lat_rad, lon_rad, base_rad * self.base.finest_spacing_rad());
        }
        let place = self.place(lat_rad, lon_rad);
        let is_any = spacing_rad.is_nan() || spacing_rad <= 0.0;
        let at = self.finest_over(&place, level);
        let node = &self.nodes[at as usize];
        if node.key.level > level {
            self.want_below(node, &place, level, is_any);
            return self.blended(at, &place, is_any);
        }
        let fine_m = self.blended(at, &place, is_any);
        if part == 0.0 {
            return fine_m;
        }
        fine_m + part * (self.blended(node.parent, &place, is_any) - fine_m)
    }

    /// Whether a node's tile contains a place. May be false for places on the Earth's eastern and southern
    /// end.
    #[inline]
    fn holds(&self, node: &Node, place: &PyramidPoint) -> bool {
        let (x, y) = place.at(node.key.level);
        let side = self.layout.side();
        let is_within =
            |at: f64, tile: u32| (at as u32).wrapping_sub(tile.wrapping_mul(side)) < side;
        is_within(x, node.key.column) && is_within(y, node.key.row)
    }

    /// The quarter of a node that contains a place.
    #[inline]
    fn quarter_of(&self, node: &Node, place: &PyramidPoint) -> usize {
        let (x, y) = place.at(node.key.level - 1);
        let side = self.layout.side();
        let is_second = |at: f64, tile: u32| usize::from(at as u32 - 2 * tile * side >= side);
        is_second(y, node.key.row) << 1 | is_second(x, node.key.column)
    }

    /// The finest node over a place, down to a level.
    ///
    /// Consecutive queries are mostly close together. The search starts at the last node of this thread, goes up as far as needed, and then down.
    #[inline]
    fn finest_over(&self, place: &PyramidPoint, level: u8) -> u32 {
        let mut at = LAST.get();
        let mut node = match self.nodes.get(at as usize) {
            Some(node) if node.key.level >= level && self.holds(node, place) => node,
            _ => {
                at = self.coarser_over(at, place, level);
                &self.nodes[at as usize]
            }
        };
        while node.key.level > level {
            let child = node.children[self.quarter_of(node, place)];
            if child == NONE {
                break;
            }
            at = child;
            node = &self.nodes[at as usize];
        }
        LAST.set(at);
        at
    }

    /// The first ancestor that contains a place and is not finer than a level.
    fn coarser_over(&self, from: u32, place: &PyramidPoint, level: u8) -> u32 {
        let mut at = from;
        while let Some(node) = self.nodes.get(at as usize) {
            if node.key.level >= level && self.holds(node, place) {
                return at;
            }
            at = node.parent;
        }
        self.root(self.key_at(place, self.layout.coarsest()))
    }

    /// Records a request for finer tiles over a place, down to a level or as far as an eye can see them.
    #[inline]
    fn want_below(&self, node: &Node, place: &PyramidPoint, level: u8, is_any: bool) {
        let quarter = self.quarter_of(node, place);
        if node.exists >> quarter & 1 == 0 {
            return;
        }
        self.want(node, quarter, is_any);
        let level = match is_any {
            true => self
                .wants
                .level_seen(place.lat_rad, place.lon_rad, self.finest_rad),
            false => level,
        };
        if level + 1 < node.key.level {
            self.wants.note(self.key_at(place, level), is_any);
        }
    }

    /// Records a request for a child, if the source has it.
    #[inline]
    fn want(&self, node: &Node, quarter: usize, is_any: bool) {
        if node.exists >> quarter & 1 == 0 {
            return;
        }
        let bit = 1 << (quarter + if is_any { 4 } else { 0 });
        // Reads first: an unwritten cache line stays in every core's cache.
        if node.wanted.load(Ordering::Relaxed) & bit == 0 {
            node.wanted.fetch_or(bit, Ordering::Relaxed);
            self.has_wants.store(true, Ordering::Relaxed);
        }
    }

    /// g at a node's level.
    #[inline]
    fn blended(&self, node: u32, place: &PyramidPoint, is_any: bool) -> f64 {
        let (mut height_m, mut beneath) = (0.0, 1.0);
        let mut at = node;
        loop {
            let node = &self.nodes[at as usize];
            let Some(tile) = &node.tile else {
                let base_m = self.base.height_m(place.lat_rad, place.lon_rad, 0.0);
                return height_m + beneath * base_m;
            };
            let level = node.key.level;
            let (x, y) = place.at(level);
            let weight = match node.missing {
                0 => 1.0,
                _ => self.weight(node, x, y, is_any),
            };
            if weight > 0.0 {
                let rows = f64::from(self.layout.rows(level) * self.layout.side());
                height_m += beneath * weight * tile.height_m(x, y, rows, self.poles_m);
                beneath *= 1.0 - weight;
                if beneath <= 0.0 {
                    return height_m;
                }
            }
            at = node.parent;
        }
    }

    /// w at a place in a tile with missing neighbours. Records requests for those neighbours.
    fn weight(&self, node: &Node, x: f64, y: f64, is_any: bool) -> f64 {
        let side = f64::from(self.layout.side());
        let (u, v) = (
            x / side - f64::from(node.key.column),
            y / side - f64::from(node.key.row),
        );
        let away = |way: i32, at: f64| match way {
            -1 => at,
            0 => 0.0,
            _ => 1.0 - at,
        };
        let mut least = f64::INFINITY;
        for (bit, (east, south)) in BESIDE.into_iter().enumerate() {
            if node.missing >> bit & 1 == 0 {
                continue;
            }
            let distance = away(east, u).max(away(south, v)).max(0.0);
            if distance < FEATHER {
                least = least.min(distance);
                self.want_beside(node.key, (east, south), is_any);
            }
        }
        smooth_step([0.0, FEATHER], least)
    }

    /// Records a request for a tile's neighbour. If the neighbour's parent is missing too, it is a neighbour of this tile's
    /// parent, and is recorded when that is visited.
    fn want_beside(&self, key: HeightTileKey, (east, south): (i32, i32), is_any: bool) {
        let Some(beside) = self.layout.beside(key, east, south) else {
            return;
        };
        if let Some(parent) = self.find(beside.parent()) {
            self.want(&self.nodes[parent as usize], beside.quarter(), is_any);
        }
    }

    /// The node of a tile, if resident.
    pub fn find(&self, key: HeightTileKey) -> Option<u32> {
        let up = self.layout.coarsest().checked_sub(key.level)?;
        let over = |up: u8| HeightTileKey {
            level: key.level + up,
            column: key.column >> up,
            row: key.row >> up,
        };
        let mut at = self.root(over(up));
        for up in (0..up).rev() {
            at = self.nodes[at as usize].children[over(up).quarter()];
            if at == NONE {
                return None;
            }
        }
        Some(at)
    }

    /// Lowest and highest height inside bounds: of the current tiles, or at any time.
    pub fn range_m(&self, bounds: &Bounds, coarsest_rad: f64, is_ever: bool) -> HeightRange {
        let coarsest = self.layout.coarsest();
        let scale = self.base.finest_spacing_rad() / self.layout.spacing_rad(coarsest);
        let mut range = self.base.range_m(bounds, coarsest_rad * scale);
        if coarsest == 0 {
            return range;
        }
        let extent = (bounds.north_rad - bounds.south_rad).max(bounds.width_rad);
        let tile_rad = self.layout.tile_rad(coarsest);
        // The range of the whole Earth is stored.
        if is_ever && extent >= 0.9 * PI {
            return wider(range, self.range);
        }
        let (rows, columns) = (self.layout.rows(coarsest), self.layout.columns(coarsest));
        let row = |lat: f64| ((FRAC_PI_2 - lat) / tile_rad).clamp(0.0, f64::from(rows - 1)) as u32;
        let (north, south) = (row(bounds.north_rad + 1e-9), row(bounds.south_rad - 1e-9));
        // At a pole all columns meet, so all count.
        let is_polar = north == 0 || south + 1 == rows;
        let first = ((bounds.west_rad + PI) / tile_rad - 1e-6).floor();
        let count = match is_polar {
            true => columns,
            false => ((bounds.width_rad / tile_rad) as u32 + 2).min(columns),
        };
        let first = first.rem_euclid(f64::from(columns)) as u32;
        for row in north..=south {
            for column in (0..count).map(|k| (first + k) % columns) {
                let node = &self.nodes[(row * columns + column) as usize];
                if self.layout.bounds(node.key).meets(bounds) {
                    range = self.range_below(node, bounds, PART * extent, is_ever, range);
                }
            }
        }
        range
    }

    fn range_below(
        &self,
        node: &Node,
        bounds: &Bounds,
        least_rad: f64,
        is_ever: bool,
        mut range: HeightRange,
    ) -> HeightRange {
        let tile_rad = self.layout.tile_rad(node.key.level);
        if let Some(tile) = &node.tile {
            let own = self.layout.bounds(node.key);
            let step = self.layout.spacing_rad(node.key.level);
            let side = f64::from(self.layout.side());
            let north = (own.north_rad - bounds.north_rad) / step;
            let south = (own.north_rad - bounds.south_rad) / step;
            // Measured from the tile's middle, so that neither is mistaken for the other side of
            // the Earth.
            let from = own.west_rad + 0.5 * tile_rad;
            let middle = bounds.west_rad + 0.5 * bounds.width_rad;
            let off = (middle - from + PI).rem_euclid(TAU) - PI;
            let (west, east) = match bounds.width_rad + tile_rad >= PI {
                true => (0.0, side),
                false => {
                    let middle = off / step + 0.5 * side;
                    let half = 0.5 * bounds.width_rad / step;
                    (middle - half, middle + half)
                }
            };
            // Rounding of an angle must not drop a sample.
            let more = 1e-6;
            range = wider(
                range,
                tile.range_m(
                    ((west - more).max(0.0), (east + more).min(side)),
                    ((north - more).max(0.0), (south + more).min(side)),
                    // Finer parts are not resolved more closely either.
                    least_rad / step,
                ),
            );
            // Beyond the outermost rows heights blend into the poles'.
            if node.key.row == 0 && north < 0.5 {
                range = wider(range, point(self.poles_m[0]));
            }
            if node.key.row + 1 == self.layout.rows(node.key.level) && south > side - 0.5 {
                range = wider(range, point(self.poles_m[1]));
            }
        }
        for quarter in 0..4 {
            let Some(key) = node.key.child(quarter) else {
                continue;
            };
            let there = node.children[quarter as usize];
            let exists = node.exists >> quarter & 1 == 1;
            if !exists || there == NONE && !is_ever || !self.layout.bounds(key).meets(bounds) {
                continue;
            }
            if there != NONE && 0.5 * tile_rad > least_rad {
                let child = &self.nodes[there as usize];
                range = self.range_below(child, bounds, least_rad, is_ever, range);
            } else {
                let [low, high] = node.below[quarter as usize];
                let of_source = HeightRange {
                    low_m: low.into(),
                    high_m: high.into(),
                };
                range = wider(range, of_source);
            }
        }
        range
    }

    /// The finest level of the source at a place.
    fn finest_level(&self, place: &PyramidPoint) -> u8 {
        let node = &self.nodes[self.finest_over(place, 0) as usize];
        let mut level = node.key.level;
        if level == 0 || node.exists >> self.quarter_of(node, place) & 1 == 0 {
            return level;
        }
        level -= 1;
        let finest = self.key_at(place, 0);
        let is_there = |level: u8| {
            let key = HeightTileKey {
                level,
                column: finest.column >> level,
                row: finest.row >> level,
            };
            self.source.range_m(key).is_some()
        };
        while level > 0 && is_there(level - 1) {
            level -= 1;
        }
        level
    }

    /// See [`crate::elevation::Elevation::finest_spacing_rad`]: for all tiles of the source, resident or not.
    pub fn finest_spacing_rad(&self, lat_rad: f64, lon_rad: f64) -> f64 {
        let level = self.finest_level(&self.place(lat_rad, lon_rad));
        match level == self.layout.coarsest() {
            true => self.base.detail_rad(),
            false => self.layout.spacing_rad(level),
        }
    }

    /// See [`crate::elevation::Elevation::finest_spacing_in`].
    pub fn finest_spacing_in(&self, bounds: &Bounds) -> f64 {
        let coarsest = self.layout.coarsest();
        let roots = self.nodes
            [..(self.layout.columns(coarsest) * self.layout.rows(coarsest)) as usize]
            .iter()
            .map(|node| node.key);
        let mut level: Vec<_> = roots
            .filter(|key| self.layout.bounds(*key).meets(bounds))
            .collect();
        let mut finest = self.base.detail_rad();
        let mut searched = level.len();
        while let Some(first) = level.first().copied() {
            let quarters = level
                .iter()
                .flat_map(|key| (0..4).filter_map(|k| key.child(k)));
            let below: Vec<_> = quarters
                .filter(|key| self.layout.bounds(*key).meets(bounds))
                .filter(|key| self.source.range_m(*key).is_some())
                .collect();
            if below.is_empty() {
                break;
            }
            finest = self.layout.spacing_rad(first.level - 1);
            searched += below.len();
            if searched > MOST_SEARCHED {
                return self.layout.spacing_rad(0);
            }
            level = below;
        }
        finest
    }
}

pub(in crate::elevation) fn wider(a: HeightRange, b: HeightRange) -> HeightRange {
    HeightRange {
        low_m: a.low_m.min(b.low_m),
        high_m: a.high_m.max(b.high_m),
    }
}

fn point(height_m: f64) -> HeightRange {
    HeightRange {
        low_m: height_m,
        high_m: height_m,
    }
}
