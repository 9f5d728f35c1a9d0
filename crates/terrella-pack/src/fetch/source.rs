//! Descriptions of sources: where maps are to be had, in which tiles, whose they are.

use super::address::{template_complaint, url_complaint};
use super::description;
use super::error::FetchError;
use super::token::{TOKEN_WORD, name_complaint};
use crate::mosaic::{Bounds, Crs, Encoding};
use serde::Deserialize;
use std::path::Path;
use terrella_imagery::pack::{MAX_ATTRIBUTION_LINES, MAX_TEXT_CHARS};

/// Most files of a list.
const MAX_FILES: usize = 1000;

/// Most pictures that a server sends in place of tiles.
const MAX_PLACEHOLDERS: usize = 100;

/// Finest level.
const MAX_LEVEL: u32 = 24;

/// Which map of a pack a source is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SourceLayer {
    /// Surface colour.
    Day,
    /// Cloud cover.
    Clouds,
    /// Heights in metres.
    Elevation,
    /// City lights.
    NightLights,
    /// Open water.
    Water,
}

impl SourceLayer {
    /// Name of its folder in a cache.
    pub fn name(self) -> &'static str {
        match self {
            Self::Day => "day",
            Self::Clouds => "clouds",
            Self::Elevation => "elevation",
            Self::NightLights => "night_lights",
            Self::Water => "water",
        }
    }
}

/// Image format of the files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Media {
    /// JPEG.
    #[serde(rename = "image/jpeg")]
    Jpeg,
    /// PNG.
    #[serde(rename = "image/png")]
    Png,
    /// TIFF; of lists only.
    #[serde(rename = "image/tiff")]
    Tiff,
}

impl Media {
    /// As HTTP names it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Jpeg => "image/jpeg",
            Self::Png => "image/png",
            Self::Tiff => "image/tiff",
        }
    }

    /// Ending of files.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Jpeg => "jpeg",
            Self::Png => "png",
            Self::Tiff => "tif",
        }
    }
}

/// Time step of a source's maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeStep {
    /// One map a month.
    Month,
    /// One map a day.
    Day,
    /// Some times that the source names itself.
    Named,
}

/// Times of a source.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Times {
    /// How its maps are parted.
    pub step: TimeStep,
    /// The default time.
    pub default: Option<String>,
    /// The earliest day, where there is one: `2000-02-24`.
    pub first: Option<String>,
    /// The latest day.
    pub last: Option<String>,
    /// All times, where they are few.
    #[serde(default)]
    pub names: Vec<String>,
}

/// Tiles of a source: levels of a grid, each with half the tile of the one before.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tiles {
    /// Address of a tile, see docs/packs.md.
    pub url: String,
    /// Coordinate system of the grid, whose north-west corner is 180° W and the northern end.
    #[serde(default)]
    pub crs: Crs,
    /// Texels of a tile's side.
    pub tile_size: u32,
    /// Degrees of longitude that a tile of level 0 spans; in Web Mercator 360.
    pub level_0_tile_deg: f64,
    /// The coarsest and the finest level.
    pub levels: [u32; 2],
    /// Names of the server's levels, from level 0 on, if they are not numbers.
    #[serde(default)]
    pub level_names: Vec<String>,
    /// Kind of picture.
    pub media: Media,
    /// Most bytes of a tile.
    #[serde(default = "most_tile_bytes")]
    pub max_tile_bytes: u64,
    /// Bytes of a tile, about: for the estimate before anything is fetched.
    pub usual_tile_bytes: Option<u64>,
    /// The server answers 404 for a missing tile.
    #[serde(default)]
    pub may_be_missing: bool,
    /// Encoding of elevations as colours.
    pub encoding: Option<Encoding>,
    /// Stored values that mark missing data.
    pub no_data: Option<Vec<f64>>,
    /// BLAKE3 of pictures that the server sends where it has nothing, 64 hexadecimal digits each.
    #[serde(default)]
    pub placeholders: Vec<String>,
}

fn most_tile_bytes() -> u64 {
    8_000_000
}

