//! Fills samples without data, and rates their confidence.

use super::levels::LevelShape;

/// A hole up to this many samples from the nearest datum is filled from the coarser levels alone.
pub(in crate::elevation) const FILLED: u8 = 4;

/// From this many samples on, the source beneath the grid applies instead.
pub(in crate::elevation) const LEFT: u8 = 9;

/// Replaces every NaN sample of a level by the value of the next coarser level at its place.
pub(super) fn fill(shape: &LevelShape, values: &mut [f32], coarse: &LevelShape, coarser: &[f32]) {
    for (row, values) in values.chunks_exact_mut(shape.columns).enumerate() {
        fill_row(
            shape,
            row,
            0..shape.columns,
            values,
            coarse,
            |row, column| f64::from(coarser[row * coarse.columns + column]),
        );
    }
}

/// Fills some columns of one row; `coarser` returns the next coarser level's sample at a row and column.
pub(in crate::elevation) fn fill_row(
    shape: &LevelShape,
    row: usize,
    columns: impl Iterator<Item = usize>,
    values: &mut [f32],
    coarse: &LevelShape,
    coarser: impl Fn(usize, usize) -> f64,
) {
    // Poles have no values yet: beyond the outermost row its value applies.
    let coarse = LevelShape {
        north_pole: None,
        south_pole: None,
        ..*coarse
    };
    let base = |n: usize, ratio: f64| (n as f64 + 0.5) / ratio - 0.5;
    for (column, value) in columns.zip(values) {
        if value.is_nan() {
            *value = coarse.interpolate(
                base(row, shape.row_ratio),
                base(column, shape.column_ratio),
                [0.0; 2],
                &coarser,
            ) as f32;
        }
    }
}

/// Confidence of each sample, 0…255 for 0…1: full up to [`FILLED`] samples from a datum, then decreasing up to
/// [`LEFT`]. Diagonal neighbours count as neighbours. `None` if all samples have full confidence.
pub(super) fn coverage(shape: &LevelShape, is_hole: &[bool]) -> Option<Vec<u8>> {
    let mut steps = steps_to_data(shape.columns, shape.is_periodic, is_hole);
    if steps.iter().all(|steps| *steps <= FILLED) {
        return None;
    }
    for steps in &mut steps {
        *steps = believed(*steps);
    }
    Some(steps)
}

/// Confidence of a sample this many steps from a datum, 0…255 for 0…1.
pub(in crate::elevation) fn believed(steps: u8) -> u8 {
    let part = f64::from(LEFT.saturating_sub(steps)) / f64::from(LEFT - FILLED);
    (255.0 * part.min(1.0)).round() as u8
}

/// Steps from each sample of rows to the nearest datum, at most [`LEFT`]. Data farther than that from a sample do not affect
/// it.
pub(in crate::elevation) fn steps_to_data(
    columns: usize,
    is_periodic: bool,
    is_hole: &[bool],
) -> Vec<u8> {
    let rows = is_hole.len() / columns.max(1);
    let mut steps: Vec<u8> = is_hole
        .iter()
        .map(|hole| if *hole { LEFT } else { 0 })
        .collect();
    // Steps to the nearest datum, propagated from visited neighbours: rows downwards, then upwards. A periodic row
    // needs two rounds.
    let wrap = |column: isize| -> Option<usize> {
        if is_periodic {
            Some(column.rem_euclid(columns as isize) as usize)
        } else {
            usize::try_from(column).ok().filter(|c| *c < columns)
        }
    };
    let rounds = if is_periodic { 2 } else { 1 };
    for _ in 0..rounds {
        for is_downwards in [true, false] {
            for n in 0..rows {
                let row = if is_downwards { n } else { rows - 1 - n };
                let behind = match (is_downwards, row) {
                    (true, 0) => None,
                    (true, row) => Some(row - 1),
                    (false, row) => Some(row + 1).filter(|row| *row < rows),
                };
                for m in 0..columns {
                    let column = if is_downwards { m } else { columns - 1 - m };
                    let here = row * columns + column;
                    if steps[here] == 0 {
                        continue;
                    }
                    let side = if is_downwards { -1 } else { 1 };
                    let mut least = wrap(column as isize + side)
                        .map_or(LEFT, |column| steps[row * columns + column]);
                    if let Some(behind) = behind {
                        for side in -1..=1 {
                            if let Some(column) = wrap(column as isize + side) {
                                least = least.min(steps[behind * columns + column]);
                            }
                        }
                    }
                    steps[here] = steps[here].min(least.saturating_add(1));
                }
            }
        }
    }
    steps
}
