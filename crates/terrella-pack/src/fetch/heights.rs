//! Heights of a mosaic written as a GeoTIFF that the readers of `elevation` take.

use super::error::FetchError;
use crate::BuildProgress;
use crate::mosaic::{Bounds, Mosaic};
use crate::source::{RowSource, SampleKind, SourceLimits};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use terrella_files::Unfinished;
use terrella_files::durable;
use tiff::encoder::{TiffEncoder, colortype::Gray32Float};
use tiff::tags::Tag;

/// Size limit of the elevation data: offsets in a TIFF have 32 bits.
const MOST_BYTES: u64 = 4_000_000_000;

/// Stored where there is nothing.
const NO_DATA: f32 = -99_999.0;

/// Number of rows that are written together.
const STRIP_ROWS: u32 = 16;

/// Writes the elevation data of a region. Returns columns and rows.
///
/// # Errors
/// [`FetchError`] with the file; no file of that name is left then.
pub fn write_heights(
    mosaic: &Path,
    region: &Bounds,
    out: &Path,
    limits: SourceLimits,
    progress: &dyn BuildProgress,
) -> Result<(u32, u32), FetchError> {
    let wrong = |cause: String| FetchError::Heights {
        path: out.to_path_buf(),
        cause,
    };
    let mosaic = Mosaic::open(mosaic, Some(region), limits)?;
    let info = mosaic.info();
    if info.channels != 1 || info.sample != SampleKind::F32 {
        return Err(wrong("what was fetched are no heights".to_string()));
    }
    let bytes = info.row_bytes() as u64 * u64::from(info.height);
    if bytes > MOST_BYTES {
        return Err(wrong(format!(
            "{} x {} heights have {bytes} bytes and a TIFF {MOST_BYTES} at most; give a smaller region or a coarser level",
            info.width, info.height
        )));
    }
    for note in mosaic.notes() {
        progress.note(note);
    }
    let name = out
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let part = out.with_file_name(format!(".{name}.part"));
    let mut rows = mosaic.rows(limits);
    progress.begin("heights", Some(u64::from(info.height)));
    let written = write(&mosaic, &mut rows, &part, progress);
    progress.end();
    for note in rows.notes() {
        progress.note(&note);
    }
    let written = match written {
        Ok(()) => durable::replace(&part, out)
            .map_err(|error| wrong(format!("{error}; make room or correct the permissions"))),
        Err(Failure::Fetch(error)) => Err(error),
        Err(Failure::Tiff(error)) => Err(wrong(format!(
            "{error}; make room or correct the permissions"
        ))),
    };
    if written.is_err() {
        // The error that counts is the one above.
        let _ = std::fs::remove_file(&part);
    }
    written.map(|()| (info.width, info.height))
}

enum Failure {
    Fetch(FetchError),
    Tiff(tiff::TiffError),
}

impl From<tiff::TiffError> for Failure {
    fn from(error: tiff::TiffError) -> Self {
        Self::Tiff(error)
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Self::Tiff(error.into())
    }
}

fn write(
    mosaic: &Mosaic,
    rows: &mut dyn RowSource,
    path: &Path,
    progress: &dyn BuildProgress,
) -> Result<(), Failure> {
    let (info, target) = (mosaic.info(), mosaic.target());
    let (file, _unfinished) = Unfinished::create(path, |path| File::create(path))?;
    let mut file = BufWriter::new(file);
    let mut encoder = TiffEncoder::new(&mut file)?;
    let mut image = encoder.new_image::<Gray32Float>(info.width, info.height)?;
    image.rows_per_strip(STRIP_ROWS)?;
    let tags = image.encoder();
    // Areas of WGS84 latitudes and longitudes: model, raster, system (OGC 19-008r4).
    let keys: [u16; 16] = [1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326];
    tags.write_tag(Tag::GeoKeyDirectoryTag, keys.as_slice())?;
    let scale = [target.texel_deg, target.texel_deg, 0.0];
    tags.write_tag(Tag::ModelPixelScaleTag, scale.as_slice())?;
    let tie = [0.0, 0.0, 0.0, target.west_deg, target.north_deg, 0.0];
    tags.write_tag(Tag::ModelTiepointTag, tie.as_slice())?;
    tags.write_tag(Tag::GdalNodata, format!("{NO_DATA}").as_str())?;
    // The unit, which readers would otherwise have to be given.
    tags.write_tag(
        Tag::Unknown(42_112),
        "<GDALMetadata><Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">m</Item></GDALMetadata>",
    )?;
    let mut bytes = vec![0; info.row_bytes()];
    let mut strip = Vec::with_capacity(info.width as usize * STRIP_ROWS as usize);
    for row in 0..info.height {
        if progress.cancelled() {
            return Err(Failure::Fetch(FetchError::Cancelled));
        }
        rows.next_row(&mut bytes)
            .map_err(|error| Failure::Fetch(error.into()))?;
        let (texels, _) = bytes.as_chunks::<4>();
        strip.extend(texels.iter().map(|texel| {
            let height_m = f32::from_ne_bytes(*texel);
            if height_m.is_finite() {
                height_m
            } else {
                NO_DATA
            }
        }));
        if (row + 1) % STRIP_ROWS == 0 || row + 1 == info.height {
            image.write_strip(&strip)?;
            strip.clear();
        }
        progress.step();
    }
    image.finish()?;
    file.flush()?;
    Ok(())
}
