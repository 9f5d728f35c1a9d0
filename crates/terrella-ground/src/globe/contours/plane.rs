//! Best-fit planes, each with two contour planes that enclose the points.
//!
//! c = mean of the points, M = Σ (p − c)(p − c)ᵀ. The normal is the eigenvector of M's smallest eigenvalue. Jacobi rotations find it; they
//! keep eigenvectors orthogonal to rounding however close eigenvalues are. All computations are in f64 about a local origin: Earth-centred
//! metres in f32 keep each coordinate to half a metre, and nothing of M.

use glam::{DMat3, DVec3};

/// How far points determine a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// Three or more that are not collinear.
    Plane,
    /// All collinear: of the planes through the line, the one whose normal is nearest to `up`.
    Line,
    /// All at one point, or none: the plane through it whose normal is `up`.
    Point,
}

/// A plane with its two contours, which are parallel to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contour {
    /// Unit normal, on the same side as `up`.
    pub normal: DVec3,
    /// The centroid, metres from the origin of the points. Distances are measured from here.
    pub at_m: DVec3,
    /// Signed distance of the lower contour plane, metres along the normal: d_min ≤ 0.
    pub low_m: f64,
    /// Signed distance of the upper one: d_max ≥ 0.
    pub high_m: f64,
    /// How far the points determine the plane.
    pub support: Support,
}

impl Contour {
    /// Thickness of the slab, metres.
    pub fn thickness_m(&self) -> f64 {
        self.high_m - self.low_m
    }

    /// The same plane with contours that enclose these points.
    pub fn over(self, points_m: impl Iterator<Item = DVec3>) -> Self {
        let (mut low_m, mut high_m) = (0.0f64, 0.0f64);
        for p in points_m {
            let d = self.normal.dot(p - self.at_m);
            low_m = low_m.min(d);
            high_m = high_m.max(d);
        }
        Self {
            low_m,
            high_m,
            ..self
        }
    }

    /// Signed distance of a point from the plane halfway between the contours, metres.
    pub fn distance_m(&self, point_m: DVec3) -> f64 {
        self.normal.dot(point_m - self.at_m) - 0.5 * (self.low_m + self.high_m)
    }
}

/// Factor on the square of a geometric mean: the square of a tenth of the rounding of f64.
const NEGLIGIBLE: f64 = 1e-2 * f64::EPSILON * f64::EPSILON;

/// Eigenvalues of a symmetric matrix, smallest first, and their unit eigenvectors, by cyclic Jacobi rotations. Entries that are not finite
/// give finite vectors without meaning.
pub fn eigen(symmetric: DMat3) -> ([f64; 3], [DVec3; 3]) {
    let mut a: [[f64; 3]; 3] = symmetric.to_cols_array_2d();
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Converges quadratically: random matrices of any scaling took at most six sweeps.
    for _ in 0..12 {
        let off = a[0][1].abs() + a[0][2].abs() + a[1][2].abs();
        if off == 0.0 || !off.is_finite() {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            // An entry below the rounding of both of its diagonals rotates neither of their vectors.
            if a[p][q] * a[p][q] <= NEGLIGIBLE * (a[p][p] * a[q][q]).abs() {
                a[p][q] = 0.0;
                a[q][p] = 0.0;
                continue;
            }
            // t = tan of the angle, the smaller root of t² + 2θt = 1.
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            // Beyond 10¹⁵⁴ the square is infinite and t = 0: the omitted rotation is below any rounding.
            let t = if theta.is_finite() {
                1.0f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt())
            } else {
                0.0
            };
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            let r = 3 - p - q;
            let (arp, arq, apq) = (a[r][p], a[r][q], a[p][q]);
            a[p][p] -= t * apq;
            a[q][q] += t * apq;
            a[p][q] = 0.0;
            a[q][p] = 0.0;
            a[r][p] = c * arp - s * arq;
            a[p][r] = a[r][p];
            a[r][q] = s * arp + c * arq;
            a[q][r] = a[r][q];
            for row in &mut v {
                let (vp, vq) = (row[p], row[q]);
                row[p] = c * vp - s * vq;
                row[q] = s * vp + c * vq;
            }
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|i, j| a[*i][*i].total_cmp(&a[*j][*j]));
    let vector = |k: usize| DVec3::new(v[0][k], v[1][k], v[2][k]).normalize_or(DVec3::Z);
    (order.map(|k| a[k][k]), order.map(vector))
}

