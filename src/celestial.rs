//! Stars, the Milky Way, Sun and Moon, drawn into a host's pass behind everything in it.
//!
//! # Use
//!
//! ```text
//! let options = CelestialOptions::load(&*find_textures()?, CelestialSelection::default())?;
//! let mut celestial = Celestial::new(&device, &queue, &earth, &options)?;
//! // once a frame, after Earth::prepare with the same view
//! celestial.prepare(&queue, &earth, &moment);
//! // in the pass, after all that is opaque
//! earth.render_surface(&mut pass);
//! earth.render_air(&mut pass);
//! celestial.render(&mut pass);
//! earth.render_clouds_overhead(&mut pass);
//! ```
//!
//! Further views ([`Earth::new_view`]) need their own sky ([`Celestial::new_view`]): prepare it with [`Celestial::prepare_view`], and draw it
//! between [`Earth::render_view_air`] and [`Earth::render_view_clouds_overhead`].
//!
//! # How it works
//!
//! **Positions** are computed in f64 for each frame. Catalogue positions are corrected for proper motion, light time, and the aberration by the
//! Earth's and the eye's motion ([`Observer`]), and projected before the conversion to f32. So nothing jitters, at any field of view.
//!
//! **Stars** are points. Each is spread over 4 × 4 pixels by a spline whose values at whole steps add up to 1. Its brightness follows from its
//! magnitude and the pixel's solid angle: its total light in the image is the same at any size and between pixels. Sun and Moon are drawn in the
//! same way if their discs are smaller than four pixels.
//!
//! **Discs** are spheres that each pixel's ray is intersected with, in axes along the line to them: exact from a field of view of 0.001° to an eye
//! on the Moon.
//!
//! **Order.** Everything is added to the content of the pass, at the farthest depth, attenuated by the air in front of each pixel. A Moon in front
//! of the Earth hides it instead.

mod ghosts;
mod moon;
mod projection;
mod seen;
mod sky_maps;
mod stars;

use crate::earth::{
    Earth, EarthView, EyeView, ItrfView, Pipelines, Viewport, ball_bounds, daylight_in_sight,
    gain_beside, gain_by_night,
};
use crate::gpu::{AirTextures, DepthBuffer, PassFormat, ShaderError};
use crate::gpu::{
    CelestialDrawable, CelestialKind, CelestialParts, CelestialUniforms, GLARE_RADIUS_RAD,
    StarPoint,
};
use crate::plan::AirSide;
use glam::{DVec3, Vec2, Vec3, Vec4};
use projection::Projection;
use seen::Seen;
pub use sky_maps::{CelestialSelection, MILKY_WAY_FILE, MOON_FILE, STARS_FILE};
pub use stars::{Star, StarCatalogue, StarError};
use std::f64::consts::PI;
use std::path::PathBuf;
use std::sync::Arc;
use terrella_frames::{Ellipsoid, Epoch, MOON_RADIUS_M, Observer, Orientation, SUN_RADIUS_M};
use terrella_ground::air::TOP;
use terrella_ground::light::{DiffractionPattern, Ghosts};
use terrella_imagery::{ImageryError, LayerImage};

/// A disc with a smaller radius, pixels, is drawn as a point: most of it would be its edge.
const POINT_PX: f64 = 2.0;
/// Days in a Julian year, and the catalogue's epoch: J1991.25 as a Julian date (TT).
const YEAR_DAYS: f64 = 365.25;
const CATALOGUE_JD: f64 = 2_448_349.062_5;
/// The parts of the sky that are drawn. A part that is off is neither in memory nor in shaders.
#[derive(Clone, Debug)]
pub struct CelestialOptions {
    /// Stars.
    pub stars: Option<Arc<StarCatalogue>>,
    /// The Milky Way: light of stars too faint to be drawn, `Rgba8Srgb`. Equirectangular in GCRF axes, declination 90° at the top, right
    /// ascension 90° at the left edge and falling to the right.
    pub milky_way: Option<Arc<LayerImage>>,
    /// The Sun's disc.
    pub sun: bool,
    /// The Moon's map, `Rgba8Srgb`: equirectangular, the middle of its near side in the middle, east to the right.
    pub moon: Option<Arc<LayerImage>>,
    /// Sunlight that lens and eye scatter around the Sun.
    pub glare: bool,
    /// With glare: sunlight that the lens's aperture diffracts into spikes. It is taken from the disc.
    pub aperture: Option<Arc<DiffractionPattern>>,
    /// With glare: lens ghosts, images of the aperture by reflected sunlight. Their light is taken from the disc.
    pub ghosts: Option<Ghosts>,
    /// Brightness of stars and Milky Way relative to the true one, so that they are visible beside daylight.
    pub star_gain: f64,
    /// Whether that gain falls to 1 in images of sunlit ground or air, since a camera exposed for daylight shows no stars, and rises to ten times
    /// itself where the Moon is new or down.
    pub stars_fade_by_day: bool,
}

