//! The work of one view is bounded by counts, over the worst ground and after views were forgotten.

use super::cracks::assert_closed;
use super::{Posts, view, whole};
use crate::elevation::Elevation;
use crate::globe::quadtree::{Quadtree, QuadtreeOptions};
use crate::globe::surface::{GroundView, Surface};

/// Upper bound of a view's counted work, in budgets: patches are divided past the end of one, and their neighbours are built again.
const MOST_BUDGETS: u32 = 3;

/// Cliffs of 20 km between samples 300 km apart.
fn cliffs() -> Posts {
    Posts::new(64, |i, j| if (i + j) % 2 == 0 { 9e3 } else { -11e3 })
}

fn above(ground: &Posts, lat_deg: f64, lon_deg: f64, above_m: f64, tilt_rad: f64) -> GroundView {
    let ground_m = ground.height_m(lat_deg.to_radians(), lon_deg.to_radians(), 0.0);
    view(lat_deg, lon_deg, ground_m + above_m, tilt_rad)
}

/// Prepares a view until nothing changes, within the bounds. Returns the remaining error, pixels.
fn settle(surface: &mut Quadtree, view: &GroundView, ground: &Posts, most: u32) -> f64 {
    for _ in 0..most {
        let stats = surface.prepare(view, ground);
        let most = MOST_BUDGETS * surface.options.work;
        assert!(surface.work_done <= most, "{} items", surface.work_done);
        assert!(surface.leaves() <= surface.options.max_leaves);
        if surface.changes == 0 {
            return stats.error_px.expect("a bound");
        }
    }
    panic!("not settled in {most} views");
}

fn points(surface: &Quadtree) -> Vec<(u64, u64)> {
    let mut all: Vec<_> = surface.patches.iter().flat_map(|b| b.points()).collect();
    all.sort_unstable();
    all.dedup();
    all
}

#[test]
fn close_above_cliffs_few_patches_keep_the_tolerance() {
    let ground = cliffs();
    for (lat, lon, above_m, tilt) in [
        (33.0, 44.0, 1.0, 1.5),
        (33.0, 44.0, 1.0, 0.0),
        (0.0, 180.0, 1.0, 1.57),
        (46.0, 8.0, 2e3, 1.2),
    ] {
        let view = above(&ground, lat, lon, above_m, tilt);
        let mut surface = Quadtree::new(QuadtreeOptions::default());
        let error_px = settle(&mut surface, &view, &ground, 60);
        let (patches, leaves) = (surface.patches.len(), surface.leaves());
        let what = format!("{lat}, {lon}: {error_px} px, {patches} patches, {leaves} leaves");
        assert!(error_px <= view.tolerance_px, "{what}");
        assert!(patches < 400 && leaves < 2_000, "{what}");
    }
}

#[test]
fn no_edge_is_open_close_above_cliffs() {
    let ground = cliffs();
    let mut surface = whole(4_000);
    for (lat, lon) in [(33.0, 44.0), (0.0, 180.0)] {
        let view = above(&ground, lat, lon, 1.0, 1.5);
        for _ in 0..12 {
            surface.prepare(&view, &ground);
            assert_closed(&surface);
        }
    }
    let levels = surface.patches.iter().map(|built| built.node.level);
    assert!(levels.max() > Some(8), "the eye is not near");
}

#[test]
fn views_are_forgotten_within_the_budget_and_leave_the_same_leaves() {
    let ground = Posts::rough(512, 9e3, 5);
    let view = view(45.0, 31.0, 3e4, 0.5);
    let mut fresh = Quadtree::new(QuadtreeOptions::default());
    settle(&mut fresh, &view, &ground, 300);
    let mut surface = Quadtree::new(QuadtreeOptions::default());
    for before in [super::view(45.3, 31.4, 1.2e4, 1.2), view] {
        settle(&mut surface, &before, &ground, 300);
    }
    surface.forget_views();
    // Coarse leaves all over the image are first: after a few views none is much worse than the others.
    let mut errors_px = Vec::new();
    for _ in 0..6 {
        errors_px.push(surface.prepare(&view, &ground).error_px.expect("a bound"));
        assert!(surface.work_done <= MOST_BUDGETS * surface.options.work);
    }
    assert!(errors_px[5] < 0.1 * errors_px[0], "{errors_px:?} px");
    settle(&mut surface, &view, &ground, 300);
    assert_eq!(points(&surface), points(&fresh));
}
