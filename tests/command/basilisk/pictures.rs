//! Pictures, films and files of simulations.

use super::free_port;
use super::messages;
use super::{Simulator, scene};
use crate::{Place, frame_names};
use glam::{DMat3, DQuat, DVec3};
use image::{DynamicImage, RgbImage};
use std::net::SocketAddr;
use terrella::frames::{Ellipsoid, Geodetic, itrf_from_gcrf};
use terrella_orbit::basilisk::Endpoint;
use terrella_play::scene::Scene;
use terrella_play::{Flight, OffscreenRenderer, Progress, ServeRequest, ViewRequest, serve};

const SIZE: (u32, u32) = (192, 128);
const WIDE: [u64; 2] = [SIZE.0 as u64, SIZE.1 as u64];
const FOV_DEG: f64 = 35.0;
const HEIGHT_M: f64 = 12e6;

struct Silent;

impl Progress for Silent {
    fn begin(&self, _what: &str, _steps: Option<u64>) {}
    fn step(&self) {}
    fn cancelled(&self) -> bool {
        false
    }
    fn end(&self) {}
}

fn numbers_of(number: u64, matrix: DMat3) -> Vec<u8> {
    messages::numbers(number, &matrix.transpose().to_cols_array())
}

/// A camera that looks straight down from above 20° N, 15° E, north upwards, on the Earth of the date: as Basilisk would write it.
fn message(cameras: &[Vec<u8>]) -> Vec<u8> {
    let epoch = "2026-03-20T14:46:10Z".parse().expect("a date");
    let rotation = itrf_from_gcrf(epoch);
    let place = Geodetic::from_degrees(20.0, 15.0, HEIGHT_M);
    let at_m = rotation.transpose() * Ellipsoid::WGS84.itrf_from_geodetic(place);
    let down = -Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let east = DVec3::Z.cross(-down).normalize();
    let south = down.cross(east);
    // Body axes: x east, y south, z down; σ = q_v/(1 + q_w).
    let inertial_from_body = rotation.transpose() * DMat3::from_cols(east, south, down);
    let q = DQuat::from_mat3(&inertial_from_body);
    let mrp = q.xyz() / (1.0 + q.w);
    let origin_m = DVec3::new(1.4e11, -3e10, 2e9);
    let earth = [
        messages::bytes(1, b"earth"),
        messages::numbers(2, &origin_m.to_array()),
        numbers_of(4, rotation),
    ];
    messages::message(
        1,
        10.0,
        &[
            messages::bytes(2, &earth.concat()),
            messages::craft(
                "sat",
                (origin_m + at_m).to_array(),
                [0.0; 3],
                mrp.to_array(),
            ),
            cameras.concat(),
            messages::epoch(),
        ],
    )
}

/// Replies of the service for a scene with these additional tables to requests for these cameras.
fn answers(tables: &str, cameras: &[(u64, Vec<u8>)]) -> Vec<DynamicImage> {
    let text = scene(
        "listen = \"tcp://127.0.0.1:0\"\ntimeout_s = 120",
        "mode = \"chase\"",
    );
    let scene = Scene::from_toml(&format!("{text}{tables}"), "test.toml".as_ref());
    let flight = Flight::open(scene.expect("a good scene")).expect("opens");
    let Endpoint::Tcp(address) = *flight.simulation().expect("a simulation").endpoint() else {
        panic!("no address");
    };
    let parts = cameras.iter().map(|(_, camera)| camera.clone());
    let update = message(&parts.collect::<Vec<_>>());
    let ids: Vec<_> = cameras.iter().map(|(id, _)| *id).collect();
    let simulator = std::thread::spawn(move || {
        let mut simulator = Simulator::connect(address);
        assert!(simulator.update(&update));
        let ask = |id: &u64| {
            let request = format!("REQUEST_IMAGE_{id}");
            simulator.ask(&[request.as_bytes()]).expect("an answer")
        };
        ids.iter().map(ask).collect::<Vec<_>>()
    });
    let request = ServeRequest {
        once: true,
        ..ServeRequest::default()
    };
    let counters = serve(&flight, &request, &Silent, |_| ()).expect("serves");
    let wanted = (cameras.len() as u64, 0);
    assert_eq!((counters.pictures, counters.no_pictures), wanted);
    let answers = simulator.join().expect("no panic");
    let pictures = answers.iter().map(|answer| {
        let picture = image::load_from_memory(&answer[1]).expect("a picture");
        assert_eq!((picture.width(), picture.height()), SIZE);
        picture
    });
    pictures.collect()
}

/// The reply for one camera without a sensor.
fn asked(mode: u64) -> RgbImage {
    let camera = messages::camera(3, "sat", FOV_DEG, WIDE, mode);
    answers("", &[(3, camera)]).remove(0).into_rgb8()
}

/// Mean difference of two pictures, steps of 8 bits.
fn difference(a: &RgbImage, b: &RgbImage) -> f64 {
    let pairs = a.as_raw().iter().zip(b.as_raw());
    let sum: f64 = pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    sum / a.as_raw().len() as f64
}

