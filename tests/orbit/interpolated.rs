//! Interpolation between samples against Kepler orbits, whose states are known at every instant.

use crate::utc;
use glam::DVec3;
use terrella_frames::{Duration, Epoch};
use terrella_orbit::Frame;
use terrella_orbit::interpolated::{
    InterpolatedStates, Interpolation, InterpolationError, KeplerOrbit, StateSample,
    interpolation_error,
};

fn start() -> Epoch {
    utc("2016-12-31T23:00:00Z")
}

fn seconds(s: f64) -> Duration {
    Duration::from_total_nanoseconds((s * 1e9).round() as i128)
}

fn sample(orbit: &KeplerOrbit, t_s: f64) -> StateSample {
    let (position_m, velocity_m_s) = orbit.state(t_s);
    StateSample {
        epoch: start() + seconds(t_s),
        position_m,
        velocity_m_s: Some(velocity_m_s),
    }
}

fn sampled(
    orbit: &KeplerOrbit,
    times_s: &[f64],
    interpolation: Interpolation,
) -> InterpolatedStates {
    let samples: Vec<_> = times_s.iter().map(|&t| sample(orbit, t)).collect();
    InterpolatedStates::new(Frame::Gcrf, &samples, interpolation).unwrap()
}

fn every(step_s: f64, count: u32) -> Vec<f64> {
    (0..count).map(|k| f64::from(k) * step_s).collect()
}

const LAGRANGE: fn(usize) -> Interpolation = |degree| Interpolation::Lagrange { degree };
const HERMITE: fn(usize) -> Interpolation = |degree| Interpolation::Hermite { degree };

#[test]
fn kepler_orbits_are_what_they_should_be() {
    for orbit in [
        KeplerOrbit::LOW,
        KeplerOrbit::MOLNIYA,
        KeplerOrbit::GEOSTATIONARY,
    ] {
        let period = std::f64::consts::TAU / orbit.mean_motion_rad_s();
        for k in -20..20 {
            let t = period * f64::from(k) / 17.0;
            let (r, v) = orbit.state(t);
            // vis-viva and Kepler's second law.
            let mu = 3.986_004_418e14;
            let energy = v.length_squared() / 2.0 - mu / r.length();
            let expected = -mu / (2.0 * orbit.semi_major_axis_m);
            assert!((energy / expected - 1.0).abs() < 1e-13);
            let e2 = 1.0 - orbit.eccentricity * orbit.eccentricity;
            let areal = (mu * orbit.semi_major_axis_m * e2).sqrt();
            assert!((r.cross(v).z / areal - 1.0).abs() < 1e-13);
            let h = 1.0;
            let rate = (orbit.state(t + h).0 - orbit.state(t - h).0) / (2.0 * h);
            assert!(rate.distance(v) < 2e-2, "{t}: {}", rate.distance(v));
        }
    }
}

/// The table of the documentation. Printed with `--nocapture`; each cell is also held here.
#[test]
fn error_against_step_and_degree() {
    let interpolations = [
        Interpolation::Linear,
        LAGRANGE(3),
        LAGRANGE(5),
        LAGRANGE(7),
        LAGRANGE(9),
        LAGRANGE(11),
        LAGRANGE(15),
        HERMITE(3),
        HERMITE(5),
        HERMITE(7),
        HERMITE(9),
        HERMITE(13),
    ];
    let steps = [10.0, 30.0, 60.0, 120.0, 180.0, 300.0, 600.0];
    for (name, orbit) in [("low", KeplerOrbit::LOW), ("Molniya", KeplerOrbit::MOLNIYA)] {
        println!("{name}, worst position difference in metres (velocity, m/s) by step in seconds");
        println!(
            "| interpolation | {} |",
            steps.map(|s| s.to_string()).join(" | ")
        );
        for interpolation in interpolations {
            let worst = steps.map(|step| interpolation_error(interpolation, step, &orbit).unwrap());
            let cells = worst.map(|w| format!("{:.1e} ({:.1e})", w.position_m, w.velocity_m_s));
            println!(
                "| {} {} | {} |",
                interpolation.name(),
                interpolation.degree(),
                cells.join(" | ")
            );
            // Longer steps are worse, until rounding is all that is left.
            for pair in worst.windows(2) {
                assert!(
                    pair[0].position_m < pair[1].position_m.max(1e-7),
                    "{interpolation:?} {worst:?}"
                );
            }
            // Halving the step divides the error by 2^(degree + 1) where it is small and not yet rounding.
            if orbit == KeplerOrbit::LOW {
                let order = interpolation.degree() as f64 + 1.0;
                let order =
                    order + (order % 2.0) * f64::from(u8::from(interpolation == HERMITE(2)));
                let [a, b] = [worst[3], worst[2]].map(|w| w.position_m);
                if b > 1e-6 {
                    let found = (a / b).log2();
                    assert!(
                        (found - order).abs() < 0.4,
                        "{interpolation:?}: order {found}"
                    );
                }
            }
        }
    }
    let worst = |i, step| {
        interpolation_error(i, step, &KeplerOrbit::LOW)
            .unwrap()
            .position_m
    };
    assert!(worst(Interpolation::WITH_VELOCITIES, 60.0) < 0.01);
    assert!(worst(Interpolation::WITHOUT_VELOCITIES, 60.0) < 0.1);
    assert!((40.0..80.0).contains(&worst(LAGRANGE(5), 300.0)));
}

