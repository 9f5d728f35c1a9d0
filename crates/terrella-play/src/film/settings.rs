//! How the pictures of a film are made and kept.

use serde::{Deserialize, Serialize};
use terrella::{Hdr, HdrTransfer};

/// As what a picture is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PictureFormat {
    /// PNG with 8 bits a channel, dithered.
    #[default]
    Png,
    /// PNG with 16 bits a channel.
    Png16,
    /// OpenEXR with 32-bit floats: light, before exposure and tone curve.
    Exr,
    /// PNG with 16 bits a channel, of high dynamic range: BT.2020's primaries, codes of PQ.
    Pq,
    /// The same with codes of HLG.
    Hlg,
}

impl PictureFormat {
    /// The ending of its files.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Png | Self::Png16 | Self::Pq | Self::Hlg => "png",
            Self::Exr => "exr",
        }
    }

    /// How it codes light of high dynamic range; `None` for the others.
    pub fn hdr_transfer(self) -> Option<HdrTransfer> {
        match self {
            Self::Pq => Some(HdrTransfer::Pq),
            Self::Hlg => Some(HdrTransfer::Hlg),
            Self::Png | Self::Png16 | Self::Exr => None,
        }
    }
}

/// How long light is gathered for a picture: motion is blurred.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shutter {
    /// Part of the time from frame to frame in which it is open, from the frame's instant on; more than 0, at most 1.
    pub open: f64,
    /// How many instants, evenly spread over that time, are drawn and averaged.
    pub subframes: u32,
}

/// How the pictures of a film are made and kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PictureSettings {
    /// As what they are kept.
    pub format: PictureFormat,
    /// Whether space is transparent. EXR has its light premultiplied, as that format does, PNG straight, as that one does.
    pub alpha: bool,
    /// N of N × N pixels that are drawn for each; `None` is 1, and where light is averaged 2 for scenes with `samples` = 4.
    pub supersample: Option<u32>,
    /// How long light is gathered; `None` for an instant.
    pub shutter: Option<Shutter>,
    /// Luminance that highlights approach with [`PictureFormat::Pq`], cd/m², from [`Hdr::PEAKS_CD_M2`]; `None` is [`Hdr::USUAL_PEAK_CD_M2`].
    pub peak_cd_m2: Option<f64>,
}

impl PictureSettings {
    /// Most pixels along each side of one.
    pub const SUPERSAMPLES: [u32; 3] = [1, 2, 4];
    /// Instants of a picture.
    pub const MAX_SUBFRAMES: u32 = 256;

    /// Whether pictures are made of light, and not as a screen shows them.
    pub fn need_light(&self) -> bool {
        self.format != PictureFormat::Png
            || self.alpha
            || self.shutter.is_some()
            || self.supersample.is_some_and(|n| n > 1)
    }

    /// How pictures of high dynamic range are coded; `None` for other formats.
    pub fn hdr(&self) -> Option<Hdr> {
        let transfer = self.format.hdr_transfer()?;
        let peak_cd_m2 = self.peak_cd_m2.unwrap_or(Hdr::USUAL_PEAK_CD_M2);
        Some(Hdr {
            transfer,
            peak_cd_m2,
        })
    }

    /// Whether tracks, names and captions, which have display colours, stand over developed light.
    pub(super) fn take_overlay(&self) -> bool {
        self.format != PictureFormat::Exr && !self.alpha
    }

    /// The options by which others differ.
    pub fn differences(&self, other: &Self) -> impl Iterator<Item = &'static str> {
        let options = [
            ("--format", self.format != other.format),
            ("--alpha", self.alpha != other.alpha),
            ("--supersample", self.supersample != other.supersample),
            ("--shutter or --subframes", self.shutter != other.shutter),
            ("--peak", self.peak_cd_m2 != other.peak_cd_m2),
        ];
        let differing = options.into_iter().filter(|(_, differs)| *differs);
        differing.map(|(name, _)| name)
    }

    /// N of N × N pixels, for a scene with so many samples a pixel.
    pub fn pixels_a_side(&self, samples: u32) -> u32 {
        // As many samples as the scene asks for, each with its own light.
        self.supersample.unwrap_or(if samples > 1 { 2 } else { 1 })
    }

    /// Which parts of the time to the next frame are drawn, in the order of time.
    pub fn instants(&self) -> Vec<f64> {
        match self.shutter {
            None => vec![0.0],
            Some(Shutter { open, subframes }) => {
                let count = f64::from(subframes);
                (0..subframes)
                    .map(|n| open * (f64::from(n) + 0.5) / count)
                    .collect()
            }
        }
    }
}
