//! Files that are rejected.

use super::*;

#[test]
fn other_coordinates_are_named_with_the_command() {
    let of = |pairs: &[(u16, u16)]| said(Plain::new().with(34_735, keys(pairs)).bytes(), "");
    assert_eq!(
        of(&[(1024, 1), (3072, 27_700), (4099, 9001)]),
        "dem.tif: is in the projected coordinates EPSG:27700; expected latitudes and longitudes of WGS84: `gdalwarp -t_srs \
         EPSG:4326 -r bilinear dem.tif OUT.tif`"
    );
    assert!(of(&[(1024, 1), (3072, 32_767)]).contains("projected coordinates of its own making"));
    assert!(of(&[(3072, 2056)]).contains("EPSG:2056"));
    assert!(of(&[(1024, 2), (2048, 4277)]).contains("the geographic coordinates EPSG:4277"));
    assert!(of(&[(1024, 3)]).contains("geocentric"));
    assert!(of(&[(1024, 9)]).contains("unknown model 9"));
    assert!(of(&[(1024, 2), (2048, 4326), (2054, 9105)]).contains("angles of the unit EPSG:9105"));
    assert!(of(&[(1025, 1)]).contains("does not state its coordinate system"));
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
        "dem.tif: has no bounds; define them in dem.toml: write bounds = { south_deg = …, north_deg = …, \
         west_deg = …, east_deg = … } and registration = \"cells\" or \"posts\" there"
    );
    let bounds = "bounds = { south_deg = 1, north_deg = 2, west_deg = 3, east_deg = 4 }\nregistration = \"cells\"";
    assert!(
        said(Plain::new().bytes(), bounds).contains("contains bounds, and so does its sidecar")
    );
    assert!(
        said(Plain::new().bytes(), "byte_order = \"big\"")
            .contains("take byte_order out of the sidecar")
    );
    assert!(said(Plain::new().bytes(), "variable = \"z\"").contains("the sidecar names one"));
}

#[test]
fn files_that_hold_no_heights_are_rejected() {
    let rgb = Plain::new()
        .with(277, shorts(&[3]))
        .with(258, shorts(&[16, 16, 16]))
        .with(339, shorts(&[1, 1, 1]))
        .with(262, shorts(&[2]));
    assert!(said(rgb.bytes(), "").contains("holds colours"));
    let white = Plain::new().with(262, shorts(&[0]));
    assert!(said(white.bytes(), "").contains("counts from white to black"));
    let lzma = Plain::new().with(259, shorts(&[34_925]));
    let lzma = said(lzma.bytes(), "");
    assert!(lzma.contains("is compressed by LZMA") && lzma.contains("gdal_translate"));
    assert!(
        said(
            Plain::new().with(42_113, (2, b"none\0".to_vec())).bytes(),
            ""
        )
        .contains("no-data value \"none")
    );
    assert!(said(b"GIF89a and so on".to_vec(), "").contains("gdal_translate -of GTiff dem.tif"));
    assert!(said(Vec::new(), "").contains("none of the files"));
    // Feet declared as metres, bytes in the wrong order.
    let high = |value: i16| {
        Plain::new()
            .samples(16, 2, value.to_le_bytes().repeat(24))
            .bytes()
    };
    for value in [29_032, 8848i16.swap_bytes()] {
        assert!(
            said(high(value), "")
                .contains("correct unit, scale, offset, no-data value or byte order")
        );
    }
    for sidecar in ["", "nodata = -32768"] {
        assert!(said(high(-32_768), sidecar).contains("has no data in any sample"));
    }
    assert!(said(high(-32_768), "nodata = nan").contains("correct unit, scale"));
}

