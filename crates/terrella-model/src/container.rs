//! A file with all that it names: the chunks of a GLB, data URIs, files beside it.

use super::error::{ModelError, ModelFault};
use super::json::Document;
use super::{MAX_BYTES, base64};
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};
use terrella_files as files;
use terrella_files::{cause, printable};

const GLB_MAGIC: &[u8] = b"glTF";
const JSON_CHUNK: u32 = u32::from_le_bytes(*b"JSON");
const BINARY_CHUNK: u32 = u32::from_le_bytes(*b"BIN\0");
/// Limit of values in a document's text, by the marks before each: bounds the parser's allocation.
const MAX_VALUES: usize = 2_000_000;

/// Extensions that are read, so that files may require them.
const READ_EXTENSIONS: [&str; 2] = ["KHR_mesh_quantization", "KHR_materials_emissive_strength"];

/// Extensions that files may require without effect on the model: lights, which the scene provides.
const HARMLESS_EXTENSIONS: [&str; 1] = ["KHR_lights_punctual"];

/// A document with its buffers.
pub struct Container {
    pub path: PathBuf,
    pub document: Document,
    /// In the order of the document.
    pub buffers: Vec<Vec<u8>>,
}

impl Container {
    pub fn open(path: &Path) -> Result<Self, ModelError> {
        Self::of_bytes(read(path, path, "")?, path)
    }

    pub fn of_bytes(bytes: Vec<u8>, path: &Path) -> Result<Self, ModelError> {
        let fail = |fault: ModelFault| fault.at(path, "");
        let (text, mut binary) = split(bytes).map_err(fail)?;
        let document = document(&text).map_err(fail)?;
        drop(text);
        check_version(&document).map_err(|fault| fault.at(path, "/asset/version"))?;
        check_extensions(&document)
            .map_err(|(at, fault)| fault.at(path, format!("/extensionsRequired/{at}")))?;
        let mut total = 0;
        let mut buffers = Vec::new();
        for (index, buffer) in document.buffers.iter().enumerate() {
            let pointer = format!("/buffers/{index}");
            let bytes = match &buffer.uri {
                Some(uri) => resource(path, uri, &pointer)?,
                // The first buffer without a name is the binary chunk.
                None if index == 0 => binary.take().unwrap_or_default(),
                None => return Err(ModelFault::Missing("uri").at(path, pointer)),
            };
            if buffer.byte_length > bytes.len() as u64 {
                let fault = ModelFault::Bounds {
                    what: "a buffer",
                    needed: buffer.byte_length,
                    had: bytes.len() as u64,
                };
                return Err(fault.at(path, pointer));
            }
            total += bytes.len() as u64;
            if total > MAX_BYTES {
                return Err(too_large(total).at(path, pointer));
            }
            buffers.push(bytes);
        }
        Ok(Self {
            path: path.to_owned(),
            document,
            buffers,
        })
    }

    /// The error of a fault of this file.
    pub fn error(&self, fault: ModelFault, pointer: impl Into<String>) -> ModelError {
        fault.at(&self.path, pointer)
    }

