//! Cost of streaming elevation data for the drawing thread: flights of every surface over tiles that take time to load.
//!
//! ```text
//! cargo bench --bench heights -- [flights] [settling] [reading] [--surface NAME] [--height-km N] [--rounds N] [--frames N] [--taken N]
//! ```
//!
//! - `flights`: each surface at 200 km and at 2 km, 60 frames a second in real time, over tiles each of which takes 5 ms to load, and the same
//!   flight with all of them in memory, interleaved. A frame is the work of an Earth for its terrain without a GPU: take tiles over, process changes,
//!   prepare. Its time is the processor time of its thread, so loaders do not count.
//! - `settling`: from no terrain until a view at rest settles, over 9 levels of tiles with two loader threads.
//! - `reading`: one elevation from tiles compared with one from a grid in memory, with the same samples.

#[path = "heights/mountains.rs"]
mod mountains;

use cpu_time::ThreadTime;
use glam::DVec3;
use mountains::Mountains;
use std::f64::consts::{FRAC_PI_2, PI};
use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{EyeView, Figure, Subdivision, SurfaceKind, SurfaceSettings};
use terrella_ground::elevation::{
    Bounds, Elevation, Georeference, GridLimits, Ground, HeightEye, HeightGrid,
    HeightStreamOptions, HeightViewer, Registration, StreamedGround, TILES_PER_FRAME,
};
use terrella_ground::globe::{GroundView, Surface};

const LEVELS: u8 = 9;
const SIDE: u32 = 128;
const TILE_TIME: Duration = Duration::from_millis(5);
const FRAME_TIME: Duration = Duration::from_micros(16_667);
/// No frame may take so much more.
const MOST_MS: f64 = 4.0;
/// Where flights begin, degrees.
const START_DEG: (f64, f64) = (46.0, 8.0);

/// A stream and the state that an Earth keeps of it.
struct Follower {
    stream: StreamedGround,
    viewer: Arc<HeightViewer>,
    version: u64,
    heights: Arc<Ground>,
}

/// Processor times of a frame's parts, milliseconds.
#[derive(Clone, Copy, Default)]
struct FrameTimes {
    take_over_ms: f64,
    changed_ms: f64,
    prepare_ms: f64,
}

impl FrameTimes {
    fn sum_ms(&self) -> f64 {
        self.take_over_ms + self.changed_ms + self.prepare_ms
    }
}

impl Follower {
    fn new(source: &Arc<Mountains>) -> Self {
        let options = HeightStreamOptions {
            memory_bytes: 1 << 30,
            threads: 2,
        };
        let stream = StreamedGround::new(source.clone(), Ground::new([]), &options);
        let stream = stream.expect("sound");
        let viewer = stream.viewer();
        let (version, heights) = stream.now();
        Self {
            stream,
            viewer,
            version,
            heights,
        }
    }

    /// A frame, and whether it read or changed anything.
    fn frame(
        &mut self,
        surface: &mut dyn Surface,
        view: &GroundView,
        most: usize,
    ) -> (FrameTimes, bool) {
        let start = ThreadTime::now();
        self.viewer.look(HeightEye {
            eye_itrf_m: view.eye_itrf_m,
            tolerance_rad: view.pixel_rad,
        });
        self.stream.take_over(most);
        let taken = start.elapsed();
        let (version, heights) = self.stream.now();
        let is_other = version != self.version;
        if is_other {
            let changes = self.stream.changes_since(self.version);
            let changes = changes.expect("not long ago");
            surface.heights_changed(&changes, heights.as_ref());
            (self.version, self.heights) = (version, heights);
        }
        let changed = start.elapsed();
        let stats = surface.prepare(view, self.heights.as_ref());
        let all = start.elapsed();
        let ms = |time: Duration| 1e3 * time.as_secs_f64();
        let times = FrameTimes {
            take_over_ms: ms(taken),
            changed_ms: ms(changed - taken),
            prepare_ms: ms(all - changed),
        };
        (times, is_other || stats.samples_read > 0)
    }

