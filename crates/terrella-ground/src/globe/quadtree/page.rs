//! A page of the forest: properties of the quarters of a square.

use super::bound::{leaf_error, leaf_range_error};
use super::node::{Node, Point, Square};
use crate::elevation::{Bounds, Elevation, HeightRange};
use glam::DVec3;
use std::f64::consts::PI;
use terrella_frames::Ellipsoid;

/// Number of halvings from a block to the finest possible point: 2 µm on the ground.
pub const DEPTH: u8 = 40;
/// Quarters in a row of a page.
const SIDE: usize = 2;
/// Steps of the lattice that a page is read on: four per quarter.
const STEPS: usize = 4 * SIDE;
/// Posts of a row of that lattice.
const POSTS: usize = STEPS + 1;
/// Ranges of the data in a row of a page, one per two steps.
const RANGES: usize = STEPS / 2;
/// Number of squares of a page. Reading several levels at once would need fewer posts for each, but most would be read for nothing. If a
/// square is almost fine enough, its quarters mostly are.
pub const PAGE_NODES: usize = 4;

/// A range of the data is narrowed if it exceeds this many sides of the square.
const MOST_STEEP: f64 = 8.0;

/// Index of a node among the quarters of its parent.
pub fn quarter(node: Node) -> u32 {
    ((node.y & 1) << 1 | node.x & 1) as u32
}

/// Properties of a square of ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SquareInfo {
    /// Centre of a ball about the ground and all terrain that can be drawn for it, ITRF metres.
    pub center_itrf_m: DVec3,
    /// Radius of that ball.
    pub radius_m: f32,
    /// Largest distance of a drawn point of the undivided square from its point of the data, metres.
    pub error_m: f32,
    /// Lowest height in the square, metres.
    pub low_m: f32,
    /// Highest height in the square, metres.
    pub high_m: f32,
}

impl SquareInfo {
    /// Extends the square to ground of other heights than it was read from. Returns whether the ball has grown.
    pub fn widen(&mut self, node: Node, ellipsoid: &Ellipsoid, range: &HeightRange) -> bool {
        let (low_m, high_m) = (
            f64::from(self.low_m).min(range.low_m),
            f64::from(self.high_m).max(range.high_m),
        );
        let is_wider = low_m < f64::from(self.low_m) || high_m > f64::from(self.high_m);
        if is_wider {
            // Rounded outwards: it is not evaluated again until it is read again.
            self.low_m = (low_m as f32).next_down();
            self.high_m = (high_m as f32).next_up();
            let shape = ball(node, ellipsoid, self.low_m.into(), self.high_m.into());
            self.center_itrf_m = shape.center_itrf_m;
            self.radius_m = rounded_up(shape.radius_m);
        }
        is_wider
    }
}

/// Geodetic latitude and longitude of a point, radians. The poles and the date line are exact.
pub fn lat_lon_rad((x, y): Point) -> (f64, f64) {
    let point_rad = PI / 8.0 / (1_u64 << DEPTH) as f64;
    (0.5 * PI - y as f64 * point_rad, x as f64 * point_rad - PI)
}

/// Side of a square at a level, radians of latitude and of longitude.
pub fn side_rad(level: u8) -> f64 {
    PI / 8.0 / (1_u64 << level) as f64
}

pub fn bounds(square: Square) -> Bounds {
    let (north_rad, west_rad) = lat_lon_rad((square.x, square.y));
    let (south_rad, east_rad) = lat_lon_rad((square.x + square.size, square.y + square.size));
    Bounds {
        south_rad,
        north_rad,
        west_rad,
        width_rad: east_rad - west_rad,
    }
}

/// Converts to single precision with a margin for rounding, so that a bound stays a bound.
fn rounded_up(value: f64) -> f32 {
    (value * (1.0 + 1e-6)).min(f64::from(f32::MAX)) as f32
}

/// Heights of a page's posts and values derived from them; kept, so that reading a page allocates nothing.
pub struct PageReader {
    heights_m: Vec<f64>,
    /// By smallest square, the largest difference between the data between the posts and the finest leaves.
    unseen_m: Vec<f64>,
    /// Range of the data, one for two steps each way.
    ranges_m: Vec<HeightRange>,
    /// Whether the posts are close enough for the data to be smooth between them. If so, `unseen_m` is valid, else `ranges_m`.
    is_smooth: bool,
    /// Whether data between the posts are bounded by their range alone.
    is_certain: bool,
    /// Places read since this was last set to 0.
    pub samples_read: u64,
}

