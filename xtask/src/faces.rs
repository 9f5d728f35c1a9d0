//! Packages for other languages: the C library with its header, and the wheel for Python.

use crate::cargo;
use crate::files::{copy_whole, write_bytes};
use crate::layout;
use crate::process::{self, repository_root, say};
use anyhow::{Context, bail};
use serde_json::Value;
use std::ffi::OsString;
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The README of the installed C library.
pub const C_README: &str = include_str!("dist/c_library.md");
/// Limit on the size of the wheel with its maps, bytes.
const MAX_WHEEL_BYTES: u64 = 25_000_000;

/// Builds the C library with a profile and installs it below a prefix, with header, maps, and the files for pkg-config and CMake.
pub fn c_library(prefix: &Path, profile: &str) -> anyhow::Result<()> {
    if !cfg!(target_os = "linux") {
        bail!(
            "the C library is laid out for Linux only; elsewhere `cargo build --release -p terrella-c` makes it in target/release"
        );
    }
    let root = repository_root();
    let mut command = cargo::cargo();
    command.envs([cargo::RELEASE]).args([
        "rustc",
        "--profile",
        profile,
        "--locked",
        "--package",
        "terrella-c",
        "--lib",
        // Omit the Rust library, for which no profile can optimise across crates.
        "--crate-type",
        "cdylib,staticlib",
    ]);
    // Cargo reports the paths of the libraries; the compiler reports the libraries that a program needs beside the static one.
    command.args([
        "--message-format=json-render-diagnostics",
        "--",
        "--print",
        "native-static-libs",
        // Strip the symbols that only debuggers read from the shared library.
        "-C",
        "strip=symbols",
    ]);
    let what = process::shown(&command);
    say(&what);
    let child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = child.with_context(|| format!("cannot start `{what}`"))?;
    // Show its messages as they arrive: the build takes minutes.
    let errors = child.stderr.take();
    let reader = std::thread::spawn(move || {
        let lines = errors
            .into_iter()
            .flat_map(|pipe| BufReader::new(pipe).lines());
        let mut reported = String::new();
        for line in lines.map_while(Result::ok) {
            eprintln!("{line}");
            reported += &line;
            reported.push('\n');
        }
        reported
    });
    let mut messages = String::new();
    if let Some(mut stdout) = child.stdout.take() {
        stdout.read_to_string(&mut messages)?;
    }
    let status = child.wait()?;
    let reported = reader.join().unwrap_or_default();
    if !status.success() {
        return Err(process::ChildFailed::new(what, status).into());
    }
    let libraries = reported
        .lines()
        .find_map(|line| line.split("native-static-libs: ").nth(1));
    let libraries = libraries.context("the compiler did not say what the static library needs")?;
    let built = built(&messages);
    lay_out(&root, &built, prefix, libraries.trim())?;
    say(format_args!(
        "{} has it; PKG_CONFIG_PATH={}",
        prefix.display(),
        prefix.join("lib/pkgconfig").display()
    ));
    Ok(())
}

/// The libraries in cargo's messages.
fn built(messages: &str) -> Vec<PathBuf> {
    let messages = messages
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let ours = messages.filter(|message| {
        let name = message.get("target").and_then(|target| target.get("name"));
        name.is_some_and(|name| name == "terrella_c")
    });
    let files = ours.filter_map(|message| message.get("filenames")?.as_array().cloned());
    let files = files.flatten();
    files
        .filter_map(|file| file.as_str().map(PathBuf::from))
        .collect()
}

