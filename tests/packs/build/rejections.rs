//! Bad files: an error with the file and the remedy, and no large allocation.

use super::maps::{
    Geo, HEIGHT, LIMITS, WIDTH, fixture, jpeg, open, png, read, read_within, rgb_map, rgb_tiff,
    tiff, u16_tiff, wide_map,
};
use image::ExtendedColorType;
use std::path::Path;
use terrella_pack::source::{SourceLimits, open_source};
use terrella_pack::{BuildError, BuildOptions, Relief, build};
use tiff::encoder::Compression;
use tiff::encoder::colortype::{Gray8, RGB8};
use tiff::tags::Tag;

/// The error of a file that must be rejected.
fn complaint(bytes: &[u8]) -> String {
    match read(bytes) {
        Ok((info, _)) => panic!("taken as {info:?}"),
        Err(error) => {
            let said = error.to_string();
            assert!(said.starts_with("dir/map.x: "), "{said}");
            assert!(said.contains("; "), "no advice: {said}");
            said
        }
    }
}

fn noise(count: usize) -> Vec<u8> {
    let mut state = 88_172_645_463_325_252_u64;
    (0..count)
        .map(|_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 24) as u8
        })
        .collect()
}

#[test]
fn truncated_files_are_never_grey() {
    let noise = noise(256 * 128 * 3);
    let baseline = jpeg(256, &noise, false);
    let files = [
        ("baseline JPEG", baseline.clone()),
        ("progressive JPEG", jpeg(256, &noise, true)),
        ("PNG", png(256, 128, ExtendedColorType::Rgb8, &noise)),
        (
            "TIFF",
            tiff::<RGB8>((256, 128), &noise, Compression::Lzw, false, &Geo::default()),
        ),
        ("tiled TIFF", fixture("tiled_lzw.tif")),
        ("interlaced PNG", fixture("interlaced.png")),
    ];
    for (what, bytes) in files {
        read(&bytes).unwrap_or_else(|error| panic!("{what}: {error}"));
        let length = bytes.len();
        // The tiled TIFF ends with tags that no reader needs.
        let last = if what == "tiled TIFF" {
            length / 2
        } else {
            length - 20
        };
        for keep in [0, 1, 2, 3, 9, 30, 100, length / 3, length / 2, last] {
            let said = read(&bytes[..keep])
                .map(|(info, _)| info)
                .expect_err(what)
                .to_string();
            assert!(said.contains("dir/map.x"), "{what} {keep}: {said}");
        }
    }
    // Cut, and an end put on: what a careless copier does. It is seen more than a few rows before the last.
    let baseline = jpeg(1024, &self::noise(1024 * 512 * 3), false);
    let mut ended = baseline[..baseline.len() / 2].to_vec();
    ended.extend_from_slice(&[0xFF, 0xD9]);
    assert!(
        complaint(&ended).contains("data end at row"),
        "{}",
        complaint(&ended)
    );
    // Also where the last rows alone are missing, and of a progressive picture the last scans.
    let progressive = jpeg(256, &noise, true);
    for whole in [&baseline, &progressive] {
        let late = [&whole[..whole.len() - 200], &[0xFF, 0xD9]].concat();
        complaint(&late);
    }
    // A PNG without its end, interlaced or not.
    let png = png(256, 128, ExtendedColorType::Rgb8, &noise);
    for whole in [png, fixture("interlaced.png")] {
        assert!(complaint(&whole[..whole.len() - 12]).contains("ends too early"));
    }
    // A marker in the middle of the picture, the rest behind it.
    let mut marked = baseline.clone();
    let middle = marked.len() / 2;
    marked[middle..middle + 2].copy_from_slice(&[0xFF, 0xD9]);
    assert!(
        complaint(&marked).contains("data end at row"),
        "{}",
        complaint(&marked)
    );
}

#[test]
fn tampered_png_and_tiff_are_found() {
    let noise = noise(256 * 128 * 3);
    let mut bytes = png(256, 128, ExtendedColorType::Rgb8, &noise);
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    complaint(&bytes);
    let deflate = Compression::Deflate(Default::default());
    let mut bytes = tiff::<RGB8>((256, 128), &noise, deflate, false, &Geo::default());
    let length = bytes.len();
    for place in (length / 4..length / 2).step_by(101) {
        bytes[place] ^= 0x55;
    }
    complaint(&bytes);
}

