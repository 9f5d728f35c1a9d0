//! Where a file of a mosaic lies: by its description, its GeoTIFF tags, its world file or NASA's names.

use super::place::{Bounds, Crs, Place, place_in_name};
use crate::elevation::geo_tags::{GeoTags, MODEL_TYPE};
use crate::files;
use crate::imagery::build::error::BuildError;
use crate::imagery::build::source::{FileContext, MODEL_GEOGRAPHIC};
use std::io::{BufRead, BufReader, Read, Seek};
use std::path::{Path, PathBuf};
use tiff::decoder::Decoder;

const MODEL_PROJECTED: u16 = 1;
/// Key of the projected coordinate system, and Web Mercator's number.
const PROJECTED_TYPE: u16 = 3072;
const WEB_MERCATOR: u16 = 3857;

/// Metres of Web Mercator for a degree of longitude: π·6 378 137 / 180.
const METRES_PER_DEG: f64 = std::f64::consts::PI * 6_378_137.0 / 180.0;

/// Largest world file, bytes.
const WORLD_FILE_BYTES: u64 = 4096;

const ADVICE: &str = "warp it (`gdalwarp -t_srs EPSG:4326`)";

/// Where a file of so many texels lies.
pub(super) fn place_of(
    path: &Path,
    given: Option<(Crs, Bounds)>,
    size: (u32, u32),
) -> Result<Place, BuildError> {
    let context = FileContext::new(path);
    let found = match given {
        Some((crs, bounds)) => Some(Place::from_bounds(crs, &bounds, size)),
        None => match of_tags(path)? {
            Some(place) => Some(place),
            None => match of_world_file(path)? {
                Some(place) => Some(place),
                None => of_name(path, size),
            },
        },
    };
    let Some(place) = found else {
        return Err(context.refused(
            "does not say where it lies (no GeoTIFF tags, no world file, no name of NASA's like NAME.A1.jpg)",
            "describe the mosaic in a TOML file and give its bounds_deg = [west, south, east, north]",
        ));
    };
    match place.complaint(size) {
        None => Ok(place),
        Some(complaint) => {
            Err(context.refused(complaint, "correct its bounds, tags or world file"))
        }
    }
}

/// By the tags of a GeoTIFF; other files and TIFFs without tags have none.
fn of_tags(path: &Path) -> Result<Option<Place>, BuildError> {
    let context = FileContext::new(path);
    let file = files::open(path).map_err(|error| context.unreadable(error))?;
    tags_place(BufReader::new(file)).map_err(|complaint| context.refused(complaint, ADVICE))
}

/// What the tags of a TIFF say, or why it cannot be used.
pub(super) fn tags_place<R: BufRead + Seek>(mut reader: R) -> Result<Option<Place>, String> {
    let mut magic = [0; 4];
    let is_tiff = reader.read_exact(&mut magic).is_ok()
        && matches!(magic, [b'I', b'I', 42 | 43, 0] | [b'M', b'M', 0, 42 | 43]);
    if !is_tiff || reader.rewind().is_err() {
        return Ok(None);
    }
    // What is wrong with the file is told by its reader.
    let Ok(mut decoder) = Decoder::new(reader) else {
        return Ok(None);
    };
    let tags = GeoTags::read(&mut decoder);
    let Some(grid) = tags.grid()? else {
        return Ok(None);
    };
    let (crs, unit) = match (tags.key(MODEL_TYPE), tags.key(PROJECTED_TYPE)) {
        (Some(MODEL_PROJECTED), Some(WEB_MERCATOR)) => (Crs::WebMercator, METRES_PER_DEG),
        (Some(MODEL_GEOGRAPHIC) | None, _) => (Crs::Geographic, 1.0),
        (model, projected) => {
            let number = projected.or(model).unwrap_or_default();
            return Err(format!(
                "lies in another coordinate system (by its GeoTIFF key {number}) than EPSG:4326 and EPSG:3857"
            ));
        }
    };
    Ok(Some(Place {
        crs,
        west_deg: grid.left / unit,
        north_deg: grid.top / unit,
        column_deg: grid.scale_x / unit,
        row_deg: grid.scale_y / unit,
    }))
}

