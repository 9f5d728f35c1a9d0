//! The smallest whole host: opens a device, draws the Earth into a picture of its own, writes it.
//!
//! `cargo run --release --example minimal` writes `out/minimal.ppm`. Of the library it needs no feature, of wgpu one backend.

use std::error::Error;
use terrella::frames::{Ellipsoid, Epoch, Geodetic};
use terrella::glam::DVec3;
use terrella::{Earth, EarthOptions, EyeView, FrameRequest, FrameTargets, LayerSelection, Sky};
use terrella::{find_textures, load_layers, wgpu};

/// Width and height of the picture, pixels.
pub const SIZE: (u32, u32) = (960, 540);

fn main() -> Result<(), Box<dyn Error>> {
    let rgba = pollster::block_on(draw())?;
    let mut ppm = format!("P6 {} {} 255\n", SIZE.0, SIZE.1).into_bytes();
    ppm.extend(rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]));
    std::fs::create_dir_all("out")?;
    Ok(std::fs::write("out/minimal.ppm", ppm)?)
}

/// Draws Africa on a summer's day; four bytes a pixel (RGBA), sRGB.
pub async fn draw() -> Result<Vec<u8>, Box<dyn Error>> {
    let instance =
        wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = instance.request_adapter(&Default::default()).await?;
    let (device, queue) = adapter.request_device(&Default::default()).await?;

    let layers = load_layers(&find_textures()?, LayerSelection::default())?;
    let mut earth = Earth::new(&device, &queue, &EarthOptions::new(layers))?;

    let place = Geodetic::from_degrees(15.0, 20.0, 1.2e7);
    let eye_itrf_m = Ellipsoid::WGS84.itrf_from_geodetic(place);
    let (fov_rad, aspect) = (0.9, f64::from(SIZE.0) / f64::from(SIZE.1));
    let down = -eye_itrf_m.normalize();
    let view = EyeView::itrf(eye_itrf_m, down, DVec3::Z, fov_rad, aspect);
    let sky = Sky::at(Epoch::from_gregorian_utc(2018, 6, 21, 9, 0, 0, 0));
    earth.prepare(&queue, FrameRequest::new(&view, &sky, SIZE));

    let targets = FrameTargets::new(&device, SIZE, 1);
    let mut encoder = device.create_command_encoder(&Default::default());
    earth.render(&mut targets.begin_pass(&mut encoder));
    queue.submit([encoder.finish()]);
    Ok(targets.read_back(&device, &queue)?)
}
