//! What is drawn of satellites: keys of `[orbit]`, and `[tracks]` with what holds for all.

use super::error::{SceneError, printable};
use super::field::{Field, range_text};
use super::keys::{RawOrbit, RawTracks, SPAN_MIN};
use super::record::{number_text, quoted};
use super::text::SceneText;
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

/// The satellite's own key, or the one for all. What it comes to is noted with the satellite.
fn own_or<'r, T, R>(own: Field<'r, T, R>, common: Field<'r, T, R>) -> Field<'r, T, R> {
    match own.is_given() {
        true => own,
        false => Field {
            notes: own.notes,
            ..common
        },
    }
}

impl TrackSpan {
    /// As a scene would write it.
    fn text(self) -> String {
        match self {
            Self::Usual => "true".to_owned(),
            Self::Minutes {
                before_min,
                after_min,
            } => format!("{{ before_min = {before_min}, after_min = {after_min} }}"),
        }
    }
}

impl SceneText<'_> {
    /// Checks what is drawn of a satellite.
    pub(super) fn track(&self, orbit: &RawOrbit, tracks: &RawTracks) -> Result<Track, SceneError> {
        let is_on = |own, common| own_or(own, common).is_on();
        Ok(Track {
            color: self.color(&orbit.color())?,
            trail: self.span(&own_or(orbit.trail(), tracks.trail()))?,
            ground_track: self.span(&own_or(orbit.ground_track(), tracks.ground_track()))?,
            footprint: self.footprint(orbit, tracks)?,
            subpoint: is_on(orbit.subpoint(), tracks.subpoint()),
            marker: is_on(orbit.marker(), tracks.marker()),
        })
    }

    /// Checks what holds for all; answers the width of lines, pixels.
    pub(super) fn tracks(
        &self,
        tracks: &RawTracks,
        has_satellites: bool,
    ) -> Result<f64, SceneError> {
        if let Some((key, span)) = tracks.given().next().filter(|_| !has_satellites) {
            let advice = "tracks are of satellites and this scene has none; give it an [orbit] table, or leave [tracks] out";
            return Err(self.reject_at("tracks", key.name, span, advice));
        }
        // Each satellite may have keys of its own: what is common is checked here too.
        self.track(&RawOrbit::default(), tracks)?;
        let width_px = self.number(&tracks.width_px(), |_, range| {
            format!("lines must be from {range} pixels wide")
        })?;
        for (key, span) in tracks.declared() {
            let why = match span {
                Some(_) => "it is reported with each satellite",
                None => "each satellite's own",
            };
            tracks.notes.note(key.name, Err(why));
        }
        Ok(width_px)
    }

    /// A colour, or none where the next of the usual ones is taken.
    pub(super) fn color(&self, field: &Field<'_, String>) -> Result<Option<[u8; 3]>, SceneError> {
        let Some(text) = field.given.map(Spanned::get_ref) else {
            field.note(Err("one of the usual colours, by its place in the scene"));
            return Ok(None);
        };
        self.color_of(field, text).map(Some)
    }

    /// A colour as `text` says it: the value of the key, or its default.
    pub(super) fn color_of(
        &self,
        field: &Field<'_, String>,
        text: &str,
    ) -> Result<[u8; 3], SceneError> {
        let digits = text.strip_prefix('#').filter(|digits| {
            digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit())
        });
        let number = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok());
        let Some(number) = number else {
            let advice =
                "must be \"#\" and six hexadecimal digits, red, green and blue: \"#ffc42e\"";
            return Err(self.reject(field, advice));
        };
        field.note(quoted(&text.to_lowercase()));
        let [_, red, green, blue] = number.to_be_bytes();
        Ok([red, green, blue])
    }

    fn span(&self, field: &Field<'_, toml::Value>) -> Result<Option<TrackSpan>, SceneError> {
        let span = self.span_of(field)?;
        field.note(Ok(span.map_or_else(|| "false".to_owned(), TrackSpan::text)));
        Ok(span)
    }

    fn span_of(&self, field: &Field<'_, toml::Value>) -> Result<Option<TrackSpan>, SceneError> {
        let advice = || {
            format!(
                "must be true, false, or minutes before and after now like {{ before_min = 90, after_min = 45 }}, each from {}",
                range_text(&SPAN_MIN)
            )
        };
        let entries = match field.given.map(Spanned::get_ref) {
            None | Some(toml::Value::Boolean(false)) => return Ok(None),
            Some(toml::Value::Boolean(true)) => return Ok(Some(TrackSpan::Usual)),
            Some(toml::Value::Table(entries)) => entries,
            Some(_) => return Err(self.reject(field, advice())),
        };
        let (mut before_min, mut after_min) = (0.0, 0.0);
        for (key, value) in entries {
            let minutes = match value {
                // Whole minutes: i64 as f64 is exact in the range that is taken.
                toml::Value::Integer(whole) => *whole as f64,
                toml::Value::Float(minutes) => *minutes,
                _ => return Err(self.reject(field, advice())),
            };
            if !SPAN_MIN.contains(&minutes) {
                return Err(self.reject(field, advice()));
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
                    return Err(self.reject(field, advice));
                }
            }
        }
        if before_min + after_min == 0.0 {
            let advice =
                "a span of no time shows nothing; give before_min or after_min, or write false";
            return Err(self.reject(field, advice));
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
        let shown = own_or(orbit.footprint(), tracks.footprint());
        let angle = own_or(
            orbit.sensor_half_angle_deg(),
            tracks.sensor_half_angle_deg(),
        );
        let fill = own_or(orbit.footprint_fill(), tracks.footprint_fill());
        let half_angle_deg = match angle.value() {
            None => None,
            Some(degrees) => Some(self.in_range(&angle, degrees, &angle.rule, |_| {
                format!(
                    "the half angle of the sensor's cone must be from {} degrees",
                    range_text(&angle.rule)
                )
            })?),
        };
        // An angle is given to be seen.
        let is_shown = shown.is_on_or(angle.is_given());
        angle.note(match half_angle_deg {
            _ if !is_shown => Err("only for footprint = true"),
            Some(degrees) => Ok(number_text(degrees)),
            None => Err("all the ground in sight"),
        });
        if !is_shown {
            fill.note(Err("only for footprint = true"));
        }
        let is_meant = |table: &str| !shown.is_given() || shown.table == table;
        if !is_shown && angle.is_given() && is_meant(angle.table) {
            let advice =
                "a sensor's angle has no meaning with footprint = false; leave one of them out";
            return Err(self.reject(&angle, advice));
        }
        if !is_shown && fill.is_on() && is_meant(fill.table) {
            let advice = "footprint_fill tints a footprint and there is none; write footprint = true, or give sensor_half_angle_deg";
            return Err(self.reject(&fill, advice));
        }
        Ok(is_shown.then(|| Footprint {
            half_angle_deg,
            fill: fill.is_on(),
        }))
    }
}
