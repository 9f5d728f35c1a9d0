//! A scene's `[quality]`: its frame time, from the scene to the Earth that is drawn; its scale in pictures that are kept.

use crate::{Place, png_size};
use std::path::Path;
use terrella::{GpuContext, Quality};
use terrella_play::scene::Scene;
use terrella_play::{Flight, HeldQuality, OffscreenRenderer, QualityControl, scene_quality};

const SIZE: (u32, u32) = (96, 54);

/// Steps whose costs the made-up clock below follows.
const LADDER: &str =
    "give_up,cost,error\nsamples,0.7,0\nscale_50,0.4,0.01\nair,0.25,0.05\nclouds,0.2,0.06\n";

/// A scene with a separate ladder, from a folder that must live as long.
fn scene(folder: &Path, target_ms: f64) -> Scene {
    std::fs::write(folder.join("ladder.csv"), LADDER).expect("writes");
    let text = format!(
        "[camera]\nmode = \"geodetic\"\nlat_deg = 20\nlon_deg = 15\nheight_km = 12000\n[output]\nsize = [{}, {}]\nsamples = 4\n[quality]\ntarget_ms = {target_ms}\nladder = \"ladder.csv\"\n",
        SIZE.0, SIZE.1
    );
    Scene::from_toml(&text, &folder.join("scene.toml")).expect("a good scene")
}

/// Frames of an Earth that is really drawn, with simulated times: the given milliseconds at full quality, and less on each level according to the
/// ladder.
struct Player {
    renderer: OffscreenRenderer,
    control: QualityControl,
    flight: Flight,
}

impl Player {
    fn open(folder: &Path, target_ms: f64) -> Self {
        let flight = Flight::open(scene(folder, target_ms)).expect("the built-in orbit");
        let gpu = pollster::block_on(GpuContext::open(None)).expect("an adapter");
        let options = flight.earth_options(gpu.bc_support()).expect("the maps");
        let mut renderer = OffscreenRenderer::open(gpu, options, SIZE).expect("a renderer");
        let full = scene_quality(&flight.scene().quality, *renderer.earth().quality());
        renderer.set_quality(&full).expect("the full quality");
        let control = QualityControl::of(flight.scene(), full, false);
        Self {
            renderer,
            control: control.expect("a good ladder").expect("a frame time"),
            flight,
        }
    }

    /// Plays frames that take `full_ms` at full quality; returns the frames at which the level changed, and the new levels.
    fn play(&mut self, frames: usize, full_ms: impl Fn(usize) -> f64) -> Vec<(usize, usize)> {
        let mut changes = Vec::new();
        for frame in 0..frames {
            let adaptive = self.control.adaptive();
            let cost_ms = full_ms(frame) * adaptive.levels()[adaptive.level()].cost;
            if let Some(quality) = self.control.observe([cost_ms]) {
                self.renderer
                    .set_quality(&quality)
                    .expect("a sound quality");
                changes.push((frame, self.control.adaptive().level()));
            }
        }
        changes
    }

    fn drawn(&mut self) -> (Quality, image::RgbaImage) {
        let start = self.flight.scene().time.start;
        let moment = self.flight.at(start, self.renderer.aspect());
        self.renderer.draw(&moment.expect("a moment"));
        let picture = self.renderer.read().expect("a picture");
        (*self.renderer.earth().quality(), picture)
    }
}

#[test]
fn quality_follows_the_frames_of_a_scene_down_and_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut player = Player::open(folder.path(), 20.0);
    let (full, full_picture) = player.drawn();
    assert_eq!((full.samples, full.scale), (4, 1.0));
    // 20 ms are held: nothing is given up.
    assert_eq!(player.play(300, |_| 19.0), []);
    // 45 ms: 31.5 on the first level, 18 on the second.
    let down = player.play(200, |_| 45.0);
    let levels: Vec<_> = down.iter().map(|(_, level)| *level).collect();
    assert_eq!(levels, [1, 2]);
    assert!(
        down[1].0 <= 40,
        "two windows of 15 frames and what settles: {down:?}"
    );
    let (quality, reduced) = player.drawn();
    assert_eq!((quality.samples, quality.scale), (1, 0.5));
    assert_eq!(player.renderer.drawn_size(), (48, 27));
    assert_eq!(reduced.dimensions(), SIZE);
    assert!(reduced != full_picture, "it is seen");
    // It settles: a long time of the same frames, some of them long, changes nothing.
    let spikes = |frame: usize| if frame.is_multiple_of(7) { 200.0 } else { 45.0 };
    assert_eq!(player.play(3_000, spikes), []);
    // Fast frames again: all comes back, and stays.
    let up = player.play(2_000, |_| 15.0);
    let levels: Vec<_> = up.iter().map(|(_, level)| *level).collect();
    assert_eq!(levels, [1, 0]);
    let (quality, picture) = player.drawn();
    assert!(quality == full && picture == full_picture, "byte for byte");
    assert_eq!(player.play(3_000, |_| 15.0), []);
}

