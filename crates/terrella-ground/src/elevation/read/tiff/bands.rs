//! Selects the height sample of a TIFF's pixels.

use super::{tiff_error, unsupported};
use crate::elevation::read::HeightFileError;
use crate::elevation::read::error::FileContext;
use std::io::{Read, Seek};
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;

/// TIFF's `SampleFormat` of unsigned integers.
const UNSIGNED: u16 = 1;

/// The samples of a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bands {
    /// Bits per sample.
    pub bits: u16,
    /// Samples per pixel.
    pub count: u16,
    /// Index of the height sample, from 0.
    pub height: u16,
    /// Index of the sample that is 0 where there is no height.
    pub alpha: Option<u16>,
    /// Whether the height sample was chosen by default among several.
    is_guessed: bool,
}

impl Bands {
    /// The bands of the current image; `wanted` counts from 1.
    pub fn of<R: Read + Seek>(
        decoder: &mut Decoder<R>,
        wanted: Option<u16>,
        context: &FileContext,
    ) -> Result<Self, HeightFileError> {
        let reported = |error| tiff_error(context, error);
        let colour = decoder.colortype().map_err(reported)?;
        let mut first = |tag, usual| {
            let found = decoder
                .find_tag_unsigned_vec::<u16>(tag)
                .map_err(reported)?;
            Ok::<_, HeightFileError>(found.unwrap_or_else(|| vec![usual]))
        };
        let format = first(Tag::SampleFormat, UNSIGNED)?;
        let count = first(Tag::SamplesPerPixel, 1)?
            .first()
            .copied()
            .unwrap_or(1);
        let bits = match colour {
            ColorType::Gray(bits)
            | ColorType::Multiband {
                bit_depth: bits, ..
            } => bits,
            // A float image has no colours.
            ColorType::RGB(bits) | ColorType::RGBA(bits) if format.first() != Some(&UNSIGNED) => {
                bits
            }
            _ => return Err(unsupported(context, "holds colours".to_string())),
        };
        if !matches!(bits, 8..=16 | 32 | 64) {
            let cause = format!("holds samples of {bits} bits");
            return Err(unsupported(context, cause));
        }
        let extra = decoder.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples);
        let extra = extra.map_err(reported)?.unwrap_or_default();
        let colours = usize::from(count).saturating_sub(extra.len());
        let alphas = (colours..)
            .zip(&extra)
            .filter(|(_, kind)| matches!(kind, 1 | 2));
        let alphas: Vec<_> = alphas.map(|(n, _)| n as u16).collect();
        let height = match wanted {
            Some(wanted) if (1..=count).contains(&wanted) => wanted - 1,
            Some(wanted) => {
                return Err(context.rejected(
                    format!("has no band {wanted}, which its sidecar names"),
                    format!("a band from 1 to {count}"),
                    "correct band in the sidecar",
                ));
            }
            None => 0,
        };
        Ok(Self {
            bits: u16::from(bits),
            count,
            height,
            alpha: alphas.iter().copied().find(|alpha| *alpha != height),
            is_guessed: wanted.is_none() && usize::from(count) > 1 + alphas.len(),
        })
    }

    /// Bytes per decoded sample.
    pub fn sample_bytes(&self) -> u64 {
        u64::from(self.bits).div_ceil(8)
    }

    /// Notice about a default choice.
    pub fn note(&self, context: &FileContext) -> Option<String> {
        self.is_guessed.then(|| {
            format!(
                "{}: has {} bands; the first is taken for heights: write band = 1, or another, in its sidecar to say so",
                context.path().display(),
                self.count
            )
        })
    }
}

/// Whether the sample at `offset` in each pixel of `stride` samples is not 0.
pub(super) fn opaque(chunk: &DecodingResult, stride: usize, offset: usize) -> Vec<bool> {
    fn of<T: Copy>(
        values: &[T],
        (stride, offset): (usize, usize),
        is_zero: impl Fn(T) -> bool,
    ) -> Vec<bool> {
        let pixels = values.chunks_exact(stride);
        let alphas = pixels.map(|pixel| pixel.get(offset).is_none_or(|alpha| !is_zero(*alpha)));
        alphas.collect()
    }
    let place = (stride, offset);
    match chunk {
        DecodingResult::U8(values) => of(values, place, |alpha| alpha == 0),
        DecodingResult::I8(values) => of(values, place, |alpha| alpha == 0),
        DecodingResult::U16(values) => of(values, place, |alpha| alpha == 0),
        DecodingResult::I16(values) => of(values, place, |alpha| alpha == 0),
        DecodingResult::U32(values) => of(values, place, |alpha| alpha == 0),
        DecodingResult::I32(values) => of(values, place, |alpha| alpha == 0),
        DecodingResult::U64(values) => of(values, place, |alpha| alpha == 0),
        DecodingResult::I64(values) => of(values, place, |alpha| alpha == 0),
        DecodingResult::F16(values) => of(values, place, |alpha| f64::from(alpha) == 0.0),
        DecodingResult::F32(values) => of(values, place, |alpha| alpha == 0.0),
        DecodingResult::F64(values) => of(values, place, |alpha| alpha == 0.0),
    }
}
