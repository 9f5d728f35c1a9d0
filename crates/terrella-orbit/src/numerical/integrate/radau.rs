//! Radau IIA, order 5: implicit, stable for any eigenvalue to the left (Hairer & Wanner 1996, Solving Ordinary Differential
//! Equations II, IV.8, code RADAU5).

use super::dop853::StepOutcome;
use super::lu::Lu;
use super::{Counts, Dense, Equations, Step, add, is_finite, scaled};
use num_complex::Complex64;

/// √6.
const S6: f64 = 2.449_489_742_783_178;
const C: [f64; 3] = [(4.0 - S6) / 10.0, (4.0 + S6) / 10.0, 1.0];
/// Error estimate from the three stages.
const E: [f64; 3] = [
    (-13.0 - 7.0 * S6) / 3.0,
    (-13.0 + 7.0 * S6) / 3.0,
    -1.0 / 3.0,
];
/// Eigenvalues of the inverse of the method's matrix, one real and a pair.
const MU: f64 = 3.637_834_252_744_496;
const MU_PAIR: Complex64 = Complex64::new(2.681_082_873_627_752_3, -3.050_430_199_247_410_5);
/// Its eigenvectors, and the inverse.
const T: [[f64; 3]; 3] = [
    [
        0.094_438_762_488_975_24,
        -0.141_255_295_020_954_2,
        0.030_029_194_105_147_42,
    ],
    [
        0.250_213_122_965_333_3,
        0.204_129_352_293_799_94,
        -0.382_942_112_757_261_9,
    ],
    [1.0, 1.0, 0.0],
];
const T_INVERSE: [[f64; 3]; 3] = [
    [
        4.178_718_591_551_905,
        0.327_682_820_761_062_37,
        0.523_376_445_499_449_5,
    ],
    [
        -4.178_718_591_551_905,
        -0.327_682_820_761_062_37,
        0.476_623_554_500_550_44,
    ],
    [
        0.502_872_634_945_786_8,
        -2.571_926_949_855_605,
        0.596_039_204_828_224_9,
    ],
];
/// The collocation polynomial from the three stages: coefficients of x, x², x³.
const P: [[f64; 3]; 3] = [
    [
        (13.0 + 7.0 * S6) / 3.0,
        (-23.0 - 22.0 * S6) / 3.0,
        (10.0 + 15.0 * S6) / 3.0,
    ],
    [
        (13.0 - 7.0 * S6) / 3.0,
        (-23.0 + 22.0 * S6) / 3.0,
        (10.0 - 15.0 * S6) / 3.0,
    ],
    [1.0 / 3.0, -8.0 / 3.0, 10.0 / 3.0],
];
/// Rounds of Newton's method before the step is made shorter.
const MAX_NEWTON_ROUNDS: u32 = 6;

/// State of the method between steps.
#[derive(Clone, Debug)]
pub(super) struct Radau<const N: usize> {
    jacobian: Option<[[f64; N]; N]>,
    jacobian_is_fresh: bool,
    decomposed: Option<(f64, Lu<f64, N>, Lu<Complex64, N>)>,
    before: Option<(Step<N>, f64)>,
    /// Newton's method stops when its error is this fraction of the tolerance.
    newton_share: f64,
    after_rejection: bool,
}

struct Stages<const N: usize> {
    z: [[f64; N]; 3],
    rounds: u32,
    rate: f64,
}

impl<const N: usize> Radau<N> {
    /// `relative` is the relative tolerance behind the norm.
    pub fn new(relative: f64) -> Self {
        Self {
            jacobian: None,
            jacobian_is_fresh: false,
            decomposed: None,
            before: None,
            newton_share: (10.0 * f64::EPSILON / relative).max(relative.sqrt().min(0.03)),
            after_rejection: false,
        }
    }

