//! `cargo xtask demo`: from a fresh machine to a picture, a video and a window.

use crate::cargo;
use crate::machine::{Display, display};
use crate::prepare::{self, Policy, Window};
use crate::process::{self, repository_root, say};
use anyhow::Context;
use std::path::Path;
use std::process::Command;

/// The scene of image and window.
const SCENE: &str = "config/iss.toml";
/// The scene of the video.
const FILM: &str = "config/revolution.toml";
/// Paths of the image and the video, from the repository's root.
const PICTURE: &str = "out/iss.png";
const VIDEO: &str = "out/iss.mp4";

/// The program without features that the demonstration omits: measurements and pack building.
const BUILD: [&str; 6] = [
    "build",
    "--release",
    "--locked",
    "--package",
    "terrella-cli",
    "--no-default-features",
];

/// Draws image and video, and opens the window if there is a display. `terrella` creates the command that starts the program.
fn draw(
    root: &Path,
    terrella: &dyn Fn() -> Command,
    open_window: bool,
    display: Display,
) -> anyhow::Result<()> {
    let command = || {
        let mut command = terrella();
        command.current_dir(root);
        command
    };
    std::fs::create_dir_all(root.join("out"))
        .with_context(|| format!("cannot make the folder {}", root.join("out").display()))?;
    process::run(command().args(["frame", SCENE, "-o", PICTURE]))?;
    process::run(command().args(["play", FILM, "--video", VIDEO]))?;
    for file in [PICTURE, VIDEO] {
        let path = root.join(file);
        let size_bytes = std::fs::metadata(&path)
            .with_context(|| format!("{} was to be written and is not there", path.display()))?
            .len();
        let size_kb = size_bytes.div_ceil(1000);
        say(format_args!("wrote {} ({size_kb} kB)", path.display()));
    }
    let mut in_window = command();
    in_window.args(["play", SCENE]);
    if open_window && display != Display::None {
        return process::run(&mut in_window);
    }
    if open_window {
        say("no window: neither DISPLAY nor WAYLAND_DISPLAY is set");
    }
    say(format_args!(
        "to fly it in a window, on a machine with a display: {}",
        process::shown(&in_window)
    ));
    Ok(())
}

/// Runs the whole demonstration.
pub fn run(policy: Policy, open_window: bool) -> anyhow::Result<()> {
    let window = if open_window {
        Window::IfDisplay
    } else {
        Window::Never
    };
    prepare::run(policy, window)?;
    let terrella = cargo::build(&BUILD)?
        .terrella
        .context("cargo built the program and did not say where it is")?;
    prepare::check_adapter(policy, &terrella)?;
    let display = display(&|name| std::env::var_os(name));
    draw(
        &repository_root(),
        &|| Command::new(&terrella),
        open_window,
        display,
    )
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::process::exit_code;
    use std::process::ExitCode;

    /// A substitute for the program: records its arguments, then runs `script`.
    fn stand_in(script: &str) -> impl Fn() -> Command {
        let script = format!("echo \"$@\" >> calls; {script}");
        move || {
            let mut command = Command::new("sh");
            // The word after the script is its $0.
            command.args(["-c", script.as_str(), "terrella"]);
            command
        }
    }

    fn calls(root: &Path) -> Vec<String> {
        let text = std::fs::read_to_string(root.join("calls")).unwrap();
        text.lines().map(str::to_string).collect()
    }

    const FRAME: &str = "frame config/iss.toml -o out/iss.png";
    const VIDEO_CALL: &str = "play config/revolution.toml --video out/iss.mp4";
    const WRITES: &str = "echo x > out/iss.png; echo x > out/iss.mp4";

    #[test]
    fn picture_video_and_window_in_this_order() {
        for (open_window, display, window) in [
            (true, Display::X11, true),
            (true, Display::None, false),
            (false, Display::X11, false),
        ] {
            let root = tempfile::tempdir().unwrap();
            let program = stand_in(WRITES);
            draw(root.path(), &program, open_window, display).unwrap();
            let mut expected = vec![FRAME, VIDEO_CALL];
            expected.extend(window.then_some("play config/iss.toml"));
            assert_eq!(calls(root.path()), expected);
        }
    }

    #[test]
    fn the_first_failure_ends_it_with_its_code() {
        let root = tempfile::tempdir().unwrap();
        let program = stand_in("exit 2");
        let error = draw(root.path(), &program, true, Display::X11).unwrap_err();
        assert_eq!(exit_code(&error), ExitCode::from(2));
        assert_eq!(calls(root.path()), [FRAME]);
    }

    #[test]
    fn a_program_that_writes_nothing_is_a_failure() {
        let root = tempfile::tempdir().unwrap();
        let program = stand_in("");
        let error = draw(root.path(), &program, false, Display::None).unwrap_err();
        assert!(format!("{error:#}").contains("iss.png"));
    }
}
