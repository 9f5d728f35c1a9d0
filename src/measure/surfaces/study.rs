//! What is found of all surfaces, and which to choose.

use super::{SurfacePath, SurfaceRow};
use std::fmt::Write;

/// What was found, and with what.
#[derive(Clone, Debug)]
pub struct SurfaceStudy {
    /// The adapter's name and backend.
    pub adapter: String,
    /// Of the frames that were timed, pixels.
    pub size: (u32, u32),
    /// Of the pictures that were held against the data, pixels.
    pub compared_size: (u32, u32),
    /// Places of each flight.
    pub places: u32,
    /// What was found.
    pub rows: Vec<SurfaceRow>,
    /// Rows that were wanted; more than there are if it was stopped.
    pub wanted: usize,
}

impl SurfaceStudy {
    /// The grounds, in order.
    pub fn data(&self) -> Vec<&'static str> {
        let mut names = Vec::new();
        for row in &self.rows {
            if !names.contains(&row.data) {
                names.push(row.data);
            }
        }
        names
    }

    /// Which surface to choose, as text for a terminal: a line for each ground and flight.
    pub fn summary(&self) -> String {
        let mut text = String::new();
        for data in self.data() {
            for path in SurfacePath::ALL {
                let Some(row) = self.choice(data, path) else {
                    continue;
                };
                // Writing to a string cannot fail.
                let _ = writeln!(
                    text,
                    "{data}, {}: {} ({} {}): {:.2} of the floor, {:.2} px",
                    path.name(),
                    row.setting.surface,
                    row.setting.parameter,
                    row.setting.value,
                    row.floor_ratio.median,
                    row.errors.p99_px,
                );
            }
        }
        text
    }

    /// The rows of one flight over one ground.
    pub(super) fn of(&self, data: &str, path: SurfacePath) -> Vec<&SurfaceRow> {
        let rows = self.rows.iter();
        rows.filter(|row| row.data == data && row.path == path)
            .collect()
    }

    /// The cheapest setting without holes whose error 99 of a hundred pixels keep below a pixel, else the most exact
    /// without holes.
    pub fn choice(&self, data: &str, path: SurfacePath) -> Option<&SurfaceRow> {
        let rows = self.of(data, path).into_iter();
        let sound: Vec<_> = rows.filter(|row| row.errors.holes == 0).collect();
        let exact = sound.iter().filter(|row| row.errors.p99_px <= 1.0);
        let cheapest = exact.min_by(|a, b| a.floor_ratio.median.total_cmp(&b.floor_ratio.median));
        let least = || {
            sound
                .iter()
                .min_by(|a, b| a.errors.p99_px.total_cmp(&b.errors.p99_px))
        };
        cheapest.or_else(least).copied()
    }
}
