//! Identity of a film: the program, the scene, the input files, and the drawing settings.

use super::error::FilmError;
use super::settings::PictureSettings;
use crate::error::PlayError;
use crate::raw_format::RawFormat;
use crate::scene::Scene;
use crate::scene_files::{SceneFile, scene_files};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use terrella::EarthError;
use terrella::frames::{TimeScale, ccsds_time};
use terrella::internals::gpu::ShaderFiles;
use terrella_files as files;

/// Most files that a message names of each kind of change.
const MOST_NAMED: usize = 5;
/// Most characters of a name in a message.
const NAME_CHARS: usize = 80;

/// Identity of a film. Frames of two films with equal keys are identical on one machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilmKey {
    /// The program and its version.
    pub program: String,
    /// BLAKE3 of the scene's text.
    pub scene_blake3: String,
    /// The instant of frame 0, UTC: a scene may leave it to the clock, to the command line, or to the file of its satellite.
    pub start_utc: String,
    /// The files that its pictures come from.
    pub inputs: Vec<FilmInput>,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// How they are made and kept.
    pub pictures: PictureSettings,
    /// The format of raw frames; `None` of pictures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub raw: Option<RawFormat>,
}

/// A file that pictures come from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilmInput {
    /// The scene's key that leads to it.
    pub key: String,
    /// Its name, without folders: a film may be gone on with elsewhere.
    pub file: String,
    /// BLAKE3 of its bytes.
    pub blake3: String,
}

impl FilmKey {
    /// The key of a scene's film with images of this size. Reads all input files.
    ///
    /// # Errors
    /// A file that cannot be found or read.
    pub fn new(
        scene: &Scene,
        size: (u32, u32),
        pictures: PictureSettings,
    ) -> Result<Self, PlayError> {
        let inputs = scene_files(scene)?
            .par_iter()
            .map(FilmInput::of)
            .collect::<Result<_, _>>()?;
        Ok(Self {
            program: program()?,
            // Scenes without a file also have a text.
            scene_blake3: match scene.own_text() {
                Some(text) => checksum(text.as_bytes()),
                None if scene.path.is_file() => checksum_of(&scene.path)?,
                None => checksum(scene.full_summary().as_bytes()),
            },
            start_utc: ccsds_time(scene.time.start, TimeScale::Utc) + "Z",
            inputs,
            size: size.into(),
            pictures,
            raw: None,
        })
    }

    /// How another film differs, in words; `None` where it is the same.
    pub fn differences(&self, found: &Self) -> Option<String> {
        let mut words = Vec::new();
        words.extend(self.program_difference(&found.program));
        if self.scene_blake3 != found.scene_blake3 {
            words.push("the scene has changed".to_owned());
        }
        if self.start_utc != found.start_utc {
            let (before, now) = (shown(&found.start_utc), &self.start_utc);
            words.push(format!(
                "it begins at {before}, this at {now} (--start {before} continues with it)"
            ));
        }
        words.extend(input_differences(&self.inputs, &found.inputs));
        if self.size != found.size {
            let [[w, h], [old_w, old_h]] = [self.size, found.size];
            words.push(format!(
                "its images have {old_w} × {old_h} pixels, these {w} × {h}"
            ));
        }
        words.extend(match (self.raw, found.raw) {
            (Some(_), None) => Some("it has pictures and no raw frames".to_owned()),
            (None, Some(_)) => Some("it has raw frames and no pictures".to_owned()),
            (now, before) => (now != before).then(|| "it has another --raw-format".to_owned()),
        });
        let options = self.pictures.differences(&found.pictures);
        words.extend(options.map(|name| format!("it was rendered with another {name}")));
        (!words.is_empty()).then(|| words.join("; "))
    }

    /// How another program differs, as text.
    pub(super) fn program_difference(&self, found: &str) -> Option<String> {
        let (before, now) = (shown(found), &self.program);
        (found != now).then(|| format!("it was rendered by {before}, this is {now}"))
    }
}

/// This program, and where shaders are read that are not its own, these.
fn program() -> Result<String, PlayError> {
    let own = concat!("terrella ", env!("CARGO_PKG_VERSION"));
    let changed = ShaderFiles::chosen().changed().map_err(EarthError::from)?;
    if changed.is_empty() {
        return Ok(own.to_owned());
    }
    let mut hasher = blake3::Hasher::new();
    for (name, text) in changed {
        hasher.update(name.as_bytes()).update(&[0]);
        hasher.update(text.as_bytes()).update(&[0]);
    }
    let hash = hasher.finalize().to_hex();
    Ok(format!("{own} with the shaders {}", &hash[..12]))
}

impl FilmInput {
    fn of(file: &SceneFile) -> Result<Self, FilmError> {
        let name = file.path.file_name().unwrap_or_default();
        Ok(Self {
            key: file.key.to_owned(),
            file: name.to_string_lossy().into_owned(),
            blake3: checksum_of(&file.path)?,
        })
    }

