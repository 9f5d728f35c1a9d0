//! Bicubic patches by what they do at their corners, and how a finer patch takes over the edge of a coarser one.
//!
//! A corner has a height and its derivatives by u, by v and by both, each per lattice step. On an edge the height is the
//! cubic of (z, z_t) at its two ends, and the derivative across it is the cubic of (z_n, z_nt) there. So two patches with
//! the same four numbers at both ends of an edge join with one height and one tangent plane all along it; and where a
//! corner lies inside the edge of a coarser patch, it takes its four numbers from that edge, after which the finer
//! patches' edge is a piece of the coarser one's and the same holds. In Bézier form: equal boundary control points, and
//! cross-boundary differences proportional with the one α > 0 that is the ratio of the patches' widths. No patch needs
//! more than its neighbours' corners, whatever the difference of levels.

/// Height, its derivatives by u and by v, and by both, per lattice step.
pub type Corner = [f64; 4];

/// Bézier control heights of a bicubic patch, `[along u][along v]`.
pub type Net = [[f64; 4]; 4];

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

/// Bézier values of the cubic that has a height and slope (per step) at both ends of `steps` steps.
fn values(a: (f64, f64), b: (f64, f64), steps: f64) -> [f64; 4] {
    let third = steps / 3.0;
    [a.0, a.0 + third * a.1, b.0 - third * b.1, b.0]
}

/// What a corner must be at `t` of the way from `a` to `b`, an edge of `steps` steps along u (or v): the coarser edge's.
pub fn restrict(a: &Corner, b: &Corner, steps: f64, t: f64, along_u: bool) -> Corner {
    let (d, n) = if along_u { (1, 2) } else { (2, 1) };
    let (z, slope) = cubic(values((a[0], a[d]), (b[0], b[d]), steps), t);
    let (across, twist) = cubic(values((a[n], a[3]), (b[n], b[3]), steps), t);
    let mut out = [z, 0.0, 0.0, twist / steps];
    out[d] = slope / steps;
    out[n] = across;
    out
}

/// The Bézier net of a patch of `w` × `h` steps from its corners south-west, south-east, north-west, north-east.
pub fn net(corners: &[Corner; 4], w: f64, h: f64) -> Net {
    let [sw, se, nw, ne] = corners;
    // Along u first: heights and derivatives by v of the southern and the northern edge.
    let row = |a: &Corner, b: &Corner| {
        (
            values((a[0], a[1]), (b[0], b[1]), w),
            values((a[2], a[3]), (b[2], b[3]), w),
        )
    };
    let ((south, south_v), (north, north_v)) = (row(sw, se), row(nw, ne));
    std::array::from_fn(|i| values((south[i], south_v[i]), (north[i], north_v[i]), h))
}

/// A corner from 3 × 3 heights about it, `[row from the south][column from the west]`, `west_east` steps to either column
/// and `south_north` to either row; 0 where there is none.
///
/// Slopes are central differences, limited as by Fritsch and Carlson to three times the smaller of the two one-sided
/// ones, and 0 at an extremum, so that a cliff or a spike does not ring.
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

/// Height and derivatives by u and by v (both 0…1) of a net.
pub fn evaluate(net: &Net, u: f64, v: f64) -> [f64; 3] {
    let columns = net.map(|column| cubic(column, v));
    let (z, zu) = cubic(columns.map(|c| c.0), u);
    let (zv, _) = cubic(columns.map(|c| c.1), u);
    [z, zu, zv]
}
