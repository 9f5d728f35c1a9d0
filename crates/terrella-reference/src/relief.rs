//! Intersection of rays with terrain: marching along elevation data in f64, independent of the surface that draws it.

use super::Rays;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use terrella::EyeView;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::internals::earth::PixelLattice;
use terrella_ground::elevation::{Bounds, Elevation};

/// A picture of how far away the ground is, one ray through the middle of each pixel.
#[derive(Clone, Debug)]
pub struct TrueRelief {
    size: (u32, u32),
    /// Row by row, metres; `None` is space.
    distances_m: Vec<Option<f64>>,
}

impl TrueRelief {
    /// Casts all rays of a view. `None` for a view without pixels.
    pub fn new(
        view: &EyeView,
        size: (u32, u32),
        figure: &Ellipsoid,
        ground: &dyn Elevation,
    ) -> Option<Self> {
        Self::of_points(view, &PixelLattice::whole(size), figure, ground)
    }

    /// The same of a picture that is looked at in some of its points.
    pub fn of_points(
        view: &EyeView,
        points: &PixelLattice,
        figure: &Ellipsoid,
        ground: &dyn Elevation,
    ) -> Option<Self> {
        let rays = Rays::new(view, points.picture)?;
        let (columns, rows) = points.points;
        let distances_m = (0..columns * rows)
            .into_par_iter()
            .map(|k| {
                let at = points.at(k % columns, k / columns);
                let direction = rays.at(at.x, at.y).try_normalize()?;
                relief_distance_m(figure, ground, rays.eye_m, direction)
            })
            .collect();
        Some(Self {
            size: points.points,
            distances_m,
        })
    }

    /// Points across and down.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Distance of the ground from the eye at a point, metres; `None` is space, or outside the image.
    pub fn distance_m(&self, x: u32, y: u32) -> Option<f64> {
        let is_inside = x < self.size.0 && y < self.size.1;
        let index = y as usize * self.size.0 as usize + x as usize;
        *self.distances_m.get(index).filter(|_| is_inside)?
    }
}

/// A part of the finest sample that a ray goes at a time where it is near the ground.
const PART_OF_SAMPLE: f64 = 0.5;
/// Farthest that it goes at a time there, radians at the Earth's centre.
const MAX_STEP_RAD: f64 = 1e-3;
/// Least that it goes at a time, metres.
const MIN_STEP_M: f64 = 0.5;

/// First intersection of a ray with the terrain at full resolution, metres along the unit vector `direction` (ITRF). `None` if there is none, and
/// from below the ground.
///
/// The ray advances by intervals in which it is above all elevations ([`Elevation::range_up_to_m`]), and otherwise by half a sample; features that
/// it crosses within less than that may be missed.
pub fn relief_distance_m(
    figure: &Ellipsoid,
    ground: &dyn Elevation,
    eye_itrf_m: DVec3,
    direction: DVec3,
) -> Option<f64> {
    let range = ground.range_m(&Bounds::GLOBE);
    // A metre more all round: a figure with both radii raised is not quite as far away everywhere.
    let (outer, inner) = (range.high_m + 1.0, range.low_m - 1.0);
    let (from_m, to_m) = chord(figure, outer, eye_itrf_m, direction)?;
    let to_m = match chord(figure, inner, eye_itrf_m, direction) {
        Some((into_m, _)) if into_m > 0.0 => into_m.min(to_m),
        _ => to_m,
    };
    let at = |along_m: f64| RayPoint::new(figure, eye_itrf_m, direction, along_m);
    let above_m =
        |s: &RayPoint| s.place.height_m - ground.height_m(s.place.lat_rad, s.place.lon_rad, 0.0);
    let mut here = at(from_m.max(0.0));
    if above_m(&here) < 0.0 {
        return None;
    }
    let radius_m = figure.polar_radius_m;
    let mut step_m = 1e4_f64;
    while here.along_m < to_m {
        let end = at((here.along_m + step_m).min(to_m));
        let bounds = bounds_between(&here, &end, radius_m);
        if here.lowest_m(&end) > ground.range_up_to_m(&bounds, 0.0).high_m {
            here = end;
            step_m *= 2.0;
            continue;
        }
        let finest = ground.finest_spacing_rad(here.place.lat_rad, here.place.lon_rad);
        let fine_m = (PART_OF_SAMPLE * finest.min(MAX_STEP_RAD) * radius_m).max(MIN_STEP_M);
        if step_m > fine_m {
            step_m = (0.5 * step_m).max(fine_m);
            continue;
        }
        if above_m(&end) <= 0.0 {
            let (mut over, mut under) = (here.along_m, end.along_m);
            for _ in 0..60 {
                let middle = 0.5 * (over + under);
                if above_m(&at(middle)) > 0.0 {
                    over = middle;
                } else {
                    under = middle;
                }
            }
            return Some(under);
        }
        here = end;
    }
    None
}

