//! `cargo xtask corpus`: passes every file of a folder to the program as a user would, and reports each outcome. By hand: the files come from the
//! field and are in no repository.

use crate::cargo;
use crate::process::{repository_root, say};
use anyhow::{Context, bail};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Limit on files, so that a wrong folder is noticed.
const MOST_FILES: usize = 20_000;

/// Interval between checks of a child process.
const STEP: Duration = Duration::from_millis(20);

/// Longest message in the table, characters.
const MOST_MESSAGE: usize = 240;

/// Limit on the kept standard error of a child process, bytes.
const MOST_ERROR_BYTES: u64 = 1 << 20;

/// File name extensions of orbits, elevation and maps.
const ORBITS: [&str; 14] = [
    "tle", "3le", "txt", "omm", "opm", "oem", "ocm", "kvn", "xml", "json", "csv", "czml", "sp3",
    "e",
];
const ELEVATION: [&str; 12] = [
    "tif", "tiff", "vrt", "nc", "grd", "hgt", "gz", "zip", "asc", "dt0", "dt1", "dt2",
];
const MAPS: [&str; 9] = [
    "tif", "tiff", "vrt", "png", "jpg", "jpeg", "webp", "mbtiles", "pmtiles",
];

/// Limits of a child process.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub seconds: u64,
    pub memory_mb: u64,
}

/// Outcome of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    Accepted,
    Rejected,
    TimedOut,
    WrongExit,
    Panicked,
}

impl Outcome {
    fn name(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::Rejected => "rejected",
            Self::TimedOut => "timed out",
            Self::WrongExit => "wrong exit",
            Self::Panicked => "panicked",
        }
    }

    /// Classifies a child's exit status and standard error. A rejection is exit code 1 or 2 with a message.
    fn of(status: Option<ExitStatus>, error: &str) -> Self {
        let Some(status) = status else {
            return Self::TimedOut;
        };
        if status.code() == Some(101) || error.contains("panicked at") {
            return Self::Panicked;
        }
        match status.code() {
            Some(0) => Self::Accepted,
            Some(1 | 2) if !message(error).is_empty() => Self::Rejected,
            _ => Self::WrongExit,
        }
    }

    /// Whether the fault is the program's, not the file's.
    fn is_fault(self) -> bool {
        matches!(self, Self::WrongExit | Self::Panicked | Self::TimedOut)
    }
}

/// The error message on one line; for a panic, its location.
fn message(error: &str) -> String {
    let mut lines = error.lines().map(str::trim).filter(|line| !line.is_empty());
    let found = lines.clone().find(|line| line.contains("panicked at"));
    let found = found.or_else(|| lines.clone().find(|line| line.starts_with("error")));
    let line = found.or_else(|| lines.next_back()).unwrap_or_default();
    let line = line.trim_start_matches("error:").trim();
    let shown: String = line.chars().take(MOST_MESSAGE).collect();
    match line.chars().count() > MOST_MESSAGE {
        true => format!("{shown}…"),
        false => shown,
    }
}

/// A row of the table.
#[derive(Clone, Debug)]
struct Row {
    file: String,
    reader: &'static str,
    outcome: Outcome,
    seconds: f64,
    message: String,
}

/// The table, worst first, and the count of each outcome.
fn table(mut rows: Vec<Row>) -> String {
    rows.sort_by(|a, b| (b.outcome, &a.file, a.reader).cmp(&(a.outcome, &b.file, b.reader)));
    let mut text =
        "| file | given to | outcome | s | message |\n|---|---|---|---|---|\n".to_string();
    for row in &rows {
        let cell = |text: &str| text.replace('|', "\\|").replace('\n', " ");
        text += &format!(
            "| {} | {} | {} | {:.1} | {} |\n",
            cell(&row.file),
            row.reader,
            row.outcome.name(),
            row.seconds,
            cell(&row.message)
        );
    }
    let all = [
        Outcome::Accepted,
        Outcome::Rejected,
        Outcome::TimedOut,
        Outcome::WrongExit,
        Outcome::Panicked,
    ];
    let counts = all.map(|outcome| {
        let count = rows.iter().filter(|row| row.outcome == outcome).count();
        format!("{count} {}", outcome.name())
    });
    text + "\n" + &counts.join(", ") + "\n"
}

