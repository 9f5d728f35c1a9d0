//! The tree over one grid.

use super::*;
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use std::collections::{HashMap, HashSet};
use terrella_ground::globe::quadtree::{Node, SplitRule};

fn mixed(seed: u64, x: u64, y: u64) -> u64 {
    let mut h = seed ^ x.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ y.rotate_left(32);
    h = (h ^ h >> 31).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (h ^ h >> 29).wrapping_mul(0x94d0_49bb_1331_11eb) >> 40
}

/// Whole metres: a plateau, a slope, rough ground and a peak.
fn heights(columns: usize, rows: usize, seed: u64) -> Vec<f32> {
    let mut out = Vec::new();
    for y in 0..rows {
        for x in 0..columns {
            let height = match (2 * x / columns.max(2), 2 * y / rows.max(2)) {
                (0, 0) => 100,
                (_, 0) => 3 * x + 5 * y,
                (0, _) => (mixed(seed, x as u64, y as u64) % 300) as usize,
                _ => 40 * usize::from(mixed(seed, x as u64 / 8, y as u64 / 8).is_multiple_of(5)),
            };
            out.push(height as f32);
        }
    }
    out
}

fn built(
    (columns, rows): (usize, usize),
    heights_m: &[f32],
    spacing_m: f64,
    options: &TreeOptions,
    progress: &mut dyn FnMut(f32),
) -> Result<GridQuadtree, TreeError> {
    let posts = Posts {
        columns,
        rows,
        heights_m,
        spacing_m,
    };
    GridQuadtree::build(posts, options, progress)
}

fn tree(columns: usize, rows: usize, seed: u64, merge: Merge, order: Order) -> GridQuadtree {
    let options = TreeOptions {
        merge,
        order,
        ..TreeOptions::default()
    };
    let heights = heights(columns, rows, seed);
    built((columns, rows), &heights, 30.0, &options, &mut |_| {}).expect("sound")
}

fn paper_view(eye_m: DVec3, lambda: f64) -> TreeView {
    TreeView {
        eye_m,
        split_rule: SplitRule::Paper { lambda },
        pixel_rad: 1e-3,
        tolerance_px: 1.0,
        metric: ErrorMetric::Bound,
        is_culled: false,
    }
}

fn mesh(tree: &GridQuadtree, view: &TreeView) -> (SelectedLeaves, Vec<[u32; 3]>) {
    let (mut selected, mut out) = (SelectedLeaves::default(), Vec::new());
    tree.select(view, &mut selected);
    tree.triangles(&selected, &mut out);
    (selected, out.as_chunks::<3>().0.to_vec())
}

/// Fails unless the triangles cover the grid once: each inner edge belongs to two triangles that traverse it in opposite directions, each other one
/// is on the grid's edge, and the areas add up.
#[track_caller]
fn assert_whole(tree: &GridQuadtree, triangles: &[[u32; 3]]) {
    let (columns, rows) = tree.size();
    let place = |post: u32| (post as usize % columns, post as usize / columns);
    let mut edges = HashSet::new();
    let mut twice_area = 0_i64;
    for corners in triangles {
        for k in 0..3 {
            let edge = (corners[k], corners[(k + 1) % 3]);
            assert!(edges.insert(edge), "twice in one direction: {edge:?}");
        }
        let [a, b, c] = corners.map(|post| {
            let (x, y) = place(post);
            (x as i64, -(y as i64))
        });
        let area = (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0);
        assert!(area > 0, "turned over or without area");
        twice_area += area;
    }
    for (a, b) in &edges {
        if !edges.contains(&(*b, *a)) {
            let ((ax, ay), (bx, by)) = (place(*a), place(*b));
            let is_rim = ax == bx && (ax == 0 || ax == columns - 1)
                || ay == by && (ay == 0 || ay == rows - 1);
            assert!(is_rim, "an open edge from {ax}, {ay} to {bx}, {by}");
        }
    }
    assert_eq!(twice_area, 2 * tree.cells() as i64);
}

