//! Time of a whole frame, device waited for, beside its floor on the same adapter in the same run.
//!
//! The floor is a full-screen pass that takes as many texture samples on each covered pixel as the frame does, from
//! textures of the same sizes and formats, and clears the rest. Absolute times on a shared machine say little; the
//! ratio, printed at the end as a median with its quartiles, is the figure to compare.

#[path = "frame/floor.rs"]
mod floor;

use criterion::{Criterion, criterion_group, criterion_main};
use floor::Floor;
use std::time::{Duration, Instant};
use terrella::frames::{Ellipsoid, Epoch, Geodetic};
use terrella::gpu::{FrameTargets, GpuContext};
use terrella::imagery::{LayerSelection, find_textures, load_layers};
use terrella::{Earth, EarthOptions, EyeView, Sky};

struct Bench {
    gpu: GpuContext,
    targets: FrameTargets,
    earth: Earth,
    floor: Floor,
    view: EyeView,
    sky: Sky,
}

impl Bench {
    fn new(gpu: GpuContext, size: (u32, u32), samples: u32, height_m: f64, pitch_deg: f64) -> Self {
        let layers = find_textures()
            .and_then(|folder| load_layers(&folder, LayerSelection::default()))
            .expect("the starter pack");
        let place = Geodetic::from_degrees(20.0, 20.0, height_m);
        let eye = Ellipsoid::WGS84.itrf_from_geodetic(place);
        let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let north = (glam::DVec3::Z - up * up.z).normalize();
        let (sin, cos) = pitch_deg.to_radians().sin_cos();
        let aspect = f64::from(size.0) / f64::from(size.1);
        let view = EyeView::itrf(
            eye,
            north * cos + up * sin,
            up * cos - north * sin,
            0.8,
            aspect,
        );
        let options = EarthOptions {
            samples,
            ..EarthOptions::new(layers)
        };
        let earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("sound options");
        let targets = FrameTargets::new(&gpu.device, size, samples);
        let floor = Floor::new(&gpu, &options, &view, size);
        let sky = Sky::at(Epoch::from_gregorian_utc(2018, 1, 15, 11, 0, 0, 0));
        Self {
            gpu,
            targets,
            earth,
            floor,
            view,
            sky,
        }
    }

    fn finish(&self, encoder: wgpu::CommandEncoder) {
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu
            .device
            .poll(wgpu::PollType::wait_indefinitely())
            .expect("the device");
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("terrella bench"),
            })
    }

    fn frame(&mut self) {
        self.earth
            .prepare(&self.gpu.queue, &self.view, &self.sky, self.targets.size());
        let mut encoder = self.encoder();
        self.earth
            .render(&mut self.targets.begin_pass(&mut encoder));
        self.finish(encoder);
    }

    fn floor(&self) {
        let mut encoder = self.encoder();
        self.floor
            .render(&mut self.targets.begin_pass(&mut encoder));
        self.finish(encoder);
    }

    /// Median and quartiles of frame time over floor time, the two measured turn about.
    fn ratio(&mut self, rounds: usize) -> [f64; 3] {
        let time = |work: &mut dyn FnMut()| {
            let start = Instant::now();
            work();
            start.elapsed()
        };
        let mut ratios: Vec<f64> = (0..rounds)
            .map(|_| {
                let frame: Duration = time(&mut || self.frame());
                let floor = time(&mut || self.floor());
                frame.as_secs_f64() / floor.as_secs_f64()
            })
            .collect();
        ratios.sort_by(f64::total_cmp);
        [0.25, 0.5, 0.75].map(|q| ratios[((rounds - 1) as f64 * q) as usize])
    }
}

fn frame(criterion: &mut Criterion) {
    let open = || pollster::block_on(GpuContext::open(None));
    if open().is_err() {
        eprintln!("SKIPPED: no adapter; `cargo xtask prepare` installs a software one");
        return;
    }
    let mut group = criterion.benchmark_group("640 x 360, 400 km");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(3))
        .warm_up_time(Duration::from_secs(1));
    let mut bench = Bench::new(open().expect("an adapter"), (640, 360), 1, 4e5, -50.0);
    group.bench_function("frame", |b| b.iter(|| bench.frame()));
    group.bench_function("floor", |b| b.iter(|| bench.floor()));
    group.finish();
    for samples in [1, 4] {
        for (name, height_m, pitch_deg) in [
            ("400 km, down", 4e5, -90.0),
            ("400 km, limb in view", 4e5, -25.0),
            ("20 000 km, whole disc", 2e7, -90.0),
        ] {
            let mut bench = Bench::new(
                open().expect("an adapter"),
                (1280, 720),
                samples,
                height_m,
                pitch_deg,
            );
            for _ in 0..3 {
                bench.frame();
                bench.floor();
            }
            let [low, median, high] = bench.ratio(25);
            println!(
                "frame/floor 1280 x 720, {samples} sample(s), {name}: {median:.2} ({low:.2} … {high:.2})"
            );
        }
    }
}

criterion_group!(benches, frame);
criterion_main!(benches);
