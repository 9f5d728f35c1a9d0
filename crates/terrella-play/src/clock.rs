//! Simulated time: the exact instants of an exported film, and the clock of the window.

use crate::scene::Time;
use hifitime::Unit;
use terrella::frames::Epoch;

/// Fastest speed that the keys reach, in simulated seconds per second. A scene may start faster.
pub const FASTEST: f64 = 65_536.0;
/// Slowest speed that the keys reach.
pub const SLOWEST: f64 = 1.0 / 16.0;

/// The instant of frame `index` of a film of the scene.
///
/// Computed from the start each time, so that frame 100 000 is as exact as frame 1: index · speed / rate seconds in
/// one rounding, then whole nanoseconds.
pub fn frame_epoch(time: &Time, index: u64) -> Epoch {
    epoch_after(time, index as f64)
}

/// The instant after so many frames, which need not be whole. Between two frames it stays on this side of a time that is left out.
pub(super) fn epoch_after(time: &Time, frames: f64) -> Epoch {
    let after = |frames: f64| time.epoch_after(frames * time.speed / time.frame_rate_hz);
    let (begin, epoch) = (after(frames.floor()), after(frames));
    let mut left_out = time.left_out.iter();
    let edge = left_out.find_map(|(from, to)| match time.speed < 0.0 {
        true => (begin >= *to && epoch < *to).then_some(*to),
        false => (begin <= *from && epoch > *from).then_some(*from),
    });
    edge.unwrap_or(epoch)
}

/// Shortest range that is played by itself, as a fraction of the span.
const MIN_RANGE_FRACTION: f64 = 1e-3;

/// Behaviour of the clock at the end of the playback range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AtEnd {
    /// Begins again, in either direction.
    Loop,
    /// Stands still at the end.
    Stop,
}

/// A clock that can be paused, sped up, reversed and set; it never leaves its span, at first the scene's own.
#[derive(Clone, Debug)]
pub struct Clock {
    /// The earliest instant of the span.
    first: Epoch,
    /// Length of the span, simulated seconds.
    duration_s: f64,
    /// Simulated seconds since the earliest instant, 0…duration.
    now_s: f64,
    /// Simulated seconds per second, negative backwards, never 0.
    speed: f64,
    paused: bool,
    at_end: AtEnd,
    /// The range that is played again and again, seconds since the earliest instant; `None` is the span's own end.
    range_s: (Option<f64>, Option<f64>),
    /// Earliest instant and length of the scene's own span.
    scene_span: (Epoch, f64),
    /// Times that are jumped over.
    left_out: Vec<(Epoch, Epoch)>,
}

impl Clock {
    /// A clock at the scene's start that runs at the scene's speed.
    pub fn new(time: &Time, at_end: AtEnd) -> Self {
        let now_s = if time.speed < 0.0 {
            time.duration_s
        } else {
            0.0
        };
        let first = time.start - now_s * Unit::Second;
        Self {
            first,
            duration_s: time.duration_s,
            now_s,
            speed: time.speed,
            paused: false,
            at_end,
            range_s: (None, None),
            scene_span: (first, time.duration_s),
            left_out: time.left_out.clone(),
        }
    }

    /// The instant that is shown.
    pub fn now(&self) -> Epoch {
        self.first + self.now_s * Unit::Second
    }

    /// Jumps ahead over a time that is left out.
    fn jump(&mut self) {
        let now = self.now();
        let mut left_out = self.left_out.iter();
        if let Some((from, to)) = left_out.find(|(from, to)| *from < now && now < *to) {
            let edge = if self.speed < 0.0 { *from } else { *to };
            self.now_s = (edge - self.first).to_seconds().clamp(0.0, self.duration_s);
        }
    }

    /// First and last instant that it can show.
    pub fn span(&self) -> (Epoch, Epoch) {
        (self.first, self.first + self.duration_s * Unit::Second)
    }

    /// Simulated seconds per second, negative backwards.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Whether it is paused.
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// Its behaviour at the end.
    pub fn at_end(&self) -> AtEnd {
        self.at_end
    }

    /// Sets what it does at the end.
    pub fn set_at_end(&mut self, at_end: AtEnd) {
        self.at_end = at_end;
    }

