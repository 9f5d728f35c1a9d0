//! Declares each scene key once: its name, value type, range, default, scope and meaning. [`table`](super::table) explains
//! the form. The sentences above the keys appear in `docs/scene-reference.md`.

use super::caption_keys::RawCaption;
use super::choices::{CameraMode, CameraUp, Look, OrbitSource, StorageChoice};
use super::coverage_keys::RawCoverage;
use super::field::{
    Bounds, Choice, Field, RawCameraKey, RawDatedMaps, RawLookAt, RawPath, RawTone,
};
use super::globe_keys::{RawGeojson, RawLayers, RawStation};
use super::lens::RawLens;
use super::orbit_keys::{RawOrbit, RawTracks};
use super::record::{Notes, Record};
use super::sensor_keys::RawSensor;
#[cfg(test)]
use super::table::About;
use super::table::{Key, Only, Table, Value, given_or, method, table};
use super::text::SceneText;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
#[cfg(test)]
use serde_json::json;
use std::marker::PhantomData;
use std::ops::{Range, RangeInclusive};
use terrella::SurfaceLight;
use terrella_ground::air::{AirOptions, Atmosphere};
use terrella_ground::globe::{Figure, LevelRule, Shading, SurfaceKind, Visibility};
use terrella_ground::light::{Bloom, Grain, WhiteBalance};
use toml::Spanned;

/// First and last year (UTC) of scenes, as in [`utc_from_rfc3339`](terrella::frames::utc_from_rfc3339).
pub(crate) const YEARS: RangeInclusive<i32> = 1900..=2099;
/// Maximum frames in one playback (at 30 per second, almost four days).
pub(super) const MAX_FRAMES: f64 = 1e7;
/// Maximum satellites, `[[orbit]]` tables, in one scene.
pub(super) const MAX_ORBITS: usize = 1000;
/// Maximum satellites of one scene with states from simulators: each needs threads and a port.
pub(super) const MAX_LIVE_ORBITS: usize = 64;
/// Maximum web pages that may connect to a simulator's port.
pub(super) const MAX_ORIGINS: usize = 16;
/// Maximum burns of one satellite.
pub(super) const MAX_BURNS: usize = 1000;
/// Length of a burn, seconds: at most a year.
pub(super) const BURN_S: RangeInclusive<f64> = 1e-3..=3.2e7;
/// Range of each component of a burn's acceleration, m/s².
pub(super) const BURN_M_S2: RangeInclusive<f64> = -1e3..=1e3;
/// Maximum dated maps of a layer.
pub(super) const MAX_DATED_MAPS: usize = 1000;
/// Maximum keyframes of a camera.
pub(super) const MAX_CAMERA_KEYS: usize = 10_000;
/// Maximum number of elevation files.
pub const MAX_ELEVATION_FILES: usize = 1000;

/// Default of `[time] start` if no satellite has its own time.
pub(super) const DEFAULT_START: &str = "2018-01-15T12:00:00Z";
/// Default of `[output] size`.
pub(super) const DEFAULT_SIZE_PX: [u32; 2] = [1280, 720];
/// Default of `[output] samples` with visible edges: a craft, or a limb without an atmosphere. Otherwise the default is
/// one.
pub const EDGE_SAMPLES: u32 = 4;
/// `[output] samples`: the counts that every adapter supports.
pub(super) const SAMPLES: [u32; 2] = [1, 4];
/// Default of `[earth] tolerance_px`.
pub const DEFAULT_TOLERANCE_PX: f64 = 1.0;

/// `samples` of `[earth.clipmap]`: along an edge of a level.
pub(super) const CLIPMAP_SAMPLES: [i64; 3] = [65, 129, 257];
/// `levels` of `[earth.clipmap]`, in addition to the globe's.
pub(super) const CLIPMAP_LEVELS: RangeInclusive<i64> =
    0..=terrella_ground::globe::clipmap::MAX_LEVELS as i64;
/// `samples` of `[earth.projected_grid]`, horizontally and vertically.
pub(super) const GRID_SAMPLES: RangeInclusive<i64> = 2..=1025;
/// `lambda` of `[earth.quadtree]`: metres of distance per metre of error.
pub(super) const QUADTREE_LAMBDA: RangeInclusive<f64> = 1.0..=1e6;
/// `max_leaves` of `[earth.quadtree]`: up to 1 GB of leaves.
pub(super) const MAX_LEAVES: RangeInclusive<i64> = 512..=1_000_000;

/// Seeds of noise.
pub(super) const SEED: RangeInclusive<i64> = 0..=u32::MAX as i64;

