//! `articulations` of `[orbit]`: moving nodes of the model.

use super::error::{SceneError, printable};
use super::field::{Field, range_text};
use super::record::{KeyText, number_text};
use super::text::SceneText;
use glam::DVec3;
use std::ops::RangeInclusive;
use toml::{Spanned, Value};

/// Maximum moving nodes of one satellite: each is drawn separately.
pub(super) const MAX_ARTICULATIONS: usize = 64;
/// Angles, degrees.
pub(super) const ANGLE_DEG: RangeInclusive<f64> = -360.0..=360.0;
/// Rates, degrees per second: up to a hundred rotations.
pub(super) const RATE_DEG_S: RangeInclusive<f64> = -36_000.0..=36_000.0;
/// Each number of an axis.
pub(super) const AXIS: RangeInclusive<f64> = -1e6..=1e6;
/// Words accepted by `track`.
pub(super) const TRACKED: [&str; 2] = ["sun", "earth"];
/// Maximum length of a node name, characters.
const MAX_NAME_CHARS: usize = 256;
/// Default direction to point at a target: +Z of the node.
const NORMAL: DVec3 = DVec3::Z;

const KNOWN_KEYS: &str =
    "an articulation has node, axis, and angle_deg or rate_deg_s, or track and normal";

/// A node of a model that rotates about an axis through its origin, with all its children.
#[derive(Clone, Debug, PartialEq)]
pub struct Articulation {
    /// Name of the node.
    pub node: String,
    /// In the axes of the node, of any length but 0.
    pub axis: DVec3,
    /// By how much.
    pub turn: ArticulationTurn,
}

/// Rotation of a node, counter-clockwise about its axis, relative to the model's file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArticulationTurn {
    /// Constant rate.
    Even {
        /// At the scene's start, degrees.
        angle_deg: f64,
        /// Degrees a second.
        rate_deg_s: f64,
    },
    /// Points a direction at a target as closely as possible.
    Track {
        /// What that is.
        target: ArticulationTarget,
        /// The direction in the axes of the node, of any length but 0.
        normal: DVec3,
    },
}

/// Target of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArticulationTarget {
    /// The Sun.
    Sun,
    /// The Earth's centre.
    Earth,
}

impl SceneText<'_> {
    /// Checks `articulations`.
    pub(super) fn articulations(
        &self,
        field: &Field<'_, Value>,
    ) -> Result<Vec<Articulation>, SceneError> {
        let given: &[Value] = match field.given.map(Spanned::get_ref) {
            None => &[],
            Some(Value::Array(given)) => given,
            Some(_) => {
                let advice = format!("must be a list of tables, [{{ … }}, {{ … }}]; {KNOWN_KEYS}");
                return Err(self.reject(field, advice));
            }
        };
        if given.len() > MAX_ARTICULATIONS {
            let advice = format!("a satellite has at most {MAX_ARTICULATIONS} articulations");
            return Err(self.reject(field, advice));
        }
        let mut all: Vec<Articulation> = Vec::with_capacity(given.len());
        for (index, value) in given.iter().enumerate() {
            let reject = |problem: String| {
                let advice = format!("articulation {}: {problem}", index + 1);
                self.reject(field, advice)
            };
            let one = articulation(value).map_err(reject)?;
            if all.iter().any(|other| other.node == one.node) {
                let node = printable(&one.node);
                return Err(reject(format!("turns the node {node:?} a second time")));
            }
            all.push(one);
        }
        field.note(text(&all));
        Ok(all)
    }
}

