//! TIFF with several bands, and with samples that share bytes.

use super::*;

const BOTH: [u16; 2] = [16, 16];

/// 6 × 4 pixels of two bands, heights of 100 n and of −n, interleaved or in planes.
fn two_bands(is_planar: bool) -> Plain {
    let bands = [|n: i16| n * 100, |n: i16| -n];
    let pixels = |n: i16| bands.map(|band| band(n));
    let samples: Vec<i16> = match is_planar {
        false => (0..24).flat_map(pixels).collect(),
        true => bands.iter().flat_map(|band| (0..24).map(band)).collect(),
    };
    let bytes = samples.iter().flat_map(|n| n.to_le_bytes()).collect();
    Plain::new()
        .samples(16, 2, bytes)
        .with(258, shorts(&BOTH))
        .with(339, shorts(&[2, 2]))
        .with(277, shorts(&[2]))
        .with(338, shorts(&[0]))
        .with(284, shorts(&[if is_planar { 2 } else { 1 }]))
}

/// Bytes of a file with two planes and therefore two strips.
fn of_planes(plain: Plain) -> Vec<u8> {
    let bytes = plain.bytes();
    let count = u16::from_le_bytes([bytes[8], bytes[9]]);
    // Both entries become two LONGs after the samples.
    let mut file = bytes.clone();
    for entry in 0..usize::from(count) {
        let at = 10 + 12 * entry;
        let tag = u16::from_le_bytes([bytes[at], bytes[at + 1]]);
        let value = u32::from_le_bytes(bytes[at + 8..at + 12].try_into().expect("four"));
        let both = match tag {
            273 => [value, value + 48],
            279 => [48, 48],
            _ => continue,
        };
        let end = file.len() as u32;
        file[at + 4..at + 8].copy_from_slice(&2_u32.to_le_bytes());
        file[at + 8..at + 12].copy_from_slice(&end.to_le_bytes());
        file.extend(both.iter().flat_map(|number| number.to_le_bytes()));
    }
    file
}

/// The height of pixel `n` in a file of 6 × 4.
fn height_m(file: &HeightFile, n: u32) -> f64 {
    let (lat, lon) = (49.5 - f64::from(n / 6), 10.5 + f64::from(n % 6));
    file.grid.height_m(lat.to_radians(), lon.to_radians(), 0.0)
}

#[test]
fn the_first_band_is_taken_or_the_one_that_is_named() {
    for bytes in [two_bands(false).bytes(), of_planes(two_bands(true))] {
        for (sidecar, of) in [("", 100.0), ("band = 1", 100.0), ("band = 2", -1.0)] {
            let file = read(bytes.clone(), sidecar).unwrap_or_else(|error| panic!("{error}"));
            for n in 0..24 {
                let got = height_m(&file, n);
                assert!(
                    (got - of * f64::from(n)).abs() < 1e-3,
                    "{sidecar} {n}: {got}"
                );
            }
        }
        assert!(said(bytes.clone(), "band = 3").contains("has no band 3, which its sidecar names"));
        // A default choice of band gives a notice.
        let note = |sidecar: &str| {
            let sidecar = Sidecar::from_toml(sidecar, Path::new("dem.toml")).expect("good");
            let path = Path::new("dem.tif");
            let reader = HeightReader::new(Cursor::new(bytes.clone()), Some(&sidecar), path);
            match reader.expect("good").decoder {
                Decoder::Tiff(tiff) => tiff.note(&FileContext::new(path)),
                _ => None,
            }
        };
        let reported = note("").expect("a note");
        assert!(
            reported.contains("has 2 bands; the first is taken"),
            "{reported}"
        );
        assert_eq!(note("band = 1"), None);
    }
    let none = Sidecar::from_toml("band = 0", Path::new("dem.toml")).unwrap_err();
    assert!(none.to_string().starts_with("dem.toml:1: band is 0"));
    let png = std::fs::read(data("globe_u16.png")).expect("a file");
    let sidecar = std::fs::read_to_string(data("globe_u16.toml")).expect("a file");
    assert!(said(png, &format!("{sidecar}\nband = 1")).contains("has no bands"));
}

