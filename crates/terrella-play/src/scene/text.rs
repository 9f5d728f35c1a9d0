//! The text of a scene with its file name: positions, excerpts, and the most similar known word.

use super::error::printable;
use std::ops::Range;
use std::path::Path;

/// A scene's text and its file name.
#[derive(Clone, Copy)]
pub(super) struct SceneText<'a> {
    pub(super) path: &'a Path,
    pub(super) text: &'a str,
    /// Result of [`line_starts`].
    pub(super) line_starts: &'a [usize],
}

/// Byte offsets of line starts. A scene looks up the line of each of its keys, up to some ten thousand.
pub(super) fn line_starts(text: &str) -> Vec<usize> {
    let after = text.match_indices('\n').map(|(at, _)| at + 1);
    std::iter::once(0).chain(after).collect()
}

impl SceneText<'_> {
    /// Line of a byte offset, from 1.
    pub(super) fn line(&self, offset: usize) -> usize {
        self.line_starts.partition_point(|start| *start <= offset)
    }

    /// Column of a byte offset, in characters, from 1.
    pub(super) fn column(&self, offset: usize) -> usize {
        let before = self.text.get(..offset).unwrap_or(self.text);
        let line = before.rsplit('\n').next().unwrap_or_default();
        line.chars().count() + 1
    }

    /// The text of a span, sanitised for a message.
    pub(super) fn excerpt(&self, span: &Range<usize>) -> String {
        printable(self.text.get(span.clone()).unwrap_or_default())
    }
}

/// The known name most similar to `word`, if any is similar enough.
pub(super) fn nearest<'k>(word: &str, known: impl Iterator<Item = &'k str>) -> Option<&'k str> {
    /// Jaro–Winkler similarity below which a suggestion would only confuse.
    const ALIKE: f64 = 0.7;
    /// No known name is half as long, and the comparison's cost grows with the length.
    const LONGEST_WORD: usize = 64;
    if word.len() > LONGEST_WORD {
        return None;
    }
    let word = word.to_lowercase();
    known
        .map(|name| (strsim::jaro_winkler(&word, name), name))
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}
