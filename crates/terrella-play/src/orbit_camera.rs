//! The camera that a user moves over the globe: pure f64 functions, independent of windows.
//!
//! An [`OrbitCamera`] is an eye above the ground, at rest in Earth-fixed axes. Every movement has an invariant:
//!
//! - [`OrbitCamera::drag`]: the grabbed place stays under the pointer, with the same height, heading and pitch. If no eye with this heading sees it
//!   there, as near the poles, the heading changes. Beyond the limb the pointer is clamped to it.
//! - [`OrbitCamera::approach`]: the distance is multiplied. The place under the pointer stays there if that turns the globe little, otherwise the
//!   place in the middle does.
//! - [`OrbitCamera::tilt`]: the eye moves around the place in the middle. Without one, it turns its head.
//! - No eye comes closer to the ground than [`MIN_CLEARANCE_M`].

// The path is said for the web page's crate, which has this file too.
#[path = "orbit_camera/solve.rs"]
mod solve;

use super::pose::Pose;
use glam::{DMat3, DQuat, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};
use terrella::frames::{Ellipsoid, Geodetic};

/// Least height of the eye above the ground, metres.
pub const MIN_CLEARANCE_M: f64 = 10.0;
/// Greatest height of the eye, metres: beyond it nothing is seen of the Earth.
pub const MAX_HEIGHT_M: f64 = 1e9;
/// The Earth's highest and lowest ground, with room to spare, metres.
const GROUND_RANGE_M: (f64, f64) = (-600.0, 9_500.0);
/// Number of steps for tracing a ray through the elevation range.
const MARCH_STEPS: u32 = 256;
/// Least elevation of the eye above the level of the place that it turns around, radians (1°).
const MIN_ELEVATION_RAD: f64 = PI / 180.0;
/// Most that approaching turns the globe to keep a place under the pointer, radians (15°).
const MAX_APPROACH_TURN_RAD: f64 = 15.0 * PI / 180.0;
/// How far inside the limb the pointer is taken to be at least, pixels.
const LIMB_MARGIN_PX: f64 = 1.0;

/// The picture that a pointer is on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screen {
    /// Width and height, pixels.
    pub size_px: DVec2,
    /// Vertical field of view, radians.
    pub fov_rad: f64,
}

/// Height of the ground above the ellipsoid, metres, at a geodetic latitude and longitude, radians.
pub type GroundHeight<'g> = &'g dyn Fn(f64, f64) -> f64;

/// The Earth beneath a camera.
#[derive(Clone, Copy)]
pub struct Globe<'g> {
    /// The figure.
    pub ellipsoid: Ellipsoid,
    /// Its relief; `None` is the ellipsoid itself.
    pub ground: Option<GroundHeight<'g>>,
}

/// An eye above the ground, without roll.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrbitCamera {
    /// The eye's place.
    pub place: Geodetic,
    /// Where it looks to, or what is upwards if it looks straight down, radians clockwise from north.
    pub heading_rad: f64,
    /// How far above the horizontal it looks, radians; −π/2 is straight down.
    pub pitch_rad: f64,
}

impl Screen {
    /// Angle of a pixel in the middle of the picture, radians.
    pub fn pixel_rad(&self) -> f64 {
        2.0 * (0.5 * self.fov_rad).tan() / self.size_px.y.max(1.0)
    }

    /// Pixels from the upper left corner to the middle.
    pub fn middle(&self) -> DVec2 {
        0.5 * self.size_px
    }

    /// The direction of a pixel, in axes of the camera: x right, y up, −z ahead; unit.
    fn direction(&self, at_px: DVec2) -> DVec3 {
        let from_middle = (at_px - self.middle()) * self.pixel_rad();
        DVec3::new(from_middle.x, -from_middle.y, -1.0).normalize()
    }

    /// Angle of a pixel in a direction of the camera's axes, radians: towards the edge of a wide picture pixels are smaller.
    fn pixel_rad_at(&self, direction: DVec3) -> f64 {
        self.pixel_rad() * direction.z * direction.z
    }

    /// Where a direction of the camera's axes is on screen, pixels; `None` behind the eye.
    #[cfg(test)]
    fn pixel(&self, direction: DVec3) -> Option<DVec2> {
        let ahead = -direction.z;
        let from_middle = DVec2::new(direction.x, -direction.y) / ahead / self.pixel_rad();
        (ahead > 0.0 && from_middle.is_finite()).then(|| self.middle() + from_middle)
    }
}

