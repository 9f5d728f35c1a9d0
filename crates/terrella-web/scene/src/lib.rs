//! A scene file as a page shows it: what `scene.js` calls. A file of its own, so that pages without a scene do not load it.
//!
//! A page has a part of what scenes describe. Keys that it does not have are listed by name.

// `wasm-bindgen` exports what is here; on other targets nothing uses it.
#![cfg_attr(not(target_family = "wasm"), allow(dead_code))]

mod keys;

use keys::{Fault, Keys};
use toml::{Table, Value};
use wasm_bindgen::prelude::{JsValue, wasm_bindgen};

/// Instant of a scene without a start and without satellites.
const DEFAULT_START: &str = "2018-01-15T12:00:00Z";
/// Exposure value of a scene without one.
const DEFAULT_EV: f64 = 0.5;
/// Sources of orbits that a page reads from a file, and those that it does not have.
const FILES: [&str; 7] = ["tle", "omm", "oem", "czml", "csv", "sp3", "stk"];
const OTHER_SOURCES: [&str; 5] = ["opm", "kepler", "numerical", "live", "basilisk"];
const RIDES: [&str; 3] = ["nadir", "horizon", "chase"];
/// Longest text of a scene, bytes, as natively.
const MOST_BYTES: usize = 16 << 20;
/// Most satellites and stations of a scene.
const MOST_TABLES: usize = 1000;

/// What a page shows of a scene.
#[wasm_bindgen]
#[derive(Debug, Default)]
pub struct PageScene {
    start: Option<String>,
    rate: Option<f64>,
    view: Option<[f64; 5]>,
    fov_deg: f64,
    follow: String,
    followed: Option<String>,
    look: String,
    hidden: Vec<String>,
    lines: Vec<String>,
    tracks: Vec<String>,
    /// `None` meters each frame.
    exposure_ev: Option<f64>,
    /// Name and numbers of each: latitude, longitude, mask (degrees) and altitude (metres).
    stations: Vec<(String, [f64; 4])>,
    /// File and satellite of each.
    satellites: Vec<[String; 2]>,
    pack: Option<String>,
    missing: Vec<String>,
}

#[wasm_bindgen]
impl PageScene {
    /// Reads a scene.
    ///
    /// # Errors
    /// A text that is no TOML, with its line, or a key with another kind of value.
    pub fn read(text: &str) -> Result<PageScene, JsValue> {
        Self::of(text).map_err(|fault| js_sys::Error::new(&fault.to_string()).into())
    }

    /// Its start; none if that is the satellite's own time.
    pub fn start(&self) -> Option<String> {
        self.start.clone()
    }

    /// Simulated seconds per second, if the scene says so.
    pub fn rate(&self) -> Option<f64> {
        self.rate
    }

    /// Latitude, longitude, altitude, heading and pitch of a camera over the ground, degrees and metres.
    pub fn view(&self) -> Option<Vec<f64>> {
        self.view.map(Vec::from)
    }

    /// Vertical field of view, degrees.
    pub fn fov(&self) -> f64 {
        self.fov_deg
    }

    /// How the camera rides on a satellite; empty for one over the ground.
    pub fn follow(&self) -> String {
        self.follow.clone()
    }

    /// The satellite that it rides on; none for the first.
    pub fn followed(&self) -> Option<String> {
        self.followed.clone()
    }

    /// "standard" or "full".
    pub fn look(&self) -> String {
        self.look.clone()
    }

    /// Parts that are not drawn.
    pub fn hidden(&self) -> Vec<String> {
        self.hidden.clone()
    }

    /// Lines on the ground.
    pub fn lines(&self) -> Vec<String> {
        self.lines.clone()
    }

    /// What is drawn of satellites.
    pub fn tracks(&self) -> Vec<String> {
        self.tracks.clone()
    }

    /// Exposure value; none meters each frame.
    pub fn exposure(&self) -> Option<f64> {
        self.exposure_ev
    }

    /// Names of the stations.
    #[wasm_bindgen(js_name = stationNames)]
    pub fn station_names(&self) -> Vec<String> {
        self.stations.iter().map(|(name, _)| name.clone()).collect()
    }

    /// Latitude, longitude, mask (degrees) and altitude (metres) of each.
    #[wasm_bindgen(js_name = stationNumbers)]
    pub fn station_numbers(&self) -> Vec<f64> {
        self.stations.iter().flat_map(|(_, at)| *at).collect()
    }

    /// Of each satellite its file and its name, which is empty for all of the file.
    pub fn satellites(&self) -> Vec<String> {
        self.satellites.iter().flatten().cloned().collect()
    }

