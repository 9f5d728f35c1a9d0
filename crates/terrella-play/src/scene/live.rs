//! `[orbit] source = "live"`: states sent by a simulator, and sharing rules for several of them.

use super::error::{SceneError, printable};
use super::field::{Bounds, Field};
use super::keys::{MAX_LIVE_ORBITS, MAX_ORIGINS};
use super::orbit::Orbit;
use super::orbit_keys::RawOrbit;
use super::record::{list_text, quoted};
use super::text::SceneText;
use std::time::Duration;
use terrella_orbit::live::{Extrapolation, LiveOptions, Pacing, Transport};

impl SceneText<'_> {
    /// Options for receiving the states of one satellite.
    pub(super) fn live(
        &self,
        orbit: &RawOrbit,
        name: Option<&str>,
    ) -> Result<LiveOptions, SceneError> {
        let listen = orbit.listen();
        let Some(given) = listen.given else {
            let advice = "needs a place to listen on; add listen = \"tcp://127.0.0.1:5005\", or \"udp://…\", \"ws://…\" or \"stdin\"";
            return Err(self.reject(&orbit.source(), advice));
        };
        let transport: Transport = given.get_ref().parse().map_err(|_| {
            let advice = "must be \"stdin\", or \"tcp://\", \"udp://\" or \"ws://\" with an IP address and a port, such as \"tcp://127.0.0.1:5005\"";
            self.reject(&listen, advice)
        })?;
        let usual = LiveOptions::new(transport);
        let pacing = self.choice(&orbit.pacing())?;
        self.live_keys_fit(orbit, &usual.transport, pacing)?;
        let allow_remote = orbit.allow_remote().is_on();
        let is_remote = |transport: &Transport| {
            let address = transport.address();
            address.is_some_and(|address| !address.ip().is_loopback())
        };
        if is_remote(&usual.transport) && !allow_remote {
            let advice = "other machines can reach this address and control the image; use 127.0.0.1 or [::1], or set allow_remote = true";
            return Err(self.reject(&listen, advice));
        }
        listen.note(quoted(&usual.transport.to_string()));
        let seconds = |field: Field<'_, f64, Bounds<f64>>| {
            let Bounds { range, default } = &field.rule;
            self.quantity_in(&field, range, *default, "seconds")
        };
        let timeout_s = seconds(orbit.timeout_s())?;
        let max_packets_per_s = self.count(&orbit.packets_per_s(), |range| {
            format!("must be from {range} packets per second")
        })?;
        Ok(LiveOptions {
            pacing,
            name: name.map_or(usual.name, str::to_owned),
            allow_remote,
            allowed_origins: self.origins(&orbit.allowed_origins())?,
            rate: self.quantity(&orbit.rate())?,
            playback_delay_s: seconds(orbit.playback_delay_s())?,
            stale_after_s: seconds(orbit.stale_after_s())?,
            extrapolation_limit_s: seconds(orbit.extrapolate_s())?,
            extrapolation: self.choice(&orbit.extrapolation())?,
            gap_s: seconds(orbit.gap_s())?,
            // In range: it is finite and not negative.
            frame_timeout: Duration::try_from_secs_f64(timeout_s).unwrap_or_default(),
            max_packets_per_s,
            transport: usual.transport,
        })
    }

    /// Rejects keys without meaning for the transport or the pacing.
    fn live_keys_fit(
        &self,
        orbit: &RawOrbit,
        transport: &Transport,
        pacing: Pacing,
    ) -> Result<(), SceneError> {
        for (key, span) in orbit.declared() {
            let Some(why) = idle(transport, pacing, key.name) else {
                continue;
            };
            if let Some(span) = span {
                return Err(self.reject_at(
                    "orbit",
                    key.name,
                    span,
                    format!("{} {why}; leave it out", key.name),
                ));
            }
            orbit.notes.note(key.name, Err(why));
        }
        Ok(())
    }

    fn origins(&self, field: &Field<'_, Vec<String>>) -> Result<Vec<String>, SceneError> {
        let origins = field
            .given
            .map(|given| given.get_ref().clone())
            .unwrap_or_default();
        if origins.len() > MAX_ORIGINS {
            let advice = format!("must be at most {MAX_ORIGINS} web pages");
            return Err(self.reject(field, advice));
        }
        let is_origin = |origin: &String| {
            let host = ["http://", "https://"]
                .iter()
                .find_map(|scheme| origin.strip_prefix(scheme));
            host.is_some_and(|host| {
                let is_plain = |c: char| c.is_ascii_graphic() && c != '/';
                !host.is_empty() && host.chars().all(is_plain)
            })
        };
        match origins.iter().all(is_origin) {
            true => {
                field.note(Ok(list_text(origins.iter())));
                Ok(origins)
            }
            false => {
                let advice = "must be web pages as browsers name them, scheme and host without a path, like \"https://example.org\"";
                Err(self.reject(field, advice))
            }
        }
    }

    /// Rejects live satellites that cannot share a scene: two on one port or on standard input, two waiting
    /// simulators, or too many.
    pub(super) fn live_together(
        &self,
        raw: &[RawOrbit],
        orbits: &[Orbit],
    ) -> Result<(), SceneError> {
        let live = || {
            let pairs = raw.iter().zip(orbits);
            pairs.filter_map(|(raw, orbit)| Some((raw, orbit.live.as_ref()?)))
        };
        if let Some((orbit, _)) = live().nth(MAX_LIVE_ORBITS) {
            let advice = format!(
                "a scene has at most {MAX_LIVE_ORBITS} satellites whose states are sent; leave some out"
            );
            return Err(self.reject(&orbit.source(), advice));
        }
        for (index, (orbit, options)) in live().enumerate() {
            let before = || live().take(index).map(|(_, before)| before);
            if before().any(|before| before.transport.collides_with(&options.transport)) {
                let advice = match options.transport {
                    Transport::Stdin => {
                        "there is one standard input, and a satellite before this one reads it; give this one a port, such as \"udp://127.0.0.1:5006\""
                    }
                    _ => "a satellite before this one listens there; give this one another port",
                };
                return Err(self.reject(&orbit.listen(), advice));
            }
            let waits = |options: &LiveOptions| options.pacing == Pacing::Lockstep;
            if waits(options) && before().any(waits) {
                let advice = "a picture is of one instant, and the simulator of a satellite before this one says which; write \"broadcast\" here";
                return Err(self.reject(&orbit.pacing(), advice));
            }
        }
        Ok(())
    }
}

