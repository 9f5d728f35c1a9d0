//! Nothing breaks at the limits of the parameters.

use super::{Posts, for_each_triangle, view, whole};
use crate::elevation::Elevation;
use crate::globe::quadtree::{Quadtree, QuadtreeOptions, SplitRule};
use crate::globe::surface::{GroundView, Surface};
use glam::{DMat4, DVec3};
use std::f64::consts::PI;

#[track_caller]
fn assert_sound(surface: &Quadtree) {
    for_each_triangle(surface, |corners| {
        for corner in corners {
            let length = corner.length();
            assert!(length > 6.3e6 && length < 6.4e6, "{corner}");
        }
    });
    surface.for_each_patch(&mut |patch| {
        for vertex in &patch.vertices {
            assert!(vertex.height_m.is_finite() && vertex.slope.is_finite());
        }
    });
}

#[test]
fn any_view_of_any_ground() {
    let grounds = [
        Posts::new(8, |_, _| 0.0),
        Posts::new(64, |i, j| if (i, j) == (64, 32) { 9e3 } else { 0.0 }),
        Posts::new(64, |i, j| if (i + j) % 2 == 0 { 9e3 } else { -11e3 }),
        Posts::new(2, |_, j| f64::from(j as u32) * 1e3),
    ];
    for ground in &grounds {
        for (lat, lon, above_m, tilt) in [
            (90.0, 0.0, 100.0, 0.3),
            (-90.0, 123.0, 1.0, 1.5),
            (0.0, 180.0, 1.0, 1.57),
            (0.0, -180.0, -500.0, 0.0),
            (0.0, 0.0, 0.0, 0.0),
            (33.0, 44.0, 1.0, PI),
            (33.0, 44.0, 4e8, 0.0),
            (33.0, 44.0, -6.37e6, 0.0),
        ] {
            for tolerance_px in [0.0, 1.0, 1e9, f64::INFINITY] {
                let mut surface = Quadtree::new(QuadtreeOptions {
                    max_leaves: 1_000,
                    max_level: 200,
                    ..QuadtreeOptions::default()
                });
                let ground_m = ground.height_m(f64::to_radians(lat), f64::to_radians(lon), 0.0);
                let view = GroundView {
                    tolerance_px,
                    ..view(lat, lon, ground_m + above_m, tilt)
                };
                for _ in 0..3 {
                    let stats = surface.prepare(&view, ground);
                    assert!(
                        stats.error_m.unwrap().is_finite() && stats.error_px.unwrap().is_finite()
                    );
                    assert!(surface.leaves() <= 1_000);
                }
                assert_sound(&surface);
            }
        }
    }
}

#[test]
fn views_that_are_no_numbers_change_nothing() {
    let ground = Posts::rough(64, 1e3, 1);
    let mut surface = whole(1_000);
    let good = view(10.0, 20.0, 1e6, 0.2);
    let stats = surface.settle(&good, &ground);
    for bad in [
        GroundView {
            eye_itrf_m: DVec3::NAN,
            ..good
        },
        GroundView {
            clip_from_eye: DMat4::NAN,
            ..good
        },
        GroundView {
            pixel_rad: 0.0,
            ..good
        },
        GroundView {
            pixel_rad: f64::NAN,
            ..good
        },
        GroundView {
            tolerance_px: f64::NAN,
            ..good
        },
    ] {
        assert_eq!(surface.prepare(&bad, &ground), stats);
    }
    assert_sound(&surface);
}

#[test]
fn a_steady_eye_changes_nothing_and_reads_nothing() {
    let ground = Posts::rough(512, 5e3, 6);
    let mut surface = Quadtree::new(QuadtreeOptions::default());
    let view = view(20.0, 30.0, 1e5, 0.9);
    for _ in 0..400 {
        surface.prepare(&view, &ground);
    }
    let state = |surface: &Quadtree| {
        let mut all = Vec::new();
        surface.for_each_patch(&mut |patch| {
            all.push((patch.key, patch.revision, patch.indices.triangles.as_ptr()))
        });
        all
    };
    let before = state(&surface);
    let stats = surface.prepare(&view, &ground);
    assert_eq!((stats.samples_read, surface.rebuilt()), (0, 0));
    assert_eq!(state(&surface), before);
    assert!(stats.error_px.unwrap() <= view.tolerance_px, "{stats:?}");
}

#[test]
fn changes_are_reported_so_that_a_copy_can_follow() {
    let ground = Posts::rough(512, 5e3, 6);
    let mut surface = Quadtree::new(QuadtreeOptions::default());
    let mut copies: std::collections::HashMap<u64, (u64, Vec<_>)> = Default::default();
    let mut followed = 0;
    for frame in 0..60 {
        let view = view(20.0 + f64::from(frame) * 0.05, 30.0, 2e5, 0.6);
        surface.prepare(&view, &ground);
        surface.for_each_patch(&mut |patch| {
            let copy = copies.entry(patch.key).or_default();
            if copy.0 + 1 == patch.revision {
                copy.1.resize(patch.vertices.len(), Default::default());
                for range in &patch.changed {
                    let range = range.start as usize..range.end as usize;
                    copy.1[range.clone()].copy_from_slice(&patch.vertices[range]);
                }
                followed += 1;
            } else if copy.0 != patch.revision {
                copy.1.clone_from(&patch.vertices);
            }
            copy.0 = patch.revision;
            assert_eq!(copy.1, patch.vertices, "frame {frame}");
        });
    }
    assert!(followed > 100, "{followed}");
}

#[test]
fn memory_stays_within_the_budget() {
    let ground = Posts::rough(512, 5e3, 8);
    let options = QuadtreeOptions {
        max_leaves: 4_000,
        max_pages: 300,
        split_rule: SplitRule::Paper { lambda: 1e4 },
        ..QuadtreeOptions::default()
    };
    let mut surface = Quadtree::new(options);
    let mut most = 0;
    for step in 0..150 {
        let lon = f64::from(step) * 7.0;
        let stats = surface.prepare(&view(10.0, lon, 3e4, 1.0), &ground);
        most = most.max(stats.resident_bytes);
        assert!(surface.leaves() <= 4_000);
        assert!(surface.forest.as_ref().unwrap().pages() <= 300);
    }
    assert!(most < 300 * 4_500 + 4_000 * 1_024, "{most} bytes");
}

/// Leaves of an earlier view must not use the budget of those that this one needs.
#[test]
fn what_was_seen_before_leaves_no_trace() {
    let ground = Posts::rough(2048, 5e3, 3);
    let options = QuadtreeOptions {
        max_leaves: 3_000,
        ..QuadtreeOptions::default()
    };
    let low = GroundView {
        tolerance_px: 0.05,
        ..view(10.0, 20.0, 6e3, 1.4)
    };
    let settled = |before: &[GroundView]| {
        let mut surface = Quadtree::new(options);
        for view in before.iter().chain([&low]) {
            for _ in 0..300 {
                surface.prepare(view, &ground);
            }
        }
        assert!(surface.error_threshold > 1.0, "the leaves are enough");
        surface.stats.error_px.unwrap()
    };
    let fresh_px = settled(&[]);
    for before in [
        view(10.0, 20.0, 4e5, 0.0),
        view(10.5, 20.0, 3e4, 0.5),
        view(10.0, 20.0, 6e3, -1.4),
    ] {
        let before = GroundView {
            tolerance_px: 0.05,
            ..before
        };
        let px = settled(&[before]);
        assert!(
            px <= 1.2 * fresh_px,
            "{px} px after {before:?}, {fresh_px} fresh"
        );
    }
}
