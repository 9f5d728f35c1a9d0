//! What the keys of a scene come to: noted while they are read, printed by the summary.

use super::error::printable;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Display;

/// The value of a key as a scene would write it, or why it has none.
pub(super) type KeyText = Result<String, &'static str>;

/// What is noted of the keys of a table while it is read.
#[derive(Debug, Default)]
pub(super) struct Notes(RefCell<BTreeMap<&'static str, KeyText>>);

impl Notes {
    /// Notes what a key comes to. The first note stands: a key that has no meaning in a scene may still be read, for its
    /// default.
    pub(super) fn note(&self, key: &'static str, text: KeyText) {
        self.0.borrow_mut().entry(key).or_insert(text);
    }
}

/// What the keys of a table came to, and where the file gives them.
#[derive(Clone, Debug, Default)]
pub(super) struct Record {
    lines: BTreeMap<&'static str, usize>,
    values: BTreeMap<&'static str, KeyText>,
}

impl Record {
    /// The record of a table that was read. `lines` are those of the keys that the file gives, from 1.
    pub(super) fn new(lines: BTreeMap<&'static str, usize>, notes: Notes) -> Self {
        Self {
            lines,
            values: notes.0.into_inner(),
        }
    }

    /// The line, from 1, on which the file gives a key; `None` where it does not.
    pub(super) fn line(&self, key: &str) -> Option<usize> {
        self.lines.get(key).copied()
    }

    /// The first line with a key of the table.
    pub(super) fn first_line(&self) -> Option<usize> {
        self.lines.values().min().copied()
    }

    /// What a key came to, if it was read.
    pub(super) fn value(&self, key: &str) -> Option<&KeyText> {
        self.values.get(key)
    }

    /// Changes what a key came to.
    pub(super) fn set(&mut self, key: &'static str, text: KeyText) {
        self.values.insert(key, text);
    }

    /// Takes no key for one that the file gives.
    pub(super) fn forget_lines(&mut self) {
        self.lines.clear();
    }
}

/// A number as a scene would write it.
pub(super) fn number_text(number: f64) -> String {
    match number != 0.0 && number.abs() < 1e-5 {
        true => format!("{number:e}"),
        false => number.to_string(),
    }
}

/// A text as a scene would write it.
pub(super) fn quoted(text: &str) -> KeyText {
    Ok(format!("\"{}\"", printable(text)))
}

/// Texts as a scene would write them.
pub(super) fn list_text(texts: impl Iterator<Item = impl Display>) -> String {
    let texts = texts.map(|text| format!("\"{}\"", printable(&text.to_string())));
    format!("[{}]", texts.collect::<Vec<_>>().join(", "))
}
