//! Playback time of images in broadcast.

use super::buffer::{Insertion, later, nanoseconds};
use std::time::Duration;
use terrella_frames::Epoch;

/// Arrivals are kept for eight bins of a quarter of a second.
const BINS: usize = 8;
const BIN_S: f64 = 0.25;

/// Simulated time as a function of the wall clock.
///
/// Packets arrive late by an unknown and varying delay, never early. The earliest one of the last two seconds therefore determines the offset of
/// the two clocks; late ones change nothing. After a pause of the simulator all packets are late, and the clock steps back by the pause.
#[derive(Debug)]
pub struct PlaybackClock {
    /// Simulated seconds in a second.
    rate: f64,
    /// The first arrival: both ways of counting begin there.
    origin: Option<(Epoch, Duration)>,
    /// Number of the bin, and the most that an epoch in it was ahead of the wall, seconds.
    bins: [Option<(i64, f64)>; BINS],
    newest_bin: i64,
}

impl PlaybackClock {
    /// For a simulator of this rate, simulated seconds in a second.
    pub fn new(rate: f64) -> Self {
        Self {
            rate,
            origin: None,
            bins: [None; BINS],
            newest_bin: 0,
        }
    }

    /// Forgets all arrivals: the simulator has jumped.
    fn clear(&mut self) {
        *self = Self::new(self.rate);
    }

    /// Takes note of the arrival of a state. Arrivals are counted from any fixed instant.
    fn note(&mut self, epoch: Epoch, arrival: Duration) {
        let (first, origin) = *self.origin.get_or_insert((epoch, arrival));
        let wall_s = arrival.saturating_sub(origin).as_secs_f64();
        let ahead_s = nanoseconds(first, epoch) as f64 * 1e-9 - self.rate * wall_s;
        let bin = (wall_s / BIN_S) as i64;
        self.newest_bin = self.newest_bin.max(bin);
        if let Some(kept) = self.bins.get_mut(bin.rem_euclid(BINS as i64) as usize) {
            *kept = match *kept {
                Some((number, most_s)) if number == bin => Some((bin, most_s.max(ahead_s))),
                _ => Some((bin, ahead_s)),
            };
        }
    }

    /// Follows a state that was added with this result: it takes note of its arrival, or begins again after a jump. Returns whether the state was taken.
    pub fn follow(&mut self, added: Insertion, epoch: Epoch, arrival: Duration) -> bool {
        match added {
            Insertion::Newest | Insertion::Late => {}
            Insertion::Restart => self.clear(),
            Insertion::Duplicate | Insertion::TooLate | Insertion::Apart => return false,
        }
        self.note(epoch, arrival);
        true
    }

    /// The instant to show: so many seconds of the wall behind the simulator, and between the first and the last at which its motion is known. `None`
    /// before the first arrival.
    pub fn shown(
        &self,
        now: Duration,
        delay_s: f64,
        (first, last): (Epoch, Epoch),
    ) -> Option<Epoch> {
        let shown = later(self.at(now)?, -delay_s * self.rate);
        Some(shown.max(first).min(last))
    }

    /// The simulated instant at a time counted as arrivals are; `None` before the first arrival.
    fn at(&self, now: Duration) -> Option<Epoch> {
        let (first, origin) = self.origin?;
        let wall_s = now.saturating_sub(origin).as_secs_f64();
        let bins = self.bins.iter().flatten();
        let fresh = bins.filter(|(number, _)| *number > self.newest_bin - BINS as i64);
        let ahead_s = fresh.map(|&(_, s)| s).reduce(f64::max)?;
        Some(later(first, ahead_s + self.rate * wall_s))
    }
}

#[cfg(test)]
mod tests {
    use super::super::buffer::seconds;
    use super::*;
    use terrella_frames::utc_from_rfc3339;

    #[test]
    fn jitter_does_not_move_it_and_a_pause_does() {
        let start = utc_from_rfc3339("2018-01-15T12:00:00Z").unwrap();
        let wall = Duration::from_secs(7);
        for rate in [1.0, 60.0] {
            let mut clock = PlaybackClock::new(rate);
            assert_eq!(clock.at(wall), None);
            let mut send = |t_s: f64, late_s: f64, paused_s: f64| {
                let arrival = wall + Duration::from_secs_f64(t_s + late_s);
                clock.note(later(start, (t_s - paused_s) * rate), arrival);
                let shown = clock.at(arrival).unwrap();
                seconds(start, shown) / rate - (t_s + late_s)
            };
            for k in 0..400 {
                // Every third arrives immediately, the others up to 80 ms late.
                let late_s = 0.04 * f64::from(k % 3);
                let off_s = send(f64::from(k) * 0.05, late_s, 0.0);
                assert!(off_s.abs() < 1e-6, "packet {k}: {off_s}");
            }
            let mut off_s = 0.0;
            for k in 400..480 {
                off_s = send(f64::from(k) * 0.05, 0.0, 3.0);
            }
            assert!((off_s + 3.0).abs() < 1e-6, "{off_s}");
        }
    }
}
