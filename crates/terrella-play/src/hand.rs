//! Manual camera control: takes the eye off the scene's camera, over the globe or around a satellite. Independent of windows.

use super::camera::{OrbitalMotion, Pose};
use super::orbit_camera::{Globe, MIN_CLEARANCE_M, OrbitCamera, Screen, pick_from};
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::PI;
use terrella::EyeView;

/// Least and greatest distance of an eye from the satellite that it follows, metres.
const FOLLOW_RANGE_M: (f64, f64) = (5.0, 1e9);
/// Greatest distance at which following begins, metres.
const FOLLOW_FROM_M: f64 = 2e6;
/// Largest elevation of the eye above and below a satellite's level, radians (89°).
const MAX_FOLLOW_PITCH_RAD: f64 = 89.0 * PI / 180.0;
/// Initial elevation of the eye above a satellite's level, radians (25°).
const FOLLOW_PITCH_RAD: f64 = 25.0 * PI / 180.0;

/// An eye that looks at a satellite and moves with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follower {
    /// The satellite's place in the scene.
    pub satellite: usize,
    /// Viewing direction, radians clockwise from the direction of flight.
    pub yaw_rad: f64,
    /// How far above level it is; negative looks down.
    pub pitch_rad: f64,
    /// From the satellite, metres.
    pub distance_m: f64,
}

/// An eye that the user has moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FreeEye {
    /// Standing over the ground.
    Orbit(OrbitCamera),
    /// Moving with a satellite.
    Follow(Follower),
}

/// The eye that the user has moved, if he has, and the place that he holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hand {
    eye: Option<FreeEye>,
    /// The place of the ground that a drag holds, ITRF metres.
    grabbed_itrf_m: Option<DVec3>,
}

/// The pose of a view in ITRF.
pub fn pose_of(view: &EyeView) -> Pose {
    let (eye_itrf_m, _) = view.to_itrf();
    let world_from_view = view.view_from_world.inverse();
    let itrf = |axis: DVec3| {
        let direction = view
            .itrf_from_world
            .transform_vector3(world_from_view * axis);
        direction.normalize_or(axis)
    };
    Pose {
        eye_itrf_m,
        forward: itrf(DVec3::NEG_Z),
        up: itrf(DVec3::Y),
    }
}

/// Vertical field of view of a view, radians.
pub fn fov_of(view: &EyeView) -> f64 {
    2.0 * (1.0 / view.clip_from_view.y_axis.y).atan()
}

impl Hand {
    /// The eye that the user has moved; `None` leaves it to the scene's camera.
    pub fn eye(&self) -> Option<FreeEye> {
        self.eye
    }

    /// The satellite that is followed.
    pub fn followed(&self) -> Option<usize> {
        match self.eye {
            Some(FreeEye::Follow(follower)) => Some(follower.satellite),
            _ => None,
        }
    }

    /// Back to the scene's camera.
    pub fn leave(&mut self) {
        *self = Self::default();
    }

    /// Nothing is held any more.
    pub fn let_go(&mut self) {
        self.grabbed_itrf_m = None;
    }

    /// The camera over the ground, initialised from the current view.
    fn orbit(&self, view: &EyeView, globe: &Globe<'_>) -> OrbitCamera {
        match self.eye {
            Some(FreeEye::Orbit(camera)) => camera,
            _ => OrbitCamera::of_pose(&pose_of(view), &globe.ellipsoid).held_above(globe),
        }
    }

    /// A drag begins at a pixel of the present view: the globe is held there. An eye that follows a satellite goes on doing so.
    pub fn grab(&mut self, view: &EyeView, globe: &Globe<'_>, screen: &Screen, at_px: DVec2) {
        if self.followed().is_some() {
            return;
        }
        // A view that is rolled loses its roll: what is held is what the user has seen under the pointer.
        self.grabbed_itrf_m = match self.eye {
            Some(FreeEye::Orbit(camera)) => camera.pick(globe, screen, at_px),
            _ => pick_from(&pose_of(view), globe, screen, at_px),
        };
        self.eye = Some(FreeEye::Orbit(self.orbit(view, globe)));
    }

