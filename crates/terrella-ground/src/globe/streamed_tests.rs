//! Every surface over heights that become finer while it is drawn: always closed, and in the end as if the final heights had always been
//! there.

use super::surface::GridUniforms;
use super::*;
use crate::elevation::{
    Elevation, Ground, HeightEye, HeightStreamOptions, StreamedGround, TestTiles,
};
use glam::{DVec3, dcamera};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::{Duration, Instant};
use terrella_frames::{Ellipsoid, Geodetic};

/// A position, a height and a slope, as bits.
type Corner = ([u64; 3], u32, [u32; 2]);

fn view(lat_deg: f64, lon_deg: f64, height_m: f64) -> GroundView {
    let place = Geodetic::from_degrees(lat_deg, lon_deg, height_m);
    let eye = Ellipsoid::WGS84.itrf_from_geodetic(place);
    let north = DVec3::Z.cross(eye).cross(-eye).normalize();
    let rotation = dcamera::rh::view::look_to_mat4(DVec3::ZERO, -eye.normalize(), north);
    let projection = dcamera::rh::proj::directx::perspective(1.6, 1.0, 10.0, 1e8);
    GroundView {
        eye_itrf_m: eye,
        clip_from_eye: projection * rotation,
        pixel_rad: 2e-3,
        tolerance_px: 1.0,
    }
}

fn corners(patch: &Patch) -> Vec<Corner> {
    let corner = |vertex: &GroundVertex| {
        // Avoid negative zeros.
        let at = patch.origin_itrf_m + vertex.from_origin_m.as_dvec3() + DVec3::ZERO;
        let slope = vertex.slope.to_array().map(f32::to_bits);
        (
            at.to_array().map(f64::to_bits),
            vertex.height_m.to_bits(),
            slope,
        )
    };
    patch.vertices.iter().map(corner).collect()
}

/// Each once, in order.
fn triangles(surface: &dyn Surface) -> Vec<[Corner; 3]> {
    let mut all = Vec::new();
    surface.for_each_patch(&mut |patch| {
        let corners = corners(patch);
        for [a, b, c] in patch.indices.triangles.as_chunks::<3>().0 {
            let mut of = [a, b, c].map(|k| corners[*k as usize]);
            // Start at the smallest corner.
            let least = (0..3).min_by_key(|k| of[*k]).unwrap_or(0);
            of.rotate_left(least);
            all.push(of);
        }
    });
    all.sort_unstable();
    all.dedup();
    all
}

/// Edges with one side must not be next to each other: a single one is the end of the drawn surface, two are a crack.
fn assert_closed(surface: &dyn Surface, when: &str) {
    let mut edges = Vec::new();
    for triangle in triangles(surface) {
        for k in 0..3 {
            let (a, b) = (triangle[k].0, triangle[(k + 1) % 3].0);
            if a != b {
                edges.push(if a < b { [a, b] } else { [b, a] });
            }
        }
    }
    edges.sort_unstable();
    let single = edges.chunk_by(|a, b| a == b).filter(|one| one.len() == 1);
    let ends: BTreeSet<[u64; 3]> = single.flatten().flatten().copied().collect();
    let mut by_direction: BTreeMap<[i64; 3], [u64; 3]> = BTreeMap::new();
    for end in ends {
        let at = DVec3::from_array(end.map(f64::from_bits));
        let way = at * Ellipsoid::WGS84.scaled_from_itrf();
        let key = (way.normalize() * 3e4).round().to_array().map(|x| x as i64);
        if let Some(other) = by_direction.insert(key, end) {
            let other = DVec3::from_array(other.map(f64::from_bits));
            let (a, b) = (at.normalize(), other.normalize());
            assert!(
                a.distance(b) > 1e-7,
                "{}: a crack of {} m {when}",
                surface.name(),
                at.distance(other)
            );
        }
    }
}

struct Flight {
    tiles: Arc<TestTiles>,
    stream: StreamedGround,
    viewer: Arc<crate::elevation::HeightViewer>,
    version: u64,
    heights: Arc<Ground>,
}

impl Flight {
    fn new() -> Self {
        // Three levels below the coarsest in one region, one level elsewhere.
        let inset = |key: crate::elevation::HeightTileKey| {
            let scale = 1_u32 << key.level;
            key.level >= 2
                || (62..70).contains(&(key.column * scale)) && (12..20).contains(&(key.row * scale))
        };
        let tiles = Arc::new(TestTiles::new(4, 16, inset).gated());
        let options = HeightStreamOptions::default();
        let stream = StreamedGround::new(tiles.clone(), Ground::new([]), &options).expect("sound");
        let viewer = stream.viewer();
        let (version, heights) = stream.now();
        Self {
            tiles,
            stream,
            viewer,
            version,
            heights,
        }
    }

