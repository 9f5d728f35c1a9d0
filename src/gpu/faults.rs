//! Device errors that no error scope catches.
//!
//! wgpu panics on them if no handler is set. For a device that we opened, the first error is recorded, and the next call that draws or reads an
//! image returns it. On a host's device we set no handler.

use std::sync::{Arc, Mutex, PoisonError};
use terrella_files::cause;

/// An error on a device outside all error scopes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuFault {
    /// The driver has reset or removed the device: nothing can be drawn with it any more.
    #[error(
        "the graphics device was lost: {0}; start again, and update the driver if it happens often"
    )]
    Lost(String),
    /// The device is out of memory.
    #[error(
        "the graphics device is out of memory: {0}; take a smaller picture, fewer samples, or less texture_mb"
    )]
    OutOfMemory(String),
    /// A command was rejected as invalid.
    #[error(
        "the graphics device rejected a command: {0}; this is a fault of the program, please report it"
    )]
    Validation(String),
    /// It failed for a reason unknown to its interface.
    #[error("the graphics driver failed: {0}; update it, or choose another adapter with --adapter")]
    Internal(String),
}

impl From<wgpu::Error> for GpuFault {
    fn from(error: wgpu::Error) -> Self {
        match error {
            wgpu::Error::OutOfMemory { source } => Self::OutOfMemory(cause(source)),
            wgpu::Error::Validation { description, .. } => Self::Validation(cause(description)),
            wgpu::Error::Internal { description, .. } => Self::Internal(cause(description)),
        }
    }
}

/// Records errors of a device. Clones share the record.
#[derive(Clone, Debug, Default)]
pub(super) struct GpuFaults(Arc<Mutex<Option<GpuFault>>>);

impl GpuFaults {
    /// Records errors of this device from now on.
    pub fn of(device: &wgpu::Device) -> Self {
        let faults = Self::default();
        let heard = faults.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| heard.note(error.into())));
        let heard = faults.clone();
        device.set_device_lost_callback(move |reason, message| {
            // Also called when the device is dropped in the regular way.
            if reason != wgpu::DeviceLostReason::Destroyed {
                heard.note(GpuFault::Lost(cause(message)));
            }
        });
        faults
    }

    /// Keeps the first error: later ones follow from it. A lost device takes precedence.
    fn note(&self, fault: GpuFault) {
        tracing::debug!("{fault}");
        let mut first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if first.is_none() || matches!(fault, GpuFault::Lost(_)) {
            *first = Some(fault);
        }
    }

    /// Returns the error since the last call. A lost device is returned each time.
    pub fn take(&self) -> Option<GpuFault> {
        let mut first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &*first {
            Some(GpuFault::Lost(_)) => first.clone(),
            _ => first.take(),
        }
    }

    /// Whether the device is lost.
    #[cfg(feature = "offscreen")]
    pub fn is_lost(&self) -> bool {
        let first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        matches!(&*first, Some(GpuFault::Lost(_)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_fault_is_reported_once_and_a_lost_device_for_good() {
        let faults = GpuFaults::default();
        assert_eq!(faults.take(), None);
        faults.note(GpuFault::Validation("one".into()));
        faults.note(GpuFault::Internal("two".into()));
        assert_eq!(faults.take(), Some(GpuFault::Validation("one".into())));
        assert_eq!(faults.take(), None);
        faults.note(GpuFault::OutOfMemory("three".into()));
        let lost = GpuFault::Lost("reset".into());
        faults.note(lost.clone());
        faults.note(GpuFault::Internal("four".into()));
        assert_eq!(
            (faults.take(), faults.take()),
            (Some(lost.clone()), Some(lost))
        );
    }
}
