//! A whole camera: from the picture of a pinhole camera to a raw frame.

use crate::detector::{Detector, RawFrame, Wells};
use crate::error::{SensorError, check_count, check_range};
use crate::fourier::Filter;
use crate::lens::Lens;
use crate::limits;
use crate::mosaic::Mosaic;
use crate::pinhole::{PinholeFrame, PinholePicture};
use crate::psf::{Psf, pixel_transfer};
use crate::radiometry::Radiometry;
use crate::shutter::Shutter;
use glam::DVec2;
use num_complex::Complex64;
use rayon::prelude::*;
use std::ops::Range;

/// Lens, aperture, shutter and detector of a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Pixels to rays.
    pub lens: Lens,
    /// Image of a point through the lens.
    pub psf: Psf,
    /// Samples of light across a pixel.
    pub oversampling: u32,
    /// Light to electrons.
    pub radiometry: Radiometry,
    /// Electrons to numbers.
    pub detector: Detector,
    /// Filters on the pixels.
    pub mosaic: Mosaic,
    /// When rows are exposed.
    pub shutter: Shutter,
    /// Noise and patterns are functions of it.
    pub seed: u64,
}

/// Side of a tile that is filtered in one transform, in samples, unless the image is smaller.
const TILE: usize = 1024;

impl Sensor {
    /// Checks all parameters with each other. The lens has been checked when it was made.
    ///
    /// # Errors
    /// The first parameter that is out of range.
    pub fn check(&self) -> Result<(), SensorError> {
        check_count("oversampling", self.oversampling, limits::OVERSAMPLING)?;
        self.psf.check(self.oversampling)?;
        self.radiometry.check(&self.lens)?;
        self.detector.check()?;
        if let Shutter::Rolling { line_time_s, .. } = self.shutter {
            check_range(
                "line_time_us",
                1e6 * line_time_s,
                limits::LINE_TIME_US,
                " µs",
            )?;
        }
        Ok(())
    }

    /// The same sensor behind the camera that a simulator describes: of this size and vertical field of view (radians, of a pinhole), and of
    /// a focal length (millimetres) and an f-number where it gives them. The pixel pitch follows. The principal point stays where the size
    /// does, and is the middle otherwise.
    ///
    /// # Errors
    /// As [`Lens::new`] and [`Self::check`].
    pub fn fitted(
        &self,
        size: [u32; 2],
        fov_rad: f64,
        focal_length_mm: Option<f64>,
        f_number: Option<f64>,
    ) -> Result<Self, SensorError> {
        let lens = &self.lens;
        let focal_length_mm = focal_length_mm.unwrap_or(lens.focal_length_mm());
        let height_mm = 2.0 * focal_length_mm * (0.5 * fov_rad).tan();
        let pixel_pitch_um = 1000.0 * height_mm / f64::from(size[1]);
        let principal_point_px = match size == lens.size() {
            true => Some(lens.principal_point_px().to_array()),
            false => None,
        };
        let radiometry = Radiometry {
            f_number: f_number.unwrap_or(self.radiometry.f_number),
            ..self.radiometry.clone()
        };
        let psf = match &self.psf {
            Psf::Airy { lambda_n_px } => Psf::Airy {
                lambda_n_px: lambda_n_px * radiometry.f_number / self.radiometry.f_number
                    * lens.pixel_pitch_um()
                    / pixel_pitch_um,
            },
            psf => psf.clone(),
        };
        let fitted = Self {
            lens: Lens::new(
                size,
                focal_length_mm,
                pixel_pitch_um,
                principal_point_px,
                *lens.distortion(),
            )?,
            psf,
            radiometry,
            ..self.clone()
        };
        fitted.check()?;
        Ok(fitted)
    }

    /// The picture that a pinhole camera in the lens's place must give for some rows.
    ///
    /// # Errors
    /// As [`Lens::direction`].
    pub fn pinhole(&self, rows: Range<u32>) -> Result<PinholeFrame, SensorError> {
        let rect = self
            .lens
            .bounds(rows, self.psf.reach_px(self.oversampling))?;
        let scale = self.lens.focal_px() * f64::from(self.oversampling) * self.lens.magnification();
        // Without distortion pixels of the picture are samples of the sensor.
        let origin = (self.lens.principal_point_px() + 0.5) * f64::from(self.oversampling);
        Ok(PinholeFrame::around(rect, scale, origin))
    }

