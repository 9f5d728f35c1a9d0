//! Checks `[orbit]`: sources of motion, their keys, initial state and forces.

use super::choices::OrbitSource;
use super::error::SceneError;
use super::field::{Bounds, Field, PathKind, short_range_text, whole, written};
use super::many::Many;
use super::orbit::{ForceOptions, InitialState, Motion, Orbit, OrbitParameters};
use super::orbit_keys::{RawOrbit, RawTracks};
use super::record::{Record, number_text, quoted};
use super::table::Key;
use super::text::SceneText;
use super::time::utc;
use super::walker::Walker;
use glam::DVec3;
use std::ops::RangeInclusive;
use terrella::frames::Epoch;
use terrella_orbit::Frame;
use terrella_orbit::kepler::{Anomaly, KeplerElements, OrbitSize};
use terrella_orbit::numerical::Spacecraft;
use toml::Spanned;

// Why keys of a satellite have no value.
const BUILT_IN: &str = "the space station's elements are built in";
const ONE_OF_MANY: &str = "all says which satellites are flown";
pub(super) const ONLY_OF_FILE: &str = "the file's only satellite is taken";
const BY_ELEMENTS: &str = "the start is given by elements";
const BY_AXIS: &str = "the size is given by the semi-major axis";
const BY_PERIAPSIS: &str = "the size is given by the periapsis";
const BY_MEAN: &str = "the place is given by the mean anomaly";
const BY_TIME: &str = "the place is given by the time at the periapsis";
const BY_TRUE: &str = "the place is given by the true anomaly";
const WITH_DRAG: &str = "only for drag = true";

/// Keys of classical elements.
const ELEMENTS: &[&str] = &[
    "semi_major_axis_km",
    "periapsis_km",
    "eccentricity",
    "inclination_deg",
    "raan_deg",
    "argument_of_periapsis_deg",
    "true_anomaly_deg",
    "mean_anomaly_deg",
];

/// Why a key has no meaning for a source; `None` if it has one.
pub(super) fn foreign(source: OrbitSource, key: &Key) -> Option<&'static str> {
    let only = key.only?;
    (!only.sources.contains(&source)).then_some(only.why)
}

