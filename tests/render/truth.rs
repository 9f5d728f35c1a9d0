//! Truth layers, as a host draws and reads them: places, distances and light compared with independent rays, land and clouds with the functions of
//! their maps.

use crate::common::{down, gpu, map, plain, ray, tilted};
use glam::DVec3;
use std::f64::consts::TAU;
use std::time::Duration;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{
    DiagnosticOptions, Earth, EarthOptions, EyeView, Figure, FrameRequest, LayerImage, Sky,
    SurfaceOutput, TruthTargets, TruthTexel, TruthView,
};
use terrella_imagery::EarthLayers;

const SIZE: (u32, u32) = (96, 64);
const ASPECT: f64 = 1.5;

fn options(layers: EarthLayers) -> EarthOptions {
    EarthOptions {
        color_format: SurfaceOutput::TRUTH[0],
        diagnostics: DiagnosticOptions {
            output: SurfaceOutput::Truth,
            ..DiagnosticOptions::default()
        },
        ..EarthOptions::new(layers)
    }
}

/// An Earth of numbers with its targets.
struct Truth {
    earth: Earth,
    targets: TruthTargets,
}

impl Truth {
    fn new(options: &EarthOptions) -> Self {
        let gpu = gpu();
        Self {
            earth: Earth::new(&gpu.device, &gpu.queue, options).expect("sound options"),
            targets: TruthTargets::new(&gpu.device, SIZE),
        }
    }

    fn draw(&mut self, view: &EyeView, sky: &Sky) -> Vec<TruthTexel> {
        let gpu = gpu();
        let wait = Duration::from_secs(20);
        self.earth
            .prepare_complete(&gpu.queue, FrameRequest::new(view, sky, SIZE), wait);
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.earth
            .render(&mut self.targets.begin_pass(&mut encoder));
        gpu.queue.submit([encoder.finish()]);
        let texels = self.targets.read(&gpu.device, &gpu.queue, 0..SIZE.1);
        texels.expect("reads")
    }
}

fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)))
}

/// How far the ray of a pixel goes to WGS84 raised by a height, metres. By halving: in scaled space the distance from the centre falls
/// up to the ray's point nearest to it.
fn range_m(eye: DVec3, ray: DVec3, height_m: f64) -> Option<f64> {
    let (a, b) = (
        Ellipsoid::WGS84.equatorial_radius_m + height_m,
        Ellipsoid::WGS84.polar_radius_m + height_m,
    );
    let scale = DVec3::new(1.0 / a, 1.0 / a, 1.0 / b);
    let (e, d) = (eye * scale, ray * scale);
    // |e + t d|² − 1, without the difference of two large numbers.
    let above = (e.length() - 1.0) * (e.length() + 1.0);
    let outside = |t: f64| above + t * (2.0 * e.dot(d) + t * d.length_squared());
    let nearest = -e.dot(d) / d.length_squared();
    if nearest <= 0.0 || outside(nearest) > 0.0 {
        return None;
    }
    let (mut near, mut far) = (0.0, nearest);
    for _ in 0..200 {
        let middle = 0.5 * (near + far);
        match outside(middle) > 0.0 {
            true => near = middle,
            false => far = middle,
        }
    }
    Some(far)
}

/// Latitude and longitude of a point of the ellipsoid, radians: tan φ = a² z/(b² ρ).
fn lat_lon(point: DVec3) -> (f64, f64) {
    let figure = Ellipsoid::WGS84;
    let stretch = (figure.equatorial_radius_m / figure.polar_radius_m).powi(2);
    let rho = point.x.hypot(point.y);
    ((stretch * point.z).atan2(rho), point.y.atan2(point.x))
}

