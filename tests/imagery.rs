//! Reading folders of maps: only the selected maps are read; every kind of bad file is reported by name.

use image::{DynamicImage, ImageBuffer, ImageFormat};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use tempfile::TempDir;
use terrella_imagery::tile::MapLayer;
use terrella_imagery::{
    EarthLayers, ImageryError, KeptInMemory, LayerSelection, MapRows, MapSink, SLOPE_EXAGGERATION,
    TexelFormat, load_layers, load_layers_to, load_whole_layers, slopes_from_elevation,
};

const WIDTH: u32 = 64;
const HEIGHT: u32 = 32;

/// Held by tests that load the starter pack: one of them looks at how much memory that takes.
static HEAVY: Mutex<()> = Mutex::new(());

fn starter_pack() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("textures")
}

/// A folder with four good little maps.
fn good_folder() -> TempDir {
    let dir = tempfile::tempdir().expect("temporary folder");
    let save = |picture: DynamicImage, name: &str, format| {
        picture
            .save_with_format(dir.path().join(name), format)
            .expect("temporary file");
    };
    let day = ImageBuffer::from_fn(WIDTH, HEIGHT, |x, y| {
        image::Rgb([(x * 4) as u8, (y * 8) as u8, 90])
    });
    save(DynamicImage::ImageRgb8(day), "day.jpg", ImageFormat::Jpeg);
    let grey = |value: u8| {
        DynamicImage::ImageLuma8(ImageBuffer::from_fn(WIDTH, HEIGHT, |x, _| {
            image::Luma([value.wrapping_add(x as u8)])
        }))
    };
    save(grey(100), "clouds.png", ImageFormat::Png);
    save(grey(7), "night_lights.png", ImageFormat::Png);
    let elevation = ImageBuffer::from_fn(WIDTH, HEIGHT, |_, y| {
        image::Luma([11_000 + (HEIGHT - y) as u16 * 1_600])
    });
    save(
        DynamicImage::ImageLuma16(elevation),
        "elevation.png",
        ImageFormat::Png,
    );
    dir
}

fn load_all(dir: &Path) -> Result<EarthLayers, ImageryError> {
    load_layers(dir, LayerSelection::default())
}

const DAY_ONLY: LayerSelection = LayerSelection {
    clouds: false,
    normals: false,
    night_lights: false,
    water: false,
};

/// Loads a folder in which `name` was replaced, expects failure, and checks that the message names the file.
fn error_with(name: &str, contents: &[u8]) -> (ImageryError, String) {
    let dir = good_folder();
    std::fs::write(dir.path().join(name), contents).expect("temporary file");
    let error = load_all(dir.path()).expect_err("a bad map must be rejected");
    let text = error.to_string();
    assert!(text.contains(name), "the message must name {name}: {text}");
    assert!(!text.contains('\n'), "one line: {text}");
    (error, text)
}

fn good_bytes(name: &str) -> Vec<u8> {
    std::fs::read(good_folder().path().join(name)).expect("temporary file")
}

#[test]
fn a_good_folder_gives_all_layers_with_their_levels() {
    let dir = good_folder();
    let layers = load_all(dir.path()).expect("good maps");
    let clouds = layers.clouds.as_ref().expect("selected");
    let normals = layers.normals.as_ref().expect("selected");
    let lights = layers.night_lights.as_ref().expect("selected");
    let all = [&layers.day, clouds, normals, lights];
    for map in all {
        map.check().expect("complete");
        assert_eq!((map.width, map.height, map.levels.len()), (64, 32, 7));
    }
    assert_eq!(layers.day.format, TexelFormat::Rgba8Srgb);
    assert_eq!(clouds.format, TexelFormat::R8Unorm);
    assert_eq!(normals.format, TexelFormat::Rg8Snorm);
    assert_eq!(lights.format, TexelFormat::R8Unorm);
    // Level 0 is what the files hold, north row first, opaque.
    assert_eq!(clouds.levels[0][..3], [100, 101, 102]);
    assert_eq!(lights.levels[0][..3], [7, 8, 9]);
    let last_of_first_row = &layers.day.levels[0][63 * 4..64 * 4];
    assert!(last_of_first_row[0].abs_diff(252) < 20 && last_of_first_row[1] < 20);
    assert!(layers.day.levels[0][31 * 64 * 4 + 1].abs_diff(248) < 20);
    assert!(layers.day.levels[0].chunks(4).all(|texel| texel[3] == 255));
    // The land rises towards the north everywhere.
    let middle = &normals.levels[0][(16 * 64 + 20) * 2..][..2];
    assert!(middle[0] == 0 && middle[1] as i8 > 0, "{middle:?}");
    assert_eq!(
        layers.texture_bytes(),
        (2048 + 512 + 128 + 32 + 8 + 2 + 1) * (4 + 1 + 2 + 1)
    );
}

