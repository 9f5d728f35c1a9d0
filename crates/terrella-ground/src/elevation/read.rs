//! Reads elevation files.
//!
//! | file | georeference | unit |
//! |---|---|---|
//! | GeoTIFF, BigTIFF: strips or tiles, compressed as [`tiff_chunks`](super::tiff_chunks) decodes | its own tags, the sidecar, or a world file | its own keys, or the sidecar |
//! | PNG, grey, 8 or 16 bits | the sidecar, or a world file | the sidecar |
//! | NetCDF: classic (CDF-1, CDF-2, CDF-5), NetCDF-4 (HDF5) | its coordinate variables, or the sidecar | its attribute `units`, or the sidecar |
//! | SRTM's `.hgt`, also packed by gzip or in a zip file | its name, or the sidecar | metres |
//! | ASCII grid (`.asc`) | its header, in degrees or in metres of a `.prj` file beside it | the sidecar |
//! | DTED, levels 0 to 2 | its header | metres |
//!
//! The sidecar of `NAME.png` is `NAME.toml` beside it ([`Sidecar`]), or else `folder.toml`, which states no position. The reader guesses nothing. If
//! neither the file nor the sidecar states a value, the error names the key to write. A contradiction between the two is also an error. Only
//! latitudes and longitudes of WGS84 and of systems within a few metres of it are read. Errors about other systems name the command that warps them.
//! GDAL's files beside a file count: `NAME.tif.aux.xml` (no data, unit, scale, offset) and the mask `NAME.tif.msk`. Numbers that usually mean no data
//! (−9999, −32 768 and others) are holes where nothing is declared, and are reported. All checks precede any large allocation.

mod ascii;
mod beside;
mod conversion;
mod dted;
mod error;
mod geo_keys;
mod hgt;
mod missing;
mod netcdf;
mod plain;
mod png;
mod set;
mod sidecar;
#[cfg(test)]
mod tests;
mod tiff;
mod vrt;
mod warp;
mod zip;

pub use error::HeightFileError;
pub use set::{MAX_SET_FILES, height_set};
pub use sidecar::{ByteOrder, HeightUnit, MAX_SIDECAR_BYTES, Sidecar, SidecarGeoreference};
use sidecar::{folder_sidecar, read_sidecar, sidecar_of};

use super::geoid::VerticalDatum;
use super::grid::placement::Placement;
use super::warp::Warp;
use super::world_file::WorldFile;
use super::{Denoise, Denoised, Georeference, GridError, GridLimits, HeightGrid};
use beside::{SaidBeside, SideMask};
pub(super) use conversion::Conversion;
use error::FileContext;
use missing::Missing;
use plain::{PlainGrid, prj_of, system_beside};
use std::fs::File;
use std::io::{BufRead, BufReader, Seek};
use std::path::{Path, PathBuf};
use terrella_files as files;
use warp::Held;

#[derive(Debug)]
pub struct HeightFile {
    pub grid: HeightGrid,
    /// Credit for the data, from the sidecar.
    pub attribution: Option<String>,
    /// Vertical datum of the file's heights, if it or its sidecar states one. The grid's heights are above mean sea level.
    pub above: Option<VerticalDatum>,
    /// Samples of the grid around projected ones, which have no data.
    pub around: u64,
    /// Samples treated as no data without a declaration, because their value usually means that.
    pub undeclared: u64,
    /// Single wrong heights found, if the search was requested.
    pub denoised: Option<Denoised>,
}

/// Contents of a file's header. `None` for what it does not state.
struct Header {
    columns: u32,
    rows: u32,
    georeference: Option<Georeference>,
    /// Positions of the samples in a system that is not known yet.
    plain: Option<PlainGrid>,
    /// Resampling from the projection of the samples to the georeference.
    warp: Option<Warp>,
    /// Whether the southern row is stored first.
    is_south_first: bool,
    unit: Option<HeightUnit>,
    scale: Option<f64>,
    offset: Option<f64>,
    /// Vertical datum of the heights.
    above: Option<VerticalDatum>,
    missing: Missing,
}

