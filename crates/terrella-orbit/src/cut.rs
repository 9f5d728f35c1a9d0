//! Detection of truncated files: an interrupted transfer or a full disk.
//!
//! A text file that ends without a line feed may have lost digits of its last number, and the rest is still a valid number. Many programs also omit
//! the line feed from complete files. The last line is therefore used if it has the precision of the lines before it, and otherwise left out. In
//! either case the user is notified.

/// Signs that a file is truncated, or may be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CutOff {
    /// Its last line is not whole, or cannot be shown to be.
    #[error(
        "the file is truncated in this line, which is skipped: it has no line feed; fetch or write the file again, or end the line with a line feed if it is complete"
    )]
    Line,
    /// Its last line seems to be whole.
    #[error(
        "the file may be truncated here: its last line has no line feed, but is used because it is as precise as the others; end it with a line feed if it is complete"
    )]
    LineFeed,
    /// Its last line may have lost digits, and nothing shows whether it has.
    #[error(
        "the file may be truncated here: its last line has no line feed, but is used; compare it with its source, and end it with a line feed if it is complete"
    )]
    Unended,
    /// States are missing at the end.
    #[error(
        "the file is truncated or states are missing: the last state is at {last}, before {key} = {stop}; fetch or write the file again"
    )]
    Stop {
        /// Instant of the last state, UTC.
        last: String,
        /// The key with the end of the states.
        key: &'static str,
        /// Its value, UTC.
        stop: String,
    },
    /// Something has begun and does not end.
    #[error("the file is truncated: {what} is not closed; fetch or write it again")]
    Unclosed {
        /// The record that has begun.
        what: String,
    },
}

impl CutOff {
    /// Whether some of the file's content is therefore not used.
    pub fn leaves_out(&self) -> bool {
        matches!(self, Self::Line | Self::Unclosed { .. })
    }
}

/// Watches the rows of a text for the one without a line feed behind it.
pub(super) struct LastLine {
    open_line: Option<usize>,
    width: usize,
    fineness: Fineness,
}

impl LastLine {
    /// For the rows of a text.
    pub fn of(text: &str) -> Self {
        Self {
            open_line: open_line(text),
            width: 0,
            fineness: Fineness::default(),
        }
    }

    /// How the text was cut off at a row of so many fields of which the last is `number`: `None` in all rows but one without
    /// a line feed behind it.
    pub fn cut(&mut self, line: usize, width: usize, number: &str) -> Option<CutOff> {
        if self.open_line == Some(line) {
            let is_whole = width == self.width && self.fineness.is_met_by(number);
            return Some(if is_whole {
                CutOff::LineFeed
            } else {
                CutOff::Line
            });
        }
        self.width = width;
        self.fineness.add(number);
        None
    }
}

/// The number, from 1, of the last line if it does not end with a line feed.
pub(super) fn open_line(text: &str) -> Option<usize> {
    let last = text
        .lines()
        .next_back()
        .filter(|line| !line.trim().is_empty());
    let is_open = last.is_some() && !text.ends_with(['\n', '\r']);
    is_open.then(|| text.lines().count())
}

/// How finely the last numbers of lines are written.
#[derive(Clone, Debug, Default)]
pub(super) struct Fineness {
    /// Fewest digits behind the point, fewest and most characters behind the `e` of an exponent.
    bounds: Option<(usize, usize, usize)>,
    last: String,
}

impl Fineness {
    /// With so many digits behind the point of kilometres, or of kilometres a second, what has been lost is no matter.
    const FINE_DIGITS: usize = 9;

    /// Takes note of a number of a whole line.
    pub fn add(&mut self, number: &str) {
        let (digits, exponent) = written(number);
        self.bounds = Some(match self.bounds {
            Some((fewest, short, long)) => {
                (fewest.min(digits), short.min(exponent), long.max(exponent))
            }
            None => (digits, exponent, exponent),
        });
        self.last.clear();
        self.last.push_str(number);
    }

    /// Whether a number has at least the precision of the numbers before it.
    pub fn is_met_by(&self, number: &str) -> bool {
        let Some((fewest, short, long)) = self.bounds else {
            return false;
        };
        let (digits, exponent) = written(number);
        // In a mix of numbers with and without exponents, a lost exponent cannot be detected.
        let has_exponent = exponent >= short && (long == 0 || short > 0);
        let is_fine = digits >= Self::FINE_DIGITS || (fewest > 0 && digits >= fewest);
        number == self.last || (has_exponent && is_fine)
    }
}

/// Digits behind the point, and characters behind the `e` of an exponent.
fn written(number: &str) -> (usize, usize) {
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, ""));
    let digits = mantissa
        .split_once('.')
        .map_or(0, |(_, digits)| digits.len());
    (digits, exponent.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_met(column: &[&str], last: &str) -> bool {
        let mut fineness = Fineness::default();
        column.iter().for_each(|number| fineness.add(number));
        fineness.is_met_by(last)
    }

    #[test]
    fn lost_digits_are_seen() {
        for (column, whole, cut) in [
            // So many digits always.
            (&["6.100", "-5.250"][..], "4.619", "4.61"),
            (&["6.100", "-5.250"], "4.619", "4."),
            (&["6.100", "-5.250"], "4.619", "4"),
            // As many as it takes.
            (&["6.1192", "4.6073213286"], "4.3711", "4.37"),
            (
                &["6.11917185863", "4.607321328555045"],
                "4.3711223341",
                "4.37112",
            ),
            // Whole numbers among them.
            (&["0", "4.607321328555045"], "4.371122334412", "4"),
            (&["7001", "-6999"], "-6999", "-69"),
            // Exponents.
            (&["6.119E+00", "-4.607E-01"], "4.371E-02", "4.371E-0"),
            (&["6.119E+00", "-4.607E-01"], "4.371E-02", "4.371"),
            (
                &["6.1191718586e-5", "0.46073213285"],
                "0.46073213285",
                "4.3711223341",
            ),
        ] {
            assert!(is_met(column, whole), "{column:?} {whole}");
            assert!(!is_met(column, cut), "{column:?} {cut}");
        }
        assert!(!is_met(&[], "6.119"));
        assert!(is_met(&["0", "0"], "0"));
    }

    #[test]
    fn a_line_without_a_line_feed_is_found() {
        for (text, line) in [
            ("", None),
            ("a\n", None),
            ("a\r\n", None),
            ("a\nb", Some(2)),
            ("a\n\n  ", None),
            ("a\n\nb ", Some(3)),
        ] {
            assert_eq!(open_line(text), line, "{text:?}");
        }
    }
}
