//! A pack's manifest.

use std::path::Path;
use terrella_imagery::pack::{
    HeightKind, HeightsEntry, LayerEntry, LevelEntry, Manifest, TileFile,
};
use terrella_imagery::tile::{MapLayer, Storage, TileShape};

/// Reads any text. An accepted manifest must be equal after it is written and read again.
pub fn run(data: &[u8]) {
    let path = Path::new("pack.toml");
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    match Manifest::from_toml(text, path) {
        Ok(manifest) => {
            let again = Manifest::from_toml(&manifest.to_toml(), path);
            assert_eq!(again.expect("its own text"), manifest);
        }
        Err(error) => {
            let said = error.to_string();
            assert!(!said.contains(char::is_control), "{said:?}");
            assert!(said.len() < 4000, "{said}");
        }
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    let manifest = |storages: &[Storage], layers: &[(MapLayer, &[u32])]| {
        let file = Some(TileFile::of(b"tile"));
        let level = |pixels: &u32| LevelEntry {
            shape: TileShape::new(*pixels).expect("in range"),
            tiles: vec![vec![file; 128]; storages.len()],
        };
        let layer = |(layer, ladder): &(MapLayer, &[u32])| LayerEntry {
            layer: *layer,
            source: "a.tif, 5400 × 2700".into(),
            exaggeration: (*layer == MapLayer::Normals).then_some(4.0),
            levels: ladder.iter().map(level).collect(),
        };
        Manifest {
            name: "Earth".into(),
            attribution: vec!["NASA".into()],
            storages: storages.to_vec(),
            layers: layers.iter().map(layer).collect(),
            heights: None,
        }
        .to_toml()
        .into_bytes()
    };
    let mut seeds = vec![
        manifest(&[Storage::Plain], &[(MapLayer::Day, &[16])]),
        manifest(
            &Storage::ALL,
            &[(MapLayer::Day, &[150, 75]), (MapLayer::Normals, &[75])],
        ),
    ];
    seeds.push(cut().to_toml().into_bytes());
    // Short manifests: changes rarely hit a checksum.
    let head = String::from_utf8_lossy(&seeds[0]).into_owned();
    let head = head.split("bytes =").next().unwrap_or_default();
    seeds.push(format!("{head}bytes = [0, 1]\nchecksums = [\"\", \"0f\"]\n").into_bytes());
    seeds.push(b"format = 1\nname = \"x\"\nlayer = [{name = \"day\", level = [{}]}]\n".to_vec());
    seeds
}

/// A manifest of version 2: one block has all of its parts but one, and there is elevation data.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
fn cut() -> Manifest {
    let file = Some(TileFile::of(b"part"));
    let mut parts = vec![None; 128 * 4];
    parts[60 * 4..60 * 4 + 3].fill(file);
    let level = |pixels, parts, tiles| LevelEntry {
        shape: TileShape::cut(pixels, parts).expect("in range"),
        tiles: vec![tiles],
    };
    Manifest {
        name: "Earth".into(),
        attribution: Vec::new(),
        storages: vec![Storage::Bc],
        layers: vec![LayerEntry {
            layer: MapLayer::Day,
            source: "a.tif".into(),
            exaggeration: None,
            levels: vec![
                level(20, 2, parts),
                level(20, 1, vec![file; 128]),
                level(16, 1, vec![file; 128]),
            ],
        }],
        heights: Some(HeightsEntry {
            sources: vec!["a.tif, 21600 x 10800".into()],
            levels: 1,
            columns: 16,
            side: 16,
            border: 1,
            kind: HeightKind::I16 {
                offset_m: -100.5,
                scale_m: 0.25,
            },
            tiles: 128,
            index: TileFile {
                bytes: 12 + 37 * 128,
                checksum: [7; 16],
            },
        }),
    }
}
