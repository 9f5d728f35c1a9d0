//! The motion from the state of an orbit parameter message.

use crate::opm::{flown, low, one, start};
use glam::DVec3;
use terrella_frames::{Duration, Orientation};
use terrella_orbit::numerical::{
    AtmosphereModel, ForceModel, Gravity, NumericalFeed, NumericalOptions, Shadow, Spacecraft,
    Thrust, ThrustAxes,
};
use terrella_orbit::{Feed, OrbitState};

fn hours(hours: f64) -> Duration {
    Duration::from_seconds(hours * 3600.0)
}

/// All forces on a satellite with mass, areas and coefficients.
fn all_forces(thrusts: Vec<Thrust>, orientation: Orientation) -> ForceModel {
    ForceModel {
        gravity: Gravity::Field {
            degree: 20,
            order: 20,
        },
        drag: Some(AtmosphereModel::Standard1976),
        sun: true,
        moon: true,
        sunlight: Some(Shadow::Cone),
        thrusts,
        orientation,
    }
}

fn maneuver(epoch: &str, seconds: f64, frame: &str, dv: [f64; 3]) -> String {
    let [x, y, z] = dv;
    format!(
        "MAN_EPOCH_IGNITION = {epoch}\nMAN_DURATION = {seconds}\nMAN_DELTA_MASS = -100\nMAN_REF_FRAME = {frame}\n\
         MAN_DV_1 = {x}\nMAN_DV_2 = {y}\nMAN_DV_3 = {z}\n"
    )
}

#[test]
fn the_state_is_integrated_under_all_forces() {
    let message = one(&low(""));
    let (first, last) = (start() - hours(3.0), start() + hours(12.0));
    let none = Orientation::default();
    let motion = message.propagated(first, last, &none).unwrap();
    assert_eq!(motion.validity(), (first, last));
    let model = all_forces(Vec::new(), none);
    let options = NumericalOptions::between(first, last);
    let alone = NumericalFeed::new("x", &message.state, &model, &message.craft, &options).unwrap();
    for hour in -3..=12 {
        let at = start() + hours(f64::from(hour));
        let (a, b) = (motion.state_at(at).unwrap(), alone.state_at(at).unwrap());
        assert!(a.position_m.distance(b.position_m) < 1e-3, "{hour}");
    }
    assert_eq!(
        motion.state_at(start()).unwrap().position_m,
        message.state.position_m
    );
    // Drag alone makes half a kilometre of that.
    let bare = low("").replace("DRAG_AREA = 10.000", "DRAG_AREA = 0");
    let bare = flown(&bare, first, last).state_at(last).unwrap();
    let drag_m = bare
        .position_m
        .distance(motion.state_at(last).unwrap().position_m);
    assert!((50.0..5000.0).contains(&drag_m), "{drag_m}");
    let outside = motion.state_at(last + hours(1.0)).unwrap_err().to_string();
    assert!(outside.contains("EUTELSAT W4 is not known"), "{outside}");
}

#[test]
fn impulses_change_the_velocity_at_once_and_are_undone_backwards() {
    let at = start() + hours(2.0);
    let dv = DVec3::new(20.0, 90.0, -30.0);
    for (frame, axes) in [("RTN", false), ("TNW", true)] {
        let kilometres = (dv / 1e3).to_array();
        let text = low(&maneuver("2006-06-03T02:00:00", 0.0, frame, kilometres));
        let last = start() + hours(6.0);
        let motion = flown(&text, start(), last);
        let before = motion.state_at(at - Duration::from_seconds(1e-6)).unwrap();
        let behind = motion.state_at(at).unwrap();
        assert!(before.position_m.distance(behind.position_m) < 0.02);
        let change = behind.velocity_m_s - before.velocity_m_s;
        let z = before.position_m.cross(before.velocity_m_s).normalize();
        let x = match axes {
            true => before.velocity_m_s.normalize(),
            false => before.position_m.normalize(),
        };
        let parts = DVec3::new(change.dot(x), change.dot(z.cross(x)), change.dot(z));
        assert!(parts.distance(dv) < 1e-3, "{frame}: {parts}");

        // The same satellite by its state after the impulse comes to its first state backwards.
        let end = motion.state_at(last).unwrap();
        let (r, v) = (end.position_m / 1e3, end.velocity_m_s / 1e3);
        let mut later = text.replace(
            "EPOCH = 2006-06-03T00:00:00.000",
            "EPOCH = 2006-06-03T06:00:00",
        );
        let mass = "MASS = 1913.000";
        later = later.replace(mass, "MASS = 1813.000");
        for (key, number) in ["X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT"]
            .iter()
            .zip(r.to_array().into_iter().chain(v.to_array()))
        {
            let line = later
                .lines()
                .find(|line| line.starts_with(&format!("{key} =")))
                .unwrap();
            later = later.replacen(line, &format!("{key} = {number:e}"), 1);
        }
        let back = flown(&later, start(), last).state_at(start()).unwrap();
        let meant = motion.state_at(start()).unwrap();
        let off_m = back.position_m.distance(meant.position_m);
        assert!(off_m < 1.0, "{frame}: {off_m}");
    }
}

#[test]
fn burns_are_accelerations_over_their_time_and_take_mass() {
    let text = low(&maneuver(
        "2006-06-03T02:00:00",
        600.0,
        "RTN",
        [0.0, 0.06, 0.0],
    ));
    let message = one(&text);
    let last = start() + hours(3.0);
    let none = Orientation::default();
    let motion = message.propagated(start(), last, &none).unwrap();
    let begin = start() + hours(2.0);
    let end = begin + Duration::from_seconds(600.0);
    let thrust = Thrust {
        first: begin,
        last: end,
        acceleration_m_s2: DVec3::new(0.0, 0.1, 0.0),
        axes: ThrustAxes::Radial,
    };
    let model = all_forces(vec![thrust], none);
    let fly = |state: &OrbitState, craft: &Spacecraft, first, last| {
        NumericalFeed::new(
            "x",
            state,
            &model,
            craft,
            &NumericalOptions::between(first, last),
        )
        .unwrap()
    };
    let during = fly(&message.state, &message.craft, start(), end);
    let there = during.state_at(end).unwrap();
    assert!(
        motion
            .state_at(end)
            .unwrap()
            .position_m
            .distance(there.position_m)
            < 1e-3
    );
    let lighter = Spacecraft {
        mass_kg: 1813.0,
        ..message.craft
    };
    let after = fly(&there, &lighter, end, last).state_at(last).unwrap();
    let own = motion.state_at(last).unwrap();
    assert!(own.position_m.distance(after.position_m) < 1e-3);
    // 60 m/s along the track are some 3 · 60 m for every second that follows.
    let coasting = flown(&low(""), start(), last).state_at(last).unwrap();
    let apart_m = own.position_m.distance(coasting.position_m);
    assert!((300e3..900e3).contains(&apart_m), "{apart_m}");
}

#[test]
fn a_fall_ends_at_the_ground() {
    let text = low(&maneuver(
        "2006-06-03T01:00:00",
        0.0,
        "TNW",
        [-0.5, 0.0, 0.0],
    ));
    let last = start() + hours(9.0);
    let motion = flown(&text, start(), last);
    let impact = motion.impact().unwrap();
    assert!(impact > start() + hours(1.0) && impact < start() + hours(2.0));
    assert_eq!(motion.validity(), (start(), impact));
    assert_eq!(motion.events().len(), 1);
    let error = motion.state_at(last).unwrap_err().to_string();
    assert!(error.contains("meets the ground at"), "{error}");
}
