//! Where a camera is: the names that scenes have for it.

/// Where the eye looks from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CameraUp {
    /// The direction of flight.
    #[default]
    Flight,
    /// North.
    North,
}
