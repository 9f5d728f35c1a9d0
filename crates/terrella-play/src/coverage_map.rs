//! How a scene's satellites cover the ground: a table by latitude, one by cell, and a map as GeoJSON.

use super::coverage_cells::CoverageCells;
use super::coverage_scale::gap_color;
use super::{Flight, PlayError, Satellite};
use std::fmt::Write;
use terrella::frames::{Duration, rfc3339};
use terrella_orbit::{Cell, CellCoverage, GroundSensor, MAX_CELLS, coverage_grid, coverage_while};

/// The columns of a table of cells.
const CSV_HEADER: &str = "lat_deg,lon_deg,accesses,covered_s,longest_gap_s,revisit_s\n";
/// Height of a band of the table by latitude, degrees.
const BAND_DEG: f64 = 10.0;
/// Opacity of these cells.
const OPACITY: f64 = 0.5;

/// What is covered, by what.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoverageRequest {
    /// Side of a cell, degrees.
    pub step_deg: f64,
    /// West, south, east and north, degrees.
    pub region_deg: [f64; 4],
    /// For how long from the scene's first instant on; `None` is to its last.
    pub length: Option<Duration>,
}

/// The cells of a region, with what of them is covered.
pub struct CoverageMap {
    names: String,
    found: CoverageCells,
}

impl CoverageMap {
    /// Computes it, of these satellites with their sensors.
    ///
    /// # Errors
    /// Too many cells, and what a feed rejects.
    pub fn new(
        flight: &Flight,
        sensors: &[(&Satellite, GroundSensor)],
        request: &CoverageRequest,
    ) -> Result<Self, PlayError> {
        // It is always wanted.
        Self::new_while(&|| true, flight, sensors, request)?.ok_or(PlayError::NoSatellite)
    }

    /// The same as long as it is wanted; `None` once it is not.
    pub(crate) fn new_while(
        is_wanted: &dyn Fn() -> bool,
        flight: &Flight,
        sensors: &[(&Satellite, GroundSensor)],
        request: &CoverageRequest,
    ) -> Result<Option<Self>, PlayError> {
        let scene = flight.scene();
        let span = scene.time.span(request.length);
        let region = request.region_deg.map(f64::to_radians);
        let grid = coverage_grid(request.step_deg.to_radians(), region);
        if grid.len() > MAX_CELLS {
            return Err(PlayError::CoverageCells { most: MAX_CELLS });
        }
        let orientation = |epoch| flight.orientation_at(epoch);
        let feeds: Vec<_> = sensors
            .iter()
            .map(|(satellite, sensor)| (satellite.feed(), *sensor))
            .collect();
        let ellipsoid = flight.ellipsoid();
        let found = coverage_while(is_wanted, &grid, &feeds, ellipsoid, &orientation, span)?;
        let Some(found) = found else {
            return Ok(None);
        };
        let names: Vec<_> = sensors.iter().map(|(one, _)| one.name()).collect();
        Ok(Some(Self {
            names: match names.as_slice() {
                [] | [_] | [_, _] | [_, _, _] => names.join(", "),
                all => format!("{} satellites", all.len()),
            },
            found: CoverageCells {
                span,
                west_rad: region[0],
                cells: grid.into_iter().zip(found).collect(),
            },
        }))
    }

    /// The cells alone.
    pub(crate) fn into_cells(self) -> CoverageCells {
        self.found
    }

    /// Bands of latitude, from north to south, and all of them: the share of the area that is seen, and means over the seen part.
    // Writing to a string cannot fail.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{}, {} cells, {} to {}\n{:>14} {:>8} {:>10} {:>12} {:>12} {:>12}\n",
            self.names,
            self.found.cells.len(),
            rfc3339(self.found.span.0),
            rfc3339(self.found.span.1),
            "latitude",
            "covered",
            "accesses",
            "view, min",
            "revisit, min",
            "gap, min"
        );
        let bands = (180.0 / BAND_DEG) as i32;
        for band in (0..bands).rev() {
            let south = -90.0 + f64::from(band) * BAND_DEG;
            let range = south..south + BAND_DEG;
            let is_in = |cell: &Cell| range.contains(&cell.lat_rad.to_degrees());
            if self.found.cells.iter().any(|(cell, _)| is_in(cell)) {
                let name = format!("{south:.0}° to {:.0}°", south + BAND_DEG);
                let _ = writeln!(text, "{name:>14} {}", self.row(is_in));
            }
        }
        let _ = writeln!(text, "{:>14} {}", "all", self.row(|_| true));
        text
    }

    /// The numbers of some cells, weighted by their area.
    fn row(&self, is_in: impl Fn(&Cell) -> bool) -> String {
        let mean = |value: &dyn Fn(&CellCoverage) -> Option<f64>| {
            let (mut sum, mut weight) = (0.0, 0.0);
            for (cell, one) in self.found.cells.iter().filter(|(cell, _)| is_in(cell)) {
                if let Some(value) = value(one) {
                    sum += cell.weight() * value;
                    weight += cell.weight();
                }
            }
            (weight > 0.0).then(|| sum / weight)
        };
        let seen = |one: &CellCoverage| one.accesses > 0;
        let covered = mean(&|one| Some(if seen(one) { 100.0 } else { 0.0 }));
        let number =
            |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.1}"));
        let accesses = mean(&|one| seen(one).then(|| f64::from(one.accesses)));
        let view = mean(&|one| seen(one).then(|| one.covered_s / 60.0));
        let revisit = mean(&|one| one.revisit_s.map(|s| s / 60.0));
        let seen_cells = self
            .found
            .cells
            .iter()
            .filter(|(cell, one)| is_in(cell) && seen(one));
        let gap = seen_cells
            .map(|(_, one)| one.longest_gap_s / 60.0)
            .reduce(f64::max);
        format!(
            "{:>6} % {:>10} {:>12} {:>12} {:>12}",
            number(covered),
            number(accesses),
            number(view),
            number(revisit),
            number(gap)
        )
    }

    /// A row for each cell.
    pub fn csv(&self) -> String {
        let mut text = CSV_HEADER.to_owned();
        for (cell, one) in &self.found.cells {
            let _ = writeln!(
                text,
                "{:.4},{:.4},{},{:.1},{:.1},{}",
                cell.lat_rad.to_degrees(),
                cell.lon_rad.to_degrees(),
                one.accesses,
                one.covered_s,
                one.longest_gap_s,
                one.revisit_s
                    .map_or(String::new(), |revisit| format!("{revisit:.1}"))
            );
        }
        text
    }

    /// The cells as polygons, coloured by their longest gap: for `[[geojson]]` of a scene. Cells that are never in view are left out.
    pub fn geojson(&self) -> String {
        let features = self.found.cells.iter().filter(|(_, one)| one.accesses > 0).map(|(cell, one)| {
            let [red, green, blue] = gap_color(one.longest_gap_s);
            let color = format!("#{red:02x}{green:02x}{blue:02x}");
            let [a, b, c, d] = cell.corners_deg();
            serde_json::json!({
                "type": "Feature",
                "properties": {
                    "fill": color, "fill-opacity": OPACITY, "stroke-width": 0, "accesses": one.accesses, "covered_s": one.covered_s,
                    "longest_gap_s": one.longest_gap_s, "revisit_s": one.revisit_s,
                },
                "geometry": { "type": "Polygon", "coordinates": [[a, b, c, d, a]] },
            })
        });
        let all = serde_json::json!({
            "type": "FeatureCollection",
            "features": features.collect::<Vec<_>>(),
        });
        all.to_string() + "\n"
    }
}
