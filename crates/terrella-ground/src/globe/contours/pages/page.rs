//! A page: a cell of the forest with a small tree of contours about its own origin.

use super::super::cast::Ray;
use super::super::dem::{Dem, DemFrame};
use super::super::gpu_layout::ContourNode;
use super::super::plane::{Contour, Support};
use super::super::surface::lattice::{
    AROUND, Cell, STEP_RAD, TALL, ball, chord_m, lat_rad, lon_rad,
};
use super::super::tree::{ContourTree, Node, corners_m};
use crate::elevation::{Bounds, Elevation, HeightRange};
use crate::globe::Block;
use glam::{DVec2, DVec3};
use terrella_frames::Ellipsoid;

/// Cells along an edge of a page.
pub const CELLS: u32 = 16;
/// Largest number of nodes of a page: 1 + 4 + 16 + 64 + 256.
pub const MAX_NODES: u32 = (4 * CELLS * CELLS - 1) / 3;
/// Deepest level: cells of 0.6 m.
pub const MAX_LEVEL: u8 = 18;
/// Posts along an edge of a page, and those with one more at each end, for slopes.
const POSTS: usize = CELLS as usize + 1;
const READ: usize = POSTS + 2;
/// A node is a leaf if its slab is thinner than this fraction of the distance between posts, whatever finer data would add.
const THICKEST: f64 = 1.0 / 32.0;
/// A node is never a leaf before its slab is thinner than this.
const THINNEST: f64 = 1.0 / 1024.0;
/// Limit of heights, metres; values beyond it from a source are clamped.
const BEYOND_M: f64 = 1e5;
/// Latitudes between which slopes change from differences of posts to the ground's own, radians.
const POLAR_RAD: (f64, f64) = (1.4, 1.47);
/// From this level on the chord of a cell is less than 3 cm below the arc, however coarse the data.
const ROUND: u8 = 8;

/// Contours of a cell of ground, in the GPU's layout.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    /// Increases with each change of the fields below; 0 means empty.
    pub revision: u64,
    /// Origin of positions, ITRF metres.
    pub origin_itrf_m: DVec3,
    /// Nodes of the page's tree of contours.
    pub nodes: Vec<ContourNode>,
    /// The prism that contains the drawn terrain: SW, SE, NW, NE below, then above, metres from the origin.
    pub corners_m: [DVec3; 8],
    /// Unit vectors east, north and up at the page's centre.
    pub axes: [DVec3; 3],
    /// Largest known distance between the drawn terrain and the data, metres.
    pub error_m: f64,
    /// The same on its border, where neighbours meet.
    pub border_m: f64,
    /// Centre of a ball that contains the prism, ITRF metres.
    pub center_m: DVec3,
    /// Radius of that ball, metres; see [`Self::center_m`].
    pub radius_m: f64,
    /// Lowest drawn height, metres.
    pub low_m: f64,
    /// Highest height in the page, metres.
    pub high_m: f64,
    /// Whether finer pages would add nothing.
    pub is_last: bool,
    /// Key of the cell that it draws; see [`Self::block`].
    pub key: u64,
    pub(super) block: u32,
}

impl Page {
    /// The block that contains the page.
    pub fn block(&self) -> Block {
        Block {
            column: self.block % crate::globe::COLUMNS,
            row: self.block / crate::globe::COLUMNS,
        }
    }
}

/// Heights of a cell's posts, and of one more on each side.
struct Posts {
    heights_m: [[f64; READ]; READ],
    /// Angle between posts, radians.
    spacing_rad: f64,
}

/// A height that can be drawn.
fn sound(height_m: f64) -> f64 {
    if height_m.is_finite() {
        height_m.clamp(-BEYOND_M, BEYOND_M)
    } else {
        0.0
    }
}

impl Posts {
    fn read(cell: Cell, ground: &dyn Elevation) -> Self {
        let step = cell.steps() / CELLS;
        let spacing_rad = f64::from(step) * STEP_RAD;
        let [x, y] = cell.vertex(0, 0);
        let mut heights_m = [[0.0; READ]; READ];
        for (j, row) in (0u32..).zip(&mut heights_m) {
            let y = (y + j * step).saturating_sub(step).min(TALL);
            for (i, height) in (0u32..).zip(row) {
                let x = (x + AROUND + i * step - step) % AROUND;
                *height = sound(ground.height_m(lat_rad(y), lon_rad(x), 0.5 * spacing_rad));
            }
        }
        Self {
            heights_m,
            spacing_rad,
        }
    }

    fn height_m(&self, i: usize, j: usize) -> f64 {
        self.heights_m[j + 1][i + 1]
    }

    /// Rise to the east and to the north at a post that is not a pole.
    fn slope(&self, lat_rad: f64, radius_m: f64, i: u32, j: u32) -> DVec2 {
        let (i, j) = (i as usize + 1, j as usize + 1);
        let h = &self.heights_m;
        let across_m = 2.0 * self.spacing_rad * radius_m;
        let east = (h[j][i + 1] - h[j][i - 1]) / (across_m * lat_rad.cos());
        DVec2::new(east, (h[j + 1][i] - h[j - 1][i]) / across_m)
    }
}

