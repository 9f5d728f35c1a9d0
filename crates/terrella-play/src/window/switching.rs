//! Layers, exposure and tone curve of the window: what takes time is made by a thread.

use super::App;
use crate::error::PlayError;
use crate::switches::Switches;
use crate::window_renderer::Switching;

impl App<'_> {
    /// Draws what the user has switched, at once or when it is made. `before` is what was switched until then.
    pub(super) fn switch(&mut self, before: Switches) {
        let (flight, switches) = (self.flight, self.controls.switches);
        let Some(renderer) = &mut self.renderer else {
            return;
        };
        // An exposure changes at once, whatever is being made.
        let exposed = renderer.expose(flight, switches.exposure);
        let is_awaited = self.pictures.awaited().is_some_and(|awaited| {
            let exposure = awaited.exposure;
            *awaited == switches.exposed(exposure)
        });
        let done = match is_awaited {
            true => exposed,
            false => exposed
                .and_then(|()| renderer.switch(flight, &switches))
                .map(|switching| match switching {
                    Switching::Done => self.pictures.forget(),
                    Switching::Ordered(order) => self.pictures.order(*order),
                }),
        };
        if let Err(error) = done {
            self.controls.switches = before;
            self.show_message(error.to_string());
        }
    }

    /// Shows the picture that was ordered last, if it is there.
    pub(super) fn take_picture(&mut self) {
        let Some(ready) = self.pictures.ready() else {
            return;
        };
        let Some(renderer) = &mut self.renderer else {
            return;
        };
        let shown =
            ready.and_then(|ready| renderer.adopt(self.flight, ready, &self.controls.switches));
        if let Err(error) = shown {
            self.controls.switches = *renderer.switches();
            self.show_message(error.to_string());
        }
    }

    /// Draws the map of coverage, which is computed now, or says why there is none.
    pub(super) fn show_coverage(&mut self, failure: Option<PlayError>) {
        let order = match (failure, &mut self.renderer) {
            (Some(error), _) => Err(error),
            (None, Some(renderer)) => renderer.order_tracks(self.flight, &self.controls.switches),
            // It is drawn from the first picture on.
            (None, None) => return,
        };
        match order {
            Ok(order) => self.pictures.order(order),
            Err(error) => {
                tracing::warn!("no map of coverage is drawn: {error}");
                self.show_message(format!("no map of coverage is drawn: {error}"));
            }
        }
    }
}
