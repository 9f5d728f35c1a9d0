//! Every kind of file gives its texels.

use super::maps::{
    HEIGHT, WIDTH, f32_tiff, fixture, i16_tiff, jpeg, png, read, rgb, rgb_map, rgb_tiff, u16_tiff,
    wide_map, wide_tiff,
};
use image::ExtendedColorType;
use terrella_pack::source::{FileKind, Opacity, SampleKind};
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
    // 48 × 16 and, in the other byte order, 16 × 48: wider or higher than the rest of the map. The last stores its channels in planes.
    for name in ["tiled_lzw.tif", "tiled_deflate.tif", "planar.tif"] {
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

/// Texels with a mask channel; the others are 0.
fn with_mask<T: Copy + Default>(
    texels: &[T],
    full: T,
    is_there: impl Fn(u32, u32) -> bool,
) -> Vec<T> {
    let mut all = Vec::new();
    for (n, texel) in (0..WIDTH * HEIGHT).zip(texels.chunks_exact(3)) {
        match is_there(n % WIDTH, n / WIDTH) {
            true => all.extend(texel.iter().chain([&full])),
            false => all.extend([T::default(); 4]),
        }
    }
    all
}

/// The file holds these texels, of which some are nothing.
fn holds_in_part(name: &str, sample: SampleKind, texels: &[u8]) {
    let (info, read) = read(&fixture(name)).expect(name);
    assert_eq!((info.channels, info.sample), (4, sample), "{name}");
    assert_eq!(info.opacity, Some(Opacity::Mask), "{name}");
    assert!(read == texels, "{name}: other texels");
}

/// The files were written by GDAL from the formulas here.
#[test]
fn what_a_tiff_says_is_nothing_is_not_there() {
    let colour = rgb_map();
    // Two tiles of eight: the others have offset 0 and length 0.
    let is_written = |x: u32, y: u32| matches!((x / 16, y / 16), (1, 0) | (3, 1));
    let expected = with_mask(&colour, 255, is_written);
    holds_in_part("sparse.tif", SampleKind::U8, &expected);
    // A BigTIFF in the other byte order with a mask of one bit inside.
    let is_there = |x: u32, y: u32| !(x + y).is_multiple_of(3);
    let expected = with_mask(&colour, 255, is_there);
    holds_in_part("mask.tif", SampleKind::U8, &expected);
    // 16 bits in planes, where 7 in all channels marks missing data; in a single channel it is a colour.
    let mut wide = wide_map(3);
    wide[3 * (WIDTH as usize + 1)] = 7;
    let expected = with_mask(&wide, u16::MAX, is_there);
    holds_in_part("no_data_16.tif", SampleKind::U16, bytes_of(&expected));
    let (info, _) = read(&fixture("grey_alpha_16.tif")).expect("grey and alpha");
    assert_eq!((info.channels, info.opacity), (2, Some(Opacity::Alpha)));
}

#[test]
fn palettes_of_tiffs_are_colours() {
    let colours: Vec<u8> = (0..WIDTH * HEIGHT)
        .flat_map(|n| [(n % WIDTH / 8 * 32) as u8, (n / WIDTH / 8 * 64) as u8, 100])
        .collect();
    let file = fixture("palette.tif");
    holds(&file, FileKind::Tiff, 3, SampleKind::U8, &colours);
}

#[test]
fn the_formula_tells_rows_from_columns() {
    assert_ne!(rgb(1, 2), rgb(2, 1));
}
