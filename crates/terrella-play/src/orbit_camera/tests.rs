//! The camera over places, sizes and fields of view drawn by lot.

use super::*;

const FLAT: Globe<'static> = Globe {
    ellipsoid: Ellipsoid::WGS84,
    ground: None,
};

/// Numbers drawn by lot, the same every time.
struct Lot(u64);

impl Lot {
    /// 0…1.
    fn part(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.part()
    }

    fn screen(&mut self) -> Screen {
        Screen {
            size_px: DVec2::new(self.between(200.0, 3840.0), self.between(120.0, 2160.0)).floor(),
            fov_rad: self.between(0.5, 120.0).to_radians(),
        }
    }

    /// From 20 m to 400 000 km, poles and date line included, looking anywhere below the horizon.
    fn camera(&mut self) -> OrbitCamera {
        let (lat, lon) = (self.between(-1.0, 1.0).asin(), self.between(-PI, PI));
        OrbitCamera {
            place: Geodetic {
                lat_rad: lat,
                lon_rad: lon,
                height_m: 10f64.powf(self.between(1.3, 8.6)),
            },
            heading_rad: self.between(-PI, PI),
            pitch_rad: self.between(-90.0, -10.0).to_radians(),
        }
    }

    fn pixel(&mut self, screen: &Screen) -> DVec2 {
        DVec2::new(self.part(), self.part()) * screen.size_px
    }
}

fn assert_sound(camera: &OrbitCamera, what: &str) {
    let numbers = [
        camera.place.lat_rad,
        camera.place.lon_rad,
        camera.place.height_m,
        camera.heading_rad,
        camera.pitch_rad,
    ];
    assert!(numbers.iter().all(|n| n.is_finite()), "{what}: {camera:?}");
    assert!(
        camera.place.lat_rad.abs() <= FRAC_PI_2,
        "{what}: {camera:?}"
    );
    assert!(
        camera.place.height_m >= MIN_CLEARANCE_M * 0.999,
        "{what}: {camera:?}"
    );
}

fn screen(width_px: f64, height_px: f64, fov_deg: f64) -> Screen {
    Screen {
        size_px: DVec2::new(width_px, height_px),
        fov_rad: fov_deg.to_radians(),
    }
}

#[test]
fn the_grabbed_place_stays_under_the_pointer() {
    let mut lot = Lot(0x5eed_0001);
    let (mut drags, mut north_up, mut worst_px) = (0, 0, 0.0_f64);
    while drags < 2_000 {
        let (screen, camera) = (lot.screen(), lot.camera());
        let (from, to) = (lot.pixel(&screen), lot.pixel(&screen));
        let grabbed = camera.pick(&FLAT, &screen, from);
        let (Some(grabbed), Some(_)) = (grabbed, camera.pick(&FLAT, &screen, to)) else {
            continue;
        };
        drags += 1;
        let moved = camera.drag(&FLAT, &screen, grabbed, to);
        assert_sound(&moved, "a drag");
        let seen = moved.pixel_of(&FLAT.ellipsoid, &screen, grabbed);
        let off_px = seen.map_or(f64::INFINITY, |seen| seen.distance(to));
        assert!(
            off_px <= 2.0,
            "{off_px} px of {screen:?} {camera:?} {from} to {to}: {moved:?}"
        );
        worst_px = worst_px.max(off_px);
        assert_eq!(moved.place.height_m, camera.place.height_m);
        assert_eq!(moved.pitch_rad, camera.pitch_rad);
        north_up += u32::from(moved.heading_rad == camera.heading_rad);
    }
    println!("{north_up} of {drags} keep their heading; worst {worst_px:.3} px");
    assert!(
        north_up > drags / 2,
        "{north_up} of {drags} keep their heading"
    );
}

