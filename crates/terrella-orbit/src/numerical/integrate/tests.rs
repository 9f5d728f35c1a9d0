use super::*;

/// Equations as a closure, with one tolerance for all unknowns.
struct Plain<F> {
    f: F,
    relative: f64,
    absolute: f64,
}

impl<const N: usize, F: FnMut(f64, &[f64; N]) -> [f64; N]> Equations<N> for Plain<F> {
    fn derivative(&mut self, t: f64, y: &[f64; N]) -> [f64; N] {
        (self.f)(t, y)
    }
    fn norm(&self, error: &[f64; N], y: &[f64; N]) -> f64 {
        let sum: f64 = (0..N)
            .map(|i| (error[i] / (self.absolute + self.relative * y[i].abs())).powi(2))
            .sum();
        (sum / N as f64).sqrt()
    }
    fn increment(&self, index: usize, y: &[f64; N]) -> f64 {
        1e-8 * y[index].abs().max(1e-5)
    }
}

fn run<const N: usize>(
    solver: Solver,
    tolerance: f64,
    f: impl FnMut(f64, &[f64; N]) -> [f64; N],
    y: [f64; N],
    end: f64,
) -> (Vec<Step<N>>, Counts) {
    let mut plain = Plain {
        f,
        relative: tolerance,
        absolute: 1e-3 * tolerance,
    };
    let mut driver = Driver::new(solver, tolerance, &mut plain, 0.0, y).unwrap();
    let mut steps = Vec::new();
    while driver.t() != end {
        steps.push(driver.step(&mut plain, end).unwrap());
        assert!(steps.len() < 200_000);
    }
    (steps, driver.counts())
}

fn end<const N: usize>(steps: &[Step<N>]) -> [f64; N] {
    steps.last().unwrap().y1
}

/// A pendulum of length 1 under g = 1, its support shaken.
fn pendulum(t: f64, y: &[f64; 2]) -> [f64; 2] {
    [y[1], -y[0].sin() + 0.4 * (1.3 * t).cos()]
}

/// Error after one step, over several starts so that no zero of the error's factor misleads.
fn error_of_one_step(implicit: bool, h: f64, inside: f64) -> f64 {
    let starts = (0..16).map(|k| [2.0 * f64::from(k).cos(), 1.5 * f64::from(k).sin()]);
    let squares = starts.map(|y0| error_from(implicit, y0, h, inside).powi(2));
    squares.sum::<f64>().sqrt()
}

/// Compared with a run at the smallest tolerance.
fn error_from(implicit: bool, y0: [f64; 2], h: f64, inside: f64) -> f64 {
    let mut plain = Plain {
        f: pendulum,
        relative: 1e-15,
        absolute: 1e300,
    };
    let mut counts = Counts::default();
    let f0 = pendulum(0.0, &y0);
    let tried = match implicit {
        true => radau::Radau::new(1e-15).step(
            &mut Plain {
                absolute: 1e-3,
                ..plain
            },
            (0.0, &y0, &f0),
            h,
            &mut counts,
        ),
        false => dop853::Dop853::new().step(&mut plain, (0.0, &y0, &f0), h, &mut counts),
    };
    let dop853::StepOutcome::Accepted { step, .. } = tried else {
        panic!()
    };
    let (exact, _) = run(Solver::Explicit, 1e-15, pendulum, y0, inside * h);
    let found = step.at(inside * h);
    let exact = end(&exact);
    (found[0] - exact[0]).abs().max((found[1] - exact[1]).abs())
}

#[test]
fn the_explicit_method_is_of_order_eight() {
    // The error of one step scales with h⁹, that of the dense output of order 7 with h⁸.
    for (inside, order) in [(1.0, 9.0), (0.4, 8.0)] {
        let (long, short) = (
            error_of_one_step(false, 0.6, inside),
            error_of_one_step(false, 0.3, inside),
        );
        let found = (long / short).log2();
        println!("DOP853 at {inside}: {long:e} {short:e}, order {found:.2} with the step's own");
        assert!((found - order).abs() < 0.7, "{inside}: {found}");
    }
}

#[test]
fn the_implicit_method_is_of_order_five() {
    // The error of one step scales with h⁶, that of the collocation polynomial with h⁴.
    for (inside, order) in [(1.0, 6.0), (0.8, 4.0)] {
        let (long, short) = (
            error_of_one_step(true, 0.2, inside),
            error_of_one_step(true, 0.1, inside),
        );
        let found = (long / short).log2();
        println!("Radau at {inside}: {long:e} {short:e}, order {found:.2} with the step's own");
        assert!((found - order).abs() < 0.4, "{inside}: {found}");
    }
}

#[test]
fn both_families_reach_the_same_place() {
    let start = [1.0, 0.5];
    let (tight, _) = run(Solver::Explicit, 1e-14, pendulum, start, 20.0);
    for tolerance in [1e-4, 1e-6, 1e-8, 1e-10] {
        for solver in [Solver::Explicit, Solver::Implicit] {
            let (steps, counts) = run(solver, tolerance, pendulum, start, 20.0);
            let error = (end(&steps)[0] - end(&tight)[0]).abs();
            println!(
                "{solver:?} {tolerance:e}: error {error:.1e}, {} evaluations",
                counts.evaluations
            );
            assert!(
                error < 30.0 * tolerance,
                "{solver:?} {tolerance:e}: {error:e}"
            );
        }
    }
}