/// Below this fraction of the largest eigenvalue, an eigenvalue is rounding and not extent: squares of 1e-7 of the size.
const ROUNDING: f64 = 1e-14;

/// Fits a plane to points, in metres from a local origin, and measures its contours. `up` is a unit vector; it is used where the points do
/// not determine the plane.
pub fn fit(up: DVec3, points_m: impl Iterator<Item = DVec3> + Clone) -> Contour {
    let first = points_m.clone().next().unwrap_or_default();
    let (mut count, mut sum) = (0u64, DVec3::ZERO);
    for p in points_m.clone() {
        count += 1;
        sum += p - first;
    }
    let center = first + sum / count.max(1) as f64;
    let mut m = DMat3::ZERO;
    for p in points_m.clone() {
        let d = p - center;
        m += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    let (normal, support) = normal_of(m, center, count, up);
    let contour = Contour {
        normal,
        at_m: center,
        low_m: 0.0,
        high_m: 0.0,
        support,
    };
    contour.over(points_m)
}

fn normal_of(m: DMat3, center: DVec3, count: u64, up: DVec3) -> (DVec3, Support) {
    let (values, vectors) = eigen(m);
    // Largest error in M from rounding of the coordinates alone.
    let noise = count as f64 * (4.0 * f64::EPSILON * center.length()).powi(2);
    if values[2] <= noise {
        return (up, Support::Point);
    }
    if values[1] <= (ROUNDING * values[2]).max(noise) {
        // The component of `up` perpendicular to the line; for a line along `up`, the axis least along it.
        let line = vectors[2];
        let across = up - line * up.dot(line);
        let normal = if across.length() > 1e-7 {
            across
        } else {
            line.any_orthogonal_vector()
        };
        return (normal.normalize_or(up), Support::Line);
    }
    let normal = if vectors[0].dot(up) < 0.0 {
        -vectors[0]
    } else {
        vectors[0]
    };
    (normal, Support::Plane)
}

/// [`fit`] for points in a slice.
pub fn fit_points(up: DVec3, points_m: &[DVec3]) -> Contour {
    fit(up, points_m.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudorandom numbers in −1…1.
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn grid(n: i32, step: f64, f: impl Fn(f64, f64) -> f64) -> Vec<DVec3> {
        let at = |k: i32| f64::from(k) * step;
        (0..n * n)
            .map(|k| DVec3::new(at(k % n), at(k / n), f(at(k % n), at(k / n))))
            .collect()
    }

    #[test]
    fn a_plane_is_found_again_with_noise_and_far_from_the_origin() {
        let mut seed = 7;
        for _ in 0..200 {
            let slope = (2.0 * noise(&mut seed), 2.0 * noise(&mut seed));
            let truth = DVec3::new(-slope.0, -slope.1, 1.0).normalize();
            let far = DVec3::new(noise(&mut seed), noise(&mut seed), noise(&mut seed)) * 1e5;
            let points: Vec<_> = grid(9, 30.0, |x, y| slope.0 * x + slope.1 * y)
                .into_iter()
                .map(|p| p + far)
                .collect();
            let contour = fit_points(DVec3::Z, &points);
            assert_eq!(contour.support, Support::Plane);
            assert!(contour.normal.angle_between(truth) < 1e-7);
            assert!((contour.normal - truth).length() < 1e-12);
            assert!(contour.thickness_m() < 1e-9);
            // Points displaced along the normal by ±1 m: the slab is 2 m.
            let rough: Vec<_> = points
                .iter()
                .enumerate()
                .map(|(k, p)| *p + truth * if k % 2 == 0 { 1.0 } else { -1.0 })
                .collect();
            let contour = fit_points(DVec3::Z, &rough);
            assert!((contour.normal - truth).length() < 2e-3);
            assert!((contour.thickness_m() - 2.0).abs() < 0.5);
            for p in rough {
                let d = contour.normal.dot(p - contour.at_m);
                assert!((contour.low_m..=contour.high_m).contains(&d));
            }
        }
    }

    #[test]
    fn eigenvectors_hold_against_their_equation() {
        let mut seed = 3;
        let mut worst: f64 = 0.0;
        for k in 0..2_000 {
            let scale = 10f64.powi(k % 25 - 12);
            let squash = DVec3::new(1.0, 10f64.powi(-(k % 9)), 10f64.powi(-(k % 13)));
            let b = DMat3::from_cols_array(&std::array::from_fn(|_| noise(&mut seed)));
            let b = DMat3::from_diagonal(squash) * b;
            let m = b.transpose() * b * scale;
            let (values, vectors) = eigen(m);
            let size = values[2].abs().max(1e-300);
            assert!(values[0] <= values[1] && values[1] <= values[2]);
            for (value, vector) in values.iter().zip(vectors) {
                let off = (m * vector - vector * *value).length() / size;
                worst = worst.max(off);
            }
            let cross = vectors[0].dot(vectors[1]).abs() + vectors[1].dot(vectors[2]).abs();
            worst = worst.max(cross);
        }
        println!("|Mv − λv|/λ₃ and |v·w|: {worst:.1e}");
        assert!(worst < 5e-15);
    }

    #[test]
    fn degenerate_points_answer_the_stated_plane() {
        let up = DVec3::new(0.0, 0.6, 0.8);
        let none = fit_points(up, &[]);
        assert_eq!((none.normal, none.support), (up, Support::Point));
        for at in [DVec3::ZERO, DVec3::new(1e7, -3.0, 0.1)] {
            let one = fit_points(up, &[at]);
            assert_eq!(
                (one.normal, one.at_m, one.support),
                (up, at, Support::Point)
            );
            let same = fit_points(up, &[at; 50]);
            assert_eq!((same.normal, same.support), (up, Support::Point));
            assert!(same.thickness_m() == 0.0);
            for line in [DVec3::X, DVec3::new(1.0, 2.0, -3.0), up, -up] {
                let points: Vec<_> = (0..20).map(|k| at + line * f64::from(k)).collect();
                let fit = fit_points(up, &points);
                assert_eq!(fit.support, Support::Line, "{at} {line}");
                assert!((fit.normal.length() - 1.0).abs() < 1e-12);
                assert!(fit.normal.dot(line).abs() < 1e-6 * line.length());
                assert!(fit.thickness_m() < 1e-6);
                // No other plane through the line is nearer to `up`.
                let across = (up - line * up.dot(line) / line.length_squared()).length();
                assert!((fit.normal.dot(up) - across).abs() < 1e-6);
            }
        }
        let two = fit_points(DVec3::Z, &[DVec3::ZERO, DVec3::new(1.0, 0.0, 1.0)]);
        assert_eq!(two.support, Support::Line);
        assert!((two.normal - DVec3::new(-1.0, 0.0, 1.0).normalize()).length() < 1e-12);
    }

    /// M in Earth-centred metres and single precision, for a field of 30 m posts.
    #[test]
    fn single_precision_about_the_centre_of_the_earth_loses_the_plane() {
        let up = DVec3::new(0.6, 0.48, 0.64);
        let east = up.cross(DVec3::Z).normalize();
        let north = east.cross(up);
        let (slope_e, slope_n) = (0.05, -0.02);
        let truth = (up - east * slope_e - north * slope_n).normalize();
        let local: Vec<_> = grid(9, 30.0, |x, y| slope_e * x + slope_n * y)
            .into_iter()
            .map(|p| east * p.x + north * p.y + up * p.z)
            .collect();
        let ours = (fit_points(up, &local).normal - truth)
            .length()
            .to_degrees();
        // The textbook one-pass form, Σ ppᵀ − n·ccᵀ, all in f32.
        let center = up * 6_371_000.0;
        let (mut m, mut sum) = (glam::Mat3::ZERO, glam::Vec3::ZERO);
        for p in &local {
            let p = (*p + center).as_vec3();
            m += glam::Mat3::from_cols(p * p.x, p * p.y, p * p.z);
            sum += p;
        }
        let c = sum / local.len() as f32;
        m -= glam::Mat3::from_cols(c * c.x, c * c.y, c * c.z) * local.len() as f32;
        let naive = eigen(m.as_dmat3()).1[0];
        let naive = naive.dot(truth).abs().min(1.0).acos().to_degrees();
        println!("normal off by {ours:.1e}° here, by {naive:.1}° from Earth-centred f32");
        assert!(ours < 1e-5);
        assert!(naive > 1.0);
    }
}
