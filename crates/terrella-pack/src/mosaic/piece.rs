//! A part of a mosaic on the target's grid, a row at a time.

use super::axis::Tap;
use super::description::{Part, PartSource};
use super::georeference::place_of;
use super::held::Turn;
use super::place::RasterPlacement;
use super::raster::Raster;
use super::row::RasterRow;
use super::target::{Span, Target};
use super::texels::{Reader, TexelKind};
use super::tiles::TileRows;
use super::virtual_raster::WindowRows;
use crate::error::BuildError;
use crate::resample::cubic;
use crate::source::{Extent, FileContext, SourceInfo, SourceLimits, open_extent};
use std::collections::VecDeque;
use std::path::Path;

/// A part that has been looked at.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub part: Part,
    pub place: RasterPlacement,
    pub turn: Turn,
    pub info: SourceInfo,
    /// Difference of its colours from sRGB, according to its file.
    pub colour_note: Option<String>,
    /// Factors of its channels.
    pub gains: [f32; 3],
}

impl Piece {
    /// Looks at a part; `description` is named where a part of it is wrong.
    pub(super) fn look(
        part: &Part,
        description: &Path,
        limits: SourceLimits,
    ) -> Result<Self, BuildError> {
        let mut raster = open(part, Turn::None, description, limits)?;
        let mut info = raster.info();
        let (place, turn) = match &part.from {
            PartSource::File(path, stated) => place_of(path, *stated, (info.width, info.height))?,
            PartSource::Tiles(_, place) => (*place, Turn::None),
            PartSource::Placed(path, place, _) => {
                match place.complaint((info.width, info.height)) {
                    None => (*place, Turn::None),
                    Some(complaint) => {
                        return Err(FileContext::new(path)
                            .rejected(complaint, "make the .vrt again (`gdalbuildvrt`)"));
                    }
                }
            }
        };
        if turn != Turn::None {
            raster = open(part, turn, description, limits)?;
            info = raster.info();
        }
        if part.encoding.is_some()
            && (info.channels < 3 || info.sample != crate::source::SampleKind::U8)
        {
            return Err(FileContext::new(part.from.name()).rejected(
                "holds no heights written as 8-bit colours",
                "leave its encoding out",
            ));
        }
        Ok(Self {
            part: part.clone(),
            place,
            turn,
            info,
            colour_note: raster.colour_note(),
            gains: [1.0; 3],
        })
    }

    pub(super) fn kind(&self) -> TexelKind {
        TexelKind::of(&self.info, self.part.encoding)
    }

    /// Bytes that its rows take on a target of so many columns.
    pub(super) fn bytes(&self, target: &Target) -> u64 {
        let channels = self.kind().channels as u64 + 1;
        // Largest number of raster rows per target row, including those at 85° of Web Mercator.
        let stretch = (target.texel_deg / self.place.row_deg * 12.0).clamp(4.0, 1e6) as u64;
        let raw = 2 * self.info.row_bytes() as u64 + u64::from(self.info.width) * 4 * channels;
        self.info.buffer_bytes
            + raw
            + stretch.min(u64::from(self.info.height)) * u64::from(target.columns) * 4 * channels
    }

    /// The rows of the target that it may reach: the first and the one after the last.
    pub(super) fn rows(&self, target: &Target) -> (u32, u32) {
        let south_deg = self.place.north_deg - self.place.row_deg * f64::from(self.info.height);
        let at = |northing_deg: f64| {
            (target.north_deg - self.place.crs.latitude_deg(northing_deg)) / target.texel_deg
        };
        // Saturates at the target's edges.
        (
            (at(self.place.north_deg) - 1e-3).floor() as u32,
            ((at(south_deg) + 1e-3).ceil() as u32).min(target.rows),
        )
    }
}

