//! The Gregorian calendar and the day count.

/// A date of the Gregorian calendar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Calendar {
    /// Year, astronomical (0 is 1 BC).
    pub year: i64,
    /// Month, 1…12.
    pub month: i64,
    /// Day of the month, from 1.
    pub day: i64,
}

impl Calendar {
    /// Whether 29 February exists.
    fn is_leap_year(year: i64) -> bool {
        year % 4 == 0 && (year % 100 != 0 || year % 400 == 0)
    }

    /// Days of its month, 28…31.
    pub fn days_in_month(self) -> i64 {
        match self.month {
            2 if Self::is_leap_year(self.year) => 29,
            2 => 28,
            4 | 6 | 9 | 11 => 30,
            _ => 31,
        }
    }

    /// Modified Julian date of its midnight. Counted in years that begin in March, so that the leap day comes last.
    pub fn mjd(self) -> i64 {
        let year = self.year - i64::from(self.month <= 2);
        let month = (self.month + 9) % 12;
        let day_of_year = (153 * month + 2) / 5 + self.day - 1;
        // 0000-03-01 is MJD −678 881.
        365 * year + year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400) + day_of_year
            - 678_881
    }

    /// The date of a modified Julian date; the inverse of [`Self::mjd`].
    pub fn from_mjd(mjd: i64) -> Self {
        let days = mjd + 678_881;
        let era = days.div_euclid(146_097);
        let day_of_era = days.rem_euclid(146_097);
        let year_of_era =
            (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
        let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
        let month = (5 * day_of_year + 2) / 153;
        Self {
            year: era * 400 + year_of_era + i64::from(month >= 10),
            month: (month + 2) % 12 + 1,
            day: day_of_year - (153 * month + 2) / 5 + 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calendar_and_day_number_agree_over_four_thousand_years() {
        let (mut date, mut mjd) = (
            Calendar {
                year: -400,
                month: 3,
                day: 1,
            },
            -678_881 - 146_097,
        );
        while date.year < 3600 {
            assert_eq!((date.mjd(), Calendar::from_mjd(mjd)), (mjd, date));
            mjd += 1;
            date.day += 1;
            if date.day > date.days_in_month() {
                (date.day, date.month) = (1, date.month + 1);
            }
            if date.month > 12 {
                (date.month, date.year) = (1, date.year + 1);
            }
        }
    }
}