#[test]
fn the_globe_follows_a_hand_over_poles_and_the_date_line() {
    let mut lot = Lot(0x5eed_0002);
    let mut drags = 0;
    while drags < 1_000 {
        let screen = screen(1280.0, 720.0, 40.0);
        let near_pole = lot.part() < 0.5;
        let lat_deg = match near_pole {
            true => lot.between(80.0, 90.0).copysign(lot.between(-1.0, 1.0)),
            false => lot.between(-60.0, 60.0),
        };
        let lon_deg = lot.between(175.0, 185.0);
        let height_m = 10f64.powf(lot.between(3.0, 7.8));
        let camera = OrbitCamera {
            place: Geodetic::from_degrees(lat_deg, lon_deg, height_m),
            heading_rad: 0.0,
            pitch_rad: -FRAC_PI_2,
        };
        let (from, to) = (lot.pixel(&screen), lot.pixel(&screen));
        let Some(grabbed) = camera.pick(&FLAT, &screen, from) else {
            continue;
        };
        drags += 1;
        // As a hand moves: in many small steps, each from the camera of the one before.
        let mut moved = camera;
        for step in 1..=20 {
            let at = from.lerp(to, f64::from(step) / 20.0);
            let was_on_globe = moved.pick(&FLAT, &screen, at).is_some();
            moved = moved.drag(&FLAT, &screen, grabbed, at);
            assert_sound(&moved, "a drag near a pole");
            let seen = moved.pixel_of(&FLAT.ellipsoid, &screen, grabbed);
            let off_px = seen.map_or(f64::INFINITY, |seen| seen.distance(at));
            assert!(
                off_px <= 2.0 || !was_on_globe,
                "{off_px} px: {camera:?} {from} to {to} at {at}"
            );
        }
    }
}

#[test]
fn a_pointer_beside_the_globe_holds_the_place_at_the_limb() {
    let screen = screen(1280.0, 720.0, 30.0);
    let camera = OrbitCamera {
        place: Geodetic::from_degrees(10.0, 20.0, 35_786_000.0),
        heading_rad: 0.0,
        pitch_rad: -FRAC_PI_2,
    };
    let middle = screen.middle();
    let grabbed = camera.pick(&FLAT, &screen, middle).expect("the globe");
    let corner = DVec2::new(1279.0, 1.0);
    assert_eq!(camera.pick(&FLAT, &screen, corner), None);
    let moved = camera.drag(&FLAT, &screen, grabbed, corner);
    let seen = moved
        .pixel_of(&FLAT.ellipsoid, &screen, grabbed)
        .expect("ahead");
    // The disc's radius: asin(R/(R + h)), 8.7°, on this screen.
    let radius_px = (6_378_137.0_f64 / 42_164_137.0).asin().tan() / screen.pixel_rad();
    assert!((seen.distance(middle) - radius_px).abs() < 4.0, "{seen}");
    // It is where the line from the middle to the pointer leaves the disc.
    assert!(
        (seen - middle).angle_to(corner - middle).abs() < 0.02,
        "{seen}"
    );
    assert!(!solve::is_inside(&camera, &FLAT.ellipsoid, &screen, corner));
    assert!(solve::is_inside(&camera, &FLAT.ellipsoid, &screen, middle));
}

#[test]
fn the_wheel_multiplies_the_distance_and_keeps_the_place_under_the_pointer() {
    let mut lot = Lot(0x5eed_0003);
    let (mut turns, mut kept) = (0, 0);
    while turns < 1_000 {
        let (screen, camera) = (lot.screen(), lot.camera());
        let at = lot.pixel(&screen);
        let Some(held) = camera.pick(&FLAT, &screen, at) else {
            continue;
        };
        if camera.place.height_m < 100.0 || camera.pick(&FLAT, &screen, screen.middle()).is_none() {
            continue;
        }
        turns += 1;
        let factor = 0.25_f64.mul_add(lot.part(), 0.7);
        let nearer = camera.approach(&FLAT, &screen, at, factor);
        assert_sound(&nearer, "the wheel");
        let ratio = nearer.place.height_m / camera.place.height_m;
        assert!(
            ratio < 1.0 && ratio > 0.5 * factor,
            "{ratio} for {factor}: {camera:?}"
        );
        let seen = nearer.pixel_of(&FLAT.ellipsoid, &screen, held);
        kept += u32::from(seen.is_some_and(|seen| seen.distance(at) <= 2.0));
    }
    // The rest are places at the limb, which would turn the globe away.
    assert!(kept > 900, "{kept} of {turns}");
}

