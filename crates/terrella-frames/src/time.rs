//! UTC as people write it, leap seconds included, to and from a typed epoch.
//!
//! Epochs made here count in TAI: adding a duration adds elapsed seconds, also across a leap second. Epochs of a host in another scale are accepted
//! everywhere; `hifitime` converts them to TAI correctly. The conversion back from TAI to UTC is done here with our own table: `hifitime` 4.3
//! removes a leap second too early, by as many seconds as TAI is ahead (its `to_gregorian_utc` is one second late from 23:59:24 UTC on 31 December
//! 2016), and it cannot represent 23:59:60.
//!
//! Before 1972 UTC and TAI are treated as equal, as in `hifitime`. A date in UTC is preserved and determines the Earth's rotation; only the Sun's
//! own motion is then up to 42 s off (1.7″). The ten seconds that this convention leaves over at the end of 1971 all read 23:59:59.999.

use super::calendar::Calendar;
use super::{Duration, Epoch};
use terrella_files::{excerpt, is_unprintable};

pub(super) const NS_PER_SECOND: i64 = 1_000_000_000;
pub(super) const NS_PER_DAY: i64 = 86_400 * NS_PER_SECOND;
/// Modified Julian date of 1 January 1900, where `hifitime` counts TAI from.
pub(super) const MJD_1900: i64 = 15_020;
/// Modified Julian dates of 1 January 1970, where POSIX counts from, and of 1 January 2100.
const MJD_1970: i64 = 40_587;
const MJD_2100: i64 = 88_069;
/// Longest date text looked at: all fields, nine decimals and an offset take 35 characters.
const LONGEST_DATE: usize = 64;

/// Characters of a date, and of a time of day without seconds.
const DATE_LEN: usize = "2018-01-15".len();
const MINUTES_LEN: usize = "12:30".len();

/// Days, as modified Julian dates, from whose beginning TAI − UTC has a new value, in seconds (IERS Bulletin C).
const TAI_MINUS_UTC: [(i64, i64); 28] = [
    (41_317, 10),
    (41_499, 11),
    (41_683, 12),
    (42_048, 13),
    (42_413, 14),
    (42_778, 15),
    (43_144, 16),
    (43_509, 17),
    (43_874, 18),
    (44_239, 19),
    (44_786, 20),
    (45_151, 21),
    (45_516, 22),
    (46_247, 23),
    (47_161, 24),
    (47_892, 25),
    (48_257, 26),
    (48_804, 27),
    (49_169, 28),
    (49_534, 29),
    (50_083, 30),
    (50_630, 31),
    (51_179, 32),
    (53_736, 33),
    (54_832, 34),
    (56_109, 35),
    (57_204, 36),
    (57_754, 37),
];

/// Why a text is not a date.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum TimeError {
    /// The text has not the form of RFC 3339.
    #[error("{text:?} is not a UTC date; write it like 2018-01-15T12:00:00Z")]
    Form {
        /// The text, shortened.
        text: String,
    },
    /// The text has not the form of CCSDS 301.0-B.
    #[error(
        "{text:?} is not a date; write it like 2018-01-15T12:00:00.000 or 2018-015T12:00:00.000"
    )]
    CcsdsForm {
        /// The text, shortened.
        text: String,
    },
    /// One of its fields has a value that does not exist.
    #[error("{text:?} is not a UTC date: {field} {value} is not from {least} to {most}")]
    Field {
        /// The text that was to be read as a date.
        text: String,
        field: &'static str,
        value: i64,
        /// The least value it may have.
        least: i64,
        /// The greatest value it may have.
        most: i64,
    },
    /// Second 60 in a minute that had no leap second.
    #[error(
        "{text:?} is not a UTC date: there was no leap second then; write 59 or the next minute"
    )]
    NoLeapSecond {
        /// The text that was to be read as a date.
        text: String,
    },
    /// The system's clock shows a date that no program of today can be run at.
    #[error(
        "the system's clock shows no date of the years 1970 to 2099; set it, or write the date"
    )]
    Clock,
}

/// First and last year that [`utc_from_rfc3339`] accepts: those in which the Sun is known to better than an arc second.
const YEARS: (i64, i64) = (1900, 2099);

