//! Time spans of trails, ground tracks and swaths.

use super::error::{SceneError, printable};
use super::field::{Field, range_text};
use super::orbit_keys::SPAN_MIN;
use super::text::SceneText;
use toml::Spanned;

/// Time span of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TrackSpan {
    /// Revolutions: the last one for a trail, half of one on each side for a ground track.
    Usual,
    /// A number of minutes.
    Minutes {
        /// Before now.
        before_min: f64,
        /// After now.
        after_min: f64,
    },
}

impl TrackSpan {
    /// The span in scene syntax.
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
    /// Checks a span; `None` means no curve.
    pub(super) fn span(
        &self,
        field: &Field<'_, toml::Value>,
    ) -> Result<Option<TrackSpan>, SceneError> {
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
                // Integer minutes: i64 as f64 is exact in the accepted range.
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
}
