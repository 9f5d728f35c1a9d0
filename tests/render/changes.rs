//! Changes while the Earth is drawn: maps, quality prepared by another thread, and a lost device.

use crate::common::{self, Rig, gpu, map, tilted};
use glam::DVec3;
use image::RgbaImage;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use terrella::frames::Geodetic;
use terrella::{
    Earth, EarthError, EarthOptions, EyeView, FrameRequest, FrameTargets, GpuContext, GpuMap,
    MapError, MapFade, MapUploader, Quality, Shading, Sky,
};
use terrella_imagery::tile::MapLayer;
use terrella_imagery::{EarthLayers, LayerImage, TexelFormat};

const SIZE: (u32, u32) = (160, 90);

fn view() -> EyeView {
    let place = Geodetic::from_degrees(20.0, 30.0, 6e6);
    tilted(place, 0.0, -90.0, 60.0, 16.0 / 9.0)
}

const SUN: DVec3 = DVec3::new(0.8, 0.6, 0.0);

fn clouds(seed: u32) -> LayerImage {
    let texel = |n: u32| (n.wrapping_add(seed).wrapping_mul(2_654_435_761) >> 24) as u8;
    let coarse = |n: u32| texel(n % 128 / 16 + 8 * (n / 128 / 16));
    let texels = (0..128 * 64).map(coarse).collect();
    LayerImage::from_r8(128, 64, texels).expect("a sound map")
}

fn layers(clouds: LayerImage) -> EarthLayers {
    EarthLayers {
        clouds: Some(clouds),
        ..common::day_only(map(128, |lat, lon| {
            [(lat + 90.0) as u8, (lon.abs() / 2.0) as u8, 90]
        }))
    }
}

fn drawn_with(clouds: LayerImage) -> RgbaImage {
    let options = EarthOptions::new(layers(clouds));
    Rig::new(&options, SIZE).draw(&view(), SUN).0
}

fn upload(layer: MapLayer, image: &LayerImage) -> GpuMap {
    let gpu = gpu();
    GpuMap::upload(&gpu.device, &gpu.queue, layer, image, Shading::Sunlit).expect("a sound map")
}