/// Twenty eyes: poles, date line, near and far, down and slant, as narrow as a thousandth of a degree; the rest by chance.
fn eyes() -> Vec<(String, EyeView)> {
    let at = Geodetic::from_degrees;
    let mut eyes: Vec<(String, EyeView)> = [
        ("north pole", down(at(90.0, 0.0, 4e5), 50.0, ASPECT)),
        (
            "south pole",
            tilted(at(-89.9, 10.0, 4e5), 200.0, -50.0, 60.0, ASPECT),
        ),
        ("date line", down(at(5.0, 179.99, 4e5), 60.0, ASPECT)),
        (
            "over the date line",
            tilted(at(-20.0, -179.0, 4e5), 270.0, -30.0, 60.0, ASPECT),
        ),
        (
            "limb",
            tilted(at(48.0, 8.0, 4e5), 90.0, -18.0, 50.0, ASPECT),
        ),
        (
            "low",
            tilted(at(30.0, 31.0, 150.0), 45.0, -3.0, 60.0, ASPECT),
        ),
        (
            "a thousandth of a degree",
            down(at(40.0, -100.0, 4e5), 0.001, ASPECT),
        ),
        (
            "the same, slant",
            tilted(at(-40.0, 65.0, 4e5), 120.0, -25.0, 0.001, ASPECT),
        ),
        ("geostationary", down(at(0.0, 19.2, 3.5786e7), 18.0, ASPECT)),
        ("from the Moon", down(at(-12.0, 100.0, 3.8e8), 2.2, ASPECT)),
    ]
    .map(|(name, view)| (name.to_owned(), view))
    .into();
    // Numerical Recipes' quick generator.
    let mut state = 2_027_u32;
    let mut chance = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    while eyes.len() < 20 {
        let lat_deg = (2.0 * chance() - 1.0).asin().to_degrees();
        let place = at(
            lat_deg,
            360.0 * chance() - 180.0,
            10_f64.powf(3.0 + 5.0 * chance()),
        );
        // Down to the limb.
        let limb_deg = (1.0 / (1.0 + place.height_m / 6.4e6)).asin().to_degrees();
        let pitch = limb_deg * chance() - 90.0;
        let (azimuth, fov) = (
            360.0 * chance(),
            (5.0 + 60.0 * chance()).min(2.0 * limb_deg),
        );
        let name = format!("{:.0} km over {lat_deg:.0}°", place.height_m / 1e3);
        eyes.push((name, tilted(place, azimuth, pitch, fov, ASPECT)));
    }
    eyes
}

#[derive(Default)]
struct Worst {
    ground: usize,
    place_px: f64,
    range_m: f64,
    sun_deg: f64,
    drawn_range: f64,
    drawn_px: f64,
    edge_px: f64,
}

