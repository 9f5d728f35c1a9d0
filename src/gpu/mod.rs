//! Device, targets and drawables.
mod context;
mod targets;

pub use context::{AdapterReport, ContextError, GpuContext, adapter_reports};
pub use targets::{FrameTargets, PictureError};