    /// Folder of the imagery pack.
    pub fn pack(&self) -> Option<String> {
        self.pack.clone()
    }

    /// Keys that the page does not have, such as `camera.roll_deg`.
    pub fn missing(&self) -> Vec<String> {
        self.missing.clone()
    }
}

impl PageScene {
    fn of(text: &str) -> Result<Self, Fault> {
        if text.len() > MOST_BYTES {
            return Err(Fault::TooLong { most: MOST_BYTES });
        }
        let table: Table = toml::from_str(text).map_err(Fault::Toml)?;
        let mut scene = Self {
            fov_deg: 45.0,
            look: "standard".to_owned(),
            exposure_ev: Some(DEFAULT_EV),
            ..Self::default()
        };
        let mut root = Keys::new("", table);
        let orbits = root.tables("orbit", MOST_TABLES)?;
        let common = root.table("tracks")?;
        scene.take_satellites(orbits, common)?;
        scene.take_time(root.table("time")?)?;
        scene.take_camera(root.table("camera")?)?;
        scene.take_earth(root.table("earth")?)?;
        scene.take_sky(root.table("sky")?)?;
        scene.take_layers(root.table("layers")?)?;
        scene.take_output(root.table("output")?)?;
        for station in root.tables("station", MOST_TABLES)? {
            scene.take_station(station)?;
        }
        scene.miss(root);
        Ok(scene)
    }

    /// Lists what was not taken.
    fn miss(&mut self, keys: Keys) {
        for key in keys.rest() {
            if !self.missing.contains(&key) {
                self.missing.push(key);
            }
        }
    }

    fn take_time(&mut self, mut keys: Keys) -> Result<(), Fault> {
        let start = keys.text("start")?;
        self.start = start.or_else(|| self.satellites.is_empty().then(|| DEFAULT_START.to_owned()));
        self.rate = keys.number("speed", -1e6..=1e6)?;
        // A page plays on without an end, at the rate of its screen.
        keys.number("duration_s", 0.0..=1e9)?;
        keys.number("frame_rate_hz", 1.0..=240.0)?;
        self.miss(keys);
        Ok(())
    }

    fn take_satellites(&mut self, orbits: Vec<Keys>, mut common: Keys) -> Result<(), Fault> {
        // All satellites of a page are drawn alike.
        let mut parts = shown_of(&mut common)?;
        self.miss(common);
        for mut keys in orbits {
            let source = keys.text("source")?.unwrap_or_else(|| "tle".to_owned());
            let known = FILES.into_iter().chain(OTHER_SOURCES);
            if !known.into_iter().any(|word| word == source) {
                return Err(keys.unknown_word("source", &source));
            }
            parts.extend(shown_of(&mut keys)?);
            keys.flag("strict")?;
            let file = keys.text("file")?;
            let name = keys.text("name")?.unwrap_or_default();
            let is_all = match keys.value("all") {
                None | Some(Value::Boolean(false)) => false,
                Some(Value::Boolean(true)) => true,
                // Patterns and ranges of numbers.
                Some(_) => {
                    self.missing.push(keys.path("all"));
                    true
                }
            };
            match file.filter(|_| FILES.contains(&source.as_str())) {
                Some(file) => {
                    let name = if is_all { String::new() } else { name };
                    self.satellites.push([file, name]);
                }
                None => self.missing.push(format!("orbit.source = \"{source}\"")),
            }
            self.miss(keys);
        }
        for part in parts {
            if !self.tracks.contains(&part) {
                self.tracks.push(part);
            }
        }
        Ok(())
    }

    fn take_camera(&mut self, mut keys: Keys) -> Result<(), Fault> {
        if let Some(fov_deg) = keys.number("fov_deg", 0.001..=179.999)? {
            self.fov_deg = fov_deg;
        }
        let mode = keys.text("mode")?;
        let place = [
            keys.number("lat_deg", -90.0..=90.0)?,
            keys.number("lon_deg", -360.0..=360.0)?,
            keys.number("height_km", 0.001..=1e9)?.map(|km| 1e3 * km),
            keys.number("heading_deg", -360.0..=360.0)?,
            keys.number("pitch_deg", -90.0..=90.0)?,
        ];
        let is_geodetic = match mode.as_deref() {
            None => place.iter().any(Option::is_some),
            Some("geodetic") => true,
            Some(ride) if RIDES.contains(&ride) => false,
            Some(word) => return Err(keys.unknown_word("mode", word)),
        };
        self.followed = keys.text("follow")?;
        if is_geodetic {
            let [lat, lon, altitude, heading, pitch] = place;
            self.view = Some([
                lat.unwrap_or(0.0),
                lon.unwrap_or(0.0),
                altitude.unwrap_or(2e7),
                heading.unwrap_or(0.0),
                pitch.unwrap_or(-90.0),
            ]);
        } else {
            self.follow = mode.unwrap_or_else(|| RIDES[0].to_owned());
            if keys.text("up")?.is_some_and(|up| up != "flight") {
                self.missing.push(keys.path("up"));
            }
        }
        self.miss(keys);
        Ok(())
    }

