//! The drawable of stars, Milky Way, Sun and Moon: plain values and maps. `crate::celestial` computes them for a time and an eye.

use super::shader::{CelestialKind, CelestialVariant, ShaderModule, ShaderVariant};
use super::{
    AirTextures, Binding, ErrorScope, GpuLayer, PassFormat, PipelineDescription, ShaderError,
};
use crate::plan::{AirSide, FrameUniforms};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};
use terrella_ground::half::half_bits;
use terrella_ground::light::DiffractionPattern;
use terrella_imagery::LayerImage;

/// `Disc` of `shaders/celestial.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Disc {
    /// Multiplied by the vector (pixel x, pixel y, 1), it gives the x of the pixel's ray in the disc's axes.
    pub pixel_x: Vec3,
    /// Distance of its centre, in its radii.
    pub distance: f32,
    pub pixel_y: Vec3,
    /// Depth at which it is drawn.
    pub depth: f32,
    /// As `pixel_x`, for the z of the ray, from the eye to the disc.
    pub pixel_z: Vec3,
    /// 1 if it hides the Earth, else 0.
    pub covers: f32,
    /// Bounds on screen: least x and y, greatest x and y, −1…1.
    pub bounds: Vec4,
}

/// `CelestialUniforms` of `shaders/celestial.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct CelestialUniforms {
    /// The eye, its rays and the exposure; its light and air are not read.
    pub frame: FrameUniforms,
    /// Width and height of the viewport, pixels.
    pub size_px: Vec2,
    /// Corner of the viewport, pixels.
    pub origin_px: Vec2,
    /// GCRF from ITRF, by columns.
    pub stars_x: Vec3,
    /// Brightness of stars and Milky Way relative to the true one.
    pub star_gain: f32,
    /// Second column.
    pub stars_y: Vec3,
    /// Mip level of the Milky Way's map with one texel a pixel.
    pub milky_way_level: f32,
    /// Third column.
    pub stars_z: Vec3,
    /// Fraction of the Sun's light that is not hidden by Earth and Moon.
    pub sun_seen: f32,
    pub sun: Disc,
    pub moon: Disc,
    /// The Moon's axes from those of its disc, by columns.
    pub moon_x: Vec3,
    /// Mip level of the Moon's map with one texel a pixel.
    pub moon_level: f32,
    /// Second column.
    pub moon_y: Vec3,
    /// Factor of the Moon's map.
    pub moon_albedo: f32,
    /// Third column.
    pub moon_z: Vec3,
    /// 1 − L of McEwen's law.
    pub moon_lambert: f32,
    /// From the Moon's centre to the Sun, unit, in the axes of the Moon's disc.
    pub moon_to_sun: Vec3,
    /// Earthshine on the Moon, as a fraction of sunlight.
    pub earthshine: f32,
    /// From the Moon's centre to the Earth's, in the Moon's radii, in the same axes.
    pub moon_to_earth: Vec3,
    /// Radius of the Earth, in the Moon's radii.
    pub earth_radius: f32,
    /// Bounds of the glare on screen, as those of a disc.
    pub glare_bounds: Vec4,
    /// Least depth.
    pub near_depth: f32,
    /// Fraction of the Sun's light that the aperture leaves in its disc.
    pub sun_kept: f32,
    /// Size of a pixel and radius of the Sun, in sides of the diffraction pattern.
    pub aperture: Vec2,
}

/// A star on screen.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct StarPoint {
    /// Position, −1…1.
    pub at: [f32; 2],
    /// Mean light of a pixel that contains all of it, RGB.
    pub light: [f32; 3],
}

/// A ghost on screen.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct GhostPoint {
    /// Position, −1…1.
    pub at: [f32; 2],
    /// Half of its width and height, in the same units.
    pub half_size: [f32; 2],
    /// Its light for an undimmed Sun, RGB.
    pub light: [f32; 3],
    /// Number of aperture blades, 0 for a round aperture.
    pub blades: f32,
}

const GHOST: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x2, 2 => Float32x3, 3 => Float32];
const STAR: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x3];

/// What is drawn, with the maps. Pipelines and textures are created only for these parts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CelestialParts<'m> {
    pub milky_way: Option<&'m LayerImage>,
    /// Largest number of stars, 0 for none.
    pub stars: usize,
    pub sun: bool,
    pub moon: Option<&'m LayerImage>,
    pub glare: bool,
    /// Diffraction pattern of the lens's aperture, added to the glare.
    pub aperture: Option<&'m DiffractionPattern>,
    /// Largest number of ghosts, 0 for none.
    pub ghosts: usize,
}

