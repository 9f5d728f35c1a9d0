//! A scene prepared for playback: the eye and the sky at any time.

use super::attitude::AttitudeMoment;
use super::camera::{HeadTurn, OrbitalMotion, Pose};
use super::camera_path::CameraPath;
use super::caption_image::check_images;
use super::coverage_cells::SharedCoverage;
use super::craft::CraftPose;
use super::craft_models::CraftModels;
use super::error::PlayError;
use super::geo_layers::geo_layers;
use super::look_target::LookTarget;
use super::map_lines::dropped_lines;
use super::maps::{
    DroppedLayer, check_pack, dropped_layers, earth_options, earth_options_at, uploaded_options_at,
};
use super::opening::open_all;
use super::place_text::GroundPlace;
use super::satellites::{Listener, Satellite, orientation_at};
use super::sky_parts::dropped_parts;
use crate::scene::{CameraMode, Ending, Scene, Time};
use glam::DVec3;
use terrella::frames::{
    EarthOrientation, Ellipsoid, Epoch, Geodetic, Illumination, Orientation, illumination,
};
use terrella::internals::gpu::BcSupport;
use terrella::tracks::EarthTurn;
use terrella::{EarthOptions, EyeView, GpuContext, Sky};
use terrella_orbit::{Feed, Frame, OrbitError, OrbitState};

/// A scene with its satellites opened and its dates checked.
pub struct Flight {
    scene: Scene,
    satellites: Vec<Satellite>,
    /// The one of `satellites` that cameras fly with.
    followed: usize,
    /// The first of them that a running simulation moves, and the first of a saved one. They are found once, as each frame asks for them.
    pub(crate) simulated: Option<usize>,
    pub(crate) recorded: Option<usize>,
    /// Whether a simulator sends the states of any.
    is_live: bool,
    models: CraftModels,
    orientation: Option<EarthOrientation>,
    ellipsoid: Ellipsoid,
    /// Motion of the scene's camera over time.
    path: CameraPath,
    look_target: Option<LookTarget>,
    coverage: SharedCoverage,
}

/// How one picture of an instant is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewRequest {
    /// The camera.
    pub mode: CameraMode,
    /// Changes of the view by the user.
    pub look: HeadTurn,
    /// Width over height of the picture.
    pub aspect: f64,
}

/// One instant of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Epoch of the picture.
    pub epoch: Epoch,
    /// The number of the scene's frame that is nearest to it, by which grain differs from frame to frame.
    pub frame: u32,
    /// Position and view of the eye.
    pub view: EyeView,
    /// Sun, Moon and stars.
    pub sky: Sky,
    /// Where the satellite is, if there is one.
    pub satellite: Option<SatelliteState>,
    /// The spacecraft to draw, if the camera looks at it.
    pub craft: Option<CraftPose>,
    /// Velocity of the eye relative to the Earth's centre, metres a second, in non-rotating axes that are aligned with ITRF at this time; `None`
    /// for an eye at rest over the ground.
    pub eye_velocity_m_s: Option<DVec3>,
    /// Orientation and rotation of the Earth if a simulation sets them instead of the date.
    pub turn: Option<EarthTurn>,
    /// Whether stars and Milky Way are hidden, as a simulation may request.
    pub is_starless: bool,
    /// The exposure value of the instant, where the scene keys it.
    pub exposure_ev: Option<f64>,
    /// The number of the shot, from 0: each cut of the camera begins one.
    pub shot: usize,
}

/// A satellite at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SatelliteState {
    /// Its place above the scene's figure.
    pub place: Geodetic,
    /// Its speed seen from the stars, metres per second.
    pub speed_m_s: f64,
    /// How much of the Sun is visible at the satellite: its class, and the fraction of the disc, 0…1.
    pub illumination: (Illumination, f64),
    /// Uncertainty of the position, metres (one standard deviation), if the satellite's source has it.
    pub error_m: Option<f64>,
}

