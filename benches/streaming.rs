//! Flights over an imagery pack in real time, as in a window: no frame waits for a tile.
//!
//! ```text
//! cargo bench --bench streaming -- --pack DIR [--texture-mb N] [--upload-mb N] [--size WxH] [--flight orbit|spin]
//!                                  [--turn-s N] [--seconds N] [--storage plain|bc|auto] [--tiles both|with|without]
//!                                  [--frames DIR]
//! ```
//!
//! Two flights: `orbit`, the International Space Station for 90 minutes at 60 ×, looking down; and `spin`, 200 km above the ground, once around the
//! Earth in 20 s (`--turn-s`; an orbit takes 5300 s), looking at the horizon, the Sun always behind. Each frame is prepared, submitted and waited
//! for, and its total time measured. The time of `prepare` is reported separately, with and without the copying of tiles, together with the
//! processor time of its thread, which does not depend on other load of the machine. Memory is the process's peak so far, so run each flight in a
//! separate process where it matters.
//!
//! Each is flown without tiles and then with them, and the difference is printed last: our own jank is the part that frames would not have if
//! `prepare` took no time.

#[path = "streaming/arguments.rs"]
mod arguments;
#[path = "streaming/record.rs"]
mod record;

use arguments::{Arguments, Course, Drawn};
use cpu_time::ThreadTime;
use glam::{DQuat, DVec3};
use image::RgbaImage;
use record::{Frame, Record};
use std::time::Instant;
use terrella::frames::{Ellipsoid, Epoch};
use terrella::{Earth, EyeView, FrameRequest, FrameTargets, GpuContext, Sky};
use terrella_play::Flight;
use terrella_play::scene::Scene;

/// As far ahead as the window looks, seconds.
const EXPECTED_S: [f64; 3] = [0.5, 1.5, 4.0];

/// Height of the spin, metres.
const SPIN_HEIGHT_M: f64 = 200e3;

fn main() {
    let arguments = Arguments::read();
    let Some(pack) = &arguments.pack else {
        println!(
            "SKIPPED: flights over a pack need one: --pack DIR; `cargo xtask big-pack` makes a large one"
        );
        return;
    };
    let start = Instant::now();
    let scene = format!(
        "[time]\nspeed = 60\nduration_s = 5400\n[camera]\nmode = \"nadir\"\n[earth]\npack = {:?}\ntexture_mb = {}\n\
         upload_mb = {}\nstorage = {:?}\n[output]\nsize = [{}, {}]\n",
        pack.display().to_string(),
        arguments.texture_mb,
        arguments.upload_mb,
        arguments.storage,
        arguments.size.0,
        arguments.size.1,
    );
    let scene = Scene::from_toml(&scene, "streaming.toml".as_ref()).expect("a good scene");
    let flight = Flight::open(scene).expect("the built-in orbit");
    let gpu = pollster::block_on(GpuContext::open(None)).expect("an adapter");
    let mut options = flight.earth_options(gpu.bc_support()).expect("a good pack");
    options.color_format = FrameTargets::COLOR;
    let info = gpu.adapter.get_info();
    println!(
        "{} ({}), {} x {}, {} samples, texture budget {} MB, upload budget {} MB a frame",
        info.name,
        info.backend,
        arguments.size.0,
        arguments.size.1,
        options.samples,
        arguments.texture_mb,
        arguments.upload_mb
    );
    for course in arguments.courses() {
        let mut flown: Vec<(Drawn, Record)> = Vec::new();
        for drawn in &arguments.tiles {
            let begin = Instant::now();
            let mut options = options.clone();
            options.tiles.take_if(|_| *drawn == Drawn::WholeMaps);
            let earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("an Earth");
            let targets = FrameTargets::new(&gpu.device, arguments.size, options.samples);
            let mut renderer = FrameRenderer {
                gpu: gpu.clone(),
                earth,
                targets,
                size: arguments.size,
            };
            let (view, sky) = course_at(course, &flight, 0.0, renderer.aspect());
            if renderer.draw_first(&view, &sky) {
                println!(
                    "\n{} {}: first complete coarse picture after {:.0} ms, {:.0} ms since the start",
                    course.name(),
                    drawn.name(),
                    begin.elapsed().as_secs_f64() * 1e3,
                    start.elapsed().as_secs_f64() * 1e3
                );
            }
            let folder = format!("{} {}", course.name(), drawn.name());
            let record = fly(&mut renderer, course, &folder, &flight, &arguments);
            record.print(&folder);
            flown.push((*drawn, record));
        }
        if let [(Drawn::WholeMaps, without), (Drawn::Tiles, with)] = &flown[..] {
            with.print_difference(without, course.name());
        }
    }
}

