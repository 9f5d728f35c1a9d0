//! The atmosphere as numbers: density profiles, scattering tables and the paper's billboard. No GPU here.
//!
//! Everything is computed on the unit sphere of scaled space (see [`crate::frames::Ellipsoid`]): there the limb of an
//! ellipsoid is a circle, so halo and limb meet at the poles as they do at the equator. Lengths are in units of the
//! equatorial radius; that makes the air 0.3 % thinner over the poles, which is far below its natural variation.

mod billboard;
mod model;
mod tables;

pub use billboard::{Billboard, HorizonSquare, Screen, horizon_square};
pub use model::{AirModel, EARTH_AIR, Species};
pub use tables::{AirTables, MULTIPLE, SCATTERING, SUNLIGHT, TRANSMITTANCE, TableSize};
pub(crate) use tables::{LOWEST_SUN, LUMINANCE};

/// How the air is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "scene", derive(serde::Deserialize, serde::Serialize))]
#[cfg_attr(feature = "scene", serde(rename_all = "lowercase"))]
pub enum Atmosphere {
    /// The paper's camera-facing square of side 2√(L1·L2), enlarged for the thickness of the air.
    #[default]
    Billboard,
    /// No air: nothing of it is computed, uploaded or compiled.
    None,
}
