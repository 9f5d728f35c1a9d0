//! Texels as numbers that may be averaged, and back: colour as linear light, everything else as it is stored.

use crate::source::sample;
use crate::source::{SampleKind, SourceInfo};
use terrella_imagery::srgb::{LINEAR_FROM_SRGB, SrgbEncoder, linear_from_encoded};

/// Encoding of elevations as colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Encoding {
    /// Metres are red × 256 + green + blue / 256 − 32 768 (Tilezen's Joerd, `docs/formats.md`). Black has no height.
    Terrarium,
    /// Metres are (red × 65 536 + green × 256 + blue) / 10 − 10 000 (Mapbox Terrain-RGB).
    Mapbox,
}

/// Format and meaning of a mosaic's texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TexelKind {
    /// 1 or 3.
    pub channels: usize,
    /// Number format of each channel.
    pub sample: SampleKind,
}

impl TexelKind {
    /// Of a raster's texels, alpha left away.
    pub(super) fn of(info: &SourceInfo, encoding: Option<Encoding>) -> Self {
        match encoding {
            Some(Encoding::Terrarium | Encoding::Mapbox) => Self {
                channels: 1,
                sample: SampleKind::F32,
            },
            None => Self {
                channels: if info.channels >= 3 { 3 } else { 1 },
                sample: info.sample,
            },
        }
    }

    /// Whether its values are linear light.
    pub(super) fn is_colour(self) -> bool {
        self.channels == 3
    }

    /// Largest stored value.
    fn full(self) -> f32 {
        match self.sample {
            SampleKind::U8 => 255.0,
            SampleKind::U16 => 65_535.0,
            SampleKind::I16 | SampleKind::F32 => 1.0,
        }
    }
}

/// Reads texels of a raster as values of a mosaic.
pub(super) struct Reader {
    from: TexelKind,
    to: TexelKind,
    encoding: Option<Encoding>,
    /// Linear light of 16-bit codes.
    linear: Vec<f32>,
    no_data: Option<Vec<f32>>,
    /// Factors of the channels.
    gains: [f32; 3],
}

impl Reader {
    /// Of texels of one kind, which may be grey where the mosaic is coloured.
    pub(super) fn new(
        from: TexelKind,
        to: TexelKind,
        encoding: Option<Encoding>,
        no_data: Option<&[f64]>,
        gains: [f32; 3],
    ) -> Self {
        let is_wide = to.is_colour() && from.sample == SampleKind::U16;
        let linear = (0..if is_wide { 65_536_u32 } else { 0 })
            .map(|code| linear_from_encoded(f64::from(code) / 65_535.0) as f32)
            .collect();
        Self {
            from,
            to,
            encoding,
            linear,
            // Stored numbers are compared, so 32 bits do.
            no_data: no_data.map(|values| values.iter().map(|value| *value as f32).collect()),
            gains,
        }
    }

    /// Whether bytes may be copied without conversion.
    pub(super) fn is_plain(&self) -> bool {
        self.from == self.to
            && self.encoding.is_none()
            && self.no_data.is_none()
            && self.gains == [1.0; 3]
    }

    /// Fills values and weights of a row from its texels and their cover, 255 where it is there.
    pub(super) fn read(&self, bytes: &[u8], cover: &[u8], values: &mut [f32], weights: &mut [f32]) {
        let channels = self.from.channels;
        let out = self.to.channels;
        for (x, (texel, weight)) in values.chunks_exact_mut(out).zip(weights).enumerate() {
            *weight = f32::from(cover[x]) / 255.0;
            if *weight == 0.0 {
                texel.fill(0.0);
                continue;
            }
            let at = |channel: usize| {
                sample(
                    self.from.sample,
                    bytes,
                    x * channels + channel.min(channels - 1),
                )
            };
            if self.no_data.as_ref().is_some_and(|no_data| {
                let of = |n: usize| no_data.get(n).or(no_data.last());
                (0..channels).all(|n| of(n) == Some(&at(n)))
            }) {
                *weight = 0.0;
                texel.fill(0.0);
                continue;
            }
            match self.encoding {
                // Black would be -32 768 m: tiles without data are black.
                Some(Encoding::Terrarium) if (0..3).all(|channel| at(channel) == 0.0) => {
                    texel[0] = f32::NAN;
                }
                Some(Encoding::Terrarium) => {
                    texel[0] = at(0) * 256.0 + at(1) + at(2) / 256.0 - 32_768.0;
                }
                Some(Encoding::Mapbox) => {
                    texel[0] = (at(0) * 65_536.0 + at(1) * 256.0 + at(2)) / 10.0 - 10_000.0;
                }
                None if self.to.is_colour() => {
                    for (channel, value) in texel.iter_mut().enumerate() {
                        *value = self.light(at(channel)) * self.gains[channel];
                    }
                }
                None => texel[0] = at(0) * self.gains[0],
            }
            if texel.iter().any(|value| !value.is_finite()) {
                *weight = 0.0;
                texel.fill(0.0);
            }
        }
    }

    fn light(&self, code: f32) -> f32 {
        // A code is whole and in range.
        match self.from.sample {
            SampleKind::U8 => LINEAR_FROM_SRGB[code as u8 as usize],
            SampleKind::U16 => self.linear[code as u16 as usize],
            SampleKind::I16 | SampleKind::F32 => linear_from_encoded(f64::from(code)) as f32,
        }
    }
}

/// Writes values of a mosaic as its texels.
pub(super) struct Writer {
    kind: TexelKind,
    encoder: SrgbEncoder,
    fill: Vec<f32>,
}

