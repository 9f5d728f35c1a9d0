//! Compares maps written by GDAL with GDAL's own reading.

use crate::source::{Opacity, SampleKind, SourceLimits, open_source};
use std::collections::BTreeMap;
use std::path::Path;

const LIMITS: SourceLimits = SourceLimits {
    buffer_bytes: 1 << 20,
};

/// Columns of the files.
const COLUMNS: usize = 72;

/// All 8-bit texels of a file, the number of channels, and the meaning of the last.
fn texels(name: &str) -> (Vec<u8>, usize, Option<Opacity>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data");
    let source = open_source(&folder.join(name), LIMITS);
    let mut source = source.unwrap_or_else(|error| panic!("{error}"));
    let info = source.info();
    let mut all = Vec::new();
    let mut row = vec![0; info.row_bytes()];
    for _ in 0..info.height {
        source.next_row(&mut row).expect("a row");
        all.extend(&row);
    }
    (all, info.channels, info.opacity)
}

/// Palette entry `n` of make.py.
fn colour(n: usize) -> [f64; 3] {
    [n * 17 % 256, 255 - n * 15, n * 40 % 256].map(|channel| channel as f64)
}

#[test]
fn maps_of_gdal_are_read_however_they_are_compressed() {
    let text = include_str!("../../../../../tests/data/gdal/expected.txt");
    let kinds = ["jpeg", "webp", "palette", "grey", "zstd_planar", "lerc_u8"];
    let mut files = BTreeMap::new();
    for line in text
        .lines()
        .filter(|line| kinds.iter().any(|kind| line.starts_with(kind)))
    {
        let (name, numbers) = line.split_once(' ').expect("numbers");
        let numbers: Vec<f64> = numbers
            .split(' ')
            .map(|n| n.parse().expect("a number"))
            .collect();
        let (all, channels, opacity) = files
            .entry(name)
            .or_insert_with(|| texels(&format!("gdal/{name}")));
        let (x, y) = (numbers[0] as usize, numbers[1] as usize);
        let got = &all[(y * COLUMNS + x) * *channels..][..*channels];
        let bits = name
            .trim_end_matches(".tif")
            .chars()
            .last()
            .and_then(|c| c.to_digit(10));
        let mut right = match (name, bits) {
            (name, Some(_)) if name.starts_with("palette") => colour(numbers[2] as usize).to_vec(),
            (name, Some(bits)) if name.starts_with("grey") => {
                vec![numbers[2] * 255.0 / (2_f64.powi(bits as i32) - 1.0)]
            }
            _ => numbers[2..].to_vec(),
        };
        if name == "jpeg_mask.tif" {
            assert_eq!(*opacity, Some(Opacity::Mask));
            // Northern rows are masked, and their contents are hidden.
            right = match y < 12 {
                true => vec![0.0; 4],
                false => [right.as_slice(), &[255.0]].concat(),
            };
        }
        let most = match name {
            "jpeg_ycbcr.tif" | "jpeg_mask.tif" => 8.0,
            _ if name.starts_with("jpeg") => 1.0,
            "webp_lossy.tif" => 2.0,
            _ => 0.0,
        };
        assert_eq!(got.len(), right.len(), "{name}");
        for (got, right) in got.iter().zip(right) {
            assert!((f64::from(*got) - right).abs() <= most, "{line}: {got}");
        }
    }
    assert_eq!(files.len(), 16);
}

#[test]
fn what_decoding_takes_is_counted() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/gdal");
    let limits = SourceLimits {
        buffer_bytes: 3 * 32 * 16 * 3 + 72 * 16 * 3,
    };
    let opened = open_source(&folder.join("zstd_planar.tif"), limits);
    let error = opened.err().expect("too large").to_string();
    assert!(error.contains("a row of its strips or tiles"), "{error}");
}

/// Written by rasterio 1.4.4 with `photometric="RGB"`: 4 bands in LZW with a predictor and 5 in ZSTD, none of which is alpha. Band c holds
/// 3 x + 5 y + 60 c mod 256.
#[test]
fn channels_beside_the_colours_are_left_out() {
    for name in ["maps/infrared.tif", "maps/infrared_zstd.tif"] {
        let (all, channels, opacity) = texels(name);
        assert_eq!((channels, opacity), (3, None), "{name}");
        for (n, got) in all.iter().enumerate() {
            let (c, x, y) = (n % 3, n / 3 % COLUMNS, n / 3 / COLUMNS);
            let right = (3 * x + 5 * y + 60 * c) % 256;
            assert_eq!(usize::from(*got), right, "{name} {x} {y}");
        }
    }
}

