//! q-Bézier patches over a DEM: bicubic, G1 across every edge and every difference of levels, within a tolerance of the
//! samples.
//!
//! | file | content |
//! |---|---|
//! | `fit.rs` | subdivision until patches are within the tolerance |
//! | `bezier.rs` | patches by their control heights |
//! | `continuity.rs` | continuity between neighbours |
//! | `serialize.rs` | patches as bytes |

mod bezier;
mod continuity;
mod fit;
#[cfg(test)]
mod tests;

pub use bezier::{Net, evaluate};
pub use continuity::{Continuity, evaluate_q};

use super::contours::{BudgetError, ContourTree};
use super::qbernstein::{QBasis, QError};
use super::workers::Workers;
use bezier::{converted, net};
use fit::{Fitting, PART_LEAVES, free, leaf_of, places};
use terrella_ground::globe::contours::dem::{Dem, Span, quarters};
use terrella_ground::globe::contours::hermite::{Corner, restrict};

/// Degree of the patches each way.
pub const DEGREE: usize = 3;
const NONE: u32 = u32::MAX;

/// Options for building patches.
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

/// Control heights of a patch in the q-Bernstein bases of its tree. Its control points are at `[i]/[3]` of the span.
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

/// Most that a leaf takes while patches are built: itself twice, while the list of leaves grows, and five thirds of a corner,
/// which is held twice when it is new. A corner has a place, an owner, a depth and whether it hangs: 14 bytes.
const LEAF_BYTES: usize = 2 * size_of::<Leaf>() + (2 * size_of::<Corner>() + 14) * 5 / 3;

impl PatchTree {
    /// Builds patches. Spans are subdivided until a patch is within the tolerance of its samples, starting from the whole grid, or from the leaves
    /// of `contours` as in the paper. Then corners inside coarser edges are constrained to those, and patches that thereby exceed the tolerance are
    /// subdivided too, until none is left. `progress` receives 0…1.
    pub fn build(
        dem: &Dem,
        contours: Option<&ContourTree>,
        options: &PatchOptions,
        progress: &mut dyn FnMut(f32),
    ) -> Result<Self, PatchError> {
        // Rejected before any work.
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
        let max_leaves = (left / LEAF_BYTES as u64).min(u64::from(NONE) / 2) as usize;
        let workers = Workers::new(options.threads);
        let fitting = Fitting::new(dem, contours, options.tolerance_m, max_leaves, &workers);
        let mut tree = Self::of_leaves(
            fitting.leaves(progress).ok_or(over)?,
            [dem.columns(), dem.rows()],
            options.q,
        )?;
        loop {
            tree.settle(dem, &workers);
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
            if tree.leaves.len() > max_leaves {
                return Err(over.into());
            }
        }
        progress(1.0);
        Ok(tree)
    }

    /// Gives all leaves their corners: free ones from the samples, hanging ones from the coarser edge.
    fn settle(&mut self, dem: &Dem, workers: &Workers) {
        let (owners, depths) = self.number();
        let all = &self.places;
        let parts = workers.map(
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

    /// Orders the leaves and numbers their corners. Returns for each corner the leaf inside whose edge it lies, and the depth of the finest leaf
    /// around it.
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

    /// Sets all corners, in the order of their numbers: free ones from `next`, hanging ones from their owners, whose corners have smaller numbers.
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

    /// A tree whose leaves have no corners yet: [`Self::settle`] finds them.
    fn of_leaves(leaves: Vec<Leaf>, size: [u32; 2], q: [f64; 2]) -> Result<Self, QError> {
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
        let control_m = converted(&self.bezier(leaf), &along_u, &along_v);
        QPatch { control_m }
    }

    /// Bézier heights from q-Bézier ones.
    pub fn bezier_from_q(&self, patch: &QPatch) -> Net {
        let [along_u, along_v] = self.bases.map(|basis| basis.bernstein_from_q());
        converted(&patch.control_m, &along_u, &along_v)
    }

    /// Bytes of the patches packed: four f32 for each free corner, and one bit for each node of the tree. Hanging corners follow from
    /// the others.
    pub fn packed_bytes(&self) -> u64 {
        let free = self.hangs.iter().filter(|hangs| !**hangs).count() as u64;
        let mut spans: Vec<Span> = self.leaves.iter().map(|leaf| leaf.span).collect();
        spans.sort_unstable();
        let [columns, rows] = self.size;
        let mut nodes = 0_u64;
        let mut stack = vec![[0, columns - 1, 0, rows - 1]];
        while let Some(span) = stack.pop() {
            nodes += 1;
            if spans.binary_search(&span).is_err()
                && let Some((children, count)) = quarters(span)
            {
                stack.extend(&children[..count]);
            }
        }
        16 * free + nodes.div_ceil(8)
    }

    /// Memory held, bytes.
    pub fn bytes(&self) -> u64 {
        (self.leaves.len() * size_of::<Leaf>()
            + self.corners.len() * (size_of::<Corner>() + size_of::<[u32; 2]>() + 1)) as u64
    }
}