    /// The pointer has moved with the grabbed place.
    pub fn drag(&mut self, globe: &Globe<'_>, screen: &Screen, from_px: DVec2, to_px: DVec2) {
        match &mut self.eye {
            Some(FreeEye::Orbit(camera)) => {
                *camera = match self.grabbed_itrf_m {
                    Some(grabbed) => camera.drag(globe, screen, grabbed, to_px),
                    None => camera.spin(globe, screen, to_px - from_px),
                };
            }
            Some(FreeEye::Follow(follower)) => follower.turn(screen, to_px - from_px),
            None => {}
        }
    }

    /// Turns and tilts around the place in the middle, or around the satellite.
    pub fn tilt(&mut self, globe: &Globe<'_>, screen: &Screen, by_px: DVec2) {
        match &mut self.eye {
            Some(FreeEye::Orbit(camera)) => *camera = camera.tilt(globe, screen, by_px),
            Some(FreeEye::Follow(follower)) => follower.turn(screen, by_px),
            None => {}
        }
    }

    /// Approaches the place under the pointer, by steps of a power of two.
    pub fn approach(
        &mut self,
        view: &EyeView,
        globe: &Globe<'_>,
        screen: &Screen,
        at_px: DVec2,
        steps: f64,
    ) {
        let factor = (-steps).exp2();
        if let Some(FreeEye::Follow(follower)) = &mut self.eye {
            let (least, most) = FOLLOW_RANGE_M;
            let distance_m = follower.distance_m * factor;
            if distance_m.is_finite() {
                follower.distance_m = distance_m.clamp(least, most);
            }
            return;
        }
        let camera = self.orbit(view, globe);
        self.eye = Some(FreeEye::Orbit(
            camera.approach(globe, screen, at_px, factor),
        ));
    }

    /// North upwards.
    pub fn north_up(&mut self, view: &EyeView, globe: &Globe<'_>, screen: &Screen) {
        match &mut self.eye {
            Some(FreeEye::Follow(follower)) => follower.yaw_rad = 0.0,
            _ => {
                let camera = self.orbit(view, globe);
                self.eye = Some(FreeEye::Orbit(camera.north_up(globe, screen)));
            }
        }
    }

    /// Brings a place of the ground into the middle.
    pub fn centre_on(
        &mut self,
        view: &EyeView,
        globe: &Globe<'_>,
        screen: &Screen,
        point_itrf_m: DVec3,
    ) {
        let camera = self.orbit(view, globe);
        let camera = camera.centred_on(globe, screen, point_itrf_m);
        *self = Self {
            eye: Some(FreeEye::Orbit(camera)),
            grabbed_itrf_m: None,
        };
    }

    /// Follows a satellite from the present distance, or from where it is seen well.
    pub fn follow(&mut self, view: &EyeView, satellite: usize, position_itrf_m: DVec3) {
        let distance_m = pose_of(view).eye_itrf_m.distance(position_itrf_m);
        let (least, _) = FOLLOW_RANGE_M;
        *self = Self {
            eye: Some(FreeEye::Follow(Follower {
                satellite,
                yaw_rad: 0.0,
                pitch_rad: -FOLLOW_PITCH_RAD,
                distance_m: distance_m.clamp(least, FOLLOW_FROM_M),
            })),
            grabbed_itrf_m: None,
        };
    }

    /// The same from where the eye is, with the satellite in the middle.
    pub fn circle(
        &mut self,
        view: &EyeView,
        globe: &Globe<'_>,
        satellite: usize,
        motion: &OrbitalMotion,
    ) {
        if self.followed() == Some(satellite) {
            return;
        }
        let away = motion.position_itrf_m - pose_of(view).eye_itrf_m;
        let level = motion.itrf_from_level(&globe.ellipsoid).transpose() * away;
        let (least, most) = FOLLOW_RANGE_M;
        *self = Self {
            eye: Some(FreeEye::Follow(Follower {
                satellite,
                yaw_rad: level.y.atan2(level.x),
                pitch_rad: (-level.z)
                    .atan2(level.x.hypot(level.y))
                    .clamp(-MAX_FOLLOW_PITCH_RAD, MAX_FOLLOW_PITCH_RAD),
                distance_m: away.length().clamp(least, most),
            })),
            grabbed_itrf_m: None,
        };
    }

