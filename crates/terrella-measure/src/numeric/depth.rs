//! Distance resolution of an f32 depth buffer.

use super::formula::{AnyFormula, ErrorMeasure, Form, Formula};
use super::method::log_spaced;
use super::oracle::Real;
use glam::{DMat4, Vec4};
use terrella::EyeView;
use terrella::internals::earth::infinite_reversed_z;

const FAR_M: f64 = 1e13;

/// The depth that the GPU finds for a point straight ahead: the matrix of f64 is handed over as f32, as it is drawn with.
fn depth(clip_from_view: DMat4, distance_m: f64) -> f32 {
    let clip = clip_from_view.as_mat4() * Vec4::new(0.0, 0.0, -(distance_m as f32), 1.0);
    clip.z / clip.w
}

/// Depth of a point straight ahead, near plane at [`EyeView::NEAR_M`] and depth 1, infinity at 0.
pub fn reversed_depth(distance_m: f64) -> f32 {
    depth(infinite_reversed_z(0.8, 1.6, EyeView::NEAR_M), distance_m)
}

/// Depth of the same point with the near plane at 0 and 1e13 m at 1.
pub fn standard_depth(distance_m: f64) -> f32 {
    let (near, far) = (EyeView::NEAR_M, FAR_M);
    let mut standard = infinite_reversed_z(0.8, 1.6, near);
    standard.z_axis.z = -far / (far - near);
    standard.w_axis.z = -near * far / (far - near);
    depth(standard, distance_m)
}

pub(super) fn formulas() -> Vec<Box<dyn AnyFormula>> {
    vec![Box::new(Formula {
        name: "distance from depth",
        range: "distances from 0.1 m to 1e12 m, near plane at 0.1 m",
        parameter: "distance_m",
        values: log_spaced(0.1, 1e12, 4),
        inputs: |at| (0..8).map(|k| at * (1.0 + 0.031 * f64::from(k))).collect(),
        error_measure: ErrorMeasure::relative(|distance_m| Real::from(*distance_m)),
        forms: vec![
            Form {
                name: "as usual: near at 0, 1e13 m at 1",
                bound: None,
                value: |distance_m| {
                    let (near, far) = (EyeView::NEAR_M, FAR_M);
                    near * far / (far - f64::from(standard_depth(*distance_m)) * (far - near))
                },
            },
            Form {
                name: "stable: reversed, infinity at 0",
                bound: Some(3e-7),
                value: |distance_m| EyeView::NEAR_M / f64::from(reversed_depth(*distance_m)),
            },
        ],
    })]
}