impl Flight {
    /// Opens the scene's satellites and checks that the followed one has states for all of the scene's dates, and that its pack, if any, has the
    /// requested content. A scene without a start begins at its satellite's own time, if that has one ([`Scene::begin_at`]). A default duration is
    /// shortened to the satellite's validity. Where the built-in satellite's elements are not valid, a stand-in replaces it ([`Scene::notices`]).
    /// Live satellites start to listen; with any of them, the simulators control the time and the scene's dates are not checked.
    pub fn open(scene: Scene) -> Result<Self, PlayError> {
        Self::open_with(scene, Listener::Open)
    }

    /// The same without listening: live satellites are never known. For looking at a scene.
    pub fn open_without_listening(scene: Scene) -> Result<Self, PlayError> {
        Self::open_with(scene, Listener::Closed)
    }

    fn open_with(mut scene: Scene, listener: Listener) -> Result<Self, PlayError> {
        check_pack(&scene)?;
        check_images(&scene)?;
        let orientation = match &scene.time.orientation {
            Some(file) => Some(EarthOrientation::from_file(file)?),
            None => None,
        };
        let satellites = open_all(&mut scene, orientation.as_ref(), listener)?;
        let models = CraftModels::open(&scene)?;
        let names: Vec<_> = satellites.iter().map(Satellite::name).collect();
        let followed = scene.followed(&names)?;
        let look_target = LookTarget::of(&scene, &names, followed)?;
        scene.coverage_satellites(&names)?;
        if let Some(satellite) = satellites.get(followed)
            && !scene.is_live()
        {
            let ellipsoid = scene.earth.figure.ellipsoid();
            let impact = impact(satellite.feed(), orientation.as_ref(), &ellipsoid);
            let (validity, gap) = known_around(satellite.feed(), &scene.time);
            let ending = impact
                .map(|(_, place)| Ending::Impact(place.to_string()))
                .filter(|_| gap.is_none())
                .or(gap)
                .or_else(|| decay(satellite.feed()));
            scene.shorten(validity, ending.as_ref());
            scene.check_dates(validity, ending.as_ref())?;
            scene.leave_out(&satellite.feed().gaps());
            let (start, end) = (scene.time.start, scene.time.end());
            models.check_span(start.min(end), start.max(end))?;
        }
        scene.note_late_keyframes();
        for notice in &scene.notices {
            tracing::warn!("{}: {notice}", scene.path.display());
        }
        let position = |is_wanted: fn(&Satellite) -> bool| satellites.iter().position(is_wanted);
        Ok(Self {
            ellipsoid: scene.earth.figure.ellipsoid(),
            path: CameraPath::new(&scene),
            simulated: position(|one| one.simulation().is_some()),
            recorded: position(|one| one.recording().is_some()),
            is_live: scene.is_live(),
            scene,
            satellites,
            followed,
            models,
            orientation,
            look_target,
            coverage: SharedCoverage::default(),
        })
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The motion of the satellite that cameras fly with.
    pub fn feed(&self) -> Option<&dyn Feed> {
        self.satellites.get(self.followed).map(Satellite::feed)
    }

    /// All satellites, in the scene's order.
    pub fn satellites(&self) -> &[Satellite] {
        &self.satellites
    }

    /// The place in [`Self::satellites`] of the one that cameras fly with.
    pub fn followed(&self) -> usize {
        self.followed
    }

    /// The map of its scene's coverage, once it is computed.
    pub(super) fn coverage(&self) -> &SharedCoverage {
        &self.coverage
    }

    /// The models of the satellites.
    pub(super) fn craft_models(&self) -> &CraftModels {
        &self.models
    }

    /// Every satellite's name and its state at a time, in the scene's order. Satellites that are not followed need not be valid for all of the
    /// scene: their error states the validity.
    pub fn states_at(
        &self,
        epoch: Epoch,
    ) -> impl Iterator<Item = (&str, Result<OrbitState, OrbitError>)> {
        self.satellites
            .iter()
            .map(move |satellite| (satellite.name(), satellite.feed().state_at(epoch)))
    }

    /// Motion of a satellite at a time, by its index in [`Self::satellites`].
    ///
    /// # Errors
    /// A time outside its validity.
    pub(super) fn motion_of(
        &self,
        satellite: usize,
        epoch: Epoch,
    ) -> Result<OrbitalMotion, PlayError> {
        let satellite = self.satellites.get(satellite);
        let state = satellite
            .ok_or(PlayError::NoSatellite)?
            .feed()
            .state_at(epoch)?;
        Ok(motion(&state, &self.orientation_at(epoch)))
    }

    /// Time and place of a satellite's impact on the ground, if it is within the validity.
    pub fn impact(&self, satellite: &Satellite) -> Option<(Epoch, GroundPlace)> {
        impact(satellite.feed(), self.orientation.as_ref(), &self.ellipsoid)
    }

    /// The Earth's orientation from the scene's table, which transforms states to Earth-fixed axes. Without a table, or outside it, UT1 = UTC and
    /// polar motion is zero.
    pub fn orientation_at(&self, epoch: Epoch) -> Orientation {
        orientation_at(self.orientation.as_ref(), epoch).unwrap_or_default()
    }

    /// The table of the Earth's orientation, if the scene names one.
    pub fn earth_orientation(&self) -> Option<&EarthOrientation> {
        self.orientation.as_ref()
    }

    /// Sun and Moon at a time, by the scene's table of the Earth's orientation.
    pub fn sky_at(&self, epoch: Epoch) -> Sky {
        Sky::with_orientation(epoch, &self.orientation_at(epoch))
    }

    /// The reference ellipsoid of heights.
    pub fn ellipsoid(&self) -> &Ellipsoid {
        &self.ellipsoid
    }

    /// The cameras that this scene can be seen with, in the order in which the window offers them.
    pub fn camera_modes(&self) -> &'static [CameraMode] {
        use CameraMode::{Chase, Geodetic, Horizon, Nadir};
        match self.feed() {
            Some(_) => &[Nadir, Horizon, Chase, Geodetic],
            None => &[Geodetic],
        }
    }

