//! Errors in the options of an Earth.

use crate::gpu::{MapError, ShaderError, SurfaceOutput};
use terrella_ground::globe::Shading;
use terrella_ground::globe::SubdivisionError;
use terrella_imagery::ImageryError;

/// Why an Earth cannot be drawn with its options.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EarthError {
    /// Subdivision outside 1…48.
    #[error(transparent)]
    Subdivision(#[from] SubdivisionError),
    /// [`EarthOptions::anisotropy`](crate::EarthOptions::anisotropy) outside 1…16.
    #[error("anisotropy is {0}; it must be from 1 to 16")]
    Anisotropy(u16),
    /// Invalid terrain settings.
    #[cfg(feature = "terrain")]
    #[error(transparent)]
    Surface(#[from] terrella_ground::globe::SurfaceError),
    /// Exposure outside [`Exposure::RANGE_EV`](terrella_ground::light::Exposure::RANGE_EV) or not finite.
    #[error("exposure is {0} EV; it must be a number from −20 to 20")]
    Exposure(f64),
    /// A measured response without development after the pass.
    #[error(
        "the tone is the measured response {0:?}, which is applied after the pass; give Development::AfterPass and a float colour \
         format (EarthOptions::develop_after_pass), or another tone"
    )]
    Response(&'static str),
    /// White balance or grain out of its range, or not a number.
    #[error("{name} is {value}; it must be from {low} to {high}")]
    Grade {
        /// The option's name.
        name: &'static str,
        /// Value that was given.
        value: f64,
        /// Smallest allowed value.
        low: f64,
        /// Largest allowed value.
        high: f64,
    },
    /// White balance or grain without development after the pass.
    #[error(
        "white balance and grain are applied after the pass; give Development::AfterPass and a float colour format \
         (EarthOptions::develop_after_pass), or leave them out"
    )]
    GradeInPass,
    /// Bloom outside [`Bloom::STRENGTH`](terrella_ground::light::Bloom::STRENGTH) or not a number.
    #[error("the lens's bloom is {0}; it must be from 0 to 0.5")]
    Bloom(f64),
    /// Scale outside [`Quality::SCALES`](crate::Quality::SCALES) or not a number.
    #[error("the picture's scale is {0}; it must be from 0.25 to 1")]
    Scale(f64),
    /// Aerosol outside 0 to [`AirOptions::MAX_AEROSOL`](terrella_ground::air::AirOptions::MAX_AEROSOL) or not a number.
    #[error("the aerosol's optical depth is {0}; it must be from 0 to 5")]
    Aerosol(f64),
    /// An option of the light on the surface out of its range, or not a number.
    #[error("{name} of the surface's light is {value}; it must be from {low} to {high}")]
    SurfaceLight {
        /// The option's name.
        name: &'static str,
        /// Value that was given.
        value: f64,
        /// Smallest allowed value.
        low: f64,
        /// Largest allowed value.
        high: f64,
    },
    /// A map is larger than the device takes.
    #[error(
        "the {layer} map is {width} × {height}; this device takes at most {limit} pixels a side"
    )]
    TooLarge {
        /// Name of the map.
        layer: &'static str,
        /// Width of the map, texels.
        width: u32,
        /// Height of the map, texels.
        height: u32,
        /// The device's limit.
        limit: u32,
    },
    /// A map's texels do not fit its description.
    #[error(transparent)]
    Layer(#[from] ImageryError),
    /// A change was prepared for another Earth, or for an earlier quality of this one.
    #[error(
        "this quality was prepared for another Earth, or before the quality of this one changed; prepare it again"
    )]
    OutOfDate,
    /// A map cannot be used.
    #[error(transparent)]
    Map(#[from] MapError),
    /// A shader file is invalid.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// A tile source has a map that the Earth does not draw.
    #[error(
        "there are tiles of the {0} map but no whole map of it among the layers; add it or leave its tiles out"
    )]
    NoWholeMap(&'static str),
    /// Tiles are compressed and the device cannot read them.
    #[error(
        "the tiles are BC-compressed, but the device was opened without TEXTURE_COMPRESSION_BC; \
         open it with that feature, or have the tiles decoded (PackTiles::new with decode = true)"
    )]
    NoBc,
    /// The wireframe is requested and the device cannot draw lines.
    #[error(
        "the wireframe needs POLYGON_MODE_LINE, which the device was opened without; \
         open it with that feature, or on another adapter (terrella doctor lists them) if this one does not have it"
    )]
    NoLines,
    /// The wireframe is requested for a surface that has no triangles.
    #[error(
        "ray-cast contours have no triangles whose edges could be drawn; leave out the wireframe, or draw \
         contours as patches (drawn = \"patches\" under [earth.contours] in a scene)"
    )]
    NoEdges,
    /// Truth layers are requested for a pass that cannot store them.
    #[error(
        "truth is written to {:?}, {:?} and {:?} with one sample a pixel; color_format is {format:?} and samples {samples}: \
         give the first of them and 1",
        SurfaceOutput::TRUTH[0], SurfaceOutput::TRUTH[1], SurfaceOutput::TRUTH[2]
    )]
    TruthTarget {
        /// Colour format that was given.
        format: wgpu::TextureFormat,
        /// Samples a pixel that were given.
        samples: u32,
    },
    /// Development after the pass is requested, but the pass does not store light.
    #[error(
        "light that is developed after the pass needs a float colour format (Rgba16Float, Rgba32Float) and sunlit shading; \
         color_format is {format:?} and the shading {shading:?}: give such a format, or Development::InPass"
    )]
    Development {
        /// Colour format that was given.
        format: wgpu::TextureFormat,
        /// Shading that was given.
        shading: Shading,
    },
    /// The textures do not fit into the device's memory.
    #[error(
        "the device has no room for {mib} MiB of maps and tiles: {cause}; \
         give a smaller texture budget (texture_mb under [earth] in a scene)"
    )]
    NoRoom {
        /// Texture memory requested, MiB.
        mib: u64,
        /// Error message of the device.
        cause: String,
    },
    /// A shader or pipeline was rejected by the device, for instance for a colour format it cannot draw to.
    #[error("the device rejected the Earth's pipelines: {0}")]
    Rejected(String),
}

impl EarthError {
    /// Of pipelines that the device rejected for this reason.
    pub(super) fn rejected(cause: impl std::fmt::Display) -> Self {
        Self::Rejected(cause.to_string())
    }
}
