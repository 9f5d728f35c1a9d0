//! Style properties of features: simplestyle-spec 1.1.0 (github.com/mapbox/simplestyle-spec).

use serde_json::{Map, Value};
use std::ops::RangeInclusive;
use terrella::tracks::FillStyle;

/// Widths that are drawn, pixels; wider lines are as wide as the widest.
const WIDTH_PX: RangeInclusive<f64> = 0.1..=64.0;
/// Properties of the specification that are not drawn: marks are rings.
const NOT_DRAWN: [&str; 3] = ["marker-size", "marker-symbol", "description"];
/// Opacity of a fill if the feature has a fill colour, by the specification.
const FILL_OPACITY: f64 = 0.6;

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeoStyle {
    /// Display values (sRGB).
    pub color: [u8; 3],
    /// 0…1; 0 is not drawn.
    pub opacity: f64,
    /// Pixels; 0 is not drawn.
    pub width_px: f64,
}

/// Style of features without their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UsualStyle {
    pub line: GeoStyle,
    /// Of the filling of polygons, 0…1; 0 is not drawn.
    pub fill_opacity: f64,
}

/// All of a style as one value: lines of the same style are drawn together.
pub(super) type StyleKey = ([u8; 3], u64, u64);

impl GeoStyle {
    pub(super) fn is_drawn(&self) -> bool {
        self.opacity > 0.0 && self.width_px > 0.0
    }

    pub(super) fn key(&self) -> StyleKey {
        let bits = |number: f64| number.to_bits();
        (self.color, bits(self.opacity), bits(self.width_px))
    }
}

/// How a feature is drawn.
pub(super) struct FeatureStyle {
    pub line: GeoStyle,
    /// `None` where a polygon's outline is drawn alone.
    pub fill: Option<FillStyle>,
    pub marker_color: [u8; 3],
}

impl FeatureStyle {
    pub(super) fn usual(usual: UsualStyle) -> Self {
        let UsualStyle { line, fill_opacity } = usual;
        Self {
            line,
            fill: fill(line.color, fill_opacity),
            marker_color: line.color,
        }
    }
}

/// The properties of a feature.
#[derive(Default)]
pub(super) struct Properties(Map<String, Value>);

impl Properties {
    pub(super) fn parse(text: &str) -> serde_json::Result<Self> {
        serde_json::from_str(text).map(Self)
    }

    /// The style, and the properties that are not understood.
    pub(super) fn style(&self, usual: UsualStyle) -> (FeatureStyle, Vec<String>) {
        let UsualStyle {
            line: usual,
            fill_opacity: usual_fill_opacity,
        } = usual;
        let mut faults = Vec::new();
        let stroke = self.color("stroke", &mut faults);
        let marker = self.color("marker-color", &mut faults);
        let opacity = self.number("stroke-opacity", &mut faults);
        let width = self.number("stroke-width", &mut faults);
        let width_px = match width {
            None => usual.width_px,
            Some(0.0) => 0.0,
            Some(width) => width.clamp(*WIDTH_PX.start(), *WIDTH_PX.end()),
        };
        let fill_color = self.color("fill", &mut faults);
        let fill_opacity = self.number("fill-opacity", &mut faults);
        let fill_opacity = match (fill_color, fill_opacity) {
            (_, Some(opacity)) => opacity.min(1.0),
            (Some(_), None) => FILL_OPACITY,
            (None, None) => usual_fill_opacity,
        };
        let style = FeatureStyle {
            fill: fill(fill_color.or(stroke).unwrap_or(usual.color), fill_opacity),
            line: GeoStyle {
                color: stroke.unwrap_or(usual.color),
                opacity: opacity.map_or(usual.opacity, |opacity| opacity.min(1.0)),
                width_px,
            },
            marker_color: marker.unwrap_or(usual.color),
        };
        (style, faults)
    }

    /// The name: by `key`, else the title.
    pub(super) fn name(&self, key: Option<&str>) -> Option<String> {
        let text = match self.0.get(key.unwrap_or("title"))? {
            Value::String(text) => text.trim().to_owned(),
            Value::Number(number) => number.to_string(),
            _ => return None,
        };
        (!text.is_empty()).then_some(text)
    }

    pub(super) fn ignored(&self) -> impl Iterator<Item = &'static str> {
        let names = NOT_DRAWN.into_iter();
        names.filter(|name| self.0.contains_key(*name))
    }

    /// A number that is not negative.
    fn number(&self, key: &str, faults: &mut Vec<String>) -> Option<f64> {
        let value = self.0.get(key).filter(|value| !value.is_null())?;
        let number = value.as_f64().filter(|number| *number >= 0.0);
        if number.is_none() {
            faults.push(format!(
                "{key} is no number of 0 or more; the usual one is taken"
            ));
        }
        number
    }

    /// `#rgb` or `#rrggbb`, the `#` may be missing.
    fn color(&self, key: &str, faults: &mut Vec<String>) -> Option<[u8; 3]> {
        let value = self.0.get(key).filter(|value| !value.is_null())?;
        let color = value.as_str().and_then(color);
        if color.is_none() {
            faults.push(format!(
                "{key} is no colour such as \"#ffc42e\"; the usual one is taken"
            ));
        }
        color
    }
}

fn fill(color: [u8; 3], opacity: f64) -> Option<FillStyle> {
    (opacity > 0.0).then_some(FillStyle { color, opacity })
}

fn color(text: &str) -> Option<[u8; 3]> {
    let digits = text.trim().trim_start_matches('#');
    let digit = |c: char| c.to_digit(16).and_then(|digit| u8::try_from(digit).ok());
    let digits: Option<Vec<_>> = digits.chars().map(digit).collect();
    match digits?.as_slice() {
        [r, g, b] => Some([17 * r, 17 * g, 17 * b]),
        [r1, r0, g1, g0, b1, b0] => Some([16 * r1 + r0, 16 * g1 + g0, 16 * b1 + b0]),
        _ => None,
    }
}