#[test]
fn what_is_not_selected_is_not_even_opened() {
    let dir = good_folder();
    for name in ["clouds.png", "night_lights.png", "elevation.png"] {
        std::fs::remove_file(dir.path().join(name)).expect("temporary file");
    }
    let layers = load_layers(dir.path(), DAY_ONLY).expect("only the day map is wanted");
    assert!(layers.clouds.is_none() && layers.normals.is_none() && layers.night_lights.is_none());
    assert_eq!(layers.texture_bytes(), layers.day.bytes());
}

#[test]
fn a_png_day_map_serves_too() {
    let dir = good_folder();
    std::fs::remove_file(dir.path().join("day.jpg")).expect("temporary file");
    for (picture, first) in [
        (DynamicImage::new_luma8(4, 2), [0, 0, 0, 255]),
        (DynamicImage::new_luma_a8(4, 2), [0, 0, 0, 255]),
        (DynamicImage::new_rgb8(4, 2), [0, 0, 0, 255]),
        // Alpha marks the texel as transparent; the day map is opaque nevertheless.
        (DynamicImage::new_rgba8(4, 2), [0, 0, 0, 255]),
    ] {
        picture
            .save(dir.path().join("day.png"))
            .expect("temporary file");
        let layers = load_layers(dir.path(), DAY_ONLY).expect("good map");
        assert_eq!((layers.day.width, layers.day.height), (4, 2));
        assert_eq!(layers.day.levels[0][..4], first);
    }
}

#[test]
fn clouds_may_be_a_jpeg() {
    let dir = good_folder();
    let path = dir.path().join("clouds.png");
    let grey = image::open(&path).expect("a map");
    std::fs::remove_file(path).expect("temporary file");
    let jpeg = dir.path().join("clouds.jpg");
    grey.save_with_format(&jpeg, ImageFormat::Jpeg)
        .expect("temporary file");
    assert!(
        LayerSelection::default()
            .files_in(dir.path())
            .contains(&jpeg)
    );
    let missing = LayerSelection::default().missing_in(dir.path());
    assert!(
        missing.iter().all(|(_, name)| *name == "water.png"),
        "{missing:?}"
    );
    let clouds = load_all(dir.path())
        .expect("good maps")
        .clouds
        .expect("clouds");
    assert!(clouds.levels[0][0].abs_diff(100) < 9);
}

#[test]
fn a_missing_map_is_named() {
    for name in ["day.jpg", "clouds.png", "night_lights.png", "elevation.png"] {
        let dir = good_folder();
        std::fs::remove_file(dir.path().join(name)).expect("temporary file");
        let error = load_all(dir.path()).expect_err("missing");
        assert!(matches!(error, ImageryError::Missing { .. }), "{error}");
        let text = error.to_string();
        assert!(text.contains(name) && text.contains("missing"), "{text}");
    }
}

#[test]
fn a_folder_in_place_of_a_map_is_rejected() {
    let dir = good_folder();
    let path = dir.path().join("clouds.png");
    std::fs::remove_file(&path).expect("temporary file");
    std::fs::create_dir(&path).expect("temporary folder");
    let error = load_all(dir.path()).expect_err("not a file");
    assert!(matches!(error, ImageryError::Unreadable { .. }), "{error}");
    assert!(
        error.to_string().contains("it is a folder, not a file"),
        "{error}"
    );
}