    /// Largest eigenvalue of the last Jacobian by size, 1/s, as a few rounds of the power method see it.
    pub fn spectral_radius(&self, norm: impl Fn(&[f64; N]) -> f64) -> f64 {
        let Some(j) = &self.jacobian else { return 0.0 };
        let mut x: [f64; N] = std::array::from_fn(|i| 1.0 / (i as f64 + 1.3));
        let mut growth = 0.0;
        for _ in 0..12 {
            let size = norm(&x);
            if size == 0.0 || !size.is_finite() {
                return growth;
            }
            x = scaled(&x, 1.0 / size);
            x = j.map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum());
            growth = norm(&x);
        }
        growth
    }

    /// One try of a step of length `h`; `f0` is f(t0, y0).
    pub fn step(
        &mut self,
        equations: &mut impl Equations<N>,
        (t0, y0, f0): (f64, &[f64; N], &[f64; N]),
        h: f64,
        counts: &mut Counts,
    ) -> StepOutcome<N> {
        let reject = |this: &mut Self, factor: f64, counts: &mut Counts| {
            this.after_rejection = true;
            counts.rejected += 1;
            StepOutcome::Rejected { next_h: factor * h }
        };
        if self.jacobian.is_none() {
            self.jacobian = Some(jacobian(equations, t0, y0, f0, counts));
            self.jacobian_is_fresh = true;
            self.decomposed = None;
        }
        if self
            .decomposed
            .as_ref()
            .is_none_or(|(length, ..)| *length != h)
        {
            let Some(j) = &self.jacobian else {
                return reject(self, 0.5, counts);
            };
            let pair = MU_PAIR / h;
            counts.decompositions += 1;
            self.decomposed = match (Lu::of_shifted(MU / h, j), Lu::of_shifted(pair, j)) {
                (Some(real), Some(complex)) => Some((h, real, complex)),
                _ => return reject(self, 0.5, counts),
            };
        }
        let Some((_, real, complex)) = &self.decomposed else {
            return reject(self, 0.5, counts);
        };
        let start = self.start(t0, y0, h);
        let solved = solve(
            equations,
            (t0, y0, h),
            start,
            (real, complex),
            self.newton_share,
            counts,
        );
        let Some(stages) = solved else {
            if self.jacobian_is_fresh {
                return reject(self, 0.5, counts);
            }
            // An old Jacobian is the likelier cause: the same length again with a new one.
            self.jacobian = None;
            return reject(self, 1.0, counts);
        };
        let y1 = add(y0, 1.0, &stages.z[2]);
        let ze: [f64; N] =
            std::array::from_fn(|i| (0..3).map(|s| stages.z[s][i] * E[s]).sum::<f64>() / h);
        let mut estimate = real.solve(&add(f0, 1.0, &ze));
        let mut error = equations
            .norm(&estimate, y0)
            .min(equations.norm(&estimate, &y1));
        if error > 1.0 && self.after_rejection {
            // The estimate itself is not damped for stiff parts; filtered once more it is.
            counts.evaluations += 1;
            let f = equations.derivative(t0, &add(y0, 1.0, &estimate));
            estimate = real.solve(&add(&f, 1.0, &ze));
            error = equations
                .norm(&estimate, y0)
                .min(equations.norm(&estimate, &y1));
        }
        let safety = 0.9 * f64::from(2 * MAX_NEWTON_ROUNDS + 1)
            / f64::from(2 * MAX_NEWTON_ROUNDS + stages.rounds);
        if !error.is_finite() || !is_finite(&y1) {
            return reject(self, 0.1, counts);
        }
        let factor = self.factor(h, error);
        if error > 1.0 {
            return reject(self, (safety * factor).max(0.2), counts);
        }
        let f1 = equations.derivative(t0 + h, &y1);
        counts.evaluations += 1;
        if !is_finite(&f1) {
            return reject(self, 0.1, counts);
        }
        counts.accepted += 1;
        counts.implicit += 1;
        let most = if self.after_rejection { 1.0 } else { 10.0 };
        let mut factor = (safety * factor).min(most);
        self.after_rejection = false;
        self.jacobian_is_fresh = false;
        if stages.rounds > 2 && stages.rate > 1e-3 {
            self.jacobian = None;
        } else if (1.0..1.2).contains(&factor) {
            // As long as before: the decomposition serves again.
            factor = 1.0;
        }
        let dense = Dense::Implicit(Box::new(std::array::from_fn(|power| {
            std::array::from_fn(|i| (0..3).map(|s| stages.z[s][i] * P[s][power]).sum())
        })));
        let step = Step {
            t0,
            h,
            y0: *y0,
            y1,
            f0: *f0,
            f1,
            dense,
        };
        self.before = Some((step.clone(), error));
        StepOutcome::Accepted {
            step,
            next_h: factor * h,
        }
    }

    /// Gustafsson's choice of the next length from this error and the last.
    fn factor(&self, h: f64, error: f64) -> f64 {
        let error = error.max(1e-10);
        let multiplier = match &self.before {
            Some((step, before)) => (h / step.h).abs() * (before.max(1e-10) / error).powf(0.25),
            None => 1.0,
        };
        multiplier.min(1.0) * error.powf(-0.25)
    }

    /// The last step's polynomial drawn on.
    fn start(&self, t0: f64, y0: &[f64; N], h: f64) -> [[f64; N]; 3] {
        match &self.before {
            Some((step, _)) if step.t1() == t0 => C.map(|c| add(&step.at(t0 + c * h), -1.0, y0)),
            _ => [[0.0; N]; 3],
        }
    }
}