impl CelestialOptions {
    /// Default of [`Self::star_gain`]: that of `[earth] night_gain` for moonlight.
    pub const STAR_GAIN: f64 = 4e4;

    /// No part of the sky.
    pub const NOTHING: Self = Self {
        stars: None,
        milky_way: None,
        sun: false,
        moon: None,
        glare: false,
        aperture: None,
        ghosts: None,
        star_gain: Self::STAR_GAIN,
        stars_fade_by_day: true,
    };

    /// Names of all parts.
    pub const FEATURES: [&'static str; 5] = ["stars", "milky_way", "sun", "moon", "glare"];

    /// Names of the parts that are on.
    pub fn features_on(&self) -> Vec<&'static str> {
        let (stars, milky_way) = (self.stars.is_some(), self.milky_way.is_some());
        let is_on = [stars, milky_way, self.sun, self.moon.is_some(), self.glare];
        let features = Self::FEATURES.into_iter().zip(is_on);
        features
            .filter_map(|(name, is_on)| is_on.then_some(name))
            .collect()
    }

    fn shown_ghosts(&self) -> Option<&Ghosts> {
        self.ghosts.as_ref().filter(|_| self.glare)
    }

    fn check(&self) -> Result<(), CelestialError> {
        for (what, map) in [("milky_way", &self.milky_way), ("moon", &self.moon)] {
            if let Some(map) = map {
                let cause = map.check().err().map(|error| error.to_string());
                let is_color = map.format == terrella_imagery::TexelFormat::Rgba8Srgb;
                let cause = cause.or((!is_color).then(|| "it is no colour map".to_owned()));
                if let Some(cause) = cause {
                    return Err(CelestialError::Map { what, cause });
                }
            }
        }
        match self.star_gain.is_finite() && self.star_gain >= 0.0 {
            true => Ok(()),
            false => Err(CelestialError::StarGain(self.star_gain)),
        }
    }
}

/// Why the sky cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum CelestialError {
    /// A shader file is invalid.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// A star catalogue that cannot be read.
    #[error("{}", error.named(path))]
    Stars { path: PathBuf, error: StarError },
    /// A map that cannot be read.
    #[error(transparent)]
    File(#[from] ImageryError),
    /// An invalid map.
    #[error("{what}: {cause}")]
    Map { what: &'static str, cause: String },
    /// A star gain out of range.
    #[error("star_gain {0} is not a number from 0 up")]
    StarGain(f64),
}

/// Time and eye of a frame.
#[derive(Clone, Copy, Debug)]
pub struct CelestialMoment<'m> {
    /// The time.
    pub epoch: Epoch,
    /// The Earth's orientation at that time.
    pub orientation: Orientation,
    /// The view from the eye.
    pub view: &'m EyeView,
    /// The part of the target that the pass draws to.
    pub target: Viewport,
    /// Velocity of the eye relative to the Earth's centre, metres a second, in non-rotating axes that are aligned with ITRF at this time. It sets
    /// the aberration, 5″ in low orbit. `None` is at rest on the rotating Earth.
    pub velocity_m_s: Option<DVec3>,
}

impl<'m> CelestialMoment<'m> {
    /// For an eye at rest, and the Earth's orientation without measured corrections.
    pub fn new(epoch: Epoch, view: &'m EyeView, target: impl Into<Viewport>) -> Self {
        Self {
            epoch,
            orientation: Orientation::default(),
            view,
            target: target.into(),
            velocity_m_s: None,
        }
    }