#[test]
fn truncated_maps_are_rejected_at_every_length() {
    for name in ["day.jpg", "clouds.png", "night_lights.png", "elevation.png"] {
        let whole = good_bytes(name);
        let last = whole.len() - 1;
        for length in (1..last).step_by(7).chain([last]) {
            let (error, text) = error_with(name, &whole[..length]);
            assert!(
                matches!(
                    error,
                    ImageryError::Damaged { .. } | ImageryError::NotAnImage { .. }
                ),
                "{name} cut to {length}: {text}"
            );
            if length > 64 {
                assert!(text.contains("truncated"), "{name} cut to {length}: {text}");
            }
        }
    }
}

#[test]
fn a_jpeg_whose_preview_is_whole_but_whose_picture_is_cut_is_rejected() {
    let whole = good_bytes("day.jpg");
    // A segment (APP1) that holds an end marker, as a preview picture does, before a cut scan.
    let mut contents = vec![0xFF, 0xD8, 0xFF, 0xE1, 0x00, 0x06, 0xFF, 0xD9, 0xFF, 0xD9];
    contents.extend_from_slice(&whole[2..whole.len() - 2]);
    let (error, text) = error_with("day.jpg", &contents);
    assert!(matches!(error, ImageryError::Damaged { .. }), "{text}");
}

/// Decoders fill the rest with grey where an end marker follows, wherever the data end.
#[test]
fn a_jpeg_that_is_cut_and_closed_again_is_rejected() {
    let texels = image::RgbImage::from_fn(512, 256, |x, y| {
        image::Rgb([
            (x * 7 % 256) as u8,
            (y * 5 % 256) as u8,
            (x * y % 256) as u8,
        ])
    });
    let mut whole = std::io::Cursor::new(Vec::new());
    texels
        .write_to(&mut whole, ImageFormat::Jpeg)
        .expect("in memory");
    let whole = whole.into_inner();
    // The last one lacks the last rows of blocks alone.
    for keep in [whole.len() / 2, whole.len() * 9 / 10, whole.len() - 40] {
        let ended = [&whole[..keep], &[0xFF, 0xD9]].concat();
        let (error, text) = error_with("day.jpg", &ended);
        assert!(matches!(error, ImageryError::Damaged { .. }), "{text}");
        assert!(text.contains("data end at row"), "{keep}: {text}");
    }
}

#[test]
fn pictures_that_are_stored_turned_are_rejected() {
    let whole = good_bytes("day.jpg");
    // Exif with one tag: orientation 3 (Exif 2.32).
    let exif = b"\xFF\xD8\xFF\xE1\x00\x22Exif\0\0MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x03\0\0\0\0\0\0";
    let turned = [exif, &whole[2..]].concat();
    let (error, text) = error_with("day.jpg", &turned);
    assert!(
        matches!(error, ImageryError::Turned { orientation: 3, .. }),
        "{text}"
    );
    assert!(
        text.contains("upside down") && text.contains("-auto-orient"),
        "{text}"
    );
}

/// The usual form of cloud maps: white, with the cover in alpha.
#[test]
fn cover_in_alpha_is_cover() {
    let dir = good_folder();
    let path = dir.path().join("clouds.png");
    let clouds = |picture: DynamicImage| {
        picture.save(&path).expect("temporary file");
        load_all(dir.path())
            .expect("good maps")
            .clouds
            .expect("clouds")
            .levels
    };
    let cover = |x: u32| (4 * x) as u8;
    let grey = image::GrayImage::from_fn(64, 32, |x, _| image::Luma([cover(x)]));
    let grey = clouds(grey.into());
    let white = image::GrayAlphaImage::from_fn(64, 32, |x, _| image::LumaA([255, cover(x)]));
    assert_eq!(clouds(white.into()), grey);
    let white = image::RgbaImage::from_fn(64, 32, |x, _| image::Rgba([255, 255, 255, cover(x)]));
    assert_eq!(clouds(white.into()), grey);
    // Half transparent grey is half as much.
    let half = image::GrayAlphaImage::from_pixel(64, 32, image::LumaA([200, 128]));
    assert_eq!(clouds(half.into())[0][0], 100);
}

