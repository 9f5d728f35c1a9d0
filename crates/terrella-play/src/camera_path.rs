//! Motion of a scene's camera over time, from its keyframes.
//!
//! A keyframe with a cut begins a shot: nothing is interpolated across it.
//!
//! Each quantity is interpolated through the keyframes that set it; without one it has the value of `[camera]`. Positions follow the sphere: the
//! vertical by a curve of great-circle arcs, the height by its logarithm. Attitudes over the ground are transported with the vertical, in axes that
//! rotate with it by the shortest way and not with north. A camera that looks straight down, or level, at two keyframes thus does so between them,
//! and nothing spins at the poles.

use super::camera::{HeadTurn, OrbitalMotion, Pose};
use super::spline::{NumberTrack, SphereTrack};
use crate::scene::{Camera, CameraKey, Scene};
use glam::{DMat3, DQuat, DVec3};
use terrella::frames::{Ellipsoid, Epoch, Geodetic};

/// The course of a camera.
#[derive(Clone, Debug)]
pub struct CameraPath {
    start: Epoch,
    /// When each shot begins, seconds after the start, in order; the first is there from the beginning.
    shots: Vec<(f64, Shot)>,
}

/// The course of a camera between two cuts.
#[derive(Clone, Debug)]
struct Shot {
    camera: Camera,
    place: Option<PlaceTrack>,
    facing: Option<FacingTrack>,
    turn: Option<SphereTrack>,
    roll_rad: Option<NumberTrack>,
    offset: Option<(SphereTrack, NumberTrack)>,
    /// Logarithm of the tangent of half the field of view: zooming is even.
    ln_half_fov: Option<NumberTrack>,
    exposure_ev: Option<NumberTrack>,
}

/// A place above the ground over time: the vertical, and the logarithm of the height in metres.
#[derive(Clone, Debug)]
struct PlaceTrack {
    vertical: SphereTrack,
    ln_height: NumberTrack,
}

/// An attitude over the ground over time, in the axes that are carried along with the vertical.
#[derive(Clone, Debug)]
struct FacingTrack {
    /// The vertical from which they are carried.
    from: DVec3,
    attitude: SphereTrack,
}

impl PlaceTrack {
    fn at(&self, time_s: f64) -> Geodetic {
        let normal = self.vertical.at(time_s).truncate();
        Geodetic {
            lat_rad: normal.z.atan2(normal.x.hypot(normal.y)),
            lon_rad: normal.y.atan2(normal.x),
            height_m: self.ln_height.at(time_s).exp(),
        }
    }
}

impl CameraPath {
    /// The course of a scene's camera.
    pub fn new(scene: &Scene) -> Self {
        let camera = &scene.camera;
        let shots = camera.keys.chunk_by(|_, next| !next.cut);
        let shots = shots.map(|keys| (keys[0].time_s, Shot::new(camera, keys)));
        let mut shots: Vec<_> = shots.collect();
        if shots.is_empty() {
            shots.push((0.0, Shot::new(camera, &[])));
        }
        Self {
            start: scene.time.start,
            shots,
        }
    }

    /// The number of the shot of an instant, from 0.
    pub fn shot_number(&self, epoch: Epoch) -> usize {
        let time_s = self.time_s(epoch);
        let begun = self.shots.partition_point(|(from, _)| *from <= time_s);
        begun.saturating_sub(1)
    }

    /// The shot of an instant, and the time, seconds after the start.
    fn shot(&self, epoch: Epoch) -> (&Shot, f64) {
        (&self.shots[self.shot_number(epoch)].1, self.time_s(epoch))
    }

    fn time_s(&self, epoch: Epoch) -> f64 {
        (epoch - self.start).to_seconds()
    }

    /// Above the ground.
    pub fn ground_pose(&self, epoch: Epoch, ellipsoid: &Ellipsoid) -> Pose {
        let (shot, time_s) = self.shot(epoch);
        shot.ground_pose(time_s, ellipsoid)
    }

    /// About the satellite, looking at it, the Earth below; `None` where no offset is keyed.
    pub fn chase_pose(
        &self,
        epoch: Epoch,
        motion: &OrbitalMotion,
        ellipsoid: &Ellipsoid,
    ) -> Option<Pose> {
        let (shot, time_s) = self.shot(epoch);
        shot.chase_pose(time_s, motion, ellipsoid)
    }

