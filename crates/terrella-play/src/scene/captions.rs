//! `[[caption]]`: texts and images on top of the output images.

use super::Scene;
use super::caption_keys::{MAX_CAPTIONS, RawCaption};
use super::choices::CaptionPlace;
use super::error::{SceneError, printable};
use super::field::{PathKind, written};
use super::record::quoted;
use super::text::{SceneText, nearest};
use std::path::PathBuf;

/// Why keys of a caption have no value.
pub(super) const NO_CAPTION: &str = "the scene has no [[caption]]";
/// Default text colour.
const COLOR: &str = "#ffffff";
/// Maximum text length, characters.
const MAX_TEXT_CHARS: usize = 1000;

/// A text or an image on top of the output images.
#[derive(Clone, Debug, PartialEq)]
pub struct CaptionTable {
    /// What it shows.
    pub content: CaptionContent,
    /// Where it stands.
    pub place: CaptionPlace,
    /// Of the dark plate behind it, 0…1.
    pub plate_opacity: f64,
    /// When it is shown.
    pub times: CaptionTimes,
}

/// When a caption is shown, in simulated seconds after the scene's start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaptionTimes {
    /// It appears; −∞ without a beginning.
    pub start_s: f64,
    /// It disappears; ∞ without an end.
    pub end_s: f64,
    /// How long it fades in and out, seconds.
    pub fade_s: f64,
}

impl CaptionTimes {
    /// Without beginning and end.
    pub const ALWAYS: Self = Self {
        start_s: f64::NEG_INFINITY,
        end_s: f64::INFINITY,
        fade_s: 0.0,
    };

    /// The opacity at a time, 0…1.
    pub fn opacity(&self, time_s: f64) -> f64 {
        if time_s < self.start_s || time_s >= self.end_s {
            return 0.0;
        }
        if self.fade_s == 0.0 {
            return 1.0;
        }
        let inside_s = (time_s - self.start_s).min(self.end_s - time_s);
        let t = (inside_s / self.fade_s).min(1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

/// Content of a caption.
#[derive(Clone, Debug, PartialEq)]
pub enum CaptionContent {
    /// A text.
    Text {
        /// What it is put together of.
        parts: Vec<CaptionPart>,
        /// Height of letters, pixels; `None` goes by the picture's height.
        size_px: Option<f64>,
        /// Display values (sRGB).
        color: [u8; 3],
    },
    /// An image.
    Image {
        /// A PNG file.
        file: PathBuf,
        /// Width, pixels; `None` is the file's.
        width_px: Option<f64>,
    },
}

/// A segment of a caption's text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CaptionPart {
    /// Constant text.
    Text(String),
    /// A value that changes per image.
    Value(CaptionValue),
}

/// A caption value at the instant of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaptionValue {
    /// Date and time of day, UTC.
    Time,
    /// UTC.
    Date,
    /// Time of day, UTC.
    Clock,
    /// Time since the scene's start.
    Elapsed,
    /// Name of the satellite that the camera follows.
    Satellite,
    /// Geodetic latitude of the satellite, or of the camera without one, degrees.
    Lat,
    /// Longitude of the same object, degrees.
    Lon,
    /// Height of the same object above the ellipsoid, kilometres.
    AltitudeKm,
    /// The satellite's inertial speed, kilometres per second.
    SpeedKmS,
}

impl CaptionValue {
    const ALL: [Self; 9] = [
        Self::Time,
        Self::Date,
        Self::Clock,
        Self::Elapsed,
        Self::Satellite,
        Self::Lat,
        Self::Lon,
        Self::AltitudeKm,
        Self::SpeedKmS,
    ];

    /// The name used inside braces.
    fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Date => "date",
            Self::Clock => "clock",
            Self::Elapsed => "elapsed",
            Self::Satellite => "satellite",
            Self::Lat => "lat",
            Self::Lon => "lon",
            Self::AltitudeKm => "altitude_km",
            Self::SpeedKmS => "speed_km_s",
        }
    }

    /// Whether the value needs a satellite.
    fn needs_satellite(self) -> bool {
        matches!(self, Self::Satellite | Self::SpeedKmS)
    }
}

/// The segments of a text, or the error in it.
fn parts(text: &str) -> Result<Vec<CaptionPart>, String> {
    let mut parts = Vec::new();
    let mut plain = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['{', '}']) {
        plain.push_str(&rest[..at]);
        let brace = &rest[at..];
        let doubled = ["{{", "}}"].into_iter().find(|two| brace.starts_with(two));
        if let Some(two) = doubled {
            plain.push_str(&two[1..]);
            rest = &brace[2..];
            continue;
        }
        let named = brace
            .strip_prefix('{')
            .and_then(|name| name.split_once('}'));
        let Some((name, after)) = named else {
            return Err(
                "has a brace without its other half; write {{ or }} for a brace that is shown"
                    .to_owned(),
            );
        };
        let names = CaptionValue::ALL.map(CaptionValue::name);
        let Some(value) = CaptionValue::ALL
            .into_iter()
            .find(|value| value.name() == name)
        else {
            let hint = match nearest(name, names.iter().copied()) {
                Some(near) => format!("did you mean {{{near}}}? A"),
                None => "a".to_owned(),
            };
            let all = names.map(|name| format!("{{{name}}}")).join(", ");
            let name = printable(name);
            return Err(format!(
                "has the unknown value {{{name}}}; {hint} caption can show {all}"
            ));
        };
        if !plain.is_empty() {
            parts.push(CaptionPart::Text(std::mem::take(&mut plain)));
        }
        parts.push(CaptionPart::Value(value));
        rest = after;
    }
    plain.push_str(rest);
    if !plain.is_empty() {
        parts.push(CaptionPart::Text(plain));
    }
    Ok(parts)
}

