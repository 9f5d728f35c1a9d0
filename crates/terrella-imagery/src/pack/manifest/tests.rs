use super::*;
use crate::pack::error::{MAX_MANIFEST_BYTES, MAX_MANIFEST_VALUES, PackError};
use crate::tile::{MAX_LEVELS, MapLayer, Storage, TileShape};
use std::path::Path;

/// A manifest of three layers in both storages, some tiles of the finest day level missing.
fn manifest() -> Manifest {
    let layer = |layer: MapLayer, ladder: &[u32]| {
        let level = |(place, pixels): (usize, &u32)| {
            let file = |storage: usize, block: usize| {
                let gap = layer == MapLayer::Day && place == 0 && block % 3 == 1;
                let contents = format!("{layer:?} {pixels} {storage} {block}");
                (!gap).then(|| TileFile::of(contents.as_bytes()))
            };
            LevelEntry {
                shape: TileShape::new(*pixels).expect("in range"),
                tiles: (0..2)
                    .map(|storage| (0..128).map(|block| file(storage, block)).collect())
                    .collect(),
            }
        };
        LayerEntry {
            layer,
            source: format!("{}.tif, 5400 × 2700 \"texels\"", layer.name()),
            exaggeration: (layer == MapLayer::Normals).then_some(4.0),
            levels: ladder.iter().enumerate().map(level).collect(),
        }
    };
    Manifest {
        name: "Erde \"mit\\Strich\" — 5400".into(),
        attribution: vec!["NASA Earth Observatory".into(), "GEBCO, \u{1F30D}".into()],
        storages: vec![Storage::Bc, Storage::Plain],
        layers: vec![
            layer(MapLayer::Day, &[337, 150, 75]),
            layer(MapLayer::Normals, &[75]),
            layer(MapLayer::Water, &[135]),
        ],
        heights: None,
    }
}

pub fn read(text: &str) -> Result<Manifest, PackError> {
    Manifest::from_toml(text, Path::new("earth/pack.toml"))
}

/// The words of rejection of a text, which must be rejected at a key.
pub(super) fn rejection(text: &str) -> String {
    let error = read(text).expect_err("rejected");
    assert!(matches!(error, PackError::Key { .. }), "{error}");
    error.to_string()
}

/// The valid manifest's text with one part replaced at its first occurrence.
fn changed(from: &str, to: &str) -> String {
    let text = manifest().to_toml();
    assert!(text.contains(from), "{from} is in no manifest");
    text.replacen(from, to, 1)
}

#[test]
fn a_manifest_comes_back() {
    let manifest = manifest();
    let text = manifest.to_toml();
    assert_eq!(read(&text).expect("a good manifest"), manifest);
    assert_eq!(text, manifest.to_toml(), "the same text again");
    let key = TileKey {
        layer: MapLayer::Day,
        level: 0,
        block: 2,
        part: 0,
    };
    let (shape, file) = manifest.tile(Storage::Plain, key).expect("it is there");
    assert_eq!((shape.pixels, file), (337, TileFile::of(b"Day 337 1 2")));
    let gap = TileKey { block: 1, ..key };
    assert_eq!(manifest.tile(Storage::Plain, gap), None);
}

#[test]
fn the_largest_manifest_is_within_the_limits() {
    let mut manifest = manifest();
    let file = Some(TileFile {
        bytes: 270_000_000,
        checksum: [0xff; 16],
    });
    manifest.attribution = vec!["ä".repeat(MAX_TEXT_CHARS); MAX_ATTRIBUTION_LINES];
    let level = |shape: TileShape| LevelEntry {
        shape,
        tiles: vec![vec![file; 128 * usize::from(shape.tiles_of_block())]; 2],
    };
    let cut = [16, 8, 4, 2].map(|parts| TileShape::cut(106, parts).expect("in range"));
    let whole = (4..MAX_LEVELS as u32).map(|n| TileShape::new(110 - n).expect("in range"));
    let shapes: Vec<_> = cut.into_iter().chain(whole).collect();
    manifest.layers = MapLayer::ALL
        .map(|layer| LayerEntry {
            layer,
            source: "ä".repeat(MAX_TEXT_CHARS),
            exaggeration: None,
            levels: shapes.iter().map(|shape| level(*shape)).collect(),
        })
        .into();
    let text = manifest.to_toml();
    let values = text.matches([',', '\n']).count();
    assert!(
        text.len() as u64 * 3 < MAX_MANIFEST_BYTES * 2,
        "{} bytes",
        text.len()
    );
    assert!(values * 9 < MAX_MANIFEST_VALUES * 8, "{values} values");
    let many = ",".repeat(MAX_MANIFEST_VALUES + 1);
    let error = read(&many).expect_err("too many");
    assert!(matches!(error, PackError::TooLarge { .. }), "{error}");
}

