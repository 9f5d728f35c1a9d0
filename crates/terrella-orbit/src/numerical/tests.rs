use super::force::EquationsOfMotion;
use super::*;
use crate::StartError;
use crate::constants::EARTH_GM_M3_S2;
use crate::kepler::{
    Anomaly, Conic, Drift, KeplerElements, KeplerFeed, KeplerOptions, OrbitSize, SecularRates,
};
use glam::DVec3;
use terrella_frames::{Ellipsoid, Orientation, utc_from_rfc3339};

mod any;
mod extremes;
mod oracle;
mod perturbed;

fn epoch() -> Epoch {
    utc_from_rfc3339("2018-01-15T12:00:00Z").unwrap()
}

fn after(days: f64) -> NumericalOptions {
    NumericalOptions::between(epoch(), epoch() + Duration::from_days(days))
}

fn conic(periapsis_m: f64, eccentricity: f64, inclination_deg: f64, nu_deg: f64) -> Conic {
    let elements = KeplerElements {
        size: OrbitSize::Periapsis(periapsis_m),
        eccentricity,
        inclination_rad: inclination_deg.to_radians(),
        raan_rad: 1.1,
        argument_of_periapsis_rad: 2.3,
        anomaly: Anomaly::True(nu_deg.to_radians()),
    };
    elements.conic(EARTH_GM_M3_S2, epoch()).unwrap()
}

fn start(conic: &Conic) -> OrbitState {
    let (position_m, velocity_m_s) = conic.state_after(0.0);
    OrbitState {
        epoch: epoch(),
        frame: Frame::Gcrf,
        position_m,
        velocity_m_s,
    }
}

fn fly(state: &OrbitState, model: &ForceModel, options: &NumericalOptions) -> NumericalFeed {
    NumericalFeed::new("test", state, model, &Spacecraft::default(), options).unwrap()
}

/// Largest distance from the conic, metres, at 500 places of the span, between the steps too.
fn off_conic(feed: &NumericalFeed, conic: &Conic) -> f64 {
    let (first, last) = feed.validity();
    let off = |k: u32| {
        let at = first + (last - first) * (f64::from(k) / 500.0);
        let (r, _) = conic.state_after((at - epoch()).to_seconds());
        (feed.state_at(at).unwrap().position_m - r).length()
    };
    (0..=500).map(off).fold(0.0, f64::max)
}

#[test]
fn two_bodies_keep_to_their_conic() {
    // (periapsis, e, tolerance, most metres off in a day). Errors grow with the square of the turns, and with 1/(1 − e).
    for (q, e, tolerance, most) in [
        (7e6, 0.0, 1e-12, 0.02),
        (7e6, 0.1, 1e-12, 0.02),
        (7e6, 0.74, 1e-12, 0.02),
        (7e6, 0.99, 1e-12, 0.2),
        (7e6, 0.9999, 1e-12, 0.05),
        (7e6, 1.0 - 1e-12, 1e-12, 0.02),
        (7e6, 1.0, 1e-12, 0.02),
        (7e6, 1.0 + 1e-12, 1e-12, 0.02),
        (7e6, 2.0, 1e-12, 0.02),
        (7e6, 0.74, 1e-9, 20.0),
        (7e6, 0.74, 1e-6, 2e4),
    ] {
        let conic = conic(q, e, 50.0, if e < 1.0 { 0.0 } else { -60.0 });
        let options = NumericalOptions {
            relative_tolerance: tolerance,
            solver: Solver::Explicit,
            ..after(1.0)
        };
        let feed = fly(&start(&conic), &ForceModel::default(), &options);
        let off = off_conic(&feed, &conic);
        println!(
            "e = {e}, tolerance {tolerance:e}: {off:.2e} m, {:?}",
            feed.counts()
        );
        assert!(off < most, "e = {e}, {tolerance:e}: {off}");
        assert!(
            feed.integration_error_m(&ForceModel::default(), &Spacecraft::default(), &options)
                .unwrap()
                < 2.0 * most
        );
    }
    // The other family, to the same place.
    let conic = conic(7e6, 0.1, 50.0, 0.0);
    let options = NumericalOptions {
        relative_tolerance: 1e-9,
        solver: Solver::Implicit,
        ..after(0.25)
    };
    let feed = fly(&start(&conic), &ForceModel::default(), &options);
    let off = off_conic(&feed, &conic);
    println!(
        "Radau, 1e-9, a quarter of a day: {off:.2e} m, {:?}",
        feed.counts()
    );
    assert!(off < 1.0, "{off}");
}

