//! Division of the Earth into elevation tiles.

use crate::elevation::Bounds;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt;

/// Minimum tile columns of the coarsest level.
const LEAST_COLUMNS: u32 = 16;
/// Maximum tile columns of the coarsest level, which is always in memory.
const MOST_COARSEST_COLUMNS: u32 = 64;
/// Maximum samples along a tile's side.
const MOST_SIDE: u32 = 1024;
/// Maximum samples around the Earth: cells of 4 cm.
const MOST_SAMPLES: u64 = 1 << 30;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct HeightTileKey {
    /// 0 is the finest.
    pub level: u8,
    /// Column from 180° W eastwards.
    pub column: u32,
    /// Row from the north pole southwards.
    pub row: u32,
}

impl HeightTileKey {
    /// The tile above it, at the next coarser level.
    pub fn parent(self) -> Self {
        Self {
            level: self.level + 1,
            column: self.column / 2,
            row: self.row / 2,
        }
    }

    /// Its ancestor at a coarser level, or itself at its own.
    pub(crate) fn over(self, level: u8) -> Self {
        let up = level - self.level;
        Self {
            level,
            column: self.column >> up,
            row: self.row >> up,
        }
    }

    /// A child at the next finer level: 0…3, north-west, north-east, south-west, south-east. `None` at the finest level.
    pub fn child(self, quarter: u32) -> Option<Self> {
        Some(Self {
            level: self.level.checked_sub(1)?,
            column: 2 * self.column + (quarter & 1),
            row: 2 * self.row + (quarter >> 1 & 1),
        })
    }

    /// Its quarter within the parent.
    pub(crate) fn quarter(self) -> usize {
        ((self.row & 1) << 1 | self.column & 1) as usize
    }
}

impl fmt::Display for HeightTileKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { level, column, row } = self;
        write!(f, "heights of level {level}, column {column}, row {row}")
    }
}

/// Why a layout is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the layout of the elevation tiles is invalid: {levels} levels, {coarsest_columns} columns at the coarsest, {side} samples a side, border \
     {border}; expected at least one level, 16, 32 or 64 columns, sides of an even number of samples from 16 to 1024 and a border of 1 to 16, and no \
     more than 2^30 samples round the Earth"
)]
pub struct HeightLayoutError {
    pub levels: u8,
    /// Columns of the coarsest level.
    pub coarsest_columns: u32,
    /// Samples along a tile's side.
    pub side: u32,
    /// Samples of its border.
    pub border: u32,
}

/// Division of the Earth into elevation tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeightTileLayout {
    levels: u8,
    coarsest_columns: u32,
    side: u32,
    border: u32,
}

impl HeightTileLayout {
    /// A layout of `levels` levels. The coarsest has `coarsest_columns` tile columns (16, 32 or 64) and half as many rows. A
    /// tile has `side` samples along a side, and `border` more beyond each edge.
    ///
    /// # Errors
    /// Numbers outside the limits of [`HeightLayoutError`].
    pub fn new(
        levels: u8,
        coarsest_columns: u32,
        side: u32,
        border: u32,
    ) -> Result<Self, HeightLayoutError> {
        let round = || {
            let columns = u64::from(coarsest_columns).checked_shl(u32::from(levels) - 1)?;
            columns.checked_mul(u64::from(side))
        };
        let is_sound = levels > 0
            && coarsest_columns.is_power_of_two()
            && (LEAST_COLUMNS..=MOST_COARSEST_COLUMNS).contains(&coarsest_columns)
            && (16..=MOST_SIDE).contains(&side)
            && side.is_multiple_of(2)
            && (1..=16).contains(&border)
            && levels <= 32
            && round().is_some_and(|round| round <= MOST_SAMPLES);
        if is_sound {
            Ok(Self {
                levels,
                coarsest_columns,
                side,
                border,
            })
        } else {
            Err(HeightLayoutError {
                levels,
                coarsest_columns,
                side,
                border,
            })
        }
    }

    pub fn levels(&self) -> u8 {
        self.levels
    }

    /// Number of the coarsest level.
    pub fn coarsest(&self) -> u8 {
        self.levels - 1
    }

    /// Samples along a tile's side, without its border.
    pub fn side(&self) -> u32 {
        self.side
    }

    /// Samples beyond each edge of a tile.
    pub fn border(&self) -> u32 {
        self.border
    }

