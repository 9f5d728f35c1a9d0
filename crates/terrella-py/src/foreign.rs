//! Instants of astropy and skyfield, recognised by their attributes. Neither library is imported before a caller passes one of its objects.

use crate::arguments::numbers;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;
use terrella::frames::{Duration, Epoch};

const NS_PER_DAY: i128 = 86_400_000_000_000;
/// 1900-01-01T00:00 as a Julian date, from which [`Epoch`] counts TAI.
const JULIAN_1900: f64 = 2_415_020.5;
/// 2100-01-01T00:00:00 UTC with the leap seconds up to 2017, from 1900 in TAI.
const END_NS: i128 = 6_311_433_637_000_000_000;

/// The instant so many nanoseconds of TAI after 1900; `None` beyond the years 1900 to 2099, which every feed and the Sun are known for.
pub fn epoch_of_tai_ns(ns: i128) -> Option<Epoch> {
    let elapsed = Duration::from_total_nanoseconds(ns);
    (0..END_NS)
        .contains(&ns)
        .then(|| Epoch::from_tai_duration(elapsed))
}

/// The instants of an astropy `Time` or a skyfield `Time`, one or an array of them; `None` of other objects.
pub fn epochs_of(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Option<Vec<Epoch>>> {
    // Skyfield: a whole Julian day, and the fraction by which TAI is ahead of it.
    let (whole, fraction) = if value.hasattr("tai_fraction")? && value.hasattr("whole")? {
        (value.getattr("whole")?, value.getattr("tai_fraction")?)
    } else if is_astropy_time(value)? {
        let tai = value.getattr("tai")?;
        (tai.getattr("jd1")?, tai.getattr("jd2")?)
    } else {
        return Ok(None);
    };
    let (_, whole) = numbers(&whole, name)?;
    let (_, fraction) = numbers(&fraction, name)?;
    // skyfield stores a single whole day if all instants of an array share it.
    let days = match (whole.as_slice(), fraction.len()) {
        (days, count) if days.len() == count => days.to_vec(),
        ([day], count) => vec![*day; count],
        _ => {
            return Err(PyValueError::new_err(format!(
                "{name}: days and fractions of a day differ in number"
            )));
        }
    };
    let rows = days.into_iter().zip(fraction);
    rows.map(|(day, fraction)| epoch_of_julian(day, fraction, name))
        .collect::<PyResult<_>>()
        .map(Some)
}

/// Whether this is a `Time` of astropy. Its `TimeDelta` has Julian dates and scales as well, but no present.
pub fn is_astropy_time(value: &Bound<'_, PyAny>) -> PyResult<bool> {
    Ok(value.hasattr("jd1")? && value.get_type().hasattr("now")?)
}

/// An instant of a Julian date in TAI, in two parts of which the first is the larger: exact to the nanosecond where it has at most the
/// digits of a day or half a day.
fn epoch_of_julian(day: f64, fraction: f64, name: &str) -> PyResult<Epoch> {
    let since_1900 = day - JULIAN_1900;
    let whole = since_1900.floor();
    let of_day_ns = (since_1900 - whole + fraction) * NS_PER_DAY as f64;
    // A million days are some millennia; NaN is not below them.
    let is_near = whole.abs() < 1e6 && of_day_ns.abs() < 1e20;
    let ns = is_near.then(|| whole as i128 * NS_PER_DAY + of_day_ns.round() as i128);
    ns.and_then(epoch_of_tai_ns).ok_or_else(|| {
        PyValueError::new_err(format!(
            "{name}: Julian date {} is not in the years 1900 to 2099",
            day + fraction
        ))
    })
}

/// An astropy `Time` on the scale TAI.
pub fn astropy_time<'py>(py: Python<'py>, epoch: Epoch) -> PyResult<Bound<'py, PyAny>> {
    let ns = epoch.to_tai_duration().total_nanoseconds();
    let day = JULIAN_1900 + ns.div_euclid(NS_PER_DAY) as f64;
    let fraction = ns.rem_euclid(NS_PER_DAY) as f64 / NS_PER_DAY as f64;
    let options = [("format", "jd"), ("scale", "tai")].into_py_dict(py)?;
    let time = py.import("astropy.time")?.getattr("Time")?;
    time.call((day, fraction), Some(&options))
}
