//! A fall that is stiff: explicit against implicit.

use super::super::numeric::{Method, Sweep, Work};
use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use terrella::frames::{Duration, Epoch};
use terrella_orbit::Frame;
use terrella_orbit::OrbitState;
use terrella_orbit::constants::EARTH_GM_M3_S2;
use terrella_orbit::kepler::{Anomaly, KeplerElements, OrbitSize};
use terrella_orbit::numerical::{
    AtmosphereModel, ForceModel, Gravity, NumericalFeed, NumericalOptions, Solver, Spacecraft,
};

/// The integrators that are compared.
const VARIANTS: [(&str, Solver); 3] = [
    ("DOP853", Solver::Explicit),
    ("Radau IIA", Solver::Implicit),
    ("automatic", Solver::Automatic),
];
/// Tolerance of the fall that the others are compared with; its impact moves by less than a millisecond from 1e-10 on.
const REFERENCE_TOLERANCE: f64 = 1e-12;

/// A fall to its end.
#[derive(Clone, Copy, Debug)]
struct Fall {
    /// From the start to the impact, seconds.
    impact_s: f64,
    /// Evaluations of the force.
    evaluations: u64,
}

/// A sphere of 30 cm that weighs a gram, from a circle at 120 km to the ground through the US Standard Atmosphere 1976.
///
/// Its error is the instant of the impact, its cost evaluations of the force, each way flown once.
#[derive(Clone, Debug)]
pub struct StiffFall {
    tolerances: Vec<f64>,
    reference: OnceCell<f64>,
    /// By variant and bits of the tolerance.
    falls: RefCell<BTreeMap<(usize, u64), Option<Fall>>>,
}

impl StiffFall {
    /// With these relative tolerances.
    pub fn new(tolerances: &[f64]) -> Self {
        Self {
            tolerances: tolerances.to_vec(),
            reference: OnceCell::new(),
            falls: RefCell::default(),
        }
    }

    /// The fall by one integrator; `None` where it fails.
    fn propagate(solver: Solver, relative_tolerance: f64) -> Option<Fall> {
        let epoch = Epoch::from_gregorian_tai_at_noon(2018, 1, 15);
        let elements = KeplerElements {
            size: OrbitSize::Periapsis(6_378_137.0 + 120e3),
            eccentricity: 0.0,
            inclination_rad: 20_f64.to_radians(),
            raan_rad: 1.1,
            argument_of_periapsis_rad: 2.3,
            anomaly: Anomaly::True(0.0),
        };
        let (position_m, velocity_m_s) =
            elements.conic(EARTH_GM_M3_S2, epoch).ok()?.state_after(0.0);
        let state = OrbitState {
            epoch,
            frame: Frame::Gcrf,
            position_m,
            velocity_m_s,
        };
        let model = ForceModel {
            gravity: Gravity::Zonal { degree: 4 },
            drag: Some(AtmosphereModel::Standard1976),
            ..ForceModel::default()
        };
        let craft = Spacecraft {
            mass_kg: 0.001,
            drag_area_m2: 0.07,
            ..Spacecraft::default()
        };
        let options = NumericalOptions {
            relative_tolerance,
            solver,
            ..NumericalOptions::between(epoch, epoch + Duration::from_days(5.0))
        };
        let feed = NumericalFeed::new("", &state, &model, &craft, &options).ok()?;
        let impact = feed.impact()?;
        Some(Fall {
            impact_s: (impact - epoch).to_seconds(),
            evaluations: feed.counts().evaluations,
        })
    }

    fn fall(&self, variant: usize, tolerance: f64) -> Option<Fall> {
        let solver = VARIANTS.get(variant)?.1;
        let key = (variant, tolerance.to_bits());
        let known = self.falls.borrow().get(&key).copied();
        known.unwrap_or_else(|| {
            let fall = Self::propagate(solver, tolerance);
            self.falls.borrow_mut().insert(key, fall);
            fall
        })
    }

    fn reference_s(&self) -> f64 {
        *self.reference.get_or_init(|| {
            let fall = Self::propagate(Solver::Automatic, REFERENCE_TOLERANCE);
            fall.map_or(f64::NAN, |fall| fall.impact_s)
        })
    }
}

impl Method for StiffFall {
    fn name(&self) -> &str {
        "a sphere of one gram falls from 120 km"
    }

    fn error_unit(&self) -> &str {
        "s"
    }

    fn cost_unit(&self) -> &str {
        "evaluations"
    }

    fn variants(&self) -> Vec<&str> {
        VARIANTS.map(|(name, _)| name).into()
    }

    fn sweep(&self) -> Sweep {
        Sweep {
            parameter: super::TOLERANCE,
            values: self.tolerances.clone(),
        }
    }

    fn error(&self, variant: usize, at: f64) -> f64 {
        self.fall(variant, at).map_or(f64::INFINITY, |fall| {
            (fall.impact_s - self.reference_s()).abs()
        })
    }

    fn work(&self, variant: usize, at: f64) -> Work<'_> {
        let fall = self.fall(variant, at);
        Work::Counted(fall.map_or(f64::INFINITY, |fall| fall.evaluations as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::measure;

    #[test]
    fn the_implicit_method_is_far_cheaper_where_stability_holds_the_other_back() {
        let found = measure(&StiffFall::new(&[1e-6]), 1);
        let of = |variant: &str| {
            let one = found.iter().find(|m| m.variant == variant).expect("there");
            println!(
                "{variant}: {:e} s, {} evaluations",
                one.error, one.cost.median
            );
            (one.error, one.cost.median)
        };
        let (explicit, implicit, automatic) = (of("DOP853"), of("Radau IIA"), of("automatic"));
        assert!(explicit.1 > 50.0 * implicit.1 && explicit.1 > 50.0 * automatic.1);
        for (error_s, _) in [explicit, implicit, automatic] {
            assert!(error_s < 5.0, "{error_s} s");
        }
    }
}
