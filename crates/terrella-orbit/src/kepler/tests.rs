use super::*;
use std::f64::consts::{PI, TAU};
use terrella_frames::utc_from_rfc3339;

const MU: f64 = EARTH_GM_M3_S2;

fn epoch() -> Epoch {
    utc_from_rfc3339("2018-01-15T12:00:00Z").unwrap()
}

fn span(days: f64) -> KeplerOptions {
    KeplerOptions {
        drift: Drift::None,
        first: epoch() - Duration::from_days(days),
        last: epoch() + Duration::from_days(days),
    }
}

fn elements(periapsis_m: f64, eccentricity: f64, nu_deg: f64) -> KeplerElements {
    KeplerElements {
        size: OrbitSize::Periapsis(periapsis_m),
        eccentricity,
        inclination_rad: 0.9,
        raan_rad: 1.1,
        argument_of_periapsis_rad: 2.3,
        anomaly: Anomaly::True(nu_deg.to_radians()),
    }
}

fn conic(periapsis_m: f64, eccentricity: f64, nu_deg: f64) -> Conic {
    elements(periapsis_m, eccentricity, nu_deg)
        .conic(MU, epoch())
        .unwrap()
}

/// Errors of the energy v²/2 − μ/r and the angular momentum, relative to those of the conic; the larger one.
fn invariants_error(conic: &Conic, (r, v): (DVec3, DVec3)) -> f64 {
    let h = (MU * conic.periapsis_m * (1.0 + conic.eccentricity)).sqrt();
    let energy = 0.5 * v.length_squared() - MU / r.length() + 0.5 * MU * conic.reciprocal_axis_1_m;
    let scale = (MU / r.length()).max(0.5 * v.length_squared());
    (energy / scale)
        .abs()
        .max((r.cross(v).length() - h).abs() / (r.length() * v.length()))
}

#[test]
fn energy_and_momentum_are_kept_on_every_conic() {
    for e in [
        0.0,
        1e-16,
        1e-8,
        0.1,
        0.74,
        0.99,
        0.9999,
        1.0 - 1e-12,
        1.0,
        1.0 + 1e-12,
        1.0001,
        1.5,
        10.0,
        1e4,
    ] {
        let conic = conic(7e6, e, 10.0);
        let mut worst = 0.0_f64;
        for k in -60_i32..=60 {
            let t = f64::from(k).signum() * 10f64.powf(f64::from(k.abs()) / 6.0 - 1.0);
            let (r, v) = conic.state_after(t);
            assert!(r.is_finite() && v.is_finite(), "{e} {t}");
            worst = worst.max(invariants_error(&conic, (r, v)));
        }
        assert!(worst < 4e-15, "{e}: {worst:e}");
    }
}

#[test]
fn the_ellipse_solves_keplers_equation() {
    for e in [0.0_f64, 0.01, 0.3, 0.74, 0.99] {
        let a = 7e6 / (1.0 - e);
        let n = (MU / a.powi(3)).sqrt();
        let mut start = elements(7e6, e, 0.0);
        start.size = OrbitSize::SemiMajorAxis(a);
        let conic = start.conic(MU, epoch()).unwrap();
        for k in -20..=20 {
            // From E to M, never the other way.
            let anomaly = PI * f64::from(k) / 20.0;
            let t = (anomaly - e * anomaly.sin()) / n;
            let (r, v) = conic.state_after(t);
            let x = a * (anomaly.cos() - e);
            let y = a * (1.0 - e * e).sqrt() * anomaly.sin();
            let rate = n / (1.0 - e * anomaly.cos());
            let expected = conic.to_periapsis * x + conic.across * y;
            let velocity = conic.to_periapsis * (-a * anomaly.sin() * rate)
                + conic.across * (a * (1.0 - e * e).sqrt() * anomaly.cos() * rate);
            assert!((r - expected).length() < 1e-14 * a, "{e} {k}");
            assert!(
                (v - velocity).length() < 1e-12 * velocity.length(),
                "{e} {k}"
            );
        }
    }
}

