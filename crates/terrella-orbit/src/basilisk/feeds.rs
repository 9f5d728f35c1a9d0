//! The craft and places of a simulation as feeds, for tracks.

use super::shared::SharedSimulation;
use super::world::{Snapshot, seconds};
use crate::{Feed, Frame, Freshness, OrbitError, OrbitState};
use glam::DVec3;
use std::sync::{Arc, OnceLock};
use terrella_frames::{Epoch, rfc3339, utc_from_rfc3339};

/// The states of a craft that have come, in GCRF about the Earth's centre.
pub struct CraftFeed {
    pub(super) shared: Arc<SharedSimulation>,
    /// Name of the spacecraft; `None` for the first one.
    pub(super) craft: Option<String>,
    /// Its name: known with its first state if none was requested.
    pub(super) name: OnceLock<String>,
}

/// All dates that there are.
fn always() -> (Epoch, Epoch) {
    let year = |text| utc_from_rfc3339(text).unwrap_or_default();
    (year("1900-01-01T00:00:00Z"), year("2099-12-31T00:00:00Z"))
}

fn freshness(shared: &SharedSimulation) -> Freshness {
    match shared.age().map(|age| age.as_secs_f64()) {
        None => Freshness::Waiting,
        Some(age_s) if age_s > shared.options.stale_after_s => Freshness::Stale { age_s },
        Some(_) => Freshness::Live,
    }
}

impl Feed for CraftFeed {
    fn name(&self) -> &str {
        if let Some(name) = &self.craft {
            return name;
        }
        let latest = || self.shared.latest();
        let first = || latest()?.craft.first().map(|craft| craft.name.to_string());
        match self.name.get() {
            Some(name) => name,
            None => match first() {
                Some(name) => self.name.get_or_init(|| name),
                None => "Basilisk",
            },
        }
    }

    fn validity(&self) -> (Epoch, Epoch) {
        let known = self
            .shared
            .with_history(self.craft.as_deref(), |latest, history| {
                let (first_s, last_s) = history?.span_s()?;
                let at = |elapsed_s: f64| latest.epoch + seconds(elapsed_s - latest.elapsed_s);
                Some((at(first_s), at(last_s)))
            });
        known.flatten().unwrap_or_else(always)
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        let state = self
            .shared
            .with_history(self.craft.as_deref(), |latest, history| {
                let elapsed_s = latest.elapsed_s + (epoch - latest.epoch).to_seconds();
                let craft = history?.at(elapsed_s)?;
                Some(OrbitState {
                    epoch,
                    frame: Frame::Gcrf,
                    position_m: craft.position_m,
                    velocity_m_s: craft.velocity_m_s,
                })
            });
        state.flatten().ok_or_else(|| {
            let (first, last) = self.validity();
            OrbitError::NotCovered {
                satellite: self.name().to_owned(),
                epoch: rfc3339(epoch),
                known: match self.shared.latest() {
                    Some(_) => format!("from {} to {}", rfc3339(first), rfc3339(last)),
                    None => "once a step has come".to_owned(),
                },
            }
        })
    }

    fn freshness(&self) -> Freshness {
        freshness(&self.shared)
    }
}

/// A place on the ground, with the Earth's rotation at the newest time.
pub struct PlaceFeed {
    pub(super) shared: Arc<SharedSimulation>,
    /// Its name.
    pub(super) name: Arc<str>,
    pub(super) position_itrf_m: DVec3,
}

impl PlaceFeed {
    fn state(&self, latest: &Snapshot, epoch: Epoch) -> OrbitState {
        OrbitState {
            epoch,
            frame: Frame::Gcrf,
            position_m: latest.itrf_from_gcrf.transpose() * self.position_itrf_m,
            velocity_m_s: DVec3::ZERO,
        }
    }
}

impl Feed for PlaceFeed {
    fn name(&self) -> &str {
        &self.name
    }

    fn validity(&self) -> (Epoch, Epoch) {
        always()
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        match self.shared.latest() {
            Some(latest) => Ok(self.state(&latest, epoch)),
            None => Err(OrbitError::NotCovered {
                satellite: self.name.to_string(),
                epoch: rfc3339(epoch),
                known: "once a step has come".to_owned(),
            }),
        }
    }

    fn freshness(&self) -> Freshness {
        freshness(&self.shared)
    }
}
