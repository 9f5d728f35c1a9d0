//! Georeferences of files in other forms, and which of them are rejected.

use super::*;

const METRES: &[u8] = b"156543.0339\n0\n0\n-156543.0339\n-19959236.82\n19959236.82\n";

const UTM: &[u8] = b"PROJCS[\"WGS 84 / UTM zone 33N\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],UNIT[\"metre\",1]]";

const MERCATOR: &[u8] = b"PROJCS[\"WGS 84 / Pseudo-Mercator\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]]],\
PROJECTION[\"Mercator_1SP\"],UNIT[\"metre\",1],AUTHORITY[\"EPSG\",\"3857\"]]";

const NAD27: &[u8] = b"GEOGCS[\"NAD27\",DATUM[\"North_American_Datum_1927\",SPHEROID[\"Clarke 1866\",6378206.4,294.978698213898]],\
PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433],AUTHORITY[\"EPSG\",\"4267\"]]";

/// A map in Web Mercator, 256 texels of 156 543 m a side, white north of the equator, with a world file.
fn metric() -> Folder {
    let folder = Folder::new();
    let shade = |_, y| [if y < 128 { 255 } else { 10 }; 3];
    folder.put("a.png", &png(256, 256, shade));
    folder.put("a.pgw", METRES);
    folder
}

const FILE: &str = "[[part]]\nfile = \"a.png\"\n";

fn rejected(folder: &Folder, text: &str, words: &[&str]) {
    let said = folder.open(text).expect_err(text).to_string();
    assert!(
        words.iter().all(|word| said.contains(word)),
        "{words:?}: {said}"
    );
}

fn is_placed(folder: &Folder, text: &str) {
    let (map, _) = folder.read(text);
    let middle = map.width / 4;
    let column = map.width / 2;
    let found = (map.at(column, middle - 1)[0], map.at(column, middle)[0]);
    assert_eq!(found, (255, 10), "{text}");
}

#[test]
fn metres_of_no_system_are_rejected_with_the_key_that_says_it() {
    let folder = metric();
    rejected(
        &folder,
        FILE,
        &["a.png", "no degrees", "crs = \"EPSG:3857\"", "gdalwarp"],
    );
    let stated = format!("{FILE}crs = \"EPSG:3857\"\n");
    is_placed(&folder, &stated);
    folder.put("a.prj", MERCATOR);
    is_placed(&folder, FILE);
    is_placed(&folder, &stated);
    let other = format!("{FILE}crs = \"EPSG:4326\"\n");
    rejected(&folder, &other, &["EPSG:3857", "EPSG:4326", "correct crs"]);
    // Without its parameters.
    folder.put("a.prj", UTM);
    rejected(&folder, FILE, &["a.prj", "UTM zone 33N"]);
    rejected(&folder, &stated, &["a.prj", "UTM zone 33N"]);
    folder.put("a.prj", b"Projection UTM\nZone 33\n");
    rejected(&folder, FILE, &["a.prj", "no well-known text"]);
}

#[test]
fn the_text_of_gdal_beside_a_file_says_its_system() {
    let folder = metric();
    let aux = |wkt: &[u8]| {
        let wkt = String::from_utf8_lossy(wkt).replace('"', "&quot;");
        let xml = format!(
            "<PAMDataset>\n  <SRS dataAxisToSRSAxisMapping=\"1,2\">{wkt}</SRS>\n</PAMDataset>\n"
        );
        folder.put("a.png.aux.xml", xml.as_bytes());
    };
    aux(MERCATOR);
    is_placed(&folder, FILE);
    aux(UTM);
    rejected(&folder, FILE, &["a.png.aux.xml", "UTM zone 33N"]);
    folder.put("a.png.aux.xml", b"<PAMDataset></PAMDataset>");
    rejected(&folder, FILE, &["no degrees"]);
}

#[test]
fn degrees_of_other_figures_are_rejected_and_south_up_files_turned() {
    let folder = Folder::new();
    folder.put("a.png", &png(64, 32, code));
    folder.put("a.pgw", b"5.625\n0\n0\n-5.625\n-177.1875\n87.1875\n");
    let (map, _) = folder.read(FILE);
    assert_eq!(map.at(3, 2), code(3, 2));
    folder.put("a.prj", NAD27);
    rejected(&folder, FILE, &["a.prj", "\"NAD27\"", "not those of WGS84"]);
    fs::remove_file(folder.0.path().join("a.prj")).expect("removed");
    folder.put("a.pgw", b"5.625\n0\n0\n5.625\n-177.1875\n-87.1875\n");
    let (map, _) = folder.read(FILE);
    assert!((0..32).all(|y| (0..64).all(|x| map.at(x, y) == code(x, 31 - y))));
    folder.put("a.pgw", b"-5.625\n0\n0\n-5.625\n177.1875\n87.1875\n");
    rejected(&folder, FILE, &["a.png"]);
}

