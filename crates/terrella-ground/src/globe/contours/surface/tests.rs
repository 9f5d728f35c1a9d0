use super::lod::WRITTEN_PER_MEASURED;
use super::*;
use crate::elevation::{Bounds, HeightRange};
use glam::Vec3;
use std::collections::HashMap;

/// Heights from a formula of latitude and longitude, degrees.
struct Formula {
    height: fn(f64, f64) -> f64,
    range: (f64, f64),
    spacing_deg: f64,
}

impl Elevation for Formula {
    fn height_m(&self, lat_rad: f64, lon_rad: f64, _: f64) -> f64 {
        let lat = lat_rad.to_degrees().clamp(-90.0, 90.0);
        let lon = if lat.abs() >= 90.0 {
            0.0
        } else {
            (lon_rad.to_degrees() + 180.0).rem_euclid(360.0) - 180.0
        };
        (self.height)(lat, lon)
    }
    fn range_m(&self, _: &Bounds) -> HeightRange {
        HeightRange {
            low_m: self.range.0,
            high_m: self.range.1,
        }
    }
    fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
        self.spacing_deg.to_radians()
    }
}

fn grounds() -> Vec<(&'static str, Formula)> {
    let new = |height, range, spacing_deg| Formula {
        height,
        range,
        spacing_deg,
    };
    vec![
        ("flat", new(|_, _| 120.0, (120.0, 120.0), f64::INFINITY)),
        (
            "waves",
            new(
                |lat, lon| {
                    let (a, b) = ((40.0 * lat).to_radians(), (40.0 * lon).to_radians());
                    1_500.0 * a.sin() * b.cos() * lat.to_radians().cos()
                        + 60.0 * (30.0 * a).sin() * (30.0 * b).sin() * lat.to_radians().cos()
                },
                (-1_560.0, 1_560.0),
                0.001,
            ),
        ),
        (
            "spike",
            new(
                |lat, lon| {
                    let d = (lat - 46.5).hypot(lon - 8.0) / 0.02;
                    9_000.0 * (1.0 - d).max(0.0)
                },
                (0.0, 9_000.0),
                0.001,
            ),
        ),
        (
            "cliffs",
            new(
                |lat, lon| {
                    let s = (7.0 * lat.to_radians()).sin() * (9.0 * lon.to_radians()).sin();
                    if lat.abs() > 80.0 {
                        -50.0
                    } else {
                        (s * 1e5).clamp(-11_000.0, 9_000.0)
                    }
                },
                (-11_000.0, 9_000.0),
                0.01,
            ),
        ),
    ]
}

fn view(
    lat_deg: f64,
    lon_deg: f64,
    height_m: f64,
    towards: Option<DVec3>,
    tolerance_px: f64,
) -> GroundView {
    let e = Ellipsoid::WGS84;
    let n = Ellipsoid::normal(lat_deg.to_radians(), lon_deg.to_radians());
    let eye_itrf_m = e.surface_point(n) + n * height_m;
    let forward = towards.unwrap_or(-n);
    let look =
        glam::dcamera::rh::view::look_to_mat4(DVec3::ZERO, forward, n.any_orthogonal_vector());
    let clip = glam::dcamera::rh::proj::directx::perspective_infinite_reverse(1.0, 16.0 / 9.0, 0.1);
    GroundView {
        eye_itrf_m,
        clip_from_eye: clip * look,
        pixel_rad: 2.0 * 0.5f64.tan() / 720.0,
        tolerance_px,
    }
}