/// Rise of the ground at its finest at a place, to the east and to the north, metres per metre.
pub(super) fn slope(figure: &Ellipsoid, ground: &dyn Elevation, place: &Geodetic) -> DVec2 {
    let (lat, lon) = (place.lat_rad, place.lon_rad);
    let step = ground
        .finest_spacing_rad(lat, lon)
        .clamp(1e-7, MAX_STEP_RAD);
    let aside = step / lat.cos().max(1e-6);
    let height = |north: f64, east: f64| ground.height_m(lat + north, lon + east, 0.0);
    let rise = DVec2::new(
        height(0.0, 0.5 * aside) - height(0.0, -0.5 * aside),
        height(0.5 * step, 0.0) - height(-0.5 * step, 0.0),
    );
    // Both radii of curvature are within 0.7 % of this one.
    rise / (step * figure.polar_radius_m)
}

/// A point of a ray, by its place on the ellipsoid.
struct RayPoint {
    along_m: f64,
    place: Geodetic,
    /// Rise of the ray over the ellipsoid, metres per metre.
    climb: f64,
}

impl RayPoint {
    fn new(figure: &Ellipsoid, eye_m: DVec3, direction: DVec3, along_m: f64) -> Self {
        let place = figure.geodetic_from_itrf(eye_m + direction * along_m);
        Self {
            along_m,
            climb: Ellipsoid::normal(place.lat_rad, place.lon_rad).dot(direction),
            place,
        }
    }

    /// Lower bound of a straight line's height between here and there, metres over the ellipsoid: height along it is convex, so it is above its
    /// tangents.
    fn lowest_m(&self, end: &Self) -> f64 {
        let (low, high) = (self.place.height_m, end.place.height_m);
        if self.climb >= 0.0 || end.climb <= 0.0 {
            return low.min(high);
        }
        let far_m = end.along_m - self.along_m;
        let meet_m = (high - end.climb * far_m - low) / (self.climb - end.climb);
        low + self.climb * meet_m.clamp(0.0, far_m)
    }
}

/// Bounds of the ground below a ray between two places, wider by half its length.
fn bounds_between(a: &RayPoint, b: &RayPoint, radius_m: f64) -> Bounds {
    let reach = 0.5 * (b.along_m - a.along_m) / radius_m + 1e-9;
    let south_rad = (a.place.lat_rad.min(b.place.lat_rad) - reach).max(-FRAC_PI_2);
    let north_rad = (a.place.lat_rad.max(b.place.lat_rad) + reach).min(FRAC_PI_2);
    let narrowest = south_rad.cos().min(north_rad.cos());
    let turn = (b.place.lon_rad - a.place.lon_rad + PI).rem_euclid(TAU) - PI;
    let aside = reach / narrowest.max(1e-9);
    let width_rad = turn.abs() + 2.0 * aside;
    if narrowest < 4.0 * reach || width_rad >= TAU {
        return Bounds {
            south_rad,
            north_rad,
            ..Bounds::GLOBE
        };
    }
    Bounds {
        south_rad,
        north_rad,
        west_rad: a.place.lon_rad + turn.min(0.0) - aside,
        width_rad,
    }
}

