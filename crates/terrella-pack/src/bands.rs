//! A level's rows gathered into bands: all rows of one row of tiles with their borders.

use super::codes;
use super::memory::{Permit, Pool};
use std::ops::Range;
use terrella_imagery::tile::{TILE_BORDER, TileShape};

/// Texels of a tile's side that are its neighbours': border and padding.
fn overlap(shape: TileShape) -> usize {
    (shape.side() - shape.pixels) as usize
}

/// Columns of tiles of these columns of blocks.
pub(super) fn tile_columns(shape: TileShape, blocks: &Range<u32>) -> Range<u32> {
    blocks.start * shape.parts..blocks.end * shape.parts
}

/// Texels of a row that is kept for so many columns of tiles.
pub(super) fn row_texels(shape: TileShape, columns: &Range<u32>) -> usize {
    columns.len() * shape.pixels as usize + overlap(shape)
}

/// The first column of the level that is kept; it may be west of the map's edge.
pub(super) fn first_texel(shape: TileShape, columns: &Range<u32>) -> i64 {
    i64::from(columns.start) * i64::from(shape.pixels) - i64::from(TILE_BORDER)
}

/// Rows beyond a pole that tiles reach: the border, in the south with the padding.
pub(super) fn polar_rows(shape: TileShape) -> u32 {
    shape.side() - shape.pixels - TILE_BORDER
}

pub(super) fn band_bytes<const C: usize>(shape: TileShape, columns: &Range<u32>) -> u64 {
    shape.side() as u64 * (row_texels(shape, columns) * C) as u64
}

/// A finished band.
pub(super) struct Band {
    pub shape: TileShape,
    /// Row of tiles.
    pub tile_row: u32,
    /// Columns of tiles.
    pub columns: Range<u32>,
    channels: usize,
    bytes: Vec<u8>,
    /// Gives the memory back.
    _permit: Permit,
}

impl Band {
    /// Row `y` of the texels of a column's tile, border included.
    pub(super) fn texels(&self, column: u32, y: u32) -> &[u8] {
        let row = row_texels(self.shape, &self.columns);
        let west = (column - self.columns.start) as usize * self.shape.pixels as usize;
        let start = (y as usize * row + west) * self.channels;
        &self.bytes[start..start + self.shape.side() as usize * self.channels]
    }
}

/// Gathers the rows of a level.
pub(super) struct Bands<const C: usize> {
    shape: TileShape,
    columns: Range<u32>,
    pool: Pool,
    tile_row: u32,
    bytes: Vec<u8>,
    permit: Option<Permit>,
    /// Rows of the opposite meridian nearest to the north pole and to the south pole, the pole first.
    caps: [Vec<Vec<u8>>; 2],
}

impl<const C: usize> Bands<C> {
    /// Waits for the memory of the first band; `None` if the work has stopped meanwhile.
    pub(super) fn new(shape: TileShape, columns: Range<u32>, pool: &Pool) -> Option<Self> {
        let mut bands = Self {
            caps: [TILE_BORDER, polar_rows(shape)].map(|rows| vec![Vec::new(); rows as usize]),
            shape,
            columns,
            pool: pool.clone(),
            tile_row: 0,
            bytes: Vec::new(),
            permit: None,
        };
        bands.begin().then_some(bands)
    }

    fn row_bytes(&self) -> usize {
        row_texels(self.shape, &self.columns) * C
    }

    /// Allocates the next band; false if the work has stopped.
    fn begin(&mut self) -> bool {
        let bytes = band_bytes::<C>(self.shape, &self.columns);
        self.permit = self.pool.take(bytes);
        if self.permit.is_some() {
            self.bytes = vec![0; bytes as usize];
        }
        self.permit.is_some()
    }

    /// Takes row `y` of the level: of lane 0 its own columns, of lane 1 those half a turn away. Finished bands go to
    /// `give`. False if the work has stopped.
    pub(super) fn put(
        &mut self,
        lane: usize,
        y: u32,
        values: &[f32],
        give: &mut impl FnMut(Band),
    ) -> bool {
        if lane == 1 {
            let last = self.shape.map_height() - 1;
            for (cap, place) in self.caps.iter_mut().zip([y, last - y]) {
                if let Some(row) = cap.get_mut(place as usize) {
                    row.resize(values.len(), 0);
                    codes::encode::<C>(values, row);
                }
            }
            return true;
        }
        let row_bytes = self.row_bytes();
        let place = self.place(y);
        codes::encode::<C>(values, &mut self.bytes[place * row_bytes..][..row_bytes]);
        let is_full = place + 1 == self.shape.side() as usize;
        if !is_full || self.tile_row + 1 == self.shape.tile_rows() {
            return true;
        }
        let carried = self.bytes[self.shape.pixels as usize * row_bytes..].to_vec();
        self.hand_over(give);
        self.tile_row += 1;
        if !self.begin() {
            return false;
        }
        self.bytes[..carried.len()].copy_from_slice(&carried);
        true
    }

    /// Index of row `y` of the level in the current band.
    fn place(&self, y: u32) -> usize {
        (y + TILE_BORDER - self.tile_row * self.shape.pixels) as usize
    }

    fn hand_over(&mut self, give: &mut impl FnMut(Band)) {
        let row_bytes = self.row_bytes();
        if self.tile_row == 0 {
            for (k, row) in self.caps[0].iter().enumerate() {
                let place = TILE_BORDER as usize - 1 - k;
                mirror::<C>(row, &mut self.bytes[place * row_bytes..][..row_bytes]);
            }
        }
        if self.tile_row + 1 == self.shape.tile_rows() {
            for (k, row) in self.caps[1].iter().enumerate() {
                let place = (TILE_BORDER + self.shape.pixels) as usize + k;
                mirror::<C>(row, &mut self.bytes[place * row_bytes..][..row_bytes]);
            }
        }
        let Some(permit) = self.permit.take() else {
            return;
        };
        give(Band {
            shape: self.shape,
            tile_row: self.tile_row,
            columns: self.columns.clone(),
            channels: C,
            bytes: std::mem::take(&mut self.bytes),
            _permit: permit,
        });
    }

    /// After the level's last row: gives the last band.
    pub(super) fn finish(mut self, give: &mut impl FnMut(Band)) {
        self.hand_over(give);
    }
}

/// Copies a row across a pole. East and north are reversed there, so slopes (two channels) change sign.
fn mirror<const C: usize>(from: &[u8], to: &mut [u8]) {
    if C == 2 {
        for (to, from) in to.iter_mut().zip(from) {
            *to = (*from as i8).saturating_neg() as u8;
        }
    } else {
        to.copy_from_slice(from);
    }
}