    /// The view of the scene's camera. `aspect` is width over height.
    pub fn at(&self, epoch: Epoch, aspect: f64) -> Result<Moment, PlayError> {
        let request = ViewRequest {
            mode: self.scene.camera.mode,
            look: HeadTurn::default(),
            aspect,
        };
        self.view_at(epoch, &request)
    }

    /// The view of an instant.
    pub fn view_at(&self, epoch: Epoch, request: &ViewRequest) -> Result<Moment, PlayError> {
        if let Some(simulation) = self.simulation() {
            let latest = simulation.latest().ok_or(PlayError::NoSatellite)?;
            return self.simulated(&latest, request);
        }
        if !self.is_live {
            self.models.check_span(epoch, epoch)?;
        }
        if let Some(moment) = self.recorded(epoch, request) {
            return moment;
        }
        let state = match self.feed().map(|feed| feed.state_at(epoch)) {
            Some(Ok(state)) => Some(motion(&state, &self.orientation_at(epoch))),
            // The ground is there without it, and its simulator may be late.
            Some(Err(_)) if request.mode == CameraMode::Geodetic && self.is_live => None,
            Some(Err(error)) => return Err(error.into()),
            None => None,
        };
        let pose = self.keyed_pose(epoch, request.mode, state.as_ref())?;
        Ok(self.moment(epoch, request, pose, state))
    }

