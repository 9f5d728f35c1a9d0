//! The fields of an element set by their columns, as strict as the format: no field may be "nan", "1e5" or half blank.
//!
//! Columns after Hoots & Roehrich, Spacetrack Report No. 3 (1980), and Vallado et al., AIAA 2006-6753.

use super::tle_text::{ElementSet, columns};
use super::{LineFault, MeanElements, OrbitError};
use std::path::Path;
use terrella_frames::{Calendar, Epoch, tai_from_utc_day};

const NS_PER_DAY: i64 = 86_400_000_000_000;
/// Days of the last digit of an epoch, 1e-8 d = 864 µs: exact in nanoseconds.
const NS_PER_EPOCH_DIGIT: i64 = NS_PER_DAY / 100_000_000;

pub(super) fn elements(set: &ElementSet<'_>, origin: &Path) -> Result<MeanElements, OrbitError> {
    let one = ElementLine {
        text: set.line1,
        at: set.at1,
        origin,
    };
    let two = ElementLine {
        text: set.line2,
        at: set.at2,
        origin,
    };
    one.blank(&[2, 9, 18, 33, 44, 53, 62, 64])?;
    two.blank(&[2, 8, 17, 26, 34, 43, 52])?;

    // Checked in the order of their columns, so that the first fault is the one that is named.
    let epoch = one.epoch()?;
    let elements = MeanElements {
        name: set.label().to_owned(),
        object_id: object_id(columns(one.text, 10, 17)),
        epoch,
        catalogue_number: one.catalogue()?,
        mean_motion_dot: one.decimal("mean motion's first derivative", 34, 43)?,
        mean_motion_ddot: one.power("mean motion's second derivative", 45, 52)?,
        drag_term_per_er: one.power("drag term B*", 54, 61)?,
        element_set_number: one.integer_or_blank("element set number", 65, 68)?,
        inclination_deg: two.degrees("inclination", 9, 16, 180.0, "degrees from 0 to 180")?,
        raan_deg: two.degrees(
            "right ascension of the ascending node",
            18,
            25,
            360.0,
            "degrees from 0 to 360",
        )?,
        eccentricity: two.eccentricity()?,
        arg_perigee_deg: two.degrees(
            "argument of perigee",
            35,
            42,
            360.0,
            "degrees from 0 to 360",
        )?,
        mean_anomaly_deg: two.degrees("mean anomaly", 44, 51, 360.0, "degrees from 0 to 360")?,
        mean_motion_rev_day: two.decimal("mean motion", 53, 63)?,
        revolution_number: two.integer_or_blank("revolution number", 64, 68)?,
    };
    // Distributed sets hold 0 here, old ones 2 or 3 (SGP4, SDP4); 4 is SGP4-XP, which this theory would fly wrongly.
    let ephemeris_type = columns(one.text, 63, 63);
    if !matches!(ephemeris_type, " " | "0" | "2" | "3") {
        return Err(one.fault(
            "ephemeris type",
            63,
            63,
            "0: only sets made for SGP4 can be flown with it",
        ));
    }
    if elements.mean_motion_rev_day <= 0.0 {
        return Err(two.fault("mean motion", 53, 63, "revolutions per day above 0"));
    }
    Ok(elements)
}

/// The catalogue number in plain or Alpha-5 form: A0000 is 100 000, Z9999 is 339 999; I and O are not used.
pub(super) fn catalogue_number(text: &str) -> Option<u64> {
    let first = text.chars().next()?;
    let tens_of_thousands = match first {
        '0'..='9' => return digits(text),
        'A'..='H' => first as u64 - 'A' as u64 + 10,
        'J'..='N' => first as u64 - 'J' as u64 + 18,
        'P'..='Z' => first as u64 - 'P' as u64 + 23,
        _ => return None,
    };
    let rest = text.get(1..).filter(|rest| rest.len() == 4)?;
    Some(tens_of_thousands * 10_000 + digits(rest)?)
}

/// `98067A` as `1998-067A`; blank or anything else as nothing, for not all lists keep to the form.
fn object_id(text: &str) -> Option<String> {
    let text = text.trim();
    let (year, rest) = text.split_at_checked(2)?;
    let year = match digits(year)? {
        year @ 0..57 => year + 2000,
        year => year + 1900,
    };
    let (launch, piece) = rest.split_at_checked(3)?;
    let is_piece = (1..=3).contains(&piece.len()) && piece.bytes().all(|c| c.is_ascii_uppercase());
    is_piece.then_some(())?;
    Some(format!("{year}-{:03}{piece}", digits(launch)?))
}

struct ElementLine<'l> {
    text: &'l str,
    at: usize,
    origin: &'l Path,
}

