//! Atmosphere model on the CPU: density profiles, scattering tables and the paper's billboard. This module uses no GPU.
//!
//! All computation is on the unit sphere of scaled space (see [`terrella_frames::Ellipsoid`]). There the limb of the ellipsoid is a circle, so the
//! halo meets the limb at every latitude. Lengths are in units of the equatorial radius. This makes the atmosphere 0.3 % thinner over the poles, far
//! below its natural variation.

mod billboard;
mod model;
pub mod profile;
mod spectrum;
mod tables;

pub use billboard::{Billboard, HorizonSquare, RingVertex, horizon_square};
pub use model::{
    AEROSOL_ASYMMETRY, AirModel, AirOptions, RADIUS_M, RAYLEIGH_PHASE, RgbCoefficients, TOP,
    aerosol_phase, molecule_phase,
};
pub use profile::{AEROSOL_SCALE_HEIGHT_M, THICKNESS_M};
pub use tables::{
    AirAboveClouds, AirFileError, AirTables, BOUNCE, BOUNCE_AND_CLOUDS, InterpolationBound,
    InterpolationLimits, MOLECULE_SCALE_HEIGHT_M, PROFILE, RAYS, SCATTERING, SCATTERING_AND_CLOUDS,
    SOURCES, SUNLIGHT, SUNLIGHT_AND_CLOUDS, THROUGH, THROUGH_AND_CLOUDS, TRANSMITTANCE, TableSize,
    supply,
};
pub use tables::{LOWEST_SUN, LUMINANCE, SOURCE_BANDS, SUN_SPACING};

/// How the atmosphere is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize, serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Atmosphere {
    /// The paper's camera-facing square of side 2√(L1·L2), enlarged for the thickness of the air.
    #[default]
    Billboard,
    /// No atmosphere: nothing is computed, uploaded or compiled for it.
    None,
}
