//! CPU time of one `prepare`, and of its pure part, at the paper's 128 blocks. Target: at most 100 µs.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{Earth, EarthOptions, EyeView, FrameRequest, GpuContext, Sky};
use terrella_ground::globe::{BlockGrid, Visibility, select_blocks};
use terrella_imagery::{EarthLayers, LayerImage};

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
    let day = LayerImage::from_rgba8(64, 32, vec![128; 64 * 32 * 4]).expect("a sound map");
    let layers = EarthLayers {
        day,
        clouds: None,
        normals: None,
        night_lights: None,
        water: None,
    };
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

criterion_group!(benches, prepare);
criterion_main!(benches);
