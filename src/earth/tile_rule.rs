//! The required level of a map.

use terrella_ground::globe::{LevelRule, paper_level, screen_level};
use terrella_imagery::tile::{LayerLayout, TileShape};

/// Marks a block that was not requested in the previous frame.
pub(super) const NONE: u8 = u8::MAX;

/// How levels are selected.
#[derive(Clone, Copy)]
pub(super) struct TileRule {
    pub rule: LevelRule,
    /// [`LevelRule::Screen`]: most screen pixels that a texel may cover.
    pub max_texel_px: f64,
    /// Radius of the Earth, metres.
    pub radius_m: f64,
}

impl TileRule {
    /// The level of a map at a distance, for this angular pixel size. `before` is the level in the previous frame.
    pub fn level(
        &self,
        ladder: &Ladder,
        distance_m: f64,
        pixel_rad: f64,
        before: Option<u8>,
    ) -> u8 {
        let level = match self.rule {
            LevelRule::Paper => paper_level(distance_m, ladder.pixels.len()),
            LevelRule::Screen => screen_level(
                &ladder.pixels,
                self.radius_m,
                distance_m,
                pixel_rad,
                self.max_texel_px,
                before.filter(|level| *level != NONE).map(usize::from),
            ),
        };
        level as u8
    }
}

/// The levels of a map, the finest first.
#[derive(Default)]
pub(super) struct Ladder {
    /// Texels per block side; empty if the map has no tiles.
    pub pixels: Vec<u32>,
    /// For each level that is cut into parts, how often blocks are halved.
    pub depths: Vec<u8>,
}

impl Ladder {
    /// The ladder of a source's map.
    pub fn new(layout: &LayerLayout) -> Self {
        let shapes = || layout.levels.iter().map(|level| level.shape);
        let cut = shapes().take(layout.cut_levels());
        Self {
            pixels: shapes().map(TileShape::block_pixels).collect(),
            depths: cut.map(|shape| shape.parts.ilog2() as u8).collect(),
        }
    }

    /// The finest level with tiles of whole blocks.
    pub fn whole(&self) -> u8 {
        self.depths.len() as u8
    }
}
