//! The page of all scenes in config/, from the table in config/README.md, with a picture of each.

use super::simulated::{self, WAITING};
use super::{frame, sheet};
use crate::process::repository_root;
use anyhow::{Context, Result, ensure};
use std::fmt::Write;
use std::path::Path;

const SIZE_PX: (u32, u32) = (320, 180);

const HEAD: &str = "# Gallery

<!-- Made from config/README.md and the scenes: cargo xtask pictures gallery -->

The scenes that come with the program, at the start of each. Run a command in the checkout, or in `share/terrella` of an installed
program. `terrella play` instead of `terrella frame` opens a scene in a window. Scenes with `terrella play` wait for a simulator. [config/README.md](../config/README.md) says what scenes are, and
[the first still](start/first-still.md) how to install the program.

| | |
|---|---|
";

/// Draws every scene, and writes the page.
pub fn draw(terrella: &Path) -> Result<()> {
    let root = repository_root();
    let folder = tempfile::tempdir().context("no temporary folder")?;
    let table = std::fs::read_to_string(root.join("config/README.md"))?;
    let scenes = scenes(&table);
    ensure!(
        !scenes.is_empty(),
        "config/README.md has no table of scenes"
    );
    for (name, _) in &scenes {
        let picture = folder.path().join("scene.png");
        if WAITING.contains(name) {
            simulated::draw(terrella, &root.join("config"), name, SIZE_PX, &picture)?;
        } else {
            let scene = format!("config/{name}.toml");
            frame(terrella, &root, &scene, SIZE_PX, &[], &picture)?;
        }
        let out = root.join(format!("docs/gallery/{name}.jpg"));
        sheet::write(&sheet::read(&picture)?, sheet::SMALL, &out)?;
    }
    let path = root.join("docs/gallery.md");
    std::fs::write(&path, page(&scenes)).with_context(|| path.display().to_string())
}

/// Name and description of each scene in the table of config/README.md, in order.
fn scenes(table: &str) -> Vec<(&str, &str)> {
    let rows = table.lines().filter_map(|line| {
        let (name, rest) = line.strip_prefix("| [")?.split_once(".toml](")?;
        let description = rest.split_once(" | ")?.1.strip_suffix(" |")?;
        Some((name, description))
    });
    rows.collect()
}

/// The page, with two scenes per row.
fn page(scenes: &[(&str, &str)]) -> String {
    let cell = |(name, description): &(&str, &str)| {
        let command = match WAITING.contains(name) {
            true => format!("terrella play config/{name}.toml"),
            false => format!("terrella frame config/{name}.toml -o {name}.png"),
        };
        format!(
            "![{description}](gallery/{name}.jpg)<br>[{name}](../config/{name}.toml): {description}<br>`{command}`"
        )
    };
    let mut page = HEAD.to_owned();
    for row in scenes.chunks(2) {
        let cells: Vec<_> = row.iter().map(cell).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(page, "| {} |", cells.join(" | "));
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gallery_shows_every_scene_and_is_current() {
        let root = repository_root();
        let table = std::fs::read_to_string(root.join("config/README.md")).unwrap();
        let scenes = scenes(&table);
        let files = std::fs::read_dir(root.join("config")).unwrap();
        let files = files.map(|file| file.unwrap().path());
        let mut files: Vec<_> = files
            .filter(|path| {
                path.extension()
                    .is_some_and(|extension| extension == "toml")
            })
            .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
            .collect();
        let mut names: Vec<_> = scenes.iter().map(|(name, _)| *name).collect();
        names.sort_unstable();
        files.sort();
        assert_eq!(names, files, "config/README.md and config/");
        let committed = std::fs::read_to_string(root.join("docs/gallery.md")).unwrap();
        assert!(
            committed == page(&scenes),
            "docs/gallery.md is not made from config/README.md; run `cargo xtask pictures gallery`"
        );
        let mut sum = 0;
        for name in &names {
            let picture = root.join(format!("docs/gallery/{name}.jpg"));
            assert_eq!(
                sheet::read(&picture).unwrap().dimensions(),
                SIZE_PX,
                "{name}"
            );
            sum += picture.metadata().unwrap().len();
        }
        assert!(sum < 400_000, "{sum} bytes of pictures");
    }

    #[test]
    fn rows_of_the_table_are_scenes() {
        let table = "| scene | shows |\n|---|---|\n| [a.toml](a.toml) | an a |\n| b | c |\n";
        assert_eq!(scenes(table), [("a", "an a")]);
        assert!(page(&[("live", "x")]).contains("`terrella play config/live.toml`"));
    }
}