#[test]
fn the_wheel_goes_from_the_whole_disc_to_the_ground_and_back() {
    let screen = screen(640.0, 360.0, 45.0);
    let mountain = |lat: f64, lon: f64| 4_000.0 + 500.0 * (300.0 * lat).sin() * (300.0 * lon).cos();
    let hilly = Globe {
        ellipsoid: Ellipsoid::WGS84,
        ground: Some(&mountain),
    };
    for globe in [FLAT, hilly] {
        let mut camera = OrbitCamera {
            place: Geodetic::from_degrees(46.0, 8.0, 60_000_000.0),
            heading_rad: 0.0,
            pitch_rad: -FRAC_PI_2,
        };
        let at = DVec2::new(300.0, 190.0);
        let target = camera.pick(&globe, &screen, at).expect("the globe");
        for _ in 0..300 {
            camera = camera.approach(&globe, &screen, at, 0.84);
            assert_sound(&camera, "inwards");
            let clearance_m = globe.clearance_m(camera.pose(&globe.ellipsoid).eye_itrf_m);
            assert!(clearance_m > 0.999 * MIN_CLEARANCE_M, "{clearance_m} m");
        }
        let eye = camera.pose(&globe.ellipsoid).eye_itrf_m;
        assert!(eye.distance(target) < 60.0, "{} m", eye.distance(target));
        for _ in 0..300 {
            camera = camera.approach(&globe, &screen, at, 1.0 / 0.84);
            assert_sound(&camera, "outwards");
        }
        assert!(camera.place.height_m > 0.9 * MAX_HEIGHT_M, "{camera:?}");
        assert!(camera.pick(&globe, &screen, screen.middle()).is_some());
    }
}

#[test]
fn tilting_goes_around_the_place_in_the_middle() {
    let mut lot = Lot(0x5eed_0004);
    let mut tilts = 0;
    while tilts < 500 {
        let (screen, camera) = (lot.screen(), lot.camera());
        let Some(middle) = camera.pick(&FLAT, &screen, screen.middle()) else {
            continue;
        };
        tilts += 1;
        let by = (lot.pixel(&screen) - screen.middle()) * 0.5;
        let tilted = camera.tilt(&FLAT, &screen, by);
        assert_sound(&tilted, "a tilt");
        let seen = tilted
            .pixel_of(&FLAT.ellipsoid, &screen, middle)
            .expect("ahead");
        let off_px = seen.distance(screen.middle());
        assert!(off_px < 1.0, "{off_px} px: {camera:?} {by}");
    }
    let screen = lot.screen();
    let camera = OrbitCamera {
        place: Geodetic::from_degrees(46.0, 8.0, 100_000.0),
        heading_rad: 0.3,
        pitch_rad: -FRAC_PI_2,
    };
    let lowered = camera.tilt(&FLAT, &screen, DVec2::new(0.0, 0.25 * screen.size_px.y));
    assert!((lowered.pitch_rad + 0.25 * PI).abs() < 0.02, "{lowered:?}");
    let turned = lowered.tilt(&FLAT, &screen, DVec2::new(20.0, 0.0));
    assert!(turned.heading_rad < lowered.heading_rad, "{turned:?}");
    let north = turned.north_up(&FLAT, &screen);
    assert!(north.heading_rad.abs() < 1e-3, "{north:?}");
}