#[test]
fn twenty_eyes_see_what_their_rays_meet() {
    let mut truth = Truth::new(&options(plain([90; 3])));
    let mut seen = 0;
    for (name, view) in eyes() {
        let sky = Sky::new(DVec3::new(0.3, -0.8, 0.52).normalize());
        let texels = truth.draw(&view, &sky);
        let places = TruthView::new(&view, &sky, Figure::Wgs84, SIZE).expect("a view");
        let eye = view.eye_world;
        let mut worst = Worst::default();
        for ((x, y), texel) in pixels().zip(&texels) {
            let direction = ray(&view, x, y, SIZE);
            let pixel_rad = direction.angle_between(ray(&view, x + 1, y, SIZE));
            assert!(
                places.ray(x, y).distance(direction) < 1e-14,
                "{name}: {x}, {y}"
            );
            let limb_px = places.limb_distance_rad(x, y).expect("outside") / pixel_rad;
            let exact = range_m(eye, direction, 0.0);
            // Beside the limb by rounding alone it may be either.
            assert!(
                exact.is_some() == (limb_px <= 0.0) || limb_px.abs() < 1e-6,
                "{name}: {x}, {y}: {limb_px} px from the limb, {exact:?}"
            );
            let found = places.point(x, y, texel);
            let (Some(found), Some(exact_m)) = (found, exact) else {
                if found.is_some() != exact.is_some() {
                    worst.edge_px = worst.edge_px.max(limb_px.abs());
                }
                continue;
            };
            worst.ground += 1;
            // In pixels of the ground, as if it faced the eye.
            let pixel_m = exact_m * pixel_rad;
            let point = eye + exact_m * direction;
            let (lat_rad, lon_rad) = lat_lon(point);
            let up = Ellipsoid::normal(lat_rad, lon_rad);
            let place = Ellipsoid::WGS84
                .surface_point(Ellipsoid::normal(found.place.lat_rad, found.place.lon_rad));
            worst.place_px = worst.place_px.max(place.distance(point) / pixel_m);
            worst.range_m = worst.range_m.max((found.range_m - exact_m).abs());
            let elevation = up.dot(sky.sun_itrf).asin().to_degrees();
            let sun_deg = (found.sun_elevation_rad.to_degrees() - elevation).abs();
            worst.sun_deg = worst.sun_deg.max(sun_deg);
            assert_eq!(found.place.height_m, 0.0);
            // Without a normal map the ground is the ellipsoid; 16-bit floats resolve slopes no better than this.
            assert!(found.normal_itrf.distance(up) < 1e-6, "{name}: {x}, {y}");
            if elevation.abs() > 0.5 {
                assert_eq!(found.sunlit, f64::from(u8::from(elevation > 0.0)));
                let is_lit = texel.marks & TruthTexel::SUNLIT != 0;
                assert_eq!(is_lit, elevation > 0.0, "{name}: {x}, {y}");
            }
            // Values that a host reads without the rays: where the ground is not seen edge-on.
            if -up.dot(direction) > 0.1 {
                let [u, v, drawn_m, _] = texel.place.map(f64::from);
                let block = (texel.marks & 0xff) - 1;
                let center = [f64::from(block % 16) + 0.5, f64::from(block / 16) + 0.5];
                let lon = (center[0] / 16.0 + u - 0.5) * TAU;
                let lat = (0.5 - center[1] / 8.0 - v) * 0.5 * TAU;
                let drawn = Ellipsoid::WGS84.surface_point(Ellipsoid::normal(lat, lon));
                worst.drawn_px = worst.drawn_px.max(drawn.distance(point) / pixel_m);
                worst.drawn_range = worst.drawn_range.max((drawn_m / exact_m - 1.0).abs());
            }
        }
        println!(
            "{name}: {} pixels; place {:.1e} px, range {:.1e} m, Sun {:.1e}°; by the GPU alone {:.1e} px, range {:.1e}; \
             the limb's edge {:.2} px",
            worst.ground,
            worst.place_px,
            worst.range_m,
            worst.sun_deg,
            worst.drawn_px,
            worst.drawn_range,
            worst.edge_px
        );
        assert!(worst.place_px < 0.01 && worst.range_m < 1.0, "{name}");
        assert!(worst.sun_deg < 1e-6 && worst.drawn_range < 1e-4, "{name}");
        assert!(worst.edge_px < 0.5, "{name}");
        assert!(worst.ground > 100, "{name}");
        seen += worst.ground;
    }
    assert!(seen > 60_000, "{seen}");
}

