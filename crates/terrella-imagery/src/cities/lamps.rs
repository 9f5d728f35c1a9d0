//! The colours of lamps.

use crate::srgb::luminance;

/// Colour that maps of lights are drawn in, linear RGB.
pub const LAMP_COLOR: [f32; 3] = [1.0, 0.72, 0.38];

/// Light that the air over lamps adds, relative to theirs: a hemisphere of light, scattered evenly by a vertical optical depth of τ, gives τ/2 of its
/// radiance to a view from above. τ is 0.25 at 550 nm. The light arrives from some kilometres around.
pub const LAMP_GLOW: f64 = 0.125;

/// Luminance of every lamp's colour; no channel of any is above 1 then.
const LAMP_LUMINANCE: f32 = 0.5;
/// How many times more light a lamp of these colours has where it takes the place of a map's.
pub const LIGHT_OF_MAP: f32 = luminance(LAMP_COLOR) / LAMP_LUMINANCE;

/// A kind of lamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lamp {
    /// High-pressure sodium.
    Sodium,
    /// White light-emitting diodes of 3000 K.
    WarmWhite,
    /// Those of 4000 K and more, and fluorescent lamps.
    NeutralWhite,
    /// Metal halide and mercury: harbours, stadiums, greenhouses.
    CoolWhite,
}

impl Lamp {
    const ALL: [Self; 4] = [
        Self::Sodium,
        Self::WarmWhite,
        Self::NeutralWhite,
        Self::CoolWhite,
    ];

    /// As a camera balanced for daylight shows it, linear RGB, at the luminance that all lamps have.
    pub fn color(self) -> [f32; 3] {
        let rgb = match self {
            Self::Sodium => [1.0, 0.50, 0.12],
            Self::WarmWhite => [1.0, 0.64, 0.34],
            Self::NeutralWhite => [1.0, 0.82, 0.62],
            Self::CoolWhite => [0.80, 1.0, 1.02],
        };
        let luminance = luminance(rgb);
        rgb.map(|channel| channel * LAMP_LUMINANCE / luminance)
    }
}

/// Shares of the kinds, in their order, where nothing else is known, and where it is: orders of magnitude for the years about 2020, from
/// what photographs from orbit and national inventories show. Belgium kept its sodium, Germany and Japan their white lamps.
const USUAL: [f32; 4] = [0.55, 0.20, 0.20, 0.05];
#[rustfmt::skip]
const BY_COUNTRY: [(&[u8; 2], [f32; 4]); 24] = [
    (b"AT", [0.40, 0.30, 0.25, 0.05]),
    (b"AU", [0.45, 0.20, 0.25, 0.10]),
    (b"BE", [0.80, 0.12, 0.06, 0.02]),
    (b"CA", [0.45, 0.30, 0.22, 0.03]),
    (b"CH", [0.40, 0.30, 0.25, 0.05]),
    (b"CN", [0.50, 0.15, 0.27, 0.08]),
    (b"CZ", [0.60, 0.22, 0.15, 0.03]),
    (b"DE", [0.25, 0.25, 0.40, 0.10]),
    (b"DK", [0.30, 0.40, 0.25, 0.05]),
    (b"EG", [0.65, 0.12, 0.15, 0.08]),
    (b"ES", [0.60, 0.22, 0.15, 0.03]),
    (b"FR", [0.55, 0.25, 0.17, 0.03]),
    (b"GB", [0.40, 0.28, 0.30, 0.02]),
    (b"IE", [0.60, 0.15, 0.22, 0.03]),
    (b"IN", [0.45, 0.12, 0.35, 0.08]),
    (b"IT", [0.35, 0.25, 0.37, 0.03]),
    (b"JP", [0.20, 0.15, 0.50, 0.15]),
    (b"KR", [0.35, 0.20, 0.35, 0.10]),
    (b"MX", [0.55, 0.15, 0.25, 0.05]),
    (b"NL", [0.50, 0.28, 0.15, 0.07]),
    (b"PL", [0.70, 0.15, 0.12, 0.03]),
    (b"RU", [0.60, 0.12, 0.22, 0.06]),
    (b"TR", [0.60, 0.15, 0.20, 0.05]),
    (b"US", [0.40, 0.27, 0.28, 0.05]),
];

/// The type of lamp at a quantile of 0…1 of all lamps of a country.
pub fn lamp_of(country: [u8; 2], share: f32) -> Lamp {
    let known = BY_COUNTRY.iter().find(|(code, _)| **code == country);
    let shares = known.map_or(USUAL, |(_, shares)| *shares);
    let mut up_to = 0.0;
    let kinds = Lamp::ALL.into_iter().zip(shares);
    let kind = kinds.into_iter().find(|(_, part)| {
        up_to += part;
        share < up_to
    });
    kind.map_or(Lamp::Sodium, |(lamp, _)| lamp)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_and_colours_have_one_luminance() {
        for (country, shares) in BY_COUNTRY.iter().chain([&(b"--", USUAL)]) {
            let sum: f32 = shares.iter().sum();
            assert!((sum - 1.0).abs() < 1e-6, "{country:?}");
        }
        assert!(BY_COUNTRY.is_sorted_by_key(|(code, _)| **code));
        for lamp in Lamp::ALL {
            let color = lamp.color();
            let luminance = luminance(color);
            assert!((luminance - LAMP_LUMINANCE).abs() < 1e-6, "{lamp:?}");
            assert!(color.iter().all(|channel| *channel <= 1.0), "{color:?}");
        }
        let of = |share| lamp_of(*b"BE", share);
        assert_eq!(
            [of(0.0), of(0.79), of(0.81)],
            [Lamp::Sodium, Lamp::Sodium, Lamp::WarmWhite]
        );
        assert_eq!(lamp_of(*b"ZZ", 0.99), Lamp::CoolWhite);
    }
}