    /// Mean light on the pixels of some rows, after lens and point spread: red, green and blue.
    ///
    /// Beyond the edge of the sensor's area, the light of the nearest edge is assumed.
    ///
    /// # Errors
    /// As [`Lens::direction`].
    pub fn expose(
        &self,
        rows: Range<u32>,
        picture: &PinholePicture<'_>,
    ) -> Result<Vec<[f32; 3]>, SensorError> {
        let margin_px = self.psf.reach_px(self.oversampling).ceil() as i64;
        let rays = Rays::new(&self.lens, rows.clone(), margin_px)?;
        let width = self.lens.size()[0];
        let mut light = vec![[0.0; 3]; width as usize * rows.len()];
        if matches!(self.psf, Psf::None) {
            let count = light.len() as u32;
            light.par_iter_mut().zip(0..count).for_each(|(light, i)| {
                *light = self.mean_light(&rays, picture, i % width, rows.start + i / width);
            });
            return Ok(light);
        }
        let samples = self.oversampling as usize;
        let margin = margin_px as usize * samples;
        let side = |pixels: usize| {
            let needed = pixels * samples + 2 * margin;
            let side = needed
                .next_power_of_two()
                .min(TILE.max((4 * margin).next_power_of_two()));
            (side, (side - 2 * margin) / samples)
        };
        let (across, tile_width) = side(width as usize);
        let (down, tile_height) = side(rows.len());
        let filter = self.filter(across, down);
        for top in (0..rows.len()).step_by(tile_height) {
            let tile_rows = tile_height.min(rows.len() - top);
            let lefts: Vec<_> = (0..width as usize).step_by(tile_width).collect();
            let tiles: Vec<_> = lefts
                .into_par_iter()
                .map(|left| {
                    let corner = [
                        left as i64 - margin_px,
                        i64::from(rows.start) + top as i64 - margin_px,
                    ];
                    let tile = self.filtered(&rays, picture, corner, [across, down], &filter);
                    (left, tile)
                })
                .collect();
            for (left, tile) in tiles {
                for y in 0..tile_rows {
                    for x in left..(left + tile_width).min(width as usize) {
                        // The sample left of and above the middle of the pixel, or in it.
                        let middle = margin + (samples - 1) / 2;
                        let at = (y * samples + middle) * across + (x - left) * samples + middle;
                        light[(top + y) * width as usize + x] = tile[at];
                    }
                }
            }
        }
        Ok(light)
    }

    /// Point spread and pixel for arrays of samples.
    fn filter(&self, across: usize, down: usize) -> Filter {
        let samples = f64::from(self.oversampling);
        let is_even = self.oversampling.is_multiple_of(2);
        // With an even number of samples, the centre of a pixel is half a sample further.
        let shift = |f: f64| match (is_even, f.abs() == 0.5) {
            (false, _) => Complex64::ONE,
            (true, true) => Complex64::ZERO,
            (true, false) => Complex64::cis(std::f64::consts::PI * f),
        };
        let mut filter = Filter::new(across, down, |x, y| {
            let (fx, fy) = (x * samples, y * samples);
            let lens = self.psf.transfer(fx, fy).unwrap_or(1.0);
            lens * pixel_transfer(fx, fy) * shift(x) * shift(y)
        });
        if let Psf::Measured(kernel) = &self.psf {
            filter.convolve(kernel.side(), kernel.weights());
        }
        filter
    }

    /// Light behind the filter at the samples of a tile whose upper left pixel is `corner`.
    fn filtered(
        &self,
        rays: &Rays,
        picture: &PinholePicture<'_>,
        corner: [i64; 2],
        [across, down]: [usize; 2],
        filter: &Filter,
    ) -> Vec<[f32; 3]> {
        let samples = f64::from(self.oversampling);
        let place =
            |corner: i64, sample: usize| corner as f64 - 0.5 + (sample as f64 + 0.5) / samples;
        let count = across * down;
        let [mut first, mut second] = [0, 1].map(|_| vec![Complex64::ZERO; count]);
        let values = first.iter_mut().zip(&mut second).enumerate();
        for (i, (first, second)) in values {
            let pixel = DVec2::new(place(corner[0], i % across), place(corner[1], i / across));
            let [red, green, blue] = picture.light(rays.direction(self.lens.clamped(pixel)));
            // Two real pictures as one of complex numbers.
            (*first, *second) = (Complex64::new(red, green), blue.into());
        }
        filter.apply(&mut first);
        filter.apply(&mut second);
        let values = first.iter().zip(&second);
        // At sharp edges the truncated spectrum undershoots below 0.
        values
            .map(|(first, second)| {
                [first.re, first.im, second.re].map(|light| light.max(0.0) as f32)
            })
            .collect()
    }

