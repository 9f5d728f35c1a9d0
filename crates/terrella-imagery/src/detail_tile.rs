//! Detail smaller than the texels of maps.

use super::decode::{FileKind, Picture};
use super::layer::LayerImage;
use super::mips;
use super::texel::TexelFormat;

/// The byte that is the mean.
pub const DETAIL_MEAN: f32 = 128.0;
/// Standard deviations that a step of one byte means.
pub const DETAIL_STEP: f32 = 3.2 / 127.0;

/// A square of clouds' fine structure with its mip levels: no map, but a tile to repeat in all directions. Its values have the mean
/// 0 and the variance 1, as bytes by [`DETAIL_STEP`].
///
/// Its first row and its first column are the same and read the same from both ends, so that a whole number of tiles along each edge
/// covers the six sides of a cube without a seam. It is a part of the starter pack's cloud map, without structures larger than some 64
/// texels, and is compiled in.
pub fn detail_tile() -> LayerImage {
    let (size, texels) = decoded().unwrap_or(((1, 1), vec![128]));
    LayerImage {
        width: size.0,
        height: size.1,
        format: TexelFormat::R8Unorm,
        levels: mips::chain(
            texels,
            size.0 as usize,
            size.1 as usize,
            TexelFormat::R8Unorm,
        )
        .into(),
    }
}

/// The embedded tile decodes: a test checks it.
fn decoded() -> Option<((u32, u32), Vec<u8>)> {
    let jpeg = include_bytes!("../data/detail_tile.jpg");
    let picture = Picture::open(FileKind::Jpeg, jpeg).ok()?;
    let size = picture.size();
    Some((size, picture.texels().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(texels: &[u8]) -> Vec<f32> {
        let values = texels
            .iter()
            .map(|byte| (f32::from(*byte) - DETAIL_MEAN) * DETAIL_STEP);
        values.collect()
    }

    fn variance(texels: &[u8]) -> f32 {
        let values = values(texels);
        let count = values.len() as f32;
        let mean = values.iter().sum::<f32>() / count;
        values
            .iter()
            .map(|value| (value - mean) * (value - mean))
            .sum::<f32>()
            / count
    }

    #[test]
    fn it_has_the_mean_0_and_the_variance_1() {
        let tile = detail_tile();
        assert_eq!(
            (tile.width, tile.height, tile.levels.len()),
            (1024, 1024, 11)
        );
        let values = values(&tile.levels[0]);
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        assert!(mean.abs() < 0.02, "{mean}");
        assert!((variance(&tile.levels[0]) - 1.0).abs() < 0.05);
    }

    /// The shader's `structure_of_size`.
    #[test]
    fn smaller_levels_show_what_the_shader_takes_them_to_show() {
        let tile = detail_tile();
        for (level, texels) in tile.levels.iter().enumerate().take(8) {
            let t = (level as f32 / 6.3).min(1.0);
            let expected = 1.0 - t * t * (3.0 - 2.0 * t);
            let shown = variance(texels);
            assert!(
                (shown - expected).abs() < 0.06,
                "level {level}: {shown} and not {expected}"
            );
        }
    }

    #[test]
    fn its_border_is_the_same_along_all_sides() {
        let tile = values(&detail_tile().levels[0]);
        let at = |x: usize, y: usize| tile[y * 1024 + x];
        let differences = (1..1024).map(|n| {
            let (row, column) = (at(n, 0) - at(0, n), at(0, n) - at(0, 1024 - n));
            row * row + column * column
        });
        let mean = differences.sum::<f32>() / 1023.0;
        // The compression's own error is as large.
        assert!(mean.sqrt() < 0.35, "{}", mean.sqrt());
    }
}
