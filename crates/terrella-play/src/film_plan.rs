//! The film of what the window plays: the arguments of `terrella play` that make it.

use super::clock::Clock;
use super::flight::Flight;
use super::hand::FreeEye;
use super::output::free_name;
use super::place_text::place_text;
use super::switches::{Layer, Switches, tone_name};
use crate::scene::{CameraMode, Scene, Setting};
use std::path::PathBuf;
use terrella::Exposure;
use terrella::frames::rfc3339;

/// What is written over a film whose scene has no captions of its own.
const CAPTION: &str = "{satellite}, {time}";
const CAPTION_WITHOUT_SATELLITE: &str = "{time}";
/// Keys of the time that a film has.
const TIME_KEYS: [(&str, &str); 3] = [("time", "start"), ("time", "duration_s"), ("time", "speed")];
/// Longest name of a satellite in the name of a file, characters.
const MAX_NAME: usize = 40;

/// What of a scene films are made of.
#[derive(Clone, Debug)]
pub struct FilmSource {
    /// The scene or file of orbits, satellites and settings, as arguments.
    scene: Vec<String>,
    satellite: Option<String>,
    has_captions: bool,
    has_stations: bool,
    /// Whether the camera can be set: it has no keys and looks at nothing.
    has_free_camera: bool,
    has_unnamed_satellite: bool,
    mode: CameraMode,
    switches: Switches,
}

/// What the window shows.
#[derive(Clone, Copy)]
pub struct FilmView<'v> {
    pub clock: &'v Clock,
    pub switches: &'v Switches,
    /// The eye that the user has moved.
    pub free_eye: Option<FreeEye>,
    pub mode: CameraMode,
    /// Vertical field of view, radians.
    pub fov_rad: f64,
}

/// A film that can be made.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmPlan {
    /// Arguments of the program.
    pub arguments: Vec<String>,
    /// The file that is written.
    pub file: PathBuf,
    /// Its length, seconds.
    pub length_s: f64,
}

impl FilmSource {
    /// That of a flight; `None` where a simulator says what there is.
    pub fn of(flight: &Flight) -> Option<Self> {
        let scene = flight.scene();
        let camera = &scene.camera;
        (!scene.is_live()).then(|| Self {
            scene: scene_arguments(scene),
            satellite: flight.feed().map(|feed| feed.name().to_owned()),
            has_captions: !scene.captions.is_empty(),
            has_stations: !scene.stations.is_empty(),
            has_free_camera: camera.keys.is_empty()
                && camera.look_at.is_none()
                && scene.sensor.is_none(),
            has_unnamed_satellite: scene.has_unnamed_satellite(),
            mode: camera.mode,
            switches: Switches::of(scene),
        })
    }
}

/// A scene as arguments: its file, where it has one, the satellites of a file of orbits, and what was set.
fn scene_arguments(scene: &Scene) -> Vec<String> {
    let mut arguments = Vec::new();
    if scene.path.is_file() {
        arguments.push(scene.path.display().to_string());
    }
    if scene.is_of_orbits() {
        let names = scene.orbits.iter().filter_map(|orbit| orbit.name.clone());
        arguments.extend(names.flat_map(|name| ["--satellite".to_owned(), name]));
    }
    // The film has a time of its own.
    let set = scene.settings().iter();
    let set = set.filter(|setting| !TIME_KEYS.contains(&setting.of()));
    arguments.extend(set.flat_map(|setting| ["--set".to_owned(), setting.to_string()]));
    arguments
}

impl FilmPlan {
    /// The film of the range that is played, from where the eye is, with the layers that are shown.
    pub fn new(source: &FilmSource, shown: &FilmView<'_>) -> Self {
        let clock = shown.clock;
        let (first, _) = clock.span();
        let (from, to) = clock.range();
        let at = |part: f64| first + hifitime::Unit::Second * (part * clock.duration_s());
        let (start, duration_s) = (at(from), (to - from) * clock.duration_s());
        let rate = clock.speed().abs();
        let mut settings = vec![Setting::new("time", "speed", rate)];
        settings.extend(look_settings(&source.switches, shown.switches));
        if source.has_free_camera {
            settings.extend(camera_settings(source, shown));
        }
        let text = |text: &str| toml::Value::from(text);
        if !source.has_captions {
            let caption = match source.satellite {
                Some(_) => CAPTION,
                None => CAPTION_WITHOUT_SATELLITE,
            };
            settings.push(Setting::new("caption", "text", text(caption)));
        }
        let shows_stations = shown.switches.is_on(Layer::Stations);
        let site = shown.switches.site();
        if let Some(site) = site.filter(|_| shows_stations && !source.has_stations) {
            let (lat_rad, lon_rad) = (site.place.lat_rad, site.place.lon_rad);
            settings.extend([
                Setting::new("station", "name", text(&place_text(lat_rad, lon_rad))),
                Setting::new("station", "lat_deg", float(lat_rad.to_degrees())),
                Setting::new("station", "lon_deg", float(lon_rad.to_degrees())),
                Setting::new(
                    "station",
                    "min_elevation_deg",
                    float(site.min_elevation_deg),
                ),
            ]);
        }
        let file = file_name(source.satellite.as_deref(), &rfc3339(start));
        let mut arguments = vec!["play".to_owned()];
        arguments.extend(source.scene.iter().cloned());
        arguments.extend(["--start".to_owned(), rfc3339(start)]);
        arguments.extend(["--duration".to_owned(), rounded(duration_s, 3).to_string()]);
        let set = settings.iter();
        arguments.extend(set.flat_map(|setting| ["--set".to_owned(), setting.to_string()]));
        arguments.extend(["--video".to_owned(), file.display().to_string()]);
        Self {
            arguments,
            file,
            length_s: duration_s / rate,
        }
    }

