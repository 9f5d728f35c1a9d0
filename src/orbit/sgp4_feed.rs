//! Orbit propagation by SGP4 (SDP4 for deep space) from mean elements.

use super::mean_elements::MeanElements;
use super::tle_fields::elements;
use super::tle_text::ElementSet;
use super::validity::Validity;
use super::{Feed, Frame, OrbitError, OrbitState};
use crate::frames::{Duration, Epoch, rfc3339};
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;

/// One satellite's mean elements, propagated by SGP4 with the constants WGS72 and in the mode that agrees with the
/// operational code of the US Space Force ("AFSPC"), for which published elements are made.
///
/// States are in TEME. Near their epoch published elements are good to about a kilometre, and the error grows by one to
/// three kilometres a day in low orbit (Vallado et al., AIAA 2006-6753).
///
/// Time runs in elapsed seconds: the satellite flies on through a leap second. Code that counts days of UTC instead
/// lets it wait for that second.
#[derive(Clone, Debug)]
pub struct Sgp4Feed {
    elements: MeanElements,
    origin: Arc<Path>,
    line: usize,
    constants: sgp4::Constants,
}

/// Two-line elements are one of the forms that [`Sgp4Feed`] reads.
pub type TleFeed = Sgp4Feed;

/// The International Space Station in January 2018, which the command flies where a scene names no file.
const BUILT_IN_ISS: &str = include_str!("../../config/orbits/iss.tle");

/// Radius below which the reference code says "decayed": one equatorial radius of WGS72, kilometres.
const DECAYED_BELOW_KM: f64 = 6378.135;

impl Sgp4Feed {
    /// How far from the epoch of the elements a feed answers, both ways: 30 days. By then a low satellite is tens of
    /// kilometres, or hundreds in a restless atmosphere, from where SGP4 says.
    pub const VALIDITY: Duration = Duration::from_parts(0, 30 * 86_400 * 1_000_000_000);

    /// Largest file read for one satellite, bytes: more than a hundred thousand two-line sets.
    pub const MAX_FILE_BYTES: u64 = 16 << 20;

    /// From elements that the program has; `origin` and `line` are named in errors.
    ///
    /// # Errors
    /// If SGP4 cannot start from them, or the satellite has decayed at their own epoch.
    pub fn from_elements(
        elements: MeanElements,
        origin: Arc<Path>,
        line: usize,
    ) -> Result<Self, OrbitError> {
        let constants =
            sgp4::Constants::from_elements_afspc_compatibility_mode(&elements.for_sgp4());
        let constants = constants.map_err(|e| OrbitError::Sgp4 {
            path: origin.to_path_buf(),
            line,
            satellite: elements.name.clone(),
            epoch: rfc3339(elements.epoch),
            cause: e.to_string(),
        })?;
        let feed = Self {
            elements,
            origin,
            line,
            constants,
        };
        // A set that does not even hold at its own epoch is refused here, not in the middle of a flight.
        feed.state_at(feed.elements.epoch)?;
        Ok(feed)
    }

    pub(super) fn from_set(set: &ElementSet<'_>, origin: &Arc<Path>) -> Result<Self, OrbitError> {
        Self::from_elements(elements(set, origin)?, Arc::clone(origin), set.at1)
    }

    /// The International Space Station, ISS (ZARYA), with elements of 20 January 2018.
    ///
    /// # Errors
    /// None as long as `config/orbits/iss.tle` is as released.
    pub fn built_in_iss() -> Result<Self, OrbitError> {
        Self::from_text(
            BUILT_IN_ISS,
            Path::new("config/orbits/iss.tle (built in)"),
            None,
        )
    }

    /// The epoch of the elements.
    pub fn epoch(&self) -> Epoch {
        self.elements.epoch
    }

    /// The satellite's number in the US catalogue.
    pub fn catalogue_number(&self) -> u64 {
        self.elements.catalogue_number
    }

    /// The elements it flies.
    pub fn elements(&self) -> &MeanElements {
        &self.elements
    }

    /// The line of the file at which its elements begin, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    fn sgp4_error(&self, epoch: Epoch, cause: String) -> OrbitError {
        OrbitError::Sgp4 {
            path: self.origin.to_path_buf(),
            line: self.line,
            satellite: self.elements.name.clone(),
            epoch: rfc3339(epoch),
            cause,
        }
    }
}

impl Feed for Sgp4Feed {
    fn name(&self) -> &str {
        &self.elements.name
    }

    fn validity(&self) -> (Epoch, Epoch) {
        (
            self.elements.epoch - Self::VALIDITY,
            self.elements.epoch + Self::VALIDITY,
        )
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        let (first, last) = self.validity();
        Validity::between(first, last).check(&self.elements.name, epoch, |_| DVec3::ZERO)?;
        // Both in TAI: elapsed time, leap seconds included.
        let elapsed = epoch.to_tai_duration() - self.elements.epoch.to_tai_duration();
        let minutes = sgp4::MinutesSinceEpoch(elapsed.to_seconds() / 60.0);
        let prediction = self
            .constants
            .propagate_afspc_compatibility_mode(minutes)
            .map_err(|e| self.sgp4_error(epoch, e.to_string()))?;
        let position_km = DVec3::from(prediction.position);
        let velocity_km_s = DVec3::from(prediction.velocity);
        // Wild elements can make SGP4's series overflow without its noticing.
        if !position_km.is_finite() || !velocity_km_s.is_finite() {
            return Err(self.sgp4_error(epoch, "the result is not a number".to_owned()));
        }
        // The sixth error of the reference code, which the crate leaves to its caller.
        if position_km.length() < DECAYED_BELOW_KM {
            return Err(OrbitError::Decayed {
                path: self.origin.to_path_buf(),
                line: self.line,
                satellite: self.elements.name.clone(),
                epoch: rfc3339(epoch),
                depth_km: DECAYED_BELOW_KM - position_km.length(),
            });
        }
        Ok(OrbitState {
            epoch,
            frame: Frame::Teme,
            position_m: position_km * 1000.0,
            velocity_m_s: velocity_km_s * 1000.0,
        })
    }
}
