//! Cost of views and flights, in processor time and in counted work. Times are printed and never asserted:
//!
//! ```text
//! cargo test -p terrella-ground --all-features --release -- --ignored --nocapture quadtree::tests::work
//! ```

#[path = "../../../../../../benches/heights/mountains.rs"]
mod mountains;

use super::{Posts, view};
use crate::elevation::{
    Bounds, Elevation, Georeference, GridLimits, Ground, HeightEye, HeightGrid,
    HeightStreamOptions, Registration, StreamedGround, open_heights,
};
use crate::globe::quadtree::{Quadtree, QuadtreeOptions};
use crate::globe::surface::{GroundView, Surface, SurfaceStats};
use cpu_time::ThreadTime;
use glam::{DVec3, dcamera};
use std::f64::consts::FRAC_PI_2;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use terrella_frames::{Ellipsoid, Geodetic};

/// Levels of the tiles of `mountains`.
const LEVELS: u8 = 9;
const SIDE: u32 = 128;

/// Cost of calls of `prepare`.
#[derive(Default)]
struct Cost {
    times_ms: Vec<f64>,
    work: u32,
    patches: usize,
    leaves: u32,
    error_px: f64,
}

impl Cost {
    fn prepare(
        &mut self,
        surface: &mut Quadtree,
        view: &GroundView,
        ground: &dyn Elevation,
    ) -> SurfaceStats {
        let start = ThreadTime::now();
        let stats = surface.prepare(view, ground);
        self.times_ms.push(1e3 * start.elapsed().as_secs_f64());
        self.work = self.work.max(surface.work_done);
        self.patches = self.patches.max(surface.patches.len());
        self.leaves = self.leaves.max(surface.leaves());
        self.error_px = stats.error_px.unwrap_or_default();
        stats
    }

    /// Calls `prepare` until nothing changes, at most `most` times. Returns whether that was reached.
    fn settle(
        &mut self,
        surface: &mut Quadtree,
        view: &GroundView,
        ground: &dyn Elevation,
        most: u32,
    ) -> bool {
        let (mut quiet, mut before) = (0, SurfaceStats::default());
        for _ in 0..most {
            let stats = self.prepare(surface, view, ground);
            let is_still = stats.samples_read == 0 && stats == before;
            (quiet, before) = (if is_still { quiet + 1 } else { 0 }, stats);
            if quiet == 10 {
                return true;
            }
        }
        false
    }

    fn print(mut self, what: &str, note: &str) {
        let calls = self.times_ms.len();
        let sum_s = 1e-3 * self.times_ms.iter().sum::<f64>();
        self.times_ms.sort_unstable_by(f64::total_cmp);
        let at = |part: f64| self.times_ms[((calls - 1) as f64 * part).round() as usize];
        println!(
            "| {what} | {calls} | {sum_s:.2} | {:.2} | {:.2} | {:.2} | {} | {} | {} | {:.2} | {note} |",
            at(0.5),
            at(0.99),
            at(1.0),
            self.work,
            self.patches,
            self.leaves,
            self.error_px
        );
    }
}

fn print_head() {
    println!(
        "| what | calls | sum, s | median, ms | 99 % | longest | work at most | patches at most | leaves at most | last error, px | |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
}

/// The leaves as one number that does not depend on their order.
fn leaf_set(surface: &Quadtree) -> String {
    let mut keys: Vec<[u64; 2]> = Vec::new();
    for built in &surface.patches {
        for point in built.points() {
            keys.push([point.0, point.1]);
        }
    }
    keys.sort_unstable();
    keys.dedup();
    let mut hasher = DefaultHasher::new();
    keys.hash(&mut hasher);
    format!("{} points, {:016x}", keys.len(), hasher.finish())
}

fn textures(file: &str) -> Arc<HeightGrid> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../textures")).join(file);
    let heights = open_heights(&path, &GridLimits::default()).expect("the starter pack");
    Arc::new(heights.grid)
}

