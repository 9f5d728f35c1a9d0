//! Dip of the horizon.

use super::formula::{AnyFormula, ErrorMeasure, Form};
use super::limb::{EyeAboveSphere, over_heights};
use super::oracle::Real;
use glam::DVec3;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella_play::camera::dip_rad;

fn exact(eye: &EyeAboveSphere) -> Real {
    let (r, h) = eye.exact();
    ((&h * (&h + &r + &r)).sqrt() / r).atan()
}

/// The horizon camera's dip over a sphere, from the eye's position.
fn from_position(eye: &EyeAboveSphere) -> f64 {
    let sphere = Ellipsoid {
        equatorial_radius_m: eye.radius_m,
        polar_radius_m: eye.radius_m,
    };
    let place = Geodetic {
        lat_rad: 0.3,
        lon_rad: -2.0,
        height_m: eye.height_m,
    };
    let vertical = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let ahead = DVec3::Z.cross(vertical).normalize();
    dip_rad(&sphere, sphere.itrf_from_geodetic(place), ahead, vertical)
}

pub(super) fn formulas() -> Vec<Box<dyn AnyFormula>> {
    vec![
        over_heights(
            "dip of the horizon, from the height",
            ErrorMeasure::relative(exact),
            vec![
                Form {
                    name: "as printed: acos(R/L)",
                    bound: None,
                    value: |eye: &EyeAboveSphere| {
                        (eye.radius_m / (eye.radius_m + eye.height_m)).acos()
                    },
                },
                Form {
                    name: "stable: atan(√(h(L + R))/R)",
                    bound: Some(1e-15),
                    value: |eye| {
                        let l = eye.radius_m + eye.height_m;
                        (eye.height_m.sqrt() * (l + eye.radius_m).sqrt()).atan2(eye.radius_m)
                    },
                },
            ],
        ),
        // A position near the ground has the height to nanometres only, whatever the formula makes of it.
        over_heights(
            "dip of the horizon, from the eye's position",
            ErrorMeasure::absolute("rad", exact),
            vec![
                Form {
                    name: "as printed: asin(√(|e|² − R²)/|e|)",
                    bound: None,
                    value: |eye: &EyeAboveSphere| {
                        let l = eye.radius_m + eye.height_m;
                        ((l * l - eye.radius_m * eye.radius_m).sqrt() / l).asin()
                    },
                },
                Form {
                    name: "the horizon camera's",
                    bound: Some(1e-10),
                    value: from_position,
                },
            ],
        ),
    ]
}
