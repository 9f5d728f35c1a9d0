//! The Earth with stars, Moon and a satellite: the order in which a host draws them.
//!
//! `cargo run --release --example orbit --features celestial,tracks` writes `out/orbit.ppm`.

use std::error::Error;
use std::path::Path;
use terrella::celestial::{Celestial, CelestialMoment, CelestialOptions, CelestialSelection};
use terrella::frames::{Ellipsoid, Epoch, Geodetic};
use terrella::glam::DVec3;
use terrella::orbit::{Catalogue, Feed};
use terrella::tracks::{TrackMoment, TrackSpan, TrackStyle, Tracks, TracksOptions};
use terrella::{Earth, EarthOptions, EyeView, FrameRequest, FrameTargets, LayerSelection, Sky};
use terrella::{find_textures, load_layers, wgpu};

/// Width and height of the picture, pixels.
pub const SIZE: (u32, u32) = (960, 540);

/// Orbital elements of the space station, January 2018.
const ELEMENTS: &str = "ISS (ZARYA)
1 25544U 98067A   18020.89808844  .00002078  00000-0  38550-4 0  9992
2 25544  51.6424  32.9776 0003646  28.7227  39.5332 15.54190080 95614
";

fn main() -> Result<(), Box<dyn Error>> {
    let rgba = pollster::block_on(draw())?;
    let mut ppm = format!("P6 {} {} 255\n", SIZE.0, SIZE.1).into_bytes();
    ppm.extend(rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]));
    std::fs::create_dir_all("out")?;
    Ok(std::fs::write("out/orbit.ppm", ppm)?)
}

/// Draws the station's orbit over Africa and Europe by night, in front of the stars; four bytes a pixel (RGBA), sRGB.
pub async fn draw() -> Result<Vec<u8>, Box<dyn Error>> {
    let instance =
        wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = instance.request_adapter(&Default::default()).await?;
    let (device, queue) = adapter.request_device(&Default::default()).await?;

    let folder = find_textures()?;
    let layers = load_layers(&folder, LayerSelection::default())?;
    let mut earth = Earth::new(&device, &queue, &EarthOptions::new(layers))?;
    let sky_options = CelestialOptions::load(&*folder, CelestialSelection::default())?;
    let mut celestial = Celestial::new(&device, &queue, &earth, &sky_options)?;

    let satellites = Catalogue::from_text(ELEMENTS, Path::new("iss.tle"), false)?.feeds;
    let style = TrackStyle {
        trail: Some(TrackSpan::TRAIL),
        marker: true,
        ..TrackStyle::new(0)
    };
    let mut tracks = Tracks::new(&device, &TracksOptions::of(&earth), &[style])?;

    let place = Geodetic::from_degrees(30.0, 10.0, 7e6);
    let eye_itrf_m = Ellipsoid::WGS84.itrf_from_geodetic(place);
    let (fov_rad, aspect) = (1.2, f64::from(SIZE.0) / f64::from(SIZE.1));
    let view = EyeView::itrf(eye_itrf_m, -eye_itrf_m, DVec3::Z, fov_rad, aspect);
    let epoch = Epoch::from_gregorian_utc(2018, 1, 20, 23, 20, 0, 0);

    // Each frame: the Earth first, then what is seen with it, for the same view.
    let sky = Sky::at(epoch);
    earth.prepare(&queue, FrameRequest::new(&view, &sky, SIZE));
    celestial.prepare(&queue, &earth, &CelestialMoment::new(epoch, &view, SIZE));
    let feeds = satellites.iter().map(|feed| feed as &dyn Feed);
    tracks.prepare_complete(&queue, &TrackMoment::new(epoch, &view, SIZE), feeds);

    let targets = FrameTargets::new(&device, SIZE, 1);
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = targets.begin_pass(&mut encoder);
        earth.render_surface(&mut pass);
        earth.render_air(&mut pass);
        celestial.render(&mut pass);
        earth.render_clouds_overhead(&mut pass);
        tracks.render(&mut pass);
    }
    queue.submit([encoder.finish()]);
    Ok(targets.read_back(&device, &queue)?)
}
