//! Position of a mosaic's file: from its description, its GeoTIFF tags, its world file or NASA's file names; and the coordinate system of its
//! numbers.
//!
//! A coordinate system is never guessed: numbers that can be degrees are degrees. All others must be declared as metres of Web Mercator, by the
//! description, by the tags or by a text beside the file.

use super::held::Turn;
use super::place::{Bounds, Crs, RasterPlacement, place_in_name};
use crate::error::BuildError;
use crate::source::{FileContext, TagGrid, grid_of, in_other_system};
use std::io::{BufRead, BufReader, Read, Seek};
use std::path::{Path, PathBuf};
use terrella_files as files;
use terrella_ground::elevation::geo_tags::{GeoTags, System};
use terrella_ground::elevation::projection::Projection;
use terrella_ground::elevation::warp::{ProjectedGrid, Warp};
use terrella_ground::elevation::wkt::{MAX_WKT_BYTES, TextSystem, system_of as system_in};
use terrella_ground::elevation::world_file::{WORLD_FILE_BYTES, WorldFile};
use tiff::decoder::Decoder;

/// Metres of Web Mercator for a degree of longitude: π·6 378 137 / 180.
pub(super) const METRES_PER_DEG: f64 = std::f64::consts::PI * 6_378_137.0 / 180.0;

const ADVICE: &str = "warp it (`gdalwarp -t_srs EPSG:4326`)";

/// The described position of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stated {
    /// The system of its rows, or of the numbers of its world file.
    pub crs: Option<Crs>,
    /// Its edges.
    pub bounds: Option<Bounds>,
}

/// Position of a file of this size, and the transformation of its rows to that position.
pub(super) fn place_of(
    path: &Path,
    stated: Stated,
    size: (u32, u32),
) -> Result<(RasterPlacement, Turn), BuildError> {
    let context = FileContext::new(path);
    let found = match stated.bounds {
        Some(bounds) => {
            let crs = stated.crs.unwrap_or_default();
            Some((RasterPlacement::from_bounds(crs, &bounds, size), Turn::None))
        }
        None => of_file(path, stated.crs, size)?,
    };
    let Some((place, turn)) = found else {
        return Err(context.rejected(
            "has no georeference (no GeoTIFF tags, no world file, no name of NASA's like NAME.A1.jpg)",
            "describe the mosaic in a TOML file and give its bounds_deg = [west, south, east, north]",
        ));
    };
    let size = match &turn {
        Turn::Warped(warp) => (warp.place.columns, warp.place.rows),
        _ => size,
    };
    match place.complaint(size) {
        None => Ok((place, turn)),
        Some(complaint) => {
            Err(context.rejected(complaint, "correct its bounds, tags or world file"))
        }
    }
}

/// Rejects a map of the whole Earth that is said to be something else by the files beside it. Its own tags are its reader's matter.
pub(crate) fn check_whole_earth(
    path: &Path,
    (width, height): (u32, u32),
) -> Result<(), BuildError> {
    let context = FileContext::new(path);
    let said = of_text(path)?;
    if matches!(said, Some(SaidBeside::Projected(_))) {
        return Err(context.rejected("is projected by the text beside it", ADVICE));
    }
    if said == Some(SaidBeside::Crs(Crs::WebMercator)) {
        return Err(context.rejected("is projected (EPSG:3857 by the text beside it)", ADVICE));
    }
    let Some(grid) = of_world_file(path)? else {
        return Ok(());
    };
    match grid.complaint(width, height, "its world file") {
        None => Ok(()),
        Some(complaint) => Err(context.rejected(
            complaint,
            "warp it to the whole globe (`gdalwarp -t_srs EPSG:4326 -te -180 -90 180 90`), or give it as a part of a mosaic",
        )),
    }
}