    /// The observer of this time, with the eye's position and velocity.
    pub fn observer(&self) -> Observer {
        let (eye, _) = self.view.to_itrf();
        match self.velocity_m_s {
            Some(velocity) => Observer::moving(self.epoch, &self.orientation, eye, velocity),
            None => Observer::at_rest(self.epoch, &self.orientation, eye),
        }
    }
}

/// Statistics of the sky in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CelestialStats {
    /// Stars in the image that neither Earth nor Moon hides.
    pub stars: u32,
    /// Fraction of the Sun's disc that Earth and Moon do not hide, 0…1.
    pub sun_seen: f64,
    /// Angle at the Moon between Sun and eye, radians; 0 is full Moon.
    pub moon_phase_rad: f64,
    /// Draw calls.
    pub draw_calls: u32,
    /// Triangles.
    pub triangles: u32,
    /// Bytes written to the GPU.
    pub uploaded_bytes: u64,
}

/// Stars, Milky Way, Sun and Moon.
pub struct Celestial {
    options: CelestialOptions,
    pass: Pass,
    drawable: CelestialDrawable,
    points: Vec<StarPoint>,
    is_shown: bool,
    shows_stars: bool,
}

/// Format of the pass, and the air.
#[derive(Clone, PartialEq)]
struct Pass {
    format: PassFormat,
    air: Option<AirTextures>,
    pipelines: Pipelines,
}

impl Pass {
    fn of(earth: &Earth) -> Self {
        Self {
            format: earth.format(),
            air: earth.air_textures().cloned(),
            pipelines: earth.pipelines(),
        }
    }

    /// The depths at infinity and at the near plane.
    fn depths(&self) -> (f32, f32) {
        match self.format.depth {
            DepthBuffer::StandardZ(_) => (1.0, 0.0),
            DepthBuffer::ReversedZ(_) | DepthBuffer::None => (0.0, 1.0),
        }
    }

    /// `replaced`: the drawable that it replaces.
    fn drawable(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        options: &CelestialOptions,
        replaced: Option<&CelestialDrawable>,
    ) -> Result<CelestialDrawable, ShaderError> {
        let stars = options.stars.as_ref();
        let parts = CelestialParts {
            milky_way: options.milky_way.as_deref(),
            stars: stars.map_or(0, |catalogue| catalogue.stars().len()),
            sun: options.sun,
            moon: options.moon.as_deref(),
            glare: options.glare,
            aperture: options.aperture.as_deref(),
            ghosts: options.shown_ghosts().map_or(0, |_| Ghosts::ALL.len()),
        };
        let air = self.air.as_ref();
        let mut drawable = CelestialDrawable::new(device, queue, self.format, &parts, air)?;
        if let Some(replaced) = replaced {
            drawable.share_pipelines(replaced);
        }
        if self.pipelines == Pipelines::AtOnce {
            drawable.make_all()?;
        }
        Ok(drawable)
    }
}

