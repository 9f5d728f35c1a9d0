//! The true image: exact ray casting on the CPU in f64. It shares constants and maps with the drawables, but no code.
//!
//! GPU rendering is compared with it, so it uses no shaders, air model, tables, mesh or filters of the drawables; only the figure, views and maps.
//!
//! - **Geometry.** Every ray meets the exact ellipsoid, or with terrain the elevation data at full resolution. From inside the ellipsoid no ground
//!   is visible, as from inside a one-sided mesh, and the air is that over the ground above the eye. Near and far plane do not clip.
//! - **Maps** are piecewise bilinear functions of their full-resolution texels, without mip levels. A pixel is its box average: N × N rays. If a
//!   ray's part of the pixel covers more than half a texel, it is sampled at taps no farther apart than half a texel, up to [`MAX_TAPS`] a side. The
//!   complete light model is evaluated at each tap and its result averaged, not its inputs.
//! - **Light** by wavelength, in 16 bands, converted to linear sRGB with the Sun as white. A map's colour is a factor on each channel of the light
//!   of white ground.
//! - **Air** by quadrature along each ray, in scaled space like that of the drawables ([`terrella_ground::air`]): molecules, ozone and aerosol from
//!   this renderer's own sources, all orders of scattering, ground with the local albedo of the maps. `terrella-measure` compares it with tables of
//!   another program.
//!
//! | file | content |
//! |---|---|
//! | `geometry` | rays of a view, the ellipsoid, the limb |
//! | `maps` | full-resolution maps as functions of position |
//! | `shading` | the light of a point on the ground |
//! | `over_ground` | the sea's light, and clouds |
//! | `light` | Sun and sky on the ground, and the light that reaches the eye |
//! | `surroundings` | mean albedo of the ground around a point |
//! | `spectrum`, `matter` | wavelengths and colours; composition of the air |
//! | `air`, `path` | light and transmittance along rays |
//! | `orders`, `field` | multiple scattering, and its tables |
//! | `grid` | quadrature and interpolation |
//! | `render`, `picture` | rays to pixels |
//! | `relief` | intersection of rays with terrain |
//! | `pack` | whole maps of a pack's finest levels |

#![allow(missing_docs, reason = "names of options and errors say what they are")]

mod air;
#[cfg(test)]
mod air_tests;
mod all_orders;
mod clouds_from_below;
mod directional;
mod field;
mod geometry;
mod grid;
mod light;
mod maps;
mod matter;
mod orders;
mod over_ground;
mod pack;
mod path;
mod picture;
mod relief;
mod render;
mod shading;
mod shading_point;
mod spectrum;
mod surroundings;

pub use geometry::{Rays, ground_point, limb_angle_rad};
pub use maps::{FullMap, FullMaps};
pub use pack::{MAX_MAP_BYTES, PackMaps, whole_maps};
pub use picture::ReferencePicture;
pub use relief::{TrueRelief, relief_distance_m};
pub use render::MAX_TAPS;

use glam::DVec3;
use rayon::prelude::*;
use render::{CastEarth, PixelPart, RayCaster};
use shading::GroundShader;
use std::fmt;
use std::ops::RangeInclusive;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use terrella::{
    Atmosphere, EarthOptions, EyeView, Shading, Sky, SurfaceLight, Tone, exposure_factor,
};
use terrella_ground::elevation::Elevation;
use terrella_ground::globe::Figure;
use terrella_imagery::{EarthLayers, ImageryError, TexelFormat};

/// Rays along each side of a pixel.
pub const SAMPLES: RangeInclusive<u32> = 1..=16;

/// Options that are fixed when a reference is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceOptions {
    pub figure: Figure,
    /// How the ground is shaded.
    pub shading: Shading,
    /// Options of the light on the surface.
    pub surface: SurfaceLight,
    /// Whether there is air.
    pub atmosphere: Atmosphere,
    /// Optical depth of the air's aerosol at 550 nm, 0 or more.
    pub aerosol_optical_depth: f64,
    /// Exposure factor, 0 or more. It does not affect the paper's shading, which uses display values, but does affect the air.
    pub exposure: f64,
    /// Tone curve of exposed light.
    pub tone: Tone,
    /// N: each pixel is the mean of N × N rays, N in [`SAMPLES`].
    pub samples: u32,
}

impl ReferenceOptions {
    /// Those of an Earth, with N × N rays a pixel. Of one that meters exposure, the default exposure: what it takes for a
    /// view is set in its place.
    pub fn of(options: &EarthOptions, samples: u32) -> Self {
        Self {
            figure: options.figure,
            shading: options.shading,
            surface: options.light,
            atmosphere: options.atmosphere,
            aerosol_optical_depth: options.air.aerosol_optical_depth,
            exposure: exposure_factor(options.exposure.fixed_ev()),
            tone: options.tone,
            samples,
        }
    }
}

