//! The clipmap on an icosahedron of the 2014 paper: nested squares of samples about the point below the eye, each twice as coarse as the
//! one inside it, on a lattice of ten diamonds. No GPU here.
//!
//! Level 0 is the whole globe, ten diamonds of `radius` × `radius` cells. `radius` is (samples − 1)/2: cells of about 110 km at the
//! default. Level 0 is read once and only loses cells to level 1. Level ℓ ≥ 1 is a square of `samples` × `samples` points about the eye's
//! ground point, with diamonds of `radius`·2^ℓ cells. The finer levels and the rest of the globe form one closed surface:
//!
//! * A level's extent is all points within `radius` steps of its middle, counted on the globe's own lattice. The middle is an even point,
//!   so the border follows the coarser lattice. At the border the level draws at half the rate, and its vertices match the coarser level's
//!   to the last bit. Over the last quarter of the radius it blends gradually into the coarser surface.
//! * Where three diamonds meet instead of four, a corner of the square is missing and the two diamonds beside it touch. At a pole five
//!   diamonds meet: two corners replace one, each cut to the longer of the middle's distances. Nothing there is drawn twice or left out,
//!   and triangles are always those of the icosahedron's faces.
//! * The choice of home diamond has no effect: a change of home reads nothing and moves nothing.
//!
//! A level moves when the eye is more than 1.5 cells from its middle. It moves to the nearest even point and reads only the new samples.
//! Levels appear and disappear by blending with the coarser surface first. If the eye outruns the samples that a [`Surface::prepare`] may
//! read, the level and all finer ones are not drawn until they are complete again.
//!
//! Positions of level ℓ are on a grid of 2^(1 − ℓ) m, a 55 000th of the cell; from level 10 on the grid is 2 mm. Offsets from the level's
//! origin are exact in single precision. The origin moves when the middle is half a radius away from it.
//!
//! Patches therefore meet to the last bit in double precision. A GPU adds an offset to the rounded eye-relative origin; there they meet to
//! less than a 1 000th of a pixel of a milliradian. The grid itself moves no vertex by more than a 60 000th of its cell, or 2 mm.
//!
//! An eye at rest reads, changes and allocates nothing. When a level moves, its triangle list and that of the coarser level are rebuilt:
//! two allocations each, 0.4 MB at 129 samples.
//!
//! The tolerance limits the number of levels. The last level is the first one where a sixteenth of a cell, the assumed rise between
//! samples, is within it. The finest data anywhere within a level's extent limit it too: no level has cells of less than a 128th of the
//! data's. Cells as wide as the data's are not enough, because the lattice's triangles cross the edges along which the data's surface
//! bends. The tolerance does not bound the error: the paper's cells are as wide as a 32nd of their distance, whatever the terrain.

mod changed;
mod lattice;
mod level;
mod level_extent;
mod level_update;
#[cfg(test)]
mod tests;
mod toroidal;
mod triangles;

pub use lattice::{
    DIAMONDS, DiamondCorner, DiamondPlace, Icosahedron, LatticeIndex, Triangle, virtual_diamond,
};
pub use level_extent::{DiamondExtent, IndexBox, LevelExtent};

use super::surface::{GroundView, Patch, Surface, SurfaceStats};
use crate::elevation::{Bounds, Elevation, HeightChange};
use level::{HeightSource, Level};
use level_update::{FinestData, SubEyePoint, is_base_visible};
use terrella_frames::Ellipsoid;

/// The outline of a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Trim {
    /// The whole square, a diamond of 60° on the ground.
    #[default]
    Diamond,
    /// The square minus its two sharp corners: about equally far in all directions.
    Hexagon,
}

/// Options of a clipmap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipmapOptions {
    /// Samples along an edge of a level: 65, 129 or 257.
    pub samples: u32,
    /// Largest number of levels besides the globe's, 0…[`MAX_LEVELS`]; larger values are clamped.
    pub levels: u32,
    /// Largest number of samples that one [`Surface::prepare`] reads, besides the globe's, which the first one reads. A new level takes
    /// several calls; `u64::MAX` completes all levels at once.
    pub samples_per_prepare: u64,
    /// Number of [`Surface::prepare`] calls over which a level appears or disappears; 0 for at once.
    pub fade_prepares: u32,
    /// The outline of a level.
    pub trim: Trim,
    /// The ellipsoid that heights are measured from.
    pub ellipsoid: Ellipsoid,
}

impl Default for ClipmapOptions {
    /// The paper's six levels of 129 × 129.
    fn default() -> Self {
        Self {
            samples: 129,
            levels: 6,
            samples_per_prepare: 2048,
            fade_prepares: 8,
            trim: Trim::Diamond,
            ellipsoid: Ellipsoid::WGS84,
        }
    }
}

/// Finest possible level: cells of 7 mm at 129 samples, the limit of the lattice indices.
pub const MAX_LEVELS: u32 = 24;

/// The number of samples of a level is not an allowed one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a clipmap level has {0} samples an edge; it must have 65, 129 or 257")]
pub struct SamplesError(pub u32);

/// Counts of a clipmap's last [`Surface::prepare`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClipmapCounts {
    /// Finest level that is drawn.
    pub finest: u32,
    /// Levels that the view needs.
    pub wanted: u32,
    /// Levels that moved with the eye.
    pub moved: u32,
    /// Samples read for levels.
    pub samples: u64,
}

/// The surface "clipmap".
pub struct Clipmap {
    options: ClipmapOptions,
    icosahedron: Icosahedron,
    levels: Vec<Level>,
    /// By level number, the finest data within the level's reach.
    found: Vec<Option<FinestData>>,
    /// Level and buffer indices of the drawn patches, near ones first.
    drawn: Vec<(usize, usize)>,
    /// First revision of the next new buffer.
    clock: u64,
    counts: ClipmapCounts,
    stats: SurfaceStats,
    /// Set by `forget_views`: levels appear without fading until all samples are read.
    is_at_rest: bool,
}

