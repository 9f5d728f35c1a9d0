//! Maps of cells in rows, such as the coverage of a region, as triangles without seams.
//!
//! Polygons soften their edges. Where two cells of one colour meet, two soft edges would leave a faint line between them, and neighbours with
//! different corners a gap. So cells of one style are joined along their row, the rows on both sides of a parallel share all corners there, and
//! only the edges of the map are soft.

use super::triangulation::{GroundTriangle, PlaneTriangle, mark_corners, step_for};
use super::{FillStyle, MAX_TRIANGLES, Polygons, TracksError};
use std::f64::consts::{FRAC_PI_2, TAU};
use terrella_frames::Ellipsoid;

/// Angles that differ by less are the same, radians.
const SAME_RAD: f64 = 1e-9;
/// How far east or west a meridian may lie, radians: files and regions go on beyond the date line.
const WIDEST_RAD: f64 = 3.0 * TAU;
/// Meridians are rounded to this, radians, so that those that rows share are the very same.
const GRID_RAD: f64 = 1e-10;

/// Cells between two parallels, for [`Polygons::of_rows`].
#[derive(Clone, Debug, PartialEq)]
pub struct FillRow {
    /// The southern and the northern parallel, radians of geodetic latitude.
    pub lat_rad: [f64; 2],
    /// From west to east; none overlaps the next.
    pub cells: Vec<FillCell>,
}

/// A cell of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FillCell {
    /// The western and the eastern meridian, radians; they may lie beyond ±π, by the same turn for all rows.
    pub lon_rad: [f64; 2],
    /// Index of its style; `None` is not filled.
    pub style: Option<usize>,
}

/// Neighbouring cells of one style.
#[derive(Clone, Copy, Debug)]
struct Run {
    west: f64,
    east: f64,
    style: usize,
}

/// A row with its runs, from west to east.
struct Row {
    lat: [f64; 2],
    runs: Vec<Run>,
}

impl Polygons {
    /// Rows of cells on the ellipsoid, filled by style: a polygon layer for each of `styles` that has cells, in their order. Rows go from south
    /// to north. Where a row ends at the parallel at which the next begins, their cells meet without a gap or a seam.
    ///
    /// # Errors
    /// A style out of range, cells that are empty, out of order or beyond three turns of longitude, and more than [`MAX_TRIANGLES`] in all.
    pub fn of_rows(
        styles: &[FillStyle],
        ellipsoid: &Ellipsoid,
        rows: &[FillRow],
    ) -> Result<Vec<Self>, TracksError> {
        styles.iter().try_for_each(FillStyle::check)?;
        let rows = joined(styles.len(), rows)?;
        let area = |row: &Row| {
            let widths = row.runs.iter().map(|run| run.east - run.west);
            widths.sum::<f64>() * (row.lat[1] - row.lat[0])
        };
        let step_rad = step_for(2.0 * rows.iter().map(area).sum::<f64>());
        let rows: Vec<_> = rows.iter().flat_map(|row| row.divided(step_rad)).collect();
        let mut layers = vec![Vec::new(); styles.len()];
        let mut left = MAX_TRIANGLES;
        for (index, row) in rows.iter().enumerate() {
            let next_to = |other: Option<&Row>, lat: f64| {
                let runs = other.filter(|other| other.lat.contains(&lat));
                runs.map_or_else(Vec::new, |other| other.runs.clone())
            };
            let south = next_to(index.checked_sub(1).map(|before| &rows[before]), row.lat[0]);
            let north = next_to(rows.get(index + 1), row.lat[1]);
            for (at, run) in row.runs.iter().enumerate() {
                let triangles: &mut Vec<GroundTriangle> = &mut layers[run.style];
                let before = triangles.len();
                for triangle in row.triangles(at, [&south, &north], step_rad) {
                    triangle.subdivide(step_rad, ellipsoid, before + left, triangles);
                    if triangles.len() > before + left {
                        let what = "cells have more than 300 000 triangles; make them larger";
                        return Err(TracksError::Lines { what });
                    }
                }
                left -= triangles.len() - before;
            }
        }
        let filled = styles.iter().zip(layers);
        let filled = filled.filter(|(_, triangles)| !triangles.is_empty());
        Ok(filled
            .map(|(style, mut triangles)| {
                mark_corners(&mut triangles);
                Self::of_triangles(*style, triangles, 0)
            })
            .collect())
    }
}

