//! Ghosts of a lens: what two reflections inside it make of the Sun.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// Images of a lens's aperture, in a line through the Sun and the middle of the picture. A model of no lens in particular.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ghosts {
    /// Part of the Sun's light that all of them have together, from [`Self::PARTS`].
    pub part: f64,
    /// Blades of the aperture, from [`super::Aperture::BLADES`]; `None` for a round one.
    pub blades: Option<u32>,
}

/// A ghost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ghost {
    /// Where it is, in distances of the Sun from the middle of the picture: below 0 it is mirrored.
    pub place: f64,
    /// Radius of the circle through the aperture's corners, in heights of the picture.
    pub radius: f64,
    /// Its part of the light of all, in red, green and blue: coatings have a colour.
    pub shares: [f64; 3],
}

impl Ghosts {
    /// What [`Self::part`] may be. A coated surface reflects some 0.5 %, two of them 2.5e-5; a lens has dozens of such pairs.
    pub const PARTS: RangeInclusive<f64> = 0.0..=0.001;

    /// All of them. Their shares are at most 1 in each channel together.
    pub const ALL: [Ghost; 6] = [
        ghost(-0.35, 0.035, [0.15, 0.26, 0.18]),
        ghost(-0.6, 0.06, [0.16, 0.18, 0.26]),
        ghost(-1.0, 0.11, [0.24, 0.18, 0.14]),
        ghost(-1.5, 0.05, [0.11, 0.08, 0.11]),
        ghost(0.45, 0.025, [0.16, 0.13, 0.08]),
        ghost(0.75, 0.08, [0.1, 0.16, 0.16]),
    ];

    /// Area of the aperture in squares of its radius.
    pub fn area(&self) -> f64 {
        self.blades.map_or(PI, |blades| {
            let blades = f64::from(blades);
            0.5 * blades * (2.0 * PI / blades).sin()
        })
    }

    /// How much of the ghosts is left where the Sun is so far from the middle of the picture, in halves of its diagonal: outside of the picture
    /// the barrel of the lens shades it.
    pub fn seen(distance: f64) -> f64 {
        let [inside, outside] = [1.0, 1.4];
        let t = ((outside - distance) / (outside - inside)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

const fn ghost(place: f64, radius: f64, shares: [f64; 3]) -> Ghost {
    Ghost {
        place,
        radius,
        shares,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ghosts_have_no_more_than_their_part() {
        for channel in 0..3 {
            let sum: f64 = Ghosts::ALL.iter().map(|one| one.shares[channel]).sum();
            assert!((0.9..=1.0 + 1e-12).contains(&sum), "{channel}: {sum}");
        }
    }

    #[test]
    fn many_blades_are_round() {
        let area = |blades| Ghosts { part: 0.0, blades }.area();
        assert!((area(Some(4)) - 2.0).abs() < 1e-12 && area(None) == PI);
        assert!((area(Some(10_000)) - PI).abs() < 1e-6);
    }
}