    /// The pose of an instant, by the keys of the scene's camera where it is that one.
    fn keyed_pose(
        &self,
        epoch: Epoch,
        mode: CameraMode,
        state: Option<&OrbitalMotion>,
    ) -> Result<Pose, PlayError> {
        let (path, ellipsoid) = (&self.path, &self.ellipsoid);
        if mode != self.scene.camera.mode {
            return self.pose(mode, state);
        }
        let pose = match (mode, state) {
            (CameraMode::Geodetic, _) => path.ground_pose(epoch, ellipsoid),
            (CameraMode::Chase, Some(state)) => {
                let chased = path.chase_pose(epoch, state, ellipsoid);
                chased.map_or_else(|| self.pose(mode, Some(state)), Ok)?
            }
            (CameraMode::Horizon, Some(state)) => {
                Pose::horizon(state, ellipsoid, path.fov_rad(epoch))
            }
            _ => self.pose(mode, state)?,
        };
        let pose = self.aimed(pose, epoch, state, || self.sky_at(epoch))?;
        Ok(path.turned(epoch, pose))
    }

    /// The pose turned to the camera's target. `state` is the motion of the followed satellite.
    ///
    /// # Errors
    /// The target satellite has no state at that time.
    pub(super) fn aimed(
        &self,
        pose: Pose,
        epoch: Epoch,
        state: Option<&OrbitalMotion>,
        sky: impl FnOnce() -> Sky,
    ) -> Result<Pose, PlayError> {
        let point = match self.look_target {
            None => return Ok(pose),
            Some(LookTarget::Sun) => {
                let sky = sky();
                Some(sky.sun_itrf * sky.sun_distance_m)
            }
            Some(LookTarget::Moon) => sky().moon_itrf_m,
            Some(LookTarget::Followed) => state.map(|state| state.position_itrf_m),
            Some(LookTarget::Other(index)) => match self.motion_of(index, epoch) {
                // Its simulator may be late.
                Err(_) if self.is_live => None,
                motion => Some(motion?.position_itrf_m),
            },
            Some(LookTarget::Point(point)) => Some(point),
        };
        Ok(point.map_or(pose, |point| pose.looking_at(point, self.ellipsoid())))
    }

    /// Position and view of the eye for this motion of a satellite.
    ///
    /// # Errors
    /// A mode that needs a satellite, without one.
    pub(super) fn pose(
        &self,
        mode: CameraMode,
        state: Option<&OrbitalMotion>,
    ) -> Result<Pose, PlayError> {
        let camera = &self.scene.camera;
        Ok(match (mode, state) {
            (CameraMode::Geodetic, _) => self.ground_pose(),
            (_, None) => return Err(PlayError::NoSatellite),
            (CameraMode::Nadir, Some(state)) => Pose::nadir(state, camera.up, &self.ellipsoid),
            (CameraMode::Horizon, Some(state)) => {
                // The scene's own field of view, so that zooming keeps its centre.
                Pose::horizon(state, &self.ellipsoid, camera.fov_deg.to_radians())
            }
            (CameraMode::Chase, Some(state)) => Pose::chase(state, &self.ellipsoid),
        })
    }

    /// Above the scene's place, looking down.
    pub(super) fn ground_pose(&self) -> Pose {
        let camera = &self.scene.camera;
        let height_m = camera.height_km * 1000.0;
        let place = Geodetic::from_degrees(camera.lat_deg, camera.lon_deg, height_m);
        let heading_rad = camera.heading_deg.to_radians();
        let pitch_rad = camera.pitch_deg.to_radians();
        Pose::geodetic(place, &self.ellipsoid).facing(heading_rad, pitch_rad)
    }

    pub(super) fn moment(
        &self,
        epoch: Epoch,
        request: &ViewRequest,
        pose: Pose,
        state: Option<OrbitalMotion>,
    ) -> Moment {
        let sky = self.sky_at(epoch);
        self.moment_under(epoch, request, pose, state, sky)
    }