/// High degrees lose nothing to rounding: at a step at which degree 27 is exact in theory, it is so in practice.
#[test]
fn high_degrees_are_stable() {
    for (orbit, step) in [
        (KeplerOrbit::LOW, 120.0),
        (KeplerOrbit::GEOSTATIONARY, 1200.0),
    ] {
        for degree in [17, 21, 25, 27, 31] {
            for interpolation in [LAGRANGE(degree), HERMITE(degree)] {
                let worst = interpolation_error(interpolation, step, &orbit).unwrap();
                println!("{interpolation:?} {step} s: {worst:?}");
                // Rounding of the orbit itself: 42 000 km · 2⁻⁵² = 9 nm, and 10 ns of its argument.
                assert!(worst.position_m < 2e-7, "{interpolation:?}: {worst:?}");
                assert!(worst.velocity_m_s < 1e-9, "{interpolation:?}: {worst:?}");
            }
        }
    }
}

#[test]
fn samples_are_met_bit_for_bit_and_neighbours_join() {
    for interpolation in [
        Interpolation::Linear,
        LAGRANGE(4),
        LAGRANGE(9),
        HERMITE(3),
        HERMITE(8),
    ] {
        let times = every(61.7, 40);
        let ephemeris = sampled(&KeplerOrbit::LOW, &times, interpolation);
        for &t in &times {
            let expected = sample(&KeplerOrbit::LOW, t);
            let state = ephemeris.state_at(expected.epoch).unwrap();
            assert_eq!(state.position_m, expected.position_m);
            assert_eq!(Some(state.velocity_m_s), expected.velocity_m_s);
            // A nanosecond on, the polynomial.
            for ns in [-1, 1] {
                let beside = expected.epoch + Duration::from_total_nanoseconds(ns);
                if let Some(beside) = ephemeris.state_at(beside) {
                    let off = beside.position_m.distance(state.position_m);
                    assert!(off < 1e-4, "{interpolation:?} {t}: {off}");
                    let off = beside.velocity_m_s.distance(state.velocity_m_s);
                    // A straight line's slope is off by half a step's fall, and is not used: velocities are given.
                    assert!(off < 1e-4, "{interpolation:?} {t}: {off} m/s");
                }
            }
        }
        let (first, last) = ephemeris.span();
        let ns = Duration::from_total_nanoseconds(1);
        assert!(
            ephemeris.state_at(first - ns).is_none() && ephemeris.state_at(last + ns).is_none()
        );
    }
}

/// Positions only: the velocity is the polynomial's own.
/// Degree 1 would be one state of a Hermite polynomial, and the position would jump half-way between two. CCSDS 502.0 leaves it
/// open; Cesium takes two samples at least, Orekit as many as the degree and one. With two the polynomial is the cubic that
/// two positions and two velocities give.
#[test]
fn hermite_of_degree_1_goes_from_sample_to_sample() {
    let times = [0.0, 1800.0, 3600.0, 5400.0];
    let states = sampled(&KeplerOrbit::LOW, &times, HERMITE(1));
    let mut before: Option<DVec3> = None;
    for second in 0..5400 {
        let position = states
            .state_at(start() + seconds(f64::from(second)))
            .unwrap()
            .position_m;
        if let Some(before) = before.replace(position) {
            // Not faster than 20 km/s anywhere: a jump would be thousands of kilometres.
            assert!(before.distance(position) < 20_000.0, "{second}");
        }
    }
    let (a, b) = (
        sample(&KeplerOrbit::LOW, 0.0),
        sample(&KeplerOrbit::LOW, 1800.0),
    );
    let (va, vb) = (a.velocity_m_s.unwrap(), b.velocity_m_s.unwrap());
    // Hermite's cubic at a quarter of the step.
    let s: f64 = 0.25;
    let cubic = a.position_m * (2.0 * s.powi(3) - 3.0 * s.powi(2) + 1.0)
        + va * 1800.0 * (s.powi(3) - 2.0 * s.powi(2) + s)
        + b.position_m * (-2.0 * s.powi(3) + 3.0 * s.powi(2))
        + vb * 1800.0 * (s.powi(3) - s.powi(2));
    let found = states
        .state_at(start() + seconds(450.0))
        .unwrap()
        .position_m;
    assert!(found.distance(cubic) < 1e-6, "{}", found.distance(cubic));
}

