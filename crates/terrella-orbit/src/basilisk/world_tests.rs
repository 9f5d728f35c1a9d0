use super::*;
use glam::DVec3;

use crate::basilisk::messages;

fn start() -> Epoch {
    "2018-01-15T12:00:00Z".parse().expect("a date")
}

fn take(world: &mut World, bytes: &[u8]) -> Result<Snapshot, UpdateFault> {
    world.take(Message::read(bytes).expect("a message"))
}

#[test]
fn places_are_brought_to_the_earths_centre_and_the_epoch_is_kept() {
    let mut world = World::new(start());
    take(&mut world, &messages::step(1, 10.0)).expect("drawn");
    let snapshot = take(&mut world, &messages::step(2, 500.0)).expect("drawn");
    let craft = snapshot.craft(None).expect("a craft");
    let (s, c) = 0.5_f64.sin_cos();
    // Half a millimetre of f64 at 1.5e11 m.
    assert!((craft.position_m - 7e6 * DVec3::new(c, s, 0.0)).length() < 1e-4);
    assert!((craft.velocity_m_s - 7e3 * DVec3::new(-s, c, 0.0)).length() < 1e-9);
    let ahead = craft.inertial_from_body * DVec3::X;
    assert!((ahead - DVec3::new(c, s, 0.0)).length() < 1e-12, "{ahead}");
    assert_eq!(rfc3339(snapshot.epoch), "2026-03-20T14:54:20.000Z");
    assert_eq!(snapshot.places.len(), 1);
    assert_eq!(snapshot.places[0].color, Some([255, 255, 0]));
    // Row by row: the Earth-fixed x axis is θ east of the inertial x axis.
    let theta = 7.292e-5 * 500.0 + 0.5;
    let x_fixed = snapshot.itrf_from_gcrf.transpose() * DVec3::X;
    assert!((x_fixed - DVec3::new(f64::cos(theta), f64::sin(theta), 0.0)).length() < 1e-12);
    assert!((snapshot.sun_m - DVec3::new(-1.4e11, 4e10, 0.0)).length() < 1e-3);
    assert!(
        snapshot.turns && world.notes().is_empty(),
        "{:?}",
        world.notes()
    );
}

#[test]
fn what_is_missing_is_reported_once_and_the_ephemeris_lights() {
    let mut world = World::new(start());
    let bare = |frame| {
        messages::message(
            frame,
            60.0,
            &[
                messages::bytes(2, &messages::bytes(1, b"earth")),
                messages::body("mars barycenter", [2e11, 0.0, 0.0]),
                messages::body("sun", [f64::NAN; 3]),
                messages::craft("ok", [7e6, 0.0, 0.0], [0.0; 3], [0.0; 3]),
                messages::craft("lost", [f64::NAN, 0.0, 0.0], [0.0; 3], [0.0; 3]),
                messages::craft("spun", [7e6, 0.0, 0.0], [0.0; 3], [f64::INFINITY; 3]),
                messages::bytes(5, b""),
            ],
        )
    };
    let snapshot = take(&mut world, &bare(1)).expect("drawn");
    assert_eq!(snapshot.itrf_from_gcrf, DMat3::IDENTITY);
    assert!(!snapshot.turns);
    assert_eq!(snapshot.sun_m, sun_position_gcrf_m(snapshot.epoch));
    assert_eq!(snapshot.craft.len(), 1);
    assert_eq!(rfc3339(snapshot.epoch), "2018-01-15T12:01:00.000Z");
    let reported = world.notes().join("\n");
    for part in [
        "no epoch", "no Sun", "identity", "lost", "spun", "mars", "quadMaps",
    ] {
        assert!(reported.contains(part), "{part}: {reported}");
    }
    let count = world.notes().len();
    take(&mut world, &bare(2)).expect("drawn");
    assert_eq!(
        world.notes().len(),
        count,
        "reported twice: {:?}",
        world.notes()
    );
}

#[test]
fn what_cannot_be_drawn_is_rejected() {
    let mut world = World::new(start());
    for elapsed_s in [-1.0, f64::NAN, f64::INFINITY, 1e30] {
        let bytes = messages::message(1, elapsed_s, &[]);
        assert_eq!(
            take(&mut world, &bytes),
            Err(UpdateFault::Time),
            "{elapsed_s}"
        );
    }
    let late = messages::message(1, 2.9e9, &[messages::epoch()]);
    assert_eq!(take(&mut world, &late), Err(UpdateFault::Date));
    let mars = messages::message(1, 1.0, &[messages::body("mars", [1.0; 3])]);
    assert_eq!(take(&mut world, &mars), Err(UpdateFault::NoEarth));
    // Without any body the Earth is at the origin.
    let alone = messages::message(
        1,
        1.0,
        &[messages::craft("a", [7e6; 3], [0.0; 3], [0.0; 3])],
    );
    assert_eq!(take(&mut world, &alone).expect("drawn").craft.len(), 1);
    // No rotation.
    let rows = messages::numbers(4, &[2.0; 9]);
    let skewed = messages::bytes(2, &[messages::bytes(1, b"earth"), rows].concat());
    let skewed = take(&mut world, &messages::message(1, 1.0, &[skewed])).expect("drawn");
    assert_eq!(skewed.itrf_from_gcrf, DMat3::IDENTITY);
    assert!(
        world
            .notes()
            .iter()
            .any(|note| note.contains("no rotation"))
    );
}

#[test]
fn between_two_instants_craft_fly_on_their_curve_and_the_earth_turns_on() {
    let mut world = World::new(start());
    let mut at = |elapsed_s: f64| take(&mut world, &messages::step(1, elapsed_s)).expect("drawn");
    let (a, b, truth) = (at(100.0), at(110.0), at(104.0));
    let between = a.toward(&b, 0.4);
    assert_eq!(between.epoch, truth.epoch);
    for (one, other) in between.craft.iter().zip(&truth.craft).take(1) {
        let off_m = (one.position_m - other.position_m).length();
        // h⁴/384 · r ω⁴, and the rounding of 1.5e11 m.
        assert!(off_m < 1e-3, "{off_m}");
        assert!((one.velocity_m_s - other.velocity_m_s).length() < 1e-3);
        assert!(
            one.inertial_from_body
                .angle_between(other.inertial_from_body)
                < 1e-6
        );
    }
    let off = between.itrf_from_gcrf - truth.itrf_from_gcrf;
    assert!(off.to_cols_array().iter().all(|part| part.abs() < 1e-9));
    let none = a.toward(&b, 0.0);
    assert_eq!(none.craft[0].position_m, a.craft[0].position_m);
    assert_eq!(none.epoch, a.epoch);
}
