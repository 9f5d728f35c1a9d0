//! A row of a raster: its texels, and which of them are there.

use crate::source::sample;
use crate::source::{Opacity, SampleKind, SourceInfo};
use crate::values::opaque_part;

#[derive(Default)]
pub(super) struct RasterRow {
    /// Texels without alpha.
    pub bytes: Vec<u8>,
    /// 255 where there is a texel, 0 where there is none.
    pub cover: Vec<u8>,
    pub is_whole: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AlphaMeans {
    /// Presence of a texel: the layer beneath is visible through the rest.
    Presence,
    /// How much of the amount that is drawn: cover of clouds, intensity of lights.
    Amount,
}

/// Parts texels from their alpha.
pub(super) fn without_alpha(
    info: &SourceInfo,
    means: AlphaMeans,
    bytes: &[u8],
    row: &mut RasterRow,
) {
    row.is_whole = true;
    row.cover.clear();
    row.bytes.clear();
    let Some(opacity) = info.opacity else {
        row.bytes.extend_from_slice(bytes);
        row.cover.resize(info.width as usize, 255);
        return;
    };
    let is_amount = opacity == Opacity::Alpha && means == AlphaMeans::Amount;
    let size = info.sample.bytes();
    for texel in bytes.chunks_exact(info.channels * size) {
        let (colour, alpha) = texel.split_at(texel.len() - size);
        if is_amount {
            let part = opaque_part(info.sample, alpha, 0);
            for channel in colour.chunks_exact(size) {
                scale(info.sample, channel, part, &mut row.bytes);
            }
            row.cover.push(255);
            continue;
        }
        row.bytes.extend_from_slice(colour);
        // The highest byte of an integer is precise enough; alpha of floats is rare, and counts where it is not 0.
        let cover = match size {
            1 => alpha[0],
            2 => u16::from_ne_bytes([alpha[0], alpha[1]]).to_be_bytes()[0],
            _ => 255 * u8::from(alpha.iter().any(|byte| *byte != 0)),
        };
        row.is_whole &= cover == 255;
        row.cover.push(cover);
    }
}

/// Appends a sample times a part of one.
fn scale(kind: SampleKind, bytes: &[u8], part: f32, out: &mut Vec<u8>) {
    let value = sample(kind, bytes, 0) * part;
    // `as` saturates.
    match kind {
        SampleKind::U8 => out.push(value.round() as u8),
        SampleKind::U16 => out.extend((value.round() as u16).to_ne_bytes()),
        SampleKind::I16 => out.extend((value.round() as i16).to_ne_bytes()),
        SampleKind::F32 => out.extend(value.to_ne_bytes()),
    }
}
