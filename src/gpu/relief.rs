//! The meshes of ground with relief.

use super::contours::PageMesh;
use super::grid::GridMesh;
use super::ground::GroundMesh;
use super::mesh::SurfaceMesh;
use super::surface::SurfaceLook;
use crate::globe::GroundForm;

/// The mesh of ground in a form.
pub(super) fn mesh(
    device: &wgpu::Device,
    form: &GroundForm<'_>,
    look: &SurfaceLook<'_>,
) -> Box<dyn SurfaceMesh + Send + Sync> {
    match form {
        GroundForm::Patches => Box::new(GroundMesh::new(device, look.crossing)),
        GroundForm::Grid(grid) => Box::new(GridMesh::new(device, grid)),
        GroundForm::Pages(pages) => Box::new(PageMesh::new(device, pages, look.format.depth)),
    }
}
