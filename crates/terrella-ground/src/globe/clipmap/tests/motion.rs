//! A moving eye: what is read, what changes, and that nothing jumps.

use super::*;
use crate::globe::surface::GroundVertex;
use proptest::prelude::*;

fn source<'a>(icosahedron: &'a Icosahedron, ground: &'a Rule) -> HeightSource<'a> {
    HeightSource {
        ellipsoid: &Ellipsoid::WGS84,
        icosahedron,
        ground,
    }
}

/// A level of 65 samples, filled about a middle.
fn filled(number: u32, middle: LatticeIndex, source: &HeightSource<'_>) -> Level {
    let mut level = Level::new(number, 32, Trim::Diamond);
    let extent = level.extent_about(middle);
    assert!(level.await_extent(extent, source, &mut u64::MAX.clone(), &mut 0));
    level
}

#[test]
fn a_move_by_a_cell_reads_its_l_and_nothing_else() {
    let icosahedron = Icosahedron::default();
    let source = source(&icosahedron, &HILLS);
    let middle = LatticeIndex {
        diamond: 3,
        i: 200,
        j: 180,
    };
    for (di, dj, new) in [
        (1, 0, 65),
        (0, -1, 65),
        (1, 1, 129),
        (-2, 2, 2 * 65 * 2 - 4),
        (0, 0, 0),
    ] {
        let mut level = filled(4, middle, &source);
        let target = level.extent_about(LatticeIndex {
            i: middle.i + di,
            j: middle.j + dj,
            ..middle
        });
        assert_eq!(level.missing(&target), new, "{di} {dj}");
        let mut budget = 10_000;
        assert!(level.fill(&target, &source, &mut budget, &mut 0));
        assert_eq!(10_000 - budget, new);
        assert_eq!(level.missing(&target), 0);
    }
    // The same across a border: points of the border are in both diamonds, and no more is read.
    let border = LatticeIndex {
        diamond: 3,
        i: 200,
        j: 0,
    };
    let mut level = filled(4, border, &source);
    let target = level.extent_about(LatticeIndex { j: 2, ..border });
    assert_eq!(level.missing(&target), 2 * 65);
    level.fill(&target, &source, &mut 10_000, &mut 0);
    // In the neighbour's indices, nothing is new.
    let corner = DiamondCorner {
        diamond: 3,
        corner: 1,
    };
    let named = corner.left();
    let (p, q) = corner.steps(200, 0, 512);
    assert_eq!(p, 0);
    let renamed = named.index(q, 0, 512);
    let mut level = filled(4, border, &source);
    let target = level.extent_about(renamed);
    assert_ne!(renamed.diamond, border.diamond);
    assert_eq!(level.missing(&target), 0);
    assert!(level.fill(&target, &source, &mut 0, &mut 0));
}

type Drawn = HashMap<(u32, LatticeIndex), (DVec3, GroundVertex)>;

/// The position of the drawn surface at a point of a level's lattice: at a vertex, or halfway along a coarser edge.
fn drawn_at(all: &Drawn, (level, index): (u32, LatticeIndex)) -> Option<DVec3> {
    if let Some((point, _)) = all.get(&(level, index)) {
        return Some(*point);
    }
    let coarser = level.checked_sub(1)?;
    let LatticeIndex { diamond, i, j } = index;
    let at = |i, j| drawn_at(all, (coarser, LatticeIndex { diamond, i, j }));
    let (x, y) = (at((i + 1) / 2, j / 2)?, at(i / 2, (j + 1) / 2)?);
    Some(0.5 * (x + y))
}