    /// Samples per row of a stored tile: the side and both borders.
    pub fn row_samples(&self) -> usize {
        (self.side + 2 * self.border) as usize
    }

    /// Samples of a stored tile.
    pub fn tile_samples(&self) -> usize {
        self.row_samples() * self.row_samples()
    }

    /// Tile columns of a level; there are half as many rows. Levels beyond the coarsest count as the coarsest.
    pub fn columns(&self, level: u8) -> u32 {
        self.coarsest_columns << (self.coarsest() - level.min(self.coarsest()))
    }

    /// Tile rows of a level.
    pub fn rows(&self, level: u8) -> u32 {
        self.columns(level) / 2
    }

    /// Angle between neighbouring samples of a level, radians of latitude and of longitude.
    pub fn spacing_rad(&self, level: u8) -> f64 {
        self.tile_rad(level) / f64::from(self.side)
    }

    /// Angle of a tile's side, radians.
    pub fn tile_rad(&self, level: u8) -> f64 {
        TAU / f64::from(self.columns(level))
    }

    /// Whether the layout has such a tile.
    pub fn contains(&self, key: HeightTileKey) -> bool {
        key.level < self.levels
            && key.column < self.columns(key.level)
            && key.row < self.rows(key.level)
    }

    /// The bounds of a tile, without its border.
    pub fn bounds(&self, key: HeightTileKey) -> Bounds {
        let tile_rad = self.tile_rad(key.level);
        let north_rad = FRAC_PI_2 - f64::from(key.row) * tile_rad;
        Bounds {
            south_rad: (north_rad - tile_rad).max(-FRAC_PI_2),
            north_rad,
            west_rad: f64::from(key.column) * tile_rad - PI,
            width_rad: tile_rad,
        }
    }

    /// The neighbouring tile of the same level, across the date line too; `None` beyond a pole.
    pub fn beside(&self, key: HeightTileKey, east: i32, south: i32) -> Option<HeightTileKey> {
        let (columns, rows) = (self.columns(key.level), self.rows(key.level));
        let row = key
            .row
            .checked_add_signed(south)
            .filter(|row| *row < rows)?;
        let column = (i64::from(key.column) + i64::from(east)).rem_euclid(i64::from(columns));
        Some(HeightTileKey {
            level: key.level,
            column: column as u32,
            row,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarters_cover_their_tile_and_neighbours_go_round() {
        let layout = HeightTileLayout::new(3, 16, 64, 1).expect("sound");
        assert_eq!(
            (layout.columns(0), layout.rows(0), layout.columns(2)),
            (64, 32, 16)
        );
        let key = HeightTileKey {
            level: 1,
            column: 31,
            row: 3,
        };
        for quarter in 0..4 {
            let child = key.child(quarter).expect("there is a finer level");
            assert_eq!((child.parent(), child.quarter()), (key, quarter as usize));
            let (own, of_child) = (layout.bounds(key), layout.bounds(child));
            assert!(of_child.north_rad <= own.north_rad && of_child.south_rad >= own.south_rad);
            assert!(own.contains(of_child.south_rad + 1e-3, of_child.west_rad + 1e-3));
        }
        let east = layout.beside(key, 1, 0).expect("round the date line");
        assert_eq!((east.column, east.row), (0, 3));
        assert_eq!(layout.beside(HeightTileKey { row: 0, ..key }, 0, -1), None);
        assert!(layout.contains(key) && !layout.contains(HeightTileKey { row: 16, ..key }));
        // 22.5° in 64 samples at the coarsest.
        assert!((layout.spacing_rad(2) - PI / 512.0).abs() < 1e-15);
    }

    #[test]
    fn layouts_that_cannot_be_are_rejected() {
        for (levels, columns, side, border) in [
            (0, 16, 64, 1),
            (1, 12, 64, 1),
            (1, 8, 64, 1),
            (1, 128, 64, 1),
            (1, 16, 14, 1),
            (1, 16, 63, 1),
            (1, 16, 2048, 1),
            (1, 16, 64, 0),
            (1, 16, 64, 17),
            (18, 16, 1024, 1),
            (255, 16, 64, 1),
        ] {
            let rejected = HeightTileLayout::new(levels, columns, side, border);
            assert!(rejected.is_err(), "{levels} {columns} {side} {border}");
        }
        assert!(HeightTileLayout::new(17, 16, 1024, 1).is_ok());
    }
}
