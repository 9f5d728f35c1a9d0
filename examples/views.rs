//! Four views of one Earth in a frame: a split screen. Maps, tables and pipelines are there once.
//!
//! `cargo run --release --example views` writes `out/views.ppm`. Another thread brings its clouds.

use std::error::Error;
use terrella::frames::{Ellipsoid, Epoch, Geodetic};
use terrella::glam::DVec3;
use terrella::{
    Earth, EarthOptions, EyeView, FrameRequest, FrameTargets, GpuMap, LayerSelection, MapLayer,
    Shading, Sky, ViewFrame, Viewport, find_textures, load_layers, wgpu,
};

/// Width and height of the picture, pixels.
pub const SIZE: (u32, u32) = (960, 540);

fn main() -> Result<(), Box<dyn Error>> {
    let rgba = pollster::block_on(draw())?;
    let mut ppm = format!("P6 {} {} 255\n", SIZE.0, SIZE.1).into_bytes();
    ppm.extend(rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]));
    std::fs::create_dir_all("out")?;
    Ok(std::fs::write("out/views.ppm", ppm)?)
}

/// An eye above a place that looks so far above the horizontal, to the north.
fn eye(lat_deg: f64, lon_deg: f64, height_m: f64, pitch_deg: f64, fov_deg: f64) -> EyeView {
    let place = Geodetic::from_degrees(lat_deg, lon_deg, height_m);
    let eye_itrf_m = Ellipsoid::WGS84.itrf_from_geodetic(place);
    let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let (sin, cos) = pitch_deg.to_radians().sin_cos();
    let north = (DVec3::Z - up * up.z).normalize();
    let (forward, upwards) = (north * cos + up * sin, up * cos - north * sin);
    EyeView::itrf(
        eye_itrf_m,
        forward,
        upwards,
        fov_deg.to_radians(),
        16.0 / 9.0,
    )
}

/// Draws the space station's view, the whole disc, a telescope's, and the limb; four bytes a pixel (RGBA), sRGB.
pub async fn draw() -> Result<Vec<u8>, Box<dyn Error>> {
    let instance =
        wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = instance.request_adapter(&Default::default()).await?;
    let (device, queue) = adapter.request_device(&Default::default()).await?;

    let layers = load_layers(&find_textures()?, LayerSelection::default())?;
    let clouds = layers.clouds.clone();
    let mut earth = Earth::new(&device, &queue, &EarthOptions::new(layers))?;
    let mut views = [earth.new_view()?, earth.new_view()?, earth.new_view()?];

    // Another thread uploads a map; the frame that takes it waits for nothing.
    let of_thread = (device.clone(), queue.clone());
    let uploading = std::thread::spawn(move || {
        let (device, queue) = of_thread;
        let upload = |map| GpuMap::upload(&device, &queue, MapLayer::Clouds, &map, Shading::Sunlit);
        clouds.map(upload).transpose()
    });
    if let Some(map) = uploading.join().map_err(|_| "the thread panicked")?? {
        earth.set_map(&queue, &map)?;
    }

    let sky = Sky::at(Epoch::from_gregorian_utc(2018, 6, 21, 9, 0, 0, 0));
    let eyes = [
        eye(30.0, 18.0, 4.2e5, -24.0, 60.0),
        eye(15.0, 30.0, 2.2e7, -90.0, 32.0),
        eye(29.5, 33.0, 2e6, -90.0, 25.0),
        eye(-20.0, 50.0, 1.2e6, -31.0, 20.0),
    ];
    let half = (SIZE.0 / 2, SIZE.1 / 2);
    let corners = [(0, 0), (half.0, 0), (0, half.1), half];
    let targets = corners.map(|(x, y)| Viewport {
        origin: (x as f32, y as f32),
        size: half,
    });

    let mut frames: Vec<_> = views
        .iter_mut()
        .zip(eyes.iter().zip(targets).skip(1))
        .map(|(view, (eye, target))| ViewFrame {
            view,
            eye,
            sky: &sky,
            target,
        })
        .collect();
    let request = FrameRequest::new(&eyes[0], &sky, targets[0]).with_views(&mut frames);
    earth.prepare(&queue, request);

    let pictures = FrameTargets::new(&device, SIZE, 1);
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = pictures.begin_pass(&mut encoder);
        let set = |target: Viewport, pass: &mut wgpu::RenderPass<'_>| {
            let ((x, y), (width, height)) = (target.origin, target.size);
            pass.set_viewport(x, y, width as f32, height as f32, 0.0, 1.0);
        };
        set(targets[0], &mut pass);
        earth.render(&mut pass);
        for (view, target) in views.iter().zip(&targets[1..]) {
            set(*target, &mut pass);
            earth.render_view(view, &mut pass);
        }
    }
    queue.submit([encoder.finish()]);
    Ok(pictures.read_back(&device, &queue)?)
}
