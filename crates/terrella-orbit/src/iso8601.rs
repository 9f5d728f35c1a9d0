//! Dates as ISO 8601 writes them: basic and extended, to any unit, by month, week or day of the year, with any zone.

use terrella_files::excerpt;
use terrella_frames::{Calendar, Duration, Epoch, TimeError, utc_from_rfc3339};

/// Longest date read, bytes.
const LONGEST: usize = 64;
/// Years that an epoch is read from.
const YEARS: std::ops::RangeInclusive<i64> = 1900..=2099;
/// Days of half a millennium, by which an unbounded interval goes beyond 1900.
const FAR_DAYS: i128 = 500 * 365;

/// Parses a date in UTC; a date without a zone is in UTC too. A blank may replace the `T`.
///
/// # Errors
/// Names the error in the text, and how to write it.
pub(super) fn epoch(text: &str) -> Result<Epoch, TimeError> {
    Written::of(text)?.epoch(text)
}

/// As [`epoch`], for an end of an interval: years outside 1900…2099 (`0000-00-00`, `9999-12-31T24:00:00Z`) leave it open.
///
/// # Errors
/// As [`epoch`].
pub(super) fn bound(text: &str) -> Result<Epoch, TimeError> {
    let written = Written::of(text)?;
    match written.year {
        year if year < *YEARS.start() => Ok(earliest()),
        year if year > *YEARS.end() => Ok(latest()),
        _ => written.epoch(text),
    }
}

/// Earlier than all dates that are read.
pub(super) fn earliest() -> Epoch {
    far(-FAR_DAYS)
}

/// Later than all dates that are read.
pub(super) fn latest() -> Epoch {
    far(FAR_DAYS)
}

fn far(days: i128) -> Epoch {
    Epoch::from_tai_duration(Duration::from_total_nanoseconds(
        days * 86_400 * 1_000_000_000,
    ))
}

/// The fields of a date as they are written.
struct Written {
    year: i64,
    month: i64,
    day: i64,
    /// Hour, minute and second.
    clock: [i64; 3],
    fraction_ns: i64,
    /// `Z`, or `+hh:mm`.
    zone: String,
}

impl Written {
    fn of(text: &str) -> Result<Self, TimeError> {
        let form = || TimeError::CcsdsForm {
            text: excerpt(text),
        };
        let text = text.trim();
        if text.len() > LONGEST {
            return Err(form());
        }
        let (date, time) = match text.split_once(['T', 't', ' ']) {
            Some((date, time)) => (date, Some(time.trim_start())),
            None => (text, None),
        };
        let (year, month, day) = calendar(date).ok_or_else(form)?;
        let mut written = Self {
            year,
            month,
            day,
            clock: [0; 3],
            fraction_ns: 0,
            zone: "Z".to_owned(),
        };
        if let Some(time) = time {
            written.time(time).ok_or_else(form)?;
        }
        Ok(written)
    }

    /// The time of the day and the zone.
    fn time(&mut self, text: &str) -> Option<()> {
        let utc = text.strip_suffix(['Z', 'z']).or(text.strip_suffix(" UTC"));
        let (clock, zone) = match utc {
            Some(clock) => (clock.trim_end(), "Z".to_owned()),
            None => match text.rfind(['+', '-']) {
                Some(at) => (text.get(..at)?.trim_end(), zone(text.get(at..)?)?),
                None => (text, "Z".to_owned()),
            },
        };
        self.zone = zone;
        let (whole, fraction) = match clock.split_once(['.', ',']) {
            Some((whole, fraction)) => (whole, Some(fraction)),
            None => (clock, None),
        };
        if !matches!(
            pattern(whole).as_str(),
            "dd" | "dddd" | "dd:dd" | "dddddd" | "dd:dd:dd"
        ) {
            return None;
        }
        let digits: String = whole.chars().filter(char::is_ascii_digit).collect();
        let fields = digits.len() / 2;
        for (at, field) in self.clock.iter_mut().enumerate().take(fields) {
            *field = digits.get(2 * at..2 * at + 2)?.parse().ok()?;
        }
        if let Some(fraction) = fraction {
            self.add_fraction(fraction, fields)?;
        }
        // The midnight that ends a day.
        if self.clock == [24, 0, 0] && self.fraction_ns == 0 {
            let date = Calendar {
                year: self.year,
                month: self.month,
                day: self.day,
            };
            let next = Calendar::from_mjd(date.mjd() + 1);
            // A day that does not exist is left as it is, for its error.
            if (1..=12).contains(&self.month) && self.day <= date.days_in_month() {
                (self.year, self.month, self.day) = (next.year, next.month, next.day);
                self.clock = [0; 3];
            }
        }
        Some(())
    }

