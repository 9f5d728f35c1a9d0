//! `walker` of `[orbit]`: a constellation of circular orbits by its pattern i:T/P/F (Walker 1984).

use super::error::SceneError;
use super::field::short_range_text;
use super::orbit_keys::RawOrbit;
use super::text::SceneText;
use std::f64::consts::TAU;
use terrella::frames::Ellipsoid;
use terrella_orbit::kepler::{Anomaly, KeplerElements, OrbitSize};
use toml::Spanned;

/// Maximum satellites of a pattern.
const MAX_SATELLITES: u32 = 20_000;
/// Why keys of elements have no value.
const BY_PATTERN: &str = "the walker pattern gives the orbit";
/// Keys of elements that a pattern determines.
const GIVEN: [&str; 6] = [
    "semi_major_axis_km",
    "periapsis_km",
    "eccentricity",
    "inclination_deg",
    "argument_of_periapsis_deg",
    "true_anomaly_deg",
];

/// A pattern: T satellites, evenly spaced in P planes of inclination i. The planes are evenly spaced over an arc of the equator. A
/// satellite of the next plane is F · 360°/T ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walker {
    /// i, degrees.
    inclination_deg: f64,
    /// T, P and F.
    satellites: u32,
    planes: u32,
    phasing: u32,
    /// Arc of the ascending nodes, radians: a turn for delta patterns, half of one for stars.
    span_rad: f64,
}

impl Walker {
    /// Parses i:T/P/F.
    fn of_text(text: &str, span_rad: f64) -> Result<Self, &'static str> {
        let form = "must be i:T/P/F, inclination in degrees, number of satellites, of planes, and phasing: \"53:72/6/1\"";
        let parts = text.split_once(':').and_then(|(inclination, rest)| {
            let inclination: f64 = inclination.trim().parse().ok()?;
            let numbers: Result<Vec<u32>, _> =
                rest.split('/').map(|part| part.trim().parse()).collect();
            let [t, p, f] = <[u32; 3]>::try_from(numbers.ok()?).ok()?;
            Some((inclination, t, p, f))
        });
        let Some((inclination_deg, satellites, planes, phasing)) = parts else {
            return Err(form);
        };
        if !(0.0..=180.0).contains(&inclination_deg) {
            return Err("the inclination must be from 0 to 180 degrees");
        }
        if !(1..=MAX_SATELLITES).contains(&satellites) {
            return Err("a pattern has from 1 to 20000 satellites");
        }
        if planes == 0 || !satellites.is_multiple_of(planes) {
            return Err("the number of planes must divide that of satellites");
        }
        if phasing >= planes {
            return Err("the phasing must be from 0 to less than the number of planes");
        }
        Ok(Self {
            inclination_deg,
            satellites,
            planes,
            phasing,
            span_rad,
        })
    }

    /// Number of satellites.
    pub fn count(&self) -> u32 {
        self.satellites
    }

    /// Plane of a satellite and its index in the plane, from 0.
    fn slot(&self, index: u32) -> (u32, u32) {
        let in_plane = self.satellites / self.planes;
        (index / in_plane, index % in_plane)
    }

    /// The name of a satellite: plane and index in it, from 1.
    pub fn name(&self, pattern: &str, index: u32) -> String {
        let (plane, place) = self.slot(index);
        format!("{pattern} {}-{}", plane + 1, place + 1)
    }

    /// The elements of a satellite, computed from those of the first.
    pub fn elements(&self, first: &KeplerElements, index: u32) -> KeplerElements {
        let (plane, place) = self.slot(index);
        let part = |count: u32, of: u32| f64::from(count) / f64::from(of);
        let ahead_rad = match first.anomaly {
            Anomaly::Mean(ahead_rad) | Anomaly::True(ahead_rad) => ahead_rad,
            Anomaly::PeriapsisAt(_) => 0.0,
        };
        let ahead = part(place, self.satellites / self.planes)
            + part(self.phasing * plane, self.satellites);
        KeplerElements {
            raan_rad: first.raan_rad + self.span_rad * part(plane, self.planes),
            // On a circle all anomalies are equal.
            anomaly: Anomaly::Mean((ahead_rad + TAU * ahead).rem_euclid(TAU)),
            ..*first
        }
    }

    /// Description for a summary.
    pub fn text(&self) -> String {
        let Self {
            inclination_deg,
            satellites,
            planes,
            phasing,
            ..
        } = self;
        format!("Walker pattern {inclination_deg}:{satellites}/{planes}/{phasing}")
    }
}

