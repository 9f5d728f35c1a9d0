//! CPU time of one `prepare`, and of its pure part, at the paper's 128 blocks. Target: at most 100 µs. Then of the tracks, with markers of
//! 30 000 satellites. Target: at most 5 ms.

use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec3;
use std::hint::black_box;
use terrella::frames::{Ellipsoid, Epoch, Geodetic, Orientation};
use terrella::tracks::{TrackMoment, TrackStyle, Tracks, TracksOptions};
use terrella::{Earth, EarthOptions, EyeView, FrameRequest, GpuContext, Sky};
use terrella_ground::globe::{BlockGrid, Visibility, select_blocks};
use terrella_imagery::{EarthLayers, LayerImage};
use terrella_orbit::{Feed, Frame, OrbitError, OrbitState};

const SATELLITES: u32 = 30_000;

fn views() -> Vec<(&'static str, EyeView)> {
    [("400 km", 4e5), ("20 000 km, whole disc", 2e7)]
        .map(|(name, height_m)| {
            let eye =
                Ellipsoid::WGS84.itrf_from_geodetic(Geodetic::from_degrees(20.0, 30.0, height_m));
            (
                name,
                EyeView::itrf(eye, -eye, glam::DVec3::Z, 0.8, 16.0 / 9.0),
            )
        })
        .into()
}

fn prepare(criterion: &mut Criterion) {
    for subdivision in [6, 48] {
        let grid = BlockGrid::new(Ellipsoid::WGS84, subdivision).expect("a sound subdivision");
        for (name, view) in views() {
            let (eye, clip_from_eye) = view.to_itrf();
            let mut drawn = Vec::with_capacity(128);
            criterion.bench_function(&format!("select, n = {subdivision}, {name}"), |b| {
                b.iter(|| {
                    select_blocks(
                        &grid,
                        Visibility::Conservative,
                        black_box(eye),
                        &clip_from_eye,
                        &mut drawn,
                    )
                });
            });
        }
    }
    let Ok(gpu) = pollster::block_on(GpuContext::open(None)) else {
        eprintln!(
            "SKIPPED: prepare with a device: no adapter; `cargo xtask prepare` installs a software one"
        );
        return;
    };
    let layers = grey_layers();
    for subdivision in [6, 48] {
        let options = EarthOptions {
            subdivision: terrella::Subdivision::Cells(subdivision),
            ..EarthOptions::new(layers.clone())
        };
        let mut earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("sound options");
        for (name, view) in views() {
            let sky = Sky::new(glam::DVec3::X);
            let mut since_flush = 0;
            criterion.bench_function(&format!("prepare, n = {subdivision}, {name}"), |b| {
                b.iter(|| {
                    since_flush += 1;
                    if since_flush % 256 == 0 {
                        // Hand staging buffers back, as a frame's submission would.
                        gpu.queue.submit([]);
                    }
                    earth.prepare(
                        &gpu.queue,
                        FrameRequest::new(black_box(&view), &sky, (1280, 720)),
                    )
                });
            });
        }
    }
}

/// A day map of one grey, and no other.
fn grey_layers() -> EarthLayers {
    let day = LayerImage::from_rgba8(64, 32, vec![128; 64 * 32 * 4]).expect("a sound map");
    EarthLayers {
        day,
        clouds: None,
        normals: None,
        night_lights: None,
        water: None,
    }
}

/// A satellite whose state has been computed before, as the program does for many of them.
struct Computed(OrbitState);

impl Feed for Computed {
    fn name(&self) -> &str {
        "computed"
    }

    fn validity(&self) -> (Epoch, Epoch) {
        (self.0.epoch, self.0.epoch)
    }

    fn state_at(&self, _epoch: Epoch) -> Result<OrbitState, OrbitError> {
        Ok(self.0)
    }
}

/// Spread evenly over the sphere by the golden angle, from 400 to 1600 km high, every fiftieth in geosynchronous orbit.
fn computed(epoch: Epoch) -> Vec<Computed> {
    let state = |k: u32| {
        let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(SATELLITES);
        let around = (1.0 - z * z).sqrt();
        let (sin, cos) = (2.399_963 * f64::from(k)).sin_cos();
        let place = DVec3::new(around * cos, around * sin, z);
        let radius_m = match k % 50 {
            0 => 42.164e6,
            low => 6.778e6 + 25e3 * f64::from(low),
        };
        Computed(OrbitState {
            epoch,
            frame: Frame::Teme,
            position_m: radius_m * place,
            velocity_m_s: 7500.0 * place.any_orthonormal_vector(),
        })
    };
    (0..SATELLITES).map(state).collect()
}

fn markers(criterion: &mut Criterion) {
    let Ok(gpu) = pollster::block_on(GpuContext::open(None)) else {
        return;
    };
    let earth = Earth::new(&gpu.device, &gpu.queue, &EarthOptions::new(grey_layers()));
    let earth = earth.expect("sound options");
    let style = |k| TrackStyle {
        marker: true,
        ..TrackStyle::new(k)
    };
    let styles: Vec<_> = (0..SATELLITES as usize).map(style).collect();
    let options = TracksOptions::of(&earth);
    let epoch = Epoch::from_tai_seconds(3e9);
    let feeds = computed(epoch);
    for (name, view) in views() {
        let mut tracks = Tracks::new(&gpu.device, &options, &styles).expect("sound styles");
        criterion.bench_function(&format!("markers of {SATELLITES}, {name}"), |b| {
            b.iter(|| {
                gpu.queue.submit([]);
                let moment = TrackMoment {
                    epoch,
                    orientation: Orientation::default(),
                    turn: None,
                    view: black_box(&view),
                    target: (1280, 720).into(),
                };
                let feeds = feeds.iter().map(|feed| feed as &dyn Feed);
                tracks.prepare(&gpu.queue, &moment, feeds)
            });
        });
    }
}

criterion_group!(benches, prepare, markers);
criterion_main!(benches);