    /// Mean over the samples of a pixel.
    fn mean_light(&self, rays: &Rays, picture: &PinholePicture<'_>, x: u32, y: u32) -> [f32; 3] {
        let samples = self.oversampling;
        let step = 1.0 / f64::from(samples);
        let mut sum = [0.0; 3];
        for i in 0..samples * samples {
            let part = DVec2::new(f64::from(i % samples), f64::from(i / samples)) + 0.5;
            let pixel = DVec2::new(f64::from(x), f64::from(y)) - 0.5 + part * step;
            let light = picture.light(rays.direction(pixel));
            for (sum, light) in sum.iter_mut().zip(light) {
                *sum += light * step * step;
            }
        }
        sum.map(|sum| sum as f32)
    }

    /// Mean electrons of all pixels, for light as from [`Self::expose`] for all rows.
    ///
    /// # Errors
    /// Light of another number of pixels; otherwise as [`Lens::direction`].
    pub fn mean_electrons(
        &self,
        light: &[[f32; 3]],
        sun_distance_au: f64,
    ) -> Result<Vec<f64>, SensorError> {
        let [width, height] = self.lens.size();
        let wanted = width as usize * height as usize;
        if light.len() != wanted {
            return Err(SensorError::PictureSize {
                found: light.len(),
                wanted,
            });
        }
        let photons = self.radiometry.photons(&self.lens, sun_distance_au);
        let efficiency = &self.radiometry.quantum_efficiency;
        let pixels = light.par_iter().zip(0_u32..light.len() as u32);
        pixels
            .map(|(light, i)| {
                let (x, y) = (i % width, i / width);
                let of_band =
                    |band: usize| f64::from(light[band]) * photons[band] * efficiency[band];
                let electrons: f64 = match self.mosaic.band(x, y) {
                    Some(band) => of_band(band),
                    None => (0..3).map(of_band).sum(),
                };
                let pixel = DVec2::new(f64::from(x), f64::from(y));
                let direction = self.lens.direction(pixel)?;
                Ok(electrons * self.radiometry.falloff(&self.lens, pixel, direction))
            })
            .collect()
    }

    /// The frame of a light, and the electrons that it was read from.
    ///
    /// # Errors
    /// As [`Self::mean_electrons`].
    pub fn read_out(
        &self,
        light: &[[f32; 3]],
        sun_distance_au: f64,
        frame: u32,
    ) -> Result<(RawFrame, Wells), SensorError> {
        let mean = self.mean_electrons(light, sun_distance_au)?;
        let width = self.lens.size()[0];
        let exposure_s = self.radiometry.exposure_s;
        let wells = self
            .detector
            .collect(&mean, width, exposure_s, self.seed, frame);
        Ok((self.detector.read(&wells, width, self.seed, frame), wells))
    }
}

/// Rays of the corners of pixels, and between them by interpolation.
struct Rays {
    first: [i64; 2],
    columns: usize,
    corners: Vec<DVec2>,
}

impl Rays {
    /// Light of some rows and a margin around them, as far as the sensor reaches.
    fn new(lens: &Lens, rows: Range<u32>, margin: i64) -> Result<Self, SensorError> {
        let [width, height] = lens.size().map(i64::from);
        let top = (i64::from(rows.start) - margin).max(0);
        let bottom = (i64::from(rows.end) + margin).min(height);
        let columns = width as usize + 1;
        let count = columns * (bottom - top + 1) as usize;
        let corners = (0..count).into_par_iter().map(|i| {
            let (x, y) = ((i % columns) as f64, top as f64 + (i / columns) as f64);
            lens.direction(DVec2::new(x, y) - 0.5)
        });
        Ok(Self {
            first: [0, top],
            columns,
            corners: corners.collect::<Result<_, _>>()?,
        })
    }

    /// The ray of a point within, pixels.
    fn direction(&self, pixel: DVec2) -> DVec2 {
        let rows = self.corners.len() / self.columns;
        let most = DVec2::new((self.columns - 1) as f64, (rows - 1) as f64);
        let first = DVec2::new(self.first[0] as f64, self.first[1] as f64);
        let at = (pixel + 0.5 - first).clamp(DVec2::ZERO, most);
        let base = at.floor().min(most - 1.0);
        let part = at - base;
        let index = base.y as usize * self.columns + base.x as usize;
        let corner = |right: usize, down: usize| self.corners[index + down * self.columns + right];
        let above = corner(0, 0).lerp(corner(1, 0), part.x);
        above.lerp(corner(0, 1).lerp(corner(1, 1), part.x), part.y)
    }
}

#[cfg(test)]
#[path = "sensor_tests.rs"]
mod tests;
