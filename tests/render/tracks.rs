//! Images of tracks: occlusion by the globe, the air in front, positions of lines on screen, and the absence of disabled elements.

mod lines;
mod rig;
mod views;

use crate::common;
use glam::DVec3;
use image::RgbaImage;
use rig::{
    Circle, MAGENTA, Rig, SIZE, WGS84, any_pixel, aspect, differs, from_segment, limb_px, now,
    options, pixel, q_of, style, views, whole,
};
use terrella::frames::Geodetic;
use terrella::internals::gpu::{DepthBuffer, FrameTargets};
use terrella::tracks::{
    Footprint, TrackSpan, TrackStyle, Tracks, TracksOptions, is_beyond_air, is_hidden,
};
use terrella::{Earth, EarthOptions, EyeView};
use terrella_ground::air::{Atmosphere, TOP};
use terrella_orbit::{Feed, FieldOfView, FieldShape};

#[test]
fn a_trail_is_where_it_is_and_the_globe_hides_it_exactly() {
    let circle = Circle {
        radius_m: 7.0e6,
        inclination_rad: 0.6,
    };
    let style = style(|style| style.trail = whole(circle.radius_m));
    let mut rig = Rig::new(options(Atmosphere::None), style);
    let (mut seen, mut hidden) = (0, 0);
    for (k, view) in views(&circle).iter().enumerate() {
        let (with, without, _) = rig.draw(view, &circle);
        let eye = view.eye_world;
        let mut shown = vec![false; (SIZE.0 * SIZE.1) as usize];
        for step in 0..72_000 {
            let place = circle.as_seen_now(-std::f64::consts::TAU * f64::from(step) / 72_000.0);
            let Some((x, y)) = pixel(view, place) else {
                continue;
            };
            let is_hidden = is_hidden(eye, place, &WGS84);
            // A line is as wide beyond the limb, where its middle is just hidden.
            let is_shown = !is_hidden || limb_px(view, place) < 6.0;
            if is_shown {
                // Reach of half the width and its outline.
                for (dx, dy) in (-6..=6).flat_map(|dx| (-6..=6).map(move |dy| (dx, dy))) {
                    let (x, y) = (x as i32 + dx, y as i32 + dy);
                    if (0..SIZE.0 as i32).contains(&x) && (0..SIZE.1 as i32).contains(&y) {
                        shown[(y as u32 * SIZE.0 + x as u32) as usize] = true;
                    }
                }
                if !is_hidden && limb_px(view, place) > 4.0 && place.distance(eye) > 2e5 {
                    let pixel = with.get_pixel(x as u32, y as u32);
                    assert!(
                        differs(&with, &without, x as u32, y as u32) > 25 && pixel[0] > pixel[1],
                        "view {k}, step {step}: nothing at {x:.1} {y:.1}: {pixel:?}"
                    );
                    seen += 1;
                }
            } else {
                hidden += 1;
            }
        }
        // Nowhere else: not behind the globe, and no streaks of parts behind the eye.
        for y in 0..SIZE.1 {
            for x in 0..SIZE.0 {
                let may = shown[(y * SIZE.0 + x) as usize]
                    || [0, 1, 2, 3, 4, 5]
                        .iter()
                        .any(|e| x == *e || y == *e || x + e + 1 == SIZE.0 || y + e + 1 == SIZE.1);
                assert!(
                    may || differs(&with, &without, x, y) == 0,
                    "view {k}: something at {x} {y}"
                );
            }
        }
    }
    println!("{seen} places seen, {hidden} hidden");
    assert!(seen > 80_000 && hidden > 40_000, "{seen} {hidden}");
}

