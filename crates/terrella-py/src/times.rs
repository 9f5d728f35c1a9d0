//! Instants: as people, `datetime` and NumPy write them, and time scales.

use crate::arguments::numpy;
use crate::errors::of_any;
use crate::foreign::{astropy_time, epoch_of_tai_ns, epochs_of, is_astropy_time};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyType;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use terrella::frames::{Duration, Epoch, TimeScale, ccsds_time, utc_from_rfc3339};

/// Most instants that one call takes.
const MAX_TIMES: usize = 1 << 24;
const NS_PER_S: i128 = 1_000_000_000;

/// An instant from 1900 to 2099, exact to the nanosecond, leap seconds included: of a text like "2018-01-15T12:00:00Z" (UTC, or with an
/// offset), a datetime with a time zone, a numpy.datetime64 (UTC), a Time of astropy or skyfield, or another Epoch.
///
/// Adding and subtracting seconds or a timedelta moves it by elapsed time; the difference of two instants is elapsed seconds.
#[pyclass(frozen, name = "Epoch", module = "terrella", eq, ord)]
#[derive(Clone, Copy, PartialEq, PartialOrd)]
pub struct PyEpoch(pub Epoch);

#[pymethods]
impl PyEpoch {
    #[new]
    #[pyo3(signature = (time))]
    fn new(time: &Bound<'_, PyAny>) -> PyResult<Self> {
        epoch(time, "time").map(Self)
    }

    /// The instant in UTC with all its digits, at least milliseconds, like 2018-01-15T12:00:00.000Z.
    #[getter]
    fn utc(&self) -> String {
        format!("{}Z", ccsds_time(self.0, TimeScale::Utc))
    }

    /// The reading of the clocks of UTC, TAI, TT or GPS, as CCSDS writes it.
    #[pyo3(signature = (scale))]
    fn text(&self, scale: &str) -> PyResult<String> {
        Ok(ccsds_time(self.0, time_scale(scale)?))
    }

    /// A datetime in UTC, later digits than microseconds cut off. Raises ValueError in a leap second, which datetime cannot hold.
    #[pyo3(name = "to_datetime")]
    fn as_datetime<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        const DIGITS: usize = "2018-01-15T12:00:00.000000".len();
        let text = self.digits("datetime")?;
        let microseconds = text.get(..DIGITS).unwrap_or(&text);
        py.import("datetime")?
            .getattr("datetime")?
            .call_method1("fromisoformat", (format!("{microseconds}+00:00"),))
    }

    /// A numpy.datetime64 of nanoseconds in UTC. Raises ValueError in a leap second, which datetime64 cannot hold.
    #[pyo3(name = "to_datetime64")]
    fn as_datetime64<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = self.digits("datetime64")?;
        numpy(py)?.call_method1("datetime64", (text, "ns"))
    }

    /// An astropy.time.Time on the scale TAI, exact to the nanosecond. Needs astropy.
    #[pyo3(name = "to_astropy")]
    fn as_astropy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        astropy_time(py, self.0)
    }

    /// Elapsed seconds from another time to this, leap seconds included.
    #[pyo3(signature = (other))]
    fn seconds_since(&self, other: &Bound<'_, PyAny>) -> PyResult<f64> {
        Ok((self.0 - epoch(other, "other")?).to_seconds())
    }

    /// Elapsed nanoseconds from another time to this, exact.
    #[pyo3(signature = (other))]
    fn nanoseconds_since(&self, other: &Bound<'_, PyAny>) -> PyResult<i128> {
        Ok((self.0 - epoch(other, "other")?).total_nanoseconds())
    }

    fn __add__(&self, elapsed: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.moved(elapsed_of(elapsed, "elapsed")?)
    }

    fn __radd__(&self, elapsed: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.__add__(elapsed)
    }

    fn __sub__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if let Some(elapsed) = elapsed(other, "elapsed")? {
            return Ok(self.moved(-elapsed)?.into_pyobject(py)?.into_any());
        }
        let seconds = self.seconds_since(other)?;
        Ok(seconds.into_pyobject(py)?.into_any())
    }

    fn __rsub__(&self, other: &Bound<'_, PyAny>) -> PyResult<f64> {
        Ok((epoch(other, "other")? - self.0).to_seconds())
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.0
            .to_tai_duration()
            .total_nanoseconds()
            .hash(&mut hasher);
        hasher.finish()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyType>, (String,)) {
        (py.get_type::<Self>(), (self.utc(),))
    }

    fn __repr__(&self) -> String {
        format!("Epoch('{}')", self.utc())
    }

    fn __str__(&self) -> String {
        self.utc()
    }
}