/// Angles with any sign within 360°, degrees.
pub(super) const TURN_DEG: RangeInclusive<f64> = -360.0..=360.0;
/// Geodetic latitude, degrees.
pub(super) const LAT_DEG: RangeInclusive<f64> = -90.0..=90.0;

/// Converts a range in metres to kilometres.
const fn km(metres: RangeInclusive<f64>) -> RangeInclusive<f64> {
    *metres.start() / 1000.0..=*metres.end() / 1000.0
}
/// Longitude east, degrees, before wrapping to −180…180.
pub(super) const LON_DEG: RangeInclusive<f64> = TURN_DEG;
/// Width and height of the image, pixels: the largest texture side guaranteed by desktop adapters.
pub(super) const SIDE_PX: RangeInclusive<i64> = 1..=16_384;

/// Former names of keys, with their current names.
pub(super) const RENAMED: &[(&str, &str)] = &[
    ("node_deg", "raan_deg"),
    ("argument_deg", "argument_of_periapsis_deg"),
];

/// The scope of a key of `[orbit]` for some sources.
pub(super) const fn only(sources: &'static [OrbitSource], why: &'static str) -> Only {
    Only { why, sources }
}

pub(super) const NADIR: &Only = &only(&[], "only for mode = \"nadir\"");
pub(super) const GEODETIC: &Only = &only(&[], "only for mode = \"geodetic\"");
pub(super) const SUNLIT: &Only = &only(&[], "not with look = \"paper\"");
const BALANCED: &Only = &only(&[], "only with white_balance_k");
const GRAINED: &Only = &only(&[], "only with grain");
pub(super) const PACK: &Only = &only(&[], "only for scenes with a pack");
pub(super) const SCREEN: &Only = &only(&[], "not with look = \"paper\"");
pub(super) const RELIEF: &Only = &only(&[], "only for terrain");
pub(super) const CLIPMAP: &Only = &only(&[], "for surface = \"clipmap\"");
pub(super) const CONTOURS: &Only = &only(&[], "for surface = \"contours\"");
pub(super) const PROJECTED_GRID: &Only = &only(&[], "for surface = \"projected-grid\"");
pub(super) const QUADTREE: &Only = &only(&[], "for surface = \"quadtree\"");

table!(RawTime = "time" {
    // Any value: both a string and TOML's own date-time are read.
    /// UTC instant of the first frame. By default the satellite's own time; 2018-01-15T12:00:00Z where it has none.
    start: toml::Value, of "a UTC instant like \"2018-01-15T12:00:00Z\", or \"now\"";
    /// Simulated time that is played. Where the scene does not give it, it is shortened to the time for which the satellite is known.
    duration_s: f64, of "simulated seconds", in f64::MIN_POSITIVE..=1e9, default 5580.0;
    /// Simulated seconds per second of playback. Negative plays backwards; 0 is rejected.
    speed: f64, of "simulated seconds per second", in -1e6..=1e6, default 60.0;
    /// Frames per second of playback.
    frame_rate_hz: f64, of "frames per second", in 1.0..=240.0, default 30.0;
    /// Table of the Earth's orientation by date. By default UT1 is taken as UTC and polar motion as none.
    orientation: RawPath, of "a file like finals2000A.all";
});

/// A table or a list of tables: `[orbit]`, or one `[[orbit]]` per satellite.
#[derive(Debug)]
pub(super) struct OneOrMore<T>(pub(super) Vec<T>);

impl<T> Default for OneOrMore<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for OneOrMore<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TableOrList<T>(PhantomData<T>);

        // An untagged enum would lose the spans of keys and values.
        impl<'de, T: Deserialize<'de>> Visitor<'de> for TableOrList<T> {
            type Value = OneOrMore<T>;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a table or a list of tables")
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
                T::deserialize(MapAccessDeserializer::new(map)).map(|one| OneOrMore(vec![one]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
                let mut all = Vec::new();
                while let Some(one) = list.next_element()? {
                    all.push(one);
                }
                Ok(OneOrMore(all))
            }
        }

        deserializer.deserialize_any(TableOrList(PhantomData))
    }
}

