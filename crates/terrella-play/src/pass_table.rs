//! When a scene's satellite passes over a place: tables for people and programs.

use super::ephemeris::Layout;
use super::table_span::table_span;
use super::{Flight, PlayError, Satellite};
use std::fmt::Write;
use terrella::frames::{Duration, Epoch, Geodetic, rfc3339, rfc3339_with_offset};
use terrella_orbit::{
    LookAngles, Observer, Pass, VisibilityRule, VisibleInterval, csv_field, passes,
    visible_intervals,
};

/// Most passes of one table.
const MAX_PASSES: usize = 100_000;

/// The columns of a table of passes.
const CSV_HEADER: &str = "name,begin_utc,begin_azimuth_deg,rises,highest_utc,highest_azimuth_deg,elevation_deg,distance_km,end_utc,end_azimuth_deg,sets,duration_s,visible_begin_utc,visible_end_utc,brightest_utc,magnitude\n";

/// Which passes are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassRequest {
    /// Over which place, above the scene's figure.
    pub place: Geodetic,
    /// Minimum elevation of a pass, radians, 0…π/2.
    pub min_elevation_rad: f64,
    /// Length of the search from the scene's first epoch; `None` is to its last.
    pub length: Option<Duration>,
    /// When the satellite counts as visible in a pass.
    pub visibility: VisibilityRule,
    /// Largest magnitude at the brightest instant of a visible time, if one is estimated; `None` is any.
    pub max_magnitude: Option<f64>,
    /// The time zone of texts, minutes east of UTC.
    pub time_zone_min: i32,
}

/// The passes of one satellite.
pub struct PassTable<'f> {
    satellite: &'f Satellite,
    place: Geodetic,
    min_elevation_rad: f64,
    span: (Epoch, Epoch),
    rows: Vec<Row>,
    max_magnitude: Option<f64>,
    time_zone_min: i32,
}

/// A pass, with its visibility.
struct Row {
    pass: Pass,
    /// Look angles at the start of the pass, at its maximum elevation and at its end.
    stands: [LookAngles; 3],
    visible: Vec<VisibleInterval>,
}

impl Row {
    fn duration_s(&self) -> f64 {
        (self.pass.end - self.pass.begin).to_seconds()
    }

    /// The longest time that the satellite is visible.
    fn longest(&self) -> Option<&VisibleInterval> {
        self.visible.iter().max_by_key(|one| one.end - one.begin)
    }
}

