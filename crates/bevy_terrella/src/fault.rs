//! Why a camera does not see the Earth.

use bevy::render::render_resource::TextureFormat;
use terrella::frames::Epoch;
use terrella::{EarthError, ImageryError};

/// Why a camera does not see the Earth. It is logged once, and stays in the camera's
/// [`EarthCameraStatus`](crate::EarthCameraStatus) while it lasts.
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
        /// The cause.
        cause: String,
    },
    /// The maps are Bevy's assets, and the app has none.
    #[error("the Earth's maps are assets, and the app has no AssetServer; add Bevy's AssetPlugin")]
    NoAssets,
    /// The component's sky cannot be drawn.
    #[cfg(feature = "celestial")]
    #[error("the sky cannot be made: {0}")]
    Celestial(#[from] terrella::celestial::CelestialError),
    /// The components' tracks, stations or lines cannot be drawn. `satellite` counts the entities with a track.
    #[cfg(feature = "tracks")]
    #[error("tracks cannot be made: {0}")]
    Tracks(#[from] terrella::tracks::TracksError),
    /// The sensor's parameters do not fit each other.
    #[cfg(feature = "sensor")]
    #[error("the sensor: {0}")]
    Sensor(#[from] terrella_sensor::SensorError),
    /// The shutter needs a pose for each row.
    #[cfg(feature = "sensor")]
    #[error(
        "the sensor has a rolling shutter, and a Bevy frame has one pose; use Shutter::Global, or a scene's [sensor]"
    )]
    RollingShutter,
    /// The device cannot hold the sensor's image.
    #[cfg(feature = "sensor")]
    #[error(
        "the sensor needs a picture of {width} × {height}, and the device has {side} pixels a side and {megabytes} MiB a buffer; lower oversampling or size"
    )]
    SensorSize {
        /// Pixels per row of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Maximum pixels per side.
        side: u32,
        /// Maximum size of one readback.
        megabytes: u64,
    },
    /// The component's Earth cannot be drawn.
    #[error("the Earth cannot be made: {0}")]
    Earth(#[from] EarthError),
    /// Several entities are an Earth.
    #[error("{0} entities have the component Earth and one can be drawn; despawn the others")]
    Several(usize),
    /// An instant without a computable sky.
    #[error("the Earth's epoch is {0}; it must be in the years 1 to 9999")]
    Epoch(Epoch),
    /// An eight-bit target without an encoding.
    #[error(
        "the camera draws to {0:?}, which holds linear light in few bits; give it the component Hdr, or a target whose format is sRGB"
    )]
    Format(TextureFormat),
    /// A projection without a vanishing point.
    #[error("the camera's projection is no perspective; the Earth is drawn through a perspective")]
    Projection,
    /// The camera's transform mirrors or stretches.
    #[error(
        "the camera's transform mirrors or stretches its world; scale all three axes alike, by a positive number"
    )]
    Transform,
}
