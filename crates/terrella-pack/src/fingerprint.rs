//! Identity of a build: all settings that determine its output, and the maps by size, time and their ends.

use super::error::BuildError;
use super::input::MapInput;
use super::mosaic::Mosaic;
use super::source::{FileContext, files_beside};
use super::{BuildOptions, Map};
use std::fmt::Write;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;
use terrella_files as files;
use terrella_ground::elevation::geoid::VerticalDatum;
use terrella_ground::elevation::{height_files, height_set};

/// Bytes of a map's file that are looked at, at its start and at its end.
const ENDS: u64 = 1 << 20;

/// Hexadecimal digits; equal for builds that write the same files. Memory and threads do not count.
pub(super) fn of(options: &BuildOptions, maps: &[Map<'_>]) -> Result<String, BuildError> {
    let mut text = format!(
        "{} {:?} {:?} {:?}\n",
        env!("CARGO_PKG_VERSION"),
        options.pack_name(),
        options.attribution,
        options.storages
    );
    for map in maps {
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{} {:?} {:?} {:?} {}",
            map.layer.name(),
            map.path,
            map.meaning,
            map.levels,
            match &map.input {
                MapInput::File(path) => with_beside(path)?,
                MapInput::Mosaic(mosaic) => of_mosaic(mosaic),
            }
        );
    }
    for path in &options.heights {
        let set = height_set(path)?;
        let known = match set.as_slice() {
            [file] => {
                let files = height_files(file);
                let known = files.iter().map(|file| of_file(file));
                known.collect::<Result<Vec<_>, _>>()?.join(" ")
            }
            set => by_times(set.iter().flat_map(|file| height_files(file))),
        };
        let above = options.heights_above.map_or("", VerticalDatum::name);
        let _ = writeln!(text, "heights {path:?} {known} {above}");
    }
    Ok(blake3::hash(text.as_bytes()).to_hex().to_string())
}

/// Of a mosaic's content, and of sizes and times of all its files.
fn of_mosaic(mosaic: &Mosaic) -> String {
    format!("{} {}", mosaic.identity(), by_times(mosaic.files()))
}

/// Of names, sizes and times of files: there may be thousands of them.
fn by_times(files: impl Iterator<Item = PathBuf>) -> String {
    let mut hasher = blake3::Hasher::new();
    for path in files {
        let known = std::fs::metadata(&path).ok();
        let known = known.map(|known| (known.len(), known.modified().ok()));
        hasher.update(format!("{} {known:?}\n", path.display()).as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}

/// Of a map and the files beside it.
fn with_beside(path: &Path) -> Result<String, BuildError> {
    let mut text = of_file(path)?;
    for file in files_beside(path).iter().filter(|file| file.is_file()) {
        text += &of_file(file)?;
    }
    Ok(text)
}

fn of_file(path: &Path) -> Result<String, BuildError> {
    let read = || -> std::io::Result<String> {
        let mut file = files::open(path)?;
        let metadata = file.metadata()?;
        // A file system without times is recognised by the rest.
        let modified = metadata
            .modified()
            .ok()
            .and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        let mut hasher = blake3::Hasher::new();
        hasher.update_reader((&mut file).take(ENDS))?;
        file.seek(SeekFrom::Start(metadata.len().saturating_sub(ENDS)))?;
        hasher.update_reader((&mut file).take(ENDS))?;
        Ok(format!(
            "{} {modified:?} {}",
            metadata.len(),
            hasher.finalize().to_hex()
        ))
    };
    read().map_err(|error| FileContext::new(path).unreadable(error))
}
