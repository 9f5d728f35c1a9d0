//! Simulated time: the exact instants of an exported film, and the clock of the window.

use crate::frames::Epoch;
use crate::scene::Time;
use hifitime::Unit;

/// Fastest speed that the keys reach, in simulated seconds per second. A scene may start faster.
pub const FASTEST: f64 = 65_536.0;
/// Slowest speed that the keys reach.
pub const SLOWEST: f64 = 1.0 / 16.0;

/// The instant of frame `index` of a film of the scene.
///
/// Computed from the start each time, so that frame 100 000 is as exact as frame 1: index · speed / rate seconds in
/// one rounding, then whole nanoseconds.
pub fn frame_epoch(time: &Time, index: u64) -> Epoch {
    time.start + (index as f64 * time.speed / time.frame_rate_hz) * Unit::Second
}

/// What the clock does at the end of the flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AtEnd {
    /// Begins anew, in either direction.
    Loop,
    /// Stands still at the end.
    Stop,
}

/// A clock that can be paused, sped up, reversed and set; it never leaves the flight.
#[derive(Clone, Debug)]
pub struct Clock {
    start: Epoch,
    /// Length of the flight, simulated seconds.
    duration_s: f64,
    /// Where `start` lies in the flight: 0, or the whole duration where the scene flies backwards.
    start_s: f64,
    /// Simulated seconds since the flight's earliest instant, 0…duration.
    now_s: f64,
    /// Simulated seconds per second, negative backwards, never 0.
    speed: f64,
    paused: bool,
    at_end: AtEnd,
}

impl Clock {
    /// A clock that stands at the scene's start and runs at its speed.
    pub fn new(time: &Time, at_end: AtEnd) -> Self {
        let start_s = if time.speed < 0.0 {
            time.duration_s
        } else {
            0.0
        };
        Self {
            start: time.start,
            duration_s: time.duration_s,
            start_s,
            now_s: start_s,
            speed: time.speed,
            paused: false,
            at_end,
        }
    }

    /// The instant that is shown.
    pub fn now(&self) -> Epoch {
        self.start + (self.now_s - self.start_s) * Unit::Second
    }

    /// Simulated seconds per second, negative backwards.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Whether it stands still.
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// How much of the flight lies before the present instant, 0…1.
    pub fn progress(&self) -> f64 {
        self.now_s / self.duration_s
    }

    /// Length of the flight, simulated seconds.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Lets `wall_dt_s` seconds of the wall clock pass. A step that is negative or not finite is no step.
    pub fn advance(&mut self, wall_dt_s: f64) {
        if self.paused || !wall_dt_s.is_finite() || wall_dt_s <= 0.0 {
            return;
        }
        let next_s = self.now_s + wall_dt_s * self.speed;
        if (0.0..=self.duration_s).contains(&next_s) {
            self.now_s = next_s;
            return;
        }
        match self.at_end {
            AtEnd::Loop => self.now_s = next_s.rem_euclid(self.duration_s),
            AtEnd::Stop => {
                self.now_s = next_s.clamp(0.0, self.duration_s);
                self.paused = true;
            }
        }
    }

    /// Pauses or goes on.
    pub fn set_paused(&mut self, paused: bool) {
        self.paused = paused;
    }

    /// To the next higher power of two of real time.
    pub fn faster(&mut self) {
        let exponent = self.speed.abs().log2().floor() + 1.0;
        self.set_magnitude(exponent.exp2());
    }

    /// To the next lower power of two of real time.
    pub fn slower(&mut self) {
        let exponent = self.speed.abs().log2().ceil() - 1.0;
        self.set_magnitude(exponent.exp2());
    }

    fn set_magnitude(&mut self, magnitude: f64) {
        self.speed = magnitude.clamp(SLOWEST, FASTEST).copysign(self.speed);
    }

    /// Turns time round.
    pub fn reverse(&mut self) {
        self.speed = -self.speed;
    }

    /// Sets the clock to a part of the flight, 0 (earliest) to 1 (latest); anything else is brought into it.
    pub fn seek(&mut self, progress: f64) {
        if progress.is_finite() {
            self.now_s = progress.clamp(0.0, 1.0) * self.duration_s;
        }
    }

