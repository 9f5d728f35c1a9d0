//! The part of the summary that is about satellites.

use super::choices::OrbitSource;
use super::error::printable;
use super::field::written;
use super::keys::RawOrbit;
use super::orbit::{ForceOptions, InitialState, Motion, Orbit, OrbitParameters};
use super::orbit_check::foreign;
use super::record::{KeyText, UNKNOWN, quoted};
use super::time::utc;
use super::tracks::TrackSpan;
use super::{Scene, basilisk, burns, live, tracks};
use glam::DVec3;
use terrella_orbit::kepler::{Anomaly, KeplerElements, OrbitSize};
use terrella_orbit::numerical::AtmosphereModel;

const BUILT_IN: &str = "the space station's elements are built in";

/// The value of a key of a satellite.
pub(super) fn value(orbit: &Orbit, key: &str) -> KeyText {
    let declared = RawOrbit::TABLE.keys.iter().find(|known| known.name == key);
    if let Some(why) = declared.and_then(|known| foreign(orbit.source, known)) {
        return Err(why);
    }
    if tracks::KEYS.contains(&key) {
        return tracks::value(&orbit.track, key);
    }
    match (key, &orbit.motion) {
        ("source", _) => quoted(&written(&orbit.source)),
        (key, _) if orbit.source == OrbitSource::Basilisk => basilisk::value(orbit, key),
        ("name", _) if orbit.live.is_some() && orbit.name.is_none() => {
            Err("it is called as its packets say")
        }
        ("file", _) => {
            let file = orbit.file.as_ref().ok_or(BUILT_IN)?;
            quoted(&file.display().to_string())
        }
        ("strict", _) if orbit.file.is_none() => Err(BUILT_IN),
        ("strict", _) => Ok(orbit.strict.to_string()),
        ("name", _) => match (&orbit.name, &orbit.file) {
            (Some(name), _) => quoted(name),
            (None, Some(_)) => Err("the file's only satellite is taken"),
            (None, None) if orbit.source.is_file() => Err(BUILT_IN),
            (None, None) => Err("it is called by its source"),
        },
        ("j2", Some(Motion::Kepler { j2, .. })) => Ok(j2.to_string()),
        (key, Some(Motion::Kepler { start, .. })) => start_value(start, key),
        (key, Some(Motion::Numerical { start, forces })) => {
            force_value(forces, key).unwrap_or_else(|| start_value(start, key))
        }
        (key, None) => match &orbit.live {
            Some(options) => live::value(options, key),
            None => Err(UNKNOWN),
        },
    }
}

fn force_value(forces: &ForceOptions, key: &str) -> Option<KeyText> {
    Some(match key {
        "gravity_degree" => Ok(forces.gravity_degree.to_string()),
        "gravity_order" => Ok(forces.gravity_order.to_string()),
        "drag" => Ok(forces.drag.is_some().to_string()),
        "air_model" => match forces.drag {
            Some(AtmosphereModel::Standard1976) => quoted("us1976"),
            Some(AtmosphereModel::Exponential) => quoted("exponential"),
            None => Err("only for drag = true"),
        },
        "sun" => Ok(forces.sun.to_string()),
        "moon" => Ok(forces.moon.to_string()),
        "radiation" => Ok(forces.radiation.to_string()),
        "mass_kg" => Ok(forces.craft.mass_kg.to_string()),
        "area_m2" => Ok(forces.craft.drag_area_m2.to_string()),
        "cd" if forces.drag.is_none() => Err("only for drag = true"),
        "cd" => Ok(forces.craft.drag_coefficient.to_string()),
        "cr" if !forces.radiation => Err("only for radiation = true"),
        "cr" => Ok(forces.craft.reflectivity.to_string()),
        "tolerance" => Ok(format!("{:e}", forces.tolerance)),
        "method" => quoted(burns::method_name(forces.method)),
        "burns" => burns::burns_value(&forces.burns),
        "events" => burns::events_value(forces.events),
        _ => return None,
    })
}

fn start_value(start: &InitialState, key: &str) -> KeyText {
    const BY_STATE: &str = "the start is given by position and velocity";
    const BY_ELEMENTS: &str = "the start is given by elements";
    match (key, &start.parameters) {
        ("epoch", _) => quoted(&utc(start.epoch)),
        ("frame", _) => quoted(&start.frame.name().to_lowercase()),
        ("position_km", OrbitParameters::State { position_m, .. }) => Ok(vector_km(*position_m)),
        ("velocity_km_s", OrbitParameters::State { velocity_m_s, .. }) => {
            Ok(vector_km(*velocity_m_s))
        }
        ("position_km" | "velocity_km_s", OrbitParameters::Elements(_)) => Err(BY_ELEMENTS),
        (_, OrbitParameters::State { .. }) => Err(BY_STATE),
        (key, OrbitParameters::Elements(elements)) => element_value(elements, key),
    }
}

fn element_value(elements: &KeplerElements, key: &str) -> KeyText {
    let km = |metres: f64| Ok(rounded(metres / 1e3));
    let degrees = |radians: f64| Ok(rounded(radians.to_degrees()));
    match (key, elements.size, elements.anomaly) {
        ("semi_major_axis_km", OrbitSize::SemiMajorAxis(metres), _) => km(metres),
        ("semi_major_axis_km", ..) => Err("the size is given by the periapsis"),
        ("periapsis_km", OrbitSize::Periapsis(metres), _) => km(metres),
        ("periapsis_km", ..) => Err("the size is given by the semi-major axis"),
        ("eccentricity", ..) => Ok(elements.eccentricity.to_string()),
        ("inclination_deg", ..) => degrees(elements.inclination_rad),
        ("raan_deg", ..) => degrees(elements.raan_rad),
        ("argument_of_periapsis_deg", ..) => degrees(elements.argument_of_periapsis_rad),
        ("true_anomaly_deg", _, Anomaly::True(radians)) => degrees(radians),
        ("true_anomaly_deg", ..) => Err("the place is given by the mean anomaly"),
        ("mean_anomaly_deg", _, Anomaly::Mean(radians)) => degrees(radians),
        ("mean_anomaly_deg", ..) => Err("the place is given by the true anomaly"),
        _ => Err(UNKNOWN),
    }
}

