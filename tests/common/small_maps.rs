//! The starter maps at a quarter of their width, for tests that start the program or an Earth many times: most of a start is reading
//! maps, and few tests look at their detail.

use image::DynamicImage;
use image::imageops::{FilterType, resize};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Maps of 4096 texels round the Earth and more.
const SHRUNK: [&str; 3] = ["day.jpg", "clouds.jpg", "water.png"];

/// The folder in `target/tmp`, made by the first test that needs it; made again when a starter map changes.
pub fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let starter = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../textures");
        let cache = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let folder = cache.join(format!("small_maps_{:016x}", version(&starter)));
        if !folder.is_dir() {
            let unfinished = tempfile::tempdir_in(cache).expect("a folder in target/tmp");
            shrink(&starter, unfinished.path());
            if let Err(error) = std::fs::rename(unfinished.path(), &folder) {
                // Another program of tests was faster.
                assert!(folder.is_dir(), "{error}");
            }
        }
        folder
    })
}

/// Another for other files.
fn version(folder: &Path) -> u64 {
    use std::hash::{DefaultHasher, Hash, Hasher};
    let mut hasher = DefaultHasher::new();
    for path in files(folder) {
        let metadata = path.metadata().expect("a map");
        let written = metadata.modified().expect("a time");
        (path, metadata.len(), written).hash(&mut hasher);
    }
    hasher.finish()
}

/// The files of a folder, without those in folders below it, by name.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut files: Vec<_> = paths.filter(|path| path.is_file()).collect();
    files.sort();
    files
}

fn shrink(from: &Path, to: &Path) {
    for path in files(from) {
        let name = path.file_name().expect("a name");
        let copy = to.join(name);
        if !SHRUNK.iter().any(|shrunk| name == *shrunk) {
            std::fs::copy(&path, copy).expect("copied");
            continue;
        }
        let map = image::open(&path).expect("a map");
        let (width, height) = (map.width() / 4, map.height() / 4);
        let small: DynamicImage = match map {
            DynamicImage::ImageLuma8(map) => {
                resize(&map, width, height, FilterType::Triangle).into()
            }
            map => resize(&map.to_rgb8(), width, height, FilterType::Triangle).into(),
        };
        small.save(copy.with_extension("png")).expect("written");
    }
}
