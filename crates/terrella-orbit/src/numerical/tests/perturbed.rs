use super::*;

#[test]
fn energy_and_momentum_are_kept_under_flattening() {
    let model = ForceModel {
        gravity: Gravity::ZonalOfJ2000 { degree: 6 },
        ..ForceModel::default()
    };
    for (e, tolerance, most) in [
        (0.001, 1e-10, 1e-8),
        (0.001, 1e-13, 2e-11),
        (0.74, 1e-13, 2e-11),
    ] {
        let conic = conic(7e6, e, 63.4, 0.0);
        let options = NumericalOptions {
            relative_tolerance: tolerance,
            solver: Solver::Explicit,
            ..after(10.0)
        };
        let feed = fly(&start(&conic), &model, &options);
        let mut motion = EquationsOfMotion::new(&model, &Spacecraft::default(), epoch(), 1e-9);
        let mut kept = |state: OrbitState| {
            let (r, v) = (state.position_m, state.velocity_m_s);
            (0.5 * v.length_squared() - motion.potential(r), r.cross(v).z)
        };
        let (energy, momentum) = kept(feed.state_at(epoch()).unwrap());
        let mut worst = 0.0_f64;
        for k in 1..=300 {
            let (e, m) = kept(
                feed.state_at(epoch() + Duration::from_hours(0.8 * f64::from(k)))
                    .unwrap(),
            );
            worst = worst
                .max((e / energy - 1.0).abs())
                .max((m / momentum - 1.0).abs());
        }
        println!(
            "e = {e}, {tolerance:e}: energy and momentum to {worst:.1e} in ten days, {:?}",
            feed.counts()
        );
        assert!(worst < most, "{worst:e}");
    }
}

#[test]
fn flattening_turns_the_node_as_the_formula_says() {
    let model = ForceModel {
        gravity: Gravity::ZonalOfJ2000 { degree: 2 },
        ..ForceModel::default()
    };
    for (e, inclination) in [(0.01, 51.6), (0.2, 98.0), (0.05, 20.0)] {
        let conic = conic(7e6, e, inclination, 0.0);
        let options = NumericalOptions {
            watch: EventSelection {
                nodes: true,
                apsides: true,
                shadow: false,
            },
            ..after(8.0)
        };
        let feed = fly(&start(&conic), &model, &options);
        let rates = SecularRates::of(&conic).unwrap();
        // From one passage of the node to the last: equal phase, so terms of short period drop out.
        let seen = |kind| {
            let found: Vec<_> = feed
                .events()
                .iter()
                .filter(|event| event.kind == kind)
                .collect();
            let elements = |event: &Event| {
                let s = feed.state_at(event.epoch).unwrap();
                KeplerElements::of(
                    &Conic::from_state(EARTH_GM_M3_S2, s.position_m, s.velocity_m_s).unwrap(),
                )
            };
            let (a, b) = (found[0], found[found.len() - 1]);
            let turn = |x: f64| x - std::f64::consts::TAU * (x / std::f64::consts::TAU).round();
            let seconds = (b.epoch - a.epoch).to_seconds();
            let (a, b) = (elements(a), elements(b));
            (
                turn(b.raan_rad - a.raan_rad) / seconds,
                turn(b.argument_of_periapsis_rad - a.argument_of_periapsis_rad) / seconds,
            )
        };
        let (node, _) = seen(EventKind::AscendingNode);
        assert!(
            (node / rates.raan_rad_s - 1.0).abs() < 0.01,
            "{inclination}: {node:e} {:e}",
            rates.raan_rad_s
        );
        let (_, argument) = seen(EventKind::Periapsis);
        // The formula is of first order, with elements that are the osculating ones here.
        let rate = rates.argument_of_periapsis_rad_s + 1e-12;
        assert!(
            (argument / rate - 1.0).abs() < 0.05,
            "{e} {inclination}: {argument:e} {rate:e}"
        );
    }
}

