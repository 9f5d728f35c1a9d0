//! Calls to cargo.

use crate::process::{ChildFailed, repository_root, say, shown};
use anyhow::{Context, bail};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// The cargo that runs us, in the repository's root.
pub fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(repository_root());
    command
}

/// Runs a building cargo command and gives the `terrella` executable that it made; `None` where its arguments made none.
pub fn build(arguments: &[&str]) -> anyhow::Result<Option<PathBuf>> {
    let mut command = cargo();
    command.args(arguments);
    let what = shown(&command);
    say(&what);
    // Asked of cargo itself: the folder depends on the profile, the target and the user's configuration.
    let mut child = command
        .arg("--message-format=json-render-diagnostics")
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot start `{what}`"))?;
    let mut executable = None;
    if let Some(stdout) = child.stdout.take() {
        for line in BufReader::new(stdout).lines() {
            let line = line.with_context(|| format!("cannot read the output of `{what}`"))?;
            executable = executable_in(&line).or(executable);
        }
    }
    let status = child.wait()?;
    if !status.success() {
        return Err(ChildFailed::new(what, status).into());
    }
    Ok(executable)
}

/// The output of a cargo command that only tells.
pub fn output(arguments: &[&str]) -> anyhow::Result<String> {
    let mut command = cargo();
    command.args(arguments).stderr(Stdio::inherit());
    let what = shown(&command);
    let output = command
        .output()
        .with_context(|| format!("cannot start `{what}`"))?;
    if !output.status.success() {
        return Err(ChildFailed::new(what, output.status).into());
    }
    match String::from_utf8(output.stdout) {
        Ok(text) => Ok(text),
        Err(_) => bail!("`{what}` wrote something that is not UTF-8"),
    }
}

/// The path in one of cargo's messages, if it is about the `terrella` program (not about its unit tests).
fn executable_in(line: &str) -> Option<PathBuf> {
    let message: Value = serde_json::from_str(line).ok()?;
    let target = message.get("target")?;
    let is_program = message.get("reason")? == "compiler-artifact"
        && target.get("name")? == "terrella"
        && target.get("kind")?.as_array()?.iter().any(|k| k == "bin")
        && message.get("profile")?.get("test")? == false;
    let path = message.get("executable")?.as_str()?;
    is_program.then(|| PathBuf::from(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(kind: &str, test: bool, executable: &str) -> String {
        format!(
            r#"{{"reason":"compiler-artifact","target":{{"kind":["{kind}"],"name":"terrella"}},"profile":{{"test":{test}}},"executable":{executable}}}"#
        )
    }

    #[test]
    fn only_the_program_itself_is_taken() {
        let path = r#""/t/debug/terrella""#;
        assert_eq!(
            executable_in(&message("bin", false, path)),
            Some(PathBuf::from("/t/debug/terrella"))
        );
        assert_eq!(executable_in(&message("bin", true, path)), None);
        assert_eq!(executable_in(&message("lib", false, path)), None);
        assert_eq!(executable_in(&message("bin", false, "null")), None);
        assert_eq!(executable_in("running 3 tests"), None);
        assert_eq!(
            executable_in(r#"{"reason":"build-finished","success":true}"#),
            None
        );
    }
}
