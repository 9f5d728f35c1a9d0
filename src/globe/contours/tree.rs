//! The quadtree of contours over a DEM of any size.

use super::dem::{Dem, Half, Span, quarters};
use super::plane::{Contour, Support, fit};
use glam::{DMat4, DVec3};

/// A tree that would not fit into its budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{what} would take more than the {budget_bytes} bytes allowed; raise the budget or the tolerance"
)]
pub struct BudgetError {
    /// What was being built.
    pub what: &'static str,
    /// Bytes allowed.
    pub budget_bytes: u64,
}

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

/// A node: a span of samples between two parallel planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Its plane and slab. All samples of the span lie inside.
    pub contour: Contour,
    /// Nothing drawn below this node rises over this signed distance from its plane, metres.
    pub ceiling_m: f64,
    /// Farthest sample from the centroid, metres.
    pub radius_m: f64,
    /// Its samples.
    pub span: Span,
    /// First of its children, which follow each other; 0 for a leaf.
    pub first: u32,
    /// How many.
    pub children: u32,
    parent: u32,
}

/// What a tree holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TreeStats {
    /// All nodes.
    pub nodes: u64,
    /// Of those without children.
    pub leaves: u64,
    /// Leaves of one cell whose slab is still thicker than the tolerance.
    pub over: u64,
    /// Nodes whose best plane stands upright, or so steep that its slab reaches higher, and that took a level one.
    pub upright: u64,
    /// Longest way from the root.
    pub depth: u32,
    /// Thickest slab of a leaf, metres.
    pub thickest_m: f64,
    /// Memory, bytes.
    pub bytes: u64,
}

/// Contours of a DEM.
#[derive(Clone, Debug, PartialEq)]
pub struct ContourTree {
    /// The root first, children after their parent.
    pub nodes: Vec<Node>,
    /// What its slabs were held against, metres.
    pub tolerance_m: f64,
    stats: TreeStats,
}

/// Below this cosine to the vertical a plane is no ground: over a column it would rise a thousandfold.
const LEAST_COSINE: f64 = 1e-3;
/// Below this cosine a plane is taken only if its slab, measured upwards, is thinner than that of the level one: of a narrow
/// column with a cliff in it, it may reach far above and below all samples.
const STEEP_COSINE: f64 = 0.5;

impl ContourTree {
    /// Builds the tree: a span is cut in quarters until its slab is not thicker than the tolerance (0: until single
    /// cells, unless flat to 10 μm). `progress` hears 0…1.
    pub fn build(
        dem: &Dem,
        tolerance_m: f64,
        budget_bytes: u64,
        progress: &mut dyn FnMut(f32),
    ) -> Result<Self, BudgetError> {
        let most = (budget_bytes / size_of::<Node>() as u64).min(u64::from(u32::MAX)) as usize;
        let mut stats = TreeStats::default();
        let mut nodes = vec![Self::node(dem, dem.span(), 0, &mut stats)];
        let (mut next, mut done, mut told) = (0, 0u64, 0.0);
        let cells = |[w, e, s, n]: Span| u64::from(e - w).max(1) * u64::from(n - s).max(1);
        let all = cells(dem.span());
        while next < nodes.len() {
            let node = nodes[next];
            let thick = node.contour.thickness_m();
            let quarters = quarters(node.span).filter(|_| thick > tolerance_m.max(1e-5));
            if let Some((spans, count)) = quarters {
                if nodes.len() + count > most {
                    return Err(BudgetError {
                        what: "a tree of contours",
                        budget_bytes,
                    });
                }
                nodes[next].first = nodes.len() as u32;
                nodes[next].children = count as u32;
                for span in &spans[..count] {
                    let child = Self::node(dem, *span, next as u32, &mut stats);
                    nodes.push(child);
                }
            } else {
                stats.leaves += 1;
                stats.thickest_m = stats.thickest_m.max(thick);
                stats.over += u64::from(thick > tolerance_m.max(1e-5));
                done += cells(node.span);
                let part = done as f32 / all as f32;
                if part > told + 0.01 {
                    told = part;
                    progress(part);
                }
            }
            next += 1;
        }
        Self::raise_ceilings(dem, &mut nodes);
        let mut last = nodes.len() - 1;
        while last > 0 {
            last = nodes[last].parent as usize;
            stats.depth += 1;
        }
        stats.nodes = nodes.len() as u64;
        stats.bytes = stats.nodes * size_of::<Node>() as u64;
        progress(1.0);
        Ok(Self {
            nodes,
            tolerance_m,
            stats,
        })
    }

