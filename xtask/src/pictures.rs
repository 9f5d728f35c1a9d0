//! `cargo xtask pictures`: draws the pictures of README.md and of the pages of docs/ again.

use crate::cargo;
use crate::process::{self, repository_root, say};
use anyhow::{Context, Result};
use image::codecs::jpeg::JpegEncoder;
use image::{RgbImage, imageops};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Size of each scene in a picture, pixels, and how many stand in a row.
const SCENE_PX: (u32, u32) = (640, 360);
const COLUMNS: u32 = 2;
const BUILD: [&str; 5] = [
    "build",
    "--release",
    "--locked",
    "--package",
    "terrella-cli",
];
const JPEG_QUALITY: u8 = 88;

/// A picture: its name below docs/, and the scenes in it, each at an instant where it is not the scene's start.
struct Sheet {
    name: &'static str,
    scenes: &'static [(&'static str, Option<&'static str>)],
}

const SHEETS: &[Sheet] = &[
    Sheet {
        name: "terrella.jpg",
        scenes: &[
            ("iss", None),
            ("iss", Some("2018-01-14T13:24:00Z")),
            ("iss", Some("2018-01-14T14:09:30Z")),
            ("iss", Some("2018-01-14T14:35:10Z")),
        ],
    },
    Sheet {
        name: "light.jpg",
        scenes: &[
            ("full_disc", None),
            ("crescent", None),
            ("sunrise", None),
            ("glint", None),
            ("night_europe", None),
            ("inside_air", None),
        ],
    },
    Sheet {
        name: "sky.jpg",
        scenes: &[
            ("night", None),
            ("moonrise", None),
            ("eclipse", None),
            ("eclipse_low", None),
        ],
    },
];

/// Draws those of these names, or all, with a program, or with one that is built for it.
///
/// # Errors
/// A program that cannot be built, a name that is none, a scene that cannot be drawn, a file that cannot be written.
pub fn run(program: Option<PathBuf>, names: &[String]) -> Result<()> {
    let sheets = wanted(names)?;
    let terrella = match program {
        Some(program) => program
            .canonicalize()
            .with_context(|| program.display().to_string())?,
        None => cargo::build(&BUILD)?
            .terrella
            .context("cargo built the program and did not say where it is")?,
    };
    let root = repository_root();
    let folder = tempfile::tempdir().context("no temporary folder")?;
    for sheet in sheets {
        let mut parts = Vec::new();
        for (n, (scene, at)) in sheet.scenes.iter().enumerate() {
            let picture = folder.path().join(format!("{n}.png"));
            let mut command = Command::new(&terrella);
            command.current_dir(&root).arg("--quiet").arg("frame");
            command.arg(format!("config/{scene}.toml"));
            command.args(["--size", &format!("{}x{}", SCENE_PX.0, SCENE_PX.1)]);
            command.args(at.iter().flat_map(|at| ["--at", *at]));
            process::run(command.arg("-o").arg(&picture))?;
            let read = image::open(&picture).with_context(|| picture.display().to_string())?;
            parts.push(read.into_rgb8());
        }
        let path = root.join("docs").join(sheet.name);
        write(&together(&parts), &path)?;
        say(format_args!("wrote {}", path.display()));
    }
    Ok(())
}

fn wanted(names: &[String]) -> Result<Vec<&'static Sheet>> {
    let known = || SHEETS.iter().map(|sheet| sheet.name).collect::<Vec<_>>();
    if names.is_empty() {
        return Ok(SHEETS.iter().collect());
    }
    let sheets = names.iter().map(|name| {
        let sheet = SHEETS.iter().find(|sheet| sheet.name == name);
        sheet.with_context(|| format!("{name} is none of {}", known().join(", ")))
    });
    sheets.collect()
}

/// Side by side, row by row.
fn together(parts: &[RgbImage]) -> RgbImage {
    let rows = (parts.len() as u32).div_ceil(COLUMNS);
    let mut sheet = RgbImage::new(COLUMNS * SCENE_PX.0, rows * SCENE_PX.1);
    for (n, part) in (0..).zip(parts) {
        let (x, y) = (n % COLUMNS * SCENE_PX.0, n / COLUMNS * SCENE_PX.1);
        imageops::replace(&mut sheet, part, x.into(), y.into());
    }
    sheet
}

fn write(sheet: &RgbImage, path: &Path) -> Result<()> {
    let mut jpeg = Vec::new();
    JpegEncoder::new_with_quality(&mut jpeg, JPEG_QUALITY).encode_image(sheet)?;
    std::fs::write(path, jpeg).with_context(|| path.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_there() {
        for sheet in SHEETS {
            for (scene, _) in sheet.scenes {
                let path = repository_root().join(format!("config/{scene}.toml"));
                assert!(path.is_file(), "{}", path.display());
            }
            assert!(repository_root().join("docs").join(sheet.name).is_file());
        }
    }

    #[test]
    fn names_choose_and_wrong_ones_list_the_right_ones() {
        let names =
            |names: &[&str]| wanted(&names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>());
        assert_eq!(names(&[]).unwrap().len(), SHEETS.len());
        assert_eq!(names(&["sky.jpg"]).unwrap()[0].name, "sky.jpg");
        let error = names(&["moon.jpg"]).err().unwrap().to_string();
        assert!(
            error.contains("moon.jpg is none of terrella.jpg, light.jpg"),
            "{error}"
        );
    }

    #[test]
    fn parts_stand_in_rows() {
        let part = |value| RgbImage::from_pixel(SCENE_PX.0, SCENE_PX.1, image::Rgb([value; 3]));
        let sheet = together(&[part(1), part(2), part(3)]);
        assert_eq!(sheet.dimensions(), (2 * SCENE_PX.0, 2 * SCENE_PX.1));
        let at = |x, y| sheet.get_pixel(x * SCENE_PX.0, y * SCENE_PX.1).0[0];
        assert_eq!([at(0, 0), at(1, 0), at(0, 1), at(1, 1)], [1, 2, 3, 0]);
    }
}