    /// Fraction of the span before the current time, 0…1.
    pub fn progress(&self) -> f64 {
        self.now_s / self.duration_s
    }

    /// Length of the span, simulated seconds.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Another span, `first` before `last`; what is shown is brought into it, and all of it is played. No span is taken
    /// that is not of some nanoseconds.
    pub fn set_span(&mut self, first: Epoch, last: Epoch) {
        let duration_s = (last - first).to_seconds();
        if duration_s > 0.0 {
            let now = self.now();
            (self.first, self.duration_s) = (first, duration_s);
            self.range_s = (None, None);
            self.seek_to(now);
        }
    }

    /// Whether its span is the scene's own.
    pub fn is_on_scene_span(&self) -> bool {
        (self.first, self.duration_s) == self.scene_span
    }

    /// Back to the scene's own span, and to its beginning.
    pub fn return_to_scene_span(&mut self) {
        (self.first, self.duration_s) = self.scene_span;
        self.range_s = (None, None);
        self.seek(if self.speed < 0.0 { 1.0 } else { 0.0 });
    }

    /// The range of the span that is played, from and to, 0…1.
    pub fn range(&self) -> (f64, f64) {
        let (from_s, to_s) = self.range_ends_s();
        (from_s / self.duration_s, to_s / self.duration_s)
    }

    fn range_ends_s(&self) -> (f64, f64) {
        let (from_s, to_s) = self.range_s;
        (from_s.unwrap_or(0.0), to_s.unwrap_or(self.duration_s))
    }

    /// The played range begins at `progress`, 0…1. One that ended before it ends with the span.
    pub fn set_range_start(&mut self, progress: f64) {
        if let Some(at_s) = self.offset_s(progress) {
            let to_s = self
                .range_s
                .1
                .filter(|to_s| self.is_long_enough(at_s, *to_s));
            if self.is_long_enough(at_s, to_s.unwrap_or(self.duration_s)) {
                self.range_s = (Some(at_s).filter(|at_s| *at_s > 0.0), to_s);
            }
        }
    }

    /// The played range ends at `progress`. One that began after it begins with the span.
    pub fn set_range_end(&mut self, progress: f64) {
        if let Some(at_s) = self.offset_s(progress) {
            let from_s = self
                .range_s
                .0
                .filter(|from_s| self.is_long_enough(*from_s, at_s));
            if self.is_long_enough(from_s.unwrap_or(0.0), at_s) {
                self.range_s = (from_s, Some(at_s).filter(|at_s| *at_s < self.duration_s));
            }
        }
    }

    /// All of the span is played.
    pub fn clear_range(&mut self) {
        self.range_s = (None, None);
    }

    fn offset_s(&self, progress: f64) -> Option<f64> {
        let is_number = progress.is_finite();
        is_number.then(|| progress.clamp(0.0, 1.0) * self.duration_s)
    }

    /// Whether a range is long enough for playback: a thousandth of the span.
    fn is_long_enough(&self, from_s: f64, to_s: f64) -> bool {
        to_s - from_s > MIN_RANGE_FRACTION * self.duration_s
    }

    /// Lets `wall_dt_s` seconds of the wall clock pass. A step that is negative or not finite is no step.
    ///
    /// It ends, or begins again, with the played range; set outside of it, it first runs into it or to the end of the span.
    pub fn advance(&mut self, wall_dt_s: f64) {
        if self.paused || !wall_dt_s.is_finite() || wall_dt_s <= 0.0 {
            return;
        }
        let next_s = self.now_s + wall_dt_s * self.speed;
        let (from_s, to_s) = self.range_ends_s();
        let end_s = self.end_ahead_s();
        let beyond_s = (next_s - end_s) * self.speed.signum();
        if beyond_s <= 0.0 {
            self.now_s = next_s;
            self.jump();
            return;
        }
        match self.at_end {
            AtEnd::Loop => {
                let into_s = beyond_s.rem_euclid(to_s - from_s);
                self.now_s = match self.speed < 0.0 {
                    true => to_s - into_s,
                    false => from_s + into_s,
                };
                self.jump();
            }
            AtEnd::Stop => {
                self.now_s = end_s;
                self.paused = true;
            }
        }
    }