    /// Moves the clock by simulated seconds, as far as the flight reaches.
    pub fn seek_by(&mut self, simulated_s: f64) {
        self.seek((self.now_s + simulated_s) / self.duration_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frames::utc_from_rfc3339;

    fn time(speed: f64) -> Time {
        Time {
            start: utc_from_rfc3339("2018-01-15T12:00:00Z").expect("a date"),
            duration_s: 100.0,
            speed,
            frame_rate_hz: 30.0,
            orientation: None,
        }
    }

    fn seconds(clock: &Clock) -> f64 {
        (clock.now() - time(1.0).start).to_seconds()
    }

    #[test]
    fn frames_do_not_accumulate_rounding() {
        let time = Time {
            frame_rate_hz: 30_000.0 / 1001.0,
            ..time(1.0)
        };
        // 30 000 frames at 30000/1001 Hz are 1001 s exactly.
        let offset = frame_epoch(&time, 30_000) - time.start;
        assert_eq!(offset.total_nanoseconds(), 1_001_000_000_000);
        assert_eq!(frame_epoch(&time, 0), time.start);
        let back = frame_epoch(
            &Time {
                speed: -2.0,
                frame_rate_hz: 10.0,
                ..time
            },
            5,
        );
        assert_eq!((back - time.start).total_nanoseconds(), -1_000_000_000);
    }

    #[test]
    fn the_window_clock_loops_both_ways() {
        let mut clock = Clock::new(&time(60.0), AtEnd::Loop);
        clock.advance(1.0);
        assert!((seconds(&clock) - 60.0).abs() < 1e-9);
        clock.advance(1.0);
        assert!((seconds(&clock) - 20.0).abs() < 1e-9);
        clock.reverse();
        clock.advance(0.5);
        assert!((seconds(&clock) - 90.0).abs() < 1e-9);
    }

    #[test]
    fn a_stopping_clock_stands_at_its_end() {
        let mut clock = Clock::new(&time(60.0), AtEnd::Stop);
        clock.advance(5.0);
        assert!((seconds(&clock) - 100.0).abs() < 1e-9);
        assert!(clock.is_paused());
    }

    #[test]
    fn a_scene_that_flies_backwards_starts_at_its_latest_instant() {
        let mut clock = Clock::new(&time(-10.0), AtEnd::Loop);
        assert_eq!(seconds(&clock), 0.0);
        clock.advance(4.0);
        assert!((seconds(&clock) + 40.0).abs() < 1e-9);
        clock.advance(7.0);
        // 110 s back is 10 s before the start again.
        assert!((seconds(&clock) + 10.0).abs() < 1e-9);
    }

    #[test]
    fn the_ladder_of_speeds_holds_real_time_and_ends() {
        let mut clock = Clock::new(&time(60.0), AtEnd::Loop);
        clock.faster();
        assert_eq!(clock.speed(), 64.0);
        clock.slower();
        assert_eq!(clock.speed(), 32.0);
        for _ in 0..5 {
            clock.slower();
        }
        assert_eq!(clock.speed(), 1.0);
        for _ in 0..50 {
            clock.slower();
        }
        assert_eq!(clock.speed(), SLOWEST);
        clock.reverse();
        for _ in 0..50 {
            clock.faster();
        }
        assert_eq!(clock.speed(), -FASTEST);
    }

    #[test]
    fn pause_and_seek() {
        let mut clock = Clock::new(&time(60.0), AtEnd::Loop);
        clock.set_paused(true);
        clock.advance(1.0);
        assert_eq!(seconds(&clock), 0.0);
        clock.seek(0.25);
        assert!((seconds(&clock) - 25.0).abs() < 1e-9);
        clock.seek_by(-1e9);
        assert_eq!(clock.progress(), 0.0);
        clock.seek(f64::NAN);
        assert_eq!(clock.progress(), 0.0);
        clock.set_paused(false);
        clock.advance(f64::NAN);
        clock.advance(-1.0);
        assert_eq!(seconds(&clock), 0.0);
    }
}