/// A file of a list.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ListedFile {
    /// Its address.
    pub url: String,
    /// Name in the cache: letters, digits, full stops, hyphens and underscores.
    pub save_as: String,
    /// West, south, east and north in degrees, if the file itself has no georeference.
    pub bounds_deg: Option<[f64; 4]>,
    /// BLAKE3 of its contents, where it is known, 64 hexadecimal digits.
    pub blake3: Option<String>,
}

/// Files of a list.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Files {
    /// Kind of picture.
    pub media: Media,
    /// Most bytes of one.
    pub max_file_bytes: u64,
    /// The files.
    pub file: Vec<ListedFile>,
}

/// Limits on the requests to a server.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gentleness {
    /// Number of simultaneous requests.
    pub connections: u32,
    /// Requests begun in a second.
    pub requests_per_s: f64,
}

impl Default for Gentleness {
    fn default() -> Self {
        Self {
            connections: 4,
            requests_per_s: 20.0,
        }
    }
}

/// A source of maps.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapSource {
    /// Its name, and its folder in a cache: lower-case letters, digits and underscores.
    pub name: String,
    /// A human-readable title.
    pub title: String,
    /// Which map of a pack it is.
    pub layer: SourceLayer,
    /// Whom to name, a line each: goes into packs.
    pub attribution: Vec<String>,
    /// Terms of use.
    pub licence: String,
    /// The source of this information.
    pub citation: String,
    /// Environment variable with the token that the server requires: it replaces `{token}` in addresses, or is sent in the header `Authorization:
    /// Bearer`.
    pub token_env: Option<String>,
    /// Its times, if it has any.
    pub time: Option<Times>,
    /// Limits on requests.
    #[serde(default)]
    pub gentleness: Gentleness,
    /// Tiles …
    pub tiles: Option<Tiles>,
    /// … or files.
    pub files: Option<Files>,
}

/// Whether a name is a valid file name: inside the folder, and not hidden.
fn is_file_name(name: &str) -> bool {
    (1..=100).contains(&name.len())
        && !name.starts_with('.')
        && name
            .bytes()
            .all(|b| b.is_ascii_alphanumeric() || matches!(b, b'.' | b'-' | b'_'))
}

impl MapSource {
    /// Reads a description; `path` is its name in messages.
    ///
    /// # Errors
    /// [`FetchError::Description`] with the line or the key.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, FetchError> {
        description::parse(text, path, Self::complaint)
    }

    /// The key that is wrong, and why.
    fn complaint(&self) -> Option<(&'static str, String)> {
        let lines = &self.attribution;
        let texts = lines
            .iter()
            .chain([&self.title, &self.licence, &self.citation]);
        let mut texts = texts;
        let is_name = self
            .name
            .bytes()
            .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_');
        if !is_name || !(1..=60).contains(&self.name.len()) {
            return Some((
                "name",
                "must be 1 to 60 lower-case letters, digits and underscores".into(),
            ));
        }
        if lines.is_empty() || lines.len() > MAX_ATTRIBUTION_LINES {
            return Some((
                "attribution",
                format!("must have 1 to {MAX_ATTRIBUTION_LINES} lines"),
            ));
        }
        if texts
            .any(|text| text.chars().count() > MAX_TEXT_CHARS || text.chars().any(char::is_control))
        {
            return Some((
                "attribution, title, licence, citation",
                format!(
                    "must be lines of at most {MAX_TEXT_CHARS} characters without control characters"
                ),
            ));
        }
        let Gentleness {
            connections,
            requests_per_s,
        } = self.gentleness;
        if !(1..=32).contains(&connections) || !(0.01..=1000.0).contains(&requests_per_s) {
            return Some((
                "gentleness",
                "1 to 32 connections and 0.01 to 1000 requests_per_s".into(),
            ));
        }
        if let Some(cause) = self.token_env.as_deref().and_then(name_complaint) {
            return Some(("token_env", cause.into()));
        }
        if self.token_env.is_none() && self.urls().any(|url| url.contains(TOKEN_WORD)) {
            return Some((
                "token_env",
                "must name the environment variable whose value {token} stands for".into(),
            ));
        }
        let in_time = self.time.as_ref().and_then(Times::complaint);
        if let Some(cause) = in_time {
            return Some(("time", cause));
        }
        match (&self.tiles, &self.files) {
            (Some(tiles), None) => tiles.complaint(self.time.is_some()),
            (None, Some(files)) => files.complaint(self.time.is_some()),
            _ => Some(("tiles", "give either [tiles] or [files]".into())),
        }
    }

    fn urls(&self) -> impl Iterator<Item = &str> {
        let tiles = self.tiles.iter().map(|tiles| tiles.url.as_str());
        let files = self.files.iter().flat_map(|files| &files.file);
        tiles.chain(files.map(|file| file.url.as_str()))
    }

    /// The time to fetch: the requested one if the source has it, else its default.
    ///
    /// # Errors
    /// [`FetchError::Option`] with the error in the time.
    pub fn time(&self, asked: Option<&str>) -> Result<Option<String>, FetchError> {
        let reject = |cause: String| FetchError::Option {
            option: "TIME",
            cause,
        };
        match (&self.time, asked) {
            (None, None) => Ok(None),
            (None, Some(_)) => Err(reject(format!("{} has no times", self.name))),
            (Some(times), None) => times.default.clone().map(Some).ok_or_else(|| {
                reject(format!(
                    "{} has one map a day: give one as in {}@2024-06-21",
                    self.name, self.name
                ))
            }),
            (Some(times), Some(asked)) => match times.asked(asked) {
                Ok(time) => Ok(Some(time)),
                Err(cause) => Err(reject(format!("{asked:?} of {}: {cause}", self.name))),
            },
        }
    }
}

