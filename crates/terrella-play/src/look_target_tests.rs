//! The camera's target is in the image centre.

use super::camera::HeadTurn;
use super::error::PlayError;
use super::flight::{Flight, ViewRequest};
use crate::scene::Scene;
use glam::{DVec2, DVec3};
use terrella::frames::{Ellipsoid, Epoch, Geodetic};

const TWO: &str = "[time]\nstart = \"2018-01-15T12:00:00Z\"\n[[orbit]]\nsource = \"kepler\"\nname = \"ONE\"\nsemi_major_axis_km = 7000\ninclination_deg = 51\n[[orbit]]\nsource = \"kepler\"\nname = \"TWO\"\nsemi_major_axis_km = 7100\ninclination_deg = 51\ntrue_anomaly_deg = 12\n";

fn flight(camera: &str) -> Result<Flight, PlayError> {
    let scene = Scene::from_toml(&format!("{TWO}[camera]\n{camera}\n"), "a.toml".as_ref());
    Flight::open(scene.unwrap_or_else(|error| panic!("{camera}: {error}")))
}

/// Where a point is on screen at a time: the middle is 0, the edges are ±1, up and to the right positive.
fn on_screen(flight: &Flight, seconds: f64, point: impl Fn(Epoch) -> DVec3) -> DVec2 {
    let epoch = flight.scene().time.start + hifitime::Unit::Second * seconds;
    let request = ViewRequest {
        mode: flight.scene().camera.mode,
        look: HeadTurn::default(),
        aspect: 1.5,
    };
    let moment = flight.view_at(epoch, &request).expect("a view");
    let (eye, clip) = moment.view.to_itrf();
    let clip = clip * (point(epoch) - eye).extend(1.0);
    assert!(clip.w > 0.0, "behind the eye");
    DVec2::new(clip.x / clip.w, clip.y / clip.w)
}

#[test]
fn targets_stay_in_the_middle() {
    let station =
        "mode = \"geodetic\"\nlat_deg = 40\nlon_deg = 10\nheight_km = 0.1\nfov_deg = 20\n";
    for (camera, other) in [
        (format!("{station}look_at = \"satellite\""), Some(0)),
        (format!("{station}look_at = \"two\""), Some(1)),
        ("look_at = \"TWO\"".to_owned(), Some(1)),
        (
            "mode = \"horizon\"\nlook_at = \"TWO\"\nroll_deg = 70".to_owned(),
            Some(1),
        ),
        (
            "mode = \"chase\"\nfollow = \"TWO\"\nlook_at = \"ONE\"".to_owned(),
            Some(0),
        ),
        ("look_at = \"sun\"".to_owned(), None),
    ] {
        let flight = flight(&camera).expect("opens");
        for seconds in [0.0, 600.0, 5000.0] {
            let point = |epoch| match other {
                Some(index) => {
                    flight
                        .motion_of(index, epoch)
                        .expect("known")
                        .position_itrf_m
                }
                None => {
                    let sky = flight.sky_at(epoch);
                    sky.sun_itrf * sky.sun_distance_m
                }
            };
            let at = on_screen(&flight, seconds, point);
            assert!(at.length() < 1e-6, "{camera} at {seconds} s: {at}");
        }
    }
    let vienna = Geodetic::from_degrees(48.2, 16.4, 0.0);
    let vienna = Ellipsoid::WGS84.itrf_from_geodetic(vienna);
    let flight = flight("look_at = { lat_deg = 48.2, lon_deg = 16.4 }").expect("opens");
    assert!(on_screen(&flight, 900.0, |_| vienna).length() < 1e-6);
}

/// A roll by 90° clockwise brings what was at the right edge to the top.
#[test]
fn a_roll_turns_the_camera_clockwise() {
    let aside = |epoch| {
        let flight = flight("").expect("opens");
        let motion = flight.motion_of(0, epoch).expect("known");
        let place = Ellipsoid::WGS84.geodetic_from_itrf(motion.position_itrf_m);
        let down = -Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let ahead = motion.velocity_m_s.reject_from_normalized(down).normalize();
        motion.position_itrf_m + 500e3 * down + 100e3 * down.cross(ahead)
    };
    let level = on_screen(&flight("").expect("opens"), 100.0, aside);
    assert!(level.x > 0.1 && level.y.abs() < 1e-9, "{level}");
    let rolled = on_screen(&flight("roll_deg = 90").expect("opens"), 100.0, aside);
    assert!(rolled.y > 0.1 && rolled.x.abs() < 1e-9, "{rolled}");
    let keyed = "keys = [{ time_s = 0, roll_deg = 0 }, { time_s = 200, roll_deg = 180 }]";
    let rolled = on_screen(&flight(keyed).expect("opens"), 100.0, aside);
    assert!(rolled.y > 0.1 && rolled.x.abs() < 1e-9, "{rolled}");
}

#[test]
fn satellites_that_cannot_be_looked_at_are_named() {
    for (camera, part) in [
        ("look_at = \"THREE\"", "THREE"),
        (
            "look_at = \"ONE\"",
            "is the satellite that the camera is on",
        ),
    ] {
        let error = flight(camera).err().expect(camera).to_string();
        assert!(error.contains("look_at") && error.contains(part), "{error}");
    }
}
