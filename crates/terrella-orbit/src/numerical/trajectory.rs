//! An integrated stretch of motion: steps with their dense output.

use super::integrate::{Dense, Step};
use glam::DVec3;

/// One step as it is kept: enough to evaluate it.
#[derive(Clone, Debug)]
struct StepPolynomial {
    t0: f64,
    h: f64,
    kind: PolynomialKind,
}

#[derive(Clone, Debug)]
enum PolynomialKind {
    /// DOP853's own polynomial, order 7.
    Explicit(Box<([f64; 6], [[f64; 6]; 7])>),
    /// Position, velocity and acceleration at both ends: a polynomial of degree 5 and its derivative. Radau's own is only of degree 3 and does not
    /// use the second derivative.
    Hermite(Box<[DVec3; 6]>),
}

impl StepPolynomial {
    fn new(step: Step<6>) -> Self {
        let first = |y: &[f64; 6]| DVec3::new(y[0], y[1], y[2]);
        let last = |y: &[f64; 6]| DVec3::new(y[3], y[4], y[5]);
        let kind = match step.dense {
            Dense::Explicit(terms) => PolynomialKind::Explicit(Box::new((step.y0, *terms))),
            Dense::Implicit(_) => {
                let h = step.h;
                let (p0, v0, a0) = (
                    first(&step.y0),
                    last(&step.y0) * h,
                    last(&step.f0) * (h * h),
                );
                let (p1, v1, a1) = (
                    first(&step.y1),
                    last(&step.y1) * h,
                    last(&step.f1) * (h * h),
                );
                // p(x) = Σ c_k x^k with value, slope and bend at 0 and 1.
                let (d, dv, da) = (p1 - p0 - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0);
                PolynomialKind::Hermite(Box::new([
                    p0,
                    v0,
                    0.5 * a0,
                    10.0 * d - 4.0 * dv + 0.5 * da,
                    -15.0 * d + 7.0 * dv - da,
                    6.0 * d - 3.0 * dv + 0.5 * da,
                ]))
            }
        };
        Self {
            t0: step.t0,
            h: step.h,
            kind,
        }
    }

    fn at(&self, t: f64) -> (DVec3, DVec3) {
        let x = (t - self.t0) / self.h;
        match &self.kind {
            PolynomialKind::Explicit(parts) => {
                let (y0, terms) = &**parts;
                let mut y = [0.0; 6];
                for (k, term) in terms.iter().rev().enumerate() {
                    let factor = if k % 2 == 0 { x } else { 1.0 - x };
                    for (y, term) in y.iter_mut().zip(term) {
                        *y = (*y + term) * factor;
                    }
                }
                let y: [f64; 6] = std::array::from_fn(|i| y0[i] + y[i]);
                (DVec3::new(y[0], y[1], y[2]), DVec3::new(y[3], y[4], y[5]))
            }
            PolynomialKind::Hermite(c) => {
                let position = c.iter().rev().fold(DVec3::ZERO, |sum, c| sum * x + *c);
                let slope = (1..6)
                    .rev()
                    .fold(DVec3::ZERO, |sum, k| sum * x + c[k] * k as f64);
                (position, slope / self.h)
            }
        }
    }
}

/// Steps in the order of time, seconds from an epoch; joined without gaps.
#[derive(Clone, Debug, Default)]
pub(super) struct Trajectory {
    backward: Vec<StepPolynomial>,
    forward: Vec<StepPolynomial>,
}

impl Trajectory {
    pub fn push(&mut self, step: Step<6>) {
        match step.h < 0.0 {
            true => self.backward.push(StepPolynomial::new(step)),
            false => self.forward.push(StepPolynomial::new(step)),
        }
    }

    /// Position (m) and velocity (m/s) at `t`, which is within the span; `None` if there is no step at all.
    pub fn at(&self, t: f64) -> Option<(DVec3, DVec3)> {
        let backwards = (t < 0.0 && !self.backward.is_empty()) || self.forward.is_empty();
        let segments = if backwards {
            &self.backward
        } else {
            &self.forward
        };
        let after = segments.partition_point(|s| if backwards { s.t0 >= t } else { s.t0 <= t });
        let segment = segments.get(after.saturating_sub(1))?;
        Some(segment.at(t))
    }

    /// Number of steps kept.
    pub fn len(&self) -> usize {
        self.backward.len() + self.forward.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_implicit_steps_is_a_polynomial_of_degree_five() {
        // Position t⁵ − 2t³ + t in x, t² in y.
        let y = |t: f64| {
            [
                t.powi(5) - 2.0 * t.powi(3) + t,
                t * t,
                1.0,
                5.0 * t.powi(4) - 6.0 * t * t + 1.0,
                2.0 * t,
                0.0,
            ]
        };
        let f = |t: f64| [y(t)[3], y(t)[4], 0.0, 20.0 * t.powi(3) - 12.0 * t, 2.0, 0.0];
        for (t0, h) in [(0.3, 2.0), (1.7, -1.1)] {
            let t1 = t0 + h;
            let step = Step {
                t0,
                h,
                y0: y(t0),
                y1: y(t1),
                f0: f(t0),
                f1: f(t1),
                dense: Dense::Implicit(Box::new([[0.0; 6]; 3])),
            };
            let segment = StepPolynomial::new(step);
            for part in [0.0, 0.2, 0.7, 1.0] {
                let t = t0 + part * h;
                let (position, velocity) = segment.at(t);
                assert!((position - DVec3::new(y(t)[0], y(t)[1], 1.0)).length() < 1e-13);
                assert!((velocity - DVec3::new(y(t)[3], y(t)[4], 0.0)).length() < 1e-12);
            }
        }
    }
}
