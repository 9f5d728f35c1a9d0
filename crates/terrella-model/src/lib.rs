//! Models of spacecraft: glTF 2.0 files (`.glb`, and `.gltf` with its data inside or beside it) as triangles, materials and textures.
//!
//! [`Model::load`] reads a whole file and flattens its node hierarchy: all vertices are in the model's axes, metres. It reads the properties needed
//! for a spacecraft in sunlight: positions, normals, texture coordinates, metallic-roughness materials. Everything else is listed in
//! [`Model::ignored`]; a file that requires an unsupported extension is rejected.
//!
//! | file | content |
//! |---|---|
//! | `json` | the objects of a glTF document |
//! | `container` | GLB chunks, data URIs, files beside the model |
//! | `accessor` | numbers in buffers |
//! | `nodes` | the node hierarchy |
//! | `mesh` | triangles and normals |
//! | `materials` | materials, textures, pictures |
//! | `error` | errors of a file, with their JSON pointer |
//!
//! The reader is our own: limits before allocation, a single way to open files, normals and flattening would also be ours with the crate `gltf`,
//! which adds five crates.
//!
//! Source: Khronos, glTF 2.0 Specification (ISO/IEC 12113:2022).

mod accessor;
mod base64;
mod container;
mod error;
mod json;
mod materials;
mod mesh;
mod nodes;

pub use container::model_files;
pub use error::{ModelError, ModelFault};
pub use materials::{AlphaMode, Material, ModelImage, TextureUse, Wrap};

use container::Container;
use glam::{DMat4, Vec2, Vec3, Vec4};
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

/// Size limit of a model's file, and of all its buffers together, bytes.
pub const MAX_BYTES: u64 = 256 << 20;
/// Most vertices of a model after its nodes are flattened.
pub const MAX_VERTICES: u64 = 4_000_000;
/// Most indices of a model after its nodes are flattened.
pub const MAX_INDICES: u64 = 12_000_000;
/// Deepest node below the root of its scene.
pub const MAX_DEPTH: usize = 128;
/// Most texels along a side of a picture.
pub const MAX_SIDE: u32 = 8192;
/// Limit of texels of all textures of a model.
pub const MAX_TEXELS: u64 = 1 << 26;

/// A vertex, in the axes of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Metres.
    pub position_m: Vec3,
    /// Unit, outwards.
    pub normal: Vec3,
    /// Texture coordinates, (0, 0) at the upper left of a picture.
    pub uv: Vec2,
    /// Unit vector to where the first texture coordinate grows, and 1 or −1: the other one grows along normal × tangent times that. All 0
    /// where the file gives none.
    pub tangent: Vec4,
}

/// Triangles of one material that move together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Its place in [`Model::materials`].
    pub material: usize,
    /// The joint that it turns with, by its place in [`Model::joints`]; `None` stands still in the model.
    pub joint: Option<usize>,
    /// Its range of [`Model::indices`].
    pub indices: Range<u32>,
}

/// A node that can be turned with its child nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Of the node.
    pub name: String,
    /// The parent joint, as an index into [`Model::joints`].
    pub parent: Option<usize>,
    /// Takes the axes of the node, as the file places it, to those of the model.
    pub model_from_node: DMat4,
}

/// A model as it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// All vertices.
    pub vertices: Vec<Vertex>,
    /// Three for each triangle, counter-clockwise as seen from outside.
    pub indices: Vec<u32>,
    /// The triangles by their materials.
    pub parts: Vec<Part>,
    /// The nodes that were asked for by name.
    pub joints: Vec<Joint>,
    /// The materials that parts name.
    pub materials: Vec<Material>,
    /// The pictures that materials name.
    pub images: Vec<ModelImage>,
    /// Lower and upper corner of the box around all vertices, metres.
    pub bounds_m: [Vec3; 2],
    /// Features of the file that the model lacks, each once, by the names of glTF.
    pub ignored: BTreeSet<String>,
}

impl Model {
    /// Reads a file with all that it names.
    ///
    /// # Errors
    /// A file that is no glTF 2.0, leaves its own bounds, the limits of this crate or its folder, or needs an extension that is
    /// not read. Names the file and the JSON pointer.
    pub fn load(path: &Path) -> Result<Self, ModelError> {
        Self::load_jointed(path, &[])
    }

    /// The same with joints: the nodes of these names, which differ, in their order.
    ///
    /// # Errors
    /// As [`Self::load`], and a name that no node has, or more than one.
    pub fn load_jointed(path: &Path, joints: &[&str]) -> Result<Self, ModelError> {
        Self::of_container(&Container::open(path)?, joints)
    }

    /// Reads the bytes of a file; what it names is looked for beside `path`.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn of_bytes(bytes: Vec<u8>, path: &Path) -> Result<Self, ModelError> {
        Self::of_container(&Container::of_bytes(bytes, path)?, &[])
    }

    fn of_container(container: &Container, joints: &[&str]) -> Result<Self, ModelError> {
        let mut ignored = BTreeSet::new();
        container.note_ignored(&mut ignored);
        let placed = nodes::placed_meshes(container, joints)?;
        let drawn = mesh::triangles(container, &placed.meshes, &mut ignored)?;
        let looks = materials::read(container, &drawn.materials, &mut ignored)?;
        Ok(Self {
            bounds_m: mesh::bounds_m(&drawn.vertices),
            vertices: drawn.vertices,
            indices: drawn.indices,
            parts: drawn.parts,
            joints: placed.joints,
            materials: looks.materials,
            images: looks.images,
            ignored,
        })
    }

    /// Longest side of the box around it, metres.
    pub fn length_m(&self) -> f32 {
        let [low, high] = self.bounds_m;
        (high - low).max_element()
    }

    /// Radius about the origin of the model that holds all of it, metres.
    pub fn radius_m(&self) -> f32 {
        let [low, high] = self.bounds_m;
        low.abs().max(high.abs()).length()
    }
}

#[cfg(test)]
mod tests;
