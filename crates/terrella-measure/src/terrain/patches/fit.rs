//! Cutting spans until a patch is within the tolerance of its samples.

use super::bezier::net;
use super::{Leaf, NONE, PatchTree};
use crate::terrain::workers::{PART_CELLS, Workers};
use std::sync::atomic::{AtomicUsize, Ordering};
use terrella_ground::globe::contours::dem::{Dem, Span, cells, quarters};
use terrella_ground::globe::contours::hermite::{Corner, cubic, estimate};
use terrella_ground::globe::contours::tree::ContourTree;

/// South-west, south-east, north-west, north-east.
pub fn places([w, e, s, n]: Span) -> [[u32; 2]; 4] {
    [[w, s], [e, s], [w, n], [e, n]]
}

/// A free corner: the sample, and differences over the width of a cell of its depth. Single precision, as it is stored.
pub fn free(dem: &Dem, i: u32, j: u32, depth: u8) -> Corner {
    let reach = |k: u32, last: u32| {
        let step = (i64::from(last) >> depth.min(62)).max(1);
        let k = i64::from(k);
        [(k - step).max(0), k, (k + step).min(i64::from(last))]
    };
    let (x, y) = (reach(i, dem.columns() - 1), reach(j, dem.rows() - 1));
    let steps = |x: [i64; 3]| [(x[1] - x[0]) as f64, (x[2] - x[1]) as f64];
    let heights = y.map(|j| x.map(|i| dem.height_m(i, j)));
    estimate(&heights, steps(x), steps(y)).map(|x| f64::from(x as f32))
}

/// Cuts spans until their patches fit.
pub struct Fitting<'a> {
    dem: &'a Dem,
    /// Spans that are cut whatever their patch, in order.
    inner: Vec<Span>,
    tolerance_m: f64,
    workers: &'a Workers,
    /// Number of leaves so far, of all parts.
    count: AtomicUsize,
    max_leaves: usize,
}

/// Rounding of heights to ±10⁶ m through a dozen operations.
const ROUNDING_M: f64 = 4e-9;

/// Leaves, or corners, that a thread takes at a time.
pub const PART_LEAVES: usize = 1 << 14;

impl<'a> Fitting<'a> {
    /// For patches over a grid that are subdivided at least as far as `contours`, at most `max_leaves` of them.
    pub fn new(
        dem: &'a Dem,
        contours: Option<&ContourTree>,
        tolerance_m: f64,
        max_leaves: usize,
        workers: &'a Workers,
    ) -> Self {
        Self {
            dem,
            inner: contours.map_or(Vec::new(), inner),
            tolerance_m: tolerance_m.max(0.0) + ROUNDING_M,
            workers,
            count: AtomicUsize::new(0),
            max_leaves,
        }
    }

    /// The leaves, by free corners alone; `None` if they are too many. `progress` hears 0…0.7.
    pub fn leaves(&self, progress: &mut dyn FnMut(f32)) -> Option<Vec<Leaf>> {
        // Coarse spans level by level, until they are small enough to be parts.
        let (mut leaves, mut parts) = (Vec::new(), Vec::new());
        let mut level = vec![(self.dem.span(), 0)];
        while !level.is_empty() {
            let (small, large): (Vec<_>, Vec<_>) = level
                .into_iter()
                .partition(|(span, _)| cells(*span) <= PART_CELLS);
            parts.extend(small);
            let cuts = self.workers.map(
                large.len(),
                |k| self.cut(large[k].0, large[k].1),
                &mut |_| (),
            );
            level = Vec::new();
            for ((span, depth), cut) in large.into_iter().zip(cuts) {
                match cut {
                    Some((spans, count)) => {
                        level.extend(spans[..count].iter().map(|span| (*span, depth + 1)));
                    }
                    None => {
                        leaves.push(leaf_of(span, depth));
                        self.count.fetch_add(1, Ordering::Relaxed);
                    }
                }
            }
        }
        let all = cells(self.dem.span());
        let mut done = leaves.iter().map(|leaf| cells(leaf.span)).sum::<u64>();
        let found = self
            .workers
            .map(parts.len(), |k| self.part(parts[k]), &mut |k| {
                done += cells(parts[k].0);
                progress(0.7 * done as f32 / all as f32);
            });
        if found.iter().any(Option::is_none) || self.count.load(Ordering::Relaxed) > self.max_leaves
        {
            return None;
        }
        leaves.reserve_exact(self.count.load(Ordering::Relaxed));
        for part in found.into_iter().flatten() {
            leaves.extend(part);
        }
        Some(leaves)
    }

