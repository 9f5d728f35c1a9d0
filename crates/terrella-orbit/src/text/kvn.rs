//! Keyword = value notation (CCSDS 502.0, section 7): one entry a line, units in brackets.

use super::super::entry::{Entry, TextPosition, number};
use super::{offset, unmarked};
use std::borrow::Cow;

/// A line of a message.
pub enum KvnLine<'t> {
    /// `KEY = value [unit]`.
    Entry(Entry<'t>),
    /// Anything else: `META_START`, a row of numbers.
    Other {
        /// Without blanks at either end, never empty.
        text: &'t str,
        /// Position of the line in the file.
        place: TextPosition,
    },
}

/// The lines of a text with content: no empty lines, no comments.
pub fn lines(text: &str) -> impl Iterator<Item = KvnLine<'_>> {
    let said = unmarked(text).lines().enumerate();
    said.filter_map(|(index, whole)| {
        let line = whole.trim();
        if line.is_empty() || is_comment(line) {
            return None;
        }
        let place = |part: &str| TextPosition {
            line: index + 1,
            column: offset(whole, part) + 1,
        };
        let Some((key, rest)) = line.split_once('=') else {
            return Some(KvnLine::Other {
                text: line,
                place: place(line),
            });
        };
        let rest = rest.trim();
        let with_unit = rest
            .strip_suffix(']')
            .and_then(|rest| rest.rsplit_once('['))
            // A name may contain brackets.
            .filter(|(value, _)| number(value).is_some());
        let (value, unit) = match with_unit {
            Some((value, unit)) => (value.trim_end(), Some(unit.trim())),
            None => (rest, None),
        };
        Some(KvnLine::Entry(Entry {
            key: Cow::Borrowed(key.trim()),
            value: Cow::Borrowed(value),
            unit: unit.map(Cow::Borrowed),
            place: place(match value.is_empty() {
                true => line,
                false => value,
            }),
        }))
    })
}

/// `COMMENT`, followed by a blank or the end of the line.
fn is_comment(line: &str) -> bool {
    let rest = line.strip_prefix("COMMENT");
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(char::is_whitespace))
}
