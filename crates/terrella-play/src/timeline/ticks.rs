//! Ticks of the time line, and their labels.

use terrella::frames::{Calendar, Epoch, tai_from_utc_day, utc_day};

const DAY_S: i64 = 86_400;
const NS: i64 = 1_000_000_000;

/// Steps that people count in, seconds; each divides a day, or is whole days.
const STEPS_S: [i64; 30] = [
    1,
    2,
    5,
    10,
    15,
    30,
    60,
    2 * 60,
    5 * 60,
    10 * 60,
    15 * 60,
    30 * 60,
    3600,
    2 * 3600,
    3 * 3600,
    6 * 3600,
    12 * 3600,
    DAY_S,
    2 * DAY_S,
    5 * DAY_S,
    10 * DAY_S,
    20 * DAY_S,
    50 * DAY_S,
    100 * DAY_S,
    200 * DAY_S,
    500 * DAY_S,
    1000 * DAY_S,
    5000 * DAY_S,
    10_000 * DAY_S,
    20_000 * DAY_S,
];

/// A mark at a round UTC time.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Where on the line, 0…1.
    pub fraction: f64,
    /// Its label: the time of day, or the date at midnight.
    pub label: String,
}

/// At most `max_count` ticks of the span, at a round step of UTC. None where even a second is too long or the longest step too
/// short.
pub fn ticks((first, last): (Epoch, Epoch), max_count: usize) -> Vec<Tick> {
    let length_s = (last - first).to_seconds();
    let fits = |step: &&i64| length_s / **step as f64 <= max_count as f64;
    let Some(step_s) = STEPS_S.iter().find(fits).copied() else {
        return Vec::new();
    };
    let (mjd, ns) = utc_day(first);
    // A leap second's count of 86 400 s belongs to its day; steps begin again each midnight.
    let begin_s = mjd * DAY_S + (ns.div_euclid(NS)).min(DAY_S - 1);
    let aligned = begin_s.div_euclid(step_s);
    (aligned..)
        .take(max_count + 2)
        .filter_map(|k| {
            let at_s = k * step_s;
            let (mjd, second) = (at_s.div_euclid(DAY_S), at_s.rem_euclid(DAY_S));
            let fraction = (tai_from_utc_day(mjd, second * NS) - first).to_seconds() / length_s;
            let label = || label(mjd, second, step_s);
            (0.0..=1.0).contains(&fraction).then(|| Tick {
                fraction,
                label: label(),
            })
        })
        .collect()
}

fn label(mjd: i64, second: i64, step_s: i64) -> String {
    let (hour, minute) = (second / 3600, second / 60 % 60);
    if second == 0 {
        let date = Calendar::from_mjd(mjd);
        format!("{:04}-{:02}-{:02}", date.year, date.month, date.day)
    } else if step_s < 60 {
        format!("{hour:02}:{minute:02}:{:02}", second % 60)
    } else {
        format!("{hour:02}:{minute:02}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella::frames::utc_from_rfc3339;

    fn labels(first: &str, last: &str, max_count: usize) -> Vec<String> {
        let at = |text| utc_from_rfc3339(text).expect("a date");
        let ticks = ticks((at(first), at(last)), max_count);
        assert!(ticks.len() <= max_count + 1);
        assert!(
            ticks
                .windows(2)
                .all(|pair| pair[0].fraction < pair[1].fraction)
        );
        ticks.into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn ticks_stand_at_round_times() {
        assert_eq!(
            labels("2018-01-15T06:07:00Z", "2018-01-15T06:37:00Z", 6),
            ["06:10", "06:15", "06:20", "06:25", "06:30", "06:35"]
        );
        assert_eq!(
            labels("2018-01-15T23:59:45.5Z", "2018-01-16T00:00:15Z", 5),
            ["23:59:50", "2018-01-16", "00:00:10"]
        );
        assert_eq!(
            labels("2018-02-27T12:00:00Z", "2018-03-02T12:00:00Z", 4),
            ["2018-02-28", "2018-03-01", "2018-03-02"]
        );
        assert_eq!(
            labels("2018-01-15T00:00:00Z", "2018-01-15T00:00:00.4Z", 4),
            ["2018-01-15"]
        );
        assert_eq!(
            labels("2018-01-15T00:00:00.1Z", "2018-01-15T00:00:00.4Z", 4),
            [""; 0]
        );
        assert!(labels("1900-01-02T00:00:00Z", "2099-12-31T00:00:00Z", 8).len() > 3);
    }

    #[test]
    fn a_leap_second_moves_the_ticks_behind_it() {
        let at = |text| utc_from_rfc3339(text).expect("a date");
        let (first, last) = (at("2016-12-31T23:59:30Z"), at("2017-01-01T00:00:29Z"));
        let ticks = ticks((first, last), 6);
        let midnight = ticks
            .iter()
            .find(|tick| tick.label == "2017-01-01")
            .expect("there");
        // 31 of the span's 60 seconds.
        assert!((midnight.fraction - 31.0 / 60.0).abs() < 1e-9, "{ticks:?}");
        let inside = labels("2016-12-31T23:59:60.5Z", "2017-01-01T00:00:10Z", 12);
        assert_eq!(inside[0], "2017-01-01");
    }
}
