//! GDAL's files beside an elevation file: `NAME.tif.aux.xml` with extra metadata, and `NAME.tif.msk` with a mask.

use super::error::FileContext;
use super::sidecar::HeightUnit;
use super::{Header, HeightFileError};
use crate::elevation::aux_xml::{AUX_BYTES, band_number, band_text};
use crate::elevation::tiff_gaps::{TiffGapError, TiffMask};
use std::fs::File;
use std::io::{BufReader, ErrorKind};
use std::path::{Path, PathBuf};
use terrella_files::{self as files, excerpt};
use tiff::TiffError;
use tiff::decoder::Decoder;

/// `NAME.tif.aux.xml`.
pub(super) fn aux_of(path: &Path) -> PathBuf {
    with_ending(path, ".aux.xml")
}

/// `NAME.tif.msk`.
pub(super) fn mask_of(path: &Path) -> PathBuf {
    with_ending(path, ".msk")
}

fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

/// Metadata of one band in the text beside a file.
#[derive(Debug, Default, PartialEq)]
pub(super) struct SaidBeside {
    no_data: Option<f64>,
    unit: Option<HeightUnit>,
    scale: Option<f64>,
    offset: Option<f64>,
}

impl SaidBeside {
    /// Reads the text beside a file, if present; bands count from 1.
    pub fn read(path: &Path, band: u16) -> Result<Self, HeightFileError> {
        let aux = aux_of(path);
        let context = FileContext::new(&aux);
        match files::read_text(&aux, AUX_BYTES) {
            Ok(Some(text)) => Self::of(&text, band, &context),
            Ok(None) => Err(context.rejected(
                format!("has more than {AUX_BYTES} bytes"),
                "a few lines about one file",
                "remove its histograms (`gdalinfo` writes it again)",
            )),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Self::default()),
            Err(error) => Err(context.reading(error)),
        }
    }

    fn of(text: &str, band: u16, context: &FileContext) -> Result<Self, HeightFileError> {
        let number = |name| {
            band_number(text, band, name).map_err(|cause| {
                context.rejected(
                    cause,
                    "a number",
                    format!("correct <{name}> of band {band}"),
                )
            })
        };
        let unit = match band_text(text, band, "UnitType").filter(|word| !word.is_empty()) {
            None => None,
            Some(word) => Some(HeightUnit::from_word(&word).ok_or_else(|| {
                context.rejected(
                    format!("has heights of the unit {:?}", excerpt(&word)),
                    "metres or feet",
                    "correct the <UnitType> of the band, or remove it and write unit = \"metres\" in a sidecar",
                )
            })?),
        };
        Ok(Self {
            no_data: number("NoDataValue")?,
            unit,
            scale: number("Scale")?,
            offset: number("Offset")?,
        })
    }
}

impl Header {
    /// Adds the metadata of the text beside the file.
    pub(super) fn add(
        &mut self,
        said: &SaidBeside,
        context: &FileContext,
    ) -> Result<(), HeightFileError> {
        if let Some(no_data) = said.no_data
            && !self.missing.has(no_data)
        {
            self.missing = self.missing.and(no_data).ok_or_else(|| {
                context.rejected(
                    "names more than 4 missing values with the .aux.xml beside it",
                    "a few",
                    "write nodata in a sidecar",
                )
            })?;
        }
        match (self.unit, said.unit) {
            (Some(own), Some(other)) if own != other => {
                return Err(context.rejected(
                    format!(
                        "has heights in {}, but its .aux.xml says {}",
                        own.name(),
                        other.name()
                    ),
                    "one unit",
                    "correct <UnitType> in the .aux.xml",
                ));
            }
            (own, other) => self.unit = own.or(other),
        }
        self.scale = self.scale.or(said.scale);
        self.offset = self.offset.or(said.offset);
        Ok(())
    }
}

/// A mask in a separate file.
pub(super) struct SideMask {
    decoder: Decoder<BufReader<File>>,
    mask: TiffMask,
    context: FileContext,
    is_there: Vec<bool>,
}

impl SideMask {
    /// The mask beside a file of this size, if present.
    pub fn find(path: &Path, size: (u32, u32)) -> Result<Option<Self>, HeightFileError> {
        let path = mask_of(path);
        let context = FileContext::new(&path);
        let file = match files::open(&path) {
            Ok(file) => BufReader::with_capacity(1 << 16, file),
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(context.unreadable(error)),
        };
        let mut decoder =
            Decoder::new(file).map_err(|error| unread(&context, TiffGapError::Tiff(error)))?;
        let mask =
            TiffMask::of_file(&mut decoder, size).map_err(|error| unread(&context, error))?;
        Ok(Some(Self {
            decoder,
            mask,
            context,
            is_there: Vec::new(),
        }))
    }

    /// Bytes in memory while heights are read in strips or tiles of `chunk_rows` rows.
    pub fn working_bytes(&self, chunk_rows: usize) -> u64 {
        self.mask.working_bytes(2 * chunk_rows)
    }

    /// Turns masked samples of a row into holes; rows above `first` are not requested again.
    pub fn cut(
        &mut self,
        first: usize,
        row: usize,
        column: usize,
        heights_m: &mut [f32],
    ) -> Result<(), HeightFileError> {
        self.mask.forget_above(first);
        self.is_there.resize(heights_m.len(), true);
        let read = self
            .mask
            .row(&mut self.decoder, row, column, &mut self.is_there);
        read.map_err(|error| unread(&self.context, error))?;
        for (height_m, is_there) in heights_m.iter_mut().zip(&self.is_there) {
            if !is_there {
                *height_m = f32::NAN;
            }
        }
        Ok(())
    }
}

fn unread(context: &FileContext, error: TiffGapError) -> HeightFileError {
    let rejected = |cause: String| {
        context.rejected(
            cause,
            "a mask of 1 or 8 bits as large as the file beside it",
            "remove it, or write what it masks as no data (`gdalwarp -dstnodata -32768`)",
        )
    };
    match error {
        TiffGapError::Tiff(TiffError::IoError(error)) => context.reading(error),
        TiffGapError::Tiff(error) => rejected(format!("is no mask that is read ({error})")),
        TiffGapError::Damaged(cause) => context.damaged(cause),
        TiffGapError::Mask(cause) => rejected(format!("is {cause}")),
    }
}
