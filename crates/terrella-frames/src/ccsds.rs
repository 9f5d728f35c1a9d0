//! Dates as messages of the CCSDS write them (ASCII time codes A and B of CCSDS 301.0-B), in four time scales.

use super::calendar::Calendar;
use super::time::{
    JulianDate, MJD_1900, NS_PER_DAY, NS_PER_SECOND, Reading, day_and_rest, utc_day_from_tai_ns,
};
use super::{Duration, Epoch, TimeError, utc_from_rfc3339};
use terrella_files::excerpt;

/// A scale that dates are written in. Others (UT1, TDB, Moon time…) are not TAI and a constant, or UTC, and are not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeScale {
    /// Coordinated universal time, with leap seconds.
    Utc,
    /// International atomic time.
    Tai,
    /// Terrestrial time, TAI + 32.184 s.
    Tt,
    /// Time of the Global Positioning System, TAI − 19 s.
    Gps,
}

impl TimeScale {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Utc, Self::Tai, Self::Tt, Self::Gps];

    /// As `TIME_SYSTEM` names it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Utc => "UTC",
            Self::Tai => "TAI",
            Self::Tt => "TT",
            Self::Gps => "GPS",
        }
    }

    /// The scale of that name, letter case aside.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|scale| scale.name().eq_ignore_ascii_case(name))
    }

    /// How far it is ahead of TAI, nanoseconds; UTC by a table.
    fn ahead_of_tai_ns(self) -> Option<i64> {
        match self {
            Self::Utc => None,
            Self::Tai => Some(0),
            Self::Tt => Some(32_184_000_000),
            Self::Gps => Some(-19 * NS_PER_SECOND),
        }
    }
}

/// Reads `2018-01-15T12:00:00.25` or `2018-015T12:00:00.25`, with or without a `Z` at the end.
///
/// Decimals below a nanosecond are dropped. Years 1900…2099. In UTC the leap second 23:59:60 is accepted where there was one.
///
/// # Errors
/// Says what is wrong with the text and how to write it.
pub fn epoch_from_ccsds(text: &str, scale: TimeScale) -> Result<Epoch, TimeError> {
    let form = || TimeError::CcsdsForm {
        text: excerpt(text),
    };
    let named = |error| match error {
        TimeError::Form { .. } => form(),
        other => other,
    };
    let (date, time) = text.split_once('T').ok_or_else(form)?;
    let time = time.strip_suffix('Z').unwrap_or(time);
    // A zone is no part of this form.
    if !time.bytes().all(|c| matches!(c, b'0'..=b'9' | b':' | b'.')) {
        return Err(form());
    }
    let calendar_date = match date.len() {
        8 => from_day_of_year(date).ok_or_else(form)?,
        _ => date.to_owned(),
    };
    let rfc3339 = format!("{calendar_date}T{time}Z");
    let Some(ahead_ns) = scale.ahead_of_tai_ns() else {
        return utc_from_rfc3339(&rfc3339).map_err(named);
    };
    let reading = Reading::of(&rfc3339).map_err(named)?;
    if reading.second == 60 {
        return Err(TimeError::NoLeapSecond {
            text: excerpt(text),
        });
    }
    let ns = i128::from(reading.mjd - MJD_1900) * i128::from(NS_PER_DAY)
        + i128::from(reading.ns_of_day() - ahead_ns);
    Ok(Epoch::from_tai_duration(Duration::from_total_nanoseconds(
        ns,
    )))
}

/// As [`epoch_from_ccsds`], of a date in barycentric dynamical time, TDB; good to 10 µs in 1600…2200.
///
/// # Errors
/// As [`epoch_from_ccsds`].
pub fn epoch_from_tdb(text: &str) -> Result<Epoch, TimeError> {
    let epoch = epoch_from_ccsds(text, TimeScale::Tt)?;
    let tt = JulianDate::tt(epoch);
    let ns = (tdb_minus_tt_s(&tt) * 1e9).round() as i128;
    Ok(epoch - Duration::from_total_nanoseconds(ns))
}

/// TDB − TT, seconds (Kaplan, US Naval Observatory Circular 179, 2005, equation 2.6).
fn tdb_minus_tt_s(tt: &JulianDate) -> f64 {
    let t = ((tt.midnight - 2_451_545.0) + tt.fraction) / 36_525.0;
    0.001_657 * (628.307_6 * t + 6.240_1).sin()
        + 0.000_022 * (575.338_5 * t + 4.297_0).sin()
        + 0.000_014 * (1_256.615_2 * t + 6.196_9).sin()
        + 0.000_005 * (606.977_7 * t + 4.021_2).sin()
        + 0.000_005 * (52.969_1 * t + 0.444_4).sin()
        + 0.000_002 * (21.329_9 * t + 5.543_1).sin()
        + 0.000_010 * t * (628.307_6 * t + 4.249_0).sin()
}

