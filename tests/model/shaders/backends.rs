//! Every backend takes every legal variant that it can.

use super::compile::{BACKENDS, Backend};
use super::{all_shaders, hold};
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
    let shaders = all_shaders();
    let mut failures = Vec::new();
    for backend in BACKENDS {
        let (mut taken, mut rejected) = (0, 0);
        for shader in shaders {
            let is_lacking = shader
                .needs
                .iter()
                .any(|need| lacks(backend).contains(need));
            match (backend.write(&shader.module, &shader.info), is_lacking) {
                (Ok(()), false) => taken += 1,
                (Err(_), true) => rejected += 1,
                (Ok(()), true) => failures.push(format!(
                    "{backend:?} takes {} without {:?}: that is no capability of it",
                    shader.name, shader.needs
                )),
                (Err(error), false) => {
                    failures.push(format!("{backend:?} rejects {}: {error}", shader.name));
                }
            }
        }
        println!("{backend:?}: {taken} variants; {rejected} rejected as expected");
    }
    hold(&failures);
}
