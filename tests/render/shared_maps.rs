//! Earths of one program have one device and one copy of their maps, as long as one of them uses it.

use crate::common;
use image::RgbImage;
use std::fs;
use std::path::Path;
use terrella::frames::Geodetic;
use terrella::{
    EarthLayers, EarthOptions, EyeView, LayerSelection, MapError, MapUploader, OffscreenEarth,
    Shading, Sky, UploadedMaps, load_layers_to, wgpu,
};

const SIZE: (u32, u32) = (64, 36);
const DAY_ONLY: LayerSelection = LayerSelection {
    clouds: false,
    normals: false,
    night_lights: false,
    water: false,
};

fn write_day(folder: &Path, color: [u8; 3]) {
    let map = RgbImage::from_pixel(64, 32, image::Rgb(color));
    map.save(folder.join("day.png")).expect("written");
}

fn earth(
    gpu: terrella::GpuContext,
    (layers, uploaded): (EarthLayers, UploadedMaps),
) -> OffscreenEarth {
    let options = EarthOptions {
        uploaded,
        atmosphere: terrella::Atmosphere::None,
        ..EarthOptions::new(layers)
    };
    OffscreenEarth::new(gpu, options, SIZE).expect("an Earth")
}

/// Red, green and blue in the middle of an image.
fn middle(earth: &mut OffscreenEarth) -> [u8; 3] {
    let view: EyeView = common::tilted(
        Geodetic::from_degrees(0.0, 0.0, 2e7),
        0.0,
        -90.0,
        40.0,
        16.0 / 9.0,
    );
    let mut rgba = vec![0; 4 * (SIZE.0 * SIZE.1) as usize];
    let sky = Sky::at(terrella::Epoch::from_gregorian_utc_at_noon(2018, 3, 20));
    let drawn = earth.draw_color(&view, &sky, std::time::Duration::ZERO, &mut rgba);
    drawn.expect("drawn");
    let at = 4 * ((SIZE.1 / 2) * SIZE.0 + SIZE.0 / 2) as usize;
    [rgba[at], rgba[at + 1], rgba[at + 2]]
}

fn day_texture(maps: &(EarthLayers, UploadedMaps)) -> wgpu::TextureView {
    let map = maps.1.get(terrella::MapLayer::Day);
    map.expect("a day map").view().clone()
}

#[test]
fn earths_share_device_and_maps_while_one_uses_them() {
    let folder = tempfile::tempdir().expect("a folder");
    write_day(folder.path(), [200, 20, 20]);
    let gpu = OffscreenEarth::open_gpu(None).expect("an adapter");
    let maps = || OffscreenEarth::shared_layers(&gpu, folder.path(), DAY_ONLY).expect("sound maps");
    let first = maps();
    let texture = day_texture(&first);
    let mut one = earth(gpu.clone(), first);
    let mut other = earth(OffscreenEarth::open_gpu(None).expect("an adapter"), maps());
    assert!(one.gpu().device == other.gpu().device);
    assert!(texture == day_texture(&maps()), "one copy");
    let red = middle(&mut one);
    assert!(red[0] > red[1] + 50, "{red:?}");
    assert_eq!(middle(&mut other), red);

    // One that is left keeps them; after the last they are read again.
    drop(one);
    assert!(texture == day_texture(&maps()));
    assert_eq!(middle(&mut other), red);
    drop(other);
    assert!(texture != day_texture(&maps()));
}

#[test]
fn changed_files_and_other_variants_are_read_again() {
    let folder = tempfile::tempdir().expect("a folder");
    write_day(folder.path(), [200, 20, 20]);
    let gpu = OffscreenEarth::open_gpu(None).expect("an adapter");
    let file = folder.path().join("day.png");
    let mut reads = 0;
    let mut maps = |variant: &str| {
        let files = vec![file.clone()];
        OffscreenEarth::shared_maps(&gpu, files, variant.to_owned(), || {
            reads += 1;
            let uploader = MapUploader::new(&gpu.device, &gpu.queue, Shading::default());
            let (layers, _) = load_layers_to(folder.path(), DAY_ONLY, &uploader)?;
            Ok::<_, MapError>((layers, uploader.finish()?))
        })
    };
    let kept = [maps("a"), maps("a"), maps("b")].map(|maps| maps.expect("sound maps"));
    let mut red = earth(gpu.clone(), kept[0].clone());
    write_day(folder.path(), [20, 20, 200]);
    let later = fs::File::options().append(true).open(&file).expect("there");
    let time = std::time::SystemTime::now() + std::time::Duration::from_secs(5);
    later.set_modified(time).expect("touched");
    let mut blue = earth(gpu.clone(), maps("a").expect("sound maps"));
    let colors = [middle(&mut red), middle(&mut blue)];
    assert!(
        colors[0][0] > colors[0][2] && colors[1][2] > colors[1][0],
        "{colors:?}"
    );

    // A failed read leaves nothing behind.
    fs::write(&file, "no picture").expect("written");
    assert!(maps("a").is_err() && maps("a").is_err());
    assert_eq!(reads, 5);
}
