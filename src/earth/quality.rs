//! Quality settings of an Earth, and their reductions.

use std::fmt;
use std::ops::RangeInclusive;
use terrella_ground::air::Atmosphere;
use terrella_ground::globe::Subdivision;
use terrella_imagery::tile::{MAP_LAYERS, MapLayer};

/// Cells per block edge for an Earth with tiles.
///
/// A pixel shows the place where its ray meets the exact ellipsoid, but its block is that of the facet drawn there. Near an edge the ray may meet
/// ground of the next block; a tile has [`TILE_BORDER`] texels of border for this. Facets lie up to R(1 − cos(11.25°/n)) below the ellipsoid: 3.4
/// km for n = 6 and 0.21 km for n = 24. The latter is little more than a texel of 1.9 km, the paper's finest, even at 6° above the ground.
///
/// [`TILE_BORDER`]: terrella_imagery::tile::TILE_BORDER
pub const TILED_SUBDIVISION: u32 = 24;

/// Quality settings of an Earth: what [`super::Earth::set_quality`] changes while maps and tiles stay in place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Cells per block edge.
    pub subdivision: Subdivision,
    /// Largest number of samples for filtering a map at a grazing view, as in [`super::EarthOptions::anisotropy`].
    pub anisotropy: u16,
    /// Sample count of the pass. The host's pass must have as many.
    pub samples: u32,
    /// Most screen pixels that a texel of a tile may cover, as in [`super::TileOptions::max_texel_px`]; no effect without tiles.
    pub texel_px: f64,
    /// Which maps are drawn, by [`MapLayer::index`]. A map that the Earth was made without is never drawn; the day map always is.
    pub maps: [bool; MAP_LAYERS],
    /// How the air is drawn.
    pub atmosphere: Atmosphere,
    /// Fraction of the displayed image's width and height that is rendered, in [`Self::SCALES`]. The Earth draws into whatever pass it is given:
    /// the host makes the pass smaller, with [`crate::ScaledTarget`] or with its own scaling.
    pub scale: f64,
}

impl Quality {
    /// Range of [`Self::scale`].
    pub const SCALES: RangeInclusive<f64> = 0.25..=1.0;

    /// Rendered width and height of an image that is displayed at `size`, pixels.
    pub fn drawn_size(&self, size: (u32, u32)) -> (u32, u32) {
        Self::drawn_size_at(self.scale, size)
    }

    /// As [`Self::drawn_size`], for a given scale.
    pub fn drawn_size_at(scale: f64, (width, height): (u32, u32)) -> (u32, u32) {
        let scale = scale.clamp(*Self::SCALES.start(), *Self::SCALES.end());
        // The cast clamps, and turns NaN into 0.
        let drawn = |side: u32| ((f64::from(side) * scale).round() as u32).clamp(1, side.max(1));
        (drawn(width), drawn(height))
    }
}

/// A reduction of quality that makes drawing faster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QualityReduction {
    /// Filters maps with two samples at grazing views.
    Anisotropy,
    /// Lets texels of tiles cover twice as many pixels.
    Detail,
    /// Drops the normal map, the shading of relief.
    Relief,
    /// Drops multisampling: one sample a pixel.
    Samples,
    /// Coarsens the limb to six cells a block edge, as in the paper; with tiles to as many as they need.
    Roundness,
    /// Drops city lights.
    Lights,
    Clouds,
    Air,
    /// Reduces resolution: at most this percentage of width and height is rendered, 25 to 99.
    Scale(u8),
}

impl QualityReduction {
    /// All reductions, and of the scales those used in ladders.
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

    /// Its name in ladders: `samples`, `scale_70`.
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

    /// The reduction with this name; `None` for an unknown name.
    pub fn of_key(key: &str) -> Option<Self> {
        if let Some(percent) = key.strip_prefix("scale_") {
            let percent = percent.parse().ok()?;
            return (25..=99).contains(&percent).then_some(Self::Scale(percent));
        }
        Self::ALL.into_iter().find(|one| one.key() == key)
    }

    /// The quality after this reduction.
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
            // The water map stays: beneath it the day map does not show the sea.
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