    /// The user's head turn as set by keyframes, and the camera's roll.
    pub fn turned(&self, epoch: Epoch, pose: Pose) -> Pose {
        let (shot, time_s) = self.shot(epoch);
        shot.turned(time_s, pose)
    }

    /// Vertical field of view.
    pub fn fov_rad(&self, epoch: Epoch) -> f64 {
        let (shot, time_s) = self.shot(epoch);
        shot.fov_rad(time_s)
    }

    /// The exposure value, where it is keyed.
    pub fn exposure_ev(&self, epoch: Epoch) -> Option<f64> {
        let (shot, time_s) = self.shot(epoch);
        Some(shot.exposure_ev.as_ref()?.at(time_s))
    }
}

impl Shot {
    /// A path through these keyframes of the camera.
    fn new(camera: &Camera, keys: &[CameraKey]) -> Self {
        let degrees =
            |[lat, lon, height_km]: [f64; 3]| Geodetic::from_degrees(lat, lon, height_km * 1e3);
        let places = of(keys, |key| key.place.map(degrees));
        let offsets = of(keys, |key| key.offset_m.map(DVec3::from));
        let mut shot = Self {
            place: place_track(&places),
            facing: None,
            turn: SphereTrack::of_attitudes(&of(keys, |key| key.turn_deg.map(head_turn))),
            roll_rad: NumberTrack::new(&of(keys, |key| key.roll_deg.map(f64::to_radians))),
            offset: offset_track(&offsets),
            ln_half_fov: NumberTrack::new(&of(keys, |key| {
                key.fov_deg.map(|deg| (0.5 * deg.to_radians()).tan().ln())
            })),
            exposure_ev: NumberTrack::new(&of(keys, |key| key.exposure_ev)),
            camera: camera.clone(),
        };
        shot.facing = shot.facing_track(keys);
        shot
    }

    fn facing_track(&self, keys: &[CameraKey]) -> Option<FacingTrack> {
        let keys = of(keys, |key| key.facing_deg);
        let places = keys
            .iter()
            .map(|(time_s, facing)| (*time_s, *facing, self.place(*time_s)));
        let places: Vec<_> = places.collect();
        let verticals = places.iter().map(|(_, _, place)| vertical(place));
        // The middle of them: its opposite, where carrying has no shortest way, is far from all.
        let from = verticals.sum::<DVec3>().try_normalize();
        let from = from.or_else(|| places.first().map(|(_, _, place)| vertical(place)))?;
        let attitudes: Vec<_> = places
            .iter()
            .map(|(time_s, [heading_deg, pitch_deg], place)| {
                // The eye's distance from the Earth's centre does not affect its viewing direction.
                let pose = Pose::geodetic(*place, &Ellipsoid::WGS84)
                    .facing(heading_deg.to_radians(), pitch_deg.to_radians());
                let carried = DQuat::from_rotation_arc(from, vertical(place));
                (*time_s, carried.inverse() * attitude(&pose))
            })
            .collect();
        Some(FacingTrack {
            from,
            attitude: SphereTrack::of_attitudes(&attitudes)?,
        })
    }

    fn place(&self, time_s: f64) -> Geodetic {
        let camera = &self.camera;
        match &self.place {
            Some(track) => track.at(time_s),
            None => Geodetic::from_degrees(camera.lat_deg, camera.lon_deg, camera.height_km * 1e3),
        }
    }

    fn ground_pose(&self, time_s: f64, ellipsoid: &Ellipsoid) -> Pose {
        let place = self.place(time_s);
        let level = Pose::geodetic(place, ellipsoid);
        let Some(facing) = &self.facing else {
            let camera = &self.camera;
            return level.facing(
                camera.heading_deg.to_radians(),
                camera.pitch_deg.to_radians(),
            );
        };
        let carried = DQuat::from_rotation_arc(facing.from, vertical(&place));
        with_attitude(
            level.eye_itrf_m,
            carried * DQuat::from_vec4(facing.attitude.at(time_s)),
        )
    }

