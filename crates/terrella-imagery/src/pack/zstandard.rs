//! Zstandard, in C or, where there is no C, in Rust.

use terrella_files::printable;

/// A frame of this level, with its length in front and a checksum behind.
#[cfg(not(target_family = "wasm"))]
pub(super) fn compress(bytes: &[u8], level: i32) -> std::io::Result<Vec<u8>> {
    let mut compressor = zstd::bulk::Compressor::new(level)?;
    compressor.include_checksum(true)?;
    compressor.compress(bytes)
}

/// A frame of the only level that there is in Rust.
#[cfg(target_family = "wasm")]
pub(super) fn compress(bytes: &[u8], _: i32) -> std::io::Result<Vec<u8>> {
    use ruzstd::encoding::{CompressionLevel, compress_to_vec};
    Ok(compress_to_vec(bytes, CompressionLevel::Fastest))
}

/// Decompresses a frame, or several in a row, that must fill `image` exactly. No more is decompressed than fits.
#[cfg(not(target_family = "wasm"))]
pub(super) fn decompress(frames: &[u8], image: &mut [u8]) -> Result<(), String> {
    let of_input = |error: std::io::Error| printable(&error.to_string());
    let mut decompressor = zstd::bulk::Decompressor::new().map_err(of_input)?;
    let count = decompressor
        .decompress_to_buffer(frames, image)
        .map_err(of_input)?;
    exactly(count, image.len())
}

/// The same in Rust.
#[cfg(target_family = "wasm")]
pub(super) fn decompress(frames: &[u8], image: &mut [u8]) -> Result<(), String> {
    decompress_in_rust(frames, image)
}

#[cfg(any(target_family = "wasm", test))]
fn decompress_in_rust(frames: &[u8], image: &mut [u8]) -> Result<(), String> {
    use ruzstd::decoding::FrameDecoder;
    let count = FrameDecoder::new()
        .decode_all(frames, image)
        .map_err(|error| printable(&error.to_string()))?;
    exactly(count, image.len())
}

fn exactly(count: usize, needed: usize) -> Result<(), String> {
    match count == needed {
        true => Ok(()),
        false => Err(format!("it has {count} bytes instead of {needed}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both decompressors, which share no code.
    fn both(frames: &[u8], length: usize) -> [Result<Vec<u8>, String>; 2] {
        [decompress, decompress_in_rust].map(|decompress| {
            let mut image = vec![0; length];
            decompress(frames, &mut image).map(|()| image)
        })
    }

    #[test]
    fn rust_and_c_give_the_same_bytes() {
        let mixed: Vec<u8> = (0..300_000_u32)
            .map(|n| (n.wrapping_mul(n / 7) >> (n / 40_000)) as u8)
            .collect();
        for texels in [&mixed[..], &mixed[..1], &vec![7; 200_000]] {
            for level in [1, 3, 19] {
                let frame = zstd::bulk::compress(texels, level).unwrap();
                assert_eq!(
                    both(&frame, texels.len()),
                    [Ok(texels.to_vec()), Ok(texels.to_vec())]
                );
            }
        }
    }

    #[test]
    fn rust_and_c_reject_the_same_bytes() {
        let texels: Vec<u8> = (0..50_000_u32).map(|n| ((n * n) >> 9) as u8).collect();
        let frame = zstd::bulk::compress(&texels, 3).unwrap();
        let mut flipped = frame.clone();
        flipped[frame.len() / 2] ^= 0x55;
        let cases: [(&[u8], usize); 6] = [
            (&frame, texels.len() - 1),
            (&frame, texels.len() + 1),
            (&frame[..frame.len() / 2], texels.len()),
            (&frame[1..], texels.len()),
            (b"not a frame", texels.len()),
            (&[], texels.len()),
        ];
        for (n, (frames, length)) in cases.into_iter().enumerate() {
            for result in both(frames, length) {
                let error = result.expect_err("rejected");
                assert!(!error.is_empty() && error.len() < 300, "case {n}: {error}");
            }
        }
        // A changed byte may go unnoticed here, as frames have no checksum of their own: the same bytes or an error, but never a panic.
        let [in_c, in_rust] = both(&flipped, texels.len());
        if let (Ok(in_c), Ok(in_rust)) = (in_c, in_rust) {
            assert_eq!(in_c, in_rust);
        }
    }
}
