//! Values into ranges, names into choices, paths into place, defaults into gaps.

use super::error::{Place, SceneError, printable};
use super::limits::*;
use super::locate::{Source, nearest};
use super::raw::{RawCamera, RawEarth, RawOrbit, RawOutput, RawScene, RawTime};
use super::{Camera, CameraMode, EarthTable, Lines, Orbit, Output, Scene, Time};
use crate::air::Atmosphere;
use crate::earth::Shading;
use crate::frames::{Epoch, utc_from_rfc3339};
use crate::globe::{Figure, Visibility};
use serde::Deserialize;
use serde::de::value::StrDeserializer;
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// A key with its value, if the file gives one.
struct Field<'r, T> {
    table: &'static str,
    key: &'static str,
    given: Option<&'r Spanned<T>>,
}

impl<T> Field<'_, T> {
    fn is_given(&self) -> bool {
        self.given.is_some()
    }
}

/// The field of a raw table under its own name: the name in a message cannot differ from the key that is read.
macro_rules! field {
    ($table:ident . $key:ident) => {
        Field {
            table: stringify!($table),
            key: stringify!($key),
            given: $table.$key.as_ref(),
        }
    };
}

/// Checks a whole scene.
pub(super) fn check(source: Source<'_>, raw: RawScene) -> Result<Scene, SceneError> {
    let has_orbit = raw.orbit.is_some();
    let time = raw.time.unwrap_or_default();
    let orbit = raw.orbit.unwrap_or_default();
    let camera = raw.camera.unwrap_or_default();
    let earth = raw.earth.unwrap_or_default();
    let output = raw.output.unwrap_or_default();

    let mut lines = Lines::default();
    for (table, given) in [
        ("time", time.given()),
        ("orbit", orbit.given()),
        ("camera", camera.given()),
        ("earth", earth.given()),
        ("output", output.given()),
    ] {
        for (key, span) in given {
            lines.insert(table, key, source.line(span.start));
        }
    }

    let camera = source.camera(&camera)?;
    let flies = camera.mode != CameraMode::Geodetic;
    Ok(Scene {
        path: source.path.to_owned(),
        time: source.time(&time)?,
        orbit: match source.orbit(&orbit)? {
            orbit if flies || has_orbit => Some(orbit),
            _ => None,
        },
        camera,
        earth: source.earth(&earth)?,
        output: source.output(&output)?,
        lines,
    })
}

