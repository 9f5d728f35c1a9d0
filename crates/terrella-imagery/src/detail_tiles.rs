//! Detail smaller than the texels of maps.

use super::decode::{FileKind, Picture, TexelKind};
use super::layer::LayerImage;
use super::mips;
use super::texel::TexelFormat;
use std::sync::OnceLock;

/// The byte that is the mean.
pub const DETAIL_MEAN: f32 = 128.0;
/// Standard deviations that a step of one byte means.
pub const DETAIL_STEP: f32 = 3.2 / 127.0;
/// Steps of a changing value, per texel, that a step of one byte means in the slopes of clouds.
pub const CLOUD_SLOPE_STEP: f32 = 0.25;
/// As [`CLOUD_SLOPE_STEP`], for land.
pub const LAND_SLOPE_STEP: f32 = 0.75;

#[cfg(any(test, feature = "detail-tiles"))]
const COMPILED_IN: Option<&[u8]> = Some(include_bytes!("../data/detail_tiles.jpg"));
#[cfg(not(any(test, feature = "detail-tiles")))]
const COMPILED_IN: Option<&[u8]> = None;

/// Side of a tile, texels.
pub const DETAIL_TILE_SIDE: u32 = 1024;

/// The tiles of [`supply_detail_tiles`].
static SUPPLIED: OnceLock<[LayerImage; 2]> = OnceLock::new();

/// Why a file is not that of the tiles.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("detail_tiles.jpg: {cause}; take the file of this version")]
pub struct DetailTilesError {
    cause: String,
}

/// Squares of the fine structure of clouds, and of eroded terrain, with their mip levels: no maps, but tiles to repeat in all directions. Their
/// values have the mean 0 and the variance 1, as bytes by [`DETAIL_STEP`].
///
/// A texel has four bytes: a value; a second value; and the change of the latter from texel to texel of its level, rightwards and downwards. So one
/// sample shows structures and their flanks.
///
/// - Clouds: the value, which is a part of the starter pack's cloud map without structures larger than some 64 texels; the same smoothed over four
///   texels of its level; slopes by [`CLOUD_SLOPE_STEP`].
/// - Land: patches of colour, the values of clouds in another place; the height of terrain, not smoothed; slopes by [`LAND_SLOPE_STEP`].
///
/// They repeat without a seam. The feature `detail-tiles` compiles them in. Without the feature and before [`supply_detail_tiles`], a tile is one
/// texel without structure.
pub fn detail_tiles() -> [LayerImage; 2] {
    let supplied = SUPPLIED.get().cloned();
    // A test decodes the compiled tiles.
    let tiles = supplied.or_else(|| decoded(COMPILED_IN?).ok());
    tiles.unwrap_or_else(|| {
        let none = LayerImage {
            width: 1,
            height: 1,
            format: TexelFormat::Rgba8Srgb,
            levels: [vec![DETAIL_MEAN as u8; 4]].into(),
        };
        [none.clone(), none]
    })
}

/// Takes the contents of `detail_tiles.jpg`, for programs without the feature `detail-tiles`. Earths that are made later show it. The first file
/// stays.
///
/// # Errors
/// A file that is no whole JPEG of the tiles' size.
pub fn supply_detail_tiles(jpeg: &[u8]) -> Result<(), DetailTilesError> {
    // The decoder fills the rest of a file that breaks off.
    let whole = Picture::open(FileKind::Jpeg, jpeg).and_then(|picture| picture.check_whole());
    let tiles = whole.and_then(|_| decoded(jpeg));
    let tiles = tiles.map_err(|cause| DetailTilesError { cause })?;
    // A second file is the same one.
    let _ = SUPPLIED.set(tiles);
    Ok(())
}

