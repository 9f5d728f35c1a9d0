//! Declares the keys of `[[caption]]`, as [`keys`](super::keys) does those of the other tables.

use super::choices::CaptionPlace;
use super::field::{Bounds, Choice, Field, RawPath};
use super::record::{Notes, Record};
#[cfg(test)]
use super::table::About;
use super::table::{Key, Only, Table, Value, given_or, method, table};
use super::text::SceneText;
use serde::Deserialize;
#[cfg(test)]
use serde_json::json;
use std::ops::{Range, RangeInclusive};
use toml::Spanned;

/// Maximum number of captions, `[[caption]]` tables, in one scene.
pub(super) const MAX_CAPTIONS: usize = 32;
/// Height of letters, and width of images, pixels.
const SIZE_PX: RangeInclusive<f64> = 6.0..=200.0;
/// As the times of camera keyframes.
const TIME_S: RangeInclusive<f64> = -1e9..=1e9;
const WIDTH_PX: RangeInclusive<f64> = 1.0..=4096.0;

const fn only(why: &'static str) -> Only {
    Only { why, sources: &[] }
}
const TEXT: &Only = &only("only with text");
const IMAGE: &Only = &only("only with image");

table!(RawCaption = "caption" {
    /// The text. A value in braces is that of each picture: {time}, {date}, {clock}, {elapsed}, {satellite}, {lat}, {lon}, {altitude_km}, {speed_km_s}; {{ and }} are braces. Position and altitude are the satellite's, in a scene without one the camera's. Long lines are wrapped.
    text: String, of "a string, the caption's text";
    /// An image in place of text, such as a logo.
    image: RawPath, of "a PNG file";
    /// Where it stands. Captions of one place stand below each other, in the scene's order.
    place: Choice<CaptionPlace>, default CaptionPlace::BottomLeft;
    /// Height of the letters. By default 3 % of the picture's height.
    size_px: f64, of "pixels", in SIZE_PX, for TEXT;
    /// Colour of the text. By default "#ffffff".
    color: String, of "a string, \"#\" and six hexadecimal digits", for TEXT;
    /// Opacity of the dark plate behind it; 0 is no plate.
    plate_opacity: f64, in 0.0..=1.0, default 0.5;
    /// Width of the image. By default its own.
    width_px: f64, of "pixels", in WIDTH_PX, for IMAGE;
    /// When it appears, in simulated seconds after the scene's start. By default it is there from the start.
    start_s: f64, of "seconds after the scene's start", in TIME_S;
    /// When it disappears. By default it stays.
    end_s: f64, of "seconds after the scene's start", in TIME_S;
    /// How long it fades in after start_s, and out before end_s, in simulated seconds.
    fade_s: f64, of "seconds", in 0.0..=1e9, default 0.0;
});
