//! The scene file as written: every key optional, every value with its place in the text, nothing checked yet.

use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::ops::Range;
use toml::Spanned;

/// A key that a table knows.
#[derive(Debug)]
pub(super) struct Key {
    pub(super) name: &'static str,
    /// What its value must be, to be read after "must be".
    pub(super) expected: &'static str,
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
        self.name == "orbit"
    }
}

/// A table's struct and its list of known keys from one place, so that they cannot part.
macro_rules! table {
    ($name:ident { $($key:ident: $kind:ty = $expected:literal,)* }) => {
        #[derive(Debug, Default, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(super) struct $name {
            $(pub(super) $key: Option<Spanned<$kind>>,)*
        }

        impl $name {
            pub(super) const KEYS: &[Key] =
                &[$(Key { name: stringify!($key), expected: $expected }),*];

            /// The keys that the file gives, with the span of their values.
            pub(super) fn given(&self) -> Vec<(&'static str, Range<usize>)> {
                let mut given = Vec::new();
                $(given.extend(self.$key.as_ref().map(|value| (stringify!($key), value.span())));)*
                given
            }
        }
    };
}

table!(RawTime {
    // Any value: both a string and TOML's own date-time are read.
    start: toml::Value = "a UTC instant like \"2018-01-15T12:00:00Z\"",
    duration_s: f64 = "a number of simulated seconds",
    speed: f64 = "a number of simulated seconds per second",
    frame_rate_hz: f64 = "a number of frames per second",
    orientation: String = "a string, the path of a file like finals2000A.all",
});

table!(RawOrbit {
    source: String = "a string, the kind of source: \"tle\", \"omm\", \"oem\", \"czml\", \"csv\", \"kepler\", \"numerical\" or \"live\"",
    file: String = "a string, the path of a file of elements or states",
    name: String = "a string, the satellite's name",
    strict: bool = "true or false",
    // Any value: both a string and TOML's own date-time are read.
    epoch: toml::Value = "a UTC instant like \"2018-01-15T12:00:00Z\"",
    frame: String = "a string: \"teme\", \"pef\", \"itrf\", \"gcrf\" or \"eme2000\"",
    semi_major_axis_km: f64 = "a number of kilometres",
    periapsis_km: f64 = "a number of kilometres",
    eccentricity: f64 = "a number",
    inclination_deg: f64 = "a number of degrees",
    node_deg: f64 = "a number of degrees",
    argument_deg: f64 = "a number of degrees",
    true_anomaly_deg: f64 = "a number of degrees",
    mean_anomaly_deg: f64 = "a number of degrees",
    // Lists of any length, so that a wrong length gets our own message.
    position_km: Vec<f64> = "[x, y, z], three numbers of kilometres",
    velocity_km_s: Vec<f64> = "[x, y, z], three numbers of kilometres per second",
    j2: bool = "true or false",
    gravity_degree: i64 = "a whole number from 0 to 20",
    gravity_order: i64 = "a whole number from 0 to gravity_degree",
    drag: bool = "true or false",
    air_model: String = "a string: \"us1976\" or \"exponential\"",
    sun: bool = "true or false",
    moon: bool = "true or false",
    radiation: bool = "true or false",
    mass_kg: f64 = "a number of kilograms",
    area_m2: f64 = "a number of square metres",
    cd: f64 = "a number",
    cr: f64 = "a number",
    tolerance: f64 = "a number",
    listen: String = "a string: \"stdin\", or \"tcp://\", \"udp://\" or \"ws://\" with an IP address and a port",
    allow_remote: bool = "true or false",
    // A list of any length.
    allowed_origins: Vec<String> = "a list of strings, web pages like \"https://example.org\"",
    pacing: String = "a string: \"broadcast\" or \"lockstep\"",
    rate: f64 = "a number of simulated seconds per second",
    playback_delay_s: f64 = "a number of seconds",
    timeout_s: f64 = "a number of seconds",
    stale_after_s: f64 = "a number of seconds",
    extrapolate_s: f64 = "a number of simulated seconds",
    extrapolation: String = "a string: \"two-body\" or \"linear\"",
    gap_s: f64 = "a number of simulated seconds",
    packets_per_s: i64 = "a whole number of packets per second",
    color: String = "a string, \"#\" and six hexadecimal digits",
    // Any value: true, false or a table.
    trail: toml::Value = "true, false or { before_min = 90, after_min = 45 }",
    ground_track: toml::Value = "true, false or { before_min = 90, after_min = 45 }",
    marker: bool = "true or false",
    subpoint: bool = "true or false",
    footprint: bool = "true or false",
    sensor_half_angle_deg: f64 = "a number of degrees",
    footprint_fill: bool = "true or false",
});