/// A map in UTM has its corners where PROJ puts them, whether its system is spelt out or given by its code.
#[test]
fn projected_maps_are_warped() {
    let spelt = String::from_utf8_lossy(UTM).replace(
        "UNIT[\"metre\",1]]",
        "PARAMETER[\"central_meridian\",15],PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",500000],UNIT[\"metre\",1]]",
    );
    let named = String::from_utf8_lossy(UTM).replace(
        "UNIT[\"metre\",1]]",
        "UNIT[\"metre\",1],AUTHORITY[\"EPSG\",\"32633\"]]",
    );
    for text in [spelt, named] {
        let folder = Folder::new();
        folder.put("below.png", &png(720, 360, |_, _| BELOW));
        let quarters = |x, y| {
            [
                if x < 40 { 250 } else { 10 },
                if y < 30 { 250 } else { 10 },
                0,
            ]
        };
        folder.put("a.png", &png(80, 60, quarters));
        // 10 km a texel, from 100 000 5 500 000.
        folder.put("a.pgw", b"10000\n0\n0\n-10000\n105000\n5495000\n");
        folder.put("a.prj", text.as_bytes());
        let whole = "width = 3600\n".to_owned() + &part("below.png", EARTH, "") + FILE;
        let (map, _) = folder.read(&whole);
        let at = |lat_deg: f64, lon_deg: f64| {
            map.at(
                ((lon_deg + 180.0) * 10.0) as u32,
                ((90.0 - lat_deg) * 10.0) as u32,
            )
        };
        // For the middle (500 000 5 200 000) PROJ returns 46.954 N 15 E; for two corners 49.520 N 9.472 E and 44.144 N 20.001 E.
        assert_eq!(at(47.1, 14.8), [250, 250, 0]);
        assert_eq!(at(47.1, 15.2), [10, 250, 0]);
        assert_eq!(at(46.8, 14.8), [250, 10, 0]);
        assert_eq!(at(46.8, 15.2), [10, 10, 0]);
        assert_eq!(
            (at(49.35, 9.75), at(44.25, 19.75)),
            ([250, 250, 0], [10, 10, 0])
        );
        assert_eq!((at(49.75, 9.25), at(43.75, 20.25)), (BELOW, BELOW));
        let stated = format!("{FILE}crs = \"EPSG:3857\"\n");
        rejected(
            &folder,
            &stated,
            &["in a projection", "EPSG:3857", "correct crs"],
        );
        assert!(
            check_whole_earth(&folder.0.path().join("a.png"), (80, 60))
                .is_err_and(|error| error.to_string().contains("is projected"))
        );
    }
}

const BELOW: [u8; 3] = [7, 8, 90];

/// A single file of the whole Earth is also checked against the files beside it.
#[test]
fn a_whole_map_is_not_said_to_be_a_part() {
    let folder = Folder::new();
    folder.put("a.png", &png(64, 32, code));
    let path = folder.0.path().join("a.png");
    let said = || check_whole_earth(&path, (64, 32)).map_err(|error| error.to_string());
    assert_eq!(said(), Ok(()));
    folder.put("a.pgw", b"5.625\n0\n0\n-5.625\n-177.1875\n87.1875\n");
    assert_eq!(said(), Ok(()));
    folder.put("a.pgw", b"0.5\n0\n0\n-0.5\n5.25\n47.75\n");
    assert!(said().is_err_and(|said| said.contains("longitudes 5.0000 to 37.0000")));
    fs::remove_file(folder.0.path().join("a.pgw")).expect("removed");
    folder.put("a.prj", NAD27);
    assert!(said().is_err_and(|said| said.contains("NAD27")));
    folder.put("a.prj", MERCATOR);
    assert!(said().is_err_and(|said| said.contains("is projected")));
}

#[test]
fn tiles_are_numbered_from_the_south_where_that_is_said() {
    let folder = Folder::new();
    for (row, column) in (0..2).flat_map(|row| (0..4).map(move |column| (row, column))) {
        let tile = png(16, 16, |x, y| code(16 * column + x, 16 * row + y));
        // As gdal2tiles and TMS: the southern row is 0.
        folder.put(&format!("t/{column}/{}.png", 1 - row), &tile);
    }
    let grid = "tile_size = 16\ntile_deg = 90\n";
    let (map, notes) = folder.read(&format!("[[part]]\ntiles = \"t/{{x}}/{{-y}}.png\"\n{grid}"));
    assert_eq!((map.width, notes.len()), (64, 0));
    assert!((0..32).all(|y| (0..64).all(|x| map.at(x, y) == code(x, y))));
    let (map, _) = folder.read(&format!(
        "[[part]]\ntiles = \"t/{{column}}/{{row}}.png\"\n{grid}"
    ));
    assert_eq!(map.at(1, 1), code(1, 17));
}

/// Adjacent parts that meet within a texel of the mosaic hide everything beneath them.
#[test]
fn parts_that_touch_leave_no_line() {
    let folder = Folder::new();
    folder.put("below.png", &png(64, 32, |_, _| [255, 0, 255]));
    folder.put("a.png", &png(64, 64, |_, _| [10, 200, 10]));
    // Edges that are a third of a texel off those of the mosaic, and two digits that round apart.
    for (east, west) in [
        (1.9, 1.9),
        (-7.123, -7.123),
        (11.25, 11.25),
        (3.333, 3.3331),
    ] {
        let bounds = |west: f64, south: f64, east: f64, north: f64| {
            part("a.png", &format!("{west}, {south}, {east}, {north}"), "")
        };
        let text = "width = 64\n".to_owned()
            + &part("below.png", EARTH, "")
            + &bounds(-100.0, 7.7, east, 80.0)
            + &bounds(west, 7.7, 100.0, 80.0)
            + &bounds(-100.0, -60.0, 100.0, 7.7);
        let (map, _) = folder.read(&text);
        for (x, y) in (4..26).flat_map(|y| (16..48).map(move |x| (x, y))) {
            assert_eq!(map.at(x, y), [10, 200, 10], "{east}: {x} {y}");
        }
    }
}
