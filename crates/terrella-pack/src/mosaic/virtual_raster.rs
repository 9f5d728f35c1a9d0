//! GDAL's virtual rasters as mosaics: each file, or a window of it, where the raster places it.

use super::description::{Description, MAX_PARTS, Part, PartSource};
use super::georeference::METRES_PER_DEG;
use super::place::{Crs, RasterPlacement, Window};
use crate::error::BuildError;
use crate::source::{FileContext, RowSource, SourceInfo};
use std::path::Path;
use terrella_ground::elevation::vrt::{Vrt, VrtBand, VrtError, VrtGrid, VrtSource};
use terrella_ground::elevation::wkt::{TextSystem, system_of};

impl Description {
    /// Reads a virtual raster.
    ///
    /// # Errors
    /// [`BuildError`] with the line, also for operations of a raster other than placing and cropping its files.
    pub(super) fn of_vrt(path: &Path) -> Result<Self, BuildError> {
        let context = FileContext::new(path);
        let vrt = Vrt::open(path).map_err(|error| match error {
            VrtError::Unreadable(error) => context.unreadable(error),
            VrtError::Damaged { .. } => context.damaged(error),
            VrtError::Unsupported { .. } => rejected(&context, error.to_string()),
        })?;
        let parts = parts_of(&vrt).map_err(|cause| rejected(&context, cause))?;
        Ok(Self {
            parts,
            ..Self::default()
        })
    }
}

fn rejected(context: &FileContext, cause: String) -> BuildError {
    context.rejected(
        cause,
        "write it out (`gdal_translate -co COMPRESS=DEFLATE -co TILED=YES IN.vrt OUT.tif`)",
    )
}

fn parts_of(vrt: &Vrt) -> Result<Vec<Part>, String> {
    let (crs, unit) = match vrt.system.as_deref() {
        None => (Crs::Geographic, 1.0),
        Some("EPSG:4326") => (Crs::Geographic, 1.0),
        Some("EPSG:3857") => (Crs::WebMercator, METRES_PER_DEG),
        Some(text) => match system_of(text)? {
            TextSystem::Degrees { .. } => (Crs::Geographic, 1.0),
            TextSystem::WebMercator => (Crs::WebMercator, METRES_PER_DEG),
            TextSystem::Projected(_) => {
                return Err("lies in a projection other than Web Mercator".to_string());
            }
        },
    };
    let grid = vrt.grid.ok_or("has no GeoTransform")?;
    // A last band that is the masks or alphas of the files: they count anyway.
    let is_alpha = |band: &VrtBand| {
        let sources = &band.sources;
        !sources.is_empty() && sources.iter().all(|source| source.band.is_none())
    };
    let bands: Vec<_> = vrt.bands.iter().filter(|band| !is_alpha(band)).collect();
    let Some((first, others)) = bands.split_first().filter(|_| bands.len() <= 4) else {
        return Err(format!("has {} bands", vrt.bands.len()));
    };
    if bands
        .iter()
        .any(|band| band.scale.is_some_and(|n| n != 1.0) || band.offset.is_some_and(|n| n != 0.0))
    {
        return Err("has a scale or an offset".to_string());
    }
    if first.sources.is_empty() || first.sources.len() > MAX_PARTS {
        return Err(format!(
            "has {} sources in a band, and a mosaic has 1 to {MAX_PARTS} parts",
            first.sources.len()
        ));
    }
    let part = |(n, source): (usize, &VrtSource)| {
        let wrong =
            |cause: &str| format!("line {}: {cause} {}", source.line, source.path.display());
        let mut no_data: Vec<_> = source.no_data.into_iter().collect();
        for (band, number) in bands.iter().zip(1..) {
            let same = band.sources.get(n).filter(|same| {
                (&same.path, same.from, same.to) == (&source.path, source.from, source.to)
            });
            let same = same.ok_or_else(|| wrong("has other sources in other bands than"))?;
            if same.band != Some(number) {
                return Err(wrong("puts the bands into another order than"));
            }
            if !same.is_plain() {
                return Err(wrong("scales"));
            }
            if number > 1 {
                no_data.extend(same.no_data);
            }
        }
        if no_data.len() > 1 && no_data.len() != bands.len() {
            return Err(wrong("has no-data values for some of the bands of"));
        }
        let from = placed(source, vrt.size, &grid, (crs, unit)).map_err(|cause| wrong(&cause))?;
        Ok(Part {
            no_data: Some(no_data).filter(|all| !all.is_empty()),
            ..Part::plain(from)
        })
    };
    if others
        .iter()
        .any(|band| band.sources.len() != first.sources.len())
    {
        return Err("has bands of different sources".to_string());
    }
    first.sources.iter().enumerate().map(part).collect()
}

