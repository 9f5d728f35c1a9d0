//! Reads a stored sample as a number.

use super::SampleKind;

/// One sample as a number; for integers, the code.
pub(crate) fn sample(kind: SampleKind, bytes: &[u8], index: usize) -> f32 {
    let at = index * kind.bytes();
    match kind {
        SampleKind::U8 => f32::from(bytes[at]),
        SampleKind::U16 => f32::from(u16::from_ne_bytes([bytes[at], bytes[at + 1]])),
        SampleKind::I16 => f32::from(i16::from_ne_bytes([bytes[at], bytes[at + 1]])),
        SampleKind::F32 => {
            f32::from_ne_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
        }
    }
}
