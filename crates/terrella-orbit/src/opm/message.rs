//! Content of an orbit parameter message.

use super::super::entry::{Entry, Fields, Keys, RecordError, RecordFault, TextPosition};
use super::super::entry::{printable, scaled_number};
use super::super::interpolated::{StateSample, doubts};
use super::super::kepler::{Anomaly, KeplerElements, OrbitSize};
use super::super::numerical::Spacecraft;
use super::super::oem::{Axes, axes_and_time};
use super::Maneuver;
use crate::OrbitState;
use crate::constants::EARTH_GM_M3_S2;
use glam::DVec3;
use std::path::{Path, PathBuf};
use terrella_files::excerpt;
use terrella_frames::Epoch;

/// Keys of a message except those of its manoeuvres. Comments and user-defined keys are skipped.
pub const KEYS: &Keys = &[
    ("OBJECT_NAME", ""),
    ("OBJECT_ID", ""),
    ("CENTER_NAME", ""),
    ("REF_FRAME", ""),
    ("REF_FRAME_EPOCH", ""),
    ("TIME_SYSTEM", ""),
    ("EPOCH", ""),
    ("X", "km"),
    ("Y", "km"),
    ("Z", "km"),
    ("X_DOT", "km/s"),
    ("Y_DOT", "km/s"),
    ("Z_DOT", "km/s"),
    ("SEMI_MAJOR_AXIS", "km"),
    ("ECCENTRICITY", ""),
    ("INCLINATION", "deg"),
    ("RA_OF_ASC_NODE", "deg"),
    ("ARG_OF_PERICENTER", "deg"),
    ("TRUE_ANOMALY", "deg"),
    ("MEAN_ANOMALY", "deg"),
    ("GM", "km**3/s**2"),
    ("MASS", "kg"),
    ("SOLAR_RAD_AREA", "m**2"),
    ("SOLAR_RAD_COEFF", ""),
    ("DRAG_AREA", "m**2"),
    ("DRAG_COEFF", ""),
    ("CX_X", "km**2"),
];

const STATE_KEYS: [&str; 6] = ["X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT"];
/// Elements and state of a message that differ by more than this do not belong together, metres.
const ELEMENTS_AGREE_M: f64 = 1_000.0;

/// A satellite's state from a message, with its manoeuvres and properties.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterMessage {
    /// The satellite's name, or its designator if it has none.
    pub name: String,
    /// The international designator, `1998-067A`.
    pub object_id: Option<String>,
    /// The state; axes of date have been turned to GCRF.
    pub state: OrbitState,
    /// Properties for drag and radiation pressure: areas are 0 if the message lacks them or the mass.
    pub craft: Spacecraft,
    /// Its manoeuvres in order of ignition.
    pub maneuvers: Vec<Maneuver>,
    pub(super) origin: PathBuf,
    pub(super) place: TextPosition,
}

/// Callback for each notice.
pub type Remark<'r> = dyn FnMut(RecordError) -> Result<(), RecordError> + 'r;

impl ParameterMessage {
    /// The line of the file at which it begins, from 1.
    pub fn line(&self) -> usize {
        self.place.line
    }

    /// Parses the entries of a message and of its manoeuvres.
    pub(super) fn of(
        fields: &Fields,
        maneuvers: &[Fields],
        origin: &Path,
        remark: &mut Remark<'_>,
    ) -> Result<Self, RecordError> {
        let must = |key| fields.must(key, "", origin);
        let (name, id) = (must("OBJECT_NAME")?, must("OBJECT_ID")?);
        let (name, id) = (printable(&name.value), printable(&id.value));
        let (axes, system) = axes_and_time(fields, origin)?;
        let epoch = system.epoch(must("EPOCH")?, origin)?;
        let state = state(fields, axes, epoch, origin, remark)?;
        let craft = craft(fields, origin, remark)?;
        let maneuvers = maneuvers
            .iter()
            .map(|maneuver| Maneuver::of(maneuver, system, origin));
        let mut maneuvers = maneuvers.collect::<Result<Vec<_>, _>>()?;
        maneuvers.sort_by_key(|maneuver| maneuver.ignition);
        if let Some(entry) = fields.get("CX_X") {
            let why = "the covariance holds at EPOCH; how the error grows from there is not computed, and none is shown";
            remark(not_followed("CX_X", entry, origin, why))?;
        }
        let sample = StateSample {
            epoch,
            position_m: state.position_m,
            velocity_m_s: Some(state.velocity_m_s),
        };
        for doubt in doubts(state.frame, &[sample]) {
            let place = fields.get("X").map_or(fields.place(), |entry| entry.place);
            remark(place.error(origin, RecordFault::Doubt(doubt)))?;
        }
        Ok(Self {
            name: match name.is_empty() {
                true => id.clone(),
                false => name,
            },
            object_id: (!id.is_empty() && !id.eq_ignore_ascii_case("UNKNOWN")).then_some(id),
            state,
            craft,
            maneuvers,
            origin: origin.to_owned(),
            place: fields.place(),
        })
    }
}