    /// A fraction of the last of so many fields.
    fn add_fraction(&mut self, text: &str, fields: usize) -> Option<()> {
        if text.is_empty() || !text.bytes().all(|c| c.is_ascii_digit()) {
            return None;
        }
        let digits = text.get(..text.len().min(12))?;
        let unit_s: i64 = match fields {
            1 => 3600,
            2 => 60,
            _ => 1,
        };
        let parts = digits.parse::<i128>().ok()? * i128::from(unit_s) * 1_000_000_000;
        let ns = parts / 10_i128.pow(u32::try_from(digits.len()).ok()?);
        let seconds = i64::try_from(ns / 1_000_000_000).ok()?;
        self.fraction_ns = i64::try_from(ns % 1_000_000_000).ok()?;
        let [_, minute, second] = &mut self.clock;
        match fields {
            1 => (*minute, *second) = (seconds / 60, seconds % 60),
            2 => *second = seconds,
            _ => {}
        }
        Some(())
    }

    fn epoch(&self, text: &str) -> Result<Epoch, TimeError> {
        let [hour, minute, second] = self.clock;
        let rfc3339 = format!(
            "{:04}-{:02}-{:02}T{hour:02}:{minute:02}:{second:02}.{:09}{}",
            self.year, self.month, self.day, self.fraction_ns, self.zone
        );
        utc_from_rfc3339(&rfc3339).map_err(|error| match error {
            TimeError::Form { .. } => TimeError::CcsdsForm {
                text: excerpt(text),
            },
            other => other,
        })
    }
}

/// The text with a `d` for each digit.
fn pattern(text: &str) -> String {
    let digit = |c: char| match c {
        '0'..='9' => 'd',
        'd' => '?',
        other => other,
    };
    text.chars().map(digit).collect()
}

/// Year, month and day.
fn calendar(date: &str) -> Option<(i64, i64, i64)> {
    let digits: String = date.chars().filter(char::is_ascii_digit).collect();
    let number = |from: usize, to: usize| digits.get(from..to)?.parse::<i64>().ok();
    let year = number(0, 4)?;
    let january = Calendar {
        year,
        month: 1,
        day: 1,
    };
    let by_number = |mjd: i64| {
        let date = Calendar::from_mjd(mjd);
        (date.year, date.month, date.day)
    };
    match pattern(date).as_str() {
        "dddd-dd-dd" | "dddddddd" => Some((year, number(4, 6)?, number(6, 8)?)),
        "dddd-dd" => Some((year, number(4, 6)?, 1)),
        "dddd" => Some((year, 1, 1)),
        "dddd-ddd" | "ddddddd" => {
            let day = number(4, 7)?;
            let found = by_number(january.mjd() + day - 1);
            (day > 0 && found.0 == year).then_some(found)
        }
        "dddd-Wdd-d" | "ddddWddd" => by_week(january, number(4, 6)?, number(6, 7)?).map(by_number),
        "dddd-Wdd" | "ddddWdd" => by_week(january, number(4, 6)?, 1).map(by_number),
        _ => None,
    }
}

