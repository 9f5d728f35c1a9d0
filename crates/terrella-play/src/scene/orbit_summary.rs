//! The summary of satellites.

use super::choices::OrbitSource;
use super::error::printable;
use super::orbit::{Motion, Orbit};
use super::track_span::TrackSpan;
use super::{Scene, basilisk, live};

impl Scene {
    /// Description of each satellite's source of motion.
    pub(super) fn orbit_uses(&self) -> Vec<(&'static str, String)> {
        let firsts = self.first_of_tables().into_iter();
        let firsts = firsts.filter_map(|(index, count)| Some((self.orbits.get(index)?, count)));
        firsts
            .map(|(orbit, count)| ("orbit", flies_by(orbit, count)))
            .collect()
    }
}

fn flies_by(orbit: &Orbit, count: usize) -> String {
    let whose = match (&orbit.file, &orbit.name) {
        (Some(file), _) if let Some(many) = &orbit.all => {
            format!("{} of {}: {count}", many.text(), file.display())
        }
        (None, _) => "the built-in elements of the International Space Station".to_owned(),
        (Some(file), Some(name)) => format!("{} of {}", printable(name), file.display()),
        (Some(file), None) => format!("the only satellite of {}", file.display()),
    };
    let name = |otherwise: &str| printable(orbit.name.as_deref().unwrap_or(otherwise));
    match (orbit.source, &orbit.motion) {
        (OrbitSource::Tle, _) => format!("two-line elements, SGP4: {whose}"),
        (OrbitSource::Omm, _) => format!("orbit mean-elements message, SGP4: {whose}"),
        (OrbitSource::Oem, _) => format!("orbit ephemeris message, interpolated: {whose}"),
        (OrbitSource::Opm, _) => format!("orbit parameter message, integrated: {whose}"),
        (OrbitSource::Czml, _) => format!("CZML, interpolated: {whose}"),
        (OrbitSource::Csv, _) => format!("CSV, interpolated: {whose}"),
        (OrbitSource::Sp3, _) => format!("SP3, interpolated: {whose}"),
        (OrbitSource::Stk, _) => format!("STK ephemeris, interpolated: {whose}"),
        (OrbitSource::Kepler, Some(Motion::Kepler { j2: true, .. })) => {
            format!("Keplerian orbit with the drift by J2: {}", name("Kepler"))
        }
        (OrbitSource::Kepler, _) => format!("Keplerian orbit: {}", name("Kepler")),
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
    /// Description of each satellite's drawn track, if any.
    pub(super) fn track_uses(&self) -> Vec<(&'static str, String)> {
        let firsts = self.first_of_tables().into_iter();
        let shown = firsts.filter_map(|(index, _)| Some((index, self.orbits.get(index)?)));
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
    let footprint = track.footprint.map(|footprint| footprint.words());
    let swath = track.footprint.and_then(|footprint| footprint.swath);
    let parts = [
        span("trail", track.trail, "the last revolution"),
        span(
            "ground track",
            track.ground_track,
            "half a revolution to each side",
        ),
        footprint,
        span("swath", swath, "half a revolution to each side"),
        track.subpoint.then(|| "sub-satellite point".to_owned()),
        track.marker.then(|| "marker with its name".to_owned()),
    ];
    let parts: Vec<_> = parts.into_iter().flatten().collect();
    let whose = match &orbit.name {
        _ if let Some(many) = &orbit.all => many.text(),
        Some(name) => printable(name),
        None => format!("satellite {}", index + 1),
    };
    format!("{whose}: {}", parts.join("; "))
}
