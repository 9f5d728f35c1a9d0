//! Raw frames of a camera with a sensor.

use crate::native::Native;
use crate::scene::{self, View, block};
use crate::sensor_example;
use bevy::math::{DMat4, DVec4};
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy_terrella::{
    EarthCamera, EarthFault, EarthFrame, EarthSensor, RawFrameTaken, TakeRawFrame,
};
use std::sync::Arc;
use std::time::{Duration, Instant};
use terrella::EyeView;
use terrella_sensor::{
    ASTRONOMICAL_UNIT_M, Detector, Distortion, Lens, PinholeFrame, PinholePicture, Radiometry,
    RawFrame, Sensor, Shutter, Wells,
};

const SIZE: [u32; 2] = [160, 100];
/// Away from the middle, so that nothing is symmetric.
const PRINCIPAL_POINT: [f64; 2] = [70.0, 56.0];
const FOCAL_PX: f64 = 150.0;
/// k1, k2, p1, p2.
const DISTORTION: [f64; 4] = [-0.12, 0.03, 0.004, -0.003];

fn sensor(noise: f64) -> Sensor {
    let mut coefficients = [0.0; 8];
    coefficients[..4].copy_from_slice(&DISTORTION);
    let distortion = Distortion::BrownConrady(coefficients);
    let lens = Lens::new(SIZE, 1.5, 10.0, Some(PRINCIPAL_POINT), distortion);
    let of_the_example = sensor_example::sensor(SIZE).expect("a sensor");
    Sensor {
        lens: lens.expect("a lens"),
        radiometry: Radiometry {
            f_number: 8.0,
            ..of_the_example.radiometry
        },
        detector: Detector {
            full_well_e: 60_000.0,
            blooming: false,
            dark_current_e_s: 0.0,
            dsnu_e: 0.0,
            prnu: 0.0,
            hot_pixel_fraction: 0.0,
            hot_pixel_e_s: 0.0,
            read_noise_e: noise,
            gain_e_dn: 4.0,
            bias_dn: 64.0,
            bits: 14,
        },
        seed: 7,
        ..of_the_example
    }
}

/// Frames delivered by a sensor camera.
#[derive(Resource, Default)]
struct Taken(Vec<RawFrameTaken>);

/// An app with a camera that has this sensor.
fn app(view: &View, sensor: Sensor) -> (App, Entity) {
    let mut app = scene::app(view);
    app.init_resource::<Taken>();
    let camera = EarthSensor::new(sensor);
    let camera = app.world_mut().spawn((camera, view.transform));
    let camera = camera.id();
    app.world_mut()
        .entity_mut(camera)
        .observe(|taken: On<RawFrameTaken>, mut all: ResMut<Taken>| all.0.push(taken.clone()));
    (app, camera)
}

fn take(app: &mut App, camera: Entity, numbers: &[u32]) -> Vec<RawFrameTaken> {
    for &number in numbers {
        let request = TakeRawFrame {
            entity: camera,
            number,
        };
        app.world_mut().trigger(request);
    }
    let begin = Instant::now();
    while app.world().resource::<Taken>().0.len() < numbers.len() {
        assert!(begin.elapsed() < Duration::from_secs(60), "no raw frame");
        app.update();
        std::thread::sleep(Duration::from_millis(2));
    }
    let mut taken = std::mem::take(&mut app.world_mut().resource_mut::<Taken>().0);
    taken.sort_by_key(|taken| taken.number);
    taken
}

fn raw(taken: &RawFrameTaken) -> &(RawFrame, Wells) {
    taken.raw.as_ref().expect("a raw frame")
}

/// The native host's view for a sensor, with f64 matrices.
fn eye(view: &View, frame: &PinholeFrame) -> EyeView {
    let (least, most) = (frame.rect.least, frame.rect.most);
    // Frustum edges at depth 1: right, left, top, bottom.
    let (r, l, t, b) = (most.x, least.x, -least.y, -most.y);
    EyeView {
        clip_from_view: DMat4::from_cols(
            DVec4::new(2.0 / (r - l), 0.0, 0.0, 0.0),
            DVec4::new(0.0, 2.0 / (t - b), 0.0, 0.0),
            DVec4::new((r + l) / (r - l), (t + b) / (t - b), 0.0, -1.0),
            DVec4::new(0.0, 0.0, 0.1, 0.0),
        ),
        ..view.eye((1, 1))
    }
}

