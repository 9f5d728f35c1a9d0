//! PNG and JPEG files as texels, by the decoders that the `image` crate uses. Used without that crate, which would bring an engine
//! for colour profiles.

use super::colour::Said;
use super::jpeg::{self, Fault};
use std::fmt;
use std::io::Cursor;
use terrella_files::printable;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Most that a decoder may hold, bytes: 32 768 × 16 384 texels of four bytes.
const MAX_DECODED_BYTES: usize = 1 << 31;

const PNG_SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
const JPEG_SIGNATURE: &[u8] = &[0xFF, 0xD8, 0xFF];

/// Format of a file, from its first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FileKind {
    Png,
    Jpeg,
}

impl FileKind {
    pub fn of(contents: &[u8]) -> Option<Self> {
        match contents {
            _ if contents.starts_with(PNG_SIGNATURE) => Some(Self::Png),
            _ if contents.starts_with(JPEG_SIGNATURE) => Some(Self::Jpeg),
            _ => None,
        }
    }
}

/// Content of a texel: 1…4 channels (grey, grey and alpha, colour, colour and alpha) of 8 or 16 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TexelKind {
    pub channels: u8,
    pub bits: u8,
}

impl TexelKind {
    pub fn grey(bits: u8) -> Self {
        Self { channels: 1, bits }
    }
}

impl fmt::Display for TexelKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let channels = match self.channels {
            1 => "grey",
            2 => "grey and alpha",
            3 => "colour",
            _ => "colour and alpha",
        };
        write!(f, "{}-bit {channels}", self.bits)
    }
}

/// A file whose header is read and whose texels are not.
pub(super) enum Picture<'a> {
    Png(Box<png::Reader<Cursor<&'a [u8]>>>),
    Jpeg {
        contents: &'a [u8],
        size: (u32, u32),
        color: ColorSpace,
    },
}

impl<'a> Picture<'a> {
    /// Reads the header. The error is the decoder's message.
    pub fn open(kind: FileKind, contents: &'a [u8]) -> Result<Self, String> {
        match kind {
            FileKind::Png => {
                let limits = png::Limits {
                    bytes: MAX_DECODED_BYTES,
                };
                let mut decoder = png::Decoder::new_with_limits(Cursor::new(contents), limits);
                // Palettes become colour, few bits become eight, a transparent colour becomes alpha.
                decoder.set_transformations(png::Transformations::EXPAND);
                let reader = decoder.read_info().map_err(one_line)?;
                Ok(Self::Png(Box::new(reader)))
            }
            FileKind::Jpeg => {
                let mut decoder =
                    JpegDecoder::new_with_options(ZCursor::new(contents), jpeg_options());
                decoder.decode_headers().map_err(one_line)?;
                let (size, color) = decoder
                    .info()
                    .zip(decoder.input_colorspace())
                    .ok_or("it has no header")?;
                Ok(Self::Jpeg {
                    contents,
                    size: (size.width.into(), size.height.into()),
                    color: match color {
                        ColorSpace::Luma | ColorSpace::LumaA => color,
                        ColorSpace::RGB | ColorSpace::RGBA => color,
                        // Inks and differences of colours are made light by the decoder.
                        _ => ColorSpace::RGB,
                    },
                })
            }
        }
    }

    /// Walks a JPEG to its end, and returns the file's colour metadata. Its size must have been checked before.
    pub fn check_whole(&self) -> Result<Said, String> {
        match self {
            // Its checksums are looked at as its texels are read.
            Self::Png(reader) => Ok(Said::of_png(reader.info())),
            Self::Jpeg { contents, .. } => jpeg::check(*contents).map_err(|fault| match fault {
                Fault::Damaged(cause) => cause,
                Fault::Read(error) => one_line(error),
            }),
        }
    }

    /// Width and height, texels.
    pub fn size(&self) -> (u32, u32) {
        match self {
            Self::Png(reader) => reader.info().size(),
            Self::Jpeg { size, .. } => *size,
        }
    }

    pub fn texel_kind(&self) -> TexelKind {
        match self {
            Self::Png(reader) => {
                let (color, depth) = reader.output_color_type();
                TexelKind {
                    channels: color.samples() as u8,
                    bits: depth as u8,
                }
            }
            Self::Jpeg { color, .. } => TexelKind {
                channels: color.num_components() as u8,
                bits: 8,
            },
        }
    }

    /// The same, a JPEG's colours with an alpha of 255.
    pub fn with_alpha(self) -> Self {
        match self {
            Self::Jpeg {
                contents,
                size,
                color: ColorSpace::RGB,
            } => Self::Jpeg {
                contents,
                size,
                color: ColorSpace::RGBA,
            },
            other => other,
        }
    }

    /// Row-major texels; 16-bit ones with the high byte first. The size must have been checked before: memory is allocated here. The error is the
    /// decoder's message.
    pub fn texels(self) -> Result<Vec<u8>, String> {
        let ((width, height), kind) = (self.size(), self.texel_kind());
        let texel_bytes = usize::from(kind.channels) * usize::from(kind.bits) / 8;
        let mut texels = vec![0; width as usize * height as usize * texel_bytes];
        match self {
            Self::Png(mut reader) => {
                reader.next_frame(&mut texels).map_err(one_line)?;
                // The rest must be complete too: checksums and the end chunk.
                reader.finish().map_err(one_line)?;
            }
            Self::Jpeg {
                contents, color, ..
            } => {
                let options = jpeg_options().jpeg_set_out_colorspace(color);
                JpegDecoder::new_with_options(ZCursor::new(contents), options)
                    .decode_into(&mut texels)
                    .map_err(one_line)?;
            }
        }
        Ok(texels)
    }

    /// The texels row by row from the north, as far as they are complete.
    pub fn rows(self, mut take: impl FnMut(&[u8])) -> Result<(), String> {
        let (width, kind) = (self.size().0 as usize, self.texel_kind());
        let row_bytes = width * usize::from(kind.channels) * usize::from(kind.bits) / 8;
        match self {
            Self::Png(mut reader) if !reader.info().interlaced => {
                while let Some(row) = reader.next_row().map_err(one_line)? {
                    take(row.data());
                }
                // The rest must be complete too: checksums and the end chunk.
                reader.finish().map_err(one_line)
            }
            whole => {
                whole.texels()?.chunks_exact(row_bytes).for_each(take);
                Ok(())
            }
        }
    }
}

/// A file that is not whole has been rejected before by [`super::jpeg`]; the size is checked by who opens a file, by limits of its
/// own.
fn jpeg_options() -> DecoderOptions {
    DecoderOptions::default()
        .set_strict_mode(false)
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX)
}

/// A decoder's message, on one line.
fn one_line(error: impl fmt::Display) -> String {
    let text = error.to_string();
    printable(&text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// The size that a PNG declares, read from its header (always the first chunk) because the decoder's error for a size that is too large does not
/// contain it.
pub(super) fn png_size(contents: &[u8]) -> Option<(u32, u32)> {
    let rest = contents.strip_prefix(PNG_SIGNATURE)?;
    let header = rest.get(4..)?.strip_prefix(b"IHDR")?;
    let width = u32::from_be_bytes(*header.first_chunk()?);
    let height = u32::from_be_bytes(*header.get(4..)?.first_chunk()?);
    Some((width, height))
}
