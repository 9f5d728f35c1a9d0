//! Motions that are computed here: on a conic, or integrated under forces.

use crate::arguments::{vector, within};
use crate::errors::of_start;
use crate::feeds::{PySatellites, frame_named};
use crate::times::{PyEpoch, epoch};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use terrella::frames::Epoch;
use terrella_orbit::OrbitState;
use terrella_orbit::kepler::{
    Anomaly, Drift, KeplerElements, KeplerFeed, KeplerOptions, OrbitSize,
};
use terrella_orbit::numerical::{
    AtmosphereModel, ForceModel, Gravity, NumericalFeed, NumericalOptions, Shadow, Spacecraft,
};

/// The one of two arguments that is given.
fn one_of<T>(first: (&str, Option<T>), second: (&str, Option<T>)) -> PyResult<(bool, T)> {
    match (first.1, second.1) {
        (Some(value), None) => Ok((true, value)),
        (None, Some(value)) => Ok((false, value)),
        _ => Err(PyValueError::new_err(format!(
            "{}, {}: give one of the two",
            first.0, second.0
        ))),
    }
}

/// First and last instant that is answered for; from the motion's own on where no first is given.
fn span(
    own: Epoch,
    first: Option<&Bound<'_, PyAny>>,
    last: &Bound<'_, PyAny>,
) -> PyResult<(Epoch, Epoch)> {
    let first = first.map_or(Ok(own), |first| epoch(first, "first"))?;
    Ok((first, epoch(last, "last")?))
}

/// A state from arguments.
fn state(
    at: Epoch,
    position_m: &Bound<'_, PyAny>,
    velocity_m_s: &Bound<'_, PyAny>,
    frame: &str,
) -> PyResult<OrbitState> {
    Ok(OrbitState {
        epoch: at,
        frame: frame_named(frame, "frame")?,
        position_m: vector(position_m, "position_m")?,
        velocity_m_s: vector(velocity_m_s, "velocity_m_s")?,
    })
}

/// A satellite on a conic about the Earth's centre, from Keplerian elements at an instant, in the axes of `frame` (gcrf, teme or eme2000). With
/// j2=True node, periapsis and mean anomaly drift as the Earth's flattening makes them on average. It is known from `first`, by default
/// the epoch of the elements, to `last`, or until it hits the ground: `impact`.
#[pyclass(frozen, extends = PySatellites, name = "KeplerOrbit", module = "terrella")]
pub struct PyKeplerOrbit {
    impact: Option<Epoch>,
}

impl PyKeplerOrbit {
    fn of(feed: KeplerFeed) -> PyClassInitializer<Self> {
        let impact = feed.impact();
        PySatellites::new([feed]).with_kind(Self { impact })
    }
}

fn kepler_options(j2: bool, (first, last): (Epoch, Epoch)) -> KeplerOptions {
    let drift = if j2 { Drift::J2 } else { Drift::None };
    KeplerOptions { drift, first, last }
}

#[pymethods]
impl PyKeplerOrbit {
    #[new]
    #[pyo3(signature = (
        time, *, last, inclination_deg, eccentricity = 0.0, semi_major_axis_m = None, periapsis_m = None, raan_deg = 0.0,
        argument_of_periapsis_deg = 0.0, true_anomaly_deg = None, mean_anomaly_deg = None, frame = "gcrf", j2 = false,
        first = None, name = "satellite"
    ))]
    // One keyword each: in Python that is how elements are named.
    #[expect(clippy::too_many_arguments)]
    fn new(
        time: &Bound<'_, PyAny>,
        last: &Bound<'_, PyAny>,
        inclination_deg: f64,
        eccentricity: f64,
        semi_major_axis_m: Option<f64>,
        periapsis_m: Option<f64>,
        raan_deg: f64,
        argument_of_periapsis_deg: f64,
        true_anomaly_deg: Option<f64>,
        mean_anomaly_deg: Option<f64>,
        frame: &str,
        j2: bool,
        first: Option<&Bound<'_, PyAny>>,
        name: &str,
    ) -> PyResult<PyClassInitializer<Self>> {
        let at = epoch(time, "time")?;
        let axis = ("semi_major_axis_m", semi_major_axis_m);
        let size = match one_of(axis, ("periapsis_m", periapsis_m))? {
            (true, axis_m) => OrbitSize::SemiMajorAxis(axis_m),
            (false, periapsis_m) => OrbitSize::Periapsis(periapsis_m),
        };
        let anomaly = ("true_anomaly_deg", true_anomaly_deg);
        let anomaly = match one_of(anomaly, ("mean_anomaly_deg", mean_anomaly_deg))? {
            (true, degrees) => Anomaly::True(degrees.to_radians()),
            (false, degrees) => Anomaly::Mean(degrees.to_radians()),
        };
        let elements = KeplerElements {
            size,
            eccentricity,
            inclination_rad: inclination_deg.to_radians(),
            raan_rad: raan_deg.to_radians(),
            argument_of_periapsis_rad: argument_of_periapsis_deg.to_radians(),
            anomaly,
        };
        let options = kepler_options(j2, span(at, first, last)?);
        let frame = frame_named(frame, "frame")?;
        KeplerFeed::from_elements(name, frame, at, &elements, options)
            .map(Self::of)
            .map_err(of_start)
    }

    /// The conic through a state: metres and metres a second.
    #[staticmethod]
    #[pyo3(signature = (
        time, position_m, velocity_m_s, *, last, frame = "gcrf", j2 = false, first = None, name = "satellite"
    ))]
    #[expect(clippy::too_many_arguments)]
    fn from_state<'py>(
        py: Python<'py>,
        time: &Bound<'py, PyAny>,
        position_m: &Bound<'py, PyAny>,
        velocity_m_s: &Bound<'py, PyAny>,
        last: &Bound<'py, PyAny>,
        frame: &str,
        j2: bool,
        first: Option<&Bound<'py, PyAny>>,
        name: &str,
    ) -> PyResult<Bound<'py, Self>> {
        let at = epoch(time, "time")?;
        let state = state(at, position_m, velocity_m_s, frame)?;
        let options = kepler_options(j2, span(at, first, last)?);
        let feed = KeplerFeed::from_state(name, &state, options).map_err(of_start)?;
        Bound::new(py, Self::of(feed))
    }

    /// When it hits the ground, if it does within its span.
    #[getter]
    fn impact(&self) -> Option<PyEpoch> {
        self.impact.map(PyEpoch)
    }
}

