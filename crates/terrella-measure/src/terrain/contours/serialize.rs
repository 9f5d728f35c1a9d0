//! Contours as bytes, for a cache on disk.
//!
//! `TERRCONT`, version, columns, rows and nodes (u32 each), tolerance (f64), nodes that stand upright (u64), the hash of the
//! source (32 bytes); of each node its first child (u32, 0 for a leaf), how far its samples determine it (a byte), normal,
//! centroid, lower and upper contour and ceiling (9 × f64); BLAKE3 of all before it (32 bytes). Numbers are little-endian.
//! Spans follow from the first children, distances from the heights.

use super::{ContourTree, Dem, DemFrame, Node, TreeStats};
use crate::terrain::deserialize::{DeserializeError, read_f64, read_u32};
use glam::DVec3;
use terrella_ground::globe::contours::build::radius_m;
use terrella_ground::globe::contours::dem::{Span, quarters};
use terrella_ground::globe::contours::plane::{Contour, Support};

const MAGIC: &[u8; 8] = b"TERRCONT";
const VERSION: u32 = 1;
const HEADER: usize = 8 + 4 * 4 + 8 + 8 + 32;
const HASH: usize = 32;
const NODE: usize = 4 + 1 + 9 * 8;
/// Of a node that no node before it has among its children.
const NOBODY: u32 = u32::MAX;
const SUPPORTS: [Support; 3] = [Support::Plane, Support::Line, Support::Point];

/// Which heights and tolerance a tree is made from.
pub fn contours_source(dem: &Dem, tolerance_m: f64) -> [u8; 32] {
    let mut hash = blake3::Hasher::new();
    hash.update(&dem.columns().to_le_bytes());
    let place = match dem.frame() {
        DemFrame::Flat { step_m } => vec![step_m.x, step_m.y],
        DemFrame::Geodetic { ellipsoid, bounds } => vec![
            ellipsoid.equatorial_radius_m,
            ellipsoid.polar_radius_m,
            bounds.south_rad,
            bounds.north_rad,
            bounds.west_rad,
            bounds.width_rad,
        ],
    };
    hash.update(&[place.len() as u8]);
    for number in place.into_iter().chain([tolerance_m]) {
        hash.update(&number.to_le_bytes());
    }
    hash.update(bytemuck::cast_slice(dem.heights_m()));
    *hash.finalize().as_bytes()
}

/// The tree as bytes. `source` is what [`contours_source`] said.
pub fn contours_to_bytes(tree: &ContourTree, source: &[u8; 32]) -> Vec<u8> {
    let [_, east, _, north] = tree.nodes[0].span;
    let mut out = Vec::with_capacity(HEADER + NODE * tree.nodes.len() + HASH);
    out.extend(MAGIC);
    for n in [VERSION, east + 1, north + 1, tree.nodes.len() as u32] {
        out.extend(n.to_le_bytes());
    }
    out.extend(tree.tolerance_m.to_le_bytes());
    out.extend(tree.stats.upright.to_le_bytes());
    out.extend(source);
    for node in &tree.nodes {
        let contour = &node.contour;
        out.extend(node.first.to_le_bytes());
        let support = SUPPORTS.iter().position(|s| *s == contour.support);
        out.push(support.unwrap_or(0) as u8);
        let (n, at) = (contour.normal, contour.at_m);
        let heights = [contour.low_m, contour.high_m, node.ceiling_m];
        let numbers = [n.x, n.y, n.z, at.x, at.y, at.z].into_iter().chain(heights);
        out.extend(numbers.flat_map(f64::to_le_bytes));
    }
    let hash = blake3::hash(&out);
    out.extend(hash.as_bytes());
    out
}

/// The tree again, to the last bit, over the heights that it was made from. Nothing is allocated before its size is known
/// to fit into the bytes at hand and into the budget.
pub fn contours_from_bytes(
    bytes: &[u8],
    dem: &Dem,
    source: &[u8; 32],
    budget_bytes: u64,
) -> Result<ContourTree, DeserializeError> {
    if bytes.len() < HEADER + HASH || &bytes[..8] != MAGIC || read_u32(&bytes[8..]) != VERSION {
        return Err(DeserializeError::Format);
    }
    let (body, hash) = bytes.split_at(bytes.len() - HASH);
    if blake3::hash(body).as_bytes() != hash {
        return Err(DeserializeError::Checksum);
    }
    let (header, body) = body.split_at(HEADER);
    let size = [read_u32(&header[12..]), read_u32(&header[16..])];
    if header[HEADER - 32..] != source[..] || size != [dem.columns(), dem.rows()] {
        return Err(DeserializeError::Stale);
    }
    let content = |what| DeserializeError::Content { what };
    let count = read_u32(&header[20..]) as usize;
    if count == 0 || body.len() != NODE * count {
        return Err(content("another number of nodes than it has"));
    }
    // A byte more for its depth.
    let needs = (size_of::<Node>() as u64 + 1) * count as u64;
    if needs > budget_bytes {
        return Err(DeserializeError::Budget {
            bytes: needs,
            budget: budget_bytes,
        });
    }
    let tolerance_m = read_f64(&header[24..]);
    let mut upright = [0; 8];
    upright.copy_from_slice(&header[32..40]);
    let mut nodes = Vec::with_capacity(count);
    for bytes in body.chunks_exact(NODE) {
        nodes
            .push(node(bytes).ok_or(content("a plane that is none, or a slab without an inside"))?);
    }
    let stats = connect(&mut nodes, dem, tolerance_m).ok_or(content("nodes of no tree"))?;
    Ok(ContourTree {
        nodes,
        tolerance_m,
        stats: TreeStats {
            upright: u64::from_le_bytes(upright),
            ..stats
        },
    })
}

