//! A map's texels as numbers that may be averaged: linear light, cover, slopes.

use super::error::BuildError;
use super::source::{FileContext, FileKind, RowSource, SampleKind, SourceInfo, sample};
use std::path::Path;
use terrella_imagery::slopes::{ELEVATION_OFFSET_M, SlopeRows, pole_fade};
use terrella_imagery::srgb::linear_from_encoded;

/// Heights beyond this are marks for "no data", metres.
const HIGHEST_M: f64 = 20_000.0;

/// The usual value for "no data" that is within the range.
const NO_DATA: f32 = -9999.0;

/// Meaning of a map's texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    /// sRGB colour to linear light: three values.
    Colour,
    /// Grey, or the luminance of colour, 0…1: one value.
    Amount,
    /// A tangent-space normal map to slopes: two values.
    Normals,
    /// Elevations to slopes: two values.
    Elevation {
        /// Offset that is subtracted, metres; `None`: the default of the file format.
        offset_m: Option<f64>,
        /// How many times steeper than the truth.
        exaggeration: f64,
    },
}

impl Meaning {
    /// Values of a texel.
    pub(super) fn channels(self) -> usize {
        match self {
            Self::Colour => 3,
            Self::Amount => 1,
            Self::Normals | Self::Elevation { .. } => 2,
        }
    }

    /// Rejects texels that cannot mean this.
    fn check(self, info: &SourceInfo, context: &FileContext) -> Result<(), BuildError> {
        use SampleKind::{F32, I16, U8, U16};
        let (fits, needed) = match self {
            Self::Colour => (
                matches!(info.sample, U8 | U16),
                "a day map needs 8- or 16-bit sRGB colour or grey",
            ),
            Self::Amount => (
                matches!(info.sample, U8 | U16 | F32),
                "this map needs 8- or 16-bit or float (0 to 1) grey or colour",
            ),
            Self::Normals => (
                matches!(info.sample, U8 | U16) && info.channels >= 3,
                "a normal map needs 8- or 16-bit RGB (for heights use --elevation)",
            ),
            Self::Elevation { .. } => (
                matches!(info.sample, U16 | I16 | F32) && info.channels <= 2,
                "elevations need 16-bit or float grey",
            ),
        };
        if fits {
            return Ok(());
        }
        let colour = if info.channels >= 3 { "colour" } else { "grey" };
        Err(context.rejected(
            format!("holds {} {colour} texels", info.sample),
            format!("{needed}: convert it"),
        ))
    }
}

/// The rows of a map as numbers, from north to south.
pub(super) struct ValueRows {
    source: Box<dyn RowSource>,
    info: SourceInfo,
    bytes: Vec<u8>,
    convert: Convert,
}

enum Convert {
    Colour {
        /// Linear light of every code.
        linear: Vec<f32>,
    },
    Amount,
    Normals {
        given: u32,
    },
    Elevation(Heights),
}

struct Heights {
    offset_m: f64,
    slopes: SlopeRows,
    heights_m: Vec<f64>,
    taken: u32,
    saturated_texels: u64,
    /// Number of samples of [`NO_DATA`] in a file that does not declare it.
    undeclared: u64,
}

impl ValueRows {
    /// For a source whose texels must have this meaning; `path` is its name in messages.
    pub(super) fn new(
        source: Box<dyn RowSource>,
        meaning: Meaning,
        path: &Path,
    ) -> Result<Self, BuildError> {
        let info = source.info();
        meaning.check(&info, &FileContext::new(path))?;
        let convert = match meaning {
            Meaning::Colour => {
                let codes = 1u32 << (8 * info.sample.bytes());
                let linear = (0..codes)
                    .map(|code| linear_from_encoded(f64::from(code) / f64::from(codes - 1)) as f32)
                    .collect();
                Convert::Colour { linear }
            }
            Meaning::Amount => Convert::Amount,
            Meaning::Normals => Convert::Normals { given: 0 },
            Meaning::Elevation {
                offset_m,
                exaggeration,
            } => Convert::Elevation(Heights {
                offset_m: offset_m.unwrap_or_else(|| usual_offset_m(&info)),
                slopes: SlopeRows::new(info.width as usize, info.height as usize, exaggeration),
                heights_m: vec![0.0; info.width as usize],
                taken: 0,
                saturated_texels: 0,
                undeclared: 0,
            }),
        };
        Ok(Self {
            bytes: vec![0; info.row_bytes()],
            source,
            info,
            convert,
        })
    }