impl Times {
    fn complaint(&self) -> Option<String> {
        let is_word = |text: &String| is_file_name(text);
        if !self.names.iter().all(is_word) || self.names.len() > 1000 {
            return Some(
                "names: at most 1000 of letters, digits, full stops, hyphens and underscores"
                    .into(),
            );
        }
        let days = [&self.first, &self.last].into_iter().flatten();
        if days.into_iter().any(|day| !is_day(day)) {
            return Some("first and last must be days as in 2000-02-24".into());
        }
        self.default
            .as_ref()
            .and_then(|time| self.asked(time).err())
            .map(|cause| format!("default: {cause}"))
    }

    /// The time as the server names it.
    fn asked(&self, asked: &str) -> Result<String, String> {
        match self.step {
            TimeStep::Named => self
                .names
                .iter()
                .find(|name| *name == asked)
                .cloned()
                .ok_or_else(|| format!("it is one of {}", self.names.join(", "))),
            TimeStep::Day | TimeStep::Month => {
                let day = match self.step {
                    TimeStep::Month if asked.len() == 7 => format!("{asked}-01"),
                    _ => asked.to_string(),
                };
                if !is_day(&day) || (self.step == TimeStep::Month && !day.ends_with("-01")) {
                    let form = if self.step == TimeStep::Month {
                        "2004-08"
                    } else {
                        "2024-06-21"
                    };
                    return Err(format!("write it as in {form}"));
                }
                // Days in this form are in the order of their letters.
                let first = self.first.as_deref().unwrap_or("0000");
                let last = self.last.as_deref().unwrap_or("9999");
                if day.as_str() < first || day.as_str() > last {
                    return Err(format!("it has maps from {first} to {last}"));
                }
                Ok(day)
            }
        }
    }
}

/// Whether a text is a valid calendar date: `2024-02-29`.
fn is_day(text: &str) -> bool {
    let number = |from: usize, to: usize| {
        text.get(from..to)
            .and_then(|digits| digits.parse::<u32>().ok())
    };
    let is_form = text.len() == 10
        && text.bytes().enumerate().all(|(n, b)| {
            if n == 4 || n == 7 {
                b == b'-'
            } else {
                b.is_ascii_digit()
            }
        });
    let (Some(year), Some(month), Some(day)) = (number(0, 4), number(5, 7), number(8, 10)) else {
        return false;
    };
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let days = match month {
        4 | 6 | 9 | 11 => 30,
        2 => 28 + u32::from(is_leap),
        1..=12 => 31,
        _ => 0,
    };
    is_form && (1..=days).contains(&day)
}

