//! Films are not mixed: every file that the pictures of a film come from makes it what it is.

use crate::films::page;
use crate::{Place, words};
use image::{GrayImage, ImageBuffer, Luma, Rgb, RgbImage};
use std::path::{Path, PathBuf};
use std::process::Output;

/// A scene of three small frames above a place, with only what is written here.
fn scene(earth: &str, more: &str) -> String {
    format!(
        "[time]\nstart = \"2018-01-15T06:14:00Z\"\nduration_s = 3\nspeed = 10\nframe_rate_hz = 10\n\
         [camera]\nmode = \"geodetic\"\nlat_deg = 20\nlon_deg = 60\nheight_km = 9000\n\
         [earth]\natmosphere = \"none\"\n{earth}\n[output]\nsize = [64, 36]\n{more}\n"
    )
}

const NO_SKY: &str = "[sky]\nstars = false\nsun = false\nmoon = false\neclipses = false";

fn write_grey(path: &Path, value: u8) {
    let map = GrayImage::from_pixel(128, 64, Luma([value]));
    map.save(path).expect("writes");
}

fn write_heights(path: &Path, metres: u16) {
    let map = ImageBuffer::from_pixel(128, 64, Luma([11_000 + metres]));
    map.save(path).expect("writes");
}

const SIDECAR: &str = "bounds = { south_deg = -90, north_deg = 90, west_deg = -180, east_deg = 180 }\n\
                       registration = \"cells\"\nunit = \"metres\"\noffset = -11000.0\n";

/// Small maps under the names of the starter pack, with its sky.
fn write_starter_pack(folder: &Path) {
    std::fs::create_dir_all(folder).expect("made");
    let day = RgbImage::from_fn(128, 64, |x, y| Rgb([2 * x as u8, 4 * y as u8, 90]));
    day.save(folder.join("day.jpg")).expect("writes");
    write_grey(&folder.join("clouds.png"), 50);
    write_grey(&folder.join("night_lights.png"), 10);
    write_grey(&folder.join("water.png"), 0);
    write_heights(&folder.join("elevation.png"), 300);
    std::fs::write(folder.join("elevation.toml"), SIDECAR).expect("writes");
    let shipped = Path::new(crate::REPOSITORY).join("textures");
    for name in ["stars.bin", "milky_way.jpg", "moon.jpg"] {
        std::fs::copy(shipped.join(name), folder.join(name)).expect("copies");
    }
}

fn copy(from: &Path, to: &Path) {
    std::fs::copy(from, to).expect("copies");
}

struct Film {
    place: Place,
}

impl Film {
    fn new(scene: &str) -> Self {
        let place = Place::new();
        write_starter_pack(&place.path("starter"));
        place.scene("s.toml", scene);
        Self { place }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.place.path(name)
    }

    fn play(&self, options: &[&str]) -> Output {
        let arguments = [&["play", "s.toml", "--frames", "f"], options].concat();
        let mut command = self.place.command(&arguments);
        let command = command.env("TERRELLA_TEXTURES", self.path("starter"));
        command.output().expect("starts")
    }

    /// Draws a part of the film, lets `change` change files, and continues: both must end with this code.
    fn resumed_after(&self, change: impl FnOnce(), code: i32) -> String {
        let begun = self.play(&["--overwrite", "--range", "0..1"]);
        assert_eq!(begun.status.code(), Some(0), "{}", words(&begun));
        change();
        let resumed = self.play(&["--resume"]);
        assert_eq!(resumed.status.code(), Some(code), "{}", words(&resumed));
        words(&resumed)
    }

    fn rejected(&self, change: impl FnOnce(), reported: &str) {
        let words = self.resumed_after(change, 1);
        let advice = words.contains("another film") && words.contains("--overwrite");
        assert!(words.contains(reported) && advice, "{words}");
    }
}

#[test]
fn a_film_with_another_dated_map_is_another() {
    let maps = "[{ date = \"2018-01-15T00:00:00Z\", file = \"a.png\" }, { date = \"2018-01-16T00:00:00Z\", file = \"b.png\" }]";
    let film = Film::new(&scene(&format!("cloud_maps = {maps}"), NO_SKY));
    write_grey(&film.path("a.png"), 255);
    write_grey(&film.path("b.png"), 255);
    let change = || write_grey(&film.path("b.png"), 40);
    film.rejected(change, "changed files: b.png (earth.cloud_maps)");
    film.resumed_after(|| (), 0);
}

#[test]
fn a_film_with_another_default_or_sidecar_is_another() {
    let relief = scene("elevation = []", "[sky]\nmilky_way = true");
    let film = Film::new(&relief);
    let starter = |name: &str| film.path("starter").join(name);
    film.rejected(
        || {
            std::fs::write(
                starter("elevation.toml"),
                SIDECAR.replace("-11000", "-10000"),
            )
            .expect("writes")
        },
        "changed files: elevation.toml (earth.elevation)",
    );
    film.rejected(
        || write_grey(&starter("night_lights.png"), 200),
        "changed files: night_lights.png (earth.textures)",
    );
    film.rejected(
        || copy(&starter("day.jpg"), &starter("moon.jpg")),
        "changed files: moon.jpg (sky.folder)",
    );
    film.rejected(
        || std::fs::remove_file(starter("water.png")).expect("removes"),
        "missing files: water.png (earth.textures)",
    );
    // Files that do not affect any image may change.
    film.resumed_after(
        || std::fs::write(starter("SOURCES.md"), "new").expect("writes"),
        0,
    );
}