table!(RawCamera = "camera" {
    /// Where the eye looks from. By default "nadir"; "geodetic" where a place or its direction of view is given.
    mode: Choice<CameraMode>;
    /// What is upwards on screen.
    up: Choice<CameraUp>, default CameraUp::default(), for NADIR;
    /// The satellite that cameras fly with. By default the first.
    follow: String, of "a string, the name of one of the scene's satellites";
    // A thousandth of a degree away from no view at all and from a half space, where a perspective projection has no meaning.
    /// Vertical field of view.
    fov_deg: f64, of "degrees", in 0.001..=179.999, default 45.0;
    /// Geodetic latitude, south negative.
    lat_deg: f64, of "degrees", in LAT_DEG, default 0.0, for GEODETIC;
    /// Longitude, west negative.
    lon_deg: f64, of "degrees", in LON_DEG, default 0.0, for GEODETIC;
    /// Height above the ellipsoid.
    height_km: f64, of "kilometres", in 0.001..=1e9, default 20_000.0, for GEODETIC;
    /// Direction in which the eye looks, clockwise from north; straight down it is what is upwards on screen.
    heading_deg: f64, of "degrees", in TURN_DEG, default 0.0, for GEODETIC;
    /// How far above the horizontal the eye looks; -90 is straight down.
    pitch_deg: f64, of "degrees", in -90.0..=90.0, default -90.0, for GEODETIC;
    // A word, a name or a table.
    /// What the camera keeps in the middle of the picture; "satellite" is the one that it follows. By default the mode gives the direction of view.
    look_at: RawLookAt;
    /// Turn of the camera about its direction of view; positive values turn it clockwise.
    roll_deg: f64, of "degrees", in TURN_DEG, default 0.0;
    // A list of tables of any keys.
    /// What the camera does at moments of the flight. By default nothing.
    keys: Vec<RawCameraKey>, of "a list of tables: write [[camera.keys]] on a line of its own for each, and below it time_s and what is set there";
});

