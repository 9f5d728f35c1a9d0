//! What is drawn of satellites: keys of `[orbit]`, and `[tracks]` with what holds for all.

use super::error::{SceneError, printable};
use super::field::{Field, field, flag, span_of};
use super::limits::*;
use super::locate::Source;
use super::orbit_summary::Value;
use super::raw::{RawOrbit, RawTracks};
use super::{Orbit, Scene};
use toml::Spanned;

/// What is drawn of one satellite besides the Earth under it. All of it is off where a scene says nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Track {
    /// Display values (sRGB); `None` is the next of the usual ones.
    pub color: Option<[u8; 3]>,
    /// The orbit.
    pub trail: Option<TrackSpan>,
    /// Where it passes overhead.
    pub ground_track: Option<TrackSpan>,
    /// What its sensor sees.
    pub footprint: Option<Footprint>,
    /// A ring where it is overhead.
    pub subpoint: bool,
    /// A dot where it is, with its name.
    pub marker: bool,
}

/// Over what time a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TrackSpan {
    /// By revolutions: a trail's is the last, a ground track's half of one to each side.
    Usual,
    /// So many minutes.
    Minutes {
        /// Before now.
        before_min: f64,
        /// After now.
        after_min: f64,
    },
}

/// The ground that a sensor sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Half angle of its cone about straight down, degrees; `None` is all the ground in sight.
    pub half_angle_deg: Option<f64>,
    /// Whether it is tinted.
    pub fill: bool,
}

impl Track {
    /// Whether nothing is drawn.
    pub fn is_off(&self) -> bool {
        *self
            == Self {
                color: self.color,
                ..Self::default()
            }
    }
}

/// Keys of a satellite that are about its track.
pub(super) const KEYS: &[&str] = &[
    "color",
    "trail",
    "ground_track",
    "marker",
    "subpoint",
    "footprint",
    "sensor_half_angle_deg",
    "footprint_fill",
];

/// The satellite's own key, or the one for all.
fn own_or<'r, T>(own: Field<'r, T>, common: Field<'r, T>) -> Field<'r, T> {
    if own.is_given() { own } else { common }
}

impl Source<'_> {
    /// Checks what is drawn of a satellite.
    pub(super) fn track(&self, orbit: &RawOrbit, tracks: &RawTracks) -> Result<Track, SceneError> {
        let is_on = |own, common| flag(&own_or(own, common), false);
        Ok(Track {
            color: self.color(&field!(orbit.color))?,
            trail: self.span(&own_or(field!(orbit.trail), field!(tracks.trail)))?,
            ground_track: self.span(&own_or(
                field!(orbit.ground_track),
                field!(tracks.ground_track),
            ))?,
            footprint: self.footprint(orbit, tracks)?,
            subpoint: is_on(field!(orbit.subpoint), field!(tracks.subpoint)),
            marker: is_on(field!(orbit.marker), field!(tracks.marker)),
        })
    }

    /// Checks what holds for all; answers the width of lines, pixels.
    pub(super) fn tracks(
        &self,
        tracks: &RawTracks,
        has_satellites: bool,
    ) -> Result<f64, SceneError> {
        if let Some((key, span)) = tracks
            .given()
            .into_iter()
            .next()
            .filter(|_| !has_satellites)
        {
            let advice = "tracks are of satellites and this scene has none; give it an [orbit] table, or leave [tracks] out";
            return Err(self.refuse_at("tracks", key, span, advice));
        }
        // Each satellite may have keys of its own: what is common is checked here too.
        self.track(&RawOrbit::default(), tracks)?;
        self.number(&field!(tracks.width_px), DEFAULT_TRACK_PX, TRACK_PX, |_| {
            format!("lines must be from {} pixels wide", span_of(&TRACK_PX))
        })
    }

    fn color(&self, field: &Field<'_, String>) -> Result<Option<[u8; 3]>, SceneError> {
        let Some(text) = field.given.map(Spanned::get_ref) else {
            return Ok(None);
        };
        let digits = text.strip_prefix('#').filter(|digits| {
            digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit())
        });
        let number = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok());
        let Some(number) = number else {
            let advice =
                "must be \"#\" and six hexadecimal digits, red, green and blue: \"#ffc42e\"";
            return Err(self.refuse(field, advice));
        };
        let [_, red, green, blue] = number.to_be_bytes();
        Ok(Some([red, green, blue]))
    }

    fn span(&self, field: &Field<'_, toml::Value>) -> Result<Option<TrackSpan>, SceneError> {
        let advice = || {
            format!(
                "must be true, false, or minutes before and after now like {{ before_min = 90, after_min = 45 }}, each from {}",
                span_of(&SPAN_MIN)
            )
        };
        let entries = match field.given.map(Spanned::get_ref) {
            None | Some(toml::Value::Boolean(false)) => return Ok(None),
            Some(toml::Value::Boolean(true)) => return Ok(Some(TrackSpan::Usual)),
            Some(toml::Value::Table(entries)) => entries,
            Some(_) => return Err(self.refuse(field, advice())),
        };
        let (mut before_min, mut after_min) = (0.0, 0.0);
        for (key, value) in entries {
            let minutes = match value {
                // Whole minutes: i64 as f64 is exact in the range that is taken.
                toml::Value::Integer(whole) => *whole as f64,
                toml::Value::Float(minutes) => *minutes,
                _ => return Err(self.refuse(field, advice())),
            };
            if !SPAN_MIN.contains(&minutes) {
                return Err(self.refuse(field, advice()));
            }
            match key.as_str() {
                "before_min" => before_min = minutes,
                "after_min" => after_min = minutes,
                other => {
                    let advice = format!(
                        "a span has before_min and after_min, not {}; {}",
                        printable(other),
                        advice()
                    );
                    return Err(self.refuse(field, advice));
                }
            }
        }
        if before_min + after_min == 0.0 {
            let advice =
                "a span of no time shows nothing; give before_min or after_min, or write false";
            return Err(self.refuse(field, advice));
        }
        Ok(Some(TrackSpan::Minutes {
            before_min,
            after_min,
        }))
    }

    fn footprint(
        &self,
        orbit: &RawOrbit,
        tracks: &RawTracks,
    ) -> Result<Option<Footprint>, SceneError> {
        let shown = own_or(field!(orbit.footprint), field!(tracks.footprint));
        let angle = own_or(
            field!(orbit.sensor_half_angle_deg),
            field!(tracks.sensor_half_angle_deg),
        );
        let fill = own_or(field!(orbit.footprint_fill), field!(tracks.footprint_fill));
        let range = SENSOR_HALF_ANGLE_DEG;
        let half_angle_deg = self.number(&angle, *range.end(), range, |_| {
            format!(
                "the half angle of the sensor's cone must be from {} degrees",
                span_of(&SENSOR_HALF_ANGLE_DEG)
            )
        })?;
        // An angle is given to be seen.
        let is_shown = flag(&shown, angle.is_given());
        let is_meant = |table: &str| !shown.is_given() || shown.table == table;
        if !is_shown && angle.is_given() && is_meant(angle.table) {
            let advice =
                "a sensor's angle has no meaning with footprint = false; leave one of them out";
            return Err(self.refuse(&angle, advice));
        }
        if !is_shown && flag(&fill, false) && is_meant(fill.table) {
            let advice = "footprint_fill tints a footprint and there is none; write footprint = true, or give sensor_half_angle_deg";
            return Err(self.refuse(&fill, advice));
        }
        Ok(is_shown.then(|| Footprint {
            half_angle_deg: angle.given.map(|_| half_angle_deg),
            fill: flag(&fill, false),
        }))
    }
}

