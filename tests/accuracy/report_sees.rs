//! The report detects errors: a faultless image is close to the true one, and each deliberate fault increases its number.

use crate::common::{down, gpu, map, tilted};
use glam::DAffine3;
use std::sync::OnceLock;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{Atmosphere, EarthOptions, EyeView, Figure, Sky, Visibility};
use terrella_imagery::{EarthLayers, LayerImage};
use terrella_measure::errors::{
    Difference, GeolocationErrors, GeolocationRenderer, SilhouetteErrors, geolocation, silhouette,
};
use terrella_measure::{FrameTimer, GroundPath};
use terrella_play::scene::CameraMode;
use terrella_reference::{Reference, ReferenceOptions, ReferencePicture};

const SIZE: (u32, u32) = (160, 90);
const FIGURE: Ellipsoid = Ellipsoid::WGS84;

/// From 2 000 km towards the limb, which the picture shows.
fn view() -> EyeView {
    let place = Geodetic::from_degrees(25.0, 40.0, 2e6);
    tilted(place, 60.0, -48.0, 60.0, 16.0 / 9.0)
}

/// From the same place straight down: a pixel is half a texel, and nothing is seen edge on.
fn view_down() -> EyeView {
    down(Geodetic::from_degrees(25.0, 40.0, 2e6), 45.0, 16.0 / 9.0)
}

fn sky() -> Sky {
    Sky::new(Ellipsoid::normal(0.1, 1.3))
}

/// Colours in waves of a few texels, and slopes in waves too.
fn layers() -> EarthLayers {
    let wave = |angle: f64, waves: f64| (waves * angle.to_radians()).sin();
    let day = map(1024, |lat, lon| {
        let value = |v: f64| (120.0 + 90.0 * v).round() as u8;
        [
            value(wave(lon, 128.0)),
            value(wave(lat, 128.0)),
            value(wave(lat + lon, 64.0)),
        ]
    });
    let mut slopes = Vec::new();
    for y in 0..256 {
        for x in 0..512 {
            let east = 60.0 * (f64::from(x) * 0.2).sin();
            let north = 60.0 * (f64::from(y) * 0.2).sin();
            slopes.extend([east as i8 as u8, north as i8 as u8]);
        }
    }
    EarthLayers {
        day,
        clouds: None,
        normals: Some(LayerImage::from_slopes(512, 256, slopes).expect("sound")),
        night_lights: None,
        water: None,
    }
}

fn options(layers: EarthLayers) -> EarthOptions {
    let mut options = EarthOptions::new(layers);
    options.atmosphere = Atmosphere::None;
    options.light = terrella::SurfaceLight::PLAIN;
    options.subdivision = terrella::Subdivision::Cells(48);
    options.samples = 4;
    // Dithering is compared too, and steep curves make more of it.
    options.tone = terrella::Tone::Neutral;
    options
}

/// The true picture of [`view_down`] with [`layers`], made once.
fn truth() -> &'static ReferencePicture {
    static TRUTH: OnceLock<ReferencePicture> = OnceLock::new();
    TRUTH.get_or_init(|| {
        let options = options(layers());
        let reference = Reference::new(&options.layers, ReferenceOptions::of(&options, 3));
        let reference = reference.expect("sound maps");
        reference.render(&view_down(), &sky(), SIZE)
    })
}

/// Draws [`view_down`] with these options and compares it.
fn difference(options: &EarthOptions) -> Difference {
    let mut rig = FrameTimer::new(gpu(), options, SIZE).expect("sound options");
    let picture = rig.draw(&view_down(), &sky(), std::time::Duration::ZERO);
    Difference::between(&picture.expect("a picture"), truth())
}

fn geolocation_renderer(subdivision: u32) -> GeolocationRenderer {
    let (figure, rule) = (Figure::Wgs84, Visibility::Conservative);
    GeolocationRenderer::new(gpu(), figure, subdivision, rule).expect("sound options")
}

/// Geolocation and limb of an Earth drawn with a view changed by `alter`, compared with those of the true view.
fn geometry(
    subdivision: u32,
    alter: fn(&EyeView) -> EyeView,
) -> (GeolocationErrors, SilhouetteErrors) {
    let mut earth = geolocation_renderer(subdivision);
    let places = earth.draw(&alter(&view()), SIZE).expect("places");
    let mut draw = |view: &EyeView, size: (u32, u32)| earth.draw(&alter(view), size);
    let limb = silhouette(&view(), &FIGURE, SIZE, &mut draw).expect("strips");
    (geolocation(&places, &view(), &FIGURE), limb)
}

/// A map shifted eastwards by half a texel: each texel the mean of two neighbours would blur, so the map is computed.
fn shifted() -> EarthLayers {
    let half_texel_deg = 0.5 * 360.0 / 1024.0;
    let wave = |angle: f64, waves: f64| (waves * angle.to_radians()).sin();
    EarthLayers {
        day: map(1024, |lat, lon| {
            let lon = lon - half_texel_deg;
            let value = |v: f64| (120.0 + 90.0 * v).round() as u8;
            [
                value(wave(lon, 128.0)),
                value(wave(lat, 128.0)),
                value(wave(lat + lon, 64.0)),
            ]
        }),
        ..layers()
    }
}

