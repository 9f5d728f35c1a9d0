//! The spacecraft's shape: a body of 4.4 × 3 × 3.2 m, with all that is on it 7 m high, and wings of 24 m from tip to tip.
//!
//! Craft axes, metres: x along flight, z down, y to the right. The wings are in their rest position, cells up; the
//! shader turns them about y.

use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec2, Vec3};
use std::f32::consts::TAU;

/// Material of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Material {
    /// Golden multi-layer insulation.
    Foil = 0,
    /// White paint.
    Paint = 1,
    /// Solar cells; turns with the wings.
    Cells = 2,
    /// The wings' back and edges; turns with the wings.
    Wing = 3,
    /// Dark metal.
    Metal = 4,
    /// A thin white sheet that is seen from both sides.
    Dish = 5,
}

/// Declares the materials' numbers for `shaders/craft.wgsl`.
pub fn material_constants() -> String {
    use Material::{Cells, Dish, Foil, Metal, Paint, Wing};
    [Foil, Paint, Cells, Wing, Metal, Dish]
        .map(|material| {
            let name = format!("{material:?}").to_uppercase();
            format!("const {name}: u32 = {}u;\n", material as u32)
        })
        .concat()
}

/// `CraftVertex` of `shaders/craft.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct CraftVertex {
    pub position_m: Vec3,
    /// Unit.
    pub normal: Vec3,
    /// Metres along and across a wing's cells; 0 elsewhere.
    pub along_m: Vec2,
    /// A [`Material`].
    pub material: u32,
}

/// Layout of [`CraftVertex`].
pub const ATTRIBUTES: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Uint32];

/// Number of sides of a round body.
const SIDES: u32 = 24;
/// Rings of the dish.
const RINGS: u32 = 5;

/// Half size of the body.
const BODY: Vec3 = Vec3::new(2.2, 1.5, 1.6);
/// Each wing: panels in a row, their length along y, width along x, the gap between two, and the root's distance.
const PANELS: u32 = 3;
const PANEL_LENGTH: f32 = 2.88;
const PANEL_WIDTH: f32 = 3.6;
const PANEL_GAP: f32 = 0.12;
const WING_ROOT: f32 = 3.2;
const WING_THICKNESS: f32 = 0.08;

/// All triangles, three vertices each.
pub fn vertices() -> Vec<CraftVertex> {
    let mut mesh = Mesh::default();
    mesh.cuboid(Vec3::ZERO, BODY, Material::Foil);
    // Radiators aft and on both flanks.
    let aft = Vec3::new(-BODY.x - 0.05, 0.0, 0.1);
    mesh.cuboid(aft, Vec3::new(0.05, 1.15, 1.1), Material::Paint);
    for side in [-1.0, 1.0] {
        let flank = Vec3::new(-1.2, side * (BODY.y + 0.04), -0.3);
        mesh.cuboid(flank, Vec3::new(0.75, 0.04, 1.0), Material::Paint);
    }
    // Its payload: a telescope that looks down, and an instrument in front of it.
    let down = Quat::IDENTITY;
    mesh.cylinder(
        Vec3::new(0.7, 0.0, BODY.z),
        down,
        0.95,
        1.5,
        Material::Paint,
    );
    mesh.cuboid(
        Vec3::new(-1.2, 0.4, BODY.z + 0.35),
        Vec3::new(0.5, 0.6, 0.35),
        Material::Metal,
    );
    mesh.high_gain_antenna(Vec3::new(0.5, 0.0, -BODY.z));
    for side in [-1.0, 1.0] {
        mesh.wing(side);
    }
    mesh.vertices
}

#[derive(Default)]
struct Mesh {
    vertices: Vec<CraftVertex>,
}

/// Position and normal.
type MeshCorner = (Vec3, Vec3);

impl Mesh {
    fn quad(&mut self, corners: [MeshCorner; 4], along_m: [Vec2; 4], material: Material) {
        for k in [0, 1, 2, 0, 2, 3] {
            let (position_m, normal) = corners[k];
            self.vertices.push(CraftVertex {
                position_m,
                normal,
                along_m: along_m[k],
                material: material as u32,
            });
        }
    }

    /// One face of a box: `normal` and the two edges from its middle.
    fn face(&mut self, middle: Vec3, u: Vec3, v: Vec3, normal: Vec3, material: Material) {
        let corners = [-u - v, u - v, u + v, v - u].map(|offset| (middle + offset, normal));
        self.quad(corners, [Vec2::ZERO; 4], material);
    }

    fn cuboid(&mut self, center: Vec3, half: Vec3, material: Material) {
        let (x, y, z) = (Vec3::X * half.x, Vec3::Y * half.y, Vec3::Z * half.z);
        for (n, u, v) in [(x, y, z), (y, z, x), (z, x, y)] {
            for n in [n, -n] {
                self.face(center + n, u, v, n.normalize(), material);
            }
        }
    }

