//! Bounds of the distance between a leaf and its data.

/// Error of a square drawn as one leaf, in the units of the heights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeafError {
    /// Largest of the paper's five: distances of the centre and of the middles of the edges from the mean of the ends of a diagonal or of
    /// the edge.
    pub midpoints: f64,
    /// Upper bound of the difference between any post and the leaf's triangles, whichever posts finer neighbours insert into its edges.
    pub bound: f64,
}

/// The errors of the square of `size` × `size` steps (a power of two, 2 or more) with its north-western post at (x, y).
///
/// A leaf is a fan of triangles from its centre to its edges. Its height is c(1 − t) + t·edge, with t = 0 in the centre and 1 on the edge.
/// Points that finer neighbours insert into an edge move it. The displacement is between the lowest and the highest departure of any post
/// from the edge; the error inside changes by t times that.
pub fn leaf_error(
    height: impl Fn(usize, usize) -> f64,
    x: usize,
    y: usize,
    size: usize,
) -> LeafError {
    let fan = Fan::new(&height, x, y, size);
    let mut bound = 0.0_f64;
    for j in 0..=size {
        for i in 0..=size {
            let data = height(x + i, y + j);
            let (least, most) = fan.heights(i, j);
            bound = bound.max(data - least).max(most - data);
        }
    }
    LeafError {
        midpoints: fan.midpoints,
        bound,
    }
}

/// Upper bound of the difference between data and a leaf if only the range of the data is known. `range` is the lowest and highest height
/// in the square of two by two steps whose north-western post is (x, y), both even.
///
/// In such a square the leaf's height is between those at its corners: the leaf's own creases pass through them.
pub fn leaf_range_error(
    height: impl Fn(usize, usize) -> f64,
    range: impl Fn(usize, usize) -> (f64, f64),
    x: usize,
    y: usize,
    size: usize,
) -> f64 {
    let fan = Fan::new(&height, x, y, size);
    let mut bound = 0.0_f64;
    for j in (0..size).step_by(2) {
        for i in (0..size).step_by(2) {
            let (low, high) = range(x + i, y + j);
            for (di, dj) in [(0, 0), (2, 0), (0, 2), (2, 2)] {
                let (least, most) = fan.heights(i + di, j + dj);
                bound = bound.max(high - least).max(most - low);
            }
        }
    }
    bound
}

/// A leaf as its triangles, and how far its edges may move.
struct Fan {
    size: usize,
    center: f64,
    /// Heights at the ends of each side, in the order of growing x or y: west, south, east, north.
    ends: [(f64, f64); 4],
    /// Lowest and highest departure of a post from the side's straight line.
    departs: [(f64, f64); 4],
    midpoints: f64,
}

impl Fan {
    fn new(height: &impl Fn(usize, usize) -> f64, x: usize, y: usize, size: usize) -> Self {
        let half = size / 2;
        let at = |i: usize, j: usize| height(x + i, y + j);
        let center = at(half, half);
        let [nw, ne, sw, se] = [at(0, 0), at(size, 0), at(0, size), at(size, size)];
        let ends = [(nw, sw), (sw, se), (ne, se), (nw, ne)];
        let post = |side: usize, i: usize| match side {
            0 => at(0, i),
            1 => at(i, size),
            2 => at(size, i),
            _ => at(i, 0),
        };
        let mut midpoints = (center - 0.5 * (nw + se))
            .abs()
            .max((center - 0.5 * (ne + sw)).abs());
        let mut departs = [(0.0_f64, 0.0_f64); 4];
        for (side, ((a, b), departs)) in ends.into_iter().zip(&mut departs).enumerate() {
            for i in 1..size {
                let by = post(side, i) - (a + (b - a) * (i as f64 / size as f64));
                *departs = (departs.0.min(by), departs.1.max(by));
            }
            midpoints = midpoints.max((post(side, half) - 0.5 * (a + b)).abs());
        }
        Self {
            size,
            center,
            ends,
            departs,
            midpoints,
        }
    }

    /// Lowest and highest height that the leaf may have at a post.
    fn heights(&self, i: usize, j: usize) -> (f64, f64) {
        let half = (self.size / 2) as f64;
        let (u, v) = (i as f64 - half, j as f64 - half);
        let (side, along, across) = if v.abs() >= u.abs() {
            (if v > 0.0 { 1 } else { 3 }, u, v.abs())
        } else {
            (if u > 0.0 { 2 } else { 0 }, v, u.abs())
        };
        let t = across / half;
        let ((a, b), (low, high)) = (self.ends[side], self.departs[side]);
        let plain = self.center * (1.0 - t) + t * 0.5 * (a + b) + along * (b - a) / (2.0 * half);
        (plain + t * low, plain + t * high)
    }
}
