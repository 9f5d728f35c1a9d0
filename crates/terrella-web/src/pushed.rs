//! Satellites whose states the page pushes, and the time that they are shown at.

use crate::satellites::{MOST, Satellite};
use std::time::Duration;
use terrella::Epoch;
use terrella::orbit::Feed;
use terrella::orbit::pushed::{
    Insertion, Packet, PacketFault, PacketKind, PlaybackClock, PushedFeed, REACH_S,
};
use terrella::tracks::TracksError;

/// How far pictures are behind the simulator, seconds: packets that come later than others still come in time.
const DELAY_S: f64 = 0.1;
/// Name of a satellite whose packets have none.
const NAME: &str = "live";

/// Why a packet is rejected.
#[derive(Debug, thiserror::Error)]
pub enum PushError {
    /// It is no packet with a state.
    #[error("packet: {0}")]
    Packet(#[from] PacketFault),
    /// A frame, which a simulator would wait for.
    #[error("packet: message is \"frame\"; a page acknowledges none, send states")]
    Frame,
    /// There are as many satellites as can be drawn.
    #[error("packet: there are {MOST} satellites already; remove some")]
    TooMany,
    /// They cannot be drawn.
    #[error(transparent)]
    Tracks(#[from] TracksError),
}

/// When pushed states arrive: all satellites share a clock.
#[derive(Debug)]
pub struct Playback {
    rate: f64,
    clock: PlaybackClock,
}

impl Default for Playback {
    fn default() -> Self {
        Self {
            rate: 1.0,
            clock: PlaybackClock::new(1.0),
        }
    }
}

impl Playback {
    /// Takes a packet of JSON, which arrived at a time of the page's clock, from a simulator of this rate, simulated seconds per second. Returns the
    /// satellite's index, and whether it is new.
    ///
    /// # Errors
    /// Text that is no packet with a state, or more satellites than can be drawn. Nothing has then changed.
    pub fn push(
        &mut self,
        satellites: &mut Vec<Satellite>,
        packet: &str,
        arrival: Duration,
        rate: f64,
    ) -> Result<(usize, bool), PushError> {
        let packet = Packet::from_json(packet.trim().as_bytes())?;
        if packet.kind == PacketKind::Frame {
            return Err(PushError::Frame);
        }
        let name = packet.name.as_deref().unwrap_or(NAME);
        let known = satellites.iter_mut().position(
            |satellite| matches!(satellite, Satellite::Pushed(feed) if feed.name() == name),
        );
        if known.is_none() && satellites.len() >= MOST {
            return Err(PushError::TooMany);
        }
        if rate != self.rate {
            self.rate = rate;
            self.clock = PlaybackClock::new(rate);
        }
        let added = match known.and_then(|index| satellites.get_mut(index)) {
            Some(Satellite::Pushed(feed)) => feed.push(packet.state),
            _ => {
                // A fast simulator has its states farther apart.
                let reach_s = REACH_S * rate.abs().max(1.0);
                let feed = PushedFeed::new(name.to_owned(), packet.state, reach_s);
                satellites.push(Satellite::Pushed(feed));
                Insertion::Newest
            }
        };
        self.clock.follow(added, packet.state.epoch, arrival);
        Ok((known.unwrap_or(satellites.len() - 1), known.is_none()))
    }

    /// The instant to show at a time of the page's clock: a little behind the simulator, and within the times at which a pushed satellite is known.
    /// `None` before the first state.
    pub fn epoch(&self, satellites: &[Satellite], now: Duration) -> Option<Epoch> {
        let spans = satellites.iter().filter_map(|satellite| match satellite {
            Satellite::Pushed(feed) => Some(feed.validity()),
            _ => None,
        });
        let known = spans.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
        self.clock.shown(now, DELAY_S, known)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packet(name: &str, second: f64) -> String {
        format!(
            r#"{{"name":"{name}","epoch":"2026-01-01T00:00:{second:06.3}Z","frame":"GCRF","position_m":[7e6,{},0],"velocity_m_s":[0,7500,0]}}"#,
            7500.0 * second
        )
    }

    #[test]
    fn states_become_satellites_and_a_time() {
        let (mut playback, mut satellites) = (Playback::default(), Vec::new());
        let mut push = |playback: &mut Playback, name: &str, second: f64, arrival: f64| {
            let arrival = Duration::from_secs_f64(arrival);
            playback.push(&mut satellites, &packet(name, second), arrival, 1.0)
        };
        assert_eq!(push(&mut playback, "A", 0.0, 100.0).ok(), Some((0, true)));
        assert_eq!(push(&mut playback, "B", 0.0, 100.0).ok(), Some((1, true)));
        assert_eq!(push(&mut playback, "A", 1.0, 101.2).ok(), Some((0, false)));
        let shown = playback.epoch(&satellites, Duration::from_secs_f64(101.0));
        let seconds = shown.expect("states have come") - satellites[0].epoch();
        assert!((seconds.to_seconds() - 0.9).abs() < 1e-6, "{seconds}");
        // A simulator that is silent stays where its last state reaches.
        let late = playback.epoch(&satellites, Duration::from_secs(900));
        let seconds = late.expect("states have come") - satellites[0].epoch();
        assert!((seconds.to_seconds() - 61.0).abs() < 1e-6, "{seconds}");
    }

    #[test]
    fn what_is_no_state_changes_nothing() {
        let (mut playback, mut satellites) = (Playback::default(), Vec::new());
        for (bad, wanted) in [
            ("", "not a packet in JSON"),
            (r#"{"epoch":1}"#, "not a packet in JSON"),
            (&packet("A", 0.0).replace("GCRF", "LUNAR"), "frame is"),
            (
                &packet("A", 0.0).replacen('{', r#"{"message":"frame","seq":1,"#, 1),
                "send states",
            ),
        ] {
            let error = playback.push(&mut satellites, bad, Duration::ZERO, 1.0);
            let error = error.expect_err("no state").to_string();
            assert!(error.contains(wanted), "{error}");
        }
        assert!(satellites.is_empty());
        assert_eq!(playback.epoch(&satellites, Duration::ZERO), None);
    }
}
