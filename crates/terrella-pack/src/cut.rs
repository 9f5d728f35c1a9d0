//! A tile cut from a band, with its mip levels.

use super::bands::Band;
use super::codes;
use terrella_imagery::tile::{MapLayer, Storage, TILE_MIPS, Tile};

/// The uncompressed tile of a column. Mip levels are means of 2 × 2 texels of the unrounded level above, the
/// first of the base as it is stored; sides halve exactly.
pub(super) fn cut<const C: usize>(band: &Band, layer: MapLayer, column: u32) -> Tile {
    let format = layer.tile_format(Storage::Plain);
    let side = band.shape.side();
    let mut texels = Vec::with_capacity(band.shape.bytes(format));
    let mut mips = Mips::<C>::new(side as usize);
    let decoded = codes::decoded::<C>();
    let mut values = vec![0.0; side as usize * C];
    for y in 0..side {
        let row = band.texels(column, y);
        push_texels::<C>(row, &mut texels);
        for (value, byte) in values.iter_mut().zip(row) {
            *value = decoded[usize::from(*byte)];
        }
        mips.push(0, &values);
    }
    for mip in mips.levels {
        texels.extend_from_slice(&mip.texels);
    }
    Tile {
        format,
        shape: band.shape,
        texels,
    }
}

/// Colour gets its alpha.
fn push_texels<const C: usize>(bytes: &[u8], texels: &mut Vec<u8>) {
    if C == 3 {
        for [red, green, blue] in bytes.as_chunks::<3>().0 {
            texels.extend_from_slice(&[*red, *green, *blue, 255]);
        }
    } else {
        texels.extend_from_slice(bytes);
    }
}

/// Mip levels 1 and up, made a row at a time.
struct Mips<const C: usize> {
    levels: Vec<Level>,
    codes: Vec<u8>,
}

struct Level {
    /// Sum of the four texels so far, of the row that is being made.
    sum: Vec<f32>,
    has_first_row: bool,
    texels: Vec<u8>,
}

impl<const C: usize> Mips<C> {
    fn new(side: usize) -> Self {
        let level = |mip: u32| Level {
            sum: vec![0.0; (side >> mip) * C],
            has_first_row: false,
            texels: Vec::new(),
        };
        Self {
            levels: (1..TILE_MIPS).map(level).collect(),
            codes: vec![0; side / 2 * C],
        }
    }

    /// Takes a row of mip level `mip`.
    fn push(&mut self, mip: usize, row: &[f32]) {
        let Some(level) = self.levels.get_mut(mip) else {
            return;
        };
        add_pairs::<C>(row, &mut level.sum);
        level.has_first_row = !level.has_first_row;
        if level.has_first_row {
            return;
        }
        let mut values = std::mem::take(&mut level.sum);
        for value in &mut values {
            *value *= 0.25;
        }
        let codes = &mut self.codes[..values.len()];
        codes::encode::<C>(&values, codes);
        push_texels::<C>(codes, &mut level.texels);
        self.push(mip + 1, &values);
        values.fill(0.0);
        self.levels[mip].sum = values;
    }
}

#[inline]
fn add_pairs<const C: usize>(row: &[f32], sum: &mut [f32]) {
    let (texels, _) = row.as_chunks::<C>();
    let (sums, _) = sum.as_chunks_mut::<C>();
    for (sum, pair) in sums.iter_mut().zip(texels.as_chunks::<2>().0) {
        for channel in 0..C {
            sum[channel] += pair[0][channel] + pair[1][channel];
        }
    }
}