/// The readers for a file, with the arguments of each. `scratch` is a temporary folder that contains `day.png`.
fn readers(file: &Path, scratch: &Path) -> Vec<(&'static str, Vec<PathBuf>)> {
    let ending = file.extension().unwrap_or_default().to_string_lossy();
    let ending = ending.to_ascii_lowercase();
    let is_of = |known: &[&str]| known.contains(&ending.as_str());
    let words = |words: &[&str]| words.iter().map(PathBuf::from).collect::<Vec<_>>();
    let pack = |day: &Path, more: &[PathBuf]| {
        let mut arguments = words(&[
            "pack",
            "build",
            "--storage",
            "plain",
            "--pixels",
            "day=16",
            "-o",
        ]);
        arguments.push(scratch.join("pack"));
        arguments.extend([PathBuf::from("--day"), day.to_owned()]);
        arguments.extend_from_slice(more);
        arguments
    };
    let mut readers = Vec::new();
    if ending == "toml" || is_of(&ORBITS) {
        readers.push(("check", [words(&["check"]), vec![file.to_owned()]].concat()));
    }
    if is_of(&ORBITS) {
        let orbit = words(&["orbit", "--every", "600", "--csv"]);
        readers.push(("orbit", [orbit, vec![file.to_owned()]].concat()));
    }
    if is_of(&ELEVATION) {
        let heights = [PathBuf::from("--heights"), file.to_owned()];
        readers.push((
            "pack build --heights",
            pack(&scratch.join("day.png"), &heights),
        ));
    }
    if matches!(ending.as_str(), "asc" | "hgt" | "dt0" | "dt1" | "dt2") {
        let terrain = words(&["terrain", "--tolerances", "20", "--threads", "1"]);
        readers.push(("terrain", [terrain, vec![file.to_owned()]].concat()));
    }
    if is_of(&MAPS) {
        readers.push(("pack build --day", pack(file, &[])));
    }
    readers
}

/// Runs a child process until its end or its limit. Returns its exit status, unless it was killed, and its standard error.
fn child(
    program: &Path,
    arguments: &[PathBuf],
    scratch: &Path,
    limits: Limits,
) -> anyhow::Result<(Option<ExitStatus>, String)> {
    let mut command = match cfg!(unix) {
        true => {
            // The shell's limit also applies to the program that replaces it.
            let script = format!("ulimit -v {}; exec \"$0\" \"$@\"", limits.memory_mb * 1024);
            let mut command = Command::new("sh");
            command.args(["-c", &script]).arg(program);
            command
        }
        false => Command::new(program),
    };
    let error_file = scratch.join("stderr");
    let output = File::create(&error_file)?;
    command.args(arguments).current_dir(scratch);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(output);
    let mut child = command.spawn().context("cannot start the program")?;
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break Some(status);
        }
        if begun.elapsed() > Duration::from_secs(limits.seconds) {
            child.kill()?;
            child.wait()?;
            break None;
        }
        std::thread::sleep(STEP);
    };
    let mut error = Vec::new();
    File::open(&error_file)?
        .take(MOST_ERROR_BYTES)
        .read_to_end(&mut error)?;
    Ok((status, String::from_utf8_lossy(&error).into_owned()))
}

/// All files below a folder, sorted by name; links are not followed.
fn files(folder: &Path, found: &mut Vec<PathBuf>) -> anyhow::Result<()> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut paths: Vec<_> = entries
        .map(|entry| Ok(entry?.path()))
        .collect::<std::io::Result<_>>()?;
    paths.sort();
    for path in paths {
        let kind = path.symlink_metadata()?;
        if kind.is_dir() {
            files(&path, found)?;
        } else if kind.is_file() {
            found.push(path);
        }
        if found.len() > MOST_FILES {
            bail!("more than {MOST_FILES} files below {}", folder.display());
        }
    }
    Ok(())
}