/// The tiles of a file, clouds above terrain. The error is its cause.
fn decoded(jpeg: &[u8]) -> Result<[LayerImage; 2], String> {
    let picture = Picture::open(FileKind::Jpeg, jpeg)?;
    let ((width, height), kind) = (picture.size(), picture.texel_kind());
    if ((width, height), kind) != ((DETAIL_TILE_SIDE, 2 * DETAIL_TILE_SIDE), TexelKind::grey(8)) {
        return Err(format!("it has {width} × {height} texels of {kind}"));
    }
    let mut clouds = picture.texels()?;
    let heights = clouds.split_off(clouds.len() / 2);
    let side = DETAIL_TILE_SIDE as usize;
    let [clouds, heights] =
        [clouds, heights].map(|values| mips::chain(values, side, side, TexelFormat::R8Unorm));
    let levels = clouds.iter().zip(&heights).enumerate();
    let (clouds, land) = levels
        .map(|(level, (clouds, heights))| {
            let width = side >> level;
            let exact = heights
                .iter()
                .map(|height| WEIGHT as u16 * u16::from(*height));
            let (soft, exact) = (smoothed(clouds, width), exact.collect::<Vec<_>>());
            (
                with_slopes(clouds, &soft, width, CLOUD_SLOPE_STEP),
                with_slopes(&elsewhere(clouds, width), &exact, width, LAND_SLOPE_STEP),
            )
        })
        .unzip::<_, _, Vec<_>, Vec<_>>();
    Ok([clouds, land].map(|levels| LayerImage {
        width,
        height: width,
        // Not colours, but as many bytes.
        format: TexelFormat::Rgba8Srgb,
        levels: levels.into(),
    }))
}

/// The four bytes of each texel of a level with rows of this length, a power of two: see [`detail_tiles`]. `second` is times [`WEIGHT`].
fn with_slopes(values: &[u8], second: &[u16], width: usize, slope_step: f32) -> Vec<u8> {
    let row_of = |row: usize| &second[row % width * width..][..width];
    let mut texels = vec![0; 4 * values.len()];
    for (row, texels) in texels.chunks_exact_mut(4 * width).enumerate() {
        let (above, here, below) = (row_of(row + width - 1), row_of(row), row_of(row + 1));
        let values = &values[row * width..][..width];
        for (column, texel) in texels.chunks_exact_mut(4).enumerate() {
            let [before, after] = [column + width - 1, column + 1].map(|at| here[at & (width - 1)]);
            texel.copy_from_slice(&[
                values[column],
                ((u32::from(here[column]) + WEIGHT / 2) / WEIGHT) as u8,
                slope(before, after, slope_step),
                slope(above[column], below[column], slope_step),
            ]);
        }
    }
    texels
}

/// The same square with rows for columns, from its middle on: where one is drawn over the other, they are independent.
fn elsewhere(values: &[u8], width: usize) -> Vec<u8> {
    let at = |n: usize| (n + width / 2) % width;
    let texels = (0..values.len()).map(|n| values[at(n % width) * width + at(n / width)]);
    texels.collect()
}

/// Byte of the slope at a texel between two.
fn slope(before: u16, after: u16, slope_step: f32) -> u8 {
    let steps = (f32::from(after) - f32::from(before)) / (2.0 * WEIGHT as f32);
    // Rounded without a call; the conversion saturates.
    (DETAIL_MEAN + steps / slope_step + 0.5) as u8
}

/// Sum of the weights of [`smoothed`].
const WEIGHT: u32 = 256;

/// A square that repeats, smoothed along rows and along columns: the mean of four means of four neighbours, times [`WEIGHT`].
fn smoothed(values: &[u8], width: usize) -> Vec<u16> {
    let wrapped = |at: usize| (at + 3 * width - 3) % width;
    let mut along_rows = Vec::with_capacity(values.len());
    for row in values.chunks_exact(width) {
        let row: Vec<u16> = (0..width + 6)
            .map(|at| u16::from(row[wrapped(at)]))
            .collect();
        along_rows.extend(weighted(std::array::from_fn(|tap| &row[tap..][..width])));
    }
    let mut soft = Vec::with_capacity(values.len());
    for row in 0..width {
        let near = |tap: usize| &along_rows[wrapped(row + tap) * width..][..width];
        soft.extend(weighted(std::array::from_fn(near)));
    }
    soft
}

