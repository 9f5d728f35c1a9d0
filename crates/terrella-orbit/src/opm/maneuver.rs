//! Manoeuvres of a message.

use super::super::entry::{Entry, Fields, Keys, RecordError, scaled_number};
use super::super::numerical::ThrustAxes;
use super::super::oem::{Axes, TimeSystem};
use crate::Frame;
use glam::DVec3;
use std::path::Path;
use terrella_frames::{Duration, Epoch, Orientation};

/// The key that each manoeuvre begins with.
pub const FIRST_KEY: &str = "MAN_EPOCH_IGNITION";

pub const KEYS: &Keys = &[
    (FIRST_KEY, ""),
    ("MAN_DURATION", "s"),
    ("MAN_DELTA_MASS", "kg"),
    ("MAN_REF_FRAME", ""),
    ("MAN_DV_1", "km/s"),
    ("MAN_DV_2", "km/s"),
    ("MAN_DV_3", "km/s"),
];

/// Burns that are shorter are impulses, seconds.
const SHORTEST_BURN_S: f64 = 1e-3;
/// Largest part of a change of velocity, m/s.
const MOST_M_S: f64 = 1e6;

/// A manoeuvre: an impulsive or a finite change of velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Maneuver {
    /// When it begins.
    pub ignition: Epoch,
    /// How long it lasts; zero for an impulse.
    pub duration: Duration,
    /// Change of velocity, metres per second.
    pub delta_v_m_s: DVec3,
    /// Axes of the change; those of a burn rotate with the satellite's motion.
    pub axes: ThrustAxes,
    /// Change of mass, kilograms; below 0.
    pub delta_mass_kg: f64,
}

impl Maneuver {
    /// Parses the entries of one manoeuvre.
    pub(super) fn of(
        fields: &Fields,
        system: TimeSystem,
        origin: &Path,
    ) -> Result<Self, RecordError> {
        let must = |key| fields.must(key, "", origin);
        let ignition = system.epoch(must(FIRST_KEY)?, origin)?;
        let duration = must("MAN_DURATION")?;
        let seconds = duration.number(origin, 0.0..=1e9, "seconds from 0 to 1e9")?;
        let seconds = if seconds < SHORTEST_BURN_S {
            0.0
        } else {
            seconds
        };
        let delta_mass_kg = match fields.get("MAN_DELTA_MASS") {
            Some(entry) => entry.number(origin, -1e9..=0.0, "kilograms, 0 or below")?,
            None => 0.0,
        };
        let part = |key| {
            let entry = must(key)?;
            scaled_number(&entry.value, 3)
                .filter(|part| part.abs() <= MOST_M_S)
                .ok_or_else(|| entry.wrong(origin, "kilometres per second from -1000 to 1000"))
        };
        let given = DVec3::new(part("MAN_DV_1")?, part("MAN_DV_2")?, part("MAN_DV_3")?);
        let (axes, delta_v_m_s) = turned(must("MAN_REF_FRAME")?, given, ignition, origin)?;
        Ok(Self {
            ignition,
            duration: Duration::from_seconds(seconds),
            delta_v_m_s,
            axes,
            delta_mass_kg,
        })
    }

    /// When it is over.
    pub fn end(&self) -> Epoch {
        self.ignition + self.duration
    }

    /// Whether the velocity changes instantaneously.
    pub fn is_impulse(&self) -> bool {
        self.duration.total_nanoseconds() == 0
    }
}

/// The axes by their name, with the change of velocity in them; one in the axes of a frame is turned to GCRF.
fn turned(
    frame: &Entry<'_>,
    given: DVec3,
    at: Epoch,
    origin: &Path,
) -> Result<(ThrustAxes, DVec3), RecordError> {
    match frame.value.to_ascii_uppercase().as_str() {
        "RTN" | "RSW" | "QSW" | "RIC" | "RTN_ROTATING" | "RSW_ROTATING" => {
            return Ok((ThrustAxes::Radial, given));
        }
        "TNW" | "TNW_ROTATING" => return Ok((ThrustAxes::Flight, given)),
        _ => {}
    }
    let unsupported =
        "known frames of manoeuvres are RTN, RSW, TNW, ICRF, GCRF, EME2000, TEME, TOD and MOD";
    let axes = Axes::from_name(&frame.value).filter(|axes| !axes.frame().is_earth_fixed());
    let axes = axes.ok_or_else(|| frame.unsupported(origin, unsupported))?;
    let given = axes.turn(at).map_or(given, |turn| turn * given);
    let none = Orientation::default();
    let itrf = axes.frame().itrf_from(at, &none) * given;
    let gcrf = Frame::Gcrf.itrf_from(at, &none).transpose() * itrf;
    Ok((ThrustAxes::Gcrf, gcrf))
}
