//! The air's tables on the GPU and the other inputs of its shaders, shared by everything that draws through it.

use crate::gpu::{GpuLayer, VIEW_ANGLES, VIEW_AZIMUTHS};
use crate::plan::{AirSide, AirUniforms};
use glam::{Vec3, Vec4};
use std::sync::Arc;
use terrella_ground::air::{self, AirAboveClouds, AirModel, AirTables, TableSize};
use terrella_imagery::NEIGHBOURHOODS;

/// A binding of group 0: its layout entry and its resource.
pub(crate) type Binding<'a> = (wgpu::BindGroupLayoutEntry, wgpu::BindGroupEntry<'a>);

/// Number of targets of the sky view for an eye in the air.
pub(super) const VIEW_TARGETS: usize = 3;

/// The air on the GPU as one view draws through it. Clones share it.
#[derive(Clone)]
pub(crate) struct AirTextures {
    tables: Arc<Tables>,
    eye: Arc<Eye>,
}

/// The part that all views share.
struct Tables {
    model: AirModel,
    sky_albedo: Vec3,
    clouds: Option<AboveClouds>,
    sampler: wgpu::Sampler,
    albedo: GpuLayer,
    sunlight: GpuLayer,
    /// Scattering, bounce and through.
    outside: [GpuLayer; VIEW_TARGETS],
    /// Inputs of the sky view for an eye in the air: transmittance, sources and profile.
    march: [GpuLayer; 3],
    /// Whether the sky view includes moonlight.
    moonlight: bool,
}

/// The air above clouds, apart from its tables.
#[derive(Clone, Copy)]
pub(crate) struct AboveClouds {
    pub height_m: f64,
    /// See [`AirAboveClouds::sky_albedo`].
    pub sky_albedo: Vec3,
}

/// The part that depends on the eye's position.
struct Eye {
    uniforms: wgpu::Buffer,
    /// Textures that replace [`Tables::outside`] for an eye in the air.
    view: [GpuLayer; VIEW_TARGETS],
}

impl Eye {
    fn new(device: &wgpu::Device, moonlight: bool) -> Self {
        let lights = if moonlight { 2 } else { 1 };
        let view = ["black", "bounce", "through"].map(|name| {
            let label = format!("terrella view of the air, {name}");
            GpuLayer::target(device, &label, wgpu::TextureFormat::Rgba16Float, {
                (VIEW_ANGLES, lights * VIEW_AZIMUTHS)
            })
        });
        Self {
            uniforms: crate::gpu::uniform_buffer::<AirUniforms>(device, "terrella air"),
            view,
        }
    }
}

