//! The nodes of a tree that a view is drawn with.

use glam::{DMat4, DVec3};
use terrella_ground::globe::contours::tree::ContourTree;
use terrella_ground::globe::culling::Frustum;

/// World error that shows as `pixels` at a depth: ε = τ·2 P_z tan(θ/2)/h. Depths below 1 mm count as 1 mm.
pub fn world_error_m(pixels: f64, viewport_px: f64, depth_m: f64, field_of_view_rad: f64) -> f64 {
    pixels * 2.0 * depth_m.max(1e-3) * (0.5 * field_of_view_rad).tan() / viewport_px
}

/// Pixels by which a world error shows: τ = ε·h/(2 P_z tan(θ/2)).
pub fn screen_error_px(
    error_m: f64,
    viewport_px: f64,
    depth_m: f64,
    field_of_view_rad: f64,
) -> f64 {
    error_m * viewport_px / (2.0 * depth_m.max(1e-3) * (0.5 * field_of_view_rad).tan())
}

/// The nodes to draw for a view, coarse ones where their slab is thinner than `pixels` at their nearest point. Nodes whose bounding sphere is
/// outside the clip volume are left out. `clip_from_local` transforms the DEM's metres to clip space, `pixel_rad` is the angular size of a pixel.
/// `out` is cleared first; allocates only while it grows.
pub fn select(
    tree: &ContourTree,
    eye_m: DVec3,
    clip_from_local: &DMat4,
    pixel_rad: f64,
    pixels: f64,
    out: &mut Vec<u32>,
) {
    out.clear();
    let frustum = Frustum::new(clip_from_local).without_depth();
    let mut stack = [0u32; 128];
    let mut height = 1;
    while height > 0 {
        height -= 1;
        let index = stack[height];
        let node = &tree.nodes[index as usize];
        let at = node.contour.at_m;
        if frustum.excludes_ball(at, node.radius_m) {
            continue;
        }
        let nearest = (at.distance(eye_m) - node.radius_m).max(0.0);
        let fine = node.contour.thickness_m() <= pixels * pixel_rad * nearest;
        if node.children == 0 || fine || height + 4 > stack.len() {
            out.push(index);
            continue;
        }
        for k in 0..node.children {
            stack[height] = node.first + k;
            height += 1;
        }
    }
}