    /// The same under a sky that is not the date's.
    pub(super) fn moment_under(
        &self,
        epoch: Epoch,
        request: &ViewRequest,
        pose: Pose,
        state: Option<OrbitalMotion>,
        sky: Sky,
    ) -> Moment {
        let fov_rad = request.look.fov_rad(self.path.fov_rad(epoch));
        let craft = match (request.mode, &state) {
            (CameraMode::Chase, Some(state)) => self.craft_pose(epoch, state, &sky),
            _ => None,
        };
        Moment {
            epoch,
            frame: self.scene.time.nearest_frame(epoch),
            view: pose.turned(&request.look).view(fov_rad, request.aspect),
            sky,
            craft,
            eye_velocity_m_s: match request.mode {
                CameraMode::Geodetic => None,
                _ => state.map(|state| state.velocity_m_s),
            },
            satellite: state.map(|state| {
                let sun_itrf_m = sky.sun_itrf * sky.sun_distance_m;
                let position_itrf_m = state.position_itrf_m;
                SatelliteState {
                    place: self.ellipsoid.geodetic_from_itrf(position_itrf_m),
                    speed_m_s: state.velocity_m_s.length(),
                    illumination: illumination(position_itrf_m, sun_itrf_m, &self.ellipsoid),
                    error_m: self.feed().and_then(|feed| feed.error_m(epoch)),
                }
            }),
            turn: None,
            is_starless: false,
            exposure_ev: self.path.exposure_ev(epoch),
            shot: self.path.shot_number(epoch),
        }
    }

    /// The followed spacecraft; `None` if a simulation's time is outside its attitude file.
    fn craft_pose(&self, epoch: Epoch, motion: &OrbitalMotion, sky: &Sky) -> Option<CraftPose> {
        let attitude = self.models.attitude(self.followed);
        let axes = attitude.itrf_from_craft(&AttitudeMoment {
            epoch,
            motion,
            ellipsoid: &self.ellipsoid,
            sky,
            orientation: &self.orientation_at(epoch),
        });
        Some(CraftPose::new(motion, &self.ellipsoid, sky).turned(axes.ok()?))
    }

    /// Maps that the scene wants by default but that are missing. Reads no map.
    ///
    /// # Errors
    /// With `strict = true` the first of them.
    pub fn dropped_layers(&self) -> Result<Vec<DroppedLayer>, PlayError> {
        let mut dropped = dropped_layers(&self.scene)?;
        dropped.extend(dropped_parts(&self.scene)?);
        dropped.extend(dropped_lines(&self.scene)?);
        dropped.extend(geo_layers(&self.scene, &self.ellipsoid, 0)?.dropped);
        Ok(dropped)
    }

    /// Differences of the scene's maps from sRGB, according to their headers.
    #[cfg(feature = "window")]
    pub fn colour_notes(&self) -> Vec<String> {
        super::colours::colour_notes(&self.scene)
    }

    /// Loads the scene's maps and builds its options. `bc` is the adapter's support of compressed textures; it only affects packs.
    pub fn earth_options(&self, bc: BcSupport) -> Result<EarthOptions, PlayError> {
        earth_options(&self.scene, bc)
    }

    /// The same with the maps of an epoch, where they change with the date.
    pub fn earth_options_at(&self, epoch: Epoch, bc: BcSupport) -> Result<EarthOptions, PlayError> {
        earth_options_at(&self.scene, epoch, bc)
    }

    /// As [`Self::earth_options`], with maps that are uploaded to this device while they are read, and not kept in memory. For programs that draw
    /// on one device and do not read texels.
    pub fn uploaded_options(&self, gpu: &GpuContext) -> Result<EarthOptions, PlayError> {
        uploaded_options_at(&self.scene, self.scene.time.start, gpu)
    }

    /// The same with the maps of an epoch, where they change with the date.
    pub fn uploaded_options_at(
        &self,
        epoch: Epoch,
        gpu: &GpuContext,
    ) -> Result<EarthOptions, PlayError> {
        uploaded_options_at(&self.scene, epoch, gpu)
    }

