//! Start time of the next request: limited per second, later after a failure, and as late as the server requests.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// The longest wait that a server may request.
pub(super) const LONGEST_WAIT: Duration = Duration::from_secs(600);

/// Waiting ends at most so much after it is no longer wanted.
const SLICE: Duration = Duration::from_millis(50);

/// The first wait after a failure; each further one is twice as long.
const FIRST_WAIT_S: f64 = 0.5;

/// The longest of those.
const LONGEST_BACK_OFF_S: f64 = 30.0;

/// Hands out times at which requests may begin.
pub(super) struct Pace {
    step: Duration,
    next: Mutex<Instant>,
}

impl Pace {
    pub(super) fn new(requests_per_s: f64) -> Self {
        Self {
            step: Duration::from_secs_f64(1.0 / requests_per_s.clamp(0.001, 1e6)),
            next: Mutex::new(Instant::now()),
        }
    }

    /// Waits for this thread's turn. False if it is no longer wanted.
    pub(super) fn wait(&self, is_cancelled: &dyn Fn() -> bool) -> bool {
        let turn = {
            let mut next = self.next.lock().unwrap_or_else(PoisonError::into_inner);
            let turn = (*next).max(Instant::now());
            *next = turn + self.step;
            turn
        };
        sleep_until(turn, is_cancelled)
    }

    /// Nobody's turn comes before this has passed.
    pub(super) fn hold(&self, pause: Duration) {
        let mut next = self.next.lock().unwrap_or_else(PoisonError::into_inner);
        *next = (*next).max(Instant::now() + pause);
    }
}

/// False if it is no longer wanted.
pub(super) fn sleep_until(end: Instant, is_cancelled: &dyn Fn() -> bool) -> bool {
    loop {
        if is_cancelled() {
            return false;
        }
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return true;
        }
        std::thread::sleep(left.min(SLICE));
    }
}

/// How long to wait after attempt `n` failed, from 0 on. Requests that fail together do not come back together: their waits differ by a
/// quarter, by their numbers.
pub(super) fn back_off(attempt: u32, number: u64) -> Duration {
    let whole_s = (FIRST_WAIT_S * f64::from(1_u32 << attempt.min(16))).min(LONGEST_BACK_OFF_S);
    // The golden ratio spreads successive numbers.
    let spread = (number as f64 * 0.618_033_988_75).fract();
    Duration::from_secs_f64(whole_s * (0.75 + 0.5 * spread))
}

/// Wait requested by the header Retry-After: seconds, or a date as in `Wed, 21 Oct 2015 07:28:00 GMT` (RFC 9110, 10.2.3). `None` if it is neither.
pub(super) fn retry_after(header: &str, now: SystemTime) -> Option<Duration> {
    let header = header.trim();
    if !header.is_empty() && header.bytes().all(|b| b.is_ascii_digit()) {
        return header.parse().ok().map(Duration::from_secs);
    }
    let words: Vec<&str> = header.split(' ').collect();
    let [_, day, month, year, time, "GMT"] = words.as_slice() else {
        return None;
    };
    const MONTHS: [&str; 12] = [
        "Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec",
    ];
    let month = MONTHS.iter().position(|name| name == month)? as i64 + 1;
    let (day, year): (i64, i64) = (day.parse().ok()?, year.parse().ok()?);
    let parts: Vec<i64> = time
        .split(':')
        .map_while(|part| part.parse().ok())
        .collect();
    let [hours, minutes, seconds] = parts.as_slice() else {
        return None;
    };
    if !(1970..=9999).contains(&year) || !(1..=31).contains(&day) {
        return None;
    }
    let at = days_from_1970(year, month, day) * 86_400 + hours * 3600 + minutes * 60 + seconds;
    let now = now.duration_since(UNIX_EPOCH).ok()?.as_secs() as i64;
    Some(Duration::from_secs((at - now).max(0) as u64))
}

/// Days of the Gregorian calendar: years begin in March, so that leap days come last.
fn days_from_1970(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    year * 365 + year / 4 - year / 100 + year / 400 + day_of_year - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_keep_their_distance() {
        let pace = Pace::new(100.0);
        let begun = Instant::now();
        for _ in 0..6 {
            assert!(pace.wait(&|| false));
        }
        assert!(
            begun.elapsed() >= Duration::from_millis(50),
            "{:?}",
            begun.elapsed()
        );
        pace.hold(Duration::from_millis(80));
        let begun = Instant::now();
        pace.wait(&|| false);
        assert!(
            begun.elapsed() >= Duration::from_millis(80),
            "{:?}",
            begun.elapsed()
        );
        pace.hold(Duration::from_secs(3600));
        assert!(!pace.wait(&|| true));
    }

    #[test]
    fn waits_double_and_differ() {
        let waits: Vec<_> = (0..4).map(|n| back_off(n, 0).as_secs_f64()).collect();
        assert_eq!(waits, [0.375, 0.75, 1.5, 3.0]);
        assert!(back_off(40, 1) <= Duration::from_secs_f64(1.25 * LONGEST_BACK_OFF_S));
        assert_ne!(back_off(0, 1), back_off(0, 2));
    }

    #[test]
    fn servers_may_ask_for_seconds_or_a_date() {
        let now = UNIX_EPOCH + Duration::from_secs(1_445_412_480 - 90);
        assert_eq!(retry_after("120", now), Some(Duration::from_secs(120)));
        assert_eq!(
            retry_after("Wed, 21 Oct 2015 07:28:00 GMT", now),
            Some(Duration::from_secs(90))
        );
        assert_eq!(
            retry_after("Wed, 21 Oct 2000 07:28:00 GMT", now),
            Some(Duration::ZERO)
        );
        for bad in [
            "",
            "soon",
            "-1",
            "1.5",
            "Wed, 21 Oct 2015 07:28:00 CET",
            "99999999999999999999999",
        ] {
            let found = retry_after(bad, now);
            assert!(found.is_none(), "{bad}: {found:?}");
        }
    }
}
