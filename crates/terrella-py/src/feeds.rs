//! Satellites from files: their states at any instants, as arrays.

use crate::arguments::vectors;
use crate::errors::{of_orbit, of_start};
use crate::passes::PassSearch;
use crate::times::{PyEpoch, epoch, epochs};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::PyClass;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrella::frames::{Epoch, Orientation};
use terrella_orbit::interpolated::{
    EphemerisSegment, InterpolatedStates, Interpolation, StateSample,
};
use terrella_orbit::{
    Catalogue, Ephemerides, EphemerisFeed, Feed, Frame, OrbitError, ParameterMessages,
};

/// Name of a text without a file, in messages.
const TEXT: &str = "<text>";
/// Limit on the states that one call returns.
const MAX_STATES: usize = 1 << 27;
const FRAMES: [Frame; 5] = [
    Frame::Itrf,
    Frame::Teme,
    Frame::Gcrf,
    Frame::Eme2000,
    Frame::Pef,
];

/// A frame by its name, letter case aside.
pub fn frame_named(wanted: &str, argument: &str) -> PyResult<Frame> {
    let found = FRAMES
        .into_iter()
        .find(|frame| frame.name().eq_ignore_ascii_case(wanted));
    found.ok_or_else(|| {
        let known: Vec<_> = FRAMES
            .iter()
            .map(|frame| frame.name().to_lowercase())
            .collect();
        PyValueError::new_err(format!(
            "{argument}: {wanted:?} is none of {}",
            known.join(", ")
        ))
    })
}

type Pair<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Positions and velocities, satellites × instants × 3. `outside` selects the handling of instants for which a state is not known.
pub fn states_of<'py>(
    py: Python<'py>,
    feeds: &[&dyn Feed],
    times: &Bound<'py, PyAny>,
    frame: &str,
    outside: &str,
) -> PyResult<Pair<'py>> {
    let (frame, epochs) = (frame_named(frame, "frame")?, epochs(times, "times")?);
    let keeps_going = match outside {
        "raise" => false,
        "nan" => true,
        _ => {
            return Err(PyValueError::new_err(format!(
                "outside: {outside:?} is neither \"raise\" nor \"nan\""
            )));
        }
    };
    let count = feeds
        .len()
        .checked_mul(epochs.len())
        .filter(|count| *count <= MAX_STATES);
    let count = count.ok_or_else(|| {
        PyValueError::new_err(format!(
            "times: {} satellites at {} instants are more than the {MAX_STATES} states that one call gives",
            feeds.len(),
            epochs.len()
        ))
    })?;
    let computed = py.detach(|| computed(feeds, &epochs, frame, keeps_going, count));
    let (positions, velocities) = computed.map_err(|error| of_orbit(&error))?;
    let shape = [feeds.len(), epochs.len(), 3];
    let array = |numbers| -> PyResult<Bound<'py, PyAny>> {
        Ok(PyArray1::from_vec(py, numbers).reshape(shape)?.into_any())
    };
    Ok((array(positions)?, array(velocities)?))
}

fn computed(
    feeds: &[&dyn Feed],
    epochs: &[Epoch],
    frame: Frame,
    keeps_going: bool,
    count: usize,
) -> Result<(Vec<f64>, Vec<f64>), OrbitError> {
    let mut positions = Vec::with_capacity(3 * count);
    let mut velocities = Vec::with_capacity(3 * count);
    for feed in feeds {
        for epoch in epochs {
            match feed.state_at(*epoch) {
                Ok(state) => {
                    let state = state.in_frame(frame, &Orientation::default());
                    positions.extend(state.position_m.to_array());
                    velocities.extend(state.velocity_m_s.to_array());
                }
                Err(_) if keeps_going => {
                    positions.extend([f64::NAN; 3]);
                    velocities.extend([f64::NAN; 3]);
                }
                Err(error) => return Err(error),
            }
        }
    }
    Ok((positions, velocities))
}

