use super::*;

/// Everything that shapes a fall.
fn fall() -> ForceModel {
    ForceModel {
        gravity: Gravity::Zonal { degree: 4 },
        drag: Some(AtmosphereModel::Standard1976),
        ..ForceModel::default()
    }
}

fn with_area_to_mass(area_to_mass_m2_kg: f64) -> Spacecraft {
    Spacecraft {
        mass_kg: 1.0,
        drag_area_m2: area_to_mass_m2_kg,
        ..Spacecraft::default()
    }
}

/// Circular at 120 km.
fn entry() -> OrbitState {
    start(&conic(6_378_137.0 + 120e3, 0.0, 20.0, 0.0))
}

#[test]
fn everything_comes_down_from_a_craft_to_a_balloon_of_one_gram() {
    // 0.005 m²/kg: a compact craft. 70 m²/kg: a sphere of 30 cm that weighs a gram.
    for area_to_mass in [0.005, 0.05, 1.0, 70.0] {
        let craft = with_area_to_mass(area_to_mass);
        let options = NumericalOptions {
            relative_tolerance: 1e-9,
            ..after(5.0)
        };
        let feed = NumericalFeed::new("down", &entry(), &fall(), &craft, &options).unwrap();
        let impact = feed.impact().unwrap();
        println!(
            "{area_to_mass} m²/kg: impact after {:.1} s, {:?}",
            (impact - epoch()).to_seconds(),
            feed.counts()
        );
        let state = feed.state_at(impact).unwrap();
        let itrf = state.in_itrf();
        let height = Ellipsoid::WGS84
            .geodetic_from_itrf(itrf.position_m)
            .height_m;
        assert!(height.abs() < 0.05, "{height}");
        // It falls straight down through the turning air at the speed where drag is weight.
        let speed = itrf.velocity_m_s.length();
        let density = AtmosphereModel::Standard1976.density_kg_m3(0.0);
        let terminal = (2.0 * 9.80 / (density * 2.2 * area_to_mass)).sqrt();
        assert!(
            (speed / terminal - 1.0).abs() < 0.01,
            "{area_to_mass}: {speed} {terminal}"
        );
        for k in 0..=200 {
            let s = feed
                .state_at(epoch() + (impact - epoch()) * (f64::from(k) / 200.0))
                .unwrap();
            assert!(s.position_m.is_finite() && s.velocity_m_s.is_finite());
        }
        let message = feed
            .state_at(impact + Duration::from_seconds(1.0))
            .unwrap_err()
            .to_string();
        assert!(
            message.contains("meets the ground at 2018-01-"),
            "{message}"
        );
        assert_eq!(
            feed.events().last().map(|e| e.kind),
            Some(EventKind::Impact)
        );
    }
}

#[test]
fn a_balloon_is_stiff_and_the_automatic_method_knows() {
    let craft = with_area_to_mass(70.0);
    let run = |solver, relative_tolerance| {
        let options = NumericalOptions {
            solver,
            relative_tolerance,
            ..after(5.0)
        };
        let feed = NumericalFeed::new("balloon", &entry(), &fall(), &craft, &options).unwrap();
        (
            (feed.impact().unwrap() - epoch()).to_seconds(),
            feed.counts(),
            feed,
        )
    };
    let (explicit, explicit_counts, feed) = run(Solver::Explicit, 1e-8);
    let (automatic, automatic_counts, other) = run(Solver::Automatic, 1e-8);
    println!(
        "explicit: {explicit:.4} s {explicit_counts:?}\nautomatic: {automatic:.4} s {automatic_counts:?}"
    );
    assert!(automatic_counts.switches >= 1 && automatic_counts.implicit > 0);
    assert!(automatic_counts.evaluations * 5 < explicit_counts.evaluations);
    assert!((explicit - automatic).abs() < 0.5, "{explicit} {automatic}");
    // The whole way down.
    for k in 0..=400 {
        let at = epoch() + Duration::from_seconds(automatic.min(explicit) * f64::from(k) / 400.0);
        let apart = (feed.state_at(at).unwrap().position_m
            - other.state_at(at).unwrap().position_m)
            .length();
        assert!(apart < 20.0, "{k}: {apart}");
    }
    // The fall is not stiff: only the explicit method is used.
    let options = NumericalOptions {
        relative_tolerance: 1e-8,
        ..after(1.0)
    };
    let craft = NumericalFeed::new(
        "craft",
        &entry(),
        &fall(),
        &with_area_to_mass(0.005),
        &options,
    )
    .unwrap();
    assert_eq!(craft.counts().implicit, 0, "{:?}", craft.counts());
    assert!(craft.stiff_spans().is_empty());
    // The balloon is stiff to the end, and for most of its way.
    let spans = other.stiff_spans();
    let stiff: f64 = spans.iter().map(|(a, b)| (*b - *a).to_seconds()).sum();
    assert!(stiff > 0.8 * automatic, "{stiff} of {automatic}");
    assert!(spans.windows(2).all(|pair| pair[0].1 <= pair[1].0));
    assert!(spans.last().unwrap().1 >= other.impact().unwrap());
}

