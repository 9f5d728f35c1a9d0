//! The scene file as written: every key optional, every value with its place in the text, nothing checked yet.

use serde::Deserialize;
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
});

table!(RawOrbit {
    source: String = "a string, the kind of source: \"tle\"",
    file: String = "a string, the path of an elements file",
    name: String = "a string, the satellite's name in the elements file",
});

table!(RawCamera {
    mode: String = "a string: \"nadir\", \"horizon\", \"chase\" or \"geodetic\"",
    up: String = "a string: \"flight\" or \"north\"",
    fov_deg: f64 = "a number of degrees",
    lat_deg: f64 = "a number of degrees",
    lon_deg: f64 = "a number of degrees",
    height_km: f64 = "a number of kilometres",
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
    pub(super) orbit: Option<RawOrbit>,
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