/// Reads a date as RFC 3339 writes it: `2018-01-15T12:00:00Z`, `2018-01-15T13:30:00.25+01:30`.
///
/// Strict: all fields in full, `T` between date and time, zone `Z` or an offset in hours and minutes. The leap second
/// 23:59:60 UTC is accepted where there was one. Decimals below a nanosecond are dropped. Years 1900…2099 in UTC.
///
/// The epoch counts in TAI, so that `epoch + duration` is elapsed time even through a leap second.
///
/// # Errors
/// Says what is wrong with the text and how to write it.
pub fn utc_from_rfc3339(text: &str) -> Result<Epoch, TimeError> {
    let reading = Reading::of(text)?;
    if reading.second == 60
        && (reading.minute_of_day != 1439 || !ends_with_leap_second(reading.mjd))
    {
        return Err(TimeError::NoLeapSecond { text: quoted(text) });
    }
    Ok(tai_from_utc_day(reading.mjd, reading.ns_of_day()))
}

/// Reads a date as people write it: as [`utc_from_rfc3339`] does, and also `2018-01-15 12:30`, `2018-01-15T12:30:00` and `2018-01-15`.
///
/// A blank may stand for `T`, seconds may be left out, and without a zone the time is UTC. A date alone is its midnight. Year, month and day are
/// written in full and in this order.
///
/// # Errors
/// Says what is wrong with the text and how to write it.
pub fn utc_from_text(text: &str) -> Result<Epoch, TimeError> {
    let form = || TimeError::Form { text: quoted(text) };
    if text.len() > LONGEST_DATE {
        return Err(form());
    }
    let (date, rest) = text.split_at_checked(DATE_LEN).ok_or_else(form)?;
    let whole = match rest.strip_prefix(['T', 't', ' ']) {
        None if rest.is_empty() || rest.eq_ignore_ascii_case("z") => format!("{date}T00:00:00Z"),
        None => return Err(form()),
        Some(time) => {
            let at = time.find(['Z', 'z', '+', '-']).unwrap_or(time.len());
            let (clock, zone) = time.split_at_checked(at).ok_or_else(form)?;
            let seconds = if clock.len() == MINUTES_LEN {
                ":00"
            } else {
                ""
            };
            let zone = if zone.is_empty() { "Z" } else { zone };
            format!("{date}T{clock}{seconds}{zone}")
        }
    };
    utc_from_rfc3339(&whole).map_err(|error| match error {
        TimeError::Form { .. } => form(),
        TimeError::NoLeapSecond { .. } => TimeError::NoLeapSecond { text: quoted(text) },
        TimeError::Field {
            field,
            value,
            least,
            most,
            ..
        } => TimeError::Field {
            text: quoted(text),
            field,
            value,
            least,
            most,
        },
        other => other,
    })
}

/// The system clock in whole seconds of UTC, so that the time can be written down and used again.
///
/// # Errors
/// A system clock before 1970 or after 2099.
pub fn utc_now() -> Result<Epoch, TimeError> {
    let since_1970 = std::time::UNIX_EPOCH.elapsed();
    let seconds = since_1970.map_err(|_| TimeError::Clock)?.as_secs();
    let seconds = i64::try_from(seconds).map_err(|_| TimeError::Clock)?;
    // POSIX counts days of 86 400 s: a leap second has no number.
    let (mjd, second) = (MJD_1970 + seconds / 86_400, seconds % 86_400);
    match mjd < MJD_2100 {
        true => Ok(tai_from_utc_day(mjd, second * NS_PER_SECOND)),
        false => Err(TimeError::Clock),
    }
}

/// The reading of a clock in any time scale.
pub(super) struct Reading {
    /// Day, as a modified Julian date.
    pub mjd: i64,
    /// 0…1439.
    pub minute_of_day: i64,
    /// 0…60.
    pub second: i64,
    /// 0…999 999 999.
    pub fraction_ns: i64,
}

