//! The camera that the page sets and the pointer moves.

use crate::orbit_camera::{Globe, OrbitCamera, Screen, pick_from};
use crate::pose::{Pose, north_of};
use crate::ride::Ride;
use glam::{DVec2, DVec3};
use terrella::EyeView;
use terrella::frames::{Ellipsoid, Geodetic};

/// Widest and narrowest vertical field of view, degrees.
const FOV_RANGE_DEG: (f64, f64) = (0.1, 150.0);

/// The near plane, as a part of the eye's height. WebGL2 keeps depth between −1 and 1, where a float has no digits left for planets behind
/// a near plane of centimetres.
const NEAR_BY_HEIGHT: f64 = 1e-3;

/// A view as a page writes it: degrees and metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Geodetic latitude of the eye, −90…90.
    pub lat_deg: f64,
    /// Longitude of the eye, east positive.
    pub lon_deg: f64,
    /// Height of the eye above the ellipsoid.
    pub altitude_m: f64,
    /// Clockwise from north.
    pub heading_deg: f64,
    /// Above the horizontal; −90 is straight down.
    pub pitch_deg: f64,
    /// Vertical field of view.
    pub fov_deg: f64,
}

/// An eye over the globe, and the place that a drag holds.
#[derive(Clone, Copy, Debug)]
pub struct Eye {
    camera: OrbitCamera,
    fov_rad: f64,
    grabbed_itrf_m: Option<DVec3>,
    /// The camera of another program or on a satellite, in place of this one until it is moved.
    free: Option<Pose>,
    /// How it rides on a satellite, until it is moved.
    ride: Option<Ride>,
}

const GLOBE: Globe<'static> = Globe {
    ellipsoid: Ellipsoid::WGS84,
    ground: None,
};

impl Eye {
    /// At a view. `None` if a number is not finite.
    pub fn new(view: &View) -> Option<Self> {
        let View {
            lat_deg,
            lon_deg,
            altitude_m,
            heading_deg,
            pitch_deg,
            fov_deg,
        } = *view;
        let all = [
            lat_deg,
            lon_deg,
            altitude_m,
            heading_deg,
            pitch_deg,
            fov_deg,
        ];
        if !all.iter().all(|number| number.is_finite()) {
            return None;
        }
        let camera = OrbitCamera {
            place: Geodetic::from_degrees(lat_deg.clamp(-90.0, 90.0), lon_deg, altitude_m),
            heading_rad: heading_deg.to_radians(),
            pitch_rad: pitch_deg.clamp(-90.0, 90.0).to_radians(),
        };
        Some(Self {
            camera: camera.held_above(&GLOBE),
            fov_rad: fov_deg.clamp(FOV_RANGE_DEG.0, FOV_RANGE_DEG.1).to_radians(),
            grabbed_itrf_m: None,
            free: None,
            ride: None,
        })
    }

    /// Rides on a satellite from the next frame on; with `None` the camera stays where it is.
    pub fn set_ride(&mut self, ride: Option<Ride>) {
        self.ride = ride;
    }

    /// How it rides on a satellite.
    pub fn ride(&self) -> Option<Ride> {
        self.ride
    }

    /// Vertical field of view, radians.
    pub fn fov_rad(&self) -> f64 {
        self.fov_rad
    }

    /// The satellite has taken it to a place.
    pub fn carried(&self, pose: &Pose) -> Self {
        let at = self.free(
            pose.eye_itrf_m,
            pose.forward,
            pose.up,
            self.fov_rad.to_degrees(),
        );
        // The satellite's place is finite.
        at.map_or(*self, |eye| Self {
            ride: self.ride,
            grabbed_itrf_m: self.grabbed_itrf_m,
            ..eye
        })
    }

    /// At a place, ITRF metres, that looks along a direction, with an axis that is upwards on screen. `None` if these are no camera: not finite, at
    /// the centre of the Earth, or with parallel axes.
    pub fn free(
        &self,
        at_itrf_m: DVec3,
        direction: DVec3,
        up: DVec3,
        fov_deg: f64,
    ) -> Option<Self> {
        let forward = direction.try_normalize()?;
        let up = (up - up.dot(forward) * forward).try_normalize()?;
        if !(at_itrf_m.is_finite() && at_itrf_m.length() > 1.0 && fov_deg.is_finite()) {
            return None;
        }
        let place = GLOBE.ellipsoid.geodetic_from_itrf(at_itrf_m);
        let vertical = Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let north = north_of(place);
        let east = north.cross(vertical);
        // Straight up or down, the heading is that of the upper edge.
        let ahead = match forward.dot(vertical).abs() < 1.0 - 1e-9 {
            true => forward,
            false => -forward.dot(vertical).signum() * up,
        };
        let camera = OrbitCamera {
            place,
            heading_rad: ahead.dot(east).atan2(ahead.dot(north)),
            pitch_rad: forward.dot(vertical).clamp(-1.0, 1.0).asin(),
        };
        Some(Self {
            camera,
            fov_rad: fov_deg.clamp(FOV_RANGE_DEG.0, FOV_RANGE_DEG.1).to_radians(),
            grabbed_itrf_m: None,
            free: Some(Pose {
                eye_itrf_m: at_itrf_m,
                forward,
                up,
            }),
            ride: None,
        })
    }

