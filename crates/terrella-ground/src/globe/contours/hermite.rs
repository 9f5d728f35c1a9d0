//! Bicubic patches defined by values at their corners, and how a finer patch adopts the edge of a coarser one.
//!
//! A corner has a height and its derivatives by u, by v and by both, each per lattice step. On an edge the height is the cubic of (z, z_t)
//! at its two ends. The derivative across it is the cubic of (z_n, z_nt) there. Two patches with the same four numbers at both ends of an
//! edge therefore share one height and one tangent plane all along it. A corner inside the edge of a coarser patch takes its four numbers
//! from that edge. The finer patches' edge is then a piece of the coarser one's, and the same is true. In Bézier form: equal boundary
//! control points, and cross-boundary differences proportional with the one α > 0 that is the ratio of the patches' widths. No patch needs
//! more than its neighbours' corners, whatever the difference of levels.

/// Height, its derivatives by u and by v, and by both, per lattice step.
pub type Corner = [f64; 4];

/// a + (b − a)t: exactly a for equal values.
fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// A cubic and its derivative by t from its Bézier values, by de Casteljau: equal values give that value exactly.
pub fn cubic(b: [f64; 4], t: f64) -> (f64, f64) {
    let (p, q, r) = (
        lerp(b[0], b[1], t),
        lerp(b[1], b[2], t),
        lerp(b[2], b[3], t),
    );
    let (p, q) = (lerp(p, q, t), lerp(q, r, t));
    (lerp(p, q, t), 3.0 * (q - p))
}

/// Bézier values of the cubic with the given height and slope (per step) at both ends of `steps` steps.
pub fn bezier_values(a: (f64, f64), b: (f64, f64), steps: f64) -> [f64; 4] {
    let third = steps / 3.0;
    [a.0, a.0 + third * a.1, b.0 - third * b.1, b.0]
}

/// The corner that the coarser edge requires at `t` of the way from `a` to `b`, an edge of `steps` steps along u (or v).
pub fn restrict(a: &Corner, b: &Corner, steps: f64, t: f64, along_u: bool) -> Corner {
    let (d, n) = if along_u { (1, 2) } else { (2, 1) };
    let (z, slope) = cubic(bezier_values((a[0], a[d]), (b[0], b[d]), steps), t);
    let (across, twist) = cubic(bezier_values((a[n], a[3]), (b[n], b[3]), steps), t);
    let mut out = [z, 0.0, 0.0, twist / steps];
    out[d] = slope / steps;
    out[n] = across;
    out
}

/// A corner from the 3 × 3 heights around it, `[row from the south][column from the west]`. The columns are `west_east` steps away, the
/// rows `south_north` steps; 0 if there is none.
///
/// Slopes are central differences, limited as by Fritsch and Carlson to three times the smaller of the two one-sided
/// ones. They are 0 at an extremum, so that a cliff or a spike does not ring.
pub fn estimate(heights: &[[f64; 3]; 3], west_east: [f64; 2], south_north: [f64; 2]) -> Corner {
    let slope = |z: [f64; 3], [left, right]: [f64; 2]| {
        if left + right == 0.0 {
            return 0.0;
        }
        let whole = (z[2] - z[0]) / (left + right);
        if left == 0.0 || right == 0.0 {
            return whole;
        }
        let (a, b) = ((z[1] - z[0]) / left, (z[2] - z[1]) / right);
        let most = 3.0 * a.abs().min(b.abs());
        if a * b <= 0.0 {
            0.0
        } else {
            whole.clamp(-most, most)
        }
    };
    let zu = slope(heights[1], west_east);
    let zv = slope(heights.map(|row| row[1]), south_north);
    let area = (west_east[0] + west_east[1]) * (south_north[0] + south_north[1]);
    let twist = if zu == 0.0 || zv == 0.0 || area == 0.0 {
        0.0
    } else {
        (heights[2][2] - heights[2][0] - heights[0][2] + heights[0][0]) / area
    };
    [heights[1][1], zu, zv, twist]
}