impl PageReader {
    /// A reader that is ready to use.
    pub fn new(is_certain: bool) -> Self {
        Self {
            is_certain,
            heights_m: vec![0.0; POSTS * POSTS],
            unseen_m: vec![0.0; PAGE_NODES],
            ranges_m: vec![
                HeightRange {
                    low_m: 0.0,
                    high_m: 0.0,
                };
                RANGES * RANGES
            ],
            is_smooth: false,
            samples_read: 0,
        }
    }

    /// Reads the squares below a node. Returns the properties of the node itself, and of those squares.
    pub fn read(
        &mut self,
        node: Node,
        ellipsoid: &Ellipsoid,
        ground: &dyn Elevation,
    ) -> (SquareInfo, [SquareInfo; PAGE_NODES]) {
        let square = node.square(DEPTH);
        let step = square.size / STEPS as u64;
        let mut finest_rad = f64::INFINITY;
        for j in 0..POSTS {
            for i in 0..POSTS {
                let point = (square.x + i as u64 * step, square.y + j as u64 * step);
                let (lat, lon) = lat_lon_rad(point);
                self.heights_m[j * POSTS + i] = ground.height_m(lat, lon, 0.0);
                if i % 4 == 0 && j % 4 == 0 {
                    finest_rad = finest_rad.min(ground.finest_spacing_rad(lat, lon));
                }
            }
        }
        self.samples_read += (POSTS * POSTS) as u64;
        self.find_unseen(square, step, finest_rad, ground);
        let mut infos = [SquareInfo {
            center_itrf_m: DVec3::ZERO,
            radius_m: 0.0,
            error_m: 0.0,
            low_m: 0.0,
            high_m: 0.0,
        }; PAGE_NODES];
        for (info, child) in infos.iter_mut().zip(node.children()) {
            let (x, y) = ((child.x & 1) as usize, (child.y & 1) as usize);
            let range = ground.range_up_to_m(&bounds(child.square(DEPTH)), 0.0);
            let range = self.narrowed(child, (4 * x, 4 * y), &range);
            *info = self.info(child, (4 * x, 4 * y), 4, ellipsoid, &range, 0.0);
        }
        let own = infos
            .iter()
            .fold(None, |own: Option<(HeightRange, f64)>, info| {
                let (low_m, high_m) = (f64::from(info.low_m), f64::from(info.high_m));
                let error_m = f64::from(info.error_m);
                Some(own.map_or(
                    (HeightRange { low_m, high_m }, error_m),
                    |(range, error)| {
                        let low_m = low_m.min(range.low_m);
                        let high_m = high_m.max(range.high_m);
                        (HeightRange { low_m, high_m }, error.max(error_m))
                    },
                ))
            });
        let (range, below_m) = own.unwrap_or((
            HeightRange {
                low_m: 0.0,
                high_m: 0.0,
            },
            0.0,
        ));
        let own = self.info(node, (0, 0), STEPS, ellipsoid, &range, below_m);
        (own, infos)
    }

    /// The range of a smallest square. The range of the data covers whole cells between samples. For a square much smaller than a steep
    /// cell, the ball about it would contain the eye, and the square would be divided without end. Where the data are smooth between the
    /// posts, the posts therefore determine the range.
    fn narrowed(&self, node: Node, (x, y): (usize, usize), range: &HeightRange) -> HeightRange {
        let side_m = side_rad(node.level) * Ellipsoid::WGS84.equatorial_radius_m;
        if !self.is_smooth || range.high_m - range.low_m <= MOST_STEEP * side_m {
            return *range;
        }
        let mut low_m = f64::INFINITY;
        let mut high_m = f64::NEG_INFINITY;
        for j in y..=y + 4 {
            for i in x..=x + 4 {
                let height_m = self.height(i, j);
                (low_m, high_m) = (low_m.min(height_m), high_m.max(height_m));
            }
        }
        let unseen_m = self.unseen_m[SIDE * (y / 4) + x / 4];
        HeightRange {
            low_m: (low_m - unseen_m).max(range.low_m),
            high_m: (high_m + unseen_m).min(range.high_m),
        }
    }

