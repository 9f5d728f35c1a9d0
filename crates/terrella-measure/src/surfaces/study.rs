//! All that is found of surfaces, and which to choose.

use super::rows::{csv_of, rows_of};
use super::{ErrorRow, SettlingRow, SurfacePath, SurfacesError, SurfacesPart, TimeRow};
use crate::{Quartiles, SortedSample};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use terrella_ground::globe::SurfaceKind;

/// Results, and their settings.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct SurfaceStudy {
    /// The adapter's name and backend; empty where nothing was measured now.
    pub adapter: String,
    /// Of all pictures, pixels.
    pub size: (u32, u32),
    /// Of whole flights.
    pub errors: Vec<ErrorRow>,
    /// Of single frames.
    pub times: Vec<TimeRow>,
    /// After a jump.
    pub settling: Vec<SettlingRow>,
    /// Whether it was stopped early.
    pub is_partial: bool,
}

/// Frame times of one setting on one flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlightSummary {
    /// Frames that were timed.
    pub frames: usize,
    /// A frame, milliseconds.
    pub frame_ms: Quartiles,
    /// A frame over its floor, each taken in the same moment.
    pub over_floor: Quartiles,
    /// A frame over a frame of blocks, each taken in the same moment.
    pub over_blocks: Quartiles,
    /// The processor's work for a frame over that for a frame of blocks.
    pub work_over_blocks: Quartiles,
}

impl FlightSummary {
    /// `None` of nothing.
    pub fn of(rows: &[&TimeRow]) -> Option<Self> {
        let spread = |of: fn(&TimeRow) -> f64| Quartiles::of(rows.iter().map(|row| of(row)));
        (!rows.is_empty()).then(|| Self {
            frames: rows.len(),
            frame_ms: spread(|row| row.frame_ms),
            over_floor: spread(|row| row.frame_ms / row.floor_ms),
            over_blocks: spread(|row| row.frame_ms / row.blocks_ms),
            work_over_blocks: spread(|row| row.processor_ms / row.blocks_processor_ms),
        })
    }
}

/// Largest error, as the 99th percentile over the pixels of a whole flight, of a surface that counts as exact, pixels.
pub const EXACT_PX: f64 = 1.0;
/// Costs that differ by less than this count as the same.
pub const SAME_COST: f64 = 1.1;

