//! The description of a mosaic: a TOML file, or a folder of georeferenced maps.

use super::archive::is_archive;
use super::archive_part::archive_tiles;
use super::georeference::Stated;
use super::place::{Bounds, Crs, RasterPlacement, Window};
use super::row::AlphaMeans;
use super::texels::Encoding;
use super::tiles::{MAX_TILE_SIDE, TileSet};
use crate::error::BuildError;
use crate::source::{FileContext, MAX_PIECE_SIDE};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use terrella_files::{self as files, path_complaint, printable};
use terrella_ground::elevation::vrt::is_vrt;
use terrella_imagery::pack::{MAX_ATTRIBUTION_LINES, MAX_TEXT_CHARS};

/// Largest description, bytes.
pub const MAX_DESCRIPTION_BYTES: u64 = 4 << 20;

/// Most parts of a mosaic.
pub const MAX_PARTS: usize = 4096;

/// A folder with a file of this name is that mosaic: what `pack fetch` leaves.
pub const MOSAIC_FILE: &str = "mosaic.toml";

/// Name endings of maps in a folder.
const ENDINGS: [&str; 6] = ["png", "jpg", "jpeg", "tif", "tiff", "webp"];

/// The description of a mosaic, the lowest part first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Description {
    /// Its name in packs made from it; by default that of its file.
    pub name: Option<String>,
    /// Texels from 180° W to 180° E; by default as fine as the finest part.
    pub width: Option<u32>,
    /// Whose data it is, a line each.
    pub attribution: Vec<String>,
    /// Values stored where there is no part: one number, or one for each channel.
    pub fill: Option<Vec<f64>>,
    /// The parts.
    pub parts: Vec<Part>,
    /// The parts have no given order: the finest goes on top.
    pub is_unordered: bool,
}

/// A part of a mosaic.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Source of the part.
    pub from: PartSource,
    /// Width of the blend at its edges into the layer beneath, if there is one, degrees.
    pub feather_deg: f64,
    /// Its light is scaled, channel by channel, to the mean of the layer beneath it.
    pub is_matched: bool,
    /// Stored values that mark missing data: one, or one for each channel.
    pub no_data: Option<Vec<f64>>,
    /// Encoding of elevations as colours.
    pub encoding: Option<Encoding>,
    pub(crate) alpha: AlphaMeans,
}

impl Part {
    /// A part that lies over others without modification.
    pub(super) fn plain(from: PartSource) -> Self {
        Self {
            from,
            feather_deg: 0.0,
            is_matched: false,
            no_data: None,
            encoding: None,
            alpha: AlphaMeans::Presence,
        }
    }
}

/// Source of a part.
#[derive(Clone, Debug, PartialEq)]
pub enum PartSource {
    /// A file, and its described position.
    File(PathBuf, Stated),
    /// A file whose place is known, and the part of it that is used, if not all is.
    Placed(PathBuf, RasterPlacement, Option<Window>),
    /// Tiles, and their position.
    Tiles(TileSet, RasterPlacement),
}

