//! Events along the integrated motions of a scene's satellites: tables for people and programs.

use super::ephemeris::Layout;
use super::{PlayError, Satellite};
use std::fmt::Write;
use terrella::frames::rfc3339;
use terrella_orbit::csv_field;
use terrella_orbit::numerical::{Event, EventKind};

/// The columns of a table of events.
const CSV_HEADER: &str = "name,epoch_utc,event\n";

/// The events of one satellite.
pub struct EventTable<'f> {
    satellite: &'f Satellite,
    events: &'f [Event],
}

impl<'f> EventTable<'f> {
    /// The events that its scene looks for, in order of time.
    ///
    /// # Errors
    /// A satellite whose motion is not integrated.
    pub fn new(satellite: &'f Satellite) -> Result<Self, PlayError> {
        let events = satellite.events().ok_or_else(|| PlayError::NoEvents {
            satellite: satellite.name().to_owned(),
        })?;
        Ok(Self { satellite, events })
    }

    /// Tables as one text, in one of the layouts: one after the other, rows under one header, or an object for one and an
    /// array for more.
    pub fn print(all: &[Self], layout: Layout) -> String {
        layout.print(all, CSV_HEADER, Self::text, Self::csv_rows, Self::json)
    }

    fn text(&self) -> String {
        let mut text = format!("{}: {} events\n", self.satellite.name(), self.events.len());
        for event in self.events {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{:24}  {}", rfc3339(event.epoch), name(event.kind));
        }
        text
    }

    fn csv_rows(&self) -> String {
        let satellite = csv_field(self.satellite.name());
        let mut text = String::new();
        for event in self.events {
            let epoch = rfc3339(event.epoch);
            let _ = writeln!(text, "{satellite},{epoch},{}", name(event.kind));
        }
        text
    }

    fn json(&self) -> serde_json::Value {
        let rows = self.events.iter().map(|event| {
            serde_json::json!({ "epoch_utc": rfc3339(event.epoch), "event": name(event.kind) })
        });
        serde_json::json!({
            "name": self.satellite.name(),
            "events": rows.collect::<Vec<_>>(),
        })
    }
}

fn name(kind: EventKind) -> &'static str {
    match kind {
        EventKind::Impact => "impact",
        EventKind::AscendingNode => "ascending node",
        EventKind::DescendingNode => "descending node",
        EventKind::Periapsis => "periapsis",
        EventKind::Apoapsis => "apoapsis",
        EventKind::ShadowEntry => "eclipse begins",
        EventKind::ShadowExit => "eclipse ends",
    }
}
