//! Patches as bytes, for a cache on disk.
//!
//! `TERRQBEZ`, version, columns, rows, leaves and free corners (u32 each), q (2 × f64), error in metres (f64), the hash of
//! the source (32 bytes); one bit for each node of the tree in depth-first order, 1 where it is cut, the first in the
//! lowest bit; four f32 for each free corner; BLAKE3 of all before it (32 bytes). Numbers are little-endian. Hanging
//! corners are not stored: they follow from the others.

use super::{Leaf, PatchOptions, PatchTree};
use crate::terrain::deserialize::{DeserializeError, read_f64, read_u32};
use terrella_ground::globe::contours::dem::{Dem, MAX_SAMPLES, Span, quarters};

const MAGIC: &[u8; 8] = b"TERRQBEZ";
const VERSION: u32 = 1;
const HEADER: usize = 8 + 5 * 4 + 3 * 8 + 32;
const HASH: usize = 32;

impl PatchTree {
    /// Which heights and options patches are made from.
    pub fn source_hash(dem: &Dem, options: &PatchOptions, over_contours: bool) -> [u8; 32] {
        let mut hash = blake3::Hasher::new();
        hash.update(&dem.columns().to_le_bytes());
        hash.update(&options.tolerance_m.to_le_bytes());
        hash.update(&[u8::from(over_contours)]);
        options.q.iter().for_each(|q| {
            hash.update(&q.to_le_bytes());
        });
        hash.update(bytemuck::cast_slice(dem.heights_m()));
        *hash.finalize().as_bytes()
    }

    /// The patches as bytes. `source` is what [`Self::source_hash`] said.
    pub fn to_bytes(&self, source: &[u8; 32]) -> Vec<u8> {
        let free = self.hangs.iter().filter(|hangs| !**hangs).count();
        let mut out = Vec::with_capacity(HEADER + self.leaves.len() / 4 + 16 * free + HASH);
        out.extend(MAGIC);
        for n in [
            VERSION,
            self.size[0],
            self.size[1],
            self.leaves.len() as u32,
            free as u32,
        ] {
            out.extend(n.to_le_bytes());
        }
        for x in [self.bases()[0].q(), self.bases()[1].q(), self.error_m] {
            out.extend(x.to_le_bytes());
        }
        out.extend(source);
        let mut spans: Vec<Span> = self.leaves.iter().map(|leaf| leaf.span).collect();
        spans.sort_unstable();
        let (mut byte, mut bits) = (0u8, 0);
        let mut stack = vec![whole(self.size)];
        while let Some(span) = stack.pop() {
            let cut = spans.binary_search(&span).is_err();
            if let Some((children, count)) = quarters(span).filter(|_| cut) {
                byte |= 1 << bits;
                stack.extend(children[..count].iter().rev());
            }
            bits += 1;
            if bits == 8 {
                out.push(byte);
                (byte, bits) = (0, 0);
            }
        }
        if bits > 0 {
            out.push(byte);
        }
        for (corner, hangs) in self.corners.iter().zip(&self.hangs) {
            if !hangs {
                corner
                    .iter()
                    .for_each(|x| out.extend((*x as f32).to_le_bytes()));
            }
        }
        let hash = blake3::hash(&out);
        out.extend(hash.as_bytes());
        out
    }