/// Georeference from a file itself, and from the files beside it.
fn of_file(
    path: &Path,
    stated: Option<Crs>,
    size: (u32, u32),
) -> Result<Option<(RasterPlacement, Turn)>, BuildError> {
    let context = FileContext::new(path);
    let rejected = |complaint: String| context.rejected(complaint, ADVICE);
    let file = files::open(path).map_err(|error| context.unreadable(error))?;
    let tags = tags_of(BufReader::new(file));
    let projection = tags.projection().filter(|_| tags.system().is_err());
    let (said, projection) = match (projection, tags.system()) {
        (Some(projection), _) => (None, Some(projection)),
        (None, Err(system)) => return Err(rejected(in_other_system(&system))),
        (None, Ok(Some(system))) => (Some(system), None),
        (None, Ok(None)) => match of_text(path)? {
            Some(SaidBeside::Projected(projection)) => (None, Some(projection)),
            Some(SaidBeside::Crs(crs)) => (Some(system_of(crs)), None),
            None => (None, None),
        },
    };
    if let (Some(_), Some(stated)) = (projection, stated) {
        return Err(context.rejected(
            format!(
                "lies in a projection by its tags or the text beside it, and in {} by its [[part]]",
                stated.name()
            ),
            "correct crs, or leave it out",
        ));
    }
    let system = agreed(said, stated, &context)?;
    let grid = match grid_of(&tags).map_err(rejected)? {
        Some(grid) => Some(grid),
        None => of_world_file(path)?,
    };
    if let Some(projection) = projection {
        return match grid {
            Some(grid) => warped(projection, grid, size, &context).map(Some),
            None => Ok(None),
        };
    }
    let (grid, turn) = match grid {
        Some(grid) if grid.scale_y < 0.0 => (Some(grid.north_up(size.1)), Turn::SouthFirst),
        grid => (grid, Turn::None),
    };
    match (grid, system) {
        (Some(grid), system) => match placed(grid, system) {
            Ok(place) => Ok(Some((place, turn))),
            Err(cause) => Err(context.rejected(cause, metric_advice())),
        },
        // Names are of degrees.
        (None, Some(System::WebMercator)) => Ok(None),
        (None, _) => Ok(of_name(path, size).map(|place| (place, Turn::None))),
    }
}

/// Position of a projected grid after warping.
fn warped(
    projection: Projection,
    grid: TagGrid,
    (columns, rows): (u32, u32),
    context: &FileContext,
) -> Result<(RasterPlacement, Turn), BuildError> {
    if !(grid.scale_x > 0.0 && grid.scale_y != 0.0) {
        return Err(context.rejected("runs from east to west, or has texels of no size", ADVICE));
    }
    let warp = Warp::of(ProjectedGrid {
        projection,
        columns,
        rows,
        east_m: grid.left + 0.5 * grid.scale_x,
        north_m: grid.top - 0.5 * grid.scale_y,
        column_m: grid.scale_x,
        row_m: grid.scale_y,
        margin: 0.5,
    });
    let warp = warp.map_err(|cause| context.rejected(cause, ADVICE))?;
    let place = &warp.place;
    let (column_deg, row_deg) = (
        place.lon_step_rad.to_degrees(),
        place.lat_step_rad.to_degrees(),
    );
    let raster = RasterPlacement {
        crs: Crs::Geographic,
        west_deg: place.west_rad.to_degrees() - 0.5 * column_deg,
        north_deg: place.north_rad.to_degrees() + 0.5 * row_deg,
        column_deg,
        row_deg,
    };
    Ok((raster, Turn::Warped(warp)))
}

fn metric_advice() -> String {
    format!(
        "if they are metres of Web Mercator, add crs = {:?} to its [[part]] or put a .prj beside it that says so; else {ADVICE}",
        Crs::WebMercator.name()
    )
}