/// The largest difference of two pictures.
fn apart(a: &RgbaImage, b: &RgbaImage) -> u8 {
    let pairs = a.as_raw().iter().zip(b.as_raw());
    pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

#[test]
fn another_map_is_drawn_as_if_it_had_been_there_from_the_start() {
    let (first, second) = (clouds(1), clouds(34));
    let mut rig = Rig::new(&EarthOptions::new(layers(first.clone())), SIZE);
    let (before, stats) = rig.draw(&view(), SUN);
    let map = std::thread::spawn({
        let second = second.clone();
        move || upload(MapLayer::Clouds, &second)
    });
    let map = map.join().expect("no panic");
    rig.earth
        .set_map(&common::gpu().queue, &map)
        .expect("it has clouds");
    let (after, stats_after) = rig.draw(&view(), SUN);
    let made_so = drawn_with(second);
    assert!(
        apart(&before, &made_so) > 20,
        "the maps must differ: {}",
        apart(&before, &made_so)
    );
    assert!(after == made_so);
    assert_eq!(stats.texture_bytes, stats_after.texture_bytes);
    rig.earth
        .set_map(&common::gpu().queue, &upload(MapLayer::Clouds, &first))
        .expect("it has clouds");
    assert!(rig.draw(&view(), SUN).0 == before);
}

/// A day map, clouds and a coast at 20° E, of this width.
fn all_layers(width: u32, seed: u32) -> EarthLayers {
    let water = |n: u32| match n % width > width * 5 / 9 {
        true => 0,
        false => 255,
    };
    let water = (0..width * width / 2).map(water).collect();
    EarthLayers {
        clouds: Some(clouds(seed)),
        water: Some(LayerImage::from_r8(width, width / 2, water).expect("a sound map")),
        ..common::day_only(map(width, |lat, lon| {
            [(lat + 90.0) as u8, (lon.abs() / 2.0) as u8, seed as u8]
        }))
    }
}

#[test]
fn finer_maps_are_drawn_as_if_they_had_been_there_from_the_start() {
    let gpu = gpu();
    let mut rig = Rig::new(&EarthOptions::new(all_layers(128, 1)), SIZE);
    let (before, _) = rig.draw(&view(), SUN);
    let finer = all_layers(1024, 34);
    let expected = Rig::new(&EarthOptions::new(finer.clone()), SIZE).draw(&view(), SUN);
    assert!(apart(&before, &expected.0) > 20, "the maps must differ");

    let uploader = MapUploader::new(&gpu.device, &gpu.queue, Shading::Sunlit);
    for layer in MapLayer::ALL {
        let Some(image) = finer.get(layer) else {
            continue;
        };
        let rows = uploader.rows(layer, (image.width, image.height), image.format);
        let mut rows = rows.expect("a device takes such maps");
        image.rows_to(&mut *rows);
        rows.finish();
    }
    // A map whose rows break off is left out.
    drop(uploader.rows(MapLayer::NightLights, (128, 64), TexelFormat::R8Unorm));
    let maps = uploader.finish().expect("sound maps");
    assert!(maps.get(MapLayer::NightLights).is_none());
    rig.earth
        .set_maps(&gpu.queue, &maps)
        .expect("the same maps");
    let (after, stats) = rig.draw(&view(), SUN);
    assert!(after == expected.0);
    assert_eq!(stats.texture_bytes, expected.1.texture_bytes);
    assert_eq!(stats.draw_calls, expected.1.draw_calls);

    let error = Rig::new(
        &EarthOptions::new(common::day_only(map(128, |_, _| [9; 3]))),
        SIZE,
    )
    .earth
    .set_maps(&gpu.queue, &maps)
    .expect_err("it has no clouds");
    assert!(
        matches!(error, EarthError::Map(MapError::NotDrawn(_))),
        "{error}"
    );
}

#[test]
fn a_fade_begins_with_one_map_and_ends_with_the_other() {
    let gpu = gpu();
    let (first, second) = (clouds(1), clouds(34));
    let mut rig = Rig::new(&EarthOptions::new(layers(first.clone())), SIZE);
    let [from, to] = [&first, &second].map(|image| upload(MapLayer::Clouds, image));
    let fade = MapFade::new(&gpu.device, MapLayer::Clouds, (128, 64)).expect("drawn to");
    // 128 × 64 texels of a byte, and seven levels below.
    let bytes = [8192, 2048, 512, 128, 32, 8, 2, 1];
    assert_eq!(fade.map().bytes(), bytes.iter().sum::<u64>());
    let set = |map: &GpuMap, rig: &mut Rig| {
        rig.earth
            .set_map(&common::gpu().queue, map)
            .expect("it has clouds");
        rig.draw(&view(), SUN).0
    };
    let ends = [set(&from, &mut rig), set(&to, &mut rig)];
    // The clouds' contribution to the light of the air stays that of the last uploaded map.
    let mut faded = |weight, base: &GpuMap| {
        set(base, &mut rig);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        fade.draw(&gpu.device, &gpu.queue, &mut encoder, (&from, &to), weight);
        gpu.queue.submit([encoder.finish()]);
        set(fade.map(), &mut rig)
    };
    assert!(apart(&faded(0.0, &from), &ends[0]) <= 1);
    assert!(apart(&faded(1.0, &to), &ends[1]) <= 1);
    assert!(apart(&faded(f32::NAN, &from), &ends[0]) <= 1);
    let half = faded(0.5, &from);
    // Where the two differ most.
    let differ = |n: &usize| ends[0].as_raw()[*n].abs_diff(ends[1].as_raw()[*n]);
    let most = (0..half.as_raw().len()).max_by_key(differ).expect("pixels");
    let [a, b, between] = [&ends[0], &ends[1], &half].map(|p| p.as_raw()[most]);
    assert!(a.abs_diff(b) > 20, "the maps must differ: {a} {b}");
    let (low, high) = (a.min(b), a.max(b));
    assert!((low + 4..high - 3).contains(&between), "{a} {b} {between}");
}

#[test]
fn a_texture_of_the_host_is_a_map() {
    let gpu = gpu();
    let mut rig = Rig::new(&EarthOptions::new(layers(clouds(1))), SIZE);
    let texture = |format, usage, layers| {
        gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("host's clouds"),
            size: wgpu::Extent3d {
                width: 4,
                height: 2,
                depth_or_array_layers: layers,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    };
    use wgpu::{TextureFormat as F, TextureUsages as U};
    let own = texture(F::R8Unorm, U::TEXTURE_BINDING | U::COPY_DST, 1);
    let map = GpuMap::from_texture(MapLayer::Clouds, &own).expect("fit");
    rig.earth
        .set_map(&common::gpu().queue, &map)
        .expect("it has clouds");
    let fill = |cover: u8| {
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4),
            rows_per_image: None,
        };
        gpu.queue
            .write_texture(own.as_image_copy(), &[cover; 8], layout, own.size());
    };
    fill(0);
    let clear = rig.draw(&view(), SUN).0;
    fill(255);
    let covered = rig.draw(&view(), SUN).0;
    let at = |picture: &RgbaImage| picture.get_pixel(SIZE.0 / 2, SIZE.1 / 2).0;
    assert!(
        at(&covered)[0] > at(&clear)[0] + 40,
        "{:?} {:?}",
        at(&clear),
        at(&covered)
    );
    for (bad, word) in [
        (texture(F::R8Unorm, U::COPY_DST, 1), "TEXTURE_BINDING"),
        (texture(F::R8Unorm, U::TEXTURE_BINDING, 2), "one layer"),
        (texture(F::R8Uint, U::TEXTURE_BINDING, 1), "R8Uint"),
    ] {
        let error = GpuMap::from_texture(MapLayer::Clouds, &bad).expect_err("unfit");
        let words = error.to_string();
        assert!(words.contains(word) && words.contains("clouds"), "{words}");
    }
}

