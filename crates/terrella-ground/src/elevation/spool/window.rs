//! A part of spooled heights in memory.

use super::store::Store;
use super::{HeightSpool, SpoolError};
use crate::elevation::Bounds;
use crate::elevation::grid::holes::{LEFT, believed, fill_row, steps_to_data};
use crate::elevation::grid::joins::Joins;
use crate::elevation::grid::levels::LevelShape;
use std::f64::consts::TAU;
use std::ops::Range;

/// Samples beyond the bounds on each side, for interpolation and rounding.
const MORE: f64 = 2.0;

/// The heights of a file inside some bounds.
pub struct HeightWindow<'a> {
    spool: &'a HeightSpool,
    /// One piece, or two if the bounds contain both ends of the rows; none if all heights are the
    /// same.
    pieces: Vec<Piece>,
    /// Whether all samples and the poles have full confidence.
    is_sure: bool,
}

impl HeightSpool {
    /// Reads the data needed for heights of places inside the bounds.
    pub fn window(&self, bounds: &Bounds) -> Result<HeightWindow<'_>, SpoolError> {
        let mut pieces = Vec::new();
        if self.uniform_m.is_none() {
            let rows = self.rows_of(bounds);
            for columns in self.columns_of(bounds) {
                pieces.push(Piece::read(self, rows.clone(), columns)?);
            }
        }
        let is_sure = pieces.iter().all(|piece| piece.believed.is_none())
            && self.poles.iter().all(|pole| pole.believed >= 255.0);
        Ok(HeightWindow {
            spool: self,
            pieces,
            is_sure,
        })
    }

    fn rows_of(&self, bounds: &Bounds) -> Range<usize> {
        let lattice = &self.place.lattice;
        let (north, _) = lattice.locate(bounds.north_rad, 0.0);
        let (south, _) = lattice.locate(bounds.south_rad, 0.0);
        // Negative numbers saturate at 0.
        let first = ((north - MORE).floor() as usize).min(lattice.rows - 1);
        let end = ((south + MORE).ceil() as usize + 1).min(lattice.rows);
        first..end.max(first + 1)
    }

    /// First column and column count of each piece. In a periodic file they may wrap to its first column.
    fn columns_of(&self, bounds: &Bounds) -> Vec<(usize, usize)> {
        let lattice = &self.place.lattice;
        let all = lattice.columns;
        let width = bounds.width_rad / lattice.lon_step_rad + 2.0 * MORE;
        if width + 2.0 >= all as f64 {
            return vec![(0, all)];
        }
        if lattice.is_periodic {
            let (_, column) = lattice.locate(0.0, bounds.west_rad);
            let first = (column - MORE).floor().rem_euclid(all as f64) as usize;
            return vec![(first.min(all - 1), width as usize + 2)];
        }
        let east_of_west = (bounds.west_rad - lattice.west_rad).rem_euclid(TAU);
        let west = east_of_west / lattice.lon_step_rad - MORE;
        let turn = TAU / lattice.lon_step_rad;
        // Once unchanged, and once 360° farther east, where the file begins again.
        let pieces = [west, west - turn].map(|west| {
            let first = west.max(0.0).floor();
            let end = (west + width).ceil().min((all - 1) as f64) + 1.0;
            (first, end)
        });
        let kept = pieces.into_iter().filter(|(first, end)| first < end);
        kept.map(|(first, end)| (first as usize, (end - first) as usize))
            .collect()
    }
}