fn settle(surface: &mut ContourSurface, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats {
    let mut stats = surface.prepare(view, ground);
    for _ in 0..400 {
        let before = stats;
        stats = surface.prepare(view, ground);
        if stats.samples_read == 0 && before.patches == stats.patches {
            break;
        }
    }
    stats
}

fn options(max_cuts: u32) -> ContourOptions {
    ContourOptions {
        max_cuts,
        ..ContourOptions::default()
    }
}

fn place(patch: &Patch, vertex: u32) -> DVec3 {
    patch.origin_itrf_m + patch.vertices[vertex as usize].from_origin_m.as_dvec3()
}

/// Number of edges of the whole Earth that are not shared by exactly two triangles, and number of triangles with area.
fn open_edges(surface: &ContourSurface) -> (usize, usize) {
    let bits = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut edges: HashMap<([u64; 3], [u64; 3]), i32> = HashMap::new();
    let mut triangles = 0;
    surface.for_each_patch(&mut |patch| {
        for corner in patch.indices.triangles.chunks_exact(3) {
            let at = [0, 1, 2].map(|k| bits(place(patch, corner[k])));
            if at[0] == at[1] || at[1] == at[2] || at[2] == at[0] {
                continue;
            }
            triangles += 1;
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                *edges.entry((at[a], at[b])).or_default() += 1;
            }
        }
    });
    let open = edges
        .iter()
        .filter(|((a, b), count)| **count != 1 || edges.get(&(*b, *a)) != Some(&1))
        .count();
    (open, triangles)
}

const EYES: [(f64, f64, f64); 8] = [
    (46.5, 8.0, 3_000.0),
    (46.5, 8.0, 400_000.0),
    (0.0, 180.0, 2_000.0),
    (90.0, 0.0, 1_500.0),
    (-90.0, 77.0, 50_000.0),
    (22.5, -22.5, 800.0),
    (89.99, 179.99, 300.0),
    (10.0, 40.0, -500.0),
];

#[test]
fn the_whole_earth_is_watertight() {
    for (name, ground) in grounds() {
        for (k, (lat, lon, height_m)) in EYES.into_iter().enumerate() {
            if name != "waves" && ![0, 3].contains(&k) {
                continue;
            }
            let mut surface = ContourSurface::new(options(40));
            surface.cull = false;
            let view = view(lat, lon, height_m, None, 1.0);
            // While it is being refined, and after.
            let mut stats = SurfaceStats::default();
            for k in 0..4 {
                stats = surface.prepare(&view, &ground);
                if k == 1 && name == "spike" {
                    let (open, _) = open_edges(&surface);
                    assert_eq!(open, 0, "{name} from {lat} {lon} {height_m}: frame {k}");
                }
            }
            let max_level = surface.leaves.iter().map(|leaf| leaf.1.level).max();
            let (open, triangles) = open_edges(&surface);
            assert_eq!(open, 0, "{name} from {lat} {lon} {height_m}");
            println!(
                "{name}: {} patches, {triangles} triangles, level {max_level:?}, 0 open edges",
                stats.patches
            );
        }
    }
}

#[test]
fn vertices_at_one_place_have_one_slope() {
    let polar = [("polar hill", 88.9, polar_hill())];
    let others = grounds()
        .into_iter()
        .map(|(name, ground)| (name, 46.4, ground));
    for (name, lat, ground) in others.chain(polar) {
        let mut surface = ContourSurface::new(options(80));
        surface.cull = false;
        settle(&mut surface, &view(lat, 8.1, 20_000.0, None, 0.5), &ground);
        let mut at: HashMap<[u64; 3], (Vec3, u64)> = HashMap::new();
        let (mut shared, mut worst) = (0, 0.0f32);
        surface.for_each_patch(&mut |patch| {
            let mut used = vec![false; patch.vertices.len()];
            patch
                .indices
                .triangles
                .iter()
                .for_each(|k| used[*k as usize] = true);
            for k in (0..patch.vertices.len() as u32).filter(|k| used[*k as usize]) {
                let p = place(patch, k);
                if p.x.hypot(p.y) < 1.0 {
                    continue;
                }
                let slope = patch.vertices[k as usize].slope;
                let normal = Vec3::new(-slope.x, -slope.y, 1.0).normalize();
                let key = p.to_array().map(f64::to_bits);
                if let Some((other, _)) = at.insert(key, (normal, patch.key)) {
                    shared += 1;
                    worst = worst.max(normal.cross(other).length());
                }
            }
        });
        println!("{name}: {shared} shared vertices, normals within {worst:.1e} rad");
        assert!(shared > 500 && worst < 1e-5);
    }
}

