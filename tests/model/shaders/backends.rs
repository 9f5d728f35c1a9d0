//! Every backend takes every legal variant that it can.

use super::compile::{BACKENDS, Backend};
use super::{Shader, all_shaders, hold, on_all_cores};
use terrella::internals::gpu::ShaderCapability;

/// What a backend cannot have, whatever the machine.
fn lacks(backend: Backend) -> &'static [ShaderCapability] {
    match backend {
        Backend::GlslEs300 => &[ShaderCapability::StorageBuffers],
        Backend::SpirV | Backend::Metal | Backend::Hlsl | Backend::GlslEs310 => &[],
    }
}

#[test]
fn every_backend_takes_every_variant_that_it_can() {
    let failures = on_all_cores(all_shaders(), failures_of);
    hold(&failures);
}

/// Where a backend takes a shader that it cannot have, or rejects one that it can.
fn failures_of(shaders: &[Shader]) -> Vec<String> {
    let mut failures = Vec::new();
    for (backend, shader) in BACKENDS
        .into_iter()
        .flat_map(|backend| shaders.iter().map(move |shader| (backend, shader)))
    {
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