/// Sums of seven lines of the same length, with the weights 1 2 3 4 3 2 1.
fn weighted([a, b, c, d, e, f, g]: [&[u16]; 7]) -> impl Iterator<Item = u16> {
    let pairs = a
        .iter()
        .zip(g)
        .zip(b.iter().zip(f))
        .zip(c.iter().zip(e))
        .zip(d);
    pairs.map(|((((a, g), (b, f)), (c, e)), d)| a + g + 2 * (b + f) + 3 * (c + e) + 4 * d)
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALUE: usize = 0;
    /// Of clouds.
    const SOFT: usize = 1;
    /// Of land.
    const HEIGHT: usize = 1;

    fn values(texels: &[u8], channel: usize) -> Vec<f32> {
        let values = texels
            .iter()
            .skip(channel)
            .step_by(4)
            .map(|byte| (f32::from(*byte) - DETAIL_MEAN) * DETAIL_STEP);
        values.collect()
    }

    fn variance(texels: &[u8], channel: usize) -> f32 {
        let values = values(texels, channel);
        let count = values.len() as f32;
        let mean = values.iter().sum::<f32>() / count;
        values
            .iter()
            .map(|value| (value - mean) * (value - mean))
            .sum::<f32>()
            / count
    }

    #[test]
    fn they_have_the_mean_0_and_the_variance_1() {
        for tile in detail_tiles() {
            assert_eq!(
                (tile.width, tile.height, tile.levels.len()),
                (1024, 1024, 11)
            );
            let values = values(&tile.levels[0], VALUE);
            let mean = values.iter().sum::<f32>() / values.len() as f32;
            assert!(mean.abs() < 0.02, "{mean}");
            assert!((variance(&tile.levels[0], VALUE) - 1.0).abs() < 0.05);
        }
    }

    #[test]
    fn another_file_is_rejected() {
        let error = supply_detail_tiles(b"no picture")
            .expect_err("no JPEG")
            .to_string();
        assert!(error.starts_with("detail_tiles.jpg: "), "{error}");
        let jpeg = COMPILED_IN.expect("compiled into tests");
        assert!(supply_detail_tiles(&jpeg[..jpeg.len() / 2]).is_err());
        supply_detail_tiles(jpeg).expect("the tile itself");
        assert_eq!(detail_tiles(), decoded(jpeg).expect("decodes"));
    }

    /// The shader's `value_of` and `soft_of`.
    #[test]
    fn smaller_levels_show_what_the_shader_takes_them_to_show() {
        let [clouds, land] = detail_tiles();
        for (tile, channel, first, last, off) in [
            (&clouds, VALUE, 0.0, 6.3, 0.06),
            (&clouds, SOFT, -2.7, 4.0, 0.06),
            (&land, VALUE, 0.0, 6.3, 0.06),
            (&land, HEIGHT, 0.0, 6.3, 0.12),
        ] {
            for (level, texels) in tile.levels.iter().enumerate().take(8) {
                let t = ((level as f32 - first) / (last - first)).min(1.0);
                let expected = 1.0 - t * t * (3.0 - 2.0 * t);
                let shown = variance(texels, channel);
                assert!(
                    (shown - expected).abs() < off,
                    "level {level}, channel {channel}: {shown} and not {expected}"
                );
            }
        }
    }

    /// The shader's `uneven_share` with both scales: of clouds' cover, and of snow in mountains.
    #[test]
    fn uneven_shares_keep_their_means() {
        let [clouds, land] = detail_tiles();
        for (tile, channel, fine, off) in [(&clouds, VALUE, 0.6, 0.07), (&land, HEIGHT, 0.3, 0.12)]
        {
            let coarse = values(&tile.levels[0], channel);
            let spread = 1.6_f32.powi(2) * (1.0 + fine * fine);
            for share in [0.1, 0.2, 0.3, 0.5, 0.7, 0.9_f32] {
                let shift = (share - 0.5) * spread * (1.0 - 0.05 * spread);
                let made = coarse.iter().enumerate().map(|(n, value)| {
                    // A prime number of texels away the fine scale is independent.
                    let fine = fine * coarse[(n * 7919 + 31) % coarse.len()];
                    let odds = (1.6 * (value + fine) + shift).exp();
                    share * odds / (1.0 - share + share * odds)
                });
                let mean = made.map(f64::from).sum::<f64>() / coarse.len() as f64;
                let ratio = mean / f64::from(share);
                assert!((ratio - 1.0).abs() < off, "{channel} {share}: {ratio}");
            }
        }
    }

    #[test]
    fn slopes_are_as_steep_as_the_second_byte_changes() {
        let [clouds, land] = detail_tiles();
        slopes_are_those_of_the_second_byte(&clouds, CLOUD_SLOPE_STEP);
        slopes_are_those_of_the_second_byte(&land, LAND_SLOPE_STEP);
    }

    fn slopes_are_those_of_the_second_byte(tile: &LayerImage, slope_step: f32) {
        for (level, texels) in tile.levels.iter().enumerate().take(6) {
            let width = 1024 >> level;
            let code = |column: usize, row: usize, channel: usize| {
                f32::from(texels[4 * ((row % width) * width + column % width) + channel])
            };
            let mut clipped = 0;
            for row in 1..=width {
                for column in 1..=width {
                    let rise = [
                        code(column + 1, row, SOFT) - code(column - 1, row, SOFT),
                        code(column, row + 1, SOFT) - code(column, row - 1, SOFT),
                    ];
                    for (channel, rise) in [(2, rise[0]), (3, rise[1])] {
                        let slope = code(column, row, channel);
                        clipped += usize::from(slope == 0.0 || slope == 255.0);
                        let shown = 2.0 * slope_step * (slope - DETAIL_MEAN);
                        let clamped = rise.clamp(-256.0 * slope_step, 254.0 * slope_step);
                        // Soft values are rounded to half a step.
                        assert!(
                            (shown - clamped).abs() < 1.3,
                            "level {level}: {shown}, {rise}"
                        );
                    }
                }
            }
            assert!(
                clipped * 1000 < 2 * width * width,
                "level {level}: {clipped}"
            );
        }
    }

    #[test]
    fn they_repeat_without_a_seam() {
        for tile in detail_tiles() {
            repeats_without_a_seam(&values(&tile.levels[0], 0));
            repeats_without_a_seam(&values(&tile.levels[0], 1));
        }
    }

    fn repeats_without_a_seam(tile: &[f32]) {
        let at = |x: usize, y: usize| tile[(y % 1024) * 1024 + x % 1024];
        let step = |from: usize| {
            let steps = (0..1024).map(|n| {
                let (across, down) = (at(from + 1, n) - at(from, n), at(n, from + 1) - at(n, from));
                across * across + down * down
            });
            steps.sum::<f32>() / 1024.0
        };
        let anywhere = (0..1023).map(step).sum::<f32>() / 1023.0;
        assert!(step(1023) < 1.5 * anywhere, "{} and {anywhere}", step(1023));
    }

    /// Streaks across a border would vary along it and not across it.
    #[test]
    fn its_borders_are_not_streaked() {
        let [clouds, _] = detail_tiles();
        let tile = values(&clouds.levels[0], VALUE);
        let at = |x: usize, y: usize| tile[(y % 1024) * 1024 + x % 1024];
        // Mean squares of the changes from texel to texel along these rows and across them, and with columns for rows.
        let changes = |rows: std::ops::Range<usize>, is_turned: bool| {
            let value = |along: usize, row: usize| match is_turned {
                true => at(row, along),
                false => at(along, row),
            };
            let (mut along, mut across) = (0.0, 0.0);
            for row in rows {
                for n in 0..1024 {
                    along += (value(n + 1, row) - value(n, row)).powi(2);
                    across += (value(n, row + 1) - value(n, row)).powi(2);
                }
            }
            across / along
        };
        for is_turned in [false, true] {
            let anywhere = changes(0..1024, is_turned);
            let border = changes(1020..1028, is_turned);
            assert!(
                border > 0.75 * anywhere,
                "{border} and {anywhere} elsewhere"
            );
        }
    }
}
