//! Two-line elements through SGP4.
use super::{Feed, OrbitError, OrbitState};
use crate::frames::Epoch;

/// One satellite's two-line elements.
pub struct TleFeed;

impl Feed for TleFeed {
    fn name(&self) -> &str {
        "stub"
    }
    fn validity(&self) -> (Epoch, Epoch) {
        unreachable!()
    }
    fn state_at(&self, _epoch: Epoch) -> Result<OrbitState, OrbitError> {
        unreachable!()
    }
}
