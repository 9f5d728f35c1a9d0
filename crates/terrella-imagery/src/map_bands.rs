//! Rows of a map collected into bands of rows, for copies that are neither tiny nor huge.

use super::layer::LayerImage;
use super::mips;

/// Collects the rows of a map's levels into bands. Levels may come in any order, and their rows from the north or from the south.
pub struct MapBands(Vec<LevelBand>);

/// A level and the band that is being collected.
struct LevelBand {
    height: u32,
    row_bytes: usize,
    /// Number of rows in a band; the last may have fewer.
    band_rows: u32,
    /// Rows of the current band, each at its place.
    band: Vec<u8>,
    /// Number of rows received.
    came: u32,
}

impl LevelBand {
    /// First row of the band that contains a row, and number of its rows.
    fn band_of(&self, row: u32) -> (u32, u32) {
        let first = row / self.band_rows * self.band_rows;
        (first, self.band_rows.min(self.height.saturating_sub(first)))
    }
}

impl MapBands {
    /// For a map of this size and format, with bands of about `band_bytes`, and of one row at least.
    pub fn new(map: &LayerImage, band_bytes: usize) -> Self {
        let count = mips::level_count(map.width, map.height);
        let levels = (0..count).map(|level| {
            let (width, height) = map.level_size(level);
            let row_bytes = width as usize * map.format.texel_bytes();
            LevelBand {
                height,
                row_bytes,
                band_rows: (band_bytes / row_bytes).max(1) as u32,
                band: Vec::new(),
                came: 0,
            }
        });
        Self(levels.collect())
    }

    /// Adds whole rows of a level, starting at row `first`, and passes on every band that is complete: its level, first row and texels. All
    /// rows of a band must come before those of the next. Rows outside the map are ignored.
    pub fn rows(
        &mut self,
        level: usize,
        first: u32,
        texels: &[u8],
        mut take: impl FnMut(usize, u32, &[u8]),
    ) {
        let Some(place) = self.0.get_mut(level) else {
            return;
        };
        let (mut number, mut left) = (first, texels);
        while !left.is_empty() && number < place.height {
            let (begin, rows) = place.band_of(number);
            let whole = rows as usize * place.row_bytes;
            // A whole band is passed on directly; a partial one is collected.
            if number == begin && place.came == 0 && left.len() >= whole {
                let (band, rest) = left.split_at(whole);
                take(level, begin, band);
                (number, left) = (begin + rows, rest);
                continue;
            }
            let (row, rest) = left.split_at(place.row_bytes.min(left.len()));
            place.band.resize(whole, 0);
            let at = (number - begin) as usize * place.row_bytes;
            place.band[at..at + row.len()].copy_from_slice(row);
            place.came += 1;
            if place.came == rows {
                place.came = 0;
                take(level, begin, &place.band);
            }
            (number, left) = (number + 1, rest);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texel::TexelFormat;

    fn map() -> LayerImage {
        LayerImage {
            width: 64,
            height: 32,
            format: TexelFormat::Rg8Snorm,
            levels: [].into(),
        }
    }

    /// The level put together from the bands, and the number of bands.
    fn collected(rows: impl IntoIterator<Item = (u32, Vec<u8>)>) -> (Vec<u8>, usize) {
        let mut bands = MapBands::new(&map(), 5 * 128);
        let (mut level, mut count) = (vec![0; 32 * 128], 0);
        for (first, texels) in rows {
            bands.rows(0, first, &texels, |_, first, band| {
                count += 1;
                let at = first as usize * 128;
                level[at..at + band.len()].copy_from_slice(band);
            });
        }
        (level, count)
    }

    #[test]
    fn rows_in_any_grouping_make_the_same_bands() {
        let texels: Vec<u8> = (0..32 * 128_u32).map(|n| ((n * 7919) >> 5) as u8).collect();
        let row = |n: u32| {
            let at = n as usize * 128;
            (n, texels[at..at + 128].to_vec())
        };
        let expected = (texels.clone(), 7);
        assert_eq!(collected([(0, texels.clone())]), expected);
        assert_eq!(collected((0..32).map(row)), expected);
        assert_eq!(collected((0..32).rev().map(row)), expected);
        let halves = [
            (0, texels[..16 * 128].to_vec()),
            (16, texels[16 * 128..].to_vec()),
        ];
        assert_eq!(collected(halves), expected);
    }

    #[test]
    fn rows_outside_the_map_are_ignored() {
        let mut bands = MapBands::new(&map(), 128);
        bands.rows(9, 0, &[0; 128], |_, _, _| panic!("no such level"));
        bands.rows(0, 32, &[0; 128], |_, _, _| panic!("no such row"));
    }
}