impl Reading {
    /// Reads RFC 3339, the zone taken into account; second 60 is left for the caller to judge.
    pub fn of(text: &str) -> Result<Self, TimeError> {
        let form = || TimeError::Form { text: quoted(text) };
        let check = |field, value: i64, least: i64, most: i64| {
            if (least..=most).contains(&value) {
                Ok(value)
            } else {
                Err(TimeError::Field {
                    text: quoted(text),
                    field,
                    value,
                    least,
                    most,
                })
            }
        };
        if text.len() > LONGEST_DATE {
            return Err(form());
        }
        let (date_time, fraction, zone) = split(text.as_bytes()).ok_or_else(form)?;
        let number = |first, len| number(date_time, first, len).ok_or_else(form);

        let date = Calendar {
            year: number(0, 4)?,
            month: check("month", number(5, 2)?, 1, 12)?,
            day: number(8, 2)?,
        };
        check("day", date.day, 1, date.days_in_month())?;
        let hour = check("hour", number(11, 2)?, 0, 23)?;
        let minute = check("minute", number(14, 2)?, 0, 59)?;
        let second = check("second", number(17, 2)?, 0, 60)?;
        let offset_minutes = match zone {
            Zone::Utc => 0,
            Zone::Ahead(hours, minutes) => {
                check("offset hour", hours.abs(), 0, 23)?;
                hours * 60 + check("offset minute", minutes.abs(), 0, 59)? * minutes.signum()
            }
        };

        // Minutes first: the leap second ends a UTC day, whatever the local clock shows.
        let minutes = hour * 60 + minute - offset_minutes;
        let mjd = date.mjd() + minutes.div_euclid(1440);
        let minute_of_day = minutes.rem_euclid(1440);
        check("year", Calendar::from_mjd(mjd).year, YEARS.0, YEARS.1)?;
        Ok(Self {
            mjd,
            minute_of_day,
            second,
            fraction_ns: fraction,
        })
    }

    pub fn ns_of_day(&self) -> i64 {
        (self.minute_of_day * 60 + self.second) * NS_PER_SECOND + self.fraction_ns
    }
}

/// Writes an epoch in UTC with milliseconds, rounded: `2018-01-15T12:00:00.000Z`; a leap second as `23:59:60`.
///
/// Years outside 0…9999 get a sign and as many digits as they need.
pub fn rfc3339(epoch: Epoch) -> String {
    rfc3339_with_offset(epoch, 0)
}

/// The same in a time zone so many minutes east of UTC: `2018-01-15T13:00:00.000+01:00`; with 0 as [`rfc3339`].
pub fn rfc3339_with_offset(epoch: Epoch, offset_min: i32) -> String {
    const NS_PER_MS: i128 = 1_000_000;
    let tai_ns = epoch.to_tai_duration().total_nanoseconds();
    // Rounded before the split, so that a carry runs through second, day and leap second.
    let rounded_ns = (tai_ns + NS_PER_MS / 2).div_euclid(NS_PER_MS) * NS_PER_MS;
    let (mjd, ns_of_day) = utc_day_from_tai_ns(rounded_ns);
    let ms_of_day = ns_of_day / 1_000_000;
    let second_of_day = ms_of_day / 1000;
    // The leap second belongs to the last minute of its day.
    let minute_of_day = (second_of_day / 60).min(1439);
    let second = second_of_day - minute_of_day * 60;
    // Minutes start at the same time in all zones, and leap seconds end them.
    let minute = minute_of_day + i64::from(offset_min);
    let date = Calendar::from_mjd(mjd + minute.div_euclid(1440));
    let minute_of_day = minute.rem_euclid(1440);
    let year = match date.year {
        0..=9999 => format!("{:04}", date.year),
        _ => format!("{:+05}", date.year),
    };
    let zone = match (offset_min, offset_min.unsigned_abs()) {
        (0, _) => "Z".to_owned(),
        (east, minutes) => {
            let sign = if east > 0 { '+' } else { '-' };
            format!("{sign}{:02}:{:02}", minutes / 60, minutes % 60)
        }
    };
    format!(
        "{year}-{:02}-{:02}T{:02}:{:02}:{second:02}.{:03}{zone}",
        date.month,
        date.day,
        minute_of_day / 60,
        minute_of_day % 60,
        ms_of_day % 1000
    )
}

/// A Julian date in two parts, midnight and the time since then, which together lose no precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JulianDate {
    /// Julian date of the midnight before.
    pub midnight: f64,
    /// Days since, 0…1, and a little more in a leap second.
    pub fraction: f64,
}

impl JulianDate {
    fn new(mjd: i64, ns_of_day: i64) -> Self {
        Self {
            midnight: mjd as f64 + 2_400_000.5,
            fraction: ns_of_day as f64 / NS_PER_DAY as f64,
        }
    }

    pub fn utc(epoch: Epoch) -> Self {
        let (mjd, ns) = utc_day_from_tai_ns(epoch.to_tai_duration().total_nanoseconds());
        Self::new(mjd, ns)
    }

    /// In terrestrial time, TT = TAI + 32.184 s. Good for TDB too, from which it differs by 2 ms at most.
    pub fn tt(epoch: Epoch) -> Self {
        let ns = epoch.to_tai_duration().total_nanoseconds() + 32_184_000_000;
        let (mjd, ns) = day_and_rest(ns);
        Self::new(mjd, ns)
    }
}

