//! Scene files: what to draw, when, from where. TOML read with serde; every message names file, line and key.

use crate::air::Atmosphere;
use crate::earth::Shading;
use crate::frames::Epoch;
use crate::globe::{Figure, Visibility};
use std::path::PathBuf;

/// A checked scene: every value is in range and every default filled in.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The file it was read from.
    pub path: PathBuf,
    /// `[time]`
    pub time: Time,
    /// `[orbit]`; `None` where the camera needs no satellite.
    pub orbit: Option<Orbit>,
    /// `[camera]`
    pub camera: Camera,
    /// `[earth]`
    pub earth: EarthTable,
    /// `[output]`
    pub output: Output,
}

/// `[time]`: when the flight starts and how it is played.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Time {
    /// UTC instant of the first frame.
    pub start: Epoch,
    /// Simulated seconds that are played, > 0.
    pub duration_s: f64,
    /// Simulated seconds per second of playback; negative plays backwards, never 0.
    pub speed: f64,
    /// Frames per second of playback.
    pub frame_rate_hz: f64,
}

/// `[orbit]`: a source of motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit {
    /// Elements file, absolute or relative to the working directory; `None` is the built-in ISS set.
    pub file: Option<PathBuf>,
    /// Which satellite of the file; `None` is its only one.
    pub name: Option<String>,
}

/// Where the eye looks from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CameraMode {
    /// At the satellite, straight down, direction of flight up on screen.
    Nadir,
    /// At the satellite, forward along the track with the horizon in the upper third.
    Horizon,
    /// Behind and above the satellite, looking at it, the Earth below.
    Chase,
    /// Above a place on the ground, straight down, north up.
    Geodetic,
}

/// `[camera]`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye looks from.
    pub mode: CameraMode,
    /// Vertical field of view, degrees.
    pub fov_deg: f64,
    /// Geodetic mode: latitude, degrees.
    pub lat_deg: f64,
    /// Geodetic mode: longitude, degrees.
    pub lon_deg: f64,
    /// Geodetic mode: height above the ellipsoid, kilometres.
    pub height_km: f64,
}

/// `[earth]`
#[derive(Clone, Debug, PartialEq)]
pub struct EarthTable {
    /// The figure.
    pub figure: Figure,
    /// Cells per block edge, 1…48.
    pub subdivision: u32,
    /// Which blocks are drawn.
    pub visibility: Visibility,
    /// How the surface is shaded.
    pub shading: Shading,
    /// Cloud layer.
    pub clouds: bool,
    /// Terrain normals.
    pub normals: bool,
    /// City lights.
    pub night_lights: bool,
    /// The air.
    pub atmosphere: Atmosphere,
    /// Folder of the maps; `None` is the starter pack.
    pub textures: Option<PathBuf>,
}

/// `[output]`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Samples per pixel, 1 or 4.
    pub samples: u32,
}
