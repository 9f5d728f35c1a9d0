//! Intersection of a ray with the ellipsoid: the nearer root of |e + t·d| = 1 in scaled space.

use super::formula::{AnyFormula, ErrorMeasure, Form, Formula};
use super::method::log_spaced;
use super::oracle::{Real, along, dot, real3};
use glam::{DMat3, DVec3};
use terrella::frames::Ellipsoid;

/// A ray from outside, in scaled space.
pub(super) struct Ray {
    pub eye: DVec3,
    /// Of any length.
    pub direction: DVec3,
}

impl Ray {
    /// A ray from `height` above the unit sphere that passes its centre at the distance `pass`, turned into no
    /// particular direction by `turn`.
    fn passing(height: f64, pass: f64, turn: f64) -> Self {
        let axes = DMat3::from_rotation_z(0.7 + turn) * DMat3::from_rotation_x(0.4 - turn);
        let distance = 1.0 + height;
        let sine = pass / distance;
        let cosine = ((1.0 - sine) * (1.0 + sine)).max(0.0).sqrt();
        Self {
            eye: axes * DVec3::new(distance, 0.0, 0.0),
            direction: axes * DVec3::new(-cosine, sine, 0.0) * (1.0 + turn),
        }
    }

    /// |e|² − 1 as the product computes it.
    fn above(&self) -> f64 {
        let distance = self.eye.length();
        (distance - 1.0) * (distance + 1.0)
    }
}

/// Backward error of a root, metres: the displacement of the sphere's surface for which the result would be exact.
///
/// A resulting point must lie on the surface. No point (NaN) is correct for a ray that misses; for one that does not, its error is the depth of the
/// ray below the surface. A forward error would describe the ray rather than the formula: near the limb the ground runs along the ray.
fn backward_error_m(ray: &Ray, t: f64) -> f64 {
    let radius = Real::from(Ellipsoid::WGS84.equatorial_radius_m);
    let (e, d) = (real3(ray.eye), real3(ray.direction));
    let one = Real::from(1.0);
    let off = if t.is_nan() {
        let (square, e_d) = (dot(&d, &d), dot(&e, &d));
        let pass = (dot(&e, &e) - e_d.squared() / square).sqrt();
        if pass >= one {
            return 0.0;
        }
        one - pass
    } else if t.is_infinite() {
        return t.abs();
    } else {
        let p = along(&e, &Real::from(t), &d);
        dot(&p, &p).sqrt() - one
    };
    (off.abs() * radius).to_f64()
}

/// Rays of all kinds from one height: towards the middle, to the side, and within 2⁻⁴⁰ of the limb on either side.
fn rays_from(height_m: f64) -> Vec<Ray> {
    let height = height_m / Ellipsoid::WGS84.equatorial_radius_m;
    let near = [4, 10, 20, 30, 40].map(|k| 2f64.powi(-k));
    let passes = [0.0, 0.3, 0.7]
        .into_iter()
        .chain(near.map(|off| 1.0 - off))
        .chain(near.map(|off| 1.0 + off));
    passes
        .filter(|pass| *pass < 1.0 + height)
        .enumerate()
        .map(|(k, pass)| Ray::passing(height, pass, 0.05 * k as f64))
        .collect()
}

/// Rays from 400 km that pass 2⁻ᵏ of the radius inside and outside the limb.
fn grazing(k: f64) -> Vec<Ray> {
    let off = 2f64.powf(-k);
    [1.0 - off, 1.0 + off]
        .into_iter()
        .flat_map(|pass| (0..4).map(move |turn| Ray::passing(0.0627, pass, 0.1 * f64::from(turn))))
        .collect()
}

/// t = (−b − √(b² − 4ac))/2a, b = 2e·d.
fn school(ray: &Ray) -> f64 {
    let a = ray.direction.length_squared();
    let b = 2.0 * ray.eye.dot(ray.direction);
    let c = ray.eye.length_squared() - 1.0;
    (-b - (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}

/// t = −b − √(b² − c) for a unit direction, b = e·d.
fn halved(ray: &Ray) -> f64 {
    let length = ray.direction.length();
    let d = ray.direction / length;
    let b = ray.eye.dot(d);
    let c = ray.eye.length_squared() - 1.0;
    (-b - (b * b - c).sqrt()) / length
}

/// t = c/(−e·d + √(|d|² − |e × d|²)), c = (|e| − 1)(|e| + 1): Lagrange's identity, and the root as a sum.
fn lagrange(ray: &Ray) -> f64 {
    let (e, d) = (ray.eye, ray.direction);
    ray.above() / ((d.length_squared() - e.cross(d).length_squared()).sqrt() - e.dot(d))
}

fn forms(bound_m: f64) -> Vec<Form<Ray>> {
    vec![
        Form {
            name: "as printed: (−b − √(b² − 4ac))/2a",
            bound: None,
            value: school,
        },
        Form {
            name: "halved: −b − √(b² − c)",
            bound: None,
            value: halved,
        },
        Form {
            name: "stable: c/(−e·d + √(|d|² − |e × d|²))",
            bound: Some(bound_m),
            value: lagrange,
        },
    ]
}

pub(super) fn formulas() -> Vec<Box<dyn AnyFormula>> {
    let error_measure = || ErrorMeasure::by("m", |ray: &Ray, t: &f64| backward_error_m(ray, *t));
    vec![
        Box::new(Formula {
            name: "ray and ellipsoid, by height",
            range: "heights from 1 mm to 1e12 m, rays from the middle to 2⁻⁴⁰ R off the limb",
            parameter: "height_m",
            values: log_spaced(1e-3, 1e12, 3),
            inputs: rays_from,
            error_measure: error_measure(),
            forms: forms(1e-3),
        }),
        Box::new(Formula {
            name: "ray and ellipsoid, grazing",
            range: "from 400 km, rays that pass the limb at R(1 ± 2⁻ᵏ), k from 1 to 52",
            parameter: "k",
            values: (1..=52).map(f64::from).collect(),
            inputs: grazing,
            error_measure: error_measure(),
            forms: forms(1e-8),
        }),
    ]
}