    /// One frame, as an Earth makes it. Returns whether heights have changed.
    fn frame(&mut self, surface: &mut dyn Surface, view: &GroundView) -> (bool, SurfaceStats) {
        self.viewer.look(HeightEye {
            eye_itrf_m: view.eye_itrf_m,
            tolerance_rad: view.pixel_rad,
        });
        self.stream.take_over(2);
        let changes = self
            .stream
            .changes_since(self.version)
            .expect("not long ago");
        (self.version, self.heights) = self.stream.now();
        if !changes.is_empty() {
            surface.heights_changed(&changes, self.heights.as_ref());
        }
        let stats = surface.prepare(view, self.heights.as_ref());
        (!changes.is_empty(), stats)
    }
}

fn settings() -> Vec<SurfaceSettings> {
    let mut all: Vec<_> = SurfaceKind::ALL
        .iter()
        .map(|kind| kind.settings(Subdivision::Cells(24)))
        .collect();
    all.push(SurfaceSettings::CastContours(Default::default()));
    all.push(SurfaceSettings::ProjectedGrid(
        projected_grid::GridOptions {
            on_gpu: true,
            samples: (65, 65),
            ..Default::default()
        },
    ));
    for one in &mut all {
        if let SurfaceSettings::ProjectedGrid(grid) = one {
            grid.samples = (65, 65);
        }
    }
    all
}

/// Prepares until nothing changes.
fn settle(surface: &mut dyn Surface, view: &GroundView, heights: &dyn Elevation) {
    let (mut before, mut quiet) = (SurfaceStats::default(), 0);
    for _ in 0..3000 {
        let stats = surface.prepare(view, heights);
        quiet = if stats.samples_read == 0 && stats == before {
            quiet + 1
        } else {
            0
        };
        before = stats;
        if quiet > 12 {
            return;
        }
    }
    panic!("{} never settles", surface.name());
}

fn pages(surface: &dyn Surface) -> BTreeMap<[u64; 3], Vec<u8>> {
    let mut all = BTreeMap::new();
    surface.for_each_contour_page(&mut |page| {
        all.insert(
            page.origin_itrf_m.to_array().map(f64::to_bits),
            page.nodes.to_vec(),
        );
    });
    all
}

fn fly(settings: SurfaceSettings, view: &GroundView) {
    let mut flight = Flight::new();
    let mut surface = settings.make(Figure::Wgs84).expect("sound");
    let (mut arrivals, mut quiet, mut before) = (0, 0, SurfaceStats::default());
    let end = Instant::now() + Duration::from_secs(100);
    while quiet < 14 {
        assert!(Instant::now() < end, "{} never settles", surface.name());
        flight.tiles.allow(2);
        let (has_changed, stats) = flight.frame(surface.as_mut(), view);
        let is_still = stats.samples_read == 0 && stats == before && flight.stream.is_settled();
        before = stats;
        quiet = if is_still { quiet + 1 } else { 0 };
        if has_changed {
            arrivals += 1;
        } else if quiet == 0 && !flight.stream.is_settled() {
            flight.stream.wait(Duration::from_millis(2));
        }
        if has_changed && arrivals % 16 == 3 {
            assert_closed(surface.as_ref(), &format!("after {arrivals} arrivals"));
            assert!(stats.patches > 0);
        }
    }
    assert_closed(surface.as_ref(), "at last");
    let mut fresh = settings.make(Figure::Wgs84).expect("sound");
    settle(fresh.as_mut(), view, flight.heights.as_ref());
    assert!(
        flight.stream.is_settled(),
        "{} asks for other heights",
        surface.name()
    );
    match (surface.draw_kind(), fresh.draw_kind()) {
        (DrawKind::Grid(grid), DrawKind::Grid(other)) => {
            let [grid, other] = [grid, other].map(|grid| {
                let uniforms = grid.uniforms.expect("ground is seen");
                let slots = uniforms.slots.iter().flatten().flat_map(|s| s.to_array());
                let slots = slots.map(|slot| (slot != u32::MAX).then(|| grid.slot(slot).to_vec()));
                slots.collect::<Vec<_>>()
            });
            assert!(grid == other, "tiles differ");
        }
        (DrawKind::ContourPages(_), _) => {
            let (pages, others) = (pages(surface.as_ref()), pages(fresh.as_ref()));
            // Pages stay cut a little longer than needed; the pages that both have must be equal.
            let both = pages.iter().filter(|(at, _)| others.contains_key(*at));
            let same = both
                .clone()
                .filter(|(at, nodes)| others[*at] == **nodes)
                .count();
            assert!(
                same > 3 && same == both.count(),
                "{same} of {}",
                pages.len()
            );
        }
        _ if surface.name() == "quadtree" => {
            // Leaves stay divided a little longer than needed; the points that both have must be equal.
            let heights = |surface: &dyn Surface| {
                let corners = triangles(surface).into_iter().flatten();
                corners
                    .map(|(at, height, _)| (at, height))
                    .collect::<BTreeMap<_, _>>()
            };
            let (own, others) = (heights(surface.as_ref()), heights(fresh.as_ref()));
            let both = own.iter().filter(|(at, _)| others.contains_key(*at));
            assert!(both.clone().count() * 10 > others.len() * 7);
            for (at, height) in &own {
                let at = DVec3::from_array(at.map(f64::from_bits));
                let place = Ellipsoid::WGS84.geodetic_from_itrf(at);
                let data = flight.heights.height_m(place.lat_rad, place.lon_rad, 0.0);
                let off = (f64::from(f32::from_bits(*height)) - data).abs();
                assert!(off < 0.5, "a vertex is {off} m off its data");
            }
        }
        _ => {
            let (own, others) = (triangles(surface.as_ref()), triangles(fresh.as_ref()));
            let lost = others.iter().filter(|one| own.binary_search(one).is_err());
            let lost = lost.count();
            assert!(
                own == others,
                "{}: {lost} of {} differ",
                surface.name(),
                others.len()
            );
        }
    }
    if !matches!(settings, SurfaceSettings::Blocks(_)) {
        assert!(arrivals > 10, "{}: {arrivals} arrivals", surface.name());
    }
}

