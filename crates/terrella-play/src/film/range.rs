//! Which frames of a film are wanted.

use super::error::FilmError;
use std::fmt::{self, Display};
use std::ops::Range;
use std::str::FromStr;

/// Frames of a film by their numbers, from 0. As text `240..480`, without the last; either number may be left out, and `..=` takes
/// the last as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameRange {
    first: u64,
    /// The first that is not wanted any more; `None` is the film's end.
    end: Option<u64>,
}

impl FrameRange {
    /// The numbers of these frames in a film of so many.
    ///
    /// # Errors
    /// Frames that the film does not have.
    pub fn of(self, frame_count: u64) -> Result<Range<u64>, FilmError> {
        let end = self.end.unwrap_or(frame_count);
        if self.first < end && end <= frame_count {
            return Ok(self.first..end);
        }
        Err(FilmError::NoSuchFrames {
            wanted: self.to_string(),
            frame_count,
        })
    }

    /// Whether all frames are meant.
    pub fn is_all(self) -> bool {
        self == Self::default()
    }
}

impl Display for FrameRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.end {
            Some(end) => write!(f, "{}..{end}", self.first),
            None => write!(f, "{}..", self.first),
        }
    }
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const FORM: &str = "write it as FIRST..END, for example 240..480 for the frames 240 to 479; 240.. goes to the end, 240..=480 takes frame 480 as well";
        let number = |text: &str| match text.trim() {
            "" => Ok(None),
            digits => digits.parse::<u64>().map(Some).map_err(|_| FORM.to_owned()),
        };
        let (first, end) = text.split_once("..").ok_or(FORM)?;
        let first = number(first)?.unwrap_or(0);
        let end = match end.strip_prefix('=') {
            None => number(end)?,
            Some(last) => Some(number(last)?.ok_or(FORM)?.saturating_add(1)),
        };
        if end.is_some_and(|end| end <= first) {
            return Err(format!("there are no frames in it; {FORM}"));
        }
        Ok(Self { first, end })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read_as_they_are_written() {
        let of = |text: &str, count| text.parse::<FrameRange>().expect(text).of(count).ok();
        assert_eq!(of("240..480", 480), Some(240..480));
        assert_eq!(of("240..=479", 480), Some(240..480));
        assert_eq!(of("240..", 480), Some(240..480));
        assert_eq!(of("..3", 480), Some(0..3));
        assert_eq!(of("..", 7), Some(0..7));
        assert_eq!(of("240..481", 480), None);
        assert_eq!(of("480..", 480), None);
        assert_eq!(FrameRange::default().of(4).ok(), Some(0..4));
        for bad in [
            "", "5", "a..b", "-1..4", "4..4", "5..4", "..0", "1...3", "..=", "1.5..2", "0..=-1",
        ] {
            bad.parse::<FrameRange>().expect_err(bad);
        }
        let rejected = "9..12".parse::<FrameRange>().expect("good").of(4);
        let words = rejected.expect_err("beyond the end").to_string();
        assert!(
            words.contains("9..12") && words.contains("are 0 to 3"),
            "{words}"
        );
    }
}
