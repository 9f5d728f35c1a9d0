//! Frame cost of the Earth in Bevy, compared with a wgpu program that draws the same view at the same size and sample count.
//!
//! ```sh
//! cargo bench --bench frame               # 60 rounds of 1280 × 720
//! cargo bench --bench frame -- 20 640 360
//! ```
//!
//! A round draws five frames of each of four kinds: Bevy with and without the Earth, and the program with and without it (its pass
//! cleared). The Earth's cost is the difference of the medians with and without it. A round's ratio is Bevy's cost divided by the
//! program's. The benchmark waits for every frame, changes its epoch and computes its sky.

#[path = "../tests/render/headless.rs"]
#[allow(dead_code)]
mod headless;
#[path = "../tests/render/native.rs"]
#[allow(dead_code)]
mod native;
#[path = "../tests/render/scene.rs"]
#[allow(dead_code)]
mod scene;

use bevy::prelude::*;
use bevy::render::render_resource::PollType;
use bevy::render::renderer::RenderDevice;
use bevy_terrella::{Earth, EarthCamera, EarthClock};
use native::Native;
use scene::View;
use std::error::Error;
use std::time::Instant;
use terrella::frames::Duration;
use terrella::{EarthLayers, EarthOptions, FrameRequest, FrameTargets, Sky, wgpu};

/// Frames of a kind in a round, after an uncounted one.
const FRAMES: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo adds a flag.
    let numbers = std::env::args().skip(1).filter(|a| a != "--bench");
    let numbers: Vec<u32> = numbers.map(|a| a.parse()).collect::<Result<_, _>>()?;
    let rounds = numbers.first().copied().unwrap_or(60).max(1);
    let size = match numbers[..] {
        [_, width, height] => (width, height),
        _ => (1280, 720),
    };
    let Some(native) = Native::open() else {
        return Ok(());
    };
    let view = View::station();
    let mut bevy = InBevy::new(&view, size)?;
    let mut host = Host::new(native, &view, size)?;
    let mut found: [Vec<f64>; 4] = Default::default();
    let mut ratios = Vec::new();
    for _ in 0..rounds {
        let round = [
            bevy.frames(true)?,
            host.frames(true)?,
            bevy.frames(false)?,
            host.frames(false)?,
        ];
        ratios.push((round[0] - round[2]) / (round[1] - round[3]));
        for (all, ms) in found.iter_mut().zip(round) {
            all.push(ms);
        }
    }
    println!(
        "{rounds} rounds of {FRAMES} frames, {} × {}",
        size.0, size.1
    );
    let kinds = [
        "Bevy with the Earth, ms",
        "program with the Earth, ms",
        "Bevy without, ms",
        "program without, ms",
    ];
    for (kind, all) in kinds.iter().zip(&mut found) {
        println!("{kind}: {}", quartiles(all));
    }
    println!(
        "the Earth in Bevy / in the program: {}",
        quartiles(&mut ratios)
    );
    Ok(())
}

/// Median and quartiles.
fn quartiles(all: &mut [f64]) -> String {
    all.sort_by(f64::total_cmp);
    let at = |quarter: usize| all[(all.len() - 1) * quarter / 4];
    format!("{:.3} ({:.3} to {:.3})", at(2), at(1), at(3))
}

/// The median of some frames, milliseconds, after an uncounted one.
fn median(mut frame: impl FnMut() -> Result<(), Box<dyn Error>>) -> Result<f64, Box<dyn Error>> {
    frame()?;
    let mut times = Vec::with_capacity(FRAMES);
    for _ in 0..FRAMES {
        let begin = Instant::now();
        frame()?;
        times.push(begin.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    Ok(times[FRAMES / 2])
}

/// The Bevy app.
struct InBevy {
    app: App,
    earth: Entity,
    camera: Entity,
    device: RenderDevice,
}

impl InBevy {
    fn new(view: &View, size: (u32, u32)) -> Result<Self, Box<dyn Error>> {
        let mut app = scene::app(view);
        let image = headless::target(&mut app, size, view.format());
        let camera = scene::camera(&mut app, view, &image, None);
        headless::draw(&mut app, &image)?;
        let mut earths = app.world_mut().query_filtered::<Entity, With<Earth>>();
        let earth = earths.single(app.world())?;
        let device = app.world().resource::<RenderDevice>().clone();
        Ok(Self {
            app,
            earth,
            camera,
            device,
        })
    }

    fn frames(&mut self, with_earth: bool) -> Result<f64, Box<dyn Error>> {
        let world = self.app.world_mut();
        if with_earth {
            world.entity_mut(self.earth).insert(EarthClock::default());
            world.entity_mut(self.camera).insert(EarthCamera::default());
        } else {
            world.entity_mut(self.earth).remove::<EarthClock>();
            world.entity_mut(self.camera).remove::<EarthCamera>();
        }
        let (app, device) = (&mut self.app, &self.device);
        median(|| {
            app.update();
            device.poll(PollType::wait_indefinitely())?;
            Ok(())
        })
    }
}

/// The wgpu program.
struct Host {
    native: Native,
    earth: terrella::Earth,
    targets: FrameTargets,
    view: View,
    size: (u32, u32),
}

impl Host {
    fn new(native: Native, view: &View, size: (u32, u32)) -> Result<Self, Box<dyn Error>> {
        let options = EarthOptions::new(EarthLayers::clone(&native::maps()));
        Ok(Self {
            earth: terrella::Earth::new(&native.device, &native.queue, &options)?,
            targets: FrameTargets::new(&native.device, size, 1),
            native,
            view: *view,
            size,
        })
    }

    fn frames(&mut self, with_earth: bool) -> Result<f64, Box<dyn Error>> {
        let eye = self.view.eye(self.size);
        let Native { device, queue } = &self.native;
        let (earth, targets, epoch) = (&mut self.earth, &self.targets, &mut self.view.epoch);
        median(|| {
            if with_earth {
                *epoch += Duration::from_seconds(0.016);
                earth.prepare(queue, FrameRequest::new(&eye, &Sky::at(*epoch), self.size));
            }
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("terrella program"),
            });
            {
                let mut pass = targets.begin_pass(&mut encoder);
                if with_earth {
                    earth.render(&mut pass);
                }
            }
            queue.submit([encoder.finish()]);
            device.poll(wgpu::PollType::wait_indefinitely())?;
            Ok(())
        })
    }
}
