//! Calls to cargo.

use crate::process::{ChildFailed, repository_root, say, shown};
use anyhow::{Context, bail};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// The running cargo, started in the repository's root.
pub fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(repository_root());
    command
}

/// A test program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TestProgram {
    /// Name of the library, program or test file.
    pub name: String,
    /// Folder of its package, where cargo starts it.
    pub package: PathBuf,
    /// The program.
    pub executable: PathBuf,
}

/// Products of a cargo build command.
#[derive(Debug, Default)]
pub struct Built {
    /// The `terrella` executable; `None` if it was not built.
    pub terrella: Option<PathBuf>,
    /// The last example; `None` if none was built.
    pub example: Option<PathBuf>,
    /// Test programs.
    pub tests: Vec<TestProgram>,
}

/// Set for builds that are installed with their maps: they do not read those of this checkout.
pub const RELEASE: (&str, &str) = ("TERRELLA_RELEASE", "1");

/// Runs a cargo build command and returns its products.
pub fn build(arguments: &[&str]) -> anyhow::Result<Built> {
    build_with(&[], arguments)
}

/// The same with environment variables.
pub fn build_with(variables: &[(&str, &str)], arguments: &[&str]) -> anyhow::Result<Built> {
    let what = shown(cargo().args(arguments));
    say(&what);
    // Cargo itself reports the path: the folder depends on the profile, the target and the user's configuration. The option comes first, since the
    // last arguments may be for the compiler.
    let (first, rest) = arguments.split_at(arguments.len().min(1));
    let mut command = cargo();
    let mut child = command
        .envs(variables.iter().copied())
        .args(first)
        .arg("--message-format=json-render-diagnostics")
        .args(rest)
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot start `{what}`"))?;
    let mut built = Built::default();
    if let Some(stdout) = child.stdout.take() {
        for line in BufReader::new(stdout).lines() {
            let line = line.with_context(|| format!("cannot read the output of `{what}`"))?;
            let executable = |kind| executable_in(&line, kind);
            built.terrella = executable(Kind::Program).or(built.terrella);
            built.example = executable(Kind::Example).or(built.example);
            built.tests.extend(test_in(&line));
        }
    }
    let status = child.wait()?;
    if !status.success() {
        return Err(ChildFailed::new(what, status).into());
    }
    Ok(built)
}

/// The test program in one of cargo's messages, if there is one.
fn test_in(line: &str) -> Option<TestProgram> {
    let message: Value = serde_json::from_str(line).ok()?;
    let is_test = message.get("reason")? == "compiler-artifact"
        && message.get("profile")?.get("test")?.as_bool()?;
    let text = |value: &Value| value.as_str().map(str::to_owned);
    let manifest = PathBuf::from(text(message.get("manifest_path")?)?);
    let program = TestProgram {
        name: text(message.get("target")?.get("name")?)?,
        package: manifest.parent()?.to_path_buf(),
        executable: PathBuf::from(text(message.get("executable")?)?),
    };
    is_test.then_some(program)
}

/// The output of a cargo query.
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

/// Kind of an executable other than a test program.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// The program `terrella`.
    Program,
    Example,
}

/// The path in one of cargo's messages, if it names an executable of this kind (not its unit tests).
fn executable_in(line: &str, kind: Kind) -> Option<PathBuf> {
    let message: Value = serde_json::from_str(line).ok()?;
    let target = message.get("target")?;
    let is = |word: &str| Some(target.get("kind")?.as_array()?.iter().any(|k| k == word));
    let is_kind = match kind {
        Kind::Program => is("bin")? && target.get("name")? == "terrella",
        Kind::Example => is("example")?,
    };
    let is_built = message.get("reason")? == "compiler-artifact"
        && message.get("profile")?.get("test")? == false;
    let path = message.get("executable")?.as_str()?;
    (is_kind && is_built).then(|| PathBuf::from(path))
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
    fn programs_of_tests_are_taken_with_their_packages() {
        let message = |test: bool| {
            format!(
                r#"{{"reason":"compiler-artifact","manifest_path":"/r/crates/a/Cargo.toml","target":{{"kind":["test"],"name":"orbit"}},"profile":{{"test":{test}}},"executable":"/t/orbit-1"}}"#
            )
        };
        let program = TestProgram {
            name: "orbit".into(),
            package: "/r/crates/a".into(),
            executable: "/t/orbit-1".into(),
        };
        assert_eq!(test_in(&message(true)), Some(program));
        assert_eq!(test_in(&message(false)), None);
        assert_eq!(test_in("running 3 tests"), None);
    }

    #[test]
    fn only_the_program_itself_is_taken() {
        let path = r#""/t/debug/terrella""#;
        let program = |line: &str| executable_in(line, Kind::Program);
        assert_eq!(
            program(&message("bin", false, path)),
            Some(PathBuf::from("/t/debug/terrella"))
        );
        assert_eq!(
            executable_in(&message("example", false, path), Kind::Example),
            Some(PathBuf::from("/t/debug/terrella"))
        );
        assert_eq!(program(&message("example", false, path)), None);
        assert_eq!(program(&message("bin", true, path)), None);
        assert_eq!(program(&message("lib", false, path)), None);
        assert_eq!(program(&message("bin", false, "null")), None);
        assert_eq!(program("running 3 tests"), None);
        assert_eq!(
            program(r#"{"reason":"build-finished","success":true}"#),
            None
        );
    }
}