impl SceneText<'_> {
    /// Checks one satellite. `scene_start` is its default epoch; `tracks` holds the drawing options common
    /// to all.
    pub(super) fn orbit(
        &self,
        orbit: &RawOrbit,
        tracks: &RawTracks,
        scene_start: Epoch,
        has_coverage: bool,
    ) -> Result<Orbit, SceneError> {
        let source_field = orbit.source();
        let source = self.choice(&source_field)?;
        for (key, span) in orbit.given() {
            if let Some(why) = foreign(source, key) {
                let advice = format!(
                    "{} {why}; leave it out, or write another source than \"{}\"",
                    key.name,
                    written(&source)
                );
                return Err(self.reject_at("orbit", key.name, span, advice));
            }
        }
        let without = match source {
            OrbitSource::Basilisk => "the simulation runs meanwhile",
            _ => BUILT_IN,
        };
        let file = self.path(&orbit.file(), PathKind::File, without)?;
        let name_field = orbit.name();
        let name = name_field.given.map(|name| name.get_ref().clone());
        if name.as_ref().is_some_and(|name| name.trim().is_empty()) {
            let advice = "must not be empty; give the satellite's name, or leave name out where the file holds one satellite";
            return Err(self.reject(&name_field, advice));
        }
        if name
            .as_ref()
            .is_some_and(|name| name.contains(char::is_control))
        {
            let advice = "must be one line of text, without control characters";
            return Err(self.reject(&name_field, advice));
        }
        name_field.note(match &name {
            Some(name) => quoted(name),
            None => Err(match source {
                OrbitSource::Basilisk => "cameras fly with the simulation's first spacecraft",
                OrbitSource::Live => "it is called as its packets say",
                _ if file.is_some() && orbit.all().is_given() => ONE_OF_MANY,
                _ if file.is_some() => ONLY_OF_FILE,
                _ if source.is_file() => BUILT_IN,
                _ => "it is called by its source",
            }),
        });
        let all = self.many(orbit, source, file.is_some(), name.is_some())?;
        let strict = orbit.strict();
        if file.is_none() {
            strict.note(Err(BUILT_IN));
        }
        if source.is_file() && file.is_none() {
            if source != OrbitSource::Tle {
                let advice = "needs the file to read; add file = \"…\" to [orbit]";
                return Err(self.reject(&source_field, advice));
            }
            if name.is_some() {
                let advice = "name chooses a satellite of an elements file; add file = \"…\" to [orbit], or leave name out for the built-in space station";
                return Err(self.reject(&name_field, advice));
            }
            if strict.is_given() {
                let advice = "strict is for files; add file = \"…\" to [orbit], or leave strict out for the built-in space station";
                return Err(self.reject(&strict, advice));
            }
        }
        let pattern = match source {
            OrbitSource::Kepler => self.walker(orbit)?,
            _ => None,
        };
        let all = pattern.map(Many::Pattern).or(all);
        let motion = match source {
            OrbitSource::Kepler => Some(Motion::Kepler {
                start: self.orbit_start(orbit, scene_start, pattern.as_ref())?,
                j2: orbit.j2().is_on(),
            }),
            OrbitSource::Numerical => Some(Motion::Numerical {
                start: self.orbit_start(orbit, scene_start, None)?,
                forces: self.forces(orbit)?,
            }),
            _ => None,
        };
        if let Some(Motion::Kepler { start, j2: true }) = &motion
            && let OrbitParameters::Elements(elements) = &start.parameters
            && elements.eccentricity >= 1.0
        {
            let advice = "the drift by J2 is an average over revolutions, which only an eccentricity below 1 has; write false or leave it out";
            return Err(self.reject(&orbit.j2(), advice));
        }
        let live = match source {
            OrbitSource::Live => Some(self.live(orbit, name.as_deref())?),
            _ => None,
        };
        let basilisk = match source {
            OrbitSource::Basilisk => self.basilisk(orbit, name.as_deref(), file.is_some())?,
            _ => None,
        };
        Ok(Orbit {
            source,
            file,
            live,
            basilisk,
            name,
            all,
            strict: strict.is_on(),
            motion,
            track: self.track(orbit, tracks, has_coverage)?,
            craft: self.craft(orbit)?,
        })
    }

    fn orbit_start(
        &self,
        orbit: &RawOrbit,
        scene_start: Epoch,
        pattern: Option<&Walker>,
    ) -> Result<InitialState, SceneError> {
        let epoch_field = orbit.epoch();
        let epoch = self.instant(&epoch_field, scene_start)?;
        epoch_field.note(quoted(&utc(epoch)));
        let frame_field = orbit.frame();
        let frame = Frame::from(self.choice(&frame_field)?);
        let (position, velocity) = (orbit.position_km(), orbit.velocity_km_s());
        let parameters = match (position.is_given(), velocity.is_given()) {
            (false, false) => {
                position.note(Err(BY_ELEMENTS));
                velocity.note(Err(BY_ELEMENTS));
                if frame.is_earth_fixed() {
                    let advice = "elements are of axes that do not rotate with the Earth: \"teme\", \"gcrf\" or \"eme2000\"; or give position_km and velocity_km_s";
                    return Err(self.reject(&frame_field, advice));
                }
                OrbitParameters::Elements(match pattern {
                    Some(pattern) => self.walker_elements(orbit, pattern)?,
                    None => self.elements(orbit)?,
                })
            }
            (_, _) if pattern.is_some() => {
                let advice = "walker and position_km both give the orbit; leave one of them out";
                return Err(self.reject(&orbit.walker(), advice));
            }
            (true, true) => {
                let elements = orbit.declared();
                for (key, span) in elements.filter(|(key, _)| ELEMENTS.contains(&key.name)) {
                    if let Some(span) = span {
                        let advice = "a start is given by elements or by position_km and velocity_km_s; leave one of them out";
                        return Err(self.reject_at("orbit", key.name, span, advice));
                    }
                    orbit
                        .notes
                        .note(key.name, Err("the start is given by position and velocity"));
                }
                OrbitParameters::State {
                    position_m: self.vector(&position, "kilometres")? * 1e3,
                    velocity_m_s: self.vector(&velocity, "kilometres per second")? * 1e3,
                }
            }
            (true, false) => {
                return Err(self.reject(&position, "needs velocity_km_s beside it"));
            }
            (false, true) => {
                return Err(self.reject(&velocity, "needs position_km beside it"));
            }
        };
        Ok(InitialState {
            epoch,
            frame,
            parameters,
        })
    }

    fn elements(&self, orbit: &RawOrbit) -> Result<KeplerElements, SceneError> {
        let (axis, periapsis) = (orbit.semi_major_axis_km(), orbit.periapsis_km());
        let eccentricity_field = orbit.eccentricity();
        let eccentricity = self.quantity(&eccentricity_field)?;
        let size = match (axis.given, periapsis.given) {
            (Some(_), Some(_)) => {
                let advice = "semi_major_axis_km and periapsis_km both say how large the orbit is; leave one out";
                return Err(self.reject(&periapsis, advice));
            }
            (None, None) => {
                let advice = "needs a start: semi_major_axis_km or periapsis_km (from the Earth's centre) with the other elements, or position_km and velocity_km_s";
                return Err(self.reject(&orbit.source(), advice));
            }
            (Some(given), None) => {
                let km = self.quantity_or(&axis, *given.get_ref())?;
                periapsis.note(Err(BY_AXIS));
                if eccentricity == 1.0 {
                    let advice =
                        "a parabola (eccentricity 1) has no semi-major axis; give periapsis_km";
                    return Err(self.reject(&axis, advice));
                }
                if (km > 0.0) != (eccentricity < 1.0) || km == 0.0 {
                    let advice = "must be above 0 with an eccentricity below 1, and below 0 with one above 1";
                    return Err(self.reject(&axis, advice));
                }
                OrbitSize::SemiMajorAxis(km * 1e3)
            }
            (None, Some(given)) => {
                axis.note(Err(BY_PERIAPSIS));
                OrbitSize::Periapsis(self.quantity_or(&periapsis, *given.get_ref())? * 1e3)
            }
        };
        let angle = |field: Field<'_, f64, Bounds<f64>>| {
            let degrees = self.quantity(&field)?;
            Ok::<f64, SceneError>(degrees.to_radians())
        };
        let (true_anomaly, mean) = (orbit.true_anomaly_deg(), orbit.mean_anomaly_deg());
        let anomaly = match mean.is_given() {
            true if true_anomaly.is_given() => {
                let advice = "true_anomaly_deg and mean_anomaly_deg both say where on the orbit; leave one out";
                return Err(self.reject(&mean, advice));
            }
            true if eccentricity == 1.0 => {
                let advice =
                    "a parabola (eccentricity 1) has no mean anomaly; give true_anomaly_deg";
                return Err(self.reject(&mean, advice));
            }
            true => {
                true_anomaly.note(Err(BY_MEAN));
                Anomaly::Mean(angle(mean)?)
            }
            false => {
                mean.note(Err(BY_TRUE));
                Anomaly::True(angle(true_anomaly)?)
            }
        };
        Ok(KeplerElements {
            size,
            eccentricity,
            inclination_rad: angle(orbit.inclination_deg())?,
            raan_rad: angle(orbit.raan_deg())?,
            argument_of_periapsis_rad: angle(orbit.argument_of_periapsis_deg())?,
            anomaly,
        })
    }

    fn forces(&self, orbit: &RawOrbit) -> Result<ForceOptions, SceneError> {
        let gravity_degree = self.count(&orbit.gravity_degree(), |range| {
            format!("the degree of the Earth's gravity must be from {range}; 0 is a point")
        })?;
        let order_field = orbit.gravity_order();
        let gravity_order = match order_field.value() {
            None => gravity_degree,
            Some(order) => whole(order, &(0..=i64::from(gravity_degree))).ok_or_else(|| {
                let advice = format!(
                    "the order of the Earth's gravity must be from 0, the zonal terms alone, to its degree, {gravity_degree}"
                );
                self.reject(&order_field, advice)
            })?,
        };
        order_field.note(Ok(gravity_order.to_string()));
        let (drag, radiation) = (orbit.drag().is_on(), orbit.radiation().is_on());
        let model = orbit.air_model();
        if !drag {
            let advice = "air_model has no meaning with drag = false; leave one of them out";
            self.idle(&model, WITH_DRAG, advice)?;
        }
        let model = self.choice(&model)?;
        let (cd, cr) = (orbit.cd(), orbit.cr());
        if !drag {
            let advice = "cd has no meaning with drag = false; leave one of them out";
            self.idle(&cd, WITH_DRAG, advice)?;
        }
        if !radiation {
            let advice = "cr has no meaning with radiation = false; leave one of them out";
            self.idle(&cr, "only for radiation = true", advice)?;
        }
        let area_m2 = self.quantity(&orbit.area_m2())?;
        Ok(ForceOptions {
            gravity_degree,
            gravity_order,
            drag: drag.then_some(model.into()),
            sun: orbit.sun().is_on(),
            moon: orbit.moon().is_on(),
            radiation,
            craft: Spacecraft {
                mass_kg: self.quantity(&orbit.mass_kg())?,
                drag_area_m2: area_m2,
                drag_coefficient: self.quantity(&cd)?,
                sunlit_area_m2: area_m2,
                reflectivity: self.quantity(&cr)?,
            },
            burns: self.burns(&orbit.burns())?,
            tolerance: self.quantity(&orbit.tolerance())?,
            method: self.choice(&orbit.method())?.into(),
            events: self.events(&orbit.events())?,
        })
    }

    fn vector(
        &self,
        field: &Field<'_, Vec<f64>, RangeInclusive<f64>>,
        unit: &str,
    ) -> Result<DVec3, SceneError> {
        let Some(&[x, y, z]) = field.given.map(Spanned::get_ref).map(Vec::as_slice) else {
            return Err(self.reject(field, "must be three numbers, [x, y, z]"));
        };
        // A range never contains NaN.
        if ![x, y, z].iter().all(|part| field.rule.contains(part)) {
            let advice = format!(
                "each number must be from {} {unit}",
                short_range_text(&field.rule)
            );
            return Err(self.reject(field, advice));
        }
        let [x_text, y_text, z_text] = [x, y, z].map(number_text);
        field.note(Ok(format!("[{x_text}, {y_text}, {z_text}]")));
        Ok(DVec3::new(x, y, z))
    }
}