    /// Replaces the camera by one of this module.
    fn moved_to(&mut self, camera: OrbitCamera) {
        self.camera = camera;
        self.free = None;
        self.ride = None;
    }

    /// Its current position.
    pub fn view(&self) -> View {
        let OrbitCamera {
            place,
            heading_rad,
            pitch_rad,
        } = self.camera;
        View {
            lat_deg: place.lat_rad.to_degrees(),
            lon_deg: place.lon_rad.to_degrees(),
            altitude_m: place.height_m,
            heading_deg: heading_rad.to_degrees().rem_euclid(360.0),
            pitch_deg: pitch_rad.to_degrees(),
            fov_deg: self.fov_rad.to_degrees(),
        }
    }

    /// For the renderer, on a canvas of so many pixels.
    pub fn eye_view(&self, size_px: (u32, u32)) -> EyeView {
        let aspect = f64::from(size_px.0) / f64::from(size_px.1.max(1));
        let mut view = self.pose().view(self.fov_rad, aspect);
        // The last column of the projection is the near plane: see `infinite_reversed_z`.
        let near_m = (NEAR_BY_HEIGHT * self.camera.place.height_m).max(EyeView::NEAR_M);
        view.clip_from_view.w_axis.z = near_m;
        view
    }

    fn pose(&self) -> Pose {
        let own = || self.camera.pose(&GLOBE.ellipsoid);
        self.free.unwrap_or_else(own)
    }

    /// The ground under a pixel as it is drawn, ITRF metres.
    fn ground_at(&self, size_px: (u32, u32), at_px: DVec2) -> Option<DVec3> {
        pick_from(&self.pose(), &GLOBE, &self.screen(size_px), at_px)
    }

    fn screen(&self, size_px: (u32, u32)) -> Screen {
        Screen {
            size_px: DVec2::new(size_px.0.into(), size_px.1.into()),
            fov_rad: self.fov_rad,
        }
    }

    /// Latitude and longitude of the ground under a pixel, degrees; `None` beside the globe.
    pub fn place_at(&self, size_px: (u32, u32), at_px: DVec2) -> Option<[f64; 2]> {
        let point = self.ground_at(size_px, at_px)?;
        let place = GLOBE.ellipsoid.geodetic_from_itrf(point);
        Some([place.lat_rad.to_degrees(), place.lon_rad.to_degrees()])
    }

    /// A drag begins: the place under the pixel is held.
    pub fn grab(&mut self, size_px: (u32, u32), at_px: DVec2) {
        self.grabbed_itrf_m = self.ground_at(size_px, at_px);
    }

    /// Nothing is held any more.
    pub fn let_go(&mut self) {
        self.grabbed_itrf_m = None;
    }

    /// The pointer has moved: the grabbed place follows it, or the globe spins if none is grabbed.
    pub fn drag(&mut self, size_px: (u32, u32), from_px: DVec2, to_px: DVec2) {
        let screen = self.screen(size_px);
        self.moved_to(match self.grabbed_itrf_m {
            Some(place) => self.camera.drag(&GLOBE, &screen, place, to_px),
            None => self.camera.spin(&GLOBE, &screen, to_px - from_px),
        });
    }

    /// Multiplies the distance; the place under the pixel stays there if it can.
    pub fn approach(&mut self, size_px: (u32, u32), at_px: DVec2, factor: f64) {
        let screen = self.screen(size_px);
        self.moved_to(self.camera.approach(&GLOBE, &screen, at_px, factor));
    }

    /// Moves around the place in the middle by pixels of a drag.
    pub fn tilt(&mut self, size_px: (u32, u32), by_px: DVec2) {
        let screen = self.screen(size_px);
        self.moved_to(self.camera.tilt(&GLOBE, &screen, by_px));
    }