#[test]
fn maps_that_cannot_be_drawn_are_rejected_by_name() {
    let gpu = gpu();
    let mut rig = Rig::new(&EarthOptions::new(layers(clouds(1))), SIZE);
    let before = rig.draw(&view(), SUN).0;
    let lights = upload(MapLayer::NightLights, &clouds(3));
    let error = rig
        .earth
        .set_map(&common::gpu().queue, &lights)
        .expect_err("made without");
    assert!(
        matches!(error, EarthError::Map(MapError::NotDrawn("night_lights"))),
        "{error}"
    );
    for (layer, size) in [
        (MapLayer::Normals, (16, 8)),
        (MapLayer::Clouds, (0, 8)),
        (MapLayer::Clouds, (1 << 30, 8)),
    ] {
        let error = MapFade::new(&gpu.device, layer, size)
            .err()
            .expect("rejected");
        assert!(error.to_string().contains(layer.name()), "{error}");
    }
    assert!(rig.draw(&view(), SUN).0 == before);
}

#[test]
fn a_quality_is_made_by_another_thread_while_frames_go_on() {
    let options = EarthOptions::new(layers(clouds(1)));
    let gpu = gpu();
    let mut rig = Rig::new(&options, SIZE);
    let before = rig.draw(&view(), SUN).0;
    let quality = Quality {
        subdivision: terrella::Subdivision::Cells(6),
        maps: [true, false, true, true, true],
        ..*rig.earth.quality()
    };
    let maker = rig.earth.change_maker(&gpu.queue);
    let late = maker.quality(&quality).expect("a sound quality");
    let made = std::thread::spawn(move || maker.quality(&quality));
    assert!(rig.draw(&view(), SUN).0 == before);
    let ready = made.join().expect("no panic").expect("a sound quality");
    assert_eq!(ready.quality(), &quality);
    assert!(rig.draw(&view(), SUN).0 == before);
    rig.earth
        .set_ready(&gpu.queue, ready)
        .expect("of this Earth");
    assert_eq!(rig.earth.quality(), &quality);
    let mut set = Rig::new(&options, SIZE);
    set.set_quality(&quality);
    let after = rig.draw(&view(), SUN).0;
    assert!(after != before && after == set.draw(&view(), SUN).0);
    // A change prepared for the Earth's earlier state is rejected, and so is one for another Earth.
    let foreign = rig.earth.change_maker(&gpu.queue).quality(&quality);
    let foreign = set.earth.set_ready(&gpu.queue, foreign.expect("sound"));
    assert!(matches!(foreign, Err(EarthError::OutOfDate)));
    let error = rig.earth.set_ready(&gpu.queue, late);
    assert!(matches!(error, Err(EarthError::OutOfDate)));
    assert!(rig.draw(&view(), SUN).0 == after);
}

#[test]
fn a_lost_device_is_survived_by_an_earth_of_the_same_options() {
    let open = || pollster::block_on(GpuContext::open(Some("llvmpipe")));
    let Ok(lost) = open().or_else(|_| pollster::block_on(GpuContext::open(None))) else {
        panic!("an adapter is needed");
    };
    let options = EarthOptions::new(layers(clouds(1)));
    let sky = Sky::new(SUN);
    let draw = |gpu: &GpuContext, earth: &mut Earth| {
        let targets = FrameTargets::new(&gpu.device, SIZE, 1);
        earth.prepare(&gpu.queue, FrameRequest::new(&view(), &sky, SIZE));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        earth.render(&mut targets.begin_pass(&mut encoder));
        gpu.queue.submit([encoder.finish()]);
        targets.read_back(&gpu.device, &gpu.queue)
    };
    let mut earth = Earth::new(&lost.device, &lost.queue, &options).expect("sound options");
    let before = draw(&lost, &mut earth).expect("a picture");
    // As a host must: without a handler wgpu panics at an uncaptured error.
    let errors = Arc::new(AtomicU32::new(0));
    let counted = errors.clone();
    let count = move |_: wgpu::Error| {
        counted.fetch_add(1, Ordering::Relaxed);
    };
    lost.device.on_uncaptured_error(Arc::new(count));
    lost.device.destroy();
    // The frame in which the host is notified, and further calls: nothing panics, whatever they return.
    for _ in 0..2 {
        earth.prepare(&lost.queue, FrameRequest::new(&view(), &sky, SIZE));
        let quality = *earth.quality();
        let _whatever = earth.set_quality(&lost.queue, &quality);
        let _whatever = earth.new_view();
    }
    assert!(errors.load(Ordering::Relaxed) > 0, "it was lost");
    let _whatever = Earth::new(&lost.device, &lost.queue, &options);
    let again = open().or_else(|_| pollster::block_on(GpuContext::open(None)));
    let again = again.expect("a device");
    let mut earth = Earth::new(&again.device, &again.queue, &options).expect("sound options");
    assert!(draw(&again, &mut earth).expect("a picture") == before);
}