/// The tags of a TIFF; a file of another format, or an unreadable one, has none: its reader reports the error.
fn tags_of<R: BufRead + Seek>(mut reader: R) -> GeoTags {
    let mut magic = [0; 4];
    let is_tiff = reader.read_exact(&mut magic).is_ok()
        && matches!(magic, [b'I', b'I', 42 | 43, 0] | [b'M', b'M', 0, 42 | 43]);
    if !is_tiff || reader.rewind().is_err() {
        return GeoTags::default();
    }
    let tags = Decoder::new(reader).map(|mut decoder| GeoTags::read(&mut decoder));
    tags.unwrap_or_default()
}

fn system_of(crs: Crs) -> System {
    match crs {
        Crs::WebMercator => System::WebMercator,
        Crs::Geographic => System::Geographic {
            unit_rad: 1f64.to_radians(),
            is_named: true,
        },
    }
}

/// The georeference of a file, or of its description; they must not contradict each other.
fn agreed(
    said: Option<System>,
    stated: Option<Crs>,
    context: &FileContext,
) -> Result<Option<System>, BuildError> {
    let is_mercator = |system: System| system == System::WebMercator;
    match (said, stated.map(system_of)) {
        (Some(said), Some(stated)) if is_mercator(said) != is_mercator(stated) => {
            let of = |system| match is_mercator(system) {
                true => Crs::WebMercator.name(),
                false => Crs::Geographic.name(),
            };
            Err(context.rejected(
                format!(
                    "lies in {} by its tags or the text beside it, and in {} by its [[part]]",
                    of(said),
                    of(stated)
                ),
                "correct crs, or leave it out",
            ))
        }
        (said, stated) => Ok(said.or(stated)),
    }
}

/// Position of a grid in a coordinate system.
fn placed(grid: TagGrid, system: Option<System>) -> Result<RasterPlacement, String> {
    let (crs, unit) = match system {
        Some(System::WebMercator) => (Crs::WebMercator, METRES_PER_DEG),
        Some(System::Geographic { unit_rad, .. }) => {
            (Crs::Geographic, 1f64.to_radians() / unit_rad)
        }
        None if can_be_degrees(&grid) => (Crs::Geographic, 1.0),
        None => {
            return Err(format!(
                "has its corner at {:?} {:?}, which are no degrees, and does not say in which coordinate system",
                grid.left, grid.top
            ));
        }
    };
    if grid.scale_y < 0.0 {
        return Err("runs from south to north".to_string());
    }
    let grid = grid.in_units_of(unit);
    Ok(RasterPlacement {
        crs,
        west_deg: grid.left,
        north_deg: grid.top,
        column_deg: grid.scale_x,
        row_deg: grid.scale_y,
    })
}

/// No longitude is beyond 360 degrees and no latitude beyond 90; half a texel on all sides.
fn can_be_degrees(grid: &TagGrid) -> bool {
    grid.left.abs() <= 361.0 && grid.top.abs() <= 91.0 && grid.scale_x.abs() <= 361.0
}

/// Coordinate system according to the text beside the file.
#[derive(PartialEq)]
enum SaidBeside {
    Crs(Crs),
    Projected(Projection),
}

/// By the text beside it: `.prj`, or the `.aux.xml` of GDAL.
fn of_text(path: &Path) -> Result<Option<SaidBeside>, BuildError> {
    let prj = ["prj", "PRJ"].map(|ending| path.with_extension(ending));
    let prj = prj.into_iter().find(|file| file.is_file());
    if let Some(file) = prj {
        return crs_in(&file, &text_of(&file, MAX_WKT_BYTES)?).map(Some);
    }
    let mut aux = path.as_os_str().to_owned();
    aux.push(".aux.xml");
    let aux = PathBuf::from(aux);
    if !aux.is_file() {
        return Ok(None);
    }
    let text = text_of(&aux, 16 * MAX_WKT_BYTES)?;
    let system = text
        .split_once("<SRS")
        .and_then(|(_, rest)| rest.split_once('>'));
    let system = system.and_then(|(_, rest)| rest.split_once("</SRS>"));
    let system = system.map(|(text, _)| text.replace("&quot;", "\""));
    system.map(|text| crs_in(&aux, &text)).transpose()
}

