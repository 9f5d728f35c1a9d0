//! The Earth's field as a sum of spherical harmonics.

use super::egm96::{EGM96, EGM96_DEGREE};
use crate::constants::{EARTH_GM_M3_S2, EGM96_EQUATORIAL_RADIUS_M};
use glam::DVec3;

/// One row or column more than the highest degree, and one because counting begins at 0.
const SIDE: usize = EGM96_DEGREE + 2;

/// Cunningham's functions V and W of degree n (rows) and order m (columns).
type Harmonics = [[f64; SIDE]; SIDE];

/// A field of EGM96 cut off at a degree and order, its coefficients no longer normalised.
///
/// Acceleration by Cunningham's recursion (Montenbruck & Gill 2000, 3.2.4), which has no singularity at the poles.
#[derive(Clone, Debug)]
pub(super) struct Field {
    degree: usize,
    order: usize,
    c: Harmonics,
    s: Harmonics,
    /// Kept between calls: filling it with zeros again would take longer than J2 itself.
    v: Harmonics,
    w: Harmonics,
}

impl Field {
    /// Up to `degree` from 2 to [`EGM96_DEGREE`] and `order` from 0 to `degree`; beyond, what there is.
    pub fn new(degree: usize, order: usize) -> Self {
        let degree = degree.min(EGM96_DEGREE);
        let order = order.min(degree);
        let (mut c, mut s) = ([[0.0; SIDE]; SIDE], [[0.0; SIDE]; SIDE]);
        let mut coefficients = EGM96.iter();
        for n in 2..=degree {
            // N = √((2 − δ0m)(2n + 1)(n − m)!/(n + m)!)
            let mut factorials = 1.0;
            for m in 0..=n {
                if m > 0 {
                    factorials /= ((n + m) * (n - m + 1)) as f64;
                }
                let twice = if m == 0 { 1.0 } else { 2.0 };
                let norm = (twice * (2 * n + 1) as f64 * factorials).sqrt();
                if let Some((c_bar, s_bar)) = coefficients.next().filter(|_| m <= order) {
                    c[n][m] = norm * c_bar;
                    s[n][m] = norm * s_bar;
                }
            }
        }
        let (v, w) = ([[0.0; SIDE]; SIDE], [[0.0; SIDE]; SIDE]);
        Self {
            degree,
            order,
            c,
            s,
            v,
            w,
        }
    }

    /// Acceleration beyond the point mass's, m/s², in the Earth-fixed axes that the position (m) is given in.
    pub fn acceleration(&mut self, position_m: DVec3) -> DVec3 {
        self.harmonics(position_m);
        let (v, w) = (&self.v, &self.w);
        let (mut x, mut y, mut z) = (0.0, 0.0, 0.0);
        // Summed from the smallest terms to the largest.
        for n in (2..=self.degree).rev() {
            for m in (0..=self.order.min(n)).rev() {
                let (c, s) = (self.c[n][m], self.s[n][m]);
                let (v1, w1) = (&v[n + 1], &w[n + 1]);
                if m == 0 {
                    x -= c * v1[1];
                    y -= c * w1[1];
                } else {
                    let factor = 0.5 * ((n - m + 1) * (n - m + 2)) as f64;
                    x += 0.5 * (-c * v1[m + 1] - s * w1[m + 1])
                        + factor * (c * v1[m - 1] + s * w1[m - 1]);
                    y += 0.5 * (-c * w1[m + 1] + s * v1[m + 1])
                        + factor * (-c * w1[m - 1] + s * v1[m - 1]);
                }
                z -= (n - m + 1) as f64 * (c * v1[m] + s * w1[m]);
            }
        }
        let radius = EGM96_EQUATORIAL_RADIUS_M;
        DVec3::new(x, y, z) * (EARTH_GM_M3_S2 / (radius * radius))
    }

    /// Potential beyond the point mass's, m²/s², positive where the field is stronger.
    #[cfg(test)]
    pub fn potential(&mut self, position_m: DVec3) -> f64 {
        self.harmonics(position_m);
        let (v, w) = (&self.v, &self.w);
        let mut sum = 0.0;
        for n in (2..=self.degree).rev() {
            for m in 0..=self.order.min(n) {
                sum += self.c[n][m] * v[n][m] + self.s[n][m] * w[n][m];
            }
        }
        sum * EARTH_GM_M3_S2 / EGM96_EQUATORIAL_RADIUS_M
    }

