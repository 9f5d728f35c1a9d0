//! The projected grid drawn from vertices of the GPU's making, against the same grid made on the CPU.

use crate::common::{Rig, gpu, map, plain, ray, tilted};
use crate::hills::Hills;
use glam::DVec3;
use std::sync::Arc;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::internals::plan::FrameUniforms;
use terrella::{Atmosphere, EarthOptions, EyeView, GroundOptions, Shading, SurfaceSettings};
use terrella_ground::elevation::Elevation;
use terrella_ground::globe::projected_grid::{
    GPU_FIRST_LOADS, GPU_LOADS, GridOptions, GridUniforms, TILE_SAMPLES,
};
use terrella_imagery::EarthLayers;
use terrella_measure::errors::{GeolocationBuffer, GeolocationRenderer, GroundPicture};

const SIZE: (u32, u32) = (320, 180);

/// Hills of four sizes, from 600 km to 300 m.
const HILLS: Hills = Hills {
    waves: &[(2500.0, 60.0), (1500.0, 251.0), (300.0, 2e3), (20.0, 1.2e5)],
    finest_spacing_rad: 5e-7,
};

fn ground(on_gpu: bool) -> GroundOptions {
    GroundOptions {
        elevation: Arc::new(HILLS),
        surface: SurfaceSettings::ProjectedGrid(GridOptions {
            on_gpu,
            ..GridOptions::default()
        }),
        tolerance_px: 0.5,
    }
}

fn options(layers: EarthLayers, on_gpu: bool) -> EarthOptions {
    let mut options = EarthOptions::new(layers);
    options.atmosphere = Atmosphere::None;
    options.shading = Shading::Paper;
    options.anisotropy = 1;
    options.ground = Some(ground(on_gpu));
    options
}

fn position_layers() -> EarthLayers {
    let wave = |angle: f64| (110.0 + 100.0 * angle.to_radians().sin()).round() as u8;
    EarthLayers {
        day: map(512, |lat, lon| {
            [wave(16.0 * lat), wave(16.0 * lon), wave(lon)]
        }),
        ..plain([0; 3])
    }
}

/// An eye so high above the ground.
fn over(lat: f64, lon: f64, height_m: f64, pitch_deg: f64, fov_deg: f64) -> EyeView {
    let place = Geodetic::from_degrees(lat, lon, 0.0);
    let place = Geodetic {
        height_m: height_m + HILLS.height_m(place.lat_rad, place.lon_rad, 0.0),
        ..place
    };
    let aspect = f64::from(SIZE.0) / f64::from(SIZE.1);
    tilted(place, 30.0, pitch_deg, fov_deg, aspect)
}

fn views() -> Vec<(&'static str, EyeView)> {
    vec![
        ("1 m", over(47.0, 11.0, 1.0, -20.0, 50.0)),
        ("500 m", over(47.0, 11.0, 500.0, -15.0, 50.0)),
        ("3 km, horizon", over(-33.0, -70.0, 3e3, -3.0, 40.0)),
        ("30 km", over(20.0, 100.0, 3e4, -40.0, 50.0)),
        ("limb, 400 km", over(20.0, -100.0, 4e5, -20.0, 40.0)),
        ("down, 400 km", over(47.0, 11.0, 4e5, -90.0, 50.0)),
        ("whole disc, 1e7 m", over(20.0, -100.0, 1e7, -90.0, 50.0)),
        ("south pole, 2 km", over(-89.9999, 40.0, 2e3, -25.0, 50.0)),
        ("north pole, 2000 km", over(89.0, 40.0, 2e6, -90.0, 50.0)),
        ("date line, 5 km", over(10.0, 179.9999, 5e3, -30.0, 50.0)),
        ("date line, 600 km", over(10.0, 179.5, 6e5, -50.0, 40.0)),
    ]
}

/// Draws until all elevation tiles of a view are resident.
fn places(earth: &mut GeolocationRenderer, view: &EyeView) -> GeolocationBuffer {
    for _ in 0..400 {
        let places = earth.draw(view, SIZE).expect("places");
        if earth.stats().ground.samples_read == 0 {
            return places;
        }
    }
    panic!("heights are still being read");
}

