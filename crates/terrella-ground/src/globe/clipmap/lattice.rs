//! The lattice of ten diamonds: the paper's icosahedron, its points on the sphere, and the neighbours of each diamond.
//!
//! Diamonds 0…4 (*upper*, k) have their corner A at the north pole, 5…9 (*lower*, 5 + m) their corner D at the south pole. A lattice of `n`
//! cells an edge gives each diamond the points (i, j), 0 ≤ i, j ≤ n, with A = (0, 0), B = (n, 0), C = (0, n), D = (n, n). Each cell is cut
//! from B's side to C's, so that all triangles are those of the icosahedron's faces.

use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

/// Diamonds of the globe.
pub const DIAMONDS: u8 = 10;

/// A point of a lattice. A point on an edge has an index in each diamond that shares the edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LatticeIndex {
    /// 0…9.
    pub diamond: u8,
    /// From A towards B, 0…n.
    pub i: i64,
    /// From A towards C, 0…n.
    pub j: i64,
}

impl LatticeIndex {
    /// The same point in a lattice finer by `factor`.
    pub fn scaled(self, factor: i64) -> Self {
        Self {
            i: self.i * factor,
            j: self.j * factor,
            ..self
        }
    }

    /// The same point in a lattice half as fine; both indices must be even.
    pub fn halved(self) -> Self {
        debug_assert!(self.i % 2 == 0 && self.j % 2 == 0);
        Self {
            i: self.i / 2,
            j: self.j / 2,
            ..self
        }
    }
}

/// Half a cell: the triangle by the cell's (i, j) corner or by its (i + 1, j + 1) corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Triangle {
    /// The cell's corner with the smallest indices.
    pub cell: LatticeIndex,
    /// Whether it is the triangle by the (i + 1, j + 1) corner.
    pub far: bool,
}

impl Triangle {
    /// Its corners, counter-clockwise seen from above; the first is the one that is not on the cell's diagonal.
    pub fn corners(self) -> [LatticeIndex; 3] {
        let LatticeIndex { diamond, i, j } = self.cell;
        let at = |i, j| LatticeIndex { diamond, i, j };
        if self.far {
            [at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)]
        } else {
            [at(i, j), at(i + 1, j), at(i, j + 1)]
        }
    }

    /// The triangles across its edges, from corner 0 to 1, 1 to 2 and 2 to 0, in a lattice of `n` cells.
    pub fn neighbours(self, n: i64) -> [Self; 3] {
        let LatticeIndex { diamond, i, j } = self.cell;
        let across = |i, j| {
            cell_across(LatticeIndex { diamond, i, j }, n).unwrap_or(Self {
                cell: LatticeIndex { diamond, i, j },
                far: !self.far,
            })
        };
        let twin = Self {
            far: !self.far,
            ..self
        };
        if self.far {
            [across(i, j + 1), twin, across(i + 1, j)]
        } else {
            [across(i, j - 1), twin, across(i - 1, j)]
        }
    }
}

/// The triangle that a cell one step outside its diamond (−1 or n in one index) shows to that diamond. `None` for a cell inside. These are
/// the paper's rules modulo five.
fn cell_across(cell: LatticeIndex, n: i64) -> Option<Triangle> {
    let LatticeIndex { diamond, i, j } = cell;
    let upper = |k: u8| k % 5;
    let lower = |m: u8| 5 + m % 5;
    let m = diamond % 5;
    let last = n - 1;
    let at = |diamond, i, j, far| {
        Some(Triangle {
            cell: LatticeIndex { diamond, i, j },
            far,
        })
    };
    match (diamond < 5, i, j) {
        // Rotation about the north pole.
        (true, -1, _) => at(upper(m + 1), j, 0, false),
        (true, _, -1) => at(upper(m + 4), 0, i, false),
        // Straight on between the two rows of diamonds.
        (true, _, _) if i == n => at(lower(m + 4), 0, j, false),
        (true, _, _) if j == n => at(lower(m), i, 0, false),
        (false, -1, _) => at(upper(m + 1), last, j, true),
        (false, _, -1) => at(upper(m), i, last, true),
        // Rotation about the south pole.
        (false, _, _) if i == n => at(lower(m + 4), j, last, true),
        (false, _, _) if j == n => at(lower(m + 1), last, i, true),
        _ => None,
    }
}

