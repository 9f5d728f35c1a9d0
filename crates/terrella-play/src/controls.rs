//! State set by the user: clock, camera, view, and displayed layers. Independent of windows.

mod dialogs;

use super::camera::HeadTurn;
use super::clock::{AtEnd, Clock};
use super::film_plan::{FilmSource, FilmView};
use super::flight::{Flight, ViewRequest};
use super::hand::{FreeEye, Hand};
use super::keys::Action;
use super::live_status::LiveStatus;
use super::picking::{Picked, ReadOut};
use super::satellite_list::SatelliteNames;
use super::switches::{Site, Switches};
use super::timeline::TimeLine;
use crate::scene::CameraMode;
use terrella::Exposure;
use terrella::frames::{Epoch, Geodetic};

/// Most that one event magnifies, as a power of two: more comes from a faulty device.
const MAX_ZOOM_STEP: f64 = 8.0;
/// How far up and down the view turns, radians (89°).
const MAX_PITCH_RAD: f64 = 89.0 * std::f64::consts::PI / 180.0;
/// Longest step of the wall clock that counts, seconds: a window that was hidden or held goes on where it stood.
const MAX_STEP_S: f64 = 0.25;

/// State set by the user.
#[derive(Clone, Debug)]
pub struct Controls {
    /// Simulated time.
    pub clock: Clock,
    /// Zoom and direction of view.
    pub look: HeadTurn,
    pub mode: CameraMode,
    /// Manual camera movements.
    pub hand: Hand,
    /// The selection.
    pub picked: Option<Picked>,
    /// Information about the selection.
    pub read_out: Option<ReadOut>,
    /// Search index of the scene's satellites.
    pub names: SatelliteNames,
    /// Number of times that the user has opened the search.
    pub searches: u32,
    /// Displayed layers, and exposure.
    pub switches: Switches,
    /// Whether the panel is visible.
    pub panel: bool,
    /// Whether the help is visible.
    pub help: bool,
    /// Whether the question to close the window is open.
    pub asks_to_close: bool,
    /// What films are made of; `None` where a simulator gives the time.
    pub film: Option<FilmSource>,
    /// Whether the program that opened the window makes films.
    pub makes_films: bool,
    /// Whether the dialog for films is open.
    pub asks_for_film: bool,
    /// The film that is being made, in words.
    pub film_in_work: Option<String>,
    /// Whether scale bar and compass are visible.
    pub map_scale: bool,
    pub line: TimeLine,
    /// The message on screen.
    pub message: Option<String>,
    /// How the simulators are whose states are drawn, where there are any.
    pub live: Option<LiveStatus>,
    modes: &'static [CameraMode],
    /// The satellite that the scene's cameras fly with.
    own_satellite: usize,
    scene_fov_rad: f64,
    frame_rate_hz: f64,
    scene_exposure: Exposure,
    scene_switches: Switches,
}

/// Part of an action that the window itself must perform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WindowTask {
    /// Write a picture.
    Screenshot,
    /// Change to full screen or back.
    FullScreen,
    /// Follow the real clock.
    RealTime,
    /// Look for the next pass.
    NextPass,
    /// Turn north upwards.
    NorthUp,
    /// Fly with a satellite.
    Follow(usize),
    /// Set the clock to a date.
    GoTo(Epoch),
    /// Make a film.
    MakeFilm,
    /// Close.
    Quit,
}

impl Controls {
    /// The initial state from the scene.
    pub fn new(flight: &Flight) -> Self {
        let scene = flight.scene();
        Self {
            clock: Clock::new(&scene.time, AtEnd::Loop),
            look: HeadTurn::default(),
            mode: scene.camera.mode,
            hand: Hand::default(),
            picked: None,
            read_out: None,
            names: SatelliteNames::of(flight.satellites()),
            searches: 0,
            switches: Switches::of(scene),
            panel: true,
            help: false,
            asks_to_close: false,
            film: FilmSource::of(flight),
            makes_films: false,
            asks_for_film: false,
            film_in_work: None,
            map_scale: false,
            line: TimeLine::new(flight),
            message: None,
            live: None,
            modes: flight.camera_modes(),
            own_satellite: flight.followed(),
            scene_fov_rad: scene.camera.fov_deg.to_radians(),
            frame_rate_hz: scene.time.frame_rate_hz,
            scene_exposure: scene.output.exposure,
            scene_switches: Switches::of(scene),
        }
    }

