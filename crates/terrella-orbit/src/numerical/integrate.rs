//! Solvers of ordinary differential equations with few unknowns, with dense output.
//!
//! | file | content |
//! |---|---|
//! | `dop853.rs`, `tableau.rs` | explicit, order 8, dense output of order 7 |
//! | `radau.rs`, `lu.rs` | implicit, order 5, for stiff stretches |
//! | `driver.rs` | selects one of them, or switches between them |
//!
//! Our own, because a propagator needs all of these together: unknowns on the stack, the dense output of every step, an error norm that
//! distinguishes metres from metres per second, counts of all work, and switching between the two methods during the integration. The available
//! crates each lack one, and the Radau method of `differential-equations` 0.7 does not converge.

mod dop853;
mod driver;
mod lu;
mod radau;
mod tableau;
#[cfg(test)]
mod tests;

pub use driver::Solver;
pub(crate) use driver::{Driver, IntegrationFault};

/// ẏ = f(t, y), with the scale of y for a solver.
pub(crate) trait Equations<const N: usize> {
    /// f(t, y).
    fn derivative(&mut self, t: f64, y: &[f64; N]) -> [f64; N];

    /// Size of an error in y, 1 where it is just allowed.
    fn norm(&self, error: &[f64; N], y: &[f64; N]) -> f64;

    /// Increment of one unknown for a difference quotient; not 0.
    fn increment(&self, index: usize, y: &[f64; N]) -> f64;
}

/// Work of an integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Evaluations of the force, those for Jacobians and for dense output included.
    pub evaluations: u64,
    /// Steps accepted.
    pub accepted: u64,
    /// Steps rejected.
    pub rejected: u64,
    /// Steps among the accepted that the implicit method took.
    pub implicit: u64,
    /// Jacobians by difference quotients.
    pub jacobians: u64,
    /// LU decompositions.
    pub decompositions: u64,
    /// Changes from one method to the other.
    pub switches: u64,
}

/// One step with its dense output.
#[derive(Clone, Debug)]
pub(crate) struct Step<const N: usize> {
    /// Time at which the step begins, seconds.
    pub t0: f64,
    /// Its length; below 0 backwards.
    pub h: f64,
    /// y where it begins.
    pub y0: [f64; N],
    /// y where it ends.
    pub y1: [f64; N],
    /// f where it begins.
    pub f0: [f64; N],
    /// f where it ends.
    pub f1: [f64; N],
    /// The polynomial that interpolates the step.
    pub dense: Dense<N>,
}

/// Coefficients of a dense output.
#[derive(Clone, Debug)]
pub(crate) enum Dense<const N: usize> {
    /// DOP853's polynomial of order 7.
    Explicit(Box<[[f64; N]; 7]>),
    /// Radau's collocation polynomial, order 3: coefficients of x, x², x³ for x from 0 to 1.
    Implicit(Box<[[f64; N]; 3]>),
}

impl<const N: usize> Step<N> {
    /// Time at which the step ends, seconds.
    pub fn t1(&self) -> f64 {
        self.t0 + self.h
    }

    /// y inside the step.
    pub fn at(&self, t: f64) -> [f64; N] {
        let x = (t - self.t0) / self.h;
        let mut y = [0.0; N];
        match &self.dense {
            Dense::Explicit(terms) => {
                for (k, term) in terms.iter().rev().enumerate() {
                    let factor = if k % 2 == 0 { x } else { 1.0 - x };
                    for (y, term) in y.iter_mut().zip(term) {
                        *y = (*y + term) * factor;
                    }
                }
            }
            Dense::Implicit(terms) => {
                for term in terms.iter().rev() {
                    for (y, term) in y.iter_mut().zip(term) {
                        *y = (*y + term) * x;
                    }
                }
            }
        }
        add(&self.y0, 1.0, &y)
    }
}

/// a + factor b.
fn add<const N: usize>(a: &[f64; N], factor: f64, b: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] + factor * b[i])
}

fn scaled<const N: usize>(a: &[f64; N], factor: f64) -> [f64; N] {
    a.map(|x| factor * x)
}

fn is_finite<const N: usize>(a: &[f64; N]) -> bool {
    a.iter().all(|x| x.is_finite())
}