impl Celestial {
    /// Uploads maps and makes pipelines for the pass and the air of an Earth, when that Earth makes its own ([`Pipelines`]).
    ///
    /// # Errors
    /// Invalid maps, or a gain out of range.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        earth: &Earth,
        options: &CelestialOptions,
    ) -> Result<Self, CelestialError> {
        options.check()?;
        let pass = Pass::of(earth);
        Ok(Self {
            drawable: pass.drawable(device, queue, options, None)?,
            options: options.clone(),
            pass,
            points: Vec::new(),
            is_shown: false,
            shows_stars: true,
        })
    }

    /// The same sky for a further view of its Earth: it shares pipelines and maps.
    pub fn new_view(&self, device: &wgpu::Device, view: &EarthView) -> Self {
        let pass = Pass {
            format: self.pass.format,
            air: view.air_textures().cloned(),
            pipelines: self.pass.pipelines,
        };
        Self {
            drawable: self.drawable.for_another_view(device, pass.air.as_ref()),
            options: self.options.clone(),
            pass,
            points: Vec::new(),
            is_shown: false,
            shows_stars: self.shows_stars,
        }
    }

    /// Shows or hides stars and Milky Way from the next [`Self::prepare`] on, if the options have them. They are shown at first.
    pub fn show_stars(&mut self, are_shown: bool) {
        self.shows_stars = are_shown;
    }

    /// Changes what is drawn from the next [`Self::prepare`] on, and adapts to the Earth's quality. Pipelines that are still needed are kept. Make the
    /// skies of further views again from this one.
    ///
    /// # Errors
    /// Those of [`Self::new`]. Nothing has then changed.
    pub fn set_options(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        earth: &Earth,
        options: &CelestialOptions,
    ) -> Result<(), CelestialError> {
        options.check()?;
        let pass = Pass::of(earth);
        self.drawable = pass.drawable(device, queue, options, Some(&self.drawable))?;
        self.options = options.clone();
        self.pass = pass;
        self.is_shown = false;
        Ok(())
    }

    /// Adapts to another quality of the Earth. Afterwards, prepare again, and make the skies of further views again from this one.
    ///
    /// # Errors
    /// None beyond those of [`Self::new`].
    pub fn follow(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        earth: &Earth,
    ) -> Result<(), CelestialError> {
        match Pass::of(earth) == self.pass {
            true => Ok(()),
            false => self.set_options(device, queue, earth, &self.options.clone()),
        }
    }

    /// Computes what the eye sees and uploads it. Call once a frame, after [`Earth::prepare`] with the same view. It never waits. If the view has
    /// no image, nothing is drawn.
    pub fn prepare(
        &mut self,
        queue: &wgpu::Queue,
        earth: &Earth,
        moment: &CelestialMoment<'_>,
    ) -> CelestialStats {
        self.prepare_view(queue, earth.first_view(), moment)
    }

    /// As [`Self::prepare`], for a further view of the Earth that [`Self::new_view`] was called for.
    pub fn prepare_view(
        &mut self,
        queue: &wgpu::Queue,
        earth: &EarthView,
        moment: &CelestialMoment<'_>,
    ) -> CelestialStats {
        let view = moment.view.in_itrf(moment.target);
        self.is_shown = view.is_ok();
        self.points.clear();
        let Ok(view) = view else {
            return CelestialStats::default();
        };
        let ellipsoid = earth.ellipsoid();
        let seen = Seen::new(&moment.observer(), &view, &ellipsoid);
        let projection = Projection::new(&view, moment.target);
        let (far, near) = self.pass.depths();
        let sun = projection.disc(seen.sun_m, SUN_RADIUS_M, far);
        let mut moon = projection.disc(seen.moon_m, MOON_RADIUS_M, far);
        if seen.moon_m.length() < view.eye_itrf_m.length() {
            moon.disc.depth = projection.depth(seen.moon_m);
            moon.disc.covers = 1.0;
        }
        let gain = self.star_gain(&view, &seen, &ellipsoid);
        if let Some(catalogue) = self.options.stars.as_ref().filter(|_| self.shows_stars) {
            let years = (moment.epoch.to_jde_tt_days() - CATALOGUE_JD) / YEAR_DAYS;
            let shown = (catalogue.as_ref(), years, gain as f32);
            seen.stars(shown, &projection, &ellipsoid, &mut self.points);
        }
        let stars = self.points.len() as u32;
        let (aperture, sun_kept) = self.diffracted(moment.target, sun.radius_px);
        let shown = self.options.shown_ghosts();
        let sun_kept = sun_kept * (1.0 - shown.map_or(0.0, |ghosts| ghosts.part));
        let sun_direction = seen.sun_m.normalize_or_zero();
        let ghosts = shown.and_then(|ghosts| ghosts::points(ghosts, sun_direction, &projection));
        let ghosts = ghosts.as_ref().map_or(&[][..], |ghosts| &ghosts[..]);
        if self.options.sun && sun.radius_px < POINT_PX {
            let light = Vec3::splat((PI * seen.sun_seen * sun_kept) as f32);
            self.points.extend(projection.point(sun_direction, light));
        }
        if self.options.moon.is_some() && moon.radius_px < POINT_PX {
            let light = Vec3::splat((PI * seen.moonlight()) as f32);
            self.points
                .extend(projection.point(seen.moon_m.normalize_or_zero(), light));
        }
        let glare = GLARE_RADIUS_RAD.sin();
        let glare_bounds = ball_bounds(&view.clip_from_eye, sun_direction, glare);
        let uniforms = CelestialUniforms {
            frame: earth.exposed(view.uniforms(&ellipsoid)),
            glare_bounds: glare_bounds.map_or(Vec4::ZERO, Vec4::from),
            near_depth: near,
            sun_kept: sun_kept as f32,
            aperture,
            star_gain: gain as f32,
            milky_way_level: level(&self.options.milky_way, view.pixel_rad()),
            moon_level: level(&self.options.moon, moon.radius_px.max(1e-9).recip()),
            ..seen.uniforms(&sun.disc, &moon.disc, &projection, &ellipsoid)
        };
        let is_sun_up = seen.sun_seen > 0.0;
        let is_drawn = |kind| match kind {
            CelestialKind::Sun => sun.radius_px >= POINT_PX && sun.is_in_picture && is_sun_up,
            CelestialKind::Moon => moon.radius_px >= POINT_PX && moon.is_in_picture,
            CelestialKind::MilkyWay => self.shows_stars,
            CelestialKind::Glare => glare_bounds.is_some() && is_sun_up,
            CelestialKind::Ghosts => is_sun_up,
            _ => true,
        };
        let side = match (view.eye_itrf_m * ellipsoid.scaled_from_itrf()).length() <= TOP {
            true => AirSide::Inside,
            false => AirSide::Outside,
        };
        let uploaded_bytes =
            self.drawable
                .write(queue, side, &uniforms, &self.points, ghosts, is_drawn);
        let draw_calls = self.drawable.calls();
        CelestialStats {
            stars,
            sun_seen: seen.sun_seen,
            moon_phase_rad: seen.phase_rad,
            draw_calls,
            triangles: 2 * ((self.points.len() + ghosts.len()) as u32 + draw_calls),
            uploaded_bytes,
        }
    }

    /// Size of a pixel and radius of the Sun in sides of the diffraction pattern, and the fraction of sunlight that stays in the disc.
    fn diffracted(&self, target: Viewport, sun_radius_px: f64) -> (Vec2, f64) {
        let pattern = self.options.aperture.as_ref();
        let Some(pattern) = pattern.filter(|_| self.options.glare) else {
            return (Vec2::ZERO, 1.0);
        };
        let height_px = f64::from(target.size.1);
        let pixel = pattern.aperture().pattern_sides_a_pixel(height_px);
        let radius = pixel * sun_radius_px;
        let radius_px = radius * f64::from(DiffractionPattern::SIDE_PX);
        let sides = Vec2::new(pixel as f32, radius as f32);
        (sides, 1.0 - pattern.diffracted(radius_px))
    }

    /// Gain of the stars in a view.
    fn star_gain(&self, view: &ItrfView, seen: &Seen, ellipsoid: &Ellipsoid) -> f64 {
        let gain = self.options.star_gain;
        let has_stars = self.options.stars.is_some() || self.options.milky_way.is_some();
        if !self.options.stars_fade_by_day || !has_stars || gain <= 1.0 {
            return gain;
        }
        let daylight = daylight_in_sight(view, seen.sun_m.normalize_or_zero(), ellipsoid);
        let moon = (seen.moon_m.normalize_or_zero(), seen.moonlight());
        let by_night = gain_by_night(gain, view.eye_itrf_m, moon, 0.0, ellipsoid);
        gain_beside(by_night, daylight)
    }

    /// Draws the sky: after the Earth and all other opaque objects.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.is_shown {
            self.drawable.render(pass);
        }
    }

    /// The options.
    pub fn options(&self) -> &CelestialOptions {
        &self.options
    }

    /// Bytes of its maps on the GPU, mip levels included.
    pub fn texture_bytes(&self) -> u64 {
        self.drawable.texture_bytes
    }

    /// Bytes of the WGSL that the driver got, for the parts that are on.
    pub fn shader_bytes(&self) -> u64 {
        self.drawable.shader_bytes
    }
}

/// Mip level of a map of 360° at which a texel covers this angle.
fn level(map: &Option<Arc<LayerImage>>, pixel_rad: f64) -> f32 {
    let texels = map.as_ref().map_or(1.0, |map| f64::from(map.width)) * pixel_rad / (2.0 * PI);
    texels.max(1.0).log2() as f32
}
