//! Earth-fixed lines, and ground stations.

use super::rig::{
    Circle, MAGENTA, Rig, SIZE, WGS84, aspect, differs, limb_px, options, pixel, style,
};
use crate::common;
use glam::DVec3;
use terrella::frames::Geodetic;
use terrella::tracks::{GroundMark, LineStyle, Polylines, Station, is_hidden};
use terrella_ground::air::Atmosphere;

const LINES: LineStyle = LineStyle {
    color: MAGENTA,
    opacity: 1.0,
    width_px: 3.0,
    is_cased: false,
};

fn circle() -> Circle {
    Circle {
        radius_m: 7.0e6,
        inclination_rad: 0.6,
    }
}

/// A graticule of 30° is on screen at its places, as far as the globe does not hide them, and nowhere else.
#[test]
fn a_graticule_is_where_it_is_and_the_globe_hides_it() {
    let mut rig = Rig::new(options(Atmosphere::None), style(|_| {}));
    let lines = Polylines::graticule(LINES, &WGS84, 30.0).expect("lines");
    rig.tracks.set_lines(vec![lines]).expect("lines");
    let (mut seen, mut hidden) = (0, 0);
    for (lat, lon, height_m, pitch, fov) in [
        (20.0, 10.0, 2e7, -90.0, 40.0),
        (-75.0, 100.0, 9e6, -80.0, 60.0),
        (10.0, -55.0, 1e6, -60.0, 70.0),
    ] {
        let place = Geodetic::from_degrees(lat, lon, height_m);
        let view = common::tilted(place, 20.0, pitch, fov, aspect());
        let (with, without, _) = rig.draw(&view, &circle());
        let eye = view.eye_world;
        let mut may = vec![false; (SIZE.0 * SIZE.1) as usize];
        let mut look_at = |lat_deg: f64, lon_deg: f64| {
            let place = WGS84.itrf_from_geodetic(Geodetic::from_degrees(lat_deg, lon_deg, 0.0));
            let Some((x, y)) = pixel(&view, place) else {
                return;
            };
            let is_hidden = is_hidden(eye, place, &WGS84);
            if is_hidden && limb_px(&view, place) > 4.0 {
                hidden += 1;
                return;
            }
            for (dx, dy) in (-3..=3).flat_map(|dx| (-3..=3).map(move |dy| (dx, dy))) {
                let (x, y) = (x as i32 + dx, y as i32 + dy);
                may[(y as u32 * SIZE.0 + x as u32) as usize] = true;
            }
            if !is_hidden && limb_px(&view, place) > 4.0 {
                // Simplified lines may be off by less than a pixel.
                let near = (0..9).map(|k| (x as u32 + k % 3 - 1, y as u32 + k / 3 - 1));
                let off = near.map(|(x, y)| differs(&with, &without, x, y)).max();
                assert!(off > Some(60), "nothing at {lat_deg}° {lon_deg}°");
                seen += 1;
            }
        };
        for k in 0..=18_000 {
            let along = f64::from(k) * 0.02;
            for parallel in [-60.0, -30.0, 0.0, 30.0, 60.0] {
                look_at(parallel, along - 180.0);
            }
            for meridian in -5..=6 {
                let end = if meridian % 3 == 0 { 90.0 } else { 60.0 };
                let lat = 0.5 * along - 90.0;
                if lat.abs() <= end {
                    look_at(lat, 30.0 * f64::from(meridian));
                }
            }
        }
        for y in 6..SIZE.1 - 6 {
            for x in 6..SIZE.0 - 6 {
                let is_drawn = differs(&with, &without, x, y) > 0;
                assert!(
                    !is_drawn || may[(y * SIZE.0 + x) as usize],
                    "something at {x} {y} from {lat}° {lon}°"
                );
            }
        }
    }
    assert!(seen > 50_000 && hidden > 50_000, "{seen} {hidden}");
}

/// Without lines there is no pipeline and nothing is drawn; a line can be taken away again.
#[test]
fn lines_that_are_off_cost_nothing() {
    let mut rig = Rig::new(options(Atmosphere::None), style(|_| {}));
    assert_eq!(rig.tracks.shader_bytes(), 0);
    let view = common::down(Geodetic::from_degrees(0.0, 0.0, 2e7), 40.0, aspect());
    let (with, without, stats) = rig.draw(&view, &circle());
    assert_eq!((stats.points, stats.draw_calls), (0, 0));
    assert!(with == without);
    let lines = Polylines::graticule(LINES, &WGS84, 10.0).expect("lines");
    rig.tracks.set_lines(vec![lines]).expect("lines");
    let (with, without, stats) = rig.draw(&view, &circle());
    assert!(stats.points > 100 && stats.draw_calls == 1, "{stats:?}");
    assert!(with != without && rig.tracks.shader_bytes() > 0);
    rig.tracks.set_lines(Vec::new()).expect("lines");
    let (with, without, stats) = rig.draw(&view, &circle());
    assert!(with == without && stats.draw_calls == 0);
}

