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

/// The part that does not depend on the sampled textures.
const SHADER: &str = include_str!("../../shaders/floor.wgsl");

/// A texture, and the coordinates that it is sampled at, in WGSL.
struct Sampled {
    texture: Texture,
    /// On every pixel of the ground.
    always: Vec<String>,
    /// Besides, where the Sun is down: by day the Earth is drawn without what shows by night alone.
    by_night: Vec<String>,
}

#[derive(Clone, Copy)]
enum Texture {
    /// A map of the Earth.
    Map(MapLayer),
    Table(air::TableSize),
}

/// Textures that the floor samples.
pub struct Samples(Vec<Sampled>);

impl Samples {
    /// Those that an Earth with these options reads on each pixel of the ground.
    pub fn of(options: &EarthOptions) -> Self {
        let is_sunlit = options.shading == Shading::Sunlit;
        let has_moon = is_sunlit && options.light.moonlight;
        let mut all = Vec::new();
        for layer in MapLayer::ALL {
            let is_read = is_sunlit || !matches!(layer, MapLayer::NightLights | MapLayer::Water);
            if !is_read || options.layers.get(layer).is_none() {
                continue;
            }
            let mut sampled = Sampled {
                texture: Texture::Map(layer),
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
            all.extend(of_the_air(is_sunlit, has_clouds, has_moon));
        }
        Self(all)
    }

    /// The shader that samples them.
    pub fn shader(&self) -> String {
        let (mut text, mut always, mut by_night) =
            (SHADER.to_owned(), String::new(), String::new());
        // Writing to a string does not fail.
        let _ = writeln!(text, "const CORNERS: u32 = {CORNERS}u;");
        for (n, sampled) in self.0.iter().enumerate() {
            let dimensions = match sampled.texture {
                Texture::Table(size) if size.z > 1 => "3d",
                Texture::Map(_) | Texture::Table(_) => "2d",
            };
            let binding = n + FIRST_TEXTURE as usize;
            let _ = writeln!(
                text,
                "@group(0) @binding({binding}) var t{n}: texture_{dimensions}<f32>;"
            );
            let sample = |place: &String| match sampled.texture {
                Texture::Map(_) => {
                    format!("    c += textureSampleGrad(t{n}, maps, {place}, dx, dy);\n")
                }
                Texture::Table(_) => {
                    format!("    c += textureSampleLevel(t{n}, tables, {place}, 0.0);\n")
                }
            };
            always.extend(sampled.always.iter().map(sample));
            by_night.extend(sampled.by_night.iter().map(sample));
        }
        text + &format!(
            "fn sampled(uv: vec2f, dx: vec2f, dy: vec2f, mu: f32, mu_s: f32) -> vec4f {{
    var c = vec4f(0.0);
{always}    if mu_s < {LAMPS_OUT_SIN:?} {{
{by_night}    }}
    return c;
}}
"
        )
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
        let textures = self.0.iter().map(|sampled| sampled.texture);
        let views = textures.clone().filter_map(|texture| match texture {
            Texture::Map(layer) => {
                let (image, label) = (options.layers.get(layer)?, "terrella floor map");
                match options.uploaded.get(layer).filter(|_| !image.has_texels()) {
                    Some(map) => Some(map.view().clone()),
                    None => Some(GpuLayer::upload(device, &gpu.queue, label, image, false).view),
                }
            }
            Texture::Table(size) => Some(table(gpu, size)),
        });
        let views: Vec<_> = views.collect();
        let resources = [&maps, &tables]
            .map(wgpu::BindingResource::Sampler)
            .into_iter()
            .chain(views.iter().map(wgpu::BindingResource::TextureView));
        let has_tables = textures
            .into_iter()
            .any(|texture| matches!(texture, Texture::Table(_)));
        for (binding, resource) in (1..).zip(resources) {
            // Bindings that the shader does not use are not in its layout.
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
fn of_the_air(is_sunlit: bool, has_clouds: bool, has_moon: bool) -> Vec<Sampled> {
    // Cosines of zenith angles as coordinates; the Moon's is another than the Sun's.
    let (sun, moon) = ("0.5 + 0.5 * mu_s", "0.5 - 0.4 * mu_s");
    let sampled = |size, of: &dyn Fn(&str) -> Vec<String>| Sampled {
        texture: Texture::Table(size),
        always: of(sun),
        by_night: if has_moon { of(moon) } else { Vec::new() },
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
        let rows = if has_clouds { 4 } else { 2 };
        all.push(sampled(air::SUNLIGHT_AND_CLOUDS, &|cosine| {
            let rows = 0..rows;
            rows.map(|row| format!("vec2f({cosine}, {row}.5 / 4.0)"))
                .collect()
        }));
    }
    all.push(once(albedo, "uv"));
    all.push(once(air::THROUGH_AND_CLOUDS, "vec2f(mu, 0.5)"));
    all.push(sampled(air::BOUNCE_AND_CLOUDS, &|cosine| {
        vec![format!("vec2f(mu, {cosine})")]
    }));
    all.push(sampled(air::SCATTERING_AND_CLOUDS, &|cosine| {
        vec![format!("vec3f(mu, {cosine}, 0.5 * mu)")]
    }));
    all
}

fn table(gpu: &GpuContext, size: air::TableSize) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("terrella floor table"),
        size: wgpu::Extent3d {
            width: size.x,
            height: size.y,
            depth_or_array_layers: size.z,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: match size.z {
            1 => wgpu::TextureDimension::D2,
            _ => wgpu::TextureDimension::D3,
        },
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backends::compile_for_every_backend;
    use terrella_imagery::{EarthLayers, LayerImage};

    #[test]
    fn every_backend_takes_the_shader_of_every_choice_of_textures() {
        let rgba = LayerImage::from_rgba8(2, 1, vec![0; 8]).unwrap();
        let gray = LayerImage::from_r8(2, 1, vec![0; 2]).unwrap();
        let slopes = LayerImage::from_slopes(2, 1, vec![0; 4]).unwrap();
        for bits in 0..128_u32 {
            let on = |bit: u32| bits >> bit & 1 == 1;
            let mut options = EarthOptions::new(EarthLayers {
                day: rgba.clone(),
                clouds: on(0).then(|| gray.clone()),
                normals: on(1).then(|| slopes.clone()),
                night_lights: on(2).then(|| gray.clone()),
                water: on(2).then(|| gray.clone()),
            });
            options.light.cloud_shadows = on(3);
            options.light.moonlight = on(4);
            options.shading = [Shading::Sunlit, Shading::Paper][on(5) as usize];
            options.atmosphere = [Atmosphere::None, Atmosphere::default()][on(6) as usize];
            compile_for_every_backend(&Samples::of(&options).shader());
        }
    }
}
