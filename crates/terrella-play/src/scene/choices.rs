//! Words that scenes can choose from.

use serde::{Deserialize, Serialize};
use terrella_orbit::numerical::{AtmosphereModel, Solver};
use terrella_orbit::{FileFormat, Frame};

/// Position and view of the eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CameraMode {
    /// At the satellite, looking straight down.
    Nadir,
    /// At the satellite, looking forward along the track with the horizon in the upper third.
    Horizon,
    /// Behind and above the satellite, looking at it and at the Earth below.
    Chase,
    /// Above a place on the ground, looking straight down, north up.
    Geodetic,
}

/// Screen-up direction when the eye looks straight down from a satellite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CameraUp {
    /// The direction of flight.
    #[default]
    Flight,
    /// North.
    North,
}

/// Sources of motion.
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
    /// States in columns of a table, interpolated.
    Csv,
    /// Orbits of navigation satellites in SP3, interpolated.
    Sp3,
    /// An ephemeris of STK, interpolated.
    Stk,
    /// A conic from elements or a state.
    Kepler,
    /// Motion under forces, integrated from elements or a state.
    Numerical,
    /// States that a simulator sends at run time.
    Live,
    /// A Basilisk simulation, running or saved.
    Basilisk,
}

impl OrbitSource {
    /// The source for a file format.
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

    /// Whether the source is always a file.
    pub fn is_file(self) -> bool {
        !matches!(
            self,
            Self::Kepler | Self::Numerical | Self::Live | Self::Basilisk
        )
    }

    /// Whether the scene states the initial state.
    pub fn has_start(self) -> bool {
        matches!(self, Self::Kepler | Self::Numerical)
    }
}

/// Quantity shown by a coverage map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CoverageShow {
    /// Number of times that satellites see the ground.
    Count,
    /// Mean time from the end of a view to the start of the next.
    Revisit,
    /// The longest time without a view.
    Gap,
}

/// Position of a caption in images.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CaptionPlace {
    /// The upper left corner.
    TopLeft,
    /// The middle of the upper edge.
    Top,
    /// The upper right corner.
    TopRight,
    /// The middle of the left edge.
    Left,
    /// The middle of the right edge.
    Right,
    /// The lower left corner.
    BottomLeft,
    /// The middle of the lower edge.
    Bottom,
    /// The lower right corner.
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

/// Reference frames of an initial state, by their names in scenes.
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

/// Models of atmospheric density, by their names in scenes.
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

/// Integration methods, by their names in scenes.
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

/// Default set of effects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Look {
    /// The image of the 2011 paper: its three layers, and no added light except the atmosphere's.
    Paper,
    /// Inexpensive effects: real light on land, sea and clouds, through the atmosphere.
    #[default]
    Standard,
    /// All effects.
    Full,
}

/// Storage of a pack to read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum StorageChoice {
    /// Compressed storage on graphics hardware that supports it, plain storage on software adapters. Falls back
    /// to the storage that exists.
    #[default]
    Auto,
    /// Plain texels.
    Plain,
    /// BC7, BC5 and BC4.
    Bc,
}