#[test]
fn dense_output_is_as_good_as_the_steps() {
    let (tight, _) = run(Solver::Explicit, 1e-14, pendulum, [1.0, 0.5], 20.0);
    let exact = |t: f64| tight.iter().find(|s| t <= s.t1()).unwrap().at(t);
    let (steps, _) = run(Solver::Explicit, 1e-9, pendulum, [1.0, 0.5], 20.0);
    let worst = (0..2000)
        .map(|k| f64::from(k) * 0.01)
        .map(|t| (steps.iter().find(|s| t <= s.t1()).unwrap().at(t)[0] - exact(t)[0]).abs())
        .fold(0.0, f64::max);
    assert!(worst < 3e-8, "{worst:e}");
    for step in &steps {
        let t = step.t0;
        assert_eq!(step.at(t), step.y0);
        assert!((step.at(step.t1())[0] - step.y1[0]).abs() < 1e-14);
    }
}

/// Van der Pol's oscillator with ε = 1e-6, for one time unit (Hairer & Wanner 1996, IV.10), start (2, −0.66).
fn van_der_pol(_: f64, y: &[f64; 2]) -> [f64; 2] {
    [y[1], ((1.0 - y[0] * y[0]) * y[1] - y[0]) / 1e-6]
}

#[test]
fn stiff_problems_are_solved_and_cost_little() {
    // Reference at t = 2 from the test set of Bari (Mazzia & Magherini 2008, problem vdpol).
    let exact = [0.170_616_773_217_045_4e1, -0.892_809_701_024_796];
    for solver in [Solver::Implicit, Solver::Automatic] {
        let (steps, counts) = run(solver, 1e-8, van_der_pol, [2.0, 0.0], 2.0);
        let error = (end(&steps)[0] - exact[0])
            .abs()
            .max((end(&steps)[1] - exact[1]).abs());
        println!("van der Pol by {solver:?}: error {error:.1e}, {counts:?}");
        assert!(error < 2e-6, "{solver:?}: {error:e} {:?}", end(&steps));
        assert!(counts.evaluations < 40_000, "{counts:?}");
    }
    // Robertson's kinetics over eleven decades: the sum stays 1; reference at 1e11 from the same test set.
    let robertson = |_: f64, y: &[f64; 3]| {
        let (a, b) = (0.04 * y[0], 3e7 * y[1] * y[1]);
        let c = 1e4 * y[1] * y[2];
        [-a + c, a - c - b, b]
    };
    let (steps, counts) = run(Solver::Automatic, 1e-7, robertson, [1.0, 0.0, 0.0], 1e11);
    let y = end(&steps);
    println!("Robertson: {y:?} {counts:?}");
    assert!(
        (y[0] / 0.208_334_014_970_125_8e-7 - 1.0).abs() < 1e-4,
        "{y:?}"
    );
    assert!((y[0] + y[1] + y[2] - 1.0).abs() < 1e-6);
    assert!(counts.evaluations < 20_000);
}

#[test]
fn automatic_goes_to_the_implicit_method_and_comes_back() {
    // Stiff only between t = 1 and t = 2.
    let f = |t: f64, y: &[f64; 2]| {
        let k = if (1.0..2.0).contains(&t) { 1e5 } else { 0.0 };
        [y[1], -25.0 * y[0] - k * (y[1] + 0.1)]
    };
    let (_, counts) = run(Solver::Automatic, 1e-8, f, [1.0, 0.0], 12.0);
    let (_, explicit) = run(Solver::Explicit, 1e-8, f, [1.0, 0.0], 12.0);
    println!("automatic {counts:?}\nexplicit {explicit:?}");
    assert!(counts.switches >= 2 && counts.implicit < counts.accepted);
    assert!(counts.evaluations * 10 < explicit.evaluations);
}

#[test]
fn steps_go_backwards_too() {
    let (there, _) = run(Solver::Explicit, 1e-12, pendulum, [1.0, 0.5], 7.0);
    let y = end(&there);
    for solver in [Solver::Explicit, Solver::Implicit] {
        let (back, _) = run(solver, 1e-10, |t, y| pendulum(t + 7.0, y), y, -7.0);
        assert!(
            (end(&back)[0] - 1.0).abs() < 1e-8 && (end(&back)[1] - 0.5).abs() < 1e-8,
            "{solver:?}"
        );
    }
}

#[test]
fn a_solution_that_ends_is_an_error() {
    // y′ = y² ends at t = 1 from y = 1: the steps grow shorter and shorter.
    for solver in [Solver::Explicit, Solver::Implicit, Solver::Automatic] {
        let mut plain = Plain {
            f: |_: f64, y: &[f64; 1]| [y[0] * y[0]],
            relative: 1e-9,
            absolute: 1e-9,
        };
        let mut driver = Driver::new(solver, 1e-9, &mut plain, 0.0, [1.0]).unwrap();
        let mut steps = 0;
        let fault = loop {
            match driver.step(&mut plain, 2.0) {
                Ok(step) => assert!(step.y1[0].is_finite()),
                Err(fault) => break fault,
            }
            steps += 1;
            assert!(steps < 100_000, "{solver:?}");
        };
        assert_eq!(fault, IntegrationFault::Underflow);
        assert!((driver.t() - 1.0).abs() < 1e-6, "{solver:?} {}", driver.t());
    }
    let mut nan = Plain {
        f: |_: f64, _: &[f64; 1]| [f64::NAN],
        relative: 1e-9,
        absolute: 1e-9,
    };
    assert_eq!(
        Driver::new(Solver::Explicit, 1e-9, &mut nan, 0.0, [1.0]).unwrap_err(),
        IntegrationFault::NotFinite
    );
}
