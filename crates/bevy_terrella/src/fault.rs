//! Why a camera does not see the Earth.

use bevy::render::render_resource::TextureFormat;
use terrella::frames::Epoch;
use terrella::{EarthError, ImageryError};

/// Why a camera does not see the Earth. It is logged once, and stands in the camera's
/// [`EarthCameraStatus`](crate::EarthCameraStatus) as long as it holds.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EarthFault {
    /// The maps could not be read.
    #[error("the Earth's maps cannot be read: {0}")]
    Maps(#[from] ImageryError),
    /// The maps are Bevy's assets, and could not be read.
    #[error(
        "the Earth's maps cannot be read from the assets {folder}: {cause}; put a copy of Terrella's textures there"
    )]
    Assets {
        /// The folder of the assets.
        folder: String,
        /// What is wrong with it.
        cause: String,
    },
    /// The maps are Bevy's assets, and the app has none.
    #[error("the Earth's maps are assets, and the app has no AssetServer; add Bevy's AssetPlugin")]
    NoAssets,
    /// The sky cannot be drawn as its component says.
    #[cfg(feature = "celestial")]
    #[error("the sky cannot be made: {0}")]
    Celestial(#[from] terrella::celestial::CelestialError),
    /// Tracks, stations or lines cannot be drawn as their components say. `satellite` counts the entities with a track.
    #[cfg(feature = "tracks")]
    #[error("tracks cannot be made: {0}")]
    Tracks(#[from] terrella::tracks::TracksError),
    /// The sensor's parameters do not fit each other.
    #[cfg(feature = "sensor")]
    #[error("the sensor: {0}")]
    Sensor(#[from] terrella_sensor::SensorError),
    /// A shutter that needs a pose for each row.
    #[cfg(feature = "sensor")]
    #[error(
        "the sensor has a rolling shutter, and a Bevy frame has one pose; use Shutter::Global, or a scene's [sensor]"
    )]
    RollingShutter,
    /// A sensor whose picture the device cannot hold.
    #[cfg(feature = "sensor")]
    #[error(
        "the sensor needs a picture of {width} × {height}, and the device has {side} pixels a side and {megabytes} MiB a buffer; lower oversampling or size"
    )]
    SensorSize {
        /// Pixels of a row of the picture.
        width: u32,
        /// Rows of the picture.
        height: u32,
        /// Most pixels of a side.
        side: u32,
        /// Most that is read back at once.
        megabytes: u64,
    },
    /// The Earth cannot be drawn as its component says.
    #[error("the Earth cannot be made: {0}")]
    Earth(#[from] EarthError),
    /// More than one entity is an Earth.
    #[error("{0} entities have the component Earth and one can be drawn; despawn the others")]
    Several(usize),
    /// An instant that the sky is not computed of.
    #[error("the Earth's epoch is {0}; it must be in the years 1 to 9999")]
    Epoch(Epoch),
    /// Light in eight bits without an encoding.
    #[error(
        "the camera draws to {0:?}, which holds linear light in few bits; give it the component Hdr, or a target whose format is sRGB"
    )]
    Format(TextureFormat),
    /// A projection without a vanishing point.
    #[error("the camera's projection is no perspective; the Earth is drawn through a perspective")]
    Projection,
    /// A camera that mirrors or stretches.
    #[error(
        "the camera's transform mirrors or stretches its world; scale all three axes alike, by a positive number"
    )]
    Transform,
}