    /// A closed cylinder from `base` along the z axis of `turn`.
    fn cylinder(&mut self, base: Vec3, turn: Quat, radius: f32, length: f32, material: Material) {
        let axis = turn * Vec3::Z;
        for k in 0..SIDES {
            let spokes = [k, k + 1].map(|k| turn * spoke(k));
            let [a, b] = spokes.map(|spoke| (base + radius * spoke, spoke));
            let [c, d] = [b, a].map(|(position, normal)| (position + length * axis, normal));
            self.quad([a, b, c, d], [Vec2::ZERO; 4], material);
            for (center, normal) in [(base, -axis), (base + length * axis, axis)] {
                let rim = spokes.map(|spoke| (center + radius * spoke, normal));
                let middle = (center, normal);
                self.quad([middle, rim[0], rim[1], middle], [Vec2::ZERO; 4], material);
            }
        }
    }

    /// A dish on a mast, turned up and aft as to a relay satellite.
    fn high_gain_antenna(&mut self, foot: Vec3) {
        let up = Quat::from_rotation_x(std::f32::consts::PI);
        self.cylinder(foot, up, 0.11, 1.5, Material::Metal);
        let turn = Quat::from_rotation_arc(Vec3::Z, Vec3::new(-0.62, -0.28, -0.73).normalize());
        let vertex = foot - 1.45 * Vec3::Z;
        // z = r²/(4f): 0.5 m deep at the rim.
        let (radius, focal) = (1.55, 1.2);
        let at = |ring: u32, k: u32| {
            let r = radius * ring as f32 / RINGS as f32;
            let point = r * spoke(k) + Vec3::Z * (r * r / (4.0 * focal));
            let normal = (Vec3::Z - spoke(k) * (r / (2.0 * focal))).normalize();
            (vertex + turn * point, turn * normal)
        };
        for ring in 0..RINGS {
            for k in 0..SIDES {
                let corners = [
                    at(ring, k),
                    at(ring, k + 1),
                    at(ring + 1, k + 1),
                    at(ring + 1, k),
                ];
                self.quad(corners, [Vec2::ZERO; 4], Material::Dish);
            }
        }
        self.cylinder(vertex, turn, 0.045, focal, Material::Metal);
        let feed = vertex + turn * Vec3::Z * (focal - 0.1);
        self.cylinder(feed, turn, 0.17, 0.3, Material::Metal);
    }

    /// The wing on the right (`side` 1) or the left (−1).
    fn wing(&mut self, side: f32) {
        // A boom along y, and a yoke that spreads to the first panel's corners.
        let outwards = Quat::from_rotation_arc(Vec3::Z, Vec3::Y * side);
        let body = Vec3::Y * (side * BODY.y);
        self.cylinder(body, outwards, 0.12, WING_ROOT - BODY.y, Material::Metal);
        let yoke = Vec3::new(0.0, side * (WING_ROOT - 0.1), 0.0);
        self.cuboid(
            yoke,
            Vec3::new(0.42 * PANEL_WIDTH, 0.07, 0.07),
            Material::Wing,
        );
        for panel in 0..PANELS {
            let inner = WING_ROOT + panel as f32 * (PANEL_LENGTH + PANEL_GAP);
            let center = Vec3::Y * (side * (inner + 0.5 * PANEL_LENGTH));
            let half = 0.5 * Vec3::new(PANEL_WIDTH, PANEL_LENGTH, WING_THICKNESS);
            self.cuboid(center, half, Material::Wing);
            // The cells are slightly above the panel and leave its rim free.
            let (u, v) = (Vec3::X * (half.x - 0.06), Vec3::Y * (half.y - 0.06));
            let top = center - Vec3::Z * (half.z + 0.01);
            let corners = [-u - v, u - v, u + v, v - u].map(|offset| (top + offset, Vec3::NEG_Z));
            let along_m = corners.map(|(p, _)| {
                let from_corner = p - (top - u - v);
                Vec2::new(from_corner.x, from_corner.y)
            });
            self.quad(corners, along_m, Material::Cells);
            // Hinges to the next panel.
            if panel + 1 < PANELS {
                for x in [-0.3 * PANEL_WIDTH, 0.3 * PANEL_WIDTH] {
                    let gap = side * (inner + PANEL_LENGTH + 0.5 * PANEL_GAP);
                    self.cuboid(
                        Vec3::new(x, gap, 0.0),
                        Vec3::new(0.12, 0.5 * PANEL_GAP, 0.03),
                        Material::Wing,
                    );
                }
            }
        }
    }
}

/// Unit vector across z.
fn spoke(k: u32) -> Vec3 {
    let (sin, cos) = (TAU * (k % SIDES) as f32 / SIDES as f32).sin_cos();
    Vec3::new(cos, sin, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shape_is_whole_and_symmetric() {
        let vertices = vertices();
        assert_eq!(vertices.len() % 3, 0);
        let mut span = (f32::MAX, f32::MIN);
        for v in &vertices {
            assert!(v.position_m.is_finite(), "{v:?}");
            assert!((v.normal.length() - 1.0).abs() < 1e-5, "{v:?}");
            assert!(v.material <= Material::Dish as u32);
            span = (span.0.min(v.position_m.y), span.1.max(v.position_m.y));
        }
        assert!(
            (span.1 - 12.08).abs() < 0.01 && (span.0 + span.1).abs() < 1e-4,
            "{span:?}"
        );
    }

    #[test]
    fn normals_of_closed_parts_point_outwards() {
        // The body's eight corners are its first twelve triangles.
        for v in &vertices()[..36] {
            assert!(v.normal.dot(v.position_m) > 0.0, "{v:?}");
        }
    }
}
