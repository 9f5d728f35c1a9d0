//! Which colour a pixel sees.

/// The filters on the pixels, named by the first two pixels of the first row and of the second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mosaic {
    /// None: each pixel sees all bands.
    #[default]
    Mono,
    /// Red and green, green and blue.
    Rggb,
    /// Blue and green, green and red.
    Bggr,
    /// Green and red, blue and green.
    Grbg,
    /// Green and blue, red and green.
    Gbrg,
}

impl Mosaic {
    /// The band of a pixel, 0 red, 1 green, 2 blue; `None` sees all.
    pub fn band(self, x: u32, y: u32) -> Option<usize> {
        let cell = match self {
            Self::Mono => return None,
            Self::Rggb => [0, 1, 1, 2],
            Self::Bggr => [2, 1, 1, 0],
            Self::Grbg => [1, 0, 2, 1],
            Self::Gbrg => [1, 2, 0, 1],
        };
        Some(cell[(2 * (y % 2) + x % 2) as usize])
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mono => "mono",
            Self::Rggb => "rggb",
            Self::Bggr => "bggr",
            Self::Grbg => "grbg",
            Self::Gbrg => "gbrg",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_its_first_four_pixels() {
        for mosaic in [Mosaic::Rggb, Mosaic::Bggr, Mosaic::Grbg, Mosaic::Gbrg] {
            let cell = [(6, 8), (7, 8), (6, 9), (7, 9)].map(|(x, y)| mosaic.band(x, y));
            let letters = cell.map(|band| ["r", "g", "b"][band.expect("a filter")]);
            assert_eq!(letters.concat(), mosaic.name());
        }
        assert_eq!(Mosaic::Mono.band(3, 4), None);
    }
}