    fn chase_pose(
        &self,
        time_s: f64,
        motion: &OrbitalMotion,
        ellipsoid: &Ellipsoid,
    ) -> Option<Pose> {
        let (direction, ln_length) = self.offset.as_ref()?;
        let itrf_from_level = motion.itrf_from_level(ellipsoid);
        let away = itrf_from_level * direction.at(time_s).truncate();
        let (ahead, down) = (itrf_from_level.x_axis, itrf_from_level.z_axis);
        // Straight above or below the satellite the direction of flight is upwards.
        let up = (-down).reject_from_normalized(away);
        let up = if up.length() > 1e-9 {
            up
        } else {
            ahead.reject_from_normalized(away)
        };
        Some(Pose {
            eye_itrf_m: motion.position_itrf_m + away * ln_length.at(time_s).exp(),
            forward: -away,
            up: up.normalize_or(ahead),
        })
    }

    fn turned(&self, time_s: f64, pose: Pose) -> Pose {
        let pose = match &self.turn {
            None => pose,
            Some(turn) => {
                let turn = DQuat::from_vec4(turn.at(time_s));
                with_attitude(pose.eye_itrf_m, attitude(&pose) * turn)
            }
        };
        match (&self.roll_rad, self.camera.roll_deg) {
            (Some(track), _) => pose.rolled(track.at(time_s)),
            // Exact if there is no roll.
            (None, 0.0) => pose,
            (None, roll_deg) => pose.rolled(roll_deg.to_radians()),
        }
    }

    fn fov_rad(&self, time_s: f64) -> f64 {
        match &self.ln_half_fov {
            Some(track) => 2.0 * track.at(time_s).exp().atan(),
            None => self.camera.fov_deg.to_radians(),
        }
    }
}

/// Times and values of the keys that set something.
fn of<T>(keys: &[CameraKey], value: impl Fn(&CameraKey) -> Option<T>) -> Vec<(f64, T)> {
    let set = keys
        .iter()
        .filter_map(|key| Some((key.time_s, value(key)?)));
    set.collect()
}

fn vertical(place: &Geodetic) -> DVec3 {
    Ellipsoid::normal(place.lat_rad, place.lon_rad)
}

fn place_track(places: &[(f64, Geodetic)]) -> Option<PlaceTrack> {
    let verticals: Vec<_> = places
        .iter()
        .map(|(time_s, place)| (*time_s, vertical(place).extend(0.0)))
        .collect();
    let heights: Vec<_> = places
        .iter()
        .map(|(time_s, place)| (*time_s, place.height_m.ln()))
        .collect();
    Some(PlaceTrack {
        vertical: SphereTrack::new(&verticals)?,
        ln_height: NumberTrack::new(&heights)?,
    })
}

fn offset_track(offsets: &[(f64, DVec3)]) -> Option<(SphereTrack, NumberTrack)> {
    let directions: Vec<_> = offsets
        .iter()
        .map(|(time_s, offset)| (*time_s, offset.normalize_or(DVec3::NEG_X).extend(0.0)))
        .collect();
    let lengths: Vec<_> = offsets
        .iter()
        .map(|(time_s, offset)| (*time_s, offset.length().ln()))
        .collect();
    Some((SphereTrack::new(&directions)?, NumberTrack::new(&lengths)?))
}

/// A turn of the head, in the axes of the view: x right, y up, −z forward.
fn head_turn([yaw_deg, pitch_deg]: [f64; 2]) -> DQuat {
    let ahead = Pose {
        eye_itrf_m: DVec3::ZERO,
        forward: DVec3::NEG_Z,
        up: DVec3::Y,
    };
    attitude(&ahead.turned(&HeadTurn {
        zoom: 1.0,
        yaw_rad: yaw_deg.to_radians(),
        pitch_rad: pitch_deg.to_radians(),
    }))
}

/// The rotation from the view's axes to ITRF.
fn attitude(pose: &Pose) -> DQuat {
    let right = pose.forward.cross(pose.up);
    DQuat::from_mat3(&DMat3::from_cols(right, pose.up, -pose.forward))
}