    fn height(&self, i: usize, j: usize) -> f64 {
        self.heights_m[j * POSTS + i]
    }

    /// Bounds the data between the posts. If the distance of two posts is at most half that of the data, the data are treated as bilinear
    /// between their own posts. They then bend at most once in two steps along each axis, by at most half of the second differences on both
    /// sides. Elsewhere the range of the data is used.
    fn find_unseen(&mut self, square: Square, step: u64, finest_rad: f64, ground: &dyn Elevation) {
        let step_rad = step as f64 * side_rad(DEPTH);
        self.is_smooth = step_rad <= 0.5 * finest_rad;
        if self.is_smooth {
            for y in 0..SIDE {
                for x in 0..SIDE {
                    self.unseen_m[SIDE * y + x] = self.between_posts(4 * x, 4 * y);
                }
            }
            return;
        }
        for y in 0..RANGES {
            for x in 0..RANGES {
                self.ranges_m[RANGES * y + x] = ground.range_up_to_m(
                    &bounds(Square {
                        x: square.x + 2 * x as u64 * step,
                        y: square.y + 2 * y as u64 * step,
                        size: 2 * step,
                    }),
                    0.0,
                );
            }
        }
    }

    /// Upper bound of the difference between smooth data and triangles between the posts of a smallest square.
    fn between_posts(&self, i0: usize, j0: usize) -> f64 {
        let h = |i: usize, j: usize| self.height(i0 + i, j0 + j);
        let bend = |a: f64, b: f64, c: f64| (a - 2.0 * b + c).abs();
        let (mut along_x, mut along_y, mut twist) = (0.0_f64, 0.0_f64, 0.0_f64);
        for k in 0..=4 {
            for m in 1..4 {
                along_x = along_x.max(bend(h(m - 1, k), h(m, k), h(m + 1, k)));
                along_y = along_y.max(bend(h(k, m - 1), h(k, m), h(k, m + 1)));
            }
        }
        for j in 0..4 {
            for i in 0..4 {
                let all = h(i, j) - h(i + 1, j) - h(i, j + 1) + h(i + 1, j + 1);
                twist = twist.max(all.abs());
            }
        }
        // A bend at the end of a row may appear only beyond it, so the half counts twice.
        along_x + along_y + 0.25 * twist
    }

    /// Upper bound of the difference of any height from a leaf over `steps` × `steps` steps. If the data are finer than the posts and
    /// certainty is not requested, it has three parts. They are the difference at the posts, half of the ground's bend between them, and
    /// the excess of the data beyond the surrounding posts. A ledge that is narrower than a post's step and within the rise of a slope is
    /// then visible only from nearer.
    fn rise_m(&self, x: usize, y: usize, steps: usize) -> f64 {
        let leaf = leaf_error(|i, j| self.height(i, j), x, y, steps);
        if self.is_smooth {
            let smallest = |at: usize| at / 4..(at + steps) / 4;
            let unseen =
                smallest(y).flat_map(|j| smallest(x).map(move |i| self.unseen_m[SIDE * j + i]));
            return leaf.bound + unseen.fold(0.0, f64::max);
        }
        let range = |i: usize, j: usize| {
            let HeightRange { low_m, high_m } = self.ranges_m[RANGES * (j / 2) + i / 2];
            (low_m, high_m)
        };
        if self.is_certain {
            return leaf_range_error(|i, j| self.height(i, j), range, x, y, steps);
        }
        let leaf = leaf_error(|i, j| self.height(i, j), x, y, steps);
        let smallest = |at: usize| (at / 4..(at + steps) / 4).map(|at| 4 * at);
        let bends = smallest(y).flat_map(|j| smallest(x).map(move |i| (i, j)));
        let bend = bends.fold(0.0_f64, |most, (i, j)| most.max(self.between_posts(i, j)));
        let mut beyond = 0.0_f64;
        for j in (y..y + steps).step_by(2) {
            for i in (x..x + steps).step_by(2) {
                let (low, high) = range(i, j);
                let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
                for m in j.saturating_sub(2)..=(j + 4).min(STEPS) {
                    for n in i.saturating_sub(2)..=(i + 4).min(STEPS) {
                        let height = self.height(n, m);
                        (least, most) = (least.min(height), most.max(height));
                    }
                }
                beyond = beyond.max(high - most).max(least - low);
            }
        }
        // Finer ground is assumed to be half as rough at half the step.
        leaf.bound + 0.5 * bend + beyond
    }

