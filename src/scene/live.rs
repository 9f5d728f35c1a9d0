//! `[orbit] source = "live"`: states that a simulator sends, and what several of them can share.

use super::error::{SceneError, printable};
use super::field::{Field, field, flag, in_range, span_of, written};
use super::limits::*;
use super::locate::Source;
use super::raw::RawOrbit;
use super::{Orbit, Scene};
use crate::orbit::live::{Extrapolation, LiveOptions, Pacing, Transport};
use std::time::Duration;

/// Keys of live satellites alone.
pub(super) const KEYS: &[&str] = &[
    "listen",
    "allow_remote",
    "allowed_origins",
    "pacing",
    "rate",
    "playback_delay_s",
    "timeout_s",
    "stale_after_s",
    "extrapolate_s",
    "extrapolation",
    "gap_s",
    "packets_per_s",
];

impl Source<'_> {
    /// How the states of one satellite are taken.
    pub(super) fn live(
        &self,
        orbit: &RawOrbit,
        name: Option<&str>,
    ) -> Result<LiveOptions, SceneError> {
        let listen = field!(orbit.listen);
        let Some(given) = listen.given else {
            let advice = "needs a place to listen on; add listen = \"tcp://127.0.0.1:5005\", or \"udp://…\", \"ws://…\" or \"stdin\"";
            return Err(self.refuse(&field!(orbit.source), advice));
        };
        let transport: Transport = given.get_ref().parse().map_err(|_| {
            let advice = "must be \"stdin\", or \"tcp://\", \"udp://\" or \"ws://\" with an IP address and a port, such as \"tcp://127.0.0.1:5005\"";
            self.refuse(&listen, advice)
        })?;
        let usual = LiveOptions::new(transport);
        let mode = self.choice(&field!(orbit.pacing), usual.pacing)?;
        self.live_keys_fit(orbit, &usual.transport, mode)?;
        let allow_remote = flag(&field!(orbit.allow_remote), false);
        let is_remote = |transport: &Transport| {
            let address = transport.address();
            address.is_some_and(|address| !address.ip().is_loopback())
        };
        if is_remote(&usual.transport) && !allow_remote {
            let advice = "other machines reach this address, and whoever reaches it can steer the picture; take 127.0.0.1 or [::1], or write allow_remote = true";
            return Err(self.refuse(&listen, advice));
        }
        let default_timeout_s = usual.frame_timeout.as_secs_f64();
        let seconds =
            |field: Field<'_, f64>, default, range| self.within(&field, default, range, "seconds");
        let timeout_s = seconds(field!(orbit.timeout_s), default_timeout_s, TIMEOUT_S)?;
        let packets = field!(orbit.packets_per_s);
        let max_packets_per_s = match packets.given.map(|given| *given.get_ref()) {
            None => usual.max_packets_per_s,
            Some(count) => in_range(count, &PACKETS_PER_S).ok_or_else(|| {
                let advice = format!(
                    "must be from {} packets per second",
                    span_of(&PACKETS_PER_S)
                );
                self.refuse(&packets, advice)
            })?,
        };
        Ok(LiveOptions {
            pacing: mode,
            name: name.map_or(usual.name, str::to_owned),
            allow_remote,
            allowed_origins: self.origins(&field!(orbit.allowed_origins))?,
            rate: self.within(
                &field!(orbit.rate),
                usual.rate,
                RATE,
                "simulated seconds per second",
            )?,
            playback_delay_s: seconds(
                field!(orbit.playback_delay_s),
                usual.playback_delay_s,
                PLAYBACK_DELAY_S,
            )?,
            stale_after_s: seconds(
                field!(orbit.stale_after_s),
                usual.stale_after_s,
                STALE_AFTER_S,
            )?,
            extrapolation_limit_s: seconds(
                field!(orbit.extrapolate_s),
                usual.extrapolation_limit_s,
                EXTRAPOLATE_S,
            )?,
            extrapolation: self.choice(&field!(orbit.extrapolation), usual.extrapolation)?,
            gap_s: seconds(field!(orbit.gap_s), usual.gap_s, GAP_S)?,
            // In range: it is finite and not negative.
            frame_timeout: Duration::try_from_secs_f64(timeout_s).unwrap_or_default(),
            max_packets_per_s,
            transport: usual.transport,
        })
    }

    /// Refuses keys that have no meaning with the way in or the pacing.
    fn live_keys_fit(
        &self,
        orbit: &RawOrbit,
        transport: &Transport,
        mode: Pacing,
    ) -> Result<(), SceneError> {
        for (key, span) in orbit.given() {
            if let Some(why) = idle(transport, mode, key) {
                return Err(self.refuse_at(
                    "orbit",
                    key,
                    span,
                    format!("{key} {why}; leave it out"),
                ));
            }
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
            return Err(self.refuse(field, advice));
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
            true => Ok(origins),
            false => {
                let advice = "must be web pages as browsers name them, scheme and host without a path, like \"https://example.org\"";
                Err(self.refuse(field, advice))
            }
        }
    }

    /// Refuses live satellites that cannot be in one scene: two on one port or both on standard input, two whose
    /// simulators both wait, too many.
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
            return Err(self.refuse(&field!(orbit.source), advice));
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
                return Err(self.refuse(&field!(orbit.listen), advice));
            }
            let waits = |options: &LiveOptions| options.pacing == Pacing::Lockstep;
            if waits(options) && before().any(waits) {
                let advice = "a picture is of one instant, and the simulator of a satellite before this one says which; write \"broadcast\" here";
                return Err(self.refuse(&field!(orbit.pacing), advice));
            }
        }
        Ok(())
    }
}

