//! q-Bézier patches over a DEM: bicubic, G1 across every edge and every difference of levels, within a tolerance of the
//! samples.

use super::dem::{Dem, PART_CELLS, Span, cells, quarters};
use super::hermite::{Corner, Net, cubic, estimate, net, restrict};
use super::qbernstein::{QBasis, QError};
use super::threads::in_parts;
use super::tree::{BudgetError, ContourTree};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Degree of the patches each way.
pub const DEGREE: usize = 3;
const NONE: u32 = u32::MAX;

/// What patches are built by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchOptions {
    /// Most vertical distance between a patch and the samples inside it or on its edge, metres. At 0 patches shrink to
    /// single cells wherever a larger one is not exact, and every sample is met to rounding.
    pub tolerance_m: f64,
    /// q along u (eastwards) and along v (northwards) of the control values. It changes these, not the surface.
    pub q: [f64; 2],
    /// Most memory while building, bytes.
    pub budget_bytes: u64,
    /// Threads that build, 1 or more. The patches are the same to the last bit.
    pub threads: usize,
}

impl Default for PatchOptions {
    fn default() -> Self {
        Self {
            tolerance_m: 5.0,
            q: [1.0, 1.0],
            budget_bytes: 1 << 30,
            threads: 1,
        }
    }
}

/// Patches that cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PatchError {
    /// Too large.
    #[error(transparent)]
    Budget(#[from] BudgetError),
    /// No such basis.
    #[error(transparent)]
    Basis(#[from] QError),
}

/// One patch: a span of samples and its four corners in [`PatchTree::corners`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leaf {
    /// Samples at its edges.
    pub span: Span,
    /// South-west, south-east, north-west, north-east.
    pub corners: [u32; 4],
    /// Cuts from the whole grid.
    pub depth: u8,
}

/// Control heights of a patch in the q-Bernstein bases of its tree. Its control points lie at
/// `[i]/[3]` of the way across.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QPatch {
    /// Heights, metres, `[along u][along v]`.
    pub control_m: Net,
}

/// Patches that tile a DEM.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchTree {
    /// Coarse ones first.
    pub leaves: Vec<Leaf>,
    /// Heights and derivatives by lattice steps at the patches' corners.
    pub corners: Vec<Corner>,
    /// Of each corner, whether it hangs in the edge of a coarser patch (and follows from that).
    pub hangs: Vec<bool>,
    /// Sample of each corner.
    pub places: Vec<[u32; 2]>,
    bases: [QBasis; 2],
    /// Columns and rows of the grid.
    pub size: [u32; 2],
    /// Largest vertical distance from a sample, metres.
    pub error_m: f64,
    /// Times that patches were cut because their corners had to follow a coarser edge.
    pub rounds: u32,
}

/// Leaves, or corners, that a thread takes at a time.
const PART_LEAVES: usize = 1 << 14;

/// Most that a leaf takes while patches are built: itself twice, while the list of leaves grows, and five thirds of a corner,
/// which is held twice when it is new. A corner has a place, an owner, a depth and whether it hangs: 14 bytes.
const LEAF_BYTES: usize = 2 * size_of::<Leaf>() + (2 * size_of::<Corner>() + 14) * 5 / 3;

/// Rounding of heights to ±10⁶ m through a dozen operations.
const ROUNDING_M: f64 = 4e-9;

impl PatchTree {
    /// Builds patches. Spans are cut until a patch is within the tolerance of its samples; they begin with the whole grid,
    /// or with the leaves of `contours` as in the paper. Then corners inside coarser edges follow those, and patches that
    /// this takes out of the tolerance are cut too, until none is left. `progress` hears 0…1.
    pub fn build(
        dem: &Dem,
        contours: Option<&ContourTree>,
        options: &PatchOptions,
        progress: &mut dyn FnMut(f32),
    ) -> Result<Self, PatchError> {
        // Refused before any work.
        options
            .q
            .iter()
            .try_for_each(|q| QBasis::new(DEGREE, *q).map(drop))?;
        let samples = dem.heights_m().len() as u64;
        let over = BudgetError {
            what: "a tree of patches",
            budget_bytes: options.budget_bytes,
        };
        // Two tables of a u32 and one of a byte a sample.
        let left = options.budget_bytes.checked_sub(9 * samples).ok_or(over)?;
        let most = (left / LEAF_BYTES as u64).min(u64::from(NONE) / 2) as usize;
        let fitting = Fitting {
            dem,
            // With contours: cut wherever they are.
            inner: contours.map_or(Vec::new(), inner),
            tolerance_m: options.tolerance_m.max(0.0) + ROUNDING_M,
            threads: options.threads,
            count: AtomicUsize::new(0),
            most,
        };
        let mut tree = Self::of_leaves(
            fitting.leaves(progress).ok_or(over)?,
            [dem.columns(), dem.rows()],
            options.q,
        )?;
        loop {
            tree.settle(dem, options.threads);
            let (error_m, cut) = fitting.check(&tree);
            tree.error_m = error_m;
            if cut.is_empty() {
                break;
            }
            tree.rounds += 1;
            progress(0.7 + 0.3 * (1.0 - 0.8f32.powi(tree.rounds as i32)));
            for k in cut {
                let leaf = tree.leaves[k];
                if let Some((spans, count)) = quarters(leaf.span) {
                    let child = |span| leaf_of(span, leaf.depth + 1);
                    tree.leaves[k] = child(spans[0]);
                    tree.leaves
                        .extend(spans[1..count].iter().map(|s| child(*s)));
                }
            }
            if tree.leaves.len() > most {
                return Err(over.into());
            }
        }
        progress(1.0);
        Ok(tree)
    }

