//! How well an Earth is drawn, and in what order quality is reduced where time is short.

use crate::air::Atmosphere;
use crate::globe::Subdivision;
use crate::imagery::tile::{MAP_LAYERS, MapLayer};
use std::fmt;

/// Cells per block edge that an Earth with tiles should have.
///
/// A pixel shows what its ray meets on the exact ellipsoid, and its block is that of the facet before it. Near an edge
/// the ray may meet the next block's ground, of which a tile has a border of [`TILE_BORDER`] texels. Facets lie up to
/// R(1 − cos(11.25°/n)) below the ellipsoid: 3.4 km for n = 6 and 0.21 km for n = 24, which even at 6° above the ground
/// is little more than a texel of 1.9 km, the paper's finest.
///
/// [`TILE_BORDER`]: crate::imagery::tile::TILE_BORDER
pub const TILED_SUBDIVISION: u32 = 24;

/// How well an Earth is drawn: what [`super::Earth::set_quality`] changes while maps and tiles stay where they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Cells per block edge.
    pub subdivision: Subdivision,
    /// Most samples that a map is filtered with at a grazing view, as in [`super::EarthOptions::anisotropy`].
    pub anisotropy: u16,
    /// Sample count of the pass. The host's pass must have as many.
    pub samples: u32,
    /// Most screen pixels that a texel of a tile may cover, as in [`super::TileOptions::max_texel_px`]; without tiles it
    /// changes nothing.
    pub texel_px: f64,
    /// Which maps are drawn, by [`MapLayer::index`]. One that the Earth was made without is never drawn; the day map
    /// always is.
    pub maps: [bool; MAP_LAYERS],
    /// How the air is drawn.
    pub atmosphere: Atmosphere,
}

impl Quality {
    /// This quality and lower ones, the cheapest loss for the time it saves first: each level gives up one thing more than
    /// the one before. Levels that would change nothing on this Earth are left out, so that each saves something.
    ///
    /// The order is that of the measured front of error against time, `docs/accuracy.md`.
    pub fn levels(self, has_tiles: bool, is_software: bool) -> Vec<QualityLevel> {
        let mut levels = vec![QualityLevel {
            reduction: QualityReduction::None,
            quality: self,
        }];
        for reduction in QualityReduction::ORDER {
            let filtered_once = is_software && reduction == QualityReduction::Anisotropy;
            let without_tiles = !has_tiles && reduction == QualityReduction::Detail;
            let last = levels.last().map_or(self, |level| level.quality);
            let quality = reduction.apply(last, has_tiles);
            if quality != last && !filtered_once && !without_tiles {
                levels.push(QualityLevel { reduction, quality });
            }
        }
        levels
    }
}

/// A step of [`Quality::levels`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QualityLevel {
    /// What it gives up that the one above has.
    pub reduction: QualityReduction,
    /// The quality that is left.
    pub quality: Quality,
}

/// What can be given up to draw faster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QualityReduction {
    /// All is drawn.
    None,
    /// Maps are filtered with two samples at grazing views.
    Anisotropy,
    /// Texels of tiles may cover twice as many pixels.
    Detail,
    /// Relief in the light: the normals.
    Relief,
    /// Smooth edges: one sample a pixel.
    Samples,
    /// A round limb: six cells a block edge, the paper's; with tiles as many as they need.
    Roundness,
    /// Lights of cities.
    Lights,
    /// Clouds.
    Clouds,
    /// The air.
    Air,
}

impl QualityReduction {
    /// What saves most for the least error first. Of a frame on a software adapter, with the FLIP error that is added:
    /// four samples 46 % and 0.000 (the air hides the limb's edge), the air 26 %, each of relief, lights and clouds 3 %.
    const ORDER: [Self; 8] = [
        Self::Samples,
        Self::Anisotropy,
        Self::Detail,
        Self::Roundness,
        Self::Relief,
        Self::Lights,
        Self::Air,
        Self::Clouds,
    ];

    fn apply(self, from: Quality, has_tiles: bool) -> Quality {
        let coarsest = if has_tiles { TILED_SUBDIVISION } else { 6 };
        let without = |layers: &[MapLayer]| {
            let mut maps = from.maps;
            for layer in layers {
                maps[layer.index()] = false;
            }
            Quality { maps, ..from }
        };
        match self {
            Self::None => from,
            Self::Anisotropy => Quality {
                anisotropy: from.anisotropy.min(2),
                ..from
            },
            Self::Detail => Quality {
                texel_px: 2.0 * from.texel_px,
                ..from
            },
            Self::Relief => without(&[MapLayer::Normals]),
            Self::Samples => Quality { samples: 1, ..from },
            Self::Roundness => Quality {
                subdivision: Subdivision::Cells(match from.subdivision {
                    Subdivision::Auto => coarsest,
                    Subdivision::Cells(cells) => cells.min(coarsest),
                }),
                ..from
            },
            // Not the water: under it the day map is no picture of the sea.
            Self::Lights => without(&[MapLayer::NightLights]),
            Self::Clouds => without(&[MapLayer::Clouds]),
            Self::Air => Quality {
                atmosphere: Atmosphere::None,
                ..from
            },
        }
    }
}

impl fmt::Display for QualityReduction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "nothing",
            Self::Anisotropy => "anisotropy",
            Self::Detail => "fine tiles",
            Self::Relief => "relief",
            Self::Samples => "smooth edges",
            Self::Roundness => "round limb",
            Self::Lights => "lights",
            Self::Clouds => "clouds",
            Self::Air => "air",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn full() -> Quality {
        Quality {
            subdivision: Subdivision::Auto,
            anisotropy: 8,
            samples: 4,
            texel_px: 1.0,
            maps: [true; MAP_LAYERS],
            atmosphere: Atmosphere::Billboard,
        }
    }

    #[test]
    fn every_rung_gives_up_one_thing_more() {
        let full = || Quality {
            subdivision: Subdivision::Cells(48),
            ..full()
        };
        let levels = full().levels(true, false);
        assert_eq!(levels.len(), 1 + QualityReduction::ORDER.len());
        assert_eq!(levels[0].quality, full());
        for pair in levels.windows(2) {
            assert_eq!(
                pair[1].reduction.apply(pair[0].quality, true),
                pair[1].quality,
                "{}",
                pair[1].reduction
            );
            assert_ne!(pair[0].quality, pair[1].quality);
        }
        let last = levels[levels.len() - 1].quality;
        assert_eq!(
            (last.samples, last.subdivision),
            (1, Subdivision::Cells(TILED_SUBDIVISION))
        );
        assert_eq!(last.maps, [true, false, false, false, true]);
    }

    #[test]
    fn what_changes_nothing_is_no_rung() {
        let names = |levels: Vec<QualityLevel>| {
            levels
                .iter()
                .map(|level| level.reduction)
                .collect::<Vec<_>>()
        };
        let software = names(full().levels(false, true));
        assert!(
            !software.contains(&QualityReduction::Anisotropy)
                && !software.contains(&QualityReduction::Detail)
        );
        let mut bare = Quality {
            subdivision: Subdivision::Cells(6),
            anisotropy: 1,
            samples: 1,
            atmosphere: Atmosphere::None,
            ..full()
        };
        bare.maps = [true, false, false, false, false];
        assert_eq!(names(bare.levels(false, false)), [QualityReduction::None]);
    }
}