impl Globe<'_> {
    /// Height of the ground at a place, metres.
    pub fn height_m(&self, lat_rad: f64, lon_rad: f64) -> f64 {
        let height_m = self.ground.map_or(0.0, |ground| ground(lat_rad, lon_rad));
        if height_m.is_finite() { height_m } else { 0.0 }
    }

    fn clearance_m(&self, point_itrf_m: DVec3) -> f64 {
        let place = self.ellipsoid.geodetic_from_itrf(point_itrf_m);
        place.height_m - self.height_m(place.lat_rad, place.lon_rad)
    }

    /// First intersection of a ray from an eye with the ground, ITRF metres. `ray` is a unit vector.
    pub fn meet(&self, eye_itrf_m: DVec3, ray: DVec3) -> Option<DVec3> {
        if !(eye_itrf_m.is_finite() && ray.is_finite()) {
            return None;
        }
        if self.ground.is_none() {
            let (near, _) = crossing(&self.ellipsoid, 0.0, eye_itrf_m, ray)?;
            return (near >= 0.0).then(|| eye_itrf_m + near * ray);
        }
        let (lowest_m, highest_m) = GROUND_RANGE_M;
        let (enter, leave) = crossing(&self.ellipsoid, highest_m, eye_itrf_m, ray)?;
        let begin = enter.max(0.0);
        let bottom = crossing(&self.ellipsoid, lowest_m, eye_itrf_m, ray);
        let end = bottom.map_or(leave, |(near, _)| near);
        if end <= begin {
            return None;
        }
        // Short steps first: an eye between mountains has its ground close by.
        let at = |step: u32| {
            let part = f64::from(step) / f64::from(MARCH_STEPS);
            begin + (end - begin) * part * part
        };
        let point = |t: f64| eye_itrf_m + t * ray;
        let below = (0..=MARCH_STEPS).find(|step| self.clearance_m(point(at(*step))) <= 0.0)?;
        let (mut above, mut below) = (at(below.checked_sub(1)?), at(below));
        for _ in 0..60 {
            let middle = 0.5 * (above + below);
            match self.clearance_m(point(middle)) > 0.0 {
                true => above = middle,
                false => below = middle,
            }
        }
        Some(point(above))
    }
}

/// The place of the ground under a pixel, as it is seen from any pose, ITRF metres; `None` beside the globe.
pub fn pick_from(pose: &Pose, globe: &Globe<'_>, screen: &Screen, at_px: DVec2) -> Option<DVec3> {
    let itrf_from_camera = axes(pose);
    globe.meet(pose.eye_itrf_m, itrf_from_camera * screen.direction(at_px))
}

/// Rotation from axes of the camera (x right, y up, −z ahead) to ITRF.
fn axes(pose: &Pose) -> DMat3 {
    DMat3::from_cols(pose.forward.cross(pose.up), pose.up, -pose.forward)
}

/// Where a line crosses the surface at a height above the ellipsoid: distances from the eye, the nearer first.
fn crossing(
    ellipsoid: &Ellipsoid,
    height_m: f64,
    eye_itrf_m: DVec3,
    ray: DVec3,
) -> Option<(f64, f64)> {
    crossing_scaled(ellipsoid.itrf_from_scaled() + height_m, eye_itrf_m, ray)
}

/// The same of an ellipsoid about the axes with these radii, metres.
fn crossing_scaled(radii_m: DVec3, eye_itrf_m: DVec3, ray: DVec3) -> Option<(f64, f64)> {
    let (e, d) = (eye_itrf_m / radii_m, ray / radii_m);
    let square = d.length_squared();
    // Lagrange's identity: (E·D)² − (|E|² − 1)|D|² = |D|² − |E×D|².
    let discriminant = square - e.cross(d).length_squared();
    if discriminant.is_nan() || discriminant < 0.0 {
        return None;
    }
    let (root, half_linear) = (discriminant.sqrt(), e.dot(d));
    let constant = (e.length() - 1.0) * (e.length() + 1.0);
    let sum = match half_linear <= 0.0 {
        true => root - half_linear,
        false => -root - half_linear,
    };
    if sum == 0.0 {
        return None;
    }
    let (one, other) = (constant / sum, sum / square);
    Some((one.min(other), one.max(other)))
}