/// Pipelines, maps and buffers.
pub(crate) struct CelestialDrawable {
    device: wgpu::Device,
    format: PassFormat,
    layers: Vec<Layer>,
    uniforms: wgpu::Buffer,
    points: wgpu::Buffer,
    count: u32,
    ghosts: Option<wgpu::Buffer>,
    ghost_count: u32,
    /// One without air; otherwise one for an eye outside the air and one for an eye inside.
    bind_groups: Vec<wgpu::BindGroup>,
    /// Layouts of these groups.
    layouts: Vec<wgpu::BindGroupLayout>,
    side: usize,
    pub texture_bytes: u64,
    pub shader_bytes: u64,
}

/// One kind of celestial object.
#[derive(Clone)]
struct Layer {
    kind: CelestialKind,
    /// One for each side of the air, if created.
    pipelines: Vec<Option<wgpu::RenderPipeline>>,
    /// Whether a pipeline failed; then none is tried again.
    is_rejected: bool,
    map: Option<(wgpu::BindGroupLayout, wgpu::BindGroup)>,
    /// Whether the frame has anything of this kind.
    is_drawn: bool,
}

/// Sun and Moon may also be drawn as points.
const BODIES: usize = 2;

impl CelestialDrawable {
    /// Uploads the maps; creates no pipeline yet.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        format: PassFormat,
        parts: &CelestialParts<'_>,
        air: Option<&AirTextures>,
    ) -> Result<Self, ShaderError> {
        let uniforms = super::uniform_buffer::<CelestialUniforms>(device, "terrella sky");
        let point_bytes = ((parts.stars + BODIES) * size_of::<StarPoint>()) as u64;
        let points = point_buffer(device, "terrella stars", point_bytes);
        let ghost_bytes = (parts.ghosts * size_of::<GhostPoint>()) as u64;
        let ghosts =
            (ghost_bytes > 0).then(|| point_buffer(device, "terrella ghosts", ghost_bytes));
        let sides = AirSide::of_air(air.is_some());
        let (mut layouts, mut bind_groups) = (Vec::new(), Vec::new());
        for side in sides {
            let bindings = bindings(&uniforms, air.zip(*side));
            let (layout, bind_group) = super::bind(device, "terrella sky", bindings);
            layouts.push(layout);
            bind_groups.push(bind_group);
        }
        let (mut texture_bytes, mut shader_bytes) = (0, 0);
        let has_points = parts.stars > 0 || parts.sun || parts.moon.is_some();
        let mut layers = Vec::new();
        for kind in CelestialKind::ALL {
            let (is_wanted, map) = match kind {
                CelestialKind::MilkyWay => (parts.milky_way.is_some(), parts.milky_way),
                CelestialKind::Stars => (has_points, None),
                CelestialKind::Sun => (parts.sun, None),
                CelestialKind::Moon => (parts.moon.is_some(), parts.moon),
                CelestialKind::Glare => (parts.glare, None),
                CelestialKind::Ghosts => (parts.ghosts > 0, None),
            };
            if !is_wanted {
                continue;
            }
            let label = format!("terrella {}", kind.name());
            let pattern = parts.aperture.filter(|_| kind == CelestialKind::Glare);
            let texture = match (map, pattern) {
                (Some(image), _) => Some(GpuLayer::upload(device, queue, &label, image, false)),
                (None, Some(pattern)) => Some(upload_pattern(device, queue, &label, pattern)),
                (None, None) => None,
            };
            let map = texture.map(|texture| {
                texture_bytes += texture.bytes;
                bind_map(device, &label, &texture)
            });
            for air in sides.iter().copied() {
                let target = format.target_color();
                let has_map = map.is_some();
                let source = CelestialVariant::new(kind, has_map, target, air).source()?;
                shader_bytes += source.text.len() as u64;
            }
            layers.push(Layer {
                kind,
                pipelines: vec![None; sides.len()],
                is_rejected: false,
                map,
                is_drawn: false,
            });
        }
        Ok(Self {
            device: device.clone(),
            format,
            layers,
            uniforms,
            points,
            count: 0,
            ghosts,
            ghost_count: 0,
            bind_groups,
            layouts,
            side: 0,
            texture_bytes,
            shader_bytes,
        })
    }

    /// Shares the pipelines of the drawable that this one replaces, where they are the same.
    pub fn share_pipelines(&mut self, replaced: &Self) {
        if replaced.format != self.format || replaced.layouts.len() != self.layouts.len() {
            return;
        }
        for layer in &mut self.layers {
            let mut others = replaced.layers.iter();
            let same = others.find(|other| {
                other.kind == layer.kind && other.map.is_some() == layer.map.is_some()
            });
            if let Some(same) = same {
                layer.pipelines.clone_from(&same.pipelines);
                layer.is_rejected = same.is_rejected;
            }
        }
    }

    /// Creates all pipelines, so that no frame waits for one.
    pub fn make_all(&mut self) -> Result<(), ShaderError> {
        for place in 0..self.layers.len() {
            for side in 0..self.layouts.len() {
                self.make(place, side)?;
            }
        }
        Ok(())
    }

    /// Creates a missing pipeline.
    fn make(&mut self, place: usize, side: usize) -> Result<(), ShaderError> {
        let Some((layer, layout)) = self.layers.get_mut(place).zip(self.layouts.get(side)) else {
            return Ok(());
        };
        if layer.pipelines[side].is_some() {
            return Ok(());
        }
        let target = self.format.target_color();
        let air = AirSide::of_air(self.layouts.len() > 1)[side];
        let variant = CelestialVariant::new(layer.kind, layer.map.is_some(), target, air);
        let shader = ShaderModule::new(&self.device, &variant)?;
        let map_layout = layer.map.as_ref().map(|(layout, _)| Some(layout));
        let groups: Vec<_> = std::iter::once(Some(layout)).chain(map_layout).collect();
        let points = [instances(size_of::<StarPoint>(), &STAR)];
        let ghosts = [instances(size_of::<GhostPoint>(), &GHOST)];
        let pipeline = PipelineDescription {
            label: &format!("terrella {}", layer.kind.name()),
            bind_groups: Some(&groups),
            module: &shader.module,
            buffers: match layer.kind {
                CelestialKind::Stars => &points,
                CelestialKind::Ghosts => &ghosts,
                _ => &[],
            },
            primitive: wgpu::PrimitiveState {
                topology: wgpu::PrimitiveTopology::TriangleStrip,
                ..Default::default()
            },
            format: self.format,
            writes_depth: false,
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        };
        layer.pipelines[side] = Some(pipeline.create(&self.device));
        Ok(())
    }

    /// Creates the pipelines of this frame. A part whose pipeline fails is not drawn, and a warning is logged.
    fn make_ready(&mut self) {
        for place in 0..self.layers.len() {
            let layer = &self.layers[place];
            if !layer.is_drawn || layer.pipelines[self.side].is_some() {
                continue;
            }
            let scope = ErrorScope::open(&self.device, wgpu::ErrorFilter::Validation);
            let made = match layer.is_rejected {
                true => Ok(()),
                false => self.make(place, self.side),
            };
            let rejected = scope.error().map(|error| error.to_string());
            let rejected = made.err().map(|error| error.to_string()).or(rejected);
            let (side, layer) = (self.side, &mut self.layers[place]);
            if let Some(error) = rejected {
                tracing::warn!("{} is not drawn: {error}", layer.kind.name());
                layer.is_rejected = true;
                layer.pipelines[side] = None;
            }
            layer.is_drawn = layer.pipelines[side].is_some();
        }
    }

    /// The same for another view, through that view's air if there is any: it shares pipelines and maps and has its own buffers.
    pub fn for_another_view(&self, device: &wgpu::Device, air: Option<&AirTextures>) -> Self {
        let uniforms = super::uniform_buffer::<CelestialUniforms>(device, "terrella sky");
        let sides = AirSide::of_air(air.is_some()).iter().zip(&self.layouts);
        let bind_groups = sides.map(|(side, layout)| {
            let bindings = bindings(&uniforms, air.zip(*side));
            super::bind_to(device, "terrella sky", layout, bindings)
        });
        Self {
            device: device.clone(),
            format: self.format,
            bind_groups: bind_groups.collect(),
            layers: self.layers.clone(),
            points: point_buffer(device, "terrella stars", self.points.size()),
            uniforms,
            count: 0,
            ghosts: self
                .ghosts
                .as_ref()
                .map(|ghosts| point_buffer(device, "terrella ghosts", ghosts.size())),
            ghost_count: 0,
            layouts: self.layouts.clone(),
            side: 0,
            texture_bytes: self.texture_bytes,
            shader_bytes: self.shader_bytes,
        }
    }

    /// Uploads the objects of this frame, for an eye on this side of the air: at most as many points as stars, Sun and Moon, and as many ghosts as
    /// declared. Returns the bytes written.
    pub fn write(
        &mut self,
        queue: &wgpu::Queue,
        side: AirSide,
        uniforms: &CelestialUniforms,
        points: &[StarPoint],
        ghosts: &[GhostPoint],
        is_drawn: impl Fn(CelestialKind) -> bool,
    ) -> u64 {
        self.side = match self.bind_groups.len() {
            1 => 0,
            _ => side as usize,
        };
        queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(uniforms));
        let points: &[u8] = bytemuck::cast_slice(points);
        queue.write_buffer(&self.points, 0, points);
        self.count = (points.len() / size_of::<StarPoint>()) as u32;
        self.ghost_count = 0;
        if let Some(buffer) = &self.ghosts {
            queue.write_buffer(buffer, 0, bytemuck::cast_slice(ghosts));
            self.ghost_count = ghosts.len() as u32;
        }
        for layer in &mut self.layers {
            layer.is_drawn = match layer.kind {
                CelestialKind::Stars => self.count > 0,
                CelestialKind::Ghosts => self.ghost_count > 0 && is_drawn(CelestialKind::Ghosts),
                kind => is_drawn(kind),
            };
        }
        self.make_ready();
        let ghost_bytes = self.ghost_count as usize * size_of::<GhostPoint>();
        (points.len() + ghost_bytes + size_of::<CelestialUniforms>()) as u64
    }

    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        for layer in self.layers.iter().filter(|layer| layer.is_drawn) {
            let Some(pipeline) = &layer.pipelines[self.side] else {
                continue;
            };
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &self.bind_groups[self.side], &[]);
            if let Some((_, map)) = &layer.map {
                pass.set_bind_group(1, map, &[]);
            }
            let mut instances = 1;
            if layer.kind == CelestialKind::Stars {
                pass.set_vertex_buffer(0, self.points.slice(..));
                instances = self.count;
            }
            if let (CelestialKind::Ghosts, Some(ghosts)) = (layer.kind, &self.ghosts) {
                pass.set_vertex_buffer(0, ghosts.slice(..));
                instances = self.ghost_count;
            }
            pass.draw(0..4, 0..instances);
        }
    }

    /// Number of draw calls of a frame.
    pub fn calls(&self) -> u32 {
        self.layers.iter().filter(|layer| layer.is_drawn).count() as u32
    }
}

