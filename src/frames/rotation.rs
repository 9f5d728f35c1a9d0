//! Earth rotation.
use super::Epoch;
use glam::DMat3;

/// Rotation that takes TEME axes to ITRF axes at `epoch`.
pub fn itrf_from_teme(_epoch: Epoch) -> DMat3 {
    DMat3::IDENTITY
}

/// Rotation that takes GCRF axes to ITRF axes at `epoch`.
pub fn itrf_from_gcrf(_epoch: Epoch) -> DMat3 {
    DMat3::IDENTITY
}
