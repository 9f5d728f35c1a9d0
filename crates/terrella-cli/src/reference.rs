//! `docs/reference/command.md`: all commands and their options, made from their declarations.

use super::command;
use clap::{Arg, Command};
use std::fmt::Write;

const HEAD: &str = "# Commands

<!-- Made from the declarations in crates/terrella-cli/src:
     TERRELLA_UPDATE_REFERENCE=1 cargo test -p terrella-cli reference -->

Every command, with its arguments, options and defaults. `terrella COMMAND --help` prints the same, and `terrella man COMMAND` the man page.
[command.md](../command.md) is the introduction, and [scene-reference.md](../scene-reference.md) lists the keys of scenes.

";

/// The page. A table of commands comes first, then the global options, then each command.
fn page() -> String {
    let mut root = command().disable_help_subcommand(true);
    // Names the usage of commands after the program, and hands them the global options.
    root.build();
    let mut page = HEAD.to_owned();
    page.push_str("| command | does |\n|---|---|\n");
    walk(&root, "", &mut |name, one| {
        let link = name.replace(' ', "-");
        let about = text(one.get_about());
        line(
            &mut page,
            &format!("| [`{name}`](#terrella-{link}) | {about} |"),
        );
    });
    page.push_str("\n## Global options\n\nEvery command has these.\n\n");
    page.push_str(&options(&root, true));
    page.push_str(&ending(&root, "terrella"));
    walk(&root, "", &mut |name, one| {
        let about = text(one.get_long_about().or(one.get_about()));
        page.push_str(&format!("\n## `terrella {name}`\n\n"));
        for paragraph in about.split("\n\n") {
            page.push_str(&format!("{}.\n\n", paragraph.trim_end_matches('.')));
        }
        let usage = one.clone().render_usage().to_string();
        let usage = usage.trim_start_matches("Usage:").trim();
        page.push_str(&format!("```text\n{usage}\n```\n"));
        if !one.has_subcommands() {
            page.push('\n');
            page.push_str(&options(one, false));
        }
        page.push_str(&ending(one, &format!("terrella {name}")));
    });
    page
}

/// Visits all commands below `parent`, with their full names.
fn walk(parent: &Command, names: &str, visit: &mut impl FnMut(&str, &Command)) {
    for one in parent.get_subcommands().filter(|one| !one.is_hide_set()) {
        let name = format!("{names}{}", one.get_name());
        visit(&name, one);
        walk(one, &format!("{name} "), visit);
    }
}

/// The table of a command's arguments and options, global or its own. Empty if there are none.
fn options(command: &Command, are_global: bool) -> String {
    let is_listed = |arg: &&Arg| {
        let is_usual = ["help", "version"].contains(&arg.get_id().as_str());
        !is_usual && !arg.is_hide_set() && arg.is_global_set() == are_global
    };
    let args: Vec<_> = command.get_arguments().filter(is_listed).collect();
    if args.is_empty() {
        return String::new();
    }
    // Arguments first, as they are typed.
    let (arguments, options): (Vec<_>, Vec<_>) = args.into_iter().partition(|a| a.is_positional());
    let mut table = "| option | default | meaning |\n|---|---|---|\n".to_owned();
    for arg in arguments.into_iter().chain(options) {
        let (default, meaning) = default_and_meaning(arg);
        let default = match default.as_str() {
            "" => " ".to_owned(),
            default => format!(" {default} "),
        };
        let names = name(arg);
        line(&mut table, &format!("| `{names}` |{default}| {meaning} |"));
    }
    table
}

/// An option as it is typed: `-o, --output <FILE>`.
fn name(arg: &Arg) -> String {
    // clap's own text, without the mark of repetition.
    let text = arg.to_string();
    let text = text.trim_end_matches("...").replace('|', "\\|");
    match (arg.get_short(), arg.get_long()) {
        (Some(short), Some(_)) => format!("-{short}, {text}"),
        _ => text,
    }
}

/// The default, declared or in the help's own `[default: …]`, and the rest of the help with the values to choose from.
fn default_and_meaning(arg: &Arg) -> (String, String) {
    let help = text(arg.get_long_help().or(arg.get_help()));
    let (mut meaning, said) = match help.split_once(" [default: ") {
        Some((before, rest)) => {
            let (default, after) = rest.split_once(']').unwrap_or((rest, ""));
            (format!("{before}{after}"), default.to_owned())
        }
        None => (help, String::new()),
    };
    let takes_value = arg.get_action().takes_values();
    let declared: Vec<_> = arg
        .get_default_values()
        .iter()
        .map(|value| value.to_string_lossy())
        .collect();
    let default = match declared.join(",") {
        declared if takes_value && !declared.is_empty() => format!("`{declared}`"),
        _ => said,
    };
    let values = arg.get_possible_values();
    let values: Vec<_> = values.iter().filter(|_| takes_value).map(value).collect();
    if !values.is_empty() {
        meaning = format!("{meaning}: {}", values.join(", "));
    }
    (default, meaning.replace('|', "\\|"))
}

/// A value to choose, with its help.
fn value(value: &clap::builder::PossibleValue) -> String {
    match text(value.get_help()).as_str() {
        "" => format!("`{}`", value.get_name()),
        help => format!("`{}` ({help})", value.get_name()),
    }
}

/// The text below a command's options: its examples, then its notes.
fn ending(command: &Command, name: &str) -> String {
    let help = text(command.get_after_help());
    let (examples, notes) = help.split_once("\n\n").unwrap_or((&help, ""));
    let examples: Vec<_> = examples
        .lines()
        .skip(1)
        .map(|line| line.strip_prefix("  "))
        .collect();
    let examples: Vec<_> = examples.into_iter().flatten().collect();
    assert!(!examples.is_empty(), "{name} has no examples");
    let mut text = format!("\n```text\n{}\n```\n", examples.join("\n"));
    for note in notes.split("\n\n").filter(|note| !note.is_empty()) {
        let _ = writeln!(text, "\n{note}");
    }
    text
}

fn text(styled: Option<&clap::builder::StyledStr>) -> String {
    styled.map(ToString::to_string).unwrap_or_default()
}

fn line(page: &mut String, text: &str) {
    let _ = writeln!(page, "{text}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(all(feature = "measure", feature = "pack"))]
    fn the_reference_page_is_that_of_the_declarations() {
        use std::path::Path;
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/command.md");
        let page = page();
        if std::env::var_os("TERRELLA_UPDATE_REFERENCE").is_some() {
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
            std::fs::write(&path, &page).expect("written");
        }
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            committed == page,
            "docs/reference/command.md is not what the declarations say; run `TERRELLA_UPDATE_REFERENCE=1 cargo test -p terrella-cli reference`"
        );
    }

    #[test]
    fn every_option_is_in_the_table_of_its_command() {
        let page = page();
        let mut root = command().disable_help_subcommand(true);
        root.build();
        walk(&root, "", &mut |name, one| {
            let section = page.split(&format!("\n## `terrella {name}`\n")).nth(1);
            let section = section.and_then(|rest| rest.split("\n## ").next());
            let section = section.unwrap_or_else(|| panic!("no section of {name}"));
            let long = one.get_arguments().filter(|arg| !arg.is_global_set());
            for option in long
                .filter_map(Arg::get_long)
                .filter(|long| *long != "help")
            {
                assert!(section.contains(&format!("--{option}")), "{name}: {option}");
            }
        });
        assert!(
            page.contains("| `-v, --verbose` |")
                && page.contains("| `--encoder <ENCODER>` | `auto` |")
        );
    }
}
