//! A camera service without a display: waits for simulations and draws the images that their cameras request.

use super::camera_service::CameraService;
use crate::error::PlayError;
use crate::flight::Flight;
use crate::progress::Progress;
use std::time::{Duration, Instant};
use terrella_orbit::basilisk::{Counters, StepPace};

/// How a service is run.
#[derive(Clone, Copy, Debug, Default)]
pub struct ServeRequest<'r> {
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
    /// Ends the service by itself after this many seconds.
    pub for_seconds: Option<f64>,
    /// Ends the service with the first simulation, when it disconnects.
    pub once: bool,
}

/// Serves simulations and their cameras until it is interrupted, its time is over, or a simulation requests the viewer to close. Returns a summary.
/// `ready` is called when everything is loaded.
///
/// # Errors
/// A scene that is not a simulation, missing maps, or no adapter.
pub fn serve(
    flight: &Flight,
    request: &ServeRequest<'_>,
    progress: &dyn Progress,
    ready: impl FnOnce(&str),
) -> Result<Counters, PlayError> {
    let simulation = flight.simulation().ok_or_else(|| PlayError::NoSimulation {
        scene: flight.scene().path.clone(),
    })?;
    simulation.set_pace(StepPace::Free);
    let painter = simulation.painter();
    progress.begin("loading maps", None);
    let mut service = CameraService::open(flight, simulation, request.adapter)?;
    progress.end();
    painter.is_ready();
    ready(&service.adapter());
    let time = request.for_seconds.map(Duration::try_from_secs_f64);
    let ends_at = time.and_then(|time| Instant::now().checked_add(time.ok()?));
    let is_ended = || {
        let counters = simulation.counters();
        let is_left = request.once && counters.steps > 0 && counters.connected == 0;
        let is_late = ends_at.is_some_and(|end| Instant::now() >= end);
        progress.cancelled() || is_left || is_late || simulation.is_over()
    };
    service.run(&is_ended)?;
    Ok(simulation.counters())
}