impl AirTextures {
    /// Uploads the tables of an air over ground of this albedo, and those of the air above clouds at a height, metres, if there are clouds. With
    /// `moonlight` for views under the Moon too.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        model: AirModel,
        tables: &AirTables,
        albedo: &[Vec4],
        clouds: Option<(&AirAboveClouds, f64)>,
        moonlight: bool,
    ) -> Self {
        let mut sunlight = tables.sunlight.clone();
        if let Some((above, height_m)) = clouds {
            sunlight.extend(tables.sunlight_on_clouds(height_m));
            sunlight.extend(above.sky());
        }
        sunlight.resize(air::SUNLIGHT_AND_CLOUDS.texels(), Vec4::ZERO);
        let above = clouds.map(|(above, _)| above);
        let of_ground = [&tables.scattering, &tables.bounce, &tables.through];
        let of_clouds = above.map(|above| [&above.scattering, &above.bounce, &above.through]);
        let [scattering, bounce, through]: [Vec<Vec4>; 3] =
            std::array::from_fn(|n| beside(of_ground[n], of_clouds.map(|tables| &tables[n][..])));
        let upload = |label, size, texels: &[Vec4]| {
            GpuLayer::upload_table(device, queue, label, size, texels)
        };
        let tables = Tables {
            model,
            sky_albedo: tables.sky_albedo,
            clouds: clouds.map(|(above, height_m)| AboveClouds {
                height_m,
                sky_albedo: above.sky_albedo,
            }),
            sampler: table_sampler(device),
            albedo: upload("terrella albedo", ALBEDO, albedo),
            sunlight: upload("terrella sunlight", air::SUNLIGHT_AND_CLOUDS, &sunlight),
            outside: [
                upload(
                    "terrella scattering",
                    air::SCATTERING_AND_CLOUDS,
                    &scattering,
                ),
                upload("terrella bounce", air::BOUNCE_AND_CLOUDS, &bounce),
                upload("terrella through", air::THROUGH_AND_CLOUDS, &through),
            ],
            march: [
                upload(
                    "terrella transmittance",
                    air::TRANSMITTANCE,
                    &tables.transmittance,
                ),
                upload("terrella sources", air::SOURCES, &tables.sources),
                upload("terrella profile", air::PROFILE, &tables.profile),
            ],
            moonlight,
        };
        Self {
            tables: Arc::new(tables),
            eye: Arc::new(Eye::new(device, moonlight)),
        }
    }

    /// The same air for another view.
    pub fn for_another_view(&self, device: &wgpu::Device) -> Self {
        Self {
            tables: self.tables.clone(),
            eye: Arc::new(Eye::new(device, self.tables.moonlight)),
        }
    }

    pub fn model(&self) -> &AirModel {
        &self.tables.model
    }

    /// See [`AirTables::sky_albedo`].
    pub fn sky_albedo(&self) -> Vec3 {
        self.tables.sky_albedo
    }

    /// `None` without clouds.
    pub fn above_clouds(&self) -> Option<AboveClouds> {
        self.tables.clouds
    }

    pub fn bytes(&self) -> u64 {
        let held = &*self.tables;
        let tables = [&held.albedo, &held.sunlight].into_iter();
        let tables = tables.chain(&held.outside).chain(&self.eye.view);
        tables.chain(&held.march).map(|layer| layer.bytes).sum()
    }

    /// Places the air over ground of another albedo.
    pub fn set_albedo(&self, queue: &wgpu::Queue, albedo: &[Vec4]) {
        self.tables.albedo.write_table(queue, albedo);
    }

    /// The buffer of [`AirUniforms`].
    pub fn uniforms(&self) -> &wgpu::Buffer {
        &self.eye.uniforms
    }

    /// Targets of the sky view.
    pub(super) fn view_targets(&self) -> &[GpuLayer; VIEW_TARGETS] {
        &self.eye.view
    }

    /// What `common/air.wgsl` binds.
    pub fn bindings(&self, side: AirSide) -> Vec<Binding<'_>> {
        let held = &*self.tables;
        let (d2, d3) = (
            wgpu::TextureViewDimension::D2,
            wgpu::TextureViewDimension::D3,
        );
        // For rays from outside, scattered light also depends on the Sun's azimuth.
        let (tables, dimension) = match side {
            AirSide::Outside => (&held.outside, d3),
            AirSide::Inside => (&self.eye.view, d2),
        };
        let [scattered, bounce, through] = tables;
        let mut bindings = self.common_bindings();
        bindings.extend([
            texture(7, d2, &held.albedo),
            texture(8, dimension, scattered),
            texture(9, d2, bounce),
            texture(10, d2, through),
        ]);
        bindings
    }

    /// Binding for ground shaders: the light that falls on the ground.
    pub fn sunlight_binding(&self) -> Binding<'_> {
        texture(11, wgpu::TextureViewDimension::D2, &self.tables.sunlight)
    }

    /// What `air_view.wgsl` binds.
    pub(super) fn march_bindings(&self) -> Vec<Binding<'_>> {
        let mut bindings = self.common_bindings();
        let tables = (3..).zip(&self.tables.march);
        let d2 = wgpu::TextureViewDimension::D2;
        bindings.extend(tables.map(|(binding, table)| texture(binding, d2, table)));
        bindings
    }

    fn common_bindings(&self) -> Vec<Binding<'_>> {
        let stage = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let uniforms = wgpu::BindGroupEntry {
            binding: 1,
            resource: self.eye.uniforms.as_entire_binding(),
        };
        let sampler = wgpu::BindGroupEntry {
            binding: 2,
            resource: wgpu::BindingResource::Sampler(&self.tables.sampler),
        };
        vec![
            (
                crate::gpu::uniform_entry(1, stage, size_of::<AirUniforms>()),
                uniforms,
            ),
            (crate::gpu::sampler_entry(2), sampler),
        ]
    }
}

impl PartialEq for AirTextures {
    /// Whether both are the same air for the same view, by identity.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.tables, &other.tables) && Arc::ptr_eq(&self.eye, &other.eye)
    }
}

impl std::fmt::Debug for AirTextures {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("AirTextures")
            .field(&self.tables.model)
            .finish()
    }
}

/// Joins each row of rays that meet or pass the ground with the row of rays that meet clouds, which is zero without clouds.
fn beside(of_ground: &[Vec4], of_clouds: Option<&[Vec4]>) -> Vec<Vec4> {
    const RAYS: usize = air::RAYS as usize;
    let rows = of_ground.chunks_exact(2 * RAYS).enumerate();
    rows.flat_map(|(n, row)| {
        let above = of_clouds.map_or(&[Vec4::ZERO; RAYS][..], |all| &all[n * RAYS..][..RAYS]);
        row.iter().chain(above).chain(&[Vec4::ZERO; RAYS]).copied()
    })
    .collect()
}

/// Size of the map of neighbourhoods, with one more column on either side.
const ALBEDO: TableSize = TableSize {
    x: NEIGHBOURHOODS + 2,
    y: NEIGHBOURHOODS / 2,
    z: 1,
};

fn texture(binding: u32, dimension: wgpu::TextureViewDimension, layer: &GpuLayer) -> Binding<'_> {
    let entry = wgpu::BindGroupEntry {
        binding,
        resource: wgpu::BindingResource::TextureView(&layer.view),
    };
    (crate::gpu::texture_entry(binding, dimension), entry)
}

/// Linear, clamped: for tables that end on texel centres.
fn table_sampler(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("terrella tables"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}