/// Errors in a reference's maps and options.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// A map's texels do not fit its description.
    #[error(transparent)]
    Layer(#[from] ImageryError),
    /// A map has the wrong format or length.
    #[error(
        "the {layer} map of {width} × {height} texels must be {wanted:?} and is {format:?} with {bytes} bytes"
    )]
    Map {
        layer: &'static str,
        /// The format it must have.
        wanted: TexelFormat,
        width: u32,
        height: u32,
        format: TexelFormat,
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
    /// Not an optical depth.
    #[error("the aerosol's optical depth is {0}; it must be a finite number, 0 or more")]
    Aerosol(f64),
    /// Not a brightness.
    #[error("the exposure is {0}; it must be a finite number, 0 or more")]
    Exposure(f64),
}

/// An Earth whose true picture can be computed from anywhere.
pub struct Reference {
    options: ReferenceOptions,
    ground: GroundShader,
    relief: Option<Arc<dyn Elevation>>,
}

impl fmt::Debug for Reference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Reference")
            .field("options", &self.options)
            .field("has_relief", &self.relief.is_some())
            .finish_non_exhaustive()
    }
}

impl Reference {
    /// Copies the full-resolution texels of the maps (4096 × 2048 colour texels are 34 MB) and computes the tables of the air, once per process, if
    /// there is any.
    ///
    /// # Errors
    /// Maps whose texels do not fit their description or have another format than their layer, or options out of range.
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
        let depth = options.aerosol_optical_depth;
        if !(depth.is_finite() && depth >= 0.0) {
            return Err(ReferenceError::Aerosol(depth));
        }
        let aerosol = match options.atmosphere {
            Atmosphere::Billboard => Some(depth),
            Atmosphere::None => None,
        };
        Ok(Self {
            options,
            ground: GroundShader::new(maps, options.shading, options.surface, aerosol),
            relief: None,
        })
    }

    /// The same on terrain at its finest, whatever surface would draw it.
    pub fn on_relief(self, elevation: Arc<dyn Elevation>) -> Self {
        Self {
            relief: Some(elevation),
            ..self
        }
    }

    pub fn options(&self) -> &ReferenceOptions {
        &self.options
    }

    /// Names of features that an Earth with these options draws and its reference does not.
    pub fn left_out(options: &EarthOptions) -> Vec<&'static str> {
        let is_sunlit = options.shading == Shading::Sunlit;
        let has_clouds = is_sunlit && options.layers.clouds.is_some();
        let has_air = options.atmosphere != Atmosphere::None;
        let all = [
            (
                "cloud relief",
                has_clouds && options.light.cloud_relief_m > 0.0,
            ),
            ("made detail", is_sunlit && options.light.detail),
            ("moonlight", is_sunlit && options.light.moonlight),
            ("airglow", has_air && options.light.airglow),
            ("aurora", has_air && options.light.kp.is_some()),
        ];
        let left_out = all.into_iter().filter(|(_, is_drawn)| *is_drawn);
        left_out.map(|(name, _)| name).collect()
    }

    /// Whether it has terrain.
    pub fn has_relief(&self) -> bool {
        self.relief.is_some()
    }

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

    /// As [`Self::render_with`], with a function in place of the flag, called at every pixel.
    pub fn render_unless(
        &self,
        view: &EyeView,
        sky: &Sky,
        size: (u32, u32),
        row_done: &(dyn Fn() + Sync),
        is_stopped: &(dyn Fn() -> bool + Sync),
    ) -> Option<ReferencePicture> {
        let mut picture = black(size);
        let Some(caster) = RayCaster::new(&self.cast_earth(), view, sky, size) else {
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

    /// The light along one ray from an eye, both in ITRF axes, the eye in metres: linear, not clamped, multiplied by the
    /// exposure. Black where view or sky are not finite.
    pub fn light_along(&self, eye_m: DVec3, direction: DVec3, sky: &Sky) -> [f64; 3] {
        let across = direction.any_orthogonal_vector();
        let view = EyeView::itrf(eye_m, direction, across, 1e-6, 1.0);
        let caster = RayCaster::new(&self.cast_earth(), &view, sky, (1, 1));
        let part = PixelPart {
            x: 0.0,
            y: 0.0,
            side: 1.0,
        };
        caster.map_or([0.0; 3], |caster| caster.sample(&part).light.to_array())
    }

    fn cast_earth(&self) -> CastEarth<'_> {
        CastEarth {
            ground: &self.ground,
            relief: self.relief.as_deref(),
            exposure: self.options.exposure,
            figure: self.options.figure.ellipsoid(),
        }
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
                light += self.ground.shown(sample.light, self.options.tone);
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
