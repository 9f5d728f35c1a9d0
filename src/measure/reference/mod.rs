//! The true picture: exact ray casting on the processor in f64. It shares constants and maps with the drawables, no code.
//!
//! What the graphics processor draws is judged against it, so nothing of the shaders, the air's tables, the mesh or the
//! filters is used here; only the model's constants ([`crate::air::EARTH_AIR`]), the figure, views and maps are.
//!
//! - **Geometry.** Every ray meets the exact ellipsoid. Inside it no ground is seen, as from inside a one-sided mesh,
//!   and the air is that over the ground above the eye. Near and far plane cut nothing off.
//! - **Maps** are piecewise bilinear functions of their full-resolution texels, without mip levels. A pixel is its box
//!   average: N × N rays, and where a ray's part of the pixel covers more than half a texel, taps no farther apart than half a
//!   texel, up to [`MAX_TAPS`] a side. The whole light model is evaluated at each tap and its light averaged, not its inputs: the
//!   mean of what is there, not what is there in the mean.
//! - **Light.** Sunlight and skylight at each tap, red, green and blue apart; the air once a ray.
//! - **Air** by quadrature along each ray, in scaled space as the drawables' air is ([`crate::air`]). What is behind it
//!   is dimmed in red, green and blue apart.
//!
//! | file | what |
//! |---|---|
//! | `geometry` | rays of a view, the ellipsoid, the limb |
//! | `maps` | full-resolution maps as functions of the place |
//! | `shading` | the light of a place on the ground |
//! | `light` | Sun and sky on the ground |
//! | `air`, `path` | light and transmittance along rays |
//! | `grid` | quadrature and interpolation |
//! | `render`, `picture` | rays to pixels |
//! | `relief` | where rays meet ground with relief |
//! | `pack` | whole maps of a pack's finest levels |
//! | `still` | one picture of a scene into a file |

mod air;
#[cfg(test)]
mod air_tests;
mod geometry;
mod grid;
mod light;
mod maps;
mod pack;
mod path;
mod picture;
mod relief;
mod render;
mod shading;
mod still;

pub(super) use geometry::Rays;
pub use geometry::{ground_point, limb_angle_rad};
pub use maps::{FullMap, FullMaps};
pub use pack::MAX_MAP_BYTES;
pub(super) use pack::whole_maps;
pub use picture::ReferencePicture;
pub use relief::{TrueRelief, relief_distance_m};
pub use render::MAX_TAPS;
pub use still::{ReferenceRequest, ReferenceStats, StillError, write_reference_still};

use crate::globe::Figure;
use crate::imagery::{EarthLayers, ImageryError, TexelFormat};
use crate::{Atmosphere, EarthOptions, EyeView, Shading, Sky};
use air::Air;
use glam::DVec3;
use light::GroundLight;
use rayon::prelude::*;
use render::{CastEarth, PixelPart, RayCaster};
use shading::GroundShader;
use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicBool, Ordering};

/// Rays along each side of a pixel.
pub const SAMPLES: RangeInclusive<u32> = 1..=16;

/// What is fixed when a reference is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceOptions {
    /// The figure.
    pub figure: Figure,
    /// How the ground is shaded.
    pub shading: Shading,
    /// Whether there is air.
    pub atmosphere: Atmosphere,
    /// What a white sheet that faces the Sun in space is drawn with, 1 being the display's white; 0 or more. The paper's
    /// shading works in display values and is not touched by it, the air is.
    pub exposure: f64,
    /// N: each pixel is the mean of N × N rays, N in [`SAMPLES`].
    pub samples: u32,
}

impl ReferenceOptions {
    /// Those of an Earth, with N × N rays a pixel.
    pub fn of(options: &EarthOptions, samples: u32) -> Self {
        Self {
            figure: options.figure,
            shading: options.shading,
            atmosphere: options.atmosphere,
            exposure: f64::from(options.exposure),
            samples,
        }
    }
}

/// What can be wrong with a reference's maps and options.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// A map does not hold what it says.
    #[error(transparent)]
    Layer(#[from] ImageryError),
    /// A map has the wrong format or length.
    #[error(
        "the {layer} map of {width} × {height} texels must be {wanted:?} and is {format:?} with {bytes} bytes"
    )]
    Map {
        /// Which map.
        layer: &'static str,
        /// The format it must have.
        wanted: TexelFormat,
        /// Its width.
        width: u32,
        /// Its height.
        height: u32,
        /// Its format.
        format: TexelFormat,
        /// Its bytes.
        bytes: usize,
    },
    /// No surface colour.
    #[error("there is no day map; the ground has no colour without it")]
    NoDay,
    /// Too many or too few rays.
    #[error(
        "{0} × {0} rays a pixel; it must be from {first} × {first} to {last} × {last}",
        first = SAMPLES.start(), last = SAMPLES.end()
    )]
    Samples(u32),
    /// Not a brightness.
    #[error("the exposure is {0}; it must be a finite number, 0 or more")]
    Exposure(f64),
}

