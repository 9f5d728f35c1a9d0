//! Satellites, stations and lines of a globe, as `earth.js` sets them.

use super::Globe;
use crate::overlay::ShownLines;
use crate::satellites::ShownTracks;
use crate::thrown;
use crate::{almanac, satellites};
use std::time::Duration;
use terrella::Epoch;
use terrella::frames::Geodetic;
use terrella::orbit::{Feed, OrbitError};
use terrella::tracks::{Station, TrackStyle, VectorMap};
use wasm_bindgen::prelude::{JsValue, wasm_bindgen};

#[wasm_bindgen]
impl Globe {
    /// Draws the satellites of a text, as [`satellites::read`] takes it, or one of them by name or catalogue number: beside those that are there or in
    /// their place. An empty text has none. Returns the names of all.
    ///
    /// # Errors
    /// The error in the text, with its line. The satellites are then unchanged.
    #[wasm_bindgen(js_name = setSatellites)]
    pub fn set_satellites(
        &mut self,
        text: &str,
        name: Option<String>,
        are_beside: bool,
    ) -> Result<Vec<String>, JsValue> {
        let feeds = match text.trim().is_empty() {
            true => Vec::new(),
            false => satellites::read(text, name.as_deref()).map_err(thrown)?,
        };
        let (device, earth) = (&self.canvas.device, &self.earth);
        self.overlay
            .set_satellites(device, earth, feeds, are_beside)
            .map_err(thrown)?;
        Ok(self.names())
    }

    /// Draws these parts of satellites, or, without `isChosen`, what suits their number.
    ///
    /// # Errors
    /// A device that cannot draw them. Nothing has then changed.
    #[wasm_bindgen(js_name = setTracks)]
    pub fn set_tracks(
        &mut self,
        is_chosen: bool,
        markers: bool,
        trails: bool,
        ground_tracks: bool,
        subpoints: bool,
        footprints: bool,
    ) -> Result<(), JsValue> {
        let shown = is_chosen.then_some(ShownTracks {
            markers,
            trails,
            ground_tracks,
            subpoints,
            footprints,
        });
        let (device, earth) = (&self.canvas.device, &self.earth);
        self.overlay
            .set_shown_tracks(device, earth, shown)
            .map_err(thrown)
    }

    /// Names of the satellites.
    pub fn names(&self) -> Vec<String> {
        let satellites = self.overlay.satellites.iter();
        satellites.map(|one| one.feed().name().to_owned()).collect()
    }

    /// Takes a packet of JSON, as live feeds send them, which arrived at a time of the page's clock, milliseconds, from a simulator of this rate,
    /// simulated seconds per second. Returns the satellite's index.
    ///
    /// # Errors
    /// A packet without a state. Nothing has then changed.
    pub fn push(&mut self, packet: &str, arrival_ms: f64, rate: f64) -> Result<usize, JsValue> {
        let came = (page_time(arrival_ms), rate);
        let (device, earth) = (&self.canvas.device, &self.earth);
        self.overlay
            .push(device, earth, packet, came)
            .map_err(thrown)
    }

    /// The instant at which pushed states are shown at a time of the page's clock, both in milliseconds; none before the first.
    #[wasm_bindgen(js_name = liveEpoch)]
    pub fn live_epoch(&self, now_ms: f64) -> Option<f64> {
        let epoch = self.overlay.live_epoch(page_time(now_ms))?;
        Some(epoch.to_unix_milliseconds())
    }

    /// Draws stations in place of all others: of each latitude, longitude, elevation mask (degrees) and altitude (metres).
    ///
    /// # Errors
    /// A station that cannot be. The others then stay.
    #[wasm_bindgen(js_name = setStations)]
    pub fn set_stations(&mut self, numbers: &[f64]) -> Result<(), JsValue> {
        let (stations, _) = numbers.as_chunks::<4>();
        let stations = stations.iter().enumerate();
        let stations = stations.map(|(index, &[lat, lon, mask, altitude])| Station {
            place: Geodetic::from_degrees(lat, lon, altitude),
            min_elevation_rad: mask.to_radians(),
            // The palette goes on after the first satellite.
            color: TrackStyle::new(index + 1).color,
            width_px: 2.0,
        });
        let (device, earth) = (&self.canvas.device, &self.earth);
        self.overlay
            .set_stations(device, earth, stations.collect())
            .map_err(thrown)
    }

