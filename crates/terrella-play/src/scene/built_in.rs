//! Scenes without a scene file: the built-in scene, and the one used with an orbit file.

use super::choices::OrbitSource;
use super::error::SceneError;
use super::field::written;
use super::orbit::Orbit;
use super::orbit_check::ONLY_OF_FILE;
use super::record::quoted;
use super::{Scene, Setting, StartSource};
use std::io::Read;
use std::path::Path;
use terrella_files as files;
use terrella_orbit::FileFormat;

/// The built-in scene.
const SHIPPED: &str = terrella::internals::shipped::ISS;
/// Its name in messages.
const SHIPPED_NAME: &str = "config/iss.toml (built in)";
/// Its keys about the elements file. The elements of that file are built in.
const FILE_KEYS: &[(&str, &str)] = &[("orbit", "file"), ("orbit", "name"), ("orbit", "strict")];
/// The keys above, and those that apply only to that satellite.
const OWN_KEYS: &[(&str, &str)] = &[
    ("orbit", "source"),
    ("orbit", "file"),
    ("orbit", "name"),
    ("orbit", "strict"),
    ("time", "start"),
    ("camera", "follow"),
];
/// Bytes of a file that are inspected to recognise its format.
const HEAD_BYTES: u64 = 64 << 10;

impl Scene {
    /// The built-in scene, `config/iss.toml`, which needs no other file.
    ///
    /// # Errors
    /// None if that file is as released.
    pub fn shipped() -> Result<Self, SceneError> {
        Self::shipped_with(&[])
    }

    /// The built-in scene with settings applied.
    ///
    /// # Errors
    /// Settings that [`Self::from_toml_with`] rejects.
    pub fn shipped_with(settings: &[Setting]) -> Result<Self, SceneError> {
        let text = without(SHIPPED, FILE_KEYS);
        let mut scene = Self::from_toml_with(&text, Path::new(SHIPPED_NAME), settings)?;
        scene.text.get_or_insert(text);
        Ok(scene)
    }

    /// The default scene for Basilisk simulations, `config/basilisk.toml`.
    ///
    /// # Errors
    /// None if that file is as released.
    pub fn of_simulations() -> Result<Self, SceneError> {
        Self::of_simulations_with(&[])
    }

    /// The default simulation scene with settings applied.
    ///
    /// # Errors
    /// Settings that [`Self::from_toml_with`] rejects.
    pub fn of_simulations_with(settings: &[Setting]) -> Result<Self, SceneError> {
        Self::from_toml_with(
            terrella::internals::shipped::BASILISK,
            Path::new("basilisk.toml"),
            settings,
        )
    }

    /// A scene with satellites of an orbit file, each given by name or catalogue number, or with the file's only one. They fly as the space station
    /// does in [`Self::shipped`], from the first satellite's own time on.
    ///
    /// # Errors
    /// None if the built-in scene is as released: the file is read when its satellites are opened.
    pub fn of_orbits(
        path: &Path,
        format: FileFormat,
        names: &[String],
    ) -> Result<Self, SceneError> {
        Self::of_orbits_with(path, format, names, &[])
    }

    fn of_orbits_with(
        path: &Path,
        format: FileFormat,
        names: &[String],
        settings: &[Setting],
    ) -> Result<Self, SceneError> {
        let text = without(SHIPPED, OWN_KEYS);
        let mut scene = Self::from_toml_with(&text, path, settings)?;
        let text = scene.text.take().unwrap_or(text);
        let track = scene.orbits.first().map(|orbit| orbit.track);
        let satellite = |name: Option<&String>| Orbit {
            source: OrbitSource::of(format),
            file: Some(path.to_owned()),
            name: name.cloned(),
            track: track.unwrap_or_default(),
            ..Orbit::built_in()
        };
        scene.orbits = match names {
            [] => vec![satellite(None)],
            names => names.iter().map(|name| satellite(Some(name))).collect(),
        };
        // The file's lines are not lines of the scene.
        for record in scene.records.values_mut().chain(&mut scene.orbit_records) {
            record.forget_lines();
        }
        let record = scene.orbit_records.first().cloned().unwrap_or_default();
        let record_of = |orbit: &Orbit| {
            let mut record = record.clone();
            record.set("source", quoted(&written(&orbit.source)));
            record.set("file", quoted(&path.display().to_string()));
            record.set("strict", Ok(orbit.strict.to_string()));
            record.set(
                "name",
                match &orbit.name {
                    Some(name) => quoted(name),
                    None => Err(ONLY_OF_FILE),
                },
            );
            record
        };
        scene.orbit_records = scene.orbits.iter().map(record_of).collect();
        if !scene.is_set("time", "start") {
            scene.time.start_from = StartSource::Default;
        }
        scene.text = Some(format!("{text}\n# {format:?} {names:?}\n"));
        Ok(scene)
    }

    /// Reads a scene file or an orbit file ([`Self::of_orbits`]). Files with the extension `.toml` are scenes. For others the text
    /// decides, or else the extension. `names` are the satellites of an orbit file.
    ///
    /// # Errors
    /// As [`Self::load`]; a file that is neither.
    pub fn load_or_orbits(path: &Path, names: &[String]) -> Result<Self, SceneError> {
        Self::load_or_orbits_with(path, names, &[])
    }

