//! Trees of contours over grids of all kinds, and rays at them.

use super::ground::{flat, fractal, globe, noise};
use crate::elevation::Bounds;
use crate::globe::contours::cast::{Hit, Ray};
use crate::globe::contours::dem::{Dem, DemError, DemFrame};
use crate::globe::contours::tree::ContourTree;
use glam::{DVec2, DVec3};

const BUDGET: u64 = 1 << 30;

fn build(dem: &Dem, tolerance_m: f64) -> ContourTree {
    ContourTree::build(dem, tolerance_m, BUDGET).unwrap()
}

fn shapes() -> Vec<(&'static str, Dem)> {
    let polar = Bounds {
        south_rad: 67.5f64.to_radians(),
        north_rad: 90f64.to_radians(),
        west_rad: 3.0,
        width_rad: 22.5f64.to_radians(),
    };
    let small = Bounds {
        south_rad: 0.6,
        north_rad: 0.605,
        west_rad: 3.139,
        width_rad: 0.006,
    };
    vec![
        ("1 × 1", flat(1, 1, |_, _| 8.0)),
        ("2 × 3", flat(2, 3, |i, j| (i * 5 + j * j) as f32)),
        ("1 × 40", flat(1, 40, |_, j| j as f32)),
        ("flat", flat(33, 33, |_, _| 250.0)),
        ("slope", flat(30, 41, |i, j| 3.0 * i as f32 - j as f32)),
        (
            "spike",
            flat(
                33,
                33,
                |i, j| if (i, j) == (11, 20) { 9_000.0 } else { 0.0 },
            ),
        ),
        (
            "cliffs",
            flat(50, 37, |i, j| {
                if (i / 9 + j / 5) % 2 == 0 {
                    -11_000.0
                } else {
                    9_000.0
                }
            }),
        ),
        ("fractal", fractal(129, 4)),
        (
            "pole",
            globe(33, polar, |i, j| ((i * j) % 17) as f32 * 90.0),
        ),
        (
            "date line",
            globe(65, small, |i, j| {
                200.0 * ((i as f32) * 0.3).sin() * (j as f32 * 0.2).cos()
            }),
        ),
    ]
}

#[test]
fn every_sample_lies_in_every_slab_above_it_and_leaves_are_thin() {
    for (name, dem) in shapes() {
        for tolerance_m in [0.0, 2.0, 50.0, 1e9] {
            let tree = build(&dem, tolerance_m);
            let mut cells = 0;
            for node in &tree.nodes {
                let [w, e, s, n] = node.span;
                for j in s..=n {
                    for i in w..=e {
                        let at = dem.point_m(i, j);
                        let d = node.contour.normal.dot(at - node.contour.at_m);
                        assert!(d >= node.contour.low_m - 1e-6 && d <= node.contour.high_m + 1e-6);
                        assert!(at.distance(node.contour.at_m) <= node.radius_m + 1e-6);
                        for (n, d) in dem.column(node.span) {
                            assert!(n.dot(at) >= d - 1e-6, "{name}: a sample outside its column");
                        }
                    }
                }
                if node.children == 0 {
                    cells += (e - w).max(1) * (n - s).max(1);
                    let single = e - w <= 1 && n - s <= 1;
                    let thin = node.contour.thickness_m() <= tolerance_m.max(1e-5);
                    assert!(thin || single, "{name} {tolerance_m}: a thick leaf");
                }
            }
            let [_, e, _, n] = dem.span();
            assert_eq!(
                cells,
                e.max(1) * n.max(1),
                "{name}: leaves must tile the grid"
            );
            if tolerance_m == 1e9 {
                assert_eq!(tree.nodes.len(), 1);
            }
        }
    }
    assert_eq!(build(&flat(33, 33, |_, _| 250.0), 0.0).nodes.len(), 1);
}

fn ray(dem: &Dem, seed: &mut u64) -> Ray {
    let [_, e, _, n] = dem.span();
    let mut place = |low: f64| {
        let i = ((noise(seed) * 0.5 + 0.5) * f64::from(e)).round() as u32;
        let j = ((noise(seed) * 0.5 + 0.5) * f64::from(n)).round() as u32;
        dem.lifted_m(i, j, low + 12_000.0 * noise(seed).abs())
    };
    let (from_m, to) = (place(0.0), place(-11_500.0));
    let jitter = DVec3::new(noise(seed), noise(seed), noise(seed)) * 40.0;
    Ray {
        from_m: from_m + jitter,
        towards: (to - from_m).try_normalize().unwrap_or(-dem.up()),
        most_m: 1e7,
        cone: 0.0,
    }
}

