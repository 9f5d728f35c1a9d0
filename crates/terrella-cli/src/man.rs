//! `terrella man`

use super::{command, print};
use clap::{Args, Command};
use std::fmt::Write;

/// Arguments of `terrella man`.
#[derive(Debug, Args)]
#[command(
    after_help = "Pages are troff source for section 1. `cargo xtask install` installs them."
)]
pub struct ManArgs {
    /// Command, for example play or pack build [default: the program]
    #[arg(value_name = "COMMAND")]
    command: Vec<String>,
    /// List the commands that have a page, one per line
    #[arg(long, conflicts_with = "command")]
    list: bool,
}

/// Prints a page, or the commands that have one.
pub fn run(args: &ManArgs) -> anyhow::Result<()> {
    let mut root = command().disable_help_subcommand(true);
    // Gives pages their full names, and commands the global options.
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
    // The after-help would be filled like prose.
    let without_end = page.clone().after_help(None::<&str>);
    clap_mangen::Man::new(without_end).render(&mut text)?;
    let end = page.get_after_help().map(ToString::to_string);
    let end = ending(&end.unwrap_or_default());
    print(&(String::from_utf8(text)? + &end))
}

/// A command's after-help as sections of its page: the examples verbatim, then the notes.
fn ending(help: &str) -> String {
    let (examples, rest) = help.split_once("\n\n").unwrap_or((help, ""));
    let mut text = String::new();
    for (line, number) in examples.lines().zip(0..) {
        match number {
            0 => text.push_str(".SH EXAMPLES\n.nf\n"),
            _ => text.push_str(&format!("{}\n", escaped(line.trim_start()))),
        }
    }
    text.push_str(".fi\n");
    for (paragraph, number) in rest.split("\n\n").zip(0..) {
        let head = match number {
            _ if paragraph.is_empty() => continue,
            0 => ".SH NOTES",
            _ => ".PP",
        };
        text.push_str(&format!("{head}\n{}\n", escaped(paragraph)));
    }
    text
}

/// A line of text without troff commands.
fn escaped(line: &str) -> String {
    let text = line.replace('\\', "\\e").replace('-', "\\-");
    match text.starts_with(['.', '\'']) {
        true => format!("\\&{text}"),
        false => text,
    }
}

/// Writes the full names of all commands below `parent`.
fn list(parent: &Command, names: &str, text: &mut String) {
    for command in parent.get_subcommands().filter(|one| !one.is_hide_set()) {
        let names = format!("{names}{} ", command.get_name());
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", names.trim_end());
        list(command, &names, text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_stay_as_they_are_typed() {
        let page = ending("Examples:\n  a --b  c\n  .d\n\nOne.\n\nTwo.");
        let lines: Vec<_> = page.lines().collect();
        let expected = [
            ".SH EXAMPLES",
            ".nf",
            "a \\-\\-b  c",
            "\\&.d",
            ".fi",
            ".SH NOTES",
            "One.",
            ".PP",
            "Two.",
        ];
        assert_eq!(lines, expected);
        assert_eq!(escaped("a\\b"), "a\\eb");
    }
}