impl SceneText<'_> {
    /// Checks the pattern, if the table has one.
    pub(super) fn walker(&self, orbit: &RawOrbit) -> Result<Option<Walker>, SceneError> {
        let (field, altitude, span) = (orbit.walker(), orbit.altitude_km(), orbit.raan_span_deg());
        let Some(text) = field.given.map(Spanned::get_ref) else {
            let unused = [&altitude.key, &span.key];
            let mut given = orbit.given();
            if let Some((key, place)) = given.find(|(key, _)| unused.contains(&&key.name)) {
                let advice = format!(
                    "{} is for a pattern; give walker, or leave it out",
                    key.name
                );
                return Err(self.reject_at("orbit", key.name, place, advice));
            }
            field.note(Err("one satellite is flown"));
            altitude.note(Err("only with walker"));
            span.note(Err("only with walker"));
            return Ok(None);
        };
        let mut given = orbit.given();
        if let Some((key, place)) = given.find(|(key, _)| GIVEN.contains(&key.name)) {
            let advice = format!(
                "{} and walker both give the orbit; leave one of them out",
                key.name
            );
            return Err(self.reject_at("orbit", key.name, place, advice));
        }
        let span_deg = self.quantity(&span)?;
        let pattern = Walker::of_text(text, span_deg.to_radians())
            .map_err(|advice| self.reject(&field, advice))?;
        field.note(super::record::quoted(text));
        Ok(Some(pattern))
    }

    /// The elements of a pattern's first satellite, on a circle.
    pub(super) fn walker_elements(
        &self,
        orbit: &RawOrbit,
        pattern: &Walker,
    ) -> Result<KeplerElements, SceneError> {
        let altitude = orbit.altitude_km();
        let Some(altitude_km) = altitude.value() else {
            let advice = "needs altitude_km beside it";
            return Err(self.reject(&orbit.walker(), advice));
        };
        let altitude_km = self.in_range(&altitude, altitude_km, &altitude.rule, |_| {
            format!(
                "the altitude must be from {} kilometres",
                short_range_text(&altitude.rule)
            )
        })?;
        altitude.note(Ok(super::record::number_text(altitude_km)));
        for key in GIVEN {
            orbit.notes.note(key, Err(BY_PATTERN));
        }
        let radius_m = Ellipsoid::WGS84.equatorial_radius_m + 1e3 * altitude_km;
        Ok(KeplerElements {
            size: OrbitSize::SemiMajorAxis(radius_m),
            eccentricity: 0.0,
            inclination_rad: pattern.inclination_deg.to_radians(),
            raan_rad: self.quantity(&orbit.raan_deg())?.to_radians(),
            argument_of_periapsis_rad: 0.0,
            anomaly: Anomaly::Mean(self.quantity(&orbit.mean_anomaly_deg())?.to_radians()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn degrees(pattern: &str, span_deg: f64) -> Vec<(f64, f64)> {
        let walker = Walker::of_text(pattern, span_deg.to_radians()).expect("a pattern");
        let first = KeplerElements {
            size: OrbitSize::SemiMajorAxis(7e6),
            eccentricity: 0.0,
            inclination_rad: 1.0,
            raan_rad: 10_f64.to_radians(),
            argument_of_periapsis_rad: 0.0,
            anomaly: Anomaly::Mean(0.0),
        };
        let all = (0..walker.count()).map(|index| {
            let KeplerElements {
                raan_rad, anomaly, ..
            } = walker.elements(&first, index);
            let Anomaly::Mean(ahead) = anomaly else {
                panic!("{anomaly:?}")
            };
            let round = |rad: f64| (rad.to_degrees() * 1e6).round() / 1e6;
            (round(raan_rad), round(ahead))
        });
        all.collect()
    }

    /// Walker's own example of a delta pattern, 6/3/1, and a star of two planes, with nodes and positions
    /// computed by hand.
    #[test]
    fn patterns_have_their_nodes_and_phases() {
        assert_eq!(
            degrees("55:6/3/1", 360.0),
            [
                (10.0, 0.0),
                (10.0, 180.0),
                (130.0, 60.0),
                (130.0, 240.0),
                (250.0, 120.0),
                (250.0, 300.0)
            ]
        );
        assert_eq!(
            degrees("86.4:4/2/0", 180.0),
            [(10.0, 0.0), (10.0, 180.0), (100.0, 0.0), (100.0, 180.0)]
        );
    }

    #[test]
    fn what_is_no_pattern_is_rejected() {
        for (bad, words) in [
            ("", "i:T/P/F"),
            ("53:72/6", "i:T/P/F"),
            ("53:72/6/1/2", "i:T/P/F"),
            ("53:-72/6/1", "i:T/P/F"),
            ("181:72/6/1", "inclination"),
            ("nan:72/6/1", "inclination"),
            ("53:0/6/1", "satellites"),
            ("53:99999/1/0", "satellites"),
            ("53:72/5/1", "divide"),
            ("53:72/0/0", "divide"),
            ("53:72/6/6", "phasing"),
        ] {
            let said = Walker::of_text(bad, TAU).expect_err(bad);
            assert!(said.contains(words), "{bad}: {said}");
        }
    }
}