#[test]
fn the_average_drift_follows_the_integrated_one() {
    // The feed with secular drift against the integration with J2 alone: the plane agrees, the place along the track within
    // what osculating elements taken as mean ones cost.
    let model = ForceModel {
        gravity: Gravity::ZonalOfJ2000 { degree: 2 },
        ..ForceModel::default()
    };
    let conic = conic(7e6, 0.01, 51.6, 0.0);
    let feed = fly(&start(&conic), &model, &after(5.0));
    let options = |drift| KeplerOptions {
        drift,
        first: epoch(),
        last: epoch() + Duration::from_days(5.0),
    };
    let normal = |s: OrbitState| s.position_m.cross(s.velocity_m_s).normalize();
    let apart = |drift| {
        let kepler = KeplerFeed::from_state("k", &start(&conic), options(drift)).unwrap();
        let at = epoch() + Duration::from_days(5.0);
        normal(kepler.state_at(at).unwrap())
            .angle_between(normal(feed.state_at(at).unwrap()))
            .to_degrees()
    };
    let (with, without) = (apart(Drift::J2), apart(Drift::None));
    let at = epoch() + Duration::from_days(5.0);
    let kepler = KeplerFeed::from_state("k", &start(&conic), options(Drift::J2)).unwrap();
    let place = |feed: &dyn Feed| feed.state_at(at).unwrap().position_m;
    let off = (place(&kepler) - place(&feed)).length();
    println!("off the integration by {:.1} km after five days", off / 1e3);
    assert!(off < 3e3, "{off}");
    println!("planes after five days: {with:.3}° with drift, {without:.3}° without");
    assert!(with < 0.1 && without > 10.0);
}

#[test]
fn sun_and_moon_tilt_the_geostationary_orbit_as_is_known() {
    // 0.75° to 0.95° a year, with the Moon's node in its course of 18.6 years (Soop 1994, Handbook of Geostationary Orbits).
    let mut conic = conic(42_164_170.0, 0.0, 0.0, 0.0);
    let pole = terrella_frames::intermediate_from_gcrf(epoch()).row(2);
    conic.to_periapsis = pole.any_orthonormal_vector();
    conic.across = pole.cross(conic.to_periapsis);
    let tilt = |sun, moon| {
        let model = ForceModel {
            gravity: Gravity::Zonal { degree: 2 },
            sun,
            moon,
            ..ForceModel::default()
        };
        let options = NumericalOptions {
            relative_tolerance: 1e-9,
            ..after(365.25)
        };
        let feed = fly(&start(&conic), &model, &options);
        let s = feed.state_at(options.last).unwrap();
        s.position_m
            .cross(s.velocity_m_s)
            .angle_between(pole)
            .to_degrees()
    };
    let (both, sun, none) = (tilt(true, true), tilt(true, false), tilt(false, false));
    println!("after a year: {both:.3}° by both, {sun:.3}° by the Sun, {none:.4}° by neither");
    assert!((0.75..0.95).contains(&both), "{both}");
    assert!((0.2..0.35).contains(&sun), "{sun}");
    assert!(none < 0.02, "{none}");
}

#[test]
fn drag_lowers_an_orbit_as_the_formula_says() {
    // Circular, equatorial: da/dt = −ρ B a² v (v − ωa)²/μ, constant except for the decay itself.
    for air in [AtmosphereModel::Exponential, AtmosphereModel::Standard1976] {
        let mut conic = conic(6_378_137.0 + 400e3, 0.0, 0.0, 0.0);
        let pole = terrella_frames::intermediate_from_gcrf(epoch()).row(2);
        conic.to_periapsis = pole.any_orthonormal_vector();
        conic.across = pole.cross(conic.to_periapsis);
        let model = ForceModel {
            drag: Some(air),
            ..ForceModel::default()
        };
        let feed = fly(&start(&conic), &model, &after(1.0));
        let s = feed.state_at(epoch() + Duration::from_days(1.0)).unwrap();
        let a = 1.0
            / Conic::from_state(EARTH_GM_M3_S2, s.position_m, s.velocity_m_s)
                .unwrap()
                .reciprocal_axis_1_m;
        let a0 = conic.periapsis_m;
        let v = (EARTH_GM_M3_S2 / a0).sqrt();
        let through_air = v - terrella_frames::EARTH_ROTATION_RATE_RAD_S * a0;
        let craft = Spacecraft::default();
        let b = craft.drag_coefficient * craft.drag_area_m2 / craft.mass_kg;
        let rate = -air.density_kg_m3(400e3) * b * a0 * a0 * v * through_air * through_air
            / EARTH_GM_M3_S2;
        let fallen = a - a0;
        println!(
            "{air:?}: {fallen:.2} m a day, formula {:.2} m",
            rate * 86_400.0
        );
        assert!((fallen / (rate * 86_400.0) - 1.0).abs() < 0.005, "{fallen}");
    }
}

