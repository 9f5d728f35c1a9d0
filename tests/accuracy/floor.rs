//! The floor that frames are compared with samples where frames do: the same pixels, the same places, the same footprints.

use crate::common::{day_only, down, gpu, looks_at, map, ray, tilted};
use image::RgbaImage;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{Atmosphere, EarthOptions, EyeView, FrameTargets, Sky};
use terrella_imagery::LayerImage;
use terrella_measure::Floor;

const SIZE: (u32, u32) = (192, 108);

fn draw(day: LayerImage, samples: u32, view: &EyeView) -> RgbaImage {
    let gpu = gpu();
    let options = EarthOptions {
        atmosphere: Atmosphere::None,
        samples,
        ..EarthOptions::new(day_only(day))
    };
    let mut floor = Floor::new(gpu, &options, options.pass_format());
    floor.prepare(&gpu.queue, view, &Sky::new(glam::DVec3::X), SIZE);
    let targets = FrameTargets::new(&gpu.device, SIZE, samples);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    floor.render(&mut targets.begin_pass(&mut encoder));
    gpu.queue.submit([encoder.finish()]);
    let pixels = targets.read_back(&gpu.device, &gpu.queue);
    RgbaImage::from_raw(SIZE.0, SIZE.1, pixels.expect("read")).expect("as large")
}

fn views() -> Vec<(&'static str, EyeView)> {
    let at = Geodetic::from_degrees;
    let aspect = f64::from(SIZE.0) / f64::from(SIZE.1);
    vec![
        (
            "horizon",
            tilted(at(12.0, 34.0, 1e3), 70.0, -2.0, 45.0, aspect),
        ),
        ("north pole", down(at(89.0, 10.0, 1e6), 60.0, aspect)),
        (
            "date line",
            tilted(at(-30.0, 179.0, 4e5), 80.0, -30.0, 50.0, aspect),
        ),
        ("whole disc", down(at(20.0, -100.0, 3e7), 26.0, aspect)),
        (
            "beside the Earth",
            tilted(at(0.0, 0.0, 4e5), 0.0, 60.0, 45.0, aspect),
        ),
    ]
}

/// Cells of 22.5°, bright and less bright.
fn is_bright(lat_deg: f64, lon_deg: f64) -> bool {
    let cell = |deg: f64| (deg / 22.5).floor() as i64;
    (cell(lat_deg) + cell(lon_deg)).rem_euclid(2) == 0
}

#[test]
fn the_floor_covers_the_ground_and_samples_where_pixels_look() {
    for samples in [1, 4] {
        for (name, view) in views() {
            let cells = map(1024, |lat_deg, lon_deg| match is_bright(lat_deg, lon_deg) {
                true => [255; 3],
                false => [140; 3],
            });
            let picture = draw(cells, samples, &view);
            let (mut edge, mut compared) = (0, 0);
            for (x, y, pixel) in picture.enumerate_pixels() {
                let place = looks_at(&view, x, y, SIZE);
                if place.is_some() != (pixel.0[0] > 0) {
                    edge += 1;
                    continue;
                }
                let Some(place) = place else { continue };
                let (lat, lon) = (place.lat_rad.to_degrees(), place.lon_rad.to_degrees());
                // Away from the limb, where pixels are long, and from the cells' edges.
                let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
                if name != "horizon" && -up.dot(ray(&view, x, y, SIZE)) < 0.35 {
                    continue;
                }
                let off = |deg: f64| (deg / 22.5 - (deg / 22.5).round()).abs() * 22.5;
                let wide = if name == "whole disc" { 6.0 } else { 1.5 };
                if off(lat) < wide || off(lon) * lat.to_radians().cos() < wide {
                    continue;
                }
                // A fifth of linear light: 123 of 255 for white, 64 for the other.
                assert_eq!(
                    pixel.0[0] > 95,
                    is_bright(lat, lon),
                    "{name}, {samples}: {x} {y} {pixel:?}"
                );
                compared += 1;
            }
            println!("{name}: {compared} pixels compared, {edge} at the edge");
            // A pixel that is covered in part is lit, though its middle looks past the Earth.
            let most = if samples == 1 { 4 } else { 200 };
            assert!(
                edge <= most,
                "{name}, {samples}: {edge} pixels covered otherwise"
            );
            let sees = name != "beside the Earth";
            assert_eq!(compared > 500, sees, "{name}: {compared}");
        }
    }
}

/// Texels interleaved from bright to dark: pixels larger than texels are grey, smaller ones are one or the other.
#[test]
fn the_floor_reads_the_mip_level_of_the_pixels_footprint() {
    let texels = |lat_deg: f64, lon_deg: f64| {
        let texel = |deg: f64| (deg / 360.0 * 1024.0).floor() as i64;
        [if (texel(lon_deg) + texel(lat_deg)).rem_euclid(2) == 0 {
            255
        } else {
            60
        }; 3]
    };
    let contrast = |height_m: f64, fov_deg: f64| {
        let view = down(
            Geodetic::from_degrees(10.0, 20.0, height_m),
            fov_deg,
            16.0 / 9.0,
        );
        let picture = draw(map(1024, texels), 1, &view);
        let middle = (60..132).flat_map(|x| (30..78).map(move |y| (x, y)));
        let values: Vec<_> = middle.map(|(x, y)| picture.get_pixel(x, y).0[0]).collect();
        let (least, most) = (values.iter().min(), values.iter().max());
        most.expect("pixels").abs_diff(*least.expect("pixels"))
    };
    // A texel is 39 km wide.
    let (near, far) = (contrast(3e5, 60.0), contrast(2e7, 30.0));
    println!("contrast {near} of pixels of 3 km, {far} of 100 km");
    assert!(near > 60, "{near}");
    assert!(far < 12, "{far}");
}
