//! The meshes of terrain.

use super::contours::PageMesh;
use super::grid::GridMesh;
use super::ground::GroundMesh;
use super::mesh::SurfaceMesh;
use super::surface_config::SurfaceConfig;
use crate::plan::DeviceLimits;
use terrella_ground::globe::DrawKind;
use terrella_ground::globe::projected_grid::GPU_TILES;

/// The mesh for terrain of this kind.
pub(super) fn mesh(
    device: &wgpu::Device,
    kind: &DrawKind<'_>,
    config: &SurfaceConfig<'_>,
) -> Box<dyn SurfaceMesh> {
    match kind {
        DrawKind::Patches => Box::new(GroundMesh::new(device, config.crosses_blocks)),
        DrawKind::Grid(grid) => Box::new(GridMesh::new(device, grid)),
        DrawKind::ContourPages(pages) => {
            Box::new(PageMesh::new(device, pages, config.format.depth))
        }
    }
}

/// Reports what an adapter with these limits can draw of terrain, and what is dropped and why, one per line.
pub(super) fn report(limits: &DeviceLimits, can: &mut Vec<String>, dropped: &mut Vec<String>) {
    match GridMesh::fits(limits, GPU_TILES) {
        true => can.push("projected grid with vertices made on the GPU".into()),
        false => dropped.push(
            "projected grid on the GPU: textures or uniforms are too small; its vertices are made on the CPU"
                .into(),
        ),
    }
}
