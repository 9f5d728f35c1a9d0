//! The tree in the GPU's layout, and the shader's walk in Rust.
//!
//! `shaders/earth/surface_point/contour_tree.wgsl` has the same names; its `contour_cast` does the same as [`contour_cast`], operation by
//! operation, in f32. Positions are metres from the DEM's origin. A ray is passed relative to that origin too, so that both are small. A
//! node has 128 bytes, and children are consecutive. A buffer may hold several trees one after another: a walk takes the index of its root.

use super::dem::{Dem, Span};
use super::tree::ContourTree;
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, Vec3, Vec4};

/// A node in the shader's layout.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct ContourNode {
    /// Unit normal of the node's planes.
    pub normal: Vec3,
    /// Upper bound of the signed distance of drawn terrain from the centroid's plane, metres.
    pub ceiling: f32,
    /// The centroid, metres.
    pub at: Vec3,
    /// Signed distance of the plane halfway between the contours, metres.
    pub middle: f32,
    /// West, east, south, north: inside is where xyz·p ≥ w.
    pub walls: [Vec4; 4],
    /// First child, relative to the root; 0 for a leaf.
    pub first: u32,
    /// Number of children.
    pub children: u32,
    /// Thickness of the slab, metres.
    pub thickness: f32,
    /// Always 0.
    pub unused: f32,
    /// For shading: direction of the ground's normal at the corners SW, SE, NW, NE, packed by `pack_slope`.
    pub slopes: [u32; 4],
}

/// Packs the rise to the east and to the north, metres per metre. It stores the east and north components of the unit normal in 16 bits
/// each.
fn pack_slope(slope: DVec2) -> u32 {
    let slope = slope.clamp(DVec2::splat(-1e3), DVec2::splat(1e3));
    let normal = -slope / (1.0 + slope.length_squared()).sqrt();
    let part = |x: f64| u32::from((x * 32_767.0).round() as i16 as u16);
    part(normal.x) | part(normal.y) << 16
}

/// Entries of the walk's stack: enough for trees of 7 levels below the root, 129 samples a side.
pub const STACK: usize = 24;

impl ContourTree {
    /// Appends all nodes to `out`, the root first. `slope` returns the rise of the ground at a sample, to the east and to the north.
    pub fn write_gpu_nodes(
        &self,
        dem: &Dem,
        slope: impl Fn(u32, u32) -> DVec2,
        out: &mut Vec<ContourNode>,
    ) {
        let corners = |[west, east, south, north]: Span| {
            [(west, south), (east, south), (west, north), (east, north)]
                .map(|(i, j)| pack_slope(slope(i, j)))
        };
        let gpu_node = |node: &super::tree::Node| ContourNode {
            normal: node.contour.normal.as_vec3(),
            // Rounding of positions to f32 must not lower the ceiling.
            ceiling: (node.ceiling_m + 1e-6 * node.contour.at_m.length()) as f32,
            at: node.contour.at_m.as_vec3(),
            middle: (0.5 * (node.contour.low_m + node.contour.high_m)) as f32,
            walls: dem
                .column(node.span)
                .map(|(n, d)| n.as_vec3().extend(d as f32)),
            first: node.first,
            children: node.children,
            thickness: node.contour.thickness_m() as f32,
            unused: 0.0,
            slopes: corners(node.span),
        };
        out.extend(self.nodes.iter().map(gpu_node));
    }
}

/// A ray in the shader's layout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourRay {
    /// Start point, metres from the tree's origin.
    pub from: Vec3,
    /// Unit direction.
    pub towards: Vec3,
    /// Largest distance, metres; hits beyond are ignored.
    pub most: f32,
    /// A node counts as a leaf if its slab is thinner than this times the distance: pixels of error × radians per pixel.
    pub cone: f32,
    /// Columns are widened by this on all sides, metres, for rays between trees whose origins round them differently.
    pub slack: f32,
    /// A ray that enters the tree's column deeper in the ground than this, metres, came from below other ground: it hits nothing.
    /// Neighbours differ in height by at most this.
    pub step: f32,
}

/// The interval of a ray inside a node's column; x > y if there is none.
fn contour_column(node: &ContourNode, ray: &ContourRay) -> (f32, f32) {
    let (mut t0, mut t1) = (0.0f32, ray.most);
    for wall in node.walls {
        let lacks = wall.w - wall.truncate().dot(ray.from) - ray.slack;
        let gains = wall.truncate().dot(ray.towards);
        if gains > 0.0 {
            t0 = t0.max(lacks / gains);
        } else if gains < 0.0 {
            t1 = t1.min(lacks / gains);
        } else if lacks > 0.0 {
            return (1.0, 0.0);
        }
    }
    (t0, t1)
}