fn with_attitude(eye_itrf_m: DVec3, attitude: DQuat) -> Pose {
    Pose {
        eye_itrf_m,
        forward: attitude * DVec3::NEG_Z,
        up: attitude * DVec3::Y,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hifitime::Unit;

    fn path(camera: &str) -> CameraPath {
        let scene = Scene::from_toml(&format!("[camera]\n{camera}"), "a.toml".as_ref());
        CameraPath::new(&scene.unwrap_or_else(|error| panic!("{error}")))
    }

    fn pose_at(path: &CameraPath, time_s: f64) -> (Pose, Geodetic) {
        let epoch = path.start + time_s * Unit::Second;
        (
            path.ground_pose(epoch, &Ellipsoid::WGS84),
            path.shot(epoch).0.place(time_s),
        )
    }

    const DOWN: &str = "
        [[camera.keys]]\ntime_s = 0\nlat_deg = 50\nlon_deg = 10\nheight_km = 1000\nheading_deg = 0\npitch_deg = -90
        [[camera.keys]]\ntime_s = 10\nlat_deg = 80\nlon_deg = 120\nheight_km = 10\nheading_deg = 40\npitch_deg = -90
        [[camera.keys]]\ntime_s = 30\nlat_deg = 60\nlon_deg = -120\nheight_km = 500\nheading_deg = 0\npitch_deg = -90\n";

    #[test]
    fn keys_are_met_exactly() {
        let path = path(DOWN);
        for (time_s, [lat, lon, height_km], heading) in [
            (-1.0, [50.0, 10.0, 1000.0], 0.0_f64),
            (0.0, [50.0, 10.0, 1000.0], 0.0),
            (10.0, [80.0, 120.0, 10.0], 40.0),
            (30.0, [60.0, -120.0, 500.0], 0.0),
            (99.0, [60.0, -120.0, 500.0], 0.0),
        ] {
            let (pose, _) = pose_at(&path, time_s);
            let place = Geodetic::from_degrees(lat, lon, height_km * 1e3);
            let wanted = Pose::geodetic(place, &Ellipsoid::WGS84)
                .facing(heading.to_radians(), -90_f64.to_radians());
            assert!(
                (pose.eye_itrf_m - wanted.eye_itrf_m).length() < 1e-6,
                "{time_s}"
            );
            assert!((pose.forward - wanted.forward).length() < 1e-9, "{time_s}");
            assert!((pose.up - wanted.up).length() < 1e-9, "{time_s}");
        }
    }

    #[test]
    fn nothing_goes_over_a_cut() {
        let path = path(
            "fov_deg = 40\n
            [[camera.keys]]\ntime_s = 0\nlat_deg = 50\nlon_deg = 10\nheight_km = 1000
            [[camera.keys]]\ntime_s = 10\nlat_deg = 52\nlon_deg = 10\nheight_km = 1000\nfov_deg = 60
            [[camera.keys]]\ntime_s = 20\ncut = true\nlat_deg = -30\nlon_deg = -170\nheight_km = 5
            [[camera.keys]]\ntime_s = 30\nlat_deg = -32\nlon_deg = -170\nheight_km = 5\n",
        );
        let at = |time_s: f64| path.start + time_s * Unit::Second;
        let lat_deg = |time_s| pose_at(&path, time_s).1.lat_rad.to_degrees();
        // Before the cut the camera stays at the last keyframe; after it, it is at the next immediately.
        for (time_s, wanted) in [(5.0, 51.0), (19.999, 52.0), (20.0, -30.0), (25.0, -31.0)] {
            assert!((lat_deg(time_s) - wanted).abs() < 1e-6, "{time_s}");
        }
        // A quantity without a keyframe in the shot has the camera's own value.
        for (time_s, wanted) in [(19.0, 60.0), (20.0, 40.0)] {
            let fov_deg = path.fov_rad(at(time_s)).to_degrees();
            assert!((fov_deg - wanted).abs() < 1e-9, "{time_s}: {fov_deg}");
        }
    }

    /// Straight down at all keys is straight down between them, near the pole too; never below the ground.
    #[test]
    fn what_looks_down_at_keys_looks_down_between_them() {
        let path = path(DOWN);
        let mut before: Option<Pose> = None;
        for n in 0..=3000 {
            let (pose, place) = pose_at(&path, f64::from(n) * 0.01);
            assert!((pose.forward + vertical(&place)).length() < 1e-9, "{n}");
            assert!((9_999.0..=1_000_001.0).contains(&place.height_m), "{n}");
            if let Some(before) = before {
                assert!(
                    (pose.up - before.up).length() < 0.02,
                    "{n}: nothing turns about"
                );
                assert!((pose.eye_itrf_m - before.eye_itrf_m).length() < 2e4, "{n}");
            }
            before = Some(pose);
        }
    }

    #[test]
    fn a_level_camera_stays_level() {
        let path = path(
            "[[camera.keys]]\ntime_s = 0\nlat_deg = 46\nlon_deg = 7\nheight_km = 6\nheading_deg = 0\npitch_deg = -12
             [[camera.keys]]\ntime_s = 60\nheading_deg = 150\npitch_deg = -12\n",
        );
        for n in 0..=60 {
            let (pose, place) = pose_at(&path, f64::from(n));
            assert!((pose.forward.dot(vertical(&place)) + 12_f64.to_radians().sin()).abs() < 1e-12);
            let right = pose.forward.cross(pose.up);
            assert!(
                right.dot(vertical(&place)).abs() < 1e-12,
                "the horizon is level"
            );
        }
    }

    #[test]
    fn view_and_exposure_are_keyed_each_by_itself() {
        let path = path(
            "fov_deg = 50\nmode = \"nadir\"
             [[camera.keys]]\ntime_s = 0\nfov_deg = 40
             [[camera.keys]]\ntime_s = 10\nexposure_ev = -2
             [[camera.keys]]\ntime_s = 20\nfov_deg = 10
             [[camera.keys]]\ntime_s = 30\nexposure_ev = 2\nyaw_deg = 20\npitch_deg = 0\n",
        );
        let at = |time_s: f64| path.start + time_s * Unit::Second;
        let fov = |time_s| path.fov_rad(at(time_s)).to_degrees();
        assert!((fov(0.0) - 40.0).abs() < 1e-12 && (fov(25.0) - 10.0).abs() < 1e-12);
        let half = |deg: f64| (0.5 * deg.to_radians()).tan();
        assert!((half(fov(10.0)) - (half(40.0) * half(10.0)).sqrt()).abs() < 1e-12);
        let ev = |time_s| path.exposure_ev(at(time_s)).expect("keyed");
        assert_eq!((ev(0.0), ev(20.0), ev(31.0)), (-2.0, 0.0, 2.0));
        // One key turns the head for all of the flight.
        let nadir = Pose {
            eye_itrf_m: DVec3::X * 7e6,
            forward: DVec3::NEG_X,
            up: DVec3::Z,
        };
        let turned = path.turned(at(0.0), nadir);
        let wanted = nadir.turned(&HeadTurn {
            yaw_rad: 20_f64.to_radians(),
            ..HeadTurn::default()
        });
        assert!((turned.forward - wanted.forward).length() < 1e-12);
        assert!((turned.up - wanted.up).length() < 1e-12);
    }

    #[test]
    fn an_offset_circles_the_satellite() {
        let path = path(
            "mode = \"chase\"
             [[camera.keys]]\ntime_s = 0\noffset_m = [-40, 0, -10]
             [[camera.keys]]\ntime_s = 10\noffset_m = [0, 80, 0]\n",
        );
        let motion = OrbitalMotion {
            position_itrf_m: DVec3::X * 7e6,
            velocity_m_s: DVec3::Y * 7e3,
        };
        let mut last_m = 0.0;
        for n in 0..=10 {
            let epoch = path.start + f64::from(n) * Unit::Second;
            let pose = path
                .chase_pose(epoch, &motion, &Ellipsoid::WGS84)
                .expect("keyed");
            let away = pose.eye_itrf_m - motion.position_itrf_m;
            assert!(
                (away.normalize() + pose.forward).length() < 1e-8,
                "looks at it"
            );
            assert!(
                away.length() > last_m && pose.up.x > 0.9,
                "the Earth is below"
            );
            last_m = away.length();
            if n == 0 {
                // Behind, flying along +y, and above, +x.
                assert!(
                    (away - DVec3::new(10.0, -40.0, 0.0)).length() < 1e-6,
                    "{away}"
                );
            }
        }
        assert!((last_m - 80.0).abs() < 1e-6);
    }
}
