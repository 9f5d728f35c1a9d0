//! Files of all formats, and every way in which they are refused.

use super::*;
use crate::elevation::GridError;
use std::collections::BTreeMap;
use std::io::Cursor;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/heights")
        .join(name)
}

fn open(name: &str) -> HeightFile {
    open_heights(&data(name), &GridLimits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// What the files of tests/data/heights hold: whole metres of a plane.
fn plane(lat_deg: f64, lon_deg: f64) -> f64 {
    (100.0 * lat_deg + 7.0 * lon_deg).round_ties_even()
}

/// Compares the samples that lie `step` apart from a first one.
#[track_caller]
fn holds(
    file: &HeightFile,
    first: (f64, f64),
    step: f64,
    size: (u32, u32),
    height: impl Fn(f64, f64) -> f64,
) {
    for row in 0..size.1 {
        for column in 0..size.0 {
            let (lat, lon) = (
                first.0 - f64::from(row) * step,
                first.1 + f64::from(column) * step,
            );
            let got = file.grid.height_m(lat.to_radians(), lon.to_radians(), 0.0);
            let right = height(lat, lon);
            assert!(
                (got - right).abs() < 1e-3,
                "{got} for {right} at {lat} {lon}"
            );
        }
    }
}

#[test]
fn tiff_files_of_other_writers_are_read() {
    holds(
        &open("strips_i16_lzw.tif"),
        (49.75, 10.25),
        0.5,
        (20, 12),
        plane,
    );
    holds(
        &open("points_big_i32.tif"),
        (50.0, 10.0),
        0.5,
        (11, 7),
        plane,
    );
    let feet = |lat, lon| plane(lat, lon) * 0.3048;
    holds(&open("feet_f64.tif"), (49.75, 10.25), 0.5, (6, 5), feet);
    let scaled = |lat, lon| plane(lat, lon) * 0.5 - 100.0;
    holds(&open("gdal_u16.tif"), (49.75, 10.25), 0.5, (6, 5), scaled);

    let tiles = open("tiles_f32_deflate_be.tif");
    assert_eq!(tiles.grid.stats().holes, 1);
    let hole = (49.75 - 1.5, 10.25 + 2.0);
    let known = |lat: f64, lon: f64| {
        let is_hole = (lat, lon) == hole;
        if is_hole {
            tiles.grid.height_m(lat.to_radians(), lon.to_radians(), 0.0)
        } else {
            plane(lat, lon)
        }
    };
    holds(&tiles, (49.75, 10.25), 0.5, (20, 20), known);
    assert!((known(hole.0, hole.1) - plane(hole.0, hole.1)).abs() < 60.0);
    let bounds = tiles.grid.bounds();
    let edges = [
        bounds.south_rad,
        bounds.north_rad,
        bounds.west_rad,
        bounds.width_rad,
    ];
    for (edge, right) in edges
        .map(f64::to_degrees)
        .iter()
        .zip([40.0, 50.0, 10.0, 10.0])
    {
        assert!((edge - right).abs() < 1e-9);
    }
}

#[test]
fn png_with_a_sidecar_is_read() {
    let file = open("globe_u16.png");
    holds(&file, (78.75, -168.75), 22.5, (16, 8), plane);
    assert_eq!(file.attribution.as_deref(), Some("made for this test"));
    assert_eq!(file.grid.weight(1.5, 3.1), 1.0);
}

#[test]
fn netcdf_is_read_from_either_end_and_across_the_date_line() {
    holds(
        &open("south_first_f32.nc"),
        (43.0, 178.0),
        1.0,
        (5, 4),
        plane,
    );
    // Packed: 0.5 × stored + 10, in feet.
    let feet = |lat, lon| plane(lat, lon) * 0.3048;
    holds(&open("packed_i16.nc"), (43.0, 178.0), 1.0, (5, 4), feet);
}

/// A TIFF of one uncompressed strip, little-endian: by default 6 × 4 samples of 1° from 10° E 50° N, i16, in metres.
struct Plain {
    /// Type (3, 4, 12 or 2) and bytes of each tag.
    tags: BTreeMap<u16, (u16, Vec<u8>)>,
    samples: Vec<u8>,
}

fn shorts(values: &[u16]) -> (u16, Vec<u8>) {
    (3, values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

fn doubles(values: &[f64]) -> (u16, Vec<u8>) {
    (12, values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

fn keys(pairs: &[(u16, u16)]) -> (u16, Vec<u8>) {
    let mut values = vec![1, 1, 0, pairs.len() as u16];
    values.extend(pairs.iter().flat_map(|(key, value)| [*key, 0, 1, *value]));
    shorts(&values)
}

impl Plain {
    fn new() -> Self {
        let mut tags = BTreeMap::new();
        for (tag, value) in [
            (256, 6),
            (257, 4),
            (258, 16),
            (259, 1),
            (262, 1),
            (277, 1),
            (278, 4),
            (339, 2),
        ] {
            tags.insert(tag, shorts(&[value]));
        }
        tags.insert(33_550, doubles(&[1.0, 1.0, 0.0]));
        tags.insert(33_922, doubles(&[0.0, 0.0, 0.0, 10.0, 50.0, 0.0]));
        tags.insert(
            34_735,
            keys(&[(1024, 2), (1025, 1), (2048, 4326), (4099, 9001)]),
        );
        Self {
            tags,
            samples: (0..24i16).flat_map(|n| (n * 100).to_le_bytes()).collect(),
        }
    }

    fn with(mut self, tag: u16, value: (u16, Vec<u8>)) -> Self {
        self.tags.insert(tag, value);
        self
    }

    fn without(mut self, tag: u16) -> Self {
        self.tags.remove(&tag);
        self
    }

    fn samples(mut self, bits: u16, format: u16, samples: Vec<u8>) -> Self {
        self.samples = samples;
        self.with(258, shorts(&[bits])).with(339, shorts(&[format]))
    }

    fn bytes(mut self) -> Vec<u8> {
        self.tags
            .insert(279, (4, (self.samples.len() as u32).to_le_bytes().to_vec()));
        self.tags.insert(273, (4, vec![0; 4]));
        let values_at = 8 + 2 + 12 * self.tags.len() + 4;
        let tail: usize = self
            .tags
            .values()
            .map(|(_, v)| {
                if v.len() > 4 {
                    v.len().next_multiple_of(2)
                } else {
                    0
                }
            })
            .sum();
        self.tags
            .insert(273, (4, ((values_at + tail) as u32).to_le_bytes().to_vec()));
        let mut file = b"II*\0\x08\0\0\0".to_vec();
        file.extend((self.tags.len() as u16).to_le_bytes());
        let mut values = Vec::new();
        for (tag, (kind, value)) in &self.tags {
            let size = match kind {
                2 => 1,
                3 => 2,
                4 => 4,
                _ => 8,
            };
            file.extend(tag.to_le_bytes());
            file.extend(kind.to_le_bytes());
            file.extend(((value.len() / size) as u32).to_le_bytes());
            if value.len() > 4 {
                file.extend(((values_at + values.len()) as u32).to_le_bytes());
                values.extend(value);
                values.resize(values.len().next_multiple_of(2), 0);
            } else {
                let mut short = value.clone();
                short.resize(4, 0);
                file.extend(short);
            }
        }
        file.extend([0; 4]);
        file.extend(values);
        file.extend(self.samples);
        file
    }
}

fn read(bytes: Vec<u8>, sidecar: &str) -> Result<HeightFile, HeightFileError> {
    let sidecar = (!sidecar.is_empty())
        .then(|| Sidecar::from_toml(sidecar, Path::new("dem.toml")))
        .transpose()?;
    read_heights(
        Cursor::new(bytes),
        sidecar.as_ref(),
        Path::new("dem.tif"),
        &GridLimits::default(),
    )
}

#[track_caller]
fn said(bytes: Vec<u8>, sidecar: &str) -> String {
    let error = read(bytes, sidecar).expect_err("refused");
    let said = error.to_string();
    assert!(said.starts_with("dem.t"), "{said}");
    said
}

const NORTH_WEST: (f64, f64) = (49.5, 10.5);

#[test]
fn every_type_of_numbers_is_read() {
    let numbers: Vec<i16> = (0..24).map(|n| n * 5).collect();
    let bytes = |f: fn(i16) -> Vec<u8>| numbers.iter().flat_map(|n| f(*n)).collect::<Vec<u8>>();
    let all = [
        Plain::new().samples(8, 1, bytes(|n| vec![n as u8])),
        Plain::new().samples(16, 1, bytes(|n| (n as u16).to_le_bytes().to_vec())),
        Plain::new().samples(16, 2, bytes(|n| n.to_le_bytes().to_vec())),
        Plain::new().samples(32, 1, bytes(|n| (n as u32).to_le_bytes().to_vec())),
        Plain::new().samples(32, 2, bytes(|n| i32::from(n).to_le_bytes().to_vec())),
        Plain::new().samples(32, 3, bytes(|n| f32::from(n).to_le_bytes().to_vec())),
        Plain::new().samples(64, 3, bytes(|n| f64::from(n).to_le_bytes().to_vec())),
    ];
    for plain in all {
        let file = read(plain.bytes(), "").unwrap_or_else(|error| panic!("{error}"));
        let height = |lat: f64, lon: f64| 5.0 * ((49.5 - lat) * 6.0 + lon - 10.5);
        holds(&file, NORTH_WEST, 1.0, (6, 4), height);
    }
}

#[test]
fn places_are_told_in_several_ways() {
    let height = |lat: f64, lon: f64| 100.0 * ((49.5 - lat) * 6.0 + lon - 10.5);
    let matrix = |m: [f64; 8]| {
        let mut all = m.to_vec();
        all.extend([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let plain = Plain::new().without(33_550).without(33_922);
        plain.with(34_264, doubles(&all)).bytes()
    };
    let file = read(matrix([1.0, 0.0, 0.0, 10.0, 0.0, -1.0, 0.0, 50.0]), "").unwrap();
    holds(&file, NORTH_WEST, 1.0, (6, 4), height);
    // The southern row first.
    let file = read(matrix([1.0, 0.0, 0.0, 10.0, 0.0, 1.0, 0.0, 46.0]), "").unwrap();
    let turned = |lat: f64, lon: f64| height(96.0 - lat, lon);
    holds(&file, NORTH_WEST, 1.0, (6, 4), turned);
    // A point inside, in the file's own NAD83, in radians.
    let tie = doubles(&[2.0, 1.0, 0.0, 12f64.to_radians(), 49f64.to_radians(), 0.0]);
    let step = 1f64.to_radians();
    let plain = Plain::new()
        .with(33_922, tie)
        .with(33_550, doubles(&[step, step, 0.0]));
    let plain = plain.with(
        34_735,
        keys(&[(1024, 2), (2048, 4269), (2054, 9101), (4099, 9001)]),
    );
    holds(
        &read(plain.bytes(), "").unwrap(),
        NORTH_WEST,
        1.0,
        (6, 4),
        height,
    );
    // By the sidecar alone: edges across the date line, and a middle.
    let bare = || {
        Plain::new()
            .without(33_550)
            .without(33_922)
            .without(34_735)
            .bytes()
    };
    let sidecar = "bounds = { south_deg = 46, north_deg = 50, west_deg = 177, east_deg = -177 }\n\
                   registration = \"cells\"\nunit = \"metres\"";
    let shifted = |lat: f64, lon: f64| height(lat, lon - 167.0);
    holds(
        &read(bare(), sidecar).unwrap(),
        (49.5, 177.5),
        1.0,
        (6, 4),
        shifted,
    );
    let sidecar = "centre = { lat_deg = 48, lon_deg = 13 }\nspacing = { lat_deg = 1, lon_deg = 1 }\n\
                   registration = \"posts\"\nunit = \"metres\"";
    holds(
        &read(bare(), sidecar).unwrap(),
        NORTH_WEST,
        1.0,
        (6, 4),
        height,
    );
}

#[test]
fn units_are_told_or_refused() {
    let unit = |pairs: &[(u16, u16)]| {
        let mut all = vec![(1024, 2), (1025, 1), (2048, 4326)];
        all.extend(pairs);
        Plain::new().with(34_735, keys(&all)).bytes()
    };
    let height = |bytes, sidecar| {
        let file = read(bytes, sidecar).unwrap_or_else(|error| panic!("{error}"));
        file.grid
            .height_m(49.5_f64.to_radians(), 11.5_f64.to_radians(), 0.0)
    };
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-4, "{a} and {b}");
    near(height(unit(&[(4099, 9002)]), ""), 30.48);
    near(height(unit(&[(4099, 9003)]), ""), 100.0 * 1200.0 / 3937.0);
    near(height(unit(&[(4096, 5703)]), ""), 100.0);
    near(height(unit(&[(4096, 6360)]), ""), 100.0 * 1200.0 / 3937.0);
    near(height(unit(&[]), "unit = \"feet\""), 30.48);
    near(
        height(unit(&[]), "unit = \"metres\"\nscale = 0.5\noffset = -20"),
        30.0,
    );
    assert_eq!(
        said(unit(&[]), ""),
        "dem.tif: does not say whether its heights are metres or feet; expected that in dem.toml: write unit = \
         \"metres\", \"feet\" or \"us-survey-feet\" there"
    );
    assert_eq!(
        said(unit(&[(4099, 9001)]), "unit = \"feet\""),
        "dem.tif: says that its heights are metres, and its sidecar says feet; expected one unit: correct the sidecar"
    );
    assert!(
        said(unit(&[(4099, 9036)]), "")
            .contains("has heights of the unit EPSG:9036; expected metres or feet")
    );
    let fathoms = "<GDALMetadata><Item name=\"U\" sample=\"0\" role=\"unittype\">fathom</Item></GDALMetadata>\0";
    let plain = Plain::new().with(34_735, keys(&[(1024, 2), (2048, 4326)]));
    let plain = plain.with(42_112, (2, fathoms.as_bytes().to_vec()));
    assert!(said(plain.bytes(), "").contains("has heights of the unit \"fathom\""));
}

#[test]
fn other_coordinates_are_named_with_the_command() {
    let of = |pairs: &[(u16, u16)]| said(Plain::new().with(34_735, keys(pairs)).bytes(), "");
    assert_eq!(
        of(&[(1024, 1), (3072, 32_633), (4099, 9001)]),
        "dem.tif: is in the projected coordinates EPSG:32633; expected latitudes and longitudes of WGS84: `gdalwarp -t_srs \
         EPSG:4326 -r bilinear dem.tif OUT.tif`"
    );
    assert!(of(&[(1024, 1), (3072, 32_767)]).contains("projected coordinates of its own making"));
    assert!(of(&[(3072, 2056)]).contains("EPSG:2056"));
    assert!(of(&[(1024, 2), (2048, 4277)]).contains("the geographic coordinates EPSG:4277"));
    assert!(of(&[(1024, 3)]).contains("geocentric"));
    assert!(of(&[(1024, 9)]).contains("unknown model 9"));
    assert!(of(&[(1024, 2), (2048, 4326), (2054, 9105)]).contains("angles of the unit EPSG:9105"));
    assert!(of(&[(1025, 1)]).contains("does not say what coordinates it lies in"));
    assert!(of(&[(1024, 2), (2048, 4326), (1025, 7)]).contains("raster type 7"));

    let matrix = doubles(&[
        1.0, 0.1, 0.0, 10.0, 0.1, -1.0, 0.0, 50.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ]);
    assert_eq!(
        said(Plain::new().with(34_264, matrix).bytes(), ""),
        "dem.tif: is rotated or sheared; expected rows from west to east: `gdalwarp -t_srs EPSG:4326 -r bilinear dem.tif \
         OUT.tif`"
    );
    let points = doubles(&[0.0; 12]);
    assert!(
        said(Plain::new().with(33_922, points).bytes(), "").contains("placed by several points")
    );
    let westwards = doubles(&[-1.0, 1.0, 0.0]);
    assert!(said(Plain::new().with(33_550, westwards).bytes(), "").contains("from east to west"));
}

#[test]
fn a_place_stands_in_one_of_both() {
    let bare = || {
        Plain::new()
            .without(33_550)
            .without(33_922)
            .without(34_735)
            .bytes()
    };
    assert_eq!(
        said(bare(), "unit = \"metres\""),
        "dem.tif: does not say where it lies; expected that in dem.toml: write bounds = { south_deg = …, north_deg = …, \
         west_deg = …, east_deg = … } and registration = \"cells\" or \"posts\" there"
    );
    let bounds = "bounds = { south_deg = 1, north_deg = 2, west_deg = 3, east_deg = 4 }\nregistration = \"cells\"";
    assert!(
        said(Plain::new().bytes(), bounds)
            .contains("says itself where it lies, and so does its sidecar")
    );
    assert!(
        said(Plain::new().bytes(), "byte_order = \"big\"")
            .contains("take byte_order out of the sidecar")
    );
    assert!(said(Plain::new().bytes(), "variable = \"z\"").contains("the sidecar names one"));
    // Two tiles of one place are no error: the finer lies on top, then the first.
}

#[test]
fn files_that_hold_no_heights_are_refused() {
    let rgb = Plain::new()
        .with(277, shorts(&[3]))
        .with(258, shorts(&[16, 16, 16]))
        .with(262, shorts(&[2]));
    assert!(said(rgb.bytes(), "").contains("expected one channel"));
    let white = Plain::new().with(262, shorts(&[0]));
    assert!(said(white.bytes(), "").contains("counts from white to black"));
    let jpeg = Plain::new().with(259, shorts(&[50_000]));
    assert!(said(jpeg.bytes(), "").contains("gdal_translate"), "zstd");
    assert!(
        said(
            Plain::new().with(42_113, (2, b"none\0".to_vec())).bytes(),
            ""
        )
        .contains("no-data value \"none")
    );
    assert!(said(b"GIF89a and so on".to_vec(), "").contains("gdal_translate -of GTiff dem.tif"));
    assert!(said(b"CDF\x05and so on".to_vec(), "").contains("nccopy -k classic"));
    assert!(said(b"\x89HDF\r\n\x1a\n".to_vec(), "").contains("nccopy -k classic"));
    assert!(said(Vec::new(), "").contains("none of the files"));
    // Feet taken for metres, −32 768 not said to be no data, bytes in the wrong order.
    let high = |value: i16| {
        Plain::new()
            .samples(16, 2, value.to_le_bytes().repeat(24))
            .bytes()
    };
    for value in [29_032, -32_768, 8848i16.swap_bytes()] {
        assert!(
            said(high(value), "")
                .contains("correct unit, scale, offset, no-data value or byte order")
        );
    }
    assert!(said(high(-32_768), "nodata = -32768").contains("has no data in any sample"));
}

#[test]
fn no_data_values_become_holes() {
    let mut samples: Vec<u8> = (0..24)
        .flat_map(|n: u8| f32::from(n).to_le_bytes())
        .collect();
    samples[20..24].copy_from_slice(&f32::MIN.to_le_bytes());
    samples[24..28].copy_from_slice(&f32::NAN.to_le_bytes());
    let plain = || Plain::new().samples(32, 3, samples.clone());
    // GDAL writes the value with fewer digits than it has.
    for text in [
        "-3.4028234663852886e+38\0",
        "-3.40282346638529e+38 \0",
        "-3.4028235e38",
    ] {
        let file = read(
            plain().with(42_113, (2, text.as_bytes().to_vec())).bytes(),
            "",
        )
        .unwrap();
        assert_eq!(file.grid.stats().holes, 2, "{text:?}");
    }
    let nan = read(
        plain().with(42_113, (2, b"nan\0".to_vec())).bytes(),
        "nodata = 3",
    )
    .unwrap_err();
    assert!(
        matches!(
            nan,
            HeightFileError::Grid {
                source: GridError::NotEarth { .. },
                ..
            }
        ),
        "{nan}"
    );
}

#[test]
fn truncated_and_lying_files_are_told() {
    for name in [
        "strips_i16_lzw.tif",
        "tiles_f32_deflate_be.tif",
        "points_big_i32.tif",
        "globe_u16.png",
        "south_first_f32.nc",
    ] {
        let bytes = std::fs::read(data(name)).unwrap();
        let sidecar = std::fs::read_to_string(data("globe_u16.toml")).unwrap();
        let sidecar = if name.ends_with("png") {
            sidecar.as_str()
        } else {
            ""
        };
        assert!(read(bytes.clone(), sidecar).is_ok(), "{name}");
        // The last bytes may be a checksum that nothing needs, or padding.
        for cut in (9..bytes.len() - 16).step_by(7) {
            let said = said(bytes[..cut].to_vec(), sidecar);
            assert!(said.len() < 600, "{said}");
            if cut > bytes.len() * 4 / 5 {
                assert!(
                    said.contains("truncated or damaged"),
                    "{name} at {cut}: {said}"
                );
            }
        }
    }
    // Sizes beyond the memory allowed are refused before it is asked for: this file is a header and nothing else.
    let mut huge = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut huge, 1_000_000, 900_000);
    encoder.set_depth(::png::BitDepth::Sixteen);
    drop(encoder.write_header());
    let told = said(huge, "unit = \"metres\"");
    assert!(
        told.contains("1000000 x 900000 samples would take")
            && told.contains("MB are allowed")
            && told.contains("gdalwarp -r average"),
        "{told}"
    );
    let strip = Plain::new().with(256, (4, 1_000_000u32.to_le_bytes().to_vec()));
    let strip = strip.with(257, shorts(&[1000])).with(278, shorts(&[1000]));
    assert!(
        said(strip.bytes(), "").contains("has strips or tiles of 2000 MB; expected at most 268 MB")
    );
    let wide = Plain::new().with(256, (4, u32::MAX.to_le_bytes().to_vec()));
    assert!(said(wide.bytes(), "").contains("expected 1 to 1048576 along each side"));
}

#[test]
fn sidecars_are_read_line_by_line() {
    let wrong = |text: &str| {
        Sidecar::from_toml(text, Path::new("dem.toml"))
            .unwrap_err()
            .to_string()
    };
    assert!(
        wrong("unit = \"m\"")
            .starts_with("dem.toml:1: unknown variant `m`, expected one of `metres`, `feet`")
    );
    assert!(wrong("unit = \"feet\"\nunits = 3").starts_with("dem.toml:2: unknown field `units`"));
    assert!(wrong("\n\nscale = 0").starts_with("dem.toml:3: scale is 0; expected"));
    assert!(wrong("offset = nan").contains("offset is NaN"));
    assert!(
        wrong("registration = \"cells\"")
            .contains("given in part or twice; expected bounds, or centre and spacing")
    );
    assert!(wrong("centre = { lat_deg = 1, lon_deg = 2 }").contains("registration is missing"));
    let with = |text: &str| wrong(&format!("registration = \"posts\"\n{text}"));
    assert!(
        with("bounds = { south_deg = 5, north_deg = 4, west_deg = 0, east_deg = 1 }")
            .starts_with("dem.toml:2: bounds are no place")
    );
    assert!(
        with("bounds = { south_deg = 5, north_deg = 6, west_deg = -200, east_deg = 300 }")
            .contains("wider than a turn")
    );
    assert!(
        with("bounds = { south_deg = 5, north_deg = 6, west_deg = nan, east_deg = 300 }")
            .contains("no place")
    );
    assert!(with("bounds = { south_deg = 5 }").contains("missing field `north_deg`"));
    assert!(
        with("centre = { lat_deg = 95, lon_deg = 2 }\nspacing = { lat_deg = 1, lon_deg = 1 }")
            .contains("dem.toml:3: centre or spacing is no place")
    );
    assert!(
        with("centre = { lat_deg = 5, lon_deg = 2 }\nspacing = { lat_deg = 0, lon_deg = 1 }")
            .contains("no place")
    );
    assert!(wrong("attribution = 3").starts_with("dem.toml:1: invalid type"));
    let long = format!("attribution = \"{}\"", "x".repeat(1001));
    assert!(wrong(&long).contains("more than 1000 characters"));
    assert!(wrong(&"#".repeat(70_000)).contains("longer than 65536 bytes"));
    assert!(wrong("unit = ").starts_with("dem.toml:1: "));
    let turn = Sidecar::from_toml(
        "bounds = { south_deg = -90, north_deg = 90, west_deg = 0, east_deg = 0 }\nregistration = \"cells\"",
        Path::new("dem.toml"),
    );
    let Some(SidecarPlace::Bounds(bounds, _)) = turn.unwrap().place else {
        panic!("bounds")
    };
    assert_eq!(bounds.width_rad, std::f64::consts::TAU);
}

#[test]
fn png_of_other_kinds_and_orders() {
    let globe = std::fs::read(data("globe_u16.png")).unwrap();
    let sidecar = std::fs::read_to_string(data("globe_u16.toml")).unwrap();
    // Read in the wrong order, hardly a height is one of the Earth.
    let little = format!("{sidecar}byte_order = \"little\"");
    assert!(said(globe.clone(), &little).contains("byte order"));
    assert!(said(globe.clone(), "").contains("does not say where it lies"));
    let no_unit = sidecar.replace("unit = \"metres\"\n", "");
    assert!(said(globe, &no_unit).contains("does not say whether its heights are metres or feet"));
    let encode = |colour, depth, bytes: &[u8]| {
        let mut file = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut file, 2, 1);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        encoder
            .write_header()
            .unwrap()
            .write_image_data(bytes)
            .unwrap();
        file
    };
    let rgb = encode(::png::ColorType::Rgb, ::png::BitDepth::Eight, &[0; 6]);
    assert!(
        said(rgb, &sidecar).contains("holds Rgb samples of 8 bits; expected one height a sample")
    );
    let byte = encode(
        ::png::ColorType::Grayscale,
        ::png::BitDepth::Eight,
        &[7, 200],
    );
    let file = read(byte, &sidecar.replace("-11000", "-100")).unwrap();
    assert_eq!(
        file.grid.height_m(0.0, std::f64::consts::FRAC_PI_2, 0.0),
        100.0
    );
    // The writer's mistake, and what mends it.
    let mut swapped = Vec::new();
    for height in [10_500u16, 11_700] {
        swapped.extend(height.to_le_bytes());
    }
    let swapped = encode(
        ::png::ColorType::Grayscale,
        ::png::BitDepth::Sixteen,
        &swapped,
    );
    assert_eq!(
        read(swapped, &little)
            .unwrap()
            .grid
            .height_m(0.0, std::f64::consts::FRAC_PI_2, 0.0),
        700.0
    );
}

#[test]
fn netcdf_of_other_kinds() {
    let good = std::fs::read(data("south_first_f32.nc")).unwrap();
    assert!(
        said(good.clone(), "variable = \"w\"")
            .contains("has no variable \"w\" over two dimensions; expected one of: z")
    );
    assert!(said(good.clone(), "unit = \"feet\"").contains("says that its heights are metres"));
    let replace = |from: &[u8], to: &[u8]| {
        let at = good
            .windows(from.len())
            .position(|w| w == from)
            .expect("there");
        let mut bytes = good.clone();
        bytes[at..at + to.len()].copy_from_slice(to);
        bytes
    };
    assert!(
        said(replace(b"degrees_north", b"metres_north_"), "")
            .contains("is in the coordinates \"lat\"")
    );
    assert!(
        said(replace(&41f64.to_be_bytes(), &41.5f64.to_be_bytes()), "")
            .contains("at unequal steps")
    );
    assert!(
        said(replace(&[0, 0, 0, 1, b'm'], &[0, 0, 0, 1, b'K']), "")
            .contains("has heights of the unit \"K\"")
    );
    assert!(
        said(
            replace(&[0, 0, 0, 10, 0, 0, 0, 2], &[0, 0, 0, 9, 0, 0, 0, 2]),
            ""
        )
        .contains("truncated or damaged")
    );
    // A list of four thousand million dimensions.
    assert!(
        said(
            replace(
                &[0, 0, 0, 10, 0, 0, 0, 2],
                &[0, 0, 0, 10, 255, 255, 255, 255]
            ),
            ""
        )
        .contains("truncated or damaged")
    );
}

#[test]
fn files_that_are_not_there_are_told() {
    let open = |path: &Path| {
        open_heights(path, &GridLimits::default())
            .unwrap_err()
            .to_string()
    };
    assert!(
        open(Path::new("nowhere/dem.tif")).contains("check that it is a file and its permissions")
    );
    assert!(open(&data("")).contains("is no file"));
}