    /// The patches again, to the last bit. Nothing is allocated before its size is known to fit into the bytes at hand
    /// and into the budget.
    pub fn from_bytes(
        bytes: &[u8],
        source: &[u8; 32],
        budget_bytes: u64,
    ) -> Result<Self, DeserializeError> {
        if bytes.len() < HEADER + HASH || &bytes[..8] != MAGIC {
            return Err(DeserializeError::Format);
        }
        let (body, hash) = bytes.split_at(bytes.len() - HASH);
        let int = |k: usize| read_u32(&body[8 + 4 * k..]);
        let real = |at: usize| read_f64(&body[at..]);
        if int(0) != VERSION {
            return Err(DeserializeError::Format);
        }
        if blake3::hash(body).as_bytes() != hash {
            return Err(DeserializeError::Checksum);
        }
        if body[HEADER - 32..HEADER] != source[..] {
            return Err(DeserializeError::Stale);
        }
        let content = |what| DeserializeError::Content { what };
        let size = [int(1), int(2)];
        let samples = u64::from(size[0]) * u64::from(size[1]);
        if samples == 0 || samples > MAX_SAMPLES {
            return Err(content("a size of 0 or beyond the limit"));
        }
        let (leaves, free) = (int(3) as usize, int(4) as usize);
        let needs = 9 * samples + 200 * leaves as u64;
        if needs > budget_bytes {
            return Err(DeserializeError::Budget {
                bytes: needs,
                budget: budget_bytes,
            });
        }
        let Some(bits) = body.len().checked_sub(HEADER + 16 * free) else {
            return Err(content("more corners than bytes"));
        };
        if leaves == 0 || leaves > 8 * bits {
            return Err(content("more leaves than bits"));
        }
        let error_m = real(44);
        if !error_m.is_finite() || error_m < 0.0 {
            return Err(content("an error that is no length"));
        }
        let mut found = Vec::with_capacity(leaves);
        let mut stack = vec![(whole(size), 0u8)];
        let mut at = 0;
        while let Some((span, depth)) = stack.pop() {
            let Some(byte) = body[HEADER..HEADER + bits].get(at / 8) else {
                return Err(content("a tree without an end"));
            };
            let cut = byte >> (at % 8) & 1 == 1;
            at += 1;
            match quarters(span) {
                Some((children, count)) if cut => {
                    stack.extend(children[..count].iter().rev().map(|s| (*s, depth + 1)));
                }
                None if cut => return Err(content("a cut of a single cell")),
                _ => found.push(Leaf {
                    span,
                    depth,
                    corners: [u32::MAX; 4],
                }),
            }
            if found.len() > leaves {
                return Err(content("fewer leaves than its tree has"));
            }
        }
        if found.len() != leaves || at.div_ceil(8) != bits {
            return Err(content("another number of leaves than its tree has"));
        }
        let mut values = body[HEADER + bits..]
            .chunks_exact(4)
            .map(|four| f64::from(f32::from_le_bytes([four[0], four[1], four[2], four[3]])));
        let mut tree = Self::of_leaves(found, size, [real(28), real(36)])?;
        tree.error_m = error_m;
        let mut bad = false;
        tree.resettle(&mut || {
            std::array::from_fn(|_| match values.next() {
                Some(x) if x.is_finite() => x,
                _ => {
                    bad = true;
                    0.0
                }
            })
        });
        if bad || values.next().is_some() {
            return Err(content(
                "another number of corners, or corners that are no numbers",
            ));
        }
        Ok(tree)
    }
}

fn whole([columns, rows]: [u32; 2]) -> Span {
    [0, columns - 1, 0, rows - 1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::tests::ground::fractal;

    fn built() -> (PatchTree, [u8; 32]) {
        let dem = fractal(65, 3);
        let options = PatchOptions {
            tolerance_m: 40.0,
            q: [0.5, 2.0],
            ..PatchOptions::default()
        };
        let tree = PatchTree::build(&dem, None, &options, &mut |_| ()).unwrap();
        (tree, PatchTree::source_hash(&dem, &options, false))
    }

    #[test]
    fn patches_come_back_to_the_last_bit() {
        let (tree, source) = built();
        let bytes = tree.to_bytes(&source);
        let mut back = PatchTree::from_bytes(&bytes, &source, 1 << 24).unwrap();
        back.rounds = tree.rounds;
        assert_eq!(back, tree);
        assert!(tree.hangs.iter().any(|hangs| *hangs));
        println!("{} patches in {} bytes", tree.leaves.len(), bytes.len());
    }

    #[test]
    fn what_was_changed_or_cut_off_is_refused() {
        let (tree, source) = built();
        let bytes = tree.to_bytes(&source);
        let read = |bytes: &[u8]| PatchTree::from_bytes(bytes, &source, 1 << 24);
        for length in 0..bytes.len() {
            assert!(read(&bytes[..length]).is_err());
        }
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            assert!(read(&changed).is_err(), "byte {at}");
            // With a checksum that fits: an answer or an error, never a panic.
            let body = changed.len() - HASH;
            let hash = blake3::hash(&changed[..body]);
            changed[body..].copy_from_slice(hash.as_bytes());
            let _ = read(&changed);
        }
        let mut other = source;
        other[3] ^= 1;
        assert_eq!(
            PatchTree::from_bytes(&bytes, &other, 1 << 24),
            Err(DeserializeError::Stale)
        );
        assert!(matches!(
            PatchTree::from_bytes(&bytes, &source, 1_000),
            Err(DeserializeError::Budget { .. })
        ));
    }
}
