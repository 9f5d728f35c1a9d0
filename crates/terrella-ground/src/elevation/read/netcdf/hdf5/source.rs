//! Blocks of an HDF5 file and the fields in them.

use crate::elevation::read::HeightFileError;
use crate::elevation::read::error::FileContext;
use std::io::{Read, Seek, SeekFrom};
use terrella_files::printable;

/// Maximum bytes of one structure block, and of all together.
const BLOCK_BYTES: u64 = 16 << 20;
const ALL_BYTES: u64 = 256 << 20;
/// Minimum charge of a block against that sum: reading many small blocks takes time too.
const LEAST_BYTES: u64 = 256;

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    #[error("{what} at byte {at}")]
    Damaged { what: &'static str, at: u64 },
    #[error("{0}")]
    Unsupported(String),
    #[error(transparent)]
    Unreadable(#[from] std::io::Error),
}

impl Fault {
    pub(in super::super) fn of_file(self, context: &FileContext) -> HeightFileError {
        match self {
            Self::Damaged { .. } => context.damaged(self),
            Self::Unreadable(error) => context.reading(error),
            Self::Unsupported(cause) => {
                let path = context.path().display();
                context.rejected(
                    printable(&cause),
                    "NetCDF-4 of numbers, stored plainly or by deflate or ZSTD",
                    format!("convert it: `nccopy -k nc4 -F none {path} OUT.nc`, or `h5repack -f GZIP=1 {path} OUT.nc`"),
                )
            }
        }
    }
}

/// Field sizes stated in the superblock.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// Byte offset of address 0.
    pub base: u64,
    /// Bytes of the file.
    pub file: u64,
    /// Bytes of an address.
    pub address: usize,
    /// Bytes of a length.
    pub length: usize,
}

/// The file, with access to blocks by address.
pub struct Source<'a, R> {
    pub reader: &'a mut R,
    pub sizes: Sizes,
    /// Remaining bytes that may be read.
    left: u64,
}

impl<'a, R: Read + Seek> Source<'a, R> {
    pub fn new(reader: &'a mut R, sizes: Sizes) -> Self {
        Self {
            reader,
            sizes,
            left: ALL_BYTES,
        }
    }

    /// Reads a block.
    pub fn block(&mut self, address: u64, bytes: u64) -> Result<Block, Fault> {
        let at = self.sizes.within(address, bytes)?;
        let damaged = |what| Fault::Damaged { what, at };
        if bytes > BLOCK_BYTES {
            return Err(damaged("a block of more than 16 MiB"));
        }
        let counted = bytes.max(LEAST_BYTES);
        let left = self.left.checked_sub(counted);
        self.left = left.ok_or_else(|| damaged("more than 256 MiB of headers and indexes"))?;
        let mut block = vec![0; bytes as usize];
        self.reader.seek(SeekFrom::Start(at))?;
        self.reader.read_exact(&mut block)?;
        Ok(Block {
            at,
            bytes: block,
            sizes: self.sizes,
        })
    }

    /// Reads a block that starts with a signature and ends with a checksum.
    pub fn checked(
        &mut self,
        address: u64,
        bytes: u64,
        signature: &[u8; 4],
        what: &'static str,
    ) -> Result<Block, Fault> {
        let mut block = self.block(address, bytes)?;
        block.signature(signature, what)?;
        block.check()?;
        Ok(block)
    }
}

impl Sizes {
    /// The file offset of an address, checked to have `bytes` bytes in the file.
    pub fn within(&self, address: u64, bytes: u64) -> Result<u64, Fault> {
        let at = address.saturating_add(self.base);
        match at.checked_add(bytes) {
            Some(end) if end <= self.file => Ok(at),
            _ => Err(Fault::Damaged {
                what: "a block that ends beyond the file",
                at,
            }),
        }
    }
}

/// Bytes of the file.
pub struct Block {
    /// Their offset in the file.
    pub at: u64,
    pub bytes: Vec<u8>,
    sizes: Sizes,
}

impl Block {
    pub fn fields(&self) -> Fields<'_> {
        Fields {
            bytes: &self.bytes,
            at: self.at,
            sizes: self.sizes,
        }
    }

    fn signature(&self, signature: &[u8; 4], what: &'static str) -> Result<(), Fault> {
        match self.bytes.starts_with(signature) {
            true => Ok(()),
            false => Err(Fault::Damaged { what, at: self.at }),
        }
    }

    /// Compares the checksum at the end, and removes it.
    pub fn check(&mut self) -> Result<(), Fault> {
        let (at, end) = (self.at, self.bytes.len().saturating_sub(4));
        let stored = self.bytes.get(end..).and_then(<[u8]>::first_chunk);
        if stored.copied().map(u32::from_le_bytes) != Some(checksum(&self.bytes[..end])) {
            let what = "a block with a wrong checksum";
            return Err(Fault::Damaged { what, at });
        }
        self.bytes.truncate(end);
        Ok(())
    }
}

