//! Runs other programs: prints one line for each, and passes exit codes on.

use anyhow::Context;
use std::fmt;
use std::path::PathBuf;
use std::process::{Command, ExitCode, ExitStatus};

/// The folder that holds the workspace's `Cargo.toml`.
pub fn repository_root() -> PathBuf {
    // Cargo gives the package's path at run time; the path at compile time may be out of date.
    let package = std::env::var_os("CARGO_MANIFEST_DIR")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    match package.parent() {
        Some(root) => root.to_path_buf(),
        None => package,
    }
}

/// Prints one step on one line.
pub fn say(line: impl fmt::Display) {
    println!("xtask: {line}");
}

/// A program that failed. Its exit code becomes ours.
#[derive(Debug)]
pub struct ChildFailed {
    what: String,
    status: ExitStatus,
}

impl ChildFailed {
    pub fn new(what: impl Into<String>, status: ExitStatus) -> Self {
        Self {
            what: what.into(),
            status,
        }
    }

    fn code(&self) -> u8 {
        #[cfg(unix)]
        if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&self.status) {
            // The shells' convention for a program that a signal killed.
            return u8::try_from(128 + signal).unwrap_or(1);
        }
        // A code above 255 exists on Windows only.
        self.status
            .code()
            .and_then(|code| u8::try_from(code).ok())
            .filter(|code| *code != 0)
            .unwrap_or(1)
    }
}

impl fmt::Display for ChildFailed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` failed ({})", self.what, self.status)
    }
}

impl std::error::Error for ChildFailed {}

/// The exit code for an error: the failed program's own, else 1.
pub fn exit_code(error: &anyhow::Error) -> ExitCode {
    match error.downcast_ref::<ChildFailed>() {
        Some(child) => ExitCode::from(child.code()),
        None => ExitCode::FAILURE,
    }
}

/// A command as a person would type it.
pub fn shown(command: &Command) -> String {
    std::iter::once(command.get_program())
        .chain(command.get_args())
        .map(|word| {
            let word = word.to_string_lossy();
            if word.is_empty() || word.contains(char::is_whitespace) {
                format!("'{word}'")
            } else {
                word.into_owned()
            }
        })
        .collect::<Vec<_>>()
        .join(" ")
}

/// Prints the command, runs it with our own input and output, and returns its failure.
pub fn run(command: &mut Command) -> anyhow::Result<()> {
    let what = shown(command);
    say(&what);
    let status = without_session_errors(command)
        .status()
        .with_context(|| format!("cannot start `{what}`"))?;
    if status.success() {
        Ok(())
    } else {
        Err(ChildFailed::new(what, status).into())
    }
}

/// Prevents an error message of the Wayland library without a session: Mesa looks for a session whenever a program opens Vulkan, and a folder
/// without one is enough.
pub fn without_session_errors(command: &mut Command) -> &mut Command {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        command.env("XDG_RUNTIME_DIR", std::env::temp_dir());
    }
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_holds_the_workspace() {
        let text = std::fs::read_to_string(repository_root().join("Cargo.toml")).unwrap();
        assert!(text.contains("[workspace]"));
    }

    #[test]
    fn a_command_is_shown_as_typed() {
        let mut command = Command::new("cargo");
        command.args(["test", "two words"]);
        assert_eq!(shown(&command), "cargo test 'two words'");
    }

    #[cfg(unix)]
    #[test]
    fn exit_codes_are_passed_on() {
        for (script, expected) in [("exit 2", 2), ("exit 101", 101), ("kill -KILL $$", 137)] {
            let error = run(Command::new("sh").args(["-c", script])).unwrap_err();
            assert_eq!(exit_code(&error), ExitCode::from(expected), "{script}");
            // Added context must not lose the code.
            let wrapped = error.context("while testing");
            assert_eq!(exit_code(&wrapped), ExitCode::from(expected), "{script}");
        }
        assert_eq!(exit_code(&anyhow::anyhow!("other")), ExitCode::FAILURE);
        run(Command::new("sh").args(["-c", "exit 0"])).unwrap();
    }

    #[test]
    fn a_missing_program_is_named() {
        let error = run(&mut Command::new("no-such-program-here")).unwrap_err();
        assert!(format!("{error:#}").contains("no-such-program-here"));
    }
}
