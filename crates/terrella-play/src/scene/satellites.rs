//! Checks that need the opened satellites: followed names, and sources without data.

use super::Scene;
use super::choices::CameraMode;
use super::error::{KeyLocation, SceneError, printable};
use super::look_at::ON_BOARD;
use super::record::Record;
use super::text::nearest;
use super::time::utc;
use terrella::frames::Epoch;

impl Scene {
    /// The index, in [`Self::orbits`], of the satellite that the camera follows. `names` are those of all satellites,
    /// in that order. A name given in `[orbit]` also counts. 0 without `[camera] follow`.
    ///
    /// # Errors
    /// `follow` matches none of them, or more than one.
    pub fn followed(&self, names: &[&str]) -> Result<usize, SceneError> {
        let Some(wanted) = &self.camera.follow else {
            return Ok(0);
        };
        self.satellite(wanted, names).map_err(|remedy| {
            self.rejection(
                "camera",
                "follow",
                self.line("camera", "follow"),
                wanted,
                remedy,
            )
        })
    }

    /// The index of the satellite that the camera looks at: the one with this name, or the followed one.
    ///
    /// # Errors
    /// There is none, or the camera is on board.
    pub(crate) fn looked_at(
        &self,
        wanted: Option<&str>,
        names: &[&str],
        followed: usize,
    ) -> Result<usize, SceneError> {
        let reject = |remedy: String| {
            let line = self.line("camera", "look_at");
            let value = wanted.unwrap_or("satellite");
            self.rejection("camera", "look_at", line, value, remedy)
        };
        let index = match wanted {
            Some(name) => self.satellite(name, names).map_err(reject)?,
            None if names.is_empty() => {
                return Err(reject("the scene has no satellite".to_owned()));
            }
            None => followed,
        };
        let is_on_board = matches!(self.camera.mode, CameraMode::Nadir | CameraMode::Horizon);
        match is_on_board && index == followed {
            true => Err(reject(ON_BOARD.to_owned())),
            false => Ok(index),
        }
    }

    /// The indices of the satellites on the coverage map; none without a map.
    ///
    /// # Errors
    /// A name that matches none of them, or more than one.
    pub(crate) fn coverage_satellites(&self, names: &[&str]) -> Result<Vec<usize>, SceneError> {
        let Some(table) = &self.coverage else {
            return Ok(Vec::new());
        };
        if table.satellites.is_empty() {
            return Ok((0..names.len()).collect());
        }
        let found = table.satellites.iter().map(|wanted| {
            self.satellite(wanted, names).map_err(|remedy| {
                let line = self.line("coverage", "satellites");
                self.rejection("coverage", "satellites", line, wanted, remedy)
            })
        });
        let mut found = found.collect::<Result<Vec<_>, _>>()?;
        found.sort_unstable();
        found.dedup();
        Ok(found)
    }

    /// The index of a satellite by name, ignoring case, with the matching of [`Self::followed`].
    ///
    /// # Errors
    /// The remedy for a message: the nearest name and all names.
    pub fn satellite(&self, wanted: &str, names: &[&str]) -> Result<usize, String> {
        let folded = wanted.trim().to_lowercase();
        let is_it = |index: usize, name: &str| {
            let own = self
                .orbits
                .get(index)
                .and_then(|orbit| orbit.name.as_deref());
            [Some(name), own]
                .into_iter()
                .flatten()
                .any(|name| name.trim().to_lowercase() == folded)
        };
        let found: Vec<usize> = names
            .iter()
            .enumerate()
            .filter(|(index, name)| is_it(*index, name))
            .map(|(index, _)| index)
            .collect();
        let list = || {
            let few = names
                .iter()
                .take(10)
                .map(|name| format!("\"{}\"", printable(name)));
            let more = if names.len() > 10 { ", …" } else { "" };
            few.collect::<Vec<_>>().join(", ") + more
        };
        match found.as_slice() {
            [only] => Ok(*only),
            [] => {
                // Names are compared ignoring case, and so is their similarity.
                let lower: Vec<_> = names.iter().map(|name| name.to_lowercase()).collect();
                let near = nearest(&folded, lower.iter().map(String::as_str))
                    .and_then(|near| lower.iter().position(|name| name == near))
                    .and_then(|index| names.get(index));
                Err(match near {
                    Some(near) => format!(
                        "no satellite of the scene has that name; did you mean \"{}\"? It has {}",
                        printable(near),
                        list()
                    ),
                    None => {
                        format!("no satellite of the scene has that name; it has {}", list())
                    }
                })
            }
            several => Err(format!(
                "{} satellites of the scene have that name; give them names of their own by name in [[orbit]]",
                several.len()
            )),
        }
    }

    /// The error that rejects the satellite at this index, at the line of its key.
    pub fn reject_orbit(&self, orbit: usize, key: &str, value: &str, remedy: String) -> SceneError {
        let record = self.orbit_records.get(self.orbit_table(orbit));
        let any = record.and_then(Record::first_line);
        let line = self.orbit_line(orbit, key).or(any);
        self.rejection("orbit", key, line, value, remedy)
    }

    /// Rejects a scene that extends beyond `span`, the span of its table of the Earth's orientation.
    ///
    /// # Errors
    /// An error that states the table's span.
    pub fn check_orientation(&self, span: (Epoch, Epoch)) -> Result<(), SceneError> {
        let (start, end) = (self.time.start, self.time.end());
        let (first, last) = (start.min(end), start.max(end));
        if span.0 <= first && last <= span.1 {
            return Ok(());
        }
        let shown = self
            .time
            .orientation
            .as_ref()
            .map(|path| path.display().to_string());
        let remedy = format!(
            "the table covers {} to {}, the flight {} to {}; use a table that covers it, or omit orientation",
            utc(span.0),
            utc(span.1),
            utc(first),
            utc(last)
        );
        let line = self.line("time", "orientation");
        Err(self.rejection(
            "time",
            "orientation",
            line,
            &shown.unwrap_or_default(),
            remedy,
        ))
    }

    fn rejection(
        &self,
        table: &str,
        key: &str,
        line: Option<usize>,
        value: &str,
        remedy: String,
    ) -> SceneError {
        SceneError::Value {
            place: Box::new(KeyLocation {
                path: self.path.clone(),
                line,
                table: table.to_owned(),
                key: key.to_owned(),
            }),
            value: format!("\"{}\"", printable(value)),
            remedy,
        }
    }
}
