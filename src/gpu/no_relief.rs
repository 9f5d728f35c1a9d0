//! Replaces `relief.rs` if the feature `terrain` is off: there is no terrain to draw.

use super::mesh::SurfaceMesh;
use super::surface_config::SurfaceConfig;
use crate::plan::DeviceLimits;
use terrella_ground::globe::DrawKind;

pub(super) fn mesh(
    _: &wgpu::Device,
    kind: &DrawKind<'_>,
    _: &SurfaceConfig<'_>,
) -> Box<dyn SurfaceMesh> {
    match kind.0 {}
}

/// Reports nothing about terrain.
pub(super) fn report(_: &DeviceLimits, _: &mut Vec<String>, _: &mut Vec<String>) {}