#[test]
fn from_orbit_every_surface_becomes_what_it_would_have_been() {
    for settings in settings() {
        fly(settings, &view(46.0, 9.0, 2e5));
    }
}

#[test]
fn near_the_ground_every_surface_becomes_what_it_would_have_been() {
    for settings in settings() {
        // On the common edge of four tiles.
        fly(settings, &view(45.02, 0.01, 9e3));
    }
}

#[test]
fn at_a_pole_every_surface_becomes_what_it_would_have_been() {
    for settings in settings() {
        fly(settings, &view(89.6, 20.0, 3e5));
    }
}

/// Each drawn patch: its position and its triangles.
fn drawn(surface: &dyn Surface) -> BTreeMap<[u64; 3], Vec<[Corner; 3]>> {
    let mut all: BTreeMap<_, Vec<_>> = BTreeMap::new();
    surface.for_each_patch(&mut |patch| {
        let corners = corners(patch);
        let triangles = patch.indices.triangles.as_chunks::<3>().0.iter();
        let triangles = triangles.map(|of| of.map(|k| corners[k as usize]));
        let origin = patch.origin_itrf_m.to_array().map(f64::to_bits);
        all.entry(origin).or_default().extend(triangles);
    });
    for triangles in all.values_mut() {
        triangles.sort_unstable();
    }
    all
}

/// Completes the view as an Earth does for stored images.
fn complete(flight: &mut Flight, surface: &mut dyn Surface, view: &GroundView) {
    let end = Instant::now() + Duration::from_secs(100);
    surface.forget_views();
    let (mut quiet, mut before, mut is_fresh) = (0, SurfaceStats::default(), true);
    loop {
        assert!(Instant::now() < end, "{} never settles", surface.name());
        flight.tiles.allow(8);
        let (has_changed, stats) = flight.frame(surface, view);
        is_fresh &= !has_changed;
        let is_still = stats.samples_read == 0 && stats == before && flight.stream.is_settled();
        (quiet, before) = (if is_still { quiet + 1 } else { 0 }, stats);
        if quiet < 10 {
            continue;
        }
        if is_fresh {
            return;
        }
        surface.forget_views();
        (quiet, is_fresh) = (0, true);
    }
}

#[test]
fn a_picture_that_is_kept_is_the_same_whatever_was_before() {
    let view_of = view;
    let view = |height_m| view_of(45.3, 4.0, height_m);
    for settings in settings() {
        let made = |before: &[GroundView]| {
            let mut flight = Flight::new();
            let mut surface = settings.make(Figure::Wgs84).expect("sound");
            for view in before {
                for _ in 0..12 {
                    flight.tiles.allow(2);
                    flight.frame(surface.as_mut(), view);
                }
                complete(&mut flight, surface.as_mut(), view);
            }
            complete(&mut flight, surface.as_mut(), &view(6e4));
            let grid = match surface.draw_kind() {
                DrawKind::Grid(grid) => grid.uniforms.map(|of| {
                    // The slot of a tile does not affect the image; its heights do.
                    let slots = of.slots.iter().flatten().flat_map(|s| s.to_array());
                    let slots = slots.filter(|slot| *slot != u32::MAX);
                    let heights: Vec<f32> = slots.flat_map(|s| grid.slot(s).to_vec()).collect();
                    let slots = bytemuck::Zeroable::zeroed();
                    let placed = GridUniforms { slots, ..*of };
                    (bytemuck::bytes_of(&placed).to_vec(), heights)
                }),
                _ => None,
            };
            (drawn(surface.as_ref()), pages(surface.as_ref()), grid)
        };
        let at_once = made(&[]);
        let from_far = made(&[view_of(46.5, 2.0, 2e5)]);
        let from_near = made(&[view_of(45.31, 4.02, 3e4)]);
        let differ = |other: &(BTreeMap<[u64; 3], Vec<[Corner; 3]>>, _, _)| {
            let same = other
                .0
                .iter()
                .filter(|(at, of)| at_once.0.get(*at) == Some(*of));
            other.0.len() - same.count()
        };
        let name = format!("{settings:?}");
        assert!(
            at_once == from_far,
            "{} patches from far: {name}",
            differ(&from_far)
        );
        assert!(
            at_once == from_near,
            "{} patches from near: {name}",
            differ(&from_near)
        );
        assert!(!at_once.0.is_empty() || !at_once.1.is_empty() || at_once.2.is_some());
    }
}