impl Writer {
    /// Where there is nothing, `fill` is written as it would be stored.
    pub(super) fn new(kind: TexelKind, fill: Option<&[f64]>) -> Self {
        let nothing = if kind.sample == SampleKind::F32 {
            f32::NAN
        } else {
            0.0
        };
        let fill = (0..kind.channels).map(|channel| {
            let of = |fill: &[f64]| fill.get(channel).or(fill.last()).copied();
            fill.and_then(of).map_or(nothing, |value| value as f32)
        });
        Self {
            kind,
            encoder: SrgbEncoder::new(),
            fill: fill.collect(),
        }
    }

    /// Fills a row of bytes.
    pub(super) fn write(&self, values: &[f32], weights: &[f32], row: &mut [u8]) {
        let Self { kind, .. } = self;
        let size = kind.channels * kind.sample.bytes();
        let texels = values.chunks_exact(kind.channels).zip(weights);
        for ((values, weight), bytes) in texels.zip(row.chunks_exact_mut(size)) {
            for (channel, bytes) in bytes.chunks_exact_mut(kind.sample.bytes()).enumerate() {
                let is_there = *weight > 0.0;
                let value = if is_there {
                    values[channel]
                } else {
                    self.fill[channel]
                };
                if is_there && kind.is_colour() && kind.sample == SampleKind::U8 {
                    bytes[0] = self.encoder.code(value);
                    continue;
                }
                let value = if is_there && kind.is_colour() {
                    encoded_from_linear(value) * kind.full()
                } else {
                    value
                };
                store(kind.sample, value, bytes);
            }
        }
    }
}

/// E = 12.92 C for C ≤ 0.0031308, else 1.055 C^(1/2.4) − 0.055.
fn encoded_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

fn store(kind: SampleKind, value: f32, bytes: &mut [u8]) {
    // `as` saturates and takes NaN to 0.
    match kind {
        SampleKind::U8 => bytes[0] = value.round() as u8,
        SampleKind::U16 => bytes.copy_from_slice(&(value.round() as u16).to_ne_bytes()),
        SampleKind::I16 => bytes.copy_from_slice(&(value.round() as i16).to_ne_bytes()),
        SampleKind::F32 => bytes.copy_from_slice(&value.to_ne_bytes()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLOUR: TexelKind = TexelKind {
        channels: 3,
        sample: SampleKind::U8,
    };

    fn read(reader: &Reader, bytes: &[u8], cover: &[u8], channels: usize) -> (Vec<f32>, Vec<f32>) {
        let (mut values, mut weights) = (vec![9.0; cover.len() * channels], vec![9.0; cover.len()]);
        reader.read(bytes, cover, &mut values, &mut weights);
        (values, weights)
    }

    #[test]
    fn every_code_comes_back() {
        for sample in [SampleKind::U8, SampleKind::U16] {
            for channels in [1, 3] {
                let kind = TexelKind { channels, sample };
                let codes: Vec<u16> = if sample == SampleKind::U8 {
                    (0..=255).collect()
                } else {
                    (0..=65_535).step_by(257).collect()
                };
                let bytes: Vec<u8> = codes
                    .iter()
                    .flat_map(|code| vec![*code; channels])
                    .flat_map(|code| match sample {
                        SampleKind::U8 => vec![code as u8],
                        _ => code.to_ne_bytes().to_vec(),
                    })
                    .collect();
                let reader = Reader::new(kind, kind, None, None, [1.0; 3]);
                let cover = vec![255; codes.len()];
                let (values, weights) = read(&reader, &bytes, &cover, channels);
                let mut back = vec![0; bytes.len()];
                Writer::new(kind, None).write(&values, &weights, &mut back);
                assert_eq!(back, bytes, "{kind:?}");
            }
        }
    }

    #[test]
    fn what_is_not_there_has_no_weight_and_is_filled() {
        let reader = Reader::new(COLOUR, COLOUR, None, Some(&[1.0, 2.0, 3.0]), [1.0; 3]);
        assert!(!reader.is_plain());
        let bytes = [1, 2, 3, 1, 2, 4, 9, 9, 9];
        let (values, weights) = read(&reader, &bytes, &[255, 255, 0], 3);
        assert_eq!(weights, [0.0, 1.0, 0.0]);
        let mut back = [0; 9];
        Writer::new(COLOUR, Some(&[7.0, 8.0, 9.0])).write(&values, &weights, &mut back);
        assert_eq!(back, [7, 8, 9, 1, 2, 4, 7, 8, 9]);
    }

    #[test]
    fn heights_are_read_from_colours() {
        let heights = TexelKind {
            channels: 1,
            sample: SampleKind::F32,
        };
        let reader = Reader::new(COLOUR, heights, Some(Encoding::Terrarium), None, [1.0; 3]);
        // The example of the format's own page: 2523.265625 m.
        let texels = [137, 219, 68, 128, 0, 0, 0, 0, 0];
        let (values, weights) = read(&reader, &texels, &[255; 3], 1);
        assert_eq!(values, [2_523.265_6, 0.0, 0.0]);
        // Black is a tile without data, not one 32 768 m deep.
        assert_eq!(weights, [1.0, 1.0, 0.0]);
    }

    #[test]
    fn gains_act_on_light() {
        let reader = Reader::new(COLOUR, COLOUR, None, None, [2.0, 1.0, 0.5]);
        let (values, weights) = read(&reader, &[100, 100, 100], &[255], 3);
        let light = LINEAR_FROM_SRGB[100];
        assert_eq!(values, [2.0 * light, light, 0.5 * light]);
        let mut back = [0; 3];
        Writer::new(COLOUR, None).write(&values, &weights, &mut back);
        assert!(back[0] > 130 && back[1] == 100 && back[2] < 80, "{back:?}");
    }
}
