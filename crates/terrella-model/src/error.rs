//! Errors of a file: place, error and remedy.

use std::fmt;
use std::path::{Path, PathBuf};

/// A model that cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {fault}", path.display(), At(pointer))]
pub struct ModelError {
    /// The file.
    pub path: PathBuf,
    /// JSON pointer (RFC 6901) to the object that is wrong; empty where it is the whole file.
    pub pointer: String,
    /// The error, and the remedy.
    pub fault: Box<ModelFault>,
}

/// ` at /pointer`, or nothing.
struct At<'p>(&'p str);

impl fmt::Display for At<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            "" => Ok(()),
            pointer => write!(f, " at {pointer}"),
        }
    }
}

/// Errors of a model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum ModelFault {
    /// A file that the system does not give.
    #[error("{}: {cause}", file.display())]
    Read { file: PathBuf, cause: String },
    /// More than a model may have.
    #[error("{count} {what}; a model has at most {limit}: simplify it")]
    TooMany {
        what: &'static str,
        count: u64,
        limit: u64,
    },
    /// Neither GLB nor JSON.
    #[error("no glTF: {0}; export it as glTF 2.0 (.glb or .gltf)")]
    NotGltf(String),
    /// Another version of the format.
    #[error("glTF version {0:?}; version 2.0 is read: export it again")]
    Version(String),
    /// An extension that the file cannot be read without.
    #[error("the file requires the extension {name}, which is not read; {remedy}")]
    Extension { name: String, remedy: &'static str },
    /// Something that must be there is not.
    #[error("has no {0}; export the model again")]
    Missing(&'static str),
    /// A reference to an object that the file does not have.
    #[error("refers to {what} {index}, and the file has {count}; export the model again")]
    Reference {
        what: &'static str,
        index: u64,
        count: usize,
    },
    /// An index that names no vertex.
    #[error(
        "index {index} at position {at}, and there are {count} vertices; export the model again"
    )]
    Index { at: usize, index: u32, count: usize },
    /// Bytes beyond the end of their container.
    #[error("needs {needed} bytes of {what}, which has {had}; the file is cut off or corrupt")]
    Bounds {
        what: &'static str,
        needed: u64,
        had: u64,
    },
    /// A value that the format does not allow.
    #[error("{key} is {text}; expected {expected}")]
    Value {
        key: &'static str,
        text: String,
        expected: &'static str,
    },
    /// A node that is reached twice.
    #[error(
        "node {0} is reached twice: nodes form a cycle or share a child; give each node one parent"
    )]
    Cycle(u64),
    /// No node of the name of one that is to be turned.
    #[error("has no node {wanted:?} in what it shows; its nodes are {nodes}")]
    NoNode { wanted: String, nodes: String },
    /// Several nodes of the name of one that is to be turned.
    #[error("has two nodes {0:?}, here the second; give nodes that are turned names of their own")]
    TwoNodes(String),
    /// A number that is none, or none that can be drawn.
    #[error("{what} {at} is not finite; export the model again")]
    NotFinite { what: &'static str, at: usize },
    /// A file outside of the model's folder.
    #[error(
        "{uri:?} leads out of the model's folder; put the file beside the model and export it with relative names"
    )]
    Outside { uri: String },
    /// An invalid image.
    #[error("the picture: {0}; PNG and JPEG are read")]
    Image(String),
    /// No triangle.
    #[error("has no triangles to draw; export meshes, not only points, lines or cameras")]
    Empty,
}

impl ModelFault {
    /// The error of this fault in a file.
    pub(crate) fn at(self, path: &Path, pointer: impl Into<String>) -> ModelError {
        ModelError {
            path: path.to_owned(),
            pointer: pointer.into(),
            fault: Box::new(self),
        }
    }
}
