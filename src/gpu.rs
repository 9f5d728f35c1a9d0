//! Code that uses wgpu: adapter, targets, shaders, uniform structs, one file per drawable.

mod air;
mod bloom;
#[cfg(feature = "celestial")]
mod celestial;
mod city_lights;
mod context;
#[cfg(feature = "terrain")]
mod contours;
mod detail_tiles;
mod develop;
mod faults;
mod full_pass;
#[cfg(feature = "terrain")]
mod grid;
#[cfg(feature = "terrain")]
mod ground;
mod lattice;
mod layers;
mod map;
mod map_upload;
mod maps;
mod mesh;
mod pass_kind;
mod pipeline;
mod read_back;
#[cfg_attr(not(feature = "terrain"), path = "gpu/no_relief.rs")]
mod relief;
mod scaled;
mod scopes;
mod shader;
mod situation;
mod surface;
mod surface_config;
mod surface_pipelines;
mod surface_view;
mod targets;
mod tiles;
mod timer;
#[cfg(feature = "tracks")]
mod tracks;
mod truth_targets;
mod uploaded_maps;

pub use bloom::BloomPass;
#[cfg(feature = "celestial")]
pub use celestial::{CelestialUniforms, Disc};
pub(crate) use context::device_limits;
pub use context::{AdapterReport, BcSupport, ContextError, GpuContext, adapter_reports};
pub use develop::{Developer, GradeUniforms, UndevelopedPicture};
pub use faults::GpuFault;
pub(crate) use map::check_size;
pub use map::{GpuMap, MapError, MapFade};
pub use scaled::ScaledTarget;
#[cfg(not(target_family = "wasm"))]
pub(crate) use scopes::resolved;
pub(crate) use scopes::{CreationErrors, CreationScopes, ErrorScope};
pub use shader::{
    AirVariant, AirViewVariant, BloomVariant, CelestialKind, CelestialVariant, DevelopVariant,
    EarthOutput, EarthVariant, GlowVariant, MapFadeVariant, PaperLayers, PatchTiles, SHADER_FILES,
    ShaderCapability, ShaderError, ShaderFiles, ShaderText, ShaderVariant, ShadingVariant,
    SunlitLayers, TargetColor, TrackKind, TracksVariant, TruthLayers, UpscaleVariant, VertexForm,
};
pub use targets::{
    Attachments, FrameTargets, PassPart, color_texture, read_floats, read_halves, read_texture,
};
pub use timer::{GpuTimer, TimerError};
#[cfg(feature = "tracks")]
pub use tracks::TrackUniforms;
pub use truth_targets::{TruthTargets, TruthTexel};
pub use uploaded_maps::{MapUploader, UploadedMaps};

pub(crate) use air::{AirDrawable, AirTextures, Binding};
#[cfg(feature = "celestial")]
pub(crate) use celestial::{CelestialDrawable, CelestialParts, GhostPoint, StarPoint};
#[cfg(feature = "terrain")]
pub(crate) use contours::PageMesh;
#[cfg(feature = "terrain")]
pub(crate) use grid::GridMesh;
pub use layers::GpuLayer;
pub use pipeline::PipelineDescription;
pub use read_back::PictureError;
#[cfg(feature = "celestial")]
pub(crate) use shader::GLARE_RADIUS_RAD;
#[cfg(feature = "tiles")]
pub(crate) use shader::GLINT_ENDS_SIN;
pub(crate) use shader::LAMPS_FULL_SIN;
#[cfg(feature = "tracks")]
pub(crate) use shader::{
    FROM_PREVIOUS as TRACK_FROM_PREVIOUS, ON_GROUND as TRACK_ON_GROUND, UNCASED as TRACK_UNCASED,
};
pub use shader::{LAMPS_OUT_SIN, VIEW_ANGLES, VIEW_AZIMUTHS};
pub(crate) use surface::SurfaceDrawable;
pub(crate) use surface_config::SurfaceConfig;
pub(crate) use surface_pipelines::{SurfaceMaker, SurfacePipelines};
pub(crate) use surface_view::SurfaceView;
#[cfg(feature = "tracks")]
pub(crate) use tracks::{DrawnTracks, Fill, LinePoint, Mark, TrackKinds, TracksDrawable, Triangle};