#[test]
fn scale_and_unit_are_those_of_the_band() {
    let gdal = b"<GDALMetadata><Item name=\"OFFSET\" sample=\"0\" role=\"offset\">7</Item>\
                 <Item name=\"SCALE\" sample=\"1\" role=\"scale\">3</Item></GDALMetadata>\0";
    let bytes = two_bands(false).with(42_112, (2, gdal.to_vec())).bytes();
    let first = read(bytes.clone(), "band = 1").expect("good");
    assert!((height_m(&first, 2) - 207.0).abs() < 1e-6);
    let second = read(bytes, "band = 2").expect("good");
    assert!((height_m(&second, 2) + 6.0).abs() < 1e-6);
}

#[test]
fn alpha_takes_heights_away() {
    for kind in [1, 2] {
        let alpha = |plain: Plain| plain.with(338, shorts(&[kind]));
        for bytes in [
            alpha(two_bands(false)).bytes(),
            of_planes(alpha(two_bands(true))),
        ] {
            // The second band is 0 only in its first sample.
            let file = read(bytes.clone(), "").unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(file.grid.stats().holes, 1);
            assert!((height_m(&file, 23) - 2300.0).abs() < 1e-6);
            // The second band is no alpha if it holds the heights.
            let file = read(bytes, "band = 2").unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(file.grid.stats().holes, 0);
        }
    }
}

#[test]
fn samples_of_10_and_12_bits_are_read() {
    for bits in [10_u16, 12, 14] {
        let value = |n: u32| (n * 41) % (1 << bits);
        let rows = (0..4).map(|row| {
            // The bits of a row, the highest first; each row starts at a byte.
            let all = (0..6).flat_map(|column| {
                let value = value(row * 6 + column);
                (0..bits).rev().map(move |bit| value >> bit & 1 == 1)
            });
            let all: Vec<bool> = all.collect();
            let byte = |eight: &[bool]| {
                let ones = eight.iter().enumerate().filter(|(_, one)| **one);
                ones.fold(0_u8, |byte, (n, _)| byte | 0x80 >> n)
            };
            all.chunks(8).map(byte).collect::<Vec<u8>>()
        });
        let bytes: Vec<u8> = rows.flatten().collect();
        let plain = || Plain::new().samples(bits, 1, bytes.clone());
        let mut deflated =
            flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        std::io::Write::write_all(&mut deflated, &bytes).expect("written");
        let mut small = plain().with(259, shorts(&[8]));
        small.samples = deflated.finish().expect("written");
        for file in [plain(), small] {
            let file = read(file.bytes(), "").unwrap_or_else(|error| panic!("{bits}: {error}"));
            for n in 0..24 {
                let (got, right) = (height_m(&file, n), f64::from(value(n)));
                assert!((got - right).abs() < 1e-6, "{bits}: {n}: {got}");
            }
        }
        let mut cut = plain();
        cut.samples.truncate(12);
        assert!(said(cut.bytes(), "").contains("truncated or damaged"));
        let back = said(plain().with(266, shorts(&[2])).bytes(), "");
        assert!(back.contains("FillOrder 2"), "{back}");
    }
}

#[test]
fn whole_numbers_of_64_bits_and_floats_of_16_are_read() {
    let height = |n: u32| f64::from(n) * 64.0 - 512.0;
    let signed = (0..24).flat_map(|n| (height(n) as i64).to_le_bytes());
    // IEEE 754: 64 n − 512 as powers of two.
    let half = |value: f64| match value {
        0.0 => 0_u16,
        value => {
            let exponent = value.abs().log2().floor();
            let mantissa = ((value.abs() / exponent.exp2() - 1.0) * 1024.0) as u16;
            u16::from(value < 0.0) << 15 | ((exponent + 15.0) as u16) << 10 | mantissa
        }
    };
    let halves = (0..24).flat_map(|n| half(height(n)).to_le_bytes());
    let unsigned = (0..24_u64).flat_map(|n| (n * 64).to_le_bytes());
    for (bits, format, bytes, offset_m) in [
        (64, 2, signed.collect::<Vec<u8>>(), 0.0),
        (64, 1, unsigned.collect(), 512.0),
        (16, 3, halves.collect(), 0.0),
    ] {
        let file = read(Plain::new().samples(bits, format, bytes).bytes(), "");
        let file = file.unwrap_or_else(|error| panic!("{bits} {format}: {error}"));
        for n in 0..24 {
            let got = height_m(&file, n);
            assert!(
                (got - offset_m - height(n)).abs() < 1e-6,
                "{bits} {format} {n}: {got}"
            );
        }
    }
}