#[test]
fn what_is_drawn_is_as_near_to_the_data_as_it_says() {
    for (name, ground) in grounds() {
        for (height_m, tolerance_px) in [(2_000.0, 1.0), (400_000.0, 1.0), (400_000.0, 4.0)] {
            let mut surface = ContourSurface::new(options(700));
            let view = view(46.5, 8.0, height_m, None, tolerance_px);
            let stats = settle(&mut surface, &view, &ground);
            let (error_m, error_px) = (stats.error_m.unwrap(), stats.error_px.unwrap());
            let mut worst = 0.0f64;
            // Edges may be those of coarser cells out of sight.
            let inner =
                (0..81u32).filter(|k| (1..8).contains(&(k % 9)) && (1..8).contains(&(k / 9)));
            surface.for_each_patch(&mut |patch| {
                for k in inner.clone() {
                    let at = Ellipsoid::WGS84.geodetic_from_itrf(place(patch, k));
                    let data = ground.height_m(at.lat_rad, at.lon_rad, 0.0);
                    worst = worst.max((at.height_m - data).abs());
                }
            });
            println!(
                "{name} from {height_m} m, {tolerance_px} px: {} patches, {error_m:.2} m and {error_px:.2} px said, vertices within {worst:.2} m",
                stats.patches
            );
            if name != "cliffs" && name != "spike" {
                assert!(
                    error_px <= tolerance_px,
                    "{name}: not settled within the tolerance"
                );
                // Probes miss a part of a wave between them, and patches at an edge blend into the coarser one's.
                assert!(worst <= 2.0 * error_m + 0.2);
            }
        }
    }
}

#[test]
fn odd_views_are_answered() {
    let up = Some(Ellipsoid::normal(0.8, 0.1));
    for (name, ground) in grounds() {
        // One metre above a slope.
        let (lat, lon) = (46.02f64, 6.03f64);
        let slope_m = ground.height_m(lat.to_radians(), lon.to_radians(), 0.0);
        let standing = (lat, lon, slope_m + 1.0);
        for (lat, lon, height_m) in EYES.into_iter().chain([standing, (0.0, 0.0, 3e8)]) {
            for tolerance_px in [0.0, 1.0, 1e12] {
                for towards in [None, up] {
                    let wild = ContourOptions {
                        max_cuts: 40,
                        max_level: 32,
                        ..ContourOptions::default()
                    };
                    let mut surface = ContourSurface::new(wild);
                    let view = view(lat, lon, height_m, towards, tolerance_px);
                    for _ in 0..3 {
                        let stats = surface.prepare(&view, &ground);
                        assert!(stats.error_m.unwrap().is_finite());
                        assert!(stats.resident_bytes < 40_000_000);
                    }
                    let mut patches = 0;
                    surface.for_each_patch(&mut |patch| {
                        patches += 1;
                        assert!(patch.origin_itrf_m.is_finite());
                        for vertex in &patch.vertices {
                            let all = [vertex.height_m, vertex.slope.x, vertex.slope.y];
                            assert!(
                                vertex.from_origin_m.is_finite()
                                    && all.iter().all(|x| x.is_finite())
                            );
                        }
                    });
                    // From below the ground looking down, nothing is visible.
                    let may_be_none = towards.is_some() || height_m < 0.0;
                    assert!(patches > 0 || may_be_none, "{name} {lat} {lon} {height_m}");
                    if tolerance_px == 1e12 {
                        assert!(patches <= 128);
                    }
                }
            }
        }
    }
}

#[test]
fn a_view_that_rests_reads_and_writes_nothing() {
    let (_, ground) = grounds().remove(1);
    let mut surface = ContourSurface::new(options(300));
    let view = view(46.5, 8.0, 20_000.0, None, 1.0);
    settle(&mut surface, &view, &ground);
    let mut revisions = Vec::new();
    surface.for_each_patch(&mut |patch| revisions.push((patch.key, patch.revision)));
    let stats = surface.prepare(&view, &ground);
    let mut again = Vec::new();
    surface.for_each_patch(&mut |patch| again.push((patch.key, patch.revision)));
    assert_eq!(stats.samples_read, 0);
    assert_eq!(revisions, again);
    let mut keys: Vec<_> = again.iter().map(|p| p.0).collect();
    keys.sort_unstable();
    keys.dedup();
    assert_eq!(keys.len(), again.len());
}