    /// The same to a file that is not there yet.
    pub fn fresh(mut self) -> Self {
        self.file = free_name(&self.file.with_extension(""), "mp4");
        if let Some(last) = self.arguments.last_mut() {
            *last = self.file.display().to_string();
        }
        self
    }

    /// The command as a shell reads it.
    pub fn command(&self) -> String {
        let words = self.arguments.iter().map(|word| quoted(word));
        format!("terrella {}", words.collect::<Vec<_>>().join(" "))
    }
}

/// A word as a shell reads it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "._/:=,+-".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

/// `iss-zarya-2018-01-25T17-12-56Z.mp4`.
fn file_name(satellite: Option<&str>, start: &str) -> PathBuf {
    let words = satellite.unwrap_or("terrella").to_lowercase();
    let words = words.split(|c: char| !c.is_alphanumeric());
    let words: Vec<_> = words.filter(|word| !word.is_empty()).collect();
    let name: String = words.join("-").chars().take(MAX_NAME).collect();
    let name = if name.is_empty() { "terrella" } else { &name };
    let whole = start.split('.').next().unwrap_or(start);
    let time = whole.trim_end_matches('Z').replace(':', "-");
    PathBuf::from(format!("{name}-{time}Z.mp4"))
}

/// A number with so many decimals.
fn rounded(number: f64, decimals: i32) -> f64 {
    let ten = 10_f64.powi(decimals);
    // Without the sign of a zero.
    (number * ten).round() / ten + 0.0
}

/// A number of a scene, to a millionth.
fn float(number: f64) -> toml::Value {
    toml::Value::from(rounded(number, 6))
}

/// Layers, exposure and tone curve that are not the scene's.
fn look_settings(own: &Switches, shown: &Switches) -> Vec<Setting> {
    let mut settings = Vec::new();
    for layer in Layer::ALL {
        let is_on = shown.is_on(layer);
        if is_on == own.is_on(layer) {
            continue;
        }
        let keys: &[(&str, &str)] = match layer {
            Layer::Clouds => &[("earth", "clouds")],
            Layer::CityLights => &[("earth", "night_lights")],
            Layer::Sky => &[("sky", "stars"), ("sky", "sun"), ("sky", "moon")],
            Layer::Graticule => &[("layers", "graticule")],
            Layer::CoastLines => &[("layers", "coast_lines")],
            Layer::Borders => &[("layers", "borders")],
            Layer::Terminator => &[("layers", "terminator")],
            Layer::MoonShadow => &[("layers", "moon_shadow")],
            Layer::PlaceNames => &[("layers", "place_names")],
            Layer::Tracks => &[
                ("tracks", "trail"),
                ("tracks", "ground_track"),
                ("tracks", "marker"),
            ],
            Layer::Atmosphere => {
                let word = if is_on { "billboard" } else { "none" };
                settings.push(Setting::new("earth", "atmosphere", toml::Value::from(word)));
                &[]
            }
            // Those of a scene are there or not.
            Layer::Stations | Layer::Files | Layer::Coverage => &[],
        };
        let set = keys.iter();
        settings.extend(set.map(|(table, key)| Setting::new(table, key, is_on)));
    }
    if let Some(tone) = shown.tone.filter(|_| shown.tone != own.tone) {
        let name = toml::Value::from(tone_name(tone));
        settings.push(Setting::new("output", "tone", name));
    }
    match shown.exposure {
        None => {}
        Some(Exposure::Auto) => {
            let auto = toml::Value::from("auto");
            settings.push(Setting::new("output", "exposure_ev", auto));
        }
        Some(Exposure::Ev(ev)) => settings.push(Setting::new("output", "exposure_ev", float(ev))),
    }
    settings
}

/// The camera, where it is not the scene's.
fn camera_settings(source: &FilmSource, shown: &FilmView<'_>) -> Vec<Setting> {
    let mode = |word: &str| Setting::new("camera", "mode", toml::Value::from(word));
    match shown.free_eye {
        Some(FreeEye::Orbit(camera)) => {
            let number = |key, value| Setting::new("camera", key, float(value));
            let angle = |key, value: f64| number(key, value.to_degrees());
            let mut settings = vec![
                mode("geodetic"),
                angle("lat_deg", camera.place.lat_rad),
                angle("lon_deg", camera.place.lon_rad),
                number("height_km", camera.place.height_m / 1000.0),
                angle("heading_deg", camera.heading_rad),
                angle("pitch_deg", camera.pitch_rad),
                // The scene's own camera may be rolled.
                number("roll_deg", 0.0),
                angle("fov_deg", shown.fov_rad),
            ];
            if source.has_unnamed_satellite {
                settings.push(Setting::new("orbit", "source", toml::Value::from("tle")));
            }
            settings
        }
        Some(FreeEye::Follow(_)) => vec![mode("chase")],
        None if shown.mode == source.mode => Vec::new(),
        None => vec![mode(match shown.mode {
            CameraMode::Nadir => "nadir",
            CameraMode::Horizon => "horizon",
            CameraMode::Chase => "chase",
            CameraMode::Geodetic => "geodetic",
        })],
    }
}

#[cfg(test)]
#[path = "film_plan_tests.rs"]
mod tests;
