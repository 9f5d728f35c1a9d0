//! IEEE half floats, as in textures.

/// Converts a finite f32 to IEEE half bits, rounded to nearest. The magnitude is limited to 65504;
/// below 2⁻²⁴ it is zero.
pub fn half_bits(value: f32) -> u16 {
    let sign = if value < 0.0 { 0x8000 } else { 0 };
    let size = value.abs().min(65504.0);
    if size < 6.103_515_6e-5 {
        // Subnormal: units of 2⁻²⁴.
        return sign | (size * 16_777_216.0).round() as u16;
    }
    let bits = size.to_bits() + 0x1000;
    sign | ((bits >> 13) - ((127 - 15) << 10)) as u16
}

/// The value of an IEEE half.
pub fn float_of_half(bits: u16) -> f32 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let exponent = i32::from(bits >> 10 & 0x1f);
    let mantissa = f32::from(bits & 0x3ff);
    let size = match exponent {
        0 => mantissa * 2f32.powi(-24),
        31 if mantissa == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        _ => (1024.0 + mantissa) * 2f32.powi(exponent - 25),
    };
    sign * size
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_match_known_patterns() {
        for (value, bits) in [
            (0.0, 0),
            (1.0, 0x3c00),
            (0.5, 0x3800),
            (65504.0, 0x7bff),
            (1e9, 0x7bff),
            (6.103_515_6e-5, 0x0400),
            (5.960_464_5e-8, 1),
            (-0.5, 0xb800),
            (-5.960_464_5e-8, 0x8001),
        ] {
            assert_eq!(half_bits(value), bits, "{value}");
        }
        // One third rounds to the nearest half.
        assert_eq!(half_bits(1.0 / 3.0), 0x3555);
    }

    #[test]
    fn floats_match_known_patterns() {
        for (bits, value) in [
            (0x0000, 0.0),
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65_504.0),
            (0x0001, 5.960_464_5e-8),
            (0x0400, 6.103_515_6e-5),
            (0x3555, 0.333_251_95),
            (0xfc00, f32::NEG_INFINITY),
        ] {
            assert_eq!(float_of_half(bits), value);
        }
        assert!(float_of_half(0x7e00).is_nan());
    }

    #[test]
    fn every_finite_half_is_its_own_nearest() {
        for bits in (0..=0x7bff).chain(0x8001..=0xfbff) {
            assert_eq!(half_bits(float_of_half(bits)), bits);
        }
    }
}