/// The Moon before the Sun: how much of its disc is hidden, by discs that are cut into small squares.
#[test]
fn the_moon_hides_of_the_sun_what_its_disc_covers() {
    const SUN_M: f64 = 1.48e11;
    let sun_itrf = Ellipsoid::normal(0.3, 0.5);
    let aside = sun_itrf.cross(DVec3::Z).normalize();
    let sky = Sky {
        sun_distance_m: SUN_M,
        moon_itrf_m: Some(3.57e8 * sun_itrf + 2e6 * aside),
        ..Sky::new(sun_itrf)
    };
    let hidden = |place: DVec3| {
        let (sun, moon) = (
            SUN_M * sun_itrf - place,
            3.57e8 * sun_itrf + 2e6 * aside - place,
        );
        let radius = |metres: f64, to: DVec3| (metres / to.length()).asin();
        let (sun_rad, moon_rad) = (radius(6.957e8, sun), radius(1.7374e6, moon));
        let apart = (moon.normalize() - sun.normalize()).length() / sun_rad;
        let (mut all, mut covered) = (0, 0);
        for (x, y) in (-100..100).flat_map(|x| (-100..100).map(move |y| (x, y))) {
            let (x, y) = ((f64::from(x) + 0.5) / 100.0, (f64::from(y) + 0.5) / 100.0);
            let is_sun = x.hypot(y) < 1.0;
            all += u32::from(is_sun);
            covered += u32::from(is_sun && (x - apart).hypot(y) < moon_rad / sun_rad);
        }
        f64::from(covered) / f64::from(all)
    };
    let view = EyeView::itrf(3e7 * sun_itrf, -sun_itrf, DVec3::Z, 0.3, ASPECT);
    let texels = Truth::new(&options(plain([90; 3]))).draw(&view, &sky);
    let places = TruthView::new(&view, &sky, Figure::Wgs84, SIZE).expect("a view");
    let (mut whole, mut part, mut none) = (0, 0, 0);
    for ((x, y), texel) in pixels().zip(&texels) {
        let direction = ray(&view, x, y, SIZE);
        let (Some(found), Some(exact_m)) = (
            places.point(x, y, texel),
            range_m(view.eye_world, direction, 0.0),
        ) else {
            continue;
        };
        let wanted = hidden(view.eye_world + exact_m * direction);
        let apart = (found.moon_shadow - wanted).abs();
        assert!(apart < 2e-3, "{x}, {y}: {} for {wanted}", found.moon_shadow);
        match found.moon_shadow {
            0.0 => none += 1,
            1.0 => whole += 1,
            _ => part += 1,
        }
    }
    println!("{whole} pixels in the umbra, {part} in the penumbra, {none} outside");
    assert!(
        whole > 0 && part > 500 && none > 50,
        "{whole} {part} {none}"
    );
}

/// Land in squares of 15°, and clouds that thicken to the north and east.
fn is_land(lat_deg: f64, lon_deg: f64) -> bool {
    ((lat_deg / 15.0).floor() + (lon_deg / 15.0).floor()).rem_euclid(2.0) == 0.0
}

fn cover(lat_deg: f64, lon_deg: f64) -> f64 {
    0.5 + 0.2 * (lat_deg.to_radians() * 12.0).sin() + 0.2 * (lon_deg.to_radians() * 12.0).sin()
}

fn gray(width: u32, value: impl Fn(f64, f64) -> f64) -> LayerImage {
    let rgba = map(width, |lat, lon| {
        [(255.0 * value(lat, lon)).round() as u8; 3]
    });
    let texels = rgba.levels[0].as_chunks::<4>().0.iter();
    LayerImage::from_r8(width, width / 2, texels.map(|texel| texel[0]).collect()).expect("sound")
}