#[test]
fn progressive_jpegs_beyond_the_budget_are_rejected_with_advice() {
    let texels = noise(512 * 256 * 3);
    let progressive = jpeg(512, &texels, true);
    let tight = SourceLimits {
        buffer_bytes: 100_000,
    };
    let error = read_within(&progressive, tight).expect_err("too large to hold");
    assert!(error.to_string().contains("jpegtran"), "{error}");
    read_within(&progressive, LIMITS).expect("fits");
    read_within(&jpeg(512, &texels, false), tight).expect("read in strips");

    let error = read_within(
        &fixture("interlaced.png"),
        SourceLimits { buffer_bytes: 1000 },
    );
    let error = error.expect_err("too large to hold");
    assert!(error.to_string().contains("-interlace none"), "{error}");

    let strips = rgb_tiff(Compression::Uncompressed, false);
    let error =
        read_within(&strips, SourceLimits { buffer_bytes: 1000 }).expect_err("large strips");
    assert!(error.to_string().contains("tiffcp -r 16"), "{error}");
}

#[test]
fn other_sizes_are_rejected_before_anything_is_allocated() {
    for (width, height) in [(64, 31), (64, 34), (8, 4), (64, 64)] {
        let grey = vec![7; width as usize * height as usize];
        let files = [
            png(width, height, ExtendedColorType::L8, &grey),
            tiff::<Gray8>(
                (width, height),
                &grey,
                Compression::Uncompressed,
                false,
                &Geo::default(),
            ),
        ];
        for bytes in files {
            let said = complaint(&bytes);
            assert!(said.contains(&format!("{width} x {height}")), "{said}");
            assert!(said.contains("twice as wide as high"), "{said}");
        }
    }
    // Off by one is a matter of rounding.
    let grey = vec![7; 65 * 32];
    read(&png(65, 32, ExtendedColorType::L8, &grey)).expect("nearly two to one");

    // Headers that promise more than can be: 131 073 × 65 537, and the most a header holds.
    for (width, height) in [(131_074_u32, 65_537_u32), (u32::MAX / 2 - 1, u32::MAX / 4)] {
        let mut bytes = png(64, 32, ExtendedColorType::L8, &[7; 2048]);
        bytes[16..20].copy_from_slice(&width.to_be_bytes());
        bytes[20..24].copy_from_slice(&height.to_be_bytes());
        // The header's checksum is reported after its size, or before: rejected in either case.
        complaint(&bytes);
    }
    let mut bytes = jpeg(64, &rgb_map(), false);
    let frame = bytes
        .windows(2)
        .position(|pair| pair == [0xFF, 0xC0])
        .expect("a frame");
    bytes[frame + 5..frame + 9].copy_from_slice(&[0xFF, 0xFF, 0xFF, 0xFF]);
    assert!(complaint(&bytes).contains("65535 x 65535"));
    // Twice as high and wide as the data: they end early.
    bytes[frame + 5..frame + 9].copy_from_slice(&[0x08, 0x00, 0x10, 0x00]);
    assert!(complaint(&bytes).contains("end"), "{}", complaint(&bytes));
}

#[test]
fn other_kinds_are_rejected() {
    assert!(complaint(b"GIF89a......").contains("neither PNG nor JPEG nor TIFF"));
    assert!(complaint(b"").contains("neither"));
    let folder = tempfile::tempdir().expect("a folder");
    for path in [folder.path(), Path::new("no/such/map.png")] {
        let error = open_source(path, LIMITS)
            .map(|source| source.info())
            .expect_err("no map");
        assert!(
            error.to_string().contains(&path.display().to_string()),
            "{error}"
        );
    }
}

#[test]
fn geotiffs_elsewhere_are_rejected() {
    let geo = |scale: f64, left: f64, model: u16| Geo {
        doubles: vec![
            (Tag::ModelPixelScaleTag, vec![scale, scale, 0.0]),
            (Tag::ModelTiepointTag, vec![0.0, 0.0, 0.0, left, 90.0, 0.0]),
        ],
        shorts: vec![(
            Tag::GeoKeyDirectoryTag,
            vec![1, 1, 0, 2, 1024, 0, 1, model, 1025, 0, 1, 1],
        )],
    };
    let degrees = 360.0 / f64::from(WIDTH);
    let file = |geo| u16_tiff(&wide_map(1), &geo);
    read(&file(geo(degrees, -180.0, 2))).expect("the whole globe");
    for (geo, word) in [
        (geo(degrees, 0.0, 2), "longitudes 0.0000 to 360.0000"),
        (geo(degrees / 2.0, -180.0, 2), "gdalwarp"),
        (geo(degrees, -180.0, 1), "projected"),
    ] {
        let said = complaint(&file(geo));
        assert!(said.contains(word), "{said}");
    }
}