#[test]
fn damaged_maps_are_left_out_where_that_is_asked_for() {
    let dir = good_folder();
    let cut = |name: &str| {
        let path = dir.path().join(name);
        let whole = std::fs::read(&path).expect("a map");
        std::fs::write(path, &whole[..whole.len() - 6]).expect("temporary file");
    };
    cut("clouds.png");
    cut("elevation.png");
    let all = LayerSelection::default();
    let (layers, damaged) = load_whole_layers(dir.path(), all).expect("the day map is whole");
    assert!(layers.clouds.is_none() && layers.normals.is_none());
    assert!(layers.night_lights.is_some());
    let names: Vec<_> = damaged.iter().map(|damaged| damaged.layer.name()).collect();
    assert_eq!(names, ["clouds", "normals"]);
    let error = load_all(dir.path()).expect_err("clouds are damaged");
    assert!(error.to_string().contains("clouds.png"), "{error}");
    cut("day.jpg");
    let error = load_whole_layers(dir.path(), all).expect_err("no day map");
    assert!(error.to_string().contains("day.jpg"), "{error}");
}

/// Takes the water map, and keeps nothing of it.
struct WaterElsewhere;

impl MapSink for WaterElsewhere {
    fn begin(&self, layer: MapLayer, _: (u32, u32), _: TexelFormat) -> Option<Box<dyn MapRows>> {
        (layer == MapLayer::Water).then(|| Box::new(Nothing) as Box<dyn MapRows>)
    }
}

struct Nothing;

impl MapRows for Nothing {
    fn rows(&mut self, _: usize, _: u32, _: &[u8]) {}

    fn finish(self: Box<Self>) {}
}

#[test]
fn files_in_memory_are_read_as_those_of_a_folder() {
    let dir = good_folder();
    let all = LayerSelection::default();
    let water = image::GrayImage::from_fn(2 * WIDTH, 2 * HEIGHT, |x, _| {
        image::Luma([if x < WIDTH { 255 } else { 0 }])
    });
    let path = dir.path().join("water.png");
    water.save(path).expect("temporary file");
    let mut files = HashMap::new();
    for entry in std::fs::read_dir(dir.path()).expect("the folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy();
        files.insert(name.into_owned(), std::fs::read(&path).expect("a map"));
    }
    assert_eq!(files.len(), 5);
    let expected = load_all(dir.path()).expect("sound maps");
    let (layers, damaged) = load_layers_to(&files, all, &KeptInMemory).expect("sound maps");
    assert!(damaged.is_empty());
    for layer in MapLayer::ALL {
        assert!(layers.get(layer) == expected.get(layer), "{layer:?}");
    }
    // A water map that is held elsewhere leaves the levels that the day map is made with.
    let (layers, _) = load_layers_to(&files, all, &WaterElsewhere).expect("sound maps");
    assert!(layers.day == expected.day);
    // The sea has its floor without normals too.
    let flat = LayerSelection {
        normals: false,
        ..all
    };
    let (layers, _) = load_layers_to(&files, flat, &KeptInMemory).expect("sound maps");
    assert!(layers.normals.is_none() && layers.day == expected.day);
    // The water map is one of them: without it the day map is another.
    let water = files.remove("water.png");
    let (dry, _) = load_layers_to(&files, all, &KeptInMemory).expect("sound maps");
    assert!(water.is_some() && dry.water.is_none() && dry.day != expected.day);

    let clouds = files.get_mut("clouds.png").expect("clouds");
    clouds.truncate(clouds.len() - 6);
    let (layers, damaged) = load_layers_to(&files, all, &KeptInMemory).expect("a sound day map");
    assert!(layers.clouds.is_none() && damaged.len() == 1);
    assert!(damaged[0].error.to_string().contains("clouds.png"));
    files.remove("day.jpg");
    let error = load_layers_to(&files, all, &KeptInMemory).expect_err("no day map");
    assert!(
        error
            .to_string()
            .starts_with("the day map day.jpg is missing"),
        "{error}"
    );
}