    pub fn request(&self, aspect: f64) -> ViewRequest {
        ViewRequest {
            mode: match self.hand.eye() {
                None => self.mode,
                // Its craft is drawn.
                Some(FreeEye::Follow(follower))
                    if follower.satellite == self.own_satellite
                        && self.modes.contains(&CameraMode::Chase) =>
                {
                    CameraMode::Chase
                }
                Some(_) => CameraMode::Geodetic,
            },
            look: self.look,
            aspect,
        }
    }

    /// Vertical field of view, radians.
    pub fn fov_rad(&self) -> f64 {
        self.look.fov_rad(self.scene_fov_rad)
    }

    /// What a film would show of this view.
    pub fn film_view(&self) -> FilmView<'_> {
        FilmView {
            clock: &self.clock,
            switches: &self.switches,
            free_eye: self.hand.eye(),
            mode: self.mode,
            fov_rad: self.fov_rad(),
        }
    }

    /// Lets time pass.
    pub fn advance(&mut self, wall_dt_s: f64) {
        self.clock.advance(wall_dt_s.min(MAX_STEP_S));
        if !self.clock.is_paused() {
            self.line.show_now(&self.clock);
        }
    }

    /// Whether layers, exposure or tone curve are not the scene's.
    pub fn is_switched(&self) -> bool {
        self.switches.at(None) != self.scene_switches
    }

    /// Whether the exposure is metered.
    pub fn meters_exposure(&self) -> bool {
        self.switches.exposure.unwrap_or(self.scene_exposure) == Exposure::Auto
    }

    /// Whether the time line is visible.
    pub fn shows_line(&self) -> bool {
        self.panel && self.line.shown && self.live.is_none()
    }

    /// The user moves the eye by hand from now on, from a view with this field of view, radians.
    pub fn free_eye(&mut self, fov_rad: f64) {
        if self.hand.eye().is_none() && fov_rad.is_finite() {
            self.look = HeadTurn {
                zoom: self.zoom_of(fov_rad),
                ..HeadTurn::default()
            };
        }
    }

    /// Back to the scene's camera.
    pub fn leave_free_eye(&mut self) {
        self.hand.leave();
        self.look = HeadTurn::default();
    }

    /// The magnification with which the field of view is this, radians.
    fn zoom_of(&self, fov_rad: f64) -> f64 {
        (0.5 * self.scene_fov_rad).tan() / (0.5 * fov_rad).tan()
    }

    /// Performs a user action; returns the part that only the window can do. `height_px` is the image height, for drags.
    /// An open dialog takes only its own actions.
    pub fn apply(&mut self, action: Action, height_px: f64) -> Option<WindowTask> {
        if !self.accepts(action) {
            return None;
        }
        if sets_clock(action) {
            self.line.leave_real_time();
        }
        match action {
            Action::Pause => self.clock.set_paused(!self.clock.is_paused()),
            Action::Faster => self.clock.faster(),
            Action::Slower => self.clock.slower(),
            Action::Rate(rate) => self.clock.set_rate(rate),
            Action::GoTo(epoch) => return Some(WindowTask::GoTo(epoch)),
            Action::Reverse => self.clock.reverse(),
            Action::Seek(progress) => self.clock.seek(progress),
            Action::Skip(wall_s) => self.clock.seek_by(wall_s * self.clock.speed()),
            Action::Step(frames) => {
                self.clock.set_paused(true);
                let frame_s = self.clock.speed().abs() / self.frame_rate_hz;
                self.clock.seek_by(frames * frame_s);
            }
            Action::ZoomLine { at, factor, by } => self.line.zoom(&self.clock, at, factor, by),
            Action::NextCamera => self.next_camera(),
            Action::Zoom(steps) => self.zoom(steps),
            Action::Drag(right_px, down_px) => self.drag(right_px, down_px, height_px),
            Action::ResetView => self.leave_free_eye(),
            Action::NorthUp => return Some(WindowTask::NorthUp),
            Action::Layer(layer) => self.switches.toggle(layer),
            Action::Expose(exposure) => self.switches.exposure = exposure,
            Action::Tone(tone) => self.switches.tone = Some(tone),
            Action::NextTone => self.switches.next_tone(),
            Action::SceneLook => {
                self.switches = self.scene_switches.at(self.switches.site());
            }
            Action::Help => self.help = !self.help,
            Action::Panel => self.panel = !self.panel,
            Action::TimeLine if self.panel => self.line.shown = !self.line.shown,
            // Hidden with the panel, it comes back with it.
            Action::TimeLine => (self.panel, self.line.shown) = (true, true),
            Action::MapScale => self.map_scale = !self.map_scale,
            Action::Loop => self.clock.set_at_end(match self.clock.at_end() {
                AtEnd::Loop => AtEnd::Stop,
                AtEnd::Stop => AtEnd::Loop,
            }),
            Action::RangeStart(at) => self
                .clock
                .set_range_start(at.unwrap_or(self.clock.progress())),
            Action::RangeEnd(at) => self
                .clock
                .set_range_end(at.unwrap_or(self.clock.progress())),
            Action::RangeAll => self.clock.clear_range(),
            Action::SceneSpan => self.clock.return_to_scene_span(),
            Action::Place(lat_deg, lon_deg) => {
                self.line.place = Some(Geodetic::from_degrees(lat_deg, lon_deg, 0.0));
                self.show_site();
            }
            Action::VisibleOnly => self.line.visible_only = !self.line.visible_only,
            Action::MinElevation(degrees) => {
                self.line.min_elevation_deg = degrees;
                self.show_site();
            }
            // A second time it is left; the clock goes on by itself.
            Action::RealTime if self.line.is_real_time() => self.line.leave_real_time(),
            Action::RealTime => return Some(WindowTask::RealTime),
            Action::NextPass => return Some(WindowTask::NextPass),
            Action::Search => {
                self.panel = true;
                self.searches = self.searches.wrapping_add(1);
            }
            Action::Select(index) => self.picked = Some(Picked::Satellite(index)),
            Action::Follow(index) => {
                self.picked = Some(Picked::Satellite(index));
                return Some(WindowTask::Follow(index));
            }
            Action::Screenshot => return Some(WindowTask::Screenshot),
            Action::FullScreen => return Some(WindowTask::FullScreen),
            Action::Dismiss => self.dismiss(),
            Action::Confirm if self.asks_to_close => return Some(WindowTask::Quit),
            Action::Confirm if self.asks_for_film => return Some(WindowTask::MakeFilm),
            Action::Confirm => {}
            Action::Film => self.toggle_film(),
            Action::MakeFilm => return Some(WindowTask::MakeFilm),
            Action::Quit => return Some(WindowTask::Quit),
        }
        None
    }

    /// Draws the place of passes as a station.
    fn show_site(&mut self) {
        let min_elevation_deg = self.line.min_elevation_deg;
        self.switches.set_site(self.line.place.map(|place| Site {
            place,
            min_elevation_deg,
        }));
    }

    fn next_camera(&mut self) {
        if self.hand.eye().is_some() {
            self.leave_free_eye();
            return;
        }
        let present = self.modes.iter().position(|mode| *mode == self.mode);
        let next = present.map_or(0, |index| (index + 1) % self.modes.len());
        if let Some(mode) = self.modes.get(next) {
            self.mode = *mode;
        }
        // A turned head would look anywhere in another camera.
        self.look = HeadTurn::default();
    }

    fn zoom(&mut self, steps: f64) {
        if !steps.is_finite() {
            return;
        }
        let steps = steps.clamp(-MAX_ZOOM_STEP, MAX_ZOOM_STEP);
        let zoom = (self.look.zoom.log2() + steps).exp2();
        let fov_rad = HeadTurn { zoom, ..self.look }.fov_rad(self.scene_fov_rad);
        // What the view's limits left of it: steps must not pile up behind them.
        self.look.zoom = self.zoom_of(fov_rad);
    }

    /// The point under the pointer stays under it: a pixel is 2 tan(fov/2)/height of a radian in the middle.
    fn drag(&mut self, right_px: f64, down_px: f64, height_px: f64) {
        let per_px = 2.0 * (0.5 * self.fov_rad()).tan() / height_px.max(1.0);
        let yaw = self.look.yaw_rad - right_px * per_px;
        let pitch = self.look.pitch_rad + down_px * per_px;
        if yaw.is_finite() && pitch.is_finite() {
            self.look.yaw_rad = yaw.rem_euclid(std::f64::consts::TAU);
            self.look.pitch_rad = pitch.clamp(-MAX_PITCH_RAD, MAX_PITCH_RAD);
        }
    }
}