#[test]
fn a_perigee_in_the_air_brakes_a_long_ellipse() {
    // e = 0.99, perigee at 95 km: each passage takes energy away, until it does not come out again.
    let conic = conic(6_378_137.0 + 95e3, 0.99, 30.0, 180.0);
    let craft = with_area_to_mass(0.01);
    let run = |solver, relative_tolerance| {
        let watch = EventSelection {
            apsides: true,
            ..EventSelection::default()
        };
        let options = NumericalOptions {
            solver,
            relative_tolerance,
            watch,
            ..after(90.0)
        };
        NumericalFeed::new("long", &start(&conic), &fall(), &craft, &options).unwrap()
    };
    let feed = run(Solver::Automatic, 1e-11);
    println!(
        "{:?}\n{:?}",
        feed.counts(),
        feed.events()
            .iter()
            .map(|e| (e.epoch - epoch()).to_seconds())
            .collect::<Vec<_>>()
    );
    let impact = feed.impact().unwrap();
    let apogees: Vec<f64> = feed
        .events()
        .iter()
        .filter(|e| e.kind == EventKind::Apoapsis)
        .map(|e| feed.state_at(e.epoch).unwrap().position_m.length())
        .collect();
    assert!(
        apogees.len() > 3 && apogees.windows(2).all(|pair| pair[1] < pair[0]),
        "{apogees:?}"
    );
    let other = run(Solver::Explicit, 1e-12);
    let apart = (other.impact().unwrap() - impact).to_seconds();
    assert!(apart.abs() < 1.0, "{apart} s");
}

#[test]
fn a_straight_fall_meets_the_ground_when_the_conic_says() {
    let state = OrbitState {
        epoch: epoch(),
        frame: Frame::Gcrf,
        position_m: DVec3::new(0.0, 0.6, 0.8) * 4e7,
        velocity_m_s: DVec3::ZERO,
    };
    let kepler = KeplerFeed::from_state(
        "stone",
        &state,
        KeplerOptions {
            drift: Drift::None,
            first: epoch(),
            last: epoch() + Duration::from_days(1.0),
        },
    )
    .unwrap();
    for solver in [Solver::Explicit, Solver::Automatic, Solver::Implicit] {
        let options = NumericalOptions {
            solver,
            ..after(1.0)
        };
        let feed = fly(&state, &ForceModel::default(), &options);
        let apart = (feed.impact().unwrap() - kepler.impact().unwrap()).to_seconds();
        assert!(apart.abs() < 1e-4, "{solver:?}: {apart}");
    }
    // With air it still arrives, later and slower.
    let feed = fly(&state, &fall(), &after(1.0));
    assert!(feed.impact().unwrap() > kepler.impact().unwrap() + Duration::from_seconds(5.0));
}

#[test]
fn a_flyby_turns_by_the_angle_of_its_hyperbola() {
    // 2 asin(1/e) between the asymptotes; from 4 days before to 4 days after.
    let conic = conic(6.9e6, 1.4, 30.0, 0.0);
    let days = Duration::from_days(4.0);
    let options = NumericalOptions {
        first: epoch() - days,
        last: epoch() + days,
        relative_tolerance: 1e-13,
        ..after(1.0)
    };
    let feed = fly(&start(&conic), &ForceModel::default(), &options);
    assert!(
        off_conic(&feed, &conic) < 0.5,
        "{}",
        off_conic(&feed, &conic)
    );
    let (first, last) = (
        feed.state_at(options.first).unwrap(),
        feed.state_at(options.last).unwrap(),
    );
    let turned = first.velocity_m_s.angle_between(last.velocity_m_s);
    let whole = 2.0 * (1.0_f64 / 1.4).asin();
    assert!(turned < whole && turned > whole - 0.02, "{turned} {whole}");
}

#[test]
fn years_go_by_far_out() {
    // Thirty years on the geostationary ring with J2 and the Moon: a third of a million steps at most, no step limit hit.
    let conic = conic(42_164_170.0, 0.0001, 0.1, 0.0);
    let model = ForceModel {
        gravity: Gravity::ZonalOfJ2000 { degree: 2 },
        ..ForceModel::default()
    };
    let days = 30.0 * 365.25;
    let options = NumericalOptions {
        relative_tolerance: 1e-8,
        ..after(days)
    };
    let feed = fly(&start(&conic), &model, &options);
    println!("thirty years: {:?}", feed.counts());
    assert!(feed.steps() < 350_000);
    let radius = feed.state_at(options.last).unwrap().position_m.length();
    assert!((radius - 42_164_170.0).abs() < 5e4, "{radius}");
}