/// An Earth whose true picture can be computed from anywhere.
#[derive(Debug)]
pub struct Reference {
    options: ReferenceOptions,
    ground: GroundShader,
    air: Option<&'static Air>,
}

impl Reference {
    /// Copies the full-resolution texels of the maps (4096 × 2048 colour texels are 34 MB) and makes the air ready, once
    /// per process, if there is any.
    ///
    /// # Errors
    /// Maps that do not hold what they say or have another format than their layer, options out of range.
    pub fn new(layers: &EarthLayers, options: ReferenceOptions) -> Result<Self, ReferenceError> {
        Self::with_maps(FullMaps::copied(layers)?, options)
    }

    /// As [`Self::new`], with maps that are taken and not copied.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_maps(maps: FullMaps, options: ReferenceOptions) -> Result<Self, ReferenceError> {
        maps.check()?;
        if !SAMPLES.contains(&options.samples) {
            return Err(ReferenceError::Samples(options.samples));
        }
        if !(options.exposure.is_finite() && options.exposure >= 0.0) {
            return Err(ReferenceError::Exposure(options.exposure));
        }
        let (air, light) = match options.atmosphere {
            Atmosphere::Billboard => {
                let light = (options.shading == Shading::Sunlit).then(GroundLight::earth);
                (Some(Air::earth()), light)
            }
            Atmosphere::None => (None, None),
        };
        Ok(Self {
            options,
            ground: GroundShader::new(maps, options.shading, light),
            air,
        })
    }

    /// The options.
    pub fn options(&self) -> &ReferenceOptions {
        &self.options
    }

    /// The maps.
    pub fn maps(&self) -> &FullMaps {
        &self.ground.maps
    }

    /// Computes a picture on all cores; it takes 16 bytes a pixel. A view or sky that is not finite gives a black one.
    pub fn render(&self, view: &EyeView, sky: &Sky, size: (u32, u32)) -> ReferencePicture {
        let picture = self.render_unless(view, sky, size, &|| (), &|| false);
        // Nothing stops it.
        picture.unwrap_or_else(|| black(size))
    }

    /// As [`Self::render`], calling `row_done` after each row from any thread; `None` soon after `stop` becomes true.
    pub fn render_with(
        &self,
        view: &EyeView,
        sky: &Sky,
        size: (u32, u32),
        row_done: &(dyn Fn() + Sync),
        stop: &AtomicBool,
    ) -> Option<ReferencePicture> {
        let is_stopped = || stop.load(Ordering::Relaxed);
        self.render_unless(view, sky, size, row_done, &is_stopped)
    }

    /// As [`Self::render_with`], with a question in place of the flag, asked at every pixel.
    pub fn render_unless(
        &self,
        view: &EyeView,
        sky: &Sky,
        size: (u32, u32),
        row_done: &(dyn Fn() + Sync),
        is_stopped: &(dyn Fn() -> bool + Sync),
    ) -> Option<ReferencePicture> {
        let mut picture = black(size);
        let earth = CastEarth {
            ground: &self.ground,
            air: self.air,
            exposure: self.options.exposure,
            scale: self.options.figure.ellipsoid().itrf_from_scaled(),
        };
        let Some(caster) = RayCaster::new(&earth, view, sky, size) else {
            return Some(picture);
        };
        let width = size.0.max(1) as usize;
        let lines = picture.linear.par_chunks_mut(width);
        let lines = lines.zip(picture.ground.par_chunks_mut(width)).enumerate();
        lines.try_for_each(|(y, (linear, ground))| {
            for (x, (linear, ground)) in linear.iter_mut().zip(ground).enumerate() {
                if is_stopped() {
                    return None;
                }
                (*linear, *ground) = self.pixel(&caster, x, y);
            }
            row_done();
            Some(())
        })?;
        Some(picture)
    }

    fn pixel(&self, caster: &RayCaster<'_>, x: usize, y: usize) -> ([f32; 3], f32) {
        let samples = self.options.samples;
        let side = 1.0 / f64::from(samples);
        let (mut light, mut ground) = (DVec3::ZERO, 0_u32);
        for j in 0..samples {
            for i in 0..samples {
                let sample = caster.sample(&PixelPart {
                    x: x as f64 + f64::from(i) * side,
                    y: y as f64 + f64::from(j) * side,
                    side,
                });
                light += sample.light;
                ground += u32::from(sample.is_ground);
            }
        }
        let count = f64::from(samples * samples);
        (
            (light / count).as_vec3().to_array(),
            (f64::from(ground) / count) as f32,
        )
    }
}

fn black((width, height): (u32, u32)) -> ReferencePicture {
    let pixels = width as usize * height as usize;
    ReferencePicture {
        width,
        height,
        linear: vec![[0.0; 3]; pixels],
        ground: vec![0.0; pixels],
    }
}
