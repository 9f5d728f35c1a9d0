use super::*;
use crate::terrain::tests::ground::{fractal, noise};
use glam::DVec2;
use terrella_ground::globe::contours::dem::DemFrame;

fn rough(columns: u32, rows: u32, seed: u64, f: impl Fn(u32, u32, f64) -> f64) -> Dem {
    let mut seed = seed;
    let heights = (0..columns * rows)
        .map(|k| f(k % columns, k / columns, noise(&mut seed)) as f32)
        .collect();
    let step_m = DVec2::new(30.0, 45.0);
    Dem::new(columns, rows, heights, DemFrame::Flat { step_m }).unwrap()
}

fn build(dem: &Dem, tolerance_m: f64, q: [f64; 2]) -> PatchTree {
    let options = PatchOptions {
        tolerance_m,
        q,
        ..PatchOptions::default()
    };
    PatchTree::build(dem, None, &options, &mut |_| ()).unwrap()
}

#[test]
fn packed_patches_take_corners_and_cuts() {
    let flat = Dem::new(2, 2, vec![7.0; 4], DemFrame::Flat { step_m: DVec2::ONE }).unwrap();
    // Four corners of four f32, and one bit.
    assert_eq!(build(&flat, 0.0, [1.0; 2]).packed_bytes(), 65);
    // Seventeen posts a side that are all needed: 256 cells and 85 cuts, 289 corners.
    let rough = fractal(17, 3);
    let tree = build(&rough, 0.0, [1.0; 2]);
    let (free, nodes) = (
        tree.hangs.iter().filter(|hangs| !**hangs).count() as u64,
        341_u64,
    );
    assert_eq!((tree.leaves.len(), free), (256, 289));
    assert_eq!(tree.packed_bytes(), 16 * free + nodes.div_ceil(8));
}

fn shapes() -> Vec<(&'static str, Dem)> {
    vec![
        ("1 × 1", rough(1, 1, 1, |_, _, _| 7.0)),
        ("2 × 3", rough(2, 3, 1, |_, _, x| 100.0 * x)),
        ("1 × 9", rough(1, 9, 1, |_, _, x| 100.0 * x)),
        ("flat", rough(33, 40, 1, |_, _, _| 4_321.1)),
        ("noise", rough(38, 29, 3, |_, _, x| 500.0 * x)),
        (
            "hills",
            rough(90, 70, 3, |i, j, x| {
                400.0 * (f64::from(i) * 0.1).sin() * (f64::from(j) * 0.07).cos() + 0.5 * x
            }),
        ),
        (
            "spike",
            rough(
                65,
                65,
                1,
                |i, j, _| if (i, j) == (30, 41) { 9_000.0 } else { 0.0 },
            ),
        ),
        (
            "cliffs",
            rough(60, 45, 1, |i, j, _| {
                if i / 13 + j / 7 < 5 {
                    -11_000.0
                } else {
                    9_000.0
                }
            }),
        ),
        ("fractal", fractal(129, 6)),
    ]
}

#[test]
fn patches_tile_the_grid_within_the_tolerance_and_join_smoothly() {
    println!(
        "shape      tolerance        q  patches   edges  levels    gap, m   angle, rad  proportion  rounds  error, m"
    );
    for (name, dem) in shapes() {
        for (tolerance_m, q) in [(0.0, 1.0), (1.0, 0.5), (25.0, 1.0), (25.0, 2.0), (1e9, 1.0)] {
            let tree = build(&dem, tolerance_m, [q, 1.0 / q]);
            let mut cells = 0;
            for leaf in &tree.leaves {
                let [w, e, s, n] = leaf.span;
                cells += (e - w).max(1) * (n - s).max(1);
                let net = tree.bezier(leaf);
                for j in s..=n {
                    for i in w..=e {
                        let u = f64::from(i - w) / f64::from(e - w).max(1.0);
                        let v = f64::from(j - s) / f64::from(n - s).max(1.0);
                        let off = evaluate(&net, u, v)[0] - dem.height_m(i.into(), j.into());
                        assert!(
                            off.abs() <= tolerance_m + 1e-8,
                            "{name} {tolerance_m}: {off}"
                        );
                    }
                }
            }
            let [_, e, _, n] = dem.span();
            assert_eq!(cells, e.max(1) * n.max(1));
            let continuity = tree.measure_continuity(&dem, 7);
            println!(
                "{name:9} {tolerance_m:10} {q:8} {:8} {:7} {:7} {:9.1e} {:12.1e} {:11.1e} {:7} {:9.2e}",
                tree.leaves.len(),
                continuity.edges,
                continuity.across_levels,
                continuity.gap_m,
                continuity.angle_rad,
                continuity.proportion_m,
                tree.rounds,
                tree.error_m
            );
            assert!(
                continuity.gap_m < 1e-9
                    && continuity.angle_rad < 1e-9
                    && continuity.proportion_m < 1e-9
            );
            assert!(continuity.edges == 0 || continuity.alpha.0 > 0.0);
            if tolerance_m == 1e9 {
                assert_eq!(tree.leaves.len(), 1);
            }
        }
    }
    assert_eq!(
        build(&shapes()[3].1, 0.0, [1.0; 2]).leaves.len(),
        1,
        "flat ground is one patch"
    );
}

