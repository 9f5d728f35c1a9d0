//! Texels of a TIFF without data: GDAL's no-data value, an internal mask, and omitted strips and tiles.

use super::super::sample::sample;
use super::super::{FileContext, SampleKind};
use super::decode_error;
use crate::error::BuildError;
use std::io::{Read, Seek};
use terrella_ground::elevation::tiff_gaps::{TiffGapError, TiffMask, absent_chunks};
use tiff::TiffError;
use tiff::decoder::Decoder;
use tiff::tags::Tag;

/// Sources of missing texels.
pub(super) struct Gaps {
    no_data: Option<f32>,
    absent: Option<Vec<bool>>,
    mask: Option<TiffMask>,
    /// Which texels of the last row exist.
    pub is_there: Vec<bool>,
}

impl Gaps {
    pub fn find<R: Read + Seek>(
        decoder: &mut Decoder<R>,
        size: (u32, u32),
        context: &FileContext,
    ) -> Result<Self, BuildError> {
        let absent = absent_chunks(decoder).map_err(|error| gap_error(context, error))?;
        let mask = TiffMask::find(decoder, size).map_err(|error| gap_error(context, error))?;
        Ok(Self {
            no_data: no_data(decoder, context)?,
            absent,
            mask,
            is_there: vec![true; size.0 as usize],
        })
    }

    /// Whether any texel may be missing.
    pub fn are_possible(&self) -> bool {
        self.no_data.is_some() || self.absent.is_some() || self.mask.is_some()
    }

    pub fn working_bytes(&self, chunk_rows: u32) -> u64 {
        let mask = self.mask.as_ref();
        let absent = self.absent.as_ref().map_or(0, Vec::len);
        mask.map_or(0, |mask| mask.working_bytes(chunk_rows as usize))
            + (absent + self.is_there.len()) as u64
    }

    pub fn is_absent(&self, chunk: u32) -> bool {
        let absent = self.absent.as_ref().and_then(|all| all.get(chunk as usize));
        absent.is_some_and(|absent| *absent)
    }

    /// Evaluates a row of texels. Chunks start at `first_chunk` and contribute `columns` texels each.
    pub fn look<R: Read + Seek>(
        &mut self,
        decoder: &mut Decoder<R>,
        row: u32,
        (first_chunk, columns): (u32, u32),
        context: &FileContext,
    ) -> Result<(), BuildError> {
        self.is_there.fill(true);
        if let Some(mask) = &mut self.mask {
            mask.forget_above(row as usize);
            mask.row(decoder, row as usize, 0, &mut self.is_there)
                .map_err(|error| gap_error(context, error))?;
        }
        if self.absent.is_some() {
            for n in 0..self.is_there.len().div_ceil(columns as usize) {
                // At most the number of columns.
                if self.is_absent(first_chunk + n as u32) {
                    let start = n * columns as usize;
                    let end = self.is_there.len().min(start + columns as usize);
                    self.is_there[start..end].fill(false);
                }
            }
        }
        Ok(())
    }

    /// Removes texels whose colours all equal the no-data value.
    pub fn take_no_data(
        &mut self,
        kind: SampleKind,
        stored: &[u8],
        channels: usize,
        colours: usize,
    ) {
        let Some(no_data) = self.no_data else {
            return;
        };
        let is_nothing = |value: f32| value == no_data || (value.is_nan() && no_data.is_nan());
        for (x, is_there) in self.is_there.iter_mut().enumerate() {
            *is_there &= !(0..colours).all(|n| is_nothing(sample(kind, stored, x * channels + n)));
        }
    }
}

/// The no-data value.
fn no_data<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    context: &FileContext,
) -> Result<Option<f32>, BuildError> {
    let found = decoder.find_tag(Tag::GdalNodata);
    let Some(found) = found.map_err(|error| decode_error(context, error))? else {
        return Ok(None);
    };
    let text = found
        .into_string()
        .map_err(|error| decode_error(context, error))?;
    let number = text.trim_matches(['\0', ' ', '\n']).parse::<f64>();
    match number {
        // Samples have at most 32 bits.
        Ok(number) => Ok(Some(number as f32)),
        Err(_) => {
            let shown: String = text.chars().take(40).collect();
            Err(context.rejected(
                format!("has the no-data value {shown:?}, which is no number"),
                "correct it (`gdal_edit.py -a_nodata 0`) or take it away (`gdal_edit.py -unsetnodata`)",
            ))
        }
    }
}

fn gap_error(context: &FileContext, error: TiffGapError) -> BuildError {
    let rejected = |cause: String| {
        context.rejected(
            format!("has {cause}"),
            "write what it masks as alpha (`gdalwarp -dstalpha IN OUT`)",
        )
    };
    match error {
        TiffGapError::Tiff(TiffError::UnsupportedError(error)) => {
            rejected(format!("a mask that is not read ({error})"))
        }
        TiffGapError::Tiff(error) => decode_error(context, error),
        TiffGapError::Damaged(cause) => context.damaged(cause),
        TiffGapError::Mask(cause) => rejected(cause),
    }
}