/// Writes an epoch so that [`epoch_from_ccsds`] reads the same one back: to the nanosecond, three decimals at least.
pub fn ccsds_time(epoch: Epoch, scale: TimeScale) -> String {
    let tai_ns = epoch.to_tai_duration().total_nanoseconds();
    let (mjd, ns_of_day) = match scale.ahead_of_tai_ns() {
        None => utc_day_from_tai_ns(tai_ns),
        Some(ahead_ns) => day_and_rest(tai_ns + i128::from(ahead_ns)),
    };
    let date = Calendar::from_mjd(mjd);
    let second_of_day = ns_of_day / NS_PER_SECOND;
    // The leap second belongs to the last minute of its day.
    let minute_of_day = (second_of_day / 60).min(1439);
    let nanoseconds = format!("{:09}", ns_of_day % NS_PER_SECOND);
    let decimals = nanoseconds.trim_end_matches('0').len().max(3);
    format!(
        "{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{}",
        date.year,
        date.month,
        date.day,
        minute_of_day / 60,
        minute_of_day % 60,
        second_of_day - minute_of_day * 60,
        nanoseconds.get(..decimals).unwrap_or(&nanoseconds)
    )
}

/// `2018-015` as `2018-01-15`.
fn from_day_of_year(date: &str) -> Option<String> {
    let (year, day) = date.split_once('-')?;
    let digits = |text: &str| text.bytes().all(|c| c.is_ascii_digit());
    if year.len() != 4 || day.len() != 3 || !digits(year) || !digits(day) {
        return None;
    }
    let year: i64 = year.parse().ok()?;
    let day: i64 = day.parse().ok()?;
    let january = Calendar {
        year,
        month: 1,
        day: 1,
    };
    let date = Calendar::from_mjd(january.mjd() + day - 1);
    (date.year == year && day > 0)
        .then(|| format!("{:04}-{:02}-{:02}", date.year, date.month, date.day))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utc(text: &str) -> Epoch {
        utc_from_rfc3339(text).unwrap()
    }

    #[test]
    fn four_scales_name_the_same_instant() {
        let instant = utc("2018-01-15T12:00:00Z");
        for (scale, text) in [
            (TimeScale::Utc, "2018-01-15T12:00:00"),
            (TimeScale::Utc, "2018-015T12:00:00.000Z"),
            (TimeScale::Tai, "2018-01-15T12:00:37"),
            (TimeScale::Tt, "2018-01-15T12:01:09.184"),
            (TimeScale::Gps, "2018-015T12:00:18.0"),
        ] {
            assert_eq!(epoch_from_ccsds(text, scale), Ok(instant), "{text}");
        }
        assert_eq!(TimeScale::from_name("gps"), Some(TimeScale::Gps));
        assert_eq!(TimeScale::from_name("UT1"), None);
    }

    /// Against the series of Fairhead and Bretagnon (1990) in SOFA's `dtdb`, from the Earth's centre.
    #[test]
    fn barycentric_time_is_good_to_ten_microseconds() {
        let mut worst_s = 0.0_f64;
        for k in 0..400 {
            let epoch = utc("1950-01-01T00:00:00Z") + Duration::from_seconds(f64::from(k) * 1e7);
            let tt = JulianDate::tt(epoch);
            let theirs_s = sofars::ts::dtdb(tt.midnight, tt.fraction, 0.0, 0.0, 0.0, 0.0);
            worst_s = worst_s.max((tdb_minus_tt_s(&tt) - theirs_s).abs());
        }
        println!("{:.1} µs", worst_s * 1e6);
        assert!(worst_s < 1e-5, "{worst_s}");
        // In April TDB is ahead of TT by 1.6 ms.
        let apart = epoch_from_tdb("2018-04-04T00:00:00").unwrap()
            - epoch_from_ccsds("2018-04-04T00:00:00", TimeScale::Tt).unwrap();
        assert!((apart.to_seconds() + 0.001_65).abs() < 5e-5, "{apart}");
        assert!(epoch_from_tdb("yesterday").is_err());
    }

    #[test]
    fn what_is_written_is_read_back_to_the_nanosecond() {
        for ns in [0, 1, 120, 999_999_999, 37_500_000_000, 86_400_123_456_789] {
            // Through the leap second at the end of 2016.
            let epoch = utc("2016-12-31T23:59:00Z") + Duration::from_total_nanoseconds(ns);
            for scale in TimeScale::ALL {
                let text = ccsds_time(epoch, scale);
                assert_eq!(epoch_from_ccsds(&text, scale), Ok(epoch), "{text}");
            }
        }
        let leap = utc("2016-12-31T23:59:60.5Z");
        assert_eq!(ccsds_time(leap, TimeScale::Utc), "2016-12-31T23:59:60.500");
    }

    #[test]
    fn other_texts_are_rejected() {
        for text in [
            "",
            "T",
            "2018-01-15",
            "2018-01-15 12:00:00",
            "2018-01-15T12:00",
            "2018-366T12:00:00",
            "2018-000T12:00:00",
            "2018-+15T12:00:00",
            "2018-01-15T12:00:00+01:00",
            "2018-01-15T12:00:00ZZ",
            "18-01-15T12:00:00",
            "é018-15T12:00:00",
        ] {
            let error = epoch_from_ccsds(text, TimeScale::Utc).unwrap_err();
            assert!(
                matches!(error, TimeError::CcsdsForm { .. }),
                "{text}: {error}"
            );
        }
        for (text, scale) in [
            ("2018-13-15T12:00:00", TimeScale::Utc),
            ("2018-12-31T23:59:60", TimeScale::Utc),
            ("2016-12-31T23:59:60", TimeScale::Tai),
        ] {
            assert!(epoch_from_ccsds(text, scale).is_err(), "{text}");
        }
    }
}
