//! Decodes chunk filters (HDF5 File Format Specification, IV.A.2.l).

use super::source::{Fault, Fields};
use std::io::Read;

/// Maximum number of filters of a variable.
const MAX_FILTERS: u8 = 8;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Deflate,
    /// The first bytes of all values, then the second bytes, …
    Shuffle {
        bytes: usize,
    },
    Fletcher32,
    Zstd,
}

/// Filters in the order in which the writer applied them.
#[derive(Clone, Debug, Default)]
pub struct Filters(Vec<Kind>);

impl Filters {
    pub fn read(mut fields: Fields<'_>) -> Result<Self, Fault> {
        let (version, count) = (fields.byte()?, fields.byte()?);
        fields.take(if version == 1 { 6 } else { 0 })?;
        if count > MAX_FILTERS {
            return Err(fields.damaged("more than 8 filters"));
        }
        let mut filters = Vec::new();
        for _ in 0..count {
            let id = fields.short()?;
            let has_name = version == 1 || id >= 256;
            let name = if has_name { fields.short()? } else { 0 };
            fields.take(2)?;
            let values = fields.short()?;
            let name = fields.take(name)?;
            let mut of_filter = fields.part(4 * values)?;
            fields.take(if version == 1 && values % 2 == 1 {
                4
            } else {
                0
            })?;
            filters.push(match id {
                1 => Kind::Deflate,
                2 => Kind::Shuffle {
                    bytes: of_filter.word()? as usize,
                },
                3 => Kind::Fletcher32,
                32_015 => Kind::Zstd,
                _ => {
                    let name = match id {
                        4 => "szip".into(),
                        5 => "nbit".into(),
                        6 => "scaleoffset".into(),
                        307 => "bzip2".into(),
                        32_001 => "Blosc".into(),
                        _ => String::from_utf8_lossy(name),
                    };
                    let name = name.trim_end_matches('\0');
                    let cause = format!("is compressed by the HDF5 filter {id} ({name})");
                    return Err(Fault::Unsupported(cause));
                }
            });
        }
        Ok(Self(filters))
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Reverses all filters that were not skipped: bit n of `skipped` belongs to the nth filter.
    pub fn undo(&self, mut bytes: Vec<u8>, skipped: u32, most: usize) -> Result<Vec<u8>, Wrong> {
        for (n, kind) in self.0.iter().enumerate().rev() {
            if skipped >> n & 1 != 0 {
                continue;
            }
            bytes = match kind {
                Kind::Deflate => {
                    let decoder = flate2::bufread::ZlibDecoder::new(&bytes[..]);
                    inflated(decoder, most)
                        .map_err(|_| Wrong("a chunk that deflate cannot read"))?
                }
                Kind::Zstd => {
                    let decoder = zstd::Decoder::with_buffer(&bytes[..]);
                    let inflated = decoder.and_then(|decoder| inflated(decoder, most));
                    inflated.map_err(|_| Wrong("a chunk that ZSTD cannot read"))?
                }
                Kind::Shuffle { bytes: of_value } => unshuffled(&bytes, *of_value),
                Kind::Fletcher32 => {
                    let end = bytes.len().saturating_sub(4);
                    let stored = bytes.get(end..).and_then(<[u8]>::first_chunk).copied();
                    let stored = stored.map(u32::from_le_bytes);
                    let sum = fletcher32(&bytes[..end]);
                    // Before HDF5 1.6.3 the two bytes of each half were swapped.
                    let old = (sum & 0x00FF_00FF) << 8 | sum >> 8 & 0x00FF_00FF;
                    if stored != Some(sum) && stored != Some(old) {
                        return Err(Wrong("a chunk with a wrong checksum (Fletcher)"));
                    }
                    bytes.truncate(end);
                    bytes
                }
            };
        }
        Ok(bytes)
    }
}

/// Error of a chunk.
#[derive(Debug)]
pub struct Wrong(pub &'static str);

/// All bytes of a decoder, at most a checksum and one byte more than `most`.
fn inflated(decoder: impl Read, most: usize) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(most);
    decoder.take(most as u64 + 5).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn unshuffled(bytes: &[u8], of_value: usize) -> Vec<u8> {
    if of_value < 2 {
        return bytes.to_vec();
    }
    let count = bytes.len() / of_value;
    let mut values = vec![0; bytes.len()];
    // Bytes after the last complete value are kept at the end.
    values[count * of_value..].copy_from_slice(&bytes[count * of_value..]);
    if count > 0 {
        for (n, plane) in bytes.chunks_exact(count).take(of_value).enumerate() {
            let of_plane = values[n..].iter_mut().step_by(of_value);
            of_plane.zip(plane).for_each(|(value, byte)| *value = *byte);
        }
    }
    values
}

/// Fletcher checksum of big-endian 16-bit words, as HDF5 computes it (`H5checksum.c`).
fn fletcher32(bytes: &[u8]) -> u32 {
    let (mut low, mut high) = (0_u64, 0_u64);
    // 65 535 = 2¹⁶ − 1 counts as 0 in both sums; after a part of this many words they still fit.
    for part in bytes.chunks(720) {
        for word in part.chunks(2) {
            let word = [word[0], word.get(1).copied().unwrap_or(0)];
            low += u64::from(u16::from_be_bytes(word));
            high += low;
        }
        low = (low & 0xFFFF) + (low >> 16);
        high = (high & 0xFFFF) + (high >> 16);
    }
    let fold = |sum: u64| {
        let once = (sum & 0xFFFF) + (sum >> 16);
        ((once & 0xFFFF) + (once >> 16)) as u32
    };
    (fold(high) << 16) | fold(low)
}
