//! Small map files of all kinds, made from a formula.

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use std::io::Cursor;
use std::path::{Path, PathBuf};
use terrella_pack::BuildError;
use terrella_pack::source::{RowSource, SourceInfo, SourceLimits, read_source};
use tiff::encoder::colortype::{ColorType, Gray16, Gray32Float, GrayI16, RGB8, RGB16};
use tiff::encoder::{Compression, TiffEncoder, TiffKind, TiffKindBig, TiffKindStandard, TiffValue};
use tiff::tags::Tag;

pub const WIDTH: u32 = 64;
pub const HEIGHT: u32 = 32;

/// Texels with non-zero channels; those of the files in tests/data/maps.
pub fn rgb(x: u32, y: u32) -> [u8; 3] {
    [(x * 4) as u8, (y * 8) as u8, (x * y % 256) as u8]
}

/// All of them, row by row.
pub fn rgb_map() -> Vec<u8> {
    (0..WIDTH * HEIGHT)
        .flat_map(|n| rgb(n % WIDTH, n / WIDTH))
        .collect()
}

/// 16-bit samples that use both bytes.
pub fn wide_map(channels: u32) -> Vec<u16> {
    (0..WIDTH * HEIGHT * channels)
        .map(|n| (n * 37 % 65_536) as u16)
        .collect()
}

/// A PNG of these bytes; 16-bit samples in the machine's order.
pub fn png(width: u32, height: u32, kind: ExtendedColorType, bytes: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let encoder = PngEncoder::new(&mut file);
    encoder
        .write_image(bytes, width, height, kind)
        .expect("as many as it has");
    file
}

/// A JPEG of colour texels (grey of one channel), baseline or progressive.
pub fn jpeg(width: u32, texels: &[u8], is_progressive: bool) -> Vec<u8> {
    let channels = texels.len() / (width * width / 2) as usize;
    let space = if channels == 1 {
        mozjpeg::ColorSpace::JCS_GRAYSCALE
    } else {
        mozjpeg::ColorSpace::JCS_RGB
    };
    let mut encoder = mozjpeg::Compress::new(space);
    encoder.set_size(width as usize, width as usize / 2);
    encoder.set_quality(95.0);
    encoder.set_optimize_scans(false);
    if is_progressive {
        encoder.set_progressive_mode();
    } else {
        encoder.set_scan_optimization_mode(mozjpeg::ScanMode::AllComponentsTogether);
        encoder.set_fastest_defaults();
    }
    let mut encoder = encoder.start_compress(Vec::new()).expect("starts");
    encoder.write_scanlines(texels).expect("written");
    encoder.finish().expect("finished")
}

/// Tags of doubles and of shorts to add.
#[derive(Default)]
pub struct Geo {
    pub doubles: Vec<(Tag, Vec<f64>)>,
    pub shorts: Vec<(Tag, Vec<u16>)>,
}

fn tiff_of<K: TiffKind, C: ColorType>(
    mut encoder: TiffEncoder<&mut Cursor<Vec<u8>>, K>,
    (width, height): (u32, u32),
    texels: &[C::Inner],
    rows_per_strip: u32,
    geo: &Geo,
) where
    [C::Inner]: TiffValue,
{
    let mut image = encoder.new_image::<C>(width, height).expect("starts");
    image.rows_per_strip(rows_per_strip).expect("before data");
    for (tag, values) in &geo.doubles {
        image
            .encoder()
            .write_tag(*tag, values.as_slice())
            .expect("a tag");
    }
    for (tag, values) in &geo.shorts {
        image
            .encoder()
            .write_tag(*tag, values.as_slice())
            .expect("a tag");
    }
    image.write_data(texels).expect("as many as it has");
}

/// A TIFF in strips.
pub fn tiff<C: ColorType>(
    size: (u32, u32),
    texels: &[C::Inner],
    compression: Compression,
    is_big: bool,
    geo: &Geo,
) -> Vec<u8>
where
    [C::Inner]: TiffValue,
{
    let mut file = Cursor::new(Vec::new());
    // Seven rows: the last strip is shorter.
    if is_big {
        let encoder = TiffEncoder::<_, TiffKindBig>::new_generic(&mut file).expect("starts");
        tiff_of::<TiffKindBig, C>(encoder.with_compression(compression), size, texels, 7, geo);
    } else {
        let encoder = TiffEncoder::<_, TiffKindStandard>::new_generic(&mut file).expect("starts");
        tiff_of::<TiffKindStandard, C>(encoder.with_compression(compression), size, texels, 7, geo);
    }
    file.into_inner()
}

/// A colour TIFF of the formula.
pub fn rgb_tiff(compression: Compression, is_big: bool) -> Vec<u8> {
    tiff::<RGB8>(
        (WIDTH, HEIGHT),
        &rgb_map(),
        compression,
        is_big,
        &Geo::default(),
    )
}

/// Others that the readers take.
pub fn wide_tiff() -> Vec<u8> {
    tiff::<RGB16>(
        (WIDTH, HEIGHT),
        &wide_map(3),
        Compression::Lzw,
        false,
        &Geo::default(),
    )
}

/// Unsigned elevations.
pub fn u16_tiff(values: &[u16], geo: &Geo) -> Vec<u8> {
    tiff::<Gray16>(
        (WIDTH, HEIGHT),
        values,
        Compression::Uncompressed,
        false,
        geo,
    )
}

/// Signed elevations.
pub fn i16_tiff(values: &[i16]) -> Vec<u8> {
    let deflate = Compression::Deflate(Default::default());
    tiff::<GrayI16>((WIDTH, HEIGHT), values, deflate, true, &Geo::default())
}

/// Heights as floats.
pub fn f32_tiff(values: &[f32]) -> Vec<u8> {
    tiff::<Gray32Float>(
        (WIDTH, HEIGHT),
        values,
        Compression::Lzw,
        false,
        &Geo::default(),
    )
}

/// A file of tests/data/maps.
pub fn fixture(name: &str) -> Vec<u8> {
    let path = PathBuf::from(crate::REPOSITORY)
        .join("tests/data/maps")
        .join(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

pub const LIMITS: SourceLimits = SourceLimits {
    buffer_bytes: 1 << 20,
};

/// Opens a map from memory.
pub fn open(bytes: &[u8], limits: SourceLimits) -> Result<Box<dyn RowSource>, BuildError> {
    read_source(Cursor::new(bytes.to_vec()), Path::new("dir/map.x"), limits)
}

/// Reads a whole map.
pub fn read(bytes: &[u8]) -> Result<(SourceInfo, Vec<u8>), BuildError> {
    read_within(bytes, LIMITS)
}

/// Reads a whole map.
pub fn read_within(
    bytes: &[u8],
    limits: SourceLimits,
) -> Result<(SourceInfo, Vec<u8>), BuildError> {
    let mut source = open(bytes, limits)?;
    let info = source.info();
    let mut texels = vec![0; info.row_bytes() * info.height as usize];
    for row in texels.chunks_exact_mut(info.row_bytes()) {
        source.next_row(row)?;
    }
    Ok((info, texels))
}
