//! `cargo xtask web`: the Earth for web pages, built, served on this machine and tested in a browser.

mod browser;
mod data;
mod npm;
mod packs;
mod parts;
mod peers;
mod serve;
mod toolchain;

use crate::cargo;
use crate::files::{copy_whole, write_bytes};
use crate::process::{self, repository_root, say};
use anyhow::{Context, bail};
use clap::{Args, Subcommand};
use serde_json::Value;
use serve::Server;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use toolchain::Toolchain;

/// The backends of pages, each with its own wasm file.
const BACKENDS: [&str; 2] = ["webgpu", "webgl"];
/// Readers that a page loads when it needs them, wasm files of their own: the name and the crate of each.
const READERS: [(&str, &str); 2] = [
    ("packs", "terrella-web-pack"),
    ("scenes", "terrella-web-scene"),
];
/// The starter maps that a page uses.
const MAPS: [&str; 10] = [
    "day.jpg",
    "clouds.jpg",
    "elevation.png",
    "night_lights.png",
    "water.png",
    "seasons.png",
    "moon.jpg",
    "milky_way.jpg",
    "places.bin",
    "stars.bin",
];

/// Files that a page loads, one of each kind.
const NEEDED: [&str; 7] = [
    "terrella/terrella.js",
    "terrella/earth.js",
    "terrella/webgpu_bg.wasm",
    "terrella/webgl_bg.wasm",
    "terrella/packs_bg.wasm",
    "terrella/scenes_bg.wasm",
    "terrella/data/air.bin",
];
/// Settings with which a scene is drawn as in the page of the test.
const AS_A_PAGE: [&str; 6] = [
    "--set",
    "earth.seasons=false",
    "--set",
    "sky.glare=true",
    "--set",
    "output.samples=4",
];
/// Parts of the test that one browser program runs, which compares with native pictures.
const PICTURES: [&str; 4] = ["webgpu", "webgl", "viewer", "none"];
/// All parts of the test.
const PARTS: [&str; 8] = [
    "webgpu", "webgl", "viewer", "none", "servers", "packs", "bundlers", "examples",
];

#[derive(Args)]
pub struct Web {
    #[command(subcommand)]
    action: Option<Action>,
    /// Only check that the library and the page's crate compile for wasm32.
    #[arg(long)]
    check: bool,
    /// Folder to write the pages to, for any static host; target/web/dist by default.
    #[arg(long, value_name = "DIR")]
    dist: Option<PathBuf>,
    /// Do not serve the folder at the end.
    #[arg(long)]
    no_serve: bool,
    /// Port to serve at.
    #[arg(long, default_value_t = 8080, value_name = "N")]
    port: u16,
}

#[derive(Subcommand)]
enum Action {
    /// Open the pages in headless Chromium and compare them with native pictures.
    Test {
        /// The program to draw native pictures with; by default it is built.
        #[arg(long, value_name = "FILE")]
        program: Option<PathBuf>,
        /// Test what is in the folder; build nothing.
        #[arg(long)]
        no_build: bool,
        /// Parts with commas between them. All by default.
        #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = PARTS)]
        only: Vec<String>,
    },
    /// Time frames beside those of CesiumJS in headless Chromium, and record them in docs/recorded/web-peers.csv.
    Peers {
        /// Rounds at each height, in which each renderer draws a turn.
        #[arg(long, default_value_t = 5, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
        rounds: u32,
        /// Measure what is in the folder; build nothing.
        #[arg(long)]
        no_build: bool,
    },
}

pub fn run(web: Web) -> anyhow::Result<()> {
    if web.check {
        return check();
    }
    let root = repository_root();
    let dist = web.dist.unwrap_or_else(|| root.join("target/web/dist"));
    match web.action {
        None => {
            build(&dist)?;
            if !web.no_serve {
                let server = Server::start(&dist, web.port)?;
                say(format_args!("open {}; Ctrl-C ends it", server.address()));
                server.wait();
            }
            Ok(())
        }
        Some(Action::Test {
            program,
            no_build,
            only,
        }) => {
            build_or_find(&dist, no_build)?;
            test(&dist, program, &only)
        }
        Some(Action::Peers { rounds, no_build }) => {
            build_or_find(&dist, no_build)?;
            peers::run(&dist, &package().join("tests"), rounds)
        }
    }
}

/// The crate's folder.
fn package() -> PathBuf {
    repository_root().join("crates/terrella-web")
}

/// Checks that the crates compile for wasm32, without output. Reports if the machine cannot compile them.
fn check() -> anyhow::Result<()> {
    let toolchain = match Toolchain::find() {
        Ok(toolchain) => toolchain,
        Err(missing) => {
            say(format_args!(
                "SKIPPED: wasm32 was not checked, because {missing}"
            ));
            return Ok(());
        }
    };
    for part in wasm_parts() {
        process::run(&mut compile(&toolchain, "check", part))?;
    }
    Ok(())
}

