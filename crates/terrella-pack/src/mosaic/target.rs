//! The grid that a mosaic is made on: rows and columns of equal degrees.

use super::axis::{Axis, Tap};
use super::place::{Bounds, RasterPlacement};
use crate::source::MAX_SOURCE_HEIGHT;

/// Grid of latitudes and longitudes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Longitude of the west edge, degrees.
    pub west_deg: f64,
    /// Latitude of the north edge, degrees.
    pub north_deg: f64,
    /// Size of a texel, degrees.
    pub texel_deg: f64,
    /// Texels from west to east.
    pub columns: u32,
    /// Texels from north to south.
    pub rows: u32,
}

/// A run of the target's columns, and the sources of each.
pub(super) struct Span {
    /// First column of the target.
    pub first: usize,
    /// Sources of the columns.
    pub taps: Vec<Tap>,
    /// All are single texels that follow each other, from this one.
    pub is_same_from: Option<u32>,
}

impl Target {
    /// The whole Earth, `columns` texels round, an even number.
    pub fn earth(columns: u32) -> Self {
        Self {
            west_deg: -180.0,
            north_deg: 90.0,
            texel_deg: 360.0 / f64::from(columns),
            columns,
            rows: columns / 2,
        }
    }

    /// The whole Earth, about as fine as these texels.
    pub(super) fn earth_of(texel_deg: f64) -> Self {
        let rows = (180.0 / texel_deg)
            .round()
            .clamp(16.0, f64::from(MAX_SOURCE_HEIGHT));
        // In range.
        Self::earth(2 * rows as u32)
    }

    /// These bounds, made larger to whole texels from 180° W and 90° N.
    pub(super) fn part(bounds: &Bounds, texel_deg: f64) -> Self {
        let west = ((bounds.west_deg + 180.0) / texel_deg + 1e-6).floor();
        let east = ((bounds.east_deg + 180.0) / texel_deg - 1e-6).ceil();
        let north = ((90.0 - bounds.north_deg) / texel_deg + 1e-6).floor();
        let south = ((90.0 - bounds.south_deg) / texel_deg - 1e-6).ceil();
        // Saturates far beyond what is allowed, which is checked by the caller.
        Self {
            west_deg: west * texel_deg - 180.0,
            north_deg: 90.0 - north * texel_deg,
            texel_deg,
            columns: (east - west) as u32,
            rows: (south - north) as u32,
        }
    }

    /// Latitude of the upper edge of a row, degrees.
    pub(super) fn latitude_deg(&self, row: u32) -> f64 {
        self.north_deg - f64::from(row) * self.texel_deg
    }

    /// Columns that a raster of so many texels reaches.
    pub(super) fn spans(&self, place: &RasterPlacement, columns: u32) -> Vec<Span> {
        let width_deg = place.width_deg(columns);
        let axis = Axis {
            size: columns,
            is_round: (width_deg - 360.0).abs() < 0.5 * place.column_deg,
        };
        let east_deg = f64::from(self.columns) * self.texel_deg;
        let offset_deg = (place.west_deg - self.west_deg + 1e-9).rem_euclid(360.0) - 1e-9;
        let turns: &[f64] = if axis.is_round {
            &[0.0]
        } else {
            &[-360.0, 0.0]
        };
        let mut spans = Vec::new();
        for turn in turns {
            let (start, end) = if axis.is_round {
                (0.0, east_deg)
            } else {
                (offset_deg + turn, offset_deg + turn + width_deg)
            };
            // Texels that are covered by a thousandth do not count.
            let first = (start.max(0.0) / self.texel_deg + 1e-3).floor();
            let last = (end.min(east_deg) / self.texel_deg - 1e-3).ceil();
            if last <= first {
                continue;
            }
            // Within the target's columns.
            let taps: Vec<Tap> = (first as u32..last as u32)
                .map(|column| {
                    let from_deg = f64::from(column) * self.texel_deg - offset_deg - turn;
                    let from = from_deg / place.column_deg;
                    axis.tap(from, from + self.texel_deg / place.column_deg)
                })
                .collect();
            let single = taps.first().and_then(Tap::single);
            let is_same = single.is_some_and(|texel| {
                taps.iter()
                    .zip(texel..)
                    .all(|(tap, texel)| tap.single() == Some(texel))
            });
            spans.push(Span {
                first: first as usize,
                is_same_from: single.filter(|_| is_same),
                taps,
            });
        }
        spans
    }

