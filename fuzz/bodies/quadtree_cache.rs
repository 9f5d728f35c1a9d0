//! Serialized quadtrees.

use glam::DVec3;
use terrella_ground::globe::quadtree::SplitRule;
use terrella_measure::terrain::quadtree::{
    ErrorMetric, GridQuadtree, Order, Posts, SelectedLeaves, TreeOptions, TreeView,
};

const SOURCE: [u8; 32] = [3; 32];
const MAX_BYTES: usize = 1 << 20;

/// Reads any bytes as a tree, as they are and with a source and a checksum that fit.
pub fn run(data: &[u8]) {
    let plain = GridQuadtree::from_bytes(data, &SOURCE, MAX_BYTES);
    let mut signed = data.to_vec();
    if signed.len() >= 80 {
        signed[16..48].copy_from_slice(&SOURCE);
        let body = signed.len() - 32;
        let hash = blake3::hash(&signed[..body]);
        signed[body..].copy_from_slice(hash.as_bytes());
    }
    for tree in [plain, GridQuadtree::from_bytes(&signed, &SOURCE, MAX_BYTES)] {
        match tree {
            Ok(tree) => draw(&tree),
            Err(error) => assert!(error.to_string().len() < 300),
        }
    }
}

/// What is a tree can be drawn, whatever its heights and errors say.
fn draw(tree: &GridQuadtree) {
    let (mut selected, mut triangles) = (SelectedLeaves::default(), Vec::new());
    for lambda in [0.0, 30.0, f64::INFINITY] {
        let view = TreeView {
            eye_m: DVec3::new(10.0, -10.0, 500.0),
            split_rule: SplitRule::Paper { lambda },
            pixel_rad: 1e-3,
            tolerance_px: 1.0,
            metric: ErrorMetric::Bound,
            is_culled: true,
        };
        tree.select(&view, &mut selected);
        tree.triangles(&selected, &mut triangles);
        let (columns, rows) = tree.size();
        assert!(
            triangles
                .iter()
                .all(|post| (*post as usize) < columns * rows)
        );
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    let sizes = [(1, 1), (2, 3), (9, 9), (17, 12)];
    let orders = [
        Order::DepthFirst,
        Order::Hilbert,
        Order::Rows,
        Order::Interleaved,
    ];
    let seed = |((columns, rows), order): ((usize, usize), Order)| {
        let heights_m: Vec<f32> = (0..columns * rows).map(|k| (k * k % 37) as f32).collect();
        let posts = Posts {
            columns,
            rows,
            heights_m: &heights_m,
            spacing_m: 30.0,
        };
        let options = TreeOptions {
            order,
            ..TreeOptions::default()
        };
        let tree = GridQuadtree::build(posts, &options, &mut |_| {});
        tree.expect("a good tree").to_bytes(&SOURCE)
    };
    sizes.into_iter().zip(orders).map(seed).collect()
}

/// Reads a seed.
#[allow(dead_code, reason = "for the test of the seeds")]
pub fn is_good(seed: &[u8]) -> bool {
    GridQuadtree::from_bytes(seed, &SOURCE, MAX_BYTES).is_ok()
}
