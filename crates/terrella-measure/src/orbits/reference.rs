//! The true orbit of a satellite: extrapolation in double-double numbers.

use super::double_double::DoubleDouble;
use glam::DVec3;
use terrella_orbit::constants::{EARTH_GM_M3_S2, EGM96_EQUATORIAL_RADIUS_M, EGM96_J2};

type StateVector = [DoubleDouble; 6];

/// Columns of the extrapolation: order 22.
const COLUMNS: usize = 11;
/// Length of a step times the angular speed of a circular orbit at that distance.
const STEP_RAD: f64 = 0.2;

/// Positions (m) at times in rising order (s, from 0), of a start with position (m) and velocity (m/s), under the Earth's
/// point mass and, with `flattened`, J2 about z.
///
/// Gragg, Bulirsch and Stoer's method with 2, 4, 6… substeps (Hairer, Nørsett & Wanner 1993, II.9): another family than
/// the methods measured, rational coefficients, 32 digits. Steps follow the distance. The greatest difference of the last
/// two columns, metres, is given too.
pub fn positions_m(
    position_m: DVec3,
    velocity_m_s: DVec3,
    flattened: bool,
    times_s: &[f64],
) -> (Vec<DVec3>, f64) {
    let number = DoubleDouble::from;
    let (r, v) = (position_m, velocity_m_s);
    let mut y: StateVector = [r.x, r.y, r.z, v.x, v.y, v.z].map(number);
    let mut t = 0.0;
    let mut worst = 0.0_f64;
    let mut found = Vec::with_capacity(times_s.len());
    for &end in times_s {
        // Whole steps in double-double: the rest is exact, for both are f64.
        while t < end {
            let radius = DVec3::new(y[0].to_f64(), y[1].to_f64(), y[2].to_f64()).length();
            let wished = STEP_RAD * (radius.powi(3) / EARTH_GM_M3_S2).sqrt();
            // A number with few digits, so that t + h is exact.
            let wished = (wished * 64.0).floor().max(1.0) / 64.0;
            let (h, next) = match t + wished >= end {
                true => (end - t, end),
                false => (wished, t + wished),
            };
            let (new, difference) = step(&y, number(h), flattened);
            y = new;
            worst = worst.max(difference);
            t = next;
        }
        found.push(DVec3::new(y[0].to_f64(), y[1].to_f64(), y[2].to_f64()));
    }
    (found, worst)
}

fn step(y: &StateVector, h: DoubleDouble, flattened: bool) -> (StateVector, f64) {
    let mut rows: Vec<StateVector> = Vec::with_capacity(COLUMNS);
    let mut difference = f64::INFINITY;
    for k in 0..COLUMNS {
        let n = 2 * (k as u32 + 1);
        let mut current = midpoint(y, h, n, flattened);
        // Aitken and Neville: T(k, j+1) = T(k, j) + (T(k, j) − T(k−1, j))/((n_k/n_{k−j−1})² − 1).
        for (j, row) in rows.iter_mut().enumerate() {
            let (a, b) = (
                DoubleDouble::from(f64::from(n * n)),
                DoubleDouble::from(f64::from(4 * ((k - j) as u32).pow(2))),
            );
            let weight = b / (a - b);
            let before = std::mem::replace(row, current);
            current = std::array::from_fn(|i| row[i] + (row[i] - before[i]) * weight);
        }
        if let Some(last) = rows.last() {
            let apart: [f64; 3] = std::array::from_fn(|i| (current[i] - last[i]).to_f64());
            difference = DVec3::from(apart).length();
        }
        rows.push(current);
    }
    (rows[COLUMNS - 1], difference)
}

/// Gragg's modified midpoint rule, its last smoothing left out.
fn midpoint(y: &StateVector, h: DoubleDouble, n: u32, flattened: bool) -> StateVector {
    let part = h / DoubleDouble::from(f64::from(n));
    let twice = part + part;
    let mut before = *y;
    let f = derivative(y, flattened);
    let mut now: StateVector = std::array::from_fn(|i| y[i] + part * f[i]);
    for _ in 1..n {
        let f = derivative(&now, flattened);
        let next = std::array::from_fn(|i| before[i] + twice * f[i]);
        (before, now) = (now, next);
    }
    now
}

