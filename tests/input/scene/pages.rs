//! Parts of scenes on the pages are valid as printed, or their fence gives the reason why they are not scenes.

use std::path::{Path, PathBuf};
use terrella_play::scene::Scene;

/// The pages of `docs/`, with their paths.
fn pages() -> Vec<(PathBuf, String)> {
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")];
    let mut pages = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                let text = std::fs::read_to_string(&path).expect("a page");
                pages.push((path, text));
            }
        }
    }
    pages
}

/// Blocks of TOML: their lines, the rest of the fence after the language, and the text.
fn blocks(page: &str) -> Vec<(usize, &str, String)> {
    let mut blocks: Vec<(usize, &str, String)> = Vec::new();
    // Whether the line is in a block, and in one of TOML.
    let (mut is_inside, mut is_toml) = (false, false);
    for (number, line) in (1..).zip(page.lines()) {
        match line.strip_prefix("```") {
            Some(_) if is_inside => is_inside = false,
            Some(fence) => {
                let (language, rest) = fence.split_once(' ').unwrap_or((fence, ""));
                (is_inside, is_toml) = (true, language == "toml");
                if is_toml {
                    blocks.push((number, rest, String::new()));
                }
            }
            None if is_inside && is_toml => {
                if let Some((_, _, text)) = blocks.last_mut() {
                    text.push_str(line);
                    text.push('\n');
                }
            }
            None => {}
        }
    }
    blocks
}

/// Faults of a page's blocks, and the number of scenes.
fn faults(path: &Path, page: &str) -> (Vec<String>, usize) {
    let (mut faults, mut scenes) = (Vec::new(), 0);
    for (line, rest, text) in blocks(page) {
        let place = format!("{}:{line}", path.display());
        match (rest, rest.strip_prefix("no-run: ")) {
            ("", _) => {
                scenes += 1;
                // Pictures of captions are read with the scene; of other files it looks for their names alone.
                let folder = tempfile::tempdir().expect("a temporary folder");
                let logo = image::RgbaImage::from_pixel(4, 2, image::Rgba([255; 4]));
                let saved = logo.save(folder.path().join("logo.png"));
                saved.expect("a logo");
                for name in ["my.tle", "satellite.glb"] {
                    std::fs::write(folder.path().join(name), "").expect("a file");
                }
                if let Err(error) = Scene::from_toml(&text, &folder.path().join("scene.toml")) {
                    faults.push(format!("{place}: {error}"));
                }
            }
            (_, Some(reason)) if !reason.trim().is_empty() => {}
            _ => faults.push(format!("{place}: {rest:?} is not \"no-run: REASON\"")),
        }
    }
    (faults, scenes)
}

#[test]
fn scenes_on_the_pages_are_scenes() {
    let found = pages().into_iter().map(|(path, text)| faults(&path, &text));
    let (faults, scenes): (Vec<_>, Vec<_>) = found.unzip();
    let faults: Vec<_> = faults.into_iter().flatten().collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(scenes.iter().sum::<usize>() >= 5, "{scenes:?}");
}

#[test]
fn a_block_that_is_no_scene_is_found() {
    let page = Path::new("page.md");
    let count = |text: &str| faults(page, text).0.len();
    assert_eq!(count("```toml\n[camera]\nmode = \"nadir\"\n```\n"), 0);
    assert_eq!(count("```toml\n[camera]\nmood = \"nadir\"\n```\n"), 1);
    assert_eq!(
        count("```toml no-run: of a crate\n[dependencies]\n```\n"),
        0
    );
    assert_eq!(count("```toml no-run:\n[dependencies]\n```\n"), 1);
    assert_eq!(count("```toml\n[dependencies]\n```\n"), 1);
    // Lines of another block are not part of it.
    assert_eq!(
        count("```sh\n[dependencies]\n```\n```toml\n```\n[more]\n"),
        0
    );
}