/// Names of the wasm files.
fn wasm_parts() -> impl Iterator<Item = &'static str> {
    BACKENDS.into_iter().chain(READERS.map(|(name, _)| name))
}

/// The crate of a reader; `None` for a backend.
fn reader_crate(part: &str) -> Option<&'static str> {
    let reader = READERS.into_iter().find(|(name, _)| *name == part);
    reader.map(|(_, package)| package)
}

/// A cargo command for a wasm file. Each has its own build folder, because features change the build.
fn compile(toolchain: &Toolchain, what: &str, part: &str) -> Command {
    let mut command = toolchain.cargo(what);
    command.current_dir(package());
    command.args(["--release", "--locked", "--no-default-features"]);
    match reader_crate(part) {
        Some(package) => command.args(["--package", package]),
        None => command.args(["--features", part]),
    };
    command.arg("--target-dir").arg(target(part));
    command
}

fn target(part: &str) -> PathBuf {
    repository_root().join("target/web").join(part)
}

/// Builds the pages, or checks that a folder has them.
fn build_or_find(dist: &Path, no_build: bool) -> anyhow::Result<()> {
    if !no_build {
        return build(dist);
    }
    let missing = NEEDED
        .iter()
        .map(|name| dist.join(name))
        .find(|file| !file.exists());
    match missing {
        Some(file) => bail!("{} is missing; run without --no-build", file.display()),
        None => Ok(()),
    }
}

/// Writes the pages, the module and the maps.
fn build(dist: &Path) -> anyhow::Result<()> {
    let toolchain = match Toolchain::find() {
        Ok(toolchain) => toolchain,
        Err(missing) => bail!("{missing}"),
    };
    let bindgen = toolchain::bindgen(&package())?;
    let module = dist.join("terrella");
    fs::create_dir_all(&module).with_context(|| module.display().to_string())?;
    for part in wasm_parts() {
        process::run(&mut compile(&toolchain, "build", part))?;
        let package = reader_crate(part).unwrap_or("terrella-web");
        let file = format!("{}.wasm", package.replace('-', "_"));
        let wasm = target(part)
            .join("wasm32-unknown-unknown/release")
            .join(file);
        let mut bind = Command::new(&bindgen);
        bind.args(["--target", "web", "--no-typescript", "--out-name", part]);
        bind.args(["--remove-name-section", "--remove-producers-section"]);
        process::run(bind.arg("--out-dir").arg(&module).arg(wasm))?;
    }
    copy_pages(dist)?;
    data::write_previews(
        &repository_root().join("textures"),
        &module.join("maps/preview"),
    )?;
    data::write_air(
        &repository_root().join(data::TABLES),
        &module.join("data/air.bin"),
    )?;
    for part in wasm_parts() {
        let file = module.join(format!("{part}_bg.wasm"));
        let bytes = fs::metadata(&file).map_or(0, |found| found.len());
        say(format_args!("{}: {bytes} bytes", file.display()));
    }
    Ok(())
}

/// Copies the files that are not compiled.
fn copy_pages(dist: &Path) -> anyhow::Result<()> {
    let (root, package) = (repository_root(), package());
    let scenes = dist.join("scenes");
    for (from, to, ending) in [
        (package.join("js"), dist.join("terrella"), None),
        (package.join("viewer"), dist.to_owned(), None),
        (root.join("config"), scenes.clone(), Some("toml")),
        (root.join("config/orbits"), scenes.join("orbits"), None),
    ] {
        let entries = fs::read_dir(&from).with_context(|| from.display().to_string())?;
        for entry in entries {
            let path = entry.with_context(|| from.display().to_string())?.path();
            if ending.is_some_and(|ending| path.extension().is_none_or(|own| own != ending)) {
                continue;
            }
            let name = path.file_name().unwrap_or_default();
            copy_whole(&path, &to.join(name), false)?;
        }
    }
    for (file, to) in [
        ("crates/terrella-imagery/data/detail_tiles.jpg", "data"),
        ("textures/lines.bin", "data"),
        ("textures/SOURCES.md", "maps"),
        ("LICENSE-APACHE", ""),
        ("LICENSE-MIT", ""),
        ("THIRD-PARTY.md", ""),
    ] {
        let from = root.join(file);
        let name = from.file_name().unwrap_or_default();
        copy_whole(&from, &dist.join("terrella").join(to).join(name), false)?;
    }
    for name in MAPS {
        let to = dist.join("terrella/maps").join(name);
        copy_whole(&root.join("textures").join(name), &to, false)?;
    }
    Ok(())
}