/// Satellites with known positions over a time span: the methods that every kind of them has.
#[pyclass(frozen, subclass, name = "Satellites", module = "terrella")]
pub struct PySatellites {
    feeds: Vec<Box<dyn Feed>>,
}

impl PySatellites {
    /// Any number of one kind.
    pub fn new<F: Feed + 'static>(feeds: impl IntoIterator<Item = F>) -> Self {
        let boxed = |feed| -> Box<dyn Feed> { Box::new(feed) };
        Self {
            feeds: feeds.into_iter().map(boxed).collect(),
        }
    }

    /// Turns these satellites into a Python subclass with data of its own.
    pub fn with_kind<T: PyClass<BaseType = Self>>(self, kind: T) -> PyClassInitializer<T> {
        PyClassInitializer::from(self).add_subclass(kind)
    }
}

#[pymethods]
impl PySatellites {
    /// Names of the satellites, in the order of the file.
    #[getter]
    fn names(&self) -> Vec<String> {
        let names = self.feeds.iter().map(|feed| feed.name().to_owned());
        names.collect()
    }

    /// First and last time of validity of each.
    #[getter]
    fn validity(&self) -> Vec<(PyEpoch, PyEpoch)> {
        let spans = self.feeds.iter().map(|feed| feed.validity());
        spans
            .map(|(first, last)| (PyEpoch(first), PyEpoch(last)))
            .collect()
    }

    fn __len__(&self) -> usize {
        self.feeds.len()
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        const MOST_NAMED: usize = 3;
        let feeds = &slf.get().feeds;
        let mut names: Vec<_> = feeds
            .iter()
            .take(MOST_NAMED)
            .map(|one| one.name())
            .collect();
        if feeds.len() > MOST_NAMED {
            names.push("…");
        }
        let plural = if feeds.len() == 1 { "" } else { "s" };
        Ok(format!(
            "<terrella.{}, {} satellite{plural}: {}>",
            slf.get_type().name()?,
            feeds.len(),
            names.join(", ")
        ))
    }

    /// Positions and velocities, metres and metres a second: satellites × instants × 3 each. `frame` is itrf, teme, gcrf, eme2000 or pef,
    /// and velocities are those seen in it. Times outside a satellite's validity raise, or give NaN with outside="nan".
    #[pyo3(signature = (times, frame = "itrf", *, outside = "raise"))]
    fn propagate<'py>(
        &self,
        py: Python<'py>,
        times: &Bound<'py, PyAny>,
        frame: &str,
        outside: &str,
    ) -> PyResult<Pair<'py>> {
        let feeds: Vec<_> = self.feeds.iter().map(AsRef::as_ref).collect();
        states_of(py, &feeds, times, frame, outside)
    }

    /// Passes over a place of WGS84 from `first` to `last`, as far as each satellite is known: for each satellite a list of dicts with begin, highest
    /// and end (Epoch), their azimuths and the greatest elevation in degrees, the distance then in metres, duration_s, and whether the satellite
    /// rises at the beginning and sets at the end. `visible` lists the times in which it is outside the umbra and the Sun's centre lies below
    /// `sun_below_deg`: begin, end, and with a standard magnitude (at 1000 km, half lit) the brightest instant and its magnitude.
    #[pyo3(
        signature = (
            lat_deg, lon_deg, height_m = 0.0, *, first, last, min_elevation_deg = 10.0, sun_below_deg = -6.0, standard_magnitude = None
        ),
        // pyo3 writes no default for a negative number.
        text_signature = "($self, lat_deg, lon_deg, height_m=0.0, *, first, last, min_elevation_deg=10.0, sun_below_deg=-6.0, standard_magnitude=None)"
    )]
    // One keyword each.
    #[expect(clippy::too_many_arguments)]
    fn passes<'py>(
        &self,
        py: Python<'py>,
        lat_deg: f64,
        lon_deg: f64,
        height_m: f64,
        first: &Bound<'py, PyAny>,
        last: &Bound<'py, PyAny>,
        min_elevation_deg: f64,
        sun_below_deg: f64,
        standard_magnitude: Option<f64>,
    ) -> PyResult<Vec<Vec<Bound<'py, PyDict>>>> {
        let search = PassSearch::new(
            [lat_deg, lon_deg, height_m],
            (epoch(first, "first")?, epoch(last, "last")?),
            min_elevation_deg,
            sun_below_deg,
            standard_magnitude,
        )?;
        let feeds: Vec<_> = self.feeds.iter().map(AsRef::as_ref).collect();
        search.all(py, &feeds)
    }
}

