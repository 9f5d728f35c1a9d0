//! LZW as in TIFF 6.0, section 13. The reader of the `tiff` crate treats tiles with few codes as truncated.

use super::TiffChunkError;
use weezl::{BitOrder, LzwStatus, decode::Configuration};

/// Decompresses at most `most` bytes; further data are ignored.
pub(super) fn bytes(data: &[u8], most: usize) -> Result<Vec<u8>, TiffChunkError> {
    let damaged = |cause: String| TiffChunkError::Damaged(format!("LZW: {cause}"));
    if matches!(data, [0, second, ..] if second & 1 == 1) {
        let cause = "is compressed by LZW with its bits turned round (before TIFF 6.0)";
        return Err(TiffChunkError::Unsupported(cause.to_string()));
    }
    let configuration = Configuration::with_tiff_size_switch(BitOrder::Msb, 8);
    let mut decoder = configuration.with_yield_on_full_buffer(true).build();
    let mut plain = vec![0; most];
    let (mut read, mut written) = (0, 0);
    while written < most {
        let step = decoder.decode_bytes(&data[read..], &mut plain[written..]);
        read += step.consumed_in;
        written += step.consumed_out;
        match step.status {
            Ok(LzwStatus::Ok) if step.consumed_in + step.consumed_out > 0 => {}
            Ok(_) => break,
            Err(error) => return Err(damaged(error.to_string())),
        }
    }
    plain.truncate(written);
    Ok(plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use weezl::encode::Encoder;

    #[test]
    fn whatever_is_compressed_comes_back() {
        let run = |n: usize| (n / 700) as u8;
        let rough = |n: usize| (n * n / 7) as u8;
        let flat = |_: usize| 0_u8;
        for length in [1, 15, 256, 4096, 70_000] {
            for value in [&run as &dyn Fn(usize) -> u8, &rough, &flat] {
                let all: Vec<u8> = (0..length).map(value).collect();
                let mut encoder = Encoder::with_tiff_size_switch(BitOrder::Msb, 8);
                let data = encoder.encode(&all).expect("encoded");
                assert!(bytes(&data, length).expect("decoded") == all, "{length}");
                // Extra bytes after the data, and a smaller limit.
                let longer = [&data[..], &[7; 9]].concat();
                assert!(bytes(&longer, length).expect("decoded") == all, "{length}");
                assert!(bytes(&data, length / 2).expect("decoded") == all[..length / 2]);
                for cut in [0, data.len() / 2] {
                    let some = bytes(&data[..cut], length).expect("decoded");
                    assert!(some.len() < length && all.starts_with(&some), "{length}");
                }
            }
        }
    }

    #[test]
    fn other_bytes_are_errors_or_bytes_within_the_limit() {
        for seed in 0..2000_u64 {
            let byte = |n: u64| ((n + seed).wrapping_mul(6_364_136_223_846_793_005) >> 56) as u8;
            let data: Vec<u8> = (0..seed % 97).map(byte).collect();
            if let Ok(all) = bytes(&data, 1000) {
                assert!(all.len() <= 1000);
            }
        }
    }
}
