//! MBTiles 1.3 (<https://github.com/mapbox/mbtiles-spec>): tiles in the table `tiles` of an SQLite file, or, as `mbutil` and others write
//! them, in the tables `map` and `images`. Rows count from the south, as TMS has them.

use super::sqlite::{Content, Object, Sqlite, Value};
use super::{ArchiveFile, Level, MAX_LEVEL, MAX_TILE_FILE_BYTES};
use crate::error::BuildError;
use std::collections::BTreeMap;

/// Most tiles of the level that is read.
const MAX_TILES: usize = 4 << 20;

/// Longest name of a picture in `images`, bytes: a checksum in hexadecimal digits.
const MAX_ID_BYTES: u64 = 128;

pub(in crate::mosaic) struct MbTiles {
    sqlite: Sqlite,
    level: Level,
    /// By row from the north and column.
    tiles: BTreeMap<(u32, u32), Content>,
}

/// A table with the places of some columns among its own.
struct Table {
    root: u32,
    columns: Vec<usize>,
}

impl Table {
    fn find(objects: &[Object], name: &str, columns: &[&str]) -> Option<Self> {
        let is_it = |object: &&Object| object.kind == "table" && object.name == name;
        let object = objects.iter().find(is_it)?;
        let names = column_names(&object.statement);
        let place = |column: &&str| names.iter().position(|name| name == column);
        let columns = columns.iter().map(place).collect::<Option<_>>()?;
        Some(Self {
            root: object.root,
            columns,
        })
    }

    /// A row's values of the columns; NULL where the row ends before.
    fn values<const N: usize>(&self, row: &[Value]) -> [Value; N] {
        std::array::from_fn(|n| {
            let place = self.columns.get(n).copied();
            let value = place.and_then(|place| row.get(place));
            value.cloned().unwrap_or(Value::Null)
        })
    }
}

/// The names of columns in a statement that made a table: the first word of each part between the outer brackets.
fn column_names(statement: &str) -> Vec<String> {
    let inside = statement.split_once('(').map_or("", |(_, inside)| inside);
    let (mut names, mut depth, mut part) = (Vec::new(), 0, String::new());
    for c in inside.chars() {
        match c {
            ')' if depth == 0 => break,
            ',' if depth == 0 => names.push(std::mem::take(&mut part)),
            c => {
                depth += i32::from(c == '(') - i32::from(c == ')');
                part.push(c);
            }
        }
    }
    names.push(part);
    let word = |part: &String| {
        let quotes = ['"', '`', '[', ']', '\''];
        let word = part.split_whitespace().next().unwrap_or_default();
        word.trim_matches(quotes).to_ascii_lowercase()
    };
    names.iter().map(word).collect()
}

/// Level, column and row from the south of a row.
fn place(level: &Value, column: &Value, row: &Value) -> Option<(u8, u32, u32)> {
    let number = |value: &Value| match value {
        Value::Number(number) => u32::try_from(*number).ok(),
        _ => None,
    };
    let level = u8::try_from(number(level)?)
        .ok()
        .filter(|level| *level <= MAX_LEVEL)?;
    let is_inside = |n: &u32| *n < 1 << level;
    let column = number(column).filter(is_inside)?;
    Some((level, column, number(row).filter(is_inside)?))
}

impl MbTiles {
    pub(super) fn open(file: ArchiveFile) -> Result<Self, BuildError> {
        let context = file.context.clone();
        let rejected = |cause: &str| {
            let advice = "write it anew (`sqlite3 IN.mbtiles 'VACUUM INTO \"OUT.mbtiles\"'`), or convert it (`pmtiles convert IN.mbtiles OUT.pmtiles`)";
            context.rejected(cause, advice)
        };
        let mut sqlite = Sqlite::open(file)?;
        let objects = sqlite.objects()?;
        let places = ["zoom_level", "tile_column", "tile_row"];
        let with = |last: &'static str| [places.as_slice(), &[last]].concat();
        let whole = Table::find(&objects, "tiles", &with("tile_data"));
        let map = Table::find(&objects, "map", &with("tile_id"));
        let images = Table::find(&objects, "images", &["tile_id", "tile_data"]);
        let (places, images) = match (whole, map, images) {
            (Some(whole), ..) => (whole, None),
            (None, Some(map), Some(images)) => (map, Some(images)),
            _ => return Err(rejected("has no table of tiles that is known")),
        };
        let level = level(&mut sqlite, &places)?;
        let level = level.ok_or_else(|| rejected("has no tiles, or too many at every level"))?;
        let mut archive = Self {
            tiles: BTreeMap::new(),
            level,
            sqlite,
        };
        archive.fill(&places, images.as_ref())?;
        match archive.tiles.is_empty() {
            true => Err(rejected("has no tiles")),
            false => Ok(archive),
        }
    }

