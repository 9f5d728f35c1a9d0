//! Geodetic coordinates of a position.

use super::formula::{AnyFormula, ErrorMeasure, Form, Formula};
use super::method::log_spaced;
use super::oracle::Real;
use glam::{DVec2, DVec3};
use terrella::frames::{Ellipsoid, Geodetic};

const FIGURE: Ellipsoid = Ellipsoid::WGS84;

/// Distance of the result from the position, in roundings of the position: |exact position of the result − p| over ε·max(|p|, a).
fn roundings(p: &DVec3, g: &Geodetic) -> f64 {
    if !(g.lat_rad.is_finite() && g.lon_rad.is_finite() && g.height_m.is_finite()) {
        return f64::INFINITY;
    }
    let (a, b) = (
        Real::from(FIGURE.equatorial_radius_m),
        Real::from(FIGURE.polar_radius_m),
    );
    let (lat, lon, h) = (
        Real::from(g.lat_rad),
        Real::from(g.lon_rad),
        Real::from(g.height_m),
    );
    let (sin, cos) = (lat.sin(), lat.cos());
    let root = (a.squared() * cos.squared() + b.squared() * sin.squared()).sqrt();
    let rho = (a.squared() / &root + &h) * cos;
    let z = (b.squared() / &root + &h) * sin;
    let off = [
        &rho * lon.cos() - Real::from(p.x),
        &rho * lon.sin() - Real::from(p.y),
        z - Real::from(p.z),
    ];
    let off = (off[0].squared() + off[1].squared() + off[2].squared()).sqrt();
    off.to_f64() / (f64::EPSILON * p.length().max(FIGURE.equatorial_radius_m))
}

/// Positions at about one height: equator, between, near both poles, and on the axis itself.
fn positions(height_m: f64) -> Vec<DVec3> {
    let degrees = [
        0.0,
        1e-9,
        -20.0,
        30.0,
        45.0,
        -60.0,
        80.0,
        89.0,
        89.999_999,
        -89.999_999_999_9,
        90.0,
        -90.0,
    ];
    degrees
        .into_iter()
        .enumerate()
        .map(|(k, lat)| {
            let lon = -179.0 + 31.0 * k as f64;
            FIGURE.itrf_from_geodetic(Geodetic::from_degrees(
                lat,
                lon,
                height_m * (1.0 + 0.01 * k as f64),
            ))
        })
        .chain([1e-9, 0.0].map(|x| DVec3::new(x, 0.0, FIGURE.polar_radius_m + height_m)))
        .collect()
}

/// Bowring's formula of 1976 as it is printed, with so many rounds: tan β = (z/ρ)(a/b) to begin with, h = ρ/cos φ − N.
fn bowring(p: &DVec3, rounds: u32) -> Geodetic {
    let (a, b) = (FIGURE.equatorial_radius_m, FIGURE.polar_radius_m);
    let e2 = FIGURE.eccentricity_squared();
    let second_e2 = e2 * a * a / (b * b);
    let rho = DVec2::new(p.x, p.y).length();
    let mut beta = (p.z * a / (rho * b)).atan();
    let mut lat_rad = 0.0;
    for _ in 0..rounds {
        let (sin, cos) = beta.sin_cos();
        lat_rad = ((p.z + second_e2 * b * sin.powi(3)) / (rho - e2 * a * cos.powi(3))).atan();
        beta = (b / a * lat_rad.tan()).atan();
    }
    let n = a / (1.0 - e2 * lat_rad.sin().powi(2)).sqrt();
    Geodetic {
        lat_rad,
        lon_rad: p.y.atan2(p.x),
        height_m: rho / lat_rad.cos() - n,
    }
}

/// The closed form of Heikkinen 1982 as it is usually printed (Zhu 1994).
fn heikkinen(p: &DVec3) -> Geodetic {
    let (a, b) = (FIGURE.equatorial_radius_m, FIGURE.polar_radius_m);
    let (a2, b2, z2) = (a * a, b * b, p.z * p.z);
    let rho = DVec2::new(p.x, p.y).length();
    let r2 = rho * rho;
    let e2 = (a2 - b2) / a2;
    let second_e2 = (a2 - b2) / b2;
    let f = 54.0 * b2 * z2;
    let g = r2 + (1.0 - e2) * z2 - e2 * (a2 - b2);
    let c = e2 * e2 * f * r2 / (g * g * g);
    let s = (1.0 + c + (c * c + 2.0 * c).sqrt()).cbrt();
    let k = s + 1.0 + 1.0 / s;
    let p_ = f / (3.0 * k * k * g * g);
    let q = (1.0 + 2.0 * e2 * e2 * p_).sqrt();
    let r0 = -p_ * e2 * rho / (1.0 + q)
        + (0.5 * a2 * (1.0 + 1.0 / q) - p_ * (1.0 - e2) * z2 / (q * (1.0 + q)) - 0.5 * p_ * r2)
            .sqrt();
    let u = ((rho - e2 * r0).powi(2) + z2).sqrt();
    let v = ((rho - e2 * r0).powi(2) + (1.0 - e2) * z2).sqrt();
    let z0 = b2 * p.z / (a * v);
    Geodetic {
        lat_rad: ((p.z + second_e2 * z0) / rho).atan(),
        lon_rad: p.y.atan2(p.x),
        height_m: u * (1.0 - b2 / (a * v)),
    }
}

pub(super) fn formulas() -> Vec<Box<dyn AnyFormula>> {
    vec![Box::new(Formula {
        name: "geodetic coordinates",
        range: "heights from 1 mm to 1e12 m, equator to poles",
        parameter: "height_m",
        values: log_spaced(1e-3, 1e12, 3),
        inputs: positions,
        error_measure: ErrorMeasure::by("roundings of the position", roundings),
        forms: vec![
            Form {
                name: "as printed: Bowring 1976, one round",
                bound: None,
                value: |p| bowring(p, 1),
            },
            Form {
                name: "as printed: Bowring 1976, three rounds",
                bound: None,
                value: |p| bowring(p, 3),
            },
            Form {
                name: "as printed: Heikkinen 1982, closed",
                bound: None,
                value: heikkinen,
            },
            Form {
                name: "stable: rounds of cosines and sines, h without a quotient",
                bound: Some(8.0),
                value: |p| FIGURE.geodetic_from_itrf(*p),
            },
        ],
    })]
}