/// Why a key has no effect with the transport or the pacing; `None` if it has one.
fn idle(transport: &Transport, pacing: Pacing, key: &str) -> Option<&'static str> {
    let is_lockstep = pacing == Pacing::Lockstep;
    match key {
        "allow_remote" if *transport == Transport::Stdin => {
            Some("is for ports, and standard input is none")
        }
        "allowed_origins" if !matches!(transport, Transport::WebSocket(_)) => {
            Some("is for listen = \"ws://…\"")
        }
        "rate" if is_lockstep => {
            Some("is for pacing = \"broadcast\"; in lockstep each frame has its own instant")
        }
        "playback_delay_s" if is_lockstep => {
            Some("is for pacing = \"broadcast\"; in lockstep nothing comes late")
        }
        "timeout_s" if !is_lockstep => {
            Some("is for pacing = \"lockstep\"; in broadcast no simulator waits")
        }
        _ => None,
    }
}

/// Description of a live satellite's source.
pub(super) fn flies_by(options: &LiveOptions) -> String {
    let whose = format!("{} on {}", printable(&options.name), options.transport);
    let beyond = match options.extrapolation {
        Extrapolation::TwoBody => "in free fall",
        Extrapolation::Linear => "straight on",
    };
    match options.pacing {
        Pacing::Broadcast => format!(
            "states that a simulator sends, drawn {} s late, {beyond} for {} s beyond the last: {whose}",
            options.playback_delay_s, options.extrapolation_limit_s
        ),
        Pacing::Lockstep => format!(
            "frames that a simulator waits for, each up to {} s: {whose}",
            options.frame_timeout.as_secs_f64()
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use std::path::Path;

    #[test]
    fn the_feed_takes_all_that_the_scene_takes() {
        let orbit = RawOrbit::default();
        let ends = [
            ("rate", orbit.rate().rule),
            ("playback_delay_s", orbit.playback_delay_s().rule),
            ("stale_after_s", orbit.stale_after_s().rule),
            ("extrapolate_s", orbit.extrapolate_s().rule),
            ("gap_s", orbit.gap_s().rule),
            ("pacing = \"lockstep\"\ntimeout_s", orbit.timeout_s().rule),
        ];
        for (key, Bounds { range, .. }) in ends {
            for end in [*range.start(), *range.end()] {
                let text = format!(
                    "[orbit]\nsource = \"live\"\nlisten = \"udp://127.0.0.1:0\"\n{key} = {end}\n"
                );
                let scene = Scene::from_toml(&text, Path::new("scene.toml"));
                let scene = scene.unwrap_or_else(|error| panic!("{error}"));
                let options = scene.orbits[0].live.as_ref().expect("a live satellite");
                options
                    .check()
                    .unwrap_or_else(|error| panic!("{key} {end}: {error}"));
            }
        }
    }
}
