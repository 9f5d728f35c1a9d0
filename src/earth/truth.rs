//! Ground truth of a pixel, in f64. The GPU writes the surface properties and elevation of the visible ground. The position follows from the
//! pixel's own ray, so that GPU rounding does not shift it.

use super::view::PixelRays;
use super::{EyeView, Sky, Viewport};
use crate::gpu::TruthTexel;
use glam::DVec3;
use std::f64::consts::PI;
use terrella_frames::{Ellipsoid, Geodetic, MoonShadow, SUN_RADIUS_M};
use terrella_ground::globe::Figure;

/// The rays of a view's pixels, with the Sun and the Moon's shadow.
///
/// Pixels are counted from the target's upper left corner; a pixel's ray goes through its middle.
#[derive(Clone, Copy, Debug)]
pub struct TruthView {
    eye_itrf_m: DVec3,
    rays: PixelRays,
    figure: Ellipsoid,
    /// Unit vector to the Sun, and the angular radius of its disc.
    sun_itrf: DVec3,
    sun_radius_rad: f64,
    shadow: Option<MoonShadow>,
}

/// Ground truth of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthPoint {
    /// The position: geodetic, with the elevation of the drawn terrain.
    pub place: Geodetic,
    /// The position, ITRF metres.
    pub place_itrf_m: DVec3,
    /// Distance from the eye, metres.
    pub range_m: f64,
    /// Elevation angle of the Sun's centre above the plane normal to the ellipsoid's normal, radians: geometric, without refraction, as seen from
    /// the Earth's centre.
    pub sun_elevation_rad: f64,
    /// Fraction of the Sun's disc above that plane, 0…1.
    pub sunlit: f64,
    /// Fraction of the Sun's disc that the Moon hides there, 0…1, by day or night; 0 for a sky without a Moon.
    pub moon_shadow: f64,
    /// Normal of the drawn terrain, ITRF axes, length 1.
    pub normal_itrf: DVec3,
    /// Land fraction of the pixel, 0…1.
    pub land: f64,
    /// Cover of the clouds drawn in front of the pixel, 0…1.
    pub cloud_cover: f64,
}

impl TruthView {
    /// The view as it is drawn to a target. `figure` is that of the Earth's options. `None` if the view has no image.
    pub fn new(
        view: &EyeView,
        sky: &Sky,
        figure: Figure,
        target: impl Into<Viewport>,
    ) -> Option<Self> {
        let (view, sky) = view.in_itrf(target.into()).ok().zip(sky.with_unit_sun())?;
        Some(Self {
            eye_itrf_m: view.eye_itrf_m,
            rays: view.rays,
            figure: figure.ellipsoid(),
            sun_itrf: sky.sun_itrf,
            sun_radius_rad: (SUN_RADIUS_M / sky.sun_distance_m).clamp(0.0, 1.0).asin(),
            shadow: sky.moon_shadow(),
        })
    }

    pub fn eye_itrf_m(&self) -> DVec3 {
        self.eye_itrf_m
    }

    /// Rays to the plane one metre in front of the eye, ITRF metres: the ray through the upper left corner of pixel (0, 0), and its increments to
    /// the next pixel right and down.
    pub fn corner_right_down(&self) -> [DVec3; 3] {
        [self.rays.corner, self.rays.right, self.rays.down]
    }

    /// Unit vector from the eye through the centre of a pixel, ITRF axes.
    pub fn ray(&self, x: u32, y: u32) -> DVec3 {
        self.ray_through(f64::from(x) + 0.5, f64::from(y) + 0.5)
    }

    /// Unit vector from the eye through a point of the target, pixels from its upper left corner, ITRF axes.
    pub fn ray_through(&self, x: f64, y: f64) -> DVec3 {
        (self.rays.corner + x * self.rays.right + y * self.rays.down).normalize()
    }

    /// Angle from the limb of the ellipsoid to a pixel's ray, radians, in the plane of the ray and the Earth's centre: negative on the disc,
    /// positive beside it. `None` for an eye that is not outside the ellipsoid.
    pub fn limb_distance_rad(&self, x: u32, y: u32) -> Option<f64> {
        self.limb_distance_along(self.ray(x, y))
    }

