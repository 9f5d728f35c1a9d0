//! Maps that are held whole, because their rows are no rows of a mosaic: those that run from south to north, and projected ones.

use crate::error::BuildError;
use crate::source::{
    FileContext, Opacity, RowSource, SampleKind, SourceInfo, SourceLimits, sample,
};
use rayon::prelude::*;
use terrella_ground::elevation::warp::Warp;
use terrella_imagery::srgb::{LINEAR_FROM_SRGB, SrgbEncoder};

/// Transformation of a file's rows to those of its position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Turn {
    /// They are its rows.
    None,
    /// The southern one comes first.
    SouthFirst,
    Warped(Warp),
}

/// Texels of a row that are not divided among processors: fewer take less time than that.
const PARALLEL_TEXELS: usize = 256;

/// A map that is held.
struct HeldRows {
    inner: Box<dyn RowSource>,
    stored: SourceInfo,
    info: SourceInfo,
    turn: Turn,
    /// Texels are a code of something: they are not mixed.
    is_code: bool,
    texels: Vec<u8>,
    encoder: SrgbEncoder,
    given: u32,
}

impl Turn {
    /// Turns the rows of a map.
    pub(super) fn of(
        self,
        inner: Box<dyn RowSource>,
        is_code: bool,
        context: &FileContext,
        limits: SourceLimits,
    ) -> Result<Box<dyn RowSource>, BuildError> {
        if self == Self::None {
            return Ok(inner);
        }
        let stored = inner.info();
        let mut info = stored;
        info.buffer_bytes = info
            .buffer_bytes
            .saturating_add(stored.row_bytes() as u64 * u64::from(stored.height));
        if info.buffer_bytes > limits.buffer_bytes {
            return Err(context.too_large(
                "to turn or warp it",
                info.buffer_bytes,
                limits,
                "warp it (`gdalwarp -t_srs EPSG:4326`) or allow more --memory",
            ));
        }
        if let Self::Warped(warp) = &self {
            (info.width, info.height) = (warp.place.columns, warp.place.rows);
            if info.opacity.is_none() {
                info.channels += 1;
                info.opacity = Some(Opacity::Mask);
            }
        }
        Ok(Box::new(HeldRows {
            inner,
            stored,
            info,
            turn: self,
            is_code,
            texels: Vec::new(),
            encoder: SrgbEncoder::new(),
            given: 0,
        }))
    }
}

impl HeldRows {
    /// Reads all rows, once.
    fn hold(&mut self) -> Result<(), BuildError> {
        if !self.texels.is_empty() {
            return Ok(());
        }
        let row_bytes = self.stored.row_bytes();
        // Within the limit for buffers.
        self.texels = vec![0; row_bytes * self.stored.height as usize];
        let rows = self.texels.chunks_exact_mut(row_bytes);
        rows.into_iter()
            .try_for_each(|row| self.inner.next_row(row))
    }

    /// A row of positions between the projected texels; empty where there are none.
    fn warped(&self, warp: &Warp, row: &mut [u8]) {
        let (stored, held, encoder, is_code) =
            (self.stored, &self.texels, &self.encoder, self.is_code);
        let size = stored.sample.bytes();
        let texel = stored.channels * size;
        let at = |row: usize, column: usize| {
            &held[(row * stored.width as usize + column) * texel..][..texel]
        };
        let is_there = |texel: &[u8]| match stored.opacity {
            Some(_) => texel[texel.len() - size..].iter().any(|byte| *byte != 0),
            None => true,
        };
        let out_bytes = self.info.channels * size;
        let mut places = Vec::new();
        warp.locate_row(self.given, &mut places);
        let texels = row.par_chunks_exact_mut(out_bytes).zip(&places);
        texels
            .with_min_len(PARALLEL_TEXELS)
            .for_each(|(out, place)| {
                out.fill(0);
                let Some((row, column)) = *place else {
                    return;
                };
                // Two rows and columns at least, of which these are no last ones.
                let (top, left) = (
                    (row as usize).min(stored.height as usize - 2),
                    (column as usize).min(stored.width as usize - 2),
                );
                let (down, right) = (row - top as f64, column - left as f64);
                let four = [
                    at(top, left),
                    at(top, left + 1),
                    at(top + 1, left),
                    at(top + 1, left + 1),
                ];
                let nearest = four[2 * usize::from(down > 0.5) + usize::from(right > 0.5)];
                if !is_there(nearest) {
                    return;
                }
                out[..texel].copy_from_slice(nearest);
                if stored.opacity.is_none() {
                    match stored.sample {
                        SampleKind::F32 => out[texel..].copy_from_slice(&1f32.to_ne_bytes()),
                        _ => out[texel..].fill(0xFF),
                    }
                }
                if !is_code && four.iter().all(|texel| is_there(texel)) {
                    let parts = [
                        (1.0 - down) * (1.0 - right),
                        (1.0 - down) * right,
                        down * (1.0 - right),
                        down * right,
                    ];
                    mix(
                        &stored,
                        encoder,
                        four,
                        parts.map(|part| part as f32),
                        &mut out[..texel],
                    );
                }
            });
    }
}

/// Mixes four texels: colours of 8 bits as light, other numbers as they are.
fn mix(
    stored: &SourceInfo,
    encoder: &SrgbEncoder,
    four: [&[u8]; 4],
    parts: [f32; 4],
    out: &mut [u8],
) {
    let (kind, size) = (stored.sample, stored.sample.bytes());
    let is_light = kind == SampleKind::U8 && stored.channels >= 3;
    for (channel, out) in out.chunks_exact_mut(size).enumerate() {
        let is_light = is_light && channel < 3;
        let values = four.map(|texel| match is_light {
            true => LINEAR_FROM_SRGB[usize::from(texel[channel])],
            false => sample(kind, texel, channel),
        });
        let mixed: f32 = values
            .iter()
            .zip(parts)
            .map(|(value, part)| value * part)
            .sum();
        // `as` saturates.
        match kind {
            SampleKind::U8 if is_light => out[0] = encoder.code(mixed),
            SampleKind::U8 => out[0] = mixed.round() as u8,
            SampleKind::U16 => out.copy_from_slice(&(mixed.round() as u16).to_ne_bytes()),
            SampleKind::I16 => out.copy_from_slice(&(mixed.round() as i16).to_ne_bytes()),
            SampleKind::F32 => out.copy_from_slice(&mixed.to_ne_bytes()),
        }
    }
}

impl RowSource for HeldRows {
    fn info(&self) -> SourceInfo {
        self.info
    }

    fn colour_note(&self) -> Option<String> {
        self.inner.colour_note()
    }

    fn notes(&mut self) -> Vec<String> {
        self.inner.notes()
    }

    fn next_row(&mut self, row: &mut [u8]) -> Result<(), BuildError> {
        self.hold()?;
        match &self.turn {
            Turn::Warped(warp) => self.warped(warp, row),
            _ => {
                let row_bytes = self.stored.row_bytes();
                let from = self.stored.height.saturating_sub(self.given + 1) as usize;
                row.copy_from_slice(&self.texels[from * row_bytes..][..row_bytes]);
            }
        }
        self.given += 1;
        Ok(())
    }
}