    /// Fills V and W.
    fn harmonics(&mut self, position_m: DVec3) {
        let (v, w) = (&mut self.v, &mut self.w);
        let r2 = position_m.length_squared();
        let scaled = position_m * (EGM96_EQUATORIAL_RADIUS_M / r2);
        let rho = EGM96_EQUATORIAL_RADIUS_M * EGM96_EQUATORIAL_RADIUS_M / r2;
        v[0][0] = rho.sqrt();
        for m in 0..=(self.order + 1).min(self.degree + 1) {
            if m > 0 {
                let odd = (2 * m - 1) as f64;
                let (a, b) = (v[m - 1][m - 1], w[m - 1][m - 1]);
                v[m][m] = odd * (scaled.x * a - scaled.y * b);
                w[m][m] = odd * (scaled.x * b + scaled.y * a);
            }
            for n in m + 1..=self.degree + 1 {
                let first = (2 * n - 1) as f64 * scaled.z;
                let second = (n + m - 1) as f64 * rho;
                let below = |h: &Harmonics| if n >= m + 2 { h[n - 2][m] } else { 0.0 };
                v[n][m] = (first * v[n - 1][m] - second * below(v)) / (n - m) as f64;
                w[n][m] = (first * w[n - 1][m] - second * below(w)) / (n - m) as f64;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constants::EGM96_J2;

    #[test]
    fn flattening_by_its_closed_form() {
        // a = −(3/2) J2 μ R²/r⁵ (x(1 − 5z²/r²), y(1 − 5z²/r²), z(3 − 5z²/r²)), Vallado 2013, 8-30.
        let mut field = Field::new(2, 0);
        for p in [
            DVec3::new(7e6, 1e5, -2e6),
            DVec3::new(0.0, 0.0, 7e6),
            DVec3::new(-1e6, 2e7, 3e7),
        ] {
            let r = p.length();
            let u = 5.0 * p.z * p.z / (r * r);
            let factor =
                -1.5 * EGM96_J2 * EARTH_GM_M3_S2 * EGM96_EQUATORIAL_RADIUS_M.powi(2) / r.powi(5);
            let expected = factor * DVec3::new(p.x * (1.0 - u), p.y * (1.0 - u), p.z * (3.0 - u));
            assert!((field.acceleration(p) - expected).length() < 1e-13 * expected.length());
        }
    }

    #[test]
    fn acceleration_is_the_slope_of_the_potential() {
        for (degree, order) in [(2, 0), (6, 0), (4, 4), (20, 20), (20, 7)] {
            let mut field = Field::new(degree, order);
            for p in [
                DVec3::new(5e6, 3e6, -3e6),
                DVec3::new(1.0, -2.0, 6.5e6),
                DVec3::new(-6.6e6, 1e5, 10.0),
            ] {
                let mut slope = |axis: DVec3| {
                    (field.potential(p + axis * 50.0) - field.potential(p - axis * 50.0)) / 100.0
                };
                let by_difference = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
                let exact = field.acceleration(p);
                assert!(
                    (exact - by_difference).length() < 2e-8 * exact.length(),
                    "{degree} {order} {p}: {exact} {by_difference}"
                );
                assert!(exact.is_finite());
            }
        }
    }

    #[test]
    fn the_field_is_that_of_the_normal_ellipsoid_but_for_mountains() {
        // Normal gravity of WGS84 (NIMA TR8350.2): 9.7803253359 m/s² at the equator, 9.8321849378 at the poles; the turn
        // of the Earth takes ω²a away at the equator. Anomalies of the field to degree 20 stay below 1e-3 m/s².
        let mut field = Field::new(20, 20);
        let mut down = |p: DVec3| {
            -(field.acceleration(p) - p * (EARTH_GM_M3_S2 / p.length().powi(3))).dot(p.normalize())
        };
        let pole = down(DVec3::new(0.0, 0.0, 6_356_752.314));
        assert!((pole - 9.832_185).abs() < 1e-3, "{pole}");
        for k in 0..36 {
            let (sin, cos) = (f64::from(k) * 10.0).to_radians().sin_cos();
            let equator = down(DVec3::new(cos, sin, 0.0) * 6_378_137.0)
                - 7.292_115e-5_f64.powi(2) * 6_378_137.0;
            assert!((equator - 9.780_325).abs() < 1e-3, "{k}: {equator}");
        }
    }
}