#[test]
fn a_raw_frame_is_that_of_the_native_hosts_light() {
    let Some(native) = Native::open() else { return };
    let view = View::station();
    let sensor = sensor(20.0);
    let (mut app, camera) = app(&view, sensor.clone());
    let taken = take(&mut app, camera, &[4, 5]);
    assert_eq!([taken[0].number, taken[1].number], [4, 5]);
    assert_eq!(taken[0].epoch, view.epoch);

    let frame = sensor.pinhole(0..SIZE[1]).expect("a picture");
    let key = (TextureFormat::Rgba16Float, 1);
    let size = frame.size.into();
    let eye = eye(&view, &frame);
    let drawn = native.draw(key, (&eye, &view.sky()), size, view.exposure);
    let light: Vec<[f32; 4]> = drawn
        .bytes
        .chunks_exact(16)
        .map(|pixel| {
            let channel = |i: usize| f32::from_le_bytes(pixel[4 * i..][..4].try_into().unwrap());
            [channel(0), channel(1), channel(2), channel(3)]
        })
        .collect();
    let picture = PinholePicture::new(frame, &light).expect("its size");
    let exposed = sensor.expose(0..SIZE[1], &picture).expect("light");
    let distance_au = view.sky().sun_distance_m / ASTRONOMICAL_UNIT_M;
    let (mut lit, mut least, mut most) = (0, u16::MAX, 0);
    for taken in &taken {
        let (found, wells) = raw(taken);
        let (expected, _) = sensor
            .read_out(&exposed, distance_au, taken.number)
            .expect("a frame");
        assert_eq!([found.width, found.height, found.bits], [160, 100, 14]);
        let apart = found.data.iter().zip(&expected.data);
        let apart = apart
            .filter(|(a, b)| a.abs_diff(**b) > 1 + **b / 256)
            .count();
        eprintln!("{apart} pixels differ by more than 0.4 % and one number");
        assert!(apart * 200 < found.data.len(), "{apart} pixels differ");
        lit += found.data.iter().filter(|&&number| number > 200).count();
        least = least.min(*found.data.iter().min().expect("pixels"));
        most = most.max(*found.data.iter().max().expect("pixels"));
        assert!(wells.electrons.len() == found.data.len());
    }
    assert!(
        lit > 4_000 && least < 64 && most > 1_000,
        "{lit} {least} {most}"
    );
    // Noise differs between frames; light does not.
    assert_ne!(raw(&taken[0]).0.data, raw(&taken[1]).0.data);
}

/// The Brown–Conrady model as in OpenCV's manual.
fn projected(x: f64, y: f64) -> [f64; 2] {
    let [k1, k2, p1, p2] = DISTORTION;
    let s = x * x + y * y;
    let radial = 1.0 + k1 * s + k2 * s * s;
    [
        FOCAL_PX * (x * radial + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x)) + PRINCIPAL_POINT[0],
        FOCAL_PX * (y * radial + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y) + PRINCIPAL_POINT[1],
    ]
}

#[test]
fn meshes_lie_where_the_lens_has_them() {
    let Some(_) = Native::open() else { return };
    // Above the Earth, which is below and invisible: space and three blocks.
    let view = View {
        frame: EarthFrame::default().shifted(bevy::math::DVec3::new(0.0, -4e7, 0.0)),
        transform: Transform::IDENTITY.looking_to(Vec3::NEG_Z, Vec3::Y),
        ..View::station()
    };
    let (mut app, camera) = app(&view, sensor(0.0));
    // x right, y down, both divided by the depth.
    let places = [(0.0, 0.0), (0.45, -0.25), (-0.38, 0.22)];
    for (x, y) in places {
        let at = Vec3::new(x, -y, -1.0) * 20.0;
        block(&mut app, Vec3::new(0.3, 0.3, 0.001), at, Color::WHITE);
    }
    let taken = take(&mut app, camera, &[0]);
    let (found, _) = raw(&taken[0]);
    for (x, y) in places {
        let expected = projected(f64::from(x), f64::from(y));
        let (mut sum, mut moment) = (0.0, [0.0; 2]);
        for row in 0..SIZE[1] {
            for column in 0..SIZE[0] {
                let at = [f64::from(column), f64::from(row)];
                if (at[0] - expected[0]).hypot(at[1] - expected[1]) > 8.0 {
                    continue;
                }
                let number = f64::from(found.data[(row * SIZE[0] + column) as usize]) - 64.0;
                sum += number;
                moment = [moment[0] + number * at[0], moment[1] + number * at[1]];
            }
        }
        let middle = moment.map(|moment| moment / sum);
        assert!(sum > 1_000.0, "{sum} at {expected:?}");
        let off = (middle[0] - expected[0]).hypot(middle[1] - expected[1]);
        assert!(off < 0.05, "{middle:?}, not {expected:?}");
    }
}

#[test]
fn sensors_that_take_no_frame_say_why() {
    let Some(_) = Native::open() else { return };
    let rolling = Shutter::Rolling {
        line_time_s: 1e-5,
        from_below: false,
    };
    let faults = |change: &dyn Fn(&mut Sensor)| {
        let mut sensor = sensor(0.0);
        change(&mut sensor);
        let (mut app, camera) = app(&View::station(), sensor);
        let taken = take(&mut app, camera, &[1]);
        taken[0].raw.clone().map(drop).expect_err("no frame")
    };
    let fault: Arc<EarthFault> = faults(&|sensor| sensor.shutter = rolling);
    assert!(matches!(*fault, EarthFault::RollingShutter));
    let fault = faults(&|sensor| sensor.detector.full_well_e = 0.0).to_string();
    assert!(fault.contains("full_well_e = 0 must be from 1"), "{fault}");
    let fault = faults(&|sensor| {
        sensor.oversampling = 16;
        sensor.lens = Lens::new([16_384, 64], 100.0, 10.0, None, Distortion::NONE).expect("a lens");
    });
    assert!(
        fault.to_string().contains("lower oversampling or size"),
        "{fault}"
    );

    // A corrected sensor takes frames.
    let mut broken = sensor(0.0);
    broken.shutter = rolling;
    let (mut app, camera) = app(&View::station(), broken);
    assert!(take(&mut app, camera, &[1])[0].raw.is_err());
    let mended = EarthSensor::new(sensor(0.0));
    app.world_mut().entity_mut(camera).insert(mended);
    assert!(take(&mut app, camera, &[2])[0].raw.is_ok());
    let world = app.world_mut();
    let cameras = world.query::<&EarthCamera>().iter(world).count();
    assert_eq!(cameras, 1);
}