    /// Gives all leaves their corners: free ones from the samples, hanging ones from the coarser edge.
    fn settle(&mut self, dem: &Dem, threads: usize) {
        let (owners, depths) = self.number();
        let all = &self.places;
        let parts = in_parts(
            threads,
            owners.len().div_ceil(PART_LEAVES),
            |part| {
                let from = part * PART_LEAVES;
                let to = owners.len().min(from + PART_LEAVES);
                let corner = |k: usize| match owners[k] {
                    NONE => free(dem, all[k][0], all[k][1], depths[k]),
                    _ => Corner::default(),
                };
                (from..to).map(corner).collect::<Vec<_>>()
            },
            &mut |_| (),
        );
        let mut free = parts.into_iter().flatten();
        self.set_corners(&owners, |_| free.next().unwrap_or_default());
    }

    /// The same with free corners from elsewhere, asked for in an order that depends on the leaves alone.
    pub(super) fn resettle(&mut self, free: &mut dyn FnMut() -> Corner) {
        let (owners, _) = self.number();
        self.set_corners(&owners, |owner| match owner {
            NONE => free(),
            _ => Corner::default(),
        });
    }

    /// Puts leaves in order and numbers their corners. Answers of each corner the leaf inside whose edge it lies, and the depth
    /// of the finest leaf about it.
    fn number(&mut self) -> (Vec<u32>, Vec<u8>) {
        let [columns, rows] = self.size.map(|n| n as usize);
        let at = |[i, j]: [u32; 2]| j as usize * columns + i as usize;
        // Leaves of one depth that begin at one place are one and the same.
        self.leaves
            .sort_unstable_by_key(|leaf| (leaf.depth, leaf.span[0], leaf.span[2]));
        // The leaf inside whose edge a sample lies, then the number of a corner.
        let mut owner = vec![NONE; columns * rows];
        let mut finest = vec![0u8; columns * rows];
        for (k, leaf) in self.leaves.iter().enumerate() {
            let [w, e, s, n] = leaf.span;
            for i in w + 1..e.max(w + 1) {
                owner[at([i, s])] = k as u32;
                owner[at([i, n])] = k as u32;
            }
            for j in s + 1..n.max(s + 1) {
                owner[at([w, j])] = k as u32;
                owner[at([e, j])] = k as u32;
            }
            for place in places(leaf.span) {
                let depth = &mut finest[at(place)];
                *depth = (*depth).max(leaf.depth);
            }
        }
        // Four of the first leaf; a cut that makes three leaves more makes five corners more at most.
        let most = (4 + self.leaves.len() * 5 / 3).min(columns * rows);
        let (mut owners, mut depths) = (Vec::with_capacity(most), Vec::with_capacity(most));
        self.places = Vec::with_capacity(most);
        let mut number = vec![NONE; columns * rows];
        for leaf in &mut self.leaves {
            for (place, corner) in places(leaf.span).into_iter().zip(&mut leaf.corners) {
                let index = at(place);
                if number[index] == NONE {
                    number[index] = self.places.len() as u32;
                    self.places.push(place);
                    owners.push(owner[index]);
                    depths.push(finest[index]);
                }
                *corner = number[index];
            }
        }
        (owners, depths)
    }

    /// Sets all corners, in the order of their numbers: free ones as `next` says, hanging ones by their owners, whose corners
    /// have smaller numbers.
    fn set_corners(&mut self, owners: &[u32], mut next: impl FnMut(u32) -> Corner) {
        self.corners = Vec::with_capacity(owners.len());
        self.hangs = owners.iter().map(|owner| *owner != NONE).collect();
        for (k, owner) in owners.iter().enumerate() {
            let given = next(*owner);
            let corner = match *owner {
                NONE => given,
                owner => self.hanging(owner, self.places[k]),
            };
            self.corners.push(corner);
        }
    }