/// Twelve digits: what is left of a number of the scene after it went through other units.
fn rounded(value: f64) -> String {
    let digits: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    digits.to_string()
}

fn vector_km(metres: DVec3) -> String {
    let [x, y, z] = metres.to_array().map(|part| rounded(part / 1e3));
    format!("[{x}, {y}, {z}]")
}

impl Scene {
    /// What each satellite flies by.
    pub(super) fn orbit_uses(&self) -> Vec<(&'static str, String)> {
        self.orbits
            .iter()
            .map(|orbit| ("orbit", flies_by(orbit)))
            .collect()
    }
}

fn flies_by(orbit: &Orbit) -> String {
    let whose = match (&orbit.file, &orbit.name) {
        (None, _) => "the built-in elements of the International Space Station".to_owned(),
        (Some(file), Some(name)) => format!("{} of {}", printable(name), file.display()),
        (Some(file), None) => format!("the only satellite of {}", file.display()),
    };
    let name = |otherwise: &str| printable(orbit.name.as_deref().unwrap_or(otherwise));
    match (orbit.source, &orbit.motion) {
        (OrbitSource::Tle, _) => format!("two-line elements, SGP4: {whose}"),
        (OrbitSource::Omm, _) => format!("orbit mean-elements message, SGP4: {whose}"),
        (OrbitSource::Oem, _) => format!("orbit ephemeris message, interpolated: {whose}"),
        (OrbitSource::Czml, _) => format!("CZML, interpolated: {whose}"),
        (OrbitSource::Csv, _) => format!("CSV, interpolated: {whose}"),
        (OrbitSource::Kepler, Some(Motion::Kepler { j2: true, .. })) => {
            format!("a conic that drifts by J2: {}", name("Kepler"))
        }
        (OrbitSource::Kepler, _) => format!("a conic: {}", name("Kepler")),
        (OrbitSource::Numerical, Some(Motion::Numerical { forces, .. })) => {
            let gravity = match forces.gravity_degree {
                0 | 1 => "the Earth as a point".to_owned(),
                degree => format!("the Earth's gravity to degree {degree}"),
            };
            let others = [
                (forces.sun, "Sun"),
                (forces.moon, "Moon"),
                (forces.drag.is_some(), "drag"),
                (forces.radiation, "sunlight"),
                (!forces.burns.is_empty(), "burns"),
            ];
            let acting = others
                .into_iter()
                .filter(|(on, _)| *on)
                .map(|(_, what)| what);
            let all: Vec<_> = std::iter::once(gravity.as_str()).chain(acting).collect();
            format!("integrated: {}: {}", name("Numerical"), all.join(", "))
        }
        (OrbitSource::Numerical, _) => name("Numerical"),
        (OrbitSource::Live, _) => orbit.live.as_ref().map_or_else(String::new, live::flies_by),
        (OrbitSource::Basilisk, _) => basilisk::flies_by(orbit),
    }
}

impl Scene {
    /// The value of a key of `[tracks]`.
    pub(super) fn tracks_value(&self, key: &str) -> KeyText {
        match key {
            "width_px" => Ok(self.track_px.to_string()),
            key => match self.line("tracks", key) {
                Some(_) => Err("it is told with each satellite"),
                None => Err("each satellite's own"),
            },
        }
    }

    /// What is drawn of each satellite of which anything is.
    pub(super) fn track_uses(&self) -> Vec<(&'static str, String)> {
        let shown = self.orbits.iter().enumerate();
        shown
            .filter(|(_, orbit)| !orbit.track.is_off())
            .map(|(index, orbit)| ("track", track_text(index, orbit)))
            .collect()
    }
}

fn track_text(index: usize, orbit: &Orbit) -> String {
    let track = &orbit.track;
    let span = |name: &str, span: Option<TrackSpan>, usual: &str| {
        span.map(|span| match span {
            TrackSpan::Usual => format!("{name} of {usual}"),
            TrackSpan::Minutes {
                before_min,
                after_min,
            } => format!("{name} from {before_min} min before to {after_min} min after"),
        })
    };
    let footprint = track.footprint.map(|footprint| {
        let tinted = if footprint.fill { ", tinted" } else { "" };
        match footprint.half_angle_deg {
            Some(degrees) => format!("footprint of {degrees}° about straight down{tinted}"),
            None => format!("footprint to the horizon{tinted}"),
        }
    });
    let parts = [
        span("trail", track.trail, "the last revolution"),
        span(
            "ground track",
            track.ground_track,
            "half a revolution to each side",
        ),
        footprint,
        track.subpoint.then(|| "sub-satellite point".to_owned()),
        track.marker.then(|| "marker with its name".to_owned()),
    ];
    let parts: Vec<_> = parts.into_iter().flatten().collect();
    let whose = match &orbit.name {
        Some(name) => printable(name),
        None => format!("satellite {}", index + 1),
    };
    format!("{whose}: {}", parts.join("; "))
}
