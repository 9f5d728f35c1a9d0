//! Declares the scene keys, each once: its name, the type of its value, the numbers that it may be, and what it is where a
//! scene leaves it out. The declaration makes the key's field in the table as written and a method of the same name that
//! hands its rule to the checks, so that neither can differ from what is written here.

use super::field::{Bounds, Field, RawPath};
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use terrella_ground::air::AirOptions;
use terrella_orbit::live::{LiveOptions, Transport};
use terrella_orbit::numerical::Spacecraft;
use toml::Spanned;

/// First and last year (UTC) that a scene may reach: those of [`utc_from_rfc3339`](terrella::frames::utc_from_rfc3339).
pub(crate) const YEARS: RangeInclusive<i32> = 1900..=2099;
/// Most frames in one playback (at 30 per second, almost four days).
pub(super) const MAX_FRAMES: f64 = 1e7;
/// Most satellites, `[[orbit]]` tables, in one scene.
pub(super) const MAX_ORBITS: usize = 1000;
/// Most satellites of one scene whose states simulators send: each has threads and a port of its own.
pub(super) const MAX_LIVE_ORBITS: usize = 64;
/// Most web pages that may connect to a simulator's port.
pub(super) const MAX_ORIGINS: usize = 16;
/// Most burns of one satellite.
pub(super) const MAX_BURNS: usize = 1000;
/// Length of a burn, seconds: at most a year.
pub(super) const BURN_S: RangeInclusive<f64> = 1e-3..=3.2e7;
/// Each part of a burn's acceleration, m/s².
pub(super) const BURN_M_S2: RangeInclusive<f64> = -1e3..=1e3;
/// Most maps of a layer that change with the date.
pub(super) const MAX_DATED_MAPS: usize = 1000;
/// Most keys of a camera.
pub(super) const MAX_CAMERA_KEYS: usize = 10_000;
/// Most files of heights.
pub(super) const MAX_ELEVATION_FILES: usize = 1000;

/// `[time] start` where a scene gives none and no satellite has a time of its own.
pub(super) const DEFAULT_START: &str = "2018-01-15T12:00:00Z";
/// `[output] size` where a scene gives none.
pub(super) const DEFAULT_SIZE_PX: [u32; 2] = [1280, 720];
/// `[output] samples` where a scene gives none and there are edges to be seen: a craft's, or a limb without air. Else one.
pub const EDGE_SAMPLES: u32 = 4;
/// `[output] samples`: the counts that every adapter can do.
pub(super) const SAMPLES: [u32; 2] = [1, 4];
/// `[earth] tolerance_px` where a scene gives none.
pub const DEFAULT_TOLERANCE_PX: f64 = 1.0;

/// `before_min` and `after_min` of a trail or ground track, minutes: at most a week.
pub(super) const SPAN_MIN: RangeInclusive<f64> = 0.0..=10_080.0;
/// `samples` of `[earth.clipmap]`: along an edge of a level.
pub(super) const CLIPMAP_SAMPLES: [i64; 3] = [65, 129, 257];
/// `levels` of `[earth.clipmap]`, besides the globe's.
pub(super) const CLIPMAP_LEVELS: RangeInclusive<i64> =
    0..=terrella_ground::globe::clipmap::MAX_LEVELS as i64;
/// `samples` of `[earth.projected_grid]`, across and down.
pub(super) const GRID_SAMPLES: RangeInclusive<i64> = 2..=1025;
/// `lambda` of `[earth.quadtree]`: metres of distance for a metre of error.
pub(super) const QUADTREE_LAMBDA: RangeInclusive<f64> = 1.0..=1e6;
/// `max_leaves` of `[earth.quadtree]`: up to 1 GB of them.
pub(super) const MAX_LEAVES: RangeInclusive<i64> = 512..=1_000_000;

