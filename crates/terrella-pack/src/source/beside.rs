//! GDAL's files beside a map: a mask in `NAME.tif.msk`, and no-data values in `NAME.tif.aux.xml`.

use super::sample::sample;
use super::{FileContext, Opacity, RowSource, SampleKind, SourceInfo};
use crate::error::BuildError;
use std::fs::File;
use std::io::{BufReader, ErrorKind};
use std::path::{Path, PathBuf};
use terrella_files as files;
use terrella_ground::elevation::aux_xml::{AUX_BYTES, no_data};
use terrella_ground::elevation::tiff_gaps::{TiffGapError, TiffMask};
use tiff::TiffError;
use tiff::decoder::Decoder;

/// Files that may accompany a map.
pub(crate) fn files_beside(path: &Path) -> [PathBuf; 2] {
    [".aux.xml", ".msk"].map(|ending| {
        let mut name = path.as_os_str().to_owned();
        name.push(ending);
        name.into()
    })
}

/// A map without the texels that its accompanying files exclude.
struct BesideRows {
    inner: Box<dyn RowSource>,
    info: SourceInfo,
    mask: Option<SideMask>,
    /// One value per colour.
    no_data: Option<Vec<f32>>,
    given: u32,
    row: Vec<u8>,
    is_there: Vec<bool>,
}

struct SideMask {
    decoder: Decoder<BufReader<File>>,
    mask: TiffMask,
    context: FileContext,
}

/// Removes the texels of a map that its accompanying files declare missing.
pub(super) fn without_gaps(
    inner: Box<dyn RowSource>,
    path: &Path,
) -> Result<Box<dyn RowSource>, BuildError> {
    let [aux, mask] = files_beside(path);
    let stored = inner.info();
    let no_data = no_data_beside(&aux, &stored)?;
    let mask = SideMask::find(&mask, &stored)?;
    if no_data.is_none() && mask.is_none() {
        return Ok(inner);
    }
    let mut info = stored;
    info.buffer_bytes += stored.row_bytes() as u64 + u64::from(stored.width);
    info.buffer_bytes += mask.as_ref().map_or(0, |mask| mask.mask.working_bytes(1));
    if info.opacity.is_none() {
        info.channels += 1;
        info.opacity = Some(Opacity::Mask);
    }
    Ok(Box::new(BesideRows {
        inner,
        info,
        mask,
        no_data,
        given: 0,
        row: vec![0; stored.row_bytes()],
        is_there: vec![true; stored.width as usize],
    }))
}

/// Number of colours of a stored texel.
fn colours(info: &SourceInfo) -> usize {
    info.channels - usize::from(info.opacity.is_some())
}

fn no_data_beside(aux: &Path, info: &SourceInfo) -> Result<Option<Vec<f32>>, BuildError> {
    let context = FileContext::new(aux);
    let text = match files::read_text(aux, AUX_BYTES) {
        Ok(Some(text)) => text,
        Ok(None) => {
            return Err(context.rejected(
                format!("has more than {AUX_BYTES} bytes"),
                "remove its histograms (`gdalinfo` writes it again)",
            ));
        }
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(context.unreadable(error)),
    };
    let numbers = no_data(&text)
        .map_err(|cause| context.rejected(cause, "correct its <NoDataValue>, or remove it"))?;
    let Some(numbers) = numbers else {
        return Ok(None);
    };
    if numbers.len() < colours(info) {
        return Err(context.rejected(
            format!(
                "names {} numbers for nothing, and the map beside it has {} colours",
                numbers.len(),
                colours(info)
            ),
            "write the palette's colours out (`gdal_translate -expand rgb IN OUT`), or give no_data in a mosaic's [[part]]",
        ));
    }
    // Samples have at most 32 bits.
    let numbers = numbers.iter().take(colours(info));
    Ok(Some(numbers.map(|number| *number as f32).collect()))
}

impl SideMask {
    fn find(path: &Path, info: &SourceInfo) -> Result<Option<Self>, BuildError> {
        let context = FileContext::new(path);
        let file = match files::open(path) {
            Ok(file) => BufReader::with_capacity(1 << 16, file),
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(context.unreadable(error)),
        };
        let mut decoder =
            Decoder::new(file).map_err(|error| unread(&context, TiffGapError::Tiff(error)))?;
        let mask = TiffMask::of_file(&mut decoder, (info.width, info.height));
        Ok(Some(Self {
            mask: mask.map_err(|error| unread(&context, error))?,
            decoder,
            context,
        }))
    }

    fn row(&mut self, row: usize, is_there: &mut [bool]) -> Result<(), BuildError> {
        self.mask.forget_above(row);
        let read = self.mask.row(&mut self.decoder, row, 0, is_there);
        read.map_err(|error| unread(&self.context, error))
    }
}

fn unread(context: &FileContext, error: TiffGapError) -> BuildError {
    let rejected = |cause: String| {
        context.rejected(
            cause,
            "remove it, or write what it masks as alpha (`gdalwarp -dstalpha IN OUT`)",
        )
    };
    match error {
        TiffGapError::Tiff(TiffError::IoError(error)) => context.damaged(error),
        TiffGapError::Tiff(error) => rejected(format!("is no mask that is read ({error})")),
        TiffGapError::Damaged(cause) => context.damaged(cause),
        TiffGapError::Mask(cause) => rejected(format!("is {cause}")),
    }
}

impl RowSource for BesideRows {
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
        let stored = self.inner.info();
        self.inner.next_row(&mut self.row)?;
        self.is_there.fill(true);
        if let Some(mask) = &mut self.mask {
            mask.row(self.given as usize, &mut self.is_there)?;
        }
        self.given += 1;
        let size = stored.sample.bytes();
        let from = self.row.chunks_exact(stored.channels * size);
        let texels = from.zip(row.chunks_exact_mut(self.info.channels * size));
        for ((from, to), is_there) in texels.zip(&self.is_there) {
            let is_nothing = |no_data: &Vec<f32>| {
                no_data.iter().enumerate().all(|(n, no_data)| {
                    let value = sample(stored.sample, from, n);
                    value == *no_data || (value.is_nan() && no_data.is_nan())
                })
            };
            if !is_there || self.no_data.as_ref().is_some_and(is_nothing) {
                to.fill(0);
                continue;
            }
            to[..from.len()].copy_from_slice(from);
            if stored.opacity.is_none() {
                full(stored.sample, &mut to[from.len()..]);
            }
        }
        Ok(())
    }
}

/// Writes the value of full opacity.
fn full(kind: SampleKind, sample: &mut [u8]) {
    match kind {
        SampleKind::F32 => sample.copy_from_slice(&1f32.to_ne_bytes()),
        SampleKind::U8 | SampleKind::U16 | SampleKind::I16 => sample.fill(0xFF),
    }
}
