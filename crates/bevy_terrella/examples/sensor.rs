//! A raw frame of a camera 420 km over Egypt, as a 16-bit PNG, without a window. It needs the feature `sensor`.
//!
//! ```sh
//! cargo run --example sensor --features sensor -- raw.png
//! ```

#[path = "../tests/render/headless.rs"]
pub mod headless;

use bevy::prelude::*;
use bevy_terrella::prelude::*;
use bevy_terrella::terrella_sensor::{
    Detector, Distortion, Lens, Mosaic, Psf, Radiometry, RawFrame, Sensor, SensorError, Shutter,
};
use std::error::Error;
use std::fs::File;
use std::time::Duration;

/// Result of the sensor.
#[derive(Resource)]
struct Taken(RawFrameTaken);

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("name the PNG to write")?;
    let frame = frame(sensor([640, 480])?)?;
    let mut encoder = png::Encoder::new(File::create(path)?, frame.width, frame.height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let bytes: Vec<u8> = frame.data.iter().flat_map(|n| n.to_be_bytes()).collect();
    Ok(encoder.write_header()?.write_image_data(&bytes)?)
}

/// The pixels of the CMV4000 detector in config/navcam.toml, behind a lens whose field of view is independent of the number of rows.
pub fn sensor(size: [u32; 2]) -> Result<Sensor, SensorError> {
    let focal_length_mm = 50.0 * f64::from(size[1]) / 2048.0;
    let distortion = Distortion::BrownConrady([-0.08, 0.01, 0.0002, -0.0001, 0.0, 0.0, 0.0, 0.0]);
    Ok(Sensor {
        lens: Lens::new(size, focal_length_mm, 5.5, None, distortion)?,
        psf: Psf::Gaussian { sigma_px: 0.6 },
        oversampling: 3,
        radiometry: Radiometry {
            f_number: 5.6,
            exposure_s: 1e-4,
            transmission: 0.9,
            bands_nm: [[600.0, 700.0], [500.0, 600.0], [400.0, 500.0]],
            quantum_efficiency: [0.5, 0.6, 0.45],
            cos4: true,
            vignetting: [0.0; 3],
        },
        detector: Detector {
            full_well_e: 13_500.0,
            blooming: false,
            dark_current_e_s: 125.0,
            dsnu_e: 0.0,
            prnu: 0.01,
            hot_pixel_fraction: 0.0,
            hot_pixel_e_s: 0.0,
            read_noise_e: 13.0,
            gain_e_dn: 3.3,
            bias_dn: 64.0,
            bits: 12,
        },
        mosaic: Mosaic::Mono,
        shutter: Shutter::Global,
        seed: 1,
    })
}

fn take_frame(In(sensor): In<Sensor>, mut commands: Commands) {
    let camera = commands
        .spawn((
            EarthSensor::new(sensor),
            Transform::default().looking_to(Vec3::new(0.0, -0.4, -1.0), Vec3::Y),
        ))
        .observe(|taken: On<RawFrameTaken>, mut commands: Commands| {
            commands.insert_resource(Taken(taken.clone()));
        })
        .id();
    commands.trigger(TakeRawFrame {
        entity: camera,
        number: 0,
    });
}

/// Takes one frame with a sensor.
pub fn frame(sensor: Sensor) -> Result<RawFrame, Box<dyn Error>> {
    let mut app = headless::app();
    app.add_plugins(TerrellaPlugin)
        .insert_resource(ClearColor(Color::BLACK));
    headless::start(&mut app);
    let place = Geodetic::from_degrees(28.0, 30.0, 420_000.0);
    let mut earth = Earth::default();
    // A measurement must show only the maps' contents.
    earth.light.detail = false;
    app.world_mut().spawn((
        earth,
        EarthFrame::local(place),
        EarthEpoch(Epoch::from_gregorian_utc(2018, 6, 21, 9, 0, 0, 0)),
    ));
    app.world_mut().run_system_cached_with(take_frame, sensor)?;
    for _ in 0..30_000 {
        app.update();
        if let Some(Taken(taken)) = app.world_mut().remove_resource::<Taken>() {
            return Ok(taken.raw?.0);
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    Err("no frame came within a minute".into())
}
