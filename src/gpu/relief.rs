//! The meshes of ground with relief.

use super::contours::PageMesh;
use super::grid::GridMesh;
use super::ground::GroundMesh;
use super::mesh::SurfaceMesh;
use super::surface_config::SurfaceConfig;
use crate::globe::GroundForm;

/// The mesh of ground in a form.
pub(super) fn mesh(
    device: &wgpu::Device,
    form: &GroundForm<'_>,
    config: &SurfaceConfig<'_>,
) -> Box<dyn SurfaceMesh + Send + Sync> {
    match form {
        GroundForm::Patches => Box::new(GroundMesh::new(device, config.crosses_blocks)),
        GroundForm::Grid(grid) => Box::new(GridMesh::new(device, grid)),
        GroundForm::Pages(pages) => Box::new(PageMesh::new(device, pages, config.format.depth)),
    }
}