/// A corner of a diamond, with the directions along its two edges. The turn from the first edge to the second is to the left, through the
/// diamond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DiamondCorner {
    /// 0…9.
    pub diamond: u8,
    /// A, B, D, C as 0…3: counter-clockwise.
    pub corner: u8,
}

impl DiamondCorner {
    /// The diamond's corner nearest to a point, the lower one if two are equally near.
    pub fn nearest(index: LatticeIndex, n: i64) -> Self {
        let corner = match (2 * index.i > n, 2 * index.j > n) {
            (false, false) => 0,
            (true, false) => 1,
            (true, true) => 2,
            (false, true) => 3,
        };
        Self {
            diamond: index.diamond,
            corner,
        }
    }

    /// Number of diamonds that meet here: five at the poles, three elsewhere.
    pub fn valence(self) -> usize {
        match (self.diamond < 5, self.corner) {
            (true, 0) | (false, 2) => 5,
            _ => 3,
        }
    }

    /// Whether the diamond's angle here is the narrow one, of one face instead of two.
    pub fn narrow(self) -> bool {
        self.corner.is_multiple_of(2)
    }

    /// The same corner in the diamond to the left, across the second edge.
    pub fn left(self) -> Self {
        let m = self.diamond % 5;
        let (diamond, corner) = match (self.diamond < 5, self.corner) {
            (true, 0) => ((m + 1) % 5, 0),
            (true, 1) => ((m + 4) % 5, 3),
            (true, 2) => (5 + (m + 4) % 5, 3),
            (true, _) => (5 + m, 0),
            (false, 0) => ((m + 1) % 5, 1),
            (false, 1) => (m, 2),
            (false, 2) => (5 + (m + 4) % 5, 2),
            (false, _) => (5 + (m + 1) % 5, 1),
        };
        Self { diamond, corner }
    }

    /// Steps from the corner along the first and the second edge to (i, j).
    pub fn steps(self, i: i64, j: i64, n: i64) -> (i64, i64) {
        match self.corner {
            0 => (i, j),
            1 => (j, n - i),
            2 => (n - i, n - j),
            _ => (n - j, i),
        }
    }

    /// The point `p` and `q` steps along the first and the second edge: the inverse of [`Self::steps`].
    pub fn index(self, p: i64, q: i64, n: i64) -> LatticeIndex {
        let (i, j) = match self.corner {
            0 => (p, q),
            1 => (n - q, p),
            2 => (n - p, n - q),
            _ => (q, n - p),
        };
        LatticeIndex {
            diamond: self.diamond,
            i,
            j,
        }
    }
}

/// A place of the paper's virtual diamond: the content of one of the 3 × 3 places about a home diamond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiamondPlace {
    /// The home itself.
    Home,
    /// The diamond across an edge of the home.
    Across(u8),
    /// Beyond a corner where three diamonds meet there is no diamond: the two places beside it touch each other.
    Closed,
    /// Beyond a pole two diamonds share the place, the left one (counter-clockwise) last.
    Two(u8, u8),
}

/// The 3 × 3 virtual diamond of a home, `[row][column]`: rows from A's side to D's along i, columns along j; the home is at `[1][1]`.
/// Unlike in the paper, nothing is split and paired again. Each place has whole diamonds of the globe, so a change of home only renames
/// points.
pub fn virtual_diamond(home: u8) -> [[DiamondPlace; 3]; 3] {
    let across = |i, j| {
        let cell = LatticeIndex {
            diamond: home,
            i,
            j,
        };
        // n = 1 makes one cell a diamond.
        cell_across(cell, 1).map_or(DiamondPlace::Home, |triangle| {
            DiamondPlace::Across(triangle.cell.diamond)
        })
    };
    let beyond = |corner| {
        let corner = DiamondCorner {
            diamond: home,
            corner,
        };
        if corner.valence() == 3 {
            return DiamondPlace::Closed;
        }
        let first = corner.left().left();
        DiamondPlace::Two(first.diamond, first.left().diamond)
    };
    [
        [beyond(0), across(-1, 0), beyond(3)],
        [across(0, -1), DiamondPlace::Home, across(0, 1)],
        [beyond(1), across(1, 0), beyond(2)],
    ]
}

