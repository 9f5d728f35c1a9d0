//! Point spread: what the lens makes of a point, before pixels sum it.

use crate::error::{SensorError, check_range};
use crate::limits;
use std::f64::consts::PI;

/// A point spread function (PSF).
#[derive(Clone, Debug, PartialEq)]
pub enum Psf {
    /// Points stay points: pixels alone blur.
    None,
    /// A Gaussian of this standard deviation.
    Gaussian {
        /// Pixels.
        sigma_px: f64,
    },
    /// Diffraction at a round, unobstructed aperture.
    Airy {
        /// Wavelength times f-number over pixel pitch. The first dark ring has a radius of 1.22 of it.
        lambda_n_px: f64,
    },
    /// As measured, with the samples per pixel of the sensor's own oversampling.
    Measured(Kernel),
}

/// A measured point spread: samples on a square grid, the point at the middle one.
#[derive(Clone, Debug, PartialEq)]
pub struct Kernel {
    side: usize,
    weights: Vec<f64>,
}

/// Most samples of a kernel's side.
const MOST_KERNEL_SIDE: usize = 255;
/// Values of its transfer function at and beyond the highest frequency that samples show. More would ring at edges.
const MOST_ALIASED: f64 = 0.01;

impl Kernel {
    /// Samples row by row; they are scaled to a sum of 1.
    ///
    /// # Errors
    /// An even side, or more than 255; another number of samples; samples that are not finite; a sum that is not positive.
    pub fn new(side: usize, samples: Vec<f64>) -> Result<Self, SensorError> {
        let kernel = |problem: String| Err(SensorError::Kernel { problem });
        if side.is_multiple_of(2) || side > MOST_KERNEL_SIDE {
            return kernel(format!(
                "has {side} rows; an odd number up to {MOST_KERNEL_SIDE} is needed, with the point in the middle"
            ));
        }
        if samples.len() != side * side {
            return kernel(format!(
                "has {} samples in {side} rows; {side} in each are needed",
                samples.len()
            ));
        }
        let sum: f64 = samples.iter().sum();
        if !sum.is_finite() || sum <= 0.0 {
            return kernel(format!("sums to {sum}; a positive sum is needed"));
        }
        let weights = samples.into_iter().map(|sample| sample / sum).collect();
        Ok(Self { side, weights })
    }

    /// Rows and columns.
    pub fn side(&self) -> usize {
        self.side
    }

    /// Row by row, with a sum of 1.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }
}

impl Psf {
    /// Checks the point spread for a number of samples across a pixel.
    ///
    /// # Errors
    /// Widths out of range, and those with detail finer than the samples.
    pub fn check(&self, oversampling: u32) -> Result<(), SensorError> {
        let samples = f64::from(oversampling);
        let undersampled = |needed: f64, remedy: &str| {
            let remedy = match needed.ceil() as u32 {
                needed if i64::from(needed) <= *limits::OVERSAMPLING.end() => {
                    format!("an oversampling of {needed} would work")
                }
                _ => format!("it is far smaller than a pixel: {remedy}"),
            };
            Err(SensorError::Undersampled {
                oversampling,
                remedy,
            })
        };
        match self {
            Self::None | Self::Measured(_) => Ok(()),
            Self::Gaussian { sigma_px } => {
                check_range("psf_sigma_px", *sigma_px, limits::PSF_SIGMA_PX, " pixels")?;
                // exp(−2π²σ²f²) at f = n/2 must be at most 0.01.
                let needed = (2.0 * (1.0 / MOST_ALIASED).ln()).sqrt() / (PI * sigma_px);
                match needed > samples {
                    true => undersampled(needed, "write psf = \"none\", or a larger psf_sigma_px"),
                    false => Ok(()),
                }
            }
            Self::Airy { lambda_n_px } => {
                check_range(
                    "f_number",
                    *lambda_n_px,
                    0.01..=20.0,
                    " pixels of wavelength times f-number",
                )?;
                // Nothing passes beyond 1/(λN), which n/2 samples must reach.
                let needed = 2.0 / lambda_n_px;
                match needed > samples {
                    true => undersampled(needed, "write psf = \"none\""),
                    false => Ok(()),
                }
            }
        }
    }

    /// The modulation transfer of the lens at spatial frequencies across and down, cycles per pixel; `None` for a measured kernel.
    pub fn transfer(&self, across: f64, down: f64) -> Option<f64> {
        let frequency = across.hypot(down);
        match self {
            Self::None => Some(1.0),
            Self::Gaussian { sigma_px } => Some((-2.0 * (PI * sigma_px * frequency).powi(2)).exp()),
            // Goodman, Introduction to Fourier Optics, 6-30: 2/π (acos ν − ν √(1 − ν²)), ν = λ N f.
            Self::Airy { lambda_n_px } => {
                let v = (lambda_n_px * frequency).min(1.0);
                Some((v.acos() - v * (1.0 - v * v).sqrt()) / (0.5 * PI))
            }
            Self::Measured(_) => None,
        }
    }

    /// Radius of the point spread function, pixels: light beyond it is spread evenly over the tile that is filtered.
    pub(crate) fn reach_px(&self, oversampling: u32) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Gaussian { sigma_px } => 6.0 * sigma_px + 1.0,
            // Beyond 20 λN is 1 % of the light: 2/(π² 20), Born and Wolf 8.5.2.
            Self::Airy { lambda_n_px } => 20.0 * lambda_n_px + 1.0,
            Self::Measured(kernel) => 0.5 * kernel.side as f64 / f64::from(oversampling) + 1.0,
        }
    }
}

/// The modulation transfer of a pixel whose whole area is sensitive: sin(πf)/(πf) each way, cycles per pixel.
pub fn pixel_transfer(across: f64, down: f64) -> f64 {
    let sinc = |f: f64| match f == 0.0 {
        true => 1.0,
        false => (PI * f).sin() / (PI * f),
    };
    sinc(across) * sinc(down)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_that_are_none_are_rejected() {
        for (side, samples) in [
            (4, vec![1.0; 16]),
            (257, vec![1.0; 257 * 257]),
            (3, vec![1.0; 8]),
            (3, vec![0.0; 9]),
            (1, vec![f64::NAN]),
        ] {
            let error = Kernel::new(side, samples).expect_err("rejected");
            assert_eq!(error.key(), "psf_kernel");
        }
        let kernel = Kernel::new(1, vec![4.0]).expect("a point");
        assert_eq!(kernel.weights(), [1.0]);
    }
}