#[test]
fn a_head_turns_where_nothing_is_in_the_middle() {
    let screen = screen(640.0, 360.0, 45.0);
    let camera = OrbitCamera {
        place: Geodetic::from_degrees(0.0, 0.0, 400_000.0),
        heading_rad: 1.0,
        pitch_rad: 0.2,
    };
    let turned = camera.tilt(&FLAT, &screen, DVec2::new(10.0, -10.0));
    assert!(turned.heading_rad < 1.0 && turned.pitch_rad < 0.2);
    assert_eq!(turned.place, camera.place);
    // The limb stays where it is on screen while the eye rises.
    let risen = camera.approach(&FLAT, &screen, DVec2::ZERO, 2.0);
    assert!((risen.place.height_m - 800_000.0).abs() < 1.0 && risen.pitch_rad < camera.pitch_rad);
    let spun = camera.spin(&FLAT, &screen, DVec2::new(50.0, 0.0));
    assert_sound(&spun, "a spin");
    assert!(spun.place != camera.place && spun.pitch_rad == camera.pitch_rad);
}

#[test]
fn a_pose_comes_back_from_the_camera() {
    let mut lot = Lot(0x5eed_0005);
    for _ in 0..500 {
        let camera = lot.camera();
        let pose = camera.pose(&FLAT.ellipsoid);
        let again = OrbitCamera::of_pose(&pose, &FLAT.ellipsoid).pose(&FLAT.ellipsoid);
        assert!(
            again.eye_itrf_m.distance(pose.eye_itrf_m) < 1e-6,
            "{camera:?}"
        );
        assert!(again.forward.distance(pose.forward) < 1e-9, "{camera:?}");
        assert!(again.up.distance(pose.up) < 1e-9, "{camera:?}");
    }
}

#[test]
fn rays_meet_the_relief_and_not_the_ellipsoid() {
    let ridge = |lat: f64, _: f64| {
        if lat.to_degrees() > 45.0 {
            3_000.0
        } else {
            0.0
        }
    };
    let hilly = Globe {
        ellipsoid: Ellipsoid::WGS84,
        ground: Some(&ridge),
    };
    let screen = screen(640.0, 360.0, 45.0);
    let camera = OrbitCamera {
        place: Geodetic::from_degrees(44.9, 8.0, 5_000.0),
        heading_rad: 0.0,
        pitch_rad: -0.25,
    };
    let hit = camera
        .pick(&hilly, &screen, screen.middle())
        .expect("the ridge");
    let place = hilly.ellipsoid.geodetic_from_itrf(hit);
    assert!(
        (place.lat_rad.to_degrees() - 45.0).abs() < 0.001,
        "{place:?}"
    );
    assert!((0.0..3_001.0).contains(&place.height_m), "{place:?}");
    let to = screen.middle() + DVec2::new(80.0, 40.0);
    let moved = camera.drag(&hilly, &screen, hit, to);
    let seen = moved
        .pixel_of(&hilly.ellipsoid, &screen, hit)
        .expect("ahead");
    assert!(seen.distance(to) < 2.0, "{seen}");
}

#[test]
fn numbers_that_are_none_change_nothing() {
    let screen = screen(640.0, 360.0, 45.0);
    let camera = OrbitCamera {
        place: Geodetic::from_degrees(0.0, 0.0, 400_000.0),
        heading_rad: 0.0,
        pitch_rad: -FRAC_PI_2,
    };
    let grabbed = camera
        .pick(&FLAT, &screen, screen.middle())
        .expect("the globe");
    let none = DVec2::splat(f64::NAN);
    let empty = Screen {
        size_px: DVec2::ZERO,
        ..screen
    };
    assert_eq!(camera.pick(&FLAT, &screen, none), None);
    assert_eq!(camera.drag(&FLAT, &screen, grabbed, none), camera);
    assert_eq!(camera.drag(&FLAT, &screen, DVec3::NAN, DVec2::ONE), camera);
    assert_eq!(camera.drag(&FLAT, &empty, grabbed, DVec2::ONE), camera);
    assert_eq!(camera.tilt(&FLAT, &screen, none), camera);
    assert_eq!(camera.spin(&FLAT, &screen, none), camera);
    for factor in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        assert_eq!(camera.approach(&FLAT, &screen, DVec2::ONE, factor), camera);
    }
    assert_sound(
        &camera.approach(&FLAT, &screen, none, 0.5),
        "a wheel without a pointer",
    );
}
