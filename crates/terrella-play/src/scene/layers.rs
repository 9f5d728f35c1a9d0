//! `[layers]`: fixed lines and names on the globe.

use super::Scene;
use super::error::{SceneError, printable};
use super::field::{Field, PathKind, range_text};
use super::globe_keys::{GRATICULE_STEP_DEG, PLACE_NAMES, RawLayers};
use super::record::number_text;
use super::text::SceneText;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use toml::Spanned;

/// Default of `step_deg` of `graticule`.
const STEP_DEG: f64 = 10.0;
/// Default maximum of names in an image.
const NAMES: u32 = 60;
/// Default colours.
const GRATICULE_COLOR: &str = "#ffffff";
const COAST_LINES_COLOR: &str = "#fff2c4";
const BORDERS_COLOR: &str = "#ffffff";
const TERMINATOR_COLOR: &str = "#ffb066";
const MOON_SHADOW_COLOR: &str = "#d0b8ff";

/// `[layers]`
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LayersTable {
    /// Degrees from one line of the graticule to the next, and how it is drawn; `None` is none.
    pub graticule: Option<(f64, LineLook)>,
    /// How coast lines are drawn.
    pub coast_lines: Option<LineLook>,
    /// How borders are drawn.
    pub borders: Option<LineLook>,
    /// How the terminator and the ends of twilight are drawn.
    pub terminator: Option<LineLook>,
    /// How the outlines of the Moon's shadow are drawn.
    pub moon_shadow: Option<LineLook>,
    /// Most names of cities in a picture; `None` is none.
    pub place_names: Option<u32>,
    /// Width of these lines, pixels.
    pub width_px: f64,
    /// File of coast lines and borders; `None` is the starter pack's.
    pub vector_map: Option<PathBuf>,
    /// Folder of the starter pack; `None` searches for it. No key of a scene: a host sets it.
    pub folder: Option<PathBuf>,
}

/// Style of lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineLook {
    /// Display values (sRGB).
    pub color: [u8; 3],
    /// Above 0 to 1.
    pub opacity: f64,
}

impl LayersTable {
    /// Whether anything is drawn.
    pub fn is_on(&self) -> bool {
        self.has_lines() || self.place_names.is_some()
    }

    /// Whether lines are drawn.
    fn has_lines(&self) -> bool {
        let own = [self.terminator, self.moon_shadow];
        self.graticule.is_some() || own.iter().any(Option::is_some) || self.needs_vector_map()
    }

    /// Whether layers from the vector map are drawn.
    pub fn needs_vector_map(&self) -> bool {
        self.coast_lines.is_some() || self.borders.is_some()
    }
}

/// A number with a default, as declared by its key.
type Number<'r> = Field<'r, f64, super::field::Bounds<f64>>;

