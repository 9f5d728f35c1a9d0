//! No machine of ours has Metal, Direct3D or WebGL: naga writes every legal variant for them as wgpu would.

use super::{Shader, all_shaders, hold};
use naga::back::{glsl, hlsl, msl, spv};
use naga::proc::BoundsCheckPolicies;
use terrella::internals::gpu::ShaderCapability;

/// A language that wgpu hands shaders over in.
#[derive(Clone, Copy, Debug)]
enum Backend {
    /// Vulkan.
    SpirV,
    /// Metal, by the oldest version that wgpu takes.
    Metal,
    /// Direct3D 12.
    Hlsl,
    /// WebGL 2.
    GlslEs300,
    /// OpenGL ES 3.1, the least that wgpu takes outside of browsers with storage buffers.
    GlslEs310,
}

const BACKENDS: [Backend; 5] = [
    Backend::SpirV,
    Backend::Metal,
    Backend::Hlsl,
    Backend::GlslEs300,
    Backend::GlslEs310,
];

impl Backend {
    /// What it cannot have, whatever the machine.
    fn lacks(self) -> &'static [ShaderCapability] {
        match self {
            Self::GlslEs300 => &[ShaderCapability::StorageBuffers],
            Self::SpirV | Self::Metal | Self::Hlsl | Self::GlslEs310 => &[],
        }
    }

    fn write(self, shader: &Shader) -> Result<(), String> {
        let (module, info) = (&shader.module, &shader.info);
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
            Self::GlslEs300 => glsl(shader, glsl::Version::new_gles(300)),
            Self::GlslEs310 => glsl(shader, glsl::Version::new_gles(310)),
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

fn glsl(shader: &Shader, version: glsl::Version) -> Result<(), String> {
    let options = glsl::Options {
        version,
        ..Default::default()
    };
    for entry in &shader.module.entry_points {
        let of_pipeline = glsl::PipelineOptions {
            shader_stage: entry.stage,
            entry_point: entry.name.clone(),
            multiview: None,
        };
        let mut text = String::new();
        glsl::Writer::new(
            &mut text,
            &shader.module,
            &shader.info,
            &options,
            &of_pipeline,
            BoundsCheckPolicies::default(),
        )
        .and_then(|mut writer| writer.write())
        .map_err(|error| format!("{}: {error}", entry.name))?;
    }
    Ok(())
}

#[test]
fn every_backend_takes_every_variant_that_it_can() {
    let shaders = all_shaders();
    let mut failures = Vec::new();
    for backend in BACKENDS {
        let (mut taken, mut refused) = (0, 0);
        for shader in shaders {
            let is_lacking = shader
                .needs
                .iter()
                .any(|need| backend.lacks().contains(need));
            match (backend.write(shader), is_lacking) {
                (Ok(()), false) => taken += 1,
                (Err(_), true) => refused += 1,
                (Ok(()), true) => failures.push(format!(
                    "{backend:?} takes {} without {:?}: that is no capability of it",
                    shader.name, shader.needs
                )),
                (Err(error), false) => {
                    failures.push(format!("{backend:?} refuses {}: {error}", shader.name));
                }
            }
        }
        println!("{backend:?}: {taken} variants; {refused} refused as expected");
    }
    hold(&failures);
}
