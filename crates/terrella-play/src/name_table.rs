//! The names of a scene's satellites, in a table.

use super::ephemeris::Layout;
use super::{Flight, Satellite};
use std::fmt::Write;
use terrella::frames::{Epoch, rfc3339};
use terrella_orbit::csv_field;

const CSV_HEADER: &str = "name,catalogue_number,designator,known_from_utc,known_to_utc,id\n";

/// A satellite of the table.
struct Row<'f> {
    name: &'f str,
    catalogue_number: Option<u64>,
    designator: Option<&'f str>,
    /// Its identifier in its file, if that is not its name.
    id: Option<&'f str>,
    /// Its validity; `None` for states from a simulator.
    known: Option<(Epoch, Epoch)>,
}

impl<'f> Row<'f> {
    fn of(satellite: &'f Satellite) -> Self {
        let elements = satellite.elements();
        Self {
            name: satellite.name(),
            catalogue_number: elements.map(|elements| elements.catalogue_number),
            designator: match elements {
                Some(elements) => elements.object_id.as_deref(),
                None => satellite.feed().object_id(),
            },
            id: satellite.feed().id().filter(|id| *id != satellite.name()),
            known: match satellite.live().is_some() || satellite.simulation().is_some() {
                true => None,
                false => Some(satellite.feed().validity()),
            },
        }
    }

    fn number(&self) -> String {
        self.catalogue_number
            .map_or_else(String::new, |number| number.to_string())
    }

    fn known(&self) -> [String; 2] {
        match self.known {
            Some((first, last)) => [rfc3339(first), rfc3339(last)],
            None => [String::new(), String::new()],
        }
    }
}

/// The names of all satellites of a scene in order, with catalogue number and designator as far as known, and the validity of each.
pub fn names(flight: &Flight, layout: Layout) -> String {
    let rows: Vec<_> = flight.satellites().iter().map(Row::of).collect();
    match layout {
        Layout::Text => text(&rows),
        Layout::Csv => rows.iter().fold(CSV_HEADER.to_owned(), |text, row| {
            let [first, last] = row.known();
            let designator = row.designator.map_or_else(String::new, csv_field);
            let (name, number) = (csv_field(row.name), row.number());
            let id = row.id.map_or_else(String::new, csv_field);
            text + &format!("{name},{number},{designator},{first},{last},{id}\n")
        }),
        Layout::Json => {
            let rows = rows.iter().map(|row| {
                serde_json::json!({
                    "name": row.name,
                    "catalogue_number": row.catalogue_number,
                    "designator": row.designator,
                    "id": row.id,
                    "known_utc": row.known.map(|(first, last)| [rfc3339(first), rfc3339(last)]),
                })
            });
            format!("{:#}\n", serde_json::Value::Array(rows.collect()))
        }
    }
}

fn text(rows: &[Row<'_>]) -> String {
    let widest = rows.iter().map(|row| row.name.chars().count()).max();
    let width = widest.unwrap_or_default().min(40);
    rows.iter().fold(String::new(), |mut text, row| {
        let designator = row.designator.unwrap_or_default();
        let known = match row.known {
            Some(_) => format!("known {}", row.known().join(" to ")),
            None => "known when a simulator sends it".to_owned(),
        };
        let id = row.id.map_or_else(String::new, |id| format!(", id {id}"));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<width$}  {:>9}  {designator:<11}  {known}{id}",
            row.name,
            row.number()
        );
        text
    })
}