#[cfg(feature = "tracks")]
use glam::DVec3;
use terrella_ground::light::{Bloom, Grade, Tone};
#[cfg(feature = "tracks")]
use terrella_imagery::srgb::linear_from_encoded;

/// The depth buffer of the pass that the Earth is drawn in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthBuffer {
    /// The pass has none: the Earth is drawn over everything already there.
    None,
    /// Reversed depth: nearer is larger (clear to 0). Recommended: it keeps precision to the horizon.
    ReversedZ(wgpu::TextureFormat),
    /// Nearer is smaller (clear to 1).
    StandardZ(wgpu::TextureFormat),
}

/// What the surface writes to the colour target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SurfaceOutput {
    /// The image.
    #[default]
    Color,
    /// The geolocation buffer, for measurements, instead of the image. The target is [`SurfaceOutput::GEOLOCATION`] with one sample a pixel,
    /// cleared to 0. A pixel of the ground holds four numbers: texture coordinates (u east from 180° W, v south from the north pole, both 0…1 over
    /// the whole map) relative to the block's centre, and those of that centre. With terrain it holds 1, 1, 1 and the distance of the drawn ground,
    /// in lengths of the pixel's ray to the plane one metre in front of the eye.
    /// No air is drawn and no map is read.
    Geolocation,
    /// Ground truth of each pixel, instead of the image: see [`TruthTexel`]. The pass has the three targets [`SurfaceOutput::TRUTH`], in this
    /// order, cleared to 0, with one sample a pixel. The Earth's options name the first of them as their colour format. There is no air and no
    /// synthetic detail, and nothing else can be drawn in such a pass.
    Truth,
}

impl SurfaceOutput {
    /// The target's format for [`Self::Geolocation`].
    pub const GEOLOCATION: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
    /// The targets' formats for [`Self::Truth`], together 28 bytes a pixel of the 32 that every WebGPU device can write:
    /// place, marks and ground of a [`TruthTexel`].
    pub const TRUTH: [wgpu::TextureFormat; 3] = [
        wgpu::TextureFormat::Rgba32Float,
        wgpu::TextureFormat::R32Uint,
        wgpu::TextureFormat::Rgba16Float,
    ];

    /// Formats of the targets after the first.
    pub(crate) fn further_targets(self) -> &'static [wgpu::TextureFormat] {
        match self {
            Self::Color | Self::Geolocation => &[],
            Self::Truth => &Self::TRUTH[1..],
        }
    }
}

/// Where exposed light is developed into displayable colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Development {
    /// In the shader of each layer, before layers are blended: one pass without an intermediate texture, exact where layers do not overlap.
    /// Overlapping layers add their displayed colours instead of their light. Float targets get unexposed light.
    #[default]
    InPass,
    /// After the pass, by a [`Developer`]: the pass accumulates exposed light in a float target, also where layers overlap.
    AfterPass,
}

/// Format of the pass, which all pipelines of one Earth share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassFormat {
    pub color: wgpu::TextureFormat,
    /// Formats of the further colour targets; nothing is blended into them.
    pub further: &'static [wgpu::TextureFormat],
    pub samples: u32,
    pub depth: DepthBuffer,
    /// Where exposed light is developed.
    pub development: Development,
    /// Tone curve.
    pub tone: Tone,
    /// Bloom of light that is developed after the pass.
    pub bloom: Bloom,
    /// White balance and grain of light that is developed after the pass.
    pub grade: Grade,
}

impl PassFormat {
    /// Depth state of a drawable that tests and, if `write`, writes depth.
    fn depth_stencil(&self, write: bool) -> Option<wgpu::DepthStencilState> {
        let (format, compare) = match self.depth {
            DepthBuffer::None => return None,
            DepthBuffer::ReversedZ(format) => (format, wgpu::CompareFunction::GreaterEqual),
            DepthBuffer::StandardZ(format) => (format, wgpu::CompareFunction::LessEqual),
        };
        Some(wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(write),
            depth_compare: Some(compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        })
    }

