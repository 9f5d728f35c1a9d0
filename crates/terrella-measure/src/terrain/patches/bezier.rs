//! Bicubic patches by their Bézier control heights.

use crate::terrain::qbernstein::Conversion;
use terrella_ground::globe::contours::hermite::{Corner, bezier_values, cubic};

/// Bézier control heights of a bicubic patch, `[along u][along v]`.
pub type Net = [[f64; 4]; 4];

/// The Bézier net of a patch of `w` × `h` steps from its corners south-west, south-east, north-west, north-east.
pub fn net(corners: &[Corner; 4], w: f64, h: f64) -> Net {
    let [sw, se, nw, ne] = corners;
    // Along u first: heights and derivatives by v of the southern and the northern edge.
    let row = |a: &Corner, b: &Corner| {
        (
            bezier_values((a[0], a[1]), (b[0], b[1]), w),
            bezier_values((a[2], a[3]), (b[2], b[3]), w),
        )
    };
    let ((south, south_v), (north, north_v)) = (row(sw, se), row(nw, ne));
    std::array::from_fn(|i| bezier_values((south[i], south_v[i]), (north[i], north_v[i]), h))
}

/// Height and derivatives by u and by v (both 0…1) of a net.
pub fn evaluate(net: &Net, u: f64, v: f64) -> [f64; 3] {
    let columns = net.map(|column| cubic(column, v));
    let (z, zu) = cubic(columns.map(|c| c.0), u);
    let (zv, _) = cubic(columns.map(|c| c.1), u);
    [z, zu, zv]
}

/// Control heights in another basis each way.
pub fn converted(net: &Net, along_u: &Conversion, along_v: &Conversion) -> Net {
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
