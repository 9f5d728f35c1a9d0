//! The Earth's orientation by date, from the table that the IERS publishes.

use super::calendar::Calendar;
use super::time::{tai_from_utc_day, tai_minus_utc_s, utc_day_from_tai_ns};
use super::{Epoch, Orientation};
use std::path::{Path, PathBuf};
use terrella_files as files;

/// UT1 − UTC and polar motion by date: `finals2000A.all` or `finals2000A.daily` of the IERS (Bulletin A), one row a day at
/// 0 h UTC, from 1973 to a year ahead.
///
/// Between rows all three are interpolated linearly; for UT1 it is UT1 − TAI, which has no steps at leap seconds. Neglected effects, as shifts on
/// the ground at the equator: the curvature from day to day, at most 0.06 ms of UT1 (3 cm) and 0.2 mas of the pole (6 mm) since 1990; ocean tides
/// within a day, 0.07 ms (3 cm) and 0.5 mas (1.5 cm). Predicted rows have larger errors, by Bulletin A's own rule 0.25 ms·d^0.75 and 0.68 mas·d^0.8
/// after d days: 1.4 ms (65 cm) and 4 mas (13 cm) after ten days, 21 ms (10 m) and 76 mas (2.4 m) after a year. Without a table: 420 m and 20 m
/// ([`Orientation`]).
#[derive(Clone, Debug)]
pub struct EarthOrientation {
    /// One a day, no day left out.
    rows: Vec<Row>,
}

#[derive(Clone, Copy, Debug)]
struct Row {
    /// 0 h UTC.
    epoch: Epoch,
    ut1_minus_tai_s: f64,
    x_pole_arcsec: f64,
    y_pole_arcsec: f64,
    is_predicted: bool,
}

/// Why a table of the Earth's orientation is rejected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum EarthOrientationError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is too large.
    #[error("{}: larger than {limit_mib} MiB, which no table of the Earth's orientation is; take finals2000A.all of the IERS", path.display())]
    TooLarge { path: PathBuf, limit_mib: u64 },
    /// The file is not text.
    #[error("{}: not plain text; take finals2000A.all of the IERS", path.display())]
    NotText { path: PathBuf },
    /// A field is not what it should be.
    #[error("{}:{line}:{column}: {field} is {text:?}; expected {expected}, as finals2000A has it", path.display())]
    Field {
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// Name of the field.
        field: &'static str,
        text: String,
        /// The expected value.
        expected: &'static str,
    },
    /// A day is missing or comes twice.
    #[error("{}:{line}: MJD {found} follows MJD {before}; rows go from day to day, so mend or download the table again", path.display())]
    Order {
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Modified Julian date of the row before.
        before: i64,
        /// Day of this row.
        found: i64,
    },
    /// No row with values.
    #[error("{}: no row with values in it; take finals2000A.all of the IERS", path.display())]
    Empty { path: PathBuf },
}

impl EarthOrientation {
    /// Largest file read, bytes: four centuries of rows.
    pub const LARGEST_FILE: u64 = 32 << 20;

    /// Reads a file in the format finals2000A.
    ///
    /// # Errors
    /// Says which line and column is wrong and how.
    pub fn from_file(path: &Path) -> Result<Self, EarthOrientationError> {
        let read_error = |source| EarthOrientationError::Read {
            path: path.to_owned(),
            source,
        };
        let bytes = files::read(path, Self::LARGEST_FILE).map_err(read_error)?;
        let bytes = bytes.ok_or_else(|| EarthOrientationError::TooLarge {
            path: path.to_owned(),
            limit_mib: Self::LARGEST_FILE >> 20,
        })?;
        let text = std::str::from_utf8(&bytes).map_err(|_| EarthOrientationError::NotText {
            path: path.to_owned(),
        })?;
        Self::from_finals2000a(text, path)
    }

    /// As [`Self::from_file`], from text that is already in memory; `origin` is named in errors.
    ///
    /// Rows at the end that have a date and no values yet are skipped.
    ///
    /// # Errors
    /// Says which line and column is wrong and how.
    pub fn from_finals2000a(text: &str, origin: &Path) -> Result<Self, EarthOrientationError> {
        let mut rows = Vec::new();
        let mut before: Option<i64> = None;
        let mut ended = false;
        for (index, text) in text.lines().enumerate() {
            let line = Line {
                text,
                at: index + 1,
                origin,
            };
            if text.trim().is_empty() {
                continue;
            }
            let mjd = line.day()?;
            if let Some(before) = before.filter(|before| before + 1 != mjd) {
                return Err(EarthOrientationError::Order {
                    path: origin.to_owned(),
                    line: line.at,
                    before,
                    found: mjd,
                });
            }
            before = Some(mjd);
            if line.columns(17, 68).trim().is_empty() {
                ended = true;
                continue;
            }
            if ended {
                return Err(line.fault(
                    "the row",
                    17,
                    17,
                    "no values, for the row before has none",
                ));
            }
            rows.push(line.row(mjd)?);
        }
        if rows.is_empty() {
            return Err(EarthOrientationError::Empty {
                path: origin.to_owned(),
            });
        }
        Ok(Self { rows })
    }