    /// What the shaders write to the colour target.
    pub fn target_color(&self) -> TargetColor {
        match self.color {
            color if stores_light(color) => match self.development {
                Development::InPass => TargetColor::Radiance,
                Development::AfterPass => TargetColor::Exposed,
            },
            color if color.is_srgb() => TargetColor::Linear(self.tone),
            _ => TargetColor::Display(self.tone),
        }
    }

    /// Whether the pass accumulates exposed light that is developed after it.
    #[cfg(feature = "tracks")]
    pub(crate) fn is_developed_later(&self) -> bool {
        self.target_color() == TargetColor::Exposed
    }

    /// Value that the target stores for a display colour, sRGB, which is blended with an opacity above 0: red, green and blue, not premultiplied.
    /// With development after the pass, it is the light that is displayed as this colour on black, reduced by the opacity.
    #[cfg(feature = "tracks")]
    pub(crate) fn stored_color(&self, srgb: [u8; 3], opacity: f64) -> [f32; 3] {
        let display = srgb.map(|code| f64::from(code) / f64::from(u8::MAX));
        let linear = DVec3::from_array(display.map(linear_from_encoded));
        let stored = match self.target_color() {
            TargetColor::Display(_) => DVec3::from_array(display),
            TargetColor::Linear(_) | TargetColor::Radiance => linear,
            TargetColor::Exposed => {
                let light = self.tone.light_shown_as(opacity * linear) / opacity;
                self.grade.before_balance(light)
            }
        };
        stored.as_vec3().to_array()
    }

    fn multisample(&self) -> wgpu::MultisampleState {
        wgpu::MultisampleState {
            count: self.samples,
            ..Default::default()
        }
    }
}

/// Whether a target of this format stores light instead of displayable colour.
pub(crate) fn stores_light(format: wgpu::TextureFormat) -> bool {
    use wgpu::TextureFormat as F;
    matches!(format, F::Rgba16Float | F::Rgba32Float | F::Rg11b10Ufloat)
}

/// A view of the whole texture.
fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        label: Some("terrella view"),
        ..Default::default()
    })
}

/// A uniform buffer for one `T`.
fn uniform_buffer<T>(device: &wgpu::Device, label: &str) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size_of::<T>() as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// A buffer with initial content. On a lost device it is empty: wgpu calls its error handler, and nothing panics.
fn filled_buffer(
    device: &wgpu::Device,
    label: &str,
    contents: &[u8],
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    let align = wgpu::COPY_BUFFER_ALIGNMENT;
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: (contents.len() as u64).next_multiple_of(align).max(align),
        usage,
        mapped_at_creation: true,
    });
    if let Ok(mut range) = buffer.get_mapped_range_mut(..) {
        range.slice(..contents.len()).copy_from_slice(contents);
    }
    buffer.unmap();
    buffer
}

/// A bind group and its layout.
fn bind(
    device: &wgpu::Device,
    label: &str,
    bindings: Vec<Binding<'_>>,
) -> (wgpu::BindGroupLayout, wgpu::BindGroup) {
    let layout = layout_of(device, label, &bindings);
    let bind_group = bind_to(device, label, &layout, bindings);
    (layout, bind_group)
}

/// The layout of bindings.
fn layout_of(
    device: &wgpu::Device,
    label: &str,
    bindings: &[Binding<'_>],
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = bindings.iter().map(|(entry, _)| *entry).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &entries,
    })
}

/// A bind group for a layout that was made from the same bindings.
fn bind_to(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    bindings: Vec<Binding<'_>>,
) -> wgpu::BindGroup {
    let entries: Vec<_> = bindings.into_iter().map(|(_, entry)| entry).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &entries,
    })
}

fn uniform_entry(
    binding: u32,
    visibility: wgpu::ShaderStages,
    size: usize,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: wgpu::BufferSize::new(size as u64),
        },
        count: None,
    }
}

fn texture_entry(
    binding: u32,
    dimension: wgpu::TextureViewDimension,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: dimension,
            multisampled: false,
        },
        count: None,
    }
}

fn sampler_entry(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        count: None,
    }
}
