//! Ray-cast contours: no ray is lost, each meets the ground where the data have it, and the GPU agrees with the CPU.

use crate::common::{self, down, tilted};
use glam::DVec3;
use std::sync::Arc;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{EyeView, GroundOptions, SurfaceSettings};
use terrella_ground::elevation::{Bounds, Elevation, HeightRange};
use terrella_ground::globe::contours::{
    ContourPages, ContourRay, MAX_NODES, PageOptions, contour_cast,
};
use terrella_ground::globe::{GroundView, Surface, SurfaceStats};

/// Width and height of the pictures, pixels.
const SIZE: (u32, u32) = (96, 54);
const EARTH: Ellipsoid = Ellipsoid::WGS84;

/// Heights by a formula of degrees.
struct Formula {
    height_m: fn(f64, f64) -> f64,
    range: (f64, f64),
    spacing_rad: f64,
}

impl Elevation for Formula {
    fn height_m(&self, lat_rad: f64, lon_rad: f64, _: f64) -> f64 {
        let lon = (lon_rad.to_degrees() + 540.0).rem_euclid(360.0) - 180.0;
        (self.height_m)(lat_rad.to_degrees(), lon)
    }
    fn range_m(&self, _: &Bounds) -> HeightRange {
        HeightRange {
            low_m: self.range.0,
            high_m: self.range.1,
        }
    }
    fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
        self.spacing_rad
    }
}

/// Hills 2 km high and some 60 km wide, smaller ones on them, lower towards the poles.
fn hills() -> Formula {
    Formula {
        height_m: |lat, lon| {
            let (a, b) = ((300.0 * lat).to_radians(), (300.0 * lon).to_radians());
            let fades = lat.to_radians().cos();
            fades * (2000.0 * a.sin() * b.cos() + 200.0 * (9.0 * a).sin() * (9.0 * b).cos())
        },
        range: (-2200.0, 2200.0),
        spacing_rad: 1e-5,
    }
}

fn grounds() -> Vec<(&'static str, Formula)> {
    let formula = |height_m, range, spacing_rad| Formula {
        height_m,
        range,
        spacing_rad,
    };
    vec![
        ("hills", hills()),
        (
            "flat",
            formula(|_, _| 1500.0, (1500.0, 1500.0), f64::INFINITY),
        ),
        (
            "cliffs",
            formula(
                |lat, lon| match ((5.0 * lat).floor() + (5.0 * lon).floor()).rem_euclid(2.0) < 1.0 {
                    true => 3000.0,
                    false => 0.0,
                },
                (0.0, 3000.0),
                1e-4,
            ),
        ),
        (
            "spike and pit",
            formula(
                |lat, lon| {
                    let cone = |lat0: f64, lon0: f64| {
                        (1.0 - (lat - lat0).hypot(lon - lon0) / 0.01).max(0.0)
                    };
                    9000.0 * cone(22.5, -90.0) - 11_000.0 * cone(22.55, -90.02)
                },
                (-11_000.0, 9000.0),
                1e-5,
            ),
        ),
    ]
}

/// Views over corners of blocks, the date line and a pole, from above and along the ground.
fn views() -> Vec<(&'static str, EyeView)> {
    let at = Geodetic::from_degrees;
    let aspect = f64::from(SIZE.0) / f64::from(SIZE.1);
    vec![
        // The eye is in the planes of walls: rays run along them.
        ("corner of blocks", down(at(22.5, -90.0, 3e4), 50.0, aspect)),
        (
            "low over it",
            tilted(at(22.4, -90.0, 9.5e3), 0.0, -8.0, 50.0, aspect),
        ),
        (
            "date line",
            tilted(at(0.0, 180.0, 2e4), 90.0, -30.0, 50.0, aspect),
        ),
        ("pole", down(at(90.0, 0.0, 3e5), 50.0, aspect)),
        (
            "beside a pole",
            tilted(at(-89.5, 33.0, 4e4), 180.0, -25.0, 50.0, aspect),
        ),
        (
            "limb",
            tilted(at(47.0, 10.0, 4e5), 120.0, -20.0, 40.0, aspect),
        ),
        ("whole disc", down(at(20.0, -100.0, 3e7), 26.0, aspect)),
    ]
}

