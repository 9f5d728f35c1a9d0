//! Elevation data, the source of surfaces with relief.
//!
//! Heights are metres above mean sea level. Heights of files above the ellipsoid are reduced to mean sea level ([`geoid`]). The renderer places
//! terrain at these heights above the ellipsoid. The geoid is within 107 m of WGS84, and no surface here distinguishes the two.
//!
//! Scenes use [`Ground`]: any number of [`HeightGrid`]s over a sea at height 0. Grids are built from heights in memory or read from files (GeoTIFF,
//! PNG with a sidecar, NetCDF). Tiles of a [`HeightTileSource`] may replace the sea; they may exceed the memory: [`StreamedGround`].

pub mod aux_xml;
mod basins;
mod change;
mod denoise;
mod floor;
mod fractal;
pub mod geo_tags;
pub mod geoid;
mod grid;
mod ground;
mod land;
mod placed;
pub mod projection;
pub mod read;
mod samples;
// `terrella-pack` builds packs from it.
pub mod spool;
mod stream;
pub mod tiff_chunks;
pub mod tiff_gaps;
mod tiles;
mod vertical_codes;
pub mod vrt;
pub mod warp;
pub mod wkt;
pub mod world_file;

pub use change::{COARSEST_STEP_RAD, HeightChange};
pub use denoise::{Denoise, Denoised};
pub use fractal::fractal_heights_m;
pub use grid::{
    FEATHER_SAMPLES, Georeference, GridError, GridLimits, GridStats, HIGHEST_M, HeightGrid,
    LOWEST_M, MAX_SIDE, Registration,
};
pub use grid::{joins::Joins, placement::Placement};
pub use ground::Ground;
pub use land::LandShares;
pub use placed::PlacedBounds;
pub use read::{
    HeightFile, HeightFileError, check_heights, height_files, height_set, open_heights,
    open_heights_above, open_heights_denoised,
};
pub use samples::HeightSamples;
#[cfg(test)]
pub(crate) use stream::test_source::TestTiles;
pub use stream::{
    HeightEye, HeightStreamOptions, HeightViewer, StreamedGround, StreamedGroundError,
    TILES_PER_FRAME,
};
pub use tiles::{
    HeightLayoutError, HeightTileError, HeightTileKey, HeightTileLayout, HeightTileSource,
};

pub use crate::height::{HeightRange, HeightTileStats};
use glam::DVec2;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use terrella_frames::Ellipsoid;

/// A rectangle of geodetic latitude and longitude, radians. It may cross the date line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Latitude of the southern edge, −π/2…π/2.
    pub south_rad: f64,
    /// Latitude of the northern edge, not below [`Self::south_rad`].
    pub north_rad: f64,
    /// Longitude of the western edge; any multiple of 360° may be added.
    pub west_rad: f64,
    /// Width to the eastern edge, 0…2π.
    pub width_rad: f64,
}

impl Bounds {
    /// The whole Earth.
    pub const GLOBE: Self = Self {
        south_rad: -0.5 * PI,
        north_rad: 0.5 * PI,
        west_rad: -PI,
        width_rad: TAU,
    };

    /// The smallest bounds of a circle: all places within an angle at the Earth's centre of a
    /// place.
    pub fn around(lat_rad: f64, lon_rad: f64, angle_rad: f64) -> Self {
        let (south_rad, north_rad) = (lat_rad - angle_rad, lat_rad + angle_rad);
        // A circle around the place touches meridians at sin Δλ = sin r / cos φ, if it contains no
        // pole.
        let has_pole = north_rad >= FRAC_PI_2 || south_rad <= -FRAC_PI_2;
        let aside_rad = match has_pole {
            true => PI,
            false => (angle_rad.sin() / lat_rad.cos()).min(1.0).asin(),
        };
        Self {
            south_rad: south_rad.max(-FRAC_PI_2),
            north_rad: north_rad.min(FRAC_PI_2),
            west_rad: lon_rad - aside_rad,
            width_rad: 2.0 * aside_rad,
        }
    }

    /// Whether the two share a place, even if only on their edges.
    pub fn overlaps(&self, other: &Self) -> bool {
        let from_west = (other.west_rad - self.west_rad).rem_euclid(TAU);
        let from_other = (self.west_rad - other.west_rad).rem_euclid(TAU);
        let along = from_west <= self.width_rad || from_other <= other.width_rad;
        // All meridians meet at a pole.
        let pole = |bounds: &Self| {
            let near = FRAC_PI_2 - 1e-9;
            (bounds.north_rad >= near, bounds.south_rad <= -near)
        };
        let (a, b) = (pole(self), pole(other));
        let at_pole = a.0 && b.0 || a.1 && b.1;
        self.south_rad <= other.north_rad && other.south_rad <= self.north_rad && (along || at_pole)
    }

    /// Whether a place is inside or on the edge.
    pub fn contains(&self, lat_rad: f64, lon_rad: f64) -> bool {
        (self.south_rad..=self.north_rad).contains(&lat_rad)
            && (lon_rad - self.west_rad).rem_euclid(TAU) <= self.width_rad
    }
}

