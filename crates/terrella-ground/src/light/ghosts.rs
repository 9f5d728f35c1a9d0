//! Lens ghosts: images of the Sun after two reflections inside the lens.

use crate::step::smooth_step;
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// Images of a lens's aperture, on a line through the Sun and the centre of the image. The model is generic, without a
/// particular lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ghosts {
    /// Fraction of the Sun's light in all ghosts together, from [`Self::PARTS`].
    pub part: f64,
    /// Blades of the aperture, from [`super::Aperture::BLADES`]; `None` for a round one.
    pub blades: Option<u32>,
}

/// A ghost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ghost {
    /// Position, in multiples of the Sun's offset from the image centre; negative on the opposite
    /// side.
    pub place: f64,
    /// Radius of the circle through the aperture's corners, in image heights.
    pub radius: f64,
    /// Share of the light of all ghosts, in red, green and blue; coatings are coloured.
    pub shares: [f64; 3],
}

impl Ghosts {
    /// Range of [`Self::part`]. A coated surface reflects some 0.5 %, two of them 2.5e-5; a lens has dozens of such pairs.
    pub const PARTS: RangeInclusive<f64> = 0.0..=0.001;

    /// All ghosts. Their shares sum to at most 1 in each channel.
    pub const ALL: [Ghost; 6] = [
        ghost(-0.35, 0.035, [0.15, 0.26, 0.18]),
        ghost(-0.6, 0.06, [0.16, 0.18, 0.26]),
        ghost(-1.0, 0.11, [0.24, 0.18, 0.14]),
        ghost(-1.5, 0.05, [0.11, 0.08, 0.11]),
        ghost(0.45, 0.025, [0.16, 0.13, 0.08]),
        ghost(0.75, 0.08, [0.1, 0.16, 0.16]),
    ];

    /// Area of the aperture, in squares of its radius.
    pub fn area(&self) -> f64 {
        self.blades.map_or(PI, |blades| {
            let blades = f64::from(blades);
            0.5 * blades * (2.0 * PI / blades).sin()
        })
    }

    /// Remaining strength of the ghosts for a distance of the Sun from the image centre, in half diagonals. Outside the image the lens barrel
    /// shades the Sun.
    pub fn seen(distance: f64) -> f64 {
        smooth_step([1.4, 1.0], distance)
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
