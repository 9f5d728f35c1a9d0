//! Forms of the surface's mesh.

use super::variant::SWITCH;

/// Form of the surface's mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum VertexForm {
    /// The block sphere on the ellipsoid; with `tiles`, each block has its own tiles.
    BlockLattice {
        /// Whether blocks have tiles.
        tiles: bool,
    },
    /// Patches of terrain.
    ReliefPatches(PatchTiles),
    /// A grid whose vertices the GPU computes; its triangles span several blocks.
    ProjectedGrid {
        /// Whether blocks have tiles.
        tiles: bool,
    },
    /// City lights as points over the block sphere.
    CityPoints,
    /// No mesh: the whole sky, for clouds overhead.
    Sky,
    /// No mesh: everything, for clouds around the eye.
    Around,
    /// A ring around the ground, for the clouds above its edge.
    Limb,
    /// Prisms behind whose faces rays are cast at pages of contours. Each lies in one block.
    ContourPrisms {
        /// Whether blocks have tiles.
        tiles: bool,
        /// Whether the pass has a depth buffer: the shader then writes the depth of each pixel.
        writes_depth: bool,
    },
}

/// Imagery of terrain patches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PatchTiles {
    /// Whole maps.
    None,
    /// Tiles of the one block that each patch lies in.
    OfOneBlock,
    /// Tiles of each block that a patch overlaps.
    OfSeveralBlocks,
}

impl VertexForm {
    /// All variants of the surface.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for tiles in SWITCH {
            all.push(Self::BlockLattice { tiles });
            all.push(Self::ProjectedGrid { tiles });
            all.extend(SWITCH.map(|writes_depth| Self::ContourPrisms {
                tiles,
                writes_depth,
            }));
        }
        use PatchTiles::{None, OfOneBlock, OfSeveralBlocks};
        all.extend([None, OfOneBlock, OfSeveralBlocks].map(Self::ReliefPatches));
        all
    }

    /// Whether blocks have tiles.
    pub fn has_tiles(self) -> bool {
        match self {
            Self::BlockLattice { tiles } | Self::ProjectedGrid { tiles } => tiles,
            Self::ContourPrisms { tiles, .. } => tiles,
            Self::ReliefPatches(tiles) => tiles != PatchTiles::None,
            Self::CityPoints | Self::Sky | Self::Around | Self::Limb => false,
        }
    }

    /// Whether triangles that span several blocks are drawn with the tiles of each.
    pub fn has_per_block_tiles(self) -> bool {
        matches!(
            self,
            Self::ReliefPatches(PatchTiles::OfSeveralBlocks) | Self::ProjectedGrid { tiles: true }
        )
    }
}