/// Sizes of orbits, positions and their parts, kilometres: a thousand times the distance of the Sun.
const ORBIT_KM: RangeInclusive<f64> = -1e11..=1e11;
/// Angles that may be given as any turn, degrees.
const TURN_DEG: RangeInclusive<f64> = -360.0..=360.0;
/// Geodetic latitude, degrees.
pub(super) const LAT_DEG: RangeInclusive<f64> = -90.0..=90.0;
/// Longitude east, degrees, before it is brought to −180…180.
pub(super) const LON_DEG: RangeInclusive<f64> = TURN_DEG;
/// Width and height of the picture, pixels: the largest texture side that desktop adapters promise.
pub(super) const SIDE_PX: RangeInclusive<i64> = 1..=16_384;

/// Keys by other names that scenes once had, with those that they have now.
pub(super) const RENAMED: &[(&str, &str)] = &[
    ("node_deg", "raan_deg"),
    ("argument_deg", "argument_of_periapsis_deg"),
];

/// Maps with their dates, whose files are paths; checked by dated_maps.rs.
#[derive(Debug, Deserialize)]
#[serde(transparent)]
pub(super) struct RawDatedMaps(pub(super) toml::Value);

/// A key that a table knows.
#[derive(Debug)]
pub(super) struct Key {
    pub(super) name: &'static str,
    /// What its value must be, to be read after "must be".
    pub(super) expected: &'static str,
    /// Whether it names files or folders.
    #[cfg(test)]
    pub(super) is_path: bool,
}

/// A table that a scene knows.
#[derive(Debug)]
pub(super) struct Table {
    pub(super) name: &'static str,
    pub(super) keys: &'static [Key],
}

impl Table {
    /// Whether a scene may have several of it.
    pub(super) fn is_list(&self) -> bool {
        self.name == RawOrbit::TABLE.name
    }
}

/// Types of values with numbers in them.
pub(super) trait Numeric {
    /// The type of the numbers.
    type Number;
}

macro_rules! numeric {
    ($($kind:ty: $number:ty,)*) => { $(impl Numeric for $kind { type Number = $number; })* };
}

numeric! { f64: f64, i64: i64, Vec<f64>: f64, Vec<i64>: i64, toml::Value: i64, }

/// Whether values of a type name files or folders.
#[cfg(test)]
pub(super) trait NamesFiles {
    const NAMES_FILES: bool;
}

#[cfg(test)]
macro_rules! names_files {
    ($($kind:ty: $names_files:literal,)*) => { $(impl NamesFiles for $kind { const NAMES_FILES: bool = $names_files; })* };
}

#[cfg(test)]
names_files! {
    RawPath: true, Vec<Spanned<RawPath>>: true, RawDatedMaps: true,
    bool: false, f64: false, i64: false, String: false, toml::Value: false,
    Vec<f64>: false, Vec<i64>: false, Vec<String>: false, Vec<RawCameraKey>: false,
}

