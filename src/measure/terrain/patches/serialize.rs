//! Patches as bytes, for a cache on disk, and what the kinds of storage cost.
//!
//! `TERRQBEZ`, version, columns, rows, leaves and free corners (u32 each), q (2 × f64), error in metres (f64), the hash of
//! the source (32 bytes); one bit for each node of the tree in depth-first order, 1 where it is cut, the first in the
//! lowest bit; four f32 for each free corner; BLAKE3 of all before it (32 bytes). Numbers are little-endian. Hanging
//! corners are not stored: they follow from the others.

use super::dem::{Dem, MOST_SAMPLES, Span, quarters};
use super::patches::{Leaf, PatchOptions, PatchTree};
use super::qbernstein::QError;
use super::tree::TreeStats;

const MAGIC: &[u8; 8] = b"TERRQBEZ";
const VERSION: u32 = 1;
const HEADER: usize = 8 + 5 * 4 + 3 * 8 + 32;
const HASH: usize = 32;

/// Bytes that are no patches, or no contours.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StoreError {
    /// Not this format, or another version of it.
    #[error("it is not in this format (version 1); build it again")]
    Format,
    /// The checksum does not fit.
    #[error("it is damaged: its checksum does not fit; build it again")]
    Checksum,
    /// Made from other heights or options.
    #[error("it was made from other heights or options; build it again")]
    Stale,
    /// A number that cannot be.
    #[error("it says {what}, which cannot be; build it again")]
    Content {
        /// Which.
        what: &'static str,
    },
    /// Larger than allowed.
    #[error("it needs {bytes} bytes of memory; {budget} are allowed; allow more")]
    Budget {
        /// Needed.
        bytes: u64,
        /// Allowed.
        budget: u64,
    },
    /// q out of range.
    #[error(transparent)]
    Basis(#[from] QError),
}

impl PatchTree {
    /// Which heights and options patches are made from.
    pub fn source(dem: &Dem, options: &PatchOptions, over_contours: bool) -> [u8; 32] {
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

    /// The bytes to keep. `source` is what [`Self::source`] said.
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
    ) -> Result<Self, StoreError> {
        if bytes.len() < HEADER + HASH || &bytes[..8] != MAGIC {
            return Err(StoreError::Format);
        }
        let (body, hash) = bytes.split_at(bytes.len() - HASH);
        let int = |k: usize| {
            let at = 8 + 4 * k;
            u32::from_le_bytes([body[at], body[at + 1], body[at + 2], body[at + 3]])
        };
        let real = |at: usize| {
            let mut eight = [0; 8];
            eight.copy_from_slice(&body[at..at + 8]);
            f64::from_le_bytes(eight)
        };
        if int(0) != VERSION {
            return Err(StoreError::Format);
        }
        if blake3::hash(body).as_bytes() != hash {
            return Err(StoreError::Checksum);
        }
        if body[HEADER - 32..HEADER] != source[..] {
            return Err(StoreError::Stale);
        }
        let content = |what| StoreError::Content { what };
        let size = [int(1), int(2)];
        let samples = u64::from(size[0]) * u64::from(size[1]);
        if samples == 0 || samples > MOST_SAMPLES {
            return Err(content("a size of 0 or beyond the limit"));
        }
        let (leaves, free) = (int(3) as usize, int(4) as usize);
        let needs = 9 * samples + 200 * leaves as u64;
        if needs > budget_bytes {
            return Err(StoreError::Budget {
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

/// Bytes of one DEM in several forms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Storage {
    /// Two bytes a sample.
    pub raw: u64,
    /// Equal (within the tolerance) quarters merged in Morton order: two bytes a leaf, one bit a node.
    pub morton: u64,
    /// Contours: three f32 a leaf (two slopes, one height), one bit a node.
    pub contours: u64,
    /// Patches, as [`PatchTree::to_bytes`] writes them.
    pub patches: u64,
}

impl Storage {
    /// Counts what a grid takes with contours and patches of the same tolerance; of the latter, their bytes as kept.
    pub fn count(dem: &Dem, tolerance_m: f64, contours: &TreeStats, patch_bytes: u64) -> Self {
        let leaves = morton_leaves(dem, tolerance_m);
        Self {
            raw: 2 * dem.heights_m().len() as u64,
            morton: 2 * leaves + (4 * leaves).div_ceil(3).div_ceil(8),
            contours: 12 * contours.leaves + contours.nodes.div_ceil(8),
            patches: patch_bytes,
        }
    }
}

/// Leaves of the quadtree whose four equal children become one, level by level; equal means that all lie within the
/// tolerance either side of one height. Grids that are no power of two are cut as [`quarters`] does, over samples.
pub fn morton_leaves(dem: &Dem, tolerance_m: f64) -> u64 {
    // Samples take the place of cells: a span's last row and column belong to the next.
    fn leaves(dem: &Dem, [w, e, s, n]: Span, tolerance_m: f64) -> (u64, f64, f64) {
        let Some((spans, count)) = quarters([w, e, s, n]) else {
            let z = dem.height_m(w.into(), s.into());
            return (1, z, z);
        };
        let mut sum = (0, f64::INFINITY, f64::NEG_INFINITY);
        for span in &spans[..count] {
            let part = leaves(dem, *span, tolerance_m);
            sum = (sum.0 + part.0, sum.1.min(part.1), sum.2.max(part.2));
        }
        if sum.0 == count as u64 && sum.2 - sum.1 <= 2.0 * tolerance_m {
            sum.0 = 1;
        }
        sum
    }
    leaves(dem, [0, dem.columns(), 0, dem.rows()], tolerance_m).0
}

#[cfg(test)]
mod tests {
    use super::super::tests::ground::fractal;
    use super::*;

    fn built() -> (PatchTree, [u8; 32]) {
        let dem = fractal(65, 3);
        let options = PatchOptions {
            tolerance_m: 40.0,
            q: [0.5, 2.0],
            ..PatchOptions::default()
        };
        let tree = PatchTree::build(&dem, None, &options, &mut |_| ()).unwrap();
        (tree, PatchTree::source(&dem, &options, false))
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
            Err(StoreError::Stale)
        );
        assert!(matches!(
            PatchTree::from_bytes(&bytes, &source, 1_000),
            Err(StoreError::Budget { .. })
        ));
    }

    #[test]
    fn equal_samples_merge() {
        use super::super::Frame;
        let step_m = glam::DVec2::ONE;
        let dem = |n: u32, f: fn(u32) -> f32| {
            Dem::new(n, n, (0..n * n).map(f).collect(), Frame::Flat { step_m }).unwrap()
        };
        assert_eq!(morton_leaves(&dem(64, |_| 5.0), 0.0), 1);
        assert_eq!(morton_leaves(&dem(65, |_| 5.0), 0.0), 1);
        assert_eq!(morton_leaves(&dem(64, |k| k as f32), 0.0), 64 * 64);
        // One odd sample: three quarters stay at each of six levels, and four samples.
        assert_eq!(
            morton_leaves(&dem(64, |k| if k == 0 { 1.0 } else { 0.0 }), 0.0),
            3 * 6 + 1
        );
    }
}
