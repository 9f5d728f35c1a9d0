//! Views and grounds at the limits of their ranges.

use super::*;

/// Ground with a cliff, as in a coarse image: the deepest sea west of 11° E, the highest mountains east.
struct Cliff;

impl Elevation for Cliff {
    fn height_m(&self, _: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
        let off = (lon_rad - 11.0_f64.to_radians()) / (spacing_rad + 1e-6);
        -1_000.0 + 10_000.0 * off.clamp(-1.0, 1.0)
    }

    fn range_m(&self, _: &Bounds) -> HeightRange {
        HeightRange {
            low_m: -11e3,
            high_m: 9e3,
        }
    }

    fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
        1e-6
    }
}

/// Prepares a view and checks the result for what every patch must fulfil. Returns the number of vertices drawn.
fn prepared(grid: &mut ProjectedGrid, view: &GroundView, ground: &dyn Elevation) -> usize {
    let stats = grid.prepare(view, ground);
    let mut vertices = 0;
    grid.for_each_patch(&mut |patch| {
        vertices += patch.vertices.len();
        assert!(patch.origin_itrf_m.is_finite());
        for vertex in &patch.vertices {
            assert!(
                vertex.from_origin_m.is_finite()
                    && vertex.height_m.is_finite()
                    && vertex.slope.is_finite(),
                "{vertex:?}"
            );
        }
    });
    assert_eq!(vertices, stats.vertices as usize);
    vertices
}

#[test]
fn as_many_vertices_at_every_height() {
    let mut grid = ProjectedGrid::new(&GridOptions::on_cpu());
    let ground = Ground::Waves(0.0, 300.0, 30e3);
    for height_m in [
        1.0, 100.0, 500.0, 2e3, 1e4, 1e5, 4e5, 2e6, 3.6e7, 3.8e8, 1e9,
    ] {
        // Level views down to heights from which the Earth fills little of the image.
        let pitch = if height_m < 1e5 { 80.0 } else { 0.0 };
        let look = Look {
            height_m,
            pitch,
            ..LOOK
        };
        let vertices = prepared(&mut grid, &look.view(&ground), &ground);
        let frame = grid.frame().unwrap();
        let size = frame.rect.size();
        println!(
            "{height_m:>12} m: {vertices} vertices over {:.2} x {:.2} half pictures, {} cells looked at",
            size.x, size.y, grid.finder.looked_at
        );
        assert_eq!(vertices, 129 * 129);
    }
}

#[test]
fn straight_up_there_is_nothing_unless_ground_is_that_high() {
    let mut grid = ProjectedGrid::new(&GridOptions::on_cpu());
    let up = Look {
        height_m: 100.0,
        pitch: 180.0,
        ..LOOK
    };
    let flat = Ground::Flat(0.0);
    assert_eq!(prepared(&mut grid, &up.view(&flat), &flat), 0);
    // Up from the foot of the cliff: its ground may be there, and the grid is complete.
    let view = up.view(&flat);
    assert_eq!(prepared(&mut grid, &view, &Cliff), 129 * 129);
    assert_eq!(prepared(&mut grid, &view, &flat), 0);
}

#[test]
fn every_view_of_every_ground_is_finite() {
    let mut grid = ProjectedGrid::new(&GridOptions::on_cpu());
    let grounds: [&dyn Elevation; 6] = [
        &Ground::Flat(-11e3),
        &Ground::Flat(9e3),
        &Ground::Waves(-1e3, 1e4, 1e3),
        &Ground::Mountain(0.5, 0.2, 9e3, 10.0),
        &Ground::Flat(1e30),
        &Cliff,
    ];
    let (mut views, mut drawn) = (0, 0);
    for ground in grounds {
        for (lat, lon) in [(90.0, 0.0), (-90.0, 12.0), (47.0, 11.0), (0.0, 180.0)] {
            for height_m in [-2e4, -1.0, 1.0, 3e3, 4e5, 1e9, 1e20] {
                for (pitch, fov, roll) in [
                    (0.0, 40.0, 0.0),
                    (89.0, 170.0, 45.0),
                    (91.0, 0.001, 90.0),
                    (180.0, 60.0, 0.0),
                ] {
                    let look = Look {
                        lat,
                        lon,
                        height_m,
                        pitch,
                        fov,
                        roll,
                        shift: (0.5, -2.0),
                        ..LOOK
                    };
                    let vertices = prepared(&mut grid, &look.view(&Ground::Flat(0.0)), ground);
                    assert!(vertices == 0 || vertices == 129 * 129);
                    views += 1;
                    drawn += usize::from(vertices > 0);
                }
            }
        }
    }
    println!("{drawn} of {views} views show ground");
}

