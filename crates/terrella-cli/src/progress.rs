//! Progress bars on standard error, where that is a terminal.

use super::interruption;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::Write;
use std::sync::Mutex;
use std::time::Duration;
use terrella_play::Progress;

/// One bar at a time.
pub struct Bars {
    hidden: bool,
    bar: Mutex<Option<ProgressBar>>,
}

impl Bars {
    /// Hidden on request; indicatif itself shows nothing where standard error is no terminal.
    pub fn new(hidden: bool) -> Self {
        Self {
            hidden,
            bar: Mutex::new(None),
        }
    }

    fn with(&self, change: impl FnOnce(&mut Option<ProgressBar>)) {
        // A panic elsewhere leaves a bar that is as good as before.
        change(
            &mut self
                .bar
                .lock()
                .unwrap_or_else(|poisoned| poisoned.into_inner()),
        );
    }
}

impl Progress for Bars {
    fn begin(&self, what: &str, steps: Option<u64>) {
        if self.hidden {
            return;
        }
        let (bar, template) = match steps {
            Some(steps) => (
                ProgressBar::new(steps),
                "{msg} {wide_bar} {pos}/{len}, {per_sec}, {eta} left",
            ),
            None => (ProgressBar::new_spinner(), "{spinner} {msg} {elapsed}"),
        };
        bar.set_draw_target(ProgressDrawTarget::stderr());
        // The templates are good (a test reads them); the default style serves as well.
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_message(what.to_owned());
        bar.enable_steady_tick(Duration::from_millis(120));
        self.with(|present| *present = Some(bar));
    }

    fn step(&self) {
        self.with(|bar| {
            if let Some(bar) = bar {
                bar.inc(1);
            }
        });
    }

    fn say(&self, line: &str) {
        if !self.hidden {
            // No one can be informed if standard error is closed.
            let _ = writeln!(std::io::stderr(), "{line}");
        }
    }

    fn cancelled(&self) -> bool {
        interruption::is_asked()
    }

    fn end(&self) {
        self.with(|bar| {
            if let Some(bar) = bar.take() {
                bar.finish_and_clear();
            }
        });
    }
}

impl Drop for Bars {
    /// An error must not be printed into a bar.
    fn drop(&mut self) {
        self.end();
    }
}
