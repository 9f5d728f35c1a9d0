//! The four forms of text that orbit files come in, read into names and values with their places.

pub mod csv;
pub mod json;
pub mod kvn;
pub mod xml;

use super::record::Place;

/// Where the lines of a text begin, to find a byte's line.
pub struct Lines {
    begins: Vec<usize>,
}

impl Lines {
    pub fn of(text: &str) -> Self {
        let breaks = text.bytes().enumerate().filter(|&(_, b)| b == b'\n');
        Self {
            begins: std::iter::once(0)
                .chain(breaks.map(|(at, _)| at + 1))
                .collect(),
        }
    }

    /// The place of byte `at`.
    pub fn place(&self, at: usize) -> Place {
        let line = self.begins.partition_point(|&begin| begin <= at).max(1);
        let begin = self.begins.get(line - 1).copied().unwrap_or_default();
        Place {
            line,
            column: at - begin + 1,
        }
    }
}

/// Where `part`, a piece of `whole`, begins in it.
pub fn offset(whole: &str, part: &str) -> usize {
    (part.as_ptr() as usize).saturating_sub(whole.as_ptr() as usize)
}

/// The text without a byte order mark.
pub fn unmarked(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}