/// Satellites of a file of mean elements (TLE, or OMM in KVN, XML, JSON or CSV), propagated by SGP4.
///
/// Corrupt sets are listed in `faults`, or rejected with strict=True.
#[pyclass(frozen, extends = PySatellites, name = "Catalogue", module = "terrella")]
pub struct PyCatalogue {
    /// Faults of skipped records of the file, at most a thousand.
    #[pyo3(get)]
    faults: Vec<String>,
}

impl PyCatalogue {
    fn of(read: Catalogue) -> PyClassInitializer<Self> {
        let faults = read.faults.iter().map(ToString::to_string).collect();
        PySatellites::new(read.feeds).with_kind(Self { faults })
    }
}

#[pymethods]
impl PyCatalogue {
    #[new]
    #[pyo3(signature = (path, *, strict = false))]
    fn new(py: Python<'_>, path: PathBuf, strict: bool) -> PyResult<PyClassInitializer<Self>> {
        let read = py.detach(|| Catalogue::from_file(&path, strict));
        Ok(Self::of(read.map_err(|error| of_orbit(&error))?))
    }

    /// Of the text of such a file.
    #[staticmethod]
    #[pyo3(signature = (text, *, strict = false))]
    fn from_text<'py>(py: Python<'py>, text: &str, strict: bool) -> PyResult<Bound<'py, Self>> {
        let read = py.detach(|| Catalogue::from_text(text, Path::new(TEXT), strict));
        Bound::new(py, Self::of(read.map_err(|error| of_orbit(&error))?))
    }
}

/// Objects of a file of states (OEM, CZML, CSV, SP3, STK), with the file's interpolation.
///
/// Corrupt records are listed in `faults`, or rejected with strict=True.
#[pyclass(frozen, extends = PySatellites, name = "Ephemerides", module = "terrella")]
pub struct PyEphemerides {
    /// Faults of skipped records of the file, at most a thousand.
    #[pyo3(get)]
    faults: Vec<String>,
}

impl PyEphemerides {
    fn of(read: Ephemerides) -> PyClassInitializer<Self> {
        let faults = read.faults.iter().map(ToString::to_string).collect();
        PySatellites::new(read.feeds).with_kind(Self { faults })
    }
}

#[pymethods]
impl PyEphemerides {
    #[new]
    #[pyo3(signature = (path, *, strict = false))]
    fn new(py: Python<'_>, path: PathBuf, strict: bool) -> PyResult<PyClassInitializer<Self>> {
        let read = py.detach(|| Ephemerides::from_file(&path, strict));
        Ok(Self::of(read.map_err(|error| of_orbit(&error))?))
    }