    /// The object that a reference names.
    pub fn object<'d, T>(
        &self,
        all: &'d [T],
        what: &'static str,
        index: u64,
        pointer: &str,
    ) -> Result<&'d T, ModelError> {
        let found = usize::try_from(index).ok().and_then(|index| all.get(index));
        found.ok_or_else(|| {
            let count = all.len();
            self.error(ModelFault::Reference { what, index, count }, pointer)
        })
    }

    /// Bytes of a buffer view from `offset` on.
    pub fn view(&self, index: u64, offset: u64, pointer: &str) -> Result<&[u8], ModelError> {
        let views = &self.document.buffer_views;
        let view = self.object(views, "buffer view", index, pointer)?;
        let pointer = format!("/bufferViews/{index}");
        let buffer = self.object(&self.buffers, "buffer", view.buffer, &pointer)?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let end = end.unwrap_or(u64::MAX);
        let begin = view.byte_offset.saturating_add(offset);
        let range = usize::try_from(begin).ok().zip(usize::try_from(end).ok());
        let bytes = range.and_then(|(begin, end)| buffer.get(begin..end));
        bytes.ok_or_else(|| {
            let fault = ModelFault::Bounds {
                what: "a buffer",
                needed: end.max(begin),
                had: buffer.len() as u64,
            };
            self.error(fault, pointer)
        })
    }

    /// The bytes of the resource at a URI.
    pub fn resource(&self, uri: &str, pointer: &str) -> Result<Vec<u8>, ModelError> {
        resource(&self.path, uri, pointer)
    }

    /// Names what the document has and no model gets.
    pub fn note_ignored(&self, ignored: &mut BTreeSet<String>) {
        let document = &self.document;
        let unread = document.extensions_used.iter();
        let unread = unread.filter(|name| !READ_EXTENSIONS.contains(&name.as_str()));
        ignored.extend(unread.map(|name| printable(name)));
        for (name, is_there) in [
            ("animations", !document.animations.is_empty()),
            ("skins", !document.skins.is_empty()),
            ("cameras", !document.cameras.is_empty()),
        ] {
            if is_there {
                ignored.insert(name.to_owned());
            }
        }
    }
}

/// A model's file and the files that it refers to, so that a change of any of them is detected. A file that cannot be read refers to none.
pub fn model_files(path: &Path) -> Vec<PathBuf> {
    let mut all = vec![path.to_owned()];
    let document = files::read(path, MAX_BYTES).ok().flatten();
    let document = document.and_then(|bytes| split(bytes).ok());
    let Some(document) = document.and_then(|(text, _)| document_of(&text)) else {
        return all;
    };
    let buffers = document.buffers.iter().map(|buffer| &buffer.uri);
    let uris = buffers.chain(document.images.iter().map(|image| &image.uri));
    let beside = uris.flatten().filter(|uri| !uri.starts_with("data:"));
    all.extend(beside.filter_map(|uri| beside_model(path, uri)));
    all
}

fn document_of(text: &[u8]) -> Option<Document> {
    document(text).ok()
}

fn too_large(count: u64) -> ModelFault {
    ModelFault::TooMany {
        what: "bytes",
        count,
        limit: MAX_BYTES,
    }
}

/// All bytes of a file that belongs to a model.
fn read(file: &Path, model: &Path, pointer: &str) -> Result<Vec<u8>, ModelError> {
    let fail = |cause: String| {
        let file = file.to_owned();
        ModelFault::Read { file, cause }.at(model, pointer)
    };
    let bytes = files::read(file, MAX_BYTES).map_err(|error| fail(cause(error)))?;
    bytes.ok_or_else(|| {
        fail(format!(
            "larger than {} MiB; simplify the model",
            MAX_BYTES >> 20
        ))
    })
}

/// The JSON of a file, and its binary chunk if it is a GLB (specification, section 4.4).
fn split(bytes: Vec<u8>) -> Result<(Vec<u8>, Option<Vec<u8>>), ModelFault> {
    if !bytes.starts_with(GLB_MAGIC) {
        return Ok((bytes, None));
    }
    let number = |at: usize| {
        let four = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(four.try_into().ok()?))
    };
    let cut = |needed: u64| ModelFault::Bounds {
        what: "the file",
        needed,
        had: bytes.len() as u64,
    };
    let version = number(4).ok_or_else(|| cut(12))?;
    if version != 2 {
        return Err(ModelFault::Version(version.to_string()));
    }
    let length = number(8).ok_or_else(|| cut(12))?;
    if u64::from(length) > bytes.len() as u64 {
        return Err(cut(length.into()));
    }
    let (mut text, mut binary) = (None, None);
    let mut at = 12_usize;
    while at < length as usize {
        let (size, kind) = number(at)
            .zip(number(at + 4))
            .ok_or_else(|| cut(at as u64 + 8))?;
        let begin = at + 8;
        let end = begin as u64 + u64::from(size);
        let chunk = usize::try_from(end)
            .ok()
            .and_then(|end| bytes.get(begin..end));
        let chunk = chunk.ok_or_else(|| cut(end))?;
        match kind {
            JSON_CHUNK if text.is_none() => text = Some(chunk.to_vec()),
            BINARY_CHUNK if binary.is_none() => binary = Some(chunk.to_vec()),
            // Other chunks are for extensions.
            _ => {}
        }
        at = begin + size as usize;
    }
    let text = text.ok_or(ModelFault::Missing("JSON chunk"))?;
    Ok((text, binary))
}