#[test]
fn the_hyperbola_and_the_parabola_solve_their_equations() {
    for e in [1.01, 1.5, 4.0] {
        let conic = conic(7e6, e, 0.0);
        let a = 7e6 / (e - 1.0);
        let n = (MU / a.powi(3)).sqrt();
        for h in [-3.0_f64, -0.5, 0.01, 1.0, 5.0] {
            let (r, _) = conic.state_after((e * h.sinh() - h) / n);
            let expected = conic.to_periapsis * (a * (e - h.cosh()))
                + conic.across * (a * (e * e - 1.0).sqrt() * h.sinh());
            assert!((r - expected).length() < 1e-13 * r.length(), "{e} {h}");
        }
    }
    // Barker: t = √(p³/μ)/2 (D + D³/3), D = tan(ν/2).
    let conic = conic(7e6, 1.0, 0.0);
    for nu in [-2.5_f64, -1.0, 0.3, 2.0, 3.0] {
        let d = (0.5 * nu).tan();
        let t = 0.5 * (1.4e7_f64.powi(3) / MU).sqrt() * (d + d * d * d / 3.0);
        let (r, _) = conic.state_after(t);
        let radius = 1.4e7 / (1.0 + nu.cos());
        let expected = (conic.to_periapsis * nu.cos() + conic.across * nu.sin()) * radius;
        assert!((r - expected).length() < 1e-13 * radius, "{nu}");
    }
}

#[test]
fn conics_on_both_sides_of_the_parabola_join() {
    // Δe = 1e-12 shifts the place by about its share of the radius, and not by more.
    for t in [1.0, 1e3, 1e5, 1e7] {
        let at = |e| conic(7e6, e, 0.0).state_after(t).0;
        let middle = at(1.0);
        for de in [1e-15, 1e-12, 1e-9] {
            for e in [1.0 - de, 1.0 + de] {
                let apart = (at(e) - middle).length();
                // α r of the parabola at that time, the second-order term of the series.
                let expected = de * middle.length() * (1.0 + middle.length() / 7e6);
                assert!(
                    apart < 2.0 * expected + 4e-15 * middle.length(),
                    "{t} {e}: {apart}"
                );
                assert!(
                    de < 1e-13 || t < 1e4 || apart > 1e-3 * expected,
                    "{t} {e}: {apart}"
                );
            }
        }
    }
}

#[test]
fn a_straight_fall_takes_the_time_it_takes() {
    // From rest at r0: t = √(r0³/2μ) (η + sin η cos η), r = r0 cos² η.
    let r0 = 4e7;
    let start = OrbitState {
        epoch: epoch(),
        frame: Frame::Gcrf,
        position_m: DVec3::new(0.0, 0.6, 0.8) * r0,
        velocity_m_s: DVec3::ZERO,
    };
    let feed = KeplerFeed::from_state("stone", &start, span(1.0)).unwrap();
    for eta in [0.01_f64, 0.3, 0.8, 1.1] {
        let t = (r0.powi(3) / (2.0 * MU)).sqrt() * (eta + eta.sin() * eta.cos());
        let (r, v) = feed.conic().state_after(t);
        let radius = r0 * eta.cos().powi(2);
        assert!(
            (r - start.position_m / r0 * radius).length() < 1e-6,
            "{eta}: {r}"
        );
        let speed = (2.0 * MU * (1.0 / radius - 1.0 / r0)).sqrt();
        assert!(
            (v + start.position_m / r0 * speed).length() < 1e-8 * speed,
            "{eta}"
        );
    }
    let impact = feed.impact().unwrap();
    let at = feed.state_at(impact).unwrap();
    assert!(
        Ellipsoid::WGS84
            .geodetic_from_itrf(at.position_m)
            .height_m
            .abs()
            < 1e-3
    );
    let message = feed
        .state_at(impact + Duration::from_seconds(1.0))
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("meets the ground at 2018-01-15T"),
        "{message}"
    );
    // At rest it has also risen, on the same line.
    assert_eq!(feed.validity().0, epoch() - (impact - epoch()));
    // Outwards with more and with less than the speed of escape.
    for factor in [0.5, 1.0, 2.0] {
        let velocity = start.position_m / r0 * (2.0 * MU / r0).sqrt() * factor;
        let conic = Conic::from_state(MU, start.position_m, velocity).unwrap();
        let (r, v) = conic.state_after(0.0);
        assert!((r - start.position_m).length() < 1e-6, "{factor}: {r}");
        assert!(
            (v - velocity).length() < 1e-10 * velocity.length(),
            "{factor}: {v}"
        );
    }
}