/// The epoch, in TAI, at which UTC reads day `mjd` and `ns_of_day`; from 86 400 s on, a leap second.
pub fn tai_from_utc_day(mjd: i64, ns_of_day: i64) -> Epoch {
    let ns = i128::from(mjd - MJD_1900) * i128::from(NS_PER_DAY)
        + i128::from(ns_of_day)
        + i128::from(tai_minus_utc_s(mjd) * NS_PER_SECOND);
    Epoch::from_tai_duration(Duration::from_total_nanoseconds(ns))
}

/// Day, as a modified Julian date, and nanosecond of the day that UTC reads; 86 400 s and more in a leap second.
pub fn utc_day(epoch: Epoch) -> (i64, i64) {
    utc_day_from_tai_ns(epoch.to_tai_duration().total_nanoseconds())
}

/// Day, as a modified Julian date, and nanosecond of the day that UTC reads; 86 400 s and more in a leap second.
pub(super) fn utc_day_from_tai_ns(tai_ns: i128) -> (i64, i64) {
    let begins_ns = |&(mjd, offset_s): &(i64, i64)| {
        i128::from(mjd - MJD_1900) * i128::from(NS_PER_DAY) + i128::from(offset_s * NS_PER_SECOND)
    };
    let next = TAI_MINUS_UTC.partition_point(|step| begins_ns(step) <= tai_ns);
    let offset_s = next
        .checked_sub(1)
        .and_then(|k| TAI_MINUS_UTC.get(k))
        .map_or(0, |step| step.1);
    let (mjd, ns) = day_and_rest(tai_ns - i128::from(offset_s * NS_PER_SECOND));
    match TAI_MINUS_UTC.get(next) {
        // The day of the next step has not begun: what runs past midnight belongs to the day before.
        Some(step) if step.0 == mjd && next > 0 => (mjd - 1, NS_PER_DAY + ns),
        Some(step) if step.0 == mjd => (mjd - 1, NS_PER_DAY - 1_000_000),
        _ => (mjd, ns),
    }
}

pub(super) fn day_and_rest(ns_since_1900: i128) -> (i64, i64) {
    let day = i128::from(NS_PER_DAY);
    // An epoch spans ±3.3 million years: a day number far inside i64.
    (
        ns_since_1900.div_euclid(day) as i64 + MJD_1900,
        ns_since_1900.rem_euclid(day) as i64,
    )
}

/// TAI − UTC through the day `mjd`, its leap second included, seconds; 0 before 1972.
pub(super) fn tai_minus_utc_s(mjd: i64) -> i64 {
    let next = TAI_MINUS_UTC.partition_point(|step| step.0 <= mjd);
    next.checked_sub(1)
        .and_then(|k| TAI_MINUS_UTC.get(k))
        .map_or(0, |step| step.1)
}

fn ends_with_leap_second(mjd: i64) -> bool {
    // The first entry began modern UTC with ten seconds; it was no leap second.
    TAI_MINUS_UTC
        .iter()
        .skip(1)
        .any(|step| step.0 == mjd.saturating_add(1))
}

enum Zone {
    Utc,
    /// Hours and minutes that the clock is ahead of UTC, both with the sign.
    Ahead(i64, i64),
}

/// `YYYY-MM-DDTHH:MM:SS`, nanoseconds, zone; `None` if a separator or a digit is missing.
fn split(text: &[u8]) -> Option<(&[u8], i64, Zone)> {
    let (date_time, rest) = text.split_at_checked(19)?;
    let separators = [(4, b'-'), (7, b'-'), (13, b':'), (16, b':')];
    if separators
        .iter()
        .any(|&(at, sign)| date_time.get(at) != Some(&sign))
        || !matches!(date_time.get(10), Some(b'T' | b't'))
    {
        return None;
    }
    let (fraction, zone) = match rest.split_first() {
        Some((b'.', decimals)) => {
            let len = decimals.iter().take_while(|c| c.is_ascii_digit()).count();
            let (digits, zone) = decimals.split_at_checked(len)?;
            if digits.is_empty() {
                return None;
            }
            let mut ns = 0;
            for k in 0..9 {
                ns = ns * 10 + digits.get(k).map_or(0, |c| i64::from(c - b'0'));
            }
            (ns, zone)
        }
        _ => (0, rest),
    };
    let zone = match zone {
        b"Z" | b"z" => Zone::Utc,
        [sign @ (b'+' | b'-'), _, _, b':', _, _] => {
            let (hours, minutes) = (number(zone, 1, 2)?, number(zone, 4, 2)?);
            if *sign == b'+' {
                Zone::Ahead(hours, minutes)
            } else {
                Zone::Ahead(-hours, -minutes)
            }
        }
        _ => return None,
    };
    Some((date_time, fraction, zone))
}