impl Tiles {
    fn complaint(&self, has_time: bool) -> Option<(&'static str, String)> {
        if let Some(cause) = template_complaint(&self.url) {
            return Some(("tiles.url", cause));
        }
        if has_time != (self.url.contains("{time}") || self.url.contains("{Time}")) {
            return Some((
                "tiles.url",
                "{time} belongs to a source with [time], and to no other".into(),
            ));
        }
        if !(16..=4096).contains(&self.tile_size) {
            return Some(("tiles.tile_size", "must be from 16 to 4096 texels".into()));
        }
        let [coarsest, finest] = self.levels;
        if coarsest > finest || finest > MAX_LEVEL {
            return Some((
                "tiles.levels",
                format!("must be [coarsest, finest] from 0 to {MAX_LEVEL}"),
            ));
        }
        if !(self.level_0_tile_deg >= 1.0 && self.level_0_tile_deg <= 720.0) {
            return Some((
                "tiles.level_0_tile_deg",
                "must be from 1 to 720 degrees".into(),
            ));
        }
        if self.crs == Crs::WebMercator && self.level_0_tile_deg != 360.0 {
            return Some(("tiles.level_0_tile_deg", "is 360 in EPSG:3857".into()));
        }
        let names = &self.level_names;
        if !names.is_empty() && names.len() <= finest as usize {
            return Some((
                "tiles.level_names",
                format!("must name levels 0 to {finest}"),
            ));
        }
        let is_name = |name: &String| {
            (1..=100).contains(&name.len())
                && name
                    .bytes()
                    .all(|b| b.is_ascii_alphanumeric() || b"._:-".contains(&b))
        };
        if !names.iter().all(is_name) {
            return Some((
                "tiles.level_names",
                "are letters, digits, full stops, colons, hyphens and underscores".into(),
            ));
        }
        if self.media == Media::Tiff {
            return Some(("tiles.media", "must be image/jpeg or image/png".into()));
        }
        if !(100..=64_000_000).contains(&self.max_tile_bytes) {
            return Some((
                "tiles.max_tile_bytes",
                "must be from 100 to 64 000 000".into(),
            ));
        }
        let is_texel = |values: &Vec<f64>| {
            (1..=4).contains(&values.len()) && values.iter().all(|v| v.is_finite())
        };
        if self
            .no_data
            .as_ref()
            .is_some_and(|values| !is_texel(values))
        {
            return Some(("tiles.no_data", "give 1 to 4 finite numbers".into()));
        }
        if self.placeholders.len() > MAX_PLACEHOLDERS
            || !self.placeholders.iter().all(|digits| is_hash(digits))
        {
            return Some((
                "tiles.placeholders",
                format!("are at most {MAX_PLACEHOLDERS}, each of 64 lower-case hexadecimal digits"),
            ));
        }
        None
    }
}

/// Whether a text is a BLAKE3 hash in the format of journals and descriptions.
fn is_hash(digits: &str) -> bool {
    digits.len() == 64
        && digits
            .bytes()
            .all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'))
}

impl Files {
    fn complaint(&self, has_time: bool) -> Option<(&'static str, String)> {
        if has_time {
            return Some((
                "time",
                "belongs to tiles; each file of a list has its own address".into(),
            ));
        }
        if self.file.is_empty() || self.file.len() > MAX_FILES {
            return Some(("files.file", format!("give 1 to {MAX_FILES} files")));
        }
        if !(100..=8_000_000_000).contains(&self.max_file_bytes) {
            return Some((
                "files.max_file_bytes",
                "must be from 100 to 8 000 000 000".into(),
            ));
        }
        for (n, file) in self.file.iter().enumerate() {
            if let Some(cause) = url_complaint(&file.url) {
                return Some(("files.file.url", cause));
            }
            if !is_file_name(&file.save_as)
                || self.file[..n]
                    .iter()
                    .any(|other| other.save_as == file.save_as)
            {
                return Some((
                    "files.file.save_as",
                    format!(
                        "{:?} must be a name of letters, digits, full stops, hyphens and underscores, and each once",
                        file.save_as
                    ),
                ));
            }
            if let Some(Err(cause)) = file.bounds_deg.map(Bounds::new) {
                return Some(("files.file.bounds_deg", cause));
            }
            if file.blake3.as_ref().is_some_and(|digits| !is_hash(digits)) {
                return Some((
                    "files.file.blake3",
                    "must be 64 lower-case hexadecimal digits".into(),
                ));
            }
        }
        None
    }
}