#[test]
fn both_forms_draw_the_same_ground() {
    let mut earths = [false, true].map(|on_gpu| {
        GeolocationRenderer::with_ground(gpu(), &ground(on_gpu)).expect("sound options")
    });
    let wgs84 = Ellipsoid::WGS84;
    let mut wrong = Vec::new();
    println!(
        "px between the forms: median, 99 %; pixels of one only | against the data, p99 px: CPU, GPU | holes"
    );
    for (name, view) in views() {
        let [cpu, on_gpu] = earths.each_mut().map(|earth| places(earth, &view));
        let [made, drawn] = earths.each_ref().map(|earth| earth.stats().ground);
        assert_eq!((made.vertices, made.triangles), (129 * 129, 2 * 128 * 128));
        assert_eq!(
            (drawn.vertices, drawn.triangles),
            (129 * 129, 2 * 128 * 128)
        );
        let forward = (view.view_from_world.inverse() * DVec3::NEG_Z).normalize();
        let pixel_rad = 2.0 / (view.clip_from_view.y_axis.y * f64::from(SIZE.1));
        let (mut apart, mut one_only) = (Vec::new(), 0);
        for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
            let (Some(a), Some(b)) = (cpu.along(x, y), on_gpu.along(x, y)) else {
                one_only += u32::from(cpu.is_ground(x, y) != on_gpu.is_ground(x, y));
                continue;
            };
            let direction = ray(&view, x, y, SIZE);
            let metres = |along: f64| along / direction.dot(forward);
            let up = (view.eye_world + direction * metres(a)).normalize();
            // As it would look from the side: a step along the ray shows by as much as the ground faces the eye.
            let facing = -up.dot(direction);
            apart.push((metres(a) - metres(b)).abs() * facing.max(0.02) / metres(a) / pixel_rad);
        }
        apart.sort_by(f64::total_cmp);
        let (median, p99) = (apart[apart.len() / 2], apart[apart.len() * 99 / 100]);
        let [cpu, on_gpu] = [cpu, on_gpu].map(|places| {
            let picture = GroundPicture::new(&places, &view, &wgs84, &HILLS).expect("pixels");
            picture.errors(&wgs84, &HILLS, None)
        });
        println!(
            "{name:>20}: {median:.4}, {p99:.4}; {one_only} of {} | {:.3}, {:.3} | {}, {}",
            apart.len(),
            cpu.p99_px,
            on_gpu.p99_px,
            cpu.holes,
            on_gpu.holes
        );
        // Around a pole a window of all longitudes is clipped, and a coarser level covers the rest.
        let near_pole = name.starts_with("south pole");
        let (most, most_p99, most_p99_px) = match near_pole {
            true => (1.0, 5.0, 5.0),
            false => (0.1, 0.5, 1.1 * cpu.p99_px + 0.1),
        };
        let is_same = median < most && p99 < most_p99 && one_only < 100 && apart.len() > 8000;
        // The chords of a whole disc's edge leave out a few pixels' middles.
        let holes = if name.starts_with("whole") {
            cpu.holes
        } else {
            0
        };
        if !is_same || on_gpu.p99_px > most_p99_px || on_gpu.holes > holes {
            wrong.push(name);
        }
    }
    assert_eq!(wrong, [""; 0]);
}

#[test]
fn both_forms_have_the_same_colours() {
    let mut rigs = [false, true].map(|on_gpu| Rig::new(&options(position_layers(), on_gpu), SIZE));
    assert!(rigs[1].earth.diagnostics().features_on.contains(&"grid"));
    assert!(!rigs[0].earth.diagnostics().features_on.contains(&"grid"));
    let mut wrong = Vec::new();
    for (name, view) in views() {
        let sun = view.eye_world.normalize();
        let sun = (sun + 0.7 * sun.any_orthonormal_vector()).normalize();
        let [cpu, on_gpu] = rigs.each_mut().map(|rig| rig.draw_complete(&view, sun).0);
        let mut apart: Vec<u8> = cpu
            .pixels()
            .zip(on_gpu.pixels())
            .map(|(a, b)| (0..3).map(|k| a[k].abs_diff(b[k])).max().unwrap_or(0))
            .collect();
        apart.sort_unstable();
        let at = |part: usize| apart[apart.len() * part / 1000];
        println!(
            "{name:>20}: {} of 255 in the middle, {} of 99 %, {} of 99.9 %",
            at(500),
            at(990),
            at(999)
        );
        if at(500) > 2 || at(990) > 25 {
            wrong.push(name);
        }
        if let Some(folder) = std::env::var_os("TERRELLA_RELIEF_PICTURES") {
            for (picture, form) in [(&cpu, "cpu"), (&on_gpu, "gpu")] {
                let file = format!("grid-{}-{form}.png", name.replace([' ', ','], "-"));
                picture
                    .save(std::path::Path::new(&folder).join(file))
                    .expect("a folder");
            }
        }
    }
    assert_eq!(wrong, [""; 0]);
}

