//! Which textures are sampled how often, and the shader that does.

use super::view::CORNERS;
use std::fmt::Write;
use terrella::internals::gpu::{GpuContext, GpuLayer, LAMPS_OUT_SIN};
use terrella::{Atmosphere, EarthOptions, Shading};
use terrella_ground::air;
use terrella_imagery::NEIGHBOURHOODS;
use terrella_imagery::tile::MapLayer;

/// The first binding of a texture.
const FIRST_TEXTURE: u32 = 3;

/// A texture, and the coordinates that it is sampled at, in WGSL.
struct Sampled {
    view: wgpu::TextureView,
    kind: Kind,
    /// On every pixel of the ground.
    always: Vec<String>,
    /// Besides, where the Sun is down: by day the Earth is drawn without what shows by night alone.
    by_night: Vec<String>,
}

#[derive(PartialEq)]
enum Kind {
    /// A map of the Earth.
    Map,
    /// A flat table of the air.
    Flat,
    /// A table of three dimensions.
    Volume,
}

/// Textures that the floor samples.
pub struct Samples(Vec<Sampled>);

impl Samples {
    /// Those that an Earth with these options reads on each pixel of the ground.
    pub fn of(gpu: &GpuContext, options: &EarthOptions) -> Self {
        let is_sunlit = options.shading == Shading::Sunlit;
        let has_moon = is_sunlit && options.light.moonlight;
        let mut all = Vec::new();
        for layer in MapLayer::ALL {
            let is_read = is_sunlit || !matches!(layer, MapLayer::NightLights | MapLayer::Water);
            let Some(image) = options.layers.get(layer).filter(|_| is_read) else {
                continue;
            };
            let label = "terrella floor map";
            let mut sampled = Sampled {
                view: GpuLayer::upload(&gpu.device, &gpu.queue, label, image, false).view,
                kind: Kind::Map,
                always: Vec::new(),
                by_night: Vec::new(),
            };
            match layer {
                MapLayer::NightLights => sampled.by_night.push("uv".to_owned()),
                _ => sampled.always.push("uv".to_owned()),
            }
            if layer == MapLayer::Clouds && options.light.cloud_shadows && is_sunlit {
                sampled.always.push("uv + ASIDE".to_owned());
                if has_moon {
                    sampled.by_night.push("uv - ASIDE".to_owned());
                }
            }
            all.push(sampled);
        }
        if options.atmosphere != Atmosphere::None {
            let has_clouds = options.layers.clouds.is_some();
            all.extend(of_the_air(gpu, is_sunlit, has_clouds, has_moon));
        }
        Self(all)
    }

    /// The shader that samples them.
    pub fn shader(&self) -> String {
        let (mut text, mut always, mut by_night) = (HEAD.to_owned(), String::new(), String::new());
        // Writing to a string does not fail.
        let _ = writeln!(text, "const CORNERS: u32 = {CORNERS}u;");
        for (n, sampled) in self.0.iter().enumerate() {
            let dimensions = match sampled.kind {
                Kind::Volume => "3d",
                Kind::Map | Kind::Flat => "2d",
            };
            let binding = n + FIRST_TEXTURE as usize;
            let _ = writeln!(
                text,
                "@group(0) @binding({binding}) var t{n}: texture_{dimensions}<f32>;"
            );
            let sample = |place: &String| match sampled.kind {
                Kind::Map => format!("    c += textureSampleGrad(t{n}, maps, {place}, dx, dy);\n"),
                _ => format!("    c += textureSampleLevel(t{n}, tables, {place}, 0.0);\n"),
            };
            always.extend(sampled.always.iter().map(sample));
            by_night.extend(sampled.by_night.iter().map(sample));
        }
        text + BODY.0
            + &always
            + &format!("    if mu_s < {LAMPS_OUT_SIN:?} {{\n{by_night}    }}\n")
            + BODY.1
    }

    /// The bind group of the pass.
    pub fn bind(
        &self,
        gpu: &GpuContext,
        options: &EarthOptions,
        pipeline: &wgpu::RenderPipeline,
        view: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let device = &gpu.device;
        let maps = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("terrella floor maps"),
            address_mode_u: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            anisotropy_clamp: match gpu.is_software() {
                true => 1,
                false => options.anisotropy,
            },
            ..Default::default()
        });
        let tables = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("terrella floor tables"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let layout = pipeline.get_bind_group_layout(0);
        let mut entries = vec![wgpu::BindGroupEntry {
            binding: 0,
            resource: view.as_entire_binding(),
        }];
        let textures = self.0.iter();
        let resources = [&maps, &tables]
            .map(wgpu::BindingResource::Sampler)
            .into_iter()
            .chain(textures.map(|sampled| wgpu::BindingResource::TextureView(&sampled.view)));
        let has_tables = self.0.iter().any(|sampled| sampled.kind != Kind::Map);
        for (binding, resource) in (1..).zip(resources) {
            // What the shader does not name is not in its layout.
            if binding != 2 || has_tables {
                entries.push(wgpu::BindGroupEntry { binding, resource });
            }
        }
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("terrella floor"),
            layout: &layout,
            entries: &entries,
        })
    }
}

