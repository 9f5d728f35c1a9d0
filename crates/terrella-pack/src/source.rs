//! Maps read from disk, a row at a time.

mod beside;
mod geo;
mod jpeg;
mod png;
mod sample;
mod sof;
mod tiff;
mod webp;

use super::error::BuildError;
pub(super) use beside::files_beside;
pub(super) use geo::{TagGrid, complaint_of, grid_of, in_other_system};
pub(super) use sample::sample;
use std::fmt;
use std::io::{BufRead, BufReader, Seek};
use std::path::{Path, PathBuf};
use terrella_files as files;
use terrella_files::first_bytes;
use terrella_imagery::colour::Said;

/// Smallest height of a map, texels.
pub const MIN_SOURCE_HEIGHT: u32 = 16;

/// Largest height of a map, texels; its width is twice that.
pub const MAX_SOURCE_HEIGHT: u32 = 131_072;

/// Longest side of a part of a map, texels.
pub const MAX_PIECE_SIDE: u32 = 262_144;

/// What one sample is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleKind {
    /// 0…255.
    U8,
    /// 0…65 535, the machine's byte order.
    U16,
    /// −32 768…32 767, the machine's byte order.
    I16,
    /// 32-bit float, the machine's byte order.
    F32,
}

impl SampleKind {
    /// Bytes of a sample.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::F32 => 4,
        }
    }
}

impl fmt::Display for SampleKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::U8 => "8-bit",
            Self::U16 => "16-bit",
            Self::I16 => "signed 16-bit",
            Self::F32 => "32-bit float",
        })
    }
}

/// What a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// Portable Network Graphics.
    Png,
    /// JPEG, baseline or progressive.
    Jpeg,
    /// TIFF, also BigTIFF and GeoTIFF.
    Tiff,
    /// WebP, lossy or lossless.
    WebP,
}

/// What a texel's last channel says of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Opacity {
    /// How much of it is there, as the file stores it.
    Alpha,
    /// Whether there is anything: made here from numbers or masks that stand for nothing, and from parts that a file leaves out.
    Mask,
}

impl Opacity {
    /// Of files that store as many channels.
    pub(super) fn of_channels(channels: usize) -> Option<Self> {
        matches!(channels, 2 | 4).then_some(Self::Alpha)
    }
}

/// Size and texels of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SourceInfo {
    /// What it is read from.
    pub file: FileKind,
    /// Texels of a row.
    pub width: u32,
    /// Height, texels.
    pub height: u32,
    /// Samples of a texel: 1 grey, 2 grey and alpha, 3 colour, 4 colour and alpha.
    pub channels: usize,
    /// What each sample is.
    pub sample: SampleKind,
    /// What the last of two or four channels means.
    pub opacity: Option<Opacity>,
    /// Bytes that reading holds beside the row that it gives.
    pub buffer_bytes: u64,
}

impl SourceInfo {
    /// Bytes of one row.
    pub fn row_bytes(&self) -> usize {
        self.width as usize * self.channels * self.sample.bytes()
    }
}

/// How much of the Earth a file must hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extent {
    /// All of it: twice as wide as high, and what it says of its place must agree.
    WholeEarth,
    /// Any part; where it lies is asked elsewhere.
    Piece,
}

/// A map read from north to south.
pub trait RowSource {
    /// Its size and texels.
    fn info(&self) -> SourceInfo;

    /// How its colours differ from sRGB, where it says so.
    fn colour_note(&self) -> Option<String> {
        None
    }

    /// What was left out so far, to be reported once each.
    fn notes(&mut self) -> Vec<String> {
        Vec::new()
    }

    /// Fills a row of [`SourceInfo::row_bytes`] bytes. Called at most once for each row.
    ///
    /// # Errors
    /// [`BuildError::Damaged`] or [`BuildError::Unreadable`]. The source gives no more rows after it.
    fn next_row(&mut self, row: &mut [u8]) -> Result<(), BuildError>;
}

/// What reading may take.
#[derive(Clone, Copy, Debug)]
pub struct SourceLimits {
    /// Most bytes to hold beside a row: for strips and tiles, and for files that cannot be read in strips.
    pub buffer_bytes: u64,
}

/// Names the file in errors of its reader.
#[derive(Clone, Debug)]
pub(super) struct FileContext(PathBuf);

impl FileContext {
    pub(super) fn new(path: &Path) -> Self {
        Self(path.to_path_buf())
    }

    pub(super) fn unreadable(&self, source: std::io::Error) -> BuildError {
        BuildError::Unreadable {
            path: self.0.clone(),
            source,
        }
    }

    /// What a decoder met while it read: a file that ends too early is damaged.
    fn failed_read(&self, error: std::io::Error) -> BuildError {
        match error.kind() {
            std::io::ErrorKind::UnexpectedEof => self.damaged("the file ends too early"),
            _ => self.unreadable(error),
        }
    }

    /// Takes the next row of a picture that was decoded as a whole, `given` rows of which are taken.
    fn take_row(&self, whole: &[u8], given: u32, row: &mut [u8]) -> Result<(), BuildError> {
        let start = given as usize * row.len();
        let texels = whole.get(start..start + row.len());
        row.copy_from_slice(texels.ok_or_else(|| self.damaged("too few rows"))?);
        Ok(())
    }

