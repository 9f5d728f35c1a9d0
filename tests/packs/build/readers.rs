//! Every kind of file gives its texels.

use super::maps::{
    HEIGHT, WIDTH, f32_tiff, fixture, i16_tiff, jpeg, png, read, rgb, rgb_map, rgb_tiff, u16_tiff,
    wide_map, wide_tiff,
};
use image::ExtendedColorType;
use terrella::internals::imagery::build::source::{FileKind, SampleKind};
use tiff::encoder::Compression;

/// The file holds these texels.
fn holds(bytes: &[u8], file: FileKind, channels: usize, sample: SampleKind, texels: &[u8]) {
    let (info, read) = read(bytes).expect("a good map");
    assert_eq!((info.width, info.height), (WIDTH, HEIGHT));
    assert_eq!(
        (info.file, info.channels, info.sample),
        (file, channels, sample)
    );
    assert!(
        read == texels,
        "{file:?} {channels} {sample:?}: other texels"
    );
}

fn bytes_of<T: bytemuck::NoUninit>(values: &[T]) -> &[u8] {
    bytemuck::cast_slice(values)
}

#[test]
fn png_of_all_kinds() {
    let colour = rgb_map();
    let file = |kind, bytes: &[u8]| png(WIDTH, HEIGHT, kind, bytes);
    let png_8 = |bytes: &[u8], channels, texels: &[u8]| {
        holds(bytes, FileKind::Png, channels, SampleKind::U8, texels);
    };
    png_8(&file(ExtendedColorType::Rgb8, &colour), 3, &colour);
    let grey: Vec<u8> = (0..WIDTH * HEIGHT).map(|n| (n % 251) as u8).collect();
    png_8(&file(ExtendedColorType::L8, &grey), 1, &grey);
    let both: Vec<u8> = grey.iter().flat_map(|grey| [*grey, 255 - grey]).collect();
    png_8(&file(ExtendedColorType::La8, &both), 2, &both);
    let four: Vec<u8> = grey.iter().flat_map(|grey| [*grey, 1, 2, 200]).collect();
    png_8(&file(ExtendedColorType::Rgba8, &four), 4, &four);
    png_8(&fixture("interlaced.png"), 3, &colour);
    let palette: Vec<u8> = (0..WIDTH * HEIGHT)
        .flat_map(|n| [(n % WIDTH / 8 * 32) as u8, (n / WIDTH / 8 * 64) as u8, 100])
        .collect();
    png_8(&fixture("palette.png"), 3, &palette);
    for (channels, kind) in [(1, ExtendedColorType::L16), (3, ExtendedColorType::Rgb16)] {
        let wide = wide_map(channels as u32);
        let wide = bytes_of(&wide);
        holds(
            &file(kind, wide),
            FileKind::Png,
            channels,
            SampleKind::U16,
            wide,
        );
    }
}

#[test]
fn jpeg_baseline_and_progressive_are_near_their_texels() {
    // Smooth, so that little is lost.
    let width = 256;
    let grey: Vec<u8> = (0..width * width / 2)
        .map(|n| (n % width / 2 + n / width / 2) as u8)
        .collect();
    let colour: Vec<u8> = grey
        .iter()
        .flat_map(|grey| [*grey, 200 - grey, 90])
        .collect();
    for texels in [&grey, &colour] {
        for is_progressive in [false, true] {
            let bytes = jpeg(width, texels, is_progressive);
            // 0xC2 begins a progressive frame.
            let sof = bytes.windows(2).any(|pair| pair == [0xFF, 0xC2]);
            assert_eq!(sof, is_progressive);
            let (info, read) = read(&bytes).expect("a good map");
            assert_eq!(
                (info.file, info.width, info.height),
                (FileKind::Jpeg, width, width / 2)
            );
            assert_eq!(read.len(), texels.len());
            let worst = read.iter().zip(texels).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(worst < Some(9), "off by {worst:?}");
        }
    }
}

#[test]
fn tiff_in_strips_and_tiles() {
    let colour = rgb_map();
    for compression in [
        Compression::Uncompressed,
        Compression::Lzw,
        Compression::Deflate(Default::default()),
        Compression::Packbits,
    ] {
        for is_big in [false, true] {
            let bytes = rgb_tiff(compression, is_big);
            assert_eq!(bytes[2], if is_big { 43 } else { 42 });
            holds(&bytes, FileKind::Tiff, 3, SampleKind::U8, &colour);
        }
    }
    // 48 × 16 and, in the other byte order, 16 × 48: wider or higher than what is left of the map.
    for name in ["tiled_lzw.tif", "tiled_deflate.tif"] {
        holds(&fixture(name), FileKind::Tiff, 3, SampleKind::U8, &colour);
    }
    holds(
        &wide_tiff(),
        FileKind::Tiff,
        3,
        SampleKind::U16,
        bytes_of(&wide_map(3)),
    );
}

#[test]
fn tiff_heights() {
    let unsigned = wide_map(1);
    let one = (FileKind::Tiff, 1);
    holds(
        &u16_tiff(&unsigned, &Default::default()),
        one.0,
        one.1,
        SampleKind::U16,
        bytes_of(&unsigned),
    );
    let signed: Vec<i16> = unsigned.iter().map(|value| *value as i16).collect();
    holds(
        &i16_tiff(&signed),
        one.0,
        one.1,
        SampleKind::I16,
        bytes_of(&signed),
    );
    let floats: Vec<f32> = signed.iter().map(|value| f32::from(*value) / 3.0).collect();
    holds(
        &f32_tiff(&floats),
        one.0,
        one.1,
        SampleKind::F32,
        bytes_of(&floats),
    );
}

#[test]
fn the_formula_tells_rows_from_columns() {
    assert_ne!(rgb(1, 2), rgb(2, 1));
}
