//! States that a program pushes while they are drawn, in the order in which they happen to come.
//!
//! [`PushedFeed`] is a [`Feed`] without a transport: its owner adds states, read with [`Packet::from_json`] or its own.
//! [`LiveFeed`](super::live::LiveFeed) adds those that arrive over a transport. A [`PlaybackClock`] finds the time that images show.

mod buffer;
mod clock;
mod packet;

use super::{Feed, Freshness, OrbitError, OrbitState};
pub use buffer::{Extrapolation, Insertion, MAX_STATES, REACH_S};
pub(crate) use buffer::{StateBuffer, later};
pub use clock::PlaybackClock;
#[cfg(feature = "live")]
pub(crate) use packet::{CRC_BYTES, MAGIC, STATE_BYTES, VERSION};
pub use packet::{MAX_PACKET_BYTES, Packet, PacketFault, PacketFormat, PacketKind};
use terrella_frames::{Epoch, rfc3339};

/// The motion of a satellite whose states are pushed. The last [`MAX_STATES`] are kept. Between states Hermite's cubic interpolates; beyond the last
/// one the satellite falls freely.
#[derive(Debug)]
pub struct PushedFeed {
    name: String,
    states: StateBuffer,
    reach_s: f64,
}

impl PushedFeed {
    /// A feed with its first state. Later states that are farther from the others than `reach_s` are a jump: one alone is dropped, two are a restart.
    /// The motion is extrapolated as far beyond the latest state.
    pub fn new(name: String, first: OrbitState, reach_s: f64) -> Self {
        let mut states = StateBuffer::new(reach_s);
        states.take(first);
        Self {
            name,
            states,
            reach_s,
        }
    }

    /// Adds a state.
    pub fn push(&mut self, state: OrbitState) -> Insertion {
        self.states.take(state)
    }

    fn limits(&self) -> (Epoch, Epoch) {
        let [oldest, newest] = [self.states.oldest(), self.states.newest()]
            .map(|state| state.map(|state| state.epoch).unwrap_or_default());
        (oldest, later(newest, self.reach_s))
    }
}

impl Feed for PushedFeed {
    fn name(&self) -> &str {
        &self.name
    }

    /// From the oldest kept state to the limit after the latest one.
    fn validity(&self) -> (Epoch, Epoch) {
        self.limits()
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        let (first, last) = self.limits();
        let known = self.states.between(epoch).or_else(|| {
            let is_near = first <= epoch && epoch <= last;
            is_near.then(|| self.states.beyond(epoch, Extrapolation::TwoBody))?
        });
        known.ok_or_else(|| OrbitError::NotCovered {
            satellite: self.name.clone(),
            epoch: rfc3339(epoch),
            known: format!("from {} to {}", rfc3339(first), rfc3339(last)),
        })
    }

    fn freshness(&self) -> Freshness {
        Freshness::Live
    }
}

#[cfg(test)]
mod tests {
    use super::super::Frame;
    use super::*;
    use glam::DVec3;
    use terrella_frames::utc_from_rfc3339;

    fn state(second: f64) -> OrbitState {
        let start = utc_from_rfc3339("2026-01-01T00:00:00Z").expect("a date");
        let (sin, cos) = (second * 1.1e-3).sin_cos();
        OrbitState {
            epoch: later(start, second),
            frame: Frame::Gcrf,
            position_m: 6.9e6 * DVec3::new(cos, sin, 0.0),
            velocity_m_s: 7.59e3 * DVec3::new(-sin, cos, 0.0),
        }
    }

    #[test]
    fn pushed_states_are_a_motion_within_their_reach() {
        let mut feed = PushedFeed::new("A".to_owned(), state(0.0), 20.0);
        assert_eq!(feed.push(state(10.0)), Insertion::Newest);
        let at = |feed: &PushedFeed, second: f64| feed.state_at(state(second).epoch);
        let off_m = |second: f64| {
            let found = at(&feed, second).expect("within the reach").position_m;
            (found - state(second).position_m).length()
        };
        assert!(off_m(5.0) < 0.01, "{}", off_m(5.0));
        // The circle of the test is not quite a free fall.
        assert!(off_m(29.0) < 20.0, "{}", off_m(29.0));
        for second in [-1.0, 31.0] {
            let error = at(&feed, second).expect_err("beyond the reach").to_string();
            assert!(error.starts_with("A is not known at 2"), "{error}");
        }
        assert_eq!(feed.push(state(1e4)), Insertion::Apart);
        assert_eq!(feed.push(state(1e4 + 1.0)), Insertion::Restart);
        assert!(at(&feed, 5.0).is_err() && at(&feed, 1e4).is_ok());
    }

    #[test]
    fn it_takes_what_packets_hold() {
        let packet = Packet {
            kind: PacketKind::State,
            seq: None,
            state: state(0.0),
            name: Some("B".to_owned()),
        };
        let read = Packet::from_json(packet.to_json().trim_end().as_bytes()).expect("a packet");
        let feed = PushedFeed::new(read.name.unwrap_or_default(), read.state, REACH_S);
        assert_eq!(feed.name(), "B");
        assert_eq!(feed.freshness(), Freshness::Live);
        assert_eq!(feed.state_at(state(0.0).epoch).ok(), Some(state(0.0)));
    }
}
