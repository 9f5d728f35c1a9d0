//! Mip levels by a box filter: each texel is the area mean of the texels of the level above that it covers.
//!
//! Colours are averaged in linear light, cover and slopes as they are. Every level is averaged from the unrounded
//! level above it, so that rounding does not build up over twelve levels. The whole image is one period in longitude;
//! with even widths no box reaches over the left or right edge.

use super::srgb::{LINEAR_FROM_SRGB, SrgbEncoder};
use super::texel::TexelFormat;

/// Number of levels down to 1 × 1.
pub(super) fn level_count(width: u32, height: u32) -> usize {
    width.max(height).max(1).ilog2() as usize + 1
}

/// Level 0 and all smaller levels. `texels` must hold width × height texels; both sizes at least 1.
pub(super) fn chain(
    texels: Vec<u8>,
    width: usize,
    height: usize,
    format: TexelFormat,
) -> Vec<Vec<u8>> {
    let mut rows = LevelRows::new(width, height, format);
    let mut smaller: Vec<Vec<u8>> = rows.sizes().map(Vec::with_capacity).collect();
    for row in texels.chunks_exact(width * format.texel_bytes()) {
        rows.push(row, &mut |level, row| {
            smaller[level - 1].extend_from_slice(row)
        });
    }
    let mut levels = vec![texels];
    levels.append(&mut smaller);
    levels
}

fn halved((width, height): (usize, usize)) -> (usize, usize) {
    ((width / 2).max(1), (height / 2).max(1))
}

/// The smaller levels of a map, made row by row: one unrounded row of each level is in memory.
pub(super) enum LevelRows {
    One(Rows<1>),
    Two(Rows<2>),
    Four(Rows<4>),
}

impl LevelRows {
    /// For a map of this size, both at least 1.
    pub fn new(width: usize, height: usize, format: TexelFormat) -> Self {
        match format {
            TexelFormat::R8Unorm => Self::One(Rows::new(width, height, format)),
            TexelFormat::Rg8Snorm => Self::Two(Rows::new(width, height, format)),
            TexelFormat::Rgba8Srgb => Self::Four(Rows::new(width, height, format)),
        }
    }

    /// Bytes of each smaller level, from level 1 on.
    pub fn sizes(&self) -> impl Iterator<Item = usize> {
        let sizes: Vec<_> = match self {
            Self::One(rows) => rows.levels.iter().map(Halved::bytes).collect(),
            Self::Two(rows) => rows.levels.iter().map(Halved::bytes).collect(),
            Self::Four(rows) => rows.levels.iter().map(Halved::bytes).collect(),
        };
        sizes.into_iter()
    }

    /// Takes the next row of level 0, from the north. `done` gets each row of a smaller level that it completes, with its level.
    pub fn push(&mut self, row: &[u8], done: &mut dyn FnMut(usize, &[u8])) {
        match self {
            Self::One(rows) => rows.push(row, done),
            Self::Two(rows) => rows.push(row, done),
            Self::Four(rows) => rows.push(row, done),
        }
    }
}

/// The same for texels of so many channels.
pub(super) struct Rows<const CHANNELS: usize> {
    format: TexelFormat,
    /// A row of level 0.
    values: Vec<f32>,
    levels: Vec<Halved<CHANNELS>>,
}

impl<const CHANNELS: usize> Rows<CHANNELS> {
    fn new(width: usize, height: usize, format: TexelFormat) -> Self {
        let mut levels = Vec::new();
        let mut size = (width, height);
        while size != (1, 1) {
            levels.push(Halved::of(size.0, size.1));
            size = halved(size);
        }
        Self {
            format,
            values: vec![0.0; width * CHANNELS],
            levels,
        }
    }

    fn push(&mut self, row: &[u8], done: &mut dyn FnMut(usize, &[u8])) {
        let (format, Some(first)) = (self.format, self.levels.first_mut()) else {
            return;
        };
        let linear: &[f32; 256] = &LINEAR_FROM_SRGB;
        match format {
            _ if !first.width.is_multiple_of(2) => {
                decode_row(row, format, &mut self.values);
                halve_row::<CHANNELS>(&self.values, first.width, &mut first.line);
            }
            // Without the row's values in memory in between, which take longer than the sums.
            TexelFormat::Rgba8Srgb => {
                halve_texels(row, &mut first.line, |texel| color_of(linear, texel));
            }
            TexelFormat::R8Unorm => halve_texels(row, &mut first.line, amount_of),
            TexelFormat::Rg8Snorm => halve_texels(row, &mut first.line, slopes_of),
        }
        take_line(&mut self.levels, 1, &mut |level, row, bytes| {
            encode(row, format, bytes);
            done(level, bytes);
        });
    }
}

