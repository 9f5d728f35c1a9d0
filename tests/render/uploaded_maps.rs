//! Maps that are on the GPU before Earths are made with them: drawn as those in memory, held once, and never for another shading or size.

use crate::common::{self, Rig, gpu, map, tilted};
use glam::DVec3;
use image::RgbaImage;
use terrella::frames::Geodetic;
use terrella::{
    Earth, EarthError, EarthOptions, EyeView, LayerSelection, MapError, MapUploader, Shading,
    load_layers, load_layers_to,
};
use terrella_imagery::tile::MapLayer;
use terrella_imagery::{EarthLayers, LayerImage};

const SIZE: (u32, u32) = (160, 90);
const SUN: DVec3 = DVec3::new(0.8, 0.6, 0.0);

fn view() -> EyeView {
    let place = Geodetic::from_degrees(20.0, 30.0, 6e6);
    tilted(place, 0.0, -90.0, 60.0, 16.0 / 9.0)
}

fn drawn(options: &EarthOptions) -> RgbaImage {
    Rig::new(options, SIZE).draw(&view(), SUN).0
}

/// Maps of which some are not as high as a power of two, with a coast, clouds and slopes.
fn layers() -> EarthLayers {
    let texel = |n: u32| (n.wrapping_mul(2_654_435_761) >> 24) as u8;
    let water = (0..256 * 128).map(|n| if n % 256 < 130 { 255 } else { 0 });
    let clouds = (0..100 * 50).map(|n| texel(n % 100 / 9 + 100 * (n / 900)));
    EarthLayers {
        water: Some(LayerImage::from_r8(256, 128, water.collect()).expect("a sound map")),
        clouds: Some(LayerImage::from_r8(100, 50, clouds.collect()).expect("a sound map")),
        normals: Some(LayerImage::from_slopes(64, 32, vec![9; 64 * 32 * 2]).expect("a sound map")),
        ..common::day_only(map(128, |lat, lon| {
            [(lat + 90.0) as u8, (lon.abs() / 2.0) as u8, 90]
        }))
    }
}

#[test]
fn uploaded_maps_are_drawn_as_those_in_memory_and_shared() {
    let gpu = gpu();
    let in_memory = EarthOptions::new(layers());
    let expected = drawn(&in_memory);
    let mut options = in_memory.clone();
    options.upload(&gpu.device, &gpu.queue).expect("sound maps");
    for layer in MapLayer::ALL {
        let (described, whole) = (options.layers.get(layer), in_memory.layers.get(layer));
        assert_eq!(described.is_some(), whole.is_some());
        assert_eq!(options.uploaded.get(layer).is_some(), whole.is_some());
        let Some((described, whole)) = described.zip(whole) else {
            continue;
        };
        assert!(!described.has_texels() && whole.has_texels(), "{layer:?}");
        assert_eq!(described.bytes(), whole.bytes());
        let held = options.uploaded.get(layer).expect("it is there");
        assert_eq!(held.bytes(), whole.bytes());
    }
    assert!(drawn(&options) == expected);
    // Clones of options, and Earths made with them.
    assert!(drawn(&options.clone()) == expected);
    // A map in memory counts before one that was uploaded.
    options.layers.day = map(128, |_, _| [200, 30, 30]);
    let mut other = in_memory.clone();
    other.layers.day = options.layers.day.clone();
    let red = drawn(&other);
    assert!(red != expected && drawn(&options) == red);
    options
        .upload(&gpu.device, &gpu.queue)
        .expect("a sound map");
    assert!(!options.layers.day.has_texels() && drawn(&options) == red);
}

#[test]
fn maps_of_a_folder_go_to_the_gpu_as_they_are_read() {
    let gpu = gpu();
    let folder = tempfile::tempdir().expect("a folder");
    // Day maps of a height that is a power of two, whose rows come from the south, and of one that is not.
    for height in [128, 75] {
        let width = 2 * height;
        let day = image::RgbImage::from_fn(width, height, |x, y| {
            image::Rgb([(x * 3) as u8, (y * 5) as u8, (x ^ y) as u8])
        });
        day.save(folder.path().join("day.png")).expect("writes");
        let grey = |name: &str, value: fn(u32, u32) -> u8| {
            let map =
                image::GrayImage::from_fn(2 * width, 2 * height, |x, y| image::Luma([value(x, y)]));
            map.save(folder.path().join(name)).expect("writes");
        };
        grey("water.png", |x, y| {
            if (x / 40 + y / 30) % 2 == 0 { 255 } else { 0 }
        });
        grey("clouds.png", |x, y| (x * y / 64) as u8);
        grey("night_lights.png", |x, _| (x % 7) as u8);
        let heights = image::ImageBuffer::from_fn(width, height, |x, y| {
            image::Luma([10_980 + ((x * 7 + y * 3) % 900) as u16])
        });
        heights
            .save(folder.path().join("elevation.png"))
            .expect("writes");
        let all = LayerSelection::default();
        let whole = load_layers(folder.path(), all).expect("sound maps");
        let expected = drawn(&EarthOptions::new(whole.clone()));
        let uploader = MapUploader::new(&gpu.device, &gpu.queue, Shading::Sunlit);
        let (layers, damaged) = load_layers_to(folder.path(), all, &uploader).expect("sound maps");
        assert!(damaged.is_empty());
        for layer in MapLayer::ALL {
            let described = layers.get(layer).expect("all are there");
            let image = whole.get(layer).expect("all are there");
            assert_eq!(*described, image.without_texels());
        }
        let options = EarthOptions {
            uploaded: uploader.finish().expect("the device takes them"),
            ..EarthOptions::new(layers)
        };
        assert!(drawn(&options) == expected, "{height}");
    }
}

#[test]
fn a_description_that_no_uploaded_map_fits_is_an_error() {
    let gpu = gpu();
    let made = |options: &EarthOptions| Earth::new(&gpu.device, &gpu.queue, options).map(drop);
    let mut options = EarthOptions::new(layers());
    let uploaded = {
        let mut options = options.clone();
        options.upload(&gpu.device, &gpu.queue).expect("sound maps");
        options
    };
    options.layers.day = options.layers.day.without_texels();
    assert!(matches!(made(&options), Err(EarthError::Layer(_))));
    let unfit = |options: &EarthOptions, word: &str| {
        let error = made(options).expect_err("it does not fit");
        let is_unfit = matches!(error, EarthError::Map(MapError::Unfit { layer: "day", .. }));
        assert!(is_unfit && error.to_string().contains(word), "{error}");
    };
    let mut other = uploaded.clone();
    other.shading = Shading::Paper;
    unfit(&other, "another shading");
    // Of the same adapter: devices of two instances of wgpu cannot be distinguished.
    let adapter = &gpu.adapter;
    let elsewhere = pollster::block_on(adapter.request_device(&Default::default()));
    let (device, queue) = elsewhere.expect("a second device");
    let mut other = EarthOptions::new(layers());
    other.upload(&device, &queue).expect("sound maps");
    unfit(&other, "another device");
    let mut other = uploaded.clone();
    other.layers.day.width /= 2;
    unfit(&other, "128 × 64");
    made(&uploaded).expect("they fit");
}