/// Whether it sets the clock, which then goes its own way.
fn sets_clock(action: Action) -> bool {
    matches!(
        action,
        Action::Pause
            | Action::Faster
            | Action::Slower
            | Action::Rate(_)
            | Action::GoTo(_)
            | Action::Reverse
            | Action::Seek(_)
            | Action::Skip(_)
            | Action::Step(_)
            | Action::SceneSpan
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use std::path::Path;

    fn controls(scene: &str) -> Controls {
        let scene = Scene::from_toml(scene, Path::new("test.toml")).expect("a good scene");
        Controls::new(&Flight::open(scene).expect("opens"))
    }

    const PLACE: &str = "[camera]\nmode = \"geodetic\"\nfov_deg = 45\n";

    #[test]
    fn only_cameras_that_make_sense_are_offered() {
        let mut ground = controls(PLACE);
        ground.apply(Action::NextCamera, 720.0);
        assert_eq!(ground.mode, CameraMode::Geodetic);

        let mut flying = controls("[camera]\nmode = \"chase\"\n");
        let mut seen = Vec::new();
        for _ in 0..4 {
            flying.apply(Action::NextCamera, 720.0);
            seen.push(flying.mode);
        }
        use CameraMode::{Chase, Geodetic, Horizon, Nadir};
        assert_eq!(seen, [Geodetic, Nadir, Horizon, Chase]);
    }

    #[test]
    fn zoom_ends_and_comes_straight_back() {
        let mut controls = controls(PLACE);
        let begin = controls.fov_rad();
        controls.apply(Action::Zoom(1.0), 720.0);
        assert!(controls.fov_rad() < 0.6 * begin);
        for _ in 0..1_000 {
            controls.apply(Action::Zoom(1.0), 720.0);
        }
        let narrowest = controls.fov_rad();
        assert!(narrowest > 0.0);
        controls.apply(Action::Zoom(-1.0), 720.0);
        assert!(controls.fov_rad() > 1.5 * narrowest, "steps piled up");
        controls.apply(Action::ResetView, 720.0);
        assert!((controls.fov_rad() - begin).abs() < 1e-12);
        controls.apply(Action::Zoom(f64::NAN), 720.0);
        assert!((controls.fov_rad() - begin).abs() < 1e-12);
    }

    #[test]
    fn dragging_moves_the_view_with_the_pointer() {
        let mut controls = controls(PLACE);
        controls.apply(Action::Drag(-10.0, 10.0), 720.0);
        // Dragging the picture to the left turns the head to the right; down, it turns up.
        assert!(controls.look.yaw_rad > 0.0 && controls.look.pitch_rad > 0.0);
        controls.apply(Action::Drag(0.0, 1e9), 720.0);
        assert!(controls.look.pitch_rad <= MAX_PITCH_RAD);
        let before = controls.look;
        controls.apply(Action::Drag(f64::NAN, 0.0), 720.0);
        assert_eq!(controls.look, before);
    }

    #[test]
    fn a_long_pause_of_the_machine_is_a_short_step() {
        let mut controls =
            controls("[camera]\nmode = \"geodetic\"\n[time]\nspeed = 10\nduration_s = 100\n");
        controls.advance(3600.0);
        assert!((controls.clock.progress() - 0.025).abs() < 1e-9);
    }

    #[test]
    fn the_time_line_is_hidden_with_the_panel_and_by_its_own_key() {
        let mut controls = controls(PLACE);
        assert!(controls.shows_line());
        controls.apply(Action::TimeLine, 720.0);
        assert!(!controls.shows_line() && controls.panel);
        controls.apply(Action::Panel, 720.0);
        controls.apply(Action::TimeLine, 720.0);
        assert!(controls.shows_line());
        controls.apply(Action::Panel, 720.0);
        assert!(!controls.shows_line());
    }

    #[test]
    fn a_clock_that_is_set_leaves_real_time() {
        use terrella::frames::utc_from_rfc3339;
        for action in [
            Action::Pause,
            Action::Seek(0.5),
            Action::Faster,
            Action::Rate(10.0),
        ] {
            let mut controls = controls(PLACE);
            assert_eq!(
                controls.apply(Action::RealTime, 720.0),
                Some(WindowTask::RealTime)
            );
            let now = utc_from_rfc3339("2026-03-01T08:00:00Z").expect("a date");
            controls
                .line
                .begin_real_time(&mut controls.clock, now, None);
            controls.apply(Action::Zoom(1.0), 720.0);
            assert!(controls.line.is_real_time());
            controls.apply(action, 720.0);
            assert!(!controls.line.is_real_time(), "{action:?}");
            assert!(!controls.clock.is_on_scene_span());
            controls.apply(Action::SceneSpan, 720.0);
            assert!(controls.clock.is_on_scene_span());
        }
    }

    #[test]
    fn the_part_begins_and_ends_where_the_clock_stands() {
        let mut controls = controls(PLACE);
        controls.apply(Action::Seek(0.25), 720.0);
        controls.apply(Action::RangeStart(None), 720.0);
        controls.apply(Action::RangeEnd(Some(0.75)), 720.0);
        assert_eq!(controls.clock.range(), (0.25, 0.75));
        controls.apply(Action::RangeAll, 720.0);
        assert_eq!(controls.clock.range(), (0.0, 1.0));
        controls.apply(Action::Loop, 720.0);
        assert_eq!(controls.clock.at_end(), AtEnd::Stop);
    }

    #[test]
    fn esc_closes_the_help_and_then_asks_before_it_closes_the_window() {
        let mut controls = controls(PLACE);
        controls.apply(Action::Help, 720.0);
        assert_eq!(controls.apply(Action::Dismiss, 720.0), None);
        assert!(!controls.help && !controls.asks_to_close);
        // Enter answers a question and does nothing without one.
        assert_eq!(controls.apply(Action::Confirm, 720.0), None);
        assert_eq!(controls.apply(Action::Dismiss, 720.0), None);
        assert!(controls.asks_to_close);
        assert_eq!(controls.apply(Action::Dismiss, 720.0), None);
        assert!(!controls.is_something_open());
        controls.apply(Action::Dismiss, 720.0);
        assert_eq!(
            controls.apply(Action::Confirm, 720.0),
            Some(WindowTask::Quit)
        );
    }

    #[test]
    fn esc_drops_the_selection_before_it_asks() {
        let mut controls = controls(PLACE);
        controls.picked = Some(Picked::Satellite(0));
        controls.apply(Action::Help, 720.0);
        assert!(controls.is_something_open());
        controls.apply(Action::Dismiss, 720.0);
        assert!(!controls.help && controls.picked.is_some());
        controls.apply(Action::Dismiss, 720.0);
        assert!(controls.picked.is_none() && !controls.is_something_open());
        controls.apply(Action::Dismiss, 720.0);
        assert!(controls.asks_to_close);
    }

    #[test]
    fn a_moved_eye_keeps_its_field_of_view_and_leaves_by_c_or_home() {
        use crate::hand::fov_of;
        use crate::orbit_camera::{Globe, Screen};
        for back in [Action::NextCamera, Action::ResetView] {
            let mut controls = controls("[camera]\nmode = \"horizon\"\nfov_deg = 40\n");
            controls.apply(Action::Zoom(1.0), 720.0);
            let fov_rad = controls.fov_rad();
            let flight = Flight::open(
                Scene::from_toml("[camera]\nmode = \"horizon\"\n", Path::new("test.toml"))
                    .expect("a good scene"),
            )
            .expect("opens");
            let now = controls.clock.now();
            let moment = flight.view_at(now, &controls.request(1.5)).expect("a view");
            let globe = Globe {
                ellipsoid: *flight.ellipsoid(),
                ground: None,
            };
            let screen = Screen {
                size_px: glam::DVec2::new(1080.0, 720.0),
                fov_rad,
            };
            controls.free_eye(fov_of(&moment.view));
            controls.hand.grab(
                &moment.view,
                &globe,
                &screen,
                glam::DVec2::new(500.0, 700.0),
            );
            assert_eq!(controls.request(1.5).mode, CameraMode::Geodetic);
            let kept = fov_of(&moment.view);
            assert!((controls.fov_rad() - kept).abs() < 1e-9, "{kept}");
            controls.apply(back, 720.0);
            assert_eq!(controls.hand.eye(), None);
            assert_eq!(controls.request(1.5).mode, CameraMode::Horizon);
            assert!((controls.fov_rad() - 40f64.to_radians()).abs() < 1e-9);
        }
    }

    #[test]
    fn the_window_is_asked_for_what_only_it_can_do() {
        let mut controls = controls(PLACE);
        assert_eq!(controls.apply(Action::Quit, 720.0), Some(WindowTask::Quit));
        assert_eq!(controls.apply(Action::Pause, 720.0), None);
        assert!(controls.clock.is_paused());
    }
}
