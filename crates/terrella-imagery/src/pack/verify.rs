//! Verifying a pack: every tile there, whole and decodable, and nothing else among them.

use super::error::PackError;
use super::file::read_whole;
use super::heights::{HeightIndex, HeightRecord, HeightsEntry, decode_heights};
use super::manifest::{Manifest, TileFile, tile_path};
use super::open::Pack;
use super::tiles::read_tile;
use crate::tile::{MapLayer, Storage, TileError, TileShape};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

/// Threads that read and decode.
const READERS: usize = 2;

/// Most files that do not belong which are named; more are only counted.
const MAX_STRANGERS: usize = 1000;

/// Result of a verification.
#[derive(Debug, Default)]
pub struct VerifyReport {
    /// Number of expected tiles, and the index of elevation data.
    pub tiles: u64,
    /// Bytes of their files, as the manifest has them.
    pub bytes: u64,
    /// Tiles that are missing or do not match the manifest, in its order.
    pub bad: Vec<BadTile>,
    /// Files and folders below `tiles/` and `heights/` that do not belong to this pack, relative to it, by name: at most 1000.
    pub strangers: Vec<PathBuf>,
    /// Number of all of those, without the content of such folders.
    pub stranger_count: u64,
}

impl VerifyReport {
    /// Every tile is good. Files that do not belong do no harm.
    pub fn is_good(&self) -> bool {
        self.bad.is_empty()
    }
}

/// A tile that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BadTile {
    /// Its file, relative to the pack's folder.
    pub path: PathBuf,
    /// The error in the tile.
    pub cause: String,
}

/// A file of the pack.
struct Listed<'a> {
    what: What<'a>,
    path: PathBuf,
    file: TileFile,
}

/// Expected content of a file.
enum What<'a> {
    Map {
        storage: Storage,
        layer: MapLayer,
        shape: TileShape,
    },
    Heights {
        entry: &'a HeightsEntry,
        record: HeightRecord,
    },
    /// The index of elevation data, and the error in it.
    Index(Option<String>),
}

/// Reads, hashes and decodes every tile of the pack in a folder, and the index of its elevation data. `progress` gets the number of finished tiles
/// and of all tiles.
///
/// # Errors
/// Errors of [`Pack::open`], or a `tiles` folder that cannot be listed. Bad tiles are not an error but part of the report.
pub fn verify(dir: &Path, mut progress: impl FnMut(u64, u64)) -> Result<VerifyReport, PackError> {
    let pack = Pack::open(dir)?;
    let mut listed = listed_tiles(pack.manifest());
    if let Some(entry) = &pack.manifest().heights {
        list_heights(dir, entry, &mut listed);
    }
    let total = listed.len() as u64;
    progress(0, total);
    let next = AtomicUsize::new(0);
    let mut bad = Vec::new();
    std::thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        for _ in 0..READERS {
            let (sender, next, listed) = (sender.clone(), &next, &listed);
            scope.spawn(move || {
                loop {
                    let at = next.fetch_add(1, Ordering::Relaxed);
                    let Some(tile) = listed.get(at) else { break };
                    // The receiver takes all.
                    let _ = sender.send((at, check(dir, tile)));
                }
            });
        }
        drop(sender);
        for (done, (at, cause)) in (1..).zip(receiver) {
            bad.extend(cause.map(|cause| (at, cause)));
            progress(done, total);
        }
    });
    bad.sort();
    let (strangers, stranger_count) = strangers(dir, &listed)?;
    Ok(VerifyReport {
        tiles: total,
        bytes: listed.iter().map(|tile| tile.file.bytes).sum(),
        bad: bad
            .into_iter()
            .map(|(at, cause)| BadTile {
                path: listed[at].path.clone(),
                cause,
            })
            .collect(),
        strangers,
        stranger_count,
    })
}