#[test]
fn spans_reach_back_too() {
    let conic = conic(7e6, 0.3, 50.0, 40.0);
    let options = NumericalOptions {
        first: epoch() - Duration::from_hours(20.0),
        last: epoch() + Duration::from_hours(3.0),
        relative_tolerance: 1e-12,
        ..after(1.0)
    };
    let feed = fly(&start(&conic), &ForceModel::default(), &options);
    assert!(off_conic(&feed, &conic) < 0.02);
    assert_eq!(feed.validity(), (options.first, options.last));
    assert!(matches!(
        feed.state_at(options.first - Duration::from_seconds(1.0)),
        Err(OrbitError::OutsideValidity { .. })
    ));
    // A span of zero length returns the state itself.
    let moment = NumericalOptions {
        first: epoch(),
        last: epoch(),
        ..options
    };
    let state = start(&conic);
    assert_eq!(
        fly(&state, &ForceModel::default(), &moment)
            .state_at(epoch())
            .unwrap(),
        state
    );
}

#[test]
fn states_of_every_frame_are_taken() {
    let conic = conic(7e6, 0.01, 50.0, 40.0);
    let model = ForceModel::default();
    let reference = fly(&start(&conic), &model, &after(0.1));
    for frame in Frame::ALL {
        let state = start(&conic).in_frame(frame, &Orientation::default());
        let feed = fly(&state, &model, &after(0.1));
        let (a, b) = (
            feed.state_at(after(0.1).last).unwrap(),
            reference.state_at(after(0.1).last).unwrap(),
        );
        // Velocities leave out the slow turn of TEME, 5e-5 m/s.
        assert!((a.position_m - b.position_m).length() < 2.0, "{frame:?}");
    }
}

#[test]
fn what_makes_no_sense_is_rejected() {
    let good = start(&conic(7e6, 0.01, 50.0, 40.0));
    let try_with =
        |state: &OrbitState, model: &ForceModel, craft: &Spacecraft, options: &NumericalOptions| {
            NumericalFeed::new("x", state, model, craft, options).unwrap_err()
        };
    let (model, craft, options) = (ForceModel::default(), Spacecraft::default(), after(0.1));
    let nan = OrbitState {
        velocity_m_s: DVec3::NAN,
        ..good
    };
    assert_eq!(
        try_with(&nan, &model, &craft, &options),
        NumericalError::Start(StartError::NotFinite { field: "velocity" })
    );
    let kilometres = OrbitState {
        position_m: good.position_m * 1e-3,
        ..good
    };
    let error = try_with(&kilometres, &model, &craft, &options);
    assert!(
        matches!(error, NumericalError::Start(StartError::BelowGround { .. }))
            && error.to_string().contains("kilometres"),
        "{error}"
    );
    for tolerance in [0.0, f64::NAN, 1.0, -1e-9] {
        let options = NumericalOptions {
            relative_tolerance: tolerance,
            ..options
        };
        assert!(matches!(
            try_with(&good, &model, &craft, &options),
            NumericalError::Start(StartError::Range { .. })
        ));
    }
    let massless = Spacecraft {
        mass_kg: 0.0,
        ..craft
    };
    assert!(matches!(
        try_with(&good, &model, &massless, &options),
        NumericalError::Start(StartError::Range { .. })
    ));
    let high = ForceModel {
        gravity: Gravity::Field {
            degree: 21,
            order: 3,
        },
        ..model.clone()
    };
    assert!(matches!(
        try_with(&good, &high, &craft, &options),
        NumericalError::Start(StartError::Range { .. })
    ));
    let late = NumericalOptions {
        first: epoch() + Duration::from_seconds(1.0),
        ..options
    };
    assert!(matches!(
        try_with(&good, &model, &craft, &late),
        NumericalError::Span { .. }
    ));
    let endless = NumericalOptions {
        last: epoch() + Duration::from_days(1e6),
        ..options
    };
    assert!(matches!(
        try_with(&good, &model, &craft, &endless),
        NumericalError::Start(StartError::Range { .. })
    ));
    let backwards = Thrust {
        first: options.last,
        last: epoch(),
        acceleration_m_s2: DVec3::X,
        axes: ThrustAxes::Flight,
    };
    let error = try_with(
        &good,
        &ForceModel {
            thrusts: vec![backwards],
            ..model.clone()
        },
        &craft,
        &options,
    );
    assert!(
        matches!(error, NumericalError::Start(StartError::Range { value, .. }) if value < 0.0),
        "{error}"
    );
    // Too few steps: how far it came is said.
    let short = NumericalOptions {
        step_limit: 10,
        ..after(2.0)
    };
    let error = try_with(&good, &model, &craft, &short).to_string();
    assert!(error.contains("10 steps by 2018-01-15T12:"), "{error}");
    // A push without bound ends in an error, not in NaN.
    let bang = Thrust {
        first: epoch() + Duration::from_seconds(30.0),
        last: options.last,
        acceleration_m_s2: DVec3::X * 1e200,
        axes: ThrustAxes::Gcrf,
    };
    let error = try_with(
        &good,
        &ForceModel {
            thrusts: vec![bang],
            ..model
        },
        &craft,
        &options,
    );
    assert!(
        matches!(
            error,
            NumericalError::Underflow { .. } | NumericalError::Force { .. }
        ),
        "{error}"
    );
    assert!(error.to_string().contains("2018-01-15T12:00:30"), "{error}");
}