/// Passes every file below a folder to the readers of its kind and prints each outcome.
///
/// # Errors
/// The build failed, a folder cannot be read, or the program panicked, ran too long or exited inconsistently for a file.
pub fn run(from: &Path, program: Option<PathBuf>, limits: Limits) -> anyhow::Result<()> {
    let from = from
        .canonicalize()
        .with_context(|| from.display().to_string())?;
    let program = match program {
        Some(program) => program
            .canonicalize()
            .with_context(|| program.display().to_string())?,
        None => {
            let mut build = cargo::cargo();
            build.args(["build", "--release", "--locked", "-p", "terrella-cli"]);
            crate::process::run(&mut build)?;
            repository_root().join("target/release/terrella")
        }
    };
    let mut found = Vec::new();
    files(&from, &mut found)?;
    let mut rows = Vec::new();
    for file in &found {
        let name = file
            .strip_prefix(&from)
            .unwrap_or(file)
            .display()
            .to_string();
        let count = readers(file, Path::new("")).len();
        for n in 0..count {
            // One folder per run: an existing pack would be resumed.
            let scratch = tempfile::tempdir()?;
            let day = image::RgbImage::from_pixel(512, 256, image::Rgb([90; 3]));
            day.save(scratch.path().join("day.png"))?;
            let (reader, arguments) = readers(file, scratch.path()).swap_remove(n);
            let begun = Instant::now();
            let (status, error) = child(&program, &arguments, scratch.path(), limits)?;
            rows.push(Row {
                file: name.clone(),
                reader,
                outcome: Outcome::of(status, &error),
                seconds: begun.elapsed().as_secs_f64(),
                message: match status.is_some_and(|status| status.success()) {
                    true => String::new(),
                    false => message(&error),
                },
            });
        }
        if count == 0 {
            say(format!("{name}: of no kind that is known by its name"));
        }
    }
    let faults = rows.iter().filter(|row| row.outcome.is_fault()).count();
    println!("{}", table(rows));
    match faults {
        0 => Ok(()),
        faults => bail!(
            "{faults} runs panicked, ran too long or ended otherwise than with exit code 0, 1 or 2"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    fn outcome(script: &str) -> (Outcome, String) {
        let scratch = tempfile::tempdir().unwrap();
        // Long enough for a busy machine, except for the case that never ends.
        let limits = Limits {
            seconds: if script.contains("sleep") { 1 } else { 60 },
            memory_mb: 500,
        };
        let arguments = ["-c", script].map(PathBuf::from);
        let (status, error) = child(Path::new("sh"), &arguments, scratch.path(), limits).unwrap();
        (Outcome::of(status, &error), message(&error))
    }

    #[cfg(unix)]
    #[test]
    fn each_end_is_distinguished_from_the_others() {
        let text = |text: &str| text.to_string();
        assert_eq!(outcome("true"), (Outcome::Accepted, text("")));
        let said = "echo 'WARN a' >&2; echo 'error: a.tif: is damaged' >&2; exit 1";
        assert_eq!(
            outcome(said),
            (Outcome::Rejected, text("a.tif: is damaged"))
        );
        // A rejection has a message.
        assert_eq!(outcome("exit 2"), (Outcome::WrongExit, text("")));
        assert_eq!(outcome("echo 'error: x' >&2; exit 7").0, Outcome::WrongExit);
        assert_eq!(outcome("kill -SEGV $$").0, Outcome::WrongExit);
        let panic =
            "echo \"thread 'main' panicked at src/a.rs:1:2:\" >&2; echo error: no >&2; exit 101";
        assert_eq!(outcome(panic).0, Outcome::Panicked);
        assert!(outcome(panic).1.contains("src/a.rs:1:2"));
        assert_eq!(outcome("exec sleep 30").0, Outcome::TimedOut);
    }

    #[cfg(unix)]
    #[test]
    fn memory_is_limited() {
        let reported = "test \"$(ulimit -v)\" = 512000 || exit 7";
        assert_eq!(outcome(reported).0, Outcome::Accepted);
    }

    #[test]
    fn the_table_has_the_worst_first() {
        let row = |file: &str, outcome, message: &str| Row {
            file: file.to_string(),
            reader: "check",
            outcome,
            seconds: 0.25,
            message: message.to_string(),
        };
        let rows = vec![
            row("b.tle", Outcome::Accepted, ""),
            row("c.tle", Outcome::Panicked, "panicked at a|b"),
            row("a.tle", Outcome::Rejected, "no\nelements"),
            row("a.oem", Outcome::Accepted, ""),
        ];
        assert_eq!(
            table(rows),
            "| file | given to | outcome | s | message |\n|---|---|---|---|---|\n\
             | c.tle | check | panicked | 0.2 | panicked at a\\|b |\n\
             | a.tle | check | rejected | 0.2 | no elements |\n\
             | a.oem | check | accepted | 0.2 |  |\n\
             | b.tle | check | accepted | 0.2 |  |\n\n\
             2 accepted, 1 rejected, 0 timed out, 0 wrong exit, 1 panicked\n"
        );
    }

    #[test]
    fn files_are_given_to_the_readers_of_their_kind() {
        let of = |name: &str| {
            let readers = readers(Path::new(name), Path::new("/scratch"));
            readers
                .into_iter()
                .map(|(reader, _)| reader)
                .collect::<Vec<_>>()
        };
        assert_eq!(of("a.TLE"), ["check", "orbit"]);
        assert_eq!(of("a.toml"), ["check"]);
        assert_eq!(of("a.tif"), ["pack build --heights", "pack build --day"]);
        assert_eq!(of("N45E006.hgt"), ["pack build --heights", "terrain"]);
        assert_eq!(of("a.pmtiles"), ["pack build --day"]);
        assert!(of("read.me").is_empty());
    }
}