impl ElementLine<'_> {
    fn fault(
        &self,
        field: &'static str,
        first: usize,
        last: usize,
        expected: &'static str,
    ) -> OrbitError {
        let fault = LineFault::Field {
            field,
            text: columns(self.text, first, last).to_owned(),
            expected,
        };
        OrbitError::line(self.origin, self.at, Some(first), fault)
    }

    /// The columns between fields, which a shifted line fills.
    fn blank(&self, at: &[usize]) -> Result<(), OrbitError> {
        match at.iter().find(|&&c| columns(self.text, c, c) != " ") {
            Some(&c) => Err(self.fault("the column between two fields", c, c, "a blank")),
            None => Ok(()),
        }
    }

    fn catalogue(&self) -> Result<u64, OrbitError> {
        catalogue_number(columns(self.text, 3, 7).trim()).ok_or_else(|| {
            self.fault(
                "catalogue number",
                3,
                7,
                "five digits, or a letter and four",
            )
        })
    }

    /// A plain decimal number, no exponent.
    fn decimal(&self, field: &'static str, first: usize, last: usize) -> Result<f64, OrbitError> {
        decimal(columns(self.text, first, last).trim())
            .ok_or_else(|| self.fault(field, first, last, "a decimal number"))
    }

    fn degrees(
        &self,
        field: &'static str,
        first: usize,
        last: usize,
        most: f64,
        expected: &'static str,
    ) -> Result<f64, OrbitError> {
        self.decimal(field, first, last)
            .ok()
            .filter(|value| (0.0..=most).contains(value))
            .ok_or_else(|| self.fault(field, first, last, expected))
    }

    /// Sign, five digits after an assumed point, sign and digit of a power of ten: ` 38550-4` is 0.38550e-4.
    fn power(&self, field: &'static str, first: usize, last: usize) -> Result<f64, OrbitError> {
        let read = || {
            let text = columns(self.text, first, last);
            let (mantissa, power) = text.split_at_checked(6)?;
            let (sign, mantissa) = mantissa.split_at_checked(1)?;
            let exponent = match power.split_at_checked(1)? {
                ("-", digit) => -(digits(digit)? as i32),
                ("+" | " ", digit) => digits(digit)? as i32,
                _ => return None,
            };
            let value = digits(mantissa)? as f64 * 10f64.powi(exponent - 5);
            match sign {
                " " | "+" => Some(value),
                "-" => Some(-value),
                _ => None,
            }
        };
        read().ok_or_else(|| {
            self.fault(
                field,
                first,
                last,
                "a sign or blank, five digits, a sign and a digit, like \" 38550-4\"",
            )
        })
    }

    /// Seven digits after an assumed point.
    fn eccentricity(&self) -> Result<f64, OrbitError> {
        digits(columns(self.text, 27, 33))
            .map(|n| n as f64 / 1e7)
            .ok_or_else(|| self.fault("eccentricity", 27, 33, "seven digits, the point left out"))
    }

    fn integer_or_blank(
        &self,
        field: &'static str,
        first: usize,
        last: usize,
    ) -> Result<u64, OrbitError> {
        match columns(self.text, first, last).trim() {
            "" => Ok(0),
            text => digits(text)
                .ok_or_else(|| self.fault(field, first, last, "a whole number or blanks")),
        }
    }

    /// Two digits of the year (57…99 are of the 20th century), day of the year and its fraction to 1e-8, UTC.
    fn epoch(&self) -> Result<Epoch, OrbitError> {
        let year_fault = || self.fault("epoch year", 19, 20, "two digits");
        let day_fault = || {
            self.fault(
                "epoch day",
                21,
                32,
                "day of the year from 1 to 365 (366 in a leap year) and its fraction, like 020.89808844",
            )
        };
        let year = match digits(columns(self.text, 19, 20)).ok_or_else(year_fault)? {
            year @ 0..57 => year + 2000,
            year => year + 1900,
        };
        let read = || {
            let (day, fraction) = columns(self.text, 21, 32).split_once('.')?;
            let day = i64::try_from(digits(day.trim_start())?).ok()?;
            let fraction = fraction.trim_end();
            let ones = 10_i64.checked_pow(8_u32.checked_sub(fraction.len() as u32)?)?;
            let ns_of_day = digits(fraction)? as i64 * ones * NS_PER_EPOCH_DIGIT;
            let january = |year| Calendar {
                year: year as i64,
                month: 1,
                day: 1,
            };
            let mjd = january(year).mjd() + day.checked_sub(1)?;
            let is_of_year = day > 0 && mjd < january(year + 1).mjd();
            is_of_year.then(|| tai_from_utc_day(mjd, ns_of_day))
        };
        read().ok_or_else(day_fault)
    }
}

/// Digits only, at least one, at most 18.
fn digits(text: &str) -> Option<u64> {
    let all = !text.is_empty() && text.len() <= 18 && text.bytes().all(|c| c.is_ascii_digit());
    all.then(|| text.parse().ok()).flatten()
}

/// `[+-]digits.digits` with either side of the point optional but one.
fn decimal(text: &str) -> Option<f64> {
    let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
    let plain = unsigned.bytes().all(|c| c.is_ascii_digit() || c == b'.')
        && unsigned.bytes().any(|c| c.is_ascii_digit());
    plain.then(|| text.parse().ok()).flatten()
}