table!(RawTracks {
    trail: toml::Value = "true, false or { before_min = 90, after_min = 45 }",
    ground_track: toml::Value = "true, false or { before_min = 90, after_min = 45 }",
    marker: bool = "true or false",
    subpoint: bool = "true or false",
    footprint: bool = "true or false",
    sensor_half_angle_deg: f64 = "a number of degrees",
    footprint_fill: bool = "true or false",
    width_px: f64 = "a number of pixels",
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

table!(RawCamera {
    mode: String = "a string: \"nadir\", \"horizon\", \"chase\" or \"geodetic\"",
    up: String = "a string: \"flight\" or \"north\"",
    follow: String = "a string, the name of one of the scene's satellites",
    fov_deg: f64 = "a number of degrees",
    lat_deg: f64 = "a number of degrees",
    lon_deg: f64 = "a number of degrees",
    height_km: f64 = "a number of kilometres",
    heading_deg: f64 = "a number of degrees",
    pitch_deg: f64 = "a number of degrees",
});

table!(RawEarth {
    figure: String = "a string: \"wgs84\" or \"sphere\"",
    // Any value: a number or a word.
    subdivision: toml::Value = "\"auto\" or a whole number from 1 to 48",
    visibility: String = "a string: \"conservative\" or \"paper\"",
    shading: String = "a string: \"sunlit\" or \"paper\"",
    clouds: bool = "true or false",
    normals: bool = "true or false",
    night_lights: bool = "true or false",
    atmosphere: String = "a string: \"billboard\" or \"none\"",
    textures: String = "a string, the path of a folder of maps",
    pack: String = "a string, the path of an imagery pack's folder",
    water: bool = "true or false",
    levels: String = "a string: \"screen\" or \"paper\"",
    texel_px: f64 = "a number of screen pixels",
    storage: String = "a string: \"auto\", \"plain\" or \"bc\"",
    texture_mb: f64 = "a number of megabytes",
    upload_mb: f64 = "a number of megabytes",
    surface: String = "a string: \"blocks\", \"projected-grid\", \"quadtree\", \"contours\" or \"clipmap\"",
    elevation: Vec<Spanned<String>> = "a list of strings, the paths of files of heights",
    tolerance_px: f64 = "a number of pixels",
    sea_floor: bool = "true or false",
    // Any value: tables within the table.
    clipmap: toml::Value = "a table like { samples = 129, levels = 12, trimming = \"diamond\" }",
    contours: toml::Value = "a table like { drawn = \"patches\" }",
    projected_grid: toml::Value = "a table like { samples = [129, 129], on_gpu = true }",
    denoise: bool = "true or false",
});

table!(RawOutput {
    // A list of any length, so that a wrong length gets our own message.
    size: Vec<i64> = "[width, height], two whole numbers of pixels",
    samples: i64 = "1 or 4",
    wait_s: f64 = "a number of seconds",
});

table!(RawQuality {
    target_ms: f64 = "a number of milliseconds",
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
    pub(super) output: Option<RawOutput>,
    pub(super) quality: Option<RawQuality>,
}

/// Every table and key, in the order in which a scene is best written.
pub(super) const TABLES: &[Table] = &[
    Table {
        name: "time",
        keys: RawTime::KEYS,
    },
    Table {
        name: "orbit",
        keys: RawOrbit::KEYS,
    },
    Table {
        name: "tracks",
        keys: RawTracks::KEYS,
    },
    Table {
        name: "camera",
        keys: RawCamera::KEYS,
    },
    Table {
        name: "earth",
        keys: RawEarth::KEYS,
    },
    Table {
        name: "output",
        keys: RawOutput::KEYS,
    },
    Table {
        name: "quality",
        keys: RawQuality::KEYS,
    },
];