fn document(text: &[u8]) -> Result<Document, ModelFault> {
    let marks = text.iter().filter(|c| matches!(c, b'{' | b'[' | b','));
    let count = marks.count();
    if count > MAX_VALUES {
        return Err(ModelFault::TooMany {
            what: "values in the JSON",
            count: count as u64,
            limit: MAX_VALUES as u64,
        });
    }
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    serde_json::from_slice(text).map_err(|error| ModelFault::NotGltf(cause(error)))
}

fn check_version(document: &Document) -> Result<(), ModelFault> {
    match document.asset.version.split('.').next() {
        Some("2") => Ok(()),
        _ => Err(ModelFault::Version(printable(&document.asset.version))),
    }
}

fn check_extensions(document: &Document) -> Result<(), (usize, ModelFault)> {
    let required = document.extensions_required.iter().enumerate();
    let mut unread = required.filter(|(_, name)| {
        let name = name.as_str();
        !READ_EXTENSIONS.contains(&name) && !HARMLESS_EXTENSIONS.contains(&name)
    });
    let Some((at, name)) = unread.next() else {
        return Ok(());
    };
    let remedy = match name.as_str() {
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
            "export the model without compression of its meshes"
        }
        "KHR_texture_basisu" | "EXT_texture_webp" | "EXT_texture_avif" => {
            "export its textures as PNG or JPEG"
        }
        "KHR_texture_transform" => "bake the transforms into the texture coordinates",
        _ => "export the model without it",
    };
    let name = printable(name);
    Err((at, ModelFault::Extension { name, remedy }))
}

/// The bytes of a data URI, or of a file beside the model.
fn resource(model: &Path, uri: &str, pointer: &str) -> Result<Vec<u8>, ModelError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let bytes = data
            .split_once(',')
            .filter(|(kind, _)| kind.ends_with(";base64"))
            .and_then(|(_, text)| base64::decoded(text));
        let fault = || ModelFault::Value {
            key: "uri",
            text: "a data URI".to_owned(),
            expected: "base64 behind \"data:…;base64,\"",
        };
        return bytes.ok_or_else(|| fault().at(model, pointer));
    }
    let outside = || {
        let uri = printable(uri);
        ModelFault::Outside { uri }.at(model, pointer)
    };
    let file = beside_model(model, uri).ok_or_else(outside)?;
    // A link may lead out of the folder.
    let folder = model
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let real = |path: &Path| path.canonicalize().ok();
    if let (Some(folder), Some(file)) = (real(folder.unwrap_or(Path::new("."))), real(&file))
        && !file.starts_with(folder)
    {
        return Err(outside());
    }
    read(&file, model, pointer)
}

/// The file that a relative URI names below the model's folder; `None` for all else.
fn beside_model(model: &Path, uri: &str) -> Option<PathBuf> {
    let name = percent_decoded(uri)?;
    if name.contains([':', '\\', '\0']) || files::path_complaint(Path::new(&name)).is_some() {
        return None;
    }
    let relative = Path::new(&name);
    let mut parts = relative.components();
    let is_below = parts.all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    let folder = model.parent().unwrap_or(Path::new(""));
    (is_below && !name.is_empty()).then(|| folder.join(relative))
}

/// RFC 3986, section 2.1.
fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        if *first != b'%' {
            bytes.push(*first);
            rest = tail;
            continue;
        }
        let digits = std::str::from_utf8(tail.get(..2)?).ok()?;
        bytes.push(u8::from_str_radix(digits, 16).ok()?);
        rest = tail.get(2..)?;
    }
    String::from_utf8(bytes).ok()
}
