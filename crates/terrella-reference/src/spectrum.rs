//! Light by wavelength, and its colour.
//!
//! The inputs are this renderer's own: neither the drawn air nor the tables that both are compared with (`terrella_measure::clear_air`) use them.

use glam::DVec3;

/// Bands of equal width from [`FIRST_NM`] to [`LAST_NM`].
pub(super) const BANDS: usize = 16;

/// A value in each band.
pub(super) type Spectrum = [f64; BANDS];

/// Where the first band begins and the last one ends, nanometres.
const FIRST_NM: f64 = 380.0;
const LAST_NM: f64 = 780.0;

/// Wavelengths in a band at which its means are taken.
const POINTS: usize = 40;

/// Irradiance of the Sun outside the air at nanometres, W/m²/µm: Neckel and Labs 1981 (Solar Physics 74, 231), as tabulated
/// by Bird and Riordan 1986 (J. Climate Appl. Meteor. 25, 87).
#[rustfmt::skip]
const SUN: [(f64, f64); 36] = [
    (370.0, 1119.9),
    (380.0, 1103.8),
    (390.0, 1033.8),
    (400.0, 1479.1),
    (410.0, 1701.3),
    (420.0, 1740.4),
    (430.0, 1587.2),
    (440.0, 1837.0),
    (450.0, 2005.0),
    (460.0, 2043.0),
    (470.0, 1987.0),
    (480.0, 2027.0),
    (490.0, 1896.0),
    (500.0, 1909.0),
    (510.0, 1927.0),
    (520.0, 1831.0),
    (530.0, 1891.0),
    (540.0, 1898.0),
    (550.0, 1892.0),
    (570.0, 1840.0),
    (593.0, 1768.0),
    (610.0, 1728.0),
    (630.0, 1658.0),
    (656.0, 1524.0),
    (667.6, 1531.0),
    (690.0, 1420.0),
    (710.0, 1399.0),
    (718.0, 1374.0),
    (724.4, 1373.0),
    (740.0, 1298.0),
    (752.5, 1269.0),
    (757.5, 1245.0),
    (762.5, 1223.0),
    (767.5, 1205.0),
    (780.0, 1183.0),
    (800.0, 1148.0),
];

/// Linear sRGB from XYZ, IEC 61966-2-1.
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.2406, -1.5372, -0.4986],
    [-0.9689, 1.8758, 0.0415],
    [0.0557, -0.2040, 1.0570],
];

/// The CIE 1931 observer at a wavelength by the sums of lobes of Wyman, Sloan and Shirley 2013 (J. Comput. Graph. Tech. 2,
/// 2, section 2.2).
fn observer(nm: f64) -> [f64; 3] {
    let lobe = |height: f64, middle: f64, below: f64, above: f64| {
        let slope = if nm < middle { below } else { above };
        height * (-0.5 * ((nm - middle) * slope).powi(2)).exp()
    };
    [
        lobe(0.362, 442.0, 0.0624, 0.0374)
            + lobe(1.056, 599.8, 0.0264, 0.0323)
            + lobe(-0.065, 501.1, 0.0490, 0.0382),
        lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
        lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725),
    ]
}

/// The Sun's irradiance at a wavelength.
fn sunlight(nm: f64) -> f64 {
    let above = SUN
        .partition_point(|(at, _)| *at <= nm)
        .clamp(1, SUN.len() - 1);
    let ((from, low), (to, high)) = (SUN[above - 1], SUN[above]);
    low + (high - low) * (nm - from) / (to - from)
}

/// Wavelengths of a band, nanometres.
fn wavelengths(band: usize) -> impl Iterator<Item = f64> {
    let width = (LAST_NM - FIRST_NM) / BANDS as f64;
    (0..POINTS).map(move |i| FIRST_NM + width * (band as f64 + (i as f64 + 0.5) / POINTS as f64))
}

/// The mean of a function of the wavelength, nanometres, in each band: the Sun's light that an eye sees counts.
pub(super) fn band_means(value: impl Fn(f64) -> f64) -> Spectrum {
    std::array::from_fn(|band| {
        let (mut sum, mut weights) = (0.0, 0.0);
        for nm in wavelengths(band) {
            let weight = sunlight(nm) * observer(nm).iter().sum::<f64>();
            sum += weight * value(nm);
            weights += weight;
        }
        sum / weights
    })
}

/// Contribution of each band of light, relative to the Sun's, to the colour.
#[derive(Clone, Debug)]
pub(super) struct Colors {
    /// For red, green and blue; each sums to 1, so that the Sun is white.
    weights: [Spectrum; 3],
}

impl Colors {
    pub fn new() -> Self {
        let xyz = |band| {
            wavelengths(band).fold([0.0; 3], |sum: [f64; 3], nm| {
                let seen = observer(nm);
                std::array::from_fn(|i| sum[i] + seen[i] * sunlight(nm))
            })
        };
        let weights = RGB_FROM_XYZ.map(|row| -> Spectrum {
            std::array::from_fn(|band| xyz(band).iter().zip(row).map(|(v, w)| v * w).sum())
        });
        Self {
            weights: weights.map(|weights| {
                let all: f64 = weights.iter().sum();
                weights.map(|weight| weight / all)
            }),
        }
    }

    /// The colour of light that is given relative to the Sun's: linear sRGB with the Sun as white, not clamped.
    pub fn rgb(&self, light: &Spectrum) -> DVec3 {
        self.rgb_of(|_, band| light[band])
    }

    /// The same of light that is another one for each channel: 0, 1, 2.
    pub fn rgb_of(&self, light: impl Fn(usize, usize) -> f64) -> DVec3 {
        let channel = |i: usize| -> f64 {
            let weights = self.weights[i].iter().enumerate();
            weights.map(|(band, weight)| weight * light(i, band)).sum()
        };
        DVec3::new(channel(0), channel(1), channel(2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_is_white_and_bands_have_their_colours() {
        let colors = Colors::new();
        let white = colors.rgb(&[1.0; BANDS]);
        assert!((white - DVec3::ONE).abs().max_element() < 1e-12, "{white}");
        let only = |nm: f64| {
            let band = ((nm - FIRST_NM) / (LAST_NM - FIRST_NM) * BANDS as f64) as usize;
            colors.rgb(&std::array::from_fn(|i| f64::from(i == band)))
        };
        assert_eq!(only(450.0).max_position(), 2);
        assert_eq!(only(550.0).max_position(), 1);
        assert_eq!(only(620.0).max_position(), 0);
    }

    #[test]
    fn means_are_of_what_is_in_the_band() {
        assert!(
            band_means(|_| 3.0)
                .iter()
                .all(|mean| (mean - 3.0).abs() < 1e-12)
        );
        let means = band_means(|nm| nm);
        for (band, mean) in means.iter().enumerate() {
            let width = (LAST_NM - FIRST_NM) / BANDS as f64;
            let middle = FIRST_NM + width * (band as f64 + 0.5);
            assert!((mean - middle).abs() < 0.3 * width, "{middle}: {mean}");
        }
    }
}
