//! One image of a scene by the reference renderer, into a file, and its numbers.

use glam::DVec3;
use std::path::Path;
use std::time::{Duration, Instant};
use terrella::frames::{Epoch, rfc3339};
use terrella::internals::earth::{metered_ev, night_gain_in};
use terrella::internals::gpu::BcSupport;
use terrella::{Atmosphere, Exposure};
use terrella_imagery::tile::{MapLayer, TileError};
use terrella_play::{
    EyePosition, Flight, Moment, OutputError, PendingFile, PlayError, Progress, SubsolarPoint,
    written_picture,
};
use terrella_reference::{
    FullMaps, MAX_MAP_BYTES, Reference, ReferenceError, ReferenceOptions, whole_maps,
};

/// Most memory that the picture itself may take, MiB.
const MAX_PICTURE_MIB: u64 = 4096;

/// Request of a true image.
#[derive(Clone, Debug)]
pub struct ReferenceRequest<'r> {
    /// The instant; `None` is the scene's start.
    pub epoch: Option<Epoch>,
    /// Width and height, pixels; `None` is the scene's.
    pub size: Option<(u32, u32)>,
    /// N × N rays a pixel.
    pub samples: u32,
    /// The PNG to write.
    pub output: &'r Path,
    /// The JSON to write its numbers to, if they are wanted.
    pub stats: Option<&'r Path>,
}

/// Errors between a scene and its true image.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StillError {
    /// The scene, its orbit or its maps.
    #[error("{0}")]
    Play(#[from] PlayError),
    /// The file could not be written.
    #[error("{0}")]
    Output(#[from] OutputError),
    /// Maps or options.
    #[error("{0}")]
    Reference(#[from] ReferenceError),
    /// A tile of the pack.
    #[error("{0}")]
    Tile(TileError),
    /// The picture needs more memory than this program takes.
    #[error(
        "a picture of {width} × {height} pixels needs {mib} MiB, more than the {limit_mib} MiB allowed; take a smaller size"
    )]
    TooMuchMemory {
        width: u32,
        height: u32,
        /// Memory required, MiB.
        mib: u64,
        /// Memory allowed, MiB.
        limit_mib: u64,
    },
    /// The work was stopped from outside.
    #[error("interrupted; nothing was written")]
    Interrupted,
}

impl From<TileError> for StillError {
    fn from(error: TileError) -> Self {
        match error {
            TileError::Cancelled => Self::Interrupted,
            error => Self::Tile(error),
        }
    }
}

/// The numbers of a true picture.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceStats {
    /// Always `reference`: what distinguishes these numbers from a graphics adapter's.
    pub renderer: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// N of N × N rays a pixel.
    pub samples: u32,
    /// Wall time of the picture, milliseconds, maps and air not counted.
    pub frame_ms: f64,
    /// Bytes of the maps' texels.
    pub map_bytes: u64,
    /// Width of the day map, texels.
    pub day_width: u32,
    /// Part of the picture that is ground, 0…1.
    pub ground: f64,
    /// Features that are drawn.
    pub features_on: Vec<String>,
    pub features_off: Vec<String>,
    /// Requests of the scene that this renderer does not draw.
    pub left_out: Vec<String>,
    pub eye: EyePosition,
    /// Position of the subsolar point.
    pub sun: SubsolarPoint,
    /// The instant, UTC, RFC 3339.
    pub epoch: String,
}

/// Computes and writes one image. No file is left if that fails or is stopped.
///
/// Requests of the scene that the reference does not draw are reported by name in a warning and in the statistics ([`ReferenceStats::left_out`]).
/// From a pack it uses the finest levels that fit into [`MAX_MAP_BYTES`], regardless of the scene's settings of levels and memory; a warning
/// reports that too.
pub fn write_reference_still(
    flight: &Flight,
    request: &ReferenceRequest<'_>,
    progress: &dyn Progress,
) -> Result<(), StillError> {
    flight.reject_live(
        "no simulator waits as long as this renderer takes",
        "draw it by a graphics adapter, with --renderer gpu",
    )?;
    let begun = Instant::now();
    let scene = flight.scene();
    let epoch = request.epoch.unwrap_or(scene.time.start);
    let size = request.size.unwrap_or(scene.output.size.into());
    check_memory(size)?;
    let moment = flight.at(epoch, f64::from(size.0) / f64::from(size.1))?;
    let output = PendingFile::create(request.output, "images", "png")?;
    let stats = match request.stats {
        Some(path) => Some(PendingFile::create(path, "numbers", "json")?),
        None => None,
    };
    progress.begin("loading maps", None);
    let (reference, mut left_out) = load(flight, &moment, request.samples, progress)?;
    progress.end();
    if flight
        .scene()
        .orbits
        .iter()
        .any(|orbit| !orbit.track.is_off())
    {
        left_out.push("tracks".to_owned());
    }
    let sky = scene.sky.parts().into_iter().filter(|(_, is_on)| *is_on);
    left_out.extend(sky.map(|(part, _)| part.to_owned()));
    let radius_m = flight.ellipsoid().equatorial_radius_m;
    let shadow = moment.sky.moon_shadow().filter(|_| scene.sky.eclipses);
    if shadow.is_some_and(|shadow| shadow.reaches(DVec3::ZERO, radius_m)) {
        left_out.push("eclipse".to_owned());
    }
    if moment.craft.is_some() {
        left_out.push("spacecraft".to_owned());
    }
    if !left_out.is_empty() {
        tracing::warn!(
            "the reference renderer does not draw what this scene asks for: {}",
            left_out.join(", ")
        );
    }
    progress.begin("drawing", Some(u64::from(size.1)));
    let (width, height) = size;
    tracing::info!(
        "drawing {width} × {height} pixels with {0} × {0} rays a pixel",
        request.samples
    );
    let begin = Instant::now();
    let picture = reference
        .render_unless(
            &moment.view,
            &moment.sky,
            size,
            &|| progress.step(),
            &|| progress.cancelled(),
        )
        .ok_or(StillError::Interrupted)?;
    let frame = begin.elapsed();
    progress.end();
    output.write_png(&picture.to_rgba8())?;
    if let Some(file) = stats {
        let ground: f64 = picture.ground.iter().map(|part| f64::from(*part)).sum();
        let ground = ground / picture.ground.len().max(1) as f64;
        let numbers = ReferenceStats {
            left_out,
            ..ReferenceStats::new(&reference, flight, &moment, size, frame, ground)
        };
        file.write_whole(numbers.to_json().as_bytes())?;
    }
    progress.say(&written_picture(request.output, size, begun.elapsed()));
    Ok(())
}