/// Slopes with their signs turned over.
fn flipped() -> EarthLayers {
    let mut layers = layers();
    let slopes = layers.normals.as_ref().expect("slopes");
    let turned = slopes.levels[0].iter();
    let turned = turned.map(|v| (*v as i8).wrapping_neg() as u8).collect();
    let (width, height) = (slopes.width, slopes.height);
    layers.normals = Some(LayerImage::from_slopes(width, height, turned).expect("sound"));
    layers
}

#[test]
fn a_shift_of_half_a_texel_and_a_flipped_normal_show_in_the_colours() {
    let good = difference(&options(layers()));
    println!(
        "faultless: FLIP {:.5}, RMSE {:.5}",
        good.flip_mean, good.rmse_linear
    );
    // Pictures are dithered, the reference is not.
    assert!(good.flip_mean < 0.025, "FLIP {}", good.flip_mean);
    for (name, layers, at_least) in [("shifted", shifted(), 5.0), ("flipped", flipped(), 10.0)] {
        let bad = difference(&options(layers));
        println!(
            "{name}: FLIP {:.5}, RMSE {:.5}",
            bad.flip_mean, bad.rmse_linear
        );
        assert!(
            bad.flip_mean > at_least * good.flip_mean
                && bad.rmse_linear > at_least * good.rmse_linear,
            "{name}: FLIP {} after {}, RMSE {} after {}",
            bad.flip_mean,
            good.flip_mean,
            bad.rmse_linear,
            good.rmse_linear
        );
    }
}

#[test]
fn a_radius_that_is_1_percent_too_large_shows_in_places_and_limb() {
    let (places, limb) = geometry(48, |view| *view);
    println!("faultless: {places:?}\n{limb:?}");
    assert!(places.pixels > 5_000 && places.max_px < 0.05 && places.median_m < 5.0);
    assert!(limb.in_view && limb.places > 8 && limb.max_px < 0.05);
    // The globe as seen from 1 % nearer to its centre: larger by as much.
    let (bad_places, bad_limb) = geometry(48, |view| EyeView {
        itrf_from_world: DAffine3::from_scale(glam::DVec3::splat(1.0 / 1.01)),
        ..*view
    });
    println!("1 % larger: {bad_places:?}\n{bad_limb:?}");
    assert!(bad_places.max_px > 1.0 && bad_places.median_m > 100.0 * places.median_m);
    assert!(bad_limb.max_px > 1.0);
    // The same by the eye's own place.
    let (near_places, near_limb) = geometry(48, |view| EyeView {
        eye_world: view.eye_world / 1.01,
        ..*view
    });
    assert!((near_limb.max_px - bad_limb.max_px).abs() < 0.1);
    assert!((near_places.max_px / bad_places.max_px - 1.0).abs() < 0.1);
}

#[test]
fn a_coarse_mesh_costs_the_silhouette_and_nothing_else() {
    let mut last = f64::INFINITY;
    for subdivision in [3, 6, 12, 24] {
        let (places, limb) = geometry(subdivision, |view| *view);
        println!(
            "{subdivision}: limb {:.3} px, places {:.4} px",
            limb.max_px, places.max_px
        );
        // Twice the cells, a quarter of the sagitta; the limb's places fall on facets as they may.
        assert!(limb.max_px < 0.45 * last, "{subdivision}: {}", limb.max_px);
        // Pixels of facets that reach beyond the limb look at it.
        let most = if subdivision < 24 { 2.0 } else { 0.05 };
        assert!(places.max_px < most, "{subdivision}: {}", places.max_px);
        last = limb.max_px;
    }
}

#[test]
fn a_view_without_a_limb_is_given_that_of_the_whole_horizon() {
    let place = Geodetic::from_degrees(10.0, 10.0, 2e5);
    let eye = FIGURE.itrf_from_geodetic(place);
    let view = EyeView::itrf(eye, -eye, glam::DVec3::Z, 0.8, 16.0 / 9.0);
    let mut earth = geolocation_renderer(48);
    let mut draw = |view: &EyeView, size: (u32, u32)| earth.draw(view, size);
    let limb = silhouette(&view, &FIGURE, (640, 360), &mut draw).expect("strips");
    println!("{limb:?}");
    assert!(!limb.in_view && limb.places > 50);
    assert!(limb.max_px < 1.0);
}

/// A coarse mesh covers pixels at the limb that look far into the next block.
#[test]
fn every_pixel_looks_where_its_ray_ends() {
    for (subdivision, height_m) in [(12, 1e6), (6, 2e6), (4, 1e7), (2, 3.6e7)] {
        let mut earth = geolocation_renderer(subdivision);
        let mut worst: f64 = 0.0;
        for part in 0..24 {
            let (part, mode) = (f64::from(part) / 24.0, CameraMode::Horizon);
            let view = GroundPath::Inclined.view(&FIGURE, height_m, part, mode, 1.0, 16.0 / 9.0);
            let places = earth.draw(&view, (640, 360)).expect("places");
            worst = worst.max(geolocation(&places, &view, &FIGURE).max_px);
        }
        println!("{subdivision} cells a block, {height_m} m: {worst} px");
        assert!(worst < 0.1, "{subdivision}, {height_m} m: {worst} px");
    }
}
