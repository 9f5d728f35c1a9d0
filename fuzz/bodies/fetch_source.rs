//! Descriptions of sources of maps.

use std::path::Path;
use terrella_pack::fetch::{Estimate, FetchOptions, Fineness, Layer, MapSource, Request};

/// Reads any text. For an accepted source, computes everything that needs no request.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    match MapSource::from_toml(text, Path::new("s.toml")) {
        Ok(source) => {
            for time in [None, Some("2004-08"), Some("../x")] {
                if let Ok(Some(time)) = source.time(time) {
                    assert!(!time.contains(['/', '\\']), "{time}");
                }
            }
            let layer = Layer {
                layer: source.layer,
                requests: vec![Request { source, time: None }],
            };
            for fineness in [Fineness::Level(3), Fineness::Width(21_600)] {
                for Estimate { files, .. } in layer.estimate(&options(fineness)).unwrap_or_default()
                {
                    assert!((1..=4_000_000).contains(&files));
                }
            }
        }
        Err(error) => {
            let said = error.to_string();
            assert!(!said.contains(char::is_control), "{said:?}");
            assert!(said.len() < 4000, "{said}");
        }
    }
}

fn options(fineness: Fineness) -> FetchOptions {
    FetchOptions {
        cache: "cache".into(),
        fineness,
        region: None,
        ground_width: 0,
        feather_deg: 0.0,
        under: None,
        connections: None,
        requests_per_s: None,
        retries: 0,
        allow_missing: false,
        client: Default::default(),
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    let head = "name = \"local\"\ntitle = \"t\"\nlayer = \"day\"\nattribution = [\"a\"]\nlicence = \"l\"\ncitation = \"c\"\n";
    let list = format!(
        "{head}[files]\nmedia = \"image/tiff\"\nmax_file_bytes = 1000\n[[files.file]]\nurl = \"https://a/b\"\nsave_as = \"b.tif\"\n\
         bounds_deg = [0, 0, 1, 1]\nblake3 = \"{}\"\n",
        "0".repeat(64)
    );
    let files: [&str; 3] = [
        include_str!("../../crates/terrella-pack/src/fetch/sources/blue_marble.toml"),
        include_str!("../../crates/terrella-pack/src/fetch/sources/black_marble.toml"),
        include_str!("../../crates/terrella-pack/src/fetch/sources/terrarium.toml"),
    ];
    let seeds = files.iter().map(|text| text.as_bytes().to_vec());
    seeds.chain([list.into_bytes()]).collect()
}
