//! The window's time, controlled by a Basilisk simulation: the displayed snapshot and the status messages.

use crate::flight::{Flight, Moment, ViewRequest};
use crate::keys::Action;
use crate::live_status::LiveStatus;
use std::sync::Arc;
use std::time::{Duration, Instant};
use terrella_orbit::basilisk::{Simulation, Snapshot, StepPace};
use winit::keyboard::Key;

/// Interval at which a window checks for the simulation's next step.
const POLL_INTERVAL: Duration = Duration::from_millis(4);
/// Interval at which a paused window checks the age of the last step.
const AGE_CHECK_INTERVAL: Duration = Duration::from_millis(250);
/// How many of the newest sentences about the simulation the panel has.
const NOTES_SHOWN: usize = 4;

/// The window's time, controlled by a simulation. The simulation is never delayed: it gets its reply immediately, and the latest step is shown.
pub struct SimulationPlay<'f> {
    flight: &'f Flight,
    simulation: &'f Simulation,
    /// The step that is shown.
    shown: Option<Arc<Snapshot>>,
    serial: u64,
    age_checked: Instant,
}

impl<'f> SimulationPlay<'f> {
    /// `None` for scenes that are no running simulation.
    pub fn of(flight: &'f Flight) -> Option<Self> {
        let simulation = flight.simulation()?;
        simulation.set_pace(StepPace::Free);
        Some(Self {
            flight,
            simulation,
            shown: None,
            serial: 0,
            age_checked: Instant::now(),
        })
    }

    /// Whether a new image is due.
    pub fn is_due(&mut self, is_hidden: bool, is_paused: bool) -> bool {
        if is_hidden {
            return false;
        }
        let is_time = self.age_checked.elapsed() > AGE_CHECK_INTERVAL;
        if is_time {
            self.age_checked = Instant::now();
        }
        let is_new = !is_paused && self.simulation.serial() != self.serial;
        is_new || is_time
    }

    /// Time for which the window may sleep before the next check.
    pub fn pause(&self, is_paused: bool) -> Duration {
        match is_paused {
            true => AGE_CHECK_INTERVAL,
            false => POLL_INTERVAL,
        }
    }

    /// Whether the simulation has requested its viewer to close.
    pub fn is_over(&self) -> bool {
        self.simulation.is_over()
    }

    /// The picture of now. There always is one: before a step has come, of the Earth alone.
    pub fn moment(&mut self, view: &ViewRequest, is_paused: bool) -> Moment {
        if !is_paused || self.shown.is_none() {
            self.serial = self.simulation.serial();
            self.shown = self.simulation.latest();
        }
        let shown = self.shown.as_deref();
        let moment = shown.and_then(|shown| self.flight.simulated(shown, view).ok());
        moment.unwrap_or_else(|| self.flight.simulated_alone(shown, view))
    }

    /// The message for an action that only the simulation can perform; `None` for other actions.
    pub fn denial(&self, action: Action) -> Option<String> {
        let what = match action {
            Action::Faster | Action::Slower | Action::Rate(_) => "made faster or slower",
            Action::Reverse => "turned round",
            Action::Seek(_) | Action::Skip(_) | Action::GoTo(_) | Action::NextPass => "moved",
            Action::Loop | Action::RangeStart(_) | Action::RangeEnd(_) | Action::RangeAll => {
                "played in parts"
            }
            Action::RealTime | Action::SceneSpan | Action::TimeLine => "set by another clock",
            _ => return None,
        };
        Some(format!(
            "time comes from the simulation on {} and cannot be {what} here; do it there",
            self.simulation.endpoint()
        ))
    }

    /// Handles a pressed key. Returns a message if the key goes to the script instead of the window.
    pub fn press(&self, key: &Key) -> Option<String> {
        let Key::Character(text) = key else {
            return None;
        };
        let mut characters = text.chars();
        let (Some(key), None) = (characters.next(), characters.next()) else {
            return None;
        };
        let sent = self.simulation.press(key)?;
        Some(format!("sent to the simulation: {sent}"))
    }

    /// The state of the simulation, for the panel.
    pub fn status(&self, is_paused: bool) -> LiveStatus {
        let counters = self.simulation.counters();
        let age = self.simulation.age();
        let state = match (age, counters.connected) {
            (None, _) => "nothing has come yet".to_owned(),
            (Some(_), 0) => "ended".to_owned(),
            (Some(age), _) if age.as_secs_f64() > self.simulation.options().stale_after_s => {
                format!("SILENT for {:.1} s", age.as_secs_f64())
            }
            (Some(_), _) => "runs".to_owned(),
        };
        let mut rows = vec![
            (
                "source",
                format!("Basilisk, {}", self.simulation.endpoint()),
            ),
            ("simulation", state),
            ("steps", counters.steps.to_string()),
        ];
        let heard = self.simulation.heard_keys();
        if !heard.is_empty() {
            rows.push(("keys", format!("{heard} go to the script")));
        }
        if counters.bad > 0 {
            rows.push(("bad", format!("{} messages", counters.bad)));
        }
        if counters.pictures + counters.no_pictures > 0 {
            let (drawn, none) = (counters.pictures, counters.no_pictures);
            rows.push(("pictures", format!("{drawn} drawn, {none} not")));
        }
        if let Some(shown) = &self.shown {
            let others = shown.craft.len().saturating_sub(1);
            if others > 0 {
                rows.push(("others", format!("{others} spacecraft")));
            }
        }
        let notes = self.simulation.notes();
        let newest = notes.iter().rev().take(NOTES_SHOWN).rev();
        rows.extend(newest.map(|note| ("note", note.clone())));
        let craft = self.shown.as_ref().and_then(|shown| {
            let wanted = self.simulation.options().craft.as_deref();
            Some(shown.craft(wanted)?.name.to_string())
        });
        let endpoint = self.simulation.endpoint();
        let notice = match (age, counters.connected) {
            (None, _) => Some(format!("waiting for a Basilisk simulation on {endpoint}")),
            (Some(_), 0) => Some(format!("the simulation has ended; waiting on {endpoint}")),
            _ => None,
        };
        LiveStatus {
            name: craft.unwrap_or_default(),
            pace: match is_paused {
                true => "the simulation's, held here".to_owned(),
                false => "the simulation's".to_owned(),
            },
            rows,
            notice,
        }
    }
}
