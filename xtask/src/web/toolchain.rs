//! The compiler for wasm32: rustup's target, or Debian's compiler with the sources of the standard library.

use crate::cargo;
use crate::process::{self, repository_root, say};
use anyhow::{Context, bail};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";
/// Debian's compiler and the sources of its standard library, which is compiled because the target has no package.
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
const DEBIAN_SOURCES: &str = "/usr/lib/rustlib/src/rust/library";
/// Advice if no compiler for the target exists.
const MISSING: &str = "no compiler for wasm32 is installed; run `rustup target add wasm32-unknown-unknown`, or on Debian \
    `apt-get install rustc-web rust-web-src lld-22`";
/// A way to compile for wasm32.
pub enum Toolchain {
    /// The compiler that runs this has the target.
    Target,
    /// Debian's compiler, which builds the standard library too and links with this program.
    Debian { linker: OsString },
}

impl Toolchain {
    /// The first compiler found on this machine, or advice.
    pub fn find() -> Result<Self, &'static str> {
        let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let mut asked = Command::new(rustc);
        asked.args(["--print", "target-libdir", "--target", TARGET]);
        if let Ok(answer) = asked.output()
            && answer.status.success()
            && Path::new(String::from_utf8_lossy(&answer.stdout).trim()).exists()
        {
            return Ok(Self::Target);
        }
        if Path::new(DEBIAN_RUSTC).exists()
            && Path::new(DEBIAN_SOURCES).exists()
            && let Some(linker) = linker()
        {
            return Ok(Self::Debian { linker });
        }
        Err(MISSING)
    }

    /// A cargo command for the target.
    pub fn cargo(&self, what: &str) -> Command {
        let mut command = cargo::cargo();
        command.arg(what);
        if let Self::Debian { linker } = self {
            command.args(["-Z", "build-std=std,panic_abort"]);
            // Sorts and searches of the standard library that are small: 22 kB less of the compressed file.
            command.args(["-Z", "build-std-features=optimize_for_size"]);
            command.env("RUSTC", DEBIAN_RUSTC);
            // Building the standard library is not stable.
            command.env("RUSTC_BOOTSTRAP", "1");
            command.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker);
        }
        command.args(["--target", TARGET]);
        command
    }
}

/// The newest wasm linker in the search path, by Debian's names.
fn linker() -> Option<OsString> {
    let path = std::env::var_os("PATH")?;
    let folders: Vec<_> = std::env::split_paths(&path).collect();
    let names = (14..40).rev().map(|version| format!("wasm-ld-{version}"));
    let mut names = names.chain(["wasm-ld".to_owned()]);
    let name = names.find(|name| folders.iter().any(|folder| folder.join(name).exists()))?;
    Some(name.into())
}

/// The program that writes the JavaScript of a wasm file, in the crate's version; installed below `target` if it is missing.
pub fn bindgen(package: &Path) -> anyhow::Result<PathBuf> {
    let manifest = package.join("Cargo.toml");
    let text = fs::read_to_string(&manifest).with_context(|| manifest.display().to_string())?;
    let version = text
        .lines()
        .find_map(|line| line.strip_prefix("wasm-bindgen = \"="))
        .and_then(|rest| rest.strip_suffix('"'))
        .with_context(|| format!("{} names no version of wasm-bindgen", manifest.display()))?;
    let has_version = |program: &Path| {
        let answer = Command::new(program).arg("--version").output();
        answer.is_ok_and(|answer| String::from_utf8_lossy(&answer.stdout).contains(version))
    };
    let tools = repository_root().join("target/web/tools");
    let own = tools.join("bin/wasm-bindgen");
    for program in [own.clone(), "wasm-bindgen".into()] {
        if has_version(&program) {
            return Ok(program);
        }
    }
    say("wasm-bindgen is compiled once, which takes some minutes");
    let mut install = cargo::cargo();
    // Without `--locked`: the registry may not have all versions of the lock.
    install.args(["install", "wasm-bindgen-cli", "--version", version]);
    process::run(install.arg("--root").arg(&tools))?;
    if !has_version(&own) {
        bail!("{} is not of version {version}", own.display());
    }
    Ok(own)
}