/// Heading and pitch, radians, of an attitude over a place.
fn facing(place: &Geodetic, forward: DVec3, up: DVec3) -> (f64, f64) {
    let vertical = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let (sin_lon, cos_lon) = place.lon_rad.sin_cos();
    let east = DVec3::new(-sin_lon, cos_lon, 0.0);
    let north = vertical.cross(east);
    let sin = forward.dot(vertical).clamp(-1.0, 1.0);
    let pitch_rad = sin.atan2(forward.reject_from_normalized(vertical).length());
    // For an eye that looks straight down, up on screen is ahead.
    let ahead = pitch_rad.cos() * forward - sin * up;
    (ahead.dot(east).atan2(ahead.dot(north)), pitch_rad)
}

impl OrbitCamera {
    /// The camera at a pose. Roll is lost.
    pub fn of_pose(pose: &Pose, ellipsoid: &Ellipsoid) -> Self {
        let place = ellipsoid.geodetic_from_itrf(pose.eye_itrf_m);
        let (heading_rad, pitch_rad) = facing(&place, pose.forward, pose.up);
        Self {
            place,
            heading_rad,
            pitch_rad,
        }
    }

    /// Its pose.
    pub fn pose(&self, ellipsoid: &Ellipsoid) -> Pose {
        Pose::geodetic(self.place, ellipsoid).facing(self.heading_rad, self.pitch_rad)
    }

    /// Its axes, see [`axes`], and the eye, ITRF metres.
    fn frame(&self, ellipsoid: &Ellipsoid) -> (DMat3, DVec3) {
        let pose = self.pose(ellipsoid);
        (axes(&pose), pose.eye_itrf_m)
    }

    /// Position of a point on screen, pixels; `None` behind the eye. Occlusion is ignored.
    #[cfg(test)]
    pub fn pixel_of(
        &self,
        ellipsoid: &Ellipsoid,
        screen: &Screen,
        point_itrf_m: DVec3,
    ) -> Option<DVec2> {
        let (itrf_from_camera, eye) = self.frame(ellipsoid);
        screen.pixel(itrf_from_camera.transpose() * (point_itrf_m - eye))
    }

    /// The place of the ground under a pixel, ITRF metres; `None` beside the globe.
    pub fn pick(&self, globe: &Globe<'_>, screen: &Screen, at_px: DVec2) -> Option<DVec3> {
        pick_from(&self.pose(&globe.ellipsoid), globe, screen, at_px)
    }

    /// Turns the globe so that a grabbed place comes under the pointer.
    pub fn drag(
        &self,
        globe: &Globe<'_>,
        screen: &Screen,
        grabbed_itrf_m: DVec3,
        to_px: DVec2,
    ) -> Self {
        let moved = solve::bring(self, &globe.ellipsoid, screen, grabbed_itrf_m, to_px);
        moved.map_or(*self, |moved| moved.held_above(globe))
    }

    /// Turns the globe by as much as the place below the eye moves for these pixels: for a pointer that holds no place.
    pub fn spin(&self, globe: &Globe<'_>, screen: &Screen, by_px: DVec2) -> Self {
        let ellipsoid = &globe.ellipsoid;
        let above_m = self.place.height_m - self.height_below_m(globe);
        let radius_m = ellipsoid.polar_radius_m;
        // Limited to the rotation that moves a point from the middle to the limb within the image height.
        let by_rad = (by_px * screen.pixel_rad() * above_m.max(MIN_CLEARANCE_M) / radius_m)
            .clamp_length_max(by_px.length() * PI / screen.size_px.y.max(1.0));
        if !by_rad.is_finite() {
            return *self;
        }
        let pose = self.pose(ellipsoid);
        let vertical = Ellipsoid::normal(self.place.lat_rad, self.place.lon_rad);
        let right = pose.forward.cross(pose.up);
        let ahead = vertical.cross(right).normalize_or(pose.up);
        // Content dragged to the right or downwards comes from the left or from above.
        let turn =
            DQuat::from_axis_angle(ahead, -by_rad.x) * DQuat::from_axis_angle(right, -by_rad.y);
        self.turned(ellipsoid, turn).held_above(globe)
    }