/// Why a key does nothing with the way in or the pacing; `None` where it does something.
fn idle(transport: &Transport, mode: Pacing, key: &str) -> Option<&'static str> {
    let is_lockstep = mode == Pacing::Lockstep;
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

/// The value of one of [`KEYS`], or why there is none.
pub(super) fn value(options: &LiveOptions, key: &str) -> Result<String, &'static str> {
    if let Some(why) = idle(&options.transport, options.pacing, key) {
        return Err(why);
    }
    let quoted = |text: &str| format!("\"{}\"", printable(text));
    Ok(match key {
        "listen" => quoted(&options.transport.to_string()),
        "allow_remote" => options.allow_remote.to_string(),
        "allowed_origins" => {
            let pages: Vec<_> = options
                .allowed_origins
                .iter()
                .map(|page| quoted(page))
                .collect();
            format!("[{}]", pages.join(", "))
        }
        "pacing" => quoted(&written(&options.pacing)),
        "rate" => options.rate.to_string(),
        "playback_delay_s" => options.playback_delay_s.to_string(),
        "timeout_s" => options.frame_timeout.as_secs_f64().to_string(),
        "stale_after_s" => options.stale_after_s.to_string(),
        "extrapolate_s" => options.extrapolation_limit_s.to_string(),
        "extrapolation" => quoted(&written(&options.extrapolation)),
        "gap_s" => options.gap_s.to_string(),
        "packets_per_s" => options.max_packets_per_s.to_string(),
        // A test holds that no known key comes here.
        _ => return Err("unknown to the summary"),
    })
}

/// What a live satellite flies by, in words.
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

impl Scene {
    /// Whether a simulator gives the time.
    pub fn is_live(&self) -> bool {
        self.orbits.iter().any(|orbit| orbit.live.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_feed_takes_all_that_the_scene_takes() {
        let ends = [
            ("rate", RATE),
            ("playback_delay_s", PLAYBACK_DELAY_S),
            ("stale_after_s", STALE_AFTER_S),
            ("extrapolate_s", EXTRAPOLATE_S),
            ("gap_s", GAP_S),
            ("pacing = \"lockstep\"\ntimeout_s", TIMEOUT_S),
        ];
        for (key, range) in ends {
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
