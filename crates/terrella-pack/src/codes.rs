//! Values as the bytes that tiles keep, and back: one byte a channel; colour without alpha until a tile is made.

use terrella_imagery::slopes::snorm8;
use terrella_imagery::srgb::{LINEAR_FROM_SRGB, SrgbEncoder};

/// The bytes of values of 3 channels (linear colour), 2 (slopes) or 1 (amount), saturated.
pub(super) fn encode<const C: usize>(values: &[f32], bytes: &mut [u8]) {
    match C {
        3 => {
            let srgb = SrgbEncoder::new();
            for (byte, value) in bytes.iter_mut().zip(values) {
                *byte = srgb.code(*value);
            }
        }
        2 => {
            for (byte, value) in bytes.iter_mut().zip(values) {
                *byte = snorm8(f64::from(*value));
            }
        }
        _ => {
            for (byte, value) in bytes.iter_mut().zip(values) {
                // `as` saturates and takes NaN to 0.
                *byte = (value * 255.0 + 0.5) as u8;
            }
        }
    }
}

/// The value of each byte.
pub(super) fn decoded<const C: usize>() -> [f32; 256] {
    match C {
        3 => *LINEAR_FROM_SRGB,
        // −128 and −127 both mean −1.
        2 => std::array::from_fn(|code| (f32::from(code as u8 as i8) / 127.0).max(-1.0)),
        _ => std::array::from_fn(|code| code as f32 / 255.0),
    }
}
