//! Scales of synthetic detail that a frame can show.

use std::f64::consts::PI;
use terrella_imagery::DETAIL_TILE_SIDE;

/// Tiles of the fine scale along an edge of the cube around the Earth: even, so that an edge ends with a tile. Their texels are 49 m.
pub const FINE_DETAIL_TILES: f64 = 198.0;
/// Mip level of the tile from which on nothing of it is left: 2^6.3 of its texels. A test measures it.
pub const EMPTY_DETAIL_LEVEL: f64 = 6.3;
/// A mip level is blended with the next one over this fraction of the distance between them: most pixels read one level only.
pub const BLENDED_DETAIL_LEVELS: f64 = 0.25;

/// The scales of the structures of clouds and land that pixels are small enough to show. GPUs skip the others by themselves; a software adapter
/// computes both sides of each branch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum DetailScales {
    /// The coarse and the fine one.
    #[default]
    Both,
    /// The coarse one.
    Coarse,
    /// None.
    None,
}

impl DetailScales {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Both, Self::Coarse, Self::None];

    /// Those of pixels of at least this size on the ground, over maps with texels of at most this size; equatorial radii.
    pub fn of_pixels(least_pixel: f64, largest_texel: f64) -> Self {
        // Half an edge of the cube is a quarter of π long.
        let fine_texel = 0.5 * PI / (FINE_DETAIL_TILES * f64::from(DETAIL_TILE_SIDE));
        // Pixels of this level read the empty one.
        let blend = BLENDED_DETAIL_LEVELS * (EMPTY_DETAIL_LEVEL.fract() - 0.5);
        let empty = EMPTY_DETAIL_LEVEL.floor() + 0.5 + blend;
        match least_pixel {
            _ if least_pixel >= largest_texel => Self::None,
            _ if least_pixel >= fine_texel * empty.exp2() => Self::Coarse,
            _ => Self::Both,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_as_large_as_texels_show_none() {
        let km = |km: f64| km / 6378.137;
        let starter_maps = km(9.78);
        for (pixel_km, shown) in [
            (0.7, DetailScales::Both),
            (4.25, DetailScales::Both),
            (4.4, DetailScales::Coarse),
            (9.7, DetailScales::Coarse),
            (9.9, DetailScales::None),
            (f64::NAN, DetailScales::Both),
        ] {
            let found = DetailScales::of_pixels(km(pixel_km), starter_maps);
            assert_eq!(found, shown, "{pixel_km} km");
        }
    }
}