fn ground_view(view: &EyeView, tolerance_px: f64) -> GroundView {
    let (eye_itrf_m, clip_from_eye) = view.to_itrf();
    GroundView {
        eye_itrf_m,
        clip_from_eye,
        pixel_rad: 2.0 / (view.clip_from_view.y_axis.y * f64::from(SIZE.1)),
        tolerance_px,
    }
}

fn settle(surface: &mut ContourPages, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats {
    for _ in 0..2000 {
        let stats = surface.prepare(view, ground);
        if stats.samples_read == 0 {
            return stats;
        }
    }
    panic!("it still reads");
}

/// Whether a ray crosses the ellipsoid of that height.
fn goes_through(eye_m: DVec3, towards: DVec3, height_m: f64) -> bool {
    let scale = DVec3::ONE
        / DVec3::new(
            EARTH.equatorial_radius_m + height_m,
            EARTH.equatorial_radius_m + height_m,
            EARTH.polar_radius_m + height_m,
        );
    let (eye, ray) = (eye_m * scale, towards * scale);
    eye.dot(ray) < 0.0 && eye.cross(ray).length_squared() < ray.length_squared()
}

/// No ground is drawn lower: it may be wrong by so many pixels as far away as the limb.
fn floor_m(ground: &Formula, seen: &GroundView, stats: &SurfaceStats) -> f64 {
    let eye_m = seen.eye_itrf_m.length();
    let limb_m = (eye_m * eye_m - EARTH.polar_radius_m.powi(2))
        .max(0.0)
        .sqrt()
        + 1e5;
    let wrong_m = stats.error_px.unwrap_or(0.0) * seen.pixel_rad * limb_m;
    ground.range.0 - wrong_m.min(3e6)
}

/// Rays through the middles of pixels.
fn rays(view: &EyeView) -> impl Iterator<Item = DVec3> {
    let view = *view;
    (0..SIZE.0 * SIZE.1).map(move |k| common::ray(&view, k % SIZE.0, k / SIZE.0, SIZE))
}

#[test]
fn no_ray_is_lost_and_each_meets_the_data() {
    let mut wrong = Vec::new();
    for (name, ground) in grounds() {
        for (place, view) in views() {
            let seen = ground_view(&view, 1.0);
            let eye_m = seen.eye_itrf_m;
            let mut surface = ContourPages::new(PageOptions::default());
            // From the first frame on there are no open nodes.
            for frame in 0..4 {
                let stats = surface.prepare(&seen, &ground);
                let floor_m = floor_m(&ground, &seen, &stats);
                let lost = rays(&view).step_by(7).filter(|ray| {
                    goes_through(eye_m, *ray, floor_m) && surface.cast(eye_m, *ray).is_none()
                });
                let lost: Vec<_> = lost.collect();
                if let Some(ray) = lost.first() {
                    println!("{}", met(&surface, eye_m, *ray));
                }
                let lost = lost.len();
                if lost > 0 {
                    wrong.push(format!(
                        "{name}, {place}: {lost} rays lost in frame {frame}"
                    ));
                }
            }
            let stats = settle(&mut surface, &seen, &ground);
            let bound_px = stats.error_px.unwrap_or(f64::NAN);
            let floor_m = floor_m(&ground, &seen, &stats);
            let (mut lost, mut errors_px) = (0, Vec::new());
            for ray in rays(&view) {
                let Some(t) = surface.cast(eye_m, ray) else {
                    lost += u32::from(goes_through(eye_m, ray, floor_m));
                    continue;
                };
                let met = EARTH.geodetic_from_itrf(eye_m + ray * t);
                let data_m = ground.height_m(met.lat_rad, met.lon_rad, 0.0);
                errors_px.push((met.height_m - data_m).abs() / (t * seen.pixel_rad));
            }
            errors_px.sort_by(f64::total_cmp);
            let at = |part: f64| errors_px[((errors_px.len() - 1) as f64 * part) as usize];
            println!(
                "{name}, {place}: {} pages, {lost} lost, median {:.3} px, 99 % {:.3} px, most {:.3} px, bound {bound_px:.3} px",
                stats.patches,
                at(0.5),
                at(0.99),
                at(1.0)
            );
            if lost > 0 {
                wrong.push(format!("{name}, {place}: {lost} rays lost"));
            }
            // Cliffs are steps of the data themselves: no spacing draws them.
            if name != "cliffs" && name != "spike and pit" && (bound_px > 1.0 || at(1.0) > 1.1) {
                wrong.push(format!("{name}, {place}: {:.3} px, {bound_px:.3}", at(1.0)));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Rays that run along the walls between pages, from every drawn page's own corners.
#[test]
fn rays_along_the_borders_of_pages_are_not_lost() {
    let ground = hills();
    let mut worst = 0;
    for (place, view) in views() {
        let seen = ground_view(&view, 0.25);
        let eye_m = seen.eye_itrf_m;
        let mut surface = ContourPages::new(PageOptions::default());
        let stats = settle(&mut surface, &seen, &ground);
        let floor_m = floor_m(&ground, &seen, &stats);
        let draw = surface.draw();
        let (mut rays, mut lost) = (0, 0);
        for drawn in draw.drawn {
            let page = &draw.pages[drawn.page as usize];
            for (a, b) in [(4, 5), (5, 7), (7, 6), (6, 4)] {
                for part in 0..16 {
                    // On the wall's face, halfway down the prism.
                    let at = |k: usize| 0.5 * (page.corners_m[k] + page.corners_m[k - 4]);
                    let on = at(a).lerp(at(b), f64::from(part) / 15.0) + page.origin_itrf_m;
                    let ray = (on - eye_m).normalize();
                    if !goes_through(eye_m, ray, floor_m) {
                        continue;
                    }
                    let clip = seen.clip_from_eye * ray.extend(1.0);
                    // In the picture, not only in a prism that reaches into it.
                    if clip.w <= 0.0 || clip.x.abs().max(clip.y.abs()) >= clip.w {
                        continue;
                    }
                    rays += 1;
                    lost += u32::from(surface.cast(eye_m, ray).is_none());
                }
            }
        }
        println!("{place}: {lost} of {rays} lost");
        worst = worst.max(lost);
        assert!(rays > 30, "{place}: {rays}");
    }
    assert_eq!(worst, 0);
}

/// The hit of a ray, for messages.
fn met(surface: &ContourPages, eye_m: DVec3, towards: DVec3) -> String {
    let draw = surface.draw();
    let mut text = String::new();
    for drawn in draw.drawn {
        let page = &draw.pages[drawn.page as usize];
        let ray = ContourRay {
            from: -(page.origin_itrf_m - eye_m).as_vec3(),
            towards: towards.as_vec3(),
            most: 1e30,
            cone: draw.cone as f32,
            slack: 1.0,
            step: drawn.skirt_m as f32,
        };
        if let Some((t, node)) = contour_cast(&page.nodes, 0, &ray) {
            let node = &page.nodes[node as usize];
            let upright = node.normal.as_dvec3().dot(page.axes[2]);
            let at = EARTH.geodetic_from_itrf(page.origin_itrf_m + node.at.as_dvec3());
            text += &format!(
                "{t} m, cosine {upright}, {at:?}, {node:?}, radius {}\n",
                page.radius_m
            );
        }
    }
    text
}

#[test]
fn whatever_is_asked_the_answer_is_finite_and_bounded() {
    let wild = Formula {
        height_m: |lat, lon| match (lat * 10.0) as i32 % 4 {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => -1e30,
            _ => lon,
        },
        range: (-1e4, 1e4),
        spacing_rad: f64::NAN,
    };
    let mut all = grounds();
    all.push(("wild", wild));
    let options = PageOptions {
        max_pages: 0,
        built_per_frame: 40,
        ..PageOptions::default()
    };
    let most = options.within_limits().max_pages;
    for (name, ground) in &all {
        let mut surface = ContourPages::new(options);
        let up = tilted(
            Geodetic::from_degrees(22.5, -90.0, 3e4),
            0.0,
            89.0,
            50.0,
            1.6,
        );
        let buried = tilted(
            Geodetic::from_degrees(21.0, -91.0, -2e4),
            0.0,
            0.0,
            50.0,
            1.6,
        );
        let far = down(Geodetic::from_degrees(22.5, -90.0, 1e12), 50.0, 1.6);
        let extra = [("up", up), ("buried", buried), ("far", far)];
        for (place, view) in views().into_iter().chain(extra) {
            for tolerance_px in [0.0, 1.0, 1e9] {
                let seen = ground_view(&view, tolerance_px);
                for _ in 0..6 {
                    surface.prepare(&seen, ground);
                }
                let draw = surface.draw();
                assert!(draw.pages.len() <= most as usize);
                for drawn in draw.drawn {
                    let page = &draw.pages[drawn.page as usize];
                    assert!((1..=MAX_NODES as usize).contains(&page.nodes.len()));
                    let is_finite = |node: &terrella_ground::globe::contours::ContourNode| {
                        node.normal.is_finite()
                            && node.at.is_finite()
                            && node.walls.iter().all(|wall| wall.is_finite())
                            && (node.ceiling + node.middle + node.thickness).is_finite()
                    };
                    assert!(page.nodes.iter().all(is_finite), "{name}, {place}");
                    assert!(page.corners_m.iter().all(|c| c.is_finite()));
                    assert!(drawn.skirt_m.is_finite() && page.error_m.is_finite());
                }
                for ray in rays(&view).step_by(101) {
                    let t = surface.cast(seen.eye_itrf_m, ray);
                    assert!(t.is_none_or(f64::is_finite), "{name}, {place}: {t:?}");
                    if place == "up" && tolerance_px < 2.0 && t.is_some() {
                        panic!("{name}: {t:?}; {}", met(&surface, seen.eye_itrf_m, ray));
                    }
                }
            }
        }
    }
}

/// An eye below the ground sees ground in every direction, and one above it none above itself.
#[test]
fn an_eye_in_the_ground_sees_nothing_else() {
    let all = grounds();
    let (_, flat) = &all[1];
    for (height_m, wanted) in [(1498.0, Some(0.0)), (1502.0, None)] {
        let place = Geodetic::from_degrees(21.0, -91.0, height_m);
        let view = tilted(place, 30.0, 40.0, 50.0, 1.6);
        let seen = ground_view(&view, 1.0);
        let mut surface = ContourPages::new(PageOptions::default());
        settle(&mut surface, &seen, flat);
        for ray in rays(&view) {
            assert_eq!(surface.cast(seen.eye_itrf_m, ray), wanted, "{height_m} m");
        }
    }
}

/// A view at rest reads nothing; one that trembles at a level's edge does not build the same page again and again.
#[test]
fn what_is_built_stays() {
    let ground = hills();
    let mut surface = ContourPages::new(PageOptions::default());
    let view = |height_m: f64| {
        let place = Geodetic::from_degrees(22.0, -91.0, height_m);
        ground_view(&tilted(place, 40.0, -40.0, 50.0, 1.6), 0.25)
    };
    let stats = settle(&mut surface, &view(3e4), &ground);
    assert!(
        stats.patches > 30 && stats.error_px.is_some_and(|px| px <= 0.25),
        "{stats:?}"
    );
    let mut read = 0;
    for step in 0..40 {
        let height_m = 3e4 * (1.0 + 1e-4 * f64::from(step % 2));
        read += surface.prepare(&view(height_m), &ground).samples_read;
    }
    // The other height may need a page more, once.
    assert!(read <= 4 * 745, "{read} heights read at rest");
}

/// The device's own drawing against the same walk on the CPU, and against the data.
#[test]
fn the_gpu_answers_as_the_cpu_does() {
    use terrella_measure::errors::{GeolocationRenderer, GroundPicture};
    let mut wrong = Vec::new();
    for (place, view) in views() {
        let ground = Arc::new(hills());
        let options = GroundOptions {
            elevation: ground.clone(),
            surface: SurfaceSettings::CastContours(PageOptions::default()),
            tolerance_px: 1.0,
        };
        let mut earth =
            GeolocationRenderer::with_ground(common::gpu(), &options).expect("an Earth");
        let wait = std::time::Duration::from_secs(60);
        earth.settle(&view, SIZE, wait);
        let places = earth.draw(&view, SIZE).expect("a picture");
        let seen = ground_view(&view, 1.0);
        let mut surface = ContourPages::new(PageOptions::default());
        settle(&mut surface, &seen, ground.as_ref());
        let forward = view.view_from_world.inverse() * DVec3::NEG_Z;
        let (mut other, mut apart) = (0, Vec::new());
        for (k, ray) in (0..).zip(rays(&view)) {
            let (x, y) = (k % SIZE.0, k / SIZE.0);
            let drawn = places.along(x, y).map(|along| along / ray.dot(forward));
            match (drawn, surface.cast(seen.eye_itrf_m, ray)) {
                (None, None) => {}
                (Some(a), Some(b)) => apart.push((a - b).abs() / b),
                _ => other += 1,
            }
        }
        apart.sort_by(f64::total_cmp);
        let at = |part: f64| apart[((apart.len() - 1) as f64 * part) as usize];
        let picture = GroundPicture::new(&places, &view, &EARTH, ground.as_ref()).expect("pixels");
        let errors = picture.errors(&EARTH, ground.as_ref(), None);
        println!(
            "{place}: {} pixels, {other} hit in one alone, apart by {:.1e}, 99 % {:.1e} of the distance; {errors:?}",
            apart.len(),
            at(0.5),
            at(0.99)
        );
        // Rays that graze a crest may pass it in one and not in the other.
        if apart.len() < 300 || other > 3 || at(0.99) > 1e-4 || errors.holes > 0 {
            wrong.push(place);
        }
        // A grazing error is long along the ray: it is measured in pixels.
        if errors.p99_px > 1.0 {
            wrong.push(place);
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// The terrain of Trinidad on the flights of the report: no hole, errors within the tolerance; and its cost compared with triangles in the same
/// view.
#[test]
fn trinidad_has_no_holes_in_descent_low_flight_and_horizon() {
    use std::time::Instant;
    use terrella_ground::globe::contours::ContourOptions;
    use terrella_measure::errors::{GeolocationRenderer, GroundPicture};
    use terrella_measure::surfaces::SurfacePath;
    let files = ["textures/elevation.png", "textures/dem/trinidad.png"]
        .map(|file| std::path::Path::new(crate::REPOSITORY).join(file));
    let ground = Arc::new(terrella_play::read_ground(&files, false, false).expect("heights"));
    let site = Geodetic::from_degrees(37.5, -105.5, 0.0);
    let size = (192, 108);
    let wait = std::time::Duration::from_secs(60);
    for path in [SurfacePath::Descent, SurfacePath::Low, SurfacePath::Horizon] {
        let time_s = 0.7 * path.duration_s();
        let view = path.view(time_s, site, &EARTH, ground.as_ref(), 16.0 / 9.0);
        let cast = SurfaceSettings::CastContours(PageOptions::default());
        let patches = SurfaceSettings::Contours(ContourOptions::default());
        let mut times_s = Vec::new();
        for surface in [cast, patches] {
            let options = GroundOptions {
                elevation: ground.clone(),
                surface,
                tolerance_px: 1.0,
            };
            let mut earth =
                GeolocationRenderer::with_ground(common::gpu(), &options).expect("an Earth");
            earth.settle(&view, size, wait);
            let mut places = earth.draw(&view, size).expect("a picture");
            let mut best_s = f64::INFINITY;
            for _ in 0..3 {
                let start = Instant::now();
                places = earth.draw(&view, size).expect("a picture");
                best_s = best_s.min(start.elapsed().as_secs_f64());
            }
            times_s.push(best_s);
            let stats = earth.stats();
            let picture = GroundPicture::new(&places, &view, &EARTH, ground.as_ref());
            let errors = picture
                .expect("pixels")
                .errors(&EARTH, ground.as_ref(), None);
            println!(
                "{path:?}, {}: {} pages or patches, {} resident bytes, {} on the GPU, bound {:?} px; {errors:?}; {:.1} ms",
                if times_s.len() == 1 {
                    "cast"
                } else {
                    "patches"
                },
                stats.ground.patches,
                stats.ground.resident_bytes,
                stats.ground_bytes,
                stats.ground.error_px,
                1e3 * best_s
            );
            if times_s.len() == 1 {
                assert_eq!(errors.holes, 0, "{path:?}");
                assert!(
                    errors.p99_px <= 1.0 && errors.pixels > 5000,
                    "{path:?}: {errors:?}"
                );
            }
        }
        let rays = f64::from(size.0 * size.1);
        println!(
            "{path:?}: {:.2} of the time of patches, {:.0} rays a second",
            times_s[0] / times_s[1],
            rays / times_s[0]
        );
    }
}