    /// Frames until nothing changes any more; returns their number.
    fn settle(
        &mut self,
        surface: &mut dyn Surface,
        view: &GroundView,
        paced: Option<usize>,
    ) -> u32 {
        let (mut frames, mut quiet) = (0, 0);
        while quiet < 4 {
            let start = Instant::now();
            let most = paced.unwrap_or(usize::MAX);
            let (_, is_busy) = self.frame(surface, view, most);
            quiet = if is_busy || !self.stream.is_settled() {
                0
            } else {
                quiet + 1
            };
            frames += 1;
            assert!(frames < 20_000, "{} never settles", surface.name());
            if paced.is_some() {
                std::thread::sleep(FRAME_TIME.saturating_sub(start.elapsed()));
            } else if quiet == 0 && !self.stream.is_settled() {
                self.stream.wait(Duration::from_millis(5));
            }
        }
        frames - quiet
    }
}

fn view(height_m: f64, flown_m: f64) -> GroundView {
    let radius_m = 6.371e6;
    let (lat_deg, lon_deg) = START_DEG;
    let east_deg = (flown_m / (radius_m * lat_deg.to_radians().cos())).to_degrees();
    let place = Geodetic::from_degrees(lat_deg, lon_deg + east_deg, height_m);
    let eye = Ellipsoid::WGS84.itrf_from_geodetic(place);
    let up = eye.normalize();
    let east = DVec3::Z.cross(up).normalize();
    // Ahead and down: the horizon is at the upper edge of the picture.
    let towards = east - 0.6 * up;
    let (fov_rad, rows) = (0.9_f64, 720.0);
    let (eye_itrf_m, clip_from_eye) =
        EyeView::itrf(eye, towards, up, fov_rad, 16.0 / 9.0).to_itrf();
    GroundView {
        eye_itrf_m,
        clip_from_eye,
        pixel_rad: 2.0 * (0.5 * fov_rad).tan() / rows,
        tolerance_px: 1.0,
    }
}

fn surfaces(only: Option<&str>) -> Vec<(&'static str, SurfaceSettings)> {
    let mut all: Vec<_> = SurfaceKind::ALL
        .iter()
        .map(|kind| (kind.name(), kind.settings(Subdivision::Auto)))
        .collect();
    all.push((
        "contours-cast",
        SurfaceSettings::CastContours(Default::default()),
    ));
    all.retain(|(name, _)| only.is_none_or(|only| *name == only));
    all
}

fn at(sorted: &[f64], part: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * part).round() as usize]
}

/// Median, 99th percentile and most.
fn summary(times: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut times: Vec<_> = times.collect();
    times.sort_unstable_by(f64::total_cmp);
    [0.5, 0.99, 1.0].map(|part| at(&times, part))
}

