//! How long a film will take, by its first frames.

use super::written::counted;
use std::time::Duration;

/// Frames that the estimate is made from, at least; before them pipelines are made and maps uploaded.
const LEAST_FRAMES: u64 = 4;
/// Time that these frames take, at least.
const LEAST_TIME: Duration = Duration::from_secs(2);
/// Films that end sooner need no estimate.
const WORTH_SAYING: Duration = Duration::from_secs(10);

/// Watches the first frames of a film, and makes one estimate.
#[derive(Debug, Default)]
pub struct FilmEstimate {
    /// When the first frame was done.
    first: Option<Duration>,
    done: u64,
    is_made: bool,
}

impl FilmEstimate {
    /// One more frame is done, so long after the beginning, and so many are left. Answers a line to be said, once.
    pub fn frame_done(&mut self, since_begun: Duration, left: u64) -> Option<String> {
        let first = *self.first.get_or_insert(since_begun);
        self.done += 1;
        let frames = self.done - 1;
        let taken = since_begun.saturating_sub(first);
        if self.is_made || frames < LEAST_FRAMES || taken < LEAST_TIME {
            return None;
        }
        self.is_made = true;
        let rest_s = taken.as_secs_f64() * (left as f64 / frames as f64);
        (rest_s >= WORTH_SAYING.as_secs_f64()).then(|| {
            format!(
                "time: about {} left, estimated from the first {}",
                rounded(rest_s),
                counted(self.done, "frame")
            )
        })
    }
}

/// A time to about a tenth.
fn rounded(seconds: f64) -> String {
    match seconds {
        s if s < 55.0 => format!("{:.0} s", 5.0 * (s / 5.0).ceil()),
        s if s < 3570.0 => format!("{:.0} min", (s / 60.0).round()),
        s => format!("{:.1} h", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines that are said of a film with frames done at these times.
    fn lines(times_s: impl Iterator<Item = f64>, frames: u64) -> Vec<String> {
        let mut estimate = FilmEstimate::default();
        let lines = times_s.zip(1..).filter_map(|(time_s, done)| {
            estimate.frame_done(Duration::from_secs_f64(time_s), frames - done)
        });
        lines.collect()
    }

    #[test]
    fn a_film_is_estimated_once_without_its_first_frame() {
        // The first frame takes 9 s, each other half a second.
        let times = || (0..900).map(|n| 9.0 + 0.5 * f64::from(n));
        let said = lines(times(), 900);
        assert_eq!(
            said,
            ["time: about 7 min left, estimated from the first 5 frames"]
        );
        let said = lines(times().take(60), 60);
        assert_eq!(
            said,
            ["time: about 30 s left, estimated from the first 5 frames"]
        );
        let fast = (0..20_000).map(|n| 1.0 + 0.01 * f64::from(n));
        let said = lines(fast, 1_000_000);
        assert_eq!(
            said,
            ["time: about 2.8 h left, estimated from the first 201 frames"]
        );
    }

    #[test]
    fn short_films_are_not_estimated() {
        assert!(lines((0..20).map(|n| 0.5 * f64::from(n)), 20).is_empty());
        assert!(lines([1.0].into_iter(), 1).is_empty());
    }
}
