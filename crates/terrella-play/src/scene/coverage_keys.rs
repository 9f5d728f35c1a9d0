//! Declares the keys of `[coverage]`, as [`keys`](super::keys) does those of the other tables.

use super::choices::{CaptionPlace, CoverageShow};
use super::field::{Bounds, Choice, Field};
use super::record::{Notes, Record};
#[cfg(test)]
use super::table::About;
use super::table::{Key, Only, Table, Value, given_or, method, table};
use super::text::SceneText;
use serde::Deserialize;
#[cfg(test)]
use serde_json::json;
use std::ops::{Range, RangeInclusive};
use toml::Spanned;

/// Maximum number of names in `satellites`.
pub(super) const MAX_NAMES: usize = 1000;
/// Range of a region's edges, degrees.
pub(super) const REGION_DEG: RangeInclusive<f64> = -360.0..=360.0;

/// Why other keys have no value without a map.
pub(super) const NO_COVERAGE: &str = "only with show";

const SHOWN: &Only = &Only {
    why: NO_COVERAGE,
    sources: &[],
};

table!(RawCoverage = "coverage" {
    /// What the colours of the map show: "count", how often satellites have the ground in view; "revisit", the mean time from the end of a view to the next; "gap", the longest time without a view. By default no map is drawn.
    show: Choice<CoverageShow>;
    /// Names of the satellites whose sensors count. By default all. A satellite without sensor_half_angle_deg or sensor_half_angles_deg has all the ground in sight in view.
    satellites: Vec<String>, of "a list of strings, names of the scene's satellites", for SHOWN;
    /// Time that is looked at, from the scene's start.
    duration_h: f64, of "hours", in 0.1..=8784.0, default 24.0, for SHOWN;
    /// Minimum elevation of a satellite above the ground's horizon.
    min_elevation_deg: f64, of "degrees", in 0.0..=89.0, default 5.0, for SHOWN;
    /// Side of a cell of the map.
    step_deg: f64, of "degrees", in 0.1..=45.0, default 2.0, for SHOWN;
    /// West, south, east and north edge of the map; a west beyond the east goes across the date line. By default [-180, -90, 180, 90].
    region_deg: Vec<f64>, of "[west, south, east, north], four numbers of degrees", in REGION_DEG, for SHOWN;
    /// Opacity of the map.
    opacity: f64, in 0.01..=1.0, default 0.5, for SHOWN;
    /// Whether pictures and the window have a legend.
    legend: bool, default true, for SHOWN;
    /// Where the legend stands.
    legend_place: Choice<CaptionPlace>, default CaptionPlace::BottomRight, for SHOWN;
});
