//! Culled patches are not visible: compared with every face, and every ray to it.

use super::{Posts, placed, view};
use crate::globe::quadtree::patch::BuiltPatch;
use crate::globe::quadtree::{Quadtree, QuadtreeOptions};
use crate::globe::surface::{GroundView, Surface};
use glam::{DVec3, DVec4};
use std::f64::consts::FRAC_PI_2;

fn culled(max_leaves: u32) -> Quadtree {
    Quadtree::new(QuadtreeOptions {
        max_leaves,
        ..QuadtreeOptions::default()
    })
}

/// Whether a ray from the eye hits a triangle before `to`, on either side (Möller and Trumbore).
fn is_hit(eye: DVec3, to: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let (along, e1, e2) = (to - eye, b - a, c - a);
    let p = along.cross(e2);
    let det = e1.dot(p);
    if det == 0.0 {
        return false;
    }
    let from = eye - a;
    let u = from.dot(p) / det;
    let q = from.cross(e1);
    let v = along.dot(q) / det;
    let t = e2.dot(q) / det;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < 1.0 - 1e-9
}

/// Number of faces of patches that are not drawn, and of those that would be visible: they face the eye, their middle is in the image, and
/// nothing is in front of them.
fn lost(surface: &Quadtree, view: &GroundView) -> (usize, usize) {
    let faces = |is_drawn: bool| {
        let patches = surface
            .patches
            .iter()
            .filter(move |b| b.is_drawn == is_drawn);
        patches.flat_map(|built: &BuiltPatch| {
            let triangles = built.patch.indices.triangles.as_chunks::<3>().0;
            triangles
                .iter()
                .map(|t| t.map(|place| placed(&built.patch, place)))
        })
    };
    let drawn: Vec<_> = faces(true).collect();
    let left_out: Vec<_> = faces(false).collect();
    let eye = view.eye_itrf_m;
    let seen = left_out.iter().filter(|[a, b, c]| {
        let middle: DVec3 = (*a + *b + *c) / 3.0;
        let clip: DVec4 = view.clip_from_eye * (middle - eye).extend(1.0);
        let is_inside = clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && clip.z <= clip.w;
        (*b - *a).cross(*c - *a).dot(eye - *a) > 0.0
            && is_inside
            && clip.z >= 0.0
            && !drawn.iter().any(|face| is_hit(eye, middle, *face))
            && !left_out.iter().any(|face| is_hit(eye, middle, *face))
    });
    (left_out.len(), seen.count())
}

#[test]
fn no_face_that_can_be_seen_is_left_out() {
    let ground = Posts::rough(256, 9e3, 3);
    let mut left_out = 0;
    for (lat, lon, height_m, tilt) in [
        (0.0, 0.0, 2e7, 0.0),
        (30.0, 100.0, 4e5, 0.0),
        (30.0, 100.0, 4e5, 1.2),
        (-60.0, 179.9, 3e4, 1.4),
        (89.9, 10.0, 1e5, 1.3),
        (10.0, -20.0, 1.2e4, FRAC_PI_2),
        (45.0, 45.0, 9e3, 2.0),
    ] {
        let mut surface = culled(1_500);
        let view = view(lat, lon, height_m, tilt);
        surface.settle(&view, &ground);
        let (faces, seen) = lost(&surface, &view);
        assert_eq!(
            seen, 0,
            "{lat} {lon} {height_m} {tilt}: {faces} faces left out"
        );
        left_out += faces;
    }
    assert!(left_out > 5_000, "{left_out}: nothing was left out");
}

#[test]
fn a_sudden_view_of_the_limb_loses_nothing() {
    // From the ground, drawn finely, to far away in one frame that may not change a leaf. The drawn terrain is then hundreds of kilometres
    // too low, and more is visible over it than over the ground.
    let ground = Posts::rough(256, 9e3, 4);
    for (lat, lon, height_m, tilt) in [
        (40.0, 120.0, 3e5, 1.3),
        (-10.0, -70.0, 1e5, 1.4),
        (0.0, 179.0, 1e6, 1.0),
    ] {
        let mut surface = culled(1_500);
        surface.settle(&view(0.0, 0.0, 1e4, 1.4), &ground);
        surface.options.work = 0;
        let view = view(lat, lon, height_m, tilt);
        surface.prepare(&view, &ground);
        let (faces, seen) = lost(&surface, &view);
        assert!(
            faces > 0 && seen == 0,
            "{seen} of {faces} faces left out are seen"
        );
    }
}