    /// The same camera with the eye turned about the Earth's centre. Height and pitch stay; the heading is carried along.
    fn turned(&self, ellipsoid: &Ellipsoid, turn: DQuat) -> Self {
        let pose = self.pose(ellipsoid);
        let eye = ellipsoid.geodetic_from_itrf(turn * pose.eye_itrf_m);
        let place = Geodetic {
            height_m: self.place.height_m,
            ..eye
        };
        let (heading_rad, _) = facing(&place, turn * pose.forward, turn * pose.up);
        Self {
            place,
            heading_rad,
            pitch_rad: self.pitch_rad,
        }
    }

    /// Multiplies the distance to the place in the middle, or the height if there is none. The place under the pointer stays under it if possible.
    pub fn approach(&self, globe: &Globe<'_>, screen: &Screen, at_px: DVec2, factor: f64) -> Self {
        let is_lowest =
            || self.place.height_m - self.height_below_m(globe) < 1.01 * MIN_CLEARANCE_M;
        if !(factor.is_finite() && factor > 0.0) || (factor < 1.0 && is_lowest()) {
            return *self;
        }
        let ellipsoid = &globe.ellipsoid;
        let held = self.pick(globe, screen, at_px);
        let next = match self.pick(globe, screen, screen.middle()) {
            Some(middle) => {
                let pose = self.pose(ellipsoid);
                let eye_itrf_m = middle + factor * (pose.eye_itrf_m - middle);
                Self::of_pose(&Pose { eye_itrf_m, ..pose }, ellipsoid)
            }
            None => self.scaled_height(globe, factor),
        };
        let next = next.held_above(globe);
        let Some(held) = held else {
            return next;
        };
        let brought = solve::bring(&next, ellipsoid, screen, held, at_px);
        let turns_little = |other: &Self| {
            let normal = |one: &Self| Ellipsoid::normal(one.place.lat_rad, one.place.lon_rad);
            let turn_rad = normal(other).angle_between(normal(&next));
            turn_rad <= MAX_APPROACH_TURN_RAD && solve::is_inside(&next, ellipsoid, screen, at_px)
        };
        brought
            .filter(turns_little)
            .map_or(next, |brought| brought.held_above(globe))
    }

    /// Another height above the same place, at which the limb stays where it is on screen.
    fn scaled_height(&self, globe: &Globe<'_>, factor: f64) -> Self {
        let ground_m = self.height_below_m(globe);
        let height_m = ground_m + factor * (self.place.height_m - ground_m);
        let dip_rad = |height_m: f64| {
            let radius_m = globe.ellipsoid.equatorial_radius_m;
            (radius_m / (radius_m + height_m.max(0.0))).acos()
        };
        let pitch_rad = self.pitch_rad + dip_rad(self.place.height_m) - dip_rad(height_m);
        Self {
            place: Geodetic {
                height_m,
                ..self.place
            },
            pitch_rad: pitch_rad.clamp(-FRAC_PI_2, FRAC_PI_2),
            ..*self
        }
    }

    /// Moves the eye around the place in the middle by pixels of a drag, to the right and downwards; the picture's height is half
    /// a turn. Dragging down lowers the eye towards the horizon. Without a place in the middle the head turns.
    pub fn tilt(&self, globe: &Globe<'_>, screen: &Screen, by_px: DVec2) -> Self {
        if !by_px.is_finite() {
            return *self;
        }
        let ellipsoid = &globe.ellipsoid;
        let Some(middle) = self.pick(globe, screen, screen.middle()) else {
            let by_rad = by_px * screen.pixel_rad();
            return Self {
                heading_rad: wrapped(self.heading_rad - by_rad.x),
                pitch_rad: (self.pitch_rad + by_rad.y).clamp(-FRAC_PI_2, FRAC_PI_2),
                ..*self
            };
        };
        let by_rad = by_px * PI / screen.size_px.y.max(1.0);
        let pose = self.pose(ellipsoid);
        let place = ellipsoid.geodetic_from_itrf(middle);
        let (heading_rad, pitch_rad) = facing(&place, pose.forward, pose.up);
        let pitch_rad = (pitch_rad + by_rad.y).clamp(-FRAC_PI_2, -MIN_ELEVATION_RAD);
        let distance_m = pose.eye_itrf_m.distance(middle);
        Self::around(
            &place,
            ellipsoid,
            heading_rad - by_rad.x,
            pitch_rad,
            distance_m,
        )
        .held_above(globe)
        .aimed_at(ellipsoid, middle)
    }

