//! Which camera sees a point at a pixel.

use super::{LIMB_MARGIN_PX, OrbitCamera, Screen, crossing_scaled};
use glam::{DMat2, DQuat, DVec2, DVec3};
use terrella::frames::{Ellipsoid, Geodetic};

/// Eyes closer to a pole turn with it: there north changes faster than the picture can follow, radians (88°).
const MAX_NORTH_UP_LAT_RAD: f64 = 88.0 * std::f64::consts::PI / 180.0;
/// A point that is this close to its pixel has arrived, pixels.
const ARRIVED_PX: f64 = 1e-5;
/// A point that is no closer has not, pixels.
const MISSED_PX: f64 = 0.5;
/// Largest ratio of eye movement to ground movement before the heading changes.
const MAX_GAIN: f64 = 4.0;
const NEWTON_STEPS: u32 = 30;
const TURNS: u32 = 60;

/// The camera of the same height and pitch that sees a point at a pixel, with the same heading if possible; `None` if none is found.
pub fn bring(
    camera: &OrbitCamera,
    ellipsoid: &Ellipsoid,
    screen: &Screen,
    point_itrf_m: DVec3,
    to_px: DVec2,
) -> Option<OrbitCamera> {
    let is_sound = point_itrf_m.is_finite() && to_px.is_finite() && screen.size_px.is_finite();
    if !is_sound || screen.size_px.min_element() < 1.0 {
        return None;
    }
    let goal = Goal::new(camera, ellipsoid, screen, point_itrf_m, to_px)?;
    let before = camera.pose(ellipsoid).eye_itrf_m;
    let moves_little = |other: &OrbitCamera| {
        let angle = other.pose(ellipsoid).eye_itrf_m.angle_between(before);
        angle <= MAX_GAIN * goal.ground_turn_rad + 1e-9
    };
    let by_heading = (camera.place.lat_rad.abs() < MAX_NORTH_UP_LAT_RAD)
        .then(|| goal.by_newton(camera))
        .flatten()
        .filter(moves_little);
    by_heading.or_else(|| goal.by_turning(camera))
}

/// Whether a pixel is inside the limb of the globe, as a camera sees it.
pub fn is_inside(
    camera: &OrbitCamera,
    ellipsoid: &Ellipsoid,
    screen: &Screen,
    at_px: DVec2,
) -> bool {
    let (itrf_from_camera, eye) = camera.frame(ellipsoid);
    let ray = itrf_from_camera * screen.direction(at_px);
    let scale = ellipsoid.scaled_from_itrf();
    within_limb(
        scale * eye,
        scale * ray,
        screen.pixel_rad_at(screen.direction(at_px)),
    ) == (scale * ray).normalize_or_zero()
}

struct Goal<'g> {
    ellipsoid: &'g Ellipsoid,
    screen: &'g Screen,
    point_itrf_m: DVec3,
    /// The ellipsoid through the point.
    radii_m: DVec3,
    /// The pixel's direction in axes of the camera.
    direction: DVec3,
    /// Two directions across it.
    across: [DVec3; 2],
    /// Where the pixel's ray meets the height of the point, for the camera before the movement.
    under_itrf_m: DVec3,
    /// Angle at the Earth's centre from there to the point.
    ground_turn_rad: f64,
}

impl<'g> Goal<'g> {
    fn new(
        camera: &OrbitCamera,
        ellipsoid: &'g Ellipsoid,
        screen: &'g Screen,
        point_itrf_m: DVec3,
        to_px: DVec2,
    ) -> Option<Self> {
        let radii_m =
            ellipsoid.itrf_from_scaled() * (ellipsoid.scaled_from_itrf() * point_itrf_m).length();
        let (itrf_from_camera, eye) = camera.frame(ellipsoid);
        if (eye / radii_m).length() <= 1.0 {
            // The point is higher than the eye: no turn of the globe carries it along a level.
            return None;
        }
        let wanted = screen.direction(to_px);
        let ray = itrf_from_camera * wanted;
        let pixel_rad = screen.pixel_rad_at(wanted);
        let ray = (radii_m * within_limb(eye / radii_m, ray / radii_m, pixel_rad)).normalize();
        let direction = itrf_from_camera.transpose() * ray;
        let right = direction.any_orthonormal_vector();
        let (near, _) = crossing_scaled(radii_m, eye, ray)?;
        let under_itrf_m = eye + near * ray;
        (near >= 0.0).then_some(Self {
            ellipsoid,
            screen,
            point_itrf_m,
            radii_m,
            direction,
            across: [right, direction.cross(right)],
            under_itrf_m,
            ground_turn_rad: under_itrf_m.angle_between(point_itrf_m),
        })
    }

    /// How far from the pixel a camera sees the point, radians in two directions; `None` if it is hidden behind the globe.
    fn miss(&self, camera: &OrbitCamera) -> Option<DVec2> {
        let (itrf_from_camera, eye) = camera.frame(self.ellipsoid);
        let normal = (self.point_itrf_m / self.radii_m).normalize();
        if normal.dot(eye / self.radii_m) < 1.0 {
            return None;
        }
        let seen = itrf_from_camera.transpose() * (self.point_itrf_m - eye).try_normalize()?;
        let along = seen.dot(self.direction);
        (along > 0.0).then(|| {
            let [right, up] = self.across;
            DVec2::new(seen.dot(right), seen.dot(up)) / along
        })
    }

