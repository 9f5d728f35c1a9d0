//! Terrain whose triangles span several blocks, drawn with the tiles of each: every pixel with those of its own block.

use crate::common::tiles::FunctionTiles;
use crate::common::{Rig, gpu, looks_at, map, plain, ray, tilted};
use crate::hills::Hills;
use image::RgbaImage;
use std::sync::Arc;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{
    Atmosphere, EarthOptions, EyeView, FrameStats, GroundOptions, Shading, SurfaceKind,
    SurfaceSettings, TileOptions,
};
use terrella_ground::elevation::Elevation;
use terrella_ground::globe::clipmap::ClipmapOptions;
use terrella_ground::globe::projected_grid::GridOptions;
use terrella_imagery::EarthLayers;
use terrella_imagery::tile::{
    BlockSet, LayerLayout, LevelLayout, MapLayer, Tile, TileError, TileFormat, TileKey, TileShape,
    TileSource,
};
use terrella_measure::errors::{GeolocationBuffer, GeolocationRenderer};

const SIZE: (u32, u32) = (320, 180);

/// Hills of 3 km and 300 m.
const HILLS: Hills = Hills {
    waves: &[(1500.0, 400.0), (200.0, 8e3)],
    finest_spacing_rad: 1e-5,
};

/// Tiles of a uniform colour, which encodes block and level. Two levels and the whole map, which is grey.
struct Coloured(Vec<LayerLayout>);

/// Colour of the whole map. No tile has it.
const GREY: [u8; 3] = [100; 3];

/// Colours repeat with a period of three: no two neighbours have the same.
fn color(level: u8, block: u8) -> [u8; 3] {
    let (row, column) = (block / 16, block % 16);
    let places = [20, 120, 220].map(|value: u8| value - level * 15);
    [
        places[usize::from(row % 3)],
        places[usize::from(column % 3)],
        60 + 10 * column,
    ]
}

/// The finest level that a block has a tile of.
fn finest(block: u8) -> Option<u8> {
    match (block / 16 + block % 16) % 4 {
        0 | 2 => Some(0),
        1 => Some(1),
        _ => None,
    }
}

impl Coloured {
    fn new() -> Self {
        let with = |is_there: fn(u8) -> bool| {
            let mut present = BlockSet::default();
            (0..128)
                .filter(|b| is_there(*b))
                .for_each(|b| present.insert(b));
            present
        };
        let level = |pixels, blocks| {
            LevelLayout::of_blocks(TileShape::new(pixels).expect("a good size"), blocks)
        };
        Self(vec![LayerLayout {
            layer: MapLayer::Day,
            format: TileFormat::Rgba8Srgb,
            levels: vec![
                level(128, with(|b| finest(b) == Some(0))),
                level(64, with(|b| finest(b).is_some())),
                level(32, BlockSet::ALL),
            ],
        }])
    }
}

impl TileSource for Coloured {
    fn layers(&self) -> &[LayerLayout] {
        &self.0
    }

    fn read(&self, key: TileKey, _: &dyn Fn() -> bool) -> Result<Tile, TileError> {
        let shape = self.0[0].levels[usize::from(key.level)].shape;
        let [r, g, b] = match key.level {
            2 => GREY,
            level => color(level, key.block),
        };
        let texels = [r, g, b, 255].repeat(shape.bytes(TileFormat::Rgba8Srgb) / 4);
        Ok(Tile {
            format: TileFormat::Rgba8Srgb,
            shape,
            texels,
        })
    }
}

fn clipmap() -> SurfaceSettings {
    SurfaceSettings::Clipmap(ClipmapOptions {
        levels: 8,
        samples_per_prepare: u64::MAX,
        fade_prepares: 0,
        ..ClipmapOptions::default()
    })
}

fn grid(on_gpu: bool) -> SurfaceSettings {
    SurfaceSettings::ProjectedGrid(GridOptions {
        on_gpu,
        ..GridOptions::default()
    })
}