#[test]
fn land_and_clouds_are_those_of_their_maps() {
    let layers = EarthLayers {
        clouds: Some(gray(1024, cover)),
        water: Some(gray(2048, |lat, lon| {
            f64::from(u8::from(!is_land(lat, lon)))
        })),
        // A slope of 0.25 to the east, as it is stored four times too steep.
        normals: Some(LayerImage::from_slopes(2, 1, vec![127, 0, 127, 0]).expect("sound")),
        ..plain([90; 3])
    };
    let mut options = options(layers);
    options.light.detail = false;
    options.anisotropy = 1;
    let cloud_height_m = 20_000.0;
    options.light.cloud_height_m = cloud_height_m;
    let mut truth = Truth::new(&options);
    let at = Geodetic::from_degrees;
    for (name, view) in [
        ("down", down(at(33.0, 140.0, 2e6), 50.0, ASPECT)),
        (
            "slant",
            tilted(at(-20.0, -175.0, 8e5), 300.0, -35.0, 40.0, ASPECT),
        ),
    ] {
        let sky = Sky::new(view.eye_world.normalize());
        let texels = truth.draw(&view, &sky);
        let places = TruthView::new(&view, &sky, Figure::Wgs84, SIZE).expect("a view");
        let (mut land, mut sea) = (0, 0);
        for ((x, y), texel) in pixels().zip(&texels) {
            let direction = ray(&view, x, y, SIZE);
            let Some(exact_m) = range_m(view.eye_world, direction, 0.0) else {
                continue;
            };
            let Some(found) = places.point(x, y, texel) else {
                continue;
            };
            let (lat, lon) = lat_lon(view.eye_world + exact_m * direction);
            let up = Ellipsoid::normal(lat, lon);
            if -up.dot(direction) < 0.3 {
                continue;
            }
            // A degree away from all coasts.
            let off = |deg: f64| (deg / 15.0 - (deg / 15.0).round()).abs() * 15.0;
            let (lat_deg, lon_deg) = (lat.to_degrees(), lon.to_degrees());
            if off(lat_deg) > 1.0 && off(lon_deg) * lat.cos() > 1.0 {
                let wanted = is_land(lat_deg, lon_deg);
                assert_eq!(found.land, f64::from(u8::from(wanted)), "{name}: {x}, {y}");
                assert_eq!(texel.marks & TruthTexel::LAND != 0, wanted);
                (land, sea) = (land + u32::from(wanted), sea + u32::from(!wanted));
            }
            let through = range_m(view.eye_world, direction, cloud_height_m).expect("nearer");
            let (lat, lon) = lat_lon(view.eye_world + through * direction);
            let wanted = cover(lat.to_degrees(), lon.to_degrees());
            let apart = (found.cloud_cover - wanted).abs();
            assert!(
                apart < 0.006,
                "{name}: {x}, {y}: {} for {wanted}",
                found.cloud_cover
            );
            let east = DVec3::Z.cross(up).normalize();
            let leans = (up - 0.25 * east).normalize();
            assert!(found.normal_itrf.distance(leans) < 2e-3, "{name}: {x}, {y}");
        }
        assert!(land > 300 && sea > 300, "{name}: {land} {sea}");
    }
}

#[test]
fn a_pass_that_cannot_hold_truth_is_rejected_by_name() {
    let gpu = gpu();
    let rejected = |options: EarthOptions| match Earth::new(&gpu.device, &gpu.queue, &options) {
        Ok(_) => panic!("drawn"),
        Err(error) => error.to_string(),
    };
    let sound = options(plain([90; 3]));
    let words = rejected(EarthOptions {
        samples: 4,
        ..sound.clone()
    });
    assert!(
        words.contains("samples 4") && words.contains("R32Uint"),
        "{words}"
    );
    let words = rejected(EarthOptions {
        color_format: wgpu::TextureFormat::Rgba8UnormSrgb,
        ..sound
    });
    assert!(words.contains("Rgba8UnormSrgb"), "{words}");
}

/// Relief: on the pixel's ray, at the height that is drawn there, near the data's.
#[cfg(feature = "terrain")]
mod relief {
    use super::*;
    use std::sync::Arc;
    use terrella::{GroundOptions, Subdivision, SurfaceKind, SurfaceSettings};
    use terrella_ground::elevation::{Bounds, Elevation, HeightRange};
    use terrella_ground::globe::contours::PageOptions;

    /// Hills some 300 km wide, 6 km high and 6 km deep.
    struct Hills;

