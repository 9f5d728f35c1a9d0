//! Replaces the simulators of scenes that wait for one: with states from standard input, or with a saved Basilisk flight.

use anyhow::{Context, Result, ensure};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

#[path = "../../../tests/common/basilisk.rs"]
mod basilisk;

/// The scenes that need a simulator for an image.
pub const WAITING: [&str; 2] = ["basilisk", "live"];

/// A state by day, as sent by a simulator that waits for its frame.
const STATE: &str = r#"{"message":"frame","seq":1,"epoch":"2018-01-15T17:30:00.000Z","frame":"GCRF","position_m":[6778137,0,0],"velocity_m_s":[0,6000,4775]}
"#;
const FLIGHT: &str = "flight.bin";
const STEPS: u64 = 60;
const STEP_S: f64 = 10.0;

/// A scene's text with another simulator: each key of `changed` with its new lines, or removed if they are empty.
fn replaced(text: &str, changed: &[(&str, &str)]) -> Result<String> {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for (key, line) in changed {
        let begins = format!("{key} = ");
        let place = lines.iter().position(|line| line.starts_with(&begins));
        let place = place.with_context(|| format!("the scene has no line {begins}"))?;
        lines[place] = (*line).to_owned();
    }
    Ok(lines.join("\n"))
}

/// Draws one of [`WAITING`] with a program into an image.
pub fn draw(
    terrella: &Path,
    config: &Path,
    name: &str,
    (width, height): (u32, u32),
    picture: &Path,
) -> Result<()> {
    let folder = picture.parent().context("a picture in no folder")?;
    let text = std::fs::read_to_string(config.join(format!("{name}.toml")))?;
    let (scene, sent) = match name {
        "live" => (live(&text, folder)?, STATE),
        _ => (saved(&text, folder)?, ""),
    };
    let mut child = Command::new(terrella)
        .args(["--quiet", "frame"])
        .arg(scene)
        .args(["--size", &format!("{width}x{height}"), "-o"])
        .arg(picture)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .with_context(|| terrella.display().to_string())?;
    if let Some(mut stdin) = child.stdin.take() {
        stdin.write_all(sent.as_bytes())?;
    }
    let status = child.wait()?;
    ensure!(status.success(), "config/{name}.toml: {status}");
    Ok(())
}

fn live(text: &str, folder: &Path) -> Result<PathBuf> {
    let changed = [
        ("listen", "listen = \"stdin\""),
        ("pacing", "pacing = \"lockstep\""),
        ("playback_delay_s", ""),
    ];
    written(&folder.join("live.toml"), &replaced(text, &changed)?)
}

fn saved(text: &str, folder: &Path) -> Result<PathBuf> {
    let steps = (0..STEPS).map(|n| step(n + 1, n as f64 * STEP_S));
    std::fs::write(
        folder.join(FLIGHT),
        basilisk::file(&steps.collect::<Vec<_>>()),
    )?;
    let file = format!("file = \"{FLIGHT}\"");
    let changed = [("listen", file.as_str()), ("timeout_s", "")];
    written(&folder.join("basilisk.toml"), &replaced(text, &changed)?)
}

fn written(path: &Path, text: &str) -> Result<PathBuf> {
    std::fs::write(path, text).with_context(|| path.display().to_string())?;
    Ok(path.to_owned())
}

/// A spacecraft on a circular orbit by day.
fn step(frame: u64, elapsed_s: f64) -> Vec<u8> {
    let (radius_m, rate) = (6.87e6, 0.0011);
    let (s, c) = (rate * elapsed_s + 0.6).sin_cos();
    // The direction across the node, inclined by 45°.
    let (y, z) = (0.7, 0.714);
    let mut parts = vec![
        basilisk::earth([0.0; 3], [0.0; 3], 7.292e-5 * elapsed_s + 0.5),
        basilisk::body("sun", [1.0e11, 1.0e11, 0.2e11]),
        basilisk::craft(
            "sat-1",
            [radius_m * c, y * radius_m * s, z * radius_m * s],
            [-s, y * c, z * c].map(|part| part * radius_m * rate),
            [0.0, 0.0, 0.2],
        ),
    ];
    if frame == 1 {
        parts.push(basilisk::epoch());
    }
    basilisk::message(frame, elapsed_s, &parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::process::repository_root;

    #[test]
    fn scenes_have_the_lines_that_are_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let text = |name: &str| {
            let path = repository_root().join(format!("config/{name}.toml"));
            std::fs::read_to_string(path).unwrap()
        };
        let live = live(&text("live"), folder.path()).unwrap();
        let live = std::fs::read_to_string(live).unwrap();
        assert!(live.contains("\nlisten = \"stdin\"\n") && !live.contains("udp:"));
        let saved = saved(&text("basilisk"), folder.path()).unwrap();
        let saved = std::fs::read_to_string(saved).unwrap();
        assert!(saved.contains("\nfile = \"flight.bin\"\n") && !saved.contains("\nlisten"));
        assert!(folder.path().join(FLIGHT).metadata().unwrap().len() > 10_000);
        assert!(replaced("a = 1", &[("b", "")]).is_err());
    }
}
