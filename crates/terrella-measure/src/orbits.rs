//! Propagators compared: error against run time, and conserved quantities.
//!
//! | file | content |
//! |---|---|
//! | `reference.rs`, `double_double.rs` | the true orbit, to 32 digits |
//! | `table.rs` | the comparison as a table |
//! | `stiff.rs` | a stiff problem: a fall through the air |
//! | `interpolation.rs` | interpolated ephemerides by degree and step, as a table |

mod double_double;
mod interpolation;
mod reference;
mod stiff;
mod table;

pub use interpolation::interpolation_csv;
pub use reference::positions_m;
pub use stiff::StiffFall;
pub use table::{OrbitRow, csv, rows};

use super::numeric::{Method, Sweep, Work};
use glam::DVec3;
use std::cell::OnceCell;
use std::hint::black_box;
use terrella::frames::{Duration, Epoch};
use terrella_orbit::constants::{EARTH_GM_M3_S2, EGM96_EQUATORIAL_RADIUS_M, EGM96_J2};
use terrella_orbit::kepler::{
    Anomaly, Drift, KeplerElements, KeplerFeed, KeplerOptions, OrbitSize,
};
use terrella_orbit::numerical::{
    ForceModel, Gravity, NumericalFeed, NumericalOptions, Solver, Spacecraft,
};
use terrella_orbit::{Feed, Frame, OrbitState};

/// The parameter that trades error for run time.
pub const TOLERANCE: &str = "relative_tolerance";

/// Instants of a span that are compared.
const SAMPLED_INSTANTS: u32 = 24;

/// The methods that are compared: a conic, or an integrator.
const VARIANTS: [(&str, Option<Solver>); 3] = [
    ("conic", None),
    ("DOP853", Some(Solver::Explicit)),
    ("Radau IIA", Some(Solver::Implicit)),
];

/// One orbit over one span.
#[derive(Clone, Debug)]
pub struct OrbitCase {
    name: String,
    start: OrbitState,
    flattened: bool,
    span: Duration,
    reference: OnceCell<Vec<DVec3>>,
}

/// A case propagated by one method.
#[derive(Clone, Debug)]
struct PropagatedRun {
    states: Vec<OrbitState>,
    evaluations: u64,
}

impl OrbitCase {
    /// Perigee at 7000 km from the centre; long ellipses begin half the span before it, so that it is passed.
    ///
    /// `None` if the numbers make no orbit.
    pub fn new(eccentricity: f64, flattened: bool, days: f64) -> Option<Self> {
        let epoch = Epoch::from_gregorian_tai_at_noon(2018, 1, 15);
        let span = Duration::from_days(days);
        let passage = if eccentricity > 0.9 {
            epoch + span * 0.5
        } else {
            epoch
        };
        let elements = KeplerElements {
            size: OrbitSize::Periapsis(7e6),
            eccentricity,
            inclination_rad: 63.4_f64.to_radians(),
            raan_rad: 1.0,
            argument_of_periapsis_rad: 4.7,
            anomaly: Anomaly::PeriapsisAt(passage),
        };
        let (position_m, velocity_m_s) =
            elements.conic(EARTH_GM_M3_S2, epoch).ok()?.state_after(0.0);
        let forces = if flattened { "J2" } else { "two bodies" };
        let unit = if days == 1.0 { "day" } else { "days" };
        Some(Self {
            name: format!("e = {eccentricity}, {forces}, {days} {unit}"),
            start: OrbitState {
                epoch,
                frame: Frame::Gcrf,
                position_m,
                velocity_m_s,
            },
            flattened,
            span,
            reference: OnceCell::new(),
        })
    }

    fn epochs(&self) -> impl Iterator<Item = Epoch> + '_ {
        (1..=SAMPLED_INSTANTS)
            .map(|k| self.start.epoch + self.span * (f64::from(k) / f64::from(SAMPLED_INSTANTS)))
    }

    fn reference(&self) -> &[DVec3] {
        self.reference.get_or_init(|| {
            let times: Vec<f64> = self
                .epochs()
                .map(|at| (at - self.start.epoch).to_seconds())
                .collect();
            positions_m(
                self.start.position_m,
                self.start.velocity_m_s,
                self.flattened,
                &times,
            )
            .0
        })
    }

    /// From the state to the sampled times by one method; `None` if it fails.
    fn propagate(&self, solver: Option<Solver>, relative_tolerance: f64) -> Option<PropagatedRun> {
        let (first, last) = (self.start.epoch, self.start.epoch + self.span);
        let states = |feed: &dyn Feed| -> Option<Vec<OrbitState>> {
            self.epochs().map(|at| feed.state_at(at).ok()).collect()
        };
        let Some(solver) = solver else {
            let drift = if self.flattened {
                Drift::J2
            } else {
                Drift::None
            };
            let feed =
                KeplerFeed::from_state("", &self.start, KeplerOptions { drift, first, last })
                    .ok()?;
            return Some(PropagatedRun {
                states: states(&feed)?,
                evaluations: 0,
            });
        };
        let model = ForceModel {
            gravity: if self.flattened {
                Gravity::ZonalOfJ2000 { degree: 2 }
            } else {
                Gravity::Point
            },
            ..ForceModel::default()
        };
        let options = NumericalOptions {
            relative_tolerance,
            solver,
            ..NumericalOptions::between(first, last)
        };
        let feed =
            NumericalFeed::new("", &self.start, &model, &Spacecraft::default(), &options).ok()?;
        Some(PropagatedRun {
            states: states(&feed)?,
            evaluations: feed.counts().evaluations,
        })
    }

    /// Largest distance from the reference, metres; infinite without one.
    fn error_m(&self, run: Option<&PropagatedRun>) -> f64 {
        let Some(run) = run else {
            return f64::INFINITY;
        };
        let off = run.states.iter().zip(self.reference());
        off.map(|(state, exact)| (state.position_m - *exact).length())
            .fold(0.0, f64::max)
    }

    /// Energy, m²/s², and angular momentum about z, m²/s: what flattening conserves.
    fn conserved(&self, state: &OrbitState) -> (f64, f64) {
        let (r, v) = (state.position_m, state.velocity_m_s);
        let distance = r.length();
        let mut potential = EARTH_GM_M3_S2 / distance;
        if self.flattened {
            let sine = r.z / distance;
            let ratio = EGM96_EQUATORIAL_RADIUS_M / distance;
            potential *= 1.0 - EGM96_J2 * ratio * ratio * (1.5 * sine * sine - 0.5);
        }
        (0.5 * v.length_squared() - potential, r.cross(v).z)
    }

    /// Relative drift of energy and angular momentum.
    fn drifts(&self, run: &PropagatedRun) -> (f64, f64) {
        let (energy, momentum) = self.conserved(&self.start);
        run.states.iter().fold((0.0_f64, 0.0_f64), |(e, m), state| {
            let now = self.conserved(state);
            (
                e.max((now.0 / energy - 1.0).abs()),
                m.max((now.1 / momentum - 1.0).abs()),
            )
        })
    }
}