    /// Properties of a square of `steps` × `steps` steps from a post. `below_m` is the error of its quarters.
    fn info(
        &self,
        node: Node,
        (x, y): (usize, usize),
        steps: usize,
        ellipsoid: &Ellipsoid,
        range: &HeightRange,
        below_m: f64,
    ) -> SquareInfo {
        let HeightRange { low_m, high_m } = *range;
        let shape = ball(node, ellipsoid, low_m, high_m);
        // The difference from the data is at most the range of the data.
        let rise_m = self.rise_m(x, y, steps).min((high_m - low_m).max(0.0));
        SquareInfo {
            center_itrf_m: shape.center_itrf_m,
            radius_m: rounded_up(shape.radius_m),
            error_m: rounded_up((rise_m + shape.bend_m).max(below_m)),
            low_m: low_m as f32,
            high_m: high_m as f32,
        }
    }
}

/// The ball about a square between two heights.
pub struct Ball {
    /// Centre of the ball, ITRF metres.
    pub center_itrf_m: DVec3,
    pub radius_m: f64,
    /// Upper bound of the departure of triangles between points of the square from the curved ground, from its curvature alone.
    pub bend_m: f64,
}

/// The ball about a node's ground, for heights between `low_m` and `high_m`.
///
/// S(φ, λ) is the ground and b are the weights of a triangle's corners. The departure of the triangle from S is at most
/// ½ Σ bᵢ |D²S[vᵢ − x]|. There |D²S[(p, q)]| ≤ R(p² + 2|pq sin φ| + q² cos φ). Σ bᵢ p² is at most a quarter of the square of the
/// triangle's extent: half the side one way, the side the other way. Heights on diverging normals add half their range times the divergence.
pub fn ball(node: Node, ellipsoid: &Ellipsoid, low_m: f64, high_m: f64) -> Ball {
    let square = node.square(DEPTH);
    let at = |x: u64, y: u64| {
        let (lat, lon) = lat_lon_rad((x, y));
        Ellipsoid::normal(lat, lon)
    };
    let point = |normal: DVec3, height_m: f64| ellipsoid.surface_point(normal) + normal * height_m;
    let (x1, y1) = (square.x + square.size, square.y + square.size);
    let corners = [
        at(square.x, square.y),
        at(x1, square.y),
        at(square.x, y1),
        at(x1, y1),
    ];
    let (middle_x, middle_y) = square.center();
    let center_itrf_m = point(at(middle_x, middle_y), 0.5 * (low_m + high_m));
    let side = side_rad(node.level);
    let (north, south) = (corners[0].z, corners[2].z);
    let sine = north.abs().max(south.abs());
    let across = |z: f64| (1.0 - z * z).max(0.0).sqrt();
    let cosine = if north * south <= 0.0 {
        1.0
    } else {
        across(north).max(across(south))
    };
    // The meridian's radius of curvature is at most a²/b, and it changes slowly.
    let a = ellipsoid.equatorial_radius_m;
    let radius = 1.01 * a * a / ellipsoid.polar_radius_m + low_m.abs().max(high_m.abs());
    let shape = (0.25 + sine + cosine).max(1.0 + sine + 0.25 * cosine);
    let bend_m = radius * side * side / 8.0 * shape + 0.5 * (high_m - low_m) * 0.56 * side;
    let reach = corners
        .iter()
        .flat_map(|normal| [point(*normal, low_m), point(*normal, high_m)])
        .map(|corner| corner.distance(center_itrf_m))
        .fold(0.0, f64::max);
    // The centre is between the corners in the fan: half the range of the heights from its own ends.
    let radius_m = reach.max(0.5 * (high_m - low_m)) + bend_m + 0.01;
    Ball {
        center_itrf_m,
        radius_m,
        bend_m,
    }
}
