//! What makes a film another film: the program, the scene, the files that the scene names, and how it is drawn.

use super::error::FilmError;
use super::settings::PictureSettings;
use crate::files;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};

/// What a film is known by. Frames of two films that are alike in this are the same on one machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilmKey {
    /// The program and its version.
    pub program: String,
    /// BLAKE3 of the scene's text.
    pub scene_blake3: String,
    /// What the scene names.
    pub inputs: Vec<Input>,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// How they are made and kept.
    pub pictures: PictureSettings,
}

/// A file that a scene names.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Its name, without folders: a film may be gone on with elsewhere.
    pub file: String,
    /// BLAKE3 of its bytes.
    pub blake3: String,
}

impl FilmKey {
    /// The film of a scene file with pictures of this size. Reads the files that the scene names.
    ///
    /// # Errors
    /// A file that cannot be read any more.
    pub fn new(
        scene: &Scene,
        size: (u32, u32),
        pictures: PictureSettings,
    ) -> Result<Self, FilmError> {
        let mut inputs = Vec::new();
        for path in files_of(scene)? {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            inputs.push(Input {
                file: name.into_owned(),
                blake3: checksum_of(&path)?,
            });
        }
        Ok(Self {
            program: concat!("terrella ", env!("CARGO_PKG_VERSION")).to_owned(),
            // The built-in scene has no file, and is the program's.
            scene_blake3: match scene.path.is_file() {
                true => checksum_of(&scene.path)?,
                false => checksum(scene.full_summary().as_bytes()),
            },
            inputs,
            size: size.into(),
            pictures,
        })
    }

    /// How another film differs, in words; `None` where it is the same.
    pub fn differences(&self, found: &Self) -> Option<String> {
        let mut words = Vec::new();
        if self.program != found.program {
            words.push(format!(
                "it was drawn by {}, this is {}",
                found.program, self.program
            ));
        }
        if self.scene_blake3 != found.scene_blake3 {
            words.push("the scene has changed".to_owned());
        }
        let changed = self
            .inputs
            .iter()
            .filter(|input| !found.inputs.contains(input));
        let names: Vec<_> = changed.map(|input| input.file.as_str()).collect();
        if !names.is_empty() {
            words.push(format!(
                "what the scene names has changed ({})",
                names.join(", ")
            ));
        } else if self.inputs.len() != found.inputs.len() {
            words.push("the scene named other files".to_owned());
        }
        let [[w, h], [old_w, old_h]] = [self.size, found.size];
        if self.size != found.size {
            words.push(format!(
                "its pictures have {old_w} × {old_h} pixels, these {w} × {h}"
            ));
        }
        let settings = [
            ("--format", self.pictures.format != found.pictures.format),
            ("--alpha", self.pictures.alpha != found.pictures.alpha),
            (
                "--supersample",
                self.pictures.supersample != found.pictures.supersample,
            ),
            (
                "--shutter or --subframes",
                self.pictures.shutter != found.pictures.shutter,
            ),
        ];
        for (name, _) in settings.iter().filter(|(_, differs)| *differs) {
            words.push(format!("it was drawn with another {name}"));
        }
        (!words.is_empty()).then(|| words.join("; "))
    }
}

/// The files that a scene names, in the order of its keys; of a folder those directly in it, of a pack its manifest, which holds the
/// checksums of its tiles.
fn files_of(scene: &Scene) -> Result<Vec<PathBuf>, FilmError> {
    let mut files = Vec::new();
    files.extend(scene.time.orientation.clone());
    files.extend(scene.orbits.iter().filter_map(|orbit| orbit.file.clone()));
    if let Some(folder) = &scene.earth.textures {
        files.extend(files_in(folder)?);
    }
    if let Some(pack) = &scene.earth.pack {
        files.push(pack.folder.join("pack.toml"));
    }
    let relief = scene.earth.relief.iter();
    files.extend(relief.flat_map(|relief| relief.elevation.clone()));
    if let Some(folder) = &scene.sky.folder {
        files.extend(files_in(folder)?);
    }
    files.extend(scene.quality.ladder.clone());
    Ok(files)
}

fn files_in(folder: &Path) -> Result<Vec<PathBuf>, FilmError> {
    let unreadable = |source| FilmError::Input {
        path: folder.to_owned(),
        source,
    };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

fn checksum_of(path: &Path) -> Result<String, FilmError> {
    let mut hasher = blake3::Hasher::new();
    files::open(path)
        .and_then(|mut file| io::copy(&mut file, &mut hasher))
        .map_err(|source| FilmError::Input {
            path: path.to_owned(),
            source,
        })?;
    Ok(hasher.finalize().to_hex().to_string())
}

/// BLAKE3 of bytes, in hexadecimal digits.
pub fn checksum(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_changes_is_named() {
        let root = tempfile::tempdir().expect("a folder");
        let path = root.path().join("a.toml");
        let text = "[time]\nduration_s = 60\n[orbit]\nsource = \"tle\"\nfile = \"a.tle\"\n";
        let elements = include_str!("../../../config/orbits/iss.tle");
        std::fs::write(&path, text).expect("writes");
        std::fs::write(root.path().join("a.tle"), elements).expect("writes");
        let key = |size| {
            let scene = Scene::load(&path).expect("a good scene");
            FilmKey::new(&scene, size, PictureSettings::default()).expect("a film")
        };
        let before = key((64, 36));
        assert_eq!(before.differences(&key((64, 36))), None);
        let words = |size| key(size).differences(&before).expect("another film");
        assert!(words((80, 36)).contains("64 × 36 pixels, these 80 × 36"));
        std::fs::write(root.path().join("a.tle"), format!("{elements}\n")).expect("writes");
        assert!(words((64, 36)).contains("(a.tle)"), "{}", words((64, 36)));
        std::fs::write(&path, format!("{text}# more\n")).expect("writes");
        assert!(words((64, 36)).contains("the scene has changed"));
        let older = FilmKey {
            program: "terrella 0.0.9".into(),
            ..key((64, 36))
        };
        let words = key((64, 36)).differences(&older).expect("another");
        assert!(
            words.contains("by terrella 0.0.9, this is terrella "),
            "{words}"
        );
    }
}
