//! Paths of an installed program below a prefix: the same in archives and on a machine.

use crate::files::{copy_whole, write_bytes};
use crate::process::ChildFailed;
use anyhow::{Context, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The program's maps: `../share/terrella/textures` beside it.
pub const MAPS: &str = "share/terrella/textures";
const SCENES: &str = "share/terrella/config";
/// Documents.
pub const DOC: &str = "share/doc/terrella";
const MAN: &str = "share/man/man1";
/// Licences in every package that is built from the sources.
const LICENCES: [&str; 3] = ["LICENSE-APACHE", "LICENSE-MIT", "THIRD-PARTY.md"];
/// The README of the installed program. The repository's describes a source checkout.
pub const PROGRAM_README: &str = include_str!("dist/program.md");

/// Shells, each with its completion file.
const COMPLETIONS: [(&str, &str); 5] = [
    ("bash", "share/bash-completion/completions/terrella"),
    ("elvish", "share/elvish/lib/terrella.elv"),
    ("fish", "share/fish/vendor_completions.d/terrella.fish"),
    ("powershell", "share/terrella/completions/terrella.ps1"),
    ("zsh", "share/zsh/site-functions/_terrella"),
];

/// The path of the program below a prefix.
pub fn program_below(prefix: &Path) -> PathBuf {
    prefix
        .join("bin")
        .join(format!("terrella{}", std::env::consts::EXE_SUFFIX))
}

/// Installs the program with its files below a prefix. The program comes last, so that an installed one always has its maps. `start` makes a
/// command from a program's path.
pub fn put_program(
    root: &Path,
    program: &Path,
    start: &dyn Fn(&Path) -> Command,
    prefix: &Path,
) -> anyhow::Result<()> {
    put_maps(root, prefix)?;
    put_documents(root, PROGRAM_README, prefix)?;
    put_folder(&root.join("config"), &prefix.join(SCENES))?;
    let printed = |arguments: &[&str]| {
        let mut command = start(program);
        printed_by(command.args(arguments))
    };
    for (shell, file) in COMPLETIONS {
        write_bytes(&prefix.join(file), &printed(&["completions", shell])?)?;
    }
    let list = String::from_utf8(printed(&["man", "--list"])?)?;
    let pages = prefix.join(MAN);
    write_bytes(&pages.join("terrella.1"), &printed(&["man"])?)?;
    for name in list.lines() {
        let arguments: Vec<_> = ["man"].into_iter().chain(name.split(' ')).collect();
        let page = pages.join(format!("terrella-{}.1", name.replace(' ', "-")));
        write_bytes(&page, &printed(&arguments)?)?;
    }
    copy_whole(program, &program_below(prefix), true)
}

/// Installs the maps, with their sources and licences.
pub fn put_maps(root: &Path, prefix: &Path) -> anyhow::Result<()> {
    // Excludes the crate files of the folder, which is a crate too.
    let is_map = |path: &Path| {
        let ending = path.extension().unwrap_or_default();
        let is_manifest = path.file_name().is_some_and(|name| name == "Cargo.toml");
        !is_manifest
            && ["bin", "jpg", "md", "png", "toml"]
                .iter()
                .any(|one| ending == *one)
    };
    copy_folder(&root.join("textures"), &prefix.join(MAPS), &is_map)
}

/// Installs a README and the licences.
pub fn put_documents(root: &Path, readme: &str, prefix: &Path) -> anyhow::Result<()> {
    let folder = prefix.join(DOC);
    for name in LICENCES {
        copy_whole(&root.join(name), &folder.join(name), false)?;
    }
    write_bytes(&folder.join("README.md"), readme.as_bytes())
}

/// Installs a folder with all files.
pub fn put_folder(from: &Path, to: &Path) -> anyhow::Result<()> {
    copy_folder(from, to, &|_| true)
}

/// Copies a folder recursively.
fn copy_folder(from: &Path, to: &Path, is_wanted: &dyn Fn(&Path) -> bool) -> anyhow::Result<()> {
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let entry = entry.with_context(|| from.display().to_string())?;
        let (path, target) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy_folder(&path, &target, is_wanted)?;
        } else if is_wanted(&path) {
            copy_whole(&path, &target, false)?;
        }
    }
    Ok(())
}

/// The output of a program; empty output is an error.
fn printed_by(command: &mut Command) -> anyhow::Result<Vec<u8>> {
    let what = crate::process::shown(command);
    let output = command.stderr(Stdio::inherit()).output();
    let output = output.with_context(|| format!("cannot start `{what}`"))?;
    if !output.status.success() {
        return Err(ChildFailed::new(what, output.status).into());
    }
    if output.stdout.is_empty() {
        bail!("`{what}` printed nothing");
    }
    Ok(output.stdout)
}
