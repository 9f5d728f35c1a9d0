//! The explicit method of order 8 by Dormand and Prince.

use super::tableau::{A, C, D, E3, E5, Row};
use super::{Counts, Dense, Equations, Step, add, is_finite, scaled};

/// Bounds on the change of the step's length.
const MIN_FACTOR: f64 = 0.3;
const MAX_FACTOR: f64 = 6.0;
const SAFETY: f64 = 0.9;
/// Share of the last error in the choice of the step (a PI controller; Hairer & Wanner 1996, IV.2).
const BETA: f64 = 0.04;
/// Product of step size and largest eigenvalue at the edge of the region of stability.
const STABLE: f64 = 6.1;

/// State of the method between steps.
#[derive(Clone, Debug)]
pub(super) struct Dop853 {
    error_before: f64,
    after_rejection: bool,
    stiff: u32,
    not_stiff: u32,
}

/// Result of an attempted step.
pub(super) enum StepOutcome<const N: usize> {
    /// The step, and the length to try next.
    Accepted { step: Step<N>, next_h: f64 },
    /// The length to try instead.
    Rejected { next_h: f64 },
}

impl Dop853 {
    pub fn new() -> Self {
        Self {
            error_before: 1e-4,
            after_rejection: false,
            stiff: 0,
            not_stiff: 0,
        }
    }

    /// Fifteen steps were cut short by stability, not by the error (Hairer & Wanner 1996, IV.2).
    pub fn is_stiff(&self) -> bool {
        self.stiff >= 15
    }

    /// One try of a step of length `h`; `f0` is f(t0, y0).
    pub fn step<const N: usize>(
        &mut self,
        equations: &mut impl Equations<N>,
        (t0, y0, f0): (f64, &[f64; N], &[f64; N]),
        h: f64,
        counts: &mut Counts,
    ) -> StepOutcome<N> {
        let mut k = [[0.0; N]; 16];
        k[0] = *f0;
        let mut y12 = *y0;
        for s in 1..12 {
            let y = add(y0, h, &sum(A[s], &k));
            k[s] = equations.derivative(t0 + C[s] * h, &y);
            y12 = y;
        }
        counts.evaluations += 11;
        let y1 = add(y0, h, &sum(A[12], &k));
        let (e5, e3) = (sum(E5, &k), sum(E3, &k));
        let largest = |e: &[f64; N]| equations.norm(e, y0).min(equations.norm(e, &y1));
        let (e5, e3) = (largest(&e5), largest(&e3));
        let error = match e5 == 0.0 && e3 == 0.0 {
            true => 0.0,
            false => h.abs() * e5 * e5 / (e5 * e5 + 0.01 * e3 * e3).sqrt(),
        };
        if !error.is_finite() || !is_finite(&y1) {
            self.after_rejection = true;
            counts.rejected += 1;
            return StepOutcome::Rejected { next_h: 0.1 * h };
        }
        let by_error = error.powf(0.125 - 0.2 * BETA);
        if error > 1.0 {
            self.after_rejection = true;
            counts.rejected += 1;
            let factor = (SAFETY / by_error).max(MIN_FACTOR);
            return StepOutcome::Rejected { next_h: factor * h };
        }
        let f1 = equations.derivative(t0 + h, &y1);
        counts.evaluations += 1;
        if !is_finite(&f1) {
            self.after_rejection = true;
            counts.rejected += 1;
            return StepOutcome::Rejected { next_h: 0.1 * h };
        }
        k[12] = f1;
        self.watch_stiffness(
            h.abs() * equations.norm(&add(&f1, -1.0, &k[11]), &y1),
            equations.norm(&add(&y1, -1.0, &y12), &y1),
        );
        for s in 13..16 {
            let y = add(y0, h, &sum(A[s], &k));
            k[s] = equations.derivative(t0 + C[s] * h, &y);
        }
        counts.evaluations += 3;
        counts.accepted += 1;
        let most = if self.after_rejection {
            1.0
        } else {
            MAX_FACTOR
        };
        let factor = (SAFETY * self.error_before.powf(BETA) / by_error).clamp(MIN_FACTOR, most);
        self.error_before = error.max(1e-4);
        self.after_rejection = false;
        StepOutcome::Accepted {
            step: Step {
                t0,
                h,
                y0: *y0,
                y1,
                f0: *f0,
                f1,
                dense: dense(y0, &y1, &k, h),
            },
            next_h: factor * h,
        }
    }

    /// The last stage and the new point are at the same time: the ratio of the differences of their derivatives and of their values estimates the
    /// largest eigenvalue.
    fn watch_stiffness(&mut self, derivatives: f64, values: f64) {
        if values > 0.0 && derivatives / values > STABLE {
            self.not_stiff = 0;
            self.stiff += 1;
        } else {
            self.not_stiff += 1;
            if self.not_stiff == 6 {
                self.stiff = 0;
            }
        }
    }
}

fn dense<const N: usize>(y0: &[f64; N], y1: &[f64; N], k: &[[f64; N]; 16], h: f64) -> Dense<N> {
    let difference = add(y1, -1.0, y0);
    let slope = add(&scaled(&k[0], h), -1.0, &difference);
    let bend = add(&add(&difference, -h, &k[12]), -1.0, &slope);
    let [d0, d1, d2, d3] = D.map(|row| scaled(&sum(row, k), h));
    Dense::Explicit(Box::new([difference, slope, bend, d0, d1, d2, d3]))
}

fn sum<const N: usize>(row: Row, k: &[[f64; N]; 16]) -> [f64; N] {
    let mut sum = [0.0; N];
    for &(stage, weight) in row {
        for (sum, k) in sum.iter_mut().zip(&k[stage]) {
            *sum += weight * k;
        }
    }
    sum
}
