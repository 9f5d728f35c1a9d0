//! The sRGB transfer function (IEC 61966-2-1) by table, exact for 8-bit values both ways.

use std::sync::LazyLock;

/// Linear light of every 8-bit sRGB value.
pub static LINEAR_FROM_SRGB: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| linear_from_encoded(code as f64 / 255.0) as f32));

/// Luminance of an RGB colour by the weights of ITU-R BT.709.
pub const fn luminance([red, green, blue]: [f32; 3]) -> f32 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

/// C = E/12.92 for E ≤ 0.04045, else ((E + 0.055)/1.055)^2.4.
pub fn linear_from_encoded(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

const BUCKETS: usize = 4096;

/// Linear values of one part in [`BUCKETS`].
#[derive(Clone, Copy)]
struct Bucket {
    /// Value from which on the code is higher by one: a bucket contains at most one such bound where the curve is steepest (12.92 · 255/4096 = 0.8
    /// codes). NaN, which no value reaches, if it contains none.
    bound: f32,
    /// The code of its darkest value.
    first: u8,
}

static ENCODER: LazyLock<[Bucket; BUCKETS]> = LazyLock::new(|| {
    // From the nth on n + 1 is the nearest code.
    let bounds: [f32; 255] =
        std::array::from_fn(|code| linear_from_encoded((code as f64 + 0.5) / 255.0) as f32);
    std::array::from_fn(|bucket| {
        let darkest = bucket as f32 / BUCKETS as f32;
        let first = bounds.partition_point(|bound| *bound <= darkest);
        Bucket {
            bound: bounds.get(first).copied().unwrap_or(f32::NAN),
            first: first as u8,
        }
    })
});

/// The nearest 8-bit sRGB value, nearest in encoded space. Takes 0…1, saturates outside, 0 for NaN.
pub struct SrgbEncoder(&'static [Bucket; BUCKETS]);

impl Default for SrgbEncoder {
    fn default() -> Self {
        Self::new()
    }
}

impl SrgbEncoder {
    /// With its table filled.
    pub fn new() -> Self {
        Self(&ENCODER)
    }

    /// The code, 0…255, of a linear value of 0…1.
    pub fn code(&self, linear: f32) -> u8 {
        // `as` saturates and maps NaN to 0; via i32, which processors convert to in one instruction.
        let bucket = ((linear * BUCKETS as f32) as i32).clamp(0, BUCKETS as i32 - 1);
        let Bucket { bound, first } = self.0[bucket as usize];
        first + u8::from(linear >= bound)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives_the_round_trip() {
        let encoder = SrgbEncoder::new();
        for code in 0..=255u8 {
            assert_eq!(encoder.code(LINEAR_FROM_SRGB[code as usize]), code);
        }
    }

    #[test]
    fn encoding_is_the_nearest_code_everywhere() {
        let encoder = SrgbEncoder::new();
        for step in 0..=100_000u32 {
            let linear = f64::from(step) / 100_000.0;
            let encoded = if linear <= 0.003_130_8 {
                linear * 12.92
            } else {
                1.055 * linear.powf(1.0 / 2.4) - 0.055
            };
            let error = (f64::from(encoder.code(linear as f32)) - encoded * 255.0).abs();
            assert!(error < 0.502, "linear {linear}: off by {error} codes");
        }
        assert_eq!(encoder.code(-1.0), 0);
        assert_eq!(encoder.code(7.0), 255);
        assert_eq!(encoder.code(f32::INFINITY), 255);
        assert_eq!(encoder.code(f32::NEG_INFINITY), 0);
        assert_eq!(encoder.code(f32::NAN), 0);
    }
}
