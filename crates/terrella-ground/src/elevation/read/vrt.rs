//! The elevation files listed by a virtual raster.
//!
//! The files are read one by one, each at its own stated position. A raster of thousands of files therefore need not fit into memory. The raster must
//! agree with the files: it may not move, crop, scale or mask them with other numbers.

use super::error::FileContext;
use super::{HeightFileError, HeightReader};
use crate::elevation::vrt::{Vrt, VrtBand, VrtError, VrtGrid, VrtSource};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// Maximum offset of a file from its position in the raster, in the file's samples.
const MOST_MOVED: f64 = 0.1;

/// The files of a virtual raster, the uppermost first.
///
/// # Errors
/// [`HeightFileError`] if the raster does more than place its files side by side, and for files whose headers are rejected.
pub(super) fn vrt_files(path: &Path) -> Result<Vec<PathBuf>, HeightFileError> {
    let context = FileContext::new(path);
    let vrt = Vrt::open(path).map_err(|error| vrt_error(&context, error))?;
    let [band] = vrt.bands.as_slice() else {
        let cause = format!("has {} bands", vrt.bands.len());
        return Err(rejected(&context, cause));
    };
    if band.sources.is_empty() {
        return Err(rejected(&context, "has no sources".to_string()));
    }
    let mut files = Vec::with_capacity(band.sources.len());
    for source in band.sources.iter().rev() {
        let reader = HeightReader::open(&source.path)?;
        if let Some(cause) = complaint(&vrt, band, source, &reader)? {
            let cause = format!("line {}: {cause}", source.line);
            return Err(rejected(&context, cause));
        }
        files.push(source.path.clone());
    }
    Ok(files)
}

/// An unsupported operation that the raster applies to a file.
fn complaint<R: std::io::BufRead + std::io::Seek>(
    vrt: &Vrt,
    band: &VrtBand,
    source: &VrtSource,
    reader: &HeightReader<R>,
) -> Result<Option<String>, HeightFileError> {
    let name = source.path.display();
    let (header, said) = (&reader.header, &reader.said);
    let stored = (f64::from(header.columns), f64::from(header.rows));
    let is_whole = match source.from {
        None => true,
        Some(from) => from == [0.0, 0.0, stored.0, stored.1],
    };
    if source.band != Some(1) {
        return Ok(Some(format!("takes another band than the first of {name}")));
    }
    if !is_whole {
        return Ok(Some(format!("takes a part of {name}")));
    }
    if !source.is_plain() {
        return Ok(Some(format!("scales {name}")));
    }
    let own = (said.scale.or(header.scale), said.offset.or(header.offset));
    let scale = |own: Option<f64>, of_band: Option<f64>, plain: f64| {
        of_band.is_none_or(|of_band| of_band == own.unwrap_or(plain))
    };
    if !scale(own.0, band.scale, 1.0) || !scale(own.1, band.offset, 0.0) {
        return Ok(Some(format!("has another scale or offset than {name}")));
    }
    // The band's own no-data value applies where no file exists.
    if let Some(no_data) = source.no_data
        && !reader.conversion()?.is_missing(no_data)
    {
        return Ok(Some(format!(
            "takes {no_data} of {name} for no data, and the file does not: write nodata = {no_data} into its sidecar or a folder.toml beside it"
        )));
    }
    // For projected files, the raster's numbers are projected coordinates.
    let (None, Some(grid)) = (&header.warp, vrt.grid) else {
        return Ok(None);
    };
    let place = reader.georeference()?;
    let to = source
        .to
        .unwrap_or([0.0, 0.0, f64::from(vrt.size.0), f64::from(vrt.size.1)]);
    let VrtGrid {
        west,
        north,
        column,
        row,
    } = grid;
    let step = (to[2] * column / stored.0, to[3] * row / stored.1);
    let first = (
        west + to[0] * column + 0.5 * step.0,
        north - to[1] * row - 0.5 * step.1,
    );
    let lon_rad = first.0.to_radians() - place.west_rad;
    // Modulo 360°.
    let east_rad = lon_rad - TAU * (lon_rad / TAU).round();
    let north_rad = first.1.to_radians() - place.north_rad;
    let span = |of_raster: f64, own: f64, count: f64| (of_raster.to_radians() - own).abs() * count;
    let is_there = east_rad.abs() <= MOST_MOVED * place.lon_step_rad
        && north_rad.abs() <= MOST_MOVED * place.lat_step_rad
        && span(step.0, place.lon_step_rad, stored.0) <= MOST_MOVED * place.lon_step_rad
        && span(step.1, place.lat_step_rad, stored.1) <= MOST_MOVED * place.lat_step_rad;
    Ok((!is_there).then(|| format!("places {name} where the file does not")))
}

fn rejected(context: &FileContext, cause: String) -> HeightFileError {
    context.rejected(
        cause,
        "a virtual raster of one band, whose files lie side by side as they are",
        format!(
            "`gdal_translate -co COMPRESS=DEFLATE -co TILED=YES {} OUT.tif`",
            context.path().display()
        ),
    )
}

fn vrt_error(context: &FileContext, error: VrtError) -> HeightFileError {
    match error {
        VrtError::Unreadable(error) => context.reading(error),
        VrtError::Damaged { .. } => context.damaged(error),
        VrtError::Unsupported { .. } => rejected(context, error.to_string()),
    }
}