#[test]
fn fewer_cells_are_measured_while_patches_are_written_anew() {
    let (_, ground) = grounds().remove(1);
    let view = view(46.5, 8.0, 20_000.0, None, 0.05);
    let budget = options(300).measured_per_frame;
    let stale = |surface: &mut ContourSurface| {
        let mut count = 0;
        surface.cell_infos.retain(|_, info| {
            count += u32::from(info.is_stale);
            true
        });
        count
    };
    // Heights have changed everywhere: at all spacings, or only at spacings that no knot uses.
    for below_rad in [f64::INFINITY, 1e-12] {
        let mut surface = ContourSurface::new(options(300));
        let patches = settle(&mut surface, &view, &ground).patches;
        assert!(patches >= 2 * WRITTEN_PER_MEASURED, "{patches} patches");
        let change = HeightChange {
            bounds: Bounds::GLOBE,
            below_rad,
            range: ground.range_m(&Bounds::GLOBE),
        };
        surface.heights_changed(&[change], &ground);
        let before = stale(&mut surface);
        surface.prepare(&view, &ground);
        let measured = before - stale(&mut surface);
        // Half of the budget is reserved for cells without known values, and there are none.
        let written = if below_rad > 1.0 { patches } else { 0 };
        let expected = (budget / 2).saturating_sub(written / WRITTEN_PER_MEASURED);
        assert_eq!(measured, expected, "of {before}, {patches} patches");
    }
}

/// A summit of 9 000 m that is 200 m wide, from a source whose ranges locate it.
struct Summit;

impl Elevation for Summit {
    fn height_m(&self, lat_rad: f64, lon_rad: f64, _: f64) -> f64 {
        let d = (lat_rad.to_degrees() - 46.31).hypot(lon_rad.to_degrees() - 8.17) / 0.001;
        9_000.0 * (1.0 - d).max(0.0)
    }
    fn range_m(&self, bounds: &Bounds) -> HeightRange {
        let (lat, lon) = (46.31f64.to_radians(), 8.17f64.to_radians());
        HeightRange {
            low_m: 0.0,
            high_m: if bounds.contains(lat, lon) {
                9_000.0
            } else {
                0.0
            },
        }
    }
    fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
        1e-5
    }
}

#[test]
fn a_single_summit_between_the_probes_is_found() {
    let mut surface = ContourSurface::new(options(300));
    let view = view(46.3, 8.16, 30_000.0, None, 1.0);
    let mut stats = SurfaceStats::default();
    for _ in 0..300 {
        stats = surface.prepare(&view, &Summit);
    }
    let mut highest = 0.0f32;
    surface.for_each_patch(&mut |patch| {
        let top = patch
            .vertices
            .iter()
            .fold(0.0f32, |top, v| top.max(v.height_m));
        highest = highest.max(top);
    });
    println!(
        "summit of 9 000 m: drawn to {highest} m, {:?} px",
        stats.error_px
    );
    assert!(highest > 7_000.0);
}

