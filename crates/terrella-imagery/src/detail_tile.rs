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

#[cfg(any(test, feature = "detail-tile"))]
const COMPILED_IN: Option<&[u8]> = Some(include_bytes!("../data/detail_tile.jpg"));
#[cfg(not(any(test, feature = "detail-tile")))]
const COMPILED_IN: Option<&[u8]> = None;

/// Edge of the tile, texels.
const SIZE: (u32, u32) = (1024, 1024);

/// The tile of [`supply_detail_tile`].
static SUPPLIED: OnceLock<LayerImage> = OnceLock::new();

/// Why a file is not the tile.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("detail_tile.jpg: {cause}; take the file of this version")]
pub struct DetailTileError {
    cause: String,
}

/// A square of clouds' fine structure with its mip levels: no map, but a tile to repeat in all directions. Its values have the mean
/// 0 and the variance 1, as bytes by [`DETAIL_STEP`].
///
/// Its first row and its first column are the same and read the same from both ends, so that a whole number of tiles along each edge
/// covers the six sides of a cube without a seam. It is a part of the starter pack's cloud map, without structures larger than some 64
/// texels. The feature `detail-tile` compiles it in. Without the feature and before [`supply_detail_tile`], the tile is one texel
/// without structure.
pub fn detail_tile() -> LayerImage {
    let supplied = SUPPLIED.get().cloned();
    // A test decodes the compiled tile.
    let tile = supplied.or_else(|| decoded(COMPILED_IN?).ok());
    tile.unwrap_or_else(|| LayerImage {
        width: 1,
        height: 1,
        format: TexelFormat::R8Unorm,
        levels: [vec![DETAIL_MEAN as u8]].into(),
    })
}

/// Takes the contents of `detail_tile.jpg`, for programs without the feature `detail-tile`. Earths that are made later show it. The first file
/// stays.
///
/// # Errors
/// A file that is no whole JPEG of the tile's size.
pub fn supply_detail_tile(jpeg: &[u8]) -> Result<(), DetailTileError> {
    // The decoder fills the rest of a file that breaks off.
    let whole = Picture::open(FileKind::Jpeg, jpeg).and_then(|picture| picture.check_whole());
    let tile = whole.and_then(|_| decoded(jpeg));
    let tile = tile.map_err(|cause| DetailTileError { cause })?;
    // A second file is the same one.
    let _ = SUPPLIED.set(tile);
    Ok(())
}

/// The tile of a file. The error is its cause.
fn decoded(jpeg: &[u8]) -> Result<LayerImage, String> {
    let picture = Picture::open(FileKind::Jpeg, jpeg)?;
    let ((width, height), kind) = (picture.size(), picture.texel_kind());
    if ((width, height), kind) != (SIZE, TexelKind::grey(8)) {
        return Err(format!("it has {width} × {height} texels of {kind}"));
    }
    let format = TexelFormat::R8Unorm;
    let levels = mips::chain(picture.texels()?, width as usize, height as usize, format);
    Ok(LayerImage {
        width,
        height,
        format,
        levels: levels.into(),
    })
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

    #[test]
    fn another_file_is_rejected() {
        let error = supply_detail_tile(b"no picture")
            .expect_err("no JPEG")
            .to_string();
        assert!(error.starts_with("detail_tile.jpg: "), "{error}");
        let jpeg = COMPILED_IN.expect("compiled into tests");
        assert!(supply_detail_tile(&jpeg[..jpeg.len() / 2]).is_err());
        supply_detail_tile(jpeg).expect("the tile itself");
        assert_eq!(detail_tile(), decoded(jpeg).expect("decodes"));
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
