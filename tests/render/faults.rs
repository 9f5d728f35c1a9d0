//! Errors of the device outside of error scopes: they come back from the next picture, and nothing panics.

use crate::common::{gpu, plain};
use std::time::Duration;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{
    Earth, EarthError, EarthOptions, EyeView, GpuContext, GpuFault, OffscreenEarth, OffscreenError,
    PictureError, Sky,
};

fn earth() -> OffscreenEarth {
    let gpu = OffscreenEarth::open_gpu(Some("llvmpipe"))
        .or_else(|_| OffscreenEarth::open_gpu(None))
        .expect("an adapter");
    let options = EarthOptions::new(plain([90, 120, 60]));
    OffscreenEarth::new(gpu, options, (64, 36)).expect("an Earth")
}

fn view() -> EyeView {
    let place = Geodetic::from_degrees(10.0, 20.0, 8e6);
    let eye_itrf_m = Ellipsoid::WGS84.itrf_from_geodetic(place);
    EyeView::itrf(eye_itrf_m, -eye_itrf_m, glam::DVec3::Z, 1.0, 64.0 / 36.0)
}

/// A buffer that maps for reading and may be drawn from: no device allows it.
fn ask_for_something_that_is_not_allowed(gpu: &GpuContext) {
    let _ = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("terrella test"),
        size: 16,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
}

fn fault(result: Result<terrella::Drawing, OffscreenError>) -> GpuFault {
    match result {
        Err(OffscreenError::Picture(PictureError::Fault(fault))) => fault,
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_the_device_rejects_is_the_error_of_the_next_picture() {
    let mut earth = earth();
    let (view, sky) = (view(), Sky::new(glam::DVec3::X));
    let mut rgba = vec![0; 64 * 36 * 4];
    let mut light = vec![0.0; 64 * 36 * 4];
    let wait = Duration::from_secs(5);
    earth
        .draw_color(&view, &sky, wait, &mut rgba)
        .expect("a picture");
    for _ in 0..2 {
        // The second follows from the first, or hides it: the first is reported.
        ask_for_something_that_is_not_allowed(earth.gpu());
        ask_for_something_that_is_not_allowed(earth.gpu());
        let found = fault(earth.draw_color(&view, &sky, wait, &mut rgba));
        assert!(matches!(found, GpuFault::Validation(_)), "{found:?}");
        assert!(found.to_string().contains("terrella test"), "{found}");
        // It is over with the error.
        earth
            .draw_color(&view, &sky, wait, &mut rgba)
            .expect("a picture");
    }
    ask_for_something_that_is_not_allowed(earth.gpu());
    let found = fault(earth.draw_light(&view, &sky, wait, &mut light));
    assert!(matches!(found, GpuFault::Validation(_)), "{found:?}");
    ask_for_something_that_is_not_allowed(earth.gpu());
    let truth = earth
        .draw_truth(&view, &sky, wait)
        .map(|(_, drawing)| drawing);
    assert!(matches!(fault(truth), GpuFault::Validation(_)));
}

#[test]
fn the_errors_of_an_awaited_earth_are_its_answer() {
    let gpu = gpu();
    let mut options = EarthOptions::new(plain([90, 120, 60]));
    let create = |options: &EarthOptions| {
        let made = Earth::create(&gpu.device, &gpu.queue, options);
        pollster::block_on(made).map(drop)
    };
    create(&options).expect("an Earth");
    // No device draws to a pass of three samples a pixel.
    options.samples = 3;
    let error = create(&options).expect_err("the device rejects it");
    assert!(matches!(error, EarthError::Rejected(_)), "{error}");
    let error = Earth::new(&gpu.device, &gpu.queue, &options).map(drop);
    assert!(matches!(error, Err(EarthError::Rejected(_))));
}

#[test]
fn a_device_that_is_gone_is_an_error_for_good() {
    let mut earth = earth();
    let (view, sky) = (view(), Sky::new(glam::DVec3::X));
    let mut rgba = vec![0; 64 * 36 * 4];
    let wait = Duration::from_secs(5);
    earth
        .draw_color(&view, &sky, wait, &mut rgba)
        .expect("a picture");
    earth.gpu().device.destroy();
    for _ in 0..2 {
        assert!(earth.draw_color(&view, &sky, wait, &mut rgba).is_err());
    }
}
