//! Writing a manifest.

use super::{FORMAT_VERSION, Manifest, TileFile};
use crate::globe::{COLUMNS, ROWS};
use crate::imagery::tile::{TILE_BORDER, TILE_MIPS};
use std::fmt::Write;

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
        let attribution: Vec<_> = self.attribution.iter().map(|line| quoted(line)).collect();
        let storages: Vec<_> = self.storages.iter().map(|s| quoted(s.name())).collect();
        let head = [
            ("format", FORMAT_VERSION.to_string()),
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
                text.push_str("\n[[layer.level]]\n");
                let sizes = [
                    ("pixels", level.shape.pixels.to_string()),
                    ("side", level.shape.side().to_string()),
                ];
                push_keys(&mut text, &sizes);
                for (storage, tiles) in self.storages.iter().zip(&level.tiles) {
                    text.push_str(&format!("\n[layer.level.{}]\n", storage.name()));
                    let bytes = |tile: &Option<TileFile>| tile.map_or(0, |tile| tile.bytes);
                    let bytes: Vec<_> = tiles.iter().map(|t| bytes(t).to_string()).collect();
                    let checksums: Vec<_> = tiles.iter().map(checksum).collect();
                    let lists = [
                        ("bytes", list(&bytes, COLUMNS as usize)),
                        ("checksums", list(&checksums, 2)),
                    ];
                    push_keys(&mut text, &lists);
                }
            }
        }
        text
    }
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
pub(crate) fn quoted(text: &str) -> String {
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
