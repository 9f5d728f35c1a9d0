//! Quantities with units of astropy, poliastro and skyfield, by the attributes that they have.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The plain numbers of a value that carries a unit, in the unit that the argument's name ends in: of an astropy `Quantity`, or of
/// skyfield's `Distance` and `Velocity`, whose three components come first. `None` of other objects.
pub fn in_unit_of<'py>(
    value: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let (unit, attribute) = match name {
        _ if name.ends_with("_m_s") => ("m/s", "m_per_s"),
        _ if name.ends_with("_m") => ("m", "m"),
        _ => ("", ""),
    };
    if value.hasattr("to_value")? && value.hasattr("unit")? {
        let plain = value.call_method1("to_value", (unit,));
        return plain
            .map(Some)
            .map_err(|error| PyValueError::new_err(format!("{name}: {error}")));
    }
    if !attribute.is_empty() && (value.hasattr("au_per_d")? || value.hasattr("au")?) {
        let rows = value
            .getattr(attribute)
            .map_err(|_| PyValueError::new_err(format!("{name}: {value} is not in {unit}")))?;
        return Ok(Some(rows.getattr("T")?));
    }
    Ok(None)
}
