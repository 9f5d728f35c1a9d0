//! The words that a scene chooses from.

use serde::{Deserialize, Serialize};
use terrella_orbit::numerical::{AtmosphereModel, Solver};
use terrella_orbit::{FileFormat, Frame};

/// Where the eye looks from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CameraMode {
    /// At the satellite, straight down.
    Nadir,
    /// At the satellite, forward along the track with the horizon in the upper third.
    Horizon,
    /// Behind and above the satellite, looking at it, the Earth below.
    Chase,
    /// Above a place on the ground, straight down, north up.
    Geodetic,
}

/// What is upwards on screen when the eye looks straight down from a satellite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CameraUp {
    /// The direction of flight.
    #[default]
    Flight,
    /// North.
    North,
}

/// Kinds of source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum OrbitSource {
    /// Two-line elements, propagated by SGP4.
    Tle,
    /// Orbit mean-elements messages (CCSDS 502.0), propagated by SGP4.
    Omm,
    /// Orbit ephemeris messages (CCSDS 502.0): states, interpolated.
    Oem,
    /// Orbit parameter messages (CCSDS 502.0): a state, integrated.
    Opm,
    /// Positions of a CZML document, interpolated.
    Czml,
    /// States in columns, interpolated.
    Csv,
    /// Orbits of navigation satellites in SP3, interpolated.
    Sp3,
    /// An ephemeris of STK, interpolated.
    Stk,
    /// A conic from elements or a state.
    Kepler,
    /// Motion under forces, integrated from elements or a state.
    Numerical,
    /// States that a simulator sends meanwhile.
    Live,
    /// A simulation of Basilisk, running or saved.
    Basilisk,
}

impl OrbitSource {
    /// The source that a kind of file is of.
    pub fn of(format: FileFormat) -> Self {
        match format {
            FileFormat::Tle => Self::Tle,
            FileFormat::Omm => Self::Omm,
            FileFormat::Oem => Self::Oem,
            FileFormat::Opm => Self::Opm,
            FileFormat::Czml => Self::Czml,
            FileFormat::Csv => Self::Csv,
            FileFormat::Sp3 => Self::Sp3,
            FileFormat::Stk => Self::Stk,
        }
    }

    /// Whether it is always read from a file.
    pub fn is_file(self) -> bool {
        !matches!(
            self,
            Self::Kepler | Self::Numerical | Self::Live | Self::Basilisk
        )
    }

    /// Whether the scene gives its start.
    pub fn has_start(self) -> bool {
        matches!(self, Self::Kepler | Self::Numerical)
    }
}

/// What a map of coverage shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CoverageShow {
    /// How often satellites have the ground in view.
    Count,
    /// The mean time from the end of a view to the beginning of the next.
    Revisit,
    /// The longest time without a view.
    Gap,
}

/// Where a caption stands in pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CaptionPlace {
    /// In the corner.
    TopLeft,
    /// In the middle of the upper edge.
    Top,
    /// In the corner.
    TopRight,
    /// In the middle of the left edge.
    Left,
    /// In the middle of the right edge.
    Right,
    /// In the corner.
    BottomLeft,
    /// In the middle of the lower edge.
    Bottom,
    /// In the corner.
    BottomRight,
}

/// Models of lens distortion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum DistortionModel {
    BrownConrady,
    Fisheye,
}

/// Point spread functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum PsfName {
    None,
    Gaussian,
    Airy,
    Measured,
}

/// Filters on the pixels of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum MosaicName {
    Mono,
    Rggb,
    Bggr,
    Grbg,
    Gbrg,
}

/// Shutters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum ShutterName {
    Global,
    Rolling,
}

/// The axes of a start, as a scene writes them.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum FrameName {
    Teme,
    Pef,
    Itrf,
    Gcrf,
    Eme2000,
}

impl From<FrameName> for Frame {
    fn from(name: FrameName) -> Self {
        match name {
            FrameName::Teme => Self::Teme,
            FrameName::Pef => Self::Pef,
            FrameName::Itrf => Self::Itrf,
            FrameName::Gcrf => Self::Gcrf,
            FrameName::Eme2000 => Self::Eme2000,
        }
    }
}

/// The air, as a scene writes it.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum AirModel {
    Us1976,
    Exponential,
}

impl From<AirModel> for AtmosphereModel {
    fn from(model: AirModel) -> Self {
        match model {
            AirModel::Us1976 => Self::Standard1976,
            AirModel::Exponential => Self::Exponential,
        }
    }
}

/// The method of integration, as a scene writes it.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Method {
    Automatic,
    Explicit,
    Implicit,
}

impl From<Method> for Solver {
    fn from(method: Method) -> Self {
        match method {
            Method::Automatic => Self::Automatic,
            Method::Explicit => Self::Explicit,
            Method::Implicit => Self::Implicit,
        }
    }
}

/// Which effects are on where a scene says nothing of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Look {
    /// The 2011 paper's picture: its three layers, and no light of ours but the air's.
    Paper,
    /// What costs little: real light on land, sea and clouds, through the air.
    #[default]
    Standard,
    /// All that there is.
    Full,
}

/// Which of a pack's storages is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum StorageChoice {
    /// Compressed on graphics hardware that reads it, plain on software adapters; whichever there is otherwise.
    #[default]
    Auto,
    /// Plain texels.
    Plain,
    /// BC7, BC5 and BC4.
    Bc,
}
