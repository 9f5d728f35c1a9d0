//! Tables of half floats rewritten so that deflate makes them small: a third less than the tables themselves with the best compressor.
//!
//! `cargo xtask web` writes them, the page reads them.

/// Halves of a texel, and of a row of texels in the largest table. The other tables are read in rows of the same length.
const TEXEL: usize = 4;
const ROW: usize = 96 * TEXEL;

/// The differences of halves from what their neighbours predict: low bytes first, then high bytes. An odd last byte follows as it is.
#[cfg_attr(target_family = "wasm", allow(dead_code))]
pub fn compact(bytes: &[u8]) -> Vec<u8> {
    let (pairs, rest) = bytes.as_chunks::<2>();
    let halves: Vec<u16> = pairs.iter().map(|pair| u16::from_le_bytes(*pair)).collect();
    let differences = halves.iter().enumerate().map(|(n, half)| {
        let difference = half.wrapping_sub(predicted(&halves, n)) as i16;
        // Small differences of either sign become small numbers.
        ((difference << 1) ^ (difference >> 15)) as u16
    });
    let differences: Vec<[u8; 2]> = differences.map(u16::to_le_bytes).collect();
    let low = differences.iter().map(|[low, _]| *low);
    let high = differences.iter().map(|[_, high]| *high);
    low.chain(high).chain(rest.iter().copied()).collect()
}

/// The bytes that [`compact`] rewrote.
#[cfg_attr(not(target_family = "wasm"), allow(dead_code))]
pub fn restore(compacted: &[u8]) -> Vec<u8> {
    let count = compacted.len() / 2;
    let (low, high) = compacted.split_at(count);
    let (high, rest) = high.split_at(count);
    let mut halves = Vec::with_capacity(count);
    for (low, high) in low.iter().zip(high) {
        let number = u16::from_le_bytes([*low, *high]);
        let difference = (number >> 1) ^ 0u16.wrapping_sub(number & 1);
        let before = predicted(&halves, halves.len());
        halves.push(before.wrapping_add(difference));
    }
    let bytes = halves.iter().flat_map(|half: &u16| half.to_le_bytes());
    bytes.chain(rest.iter().copied()).collect()
}

/// What the texels to the left and above predict for the half of this number.
fn predicted(halves: &[u16], n: usize) -> u16 {
    let before = |places: usize| n.checked_sub(places).map_or(0, |at| halves[at]);
    before(TEXEL)
        .wrapping_add(before(ROW))
        .wrapping_sub(before(ROW + TEXEL))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_compacted_is_restored() {
        let bytes: Vec<u8> = (0..5001_u32).map(|n| ((n * n) >> 7) as u8).collect();
        for length in [0, 1, 2, 9, 799, 5000, 5001] {
            let bytes = &bytes[..length];
            assert_eq!(restore(&compact(bytes)), bytes, "{length}");
        }
    }
}