fn crs_in(file: &Path, text: &str) -> Result<SaidBeside, BuildError> {
    match system_in(text) {
        Ok(TextSystem::Degrees { .. }) => Ok(SaidBeside::Crs(Crs::Geographic)),
        Ok(TextSystem::WebMercator) => Ok(SaidBeside::Crs(Crs::WebMercator)),
        Ok(TextSystem::Projected(projection)) => Ok(SaidBeside::Projected(projection)),
        Err(cause) => Err(FileContext::new(file).rejected(
            cause,
            "warp the map beside it (`gdalwarp -t_srs EPSG:4326`): those of EPSG:4326, EPSG:3857, UTM, polar stereographic and conformal \
             conic grids of WGS84 are taken",
        )),
    }
}

/// By the world file beside it: `.tfw`, `.jgw`, `.pgw`, or `.wld`.
fn of_world_file(path: &Path) -> Result<Option<TagGrid>, BuildError> {
    let Some(file) = WorldFile::beside(path) else {
        return Ok(None);
    };
    let grid = world_grid(&text_of(&file, WORLD_FILE_BYTES)?);
    grid.map(Some)
        .map_err(|cause| FileContext::new(&file).rejected(cause, ADVICE))
}

/// The text of a small file.
fn text_of(file: &Path, most_bytes: u64) -> Result<String, BuildError> {
    let context = FileContext::new(file);
    let opened = files::open(file).map_err(|error| context.unreadable(error))?;
    let mut bytes = Vec::new();
    opened
        .take(most_bytes)
        .read_to_end(&mut bytes)
        .map_err(|error| context.unreadable(error))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// The grid of a world file, whose coordinates are those of pixel centres.
fn world_grid(text: &str) -> Result<TagGrid, String> {
    let world = WorldFile::of_text(text)?;
    Ok(TagGrid {
        left: world.x - 0.5 * world.column,
        top: world.y + 0.5 * world.row,
        scale_x: world.column,
        scale_y: world.row,
    })
}

/// The position of a map according to its world file. Without a coordinate system its numbers must be degrees.
///
/// # Errors
/// The error in it.
pub fn world_place(text: &str, crs: Option<Crs>) -> Result<RasterPlacement, String> {
    placed(world_grid(text)?, crs.map(system_of))
}

/// From NASA's file names of eight parts.
fn of_name(path: &Path, size: (u32, u32)) -> Option<RasterPlacement> {
    let stem = path.file_stem()?.to_string_lossy();
    let bounds = place_in_name(&stem)?;
    // A part is a square.
    (size.0 == size.1).then(|| RasterPlacement::from_bounds(Crs::Geographic, &bounds, size))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn world_files_are_read_and_turned_ones_rejected() {
        let place = world_place("0.5\n0\n0\n-0.25\n-179.75\n89.875\n", None).expect("good");
        assert_eq!((place.west_deg, place.north_deg), (-180.0, 90.0));
        assert_eq!(
            (place.column_deg, place.row_deg, place.crs),
            (0.5, 0.25, Crs::Geographic)
        );
        let text = "1000 0 0 -1000 500 5000500";
        assert!(world_place(text, None).is_err_and(|said| said.contains("at 0.0 5001000.0")));
        let metric = world_place(text, Some(Crs::WebMercator)).expect("good");
        assert_eq!(metric.crs, Crs::WebMercator);
        assert!((metric.north_deg - 5_001_000.0 / METRES_PER_DEG).abs() < 1e-9);
        let wrong = |text: &str| world_place(text, None).expect_err(text);
        assert!(wrong("0.5\n0.1\n0\n-0.5\n0\n0").contains("turns"));
        assert!(wrong("0.5 0 0 0.5 0 0").contains("from south to north"));
        for bad in ["", "1 2 3", "1 0 0 -1 5 x", "1 0 0 -1 5 5 5"] {
            assert!(wrong(bad).contains("six"), "{bad}");
        }
    }
}
