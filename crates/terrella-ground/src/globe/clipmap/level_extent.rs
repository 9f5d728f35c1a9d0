//! Distances between points of the lattice, and the points within a level's extent.
//!
//! The distance is counted on the globe's own lattice, not on a plane. It does not depend on which diamond is home, so a change of home
//! changes nothing. An extent's radius is at most half a diamond's edge, so it includes at most one corner.

use super::Trim;
use super::lattice::{DiamondCorner, LatticeIndex, Triangle};

/// Largest number of diamonds within an extent: those about a pole.
const MOST: usize = 5;

/// A range from `least` to `most`, both inclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexBox {
    /// Least i and j.
    pub least: (i64, i64),
    /// Greatest i and j.
    pub most: (i64, i64),
}

/// All points within a number of steps of a middle.
///
/// [`Trim::Diamond`]: a step goes to any point of the same cell, like a king in chess. The points are a square of the lattice. About a
/// corner of three diamonds, one corner of the square is missing; about a pole it is there twice, smaller. [`Trim::Hexagon`]: a step
/// follows an edge of a triangle. The points are a hexagon; about the icosahedron's corners a pentagon.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LevelExtent {
    pub middle: LatticeIndex,
    /// Cells along a diamond's edge.
    pub n: i64,
    /// Number of steps, n/2 at most.
    pub radius: i64,
    trim: Trim,
    /// The home's corner nearest to the middle, then the same corner in each diamond to the left, as many as meet there.
    sectors: [DiamondCorner; MOST],
    valence: usize,
    /// The middle's steps from that corner along the home's first and second edge.
    a: i64,
    b: i64,
}

impl LevelExtent {
    /// All points within `radius` steps of `middle`, in a lattice of `n` cells.
    pub fn new(middle: LatticeIndex, n: i64, radius: i64, trim: Trim) -> Self {
        let home = DiamondCorner::nearest(middle, n);
        let (a, b) = home.steps(middle.i, middle.j, n);
        let mut sectors = [home; MOST];
        for s in 1..MOST {
            sectors[s] = sectors[s - 1].left();
        }
        Self {
            middle,
            n,
            radius,
            trim,
            sectors,
            valence: home.valence(),
            a,
            b,
        }
    }

    /// The same extent in a lattice half as fine; the middle must be even.
    pub fn halved(&self) -> Self {
        Self::new(self.middle.halved(), self.n / 2, self.radius / 2, self.trim)
    }

    /// Steps from the middle to a point; `None` if its diamond is out of reach. Exact for points within n/2 steps, never less than that for
    /// others.
    pub fn distance(&self, index: LatticeIndex) -> Option<i64> {
        Some(self.in_diamond(index.diamond)?.distance(index.i, index.j))
    }

    /// King's moves from the middle to (p, q) of sector `s`: round the corner either way, or over it.
    fn king(&self, s: usize, p: i64, q: i64) -> i64 {
        let (a, b) = (self.a, self.b);
        let far = a.max(b);
        match (self.valence, s) {
            (_, 0) => (p - a).abs().max((q - b).abs()),
            (5, 1) => (a + q).max((p - b).abs()),
            (5, 2) => (a + p).max(far + q),
            (5, 3) => (far + p).max(b + q),
            (5, _) => (b + p).max((q - a).abs()),
            (_, 1) => (a + q).max((p - b).abs()).min((b + q).max(far + p)),
            (_, _) => (b + p).max((q - a).abs()).min((a + p).max(far + q)),
        }
    }

    /// Triangle edges from the middle to (p, q) of sector `s`: five wedges of 60° about the corner, unrolled both ways.
    fn hex(&self, s: usize, p: i64, q: i64) -> i64 {
        let (home, u0, t0) = self.wedge(0, self.a, self.b);
        let (wedge, u, t) = self.wedge(s, p, q);
        // Edges in the plane of the home wedge's edges e0, e1 at 60°, by rotations of 60° to the left.
        const EDGES: [(i64, i64); 7] = [(1, 0), (0, 1), (-1, 1), (-1, 0), (0, -1), (1, -1), (1, 0)];
        let over = u0 + t0 + u + t;
        let turn = (wedge + 5 - home) % 5;
        let mut best = over;
        for (edge, left) in [(turn, true), ((turn + 1) % 6, false)] {
            // To the right, the last of the five wedges is the sixth of the plane's six.
            if turn == 0 && !left {
                continue;
            }
            let ((ux, uy), (tx, ty)) = (EDGES[edge], EDGES[edge + 1]);
            let (x, y) = (u * ux + t * tx, u * uy + t * ty);
            let side = u0 * y - t0 * x;
            // The straight path is valid only if it passes the corner on the correct side; within one wedge it always is.
            if turn == 0 || (left && side >= 0 && turn <= 3) || (!left && side <= 0 && turn >= 2) {
                let (dx, dy) = (x - u0, y - t0);
                best = best.min(dx.abs().max(dy.abs()).max((dx + dy).abs()));
            }
        }
        best
    }

