//! The samples of a tile as bytes: differences from predictions by their neighbours, compressed.

use super::{HeightKind, HeightsEntry};
use crate::pack::zstandard::{compress, decompress};

/// Zstandard's level: a third smaller than its usual one, decompressed as fast.
const ZSTD_LEVEL: i32 = 12;

/// Samples of a tile as they are stored.
#[derive(Clone, Debug, PartialEq)]
pub enum HeightValues {
    /// Steps.
    I16(Vec<i16>),
    /// Metres.
    F32(Vec<f32>),
}

impl HeightValues {
    /// Lowest and highest sample, metres; `None` if there is none.
    pub fn range_m(&self, kind: HeightKind) -> Option<(f64, f64)> {
        let range = |metres: &mut dyn Iterator<Item = f64>| {
            metres.fold(None, |range: Option<(f64, f64)>, height_m| {
                let (low_m, high_m) = range.unwrap_or((height_m, height_m));
                Some((low_m.min(height_m), high_m.max(height_m)))
            })
        };
        match (self, kind) {
            (Self::I16(values), HeightKind::I16 { offset_m, scale_m }) => {
                let low = values.iter().min()?;
                let high = values.iter().max()?;
                let metres = |step: &i16| offset_m + scale_m * f64::from(*step);
                Some((metres(low), metres(high)))
            }
            (Self::F32(values), _) => range(&mut values.iter().map(|value| f64::from(*value))),
            (Self::I16(_), HeightKind::F32) => None,
        }
    }
}

/// The bytes of a tile's file; rows have so many samples.
///
/// # Errors
/// The compressor's.
pub fn encode_heights(values: &HeightValues, row_samples: usize) -> std::io::Result<Vec<u8>> {
    let bytes = match values {
        HeightValues::I16(values) => {
            let codes: Vec<u16> = values.iter().map(|value| *value as u16).collect();
            let folded = residues(codes.len(), row_samples, |n| u32::from(codes[n]), 16);
            planes(&folded, 2)
        }
        HeightValues::F32(values) => {
            let folded = residues(values.len(), row_samples, |n| ordered(values[n]), 32);
            planes(&folded, 4)
        }
    };
    compress(&bytes, ZSTD_LEVEL)
}

/// Decodes a tile's file, which is not trusted: exactly the bytes of the tile are allocated, and no more is decompressed than fits.
///
/// # Errors
/// The error in it, without its name: its size, the compressed data, elevations that are not finite.
pub fn decode_heights(bytes: &[u8], entry: &HeightsEntry) -> Result<HeightValues, String> {
    let most = entry.most_file_bytes();
    if bytes.len() > most {
        return Err(format!(
            "it has {} bytes, and such a tile has at most {most}",
            bytes.len()
        ));
    }
    let (count, row) = (entry.tile_samples(), entry.row_samples());
    let mut raw = vec![0; count * entry.kind.bytes()];
    decompress(bytes, &mut raw).map_err(|cause| format!("it cannot be decompressed: {cause}"))?;
    match entry.kind {
        HeightKind::I16 { .. } => {
            let codes = restored(&raw, count, row, 2);
            Ok(HeightValues::I16(
                codes.into_iter().map(|code| code as u16 as i16).collect(),
            ))
        }
        HeightKind::F32 => {
            let codes = restored(&raw, count, row, 4);
            let values: Vec<f32> = codes.into_iter().map(of_ordered).collect();
            if values.iter().any(|value| !value.is_finite()) {
                return Err("it has heights that are no numbers".into());
            }
            Ok(HeightValues::F32(values))
        }
    }
}

/// Bits of a number in the order of whole numbers.
fn ordered(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 0 {
        bits | 1 << 31
    } else {
        !bits
    }
}

fn of_ordered(code: u32) -> f32 {
    f32::from_bits(if code >> 31 == 1 {
        code & !(1 << 31)
    } else {
        !code
    })
}

/// Prediction from the neighbours.
#[inline]
fn expected(n: usize, row: usize, at: impl Fn(usize) -> u32) -> u32 {
    match (n / row, n % row) {
        (0, 0) => 0,
        (0, _) => at(n - 1),
        (_, 0) => at(n - row),
        _ => at(n - 1)
            .wrapping_add(at(n - row))
            .wrapping_sub(at(n - row - 1)),
    }
}

/// Folded differences from the prediction, for codes of this many bits.
fn residues(count: usize, row: usize, at: impl Fn(usize) -> u32, bits: u32) -> Vec<u32> {
    // To the highest bits and back: differences wrap at the width of the codes.
    let shift = 32 - bits;
    (0..count)
        .map(|n| {
            let residue = (at(n).wrapping_sub(expected(n, row, &at)) << shift) as i32 >> shift;
            (residue << 1 ^ residue >> 31) as u32
        })
        .collect()
}

/// All lowest bytes, then all the next.
fn planes(folded: &[u32], bytes: u32) -> Vec<u8> {
    (0..bytes)
        .flat_map(|byte| folded.iter().map(move |code| (code >> (8 * byte)) as u8))
        .collect()
}

/// Codes from the bytes of their folded differences; of less than 32 bits with anything above them.
fn restored(raw: &[u8], count: usize, row: usize, bytes: usize) -> Vec<u32> {
    let mut codes: Vec<u32> = Vec::with_capacity(count);
    for n in 0..count {
        let folded = (0..bytes).fold(0, |code, byte| {
            code | u32::from(raw[byte * count + n]) << (8 * byte)
        });
        let residue = folded >> 1 ^ (folded & 1).wrapping_neg();
        let code = expected(n, row, |n| codes[n]).wrapping_add(residue);
        codes.push(code);
    }
    codes
}
