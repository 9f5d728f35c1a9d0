//! Where a scene's satellites are: tables for people and programs, and messages for other programs.

use super::stretches::stretches;
use super::table_span::reject_live;
use super::{Flight, PlayError, Satellite};
use std::fmt::Write;
use std::path::Path;
use terrella::frames::{
    Duration, Epoch, Geodetic, Illumination, TimeScale, ccsds_time, illumination,
    sun_position_itrf_m,
};
use terrella_orbit::interpolated::{EphemerisSegment, InterpolatedStates, Interpolation};
use terrella_orbit::{
    EphemerisFeed, Feed, Frame, Header, OrbitState, csv_header, csv_row, write_oem, write_omm,
};

/// Most rows of one ephemeris.
const MAX_ROWS: u64 = 1_000_000;

/// Instants to print.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Span {
    /// One.
    At(Epoch),
    /// From the scene's first instant on, a step apart.
    Every {
        /// The step.
        step: Duration,
        /// The length, as far as the satellite is known; `None` is to the scene's last instant.
        length: Option<Duration>,
        /// Whether the last instant is one of them even if it is not a whole number of steps from the first.
        has_end: bool,
    },
}

/// The axes of the states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// Position and velocity in a frame.
    Frame(Frame),
    /// Latitude, longitude and height; tables with position columns use ITRF.
    Geodetic,
}

impl Axes {
    /// The frame of columns of position.
    pub fn frame(self) -> Frame {
        match self {
            Self::Frame(frame) => frame,
            Self::Geodetic => Frame::Itrf,
        }
    }
}

/// How an ephemeris is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Columns for people.
    Text,
    /// As [`Ephemerides`](terrella_orbit::Ephemerides) reads it.
    Csv,
    /// An object with `name`, `frame` and an array `states`.
    Json,
}

impl Layout {
    /// That of the options --csv and --json.
    pub fn of(csv: bool, json: bool) -> Self {
        match (csv, json) {
            (true, _) => Self::Csv,
            (_, true) => Self::Json,
            _ => Self::Text,
        }
    }

    /// Tables of several satellites as one text: one after the other, rows under one header, or an object for one and an array
    /// for more.
    pub(super) fn print<T>(
        self,
        all: &[T],
        csv_header: &str,
        text: impl FnMut(&T) -> String,
        mut csv_rows: impl FnMut(&T) -> String,
        to_json: impl FnMut(&T) -> serde_json::Value,
    ) -> String {
        match self {
            Self::Text => all.iter().map(text).collect::<Vec<_>>().join("\n"),
            Self::Csv => all
                .iter()
                .fold(csv_header.to_owned(), |text, one| text + &csv_rows(one)),
            Self::Json => json(all.iter().map(to_json).collect()),
        }
    }
}

/// Satellites of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selection<'n> {
    /// The one that cameras follow.
    Followed,
    /// Those of these names.
    Named(&'n [String]),
    /// All.
    All,
}

/// Which ephemeris is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EphemerisRequest {
    /// First and last epoch, and the step.
    pub span: Span,
    /// Axes of the states.
    pub axes: Axes,
    /// Whether instants at which the satellite is not known are left out and counted, as long as one is left.
    pub where_known: bool,
}

/// The states of one satellite.
pub struct Ephemeris<'f> {
    flight: &'f Flight,
    satellite: &'f Satellite,
    axes: Axes,
    states: Vec<OrbitState>,
    left_out: usize,
}

impl<'f> Ephemeris<'f> {
    /// Requests all states from the satellite before anything is printed.
    ///
    /// # Errors
    /// If an epoch is outside its validity (the error states the interval), or there are more than a million.
    pub fn new(
        flight: &'f Flight,
        satellite: &'f Satellite,
        request: &EphemerisRequest,
    ) -> Result<Self, PlayError> {
        reject_live(flight, satellite)?;
        let frame = request.axes.frame();
        let mut states = Vec::new();
        let mut unknown = Vec::new();
        for epoch in epochs(flight, satellite, request.span)? {
            match satellite.feed().state_at(epoch) {
                Ok(state) => states.push(state.in_frame(frame, &flight.orientation_at(epoch))),
                Err(error) if request.where_known => unknown.push(error),
                Err(error) => return Err(error.into()),
            }
        }
        let left_out = unknown.len();
        match unknown.into_iter().next() {
            Some(error) if states.is_empty() => Err(error.into()),
            _ => Ok(Self {
                flight,
                satellite,
                axes: request.axes,
                states,
                left_out,
            }),
        }
    }