    /// What it holds.
    pub fn stats(&self) -> TreeStats {
        self.stats
    }

    fn node(dem: &Dem, span: Span, parent: u32, stats: &mut TreeStats) -> Node {
        let [west, east, south, north] = span;
        let each = |take: &mut dyn FnMut(DVec3)| {
            for j in south..=north {
                for i in west..=east {
                    take(dem.point_m(i, j));
                }
            }
        };
        let mut contour = fit(dem.up(), each);
        let mut radius_m = 0.0f64;
        let cosine = contour.normal.dot(dem.up());
        if cosine < STEEP_COSINE {
            let mut level = Contour {
                normal: dem.up(),
                support: Support::Point,
                low_m: 0.0,
                high_m: 0.0,
                ..contour
            };
            each(&mut |p| {
                let d = level.normal.dot(p - level.at_m);
                level.low_m = level.low_m.min(d);
                level.high_m = level.high_m.max(d);
            });
            if cosine < LEAST_COSINE || contour.thickness_m() > cosine * level.thickness_m() {
                stats.upright += 1;
                contour = level;
            }
        }
        for (i, j) in [(west, south), (east, south), (west, north), (east, north)] {
            for height in [dem.range_m().low_m, dem.range_m().high_m] {
                let along = dem.lifted_m(i, j, height) - contour.at_m;
                radius_m = radius_m.max(along.length());
            }
        }
        Node {
            contour,
            ceiling_m: contour.high_m,
            radius_m,
            span,
            first: 0,
            children: 0,
            parent,
        }
    }

    /// Lets each ceiling hold the drawn quadrilaterals of the node and of all below it.
    fn raise_ceilings(dem: &Dem, nodes: &mut [Node]) {
        for k in 0..nodes.len() {
            let corners = corners_m(&dem.column(nodes[k].span), &nodes[k].contour);
            let mut at = k;
            loop {
                let node = &mut nodes[at];
                for corner in corners {
                    let d = node.contour.normal.dot(corner - node.contour.at_m);
                    // A hair more than rounding.
                    node.ceiling_m = node.ceiling_m.max(d + 1e-6);
                }
                if at == 0 {
                    break;
                }
                at = node.parent as usize;
            }
        }
    }

    /// The nodes to draw for a view, coarse ones where their slab is thinner than `pixels` at their nearest: those whose
    /// ball lies wholly outside a side of the clip volume are left out. `clip_from_local` takes the DEM's metres to clip
    /// space, `pixel_rad` is the angle of a pixel. Cleared first; allocates only while `out` grows.
    pub fn select(
        &self,
        eye_m: DVec3,
        clip_from_local: &DMat4,
        pixel_rad: f64,
        pixels: f64,
        out: &mut Vec<u32>,
    ) {
        out.clear();
        let rows = clip_from_local.transpose();
        let sides = [
            rows.w_axis + rows.x_axis,
            rows.w_axis - rows.x_axis,
            rows.w_axis + rows.y_axis,
            rows.w_axis - rows.y_axis,
        ];
        let mut stack = [0u32; 128];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let index = stack[height];
            let node = &self.nodes[index as usize];
            let at = node.contour.at_m;
            let outside = sides.iter().any(|side| {
                let n = side.truncate();
                n.dot(at) + side.w < -node.radius_m * n.length()
            });
            if outside {
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
}

/// Where the plane halfway between the contours meets the four edges of its column, metres.
pub fn corners_m(column: &[Half; 4], contour: &Contour) -> [DVec3; 4] {
    let middle = 0.5 * (contour.low_m + contour.high_m);
    // About the centroid, so that nothing large cancels.
    let moved = |half: Half| (half.0, half.1 - half.0.dot(contour.at_m));
    [(0, 2), (1, 2), (0, 3), (1, 3)].map(|(a, b)| {
        let ((a, da), (b, db)) = (moved(column[a]), moved(column[b]));
        let n = contour.normal;
        let determinant = n.dot(a.cross(b));
        let p = n.cross(a) * db + b.cross(n) * da + a.cross(b) * middle;
        // Sides that are parallel to each other: a column without width, at a pole.
        if determinant.abs() > 1e-12 {
            contour.at_m + p / determinant
        } else {
            contour.at_m + n * middle
        }
    })
}
