//! The drawn surface is closed, and as near to the data as its cells allow, for any place and ground.

use super::*;

#[test]
fn the_drawn_ground_is_closed_everywhere() {
    for (nth, (lat_deg, lon_deg)) in odd_places().into_iter().enumerate() {
        let trim = [Trim::Diamond, Trim::Hexagon][nth % 2];
        let mut map = clipmap(at_once(5, trim));
        map.prepare(&over(lat_deg, lon_deg, 3000.0), &HILLS);
        assert_eq!(map.counts.finest, 5);
        assert_closed(&map, &format!("{trim:?} {lat_deg}° {lon_deg}°"));
    }
}

#[test]
fn a_border_through_a_corner_of_three_diamonds_is_closed() {
    let icosahedron = Icosahedron::default();
    // The border of level 4 runs through the corner B of diamond 5, or past it.
    let n = 32 << 4;
    for trim in [Trim::Diamond, Trim::Hexagon] {
        for (diamond, i, j) in [
            (5, n - 6, 32),
            (5, n - 32, 6),
            (5, n - 32, 32),
            (0, n - 6, 32),
            (3, 32, n - 8),
            (7, 6, 32),
        ] {
            let up = icosahedron.direction(LatticeIndex { diamond, i, j }, n);
            let mut map = clipmap(at_once(5, trim));
            map.prepare(
                &view_from(Ellipsoid::WGS84.surface_point(up) + up * 3000.0),
                &HILLS,
            );
            assert_closed(&map, &format!("{trim:?} {diamond} {i} {j}"));
        }
    }
}

#[test]
fn the_default_has_the_papers_vertices() {
    let mut map = clipmap(ClipmapOptions::default());
    // In the middle of a diamond nothing is cut or doubled.
    let view = over(30.0, 36.0, 20_000.0);
    settle(&mut map, &view, &HILLS);
    assert_eq!(map.counts().finest, 6);
    let vertices: usize = (1..=6)
        .flat_map(|level| &map.levels[level].buffers)
        .filter(|buffer| !buffer.patch.indices.triangles.is_empty())
        .map(|buffer| buffer.patch.vertices.len())
        .sum();
    assert_eq!(vertices, 99_846 + 129 * 129 * (buffers(&map) - 6));
    assert_closed(&map, "default");
    // Each point within the extent once: six squares, and a few points of diamond borders twice.
    let bound = map.max_bytes();
    assert!(
        map.stats.resident_bytes < bound,
        "{} of {bound}",
        map.stats.resident_bytes
    );
}

fn buffers(map: &Clipmap) -> usize {
    map.levels[1..]
        .iter()
        .map(|level| level.buffers.len())
        .sum()
}

#[test]
fn positions_are_exact_sums_in_single_precision() {
    for (lat_deg, lon_deg) in odd_places() {
        let mut map = clipmap(at_once(12, Trim::Diamond));
        map.prepare(&over(lat_deg, lon_deg, 300.0), &CLIFFS);
        for level in &map.levels {
            let quantum_m = Level::quantum_m(level.number);
            for buffer in &level.buffers {
                for t in &buffer.patch.indices.triangles {
                    let offset = buffer.patch.vertices[*t as usize].from_origin_m.as_dvec3();
                    assert!(offset.abs().max_element() <= Level::most_m(level.number));
                    assert_eq!((offset / quantum_m).round() * quantum_m, offset);
                }
            }
        }
    }
}