/// Where a ray is inside the figure with both radii raised, metres along it; `None` where it never is, or only behind.
fn chord(
    figure: &Ellipsoid,
    raised_m: f64,
    eye_itrf_m: DVec3,
    direction: DVec3,
) -> Option<(f64, f64)> {
    let raised = Ellipsoid {
        equatorial_radius_m: figure.equatorial_radius_m + raised_m,
        polar_radius_m: figure.polar_radius_m + raised_m,
    };
    let scale = raised.scaled_from_itrf();
    let (eye, ray) = (eye_itrf_m * scale, direction * scale);
    let length = ray.length();
    let ray = ray / length;
    let nearest = eye.cross(ray).length();
    if nearest >= 1.0 {
        return None;
    }
    let half = ((1.0 - nearest) * (1.0 + nearest)).sqrt();
    let along = -eye.dot(ray);
    (along + half > 0.0).then(|| ((along - half) / length, (along + half) / length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella_ground::elevation::HeightRange;

    const FIGURE: Ellipsoid = Ellipsoid::WGS84;

    /// Ground of one height, with a wall of a kilometre along the meridian 10° east.
    struct Wall(f64);

    impl Elevation for Wall {
        fn height_m(&self, _: f64, lon_rad: f64, _: f64) -> f64 {
            let aside = (lon_rad - 10_f64.to_radians()).abs() / 1e-4;
            self.0 + 1000.0 * (1.0 - aside).max(0.0)
        }
        fn range_m(&self, _: &Bounds) -> HeightRange {
            HeightRange {
                low_m: self.0,
                high_m: self.0 + 1000.0,
            }
        }
        fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
            1e-4
        }
    }

    fn eye(lat_deg: f64, lon_deg: f64, height_m: f64) -> DVec3 {
        FIGURE.itrf_from_geodetic(Geodetic::from_degrees(lat_deg, lon_deg, height_m))
    }

    #[test]
    fn rays_meet_the_ground_where_it_is() {
        for ground_m in [-11_000.0, 0.0, 9000.0] {
            for (lat, lon) in [(0.0, 0.0), (46.0, 179.99), (-89.9, 30.0), (90.0, 0.0)] {
                let place = Geodetic::from_degrees(lat, lon, 0.0);
                let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
                let from = eye(lat, lon, ground_m + 5e4);
                let found = relief_distance_m(&FIGURE, &Wall(ground_m), from, -up);
                assert!((found.expect("ground") - 5e4).abs() < 1e-3, "{found:?}");
                let aslant = (up.any_orthonormal_vector() - 0.3 * up).normalize();
                let found = relief_distance_m(&FIGURE, &Wall(ground_m), from, aslant);
                let met = FIGURE.geodetic_from_itrf(from + aslant * found.expect("ground"));
                let true_m = Wall(ground_m).height_m(met.lat_rad, met.lon_rad, 0.0);
                assert!((met.height_m - true_m).abs() < 1e-2, "{met:?}");
                assert_eq!(relief_distance_m(&FIGURE, &Wall(ground_m), from, up), None);
            }
        }
        let below = eye(0.0, 0.0, -10.0);
        assert_eq!(
            relief_distance_m(&FIGURE, &Wall(0.0), below, DVec3::X),
            None
        );
    }

    #[test]
    fn a_wall_hides_what_is_behind_it() {
        // From half its height, 8 km west of it, level.
        let from = eye(0.0, 9.93, 500.0);
        let lon_rad = 9.93_f64.to_radians();
        let east = DVec3::new(-lon_rad.sin(), lon_rad.cos(), 0.0);
        let found = relief_distance_m(&FIGURE, &Wall(0.0), from, east).expect("the wall");
        assert!((7e3..7.8e3).contains(&found), "{found}");
        // From above it there is nothing.
        let over = eye(0.0, 9.93, 1100.0);
        assert_eq!(relief_distance_m(&FIGURE, &Wall(0.0), over, east), None);
    }
}
