//! Drawing options of satellites: keys of `[orbit]`, and `[tracks]` with those common to all.

use super::error::SceneError;
use super::field::{Field, own_or};
use super::footprint::Footprint;
use super::orbit_keys::{RawOrbit, RawTracks};
use super::record::quoted;
use super::text::SceneText;
use super::track_span::TrackSpan;
use terrella_orbit::FieldOfView;
use toml::Spanned;

/// Drawing options of one satellite besides the Earth below it. All are off by default.
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
    /// The field of view of its sensor, drawn or not; `None` is all the ground in sight.
    pub sensor: Option<FieldOfView>,
    /// A ring where it is overhead.
    pub subpoint: bool,
    /// A dot where it is, with its name.
    pub marker: bool,
}

impl Track {
    /// Whether nothing is drawn.
    pub fn is_off(&self) -> bool {
        *self
            == Self {
                color: self.color,
                sensor: self.sensor,
                ..Self::default()
            }
    }
}

impl SceneText<'_> {
    /// Checks the drawing options of a satellite. With a coverage map its sensor counts even if it is not
    /// drawn.
    pub(super) fn track(
        &self,
        orbit: &RawOrbit,
        tracks: &RawTracks,
        has_coverage: bool,
    ) -> Result<Track, SceneError> {
        let (footprint, sensor) = self.footprint(orbit, tracks, has_coverage)?;
        let is_on = |own, common| own_or(own, common).is_on();
        Ok(Track {
            color: self.color(&orbit.color())?,
            trail: self.span(&own_or(orbit.trail(), tracks.trail()))?,
            ground_track: self.span(&own_or(orbit.ground_track(), tracks.ground_track()))?,
            footprint,
            sensor,
            subpoint: is_on(orbit.subpoint(), tracks.subpoint()),
            marker: is_on(orbit.marker(), tracks.marker()),
        })
    }

    /// Checks the options common to all satellites; returns the line width, pixels.
    pub(super) fn tracks(
        &self,
        tracks: &RawTracks,
        has_satellites: bool,
        has_coverage: bool,
    ) -> Result<f64, SceneError> {
        if let Some((key, span)) = tracks.given().next().filter(|_| !has_satellites) {
            let advice = "tracks are of satellites and this scene has none; give it an [orbit] table, or leave [tracks] out";
            return Err(self.reject_at("tracks", key.name, span, advice));
        }
        // Each satellite may have its own keys, so common keys are checked here too.
        self.track(&RawOrbit::default(), tracks, has_coverage)?;
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

    /// A colour, or `None` for the next default colour.
    pub(super) fn color(&self, field: &Field<'_, String>) -> Result<Option<[u8; 3]>, SceneError> {
        let Some(text) = field.given.map(Spanned::get_ref) else {
            field.note(Err("one of the usual colours, by its place in the scene"));
            return Ok(None);
        };
        self.color_of(field, text).map(Some)
    }

    /// Parses `text` as a colour: the value of the key, or its default.
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
}