impl HeightWindow<'_> {
    /// Height and weight at a place inside the bounds, as a grid returns at its finest spacing. No height where the weight
    /// is 0.
    #[inline]
    pub fn weighted(&self, lat_rad: f64, lon_rad: f64, joins: &Joins) -> Option<(f64, f64)> {
        let HeightSpool {
            place,
            shape,
            poles,
            uniform_m,
            ..
        } = self.spool;
        let (row, column) = place.lattice.locate(lat_rad, lon_rad);
        let mut weight = joins.inside(place, row, column);
        if weight <= 0.0 {
            return None;
        }
        if let Some(height_m) = uniform_m {
            return Some((*height_m, weight));
        }
        if !self.is_sure {
            let of_poles = [poles[0].believed, poles[1].believed];
            let of_255 = shape.interpolate(row, column, of_poles, |row, column| {
                let (piece, n) = self.at(row, column);
                let believed = piece.believed.as_ref().map(|believed| believed[n]);
                f64::from(believed.unwrap_or(255))
            });
            weight *= of_255 * (1.0 / 255.0);
        }
        let of_poles = [poles[0].height_m, poles[1].height_m];
        let height_m = || {
            shape.interpolate(row, column, of_poles, |row, column| {
                let (piece, n) = self.at(row, column);
                f64::from(piece.heights_m[n])
            })
        };
        (weight > 0.0).then(|| (height_m(), weight))
    }

    /// The piece that contains a sample, and the sample's index there.
    #[inline]
    fn at(&self, row: usize, column: usize) -> (&Piece, usize) {
        match self.pieces.as_slice() {
            [first, second] if !first.has(column) => (second, second.number(row, column)),
            pieces => (&pieces[0], pieces[0].number(row, column)),
        }
    }
}

/// Some rows of some columns.
pub(super) struct Piece {
    rows: Range<usize>,
    first_column: usize,
    columns: usize,
    all_columns: usize,
    pub heights_m: Vec<f32>,
    /// Confidence of each sample, 0…255; `None` if all have full confidence.
    pub believed: Option<Vec<u8>>,
}

impl Piece {
    /// Reads rows with filled holes and uniform poles, as in a grid.
    fn read(
        spool: &HeightSpool,
        rows: Range<usize>,
        (first_column, columns): (usize, usize),
    ) -> Result<Self, SpoolError> {
        let mut piece = Self::filled(spool, rows.clone(), first_column, columns)?;
        let outermost = [0, spool.shape.rows - 1];
        for (pole, row) in spool.poles.iter().zip(outermost) {
            if pole.is_row && rows.contains(&row) {
                let start = (row - rows.start) * columns;
                let of_row = start..start + columns;
                piece.heights_m[of_row.clone()].fill(pole.height_m as f32);
                if pole.believed < 255.0 || piece.believed.is_some() {
                    let all = piece.heights_m.len();
                    let believed = piece.believed.get_or_insert_with(|| vec![255; all]);
                    believed[of_row].fill(pole.believed as u8);
                }
            }
        }
        piece.round(spool);
        Ok(piece)
    }

    /// Reads rows with filled holes.
    pub(super) fn filled(
        spool: &HeightSpool,
        rows: Range<usize>,
        first_column: usize,
        columns: usize,
    ) -> Result<Self, SpoolError> {
        let shape = &spool.shape;
        let Some((coarse_shape, coarse_store)) = &spool.means else {
            return Self::raw(&spool.store, shape, rows, (first_column, columns));
        };
        // Data this far away still count.
        let margin = usize::from(LEFT);
        let more_rows = rows.start.saturating_sub(margin)..(rows.end + margin).min(shape.rows);
        let (west, more_columns) = match shape.is_periodic {
            _ if columns + 2 * margin >= shape.columns => (0, shape.columns),
            true => (
                (first_column + shape.columns - margin) % shape.columns,
                columns + 2 * margin,
            ),
            false => {
                let west = first_column.saturating_sub(margin);
                let east = (first_column + columns + margin).min(shape.columns);
                (west, east - west)
            }
        };
        let wide = Self::raw(&spool.store, shape, more_rows, (west, more_columns))?;
        let mut piece = Self {
            rows,
            first_column,
            columns,
            all_columns: shape.columns,
            heights_m: Vec::with_capacity(columns),
            believed: None,
        };
        piece.heights_m = piece
            .samples()
            .map(|n| wide.heights_m[wide.number(n.0, n.1)])
            .collect();
        if !piece.heights_m.iter().any(|height| height.is_nan()) {
            return Ok(piece);
        }
        let is_hole: Vec<bool> = wide.heights_m.iter().map(|h| h.is_nan()).collect();
        let is_round = shape.is_periodic && more_columns == shape.columns;
        let steps = steps_to_data(more_columns, is_round, &is_hole);
        let of_sample = |n: (usize, usize)| believed(steps[wide.number(n.0, n.1)]);
        piece.believed = Some(piece.samples().map(of_sample).collect());

        let coarse = coarse_piece(shape, coarse_shape, coarse_store, &piece)?;
        let coarser = |row, column| f64::from(coarse.heights_m[coarse.number(row, column)]);
        let first_row = piece.rows.start;
        for (n, values) in piece.heights_m.chunks_exact_mut(columns).enumerate() {
            let of_row = (first_column..first_column + columns).map(|n| n % shape.columns);
            fill_row(shape, first_row + n, of_row, values, coarse_shape, coarser);
        }
        Ok(piece)
    }