    /// First and last instant of the table.
    pub fn span(&self) -> (Epoch, Epoch) {
        let epoch = |row: Option<&Row>| row.map(|row| row.epoch).unwrap_or_default();
        (epoch(self.rows.first()), epoch(self.rows.last()))
    }

    /// The last instant that was measured; behind it the table predicts. `None` if all of it is predicted.
    pub fn measured_until(&self) -> Option<Epoch> {
        let measured = self.rows.iter().rev().find(|row| !row.is_predicted);
        measured.map(|row| row.epoch)
    }

    /// The orientation at `epoch`; `None` outside the table, for which nothing is guessed.
    pub fn at(&self, epoch: Epoch) -> Option<Orientation> {
        let behind = self.rows.partition_point(|row| row.epoch <= epoch);
        let a = self.rows.get(behind.checked_sub(1)?)?;
        let b = match self.rows.get(behind) {
            Some(b) => b,
            None if a.epoch == epoch => a,
            None => return None,
        };
        // A day of 86 401 s where a leap second ends it.
        let length_s = (b.epoch - a.epoch).to_seconds();
        let share = match length_s > 0.0 {
            true => (epoch - a.epoch).to_seconds() / length_s,
            false => 0.0,
        };
        let between = |of: fn(&Row) -> f64| of(a) + share * (of(b) - of(a));
        let (mjd, _) = utc_day_from_tai_ns(epoch.to_tai_duration().total_nanoseconds());
        Some(Orientation {
            ut1_minus_utc_s: between(|row| row.ut1_minus_tai_s) + tai_minus_utc_s(mjd) as f64,
            x_pole_rad: (between(|row| row.x_pole_arcsec) / 3600.0).to_radians(),
            y_pole_rad: (between(|row| row.y_pole_arcsec) / 3600.0).to_radians(),
        })
    }
}

struct Line<'l> {
    text: &'l str,
    at: usize,
    origin: &'l Path,
}

impl Line<'_> {
    /// Columns `first` to `last`, counted from 1; what there is of them.
    fn columns(&self, first: usize, last: usize) -> &str {
        let last = last.min(self.text.len());
        self.text.get(first - 1..last).unwrap_or("")
    }

    fn fault(
        &self,
        field: &'static str,
        first: usize,
        last: usize,
        expected: &'static str,
    ) -> EarthOrientationError {
        EarthOrientationError::Field {
            path: self.origin.to_owned(),
            line: self.at,
            column: first,
            field,
            text: self.columns(first, last).to_owned(),
            expected,
        }
    }

    /// The modified Julian date, which must agree with the calendar date beside it: this detects shifted columns.
    fn day(&self) -> Result<i64, EarthOrientationError> {
        let fault = || {
            self.fault(
                "the date",
                1,
                15,
                "two digits each of year, month and day, and the modified Julian date in columns 8 to 15",
            )
        };
        let whole = |first, last| self.columns(first, last).trim().parse::<i64>().ok();
        let day_text = self.columns(8, 15).trim();
        let mjd = day_text
            .split_once('.')
            .filter(|(_, decimals)| decimals.bytes().all(|c| c == b'0'))
            .and_then(|(mjd, _)| mjd.parse::<i64>().ok())
            .ok_or_else(fault)?;
        let date = Calendar::from_mjd(mjd);
        let written = (whole(1, 2), whole(3, 4), whole(5, 6));
        match written
            == (
                Some(date.year.rem_euclid(100)),
                Some(date.month),
                Some(date.day),
            ) {
            true => Ok(mjd),
            false => Err(fault()),
        }
    }

    fn row(&self, mjd: i64) -> Result<Row, EarthOrientationError> {
        let flag = |column| match self.columns(column, column) {
            "I" => Ok(false),
            "P" => Ok(true),
            _ => Err(self.fault("the flag", column, column, "I (measured) or P (predicted)")),
        };
        let pole = "arc seconds, at most 2";
        let is_predicted = flag(17)? | flag(58)?;
        let x_pole_arcsec = self.number("the pole's x", 19, 27, 2.0, pole)?;
        let y_pole_arcsec = self.number("the pole's y", 38, 46, 2.0, pole)?;
        let ut1 = self.number("UT1 − UTC", 59, 68, 1.0, "seconds, at most 1")?;
        Ok(Row {
            epoch: tai_from_utc_day(mjd, 0),
            ut1_minus_tai_s: ut1 - tai_minus_utc_s(mjd) as f64,
            x_pole_arcsec,
            y_pole_arcsec,
            is_predicted,
        })
    }

    fn number(
        &self,
        field: &'static str,
        first: usize,
        last: usize,
        most: f64,
        expected: &'static str,
    ) -> Result<f64, EarthOrientationError> {
        let text = self.columns(first, last).trim();
        let value = text.parse::<f64>().ok();
        value
            .filter(|value| value.abs() <= most)
            .ok_or_else(|| self.fault(field, first, last, expected))
    }
}
