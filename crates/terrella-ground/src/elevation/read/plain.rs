//! Cells of a file that does not say in which coordinate system its numbers are.

use super::error::FileContext;
use super::{Header, HeightFileError};
use crate::elevation::aux_xml::{AUX_BYTES, element, plain};
use crate::elevation::projection::Projection;
use crate::elevation::warp::{ProjectedGrid, Warp};
use crate::elevation::wkt::{MAX_WKT_BYTES, TextSystem, system_of};
use crate::elevation::{Georeference, Registration};
use std::io::ErrorKind;
use std::path::Path;
use terrella_files as files;

/// Cells at equal steps, by the middle of the north-western one, in degrees or in metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlainGrid {
    pub columns: u32,
    pub rows: u32,
    pub left: f64,
    pub top: f64,
    /// From column to column and from row to row, positive.
    pub column: f64,
    pub row: f64,
}

impl Header {
    /// Places a plain grid in a system, or without one, where its numbers can be degrees.
    pub(super) fn settle(
        &mut self,
        system: Option<TextSystem>,
        context: &FileContext,
    ) -> Result<(), HeightFileError> {
        let Some(grid) = self.plain else {
            return Ok(());
        };
        let projection = match system {
            Some(TextSystem::Projected(projection)) => Some(projection),
            Some(TextSystem::WebMercator) => Projection::of_code(3857),
            Some(TextSystem::Degrees) | None => None,
        };
        if let Some(projection) = projection {
            let warp = Warp::of(ProjectedGrid {
                projection,
                columns: grid.columns,
                rows: grid.rows,
                east_m: grid.left,
                north_m: grid.top,
                column_m: grid.column,
                row_m: grid.row,
                margin: 0.5,
            });
            let warp = warp.map_err(|cause| context.unwarped(cause))?;
            self.georeference = Some(warp.place);
            self.warp = Some(warp);
            return Ok(());
        }
        let south = grid.top - f64::from(grid.rows - 1) * grid.row;
        // Half a cell over on all sides.
        let is_degrees = grid.left.abs() <= 361.0
            && grid.column <= 360.0
            && grid.top <= 90.0 + grid.row
            && south >= -90.0 - grid.row;
        if !is_degrees {
            return Err(context.rejected(
                format!(
                    "has its first cell at {} {}, which are no degrees, and nothing says in which coordinate system",
                    grid.left, grid.top
                ),
                "degrees, or a .prj file beside it",
                format!("`gdalwarp -s_srs EPSG:CODE -t_srs EPSG:4326 {} OUT.tif`", context.path().display()),
            ));
        }
        self.georeference = Some(Georeference {
            columns: grid.columns,
            rows: grid.rows,
            registration: Registration::Cells,
            north_rad: grid.top.to_radians(),
            lat_step_rad: grid.row.to_radians(),
            west_rad: grid.left.to_radians(),
            lon_step_rad: grid.column.to_radians(),
        });
        Ok(())
    }
}

/// The system that a text beside a file names: `NAME.prj`, or `NAME.asc.aux.xml`.
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
    for ending in ["prj", "PRJ"] {
        let file = path.with_extension(ending);
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
