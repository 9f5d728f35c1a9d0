//! What is said of heights where the ground itself may be left out.

/// Lowest and highest of some heights, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightRange {
    /// Lowest height, metres above the ellipsoid.
    pub low_m: f64,
    /// Highest height, metres above the ellipsoid.
    pub high_m: f64,
}

/// Tiles of heights that are streamed; all zero of heights that are in memory as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HeightTileStats {
    /// Tiles in memory.
    pub tiles: u32,
    /// Bytes of all heights in memory, the coarsest level's among them.
    pub bytes: u64,
    /// Requested tiles that are loading.
    pub wanted: u32,
    /// Requested tiles that exceed the budget: the terrain stays coarser there.
    pub rejected: u32,
    /// Requested tiles that could not be read.
    pub unreadable: u32,
    /// How often a tile has come or gone since the start.
    pub changes: u64,
}
