//! `burns`, `events` and `method` of `[orbit]`: thrusts of a numerical motion, detected events, and the integration method.

use super::error::{SceneError, printable};
use super::field::{Field, range_text};
use super::keys::{BURN_M_S2, BURN_S, MAX_BURNS};
use super::record::KeyText;
use super::text::SceneText;
use super::time::utc;
use glam::DVec3;
use terrella::frames::{Duration, Epoch, utc_from_text};
use terrella_orbit::numerical::{EventSelection, Thrust, ThrustAxes};
use toml::{Spanned, Value};

const KNOWN_KEYS: &str = "a burn has start, duration_s, acceleration_m_s2 and axes";

impl SceneText<'_> {
    /// Checks `burns`.
    pub(super) fn burns(&self, field: &Field<'_, Value>) -> Result<Vec<Thrust>, SceneError> {
        let burns: &[Value] = match field.given.map(Spanned::get_ref) {
            None => &[],
            Some(Value::Array(burns)) => burns,
            Some(_) => {
                let advice = format!("must be a list of burns, [{{ … }}, {{ … }}]; {KNOWN_KEYS}");
                return Err(self.reject(field, advice));
            }
        };
        if burns.len() > MAX_BURNS {
            let advice = format!("a satellite has at most {MAX_BURNS} burns");
            return Err(self.reject(field, advice));
        }
        let numbered = burns.iter().enumerate();
        let read = numbered.map(|(n, value)| {
            burn(value).map_err(|problem| {
                let advice = format!("burn {}: {problem}", n + 1);
                self.reject(field, advice)
            })
        });
        let burns = read.collect::<Result<Vec<_>, _>>()?;
        field.note(burns_text(&burns));
        Ok(burns)
    }

    /// Checks `events`.
    pub(super) fn events(
        &self,
        field: &Field<'_, Vec<String>>,
    ) -> Result<EventSelection, SceneError> {
        let mut selection = EventSelection::default();
        for word in field.given.map(Spanned::get_ref).into_iter().flatten() {
            let on = match word.as_str() {
                "nodes" => &mut selection.nodes,
                "apsides" => &mut selection.apsides,
                "eclipses" => &mut selection.shadow,
                other => {
                    let advice = format!(
                        "{:?} is not an event; the events are \"nodes\", \"apsides\" and \"eclipses\"",
                        printable(other)
                    );
                    return Err(self.reject(field, advice));
                }
            };
            if std::mem::replace(on, true) {
                return Err(self.reject(field, format!("names {word:?} twice")));
            }
        }
        field.note(events_text(selection));
        Ok(selection)
    }
}

fn burn(value: &Value) -> Result<Thrust, String> {
    let Value::Table(entries) = value else {
        return Err(format!("must be a table, {{ start = … }}; {KNOWN_KEYS}"));
    };
    if let Some(key) = entries
        .keys()
        .find(|key| !["start", "duration_s", "acceleration_m_s2", "axes"].contains(&key.as_str()))
    {
        return Err(format!("{KNOWN_KEYS}, not {}", printable(key)));
    }
    let needed = |key: &str| entries.get(key).ok_or_else(|| format!("needs {key}"));
    let first = start(needed("start")?)?;
    let duration_s = number(needed("duration_s")?)
        .filter(|seconds| BURN_S.contains(seconds))
        .ok_or_else(|| {
            let range = super::field::short_range_text(&BURN_S);
            format!("duration_s must be a number of seconds from {range}")
        })?;
    let parts = match needed("acceleration_m_s2")? {
        Value::Array(parts) => parts.iter().map(number).collect::<Option<Vec<_>>>(),
        _ => None,
    };
    let acceleration = match parts.as_deref() {
        Some(&[x, y, z]) if [x, y, z].iter().all(|part| BURN_M_S2.contains(part)) => {
            DVec3::new(x, y, z)
        }
        _ => {
            return Err(format!(
                "acceleration_m_s2 must be three numbers of m/s², [x, y, z], each from {}",
                range_text(&BURN_M_S2)
            ));
        }
    };
    let axes = match entries.get("axes").map(|value| (value, value.as_str())) {
        None | Some((_, Some("flight"))) => ThrustAxes::Flight,
        Some((_, Some("radial"))) => ThrustAxes::Radial,
        Some((_, Some("gcrf"))) => ThrustAxes::Gcrf,
        Some((other, _)) => {
            return Err(format!(
                "axes is {}; it must be \"flight\" (x along the velocity, z along the angular momentum), \"radial\" (x away from the Earth's centre, z likewise) or \"gcrf\"",
                printable(&other.to_string())
            ));
        }
    };
    Ok(Thrust {
        first,
        last: first + Duration::from_seconds(duration_s),
        acceleration_m_s2: acceleration,
        axes,
    })
}

fn start(value: &Value) -> Result<Epoch, String> {
    let text = match value {
        Value::String(text) => text.clone(),
        Value::Datetime(when) => when.to_string(),
        _ => String::new(),
    };
    utc_from_text(&text).map_err(|error| format!("start: {error}"))
}

fn number(value: &Value) -> Option<f64> {
    match value {
        // Numbers in scenes are far inside the exact range of f64.
        Value::Integer(whole) => Some(*whole as f64),
        Value::Float(number) => Some(*number),
        _ => None,
    }
}

/// Burns in scene syntax.
fn burns_text(burns: &[Thrust]) -> KeyText {
    if burns.is_empty() {
        return Err("there are none");
    }
    let texts: Vec<_> = burns
        .iter()
        .map(|burn| {
            let [x, y, z] = burn.acceleration_m_s2.to_array();
            let axes = match burn.axes {
                ThrustAxes::Flight => "flight",
                ThrustAxes::Radial => "radial",
                ThrustAxes::Gcrf => "gcrf",
            };
            format!(
                "{{ start = \"{}\", duration_s = {}, acceleration_m_s2 = [{x}, {y}, {z}], axes = \"{axes}\" }}",
                utc(burn.first),
                (burn.last - burn.first).to_seconds()
            )
        })
        .collect();
    Ok(format!("[{}]", texts.join(", ")))
}

/// Events in scene syntax.
fn events_text(events: EventSelection) -> KeyText {
    let words = [
        (events.nodes, "\"nodes\""),
        (events.apsides, "\"apsides\""),
        (events.shadow, "\"eclipses\""),
    ];
    let words: Vec<_> = words
        .into_iter()
        .filter_map(|(on, word)| on.then_some(word))
        .collect();
    match words.is_empty() {
        true => Err("only the impact is looked for"),
        false => Ok(format!("[{}]", words.join(", "))),
    }
}
