//! Examples at the end of every command's help.

use clap::Command;

/// A command line and its meaning.
type Example = (&'static str, &'static str);

/// The examples of each command, by its full name; those of the program itself are under "".
const EXAMPLES: &[(&str, &[Example])] = &[
    (
        "",
        &[
            (
                "terrella play",
                "the view from the space station, in a window",
            ),
            ("terrella frame my.tle -o a.png", "render one image"),
            ("terrella play my.tle --video a.mp4", "write a film"),
        ],
    ),
    (
        "play",
        &[
            ("terrella play", "the space station in a window"),
            (
                "terrella play my.tle --start now",
                "a satellite of an orbit file, now",
            ),
            ("terrella play a.toml --video a.mp4", "a film"),
            (
                "terrella play my.tle --start now --duration 400 --set caption.text={time} --video a.mp4",
                "a captioned film",
            ),
            (
                "terrella play a.toml --frames film --range 0..240",
                "240 PNG files",
            ),
            (
                "terrella play a.toml --frames film --resume",
                "the frames that are missing",
            ),
        ],
    ),
    (
        "serve",
        &[
            ("terrella serve", "serve simulations on the default port"),
            (
                "terrella serve --listen tcp://127.0.0.1:5556 --once",
                "serve one simulation, then exit",
            ),
        ],
    ),
    (
        "frame",
        &[
            (
                "terrella frame -o iss.png",
                "the view from the space station",
            ),
            (
                "terrella frame my.tle --at now --size 1920x1080 -o a.png",
                "a satellite's view, now",
            ),
            (
                "terrella frame a.toml -o a.png --truth truth",
                "an image with ground truth per pixel",
            ),
            (
                "terrella frame a.toml -o a.png --raw raw.tiff --truth truth",
                "a sensor's raw frame with its truth",
            ),
            (
                "terrella frame a.toml --format exr -o a.exr",
                "linear light",
            ),
        ],
    ),
    (
        "bench",
        &[
            (
                "terrella bench a.toml --json old.json",
                "measure and record",
            ),
            (
                "terrella bench a.toml --baseline old.json --repeats 3",
                "compare; exit code 3 if slower",
            ),
        ],
    ),
    (
        "new",
        &[
            ("terrella new mission", "write mission.toml"),
            ("terrella new films/pass.toml", "in a folder that is there"),
        ],
    ),
    (
        "check",
        &[
            ("terrella check a.toml", "what the scene uses and ignores"),
            (
                "terrella check a.toml --all",
                "with every key that a scene can have",
            ),
            (
                "terrella check my.tle --strict",
                "reject an orbit file with a bad record",
            ),
        ],
    ),
    (
        "access",
        &[
            (
                "terrella access config/stations.toml --days 1",
                "when stations have a satellite in view",
            ),
            (
                "terrella access a.toml --crosslinks --max-range 5000 --csv",
                "a table that includes accesses between satellites",
            ),
        ],
    ),
    (
        "coverage",
        &[
            (
                "terrella coverage my.tle --days 1 --half-angle 30",
                "how often a sensor sees each latitude in a day",
            ),
            (
                "terrella coverage a.toml --region 5,44,12,48 --step 0.5 --csv",
                "a row for each cell of a region",
            ),
        ],
    ),
    (
        "elements",
        &[(
            "terrella elements fetch 25544",
            "the space station's elements, in 25544.tle",
        )],
    ),
    (
        "elements fetch",
        &[
            (
                "terrella elements fetch 25544",
                "the space station's elements, in 25544.tle",
            ),
            (
                "terrella elements fetch --group gps-ops -o gps.tle",
                "the satellites of GPS",
            ),
        ],
    ),
    (
        "orbit",
        &[
            (
                "terrella orbit my.tle --at now --frame geodetic",
                "where the satellite is",
            ),
            (
                "terrella orbit a.toml --every 10 --csv",
                "a table of states",
            ),
            (
                "terrella orbit my.tle --passes 48.2,16.4 --days 3",
                "passes over a place",
            ),
            (
                "terrella orbit a.toml --all --oem all.oem",
                "ephemerides as a CCSDS message",
            ),
        ],
    ),
    (
        "doctor",
        &[
            ("terrella doctor", "the adapters and their limits"),
            (
                "terrella doctor --adapter llvmpipe",
                "fail if there is no such adapter",
            ),
        ],
    ),
    (
        "report",
        &[
            (
                "terrella report a.toml -o out --quick",
                "error against run time, in minutes",
            ),
            (
                "terrella report a.toml -o out --quality",
                "a quality ladder for this adapter",
            ),
        ],
    ),
    (
        "terrain",
        &[
            (
                "terrella terrain alps.tif",
                "the structures on an elevation file",
            ),
            (
                "terrella terrain --fractal 2049 --csv",
                "the same on fractal terrain, as CSV",
            ),
        ],
    ),
    (
        "pack",
        &[
            (
                "terrella pack fetch blue_marble -o earth",
                "download maps, build a pack",
            ),
            ("terrella pack info earth", "list its contents"),
        ],
    ),
    (
        "pack build",
        &[
            (
                "terrella pack build --day day.tif -o earth",
                "a pack of one map",
            ),
            (
                "terrella pack build --day day.tif --elevation dem.tif --water sea.png -o earth",
                "with slopes and water",
            ),
        ],
    ),
    (
        "pack fetch",
        &[
            ("terrella pack fetch --list", "the sources and their terms"),
            (
                "terrella pack fetch blue_marble@2004-06 -o earth",
                "the map of June",
            ),
            (
                "terrella pack fetch blue_marble --dry-run",
                "print the size of the download only",
            ),
            (
                "terrella pack fetch terrarium --region 5,44,12,48 --heights alps.tif",
                "elevation of a region",
            ),
        ],
    ),
    (
        "pack info",
        &[(
            "terrella pack info earth",
            "the contents of the pack `earth`",
        )],
    ),
    (
        "pack verify",
        &[(
            "terrella pack verify earth",
            "read every tile of the pack `earth`",
        )],
    ),
    (
        "pack preview",
        &[(
            "terrella pack preview earth -o sheet.png",
            "a contact sheet of the pack `earth`",
        )],
    ),
    (
        "completions",
        &[
            (
                "terrella completions bash > ~/.local/share/bash-completion/completions/terrella",
                "for bash",
            ),
            (
                "terrella completions zsh > ~/.zfunc/_terrella",
                "for zsh, if fpath has ~/.zfunc",
            ),
        ],
    ),
    (
        "man",
        &[
            ("terrella man pack build | man -l -", "read a page"),
            ("terrella man --list", "the commands that have one"),
        ],
    ),
];