fn flights(arguments: &Arguments) {
    let slow = Arc::new(Mountains::new(TILE_TIME));
    let quick = Arc::new(Mountains::new(Duration::ZERO));
    println!(
        "processor time of a frame, ms: median / 99th percentile / most of {} frames, {} rounds interleaved",
        arguments.frames, arguments.rounds
    );
    println!(
        "| flight | surface | resident | streamed | streamed − resident | frames over {MOST_MS} more | most of take over, changed, prepare | tiles |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for height_km in [200.0, 2.0] {
        if arguments.height_km.is_some_and(|only| only != height_km) {
            continue;
        }
        // Ten times as fast as things fly there.
        let speed_m_per_s = if height_km > 100.0 { 7.8e4 } else { 2.5e3 };
        let height_m = 1e3 * height_km + if height_km > 100.0 { 0.0 } else { 4e3 };
        let views: Vec<_> = (0..arguments.frames)
            .map(|k| {
                view(
                    height_m,
                    speed_m_per_s * f64::from(k) * FRAME_TIME.as_secs_f64(),
                )
            })
            .collect();
        for (name, settings) in surfaces(arguments.surface.as_deref()) {
            let make = || settings.make(Figure::Wgs84).expect("sound settings");
            let mut whole = Follower::new(&quick);
            let mut surface = make();
            for view in views.iter().step_by(6) {
                whole.settle(surface.as_mut(), view, None);
            }
            let (mut resident, mut streamed) = (Vec::new(), Vec::new());
            let mut tiles = 0;
            for _ in 0..arguments.rounds {
                let mut follower = Follower::new(&slow);
                let mut surface = make();
                for view in &views {
                    let start = Instant::now();
                    let frame = follower.frame(surface.as_mut(), view, arguments.taken);
                    streamed.push(frame.0);
                    std::thread::sleep(FRAME_TIME.saturating_sub(start.elapsed()));
                }
                tiles = follower.stream.counters().tiles;
                let mut surface = make();
                for view in &views {
                    let frame = whole.frame(surface.as_mut(), view, arguments.taken);
                    resident.push(frame.0);
                }
            }
            let sums = |of: &[FrameTimes]| summary(of.iter().map(FrameTimes::sum_ms));
            let more = || {
                let pairs = streamed.iter().zip(&resident);
                pairs.map(|(streamed, resident)| streamed.sum_ms() - resident.sum_ms())
            };
            let show = |[a, b, c]: [f64; 3]| format!("{a:.2} / {b:.2} / {c:.2}");
            let most = |of: fn(&FrameTimes) -> f64| streamed.iter().map(of).fold(0.0, f64::max);
            println!(
                "| {height_km} km | {name} | {} | {} | {} | {} | {:.2}, {:.2}, {:.2} | {tiles} |",
                show(sums(&resident)),
                show(sums(&streamed)),
                show(summary(more())),
                more().filter(|more| *more > MOST_MS).count(),
                most(|times| times.take_over_ms),
                most(|times| times.changed_ms),
                most(|times| times.prepare_ms),
            );
        }
    }
}

fn settling(arguments: &Arguments) {
    println!("until a view at rest settles, {LEVELS} levels, {TILE_TIME:?} a tile, 2 threads");
    println!("| height | surface | seconds | frames | tiles | seconds of loading, both threads |");
    println!("|---|---|---|---|---|---|");
    for height_km in [200.0, 2.0] {
        if arguments.height_km.is_some_and(|only| only != height_km) {
            continue;
        }
        for (name, settings) in surfaces(arguments.surface.as_deref()) {
            let slow = Arc::new(Mountains::new(TILE_TIME));
            let mut runs = Vec::new();
            let mut tiles = 0;
            for _ in 0..arguments.rounds {
                let mut follower = Follower::new(&slow);
                let mut surface = settings.make(Figure::Wgs84).expect("sound settings");
                let view = view(
                    1e3 * height_km + if height_km > 100.0 { 0.0 } else { 4e3 },
                    0.0,
                );
                let start = Instant::now();
                let frames = follower.settle(surface.as_mut(), &view, Some(arguments.taken));
                runs.push((start.elapsed().as_secs_f64(), frames));
                tiles = follower.stream.counters().tiles;
            }
            runs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            let (seconds, frames) = runs[runs.len() / 2];
            let loading_s = 0.5 * f64::from(tiles) * TILE_TIME.as_secs_f64();
            println!(
                "| {height_km} km | {name} | {seconds:.2} | {frames} | {tiles} | {loading_s:.2} |"
            );
        }
    }
}

