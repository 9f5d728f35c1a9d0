//! `cargo xtask peers`: frame times beside those of other renderers, in one run.

use crate::process::{self, repository_root};
use anyhow::Context;
use std::path::PathBuf;
use std::process::Command;

/// The peers and what they need beside it, as Python packages.
const PACKAGES: [&str; 4] = [
    "vtk==9.7.2",
    "pygfx==0.17.0",
    "rendercanvas==2.7.2",
    "pillow==13.0.0",
];

/// Installs the peers and this repository's Python package, or its wheel, into target/peers, and prints the frame times of all as CSV.
///
/// # Errors
/// A package cannot be installed, for example without a network, or a renderer draws nothing.
pub fn run(rounds: u32, wheel: Option<PathBuf>) -> anyhow::Result<()> {
    let root = repository_root();
    let environment = root.join("target/peers");
    process::run(
        Command::new("python3")
            .args(["-m", "venv"])
            .arg(&environment),
    )?;
    let python = environment.join(match cfg!(windows) {
        true => "Scripts/python.exe",
        false => "bin/python",
    });
    let mut install = Command::new(&python);
    install
        .args(["-m", "pip", "install", "--quiet"])
        .args(PACKAGES)
        .arg(wheel.as_ref().unwrap_or(&root));
    process::run(&mut install)
        .context("the peers are not measured: they cannot be installed into target/peers")?;
    let script: PathBuf = root.join("crates/terrella-py/benches/peers.py");
    let mut measure = Command::new(&python);
    measure
        .arg(script)
        .arg(root.join("textures/day.jpg"))
        .arg(rounds.to_string());
    process::run(&mut measure)
}
