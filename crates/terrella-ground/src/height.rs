//! Types about heights that exist even without the elevation module.

/// Lowest and highest of some heights, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightRange {
    /// Lowest height, metres above the ellipsoid.
    pub low_m: f64,
    /// Highest height, metres above the ellipsoid.
    pub high_m: f64,
}

/// Statistics of streamed height tiles; all zero if all heights are in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HeightTileStats {
    /// Tiles in memory.
    pub tiles: u32,
    /// Bytes of all heights in memory, including the coarsest level.
    pub bytes: u64,
    /// Requested tiles that are loading.
    pub wanted: u32,
    /// Requested tiles that exceed the budget: the terrain stays coarser there.
    pub rejected: u32,
    /// Requested tiles that could not be read.
    pub unreadable: u32,
    /// Number of loads and evictions since the start.
    pub changes: u64,
}