/// Sequential little-endian fields.
#[derive(Clone, Copy)]
pub struct Fields<'a> {
    pub bytes: &'a [u8],
    /// Offset of the next field in the file.
    pub at: u64,
    pub sizes: Sizes,
}

impl<'a> Fields<'a> {
    pub fn damaged(&self, what: &'static str) -> Fault {
        Fault::Damaged { what, at: self.at }
    }

    pub fn take(&mut self, bytes: usize) -> Result<&'a [u8], Fault> {
        let split = self.bytes.split_at_checked(bytes);
        let (taken, rest) = split.ok_or_else(|| self.damaged("a field that is cut off"))?;
        self.bytes = rest;
        self.at += bytes as u64;
        Ok(taken)
    }

    /// A sub-range of fields.
    pub fn part(&mut self, bytes: usize) -> Result<Self, Fault> {
        let (at, sizes) = (self.at, self.sizes);
        let bytes = self.take(bytes)?;
        Ok(Self { bytes, at, sizes })
    }

    /// An integer of at most 8 bytes.
    pub fn number(&mut self, bytes: usize) -> Result<u64, Fault> {
        if bytes > 8 {
            return Err(self.damaged("a number of more than 8 bytes"));
        }
        let mut all = [0; 8];
        all[..bytes].copy_from_slice(self.take(bytes)?);
        Ok(u64::from_le_bytes(all))
    }

    pub fn byte(&mut self) -> Result<u8, Fault> {
        Ok(self.take(1)?[0])
    }

    /// An integer of two bytes.
    pub fn short(&mut self) -> Result<usize, Fault> {
        self.number(2).map(|number| number as usize)
    }

    /// An integer of four bytes.
    pub fn word(&mut self) -> Result<u32, Fault> {
        self.number(4).map(|number| number as u32)
    }

    /// An address; `None` if undefined.
    pub fn address(&mut self) -> Result<Option<u64>, Fault> {
        let bytes = self.sizes.address;
        let address = self.number(bytes)?;
        Ok((address != u64::MAX >> (64 - 8 * bytes)).then_some(address))
    }

    /// An address that must be defined.
    pub fn defined(&mut self) -> Result<u64, Fault> {
        let at = self.at;
        let what = "an undefined address";
        self.address()?.ok_or(Fault::Damaged { what, at })
    }

    pub fn length(&mut self) -> Result<u64, Fault> {
        self.number(self.sizes.length)
    }
}

/// Bytes needed for every number up to this one.
pub fn bytes_of(most: u64) -> usize {
    (64 - most.leading_zeros() as usize).div_ceil(8).max(1)
}

/// Jenkins, "lookup3" (2006), `hashlittle` of 0, which HDF5 uses for its structures.
fn checksum(bytes: &[u8]) -> u32 {
    let seed = 0xDEAD_BEEF_u32.wrapping_add(bytes.len() as u32);
    let (mut a, mut b, mut c) = (seed, seed, seed);
    let mut rest = bytes;
    let word = |bytes: &[u8], n: usize| {
        let mut all = [0; 4];
        let part = bytes.get(4 * n..).unwrap_or_default();
        let count = part.len().min(4);
        all[..count].copy_from_slice(&part[..count]);
        u32::from_le_bytes(all)
    };
    while rest.len() > 12 {
        a = a.wrapping_add(word(rest, 0));
        b = b.wrapping_add(word(rest, 1));
        c = c.wrapping_add(word(rest, 2));
        for (n, turn) in [4, 6, 8, 16, 19, 4].into_iter().enumerate() {
            // a −= c; a ^= rot(c); c += b, then the same with the roles rotated.
            let (x, y, z) = match n % 3 {
                0 => (&mut a, &b, &mut c),
                1 => (&mut b, &c, &mut a),
                _ => (&mut c, &a, &mut b),
            };
            *x = x.wrapping_sub(*z) ^ z.rotate_left(turn);
            *z = z.wrapping_add(*y);
        }
        rest = &rest[12..];
    }
    if rest.is_empty() {
        return c;
    }
    a = a.wrapping_add(word(rest, 0));
    b = b.wrapping_add(word(rest, 1));
    c = c.wrapping_add(word(rest, 2));
    for (n, turn) in [14, 11, 25, 16, 4, 14, 24].into_iter().enumerate() {
        // c ^= b; c −= rot(b), then the same with the roles rotated.
        let (x, y) = match n % 3 {
            0 => (&mut c, b),
            1 => (&mut a, c),
            _ => (&mut b, a),
        };
        *x = (*x ^ y).wrapping_sub(y.rotate_left(turn));
    }
    c
}