#[test]
fn velocities_come_from_positions() {
    let samples: Vec<_> = every(60.0, 100)
        .iter()
        .map(|&t| StateSample {
            velocity_m_s: None,
            ..sample(&KeplerOrbit::LOW, t)
        })
        .collect();
    let ephemeris = InterpolatedStates::new(Frame::Gcrf, &samples, LAGRANGE(9)).unwrap();
    for k in 0..990 {
        let t = 3.0 * 60.0 + f64::from(k) * 5.3;
        let expected = sample(&KeplerOrbit::LOW, t);
        let state = ephemeris.state_at(expected.epoch).unwrap();
        assert!(state.position_m.distance(expected.position_m) < 2e-3);
        assert!(
            state.velocity_m_s.distance(expected.velocity_m_s.unwrap()) < 1e-4,
            "{t}"
        );
    }
    let error = InterpolatedStates::new(Frame::Gcrf, &samples, HERMITE(7)).unwrap_err();
    assert_eq!(error, InterpolationError::NoVelocity { index: 0 });
}

/// At the ends the window is shifted, not shortened: with as many samples as the polynomial needs, all of it is one polynomial.
#[test]
fn the_ends_use_whole_windows() {
    let times = every(60.0, 8);
    let ephemeris = sampled(&KeplerOrbit::LOW, &times, LAGRANGE(7));
    let longer = sampled(&KeplerOrbit::LOW, &every(60.0, 20), LAGRANGE(7));
    let at = |t: f64| ephemeris.state_at(start() + seconds(t)).unwrap();
    for k in 1..70 {
        let t = f64::from(k) * 6.0;
        let off = at(t)
            .position_m
            .distance(sample(&KeplerOrbit::LOW, t).position_m);
        assert!(off < 0.5, "{t}: {off} m");
        if t < 240.0 {
            // The first half of the first window.
            let same = longer.state_at(start() + seconds(t)).unwrap();
            assert_eq!(same.position_m, at(t).position_m);
        }
    }
    // Fewer samples than the degree needs: all of them.
    let two = sampled(&KeplerOrbit::LOW, &every(60.0, 2), HERMITE(27));
    let off = two.state_at(start() + seconds(30.0)).unwrap();
    assert!(
        off.position_m
            .distance(sample(&KeplerOrbit::LOW, 30.0).position_m)
            < 1.0
    );
    let single = sampled(&KeplerOrbit::LOW, &[0.0], HERMITE(7));
    assert!(single.state_at(start()).is_some());
    assert!(single.state_at(start() + seconds(1e-9)).is_none());
}

/// Through the leap second at the end of 2016, and with steps that change as in real files.
#[test]
fn time_is_elapsed_and_steps_may_differ() {
    let times: Vec<_> = (0..80)
        .map(|k| 60.0 * f64::from(k) + 20.0 * (f64::from(k) * 0.9).sin())
        .collect();
    for interpolation in [LAGRANGE(9), HERMITE(11)] {
        let ephemeris = sampled(&KeplerOrbit::LOW, &times, interpolation);
        let leap = utc("2016-12-31T23:59:60.5Z");
        let t = (leap - start()).to_seconds();
        assert_eq!(t, 3600.5);
        for k in -50..50 {
            let t = t + f64::from(k) * 10.0;
            let expected = sample(&KeplerOrbit::LOW, t);
            let off = ephemeris
                .state_at(expected.epoch)
                .unwrap()
                .position_m
                .distance(expected.position_m);
            assert!(off < 0.02, "{interpolation:?} {t}: {off}");
        }
    }
}