table!(RawEarth = "earth" {
    /// Which effects are on where their own keys are left out.
    look: Choice<Look>, default Look::default();
    /// Whether a missing map rejects the scene; else the map is left out.
    strict: bool, default false;
    /// The Earth's figure: the ellipsoid, or a sphere of 6378.164 km.
    figure: Choice<Figure>, default Figure::default();
    // Any value: a number or a word.
    /// Cells per block edge. By default "auto": as many as the limb needs.
    subdivision: toml::Value, of "\"auto\" or a whole number from 1 to 48", in 1..=48;
    /// Deprecated: look = "paper" chooses it. Which blocks are drawn. By default "conservative"; "paper" with look = "paper" and no terrain.
    visibility: Choice<Visibility>;
    /// Deprecated: look = "paper" chooses it. How the surface is shaded. By default "sunlit"; "paper" with look = "paper".
    shading: Choice<Shading>;
    /// Whether clouds are drawn.
    clouds: bool, default true;
    /// Whether the terrain's normals shade the ground.
    normals: bool, default true;
    /// Whether city lights are drawn. By default on; off with look = "paper".
    night_lights: bool;
    /// How the air is drawn.
    atmosphere: Choice<Atmosphere>, default Atmosphere::default();
    /// Vertical optical depth of the air's haze at 550 nm; 0 is clear air. By default 0.1; 0 with look = "paper".
    aerosol_optical_depth: f64, in 0.0..=AirOptions::MAX_AEROSOL;
    /// Wind that roughens the sea.
    wind_m_s: f64, of "metres a second", in SurfaceLight::WIND_M_S, default SurfaceLight::DEFAULT.wind_m_s, for SUNLIT;
    /// How many times too steep slopes are lit; 1 is true.
    relief_exaggeration: f64, in SurfaceLight::RELIEF_EXAGGERATION, default SurfaceLight::DEFAULT.relief_exaggeration, for SUNLIT;
    /// Height of the cloud layer.
    cloud_height_km: f64, of "kilometres", in km(SurfaceLight::CLOUD_HEIGHT_M), default SurfaceLight::DEFAULT.cloud_height_m / 1000.0, for SUNLIT;
    /// How far the tops of thick clouds rise over thin ones.
    cloud_relief_km: f64, of "kilometres", in km(SurfaceLight::CLOUD_RELIEF_M), default SurfaceLight::DEFAULT.cloud_relief_m / 1000.0, for SUNLIT;
    /// Whether clouds throw shadows. By default with look = "full".
    cloud_shadows: bool, for SUNLIT;
    /// Whether detail smaller than the maps' texels is made up. By default on; off with look = "paper".
    detail: bool, for SUNLIT;
    /// Whether land and clouds reflect more light to some sides than to others. By default on; off with look = "paper".
    directional_reflectance: bool, for SUNLIT;
    /// Whether the Moon lights the Earth, by its phase. By default with look = "full".
    moonlight: bool, for SUNLIT;
    /// Whether the air glows by itself at night. By default with look = "full".
    airglow: bool, for SUNLIT;
    /// Planetary index of geomagnetic activity Kp: where the aurora is at night, and how bright. By default there is no aurora.
    kp: f64, in SurfaceLight::KP, for SUNLIT;
    /// How many times brighter than in truth the lights of the night are: cities, moonlight, airglow and aurora. By default 150000; with
    /// moonlight 40000 under a full Moon, and without an aurora up to 400000 where the Moon is new or down. Without the key they fade where sunlit
    /// ground or air is in view.
    night_gain: f64, in SurfaceLight::NIGHT_GAIN, for SUNLIT;
    /// Folder of the maps. By default the starter pack.
    textures: RawPath, of "a folder of maps";
    /// Folder of an imagery pack, in place of maps. By default none.
    pack: RawPath, of "an imagery pack's folder";
    // Lists, checked by dated_maps.rs.
    /// Day maps that change with the date. By default none.
    day_maps: RawDatedMaps, of "a list of maps with their dates, or of twelve files, from January on", for SUNLIT;
    /// Cloud maps that change with the date. By default none.
    cloud_maps: RawDatedMaps, of "a list of maps with their dates, or of twelve files, from January on", for SUNLIT;
    /// Maps of city lights that change with the date. By default none.
    night_light_maps: RawDatedMaps, of "a list of maps with their dates, or of twelve files, from January on", for SUNLIT;
    /// Whether maps that change with the date pass into each other.
    map_fade: bool, default true, for SUNLIT;
    /// Whether snow on land and ice on the sea are those of the time of year, where the folder has seasons.png. By default on; off with
    /// look = "paper", with a pack, with day maps of their own dates, with terrain, and without water.
    seasons: bool, for SUNLIT;
    /// Whether open water is drawn as such, where the maps have it. By default on; off with look = "paper".
    water: bool;
    /// Deprecated: look = "paper" chooses it. How the level of a block's tiles is chosen. By default "screen"; "paper" with look = "paper".
    levels: Choice<LevelRule>, for PACK;
    /// Most screen pixels that a texel of a tile may cover.
    texel_px: f64, of "screen pixels", in 0.25..=16.0, default 1.0, for SCREEN;
    /// Which of the pack's storages is read; "auto" takes what the adapter draws fastest.
    storage: Choice<StorageChoice>, default StorageChoice::default(), for PACK;
    /// Memory for the textures of maps and tiles (10⁶ bytes).
    texture_mb: f64, of "megabytes", in 1.0..=1e6, default 512.0, for PACK;
    /// Tiles that are uploaded in one frame (10⁶ bytes).
    upload_mb: f64, of "megabytes", in 0.01..=1e4, default 4.0, for PACK;
    /// What draws the ground. By default "quadtree" where heights are given, else "blocks".
    surface: Choice<SurfaceKind>;
    /// Files of heights, folders of them, and patterns such as dem/*.tif. The finest lies on top. An empty list takes the starter pack's heights, or none with pack_heights. By default the smooth ellipsoid is drawn.
    elevation: Vec<Spanned<RawPath>>, of "a list of strings, the paths of files or folders of heights";
    /// Whether the pack's heights are the ground, beneath the files of elevation.
    pack_heights: bool, default false, for PACK;
    /// Memory for the pack's heights (10⁶ bytes), with pack_heights.
    ground_mb: f64, of "megabytes", in 1.0..=1e6, default 256.0, for PACK;
    /// Most pixels by which the drawn ground may differ from its heights.
    tolerance_px: f64, of "pixels", in 0.0..=1000.0, default DEFAULT_TOLERANCE_PX, for RELIEF;
    /// Whether the sea's floor is drawn, and not its surface.
    sea_floor: bool, default false, for RELIEF;
    // Any value: tables within the table, whose keys are read in `surfaces`.
    /// Settings of surface = "clipmap".
    clipmap: toml::Value, of "a table like { samples = 129, levels = 12, trimming = \"diamond\" }", for CLIPMAP;
    /// Settings of surface = "contours".
    contours: toml::Value, of "a table like { drawn = \"patches\" }", for CONTOURS;
    /// Settings of surface = "projected-grid".
    projected_grid: toml::Value, of "a table like { samples = [129, 129], on_gpu = true }", for PROJECTED_GRID;
    /// Settings of surface = "quadtree".
    quadtree: toml::Value, of "a table like { lambda = 300, culling = true, max_leaves = 24000 }", for QUADTREE;
    /// Whether single wrong heights are taken out of the files.
    denoise: bool, default false, for RELIEF;
});

