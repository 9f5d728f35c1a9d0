//! Resamples heights of a projected grid: all are held in memory and interpolated bilinearly.

use crate::elevation::warp::Warp;

/// Projected heights.
pub(super) struct Held<'a> {
    warp: &'a Warp,
    columns: usize,
    heights_m: Vec<f32>,
}

/// Bytes of the projected heights.
pub(super) fn working_bytes(warp: &Warp) -> u64 {
    4 * warp.samples() as u64
}

impl<'a> Held<'a> {
    /// Creates the buffer without any heights.
    pub(super) fn new(warp: &'a Warp) -> Self {
        Self {
            warp,
            columns: warp.size().0 as usize,
            heights_m: vec![f32::NAN; warp.samples()],
        }
    }

    /// Stores heights of a row from a column on.
    pub(super) fn put(&mut self, row: usize, column: usize, heights_m: &[f32]) {
        let start = row * self.columns + column;
        self.heights_m[start..start + heights_m.len()].copy_from_slice(heights_m);
    }

    /// Passes on all rows of the target grid; NaN outside the projected one. Returns how many places lie outside.
    pub(super) fn rows<E>(
        &self,
        put: &mut impl FnMut(usize, usize, &mut [f32]) -> Result<(), E>,
    ) -> Result<u64, E> {
        let warp = self.warp;
        let mut outside = 0;
        let mut heights_m = vec![0.0; warp.place.columns as usize];
        let mut places = Vec::new();
        for row in 0..warp.place.rows {
            warp.locate_row(row, &mut places);
            outside += places.iter().filter(|at| at.is_none()).count() as u64;
            for (height_m, at) in heights_m.iter_mut().zip(&places) {
                *height_m = at.map_or(f32::NAN, |(row, column)| self.height_m(row, column));
            }
            put(row as usize, 0, &mut heights_m)?;
        }
        Ok(outside)
    }

    fn height_m(&self, row: f64, column: f64) -> f32 {
        let rows = self.heights_m.len() / self.columns;
        // There are at least two rows and columns.
        let (top, left) = (
            (row as usize).min(rows - 2),
            (column as usize).min(self.columns - 2),
        );
        let (down, right) = (row - top as f64, column - left as f64);
        let at = |row: usize, column: usize| f64::from(self.heights_m[row * self.columns + column]);
        let across = |row: usize| at(row, left) + right * (at(row, left + 1) - at(row, left));
        let height = across(top) + down * (across(top + 1) - across(top));
        match height.is_nan() {
            // Beside a hole the nearest sample counts.
            true => at(
                top + usize::from(down > 0.5),
                left + usize::from(right > 0.5),
            ) as f32,
            false => height as f32,
        }
    }
}
