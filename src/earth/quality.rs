//! How well an Earth is drawn, and what can be given up where time is short.

use std::fmt;
use std::ops::RangeInclusive;
use terrella_ground::air::Atmosphere;
use terrella_ground::globe::Subdivision;
use terrella_imagery::tile::{MAP_LAYERS, MapLayer};

/// Cells per block edge that an Earth with tiles should have.
///
/// A pixel shows what its ray meets on the exact ellipsoid, and its block is that of the facet before it. Near an edge
/// the ray may meet the next block's ground, of which a tile has a border of [`TILE_BORDER`] texels. Facets lie up to
/// R(1 − cos(11.25°/n)) below the ellipsoid: 3.4 km for n = 6 and 0.21 km for n = 24, which even at 6° above the ground
/// is little more than a texel of 1.9 km, the paper's finest.
///
/// [`TILE_BORDER`]: terrella_imagery::tile::TILE_BORDER
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
    /// Part of the shown picture's width and height that is drawn, in [`Self::SCALES`]. The Earth draws into whatever pass it is
    /// given: the host makes the pass smaller, by [`crate::ScaledTarget`] or as it does that for all that it draws.
    pub scale: f64,
}

impl Quality {
    /// What [`Self::scale`] may be.
    pub const SCALES: RangeInclusive<f64> = 0.25..=1.0;

    /// Width and height that are drawn of a picture that is shown at `size`, pixels.
    pub fn drawn_size(&self, size: (u32, u32)) -> (u32, u32) {
        Self::drawn_size_at(self.scale, size)
    }

    /// The same for a scale.
    pub fn drawn_size_at(scale: f64, (width, height): (u32, u32)) -> (u32, u32) {
        let scale = scale.clamp(*Self::SCALES.start(), *Self::SCALES.end());
        // A cast clamps, and what is not a number is 0.
        let drawn = |side: u32| ((f64::from(side) * scale).round() as u32).clamp(1, side.max(1));
        (drawn(width), drawn(height))
    }
}

/// What can be given up to draw faster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QualityReduction {
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
    Clouds,
    Air,
    /// Resolution: so many percent of width and height are drawn at most, 25 to 99.
    Scale(u8),
}

impl QualityReduction {
    /// All that can be given up, each by itself; of scales those that ladders are made of.
    pub const ALL: [Self; 13] = [
        Self::Anisotropy,
        Self::Detail,
        Self::Relief,
        Self::Samples,
        Self::Roundness,
        Self::Lights,
        Self::Clouds,
        Self::Air,
        Self::Scale(85),
        Self::Scale(70),
        Self::Scale(60),
        Self::Scale(50),
        Self::Scale(35),
    ];

    /// The word for it in ladders: `samples`, `scale_70`.
    pub fn key(self) -> String {
        match self {
            Self::Anisotropy => "anisotropy".into(),
            Self::Detail => "detail".into(),
            Self::Relief => "relief".into(),
            Self::Samples => "samples".into(),
            Self::Roundness => "roundness".into(),
            Self::Lights => "lights".into(),
            Self::Clouds => "clouds".into(),
            Self::Air => "air".into(),
            Self::Scale(percent) => format!("scale_{percent}"),
        }
    }

    /// What a word of a ladder means; `None` if it is none.
    pub fn of_key(key: &str) -> Option<Self> {
        if let Some(percent) = key.strip_prefix("scale_") {
            let percent = percent.parse().ok()?;
            return (25..=99).contains(&percent).then_some(Self::Scale(percent));
        }
        Self::ALL.into_iter().find(|one| one.key() == key)
    }

    /// The quality that is left of `from`.
    pub fn apply(self, from: Quality, has_tiles: bool) -> Quality {
        let coarsest = if has_tiles { TILED_SUBDIVISION } else { 6 };
        let without = |layer: MapLayer| {
            let mut maps = from.maps;
            maps[layer.index()] = false;
            Quality { maps, ..from }
        };
        match self {
            Self::Anisotropy => Quality {
                anisotropy: from.anisotropy.min(2),
                ..from
            },
            Self::Detail if !has_tiles => from,
            Self::Detail => Quality {
                texel_px: 2.0 * from.texel_px,
                ..from
            },
            Self::Relief => without(MapLayer::Normals),
            Self::Samples => Quality { samples: 1, ..from },
            Self::Roundness => Quality {
                subdivision: Subdivision::Cells(match from.subdivision {
                    Subdivision::Auto => coarsest,
                    Subdivision::Cells(cells) => cells.min(coarsest),
                }),
                ..from
            },
            // Not the water: under it the day map is no picture of the sea.
            Self::Lights => without(MapLayer::NightLights),
            Self::Clouds => without(MapLayer::Clouds),
            Self::Air => Quality {
                atmosphere: Atmosphere::None,
                ..from
            },
            Self::Scale(percent) => Quality {
                scale: from.scale.min(f64::from(percent) / 100.0),
                ..from
            },
        }
    }
}

impl fmt::Display for QualityReduction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = match self {
            Self::Anisotropy => "anisotropy",
            Self::Detail => "fine tiles",
            Self::Relief => "relief",
            Self::Samples => "smooth edges",
            Self::Roundness => "round limb",
            Self::Lights => "lights",
            Self::Clouds => "clouds",
            Self::Air => "air",
            Self::Scale(percent) => return write!(f, "full resolution ({percent} %)"),
        };
        f.write_str(words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_ladders_mean_what_they_are_written_for() {
        for one in QualityReduction::ALL {
            assert_eq!(QualityReduction::of_key(&one.key()), Some(one));
        }
        for wrong in ["", "Samples", "scale_", "scale_24", "scale_100", "scale_7x"] {
            assert_eq!(QualityReduction::of_key(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn drawn_sizes_are_whole_and_never_nothing() {
        let mut quality = Quality {
            subdivision: Subdivision::Auto,
            anisotropy: 8,
            samples: 4,
            texel_px: 1.0,
            maps: [true; MAP_LAYERS],
            atmosphere: Atmosphere::Billboard,
            scale: 1.0,
        };
        assert_eq!(quality.drawn_size((1280, 721)), (1280, 721));
        quality.scale = 0.5;
        assert_eq!(quality.drawn_size((1280, 721)), (640, 361));
        assert_eq!(quality.drawn_size((1, 1)), (1, 1));
        for wrong in [f64::NAN, -1.0, 0.0, 7.0] {
            quality.scale = wrong;
            let (width, height) = quality.drawn_size((100, 50));
            assert!((1..=100).contains(&width) && (1..=50).contains(&height));
        }
    }
}