fn derivative(y: &StateVector, flattened: bool) -> StateVector {
    let number = DoubleDouble::from;
    let [x, y_, z, vx, vy, vz] = *y;
    let r2 = x * x + y_ * y_ + z * z;
    let r = r2.sqrt();
    let mu = number(EARTH_GM_M3_S2) / (r2 * r);
    let (mut equatorial, mut polar) = (-mu, -mu);
    if flattened {
        // −(3/2) J2 μ R²/r⁵ (1 − 5z²/r²), and 3 − 5z²/r² along z.
        let radius = number(EGM96_EQUATORIAL_RADIUS_M);
        let factor = number(-1.5) * number(EGM96_J2) * mu * radius * radius / r2;
        let u = number(5.0) * z * z / r2;
        equatorial = equatorial + factor * (number(1.0) - u);
        polar = polar + factor * (number(3.0) - u);
    }
    [vx, vy, vz, x * equatorial, y_ * equatorial, z * polar]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::oracle::Real;

    /// Two bodies from r and v over `t` by eccentric anomaly, in 320 bits: another formula than the product's.
    fn exact(r0: DVec3, v0: DVec3, t: f64) -> DVec3 {
        let real = |x: f64| Real::from(x);
        let mu = real(EARTH_GM_M3_S2);
        let dot = |a: DVec3, b: DVec3| {
            real(a.x) * real(b.x) + real(a.y) * real(b.y) + real(a.z) * real(b.z)
        };
        let r = dot(r0, r0).sqrt();
        let a = real(1.0) / (real(2.0) / &r - dot(v0, v0) / &mu);
        let sigma = dot(r0, v0) / mu.sqrt() / a.sqrt();
        let c = real(1.0) - &r / &a;
        let mean = (&mu / (&a * &a * &a)).sqrt() * real(t);
        // M = ΔE − c sin ΔE + σ (1 − cos ΔE): rises everywhere; halves first, Newton then.
        let value = |x: &Real| x - &c * x.sin() + &sigma * (real(1.0) - x.cos()) - &mean;
        let (mut low, mut high) = (&mean - real(3.0), &mean + real(3.0));
        for _ in 0..45 {
            let middle = (&low + &high) * real(0.5);
            match value(&middle).is_negative() {
                true => low = middle,
                false => high = middle,
            }
        }
        let mut x = low;
        for _ in 0..5 {
            let slope = real(1.0) - &c * x.cos() + &sigma * x.sin();
            x = &x - value(&x) / slope;
        }
        let f = real(1.0) - &a / &r * (real(1.0) - x.cos());
        let g = real(t) - (&a * &a * &a / &mu).sqrt() * (&x - x.sin());
        let at = |r: f64, v: f64| (&f * real(r) + &g * real(v)).to_f64();
        DVec3::new(at(r0.x, v0.x), at(r0.y, v0.y), at(r0.z, v0.z))
    }

    #[test]
    fn two_references_agree_to_a_nanometre() {
        for (r, v) in [
            (DVec3::new(7e6, 0.0, 1e5), DVec3::new(10.0, 6e3, 4.5e3)),
            (DVec3::new(7e6, 1e5, 0.0), DVec3::new(-50.0, 8e3, 5.5e3)),
            (DVec3::new(9e7, 1e5, 0.0), DVec3::new(-2.8e3, 0.0, 5.5e2)),
        ] {
            let times: Vec<f64> = (1..=8).map(|k| 10_800.0 * f64::from(k)).collect();
            let (found, difference) = positions_m(r, v, false, &times);
            assert!(difference < 1e-9, "{difference:e}");
            for (t, found) in times.iter().zip(found) {
                let off = (found - exact(r, v, *t)).length();
                assert!(off < 1e-8, "{r} {t}: {off:e}");
            }
        }
    }
}