#[test]
fn other_figures_and_meridians_are_rejected_as_in_heights() {
    let degrees = 360.0 / f64::from(WIDTH);
    let file = |keys: &[(u16, u16)]| {
        let mut directory = vec![1, 1, 0, keys.len() as u16];
        directory.extend(keys.iter().flat_map(|(key, value)| [*key, 0, 1, *value]));
        let geo = Geo {
            doubles: vec![
                (Tag::ModelPixelScaleTag, vec![degrees, degrees, 0.0]),
                (
                    Tag::ModelTiepointTag,
                    vec![0.0, 0.0, 0.0, -180.0, 90.0, 0.0],
                ),
            ],
            shorts: vec![(Tag::GeoKeyDirectoryTag, directory)],
        };
        u16_tiff(&wide_map(1), &geo)
    };
    read(&file(&[(1024, 2), (2048, 4326), (2054, 9102)])).expect("WGS84");
    read(&file(&[(1024, 2), (2048, 4269)])).expect("NAD83");
    for (keys, word) in [
        (&[(1024, 2), (2048, 4267)][..], "EPSG:4267"),
        (&[(1024, 2), (2048, 4807), (2054, 9105)], "EPSG:4807"),
        (&[(1024, 2), (2048, 32_767)], "of its own making"),
        (&[(1024, 2), (2048, 4326), (2051, 8903)], "EPSG:8903"),
        (&[(1024, 2), (2048, 4326), (2054, 9105)], "EPSG:9105"),
        (&[(1024, 1), (3072, 32_633)], "projected"),
    ] {
        let said = complaint(&file(keys));
        assert!(said.contains(word) && said.contains("gdalwarp"), "{said}");
    }
}

#[test]
fn turned_and_short_tiffs_are_rejected() {
    let turned = Geo {
        shorts: vec![(Tag::Orientation, vec![3])],
        ..Geo::default()
    };
    let said = complaint(&u16_tiff(&wide_map(1), &turned));
    assert!(
        said.contains("upside down") && said.contains("-auto-orient"),
        "{said}"
    );
    // Each strip of seven rows has 896 bytes: one claims fewer, and would be read on into the next.
    let mut bytes = u16_tiff(&wide_map(1), &Geo::default());
    let lengths: Vec<u8> = [896_u32; 4].iter().flat_map(|n| n.to_le_bytes()).collect();
    let at = bytes.windows(16).position(|found| found == lengths);
    let at = at.expect("lengths");
    bytes[at..at + 4].copy_from_slice(&600_u32.to_le_bytes());
    let said = complaint(&bytes);
    assert!(said.contains("600 bytes"), "{said}");
}

#[test]
fn maps_of_the_wrong_kind_for_their_layer_are_rejected() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("a writable folder");
        path
    };
    let colour = write(
        "colour.png",
        &png(WIDTH, HEIGHT, ExtendedColorType::Rgb8, &rgb_map()),
    );
    let grey = write(
        "grey.png",
        &png(WIDTH, HEIGHT, ExtendedColorType::L8, &vec![9; 2048]),
    );
    let signed = write("signed.tif", &super::maps::i16_tiff(&[5; 2048]));
    let out = folder.path().join("pack");
    let good = BuildOptions::new(&colour, &out);
    let rejected = |options: BuildOptions, word: &str| {
        let error = build(&options, &()).expect_err(word);
        assert!(error.to_string().contains(word), "{error}");
        assert!(!out.exists(), "nothing is begun: {word}");
    };
    rejected(BuildOptions::new(&signed, &out), "needs 8- or 16-bit sRGB");
    let with_clouds = BuildOptions {
        clouds: Some(signed.clone()),
        ..good.clone()
    };
    rejected(with_clouds, "float (0 to 1)");
    let relief = |relief| BuildOptions {
        relief: Some(relief),
        ..good.clone()
    };
    rejected(relief(Relief::Normals(grey.clone())), "use --elevation");
    let elevation = |path: &Path, offset_m, exaggeration| {
        relief(Relief::Elevation {
            path: path.into(),
            offset_m,
            exaggeration,
        })
    };
    rejected(elevation(&grey, None, 4.0), "elevations need 16-bit");
    rejected(elevation(&signed, None, f64::NAN), "--exaggeration");
    rejected(
        elevation(&signed, Some(f64::INFINITY), 4.0),
        "--elevation-offset",
    );
    let control = BuildOptions {
        attribution: vec!["two\nlines".to_string()],
        ..good.clone()
    };
    rejected(control, "attribution");
    let memory = BuildOptions {
        memory_bytes: 30_000_000,
        ..good
    };
    let error = build(&memory, &()).expect_err("too little");
    assert!(matches!(error, BuildError::Memory { .. }), "{error}");
}

#[test]
fn a_source_gives_no_rows_beyond_its_last() {
    let colour = rgb_map();
    for bytes in [
        png(WIDTH, HEIGHT, ExtendedColorType::Rgb8, &colour),
        jpeg(WIDTH, &colour, false),
        rgb_tiff(Compression::Lzw, false),
        fixture("interlaced.png"),
    ] {
        let mut source = open(&bytes, LIMITS).expect("a good map");
        let mut row = vec![0; source.info().row_bytes()];
        for _ in 0..HEIGHT {
            source.next_row(&mut row).expect("a row");
        }
        source.next_row(&mut row).expect_err("no more");
    }
}