/// A source of elevation data. Every height is finite; each source documents its substitute where data are missing.
pub trait Elevation: Send + Sync {
    /// Height at a geodetic place, metres, averaged over about `spacing_rad` of ground to each side. The spacing is an angle
    /// at the Earth's centre; 0 requests the finest data. Continuous in the place. Longitudes may exceed ±180°, and a
    /// latitude beyond a pole counts as the pole's.
    fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64;

    /// Lowest and highest height that [`Self::height_m`] returns inside the bounds, at any spacing. May be too wide, never
    /// too narrow. If a source refines its heights ([`Self::streamed`]), this holds now and later.
    fn range_m(&self, bounds: &Bounds) -> HeightRange;

    /// As [`Self::range_m`], for spacings up to `coarsest_rad` only. For a small spacing the range is much narrower, because
    /// [`Self::range_m`] also includes the mean of the whole Earth. If a source refines its heights, this covers only those that
    /// it has now.
    fn range_up_to_m(&self, bounds: &Bounds, coarsest_rad: f64) -> HeightRange {
        let _ = coarsest_rad;
        self.range_m(bounds)
    }

    /// The stream of a source whose heights become finer while they are drawn. `None` for all others.
    fn streamed(&self) -> Option<&StreamedGround> {
        None
    }

    /// Angle between neighbouring samples of the finest data at a place, radians. Infinite where heights do not vary, at any
    /// distance.
    fn finest_spacing_rad(&self, lat_rad: f64, lon_rad: f64) -> f64;

    /// Angle between neighbouring samples of the finest data anywhere inside the bounds, radians. Infinite where heights do not vary. May be too
    /// small, never too large.
    ///
    /// The default implementation samples 25 places. A source with data that differ from place to place must override it.
    fn finest_spacing_in(&self, bounds: &Bounds) -> f64 {
        let part = |k: u32| f64::from(k) / 4.0;
        let places = (0..25).map(|k| (part(k / 5), part(k % 5)));
        let spacings = places.map(|(up, along)| {
            let lat_rad = bounds.south_rad + up * (bounds.north_rad - bounds.south_rad);
            self.finest_spacing_rad(lat_rad, bounds.west_rad + along * bounds.width_rad)
        });
        spacings.fold(f64::INFINITY, f64::min)
    }

    /// Slope of the ground to the east and to the north, metres per metre, between places `spacing_rad` to each side.
    /// [`Self::finest_spacing_rad`] applies if it is larger. Zero where heights do not vary. At a pole, north points away
    /// from it along the meridian opposite to the longitude.
    fn slope(&self, ellipsoid: &Ellipsoid, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> DVec2 {
        let step_rad = spacing_rad.max(self.finest_spacing_rad(lat_rad, lon_rad));
        if !step_rad.is_finite() {
            return DVec2::ZERO;
        }
        // At least a decimetre of ground, so that the difference of two heights keeps its last digits.
        let step_rad = step_rad.clamp(2e-8, 0.25 * PI);
        let lat_rad = lat_rad.clamp(-FRAC_PI_2, FRAC_PI_2);
        let (sin, cos) = step_rad.sin_cos();
        let (sin_lat, cos_lat) = lat_rad.sin_cos();
        // Distance of a geodetic latitude from the axis and from the equatorial plane.
        let (a, b) = (ellipsoid.equatorial_radius_m, ellipsoid.polar_radius_m);
        let meridian = |sin_lat: f64, cos_lat: f64| {
            let scaled = DVec2::new(a * cos_lat, b * sin_lat);
            DVec2::new(a, b) * scaled / scaled.length()
        };
        // Along the great circle that leaves to the east. Unlike the parallel, it is well defined at the poles. Its
        // points have longitudes ±λ from here, at a latitude φ with cos φ sin λ = sin s.
        let turn_rad = sin.atan2(cos_lat * cos);
        let (sin_beside, cos_beside) = (sin_lat * cos, (cos_lat * cos).hypot(sin));
        let beside_rad = sin_beside.atan2(cos_beside);
        let east_m = 2.0 * meridian(sin_beside, cos_beside).x * (sin / cos_beside);
        let beside_m = |lon_rad| self.height_m(beside_rad, lon_rad, spacing_rad);
        let east_rise_m = beside_m(lon_rad + turn_rad) - beside_m(lon_rad - turn_rad);
        // Along the meridian, across a pole if one is that near.
        let north_m =
            meridian(sin_lat * cos + cos_lat * sin, cos_lat * cos - sin_lat * sin).distance(
                meridian(sin_lat * cos - cos_lat * sin, cos_lat * cos + sin_lat * sin),
            );
        let along_m = |lat: f64| {
            if lat.abs() > FRAC_PI_2 {
                self.height_m(PI.copysign(lat) - lat, lon_rad + PI, spacing_rad)
            } else {
                self.height_m(lat, lon_rad, spacing_rad)
            }
        };
        let north_rise_m = along_m(lat_rad + step_rad) - along_m(lat_rad - step_rad);
        DVec2::new(east_rise_m / east_m, north_rise_m / north_m)
    }
}

#[cfg(test)]
mod joins_tests;
#[cfg(test)]
mod tests;
