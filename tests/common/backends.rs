//! Compiles shaders by naga and writes them for every backend, as wgpu would: Metal, Direct3D and WebGL are not at hand where tests run.
#![allow(dead_code)] // Each crate's tests use their own part.

use naga::back::{glsl, hlsl, msl, spv};
use naga::proc::BoundsCheckPolicies;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, SourceLocation};

/// Compiles a shader; what is wrong with it, and where.
pub fn compiled(text: &str) -> Result<(Module, ModuleInfo), (Option<SourceLocation>, String)> {
    let module = naga::front::wgsl::parse_str(text)
        .map_err(|error| (error.location(text), error.emit_to_string(text)))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|error| (error.location(text), error.emit_to_string(text)))?;
    Ok((module, info))
}

/// Compiles a shader that every backend must take.
pub fn compile_for_every_backend(text: &str) -> Module {
    let (module, info) = compiled(text).unwrap_or_else(|(_, error)| panic!("{error}"));
    for backend in BACKENDS {
        if let Err(error) = backend.write(&module, &info) {
            panic!("{backend:?} rejects it: {error}\n{text}");
        }
    }
    module
}

/// A language that wgpu hands shaders over in.
#[derive(Clone, Copy, Debug)]
pub enum Backend {
    /// Vulkan.
    SpirV,
    /// Metal, by the oldest version that wgpu takes.
    Metal,
    /// Direct3D 12.
    Hlsl,
    /// WebGL 2.
    GlslEs300,
    /// OpenGL ES 3.1, wgpu's minimum outside browsers with storage buffers.
    GlslEs310,
}

pub const BACKENDS: [Backend; 5] = [
    Backend::SpirV,
    Backend::Metal,
    Backend::Hlsl,
    Backend::GlslEs300,
    Backend::GlslEs310,
];

impl Backend {
    /// Writes a module for it.
    pub fn write(self, module: &Module, info: &ModuleInfo) -> Result<(), String> {
        match self {
            Self::SpirV => spv::write_vec(module, info, &spv::Options::default(), None)
                .map(|words| assert!(!words.is_empty()))
                .map_err(|error| error.to_string()),
            Self::Metal => {
                let options = msl::Options {
                    lang_version: (2, 0),
                    ..Default::default()
                };
                let (_, entries) =
                    msl::write_string(module, info, &options, &msl::PipelineOptions::default())
                        .map_err(|error| error.to_string())?;
                all_entries(entries.entry_point_names)
            }
            Self::Hlsl => {
                let (options, of_pipeline) = (hlsl::Options::default(), Default::default());
                let mut text = String::new();
                let written = hlsl::Writer::new(&mut text, &options, &of_pipeline)
                    .write(module, info, None)
                    .map_err(|error| error.to_string())?;
                all_entries(written.entry_point_names)
            }
            Self::GlslEs300 => glsl(module, info, glsl::Version::new_gles(300)),
            Self::GlslEs310 => glsl(module, info, glsl::Version::new_gles(310)),
        }
    }
}

/// Each entry point has a name, or what went wrong in it.
fn all_entries<E: ToString>(names: Vec<Result<String, E>>) -> Result<(), String> {
    let names: Result<Vec<_>, E> = names.into_iter().collect();
    match names {
        Ok(names) if names.len() == 2 => Ok(()),
        Ok(names) => Err(format!("entry points {names:?}")),
        Err(error) => Err(error.to_string()),
    }
}

fn glsl(module: &Module, info: &ModuleInfo, version: glsl::Version) -> Result<(), String> {
    let options = glsl::Options {
        version,
        ..Default::default()
    };
    for entry in &module.entry_points {
        let of_pipeline = glsl::PipelineOptions {
            shader_stage: entry.stage,
            entry_point: entry.name.clone(),
            multiview: None,
        };
        let mut text = String::new();
        glsl::Writer::new(
            &mut text,
            module,
            info,
            &options,
            &of_pipeline,
            BoundsCheckPolicies::default(),
        )
        .and_then(|mut writer| writer.write())
        .map_err(|error| format!("{}: {error}", entry.name))?;
    }
    Ok(())
}