/// A level during its computation: rows of the level above are added from the north, and one unrounded row of its own is in memory.
struct Halved<const CHANNELS: usize> {
    /// Size of the level above.
    width: usize,
    height: usize,
    /// Rows of the level above that went in.
    taken: usize,
    /// The last of them, halved in length.
    line: Vec<f32>,
    row: Vec<f32>,
    /// The same row, rounded.
    bytes: Vec<u8>,
}

impl<const CHANNELS: usize> Halved<CHANNELS> {
    fn of(width: usize, height: usize) -> Self {
        let row = vec![0.0; halved((width, height)).0 * CHANNELS];
        Self {
            width,
            height,
            taken: 0,
            bytes: Vec::with_capacity(row.len()),
            line: row.clone(),
            row,
        }
    }

    /// Bytes of the whole level.
    fn bytes(&self) -> usize {
        self.row.len() * halved((self.width, self.height)).1
    }
}

/// Gets a level, an unrounded row of it, and where the row's bytes go.
type RowDone<'a> = dyn FnMut(usize, &[f32], &mut Vec<u8>) + 'a;

/// Adds the line of the first of these levels, which is the `number`th, to its row, and gives what that completes to the next ones.
fn take_line<const CHANNELS: usize>(
    levels: &mut [Halved<CHANNELS>],
    number: usize,
    done: &mut RowDone<'_>,
) {
    let Some((level, smaller)) = levels.split_first_mut() else {
        return;
    };
    let y = level.taken;
    level.taken += 1;
    // At an odd height every second row contributes to two rows: it completes the one and starts the other.
    for target in (y / 2).saturating_sub(1)..=y / 2 {
        let (first, weights) = taps(level.height, target);
        let is_own = target < (level.height / 2).max(1) && (first..first + 3).contains(&y);
        let offset = y.saturating_sub(first);
        if !is_own || weights[offset] == 0.0 {
            continue;
        }
        let weight = weights[offset];
        let pairs = level.row.iter_mut().zip(&level.line);
        match offset {
            0 => pairs.for_each(|(sum, value)| *sum = weight * value),
            _ => pairs.for_each(|(sum, value)| *sum += weight * value),
        }
        if weights[offset + 1..].iter().all(|weight| *weight == 0.0) {
            level.bytes.clear();
            done(number, &level.row, &mut level.bytes);
            if let Some(next) = smaller.first_mut() {
                halve_row::<CHANNELS>(&level.row, next.width, &mut next.line);
            }
            take_line(smaller, number + 1, done);
        }
    }
}

/// Values of texels' bytes.
pub(super) fn decode_row(bytes: &[u8], format: TexelFormat, values: &mut [f32]) {
    fn decode<const N: usize>(bytes: &[u8], values: &mut [f32], of: impl Fn([u8; N]) -> [f32; N]) {
        let (texels, _) = bytes.as_chunks();
        let (values, _) = values.as_chunks_mut();
        for (value, texel) in values.iter_mut().zip(texels) {
            *value = of(*texel);
        }
    }
    let linear: &[f32; 256] = &LINEAR_FROM_SRGB;
    match format {
        TexelFormat::Rgba8Srgb => decode(bytes, values, |texel| color_of(linear, texel)),
        TexelFormat::R8Unorm => decode(bytes, values, amount_of),
        TexelFormat::Rg8Snorm => decode(bytes, values, slopes_of),
    }
}

fn color_of(linear: &[f32; 256], [red, green, blue, alpha]: [u8; 4]) -> [f32; 4] {
    let [red, green, blue] = [red, green, blue].map(|code| linear[usize::from(code)]);
    [red, green, blue, f32::from(alpha) / 255.0]
}

fn amount_of([code]: [u8; 1]) -> [f32; 1] {
    [f32::from(code) / 255.0]
}

fn slopes_of(codes: [u8; 2]) -> [f32; 2] {
    // −128 and −127 both mean −1.
    codes.map(|code| (f32::from(code as i8) / 127.0).max(-1.0))
}