fn not_followed(
    key: &'static str,
    entry: &Entry<'_>,
    origin: &Path,
    why: &'static str,
) -> RecordError {
    let text = excerpt(&entry.value);
    let fault = RecordFault::NotFollowed { key, text, why };
    entry.place.error(origin, fault)
}

/// The state vector, which counts, or else what the elements give.
fn state(
    fields: &Fields,
    axes: Axes,
    epoch: Epoch,
    origin: &Path,
    remark: &mut Remark<'_>,
) -> Result<OrbitState, RecordError> {
    let vector = match STATE_KEYS.iter().any(|key| fields.get(key).is_some()) {
        true => Some(state_vector(fields, origin)?),
        false => None,
    };
    let axis = fields.get("SEMI_MAJOR_AXIS");
    let of_elements = match axis {
        Some(axis) if axes.frame().is_earth_fixed() => {
            let why = "elements are of axes that do not rotate with the Earth";
            match vector {
                Some(_) => remark(not_followed("SEMI_MAJOR_AXIS", axis, origin, why))?,
                None => {
                    let remedy = "elements are of axes that do not rotate with the Earth; give X, Y, Z, X_DOT, Y_DOT, Z_DOT, or another REF_FRAME";
                    return Err(axis.unsupported(origin, remedy));
                }
            }
            None
        }
        Some(_) => Some(state_of_elements(fields, epoch, origin)?),
        None => None,
    };
    let (position_m, velocity_m_s) = match (vector, of_elements) {
        (Some(vector), Some(of_elements)) => {
            if let Some(axis) = axis.filter(|_| vector.0.distance(of_elements.0) > ELEMENTS_AGREE_M)
            {
                let why = "the elements are more than a kilometre from the state of the message, which is used";
                remark(not_followed("SEMI_MAJOR_AXIS", axis, origin, why))?;
            }
            vector
        }
        (Some(one), None) | (None, Some(one)) => one,
        (None, None) => {
            let fault = RecordFault::Missing {
                what: "the message",
                key: "X",
                remedy: "; it needs a state (X, Y, Z, X_DOT, Y_DOT, Z_DOT) or Keplerian elements (SEMI_MAJOR_AXIS, …)",
            };
            return Err(fields.place().error(origin, fault));
        }
    };
    let turned = |vector| axes.turn(epoch).map_or(vector, |turn| turn * vector);
    Ok(OrbitState {
        epoch,
        frame: axes.frame(),
        position_m: turned(position_m),
        velocity_m_s: turned(velocity_m_s),
    })
}

/// Position and velocity, metres and metres per second, in the message's axes.
fn state_vector(fields: &Fields, origin: &Path) -> Result<(DVec3, DVec3), RecordError> {
    let mut numbers = [0.0; 6];
    for (slot, key) in numbers.iter_mut().zip(STATE_KEYS) {
        let entry = fields.must(key, "; a state has six numbers", origin)?;
        *slot = scaled_number(&entry.value, 3).ok_or_else(|| entry.wrong(origin, "a number"))?;
    }
    let [x, y, z, vx, vy, vz] = numbers;
    Ok((DVec3::new(x, y, z), DVec3::new(vx, vy, vz)))
}

