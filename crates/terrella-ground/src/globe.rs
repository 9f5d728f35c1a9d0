//! The block sphere of the 2011 paper: blocks, culling and level of detail (LOD); and surfaces with relief. This
//! module uses no GPU.
//!
//! The Earth is divided into 16 × 8 blocks of 22.5° each. A block is drawn as a lattice of n × n cells. [`BlockGrid`] holds
//! the lattice in f64, and [`select_blocks`] chooses the blocks that an eye needs. [`screen_level`] and [`paper_level`]
//! choose the level of detail of the map, [`Meshes`] that of the lattice.
//!
//! A [`Surface`] draws terrain: it converts a view and heights into patches of triangles. The surfaces are
//! `DisplacedBlocks`, `projected_grid`, `quadtree`, `contours` or `clipmap`; `SurfaceKind` names them. They need the feature
//! `terrain`.
//!
//! `culling` excludes everything outside the view frustum or behind the horizon, for all surfaces.

mod blocks;
#[cfg(feature = "terrain")]
pub mod clipmap;
#[cfg(feature = "terrain")]
pub mod contours;
// Surfaces with relief and tracks need more of it than blocks do.
pub mod culling;
#[cfg(feature = "terrain")]
mod displaced;
#[cfg(feature = "terrain")]
mod index_ranges;
#[cfg(feature = "terrain")]
mod kinds;
mod levels;
mod limb;
mod meshes;
mod parts;
#[cfg(feature = "terrain")]
pub mod projected_grid;
#[cfg(feature = "terrain")]
pub mod quadtree;
mod select;
#[cfg(all(test, feature = "terrain"))]
mod streamed_tests;
#[cfg_attr(not(feature = "terrain"), path = "globe/no_surface.rs")]
mod surface;
mod surface_stats;

pub use blocks::{
    BLOCK_COUNT, Block, BlockGrid, BlockRow, BlockSet, COLUMNS, ROWS, SubdivisionError,
};
#[cfg(feature = "terrain")]
pub use displaced::DisplacedBlocks;
#[cfg(feature = "terrain")]
pub use index_ranges::{RANGE_TRIANGLES, blocks_near, patch_ranges};
#[cfg(feature = "terrain")]
pub use kinds::{ContourDrawing, SurfaceError, SurfaceKind, SurfaceSettings};
pub use levels::{
    HYSTERESIS, LevelRule, PAPER_BANDS_M, paper_level, screen_level, texels_per_pixel,
};
pub use limb::TangentCone;
pub use meshes::{LIMB_PX, Meshes, Subdivision, limb_error_px, sagitta};
pub use parts::{Part, PartSight};
pub use select::{Selection, select_blocks, select_blocks_between};
#[cfg(feature = "terrain")]
pub use surface::{
    ContourPage, ContourPageSet, GridDraw, GroundVertex, GroundView, IndexRange, Patch,
    TriangleList, merged_ranges,
};
pub use surface::{DrawKind, Surface, SurfaceStats};

/// Visibility test of blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize, serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Visibility {
    /// Never drops a visible block.
    #[default]
    Conservative,
    /// The paper's rule: a block is drawn if (e − v)·n > 0 at one of its four corners. Drops visible blocks near the
    /// ground.
    Paper,
}

/// The figure of the Earth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize, serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Figure {
    /// The WGS84 ellipsoid.
    #[default]
    Wgs84,
    /// The paper's sphere, R = 6 378 164 m.
    Sphere,
}

impl Figure {
    pub fn ellipsoid(self) -> terrella_frames::Ellipsoid {
        match self {
            Self::Wgs84 => terrella_frames::Ellipsoid::WGS84,
            Self::Sphere => terrella_frames::Ellipsoid::PAPER_SPHERE,
        }
    }
}

/// How the surface is shaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize, serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Shading {
    /// Linear light, the Sun of the date, dark night side with a soft terminator.
    #[default]
    Sunlit,
    /// The three layers earth, cloud and normal as the 2011 paper prints them, in display values.
    Paper,
}
