//! The land mask of 43 200 × 21 600: a `.npz`, which is a zip file of `.npy` arrays, read a row at a time.

use anyhow::{Context, Result, bail, ensure};
use flate2::read::DeflateDecoder;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// The mask's size, texels.
pub const WIDTH: usize = 43_200;
pub const HEIGHT: usize = 21_600;

/// Rows of the mask, north first: 1 is open water, 0 land.
pub struct Mask<R> {
    texels: R,
    width: usize,
}

impl Mask<DeflateDecoder<std::io::Take<BufReader<File>>>> {
    /// Opens the array `mask` of an archive.
    pub fn open(path: &Path) -> Result<Self> {
        let file = File::open(path).with_context(|| path.display().to_string())?;
        let entry = entry(BufReader::new(file), "mask.npy");
        let entry = entry.with_context(|| path.display().to_string())?;
        Self::new(entry, WIDTH, HEIGHT).with_context(|| path.display().to_string())
    }
}

impl<R: Read> Mask<R> {
    /// Reads the head of a `.npy` of booleans of this size.
    fn new(mut npy: R, width: usize, height: usize) -> Result<Self> {
        let mut start = [0; 10];
        npy.read_exact(&mut start)?;
        ensure!(start.starts_with(b"\x93NUMPY\x01"), "not a .npy, version 1");
        let mut head = vec![0; usize::from(u16::from_le_bytes([start[8], start[9]]))];
        npy.read_exact(&mut head)?;
        let head = String::from_utf8_lossy(&head);
        let says = |what: &str| head.contains(what);
        ensure!(
            says("'descr': '|b1'")
                && says("'fortran_order': False")
                && says(&format!("'shape': ({height}, {width})")),
            "expected {height} rows of {width} booleans, found {head}"
        );
        Ok(Self { texels: npy, width })
    }

    /// The next `size` rows, reduced to one row of `size` × `size` squares: the share of water in each, 0…255.
    pub fn next_row(&mut self, size: usize) -> Result<Vec<u8>> {
        let mut sums = vec![0_u32; self.width / size];
        let mut row = vec![0; self.width];
        for _ in 0..size {
            self.texels.read_exact(&mut row)?;
            for (sum, texels) in sums.iter_mut().zip(row.chunks_exact(size)) {
                *sum += texels.iter().map(|water| u32::from(*water)).sum::<u32>();
            }
        }
        let area = (size * size) as u32;
        let share = |sum: u32| ((sum * 255 + area / 2) / area) as u8;
        Ok(sums.into_iter().map(share).collect())
    }
}

/// A compressed file of a zip archive, found by its local headers. Archives whose local headers lack sizes are rejected.
fn entry<R: Read>(mut archive: R, name: &str) -> Result<DeflateDecoder<std::io::Take<R>>> {
    loop {
        let mut head = [0; 30];
        archive
            .read_exact(&mut head)
            .with_context(|| format!("it holds no {name}"))?;
        let short = |at: usize| u16::from_le_bytes([head[at], head[at + 1]]);
        let long = |at: usize| u32::from(short(at)) | u32::from(short(at + 2)) << 16;
        ensure!(head.starts_with(b"PK\x03\x04"), "it holds no {name}");
        let (flags, method, bytes) = (short(6), short(8), long(18));
        if flags & 8 != 0 || method != 8 || bytes == u32::MAX {
            bail!("a zip file of another kind than numpy's compressed arrays below 4 GB");
        }
        let mut own_name = vec![0; usize::from(short(26))];
        archive.read_exact(&mut own_name)?;
        let extra = u64::from(short(28));
        std::io::copy(&mut archive.by_ref().take(extra), &mut std::io::sink())?;
        if own_name == name.as_bytes() {
            return Ok(DeflateDecoder::new(archive.take(u64::from(bytes))));
        }
        std::io::copy(
            &mut archive.by_ref().take(u64::from(bytes)),
            &mut std::io::sink(),
        )?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::DeflateEncoder};
    use std::io::Write;

    fn npy(text: &str, texels: &[u8]) -> Vec<u8> {
        let mut npy = b"\x93NUMPY\x01\x00".to_vec();
        npy.extend((text.len() as u16).to_le_bytes());
        npy.extend(text.as_bytes());
        npy.extend(texels);
        npy
    }

    fn zipped(name: &str, contents: &[u8]) -> Vec<u8> {
        let mut packed = DeflateEncoder::new(Vec::new(), Compression::fast());
        packed.write_all(contents).unwrap();
        let packed = packed.finish().unwrap();
        let mut file = b"PK\x03\x04\x14\0\0\0\x08\0\0\0\0\0\0\0\0\0".to_vec();
        file.extend((packed.len() as u32).to_le_bytes());
        file.extend((contents.len() as u32).to_le_bytes());
        file.extend((name.len() as u16).to_le_bytes());
        file.extend(2_u16.to_le_bytes());
        file.extend(name.as_bytes());
        file.extend([7, 7]);
        file.extend(packed);
        file
    }

    const HEAD: &str = "{'descr': '|b1', 'fortran_order': False, 'shape': (2, 4), }\n";

    #[test]
    fn rows_are_found_and_averaged() {
        let npy = npy(HEAD, &[1, 1, 0, 0, 1, 1, 0, 1]);
        let archive = [zipped("lat.npy", b"other"), zipped("mask.npy", &npy)].concat();
        let mut mask = Mask::new(entry(&archive[..], "mask.npy").unwrap(), 4, 2).unwrap();
        assert_eq!(mask.next_row(2).unwrap(), [255, 64]);
        assert!(mask.next_row(2).is_err(), "there is no third row");
        let mut mask = Mask::new(entry(&archive[..], "mask.npy").unwrap(), 4, 2).unwrap();
        assert_eq!(mask.next_row(1).unwrap(), [255, 255, 0, 0]);
    }

    #[test]
    fn other_files_are_rejected() {
        let archive = zipped("mask.npy", &npy(HEAD, &[0; 8]));
        assert!(entry(&archive[..], "none.npy").is_err());
        assert!(entry(&b"no zip at all, but long enough"[..], "mask.npy").is_err());
        let open =
            |width, height| Mask::new(entry(&archive[..], "mask.npy").unwrap(), width, height);
        assert!(open(4, 2).is_ok());
        assert!(open(8, 1).is_err());
    }
}
