//! Maps enlarged row by row.

use crate::starter_pack::map::{Map, cubic_taps};

/// A map of the whole Earth in bytes, channels interleaved.
pub struct Bytes {
    pub width: usize,
    pub height: usize,
    pub channels: usize,
    pub values: Vec<u8>,
}

impl Bytes {
    /// The map rounded to bytes.
    pub fn of(map: &Map) -> Self {
        Self {
            width: map.width,
            height: map.height,
            channels: map.channels,
            values: map.to_bytes(),
        }
    }
}

/// Produces the rows of a map enlarged by the Catmull–Rom cubic, periodic in longitude.
pub struct Enlarger {
    source: Bytes,
    height: usize,
    /// First source column and four weights of each target column.
    columns: Vec<(isize, [f32; 4])>,
    /// Source rows already enlarged horizontally; row n is in slot n mod 4.
    wide: [(Option<usize>, Vec<f32>); 4],
}

impl Enlarger {
    /// Enlarges to a width and height not smaller than the source's.
    pub fn new(source: Bytes, width: usize, height: usize) -> Self {
        let columns = (0..width).map(|x| four_taps(x, width, source.width));
        let wide = || (None, vec![0.0; width * source.channels]);
        Self {
            columns: columns.collect(),
            wide: [wide(), wide(), wide(), wide()],
            source,
            height,
        }
    }

    /// Writes row `y` of the enlarged map; values may lie slightly outside 0…255 at an edge.
    pub fn row(&mut self, y: usize, out: &mut [f32]) {
        out.fill(0.0);
        let (first, weights) = four_taps(y, self.height, self.source.height);
        for (n, weight) in (first..).zip(weights) {
            let n = n.clamp(0, self.source.height as isize - 1) as usize;
            let wide = self.wide_row(n);
            for (out, value) in out.iter_mut().zip(wide) {
                *out += weight * value;
            }
        }
    }

    fn wide_row(&mut self, n: usize) -> &[f32] {
        let Bytes {
            width,
            channels,
            ref values,
            ..
        } = self.source;
        let (held, wide) = &mut self.wide[n % 4];
        if *held != Some(n) {
            let row = &values[n * width * channels..(n + 1) * width * channels];
            for ((first, weights), out) in self.columns.iter().zip(wide.chunks_exact_mut(channels))
            {
                out.fill(0.0);
                for (x, weight) in (*first..).zip(weights) {
                    let x = x.rem_euclid(width as isize) as usize * channels;
                    for (out, value) in out.iter_mut().zip(&row[x..x + channels]) {
                        *out += weight * f32::from(*value);
                    }
                }
            }
            *held = Some(n);
        }
        wide
    }
}

/// The taps of an unstretched cubic: four, or three and a zero if the target coincides with a source texel.
fn four_taps(index: usize, target: usize, source: usize) -> (isize, [f32; 4]) {
    let (first, taps) = cubic_taps(index, target, source);
    let mut weights = [0.0; 4];
    // At a source texel there are five taps; the outer ones are zero.
    let skip = taps.len().saturating_sub(4);
    for (weight, tap) in weights.iter_mut().zip(&taps[skip..]) {
        *weight = *tap;
    }
    (first + skip as isize, weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_those_of_the_whole_map_enlarged() {
        let map = Map {
            width: 12,
            height: 6,
            channels: 2,
            values: (0..144).map(|n| ((n * 37) % 101) as f32 + 70.0).collect(),
        };
        for (width, height) in [(12, 6), (24, 12), (60, 30), (62, 31)] {
            let whole = map.resampled(width, height);
            let mut rows = Enlarger::new(Bytes::of(&map), width, height);
            let mut row = vec![0.0; width * 2];
            for y in 0..height {
                rows.row(y, &mut row);
                let expected = &whole.values[y * width * 2..(y + 1) * width * 2];
                for (value, expected) in row.iter().zip(expected) {
                    assert!((value.clamp(0.0, 255.0) - expected).abs() < 1e-2);
                }
            }
        }
    }
}
