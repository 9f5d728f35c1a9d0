//! Maps fetched from a server on this machine: good ones, bad ones, interrupted ones.

mod bad_servers;
mod command;
mod elements;
mod good_servers;
mod server;

use image::{ExtendedColorType, ImageEncoder, codecs::jpeg::JpegEncoder, codecs::png::PngEncoder};
use server::Server;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;
use terrella_pack::BuildProgress;
use terrella_pack::fetch::{ClientOptions, FetchOptions, Fineness, Layer, MapSource, Request};

/// Texels of a tile.
pub const SIDE: u32 = 32;

/// Colour of a place, of latitudes and longitudes in degrees.
pub fn colour(lon_deg: f64, lat_deg: f64) -> [u8; 3] {
    let wave = |degrees: f64| (128.0 + 100.0 * degrees.to_radians().sin()) as u8;
    [
        wave(2.0 * lon_deg),
        wave(3.0 * lat_deg),
        wave(lon_deg + lat_deg),
    ]
}

/// A tile of a grid of 2^level tiles round the Earth, by the colours of its texels' centres.
pub fn tile(level: u32, row: u32, column: u32, colour: impl Fn(f64, f64) -> [u8; 3]) -> Vec<u8> {
    let tile_deg = 360.0 / f64::from(1_u32 << level);
    let at = |tile: u32, texel: u32| {
        (f64::from(tile) + (f64::from(texel) + 0.5) / f64::from(SIDE)) * tile_deg
    };
    (0..SIDE * SIDE)
        .flat_map(|n| colour(at(column, n % SIDE) - 180.0, 90.0 - at(row, n / SIDE)))
        .collect()
}

pub fn png(texels: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let encoder = PngEncoder::new(&mut file);
    encoder
        .write_image(texels, SIDE, SIDE, ExtendedColorType::Rgb8)
        .expect("written");
    file
}

pub fn jpeg(texels: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut file, 95);
    encoder
        .write_image(texels, SIDE, SIDE, ExtendedColorType::Rgb8)
        .expect("written");
    file
}

/// Level, row and column of a path `/z/row/column.png`.
pub fn place(path: &str) -> [u32; 3] {
    let mut numbers = path
        .trim_end_matches(".png")
        .trim_end_matches(".jpeg")
        .rsplit('/')
        .map_while(|word| word.parse().ok());
    let (column, row, level) = (numbers.next(), numbers.next(), numbers.next());
    [level, row, column].map(|number| number.expect("a number"))
}

/// A description of a source of PNG tiles on this server.
pub fn description(server: &Server) -> String {
    format!(
        "name = \"local\"\ntitle = \"Waves\"\nlayer = \"day\"\nattribution = [\"Waves by the tests\"]\nlicence = \"none\"\n\
         citation = \"none\"\n[gentleness]\nconnections = 3\nrequests_per_s = 1000\n[tiles]\nurl = \"{}\"\ntile_size = {SIDE}\n\
         level_0_tile_deg = 360\nlevels = [0, 4]\nmedia = \"image/png\"\n",
        server.url("/{z}/{row}/{column}.png")
    )
}

/// The only map of a description.
pub fn layer(text: &str) -> Layer {
    let source = MapSource::from_toml(text, Path::new("local.toml")).expect("a good description");
    let time = source.time(None).expect("a time");
    let mut layers = Layer::group(vec![Request { source, time }]);
    layers.remove(0)
}

pub fn options(cache: &Path) -> FetchOptions {
    FetchOptions {
        cache: cache.to_path_buf(),
        fineness: Fineness::Level(2),
        region: None,
        ground_width: 0,
        feather_deg: 0.0,
        under: None,
        connections: None,
        requests_per_s: None,
        retries: 1,
        allow_missing: false,
        client: ClientOptions {
            timeout: Duration::from_secs(1),
            authorities: None,
            redirect_hosts: Vec::new(),
        },
    }
}

/// Keeps what is noted; stops after so many steps.
#[derive(Default)]
pub struct Notes {
    pub texts: Mutex<Vec<String>>,
    pub steps: Mutex<u64>,
    pub stop_after: Option<u64>,
}

impl BuildProgress for Notes {
    fn begin(&self, _what: &str, _steps: Option<u64>) {}
    fn step(&self) {
        *self.steps.lock().expect("whole") += 1;
    }
    fn end(&self) {}
    fn note(&self, text: &str) {
        self.texts.lock().expect("whole").push(text.to_string());
    }
    fn cancelled(&self) -> bool {
        self.stop_after
            .is_some_and(|most| *self.steps.lock().expect("whole") >= most)
    }
}

/// All files of a cache that are no journals, by their names.
pub fn files(dir: &Path) -> Vec<PathBuf> {
    let (mut found, mut folders) = (Vec::new(), vec![dir.to_path_buf()]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_none_or(|ending| ending != "journal") {
                found.push(path.strip_prefix(dir).expect("inside").to_path_buf());
            }
        }
    }
    found.sort();
    found
}
