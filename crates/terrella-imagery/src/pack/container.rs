//! A tile as a KTX2 file: written and read here, to the letter of the Khronos specification, version 2.0.

mod descriptor;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use read::read_ktx2;
pub use write::write_ktx2;

/// KTX2's supercompression scheme of Zstandard.
const SCHEME_ZSTD: u32 = 2;

/// Largest overhead of a tile's file beyond its texels, bytes: header, level index, descriptor, key/value data, and the frames and block headers of
/// incompressible texels (3 bytes for each 128 KiB).
pub const MAX_OVERHEAD_BYTES: usize = 64 << 10;