/// A degree of cliffs, a spike, a pit and rubble, as in the flight of `terrella report --surfaces`.
fn worst_case() -> HeightGrid {
    const SIDE: u32 = 700;
    let height_m = |row: u32, column: u32| -> f32 {
        let (half, quarter) = (SIDE / 2, SIDE / 4);
        let mut bits = u64::from(row * SIDE + column).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let noise = ((bits >> 40) as f32) / 16_777_216.0;
        match (row, column) {
            (r, c) if r == quarter && c == quarter => 9000.0,
            (r, c) if r.abs_diff(3 * quarter) < 8 && c.abs_diff(quarter) < 8 => -11_000.0,
            (r, c) if r < half && c >= half => {
                if (c / 40) % 2 == 0 {
                    3000.0
                } else {
                    0.0
                }
            }
            (r, c) if r >= half && c >= half => 400.0 * noise,
            _ => 500.0,
        }
    };
    let corner = Geodetic::from_degrees(20.0, 10.0, 0.0);
    let side_rad = 1_f64.to_radians();
    let bounds = Bounds {
        south_rad: corner.lat_rad,
        north_rad: corner.lat_rad + side_rad,
        west_rad: corner.lon_rad,
        width_rad: side_rad,
    };
    let place = Georeference::from_bounds(Registration::Posts, &bounds, SIDE, SIDE);
    let heights = (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| height_m(row, column)));
    HeightGrid::new(
        &place.expect("a part of the Earth"),
        heights.collect(),
        &GridLimits::default(),
    )
    .expect("sound")
}

/// An eye that looks along `azimuth_rad` and `pitch_rad`, both as in `docs/surfaces.md`.
fn looking(
    place: Geodetic,
    azimuth_rad: f64,
    pitch_rad: f64,
    fov_rad: f64,
    size: (f64, f64),
) -> GroundView {
    let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let east = DVec3::new(-place.lon_rad.sin(), place.lon_rad.cos(), 0.0);
    let north = up.cross(east);
    let level = north * azimuth_rad.cos() + east * azimuth_rad.sin();
    let forward = level * pitch_rad.cos() + up * pitch_rad.sin();
    let upwards = up * pitch_rad.cos() - level * pitch_rad.sin();
    let projection =
        dcamera::rh::proj::directx::perspective_infinite_reverse(fov_rad, size.0 / size.1, 0.1);
    GroundView {
        eye_itrf_m: Ellipsoid::WGS84.itrf_from_geodetic(place),
        clip_from_eye: projection * dcamera::rh::view::look_to_mat4(DVec3::ZERO, forward, upwards),
        pixel_rad: 2.0 * (0.5 * fov_rad).tan() / size.1,
        tolerance_px: 1.0,
    }
}

const FLIGHTS: [(&str, f64); 4] = [
    ("orbit", 5.0),
    ("descent", 30.0),
    ("low flight", 15.0),
    ("horizon", 10.0),
];

/// A view of a flight of `docs/surfaces.md`.
fn flown(
    flight: &str,
    duration_s: f64,
    time_s: f64,
    site: Geodetic,
    ground: &dyn Elevation,
) -> GroundView {
    let speed_m_s = match flight {
        "orbit" => 7700.0,
        "low flight" => 250.0,
        _ => 0.0,
    };
    let radius_m = Ellipsoid::WGS84.equatorial_radius_m;
    let lat_rad = site.lat_rad;
    let lon_rad = site.lon_rad
        + (time_s - 0.5 * duration_s) * speed_m_s / (radius_m * lat_rad.cos().max(0.01));
    let under_m = ground.height_m(lat_rad, lon_rad, 0.0);
    let height_m = match flight {
        "orbit" => 4e5,
        "descent" => under_m + 4e5 * 5e-3_f64.powf(time_s / duration_s),
        "low flight" => {
            let near_rad = 3000.0 / 6.371e6;
            let aside_rad = near_rad / lat_rad.cos().max(0.01);
            let near = (-3..=3).flat_map(|i| (-3..=3).map(move |j| (f64::from(i), f64::from(j))));
            let highest = near.map(|(i, j)| {
                let (lat, lon) = (lat_rad + i / 3.0 * near_rad, lon_rad + j / 3.0 * aside_rad);
                ground.height_m(lat, lon, near_rad / 3.0)
            });
            highest.fold(under_m, f64::max) + 500.0
        }
        _ => under_m + 3e3,
    };
    let (azimuth_rad, pitch_rad) = match flight {
        "orbit" => (FRAC_PI_2, -FRAC_PI_2),
        "descent" => (0.0, -40_f64.to_radians()),
        "low flight" => (FRAC_PI_2, -8_f64.to_radians()),
        _ => (
            (6.0 * time_s).to_radians(),
            -(2.0 * height_m.max(0.0) / radius_m).sqrt(),
        ),
    };
    let place = Geodetic {
        lat_rad,
        lon_rad,
        height_m,
    };
    looking(
        place,
        azimuth_rad,
        pitch_rad,
        50_f64.to_radians(),
        (1280.0, 720.0),
    )
}

