//! Culling of blocks and patches that are outside the view frustum or behind the horizon.
//!
//! All surfaces use it. Every test is conservative: no visible point is culled, whatever the ground's shape between its lowest and highest
//! height.
//!
//! [`Frustum`] holds the clip planes, and [`Horizon`] what the Earth hides. `CullingContext` combines both for a view, with the distance to
//! a bound, which selects the level of detail. Bounds are balls (`GroundBound`), or rectangles of longitude and latitude ([`ScaledRect`])
//! where these are much tighter.

#[cfg(feature = "terrain")]
mod context;
mod frustum;
mod horizon;
mod rect;
#[cfg(all(test, feature = "terrain"))]
mod tests;

#[cfg(feature = "terrain")]
pub use context::{BoundVisibility, CullingContext, GroundBound, NormalCone};
pub use frustum::{Containment, Frustum, ScaledFrustum};
pub use horizon::{GroundShell, Horizon, is_within_angle};
pub use rect::{ScaledRect, max_toward};