#[test]
fn each_level_follows_the_ground_as_its_cells_allow() {
    // One wave of 600 km, not averaged, so that the error comes from the triangles alone.
    const WAVE: Rule = Rule {
        height: |n, _| 2000.0 * (60.0 * n.x).sin() * (60.0 * n.z).cos(),
        finest_rad: 1e-6,
    };
    // Upper bound of the wave's |second derivative|: 2 k² A along the sphere's chord, plus the sphere's own.
    let (radius_m, k) = (6.4e6, 60.0 / 6.35e6);
    let curvature = 2.0 * k * k * 2000.0 + 1.0 / radius_m;
    for (lat_deg, lon_deg) in [(26.565, 72.0), (90.0, 0.0), (31.0, 40.0), (-5.0, 179.9)] {
        let mut map = clipmap(at_once(6, Trim::Diamond));
        map.prepare(&over(lat_deg, lon_deg, 3000.0), &WAVE);
        let mut met = [false; 7];
        for level in &map.levels {
            // Blended cells are the coarser level's. A triangle's points are within s/√3 of a corner, so the error is s²·c/6; a cell is up
            // to 1.3 times the mean.
            let spacing_m = map.spacing_m(level.number.saturating_sub(1)) * 1.3;
            let bound_m = spacing_m * spacing_m * curvature / 6.0 + Level::quantum_m(level.number);
            for buffer in &level.buffers {
                let patch = &buffer.patch;
                for t in patch.indices.triangles.chunks_exact(3) {
                    let at = |x: usize| {
                        patch.origin_itrf_m + patch.vertices[t[x] as usize].from_origin_m.as_dvec3()
                    };
                    let middle = (at(0) + at(1) + at(2)) / 3.0;
                    let place = Ellipsoid::WGS84.geodetic_from_itrf(middle);
                    let data_m = WAVE.height_m(place.lat_rad, place.lon_rad, 0.0);
                    let error_m = (place.height_m - data_m).abs();
                    assert!(error_m <= bound_m, "level {}: {error_m} m", level.number);
                    met[level.number as usize] = true;
                }
            }
        }
        assert_eq!(met, [true; 7]);
    }
}

#[test]
fn extreme_grounds_and_eyes_are_drawn_closed() {
    let eyes = [
        over(10.0, 20.0, 1.0),
        over(10.0, 20.0, 8001.0),
        over(10.0, 20.0, -500.0),
        over(-90.0, 0.0, 2.0),
        over(0.0, 180.0, 3e8),
        view_from(DVec3::ZERO),
        view_from(DVec3::new(0.0, 0.0, 1.0)),
        view_from(DVec3::splat(1e200)),
    ];
    for (ground, name) in [
        (&FLAT, "flat"),
        (&SPIKE, "spike"),
        (&CLIFFS, "cliffs"),
        (&HILLS, "hills"),
    ] {
        let mut map = clipmap(at_once(32, Trim::Diamond));
        assert_eq!(map.options.levels, MAX_LEVELS);
        for (k, view) in eyes.iter().enumerate() {
            for tolerance_px in [0.0, 1.0, 1e30, f64::NAN] {
                let view = GroundView {
                    tolerance_px,
                    ..*view
                };
                let stats = map.prepare(&view, ground);
                assert!(stats.resident_bytes <= map.max_bytes());
                map.for_each_patch(&mut |patch| {
                    for vertex in &patch.vertices {
                        assert!(vertex.from_origin_m.is_finite() && vertex.slope.is_finite());
                    }
                });
            }
            assert_closed(&map, &format!("{name}, eye {k}"));
        }
        // An eye that is not finite: the previous state stays.
        let before = map.stats;
        let stats = map.prepare(&view_from(DVec3::NAN), ground);
        assert_eq!(
            stats,
            SurfaceStats {
                samples_read: 0,
                ..before
            }
        );
    }
}

#[test]
fn as_many_levels_as_data_and_tolerance_ask_for() {
    let finest = |ground: &Rule, height_m: f64, tolerance_px: f64| {
        let mut map = clipmap(at_once(32, Trim::Diamond));
        map.prepare(
            &GroundView {
                tolerance_px,
                ..over(31.0, 40.0, height_m)
            },
            ground,
        );
        map.counts.finest
    };
    // Flat, but declared as data of 6.4 m.
    const FINE: Rule = Rule {
        height: |_, _| 0.0,
        finest_rad: 1e-6,
    };
    // Cells of 220 km/2^ℓ. Flat ground needs levels only for the curvature: a millimetre at 226 m.
    assert_eq!(finest(&FLAT, 1e3, 0.0), 10);
    assert_eq!(finest(&FLAT, 1e3, 1e9), 0);
    assert_eq!(finest(&FINE, 1e4, 0.0), 22);
    // 1 px of a milliradian at 2 km and 400 km: 32 m and 6.4 km between samples. The spike's data of 64 m are not followed by equally wide
    // cells.
    assert_eq!(finest(&FINE, 2e3, 1.0), 13);
    assert_eq!(finest(&SPIKE, 2e3, 1.0), 13);
    assert_eq!(finest(&FINE, 4e5, 1.0), 6);
    assert_eq!(finest(&FINE, 1e30, 1.0), 0);
}