#[test]
fn the_air_tints_what_lies_behind_it_and_nothing_before_it() {
    let circle = Circle {
        radius_m: 7.2e6,
        inclination_rad: 0.0,
    };
    let style = style(|style| style.trail = whole(circle.radius_m));
    for samples in [1, 4] {
        let options = EarthOptions {
            samples,
            ..options(Atmosphere::Billboard)
        };
        let mut rig = Rig::new(options, style);
        let place = Geodetic::from_degrees(18.0, 0.0, 3.5e7);
        // Close to where the circle crosses the limb.
        rig.sun = DVec3::new(0.6, 0.8, 0.0);
        let (mut behind, mut before) = (Vec::new(), Vec::new());
        for yaw in [-1.0, 1.0] {
            let down = common::down(place, 25.0, aspect());
            let eye = down.eye_world;
            let limb = DVec3::new(0.0, yaw * 6.4e6, 0.0);
            let view = EyeView::itrf(eye, limb - eye, DVec3::Z, 0.1, aspect());
            let (with, without, _) = rig.draw(&view, &circle);
            for step in 0..72_000 {
                let angle = -std::f64::consts::TAU * f64::from(step) / 72_000.0;
                let place = circle.as_seen_now(angle);
                let Some((x, y)) = pixel(&view, place) else {
                    continue;
                };
                let q = q_of(eye, place);
                if !(1.001..1.008).contains(&q) {
                    continue;
                }
                let air = without.get_pixel(x as u32, y as u32).0;
                let line = with.get_pixel(x as u32, y as u32).0;
                // The most recent part is opaque enough for the test.
                match is_beyond_air(eye, place, TOP, &WGS84) {
                    true => behind.push((air, line)),
                    false => before.push((air, line)),
                }
            }
        }
        println!(
            "{samples}: {} behind, {} before: {:?} {:?}",
            behind.len(),
            before.len(),
            behind.first(),
            before.first()
        );
        assert!(behind.len() > 20 && before.len() > 20);
        // Before the air, a line of no green takes green away; behind it the air's own green is added whole.
        let green = |list: &[([u8; 4], [u8; 4])]| {
            let sum: f64 = list
                .iter()
                .map(|(air, line)| f64::from(line[1]) - f64::from(air[1]))
                .sum();
            sum / list.len() as f64
        };
        let sunlit: Vec<_> = before
            .iter()
            .filter(|(air, _)| air[1] > 40)
            .copied()
            .collect();
        let lit_behind: Vec<_> = behind
            .iter()
            .filter(|(air, _)| air[1] > 40)
            .copied()
            .collect();
        println!(
            "green: before {} of {}, behind {} of {}",
            green(&sunlit),
            sunlit.len(),
            green(&lit_behind),
            lit_behind.len()
        );
        assert!(sunlit.len() > 10 && lit_behind.len() > 10);
        assert!(
            green(&sunlit) < -8.0,
            "a line before the air hides some of it"
        );
        assert!(
            green(&lit_behind) > -1.0,
            "a line behind the air takes nothing from its light"
        );
    }
}