/// Every regular file that a film opens, as the kernel sees it, is in the film's key: by its name and checksum on the page.
#[cfg(target_os = "linux")]
#[test]
fn every_file_that_a_film_opens_is_in_its_key() {
    if !strace_works() {
        eprintln!(
            "SKIPPED: strace is not installed or may not trace; no test saw which files a film opens"
        );
        return;
    }
    let dated = "[{ date = \"2018-01-15T00:00:00Z\", file = \"a.png\" }, { date = \"2018-01-16T00:00:00Z\", file = \"b.png\" }]";
    let repository = Path::new(crate::REPOSITORY).display();
    let orbit = format!(
        "[[orbit]]\nfile = \"{repository}/config/orbits/iss.tle\"\n[tracks]\ntrail = true\n"
    );
    for (what, text) in [
        ("defaults", scene("look = \"full\"", "")),
        ("paper", scene("look = \"paper\"", "")),
        ("heights", scene("elevation = [\"heights.png\"]", NO_SKY)),
        ("the starter pack's heights", scene("elevation = []", NO_SKY)),
        (
            "dated maps",
            scene(
                &format!("day_maps = {dated}\ncloud_maps = {dated}\nnight_light_maps = {dated}"),
                NO_SKY,
            ),
        ),
        (
            "tables",
            // The table has that January alone, and the station's elements the next one.
            scene("", "[quality]\ntarget_ms = 30\nladder = \"ladder.csv\"")
                .replace(
                    "[time]",
                    &format!("[time]\norientation = \"{repository}/tests/data/orbit/finals2000A.extract\"")
                )
                .replace("2018-01-15", "2017-01-05"),
        ),
        ("an orbit", format!("{orbit}{}", scene("", NO_SKY))),
        ("a pack", scene("pack = \"earth\"", NO_SKY)),
    ] {
        let film = Film::new(&text);
        for name in ["a.png", "b.png"] {
            write_grey(&film.path(name), 77);
        }
        write_heights(&film.path("heights.png"), 200);
        std::fs::write(film.path("heights.toml"), SIDECAR).expect("writes");
        let ladder = Path::new(crate::REPOSITORY).join("src/earth/quality_ladder/software.csv");
        std::fs::copy(ladder, film.path("ladder.csv")).expect("copies");
        if what == "a pack" {
            film.place.succeed(&[
                "-q", "pack", "build", "--day", "starter/day.jpg", "--clouds", "starter/clouds.png", "--pixels", "day=16", "-o", "earth",
            ]);
        }
        let opened = opened_by(&film);
        let known = page(&film.path("f"));
        let known = known["film"]["inputs"].as_array().expect("a list").clone();
        for path in &opened {
            let bytes = std::fs::read(path).expect("reads");
            let name = path.file_name().expect("a name").to_string_lossy();
            let is_input = known.iter().any(|input| {
                input["file"] == *name && input["blake3"] == blake3::hash(&bytes).to_hex().as_str()
            });
            // The scene has a separate checksum, and the manifest of a pack has those of its files. Shaders of a development build, if they differ
            // from the embedded ones, are in the name of the program.
            let shaders = Path::new(crate::REPOSITORY).join("shaders");
            let is_shader = path.starts_with(shaders.canonicalize().expect("the folder"));
            let is_known = is_input || is_shader || path.ends_with("s.toml") || path.starts_with(film.path("earth"));
            assert!(is_known, "{what}: {} is not in the key", path.display());
        }
        // The trace sees something.
        let day = if what == "a pack" { "earth/pack.toml" } else { "starter/day.jpg" };
        assert!(opened.contains(&film.path(day)), "{what}: {opened:?}");
    }
}

#[cfg(target_os = "linux")]
fn strace_works() -> bool {
    let traced = std::process::Command::new("strace")
        .args(["-f", "-y", "-o", "/dev/null", "true"])
        .output();
    traced.is_ok_and(|output| output.status.success())
}

/// The regular files that a film opens, except those of the system and its own folder.
#[cfg(target_os = "linux")]
fn opened_by(film: &Film) -> Vec<PathBuf> {
    let play = film.place.command(&[]);
    let mut strace = std::process::Command::new("strace");
    strace
        .args([
            "-f",
            "-y",
            "-e",
            "trace=open,openat,openat2",
            "-o",
            "opened.txt",
        ])
        .arg(play.get_program())
        .args(["-q", "play", "s.toml", "--frames", "f"])
        .current_dir(film.path(""))
        .env("TERRELLA_TEXTURES", film.path("starter"))
        .env("HOME", film.path("home"))
        .env("XDG_RUNTIME_DIR", film.path("home"))
        .env("XDG_CACHE_HOME", film.path("home"))
        .env_remove("RUST_LOG")
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY");
    let output = strace.output().expect("strace starts");
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    let trace = std::fs::read_to_string(film.path("opened.txt")).expect("a trace");
    // The opened path is after the number: = 5</path/of/a/file>
    let opened = trace.lines().filter_map(|line| {
        let (_, path) = line.rsplit_once("= ")?.1.split_once('<')?;
        Some(PathBuf::from(path.strip_suffix('>')?))
    });
    let system = [
        "/usr", "/lib", "/lib64", "/etc", "/proc", "/sys", "/dev", "/run", "/var", "/opt",
    ];
    let is_ours = |path: &PathBuf| {
        let own = [film.path("f"), film.path("home")];
        path.is_file()
            && !system.iter().any(|folder| path.starts_with(folder))
            && !own.iter().any(|folder| path.starts_with(folder))
            && path != Path::new(env!("CARGO_BIN_EXE_terrella"))
    };
    opened.filter(is_ours).collect()
}