/// Hills of half a degree at 20° N 10° E, with samples 139 m apart, and flat elsewhere.
fn island() -> crate::elevation::Ground {
    use crate::elevation::{Georeference, GridLimits, HeightGrid, Registration};
    const SIDE: u32 = 401;
    let bounds = Bounds {
        south_rad: 20_f64.to_radians(),
        north_rad: 20.5_f64.to_radians(),
        west_rad: 10_f64.to_radians(),
        width_rad: 0.5_f64.to_radians(),
    };
    let place = Georeference::from_bounds(Registration::Posts, &bounds, SIDE, SIDE);
    let height =
        |n: u32| 500.0 + 400.0 * ((n % SIDE) as f32 * 0.4).sin() * ((n / SIDE) as f32 * 0.3).cos();
    let heights = (0..SIDE * SIDE).map(height).collect();
    let place = place.expect("a place");
    let grid = HeightGrid::new(&place, heights, &GridLimits::default());
    crate::elevation::Ground::from(grid.expect("a grid"))
}

#[test]
fn data_ahead_of_the_eye_bring_the_levels_that_reach_them() {
    let ground = island();
    let mut map = clipmap(at_once(16, Trim::Diamond));
    let mut finest = |lat_deg: f64| {
        let view = GroundView {
            tolerance_px: 1.0,
            ..over(lat_deg, 10.25, 3e3)
        };
        map.prepare(&view, &ground);
        map.counts.finest
    };
    // Level ℓ reaches 2.1 · 7060 km/2^ℓ, and cells are 220 km/2^ℓ; flat ground is drawn by level 5 at 3 km (3 m of curvature).
    assert_eq!(finest(0.0), 5);
    let near = finest(19.25);
    assert_eq!(near, 7, "83 km away");
    assert_eq!(finest(19.85), 9, "17 km away");
    // A rise over 139 m is within the tolerance of 3 m: 48 m between samples.
    assert_eq!(finest(20.25), 13);
    // An eye that moves to and fro toggles no level: a level that is there stays for a quarter of its reach.
    let mut before = finest(17.0);
    for step in 0..300 {
        let sway = if step % 2 == 0 { 0.0 } else { 0.02 };
        let now = finest(17.0 + 0.01 * f64::from(step) - sway);
        assert!(now >= before, "{now} after {before} at step {step}");
        before = now;
    }
    assert!(before > 9);
}

#[test]
fn a_frame_at_rest_or_on_its_way_looks_for_data_seldom() {
    struct Counting(crate::elevation::Ground, std::sync::atomic::AtomicU32);
    impl Elevation for Counting {
        fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
            self.0.height_m(lat_rad, lon_rad, spacing_rad)
        }
        fn range_m(&self, bounds: &Bounds) -> HeightRange {
            self.0.range_m(bounds)
        }
        fn finest_spacing_rad(&self, lat_rad: f64, lon_rad: f64) -> f64 {
            self.0.finest_spacing_rad(lat_rad, lon_rad)
        }
        fn finest_spacing_in(&self, bounds: &Bounds) -> f64 {
            self.1.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            self.0.finest_spacing_in(bounds)
        }
    }
    let ground = Counting(island(), 0.into());
    let mut map = clipmap(at_once(16, Trim::Diamond));
    let view = |step: u32| GroundView {
        tolerance_px: 1.0,
        // The eye moves 4 m a frame.
        ..over(20.25 + 3.6e-5 * f64::from(step), 10.25, 3e3)
    };
    // Twice: a level that is there searches farther than one that is not.
    map.prepare(&view(0), &ground);
    map.prepare(&view(0), &ground);
    let looks = || ground.1.swap(0, std::sync::atomic::Ordering::Relaxed);
    assert!(looks() >= 26);
    map.prepare(&view(0), &ground);
    assert_eq!(looks(), 0);
    for step in 0..100 {
        map.prepare(&view(step), &ground);
    }
    // Over 400 m: level 14, which is not there, searches again after 28 m, level 13 after 57 m, and so on.
    let looks = looks();
    assert!((10..40).contains(&looks), "{looks}");
}