#[test]
fn levels_do_meet_in_these_tests() {
    let shapes = shapes();
    let continuity = |name: &str| {
        let dem = &shapes.iter().find(|shape| shape.0 == name).unwrap().1;
        build(dem, 1.0, [1.0; 2]).measure_continuity(dem, 5)
    };
    assert!(continuity("hills").across_levels > 400);
    let spike = continuity("spike");
    assert!(
        spike.alpha.0 < 0.3,
        "a patch must meet one more than twice as wide: {spike:?}"
    );
}

#[test]
fn q_moves_control_values_and_not_the_surface() {
    let dem = fractal(33, 2);
    let plain = build(&dem, 20.0, [1.0; 2]);
    for q in [[0.2, 0.7], [1.0, 3.0], [1e-6, 2.0]] {
        let other = build(&dem, 20.0, q);
        assert_eq!(plain.leaves, other.leaves);
        let mut moved: f64 = 0.0;
        for leaf in &other.leaves {
            let (bezier, patch) = (plain.bezier(leaf), other.q_patch(leaf));
            for k in 0..=6 {
                let (u, v) = (f64::from(k) / 6.0, 1.0 - f64::from(k * k) / 36.0);
                let [z, zu, zv] = evaluate(&bezier, u, v);
                let ours = evaluate_q(other.bases(), &patch, u, v);
                assert!((ours[0] - z).abs() < 1e-8);
                assert!((ours[1] - zu).abs() + (ours[2] - zv).abs() < 1e-7);
            }
            moved = moved.max((patch.control_m[1][1] - bezier[1][1]).abs());
        }
        assert!(moved > 1.0);
    }
    let rejected = PatchOptions {
        q: [0.0, 1.0],
        ..PatchOptions::default()
    };
    assert!(PatchTree::build(&dem, None, &rejected, &mut |_| ()).is_err());
    let small = PatchOptions {
        tolerance_m: 0.0,
        budget_bytes: 20_000,
        ..PatchOptions::default()
    };
    assert!(PatchTree::build(&dem, None, &small, &mut |_| ()).is_err());
}

#[test]
fn patches_over_contours_begin_with_their_leaves() {
    let dem = fractal(65, 8);
    let contours = ContourTree::build(&dem, 30.0, 1 << 28).unwrap();
    let options = PatchOptions {
        tolerance_m: 30.0,
        ..PatchOptions::default()
    };
    let mut reported = Vec::new();
    let tree =
        PatchTree::build(&dem, Some(&contours), &options, &mut |x| reported.push(x)).unwrap();
    assert!(reported.is_sorted() && reported.last() == Some(&1.0) && reported.len() > 1);
    let leaves: Vec<_> = contours
        .nodes
        .iter()
        .filter(|n| n.children == 0)
        .map(|n| n.span)
        .collect();
    for leaf in &tree.leaves {
        let [w, e, s, n] = leaf.span;
        assert!(
            leaves
                .iter()
                .any(|c| c[0] <= w && e <= c[1] && c[2] <= s && n <= c[3])
        );
    }
    assert!(tree.measure_continuity(&dem, 5).angle_rad < 1e-9);
}

#[test]
fn every_number_of_threads_builds_the_same_patches() {
    for dem in [
        fractal(513, 3),
        rough(700, 300, 5, |i, _, x| 0.1 * f64::from(i) * x),
    ] {
        for tolerance_m in [0.0, 60.0] {
            let on = |threads, budget_bytes| {
                let options = PatchOptions {
                    tolerance_m,
                    threads,
                    budget_bytes,
                    ..PatchOptions::default()
                };
                PatchTree::build(&dem, None, &options, &mut |_| ())
            };
            let one = on(1, 1 << 30).unwrap();
            assert!(one.leaves.len() > 500);
            for threads in [2, 16] {
                assert!(on(threads, 1 << 30).unwrap() == one, "{threads}");
            }
            // A leaf counts 202 bytes.
            let takes = 9 * dem.heights_m().len() as u64 + 202 * one.leaves.len() as u64;
            for (budget, fits) in [(takes, true), (takes - 202, false)] {
                assert_eq!((on(1, budget).is_ok(), on(2, budget).is_ok()), (fits, fits));
            }
        }
    }
}