    impl Elevation for Hills {
        fn height_m(&self, lat_rad: f64, lon_rad: f64, _: f64) -> f64 {
            let p = Ellipsoid::normal(lat_rad, lon_rad);
            6000.0 * (60.0 * p.x).sin() * (60.0 * p.y).cos() * (60.0 * p.z).cos()
        }
        fn range_m(&self, _: &Bounds) -> HeightRange {
            HeightRange {
                low_m: -6000.0,
                high_m: 6000.0,
            }
        }
        fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
            1e-3
        }
    }

    #[test]
    fn a_place_lies_on_its_ray_at_the_height_that_is_drawn() {
        let kinds = SurfaceKind::ALL.iter();
        let mut surfaces: Vec<_> = kinds
            .map(|kind| (kind.name(), kind.settings(Subdivision::Auto)))
            .collect();
        let cast = SurfaceSettings::CastContours(PageOptions::default());
        surfaces.push(("contours, cast", cast));
        let at = Geodetic::from_degrees;
        for (kind, surface) in surfaces {
            let mut options = options(plain([90; 3]));
            options.ground = Some(GroundOptions {
                elevation: Arc::new(Hills),
                surface,
                tolerance_px: 0.25,
            });
            let mut truth = Truth::new(&options);
            for (name, view) in [
                ("down", down(at(47.0, 11.0, 4e5), 50.0, ASPECT)),
                (
                    "slant",
                    tilted(at(10.0, 179.5, 4e5), 80.0, -40.0, 40.0, ASPECT),
                ),
                (
                    "pole",
                    tilted(at(-89.0, 40.0, 9e5), 20.0, -60.0, 50.0, ASPECT),
                ),
            ] {
                let sky = Sky::new(DVec3::X);
                let texels = truth.draw(&view, &sky);
                let places = TruthView::new(&view, &sky, Figure::Wgs84, SIZE).expect("a view");
                let (mut ground, mut worst_px, mut worst_m) = (0, 0.0_f64, 0.0_f64);
                let (mut drawn_px, mut along_px) = (0.0_f64, 0.0_f64);
                for ((x, y), texel) in pixels().zip(&texels) {
                    let Some(found) = places.point(x, y, texel) else {
                        continue;
                    };
                    ground += 1;
                    let direction = ray(&view, x, y, SIZE);
                    let pixel_rad = direction.angle_between(ray(&view, x + 1, y, SIZE));
                    let point = view.eye_world + found.range_m * direction;
                    assert!(point.distance(found.place_itrf_m) < 1e-3);
                    let there = Ellipsoid::WGS84.geodetic_from_itrf(point);
                    let height_m = f64::from(texel.place[3]);
                    worst_m = worst_m.max((there.height_m - height_m).abs());
                    assert!((there.height_m - found.place.height_m).abs() < 1e-6);
                    let data_m = Hills.height_m(there.lat_rad, there.lon_rad, 0.0);
                    let pixel_m = pixel_rad * found.range_m;
                    worst_px = worst_px.max((there.height_m - data_m).abs() / pixel_m);
                    // The drawn ground itself deviates equally from the height in its texel.
                    let drawn = view.eye_world + f64::from(texel.place[2]) * direction;
                    let drawn = Ellipsoid::WGS84.geodetic_from_itrf(drawn);
                    drawn_px = drawn_px.max((drawn.height_m - height_m).abs() / pixel_m);
                    let up = Ellipsoid::normal(drawn.lat_rad, drawn.lon_rad);
                    let facing = -up.dot(direction);
                    if facing > 0.3 {
                        let apart_px = (f64::from(texel.place[2]) - found.range_m).abs() / pixel_m;
                        along_px = along_px.max(apart_px);
                    }
                }
                println!(
                    "{kind}, {name}: {ground} pixels, {worst_px:.2} px, {worst_m:.1e} m; drawn {drawn_px:.2} px from it, {along_px:.2} px along"
                );
                assert!(ground > 2000 && worst_m < 1e-3, "{kind}, {name}: {worst_m}");
                assert!(
                    worst_px < 0.25 && drawn_px < 0.25,
                    "{kind}, {name}: {worst_px} {drawn_px}"
                );
                assert!(along_px < 0.25, "{kind}, {name}: {along_px}");
            }
        }
    }
}
