//! Instants of a simulation as moments of a flight: where the eye is, what lights the Earth, how it stands.

use crate::Sky;
use crate::basilisk::{Camera, Recording, Simulation, Snapshot, camera_pose};
use crate::frames::{EARTH_ROTATION_RATE_RAD_S, Epoch};
use crate::play::camera::{Look, OrbitalMotion, Pose};
use crate::play::craft::CraftPose;
use crate::play::error::PlayError;
use crate::play::flight::{Flight, Moment, ViewRequest};
use crate::scene::CameraMode;
use crate::tracks::EarthTurn;
use glam::DMat3;
use std::sync::Arc;

/// Craft farther than this from a camera are less than a pixel.
const CRAFT_RANGE_M: f64 = 50e3;

/// What lights the Earth at an instant of a simulation, as the simulation says it.
fn sky(snapshot: &Snapshot) -> Sky {
    let itrf_from_gcrf = snapshot.itrf_from_gcrf;
    let sun_m = itrf_from_gcrf * snapshot.sun_m;
    Sky {
        sun_itrf: sun_m.normalize(),
        sun_distance_m: sun_m.length(),
        moon_itrf_m: Some(itrf_from_gcrf * snapshot.moon_m),
        itrf_from_gcrf: Some(itrf_from_gcrf),
    }
}

fn turn(snapshot: &Snapshot) -> EarthTurn {
    EarthTurn {
        itrf_from_gcrf: snapshot.itrf_from_gcrf,
        rate_rad_s: if snapshot.turns {
            EARTH_ROTATION_RATE_RAD_S
        } else {
            0.0
        },
    }
}

impl Flight {
    /// The simulation that this flight shows, if it runs meanwhile.
    pub fn simulation(&self) -> Option<&Simulation> {
        self.satellites()
            .iter()
            .find_map(|one| one.simulation())
            .map(Arc::as_ref)
    }

    /// The same, to be kept beside the flight.
    pub(crate) fn shared_simulation(&self) -> Option<Arc<Simulation>> {
        let mut satellites = self.satellites().iter();
        satellites.find_map(|one| one.simulation()).cloned()
    }

    /// The view of an instant of a simulation that was saved; `None` for flights that are no such.
    pub(crate) fn recorded(
        &self,
        epoch: Epoch,
        request: &ViewRequest,
    ) -> Option<Result<Moment, PlayError>> {
        let recording = self.recording()?;
        Some(match recording.snapshot_at(epoch) {
            Ok(Some(snapshot)) => self.simulated(&snapshot, request),
            Ok(None) => {
                // The feed's words for it: from when to when it is known.
                let unknown = self.feed().and_then(|feed| feed.state_at(epoch).err());
                Err(unknown.map_or(PlayError::NoSatellite, PlayError::from))
            }
            Err(error) => Err(error.into()),
        })
    }

    /// The saved simulation that this flight shows.
    pub(crate) fn recording(&self) -> Option<&Arc<Recording>> {
        self.satellites().iter().find_map(|one| one.recording())
    }

    /// The view of an instant of a simulation.
    ///
    /// # Errors
    /// Without the craft that cameras fly with, a view that needs it.
    pub(crate) fn simulated(
        &self,
        snapshot: &Snapshot,
        request: &ViewRequest,
    ) -> Result<Moment, PlayError> {
        let wanted = self.simulated_craft();
        let craft = snapshot.craft(wanted);
        if let (None, Some(wanted), Some(simulation)) = (craft, wanted, self.simulation()) {
            let names: Vec<_> = snapshot
                .craft
                .iter()
                .take(10)
                .map(|one| &*one.name)
                .collect();
            simulation.tell(format!(
                "the simulation has no spacecraft {wanted:?}, which [orbit] name asks for; it has {names:?}"
            ));
        }
        let itrf_from_gcrf = snapshot.itrf_from_gcrf;
        let state = craft.map(|craft| OrbitalMotion {
            position_itrf_m: itrf_from_gcrf * craft.position_m,
            velocity_m_s: itrf_from_gcrf * craft.velocity_m_s,
        });
        let pose = self.pose(request.mode, state.as_ref())?;
        let mut moment = self.moment_under(snapshot.epoch, request, pose, state, sky(snapshot));
        moment.turn = Some(turn(snapshot));
        if let (Some(drawn), Some(craft)) = (&mut moment.craft, craft) {
            drawn.itrf_from_craft = itrf_from_gcrf * DMat3::from_quat(craft.inertial_from_body);
        }
        Ok(moment)
    }

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

    /// The name of the craft that cameras fly with, where the scene gives one.
    fn simulated_craft(&self) -> Option<&str> {
        self.scene().orbits.first()?.name.as_deref()
    }

    /// What a camera of the simulation sees, or why it sees nothing. Of other craft the nearest is drawn.
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
            // What is at the craft and is not the craft.
            mode: CameraMode::Nadir,
            look: Look::default(),
            aspect,
        };
        let sky = sky(snapshot);
        let moment = self.moment_under(snapshot.epoch, &request, pose, Some(state), sky);
        let others = snapshot.craft.iter().filter(|one| one.name != parent.name);
        let range_m = |one: &&crate::basilisk::CraftState| {
            (itrf_from_gcrf * one.position_m - eye_itrf_m).length()
        };
        let nearest = others.min_by(|a, b| range_m(a).total_cmp(&range_m(b)));
        let nearest = nearest.filter(|one| range_m(one) < CRAFT_RANGE_M);
        Ok(Moment {
            view: pose.view(fov_deg.to_radians(), aspect),
            turn: Some(turn(snapshot)),
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