/// Largest difference between the triangles and any post, metres. Every post must be under some triangle.
#[track_caller]
fn largest_difference(tree: &GridQuadtree, triangles: &[[u32; 3]]) -> f64 {
    let (columns, rows) = tree.size();
    let mut is_covered = vec![false; columns * rows];
    let mut most = 0.0_f64;
    for corners in triangles {
        let at = corners.map(|post| (post as usize % columns, post as usize / columns));
        let flat = at.map(|(x, y)| DVec2::new(x as f64, y as f64));
        let heights = corners.map(|post| tree.post_m(post).z);
        let area = (flat[1] - flat[0]).perp_dot(flat[2] - flat[0]);
        let range = |of: fn(&(usize, usize)) -> usize| {
            let all = at.map(|p| of(&p));
            all[0].min(all[1]).min(all[2])..=all[0].max(all[1]).max(all[2])
        };
        for y in range(|p| p.1) {
            for x in range(|p| p.0) {
                let p = DVec2::new(x as f64, y as f64);
                let share = [0, 1, 2].map(|k: usize| {
                    let (b, c) = (flat[(k + 1) % 3], flat[(k + 2) % 3]);
                    (b - p).perp_dot(c - p) / area
                });
                if share.iter().all(|s| *s >= -1e-12) {
                    let drawn: f64 = (0..3).map(|k| share[k] * heights[k]).sum();
                    let post = (y * columns + x) as u32;
                    most = most.max((drawn - tree.post_m(post).z).abs());
                    is_covered[post as usize] = true;
                }
            }
        }
    }
    assert!(tree.cells() == 0 || is_covered.iter().all(|is| *is));
    most
}

const SIZES: [(usize, usize); 9] = [
    (1, 1),
    (1, 9),
    (2, 3),
    (3, 3),
    (5, 4),
    (33, 33),
    (100, 37),
    (64, 65),
    (130, 129),
];

#[test]
fn merging_loses_nothing_at_any_size() {
    for (columns, rows) in SIZES {
        let full = tree(columns, rows, 1, Merge::None, Order::DepthFirst);
        let mut before = usize::MAX;
        for merge in [Merge::None, Merge::Equal, Merge::Flat] {
            let tree = tree(columns, rows, 1, merge, Order::DepthFirst);
            // Subdivided completely.
            let (selected, triangles) = mesh(&tree, &paper_view(DVec3::ZERO, f64::INFINITY));
            assert_whole(&tree, &triangles);
            assert!(largest_difference(&tree, &triangles) < 1e-9);
            assert!(tree.nodes() <= before && tree.nodes() <= full.nodes());
            before = tree.nodes();
            if merge == Merge::Flat && columns >= 100 {
                assert!(selected.leaves().len() * 4 < 3 * tree.cells());
            }
        }
    }
}

