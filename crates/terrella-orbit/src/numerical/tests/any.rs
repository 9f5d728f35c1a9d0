//! Any start gives finite states, or an error with a reason.

use super::*;
use proptest::prelude::*;

fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    let part = move || {
        (-1.0..1.0_f64, -3.0..0.0_f64).prop_map(move |(x, decades)| x * size * 10f64.powf(decades))
    };
    (part(), part(), part()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn integrations_end(position_m in vector(2e8), velocity_m_s in vector(3e4), area_to_mass in -4.0..2.5_f64, solver in 0..3_u8) {
        let state = OrbitState { epoch: epoch(), frame: Frame::Gcrf, position_m, velocity_m_s };
        let model = ForceModel {
            gravity: Gravity::Field { degree: 8, order: 8 },
            drag: Some(AtmosphereModel::Exponential),
            sun: true,
            moon: true,
            sunlight: Some(Shadow::Cone),
            ..ForceModel::default()
        };
        let area = 10f64.powf(area_to_mass);
        let craft = Spacecraft { mass_kg: 1.0, drag_area_m2: area, sunlit_area_m2: area, ..Spacecraft::default() };
        let options = NumericalOptions {
            solver: [Solver::Automatic, Solver::Explicit, Solver::Implicit][usize::from(solver)],
            relative_tolerance: 1e-7,
            step_limit: 20_000,
            watch: EventSelection { nodes: true, apsides: true, shadow: true },
            first: epoch() - Duration::from_hours(2.0),
            ..after(0.2)
        };
        match NumericalFeed::new("any", &state, &model, &craft, &options) {
            Ok(feed) => {
                let (first, last) = feed.validity();
                prop_assert!(first <= epoch() && epoch() <= last);
                for k in 0..=50 {
                    let state = feed.state_at(first + (last - first) * (f64::from(k) / 50.0)).unwrap();
                    prop_assert!(state.position_m.is_finite() && state.velocity_m_s.is_finite());
                    let height = Ellipsoid::WGS84.geodetic_from_itrf(state.in_itrf().position_m).height_m;
                    prop_assert!(height > -50.0, "{}", height);
                }
            }
            Err(error) => prop_assert!(error.to_string().len() > 20),
        }
    }

    #[test]
    fn conics_are_numbers(position_m in vector(2e9), velocity_m_s in vector(1e5), days in -1e4..1e4_f64, drift in any::<bool>()) {
        let state = OrbitState { epoch: epoch(), frame: Frame::Teme, position_m, velocity_m_s };
        let far = Duration::from_days(1e4);
        let options = KeplerOptions {
            drift: if drift { Drift::J2 } else { Drift::None },
            first: epoch() - far,
            last: epoch() + far,
        };
        if let Ok(feed) = KeplerFeed::from_state("any", &state, options) {
            let (first, last) = feed.validity();
            prop_assert!(first <= epoch() && epoch() <= last);
            let start = feed.state_at(epoch()).unwrap();
            prop_assert!((start.position_m - position_m).length() < 1e-9 * position_m.length(), "{}", start.position_m - position_m);
            if let Ok(state) = feed.state_at(epoch() + Duration::from_days(days)) {
                prop_assert!(state.position_m.is_finite() && state.velocity_m_s.is_finite());
            }
        }
    }
}