#[test]
fn a_frame_writes_its_uniform_and_new_tiles_alone() {
    let mut rig = Rig::new(&options(plain([200; 3]), true), SIZE);
    let least = (size_of::<FrameUniforms>() + size_of::<GridUniforms>()) as u64;
    let tile = u64::from(4 * TILE_SAMPLES * TILE_SAMPLES);
    let mut held = None;
    for (name, view) in views() {
        let sun = view.eye_world.normalize();
        let mut all = 0;
        loop {
            let (_, stats) = rig.draw(&view, sun);
            let tiles = stats.ground.samples_read / u64::from(TILE_SAMPLES * TILE_SAMPLES);
            assert_eq!(stats.uploaded_bytes, least + tiles * tile, "{name}");
            let is_new = all == 0 || name.starts_with("south pole");
            let most = GPU_LOADS + if is_new { GPU_FIRST_LOADS } else { 0 };
            assert!(tiles <= u64::from(most), "{name}: {tiles} tiles in a frame");
            assert_eq!(stats.draw_calls, 1);
            let bytes = (stats.ground_bytes, stats.ground.resident_bytes);
            assert_eq!(*held.get_or_insert(bytes), bytes, "{name}");
            all += tiles;
            if tiles == 0 {
                break;
            }
        }
        println!("{name}: {all} tiles");
        assert!(all > 0, "{name}");
    }
}

#[test]
fn tiles_loaded_for_a_view_that_is_not_drawn_are_not_lost() {
    let view = over(47.0, 11.0, 500.0, -15.0, 50.0);
    let sun = view.eye_world.normalize();
    let mut rig = Rig::new(&options(plain([200; 3]), true), SIZE);
    for _ in 0..200 {
        let (_, stats) = rig.draw(&view, DVec3::ZERO);
        assert_eq!(stats.triangles, 0, "nothing is drawn without a Sun");
    }
    let (picture, ..) = rig.draw_complete(&view, sun);
    let mut other = Rig::new(&options(plain([200; 3]), true), SIZE);
    assert_eq!(picture, other.draw_complete(&view, sun).0);
}

#[test]
fn quality_can_change() {
    let view = over(20.0, -100.0, 4e5, -20.0, 40.0);
    let sun = view.eye_world.normalize();
    let mut rig = Rig::new(&options(position_layers(), true), SIZE);
    let (before, ..) = rig.draw_complete(&view, sun);
    let quality = *rig.earth.quality();
    rig.set_quality(&terrella::Quality {
        samples: 4,
        ..quality
    });
    let (smooth, stats, _) = rig.draw_complete(&view, sun);
    assert_eq!((stats.ground.vertices, stats.draw_calls), (129 * 129, 1));
    let differ = before.pixels().zip(smooth.pixels()).filter(|(a, b)| a != b);
    let differ = differ.count();
    assert!(
        (10..8000).contains(&differ),
        "{differ} pixels, those of edges, differ"
    );
    rig.set_quality(&quality);
    assert_eq!(rig.draw_complete(&view, sun).0, before);
}

#[test]
fn a_device_without_room_draws_it_from_the_cpu() {
    let gpu = gpu();
    let (device, queue) = pollster::block_on(gpu.adapter.request_device(&wgpu::DeviceDescriptor {
        required_limits: wgpu::Limits {
            max_texture_dimension_2d: 1024,
            ..gpu.adapter.limits()
        },
        ..Default::default()
    }))
    .expect("a device");
    let options = options(plain([200; 3]), true);
    let earth = terrella::Earth::new(&device, &queue, &options).expect("sound options");
    let on = earth.diagnostics().features_on;
    assert!(on.contains(&"relief") && !on.contains(&"grid"));
}