fn articulation(value: &Value) -> Result<Articulation, String> {
    let Value::Table(entries) = value else {
        return Err(format!("must be a table, {{ node = \"…\" }}; {KNOWN_KEYS}"));
    };
    let known = ["node", "axis", "angle_deg", "rate_deg_s", "track", "normal"];
    if let Some(key) = entries.keys().find(|key| !known.contains(&key.as_str())) {
        return Err(format!("{KNOWN_KEYS}, not {}", printable(key)));
    }
    let needed = |key: &str| entries.get(key).ok_or_else(|| format!("needs {key}"));
    let node = match needed("node")? {
        Value::String(node) if !node.is_empty() && node.chars().count() <= MAX_NAME_CHARS => {
            node.clone()
        }
        _ => {
            return Err(format!(
                "node must be the name of a node of the model, of at most {MAX_NAME_CHARS} characters"
            ));
        }
    };
    let axis = direction("axis", needed("axis")?)?;
    let track = match entries.get("track") {
        None => None,
        Some(Value::String(word)) if word == TRACKED[0] => Some(ArticulationTarget::Sun),
        Some(Value::String(word)) if word == TRACKED[1] => Some(ArticulationTarget::Earth),
        Some(_) => return Err("track must be \"sun\" or \"earth\"".to_owned()),
    };
    let normal = entries.get("normal");
    let normal = normal.map(|value| direction("normal", value)).transpose()?;
    let number = |key: &str, range: &RangeInclusive<f64>| {
        let given = entries.get(key).map(|value| {
            let number = number(value).filter(|number| range.contains(number));
            number.ok_or_else(|| format!("{key} must be a number from {}", range_text(range)))
        });
        given.transpose()
    };
    let angle_deg = number("angle_deg", &ANGLE_DEG)?;
    let rate_deg_s = number("rate_deg_s", &RATE_DEG_S)?;
    let turn = match (track, angle_deg.or(rate_deg_s).is_some()) {
        (Some(_), true) => {
            return Err("track says how it turns; leave angle_deg and rate_deg_s out".to_owned());
        }
        (None, false) => return Err("needs angle_deg, rate_deg_s or track".to_owned()),
        (None, true) if normal.is_some() => {
            return Err("normal is what is turned by track; leave it out".to_owned());
        }
        (None, true) => ArticulationTurn::Even {
            angle_deg: angle_deg.unwrap_or(0.0),
            rate_deg_s: rate_deg_s.unwrap_or(0.0),
        },
        (Some(target), false) => ArticulationTurn::Track {
            target,
            normal: normal.unwrap_or(NORMAL),
        },
    };
    if let ArticulationTurn::Track { normal, .. } = turn
        && axis.normalize().cross(normal.normalize()).length() < 1e-6
    {
        return Err("normal lies along axis, about which it does not turn".to_owned());
    }
    Ok(Articulation { node, axis, turn })
}

fn direction(key: &str, value: &Value) -> Result<DVec3, String> {
    let parts = match value {
        Value::Array(parts) => parts.iter().map(number).collect::<Option<Vec<_>>>(),
        _ => None,
    };
    let found = match parts.as_deref() {
        Some(&[x, y, z]) if [x, y, z].iter().all(|part| AXIS.contains(part)) => {
            Some(DVec3::new(x, y, z)).filter(|direction| direction.length() > 1e-9)
        }
        _ => None,
    };
    found.ok_or_else(|| format!("{key} must be three numbers, [x, y, z], not all of them 0"))
}

fn number(value: &Value) -> Option<f64> {
    match value {
        // Numbers in scenes are far inside the exact range of f64.
        Value::Integer(whole) => Some(*whole as f64),
        Value::Float(number) => Some(*number),
        _ => None,
    }
}

/// Articulations in scene syntax.
fn text(all: &[Articulation]) -> KeyText {
    if all.is_empty() {
        return Err("all nodes are as the model's file places them");
    }
    let vector = |vector: DVec3| {
        let numbers = vector.to_array().map(number_text);
        format!("[{}]", numbers.join(", "))
    };
    let texts = all.iter().map(|one| {
        let turn = match one.turn {
            ArticulationTurn::Even {
                angle_deg,
                rate_deg_s,
            } => format!(
                "angle_deg = {}, rate_deg_s = {}",
                number_text(angle_deg),
                number_text(rate_deg_s)
            ),
            ArticulationTurn::Track { target, normal } => {
                let word = match target {
                    ArticulationTarget::Sun => TRACKED[0],
                    ArticulationTarget::Earth => TRACKED[1],
                };
                format!("track = \"{word}\", normal = {}", vector(normal))
            }
        };
        let node = printable(&one.node);
        format!("{{ node = {node:?}, axis = {}, {turn} }}", vector(one.axis))
    });
    Ok(format!("[{}]", texts.collect::<Vec<_>>().join(", ")))
}