    /// The satellite.
    pub fn satellite(&self) -> &'f Satellite {
        self.satellite
    }

    /// Number of instants at which it is not known.
    pub fn left_out(&self) -> usize {
        self.left_out
    }

    /// The states, in the requested frame.
    pub fn states(&self) -> &[OrbitState] {
        &self.states
    }

    /// Ephemerides as one text, in one of the layouts: tables one after the other, rows under one header, or an object for
    /// one and an array for more.
    pub fn print(all: &[Self], layout: Layout) -> String {
        let csv_header = format!("{},light\n", csv_header().trim_end());
        layout.print(all, &csv_header, Self::text, Self::csv_rows, Self::json)
    }

    fn csv_rows(&self) -> String {
        let rows = self.states.iter().map(|state| {
            let error_m = self.satellite.feed().error_m(state.epoch);
            let row = csv_row(self.satellite.name(), state, &self.place(state), error_m);
            format!("{},{}\n", row.trim_end(), self.illumination(state).0.name())
        });
        rows.collect()
    }

    fn text(&self) -> String {
        let mut text = format!("{}, ", self.satellite.name());
        text += match self.axes {
            Axes::Geodetic => "latitude and longitude in degrees, height in km; light\n",
            Axes::Frame(_) => "position in km, velocity in km/s; light; ",
        };
        if let Axes::Frame(frame) = self.axes {
            text += frame.name();
            text.push('\n');
        }
        for state in &self.states {
            let (r, v) = (state.position_m / 1e3, state.velocity_m_s / 1e3);
            let place = self.place(state);
            let light = self.illumination(state).0.name();
            let error = match self.satellite.feed().error_m(state.epoch) {
                Some(error_m) => format!("  ±{error_m:.1} m"),
                None => String::new(),
            };
            // Writing to a string cannot fail.
            let _ = match self.axes {
                Axes::Geodetic => writeln!(
                    text,
                    "{}  {:>11.6} {:>12.6} {:>14.5}  {light}{error}",
                    utc(state.epoch),
                    place.lat_rad.to_degrees(),
                    place.lon_rad.to_degrees(),
                    place.height_m / 1e3
                ),
                Axes::Frame(_) => writeln!(
                    text,
                    "{}  {:>14.6} {:>14.6} {:>14.6}  {:>13.9} {:>13.9} {:>13.9}  {light}{error}",
                    utc(state.epoch),
                    r.x,
                    r.y,
                    r.z,
                    v.x,
                    v.y,
                    v.z
                ),
            };
        }
        if let Some((epoch, place)) = self.flight.impact(self.satellite) {
            let _ = writeln!(text, "meets the ground at {}, {place}", utc(epoch));
        }
        text
    }

    fn json(&self) -> serde_json::Value {
        let rows = self.states.iter().map(|state| {
            let (r, v) = (state.position_m / 1e3, state.velocity_m_s / 1e3);
            let place = self.place(state);
            let (light, sunlight) = self.illumination(state);
            serde_json::json!({
                "epoch_utc": utc(state.epoch),
                "position_km": r.to_array(),
                "velocity_km_s": v.to_array(),
                "lat_deg": place.lat_rad.to_degrees(),
                "lon_deg": place.lon_rad.to_degrees(),
                "height_km": place.height_m / 1e3,
                "light": light.name(),
                "sunlight": sunlight,
                "error_m": self.satellite.feed().error_m(state.epoch),
            })
        });
        let impact = self.flight.impact(self.satellite).map(|(epoch, place)| {
            serde_json::json!({
                "epoch_utc": utc(epoch),
                "lat_deg": place.lat_deg,
                "lon_deg": place.lon_deg,
            })
        });
        serde_json::json!({
            "name": self.satellite.name(),
            "frame": self.axes.frame().name(),
            "states": rows.collect::<Vec<_>>(),
            "impact": impact,
        })
    }

    /// How much of the Sun is visible at a state: its class, and the fraction of the disc.
    fn illumination(&self, state: &OrbitState) -> (Illumination, f64) {
        let orientation = self.flight.orientation_at(state.epoch);
        let sun_itrf_m = sun_position_itrf_m(state.epoch, &orientation);
        let itrf = state.in_frame(Frame::Itrf, &orientation);
        illumination(itrf.position_m, sun_itrf_m, self.flight.ellipsoid())
    }

    /// The place above the scene's figure.
    fn place(&self, state: &OrbitState) -> Geodetic {
        let itrf = state.in_frame(Frame::Itrf, &self.flight.orientation_at(state.epoch));
        self.flight.ellipsoid().geodetic_from_itrf(itrf.position_m)
    }

    /// The states as an orbit ephemeris message, in segments where the motion is not smooth or not known, for the file `path`, and how far what a reader interpolates is from the
    /// satellite half-way between states, metres at most.
    ///
    /// # Errors
    /// A frame that no such message names, or fewer states than an interpolation needs.
    pub fn oem(&self, path: &Path, header: &Header) -> Result<(String, f64), PlayError> {
        let reject = |cause: String| PlayError::NoEphemeris {
            path: path.to_owned(),
            satellite: self.satellite.name().to_owned(),
            cause,
        };
        let frame = self.axes.frame();
        if frame == Frame::Pef {
            return Err(reject(
                "the format has no name for PEF; take --frame itrf".to_owned(),
            ));
        }
        let mut segments = Vec::new();
        for samples in stretches(self.satellite.feed(), &self.states, |state| {
            state.in_frame(frame, &self.flight.orientation_at(state.epoch))
        })? {
            let sampled = InterpolatedStates::new(frame, &samples, Interpolation::WITH_VELOCITIES)
                .map_err(|error| reject(format!("{error}; take a smaller step with --every")))?;
            segments.push(EphemerisSegment::whole(sampled));
        }
        let id = self.satellite.feed().object_id().map(str::to_owned);
        let name = self.satellite.name().to_owned();
        let feed =
            EphemerisFeed::new(name, id, segments).map_err(|error| reject(error.to_string()))?;
        let mut worst_m = 0.0_f64;
        for segment in feed.segments() {
            let epochs: Vec<_> = segment.samples.samples().map(|one| one.epoch).collect();
            for (a, b) in epochs.iter().zip(epochs.iter().skip(1)) {
                let middle = *a + (*b - *a) * 0.5;
                let orientation = self.flight.orientation_at(middle);
                let meant = self.satellite.feed().state_at(middle)?;
                let meant = meant.in_frame(frame, &orientation).position_m;
                worst_m = worst_m.max((feed.state_at(middle)?.position_m - meant).length());
            }
        }
        Ok((write_oem(&feed, header), worst_m))
    }
}