impl SceneText<'_> {
    /// Checks `[layers]`.
    pub(super) fn layers(&self, layers: &RawLayers) -> Result<LayersTable, SceneError> {
        let step_deg = self.graticule(&layers.graticule())?;
        let look = |is_on, color: Field<'_, String>, opacity: Number<'_>, usual, only| {
            self.line_look(is_on, &color, &opacity, usual, only)
        };
        let graticule = look(
            step_deg.is_some(),
            layers.graticule_color(),
            layers.graticule_opacity(),
            GRATICULE_COLOR,
            "only for graticule = true",
        )?;
        let coast_lines = look(
            layers.coast_lines().is_on(),
            layers.coast_lines_color(),
            layers.coast_lines_opacity(),
            COAST_LINES_COLOR,
            "only for coast_lines = true",
        )?;
        let borders = look(
            layers.borders().is_on(),
            layers.borders_color(),
            layers.borders_opacity(),
            BORDERS_COLOR,
            "only for borders = true",
        )?;
        let terminator = look(
            layers.terminator().is_on(),
            layers.terminator_color(),
            layers.terminator_opacity(),
            TERMINATOR_COLOR,
            "only for terminator = true",
        )?;
        let moon_shadow = look(
            layers.moon_shadow().is_on(),
            layers.moon_shadow_color(),
            layers.moon_shadow_opacity(),
            MOON_SHADOW_COLOR,
            "only for moon_shadow = true",
        )?;
        let table = LayersTable {
            terminator,
            moon_shadow,
            graticule: step_deg.zip(graticule),
            coast_lines,
            borders,
            place_names: self.place_names(&layers.place_names())?,
            ..LayersTable::default()
        };
        let (width, vector_map) = (layers.width_px(), layers.vector_map());
        if !table.has_lines() {
            width.note(Err("there are no lines in [layers]"));
        }
        if !table.needs_vector_map() {
            let why = "for coast_lines = true or borders = true";
            self.idle(
                &vector_map,
                why,
                "is for coast_lines = true or borders = true; set one of them, or leave vector_map out",
            )?;
        }
        Ok(LayersTable {
            width_px: self.number(&width, |_, range| {
                format!("lines must be from {range} pixels wide")
            })?,
            vector_map: self.path(&vector_map, PathKind::File, "the starter pack's is taken")?,
            ..table
        })
    }

    fn line_look(
        &self,
        is_on: bool,
        color: &Field<'_, String>,
        opacity: &Number<'_>,
        usual: &str,
        only: &'static str,
    ) -> Result<Option<LineLook>, SceneError> {
        if !is_on {
            let advice = format!("is {only}; write that, or leave this key out");
            self.idle(color, only, &advice)?;
            self.idle(opacity, only, &advice)?;
            return Ok(None);
        }
        let text = color.given.map_or(usual, |given| given.get_ref());
        Ok(Some(LineLook {
            color: self.color_of(color, text)?,
            opacity: self.quantity(opacity)?,
        }))
    }

    /// Maximum names in an image, if names are drawn.
    fn place_names(&self, field: &Field<'_, toml::Value>) -> Result<Option<u32>, SceneError> {
        let names = match field.given.map(Spanned::get_ref) {
            None | Some(toml::Value::Boolean(false)) => None,
            Some(toml::Value::Boolean(true)) => Some(NAMES),
            Some(toml::Value::Integer(most)) if PLACE_NAMES.contains(most) => Some(*most as u32),
            Some(_) => {
                let range = range_text(&PLACE_NAMES);
                let advice = format!(
                    "must be true, false, or the greatest number of names in a picture, {range}"
                );
                return Err(self.reject(field, advice));
            }
        };
        field.note(Ok(names.map_or("false".to_owned(), |most| most.to_string())));
        Ok(names)
    }

    /// Degrees between lines, if lines are drawn.
    fn graticule(&self, field: &Field<'_, toml::Value>) -> Result<Option<f64>, SceneError> {
        let range: &RangeInclusive<f64> = &GRATICULE_STEP_DEG;
        let advice = || {
            format!(
                "must be true, false, or {{ step_deg = 10 }} with degrees from {}",
                range_text(range)
            )
        };
        let step_deg = match field.given.map(Spanned::get_ref) {
            None | Some(toml::Value::Boolean(false)) => None,
            Some(toml::Value::Boolean(true)) => Some(STEP_DEG),
            Some(toml::Value::Table(entries)) => {
                let other = entries.keys().find(|key| *key != "step_deg");
                if let Some(other) = other {
                    let advice = format!(
                        "a graticule has step_deg, not {}; {}",
                        printable(other),
                        advice()
                    );
                    return Err(self.reject(field, advice));
                }
                let step = match entries.get("step_deg") {
                    None => Some(STEP_DEG),
                    // Integer degrees: i64 as f64 is exact in the accepted range.
                    Some(toml::Value::Integer(whole)) => Some(*whole as f64),
                    Some(toml::Value::Float(step)) => Some(*step),
                    Some(_) => None,
                };
                let step = step.filter(|step| range.contains(step));
                Some(step.ok_or_else(|| self.reject(field, advice()))?)
            }
            Some(_) => return Err(self.reject(field, advice())),
        };
        field.note(Ok(match step_deg {
            None => "false".to_owned(),
            Some(step) => format!("{{ step_deg = {} }}", number_text(step)),
        }));
        Ok(step_deg)
    }
}

impl Scene {
    /// Description of the lines on the globe.
    pub(super) fn line_uses(&self) -> Option<(&'static str, String)> {
        let layers = &self.layers;
        let graticule = layers.graticule;
        let parts = [
            graticule.map(|(step_deg, _)| format!("graticule of {step_deg}°")),
            layers.coast_lines.map(|_| "coast lines".to_owned()),
            layers.borders.map(|_| "borders".to_owned()),
        ];
        let parts: Vec<_> = parts.into_iter().flatten().collect();
        let source = match (&layers.vector_map, layers.needs_vector_map()) {
            (_, false) => String::new(),
            (Some(file), true) => format!(" from {}", file.display()),
            (None, true) => " from the starter pack (Natural Earth 1:50 million)".to_owned(),
        };
        let twilight = layers
            .terminator
            .map(|_| "terminator and twilight".to_owned());
        let shadow = layers.moon_shadow.map(|_| "the Moon's shadow".to_owned());
        let mapped = (!parts.is_empty()).then(|| format!("{}{source}", parts.join(", ")));
        let names = layers.place_names;
        let names = names.map(|most| format!("at most {most} place names (GeoNames)"));
        let all: Vec<_> = [twilight, shadow, mapped, names]
            .into_iter()
            .flatten()
            .collect();
        (!all.is_empty()).then(|| ("lines", all.join(", ")))
    }
}