impl PyEpoch {
    /// So much later; rejects times beyond the years 1900 to 2099.
    fn moved(&self, elapsed: Duration) -> PyResult<Self> {
        let since_1900 = self.0.to_tai_duration() + elapsed;
        let moved = epoch_of_tai_ns(since_1900.total_nanoseconds());
        moved.map(Self).ok_or_else(|| {
            PyValueError::new_err(format!(
                "elapsed: {} s from {} is not in the years 1900 to 2099",
                elapsed.to_seconds(),
                self.utc()
            ))
        })
    }

    /// UTC without its zone, with nanoseconds where there are any, for a type that has no leap seconds.
    fn digits(&self, kind: &str) -> PyResult<String> {
        let text = ccsds_time(self.0, TimeScale::Utc);
        let fraction = text.split_once('.').map_or(0, |(_, digits)| digits.len());
        match text.get(17..19) {
            Some("60") => Err(PyValueError::new_err(format!(
                "{text}Z is in a leap second, which {kind} cannot hold; take Epoch.utc, Epoch.text or Epoch.to_astropy"
            ))),
            _ => Ok(format!(
                "{text}{}",
                "0".repeat(9usize.saturating_sub(fraction))
            )),
        }
    }
}

/// A duration from a `timedelta`, a numpy.timedelta64, or seconds.
pub fn elapsed_of(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Duration> {
    elapsed(value, name)?.ok_or_else(|| {
        PyTypeError::new_err(format!(
            "{name}: a datetime.timedelta, a numpy.timedelta64 or seconds are needed"
        ))
    })
}

/// Same as [`elapsed_of`]; `None` if the value is no duration.
fn elapsed(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Option<Duration>> {
    let wrong = || PyValueError::new_err(format!("{name}: {value} s is no elapsed time"));
    if kind_of(value).as_deref() == Some("m") {
        let ns = value.call_method1("astype", ("timedelta64[ns]",))?;
        let ns: i64 = ns.call_method1("astype", ("int64",))?.extract()?;
        return match ns {
            // NaT.
            i64::MIN => Err(wrong()),
            ns => Ok(Some(Duration::from_total_nanoseconds(ns.into()))),
        };
    }
    // Quantities and time differences of astropy.
    let has_unit = value.hasattr("to_value")? && !is_astropy_time(value)?;
    let seconds = match value.call_method0("total_seconds") {
        Ok(seconds) => seconds.extract::<f64>(),
        Err(_) if has_unit => value
            .call_method1("to_value", ("s",))
            .and_then(|seconds| seconds.extract()),
        Err(_) => value.extract::<f64>(),
    };
    match seconds {
        Ok(seconds) if seconds.is_finite() && seconds.abs() < 1e10 => {
            // Rounds to the nearest nanosecond: differences of Julian dates fall slightly short of whole ones.
            let ns = (seconds * NS_PER_S as f64).round() as i128;
            Ok(Some(Duration::from_total_nanoseconds(ns)))
        }
        Ok(_) => Err(wrong()),
        Err(_) => Ok(None),
    }
}

/// An instant from any value that [`PyEpoch`] accepts.
pub fn epoch(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Epoch> {
    if let Ok(epoch) = value.cast::<PyEpoch>() {
        return Ok(epoch.get().0);
    }
    if let Ok(text) = value.extract::<String>() {
        return parsed(&text, name);
    }
    if let (Ok(zone), Ok(text)) = (value.getattr("tzinfo"), value.call_method0("isoformat")) {
        if zone.is_none() {
            return Err(PyValueError::new_err(format!(
                "{name}: {text} has no time zone; write datetime(…, tzinfo=timezone.utc)"
            )));
        }
        return parsed(&text.extract::<String>()?, name);
    }
    if kind_of(value).as_deref() == Some("M")
        && let Ok(0) = value.getattr("ndim").and_then(|n| n.extract::<usize>())
    {
        let one = numpy(value.py())?.call_method1("atleast_1d", (value,))?;
        let times = of_datetime64(&one, name)?;
        return times
            .first()
            .copied()
            .ok_or_else(|| PyValueError::new_err(format!("{name}: empty")));
    }
    if let Some(epochs) = epochs_of(value, name)? {
        return match epochs.as_slice() {
            [epoch] => Ok(*epoch),
            epochs => Err(PyValueError::new_err(format!(
                "{name}: {} instants where one is needed",
                epochs.len()
            ))),
        };
    }
    Err(PyTypeError::new_err(format!(
        "{name}: an instant is a terrella.Epoch, a text like \"2018-01-15T12:00:00Z\", a datetime with a time zone, a \
         numpy.datetime64 (UTC), or a Time of astropy or skyfield, not {}",
        value.get_type()
    )))
}

/// A sequence of instants from a datetime64 array, from a sequence of values that [`epoch`] accepts, or from a single one.
pub fn epochs(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<Epoch>> {
    if kind_of(value).as_deref() == Some("M") {
        let row = numpy(value.py())?.call_method1("atleast_1d", (value,))?;
        return of_datetime64(&row, name);
    }
    if value.extract::<String>().is_ok() || value.is_instance_of::<PyEpoch>() {
        return Ok(vec![epoch(value, name)?]);
    }
    if let Some(epochs) = epochs_of(value, name)? {
        return match epochs.len() > MAX_TIMES {
            true => Err(too_many(name)),
            false => Ok(epochs),
        };
    }
    let items = match value.try_iter() {
        Ok(items) => items,
        Err(_) => return Ok(vec![epoch(value, name)?]),
    };
    let mut epochs = Vec::new();
    for (n, item) in items.enumerate() {
        if n == MAX_TIMES {
            return Err(too_many(name));
        }
        epochs.push(epoch(&item?, &format!("{name}[{n}]"))?);
    }
    Ok(epochs)
}

fn too_many(name: &str) -> PyErr {
    PyValueError::new_err(format!(
        "{name}: more than the {MAX_TIMES} instants that one call takes"
    ))
}

fn parsed(text: &str, name: &str) -> PyResult<Epoch> {
    utc_from_rfc3339(text).map_err(|error| PyValueError::new_err(format!("{name}: {error}")))
}

fn kind_of(value: &Bound<'_, PyAny>) -> Option<String> {
    let kind = value.getattr("dtype").ok()?.getattr("kind").ok()?;
    kind.extract().ok()
}

fn of_datetime64(row: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<Epoch>> {
    // Microseconds first: years that nanoseconds do not hold would wrap around.
    let whole = integers(row, "datetime64[us]", name)?;
    // 1900-01-01 to 2100-01-01, the dates that every feed and the Sun are known for.
    const FIRST_US: i64 = -2_208_988_800_000_000;
    const END_US: i64 = 4_102_444_800_000_000;
    if let Some(n) = whole.iter().position(|us| !(FIRST_US..END_US).contains(us)) {
        let what = match whole[n] {
            i64::MIN => "NaT is not a time".to_owned(),
            us => format!("{us} µs after 1970 is not in the years 1900 to 2099"),
        };
        return Err(PyValueError::new_err(format!("{name}[{n}]: {what}")));
    }
    let ns = integers(row, "datetime64[ns]", name)?;
    Ok(ns
        .into_iter()
        .map(|ns| {
            let utc = Epoch::from_unix_duration(Duration::from_total_nanoseconds(ns.into()));
            // In TAI, so that what is added to it is elapsed time.
            Epoch::from_tai_duration(utc.to_tai_duration())
        })
        .collect())
}

fn integers(row: &Bound<'_, PyAny>, unit: &str, name: &str) -> PyResult<Vec<i64>> {
    let row = row
        .call_method1("astype", (unit,))?
        .call_method1("astype", ("int64",))?;
    let row = row
        .cast::<PyArray1<i64>>()
        .map_err(|_| PyValueError::new_err(format!("{name}: an array with one axis is needed")))?;
    if row.readonly().as_array().len() > MAX_TIMES {
        return Err(too_many(name));
    }
    row.to_vec().map_err(of_any)
}

fn time_scale(name: &str) -> PyResult<TimeScale> {
    TimeScale::from_name(&name.to_ascii_uppercase()).ok_or_else(|| {
        PyValueError::new_err(format!("scale: {name:?} is none of UTC, TAI, TT, GPS"))
    })
}

/// The readings of clocks of TAI, TT or GPS at instants, as datetime64[ns].
#[pyfunction]
fn readings<'py>(
    py: Python<'py>,
    times: &Bound<'py, PyAny>,
    scale: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let scale = time_scale(scale)?;
    let ahead = ahead_of_tai(scale)?;
    let epochs = epochs(times, "times")?;
    // TAI counts from 1900-01-01, datetime64 from 1970-01-01.
    const FROM_1900_TO_1970_S: i128 = 2_208_988_800;
    let ns: Vec<i64> = epochs
        .iter()
        .map(|epoch| {
            let tai = epoch.to_tai_duration().total_nanoseconds();
            (tai + ahead - FROM_1900_TO_1970_S * NS_PER_S) as i64
        })
        .collect();
    PyArray1::from_vec(py, ns).call_method1("view", ("datetime64[ns]",))
}

/// How far a scale's clocks are ahead of TAI's, nanoseconds.
fn ahead_of_tai(scale: TimeScale) -> PyResult<i128> {
    match scale {
        TimeScale::Tai => Ok(0),
        TimeScale::Tt => Ok(32_184_000_000),
        TimeScale::Gps => Ok(-19 * NS_PER_S),
        _ => Err(PyValueError::new_err(
            "scale: UTC has leap seconds that datetime64 cannot write; take Epoch.utc, or TAI, TT or GPS",
        )),
    }
}

pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(readings, module)?)
}
