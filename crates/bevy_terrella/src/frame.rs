//! Position of the Earth in the app's world, in f64.

use bevy::ecs::component::Component;
use bevy::ecs::reflect::ReflectComponent;
use bevy::math::{DAffine3, DMat3, DVec3};
use bevy::reflect::Reflect;
use terrella::frames::{Ellipsoid, Epoch, Geodetic, itrf_from_gcrf};

/// Position of the world's origin and axes on the Earth.
///
/// Bevy's transforms are f32. At 10 km from the origin they are accurate to a millimetre. At a satellite's distance from the Earth's centre, they are
/// accurate to half a metre. Keep the origin near the cameras, and store its position here in f64. It may move in any frame (a floating origin). The
/// image depends on where things are, not on where the origin is.
///
/// With `big_space` the origin is a cell of the grid. Use [`Self::shifted`] on the frame of cell 0, with the cell's indices times its edge.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Clone, Debug, PartialEq)]
pub struct EarthFrame {
    /// Transforms points of the world, in its unit, to ITRF metres: a rotation, a uniform scale and a
    /// translation.
    pub itrf_from_world: DAffine3,
}

impl Default for EarthFrame {
    /// ITRF itself: metres from the Earth's centre.
    fn default() -> Self {
        Self::itrf(DVec3::ZERO)
    }
}

impl EarthFrame {
    /// Metres from a place; x east, y up, z south.
    pub fn local(place: Geodetic) -> Self {
        let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let east = DVec3::new(-place.lon_rad.sin(), place.lon_rad.cos(), 0.0);
        let axes = DMat3::from_cols(east, up, east.cross(up));
        Self::of(axes, Ellipsoid::WGS84.itrf_from_geodetic(place))
    }

    /// Metres from a point in ITRF metres, axes of ITRF: x to 0° E on the equator, z to the north pole.
    pub fn itrf(origin_itrf_m: DVec3) -> Self {
        Self::of(DMat3::IDENTITY, origin_itrf_m)
    }

    /// Metres from a point in GCRF metres, axes of GCRF, with the Earth's rotation at `epoch`. Update it when the epoch changes.
    pub fn gcrf(origin_gcrf_m: DVec3, epoch: Epoch) -> Self {
        let itrf_from_gcrf = itrf_from_gcrf(epoch);
        Self::of(itrf_from_gcrf, itrf_from_gcrf * origin_gcrf_m)
    }

    /// The same origin and axes in a world with a unit of `unit_m` metres.
    #[must_use]
    pub fn in_unit(self, unit_m: f64) -> Self {
        let DAffine3 {
            matrix3,
            translation,
        } = self.itrf_from_world;
        Self::of(matrix3 * unit_m, translation)
    }

    /// The same axes and unit, with the origin at a point given in this world. That point becomes zero. Subtract `origin_world` from
    /// the position of everything in the world.
    #[must_use]
    pub fn shifted(self, origin_world: DVec3) -> Self {
        let origin_itrf_m = self.itrf_from_world.transform_point3(origin_world);
        Self::of(self.itrf_from_world.matrix3, origin_itrf_m)
    }

    /// Converts a point in ITRF metres to the world, in its unit. Not finite if the frame has no inverse.
    pub fn world_from_itrf(&self, point_itrf_m: DVec3) -> DVec3 {
        let DAffine3 {
            matrix3,
            translation,
        } = self.itrf_from_world;
        // Subtract first: the difference is small for a point near the origin.
        matrix3.inverse() * (point_itrf_m - translation)
    }

    /// Converts a direction in ITRF axes to the world, with length 1. Zero if the frame has no
    /// inverse.
    pub fn world_direction(&self, direction_itrf: DVec3) -> DVec3 {
        (self.itrf_from_world.matrix3.inverse() * direction_itrf).normalize_or_zero()
    }

    fn of(itrf_from_axes: DMat3, origin_itrf_m: DVec3) -> Self {
        Self {
            itrf_from_world: DAffine3::from_mat3_translation(itrf_from_axes, origin_itrf_m),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_of_a_place_are_east_up_and_south() {
        let frame = EarthFrame::local(Geodetic::from_degrees(0.0, 90.0, 100.0));
        let at = |point| frame.itrf_from_world.transform_point3(point);
        let radius_m = Ellipsoid::WGS84.equatorial_radius_m;
        let near = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-8, "{a} {b}");
        near(at(DVec3::ZERO), DVec3::new(0.0, radius_m + 100.0, 0.0));
        near(at(DVec3::X), DVec3::new(-1.0, radius_m + 100.0, 0.0));
        near(at(DVec3::Y), DVec3::new(0.0, radius_m + 101.0, 0.0));
        near(at(DVec3::Z), DVec3::new(0.0, radius_m + 100.0, -1.0));
    }

    #[test]
    fn a_shifted_origin_leaves_things_where_they_are() {
        let frame = EarthFrame::local(Geodetic::from_degrees(28.0, 30.0, 420e3)).in_unit(1000.0);
        let (there, origin) = (DVec3::new(70.0, -3.0, 12.0), DVec3::new(71.5, -2.0, 9.0));
        let shifted = frame.shifted(origin);
        let before = frame.itrf_from_world.transform_point3(there);
        let after = shifted.itrf_from_world.transform_point3(there - origin);
        assert!((before - after).length() < 1e-8);
        assert!((shifted.world_from_itrf(before) - (there - origin)).length() < 1e-11);
    }

    #[test]
    fn inertial_axes_turn_with_the_earth() {
        let noon: Epoch = "2018-06-21T12:00:00Z".parse().expect("a date");
        let point = DVec3::new(7e6, 1e6, -2e6);
        let frame = EarthFrame::gcrf(point, noon);
        let expected = itrf_from_gcrf(noon) * (point + DVec3::X * 10.0);
        let found = frame.itrf_from_world.transform_point3(DVec3::X * 10.0);
        assert!((found - expected).length() < 1e-8);
    }
}
