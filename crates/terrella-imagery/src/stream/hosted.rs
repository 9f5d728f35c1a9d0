//! Loads that the host does itself.

use super::cache::LoadId;
use super::loader::TileReads;
use crate::tile::{LayerLayout, Tile, TileError, TileKey, TileSource};
use std::sync::Arc;

/// The layout of tiles that the host loads itself, with [`super::TileLoading::Host`].
#[derive(Clone, Debug)]
pub struct HostedTiles(pub Vec<LayerLayout>);

impl TileSource for HostedTiles {
    fn layers(&self) -> &[LayerLayout] {
        &self.0
    }

    fn read(&self, key: TileKey, _: &dyn Fn() -> bool) -> Result<Tile, TileError> {
        Err(TileError::Absent(key))
    }
}

/// A tile for the host to load, and its turn at it. If dropped without [`Self::end`], the load has failed and the tile is requested again later.
pub struct TileLoad {
    key: TileKey,
    id: LoadId,
    /// Absent after the end.
    reads: Option<Arc<TileReads>>,
}

impl TileLoad {
    pub(super) fn begin(reads: &Arc<TileReads>) -> Option<Self> {
        let (key, id) = reads.begin()?;
        Some(Self {
            key,
            id,
            reads: Some(Arc::clone(reads)),
        })
    }

    /// The tile.
    pub fn key(&self) -> TileKey {
        self.key
    }

    /// Whether it is still requested. Otherwise the host may end it with [`TileError::Cancelled`].
    pub fn is_wanted(&self) -> bool {
        let reads = self.reads.as_ref();
        reads.is_some_and(|reads| !reads.is_cancelled(self.id))
    }

    /// Passes on the tile or the reason why there is none. A tile of another format or size than its layout's is an error.
    pub fn end(mut self, result: Result<Tile, TileError>) {
        self.give(result);
    }

    fn give(&mut self, result: Result<Tile, TileError>) {
        if let Some(reads) = self.reads.take() {
            reads.end(self.key, self.id, result);
        }
    }
}

impl Drop for TileLoad {
    fn drop(&mut self) {
        self.give(Err(TileError::Cancelled));
    }
}
