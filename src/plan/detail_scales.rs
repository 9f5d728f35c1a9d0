//! Scales of synthetic detail that a frame can show.

use std::f64::consts::PI;
use terrella_imagery::DETAIL_TILE_SIDE;

/// Tiles of the fine scale along an edge of the cube around the Earth: even, so that an edge ends with a tile. Their texels are 49 m.
pub const FINE_DETAIL_TILES: f64 = 198.0;
/// Mip level of the tile from which on nothing of it is left: 2^6.3 of its texels. A test measures it.
pub const EMPTY_DETAIL_LEVEL: f64 = 6.3;

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
        match least_pixel {
            _ if least_pixel >= largest_texel => Self::None,
            _ if least_pixel >= fine_texel * EMPTY_DETAIL_LEVEL.exp2() => Self::Coarse,
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
            (3.8, DetailScales::Both),
            (3.95, DetailScales::Coarse),
            (9.7, DetailScales::Coarse),
            (9.9, DetailScales::None),
            (f64::NAN, DetailScales::Both),
        ] {
            let found = DetailScales::of_pixels(km(pixel_km), starter_maps);
            assert_eq!(found, shown, "{pixel_km} km");
        }
    }
}
