use super::*;
use crate::controls::Controls;
use crate::flight::Moment;
use crate::keys::Action;
use crate::picking::ray;
use glam::{DVec2, DVec3};
use std::path::Path;
use terrella::EyeView;
use terrella::frames::{Ellipsoid, utc_from_rfc3339};

fn opened(text: &str) -> Flight {
    let scene = Scene::from_toml(text, Path::new("test.toml")).expect("a good scene");
    Flight::open(scene).expect("opens")
}

fn plan(flight: &Flight, controls: &Controls) -> FilmPlan {
    let source = FilmSource::of(flight).expect("no simulator");
    FilmPlan::new(&source, &controls.film_view())
}

/// The scene with what a plan sets.
fn set(text: &str, plan: &FilmPlan) -> Scene {
    let words = plan.arguments.windows(2);
    let set = words.filter(|pair| pair[0] == "--set");
    let settings = set.map(|pair| pair[1].parse::<Setting>().expect("a setting"));
    let settings: Vec<_> = settings.collect();
    let scene = Scene::from_toml_with(text, Path::new("test.toml"), &settings);
    scene.unwrap_or_else(|error| panic!("{error}"))
}

const SCENE: &str = "[time]\nstart = \"2018-01-15T12:00:00Z\"\nduration_s = 1000\nspeed = 60\n";

#[test]
fn a_film_is_of_the_range_that_is_played_and_of_the_layers_that_are_shown() {
    let flight = opened(SCENE);
    let mut controls = Controls::new(&flight);
    for action in [
        Action::RangeStart(Some(0.2)),
        Action::RangeEnd(Some(0.6)),
        Action::Rate(20.0),
        Action::Layer(Layer::Borders),
        Action::Layer(Layer::Clouds),
        Action::Layer(Layer::Atmosphere),
        Action::Tone(terrella::Tone::Agx),
        Action::Expose(Some(Exposure::Ev(-1.25))),
        Action::Place(48.2, -16.4),
    ] {
        controls.apply(action, 720.0);
    }
    let plan = plan(&flight, &controls);
    assert!((plan.length_s - 20.0).abs() < 1e-9);
    assert_eq!(plan.file, Path::new("iss-zarya-2018-01-15T12-03-20Z.mp4"));
    let value = |name: &str| {
        let words = plan.arguments.windows(2);
        words
            .filter(|pair| pair[0] == name)
            .map(|pair| pair[1].clone())
            .next()
    };
    let start = utc_from_rfc3339(&value("--start").expect("a start")).expect("a date");
    assert_eq!(
        start,
        flight.scene().time.start + hifitime::Unit::Second * 200.0
    );
    assert_eq!(value("--duration").as_deref(), Some("400"));
    let scene = set(SCENE, &plan);
    assert!(scene.layers.borders.is_some() && !scene.earth.clouds && !scene.earth.has_air());
    assert_eq!(scene.time.speed, 20.0);
    assert_eq!(scene.output.exposure, Exposure::Ev(-1.25));
    assert_eq!(scene.captions.len(), 1);
    let station = &scene.stations[0].place;
    assert!((station.lon_rad.to_degrees() + 16.4).abs() < 1e-9);
    // The caption is one word for a shell.
    let command = plan.command();
    assert!(
        command.starts_with("terrella play --start 2018-01-15T12:03:20"),
        "{command}"
    );
    assert!(
        command.contains("'caption.text=\"{satellite}, {time}\"'"),
        "{command}"
    );
    // What the scene has is not set again.
    let own = "[[caption]]\ntext = \"A\"\n[[station]]\nname = \"B\"\nlat_deg = 1\nlon_deg = 2\n";
    let flight = opened(&format!("{SCENE}{own}"));
    let plan = self::plan(&flight, &Controls::new(&flight));
    assert_eq!(
        plan.arguments
            .iter()
            .filter(|word| *word == "--set")
            .count(),
        1
    );
    assert_eq!(quoted("a'b"), "'a'\\''b'");
}

/// An eye that the user has moved is the same in the film: its place, and where the corners of the picture look.
#[test]
fn a_moved_eye_stands_in_the_film_where_it_stands_in_the_window() {
    let flight = opened(SCENE);
    let epoch = flight.scene().time.start;
    let request = Controls::new(&flight).request(1.5);
    let moment = flight.view_at(epoch, &request).expect("a view");
    let eye = Ellipsoid::WGS84
        .itrf_from_geodetic(terrella::frames::Geodetic::from_degrees(-35.0, 170.0, 2e6));
    let fov_rad = 0.7;
    for (forward, up) in [
        (-eye.normalize() + 0.3 * DVec3::Z, DVec3::new(0.3, 0.2, 1.0)),
        (
            -eye.normalize() + 0.2 * DVec3::X,
            DVec3::new(-1.0, 0.4, 0.1),
        ),
        (
            -Ellipsoid::normal(-35_f64.to_radians(), 170_f64.to_radians()),
            DVec3::X,
        ),
    ] {
        let view = EyeView::itrf(eye, forward, up, fov_rad, 1.5);
        let shown = Moment { view, ..moment };
        let mut controls = Controls::new(&flight);
        controls.free_eye(fov_rad);
        let globe = crate::orbit_camera::Globe {
            ellipsoid: Ellipsoid::WGS84,
            ground: None,
        };
        let screen = crate::orbit_camera::Screen {
            size_px: DVec2::new(900.0, 600.0),
            fov_rad,
        };
        controls
            .hand
            .grab(&shown.view, &globe, &screen, DVec2::new(450.0, 300.0));
        let scene = set(SCENE, &plan(&flight, &controls));
        assert_eq!(scene.camera.mode, CameraMode::Geodetic);
        let film = Flight::open(scene).expect("opens");
        let Some(FreeEye::Orbit(camera)) = controls.hand.eye() else {
            panic!("an eye over the ground");
        };
        // What the window draws: a grabbed view loses its roll.
        let drawn = camera.pose(&Ellipsoid::WGS84).view(fov_rad, 1.5);
        let filmed = film.at(epoch, 1.5).expect("a moment").view;
        let [(one, _), (other, _)] = [filmed, drawn].map(|view| view.to_itrf());
        assert!(one.distance(other) < 10.0, "{one} {other}");
        for corner in [
            DVec2::ZERO,
            DVec2::new(900.0, 0.0),
            DVec2::new(300.0, 600.0),
        ] {
            let size = DVec2::new(900.0, 600.0);
            let rays = [filmed, drawn].map(|view| ray(&view, size, corner).expect("a ray"));
            assert!(rays[0].distance(rays[1]) < 1e-5, "{corner}: {rays:?}");
        }
    }
}
