//! Cost of each layer and effect: the scene compared with the same scene without it.

use super::report::{COURSE_HEIGHT_KM, Course, Feature, FeatureTimes, Unmeasured, ratios, spread};
use super::rows::{precise, rounded};
use crate::frame_timer::milliseconds;
use crate::{FrameTimer, median};
use terrella::internals::gpu::{BcSupport, GpuContext};
use terrella::internals::offscreen::picture_bytes;
use terrella::{Atmosphere, EarthOptions, Grade, Grain, LightEffect, PassFormat, Shading};
use terrella_imagery::tile::MapLayer;
use terrella_play::clock::frame_epoch;
use terrella_play::scene::Scene;
use terrella_play::{
    Flight, Moment, OffscreenRenderer, PlayError, Progress, TimedFrame, TracksLayer, earth_options,
};

/// Frames of each kind drawn before the first that counts.
const WARM_UP: u32 = 2;

/// A layer or an effect that can be switched off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FeatureKind {
    Map(MapLayer),
    Light(LightEffect),
    Atmosphere,
    Relief,
    Tiles,
    Multisampling,
    Anisotropy,
    /// That light is added up and developed once, in place of one pass.
    Composition,
    Bloom,
    WhiteBalance,
    Grain,
    /// A part of `[sky]`, by its key, or aperture and ghosts of `[lens]`.
    Sky(&'static str),
    Tracks,
}

impl FeatureKind {
    /// Those that a flight's scene has on, whose Earth has these options.
    pub fn on(flight: &Flight, options: &EarthOptions, gpu: &GpuContext) -> Vec<Self> {
        let layers = MapLayer::ALL.into_iter();
        let mut kinds: Vec<_> = layers
            .filter(|layer| *layer != MapLayer::Day && options.layers.get(*layer).is_some())
            .map(Self::Map)
            .collect();
        let has_air = options.atmosphere != Atmosphere::None;
        let effects = options.light.effects();
        let is_drawn = |effect: &LightEffect| {
            effects.has(*effect)
                && match effect {
                    LightEffect::Airglow => has_air,
                    LightEffect::CloudShadows if options.layers.clouds.is_none() => false,
                    _ => options.shading == Shading::Sunlit,
                }
        };
        let effects = LightEffect::ALL.iter().copied().filter(is_drawn);
        kinds.extend(effects.map(Self::Light));
        for (kind, is_on) in [
            (Self::Atmosphere, has_air),
            (Self::Relief, options.ground.is_some()),
            (Self::Tiles, options.tiles.is_some()),
            (Self::Multisampling, options.samples > 1),
            (
                Self::Anisotropy,
                options.anisotropy > 1 && !gpu.is_software(),
            ),
            (Self::Composition, can_be_shown_in_pass(options)),
            (Self::Bloom, options.bloom.strength > 0.0),
            (Self::WhiteBalance, options.grade.white_balance.is_some()),
            (Self::Grain, options.grade.grain.strength > 0.0),
        ] {
            if is_on {
                kinds.push(kind);
            }
        }
        let sky = flight.scene().sky.parts().into_iter();
        kinds.extend(
            sky.filter(|(_, is_on)| *is_on)
                .map(|(key, _)| Self::Sky(key)),
        );
        if flight.scene().aperture.is_some() {
            kinds.push(Self::Sky("aperture"));
        }
        if flight.scene().ghosts.is_some() {
            kinds.push(Self::Sky("ghosts"));
        }
        if TracksLayer::is_wanted(flight) {
            kinds.push(Self::Tracks);
        }
        kinds
    }

    /// Whether it is not part of the Earth.
    fn is_beside_the_earth(self) -> bool {
        matches!(self, Self::Sky(_) | Self::Tracks)
    }

