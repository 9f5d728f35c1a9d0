//! Pieces over one another, a row at a time.

use super::piece::{Piece, PieceRows};
use super::target::Target;
use super::texels::TexelKind;
use crate::error::BuildError;
use crate::source::SourceLimits;
use std::path::PathBuf;

/// Composes rows of all pieces.
pub(super) struct Composer {
    pieces: Vec<Piece>,
    states: Vec<PieceState>,
    target: Target,
    kind: TexelKind,
    description: PathBuf,
    limits: SourceLimits,
    /// Values of the row that was made last, and how much of each texel was there.
    pub values: Vec<f32>,
    pub weights: Vec<f32>,
    /// Fraction of each texel through which the pieces beneath are visible.
    left: Vec<f32>,
    notes: Vec<String>,
}

/// How far a piece is.
enum PieceState {
    /// Not yet begun.
    Ahead,
    Open(Box<PieceRows>),
    /// Passed, or broken.
    Over,
}

impl Composer {
    pub(super) fn new(
        pieces: Vec<Piece>,
        target: Target,
        kind: TexelKind,
        description: PathBuf,
        limits: SourceLimits,
    ) -> Self {
        let columns = target.columns as usize;
        Self {
            states: pieces.iter().map(|_| PieceState::Ahead).collect(),
            pieces,
            target,
            kind,
            description,
            limits,
            values: vec![0.0; columns * kind.channels],
            weights: vec![0.0; columns],
            left: vec![0.0; columns],
            notes: Vec::new(),
        }
    }

    /// The rows of piece `n`, if it reaches row `row` of the target and is not broken.
    fn open(&mut self, n: usize, row: u32) -> Result<Option<&mut PieceRows>, BuildError> {
        let (first, end) = self.pieces[n].rows(&self.target);
        if row < first {
            return Ok(None);
        }
        if row >= end {
            self.close(n);
            return Ok(None);
        }
        if matches!(self.states[n], PieceState::Ahead) {
            let rows = PieceRows::open(
                &self.pieces[n],
                &self.target,
                self.kind,
                &self.description,
                self.limits,
            );
            let state = match rows {
                Ok(rows) => PieceState::Open(Box::new(rows)),
                Err(error) => self.broken(error)?,
            };
            self.states[n] = state;
        }
        Ok(match &mut self.states[n] {
            PieceState::Open(rows) => Some(rows),
            PieceState::Ahead | PieceState::Over => None,
        })
    }

    fn close(&mut self, n: usize) {
        if let PieceState::Open(rows) = &mut self.states[n] {
            self.notes.extend(rows.notes());
        }
        self.states[n] = PieceState::Over;
    }

    /// A damaged piece is left out from here on and reported; other errors are returned.
    fn broken(&mut self, error: BuildError) -> Result<PieceState, BuildError> {
        match error {
            BuildError::Damaged { .. } => {
                self.notes
                    .push(format!("{error}; the rest of it is left out"));
                Ok(PieceState::Over)
            }
            other => Err(other),
        }
    }

    /// Takes what an operation on piece `n` gave; a damaged piece gives nothing.
    fn taken<T>(&mut self, n: usize, done: Result<T, BuildError>) -> Result<Option<T>, BuildError> {
        match done {
            Ok(done) => Ok(Some(done)),
            Err(error) => {
                if let PieceState::Open(rows) = &mut self.states[n] {
                    self.notes.extend(rows.notes());
                }
                let state = self.broken(error)?;
                self.states[n] = state;
                Ok(None)
            }
        }
    }

    /// Copies a row, if only unmodified rows of pieces are visible in it.
    pub(super) fn plain(&mut self, row: u32, bytes: &mut [u8]) -> Result<bool, BuildError> {
        let mut seen = Vec::new();
        let mut is_covered = false;
        for n in (0..self.pieces.len()).rev() {
            let Some(rows) = self.open(n, row)? else {
                continue;
            };
            seen.push(n);
            if rows.covers_all() {
                is_covered = true;
                break;
            }
        }
        self.left.fill(1.0);
        let size = bytes.len() / self.left.len();
        // From below, so that higher ones come on top.
        for n in seen.into_iter().rev() {
            let PieceState::Open(rows) = &mut self.states[n] else {
                return Ok(false);
            };
            let done = rows.plain(row).map(|texels| texels.map(<[u8]>::to_vec));
            let Some(Some(texels)) = self.taken(n, done)? else {
                return Ok(false);
            };
            let PieceState::Open(rows) = &self.states[n] else {
                return Ok(false);
            };
            for span in &rows.spans {
                // All are runs of the raster's own texels.
                let from = span.is_same_from.unwrap_or_default() as usize;
                let count = span.taps.len();
                bytes[span.first * size..][..count * size]
                    .copy_from_slice(&texels[from * size..][..count * size]);
                self.left[span.first..][..count].fill(0.0);
            }
        }
        Ok(is_covered || self.left.iter().all(|left| *left == 0.0))
    }

    /// Composes a row: the highest piece first, each where those above it leave it visible.
    pub(super) fn row(&mut self, row: u32) -> Result<(), BuildError> {
        self.values.fill(0.0);
        self.weights.fill(0.0);
        self.left.fill(1.0);
        let channels = self.kind.channels;
        for n in (0..self.pieces.len()).rev() {
            let Some(rows) = self.open(n, row)? else {
                continue;
            };
            let made = rows.row(row);
            if self.taken(n, made)? != Some(true) {
                continue;
            }
            let PieceState::Open(rows) = &self.states[n] else {
                continue;
            };
            let mut at = 0;
            let mut is_covered = true;
            for span in &rows.spans {
                let columns = span.first..span.first + span.taps.len();
                let out = self.values[columns.start * channels..columns.end * channels]
                    .chunks_exact_mut(channels)
                    .zip(&mut self.weights[columns.clone()])
                    .zip(&mut self.left[columns]);
                let values = rows.values[at * channels..].chunks_exact(channels);
                for (((out, weight), left), (values, part)) in
                    out.zip(values.zip(&rows.weights[at..]))
                {
                    for (out, value) in out.iter_mut().zip(values) {
                        *out += *left * value;
                    }
                    *weight += *left * part;
                    *left *= 1.0 - part.clamp(0.0, 1.0);
                }
                at += span.taps.len();
            }
            is_covered &= self.left.iter().all(|left| *left <= 0.0);
            if is_covered {
                break;
            }
        }
        for (texel, weight) in self
            .values
            .chunks_exact_mut(channels)
            .zip(&mut self.weights)
        {
            // Less than a thousandth is rounding.
            if *weight < 1e-3 {
                *weight = 0.0;
                continue;
            }
            if *weight != 1.0 {
                texel.iter_mut().for_each(|value| *value /= *weight);
            }
        }
        Ok(())
    }

    /// Remarks about omitted parts since the last call.
    pub(super) fn notes(&mut self) -> Vec<String> {
        for state in &mut self.states {
            if let PieceState::Open(rows) = state {
                self.notes.extend(rows.notes());
            }
        }
        std::mem::take(&mut self.notes)
    }
}