    /// Source of a row in a raster with this many rows.
    pub(super) fn row_tap(&self, place: &RasterPlacement, rows: u32, row: u32) -> Tap {
        let axis = Axis {
            size: rows,
            is_round: false,
        };
        let at = |row: u32| {
            (place.north_deg - place.crs.northing_deg(self.latitude_deg(row))) / place.row_deg
        };
        axis.tap(at(row), at(row + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mosaic::place::Crs;

    fn place(west: f64, east: f64, columns: u32) -> RasterPlacement {
        let bounds = Bounds::new([west, -90.0, east, 90.0]).expect("good");
        RasterPlacement::from_bounds(Crs::Geographic, &bounds, (columns, 8))
    }

    fn columns(spans: &[Span]) -> Vec<(usize, usize)> {
        spans
            .iter()
            .map(|span| (span.first, span.taps.len()))
            .collect()
    }

    #[test]
    fn rasters_lie_where_they_are_placed() {
        let earth = Target::earth(16);
        let spans = earth.spans(&place(-180.0, 180.0, 16), 16);
        assert_eq!(
            (columns(&spans), spans[0].is_same_from),
            (vec![(0, 16)], Some(0))
        );
        // A quarter, from its first texel.
        let spans = earth.spans(&place(0.0, 90.0, 4), 4);
        assert_eq!(
            (columns(&spans), spans[0].is_same_from),
            (vec![(8, 4)], Some(0))
        );
        // Across the date line: its west part is at the target's east end.
        let spans = earth.spans(&place(135.0, -135.0, 4), 4);
        assert_eq!(columns(&spans), [(0, 2), (14, 2)]);
        assert_eq!(
            (spans[0].is_same_from, spans[1].is_same_from),
            (Some(2), Some(0))
        );
        // From 0° to 360°: round the Earth, half a turn on, and at the seam not in one run.
        let spans = earth.spans(&place(0.0, 360.0, 16), 16);
        assert_eq!(
            (columns(&spans), spans[0].is_same_from),
            (vec![(0, 16)], None)
        );
        assert_eq!(
            (spans[0].taps[0].single(), spans[0].taps[8].single()),
            (Some(8), Some(0))
        );
    }

    #[test]
    fn parts_are_whole_texels() {
        let bounds = Bounds::new([10.1, -20.0, 11.9, -18.2]).expect("good");
        let part = Target::part(&bounds, 0.5);
        assert_eq!(
            (part.west_deg, part.north_deg, part.columns, part.rows),
            (10.0, -18.0, 4, 4)
        );
        let exact = Target::part(&Bounds::EARTH, 22.5);
        assert_eq!(exact, Target::earth(16));
    }

    #[test]
    fn rows_of_web_mercator_are_narrower_towards_the_poles() {
        let earth = Target::earth(256);
        let bounds = Bounds::new([-180.0, -85.051_128_779_806_59, 180.0, 85.051_128_779_806_59]);
        let place =
            RasterPlacement::from_bounds(Crs::WebMercator, &bounds.expect("good"), (256, 256));
        let texels = |row| match earth.row_tap(&place, 256, row) {
            Tap::Mean(_, parts) => parts.len(),
            Tap::Cubic(..) => 1,
            Tap::Outside => 0,
        };
        // Rows of 1.41 degrees; at 80° a degree of latitude is 1/cos 80° = 5.8 of northing.
        assert_eq!((texels(0), texels(64), texels(127)), (0, 1, 0));
        assert!((6..=8).contains(&texels(7)), "{}", texels(7));
    }
}
