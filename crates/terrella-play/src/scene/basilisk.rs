//! `[orbit] source = "basilisk"`: a running simulation, or a saved one.

use super::choices::OrbitSource;
use super::error::{SceneError, printable};
use super::field::Field;
use super::orbit::Orbit;
use super::orbit_keys::RawOrbit;
use super::record::quoted;
use super::text::SceneText;
use std::time::Duration;
use terrella_orbit::basilisk::{Endpoint, Meeting, SimulationOptions};

const RUNS_NOT: &str = "is for simulations that run; a file is read as it was saved";
const WAITS_NOT: &str = "is for simulations that wait for an answer; one that publishes does not";

impl SceneText<'_> {
    /// How to connect to a simulation; `None` if a file is read.
    pub(super) fn basilisk(
        &self,
        orbit: &RawOrbit,
        name: Option<&str>,
        is_saved: bool,
    ) -> Result<Option<SimulationOptions>, SceneError> {
        let (listen, subscribe) = (orbit.listen(), orbit.subscribe());
        let publishes = subscribe.is_given();
        if publishes {
            listen.note(Err("the simulation publishes"));
        }
        for (key, span) in orbit.declared() {
            let is_met = key
                .only
                .is_some_and(|only| only.sources.contains(&OrbitSource::Basilisk))
                && key.name != "file";
            let why = match key.name {
                "timeout_s" if publishes => WAITS_NOT,
                _ if is_saved && is_met => RUNS_NOT,
                "listen" if publishes => {
                    "is where simulations connect, subscribe where one publishes; a scene has one of them"
                }
                _ => continue,
            };
            if let Some(span) = span {
                let advice = format!("{} {why}; leave it out", key.name);
                return Err(self.reject_at("orbit", key.name, span, advice));
            }
            orbit.notes.note(key.name, Err(why));
        }
        if is_saved {
            return Ok(None);
        }
        let field = if publishes { &subscribe } else { &listen };
        let endpoint = self.endpoint(field)?.unwrap_or(Endpoint::TWO_WAY);
        let allow_remote = orbit.allow_remote().is_on();
        if endpoint.is_remote() && !allow_remote {
            let advice = "other machines can reach this address and control the image; use 127.0.0.1 or [::1], or set allow_remote = true";
            return Err(self.reject(field, advice));
        }
        field.note(quoted(&endpoint.to_string()));
        if !publishes {
            subscribe.note(Err("the simulation connects"));
        }
        let meeting = match publishes {
            true => Meeting::Subscribe(endpoint),
            false => Meeting::Listen(endpoint),
        };
        let timeout_s = self.quantity(&orbit.timeout_s())?;
        Ok(Some(SimulationOptions {
            craft: name.map(str::to_owned),
            allow_remote,
            // In range: it is finite and not negative.
            timeout: Duration::try_from_secs_f64(timeout_s).unwrap_or_default(),
            stale_after_s: self.quantity(&orbit.stale_after_s())?,
            ..SimulationOptions::new(meeting)
        }))
    }

    fn endpoint(&self, field: &Field<'_, String>) -> Result<Option<Endpoint>, SceneError> {
        let Some(given) = field.given else {
            return Ok(None);
        };
        let endpoint = given.get_ref().parse();
        endpoint.map(Some).map_err(|_| {
            let advice = "must be \"tcp://\" with an IP address or localhost and a port, such as \"tcp://127.0.0.1:5556\", or \"ipc:///path\"";
            self.reject(field, advice)
        })
    }

    /// Rejects a simulation beside other satellites: it supplies all its satellites, and the time.
    pub(super) fn basilisk_alone(
        &self,
        raw: &[RawOrbit],
        orbits: &[Orbit],
    ) -> Result<(), SceneError> {
        let mut all = raw.iter().zip(orbits);
        let simulation = all.find(|(_, orbit)| orbit.source == OrbitSource::Basilisk);
        match simulation {
            Some((orbit, _)) if raw.len() > 1 => {
                let advice = "a simulation brings its own satellites and its own time; leave the other [[orbit]] tables out";
                Err(self.reject(&orbit.source(), advice))
            }
            _ => Ok(()),
        }
    }
}

/// Description of a simulation as the source of motion.
pub(super) fn flies_by(orbit: &Orbit) -> String {
    let craft = match &orbit.name {
        Some(name) => format!("cameras with {}", printable(name)),
        None => "cameras with its first spacecraft".to_owned(),
    };
    match (&orbit.file, &orbit.basilisk) {
        (Some(file), _) => format!("Basilisk, saved in {}, {craft}", file.display()),
        (None, Some(options)) => match &options.meeting {
            Meeting::Listen(endpoint) => {
                format!("a Basilisk simulation that connects to {endpoint}, {craft}")
            }
            Meeting::Subscribe(endpoint) => {
                format!("a Basilisk simulation that publishes on {endpoint}, {craft}")
            }
        },
        (None, None) => craft,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::scene::field::Bounds;
    use std::path::Path;

    #[test]
    fn the_simulation_takes_all_that_the_scene_takes() {
        let orbit = RawOrbit::default();
        let ends = [
            (
                "timeout_s",
                orbit.timeout_s().rule,
                SimulationOptions::TIMEOUTS_S,
            ),
            (
                "stale_after_s",
                orbit.stale_after_s().rule,
                SimulationOptions::STALE_AGES_S,
            ),
        ];
        for (key, Bounds { range, default }, own) in ends {
            assert_eq!(range, own, "{key}");
            for end in [*range.start(), *range.end()] {
                let text = format!("[orbit]\nsource = \"basilisk\"\n{key} = {end}\n");
                let scene = Scene::from_toml(&text, Path::new("scene.toml"));
                let scene = scene.unwrap_or_else(|error| panic!("{error}"));
                assert!(scene.orbits[0].basilisk.is_some());
            }
            let usual = SimulationOptions::new(Meeting::Listen(Endpoint::TWO_WAY));
            let usual = [usual.timeout.as_secs_f64(), usual.stale_after_s];
            assert!(usual.contains(&default), "{key}");
        }
    }
}
