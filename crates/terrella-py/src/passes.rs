//! Passes over a place, and when a satellite is visible in them.

use crate::arguments::within;
use crate::errors::of_orbit;
use crate::times::PyEpoch;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use terrella::frames::{Ellipsoid, Epoch, Geodetic, Orientation};
use terrella_orbit::{
    Feed, LookAngles, Observer, OrbitError, Pass, VisibilityRule, VisibleInterval, passes,
    visible_intervals,
};

/// Limit on the passes that one call returns for one satellite.
const MAX_PASSES: usize = 100_000;

/// The place and the time span of a search for passes, and the rule for visibility.
pub struct PassSearch {
    place: Geodetic,
    min_elevation_rad: f64,
    rule: VisibilityRule,
    span: (Epoch, Epoch),
}

/// A pass, the look angles at its begin, culmination and end, and its visible intervals.
type Found = (Pass, [LookAngles; 3], Vec<VisibleInterval>);

impl PassSearch {
    /// Checks degrees and metres of a call.
    pub fn new(
        [lat_deg, lon_deg, height_m]: [f64; 3],
        span: (Epoch, Epoch),
        min_elevation_deg: f64,
        sun_below_deg: f64,
        standard_magnitude: Option<f64>,
    ) -> PyResult<Self> {
        let magnitude = standard_magnitude
            .map(|magnitude| within(magnitude, "standard_magnitude", -30.0, 30.0))
            .transpose()?;
        Ok(Self {
            place: Geodetic::from_degrees(
                within(lat_deg, "lat_deg", -90.0, 90.0)?,
                within(lon_deg, "lon_deg", -360.0, 360.0)?,
                within(height_m, "height_m", -12_000.0, 100_000.0)?,
            ),
            min_elevation_rad: within(min_elevation_deg, "min_elevation_deg", 0.0, 89.999)?
                .to_radians(),
            rule: VisibilityRule {
                sun_below_rad: within(sun_below_deg, "sun_below_deg", -90.0, 90.0)?.to_radians(),
                standard_magnitude: magnitude,
            },
            span,
        })
    }

    /// The passes of each satellite as dicts.
    pub fn all<'py>(
        &self,
        py: Python<'py>,
        feeds: &[&dyn Feed],
    ) -> PyResult<Vec<Vec<Bound<'py, PyDict>>>> {
        let found = py.detach(|| {
            let found = feeds.iter().map(|feed| self.of(*feed));
            found.collect::<Result<Vec<_>, OrbitError>>()
        });
        let found = found.map_err(|error| of_orbit(&error))?;
        let of_one = |passes: Vec<Found>| passes.into_iter().map(|one| pass(py, one)).collect();
        found.into_iter().map(of_one).collect()
    }

    fn of(&self, feed: &dyn Feed) -> Result<Vec<Found>, OrbitError> {
        let still = |_| Orientation::default();
        let ellipsoid = &Ellipsoid::WGS84;
        let observer = Observer::new(self.place, ellipsoid, self.min_elevation_rad, &still);
        let found = passes(feed, &observer, self.span.0, self.span.1);
        let found = found.take(MAX_PASSES).map(|pass| {
            let pass = pass?;
            let stands = |epoch| -> Result<LookAngles, OrbitError> {
                Ok(observer.look_angles(&feed.state_at(epoch)?))
            };
            let [begin, highest, end] = [pass.begin, pass.highest, pass.end].map(stands);
            let visible = visible_intervals(feed, &observer, &pass, &self.rule)?;
            Ok((pass, [begin?, highest?, end?], visible))
        });
        found.collect()
    }
}

fn pass<'py>(
    py: Python<'py>,
    (pass, [begin, highest, end], visible): Found,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("begin", PyEpoch(pass.begin))?;
    dict.set_item("begin_azimuth_deg", begin.azimuth_rad.to_degrees())?;
    dict.set_item("rises", pass.rises)?;
    dict.set_item("highest", PyEpoch(pass.highest))?;
    dict.set_item("highest_azimuth_deg", highest.azimuth_rad.to_degrees())?;
    dict.set_item("elevation_deg", pass.elevation_rad.to_degrees())?;
    dict.set_item("distance_m", highest.distance_m)?;
    dict.set_item("end", PyEpoch(pass.end))?;
    dict.set_item("end_azimuth_deg", end.azimuth_rad.to_degrees())?;
    dict.set_item("sets", pass.sets)?;
    dict.set_item("duration_s", (pass.end - pass.begin).to_seconds())?;
    let visible = visible.into_iter().map(|one| {
        let dict = PyDict::new(py);
        dict.set_item("begin", PyEpoch(one.begin))?;
        dict.set_item("end", PyEpoch(one.end))?;
        dict.set_item("brightest", one.brightest.map(|(at, _)| PyEpoch(at)))?;
        dict.set_item("magnitude", one.brightest.map(|(_, magnitude)| magnitude))?;
        Ok(dict)
    });
    dict.set_item("visible", visible.collect::<PyResult<Vec<_>>>()?)?;
    Ok(dict)
}