/// Runs the parts of the test of these names; all without a name. A part that fails does not stop the others.
fn test(dist: &Path, program: Option<PathBuf>, only: &[String]) -> anyhow::Result<()> {
    let is_wanted = |part: &str| only.is_empty() || only.iter().any(|one| one == part);
    let pictures: Vec<_> = PICTURES
        .into_iter()
        .filter(|part| is_wanted(part))
        .collect();
    let (tests, web) = (
        package().join("tests"),
        repository_root().join("target/web"),
    );
    let mut failed = Vec::new();
    let mut run = |part: &str, is_wanted: bool, test: &dyn Fn() -> anyhow::Result<()>| {
        if is_wanted && let Err(error) = test() {
            say(format!("{part}: {error:#}"));
            failed.push(part.to_owned());
        }
    };
    let list = pictures.join(",");
    run(&list, !pictures.is_empty(), &|| {
        compare(dist, program.as_deref(), &list)
    });
    run("servers", is_wanted("servers"), &|| {
        parts::servers(dist, &tests, &web.join("servers"))
    });
    run("packs", is_wanted("packs"), &|| {
        let program = native_program(program.as_deref())?;
        packs::run(dist, &tests, &program, &web.join("packs"))
    });
    run("examples", is_wanted("examples"), &|| {
        parts::examples(dist, &tests, &web.join("pictures"))
    });
    run("bundlers", is_wanted("bundlers"), &|| {
        parts::bundlers(dist, &tests)
    });
    match failed.is_empty() {
        true => Ok(()),
        false => bail!("failed: {}", failed.join("; ")),
    }
}

/// Opens the pages and compares them with native pictures.
fn compare(dist: &Path, program: Option<&Path>, only: &str) -> anyhow::Result<()> {
    let (root, tests) = (repository_root(), package().join("tests"));
    for page in ["test.html", "test.css"] {
        copy_whole(&tests.join(page), &dist.join(page), false)?;
    }
    let native = root.join("target/web/native");
    let program = native_program(program)?;
    let maps = dist.join("terrella/maps");
    draw_natively(&program, &tests.join("views.json"), &maps, &native)?;
    let tools = npm::installed(&[npm::PLAYWRIGHT])?;
    let server = Server::start(dist, 0)?;
    let mut node = browser::script(&tests.join("drive.mjs"));
    node.arg(server.address());
    node.arg(&native).arg(root.join("target/web/pictures"));
    process::run(node.env("ONLY", only).current_dir(&tools))
}

/// The program that draws native pictures: as given, or built.
fn native_program(program: Option<&Path>) -> anyhow::Result<PathBuf> {
    match program {
        Some(program) => Ok(program.to_owned()),
        None => cargo::build(&["build", "--package", "terrella-cli"])?
            .terrella
            .context("cargo built no program"),
    }
}

/// Draws each view of the list with the native program and the page's maps.
fn draw_natively(program: &Path, views: &Path, maps: &Path, to: &Path) -> anyhow::Result<()> {
    let maps = fs::canonicalize(maps).with_context(|| maps.display().to_string())?;
    let text = fs::read_to_string(views).with_context(|| views.display().to_string())?;
    let views: Vec<Value> = serde_json::from_str(&text).context("views.json is no list")?;
    fs::create_dir_all(to).with_context(|| to.display().to_string())?;
    let device = browser::driver()?;
    for view in &views {
        let name = view["name"].as_str().context("a view without a name")?;
        let mut draw = Command::new(program);
        draw.envs(device.variables());
        draw.arg("frame").args(["--size", "640x360", "-o"]);
        draw.arg(to.join(format!("{name}.png")));
        match view["scene"].as_str() {
            Some(scene) => {
                draw.arg(repository_root().join(format!("config/{scene}.toml")));
                draw.arg("--set")
                    .arg(format!("earth.textures={}", maps.display()));
                draw.args(AS_A_PAGE);
            }
            None => {
                let scene = to.join(format!("{name}.toml"));
                write_bytes(&scene, scene_of(view, &maps).as_bytes())?;
                draw.arg(scene);
            }
        }
        process::run(&mut draw)?;
    }
    Ok(())
}

/// The scene file of a view: only the Earth, its atmosphere, stars and Sun, as a page draws them.
fn scene_of(view: &Value, maps: &Path) -> String {
    let kilometres = view["altitude"].as_f64().unwrap_or_default() / 1000.0;
    format!(
        "[time]\nstart = {}\n\n[earth]\ntextures = {:?}\nseasons = {}\n\n[camera]\nmode = \"geodetic\"\nlat_deg = {}\nlon_deg = {}\nheight_km = {kilometres}\nheading_deg = {}\n\
         pitch_deg = {}\nfov_deg = {}\n\n[sky]\nglare = true\n\n[output]\nsamples = 4\nexposure_ev = {}\n",
        view["epoch"],
        maps.display().to_string(),
        view["seasons"].as_bool().unwrap_or_default(),
        view["lat"],
        view["lon"],
        view["heading"],
        view["pitch"],
        view["fov"],
        view["exposure"]
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_without_pages_is_named() {
        let dist = tempfile::tempdir().unwrap();
        let error = build_or_find(dist.path(), true).unwrap_err();
        assert!(
            error.to_string().contains("terrella.js is missing"),
            "{error}"
        );
    }
}
