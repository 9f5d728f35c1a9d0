//! Measuring the continuity of patches across their edges: position, normal, and the proportion of the paper's theorem.

use super::bezier::Net;
use super::{Leaf, PatchTree, QPatch};
use crate::terrain::qbernstein::QBasis;
use glam::{DVec2, DVec3};
use terrella_ground::globe::contours::dem::{Dem, DemFrame};
use terrella_ground::globe::contours::hermite::cubic;

/// Continuity across the edges of a tree of patches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Continuity {
    /// Shared edges, each as long as the finer of its two patches.
    pub edges: u64,
    /// Of those, between patches of different depth.
    pub across_levels: u64,
    /// Largest distance between the two patches' positions on an edge, metres.
    pub gap_m: f64,
    /// Largest angle between their normals there, radians.
    pub angle_rad: f64,
    /// Largest difference between the finer patch's cross-boundary differences of Bézier control points and α times the
    /// coarser one's, metres.
    pub proportion_m: f64,
    /// Smallest and largest α of an edge.
    pub alpha: (f64, f64),
}

/// The value and both derivatives of a q-Bézier patch, directly from its q-control heights, u and v in 0…1.
pub fn evaluate_q(bases: &[QBasis; 2], patch: &QPatch, u: f64, v: f64) -> [f64; 3] {
    let columns = patch.control_m.map(|c| bases[1].point_and_slope(&c, v));
    let (z, zu) = bases[0].point_and_slope(&columns.map(|c| c.0), u);
    [z, zu, bases[0].point(&columns.map(|c| c.1), u)]
}

/// The piece a…b of a cubic's Bézier values.
fn piece(c: [f64; 4], a: f64, b: f64) -> [f64; 4] {
    let third = (b - a) / 3.0;
    let ((za, da), (zb, db)) = (cubic(c, a), cubic(c, b));
    [za, za + third * da, zb - third * db, zb]
}

impl PatchTree {
    /// Measures every shared edge at `points` points from q-control heights, with each patch evaluated independently. Steps of a grid on the
    /// ellipsoid count with their length in the middle.
    pub fn measure_continuity(&self, dem: &Dem, points: u32) -> Continuity {
        let [columns, rows] = self.size.map(|n| n as usize - 1);
        let step_m = match dem.frame() {
            DemFrame::Flat { step_m } => step_m,
            DemFrame::Geodetic { ellipsoid, bounds } => {
                let lat = 0.5 * (bounds.south_rad + bounds.north_rad);
                let tall = bounds.north_rad - bounds.south_rad;
                let part = DVec2::new(bounds.width_rad * lat.cos(), tall);
                (part * ellipsoid.equatorial_radius_m
                    / DVec2::new(columns.max(1) as f64, rows.max(1) as f64))
                .max(DVec2::splat(1e-3))
            }
        };
        let mut cell = vec![u32::MAX; columns * rows];
        for (k, leaf) in self.leaves.iter().enumerate() {
            let [w, e, s, n] = leaf.span;
            for j in s..n {
                for i in w..e {
                    cell[j as usize * columns + i as usize] = k as u32;
                }
            }
        }
        let mut continuity = Continuity {
            alpha: (f64::INFINITY, 0.0),
            ..Continuity::default()
        };
        let patches: Vec<QPatch> = self.leaves.iter().map(|leaf| self.q_patch(leaf)).collect();
        for (k, leaf) in self.leaves.iter().enumerate() {
            let [w, e, s, n] = leaf.span;
            if w == e || s == n {
                continue;
            }
            for side in 0..4 {
                let (i, j) = match side {
                    0 => (i64::from(w) - 1, i64::from(s)),
                    1 => (i64::from(e), i64::from(s)),
                    2 => (i64::from(w), i64::from(s) - 1),
                    _ => (i64::from(w), i64::from(n)),
                };
                if i < 0 || j < 0 || i >= columns as i64 || j >= rows as i64 {
                    continue;
                }
                let other = cell[j as usize * columns + i as usize] as usize;
                let beside = &self.leaves[other];
                // Measured from the finer side; among equals from the eastern and northern.
                if beside.depth > leaf.depth || beside.depth == leaf.depth && side % 2 == 1 {
                    continue;
                }
                continuity.edges += 1;
                continuity.across_levels += u64::from(beside.depth < leaf.depth);
                self.measure_edge(
                    &mut continuity,
                    step_m,
                    side,
                    points,
                    (leaf, &patches[k]),
                    (beside, &patches[other]),
                );
            }
        }
        continuity
    }

    fn measure_edge(
        &self,
        continuity: &mut Continuity,
        step_m: DVec2,
        side: u32,
        points: u32,
        fine: (&Leaf, &QPatch),
        coarse: (&Leaf, &QPatch),
    ) {
        let normal = |(leaf, patch): (&Leaf, &QPatch), i: f64, j: f64| {
            let [w, e, s, n] = leaf.span.map(f64::from);
            let [z, zu, zv] = evaluate_q(self.bases(), patch, (i - w) / (e - w), (j - s) / (n - s));
            let rise = DVec2::new(zu / (e - w), zv / (n - s)) / step_m;
            (z, DVec3::new(-rise.x, -rise.y, 1.0).normalize())
        };
        let [w, e, s, n] = fine.0.span.map(f64::from);
        for k in 0..points {
            let t = f64::from(k) / f64::from((points - 1).max(1));
            let (i, j) = match side {
                0 => (w, s + (n - s) * t),
                1 => (e, s + (n - s) * t),
                2 => (w + (e - w) * t, s),
                _ => (w + (e - w) * t, n),
            };
            let ((a, na), (b, nb)) = (normal(fine, i, j), normal(coarse, i, j));
            continuity.gap_m = continuity.gap_m.max((a - b).abs());
            continuity.angle_rad = continuity.angle_rad.max(na.cross(nb).length().asin());
        }
        // Cross-boundary first differences of the Bézier nets, both counted from west to east or south to north.
        let turn = |net: Net| -> Net {
            if side < 2 {
                net
            } else {
                std::array::from_fn(|i| std::array::from_fn(|j| net[j][i]))
            }
        };
        let (f, c) = (
            turn(self.bezier_from_q(fine.1)),
            turn(self.bezier_from_q(coarse.1)),
        );
        let [cw, ce, cs, cn] = coarse.0.span.map(f64::from);
        let (along, across) = if side < 2 {
            (
                ((s - cs) / (cn - cs), (n - cs) / (cn - cs)),
                (e - w) / (ce - cw),
            )
        } else {
            (
                ((w - cw) / (ce - cw), (e - cw) / (ce - cw)),
                (n - s) / (cn - cs),
            )
        };
        let (low, high) = (0, 3);
        let difference = |net: &Net, at: usize| -> [f64; 4] {
            let (a, b) = if at == low { (0, 1) } else { (2, 3) };
            std::array::from_fn(|k| net[b][k] - net[a][k])
        };
        let (mine, its) = if side.is_multiple_of(2) {
            (low, high)
        } else {
            (high, low)
        };
        let its = piece(difference(&c, its), along.0, along.1);
        for (a, b) in difference(&f, mine).into_iter().zip(its) {
            continuity.proportion_m = continuity.proportion_m.max((a - across * b).abs());
        }
        continuity.alpha = (
            continuity.alpha.0.min(across),
            continuity.alpha.1.max(across),
        );
    }
}
