//! Removal of single wrong heights from a DEM before planes are fitted to it.

use super::ground::{fractal, noise};
use crate::elevation::{Denoise, Denoised};
use crate::globe::contours::dem::{Dem, DemFrame};
use crate::globe::contours::tree::ContourTree;
use glam::DVec2;

/// A DEM without its outliers.
fn cleaned(dem: &Dem) -> (Dem, Denoised) {
    let mut heights_m = dem.heights_m().to_vec();
    let found = Denoise::default().clean(dem.columns() as usize, &mut heights_m);
    let clean = Dem::new(dem.columns(), dem.rows(), heights_m, dem.frame()).unwrap();
    (clean, found)
}

fn with(dem: &Dem, change: impl Fn(&mut [f32])) -> Dem {
    let mut heights = dem.heights_m().to_vec();
    change(&mut heights);
    Dem::new(dem.columns(), dem.rows(), heights, dem.frame()).unwrap()
}

#[test]
fn spikes_go_and_the_rest_stays() {
    let clean = fractal(129, 12);
    let mut seed = 4;
    let spikes: Vec<(usize, f32)> = (0..60)
        .map(|k| {
            let at = ((noise(&mut seed).abs() * 128.0) as usize) * 129 + k * 2;
            (at, if k % 2 == 0 { 8_000.0 } else { -9_999.0 })
        })
        .collect();
    let dirty = with(&clean, |h| spikes.iter().for_each(|(at, z)| h[*at] = *z));
    let (out, found) = cleaned(&dirty);
    println!("{found:?} of 60 spikes");
    assert!((55..=62).contains(&found.replaced), "{found:?}");
    let mut other = 0;
    for (k, (a, b)) in clean.heights_m().iter().zip(out.heights_m()).enumerate() {
        if !spikes.iter().any(|(at, _)| *at == k) {
            other += u32::from(a != b);
        } else {
            assert!((a - b).abs() < 2_000.0);
        }
    }
    assert!(other <= 2, "{other} good samples were moved");
    let (_, again) = cleaned(&clean);
    assert!(again.replaced <= 2, "{again:?}");
    // Fewer spikes, fewer nodes.
    let nodes = |dem: &Dem| {
        let tree = ContourTree::build(dem, 200.0, 1 << 30).unwrap();
        tree.nodes.len()
    };
    assert!(nodes(&out) < nodes(&dirty));
}

#[test]
fn cliffs_walls_and_flat_ground_stay() {
    type Inside = fn(u32, u32) -> bool;
    let shapes: [(&str, Inside); 5] = [
        ("straight", |i, _| i > 20),
        ("slanting", |i, j| i + 2 * j > 70),
        ("corner", |i, j| i > 20 && j > 14),
        ("wall", |i, _| i == 20),
        ("round", |i, j| {
            (i as i32 - 20).pow(2) + (j as i32 - 20).pow(2) < 90
        }),
    ];
    for (name, inside) in shapes {
        let heights = (0..41 * 41)
            .map(|k| {
                if inside(k % 41, k / 41) {
                    9_000.0
                } else {
                    -11_000.0
                }
            })
            .collect();
        let step_m = DVec2::splat(30.0);
        let dem = Dem::new(41, 41, heights, DemFrame::Flat { step_m }).unwrap();
        let (out, found) = cleaned(&dem);
        assert!(out == dem, "{name}: {found:?}");
    }
    for (c, r) in [(1, 1), (2, 3), (1, 5)] {
        let heights = (0..c * r).map(|k| (k * 500) as f32).collect();
        let step_m = DVec2::ONE;
        let dem = Dem::new(c, r, heights, DemFrame::Flat { step_m }).unwrap();
        cleaned(&dem);
    }
}