/// A satellite whose motion under forces is integrated once, at creation: from a state (metres, metres a second) over the span from
/// `first`, by default the state's epoch, to `last`. It ends where it hits the ground: `impact`.
///
/// `gravity_degree` is 0 for a point mass, else 2 to 20 of EGM96, with orders up to `gravity_order` (by default all). `air` is None,
/// "us1976" or "exponential". Manoeuvres and other shadow models are available in scenes.
#[pyclass(frozen, extends = PySatellites, name = "IntegratedOrbit", module = "terrella")]
pub struct PyIntegratedOrbit {
    impact: Option<Epoch>,
    /// Number of accepted integration steps.
    #[pyo3(get)]
    steps: usize,
}

#[pymethods]
impl PyIntegratedOrbit {
    #[new]
    #[pyo3(signature = (
        time, position_m, velocity_m_s, *, last, first = None, frame = "gcrf", gravity_degree = 8, gravity_order = None,
        air = None, sun = false, moon = false, sunlight = false, mass_kg = 1000.0, drag_area_m2 = 10.0, drag_coefficient = 2.2,
        sunlit_area_m2 = 10.0, reflectivity = 1.3, relative_tolerance = 1e-10, name = "satellite"
    ))]
    // One keyword each, as above.
    #[expect(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        time: &Bound<'_, PyAny>,
        position_m: &Bound<'_, PyAny>,
        velocity_m_s: &Bound<'_, PyAny>,
        last: &Bound<'_, PyAny>,
        first: Option<&Bound<'_, PyAny>>,
        frame: &str,
        gravity_degree: usize,
        gravity_order: Option<usize>,
        air: Option<&str>,
        sun: bool,
        moon: bool,
        sunlight: bool,
        mass_kg: f64,
        drag_area_m2: f64,
        drag_coefficient: f64,
        sunlit_area_m2: f64,
        reflectivity: f64,
        relative_tolerance: f64,
        name: &str,
    ) -> PyResult<PyClassInitializer<Self>> {
        let at = epoch(time, "time")?;
        let state = state(at, position_m, velocity_m_s, frame)?;
        let (first, last) = span(at, first, last)?;
        let model = ForceModel {
            gravity: gravity(gravity_degree, gravity_order)?,
            drag: air.map(atmosphere).transpose()?,
            sun,
            moon,
            sunlight: sunlight.then_some(Shadow::Cone),
            ..Default::default()
        };
        let craft = Spacecraft {
            mass_kg,
            drag_area_m2,
            drag_coefficient,
            sunlit_area_m2,
            reflectivity,
        };
        let relative_tolerance = within(relative_tolerance, "relative_tolerance", 1e-14, 1e-3)?;
        let options = NumericalOptions {
            relative_tolerance,
            ..NumericalOptions::between(first, last)
        };
        let feed = py.detach(|| NumericalFeed::new(name, &state, &model, &craft, &options));
        let feed = feed.map_err(of_start)?;
        let (impact, steps) = (feed.impact(), feed.steps());
        Ok(PySatellites::new([feed]).with_kind(Self { impact, steps }))
    }

    /// When it hits the ground, if it does within its span.
    #[getter]
    fn impact(&self) -> Option<PyEpoch> {
        self.impact.map(PyEpoch)
    }
}

fn gravity(degree: usize, order: Option<usize>) -> PyResult<Gravity> {
    match (degree, order) {
        (0, None | Some(0)) => Ok(Gravity::Point),
        (2..=20, Some(0)) => Ok(Gravity::Zonal { degree }),
        (2..=20, None) => Ok(Gravity::Field {
            degree,
            order: degree,
        }),
        (2..=20, Some(order)) if order <= degree => Ok(Gravity::Field { degree, order }),
        (0 | 2..=20, _) => Err(PyValueError::new_err(format!(
            "gravity_order: it is at most gravity_degree, {degree}"
        ))),
        _ => Err(PyValueError::new_err(format!(
            "gravity_degree: {degree} is neither 0 nor from 2 to 20"
        ))),
    }
}

fn atmosphere(name: &str) -> PyResult<AtmosphereModel> {
    match name {
        "us1976" => Ok(AtmosphereModel::Standard1976),
        "exponential" => Ok(AtmosphereModel::Exponential),
        _ => Err(PyValueError::new_err(format!(
            "air: {name:?} is neither \"us1976\" nor \"exponential\""
        ))),
    }
}