    /// A corner at a place inside an edge of a coarser leaf, whose own corners are settled: coarse leaves come first.
    fn hanging(&self, owner: u32, [i, j]: [u32; 2]) -> Corner {
        let leaf = &self.leaves[owner as usize];
        let [w, e, s, n] = leaf.span;
        let corner = |k: usize| &self.corners[leaf.corners[k] as usize];
        if j == s || j == n {
            let (a, b) = if j == s { (0, 1) } else { (2, 3) };
            let steps = f64::from(e - w);
            restrict(corner(a), corner(b), steps, f64::from(i - w) / steps, true)
        } else {
            let (a, b) = if i == w { (0, 2) } else { (1, 3) };
            let steps = f64::from(n - s);
            restrict(corner(a), corner(b), steps, f64::from(j - s) / steps, false)
        }
    }

    /// An empty tree for [`Self::resettle`].
    pub(super) fn of_leaves(
        leaves: Vec<Leaf>,
        size: [u32; 2],
        q: [f64; 2],
    ) -> Result<Self, QError> {
        Ok(Self {
            leaves,
            corners: Vec::new(),
            hangs: Vec::new(),
            places: Vec::new(),
            bases: [QBasis::new(DEGREE, q[0])?, QBasis::new(DEGREE, q[1])?],
            size,
            error_m: 0.0,
            rounds: 0,
        })
    }

    /// The bases along u and along v.
    pub fn bases(&self) -> &[QBasis; 2] {
        &self.bases
    }

    /// Bézier heights of a patch, metres.
    pub fn bezier(&self, leaf: &Leaf) -> Net {
        let [w, e, s, n] = leaf.span;
        let corners = leaf.corners.map(|c| self.corners[c as usize]);
        net(&corners, f64::from(e - w), f64::from(n - s))
    }

    /// q-Bézier heights of a patch, metres: M⁻¹ of each basis each way.
    pub fn q_patch(&self, leaf: &Leaf) -> QPatch {
        let [along_u, along_v] = self.bases.map(|basis| basis.q_from_bernstein());
        let control_m = both_ways(&self.bezier(leaf), &along_u, &along_v);
        QPatch { control_m }
    }

    /// Bézier heights again from q-Bézier ones.
    pub fn bezier_from_q(&self, patch: &QPatch) -> Net {
        let [along_u, along_v] = self.bases.map(|basis| basis.bernstein_from_q());
        both_ways(&patch.control_m, &along_u, &along_v)
    }

    /// Memory held, bytes.
    pub fn bytes(&self) -> u64 {
        (self.leaves.len() * size_of::<Leaf>()
            + self.corners.len() * (size_of::<Corner>() + size_of::<[u32; 2]>() + 1)) as u64
    }
}

fn both_ways(
    net: &Net,
    along_u: &super::qbernstein::Conversion,
    along_v: &super::qbernstein::Conversion,
) -> Net {
    let columns = net.map(|column| along_v.apply(&column));
    let mut out = [[0.0; 4]; 4];
    for j in 0..4 {
        let row = along_u.apply(&columns.map(|column| column[j]));
        for i in 0..4 {
            out[i][j] = row[i];
        }
    }
    out
}

/// South-west, south-east, north-west, north-east.
pub(super) fn places([w, e, s, n]: Span) -> [[u32; 2]; 4] {
    [[w, s], [e, s], [w, n], [e, n]]
}

/// A free corner: the sample, and differences over the width of a cell of its depth. Single precision, as it is stored.
fn free(dem: &Dem, i: u32, j: u32, depth: u8) -> Corner {
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
struct Fitting<'a> {
    dem: &'a Dem,
    /// Spans that are cut whatever their patch, in order.
    inner: Vec<Span>,
    tolerance_m: f64,
    threads: usize,
    /// Leaves so far, of all parts.
    count: AtomicUsize,
    most: usize,
}

impl Fitting<'_> {
    /// The leaves, by free corners alone; `None` if they are too many. `progress` hears 0…0.7.
    fn leaves(&self, progress: &mut dyn FnMut(f32)) -> Option<Vec<Leaf>> {
        // Coarse spans level by level, until they are small enough to be parts.
        let (mut leaves, mut parts) = (Vec::new(), Vec::new());
        let mut level = vec![(self.dem.span(), 0)];
        while !level.is_empty() {
            let (small, large): (Vec<_>, Vec<_>) = level
                .into_iter()
                .partition(|(span, _)| cells(*span) <= PART_CELLS);
            parts.extend(small);
            let cuts = in_parts(
                self.threads,
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
        let found = in_parts(
            self.threads,
            parts.len(),
            |k| self.part(parts[k]),
            &mut |k| {
                done += cells(parts[k].0);
                progress(0.7 * done as f32 / all as f32);
            },
        );
        if found.iter().any(Option::is_none) || self.count.load(Ordering::Relaxed) > self.most {
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
            if self.count.fetch_add(1, Ordering::Relaxed) >= self.most {
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
    fn check(&self, tree: &PatchTree) -> (f64, Vec<usize>) {
        let parts = in_parts(
            self.threads,
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
                        // A single cell off by more lies on a coarser patch's edge that is off too, and cut now.
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

fn leaf_of(span: Span, depth: u8) -> Leaf {
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
