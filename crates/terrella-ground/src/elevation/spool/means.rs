//! Means for holes: pyramid levels in scratch files, built upwards until no hole is left, then filled downwards.

use super::store::{Kept, OpenStore, Store};
use super::{Scratch, SpoolError};
use crate::elevation::grid::holes::fill_row;
use crate::elevation::grid::levels::{Averager, LevelShape, spans};
use crate::elevation::grid::placement::Placement;

/// The filled level above the finest, from which holes of the finest are filled. `None` if the finest is the only
/// level.
pub(super) fn filled(
    place: &Placement,
    shapes: &[LevelShape],
    finest: &Store,
    scratch: &Scratch<'_>,
) -> Result<Option<Store>, SpoolError> {
    let mut means: Vec<Store> = Vec::new();
    for (level, pair) in shapes.windows(2).enumerate() {
        let size = (pair[1].columns, pair[1].rows);
        let store = scratch.store(&format!("means-{}", level + 1), size, Kept::Float)?;
        let below = means.last().unwrap_or(finest);
        let is_whole = average(place, pair, (below, &store), scratch)?;
        means.push(store);
        if is_whole {
            break;
        }
    }
    while let Some(coarser) = means.pop() {
        let level = means.len();
        let Some(fine) = means.last() else {
            return Ok(Some(coarser));
        };
        fill(&shapes[level..level + 2], (fine, &coarser), scratch)?;
    }
    Ok(None)
}

/// Writes the means of a level. Returns whether they have no hole.
fn average(
    place: &Placement,
    shapes: &[LevelShape],
    (fine, coarse): (&Store, &Store),
    scratch: &Scratch<'_>,
) -> Result<bool, SpoolError> {
    let (mut from, mut to) = (fine.open()?, coarse.open()?);
    let columns = shapes[0].columns;
    let mut averager = Averager::new(&place.lattice, &shapes[0], &shapes[1]);
    let (mut values, mut means) = (Vec::new(), Vec::new());
    let mut is_whole = true;
    for (row, span) in spans(shapes[0].rows, shapes[1].rows).enumerate() {
        scratch.go_on()?;
        values.resize(span.1.len() * columns, 0.0);
        for (n, values) in values.chunks_exact_mut(columns).enumerate() {
            from.read(span.0 + n, 0, values)?;
        }
        means.clear();
        averager.row(&span, &values, &mut means);
        is_whole &= means.iter().all(|mean| !mean.is_nan());
        to.write(row, 0, &means)?;
    }
    Ok(is_whole)
}

/// Fills the holes of a level from the next coarser one.
fn fill(
    shapes: &[LevelShape],
    (fine, coarse): (&Store, &Store),
    scratch: &Scratch<'_>,
) -> Result<(), SpoolError> {
    let (mut file, mut from) = (fine.open()?, coarse.open()?);
    let shape = &shapes[0];
    let mut values = vec![0.0; shape.columns];
    let mut rows = Rows::new(&shapes[1]);
    for row in 0..shape.rows {
        scratch.go_on()?;
        file.read(row, 0, &mut values)?;
        if !values.iter().any(|value| value.is_nan()) {
            continue;
        }
        let base_row = (row as f64 + 0.5) / shape.row_ratio - 0.5;
        rows.load(&mut from, base_row)?;
        let coarser = |row: usize, column: usize| rows.at(row, column);
        let columns = 0..shape.columns;
        fill_row(shape, row, columns, &mut values, &shapes[1], coarser);
        file.write(row, 0, &values)?;
    }
    Ok(())
}

/// The two rows of a level around a place.
struct Rows<'a> {
    shape: &'a LevelShape,
    first: Option<usize>,
    values: Vec<f32>,
}

impl<'a> Rows<'a> {
    fn new(shape: &'a LevelShape) -> Self {
        Self {
            shape,
            first: None,
            values: vec![0.0; 2 * shape.columns],
        }
    }

    /// Reads the rows around a row of the finest level.
    fn load(&mut self, from: &mut OpenStore<'_>, base_row: f64) -> Result<(), SpoolError> {
        let (row, _) = self.shape.own(base_row, 0.0);
        // Negative numbers saturate at 0.
        let first = (row as usize).min(self.shape.rows.saturating_sub(2));
        if self.first != Some(first) {
            let rows = self.values.chunks_exact_mut(self.shape.columns);
            for (row, values) in (first..self.shape.rows).zip(rows) {
                from.read(row, 0, values)?;
            }
            self.first = Some(first);
        }
        Ok(())
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        let row = row - self.first.unwrap_or(row);
        f64::from(self.values[row * self.shape.columns + column])
    }
}
