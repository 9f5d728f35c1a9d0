//! `cargo xtask lean`: the cost for a host that draws the Earth and nothing else.

use crate::cargo;
use crate::process::{self, repository_root, say};
use anyhow::Context;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::time::Instant;

/// Builds `examples/minimal.rs` from scratch as a separate program outside the workspace, and reports its cost. As an example it would be built
/// with all dependencies of the tests.
pub fn run(features: &str) -> anyhow::Result<()> {
    let root = repository_root();
    let host = root.join("target/lean");
    if host.exists() {
        fs::remove_dir_all(&host).with_context(|| format!("cannot remove {}", host.display()))?;
    }
    write_host(&root, &host, features)
        .with_context(|| format!("cannot write the program into {}", host.display()))?;

    let manifest = host.join("Cargo.toml");
    let manifest = manifest.to_string_lossy();
    let tree = cargo::output(&[
        "tree",
        "--manifest-path",
        &manifest,
        "--edges",
        "normal",
        "--prefix",
        "none",
        "--no-dedupe",
    ])?;
    // Fetch everything before the clock starts.
    process::run(cargo::cargo().args(["fetch", "--manifest-path", &manifest]))?;
    let begin = Instant::now();
    let mut build = cargo::cargo();
    build.args(["build", "--release", "--manifest-path", &manifest]);
    let target = host.join("target");
    process::run(build.arg("--target-dir").arg(&target))?;
    let seconds = begin.elapsed().as_secs_f64();
    let program = target
        .join("release")
        .join(format!("hello-earth{}", std::env::consts::EXE_SUFFIX));
    let bytes = fs::metadata(&program)
        .with_context(|| format!("cannot look at {}", program.display()))?
        .len();
    say(format_args!(
        "features `{features}`: {} crates besides the program, {seconds:.0} s to build for release, {bytes} bytes stripped",
        crates(&tree)
    ));
    Ok(())
}

/// Packages in the output of `cargo tree`, except the first.
fn crates(tree: &str) -> usize {
    let packages: BTreeSet<_> = tree
        .lines()
        .skip(1)
        .filter_map(|line| {
            let mut words = line.split_whitespace();
            Some((words.next()?, words.next()?))
        })
        .collect();
    packages.len()
}

/// Writes the program to a folder outside the workspace, with the versions of our lock file.
fn write_host(root: &Path, host: &Path, features: &str) -> std::io::Result<()> {
    fs::create_dir_all(host.join("src"))?;
    fs::write(host.join("Cargo.toml"), manifest(root, features))?;
    fs::copy(root.join("Cargo.lock"), host.join("Cargo.lock"))?;
    fs::copy(root.join("examples/minimal.rs"), host.join("src/main.rs"))?;
    Ok(())
}

fn manifest(root: &Path, features: &str) -> String {
    let features = features
        .split(',')
        .filter(|name| !name.is_empty())
        .map(|name| format!("{name:?}"))
        .collect::<Vec<_>>()
        .join(", ");
    format!(
        "[package]
name = \"hello-earth\"
version = \"0.0.0\"
edition = \"2024\"

[workspace]

[dependencies]
pollster = \"0.4\"
terrella = {{ path = {root:?}, default-features = false, features = [{features}] }}

[profile.release]
strip = true
"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_package_counts_once_in_each_version() {
        let tree = "hello-earth v0.0.0 (/a)\nglam v0.33.12\nsyn v2.0.1 (proc-macro)\nsyn v3.0.0\nglam v0.33.12\n";
        assert_eq!(crates(tree), 3);
    }

    #[test]
    fn the_program_asks_for_these_features_alone() {
        let text = manifest(Path::new("/a b"), "vulkan,packs");
        assert!(text.contains(
            r#"path = "/a b", default-features = false, features = ["vulkan", "packs"]"#
        ));
        assert!(manifest(Path::new("/a"), "").contains("features = []"));
    }
}
