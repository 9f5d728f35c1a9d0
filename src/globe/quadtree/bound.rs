//! How far a leaf may lie from its data.

/// What a square drawn as one leaf is off by, in the units of the heights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeafError {
    /// Largest of the paper's five: how far the centre and the middles of the edges lie from the mean of the ends of a
    /// diagonal or of the edge.
    pub midpoints: f64,
    /// Most that any post differs from the leaf's triangles, whichever posts of its edges finer neighbours put in.
    pub bound: f64,
}

/// The errors of the square of `size` × `size` steps (a power of two, 2 or more) with its north-western post at (x, y).
///
/// A leaf is a fan of triangles from its centre to its edges, so its height is c(1 − t) + t·edge, with t = 0 in the centre
/// and 1 on the edge. Points that finer neighbours put into an edge move it by some amount between the lowest and the
/// highest that any post of the edge departs from it; the error within moves by t times that.
pub fn leaf_error(
    height: impl Fn(usize, usize) -> f64,
    x: usize,
    y: usize,
    size: usize,
) -> LeafError {
    let half = size / 2;
    let at = |i: usize, j: usize| height(x + i, y + j);
    let center = at(half, half);
    let [nw, ne, sw, se] = [at(0, 0), at(size, 0), at(0, size), at(size, size)];
    // West, south, east, north: ends in the order of growing x or y.
    let ends = [(nw, sw), (sw, se), (ne, se), (nw, ne)];
    let post = |side: usize, i: usize| match side {
        0 => at(0, i),
        1 => at(i, size),
        2 => at(size, i),
        _ => at(i, 0),
    };
    let inverse = 1.0 / size as f64;
    let mut midpoints = (center - 0.5 * (nw + se))
        .abs()
        .max((center - 0.5 * (ne + sw)).abs());
    let mut departs = [(0.0_f64, 0.0_f64); 4];
    for (side, ((a, b), departs)) in ends.into_iter().zip(&mut departs).enumerate() {
        for i in 1..size {
            let by = post(side, i) - (a + (b - a) * (i as f64 * inverse));
            departs.0 = departs.0.min(by);
            departs.1 = departs.1.max(by);
        }
        midpoints = midpoints.max((post(side, half) - 0.5 * (a + b)).abs());
    }
    let mut bound = 0.0_f64;
    for j in 0..=size {
        let v = j as f64 - half as f64;
        for i in 0..=size {
            let u = i as f64 - half as f64;
            let (side, along, across) = if v.abs() >= u.abs() {
                (if v > 0.0 { 1 } else { 3 }, u, v.abs())
            } else {
                (if u > 0.0 { 2 } else { 0 }, v, u.abs())
            };
            let t = 2.0 * across * inverse;
            let (a, b) = ends[side];
            let fan = center * (1.0 - t) + t * 0.5 * (a + b) + along * inverse * (b - a);
            let off = fan - at(i, j);
            let (low, high) = departs[side];
            bound = bound.max(off.abs());
            bound = bound.max((off + t * low).abs().max((off + t * high).abs()));
        }
    }
    LeafError { midpoints, bound }
}