/// The error that the tree of posts does not include: the largest distance of the data from the posts' squares, metres.
fn missed_m(
    cell: Cell,
    posts: &Posts,
    ground: &dyn Elevation,
    ellipsoid: &Ellipsoid,
) -> (f64, HeightRange) {
    let step = cell.steps() / CELLS;
    let [x, y] = cell.vertex(0, 0);
    let mut most_m = 0.0f64;
    let (mut low_m, mut high_m) = (f64::INFINITY, f64::NEG_INFINITY);
    for j in 0..POSTS - 1 {
        for i in 0..POSTS - 1 {
            let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
            let corners = corners.map(|(a, b)| posts.height_m(i + a, j + b));
            let drawn = 0.25 * corners.iter().sum::<f64>();
            let (lon, lat) = (
                x + i as u32 * step + step / 2,
                y + j as u32 * step + step / 2,
            );
            let data = sound(ground.height_m(lat_rad(lat), lon_rad(lon % AROUND), 0.0));
            most_m = most_m.max((drawn - data).abs());
            for height in corners.into_iter().chain([data]) {
                low_m = low_m.min(height);
                high_m = high_m.max(height);
            }
        }
    }
    // Depth of the chord of a square below the arc, both ways.
    let arc = posts.spacing_rad;
    most_m += chord_m(ellipsoid, arc);
    // Features that the probes have missed, such as a single summit. Only for a source whose ranges become narrower with the bounds.
    let range = ground.range_up_to_m(&cell.bounds(), 0.0);
    let is_telling = cell
        .children()
        .iter()
        .any(|child| ground.range_up_to_m(&child.bounds(), 0.0) != range);
    if is_telling {
        most_m = most_m.max(range.high_m - high_m).max(low_m - range.low_m);
    }
    (most_m.min(BEYOND_M), HeightRange { low_m, high_m })
}

impl Page {
    /// Number of heights that [`Self::build`] reads.
    pub(super) const READS: u64 = (READ * READ) as u64 + (CELLS * CELLS + 8 * CELLS) as u64;

    /// Builds the page of a cell. `reach` is the same for all pages: heights at which all columns contain their corners.
    pub(super) fn build(
        &mut self,
        cell: Cell,
        ground: &dyn Elevation,
        ellipsoid: &Ellipsoid,
        reach: HeightRange,
    ) {
        let posts = Posts::read(cell, ground);
        let (missed_m, range) = missed_m(cell, &posts, ground, ellipsoid);
        let bounds = cell.bounds();
        let spacing_m = posts.spacing_rad * ellipsoid.equatorial_radius_m;
        let tolerance_m = missed_m.clamp(THINNEST * spacing_m, THICKEST * spacing_m);
        self.key = cell.key();
        self.block = cell.block().index();
        self.nodes.clear();
        self.is_last = true;
        let heights = (0..POSTS * POSTS).map(|k| posts.height_m(k % POSTS, k / POSTS) as f32);
        let frame = DemFrame::Geodetic {
            ellipsoid: *ellipsoid,
            bounds,
        };
        let posts_a_side = POSTS as u32;
        let dem = match Dem::new(posts_a_side, posts_a_side, heights.collect(), frame) {
            Ok(dem) => dem.reaching(reach),
            Err(error) => {
                tracing::warn!("a page of contours is left out: {error}");
                return;
            }
        };
        // Building counts each node twice.
        let room = 2 * u64::from(MAX_NODES) * size_of::<Node>() as u64;
        let tree = match ContourTree::build(&dem, tolerance_m, room) {
            Ok(tree) => tree,
            Err(error) => {
                tracing::warn!("a page of contours is left out: {error}");
                return;
            }
        };
        let radius_m = ellipsoid.equatorial_radius_m;
        // Near the poles columns converge, and differences between them are meaningless: use the ground's own slope there.
        let slope = |i: u32, j: u32| {
            let lat_rad = bounds.south_rad + f64::from(j) * posts.spacing_rad;
            let part =
                ((lat_rad.abs() - POLAR_RAD.0) / (POLAR_RAD.1 - POLAR_RAD.0)).clamp(0.0, 1.0);
            if part == 0.0 {
                return posts.slope(lat_rad, radius_m, i, j);
            }
            let lon_rad = bounds.west_rad + f64::from(i) * posts.spacing_rad;
            let of_ground = ground.slope(ellipsoid, lat_rad, lon_rad, posts.spacing_rad);
            let of_ground = if of_ground.is_finite() {
                of_ground
            } else {
                DVec2::ZERO
            };
            if part == 1.0 {
                return of_ground;
            }
            posts.slope(lat_rad, radius_m, i, j).lerp(of_ground, part)
        };
        tree.write_gpu_nodes(&dem, slope, &mut self.nodes);
        self.origin_itrf_m = dem.origin_m();
        let leaves = tree.nodes.iter().filter(|node| node.children == 0);
        // Measured upwards, not along the normal.
        let slabs_m =
            leaves.map(|leaf| leaf.contour.thickness_m() / leaf.contour.normal.dot(dem.up()));
        self.error_m = 0.5 * slabs_m.fold(0.0, f64::max) + missed_m;
        self.border_m = self.border_m(&bounds, (&dem, &tree), ground, ellipsoid);
        let (lat, lon) = (
            0.5 * (bounds.south_rad + bounds.north_rad),
            bounds.west_rad + 0.5 * bounds.width_rad,
        );
        let finest_rad = ground.finest_spacing_rad(lat, lon);
        self.is_last =
            finest_rad.is_finite() && posts.spacing_rad <= 0.5 * finest_rad && cell.level >= ROUND;
        self.enclose(cell, &dem, &tree, ellipsoid, range);
    }