impl Clipmap {
    /// An empty clipmap; the first [`Surface::prepare`] reads the globe's samples.
    ///
    /// # Errors
    /// A number of samples that is not allowed.
    pub fn new(options: ClipmapOptions) -> Result<Self, SamplesError> {
        if ![65, 129, 257].contains(&options.samples) {
            return Err(SamplesError(options.samples));
        }
        let levels = options.levels.min(MAX_LEVELS);
        Ok(Self {
            options: ClipmapOptions { levels, ..options },
            icosahedron: Icosahedron::default(),
            levels: Vec::with_capacity(levels as usize + 1),
            found: (0..=levels).map(|_| None).collect(),
            drawn: Vec::with_capacity(10 + 5 * levels as usize),
            clock: 0,
            counts: ClipmapCounts::default(),
            stats: SurfaceStats::default(),
            is_at_rest: false,
        })
    }

    /// Drops all samples, for elevation data that have changed.
    pub fn forget(&mut self) {
        self.levels.clear();
        self.found.fill_with(|| None);
        self.drawn.clear();
    }

    /// Counts of the last [`Surface::prepare`].
    pub fn counts(&self) -> ClipmapCounts {
        self.counts
    }

    /// Edge length of a cell at a level, metres: the mean along an edge of the icosahedron. Over the globe the length is 0.8…1.2 times
    /// that.
    pub fn spacing_m(&self, level: u32) -> f64 {
        let n = f64::from(self.options.samples / 2) * 2.0_f64.powi(level as i32);
        level::EDGE_RAD / n * self.options.ellipsoid.equatorial_radius_m
    }

    /// Upper bound of the bytes of samples, vertices and indices for these options: five buffers a level, and the globe.
    pub fn max_bytes(&self) -> u64 {
        let samples = u64::from(self.options.samples);
        let half = samples / 2 + 1;
        // Two vertices and a tag a slot; two triangles a cell.
        let slot = 2 * 24 + 8 + 1 + 24;
        slot * (samples * samples * 5 * u64::from(self.options.levels) + half * half * 10)
    }
}

impl Surface for Clipmap {
    fn name(&self) -> &'static str {
        "clipmap"
    }

    fn prepare(&mut self, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats {
        self.stats.samples_read = 0;
        let ellipsoid = self.options.ellipsoid;
        let Some(eye) = SubEyePoint::new(&self.icosahedron, &ellipsoid, view, ground) else {
            return self.stats;
        };
        self.counts = ClipmapCounts::default();
        let source = HeightSource {
            ellipsoid: &ellipsoid,
            icosahedron: &self.icosahedron,
            ground,
        };
        let radius = i64::from(self.options.samples / 2);
        let mut read = 0;
        if self.levels.is_empty() {
            let mut globe = Level::new(0, radius, self.options.trim);
            read += globe.fill_globe(&source, &mut self.clock);
            self.levels.push(globe);
        }
        let fade_prepares = match self.is_at_rest {
            true => 0,
            false => self.options.fade_prepares,
        };
        level_update::update_levels(
            &mut self.levels,
            &mut self.found,
            &ClipmapOptions {
                fade_prepares,
                ..self.options
            },
            &eye,
            &source,
            &mut self.clock,
            &mut self.counts,
        );
        read += self.counts.samples;
        self.is_at_rest &= self.counts.samples > 0;
        let mut left = self
            .options
            .samples_per_prepare
            .saturating_sub(self.counts.samples);
        read += changed::read_left(&mut self.levels, &source, &mut left);

        self.drawn.clear();
        let mut stats = SurfaceStats {
            samples_read: read,
            ..SurfaceStats::default()
        };
        for number in 0..self.levels.len() {
            let (coarse, fine) = self.levels.split_at_mut(number + 1);
            let level = &mut coarse[number];
            level.cut(fine.first());
            stats.resident_bytes += level.bytes() as u64;
            for buffer in &mut level.buffers {
                buffer.publish();
            }
        }
        let range = ground.range_m(&Bounds::GLOBE);
        let cell_rad = level::EDGE_RAD / radius as f64;
        let finest = self.counts.finest as usize;
        for (number, level) in self.levels.iter().enumerate().take(finest + 1).rev() {
            for (at, buffer) in level.buffers.iter().enumerate() {
                let patch = &buffer.patch;
                let empty = patch.indices.triangles.is_empty();
                let is_hidden = number == 0
                    && !is_base_visible(patch.origin_itrf_m, view, &ellipsoid, range, cell_rad);
                if empty || is_hidden {
                    continue;
                }
                self.drawn.push((number, at));
                stats.patches += 1;
                stats.vertices += patch.vertices.len() as u32;
                stats.triangles += patch.indices.triangles.len() as u32 / 3;
            }
        }
        self.stats = stats;
        stats
    }

    fn heights_changed(&mut self, changes: &[HeightChange], ground: &dyn Elevation) {
        let source = HeightSource {
            ellipsoid: &self.options.ellipsoid,
            icosahedron: &self.icosahedron,
            ground,
        };
        changed::heights_changed(&mut self.levels, changes, &source);
    }

    fn forget_views(&mut self) {
        for level in self.levels.iter_mut().skip(1) {
            level.forget_view();
        }
        self.found.fill_with(|| None);
        self.is_at_rest = true;
    }

    fn crosses_blocks(&self) -> bool {
        true
    }

    fn for_each_patch(&self, draw: &mut dyn FnMut(&Patch)) {
        for (level, buffer) in &self.drawn {
            draw(&self.levels[*level].buffers[*buffer].patch);
        }
    }
}