    /// Its name and key, for a message: they may come from a page that another program has changed.
    fn shown(&self) -> String {
        format!("{} ({})", shown(&self.file), shown(&self.key))
    }
}

/// How the files of two films differ, in words. Files of one name in different folders are distinguished by their order.
fn input_differences(now: &[FilmInput], before: &[FilmInput]) -> Vec<String> {
    let (now, before) = (numbered(now), numbered(before));
    let only_in = |some: &Numbered<'_>, others: &Numbered<'_>| {
        let others = others.clone();
        let missing = some.iter().filter(|(name, _)| !others.contains_key(*name));
        missing.map(|(_, input)| input.shown()).collect::<Vec<_>>()
    };
    let both = now
        .iter()
        .filter_map(|(name, input)| Some((input, before.get(name)?)));
    let changed = both.filter(|(now, before)| now.blake3 != before.blake3);
    let kinds = [
        ("changed", changed.map(|(input, _)| input.shown()).collect()),
        ("new", only_in(&now, &before)),
        ("missing", only_in(&before, &now)),
    ];
    let reported = kinds.into_iter().filter(|(_, names)| !names.is_empty());
    reported
        .map(|(how, names)| file_words(how, &names))
        .collect()
}

/// Files by their keys, their names and their numbers among those that are alike in both.
type Numbered<'i> = BTreeMap<(&'i str, &'i str, usize), &'i FilmInput>;

fn numbered(inputs: &[FilmInput]) -> Numbered<'_> {
    let mut numbered = BTreeMap::new();
    for input in inputs {
        let alike = (1..).map(|n| (&*input.key, &*input.file, n));
        let free = alike.into_iter().find(|name| !numbered.contains_key(name));
        numbered.extend(free.map(|name| (name, input)));
    }
    numbered
}

fn file_words(how: &str, names: &[String]) -> String {
    let named = names[..names.len().min(MOST_NAMED)].join(", ");
    match names.len().saturating_sub(MOST_NAMED) {
        0 => format!("{how} files: {named}"),
        more => format!("{how} files: {named} and {more} more"),
    }
}

/// A text of a page in a message: without control characters, and of bounded length.
fn shown(text: &str) -> String {
    let text: String = text.chars().take(NAME_CHARS).collect();
    text.escape_debug().to_string()
}

fn checksum_of(path: &Path) -> Result<String, FilmError> {
    let read = || {
        let mut hasher = blake3::Hasher::new();
        hasher.update_reader(files::open(path)?)?;
        Ok(hasher.finalize().to_hex().to_string())
    };
    read().map_err(|source| FilmError::Input {
        path: path.to_owned(),
        source,
    })
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
        let elements = include_str!("../../../../config/orbits/iss.tle");
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
        let changed = words((64, 36));
        assert_eq!(changed, "changed files: a.tle (orbit.file)");
        let later = FilmKey {
            start_utc: "2030-01-01T00:00:00.000Z".into(),
            ..key((64, 36))
        };
        let moved = later.differences(&key((64, 36))).expect("another");
        assert_eq!(
            moved,
            "it begins at 2018-01-15T12:00:00.000Z, this at 2030-01-01T00:00:00.000Z (--start 2018-01-15T12:00:00.000Z continues with it)"
        );
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

    fn input(file: &str, blake3: &str) -> FilmInput {
        FilmInput {
            key: "earth.cloud_maps".into(),
            file: file.into(),
            blake3: blake3.into(),
        }
    }

    /// Two folders have a file of one name each: their order distinguishes them.
    #[test]
    fn files_of_one_name_are_not_exchanged() {
        let before = [input("x.png", "1"), input("x.png", "2")];
        let now = [input("x.png", "2"), input("x.png", "1")];
        assert!(input_differences(&before, &before).is_empty());
        let words = input_differences(&now, &before);
        assert_eq!(
            words,
            ["changed files: x.png (earth.cloud_maps), x.png (earth.cloud_maps)"]
        );
    }

    #[test]
    fn new_and_missing_files_are_named_and_many_are_counted() {
        let many: Vec<_> = (0..7)
            .map(|n| input(&format!("{n}\u{1b}.png"), "1"))
            .collect();
        let words = input_differences(&many, &[input("a", "1")]);
        assert_eq!(words.len(), 2, "{words:?}");
        assert!(words[0].starts_with("new files: 0\\u{1b}.png (earth.cloud_maps), "));
        assert!(words[0].ends_with("4\\u{1b}.png (earth.cloud_maps) and 2 more"));
        assert_eq!(words[1], "missing files: a (earth.cloud_maps)");
        let long = input_differences(&[], &[input(&"a".repeat(10_000), "1")]);
        assert!(long[0].len() < 200, "{long:?}");
    }

    #[test]
    fn what_is_no_regular_file_is_not_waited_for() {
        let root = tempfile::tempdir().expect("a folder");
        let error = checksum_of(root.path()).expect_err("a folder");
        assert!(error.to_string().contains("not a file"), "{error}");
    }
}