    /// As [`Self::limb_distance_rad`], for a ray through any point of the target: a unit vector, ITRF axes.
    pub fn limb_distance_along(&self, ray: DVec3) -> Option<f64> {
        let scale = self.figure.scaled_from_itrf() * self.figure.equatorial_radius_m;
        let eye = self.eye_itrf_m * scale / self.figure.equatorial_radius_m;
        let above = (eye.length() - 1.0) * (eye.length() + 1.0);
        if above <= 0.0 {
            return None;
        }
        let axis = -self.eye_itrf_m.normalize();
        let across = ray.reject_from_normalized(axis);
        let from_axis = across.length().atan2(axis.dot(ray));
        let across = across
            .try_normalize()
            .unwrap_or_else(|| axis.any_orthonormal_vector());
        // Rays d that meet the ellipsoid are those of |d|² − |e × d|² ≥ 0 in scaled space, by Lagrange's identity
        //   (e·d)² − (|e|² − 1)|d|² ≥ 0;
        // with d = cos θ axis + sin θ across: constant + 2 half tan θ + square tan² θ = 0. The axis goes through the centre,
        // e × axis = 0, so that the constant is its length squared.
        let (a, c) = (axis * scale, across * scale);
        let constant = a.length_squared();
        let half = a.dot(c);
        let square = eye.dot(c).powi(2) - above * c.length_squared();
        let root = (half * half - constant * square).max(0.0).sqrt();
        // Of the two forms of the least positive angle, the one without cancellation.
        let limb = match half > 0.0 {
            true => (half + root).atan2(-square),
            false => constant.atan2(root - half),
        };
        Some(from_axis - limb)
    }

    /// Ground truth of a pixel from the texel that was read back; `None` if the pixel shows no ground or the eye is below the ground.
    pub fn point(&self, x: u32, y: u32, texel: &TruthTexel) -> Option<TruthPoint> {
        self.point_along(self.ray(x, y), texel)
    }

    /// As [`Self::point`], for a ray through any point of the target, a unit vector in ITRF axes. Land, clouds, slopes and elevation come from the
    /// texel, the position from the ray.
    pub fn point_along(&self, ray: DVec3, texel: &TruthTexel) -> Option<TruthPoint> {
        if !texel.is_ground() {
            return None;
        }
        let [_, _, drawn_range_m, height_m] = texel.place.map(f64::from);
        let (range_m, place) = match height_m == 0.0 {
            true => self.on_ellipsoid(ray)?,
            false => self.on_relief(ray, height_m, drawn_range_m)?,
        };
        let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let place_itrf_m = self.eye_itrf_m + range_m * ray;
        let sun = self.sun_itrf;
        let sun_elevation_rad = up.dot(sun).atan2(up.cross(sun).length());
        let [slope_east, slope_north, land, cloud_cover] = texel.ground.map(f64::from);
        let (sin_lon, cos_lon) = place.lon_rad.sin_cos();
        let east = DVec3::new(-sin_lon, cos_lon, 0.0);
        let north = up.cross(east);
        Some(TruthPoint {
            place,
            place_itrf_m,
            range_m,
            sun_elevation_rad,
            sunlit: disc_above(sun_elevation_rad / self.sun_radius_rad),
            moon_shadow: match &self.shadow {
                Some(shadow) => 1.0 - shadow.sun_left(place_itrf_m),
                None => 0.0,
            },
            normal_itrf: (up - slope_east * east - slope_north * north).normalize(),
            land,
            cloud_cover,
        })
    }

    /// Where a ray meets the ellipsoid: the distance and the place. A ray that just misses it although the mesh covers its pixel is treated as
    /// touching it.
    fn on_ellipsoid(&self, ray: DVec3) -> Option<(f64, Geodetic)> {
        let [range_m, _] = crossings(&self.figure, self.eye_itrf_m, ray);
        if range_m.is_nan() || range_m < 0.0 {
            return None;
        }
        let scale = self.figure.scaled_from_itrf();
        let up = (self.eye_itrf_m + range_m * ray) * scale * scale;
        let place = Geodetic {
            lat_rad: up.z.atan2(up.x.hypot(up.y)),
            lon_rad: up.y.atan2(up.x),
            height_m: 0.0,
        };
        Some((range_m, place))
    }

    /// Where a ray meets the surface of constant elevation `height_m`. If there are two points, the one nearer to the drawn terrain.
    fn on_relief(&self, ray: DVec3, height_m: f64, drawn_range_m: f64) -> Option<(f64, Geodetic)> {
        // The ellipsoid whose axes are longer by the elevation differs from that surface by centimetres.
        let lifted = Ellipsoid {
            equatorial_radius_m: self.figure.equatorial_radius_m + height_m,
            polar_radius_m: self.figure.polar_radius_m + height_m,
        };
        let met = crossings(&lifted, self.eye_itrf_m, ray);
        let ahead = met.into_iter().filter(|range_m| *range_m >= 0.0);
        let apart = |range_m: &f64| (range_m - drawn_range_m).abs();
        let mut range_m = ahead.min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
        let place = |range_m: f64| {
            let point = self.eye_itrf_m + range_m * ray;
            self.figure.geodetic_from_itrf(point)
        };
        for _ in 0..NEWTON_STEPS {
            let at = place(range_m);
            let climbs = Ellipsoid::normal(at.lat_rad, at.lon_rad).dot(ray);
            if climbs.abs() < LEAST_CLIMB {
                break;
            }
            range_m -= (at.height_m - height_m) / climbs;
        }
        Some((range_m, place(range_m)))
    }
}

/// Each step reduces an error of centimetres by a factor of about a thousand.
const NEWTON_STEPS: usize = 2;
/// Sine of the angle between ray and ground below which the intersection with an elevation is ill-conditioned.
const LEAST_CLIMB: f64 = 1e-3;