/// The index of elevation data, and the tiles that it lists if it is valid.
fn list_heights<'a>(dir: &Path, entry: &'a HeightsEntry, listed: &mut Vec<Listed<'a>>) {
    let index = HeightIndex::read(dir, entry);
    let cause = index.as_ref().err().map(|error| match error {
        PackError::HeightIndex { cause, .. } => cause.clone(),
        PackError::Read { source, .. } => unreadable(source),
        other => other.to_string(),
    });
    listed.push(Listed {
        what: What::Index(cause),
        path: HeightsEntry::index_path(),
        file: entry.index,
    });
    let index = index.ok();
    let records = index.iter().flat_map(|index| index.records());
    listed.extend(records.map(|record| Listed {
        what: What::Heights {
            entry,
            record: *record,
        },
        path: entry.path(record.place),
        file: record.file,
    }));
}

fn listed_tiles(manifest: &Manifest) -> Vec<Listed<'_>> {
    let mut listed = Vec::new();
    for (place, storage) in manifest.storages.iter().enumerate() {
        for entry in &manifest.layers {
            for level in &entry.levels {
                let files = level.tiles.get(place).into_iter().flatten();
                for ((block, part), file) in level.places().zip(files) {
                    listed.extend(file.map(|file| Listed {
                        what: What::Map {
                            storage: *storage,
                            layer: entry.layer,
                            shape: level.shape,
                        },
                        path: tile_path(*storage, entry.layer, level.shape, block, part),
                        file,
                    }));
                }
            }
        }
    }
    listed
}

fn check(dir: &Path, tile: &Listed<'_>) -> Option<String> {
    let path = dir.join(&tile.path);
    let read = match &tile.what {
        What::Index(cause) => return cause.clone(),
        What::Map {
            storage,
            layer,
            shape,
        } => {
            let format = layer.tile_format(*storage);
            read_tile(&path, tile.file, format, *shape, &|| false).map(drop)
        }
        What::Heights { entry, record } => read_whole(&path, tile.file, &|| false)
            .and_then(|bytes| check_heights(&bytes, entry, record, &path)),
    };
    match read {
        Ok(()) => None,
        Err(TileError::Corrupt { cause, .. }) => Some(cause),
        Err(TileError::Unreadable { source, .. }) => Some(unreadable(&source)),
        Err(error) => Some(error.to_string()),
    }
}

fn check_heights(
    bytes: &[u8],
    entry: &HeightsEntry,
    record: &HeightRecord,
    path: &Path,
) -> Result<(), TileError> {
    let checked =
        decode_heights(bytes, entry).and_then(|values| record.check_range(&values, entry.kind));
    checked.map_err(|cause| TileError::Corrupt {
        path: path.into(),
        cause,
    })
}

fn unreadable(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "it is missing".into(),
        _ => error.to_string(),
    }
}

/// Entries below `tiles/` and `heights/` that are neither a tile nor a folder of tiles, by name, and their number. Foreign folders are not entered,
/// so no link is followed.
fn strangers(dir: &Path, listed: &[Listed<'_>]) -> Result<(Vec<PathBuf>, u64), PackError> {
    let files: BTreeSet<&Path> = listed.iter().map(|tile| tile.path.as_path()).collect();
    let folders: BTreeSet<&Path> = files
        .iter()
        .flat_map(|path| path.ancestors().skip(1))
        .filter(|path| *path != Path::new(""))
        .collect();
    let mut strangers = Vec::new();
    let mut count = 0;
    for folder in &folders {
        let path = dir.join(folder);
        let unreadable = |source| PackError::Read {
            path: path.clone(),
            source,
        };
        let entries = match std::fs::read_dir(&path) {
            Ok(entries) => entries,
            // Its tiles are reported as missing.
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => continue,
            Err(error) if error.kind() == std::io::ErrorKind::NotADirectory => continue,
            Err(error) => return Err(unreadable(error)),
        };
        for entry in entries {
            let name = folder.join(entry.map_err(unreadable)?.file_name());
            if !files.contains(name.as_path()) && !folders.contains(name.as_path()) {
                count += 1;
                if strangers.len() < MAX_STRANGERS {
                    strangers.push(name);
                }
            }
        }
    }
    strangers.sort();
    Ok((strangers, count))
}