#[test]
fn truncated_and_lying_files_are_reported() {
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
        // The last bytes may be an unneeded checksum or padding.
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
    // Sizes beyond the memory limit are rejected before allocation: this file is only a header.
    let mut huge = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut huge, 1_000_000, 900_000);
    encoder.set_depth(::png::BitDepth::Sixteen);
    let mut writer = encoder.write_header().unwrap();
    writer.write_chunk(::png::chunk::IDAT, &[0x78, 1]).unwrap();
    drop(writer);
    let reported = said(huge, "unit = \"metres\"");
    assert!(
        reported.contains("1000000 x 900000 samples would take")
            && reported.contains("MB are allowed")
            && reported.contains("gdalwarp -r average"),
        "{reported}"
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
    let Some(SidecarGeoreference::Bounds(bounds, _)) = turn.unwrap().georeference else {
        panic!("bounds")
    };
    assert_eq!(bounds.width_rad, std::f64::consts::TAU);
}

#[test]
fn png_of_other_kinds_and_orders() {
    let globe = std::fs::read(data("globe_u16.png")).unwrap();
    let sidecar = std::fs::read_to_string(data("globe_u16.toml")).unwrap();
    // In the wrong byte order, almost no height is possible on Earth.
    let little = format!("{sidecar}byte_order = \"little\"");
    assert!(said(globe.clone(), &little).contains("byte order"));
    assert!(said(globe.clone(), "").contains("has no bounds"));
    let no_unit = sidecar.replace("unit = \"metres\"\n", "");
    assert!(said(globe, &no_unit).contains("does not state the unit of its elevations"));
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
    // The writer's mistake, and its remedy.
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
    assert!(said(good.clone(), "unit = \"feet\"").contains("has elevations in metres"));
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
    // A list of four billion dimensions.
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
fn files_that_are_not_there_are_reported() {
    let open = |path: &Path| {
        open_heights(path, &GridLimits::default())
            .unwrap_err()
            .to_string()
    };
    assert!(
        open(Path::new("nowhere/dem.tif")).contains("check that it is a file and its permissions")
    );
    assert!(open(&data("")).contains("not a file"));
}

#[test]
fn a_virtual_raster_that_changes_its_files_is_rejected() {
    let gdal = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/data/gdal"
    ));
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for name in ["part_west.tif", "part_east.tif", "folder.toml"] {
        std::fs::copy(gdal.join(name), path(name)).expect("copied");
    }
    let whole = std::fs::read_to_string(gdal.join("heights.vrt")).expect("a file");
    let set = |text: &str| {
        std::fs::write(path("all.vrt"), text).expect("written");
        crate::elevation::height_set(&path("all.vrt")).map_err(|error| error.to_string())
    };
    assert_eq!(set(&whole).expect("good").len(), 2);
    for (from, to, words) in [
        (
            "DstRect xOff=\"36\"",
            "DstRect xOff=\"37\"",
            "where the file does not",
        ),
        (
            "<GeoTransform>-180, 5",
            "<GeoTransform>-180, 6",
            "where the file does not",
        ),
        (
            "SrcRect xOff=\"0\" yOff=\"0\" xSize=\"36\"",
            "SrcRect xOff=\"1\" yOff=\"0\" xSize=\"35\"",
            "takes a part of",
        ),
        (
            "<NODATA>-32768</NODATA>",
            "<NODATA>7</NODATA>",
            "write nodata = 7 into its sidecar",
        ),
        (
            "<NODATA>-32768</NODATA>",
            "<ScaleRatio>2</ScaleRatio>",
            "scales",
        ),
        (
            "<NoDataValue>",
            "<Scale>0.1</Scale><NoDataValue>",
            "another scale or offset",
        ),
        (
            "<SourceBand>1",
            "<SourceBand>2",
            "another band than the first",
        ),
        ("part_east.tif", "part_none.tif", "part_none.tif"),
        (
            "part_east.tif",
            "all.vrt",
            "another virtual raster as a source",
        ),
        (
            "<VRTRasterBand",
            "<VRTRasterBand band=\"2\"></VRTRasterBand><VRTRasterBand",
            "has 2 bands",
        ),
    ] {
        let text = whole.replace(from, to);
        assert_ne!(text, whole, "{from}");
        let said = set(&text).expect_err(to);
        assert!(said.contains(words), "{to}: {said}");
    }
}