#[test]
fn a_camera_sees_what_one_sees_from_there() {
    let seen = asked(0);
    let text = "[time]\nstart = \"2026-03-20T14:46:10Z\"\n[camera]\nmode = \"geodetic\"\nlat_deg = 20\nlon_deg = 15\nheight_km = 12000\n\
                fov_deg = 35\n[earth]\nnormals = false\nnight_lights = false\nseasons = false\n[sky]\nstars = false\n[output]\nsamples = 1\n";
    let scene = Scene::from_toml(text, "test.toml".as_ref()).expect("a good scene");
    let flight = Flight::open(scene).expect("opens");
    let gpu = pollster::block_on(terrella::internals::gpu::GpuContext::open(None));
    let gpu = gpu.expect("an adapter");
    let options = flight.earth_options(gpu.bc_support()).expect("maps");
    let mut renderer = OffscreenRenderer::open(gpu, options, SIZE).expect("opens");
    renderer.show_sky(&flight).expect("a sky");
    let request = ViewRequest {
        mode: flight.scene().camera.mode,
        look: Default::default(),
        aspect: renderer.aspect(),
    };
    let moment = flight
        .view_at(flight.scene().time.start, &request)
        .expect("a moment");
    renderer.draw(&moment);
    let there = image::DynamicImage::from(renderer.read().expect("reads")).into_rgb8();
    let off = difference(&seen, &there);
    assert!(off < 0.5, "{off}");
    // Mirrored or turned it would be seen.
    for other in [
        image::imageops::flip_horizontal(&there),
        image::imageops::flip_vertical(&there),
        image::imageops::rotate180(&there),
    ] {
        let off = difference(&seen, &other);
        assert!(off > 5.0, "{off}");
    }
}

/// The scene's sensor applies to the simulation's cameras: with their size, field of view, focal length and f-number.
#[test]
fn a_sensor_makes_the_pictures_of_cameras() {
    let sensor = "[sensor]\nsize = [8, 8]\nfocal_length_mm = 20\npixel_pitch_um = 5\nf_number = 4\nexposure_s = 4e-7\nfull_well_e = 40000\n\
                  bits = 12\noversampling = 1\ndistortion = [0.5, 0, 0, 0]\n";
    // ppAperture and ppFocalLength of half a lens: as many electrons fall on a pixel of half the pitch as through half the f-number.
    let small = [messages::number(13, 8.0), messages::number(14, 10.0)].concat();
    let cameras = [
        (3, messages::camera(3, "sat", FOV_DEG, WIDE, 0)),
        (4, messages::camera_with(4, "sat", FOV_DEG, WIDE, &small)),
    ];
    let pictures: [_; 2] = answers(sensor, &cameras).try_into().expect("two");
    let [bright, dim] = pictures.each_ref().map(|picture| {
        let DynamicImage::ImageLuma8(gray) = picture else {
            panic!("{:?}", picture.color());
        };
        assert!(gray.pixels().all(|pixel| pixel[0] < 255), "not full");
        gray
    });
    // Numbers are rounded down.
    let sums = bright.pixels().zip(dim.pixels()).filter(|(a, _)| a[0] > 64);
    let (sum, other) = sums.fold((0.0, 0.0), |(sum, other), (a, b)| {
        (sum + f64::from(a[0]) + 0.5, other + f64::from(b[0]) + 0.5)
    });
    // (8/4)² of the aperture, (20/10)² of the pixel's area.
    assert!((sum / other / 16.0 - 1.0).abs() < 0.03, "{sum} {other}");
    // The lit limb in the west: r (1 + k1 r²) from the middle.
    let first = (0..SIZE.0).find(|x| bright.get_pixel(*x, 64)[0] > 20);
    let radius_m = 6.3745e6;
    let r = f64::asin(radius_m / (radius_m + HEIGHT_M)).tan();
    let focal_px = 64.0 / (FOV_DEG / 2.0).to_radians().tan();
    let wanted = 96.0 - focal_px * r * (1.0 + 0.5 * r * r);
    let first = first.map(f64::from).expect("a limb");
    assert!((first - wanted).abs() < 2.0, "{first} {wanted}");
}

#[test]
fn a_depth_map_has_the_disc_where_geometry_has_it() {
    let map = asked(1);
    let depth_m = |x: u32, y: u32| {
        let [red, green, blue] = map.get_pixel(x, y).0.map(f64::from);
        1e8 * (red / 255.0 + green / 255.0_f64.powi(2) + blue / 255.0_f64.powi(3))
    };
    // Half a pixel off the middle, 12 000 km down.
    let middle_m = depth_m(96, 64);
    assert!((middle_m - HEIGHT_M).abs() < 2000.0, "{middle_m}");
    let is_ground = |x: u32| map.get_pixel(x, 64).0 != [255; 3];
    let across = (0..SIZE.0).filter(|x| is_ground(*x)).count() as f64;
    // sin of the limb's angle R/(R + h); its tangent over that of half the field of view, of 64 pixels.
    let radius_m = 6.3745e6;
    let angle = f64::asin(radius_m / (radius_m + HEIGHT_M));
    let wide = (angle.tan() / (FOV_DEG / 2.0).to_radians().tan() * 128.0).min(f64::from(SIZE.0));
    assert!((across - wide).abs() < 2.0, "{across} of {wide}");
}

