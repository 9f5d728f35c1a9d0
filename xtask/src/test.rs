//! `cargo xtask test`: the preparation of the demonstration, then the whole suite.

mod pool;

use crate::cargo;
use crate::prepare::{self, Policy, Window};
use crate::process::{self, say};

/// Prepares the machine, builds the tests, opens the adapter once, and runs the tests.
pub fn run(policy: Policy, arguments: &[String]) -> anyhow::Result<()> {
    prepare::run(policy, Window::ForTests)?;
    let (for_cargo, for_tests) = split(arguments);
    let mut cargo_arguments = vec!["test"];
    if !chooses_packages(for_cargo) {
        cargo_arguments.push("--workspace");
    }
    cargo_arguments.extend(for_cargo.iter().map(String::as_str));

    // Build it with the tests: a separate build would compile other variants of the dependencies.
    let mut build = cargo_arguments.clone();
    build.push("--no-run");
    let built = cargo::build(&build)?;
    match built.terrella {
        // Report a missing adapter once and plainly, not in every test that draws.
        Some(terrella) => prepare::check_adapter(policy, &terrella)?,
        None => say("the adapter is not tried: these arguments do not build the program"),
    }
    if arguments.is_empty() {
        pool::run(built.tests)?;
        cargo_arguments.push("--doc");
    }
    process::run(cargo::cargo().args(cargo_arguments).args(for_tests))
}

/// Arguments for cargo, and those for the test programs with their `--`.
fn split(arguments: &[String]) -> (&[String], &[String]) {
    let end = arguments
        .iter()
        .position(|argument| argument == "--")
        .unwrap_or(arguments.len());
    arguments.split_at(end)
}

/// Whether the user selected packages; then `--workspace` would widen the selection again.
fn chooses_packages(arguments: &[String]) -> bool {
    arguments
        .iter()
        .any(|a| a.starts_with("-p") || a == "--package" || a.starts_with("--package="))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        text.split_whitespace().map(str::to_string).collect()
    }

    #[test]
    fn arguments_go_where_they_belong() {
        let all = words("--test render -- --nocapture");
        let (for_cargo, for_tests) = split(&all);
        assert_eq!(for_cargo, words("--test render"));
        assert_eq!(for_tests, words("-- --nocapture"));
        assert_eq!(split(&words("horizon")).1, words(""));
    }

    #[test]
    fn a_choice_of_packages_is_kept() {
        assert!(chooses_packages(&words("-p xtask")));
        assert!(chooses_packages(&words("-pxtask")));
        assert!(chooses_packages(&words("--package=xtask")));
        assert!(!chooses_packages(&words("--test render")));
    }
}
