//! What each layer and effect costs: the scene beside the same scene without it.

use super::report::Feature;
use super::rows::rounded;
use crate::gpu::{BcSupport, GpuContext};
use crate::imagery::tile::MapLayer;
use crate::measure::frame_timer::milliseconds;
use crate::measure::{FrameTimer, median};
use crate::play::clock::frame_epoch;
use crate::play::{
    Flight, Moment, OffscreenRenderer, PlayError, Progress, TimedFrame, TracksLayer, earth_options,
    target_bytes,
};
use crate::scene::Scene;
use crate::{Atmosphere, EarthOptions, Shading};

/// Frames of each kind drawn before the first that counts.
const WARM_UP: u32 = 2;

/// A layer or an effect that can be switched off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FeatureKind {
    Map(MapLayer),
    CloudShadows,
    Detail,
    Moonlight,
    Eclipses,
    Airglow,
    Atmosphere,
    Relief,
    Tiles,
    Multisampling,
    Anisotropy,
    /// A part of `[sky]`, by its key.
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
        let is_sunlit = options.shading == Shading::Sunlit;
        let has_air = options.atmosphere != Atmosphere::None;
        for (kind, is_on) in [
            (
                Self::CloudShadows,
                is_sunlit && options.light.cloud_shadows && options.layers.clouds.is_some(),
            ),
            (Self::Detail, is_sunlit && options.light.detail),
            (Self::Moonlight, is_sunlit && options.light.moonlight),
            (Self::Eclipses, is_sunlit && options.light.eclipses),
            (Self::Airglow, has_air && options.light.airglow),
            (Self::Atmosphere, has_air),
            (Self::Relief, options.ground.is_some()),
            (Self::Tiles, options.tiles.is_some()),
            (Self::Multisampling, options.samples > 1),
            // Software adapters never filter so.
            (
                Self::Anisotropy,
                options.anisotropy > 1 && !gpu.is_software(),
            ),
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
        if TracksLayer::is_wanted(flight) {
            kinds.push(Self::Tracks);
        }
        kinds
    }

    /// Whether it is no part of the Earth.
    fn is_beside_the_earth(self) -> bool {
        matches!(self, Self::Sky(_) | Self::Tracks)
    }

    fn name(self) -> &'static str {
        match self {
            Self::Map(layer) => layer.name(),
            Self::CloudShadows => "cloud_shadows",
            Self::Detail => "detail",
            Self::Moonlight => "moonlight",
            Self::Eclipses => "eclipses",
            Self::Airglow => "airglow",
            Self::Atmosphere => "atmosphere",
            Self::Relief => "relief",
            Self::Tiles => "tiles",
            Self::Multisampling => "multisampling",
            Self::Anisotropy => "anisotropy",
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
            Self::CloudShadows => less.light.cloud_shadows = false,
            Self::Detail => less.light.detail = false,
            Self::Moonlight => less.light.moonlight = false,
            Self::Eclipses => less.light.eclipses = false,
            Self::Airglow => less.light.airglow = false,
            Self::Atmosphere => less.atmosphere = Atmosphere::None,
            Self::Relief => less.ground = None,
            Self::Tiles => less.tiles = None,
            Self::Multisampling => less.samples = 1,
            Self::Anisotropy => less.anisotropy = 1,
            // A pack is opened anew: its tiles go with the map.
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
            // The ground itself is never left out, and what is beside the Earth is none of its options.
            Self::Map(MapLayer::Day) | Self::Sky(_) | Self::Tracks => {}
        }
        Ok(less)
    }
}

/// Times the scene with and without a feature, turn about, along the scene's own flight; `None` where the work is no longer
/// wanted. `options` are those that `timer` was made with.
pub(super) fn measure(
    kind: FeatureKind,
    flight: &Flight,
    timer: &mut FrameTimer,
    options: &EarthOptions,
    frames: u32,
    progress: &dyn Progress,
) -> Result<Option<Feature>, PlayError> {
    let scene = flight.scene();
    let gpu = timer.picture().gpu().clone();
    let size = timer.picture().size();
    let less = kind.options_without(scene, options, gpu.bc_support())?;
    let less_samples = less.samples;
    let mut less = OffscreenRenderer::open(gpu.clone(), less, size)?;
    let mut own = match kind.is_beside_the_earth() {
        true => Some(OffscreenRenderer::open(gpu, options.clone(), size)?),
        false => None,
    };
    if let Some(own) = &mut own {
        match kind {
            FeatureKind::Tracks => own.show_tracks(flight)?,
            _ => own.show_sky(flight)?,
        }
    }
    if let FeatureKind::Sky(part) = kind {
        less.show_sky_without(flight, part)?;
    }
    let whole = own.as_mut().unwrap_or(timer.picture_mut());
    let aspect = less.aspect();
    let flight_frames = scene.time.frame_count();
    let moment = |n: u32| {
        let index = flight_frames * u64::from(n) / u64::from(frames);
        flight.at(frame_epoch(&scene.time, index), aspect)
    };
    let first = moment(0)?;
    for _ in 0..WARM_UP {
        timed(whole, &first, scene)?;
        timed(&mut less, &first, scene)?;
    }
    let (mut with, mut without, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    let mut texture_bytes = [0; 2];
    for n in 0..frames {
        if progress.cancelled() {
            return Ok(None);
        }
        let moment = moment(n)?;
        // Neither is always the first.
        let (a, b) = if n % 2 == 0 {
            let a = timed(whole, &moment, scene)?;
            (a, timed(&mut less, &moment, scene)?)
        } else {
            let b = timed(&mut less, &moment, scene)?;
            (timed(whole, &moment, scene)?, b)
        };
        let (a_ms, b_ms) = (milliseconds(a.frame), milliseconds(b.frame));
        with.push(a_ms);
        without.push(b_ms);
        ratios.push(a_ms / b_ms.max(1e-6));
        texture_bytes = [a.stats.texture_bytes, b.stats.texture_bytes];
    }
    let difference = |more: u64, less: u64| more as i64 - less as i64;
    let targets = difference(
        target_bytes(size, options.samples),
        target_bytes(size, less_samples),
    );
    let shader = [&*whole, &less].map(OffscreenRenderer::shader_bytes);
    Ok(Some(Feature {
        name: kind.name().to_owned(),
        frame_ms_with: rounded(median(&with)),
        frame_ms_without: rounded(median(&without)),
        frame_ratio: rounded(median(&ratios)),
        texture_bytes: difference(texture_bytes[0], texture_bytes[1]) + targets,
        shader_bytes: difference(shader[0], shader[1]),
    }))
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