/// The decimal number in `len` characters from `first`.
fn number(text: &[u8], first: usize, len: usize) -> Option<i64> {
    text.get(first..first + len)?.iter().try_fold(0, |n, c| {
        c.is_ascii_digit().then(|| n * 10 + i64::from(c - b'0'))
    })
}

/// Quotes an invalid text, unless it is long: blanks around it may be the error.
fn quoted(text: &str) -> String {
    const SHORT: usize = 40;
    match text.len() <= SHORT && !text.contains(is_unprintable) {
        true => text.to_owned(),
        false => excerpt(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leap_seconds_are_those_of_the_sofa_table() {
        for mjd in 41_317..61_000 {
            let c = Calendar::from_mjd(mjd);
            let sofa = sofars::ts::dat(c.year as i32, c.month as i32, c.day as i32, 0.5).unwrap();
            assert_eq!(tai_minus_utc_s(mjd) as f64, sofa, "{c:?}");
        }
    }

    #[test]
    fn an_offset_moves_the_calendar_and_no_leap_second() {
        let at = |text: &str, offset_min| {
            rfc3339_with_offset(utc_from_rfc3339(text).expect("a date"), offset_min)
        };
        assert_eq!(
            at("2018-01-15T12:00:00Z", 60),
            "2018-01-15T13:00:00.000+01:00"
        );
        assert_eq!(
            at("2018-01-01T01:15:30.5Z", -210),
            "2017-12-31T21:45:30.500-03:30"
        );
        assert_eq!(
            at("2016-02-28T20:00:00Z", 345),
            "2016-02-29T01:45:00.000+05:45"
        );
        assert_eq!(
            at("2016-12-31T23:59:60Z", 60),
            "2017-01-01T00:59:60.000+01:00"
        );
        assert_eq!(
            at("2016-12-31T23:30:00Z", 60),
            "2017-01-01T00:30:00.000+01:00"
        );
        assert_eq!(at("2018-01-15T12:00:00Z", 0), "2018-01-15T12:00:00.000Z");
    }

    #[test]
    fn tai_and_utc_are_inverse_around_every_step() {
        for &(mjd, _) in &TAI_MINUS_UTC[1..] {
            for ms in -70_000..5_000 {
                let ns = (86_401_000 + i64::from(ms)) * 1_000_000;
                let (mjd, ns) = if ns < 86_401 * NS_PER_SECOND {
                    (mjd - 1, ns)
                } else {
                    (mjd, ns - 86_401 * NS_PER_SECOND)
                };
                let tai = tai_from_utc_day(mjd, ns).to_tai_duration();
                assert_eq!(utc_day_from_tai_ns(tai.total_nanoseconds()), (mjd, ns));
            }
        }
    }

    #[test]
    fn now_is_what_another_clock_says() {
        assert_eq!(Calendar::from_mjd(MJD_1970).year, 1970);
        assert_eq!(Calendar::from_mjd(MJD_2100).year, 2100);
        assert_eq!(Calendar::from_mjd(MJD_2100 - 1).year, 2099);
        // hifitime reads the clock itself only where its `std` is on.
        let since_1970_s = std::time::UNIX_EPOCH.elapsed().unwrap().as_secs_f64();
        let (now, other) = (utc_now().unwrap(), Epoch::from_unix_seconds(since_1970_s));
        let apart_s = (other - now).to_seconds();
        assert!((0.0..10.0).contains(&apart_s), "{apart_s}");
        assert!(rfc3339(now).ends_with(".000Z"), "{}", rfc3339(now));
    }

    #[test]
    fn julian_dates_of_j2000() {
        let j2000 = utc_from_rfc3339("2000-01-01T11:58:55.816Z").unwrap();
        let tt = JulianDate::tt(j2000);
        assert_eq!((tt.midnight, tt.fraction), (2_451_544.5, 0.5));
        let utc = JulianDate::utc(j2000);
        assert_eq!(utc.midnight, 2_451_544.5);
        assert!((utc.fraction - (0.5 - 64.184 / 86_400.0)).abs() < 1e-15);
    }
}