/// The method of a key, with as much of a rule as its declaration has.
macro_rules! method {
    ($(#[$doc:meta])+ $key:ident: $kind:ty) => {
        method! { @ $(#[$doc])+ $key: $kind, (), () }
    };
    ($(#[$doc:meta])+ $key:ident: $kind:ty, in $range:expr) => {
        method! { @ $(#[$doc])+ $key: $kind, RangeInclusive<<$kind as Numeric>::Number>, $range }
    };
    ($(#[$doc:meta])+ $key:ident: $kind:ty, in $range:expr, default $default:expr) => {
        method! { @ $(#[$doc])+ $key: $kind, Bounds<<$kind as Numeric>::Number>, Bounds { range: $range, default: $default } }
    };
    ($(#[$doc:meta])+ $key:ident: $kind:ty, default $default:expr) => {
        method! { @ $(#[$doc])+ $key: $kind, $kind, $default }
    };
    (@ $(#[$doc:meta])+ $key:ident: $kind:ty, $rule:ty, $value:expr) => {
        $(#[$doc])+
        pub(super) fn $key(&self) -> Field<'_, $kind, $rule> {
            Field {
                table: Self::TABLE.name,
                key: stringify!($key),
                given: self.$key.as_ref(),
                rule: $value,
            }
        }
    };
}

/// A table from its keys: `key: type = "what it must be", in its range, default its default;`.
macro_rules! table {
    ($name:ident = $table:literal {
        $($(#[$doc:meta])+ $key:ident: $kind:ty = $expected:literal $(, in $range:expr)? $(, default $default:expr)?;)*
    }) => {
        #[derive(Debug, Default, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(super) struct $name {
            $($(#[$doc])+ $key: Option<Spanned<$kind>>,)*
        }

        impl $name {
            pub(super) const TABLE: Table = Table {
                name: $table,
                keys: &[$(Key {
                    name: stringify!($key),
                    expected: $expected,
                    #[cfg(test)]
                    is_path: <$kind as NamesFiles>::NAMES_FILES,
                }),*],
            };

            /// The keys that the file gives, with the span of their values.
            pub(super) fn given(&self) -> Vec<(&'static str, Range<usize>)> {
                let mut given = Vec::new();
                $(given.extend(self.$key.as_ref().map(|value| (stringify!($key), value.span())));)*
                given
            }

            $(method! { $(#[$doc])+ $key: $kind $(, in $range)? $(, default $default)? })*
        }
    };
}

/// A table with the keys of tracks between its own: `[tracks]` has them for all satellites, `[orbit]` for one.
macro_rules! table_with_tracks {
    ($name:ident = $table:literal { $($before:tt)* } { $($after:tt)* }) => {
        table!($name = $table {
            $($before)*
            // Any value: true, false or a table.
            /// The orbit, drawn over a time.
            trail: toml::Value = "true, false or { before_min = 90, after_min = 45 }";
            /// Where the satellite passes overhead, drawn over a time.
            ground_track: toml::Value = "true, false or { before_min = 90, after_min = 45 }";
            /// A dot where the satellite is, with its name.
            marker: bool = "true or false", default false;
            /// A ring where it is overhead.
            subpoint: bool = "true or false", default false;
            /// The outline of the ground that its sensor sees; drawn also where an angle is given.
            footprint: bool = "true or false";
            /// Half angle of the sensor's cone about straight down; without it all the ground in sight is seen.
            sensor_half_angle_deg: f64 = "a number of degrees", in 0.001..=90.0;
            /// Whether the footprint is tinted.
            footprint_fill: bool = "true or false", default false;
            $($after)*
        });
    };
}

table!(RawTime = "time" {
    // Any value: both a string and TOML's own date-time are read.
    /// UTC instant of the first frame; by default the satellite's own time, [`DEFAULT_START`] where it has none.
    start: toml::Value = "a UTC instant like \"2018-01-15T12:00:00Z\", or \"now\"";
    /// Simulated seconds that are played, about 32 years at most; by default a revolution of the space station.
    duration_s: f64 = "a number of simulated seconds", in f64::MIN_POSITIVE..=1e9, default 5580.0;
    /// Simulated seconds per second of playback; negative plays backwards, never 0.
    speed: f64 = "a number of simulated seconds per second", in -1e6..=1e6, default 60.0;
    /// Frames per second of playback.
    frame_rate_hz: f64 = "a number of frames per second", in 1.0..=240.0, default 30.0;
    /// Table of the Earth's orientation by date; without it UT1 is taken as UTC and polar motion as none.
    orientation: RawPath = "a string, the path of a file like finals2000A.all";
});

table_with_tracks!(RawOrbit = "orbit" {
    /// The kind of source, [`OrbitSource`](super::OrbitSource): "tle" by default.
    source: String = "a string, the kind of source: \"tle\", \"omm\", \"oem\", \"czml\", \"csv\", \"kepler\", \"numerical\", \"live\" or \"basilisk\"";
    /// The file of a source that is one; without it "tle" flies the built-in space station, and "basilisk" meets a simulation
    /// that runs.
    file: RawPath = "a string, the path of a file of elements or states";
    /// Which satellite of the file; without a file, what it is called.
    name: String = "a string, the satellite's name";
    /// Whether one bad record refuses the file.
    strict: bool = "true or false", default false;
    // Any value: both a string and TOML's own date-time are read.
    /// When the start of a motion holds; the start of the scene by default.
    epoch: toml::Value = "a UTC instant like \"2018-01-15T12:00:00Z\"";
    /// The axes that the start is given in, "gcrf" by default.
    frame: String = "a string: \"teme\", \"pef\", \"itrf\", \"gcrf\" or \"eme2000\"";
    /// Semi-major axis; below 0 for hyperbolas.
    semi_major_axis_km: f64 = "a number of kilometres", in ORBIT_KM;
    /// Distance of the periapsis from the Earth's centre, in place of the semi-major axis.
    periapsis_km: f64 = "a number of kilometres", in 0.001..=*ORBIT_KM.end();
    /// Eccentricity: 0 a circle, 1 a parabola.
    eccentricity: f64 = "a number", in 0.0..=1e6, default 0.0;
    /// Inclination.
    inclination_deg: f64 = "a number of degrees", in 0.0..=180.0, default 0.0;
    /// Right ascension of the ascending node (RAAN).
    raan_deg: f64 = "a number of degrees", in TURN_DEG, default 0.0;
    /// Argument of periapsis.
    argument_of_periapsis_deg: f64 = "a number of degrees", in TURN_DEG, default 0.0;
    /// True anomaly at the epoch.
    true_anomaly_deg: f64 = "a number of degrees", in TURN_DEG, default 0.0;
    /// Mean anomaly at the epoch, in place of the true one.
    mean_anomaly_deg: f64 = "a number of degrees", in TURN_DEG, default 0.0;
    // Lists of any length, so that a wrong length gets our own message.
    /// Position of a start that is given as a state vector, from the Earth's centre.
    position_km: Vec<f64> = "[x, y, z], three numbers of kilometres", in ORBIT_KM;
    /// Its velocity, as seen in the frame.
    velocity_km_s: Vec<f64> = "[x, y, z], three numbers of kilometres per second", in -5000.0..=5000.0;
    /// Source "kepler": whether node and periapsis drift by the Earth's flattening.
    j2: bool = "true or false", default false;
    /// Source "numerical": degree of the Earth's gravity; 0 is a point, 1 would be the same. By default all there is.
    gravity_degree: i64 = "a whole number from 0 to 20", in 0..=20, default 20;
    /// Its order, the degree by default; 0 leaves the zonal terms alone.
    gravity_order: i64 = "a whole number from 0 to gravity_degree";
    /// Whether the air's drag acts.
    drag: bool = "true or false", default true;
    /// The air's density by height, "us1976" by default.
    air_model: String = "a string: \"us1976\" or \"exponential\"";
    /// Whether the Sun's gravity acts.
    sun: bool = "true or false", default true;
    /// Whether the Moon's gravity acts.
    moon: bool = "true or false", default true;
    /// Whether the pressure of sunlight acts.
    radiation: bool = "true or false", default true;
    /// Mass of the satellite.
    mass_kg: f64 = "a number of kilograms", in 1e-6..=1e9, default Spacecraft::default().mass_kg;
    /// Area against air and sunlight.
    area_m2: f64 = "a number of square metres", in 0.0..=1e9, default Spacecraft::default().drag_area_m2;
    /// Drag coefficient.
    cd: f64 = "a number", in 0.0..=100.0, default Spacecraft::default().drag_coefficient;
    /// Coefficient of reflectivity: 1 where light is taken up, 2 where it is thrown back.
    cr: f64 = "a number", in 0.0..=100.0, default Spacecraft::default().reflectivity;
    /// Error allowed in a step of the integration, relative to distance and speed; by default millimetres a revolution.
    tolerance: f64 = "a number", in 1e-14..=1e-3, default 1e-10;
    /// How it is integrated, "automatic" by default.
    method: String = "a string: \"automatic\", \"explicit\" or \"implicit\"";
    // A list of tables, checked by burns.rs.
    /// Thrusts, each over its own time.
    burns: toml::Value = "a list like [{ start = \"2018-01-15T12:30:00Z\", duration_s = 60, acceleration_m_s2 = [0.05, 0, 0], axes = \"flight\" }]";
    // A list of any length.
    /// Which events are looked for besides the impact; none by default.
    events: Vec<String> = "a list of \"nodes\", \"apsides\" and \"eclipses\"";
    /// Sources "live" and "basilisk": where the simulator is met; of the latter port 5556 of this machine by default.
    listen: String = "a string: \"stdin\", or \"tcp://\", \"udp://\" or \"ws://\" with an IP address and a port";
    /// Source "basilisk": where a simulation publishes its steps, in place of listening.
    subscribe: String = "a string: \"tcp://\" with an IP address and a port";
    /// Whether the port may be one that other machines reach.
    allow_remote: bool = "true or false", default false;
    // A list of any length.
    /// Web pages whose scripts may connect.
    allowed_origins: Vec<String> = "a list of strings, web pages like \"https://example.org\"";
    /// Whether the simulator waits for its pictures, "broadcast" by default.
    pacing: String = "a string: \"broadcast\" or \"lockstep\"";
    /// Simulated seconds in a second of a simulator that nobody waits for.
    rate: f64 = "a number of simulated seconds per second", in LiveOptions::RATES, default usual_live().rate;
    /// How far pictures are behind such a simulator.
    playback_delay_s: f64 = "a number of seconds", in LiveOptions::PLAYBACK_DELAYS_S, default usual_live().playback_delay_s;
    /// How long a simulator waits for its picture.
    timeout_s: f64 = "a number of seconds", in LiveOptions::FRAME_TIMEOUTS_S, default usual_live().frame_timeout.as_secs_f64();
    /// Age of the last state from which on the simulator is reported as silent.
    stale_after_s: f64 = "a number of seconds", in LiveOptions::STALE_AGES_S, default usual_live().stale_after_s;
    /// How far a satellite goes on beyond its simulator's last state.
    extrapolate_s: f64 = "a number of simulated seconds", in LiveOptions::EXTRAPOLATION_LIMITS_S, default usual_live().extrapolation_limit_s;
    /// How it goes on there, "two-body" by default.
    extrapolation: String = "a string: \"two-body\" or \"linear\"";
    /// How far apart two states are a jump.
    gap_s: f64 = "a number of simulated seconds", in LiveOptions::GAPS_S, default usual_live().gap_s;
    /// Packets that the simulator may send in a second.
    packets_per_s: i64 = "a whole number of packets per second", in LiveOptions::PACKET_RATES_PER_S, default i64::from(usual_live().max_packets_per_s);
    /// Colour of all that is drawn of the satellite; by default one of the usual ones, by its place in the scene.
    color: String = "a string, \"#\" and six hexadecimal digits";
} {});

/// The settings that a live feed has where a scene says nothing; the transport is always said.
fn usual_live() -> LiveOptions {
    LiveOptions::new(Transport::Stdin)
}

table_with_tracks!(RawTracks = "tracks" {} {
    /// Width of all lines.
    width_px: f64 = "a number of pixels", in 0.5..=16.0, default 2.0;
});

/// `[orbit]`, or `[[orbit]]` as often as there are satellites.
#[derive(Debug)]
pub(super) struct RawOrbits(pub(super) Vec<RawOrbit>);

impl<'de> Deserialize<'de> for RawOrbits {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrMore;

        // An untagged enum would lose the places of keys and values.
        impl<'de> Visitor<'de> for OneOrMore {
            type Value = RawOrbits;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a table or a list of tables")
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<RawOrbits, A::Error> {
                RawOrbit::deserialize(MapAccessDeserializer::new(map))
                    .map(|orbit| RawOrbits(vec![orbit]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<RawOrbits, A::Error> {
                let mut orbits = Vec::new();
                while let Some(orbit) = list.next_element()? {
                    orbits.push(orbit);
                }
                Ok(RawOrbits(orbits))
            }
        }

        deserializer.deserialize_any(OneOrMore)
    }
}

/// One of `[[camera.keys]]`, checked by camera_keys.rs.
pub(super) type RawCameraKey = BTreeMap<String, Spanned<toml::Value>>;

table!(RawCamera = "camera" {
    /// Where the eye looks from: "nadir" by default, "geodetic" where a place is given.
    mode: String = "a string: \"nadir\", \"horizon\", \"chase\" or \"geodetic\"";
    /// Nadir mode: what is upwards on screen, "flight" by default.
    up: String = "a string: \"flight\" or \"north\"";
    /// The satellite that cameras fly with, the first by default.
    follow: String = "a string, the name of one of the scene's satellites";
    /// Vertical field of view: a thousandth of a degree away from no view at all and from a half space, where a perspective
    /// projection has no meaning.
    fov_deg: f64 = "a number of degrees", in 0.001..=179.999, default 45.0;
    /// Geodetic mode: latitude.
    lat_deg: f64 = "a number of degrees", in LAT_DEG, default 0.0;
    /// Geodetic mode: longitude east.
    lon_deg: f64 = "a number of degrees", in LON_DEG, default 0.0;
    /// Geodetic mode: height above the ellipsoid, from one metre to seven times the distance of the Sun; by default the whole
    /// disc is in view.
    height_km: f64 = "a number of kilometres", in 0.001..=1e9, default 20_000.0;
    /// Geodetic mode: where the eye looks to, clockwise from north.
    heading_deg: f64 = "a number of degrees", in TURN_DEG, default 0.0;
    /// Geodetic mode: how far above the horizontal it looks; by default straight down.
    pitch_deg: f64 = "a number of degrees", in -90.0..=90.0, default -90.0;
    // A list of tables of any keys.
    /// What the camera does at moments of the flight.
    keys: Vec<RawCameraKey> = "a list of tables: write [[camera.keys]] on a line of its own for each, and below it time_s and what is set there";
});

table!(RawEarth = "earth" {
    /// Which effects are on where their own keys say nothing, "standard" by default.
    look: String = "a string: \"paper\", \"standard\" or \"full\"";
    /// Whether a map that is not there refuses the scene; else it is left out.
    strict: bool = "true or false", default false;
    /// The Earth's figure, "wgs84" by default.
    figure: String = "a string: \"wgs84\" or \"sphere\"";
    // Any value: a number or a word.
    /// Cells per block edge, "auto" by default.
    subdivision: toml::Value = "\"auto\" or a whole number from 1 to 48", in 1..=48;
    /// Which blocks are drawn, "conservative" by default.
    visibility: String = "a string: \"conservative\" or \"paper\"";
    /// How the surface is shaded, "sunlit" by default and "paper" with look = "paper".
    shading: String = "a string: \"sunlit\" or \"paper\"";
    /// The cloud layer.
    clouds: bool = "true or false", default true;
    /// Normals of the terrain.
    normals: bool = "true or false", default true;
    /// City lights, on by default with shading = "sunlit".
    night_lights: bool = "true or false";
    /// The air, "billboard" by default.
    atmosphere: String = "a string: \"billboard\" or \"none\"";
    /// Optical depth of the haze that the air holds, straight up and at 550 nm: 0 is clear air; by default that with look =
    /// "paper", else 0.1.
    aerosol_optical_depth: f64 = "a number", in 0.0..=AirOptions::MAX_AEROSOL;
    /// Wind over the sea, which roughens it.
    wind_m_s: f64 = "a number of metres a second", in 0.0..=30.0, default 7.0;
    /// How many times too steep slopes are lit; 1 is true.
    relief_exaggeration: f64 = "a number", in 0.0..=20.0, default 1.0;
    /// Height of the cloud layer.
    cloud_height_km: f64 = "a number of kilometres", in 0.1..=20.0, default 6.0;
    /// How far the tops of thick clouds rise over thin ones.
    cloud_relief_km: f64 = "a number of kilometres", in 0.0..=20.0, default 4.0;
    /// Whether clouds throw shadows, by default with look = "full".
    cloud_shadows: bool = "true or false";
    /// Whether what is smaller than the maps' texels is made up; by default with look = "full".
    detail: bool = "true or false";
    /// Whether the Moon lights the Earth, by its phase; by default with look = "full".
    moonlight: bool = "true or false";
    /// Whether the air glows green at night, 95 km up; by default with look = "full".
    airglow: bool = "true or false";
    /// How many times brighter than in truth the lights of the night are, cities, moonlight and airglow; by default 40 000 with
    /// moonlight, else 150 000.
    night_gain: f64 = "a number", in 0.0..=1e6;
    /// Folder of the maps, the starter pack by default.
    textures: RawPath = "a string, the path of a folder of maps";
    /// Folder of an imagery pack, in place of maps.
    pack: RawPath = "a string, the path of an imagery pack's folder";
    // Lists, checked by dated_maps.rs.
    /// Day maps that change with the date.
    day_maps: RawDatedMaps = "a list of maps with their dates, or of twelve files, from January on";
    /// Cloud maps that change with the date.
    cloud_maps: RawDatedMaps = "a list of maps with their dates, or of twelve files, from January on";
    /// Maps of city lights that change with the date.
    night_light_maps: RawDatedMaps = "a list of maps with their dates, or of twelve files, from January on";
    /// Whether maps that change with the date pass into each other.
    map_fade: bool = "true or false", default true;
    /// Open water, where the maps have it; on by default with shading = "sunlit".
    water: bool = "true or false";
    /// Packs: how the level of a block is chosen, "screen" by default.
    levels: String = "a string: \"screen\" or \"paper\"";
    /// Packs: most screen pixels that a texel of a tile may cover.
    texel_px: f64 = "a number of screen pixels", in 0.25..=16.0, default 1.0;
    /// Packs: which of the storages is read, "auto" by default.
    storage: String = "a string: \"auto\", \"plain\" or \"bc\"";
    /// Packs: textures of maps and tiles (10⁶ bytes), from what the coarsest maps take to more than any adapter has.
    texture_mb: f64 = "a number of megabytes", in 1.0..=1e6, default 512.0;
    /// Packs: tiles uploaded in one frame.
    upload_mb: f64 = "a number of megabytes", in 0.01..=1e4, default 4.0;
    /// What draws ground with relief: "quadtree" by default where heights are named, else "blocks".
    surface: String = "a string: \"blocks\", \"projected-grid\", \"quadtree\", \"contours\" or \"clipmap\"";
    /// Files of heights; an empty list takes the starter pack's, or with pack_heights none.
    elevation: Vec<Spanned<RawPath>> = "a list of strings, the paths of files of heights";
    /// Packs: whether the pack's heights are the ground, beneath the files of `elevation`.
    pack_heights: bool = "true or false", default false;
    /// Packs: memory of their heights (10⁶ bytes), with pack_heights.
    ground_mb: f64 = "a number of megabytes", in 1.0..=1e6, default 256.0;
    /// Most pixels by which the drawn ground may differ from its data.
    tolerance_px: f64 = "a number of pixels", in 0.0..=1000.0, default DEFAULT_TOLERANCE_PX;
    /// Whether the sea's floor is drawn, and not its surface.
    sea_floor: bool = "true or false", default false;
    // Any value: tables within the table, whose keys are read in `surfaces`.
    /// Settings of surface = "clipmap".
    clipmap: toml::Value = "a table like { samples = 129, levels = 12, trimming = \"diamond\" }";
    /// Settings of surface = "contours".
    contours: toml::Value = "a table like { drawn = \"patches\" }";
    /// Settings of surface = "projected-grid".
    projected_grid: toml::Value = "a table like { samples = [129, 129], on_gpu = true }";
    /// Settings of surface = "quadtree".
    quadtree: toml::Value = "a table like { lambda = 300, culling = true, max_leaves = 24000 }";
    /// Whether single wrong heights are taken out of the files.
    denoise: bool = "true or false", default false;
});

table!(RawSky = "sky" {
    /// The stars of the Hipparcos catalogue to magnitude 6.5; off by default with look = "paper" alone.
    stars: bool = "true or false";
    /// The light of the stars too faint for that; by default with look = "full".
    milky_way: bool = "true or false";
    /// The Sun's disc; off by default with look = "paper" alone.
    sun: bool = "true or false";
    /// The Moon; off by default with look = "paper" alone.
    moon: bool = "true or false";
    /// The light of the Sun that a lens scatters about it; by default with look = "full".
    glare: bool = "true or false";
    /// The Moon's shadow on ground, clouds and air; off by default with look = "paper" alone.
    eclipses: bool = "true or false";
    /// How many times brighter than in truth stars and Milky Way are drawn.
    star_gain: f64 = "a number", in 0.0..=1e6, default 4e4;
    /// Folder of stars.bin, milky_way.jpg and moon.jpg, the starter pack by default.
    folder: RawPath = "a string, the path of a folder of star catalogue and maps";
});

table!(RawOutput = "output" {
    // A list of any length, so that a wrong length gets our own message.
    /// Width and height of pictures, [`DEFAULT_SIZE_PX`] by default.
    size: Vec<i64> = "[width, height], two whole numbers of pixels", in SIDE_PX;
    /// Samples per pixel, one of [`SAMPLES`]; [`EDGE_SAMPLES`] by default where edges are seen, else 1.
    samples: i64 = "1 or 4";
    // Any value: a number or a word.
    /// What light is multiplied by before it is shown: 2 to the power of it; "auto" meters each picture.
    exposure_ev: toml::Value = "a number of exposure values from −20 to 20 or \"auto\"";
    /// By which curve exposed light is shown, "neutral" by default.
    tone: String = "a string: \"neutral\", \"linear\" or \"filmic\"";
    /// How long a picture that is kept waits for its tiles and its simulator.
    wait_s: f64 = "a number of seconds", in 0.0..=3600.0, default 30.0;
});

table!(RawQuality = "quality" {
    /// Most milliseconds that a frame may cost before quality is given up; without it everything is drawn.
    target_ms: f64 = "a number of milliseconds", in 1.0..=1000.0;
    /// Part of width and height that is drawn and then enlarged, in the window and in pictures.
    scale: f64 = "a number", in 0.25..=1.0, default 1.0;
    /// The steps of quality, in place of those that were recorded for the adapter.
    ladder: RawPath = "a string, the path of a ladder.csv that `terrella report --quality` wrote";
});

/// A scene file; a table that is left out is `None`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawScene {
    pub(super) time: Option<RawTime>,
    pub(super) orbit: Option<RawOrbits>,
    pub(super) tracks: Option<RawTracks>,
    pub(super) camera: Option<RawCamera>,
    pub(super) earth: Option<RawEarth>,
    pub(super) sky: Option<RawSky>,
    pub(super) output: Option<RawOutput>,
    pub(super) quality: Option<RawQuality>,
}

/// Every table and key, in the order in which a scene is best written.
pub(super) const TABLES: &[Table] = &[
    RawTime::TABLE,
    RawOrbit::TABLE,
    RawTracks::TABLE,
    RawCamera::TABLE,
    RawEarth::TABLE,
    RawSky::TABLE,
    RawOutput::TABLE,
    RawQuality::TABLE,
];
