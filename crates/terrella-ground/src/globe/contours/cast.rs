//! Casting rays at contours.
//!
//! The ground is solid: below the plane halfway between a leaf's contours, inside the leaf's column, to any depth. A ray hits it where it
//! crosses that plane, or at the wall between two columns where it enters below the plane. No step between neighbouring contours therefore
//! lets a ray through. The walk descends the quadtree, near children first, with the ray's interval inside each column. A node whose
//! ceiling the ray stays above is skipped, and nothing beyond the nearest hit so far is tested. There is no recursion and no allocation:
//! the stack has 4 entries a level.

use super::dem::{Dem, HalfSpace};
use super::tree::{ContourTree, Node};
use glam::DVec3;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start point, metres from the DEM's origin.
    pub from_m: DVec3,
    /// Unit direction.
    pub towards: DVec3,
    /// Largest distance, metres; hits beyond are ignored.
    pub most_m: f64,
    /// A node counts as a leaf if its slab is thinner than this times the distance: pixels × radians per pixel. 0 descends to the leaves.
    pub cone: f64,
}

/// Intersection of a ray with the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, metres. 0 for a ray that begins in the ground.
    pub distance_m: f64,
    /// Index of the node that was hit.
    pub node: u32,
    /// Whether the ray hit the wall of a column instead of the top.
    pub wall: bool,
}

/// The interval t0…t1 of a ray inside a column; empty if t0 > t1.
fn inside(ray: &Ray, column: &[HalfSpace; 4], (mut t0, mut t1): (f64, f64)) -> (f64, f64) {
    for (n, d) in column {
        let (lacks, gains) = (d - n.dot(ray.from_m), n.dot(ray.towards));
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

fn top(ray: &Ray, node: &Node, index: u32, (t0, t1): (f64, f64)) -> Option<Hit> {
    let height = node.contour.distance_m(ray.from_m);
    let climbs = node.contour.normal.dot(ray.towards);
    if height + climbs * t0 <= 0.0 {
        return Some(Hit {
            distance_m: t0,
            node: index,
            wall: true,
        });
    }
    let t = -height / climbs;
    (climbs < 0.0 && t <= t1).then_some(Hit {
        distance_m: t.max(t0),
        node: index,
        wall: false,
    })
}

impl ContourTree {
    /// First intersection of a ray with the ground.
    pub fn cast(&self, dem: &Dem, ray: &Ray) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        let mut stack = [(0u32, 0.0f64, 0.0f64); 128];
        let mut height = 0;
        let whole = (0.0, ray.most_m);
        let (t0, t1) = inside(ray, &dem.column(self.nodes[0].span), whole);
        if t0 <= t1 {
            stack[0] = (0, t0, t1);
            height = 1;
        }
        while height > 0 {
            height -= 1;
            let (index, t0, t1) = stack[height];
            if best.is_some_and(|hit| hit.distance_m <= t0) {
                continue;
            }
            let node = &self.nodes[index as usize];
            let contour = &node.contour;
            let over = contour.normal.dot(ray.from_m - contour.at_m) - node.ceiling_m;
            let climbs = contour.normal.dot(ray.towards);
            if over + climbs * t0 > 0.0 && over + climbs * t1 > 0.0 {
                continue;
            }
            let fine = contour.thickness_m() <= ray.cone * t0;
            if node.children == 0 || fine || height + 4 > stack.len() {
                if let Some(hit) = top(ray, node, index, (t0, t1))
                    && best.is_none_or(|best| hit.distance_m < best.distance_m)
                {
                    best = Some(hit);
                }
                continue;
            }
            let first = height;
            for k in node.first..node.first + node.children {
                let column = dem.column(self.nodes[k as usize].span);
                let (t0, t1) = inside(ray, &column, whole);
                if t0 <= t1 {
                    // Insertion sort: the farthest at the bottom.
                    let mut at = height;
                    while at > first && stack[at - 1].1 < t0 {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = (k, t0, t1);
                    height += 1;
                }
            }
        }
        best
    }

    /// The same by testing every leaf: reference for [`Self::cast`].
    #[cfg(test)]
    pub fn cast_at_all(&self, dem: &Dem, ray: &Ray) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        for (index, node) in self.nodes.iter().enumerate() {
            let (t0, t1) = inside(ray, &dem.column(node.span), (0.0, ray.most_m));
            if node.children == 0
                && t0 <= t1
                && let Some(hit) = top(ray, node, index as u32, (t0, t1))
                && best.is_none_or(|best| hit.distance_m < best.distance_m)
            {
                best = Some(hit);
            }
        }
        best
    }
}
