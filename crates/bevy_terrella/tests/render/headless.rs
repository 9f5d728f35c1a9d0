//! Apps without a window that draw into memory.

use bevy::app::{App, Plugins, PluginsState};
use bevy::asset::{Assets, Handle};
use bevy::camera::RenderTarget;
use bevy::image::Image;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::gpu_readback::{Readback, ReadbackComplete};
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{TextureFormat, TextureUsages};
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use bevy_terrella::{EarthCamera, EarthCameraStatus, EarthClock};
use std::error::Error;
use std::time::{Duration, Instant};

/// Eight bits per channel, encoded.
pub const SRGB: TextureFormat = TextureFormat::Rgba8UnormSrgb;

/// Maximum wait for an image.
const PATIENCE: Duration = Duration::from_secs(60);

/// An image in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// Contiguous rows without padding, as the target stores them.
    pub bytes: Vec<u8>,
}

impl Picture {
    /// Writes an 8-bit image as an opaque PNG.
    pub fn save(&self, path: impl AsRef<std::path::Path>) -> Result<(), Box<dyn Error>> {
        let file = std::io::BufWriter::new(std::fs::File::create(path)?);
        let mut encoder = png::Encoder::new(file, self.size.0, self.size.1);
        encoder.set_color(png::ColorType::Rgb);
        let rgb = self.bytes.chunks_exact(4).flat_map(|pixel| &pixel[..3]);
        let rgb: Vec<u8> = rgb.copied().collect();
        Ok(encoder.write_header()?.write_image_data(&rgb)?)
    }
}

/// Bevy with all drawing plugins, but without a window or a render thread: after `update` the frame is submitted. Pipelines are
/// compiled synchronously, so no later frame has to wait for them.
pub fn app() -> App {
    app_with_assets(AssetPlugin::default())
}

/// The same with another asset folder.
pub fn app_with_assets(assets: AssetPlugin) -> App {
    let mut app = App::new();
    let window = WindowPlugin {
        primary_window: None,
        exit_condition: ExitCondition::DontExit,
        ..default()
    };
    let render = RenderPlugin {
        synchronous_pipeline_compilation: true,
        ..default()
    };
    app.add_plugins(
        DefaultPlugins
            .set(window)
            .set(render)
            .set(assets)
            .disable::<WinitPlugin>()
            .disable::<PipelinedRenderingPlugin>(),
    );
    app
}

/// Finishes the setup that `App::run` does before the first frame.
pub fn start(app: &mut App) {
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
}

/// A texture to draw to and read back.
pub fn target(app: &mut App, (width, height): (u32, u32), format: TextureFormat) -> Handle<Image> {
    let mut image = Image::new_target_texture(width, height, format, None);
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    app.world_mut().resource_mut::<Assets<Image>>().add(image)
}

/// Result of the last readback.
#[derive(Resource)]
struct Read(Vec<u8>);

/// Runs frames until all cameras see the Earth, then one more, and reads that back.
pub fn draw(app: &mut App, image: &Handle<Image>) -> Result<Picture, Box<dyn Error>> {
    wait(app, |status| status.is_drawn())?;
    read(app, image)
}

/// Runs frames until the condition is true for all cameras.
pub fn wait(
    app: &mut App,
    holds: impl Fn(&EarthCameraStatus) -> bool,
) -> Result<(), Box<dyn Error>> {
    let begin = Instant::now();
    // The status of a frame is known two frames later.
    app.update();
    app.update();
    loop {
        let mut cameras = app.world_mut().query::<&EarthCameraStatus>();
        let world = app.world();
        if cameras.iter(world).all(&holds) {
            return Ok(());
        }
        if begin.elapsed() > PATIENCE {
            let found: Vec<_> = cameras.iter(world).collect();
            return Err(format!("after {PATIENCE:?} it does not hold: {found:?}").into());
        }
        app.update();
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// One image of an app's only camera, at the first instant of its only clock, `frames` frames after the Earth is ready.
pub fn still<M>(
    fly: impl Plugins<M>,
    size: (u32, u32),
    frames: u32,
) -> Result<Picture, Box<dyn Error>> {
    let mut app = app();
    app.add_plugins(fly);
    start(&mut app);
    app.update();
    let mut clocks = app.world_mut().query::<&mut EarthClock>();
    clocks.single_mut(app.world_mut())?.rate = 0.0;
    let image = target(&mut app, size, SRGB);
    let mut cameras = app
        .world_mut()
        .query_filtered::<Entity, With<EarthCamera>>();
    let camera = cameras.single(app.world())?;
    app.world_mut()
        .entity_mut(camera)
        .insert(RenderTarget::Image(image.clone().into()));
    wait(&mut app, EarthCameraStatus::is_drawn)?;
    for _ in 0..frames {
        app.update();
    }
    draw(&mut app, &image)
}

/// Draws a frame and reads it back.
pub fn read(app: &mut App, image: &Handle<Image>) -> Result<Picture, Box<dyn Error>> {
    let begin = Instant::now();
    app.world_mut().remove_resource::<Read>();
    let reader = app.world_mut().spawn(Readback::texture(image.clone()));
    let reader = reader.id();
    app.world_mut().entity_mut(reader).observe(
        |done: On<ReadbackComplete>, mut commands: Commands| {
            commands.insert_resource(Read(done.data.clone()));
        },
    );
    while !app.world().contains_resource::<Read>() {
        if begin.elapsed() > PATIENCE {
            return Err(format!("no picture came within {PATIENCE:?}").into());
        }
        app.update();
    }
    app.world_mut().despawn(reader);
    let read = app.world_mut().remove_resource::<Read>();
    let read = read.ok_or("the picture is gone")?.0;
    let images = app.world().resource::<Assets<Image>>();
    let image = images.get(image).ok_or("the target is gone")?;
    let size = image.size();
    // Rows may be padded to 256 bytes.
    let row = read.len() / size.y as usize;
    let texel = image.texture_descriptor.format.block_copy_size(None);
    let texel = texel.ok_or("a format of blocks")? as usize;
    let rows = read
        .chunks_exact(row)
        .flat_map(|row| &row[..texel * size.x as usize]);
    Ok(Picture {
        size: (size.x, size.y),
        bytes: rows.copied().collect(),
    })
}
