//! Files of the page that are made from others: small maps for the first picture, and the tables of the air.

use crate::files::write_bytes;
use anyhow::Context;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use image::ImageReader;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use std::fs;
use std::io::Write;
use std::path::Path;

#[path = "../../../crates/terrella-web/src/compact.rs"]
mod compact;

/// Widths of the small maps, texels. Elevations are noisy and large, and show least.
const PREVIEWS: [(&str, u32); 5] = [
    ("day.jpg", 1024),
    ("clouds.jpg", 1024),
    ("elevation.png", 512),
    ("night_lights.png", 1024),
    ("water.png", 1024),
];
/// They are shown for a second or two.
const JPEG_QUALITY: u8 = 70;

/// The folder of the tables of the air, in the repository.
pub const TABLES: &str = "crates/terrella-ground/src/air/tables";
/// The files of the tables of the air, in the order in which the page takes them.
const AIR: [&str; 2] = ["default.bin", "above_clouds.bin"];

/// Writes the small versions of a folder's maps.
pub fn write_previews(textures: &Path, to: &Path) -> anyhow::Result<()> {
    fs::create_dir_all(to).with_context(|| to.display().to_string())?;
    for (name, width) in PREVIEWS {
        let from = textures.join(name);
        let file = preview(&from, width).with_context(|| from.display().to_string())?;
        write_bytes(&to.join(name), &file)?;
    }
    Ok(())
}

/// The file of a map of this width. Its texels are means.
fn preview(map: &Path, width: u32) -> anyhow::Result<Vec<u8>> {
    let small = ImageReader::open(map)?
        .decode()?
        .thumbnail_exact(width, width / 2);
    let mut file = Vec::new();
    match map.extension().is_some_and(|extension| extension == "jpg") {
        true => {
            small.write_with_encoder(JpegEncoder::new_with_quality(&mut file, JPEG_QUALITY))?;
        }
        false => small.write_with_encoder(PngEncoder::new_with_quality(
            &mut file,
            CompressionType::Best,
            FilterType::Adaptive,
        ))?,
    }
    Ok(file)
}

/// Writes the tables of the air, compacted and deflated: browsers inflate them, whatever a host compresses.
pub fn write_air(tables: &Path, to: &Path) -> anyhow::Result<()> {
    let mut bytes = Vec::new();
    for name in AIR {
        let file = tables.join(name);
        bytes.extend(fs::read(&file).with_context(|| file.display().to_string())?);
    }
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(&compact::compact(&bytes))?;
    write_bytes(to, &encoder.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::process::repository_root;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    #[test]
    fn first_maps_are_small_and_the_air_comes_back() -> anyhow::Result<()> {
        let (root, to) = (repository_root(), tempfile::tempdir()?);
        write_previews(&root.join("textures"), to.path())?;
        let mut bytes = 0;
        for (name, width) in PREVIEWS {
            let file = to.path().join(name);
            bytes += fs::metadata(&file)?.len();
            assert_eq!(
                image::image_dimensions(&file)?,
                (width, width / 2),
                "{name}"
            );
        }
        assert!(bytes < 600_000, "{bytes}");

        let (tables, file) = (root.join(TABLES), to.path().join("air.bin"));
        write_air(&tables, &file)?;
        let compressed = fs::read(&file)?;
        assert!(compressed.len() < 700_000, "{}", compressed.len());
        let mut compacted = Vec::new();
        ZlibDecoder::new(&compressed[..]).read_to_end(&mut compacted)?;
        let expected = [
            fs::read(tables.join(AIR[0]))?,
            fs::read(tables.join(AIR[1]))?,
        ]
        .concat();
        assert!(compact::restore(&compacted) == expected);
        Ok(())
    }
}
