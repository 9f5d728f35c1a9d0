//! Cost of a call from C over the native call. By hand, on a quiet machine:
//! `cargo test --release -p terrella-c --test overhead -- --ignored --nocapture`.

use std::time::Instant;
use terrella::{EarthOptions, LayerSelection, OffscreenEarth, Sky, find_textures, load_layers};
use terrella_c::*;

const ROUNDS: usize = 60;

#[test]
#[ignore = "a measurement"]
fn a_still_through_c_takes_as_long_as_one_without() {
    // A small image too: the cost of a call does not depend on the size, but the noise of drawing does.
    for size in [(16, 9), (800, 450)] {
        measure(size);
    }
}

fn measure(size: (u32, u32)) {
    let layers = load_layers(&find_textures().expect("maps"), LayerSelection::default());
    let gpu = OffscreenEarth::open_gpu(None).expect("an adapter");
    let options = EarthOptions::new(layers.expect("maps"));
    let mut native = OffscreenEarth::new(gpu, options, size).expect("an Earth");

    let mut options = std::mem::MaybeUninit::uninit();
    let mut earth = std::ptr::null_mut();
    let mut camera = std::mem::MaybeUninit::uninit();
    let mut time = std::mem::MaybeUninit::uninit();
    // SAFETY: all pointers are valid for writes, and the text ends with a zero byte.
    let (camera, time) = unsafe {
        terrella_options_default(options.as_mut_ptr());
        (*options.as_mut_ptr()).width = size.0;
        (*options.as_mut_ptr()).height = size.1;
        let status = terrella_earth_new(options.as_ptr(), &raw mut earth);
        assert_eq!(status, TerrellaStatus::TERRELLA_OK);
        terrella_camera_geodetic(
            13.0,
            14.0,
            5e6,
            270.0,
            -60.0,
            45.0,
            800.0 / 450.0,
            camera.as_mut_ptr(),
        );
        terrella_time_utc(c"2018-06-21T16:00:00Z".as_ptr(), time.as_mut_ptr());
        (camera.assume_init(), time.assume_init())
    };

    let mut rgba = vec![0_u8; size.0 as usize * size.1 as usize * 4];
    let epoch = terrella::frames::utc_from_rfc3339("2018-06-21T16:00:00Z").expect("a date");
    let place = terrella::frames::Geodetic::from_degrees(13.0, 14.0, 5e6);
    let pose = terrella_play::camera::Pose::geodetic(place, &terrella::frames::Ellipsoid::WGS84);
    let pose = pose.facing(270_f64.to_radians(), -60_f64.to_radians());
    let view = pose.view(45_f64.to_radians(), 800.0 / 450.0);
    let (mut own, mut through_c) = (Vec::new(), Vec::new());
    for round in 0..ROUNDS + 5 {
        let begin = Instant::now();
        let drawn = native.draw_color(&view, &Sky::at(epoch), std::time::Duration::ZERO, &mut rgba);
        let first = begin.elapsed().as_secs_f64() * 1e3;
        drawn.expect("drawn");
        let begin = Instant::now();
        // SAFETY: the buffer has the given number of bytes.
        let status = unsafe {
            let pixels = rgba.as_mut_ptr().cast();
            terrella_earth_draw(
                earth,
                &raw const camera,
                time,
                0.0,
                TERRELLA_RGBA8,
                pixels,
                rgba.len(),
                std::ptr::null_mut(),
            )
        };
        let second = begin.elapsed().as_secs_f64() * 1e3;
        assert_eq!(status, TerrellaStatus::TERRELLA_OK);
        // The first fill caches.
        if round >= 5 {
            own.push(first);
            through_c.push(second);
        }
    }
    let median = |times: &mut Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times[ROUNDS / 2]
    };
    let (own, through_c) = (median(&mut own), median(&mut through_c));
    let (width, height) = size;
    println!(
        "{width} × {height}: native {own:.3} ms, through C {through_c:.3} ms, {:+.3} ms",
        through_c - own
    );
    assert_eq!(terrella_earth_free(earth), TerrellaStatus::TERRELLA_OK);
}