fn reading(arguments: &Arguments) {
    let source = Arc::new(Mountains::new(Duration::ZERO));
    let step = source.layout.spacing_rad(0);
    let (lat_deg, lon_deg) = START_DEG;
    // Samples of both are at the same places.
    let (row, column) = (
        ((90.0 - lat_deg).to_radians() / step).floor(),
        ((lon_deg + 180.0).to_radians() / step).floor(),
    );
    const SAMPLES: usize = 1024;
    let north_rad = FRAC_PI_2 - (row - 512.0) * step;
    let west_rad = (column - 512.0) * step - PI;
    let size_rad = SAMPLES as f64 * step;
    let bounds = Bounds {
        south_rad: north_rad - size_rad,
        north_rad,
        west_rad,
        width_rad: size_rad,
    };
    let cells = source.cells(
        north_rad - 0.5 * step,
        west_rad + 0.5 * step,
        step,
        (SAMPLES, SAMPLES),
    );
    let place =
        Georeference::from_bounds(Registration::Cells, &bounds, SAMPLES as u32, SAMPLES as u32);
    let place = place.expect("a part of the Earth");
    let grid = HeightGrid::new(&place, cells, &GridLimits::default()).expect("sound");
    let grid = Ground::from(grid);
    let stream = Follower::new(&source).stream;
    let places = |spread: f64, is_mixed: bool| {
        let side = 300_usize;
        (0..side * side).map(move |n| {
            let n = if is_mixed {
                n.wrapping_mul(2_654_435_761) % (side * side)
            } else {
                n
            };
            let part = |k: usize| (k as f64 + 0.37) / side as f64 * spread;
            (
                north_rad - size_rad * (0.3 + part(n / side)),
                west_rad + size_rad * (0.3 + part(n % side)),
            )
        })
    };
    let read = |ground: &dyn Elevation, spacing: f64, spread: f64, is_mixed: bool| {
        let mut sum_m = 0.0;
        for (lat, lon) in places(spread, is_mixed) {
            sum_m += ground.height_m(lat, lon, spacing);
        }
        black_box(sum_m)
    };
    for _ in 0..1000 {
        read(stream.now().1.as_ref(), 0.0, 0.4, false);
        stream.take_over(usize::MAX);
        if stream.is_settled() {
            break;
        }
        stream.wait(Duration::from_millis(5));
    }
    println!(
        "a height, ns: median of {} rounds interleaved, least and most",
        5 * arguments.rounds
    );
    println!("| asked for | order | grid | tiles | ratio |");
    println!("|---|---|---|---|---|");
    let heights = stream.now().1;
    for (what, spacing) in [("finest", 0.0), ("2.7 samples", 2.7 * step)] {
        for (order, is_mixed) in [("row by row", false), ("mixed", true)] {
            let mut times = [Vec::new(), Vec::new()];
            for _ in 0..5 * arguments.rounds {
                for (times, ground) in times.iter_mut().zip([&grid, heights.as_ref()]) {
                    let start = ThreadTime::now();
                    read(ground, spacing, 0.4, is_mixed);
                    times.push(1e9 * start.elapsed().as_secs_f64() / 9e4);
                }
            }
            for times in &mut times {
                times.sort_unstable_by(f64::total_cmp);
            }
            let [of_grid, of_tiles] =
                [&times[0], &times[1]].map(|t| [at(t, 0.5), t[0], at(t, 1.0)]);
            let show = |[a, b, c]: [f64; 3]| format!("{a:.1} ({b:.1}–{c:.1})");
            let ratio = of_tiles[0] / of_grid[0];
            println!(
                "| {what} | {order} | {} | {} | {ratio:.2} |",
                show(of_grid),
                show(of_tiles)
            );
        }
    }
}

struct Arguments {
    parts: Vec<String>,
    surface: Option<String>,
    height_km: Option<f64>,
    rounds: u32,
    frames: u32,
    /// Tiles that a frame may take over.
    taken: usize,
}

impl Arguments {
    fn read() -> Self {
        let mut own = Self {
            parts: Vec::new(),
            surface: None,
            height_km: None,
            rounds: 3,
            frames: 360,
            taken: TILES_PER_FRAME,
        };
        let mut arguments = std::env::args().skip(1);
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().expect("a value behind it");
            match argument.as_str() {
                "--surface" => own.surface = Some(value()),
                "--height-km" => own.height_km = Some(value().parse().expect("a number")),
                "--rounds" => own.rounds = value().parse().expect("a number"),
                "--taken" => own.taken = value().parse().expect("a number"),
                "--frames" => own.frames = value().parse().expect("a number"),
                // Cargo's own.
                "--bench" => {}
                part => own.parts.push(part.to_owned()),
            }
        }
        own
    }

    fn has(&self, part: &str) -> bool {
        self.parts.is_empty() || self.parts.iter().any(|own| own == part)
    }
}

fn main() {
    let arguments = Arguments::read();
    for (name, run) in [
        ("reading", reading as fn(&Arguments)),
        ("flights", flights),
        ("settling", settling),
    ] {
        if arguments.has(name) {
            run(&arguments);
        }
    }
}