/// The icosahedron about the unit sphere's centre.
pub struct Icosahedron {
    corners: [DVec3; 12],
    /// By face, diamond by diamond, near then far: maps a direction to its weights of the face's corners, see [`Triangle::corners`].
    weights: [DMat3; 20],
}

/// Indices of a diamond's corners A, B, C, D among the twelve: north pole, five at 26.565° N from 0° E eastwards, five at 26.565° S from
/// 36° E, south pole.
fn corner_numbers(diamond: u8) -> [usize; 4] {
    let m = usize::from(diamond % 5);
    let next = (m + 1) % 5;
    if diamond < 5 {
        [0, 1 + m, 1 + next, 6 + m]
    } else {
        [1 + next, 6 + m, 6 + next, 11]
    }
}

impl Default for Icosahedron {
    fn default() -> Self {
        // tan 26.565° = 1/2: z = 1/√5, ρ = 2/√5.
        let z = 0.2_f64.sqrt();
        let ring = |k: usize, turn: f64, z: f64| {
            let (sin, cos) = ((k as f64 + turn) * TAU / 5.0).sin_cos();
            DVec3::new(2.0 * 0.2_f64.sqrt() * cos, 2.0 * 0.2_f64.sqrt() * sin, z)
        };
        let corners = std::array::from_fn(|c| match c {
            0 => DVec3::Z,
            1..=5 => ring(c - 1, 0.0, z),
            6..=10 => ring(c - 6, 0.5, -z),
            _ => DVec3::NEG_Z,
        });
        let weights = std::array::from_fn(|face| {
            let [a, b, c, d] = corner_numbers(face as u8 / 2).map(|number| corners[number]);
            if face % 2 == 0 {
                DMat3::from_cols(a, b, c).inverse()
            } else {
                DMat3::from_cols(d, c, b).inverse()
            }
        });
        Self { corners, weights }
    }
}

impl Icosahedron {
    /// The unit direction of a point of a lattice of `n` cells.
    ///
    /// The paper's OE = OA + y(OB − OA), OF = OA + y(OC − OA), OG = OE + x(OF − OE), y = (i + j)/n, x = j/(i + j), is OG = (1 − (i +
    /// j)/n)·OA + (i/n)·OB + (j/n)·OC, and from D likewise for i + j > n. A point on an edge is the same to the last bit in each diamond:
    /// the corners are summed in the order of their indices.
    pub fn direction(&self, index: LatticeIndex, n: i64) -> DVec3 {
        let LatticeIndex { diamond, i, j } = index;
        let [a, b, c, d] = corner_numbers(diamond);
        let mut parts = if i + j <= n {
            [(a, n - i - j), (b, i), (c, j)]
        } else {
            [(d, i + j - n), (b, n - j), (c, n - i)]
        };
        parts.sort_unstable_by_key(|(number, _)| *number);
        let sum = parts.iter().fold(DVec3::ZERO, |sum, (number, weight)| {
            sum + self.corners[*number] * *weight as f64
        });
        sum / sum.length()
    }

    /// The diamond that a direction passes through, and the position there: fractions of its edges from A towards B and from A towards C,
    /// 0…1.
    pub fn locate(&self, direction: DVec3) -> (u8, f64, f64) {
        let mut best = (f64::NEG_INFINITY, 0, DVec3::X);
        for (face, weights) in self.weights.iter().enumerate() {
            let w = *weights * direction;
            let least = w.min_element();
            if least > best.0 {
                best = (least, face, w);
            }
        }
        let (_, face, w) = best;
        let w = w.max(DVec3::ZERO);
        let w = w / (w.x + w.y + w.z);
        let place = if face % 2 == 0 {
            (w.y, w.z)
        } else {
            // Weights of D, C, B: that of C is 1 − x, that of B is 1 − y.
            (1.0 - w.y, 1.0 - w.z)
        };
        (
            face as u8 / 2,
            place.0.clamp(0.0, 1.0),
            place.1.clamp(0.0, 1.0),
        )
    }
}