/// The scene's maps and elevation data at full resolution, and the air; and the features of its Earth that are not drawn.
fn load(
    flight: &Flight,
    moment: &Moment,
    samples: u32,
    progress: &dyn Progress,
) -> Result<(Reference, Vec<String>), StillError> {
    // Tiles are read as plain texels.
    let mut earth = flight.earth_options_at(moment.epoch, BcSupport::None)?;
    if earth.exposure == Exposure::Auto
        && let Some(ev) = metered_ev(&earth, &moment.view, &moment.sky)
    {
        earth.exposure = Exposure::Ev(ev);
    }
    if let Some(gain) = night_gain_in(&earth, &moment.view, &moment.sky) {
        earth.light.night_gain = gain;
    }
    let relief = earth.ground.take().map(|ground| ground.elevation);
    let left_out = Reference::left_out(&earth)
        .into_iter()
        .map(str::to_owned)
        .collect();
    let options = ReferenceOptions::of(&earth, samples);
    let maps = match &earth.tiles {
        None => FullMaps::taken(earth.layers)?,
        Some(tiles) => {
            let cancelled = || progress.cancelled();
            let found = whole_maps(tiles.source.as_ref(), MAX_MAP_BYTES, &cancelled)?;
            for (layer, width) in found.coarser {
                tracing::warn!(
                    "the finest {layer} maps of the pack do not fit into {} MiB; {width} texels round the Earth are taken",
                    MAX_MAP_BYTES >> 20
                );
            }
            found.maps
        }
    };
    if progress.cancelled() {
        return Err(StillError::Interrupted);
    }
    let reference = Reference::with_maps(maps, options)?;
    let reference = match relief {
        Some(elevation) => reference.on_relief(elevation),
        None => reference,
    };
    Ok((reference, left_out))
}

/// 16 bytes a pixel of the picture and four of its encoding, and three for the file's.
fn check_memory((width, height): (u32, u32)) -> Result<(), StillError> {
    let mib = (u64::from(width) * u64::from(height) * (16 + 4 + 3)) >> 20;
    if mib <= MAX_PICTURE_MIB {
        return Ok(());
    }
    Err(StillError::TooMuchMemory {
        width,
        height,
        mib,
        limit_mib: MAX_PICTURE_MIB,
    })
}

impl ReferenceStats {
    fn new(
        reference: &Reference,
        flight: &Flight,
        moment: &Moment,
        size: (u32, u32),
        frame: Duration,
        ground: f64,
    ) -> Self {
        let options = reference.options();
        let maps = reference.maps();
        let (eye_m, _) = moment.view.to_itrf();
        let place = flight
            .scene()
            .earth
            .figure
            .ellipsoid()
            .geodetic_from_itrf(eye_m);
        let sun = moment.sky.sun_itrf;
        let layers = [
            MapLayer::Clouds,
            MapLayer::Normals,
            MapLayer::NightLights,
            MapLayer::Water,
        ];
        let has_air = options.atmosphere != Atmosphere::None;
        let features: Vec<_> = layers
            .map(|layer| (layer.name(), maps.layers[layer.index()].is_some()))
            .into_iter()
            .chain([("atmosphere", has_air), ("relief", reference.has_relief())])
            .collect();
        let named = |wanted: bool| {
            let all = features.iter().filter(|(_, is_on)| *is_on == wanted);
            all.map(|(name, _)| (*name).to_owned()).collect()
        };
        let day = maps.layers[MapLayer::Day.index()].as_ref();
        Self {
            renderer: "reference".into(),
            size: [size.0, size.1],
            samples: options.samples,
            frame_ms: (frame.as_secs_f64() * 1e6).round() / 1e3,
            map_bytes: maps.bytes(),
            day_width: day.map_or(0, |map| map.width),
            ground,
            features_on: named(true),
            features_off: named(false),
            left_out: Vec::new(),
            eye: EyePosition {
                lat_deg: place.lat_rad.to_degrees(),
                lon_deg: place.lon_rad.to_degrees(),
                height_km: place.height_m / 1000.0,
            },
            sun: SubsolarPoint {
                lat_deg: sun.z.atan2(sun.x.hypot(sun.y)).to_degrees(),
                lon_deg: sun.y.atan2(sun.x).to_degrees(),
            },
            epoch: rfc3339(moment.epoch),
        }
    }

    /// As indented JSON with a line end.
    pub fn to_json(&self) -> String {
        // Numbers, strings and lists cannot fail to be written; the error is kept for the type's sake.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_else(|error| error.to_string());
        text.push('\n');
        text
    }
}
