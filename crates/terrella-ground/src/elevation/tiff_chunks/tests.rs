//! Compares files written by GDAL with GDAL's own reading, and checks rejections.

use super::*;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/gdal")
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(folder().join(name)).expect("a file of tests/data/gdal")
}

/// An image with all its samples.
struct Image {
    columns: usize,
    samples: usize,
    values: Vec<f64>,
}

fn numbers(chunk: DecodingResult) -> Vec<f64> {
    use DecodingResult as Of;
    match chunk {
        Of::U8(all) => all.into_iter().map(f64::from).collect(),
        Of::I16(all) => all.into_iter().map(f64::from).collect(),
        Of::U32(all) => all.into_iter().map(f64::from).collect(),
        Of::F32(all) => all.into_iter().map(f64::from).collect(),
        Of::F64(all) => all,
        _ => panic!("samples that no file of these tests has"),
    }
}

/// The same with the palette declared as grey, as the crate's decoder requires.
fn decoded(mut file: Vec<u8>) -> Result<Image, TiffChunkError> {
    let palette = [6, 1, 3, 0, 1, 0, 0, 0, 3, 0];
    let at = file.windows(10).position(|bytes| bytes == palette);
    if let Some(at) = at {
        file[at + 8] = 1;
    }
    let mut decoder = Decoder::new(Cursor::new(file))?;
    let chunks = TiffChunks::of(&mut decoder)?;
    let (columns, rows) = decoder.dimensions()?;
    let (columns, rows) = (columns as usize, rows as usize);
    let of_pixel = decoder.find_tag_unsigned::<u16>(Tag::SamplesPerPixel)?;
    let samples = usize::from(of_pixel.unwrap_or(1));
    let (width, height) = decoder.chunk_dimensions();
    let (width, height) = (width as usize, (height as usize).min(rows));
    let across = columns.div_ceil(width);
    let per_plane = across * rows.div_ceil(height);
    let planes = samples / usize::from(chunks.form.samples);
    let mut values = vec![f64::MAX; columns * rows * samples];
    for index in 0..per_plane * planes {
        let (plane, place) = (index / per_plane, index % per_plane);
        let first = (place % across * width, place / across * height);
        let run = width.min(columns - first.0);
        let of_chunk = samples / planes;
        let read = numbers(chunks.read(&mut decoder, index as u32)?);
        for (n, value) in read.into_iter().enumerate() {
            let (pixel, sample) = (n / of_chunk, n % of_chunk + plane);
            let (x, y) = (first.0 + pixel % run, first.1 + pixel / run);
            values[(y * columns + x) * samples + sample] = value;
        }
    }
    Ok(Image {
        columns,
        samples,
        values,
    })
}