/// Every place that is truly visible to the eye is in a drawn patch.
#[test]
fn nothing_seen_is_left_out() {
    let (_, ground) = grounds().remove(1);
    for (lat, lon, height_m) in [
        (46.5, 8.0, 3_000.0),
        (0.0, 180.0, 400_000.0),
        (90.0, 0.0, 2_000.0),
    ] {
        let mut surface = ContourSurface::new(options(200));
        let n = Ellipsoid::normal(f64::to_radians(lat), f64::to_radians(lon));
        let tilted = (n.any_orthogonal_vector() - n * 0.2).normalize();
        let view = view(lat, lon, height_m, Some(tilted), 2.0);
        settle(&mut surface, &view, &ground);
        let mut seed = 5;
        let (mut seen, mut hits) = (0, 0);
        for _ in 0..20_000 {
            let around = super::super::tests::ground::noise(&mut seed) * std::f64::consts::PI;
            let away = 0.4 * super::super::tests::ground::noise(&mut seed).abs().powi(4);
            let (x, y) = (n.any_orthonormal_pair().0, n.any_orthonormal_pair().1);
            let m = (n + (x * around.cos() + y * around.sin()) * away).normalize();
            let at = Ellipsoid::WGS84.geodetic_from_itrf(Ellipsoid::WGS84.surface_point(m));
            let up = Ellipsoid::normal(at.lat_rad, at.lon_rad);
            let p = Ellipsoid::WGS84.surface_point(up)
                + up * ground.height_m(at.lat_rad, at.lon_rad, 0.0);
            let clip = view.clip_from_eye * (p - view.eye_itrf_m).extend(1.0);
            // On screen, and facing the eye by the ellipsoid's normal.
            let on = clip.w > 0.0 && clip.x.abs() < clip.w && clip.y.abs() < clip.w;
            if !on || up.dot(view.eye_itrf_m - p) < 0.0 {
                continue;
            }
            seen += 1;
            let covered = surface
                .leaves
                .iter()
                .any(|leaf| leaf.1.bounds().contains(at.lat_rad, at.lon_rad));
            hits += u32::from(covered);
        }
        assert!(seen > 100, "{seen}");
        assert_eq!(seen, hits, "from {lat} {lon} {height_m}");
    }
}

/// A hill beside each pole on ground that is tilted there, smooth at the pole itself.
fn polar_hill() -> Formula {
    Formula {
        height: |lat, lon| {
            let p = Ellipsoid::normal(lat.to_radians(), lon.to_radians());
            let from_top = (p.x - 0.01).hypot(p.y + 0.02) / 0.03;
            2_000.0 * (-from_top * from_top).exp() + 60_000.0 * p.x
        },
        range: (-63_000.0, 63_000.0),
        spacing_deg: 0.01,
    }
}

#[test]
fn slopes_near_the_poles_are_those_of_the_ground() {
    let ground = polar_hill();
    let figure = Ellipsoid::WGS84;
    for (lat, lon, height_m) in [
        (90.0, 0.0, 2_000.0),
        (-90.0, 33.0, 4_000.0),
        (88.0, 120.0, 2_000.0),
        (-86.5, -20.0, 2_000.0),
    ] {
        let mut surface = ContourSurface::new(options(200));
        settle(&mut surface, &view(lat, lon, height_m, None, 1.0), &ground);
        let (mut polar, mut at_pole, mut worst, mut worst_at_pole) = (0, 0, 0.0f64, 0.0f64);
        surface.for_each_patch(&mut |patch| {
            // Larger cells compute their slopes over more than the hill.
            if patch.key >> 56 < 3 {
                return;
            }
            for k in 0..patch.vertices.len() as u32 {
                let p = place(patch, k);
                let is_pole = p.x == 0.0 && p.y == 0.0;
                // All vertices of a row are at a pole, each for the longitude of the adjacent one.
                let beside = if p.z > 0.0 { k.wrapping_sub(9) } else { k + 9 };
                let lon_rad = if is_pole {
                    let q = place(patch, beside);
                    q.y.atan2(q.x)
                } else {
                    p.y.atan2(p.x)
                };
                let lat_rad = figure.geodetic_from_itrf(p).lat_rad;
                if lat_rad.abs() < 76f64.to_radians() {
                    continue;
                }
                let truth = ground.slope(&figure, lat_rad, lon_rad, 0.0);
                let drawn = patch.vertices[k as usize].slope.as_dvec2();
                let off = drawn.distance(truth);
                polar += 1;
                worst = worst.max(off);
                if is_pole {
                    at_pole += 1;
                    worst_at_pole = worst_at_pole.max(off);
                }
            }
        });
        println!(
            "from {lat} {lon} {height_m}: {polar} vertices, {at_pole} at the pole, slopes within {worst:.4} and {worst_at_pole:.4}"
        );
        // The hill has slopes up to 0.01 + 2 000 · 0.86 / (0.03 · R) = 0.018.
        assert!(polar > 1_000 && worst < 0.005 && worst_at_pole < 0.005);
        assert!(at_pole > 0 || lat.abs() < 89.0);
    }
}
