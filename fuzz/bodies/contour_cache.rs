//! Serialized contours.

use glam::{DVec2, DVec3};
use terrella_measure::terrain::contours::{
    ContourTree, Dem, DemFrame, Ray, contours_from_bytes, contours_source, contours_to_bytes,
};

const BUDGET: u64 = 1 << 20;
const TOLERANCES_M: [f64; 3] = [0.0, 30.0, 1e6];

/// Heights that trees are read over.
fn dem() -> Dem {
    let heights = (0..17 * 12).map(|k| (k * k % 37 * 9) as f32).collect();
    let step_m = DVec2::new(30.0, 40.0);
    Dem::new(17, 12, heights, DemFrame::Flat { step_m }).expect("good heights")
}

/// Reads any bytes as contours, as they are and with a source and a checksum that fit.
pub fn run(data: &[u8]) {
    let dem = dem();
    let source = contours_source(&dem, TOLERANCES_M[0]);
    let plain = contours_from_bytes(data, &dem, &source, BUDGET);
    let mut signed = data.to_vec();
    if signed.len() >= 104 {
        signed[40..72].copy_from_slice(&source);
        let body = signed.len() - 32;
        let hash = blake3::hash(&signed[..body]);
        signed[body..].copy_from_slice(hash.as_bytes());
    }
    for tree in [plain, contours_from_bytes(&signed, &dem, &source, BUDGET)] {
        match tree {
            Ok(tree) => look(&tree, &dem),
            Err(error) => assert!(error.to_string().len() < 300),
        }
    }
}

/// What is a tree has an answer for any ray.
fn look(tree: &ContourTree, dem: &Dem) {
    for towards in [-DVec3::Z, DVec3::new(0.6, 0.0, -0.8), DVec3::Y] {
        let ray = Ray {
            from_m: DVec3::new(200.0, 200.0, 900.0),
            towards,
            most_m: 1e6,
            cone: 0.0,
        };
        if let Some(hit) = tree.cast(dem, &ray) {
            assert!((0.0..=1e6).contains(&hit.distance_m));
        }
    }
    let mut nodes = Vec::new();
    tree.write_gpu_nodes(dem, |_, _| DVec2::ZERO, &mut nodes);
    assert_eq!(nodes.len(), tree.nodes.len());
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    let dem = dem();
    let seed = |tolerance_m| {
        let tree = ContourTree::build(&dem, tolerance_m, BUDGET);
        let source = contours_source(&dem, TOLERANCES_M[0]);
        contours_to_bytes(&tree.expect("a good tree"), &source)
    };
    TOLERANCES_M.map(seed).to_vec()
}

/// Reads a seed.
#[allow(dead_code, reason = "for the test of the seeds")]
pub fn is_good(seed: &[u8]) -> bool {
    let dem = dem();
    let source = contours_source(&dem, TOLERANCES_M[0]);
    contours_from_bytes(seed, &dem, &source, BUDGET).is_ok()
}
