//! A scene file.

use std::path::Path;
use terrella_play::scene::Scene;

/// Reads any text. A valid scene must have a summary, and a longer full summary.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    match Scene::from_toml(text, Path::new("fuzz.toml")) {
        Ok(scene) => assert!(scene.full_summary().len() > scene.summary().len()),
        Err(error) => {
            let said = error.to_string();
            assert!(!said.contains(char::is_control), "{said:?}");
            assert!(error.path() == Path::new("fuzz.toml"), "{said}");
        }
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    const SCENES: [&str; 4] = [
        "[time]\nstart = 2018-01-15T12:00:00Z\nduration_s = 60\nspeed = -10.5\nframe_rate_hz = 30\n",
        "[orbit]\nsource = \"tle\"\n[camera]\nmode = \"nadir\"\nup = \"north\"\nfov_deg = 60\n",
        "[[orbit]]\nsource = \"kepler\"\nname = \"A\"\nsemi_major_axis_km = 7000\neccentricity = 0.1\nj2 = true\n\
         [[orbit]]\nsource = \"numerical\"\nposition_km = [7000, 0, 0]\nvelocity_km_s = [0, 7.5, 0]\ndrag = false\n\
         epoch = 2018-01-15T12:00:00Z\nframe = \"itrf\"\n[camera]\nfollow = \"A\"\n",
        "[camera]\nmode = \"geodetic\"\nlat_deg = -20\nlon_deg = 15.5\nheight_km = 12000\n[earth]\nfigure = \"wgs84\"\n\
         subdivision = 6\nvisibility = \"paper\"\nshading = \"sunlit\"\nclouds = true\nnormals = false\n\
         atmosphere = \"none\"\n[output]\nsize = [64, 36]\nsamples = 4\n",
    ];
    SCENES.map(|text| text.as_bytes().to_vec()).into()
}