impl PartSource {
    /// Its name in messages.
    pub fn name(&self) -> &Path {
        match self {
            Self::File(path, _) | Self::Placed(path, ..) => path,
            Self::Tiles(set, _) => &set.path,
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawDescription {
    name: Option<String>,
    width: Option<u32>,
    #[serde(default)]
    attribution: Vec<String>,
    fill: Option<Vec<f64>>,
    #[serde(default)]
    part: Vec<RawPart>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPart {
    file: Option<PathBuf>,
    tiles: Option<PathBuf>,
    crs: Option<Crs>,
    bounds_deg: Option<[f64; 4]>,
    tile_size: Option<u32>,
    tile_deg: Option<f64>,
    columns: Option<[u32; 2]>,
    rows: Option<[u32; 2]>,
    #[serde(default)]
    feather_deg: f64,
    #[serde(default)]
    match_colour: bool,
    no_data: Option<Vec<f64>>,
    encoding: Option<Encoding>,
}

/// The TOML error in a description, and its line.
pub(crate) fn syntax_complaint(text: &str, error: &toml::de::Error) -> String {
    let before = text
        .as_bytes()
        .iter()
        .take(error.span().map_or(0, |span| span.start));
    let line = before.filter(|byte| **byte == b'\n').count() + 1;
    format!("line {line}: {}", printable(error.message()))
}

impl Description {
    /// Reads a description; files in it are beside `path`, which is also its name in messages.
    ///
    /// # Errors
    /// [`BuildError::Source`] with the line or the part.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, BuildError> {
        let context = FileContext::new(path);
        let wrong =
            |cause: String| context.rejected(cause, "see docs/packs.md for what a mosaic is");
        let raw: RawDescription =
            toml::from_str(text).map_err(|error| wrong(syntax_complaint(text, &error)))?;
        let texts = &raw.attribution;
        if texts.len() > MAX_ATTRIBUTION_LINES
            || texts
                .iter()
                .any(|text| text.chars().count() > MAX_TEXT_CHARS)
        {
            return Err(wrong(format!(
                "attribution: has more than {MAX_ATTRIBUTION_LINES} lines or one of more than {MAX_TEXT_CHARS} characters"
            )));
        }
        if raw.part.is_empty() || raw.part.len() > MAX_PARTS {
            return Err(wrong(format!(
                "has {} parts: give 1 to {MAX_PARTS}, each as a table [[part]]",
                raw.part.len()
            )));
        }
        if raw.fill.as_ref().is_some_and(|fill| !are_texel(fill)) {
            return Err(wrong("fill: give 1 to 4 finite numbers".to_string()));
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let parts = raw.part.iter().zip(1..).map(|(part, number)| {
            part.checked(folder)
                .map_err(|cause| wrong(format!("part {number}: {cause}")))
        });
        Ok(Self {
            parts: parts.collect::<Result<_, _>>()?,
            name: raw.name,
            width: raw.width,
            attribution: raw.attribution,
            fill: raw.fill,
            is_unordered: false,
        })
    }

    /// Reads the description at a path: a file, a virtual raster, a folder with [`MOSAIC_FILE`], or a folder of maps.
    ///
    /// # Errors
    /// [`BuildError`] with the file.
    pub(crate) fn read(path: &Path) -> Result<Self, BuildError> {
        let context = FileContext::new(path);
        let with_path = |error| context.unreadable(error);
        if path.is_dir() {
            let inside = path.join(MOSAIC_FILE);
            if inside.is_file() {
                return Self::read(&inside);
            }
            return Self::of_folder(path);
        }
        if is_vrt(path) {
            return Self::of_vrt(path);
        }
        if is_archive(path) {
            return Ok(Self {
                parts: vec![Part::plain(archive_part(path)?)],
                ..Self::default()
            });
        }
        let bytes = files::read(path, MAX_DESCRIPTION_BYTES).map_err(with_path)?;
        let bytes = bytes.ok_or_else(|| {
            context.rejected(
                format!("has more than {MAX_DESCRIPTION_BYTES} bytes"),
                "give a description of a mosaic",
            )
        })?;
        let text = String::from_utf8(bytes)
            .map_err(|_| context.rejected("is no text", "give a description of a mosaic"))?;
        let mut description = Self::from_toml(&text, path)?;
        for part in &mut description.parts {
            let PartSource::File(file, stated) = &part.from else {
                continue;
            };
            if is_archive(file) {
                if *stated != Stated::default() {
                    return Err(FileContext::new(file).rejected(
                        "says itself where its tiles lie, and so does its [[part]]",
                        "leave crs and bounds_deg out",
                    ));
                }
                part.from = archive_part(file)?;
            }
        }
        Ok(description)
    }

    /// The same of cover or intensity: alpha is how much of it there is.
    pub(crate) fn of_amounts(mut self) -> Self {
        for part in &mut self.parts {
            part.alpha = AlphaMeans::Amount;
        }
        self
    }

    /// All maps in a folder, each of which must be georeferenced.
    fn of_folder(dir: &Path) -> Result<Self, BuildError> {
        let context = FileContext::new(dir);
        let mut files = Vec::new();
        for entry in std::fs::read_dir(dir).map_err(|error| context.unreadable(error))? {
            let path = entry.map_err(|error| context.unreadable(error))?.path();
            let ending = path
                .extension()
                .map(|e| e.to_string_lossy().to_ascii_lowercase());
            if path.is_file() && ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str())) {
                files.push(path);
            }
        }
        files.sort();
        if files.is_empty() || files.len() > MAX_PARTS {
            return Err(context.rejected(
                format!("holds {} maps", files.len()),
                format!("give a folder with 1 to {MAX_PARTS} PNG, JPEG, WebP or TIFF files, or with {MOSAIC_FILE}"),
            ));
        }
        let parts = files
            .into_iter()
            .map(|file| Part::plain(PartSource::File(file, Stated::default())));
        Ok(Self {
            parts: parts.collect(),
            is_unordered: true,
            ..Self::default()
        })
    }
}

/// A file that holds tiles as the source of a part.
fn archive_part(path: &Path) -> Result<PartSource, BuildError> {
    archive_tiles(path).map(|(set, place)| PartSource::Tiles(set, place))
}

/// Whether these numbers can be values of a texel.
fn are_texel(values: &[f64]) -> bool {
    (1..=4).contains(&values.len()) && values.iter().all(|value| value.is_finite())
}

impl RawPart {
    fn checked(&self, folder: &Path) -> Result<Part, String> {
        if !(0.0..=90.0).contains(&self.feather_deg) {
            return Err("feather_deg must be from 0 to 90".to_string());
        }
        if self
            .no_data
            .as_ref()
            .is_some_and(|values| !are_texel(values))
        {
            return Err("no_data: give 1 to 4 finite numbers".to_string());
        }
        let named = self.file.as_deref().or(self.tiles.as_deref());
        if let Some(complaint) = named.and_then(path_complaint) {
            return Err(complaint);
        }
        let from = match (&self.file, &self.tiles) {
            (Some(file), None) => self.file(folder.join(file))?,
            (None, Some(path)) => self.tiles(folder.join(path))?,
            _ => return Err("give either file or tiles".to_string()),
        };
        Ok(Part {
            from,
            feather_deg: self.feather_deg,
            is_matched: self.match_colour,
            no_data: self.no_data.clone(),
            encoding: self.encoding,
            alpha: AlphaMeans::Presence,
        })
    }

    fn file(&self, path: PathBuf) -> Result<PartSource, String> {
        let of_tiles = [
            ("tile_size", self.tile_size.is_some()),
            ("tile_deg", self.tile_deg.is_some()),
            ("columns", self.columns.is_some()),
            ("rows", self.rows.is_some()),
        ];
        if let Some((key, _)) = of_tiles.iter().find(|(_, is_there)| *is_there) {
            return Err(format!("{key} belongs to tiles, and this is a file"));
        }
        let stated = Stated {
            crs: self.crs,
            bounds: self.bounds_deg.map(Bounds::new).transpose()?,
        };
        Ok(PartSource::File(path, stated))
    }

    fn tiles(&self, path: PathBuf) -> Result<PartSource, String> {
        if self.bounds_deg.is_some() {
            return Err(
                "bounds_deg belongs to a file; tiles have tile_deg, columns and rows".to_string(),
            );
        }
        let side = self
            .tile_size
            .filter(|size| (1..=MAX_TILE_SIDE).contains(size));
        let side = side.ok_or(format!("tile_size must be from 1 to {MAX_TILE_SIDE}"))?;
        let crs = self.crs.unwrap_or_default();
        let tile_deg = self.tile_deg.filter(|deg| *deg > 1e-4 && *deg <= 360.0);
        let tile_deg = tile_deg.ok_or("tile_deg must be from 0.0001 to 360")?;
        let grid_rows = 2.0 * crs.top_deg() / tile_deg;
        if let Some(complaint) = TileSet::path_complaint(&path.to_string_lossy(), grid_rows) {
            return Err(complaint);
        }
        let range = |key: &str, given: Option<[u32; 2]>, whole_deg: f64| {
            let most = (whole_deg / tile_deg - 1e-9).ceil().max(1.0);
            let [first, end] = given.unwrap_or([0, most as u32]);
            let is_good = first < end
                && f64::from(end) <= most
                && u64::from(end - first) * u64::from(side) <= u64::from(MAX_PIECE_SIDE);
            is_good.then_some(first..end).ok_or(format!(
                "{key} must be [first, end] within 0 and {most}, of at most {MAX_PIECE_SIDE} texels in all"
            ))
        };
        let columns = range("columns", self.columns, 360.0)?;
        let left_deg = 360.0 - tile_deg * f64::from(columns.start);
        let set = TileSet {
            // At least one: the first column begins west of the date line.
            width: (left_deg / tile_deg * f64::from(side)).round().max(1.0) as u32,
            columns,
            rows: range("rows", self.rows, 2.0 * crs.top_deg())?,
            // At most 3 600 000: a tile has a ten-thousandth of a degree.
            grid_rows: (grid_rows - 1e-9).ceil().max(1.0) as u32,
            path: path.clone(),
            tile_size: side,
            archive_level: None,
        };
        let place = RasterPlacement {
            crs,
            west_deg: -180.0 + tile_deg * f64::from(set.columns.start),
            north_deg: crs.top_deg() - tile_deg * f64::from(set.rows.start),
            column_deg: tile_deg / f64::from(side),
            row_deg: tile_deg / f64::from(side),
        };
        Ok(PartSource::Tiles(set, place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Description, BuildError> {
        Description::from_toml(text, Path::new("maps/m.toml"))
    }

    #[test]
    fn files_and_tiles_are_read() {
        let text = "attribution = [\"NASA\"]\nfill = [1, 2, 3]\n[[part]]\nfile = \"a.png\"\n[[part]]\nfile = \"b.jpg\"\n\
                    bounds_deg = [170, -10, -170, 10]\nfeather_deg = 1\nmatch_colour = true\nno_data = [0]\n\
                    [[part]]\ntiles = \"t/{row}/{column}.png\"\ntile_size = 256\ntile_deg = 45\ncrs = \"EPSG:3857\"\n\
                    rows = [2, 4]\nencoding = \"terrarium\"\n";
        let read = read(text).expect("good");
        assert_eq!(read.attribution, ["NASA"]);
        assert_eq!(read.parts.len(), 3);
        assert_eq!(
            read.parts[0].from,
            PartSource::File("maps/a.png".into(), Stated::default())
        );
        let PartSource::File(_, stated) = &read.parts[1].from else {
            panic!("{:?}", read.parts[1]);
        };
        assert_eq!(stated.crs, None);
        assert_eq!(stated.bounds.map(|bounds| bounds.east_deg), Some(190.0));
        assert!(read.parts[1].is_matched && read.parts[1].no_data == Some(vec![0.0]));
        let PartSource::Tiles(set, place) = &read.parts[2].from else {
            panic!("{:?}", read.parts[2]);
        };
        assert_eq!((set.columns.clone(), set.rows.clone()), (0..8, 2..4));
        assert_eq!(set.file(3, 7), Path::new("maps/t/3/7.png"));
        let south = TileSet {
            path: "t/{x}/{-y}.png".into(),
            ..set.clone()
        };
        // Eight rows, as TMS counts them.
        assert_eq!(south.file(3, 7), Path::new("t/7/4.png"));
        assert_eq!(
            (south.file(0, 0), south.file(7, 1)),
            ("t/0/7.png".into(), "t/1/0.png".into())
        );
        assert_eq!((place.north_deg, place.column_deg), (90.0, 45.0 / 256.0));
        assert_eq!(set.size(), (2048, 512));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let tiles = "[[part]]\ntiles = \"{row}/{column}\"\ntile_size = 256\ntile_deg = 45\n";
        for (text, words) in [
            (String::new(), "has 0 parts"),
            ("width = 1\nwidth = 2\n".into(), "line 2"),
            (
                "[[part]]\nfile = \"a\"\nurl = \"b\"\n".into(),
                "line 3: unknown field `url`",
            ),
            ("[[part]]\n".into(), "part 1: give either file or tiles"),
            (
                "[[part]]\nfile = \"a\"\ncrs = \"EPSG:32633\"\n".into(),
                "EPSG:32633",
            ),
            (
                "[[part]]\nfile = \"a\"\nrows = [0, 1]\n".into(),
                "rows belongs to tiles",
            ),
            (
                "[[part]]\nfile = \"a\"\nbounds_deg = [0, 1, 2, 0]\n".into(),
                "are none",
            ),
            (
                "[[part]]\nfile = \"a\"\nfeather_deg = -1\n".into(),
                "feather_deg",
            ),
            ("[[part]]\nfile = \"a\"\nno_data = []\n".into(), "no_data"),
            (tiles.replace("/{column}", ""), "{column}"),
            (tiles.replace("{row}", "{z}"), "{-y}"),
            (
                tiles.replace("{row}", "{-y}").replace("45", "144"),
                "tile_deg must divide",
            ),
            (format!("{tiles}columns = [0, 9]\n"), "columns must be"),
            (format!("{tiles}rows = [2, 2]\n"), "rows must be"),
            (tiles.replace("256", "100000"), "tile_size"),
            (tiles.replace("45", "nan"), "tile_deg"),
        ] {
            let said = read(&text).expect_err(&text).to_string();
            assert!(
                said.contains(words) && said.contains("m.toml"),
                "{text}: {said}"
            );
        }
    }
}
