//! Sidecars of elevation files.

use std::path::Path;
use terrella_ground::elevation::read::{Sidecar, SidecarGeoreference};

/// Reads any text as a sidecar.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    match Sidecar::from_toml(text, Path::new("dem.toml")) {
        Ok(sidecar) => {
            let numbers = [sidecar.scale, sidecar.offset];
            assert!(numbers.iter().flatten().all(|number| number.is_finite()));
            if let Some(SidecarGeoreference::Bounds(bounds, _)) = sidecar.georeference {
                assert!(bounds.south_rad < bounds.north_rad);
                assert!(0.0 < bounds.width_rad && bounds.width_rad <= std::f64::consts::TAU);
            }
        }
        Err(error) => {
            let said = error.to_string();
            assert!(said.starts_with("dem.toml:"), "{said}");
            assert!(said.len() < 2000, "{said}");
        }
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    let texts = [
        include_str!("../../tests/data/heights/globe_u16.toml"),
        include_str!("../../textures/elevation.toml"),
        include_str!("../../textures/dem/trinidad.toml"),
        "centre = { lat_deg = 47.5, lon_deg = 11.0 }\nspacing = { lat_deg = 0.001, lon_deg = 0.002 }\n\
         registration = \"posts\"\nunit = \"us-survey-feet\"\nscale = 0.1\noffset = -32768\nnodata = nan\n\
         byte_order = \"little\"\nvariable = \"z\"\nattribution = \"é\"\n",
    ];
    texts.map(|text| text.as_bytes().to_vec()).to_vec()
}