    /// As [`Self::uploaded_options`] for another scene of the same flight.
    #[cfg(feature = "window")]
    pub(super) fn uploaded_options_of(
        &self,
        scene: &Scene,
        gpu: &GpuContext,
    ) -> Result<EarthOptions, PlayError> {
        uploaded_options_at(scene, self.scene.time.start, gpu)
    }
}

fn impact(
    feed: &dyn Feed,
    table: Option<&EarthOrientation>,
    ellipsoid: &Ellipsoid,
) -> Option<(Epoch, GroundPlace)> {
    let epoch = feed.impact()?;
    let state = feed.state_at(epoch).ok()?;
    let orientation = orientation_at(table, epoch).unwrap_or_default();
    let itrf = state.in_frame(Frame::Itrf, &orientation);
    let place = ellipsoid.geodetic_from_itrf(itrf.position_m);
    let place = GroundPlace {
        lat_deg: place.lat_rad.to_degrees(),
        lon_deg: place.lon_rad.to_degrees(),
    };
    Some((epoch, place))
}

/// The time in which a satellite is known, and whether a gap bounds it: one in which the scene would end. Of a scene that would start
/// in a gap, the time behind it up to the next.
fn known_around(feed: &dyn Feed, time: &Time) -> ((Epoch, Epoch), Option<Ending>) {
    let (mut first, mut last) = feed.validity();
    let (start, end) = (time.start, time.end());
    let gaps = feed.gaps();
    let is_in = |epoch: Epoch| move |(from, to): &&(Epoch, Epoch)| *from < epoch && epoch < *to;
    if let Some((_, to)) = gaps.iter().find(is_in(start)) {
        first = *to;
        let next = gaps.iter().map(|(from, _)| *from);
        last = next.filter(|from| from >= to).min().unwrap_or(last);
        return ((first, last), Some(Ending::Gap));
    }
    match gaps.iter().find(is_in(end)) {
        Some((_, to)) if time.speed < 0.0 => ((*to, last), Some(Ending::Gap)),
        Some((from, _)) => ((first, *from), Some(Ending::Gap)),
        None => ((first, last), None),
    }
}

fn decay(feed: &dyn Feed) -> Option<Ending> {
    let (before, after) = feed.decay();
    before.or(after).map(|_| Ending::Decay)
}

pub(super) fn motion(state: &OrbitState, orientation: &Orientation) -> OrbitalMotion {
    let (position_itrf_m, velocity_m_s) = state.inertial_in_itrf_axes(orientation);
    OrbitalMotion {
        position_itrf_m,
        velocity_m_s,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_sun_follows_the_table_that_the_scene_names() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/orbit");
        let flight = |orientation: &str| {
            let text = format!(
                "[time]\nstart = \"2017-01-01T12:00:00Z\"\nduration_s = 60\n{orientation}[camera]\nmode = \"geodetic\"\n"
            );
            let scene = Scene::from_toml(&text, &folder.join("test.toml")).expect("a good scene");
            Flight::open(scene).expect("opens")
        };
        let (plain, oriented) = (
            flight(""),
            flight("orientation = \"finals2000A.extract\"\n"),
        );
        let epoch = plain.scene().time.start;
        let sun = |flight: &Flight| flight.at(epoch, 1.5).expect("a moment").sky.sun_itrf;
        assert_eq!(sun(&plain), Sky::at(epoch).sun_itrf);
        let ut1_s = oriented.orientation_at(epoch).ut1_minus_utc_s;
        assert!((0.1..0.9).contains(&ut1_s.abs()), "{ut1_s}");
        // 15.041 arc seconds for each second of UT1 − UTC, about the pole.
        let lon = |sun: glam::DVec3| sun.y.atan2(sun.x).to_degrees() * 3600.0;
        let moved = lon(sun(&plain)) - lon(sun(&oriented));
        assert!(
            (moved - 15.041 * ut1_s).abs() < 0.3,
            "{moved}″ for {ut1_s} s"
        );
        assert_eq!(sun(&oriented), oriented.sky_at(epoch).sun_itrf);
    }
}