#[test]
fn a_frame_time_out_of_reach_is_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut player = Player::open(folder.path(), 20.0);
    // The last level takes a fifth of it.
    player.play(500, |_| 150.0);
    let adaptive = player.control.adaptive();
    assert_eq!(adaptive.level(), 4);
    assert!(
        adaptive
            .out_of_reach_ms()
            .is_some_and(|ms| (ms - 30.0).abs() < 1e-9)
    );
    player.play(30, |_| 90.0);
    assert_eq!(player.control.adaptive().out_of_reach_ms(), None);
    // In the numbers of a picture: no adapter draws one in a thousandth of a millisecond, all do within a second.
    let start = player.flight.scene().time.start;
    let moment = player.flight.at(start, 1.0).expect("a moment");
    for (target_ms, out_of_reach) in [(1.0, None), (1000.0, Some(false))] {
        let mut scene = scene(folder.path(), target_ms);
        scene.quality.target_ms = Some(out_of_reach.map_or(1e-3, |_| target_ms));
        let before = *player.renderer.earth().quality();
        let held = HeldQuality::find(&mut player.renderer, &scene, &moment);
        let held = held.expect("frames").expect("a frame time");
        assert_eq!(held.out_of_reach, out_of_reach.unwrap_or(true), "{held:?}");
        assert_eq!(*player.renderer.earth().quality(), before, "as it was");
        let numbers = serde_json::to_value(&held).expect("numbers");
        assert_eq!(numbers["out_of_reach"], held.out_of_reach);
    }
}

#[test]
fn pictures_are_drawn_at_the_scale_of_the_scene() {
    let place = Place::new();
    place.scene(
        "half.toml",
        &format!("{}[quality]\nscale = 0.5\ntarget_ms = 1000\n", crate::SMALL),
    );
    place.succeed(&["frame", "small.toml", "-o", "full.png"]);
    place.succeed(&[
        "frame",
        "half.toml",
        "-o",
        "half.png",
        "--stats",
        "half.json",
    ]);
    assert_eq!(png_size(&place.path("half.png")), (64, 36));
    let read = |name: &str| std::fs::read(place.path(name)).expect("reads");
    assert!(read("full.png") != read("half.png"), "it is seen");
    let stats: serde_json::Value = serde_json::from_slice(&read("half.json")).expect("JSON");
    assert_eq!(stats["size"], serde_json::json!([64, 36]));
    assert_eq!(stats["drawn_size"], serde_json::json!([32, 18]));
    assert_eq!(stats["quality"]["out_of_reach"], false);
    assert_eq!(stats["quality"]["target_ms"], 1000.0);
    // Films too.
    place.succeed(&["play", "half.toml", "--frames", "film"]);
    let still = image::open(place.path("half.png")).expect("a picture");
    let first = image::open(place.path("film/frame_00000.png")).expect("a frame");
    assert!(still == first, "a film's first frame is the still");
}

#[test]
fn a_ladder_that_is_none_is_rejected_with_its_line() {
    let place = Place::new();
    place.scene(
        "ladder.csv",
        "give_up,cost,error\nair,0.5,0.01\nhats,0.4,0.02\n",
    );
    place.scene(
        "bad.toml",
        &format!(
            "{}[quality]\nladder = \"ladder.csv\"\ntarget_ms = 20\n",
            crate::SMALL
        ),
    );
    let words = place.fail(
        2,
        &["frame", "bad.toml", "-o", "a.png", "--stats", "a.json"],
    );
    assert!(
        words.contains("ladder.csv: line 3: hats cannot be given up"),
        "{words}"
    );
}
