//! The command line of the benchmark.

use std::path::PathBuf;

/// The course of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Course {
    Orbit,
    /// Once round the Earth in so many seconds.
    Spin {
        turn_s: f64,
    },
}

impl Course {
    pub fn name(self) -> &'static str {
        match self {
            Self::Orbit => "orbit",
            Self::Spin { .. } => "spin",
        }
    }
}

/// Imagery of a flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawn {
    /// The pack's tiles.
    Tiles,
    /// Its coarsest maps alone.
    WholeMaps,
}

impl Drawn {
    pub fn name(self) -> &'static str {
        match self {
            Self::Tiles => "with tiles",
            Self::WholeMaps => "without tiles",
        }
    }
}

pub struct Arguments {
    pub pack: Option<PathBuf>,
    pub tiles: Vec<Drawn>,
    pub texture_mb: f64,
    pub upload_mb: f64,
    pub size: (u32, u32),
    /// `orbit` or `spin`; both where it is empty.
    pub flight: String,
    pub turn_s: f64,
    pub seconds: Option<f64>,
    pub storage: String,
    pub frames: Option<PathBuf>,
}

impl Arguments {
    /// From the command line; arguments added by cargo are skipped.
    pub fn read() -> Self {
        let mut read = Self {
            pack: None,
            tiles: vec![Drawn::WholeMaps, Drawn::Tiles],
            texture_mb: 512.0,
            upload_mb: 4.0,
            size: (640, 360),
            flight: String::new(),
            turn_s: 20.0,
            seconds: None,
            storage: "auto".into(),
            frames: None,
        };
        let mut words = std::env::args().skip(1).filter(|word| word != "--bench");
        while let Some(word) = words.next() {
            let mut value = || {
                words
                    .next()
                    .unwrap_or_else(|| panic!("{word} needs a value"))
            };
            let number = |text: String| -> f64 {
                text.parse()
                    .unwrap_or_else(|_| panic!("{word} needs a number, not {text}"))
            };
            match word.as_str() {
                "--pack" => read.pack = Some(value().into()),
                "--texture-mb" => read.texture_mb = number(value()),
                "--upload-mb" => read.upload_mb = number(value()),
                "--turn-s" => read.turn_s = number(value()),
                "--seconds" => read.seconds = Some(number(value())),
                "--storage" => read.storage = value(),
                "--frames" => read.frames = Some(value().into()),
                "--size" => {
                    let text = value();
                    let size = text.split_once('x').and_then(|(width, height)| {
                        Some((width.parse().ok()?, height.parse().ok()?))
                    });
                    read.size = size.unwrap_or_else(|| panic!("--size needs WxH, not {text}"));
                }
                "--tiles" => {
                    read.tiles = match value().as_str() {
                        "both" => vec![Drawn::WholeMaps, Drawn::Tiles],
                        "with" => vec![Drawn::Tiles],
                        "without" => vec![Drawn::WholeMaps],
                        other => panic!("--tiles is both, with or without, not {other}"),
                    };
                }
                "--flight" => {
                    read.flight = value();
                    if !["orbit", "spin"].contains(&read.flight.as_str()) {
                        panic!("--flight is orbit or spin, not {}", read.flight);
                    }
                }
                // A filter for other benchmarks.
                _ if !word.starts_with('-') => {}
                _ => panic!("unknown argument {word}; see the first lines of benches/streaming.rs"),
            }
        }
        read
    }

    pub fn courses(&self) -> Vec<Course> {
        let all = [
            Course::Orbit,
            Course::Spin {
                turn_s: self.turn_s,
            },
        ];
        let is_meant = |course: &Course| self.flight.is_empty() || self.flight == course.name();
        all.into_iter().filter(is_meant).collect()
    }
}