fn grounds() -> [(&'static str, Ground, Geodetic); 3] {
    let globe = || textures("elevation.png");
    let trinidad = textures("dem/trinidad.png");
    let bounds = trinidad.bounds();
    let middle = Geodetic {
        lat_rad: 0.5 * (bounds.south_rad + bounds.north_rad),
        lon_rad: bounds.west_rad + 0.5 * bounds.width_rad,
        height_m: 0.0,
    };
    let over_the_sea = |grids: Vec<Arc<HeightGrid>>| Ground::new(grids).with_sea_surface(None);
    [
        (
            "globe",
            over_the_sea(vec![globe()]),
            Geodetic::from_degrees(46.5, 8.0, 0.0),
        ),
        ("scene", over_the_sea(vec![globe(), trinidad]), middle),
        (
            "worst case",
            over_the_sea(vec![globe(), Arc::new(worst_case())]),
            Geodetic::from_degrees(20.5, 10.5, 0.0),
        ),
    ]
}

#[test]
#[ignore = "measures times"]
fn flights_of_the_study() {
    print_head();
    for (name, ground, site) in grounds() {
        for (flight, duration_s) in FLIGHTS {
            let mut surface = Quadtree::new(QuadtreeOptions::default());
            let view =
                |frame: u32| flown(flight, duration_s, f64::from(frame) / 60.0, site, &ground);
            let mut first = Cost::default();
            surface.forget_views();
            let is_settled = first.settle(&mut surface, &view(0), &ground, 3000);
            let note = format!("{}, settled: {is_settled}", leaf_set(&surface));
            first.print(&format!("{name}, {flight}, first view"), &note);
            let mut cost = Cost::default();
            let mut reported_px = 0.0_f64;
            for frame in 0..(duration_s * 60.0) as u32 {
                cost.prepare(&mut surface, &view(frame), &ground);
                reported_px = reported_px.max(cost.error_px);
            }
            cost.print(
                &format!("{name}, {flight}"),
                &format!("error at most {reported_px:.2} px"),
            );
        }
        // A jump, as in the study.
        let mut surface = Quadtree::new(QuadtreeOptions::default());
        let middle = |at: usize| {
            flown(
                FLIGHTS[at].0,
                FLIGHTS[at].1,
                0.5 * FLIGHTS[at].1,
                site,
                &ground,
            )
        };
        surface.forget_views();
        Cost::default().settle(&mut surface, &middle(0), &ground, 3000);
        let mut cost = Cost::default();
        let is_settled = cost.settle(&mut surface, &middle(2), &ground, 3000);
        cost.print(&format!("{name}, jump"), &format!("settled: {is_settled}"));
    }
}

/// Views whose images are compared with goldens.
#[test]
#[ignore = "measures times"]
fn views_of_goldens() {
    let [_, (_, ground, _), _] = grounds();
    let place = Geodetic::from_degrees(37.495, -105.44, 4600.0);
    print_head();
    for size in [(320.0, 180.0), (1280.0, 720.0), (1920.0, 1080.0)] {
        let view = looking(
            place,
            342_f64.to_radians(),
            -7_f64.to_radians(),
            45_f64.to_radians(),
            size,
        );
        let mut surface = Quadtree::new(QuadtreeOptions::default());
        surface.forget_views();
        let mut cost = Cost::default();
        let is_settled = cost.settle(&mut surface, &view, &ground, 3000);
        let note = format!("{}, settled: {is_settled}", leaf_set(&surface));
        cost.print(&format!("Blanca Peak, {size:?}"), &note);
    }
}

#[test]
#[ignore = "measures times"]
fn extreme_views() {
    let cliffs = Posts::new(64, |i, j| if (i + j) % 2 == 0 { 9e3 } else { -11e3 });
    let steep = Posts::new(
        512,
        |i, j| if (i / 3 + j / 5) % 2 == 0 { 9e3 } else { -11e3 },
    );
    let rough = Posts::rough(2048, 5e3, 3);
    print_head();
    for (name, ground) in [
        ("cliffs", &cliffs),
        ("steep cliffs", &steep),
        ("rough", &rough),
    ] {
        for (where_, lat, lon, above_m, tilt) in [
            ("a metre high", 33.0, 44.0, 1.0, 1.5),
            ("a metre high, down", 33.0, 44.0, 1.0, 0.0),
            ("date line", 0.0, 180.0, 1.0, 1.57),
            ("pole", 90.0, 0.0, 100.0, 0.3),
            ("near a pole", 89.99, 20.0, 1.0, 1.4),
            ("southern pole", -90.0, 123.0, 1.0, 1.5),
            ("2 km", 46.0, 8.0, 2e3, 1.2),
        ] {
            let ground_m = ground.height_m(f64::to_radians(lat), f64::to_radians(lon), 0.0);
            let view = view(lat, lon, ground_m + above_m, tilt);
            for is_forgotten in [false, true] {
                let mut surface = Quadtree::new(QuadtreeOptions::default());
                if is_forgotten {
                    surface.prepare(&view, ground);
                    surface.forget_views();
                }
                let mut cost = Cost::default();
                let start = ThreadTime::now();
                let mut is_settled = false;
                while !is_settled && start.elapsed() < Duration::from_secs(10) {
                    is_settled = cost.settle(&mut surface, &view, ground, 50);
                }
                let how = if is_forgotten { ", forgotten" } else { "" };
                let note = format!("{}, settled: {is_settled}", leaf_set(&surface));
                cost.print(&format!("{name}, {where_}{how}"), &note);
            }
        }
    }
}

/// Processor time of the drawing thread, from empty ground until a view 2 km high at rest settles over streamed heights.
#[test]
#[ignore = "measures times"]
fn settling_over_streamed_heights() {
    let source = Arc::new(mountains::Mountains::new(Duration::from_millis(5)));
    let options = HeightStreamOptions {
        memory_bytes: 1 << 30,
        threads: 2,
    };
    let up_m = 4e3 + 2e3;
    let place = Geodetic::from_degrees(46.0, 8.0, up_m);
    let view = looking(place, FRAC_PI_2, -0.6_f64.atan(), 0.9, (1280.0, 720.0));
    print_head();
    for most in [4, usize::MAX] {
        let stream = StreamedGround::new(source.clone(), Ground::new([]), &options).expect("sound");
        let viewer = stream.viewer();
        let (mut version, mut heights) = stream.now();
        let mut surface = Quadtree::new(QuadtreeOptions::default());
        let (mut cost, mut quiet, begin) = (Cost::default(), 0, Instant::now());
        let (mut other_ms, mut other_most_ms) = (0.0, 0.0_f64);
        while quiet < 4 && begin.elapsed() < Duration::from_secs(100) {
            let frame = Instant::now();
            let start = ThreadTime::now();
            viewer.look(HeightEye {
                eye_itrf_m: view.eye_itrf_m,
                tolerance_rad: view.pixel_rad,
            });
            stream.take_over(most);
            let now = stream.now();
            let is_other = now.0 != version;
            if is_other {
                let changes = stream.changes_since(version).expect("not long ago");
                surface.heights_changed(&changes, now.1.as_ref());
                (version, heights) = now;
            }
            let ms = 1e3 * start.elapsed().as_secs_f64();
            (other_ms, other_most_ms) = (other_ms + ms, other_most_ms.max(ms));
            let stats = cost.prepare(&mut surface, &view, heights.as_ref());
            let is_busy = is_other || stats.samples_read > 0 || !stream.is_settled();
            quiet = if is_busy { 0 } else { quiet + 1 };
            std::thread::sleep(Duration::from_micros(16_667).saturating_sub(frame.elapsed()));
        }
        let note = format!(
            "{:.1} s by the clock, {:.2} s for {} tiles and changes, {other_most_ms:.1} ms at most; {}",
            begin.elapsed().as_secs_f64(),
            1e-3 * other_ms,
            stream.counters().tiles,
            leaf_set(&surface)
        );
        cost.print(&format!("2 km over tiles, {most} a frame"), &note);
    }
}