    /// Slopes beyond ±1 so far.
    pub(super) fn saturated_texels(&self) -> u64 {
        match &self.convert {
            Convert::Elevation(heights) => heights.saturated_texels,
            _ => 0,
        }
    }

    /// Remarks about omitted parts of the map, for reports.
    pub(super) fn notes(&mut self) -> Vec<String> {
        let mut notes = self.source.notes();
        if let Convert::Elevation(heights) = &mut self.convert {
            let count = std::mem::take(&mut heights.undeclared);
            notes.extend((count > 0).then(|| {
                format!(
                    "{count} elevations are {NO_DATA}, which the file does not declare as no data (`gdal_edit.py -a_nodata`): they are \
                     taken for no data"
                )
            }));
        }
        notes
    }

    /// Fills the next row: width × channels values.
    pub(super) fn next_row(&mut self, out: &mut [f32]) -> Result<(), BuildError> {
        let Self {
            source,
            info,
            bytes,
            convert,
        } = self;
        match convert {
            Convert::Elevation(heights) => {
                // One row ahead: a slope needs the row south of it.
                let mut texels = out.as_chunks_mut::<2>().0.iter_mut();
                let mut saturated = 0;
                let mut store = |slope: [f64; 2]| {
                    if let Some(texel) = texels.next() {
                        saturated += u64::from(slope.iter().any(|s| s.abs() > 1.0));
                        *texel = slope.map(|s| s as f32);
                    }
                };
                if heights.taken == 0 {
                    source.next_row(bytes)?;
                    heights.read(info, bytes);
                    heights.slopes.push(&heights.heights_m, |_| {});
                    heights.taken = 1;
                }
                if heights.taken == info.height {
                    heights.slopes.finish(&mut store);
                } else {
                    source.next_row(bytes)?;
                    heights.read(info, bytes);
                    heights.slopes.push(&heights.heights_m, &mut store);
                    heights.taken += 1;
                }
                heights.saturated_texels += saturated;
            }
            Convert::Colour { linear } => {
                source.next_row(bytes)?;
                read_colour(info, bytes, linear, out);
            }
            Convert::Amount => {
                source.next_row(bytes)?;
                read_amount(info, bytes, out);
            }
            Convert::Normals { given } => {
                source.next_row(bytes)?;
                let latitude_deg =
                    90.0 - (f64::from(*given) + 0.5) * 180.0 / f64::from(info.height);
                read_normals(info, bytes, pole_fade(latitude_deg) as f32, out);
                *given += 1;
            }
        }
        Ok(())
    }
}

/// 16-bit PNGs cannot hold depths below zero and have [`ELEVATION_OFFSET_M`] added.
fn usual_offset_m(info: &SourceInfo) -> f64 {
    if info.file == FileKind::Png {
        f64::from(ELEVATION_OFFSET_M)
    } else {
        0.0
    }
}

fn read_colour(info: &SourceInfo, bytes: &[u8], linear: &[f32], out: &mut [f32]) {
    let (texels, _) = out.as_chunks_mut::<3>();
    let grey = info.channels < 3;
    let of = |samples: &[usize]| {
        if grey {
            [linear[samples[0]]; 3]
        } else {
            [linear[samples[0]], linear[samples[1]], linear[samples[2]]]
        }
    };
    if info.sample == SampleKind::U8 {
        for (texel, samples) in texels.iter_mut().zip(bytes.chunks_exact(info.channels)) {
            let last = samples.len() - 1;
            let at = |n: usize| usize::from(samples[n.min(last)]);
            *texel = of(&[at(0), at(1), at(2)]);
        }
    } else {
        let (pairs, _) = bytes.as_chunks::<2>();
        for (texel, samples) in texels.iter_mut().zip(pairs.chunks_exact(info.channels)) {
            let last = samples.len() - 1;
            let at = |n: usize| usize::from(u16::from_ne_bytes(samples[n.min(last)]));
            *texel = of(&[at(0), at(1), at(2)]);
        }
    }
    clear_nothing::<3>(info, bytes, out);
}