#[test]
fn casting_finds_what_looking_at_every_leaf_finds() {
    let (mut hits, mut walls, mut rays) = (0, 0, 0);
    for (name, dem) in shapes() {
        for tolerance_m in [0.0, 20.0, 400.0] {
            let tree = build(&dem, tolerance_m);
            let mut seed = 11;
            for _ in 0..200 {
                let ray = ray(&dem, &mut seed);
                let (ours, all) = (tree.cast(&dem, &ray), tree.cast_at_all(&dem, &ray));
                let distance = |hit: Option<Hit>| hit.map(|hit| hit.distance_m);
                assert_eq!(
                    distance(ours),
                    distance(all),
                    "{name} {tolerance_m} {ray:?}"
                );
                rays += 1;
                hits += u32::from(all.is_some());
                walls += u32::from(all.is_some_and(|hit| hit.wall));
            }
        }
    }
    println!(
        "{rays} rays, {hits} hits, {walls} through walls: the same as every leaf, bit for bit"
    );
    assert!(hits > rays / 3 && hits < rays);
}

#[test]
fn a_ray_meets_the_ground_where_marching_over_the_data_does() {
    // Bilinear heights, marched in steps of 1 m, on rays steep enough for one tolerance of height.
    let dem = fractal(129, 9);
    let DemFrame::Flat { step_m } = dem.frame() else {
        panic!()
    };
    let height = |p: DVec3| {
        let (x, y) = (p.x / step_m.x, p.y / step_m.y);
        let (i, j) = (x.floor() as i64, y.floor() as i64);
        let (u, v) = (x - x.floor(), y - y.floor());
        let row = |j| dem.height_m(i, j) * (1.0 - u) + dem.height_m(i + 1, j) * u;
        row(j) * (1.0 - v) + row(j + 1) * v
    };
    let mut seed = 5;
    for tolerance_m in [1.0, 10.0] {
        let tree = build(&dem, tolerance_m);
        let mut worst: f64 = 0.0;
        for _ in 0..300 {
            let size = step_m * 128.0;
            let at =
                |seed: &mut u64| DVec2::new(noise(seed), noise(seed)) * 0.3 * size + size * 0.5;
            let from_m = at(&mut seed).extend(9_000.0);
            let to = at(&mut seed).extend(0.0);
            let towards = (to - from_m).normalize();
            let ray = Ray {
                from_m,
                towards,
                most_m: 1e6,
                cone: 0.0,
            };
            let hit = tree.cast(&dem, &ray).unwrap();
            let off =
                (from_m + towards * hit.distance_m).z - height(from_m + towards * hit.distance_m);
            // There is a wall where two planes disagree: the ray is then between the two.
            worst = worst.max(off.abs());
        }
        println!("tolerance {tolerance_m} m: {worst:.2} m from bilinear data at the hit");
        assert!(worst < 12.0 * tolerance_m + 2.0);
    }
}

#[test]
fn an_eye_in_the_ground_and_odd_rays_have_answers() {
    for (name, dem) in shapes() {
        let tree = build(&dem, 5.0);
        let [_, e, _, n] = dem.span();
        let inside = dem.lifted_m(e / 2, n / 2, -20_000.0);
        for towards in [dem.up(), -dem.up(), DVec3::ZERO] {
            let ray = Ray {
                from_m: inside,
                towards,
                most_m: 1e9,
                cone: 0.0,
            };
            let hit = tree.cast(&dem, &ray).unwrap();
            assert_eq!(hit.distance_m, 0.0, "{name}");
            let above = dem.lifted_m(e / 2, n / 2, 20_000.0);
            let ray = Ray {
                from_m: above,
                ..ray
            };
            let hit = tree.cast(&dem, &ray);
            assert_eq!(hit.is_some(), towards == -dem.up(), "{name} {towards}");
            assert!(hit.is_none_or(|hit| hit.distance_m.is_finite()));
        }
    }
}

#[test]
fn what_cannot_be_a_dem_is_rejected() {
    let step_m = DVec2::ONE;
    let new = |c, r, h: Vec<f32>| Dem::new(c, r, h, DemFrame::Flat { step_m });
    assert!(matches!(new(0, 3, vec![]), Err(DemError::Size { .. })));
    assert!(matches!(
        new(2, 2, vec![0.0; 3]),
        Err(DemError::Size { .. })
    ));
    assert!(matches!(
        new(u32::MAX, u32::MAX, vec![]),
        Err(DemError::Size { .. })
    ));
    assert!(matches!(
        new(1, 1, vec![f32::NAN]),
        Err(DemError::Height { .. })
    ));
    let step_m = DVec2::new(0.0, 1.0);
    assert_eq!(
        Dem::new(1, 1, vec![0.0], DemFrame::Flat { step_m }),
        Err(DemError::Place)
    );
    let dem = fractal(65, 1);
    let rejected = ContourTree::build(&dem, 0.0, 10_000);
    assert!(rejected.is_err());
}
