//! Differences of colours as people see them: CIEDE2000.

use glam::DVec3;

/// Linear sRGB to XYZ of the white D65 (IEC 61966-2-1).
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [0.4124, 0.3576, 0.1805],
    [0.2126, 0.7152, 0.0722],
    [0.0193, 0.1192, 0.9505],
];

/// CIE L*a*b* of linear sRGB light, (1, 1, 1) being white.
pub fn lab_of_linear(rgb: DVec3) -> [f64; 3] {
    let channels = rgb.to_array();
    let [x, y, z] = XYZ_FROM_RGB.map(|row| {
        let sum = |weights: [f64; 3]| -> f64 {
            weights
                .iter()
                .zip(channels)
                .map(|(weight, value)| weight * value)
                .sum()
        };
        root(sum(row) / row.iter().sum::<f64>())
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The cube root, and below (6/29)³ the straight line that continues it.
fn root(t: f64) -> f64 {
    let knee: f64 = 6.0 / 29.0;
    if t > knee.powi(3) {
        t.cbrt()
    } else {
        t / (3.0 * knee * knee) + 4.0 / 29.0
    }
}

/// ΔE₀₀ of two colours in L*a*b*, all weights 1: Sharma, Wu and Dalal 2005, Color Res. Appl. 30, 21, in their notation.
pub fn color_difference([l1, a1, b1]: [f64; 3], [l2, a2, b2]: [f64; 3]) -> f64 {
    let seventh = |c: f64| c.powi(7) / (c.powi(7) + 25.0_f64.powi(7));
    let mean_c = 0.5 * (a1.hypot(b1) + a2.hypot(b2));
    let g = 0.5 * (1.0 - seventh(mean_c).sqrt());
    let (a1, a2) = ((1.0 + g) * a1, (1.0 + g) * a2);
    let (c1, c2) = (a1.hypot(b1), a2.hypot(b2));
    let hue = |a: f64, b: f64| b.atan2(a).to_degrees().rem_euclid(360.0);
    let (h1, h2) = (hue(a1, b1), hue(a2, b2));
    let is_grey = c1 * c2 == 0.0;
    let turn = if is_grey {
        0.0
    } else {
        // The shorter way round.
        (h2 - h1 + 180.0).rem_euclid(360.0) - 180.0
    };
    let (d_l, d_c) = (l2 - l1, c2 - c1);
    let d_h = 2.0 * (c1 * c2).sqrt() * (0.5 * turn).to_radians().sin();
    let (mean_l, mean_c) = (0.5 * (l1 + l2), 0.5 * (c1 + c2));
    let mean_h = match (is_grey, (h1 - h2).abs() <= 180.0) {
        (true, _) => h1 + h2,
        (false, true) => 0.5 * (h1 + h2),
        (false, false) if h1 + h2 < 360.0 => 0.5 * (h1 + h2 + 360.0),
        (false, false) => 0.5 * (h1 + h2 - 360.0),
    };
    let cos = |deg: f64| deg.to_radians().cos();
    let t =
        1.0 - 0.17 * cos(mean_h - 30.0) + 0.24 * cos(2.0 * mean_h) + 0.32 * cos(3.0 * mean_h + 6.0)
            - 0.20 * cos(4.0 * mean_h - 63.0);
    let d_theta = 30.0 * (-((mean_h - 275.0) / 25.0).powi(2)).exp();
    let r_c = 2.0 * seventh(mean_c).sqrt();
    let from_middle = (mean_l - 50.0).powi(2);
    let s_l = 1.0 + 0.015 * from_middle / (20.0 + from_middle).sqrt();
    let s_c = 1.0 + 0.045 * mean_c;
    let s_h = 1.0 + 0.015 * mean_c * t;
    let r_t = -(2.0 * d_theta).to_radians().sin() * r_c;
    let (l, c, h) = (d_l / s_l, d_c / s_c, d_h / s_h);
    (l * l + c * c + h * h + r_t * c * h).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the 34 pairs of the paper's Table 1: its pairs of blues, of hues across 0°, of greys, and of ordinary colours.
    #[test]
    fn published_pairs_are_as_far_apart_as_published() {
        for (a, b, wanted) in [
            ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
            ([50.0, 3.1571, -77.2803], [50.0, 0.0, -82.7485], 2.8615),
            ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0000),
            ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
            ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0009], 7.1792),
            ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0011], 7.2195),
            ([50.0, -0.0010, 2.4900], [50.0, 0.0009, -2.4900], 4.8045),
            ([50.0, 2.5, 0.0], [50.0, 0.0, -2.5], 4.3065),
            ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
            ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.4535),
            (
                [60.2574, -34.0099, 36.2677],
                [60.4626, -34.1751, 39.4387],
                1.2644,
            ),
            (
                [22.7233, 20.0904, -46.6940],
                [23.0331, 14.9730, -42.5619],
                2.0373,
            ),
            (
                [90.8027, -2.0831, 1.4410],
                [91.1528, -1.6435, 0.0447],
                1.4441,
            ),
            (
                [2.0776, 0.0795, -1.1350],
                [0.9033, -0.0636, -0.5514],
                0.9082,
            ),
        ] {
            let found = color_difference(a, b);
            assert!(
                (found - wanted).abs() < 1e-4,
                "{a:?} {b:?}: {found} for {wanted}"
            );
            assert!((found - color_difference(b, a)).abs() < 1e-12);
        }
    }

    #[test]
    fn white_and_grey_have_no_hue() {
        let [l, a, b] = lab_of_linear(DVec3::ONE);
        assert!((l - 100.0).abs() < 1e-9 && a.abs() < 1e-9 && b.abs() < 1e-9);
        let [l, a, b] = lab_of_linear(DVec3::splat(0.18418));
        assert!((l - 50.0).abs() < 1e-2 && a.abs() < 1e-9 && b.abs() < 1e-9);
        let [_, a, b] = lab_of_linear(DVec3::Z);
        assert!(a > 50.0 && b < -80.0, "{a} {b}");
    }
}
