//! Options of pictures that are written: their format, and what light they are made of.

use super::values;
use clap::{Args, ValueEnum};
use terrella_play::{PictureFormat, PictureSettings, Shutter};

/// Instants of a picture with an open shutter where their number is not given.
const DEFAULT_SUBFRAMES: u32 = 16;

/// Options of pictures that are written.
#[derive(Clone, Copy, Debug, Args)]
pub struct PictureArgs {
    /// As what pictures are kept. Default: png
    #[arg(long, value_enum)]
    pub format: Option<Format>,
    /// Space is transparent, and nothing beyond the Earth is drawn. PNG has its colours straight, EXR premultiplied
    #[arg(long)]
    pub alpha: bool,
    /// Draw N × N pixels for each and average their light: 1, 2 or 4. Default: 1; where light is averaged, 2 with samples = 4
    #[arg(long, value_name = "N", value_parser = values::supersample)]
    pub supersample: Option<u32>,
    /// Blur motion: average the light of this part of the time from frame to frame, from the frame's instant on; 0.5 is a film
    /// camera's shutter of 180°
    #[arg(long, value_name = "PART", value_parser = values::shutter)]
    pub shutter: Option<f64>,
    /// With --shutter: how many instants are averaged, 1 to 256. Default: 16
    #[arg(long, value_name = "N", requires = "shutter", value_parser = clap::value_parser!(u32).range(
        1..=i64::from(PictureSettings::MAX_SUBFRAMES)
    ))]
    pub subframes: Option<u32>,
}

/// As what pictures are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// PNG, 8 bits a channel, sRGB, dithered
    Png,
    /// PNG, 16 bits a channel, sRGB
    Png16,
    /// OpenEXR, 32-bit floats: light before exposure and tone curve, a white sheet that faces the Sun in space is 1
    Exr,
}

impl PictureArgs {
    /// What they say.
    pub fn settings(&self) -> PictureSettings {
        PictureSettings {
            format: match self.format {
                None | Some(Format::Png) => PictureFormat::Png,
                Some(Format::Png16) => PictureFormat::Png16,
                Some(Format::Exr) => PictureFormat::Exr,
            },
            alpha: self.alpha,
            supersample: self.supersample,
            shutter: self.shutter.map(|open| Shutter {
                open,
                subframes: self.subframes.unwrap_or(DEFAULT_SUBFRAMES),
            }),
        }
    }

    /// The first of them that is given, by its name.
    pub fn first_given(&self) -> Option<&'static str> {
        [
            ("--format", self.format.is_some()),
            ("--alpha", self.alpha),
            ("--supersample", self.supersample.is_some()),
            ("--shutter", self.shutter.is_some()),
        ]
        .into_iter()
        .find_map(|(name, is_given)| is_given.then_some(name))
    }
}
