//! Serialized q-Bézier patches.

use glam::DVec2;
use terrella_measure::terrain::contours::{Dem, DemFrame};
use terrella_measure::terrain::patches::{PatchOptions, PatchTree};

const SOURCE: [u8; 32] = [3; 32];
const BUDGET: u64 = 1 << 20;

/// Reads any bytes as patches, as they are and with a source and a checksum that fit.
pub fn run(data: &[u8]) {
    let plain = PatchTree::from_bytes(data, &SOURCE, BUDGET);
    let mut signed = data.to_vec();
    if signed.len() >= 116 {
        signed[52..84].copy_from_slice(&SOURCE);
        let body = signed.len() - 32;
        let hash = blake3::hash(&signed[..body]);
        signed[body..].copy_from_slice(hash.as_bytes());
    }
    for tree in [plain, PatchTree::from_bytes(&signed, &SOURCE, BUDGET)] {
        match tree {
            Ok(tree) => {
                // As read, so written.
                let bytes = tree.to_bytes(&SOURCE);
                let again = PatchTree::from_bytes(&bytes, &SOURCE, BUDGET);
                assert_eq!(again.as_ref(), Ok(&tree));
            }
            Err(error) => assert!(error.to_string().len() < 300),
        }
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    let seed = |(columns, rows, tolerance_m): (u32, u32, f64)| {
        let heights = (0..columns * rows).map(|k| (k * k % 37 * 9) as f32);
        let step_m = DVec2::splat(30.0);
        let dem = Dem::new(columns, rows, heights.collect(), DemFrame::Flat { step_m });
        let options = PatchOptions {
            tolerance_m,
            ..PatchOptions::default()
        };
        let dem = dem.expect("good heights");
        let tree = PatchTree::build(&dem, None, &options, &mut |_| ());
        tree.expect("good patches").to_bytes(&SOURCE)
    };
    [(1, 1, 0.0), (9, 7, 0.0), (17, 17, 120.0), (2, 30, 50.0)]
        .map(seed)
        .to_vec()
}

/// Reads a seed.
#[allow(dead_code, reason = "for the test of the seeds")]
pub fn is_good(seed: &[u8]) -> bool {
    PatchTree::from_bytes(seed, &SOURCE, BUDGET).is_ok()
}
