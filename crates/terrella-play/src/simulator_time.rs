//! The window's time where somebody else gives it: a simulator of live states, or a simulation of Basilisk.

use super::basilisk::SimulationPlay;
use super::flight::{Flight, Moment, ViewRequest};
use super::keys::Action;
use super::live::LivePlay;
use super::live_status::LiveStatus;
use std::time::Duration;
use winit::keyboard::Key;

/// The window's time where a simulator gives it.
pub(super) enum SimulatorTime<'f> {
    /// Time of live states.
    Live(Box<LivePlay<'f>>),
    Basilisk(SimulationPlay<'f>),
}

impl<'f> SimulatorTime<'f> {
    /// `None` for scenes that have their own time.
    pub fn of(flight: &'f Flight) -> Option<Self> {
        let simulation = SimulationPlay::of(flight).map(Self::Basilisk);
        simulation.or_else(|| LivePlay::of(flight).map(Box::new).map(Self::Live))
    }

    /// Whether a new image is due.
    pub fn is_due(&mut self, is_hidden: bool, is_paused: bool) -> bool {
        match self {
            Self::Live(live) => live.is_due(is_hidden, is_paused),
            Self::Basilisk(play) => play.is_due(is_hidden, is_paused),
        }
    }

    /// Time for which the window may sleep before the next check; `None` draws continuously.
    pub fn pause(&self, is_paused: bool) -> Option<Duration> {
        match self {
            Self::Live(live) => live.pause(is_paused),
            Self::Basilisk(play) => Some(play.pause(is_paused)),
        }
    }

    /// Whether the simulator has requested the window to close.
    pub fn is_over(&self) -> bool {
        match self {
            Self::Live(_) => false,
            Self::Basilisk(play) => play.is_over(),
        }
    }

    /// Simulated seconds per second, if time runs uniformly.
    pub fn rate(&self) -> Option<f64> {
        match self {
            Self::Live(live) => live.rate(),
            Self::Basilisk(_) => None,
        }
    }

    /// The picture of now. There always is one.
    pub fn moment(&mut self, view: &ViewRequest, is_paused: bool) -> Moment {
        match self {
            Self::Live(live) => live.moment(view, is_paused),
            Self::Basilisk(play) => play.moment(view, is_paused),
        }
    }

    /// The picture is on its way to the screen.
    pub fn drawn(&mut self) {
        match self {
            Self::Live(live) => live.drawn(),
            // It was answered when it came.
            Self::Basilisk(_) => {}
        }
    }

    /// Handles a pressed key. Returns a message if the key goes to the simulator instead of the window.
    pub fn press(&self, key: &Key) -> Option<String> {
        match self {
            Self::Live(_) => None,
            Self::Basilisk(play) => play.press(key),
        }
    }

    /// The message for an action that only the simulator can perform; `None` for other actions.
    pub fn denial(&self, action: Action) -> Option<String> {
        match self {
            Self::Live(live) => live.denial(action),
            Self::Basilisk(play) => play.denial(action),
        }
    }

    /// The state of the simulator, for the panel.
    pub fn status(&self, is_paused: bool) -> LiveStatus {
        match self {
            Self::Live(live) => live.status(is_paused),
            Self::Basilisk(play) => play.status(is_paused),
        }
    }
}
