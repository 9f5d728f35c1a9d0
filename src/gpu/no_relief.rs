//! In place of `relief.rs` where the feature `terrain` is off: terrain is drawn in no way.

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

/// There is nothing to tell of terrain.
pub(super) fn report(_: &DeviceLimits, _: &mut Vec<String>, _: &mut Vec<String>) {}