/// Sets texels to 0 that are transparent.
fn clear_nothing<const C: usize>(info: &SourceInfo, bytes: &[u8], out: &mut [f32]) {
    if info.opacity.is_some() {
        let (texels, _) = out.as_chunks_mut::<C>();
        for (x, texel) in texels.iter_mut().enumerate() {
            if is_nothing(info, bytes, x) {
                *texel = [0.0; C];
            }
        }
    }
}

/// Whether a texel is transparent.
fn is_nothing(info: &SourceInfo, bytes: &[u8], x: usize) -> bool {
    info.opacity.is_some() && sample(info.sample, bytes, (x + 1) * info.channels - 1) == 0.0
}

/// The alpha of a sample, 0…1.
pub(super) fn opaque_part(kind: SampleKind, bytes: &[u8], index: usize) -> f32 {
    let full = match kind {
        SampleKind::U8 => 255.0,
        SampleKind::U16 => 65_535.0,
        SampleKind::I16 => 32_767.0,
        SampleKind::F32 => 1.0,
    };
    let part = sample(kind, bytes, index) / full;
    if part.is_nan() {
        0.0
    } else {
        part.clamp(0.0, 1.0)
    }
}

/// Luminance weights of ITU-R BT.709, on values as they are stored.
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

fn read_amount(info: &SourceInfo, bytes: &[u8], out: &mut [f32]) {
    let full = match info.sample {
        SampleKind::U8 => 255.0,
        SampleKind::U16 => 65_535.0,
        SampleKind::I16 | SampleKind::F32 => 1.0,
    };
    for (x, value) in out.iter_mut().enumerate() {
        let at = |channel: usize| sample(info.sample, bytes, x * info.channels + channel) / full;
        let amount = if info.channels < 3 {
            at(0)
        } else {
            LUMINANCE[0] * at(0) + LUMINANCE[1] * at(1) + LUMINANCE[2] * at(2)
        };
        // Alpha is how much of it there is.
        let part = match info.opacity {
            Some(_) => opaque_part(info.sample, bytes, (x + 1) * info.channels - 1),
            None => 1.0,
        };
        *value = if amount.is_nan() {
            // Missing data is zero.
            0.0
        } else {
            amount.clamp(0.0, 1.0) * part
        };
    }
}

/// The normal of a surface z(east, north) is proportional to (−dz/d east, −dz/d north, 1); 128 (of 16 bits, 32 768) represents 0.
fn read_normals(info: &SourceInfo, bytes: &[u8], fade: f32, out: &mut [f32]) {
    let (zero, full) = if info.sample == SampleKind::U8 {
        (128.0, 127.0)
    } else {
        (32_768.0, 32_767.0)
    };
    let (texels, _) = out.as_chunks_mut::<2>();
    for (x, texel) in texels.iter_mut().enumerate() {
        let at = |channel: usize| {
            (sample(info.sample, bytes, x * info.channels + channel) - zero) / full
        };
        // A wall or an overhang is as steep as can be stored.
        let up = at(2).max(0.01);
        *texel = [0, 1].map(|channel| (-at(channel) / up).clamp(-1.0, 1.0) * fade);
    }
    clear_nothing::<2>(info, bytes, out);
}

impl Heights {
    fn read(&mut self, info: &SourceInfo, bytes: &[u8]) {
        for (x, height_m) in self.heights_m.iter_mut().enumerate() {
            let stored = sample(info.sample, bytes, x * info.channels);
            let value = f64::from(stored) - self.offset_m;
            let is_undeclared = stored == NO_DATA && info.opacity.is_none();
            self.undeclared += u64::from(is_undeclared);
            *height_m = if value.abs() <= HIGHEST_M && !is_undeclared && !is_nothing(info, bytes, x)
            {
                value
            } else {
                f64::NAN
            };
        }
    }
}
