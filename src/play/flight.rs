//! A scene made ready to be played: where the eye is and what lights it at any instant.

use super::camera::{Look, Motion, Pose};
use super::craft::CraftPose;
use super::error::PlayError;
use super::maps::{check_pack, earth_options};
use crate::frames::{Ellipsoid, Epoch, Geodetic};
use crate::gpu::BcSupport;
use crate::orbit::{Feed, OrbitState, TleFeed};
use crate::scene::{CameraMode, Orbit, Scene};
use crate::{EarthOptions, EyeView, Sky};

/// A scene with its orbit opened and its dates checked.
pub struct Flight {
    scene: Scene,
    feed: Option<Box<dyn Feed>>,
    ellipsoid: Ellipsoid,
}

/// How one picture of an instant is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewRequest {
    /// The camera.
    pub mode: CameraMode,
    /// What the user changed about it.
    pub look: Look,
    /// Width over height of the picture.
    pub aspect: f64,
}

/// One instant of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// When.
    pub epoch: Epoch,
    /// Where the eye is and what it sees.
    pub view: EyeView,
    /// What lights the Earth.
    pub sky: Sky,
    /// Where the satellite is, if there is one.
    pub satellite: Option<Satellite>,
    /// The spacecraft to draw, if the camera looks at it.
    pub craft: Option<CraftPose>,
}

/// A satellite at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Satellite {
    /// Its place above the scene's figure.
    pub place: Geodetic,
    /// Its speed seen from the stars, metres per second.
    pub speed_m_s: f64,
}

impl Flight {
    /// Opens the scene's orbit and checks that it answers for all of the scene's dates, and that its pack, if it has
    /// one, holds what it asks for.
    pub fn open(scene: Scene) -> Result<Self, PlayError> {
        check_pack(&scene)?;
        let feed = match &scene.orbit {
            Some(orbit) => Some(open_feed(orbit)?),
            None => None,
        };
        if let Some(feed) = &feed {
            scene.check_dates(feed.validity())?;
        }
        Ok(Self {
            ellipsoid: scene.earth.figure.ellipsoid(),
            scene,
            feed,
        })
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The satellite's motion.
    pub fn feed(&self) -> Option<&dyn Feed> {
        self.feed.as_deref()
    }

    /// The cameras that this scene can be seen with, in the order in which the window offers them.
    pub fn camera_modes(&self) -> &'static [CameraMode] {
        use CameraMode::{Chase, Geodetic, Horizon, Nadir};
        match self.feed {
            Some(_) => &[Nadir, Horizon, Chase, Geodetic],
            None => &[Geodetic],
        }
    }

    /// The view as the scene asks for it. `aspect` is width over height.
    pub fn at(&self, epoch: Epoch, aspect: f64) -> Result<Moment, PlayError> {
        let request = ViewRequest {
            mode: self.scene.camera.mode,
            look: Look::default(),
            aspect,
        };
        self.view_at(epoch, &request)
    }

    /// The view of an instant.
    pub fn view_at(&self, epoch: Epoch, request: &ViewRequest) -> Result<Moment, PlayError> {
        let state = match &self.feed {
            Some(feed) => Some(feed.state_at(epoch)?),
            None => None,
        };
        let camera = &self.scene.camera;
        let fov_rad = request.look.fov_rad(camera.fov_deg.to_radians());
        let pose = match (request.mode, &state) {
            (CameraMode::Geodetic, _) => {
                let height_m = camera.height_km * 1000.0;
                let place = Geodetic::from_degrees(camera.lat_deg, camera.lon_deg, height_m);
                Pose::geodetic(place, &self.ellipsoid)
            }
            (_, None) => return Err(PlayError::NoSatellite),
            (CameraMode::Nadir, Some(state)) => {
                Pose::nadir(&motion(state), camera.up, &self.ellipsoid)
            }
            (CameraMode::Horizon, Some(state)) => {
                // The scene's own field of view, so that zooming keeps its centre.
                Pose::horizon(&motion(state), &self.ellipsoid, camera.fov_deg.to_radians())
            }
            (CameraMode::Chase, Some(state)) => Pose::chase(&motion(state), &self.ellipsoid),
        };
        let sky = Sky::at(epoch);
        let craft = match (request.mode, &state) {
            (CameraMode::Chase, Some(state)) => {
                Some(CraftPose::new(&motion(state), &self.ellipsoid, &sky))
            }
            _ => None,
        };
        Ok(Moment {
            epoch,
            view: pose.turned(&request.look).view(fov_rad, request.aspect),
            sky,
            craft,
            satellite: state.map(|state| Satellite {
                place: self.ellipsoid.geodetic_from_itrf(state.position_itrf_m()),
                speed_m_s: state.inertial_velocity_itrf_axes_m_s().length(),
            }),
        })
    }

    /// Loads the maps that the scene wants and no others, and gathers its options. `bc` is what the adapter does with
    /// compressed textures; it matters to packs alone.
    pub fn earth_options(&self, bc: BcSupport) -> Result<EarthOptions, PlayError> {
        earth_options(&self.scene, bc)
    }
}

fn open_feed(orbit: &Orbit) -> Result<Box<dyn Feed>, PlayError> {
    Ok(Box::new(match &orbit.file {
        Some(file) => TleFeed::from_file(file, orbit.name.as_deref())?,
        None => TleFeed::built_in_iss()?,
    }))
}

fn motion(state: &OrbitState) -> Motion {
    Motion {
        position_itrf_m: state.position_itrf_m(),
        velocity_m_s: state.inertial_velocity_itrf_axes_m_s(),
    }
}
