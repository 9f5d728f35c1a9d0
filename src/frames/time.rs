//! UTC instants as RFC 3339 text.

use super::Epoch;

/// Reads an RFC 3339 instant, for example `2018-01-15T12:00:00Z`.
pub fn utc_from_rfc3339(text: &str) -> Result<Epoch, String> {
    let bad = || format!("{text:?} is not a UTC date; write it like 2018-01-15T12:00:00Z");
    // The shape is checked first: hifitime also reads other things (Julian days, other scales), and
    // overflows on more than nine digits of a second.
    let shape: String = text
        .chars()
        .map(|c| if c.is_ascii_digit() { '0' } else { c })
        .collect();
    let rest = shape.strip_prefix("0000-00-00T00:00:00").ok_or_else(bad)?;
    let zone = match rest.strip_prefix('.') {
        Some(fraction) => {
            let zone = fraction.trim_start_matches('0');
            if !(1..=9).contains(&(fraction.len() - zone.len())) {
                return Err(bad());
            }
            zone
        }
        None => rest,
    };
    if !matches!(zone, "Z" | "+00:00" | "-00:00") {
        return Err(bad());
    }
    let epoch = Epoch::from_gregorian_str(text).map_err(|error| format!("{} ({error})", bad()))?;
    match epoch.to_gregorian_utc() {
        (1900..=2099, ..) => Ok(epoch),
        (year, ..) => Err(format!(
            "{text:?} is not a UTC date: year {year} is not from 1900 to 2099"
        )),
    }
}

/// The instant as RFC 3339 text in UTC, to the second where it is whole.
pub fn rfc3339(epoch: Epoch) -> String {
    let (year, month, day, hour, minute, second, nanos) = epoch.to_gregorian_utc();
    let fraction = match nanos {
        0 => String::new(),
        nanos => format!(".{nanos:09}").trim_end_matches('0').to_owned(),
    };
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}{fraction}Z")
}