/// The three stages by a simplified Newton method; `None` if it does not converge.
fn solve<const N: usize>(
    equations: &mut impl Equations<N>,
    (t0, y0, h): (f64, &[f64; N], f64),
    start: [[f64; N]; 3],
    (real, complex): (&Lu<f64, N>, &Lu<Complex64, N>),
    share: f64,
    counts: &mut Counts,
) -> Option<Stages<N>> {
    let mut z = start;
    let mut w = mixed(&T_INVERSE, &z);
    let mut before: Option<f64> = None;
    let mut rate = 0.0;
    for round in 0..MAX_NEWTON_ROUNDS {
        let mut f = [[0.0; N]; 3];
        for s in 0..3 {
            f[s] = equations.derivative(t0 + C[s] * h, &add(y0, 1.0, &z[s]));
        }
        counts.evaluations += 3;
        if !f.iter().all(is_finite) {
            return None;
        }
        let g = mixed(&T_INVERSE, &f);
        let d0 = real.solve(&add(&g[0], -MU / h, &w[0]));
        let pair: [Complex64; N] = std::array::from_fn(|i| {
            let w = Complex64::new(w[1][i], w[2][i]);
            Complex64::new(g[1][i], g[2][i]) - MU_PAIR / h * w
        });
        let pair = complex.solve(&pair);
        let d = [d0, pair.map(|c| c.re), pair.map(|c| c.im)];
        let size = (d.iter().map(|d| equations.norm(d, y0).powi(2)).sum::<f64>() / 3.0).sqrt();
        if !size.is_finite() {
            return None;
        }
        if let Some(before) = before.filter(|before| *before > 0.0) {
            rate = size / before;
            let left = (MAX_NEWTON_ROUNDS - round) as i32;
            if rate >= 1.0 || rate.powi(left) / (1.0 - rate) * size > share {
                return None;
            }
        }
        w = std::array::from_fn(|s| add(&w[s], 1.0, &d[s]));
        z = mixed(&T, &w);
        let known = before.is_some();
        if size == 0.0 || (known && rate / (1.0 - rate) * size < share) {
            return Some(Stages {
                z,
                rounds: round + 1,
                rate,
            });
        }
        before = Some(size);
    }
    None
}

fn mixed<const N: usize>(matrix: &[[f64; 3]; 3], rows: &[[f64; N]; 3]) -> [[f64; N]; 3] {
    matrix
        .map(|m| std::array::from_fn(|i| m[0] * rows[0][i] + m[1] * rows[1][i] + m[2] * rows[2][i]))
}

fn jacobian<const N: usize>(
    equations: &mut impl Equations<N>,
    t: f64,
    y: &[f64; N],
    f: &[f64; N],
    counts: &mut Counts,
) -> [[f64; N]; N] {
    let mut matrix = [[0.0; N]; N];
    for j in 0..N {
        let mut shifted = *y;
        shifted[j] += equations.increment(j, y);
        let change = shifted[j] - y[j];
        let g = equations.derivative(t, &shifted);
        for i in 0..N {
            matrix[i][j] = (g[i] - f[i]) / change;
        }
    }
    counts.evaluations += N as u64;
    counts.jacobians += 1;
    matrix
}