/// Likewise, of the elements.
fn state_of_elements(
    fields: &Fields,
    epoch: Epoch,
    origin: &Path,
) -> Result<(DVec3, DVec3), RecordError> {
    let must = |key| fields.must(key, "; Keplerian elements need it", origin);
    let degrees = |key| {
        let entry = must(key)?;
        let turn = entry.number(origin, -360.0..=360.0, "degrees from -360 to 360")?;
        Ok::<f64, RecordError>(turn.to_radians())
    };
    let axis = must("SEMI_MAJOR_AXIS")?;
    let axis_m = scaled_number(&axis.value, 3).ok_or_else(|| axis.wrong(origin, "a number"))?;
    let eccentricity = must("ECCENTRICITY")?;
    let inclination = must("INCLINATION")?;
    let anomaly = match (fields.get("TRUE_ANOMALY"), fields.get("MEAN_ANOMALY")) {
        (Some(_), _) => Anomaly::True(degrees("TRUE_ANOMALY")?),
        (None, Some(_)) => Anomaly::Mean(degrees("MEAN_ANOMALY")?),
        (None, None) => {
            let fault = RecordFault::Missing {
                what: "the message",
                key: "TRUE_ANOMALY",
                remedy: " or MEAN_ANOMALY; Keplerian elements need one of them",
            };
            return Err(fields.place().error(origin, fault));
        }
    };
    let gm_m3_s2 = match fields.get("GM") {
        Some(entry) => {
            let expected = "km³/s² above 0, 398600.4415 for the Earth";
            entry.number(origin, 1e-3..=1e12, expected)? * 1e9
        }
        None => EARTH_GM_M3_S2,
    };
    let elements = KeplerElements {
        size: OrbitSize::SemiMajorAxis(axis_m),
        eccentricity: eccentricity.number(origin, 0.0..=1e6, "a number from 0 to 1e6")?,
        inclination_rad: inclination
            .number(origin, 0.0..=180.0, "degrees from 0 to 180")?
            .to_radians(),
        raan_rad: degrees("RA_OF_ASC_NODE")?,
        argument_of_periapsis_rad: degrees("ARG_OF_PERICENTER")?,
        anomaly,
    };
    let conic = elements.conic(gm_m3_s2, epoch);
    let conic = conic.map_err(|error| axis.place.error(origin, RecordFault::Elements(error)))?;
    Ok(conic.state_after(0.0))
}

/// Mass, areas and coefficients. An area counts only together with its coefficient and the mass.
fn craft(
    fields: &Fields,
    origin: &Path,
    remark: &mut Remark<'_>,
) -> Result<Spacecraft, RecordError> {
    let number = |key| {
        let entry = fields.get(key);
        let number = entry.map(|entry| entry.number(origin, 0.0..=1e11, "a number from 0 to 1e11"));
        number.transpose()
    };
    let mass_kg = number("MASS")?.filter(|mass_kg| *mass_kg > 0.0);
    let mut surface = |area_key, coefficient_key, why| {
        let (area, coefficient) = (number(area_key)?, number(coefficient_key)?);
        match (area, coefficient, mass_kg) {
            (Some(area), Some(coefficient), Some(_)) => Ok((area, coefficient)),
            (Some(area), ..) if area > 0.0 => {
                if let Some(entry) = fields.get(area_key) {
                    remark(not_followed(area_key, entry, origin, why))?;
                }
                Ok((0.0, 0.0))
            }
            _ => Ok((0.0, 0.0)),
        }
    };
    let (drag_area_m2, drag_coefficient) = surface(
        "DRAG_AREA",
        "DRAG_COEFF",
        "drag needs MASS above 0 and DRAG_COEFF beside it; the motion is computed without drag",
    )?;
    let (sunlit_area_m2, reflectivity) = surface(
        "SOLAR_RAD_AREA",
        "SOLAR_RAD_COEFF",
        "the pressure of sunlight needs MASS above 0 and SOLAR_RAD_COEFF beside it; the motion is computed without it",
    )?;
    Ok(Spacecraft {
        mass_kg: mass_kg.unwrap_or(Spacecraft::default().mass_kg),
        drag_area_m2,
        drag_coefficient,
        sunlit_area_m2,
        reflectivity,
    })
}
