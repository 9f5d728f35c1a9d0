//! The meshes of ground with relief.

use super::contours::PageMesh;
use super::grid::GridMesh;
use super::ground::GroundMesh;
use super::mesh::SurfaceMesh;
use super::surface::SurfaceLook;
use crate::globe::GroundForm;
use crate::globe::projected_grid::GPU_TILES;

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

/// What an adapter with these limits can draw of it, and what is dropped and why, each a line.
pub(super) fn report(limits: &wgpu::Limits, can: &mut Vec<String>, dropped: &mut Vec<String>) {
    match GridMesh::fits(limits, GPU_TILES) {
        true => can.push("projected grid with vertices made on the GPU".into()),
        false => dropped.push(
            "projected grid on the GPU: textures or uniforms are too small; its vertices are made on the CPU"
                .into(),
        ),
    }
}
