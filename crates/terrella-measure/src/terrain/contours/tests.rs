//! Large trees of contours, on any number of threads.

use super::{ContourTree, build_on, screen_error_px, select, world_error_m};
use crate::terrain::tests::ground::{flat, fractal, globe};
use glam::DVec3;
use terrella_ground::elevation::Bounds;
use terrella_ground::globe::contours::dem::quarters;
use terrella_ground::globe::contours::tree::corners_m;

const BUDGET: u64 = 1 << 30;

#[test]
fn far_views_need_fewer_nodes_and_views_of_nothing_none() {
    let dem = fractal(129, 2);
    let tree = ContourTree::build(&dem, 1.0, BUDGET).unwrap();
    let leaves = tree.stats.leaves as usize;
    let mut out = Vec::new();
    let mut last = usize::MAX;
    for height_m in [2_000.0, 2e4, 2e5, 2e6] {
        let eye = DVec3::new(4_000.0, 4_000.0, height_m);
        let look = glam::dcamera::rh::view::look_to_mat4(eye, -DVec3::Z, DVec3::Y);
        let clip = glam::dcamera::rh::proj::directx::perspective(1.0, 16.0 / 9.0, 1.0, 1e8) * look;
        select(&tree, eye, &clip, 1.0 / 720.0, 2.0 / 3.0, &mut out);
        assert!(!out.is_empty() && out.len() <= leaves);
        // From 2 km only a part is in view.
        assert!(height_m < 1e5 || out.len() <= last);
        last = out.len();
        let away = glam::dcamera::rh::proj::directx::perspective(1.0, 16.0 / 9.0, 1.0, 1e8)
            * glam::dcamera::rh::view::look_to_mat4(eye, DVec3::Z, DVec3::Y);
        select(&tree, eye, &away, 1.0 / 720.0, 2.0 / 3.0, &mut out);
        assert!(height_m < 1e4 || out.is_empty());
    }
    assert_eq!(last, 1);
    let error_m = world_error_m(2.0 / 3.0, 768.0, 5_000.0, 1.0);
    assert!((screen_error_px(error_m, 768.0, 5_000.0, 1.0) - 2.0 / 3.0).abs() < 1e-12);
}

#[test]
fn every_number_of_threads_builds_the_same_contours() {
    let bounds = Bounds {
        south_rad: 0.6,
        north_rad: 0.61,
        west_rad: 3.139,
        width_rad: 0.012,
    };
    // Larger than a part, one of them rough in one corner alone.
    let dems = [
        fractal(513, 3),
        globe(400, bounds, |i, j| ((i * j) % 23 * (i / 300)) as f32 * 9.0),
        flat(1, 70_000, |_, j| (j % 7) as f32),
    ];
    for dem in dems {
        for tolerance_m in [0.0, 300.0] {
            let mut reported = Vec::new();
            let on = |threads, note: &mut dyn FnMut(f32)| {
                build_on(threads, &dem, tolerance_m, BUDGET, note).unwrap()
            };
            let one = on(1, &mut |part| reported.push(part));
            assert!(reported.is_sorted() && reported.last() == Some(&1.0));
            for threads in [2, 16] {
                assert!(on(threads, &mut |_| ()) == one, "{threads}");
            }
            // The size of the whole tree is sufficient, and one node less is not, on any number of threads.
            let takes = 2 * one.stats.bytes;
            for (budget, fits) in [(takes, true), (takes - 2 * 120, false)] {
                let built =
                    |threads| build_on(threads, &dem, tolerance_m, budget, &mut |_| ()).is_ok();
                assert_eq!((built(1), built(2)), (fits, fits));
            }
        }
    }
}

#[test]
fn large_trees_are_whole() {
    // Planes through three posts beside a pit rise over all posts by a quarter of it.
    let pits = |i, j| {
        if (i * 7 + j * 13) % 11 == 0 {
            -90.0
        } else {
            0.0
        }
    };
    let dem = flat(513, 513, pits);
    let tree = build_on(2, &dem, 30.0, BUDGET, &mut |_| ()).unwrap();
    let (mut cells, mut deepest, mut met, mut raised) = (0, 0, 0, 0);
    let mut stack = vec![(0u32, dem.span(), 0)];
    while let Some((index, span, depth)) = stack.pop() {
        let node = &tree.nodes[index as usize];
        assert_eq!(node.span, span);
        (met, deepest) = (met + 1, deepest.max(depth));
        let [w, e, s, n] = span;
        if node.children == 0 {
            cells += (e - w) * (n - s);
        } else {
            let (spans, count) = quarters(span).unwrap();
            assert_eq!(node.children as usize, count);
            for (k, span) in (node.first..).zip(&spans[..count]) {
                assert_eq!(tree.nodes[k as usize].parent, index);
                stack.push((k, *span, depth + 1));
            }
        }
        // It rises over no ceiling above it.
        let corners = corners_m(&dem.column(span), &node.contour);
        let mut at = index;
        while at > 0 {
            at = tree.nodes[at as usize].parent;
            let above = &tree.nodes[at as usize];
            for corner in corners {
                let over_m = above.contour.normal.dot(corner - above.contour.at_m);
                assert!(over_m <= above.ceiling_m, "{over_m} over {at}");
                raised += u32::from(at == 0 && over_m > above.contour.high_m + 10.0);
            }
        }
    }
    assert_eq!((met, cells), (tree.nodes.len(), 512 * 512));
    assert_eq!((tree.stats.depth, deepest), (9, 9));
    assert!(raised > 1_000, "the root's ceiling was not tried: {raised}");
}