/// By the world file beside it: `.tfw`, `.jgw`, `.pgw`, or `.wld`. Those of Web Mercator are known by numbers beyond degrees.
fn of_world_file(path: &Path) -> Result<Option<Place>, BuildError> {
    let Some(file) = world_files(path).into_iter().find(|file| file.is_file()) else {
        return Ok(None);
    };
    let context = FileContext::new(&file);
    let mut text = String::new();
    let opened = files::open(&file).map_err(|error| context.unreadable(error))?;
    opened
        .take(WORLD_FILE_BYTES)
        .read_to_string(&mut text)
        .map_err(|error| context.refused(error.to_string(), "give six numbers, a line each"))?;
    world_place(&text)
        .map(Some)
        .map_err(|cause| context.refused(cause, ADVICE))
}

/// What a world file may be called: two letters of the map's ending and w, the ending and w, or wld.
fn world_files(path: &Path) -> Vec<PathBuf> {
    let ending = path
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let mut letters = ending.chars();
    let mut names = vec![format!("{ending}w"), "wld".to_string()];
    if let (Some(first), Some(last)) = (letters.next(), letters.next_back()) {
        names.insert(0, format!("{first}{last}w"));
    }
    names.iter().map(|name| path.with_extension(name)).collect()
}

/// Where a world file says that its map lies: sizes and turns of a texel, then the centre of the first one.
///
/// # Errors
/// What is wrong with it.
pub fn world_place(text: &str) -> Result<Place, String> {
    let numbers: Vec<f64> = text
        .split_whitespace()
        .map_while(|word| word.parse().ok())
        .collect();
    let [column, turn_y, turn_x, row, x, y] = numbers.as_slice() else {
        return Err(format!("has {} numbers and must have six", numbers.len()));
    };
    if *turn_x != 0.0 || *turn_y != 0.0 {
        return Err("turns its map (its second and third number are not 0)".to_string());
    }
    // No longitude is beyond 360 degrees, and no map of Web Mercator has its corner within 360 m of the origin's.
    let is_metric = x.abs() > 361.0 || y.abs() > 91.0 || column.abs() > 361.0;
    let (crs, unit) = if is_metric {
        (Crs::WebMercator, METRES_PER_DEG)
    } else {
        (Crs::Geographic, 1.0)
    };
    Ok(Place {
        crs,
        west_deg: (x - 0.5 * column) / unit,
        north_deg: (y - 0.5 * row) / unit,
        column_deg: column / unit,
        row_deg: -row / unit,
    })
}

/// By NASA's names of eight parts.
fn of_name(path: &Path, size: (u32, u32)) -> Option<Place> {
    let stem = path.file_stem()?.to_string_lossy();
    let bounds = place_in_name(&stem)?;
    // A part is a square.
    (size.0 == size.1).then(|| Place::from_bounds(Crs::Geographic, &bounds, size))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn world_files_are_read_and_turned_ones_refused() {
        let place = world_place("0.5\n0\n0\n-0.25\n-179.75\n89.875\n").expect("good");
        assert_eq!((place.west_deg, place.north_deg), (-180.0, 90.0));
        assert_eq!(
            (place.column_deg, place.row_deg, place.crs),
            (0.5, 0.25, Crs::Geographic)
        );
        let metric = world_place("1000 0 0 -1000 500 5000500").expect("good");
        assert_eq!(metric.crs, Crs::WebMercator);
        assert!((metric.north_deg - 5_001_000.0 / METRES_PER_DEG).abs() < 1e-9);
        assert!(world_place("0.5\n0.1\n0\n-0.5\n0\n0").is_err_and(|said| said.contains("turns")));
        for bad in ["", "1 2 3", "1 0 0 -1 5 x", "1 0 0 -1 5 5 5"] {
            assert!(
                world_place(bad).is_err_and(|said| said.contains("six")),
                "{bad}"
            );
        }
    }

    #[test]
    fn world_files_have_their_usual_names() {
        let names = world_files(Path::new("d/a.tif"));
        assert_eq!(names, ["d/a.tfw", "d/a.tifw", "d/a.wld"].map(PathBuf::from));
        let names = world_files(Path::new("a.jpeg"));
        assert_eq!(names[0], Path::new("a.jgw"));
        assert_eq!(
            world_files(Path::new("a")),
            ["a.w", "a.wld"].map(PathBuf::from)
        );
    }
}
