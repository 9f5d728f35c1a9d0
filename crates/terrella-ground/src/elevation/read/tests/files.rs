//! Files that are accepted.

use super::*;
use crate::elevation::{Elevation, Ground};
use std::sync::Arc;

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
fn places_are_reported_in_several_ways() {
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
    // A tie point inside, in the file's own NAD83, in radians.
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
    // By the sidecar alone: edges across the date line, and a centre.
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
fn units_are_reported_or_rejected() {
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
        "dem.tif: does not state the unit of its elevations; define it in dem.toml: write unit = \
         \"metres\", \"feet\" or \"us-survey-feet\" there, or for all files of the folder in its folder.toml"
    );
    assert_eq!(
        said(unit(&[(4099, 9001)]), "unit = \"feet\""),
        "dem.tif: has elevations in metres, but its sidecar or folder.toml says feet; correct unit there"
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

/// The grids of the starter pack are placed correctly: known heights, and each in the other's frame.
#[test]
fn the_starter_pack_is_read() {
    let textures = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("textures");
    let open = |name| open_heights(&textures.join(name), &GridLimits::default()).expect("good");
    let (globe, trinidad) = (open("elevation.png"), open("dem/trinidad.png"));
    assert!(globe.attribution.expect("reported").contains("ETOPO1"));
    let (globe, trinidad) = (Arc::new(globe.grid), Arc::new(trinidad.grid));
    assert_eq!(globe.stats().holes + trinidad.stats().holes, 0);
    assert_eq!(
        (globe.stats().quantum_m, trinidad.stats().quantum_m),
        (1.0, 1.0)
    );
    let range = trinidad.stats().range;
    assert_eq!((range.low_m, range.high_m), (1710.0, 4322.0));
    let at = |grid: &HeightGrid, lat: f64, lon: f64| {
        grid.height_m(lat.to_radians(), lon.to_radians(), 0.0)
    };
    // Challenger Deep, Tibet, the South Pole, the Pacific on both sides of the date line.
    assert!(at(&globe, 11.35, 142.2) < -7000.0);
    assert!(at(&globe, 32.0, 88.0) > 4500.0);
    assert!((at(&globe, -90.0, 0.0) - 2800.0).abs() < 150.0);
    assert!((at(&globe, 0.0, 179.999) - at(&globe, 0.0, -179.999)).abs() < 5.0);
    // Blanca Peak (4374 m) within half a kilometre, the San Luis Valley to its west, the plains in the
    // east.
    let mut peak: f64 = 0.0;
    for n in 0..100 {
        let (v, u) = (
            f64::from(n / 10) / 10.0 - 0.5,
            f64::from(n % 10) / 10.0 - 0.5,
        );
        peak = peak.max(at(&trinidad, 37.5775 + 0.01 * v, -105.4856 + 0.01 * u));
    }
    assert!(peak > 4200.0, "{peak}");
    assert!((at(&trinidad, 37.5, -105.64) - 2310.0).abs() < 60.0);
    assert!(at(&trinidad, 37.7, -104.8) < 2000.0);
    // Averaged to the spacing of the globe's samples, both agree.
    let ground = Ground::new([Arc::clone(&globe), Arc::clone(&trinidad)]);
    let (lat, lon) = (37.6_f64.to_radians(), -105.2_f64.to_radians());
    let coarse = globe.finest_spacing_rad();
    let difference = trinidad.height_m(lat, lon, coarse) - globe.height_m(lat, lon, coarse);
    assert!(difference.abs() < 150.0, "{difference}");
    assert_eq!(
        ground.height_m(lat, lon, 0.0),
        trinidad.height_m(lat, lon, 0.0)
    );
    assert_eq!(
        ground.height_m(0.3, 0.4, 0.0),
        globe.height_m(0.3, 0.4, 0.0)
    );
}

/// A single wrong height is drawn as it is, or removed on request.
#[test]
fn single_wrong_heights_are_taken_out_if_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("needle.png");
    let picture = image::ImageBuffer::from_fn(24, 16, |x, y| {
        let needle = if (x, y) == (11, 6) { 4000 } else { 0 };
        image::Luma([1000 + 5 * x as u16 + 9 * y as u16 + needle])
    });
    picture.save(&path).expect("written");
    let sidecar = "bounds = { south_deg = 10, north_deg = 25, west_deg = 0, east_deg = 23 }\n\
                   registration = \"posts\"\nunit = \"metres\"\n";
    std::fs::write(path.with_extension("toml"), sidecar).expect("written");
    let limits = GridLimits::default();
    let plain = open_heights(&path, &limits).expect("good");
    assert_eq!(
        (plain.denoised, plain.grid.stats().range.high_m),
        (None, 5109.0)
    );
    let clean = open_heights_denoised(&path, &limits, Some(&Denoise::default())).expect("good");
    let found = clean.denoised.expect("looked for");
    assert_eq!((found.replaced, found.kept), (1, 0));
    assert!((found.moved_m - 4000.0).abs() < 20.0);
    assert_eq!(clean.grid.stats().range.high_m, 1250.0);
    let needle_m = clean
        .grid
        .height_m(19_f64.to_radians(), 11_f64.to_radians(), 0.0);
    assert!((needle_m - 1109.0).abs() < 20.0, "{needle_m}");
}

#[test]
fn heights_above_the_ellipsoid_are_brought_to_the_sea() {
    use crate::elevation::geoid::{VerticalDatum, geoid_m};
    let with = |pairs: &[(u16, u16)], sidecar: &str| {
        let all = [&[(1024, 2), (1025, 1), (4099, 9001)], pairs].concat();
        read(Plain::new().with(34_735, keys(&all)).bytes(), sidecar)
    };
    let height = |lat: f64, lon: f64| 100.0 * ((49.5 - lat) * 6.0 + lon - 10.5);
    let lowered =
        |lat: f64, lon: f64| height(lat, lon) - geoid_m(lat.to_radians(), lon.to_radians());
    // About 47 m there.
    assert!(height(48.0, 12.0) - lowered(48.0, 12.0) > 44.0);
    for (pairs, sidecar, above) in [
        (&[(2048, 4326)][..], "", None),
        (
            &[(2048, 4326), (4096, 5773)],
            "",
            Some(VerticalDatum::Egm96),
        ),
        (
            &[(2048, 4326), (4096, 3855)],
            "above = \"egm2008\"",
            Some(VerticalDatum::Egm2008),
        ),
        (&[(2048, 4326), (4096, 5703)], "", Some(VerticalDatum::Sea)),
        (&[(2048, 4979)], "", Some(VerticalDatum::Ellipsoid)),
        (
            &[(2048, 4326), (4096, 5030)],
            "",
            Some(VerticalDatum::Ellipsoid),
        ),
        // ETRS89 and GDA2020 with height, as GDAL writes them.
        (
            &[(2048, 4258), (4096, 4937)],
            "",
            Some(VerticalDatum::Ellipsoid),
        ),
        (&[(2048, 7843)], "", Some(VerticalDatum::Ellipsoid)),
        (
            &[(2048, 4326)],
            "above = \"ellipsoid\"",
            Some(VerticalDatum::Ellipsoid),
        ),
        // A vertical system overrides the datum of WGS84 with height.
        (
            &[(2048, 4979), (4096, 5773)],
            "",
            Some(VerticalDatum::Egm96),
        ),
    ] {
        let file = with(pairs, sidecar).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(file.above, above);
        match above {
            Some(VerticalDatum::Ellipsoid) => holds(&file, NORTH_WEST, 1.0, (6, 4), lowered),
            _ => holds(&file, NORTH_WEST, 1.0, (6, 4), height),
        }
    }
    for depth in [5715, 5861, 6358] {
        let said = with(&[(2048, 4326), (4096, depth)], "").expect_err("depths");
        let words = format!("has depths (EPSG:{depth}), which grow downwards");
        assert!(said.to_string().contains(&words), "{said}");
    }
    let said = with(&[(2048, 4326), (4096, 5773)], "above = \"ellipsoid\"").expect_err("two");
    assert!(
        said.to_string()
            .contains("heights above egm96, but its sidecar says above ellipsoid")
    );
    let said = with(&[(2048, 4326)], "above = \"moon\"")
        .expect_err("none")
        .to_string();
    assert!(
        said.contains("dem.toml:1: unknown variant `moon`"),
        "{said}"
    );
}

/// Planes over the metres of UTM and of polar stereographic stay planes at the corresponding places.
#[test]
fn projected_heights_are_warped() {
    use crate::elevation::projection::Projection;
    let heights: Vec<u8> = (0..64 * 48)
        .flat_map(|n: i16| (10 * (n % 64) + 5 * (n / 64)).to_le_bytes())
        .collect();
    for (code, west_m, north_m) in [
        (32_633, 400_000.0, 5_200_000.0),
        (3413, -500_000.0, -800_000.0),
    ] {
        let file = |step_m: f64, north_m: f64| {
            Plain::new()
                .with(256, shorts(&[64]))
                .with(257, shorts(&[48]))
                .with(278, shorts(&[48]))
                .with(33_550, doubles(&[1000.0, step_m, 0.0]))
                .with(33_922, doubles(&[0.0, 0.0, 0.0, west_m, north_m, 0.0]))
                .with(
                    34_735,
                    keys(&[(1024, 1), (1025, 1), (3072, code), (4099, 9001)]),
                )
                .samples(16, 2, heights.clone())
        };
        for is_south_first in [false, true] {
            let (step_m, top_m) = if is_south_first {
                (-1000.0, north_m - 48_000.0)
            } else {
                (1000.0, north_m)
            };
            let read =
                read(file(step_m, top_m).bytes(), "").unwrap_or_else(|error| panic!("{error}"));
            let projection = Projection::of_code(code).expect("known");
            for n in 0..50 {
                let part = f64::from(n) / 50.0;
                let (column, row) = (8.0 + 47.0 * part, 8.0 + 31.0 * (part * 7.3).fract());
                let (lat_rad, lon_rad) = projection.inverse_rad(
                    west_m + (column + 0.5) * 1000.0,
                    north_m - (row + 0.5) * 1000.0,
                );
                let row = if is_south_first { 47.0 - row } else { row };
                let (got, right) = (
                    read.grid.height_m(lat_rad, lon_rad, 0.0),
                    10.0 * column + 5.0 * row,
                );
                assert!((got - right).abs() < 0.05, "{code} {n}: {got} for {right}");
            }
        }
    }
    // Keys that spell out EPSG:32633, and one that is no projection near WGS84.
    let spelt_of = |geographic: u16, datum: u16| {
        let mut directory = vec![
            1, 1, 0, 10, 1024, 0, 1, 1, 1025, 0, 1, 1, 2048, 0, 1, geographic, 2050, 0, 1, datum,
            3072, 0, 1, 32_767,
        ];
        directory.extend([
            3075, 0, 1, 1, 3080, 34_736, 1, 0, 3082, 34_736, 1, 1, 3092, 34_736, 1, 2, 4099, 0, 1,
            9001,
        ]);
        Plain::new()
            .with(34_735, shorts(&directory))
            .with(34_736, doubles(&[15.0, 500_000.0, 0.9996]))
            .with(33_550, doubles(&[1000.0, 1000.0, 0.0]))
            .with(
                33_922,
                doubles(&[0.0, 0.0, 0.0, 400_000.0, 5_200_000.0, 0.0]),
            )
    };
    let spelt = |geographic| spelt_of(geographic, 6326);
    // As GDAL writes the text "+proj=utm +zone=33 +datum=WGS84".
    assert!(read(spelt_of(32_767, 6326).bytes(), "").is_ok());
    assert!(read(spelt_of(32_767, 32_767).bytes(), "").is_err());
    assert!(read(spelt_of(32_767, 6267).bytes(), "").is_err());
    // With two samples around.
    let bounds = read(spelt(4326).bytes(), "").expect("good").grid.bounds();
    let (_, west) = Projection::of_code(32_633)
        .expect("known")
        .inverse_rad(398_500.0, 5_196_500.0);
    let (north, _) = Projection::of_code(32_633)
        .expect("known")
        .inverse_rad(405_500.0, 5_201_500.0);
    assert!((bounds.west_rad - west).abs() < 1e-4 && (bounds.north_rad - north).abs() < 1e-4);
    assert!(said(spelt(4267).bytes(), "").contains("projected coordinates of its own making"));
}
