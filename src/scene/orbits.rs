//! `[orbit]`: sources of motion and which keys each takes.

use super::error::SceneError;
use super::field::{Field, Wanted, field, flag, in_range, span_of, written};
use super::limits::*;
use super::live;
use super::locate::Source;
use super::raw::{RawOrbit, RawTracks};
use super::{Forces, Motion, Orbit, OrbitSource, Start, StartForm};
use crate::frames::Epoch;
use crate::orbit::Frame;
use crate::orbit::kepler::{Anomaly, KeplerElements, OrbitSize};
use crate::orbit::numerical::{AtmosphereModel, Spacecraft};
use glam::DVec3;
use serde::Deserialize;
use std::ops::RangeInclusive;
use toml::Spanned;

/// The axes of a start, as a scene writes them.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum FrameName {
    Teme,
    Pef,
    Itrf,
    Gcrf,
    Eme2000,
}

impl From<FrameName> for Frame {
    fn from(name: FrameName) -> Self {
        match name {
            FrameName::Teme => Self::Teme,
            FrameName::Pef => Self::Pef,
            FrameName::Itrf => Self::Itrf,
            FrameName::Gcrf => Self::Gcrf,
            FrameName::Eme2000 => Self::Eme2000,
        }
    }
}

/// The air, as a scene writes it.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum AirModel {
    Us1976,
    Exponential,
}

impl From<AirModel> for AtmosphereModel {
    fn from(model: AirModel) -> Self {
        match model {
            AirModel::Us1976 => Self::Standard1976,
            AirModel::Exponential => Self::Exponential,
        }
    }
}

/// Keys of classical elements.
const ELEMENTS: &[&str] = &[
    "semi_major_axis_km",
    "periapsis_km",
    "eccentricity",
    "inclination_deg",
    "node_deg",
    "argument_deg",
    "true_anomaly_deg",
    "mean_anomaly_deg",
];

/// Keys of a start that is given as a state.
const STATE: &[&str] = &["position_km", "velocity_km_s"];

/// Why a key has no meaning with a source; `None` where it has.
pub(super) fn foreign(source: OrbitSource, key: &str) -> Option<&'static str> {
    let (fits, why) = match key {
        "source" | "name" => (true, ""),
        key if super::tracks::KEYS.contains(&key) => (true, ""),
        "file" | "strict" => (
            source.is_file(),
            "is for sources that are read from files: \"tle\", \"omm\", \"oem\", \"czml\" and \"csv\"",
        ),
        "j2" => (
            source == OrbitSource::Kepler,
            "is for source = \"kepler\"; \"numerical\" takes gravity_degree",
        ),
        key if ["epoch", "frame"].contains(&key)
            || ELEMENTS.contains(&key)
            || STATE.contains(&key) =>
        {
            (
                source.has_start(),
                "is for source = \"kepler\" and \"numerical\", whose start the scene gives",
            )
        }
        key if live::KEYS.contains(&key) => (
            source == OrbitSource::Live,
            "is for source = \"live\", states that a simulator sends",
        ),
        _ => (
            source == OrbitSource::Numerical,
            "is for source = \"numerical\", where forces are integrated",
        ),
    };
    (!fits).then_some(why)
}

