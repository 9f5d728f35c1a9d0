//! Films that the window has made: a process of its own for each, so that the window goes on, and the film outlives it.

use super::App;
use crate::film_plan::FilmPlan;
use crate::written::size_text;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::JoinHandle;

/// Most of what a failed film has said that is shown, bytes.
const MAX_WORDS: usize = 2000;

/// A film that is being made.
pub struct Filming {
    process: Child,
    file: PathBuf,
    /// What it says: errors alone.
    words: JoinHandle<String>,
}

impl Filming {
    /// Starts it.
    ///
    /// # Errors
    /// The system's.
    fn start(program: &Path, adapter: Option<&str>, plan: &FilmPlan) -> std::io::Result<Self> {
        let adapter = adapter.map(|name| ["--adapter", name]);
        let mut process = Command::new(program)
            .arg("--quiet")
            .args(adapter.into_iter().flatten())
            .args(&plan.arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()?;
        let stderr = process.stderr.take();
        Ok(Self {
            process,
            file: plan.file.clone(),
            words: std::thread::spawn(move || {
                let mut words = Vec::new();
                if let Some(stderr) = stderr {
                    // What cannot be read is not shown.
                    let _ = stderr.take(MAX_WORDS as u64).read_to_end(&mut words);
                }
                String::from_utf8_lossy(&words).trim().to_owned()
            }),
        })
    }

    /// What has become of it; itself while it is being made.
    fn ended(mut self) -> Result<String, Self> {
        match self.process.try_wait() {
            Ok(None) => return Err(self),
            Ok(Some(status)) if status.success() => {}
            Ok(Some(_)) | Err(_) => {
                let words = self.words.join().unwrap_or_default();
                return Ok(format!("no film: {words}"));
            }
        }
        let size = std::fs::metadata(&self.file).map(|file| file.len());
        let size = size.map_or(String::new(), |size| format!(", {}", size_text(size)));
        Ok(format!("made {}{size}", self.file.display()))
    }
}

impl App<'_> {
    /// Has a film made of what is played.
    pub(super) fn make_film(&mut self) {
        let (Some(program), Some(source)) = (&self.request.program, &self.controls.film) else {
            return;
        };
        if self.filming.is_some() {
            self.show_message("a film is being made; wait until it is there".to_owned());
            return;
        }
        let plan = FilmPlan::new(source, &self.controls.film_view()).fresh();
        match Filming::start(program, self.request.adapter, &plan) {
            Ok(filming) => {
                self.controls.film_in_work = Some(format!("making {}", plan.file.display()));
                // Nothing else acts while it is open.
                self.controls.asks_for_film = false;
                self.show_message(format!(
                    "making {}; the window can be used or closed meanwhile",
                    plan.file.display()
                ));
                self.filming = Some(filming);
            }
            Err(error) => self.show_message(format!("no film: {}: {error}", program.display())),
        }
    }

    /// Says what has become of a film once it is there.
    pub(super) fn look_for_film(&mut self) {
        match self.filming.take().map(Filming::ended) {
            None => {}
            Some(Err(filming)) => self.filming = Some(filming),
            Some(Ok(said)) => {
                self.controls.film_in_work = None;
                self.show_message(said);
                self.redraw();
            }
        }
    }
}
