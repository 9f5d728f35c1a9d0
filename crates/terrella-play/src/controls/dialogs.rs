//! Dialogs over the picture: which is open, what closes it, and which actions it takes.

use super::Controls;
use crate::keys::Action;

impl Controls {
    /// Whether something is open or selected that Esc closes.
    pub fn is_something_open(&self) -> bool {
        self.help || self.is_modal() || self.picked.is_some()
    }

    /// Whether a dialog waits for an answer: nothing else acts meanwhile.
    pub fn is_modal(&self) -> bool {
        self.asks_to_close || self.asks_for_film
    }

    /// Whether an action acts now: an open dialog takes only its own.
    pub fn accepts(&self, action: Action) -> bool {
        if !self.is_modal() {
            return true;
        }
        match action {
            Action::Confirm | Action::Dismiss => true,
            Action::Film | Action::MakeFilm => !self.asks_to_close,
            _ => false,
        }
    }

    /// Opens or closes the dialog that makes a film. It takes the place of the help.
    pub(super) fn toggle_film(&mut self) {
        self.asks_for_film = !self.asks_for_film && self.film.is_some();
        self.help &= !self.asks_for_film;
    }

    /// Closes the topmost dialog, or clears the selection; without either, opens the question to close the window.
    pub(super) fn dismiss(&mut self) {
        if self.asks_to_close {
            self.asks_to_close = false;
        } else if self.help {
            self.help = false;
        } else if self.asks_for_film {
            self.asks_for_film = false;
        } else if self.picked.is_some() {
            (self.picked, self.read_out) = (None, None);
        } else {
            self.asks_to_close = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::WindowTask;
    use super::*;
    use crate::flight::Flight;
    use crate::scene::Scene;
    use crate::switches::Layer;
    use std::path::Path;

    const OTHERS: [Action; 9] = [
        Action::MapScale,
        Action::Layer(Layer::Clouds),
        Action::TimeLine,
        Action::Help,
        Action::Pause,
        Action::Zoom(1.0),
        Action::Search,
        Action::FullScreen,
        Action::Quit,
    ];

    fn controls() -> Controls {
        let scene = Scene::from_toml("[orbit]\n", Path::new("test.toml")).expect("a good scene");
        Controls::new(&Flight::open(scene).expect("opens"))
    }

    /// What another action would change.
    fn state(controls: &Controls) -> impl PartialEq + std::fmt::Debug + use<> {
        (
            (controls.map_scale, controls.help, controls.searches),
            (controls.line.shown, controls.clock.is_paused()),
            controls.switches,
            controls.fov_rad(),
        )
    }

    fn assert_nothing_else_acts(controls: &mut Controls) {
        let before = state(controls);
        for action in OTHERS {
            assert!(!controls.accepts(action), "{action:?}");
            assert_eq!(controls.apply(action, 720.0), None, "{action:?}");
            assert_eq!(state(controls), before, "{action:?}");
        }
    }

    #[test]
    fn the_question_to_close_takes_only_its_answers() {
        let mut controls = controls();
        assert!(OTHERS.iter().all(|action| controls.accepts(*action)));
        controls.apply(Action::Dismiss, 720.0);
        assert!(controls.is_modal() && controls.asks_to_close);
        assert_nothing_else_acts(&mut controls);
        controls.apply(Action::Film, 720.0);
        assert!(!controls.asks_for_film);
        let mut stays = controls.clone();
        stays.apply(Action::Dismiss, 720.0);
        assert!(!stays.is_modal());
        stays.apply(Action::MapScale, 720.0);
        assert!(stays.map_scale);
        let answer = controls.apply(Action::Confirm, 720.0);
        assert_eq!(answer, Some(WindowTask::Quit));
    }

    #[test]
    fn the_dialog_for_films_takes_only_its_own_keys() {
        let mut controls = controls();
        controls.apply(Action::Help, 720.0);
        controls.apply(Action::Film, 720.0);
        assert!(controls.asks_for_film && !controls.help);
        assert_nothing_else_acts(&mut controls);
        let answer = controls.apply(Action::Confirm, 720.0);
        assert_eq!(answer, Some(WindowTask::MakeFilm));
        controls.apply(Action::Dismiss, 720.0);
        assert!(!controls.is_something_open());
        controls.apply(Action::Film, 720.0);
        controls.apply(Action::Film, 720.0);
        assert!(!controls.is_modal());
    }
}
