//! The samples of a tile: from the files, or means of finer tiles where those are.

use super::budget::KEPT_A_THREAD;
use super::files::{HeightFiles, View};
use crate::BuildError;
use crate::folder::BuildFolder;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::{Arc, Mutex, PoisonError};
use terrella_ground::elevation::Bounds;
use terrella_imagery::pack::{
    HeightKind, HeightPlace, HeightRecord, HeightValues, HeightsEntry, decode_heights,
};

/// Where the samples of a tile come from, kept from one to the next.
#[derive(Default)]
struct SampleSource<'a> {
    /// The finer tile that was looked at last.
    finer: Option<(HeightPlace, Option<Arc<HeightValues>>)>,
    /// The files about the tile, so many columns farther east.
    view: Option<(i64, View<'a>)>,
}

/// Makes the tiles of a level.
pub(super) struct TileMaker<'a> {
    files: &'a HeightFiles,
    pub entry: &'a HeightsEntry,
    pub folder: &'a BuildFolder<'a>,
    /// The last used at the end.
    kept: Mutex<Vec<(HeightPlace, Arc<HeightValues>)>>,
    most_kept: usize,
}

impl<'a> TileMaker<'a> {
    pub(super) fn new(
        files: &'a HeightFiles,
        entry: &'a HeightsEntry,
        folder: &'a BuildFolder<'a>,
        threads: usize,
    ) -> Self {
        Self {
            files,
            entry,
            folder,
            kept: Mutex::new(Vec::new()),
            most_kept: KEPT_A_THREAD * threads,
        }
    }

    /// The tiles of the next finer level in a tile's ground.
    pub(super) fn beneath(&self, place: HeightPlace) -> impl Iterator<Item = HeightRecord> + '_ {
        let level = place.level.checked_sub(1);
        let quarters = level.into_iter().flat_map(move |level| {
            (0..4).map(move |quarter| HeightPlace {
                level,
                row: 2 * place.row + quarter / 2,
                column: 2 * place.column + quarter % 2,
            })
        });
        quarters.filter_map(|place| self.folder.height(place))
    }

    /// All samples of a tile, its border included. A sample depends only on its position: neighbours agree to the last bit.
    pub(super) fn tile(&self, place: HeightPlace) -> Result<HeightValues, BuildError> {
        let entry = self.entry;
        let (side, border) = (i64::from(entry.side), i64::from(entry.border));
        let round = i64::from(entry.round(place.level));
        let mut source = SampleSource::default();
        let mut metres = Vec::with_capacity(entry.tile_samples());
        for y in -border..side + border {
            let row = i64::from(place.row) * side + y;
            // Beyond a pole, on the opposite meridian.
            let (row, turn) = match row {
                ..0 => (-1 - row, round / 2),
                row if row >= round / 2 => (round - 1 - row, round / 2),
                row => (row, 0),
            };
            for x in -border..side + border {
                let column = i64::from(place.column) * side + x + turn;
                // 0…2^30.
                let at = (row as u32, column.rem_euclid(round) as u32);
                metres.push(self.sample_m(place, at, turn, &mut source)?);
            }
        }
        Ok(match entry.kind {
            HeightKind::I16 { offset_m, scale_m } => {
                // `as` saturates.
                let step = |metres: &f64| ((metres - offset_m) / scale_m).round() as i16;
                HeightValues::I16(metres.iter().map(step).collect())
            }
            HeightKind::F32 => {
                HeightValues::F32(metres.iter().map(|metres| *metres as f32).collect())
            }
        })
    }

    /// The sample in a row and column of the level of `place`, whose tile is being made: of its own rows, `turn` columns farther east.
    fn sample_m(
        &self,
        place: HeightPlace,
        (row, column): (u32, u32),
        turn: i64,
        source: &mut SampleSource<'a>,
    ) -> Result<f64, BuildError> {
        let side = self.entry.side;
        if let Some(level) = place.level.checked_sub(1) {
            let finer = HeightPlace {
                level,
                row: 2 * row / side,
                column: 2 * column / side,
            };
            if source.finer.as_ref().is_none_or(|(at, _)| *at != finer) {
                source.finer = Some((finer, self.finer(finer)?));
            }
            if let Some((_, Some(values))) = &source.finer {
                let own = |at: u32| (2 * at % side + self.entry.border) as usize;
                return Ok(self.mean_m(values, own(row), own(column)));
            }
        }
        let spacing_rad = TAU / f64::from(self.entry.round(place.level));
        let lat_rad = FRAC_PI_2 - (f64::from(row) + 0.5) * spacing_rad;
        let lon_rad = -PI + (f64::from(column) + 0.5) * spacing_rad;
        let view = match &mut source.view {
            Some((of_turn, view)) if *of_turn == turn => view,
            _ => {
                // One at a time in memory.
                source.view = None;
                let view = self.files.view(&self.bounds(place, turn), spacing_rad)?;
                &mut source.view.insert((turn, view)).1
            }
        };
        Ok(view.height_m(lat_rad, lon_rad))
    }

    /// Bounds of the samples of a tile and its border, this many columns farther east.
    fn bounds(&self, place: HeightPlace, turn: i64) -> Bounds {
        let spacing_rad = TAU / f64::from(self.entry.round(place.level));
        let (side, border) = (f64::from(self.entry.side), f64::from(self.entry.border));
        let first = |tile: u32| f64::from(tile) * side - border;
        let across_rad = (side + 2.0 * border) * spacing_rad;
        let north_rad = FRAC_PI_2 - first(place.row) * spacing_rad;
        Bounds {
            south_rad: (north_rad - across_rad).max(-FRAC_PI_2),
            north_rad: north_rad.min(FRAC_PI_2),
            west_rad: (first(place.column) + turn as f64) * spacing_rad - PI,
            width_rad: across_rad,
        }
    }

    /// The mean of four samples, metres: of this row and column and the next.
    fn mean_m(&self, values: &HeightValues, row: usize, column: usize) -> f64 {
        let width = self.entry.row_samples();
        let first = row * width + column;
        let four = [first, first + 1, first + width, first + width + 1];
        match (values, self.entry.kind) {
            (HeightValues::I16(steps), HeightKind::I16 { offset_m, scale_m }) => {
                let sum: i32 = four.iter().map(|n| i32::from(steps[*n])).sum();
                offset_m + scale_m * (0.25 * f64::from(sum))
            }
            (HeightValues::I16(steps), HeightKind::F32) => {
                0.25 * four.iter().map(|n| f64::from(steps[*n])).sum::<f64>()
            }
            (HeightValues::F32(metres), _) => {
                0.25 * four.iter().map(|n| f64::from(metres[*n])).sum::<f64>()
            }
        }
    }

    /// A tile of the next finer level, if there is one.
    fn finer(&self, place: HeightPlace) -> Result<Option<Arc<HeightValues>>, BuildError> {
        let Some(record) = self.folder.height(place) else {
            return Ok(None);
        };
        let kept = || self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        {
            let mut kept = kept();
            if let Some(at) = kept.iter().rposition(|(of, _)| *of == place) {
                let found = kept.remove(at);
                let values = Arc::clone(&found.1);
                kept.push(found);
                return Ok(Some(values));
            }
        }
        let bytes = self.folder.read_height(self.entry, &record)?;
        let values = decode_heights(&bytes, self.entry).map_err(|cause| BuildError::Damaged {
            path: self.entry.path(place),
            cause,
        })?;
        let values = Arc::new(values);
        let mut kept = kept();
        if kept.len() >= self.most_kept {
            kept.remove(0);
        }
        kept.push((place, Arc::clone(&values)));
        Ok(Some(values))
    }
}
