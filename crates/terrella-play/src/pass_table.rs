//! When a scene's satellite passes over a place: tables for people and programs.

use super::ephemeris::Layout;
use super::{Flight, PlayError, Satellite};
use std::fmt::Write;
use terrella::frames::{Duration, Epoch, Geodetic, rfc3339};
use terrella_orbit::{LookAngles, Observer, Pass, csv_field, passes};

/// Most passes of one table.
const MAX_PASSES: usize = 100_000;

/// The columns of a table of passes.
const CSV_HEADER: &str = "name,begin_utc,begin_azimuth_deg,rises,highest_utc,highest_azimuth_deg,elevation_deg,distance_km,end_utc,end_azimuth_deg,sets\n";

/// Which passes are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassRequest {
    /// Over which place, above the scene's figure.
    pub place: Geodetic,
    /// Minimum elevation of a pass, radians, 0…π/2.
    pub min_elevation_rad: f64,
    /// For how long from the scene's first instant on; `None` is to its last.
    pub length: Option<Duration>,
}

/// The passes of one satellite.
pub struct PassTable<'f> {
    satellite: &'f Satellite,
    place: Geodetic,
    min_elevation_rad: f64,
    span: (Epoch, Epoch),
    rows: Vec<(Pass, [LookAngles; 3])>,
}

impl<'f> PassTable<'f> {
    /// Looks for them, as far as the satellite is known.
    ///
    /// # Errors
    /// If the satellite is not known in any of the time (the error says when it is), or its feed fails in it.
    pub fn new(
        flight: &'f Flight,
        satellite: &'f Satellite,
        request: &PassRequest,
    ) -> Result<Self, PlayError> {
        let time = &flight.scene().time;
        let first = time.start.min(time.end());
        let last = match request.length {
            Some(length) => first + length,
            None => time.start.max(time.end()),
        };
        let known = satellite.feed().validity();
        let span = (first.max(known.0), last.min(known.1));
        if span.0 > span.1 {
            // It says when it is known.
            satellite.feed().state_at(first)?;
        }
        let orientation = |epoch| flight.orientation_at(epoch);
        let min_elevation_rad = request.min_elevation_rad;
        let observer = Observer::new(
            request.place,
            flight.ellipsoid(),
            min_elevation_rad,
            &orientation,
        );
        let bearing = |epoch| -> Result<_, PlayError> {
            Ok(observer.look_angles(&satellite.feed().state_at(epoch)?))
        };
        let rows = passes(satellite.feed(), &observer, span.0, span.1)
            .take(MAX_PASSES)
            .map(|pass| {
                let pass = pass?;
                let at = [pass.begin, pass.highest, pass.end];
                let [begin, highest, end] = at.map(bearing);
                Ok((pass, [begin?, highest?, end?]))
            })
            .collect::<Result<Vec<_>, PlayError>>()?;
        Ok(Self {
            satellite,
            place: request.place,
            min_elevation_rad,
            span,
            rows,
        })
    }

    /// The passes, in order of time.
    pub fn passes(&self) -> impl Iterator<Item = &Pass> {
        self.rows.iter().map(|(pass, _)| pass)
    }

    /// Tables as one text, in one of the layouts: one after the other, rows under one header, or an object for one and an
    /// array for more.
    pub fn print(all: &[Self], layout: Layout) -> String {
        layout.print(all, CSV_HEADER, Self::text, Self::csv_rows, Self::json)
    }

    // Writing to a string cannot fail.
    fn text(&self) -> String {
        let mut text = format!(
            "{} over {:.5}, {:.5}, more than {}° above the horizon, {} to {}\n",
            self.satellite.name(),
            self.place.lat_rad.to_degrees(),
            self.place.lon_rad.to_degrees(),
            rounded(self.min_elevation_rad.to_degrees()),
            rfc3339(self.span.0),
            rfc3339(self.span.1)
        );
        if self.rows.is_empty() {
            text += "none\n";
            return text;
        }
        let _ = writeln!(
            text,
            "{:24} {:>7}  {:24} {:>7} {:>9} {:>9}  {:24} {:>7}",
            "begins", "azimuth", "highest", "azimuth", "elevation", "km away", "ends", "azimuth"
        );
        for (pass, [begin, highest, end]) in &self.rows {
            let cut = match (pass.rises, pass.sets) {
                (true, true) => "",
                (false, true) => "  above at the beginning",
                (true, false) => "  above at the end",
                (false, false) => "  above all the time",
            };
            let _ = writeln!(
                text,
                "{:24} {:>6.1}°  {:24} {:>6.1}° {:>8.2}° {:>9.1}  {:24} {:>6.1}°{cut}",
                rfc3339(pass.begin),
                begin.azimuth_rad.to_degrees(),
                rfc3339(pass.highest),
                highest.azimuth_rad.to_degrees(),
                pass.elevation_rad.to_degrees(),
                highest.distance_m / 1e3,
                rfc3339(pass.end),
                end.azimuth_rad.to_degrees()
            );
        }
        text
    }

    fn csv_rows(&self) -> String {
        let name = csv_field(self.satellite.name());
        let mut text = String::new();
        for (pass, [begin, highest, end]) in &self.rows {
            let _ = writeln!(
                text,
                "{name},{},{:.4},{},{},{:.4},{:.4},{:.4},{},{:.4},{}",
                rfc3339(pass.begin),
                begin.azimuth_rad.to_degrees(),
                pass.rises,
                rfc3339(pass.highest),
                highest.azimuth_rad.to_degrees(),
                pass.elevation_rad.to_degrees(),
                highest.distance_m / 1e3,
                rfc3339(pass.end),
                end.azimuth_rad.to_degrees(),
                pass.sets
            );
        }
        text
    }

    fn json(&self) -> serde_json::Value {
        let rows = self.rows.iter().map(|(pass, [begin, highest, end])| {
            serde_json::json!({
                "begin_utc": rfc3339(pass.begin),
                "begin_azimuth_deg": begin.azimuth_rad.to_degrees(),
                "rises": pass.rises,
                "highest_utc": rfc3339(pass.highest),
                "highest_azimuth_deg": highest.azimuth_rad.to_degrees(),
                "elevation_deg": pass.elevation_rad.to_degrees(),
                "distance_km": highest.distance_m / 1e3,
                "end_utc": rfc3339(pass.end),
                "end_azimuth_deg": end.azimuth_rad.to_degrees(),
                "sets": pass.sets,
            })
        });
        serde_json::json!({
            "name": self.satellite.name(),
            "lat_deg": self.place.lat_rad.to_degrees(),
            "lon_deg": self.place.lon_rad.to_degrees(),
            "height_m": self.place.height_m,
            "least_elevation_deg": self.min_elevation_rad.to_degrees(),
            "first_utc": rfc3339(self.span.0),
            "last_utc": rfc3339(self.span.1),
            "passes": rows.collect::<Vec<_>>(),
        })
    }
}

/// Degrees that came from radians, without the digits of that.
fn rounded(degrees: f64) -> f64 {
    (degrees * 1e6).round() * 1e-6
}