#[test]
fn a_state_comes_back_as_itself() {
    for e in [
        0.0,
        1e-12,
        1e-3,
        0.49,
        0.51,
        0.74,
        0.99,
        1.0 - 1e-9,
        1.0,
        1.0 + 1e-9,
        1.2,
        30.0,
    ] {
        for nu in [-170.0, -90.0, -5.0, 0.0, 1e-5, 45.0, 120.0, 179.0, 180.0] {
            let Ok(first) = elements(7e6, e, nu).conic(MU, epoch()) else {
                assert!(e >= 1.0 && f64::abs(nu) > 90.0, "{e} {nu}");
                continue;
            };
            let (r, v) = first.state_after(0.0);
            if r.length() > 1e15 {
                continue;
            }
            let second = Conic::from_state(MU, r, v).unwrap();
            let (again, velocity) = second.state_after(0.0);
            assert!(
                (again - r).length() < 2e-14 * r.length(),
                "{e} {nu}: {}",
                (again - r).length() / r.length()
            );
            assert!((velocity - v).length() < 2e-13 * v.length(), "{e} {nu}");
        }
    }
}

#[test]
fn elements_come_back_as_themselves() {
    for e in [0.01, 0.5, 0.95, 1.3] {
        for nu in [-80.0, 20.0, 100.0] {
            let given = elements(8e6, e, nu);
            let found = KeplerElements::of(&given.conic(MU, epoch()).unwrap());
            let size = match found.size {
                OrbitSize::SemiMajorAxis(a) => a * (1.0 - e),
                OrbitSize::Periapsis(q) => q,
            };
            assert!((size / 8e6 - 1.0).abs() < 1e-14);
            assert!((found.inclination_rad - given.inclination_rad).abs() < 1e-14);
            assert!((found.raan_rad - given.raan_rad).abs() < 1e-14);
            assert!(
                (found.argument_of_periapsis_rad - given.argument_of_periapsis_rad).abs() < 1e-13
            );
            let Anomaly::True(true_anomaly) = found.anomaly else {
                panic!()
            };
            assert!(
                (true_anomaly - f64::to_radians(nu)).abs() < 1e-13,
                "{e} {nu}"
            );
        }
    }
}

#[test]
fn thirty_years_on_the_turns_are_still_counted() {
    // A period that is a whole number of seconds by choice of a: after 30 years of turns the place is the first one.
    let a = (MU * (5_400.0 / TAU).powi(2)).cbrt();
    let mut start = elements(1.0, 0.001, 0.0);
    start.size = OrbitSize::SemiMajorAxis(a);
    start.anomaly = Anomaly::Mean(0.3);
    let feed =
        KeplerFeed::from_elements("old", Frame::Teme, epoch(), &start, span(11_000.0)).unwrap();
    let first = feed.state_at(epoch()).unwrap().position_m;
    let turns = 175_320;
    let then = epoch() + Duration::from_seconds(5_400.0) * turns;
    let moved = (feed.state_at(then).unwrap().position_m - first).length();
    println!("after {turns} turns, 30 years: {moved:.6} m");
    // Rounding of the axis: 1.5 n t ulp(a) ≈ 1.6e6 rad × 1.1e-16 × 6.7e6 m.
    assert!(moved < 5e-3, "{moved}");
    let back = (feed
        .state_at(epoch() - Duration::from_seconds(5_400.0) * turns)
        .unwrap()
        .position_m
        - first)
        .length();
    assert!(back < 5e-3, "{back}");
}