    /// North upwards.
    pub fn north_up(&mut self, size_px: (u32, u32)) {
        let screen = self.screen(size_px);
        self.moved_to(self.camera.north_up(&GLOBE, &screen));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (640, 360);

    fn eye() -> Eye {
        let view = View {
            lat_deg: 20.0,
            lon_deg: -40.0,
            altitude_m: 12e6,
            heading_deg: 30.0,
            pitch_deg: -80.0,
            fov_deg: 40.0,
        };
        Eye::new(&view).expect("finite numbers")
    }

    #[test]
    fn a_dragged_place_stays_under_the_pointer() {
        let (mut eye, from, to) = (eye(), DVec2::new(300.0, 200.0), DVec2::new(250.0, 140.0));
        let held = eye.place_at(SIZE, from).expect("ground");
        eye.grab(SIZE, from);
        eye.drag(SIZE, from, to);
        let there = eye.place_at(SIZE, to).expect("ground");
        for (held, there) in held.into_iter().zip(there) {
            assert!((held - there).abs() < 1e-6, "{held} {there}");
        }
    }

    #[test]
    fn the_camera_of_another_program_is_taken_as_it_is() {
        let eye = eye();
        let pose = eye.camera.pose(&GLOBE.ellipsoid);
        // Rolled, and not quite at right angles.
        let right = pose.forward.cross(pose.up);
        let up = pose.up + 0.5 * right + 0.2 * pose.forward;
        let free = eye
            .free(pose.eye_itrf_m, 3.0 * pose.forward, up, 40.0)
            .expect("a camera");
        let (view, again) = (eye.view(), free.view());
        assert!((view.lat_deg - again.lat_deg).abs() < 1e-9, "{again:?}");
        assert!(
            (view.heading_deg - again.heading_deg).abs() < 1e-9,
            "{again:?}"
        );
        assert!((view.pitch_deg - again.pitch_deg).abs() < 1e-9, "{again:?}");
        let drawn = free.free.expect("kept as it is");
        assert!(
            (drawn.up.dot(right) - 0.2_f64.sqrt()).abs() < 1e-12,
            "{drawn:?}"
        );
        // A place right of the middle is picked where the roll puts it.
        let middle = DVec2::new(320.0, 180.0);
        let [east, north] = [drawn.forward.cross(drawn.up), drawn.up];
        let aside = drawn.forward + 0.05 * east + 0.02 * north;
        let seen = GLOBE.meet(drawn.eye_itrf_m, aside).expect("ground");
        let seen = GLOBE.ellipsoid.geodetic_from_itrf(seen);
        let pixels = 180.0 / 20_f64.to_radians().tan();
        let at_px = middle + pixels * DVec2::new(0.05, -0.02);
        let picked = free.place_at(SIZE, at_px).expect("ground");
        let expected = [seen.lat_rad.to_degrees(), seen.lon_rad.to_degrees()];
        assert!(
            (picked[0] - expected[0]).abs() < 1e-6,
            "{picked:?}, {expected:?}"
        );
        assert!(
            (picked[1] - expected[1]).abs() < 1e-6,
            "{picked:?}, {expected:?}"
        );
        // A drag levels the camera, with the grabbed place under the pointer.
        let (mut dragged, to_px) = (free, at_px + DVec2::new(20.0, 5.0));
        dragged.grab(SIZE, at_px);
        dragged.drag(SIZE, at_px, to_px);
        let there = dragged.place_at(SIZE, to_px).expect("ground");
        assert!(
            dragged.free.is_none() && (there[0] - picked[0]).abs() < 1e-6,
            "{there:?}"
        );
        let mut moved = free;
        moved.tilt(SIZE, DVec2::new(3.0, 0.0));
        assert!(moved.free.is_none());
        // Straight down, west upwards.
        let down = eye
            .free(DVec3::X * 9e6, -DVec3::X, -DVec3::Y, 40.0)
            .expect("a camera")
            .view();
        assert!(
            (down.heading_deg - 270.0).abs() < 1e-6 && (down.pitch_deg + 90.0).abs() < 1e-6,
            "{down:?}"
        );
        assert!(eye.free(DVec3::ZERO, DVec3::X, DVec3::Y, 40.0).is_none());
        assert!(eye.free(DVec3::X * 9e6, DVec3::X, DVec3::X, 40.0).is_none());
        assert!(
            eye.free(DVec3::X * 9e6, DVec3::X, DVec3::Y, f64::NAN)
                .is_none()
        );
    }

    #[test]
    fn views_come_back_and_nonsense_is_none() {
        let view = eye().view();
        let again = Eye::new(&view).expect("finite numbers").view();
        assert!((view.lat_deg - again.lat_deg).abs() < 1e-12);
        assert!((view.heading_deg - again.heading_deg).abs() < 1e-12);
        let nonsense = View {
            altitude_m: f64::NAN,
            ..view
        };
        assert!(Eye::new(&nonsense).is_none());
        let low = View {
            altitude_m: -1e9,
            lat_deg: 1e9,
            ..view
        };
        let low = Eye::new(&low).expect("finite numbers").view();
        assert!(low.altitude_m > 0.0 && low.lat_deg == 90.0);
    }
}