#[test]
fn empty_files_and_other_data_are_no_images() {
    for name in ["day.jpg", "clouds.png", "elevation.png"] {
        for contents in [
            &b""[..],
            b"not an image at all, only words",
            &[0; 4096],
            b"GIF89a\x02\x00\x01\x00",
        ] {
            let (error, text) = error_with(name, contents);
            assert!(matches!(error, ImageryError::NotAnImage { .. }), "{text}");
            assert!(text.contains("not an image"), "{text}");
        }
    }
}

#[test]
fn a_wrong_size_is_named_with_its_numbers() {
    for (width, height) in [(64, 31), (64, 64), (3, 1), (2, 1), (1, 1)] {
        let mut png = std::io::Cursor::new(Vec::new());
        DynamicImage::new_luma8(width, height)
            .write_to(&mut png, ImageFormat::Png)
            .expect("in memory");
        let (error, text) = error_with("clouds.png", png.get_ref());
        assert!(matches!(error, ImageryError::Size { .. }), "{text}");
        assert!(text.contains(&format!("{width} x {height}")), "{text}");
    }
}

/// A PNG that ends after a header which declares a size and 8-bit RGBA texels, and begins its data.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |kind: &[u8; 4], data: &[u8]| {
        png.extend_from_slice(&(data.len() as u32).to_be_bytes());
        let body = [kind.as_slice(), data].concat();
        png.extend_from_slice(&body);
        png.extend_from_slice(&crc32(&body).to_be_bytes());
    };
    let header = [
        width.to_be_bytes().as_slice(),
        &height.to_be_bytes(),
        &[8, 6, 0, 0, 0],
    ]
    .concat();
    chunk(b"IHDR", &header);
    chunk(b"IDAT", &[0x78, 0x9C]);
    png
}

/// CRC-32 of PNG chunks (ISO 3309), bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 }
        })
    })
}

#[test]
fn a_header_that_declares_too_much_is_rejected_before_any_allocation() {
    for (width, height) in [
        (60_000, 30_000),
        (32_770, 16_385),
        (0x7FFF_FFFE, 0x3FFF_FFFF),
    ] {
        let contents = png_header(width, height);
        for name in ["day.jpg", "clouds.png", "elevation.png"] {
            let ((error, text), risen_kib) = memory_risen_kib(|| error_with(name, &contents));
            assert!(matches!(error, ImageryError::Size { .. }), "{text}");
            assert!(text.contains(&format!("{width} x {height}")), "{text}");
            // The declared texels would fill 2 GB and more.
            assert!(risen_kib < 300_000, "{risen_kib} KiB more in use");
        }
    }
}

/// Runs `work` and returns the increase of this process's resident memory during it in KiB, sampled every millisecond; 0 if the system does not
/// report it. Concurrent tests need a few megabytes, one of them 100.
fn memory_risen_kib<T>(work: impl FnOnce() -> T) -> (T, u64) {
    use std::sync::atomic::{AtomicBool, Ordering};
    let resident_kib = || -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let value = line.map(|line| line.trim().trim_end_matches(" kB").parse());
        value.and_then(Result::ok).unwrap_or(0)
    };
    struct EndsWatch<'a>(&'a AtomicBool);
    impl Drop for EndsWatch<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Relaxed);
        }
    }
    let done = &AtomicBool::new(false);
    let before = resident_kib();
    std::thread::scope(|scope| {
        let watch = scope.spawn(move || {
            let mut peak = before;
            while !done.load(Ordering::Relaxed) {
                peak = peak.max(resident_kib());
                std::thread::sleep(std::time::Duration::from_millis(1));
            }
            peak - before
        });
        // Dropped also if the work panics: the scope would wait for the watch for ever.
        let ends_watch = EndsWatch(done);
        let result = work();
        drop(ends_watch);
        (result, watch.join().expect("the watch does not panic"))
    })
}