impl SceneText<'_> {
    /// Checks all `[[caption]]` tables.
    pub(super) fn captions(
        &self,
        raw: &[RawCaption],
        has_satellites: bool,
    ) -> Result<Vec<CaptionTable>, SceneError> {
        if let Some(caption) = raw.get(MAX_CAPTIONS) {
            let advice = format!(
                "a scene has at most {MAX_CAPTIONS} captions and this one {}; leave some out",
                raw.len()
            );
            return Err(self.reject(&caption.text(), advice));
        }
        let captions = raw.iter();
        captions
            .map(|one| self.caption(one, has_satellites))
            .collect()
    }

    fn caption(&self, raw: &RawCaption, has_satellites: bool) -> Result<CaptionTable, SceneError> {
        let (text, image) = (raw.text(), raw.image());
        let content = match (text.given, image.given) {
            (None, None) => {
                let remedy =
                    "a caption needs its text; add text = \"…\", or image = \"…\" for a logo";
                return Err(self.missing(&text, raw.given(), remedy));
            }
            (Some(_), Some(_)) => {
                let advice = "a caption has a text or an image; write a [[caption]] for each";
                return Err(self.reject(&image, advice));
            }
            (Some(_), None) => self.caption_text(raw, has_satellites)?,
            (None, Some(given)) => self.caption_image(raw, given.get_ref())?,
        };
        Ok(CaptionTable {
            content,
            place: self.choice(&raw.place())?,
            plate_opacity: self.quantity(&raw.plate_opacity())?,
            times: self.caption_times(raw)?,
        })
    }

    fn caption_times(&self, raw: &RawCaption) -> Result<CaptionTimes, SceneError> {
        let (from, until, fade) = (raw.start_s(), raw.end_s(), raw.fade_s());
        let mut times = CaptionTimes::ALWAYS;
        match from.is_given() {
            true => times.start_s = self.quantity_or(&from, 0.0)?,
            false => from.note(Ok("the start".to_owned())),
        }
        match until.is_given() {
            true => times.end_s = self.quantity_or(&until, 0.0)?,
            false => until.note(Ok("the end".to_owned())),
        }
        if times.end_s <= times.start_s {
            let advice = format!("must be more than start_s, {}", times.start_s);
            return Err(self.reject(&until, advice));
        }
        times.fade_s = self.quantity(&fade)?;
        if times.fade_s > 0.0 && !from.is_given() && !until.is_given() {
            let advice =
                "needs start_s or end_s: a caption without them neither appears nor disappears";
            return Err(self.reject(&fade, advice));
        }
        Ok(times)
    }

    fn caption_text(
        &self,
        raw: &RawCaption,
        has_satellites: bool,
    ) -> Result<CaptionContent, SceneError> {
        let field = raw.text();
        let text = field.given.map_or("", |text| text.get_ref().trim());
        if text.is_empty() {
            return Err(self.reject(&field, "must not be empty: it is written over pictures"));
        }
        if text.chars().count() > MAX_TEXT_CHARS {
            let advice = format!("must have at most {MAX_TEXT_CHARS} characters");
            return Err(self.reject(&field, advice));
        }
        let parts = parts(text).map_err(|wrong| self.reject(&field, wrong))?;
        let lacking = parts.iter().find_map(|part| match part {
            CaptionPart::Value(value) if value.needs_satellite() && !has_satellites => Some(value),
            _ => None,
        });
        if let Some(value) = lacking {
            let advice = format!(
                "shows {{{}}} of a satellite and this scene has none; give it an [orbit] table, or leave the value out",
                value.name()
            );
            return Err(self.reject(&field, advice));
        }
        field.note(quoted(text));
        raw.image().note(Err("this caption is a text"));
        let width = raw.width_px();
        let advice = "is for image = \"…\"; size_px is the height of letters";
        self.idle(&width, "only with image", advice)?;
        let (size, color) = (raw.size_px(), raw.color());
        let size_px = match size.is_given() {
            true => Some(self.quantity_or(&size, 0.0)?),
            false => {
                size.note(Ok("3 % of the height".to_owned()));
                None
            }
        };
        let written = color.given.map_or(COLOR, |given| given.get_ref());
        Ok(CaptionContent::Text {
            parts,
            size_px,
            color: self.color_of(&color, written)?,
        })
    }

    fn caption_image(
        &self,
        raw: &RawCaption,
        given: &super::field::RawPath,
    ) -> Result<CaptionContent, SceneError> {
        let (field, width) = (raw.image(), raw.width_px());
        let file = self.existing(&field, given, PathKind::File)?;
        field.note(quoted(&file.display().to_string()));
        raw.text().note(Err("this caption is an image"));
        self.idle(
            &raw.size_px(),
            "only with text",
            "is for text = \"…\"; width_px is the width of an image",
        )?;
        self.idle(
            &raw.color(),
            "only with text",
            "is for text = \"…\"; an image has its own colours",
        )?;
        let width_px = match width.is_given() {
            true => Some(self.quantity_or(&width, 0.0)?),
            false => {
                width.note(Err("the image's own"));
                None
            }
        };
        Ok(CaptionContent::Image { file, width_px })
    }
}

impl Scene {
    /// Descriptions of all captions.
    pub(super) fn caption_uses(&self) -> impl Iterator<Item = (&'static str, String)> {
        self.captions.iter().map(|caption| {
            let what = match &caption.content {
                CaptionContent::Text { .. } => "a text".to_owned(),
                CaptionContent::Image { file, .. } => file.display().to_string(),
            };
            let place = written(&caption.place);
            ("caption", format!("{what} at {place} of the picture"))
        })
    }
}
