//! `cargo xtask pictures`: draws the pictures of README.md and of the pages of docs/ again.

mod film;
mod gallery;
mod sheet;
mod simulated;
mod tutorials;

use crate::cargo;
use crate::process::{self, repository_root, say};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;
use tutorials::Tutorial;

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
/// Name of the page of all scenes, with its pictures.
const GALLERY: &str = "gallery";

/// A picture of scenes of config/.
struct Sheet {
    /// Name below docs/.
    name: &'static str,
    /// The scenes in it, each at an instant where it is not the scene's start.
    scenes: &'static [(&'static str, Option<&'static str>)],
}

const SHEETS: &[Sheet] = &[
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
        name: "seasons.jpg",
        scenes: &[("arctic", None), ("arctic", Some("2018-09-08T16:00:00Z"))],
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

/// What can be drawn, by name.
enum Picture {
    Film,
    Sheet(&'static Sheet),
    Tutorial(&'static Tutorial),
    Gallery,
}

impl Picture {
    fn all() -> Vec<Self> {
        let sheets = SHEETS.iter().map(Self::Sheet);
        let tutorials = tutorials::ALL.iter().map(Self::Tutorial);
        [Self::Film]
            .into_iter()
            .chain(sheets)
            .chain(tutorials)
            .chain([Self::Gallery])
            .collect()
    }

    fn name(&self) -> String {
        match self {
            Self::Film => film::NAME.to_owned(),
            Self::Sheet(sheet) => sheet.name.to_owned(),
            Self::Tutorial(tutorial) => tutorial.picture(),
            Self::Gallery => GALLERY.to_owned(),
        }
    }
}

/// Draws those of these names, or all, with a program, or with one that is built for it.
///
/// # Errors
/// A program that cannot be built, a name that is none, a scene that cannot be drawn, a file that cannot be written.
pub fn run(program: Option<PathBuf>, names: &[String]) -> Result<()> {
    let wanted = wanted(names)?;
    let terrella = match program {
        Some(program) => program
            .canonicalize()
            .with_context(|| program.display().to_string())?,
        None => cargo::build(&BUILD)?
            .terrella
            .context("cargo built the program and did not say where it is")?,
    };
    let docs = repository_root().join("docs");
    for picture in wanted {
        match &picture {
            Picture::Film => film::draw(&terrella, &docs.join(film::NAME))?,
            Picture::Sheet(sheet) => draw(sheet, &terrella, &docs.join(sheet.name))?,
            Picture::Tutorial(tutorial) => tutorial.draw(&terrella, &docs)?,
            Picture::Gallery => gallery::draw(&terrella)?,
        }
        say(format_args!("wrote docs/{}", picture.name()));
    }
    Ok(())
}

fn draw(of: &Sheet, terrella: &Path, path: &Path) -> Result<()> {
    let folder = tempfile::tempdir().context("no temporary folder")?;
    let mut parts = Vec::new();
    for (n, (scene, at)) in of.scenes.iter().enumerate() {
        let picture = folder.path().join(format!("{n}.png"));
        let scene = format!("config/{scene}.toml");
        let at: Vec<_> = at.iter().flat_map(|at| ["--at", *at]).collect();
        frame(
            terrella,
            &repository_root(),
            &scene,
            SCENE_PX,
            &at,
            &picture,
        )?;
        parts.push(sheet::read(&picture)?);
    }
    sheet::write(&sheet::together(&parts, COLUMNS), sheet::WHOLE, path)
}

/// `terrella frame` of a scene, or of the built-in one where it has no name, in a folder.
fn frame(
    terrella: &Path,
    folder: &Path,
    scene: &str,
    size_px: (u32, u32),
    more: &[&str],
    picture: &Path,
) -> Result<()> {
    let mut command = Command::new(terrella);
    command.current_dir(folder).args(["--quiet", "frame"]);
    command.args(Some(scene).filter(|scene| !scene.is_empty()));
    command.args(["--size", &format!("{}x{}", size_px.0, size_px.1)]);
    process::run(command.args(more).arg("-o").arg(picture))
}

fn wanted(names: &[String]) -> Result<Vec<Picture>> {
    let all = Picture::all();
    let known: Vec<_> = all.iter().map(Picture::name).collect();
    if let Some(name) = names.iter().find(|name| !known.contains(name)) {
        bail!("{name} is none of {}", known.join(", "));
    }
    let is_wanted = |picture: &Picture| names.is_empty() || names.contains(&picture.name());
    Ok(all.into_iter().filter(is_wanted).collect())
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
        assert_eq!(names(&[]).unwrap().len(), Picture::all().len());
        for name in ["sky.jpg", "start/film.jpg", "gallery"] {
            let found = names(&[name]).unwrap();
            assert!(found.len() == 1 && found[0].name() == name);
        }
        let error = names(&["moon.jpg"]).err().unwrap().to_string();
        assert!(
            error.contains("moon.jpg is none of terrella.webp, light.jpg"),
            "{error}"
        );
    }
}