    /// Where it would end if it continued.
    fn end_ahead_s(&self) -> f64 {
        let (from_s, to_s) = self.range_ends_s();
        match self.speed < 0.0 {
            true if self.now_s < from_s => 0.0,
            true => from_s,
            false if self.now_s > to_s => self.duration_s,
            false => to_s,
        }
    }

    /// Pauses or resumes.
    ///
    /// At the end, where it would stop again immediately, it resumes from the other end.
    pub fn set_paused(&mut self, paused: bool) {
        self.paused = paused;
        if !paused && self.at_end == AtEnd::Stop && self.now_s == self.end_ahead_s() {
            let (from_s, to_s) = self.range_ends_s();
            self.now_s = if self.speed < 0.0 { to_s } else { from_s };
        }
    }

    /// Another speed, simulated seconds per second, within what keys reach. Time goes the way that it went.
    pub fn set_rate(&mut self, rate: f64) {
        if rate.is_finite() {
            self.set_magnitude(rate.abs());
        }
    }

    /// Increases the speed to the next power of two of real time.
    pub fn faster(&mut self) {
        let exponent = self.speed.abs().log2().floor() + 1.0;
        self.set_magnitude(exponent.exp2());
    }

    /// Decreases the speed to the next power of two of real time.
    pub fn slower(&mut self) {
        let exponent = self.speed.abs().log2().ceil() - 1.0;
        self.set_magnitude(exponent.exp2());
    }

    fn set_magnitude(&mut self, magnitude: f64) {
        self.speed = magnitude.clamp(SLOWEST, FASTEST).copysign(self.speed);
    }

    /// Real time, forwards.
    pub fn set_real_time(&mut self) {
        self.speed = 1.0;
    }

    /// Turns time round.
    pub fn reverse(&mut self) {
        self.speed = -self.speed;
    }

    /// Sets the clock to a fraction of the span, 0 (earliest) to 1 (latest); anything else is brought into it.
    pub fn seek(&mut self, progress: f64) {
        if progress.is_finite() {
            self.now_s = progress.clamp(0.0, 1.0) * self.duration_s;
            self.jump();
        }
    }

    /// Sets the clock to an instant; one outside the span is brought into it.
    pub fn seek_to(&mut self, epoch: Epoch) {
        self.now_s = (epoch - self.first)
            .to_seconds()
            .clamp(0.0, self.duration_s);
        self.jump();
    }

