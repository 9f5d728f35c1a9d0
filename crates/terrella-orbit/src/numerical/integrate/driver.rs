//! Takes one step after the other, by the method that suits: DOP853, or Radau IIA where the motion is stiff.

use super::dop853::{Dop853, StepOutcome};
use super::radau::Radau;
use super::{Counts, Equations, Step, is_finite};

/// Which method of integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Solver {
    /// DOP853 until it finds the motion stiff, Radau IIA until it no longer is.
    #[default]
    Automatic,
    /// DOP853 throughout: order 8, fifteen evaluations a step with dense output.
    Explicit,
    /// Radau IIA throughout: order 5, for motion that is known to be stiff.
    Implicit,
}

/// Why there is no next step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum IntegrationFault {
    /// The step has become too short to advance the time.
    Underflow,
    /// The derivative is not a finite number at the last point reached.
    NotFinite,
}

/// Steps of the implicit method that an explicit one would have taken too, before it is given back.
const NONSTIFF_STEPS: u32 = 10;
/// Length times largest eigenvalue below which the explicit method is not held back.
const NONSTIFF_RADIUS: f64 = 3.0;

/// An integration on its way: the last point, and the method that takes the next step.
#[derive(Clone, Debug)]
pub(crate) struct Driver<const N: usize> {
    solver: Solver,
    relative: f64,
    t: f64,
    y: [f64; N],
    f: [f64; N],
    /// Length to try next, with its sign; 0 before the first.
    h: f64,
    explicit: Dop853,
    implicit: Option<Radau<N>>,
    nonstiff_steps: u32,
    counts: Counts,
}

impl<const N: usize> Driver<N> {
    /// Starts at (t, y). `relative` is the relative tolerance behind the equations' norm.
    pub fn new(
        solver: Solver,
        relative: f64,
        equations: &mut impl Equations<N>,
        t: f64,
        y: [f64; N],
    ) -> Result<Self, IntegrationFault> {
        let mut driver = Self {
            solver,
            relative,
            t,
            y,
            f: [0.0; N],
            h: 0.0,
            explicit: Dop853::new(),
            implicit: (solver == Solver::Implicit).then(|| Radau::new(relative)),
            nonstiff_steps: 0,
            counts: Counts::default(),
        };
        driver.restart(equations, y)?;
        Ok(driver)
    }

    /// Goes on from another y, or with another derivative, at the same time: after a step in the force.
    pub fn restart(
        &mut self,
        equations: &mut impl Equations<N>,
        y: [f64; N],
    ) -> Result<(), IntegrationFault> {
        self.y = y;
        self.f = equations.derivative(self.t, &y);
        self.counts.evaluations += 1;
        self.explicit = Dop853::new();
        if self.implicit.is_some() {
            self.implicit = Some(Radau::new(self.relative));
        }
        self.h = 0.0;
        match is_finite(&self.f) && is_finite(&y) {
            true => Ok(()),
            false => Err(IntegrationFault::NotFinite),
        }
    }

    pub fn t(&self) -> f64 {
        self.t
    }

    pub fn y(&self) -> &[f64; N] {
        &self.y
    }

    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// The next step, which does not pass `limit`; `limit` must differ from the current time.
    pub fn step(
        &mut self,
        equations: &mut impl Equations<N>,
        limit: f64,
    ) -> Result<Step<N>, IntegrationFault> {
        let direction = (limit - self.t).signum();
        if self.h == 0.0 || self.h.signum() != direction {
            self.h = direction * self.first_length(equations, direction);
        }
        loop {
            let rest = limit - self.t;
            // Not a crumb left over: the last step but one is made shorter, or the last longer, by little.
            let whole = self.h.abs() >= rest.abs() * (1.0 - 1e-9);
            let h = match whole {
                true => rest,
                false if self.h.abs() > 0.5 * rest.abs() => 0.5 * rest,
                false => self.h,
            };
            if self.t + h == self.t || h.abs() < 4.0 * f64::EPSILON * self.t.abs() {
                return Err(match is_finite(&self.f) {
                    true => IntegrationFault::Underflow,
                    false => IntegrationFault::NotFinite,
                });
            }
            let from = (self.t, &self.y, &self.f);
            let tried = match &mut self.implicit {
                Some(radau) => radau.step(equations, from, h, &mut self.counts),
                None => self.explicit.step(equations, from, h, &mut self.counts),
            };
            match tried {
                StepOutcome::Rejected { next_h } => {
                    self.h = next_h;
                    self.change_method(equations, h);
                }
                StepOutcome::Accepted { step, next_h } => {
                    // A step shortened by the limit is no guide to the size of the next one.
                    self.h = match h.abs() < 0.99 * self.h.abs() && next_h.abs() < self.h.abs() {
                        true => self.h,
                        false => next_h,
                    };
                    self.t = if whole { limit } else { step.t1() };
                    self.y = step.y1;
                    self.f = step.f1;
                    self.change_method(equations, h);
                    return Ok(step);
                }
            }
        }
    }

    fn change_method(&mut self, equations: &mut impl Equations<N>, h: f64) {
        if self.solver != Solver::Automatic {
            return;
        }
        match &self.implicit {
            None if self.explicit.is_stiff() => {
                self.implicit = Some(Radau::new(self.relative));
                self.nonstiff_steps = 0;
                self.counts.switches += 1;
            }
            None => {}
            Some(radau) => {
                let y = &self.y;
                let radius = radau.spectral_radius(|x| equations.norm(x, y));
                self.nonstiff_steps = if h.abs() * radius < NONSTIFF_RADIUS {
                    self.nonstiff_steps + 1
                } else {
                    0
                };
                if self.nonstiff_steps >= NONSTIFF_STEPS {
                    self.implicit = None;
                    self.explicit = Dop853::new();
                    self.counts.switches += 1;
                }
            }
        }
    }

    /// A first length from the sizes of y, f and f′ (Hairer, Nørsett & Wanner 1993, II.4).
    fn first_length(&mut self, equations: &mut impl Equations<N>, direction: f64) -> f64 {
        let (d0, d1) = (
            equations.norm(&self.y, &self.y),
            equations.norm(&self.f, &self.y),
        );
        let guess = match d0 > 0.0 && d1 > 0.0 {
            true => 0.01 * d0 / d1,
            false => 1e-6,
        };
        let y = super::add(&self.y, direction * guess, &self.f);
        let f = equations.derivative(self.t + direction * guess, &y);
        self.counts.evaluations += 1;
        let d2 = equations.norm(&super::add(&f, -1.0, &self.f), &self.y) / guess;
        let largest = d1.max(d2);
        let by_order = match largest > 1e-15 && largest.is_finite() {
            true => (0.01 / largest).powf(0.125),
            false => guess * 1e-3,
        };
        (100.0 * guess).min(by_order).max(1e-9)
    }
}