/// Far from the first sample nothing is lost: times are whole nanoseconds.
#[test]
fn years_on_it_is_as_sharp() {
    let far = 150.0 * 365.25 * 86_400.0;
    let times: Vec<_> = [0.0]
        .into_iter()
        .chain((0..30).map(|k| far + 60.0 * f64::from(k)))
        .collect();
    let samples: Vec<_> = times
        .iter()
        .map(|&t| {
            let (position_m, velocity) =
                KeplerOrbit::LOW.state(if t > 0.0 { t - far } else { 0.0 });
            StateSample {
                epoch: start() + seconds(t),
                position_m,
                velocity_m_s: Some(velocity),
            }
        })
        .collect();
    let ephemeris = InterpolatedStates::new(Frame::Gcrf, &samples, HERMITE(9)).unwrap();
    for k in 0..100 {
        let t = 600.0 + f64::from(k) * 4.7;
        let epoch = start() + seconds(far) + seconds(t);
        let off = ephemeris
            .state_at(epoch)
            .unwrap()
            .position_m
            .distance(KeplerOrbit::LOW.state(t).0);
        assert!(off < 1e-4, "{t}: {off}");
    }
}

#[test]
fn samples_that_are_no_ephemeris_are_rejected() {
    let good = sample(&KeplerOrbit::LOW, 0.0);
    let later = sample(&KeplerOrbit::LOW, 60.0);
    let new =
        |samples: &[StateSample], i| InterpolatedStates::new(Frame::Gcrf, samples, i).map(|_| ());
    assert_eq!(new(&[], LAGRANGE(3)), Err(InterpolationError::Empty));
    for degree in [0, 32, usize::MAX] {
        let rejected = Err(InterpolationError::Degree { degree });
        assert_eq!(new(&[good], LAGRANGE(degree)), rejected);
        assert_eq!(new(&[good], HERMITE(degree)), rejected);
    }
    for samples in [[good, good], [later, good]] {
        assert!(matches!(
            new(&samples, LAGRANGE(3)),
            Err(InterpolationError::Order { index: 1, .. })
        ));
    }
    for (position_m, velocity) in [
        (DVec3::NAN, DVec3::ZERO),
        (DVec3::splat(f64::INFINITY), DVec3::ZERO),
        (DVec3::splat(1e13), DVec3::ZERO),
        (DVec3::ZERO, DVec3::splat(3e8)),
    ] {
        let bad = StateSample {
            position_m,
            velocity_m_s: Some(velocity),
            ..later
        };
        assert_eq!(
            new(&[good, bad], LAGRANGE(3)),
            Err(InterpolationError::NotAState { index: 1 })
        );
    }
    let far = StateSample {
        epoch: Epoch::from_duration(Duration::MAX, hifitime::TimeScale::TAI),
        ..good
    };
    assert!(matches!(
        new(&[good, far], LAGRANGE(3)),
        Err(InterpolationError::TooLong { index: 1, .. })
    ));
    let ephemeris = sampled(&KeplerOrbit::LOW, &every(60.0, 20), LAGRANGE(7));
    for duration in [Duration::MAX, Duration::MIN] {
        assert!(
            ephemeris
                .state_at(Epoch::from_duration(duration, hifitime::TimeScale::TAI))
                .is_none()
        );
    }
}

/// Steps from a nanosecond to a century cannot make a polynomial: no state, and never one that is not a number.
#[test]
fn steps_of_all_sizes_give_numbers_or_nothing() {
    let mut times = vec![0.0];
    for k in 0..40 {
        times.push(1e-9 * 2.7_f64.powi(k) + f64::from(k) * 1e-9);
    }
    times.dedup_by_key(|t| (*t * 1e9).round() as i64);
    for interpolation in [LAGRANGE(31), HERMITE(31)] {
        let samples: Vec<_> = times
            .iter()
            .map(|&t| StateSample {
                epoch: start() + seconds(t),
                ..sample(&KeplerOrbit::LOW, 0.0)
            })
            .collect();
        let mut samples = samples;
        samples.dedup_by_key(|s| s.epoch);
        let ephemeris = InterpolatedStates::new(Frame::Gcrf, &samples, interpolation).unwrap();
        for k in 0..400 {
            let t = start() + seconds(1e-9 * 1.3_f64.powi(k / 4) + f64::from(k) * 0.3e-9);
            if let Some(state) = ephemeris.state_at(t) {
                assert!(state.position_m.is_finite() && state.velocity_m_s.is_finite());
            }
        }
    }
}
