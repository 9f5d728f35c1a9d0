//! Uniforms of the model shader: the structs of shaders/craft_model.wgsl.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec2, Vec3, Vec4};
use terrella_model::{AlphaMode, Material, Vertex};

/// `ModelFrame` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct ModelFrame {
    pub clip_from_model: Mat4,
    pub sun: Vec3,
    pub sunlight: f32,
    pub moon: Vec3,
    pub moonlight: f32,
    pub eye: Vec3,
    pub exposure: f32,
    pub down: Vec3,
    pub limb_sine: f32,
    pub earth_light: Vec3,
    pub padding: f32,
}

/// `ModelMaterial` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ModelMaterial {
    pub base_color: Vec4,
    pub emissive: Vec3,
    pub metallic: f32,
    pub roughness: f32,
    pub alpha_cutoff: f32,
    pub normal_scale: f32,
    pub padding: f32,
}

impl From<&Material> for ModelMaterial {
    fn from(material: &Material) -> Self {
        Self {
            base_color: material.base_color,
            emissive: material.emissive,
            metallic: material.metallic,
            roughness: material.roughness,
            alpha_cutoff: match material.alpha {
                AlphaMode::Mask(cutoff) => cutoff,
                AlphaMode::Opaque | AlphaMode::Blend => f32::MIN,
            },
            normal_scale: material.normal_scale,
            padding: 0.0,
        }
    }
}

/// `ModelVertex` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ModelVertex {
    pub position_m: Vec3,
    pub normal: Vec3,
    pub uv: Vec2,
    pub tangent: Vec4,
}

/// Layout of [`ModelVertex`].
pub const ATTRIBUTES: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Float32x4];

impl From<&Vertex> for ModelVertex {
    fn from(vertex: &Vertex) -> Self {
        Self {
            position_m: vertex.position_m,
            normal: vertex.normal,
            uv: vertex.uv,
            tangent: vertex.tangent,
        }
    }
}
