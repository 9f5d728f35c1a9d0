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
    /// Tiles that are asked for and on their way.
    pub wanted: u32,
    /// Tiles that are asked for and that the budget has no room for: the ground stays coarser there.
    pub rejected: u32,
    /// Tiles that were asked for and could not be read.
    pub unreadable: u32,
    /// How often a tile has come or gone since the start.
    pub changes: u64,
}
