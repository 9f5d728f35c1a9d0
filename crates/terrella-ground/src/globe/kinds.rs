//! Selects the surface that draws terrain, and its settings.

use super::clipmap::{Clipmap, ClipmapOptions, SamplesError};
use super::contours::{ContourOptions, ContourPages, ContourSurface, PageOptions};
use super::projected_grid::{GridOptions, ProjectedGrid};
use super::quadtree::{Quadtree, QuadtreeOptions};
use super::{DisplacedBlocks, Figure, Subdivision, SubdivisionError, Surface};

/// Levels of a scene's clipmap, twice the paper's; the last has cells of 27 m. Levels that neither the view nor the data needs cost
/// nothing.
const SCENE_LEVELS: u32 = 12;

/// Which surface draws terrain. The default is the best near the ground according to docs/surfaces.md.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SurfaceKind {
    /// The blocks of the 2011 paper, their vertices displaced.
    Blocks,
    /// A grid on the screen, cast on the ground (2009).
    ProjectedGrid,
    /// Squares of the ground, divided where it is rough and near (2005).
    #[default]
    Quadtree,
    /// After the paper of 2017: rays are cast at its contours, or bicubic patches replace them, see [`ContourDrawing`].
    Contours,
    /// Nested rings of samples on an icosahedron (2014).
    Clipmap,
}

impl SurfaceKind {
    pub const ALL: &[Self] = &[
        Self::Blocks,
        Self::ProjectedGrid,
        Self::Quadtree,
        Self::Contours,
        Self::Clipmap,
    ];

    /// Name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Blocks => "blocks",
            Self::ProjectedGrid => "projected-grid",
            Self::Quadtree => "quadtree",
            Self::Contours => "contours",
            Self::Clipmap => "clipmap",
        }
    }

    /// Default settings. `subdivision` is for blocks only; `Auto` selects the finest mesh there.
    pub fn settings(self, subdivision: Subdivision) -> SurfaceSettings {
        match self {
            Self::Blocks => SurfaceSettings::Blocks(subdivision),
            Self::ProjectedGrid => SurfaceSettings::ProjectedGrid(GridOptions::default()),
            Self::Quadtree => SurfaceSettings::Quadtree(QuadtreeOptions::default()),
            Self::Contours => SurfaceSettings::Contours(ContourOptions::default()),
            Self::Clipmap => SurfaceSettings::Clipmap(ClipmapOptions {
                levels: SCENE_LEVELS,
                ..ClipmapOptions::default()
            }),
        }
    }
}

/// How contours are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ContourDrawing {
    /// Contours are not drawn: bicubic patches of the heights in Hermite form, without q, as triangles.
    #[default]
    Patches,
    /// By casting each pixel's ray at them.
    Cast,
}

/// A surface that draws terrain, with its settings. The Earth's figure replaces the figures in them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SurfaceSettings {
    /// [`DisplacedBlocks`] with this number of cells a block edge.
    Blocks(Subdivision),
    /// [`ProjectedGrid`]
    ProjectedGrid(GridOptions),
    /// [`Quadtree`]
    Quadtree(QuadtreeOptions),
    /// [`ContourSurface`]
    Contours(ContourOptions),
    /// [`ContourPages`]. A device that cannot read storage buffers in fragment shaders gets [`ContourSurface`].
    CastContours(PageOptions),
    /// [`Clipmap`]
    Clipmap(ClipmapOptions),
}

/// Why a surface cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SurfaceError {
    /// Invalid cells of blocks.
    #[error(transparent)]
    Subdivision(#[from] SubdivisionError),
    /// Invalid samples of a clipmap.
    #[error(transparent)]
    Samples(#[from] SamplesError),
}

impl SurfaceSettings {
    /// Makes the surface on this figure.
    ///
    /// # Errors
    /// Settings out of range.
    pub fn make(self, figure: Figure) -> Result<Box<dyn Surface>, SurfaceError> {
        let ellipsoid = figure.ellipsoid();
        Ok(match self {
            Self::Blocks(Subdivision::Auto) => Box::new(DisplacedBlocks::finest(ellipsoid)),
            Self::Blocks(Subdivision::Cells(cells)) => {
                Box::new(DisplacedBlocks::new(ellipsoid, cells)?)
            }
            Self::ProjectedGrid(options) => {
                Box::new(ProjectedGrid::new(&GridOptions { figure, ..options }))
            }
            Self::Quadtree(options) => Box::new(Quadtree::new(QuadtreeOptions {
                ellipsoid,
                ..options
            })),
            Self::Contours(options) => Box::new(ContourSurface::new(ContourOptions {
                ellipsoid,
                ..options
            })),
            Self::CastContours(options) => Box::new(ContourPages::new(PageOptions {
                ellipsoid,
                ..options
            })),
            Self::Clipmap(options) => Box::new(Clipmap::new(ClipmapOptions {
                ellipsoid,
                ..options
            })?),
        })
    }
}
