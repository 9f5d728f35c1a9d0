//! When a scene's ground stations and satellites have access to each other: tables for people and programs.

use super::ephemeris::Layout;
use super::{Flight, PlayError, Satellite};
use std::fmt::Write;
use terrella::frames::{Duration, Epoch, rfc3339};
use terrella_orbit::{Access, AccessFrom, AccessRule, Observer, accesses, csv_field};

/// The columns of a table of accesses.
const CSV_HEADER: &str =
    "from,to,begin_utc,starts,end_utc,stops,duration_s,least_range_km,greatest_range_km\n";
/// Most tables of one request.
const MAX_TABLES: usize = 10_000;

/// Which accesses are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AccessRequest {
    /// Conditions of an access besides a line of sight.
    pub rule: AccessRule,
    /// Whether accesses between satellites are included, besides those of stations.
    pub has_crosslinks: bool,
    /// Length of the search from the scene's first epoch; `None` is to its last.
    pub length: Option<Duration>,
}

/// The accesses of one station or satellite to another satellite.
pub struct AccessTable<'f> {
    from: &'f str,
    to: &'f str,
    /// Minimum elevation above the horizon of the station, degrees; `None` from a satellite.
    min_elevation_deg: Option<f64>,
    span: (Epoch, Epoch),
    rows: Vec<Access>,
}

impl<'f> AccessTable<'f> {
    /// Finds the accesses of every station of the scene to each of these satellites, and of the satellites to each other.
    ///
    /// # Errors
    /// No stations and fewer than two satellites, too many of both, or an error of a feed.
    pub fn all(
        flight: &'f Flight,
        satellites: &[&'f Satellite],
        request: &AccessRequest,
    ) -> Result<Vec<Self>, PlayError> {
        let scene = flight.scene();
        let span = scene.time.span(request.length);
        let count = satellites.len();
        let pairs = match request.has_crosslinks {
            true => count * count.saturating_sub(1) / 2,
            false => 0,
        };
        let tables = scene.stations.len() * count + pairs;
        if !(1..=MAX_TABLES).contains(&tables) {
            return Err(PlayError::Accesses {
                scene: scene.path.clone(),
                found: tables,
                most: MAX_TABLES,
            });
        }
        let orientation = |epoch| flight.orientation_at(epoch);
        let table = |name, from: AccessFrom<'_>, to: &'f Satellite| -> Result<Self, PlayError> {
            let (rule, ellipsoid) = (&request.rule, flight.ellipsoid());
            Ok(Self {
                from: name,
                to: to.name(),
                min_elevation_deg: None,
                span,
                rows: accesses(from, to.feed(), rule, ellipsoid, &orientation, span)?,
            })
        };
        let mut all = Vec::with_capacity(tables);
        for station in &scene.stations {
            let mask_rad = station.min_elevation_deg.to_radians();
            let observer = Observer::new(station.place, flight.ellipsoid(), mask_rad, &orientation);
            for &to in satellites {
                let from = AccessFrom::Station(&observer);
                all.push(Self {
                    min_elevation_deg: Some(station.min_elevation_deg),
                    ..table(station.name.as_str(), from, to)?
                });
            }
        }
        if request.has_crosslinks {
            for (index, &from) in satellites.iter().enumerate() {
                for &to in &satellites[index + 1..] {
                    all.push(table(from.name(), AccessFrom::Satellite(from.feed()), to)?);
                }
            }
        }
        Ok(all)
    }

    /// Tables as one text, in one of the layouts: one after the other, rows under one header, or an object for one and an
    /// array for more.
    pub fn print(all: &[Self], layout: Layout) -> String {
        layout.print(all, CSV_HEADER, Self::text, Self::csv_rows, Self::json)
    }

    // Writing to a string cannot fail.
    fn text(&self) -> String {
        let [first, last] = [self.span.0, self.span.1].map(rfc3339);
        let mask = self.min_elevation_deg.map_or_else(String::new, |degrees| {
            format!(", more than {degrees}° above the horizon")
        });
        let mut text = format!("{} to {}{mask}, {first} to {last}\n", self.from, self.to);
        if self.rows.is_empty() {
            text += "none\n";
            return text;
        }
        let width = first.len();
        let _ = writeln!(
            text,
            "{:width$}  {:width$} {:>11} {:>20}",
            "begins", "ends", "duration", "range, km"
        );
        for row in &self.rows {
            let cut = match (row.starts, row.stops) {
                (true, true) => "",
                (false, true) => "  in access at the beginning",
                (true, false) => "  in access at the end",
                (false, false) => "  in access all the time",
            };
            let range = format!("{:.1} to {:.1}", row.range_m.0 / 1e3, row.range_m.1 / 1e3);
            let _ = writeln!(
                text,
                "{:width$}  {:width$} {:>9.1} s {range:>20}{cut}",
                rfc3339(row.begin),
                rfc3339(row.end),
                duration_s(row)
            );
        }
        let total: f64 = self.rows.iter().map(duration_s).sum();
        let _ = writeln!(text, "{} accesses, {total:.1} s in all", self.rows.len());
        text
    }

    fn csv_rows(&self) -> String {
        let [from, to] = [self.from, self.to].map(csv_field);
        let mut text = String::new();
        for row in &self.rows {
            let _ = writeln!(
                text,
                "{from},{to},{},{},{},{},{:.3},{:.4},{:.4}",
                rfc3339(row.begin),
                row.starts,
                rfc3339(row.end),
                row.stops,
                duration_s(row),
                row.range_m.0 / 1e3,
                row.range_m.1 / 1e3
            );
        }
        text
    }

    fn json(&self) -> serde_json::Value {
        let rows = self.rows.iter().map(|row| {
            serde_json::json!({
                "begin_utc": rfc3339(row.begin),
                "starts": row.starts,
                "end_utc": rfc3339(row.end),
                "stops": row.stops,
                "duration_s": duration_s(row),
                "least_range_km": row.range_m.0 / 1e3,
                "greatest_range_km": row.range_m.1 / 1e3,
            })
        });
        serde_json::json!({
            "from": self.from,
            "to": self.to,
            "min_elevation_deg": self.min_elevation_deg,
            "first_utc": rfc3339(self.span.0),
            "last_utc": rfc3339(self.span.1),
            "accesses": rows.collect::<Vec<_>>(),
        })
    }
}

fn duration_s(access: &Access) -> f64 {
    (access.end - access.begin).to_seconds()
}