    /// Widens the page to ground of other heights than it was built from, until it is built again. Nothing of that ground is culled, and
    /// adjacent prisms extend down as far as it may be.
    pub(super) fn widen(&mut self, range: HeightRange) {
        let off_m = (range.high_m - self.low_m).max(self.high_m - range.low_m);
        self.border_m = self.border_m.max(off_m);
        let grows_m = (range.high_m - self.high_m).max(self.low_m - range.low_m);
        // Along the normals of the cell's ground, which diverge by far less than 180°.
        self.radius_m += grows_m.max(0.0);
        self.low_m = self.low_m.min(range.low_m);
        self.high_m = self.high_m.max(range.high_m);
    }

    /// Distance between the drawn terrain and the data on the border, metres: at posts and between them.
    fn border_m(
        &self,
        bounds: &Bounds,
        (dem, tree): (&Dem, &ContourTree),
        ground: &dyn Elevation,
        ellipsoid: &Ellipsoid,
    ) -> f64 {
        let top_m = dem.range_m().high_m + 1e5;
        let tall_rad = bounds.north_rad - bounds.south_rad;
        let mut most_m = 0.0f64;
        for k in 0..2 * CELLS {
            // Slightly inside, where columns do not end.
            let part = (f64::from(k) / f64::from(2 * CELLS)).max(1e-4);
            for (u, v) in [
                (part, 1e-4),
                (part, 1.0 - 1e-4),
                (1e-4, part),
                (1.0 - 1e-4, part),
            ] {
                let lat_rad = bounds.south_rad + v * tall_rad;
                let lon_rad = bounds.west_rad + u * bounds.width_rad;
                let up = Ellipsoid::normal(lat_rad, lon_rad);
                let ray = Ray {
                    from_m: ellipsoid.surface_point(up) + up * top_m - dem.origin_m(),
                    towards: -up,
                    most_m: 1e7,
                    cone: 0.0,
                };
                let Some(hit) = tree.cast(dem, &ray) else {
                    return self.error_m;
                };
                let data_m = sound(ground.height_m(lat_rad, lon_rad, 0.0));
                most_m = most_m.max((top_m - hit.distance_m - data_m).abs());
            }
        }
        most_m
    }

    /// The prism and the ball around all drawn terrain.
    fn enclose(
        &mut self,
        cell: Cell,
        dem: &Dem,
        tree: &ContourTree,
        ellipsoid: &Ellipsoid,
        range: HeightRange,
    ) {
        let up = dem.up();
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        for node in &tree.nodes {
            // The parts of planes in convex columns have their extremes at corners.
            for corner in corners_m(&dem.column(node.span), &node.contour) {
                lowest = lowest.min(up.dot(corner));
                highest = highest.max(up.dot(corner));
            }
        }
        // More than the widening of a column, and more than rounding.
        let more_m = 1e-6 * tree.nodes[0].radius_m + 0.01;
        let column = dem.column(dem.span());
        let at = |height_m: f64| {
            let plane = Contour {
                normal: up,
                at_m: up * height_m,
                low_m: 0.0,
                high_m: 0.0,
                support: Support::Plane,
            };
            corners_m(&column, &plane)
        };
        let (below, above) = (at(lowest - more_m), at(highest + more_m));
        for k in 0..4 {
            (self.corners_m[k], self.corners_m[k + 4]) = (below[k], above[k]);
        }
        let east = DVec3::Z.cross(up).try_normalize();
        let east = east.unwrap_or_else(|| up.any_orthonormal_vector());
        self.axes = [east, up.cross(east), up];
        (self.low_m, self.high_m) = (range.low_m, range.high_m);
        let (center_m, radius_m) = ball(ellipsoid, cell, range.low_m, range.high_m);
        self.center_m = center_m;
        self.radius_m = self
            .corners_m
            .iter()
            .map(|corner| center_m.distance(*corner + self.origin_itrf_m))
            .fold(radius_m, f64::max);
    }
}