#[test]
fn samples_are_those_that_gdal_reads() {
    let text = std::fs::read_to_string(folder().join("expected.txt")).expect("expected.txt");
    let mut images: BTreeMap<&str, Image> = BTreeMap::new();
    let mut compared: BTreeMap<&str, usize> = BTreeMap::new();
    for line in text.lines().skip(1).filter(|line| line.contains(".tif ")) {
        let mut words = line.split(' ');
        let name = words.next().expect("a name");
        let image = images.entry(name).or_insert_with(|| {
            decoded(bytes(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
        });
        let numbers: Vec<f64> = words.map(|word| word.parse().expect("a number")).collect();
        let place = numbers[1] as usize * image.columns + numbers[0] as usize;
        let got = &image.values[place * image.samples..][..image.samples];
        assert_eq!(got.len(), numbers.len() - 2, "{name}");
        // Inverse transforms of JPEG may differ by one. Subsampled chrominance is interpolated in different ways.
        let most = match name {
            "jpeg_ycbcr.tif" | "jpeg_mask.tif" => 8.0,
            _ if name.starts_with("jpeg") => 1.0,
            "webp_lossy.tif" => 2.0,
            _ => 0.0,
        };
        for (got, right) in got.iter().zip(&numbers[2..]) {
            let is_right = (got - right).abs() <= most || (got.is_nan() && right.is_nan());
            assert!(is_right, "{line}: {got}");
        }
        *compared.entry(name).or_default() += 1;
    }
    let tiffs = std::fs::read_dir(folder())
        .expect("a folder")
        .filter(|file| {
            let path = file.as_ref().expect("a file").path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.ends_with(".tif") && !name.starts_with("part_")
        });
    assert_eq!(compared.len(), tiffs.count());
    assert!(compared.values().all(|places| *places == 50));
}

/// A file with one SHORT tag changed, also in directories that GDAL rewrote elsewhere.
fn with_short(name: &str, tag: u16, value: u16) -> Vec<u8> {
    let mut file = bytes(name);
    let mut entry = tag.to_le_bytes().to_vec();
    entry.extend([3, 0, 1, 0, 0, 0]);
    let found: Vec<_> = (0..file.len() - 10)
        .filter(|at| file[*at..].starts_with(&entry))
        .collect();
    assert!(!found.is_empty(), "the tag");
    for at in found {
        file[at + 8..at + 10].copy_from_slice(&value.to_le_bytes());
    }
    file
}

#[track_caller]
fn rejected(file: Vec<u8>) -> String {
    match decoded(file) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("accepted"),
    }
}

#[test]
fn other_compression_is_rejected_by_its_name() {
    for (compression, name) in [
        (4, "is compressed by CCITT fax"),
        (6, "is compressed by JPEG of TIFF 6.0 (old-style)"),
        (34_712, "is compressed by JPEG 2000"),
        (34_925, "is compressed by LZMA"),
        (50_002, "is compressed by JPEG XL"),
        (777, "is compressed by method 777"),
    ] {
        let file = with_short("zstd_i16_predictor_2.tif", 259, compression);
        assert_eq!(rejected(file), name);
    }
}

#[test]
fn data_of_one_codec_are_damaged_for_another() {
    for (name, compression, said) in [
        ("zstd_i16_predictor_2.tif", 34_887, "LERC data: no header"),
        ("lerc_i16.tif", 50_000, "ZSTD: "),
        ("webp_rgb.tif", 7, "JPEG: "),
        ("jpeg_rgb.tif", 50_001, "WebP: "),
    ] {
        let error = rejected(with_short(name, 259, compression));
        assert!(error.starts_with(said), "{name}: {error}");
    }
}

#[test]
fn changed_data_are_errors_or_samples_but_no_panics() {
    let (mut damaged, mut read) = (0, 0);
    for name in [
        "zstd_i16_predictor_2.tif",
        "lerc_f32_holes.tif",
        "lerc_u8.tif",
        "lerc_rough_u8.tif",
        "jpeg_ycbcr.tif",
        "webp_rgba.tif",
        "palette_2.tif",
    ] {
        let whole = bytes(name);
        for n in (0..whole.len()).step_by(whole.len() / 60) {
            let mut file = whole.clone();
            file[n] ^= 0x55;
            match decoded(file) {
                Ok(_) => read += 1,
                Err(_) => damaged += 1,
            }
            match decoded(whole[..n].to_vec()) {
                Ok(_) => read += 1,
                Err(_) => damaged += 1,
            }
        }
    }
    assert!(damaged > 500 && read > 10, "{damaged} {read}");
}

#[test]
fn lerc_says_what_is_wrong() {
    let file = bytes("lerc_f32.tif");
    let at = file.windows(6).position(|bytes| bytes == b"Lerc2 ");
    let blob = &file[at.expect("a blob")..];
    let of = |blob: &[u8]| lerc::decode::<f32>(blob, (32, 16)).err();
    assert_eq!(of(blob), None);
    let mut other = blob.to_vec();
    other[100] ^= 1;
    assert_eq!(of(&other), Some(LercError::Damaged("its checksum differs")));
    assert_eq!(
        of(&blob[..90]),
        Some(LercError::Damaged("the data end too early"))
    );
    other = blob.to_vec();
    other[6] = 9;
    let unsupported = LercError::Unsupported("a version other than 2.3 to 2.6");
    assert_eq!(of(&other), Some(unsupported));
    let other_size = lerc::decode::<f32>(blob, (16, 32)).err();
    let cause = "another size than its strip or tile";
    assert_eq!(other_size, Some(LercError::Damaged(cause)));
    let other_type = lerc::decode::<i16>(blob, (32, 16)).err();
    let cause = "another type than the file's";
    assert_eq!(other_type, Some(LercError::Damaged(cause)));
}
