//! The moving picture at the top of README.md: four shots from the space station, an animated WebP.

use crate::process::{self, repository_root};
use anyhow::{Context, Result, ensure};
use std::path::Path;
use std::process::Command;

/// Name below docs/.
pub const NAME: &str = "terrella.webp";
const SCENE: &str = "config/iss.toml";
/// Sun glint off Central America, cloud bands over the South Atlantic, Italy to the Nile under a full Moon, dawn off California.
const SHOTS: [&str; 4] = [
    "2018-01-14T13:06:40Z",
    "2018-01-14T13:24:00Z",
    "2018-01-31T21:37:20Z",
    "2018-01-14T14:35:10Z",
];
/// Of each shot: simulated seconds, and the film's frames: two and a half seconds at thirty times real time.
const DURATION_S: u32 = 75;
const SPEED: u32 = 30;
const FRAME_RATE_HZ: u32 = 12;
const SIZE: &str = "640x360";
/// Writes frames as one animated WebP.
const ANIMATE: &str = "xtask/src/pictures/animate.py";

/// Renders the shots and writes the picture.
pub fn draw(terrella: &Path, path: &Path) -> Result<()> {
    let folder = tempfile::tempdir().context("no temporary folder")?;
    let mut animate = Command::new("python3");
    let frame_ms = (1000 / FRAME_RATE_HZ).to_string();
    animate
        .arg(repository_root().join(ANIMATE))
        .arg(path)
        .arg(frame_ms);
    for (n, start) in SHOTS.iter().enumerate() {
        let frames = folder.path().join(n.to_string());
        let mut play = Command::new(terrella);
        play.current_dir(repository_root())
            .args(["--quiet", "play", SCENE, "--start", start, "--size", SIZE])
            .args(["--duration", &DURATION_S.to_string()])
            .args(["--set", &format!("time.speed={SPEED}")])
            .args(["--set", &format!("time.frame_rate_hz={FRAME_RATE_HZ}")])
            .arg("--frames")
            .arg(&frames);
        process::run(&mut play)?;
        animate.arg(frames);
    }
    process::run(&mut animate)?;
    let bytes = path
        .metadata()
        .with_context(|| path.display().to_string())?;
    ensure!(bytes.len() > 0, "{} is empty", path.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_readme_begins_with_the_moving_picture() {
        let root = repository_root();
        let readme = std::fs::read_to_string(root.join("README.md")).expect("a README");
        let first = readme.lines().find(|line| line.starts_with("!["));
        let is_its = |line: &str| line.ends_with(&format!("](docs/{NAME})"));
        assert!(first.is_some_and(is_its), "{first:?}");
        let bytes = std::fs::read(root.join("docs").join(NAME)).expect("the picture");
        assert_eq!((&bytes[..4], &bytes[8..12]), (&b"RIFF"[..], &b"WEBP"[..]));
        let frames = bytes.windows(4).filter(|word| word == b"ANMF").count();
        let per_shot = DURATION_S * FRAME_RATE_HZ / SPEED;
        assert_eq!(frames, SHOTS.len() * per_shot as usize);
        assert!(bytes.len() < 1_500_000, "{}", bytes.len());
    }
}