#[test]
fn views_that_are_none_draw_nothing() {
    let mut grid = ProjectedGrid::new(&GridOptions::on_cpu());
    let ground = Ground::Flat(0.0);
    let good = LOOK.view(&ground);
    let matrices = [
        DMat4::ZERO,
        DMat4::IDENTITY,
        DMat4::from_cols_array(&[f64::NAN; 16]),
        DMat4::from_cols_array(&[f64::INFINITY; 16]),
        DMat4::from_cols_array(&[1e308; 16]),
    ];
    for clip_from_eye in matrices {
        let view = GroundView {
            clip_from_eye,
            ..good
        };
        assert_eq!(prepared(&mut grid, &view, &ground), 0, "{clip_from_eye}");
    }
    for eye_itrf_m in [
        DVec3::ZERO,
        DVec3::splat(f64::NAN),
        DVec3::INFINITY,
        DVec3::splat(1e200),
    ] {
        let view = GroundView { eye_itrf_m, ..good };
        assert_eq!(prepared(&mut grid, &view, &ground), 0, "{eye_itrf_m}");
    }
    assert_eq!(prepared(&mut grid, &good, &ground), 129 * 129);
}

#[test]
fn depth_plays_no_part_in_the_rays() {
    let view = Look {
        shift: (0.3, -0.4),
        roll: 33.0,
        ..LOOK
    }
    .view(&Ground::Flat(0.0));
    let infinite = ScreenPlane::new(&view.clip_from_eye).unwrap();
    // Standard depth from 1 m to 1000 km: z = (far − near/depth …); any third row is valid.
    let mut rows = view.clip_from_eye.transpose();
    rows.z_axis = rows.w_axis * 1.000_001 + DVec4::new(0.0, 0.0, 0.0, -1.000_001);
    let finite = ScreenPlane::new(&rows.transpose()).unwrap();
    assert_eq!(infinite, finite);
    // The rays equal those of the inverse matrix, from two depths.
    let inverse = view.clip_from_eye.inverse();
    for at in [DVec2::ZERO, DVec2::new(1.0, -1.0), DVec2::new(-0.7, 0.2)] {
        let point = |depth: f64| inverse.project_point3(at.extend(depth));
        let ray = (point(1e-3) - point(0.5)).normalize();
        assert!(ray.distance(infinite.direction(at)) < 1e-12);
        assert!(infinite.place_of(ray).distance(at) < 1e-12);
    }
    // Round trip outside the image, beside and behind the eye.
    for at in [
        DVec2::new(3.0, 2.0),
        DVec2::new(-5.0, 1.0),
        DVec2::new(0.5, -6.0),
    ] {
        let direction = infinite.direction(at);
        assert!(infinite.place_of(direction).distance(at) < 1e-9, "{at}");
    }
}

#[test]
fn steady_state_moves_no_memory() {
    let mut grid = ProjectedGrid::new(&GridOptions::on_cpu());
    let ground = Ground::Waves(0.0, 3_000.0, 100e3);
    let held = |grid: &ProjectedGrid| {
        (
            grid.patch.vertices.as_ptr(),
            grid.patch.vertices.capacity(),
            grid.patch.changed.capacity(),
            grid.samples.as_ptr(),
            grid.finder.resident_bytes(),
            Arc::as_ptr(&grid.patch.indices),
        )
    };
    let before = held(&grid);
    for step in 0..60 {
        let look = Look {
            height_m: 4e5 * 0.9_f64.powi(step),
            pitch: f64::from(step) * 3.0,
            ..LOOK
        };
        grid.prepare(&look.view(&ground), &ground);
        assert_eq!(held(&grid), before);
    }
}

#[test]
fn triangles_face_up() {
    // Counter-clockwise seen from above, also in a mirrored image; triangles without area are allowed.
    let ground = Ground::Flat(0.0);
    for mirror in [1.0, -1.0] {
        let look = Look {
            pitch: 75.0,
            roll: 40.0,
            ..LOOK
        };
        let mut view = look.view(&ground);
        view.clip_from_eye =
            DMat4::from_diagonal(DVec4::new(mirror, 1.0, 1.0, 1.0)) * view.clip_from_eye;
        let mut grid = ProjectedGrid::new(&GridOptions::on_cpu());
        grid.prepare(&view, &ground);
        let mut faces = 0;
        grid.for_each_patch(&mut |patch| {
            for triangle in patch.indices.triangles.chunks_exact(3) {
                let [a, b, c] = [0, 1, 2].map(|k| {
                    patch.vertices[triangle[k] as usize]
                        .from_origin_m
                        .as_dvec3()
                });
                let area = (b - a).cross(c - a);
                let up = (patch.origin_itrf_m + a).normalize();
                let size = (b - a).length() * (c - a).length();
                // Samples above the limb are all on it: slivers between them may have either orientation.
                assert!(area.dot(up) > -5e-3 * size, "{a} {b} {c}");
                faces += usize::from(area.dot(up) > 1e-3 * size);
            }
        });
        assert!(faces > 10_000, "{faces}");
    }
}