fn surfaces() -> [(&'static str, SurfaceSettings); 3] {
    [
        ("grid of the CPU", grid(false)),
        ("grid of the GPU", grid(true)),
        ("clipmap", clipmap()),
    ]
}

fn ground(surface: SurfaceSettings) -> GroundOptions {
    GroundOptions {
        elevation: Arc::new(HILLS),
        surface,
        tolerance_px: 0.5,
    }
}

/// Colours as in the maps, one tenth lighter, under a high Sun.
fn options(surface: SurfaceSettings, with_tiles: bool) -> EarthOptions {
    let day = map(512, |_, _| GREY);
    let mut options = EarthOptions::new(EarthLayers { day, ..plain(GREY) });
    options.atmosphere = Atmosphere::None;
    options.shading = Shading::Paper;
    options.anisotropy = 1;
    options.ground = Some(ground(surface));
    options.tiles = with_tiles.then(|| TileOptions {
        max_texel_px: 1e-9,
        texture_bytes: 64_000_000,
        ..TileOptions::new(Arc::new(Coloured::new()) as Arc<dyn TileSource>)
    });
    options
}

fn over(lat: f64, lon: f64, height_m: f64, pitch_deg: f64) -> EyeView {
    let place = Geodetic::from_degrees(lat, lon, 0.0);
    let ground_m = HILLS.height_m(place.lat_rad, place.lon_rad, 0.0);
    let place = Geodetic {
        height_m: height_m + ground_m,
        ..place
    };
    tilted(place, 40.0, pitch_deg, 50.0, 16.0 / 9.0)
}

fn views() -> Vec<(&'static str, EyeView)> {
    vec![
        ("corner, 3 km", over(22.48, 44.98, 3e3, -15.0)),
        ("edge, horizon", over(22.3, 50.0, 8e3, -4.0)),
        ("inside a block", over(35.0, 80.0, 3e3, -30.0)),
        ("date line", over(-0.1, 179.8, 3e4, -35.0)),
        ("north pole", over(89.7, 10.0, 2e5, -60.0)),
        ("a third of the globe", over(20.0, -100.0, 4e6, -80.0)),
    ]
}

/// Place of a pixel of the ground.
fn place(places: &GeolocationBuffer, view: &EyeView, x: u32, y: u32) -> Option<Geodetic> {
    let along = places.along(x, y)?;
    let forward = (view.view_from_world.inverse() * glam::DVec3::NEG_Z).normalize();
    let ray = ray(view, x, y, SIZE);
    let at = view.eye_world + ray * (along / ray.dot(forward));
    Some(Ellipsoid::WGS84.geodetic_from_itrf(at))
}

/// The block of a place; `None` within 30 m of an edge, where the last digit of a single precision number decides.
fn block_of(place: Geodetic) -> Option<u8> {
    let lat = (90.0 - place.lat_rad.to_degrees()) / 22.5;
    let lon = (place.lon_rad.to_degrees() + 180.0) / 22.5;
    let to_edge = |value: f64| (value - value.round()).abs() * 2.5e6;
    let is_sure = to_edge(lat) > 30.0 && to_edge(lon) * place.lat_rad.cos() > 30.0;
    is_sure.then(|| 16 * (lat as u8).min(7) + (lon as u8).min(15))
}

fn settled(earth: &mut GeolocationRenderer, view: &EyeView) -> GeolocationBuffer {
    for _ in 0..400 {
        let places = earth.draw(view, SIZE).expect("places");
        if earth.stats().ground.samples_read == 0 {
            return places;
        }
    }
    panic!("heights are still being read");
}

fn drawn(rig: &mut Rig, view: &EyeView) -> (RgbaImage, FrameStats) {
    let (picture, stats, missing) = rig.draw_complete(view, view.eye_world.normalize());
    assert!(missing.is_empty(), "{missing:?}");
    (picture, stats)
}

#[test]
fn every_pixel_has_its_own_block_s_tile() {
    let mut wrong = Vec::new();
    for (name, surface) in surfaces() {
        let mut places =
            GeolocationRenderer::with_ground(gpu(), &ground(surface)).expect("sound options");
        let mut rig = Rig::new(&options(surface, true), SIZE);
        assert!(rig.earth.diagnostics().features_on.contains(&"tiles"));
        for (view_name, view) in views() {
            let at = settled(&mut places, &view);
            let (picture, stats) = drawn(&mut rig, &view);
            let (mut pixels, mut others, mut undrawn) = (0, 0, 0);
            let mut found = BlockSet::default();
            for (x, y, pixel) in picture.enumerate_pixels() {
                undrawn += u32::from(at.is_ground(x, y) != (pixel.0[..3] != [0, 0, 0]));
                let Some(block) = place(&at, &view, x, y).and_then(block_of) else {
                    continue;
                };
                let flat = finest(block).map_or(GREY, |level| color(level, block));
                let lit = flat.map(|value| (f64::from(value) * 1.1).round().min(255.0) as u8);
                pixels += 1;
                found.insert(block);
                // Far from below the Sun, or on a slope, the paper's light is dimmer: all three alike.
                let shade = f64::from(pixel.0[2]) / f64::from(lit[2]);
                let is_own =
                    (0..3).all(|k| (f64::from(pixel.0[k]) - shade * f64::from(lit[k])).abs() < 3.0);
                others += u32::from(!is_own || shade < 0.4);
            }
            println!(
                "{name}, {view_name}: {pixels} pixels of {} blocks, {others} with another's tile, {undrawn} undrawn; {} draws of {} triangles, {} without tiles",
                found.len(),
                stats.draw_calls,
                stats.triangles,
                stats.ground.triangles,
            );
            if others + undrawn > 0 || pixels < 15_000 {
                wrong.push(format!("{name}, {view_name}"));
            }
            // Cost of tiles in several blocks: parts of the list, not the list for each.
            let most = match found.len() {
                1 => 1.2,
                2..5 => 3.0,
                _ => 6.0,
            };
            if f64::from(stats.triangles) > most * f64::from(stats.ground.triangles) {
                wrong.push(format!(
                    "{name}, {view_name}: {} triangles",
                    stats.triangles
                ));
            }
        }
    }
    assert_eq!(wrong, [""; 0]);
}

#[test]
fn it_shows_what_blocks_show() {
    let blocks = SurfaceKind::Blocks.settings(terrella::Subdivision::Auto);
    let mut of_blocks = Rig::new(&options(blocks, true), SIZE);
    let view = over(22.48, 44.98, 3e4, -30.0);
    let (expected, _) = drawn(&mut of_blocks, &view);
    for (name, surface) in surfaces() {
        let (picture, _) = drawn(&mut Rig::new(&options(surface, true), SIZE), &view);
        let differ = expected.pixels().zip(picture.pixels());
        let differ = differ.filter(|(a, b)| (0..3).any(|k| a[k].abs_diff(b[k]) > 12));
        let differ = differ.count();
        println!("{name}: {differ} of {} pixels", SIZE.0 * SIZE.1);
        // Along edges of blocks, where elevations differ by the surfaces' errors.
        assert!(differ < 600, "{name}: {differ}");
    }
}

fn waves(lat: f64, lon: f64) -> [u8; 3] {
    let wave = |angle: f64| (110.0 + 100.0 * angle.to_radians().sin()).round() as u8;
    [wave(16.0 * lat), wave(16.0 * lon), wave(lon)]
}

#[test]
fn tiles_lie_where_the_whole_map_says() {
    lie_where_the_whole_map_says(&surfaces(), FunctionTiles::new(&[64, 32], waves));
}

#[test]
fn parts_lie_where_the_whole_map_says() {
    let others = [
        ("cast", SurfaceSettings::CastContours(Default::default())),
        (
            "quadtree",
            SurfaceKind::Quadtree.settings(Default::default()),
        ),
        ("blocks", SurfaceKind::Blocks.settings(Default::default())),
    ];
    let all = [&surfaces()[..], &others].concat();
    lie_where_the_whole_map_says(&all, FunctionTiles::new(&[32, 16], waves).cut(&[2]));
}

/// The finest level is 1024 texels round the Earth.
fn lie_where_the_whole_map_says<F: Fn(f64, f64) -> [u8; 3] + Send + Sync + 'static>(
    surfaces: &[(&'static str, SurfaceSettings)],
    source: FunctionTiles<F>,
) {
    let source = Arc::new(source);
    let coarsest = source.layers()[0].levels.len() - 1;
    for (nth, &(name, surface)) in surfaces.iter().enumerate() {
        let of = |level, with_tiles: bool| {
            let mut options = options(surface, false);
            options.layers.day = source.whole(level);
            let pack: Arc<dyn TileSource> = source.clone();
            options.tiles = with_tiles.then(|| TileOptions {
                max_texel_px: 1e-9,
                ..TileOptions::new(pack)
            });
            Rig::new(&options, SIZE)
        };
        let (mut whole, mut tiled) = (of(0, false), of(coarsest, true));
        // At the pole a texel has the colours of all longitudes.
        let views = views()
            .into_iter()
            .filter(|(name, _)| *name != "north pole");
        // Each surface from every second view, alternating.
        for (view_name, view) in views.skip(nth % 2).step_by(2) {
            let (expected, _) = drawn(&mut whole, &view);
            let (picture, stats) = drawn(&mut tiled, &view);
            assert!(stats.tiles.hits > 0 && stats.tiles.fallbacks == 0);
            // A tile has four mip levels; towards the limb of a globe pixels are larger than the last one's texels.
            let is_steep = |x: u32, y: u32| {
                looks_at(&view, x, y, SIZE).is_some_and(|place| {
                    let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
                    -up.dot(ray(&view, x, y, SIZE)) > 0.6
                })
            };
            let is_far = view_name.contains("globe");
            let pairs = expected.enumerate_pixels().zip(picture.pixels());
            let pairs = pairs.filter(|((x, y, _), _)| !is_far || is_steep(*x, *y));
            let off = pairs.map(|((_, _, a), b)| (0..3).map(|k| a[k].abs_diff(b[k])).max());
            let mut off: Vec<u8> = off.flatten().collect();
            assert!(off.len() > 10_000);
            off.sort_unstable();
            let (most, at_999) = (off[off.len() - 1], off[off.len() * 999 / 1000]);
            println!("{name}, {view_name}: {at_999} of 255 at 99.9 %, {most} at most");
            let limit = if is_far { 10 } else { 3 };
            assert!(at_999 <= limit, "{name}, {view_name}: {at_999}, {most}");
        }
    }
}

#[test]
fn edges_of_samples_are_drawn_too() {
    for (name, surface) in surfaces() {
        let picture = |with_tiles| {
            let mut options = options(surface, with_tiles);
            options.samples = 4;
            let mut rig = Rig::new(&options, SIZE);
            views()
                .into_iter()
                .map(move |(_, view)| drawn(&mut rig, &view).0)
        };
        for ((tiled, whole), (view, _)) in picture(true).zip(picture(false)).zip(views()) {
            // A sample that no draw kept would leave black in ground that is all lit.
            let dark = |picture: &RgbaImage| {
                let black = |pixel: &&image::Rgba<u8>| pixel.0[..3].iter().all(|value| *value < 25);
                let dark = picture.pixels().filter(black);
                dark.count()
            };
            let (tiled, whole) = (dark(&tiled), dark(&whole));
            println!("{name}, {view}: {tiled} dark pixels, {whole} without tiles");
            assert!(
                tiled.abs_diff(whole) < 20,
                "{name}, {view}: {tiled}, {whole}"
            );
        }
    }
}