    pub(super) fn damaged(&self, cause: impl fmt::Display) -> BuildError {
        BuildError::Damaged {
            path: self.0.clone(),
            cause: files::cause(cause),
        }
    }

    pub(super) fn rejected(
        &self,
        cause: impl fmt::Display,
        advice: impl Into<String>,
    ) -> BuildError {
        BuildError::Source {
            path: self.0.clone(),
            cause: files::cause(cause),
            advice: advice.into(),
        }
    }

    /// Rejects texels that do not lie as they are drawn.
    fn check_turned(&self, said: &Said) -> Result<(), BuildError> {
        match said.turned() {
            None => Ok(()),
            Some(how) => Err(self.rejected(
                format!(
                    "is stored {how} (orientation {})",
                    said.orientation.unwrap_or_default()
                ),
                "rotate it (`magick IN -auto-orient OUT`)",
            )),
        }
    }

    /// That the file cannot be read in strips and is too large to be held.
    pub(super) fn too_large(
        &self,
        what: &str,
        bytes: u64,
        limits: SourceLimits,
        advice: &str,
    ) -> BuildError {
        let megabytes = |bytes: u64| bytes.div_ceil(1_000_000);
        self.rejected(
            format!(
                "{what} would take {} MB of memory and {} MB are left for it",
                megabytes(bytes),
                megabytes(limits.buffer_bytes)
            ),
            advice,
        )
    }
}

/// Opens a map; the contents say what it is, not the name.
///
/// # Errors
/// [`BuildError`] with the file and what to do, before anything large is allocated.
pub fn open_source(path: &Path, limits: SourceLimits) -> Result<Box<dyn RowSource>, BuildError> {
    open_extent(path, limits, Extent::WholeEarth)
}

/// Opens a picture of any part of the Earth, and what lies beside it.
pub(super) fn open_extent(
    path: &Path,
    limits: SourceLimits,
    extent: Extent,
) -> Result<Box<dyn RowSource>, BuildError> {
    let context = FileContext::new(path);
    let file = files::open(path).map_err(|error| context.unreadable(error))?;
    let reader = BufReader::with_capacity(1 << 16, file);
    beside::without_gaps(read_extent(reader, path, limits, extent)?, path)
}

/// Reads a map from anything; `path` is its name in messages.
///
/// # Errors
/// As [`open_source`].
pub fn read_source<R: BufRead + Seek + 'static>(
    reader: R,
    path: &Path,
    limits: SourceLimits,
) -> Result<Box<dyn RowSource>, BuildError> {
    read_extent(reader, path, limits, Extent::WholeEarth)
}

/// Reads a picture of any part of the Earth.
pub(super) fn read_extent<R: BufRead + Seek + 'static>(
    mut reader: R,
    path: &Path,
    limits: SourceLimits,
    extent: Extent,
) -> Result<Box<dyn RowSource>, BuildError> {
    let context = FileContext::new(path);
    let magic = first_bytes(&mut reader).map_err(|error| context.unreadable(error))?;
    let source: Box<dyn RowSource> = match magic.as_slice() {
        [0x89, b'P', b'N', b'G', ..] => {
            Box::new(png::PngRows::open(reader, context.clone(), limits, extent)?)
        }
        [0xFF, 0xD8, ..] => Box::new(jpeg::JpegRows::open(
            reader,
            context.clone(),
            limits,
            extent,
        )?),
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => Box::new(
            tiff::TiffRows::open(reader, context.clone(), limits, extent)?,
        ),
        // Eight bytes are looked at: the length of a file of RIFF, and its kind behind it, are the decoder's matter.
        [b'R', b'I', b'F', b'F', ..] => {
            let rows = webp::WebPRows::open(reader, context.clone(), limits, extent)?;
            Box::new(rows)
        }
        _ => {
            return Err(context.rejected(
                "is neither PNG nor JPEG nor TIFF nor WebP",
                "convert it to one of these",
            ));
        }
    };
    Ok(source)
}

/// Rejects what is no map of the whole Earth, or no part of one. Readers call it with the sizes of the header, before they
/// allocate.
fn check_size(
    context: &FileContext,
    width: u32,
    height: u32,
    extent: Extent,
) -> Result<(), BuildError> {
    if extent == Extent::Piece {
        let sides = 1..=MAX_PIECE_SIDE;
        if sides.contains(&width) && sides.contains(&height) {
            return Ok(());
        }
        return Err(context.rejected(
            format!("is {width} x {height} texels"),
            format!("give maps of at most {MAX_PIECE_SIDE} texels a side"),
        ));
    }
    if !(MIN_SOURCE_HEIGHT..=MAX_SOURCE_HEIGHT).contains(&height)
        || width.abs_diff(height.saturating_mul(2)) > 1
    {
        return Err(context.rejected(
            format!("is {width} x {height} texels"),
            format!(
                "give an equirectangular map of the whole Earth, twice as wide as high, from {MIN_SOURCE_HEIGHT} to \
                 {MAX_SOURCE_HEIGHT} texels high, or a mosaic (a TOML file or a folder) of maps that say where they lie"
            ),
        ));
    }
    Ok(())
}