impl Header {
    /// Header of a file that states only its size and its missing samples.
    fn of_size(columns: u32, rows: u32, missing: Missing) -> Self {
        Self {
            columns,
            rows,
            georeference: None,
            plain: None,
            warp: None,
            is_south_first: false,
            unit: None,
            scale: None,
            offset: None,
            above: None,
            missing,
        }
    }
}

/// A file whose header has been read.
enum Decoder<R: BufRead + Seek> {
    Tiff(Box<tiff::Tiff<R>>),
    Png(Box<png::Png<R>>),
    NetCdf(netcdf::NetCdf<R>),
    Hgt(hgt::Hgt<R>),
    Ascii(ascii::Ascii<R>),
    Dted(dted::Dted<R>),
}

impl<R: BufRead + Seek> Decoder<R> {
    /// Rows of a strip or tile.
    fn chunk_rows(&self) -> usize {
        match self {
            Self::Tiff(tiff) => tiff.chunk_rows(),
            Self::NetCdf(file) => file.chunk_rows(),
            _ => 1,
        }
    }
}

/// A file with a parsed header and unread heights.
pub(super) struct HeightReader<R: BufRead + Seek> {
    context: FileContext,
    decoder: Decoder<R>,
    header: Header,
    said: Sidecar,
    /// Vertical datum to use if neither the file nor its sidecar states one.
    assumed_above: Option<VerticalDatum>,
    mask: Option<SideMask>,
}

impl HeightReader<BufReader<File>> {
    /// Opens a file, its sidecar if present, and GDAL's files beside it.
    pub(super) fn open(path: &Path) -> Result<Self, HeightFileError> {
        let context = FileContext::new(path);
        let file = files::open(path).map_err(|error| context.unreadable(error))?;
        let sidecar = match read_sidecar(&sidecar_of(path))? {
            None => folder_sidecar(path)?,
            sidecar => sidecar,
        };
        let reader = BufReader::with_capacity(1 << 16, file);
        let mut reader = Self::new(reader, sidecar.as_ref(), path)?;
        if reader.lacks_place() {
            let size = (reader.header.columns, reader.header.rows);
            reader.header.plain = PlainGrid::beside(path, size)?;
        }
        let system = match reader.header.plain {
            Some(_) => system_beside(path)?,
            None => None,
        };
        reader.header.settle(system, &context)?;
        let band = reader.said.band.unwrap_or(1);
        reader
            .header
            .add(&SaidBeside::read(path, band)?, &context)?;
        reader.mask = SideMask::find(path, (reader.header.columns, reader.header.rows))?;
        Ok(reader)
    }
}

/// Reads heights from a file, with its sidecar if present. The contents determine the format, not the name.
///
/// # Errors
/// [`HeightFileError`]: the file, the cause, what was expected and what to do.
pub fn open_heights(path: &Path, limits: &GridLimits) -> Result<HeightFile, HeightFileError> {
    open_heights_denoised(path, limits, None)
}

/// Reads heights above a datum that applies if neither the file nor its sidecar names one.
///
/// # Errors
/// As [`open_heights`].
pub fn open_heights_above(
    path: &Path,
    limits: &GridLimits,
    above: Option<VerticalDatum>,
) -> Result<HeightFile, HeightFileError> {
    let mut reader = HeightReader::open(path)?;
    reader.assume_above(above);
    reader.whole(limits, None)
}

/// Reads heights without single wrong heights. These are removed before means and ranges are computed.
///
/// # Errors
/// As [`open_heights`].
pub fn open_heights_denoised(
    path: &Path,
    limits: &GridLimits,
    denoise: Option<&Denoise>,
) -> Result<HeightFile, HeightFileError> {
    HeightReader::open(path)?.whole(limits, denoise)
}