fn open(
    part: &Part,
    turn: Turn,
    description: &Path,
    limits: SourceLimits,
) -> Result<Raster, BuildError> {
    match &part.from {
        PartSource::File(path, _) => {
            let rows = open_extent(path, limits, Extent::Piece)?;
            let rows = turn.of(
                rows,
                part.encoding.is_some(),
                &FileContext::new(path),
                limits,
            )?;
            Ok(Raster::file(rows, part.alpha))
        }
        PartSource::Placed(path, _, window) => {
            let rows = open_extent(path, limits, Extent::Piece)?;
            let rows = match window {
                Some(window) => Box::new(WindowRows::new(rows, *window, &FileContext::new(path))?),
                None => rows,
            };
            Ok(Raster::file(rows, part.alpha))
        }
        PartSource::Tiles(set, _) => {
            let tiles = TileRows::open(set, part.alpha, limits, description)?;
            Ok(Raster::Tiles(Box::new(tiles)))
        }
    }
}

/// A row of the raster on the target's columns: light times weight, and weight.
#[derive(Default)]
struct HeldRow {
    row: u32,
    values: Vec<f32>,
    weights: Vec<f32>,
    is_whole: bool,
}

pub(super) struct PieceRows {
    raster: Raster,
    place: RasterPlacement,
    height: u32,
    channels: usize,
    reader: Reader,
    target: Target,
    pub spans: Vec<Span>,
    columns: usize,
    /// Part of the way from an edge to full weight, by column and for the current row.
    column_feather: Option<Vec<f32>>,
    feather_deg: f64,
    latitudes_deg: (f64, f64),
    next: u32,
    raw: RasterRow,
    raw_row: Option<u32>,
    scratch: (Vec<f32>, Vec<f32>),
    held: VecDeque<HeldRow>,
    /// Rows to be used again.
    spare: Vec<HeldRow>,
    /// Light times weight and weight of the row that was made last.
    pub values: Vec<f32>,
    pub weights: Vec<f32>,
}

impl PieceRows {
    /// Opens the piece for texels of this kind.
    pub(super) fn open(
        piece: &Piece,
        target: &Target,
        kind: TexelKind,
        description: &Path,
        limits: SourceLimits,
    ) -> Result<Self, BuildError> {
        let raster = open(&piece.part, piece.turn, description, limits)?;
        let info = raster.info();
        if info != piece.info {
            return Err(FileContext::new(piece.part.from.name())
                .damaged("it has changed while it was read"));
        }
        let spans = target.spans(&piece.place, info.width);
        let columns = spans.iter().map(|span| span.taps.len()).sum();
        let from = TexelKind {
            channels: if info.channels >= 3 { 3 } else { 1 },
            sample: info.sample,
        };
        let place = piece.place;
        let south_deg = place.north_deg - place.row_deg * f64::from(info.height);
        Ok(Self {
            raster,
            place,
            height: info.height,
            channels: kind.channels,
            reader: Reader::new(
                from,
                kind,
                piece.part.encoding,
                piece.part.no_data.as_deref(),
                piece.gains,
            ),
            target: *target,
            column_feather: column_feather(piece, target, &spans),
            feather_deg: piece.part.feather_deg,
            latitudes_deg: (
                place.crs.latitude_deg(place.north_deg),
                place.crs.latitude_deg(south_deg),
            ),
            spans,
            columns,
            next: 0,
            raw: RasterRow::default(),
            raw_row: None,
            scratch: (
                vec![0.0; info.width as usize * kind.channels],
                vec![0.0; info.width as usize],
            ),
            held: VecDeque::new(),
            spare: Vec::new(),
            values: vec![0.0; columns * kind.channels],
            weights: vec![0.0; columns],
        })
    }

    /// Whether every column of the target is one of its own, at full weight wherever there is a texel.
    pub(super) fn covers_all(&self) -> bool {
        self.columns == self.target.columns as usize
            && self.column_feather.is_none()
            && self.spans.iter().all(is_covered)
    }

    /// The texels of the raster's row that equals a row of the target, if it does without modification: spans give their columns.
    pub(super) fn plain(&mut self, row: u32) -> Result<Option<&[u8]>, BuildError> {
        let is_same = self.spans.iter().all(|span| span.is_same_from.is_some());
        if !is_same
            || self.column_feather.is_some()
            || !self.reader.is_plain()
            || self.row_feather(row) < 1.0
        {
            return Ok(None);
        }
        let tap = self.target.row_tap(&self.place, self.height, row);
        let Some(texel) = tap.single() else {
            return Ok(None);
        };
        if texel < self.next && self.raw_row != Some(texel) {
            return Ok(None);
        }
        self.read(texel)?;
        Ok(self.raw.is_whole.then_some(self.raw.bytes.as_slice()))
    }