    /// Moves the clock by simulated seconds, clamped to the span.
    pub fn seek_by(&mut self, simulated_s: f64) {
        self.seek((self.now_s + simulated_s) / self.duration_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella::frames::utc_from_rfc3339;

    fn time(speed: f64) -> Time {
        Time {
            start: utc_from_rfc3339("2018-01-15T12:00:00Z").expect("a date"),
            start_from: crate::scene::StartSource::Given,
            duration_s: 100.0,
            speed,
            frame_rate_hz: 30.0,
            orientation: None,
            left_out: Vec::new(),
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
    fn frames_and_the_clock_jump_over_what_is_left_out() {
        let start = time(1.0).start;
        let at = |seconds: f64| start + seconds * Unit::Second;
        let with = |speed: f64, left_out: &[(f64, f64)]| Time {
            frame_rate_hz: 1.0,
            left_out: left_out
                .iter()
                .map(|(from, to)| (at(*from), at(*to)))
                .collect(),
            ..time(speed)
        };
        let ahead = with(10.0, &[(25.0, 47.0), (60.0, 70.0)]);
        let frames = |time: &Time| {
            let frames = (0..time.frame_count()).map(|n| frame_epoch(time, n));
            frames
                .map(|epoch| (epoch - start).to_seconds())
                .collect::<Vec<_>>()
        };
        // 68 s are known: seven frames, the last one at 92 s of 100.
        assert_eq!(frames(&ahead), [0.0, 10.0, 20.0, 52.0, 72.0, 82.0, 92.0]);
        let back = with(-10.0, &[(-47.0, -25.0)]);
        assert_eq!(frames(&back)[1..5], [-10.0, -20.0, -52.0, -62.0]);
        for time in [&ahead, &back] {
            for n in 0..time.frame_count() {
                assert_eq!(time.nearest_frame(frame_epoch(time, n)), n as u32);
            }
        }
        // The shutter of the frame before a gap closes at its edge.
        assert_eq!(epoch_after(&ahead, 2.4), at(24.0));
        assert_eq!(epoch_after(&ahead, 2.9), at(25.0));
        assert_eq!(epoch_after(&back, 2.9), at(-25.0));
        let mut clock = Clock::new(&ahead, AtEnd::Loop);
        clock.advance(2.6);
        assert_eq!(seconds(&clock), 47.0);
        clock.seek(0.65);
        assert_eq!(seconds(&clock), 70.0);
        let mut clock = Clock::new(&back, AtEnd::Loop);
        clock.advance(2.6);
        assert_eq!((clock.now() - start).to_seconds(), -47.0);
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
    fn a_part_is_played_again_and_again() {
        let mut clock = Clock::new(&time(10.0), AtEnd::Loop);
        clock.set_range_start(0.2);
        clock.set_range_end(0.5);
        assert_eq!(clock.range(), (0.2, 0.5));
        // From before the part into it, then round in it.
        clock.advance(4.0);
        assert!((seconds(&clock) - 40.0).abs() < 1e-9);
        clock.advance(2.0);
        assert!((seconds(&clock) - 30.0).abs() < 1e-9);
        // More than once round in one step: 50 s beyond the end of a part of 30 s.
        clock.advance(7.0);
        assert!((seconds(&clock) - 40.0).abs() < 1e-9);
        clock.seek(0.3);
        clock.reverse();
        clock.advance(2.0);
        assert!((seconds(&clock) - 40.0).abs() < 1e-9);
        // From behind the part to the end of the span, and then into it.
        clock.reverse();
        clock.seek(0.8);
        clock.advance(1.0);
        assert!((seconds(&clock) - 90.0).abs() < 1e-9);
        clock.advance(1.5);
        assert!((seconds(&clock) - 25.0).abs() < 1e-9);
        // An end before the beginning takes the beginning away.
        clock.set_range_end(0.1);
        assert_eq!(clock.range(), (0.0, 0.1));
        clock.set_range_start(0.7);
        assert_eq!(clock.range(), (0.7, 1.0));
        clock.set_range_start(f64::NAN);
        clock.set_range_end(1.0);
        clock.set_range_start(1.0);
        assert_eq!(clock.range(), (0.7, 1.0));
        clock.clear_range();
        assert_eq!(clock.range(), (0.0, 1.0));
    }

    #[test]
    fn a_stopped_clock_goes_on_from_the_other_end() {
        let mut clock = Clock::new(&time(60.0), AtEnd::Stop);
        clock.set_range_start(0.25);
        clock.advance(5.0);
        assert!(clock.is_paused() && seconds(&clock) == 100.0);
        clock.set_paused(false);
        assert_eq!(seconds(&clock), 25.0);
        clock.reverse();
        clock.advance(9.0);
        assert!(clock.is_paused() && seconds(&clock) == 25.0);
        clock.set_paused(false);
        clock.advance(0.5);
        assert!((seconds(&clock) - 70.0).abs() < 1e-9);
        // A clock in the middle resumes from there.
        clock.set_paused(true);
        clock.set_paused(false);
        assert!((seconds(&clock) - 70.0).abs() < 1e-9);
    }

    #[test]
    fn spans_move_and_come_back() {
        let mut clock = Clock::new(&time(-10.0), AtEnd::Loop);
        let (first, last) = clock.span();
        assert_eq!(last, time(1.0).start);
        clock.set_range_end(0.5);
        clock.set_span(last + 50.0 * Unit::Second, last + 250.0 * Unit::Second);
        assert!(!clock.is_on_scene_span());
        assert_eq!((seconds(&clock), clock.range()), (50.0, (0.0, 1.0)));
        clock.seek_to(last + 99.5 * Unit::Second);
        assert_eq!(seconds(&clock), 99.5);
        // Turned round, or of no length, it is no span.
        clock.set_span(last, first);
        clock.set_span(first, first);
        assert_eq!(clock.span().0, last + 50.0 * Unit::Second);
        clock.return_to_scene_span();
        assert!(clock.is_on_scene_span());
        assert_eq!((clock.span(), clock.now()), ((first, last), last));
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
        clock.set_rate(300.0);
        assert_eq!(clock.speed(), -300.0);
        clock.set_rate(f64::NAN);
        assert_eq!(clock.speed(), -300.0);
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
