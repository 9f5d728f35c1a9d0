//! Keys of the window, in the order of all events: a key after a click belongs to the text field that the click is on.

use super::App;
use crate::keys::{Action, action_of};
use winit::event::KeyEvent;
use winit::event_loop::ActiveEventLoop;

impl App<'_> {
    /// Lays out clicks and keys that come before a key and can move the focus, and does what they mean.
    pub(super) fn settle_focus(&mut self, event_loop: &ActiveEventLoop) {
        let renderer = self.renderer.as_mut();
        let actions = renderer.and_then(|renderer| renderer.settle_focus(&self.controls));
        let Some(actions) = actions else {
            return;
        };
        for action in actions {
            self.act(event_loop, action);
        }
        self.redraw();
    }

    /// A key that no text field has taken is pressed.
    pub(super) fn press_key(&mut self, event_loop: &ActiveEventLoop, event: &KeyEvent) {
        let is_free = !event.repeat && !self.controls.is_modal();
        let live = self.live.as_ref().filter(|_| is_free);
        if let Some(reported) = live.and_then(|live| live.press(&event.logical_key)) {
            self.show_message(reported);
            self.redraw();
            return;
        }
        let repeats =
            |action: Action| matches!(action, Action::Zoom(_) | Action::Skip(_) | Action::Step(_));
        let action = action_of(&event.logical_key);
        if let Some(action) = action.filter(|action| !event.repeat || repeats(*action)) {
            let searches = self.controls.searches;
            self.act(event_loop, action);
            if let Some(renderer) = &mut self.renderer
                && self.controls.searches != searches
            {
                renderer.expect_focus();
            }
        }
    }
}
