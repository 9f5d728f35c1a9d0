//! Culling of blocks and patches: what an eye cannot see, because it lies outside the view frustum or behind the horizon, is
//! left out.
//!
//! All surfaces ask here. Every test is conservative: nothing is left out of which any point could be seen, whatever the
//! ground is like between its lowest and its highest height.
//!
//! [`Frustum`] holds the clip planes, [`Horizon`] what the Earth hides; `CullingContext` is both for a view, with what a
//! level of detail goes by: the distance to a bound. Bounds are balls (`GroundBound`), or rectangles of longitude and
//! latitude ([`ScaledRect`]) where these are much closer.

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
