//! A row of a raster: its texels, and which of them are there.

use crate::imagery::build::source::SourceInfo;

/// A row of a raster.
#[derive(Default)]
pub(super) struct RasterRow {
    /// Texels without alpha.
    pub bytes: Vec<u8>,
    /// 255 where there is a texel, 0 where there is none.
    pub cover: Vec<u8>,
    /// All of it is there.
    pub is_whole: bool,
}

/// Parts texels from their alpha.
pub(super) fn without_alpha(info: &SourceInfo, bytes: &[u8], row: &mut RasterRow) {
    let size = info.sample.bytes();
    row.is_whole = true;
    row.cover.clear();
    row.bytes.clear();
    if matches!(info.channels, 1 | 3) {
        row.bytes.extend_from_slice(bytes);
        row.cover.resize(info.width as usize, 255);
        return;
    }
    for texel in bytes.chunks_exact(info.channels * size) {
        let (colour, alpha) = texel.split_at(texel.len() - size);
        row.bytes.extend_from_slice(colour);
        // The highest byte of an integer says enough; alpha of floats is seldom, and counts where it is not 0.
        let cover = match size {
            1 => alpha[0],
            2 => u16::from_ne_bytes([alpha[0], alpha[1]]).to_be_bytes()[0],
            _ => 255 * u8::from(alpha.iter().any(|byte| *byte != 0)),
        };
        row.is_whole &= cover == 255;
        row.cover.push(cover);
    }
}