#[test]
fn the_drift_by_flattening_is_that_of_known_orbits() {
    // Sun-synchronous: 360° in a tropical year; a = 7178.1363 km, i = 98.603° (Vallado 2013, example 11-2 gives the formula).
    let mut sun = elements(7_178_136.3, 0.0, 0.0);
    sun.inclination_rad = 98.603_f64.to_radians();
    let rates = SecularRates::of(&sun.conic(MU, epoch()).unwrap()).unwrap();
    let deg_day = rates.raan_rad_s.to_degrees() * 86_400.0;
    assert!((deg_day - 0.985_647).abs() < 1e-3, "{deg_day}");
    // Frozen perigee at the critical inclination, sin² i = 4/5.
    let mut molniya = elements(6_978e3, 0.74, 0.0);
    molniya.inclination_rad = 0.8_f64.sqrt().asin();
    let rates = SecularRates::of(&molniya.conic(MU, epoch()).unwrap()).unwrap();
    assert!(
        rates.argument_of_periapsis_rad_s.abs() < 1e-20,
        "{}",
        rates.argument_of_periapsis_rad_s
    );
    // The feed moves by these rates: its node after 10 days.
    let options = KeplerOptions {
        drift: Drift::J2,
        ..span(30.0)
    };
    let feed = KeplerFeed::from_elements("sun", Frame::Teme, epoch(), &sun, options).unwrap();
    let state = feed.state_at(epoch() + Duration::from_days(10.0)).unwrap();
    let normal = state.position_m.cross(state.velocity_m_s).normalize();
    let node = normal.x.atan2(-normal.y).to_degrees();
    assert!(
        (node - 1.1_f64.to_degrees() - 9.856).abs() < 0.012,
        "{node}"
    );
    // The velocity is the derivative of the position.
    let h = Duration::from_milliseconds(500.0);
    let at = |e| feed.state_at(e).unwrap();
    let slope = at(state.epoch + h).position_m - at(state.epoch - h).position_m;
    assert!(
        (slope - state.velocity_m_s).length() < 1e-3,
        "{}",
        (slope - state.velocity_m_s).length()
    );
}

#[test]
fn what_is_no_orbit_is_rejected() {
    let rejected = |change: fn(&mut KeplerElements)| {
        let mut e = elements(7e6, 0.1, 20.0);
        change(&mut e);
        e.conic(MU, epoch()).unwrap_err()
    };
    assert!(matches!(
        rejected(|e| e.eccentricity = f64::NAN),
        KeplerError::Start(StartError::NotFinite {
            field: "eccentricity"
        })
    ));
    assert!(matches!(
        rejected(|e| e.eccentricity = -0.1),
        KeplerError::Start(StartError::Range { .. })
    ));
    assert!(matches!(
        rejected(|e| e.inclination_rad = 4.0),
        KeplerError::Start(StartError::Range { .. })
    ));
    assert!(matches!(
        rejected(|e| e.size = OrbitSize::Periapsis(-7e6)),
        KeplerError::Start(StartError::Range { .. })
    ));
    assert!(matches!(
        rejected(|e| e.size = OrbitSize::SemiMajorAxis(f64::INFINITY)),
        KeplerError::Start(StartError::NotFinite { .. })
    ));
    for (a, e) in [(-7e6, 0.5), (7e6, 1.5), (7e6, 1.0), (-7e6, 1.0), (0.0, 1.2)] {
        let mut orbit = elements(7e6, e, 0.0);
        orbit.size = OrbitSize::SemiMajorAxis(a);
        let error = orbit.conic(MU, epoch()).unwrap_err();
        assert!(
            matches!(
                error,
                KeplerError::Contradiction { .. } | KeplerError::Start(StartError::Range { .. })
            ),
            "{error}"
        );
    }
    let mut parabola = elements(7e6, 1.0, 0.0);
    parabola.anomaly = Anomaly::Mean(0.1);
    assert_eq!(
        parabola.conic(MU, epoch()).unwrap_err(),
        KeplerError::NoMeanAnomaly
    );
    assert!(matches!(
        elements(7e6, 2.0, 121.0).conic(MU, epoch()),
        Err(KeplerError::BeyondAsymptote { .. })
    ));
    assert!(elements(7e6, 2.0, 119.0).conic(MU, epoch()).is_ok());
    assert!(matches!(
        Conic::from_state(MU, DVec3::ZERO, DVec3::X),
        Err(StartError::Range { .. })
    ));
    assert!(matches!(
        Conic::from_state(MU, DVec3::NAN, DVec3::X),
        Err(StartError::NotFinite { .. })
    ));
    let feed = |e: KeplerElements, frame, options| {
        KeplerFeed::from_elements("x", frame, epoch(), &e, options)
    };
    assert!(matches!(
        feed(elements(7e6, 0.1, 0.0), Frame::Itrf, span(1.0)),
        Err(KeplerError::TurningFrame { .. })
    ));
    let drift = KeplerOptions {
        drift: Drift::J2,
        ..span(1.0)
    };
    assert!(matches!(
        feed(elements(7e6, 1.1, 0.0), Frame::Gcrf, drift),
        Err(KeplerError::DriftNeedsEllipse { .. })
    ));
    assert!(matches!(
        feed(elements(6e6, 0.1, 0.0), Frame::Gcrf, span(1.0)),
        Err(KeplerError::Start(StartError::BelowGround { .. }))
    ));
    assert!(matches!(
        feed(elements(7e6, 0.1, 0.0), Frame::Gcrf, span(-1.0)),
        Err(KeplerError::EmptySpan { .. })
    ));
}