/// First intersection of a ray with the ground of the tree at `root`: distance in metres, and the node. See [`ContourTree::cast`].
pub fn contour_cast(nodes: &[ContourNode], root: u32, ray: &ContourRay) -> Option<(f32, u32)> {
    let mut best = (ray.most, u32::MAX);
    let mut stack = [(0u32, 0.0f32, 0.0f32); STACK];
    let (t0, t1) = contour_column(&nodes[root as usize], ray);
    let entry = t0;
    stack[0] = (root, t0, t1);
    let whole = &nodes[root as usize];
    let above = whole.normal.dot(ray.from - whole.at) + whole.normal.dot(ray.towards) * t0;
    if t0 > 0.0 && whole.middle - above > whole.thickness + ray.step {
        return None;
    }
    let mut height = usize::from(t0 <= t1);
    while height > 0 {
        height -= 1;
        let (index, t0, t1) = stack[height];
        if t0 >= best.0 {
            continue;
        }
        let node = &nodes[index as usize];
        let over = node.normal.dot(ray.from - node.at);
        let climbs = node.normal.dot(ray.towards);
        let lowest = (over + climbs * t0).min(over + climbs * t1);
        if lowest > node.ceiling {
            continue;
        }
        let fine = node.thickness <= ray.cone * t0;
        if node.children == 0 || fine || height + 4 > STACK {
            let start = over + climbs * t0 - node.middle;
            let t = (node.middle - over) / climbs;
            if start <= 0.0 {
                if t0 > 0.0 && t0 <= entry && -start > ray.step {
                    return None;
                }
                best = (t0, index);
            } else if climbs < 0.0 && t <= t1 && t < best.0 {
                best = (t.max(t0), index);
            }
            continue;
        }
        let bottom = height;
        for k in root + node.first..root + node.first + node.children {
            let (t0, t1) = contour_column(&nodes[k as usize], ray);
            if t0 <= t1 {
                let mut at = height;
                while at > bottom && stack[at - 1].1 < t0 {
                    stack[at] = stack[at - 1];
                    at -= 1;
                }
                stack[at] = (k, t0, t1);
                height += 1;
            }
        }
    }
    (best.1 != u32::MAX).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::super::cast::Ray;
    use super::super::tests::ground::{fractal, noise};
    use super::*;
    use glam::{DVec3, Vec2};

    #[test]
    fn single_precision_meets_the_same_ground() {
        let dem = fractal(129, 21);
        let tree = ContourTree::build(&dem, 10.0, 1 << 28).unwrap();
        let mut nodes = vec![ContourNode::default(); 3];
        tree.write_gpu_nodes(&dem, |_, _| DVec2::ZERO, &mut nodes);
        let mut seed = 2;
        let (mut offs, mut other) = (Vec::new(), 0);
        for _ in 0..5_000 {
            let mut place = |z: f64| {
                let mut at = || (0.5 + 0.7 * noise(&mut seed)) * 11_500.0;
                DVec3::new(at(), at(), z)
            };
            let (from, to) = (place(6_000.0), place(1_500.0));
            let ray = Ray {
                from_m: from,
                towards: (to - from).normalize(),
                most_m: 1e6,
                cone: 0.0,
            };
            let double = tree.cast(&dem, &ray);
            let ray = ContourRay {
                from: from.as_vec3(),
                towards: ray.towards.as_vec3(),
                most: 1e6,
                cone: 0.0,
                slack: 0.0,
                step: f32::MAX,
            };
            let single = contour_cast(&nodes, 3, &ray);
            match (double, single) {
                (Some(a), Some(b)) => offs.push((a.distance_m - f64::from(b.0)).abs()),
                (None, None) => (),
                _ => other += 1,
            }
        }
        offs.sort_by(f64::total_cmp);
        let at = |part: f64| offs[((offs.len() - 1) as f64 * part) as usize];
        println!(
            "{} hits, f32 against f64: median {:.1e} m, 99 % {:.1e} m, most {:.1e} m; {other} hit in one alone",
            offs.len(),
            at(0.5),
            at(0.99),
            at(1.0)
        );
        // Rays that graze a crest reach the next one in one of the two.
        assert!(at(0.99) < 0.1 && other <= 3 && offs.len() > 2_000);
    }

    /// The east and north components of the unit normal, as a shader's `unpack2x16snorm` returns them.
    fn unpack_normal(packed: u32) -> Vec2 {
        let part = |bits: u32| (f32::from(bits as u16 as i16) / 32_767.0).max(-1.0);
        Vec2::new(part(packed), part(packed >> 16))
    }

    #[test]
    fn slopes_come_back_from_sixteen_bits() {
        for slope in [DVec2::ZERO, DVec2::new(0.3, -0.1), DVec2::new(-4.0, 2.0)] {
            let normal = unpack_normal(pack_slope(slope)).as_dvec2();
            let up = (1.0 - normal.length_squared()).sqrt();
            assert!((-normal / up - slope).length() < 1e-3 * (1.0 + slope.length_squared()));
        }
        let upright = unpack_normal(pack_slope(DVec2::new(f64::INFINITY, 0.0)));
        assert!((upright.x + 1.0).abs() < 1e-4);
    }
}