#[test]
fn a_thrust_is_flown_without_a_stumble() {
    // A minute of push, entered and left within a day: restarted at both ends, no step tries to cross them.
    let state = start(&conic(7e6, 0.001, 50.0, 0.0));
    let hour = |h: f64| epoch() + Duration::from_hours(h);
    let push = |axes, acceleration_m_s2| Thrust {
        first: hour(3.0),
        last: hour(3.0) + Duration::from_seconds(60.0),
        acceleration_m_s2,
        axes,
    };
    let model = |thrust| ForceModel {
        thrusts: vec![thrust],
        ..ForceModel::default()
    };
    let coast = fly(&state, &ForceModel::default(), &after(1.0));
    for axes in [ThrustAxes::Gcrf, ThrustAxes::Flight] {
        let feed = fly(
            &state,
            &model(push(axes, DVec3::new(0.5, 0.0, 0.0))),
            &after(1.0),
        );
        println!("{axes:?}: {:?} against {:?}", feed.counts(), coast.counts());
        assert!(feed.counts().rejected <= coast.counts().rejected + 6);
        // The same in three runs, each from the last one's end.
        let mut piece = state;
        for (end, thrust) in [
            (hour(3.0), false),
            (push(axes, DVec3::X).last, true),
            (hour(24.0), false),
        ] {
            let options = NumericalOptions {
                relative_tolerance: 1e-13,
                ..NumericalOptions::between(piece.epoch, end)
            };
            let forces = if thrust {
                model(push(axes, DVec3::new(0.5, 0.0, 0.0)))
            } else {
                ForceModel::default()
            };
            piece = fly(&piece, &forces, &options).state_at(end).unwrap();
        }
        let apart = (feed.state_at(hour(24.0)).unwrap().position_m - piece.position_m).length();
        assert!(apart < 2.0, "{apart}");
        // 30 m/s are many kilometres by the end of the day.
        assert!((piece.position_m - coast.state_at(hour(24.0)).unwrap().position_m).length() > 1e4);
    }
}

#[test]
fn the_edge_of_a_cylinder_is_flown_over() {
    // The light jumps at the edge; nothing announces it. Small steps find it, and both shadows agree nearly.
    let state = start(&conic(7e6, 0.001, 20.0, 0.0));
    let sail = Spacecraft {
        sunlit_area_m2: 100.0,
        mass_kg: 1.0,
        ..Spacecraft::default()
    };
    let end = |shadow, relative_tolerance| {
        let model = ForceModel {
            sunlight: Some(shadow),
            ..ForceModel::default()
        };
        let options = NumericalOptions {
            relative_tolerance,
            ..after(0.5)
        };
        NumericalFeed::new("sail", &state, &model, &sail, &options)
            .unwrap()
            .state_at(options.last)
            .unwrap()
            .position_m
    };
    let exact = end(Shadow::Cylinder, 1e-13);
    for (tolerance, most) in [(1e-6, 1e5), (1e-8, 100.0), (1e-10, 20.0), (1e-12, 5.0)] {
        let off = (end(Shadow::Cylinder, tolerance) - exact).length();
        println!("cylinder, {tolerance:e}: {off:.2e} m");
        assert!(off < most, "{tolerance:e}: {off}");
    }
    let cone = (end(Shadow::Cone, 1e-12) - exact).length();
    let none = (end(Shadow::None, 1e-12) - exact).length();
    assert!(cone < 0.05 * none && none > 1e3, "{cone} {none}");
}