fn instances(
    stride: usize,
    attributes: &[wgpu::VertexAttribute],
) -> Option<wgpu::VertexBufferLayout<'_>> {
    Some(wgpu::VertexBufferLayout {
        array_stride: stride as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes,
    })
}

fn point_buffer(device: &wgpu::Device, label: &str, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Group 0.
fn bindings<'a>(
    uniforms: &'a wgpu::Buffer,
    air: Option<(&'a AirTextures, AirSide)>,
) -> Vec<Binding<'a>> {
    let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
    let mut bindings = vec![(
        super::uniform_entry(0, stages, size_of::<CelestialUniforms>()),
        wgpu::BindGroupEntry {
            binding: 0,
            resource: uniforms.as_entire_binding(),
        },
    )];
    if let Some((air, side)) = air {
        bindings.extend(air.bindings(side));
    }
    bindings
}

/// The diffraction pattern of an aperture with its mip levels, in half floats.
fn upload_pattern(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    pattern: &DiffractionPattern,
) -> GpuLayer {
    let extent = |side| wgpu::Extent3d {
        width: side,
        height: side,
        depth_or_array_layers: 1,
    };
    let levels = pattern.levels();
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: extent(DiffractionPattern::SIDE_PX),
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let mut bytes = 0;
    for (mip_level, level) in (0..).zip(levels) {
        let side = DiffractionPattern::SIDE_PX >> mip_level;
        let texels: Vec<u16> = level.iter().map(|value| half_bits(*value)).collect();
        let texels: &[u8] = bytemuck::cast_slice(&texels);
        bytes += texels.len() as u64;
        let target = wgpu::TexelCopyTextureInfo {
            texture: &texture,
            mip_level,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
        };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(2 * side),
            rows_per_image: None,
        };
        queue.write_texture(target, texels, layout, extent(side));
    }
    GpuLayer {
        view: super::view(&texture),
        bytes,
    }
}

/// Group 1, its layout first: a map that repeats in longitude.
fn bind_map(
    device: &wgpu::Device,
    label: &str,
    texture: &GpuLayer,
) -> (wgpu::BindGroupLayout, wgpu::BindGroup) {
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some(label),
        address_mode_u: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    });
    let map = wgpu::BindGroupEntry {
        binding: 0,
        resource: wgpu::BindingResource::TextureView(&texture.view),
    };
    let sampler = wgpu::BindGroupEntry {
        binding: 1,
        resource: wgpu::BindingResource::Sampler(&sampler),
    };
    let d2 = wgpu::TextureViewDimension::D2;
    let bindings = vec![
        (super::texture_entry(0, d2), map),
        (super::sampler_entry(1), sampler),
    ];
    super::bind(device, label, bindings)
}