/// What a node's bytes say; its span is empty and its parent unknown.
fn node(bytes: &[u8]) -> Option<Node> {
    let number = |k: usize| read_f64(&bytes[5 + 8 * k..]);
    let vector = |k: usize| DVec3::new(number(k), number(k + 1), number(k + 2));
    let contour = Contour {
        normal: vector(0),
        at_m: vector(3),
        low_m: number(6),
        high_m: number(7),
        support: *SUPPORTS.get(usize::from(bytes[4]))?,
    };
    let ceiling_m = number(8);
    let is_sound = (contour.normal.length() - 1.0).abs() < 1e-9
        && contour.at_m.is_finite()
        && (f64::NEG_INFINITY..=0.0).contains(&contour.low_m)
        && contour.high_m >= 0.0
        && contour.thickness_m().is_finite()
        && ceiling_m.is_finite()
        && ceiling_m >= contour.high_m;
    is_sound.then_some(Node {
        contour,
        ceiling_m,
        radius_m: 0.0,
        span: [0; 4],
        first: read_u32(bytes),
        children: 0,
        parent: NOBODY,
    })
}

/// Gives each node its span, its parent and its number of children. `None` unless every node but the first is the child of
/// exactly one before it.
fn connect(nodes: &mut [Node], dem: &Dem, tolerance_m: f64) -> Option<TreeStats> {
    let mut stats = TreeStats {
        nodes: nodes.len() as u64,
        bytes: size_of_val(nodes) as u64,
        ..TreeStats::default()
    };
    let mut depths = vec![0u8; nodes.len()];
    nodes[0].span = dem.span();
    nodes[0].parent = 0;
    for k in 0..nodes.len() {
        let Node { span, first, .. } = nodes[k];
        if nodes[k].parent == NOBODY {
            return None;
        }
        nodes[k].radius_m = radius_m(dem, span, nodes[k].contour.at_m);
        if first == 0 {
            stats.add_leaf(&nodes[k], tolerance_m.max(1e-5));
            stats.depth = stats.depth.max(u32::from(depths[k]));
            continue;
        }
        let (spans, count): ([Span; 4], usize) = quarters(span)?;
        let children = (first as usize).max(k + 1)..(first as usize).checked_add(count)?;
        if children.len() != count {
            return None;
        }
        nodes[k].children = count as u32;
        for (child, span) in children.zip(spans) {
            let node = nodes.get_mut(child)?;
            if node.parent != NOBODY {
                return None;
            }
            (node.parent, node.span) = (k as u32, span);
            depths[child] = depths[k] + 1;
        }
    }
    Some(stats)
}

#[cfg(test)]
mod tests {
    use super::super::build_on;
    use super::*;
    use crate::terrain::tests::ground::fractal;

    #[test]
    fn contours_come_back_to_the_last_bit() {
        for (n, tolerance_m) in [(33, 20.0), (129, 0.0), (513, 30.0)] {
            let dem = fractal(n, 5);
            let tree = build_on(1, &dem, tolerance_m, 1 << 28, &mut |_| ()).unwrap();
            let source = contours_source(&dem, tolerance_m);
            let bytes = contours_to_bytes(&tree, &source);
            let back = contours_from_bytes(&bytes, &dem, &source, 1 << 28).unwrap();
            assert_eq!(back, tree);
            let small = contours_from_bytes(&bytes, &dem, &source, 1_000);
            assert!(matches!(small, Err(DeserializeError::Budget { .. })));
            let other = contours_source(&dem, tolerance_m + 1.0);
            let stale = contours_from_bytes(&bytes, &dem, &other, 1 << 28);
            assert_eq!(stale, Err(DeserializeError::Stale));
        }
    }

    #[test]
    fn what_was_changed_or_cut_off_is_refused() {
        let dem = fractal(17, 3);
        let tree = ContourTree::build(&dem, 40.0, 1 << 24).unwrap();
        let source = contours_source(&dem, 40.0);
        let bytes = contours_to_bytes(&tree, &source);
        let read = |bytes: &[u8]| contours_from_bytes(bytes, &dem, &source, 1 << 24);
        let signed = |mut bytes: Vec<u8>| {
            let body = bytes.len() - HASH;
            let hash = blake3::hash(&bytes[..body]);
            bytes[body..].copy_from_slice(hash.as_bytes());
            read(&bytes)
        };
        assert!(read(&bytes).is_ok() && signed(bytes.clone()).is_ok());
        for at in 0..bytes.len() {
            assert!(read(&bytes[..at]).is_err());
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            assert!(read(&changed).is_err(), "byte {at}");
            // With a checksum that fits: an answer or an error, never a panic.
            let _ = signed(changed);
        }
        // Numbers of first children that make no tree; the root's is 1.
        for first in [0, 2, u32::MAX, tree.nodes.len() as u32 - 1] {
            let mut changed = bytes.clone();
            changed[HEADER..HEADER + 4].copy_from_slice(&first.to_le_bytes());
            assert!(signed(changed).is_err(), "{first}");
        }
        for (at, number) in [(0, f64::NAN), (3, f64::INFINITY), (6, 1.0), (8, -1e9)] {
            let mut changed = bytes.clone();
            let at = HEADER + 5 + 8 * at;
            changed[at..at + 8].copy_from_slice(&number.to_le_bytes());
            assert!(signed(changed).is_err(), "{number} at {at}");
        }
    }
}