    pub(super) fn level(&self) -> &Level {
        &self.level
    }

    /// Records the location of each tile of the level.
    fn fill(&mut self, places: &Table, images: Option<&Table>) -> Result<(), BuildError> {
        let (wanted, last) = (self.level.level, (1_u32 << self.level.level) - 1);
        let (tiles, mut named) = (&mut self.tiles, BTreeMap::<Vec<u8>, Vec<(u32, u32)>>::new());
        let mut count = 0;
        self.sqlite.rows(places.root, &mut |_, row, sqlite| {
            let [level, column, row, data] = places.values(&row);
            let Some((_, column, row)) = place(&level, &column, &row).filter(|at| at.0 == wanted)
            else {
                return Ok(());
            };
            count += 1;
            if count > MAX_TILES {
                return Err(sqlite.file.context.damaged("more tiles than a level has"));
            }
            // Rows count from the south.
            let at = (last - row, column);
            match (data, images) {
                (Value::Bytes(content), None) => {
                    tiles.insert(at, content);
                }
                (Value::Bytes(content), Some(_)) => {
                    let id = sqlite.content(&content, MAX_ID_BYTES)?;
                    named.entry(id).or_default().push(at);
                }
                (Value::Number(id), Some(_)) => {
                    named.entry(id.to_be_bytes().to_vec()).or_default().push(at);
                }
                _ => {}
            }
            Ok(())
        })?;
        let Some(images) = images else {
            return Ok(());
        };
        self.sqlite.rows(images.root, &mut |rowid, row, sqlite| {
            let [id, data] = images.values(&row);
            let id = match id {
                Value::Bytes(content) => sqlite.content(&content, MAX_ID_BYTES)?,
                Value::Number(id) => id.to_be_bytes().to_vec(),
                // A primary key of whole numbers is the rowid itself.
                Value::Null => rowid.to_be_bytes().to_vec(),
            };
            if let (Some(all), Value::Bytes(content)) = (named.get(&id), data) {
                tiles.extend(all.iter().map(|at| (*at, content.clone())));
            }
            Ok(())
        })
    }

    pub(super) fn tile(&mut self, row: u32, column: u32) -> Result<Option<Vec<u8>>, BuildError> {
        let content = self.tiles.get(&(row, column));
        content
            .map(|content| self.sqlite.content(content, MAX_TILE_FILE_BYTES))
            .transpose()
    }
}

/// The finest level whose tiles make a raster that is read, and the columns and rows that are there.
fn level(sqlite: &mut Sqlite, places: &Table) -> Result<Option<Level>, BuildError> {
    let mut levels: BTreeMap<u8, Level> = BTreeMap::new();
    sqlite.rows(places.root, &mut |_, row, _| {
        let [level, column, row] = places.values(&row);
        if let Some((level, column, row)) = place(&level, &column, &row) {
            let row = (1 << level) - 1 - row;
            let known = levels.entry(level).or_insert_with(|| Level {
                level,
                columns: column..column,
                rows: row..row,
            });
            let with =
                |range: &std::ops::Range<u32>, n: u32| range.start.min(n)..range.end.max(n + 1);
            known.columns = with(&known.columns, column);
            known.rows = with(&known.rows, row);
        }
        Ok(())
    })?;
    Ok(levels.into_values().rev().find(Level::fits))
}