fn lay_out(root: &Path, built: &[PathBuf], prefix: &Path, libraries: &str) -> anyhow::Result<()> {
    let library = |name: &str| {
        let found = built.iter().find(|path| path.ends_with(name));
        found.with_context(|| format!("cargo made no {name}"))
    };
    let package = root.join("crates/terrella-c");
    let [include, lib, pc, cmake] =
        ["include", "lib", "lib/pkgconfig", "lib/cmake/terrella"].map(|folder| prefix.join(folder));
    layout::put_maps(root, prefix)?;
    layout::put_documents(root, C_README, prefix)?;
    layout::put_folder(
        &package.join("examples"),
        &prefix.join(layout::DOC).join("examples"),
    )?;
    for header in ["terrella.h", "terrella.hpp"] {
        let from = package.join("include").join(header);
        copy_whole(&from, &include.join(header), false)?;
    }
    let archive = "libterrella_c.a";
    copy_whole(library(archive)?, &lib.join(archive), false)?;
    strip_debug_lines(&lib.join(archive))?;
    let named = lib.join("libterrella_c.so.0.1");
    copy_whole(library("libterrella_c.so")?, &named, true)?;
    #[cfg(unix)]
    {
        let (link, new) = (lib.join("libterrella_c.so"), lib.join(".libterrella_c.so"));
        let _ = fs::remove_file(&new);
        std::os::unix::fs::symlink("libterrella_c.so.0.1", &new)?;
        fs::rename(new, link)?;
    }
    let list = libraries.split_whitespace().collect::<Vec<_>>().join(";");
    for (template, to) in [
        ("terrella.pc.in", pc.join("terrella.pc")),
        (
            "cmake/terrella-config.cmake.in",
            cmake.join("terrella-config.cmake"),
        ),
        (
            "cmake/terrella-config-version.cmake.in",
            cmake.join("terrella-config-version.cmake"),
        ),
    ] {
        let text =
            fs::read_to_string(package.join(template)).with_context(|| template.to_owned())?;
        write_bytes(&to, filled(&text, libraries, &list).as_bytes())?;
    }
    Ok(())
}

/// Strips debug information from a static library, including Rust's own: no profile does that. The tool comes with the C compiler.
fn strip_debug_lines(archive: &Path) -> anyhow::Result<()> {
    let mut command = Command::new("strip");
    command.arg("--strip-debug").arg(archive);
    let status = command.status();
    let status = status.context("cannot start `strip`; install binutils")?;
    match status.success() {
        true => Ok(()),
        false => Err(process::ChildFailed::new(process::shown(&command), status).into()),
    }
}

fn filled(template: &str, libraries: &str, list: &str) -> String {
    template
        .replace("@VERSION@", env!("CARGO_PKG_VERSION"))
        .replace("@PRIVATE_LIST@", list)
        .replace("@PRIVATE@", libraries)
}

/// The Python that builds the wheel.
fn python() -> OsString {
    let Some(chosen) = std::env::var_os("TERRELLA_PYTHON") else {
        return "python3".into();
    };
    // Build scripts, which start it too, run in other folders. Links stay: a virtual environment is one.
    match Path::new(&chosen).components().count() > 1 {
        true => std::path::absolute(&chosen).map_or(chosen, PathBuf::into_os_string),
        false => chosen,
    }
}

/// Fails if the packages that build the wheel are missing, and explains how to install them.
pub fn check_wheel_tools() -> anyhow::Result<()> {
    let python = python();
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
    Ok(())
}

/// Builds one wheel for Python 3.10 and later, for every Linux with glibc 2.28 or later. Needs maturin and zig, as Python packages.
pub fn wheel(out: &Path) -> anyhow::Result<()> {
    let root = repository_root();
    check_wheel_tools()?;
    let mut command = Command::new(python());
    command
        .current_dir(&root)
        // Otherwise maturin looks for ziglang in the `python3` on PATH.
        .env("CARGO_ZIGBUILD_PYTHON_PATH", python())
        .envs([cargo::RELEASE])
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
    fn libraries_are_found_in_messages() {
        let messages = r#"{"reason":"compiler-artifact","target":{"name":"terrella"},"filenames":["/t/libterrella.rlib"]}
no message
{"reason":"compiler-artifact","target":{"name":"terrella_c"},"filenames":["/t/libterrella_c.so","/t/libterrella_c.a"]}"#;
        let found = [
            Path::new("/t/libterrella_c.so"),
            Path::new("/t/libterrella_c.a"),
        ];
        assert_eq!(built(messages), found);
    }

    #[test]
    fn templates_are_filled() {
        let root = repository_root().join("crates/terrella-c");
        for (template, has_libraries) in [
            ("terrella.pc.in", true),
            ("cmake/terrella-config.cmake.in", true),
            ("cmake/terrella-config-version.cmake.in", false),
        ] {
            let text = fs::read_to_string(root.join(template)).expect("there");
            let filled = filled(&text, "-lm -ldl", "-lm;-ldl");
            assert!(!filled.contains('@'), "{template}: {filled}");
            assert!(filled.contains(env!("CARGO_PKG_VERSION")), "{template}");
            assert_eq!(filled.contains("-ldl"), has_libraries, "{template}");
        }
    }
}