#[test]
fn every_key_is_needed() {
    let text = manifest().to_toml();
    for (key, line) in [
        ("format", None),
        ("name", None),
        ("columns", None),
        ("rows", None),
        ("border", None),
        ("mips", None),
        ("storages", None),
        ("attribution", None),
        ("source", Some("layer.source")),
        ("pixels", Some("layer.level.pixels")),
        ("side", Some("layer.level.side")),
        ("bytes", Some("layer.level.bc.bytes")),
        ("checksums", Some("layer.level.bc.checksums")),
    ] {
        let start = text.find(&format!("\n{key} = ")).expect("written") + 1;
        // A list ends with a bracket on a separate line.
        let end = match text[start..].find('\n').expect("a line") {
            len if text[start..start + len].ends_with('[') => {
                start + text[start..].find("\n]\n").expect("closed") + 3
            }
            len => start + len + 1,
        };
        let without = [&text[..start], &text[end..]].concat();
        let said = rejection(&without);
        let name = line.unwrap_or(key);
        assert!(said.contains(&format!("{name}: is missing")), "{said}");
    }
    let said = rejection(&changed("name = \"day\"\n", ""));
    assert!(said.contains("layer.name: is missing"), "{said}");
    let said = rejection("");
    assert_eq!(
        said,
        "earth/pack.toml: format: is missing; build the pack again"
    );
}

