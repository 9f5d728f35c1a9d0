//! How fine a map is asked for.

use terrella_ground::globe::{LevelRule, paper_level, screen_level};
use terrella_imagery::tile::{LayerLayout, TileShape};

/// Level of a block that was not requested in the frame before.
pub(super) const NONE: u8 = u8::MAX;

/// How levels are chosen.
#[derive(Clone, Copy)]
pub(super) struct TileRule {
    pub rule: LevelRule,
    /// [`LevelRule::Screen`]: most screen pixels that a texel may cover.
    pub max_texel_px: f64,
    /// The Earth's.
    pub radius_m: f64,
}

impl TileRule {
    /// The level of a map at a distance, in a view whose pixels are so large; `before` in the frame before.
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
    /// Texels per block side; empty where a map has no tiles.
    pub pixels: Vec<u32>,
    /// How often blocks are halved for the tiles of those that are cut into parts.
    pub depths: Vec<u8>,
}

impl Ladder {
    /// That of a map of a source.
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