    fn name(self) -> &'static str {
        match self {
            Self::Map(layer) => layer.name(),
            Self::Light(effect) => effect.name(),
            Self::Atmosphere => "atmosphere",
            Self::Relief => "relief",
            Self::Tiles => "tiles",
            Self::Multisampling => "multisampling",
            Self::Anisotropy => "anisotropy",
            Self::Composition => "composition",
            Self::Bloom => "bloom",
            Self::WhiteBalance => "white_balance",
            Self::Grain => "grain",
            Self::Sky(key) => key,
            Self::Tracks => "tracks",
        }
    }

    /// The scene's options without it, all else as it was.
    fn options_without(
        self,
        scene: &Scene,
        options: &EarthOptions,
        bc: BcSupport,
    ) -> Result<EarthOptions, PlayError> {
        let mut less = options.clone();
        match self {
            Self::Light(effect) => less.light.set_effect(effect, false),
            Self::Atmosphere => less.atmosphere = Atmosphere::None,
            Self::Relief => less.ground = None,
            Self::Tiles => less.tiles = None,
            Self::Multisampling => less.samples = 1,
            Self::Anisotropy => less.anisotropy = 1,
            Self::Bloom => less.bloom.strength = 0.0,
            Self::WhiteBalance => less.grade.white_balance = None,
            Self::Grain => less.grade.grain = Grain::NONE,
            // A pack is opened again: its tiles go with the map.
            Self::Map(layer) if less.tiles.is_some() => {
                let mut scene = scene.clone();
                let earth = &mut scene.earth;
                earth.clouds &= layer != MapLayer::Clouds;
                earth.normals &= layer != MapLayer::Normals;
                earth.night_lights &= layer != MapLayer::NightLights;
                earth.water &= layer != MapLayer::Water;
                less = EarthOptions {
                    samples: options.samples,
                    ..earth_options(&scene, bc)?
                };
            }
            Self::Map(MapLayer::Clouds) => less.layers.clouds = None,
            Self::Map(MapLayer::Normals) => less.layers.normals = None,
            Self::Map(MapLayer::NightLights) => less.layers.night_lights = None,
            Self::Map(MapLayer::Water) => less.layers.water = None,
            // The ground itself is never left out, and these are not among the options of the Earth.
            Self::Map(MapLayer::Day) | Self::Composition | Self::Sky(_) | Self::Tracks => {}
        }
        Ok(less)
    }
}

/// Whether a frame can be drawn in one pass as well, apart from bloom, white balance and grain.
fn can_be_shown_in_pass(options: &EarthOptions) -> bool {
    options.shading == Shading::Sunlit && options.tone.response().is_none()
}

/// Requests of a scene that this adapter does not support. `wanted` are the scene's options, `drawn_samples` the samples a pixel that the adapter
/// draws.
pub(super) fn unmeasured(
    wanted: &EarthOptions,
    drawn_samples: u32,
    is_software: bool,
) -> Vec<Unmeasured> {
    let mut all = Vec::new();
    let mut add = |kind: FeatureKind, why: &str| {
        all.push(Unmeasured {
            name: kind.name().to_owned(),
            why: why.to_owned(),
        });
    };
    if wanted.anisotropy > 1 && is_software {
        add(
            FeatureKind::Anisotropy,
            "the adapter is software and ignores it",
        );
    }
    if wanted.samples > drawn_samples {
        add(
            FeatureKind::Multisampling,
            "the adapter cannot draw so many samples a pixel",
        );
    }
    all
}

/// A feature that is measured, run after run: the scene, and the scene without it.
pub(super) struct FeatureMeter<'f> {
    kind: FeatureKind,
    flight: &'f Flight,
    /// The scene's own picture where the feature is beside the Earth; else the one that rows are drawn with.
    own: Option<OffscreenRenderer>,
    less: OffscreenRenderer,
    /// The passes that it is drawn in with it and without.
    passes: [PassFormat; 2],
}

impl<'f> FeatureMeter<'f> {
    /// Makes what draws. `options` are those that `timer` was made with.
    pub fn new(
        kind: FeatureKind,
        flight: &'f Flight,
        timer: &FrameTimer,
        options: &EarthOptions,
    ) -> Result<Self, PlayError> {
        let gpu = timer.picture().gpu().clone();
        let size = timer.picture().size();
        let less = kind.options_without(flight.scene(), options, gpu.bc_support())?;
        let (mut less, mut own) = match kind {
            FeatureKind::Composition => {
                let mut developed = options.clone();
                developed.bloom.strength = 0.0;
                developed.grade = Grade::NONE;
                let own = OffscreenRenderer::open(gpu.clone(), developed, size)?;
                (OffscreenRenderer::open_in_pass(gpu, less, size)?, Some(own))
            }
            kind if kind.is_beside_the_earth() => {
                let own = OffscreenRenderer::open(gpu.clone(), options.clone(), size)?;
                (OffscreenRenderer::open(gpu, less, size)?, Some(own))
            }
            _ => (OffscreenRenderer::open(gpu, less, size)?, None),
        };
        match (kind, &mut own) {
            (FeatureKind::Tracks, Some(own)) => own.show_tracks(flight)?,
            (FeatureKind::Sky(part), Some(own)) => {
                own.show_sky(flight)?;
                less.show_sky_without(flight, part)?;
            }
            _ => {}
        }
        let whole = own.as_ref().unwrap_or(timer.picture());
        let passes = [whole.earth().format(), less.earth().format()];
        Ok(Self {
            kind,
            flight,
            own,
            less,
            passes,
        })
    }