/// Draws the Earth into its own targets, as a window would.
struct FrameRenderer {
    gpu: GpuContext,
    earth: Earth,
    targets: FrameTargets,
    size: (u32, u32),
}

impl FrameRenderer {
    fn aspect(&self) -> f64 {
        f64::from(self.size.0) / f64::from(self.size.1)
    }

    /// Draws one frame and waits for it; whether any ground was drawn.
    fn draw_first(&mut self, view: &EyeView, sky: &Sky) -> bool {
        let stats = self
            .earth
            .prepare(&self.gpu.queue, FrameRequest::new(view, sky, self.size));
        self.draw();
        stats.blocks_drawn > 0
    }

    /// Draws what was prepared and waits for the device.
    fn draw(&mut self) {
        let label = Some("terrella streaming");
        let mut encoder = self
            .gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        self.earth
            .render(&mut self.targets.begin_pass(&mut encoder));
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu
            .device
            .poll(wgpu::PollType::wait_indefinitely())
            .expect("the device answers");
    }
}

/// The eye and the Sun, so many seconds of real time after the start.
fn course_at(course: Course, flight: &Flight, seconds: f64, aspect: f64) -> (EyeView, Sky) {
    match course {
        Course::Orbit => {
            let scene = flight.scene();
            let epoch: Epoch =
                scene.time.start + hifitime::Unit::Second * (seconds * scene.time.speed);
            let moment = flight
                .at(epoch, aspect)
                .expect("within the elements' reach");
            (moment.view, moment.sky)
        }
        Course::Spin { turn_s } => {
            let angle = seconds / turn_s * std::f64::consts::TAU;
            let tilt = DQuat::from_rotation_x(51.6_f64.to_radians());
            let (up, forward) = (
                tilt * DVec3::new(angle.cos(), angle.sin(), 0.0),
                tilt * DVec3::new(-angle.sin(), angle.cos(), 0.0),
            );
            let eye = Ellipsoid::WGS84.surface_point(up) + SPIN_HEIGHT_M * up;
            let look = forward - 0.45 * up;
            let view = EyeView::itrf(eye, look, up, 60_f64.to_radians(), aspect);
            (view, Sky::new(up))
        }
    }
}

/// Flies a course in real time and records its frames.
fn fly(
    renderer: &mut FrameRenderer,
    course: Course,
    folder: &str,
    flight: &Flight,
    arguments: &Arguments,
) -> Record {
    let aspect = renderer.aspect();
    let length_s = arguments.seconds.unwrap_or(match course {
        Course::Orbit => 90.0,
        Course::Spin { turn_s } => 2.0 * turn_s,
    });
    let mut record = Record::new(folder, arguments.frames.as_deref());
    let start = Instant::now();
    loop {
        let begin = Instant::now();
        let seconds = (begin - start).as_secs_f64();
        if seconds >= length_s {
            return record;
        }
        let (view, sky) = course_at(course, flight, seconds, aspect);
        let expected = EXPECTED_S.map(|ahead| course_at(course, flight, seconds + ahead, aspect).0);
        let (prepare, prepare_cpu) = (Instant::now(), ThreadTime::now());
        renderer.earth.prefetch(&expected);
        let stats = renderer.earth.prepare(
            &renderer.gpu.queue,
            FrameRequest::new(&view, &sky, renderer.size),
        );
        let (prepare, prepare_cpu) = (prepare.elapsed(), prepare_cpu.elapsed());
        renderer.draw();
        let frame = Frame {
            whole: begin.elapsed(),
            prepare,
            prepare_cpu,
        };
        record.add(frame, &stats);
        if record.keeps_frames() {
            let read = renderer
                .targets
                .read_back(&renderer.gpu.device, &renderer.gpu.queue);
            let (width, height) = renderer.size;
            let picture = RgbaImage::from_raw(width, height, read.expect("a picture"));
            record.keep(picture.expect("of that size"));
        }
    }
}
