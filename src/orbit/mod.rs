//! Feeds: where a satellite is at an epoch.

mod error;
mod state;
mod tle;
mod tle_fields;
mod tle_text;

use crate::frames::Epoch;

pub use error::{LineFault, OrbitError};
pub use state::{Frame, OrbitState};
pub use tle::TleFeed;

/// A source of motion.
pub trait Feed: Send + Sync {
    /// The satellite's name, for panels and pictures.
    fn name(&self) -> &str;
    /// First and last epoch that the feed answers for.
    fn validity(&self) -> (Epoch, Epoch);
    /// The state at `epoch`; an epoch outside the validity interval is an error that names the interval.
    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError>;
}
