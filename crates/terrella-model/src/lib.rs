//! Models of spacecraft: glTF 2.0 files (`.glb`, and `.gltf` with its data inside or beside it) as triangles, materials and pictures.
//!
//! | file | what |
//! |---|---|
//! | `json` | the objects of a glTF document |
//! | `container` | GLB chunks, data URIs, files beside the model |
//! | `accessor` | numbers in buffers |
//! | `nodes` | the node hierarchy |
//! | `error` | what is wrong with a file, with its JSON pointer |
//!
//! The reader is our own: limits before allocation, files opened in one way, normals and flattening would be ours with the crate
//! `gltf` too, which brings five crates.
//!
//! Source: Khronos, glTF 2.0 Specification (ISO/IEC 12113:2022).

mod accessor;
mod base64;
mod container;
mod error;
mod json;
mod nodes;

pub use container::model_files;
pub use error::{ModelError, ModelFault};

/// Most bytes of a model's file, and of all its buffers together.
pub const MAX_BYTES: u64 = 256 << 20;
/// Most vertices of a model after its nodes are flattened.
pub const MAX_VERTICES: u64 = 4_000_000;
/// Most indices of a model after its nodes are flattened.
pub const MAX_INDICES: u64 = 12_000_000;
/// Deepest node below the root of its scene.
pub const MAX_DEPTH: usize = 128;
/// Most texels along a side of a picture.
pub const MAX_SIDE: u32 = 8192;
/// Most texels of all pictures of a model.
pub const MAX_TEXELS: u64 = 1 << 26;
