//! Numbers of heights that are streamed.

/// Tiles of heights that are streamed; all zero of heights that are in memory as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HeightTileStats {
    /// Tiles in memory.
    pub tiles: u32,
    /// Bytes of all heights in memory, the coarsest level's among them.
    pub bytes: u64,
    /// Tiles that are asked for and on their way.
    pub wanted: u32,
    /// Tiles that are asked for and that the budget has no room for: the ground stays coarser there.
    pub refused: u32,
    /// Tiles that were asked for and could not be read.
    pub unreadable: u32,
    /// How often a tile has come or gone since the start.
    pub changes: u64,
}