    /// The `n`-th of `frames` instants along a course.
    fn moment(&self, course: Course, n: u32, frames: u32) -> Result<Moment, PlayError> {
        let scene = self.flight.scene();
        let aspect = self.less.aspect();
        let index = scene.time.frame_count() * u64::from(n) / u64::from(frames);
        let moment = self.flight.at(frame_epoch(&scene.time, index), aspect)?;
        let Some(path) = course.path() else {
            return Ok(moment);
        };
        let camera = &scene.camera;
        Ok(Moment {
            view: path.view(
                &scene.earth.figure.ellipsoid(),
                COURSE_HEIGHT_KM * 1e3,
                f64::from(n) / f64::from(frames),
                camera.mode,
                camera.fov_deg.to_radians(),
                aspect,
            ),
            craft: None,
            eye_velocity_m_s: None,
            ..moment
        })
    }

    /// Measures it along each course, with `repeats` runs of all of them, the scene with and without it interleaved; `None` if the work is
    /// cancelled.
    pub fn measure(
        &mut self,
        timer: &mut FrameTimer,
        frames: u32,
        repeats: u32,
        progress: &dyn Progress,
    ) -> Result<Option<Vec<Feature>>, PlayError> {
        let mut runs = Course::ALL.map(|_| Vec::new());
        let mut texture_bytes = [0; 2];
        for _ in 0..repeats {
            for (course, runs) in Course::ALL.into_iter().zip(&mut runs) {
                let Some((times, bytes)) = self.run(timer, course, frames, progress)? else {
                    return Ok(None);
                };
                runs.push(times);
                texture_bytes = bytes;
            }
        }
        let size = self.less.size();
        let whole = self.own.as_ref().unwrap_or(timer.picture());
        let difference = |more: u64, less: u64| more as i64 - less as i64;
        let [more, less] = self.passes.map(|pass| picture_bytes(size, &pass));
        let texture_bytes = difference(texture_bytes[0], texture_bytes[1]) + difference(more, less);
        let shader_bytes = difference(whole.shader_bytes(), self.less.shader_bytes());
        let features = Course::ALL.into_iter().zip(runs).map(|(course, runs)| {
            let by_run: Vec<_> = runs
                .iter()
                .map(|run| ratios(&run.with_ms, &run.without_ms))
                .collect();
            let ratio = median(&by_run.concat());
            let all = |of: fn(&FeatureTimes) -> &Vec<f64>| -> Vec<f64> {
                runs.iter().flat_map(of).copied().collect()
            };
            Feature {
                name: self.kind.name().to_owned(),
                course,
                frame_ms_with: rounded(median(&all(|run| &run.with_ms))),
                frame_ms_without: rounded(median(&all(|run| &run.without_ms))),
                frame_ratio: rounded(ratio),
                frame_ratio_spread: spread(&by_run, ratio).map(rounded),
                texture_bytes,
                shader_bytes,
                runs,
            }
        });
        Ok(Some(features.collect()))
    }

    /// One run along a course, and the bytes of textures with and without.
    fn run(
        &mut self,
        timer: &mut FrameTimer,
        course: Course,
        frames: u32,
        progress: &dyn Progress,
    ) -> Result<Option<(FeatureTimes, [u64; 2])>, PlayError> {
        let scene = self.flight.scene();
        let first = self.moment(course, 0, frames)?;
        let mut times = FeatureTimes::default();
        let mut texture_bytes = [0; 2];
        for n in 0..frames + WARM_UP {
            if progress.cancelled() {
                return Ok(None);
            }
            let moment = match n.checked_sub(WARM_UP) {
                Some(n) => self.moment(course, n, frames)?,
                None => first,
            };
            let whole = self.own.as_mut().unwrap_or(timer.picture_mut());
            let less = &mut self.less;
            // Neither is always the first.
            let (a, b) = if n % 2 == 0 {
                let a = timed(whole, &moment, scene)?;
                (a, timed(less, &moment, scene)?)
            } else {
                let b = timed(less, &moment, scene)?;
                (timed(whole, &moment, scene)?, b)
            };
            if n >= WARM_UP {
                times.with_ms.push(precise(milliseconds(a.frame)));
                times.without_ms.push(precise(milliseconds(b.frame)));
            }
            texture_bytes = [a.stats.texture_bytes, b.stats.texture_bytes];
        }
        Ok(Some((times, texture_bytes)))
    }
}

fn timed(
    picture: &mut OffscreenRenderer,
    moment: &Moment,
    scene: &Scene,
) -> Result<TimedFrame, PlayError> {
    if picture.earth().has_tiles() {
        picture.draw_complete(moment, scene.output.wait());
    }
    picture.time(moment)
}
