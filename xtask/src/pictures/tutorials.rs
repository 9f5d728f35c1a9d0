//! The images of the pages of docs/start/, drawn from the scenes and orbits on these pages.

use super::{frame, sheet};
use crate::cargo;
use crate::process;
use anyhow::{Context, Result, bail, ensure};
use image::{RgbImage, imageops};
use std::path::Path;
use std::process::Command;

const WIDTH_PX: u32 = 640;

/// The image of a page, from parts in two columns, or from one part.
pub struct Tutorial {
    /// Name of the page without its extension.
    page: &'static str,
    parts: &'static [Part],
}

/// A part of an image.
enum Part {
    /// `terrella frame` with these arguments, of a file that the page writes, or of the built-in scene.
    Frame(&'static str, &'static [&'static str]),
    /// A truth layer that the previous part has written, from black at its smallest value to white.
    Layer(&'static str),
    /// The image of the host `examples/minimal.rs`.
    Host,
}

use Part::{Frame, Host, Layer};

/// The images in the order of the pages.
pub const ALL: &[Tutorial] = &[
    Tutorial {
        page: "first-still",
        parts: &[Frame("", &[])],
    },
    Tutorial {
        page: "my-satellite",
        parts: &[Frame("my.tle", &["--at", "2018-01-21T15:19:00Z"])],
    },
    Tutorial {
        page: "film",
        parts: &[
            Frame("fall.toml", &[]),
            Frame("fall.toml", &["--at", "2018-06-21T09:30:50Z"]),
            Frame("fall.toml", &["--at", "2018-06-21T09:31:20Z"]),
            Frame("fall.toml", &["--at", "2018-06-21T09:31:57Z"]),
        ],
    },
    Tutorial {
        page: "data-set",
        parts: &[
            Frame("look.toml", &["--at", "2018-03-20T04:00:00Z"]),
            Layer("range_m"),
            Layer("land"),
            Layer("cloud_cover"),
        ],
    },
    Tutorial {
        page: "own-renderer",
        parts: &[Host],
    },
];

impl Tutorial {
    /// Name of the image below docs/.
    pub fn picture(&self) -> String {
        format!("start/{}.jpg", self.page)
    }

    /// Draws the image into the documentation's folder.
    pub fn draw(&self, terrella: &Path, docs: &Path) -> Result<()> {
        let folder = tempfile::tempdir().context("no temporary folder")?;
        let folder = folder.path();
        let page = docs.join(format!("start/{}.md", self.page));
        let page = std::fs::read_to_string(&page).with_context(|| page.display().to_string())?;
        for (name, text) in files(&page) {
            std::fs::write(folder.join(name), text).with_context(|| name.to_owned())?;
        }
        let columns = if self.parts.len() == 1 { 1 } else { 2 };
        let (width, height) = (WIDTH_PX / columns, WIDTH_PX / columns * 9 / 16);
        let mut parts = Vec::new();
        for part in self.parts {
            let drawn = match part {
                Frame(scene, more) => {
                    let picture = folder.join("part.png");
                    let more = [more, &["--truth", "truth"][..]].concat();
                    frame(terrella, folder, scene, (width, height), &more, &picture)?;
                    sheet::read(&picture)?
                }
                Layer(name) => {
                    let path = folder.join(format!("truth/{name}.npy"));
                    let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
                    grey(&bytes, (width, height)).with_context(|| path.display().to_string())?
                }
                Host => {
                    let host = host(folder)?;
                    imageops::resize(&host, width, height, imageops::FilterType::Triangle)
                }
            };
            parts.push(drawn);
        }
        sheet::write(
            &sheet::together(&parts, columns),
            sheet::WHOLE,
            &docs.join(self.picture()),
        )
    }
}

/// Name and text of the files that a page's shell blocks write.
fn files(page: &str) -> Vec<(&str, &str)> {
    let parts = page.split("\ncat > ").skip(1);
    let files = parts.filter_map(|part| {
        let (name, rest) = part.split_once(" <<'END'\n")?;
        Some((name, rest.split_once("\nEND\n")?.0))
    });
    files.collect()
}

/// A layer of 32-bit floats in grey; black where there is no value.
fn grey(npy: &[u8], (width, height): (u32, u32)) -> Result<RgbImage> {
    // Version 1 of the format: ten bytes, the last two of them the length of the header.
    let header = npy.get(8..10).context("no NumPy array")?;
    let header = usize::from(u16::from_le_bytes([header[0], header[1]]));
    let Some(bytes) = npy.get(10 + header..) else {
        bail!("the NumPy array ends in its header");
    };
    let (values, rest) = bytes.as_chunks::<4>();
    let values: Vec<_> = values
        .iter()
        .map(|bytes| f32::from_le_bytes(*bytes))
        .collect();
    let count = u64::from(width) * u64::from(height);
    ensure!(
        rest.is_empty() && values.len() as u64 == count,
        "not {width} × {height} 32-bit floats"
    );
    let known = values.iter().copied().filter(|value| value.is_finite());
    let (least, most) = known.fold((f32::MAX, f32::MIN), |(least, most), value| {
        (least.min(value), most.max(value))
    });
    let span = (most - least).max(f32::MIN_POSITIVE);
    Ok(RgbImage::from_fn(width, height, |x, y| {
        let value = values[(y * width + x) as usize];
        // A cast of NaN is 0.
        image::Rgb([((value - least) / span * 255.0) as u8; 3])
    }))
}

/// Runs the host in a folder and reads its picture.
fn host(folder: &Path) -> Result<RgbImage> {
    // Builds the whole workspace, like the tests, so that nothing is compiled twice.
    let built = cargo::build(&["build", "--locked", "--workspace", "--example", "minimal"])?;
    let program = built
        .example
        .context("cargo did not say where the example is")?;
    process::run(Command::new(program).current_dir(folder))?;
    let path = folder.join("out/minimal.ppm");
    let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
    ppm(&bytes).with_context(|| format!("{}: not the host's picture", path.display()))
}

/// The image of a binary PPM with a one-line header.
fn ppm(bytes: &[u8]) -> Option<RgbImage> {
    let end = bytes.iter().position(|byte| *byte == b'\n')?;
    let header = std::str::from_utf8(&bytes[..end]).ok()?;
    let mut words = header.strip_prefix("P6 ")?.split(' ');
    let mut size = || words.next()?.parse().ok();
    RgbImage::from_raw(size()?, size()?, bytes[end + 1..].to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::process::repository_root;

    #[test]
    fn every_page_has_its_picture_and_the_scenes_in_it() {
        let docs = repository_root().join("docs");
        let pages = std::fs::read_dir(docs.join("start")).unwrap();
        let pages = pages.filter(|page| page.as_ref().unwrap().path().extension().unwrap() == "md");
        assert_eq!(pages.count(), ALL.len());
        for tutorial in ALL {
            let page = docs.join(format!("start/{}.md", tutorial.page));
            let page = std::fs::read_to_string(page).unwrap();
            assert!(page.contains(&format!("]({}.jpg)", tutorial.page)));
            let written = files(&page);
            for part in tutorial.parts {
                if let Frame(scene, _) = part {
                    let is_there = written.iter().any(|(name, _)| name == scene);
                    assert!(is_there || scene.is_empty(), "{scene}");
                }
            }
            let picture = docs.join(tutorial.picture());
            let bytes = picture.metadata().unwrap().len();
            assert!(bytes < 120_000, "{}: {bytes} bytes", picture.display());
            assert_eq!(sheet::read(&picture).unwrap().width(), WIDTH_PX);
        }
    }

    #[test]
    fn files_of_a_page_are_taken_from_its_shell_blocks() {
        let page = "```sh\ncat > a.toml <<'END'\nb\nc\nEND\nls\n```\n";
        assert_eq!(files(page), [("a.toml", "b\nc")]);
    }

    #[test]
    fn layers_are_grey_between_their_extremes() {
        let mut npy = b"\x93NUMPY\x01\x00\x02\x00{}".to_vec();
        for value in [2.0_f32, 3.0, f32::NAN, 4.0] {
            npy.extend(value.to_le_bytes());
        }
        let picture = grey(&npy, (2, 2)).unwrap();
        let values: Vec<_> = picture.pixels().map(|pixel| pixel.0[0]).collect();
        assert_eq!(values, [0, 127, 0, 255]);
        assert!(grey(&npy, (2, 3)).is_err() && grey(&npy[..9], (2, 2)).is_err());
    }

    #[test]
    fn a_hosts_picture_is_read() {
        let picture = ppm(b"P6 1 2 255\nabcdef").unwrap();
        assert_eq!(
            (picture.dimensions(), picture.as_raw().as_slice()),
            ((1, 2), &b"abcdef"[..])
        );
        assert!(ppm(b"P6 1 2 255\nabc").is_none() && ppm(b"P5 1 2 255\n").is_none());
    }
}