/// Position of a file in the raster.
fn placed(
    source: &VrtSource,
    size: (u32, u32),
    grid: &VrtGrid,
    (crs, unit): (Crs, f64),
) -> Result<PartSource, String> {
    let to = source
        .to
        .unwrap_or([0.0, 0.0, f64::from(size.0), f64::from(size.1)]);
    let (from, window) = match (source.from, source.size) {
        (Some(from), _) if source.is_whole() && source.size.is_some() => (from, None),
        (Some(from), _) => (from, Some(window(from)?)),
        (None, Some((columns, rows))) => ([0.0, 0.0, f64::from(columns), f64::from(rows)], None),
        (None, None) => return Err("does not say the size of".to_string()),
    };
    let place = RasterPlacement {
        crs,
        west_deg: (grid.west + to[0] * grid.column) / unit,
        north_deg: (grid.north - to[1] * grid.row) / unit,
        column_deg: grid.column * to[2] / from[2] / unit,
        row_deg: grid.row * to[3] / from[3] / unit,
    };
    Ok(PartSource::Placed(source.path.clone(), place, window))
}

/// Whole texels.
fn window(from: [f64; 4]) -> Result<Window, String> {
    let whole = |number: f64| match number >= 0.0 && number.fract() == 0.0 && number < 4e9 {
        // Below 2^32.
        true => Ok(number as u32),
        false => Err("takes parts of texels of".to_string()),
    };
    let [x, y, columns, rows] = from;
    Ok(Window {
        first: (whole(x)?, whole(y)?),
        size: (whole(columns)?, whole(rows)?),
    })
}

/// A window of a file's rows.
pub(super) struct WindowRows {
    rows: Box<dyn RowSource>,
    window: Window,
    given: u32,
    /// A whole row.
    row: Vec<u8>,
}

impl WindowRows {
    /// Rejects a window that reaches beyond its file.
    pub(super) fn new(
        rows: Box<dyn RowSource>,
        window: Window,
        context: &FileContext,
    ) -> Result<Self, BuildError> {
        let info = rows.info();
        let end = |first: u32, size: u32| u64::from(first) + u64::from(size);
        if end(window.first.0, window.size.0) > u64::from(info.width)
            || end(window.first.1, window.size.1) > u64::from(info.height)
            || window.size.0 == 0
            || window.size.1 == 0
        {
            return Err(context.rejected(
                format!(
                    "has {} x {} texels, fewer than the .vrt takes",
                    info.width, info.height
                ),
                "make the .vrt again (`gdalbuildvrt`)",
            ));
        }
        Ok(Self {
            row: vec![0; info.row_bytes()],
            rows,
            window,
            given: 0,
        })
    }
}

impl RowSource for WindowRows {
    fn info(&self) -> SourceInfo {
        let info = self.rows.info();
        SourceInfo {
            width: self.window.size.0,
            height: self.window.size.1,
            buffer_bytes: info.buffer_bytes + self.row.len() as u64,
            ..info
        }
    }

    fn colour_note(&self) -> Option<String> {
        self.rows.colour_note()
    }

    fn notes(&mut self) -> Vec<String> {
        self.rows.notes()
    }

    fn next_row(&mut self, row: &mut [u8]) -> Result<(), BuildError> {
        while self.given < self.window.first.1 {
            self.rows.next_row(&mut self.row)?;
            self.given += 1;
        }
        self.rows.next_row(&mut self.row)?;
        self.given += 1;
        let info = self.rows.info();
        let start = self.window.first.0 as usize * info.channels * info.sample.bytes();
        row.copy_from_slice(&self.row[start..start + row.len()]);
        Ok(())
    }
}