table!(RawSky = "sky" {
    /// The stars of the Hipparcos catalogue to magnitude 6.5. By default on; off with look = "paper".
    stars: bool;
    /// The light of the stars too faint for that. By default with look = "full".
    milky_way: bool;
    /// The Sun's disc. By default on; off with look = "paper".
    sun: bool;
    /// The Moon. By default on; off with look = "paper".
    moon: bool;
    /// The light of the Sun that a lens scatters about it. By default with look = "full".
    glare: bool;
    /// The Moon's shadow on ground, clouds and air. By default on; off with look = "paper".
    eclipses: bool;
    /// How many times brighter than in truth stars and Milky Way are drawn. Without the key up to 400000 where the Moon is new or down, and they
    /// fade where sunlit ground or air is in view.
    star_gain: f64, in 0.0..=1e6, default 4e4;
    /// Folder of stars.bin, milky_way.jpg and moon.jpg. By default the starter pack.
    folder: RawPath, of "a folder of star catalogue and maps";
});

table!(RawOutput = "output" {
    // A list of any length, so that a wrong length gets our own message.
    /// Width and height of pictures. By default [1280, 720]; with a sensor, its size.
    size: Vec<i64>, of "[width, height], two whole numbers of pixels", in SIDE_PX;
    /// Samples per pixel. By default 4 with mode = "chase", with a model or without air, else 1.
    samples: i64, of "1 or 4";
    // Any value: a number or a word.
    /// Exposure: light is multiplied by 2 to the power of it before it is shown; "auto" meters each picture. By default 0.5.
    exposure_ev: toml::Value, of "a number of exposure values from −20 to 20 or \"auto\"";
    /// The curve by which exposed light is shown: one by name, or the measured response of a film or camera, which is not for look = "paper". By
    /// default "camera"; "neutral" with look = "paper".
    tone: RawTone;
    /// The part of all light that the lens scatters about what is bright. By default 0.03 with look = "full", else 0.
    bloom: f64, in Bloom::STRENGTH, for SUNLIT;
    /// Colour temperature of the light that is shown white. By default colours are as they are; sunlight in space is close to 6000.
    white_balance_k: f64, of "kelvins", in WhiteBalance::TEMPERATURES_K, for SUNLIT;
    /// How much greener than a black body of white_balance_k that light is, in 1/3000 of the CIE 1960 UCS diagram; positive numbers make
    /// pictures more magenta.
    tint: f64, in WhiteBalance::TINTS, default 0.0, for BALANCED;
    /// Film grain: standard deviation of pixel values in the middle of the scale, as a part of the scale.
    grain: f64, in Grain::STRENGTHS, default 0.0, for SUNLIT;
    /// Distance of grains.
    grain_size_px: f64, of "pixels", in Grain::SIZES_PX, default Grain::USUAL_SIZE_PX, for GRAINED;
    /// Seed of the pattern of grains.
    grain_seed: i64, of "a whole number from 0 to 4294967295", in SEED, default 0, for GRAINED;
    /// How long a picture that is kept waits for its tiles and its simulator.
    wait_s: f64, of "seconds", in 0.0..=3600.0, default 30.0;
});

table!(RawQuality = "quality" {
    /// Most time that a frame may cost before quality is reduced, in the window. By default quality is not reduced.
    target_ms: f64, of "milliseconds", in 1.0..=1000.0;
    /// Part of width and height that is drawn and then enlarged, in the window and in pictures.
    scale: f64, in 0.25..=1.0, default 1.0;
    /// The steps of quality. By default those that were recorded for the adapter.
    ladder: RawPath, of "a ladder.csv that `terrella report --quality` wrote";
});

/// A scene file.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct RawScene {
    pub(super) time: RawTime,
    pub(super) orbit: OneOrMore<RawOrbit>,
    pub(super) tracks: RawTracks,
    pub(super) station: OneOrMore<RawStation>,
    pub(super) layers: RawLayers,
    pub(super) geojson: OneOrMore<RawGeojson>,
    pub(super) coverage: RawCoverage,
    pub(super) camera: RawCamera,
    pub(super) sensor: RawSensor,
    pub(super) earth: RawEarth,
    pub(super) sky: RawSky,
    pub(super) lens: RawLens,
    pub(super) caption: OneOrMore<RawCaption>,
    pub(super) output: RawOutput,
    pub(super) quality: RawQuality,
}

/// All tables and keys, in the recommended order of a scene.
pub(super) const TABLES: &[Table] = &[
    RawTime::TABLE,
    RawOrbit::TABLE,
    RawTracks::TABLE,
    RawStation::TABLE,
    RawLayers::TABLE,
    RawGeojson::TABLE,
    RawCoverage::TABLE,
    RawCamera::TABLE,
    RawSensor::TABLE,
    RawEarth::TABLE,
    RawSky::TABLE,
    RawLens::TABLE,
    RawCaption::TABLE,
    RawOutput::TABLE,
    RawQuality::TABLE,
];