impl<'f> PassTable<'f> {
    /// Finds the passes within the satellite's validity.
    ///
    /// # Errors
    /// If the satellite has no state in all of the time (the error states its validity), or its feed fails.
    pub fn new(
        flight: &'f Flight,
        satellite: &'f Satellite,
        request: &PassRequest,
    ) -> Result<Self, PlayError> {
        let span = table_span(flight, satellite, request.length)?;
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
                let mut visible =
                    visible_intervals(satellite.feed(), &observer, &pass, &request.visibility)?;
                if let Some(most) = request.max_magnitude {
                    visible.retain(|one| one.brightest.is_none_or(|(_, least)| least <= most));
                }
                Ok(Row {
                    pass,
                    stands: [begin?, highest?, end?],
                    visible,
                })
            })
            .collect::<Result<Vec<_>, PlayError>>()?;
        Ok(Self {
            satellite,
            place: request.place,
            min_elevation_rad,
            span,
            rows,
            max_magnitude: request.max_magnitude,
            time_zone_min: request.time_zone_min,
        })
    }

    /// The passes, in order of time.
    pub fn passes(&self) -> impl Iterator<Item = &Pass> {
        self.rows.iter().map(|row| &row.pass)
    }

    /// Tables as one text, in one of the layouts: one after the other, rows under one header, or an object for one and an
    /// array for more.
    pub fn print(all: &[Self], layout: Layout) -> String {
        layout.print(all, CSV_HEADER, Self::text, Self::csv_rows, Self::json)
    }

    // Writing to a string cannot fail.
    fn text(&self) -> String {
        let time = |epoch| rfc3339_with_offset(epoch, self.time_zone_min);
        let width = time(self.span.0).len();
        let mut text = format!(
            "{} over {:.5}, {:.5}, more than {}° above the horizon, {} to {}\n",
            self.satellite.name(),
            self.place.lat_rad.to_degrees(),
            self.place.lon_rad.to_degrees(),
            rounded(self.min_elevation_rad.to_degrees()),
            time(self.span.0),
            time(self.span.1)
        );
        if self.rows.is_empty() {
            text += "none\n";
            return text;
        }
        let _ = writeln!(
            text,
            "{:width$} {:>7}  {:width$} {:>7} {:>9} {:>9}  {:width$} {:>7} {:>9}",
            "begins",
            "azimuth",
            "highest",
            "azimuth",
            "elevation",
            "km away",
            "ends",
            "azimuth",
            "duration"
        );
        for row in &self.rows {
            let (pass, [begin, highest, end]) = (&row.pass, &row.stands);
            let cut = match (pass.rises, pass.sets) {
                (true, true) => "",
                (false, true) => "  above at the beginning",
                (true, false) => "  above at the end",
                (false, false) => "  above all the time",
            };
            let _ = writeln!(
                text,
                "{} {:>6.1}°  {} {:>6.1}° {:>8.2}° {:>9.1}  {} {:>6.1}° {:>7.1} s{cut}",
                time(pass.begin),
                begin.azimuth_rad.to_degrees(),
                time(pass.highest),
                highest.azimuth_rad.to_degrees(),
                pass.elevation_rad.to_degrees(),
                highest.distance_m / 1e3,
                time(pass.end),
                end.azimuth_rad.to_degrees(),
                row.duration_s()
            );
            for one in &row.visible {
                let brightest = one.brightest.map(|(at, magnitude)| {
                    format!(", brightest at {}: magnitude {magnitude:.1}", time(at))
                });
                let _ = writeln!(
                    text,
                    "  visible {} to {}{}",
                    time(one.begin),
                    time(one.end),
                    brightest.unwrap_or_default()
                );
            }
        }
        if self.rows.iter().all(|row| row.visible.is_empty()) {
            text += "visible in none of them: the satellite is in the Earth's shadow, or the sky is not dark";
            if let Some(most) = self.max_magnitude {
                let _ = write!(text, ", or it is fainter than magnitude {most}");
            }
            text.push('\n');
        }
        text
    }

    fn csv_rows(&self) -> String {
        let name = csv_field(self.satellite.name());
        let mut text = String::new();
        for row in &self.rows {
            let (pass, [begin, highest, end]) = (&row.pass, &row.stands);
            let _ = write!(
                text,
                "{name},{},{:.4},{},{},{:.4},{:.4},{:.4},{},{:.4},{},{:.3},",
                rfc3339(pass.begin),
                begin.azimuth_rad.to_degrees(),
                pass.rises,
                rfc3339(pass.highest),
                highest.azimuth_rad.to_degrees(),
                pass.elevation_rad.to_degrees(),
                highest.distance_m / 1e3,
                rfc3339(pass.end),
                end.azimuth_rad.to_degrees(),
                pass.sets,
                row.duration_s()
            );
            let visible = row.longest();
            let times = visible.map(|one| [one.begin, one.end].map(rfc3339).join(","));
            let brightest = visible.and_then(|one| one.brightest);
            let brightest =
                brightest.map(|(at, magnitude)| format!("{},{magnitude:.2}", rfc3339(at)));
            let [times, brightest] = [times, brightest].map(|two| two.unwrap_or(",".to_owned()));
            let _ = writeln!(text, "{times},{brightest}");
        }
        text
    }

    fn json(&self) -> serde_json::Value {
        let rows = self.rows.iter().map(|row| {
            let (pass, [begin, highest, end]) = (&row.pass, &row.stands);
            let visible = row.visible.iter().map(|one| {
                serde_json::json!({
                    "begin_utc": rfc3339(one.begin),
                    "end_utc": rfc3339(one.end),
                    "brightest_utc": one.brightest.map(|(at, _)| rfc3339(at)),
                    "magnitude": one.brightest.map(|(_, magnitude)| magnitude),
                })
            });
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
                "duration_s": row.duration_s(),
                "visible": visible.collect::<Vec<_>>(),
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