#[test]
fn a_ground_track_lies_on_the_ground_at_any_height_and_up_to_the_limb() {
    let circle = Circle {
        radius_m: 6.9e6,
        inclination_rad: 1.5,
    };
    let style = style(|style| {
        style.ground_track = Some(TrackSpan::Seconds {
            before_s: 3000.0,
            after_s: 3000.0,
        });
    });
    let mut rig = Rig::new(options(Atmosphere::None), style);
    let foot = |t_s: f64| {
        let state = circle
            .state_at(now() + terrella::frames::Duration::from_seconds(t_s))
            .expect("a state");
        let g = WGS84.geodetic_from_itrf(state.in_itrf().position_m);
        Geodetic { height_m: 0.0, ..g }
    };
    let mut seen = 0;
    // Over the track itself, at the pole, at the date line's side of the Earth, from far, and along the ground.
    for (t_s, height_m, pitch, fov) in [
        (0.0, 4e5, -90.0, 70.0),
        (1500.0, 4e5, -90.0, 70.0),
        (-1200.0, 4e5, -20.0, 60.0),
        (700.0, 3.58e7, -90.0, 20.0),
        (-2500.0, 3.58e7, -90.0, 20.0),
        (300.0, 2e3, -90.0, 60.0),
        (900.0, 2e6, -45.0, 60.0),
    ] {
        let over = Geodetic {
            height_m,
            ..foot(t_s)
        };
        let view = common::tilted(over, 10.0, pitch, fov, aspect());
        let (with, without, _) = rig.draw(&view, &circle);
        let eye = view.eye_world;
        for step in -2900..2900 {
            let place = WGS84.itrf_from_geodetic(foot(f64::from(step)));
            let Some((x, y)) = pixel(&view, place) else {
                continue;
            };
            let difference = differs(&with, &without, x as u32, y as u32);
            // Pixels antialiased by the limb are left out.
            if !is_hidden(eye, place * 1.000_001, &WGS84) && limb_px(&view, place) > 2.0 {
                assert!(
                    difference > 8,
                    "{height_m} m, {step}: hidden at {x:.1} {y:.1}"
                );
                seen += 1;
            }
        }
        // Off the disc there is nothing, not even beside lines that run along the limb.
        for y in 0..SIZE.1 {
            for x in 0..SIZE.0 {
                let ray = common::ray(&view, x, y, SIZE);
                let q = q_of(eye, eye + ray * 1e6);
                let is_off =
                    q > 1.0 + 4.0 * fov.to_radians() / f64::from(SIZE.1) * eye.length() / 6.3e6;
                assert!(
                    !is_off || differs(&with, &without, x, y) == 0,
                    "{height_m} m: something beside the globe at {x} {y}"
                );
            }
        }
    }
    println!("{seen} places seen");
    assert!(seen > 3000, "{seen}");
}

#[test]
fn a_footprint_is_tinted_where_rays_say() {
    let circle = Circle {
        radius_m: 8.0e6,
        inclination_rad: 0.9,
    };
    let nadir = |half_deg: f64| FieldOfView::nadir(half_deg.to_radians());
    let tilted = FieldOfView {
        shape: FieldShape::Rectangle {
            along_rad: 0.1,
            across_rad: 0.4,
        },
        off_nadir_rad: 0.5,
        azimuth_rad: 4.0,
    };
    for field in [
        Some(nadir(20.0)),
        Some(nadir(51.0)),
        None,
        Some(FieldOfView {
            off_nadir_rad: 0.6,
            ..nadir(20.0)
        }),
        Some(tilted),
    ] {
        let style = style(|style| {
            style.footprint = Some(Footprint {
                field,
                is_filled: true,
                ..Footprint::default()
            });
        });
        let mut rig = Rig::new(options(Atmosphere::None), style);
        let satellite = circle.as_seen_now(0.0);
        let g = WGS84.geodetic_from_itrf(satellite);
        // On a circle it flies where it will be.
        let flight = circle.as_seen_now(1e-3) - satellite;
        let seen = field.unwrap_or(nadir(90.0));
        let aimed = seen.aimed(satellite, flight, &WGS84).expect("above");
        let mut outline = Vec::new();
        aimed.outline(|p| outline.push(p));
        for (dlat, dlon, height, pitch) in [
            (0.0, 0.0, 2e7, -90.0),
            (5.0, -50.0, 1e7, -85.0),
            (3.0, 8.0, 9e5, -60.0),
            (20.0, 150.0, 2e7, -90.0),
        ] {
            let over = Geodetic {
                lat_rad: g.lat_rad + f64::to_radians(dlat),
                lon_rad: g.lon_rad + f64::to_radians(dlon),
                height_m: height,
            };
            let view = common::tilted(over, 200.0, pitch, 50.0, aspect());
            let (with, without, _) = rig.draw(&view, &circle);
            let on_screen: Vec<_> = outline.iter().map(|p| any_pixel(&view, *p)).collect();
            let next = on_screen.iter().cycle().skip(1);
            let edges: Vec<_> = on_screen
                .iter()
                .zip(next)
                .filter_map(|(a, b)| Some(((*a)?, (*b)?)))
                .collect();
            let (mut tinted, mut compared) = (0, 0);
            for y in 8..SIZE.1 - 8 {
                for x in 8..SIZE.0 - 8 {
                    let at = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                    if edges.iter().any(|edge| from_segment(at, *edge) < 8.0) {
                        continue;
                    }
                    let ground = common::looks_at(&view, x, y, SIZE).map(|place| {
                        WGS84.itrf_from_geodetic(Geodetic {
                            height_m: 0.0,
                            ..place
                        })
                    });
                    let q = q_of(
                        view.eye_world,
                        view.eye_world + common::ray(&view, x, y, SIZE) * 1e6,
                    );
                    if (q - 1.0).abs() < 0.02 {
                        continue;
                    }
                    let inside = ground.is_some_and(|ground| {
                        let v = ground - satellite;
                        let scale = WGS84.scaled_from_itrf();
                        let faces = (scale * ground).dot(scale * satellite) > 1.0;
                        faces && aimed.margin_rad(v) > 0.0
                    });
                    let difference = differs(&with, &without, x, y);
                    assert_eq!(
                        difference > 3,
                        inside,
                        "{field:?} {height} {x} {y}: {difference}"
                    );
                    compared += 1;
                    tinted += u32::from(inside);
                }
            }
            println!("{field:?} from {height}: {tinted} of {compared} tinted");
            assert!(compared > 50_000);
        }
    }
}