    /// An eye that has a place in the middle, at a distance from it, looking along a heading and pitch of that place, radians.
    pub fn around(
        place: &Geodetic,
        ellipsoid: &Ellipsoid,
        heading_rad: f64,
        pitch_rad: f64,
        distance_m: f64,
    ) -> Self {
        let pose = Pose::geodetic(*place, ellipsoid).facing(heading_rad, pitch_rad);
        let eye_itrf_m = pose.eye_itrf_m - distance_m * pose.forward;
        Self::of_pose(&Pose { eye_itrf_m, ..pose }, ellipsoid)
    }

    /// The same eye with a point in the middle, where that is not straight below already.
    fn aimed_at(&self, ellipsoid: &Ellipsoid, point_itrf_m: DVec3) -> Self {
        let pose = self.pose(ellipsoid);
        let Some(forward) = (point_itrf_m - pose.eye_itrf_m).try_normalize() else {
            return *self;
        };
        let vertical = Ellipsoid::normal(self.place.lat_rad, self.place.lon_rad);
        let level = forward.reject_from_normalized(vertical);
        // Straight down there is no other heading than the present one.
        let ahead = match level.length() > 1e-9 {
            true => level.normalize(),
            false => vertical.cross(pose.forward.cross(pose.up)),
        };
        let (heading_rad, _) = facing(&self.place, ahead, vertical);
        let pitch_rad = forward.dot(vertical).atan2(level.length());
        Self {
            heading_rad,
            pitch_rad,
            ..*self
        }
    }

    /// North upwards, around the place in the middle where there is one.
    pub fn north_up(&self, globe: &Globe<'_>, screen: &Screen) -> Self {
        let ellipsoid = &globe.ellipsoid;
        let Some(middle) = self.pick(globe, screen, screen.middle()) else {
            return Self {
                heading_rad: 0.0,
                ..*self
            };
        };
        let pose = self.pose(ellipsoid);
        let place = ellipsoid.geodetic_from_itrf(middle);
        let (_, pitch_rad) = facing(&place, pose.forward, pose.up);
        let distance_m = pose.eye_itrf_m.distance(middle);
        Self::around(&place, ellipsoid, 0.0, pitch_rad, distance_m).held_above(globe)
    }

    /// Moves so that a point of the ground comes into the middle; heading, pitch and height stay where the globe allows it.
    pub fn centred_on(&self, globe: &Globe<'_>, screen: &Screen, point_itrf_m: DVec3) -> Self {
        let middle = screen.middle();
        let ellipsoid = &globe.ellipsoid;
        match self.pick(globe, screen, middle) {
            Some(_) => self.drag(globe, screen, point_itrf_m, middle),
            // Nothing is in the middle: from straight above.
            None => {
                let place = ellipsoid.geodetic_from_itrf(point_itrf_m);
                let distance_m = self.place.height_m - place.height_m;
                Self::around(
                    &place,
                    ellipsoid,
                    self.heading_rad,
                    -FRAC_PI_2,
                    distance_m.max(MIN_CLEARANCE_M),
                )
                .held_above(globe)
            }
        }
    }

    fn height_below_m(&self, globe: &Globe<'_>) -> f64 {
        globe.height_m(self.place.lat_rad, self.place.lon_rad)
    }

    /// The same eye, raised to [`MIN_CLEARANCE_M`] above the ground where it is lower, and never beyond [`MAX_HEIGHT_M`].
    pub fn held_above(&self, globe: &Globe<'_>) -> Self {
        let lowest_m = self.height_below_m(globe) + MIN_CLEARANCE_M;
        Self {
            place: Geodetic {
                height_m: self.place.height_m.min(MAX_HEIGHT_M).max(lowest_m),
                ..self.place
            },
            ..*self
        }
    }
}

/// An angle in −π…π.
fn wrapped(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(2.0 * PI) - PI
}

#[cfg(test)]
#[path = "orbit_camera/tests.rs"]
mod tests;