#[test]
fn wrong_values_are_rejected_with_line_and_key() {
    for (from, to, parts) in [
        (
            "format = 1",
            "format = 3",
            &[
                "pack.toml:5: format: must be 1 to 2, the versions that",
                "found 3",
            ][..],
        ),
        ("format = 1", "format = \"1\"", &["whole number"]),
        (
            "columns = 16",
            "columns = 8",
            &[":11: columns: must be 16 (found 8)"],
        ),
        ("rows = 8", "rows = -8", &["rows: must be 8"]),
        (
            "border = 4",
            "border = 4.0",
            &["border: must be a whole number"],
        ),
        (
            "mips = 4",
            "mips = 99999999999999999999999",
            &["mips: must be 4"],
        ),
        (
            "storages = [\"bc\", \"plain\"]",
            "storages = []",
            &["storages: must have 1 to 2 items and has 0"],
        ),
        (
            "storages = [\"bc\", \"plain\"]",
            "storages = [\"bc\", \"bc\"]",
            &["is given twice"],
        ),
        (
            "storages = [\"bc\", \"plain\"]",
            "storages = [\"bc\", \"plane\"]",
            &["one of \"plain\", \"bc\"; did you mean \"plain\"?"],
        ),
        (
            "storages = [\"bc\", \"plain\"]",
            "storages = [\"bc\"]",
            &["layer.level.plain: unknown key"],
        ),
        (
            "storages = [\"bc\", \"plain\"]",
            "storages = \"bc\"",
            &["must be a list"],
        ),
        (
            "name = \"Erde",
            "nam = \"Erde",
            &["nam: unknown key; did you mean name?"],
        ),
        (
            "source = ",
            "sauce = ",
            &["layer.sauce: unknown key; did you mean source?"],
        ),
        (
            "name = \"Erde",
            "path = \"/etc\"\nname = \"Erde",
            &["path: unknown key"],
        ),
        (
            "name = \"normals\"",
            "name = \"day\"",
            &["layer.name: is given twice"],
        ),
        (
            "name = \"day\"",
            "name = \"clouds\"",
            &["layer: no layer is named \"day\""],
        ),
        (
            "name = \"water\"",
            "name = \"../../etc\"",
            &["must be one of \"day\""],
        ),
        (
            "name = \"water\"",
            "name = \"../water\"",
            &["did you mean \"water\"?"],
        ),
        (
            "storages = [\"bc\", \"plain\"]",
            "storages = [\"../bc\", \"plain\"]",
            &["must be one of"],
        ),
        (
            "[layer.level.plain]",
            "[layer.level.\"../plain\"]",
            &["unknown key; did you mean plain?"],
        ),
        (
            "exaggeration = 4.0",
            "exaggeration = inf",
            &["must be a finite number above 0"],
        ),
        (
            "exaggeration = 4.0",
            "exaggeration = -1",
            &["must be a finite number above 0"],
        ),
        (
            "exaggeration = 4.0",
            "exaggeration = \"4\"",
            &["must be a finite number above 0"],
        ),
        (
            "name = \"water\"",
            "name = \"water\"\nexaggeration = 4.0",
            &["for the layer \"normals\" only"],
        ),
        (
            "pixels = 337\nside = 352",
            "pixels = 336\nside = 352",
            &["layer.level.side: must be 344 (found 352)"],
        ),
        ("pixels = 337", "pixels = 15", &["from 16 to 8184"]),
        ("pixels = 337", "pixels = 8185", &["from 16 to 8184"]),
        (
            "pixels = 150\nside = 160",
            "pixels = 337\nside = 352",
            &["must be less than 337", "each once"],
        ),
        (
            "pixels = 150\nside = 160",
            "pixels = 340\nside = 352",
            &["must be less than 337"],
        ),
        (
            "pixels = 135\nside = 144",
            "pixels = 257\nside = 272",
            &["has 257 pixels and may have at most 256"],
        ),
        ("\n    \"9", "\n    \"09", &["32 digits"]),
        (
            "[[layer.level]]\npixels = 337",
            "[[layer.level]]\nurl = 1\npixels = 337",
            &["layer.level.url: unknown key"],
        ),
        (
            "[layer.level.bc]\n",
            "[layer.level.bc]\nfile = \"../x\"\n",
            &["layer.level.bc.file: unknown key"],
        ),
    ] {
        let said = rejection(&changed(from, to));
        for part in parts {
            assert!(said.contains(part), "{from} → {to}: {said}");
        }
    }
}

/// The good manifest with one tile's file exchanged: `(layer, level, storage, block)`.
fn with_file(place: [usize; 4], file: Option<TileFile>) -> String {
    let mut manifest = manifest();
    let [layer, level, storage, block] = place;
    manifest.layers[layer].levels[level].tiles[storage][block] = file;
    manifest.to_toml()
}

#[test]
fn files_are_held_to_their_shape() {
    let file = |bytes| {
        Some(TileFile {
            bytes,
            checksum: [1; 16],
        })
    };
    // R8 of side 144 in four levels: 27 540 bytes and 64 KiB.
    let most = 144 * 144 + 72 * 72 + 36 * 36 + 18 * 18 + 65_536;
    assert!(read(&with_file([2, 0, 1, 0], file(most))).is_ok());
    let said = rejection(&with_file([2, 0, 1, 0], file(most + 1)));
    assert!(
        said.contains("layer.level.plain.bytes: must be a whole number from 0 to 93076"),
        "{said}"
    );
    let said = rejection(&with_file([2, 0, 1, 0], file(0)));
    assert!(
        said.contains("must be empty just where the bytes are 0"),
        "{said}"
    );
    let said = rejection(&with_file([2, 0, 0, 7], None));
    assert!(
        said.contains("in one storage and none in the other"),
        "{said}"
    );
    let mut gap = manifest();
    for tiles in &mut gap.layers[1].levels[0].tiles {
        tiles[77] = None;
    }
    let said = rejection(&gap.to_toml());
    assert!(
        said.contains("must have all 128 blocks, and block 77 is missing"),
        "{said}"
    );
    for blocks in [127, 129] {
        let mut wrong = manifest();
        wrong.layers[0].levels[1].tiles[0].resize(blocks, file(9));
        let said = rejection(&wrong.to_toml());
        assert!(
            said.contains(&format!("must have 128 items and has {blocks}")),
            "{said}"
        );
    }
    let mut many = manifest();
    let level = many.layers[1].levels[0].clone();
    many.layers[1].levels = vec![level; MAX_LEVELS + 1];
    assert!(rejection(&many.to_toml()).contains("must have 1 to 10 items and has 11"));
    let as_1 = many.to_toml().replacen("format = 2", "format = 1", 1);
    assert!(rejection(&as_1).contains("must have 1 to 8 items and has 11"));
    many.layers[1].levels.clear();
    assert!(rejection(&many.to_toml()).contains("layer.level: is missing"));
}