/// A marked place in sight has a ring and a place for its name, one on the far side has neither, and a place that is only named has no
/// ring.
#[test]
fn marked_places_are_drawn_on_the_side_that_is_seen() {
    let mut rig = Rig::new(options(Atmosphere::None), style(|_| {}));
    let view = common::down(Geodetic::from_degrees(20.0, 30.0, 5e6), 40.0, aspect());
    let mark = |lat_deg, lon_deg, is_marked| GroundMark {
        place: Geodetic::from_degrees(lat_deg, lon_deg, 0.0),
        color: MAGENTA,
        opacity: 1.0,
        width_px: 3.0,
        is_marked,
        is_named: true,
    };
    let (_, _, stats) = rig.draw(&view, &circle());
    assert_eq!((stats.marks, stats.draw_calls), (0, 0));
    let places = [
        mark(-20.0, -150.0, true),
        mark(20.0, 30.0, true),
        mark(22.0, 30.0, false),
    ];
    rig.tracks.set_places(&places).expect("places");
    let (with, without, stats) = rig.draw(&view, &circle());
    assert_eq!((stats.marks, stats.draw_calls), (1, 1));
    assert!(with != without);
    let labels = rig.tracks.place_labels();
    let named: Vec<_> = labels.iter().map(|label| label.place).collect();
    assert_eq!(named, [1, 2]);
    // Straight below the eye is the middle of the picture; north is up.
    let [x, y] = labels[0].at_px;
    let off = (x - 0.5 * SIZE.0 as f32).abs() + (y - 0.5 * SIZE.1 as f32).abs();
    assert!(off < 0.5, "{x} {y}");
    assert!(labels[1].at_px[1] < y - 1.0);
    let wrong = mark(91.0, 0.0, true);
    assert!(rig.tracks.set_places(&[wrong]).is_err());
    rig.tracks.set_places(&[]).expect("none");
    let (with, without, stats) = rig.draw(&view, &circle());
    assert!(with == without && stats.marks == 0);
}

/// A station below the satellite has a line to it, a circle and a position for its name; one on the far side has none of them.
#[test]
fn a_station_shows_the_satellite_that_it_sees() {
    let circle = circle();
    let mut rig = Rig::new(options(Atmosphere::None), style(|_| {}));
    let satellite = circle.as_seen_now(0.0);
    let foot = WGS84.geodetic_from_itrf(satellite);
    let station = |lat_rad: f64, lon_rad: f64| Station {
        place: Geodetic {
            lat_rad,
            lon_rad,
            height_m: 0.0,
        },
        min_elevation_rad: 0.1,
        color: MAGENTA,
        width_px: 3.0,
    };
    let near = station(foot.lat_rad + 0.08, foot.lon_rad);
    let far = station(-foot.lat_rad, foot.lon_rad + std::f64::consts::PI);
    rig.tracks.set_stations(&[near, far], 0).expect("stations");
    let above = Geodetic {
        height_m: 9e6,
        ..foot
    };
    // From the side, so that the line is long.
    let view = common::tilted(above, 90.0, -88.0, 45.0, aspect());
    let (with, without, stats) = rig.draw(&view, &circle);
    assert_eq!((stats.accesses, stats.marks), (1, 2));
    let labels = rig.tracks.station_labels();
    assert_eq!(labels.len(), 1);
    assert_eq!((labels[0].station, labels[0].color), (0, MAGENTA));
    let at = WGS84.itrf_from_geodetic(near.place);
    let (x, y) = pixel(&view, at).expect("in the picture");
    assert!((f64::from(labels[0].at_px[0]) - x).abs() < 0.01);
    assert!((f64::from(labels[0].at_px[1]) - y).abs() < 0.01);
    let is_drawn = |place: DVec3| {
        let (x, y) = pixel(&view, place).expect("in the picture");
        differs(&with, &without, x as u32, y as u32) > 60
    };
    for k in 2..=9 {
        assert!(is_drawn(at.lerp(satellite, f64::from(k) / 10.0)), "{k}");
    }
    // Positions at which the satellite would be at the mask, found by bisection.
    let height_m = foot.height_m;
    for azimuth in [0.3, 1.7, 3.1, 5.5_f64] {
        let there = |angle: f64| {
            let (sin, cos) = azimuth.sin_cos();
            let lat = near.place.lat_rad;
            let sin_lat = lat.sin() * angle.cos() + lat.cos() * angle.sin() * cos;
            let lon = (sin * angle.sin() * lat.cos()).atan2(angle.cos() - lat.sin() * sin_lat);
            Geodetic {
                lat_rad: sin_lat.asin(),
                lon_rad: near.place.lon_rad + lon,
                height_m: 0.0,
            }
        };
        let (mut inside, mut outside) = (0.0, 0.6);
        for _ in 0..50 {
            let middle = 0.5 * (inside + outside);
            let at_height = Geodetic {
                height_m,
                ..there(middle)
            };
            match near.sees(WGS84.itrf_from_geodetic(at_height), &WGS84) {
                true => inside = middle,
                false => outside = middle,
            }
        }
        let place = WGS84.itrf_from_geodetic(there(inside));
        assert!(is_drawn(place), "no circle at azimuth {azimuth}");
    }
    // A satellite that has set is no longer in view.
    let low = Station {
        min_elevation_rad: 1.5,
        ..near
    };
    rig.tracks.set_stations(&[low], 0).expect("stations");
    assert_eq!(rig.draw(&view, &circle).2.accesses, 0);
}