/// All drawn vertices, by level and point.
fn drawn(map: &Clipmap) -> Drawn {
    let mut all = Drawn::default();
    for level in &map.levels[..=map.counts.finest as usize] {
        let whole = level.n;
        for buffer in &level.buffers {
            let used: HashSet<u32> = buffer.patch.indices.triangles.iter().copied().collect();
            let spans = match &level.extent {
                Some(extent) => extent
                    .boxes()
                    .find(|(d, _)| *d == buffer.diamond)
                    .map(|(_, s)| (s.least, s.most)),
                None => Some(((0, 0), (whole, whole))),
            };
            let Some((least, most)) = spans else { continue };
            for i in least.0..=most.0 {
                for j in least.1..=most.1 {
                    let slot = buffer.slot(i, j);
                    if used.contains(&(slot as u32)) {
                        let vertex = buffer.patch.vertices[slot];
                        let point = buffer.patch.origin_itrf_m + vertex.from_origin_m.as_dvec3();
                        all.insert(
                            (
                                level.number,
                                LatticeIndex {
                                    diamond: buffer.diamond,
                                    i,
                                    j,
                                },
                            ),
                            (point, vertex),
                        );
                    }
                }
            }
        }
    }
    all
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn after_any_walk_all_is_as_if_built_anew(
        start in 0..30_usize,
        steps in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, 0.0..5.0_f64), 1..12),
        hexagon in any::<bool>(),
    ) {
        let trim = if hexagon { Trim::Hexagon } else { Trim::Diamond };
        let places = odd_places();
        let (lat, lon) = places[start % places.len()];
        let mut eye = over(lat, lon, 2000.0).eye_itrf_m;
        let mut map = clipmap(at_once(7, trim));
        map.prepare(&view_from(eye), &HILLS);
        for (x, y, length) in steps {
            // Steps from metres to hundreds of kilometres in the tangent plane, back to 2 km of height.
            let (east, north) = eye.normalize().any_orthonormal_pair();
            eye += (east * x + north * y) * 10_f64.powf(1.0 + length);
            let ground = Ellipsoid::WGS84.geodetic_from_itrf(eye);
            eye = Ellipsoid::WGS84.itrf_from_geodetic(Geodetic { height_m: 2000.0, ..ground });
            map.prepare(&view_from(eye), &HILLS);
        }
        assert_closed(&map, "after a walk");
        let icosahedron = Icosahedron::default();
        let source = source(&icosahedron, &HILLS);
        for at in 1..=map.counts.finest as usize {
            let level = &map.levels[at];
            let extent = level.extent.clone().expect("drawn");
            let mut fresh = Level::new(level.number, level.radius, trim);
            prop_assert!(fresh.await_extent(extent.clone(), &source, &mut u64::MAX.clone(), &mut 0));
            fresh.blend_into(Some(&map.levels[at - 1]));
            let extent = fresh.extent.as_ref().expect("filled");
            for (diamond, span) in extent.boxes() {
                let part = extent.in_diamond(diamond).expect("a box");
                let find = |level: &Level| level.buffers.iter().position(|s| s.diamond == diamond).expect("a buffer");
                let (old, new) = (&level.buffers[find(level)], &fresh.buffers[find(&fresh)]);
                for i in span.least.0..=span.most.0 {
                    for j in span.least.1..=span.most.1 {
                        if part.distance(i, j) <= extent.radius {
                            let slot = old.slot(i, j);
                            let vertices = [old, new].map(|buffer| {
                                let vertex = buffer.patch.vertices[slot];
                                let point = buffer.patch.origin_itrf_m + vertex.from_origin_m.as_dvec3();
                                (bits(point), vertex.height_m.to_bits(), vertex.slope.to_array().map(f32::to_bits))
                            });
                            prop_assert_eq!(vertices[0], vertices[1]);
                            prop_assert_eq!(old.own(i, j).height_m, new.own(i, j).height_m);
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn who_takes_only_what_changed_has_all_of_it() {
    let mut map = clipmap(ClipmapOptions {
        samples_per_prepare: 3000,
        fade_prepares: 3,
        ..at_once(6, Trim::Diamond)
    });
    let mut copies: HashMap<u64, (u64, Vec<GroundVertex>)> = HashMap::default();
    let (mut all, mut sent) = (0, 0);
    for k in 0..400 {
        // Over the pole and through a corner of the icosahedron, with two jumps.
        let lat = 89.0 + 0.01 * f64::from(k);
        let view = match k {
            150..200 => over(26.3 + 0.01 * f64::from(k - 150), 72.1, 5000.0),
            _ => over(
                lat.min(180.0 - lat),
                if lat > 90.0 { 180.0 } else { 0.0 },
                5000.0,
            ),
        };
        map.prepare(&view, &HILLS);
        map.for_each_patch(&mut |patch| {
            let (revision, copy) = copies.entry(patch.key).or_default();
            if *revision + 1 == patch.revision {
                for range in &patch.changed {
                    let range = range.start as usize..range.end as usize;
                    copy[range.clone()].copy_from_slice(&patch.vertices[range.clone()]);
                    sent += range.len();
                }
            } else if *revision != patch.revision {
                copy.clone_from(&patch.vertices);
            }
            *revision = patch.revision;
            for index in &patch.indices.triangles {
                assert_eq!(
                    copy[*index as usize], patch.vertices[*index as usize],
                    "{k}"
                );
            }
            all += patch.vertices.len();
        });
    }
    assert!(sent < all / 4, "{sent} of {all}");
}

#[test]
fn an_eye_at_rest_changes_nothing() {
    let mut map = clipmap(at_once(6, Trim::Diamond));
    let view = over(48.0, 11.0, 2000.0);
    settle(&mut map, &view, &HILLS);
    let state = |map: &Clipmap| {
        let mut all = Vec::new();
        map.for_each_patch(&mut |patch| {
            all.push((
                patch.key,
                patch.revision,
                std::sync::Arc::as_ptr(&patch.indices),
            ));
        });
        all
    };
    let before = state(&map);
    let stats = map.prepare(&view, &HILLS);
    assert_eq!((stats.samples_read, state(&map)), (0, before));
}

#[test]
fn a_change_of_home_changes_nothing() {
    let icosahedron = Icosahedron::default();
    // Just on either side of every border, near corners and far from them.
    let n = 1 << 20;
    for diamond in 0..DIAMONDS {
        for part in [0.0, 1e-4, 0.5] {
            let t = (part * n as f64) as i64;
            for (i, j) in [(0, t), (t, 0), (n, t), (t, n)] {
                let on = icosahedron.direction(LatticeIndex { diamond, i, j }, n);
                let (i, j) = (i.clamp(1, n - 1), j.clamp(1, n - 1));
                let inside = icosahedron.direction(LatticeIndex { diamond, i, j }, n);
                let eye = |nudge: f64| {
                    let up = (on + (inside - on).normalize_or_zero() * nudge).normalize();
                    view_from(Ellipsoid::WGS84.surface_point(up) + up * 3000.0)
                };
                let mut map = clipmap(at_once(6, Trim::Diamond));
                map.prepare(&eye(1e-9), &HILLS);
                let before: HashSet<[Point; 3]> = triangles(&map).into_iter().collect();
                let stats = map.prepare(&eye(-1e-9), &HILLS);
                let after: HashSet<[Point; 3]> = triangles(&map).into_iter().collect();
                assert_eq!(stats.samples_read, 0);
                assert!(before == after, "{diamond} {i} {j}");
            }
        }
    }
}

#[test]
fn nothing_jumps_on_the_way() {
    // A tenth of the finest cell a step, over a border near a corner, over a pole, and far from both. Then up and down through the heights
    // where levels appear and disappear.
    let flights: Vec<Vec<GroundView>> = vec![
        (0..30)
            .map(|k| over(26.03 + 2e-3 * f64::from(k), 72.01, 4000.0))
            .collect(),
        (0..30)
            .map(|k| {
                let lat = 89.97 + 2e-3 * f64::from(k);
                over(
                    lat.min(180.0 - lat),
                    if lat > 90.0 { 190.0 } else { 10.0 },
                    4000.0,
                )
            })
            .collect(),
        (0..30)
            .map(|k| over(40.0, 35.9 + 2e-3 * f64::from(k), 4000.0))
            .collect(),
        (0..240)
            .map(|k| {
                let t = f64::from(k) / 120.0 - 1.0;
                GroundView {
                    tolerance_px: 1.0,
                    ..over(40.0, 35.9, 3000.0 * (11.0 * (1.0 - t.abs())).exp2())
                }
            })
            .collect(),
    ];
    for (flight, views) in flights.iter().enumerate() {
        let mut map = clipmap(ClipmapOptions {
            fade_prepares: 8,
            ..at_once(7, Trim::Diamond)
        });
        settle(&mut map, &views[0], &HILLS);
        let mut before = drawn(&map);
        let mut worst_px = 0.0_f64;
        let mut levels = HashSet::default();
        for view in views {
            map.prepare(view, &HILLS);
            let after = drawn(&map);
            levels.insert(map.counts.finest);
            // Compare each vertex of one with the surface of the other, whether a vertex is there or not.
            for key in before.keys().chain(after.keys()) {
                let (Some(old), Some(new)) = (drawn_at(&before, *key), drawn_at(&after, *key))
                else {
                    continue;
                };
                let distance_m = new.distance(view.eye_itrf_m);
                worst_px = worst_px.max(new.distance(old) / distance_m / view.pixel_rad);
            }
            before = after;
        }
        println!("flight {flight}: {worst_px} px");
        assert!(worst_px > 0.0 && (flight < 3 || levels.len() > 3));
        // Without blending it is 0.4…0.8 px, without fading 0.13 px.
        let most_px = if flight < 3 { 0.3 } else { 0.05 };
        assert!(worst_px < most_px, "flight {flight}: {worst_px} px");
    }
}

#[test]
fn levels_come_and_go_as_the_surface_below_them() {
    // While fully faded, a level equals the coarser surface to the last bit where both have a vertex.
    let mut map = clipmap(ClipmapOptions {
        fade_prepares: 1 << 20,
        ..at_once(1, Trim::Diamond)
    });
    let view = over(26.0, 72.0, 5000.0);
    map.prepare(&view, &HILLS);
    assert_eq!(map.counts.finest, 1);
    let mut most = 0.0_f64;
    for ((level, index), (point, _)) in drawn(&map) {
        if level == 1 && index.i % 2 == 0 && index.j % 2 == 0 {
            let half = index.halved();
            let buffer = &map.levels[0].buffers[half.diamond as usize];
            let coarse =
                buffer.patch.origin_itrf_m + buffer.own(half.i, half.j).from_origin_m.as_dvec3();
            most = most.max(coarse.distance(point));
        }
    }
    // A millionth of the difference between the levels, on the grid of 1 m.
    assert!(most <= 1.8, "{most}");
    assert_closed(&map, "fading");
}

#[test]
fn an_eye_that_outruns_its_samples_sees_coarser_ground_without_cracks() {
    for trim in [Trim::Diamond, Trim::Hexagon] {
        let options = ClipmapOptions {
            samples_per_prepare: 700,
            fade_prepares: 2,
            ..at_once(6, trim)
        };
        let mut map = clipmap(options);
        let mut finest = Vec::new();
        for k in 0..260 {
            let k = f64::from(k);
            // Jumps to the antipodes, slows down, stands still.
            let (lat, lon) = match k as u32 {
                0..60 => (10.0 + 0.2 * k, 30.0 + 0.4 * k),
                60..90 => (26.565, 72.0 + 0.001 * k),
                90..120 => (-80.0 - 0.3 * (k - 90.0), 170.0 + k - 90.0),
                _ => (-89.99, 170.0),
            };
            let stats = map.prepare(&over(lat, lon, 3000.0), &CLIFFS);
            let globe = if k == 0.0 { 10 * 33 * 33 } else { 0 };
            assert!(stats.samples_read <= 700 + globe);
            if (k as u32).is_multiple_of(7) || (58..70).contains(&(k as u32)) {
                assert_closed(&map, &format!("{trim:?} {k}"));
            }
            finest.push(map.counts.finest);
        }
        assert!(finest[..60].iter().any(|f| *f < 3), "{finest:?}");
        assert_eq!(finest.last(), Some(&6));
        let mut other = clipmap(at_once(6, trim));
        other.prepare(&over(-89.99, 170.0, 3000.0), &CLIFFS);
        let all = |map: &Clipmap| triangles(map).into_iter().collect::<HashSet<_>>();
        assert!(
            all(&map) == all(&other),
            "what was waited for is what comes at once"
        );
    }
}
