//! Descriptions of mosaics, virtual rasters, and the world files beside their maps.

use std::path::Path;
use terrella_ground::elevation::vrt::{MAX_VRT_SOURCES, Vrt};
use terrella_pack::mosaic::{Description, PartSource, world_place};

/// Reads any text. An accepted description must stay within its limits.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    match Description::from_toml(text, Path::new("m.toml")) {
        Ok(description) => {
            assert!((1..=4096).contains(&description.parts.len()));
            for part in &description.parts {
                if let PartSource::Tiles(set, place) = &part.from {
                    let (width, height) = set.size();
                    assert!(width <= 262_144 && height <= 262_144);
                    assert!(place.column_deg > 0.0 && place.row_deg > 0.0);
                }
            }
        }
        Err(error) => {
            let said = error.to_string();
            assert!(said.starts_with("m.toml: ") && said.len() < 4000, "{said}");
        }
    }
    match Vrt::read(text, Path::new("maps")) {
        Ok(vrt) => assert!(
            vrt.bands
                .iter()
                .all(|band| band.sources.len() <= MAX_VRT_SOURCES)
        ),
        Err(error) => assert!(error.to_string().len() < 1000, "{error}"),
    }
    if let Err(said) = world_place(text, None) {
        assert!(said.len() < 200, "{said}");
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    let texts: [&str; 5] = [
        "name = \"x\"\nwidth = 64\nattribution = [\"NASA\"]\nfill = [1, 2, 3]\n[[part]]\nfile = \"a.png\"\n",
        "[[part]]\nfile = \"b.jpg\"\nbounds_deg = [170, -10, -170, 10]\ncrs = \"EPSG:3857\"\nfeather_deg = 1\n\
         match_colour = true\nno_data = [0]\n",
        "[[part]]\ntiles = \"t/{row}/{column}.png\"\ntile_size = 256\ntile_deg = 45\ncolumns = [1, 3]\nrows = [2, 4]\n\
         encoding = \"terrarium\"\n",
        "0.5\n0\n0\n-0.25\n-179.75\n89.875\n",
        include_str!("../../tests/data/gdal/heights.vrt"),
    ];
    texts.map(|text| text.as_bytes().to_vec()).to_vec()
}
