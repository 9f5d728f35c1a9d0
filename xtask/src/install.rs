//! `cargo xtask install`: the program on this machine, with maps, completions and man pages.

use crate::dist::build_program;
use crate::layout;
use crate::process::{repository_root, say};
use anyhow::Context;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Installs below a prefix, `~/.local` by default.
pub fn run(prefix: Option<PathBuf>, program: Option<PathBuf>) -> anyhow::Result<()> {
    let prefix = match prefix {
        Some(prefix) => prefix,
        None => std::env::home_dir()
            .context("there is no home folder; give --prefix")?
            .join(".local"),
    };
    let program = match program {
        Some(program) => program,
        None => build_program()?,
    };
    let root = repository_root();
    layout::put_program(&root, &program, &|program| Command::new(program), &prefix)?;
    let installed = layout::program_below(&prefix);
    say(format_args!("{} is installed", installed.display()));
    let folder = installed.parent().unwrap_or(&prefix);
    if !is_on_path(folder) {
        say(format_args!(
            "shells do not find it yet: add {} to PATH",
            folder.display()
        ));
    }
    Ok(())
}

/// Whether a folder is in the shell's search path.
fn is_on_path(folder: &Path) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|one| one == folder)
}