#[test]
fn merging_keeps_what_the_paper_s_figure_keeps() {
    // Figure 1 has cells of one height; these are posts, so a block of equal posts is a cell smaller.
    let rows = ["00000", "00011", "00011", "21100", "02200"];
    let heights = rows
        .iter()
        .flat_map(|row| row.bytes().map(|b| f32::from(b - b'0')));
    let options = TreeOptions {
        merge: Merge::Equal,
        ..TreeOptions::default()
    };
    let tree = built(
        (5, 5),
        &heights.collect::<Vec<_>>(),
        1.0,
        &options,
        &mut |_| {},
    )
    .expect("sound");
    let (selected, _) = mesh(&tree, &paper_view(DVec3::ZERO, f64::INFINITY));
    // One quarter of four equal cells, and twelve cells.
    let sizes: Vec<u8> = selected.leaves().iter().map(|leaf| leaf.level).collect();
    assert_eq!(sizes.iter().filter(|level| **level == 1).count(), 1);
    assert_eq!(sizes.iter().filter(|level| **level == 2).count(), 12);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn no_edge_is_open_and_the_bound_holds(
        (columns, rows) in (1_usize..90, 1_usize..90),
        seed in any::<u64>(),
        eye in (-500.0..3_500.0_f64, -3_500.0..500.0_f64, 0.0..800.0_f64),
        log_lambda in -1.0..3.0_f64,
        order in 0_usize..5,
        merge in 0_usize..3,
        is_full in any::<bool>(),
        is_paper in any::<bool>(),
    ) {
        let merge = [Merge::None, Merge::Equal, Merge::Flat][merge];
        let tree = tree(columns, rows, seed, merge, Order::ALL[order]);
        let lambda = 10_f64.powf(log_lambda);
        let mut view = paper_view(DVec3::from(eye), lambda);
        if is_full {
            view.split_rule = SplitRule::Full { k: 1.0 / lambda };
        }
        if is_paper {
            view.metric = ErrorMetric::Midpoints;
        }
        let (selected, triangles) = mesh(&tree, &view);
        assert_whole(&tree, &triangles);
        let off_m = largest_difference(&tree, &triangles);
        prop_assert!(off_m <= selected.error_m() + 1e-9, "{} of {}", off_m, selected.error_m());
    }

    #[test]
    fn no_face_that_faces_the_eye_is_left_out(
        (columns, rows) in (2_usize..70, 2_usize..70),
        seed in any::<u64>(),
        eye in (-3_000.0..6_000.0_f64, -6_000.0..3_000.0_f64, -200.0..800.0_f64),
        log_lambda in -1.0..3.0_f64,
    ) {
        let tree = tree(columns, rows, seed, Merge::Flat, Order::DepthFirst);
        let view = paper_view(DVec3::from(eye), 10_f64.powf(log_lambda));
        let (_, all) = mesh(&tree, &view);
        let (kept, faces) = mesh(&tree, &TreeView { is_culled: true, ..view });
        let kept_leaves: HashSet<Node> = kept.leaves().iter().copied().collect();
        let owner = owners(&tree, &view);
        let faces: HashSet<[u32; 3]> = faces.into_iter().collect();
        for corners in all {
            let [a, b, c] = corners.map(|post| tree.post_m(post));
            let facing = (b - a).cross(c - a).dot(view.eye_m - a);
            if facing > 1e-6 {
                let leaf = owner[&corners];
                prop_assert!(kept_leaves.contains(&leaf), "{leaf:?} was left out, {corners:?} is seen");
            }
        }
        prop_assert!(kept.leaves().len() + kept.culled() > 0 && faces.len() <= 2 * tree.cells());
    }
}

/// The leaf of each triangle.
fn owners(tree: &GridQuadtree, view: &TreeView) -> HashMap<[u32; 3], Node> {
    let (selected, triangles) = mesh(tree, view);
    let (columns, _) = tree.size();
    let levels = tree.levels();
    let leaves: HashSet<Node> = selected.leaves().iter().copied().collect();
    triangles
        .into_iter()
        .map(|corners| {
            // Three times the triangle's centroid is inside its leaf.
            let sum = |of: fn(usize, usize) -> usize| -> u64 {
                corners
                    .iter()
                    .map(|post| of(*post as usize, columns) as u64)
                    .sum()
            };
            let (x, y) = (
                sum(|post, columns| post % columns),
                sum(|post, columns| post / columns),
            );
            let cell = Node {
                level: levels,
                x: x / 3,
                y: y / 3,
            };
            let leaf = (0..=levels)
                .map(|level| cell.ancestor(level))
                .find(|node| leaves.contains(node));
            (corners, leaf.expect("every triangle has a leaf"))
        })
        .collect()
}

#[test]
fn steep_ground_seen_from_low_down_is_left_out_in_part() {
    let ridge: Vec<f32> = (0..65 * 65)
        .map(|i| 900.0 - 28.0 * ((i % 65) as f32 - 32.0).abs())
        .collect();
    let tree = built((65, 65), &ridge, 30.0, &TreeOptions::default(), &mut |_| {}).expect("sound");
    let view = TreeView {
        is_culled: true,
        ..paper_view(DVec3::new(-200.0, -960.0, 50.0), f64::INFINITY)
    };
    let (selected, triangles) = mesh(&tree, &view);
    // The eastern slope faces away; the western one is a few large leaves.
    assert!(selected.culled() > 0);
    let east = triangles
        .iter()
        .filter(|corners| corners.iter().all(|post| post % 65 >= 32));
    assert_eq!(east.count(), 0);
    assert!(!triangles.is_empty());
}

