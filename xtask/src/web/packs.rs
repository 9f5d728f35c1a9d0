//! The part of `cargo xtask web test` about imagery packs: a pack is built, drawn natively, and drawn in pages that fetch it.

use super::browser;
use super::npm::{self, PLAYWRIGHT};
use super::parts;
use crate::files::write_bytes;
use crate::process::{self, repository_root};
use anyhow::Context;
use image::{ImageFormat, RgbImage};
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Width of the day map, texels.
const WIDTH: u32 = 4096;
/// Levels of its pack, texels of a block. The test knows the coarsest and the finest.
const LEVELS: &str = "day=256,128,32";
/// Each has a native picture of its name.
const STORAGES: [&str; 2] = ["bc", "plain"];
/// Attributes of the page's element: a place in sunlight, near enough for the finest level.
const VIEW: &str = r#"{"epoch":"2026-06-01T12:00:00Z","lat":20,"lon":10,"altitude":1500000,"heading":0,"pitch":-90,"fov":45,"exposure":0.5,"samples":4,"seasons":"off","resolution":1}"#;
/// The same in a scene.
const SCENE: &str = "[time]\nstart = \"2026-06-01T12:00:00Z\"\n\n[earth]\npack = \"pack\"\nseasons = false\n\n[camera]\nmode = \"geodetic\"\nlat_deg = 20\nlon_deg = 10\nheight_km = 1500\n\
heading_deg = 0\npitch_deg = -90\nfov_deg = 45\n\n[sky]\nglare = true\n\n[output]\nsamples = 4\nexposure_ev = 0.5\n";

/// Builds a pack of a pattern and the starter maps, and opens pages that draw it.
///
/// # Errors
/// A missing program or package, a page that differs from the native picture or without its message.
pub fn run(dist: &Path, tests: &Path, program: &Path, out: &Path) -> anyhow::Result<()> {
    let tools = npm::installed(&[PLAYWRIGHT]).context("no page is tested")?;
    fs::create_dir_all(out).with_context(|| out.display().to_string())?;
    let day = out.join("pattern.png");
    write_pattern(&day)?;
    let textures = repository_root().join("textures");
    let pack = out.join("pack");
    let mut build = Command::new(program);
    build.args(["pack", "build", "--restart", "--name", "pattern"]);
    build.args(["--attribution", "Nobody", "--pixels", LEVELS]);
    build.arg("--day").arg(&day);
    for (option, map) in [
        ("--clouds", "clouds.jpg"),
        ("--elevation", "elevation.png"),
        ("--night", "night_lights.png"),
        ("--water", "water.png"),
    ] {
        build.arg(option).arg(textures.join(map));
    }
    process::run(build.arg("--output").arg(&pack))?;
    let scene = out.join("pack.toml");
    write_bytes(&scene, SCENE.as_bytes())?;
    let device = browser::driver()?;
    for storage in STORAGES {
        let mut draw = Command::new(program);
        draw.envs(device.variables());
        draw.arg("frame").arg(&scene).args(["--size", "640x360"]);
        draw.arg("--set").arg(format!("earth.storage={storage}"));
        process::run(draw.arg("-o").arg(out.join(storage).with_extension("png")))?;
    }
    let more = [pack.as_os_str(), out.as_os_str(), VIEW.as_ref()];
    parts::run(
        dist,
        &tools,
        &tests.join("packs.mjs"),
        &out.join("pages"),
        &more,
    )
}

/// A day map of long waves: each place differs from every other map, and compression changes little.
fn write_pattern(file: &Path) -> anyhow::Result<()> {
    let wave = |at: u32, period: f64| (110.0 + 70.0 * (TAU * f64::from(at) / period).sin()) as u8;
    let map = RgbImage::from_fn(WIDTH, WIDTH / 2, |x, y| {
        let grey = (u16::from(wave(x, 41.0)) + u16::from(wave(y, 67.0))) / 2;
        image::Rgb([grey as u8, grey as u8, (grey / 2) as u8])
    });
    map.save_with_format(file, ImageFormat::Png)
        .with_context(|| file.display().to_string())
}