#[test]
fn every_kind_of_pass_shows_the_same() {
    let circle = Circle {
        radius_m: 8e6,
        inclination_rad: 0.4,
    };
    let all = style(|style| {
        style.trail = whole(circle.radius_m);
        style.ground_track = Some(TrackSpan::GROUND_TRACK);
        style.marker = true;
        style.subpoint = true;
        style.footprint = Some(Footprint {
            is_filled: true,
            ..Footprint::default()
        });
    });
    let over = WGS84.geodetic_from_itrf(circle.as_seen_now(-0.3));
    let view = common::down(
        Geodetic {
            height_m: 2e7,
            ..over
        },
        50.0,
        aspect(),
    );
    let base = EarthOptions {
        // Blending in display values differs most from that in light where curves are steep.
        tone: terrella::Tone::Neutral,
        ..options(Atmosphere::Billboard)
    };
    let cases = [
        base.clone(),
        EarthOptions {
            samples: 4,
            ..base.clone()
        },
        EarthOptions {
            color_format: wgpu::TextureFormat::Rgba8Unorm,
            ..base.clone()
        },
        EarthOptions {
            depth: DepthBuffer::None,
            ..base.clone()
        },
    ];
    let mut first: Option<RgbaImage> = None;
    for (k, options) in cases.into_iter().enumerate() {
        let mut rig = Rig::new(options, all);
        let (with, without, stats) = rig.draw(&view, &circle);
        assert_eq!((stats.marks, stats.is_complete), (2, true));
        let changed = with
            .pixels()
            .zip(without.pixels())
            .filter(|(a, b)| a != b)
            .count();
        assert!(changed > 5000, "{k}: {changed}");
        let [label] = rig.tracks.labels() else {
            panic!("one label")
        };
        let [x, y] = label.at_px;
        let dot = with.get_pixel(x as u32, y as u32).0;
        assert_eq!(dot[..3], MAGENTA, "case {k}: the dot itself, at {x} {y}");
        let Some(first) = &first else {
            first = Some(with);
            continue;
        };
        // Display values blend a little otherwise than light; edges are drawn otherwise by four samples.
        let far = with
            .enumerate_pixels()
            .filter(|(x, y, _)| differs(&with, first, *x, *y) > 60)
            .count();
        assert!(far < 1200, "case {k}: {far} pixels differ");
    }
}