    /// Takes coast lines and borders, as `lines.bin` among the starter maps holds them.
    ///
    /// # Errors
    /// Another file.
    #[wasm_bindgen(js_name = supplyLines)]
    pub fn supply_lines(&mut self, file: &[u8]) -> Result<(), JsValue> {
        let map = VectorMap::from_bytes(file)
            .map_err(|error| thrown(format!("coast lines and borders: {error}")))?;
        self.overlay.set_vector_map(map);
        Ok(())
    }

    /// Draws lines on the ground.
    ///
    /// # Errors
    /// A device that cannot draw them. Nothing has then changed.
    #[wasm_bindgen(js_name = setLines)]
    pub fn set_lines(
        &mut self,
        coasts: bool,
        borders: bool,
        graticule: bool,
        twilight: bool,
    ) -> Result<(), JsValue> {
        let shown = ShownLines {
            coasts,
            borders,
            graticule,
            twilight,
        };
        let (device, earth) = (&self.canvas.device, &self.earth);
        self.overlay.set_lines(device, earth, shown).map_err(thrown)
    }

    /// Passes of a satellite over a station between two instants: of each its begin, highest point and end (milliseconds since 1970), the greatest
    /// elevation (degrees), and 1 if the satellite can be seen, else 0. None of a satellite or a station that there is not.
    ///
    /// # Errors
    /// A satellite that has decayed.
    pub fn passes(
        &self,
        satellite: usize,
        station: usize,
        from_ms: f64,
        to_ms: f64,
    ) -> Result<Vec<f64>, JsValue> {
        let overlay = &self.overlay;
        let Some(station) = overlay.stations.get(station) else {
            return Ok(Vec::new());
        };
        self.searched(satellite, from_ms, to_ms, |feed, span| {
            let found = almanac::station_passes(feed, station, span)?;
            let numbers = found
                .iter()
                .flat_map(|almanac::SeenPass { pass, is_visible }| {
                    let [begin, highest, end] =
                        [pass.begin, pass.highest, pass.end].map(|at| at.to_unix_milliseconds());
                    let elevation = pass.elevation_rad.to_degrees();
                    [begin, highest, end, elevation, f64::from(*is_visible)]
                });
            Ok(numbers.collect())
        })
    }

    /// Begin and end of each time between two instants at which a satellite is in the Earth's umbra, milliseconds since 1970.
    ///
    /// # Errors
    /// A satellite that has decayed.
    pub fn shadows(&self, satellite: usize, from_ms: f64, to_ms: f64) -> Result<Vec<f64>, JsValue> {
        self.searched(satellite, from_ms, to_ms, |feed, span| {
            let found = almanac::shadows(feed, span)?;
            let ends = found.iter().flat_map(|(begin, end)| [*begin, *end]);
            Ok(ends.map(|at| at.to_unix_milliseconds()).collect())
        })
    }

    /// What a search finds for a satellite; nothing if there is no such satellite.
    fn searched(
        &self,
        satellite: usize,
        from_ms: f64,
        to_ms: f64,
        search: impl FnOnce(&dyn Feed, (Epoch, Epoch)) -> Result<Vec<f64>, OrbitError>,
    ) -> Result<Vec<f64>, JsValue> {
        let days = (to_ms - from_ms) / 86_400_000.0;
        if !(0.0..=almanac::MOST_DAYS).contains(&days) {
            let most = almanac::MOST_DAYS;
            return Err(thrown(format!("a span of {days} days; take 0 to {most}")));
        }
        let Some(satellite) = self.overlay.satellites.get(satellite) else {
            return Ok(Vec::new());
        };
        let span = [from_ms, to_ms].map(Epoch::from_unix_milliseconds);
        search(satellite.feed(), span.into()).map_err(thrown)
    }

    /// The epoch of a satellite's elements or its first state, milliseconds since 1970.
    #[wasm_bindgen(js_name = epochOf)]
    pub fn epoch_of(&self, satellite: usize) -> Option<f64> {
        let satellite = self.overlay.satellites.get(satellite)?;
        Some(satellite.epoch().to_unix_milliseconds())
    }
}

/// A time of the page's clock, which begins with the page.
fn page_time(ms: f64) -> Duration {
    Duration::try_from_secs_f64(ms / 1000.0).unwrap_or_default()
}
