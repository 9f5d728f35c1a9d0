//! `terrella man`

use super::{command, print};
use clap::{Args, Command};
use std::fmt::Write;

/// Arguments of `terrella man`.
#[derive(Debug, Args)]
#[command(
    after_help = "Pages are troff source for section 1. `cargo xtask install` installs them for man."
)]
pub struct ManArgs {
    /// The command to describe: play, or pack build; without one the program
    #[arg(value_name = "COMMAND")]
    command: Vec<String>,
    /// List the commands that have a page, one a line
    #[arg(long, conflicts_with = "command")]
    list: bool,
}

/// Prints a page, or the commands that have one.
pub fn run(args: &ManArgs) -> anyhow::Result<()> {
    let mut root = command().disable_help_subcommand(true);
    // Names the pages of commands after the program, and hands them the global options.
    root.build();
    if args.list {
        let mut text = String::new();
        list(&root, "", &mut text);
        return print(&text);
    }
    let mut page = &root;
    for name in &args.command {
        page = page.find_subcommand(name).ok_or_else(|| {
            anyhow::anyhow!("there is no command {name:?}; `terrella man --list` lists them")
        })?;
    }
    let mut text = Vec::new();
    clap_mangen::Man::new(page.clone()).render(&mut text)?;
    print(&String::from_utf8(text)?)
}

/// Writes the names of the commands below `parent`, each with those of its parents before it.
fn list(parent: &Command, names: &str, text: &mut String) {
    for command in parent.get_subcommands().filter(|one| !one.is_hide_set()) {
        let names = format!("{names}{} ", command.get_name());
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", names.trim_end());
        list(command, &names, text);
    }
}
