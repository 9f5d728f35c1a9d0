//! Feeds: where a satellite is at an epoch.

mod tle;

use crate::frames::Epoch;
use glam::DVec3;
use std::path::PathBuf;

pub use tle::TleFeed;

/// The axes that a state is given in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// True equator, mean equinox of date: what SGP4 gives.
    Teme,
    /// Earth-fixed.
    Itrf,
}

/// Position and velocity at an epoch, in the axes of `frame`, about the Earth's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrbitState {
    /// When.
    pub epoch: Epoch,
    /// In which axes.
    pub frame: Frame,
    /// Position, metres.
    pub position_m: DVec3,
    /// Velocity as seen in `frame`, metres per second.
    pub velocity_m_s: DVec3,
}

/// A source of motion.
pub trait Feed: Send + Sync {
    /// The satellite's name, for panels and pictures.
    fn name(&self) -> &str;
    /// First and last epoch that the feed answers for.
    fn validity(&self) -> (Epoch, Epoch);
    /// The state at `epoch`; an epoch outside the validity interval is an error that names the interval.
    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError>;
}

/// What can be wrong with a feed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OrbitError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
}