    /// Reads rows as stored.
    fn raw(
        store: &Store,
        shape: &LevelShape,
        rows: Range<usize>,
        (first_column, columns): (usize, usize),
    ) -> Result<Self, SpoolError> {
        let mut file = store.open()?;
        let mut heights_m = vec![0.0; rows.len() * columns];
        for (row, heights_m) in rows.clone().zip(heights_m.chunks_exact_mut(columns)) {
            file.read_round(row, first_column, heights_m)?;
        }
        Ok(Self {
            rows,
            first_column,
            columns,
            all_columns: shape.columns,
            heights_m,
            believed: None,
        })
    }

    /// Rounds to integer metres if the file has only those; filled holes and poles may be
    /// fractional.
    pub(super) fn round(&mut self, spool: &HeightSpool) {
        if spool.is_whole {
            for height_m in &mut self.heights_m {
                *height_m = f64::from(*height_m).round() as f32;
            }
        }
    }

    /// Rows and columns of its samples in order.
    fn samples(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (first, columns, all) = (self.first_column, self.columns, self.all_columns);
        let of_row = move |row| (first..first + columns).map(move |n| (row, n % all));
        self.rows.clone().flat_map(of_row)
    }

    #[inline]
    fn column(&self, column: usize) -> usize {
        if column >= self.first_column {
            column - self.first_column
        } else {
            column + self.all_columns - self.first_column
        }
    }

    #[inline]
    fn has(&self, column: usize) -> bool {
        self.column(column) < self.columns
    }

    #[inline]
    fn number(&self, row: usize, column: usize) -> usize {
        (row - self.rows.start) * self.columns + self.column(column)
    }
}

/// The coarser piece from which the holes of a piece are filled.
fn coarse_piece(
    shape: &LevelShape,
    coarse: &LevelShape,
    store: &Store,
    piece: &Piece,
) -> Result<Piece, SpoolError> {
    // Rows and columns of the finest level.
    let (first, last) = (piece.rows.start as f64, (piece.rows.end - 1) as f64);
    let (west, east) = (
        piece.first_column as f64,
        (piece.first_column + piece.columns - 1) as f64,
    );
    let (north, west) = coarse.own(first, west);
    let (south, east) = coarse.own(last, east);
    // Negative numbers saturate at 0.
    let rows = ((north - 1.0) as usize).min(coarse.rows - 1)
        ..((south + 2.0) as usize + 1).clamp(1, coarse.rows);
    let (first, count) = ((west - 1.0).floor(), (east - west).ceil() as usize + 4);
    let columns = match shape.is_periodic {
        _ if count >= coarse.columns => (0, coarse.columns),
        true => (
            first.rem_euclid(coarse.columns as f64) as usize % coarse.columns,
            count,
        ),
        false => {
            let first = (first as usize).min(coarse.columns - 1);
            (first, count.min(coarse.columns - first))
        }
    };
    Piece::raw(store, coarse, rows, columns)
}