#[test]
fn depths_the_other_way_round_show_the_same() {
    let circle = Circle {
        radius_m: 8e6,
        inclination_rad: 0.4,
    };
    let line = style(|style| {
        style.trail = whole(circle.radius_m);
        style.ground_track = Some(TrackSpan::GROUND_TRACK);
    });
    let over = WGS84.geodetic_from_itrf(circle.as_seen_now(-0.3));
    let mut view = common::down(
        Geodetic {
            height_m: 2e7,
            ..over
        },
        50.0,
        aspect(),
    );
    let options = options(Atmosphere::Billboard);
    let (reversed, ..) = Rig::new(options.clone(), line).draw(&view, &circle);
    // Near 1 km, far 100 000 km, nearer is smaller.
    let (near, far) = (1e3, 1e8);
    view.clip_from_view.z_axis.z = -far / (far - near);
    view.clip_from_view.w_axis.z = -near * far / (far - near);
    let depth = DepthBuffer::StandardZ(wgpu::TextureFormat::Depth32Float);
    let (standard, without, _) =
        Rig::new(EarthOptions { depth, ..options }, line).draw(&view, &circle);
    let drawn = standard
        .pixels()
        .zip(without.pixels())
        .filter(|(a, b)| a != b)
        .count();
    let other = standard
        .enumerate_pixels()
        .filter(|(x, y, _)| differs(&standard, &reversed, *x, *y) > 40)
        .count();
    println!("{drawn} drawn, {other} otherwise");
    assert!(drawn > 1500 && other < 50, "{drawn} {other}");
}

#[test]
fn what_is_off_is_absent() {
    let gpu = common::gpu();
    let earth_options = options(Atmosphere::Billboard);
    let earth = Earth::new(&gpu.device, &gpu.queue, &earth_options).expect("an Earth");
    let options = TracksOptions::of(&earth);
    let of = |styles: &[TrackStyle]| Tracks::new(&gpu.device, &options, styles).expect("tracks");
    let none = of(&[TrackStyle::new(0), TrackStyle::new(1)]);
    assert_eq!((none.features_on(), none.shader_bytes()), (vec![], 0));
    let marker = of(&[style(|style| style.marker = true), TrackStyle::new(1)]);
    assert_eq!(marker.features_on(), ["marks"]);
    let trail = of(&[style(|style| style.trail = Some(TrackSpan::TRAIL))]);
    assert_eq!(trail.features_on(), ["trails"]);
    let both = of(&[style(|style| {
        style.trail = Some(TrackSpan::TRAIL);
        style.marker = true;
    })]);
    assert_eq!(
        both.shader_bytes(),
        marker.shader_bytes() + trail.shader_bytes()
    );
    // Byte for byte the picture without, and no draw call.
    let circle = Circle {
        radius_m: 7e6,
        inclination_rad: 0.4,
    };
    let mut rig = Rig::new(earth_options, TrackStyle::new(0));
    let view = common::down(Geodetic::from_degrees(10.0, 20.0, 2e7), 50.0, aspect());
    let (with, without, stats) = rig.draw(&view, &circle);
    assert_eq!(with, without);
    assert_eq!(
        (
            stats.draw_calls,
            stats.triangles,
            stats.points,
            stats.samples
        ),
        (0, 0, 0, 0)
    );
    assert_eq!(FrameTargets::COLOR, options.color_format);
}

#[test]
fn styles_without_meaning_are_rejected() {
    let gpu = common::gpu();
    let earth = Earth::new(&gpu.device, &gpu.queue, &options(Atmosphere::None));
    let options = TracksOptions::of(&earth.expect("an Earth"));
    for (change, words) in [
        ((|s| s.width_px = f32::NAN) as fn(&mut TrackStyle), "width"),
        (
            |s| {
                s.trail = Some(TrackSpan::Seconds {
                    before_s: -1.0,
                    after_s: 0.0,
                })
            },
            "spans",
        ),
        (
            |s| {
                s.ground_track = Some(TrackSpan::Revolutions {
                    before: f64::INFINITY,
                    after: 0.0,
                })
            },
            "spans",
        ),
        (
            |s| {
                s.footprint = Some(Footprint {
                    field: Some(FieldOfView::nadir(2.0)),
                    ..Footprint::default()
                })
            },
            "half angle",
        ),
    ] {
        let rejected = Tracks::new(&gpu.device, &options, &[TrackStyle::new(0), style(change)]);
        let words_of = rejected
            .err()
            .map(|error| error.to_string())
            .unwrap_or_default();
        assert!(
            words_of.contains(words) && words_of.contains("satellite 1"),
            "{words_of}"
        );
    }
}