    /// Reads on until row `row` of the raster is at hand.
    fn read(&mut self, row: u32) -> Result<(), BuildError> {
        if self.raw_row == Some(row) {
            return Ok(());
        }
        debug_assert!(row >= self.next, "rows are asked for in their order");
        if row > self.next {
            self.raster.skip(row - self.next)?;
            self.next = row;
        }
        self.raw_row = None;
        self.raster.next_row(&mut self.raw)?;
        self.raw_row = Some(row);
        self.next = row + 1;
        Ok(())
    }

    /// Computes a row of the target. Returns false if it has no source.
    pub(super) fn row(&mut self, row: u32) -> Result<bool, BuildError> {
        let tap = self.target.row_tap(&self.place, self.height, row);
        let feather = self.row_feather(row);
        let Some((first, last)) = tap.span().filter(|_| feather > 0.0) else {
            return Ok(false);
        };
        while self.held.front().is_some_and(|held| held.row < first) {
            self.spare.extend(self.held.pop_front());
        }
        let from = self
            .held
            .back()
            .map_or(first, |held| held.row + 1)
            .max(first);
        for row in from..=last {
            self.hold(row)?;
        }
        let Some(origin) = self.held.front().map(|held| held.row) else {
            return Ok(false);
        };
        debug_assert_eq!(origin, first, "rows are asked for in their order");
        self.values.fill(0.0);
        self.weights.fill(0.0);
        match &tap {
            Tap::Mean(first, parts) => {
                for (held, part) in self.held.iter().skip((first - origin) as usize).zip(parts) {
                    add(&mut self.values, &held.values, *part);
                    add(&mut self.weights, &held.weights, *part);
                }
            }
            Tap::Cubic(rows, t) => {
                let held = rows.map(|row| &self.held[(row - origin) as usize]);
                if held.iter().all(|held| held.is_whole) {
                    for (x, value) in self.values.iter_mut().enumerate() {
                        *value = cubic(held.map(|held| held.values[x]), *t);
                    }
                    self.weights.fill(1.0);
                } else {
                    for (held, part) in [(held[1], 1.0 - t), (held[2], *t)] {
                        add(&mut self.values, &held.values, part);
                        add(&mut self.weights, &held.weights, part);
                    }
                }
            }
            Tap::Outside => return Ok(false),
        }
        self.feather(feather);
        Ok(true)
    }

    fn feather(&mut self, row: f32) {
        if row == 1.0 && self.column_feather.is_none() {
            return;
        }
        let texels = self
            .values
            .chunks_exact_mut(self.channels)
            .zip(&mut self.weights);
        for (x, (texel, weight)) in texels.enumerate() {
            let part = row * self.column_feather.as_ref().map_or(1.0, |parts| parts[x]);
            *weight *= part;
            for value in texel {
                *value *= part;
            }
        }
    }

    /// How much of a row counts by its distance from the north and south edges. The poles are no edges.
    fn row_feather(&self, row: u32) -> f32 {
        if self.feather_deg == 0.0 {
            return 1.0;
        }
        let latitude_deg = self.target.latitude_deg(row) - 0.5 * self.target.texel_deg;
        let (north_deg, south_deg) = self.latitudes_deg;
        let at_pole = 90.0 - self.target.texel_deg;
        let north = if north_deg >= at_pole {
            f64::INFINITY
        } else {
            north_deg - latitude_deg
        };
        let south = if south_deg <= -at_pole {
            f64::INFINITY
        } else {
            latitude_deg - south_deg
        };
        (north.min(south) / self.feather_deg).clamp(0.0, 1.0) as f32
    }

