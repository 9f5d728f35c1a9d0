//! Pointer interaction in the window: with the camera, and with the selection.

use super::App;
use crate::flight::Moment;
use crate::hand::{FreeEye, fov_of};
use crate::keys::Action;
use crate::orbit_camera::{Globe, GroundHeight, Screen};
use crate::picking::{Picked, pick, position_of, read_out};
use crate::pointer::{Gesture, Hold};
use crate::scene::CameraMode;
use glam::DVec2;
use std::sync::Arc;
use terrella::frames::Ellipsoid;
use terrella_ground::elevation::Elevation;
use winit::event::{ElementState, MouseButton};
use winit::event_loop::ActiveEventLoop;

/// Does something with the globe: its figure, and its relief where it has one.
fn with_globe<R>(
    ellipsoid: &Ellipsoid,
    relief: Option<&Arc<dyn Elevation>>,
    act: impl FnOnce(&Globe<'_>) -> R,
) -> R {
    let height = |lat_rad: f64, lon_rad: f64| {
        relief.map_or(0.0, |relief| relief.height_m(lat_rad, lon_rad, 0.0))
    };
    act(&Globe {
        ellipsoid: *ellipsoid,
        ground: relief.is_some().then_some(&height as GroundHeight<'_>),
    })
}

impl App<'_> {
    fn relief(&self) -> Option<Arc<dyn Elevation>> {
        self.renderer.as_ref()?.relief().cloned()
    }

    /// The picture on screen; `None` before there is one.
    fn shown(&self) -> Option<(Moment, Screen)> {
        let renderer = self.renderer.as_ref()?;
        let moment = renderer.last_moment()?;
        let (width, height) = renderer.size();
        let size_px = DVec2::new(f64::from(width), f64::from(height));
        let fov_rad = fov_of(&moment.view);
        Some((moment, Screen { size_px, fov_rad }))
    }

    /// A button is pressed or released; `is_consumed` where it is the panel's.
    pub(super) fn press(
        &mut self,
        event_loop: &ActiveEventLoop,
        state: ElementState,
        button: MouseButton,
        is_consumed: bool,
    ) {
        let hold = match button {
            MouseButton::Left if self.modifiers.shift_key() => Hold::Turn,
            MouseButton::Left => Hold::Grab,
            MouseButton::Right => Hold::Turn,
            _ => return,
        };
        match state {
            ElementState::Pressed if is_consumed => self.pointer.let_go(),
            ElementState::Pressed => self.pointer.press(hold),
            ElementState::Released => {
                if let Some(gesture) = self.pointer.release(hold, std::time::Instant::now()) {
                    self.gesture(event_loop, gesture);
                }
            }
        }
    }

    /// Does what the pointer means.
    pub(super) fn gesture(&mut self, event_loop: &ActiveEventLoop, gesture: Gesture) {
        let Some((moment, screen)) = self.shown() else {
            return;
        };
        let relief = self.relief();
        let flight = self.flight;
        let ellipsoid = flight.ellipsoid();
        let is_free = self.controls.hand.eye().is_some();
        match gesture {
            Gesture::Begin(Hold::Grab, at) => {
                self.take_eye(&moment, &screen, at);
            }
            Gesture::Begin(Hold::Turn, _) => {}
            Gesture::Move(Hold::Grab, from, to) if is_free => {
                let hand = &mut self.controls.hand;
                with_globe(ellipsoid, relief.as_ref(), |globe| {
                    hand.drag(globe, &screen, from, to);
                });
            }
            Gesture::Move(Hold::Turn, from, to) if is_free => {
                let hand = &mut self.controls.hand;
                with_globe(ellipsoid, relief.as_ref(), |globe| {
                    hand.tilt(globe, &screen, to - from);
                });
            }
            Gesture::Move(_, from, to) => {
                let by = to - from;
                self.act(event_loop, Action::Drag(by.x, by.y));
            }
            Gesture::End => self.controls.hand.let_go(),
            Gesture::Click(at) => self.controls.picked = self.picked_at(&moment, &screen, at),
            Gesture::DoubleClick(at) => {
                let picked = self.picked_at(&moment, &screen, at);
                self.controls.picked = picked;
                match picked {
                    Some(Picked::Satellite(index)) => self.follow(&moment, index),
                    Some(Picked::Place(place)) => {
                        let point = ellipsoid.itrf_from_geodetic(place);
                        self.controls.free_eye(fov_of(&moment.view));
                        let hand = &mut self.controls.hand;
                        with_globe(ellipsoid, relief.as_ref(), |globe| {
                            hand.centre_on(&moment.view, globe, &screen, point);
                        });
                    }
                    None => {}
                }
            }
        }
        self.redraw();
    }

    /// What is under a pixel of the picture on screen.
    fn picked_at(&self, moment: &Moment, screen: &Screen, at: DVec2) -> Option<Picked> {
        let near = self
            .renderer
            .as_ref()
            .map(|renderer| renderer.markers_near(at));
        let near = near.unwrap_or_default();
        let relief = self.relief();
        with_globe(self.flight.ellipsoid(), relief.as_ref(), |globe| {
            pick(self.flight, moment, globe, screen.size_px, at, &near)
        })
    }

    fn follow(&mut self, moment: &Moment, satellite: usize) {
        if let Some(position) = position_of(self.flight, satellite, moment.epoch) {
            self.controls.free_eye(fov_of(&moment.view));
            self.controls.hand.follow(&moment.view, satellite, position);
        }
    }

    /// Flies with a satellite from the picture on screen on.
    pub(super) fn follow_now(&mut self, satellite: usize) {
        if let Some((moment, _)) = self.shown() {
            self.follow(&moment, satellite);
        }
    }

    /// Takes the eye off the scene's camera: around the craft where that is in the picture, else over the globe.
    fn take_eye(&mut self, moment: &Moment, screen: &Screen, at: DVec2) {
        let relief = self.relief();
        let (flight, controls) = (self.flight, &mut self.controls);
        let is_chase = controls.hand.eye().is_none() && controls.mode == CameraMode::Chase;
        let followed = flight.followed();
        let motion = flight.motion_of(followed, moment.epoch).ok();
        with_globe(flight.ellipsoid(), relief.as_ref(), |globe| {
            match motion.filter(|_| is_chase) {
                // Not known: the head turns.
                None if is_chase => {}
                Some(motion) => {
                    controls.free_eye(fov_of(&moment.view));
                    controls.hand.circle(&moment.view, globe, followed, &motion);
                }
                None => {
                    controls.free_eye(fov_of(&moment.view));
                    controls.hand.grab(&moment.view, globe, screen, at);
                }
            }
        });
    }

    /// The wheel is turned by steps of a power of two, away from the user is positive. With Ctrl, and where the eye flies with a
    /// satellite, it changes the field of view.
    pub(super) fn wheel(&mut self, event_loop: &ActiveEventLoop, steps: f64) {
        let is_standing = self.controls.hand.eye().is_some()
            || matches!(self.controls.mode, CameraMode::Geodetic | CameraMode::Chase);
        let shown = self.shown().filter(|_| is_standing && steps.is_finite());
        let Some((moment, screen)) = shown.filter(|_| !self.modifiers.control_key()) else {
            self.act(event_loop, Action::Zoom(steps));
            return;
        };
        let at = self.pointer.at_px().unwrap_or(screen.middle());
        let is_held = self.controls.hand.eye().is_some();
        if !is_held {
            self.take_eye(&moment, &screen, at);
            self.controls.hand.let_go();
        }
        if self.controls.hand.eye().is_none() {
            self.act(event_loop, Action::Zoom(steps));
            return;
        }
        let relief = self.relief();
        let hand = &mut self.controls.hand;
        with_globe(self.flight.ellipsoid(), relief.as_ref(), |globe| {
            hand.approach(&moment.view, globe, &screen, at, steps);
        });
        self.redraw();
    }

    /// Turns north upwards.
    pub(super) fn turn_north_up(&mut self) {
        let Some((moment, screen)) = self.shown() else {
            return;
        };
        self.controls.free_eye(fov_of(&moment.view));
        let relief = self.relief();
        let hand = &mut self.controls.hand;
        with_globe(self.flight.ellipsoid(), relief.as_ref(), |globe| {
            hand.north_up(&moment.view, globe, &screen);
        });
    }

    /// Puts the user's eye into a moment, and returns information about the selection there.
    pub(super) fn place_eye(&mut self, moment: &mut Moment, aspect: f64) {
        let relief = self.relief();
        let (flight, controls) = (self.flight, &mut self.controls);
        let (fov_rad, hand) = (controls.fov_rad(), controls.hand);
        let followed = hand.followed();
        let motion = followed.and_then(|index| flight.motion_of(index, moment.epoch).ok());
        let picked = controls.picked;
        let mut lost = false;
        controls.read_out = with_globe(flight.ellipsoid(), relief.as_ref(), |globe| {
            match (hand.pose(globe, motion.as_ref()), hand.eye()) {
                (Some(pose), _) => moment.view = pose.view(fov_rad, aspect),
                (None, Some(FreeEye::Follow(_))) => lost = true,
                (None, _) => {}
            }
            read_out(flight, moment, globe, picked?)
        });
        if lost {
            self.controls.leave_free_eye();
            self.show_message("the satellite is not known at this time".to_owned());
        }
    }
}