#[test]
fn the_ground_is_met_where_the_conic_meets_it() {
    for (q, e, nu) in [
        (6.3e6, 0.05, 180.0),
        (6.36e6, 0.9999, -100.0),
        (2e6, 0.7, 170.0),
        (6e6, 1.2, -60.0),
        (6.366e6, 0.002, 180.0),
    ] {
        let feed =
            KeplerFeed::from_elements("low", Frame::Gcrf, epoch(), &elements(q, e, nu), span(4e4))
                .unwrap();
        let impact = feed.impact().unwrap_or_else(|| panic!("{q} {e} {nu}"));
        let height = |e| {
            Ellipsoid::WGS84
                .geodetic_from_itrf(feed.state_at(e).unwrap().position_m)
                .height_m
        };
        assert!(height(impact).abs() < 0.01, "{}", height(impact));
        let (first, last) = feed.validity();
        assert_eq!(last, impact);
        // Nowhere between is it under the ground.
        for k in 0..=1000 {
            assert!(
                height(first + (last - first) * (f64::from(k) / 1000.0)) > -0.01,
                "{q} {e} {k}"
            );
        }
        assert!(
            feed.state_at(impact + Duration::from_milliseconds(10.0))
                .is_err()
        );
    }
}

#[test]
fn the_solver_ends_in_few_rounds_wherever_it_is_sent() {
    let (mut most, mut sum, mut calls) = (0, 0, 0);
    let mut conics = Vec::new();
    for q in [1.0, 7e6, 1e12] {
        for e in [
            0.0,
            1e-9,
            0.1,
            0.9,
            0.9999,
            1.0 - 1e-12,
            1.0,
            1.0 + 1e-12,
            1.1,
            10.0,
            1e5,
        ] {
            conics.push((q, e, (1.0 - e) / q));
        }
    }
    // Straight lines, bound, at the speed of escape and beyond.
    conics.extend([1e-7, 1e-14, 0.0, -1e-14, -1e-7].map(|alpha| (0.0, 1.0, alpha)));
    for (q, e, alpha) in conics {
        let conic = Conic {
            periapsis_m: q,
            eccentricity: e,
            reciprocal_axis_1_m: alpha,
            ..conic(7e6, 0.0, 0.0)
        };
        // An ellipse's time is taken to half a turn before.
        let half = if alpha > 0.0 {
            PI / (alpha * alpha.sqrt())
        } else {
            f64::MAX
        };
        for k in -40..=160 {
            let tau = 10f64.powf(f64::from(k) * 0.25);
            if tau <= half {
                let (chi, rounds) = conic.solve(tau);
                assert!(chi.is_finite() && chi > 0.0, "{e} {q} {alpha} {tau}");
                if rounds > most {
                    println!("e = {e}, q = {q}, τ = {tau:e}: {rounds} rounds");
                }
                (most, sum, calls) = (most.max(rounds), sum + rounds, calls + 1);
            }
        }
    }
    println!(
        "{calls} times: {most} rounds at most, {:.1} on average",
        f64::from(sum) / f64::from(calls)
    );
    assert!(most <= 10 && sum < 4 * calls, "{most} {sum} {calls}");
}

#[test]
fn a_circle_drifts_from_where_it_is() {
    // A circle's periapsis is undefined: the drift must not change the position at the epoch, nor the rate of the argument of latitude.
    for e in [0.0, 1e-15, 1e-12, 1e-3] {
        let (position_m, velocity_m_s) = conic(7e6, e, 70.0).state_after(0.0);
        let state = OrbitState {
            epoch: epoch(),
            frame: Frame::Gcrf,
            position_m,
            velocity_m_s,
        };
        let options = KeplerOptions {
            drift: Drift::J2,
            ..span(1.0)
        };
        let feed = KeplerFeed::from_state("circle", &state, options).unwrap();
        let off = (feed.state_at(epoch()).unwrap().position_m - position_m).length();
        assert!(off < 1e-6, "{e}: {off}");
    }
}