    /// Reads row `row` of the raster and keeps it on the target's columns.
    fn hold(&mut self, row: u32) -> Result<(), BuildError> {
        self.read(row)?;
        let (values, weights) = (&mut self.scratch.0, &mut self.scratch.1);
        self.reader
            .read(&self.raw.bytes, &self.raw.cover, values, weights);
        let channels = self.channels;
        let is_whole = self.raw.is_whole && weights.iter().all(|weight| *weight == 1.0);
        let mut held = self.spare.pop().unwrap_or_default();
        (held.row, held.is_whole) = (row, is_whole);
        held.values.clear();
        held.values.resize(self.columns * channels, 0.0);
        held.weights.clear();
        held.weights.resize(self.columns, 0.0);
        let mut at = 0;
        for span in &self.spans {
            let end = at + span.taps.len();
            let out = (
                &mut held.values[at * channels..end * channels],
                &mut held.weights[at..end],
            );
            if let Some(first) = span.is_same_from {
                let texels = first as usize..first as usize + span.taps.len();
                out.0
                    .copy_from_slice(&values[texels.start * channels..texels.end * channels]);
                out.1.copy_from_slice(&weights[texels]);
                if !is_whole {
                    for (texel, weight) in out.0.chunks_exact_mut(channels).zip(out.1.iter()) {
                        texel.iter_mut().for_each(|value| *value *= weight);
                    }
                }
            } else {
                apply(&span.taps, (values, weights), out, channels, is_whole);
            }
            held.is_whole &= self.spans.len() == 1 && is_covered(span);
            at = end;
        }
        self.held.push_back(held);
        Ok(())
    }

    /// Remarks about omitted parts since the last call.
    pub(super) fn notes(&mut self) -> Vec<String> {
        self.raster.notes()
    }
}

/// Whether no column of a span extends beyond the raster.
fn is_covered(span: &Span) -> bool {
    let whole = |tap: &Tap| match tap {
        Tap::Mean(_, parts) => parts.iter().sum::<f32>() > 0.999,
        Tap::Cubic(..) => true,
        Tap::Outside => false,
    };
    span.is_same_from.is_some() || span.taps.iter().all(whole)
}

/// Makes the columns of one row.
fn apply(
    taps: &[Tap],
    (values, weights): (&[f32], &[f32]),
    (out, out_weights): (&mut [f32], &mut [f32]),
    channels: usize,
    is_whole: bool,
) {
    let columns = weights.len();
    let columns_out = out.chunks_exact_mut(channels).zip(out_weights);
    for (tap, (texel, weight)) in taps.iter().zip(columns_out) {
        let mut add = |column: usize, part: f32| {
            let part = part * weights[column];
            *weight += part;
            for (channel, value) in texel.iter_mut().enumerate() {
                *value += part * values[column * channels + channel];
            }
        };
        match tap {
            Tap::Mean(first, parts) => {
                for (n, part) in parts.iter().enumerate() {
                    add((*first as usize + n) % columns, *part);
                }
            }
            Tap::Cubic(texels, t) if is_whole => {
                let at = texels.map(|texel| texel as usize * channels);
                for (channel, value) in texel.iter_mut().enumerate() {
                    *value = cubic(at.map(|at| values[at + channel]), *t);
                }
                *weight = 1.0;
            }
            Tap::Cubic(texels, t) => {
                add(texels[1] as usize, 1.0 - t);
                add(texels[2] as usize, *t);
            }
            Tap::Outside => {}
        }
    }
}

fn add(sum: &mut [f32], values: &[f32], part: f32) {
    for (sum, value) in sum.iter_mut().zip(values) {
        *sum += part * value;
    }
}

/// How much of each column counts by its distance from the west and east edges; `None` if all does.
fn column_feather(piece: &Piece, target: &Target, spans: &[Span]) -> Option<Vec<f32>> {
    let feather_deg = piece.part.feather_deg;
    let width_deg = piece.place.width_deg(piece.info.width);
    if feather_deg == 0.0 || width_deg > 360.0 - 0.5 * piece.place.column_deg {
        return None;
    }
    let columns = spans
        .iter()
        .flat_map(|span| span.first..span.first + span.taps.len());
    let parts = columns.map(|column| {
        let longitude_deg = target.west_deg + (column as f64 + 0.5) * target.texel_deg;
        let west_deg = (longitude_deg - piece.place.west_deg).rem_euclid(360.0);
        let nearest_deg = west_deg.min(width_deg - west_deg);
        (nearest_deg / feather_deg).clamp(0.0, 1.0) as f32
    });
    Some(parts.collect())
}