#[test]
fn the_wrong_kind_of_texel_is_named_with_the_right_one() {
    let png = |picture: DynamicImage| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        picture
            .write_to(&mut bytes, ImageFormat::Png)
            .expect("in memory");
        bytes.into_inner()
    };
    for (name, picture, found, needed) in [
        (
            "elevation.png",
            DynamicImage::new_luma8(64, 32),
            "8-bit grey",
            "16-bit grey",
        ),
        (
            "elevation.png",
            DynamicImage::new_rgb16(64, 32),
            "16-bit colour",
            "16-bit grey",
        ),
        (
            "clouds.png",
            DynamicImage::new_luma16(64, 32),
            "16-bit grey",
            "8-bit grey",
        ),
        (
            "night_lights.png",
            DynamicImage::new_rgb8(64, 32),
            "8-bit colour",
            "8-bit grey",
        ),
        (
            "day.jpg",
            DynamicImage::new_rgb16(64, 32),
            "16-bit colour",
            "8-bit colour",
        ),
    ] {
        let (error, text) = error_with(name, &png(picture));
        assert!(matches!(error, ImageryError::TexelKind { .. }), "{text}");
        let (found_at, needed_at) = (text.find(found), text.rfind(needed));
        assert!(found_at.is_some() && found_at < needed_at, "{text}");
    }
}

#[test]
fn the_starter_pack_loads_in_little_memory() {
    let _alone = HEAVY.lock().unwrap_or_else(PoisonError::into_inner);
    let dir = starter_pack();
    let started = std::time::Instant::now();
    let (layers, risen_kib) = memory_risen_kib(|| load_all(&dir));
    eprintln!("starter pack: {:?}, {risen_kib} KiB", started.elapsed());
    let layers = layers.expect("the starter pack is good");
    let sizes = [
        Some(&layers.day),
        layers.clouds.as_ref(),
        layers.normals.as_ref(),
        layers.night_lights.as_ref(),
    ]
    .map(|map| map.map(|map| (map.width, map.height)));
    let (large, small) = (Some((4096, 2048)), Some((2048, 1024)));
    assert_eq!(sizes, [large, large, small, small]);
    // 64 MB remain.
    assert!(risen_kib < 300_000, "{risen_kib} KiB more in use");
}

#[test]
fn no_slope_of_the_starter_pack_saturates() {
    let _alone = HEAVY.lock().unwrap_or_else(PoisonError::into_inner);
    let dir = starter_pack();
    let picture = image::open(dir.join("elevation.png")).expect("the starter pack is good");
    let (width, height) = (picture.width(), picture.height());
    let elevation = picture.into_luma16().into_raw();
    let saturated = |exaggeration| {
        slopes_from_elevation(width, height, &elevation, exaggeration)
            .expect("the starter pack is good")
            .saturated_texels
    };
    assert_eq!(saturated(SLOPE_EXAGGERATION), 0);
    assert_eq!(saturated(8.0), 36);
}

/// A row of the map at a pole is one place: were it not nearly one value, the pole would show a swirl.
#[test]
fn the_starter_pack_has_neither_seam_nor_pinch() {
    let _alone = HEAVY.lock().unwrap_or_else(PoisonError::into_inner);
    let dir = starter_pack();
    let layers = load_all(&dir).expect("the starter pack is good");
    let clouds = layers.clouds.as_ref().expect("selected");
    let lights = layers.night_lights.as_ref().expect("selected");
    for (name, map) in [("day", &layers.day), ("clouds", clouds), ("lights", lights)] {
        let bytes = map.format.texel_bytes();
        let (width, height) = (map.width as usize, map.height as usize);
        let texel = |x: usize, y: usize| i32::from(map.levels[0][(y * width + x) * bytes]);
        for y in [0, height - 1] {
            let row = (0..width).map(|x| texel(x, y));
            let (least, most) = (row.clone().min(), row.max());
            let spread = most.zip(least).map_or(0, |(most, least)| most - least);
            assert!(spread <= 6, "{name}: row {y} spreads over {spread}");
        }
        // The edges differ no more than neighbouring columns elsewhere.
        let step = |x: usize| {
            let next = (x + 1) % width;
            let sum: i32 = (0..height)
                .map(|y| (texel(x, y) - texel(next, y)).abs())
                .sum();
            f64::from(sum) / height as f64
        };
        let near = (2..22).map(|k| step(k) + step(width - 2 - k)).sum::<f64>() / 40.0;
        let seam = step(width - 1);
        assert!(seam <= 1.3 * near + 0.05, "{name}: {seam}, near it {near}");
    }
}
