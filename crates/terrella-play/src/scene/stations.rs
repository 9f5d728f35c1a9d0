//! `[[station]]`: ground stations.

use super::Scene;
use super::error::{SceneError, printable};
use super::field::{Field, range_text};
use super::globe_keys::{MAX_STATIONS, RawStation};
use super::record::{number_text, quoted};
use super::text::SceneText;
use std::ops::RangeInclusive;
use terrella::frames::Geodetic;

/// Why keys of a station have no value.
pub(super) const NO_STATION: &str = "the scene has no [[station]]";

/// Maximum name length, characters.
const MAX_NAME_CHARS: usize = 100;

/// A ground station.
#[derive(Clone, Debug, PartialEq)]
pub struct StationTable {
    /// What it is called.
    pub name: String,
    /// Where it stands; the height is above the ellipsoid.
    pub place: Geodetic,
    /// Minimum elevation of a satellite above the horizon, degrees.
    pub min_elevation_deg: f64,
    /// Display values (sRGB); `None` is the next of the usual ones.
    pub color: Option<[u8; 3]>,
}

impl SceneText<'_> {
    /// Checks all `[[station]]` tables.
    pub(super) fn stations(&self, raw: &[RawStation]) -> Result<Vec<StationTable>, SceneError> {
        if let Some(station) = raw.get(MAX_STATIONS) {
            let advice = format!(
                "a scene has at most {MAX_STATIONS} ground stations and this one {}; leave some out",
                raw.len()
            );
            return Err(self.reject(&station.name(), advice));
        }
        raw.iter().map(|station| self.station(station)).collect()
    }

    fn station(&self, station: &RawStation) -> Result<StationTable, SceneError> {
        let field = station.name();
        let name = match field.given.map(|name| name.get_ref().trim()) {
            None => {
                let remedy = "a ground station needs a name, which is written beside its mark; add name = \"…\"";
                return Err(self.missing(&field, station.given(), remedy));
            }
            Some("") => {
                let advice = "must not be empty: it is written beside the station's mark";
                return Err(self.reject(&field, advice));
            }
            Some(name) if name.chars().count() > MAX_NAME_CHARS => {
                let advice = format!("must have at most {MAX_NAME_CHARS} characters");
                return Err(self.reject(&field, advice));
            }
            Some(name) => name.to_owned(),
        };
        field.note(quoted(&name));
        let lat_deg = self.angle(station, &station.lat_deg(), "latitude")?;
        let lon_deg = self.angle(station, &station.lon_deg(), "longitude")?;
        let height_m = self.quantity(&station.height_m())?;
        // −180…180, as for places on the ground.
        let lon_deg = lon_deg - 360.0 * (lon_deg / 360.0).round();
        Ok(StationTable {
            name,
            place: Geodetic::from_degrees(lat_deg, lon_deg, height_m),
            min_elevation_deg: self.quantity(&station.min_elevation_deg())?,
            color: self.color(&station.color())?,
        })
    }

    /// A required angle of a station.
    fn angle(
        &self,
        station: &RawStation,
        field: &Field<'_, f64, RangeInclusive<f64>>,
        what: &str,
    ) -> Result<f64, SceneError> {
        let Some(degrees) = field.value() else {
            let remedy = format!(
                "a ground station needs its {what}; add {} = … in degrees",
                field.key
            );
            return Err(self.missing(field, station.given(), remedy));
        };
        let degrees = self.in_range(field, degrees, &field.rule, |_| {
            format!("must be from {} degrees", range_text(&field.rule))
        })?;
        field.note(Ok(number_text(degrees)));
        Ok(degrees)
    }
}

impl Scene {
    /// Adds a ground station after those of the scene; the minimum elevation of satellites is in degrees.
    pub fn add_station(&mut self, name: &str, place: Geodetic, min_elevation_deg: f64) {
        self.stations.push(StationTable {
            name: name.to_owned(),
            place,
            min_elevation_deg,
            color: None,
        });
    }

    /// Descriptions of all stations with their positions.
    pub(super) fn station_uses(&self) -> impl Iterator<Item = (&'static str, String)> {
        self.stations.iter().map(|station| {
            let place = &station.place;
            let text = format!(
                "{}: {:.4}° latitude, {:.4}° longitude, {} m, satellites from {}° above the horizon",
                printable(&station.name),
                place.lat_rad.to_degrees(),
                place.lon_rad.to_degrees(),
                number_text(place.height_m),
                number_text(station.min_elevation_deg)
            );
            ("station", text)
        })
    }
}