    fn take_earth(&mut self, mut keys: Keys) -> Result<(), Fault> {
        match keys.text("look")?.as_deref() {
            None => {}
            Some(look @ ("standard" | "full")) => self.look = look.to_owned(),
            Some("paper") => self.missing.push("earth.look = \"paper\"".to_owned()),
            Some(word) => return Err(keys.unknown_word("look", word)),
        }
        for (key, part) in [
            ("clouds", "clouds"),
            ("night_lights", "lights"),
            ("normals", "relief"),
            ("water", "water"),
        ] {
            // A map of its own is a file, which the page does not have.
            match keys.value(key) {
                None | Some(Value::Boolean(true)) => {}
                Some(Value::Boolean(false)) => self.hidden.push(part.to_owned()),
                Some(_) => self.missing.push(keys.path(key)),
            }
        }
        match keys.text("atmosphere")?.as_deref() {
            None | Some("billboard") => {}
            Some("none") => self.hidden.push("air".to_owned()),
            Some(_) => self.missing.push(keys.path("atmosphere")),
        }
        // The page has them by its own attribute.
        if keys.flag("seasons")? == Some(false) {
            self.missing.push(keys.path("seasons"));
        }
        self.pack = keys.text("pack")?;
        self.miss(keys);
        Ok(())
    }

    fn take_sky(&mut self, mut keys: Keys) -> Result<(), Fault> {
        let mut shown = Vec::new();
        for key in ["stars", "sun", "moon"] {
            shown.push(keys.flag(key)?.unwrap_or(true));
        }
        match shown.iter().filter(|is_shown| **is_shown).count() {
            0 => self.hidden.push("sky".to_owned()),
            3 => {}
            _ => self.missing.push("sky.stars, sun, moon".to_owned()),
        }
        self.miss(keys);
        Ok(())
    }

    fn take_layers(&mut self, mut keys: Keys) -> Result<(), Fault> {
        for (key, lines) in [
            ("graticule", "graticule"),
            ("coast_lines", "coasts"),
            ("borders", "borders"),
            ("terminator", "twilight"),
        ] {
            if keys.is_on(key)? {
                self.lines.push(lines.to_owned());
            }
        }
        self.miss(keys);
        Ok(())
    }

    fn take_output(&mut self, mut keys: Keys) -> Result<(), Fault> {
        match keys.value("exposure_ev") {
            None => {}
            Some(Value::String(word)) if word == "auto" => self.exposure_ev = None,
            Some(value) => {
                let ev = keys.number_of("exposure_ev", &value, -20.0..=20.0)?;
                self.exposure_ev = Some(ev);
            }
        }
        // The canvas has a size and samples of its own.
        keys.value("size");
        keys.value("samples");
        self.miss(keys);
        Ok(())
    }

    fn take_station(&mut self, mut keys: Keys) -> Result<(), Fault> {
        let name = keys.text("name")?.unwrap_or_default();
        let lat = keys.number("lat_deg", -90.0..=90.0)?;
        let lon = keys.number("lon_deg", -360.0..=360.0)?;
        let (Some(lat), Some(lon)) = (lat, lon) else {
            return Err(keys.wrong("lat_deg", "a number, and lon_deg too"));
        };
        let mask = keys.number("min_elevation_deg", 0.0..=89.0)?.unwrap_or(5.0);
        let altitude = keys.number("height_m", -1e4..=1e5)?.unwrap_or(0.0);
        self.stations.push((name, [lat, lon, mask, altitude]));
        self.miss(keys);
        Ok(())
    }
}

/// What is drawn of a satellite, by the words of the page's `tracks`.
fn shown_of(keys: &mut Keys) -> Result<Vec<String>, Fault> {
    let mut parts = Vec::new();
    for (key, part) in [
        ("marker", "markers"),
        ("trail", "trails"),
        ("ground_track", "ground-tracks"),
        ("subpoint", "subpoints"),
        ("footprint", "footprints"),
    ] {
        if keys.is_on(key)? {
            parts.push(part.to_owned());
        }
    }
    Ok(parts)
}

#[cfg(test)]
mod tests;
