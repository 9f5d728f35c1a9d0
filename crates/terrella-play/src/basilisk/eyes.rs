//! The window's view of a simulation before it has a spacecraft, and the views of the simulation's own cameras.

use super::moments::{sky, turn};
use crate::camera::{HeadTurn, OrbitalMotion, Pose};
use crate::craft::CraftPose;
use crate::flight::{Flight, Moment, ViewRequest};
use crate::scene::CameraMode;
use glam::DMat3;
use terrella_orbit::basilisk::{Camera, Snapshot, camera_pose};

/// Craft farther than this from a camera are less than a pixel.
const CRAFT_RANGE_M: f64 = 50e3;

impl Flight {
    /// The view where no craft is known: above the place of a geodetic camera, under the simulation's sky once there is one.
    pub(crate) fn simulated_alone(
        &self,
        snapshot: Option<&Snapshot>,
        request: &ViewRequest,
    ) -> Moment {
        let request = ViewRequest {
            mode: CameraMode::Geodetic,
            ..*request
        };
        let alone = snapshot.and_then(|snapshot| self.simulated(snapshot, &request).ok());
        alone.unwrap_or_else(|| self.without_satellite(self.scene().time.start, &request))
    }

    /// The view of a simulation's camera, or why it has none. Of other spacecraft only the nearest is drawn.
    pub(super) fn seen_by(
        &self,
        snapshot: &Snapshot,
        camera: &Camera,
        size: (u32, u32),
    ) -> Result<Moment, String> {
        let id = camera.id;
        let parent = snapshot.craft(Some(&camera.parent));
        let parent = parent.ok_or_else(|| {
            let parent = &camera.parent;
            format!("camera {id} is on {parent:?}, which the simulation does not have")
        })?;
        let fov_deg = camera.fov_deg;
        if !(0.001..179.0).contains(&fov_deg) {
            return Err(format!(
                "camera {id} has a field of view of {fov_deg}°, which cannot be drawn"
            ));
        }
        let pose = camera_pose(camera, parent)
            .ok_or_else(|| format!("camera {id} has a place or an attitude that is not finite"))?;
        let itrf_from_gcrf = snapshot.itrf_from_gcrf;
        let eye_itrf_m = itrf_from_gcrf * pose.position_m;
        if (eye_itrf_m * self.ellipsoid().scaled_from_itrf()).length() <= 1.0 {
            return Err(format!("camera {id} is below the ground"));
        }
        let state = OrbitalMotion {
            position_itrf_m: itrf_from_gcrf * parent.position_m,
            velocity_m_s: itrf_from_gcrf * parent.velocity_m_s,
        };
        let pose = Pose {
            eye_itrf_m,
            forward: itrf_from_gcrf * pose.forward,
            up: itrf_from_gcrf * pose.up,
        };
        let aspect = f64::from(size.0) / f64::from(size.1);
        let request = ViewRequest {
            // A camera at the spacecraft's position, but not attached to it.
            mode: CameraMode::Nadir,
            look: HeadTurn::default(),
            aspect,
        };
        let sky = sky(snapshot);
        let moment = self.moment_under(snapshot.epoch, &request, pose, Some(state), sky);
        let others = snapshot.craft.iter().filter(|one| one.name != parent.name);
        let range_m = |one: &&terrella_orbit::basilisk::CraftState| {
            (itrf_from_gcrf * one.position_m - eye_itrf_m).length()
        };
        let nearest = others.min_by(|a, b| range_m(a).total_cmp(&range_m(b)));
        let nearest = nearest.filter(|one| range_m(one) < CRAFT_RANGE_M);
        Ok(Moment {
            view: pose.view(fov_deg.to_radians(), aspect),
            turn: Some(turn(snapshot)),
            is_starless: camera.is_sky_black(snapshot.is_sky_black),
            craft: nearest.map(|one| {
                let motion = OrbitalMotion {
                    position_itrf_m: itrf_from_gcrf * one.position_m,
                    velocity_m_s: itrf_from_gcrf * one.velocity_m_s,
                };
                CraftPose {
                    itrf_from_craft: itrf_from_gcrf * DMat3::from_quat(one.inertial_from_body),
                    ..CraftPose::new(&motion, self.ellipsoid(), &sky)
                }
            }),
            ..moment
        })
    }
}