    /// Of the text of such a file.
    #[staticmethod]
    #[pyo3(signature = (text, *, strict = false))]
    fn from_text<'py>(py: Python<'py>, text: &str, strict: bool) -> PyResult<Bound<'py, Self>> {
        let read = py.detach(|| Ephemerides::from_text(text, Path::new(TEXT), strict));
        Bound::new(py, Self::of(read.map_err(|error| of_orbit(&error))?))
    }

    /// One object from arrays: positions (instants × 3, metres) and velocities (the same, metres a second, or None) in the axes of `frame`: itrf,
    /// teme, gcrf, eme2000 or pef. Between the instants it is interpolated by polynomials of degree 7, or of the highest that the number of states
    /// allows.
    #[staticmethod]
    #[pyo3(signature = (times, positions_m, velocities_m_s = None, *, frame = "gcrf", name = "satellite"))]
    fn from_states<'py>(
        py: Python<'py>,
        times: &Bound<'py, PyAny>,
        positions_m: &Bound<'py, PyAny>,
        velocities_m_s: Option<&Bound<'py, PyAny>>,
        frame: &str,
        name: &str,
    ) -> PyResult<Bound<'py, Self>> {
        let frame = frame_named(frame, "frame")?;
        let epochs = epochs(times, "times")?;
        let rows = |value, argument| {
            let (shape, rows) = vectors(value, argument)?;
            match shape == [epochs.len()] {
                true => Ok(rows),
                false => Err(PyValueError::new_err(format!(
                    "{argument}: an array of shape ({}, 3) is needed, one row for each of times",
                    epochs.len()
                ))),
            }
        };
        let positions = rows(positions_m, "positions_m")?;
        let velocities = velocities_m_s
            .map(|value| rows(value, "velocities_m_s"))
            .transpose()?;
        let samples = (0..epochs.len()).map(|n| StateSample {
            epoch: epochs[n],
            position_m: positions[n],
            velocity_m_s: velocities.as_ref().map(|rows| rows[n]),
        });
        let samples: Vec<_> = samples.collect();
        let feed = py.detach(|| {
            let states = InterpolatedStates::new(
                frame,
                &samples,
                interpolation(velocities.is_some(), epochs.len()),
            );
            let segment = EphemerisSegment::whole(states.map_err(of_start)?);
            EphemerisFeed::new(name.to_owned(), None, vec![segment]).map_err(of_start)
        });
        let faults = Vec::new();
        Bound::new(py, PySatellites::new([feed?]).with_kind(Self { faults }))
    }
}

/// The usual interpolation, of a degree that so many states allow.
fn interpolation(has_velocities: bool, count: usize) -> Interpolation {
    match has_velocities {
        true => Interpolation::Hermite {
            degree: (2 * count)
                .saturating_sub(1)
                .clamp(3, Interpolation::WITH_VELOCITIES.degree()),
        },
        false => Interpolation::Lagrange {
            degree: count
                .saturating_sub(1)
                .clamp(1, Interpolation::WITHOUT_VELOCITIES.degree()),
        },
    }
}

/// Satellites of a file of orbit parameter messages (CCSDS OPM, KVN or XML): each state is integrated with the message's spacecraft and manoeuvres from
/// `first`, by default the state's own instant, to `last`.
///
/// Corrupt messages are listed in `faults`, or rejected with strict=True.
#[pyclass(frozen, extends = PySatellites, name = "ParameterMessages", module = "terrella")]
pub struct PyParameterMessages {
    /// Faults of skipped messages of the file, at most a thousand.
    #[pyo3(get)]
    faults: Vec<String>,
}

#[pymethods]
impl PyParameterMessages {
    #[new]
    #[pyo3(signature = (path, *, last, first = None, strict = false))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        last: &Bound<'_, PyAny>,
        first: Option<&Bound<'_, PyAny>>,
        strict: bool,
    ) -> PyResult<PyClassInitializer<Self>> {
        let first = first.map(|first| epoch(first, "first")).transpose()?;
        let last = epoch(last, "last")?;
        let read = py.detach(|| {
            let read = ParameterMessages::from_file(&path, strict)?;
            let faults: Vec<_> = read.faults.iter().map(ToString::to_string).collect();
            let feeds = read.messages.into_iter().map(|message| {
                let from = first.unwrap_or(message.state.epoch);
                Arc::new(message).propagated(from, last, &Orientation::default())
            });
            Ok((feeds.collect::<Result<Vec<_>, OrbitError>>()?, faults))
        });
        let (feeds, faults) = read.map_err(|error: OrbitError| of_orbit(&error))?;
        Ok(PySatellites::new(feeds).with_kind(Self { faults }))
    }
}