/// The files that [`open_heights`] reads for an elevation file, as far as present. They are the file, its sidecar, its world file
/// with the text of its system, and GDAL's files.
pub fn height_files(path: &Path) -> Vec<PathBuf> {
    let beside = [
        sidecar_of(path),
        beside::aux_of(path),
        beside::mask_of(path),
    ];
    let prj = prj_of(path).into_iter().find(|file| file.exists());
    let beside = beside.into_iter().filter(|file| file.exists());
    let beside = beside.chain(WorldFile::beside(path)).chain(prj);
    std::iter::once(path.to_owned()).chain(beside).collect()
}

/// Checks the header and the sidecar as [`open_heights`] does, without reading heights.
///
/// # Errors
/// As [`open_heights`].
pub fn check_heights(path: &Path, limits: &GridLimits) -> Result<(), HeightFileError> {
    let reader = HeightReader::open(path)?;
    let (columns, rows) = reader.size();
    limits.check(columns, rows).map_err(reader.rejection())?;
    reader.georeference()?;
    reader.above()?;
    reader.conversion().map(drop)
}

/// Checks an elevation file that is read as a plain image in metres. It rejects what [`open_heights`] rejects in the header or sidecar,
/// and numbers that the file declares in another unit. The caller knows the position, so a missing position or unit is no error. With
/// `is_placed`, neither is another coordinate system.
///
/// # Errors
/// As [`open_heights`].
pub fn check_metres(path: &Path, is_placed: bool) -> Result<(), HeightFileError> {
    let reader = match HeightReader::open(path) {
        Err(HeightFileError::OtherCoordinates { .. }) if is_placed => return Ok(()),
        reader => reader?,
    };
    if let Decoder::Tiff(tiff) = &reader.decoder
        && tiff.is_narrow()
    {
        let rewrite = format!("`gdal_translate -ot Int16 {} OUT.tif`", path.display());
        let cause = "has heights of fewer than 16 bits";
        let context = &reader.context;
        return Err(context.rejected(cause, "heights of 16 bits or floats", rewrite));
    }
    match reader.georeference() {
        Ok(_) | Err(HeightFileError::NoPlace { .. }) => {}
        Err(error) => return Err(error),
    }
    match reader.conversion() {
        Ok(_) | Err(HeightFileError::NoUnit { .. }) => {}
        Err(error) => return Err(error),
    }
    let Header {
        unit,
        scale,
        offset,
        ..
    } = reader.header;
    let unit_m = unit.or(reader.said.unit).map_or(1.0, HeightUnit::metres);
    if unit_m * scale.unwrap_or(1.0) == 1.0 && offset.unwrap_or(0.0) == 0.0 {
        return Ok(());
    }
    let unit = unit.or(reader.said.unit).map_or("metres", HeightUnit::name);
    Err(reader.context.rejected(
        format!(
            "stores {unit}, times {} plus {}",
            scale.unwrap_or(1.0),
            offset.unwrap_or(0.0)
        ),
        "metres as they are stored",
        format!(
            "convert it: `gdal_translate -unscale -ot Float32 {} OUT.tif`, and of feet `gdal_calc.py` to metres",
            path.display()
        ),
    ))
}

/// Reads heights from any reader; `path` is its name in messages.
///
/// # Errors
/// As [`open_heights`].
pub fn read_heights<R: BufRead + Seek>(
    reader: R,
    sidecar: Option<&Sidecar>,
    path: &Path,
    limits: &GridLimits,
) -> Result<HeightFile, HeightFileError> {
    let mut reader = HeightReader::new(reader, sidecar, path)?;
    reader.header.settle(None, &reader.context)?;
    reader.whole(limits, None)
}

