//! Effective values of a scene's keys: recorded during reading, printed by the summary.

use super::error::printable;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Display;

/// The value of a key in scene syntax, or why it has none.
pub(super) type KeyText = Result<String, &'static str>;

/// Values recorded while a table is read.
#[derive(Debug, Default)]
pub(super) struct Notes(RefCell<BTreeMap<&'static str, KeyText>>);

impl Notes {
    /// Records the effective value of a key. The first record wins: a key without meaning in a scene may still be read
    /// for its default.
    pub(super) fn note(&self, key: &'static str, text: KeyText) {
        self.0.borrow_mut().entry(key).or_insert(text);
    }
}

/// Effective values of a table's keys, and their lines in the file.
#[derive(Clone, Debug, Default)]
pub(super) struct Record {
    lines: BTreeMap<&'static str, usize>,
    values: BTreeMap<&'static str, KeyText>,
}

impl Record {
    /// The record of a table after reading. `lines` are the lines, from 1, of the keys in the file.
    pub(super) fn new(lines: BTreeMap<&'static str, usize>, notes: Notes) -> Self {
        Self {
            lines,
            values: notes.0.into_inner(),
        }
    }

    /// The line, from 1, of a key in the file; `None` if the file does not give it.
    pub(super) fn line(&self, key: &str) -> Option<usize> {
        self.lines.get(key).copied()
    }

    /// The first line with a key of the table.
    pub(super) fn first_line(&self) -> Option<usize> {
        self.lines.values().min().copied()
    }

    /// The effective value of a key, if it was read.
    pub(super) fn value(&self, key: &str) -> Option<&KeyText> {
        self.values.get(key)
    }

    /// Replaces the effective value of a key.
    pub(super) fn set(&mut self, key: &'static str, text: KeyText) {
        self.values.insert(key, text);
    }

    /// Marks all keys as not given in the file.
    pub(super) fn forget_lines(&mut self) {
        self.lines.clear();
    }
}

/// A number in scene syntax.
pub(super) fn number_text(number: f64) -> String {
    match number != 0.0 && number.abs() < 1e-5 {
        true => format!("{number:e}"),
        false => number.to_string(),
    }
}

/// A text in scene syntax.
pub(super) fn quoted(text: &str) -> KeyText {
    Ok(format!("\"{}\"", printable(text)))
}

/// Texts in scene syntax.
pub(super) fn list_text(texts: impl Iterator<Item = impl Display>) -> String {
    let texts = texts.map(|text| format!("\"{}\"", printable(&text.to_string())));
    format!("[{}]", texts.collect::<Vec<_>>().join(", "))
}
