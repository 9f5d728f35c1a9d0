//! Every backend takes every variant that it can.

use super::compile::{BACKENDS, Backend};
use super::{Shader, hold, sampled_shaders};
use terrella::internals::gpu::ShaderCapability;
use terrella_files::parallel;

/// Capabilities that a backend lacks on every machine.
fn lacks(backend: Backend) -> &'static [ShaderCapability] {
    match backend {
        Backend::GlslEs300 => &[ShaderCapability::StorageBuffers],
        Backend::SpirV | Backend::Metal | Backend::Hlsl | Backend::GlslEs310 => &[],
    }
}

#[test]
fn every_backend_takes_every_variant_that_it_can() {
    let shaders = sampled_shaders();
    let failures = parallel::map(shaders.len(), |n| failures_of(&shaders[n]));
    hold(&failures.concat());
}

/// The backends that take the shader without what it needs, and those that reject it though they have that.
pub fn failures_of(shader: &Shader) -> Vec<String> {
    let mut failures = Vec::new();
    for backend in BACKENDS {
        let is_lacking = shader
            .needs
            .iter()
            .any(|need| lacks(backend).contains(need));
        match (backend.write(&shader.module, &shader.info), is_lacking) {
            (Ok(()), false) | (Err(_), true) => {}
            (Ok(()), true) => failures.push(format!(
                "{backend:?} takes {} without {:?}: that is no capability of it",
                shader.name, shader.needs
            )),
            (Err(error), false) => {
                failures.push(format!("{backend:?} rejects {}: {error}", shader.name));
            }
        }
    }
    failures
}