/// Tables of the air, empty ones of the same size and format.
fn of_the_air(gpu: &GpuContext, is_sunlit: bool, has_clouds: bool, has_moon: bool) -> Vec<Sampled> {
    // Cosines of zenith angles as coordinates; the Moon's is another than the Sun's.
    let (sun, moon) = ("0.5 + 0.5 * mu_s", "0.5 - 0.4 * mu_s");
    let sampled = |size: air::TableSize, of: &dyn Fn(&str) -> Vec<String>| {
        let (dimension, kind) = match size.z {
            1 => (wgpu::TextureDimension::D2, Kind::Flat),
            _ => (wgpu::TextureDimension::D3, Kind::Volume),
        };
        Sampled {
            view: table(gpu, size, dimension),
            kind,
            always: of(sun),
            by_night: if has_moon { of(moon) } else { Vec::new() },
        }
    };
    let once = |size, place: &str| Sampled {
        by_night: Vec::new(),
        ..sampled(size, &|_| vec![place.to_owned()])
    };
    let albedo = air::TableSize {
        x: NEIGHBOURHOODS + 2,
        y: NEIGHBOURHOODS / 2,
        z: 1,
    };
    let mut all = Vec::new();
    if is_sunlit {
        let rows = if has_clouds { 3 } else { 2 };
        all.push(sampled(air::SUNLIGHT_AND_CLOUDS, &|cosine| {
            let rows = 0..rows;
            rows.map(|row| format!("vec2f({cosine}, {row}.5 / 3.0)"))
                .collect()
        }));
    }
    all.push(once(albedo, "uv"));
    all.push(once(air::THROUGH, "vec2f(mu, 0.5)"));
    all.push(sampled(air::BOUNCE, &|cosine| {
        vec![format!("vec2f(mu, {cosine})")]
    }));
    all.push(sampled(air::SCATTERING, &|cosine| {
        vec![format!("vec3f(mu, {cosine}, 0.5 * mu)")]
    }));
    all
}

fn table(
    gpu: &GpuContext,
    size: air::TableSize,
    dimension: wgpu::TextureDimension,
) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("terrella floor table"),
        size: wgpu::Extent3d {
            width: size.x,
            height: size.y,
            depth_or_array_layers: size.z,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}

const HEAD: &str = "struct View {
    clip_from_eye: mat4x4f,
    eye_scaled: vec3f, above: f32,
    corner_ray: vec3f, polar_stretch: f32,
    pixel_right: vec3f, padding_0: f32,
    pixel_down: vec3f, padding_1: f32,
    limb_center: vec3f, padding_2: f32,
    limb_across: vec3f, padding_3: f32,
    limb_beside: vec3f, padding_4: f32,
    sun_itrf: vec3f, padding_5: f32,
}
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var maps: sampler;
@group(0) @binding(2) var tables: sampler;
const PI: f32 = 3.14159265;
// Shadows of clouds: some kilometres.
const ASIDE: vec2f = vec2f(0.0003, 0.0003);
";

/// The point of the ground and the footprint are those of shaders/earth/surface_point/ray_on_ellipsoid.wgsl.
const BODY: (&str, &str) = (
    "@vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    // One triangle over the middle, then one on each side of those before: few of them are slivers.
    let rest = max(i / 3u, 1u) - 1u;
    let level = firstLeadingBit(rest / 3u + 1u);
    let side = (CORNERS / 3u) >> level;
    let outer = side * (rest + 3u - (3u << level)) + (i % 3u) * (side / 2u);
    let corner = select(outer, (i % 3u) * (CORNERS / 3u), i < 3u);
    let angle = f32(corner) * (2.0 * PI / f32(CORNERS));
    let at = view.limb_center + cos(angle) * view.limb_across + sin(angle) * view.limb_beside;
    return view.clip_from_eye * vec4f(at, 1.0);
}
@fragment fn fragment(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let ray = view.corner_ray + pixel.x * view.pixel_right + pixel.y * view.pixel_down;
    let to_scaled = vec3f(1.0, 1.0, view.polar_stretch);
    let scaled = ray * to_scaled;
    let d = normalize(scaled);
    let across_ray = cross(view.eye_scaled, d);
    let root = sqrt(max(1.0 - dot(across_ray, across_ray), 0.0));
    let t = max(view.above / max(root - dot(view.eye_scaled, d), 1e-9), 0.0);
    let up = normalize((view.eye_scaled + t * d) * to_scaled);
    let across = max(length(up.xy), 1e-7);
    let uv = vec2f(0.5 + atan2(up.y, up.x) / (2.0 * PI), acos(clamp(up.z, -1.0, 1.0)) / PI);
    let east = vec3f(-up.y, up.x, 0.0) / across;
    let north = cross(up, east);
    let radii = t / length(scaled);
    let facing = min(dot(up, ray), -0.02 * length(ray));
    let right = radii * (view.pixel_right - ray * (dot(up, view.pixel_right) / facing));
    let down = radii * (view.pixel_down - ray * (dot(up, view.pixel_down) / facing));
    let to_uv = vec2f(0.5, -1.0) / PI;
    let dx = vec2f(dot(east, right), dot(north, right)) * to_uv;
    let dy = vec2f(dot(east, down), dot(north, down)) * to_uv;
    let mu = -dot(up, ray) / length(ray);
    let mu_s = dot(up, view.sun_itrf);
    var c = vec4f(0.0);
",
    "    return c * 0.2;
}
",
);
