//! Events along the motions of a scene's satellites: tables for people and programs.

use super::ephemeris::Layout;
use super::table_span::{reject_live, table_span};
use super::{Flight, PlayError, Satellite};
use std::fmt::Write;
use terrella::frames::{Duration, Epoch, rfc3339};
use terrella_orbit::numerical::EventKind;
use terrella_orbit::{MotionEventKind, SoughtEvents, csv_field, motion_events};

/// The columns of a table of events.
const CSV_HEADER: &str = "name,epoch_utc,event\n";

/// The events of one satellite.
pub struct EventTable<'f> {
    satellite: &'f Satellite,
    span: (Epoch, Epoch),
    /// Times and names, in order of time.
    events: Vec<(Epoch, &'static str)>,
}

impl<'f> EventTable<'f> {
    /// The events from the scene's first epoch on, for this length or to the scene's last epoch, within the satellite's validity.
    ///
    /// They are entries into the Earth's penumbra and umbra, exits, nodes and apsides. Where motion is integrated, nodes and apsides are those that its
    /// scene names, and the other events of the integration are added.
    ///
    /// # Errors
    /// If a simulator gives the states, if there are none in all of the time (the error states the validity), or an error of the feed.
    pub fn new(
        flight: &'f Flight,
        satellite: &'f Satellite,
        length: Option<Duration>,
    ) -> Result<Self, PlayError> {
        reject_live(flight, satellite)?;
        let span = table_span(flight, satellite, length)?;
        let integrated = satellite.events();
        let sought = match integrated {
            Some(_) => SoughtEvents::Shadow,
            None => SoughtEvents::All,
        };
        let orientation = |epoch| flight.orientation_at(epoch);
        let found = motion_events(
            satellite.feed(),
            sought,
            flight.ellipsoid(),
            &orientation,
            span,
        )?;
        let found = found.iter().map(|event| (event.epoch, name(event.kind)));
        let own = integrated.unwrap_or_default().iter();
        let own = own.filter(|event| (span.0..=span.1).contains(&event.epoch));
        let own = own.map(|event| (event.epoch, integrated_name(event.kind)));
        let mut events: Vec<_> = found.chain(own).collect();
        events.sort_by_key(|(epoch, _)| *epoch);
        Ok(Self {
            satellite,
            span,
            events,
        })
    }

    /// Tables as one text, in one of the layouts: one after the other, rows under one header, or an object for one and an
    /// array for more.
    pub fn print(all: &[Self], layout: Layout) -> String {
        layout.print(all, CSV_HEADER, Self::text, Self::csv_rows, Self::json)
    }

    fn text(&self) -> String {
        let mut text = format!(
            "{}: {} events, {} to {}\n",
            self.satellite.name(),
            self.events.len(),
            rfc3339(self.span.0),
            rfc3339(self.span.1)
        );
        for (epoch, name) in &self.events {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{:24}  {name}", rfc3339(*epoch));
        }
        text
    }

    fn csv_rows(&self) -> String {
        let satellite = csv_field(self.satellite.name());
        let mut text = String::new();
        for (epoch, name) in &self.events {
            let _ = writeln!(text, "{satellite},{},{name}", rfc3339(*epoch));
        }
        text
    }

    fn json(&self) -> serde_json::Value {
        let rows = self.events.iter().map(
            |(epoch, name)| serde_json::json!({ "epoch_utc": rfc3339(*epoch), "event": name }),
        );
        serde_json::json!({
            "name": self.satellite.name(),
            "first_utc": rfc3339(self.span.0),
            "last_utc": rfc3339(self.span.1),
            "events": rows.collect::<Vec<_>>(),
        })
    }
}

fn name(kind: MotionEventKind) -> &'static str {
    match kind {
        MotionEventKind::PenumbraEntry => "penumbra begins",
        MotionEventKind::UmbraEntry => "umbra begins",
        MotionEventKind::UmbraExit => "umbra ends",
        MotionEventKind::PenumbraExit => "penumbra ends",
        MotionEventKind::AscendingNode => "ascending node",
        MotionEventKind::DescendingNode => "descending node",
        MotionEventKind::Periapsis => "periapsis",
        MotionEventKind::Apoapsis => "apoapsis",
    }
}

fn integrated_name(kind: EventKind) -> &'static str {
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
