//! Bindings of variants, compared with wgpu's guaranteed device limits.

use super::{Shader, hold, sampled_shaders};
use naga::valid::GlobalUse;
use naga::{AddressSpace, Binding, ShaderStage, TypeInner};
use terrella::internals::gpu::ShaderCapability;
use wgpu::Limits;

/// The kinds of device that wgpu has limits for.
const DEVICES: [(&str, Limits); 3] = [
    ("every WebGPU device", Limits::defaults()),
    ("downlevel devices", Limits::downlevel_defaults()),
    ("WebGL 2", Limits::downlevel_webgl2_defaults()),
];

/// Resources of one shader stage.
#[derive(Clone, Copy, Debug, Default)]
struct Used {
    textures: u32,
    samplers: u32,
    uniforms: u32,
    storage: u32,
    largest_uniform: u64,
    groups: u32,
    largest_binding: u32,
}

fn used_in(shader: &Shader, entry: usize) -> Used {
    let info = shader.info.get_entry_point(entry);
    let mut used = Used::default();
    for (handle, global) in shader.module.global_variables.iter() {
        let Some(at) = global
            .binding
            .filter(|_| info[handle] != GlobalUse::empty())
        else {
            continue;
        };
        used.groups = used.groups.max(at.group + 1);
        used.largest_binding = used.largest_binding.max(at.binding);
        let inner = &shader.module.types[global.ty].inner;
        match (global.space, inner) {
            (AddressSpace::Uniform, TypeInner::Struct { span, .. }) => {
                used.uniforms += 1;
                used.largest_uniform = used.largest_uniform.max(u64::from(*span));
            }
            (AddressSpace::Storage { .. }, _) => used.storage += 1,
            (AddressSpace::Handle, TypeInner::Image { .. }) => used.textures += 1,
            (AddressSpace::Handle, TypeInner::Sampler { .. }) => used.samplers += 1,
            other => panic!("{}: {other:?}", shader.name),
        }
    }
    used
}

/// Locations used by a struct or single value.
fn locations(shader: &Shader, ty: naga::Handle<naga::Type>, binding: &Option<Binding>) -> Vec<u32> {
    let of = |binding: &Option<Binding>| match binding {
        Some(Binding::Location { location, .. }) => Some(*location),
        _ => None,
    };
    match &shader.module.types[ty].inner {
        TypeInner::Struct { members, .. } => members
            .iter()
            .filter_map(|member| of(&member.binding))
            .collect(),
        _ => of(binding).into_iter().collect(),
    }
}

/// Device limits that a shader exceeds.
fn beyond(shader: &Shader, limits: &Limits) -> Vec<String> {
    let mut beyond = Vec::new();
    let mut most = |what: &str, used: u64, limit: u64| {
        if used > limit {
            beyond.push(format!("{what}: {used} of {limit}"));
        }
    };
    for (index, entry) in shader.module.entry_points.iter().enumerate() {
        let used = used_in(shader, index);
        let counts = [
            (
                "sampled textures",
                used.textures,
                limits.max_sampled_textures_per_shader_stage,
            ),
            (
                "samplers",
                used.samplers,
                limits.max_samplers_per_shader_stage,
            ),
            (
                "uniform buffers",
                used.uniforms,
                limits.max_uniform_buffers_per_shader_stage,
            ),
            (
                "storage buffers",
                used.storage,
                limits.max_storage_buffers_per_shader_stage,
            ),
            ("bind groups", used.groups, limits.max_bind_groups),
            (
                "bindings",
                used.largest_binding + 1,
                limits.max_bindings_per_bind_group,
            ),
        ];
        for (what, used, limit) in counts {
            most(what, used.into(), limit.into());
        }
        most(
            "bytes of a uniform",
            used.largest_uniform,
            limits.max_uniform_buffer_binding_size,
        );
        let inputs = entry.function.arguments.iter();
        let inputs: Vec<_> = inputs
            .flat_map(|input| locations(shader, input.ty, &input.binding))
            .collect();
        let outputs = entry.function.result.iter();
        let outputs: Vec<_> = outputs
            .flat_map(|output| locations(shader, output.ty, &output.binding))
            .collect();
        let highest = |locations: &[u32]| {
            locations
                .iter()
                .max()
                .map_or(0, |location| u64::from(location + 1))
        };
        match entry.stage {
            ShaderStage::Vertex => {
                let attributes = u64::from(limits.max_vertex_attributes);
                most("vertex attributes", highest(&inputs), attributes);
                let varyings = u64::from(limits.max_inter_stage_shader_variables);
                most("inter-stage variables", highest(&outputs), varyings);
            }
            ShaderStage::Fragment => {
                let targets = u64::from(limits.max_color_attachments);
                most("colour targets", highest(&outputs), targets);
            }
            other => panic!("{}: {other:?}", shader.name),
        }
    }
    beyond
}

#[test]
fn every_variant_keeps_to_the_limits_or_names_what_it_needs() {
    let shaders = sampled_shaders();
    let mut failures = Vec::new();
    for (device, limits) in &DEVICES {
        let (mut within, mut lacking) = (0, 0);
        for shader in shaders {
            let beyond = beyond(shader, limits);
            let missing: Vec<_> = shader
                .needs
                .iter()
                .filter(|need| !need.is_met(limits))
                .collect();
            match (beyond.is_empty(), missing.is_empty()) {
                (true, true) => within += 1,
                (false, false) => lacking += 1,
                _ => failures.push(format!(
                    "{device}, {}: beyond the limits {beyond:?}, capabilities said to be missing {missing:?}",
                    shader.name
                )),
            }
        }
        println!("{device}: {within} variants within the limits; {lacking} lack a capability");
    }
    hold(&failures);
}

/// Requirements beyond the limits of WebGL 2 are declared, and some variant needs each.
#[test]
fn every_capability_is_needed() {
    let shaders = sampled_shaders();
    for capability in ShaderCapability::ALL {
        assert!(
            shaders
                .iter()
                .any(|shader| shader.needs.contains(&capability))
        );
        assert!(!capability.is_met(&Limits::downlevel_webgl2_defaults()));
        assert!(capability.is_met(&Limits::defaults()));
    }
}