/// Adds the bytes of values that [`decode_row`] gave, rounded.
pub(super) fn encode(values: &[f32], format: TexelFormat, bytes: &mut Vec<u8>) {
    // By way of i32, which the compiler makes vectors of.
    let unorm = |value: f32| (value * 255.0 + 0.5) as i32 as u8;
    let snorm = |value: f32| (value * 127.0).round() as i8 as u8;
    match format {
        TexelFormat::Rgba8Srgb => {
            let srgb = SrgbEncoder::new();
            let (texels, _) = values.as_chunks::<4>();
            bytes.extend(texels.iter().flat_map(|[red, green, blue, alpha]| {
                [
                    srgb.code(*red),
                    srgb.code(*green),
                    srgb.code(*blue),
                    unorm(*alpha),
                ]
            }));
        }
        TexelFormat::R8Unorm => bytes.extend(values.iter().map(|value| unorm(*value))),
        TexelFormat::Rg8Snorm => bytes.extend(values.iter().map(|value| snorm(*value))),
    }
}

/// Which texels of a line of `size` texel `target` of the line of half its size covers: the first one, and the weight
/// of it and of its followers.
///
/// An even line has two of equal weight. Of an odd line of 2k + 1 each of the k covers 2 + 1/k texels, three with the
/// weights (k − i), k and (i + 1) over 2k + 1; plain halving would lose the last texel and shift the map.
fn taps(size: usize, target: usize) -> (usize, [f32; 3]) {
    if size == 1 {
        return (0, [1.0, 0.0, 0.0]);
    }
    if size.is_multiple_of(2) {
        return (2 * target, [0.5, 0.5, 0.0]);
    }
    let half = (size / 2) as f32;
    let (total, target_f) = (size as f32, target as f32);
    (
        2 * target,
        [
            (half - target_f) / total,
            half / total,
            (target_f + 1.0) / total,
        ],
    )
}

/// Means of pairs of texels of an even number.
fn halve_texels<const N: usize>(
    bytes: &[u8],
    line: &mut [f32],
    value_of: impl Fn([u8; N]) -> [f32; N],
) {
    let (texels, _) = bytes.as_chunks::<N>();
    let (pairs, _) = texels.as_chunks::<2>();
    let (line, _) = line.as_chunks_mut::<N>();
    for (out, pair) in line.iter_mut().zip(pairs) {
        let [west, east] = pair.map(&value_of);
        *out = std::array::from_fn(|channel| 0.5 * (west[channel] + east[channel]));
    }
}

