//! Options of written images: their format, and the light that they store.

use super::values;
use clap::{Args, ValueEnum};
use terrella_play::{PictureFormat, PictureSettings, Shutter};

/// Default number of averaged instants for an open shutter.
const DEFAULT_SUBFRAMES: u32 = 16;

/// Options of pictures that are written.
#[derive(Clone, Copy, Debug, Args)]
pub struct PictureArgs {
    /// Image format [default: png]
    #[arg(long, value_enum)]
    pub format: Option<Format>,
    /// Transparent space, without stars, Sun or Moon; PNG stores straight alpha, EXR premultiplied alpha
    #[arg(long)]
    pub alpha: bool,
    /// Render N × N samples per pixel and average their light: 1, 2 or 4 [default: 1; 2 where light is averaged and the scene has
    /// samples = 4]
    #[arg(long, value_name = "N", value_parser = values::supersample)]
    pub supersample: Option<u32>,
    /// Motion blur: average the light over this fraction of the frame interval, from the frame's time on; 0.5 is a film camera's 180°
    /// shutter
    #[arg(long, value_name = "PART", value_parser = values::shutter)]
    pub shutter: Option<f64>,
    /// With --shutter: number of times that are averaged, 1 to 256 [default: 16]
    #[arg(long, value_name = "N", requires = "shutter", value_parser = clap::value_parser!(u32).range(
        1..=i64::from(PictureSettings::MAX_SUBFRAMES)
    ))]
    pub subframes: Option<u32>,
    /// With --format pq: luminance that the brightest highlights approach, 400 to 10000 cd/m² [default: 1000]
    #[arg(long, value_name = "CD_M2")]
    pub peak: Option<f64>,
}

/// The image format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// PNG, 8 bits per channel, sRGB, dithered
    Png,
    /// PNG, 16 bits per channel, sRGB
    Png16,
    /// OpenEXR, 32-bit floats: linear light before exposure and tone mapping; a white surface that faces the Sun in space is 1
    Exr,
    /// High dynamic range: PNG, 16 bits per channel, BT.2020 with PQ (SMPTE ST 2084); reference white is 203 cd/m². Videos have 10 bits
    Pq,
    /// The same with HLG
    Hlg,
}

impl PictureArgs {
    /// The settings that these options select.
    pub fn settings(&self) -> PictureSettings {
        PictureSettings {
            format: match self.format {
                None | Some(Format::Png) => PictureFormat::Png,
                Some(Format::Png16) => PictureFormat::Png16,
                Some(Format::Exr) => PictureFormat::Exr,
                Some(Format::Pq) => PictureFormat::Pq,
                Some(Format::Hlg) => PictureFormat::Hlg,
            },
            alpha: self.alpha,
            supersample: self.supersample,
            shutter: self.shutter.map(|open| Shutter {
                open,
                subframes: self.subframes.unwrap_or(DEFAULT_SUBFRAMES),
            }),
            peak_cd_m2: self.peak,
        }
    }

    /// The first of them that is given, by its name.
    pub fn first_given(&self) -> Option<&'static str> {
        [
            ("--format", self.format.is_some()),
            ("--alpha", self.alpha),
            ("--supersample", self.supersample.is_some()),
            ("--shutter", self.shutter.is_some()),
            ("--peak", self.peak.is_some()),
        ]
        .into_iter()
        .find_map(|(name, is_given)| is_given.then_some(name))
    }
}
