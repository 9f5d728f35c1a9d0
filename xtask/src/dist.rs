//! `cargo xtask dist`: the parts of a release, as archives with checksums.

mod archive;
#[cfg(test)]
mod tests;

use crate::process::{repository_root, say};
use crate::{cargo, faces, layout};
use anyhow::{Context, bail};
use clap::ValueEnum;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// Limit on the size of the stripped program, bytes.
const MAX_PROGRAM_BYTES: u64 = 36_000_000;
/// The file of checksums, as `sha256sum --check` reads it.
const CHECKSUMS: &str = "SHA256SUMS";
/// The build of the program. Its last stage, LTO over all crates, inlines sparingly: functions that are hot across crates are marked, and the usual
/// threshold would make the program larger than without LTO.
const BUILD: [&str; 11] = [
    "rustc",
    "--profile",
    "dist",
    "--locked",
    "--package",
    "terrella-cli",
    "--bin",
    "terrella",
    "--",
    "-C",
    "llvm-args=--inline-threshold=75",
];

/// A part of a release.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Part {
    /// The command with maps, scenes, completions and man pages
    Program,
    /// The C library with header, maps, pkg-config file and CMake package; Linux only
    CLibrary,
    /// The wheel of the Python package; needs maturin and ziglang
    Wheel,
}

/// Builds the parts and writes them to a folder with the checksums of all files there. `program` is archived instead of a new build.
pub fn run(parts: &[Part], program: Option<PathBuf>, out: &Path) -> anyhow::Result<()> {
    if parts.contains(&Part::CLibrary) && !cfg!(target_os = "linux") {
        bail!("the C library is packed on Linux only; choose other parts with --parts");
    }
    if parts.contains(&Part::Wheel) {
        // Check before the builds, which take minutes.
        faces::check_wheel_tools()?;
    }
    for part in parts {
        match part {
            Part::Program => {
                let program = match &program {
                    Some(program) => program.clone(),
                    None => build_program()?,
                };
                pack_program(&program, &|program| Command::new(program), out)?;
            }
            Part::CLibrary => pack_c_library(out)?,
            Part::Wheel => pack_wheel(out)?,
        }
        // A part that fails later leaves the checksums of the earlier ones.
        write_checksums(out)?;
    }
    Ok(())
}

/// Builds the program for release.
pub fn build_program() -> anyhow::Result<PathBuf> {
    cargo::build_with(&[cargo::RELEASE], &BUILD)?
        .terrella
        .context("cargo built the program and did not say where it is")
}

/// Archives a program with its files.
fn pack_program(
    program: &Path,
    start: &dyn Fn(&Path) -> Command,
    out: &Path,
) -> anyhow::Result<()> {
    let begun = Instant::now();
    let bytes = fs::metadata(program)
        .with_context(|| program.display().to_string())?
        .len();
    if bytes > MAX_PROGRAM_BYTES {
        bail!(
            "{} has {bytes} bytes, more than {MAX_PROGRAM_BYTES}",
            program.display()
        );
    }
    let staged = tempfile::tempdir()?;
    layout::put_program(&repository_root(), program, start, staged.path())?;
    put_readme(layout::PROGRAM_README, staged.path())?;
    archive(staged.path(), &versioned("terrella")?, out, begun)
}

/// Builds and archives the C library.
fn pack_c_library(out: &Path) -> anyhow::Result<()> {
    let begun = Instant::now();
    let staged = tempfile::tempdir()?;
    faces::c_library(staged.path(), "dist")?;
    put_readme(faces::C_README, staged.path())?;
    archive(staged.path(), &versioned("terrella-c")?, out, begun)
}

/// Writes the README where a user who extracts the archive looks first.
fn put_readme(text: &str, folder: &Path) -> anyhow::Result<()> {
    crate::files::write_bytes(&folder.join("README.md"), text.as_bytes())
}

/// Builds the wheel in another folder, and moves it when it is complete.
fn pack_wheel(out: &Path) -> anyhow::Result<()> {
    let built = tempfile::tempdir()?;
    faces::wheel(built.path())?;
    for file in fs::read_dir(built.path())? {
        let file = file?;
        crate::files::copy_whole(&file.path(), &out.join(file.file_name()), false)?;
    }
    Ok(())
}

/// A name with version and platform.
fn versioned(name: &str) -> anyhow::Result<String> {
    let version = cargo::output(&["--version", "--verbose"])?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    let host = host.context("cargo does not say which platform it is for")?;
    Ok(format!("{name}-{}-{host}", env!("CARGO_PKG_VERSION")))
}

/// Archives a folder under a name, and reports it.
fn archive(folder: &Path, name: &str, out: &Path, begun: Instant) -> anyhow::Result<()> {
    let path = out.join(format!("{name}.tar.gz"));
    archive::write(folder, name, &path)?;
    say(format_args!(
        "{}: {:.1} MB, {:.0} s",
        path.display(),
        fs::metadata(&path)?.len() as f64 / 1e6,
        begun.elapsed().as_secs_f64()
    ));
    Ok(())
}

/// Writes the checksums of all archives and wheels in a folder.
fn write_checksums(out: &Path) -> anyhow::Result<()> {
    let mut lines = Vec::new();
    for file in fs::read_dir(out).with_context(|| out.display().to_string())? {
        let file = file?;
        let name = file.file_name().to_string_lossy().into_owned();
        if name.starts_with("terrella") && (name.ends_with(".tar.gz") || name.ends_with(".whl")) {
            // Two spaces between checksum and name, as `sha256sum` writes them.
            lines.push((name.clone(), archive::sha256(&file.path())?));
        }
    }
    lines.sort();
    let text: String = lines
        .iter()
        .map(|(name, sum)| format!("{sum}  {name}\n"))
        .collect();
    crate::files::write_bytes(&out.join(CHECKSUMS), text.as_bytes())?;
    say(format_args!("{}", out.join(CHECKSUMS).display()));
    Ok(())
}