/// Distances along a ray of length 1 at which its line enters and leaves an ellipsoid, metres; negative behind the eye. If the line misses, twice
/// the distance of closest approach in scaled space.
fn crossings(figure: &Ellipsoid, eye_m: DVec3, ray: DVec3) -> [f64; 2] {
    let scale = figure.scaled_from_itrf();
    let (eye, direction) = (eye_m * scale, ray * scale);
    let metres = 1.0 / direction.length();
    let direction = direction * metres;
    // |e + t d| = 1: t² − 2 along t + above = 0, with the discriminant 1 − |e × d|² by Lagrange's identity.
    let above = (eye.length() - 1.0) * (eye.length() + 1.0);
    let along = -eye.dot(direction);
    let beside = eye.cross(direction).length();
    if beside >= 1.0 {
        return [along * metres; 2];
    }
    let half = ((1.0 - beside) * (1.0 + beside)).sqrt();
    // The root that would suffer cancellation comes from the product of the roots.
    match along >= 0.0 {
        true => [above / (along + half), along + half],
        false => [along - half, above / (along - half)],
    }
    .map(|t| t * metres)
}

/// Fraction of a disc above a straight horizon that is `height` of its radii below its centre.
fn disc_above(height: f64) -> f64 {
    let x = height.clamp(-1.0, 1.0);
    1.0 - (x.acos() - x * (1.0 - x * x).sqrt()) / PI
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(eye_itrf_m: DVec3, forward: DVec3) -> TruthView {
        let view = EyeView::itrf(eye_itrf_m, forward, DVec3::Z, 1.0, 1.0);
        let sky = Sky::new(DVec3::X);
        TruthView::new(&view, &sky, Figure::Sphere, (3, 3)).expect("a view")
    }

    #[test]
    fn the_limb_of_a_sphere_is_where_its_radius_is_seen() {
        let radius_m = Figure::Sphere.ellipsoid().equatorial_radius_m;
        for height_m in [1.0, 4e5, 3.6e7, 1e10] {
            let distance_m = radius_m + height_m;
            let view = view(DVec3::X * distance_m, DVec3::NEG_X);
            let found = view.limb_distance_rad(1, 1).expect("an eye outside");
            // cos of the dip is r/(r + h); by tangents, which do not cancel.
            let dip = (height_m * (radius_m + distance_m)).sqrt().atan2(radius_m);
            let limb = radius_m.atan2((height_m * (radius_m + distance_m)).sqrt());
            assert!((limb + dip - PI / 2.0).abs() < 1e-12);
            assert!((found + limb).abs() < 1e-12, "{height_m}: {found} {limb}");
        }
        let away = view(DVec3::X * 2.0 * radius_m, DVec3::X);
        let found = away.limb_distance_rad(1, 1).expect("an eye outside");
        assert!((found - (PI - PI / 6.0)).abs() < 1e-12, "{found}");
        let inside = view(DVec3::X * 0.9 * radius_m, DVec3::X);
        assert_eq!(inside.limb_distance_rad(1, 1), None);
    }

    /// A ray turned by its distance from the limb touches the ellipsoid.
    #[test]
    fn the_limb_of_the_ellipsoid_is_touched() {
        let figure = Ellipsoid::WGS84;
        for (lat_deg, height_m) in [(50.0, 10.0), (-33.0, 4e5), (89.9, 2e7), (0.0, 1e9)] {
            let place = Geodetic::from_degrees(lat_deg, 70.0, height_m);
            let eye = figure.itrf_from_geodetic(place);
            let east = DVec3::new(-place.lon_rad.sin(), place.lon_rad.cos(), 0.0);
            for direction in [east, DVec3::Z, east - DVec3::Z, -eye] {
                let look = EyeView::itrf(eye, direction - eye / eye.length(), DVec3::Z, 1.0, 1.0);
                let sky = Sky::new(DVec3::X);
                let view = TruthView::new(&look, &sky, Figure::Wgs84, (5, 5)).expect("a view");
                let ray = view.ray(1, 3);
                let distance = view.limb_distance_rad(1, 3).expect("outside");
                let axis = -eye.normalize();
                let across = ray.reject_from_normalized(axis).normalize();
                let angle = across.dot(ray).atan2(axis.dot(ray)) - distance;
                let limb = angle.cos() * axis + angle.sin() * across;
                let scale = figure.scaled_from_itrf();
                let nearest = (eye * scale).cross((limb * scale).normalize()).length();
                assert!((nearest - 1.0).abs() < 1e-9, "{lat_deg}: {nearest}");
            }
        }
    }

    #[test]
    fn half_a_disc_is_above_its_middle() {
        assert_eq!((disc_above(1.5), disc_above(-2.0)), (1.0, 0.0));
        assert!((disc_above(0.0) - 0.5).abs() < 1e-15);
        assert!((disc_above(0.3) + disc_above(-0.3) - 1.0).abs() < 1e-15);
    }
}