#[test]
fn texts_are_bounded_and_printable() {
    let named = |name: &str| {
        Manifest {
            name: name.into(),
            ..manifest()
        }
        .to_toml()
    };
    assert!(read(&named(&"x".repeat(MAX_NAME_CHARS))).is_ok());
    let said = rejection(&named(&"x".repeat(MAX_NAME_CHARS + 1)));
    assert!(
        said.contains("name: must have at most 200 characters"),
        "{said}"
    );
    assert!(said.len() < 300, "{said}");
    for text in ["a\u{1b}[31m", "a\nb", "\u{202e}gnp", "\u{7f}", "\0"] {
        let said = rejection(&named(text));
        assert!(said.contains("no control characters"), "{said:?}");
        assert!(
            !said.contains(|c: char| c.is_control() || c == '\u{202e}'),
            "{said:?}"
        );
    }
    let lines = vec![String::new(); MAX_ATTRIBUTION_LINES + 1];
    let said = rejection(
        &Manifest {
            attribution: lines,
            ..manifest()
        }
        .to_toml(),
    );
    assert!(
        said.contains("attribution: must have 0 to 64 items"),
        "{said}"
    );
}

#[test]
fn what_is_no_toml_is_rejected() {
    let error = read("format = 1\nname = [\n").expect_err("not TOML");
    assert!(matches!(error, PackError::Syntax { .. }), "{error}");
    let error = read("format = 1\nformat = 1\n").expect_err("twice");
    assert!(
        error
            .to_string()
            .contains("pack.toml:2: is not TOML: duplicate key"),
        "{error}"
    );
    let error = read(&"#".repeat(MAX_MANIFEST_BYTES as usize + 1)).expect_err("too large");
    assert!(matches!(error, PackError::TooLarge { .. }), "{error}");
    for hostile in [
        "a = ".to_owned() + &"[".repeat(200_000),
        "[a.".repeat(100_000),
        "a.".repeat(100_000) + "a = 1",
    ] {
        assert!(read(&hostile).is_err());
    }
    // A later version is named as such, whatever keys it has.
    let said = rejection("format = 3\nnew_key = 1\n");
    assert!(said.contains("format: must be 1 to 2"), "{said}");
}

#[test]
fn paths_are_made_of_known_names_only() {
    let shape = TileShape::new(75).expect("in range");
    for storage in Storage::ALL {
        for layer in MapLayer::ALL {
            for block in Block::all() {
                let path = tile_path(storage, layer, shape, block, 0);
                let mut parts = path.components();
                assert!(parts.all(|part| matches!(part, std::path::Component::Normal(_))));
            }
        }
    }
    let block = Block { column: 12, row: 3 };
    let path = tile_path(
        Storage::Plain,
        MapLayer::NightLights,
        TileShape::new(1350).expect("in range"),
        block,
        0,
    );
    assert_eq!(path, Path::new("tiles/plain/night_lights/1350/r3c12.ktx2"));
    let shape = TileShape::cut(1350, 4).expect("in range");
    let path = tile_path(Storage::Bc, MapLayer::Day, shape, block, 7);
    assert_eq!(path, Path::new("tiles/bc/day/5400/r13c51.ktx2"));
}
