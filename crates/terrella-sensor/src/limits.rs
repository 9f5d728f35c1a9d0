//! Ranges of a sensor's parameters, each in the unit of its name. Scene files use the same ranges.

use std::ops::RangeInclusive;

/// Sides of the sensor, pixels.
pub const SIDE_PX: RangeInclusive<f64> = 1.0..=16_384.0;
/// Pixels in all: some 30 bytes are needed for each.
pub const PIXELS: RangeInclusive<f64> = 1.0..=67_108_864.0;
/// Focal length.
pub const FOCAL_LENGTH_MM: RangeInclusive<f64> = 1e-3..=1e6;
/// Distance of pixel centres.
pub const PIXEL_PITCH_UM: RangeInclusive<f64> = 0.1..=1000.0;
/// Focal length over aperture.
pub const F_NUMBER: RangeInclusive<f64> = 0.1..=1000.0;
/// Time of exposure.
pub const EXPOSURE_S: RangeInclusive<f64> = 1e-9..=1e5;
/// Parts of the light, of photons or of pixels.
pub const PART: RangeInclusive<f64> = 0.0..=1.0;
/// Standard deviation of a Gaussian point spread.
pub const PSF_SIGMA_PX: RangeInclusive<f64> = 0.01..=20.0;
/// Samples across a pixel.
pub const OVERSAMPLING: RangeInclusive<i64> = 1..=16;
/// Full well.
pub const FULL_WELL_E: RangeInclusive<f64> = 1.0..=1e9;
/// Dark currents.
pub const DARK_CURRENT_E_S: RangeInclusive<f64> = 0.0..=1e9;
/// Standard deviations of noise and of offsets.
pub const NOISE_E: RangeInclusive<f64> = 0.0..=1e6;
/// Bits of the converter.
pub const BITS: RangeInclusive<i64> = 1..=16;
/// Electrons for a step of the converter.
pub const GAIN_E_DN: RangeInclusive<f64> = 1e-6..=1e9;
/// Time from one row to the next.
pub const LINE_TIME_US: RangeInclusive<f64> = 1e-3..=1e6;
