//! Suggestions for options and commands that users know from other programs.

use clap::Error;
use clap::error::{ContextKind, ContextValue, ErrorKind};

/// Unknown options, and suggestions for them.
const OPTIONS: &[(&str, &str)] = &[
    ("--fps", "set frame_rate_hz under [time] in the scene"),
    ("--framerate", "set frame_rate_hz under [time] in the scene"),
    (
        "--duration",
        "set duration_s under [time] in the scene, or render a part of the film with --range",
    ),
    ("--tle", "give the file as SCENE: terrella play my.tle"),
    ("--file", "give the file as SCENE: terrella play my.tle"),
    (
        "--dem",
        "list the file under elevation in [earth] of the scene",
    ),
    (
        "--elevation",
        "list the file under elevation in [earth] of the scene",
    ),
    (
        "--textures",
        "set textures under [earth] in the scene, or the environment variable TERRELLA_TEXTURES",
    ),
    ("--resolution", "use --size, for example --size 1920x1080"),
    ("--width", "use --size, for example --size 1920x1080"),
    ("--height", "use --size, for example --size 1920x1080"),
    ("--date", "use --at with `frame` and --start with `play`"),
    ("--time", "use --at with `frame` and --start with `play`"),
    (
        "--gpu",
        "use --adapter; `terrella doctor` lists the adapters",
    ),
    (
        "--device",
        "use --adapter; `terrella doctor` lists the adapters",
    ),
    (
        "--msaa",
        "set samples under [output] in the scene, or use --supersample",
    ),
    ("--motion-blur", "use --shutter"),
    ("--depth", "use --truth"),
    ("--out", "use --output, or -o"),
];

/// Unknown commands, and suggestions for them.
const COMMANDS: &[(&str, &str)] = &[
    ("render", "terrella frame SCENE -o OUT.png"),
    ("image", "terrella frame SCENE -o OUT.png"),
    ("picture", "terrella frame SCENE -o OUT.png"),
    ("still", "terrella frame SCENE -o OUT.png"),
    ("screenshot", "terrella frame SCENE -o OUT.png"),
    ("video", "terrella play SCENE --video FILE.mp4"),
    ("film", "terrella play SCENE --video FILE.mp4"),
    ("movie", "terrella play SCENE --video FILE.mp4"),
    ("view", "terrella play SCENE"),
    ("show", "terrella play SCENE"),
    ("run", "terrella play SCENE"),
    ("open", "terrella play SCENE"),
    ("validate", "terrella check SCENE"),
    ("lint", "terrella check SCENE"),
    ("passes", "terrella orbit SCENE --passes LAT,LON"),
    ("propagate", "terrella orbit SCENE"),
    ("download", "terrella pack fetch SOURCE -o DIR"),
    ("fetch", "terrella pack fetch SOURCE -o DIR"),
    ("adapters", "terrella doctor"),
    ("gpus", "terrella doctor"),
    ("completion", "terrella completions SHELL"),
];

/// The error, with a tip where the unknown option or command is one of these.
pub fn added_to(mut error: Error) -> Error {
    let (kind, table) = match error.kind() {
        ErrorKind::UnknownArgument => (ContextKind::InvalidArg, OPTIONS),
        ErrorKind::InvalidSubcommand => (ContextKind::InvalidSubcommand, COMMANDS),
        _ => return error,
    };
    let Some(ContextValue::String(word)) = error.get(kind) else {
        return error;
    };
    let found = table.iter().find(|(known, _)| known == word);
    if let Some((_, advice)) = found {
        let advice = ContextValue::StyledStrs(vec![(*advice).into()]);
        error.insert(ContextKind::Suggested, advice);
        // Names that are only spelled alike would distract.
        for alike in [ContextKind::SuggestedArg, ContextKind::SuggestedSubcommand] {
            error.remove(alike);
        }
    }
    error
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command;

    fn message(args: &[&str]) -> String {
        let error = command().try_get_matches_from(args);
        added_to(error.expect_err("bad usage")).to_string()
    }

    #[test]
    fn unknown_words_are_answered_by_their_meaning() {
        for (option, advice) in OPTIONS {
            let said = message(&["terrella", "check", option]);
            assert!(said.contains(advice), "{option}: {said}");
        }
        for (name, advice) in COMMANDS {
            let said = message(&["terrella", name]);
            assert!(said.contains(advice), "{name}: {said}");
        }
        assert!(!message(&["terrella", "xyzzy"]).contains("tip"));
    }
}
