//! Runs the commands of recordings and stores their results.

use super::printed::figures;
use super::record::{FIGURES, FOLDER, written};
use super::recordings::{Figures, Found, RECORDINGS, Recording, Source};
use super::whereabouts;
use crate::cargo;
use crate::process::{ChildFailed, run, say};
use anyhow::{Context, bail};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Measures the recordings with these names, or all without names. Writes each one as soon as it is complete.
pub fn all(root: &Path, names: &[String]) -> anyhow::Result<()> {
    let mut outputs = Outputs::default();
    for recording in wanted(names)? {
        if let Source::Kept { why } = recording.source {
            say(format_args!("{} is kept as it is: {why}", recording.name));
            continue;
        }
        let text = one(root, recording, &mut outputs)
            .with_context(|| format!("cannot measure {}", recording.name))?;
        let path = root.join(FOLDER).join(recording.file);
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
        say(format_args!("recorded {}", path.display()));
    }
    Ok(())
}

/// The recordings with these names; all without names.
fn wanted(names: &[String]) -> anyhow::Result<Vec<&'static Recording>> {
    let known = |name: &str| RECORDINGS.iter().find(|recording| recording.name == name);
    for name in names {
        match known(name).map(|recording| &recording.source) {
            Some(Source::Kept { why }) => bail!("{name} cannot be measured here: {why}"),
            Some(_) => {}
            None => {
                let all: Vec<_> = RECORDINGS.iter().map(|recording| recording.name).collect();
                bail!(
                    "there is no recording {name:?}; there are {}",
                    all.join(", ")
                );
            }
        }
    }
    Ok(RECORDINGS
        .iter()
        .filter(|recording| names.is_empty() || names.iter().any(|name| name == recording.name))
        .collect())
}

/// The text of a newly measured recording.
fn one(root: &Path, recording: &Recording, outputs: &mut Outputs) -> anyhow::Result<String> {
    let Source::Measured {
        method,
        draws,
        found,
    } = &recording.source
    else {
        bail!("it is kept as it is");
    };
    let (command, body) = match found {
        Found::Printed { command, what } => {
            let body = what.csv(&outputs.of(root, command)?)?;
            ((*command).to_owned(), body)
        }
        Found::Figures(sets) => {
            let mut writer = csv::Writer::from_writer(Vec::new());
            writer.write_record(FIGURES)?;
            for Figures { command, lines } in *sets {
                for (name, value) in figures(lines, &outputs.of(root, command)?)? {
                    writer.write_record([&*name, &*value, command])?;
                }
            }
            let body = String::from_utf8(writer.into_inner()?)?;
            ("the command of each line".to_owned(), body)
        }
        Found::Written { command, file } => {
            let out = root.join("target/numbers").join(recording.name);
            fs::create_dir_all(&out).with_context(|| format!("cannot make {}", out.display()))?;
            let out_text = out.to_string_lossy();
            let (program, arguments) = program(command)?;
            let arguments = arguments
                .iter()
                .map(|argument| argument.replace("{out}", &out_text));
            run(Command::new(program).args(arguments).current_dir(root))?;
            let file = out.join(file);
            let body = fs::read_to_string(&file)
                .with_context(|| format!("cannot read {}", file.display()))?;
            (command.replace("{out}", "OUT"), body)
        }
    };
    let (adapter, driver) = match draws {
        true => whereabouts::adapter(&terrella()?)?,
        false => ("none".to_owned(), "none".to_owned()),
    };
    let mut head = vec![
        ("method", (*method).to_owned()),
        ("command", command),
        ("adapter", adapter),
        ("driver", driver),
    ];
    head.extend(whereabouts::of_this_run());
    written(recording.file, &head, &body)
}

/// Cached outputs of commands that several recordings use.
#[derive(Default)]
struct Outputs(BTreeMap<&'static str, String>);

impl Outputs {
    /// The output of a command, which runs only once.
    fn of(&mut self, root: &Path, command: &'static str) -> anyhow::Result<String> {
        if let Some(output) = self.0.get(command) {
            return Ok(output.clone());
        }
        let output = output_of(root, command)?;
        self.0.insert(command, output.clone());
        Ok(output)
    }
}

/// The output of a command.
fn output_of(root: &Path, command: &str) -> anyhow::Result<String> {
    say(command);
    let (program, arguments) = program(command)?;
    let mut started = Command::new(program);
    started.args(arguments).current_dir(root);
    let output = started.stderr(Stdio::inherit()).output();
    let output = output.with_context(|| format!("cannot start `{command}`"))?;
    if !output.status.success() {
        return Err(ChildFailed::new(command, output.status).into());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The program and the arguments of a command.
fn program(command: &str) -> anyhow::Result<(PathBuf, Vec<&str>)> {
    let mut words = command.split_whitespace();
    let program = match words.next() {
        Some("cargo") => cargo::cargo().get_program().into(),
        Some("terrella") => terrella()?,
        _ => bail!("`{command}` begins neither with `cargo` nor with `terrella`"),
    };
    Ok((program, words.collect()))
}

/// The program, built for release.
fn terrella() -> anyhow::Result<PathBuf> {
    let built = cargo::build(&["build", "--release", "--locked", "--bin", "terrella"])?.terrella;
    built.context("cargo built no `terrella`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_choose_recordings() {
        let all = wanted(&[]).unwrap();
        assert_eq!(all.len(), RECORDINGS.len());
        let one = wanted(&["orbits".to_owned()]).unwrap();
        assert_eq!(one.iter().map(|r| r.name).collect::<Vec<_>>(), ["orbits"]);
        let error = wanted(&["orbit".to_owned()]).err().unwrap().to_string();
        assert!(error.contains("orbits"), "{error}");
    }

    #[test]
    fn commands_begin_with_a_program_that_is_built_here() {
        for recording in RECORDINGS {
            let commands = match &recording.source {
                Source::Measured { found, .. } => match found {
                    Found::Printed { command, .. } | Found::Written { command, .. } => {
                        vec![*command]
                    }
                    Found::Figures(sets) => sets.iter().map(|set| set.command).collect(),
                },
                Source::Kept { .. } => Vec::new(),
            };
            for command in commands {
                let is_ours = command.starts_with("cargo ") || command.starts_with("terrella ");
                assert!(is_ours, "{}: {command}", recording.name);
            }
        }
    }
}
