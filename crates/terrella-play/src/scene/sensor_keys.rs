//! Declares the keys of `[sensor]`, as [`keys`](super::keys) does those of the other tables.

use super::choices::{DistortionModel, MosaicName, PsfName, ShutterName};
use super::field::{Bounds, Choice, Field, RawPath};
use super::keys::{SEED, SIDE_PX};
use super::record::{Notes, Record};
#[cfg(test)]
use super::table::About;
use super::table::{Key, Only, Table, Value, given_or, method, table};
use super::text::SceneText;
use serde::Deserialize;
#[cfg(test)]
use serde_json::json;
use std::ops::{Range, RangeInclusive};
use terrella_sensor::limits;
use toml::Spanned;

const GAUSSIAN: &Only = &Only {
    why: "only for psf = \"gaussian\"",
    sources: &[],
};
const AIRY: &Only = &Only {
    why: "only for psf = \"airy\"",
    sources: &[],
};
const MEASURED: &Only = &Only {
    why: "only for psf = \"measured\"",
    sources: &[],
};
const ROLLING: &Only = &Only {
    why: "only for shutter = \"rolling\"",
    sources: &[],
};

/// Default wavelength bands of red, green and blue, nanometres.
pub(super) const BANDS_NM: [[f64; 2]; 3] = [[600.0, 700.0], [500.0, 600.0], [400.0, 500.0]];
/// Default quantum efficiency.
pub(super) const QUANTUM_EFFICIENCY: [f64; 3] = [0.5; 3];

table!(RawSensor = "sensor" {
    /// Width and height of the sensor. Required.
    size: Vec<i64>, of "[width, height], two whole numbers of pixels", in SIDE_PX;
    /// Focal length of the lens; with pixel_pitch_um and size it gives the field of view. Required.
    focal_length_mm: f64, of "millimetres", in limits::FOCAL_LENGTH_MM;
    /// Distance of pixel centres. Required.
    pixel_pitch_um: f64, of "micrometres", in limits::PIXEL_PITCH_UM;
    // Lists of any length, so that a wrong length gets our own message.
    /// Where the optical axis meets the sensor, counted as OpenCV does: the centre of the upper left pixel is [0, 0]. By default the middle.
    principal_point_px: toml::Value, of "[x, y], two numbers of pixels";
    /// Model of the lens distortion.
    distortion_model: Choice<DistortionModel>, default DistortionModel::BrownConrady;
    /// Coefficients of the distortion in OpenCV's order: k1, k2, p1, p2 and, where there are more, k3 to k6; of a fisheye k1 to k4. By default none.
    distortion: toml::Value, of "a list of 4, 5 or 8 numbers; of a fisheye 4";
    /// Focal length over the diameter of the aperture. Required.
    f_number: f64, in limits::F_NUMBER;
    /// Time of exposure. Required.
    exposure_s: f64, of "seconds", in limits::EXPOSURE_S;
    /// Part of the light that passes the lens.
    transmission: f64, in limits::PART, default 1.0;
    /// Wavelengths that the red, green and blue light of the picture stand for, nanometres. By default [[600, 700], [500, 600], [400, 500]].
    bands_nm: toml::Value, of "[[from, to], [from, to], [from, to]], nanometres of red, green and blue";
    /// Electrons per photon in the red, green and blue band. By default [0.5, 0.5, 0.5].
    quantum_efficiency: Vec<f64>, of "[red, green, blue], three numbers", in limits::PART;
    /// Whether light falls off as the fourth power of the cosine of the angle from the axis, and by distortion as much as that enlarges.
    cos4: bool, default true;
    /// Falloff besides: 1 + v1 r² + v2 r⁴ + v3 r⁶, with r the distance from the principal point over the focal length. By default none.
    vignetting: Vec<f64>, of "[v1, v2, v3], three numbers", in -1e6..=1e6;
    /// Point spread function of the lens; the area of the pixel comes on top.
    psf: Choice<PsfName>, default PsfName::None;
    /// Standard deviation of the Gaussian.
    psf_sigma_px: f64, of "pixels", in limits::PSF_SIGMA_PX, default 0.5, for GAUSSIAN;
    /// Wavelength of the diffraction at the aperture.
    psf_wavelength_nm: f64, of "nanometres", in 100.0..=20_000.0, default 550.0, for AIRY;
    /// Kernel of the measured point spread: rows of numbers, with the samples per pixel of oversampling.
    psf_kernel: RawPath, of "a text file of numbers", for MEASURED;
    /// Samples of light across a pixel.
    oversampling: i64, of "a whole number from 1 to 16", in limits::OVERSAMPLING, default 4;
    /// Electrons that a pixel holds. Required.
    full_well_e: f64, of "electrons", in limits::FULL_WELL_E;
    /// Whether what a pixel cannot hold flows into its column; else it is lost.
    blooming: bool, default false;
    /// Dark current.
    dark_current_e_s: f64, of "electrons per second", in limits::DARK_CURRENT_E_S, default 0.0;
    /// Dark signal nonuniformity (DSNU): standard deviation of the offsets of pixels.
    dsnu_e: f64, of "electrons", in limits::NOISE_E, default 0.0;
    /// Photo response nonuniformity (PRNU): standard deviation of the gains of pixels, a part of 1.
    prnu: f64, in limits::PART, default 0.0;
    /// Part of the pixels that are hot.
    hot_pixel_fraction: f64, in limits::PART, default 0.0;
    /// Dark current of hot pixels.
    hot_pixel_e_s: f64, of "electrons per second", in limits::DARK_CURRENT_E_S, default 1000.0;
    /// Read noise, standard deviation.
    read_noise_e: f64, of "electrons", in limits::NOISE_E, default 0.0;
    /// Bits of a raw number.
    bits: i64, of "a whole number from 1 to 16", in limits::BITS, default 12;
    /// Raw number of no electrons.
    bias_dn: i64, of "a whole number below 2^bits", in 0..=65_535, default 0;
    /// Electrons per step of the raw number. By default the full well is the greatest number.
    gain_e_dn: f64, of "electrons per number", in limits::GAIN_E_DN;
    /// Colour filters on the pixels; mono sums all bands.
    mosaic: Choice<MosaicName>, default MosaicName::Mono;
    /// Whether all rows are exposed at once or one after the other.
    shutter: Choice<ShutterName>, default ShutterName::Global;
    /// Time from one row to the next; negative reads from the lowest row upwards.
    line_time_us: f64, of "microseconds", in -*limits::LINE_TIME_US.end()..=*limits::LINE_TIME_US.end(), default 10.0, for ROLLING;
    /// Seed of noise and pixel patterns.
    seed: i64, of "a whole number from 0 to 4294967295", in SEED, default 0;
});