/// A row of `width` texels, halved in length.
fn halve_row<const CHANNELS: usize>(row: &[f32], width: usize, line: &mut [f32]) {
    let (texels, _) = row.as_chunks::<CHANNELS>();
    let (line, _) = line.as_chunks_mut::<CHANNELS>();
    if width.is_multiple_of(2) {
        let (pairs, _) = texels.as_chunks::<2>();
        for (out, [west, east]) in line.iter_mut().zip(pairs) {
            *out = std::array::from_fn(|channel| 0.5 * (west[channel] + east[channel]));
        }
        return;
    }
    for (x, out) in line.iter_mut().enumerate() {
        let (first, weights) = taps(width, x);
        *out = [0.0; CHANNELS];
        // The other channels of a texel are beyond its row.
        for (texel, weight) in texels[first..].iter().zip(weights) {
            for (out, value) in out.iter_mut().zip(texel) {
                *out += weight * value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMATS: [TexelFormat; 3] = [
        TexelFormat::Rgba8Srgb,
        TexelFormat::R8Unorm,
        TexelFormat::Rg8Snorm,
    ];
    const SIZES: [(usize, usize); 8] = [
        (1, 1),
        (2, 1),
        (1, 5),
        (8, 4),
        (7, 3),
        (45, 23),
        (64, 64),
        (100, 50),
    ];

    /// Values of each byte of each channel.
    fn decode_tables<const CHANNELS: usize>(format: TexelFormat) -> [[f32; 256]; CHANNELS] {
        std::array::from_fn(|channel| match format {
            TexelFormat::Rgba8Srgb if channel < 3 => *LINEAR_FROM_SRGB,
            TexelFormat::Rgba8Srgb | TexelFormat::R8Unorm => {
                std::array::from_fn(|code| code as f32 / 255.0)
            }
            // −128 and −127 both mean −1.
            TexelFormat::Rg8Snorm => {
                std::array::from_fn(|code| (f32::from(code as u8 as i8) / 127.0).max(-1.0))
            }
        })
    }

    /// Bytes without pattern, the same at every run.
    fn noise(count: usize) -> Vec<u8> {
        let mut state = 0x2545_F491_4F6C_DD1Du64;
        (0..count)
            .map(|_| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 32) as u8
            })
            .collect()
    }

    #[test]
    fn levels_have_the_stated_sizes_and_end_at_one_texel() {
        for format in FORMATS {
            for (width, height) in SIZES {
                let texel = format.texel_bytes();
                let levels = chain(noise(width * height * texel), width, height, format);
                assert_eq!(levels.len(), level_count(width as u32, height as u32));
                for (n, level) in levels.iter().enumerate() {
                    let (w, h) = ((width >> n).max(1), (height >> n).max(1));
                    assert_eq!(level.len(), w * h * texel, "{width}x{height} level {n}");
                }
                assert_eq!(levels.last().map(Vec::len), Some(texel));
            }
        }
    }

    #[test]
    fn a_constant_map_stays_constant() {
        for format in FORMATS {
            for (width, height) in SIZES {
                for value in [0u8, 1, 37, 127, 129, 200, 255] {
                    let texels = vec![value; width * height * format.texel_bytes()];
                    for level in chain(texels, width, height, format) {
                        assert!(
                            level.iter().all(|byte| *byte == value),
                            "{format:?} {width}x{height} value {value}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_checker_of_black_and_white_averages_in_linear_light() {
        let colour: Vec<u8> = (0..64)
            .flat_map(|n| [[0, 0, 0, 255], [255, 255, 255, 255]][(n % 8 + n / 8) % 2])
            .collect();
        for level in &chain(colour, 8, 8, TexelFormat::Rgba8Srgb)[1..] {
            for texel in level.chunks_exact(4) {
                // Half the light is sRGB 188, not 128.
                assert_eq!(texel, [188, 188, 188, 255]);
            }
        }
        let cover: Vec<u8> = (0..64).map(|n| [0, 255][(n % 8 + n / 8) % 2]).collect();
        for level in &chain(cover, 8, 8, TexelFormat::R8Unorm)[1..] {
            assert!(level.iter().all(|byte| *byte == 128));
        }
    }

    #[test]
    fn every_level_keeps_the_mean() {
        for format in FORMATS {
            for (width, height) in SIZES {
                let channels = format.texel_bytes();
                let levels = chain(noise(width * height * channels), width, height, format);
                let tables = decode_tables::<4>(format);
                let mean = |level: &[u8]| {
                    let sum: f64 = level
                        .iter()
                        .enumerate()
                        .map(|(n, byte)| f64::from(tables[n % channels][*byte as usize]))
                        .sum();
                    sum / level.len() as f64
                };
                let full = mean(&levels[0]);
                for (n, level) in levels.iter().enumerate() {
                    // Each value is rounded by at most half a code: at most 0.0046 in linear light near white.
                    let error = (mean(level) - full).abs();
                    assert!(error < 0.0046, "{format:?} {width}x{height} {n}: {error}");
                }
            }
        }
    }

    #[test]
    fn every_code_means_what_the_tables_say_and_comes_back() {
        for format in FORMATS {
            let bytes: Vec<u8> = (0..=255).flat_map(|code| [code; 4]).collect();
            let mut values = vec![0.0; bytes.len()];
            decode_row(&bytes, format, &mut values);
            let tables = decode_tables::<4>(format);
            for (n, (value, code)) in values.iter().zip(&bytes).enumerate() {
                let channel = n % 4 % format.texel_bytes();
                assert_eq!(*value, tables[channel][*code as usize], "{format:?} {code}");
            }
            let mut encoded = Vec::new();
            encode(&values, format, &mut encoded);
            for (found, code) in encoded.iter().zip(&bytes) {
                // −128 is stored as −127.
                let is_lowest = format == TexelFormat::Rg8Snorm && *code == 128;
                assert_eq!(*found, if is_lowest { 129 } else { *code }, "{format:?}");
            }
        }
    }

    #[test]
    fn odd_lines_lose_nothing_and_do_not_shift() {
        for size in 1..40 {
            let mut weight_of = vec![0.0f32; size];
            for target in 0..(size / 2).max(1) {
                let (first, weights) = taps(size, target);
                assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
                for (offset, weight) in weights.into_iter().enumerate() {
                    if weight != 0.0 {
                        weight_of[first + offset] += weight;
                    }
                }
            }
            let share = (size / 2).max(1) as f32 / size as f32;
            assert!(weight_of.iter().all(|w| (w - share).abs() < 1e-6), "{size}");
        }
    }

    #[test]
    fn slopes_of_both_signs_cancel() {
        let texels: Vec<u8> = [100i8, -100, 100, -100, -100, 100, -100, 100]
            .map(|slope| slope as u8)
            .to_vec();
        assert_eq!(
            chain(texels, 2, 2, TexelFormat::Rg8Snorm).last(),
            Some(&vec![0, 0])
        );
    }
}