#[test]
fn a_film_has_one_frame_for_each_step_and_its_simulator_goes_on() {
    let place = Place::new();
    let port = free_port();
    let listen =
        format!("listen = \"tcp://127.0.0.1:{port}\"\ntimeout_s = 60\ntrail = true\nmarker = true");
    place.scene("basilisk.toml", &scene(&listen, "mode = \"nadir\""));
    let player = place
        .command(&["play", "basilisk.toml", "--frames", "frames"])
        .spawn()
        .expect("starts");
    let address = SocketAddr::from(([127, 0, 0, 1], port));
    let mut simulator = Simulator::connect(address);
    for frame in 1..=5 {
        // Over the day side, where one place is unlike another.
        let elapsed_s = 2200.0 + 300.0 * frame as f64;
        assert!(simulator.update(&messages::step(frame, elapsed_s)));
        // Its camera is answered in the same flight.
        let answer = simulator.ask(&[b"REQUEST_IMAGE_1"]).expect("an answer");
        let picture = image::load_from_memory(&answer[1]).expect("a picture");
        assert_eq!((picture.width(), picture.height()), (96, 64));
    }
    // It disconnects: the film is completed immediately.
    drop(simulator);
    let output = player.wait_with_output().expect("ends");
    assert!(output.status.success());
    let files = frame_names(&place.path("frames"));
    assert_eq!(files.len(), 5, "{files:?}");
    let bytes = |name: &String| std::fs::read(place.path("frames").join(name)).expect("reads");
    let pictures: std::collections::BTreeSet<_> = files.iter().map(bytes).collect();
    assert_eq!(pictures.len(), 5, "two frames are the same");
}

/// A scene without a duration has the simulation's: no step is left out, and no peer is left waiting.
#[test]
fn a_film_without_a_duration_is_as_long_as_the_simulation() {
    const STEPS: u64 = 12;
    let place = Place::new();
    let port = free_port();
    let listen = format!("listen = \"tcp://127.0.0.1:{port}\"\ntimeout_s = 60");
    let film = |name: &str, text: &str| {
        place.scene("basilisk.toml", text);
        let player = place
            .command(&["play", "basilisk.toml", "--frames", name])
            .spawn()
            .expect("starts");
        let mut simulator = Simulator::connect(SocketAddr::from(([127, 0, 0, 1], port)));
        let answered = (1..=STEPS)
            .take_while(|frame| simulator.update(&messages::step(*frame, 10.0 * *frame as f64)))
            .count();
        drop(simulator);
        assert!(player.wait_with_output().expect("ends").status.success());
        (answered as u64, frame_names(&place.path(name)).len() as u64)
    };
    // 5580 s by default; at this speed that would be three frames.
    let text = scene(&listen, "mode = \"nadir\"").replace("speed = 10\n", "speed = 18600\n");
    assert_eq!(
        film("open", &text.replace("duration_s = 1000\n", "")),
        (STEPS, STEPS)
    );
    let (_, frames) = film("given", &text.replace("= 1000\n", "= 5580\n"));
    assert_eq!(frames, 3);
}

#[test]
fn a_saved_simulation_is_played_by_its_own_time() {
    let place = Place::new();
    let steps: Vec<_> = (1..=40)
        .map(|n| messages::step(n, 30.0 * n as f64))
        .collect();
    let file = messages::file(&steps);
    std::fs::write(place.path("flight.bin"), &file).expect("writes");
    let text = scene("file = \"flight.bin\"\ntrail = true", "mode = \"chase\"");
    let text = text
        .replace("duration_s = 1000\n", "")
        .replace("wait_s = 5\n", "");
    place.scene("saved.toml", &text.replace("speed = 10\n", "speed = 100\n"));
    place.succeed(&["play", "saved.toml", "--frames", "frames"]);
    // 1170 s at a hundred times real time, ten frames a second.
    assert_eq!(frame_names(&place.path("frames")).len(), 117);
    place.succeed(&[
        "frame",
        "saved.toml",
        "-o",
        "a.png",
        "--at",
        "2026-03-20T14:56:00Z",
    ]);
    let late = place.fail(
        2,
        &[
            "frame",
            "saved.toml",
            "-o",
            "b.png",
            "--at",
            "2027-01-01T00:00:00Z",
        ],
    );
    assert!(late.contains("2026-03-20T15:06:00"), "{late}");
    // Corrupt from the middle on.
    let cut = file.len() / 2;
    std::fs::write(place.path("flight.bin"), &file[..cut]).expect("writes");
    let output = place.succeed(&["frame", "saved.toml", "-o", "c.png"]);
    assert!(
        crate::words(&output).contains("corrupt from byte"),
        "{}",
        crate::words(&output)
    );
    std::fs::write(place.path("flight.bin"), b"no simulation").expect("writes");
    let rejected = place.fail(2, &["frame", "saved.toml", "-o", "d.png"]);
    assert!(
        rejected.contains("[orbit] file") && rejected.contains("saveFile"),
        "{rejected}"
    );
}
