//! The paper's square: its distance L2 from the eye and its side S.

use super::formula::{AnyFormula, ErrorMeasure, Form, Formula};
use super::method::log_spaced;
use super::oracle::Real;
use terrella::frames::Ellipsoid;
use terrella_ground::air::horizon_square;

pub(super) struct EyeAboveSphere {
    pub radius_m: f64,
    pub height_m: f64,
}

impl EyeAboveSphere {
    pub fn exact(&self) -> (Real, Real) {
        (Real::from(self.radius_m), Real::from(self.height_m))
    }
}

/// Heights about `height_m`, none of them round.
fn heights_about(height_m: f64) -> Vec<EyeAboveSphere> {
    let radius_m = Ellipsoid::PAPER_SPHERE.equatorial_radius_m;
    (0..8)
        .map(|k| EyeAboveSphere {
            radius_m,
            height_m: height_m * (1.0 + 0.031 * f64::from(k)),
        })
        .collect()
}

/// A formula of the height of an eye above a sphere, from 1 mm to 1e12 m.
pub(super) fn over_heights(
    name: &'static str,
    error_measure: ErrorMeasure<EyeAboveSphere>,
    forms: Vec<Form<EyeAboveSphere>>,
) -> Box<dyn AnyFormula> {
    Box::new(Formula {
        name,
        range: "heights from 1 mm to 1e12 m",
        parameter: "height_m",
        values: log_spaced(1e-3, 1e12, 4),
        inputs: heights_about,
        error_measure,
        forms,
    })
}

/// L1 and L2 as the paper prints them: R²/L and L − L1.
fn printed(eye: &EyeAboveSphere) -> (f64, f64) {
    let l = eye.radius_m + eye.height_m;
    let l1 = eye.radius_m * eye.radius_m / l;
    (l1, l - l1)
}

/// L2 = h(h + 2R)/(R + h).
fn l2() -> Box<dyn AnyFormula> {
    over_heights(
        "billboard, distance L2",
        ErrorMeasure::relative(|eye| {
            let (r, h) = eye.exact();
            &h * (&h + &r + &r) / (r + h)
        }),
        vec![
            Form {
                name: "as printed: L − R²/L",
                bound: None,
                value: |eye| printed(eye).1,
            },
            Form {
                name: "stable: h(L + R)/L",
                bound: Some(1e-15),
                value: |eye| {
                    horizon_square(eye.radius_m, eye.height_m).map_or(f64::NAN, |square| square.l2)
                },
            },
        ],
    )
}

/// S = 2R√(h(h + 2R))/(R + h).
fn side() -> Box<dyn AnyFormula> {
    over_heights(
        "billboard, side S",
        ErrorMeasure::relative(|eye| {
            let (r, h) = eye.exact();
            let tangent = (&h * (&h + &r + &r)).sqrt();
            (&r + &r) * tangent / (r + h)
        }),
        vec![
            Form {
                name: "as printed: 2√(L1·L2), L2 = L − R²/L",
                bound: None,
                value: |eye| {
                    let (l1, l2) = printed(eye);
                    2.0 * (l1 * l2).sqrt()
                },
            },
            Form {
                name: "stable: 2R√(h(L + R))/L",
                bound: Some(1e-15),
                value: |eye| {
                    horizon_square(eye.radius_m, eye.height_m)
                        .map_or(f64::NAN, |square| square.side)
                },
            },
        ],
    )
}

pub(super) fn formulas() -> Vec<Box<dyn AnyFormula>> {
    vec![l2(), side()]
}