#[test]
fn events_are_where_the_conic_has_them() {
    let conic = conic(7e6, 0.3, 50.0, 20.0);
    let watch = EventSelection {
        nodes: true,
        apsides: true,
        shadow: false,
    };
    let options = NumericalOptions {
        watch,
        relative_tolerance: 1e-12,
        ..after(1.0)
    };
    let feed = fly(&start(&conic), &ForceModel::default(), &options);
    let period = conic.period_s().unwrap();
    let of = |kind| {
        feed.events()
            .iter()
            .filter(move |e| e.kind == kind)
            .map(|e| (e.epoch - epoch()).to_seconds())
    };
    // Apsides: half a period apart, counted from the passage before the epoch.
    for (kind, phase) in [(EventKind::Periapsis, 0.0), (EventKind::Apoapsis, 0.5)] {
        let times: Vec<f64> = of(kind).collect();
        assert_eq!(
            times.len(),
            (86_400.0 / period + conic.since_periapsis_s / period - phase).floor() as usize
                + usize::from(phase > 0.0),
            "{kind:?} {times:?}"
        );
        for t in times {
            let turns = (t + conic.since_periapsis_s) / period - phase;
            assert!(
                (turns - turns.round()).abs() * period < 2e-5,
                "{kind:?} {t}"
            );
        }
    }
    for (kind, sign) in [
        (EventKind::AscendingNode, 1.0),
        (EventKind::DescendingNode, -1.0),
    ] {
        assert!(of(kind).count() >= 8);
        for t in of(kind) {
            let (r, v) = conic.state_after(t);
            // The pole of 2018 is 0.1° from that of J2000: up to 13 km in z at this radius.
            assert!(r.z.abs() < 3e4 && v.z * sign > 0.0, "{kind:?} {t}: {r}");
        }
    }
    assert!(
        feed.events()
            .windows(2)
            .all(|pair| pair[0].epoch <= pair[1].epoch)
    );
}

#[test]
fn the_shadow_is_entered_and_left_once_a_turn() {
    let conic = conic(6.778e6, 0.0, 10.0, 0.0);
    let watch = EventSelection {
        shadow: true,
        ..EventSelection::default()
    };
    let feed = fly(
        &start(&conic),
        &ForceModel {
            sun: true,
            ..ForceModel::default()
        },
        &NumericalOptions {
            watch,
            ..after(1.0)
        },
    );
    let turns = 86_400.0 / conic.period_s().unwrap();
    let shadow: Vec<Event> = feed
        .events()
        .iter()
        .copied()
        .filter(|e| matches!(e.kind, EventKind::ShadowEntry | EventKind::ShadowExit))
        .collect();
    assert!(
        (shadow.len() as f64 - 2.0 * turns).abs() < 2.5,
        "{}",
        shadow.len()
    );
    for pair in shadow.windows(2) {
        assert_ne!(pair[0].kind, pair[1].kind);
        let minutes = (pair[1].epoch - pair[0].epoch).to_seconds() / 60.0;
        // Two asin(R/r) of 360° at most: 36 minutes of 92.6.
        match pair[0].kind {
            EventKind::ShadowEntry => assert!((30.0..36.5).contains(&minutes), "{minutes}"),
            _ => assert!((56.0..63.0).contains(&minutes), "{minutes}"),
        }
        let state = feed.state_at(pair[0].epoch).unwrap();
        let sun = terrella_frames::sun_position_gcrf_m(pair[0].epoch);
        assert!(super::force::sun_above_limb_rad(state.position_m, sun).abs() < 1e-6);
    }
}

#[test]
fn feeds_go_between_threads() {
    fn check<T: Send + Sync + 'static>() {}
    check::<NumericalFeed>();
    check::<KeplerFeed>();
}
