//! The meshes of ground with relief.

use super::contours::PageMesh;
use super::grid::GridMesh;
use super::ground::GroundMesh;
use super::mesh::SurfaceMesh;
use super::surface_config::SurfaceConfig;
use crate::globe::DrawKind;

/// The mesh of ground that is drawn so.
pub(super) fn mesh(
    device: &wgpu::Device,
    kind: &DrawKind<'_>,
    config: &SurfaceConfig<'_>,
) -> Box<dyn SurfaceMesh + Send + Sync> {
    match kind {
        DrawKind::Patches => Box::new(GroundMesh::new(device, config.crosses_blocks)),
        DrawKind::Grid(grid) => Box::new(GridMesh::new(device, grid)),
        DrawKind::ContourPages(pages) => {
            Box::new(PageMesh::new(device, pages, config.format.depth))
        }
    }
}