    /// The same with settings that replace the file's keys, or the keys used with an orbit file.
    ///
    /// # Errors
    /// As [`Self::load_or_orbits`]; errors of a setting name `--set` instead of the file.
    pub fn load_or_orbits_with(
        path: &Path,
        names: &[String],
        settings: &[Setting],
    ) -> Result<Self, SceneError> {
        if is_named_scene(path) {
            return Self::load_with(path, settings);
        }
        match recognise(path) {
            Some(format) => Self::of_orbits_with(path, format, names, settings),
            None if is_empty(path) => Err(SceneError::Empty {
                path: path.to_owned(),
            }),
            None => Self::load_with(path, settings).map_err(neither),
        }
    }

    /// Whether an orbit file is used in place of a scene file.
    pub fn is_of_orbits(&self) -> bool {
        let is_file = |orbit: &Orbit| orbit.file.as_ref() == Some(&self.path);
        self.orbits.iter().any(is_file)
    }
}

fn is_named_scene(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
}

/// Whether a file has no byte: a download that failed.
fn is_empty(path: &Path) -> bool {
    let head = files::open(path).and_then(files::first_bytes);
    head.is_ok_and(|bytes| bytes.is_empty())
}

/// The orbit format of a file. A pipe is not inspected, because its data can be read only once.
fn recognise(path: &Path) -> Option<FileFormat> {
    let mut head = Vec::new();
    let file = files::open(path).ok()?;
    file.take(HEAD_BYTES).read_to_end(&mut head).ok()?;
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    // The ephemeris reader reports the type of such a message and the remedy.
    let unread = || FileFormat::is_unread_message(&head).then_some(FileFormat::Oem);
    FileFormat::of_bytes(&head)
        .or_else(unread)
        .or_else(|| FileFormat::of_ending(&ending))
}

/// The error for a file that is not a scene and whose name does not suggest one.
fn neither(error: SceneError) -> SceneError {
    match error {
        SceneError::NotUtf8 { .. }
        | SceneError::TooLarge { .. }
        | SceneError::Syntax { .. }
        | SceneError::Unknown { .. } => SceneError::Neither {
            scene: Box::new(error),
        },
        error => error,
    }
}

/// A scene's text with empty lines in place of some one-line keys.
fn without(text: &str, keys: &[(&str, &str)]) -> String {
    let mut table = "";
    let lines = text.lines().map(|line| {
        if let Some(name) = line.strip_prefix('[') {
            table = name.trim_end().trim_matches(['[', ']']);
        }
        let key = line.split('=').next().unwrap_or_default().trim();
        match keys.contains(&(table, key)) {
            true => "",
            false => line,
        }
    });
    lines.fold(String::new(), |text, line| text + line + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella_orbit::Sgp4Feed;

    /// The built-in scene cannot drift from the file: except for the location of the elements, both are equal.
    #[test]
    fn the_built_in_scene_is_the_one_of_the_file() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/iss.toml");
        let file = Scene::load(&path).expect("a good scene");
        let mut shipped = Scene::shipped().expect("a good scene");
        let [theirs] = file.orbits.as_slice() else {
            panic!("one satellite");
        };
        let elements = theirs.file.as_ref().expect("a file");
        let theirs = Sgp4Feed::from_file(elements, theirs.name.as_deref()).expect("elements");
        let ours = Sgp4Feed::built_in_iss().expect("elements");
        assert_eq!(theirs.elements(), ours.elements());
        assert!(shipped.orbits.iter().all(Orbit::is_built_in));
        shipped.orbits.clone_from(&file.orbits);
        let reported = |scene: &Scene| {
            let summary = scene.full_summary();
            let lines = summary.lines().skip(1);
            let lines = lines.filter(|line| {
                !["file", "name", "strict"]
                    .contains(&line.split_whitespace().next().unwrap_or_default())
            });
            lines.map(|line| line.to_owned() + "\n").collect::<String>()
        };
        assert_eq!(reported(&shipped), reported(&file));
    }

    #[test]
    fn satellites_of_a_file_are_recorded_each_by_its_name() {
        let names = ["A", "B"].map(str::to_owned);
        let scene = Scene::of_orbits(Path::new("two.oem"), FileFormat::Oem, &names);
        let mut scene = scene.expect("a good scene");
        for strict in ["false", "true"] {
            let summary = scene.summary();
            for value in ["\"oem\"", "\"two.oem\"", "\"A\"", "\"B\""] {
                assert!(
                    summary.contains(&format!(" {value} ")),
                    "{value}: {summary}"
                );
            }
            let is_strict =
                |line: &&str| line.starts_with(&format!("  strict             {strict} "));
            // Once in [earth] and once per satellite.
            let count = summary.lines().filter(is_strict).count();
            assert_eq!(count, if strict == "true" { 2 } else { 3 }, "{summary}");
            scene.read_strictly();
        }
    }

    #[test]
    fn keys_are_left_out_of_their_own_table_alone() {
        let text = "[time]\nstart = 1\nfile = 2\n[orbit]\n# file = 3\nfile = 4\nfiles = 5\n";
        let left = without(text, &[("orbit", "file"), ("time", "start")]);
        assert_eq!(
            left,
            "[time]\n\nfile = 2\n[orbit]\n# file = 3\n\nfiles = 5\n"
        );
    }
}