/// The day in an ISO week, Monday being 1: the first week contains 4 January.
fn by_week(january: Calendar, week: i64, weekday: i64) -> Option<i64> {
    if !(1..=53).contains(&week) || !(1..=7).contains(&weekday) {
        return None;
    }
    let fourth = january.mjd() + 3;
    // MJD 0 was a Wednesday.
    let monday = fourth - (fourth + 2).rem_euclid(7);
    Some(monday + 7 * (week - 1) + weekday - 1)
}

/// A zone as RFC 3339 writes it.
fn zone(text: &str) -> Option<String> {
    let digits: String = text.chars().filter(char::is_ascii_digit).collect();
    let sign = text.get(..1)?;
    match pattern(text.get(1..)?).as_str() {
        "dd" => Some(format!("{sign}{digits}:00")),
        "dddd" | "dd:dd" => Some(format!("{sign}{}:{}", digits.get(..2)?, digits.get(2..)?)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_forms_name_the_same_instant() {
        let midnight = utc_from_rfc3339("2026-03-01T00:00:00Z").unwrap();
        for text in [
            "2026-03-01T00:00:00.000Z",
            "2026-03-01T00:00:00",
            "20260301T000000Z",
            "20260301T0000Z",
            "20260301T00Z",
            "2026-03-01 00:00:00",
            "2026-03-01",
            "20260301",
            "2026-03",
            "2026-060T00Z",
            "2026060",
            "2026-W09-7",
            "2026W097T00:00Z",
            "2026-02-28T24:00:00Z",
            "20260228T24Z",
            "2026-02-28T21:00:00-03:00",
            "2026-02-28T2100-03",
            "2026-03-01T05:30:00+0530",
        ] {
            assert_eq!(epoch(text), Ok(midnight), "{text}");
        }
        let later = |s: f64| midnight + Duration::from_seconds(s);
        for (text, s) in [
            ("2026-03-01T00:00:12.5Z", 12.5),
            ("20260301T000012,5Z", 12.5),
            ("2026-03-01T00:30.5Z", 1830.0),
            ("20260301T01.25Z", 4500.0),
        ] {
            assert_eq!(epoch(text), Ok(later(s)), "{text}");
        }
        // A week that begins in the year before.
        let monday = utc_from_rfc3339("2024-12-30T00:00:00Z").unwrap();
        assert_eq!(epoch("2025-W01"), Ok(monday));
    }

    #[test]
    fn other_texts_are_rejected() {
        for text in [
            "",
            "T",
            "yesterday",
            "2026-3-1",
            "2026-03-01T",
            "2026-03-01T0",
            "2026-03-01TZ",
            "2026-366",
            "2026-000",
            "2026-W54-1",
            "2026-03-01T12:0",
            "2026-03-01T12:00:00+1",
            "2026-03-01T12:00:00.Z",
            "2026-03-01T12:00:00ZZ",
            "é026-03-01",
            "2026-03-01T12-é0",
        ] {
            assert!(
                matches!(epoch(text), Err(TimeError::CcsdsForm { .. })),
                "{text}"
            );
        }
        for text in [
            "2026-13-01",
            "2026-02-30T24:00",
            "2026-03-01T25Z",
            "1850-01-01",
            "2026-03-01T24:01Z",
        ] {
            assert!(
                matches!(epoch(text), Err(TimeError::Field { .. })),
                "{text}"
            );
        }
    }

    #[test]
    fn intervals_may_be_open() {
        for text in ["0000-00-00T00:00:00Z", "00000000T00Z", "0001-01-01"] {
            assert_eq!(bound(text), Ok(earliest()), "{text}");
        }
        for text in ["9999-12-31T24:00:00Z", "99991231T24Z"] {
            assert_eq!(bound(text), Ok(latest()), "{text}");
        }
        let first = utc_from_rfc3339("1900-01-01T00:00:00Z").unwrap();
        let last = utc_from_rfc3339("2099-12-31T23:59:59Z").unwrap();
        assert!(earliest() < first && last < latest());
        assert_eq!(bound("1900-01-01"), Ok(first));
        assert!(bound("never").is_err());
    }
}
