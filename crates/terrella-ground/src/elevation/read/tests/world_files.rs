//! Files placed by a world file: six numbers, in degrees or in the system of a text beside it.

use super::*;

/// A folder with `dem.tif`, and files beside it by extension.
fn folder(bytes: Vec<u8>, beside: &[(&str, &str)]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dem.tif");
    std::fs::write(&path, bytes).expect("written");
    for (ending, text) in beside {
        std::fs::write(path.with_extension(ending), text).expect("written");
    }
    (folder, path)
}

/// 6 × 4 samples without GeoTIFF tags.
fn bare() -> Vec<u8> {
    let bare = Plain::new().without(33_550).without(33_922);
    bare.without(34_735).bytes()
}

const METRES: (&str, &str) = ("toml", "unit = \"metres\"");
const DEGREES: &str = "1.0\n0.0\n0.0\n-1.0\n10.5\n49.5\n";

fn height_m(path: &Path, lat_deg: f64, lon_deg: f64) -> f64 {
    let file = open_heights(path, &GridLimits::default()).unwrap_or_else(|e| panic!("{e}"));
    let grid = file.grid;
    grid.height_m(lat_deg.to_radians(), lon_deg.to_radians(), 0.0)
}

#[test]
fn a_world_file_places_what_has_no_tags() {
    for ending in ["tfw", "wld", "tifw", "TFW"] {
        let (_folder, path) = folder(bare(), &[METRES, (ending, DEGREES)]);
        assert!((height_m(&path, 49.5, 10.5)).abs() < 1e-6, "{ending}");
        assert!((height_m(&path, 46.5, 15.5) - 2300.0).abs() < 1e-6);
        assert!((height_m(&path, 48.5, 11.5) - 700.0).abs() < 1e-6);
        // It is listed among the files of the scene.
        assert!(height_files(&path).contains(&path.with_extension(ending)));
    }
    // Pixels at their own indices, as libraries write without a georeference.
    let mut identity = [0.0; 16];
    for n in [0, 5, 15] {
        identity[n] = 1.0;
    }
    let unplaced = Plain::new().without(33_550).without(33_922);
    let unplaced = unplaced.without(34_735).with(34_264, doubles(&identity));
    let (_folder, path) = folder(unplaced.bytes(), &[METRES, ("tfw", DEGREES)]);
    assert!((height_m(&path, 46.5, 15.5) - 2300.0).abs() < 1e-6);
    // The southern row first.
    let (_folder, path) = folder(bare(), &[METRES, ("tfw", "1 0 0 1 10.5 46.5")]);
    assert!((height_m(&path, 49.5, 10.5) - 1800.0).abs() < 1e-6);
    assert!(height_m(&path, 46.5, 10.5).abs() < 1e-6);
    // The tags and the sidecar override it.
    let elsewhere = ("tfw", "1 0 0 -1 100 20");
    let (_folder, path) = folder(Plain::new().bytes(), &[elsewhere]);
    assert!((height_m(&path, 46.5, 15.5) - 2300.0).abs() < 1e-6);
    let said = "unit = \"metres\"\nregistration = \"cells\"\n\
                bounds = { south_deg = 46, north_deg = 50, west_deg = 10, east_deg = 16 }";
    let (_folder, path) = folder(bare(), &[("toml", said), elsewhere]);
    assert!((height_m(&path, 46.5, 15.5) - 2300.0).abs() < 1e-6);
}

/// UTM zone 32 north, as Esri and GDAL write it.
const UTM: &str = "PROJCS[\"WGS 84 / UTM zone 32N\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
                   PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],\
                   PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",9],PARAMETER[\"scale_factor\",0.9996],\
                   PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\",0],UNIT[\"metre\",1]]";

#[test]
fn its_metres_are_those_of_the_system_beside_it() {
    // 6 × 4 heights 10 km apart. On the central meridian the easting is 500 km; PROJ has 45° N at a northing of 4 982 950.400 m.
    let world = ("tfw", "10000 0 0 -10000 480000 4992950.4");
    let (_folder, path) = folder(bare(), &[METRES, world, ("prj", UTM)]);
    // Column 2, row 1.
    assert!((height_m(&path, 45.0, 9.0) - 800.0).abs() < 1.0);
    assert!(height_files(&path).contains(&path.with_extension("prj")));
    // Without the `.prj`, metres are not accepted as degrees.
    let (_folder, path) = folder(bare(), &[METRES, world]);
    let error = open_heights(&path, &GridLimits::default()).unwrap_err();
    let said = error.to_string();
    assert!(
        said.contains("which are no degrees") && said.contains(".prj"),
        "{said}"
    );
}

#[test]
fn tags_without_a_system_take_that_of_the_text_beside_them() {
    let tags = Plain::new().with(34_735, keys(&[(1025, 1), (4099, 9001)]));
    let (_folder, path) = folder(tags.bytes(), &[]);
    let said = open_heights(&path, &GridLimits::default())
        .unwrap_err()
        .to_string();
    assert!(
        said.contains("does not state its coordinate system"),
        "{said}"
    );
    let degrees = UTM
        .split_once("GEOGCS")
        .map(|(_, rest)| format!("GEOGCS{rest}"));
    let degrees = degrees.and_then(|text| Some(text.split_once(",PROJECTION")?.0.to_owned()));
    let tags = Plain::new().with(34_735, keys(&[(1025, 1), (4099, 9001)]));
    let (_folder, path) = folder(tags.bytes(), &[("prj", &degrees.expect("a part"))]);
    assert!((height_m(&path, 46.5, 15.5) - 2300.0).abs() < 1e-6);
}

#[test]
fn bad_world_files_are_named() {
    for (text, says) in [
        ("1 0 0 -1 10", "dem.tfw: has 5 numbers and must have six"),
        ("1 0.2 0 -1 10 50", "dem.tfw: turns its map"),
        ("-1 0 0 -1 10 50", "dem.tfw: runs from east to west"),
        (
            "1 0 0 0 10 50",
            "dem.tfw: runs from east to west, or has steps of no size",
        ),
    ] {
        let (_folder, path) = folder(bare(), &[METRES, ("tfw", text)]);
        let error = open_heights(&path, &GridLimits::default()).unwrap_err();
        assert!(error.to_string().contains(says), "{error}");
    }
    let long = "1 0 0 -1 10 50 ".repeat(1000);
    let (_folder, path) = folder(bare(), &[METRES, ("tfw", &long)]);
    let error = open_heights(&path, &GridLimits::default()).unwrap_err();
    assert!(
        error.to_string().contains("more than 4096 bytes"),
        "{error}"
    );
}