    /// The leaves of a span; `None` once there are too many.
    fn part(&self, whole: (Span, u8)) -> Option<Vec<Leaf>> {
        let (mut open, mut leaves) = (vec![whole], Vec::new());
        while let Some((span, depth)) = open.pop() {
            if let Some((spans, count)) = self.cut(span, depth) {
                open.extend(spans[..count].iter().map(|span| (*span, depth + 1)));
                continue;
            }
            leaves.push(leaf_of(span, depth));
            if self.count.fetch_add(1, Ordering::Relaxed) >= self.max_leaves {
                return None;
            }
        }
        leaves.shrink_to_fit();
        Some(leaves)
    }

    /// The quarters of a span whose patch is beyond the tolerance.
    fn cut(&self, span: Span, depth: u8) -> Option<([Span; 4], usize)> {
        let spans = quarters(span)?;
        let must = self.inner.binary_search(&span).is_ok();
        let fits = || {
            let corners = places(span).map(|[i, j]| free(self.dem, i, j, depth));
            distance_m(self.dem, span, &corners, self.tolerance_m).is_some()
        };
        (must || !fits()).then_some(spans)
    }

    /// The largest error of the settled leaves that fit, metres, and those that do not and can be cut.
    pub fn check(&self, tree: &PatchTree) -> (f64, Vec<usize>) {
        let parts = self.workers.map(
            tree.leaves.len().div_ceil(PART_LEAVES),
            |part| {
                let from = part * PART_LEAVES;
                let to = tree.leaves.len().min(from + PART_LEAVES);
                let (mut error_m, mut cut) = (0.0f64, Vec::new());
                for (k, leaf) in (from..to).zip(&tree.leaves[from..to]) {
                    let corners = leaf.corners.map(|c| tree.corners[c as usize]);
                    match distance_m(self.dem, leaf.span, &corners, self.tolerance_m) {
                        Some(off) => error_m = error_m.max(off),
                        None if quarters(leaf.span).is_some() => cut.push(k),
                        // A single cell with a larger error is on a coarser patch's edge that is off too, and will be subdivided now.
                        None => (),
                    }
                }
                (error_m, cut)
            },
            &mut |_| (),
        );
        let error_m = parts.iter().map(|part| part.0).fold(0.0, f64::max);
        (error_m, parts.into_iter().flat_map(|part| part.1).collect())
    }
}

pub fn leaf_of(span: Span, depth: u8) -> Leaf {
    Leaf {
        span,
        depth,
        corners: [NONE; 4],
    }
}

/// Spans that contours are cut at, in order.
fn inner(contours: &ContourTree) -> Vec<Span> {
    let nodes = contours.nodes.iter().filter(|node| node.children > 0);
    let mut spans: Vec<Span> = nodes.map(|node| node.span).collect();
    spans.sort_unstable();
    spans
}

/// Largest distance of a patch from its samples; `None` as soon as one is beyond the tolerance.
fn distance_m(dem: &Dem, span: Span, corners: &[Corner; 4], tolerance_m: f64) -> Option<f64> {
    let [w, e, s, n] = span;
    let (width, height) = (f64::from(e - w), f64::from(n - s));
    let net = net(corners, width, height);
    let part = |k: u32, by: f64| if by > 0.0 { f64::from(k) / by } else { 0.0 };
    // An eighth of the samples each way first: most spans that fail, fail there.
    let steps = if (e - w).max(n - s) > 8 {
        &[8, 1][..]
    } else {
        &[1][..]
    };
    let mut worst = 0.0f64;
    for divisor in steps {
        let step = |cells: u32| if *divisor == 8 { (cells / 8).max(1) } else { 1 } as usize;
        worst = 0.0;
        for j in (s..=n).step_by(step(n - s)) {
            let row = net.map(|column| cubic(column, part(j - s, height)).0);
            let from = j as usize * dem.columns() as usize;
            let samples = &dem.heights_m()[from + w as usize..=from + e as usize];
            for (k, sample) in samples.iter().enumerate().step_by(step(e - w)) {
                let z = cubic(row, part(k as u32, width)).0;
                worst = worst.max((z - f64::from(*sample)).abs());
            }
            if worst > tolerance_m {
                return None;
            }
        }
    }
    Some(worst)
}