/// Mean elements as an orbit mean-elements message, for the file `path`.
///
/// # Errors
/// If a satellite has none, or there is no satellite.
pub fn omm(wanted: &[&Satellite], path: &Path, header: &Header) -> Result<String, PlayError> {
    let elements = wanted.iter().map(|one| {
        one.elements()
            .cloned()
            .ok_or_else(|| PlayError::NoElements {
                path: path.to_owned(),
                satellite: one.name().to_owned(),
            })
    });
    let elements = elements.collect::<Result<Vec<_>, _>>()?;
    match elements.is_empty() {
        true => Err(PlayError::NoSatellite),
        false => Ok(write_omm(&elements, header)),
    }
}

/// With all decimals: a millisecond is metres of flight.
fn utc(epoch: Epoch) -> String {
    ccsds_time(epoch, TimeScale::Utc) + "Z"
}

/// Machine-readable output: an object for one satellite, an array for several.
fn json(mut documents: Vec<serde_json::Value>) -> String {
    let document = match documents.len() {
        1 => documents.swap_remove(0),
        _ => serde_json::Value::Array(documents),
    };
    format!("{document:#}\n")
}

/// The requested satellites of a scene, each once.
///
/// # Errors
/// A name that is unknown or ambiguous, or a scene without satellites.
pub fn select<'f>(
    flight: &'f Flight,
    selection: Selection<'_>,
) -> Result<Vec<&'f Satellite>, PlayError> {
    let satellites = flight.satellites();
    let mut indices = Vec::new();
    match selection {
        Selection::Followed => indices.push(flight.followed()),
        Selection::All => indices.extend(0..satellites.len()),
        Selection::Named(wanted) => {
            let names: Vec<_> = satellites.iter().map(Satellite::name).collect();
            let scene = flight.scene();
            for wanted in wanted {
                let reject = |remedy| PlayError::UnknownSatellite {
                    scene: scene.path.clone(),
                    wanted: wanted.clone(),
                    remedy,
                };
                let index = scene.satellite(wanted, &names).map_err(reject)?;
                if !indices.contains(&index) {
                    indices.push(index);
                }
            }
        }
    }
    let selected: Vec<_> = indices
        .into_iter()
        .filter_map(|index| satellites.get(index))
        .collect();
    match selected.is_empty() {
        true => Err(PlayError::NoSatellite),
        false => Ok(selected),
    }
}

/// In the order of time, whichever way the scene is played.
fn epochs(flight: &Flight, satellite: &Satellite, span: Span) -> Result<Vec<Epoch>, PlayError> {
    let (step, length, has_end) = match span {
        Span::At(epoch) => return Ok(vec![epoch]),
        Span::Every {
            step,
            length,
            has_end,
        } => (step, length, has_end),
    };
    let (first, mut last) = flight.scene().time.span(length);
    if length.is_some() {
        // A satellite that is not known at the beginning has the error of its first state.
        last = last.min(satellite.feed().validity().1).max(first);
    }
    let (length_ns, step_ns) = (
        (last - first).total_nanoseconds(),
        step.total_nanoseconds().max(1),
    );
    let steps = length_ns / step_ns;
    let rows = u64::try_from(steps).unwrap_or(u64::MAX).saturating_add(2);
    if rows > MAX_ROWS {
        return Err(PlayError::TooManyRows {
            rows,
            limit: MAX_ROWS,
        });
    }
    let mut epochs: Vec<_> = (0..=steps)
        .map(|k| first + Duration::from_total_nanoseconds(k * step_ns))
        .collect();
    if has_end && epochs.last().is_some_and(|epoch| *epoch < last) {
        epochs.push(last);
    }
    Ok(epochs)
}
