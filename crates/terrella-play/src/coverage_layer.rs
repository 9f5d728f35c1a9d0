//! `[coverage]` of a scene: computed once for a flight, and drawn as cells on the globe with a legend.
//!
//! Pictures wait for it. The window does not: there a thread computes it, and the map appears when it is ready.

use super::coverage_cells::CoverageCells;
use super::coverage_map::{CoverageMap, CoverageRequest};
use super::coverage_scale::CoverageScale;
use super::error::PlayError;
use super::flight::Flight;
use super::satellites::Satellite;
use crate::scene::{CaptionPlace, CoverageTable, Scene};
use std::f64::consts::{FRAC_PI_2, TAU};
#[cfg(feature = "window")]
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};
use terrella::frames::{Duration, Ellipsoid};
use terrella::tracks::{FillCell, FillRow, FillStyle, Polygons};
use terrella_orbit::{Cell, CellCoverage, FieldOfView, GroundSensor};

/// Rounding of longitudes, radians.
const ROUNDING_RAD: f64 = 1e-10;

/// The legend of a map.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CoverageLegend {
    pub scale: CoverageScale,
    pub place: CaptionPlace,
}

/// The cells of a flight's map; `None` where a thread still computes them.
fn cells<'f>(
    flight: &'f Flight,
    table: &CoverageTable,
) -> Result<Option<&'f CoverageCells>, PlayError> {
    let shared = flight.coverage();
    if shared.get().is_some() || shared.is_behind() {
        return Ok(shared.get());
    }
    let map = compute(&|| true, flight, table)?;
    Ok(map.map(|map| shared.keep(map)))
}

/// Computes the map of a flight's scene on a thread, where it has one; nobody waits for it from now on. `done` is called on that thread with
/// what went wrong, or nothing. The work ends early once its answer is dropped.
///
/// # Errors
/// No thread.
#[cfg(feature = "window")]
pub(crate) fn compute_behind<'scope>(
    scope: &'scope std::thread::Scope<'scope, '_>,
    flight: &'scope Flight,
    done: impl Fn(Option<PlayError>) + Send + 'scope,
) -> std::io::Result<Option<CoverageWork>> {
    let Some(table) = &flight.scene().coverage else {
        return Ok(None);
    };
    flight.coverage().leave_to_thread();
    let work = CoverageWork(Arc::new(AtomicBool::new(true)));
    let is_wanted = Arc::clone(&work.0);
    let compute = move || match compute(&|| is_wanted.load(Ordering::Relaxed), flight, table) {
        Ok(Some(map)) => {
            flight.coverage().keep(map);
            done(None);
        }
        Ok(None) => {}
        Err(error) => done(Some(error)),
    };
    std::thread::Builder::new()
        .name("terrella coverage".to_owned())
        .spawn_scoped(scope, compute)?;
    Ok(Some(work))
}

/// A computation that ends early when this is dropped.
#[cfg(feature = "window")]
pub(crate) struct CoverageWork(Arc<AtomicBool>);

#[cfg(feature = "window")]
impl Drop for CoverageWork {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Relaxed);
    }
}

/// The satellites of the map with their sensors.
///
/// # Errors
/// A name that no satellite has.
fn sensors<'f>(
    flight: &'f Flight,
    table: &CoverageTable,
) -> Result<Vec<(&'f Satellite, GroundSensor)>, PlayError> {
    let (scene, satellites) = (flight.scene(), flight.satellites());
    let names: Vec<_> = satellites.iter().map(Satellite::name).collect();
    let chosen = scene.coverage_satellites(&names)?.into_iter();
    let all = || FieldOfView::nadir(FRAC_PI_2);
    let of = |index: usize| {
        let field = scene.orbits.get(index)?.track.sensor;
        let sensor = GroundSensor {
            field: field.unwrap_or_else(all),
            min_elevation_rad: table.min_elevation_deg.to_radians(),
        };
        Some((satellites.get(index)?, sensor))
    };
    Ok(chosen.filter_map(of).collect())
}

fn compute(
    is_wanted: &dyn Fn() -> bool,
    flight: &Flight,
    table: &CoverageTable,
) -> Result<Option<CoverageCells>, PlayError> {
    let sensors = sensors(flight, table)?;
    let request = CoverageRequest {
        step_deg: table.step_deg,
        region_deg: table.region_deg,
        length: Some(Duration::from_hours(table.duration_h)),
    };
    let map = CoverageMap::new_while(is_wanted, flight, &sensors, &request)?;
    Ok(map.map(CoverageMap::into_cells))
}

/// The cells of a scene's map as polygons; none where it has no map, or not yet.
///
/// # Errors
/// A map of too many cells, a name that no satellite has, and what a feed rejects.
pub(crate) fn coverage_polygons(
    scene: &Scene,
    flight: &Flight,
) -> Result<Vec<Polygons>, PlayError> {
    let Some(table) = &scene.coverage else {
        return Ok(Vec::new());
    };
    let Some(map) = cells(flight, table)? else {
        return Ok(Vec::new());
    };
    let scale = CoverageScale::of(map, table.show);
    let styles = scale.classes.iter().map(|class| FillStyle {
        color: class.color,
        opacity: table.opacity,
    });
    let styles: Vec<_> = styles.collect();
    polygons(map, &scale, &styles, flight.ellipsoid())
}

fn polygons(
    map: &CoverageCells,
    scale: &CoverageScale,
    styles: &[FillStyle],
    ellipsoid: &Ellipsoid,
) -> Result<Vec<Polygons>, PlayError> {
    let is_same_row = |(one, _): &(Cell, CellCoverage), (other, _): &(Cell, CellCoverage)| {
        one.lat_rad == other.lat_rad
    };
    let rows = map.cells.chunk_by(is_same_row).map(|row| {
        let cells = row.iter().map(|(cell, one)| {
            // From the western edge on; cells are of ±π.
            let past_west = cell.lon_rad - 0.5 * cell.width_rad - map.west_rad;
            let west = map.west_rad + (past_west + ROUNDING_RAD).rem_euclid(TAU);
            FillCell {
                lon_rad: [west, west + cell.width_rad],
                style: scale.class(one),
            }
        });
        let lat = row.first().map_or(0.0, |(cell, _)| cell.lat_rad);
        let half = row.first().map_or(0.0, |(cell, _)| 0.5 * cell.height_rad);
        FillRow {
            lat_rad: [lat - half, lat + half],
            cells: cells.collect(),
        }
    });
    let rows: Vec<_> = rows.collect();
    Ok(Polygons::of_rows(styles, ellipsoid, &rows)?)
}

/// The legend of a scene's map; `None` where it has none, or not yet.
///
/// # Errors
/// As [`coverage_polygons`].
pub(crate) fn coverage_legend(
    scene: &Scene,
    flight: &Flight,
) -> Result<Option<CoverageLegend>, PlayError> {
    let Some((table, place)) = scene
        .coverage
        .as_ref()
        .and_then(|one| Some((one, one.legend?)))
    else {
        return Ok(None);
    };
    let map = cells(flight, table)?;
    Ok(map.map(|map| CoverageLegend {
        scale: CoverageScale::of(map, table.show),
        place,
    }))
}

#[cfg(test)]
#[path = "coverage_layer_tests.rs"]
mod tests;
