//! Runs test programs in parallel: cargo runs them one after another, and each leaves CPU cores idle at its end and while it waits for child
//! programs.

use crate::cargo::TestProgram;
use crate::process::{ChildFailed, say, without_session_errors};
use anyhow::{Context, bail};
use std::process::{Command, Output};
use std::sync::Mutex;
use std::time::Instant;

/// The slowest programs, slowest first, so that none runs alone at the end.
const LONGEST: [&str; 6] = [
    "command",
    "render",
    "python",
    "terrella_pack",
    "accuracy",
    "terrella_ground",
];

/// Runs all programs, as many at a time as there are CPU cores. Prints the output of those that fail, and the last line of those that pass.
///
/// # Errors
/// Names every failed program.
pub fn run(mut programs: Vec<TestProgram>) -> anyhow::Result<()> {
    if programs.is_empty() {
        bail!("cargo built no tests");
    }
    let place = |program: &TestProgram| LONGEST.iter().position(|name| *name == program.name);
    programs.sort_by_key(|program| place(program).unwrap_or(LONGEST.len()));
    let at_once = std::thread::available_parallelism().map_or(1, usize::from);
    let count = programs.len();
    say(format_args!(
        "{count} programs of tests, {at_once} at a time"
    ));
    let waiting = Mutex::new(programs.into_iter());
    let failed = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..at_once {
            scope.spawn(|| {
                while let Some(program) = next(&waiting) {
                    if let Err(error) = run_one(&program) {
                        let mut failed = failed.lock().unwrap_or_else(|error| error.into_inner());
                        failed.push(error);
                    }
                }
            });
        }
    });
    let mut failed = failed
        .into_inner()
        .unwrap_or_else(|error| error.into_inner());
    match failed.pop() {
        None => Ok(()),
        Some(last) => {
            let others: Vec<_> = failed.iter().map(|error| format!("{error:#}")).collect();
            Err(match others.is_empty() {
                true => last,
                false => last.context(format!("failed too: {}", others.join("; "))),
            })
        }
    }
}

fn next(waiting: &Mutex<std::vec::IntoIter<TestProgram>>) -> Option<TestProgram> {
    waiting
        .lock()
        .unwrap_or_else(|error| error.into_inner())
        .next()
}

fn run_one(program: &TestProgram) -> anyhow::Result<()> {
    let mut command = Command::new(&program.executable);
    // Like cargo.
    command
        .current_dir(&program.package)
        .env("CARGO_MANIFEST_DIR", &program.package);
    if let Some(cargo) = std::env::var_os("CARGO") {
        command.env("CARGO", cargo);
    }
    let begun = Instant::now();
    let output = without_session_errors(&mut command)
        .output()
        .with_context(|| format!("cannot start {}", program.executable.display()))?;
    say(format_args!(
        "{}, {:.0} s",
        summary(program, &output),
        begun.elapsed().as_secs_f64()
    ));
    match output.status.success() {
        true => Ok(()),
        false => Err(ChildFailed::new(&program.name, output.status).into()),
    }
}

/// The whole output of a failed program; otherwise its result and its skipped tests.
fn summary(program: &TestProgram, output: &Output) -> String {
    let stdout = String::from_utf8_lossy(&output.stdout);
    let stderr = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        return format!("{}:\n{stdout}\n{stderr}\n{}", program.name, program.name);
    }
    let skipped = stderr.lines().chain(stdout.lines());
    let skipped: String = skipped
        .filter(|line| line.contains("SKIPPED"))
        .map(|line| format!("{}: {line}\nxtask: ", program.name))
        .collect();
    let results: Vec<_> = stdout
        .lines()
        .filter(|line| line.starts_with("test result"))
        .collect();
    format!("{skipped}{}: {}", program.name, results.join(" "))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;
    use std::path::Path;

    fn program(folder: &Path, name: &str, script: &str) -> TestProgram {
        let executable = folder.join(name);
        std::fs::write(&executable, format!("#!/bin/sh\n{script}\n")).unwrap();
        std::fs::set_permissions(&executable, std::fs::Permissions::from_mode(0o755)).unwrap();
        TestProgram {
            name: name.to_owned(),
            package: folder.to_path_buf(),
            executable,
        }
    }

    #[test]
    fn every_program_runs_in_its_package() {
        let folder = tempfile::tempdir().unwrap();
        let note = "pwd > ran_$(basename $0); test \"$CARGO_MANIFEST_DIR\" = \"$(pwd)\"";
        let names = ["a", "b", "c", "d", "e"];
        let programs = names.map(|name| program(folder.path(), name, note));
        run(programs.into()).unwrap();
        for name in names {
            assert!(folder.path().join(format!("ran_{name}")).exists(), "{name}");
        }
    }

    #[test]
    fn the_others_run_after_a_failure_which_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let programs = vec![
            program(folder.path(), "bad", "exit 101"),
            program(folder.path(), "worse", "exit 101"),
            program(folder.path(), "good", "touch good_ran"),
        ];
        let error = format!("{:#}", run(programs).unwrap_err());
        assert!(error.contains("bad") && error.contains("worse"), "{error}");
        assert!(folder.path().join("good_ran").exists());
        assert!(run(Vec::new()).is_err());
    }

    #[test]
    fn skipped_tests_are_passed_on() {
        let folder = tempfile::tempdir().unwrap();
        let script = "echo 'SKIPPED: no display' >&2; echo 'test result: ok. 3 passed'";
        let program = program(folder.path(), "a", script);
        let output = Command::new(&program.executable).output().unwrap();
        let summary = summary(&program, &output);
        assert!(
            summary.contains("a: SKIPPED: no display")
                && summary.ends_with("a: test result: ok. 3 passed"),
            "{summary}"
        );
    }
}
