//! What other languages call: the C library with its header, and the wheel for Python.

use crate::cargo;
use crate::process::{self, repository_root, say};
use anyhow::{Context, bail};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Largest wheel, bytes: maps and all.
const MAX_WHEEL_BYTES: u64 = 25_000_000;

/// Builds the C library and puts it below a prefix, with header, maps, and what pkg-config and CMake look for.
pub fn c_library(prefix: &Path) -> anyhow::Result<()> {
    if !cfg!(target_os = "linux") {
        bail!(
            "the C library is laid out for Linux only; elsewhere `cargo build --release -p terrella-c` makes it in target/release"
        );
    }
    let root = repository_root();
    let arguments = [
        "rustc",
        "--release",
        "--locked",
        "--package",
        "terrella-c",
        "--lib",
    ];
    // The libraries that a program needs beside the static one are told by the compiler.
    let asked = ["--", "--print", "native-static-libs"];
    let mut command = cargo::cargo();
    command.args(arguments).args(asked);
    let what = process::shown(&command);
    say(&what);
    let output = command
        .output()
        .with_context(|| format!("cannot start `{what}`"))?;
    let told = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        eprint!("{told}");
        return Err(process::ChildFailed::new(what, output.status).into());
    }
    let libraries = told
        .lines()
        .find_map(|line| line.split("native-static-libs: ").nth(1));
    let libraries = match libraries {
        Some(libraries) => libraries.trim().to_owned(),
        // Told only when it compiles: what it was is beside the library.
        None => fs::read_to_string(built(&root)?.join("terrella_c.libs"))
            .context("the compiler did not say what the static library needs; touch crates/terrella-c/src/lib.rs and run this again")?,
    };
    fs::write(built(&root)?.join("terrella_c.libs"), &libraries)?;
    lay_out(&root, prefix, &libraries)?;
    say(format_args!(
        "{} has it; PKG_CONFIG_PATH={}",
        prefix.display(),
        prefix.join("lib/pkgconfig").display()
    ));
    Ok(())
}

fn built(root: &Path) -> anyhow::Result<std::path::PathBuf> {
    let metadata = cargo::output(&[
        "metadata",
        "--format-version",
        "1",
        "--no-deps",
        "--offline",
    ])?;
    let metadata: serde_json::Value = serde_json::from_str(&metadata)?;
    let target = metadata
        .get("target_directory")
        .and_then(|path| path.as_str());
    let target = target.map_or_else(|| root.join("target"), Into::into);
    Ok(target.join("release"))
}

fn lay_out(root: &Path, prefix: &Path, libraries: &str) -> anyhow::Result<()> {
    let (package, built) = (root.join("crates/terrella-c"), built(root)?);
    let [include, lib, pc, cmake, share] = [
        "include",
        "lib",
        "lib/pkgconfig",
        "lib/cmake/terrella",
        "share/terrella/textures",
    ]
    .map(|folder| prefix.join(folder));
    for folder in [&include, &lib, &pc, &cmake, &share] {
        fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    copy(
        &package.join("include/terrella.h"),
        &include.join("terrella.h"),
    )?;
    copy(&built.join("libterrella_c.a"), &lib.join("libterrella_c.a"))?;
    copy(
        &built.join("libterrella_c.so"),
        &lib.join("libterrella_c.so.0"),
    )?;
    let link = lib.join("libterrella_c.so");
    if link.symlink_metadata().is_ok() {
        fs::remove_file(&link)?;
    }
    #[cfg(unix)]
    std::os::unix::fs::symlink("libterrella_c.so.0", &link)?;
    for map in fs::read_dir(root.join("textures"))?
        .flatten()
        .filter(|map| map.path().is_file())
    {
        copy(&map.path(), &share.join(map.file_name()))?;
    }
    let list = libraries.split_whitespace().collect::<Vec<_>>().join(";");
    for (template, to) in [
        ("terrella.pc.in", pc.join("terrella.pc")),
        (
            "cmake/terrella-config.cmake.in",
            cmake.join("terrella-config.cmake"),
        ),
    ] {
        let text =
            fs::read_to_string(package.join(template)).with_context(|| template.to_owned())?;
        fs::write(to, filled(&text, libraries, &list))?;
    }
    Ok(())
}

fn filled(template: &str, libraries: &str, list: &str) -> String {
    template
        .replace("@VERSION@", env!("CARGO_PKG_VERSION"))
        .replace("@PRIVATE_LIST@", list)
        .replace("@PRIVATE@", libraries)
}

fn copy(from: &Path, to: &Path) -> anyhow::Result<()> {
    fs::copy(from, to).with_context(|| format!("{} to {}", from.display(), to.display()))?;
    Ok(())
}

/// Builds the wheel: one for Python 3.10 and later, for every Linux with glibc 2.28 or later. Needs maturin and zig, as Python packages.
pub fn wheel(out: &Path) -> anyhow::Result<()> {
    let root = repository_root();
    let python = std::env::var_os("TERRELLA_PYTHON").unwrap_or_else(|| "python3".into());
    let ready = Command::new(&python)
        .args(["-c", "import maturin, ziglang"])
        .output();
    if !ready.is_ok_and(|output| output.status.success()) {
        bail!(
            "{} has no maturin or no ziglang; run `python3 -m venv target/venv && target/venv/bin/pip install maturin==1.16.0 ziglang==0.15.2`, then \
             this with TERRELLA_PYTHON=target/venv/bin/python",
            python.display()
        );
    }
    let mut command = Command::new(&python);
    command
        .current_dir(&root)
        .args(["-m", "maturin", "build", "--release", "--locked", "--strip"]);
    command.args([
        "--zig",
        "--target",
        "x86_64-unknown-linux-gnu",
        "--compatibility",
        "manylinux_2_28",
        "--out",
    ]);
    command.arg(out);
    process::run(&mut command)?;
    for file in fs::read_dir(out)?.flatten() {
        let (name, bytes) = (file.file_name(), file.metadata()?.len());
        if name.to_string_lossy().ends_with(".whl") {
            say(format_args!(
                "{}: {:.1} MB",
                file.path().display(),
                bytes as f64 / 1e6
            ));
            if bytes > MAX_WHEEL_BYTES {
                bail!(
                    "the wheel is larger than {} MB",
                    MAX_WHEEL_BYTES / 1_000_000
                );
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn templates_are_filled() {
        let root = repository_root().join("crates/terrella-c");
        for template in ["terrella.pc.in", "cmake/terrella-config.cmake.in"] {
            let text = fs::read_to_string(root.join(template)).expect("there");
            let filled = filled(&text, "-lm -ldl", "-lm;-ldl");
            assert!(!filled.contains('@'), "{template}: {filled}");
            assert!(
                filled.contains(env!("CARGO_PKG_VERSION")) && filled.contains("-ldl"),
                "{template}"
            );
        }
    }
}