impl<R: BufRead + Seek> HeightReader<R> {
    fn new(mut reader: R, sidecar: Option<&Sidecar>, path: &Path) -> Result<Self, HeightFileError> {
        let context = FileContext::new(path);
        let magic =
            terrella_files::first_bytes(&mut reader).map_err(|error| context.unreadable(error))?;
        let formats =
            "a GeoTIFF, a PNG, a NetCDF file, an ASCII grid, an .hgt file of SRTM or DTED";
        let said = sidecar.cloned().unwrap_or_default();
        let (decoder, header) = match magic.as_slice() {
            // The format has no signature: any number may come first.
            _ if hgt::is_named(path) => {
                let (file, header) = hgt::Hgt::plain(reader, &context)?;
                (Decoder::Hgt(file), header)
            }
            [0x89, b'P', b'N', b'G', ..] => {
                let (png, header) = png::Png::open(reader, &context, said.byte_order)?;
                (Decoder::Png(Box::new(png)), header)
            }
            [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => {
                let (tiff, header) = tiff::Tiff::open(reader, &context, said.band)?;
                (Decoder::Tiff(Box::new(tiff)), header)
            }
            [b'C', b'D', b'F', 1 | 2 | 5, ..] | [0x89, b'H', b'D', b'F', ..] => {
                let (file, header) =
                    netcdf::NetCdf::open(reader, &magic, &context, said.variable.as_deref())?;
                (Decoder::NetCdf(file), header)
            }
            [0x1F, 0x8B, ..] => {
                let (file, header) = hgt::Hgt::gzip(reader, &context)?;
                (Decoder::Hgt(file), header)
            }
            [b'P', b'K', 3, 4, ..] => {
                let (file, header) = hgt::Hgt::zip(reader, &context)?;
                (Decoder::Hgt(file), header)
            }
            [b'U', b'H', b'L', b'1', ..]
            | [b'V', b'O', b'L', b'1', ..]
            | [b'H', b'D', b'R', b'1', ..] => {
                let (file, header) = dted::Dted::open(reader, &context)?;
                (Decoder::Dted(file), header)
            }
            begin if ascii::begins(begin) => {
                let (file, header) = ascii::Ascii::open(reader, &context)?;
                (Decoder::Ascii(file), header)
            }
            _ => {
                return Err(context.rejected(
                    "is none of the files that heights are read from",
                    formats,
                    format!(
                        "convert it: `gdal_translate -of GTiff {} OUT.tif`",
                        path.display()
                    ),
                ));
            }
        };
        let is_png = matches!(decoder, Decoder::Png(_));
        if said.byte_order.is_some() && !is_png {
            return Err(context.rejected(
                "says its byte order itself, and so does the sidecar",
                "one word on it",
                "take byte_order out of the sidecar",
            ));
        }
        if said.variable.is_some() && !matches!(decoder, Decoder::NetCdf(_)) {
            return Err(context.rejected(
                "has no variables, and the sidecar names one",
                "a variable for NetCDF files only",
                "take it out of the sidecar",
            ));
        }
        if said.band.is_some() && !matches!(decoder, Decoder::Tiff(_)) {
            return Err(context.rejected(
                "has no bands, and the sidecar names one",
                "a band for TIFF files only",
                "take it out of the sidecar",
            ));
        }
        Ok(Self {
            context,
            decoder,
            header,
            said,
            assumed_above: None,
            mask: None,
        })
    }

    /// Whether an image has no georeference yet, so that a world file counts.
    fn lacks_place(&self) -> bool {
        matches!(self.decoder, Decoder::Tiff(_) | Decoder::Png(_))
            && self.header.georeference.is_none()
            && self.header.plain.is_none()
            && self.said.georeference.is_none()
    }

    /// Columns and rows of the heights after resampling.
    pub fn size(&self) -> (u32, u32) {
        match &self.header.warp {
            Some(warp) => (warp.place.columns, warp.place.rows),
            None => (self.header.columns, self.header.rows),
        }
    }

    /// Positions of the samples.
    pub(super) fn georeference(&self) -> Result<Georeference, HeightFileError> {
        georeference(&self.header, &self.said, &self.context)
    }

    /// Placement of the samples.
    pub(super) fn placement(&self) -> Result<Placement, HeightFileError> {
        let place = Placement::of(&self.georeference()?, self.header.warp.as_ref());
        place.map_err(self.rejection())
    }

    /// Sets the vertical datum to use if neither the file nor its sidecar names one.
    pub(super) fn assume_above(&mut self, above: Option<VerticalDatum>) {
        self.assumed_above = above;
    }

    /// Vertical datum of the file's heights.
    fn above(&self) -> Result<Option<VerticalDatum>, HeightFileError> {
        match (self.header.above, self.said.above) {
            (Some(own), Some(other)) if own != other => Err(self.context.rejected(
                format!(
                    "has heights above {}, but its sidecar says above {}",
                    own.name(),
                    other.name()
                ),
                "one datum",
                "correct above in the sidecar, or take it out",
            )),
            (own, other) => Ok(own.or(other).or(self.assumed_above)),
        }
    }

    /// Credit for the heights.
    pub fn attribution(&self) -> Option<String> {
        self.said.attribution.clone()
    }

    /// Returns a function that wraps grid errors with the file.
    pub(super) fn rejection(&self) -> impl Fn(GridError) -> HeightFileError + use<R> {
        let context = self.context.clone();
        move |error| context.grid(error)
    }

    /// Peak memory of reading, bytes, without the destination of the heights.
    pub fn working_bytes(&self) -> u64 {
        let mask = self.mask.as_ref();
        let of_mask = mask.map_or(0, |mask| mask.working_bytes(self.decoder.chunk_rows()));
        let of_warp = self.header.warp.as_ref().map_or(0, warp::working_bytes);
        of_mask
            + of_warp
            + match &self.decoder {
                Decoder::Tiff(tiff) => tiff.working_bytes(),
                Decoder::Png(png) => png.working_bytes(),
                Decoder::NetCdf(file) => file.working_bytes(),
                Decoder::Hgt(file) => file.working_bytes(),
                Decoder::Ascii(file) => file.working_bytes(),
                Decoder::Dted(file) => file.working_bytes(),
            }
    }

    /// Conversion from stored numbers to metres.
    pub(super) fn conversion(&self) -> Result<Conversion, HeightFileError> {
        Conversion::of(&self.header, &self.said, &self.context)
    }

    /// Reads all heights and passes each once to `put`, in stretches of a row: row (0 is the northern), first column, metres. Samples
    /// without data are not finite. Stops at the first error of `put`. Returns how many samples lie around projected ones.
    pub fn read<E: From<HeightFileError>>(
        self,
        conversion: &Conversion,
        mut put: impl FnMut(usize, usize, &mut [f32]) -> Result<(), E>,
    ) -> Result<u64, E> {
        let ellipsoid = self
            .above()?
            .filter(|above| *above == VerticalDatum::Ellipsoid);
        let place = ellipsoid.map(|above| Ok::<_, E>((above, self.georeference()?)));
        let place = place.transpose()?;
        let mut put = |row: usize, column: usize, heights_m: &mut [f32]| {
            if let Some((above, place)) = &place {
                let lat_rad = place.north_rad - row as f64 * place.lat_step_rad;
                for (height_m, n) in heights_m.iter_mut().zip(column..) {
                    let lon_rad = place.west_rad + n as f64 * place.lon_step_rad;
                    *height_m += above.to_sea_m(lat_rad, lon_rad) as f32;
                }
            }
            put(row, column, heights_m)
        };
        match self.header.warp {
            None => self.stored(conversion, &mut put).map(|()| 0),
            Some(warp) => {
                let mut held = Held::new(&warp);
                self.stored(conversion, &mut |row, column, heights_m: &mut [f32]| {
                    held.put(row, column, heights_m);
                    Ok::<_, HeightFileError>(())
                })?;
                held.rows(&mut put)
            }
        }
    }

    /// Passes on all heights as stored in the file.
    fn stored<E: From<HeightFileError>>(
        self,
        conversion: &Conversion,
        put: &mut impl FnMut(usize, usize, &mut [f32]) -> Result<(), E>,
    ) -> Result<(), E> {
        let last = self.header.rows as usize - 1;
        let is_south_first = self.header.is_south_first;
        let (mut mask, back) = (self.mask, self.decoder.chunk_rows());
        let mut put = |row: usize, column: usize, heights_m: &mut [f32]| {
            if let Some(mask) = &mut mask {
                // Strips and tiles go back by at most this many rows.
                mask.cut((row + 1).saturating_sub(back), row, column, heights_m)?;
            }
            match is_south_first {
                true => put(last - row, column, heights_m),
                false => put(row, column, heights_m),
            }
        };
        let note = match &self.decoder {
            Decoder::Tiff(tiff) => tiff.note(&self.context),
            _ => None,
        };
        match self.decoder {
            Decoder::Tiff(mut tiff) => tiff.read(&self.context, conversion, &mut put),
            Decoder::Png(mut png) => png.read(&self.context, conversion, &mut put),
            Decoder::NetCdf(mut file) => file.read(&self.context, conversion, &mut put),
            Decoder::Hgt(mut file) => file.read(&self.context, conversion, &mut put),
            Decoder::Ascii(mut file) => file.read(&self.context, conversion, &mut put),
            Decoder::Dted(mut file) => file.read(&self.context, conversion, &mut put),
        }?;
        for note in note.into_iter().chain(conversion.note(&self.context)) {
            tracing::warn!("{note}");
        }
        Ok(())
    }

    /// Reads all heights into a grid.
    pub(super) fn whole(
        self,
        limits: &GridLimits,
        denoise: Option<&Denoise>,
    ) -> Result<HeightFile, HeightFileError> {
        let (columns, rows) = self.size();
        let context = self.context.clone();
        limits
            .check(columns, rows)
            .map_err(|error| context.grid(error))?;
        let georeference = self.georeference()?;
        let conversion = self.conversion()?;
        let (attribution, above) = (self.attribution(), self.above()?);
        let (columns, warp) = (columns as usize, self.header.warp);
        let mut heights_m = vec![0.0f32; columns * rows as usize];
        let around = self.read(&conversion, |row, column, of_row: &mut [f32]| {
            let start = row * columns + column;
            heights_m[start..start + of_row.len()].copy_from_slice(of_row);
            Ok::<_, HeightFileError>(())
        })?;
        let denoised = denoise.map(|denoise| denoise.clean(columns, &mut heights_m));
        let grid = HeightGrid::new(&georeference, heights_m, limits)
            .and_then(|grid| grid.with_border_of(warp.as_ref()))
            .map_err(|error| context.grid(error))?;
        Ok(HeightFile {
            grid,
            above,
            around,
            undeclared: conversion.undeclared(),
            attribution,
            denoised,
        })
    }
}

fn georeference(
    header: &Header,
    said: &Sidecar,
    context: &FileContext,
) -> Result<Georeference, HeightFileError> {
    match (&header.georeference, &said.georeference) {
        (Some(_), Some(_)) => Err(context.rejected(
            "contains bounds, and so does its sidecar",
            "one place",
            "take bounds, centre, spacing and registration out of the sidecar",
        )),
        (Some(georeference), None) => Ok(*georeference),
        (None, Some(said)) => {
            let georeference = said.georeference(header.columns, header.rows);
            georeference.map_err(|error| context.grid(error))
        }
        (None, None) => Err(HeightFileError::NoPlace {
            path: context.path().to_owned(),
            sidecar: sidecar_of(context.path()),
        }),
    }
}