impl Source<'_> {
    fn time(&self, time: &RawTime) -> Result<Time, SceneError> {
        let start = self.start(&field!(time.start))?;
        let above_zero = f64::MIN_POSITIVE..=MAX_DURATION_S;
        let duration = field!(time.duration_s);
        let duration_s = self.number(&duration, DEFAULT_DURATION_S, above_zero, |_| {
            format!("must be more than 0 and at most {MAX_DURATION_S} seconds")
        })?;
        let speed_field = field!(time.speed);
        let speed = self.number(&speed_field, DEFAULT_SPEED, -MAX_SPEED..=MAX_SPEED, |_| {
            format!("must be from −{MAX_SPEED} to {MAX_SPEED} simulated seconds per second")
        })?;
        if speed == 0.0 {
            return Err(self.refuse(
                &speed_field,
                "a scene at speed 0 would never end; give 1 for real time, a negative speed to play backwards",
            ));
        }
        let rate = field!(time.frame_rate_hz);
        let frame_rate_hz = self.number(&rate, DEFAULT_FRAME_RATE_HZ, FRAME_RATE_HZ, |_| {
            format!("must be from {} frames per second", span_of(&FRAME_RATE_HZ))
        })?;
        let time = Time {
            start,
            duration_s,
            speed,
            frame_rate_hz,
        };
        if time.frames_exact() > MAX_FRAMES {
            let advice = format!(
                "duration_s {duration_s} × frame_rate_hz {frame_rate_hz} / speed {} makes more than {MAX_FRAMES} frames; \
                 shorten the duration, lower the frame rate or raise the speed",
                speed.abs()
            );
            // The one of the three that the author chose is the one to name.
            return Err(match (duration.is_given(), speed_field.is_given()) {
                (_, true) => self.refuse(&speed_field, advice),
                (true, _) => self.refuse(&duration, advice),
                _ => self.refuse(&rate, advice),
            });
        }
        let (end_year, ..) = time.end().to_gregorian_utc();
        if !(FIRST_YEAR..=LAST_YEAR).contains(&end_year) {
            return Err(self.refuse(
                &duration,
                format!(
                    "the flight would end in {end_year}; it must stay in {FIRST_YEAR}…{LAST_YEAR}"
                ),
            ));
        }
        Ok(time)
    }

    fn start(&self, field: &Field<'_, toml::Value>) -> Result<Epoch, SceneError> {
        const ADVICE: &str = "write UTC like \"2018-01-15T12:00:00Z\"";
        let text = match field.given.map(Spanned::get_ref) {
            None => DEFAULT_START.to_owned(),
            Some(toml::Value::String(text)) => text.clone(),
            Some(toml::Value::Datetime(when)) => {
                let mut when = *when;
                if when.date.is_none() || when.time.is_none() || when.offset.is_none() {
                    let advice =
                        format!("must have a date, a time of day and the zone Z; {ADVICE}");
                    return Err(self.refuse(field, advice));
                }
                // TOML lets the seconds be left out, RFC 3339 does not.
                if let Some(time) = &mut when.time {
                    time.second.get_or_insert(0);
                }
                when.to_string()
            }
            Some(_) => {
                return Err(
                    self.refuse(field, format!("must be a date and a time of day; {ADVICE}"))
                );
            }
        };
        let start = utc_from_rfc3339(&text)
            .map_err(|error| self.refuse(field, format!("{error}; {ADVICE}")))?;
        let (year, ..) = start.to_gregorian_utc();
        if !(FIRST_YEAR..=LAST_YEAR).contains(&year) {
            let advice = format!("must lie in the years {FIRST_YEAR} to {LAST_YEAR}");
            return Err(self.refuse(field, advice));
        }
        Ok(start)
    }

    fn orbit(&self, orbit: &RawOrbit) -> Result<Orbit, SceneError> {
        let OrbitSource::Tle = self.choice(&field!(orbit.source), OrbitSource::Tle)?;
        let file = self.path(&field!(orbit.file), Wanted::File)?;
        let name_field = field!(orbit.name);
        let name = name_field.given.map(|name| name.get_ref().clone());
        if name.as_ref().is_some_and(|name| name.trim().is_empty()) {
            let advice = "must not be empty; give the satellite's name, or leave name out where the file holds one satellite";
            return Err(self.refuse(&name_field, advice));
        }
        if name.is_some() && file.is_none() {
            let advice = "name chooses a satellite of an elements file; add file = \"…\" to [orbit], or leave name out for the built-in space station";
            return Err(self.refuse(&name_field, advice));
        }
        Ok(Orbit { file, name })
    }

    fn camera(&self, camera: &RawCamera) -> Result<Camera, SceneError> {
        let (lat, lon, height) = (
            field!(camera.lat_deg),
            field!(camera.lon_deg),
            field!(camera.height_km),
        );
        let stands = [&lat, &lon, &height]
            .into_iter()
            .find(|field| field.is_given());
        let default_mode = match stands {
            Some(_) => CameraMode::Geodetic,
            None => CameraMode::Nadir,
        };
        let mode = self.choice(&field!(camera.mode), default_mode)?;
        if let Some(field) = stands
            && mode != CameraMode::Geodetic
        {
            let advice = format!(
                "{} has no meaning with mode = \"{}\", where the eye is the satellite's; leave it out or write mode = \"geodetic\"",
                field.key,
                written(&mode)
            );
            return Err(self.refuse(field, advice));
        }
        let fov_deg = self.number(&field!(camera.fov_deg), DEFAULT_FOV_DEG, FOV_DEG, |_| {
            format!(
                "the field of view must be more than 0 and less than 180 degrees (from {})",
                span_of(&FOV_DEG)
            )
        })?;
        let lat_deg = self.number(&lat, 0.0, LAT_DEG, |_| {
            format!("must be from {} degrees, south negative", span_of(&LAT_DEG))
        })?;
        let lon_deg = self.number(&lon, 0.0, LON_DEG, |_| {
            format!("must be from {} degrees, west negative", span_of(&LON_DEG))
        })?;
        let height_km = self.number(&height, DEFAULT_HEIGHT_KM, HEIGHT_KM, |height_km| {
            let why = match height_km {
                h if h < 0.0 => "the eye would be inside the Earth",
                h if h < *HEIGHT_KM.start() => "the eye would stand in the surface it looks at",
                _ => "nothing would be seen from so far",
            };
            format!("{why}; must be from {} km", span_of(&HEIGHT_KM))
        })?;
        Ok(Camera {
            mode,
            fov_deg,
            lat_deg,
            lon_deg: half_turn(lon_deg),
            height_km,
        })
    }

    fn earth(&self, earth: &RawEarth) -> Result<EarthTable, SceneError> {
        let shading = self.choice(&field!(earth.shading), Shading::default())?;
        let lights = field!(earth.night_lights);
        let night_lights = flag(&lights, shading == Shading::Sunlit);
        if night_lights && shading == Shading::Paper {
            let advice = "the paper's shading has no night lights; write false, leave it out, or take shading = \"sunlit\"";
            return Err(self.refuse(&lights, advice));
        }
        Ok(EarthTable {
            figure: self.choice(&field!(earth.figure), Figure::default())?,
            subdivision: self.subdivision(&field!(earth.subdivision))?,
            visibility: self.choice(&field!(earth.visibility), Visibility::default())?,
            shading,
            clouds: flag(&field!(earth.clouds), true),
            normals: flag(&field!(earth.normals), true),
            night_lights,
            atmosphere: self.choice(&field!(earth.atmosphere), Atmosphere::default())?,
            textures: self.path(&field!(earth.textures), Wanted::Folder)?,
        })
    }

    fn subdivision(&self, field: &Field<'_, i64>) -> Result<u32, SceneError> {
        let Some(given) = field.given else {
            return Ok(DEFAULT_SUBDIVISION);
        };
        in_range(*given.get_ref(), &SUBDIVISION).ok_or_else(|| {
            let advice = format!(
                "must be from {} cells per block edge",
                span_of(&SUBDIVISION)
            );
            self.refuse(field, advice)
        })
    }

    fn output(&self, output: &RawOutput) -> Result<Output, SceneError> {
        let size_field = field!(output.size);
        let size = match size_field.given.map(|given| given.get_ref().as_slice()) {
            None => DEFAULT_SIZE_PX,
            Some(&[width, height]) => match (in_range(width, &SIDE_PX), in_range(height, &SIDE_PX))
            {
                (Some(width), Some(height)) => [width, height],
                _ => {
                    let advice = format!(
                        "width and height must each be from {} pixels",
                        span_of(&SIDE_PX)
                    );
                    return Err(self.refuse(&size_field, advice));
                }
            },
            Some(other) => {
                let advice = format!("must be two numbers, [width, height], not {}", other.len());
                return Err(self.refuse(&size_field, advice));
            }
        };
        let samples_field = field!(output.samples);
        let samples = match samples_field.given.map(|given| *given.get_ref()) {
            None => DEFAULT_SAMPLES,
            Some(count) if SAMPLES.contains(&count) => {
                u32::try_from(count).unwrap_or(DEFAULT_SAMPLES)
            }
            Some(_) => {
                let advice =
                    "must be 1 (no smoothing of edges) or 4, the counts that every adapter can do";
                return Err(self.refuse(&samples_field, advice));
            }
        };
        Ok(Output { size, samples })
    }

    /// A finite number in a range; `remedy` gets the number that is not.
    fn number(
        &self,
        field: &Field<'_, f64>,
        default: f64,
        range: RangeInclusive<f64>,
        remedy: impl Fn(f64) -> String,
    ) -> Result<f64, SceneError> {
        let value = field.given.map_or(default, |given| *given.get_ref());
        if !value.is_finite() {
            return Err(self.refuse(field, "must be a finite number, not nan or inf"));
        }
        if !range.contains(&value) {
            return Err(self.refuse(field, remedy(value)));
        }
        Ok(value)
    }

    /// One of the names of an enum, as its serde derive spells them.
    fn choice<T: for<'de> Deserialize<'de>>(
        &self,
        field: &Field<'_, String>,
        default: T,
    ) -> Result<T, SceneError> {
        let Some(given) = field.given else {
            return Ok(default);
        };
        let word = given.get_ref();
        T::deserialize(StrDeserializer::<UnknownName>::new(word)).map_err(|UnknownName(known)| {
            let all = known
                .iter()
                .map(|name| format!("\"{name}\""))
                .collect::<Vec<_>>();
            let list = match all.as_slice() {
                [only] => format!("must be {only}, the only kind there is"),
                all => format!("must be one of {}", all.join(", ")),
            };
            let hint = match nearest(word, known.iter().copied()) {
                Some(near) if known.len() > 1 => format!("; did you mean \"{near}\"?"),
                _ => String::new(),
            };
            self.refuse(field, list + &hint)
        })
    }

    /// A path relative to the scene's folder, of something that is there.
    fn path(
        &self,
        field: &Field<'_, String>,
        wanted: Wanted,
    ) -> Result<Option<PathBuf>, SceneError> {
        let Some(given) = field.given else {
            return Ok(None);
        };
        let (what, other) = match wanted {
            Wanted::File => ("a file", "a folder"),
            Wanted::Folder => ("a folder", "a file"),
        };
        if given.get_ref().is_empty() {
            let advice = format!(
                "must not be empty; give the path of {what}, relative to the scene's folder"
            );
            return Err(self.refuse(field, advice));
        }
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let path = folder.join(given.get_ref());
        let shown = printable(&path.display().to_string());
        match std::fs::metadata(&path) {
            Ok(found) if found.is_dir() == (wanted == Wanted::Folder) => Ok(Some(path)),
            Ok(_) => {
                let advice = format!("{shown} is {other}; give the path of {what}");
                Err(self.refuse(field, advice))
            }
            Err(error) => {
                let advice = format!(
                    "{shown} cannot be opened: {error}; give the path of {what}, relative to the scene's folder"
                );
                Err(self.refuse(field, advice))
            }
        }
    }

    fn refuse<T>(&self, field: &Field<'_, T>, remedy: impl Display) -> SceneError {
        let span = field.given.map(Spanned::span);
        SceneError::Value {
            place: Box::new(Place {
                path: self.path.to_owned(),
                line: span.as_ref().map(|span| self.line(span.start)),
                table: field.table.to_owned(),
                key: field.key.to_owned(),
            }),
            value: match span {
                Some(span) => self.excerpt(&span),
                None => "its default".to_owned(),
            },
            remedy: remedy.to_string(),
        }
    }
}

