//! Samples of a file that does not state its coordinate system: ASCII grids, world files, and GeoTIFF tags without keys.

use super::error::FileContext;
use super::{Header, HeightFileError};
use crate::elevation::aux_xml::{AUX_BYTES, element, plain};
use crate::elevation::geoid::VerticalDatum;
use crate::elevation::projection::Projection;
use crate::elevation::warp::{AROUND, ProjectedGrid, Warp};
use crate::elevation::wkt::{MAX_WKT_BYTES, TextSystem, system_of};
use crate::elevation::world_file::{WORLD_FILE_BYTES, WorldFile};
use crate::elevation::{Georeference, Registration};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use terrella_files as files;

/// Samples at equal steps from the first of the first row, in degrees or in metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlainGrid {
    pub columns: u32,
    pub rows: u32,
    /// Centre of the first cell, or the first post.
    pub left: f64,
    pub top: f64,
    /// Step from column to column, positive.
    pub column: f64,
    /// Step from row to row, to the south; negative where the southern row comes first.
    pub row: f64,
    pub registration: Registration,
    /// Whether its numbers need a stated system and are never assumed to be degrees.
    pub needs_system: bool,
}

impl PlainGrid {
    /// The grid of the world file beside a raster of this size, if there is one.
    pub fn beside(
        raster: &Path,
        (columns, rows): (u32, u32),
    ) -> Result<Option<Self>, HeightFileError> {
        let Some(path) = WorldFile::beside(raster) else {
            return Ok(None);
        };
        let context = FileContext::new(&path);
        let text = files::read(&path, WORLD_FILE_BYTES);
        let text = text.map_err(|error| context.unreadable(error))?;
        let world = match text {
            Some(text) => WorldFile::of_text(&String::from_utf8_lossy(&text)),
            None => Err(format!("has more than {WORLD_FILE_BYTES} bytes")),
        };
        let remedy = "correct it, or warp the file beside it (`gdalwarp -t_srs EPSG:4326`)";
        let rejected = |cause: String| context.rejected(cause, "six numbers", remedy);
        let world = world.map_err(rejected)?;
        if !(world.column > 0.0 && world.row != 0.0) {
            let cause = "runs from east to west, or has steps of no size".to_string();
            return Err(rejected(cause));
        }
        Ok(Some(Self {
            columns,
            rows,
            left: world.x,
            top: world.y,
            column: world.column,
            row: world.row,
            registration: Registration::Cells,
            needs_system: false,
        }))
    }
}

impl Header {
    /// Places a plain grid in a system; without one, only if its numbers can be degrees.
    pub(super) fn settle(
        &mut self,
        system: Option<TextSystem>,
        context: &FileContext,
    ) -> Result<(), HeightFileError> {
        let Some(grid) = self.plain else {
            return Ok(());
        };
        if let Some(TextSystem::Degrees { with_height: true }) = system {
            self.above.get_or_insert(VerticalDatum::Ellipsoid);
        }
        // Half a cell beyond the limits on all sides is accepted.
        let margin = match grid.registration {
            Registration::Cells => 0.5,
            Registration::Posts => 0.0,
        };
        let projection = match system {
            Some(TextSystem::Projected(projection)) => Some(projection),
            Some(TextSystem::WebMercator) => Projection::of_code(3857),
            Some(TextSystem::Degrees { .. }) => None,
            None if grid.needs_system => {
                return Err(context.rejected(
                    "does not state its coordinate system",
                    "GeoTIFF keys of latitude and longitude, or a .prj file beside it",
                    format!(
                        "if it is so, `gdal_translate -a_srs EPSG:4326 {} OUT.tif`",
                        context.path().display()
                    ),
                ));
            }
            None => None,
        };
        if let Some(projection) = projection {
            let projected = ProjectedGrid {
                projection,
                columns: grid.columns,
                rows: grid.rows,
                east_m: grid.left,
                north_m: grid.top,
                column_m: grid.column,
                row_m: grid.row,
                margin,
            };
            let warp = Warp::beyond(projected, AROUND);
            let warp = warp.map_err(|cause| context.unwarped(cause))?;
            self.georeference = Some(warp.place);
            self.warp = Some(warp);
            return Ok(());
        }
        let last = grid.top - f64::from(grid.rows.saturating_sub(1)) * grid.row;
        let (south, north) = (last.min(grid.top), last.max(grid.top));
        let row = grid.row.abs();
        let is_degrees = grid.left.abs() <= 361.0
            && grid.column <= 360.0
            && north <= 90.0 + row
            && south >= -90.0 - row;
        if !is_degrees {
            return Err(context.rejected(
                format!(
                    "has its first sample at {} {}, which are no degrees, and nothing says in which coordinate system",
                    grid.left, grid.top
                ),
                "degrees, or a .prj file beside it",
                format!("`gdalwarp -s_srs EPSG:CODE -t_srs EPSG:4326 {} OUT.tif`", context.path().display()),
            ));
        }
        self.is_south_first = grid.row < 0.0;
        self.georeference = Some(Georeference {
            columns: grid.columns,
            rows: grid.rows,
            registration: grid.registration,
            north_rad: north.to_radians(),
            lat_step_rad: row.to_radians(),
            west_rad: grid.left.to_radians(),
            lon_step_rad: grid.column.to_radians(),
        });
        Ok(())
    }
}

/// Possible names of the text with a file's coordinate system.
pub(super) fn prj_of(path: &Path) -> [PathBuf; 2] {
    ["prj", "PRJ"].map(|ending| path.with_extension(ending))
}

/// The system stated in a text beside a file: `NAME.prj`, or `NAME.asc.aux.xml`.
pub(super) fn system_beside(path: &Path) -> Result<Option<TextSystem>, HeightFileError> {
    let read = |file: &Path, most: u64| match files::read(file, most) {
        Ok(Some(bytes)) => Ok(Some(String::from_utf8_lossy(&bytes).into_owned())),
        Ok(None) => Err(FileContext::new(file).rejected(
            format!("has more than {most} bytes"),
            "the name of a coordinate system",
            "write it again",
        )),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(FileContext::new(file).unreadable(error)),
    };
    let named = |file: &Path, text: &str| {
        let system = system_of(text);
        system.map(Some).map_err(|cause| {
            FileContext::new(file).rejected(
                cause,
                "degrees, UTM, polar stereographic or conformal conic metres of WGS84",
                format!(
                    "`gdalwarp -t_srs EPSG:4326 -r bilinear {} OUT.tif`",
                    path.display()
                ),
            )
        })
    };
    for file in prj_of(path) {
        if let Some(text) = read(&file, MAX_WKT_BYTES)? {
            return named(&file, &text);
        }
    }
    let file = super::beside::aux_of(path);
    let text = read(&file, AUX_BYTES)?.unwrap_or_default();
    match element(&text, "SRS") {
        Some(system) => named(&file, &plain(system)),
        None => Ok(None),
    }
}