    /// The pose of the user's eye. `motion` is that of the followed satellite, if known.
    pub fn pose(&self, globe: &Globe<'_>, motion: Option<&OrbitalMotion>) -> Option<Pose> {
        match (self.eye?, motion) {
            (FreeEye::Orbit(camera), _) => {
                // The ground may have become finer, and higher, since.
                Some(camera.held_above(globe).pose(&globe.ellipsoid))
            }
            (FreeEye::Follow(follower), Some(motion)) => Some(follower.pose(globe, motion)),
            (FreeEye::Follow(_), None) => None,
        }
    }
}

impl Follower {
    /// Turns by a drag in pixels; the image height is half a turn.
    fn turn(&mut self, screen: &Screen, by_px: DVec2) {
        let by_rad = by_px * PI / screen.size_px.y.max(1.0);
        if by_rad.is_finite() {
            self.yaw_rad = (self.yaw_rad - by_rad.x).rem_euclid(2.0 * PI);
            self.pitch_rad =
                (self.pitch_rad - by_rad.y).clamp(-MAX_FOLLOW_PITCH_RAD, MAX_FOLLOW_PITCH_RAD);
        }
    }

    /// Looking at the satellite, the Earth below; raised where the eye would be in the ground.
    fn pose(&self, globe: &Globe<'_>, motion: &OrbitalMotion) -> Pose {
        let level = motion.itrf_from_level(&globe.ellipsoid);
        let (ahead, down) = (level.x_axis, level.z_axis);
        let ahead = DQuat::from_axis_angle(down, self.yaw_rad) * ahead;
        let (sin, cos) = self.pitch_rad.sin_cos();
        let forward = cos * ahead - sin * down;
        let pose = Pose {
            eye_itrf_m: motion.position_itrf_m - self.distance_m * forward,
            forward,
            up: -cos * down - sin * ahead,
        };
        let place = globe.ellipsoid.geodetic_from_itrf(pose.eye_itrf_m);
        let ground_m = globe.height_m(place.lat_rad, place.lon_rad);
        if place.height_m >= ground_m + MIN_CLEARANCE_M {
            return pose;
        }
        let raised = OrbitCamera::of_pose(&pose, &globe.ellipsoid).held_above(globe);
        let eye_itrf_m = raised.pose(&globe.ellipsoid).eye_itrf_m;
        let forward = (motion.position_itrf_m - eye_itrf_m).normalize_or(forward);
        let up = (-down).reject_from_normalized(forward);
        Pose {
            eye_itrf_m,
            forward,
            up: up.normalize_or(forward.any_orthonormal_vector()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella::frames::{Ellipsoid, Geodetic};

    const FLAT: Globe<'static> = Globe {
        ellipsoid: Ellipsoid::WGS84,
        ground: None,
    };

    fn screen() -> Screen {
        Screen {
            size_px: DVec2::new(1280.0, 720.0),
            fov_rad: 0.8,
        }
    }

    fn motion() -> OrbitalMotion {
        let place = Geodetic::from_degrees(20.0, 30.0, 420_000.0);
        OrbitalMotion {
            position_itrf_m: Ellipsoid::WGS84.itrf_from_geodetic(place),
            velocity_m_s: DVec3::new(0.0, 5_000.0, 5_500.0),
        }
    }

    fn assert_looks_at(pose: &Pose, point: DVec3) {
        let towards = (point - pose.eye_itrf_m).normalize();
        assert!(pose.forward.distance(towards) < 1e-9, "{pose:?}");
        assert!(pose.forward.dot(pose.up).abs() < 1e-9, "{pose:?}");
    }

    #[test]
    fn taking_the_globe_does_not_move_the_picture() {
        let motion = motion();
        for pose in [
            Pose::nadir(&motion, crate::scene::CameraUp::Flight, &FLAT.ellipsoid),
            Pose::horizon(&motion, &FLAT.ellipsoid, 0.8),
        ] {
            let view = pose.view(0.8, 16.0 / 9.0);
            let mut hand = Hand::default();
            hand.grab(&view, &FLAT, &screen(), DVec2::new(600.0, 600.0));
            let taken = hand.pose(&FLAT, None).expect("an eye");
            assert!(taken.eye_itrf_m.distance(pose.eye_itrf_m) < 1e-3);
            assert!(taken.forward.distance(pose.forward) < 1e-6);
            assert!(taken.up.distance(pose.up) < 1e-6, "{taken:?} {pose:?}");
            assert!((fov_of(&view) - 0.8).abs() < 1e-9);
            hand.leave();
            assert_eq!(hand.pose(&FLAT, None), None);
        }
    }

    #[test]
    fn a_rolled_view_is_held_where_it_was_seen() {
        use crate::camera::HeadTurn;
        let look = HeadTurn {
            yaw_rad: 0.4,
            pitch_rad: 0.2,
            ..HeadTurn::default()
        };
        let level = Pose::geodetic(Geodetic::from_degrees(50.0, 8.0, 2e6), &FLAT.ellipsoid);
        let pose = level.turned(&look);
        let at = DVec2::new(800.0, 500.0);
        let seen = pick_from(&pose, &FLAT, &screen(), at).expect("the globe");
        let mut hand = Hand::default();
        hand.grab(&pose.view(0.8, 16.0 / 9.0), &FLAT, &screen(), at);
        let to = DVec2::new(700.0, 420.0);
        hand.drag(&FLAT, &screen(), at, to);
        let moved = hand.pose(&FLAT, None).expect("an eye");
        let held = pick_from(&moved, &FLAT, &screen(), to).expect("the globe");
        assert!(held.distance(seen) < 10.0, "{} m", held.distance(seen));
    }

    #[test]
    fn an_eye_that_circles_a_satellite_begins_where_it_is() {
        let motion = motion();
        let chase = Pose::chase(&motion, &FLAT.ellipsoid);
        let mut hand = Hand::default();
        hand.circle(&chase.view(0.8, 1.5), &FLAT, 0, &motion);
        let begun = hand.pose(&FLAT, Some(&motion)).expect("an eye");
        assert!(begun.eye_itrf_m.distance(chase.eye_itrf_m) < 1e-3);
        assert!(begun.up.distance(chase.up) < 1e-6);
        hand.drag(&FLAT, &screen(), DVec2::ZERO, DVec2::new(200.0, -300.0));
        let turned = hand.pose(&FLAT, Some(&motion)).expect("an eye");
        assert_looks_at(&turned, motion.position_itrf_m);
        let distance_m = turned.eye_itrf_m.distance(motion.position_itrf_m);
        assert!((distance_m - crate::camera::CHASE_DISTANCE_M).abs() < 1e-3);
        // The satellite is not known: there is no such eye.
        assert_eq!(hand.pose(&FLAT, None), None);
    }

    #[test]
    fn an_eye_that_follows_never_is_in_the_ground() {
        let motion = motion();
        let mut hand = Hand::default();
        let far = Pose::geodetic(Geodetic::from_degrees(0.0, 0.0, 3e7), &FLAT.ellipsoid);
        let view = far.view(0.8, 1.5);
        hand.follow(&view, 3, motion.position_itrf_m);
        assert_eq!(hand.followed(), Some(3));
        for step in 0..60 {
            hand.tilt(&FLAT, &screen(), DVec2::new(13.0, -40.0));
            hand.approach(
                &view,
                &FLAT,
                &screen(),
                DVec2::ZERO,
                if step < 30 { 0.5 } else { -1.0 },
            );
            let pose = hand.pose(&FLAT, Some(&motion)).expect("an eye");
            assert_looks_at(&pose, motion.position_itrf_m);
            let place = FLAT.ellipsoid.geodetic_from_itrf(pose.eye_itrf_m);
            assert!(place.height_m > 0.99 * MIN_CLEARANCE_M, "{place:?}");
        }
    }
}
