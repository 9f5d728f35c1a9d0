//! Validity of a feed, limited by impacts on the ground.

use super::{OrbitError, OrbitState};
use glam::DVec3;
use terrella_frames::{Ellipsoid, Epoch, rfc3339};

/// First and last epoch with a state, and impacts in between.
#[derive(Clone, Copy, Debug)]
pub(super) struct Validity {
    pub first: Epoch,
    pub last: Epoch,
    pub impacts: Impacts,
}

/// When the satellite left the ground before its epoch, and when it hits the ground after it, if within the interval.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Impacts {
    pub before: Option<Epoch>,
    pub after: Option<Epoch>,
}

impl Validity {
    /// An interval that no impact cuts short.
    pub fn between(first: Epoch, last: Epoch) -> Self {
        Self {
            first,
            last,
            impacts: Impacts::default(),
        }
    }

    /// The interval between the impacts.
    pub fn interval(&self) -> (Epoch, Epoch) {
        (
            self.impacts.before.unwrap_or(self.first),
            self.impacts.after.unwrap_or(self.last),
        )
    }

    /// The state at a valid epoch; `inside` propagates.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn state_at(
        &self,
        satellite: &str,
        epoch: Epoch,
        inside: impl Fn(Epoch) -> OrbitState,
    ) -> Result<OrbitState, OrbitError> {
        self.check(satellite, epoch, |impact| inside(impact).position_itrf_m())?;
        Ok(inside(epoch))
    }

    /// Rejects an epoch outside the interval or on the far side of an impact; `position_itrf_m` is where the satellite is at
    /// that.
    fn check(
        &self,
        satellite: &str,
        epoch: Epoch,
        position_itrf_m: impl Fn(Epoch) -> DVec3,
    ) -> Result<(), OrbitError> {
        if epoch < self.first || self.last < epoch {
            return Err(OrbitError::OutsideValidity {
                satellite: satellite.to_owned(),
                epoch: rfc3339(epoch),
                first: rfc3339(self.first),
                last: rfc3339(self.last),
            });
        }
        let before = self.impacts.before.filter(|impact| epoch < *impact);
        match before.or(self.impacts.after.filter(|impact| epoch > *impact)) {
            Some(impact) => Err(OrbitError::Impact {
                satellite: satellite.to_owned(),
                impact: rfc3339(impact),
                place: place_text(position_itrf_m(impact)),
                asked: rfc3339(epoch),
            }),
            None => Ok(()),
        }
    }
}

/// A place on the ground, to a hundredth of a degree.
fn place_text(position_itrf_m: DVec3) -> String {
    let place = Ellipsoid::WGS84.geodetic_from_itrf(position_itrf_m);
    let (lat, lon) = (place.lat_rad.to_degrees(), place.lon_rad.to_degrees());
    let side = |value: f64, below, above| if value < 0.0 { below } else { above };
    format!(
        "{:.2}° {}, {:.2}° {}",
        lat.abs(),
        side(lat, "S", "N"),
        lon.abs(),
        side(lon, "W", "E")
    )
}