/// The value of a key as a scene would write it.
pub(super) fn value(track: &Track, key: &str) -> Value {
    let span = |span: Option<TrackSpan>| match span {
        None => "false".to_owned(),
        Some(TrackSpan::Usual) => "true".to_owned(),
        Some(TrackSpan::Minutes {
            before_min,
            after_min,
        }) => format!("{{ before_min = {before_min}, after_min = {after_min} }}"),
    };
    Ok(match key {
        "color" => match track.color {
            Some([red, green, blue]) => format!("\"#{red:02x}{green:02x}{blue:02x}\""),
            None => return Err("one of the usual colours, by its place in the scene"),
        },
        "trail" => span(track.trail),
        "ground_track" => span(track.ground_track),
        "marker" => track.marker.to_string(),
        "subpoint" => track.subpoint.to_string(),
        "footprint" => track.footprint.is_some().to_string(),
        "sensor_half_angle_deg" => match track.footprint {
            None => return Err("only for footprint = true"),
            Some(Footprint {
                half_angle_deg: None,
                ..
            }) => return Err("all the ground in sight"),
            Some(Footprint {
                half_angle_deg: Some(degrees),
                ..
            }) => degrees.to_string(),
        },
        _ => match track.footprint {
            None => return Err("only for footprint = true"),
            Some(footprint) => footprint.fill.to_string(),
        },
    })
}

impl Scene {
    /// The value of a key of `[tracks]`.
    pub(super) fn tracks_value(&self, key: &str) -> Value {
        match key {
            "width_px" => Ok(self.track_px.to_string()),
            key => match self.line("tracks", key) {
                Some(_) => Err("it is told with each satellite"),
                None => Err("each satellite's own"),
            },
        }
    }

    /// What is drawn of each satellite of which anything is.
    pub(super) fn track_uses(&self) -> Vec<(&'static str, String)> {
        let shown = self.orbits.iter().enumerate();
        shown
            .filter(|(_, orbit)| !orbit.track.is_off())
            .map(|(index, orbit)| ("track", words(index, orbit)))
            .collect()
    }
}

fn words(index: usize, orbit: &Orbit) -> String {
    let track = &orbit.track;
    let span = |name: &str, span: Option<TrackSpan>, usual: &str| {
        span.map(|span| match span {
            TrackSpan::Usual => format!("{name} of {usual}"),
            TrackSpan::Minutes {
                before_min,
                after_min,
            } => format!("{name} from {before_min} min before to {after_min} min after"),
        })
    };
    let footprint = track.footprint.map(|footprint| {
        let tinted = if footprint.fill { ", tinted" } else { "" };
        match footprint.half_angle_deg {
            Some(degrees) => format!("footprint of {degrees}° about straight down{tinted}"),
            None => format!("footprint to the horizon{tinted}"),
        }
    });
    let parts = [
        span("trail", track.trail, "the last revolution"),
        span(
            "ground track",
            track.ground_track,
            "half a revolution to each side",
        ),
        footprint,
        track.subpoint.then(|| "sub-satellite point".to_owned()),
        track.marker.then(|| "marker with its name".to_owned()),
    ];
    let parts: Vec<_> = parts.into_iter().flatten().collect();
    let whose = match &orbit.name {
        Some(name) => printable(name),
        None => format!("satellite {}", index + 1),
    };
    format!("{whose}: {}", parts.join("; "))
}
