//! `terrella new`

use super::{Common, print};
use anyhow::Context;
use clap::Args;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use terrella_play::scene::Scene;

/// The name of the built-in scene in its own text.
const SHIPPED: &str = "config/iss.toml";

/// Arguments of `terrella new`.
#[derive(Debug, Args)]
pub struct NewArgs {
    /// Name of the scene, or path of its file; .toml is added where it is missing. An existing file is never overwritten
    name: PathBuf,
}

/// Writes the built-in scene, in which every key is explained.
pub fn run(args: &NewArgs, common: &Common) -> anyhow::Result<()> {
    let path = file_name(&args.name)?;
    let text = text(&path)?;
    let mut file = create(&path)?;
    if let Err(error) = file
        .write_all(text.as_bytes())
        .and_then(|()| file.sync_all())
    {
        drop(file);
        // The file is ours and incomplete.
        let _ = std::fs::remove_file(&path);
        return Err(error).with_context(|| format!("{}: it cannot be written", path.display()));
    }
    match common.quiet {
        true => Ok(()),
        false => print(&format!(
            "{0}: edit it, then run `terrella play {0}`\n",
            path.display()
        )),
    }
}

/// The path with `.toml`.
fn file_name(name: &Path) -> anyhow::Result<PathBuf> {
    match name.extension() {
        _ if name.file_name().is_none() => {
            anyhow::bail!(
                "{}: it is a folder; give the name of a file in it",
                name.display()
            )
        }
        None => Ok(name.with_extension("toml")),
        Some(extension) if extension == "toml" => Ok(name.to_owned()),
        Some(_) => anyhow::bail!(
            "{}: scenes are TOML; give a name that ends in .toml, or one without an ending",
            name.display()
        ),
    }
}

/// The text of the built-in scene with this path as its name.
fn text(path: &Path) -> anyhow::Result<String> {
    let scene = Scene::shipped()?;
    let text = scene.own_text().unwrap_or_default();
    // Only a checkout has the schema beside its scenes.
    let lines = text.lines().filter(|line| !line.starts_with("#:schema"));
    let name = path.display().to_string();
    let lines = lines.map(|line| line.replace(SHIPPED, &name) + "\n");
    Ok(lines.collect())
}

/// Creates the file, and its folder where that is missing; fails if the file exists.
fn create(path: &Path) -> anyhow::Result<File> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("{}: its folder cannot be created", path.display()))?;
    }
    let made = OpenOptions::new().write(true).create_new(true).open(path);
    made.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            anyhow::anyhow!(
                "{}: it exists already; give another name, or remove it",
                path.display()
            )
        }
        _ => {
            anyhow::Error::from(error).context(format!("{}: it cannot be written", path.display()))
        }
    })
}