#[test]
fn children_stand_where_the_paper_s_formula_says() {
    let order = |order| tree(65, 65, 3, Merge::None, order);
    // Nodes of a full tree by level, as 4p + k + m needs them.
    for (tree, is_two_coloured) in [
        (order(Order::Morton), false),
        (order(Order::Interleaved), true),
    ] {
        let mut m_of_level = HashMap::new();
        let mut stack = vec![(0_u32, 0_u8)];
        while let Some((p, level)) = stack.pop() {
            let first = tree.nodes[p as usize].children;
            if first < super::tree::ABSENT {
                let m = i64::from(first) - 4 * i64::from(p);
                assert_eq!(*m_of_level.entry(level).or_insert(m), m, "level {level}");
                stack.extend((0..4).map(|k| (first + k, level + 1)));
            }
        }
        let all_one = m_of_level.values().all(|m| *m == 1);
        assert_eq!(all_one, !is_two_coloured);
    }
}

#[test]
fn every_order_and_every_number_of_threads_gives_the_same_leaves() {
    let view = paper_view(DVec3::new(500.0, -900.0, 300.0), 60.0);
    let leaves = |tree: &GridQuadtree| {
        let (selected, triangles) = mesh(tree, &view);
        (selected.leaves().to_vec(), triangles)
    };
    let first = leaves(&tree(130, 90, 4, Merge::Flat, Order::DepthFirst));
    for order in Order::ALL {
        assert_eq!(
            leaves(&tree(130, 90, 4, Merge::Flat, order)),
            first,
            "{order:?}"
        );
    }
    let with_threads = |threads| {
        let options = TreeOptions {
            threads,
            ..TreeOptions::default()
        };
        let mut reported = Vec::new();
        let mut note = |part| reported.push(part);
        let tree =
            built((130, 90), &heights(130, 90, 4), 30.0, &options, &mut note).expect("sound");
        assert!(reported.is_sorted() && reported.last() == Some(&1.0) && reported.len() > 10);
        tree
    };
    assert_eq!(with_threads(1), with_threads(2));
}

#[test]
fn what_cannot_be_built_is_rejected() {
    let build = |size, heights: Vec<f32>, max_bytes| {
        let options = TreeOptions {
            max_bytes,
            ..TreeOptions::default()
        };
        built(size, &heights, 1.0, &options, &mut |_| {}).map(|_| ())
    };
    let all = usize::MAX;
    assert!(matches!(
        build((0, 5), vec![], all),
        Err(TreeError::Size { .. })
    ));
    assert!(matches!(
        build((MAX_POSTS + 1, 1), vec![], all),
        Err(TreeError::Size { .. })
    ));
    assert!(matches!(
        build((2, 2), vec![0.0; 3], all),
        Err(TreeError::Heights { .. })
    ));
    assert!(matches!(
        build((64, 64), vec![0.0; 4096], 9_000),
        Err(TreeError::TooLarge { .. })
    ));
    let mut heights = vec![0.0; 12];
    heights[7] = f32::NAN;
    let error = build((4, 3), heights, all);
    assert_eq!(error, Err(TreeError::NotFinite { column: 3, row: 1 }));
}

#[test]
fn extreme_heights_give_finite_answers() {
    let cliffs: Vec<f32> = (0..33 * 33)
        .map(|i| if (i / 5) % 2 == 0 { 9_000.0 } else { -11_000.0 })
        .collect();
    let tree = built(
        (33, 33),
        &cliffs,
        30.0,
        &TreeOptions::default(),
        &mut |_| {},
    )
    .expect("sound");
    for eye_m in [
        DVec3::ZERO,
        DVec3::new(480.0, -480.0, 9_001.0),
        DVec3::splat(-1e9),
    ] {
        for lambda in [0.0, 300.0, f64::INFINITY] {
            let (selected, triangles) = mesh(&tree, &paper_view(eye_m, lambda));
            assert_whole(&tree, &triangles);
            assert!(selected.error_m().is_finite());
        }
    }
}
