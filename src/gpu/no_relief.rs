//! In place of `relief.rs` where the feature `terrain` is off: there is no form of ground, and so no mesh of it.

use super::mesh::SurfaceMesh;
use super::surface_config::SurfaceConfig;
use crate::globe::GroundForm;

pub(super) fn mesh(
    _: &wgpu::Device,
    form: &GroundForm<'_>,
    _: &SurfaceConfig<'_>,
) -> Box<dyn SurfaceMesh + Send + Sync> {
    match form.0 {}
}

/// There is nothing to tell of ground with relief.
pub(super) fn report(_: &wgpu::Limits, _: &mut Vec<String>, _: &mut Vec<String>) {}
