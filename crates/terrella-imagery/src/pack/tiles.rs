//! A pack as a source of tiles. Every reading opens its file again: nothing is kept between two of them.

use super::container::read_ktx2;
use super::decode::decode_tile;
use super::error::PackError;
use super::file::{TileFile, check, read_whole, unless};
use super::open::Pack;
use crate::tile::{
    LayerLayout, LevelLayout, MapLayer, Storage, Tile, TileError, TileFormat, TileKey, TileSet,
    TileShape, TileSource,
};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The tiles of some maps of a pack, in one of its storages.
#[derive(Debug)]
pub struct PackTiles {
    pub(super) pack: Arc<Pack>,
    pub(super) storage: Storage,
    decode: bool,
    layouts: Vec<LayerLayout>,
}

impl PackTiles {
    /// The tiles of `layers` as `storage` keeps them, or with `decode` made plain on the CPU where they are compressed.
    /// The day map is always among them, and each map once.
    ///
    /// # Errors
    /// A storage or a map that the pack has not.
    pub fn new(
        pack: Arc<Pack>,
        storage: Storage,
        decode: bool,
        layers: &[MapLayer],
    ) -> Result<Self, PackError> {
        let manifest = pack.manifest();
        let Some(place) = manifest.storages.iter().position(|kept| *kept == storage) else {
            return Err(PackError::NoStorage {
                path: pack.dir().into(),
                storage,
                has: manifest.storages.first().map_or("none", |kept| kept.name()),
            });
        };
        let mut layouts = Vec::new();
        for layer in MapLayer::ALL {
            if layer != MapLayer::Day && !layers.contains(&layer) {
                continue;
            }
            let entry = manifest.layer(layer).ok_or_else(|| PackError::NoLayer {
                path: pack.dir().into(),
                layer,
            })?;
            let format = layer.tile_format(storage);
            let levels = entry.levels.iter().map(|level| {
                let mut present = TileSet::none(level.shape);
                for ((block, part), file) in level.places().zip(&level.tiles[place]) {
                    if file.is_some() {
                        // 0…127.
                        present.insert(block.index() as u8, part);
                    }
                }
                LevelLayout {
                    shape: level.shape,
                    present,
                }
            });
            layouts.push(LayerLayout {
                layer,
                format: if decode { format.decoded() } else { format },
                levels: levels.collect(),
            });
        }
        Ok(Self {
            pack,
            storage,
            decode,
            layouts,
        })
    }

    /// The pack.
    pub fn pack(&self) -> &Arc<Pack> {
        &self.pack
    }

    /// Which of the pack's storages is read.
    pub fn storage(&self) -> Storage {
        self.storage
    }

    /// A tile as it is stored.
    pub fn read_stored(
        &self,
        key: TileKey,
        cancelled: &dyn Fn() -> bool,
    ) -> Result<Tile, TileError> {
        let (path, file, shape) = self.place(key)?;
        let format = key.layer.tile_format(self.storage);
        read_tile(&path, file, format, shape, cancelled)
    }

    /// Path and length of a tile's file, for a host that reads it itself.
    ///
    /// # Errors
    /// [`TileError::Absent`].
    pub fn file(&self, key: TileKey) -> Result<(PathBuf, u64), TileError> {
        let (path, file, _) = self.place(key)?;
        Ok((path, file.bytes))
    }

    /// A tile from the bytes of its file, as [`TileSource::read`] gives it.
    ///
    /// # Errors
    /// [`TileError::Absent`], or bytes that do not match the manifest.
    pub fn tile_of(&self, key: TileKey, bytes: &[u8]) -> Result<Tile, TileError> {
        let (path, file, shape) = self.place(key)?;
        let format = key.layer.tile_format(self.storage);
        let read = check(bytes, file).and_then(|()| read_ktx2(bytes, format, shape));
        let tile = read.map_err(|cause| TileError::Corrupt { path, cause })?;
        Ok(if self.decode { decode_tile(tile) } else { tile })
    }

    fn place(&self, key: TileKey) -> Result<(PathBuf, TileFile, TileShape), TileError> {
        let is_listed = self.layouts.iter().any(|layout| layout.layer == key.layer);
        let tile = self.pack.manifest().tile(self.storage, key);
        let (shape, file) = tile.filter(|_| is_listed).ok_or(TileError::Absent(key))?;
        let path = self.pack.tile_path(self.storage, key);
        Ok((path.ok_or(TileError::Absent(key))?, file, shape))
    }
}

impl TileSource for PackTiles {
    fn layers(&self) -> &[LayerLayout] {
        &self.layouts
    }

    fn read(&self, key: TileKey, cancelled: &dyn Fn() -> bool) -> Result<Tile, TileError> {
        let tile = self.read_stored(key, cancelled)?;
        if !self.decode {
            return Ok(tile);
        }
        unless(cancelled)?;
        Ok(decode_tile(tile))
    }
}

/// Reads a tile's file, which must match the manifest exactly.
pub(super) fn read_tile(
    path: &Path,
    file: TileFile,
    format: TileFormat,
    shape: TileShape,
    cancelled: &dyn Fn() -> bool,
) -> Result<Tile, TileError> {
    let bytes = read_whole(path, file, cancelled)?;
    unless(cancelled)?;
    read_ktx2(&bytes, format, shape).map_err(|cause| TileError::Corrupt {
        path: path.into(),
        cause,
    })
}