/// Adds each command's examples before the rest of its after-help.
pub fn added_to(root: Command) -> Command {
    EXAMPLES
        .iter()
        .fold(root, |root, (path, examples)| at(root, path, examples))
}

/// Adds the examples of one command. Commands that this build omits are skipped.
fn at(command: Command, path: &str, examples: &[Example]) -> Command {
    if path.is_empty() {
        return with(command, examples);
    }
    let (name, rest) = path.split_once(' ').unwrap_or((path, ""));
    if command.find_subcommand(name).is_none() {
        return command;
    }
    command.mut_subcommand(name, |child| at(child, rest, examples))
}

fn with(command: Command, examples: &[Example]) -> Command {
    /// The meaning of a longer command line goes on the next line.
    const LONGEST: usize = 60;
    let lengths = examples.iter().map(|(line, _)| line.len());
    let width = lengths.filter(|length| *length <= LONGEST).max();
    let width = width.unwrap_or_default();
    let mut text = "Examples:".to_owned();
    for (line, does) in examples {
        match line.len() <= LONGEST {
            true => text.push_str(&format!("\n  {line:width$}  {does}")),
            false => text.push_str(&format!("\n  {line}\n    {does}")),
        }
    }
    if let Some(after) = command.get_after_help() {
        text.push_str(&format!("\n\n{after}"));
    }
    command.after_help(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command;

    /// All commands by their full names.
    fn names(parent: &Command, before: &str, all: &mut Vec<String>) {
        for child in parent.get_subcommands() {
            let name = format!("{before}{}", child.get_name());
            all.push(name.clone());
            names(child, &format!("{name} "), all);
        }
    }

    #[test]
    fn every_command_has_examples() {
        let mut all = vec![String::new()];
        names(&command(), "", &mut all);
        for name in &all {
            let found = EXAMPLES.iter().find(|(path, _)| path == name);
            assert!(found.is_some_and(|(_, some)| !some.is_empty()), "{name:?}");
        }
        if cfg!(all(feature = "measure", feature = "pack")) {
            assert_eq!(all.len(), EXAMPLES.len());
        }
    }

    #[test]
    fn examples_are_of_their_command_and_can_be_typed() {
        let is_left_out = |path: &str| {
            let first = path.split(' ').next().unwrap_or_default();
            !path.is_empty() && command().find_subcommand(first).is_none()
        };
        for (path, examples) in EXAMPLES.iter().filter(|(path, _)| !is_left_out(path)) {
            for (line, does) in *examples {
                let own = line.split(['|', '>']).next().expect("a first part");
                let words: Vec<_> = own.split_whitespace().collect();
                assert!(
                    own.starts_with(format!("terrella {path}").trim_end()),
                    "{line}"
                );
                if let Err(error) = command().try_get_matches_from(words) {
                    panic!("{line}: {error}");
                }
                assert!(
                    !does.is_empty() && line.len().max(60) + does.len() < 110,
                    "{line}"
                );
            }
        }
    }
}