/// The rows with their cells joined, on parallels that are the very same where they meet.
fn joined(styles: usize, rows: &[FillRow]) -> Result<Vec<Row>, TracksError> {
    let wrong = |what| TracksError::Lines { what };
    let mut joined: Vec<Row> = Vec::with_capacity(rows.len());
    for FillRow { lat_rad, cells } in rows {
        let [mut south, north] = *lat_rad;
        let in_order = -FRAC_PI_2 - SAME_RAD <= south && south < north;
        if !(in_order && north <= FRAC_PI_2 + SAME_RAD) {
            return Err(wrong(
                "the parallels of a row are not in order, or no latitudes",
            ));
        }
        if let Some(before) = joined.last().map(|row| row.lat[1]) {
            if south < before - SAME_RAD {
                return Err(wrong(
                    "rows of cells overlap, or do not go from south to north",
                ));
            }
            if south < before + SAME_RAD {
                south = before;
            }
        }
        let lat = [south, north].map(|lat| lat.clamp(-FRAC_PI_2, FRAC_PI_2));
        let mut row = Row {
            lat,
            runs: Vec::new(),
        };
        let mut end = f64::NEG_INFINITY;
        for FillCell { lon_rad, style } in cells {
            let [west, east] = lon_rad.map(on_grid);
            let is_cell = west < east && west.abs() <= WIDEST_RAD && east.abs() <= WIDEST_RAD;
            if !(is_cell && west >= end - SAME_RAD) {
                return Err(wrong(
                    "the cells of a row are not in order, or not within three turns of longitude",
                ));
            }
            end = east;
            let Some(style) = *style else { continue };
            if style >= styles {
                return Err(wrong("a cell has a style that there is none of"));
            }
            match row.runs.last_mut() {
                Some(run) if run.style == style && (west - run.east).abs() < SAME_RAD => {
                    run.east = east;
                }
                _ => row.runs.push(Run { west, east, style }),
            }
        }
        joined.push(row);
    }
    Ok(joined)
}

impl Row {
    /// The same in rows that are no higher than a step.
    fn divided(&self, step_rad: f64) -> impl Iterator<Item = Self> {
        let [south, north] = self.lat;
        let count = ((north - south) / step_rad).ceil().max(1.0) as u32;
        // Both rows at a parallel have the very same one.
        let at = move |index: u32| match index {
            0 => south,
            index if index == count => north,
            index => south + (north - south) * f64::from(index) / f64::from(count),
        };
        let runs = self.runs.clone();
        (0..count).map(move |index| Self {
            lat: [at(index), at(index + 1)],
            runs: runs.clone(),
        })
    }

