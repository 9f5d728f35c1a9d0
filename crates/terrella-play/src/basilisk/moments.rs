//! Converts snapshots of a simulation into moments of a flight: eye, light, and the Earth's orientation.

use crate::camera::OrbitalMotion;
use crate::error::PlayError;
use crate::flight::{Flight, Moment, ViewRequest};
use glam::DMat3;
use std::sync::Arc;
use terrella::Sky;
use terrella::frames::{EARTH_ROTATION_RATE_RAD_S, Epoch};
use terrella::tracks::EarthTurn;
use terrella_orbit::basilisk::{Recording, Simulation, Snapshot};

/// Sun and Moon in a snapshot of a simulation.
pub(super) fn sky(snapshot: &Snapshot) -> Sky {
    let itrf_from_gcrf = snapshot.itrf_from_gcrf;
    let sun_m = itrf_from_gcrf * snapshot.sun_m;
    Sky {
        sun_itrf: sun_m.normalize(),
        sun_distance_m: sun_m.length(),
        moon_itrf_m: Some(itrf_from_gcrf * snapshot.moon_m),
        itrf_from_gcrf: Some(itrf_from_gcrf),
        epoch: Some(snapshot.epoch),
    }
}

pub(super) fn turn(snapshot: &Snapshot) -> EarthTurn {
    EarthTurn {
        itrf_from_gcrf: snapshot.itrf_from_gcrf,
        rate_rad_s: if snapshot.turns {
            EARTH_ROTATION_RATE_RAD_S
        } else {
            0.0
        },
    }
}

impl Flight {
    /// The simulation that this flight shows, if it runs meanwhile.
    pub fn simulation(&self) -> Option<&Simulation> {
        let satellite = self.satellites().get(self.simulated?)?;
        satellite.simulation().map(Arc::as_ref)
    }

    /// The same, to be kept beside the flight.
    pub(crate) fn shared_simulation(&self) -> Option<Arc<Simulation>> {
        let satellite = self.satellites().get(self.simulated?)?;
        satellite.simulation().cloned()
    }

    /// The view of an instant of a simulation that was saved; `None` for flights that are no such.
    pub(crate) fn recorded(
        &self,
        epoch: Epoch,
        request: &ViewRequest,
    ) -> Option<Result<Moment, PlayError>> {
        let recording = self.recording()?;
        Some(match recording.snapshot_at(epoch) {
            Ok(Some(snapshot)) => self.simulated(&snapshot, request),
            Ok(None) => {
                // The feed's words for it: from when to when it is known.
                let unknown = self.feed().and_then(|feed| feed.state_at(epoch).err());
                Err(unknown.map_or(PlayError::NoSatellite, PlayError::from))
            }
            Err(error) => Err(error.into()),
        })
    }

    /// The saved simulation that this flight shows.
    pub(crate) fn recording(&self) -> Option<&Arc<Recording>> {
        self.satellites().get(self.recorded?)?.recording()
    }

    /// The view of an instant of a simulation.
    ///
    /// # Errors
    /// Without the craft that cameras fly with, a view that needs it.
    pub(crate) fn simulated(
        &self,
        snapshot: &Snapshot,
        request: &ViewRequest,
    ) -> Result<Moment, PlayError> {
        let wanted = self.simulated_craft();
        let craft = snapshot.craft(wanted);
        if let (None, Some(wanted), Some(simulation)) = (craft, wanted, self.simulation()) {
            let names: Vec<_> = snapshot
                .craft
                .iter()
                .take(10)
                .map(|one| &*one.name)
                .collect();
            simulation.tell(format!(
                "the simulation has no spacecraft {wanted:?}, which [orbit] name asks for; it has {names:?}"
            ));
        }
        let itrf_from_gcrf = snapshot.itrf_from_gcrf;
        let state = craft.map(|craft| OrbitalMotion {
            position_itrf_m: itrf_from_gcrf * craft.position_m,
            velocity_m_s: itrf_from_gcrf * craft.velocity_m_s,
        });
        let pose = self.pose(request.mode, state.as_ref())?;
        let pose = match request.mode == self.scene().camera.mode {
            true => self.aimed(pose, snapshot.epoch, state.as_ref(), || sky(snapshot))?,
            false => pose,
        };
        let mut moment = self.moment_under(snapshot.epoch, request, pose, state, sky(snapshot));
        moment.turn = Some(turn(snapshot));
        moment.is_starless = snapshot.is_sky_black;
        if let (Some(drawn), Some(craft)) = (&mut moment.craft, craft) {
            drawn.itrf_from_craft = itrf_from_gcrf * DMat3::from_quat(craft.inertial_from_body);
        }
        Ok(moment)
    }

    /// The name of the craft that cameras fly with, where the scene gives one.
    fn simulated_craft(&self) -> Option<&str> {
        self.scene().orbits.first()?.name.as_deref()
    }
}