/// Written by rasterio 1.4.4. Fields of 50 x 25 texels have one colour, so LZW tiles have few codes, and the last column of tiles is half
/// outside. Tiles of 16 x 16 have fewer bytes than the file's tags. One file is declared grey but has a palette, as GDAL writes it if colours
/// are set last.
#[test]
fn tiles_of_gdal_are_read_whole() {
    for (name, columns) in [
        ("lzw_tiles", 80),
        ("lzw_tiles_planar", 80),
        ("small_tiles", 100),
        ("palette_as_grey", 80),
    ] {
        let (all, channels, _) = texels(&format!("maps/{name}.tif"));
        assert_eq!(
            (channels, all.len()),
            (3, 3 * columns * columns / 2),
            "{name}"
        );
        for (n, got) in all.chunks_exact(3).enumerate() {
            let field = n % columns / 50 + n / columns / 25;
            let right = match name {
                "palette_as_grey" => [[20, 60, 100], [230, 200, 170]][field % 2],
                _ => [0, 1, 2].map(|c| match (field + usize::from(c)) % 2 {
                    0 => 40 * c + 20,
                    _ => 230 - 30 * c,
                }),
            };
            assert_eq!(got, right, "{name}: texel {n}");
        }
    }
}

/// All samples of a file of `maps`, as 16 bits, and its channels.
fn wide(name: &str) -> (Vec<u16>, usize, Option<Opacity>, Option<String>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/maps");
    let source = open_source(&folder.join(format!("{name}.tif")), LIMITS);
    let mut source = source.unwrap_or_else(|error| panic!("{error}"));
    let info = source.info();
    let mut all = Vec::new();
    let mut row = vec![0; info.row_bytes()];
    for _ in 0..info.height {
        source.next_row(&mut row).expect("a row");
        match info.sample {
            SampleKind::U16 => all.extend(
                row.chunks_exact(2)
                    .map(|pair| u16::from_ne_bytes([pair[0], pair[1]])),
            ),
            _ => all.extend(row.iter().map(|byte| u16::from(*byte))),
        }
    }
    (all, info.channels, info.opacity, source.colour_note())
}

/// Written by rasterio 1.4.4 without `PHOTOMETRIC=RGB`, as GDAL writes 16 bits. The files have 3 bands, 4 without alpha (ZSTD), and 4 in
/// planes with alpha as the last. Band c holds 900 x + 1700 y + 20 000 c mod 65 536.
#[test]
fn colours_of_16_bits_that_are_called_grey_are_colours() {
    for (name, channels) in [
        ("grey16_rgb", 3),
        ("grey16_infrared", 3),
        ("grey16_planes", 4),
    ] {
        let (all, found, opacity, note) = wide(name);
        assert_eq!((found, all.len()), (channels, channels * 800), "{name}");
        assert_eq!(opacity.is_some(), channels == 4, "{name}");
        for (n, got) in all.iter().enumerate() {
            let (c, x, y) = (n % channels, n / channels % 40, n / channels / 40);
            let right = (900 * x + 1700 * y + 20_000 * c) % 65_536;
            assert_eq!(usize::from(*got), right, "{name} {x} {y}");
        }
        let note = note.expect("a note");
        assert!(note.contains("the first three are taken for red"), "{note}");
    }
}

/// Written by rasterio 1.4.4 with NBITS of 10 and 12: 41 x + 97 y + 1000 c with that many bits. They are stretched to 16
/// bits.
#[test]
fn samples_of_10_and_12_bits_reach_white() {
    for (name, bits, channels) in [
        ("grey10_plain", 10, 1),
        ("grey12_lzw", 12, 1),
        ("grey12_rgb", 12, 3),
    ] {
        let (all, found, _, note) = wide(name);
        assert_eq!((found, all.len()), (channels, channels * 800), "{name}");
        assert_eq!(note, None);
        for (n, got) in all.iter().enumerate() {
            let (c, x, y) = (n % channels, n / channels % 40, n / channels / 40);
            let stored = (41 * x + 97 * y + 1000 * c) % (1 << bits);
            let right = stored as f64 / ((1 << bits) - 1) as f64 * 65_535.0;
            assert!(
                (f64::from(*got) - right).abs() <= 0.5,
                "{name} {x} {y}: {got}"
            );
        }
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/maps");
    let heights =
        terrella_ground::elevation::read::check_metres(&folder.join("grey12_lzw.tif"), true);
    let error = heights.expect_err("stretched").to_string();
    assert!(error.contains("fewer than 16 bits"), "{error}");
}

/// Written by rasterio 1.4.4 with NBITS = 2 and no-data value 2: x / 3 + y / 5 mod 4.
#[test]
fn the_number_for_nothing_is_one_of_those_stored() {
    let (all, channels, opacity, _) = wide("grey2_nothing");
    assert_eq!((channels, opacity), (2, Some(Opacity::Mask)));
    for (n, texel) in all.chunks_exact(2).enumerate() {
        let stored = ((n % 40) / 3 + n / 40 / 5) % 4;
        let right = match stored {
            2 => [0, 0],
            _ => [stored as u16 * 85, 255],
        };
        assert_eq!(texel, right, "{n}");
    }
}
