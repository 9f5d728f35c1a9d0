//! Quality that is changed while the Earth is drawn gives the picture that an Earth made so gives, byte for byte.

use crate::common::tiles::FunctionTiles;
use crate::common::{self, Rig, map, tilted};
use glam::DVec3;
use std::sync::Arc;
use terrella::frames::Geodetic;
use terrella::{EarthOptions, EyeView, Quality, QualityLadder, QualityReduction, TileOptions};
use terrella_imagery::tile::{MapLayer, TileSource};
use terrella_imagery::{EarthLayers, LayerImage};

const SIZE: (u32, u32) = (192, 108);

fn hills(lat: f64, lon: f64) -> [u8; 3] {
    let wave = |angle: f64| (120.0 + 80.0 * angle.sin()).round() as u8;
    [wave(3.0 * lat), wave(2.5 * lon), wave(2.0 * (lat + lon))]
}

/// All maps, each with something to see.
fn layers(day: LayerImage) -> EarthLayers {
    let texels = |f: fn(usize) -> u8| (0..128 * 64).map(f).collect::<Vec<u8>>();
    EarthLayers {
        day,
        clouds: Some(LayerImage::from_r8(128, 64, texels(|n| (n % 97) as u8)).unwrap()),
        normals: Some(
            LayerImage::from_slopes(128, 64, (0..2 * 128 * 64).map(|n| (n % 61) as u8).collect())
                .unwrap(),
        ),
        night_lights: Some(LayerImage::from_r8(128, 64, texels(|n| (n % 251) as u8)).unwrap()),
        water: Some(LayerImage::from_r8(128, 64, vec![200; 128 * 64]).unwrap()),
    }
}

fn view() -> EyeView {
    let aspect = f64::from(SIZE.0) / f64::from(SIZE.1);
    let place = Geodetic::from_degrees(20.0, 30.0, 1.5e6);
    tilted(place, 60.0, -45.0, 60.0, aspect)
}

/// On the eastern horizon: day and night in one picture.
fn sun() -> DVec3 {
    DVec3::new(-0.5, 0.86, 0.05).normalize()
}

/// City lights are bright beside daylight too: giving them up is seen.
fn options(layers: EarthLayers) -> EarthOptions {
    let mut options = EarthOptions::new(layers);
    options.light.night_fades_by_day = false;
    options
}

fn made_so(options: &EarthOptions, quality: &Quality) -> EarthOptions {
    let mut options = options.clone();
    options.subdivision = quality.subdivision;
    options.anisotropy = quality.anisotropy;
    options.samples = quality.samples;
    options.atmosphere = quality.atmosphere;
    if let Some(tiles) = &mut options.tiles {
        tiles.max_texel_px = quality.texel_px;
    }
    let shown = |layer: MapLayer| quality.maps[layer.index()];
    let layers = &mut options.layers;
    layers.clouds.take_if(|_| !shown(MapLayer::Clouds));
    layers.normals.take_if(|_| !shown(MapLayer::Normals));
    layers
        .night_lights
        .take_if(|_| !shown(MapLayer::NightLights));
    layers.water.take_if(|_| !shown(MapLayer::Water));
    options
}

/// All reductions of the Earth itself, one after another.
const LADDER: &str = "give_up,cost,error\nsamples,0.9,0\nanisotropy,0.8,0\ndetail,0.7,0\nroundness,0.6,0\nrelief,0.5,0\n\
                      lights,0.4,0\nair,0.3,0\nclouds,0.2,0\n";

/// Goes down the levels and back up.
fn follows_the_levels(options: &EarthOptions, count: usize) {
    let (view, sun) = (view(), sun());
    let mut changed = Rig::new(options, SIZE);
    let ladder = QualityLadder::parse(LADDER).expect("a good ladder");
    let levels = ladder.levels(*changed.earth.quality(), options.tiles.is_some());
    assert_eq!(levels.len(), count);
    let mut pictures = Vec::new();
    for level in &levels {
        changed.set_quality(&level.quality);
        let (picture, stats, missing) = changed.draw_complete(&view, sun);
        let options = made_so(options, &level.quality);
        let mut made = Rig::new(&options, SIZE);
        let (expected, expected_stats, _) = made.draw_complete(&view, sun);
        assert!(missing.is_empty(), "{:?}: {missing:?}", level.reductions);
        assert!(picture == expected, "{:?}", level.reductions);
        assert_eq!(stats.triangles, expected_stats.triangles);
        assert_eq!(
            changed.earth.diagnostics().features_on,
            made.earth.diagnostics().features_on
        );
        assert_eq!(changed.earth.quality(), &level.quality);
        pictures.push(picture);
    }
    for (level, pair) in levels.iter().skip(1).zip(pictures.windows(2)) {
        // A software adapter always filters trilinearly, and the part beyond the limb is lifted to it, however coarse the mesh.
        let is_seen = pair[0] != pair[1];
        let may_be_alike = [QualityReduction::Anisotropy, QualityReduction::Roundness];
        assert!(
            is_seen || may_be_alike.contains(&level.reductions[0]),
            "{:?}",
            level.reductions
        );
    }
    changed.set_quality(&levels[0].quality);
    assert!(
        changed.draw_complete(&view, sun).0 == pictures[0],
        "back at the top"
    );
}

#[test]
fn whole_maps_follow_the_levels() {
    let mut options = options(layers(map(256, hills)));
    options.samples = 4;
    options.subdivision = terrella::Subdivision::Cells(24);
    // No tiles, so detail cannot be given up.
    follows_the_levels(&options, 8);
}

#[test]
fn tiles_follow_the_levels() {
    let tiles = Arc::new(FunctionTiles::new(&[256, 128, 64, 32], hills));
    let mut options = options(layers(tiles.whole(3)));
    options.samples = 4;
    options.subdivision = terrella::Subdivision::Cells(48);
    options.tiles = Some(TileOptions {
        texture_bytes: 64_000_000,
        ..TileOptions::new(tiles as Arc<dyn TileSource>)
    });
    follows_the_levels(&options, 9);
}

#[test]
fn a_quality_that_is_rejected_leaves_the_earth_as_it_was() {
    let options = EarthOptions::new(layers(map(64, hills)));
    let mut rig = Rig::new(&options, SIZE);
    let (before, ..) = rig.draw_complete(&view(), sun());
    let quality = *rig.earth.quality();
    let queue = &common::gpu().queue;
    let cells = Quality {
        subdivision: terrella::Subdivision::Cells(49),
        ..quality
    };
    let samples = Quality {
        samples: 3,
        ..quality
    };
    let scale = Quality {
        scale: f64::NAN,
        ..quality
    };
    for bad in [cells, samples, scale] {
        let error = rig.earth.set_quality(queue, &bad).expect_err("rejected");
        assert!(!error.to_string().is_empty());
        assert_eq!(rig.earth.quality(), &quality);
        assert!(rig.draw_complete(&view(), sun()).0 == before);
    }
}