    /// The wedge of the five about the corner that contains (p, q) of sector `s`, and the steps along its two edges.
    fn wedge(&self, s: usize, p: i64, q: i64) -> (usize, i64, i64) {
        let before = self.sectors[..s]
            .iter()
            .map(|corner| if corner.narrow() { 1 } else { 2 })
            .sum();
        if self.sectors[s].narrow() {
            (before, p, q)
        } else if p >= q {
            (before, p - q, q)
        } else {
            (before + 1, p, q - p)
        }
    }

    /// The diamonds that the extent covers by more than an edge, each with the box of (i, j) that contains its points there.
    pub fn boxes(&self) -> impl Iterator<Item = (u8, IndexBox)> + '_ {
        (0..self.valence).filter_map(move |s| {
            let ((p0, p1), (q0, q1)) = self.spans(s)?;
            let corner = self.sectors[s];
            let (x, y) = (corner.index(p0, q0, self.n), corner.index(p1, q1, self.n));
            Some((
                corner.diamond,
                IndexBox {
                    least: (x.i.min(y.i), x.j.min(y.j)),
                    most: (x.i.max(y.i), x.j.max(y.j)),
                },
            ))
        })
    }

    /// The box of a diamond among [`Self::boxes`].
    pub fn box_in(&self, diamond: u8) -> Option<IndexBox> {
        let mut boxes = self.boxes();
        boxes.find(|(d, _)| *d == diamond).map(|(_, span)| span)
    }

    /// Spans of p and q in sector `s` that contain a king's extent; they contain the hexagon too.
    fn spans(&self, s: usize) -> Option<((i64, i64), (i64, i64))> {
        let (a, b, r) = (self.a, self.b, self.radius);
        let (near_a, near_b) = ((a - r).max(0), (b - r).max(0));
        // Remaining steps once the edge, or the corner, has been reached.
        let (ra, rb, rc) = (r - a, r - b, r - a.max(b));
        let spans = match (self.valence, s) {
            (_, 0) => ((near_a, a + r), (near_b, b + r)),
            (5, 1) => ((near_b, b + r), (0, ra)),
            (5, 2) if rb > 0 => ((0, ra), (0, rc)),
            (5, 3) if ra > 0 => ((0, rc), (0, rb)),
            (5, 4) => ((0, rb), (near_a, a + r)),
            (3, 1) if ra > 0 => ((near_b, b + r), (0, ra.max(if rc > 0 { rb } else { 0 }))),
            (3, 2) if rb > 0 => ((0, rb.max(if rc > 0 { ra } else { 0 })), (near_a, a + r)),
            _ => return None,
        };
        let ((p0, p1), (q0, q1)) = spans;
        (p1 > p0 && q1 > q0).then_some(spans)
    }

    /// The extent's part in one diamond; `None` if that is out of reach.
    pub fn in_diamond(&self, diamond: u8) -> Option<DiamondExtent<'_>> {
        let sectors = &self.sectors[..self.valence];
        let sector = sectors.iter().position(|c| c.diamond == diamond)?;
        Some(DiamondExtent {
            extent: self,
            sector,
        })
    }

    /// Whether a triangle is within the extent: all its corners, and for [`Trim::Diamond`] all corners of its cell.
    ///
    /// Three corners are not enough for a king's distance. Where the border passes through a corner of three diamonds, the diamond beyond
    /// would show a single triangle between two borders.
    pub fn holds(&self, triangle: Triangle) -> bool {
        let LatticeIndex { diamond, i, j } = triangle.cell;
        let part = self.in_diamond(diamond);
        part.is_some_and(|part| part.holds(i, j, triangle.far))
    }
}

/// An extent in the indices of one diamond.
pub struct DiamondExtent<'a> {
    extent: &'a LevelExtent,
    sector: usize,
}

impl DiamondExtent<'_> {
    /// Steps from the middle to (i, j).
    pub fn distance(&self, i: i64, j: i64) -> i64 {
        let (p, q) = self.extent.sectors[self.sector].steps(i, j, self.extent.n);
        match self.extent.trim {
            Trim::Diamond => self.extent.king(self.sector, p, q),
            Trim::Hexagon => self.extent.hex(self.sector, p, q),
        }
    }

    /// [`LevelExtent::holds`] for the triangle of cell (i, j).
    pub fn holds(&self, i: i64, j: i64, far: bool) -> bool {
        let within = |i, j| self.distance(i, j) <= self.extent.radius;
        let whole = self.extent.trim == Trim::Diamond;
        within(i + 1, j)
            && within(i, j + 1)
            && (far && !whole || within(i, j))
            && (!far && !whole || within(i + 1, j + 1))
    }

    /// Radius of the extent, in steps.
    pub fn radius(&self) -> i64 {
        self.extent.radius
    }
}
