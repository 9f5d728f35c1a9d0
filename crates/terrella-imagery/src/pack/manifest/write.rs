//! Writing a manifest.

use super::{LevelEntry, Manifest, TileFile};
use crate::pack::heights::{HeightKind, HeightsEntry};
use crate::tile::{TILE_BORDER, TILE_MIPS};
use std::fmt::Write;
use terrella_ground::globe::{COLUMNS, ROWS};

impl Manifest {
    /// The text of `pack.toml`. The same manifest gives the same text, and [`Manifest::from_toml`] reads it back if
    /// the manifest is a good one; that is also the way to check one.
    pub fn to_toml(&self) -> String {
        let mut text = String::from(
            "# An imagery pack of terrella: maps of the Earth, cut into tiles. Each tile is a KTX2 file in\n\
             # tiles/<storage>/<layer>/<pixels>/r<row>c<column>.ktx2. Lists of tiles run from the block at 180° W and\n\
             # the north pole eastwards, row by row; 0 and \"\" stand for a tile that there is not. Checksums are the\n\
             # first 16 bytes of BLAKE3.\n",
        );
        let format = self.format();
        if format > 1 {
            text.push_str(
                "# Levels with `parts` are cut further, each block into that many parts along its side; their lists are those of one\n\
                 # block each, part by part, row by row from its north-west corner.\n",
            );
        }
        let attribution: Vec<_> = self.attribution.iter().map(|line| quoted(line)).collect();
        let storages: Vec<_> = self.storages.iter().map(|s| quoted(s.name())).collect();
        let head = [
            ("format", format.to_string()),
            ("name", quoted(&self.name)),
            ("attribution", list(&attribution, 1)),
            ("columns", COLUMNS.to_string()),
            ("rows", ROWS.to_string()),
            ("border", TILE_BORDER.to_string()),
            ("mips", TILE_MIPS.to_string()),
            ("storages", list(&storages, storages.len())),
        ];
        push_keys(&mut text, &head);
        for entry in &self.layers {
            text.push_str("\n[[layer]]\n");
            push_keys(
                &mut text,
                &[
                    ("name", quoted(entry.layer.name())),
                    ("source", quoted(&entry.source)),
                ],
            );
            if let Some(exaggeration) = entry.exaggeration {
                // With a fraction, as TOML's floats have.
                push_keys(&mut text, &[("exaggeration", format!("{exaggeration:?}"))]);
            }
            for level in &entry.levels {
                push_level(&mut text, self, level);
            }
        }
        if let Some(entry) = &self.heights {
            push_heights(&mut text, entry);
        }
        text
    }
}

fn push_heights(text: &mut String, entry: &HeightsEntry) {
    text.push_str("\n[heights]\n");
    let sources: Vec<_> = entry.sources.iter().map(|source| quoted(source)).collect();
    let mut keys = vec![
        ("sources", list(&sources, 1)),
        ("levels", entry.levels.to_string()),
        ("columns", entry.columns.to_string()),
        ("side", entry.side.to_string()),
        ("border", entry.border.to_string()),
    ];
    match entry.kind {
        // With a fraction or an exponent, as TOML's floats have.
        HeightKind::I16 { offset_m, scale_m } => keys.extend([
            ("samples", quoted("i16")),
            ("offset_m", format!("{offset_m:?}")),
            ("scale_m", format!("{scale_m:?}")),
        ]),
        HeightKind::F32 => keys.push(("samples", quoted("f32"))),
    }
    keys.extend([
        ("tiles", entry.tiles.to_string()),
        ("index_bytes", entry.index.bytes.to_string()),
        ("index_checksum", checksum(&Some(entry.index))),
    ]);
    push_keys(text, &keys);
}

fn push_level(text: &mut String, manifest: &Manifest, level: &LevelEntry) {
    text.push_str("\n[[layer.level]]\n");
    let shape = level.shape;
    let mut sizes = vec![
        ("pixels", shape.block_pixels().to_string()),
        ("side", shape.side().to_string()),
    ];
    if shape.parts > 1 {
        sizes.push(("parts", shape.parts.to_string()));
    }
    push_keys(text, &sizes);
    for (storage, tiles) in manifest.storages.iter().zip(&level.tiles) {
        let name = storage.name();
        if shape.parts == 1 {
            text.push_str(&format!("\n[layer.level.{name}]\n"));
            push_files(text, tiles, COLUMNS as usize);
            continue;
        }
        let blocks = tiles.chunks(usize::from(shape.tiles_of_block()));
        for (block, files) in blocks.enumerate() {
            if files.iter().any(Option::is_some) {
                text.push_str(&format!(
                    "\n[[layer.level.{name}.block]]\nblock = {block}\n"
                ));
                push_files(text, files, shape.parts as usize);
            }
        }
    }
}

fn push_files(text: &mut String, files: &[Option<TileFile>], per_line: usize) {
    let bytes = |file: &Option<TileFile>| file.map_or(0, |file| file.bytes);
    let bytes: Vec<_> = files.iter().map(|file| bytes(file).to_string()).collect();
    let checksums: Vec<_> = files.iter().map(checksum).collect();
    let lists = [
        ("bytes", list(&bytes, per_line)),
        ("checksums", list(&checksums, 2)),
    ];
    push_keys(text, &lists);
}

fn push_keys(text: &mut String, keys: &[(&str, String)]) {
    for (key, value) in keys {
        text.push_str(&format!("{key} = {value}\n"));
    }
}

/// A list, broken into lines of so many items if it has more.
fn list(items: &[String], per_line: usize) -> String {
    if items.len() <= per_line {
        return format!("[{}]", items.join(", "));
    }
    let mut text = String::from("[\n");
    for line in items.chunks(per_line.max(1)) {
        text.push_str(&format!("    {},\n", line.join(", ")));
    }
    text.push(']');
    text
}

/// A TOML string.
pub fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

fn checksum(tile: &Option<TileFile>) -> String {
    let mut digits = String::from("\"");
    for byte in tile.iter().flat_map(|tile| tile.checksum) {
        // Writing to a string does not fail.
        let _ = write!(digits, "{byte:02x}");
    }
    digits.push('"');
    digits
}
