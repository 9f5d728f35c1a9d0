//! The air's tables on the GPU, with what else its shaders read, shared by all that draw through it.

use crate::gpu::{GpuLayer, VIEW_ANGLES, VIEW_AZIMUTHS};
use crate::plan::{AirSide, AirUniforms};
use glam::{Vec3, Vec4};
use std::sync::Arc;
use terrella_ground::air::{self, AirModel, AirTables, TableSize};
use terrella_imagery::NEIGHBOURHOODS;

/// A binding of group 0: what its layout has, and what is bound.
pub(crate) type Binding<'a> = (wgpu::BindGroupLayoutEntry, wgpu::BindGroupEntry<'a>);

/// Targets of what an eye in the air sees of it.
pub(super) const VIEW_TARGETS: usize = 3;

/// The air on the GPU as one view draws through it. A clone is the same.
#[derive(Clone)]
pub(crate) struct AirTextures {
    tables: Arc<Tables>,
    eye: Arc<Eye>,
}

/// What all views share.
struct Tables {
    model: AirModel,
    sky_albedo: Vec3,
    sampler: wgpu::Sampler,
    albedo: GpuLayer,
    sunlight: GpuLayer,
    /// Scattering, bounce and through.
    outside: [GpuLayer; VIEW_TARGETS],
    /// What is drawn from for an eye in the air: transmittance, sources and profile.
    march: [GpuLayer; 3],
    /// Whether that is drawn under the Moon too.
    moonlight: bool,
}

/// What depends on where a view's eye is.
struct Eye {
    uniforms: wgpu::Buffer,
    /// What is drawn in place of [`Tables::outside`] for an eye in the air.
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
    /// Uploads the tables of an air, over ground of this albedo, with clouds at this height; for views under the Moon too if
    /// `moonlight`.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        model: AirModel,
        tables: &AirTables,
        albedo: &[Vec4],
        cloud_height_m: f64,
        moonlight: bool,
    ) -> Self {
        let sunlight = tables.sunlight_with_clouds(cloud_height_m);
        let upload = |label, size, texels: &[Vec4]| {
            GpuLayer::upload_table(device, queue, label, size, texels)
        };
        let tables = Tables {
            model,
            sky_albedo: tables.sky_albedo,
            sampler: table_sampler(device),
            albedo: upload("terrella albedo", ALBEDO, albedo),
            sunlight: upload("terrella sunlight", air::SUNLIGHT_AND_CLOUDS, &sunlight),
            outside: [
                upload("terrella scattering", air::SCATTERING, &tables.scattering),
                upload("terrella bounce", air::BOUNCE, &tables.bounce),
                upload("terrella through", air::THROUGH, &tables.through),
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

    pub fn bytes(&self) -> u64 {
        let held = &*self.tables;
        let tables = [&held.albedo, &held.sunlight].into_iter();
        let tables = tables.chain(&held.outside).chain(&self.eye.view);
        tables.chain(&held.march).map(|layer| layer.bytes).sum()
    }

    /// Has the air stand over ground of another albedo.
    pub fn set_albedo(&self, queue: &wgpu::Queue, albedo: &[Vec4]) {
        self.tables.albedo.write_table(queue, albedo);
    }

    /// The buffer of [`AirUniforms`].
    pub fn uniforms(&self) -> &wgpu::Buffer {
        &self.eye.uniforms
    }

    /// What is drawn of an eye's view.
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
        // Of rays from outside the light scattered depends on the Sun's azimuth too.
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

    /// What the ground binds besides, for the light that falls on it.
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
    /// Whether they are the same air for the same view, not ones like them.
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

/// Size of the map of neighbourhoods, a column more on either side.
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