/// Records the key values of a satellite with these elements, which no file gives.
pub(super) fn set_elements(record: &mut Record, elements: &KeplerElements) {
    let km = |metres: f64| Ok(rounded(metres / 1e3));
    let degrees = |radians: f64| Ok(rounded(radians.to_degrees()));
    let (axis, periapsis) = match elements.size {
        OrbitSize::SemiMajorAxis(metres) => (km(metres), Err(BY_AXIS)),
        OrbitSize::Periapsis(metres) => (Err(BY_PERIAPSIS), km(metres)),
    };
    let (true_anomaly, mean_anomaly) = match elements.anomaly {
        Anomaly::True(radians) => (degrees(radians), Err(BY_TRUE)),
        Anomaly::Mean(radians) => (Err(BY_MEAN), degrees(radians)),
        Anomaly::PeriapsisAt(_) => (Err(BY_TIME), Err(BY_TIME)),
    };
    let argument = degrees(elements.argument_of_periapsis_rad);
    for (key, text) in [
        ("semi_major_axis_km", axis),
        ("periapsis_km", periapsis),
        ("eccentricity", Ok(number_text(elements.eccentricity))),
        ("inclination_deg", degrees(elements.inclination_rad)),
        ("raan_deg", degrees(elements.raan_rad)),
        ("argument_of_periapsis_deg", argument),
        ("true_anomaly_deg", true_anomaly),
        ("mean_anomaly_deg", mean_anomaly),
        ("position_km", Err(BY_ELEMENTS)),
        ("velocity_km_s", Err(BY_ELEMENTS)),
    ] {
        record.set(key, text);
    }
}

/// Twelve digits: the precision left after unit conversions.
fn rounded(value: f64) -> String {
    let digits: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    number_text(digits)
}