    /// The triangles of a run between the corners on both its parallels; `beside` are the runs south and north of this row.
    fn triangles(&self, at: usize, beside: [&[Run]; 2], step_rad: f64) -> Vec<PlaneTriangle> {
        let run = self.runs[at];
        let beside = beside.map(|runs| touching(runs, run.west, run.east));
        let [south, north] =
            [0, 1].map(|side| corners(run, beside[side], self.lat[side], step_rad));
        let is_edge = |side: usize, west: f64, east: f64| {
            let middle = 0.5 * (west + east);
            let is_pole = FRAC_PI_2 - self.lat[side].abs() < SAME_RAD;
            !is_pole && touching(beside[side], middle, middle).is_empty()
        };
        // A row that goes all around the Earth meets itself.
        let around = |from: f64, to: f64| {
            let apart = from - to;
            (apart - TAU * (apart / TAU).round()).abs() < SAME_RAD
        };
        let ends = self.runs.first().zip(self.runs.last());
        let meets_itself = ends.is_some_and(|(first, last)| around(first.west, last.east));
        let before = at.checked_sub(1).and_then(|before| self.runs.get(before));
        let west_edge = match before {
            None => !meets_itself,
            Some(before) => run.west - before.east > SAME_RAD,
        };
        let east_edge = match self.runs.get(at + 1) {
            None => !meets_itself,
            Some(after) => after.west - run.east > SAME_RAD,
        };
        let bit = |is_edge: bool, bit: u32| u32::from(is_edge) << bit;
        let mut triangles = Vec::with_capacity(south.len() + north.len());
        let (mut i, mut j) = (0, 0);
        while i + 1 < south.len() || j + 1 < north.len() {
            let goes_south = match (south.get(i + 1), north.get(j + 1)) {
                (Some(below), Some(above)) => below <= above,
                (below, _) => below.is_some(),
            };
            let begins = i == 0 && j == 0;
            if goes_south {
                let (west, east) = (south[i], south[i + 1]);
                let ends = i + 2 == south.len() && j + 1 == north.len();
                triangles.push(PlaneTriangle {
                    corners: [
                        [west, self.lat[0]],
                        [east, self.lat[0]],
                        [north[j], self.lat[1]],
                    ],
                    edges: bit(ends && east_edge, 0)
                        | bit(begins && west_edge, 1)
                        | bit(is_edge(0, west, east), 2),
                });
                i += 1;
            } else {
                let (west, east) = (north[j], north[j + 1]);
                let ends = j + 2 == north.len() && i + 1 == south.len();
                triangles.push(PlaneTriangle {
                    corners: [
                        [east, self.lat[1]],
                        [west, self.lat[1]],
                        [south[i], self.lat[0]],
                    ],
                    edges: bit(begins && west_edge, 0)
                        | bit(ends && east_edge, 1)
                        | bit(is_edge(1, west, east), 2),
                });
                j += 1;
            }
        }
        triangles
    }
}

/// Those of a row's runs that reach into an interval.
fn touching(runs: &[Run], west: f64, east: f64) -> &[Run] {
    let first = runs.partition_point(|run| run.east <= west);
    let runs = &runs[first..];
    &runs[..runs.partition_point(|run| run.west <= east)]
}

/// The meridians of a run's corners on a parallel: its own ends, in between those of the runs on both sides of the parallel, and enough others
/// that no edge along it is longer than a step. All are the same for the runs beside it.
fn corners(run: Run, beside: &[Run], lat: f64, step_rad: f64) -> Vec<f64> {
    let inside = |lon: &f64| run.west + SAME_RAD < *lon && *lon < run.east - SAME_RAD;
    let ends = beside.iter().flat_map(|other| [other.west, other.east]);
    let mut corners: Vec<f64> = ends.filter(inside).collect();
    // As an arc counts for a step.
    let around = (TAU * lat.cos().max(0.0).sqrt() / step_rad).ceil().max(1.0);
    let apart = TAU / around;
    let (first, last) = ((run.west / apart).ceil(), (run.east / apart).floor());
    let regular = (0..=(last - first).max(0.0) as usize).map(|index| first + index as f64);
    let regular = regular.map(|number| on_grid(number * apart));
    corners.extend(regular.filter(inside));
    corners.extend([run.west, run.east]);
    corners.sort_unstable_by(f64::total_cmp);
    corners.dedup_by(|later, earlier| (*later - *earlier).abs() < SAME_RAD);
    corners
}

fn on_grid(lon_rad: f64) -> f64 {
    (lon_rad / GRID_RAD).round() * GRID_RAD
}

#[cfg(test)]
#[path = "rows_tests.rs"]
mod tests;
