//! q-Bézier patches over a DEM: bicubic, G1 across every edge and every difference of levels, within a tolerance of the
//! samples.

use super::dem::{Dem, Span, quarters};
use super::hermite::{Corner, Net, cubic, estimate, net, restrict};
use super::qbernstein::{QBasis, QError};
use super::tree::{BudgetError, ContourTree};

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
}

impl Default for PatchOptions {
    fn default() -> Self {
        Self {
            tolerance_m: 5.0,
            q: [1.0, 1.0],
            budget_bytes: 1 << 30,
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
        let bases = [
            QBasis::new(DEGREE, options.q[0])?,
            QBasis::new(DEGREE, options.q[1])?,
        ];
        let samples = dem.heights_m().len() as u64;
        let over = BudgetError {
            what: "a tree of patches",
            budget_bytes: options.budget_bytes,
        };
        // Two tables of a u32 and one of a byte a sample; a leaf and its share of corners, once more while growing.
        let left = options.budget_bytes.checked_sub(9 * samples).ok_or(over)?;
        let a_leaf = size_of::<Leaf>() + size_of::<Corner>() + 9;
        let most = (left / (2 * a_leaf as u64)).min(u64::from(NONE) - 1) as usize;
        let tolerance_m = options.tolerance_m.max(0.0) + ROUNDING_M;
        let mut open: Vec<(Span, u8)> = vec![(dem.span(), 0)];
        let mut leaves = Vec::new();
        let cells = |[w, e, s, n]: Span| u64::from(e - w).max(1) * u64::from(n - s).max(1);
        let (all, mut done, mut told) = (cells(dem.span()), 0, 0.0f32);
        // With contours: cut wherever they are.
        let mut inner: Vec<Span> = contours.map_or(Vec::new(), |tree| {
            let nodes = tree.nodes.iter().filter(|node| node.children > 0);
            nodes.map(|node| node.span).collect()
        });
        inner.sort_unstable();
        while let Some((span, depth)) = open.pop() {
            let corners = places(span).map(|[i, j]| free(dem, i, j, depth));
            let good = inner.binary_search(&span).is_err()
                && distance_m(dem, span, &corners, tolerance_m).is_some();
            if let Some((spans, count)) = quarters(span).filter(|_| !good) {
                open.extend(spans[..count].iter().map(|span| (*span, depth + 1)));
            } else {
                leaves.push(Leaf {
                    span,
                    depth,
                    corners: [NONE; 4],
                });
                if leaves.len() > most {
                    return Err(over.into());
                }
                done += cells(span);
                let part = 0.7 * done as f32 / all as f32;
                if part > told + 0.01 {
                    told = part;
                    progress(part);
                }
            }
        }
        let mut tree = Self {
            leaves,
            corners: Vec::new(),
            hangs: Vec::new(),
            places: Vec::new(),
            bases,
            size: [dem.columns(), dem.rows()],
            error_m: 0.0,
            rounds: 0,
        };
        loop {
            tree.settle(dem);
            let mut cut = Vec::new();
            tree.error_m = 0.0;
            for (k, leaf) in tree.leaves.iter().enumerate() {
                let corners = leaf.corners.map(|c| tree.corners[c as usize]);
                match distance_m(dem, leaf.span, &corners, tolerance_m) {
                    Some(off) => tree.error_m = tree.error_m.max(off),
                    None if quarters(leaf.span).is_some() => cut.push(k),
                    // A single cell off by more lies on a coarser patch's edge that is off too, and cut now.
                    None => (),
                }
            }
            if cut.is_empty() {
                break;
            }
            tree.rounds += 1;
            progress(0.7 + 0.3 * (1.0 - 0.8f32.powi(tree.rounds as i32)));
            for k in cut {
                let leaf = tree.leaves[k];
                if let Some((spans, count)) = quarters(leaf.span) {
                    let child = |span| Leaf {
                        span,
                        depth: leaf.depth + 1,
                        ..leaf
                    };
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
    fn settle(&mut self, dem: &Dem) {
        self.resettle(&mut |i, j, depth| free(dem, i, j, depth));
    }

    /// The same with free corners from elsewhere, asked for in an order that depends on the leaves alone.
    pub(super) fn resettle(&mut self, free: &mut dyn FnMut(u32, u32, u8) -> Corner) {
        let [columns, rows] = self.size.map(|n| n as usize);
        let at = |[i, j]: [u32; 2]| j as usize * columns + i as usize;
        self.leaves.sort_by_key(|leaf| (leaf.depth, leaf.span));
        self.corners.clear();
        self.hangs.clear();
        self.places.clear();
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
        let mut number = vec![NONE; columns * rows];
        for k in 0..self.leaves.len() {
            for (c, place) in places(self.leaves[k].span).into_iter().enumerate() {
                let index = at(place);
                if number[index] == NONE {
                    number[index] = self.corners.len() as u32;
                    let corner = match owner[index] {
                        NONE => free(place[0], place[1], finest[index]),
                        owner => self.hanging(owner, place),
                    };
                    self.corners.push(corner);
                    self.hangs.push(owner[index] != NONE);
                    self.places.push(place);
                }
                self.leaves[k].corners[c] = number[index];
            }
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