/// What a path must lead to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Wanted {
    File,
    Folder,
}

/// Kinds of orbit source.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum OrbitSource {
    Tle,
}

/// What serde says of a name that an enum does not have: the names it has.
#[derive(Debug)]
struct UnknownName(&'static [&'static str]);

impl Display for UnknownName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "must be one of {}", self.0.join(", "))
    }
}

impl std::error::Error for UnknownName {}

impl serde::de::Error for UnknownName {
    fn custom<T: Display>(_: T) -> Self {
        Self(&[])
    }

    fn unknown_variant(_: &str, expected: &'static [&'static str]) -> Self {
        Self(expected)
    }
}

/// The name of an enum's value as a scene writes it.
pub(super) fn written(value: &impl serde::Serialize) -> String {
    match toml::Value::try_from(value) {
        Ok(toml::Value::String(name)) => name,
        Ok(other) => other.to_string(),
        Err(error) => error.to_string(),
    }
}

fn flag(field: &Field<'_, bool>, default: bool) -> bool {
    field.given.map_or(default, |given| *given.get_ref())
}

fn in_range(value: i64, range: &RangeInclusive<i64>) -> Option<u32> {
    u32::try_from(value).ok().filter(|_| range.contains(&value))
}

/// A range in words: "1 to 48".
fn span_of<T: Display>(range: &RangeInclusive<T>) -> String {
    format!("{} to {}", range.start(), range.end()).replace('-', "−")
}

/// A longitude of −360…360 in −180…180, exact where it is there already.
fn half_turn(lon_deg: f64) -> f64 {
    match lon_deg {
        lon if lon > 180.0 => lon - 360.0,
        lon if lon < -180.0 => lon + 360.0,
        lon => lon,
    }
}