impl Source<'_> {
    /// Checks one satellite. `scene_start` is its epoch where it gives none, `tracks` what is drawn of all.
    pub(super) fn orbit(
        &self,
        orbit: &RawOrbit,
        tracks: &RawTracks,
        scene_start: Epoch,
    ) -> Result<Orbit, SceneError> {
        let source_field = field!(orbit.source);
        let source = self.choice(&source_field, OrbitSource::Tle)?;
        for (key, span) in orbit.given() {
            if let Some(why) = foreign(source, key) {
                let advice = format!(
                    "{key} {why}; leave it out, or write another source than \"{}\"",
                    written(&source)
                );
                return Err(self.refuse_at("orbit", key, span, advice));
            }
        }
        let file_field = field!(orbit.file);
        let file = self.path(&file_field, Wanted::File)?;
        let name_field = field!(orbit.name);
        let name = name_field.given.map(|name| name.get_ref().clone());
        if name.as_ref().is_some_and(|name| name.trim().is_empty()) {
            let advice = "must not be empty; give the satellite's name, or leave name out where the file holds one satellite";
            return Err(self.refuse(&name_field, advice));
        }
        if name
            .as_ref()
            .is_some_and(|name| name.contains(char::is_control))
        {
            let advice = "must be one line of text, without control characters";
            return Err(self.refuse(&name_field, advice));
        }
        let strict = field!(orbit.strict);
        if source.is_file() && file.is_none() {
            if source != OrbitSource::Tle {
                let advice = "needs the file to read; add file = \"…\" to [orbit]";
                return Err(self.refuse(&source_field, advice));
            }
            if name.is_some() {
                let advice = "name chooses a satellite of an elements file; add file = \"…\" to [orbit], or leave name out for the built-in space station";
                return Err(self.refuse(&name_field, advice));
            }
            if strict.is_given() {
                let advice = "strict is for files; add file = \"…\" to [orbit], or leave strict out for the built-in space station";
                return Err(self.refuse(&strict, advice));
            }
        }
        let motion = match source {
            OrbitSource::Kepler => Some(Motion::Kepler {
                start: self.orbit_start(orbit, scene_start)?,
                j2: flag(&field!(orbit.j2), false),
            }),
            OrbitSource::Numerical => Some(Motion::Numerical {
                start: self.orbit_start(orbit, scene_start)?,
                forces: self.forces(orbit)?,
            }),
            _ => None,
        };
        if let Some(Motion::Kepler { start, j2: true }) = &motion
            && let StartForm::Elements(elements) = &start.form
            && elements.eccentricity >= 1.0
        {
            let advice = "the drift by J2 is an average over revolutions, which only an eccentricity below 1 has; write false or leave it out";
            return Err(self.refuse(&field!(orbit.j2), advice));
        }
        let live = match source {
            OrbitSource::Live => Some(self.live(orbit, name.as_deref())?),
            _ => None,
        };
        Ok(Orbit {
            source,
            file,
            live,
            name,
            strict: flag(&strict, false),
            motion,
            track: self.track(orbit, tracks)?,
        })
    }

    fn orbit_start(&self, orbit: &RawOrbit, scene_start: Epoch) -> Result<Start, SceneError> {
        let epoch = self.instant(&field!(orbit.epoch), scene_start)?;
        let frame_field = field!(orbit.frame);
        let frame = Frame::from(self.choice(&frame_field, FrameName::Gcrf)?);
        let (position, velocity) = (field!(orbit.position_km), field!(orbit.velocity_km_s));
        let given = orbit.given();
        let form = match (position.is_given(), velocity.is_given()) {
            (false, false) => {
                if frame.is_earth_fixed() {
                    let advice = "elements are of axes that do not turn with the Earth: \"teme\", \"gcrf\" or \"eme2000\"; or give position_km and velocity_km_s";
                    return Err(self.refuse(&frame_field, advice));
                }
                StartForm::Elements(self.elements(orbit)?)
            }
            (true, true) => {
                let element = given.into_iter().find(|(key, _)| ELEMENTS.contains(key));
                if let Some((key, span)) = element {
                    let advice = "a start is given by elements or by position_km and velocity_km_s; leave out the one or the other";
                    return Err(self.refuse_at("orbit", key, span, advice));
                }
                StartForm::State {
                    position_m: self.vector(&position, ORBIT_KM, "kilometres")? * 1e3,
                    velocity_m_s: self.vector(&velocity, SPEED_KM_S, "kilometres per second")?
                        * 1e3,
                }
            }
            (true, false) => {
                return Err(self.refuse(&position, "needs velocity_km_s beside it"));
            }
            (false, true) => {
                return Err(self.refuse(&velocity, "needs position_km beside it"));
            }
        };
        Ok(Start { epoch, frame, form })
    }

    fn elements(&self, orbit: &RawOrbit) -> Result<KeplerElements, SceneError> {
        let (axis, periapsis) = (field!(orbit.semi_major_axis_km), field!(orbit.periapsis_km));
        let eccentricity_field = field!(orbit.eccentricity);
        let eccentricity = self.within(&eccentricity_field, 0.0, ECCENTRICITY, "")?;
        let size = match (axis.is_given(), periapsis.is_given()) {
            (true, true) => {
                let advice = "semi_major_axis_km and periapsis_km both say how large the orbit is; leave one out";
                return Err(self.refuse(&periapsis, advice));
            }
            (false, false) => {
                let advice = "needs a start: semi_major_axis_km or periapsis_km (from the Earth's centre) with the other elements, or position_km and velocity_km_s";
                return Err(self.refuse(&field!(orbit.source), advice));
            }
            (true, false) => {
                let km = self.within(&axis, 0.0, ORBIT_KM, "kilometres")?;
                if eccentricity == 1.0 {
                    let advice =
                        "a parabola (eccentricity 1) has no semi-major axis; give periapsis_km";
                    return Err(self.refuse(&axis, advice));
                }
                if (km > 0.0) != (eccentricity < 1.0) || km == 0.0 {
                    let advice = "must be above 0 with an eccentricity below 1, and below 0 with one above 1";
                    return Err(self.refuse(&axis, advice));
                }
                OrbitSize::SemiMajorAxis(km * 1e3)
            }
            (false, true) => {
                let range = 0.001..=*ORBIT_KM.end();
                OrbitSize::Periapsis(self.within(&periapsis, 0.0, range, "kilometres")? * 1e3)
            }
        };
        let angle = |field: Field<'_, f64>| {
            let degrees = self.within(&field, 0.0, ANGLE_DEG, "degrees")?;
            Ok::<f64, SceneError>(degrees.to_radians())
        };
        let (true_anomaly, mean) = (
            field!(orbit.true_anomaly_deg),
            field!(orbit.mean_anomaly_deg),
        );
        let anomaly = match mean.is_given() {
            true if true_anomaly.is_given() => {
                let advice = "true_anomaly_deg and mean_anomaly_deg both say where on the orbit; leave one out";
                return Err(self.refuse(&mean, advice));
            }
            true if eccentricity == 1.0 => {
                let advice =
                    "a parabola (eccentricity 1) has no mean anomaly; give true_anomaly_deg";
                return Err(self.refuse(&mean, advice));
            }
            true => Anomaly::Mean(angle(mean)?),
            false => Anomaly::True(angle(true_anomaly)?),
        };
        let inclination = field!(orbit.inclination_deg);
        Ok(KeplerElements {
            size,
            eccentricity,
            inclination_rad: self
                .within(&inclination, 0.0, INCLINATION_DEG, "degrees")?
                .to_radians(),
            raan_rad: angle(field!(orbit.node_deg))?,
            argument_of_periapsis_rad: angle(field!(orbit.argument_deg))?,
            anomaly,
        })
    }

    fn forces(&self, orbit: &RawOrbit) -> Result<Forces, SceneError> {
        let degree_field = field!(orbit.gravity_degree);
        let gravity_degree = match degree_field.given.map(|given| *given.get_ref()) {
            None => DEFAULT_GRAVITY_DEGREE,
            Some(degree) => in_range(degree, &GRAVITY_DEGREE).ok_or_else(|| {
                let advice = format!(
                    "the degree of the Earth's gravity must be from {}; 0 is a point",
                    span_of(&GRAVITY_DEGREE)
                );
                self.refuse(&degree_field, advice)
            })?,
        };
        let order_field = field!(orbit.gravity_order);
        let gravity_order = match order_field.given.map(|given| *given.get_ref()) {
            None => gravity_degree,
            Some(order) => in_range(order, &(0..=i64::from(gravity_degree))).ok_or_else(|| {
                let advice = format!(
                    "the order of the Earth's gravity must be from 0, the zonal terms alone, to its degree, {gravity_degree}"
                );
                self.refuse(&order_field, advice)
            })?,
        };
        let (drag, radiation) = (
            flag(&field!(orbit.drag), true),
            flag(&field!(orbit.radiation), true),
        );
        let model = field!(orbit.air_model);
        if !drag && model.is_given() {
            let advice = "air_model has no meaning with drag = false; leave one of them out";
            return Err(self.refuse(&model, advice));
        }
        let model = self.choice(&model, AirModel::Us1976)?;
        let (cd, cr) = (field!(orbit.cd), field!(orbit.cr));
        if !drag && cd.is_given() {
            return Err(self.refuse(
                &cd,
                "cd has no meaning with drag = false; leave one of them out",
            ));
        }
        if !radiation && cr.is_given() {
            let advice = "cr has no meaning with radiation = false; leave one of them out";
            return Err(self.refuse(&cr, advice));
        }
        let usual = Spacecraft::default();
        let area = field!(orbit.area_m2);
        let area_m2 = self.within(&area, usual.drag_area_m2, AREA_M2, "square metres")?;
        Ok(Forces {
            gravity_degree,
            gravity_order,
            drag: drag.then_some(model.into()),
            sun: flag(&field!(orbit.sun), true),
            moon: flag(&field!(orbit.moon), true),
            radiation,
            craft: Spacecraft {
                mass_kg: self.within(
                    &field!(orbit.mass_kg),
                    usual.mass_kg,
                    MASS_KG,
                    "kilograms",
                )?,
                drag_area_m2: area_m2,
                drag_coefficient: self.within(&cd, usual.drag_coefficient, COEFFICIENT, "")?,
                sunlit_area_m2: area_m2,
                reflectivity: self.within(&cr, usual.reflectivity, COEFFICIENT, "")?,
            },
            tolerance: self.within(&field!(orbit.tolerance), DEFAULT_TOLERANCE, TOLERANCE, "")?,
        })
    }

    pub(super) fn within(
        &self,
        field: &Field<'_, f64>,
        default: f64,
        range: RangeInclusive<f64>,
        unit: &str,
    ) -> Result<f64, SceneError> {
        let (least, most) = (*range.start(), *range.end());
        self.number(field, default, range, |_| {
            let words = format!("must be from {} to {} {unit}", short(least), short(most));
            words.trim_end().to_owned()
        })
    }

    fn vector(
        &self,
        field: &Field<'_, Vec<f64>>,
        range: RangeInclusive<f64>,
        unit: &str,
    ) -> Result<DVec3, SceneError> {
        let Some(&[x, y, z]) = field.given.map(Spanned::get_ref).map(Vec::as_slice) else {
            return Err(self.refuse(field, "must be three numbers, [x, y, z]"));
        };
        // A range does not contain a number that is none.
        if ![x, y, z].iter().all(|part| range.contains(part)) {
            let advice = format!(
                "each number must be from {} to {} {unit}",
                short(*range.start()),
                short(*range.end())
            );
            return Err(self.refuse(field, advice));
        }
        Ok(DVec3::new(x, y, z))
    }
}

/// A bound in few characters.
fn short(bound: f64) -> String {
    let text = match bound != 0.0 && !(1e-3..1e6).contains(&bound.abs()) {
        true => format!("{bound:e}"),
        false => bound.to_string(),
    };
    match text.strip_prefix('-') {
        Some(size) => format!("−{size}"),
        None => text,
    }
}