impl SurfaceStudy {
    /// Reads the tables that are there; `read` gives a file's text, empty where it is not.
    ///
    /// # Errors
    /// Those of `read`; a table with lines that are no rows of it.
    pub fn read(
        read: impl Fn(&'static str) -> Result<String, SurfacesError>,
    ) -> Result<Self, SurfacesError> {
        fn table<Row: DeserializeOwned>(
            part: SurfacesPart,
            text: Result<String, SurfacesError>,
        ) -> Result<Vec<Row>, SurfacesError> {
            let file = part.file();
            rows_of(&text?).map_err(|source| SurfacesError::Table { file, source })
        }
        let of = |part: SurfacesPart| read(part.file());
        let [errors, times, settling] = SurfacesPart::ALL;
        Ok(Self {
            errors: table(errors, of(errors))?,
            times: table(times, of(times))?,
            settling: table(settling, of(settling))?,
            ..Self::default()
        })
    }

    /// The table of a part.
    pub fn csv(&self, part: SurfacesPart) -> String {
        match part {
            SurfacesPart::Errors => csv_of(&self.errors),
            SurfacesPart::Times => csv_of(&self.times),
            SurfacesPart::Settling => csv_of(&self.settling),
        }
    }

    /// The grounds, in order.
    pub fn data(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for row in &self.errors {
            if !names.contains(&row.data.as_str()) {
                names.push(&row.data);
            }
        }
        names
    }

    /// The rows of one flight over one ground.
    pub fn of(&self, data: &str, path: SurfacePath) -> impl Iterator<Item = &ErrorRow> {
        let rows = self.errors.iter();
        rows.filter(move |row| row.data == data && row.path == path)
    }

    /// Frame times of a row; `None` if they were not measured.
    pub fn summary_of(&self, row: &ErrorRow) -> Option<FlightSummary> {
        let is_its = |time: &&TimeRow| {
            let setting = (time.surface, &time.parameter, &time.value);
            let flight = (&time.data, time.path);
            flight == (&row.data, row.path) && setting == (row.surface, &row.parameter, &row.value)
        };
        FlightSummary::of(&self.times.iter().filter(is_its).collect::<Vec<_>>())
    }

    /// Which surface to choose, as text for a terminal: a line for each ground and flight.
    pub fn summary(&self) -> String {
        let mut text = String::new();
        for data in self.data() {
            for path in SurfacePath::ALL {
                let Some(row) = self.choice(data, path) else {
                    continue;
                };
                let cost = self.summary_of(row).map_or_else(
                    || "not timed".to_owned(),
                    |cost| format!("{:.2} of a frame of blocks", cost.over_blocks.median),
                );
                // Writing to a string cannot fail.
                let _ = writeln!(
                    text,
                    "{data}, {}: {} ({} {}): {cost}, {:.2} px",
                    path.name(),
                    row.surface.name(),
                    row.parameter,
                    row.value,
                    row.error_px_p99,
                );
            }
        }
        if let Some(surface) = self.default_surface() {
            let _ = writeln!(text, "near the ground: {}", surface.name());
        }
        text
    }

    /// The cheapest setting without holes whose error 99 of a hundred pixels keep below a pixel, else the most exact
    /// without holes.
    pub fn choice(&self, data: &str, path: SurfacePath) -> Option<&ErrorRow> {
        let sound: Vec<_> = self.of(data, path).filter(|row| row.holes == 0).collect();
        let cost = |row: &&&ErrorRow| {
            let summary = self.summary_of(row);
            summary.map_or(f64::INFINITY, |s| s.over_blocks.median)
        };
        let exact = sound.iter().filter(|row| row.error_px_p99 <= EXACT_PX);
        let cheapest = exact.min_by(|a, b| cost(a).total_cmp(&cost(b)));
        let most_exact = || {
            sound
                .iter()
                .min_by(|a, b| a.error_px_p99.total_cmp(&b.error_px_p99))
        };
        cheapest.or_else(most_exact).copied()
    }

    /// The default surface of a scene with elevation data, by this rule. Candidates are the surfaces at their defaults, on the flights near the
    /// ground (descent, low flight, horizon) over real terrain: those without holes and exact to [`EXACT_PX`] on each; of these, those whose frames
    /// cost at most [`SAME_COST`] times the cheapest's; of these, the one with the least error over the worst terrain. If none is exact, the one
    /// with the least error on real terrain. `None` without complete measurements.
    pub fn default_surface(&self) -> Option<SurfaceKind> {
        let scores: Vec<Score> = SurfaceKind::ALL
            .iter()
            .filter_map(|kind| self.score(*kind))
            .collect();
        let exact: Vec<_> = scores
            .iter()
            .filter(|s| s.is_sound && s.real_px <= EXACT_PX)
            .collect();
        if exact.is_empty() {
            let least = scores.iter().min_by(|a, b| a.real_px.total_cmp(&b.real_px));
            return least.map(|score| score.surface);
        }
        let cheapest = exact.iter().map(|s| s.cost).fold(f64::INFINITY, f64::min);
        let cheap = exact.iter().filter(|s| s.cost <= SAME_COST * cheapest);
        cheap
            .min_by(|a, b| a.worst_px.total_cmp(&b.worst_px))
            .map(|score| score.surface)
    }

    /// Inputs of the rule of [`Self::default_surface`]; `None` if a flight is missing.
    pub fn score(&self, surface: SurfaceKind) -> Option<Score> {
        let rows: Vec<_> = self
            .errors
            .iter()
            .filter(|row| {
                row.is_default && row.surface == surface && row.path != SurfacePath::Orbit
            })
            .collect();
        let (worst, real): (Vec<&ErrorRow>, Vec<_>) =
            rows.iter().partition(|row| row.data == WORST);
        let costs: Option<Vec<f64>> = real
            .iter()
            .map(|row| Some(self.summary_of(row)?.over_blocks.median.ln()))
            .collect();
        let costs = costs.filter(|costs| !costs.is_empty())?;
        let most = |rows: &[&ErrorRow]| rows.iter().map(|row| row.error_px_p99).fold(0.0, f64::max);
        Some(Score {
            surface,
            is_sound: real.iter().all(|row| row.holes == 0),
            real_px: most(&real),
            worst_px: most(&worst),
            cost: SortedSample::new(costs).mean().exp(),
        })
    }
}

/// The name of the ground that no surface likes.
pub const WORST: &str = "worst case";

/// A surface at its default, near the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    pub surface: SurfaceKind,
    /// Without holes over real ground.
    pub is_sound: bool,
    /// 99th percentile over the pixels of the worst flight over real terrain, pixels.
    pub real_px: f64,
    /// The same over the worst ground.
    pub worst_px: f64,
    /// A frame over one of blocks: geometric mean over flights over real ground.
    pub cost: f64,
}