    fn pixel_rad(&self) -> f64 {
        self.screen.pixel_rad_at(self.direction)
    }

    fn has_arrived(&self, camera: &OrbitCamera, within_px: f64) -> bool {
        let miss = self.miss(camera);
        miss.is_some_and(|miss| miss.length() <= within_px * self.pixel_rad())
    }

    /// Latitude and longitude alone change.
    fn by_newton(&self, camera: &OrbitCamera) -> Option<OrbitCamera> {
        let moved = |from: &OrbitCamera, by: DVec2| OrbitCamera {
            place: Geodetic {
                lat_rad: from.place.lat_rad + by.y,
                lon_rad: super::wrapped(from.place.lon_rad + by.x / from.place.lat_rad.cos()),
                ..from.place
            },
            ..*from
        };
        let [from, to] =
            [self.under_itrf_m, self.point_itrf_m].map(|at| self.ellipsoid.geodetic_from_itrf(at));
        let first = DVec2::new(
            super::wrapped(to.lon_rad - from.lon_rad) * camera.place.lat_rad.cos(),
            to.lat_rad - from.lat_rad,
        );
        let guess = moved(camera, first);
        let is_good =
            guess.place.lat_rad.abs() < MAX_NORTH_UP_LAT_RAD && self.miss(&guess).is_some();
        let mut at = if is_good { guess } else { *camera };
        let mut miss = self.miss(&at)?;
        let step_rad =
            (1e-4 * camera.place.height_m / self.ellipsoid.polar_radius_m).clamp(1e-11, 1e-5);
        for _ in 0..NEWTON_STEPS {
            if miss.length() <= ARRIVED_PX * self.pixel_rad() {
                break;
            }
            let slope = |by: DVec2| {
                let (ahead, behind) = (self.miss(&moved(&at, by))?, self.miss(&moved(&at, -by))?);
                Some((ahead - behind) / (2.0 * step_rad))
            };
            let jacobian = DMat2::from_cols(
                slope(DVec2::new(step_rad, 0.0))?,
                slope(DVec2::new(0.0, step_rad))?,
            );
            let by = -(jacobian.inverse() * miss);
            if !by.is_finite() {
                return None;
            }
            // Half the step, and half of that, until it is one that helps.
            let mut part = 1.0;
            let next = loop {
                let next = moved(&at, part * by);
                let is_north_up = next.place.lat_rad.abs() < MAX_NORTH_UP_LAT_RAD;
                let better = self.miss(&next).filter(|one| one.length() < miss.length());
                if let (true, Some(better)) = (is_north_up, better) {
                    break Some((next, better));
                }
                part *= 0.5;
                if part < 1e-3 {
                    break None;
                }
            };
            match next {
                Some(next) => (at, miss) = next,
                None => break,
            }
        }
        self.has_arrived(&at, MISSED_PX).then_some(at)
    }

    /// The globe turns by the shortest way, and the heading with it.
    fn by_turning(&self, camera: &OrbitCamera) -> Option<OrbitCamera> {
        let mut at = *camera;
        for _ in 0..TURNS {
            let (itrf_from_camera, eye) = at.frame(self.ellipsoid);
            let ray = itrf_from_camera * self.direction;
            let ray = (self.radii_m
                * within_limb(eye / self.radii_m, ray / self.radii_m, self.pixel_rad()))
            .normalize();
            let (near, _) = crossing_scaled(self.radii_m, eye, ray)?;
            let under = eye + near * ray;
            let turn = DQuat::from_rotation_arc(
                under.try_normalize()?,
                self.point_itrf_m.try_normalize()?,
            );
            let next = at.turned(self.ellipsoid, turn);
            if self.has_arrived(&next, ARRIVED_PX) {
                return Some(next);
            }
            at = next;
        }
        self.has_arrived(&at, MISSED_PX).then_some(at)
    }
}

/// The direction of a ray in scaled space, turned inwards to [`LIMB_MARGIN_PX`] inside the limb where it passes beside the globe or
/// closer to the limb.
fn within_limb(eye: DVec3, ray: DVec3, pixel_rad: f64) -> DVec3 {
    let ray = ray.normalize_or_zero();
    let distance = eye.length();
    if distance <= 1.0 {
        return ray;
    }
    let down = -eye / distance;
    let limb_rad = (1.0 / distance).asin();
    let widest_rad = limb_rad - (LIMB_MARGIN_PX * pixel_rad).min(0.5 * limb_rad);
    let outwards = ray.reject_from_normalized(down);
    let angle_rad = outwards.length().atan2(ray.dot(down));
    if angle_rad <= widest_rad {
        return ray;
    }
    let (sin, cos) = widest_rad.sin_cos();
    cos * down + sin * outwards.normalize_or(down.any_orthonormal_vector())
}