impl Method for OrbitCase {
    fn name(&self) -> &str {
        &self.name
    }

    fn error_unit(&self) -> &str {
        "m"
    }

    fn variants(&self) -> Vec<&str> {
        VARIANTS.map(|(name, _)| name).into()
    }

    fn sweep(&self) -> Sweep {
        Sweep {
            parameter: TOLERANCE,
            values: vec![1e-6, 1e-8, 1e-10, 1e-12],
        }
    }

    fn error(&self, variant: usize, at: f64) -> f64 {
        let solver = VARIANTS.get(variant).and_then(|(_, solver)| *solver);
        self.error_m(self.propagate(solver, at).as_ref())
    }

    fn work(&self, variant: usize, at: f64) -> Work<'_> {
        let solver = VARIANTS.get(variant).and_then(|(_, solver)| *solver);
        Work::Timed {
            calls: 1,
            run: Box::new(move || {
                black_box(self.propagate(solver, at));
            }),
        }
    }
}

/// Circle to e = 0.9999, two bodies and J2, one day and thirty.
pub fn methods() -> Vec<OrbitCase> {
    let mut cases = Vec::new();
    for flattened in [false, true] {
        for days in [1.0, 30.0] {
            for eccentricity in [0.0, 0.1, 0.74, 0.99, 0.9999] {
                cases.extend(OrbitCase::new(eccentricity, flattened, days));
            }
        }
    }
    cases
}

/// All that a report compares: [`methods`] and the stiff fall. `quick`: a circle, a Molniya and a parabola's
/// neighbour over a day with J2, and the fall at one tolerance.
pub fn for_report(quick: bool) -> Vec<Box<dyn Method>> {
    let (cases, tolerances): (Vec<_>, &[f64]) = match quick {
        true => (
            [0.0, 0.74, 0.9999]
                .into_iter()
                .filter_map(|eccentricity| OrbitCase::new(eccentricity, true, 1.0))
                .collect(),
            &[1e-6],
        ),
        false => (methods(), &[1e-4, 1e-6, 1e-8]),
    };
    let cases = cases
        .into_iter()
        .map(|case| Box::new(case) as Box<dyn Method>);
    cases
        .chain([Box::new(StiffFall::new(tolerances)) as Box<dyn Method>])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::measure;

    #[test]
    fn errors_fall_with_the_tolerance_and_the_conic_is_exact_for_two_bodies() {
        for (eccentricity, flattened) in [(0.1, false), (0.74, true), (0.9999, false)] {
            let case = OrbitCase::new(eccentricity, flattened, 1.0).unwrap();
            let found = measure(&case, 1);
            assert_eq!(found.len(), 12);
            let errors = |variant: &str| -> Vec<f64> {
                found
                    .iter()
                    .filter(|m| m.variant == variant)
                    .map(|m| m.error)
                    .collect()
            };
            for variant in ["DOP853", "Radau IIA"] {
                let errors = errors(variant);
                assert!(
                    errors.windows(2).all(|e| e[1] < 0.2 * e[0] || e[1] < 1e-3),
                    "{eccentricity} {variant}: {errors:?}"
                );
                assert!(errors[3] < 0.01, "{eccentricity} {variant}: {errors:?}");
            }
            let conic = errors("conic")[0];
            match flattened {
                true => assert!((1e4..2e6).contains(&conic), "{conic}"),
                false => assert!(conic < 2e-5, "{eccentricity}: {conic:e}"),
            }
        }
    }

    #[test]
    fn there_are_twenty_cases() {
        assert_eq!(methods().len(), 20);
        assert_eq!((for_report(false).len(), for_report(true).len()), (21, 4));
        assert!(OrbitCase::new(f64::NAN, false, 1.0).is_none());
    }
}