#[test]
fn samples_are_those_there_are() {
    for samples in [0, 64, 127, 128, 513, u32::MAX] {
        let options = ClipmapOptions {
            samples,
            ..ClipmapOptions::default()
        };
        assert_eq!(Clipmap::new(options).err(), Some(SamplesError(samples)));
    }
    let mut map = clipmap(ClipmapOptions {
        samples: 257,
        ..at_once(2, Trim::Hexagon)
    });
    map.prepare(&over(26.6, 72.1, 1e4), &HILLS);
    assert_closed(&map, "257");
}

#[test]
fn the_far_side_of_the_globe_is_not_handed_over() {
    let mut map = clipmap(at_once(3, Trim::Diamond));
    let eye = over(90.0, 0.0, 4e5);
    // The identity matrix would keep only what is within a metre of the eye. This matrix keeps all of space: rows x, y, z are zero, w is
    // one.
    let mut clip = DMat4::ZERO;
    clip.w_axis.w = 1.0;
    let stats = map.prepare(
        &GroundView {
            clip_from_eye: clip,
            ..eye
        },
        &HILLS,
    );
    let mut handed = HashSet::default();
    map.for_each_patch(&mut |patch| {
        handed.insert(patch.key);
    });
    assert_eq!(handed.len(), stats.patches as usize);
    let of_globe: Vec<u64> = (0..16).filter(|key| handed.contains(key)).collect();
    // Level 1 is drawn about the pole in five buffers.
    assert!((16..21).all(|key| handed.contains(&key)));
    assert!(
        of_globe.len() < 10 && of_globe.iter().all(|key| *key < 10),
        "{of_globe:?}"
    );
}

#[test]
fn patches_meet_in_single_precision_too() {
    // Add as the GPU does: the rounded eye-relative origin plus the offset.
    for (lat_deg, lon_deg) in [(89.7, 40.0), (26.3, 71.8), (31.0, 40.0), (0.0, 180.0)] {
        let mut map = clipmap(at_once(12, Trim::Diamond));
        let mut worst_px = 0.0_f64;
        for k in 0..30 {
            // Moves by half a cell of the finest level and more, so that origins lag.
            let view = over(lat_deg + 0.004 * f64::from(k), lon_deg, 2000.0);
            map.prepare(&view, &HILLS);
            let mut seen: HashMap<Point, DVec3> = HashMap::default();
            for level in &map.levels[8..] {
                for buffer in &level.buffers {
                    let patch = &buffer.patch;
                    let origin = (patch.origin_itrf_m - view.eye_itrf_m).as_vec3();
                    for t in &patch.indices.triangles {
                        let offset = patch.vertices[*t as usize].from_origin_m;
                        let sum = (origin + offset).as_dvec3();
                        let exact = bits(patch.origin_itrf_m + offset.as_dvec3());
                        let other = *seen.entry(exact).or_insert(sum);
                        let gap_px = sum.distance(other) / sum.length() / view.pixel_rad;
                        worst_px = worst_px.max(gap_px);
                    }
                }
            }
        }
        println!("{lat_deg}° {lon_deg}°: {worst_px} px");
        assert!(worst_px < 1e-3, "{worst_px}");
    }
}
