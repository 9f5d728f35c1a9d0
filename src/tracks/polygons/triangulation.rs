//! Polygons in the plane as small triangles on the ellipsoid.

use super::plane::{FlatPolygon, PlanePoint};
use earcut::Earcut;
use glam::DVec3;
use std::collections::HashSet;
use std::f64::consts::PI;
use terrella_frames::Ellipsoid;

/// Longest edge of a triangle, radians of arc: equal to that of lines, so that outlines lie on the edges; longer for polygons that would need more
/// than [`USUAL_TRIANGLES`].
const STEP_RAD: std::ops::RangeInclusive<f64> = 0.5 * PI / 180.0..=1.3 * PI / 180.0;
/// Number of triangles of all polygons of a style above which edges are longer.
const USUAL_TRIANGLES: f64 = 20_000.0;
/// Largest relative difference between a polygon's area and that of its triangles.
const MAX_DEVIATION: f64 = 1e-6;

/// A triangle on the ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GroundTriangle {
    pub itrf_m: [DVec3; 3],
    /// Bit i: the edge opposite to corner i is an edge of the polygon. Bit 3 + i: corner i lies on such an edge, and none of the triangle's own
    /// edges does.
    pub edges: u32,
}

/// Notes which corners lie on edges of the polygon that belong to other triangles.
pub(super) fn mark_corners(triangles: &mut [GroundTriangle]) {
    let bits = |corner: DVec3| corner.to_array().map(f64::to_bits);
    let mut at_edge = HashSet::new();
    for triangle in triangles.iter() {
        for k in (0..3).filter(|k| triangle.edges >> k & 1 == 1) {
            at_edge.extend([1, 2].map(|on| bits(triangle.itrf_m[(k + on) % 3])));
        }
    }
    for triangle in triangles {
        for k in 0..3 {
            let beside = triangle.edges & 0b111 & !(1 << k);
            if beside == 0 && at_edge.contains(&bits(triangle.itrf_m[k])) {
                triangle.edges |= 8 << k;
            }
        }
    }
}

/// A triangulated polygon in the plane, without further corners.
pub(super) struct CutPolygon {
    triangles: Vec<PlaneTriangle>,
    twice_area: f64,
    /// Whether the triangles have the polygon's area: false if rings cross.
    pub is_sound: bool,
}

impl CutPolygon {
    pub fn new(flat: &FlatPolygon) -> Self {
        let holes: Vec<u32> = flat
            .rings
            .iter()
            .skip(1)
            .map(|first| *first as u32)
            .collect();
        let mut corners: Vec<u32> = Vec::new();
        Earcut::new().earcut(flat.points.iter().copied(), &holes, &mut corners);
        let edges = RingEdges::new(flat, &corners);
        let at = |index: u32| flat.points[index as usize];
        let triangles = corners.as_chunks::<3>().0.iter().map(|[a, b, c]| {
            let sides = [(*b, *c), (*c, *a), (*a, *b)];
            let bits = sides.iter().enumerate();
            let bits = bits.map(|(k, (from, to))| u32::from(edges.has(*from, *to)) << k);
            PlaneTriangle {
                corners: [at(*a), at(*b), at(*c)],
                edges: bits.sum(),
            }
        });
        let triangles: Vec<_> = triangles.collect();
        let areas = triangles.iter().map(|PlaneTriangle { corners, .. }| {
            let [a, b, c] = *corners;
            twice_area(a, b, c).abs()
        });
        let twice_area = areas.sum::<f64>();
        let off = (twice_area - twice_ring_area(flat)).abs();
        Self {
            triangles,
            twice_area,
            is_sound: off <= MAX_DEVIATION * twice_area.max(f64::MIN_POSITIVE),
        }
    }

    /// Adds triangles on the ellipsoid with edges of at most one step, until there are more than `most` in total.
    pub fn subdivide(
        &self,
        step_rad: f64,
        ellipsoid: &Ellipsoid,
        most: usize,
        triangles: &mut Vec<GroundTriangle>,
    ) {
        let first = triangles.len();
        for triangle in &self.triangles {
            triangle.subdivide(step_rad, ellipsoid, most, triangles);
            if triangles.len() > most {
                return;
            }
        }
        mark_corners(&mut triangles[first..]);
    }
}

/// The longest edge for these polygons.
pub(super) fn step_rad(polygons: &[CutPolygon]) -> f64 {
    step_for(polygons.iter().map(|polygon| polygon.twice_area).sum())
}

/// The longest edge for polygons of twice this area of the plane.
pub(super) fn step_for(twice: f64) -> f64 {
    // Two triangles have the area of a square of this side.
    let step_rad = (twice / USUAL_TRIANGLES).sqrt();
    step_rad.clamp(*STEP_RAD.start(), *STEP_RAD.end())
}

/// Twice the signed area of a triangle.
fn twice_area(a: PlanePoint, b: PlanePoint, c: PlanePoint) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
}

/// Twice the area of the outer ring without the holes: the shoelace formula.
fn twice_ring_area(flat: &FlatPolygon) -> f64 {
    let ends = flat.rings.iter().skip(1).copied();
    let ends = ends.chain([flat.points.len()]);
    let rings = flat.rings.iter().zip(ends).enumerate();
    let areas = rings.map(|(index, (first, end))| {
        let ring = &flat.points[*first..end];
        let fan = ring
            .windows(2)
            .map(|edge| twice_area(ring[0], edge[0], edge[1]));
        let area = fan.sum::<f64>().abs();
        if index == 0 { area } else { -area }
    });
    areas.sum()
}

/// Which corners of triangles are neighbours in a ring. Corners on a straight line are in no triangle: their two neighbours count as adjacent.
struct RingEdges {
    /// The next corner of a triangle in the ring, if the edge to it is an edge on the globe.
    next: Vec<Option<u32>>,
}

impl RingEdges {
    fn new(flat: &FlatPolygon, corners: &[u32]) -> Self {
        let mut is_used = vec![false; flat.points.len()];
        for corner in corners {
            is_used[*corner as usize] = true;
        }
        let mut next = vec![None; flat.points.len()];
        let ends = flat.rings.iter().skip(1).copied();
        for (first, end) in flat.rings.iter().zip(ends.chain([flat.points.len()])) {
            let used: Vec<usize> = (*first..end).filter(|index| is_used[*index]).collect();
            for (from, to) in used.iter().zip(used.iter().cycle().skip(1)) {
                next[*from] = flat.is_edge[*from].then_some(*to as u32);
            }
        }
        Self { next }
    }

    fn has(&self, a: u32, b: u32) -> bool {
        self.next[a as usize] == Some(b) || self.next[b as usize] == Some(a)
    }
}

/// A triangle of the plane.
#[derive(Clone, Copy)]
pub(super) struct PlaneTriangle {
    pub corners: [PlanePoint; 3],
    /// Bit i: the edge opposite to corner i is an edge of the polygon.
    pub edges: u32,
}

impl PlaneTriangle {
    /// Halves the longest edge until none is longer than a step. The decision depends only on the edge's end points, so both of its triangles
    /// agree: there are no gaps.
    pub fn subdivide(
        self,
        step_rad: f64,
        ellipsoid: &Ellipsoid,
        most: usize,
        triangles: &mut Vec<GroundTriangle>,
    ) {
        let mut left = vec![self];
        while let Some(triangle) = left.pop() {
            let [a, b, c] = triangle.corners;
            let lengths = [length(b, c), length(c, a), length(a, b)];
            let longest = (0..3).max_by(|i, j| lengths[*i].total_cmp(&lengths[*j]));
            match longest.filter(|longest| lengths[*longest] > step_rad) {
                Some(longest) => left.extend(triangle.halves(longest)),
                None => triangles.push(GroundTriangle {
                    itrf_m: triangle
                        .corners
                        .map(|[lon, lat]| ellipsoid.surface_point(Ellipsoid::normal(lat, lon))),
                    edges: triangle.edges,
                }),
            }
            if triangles.len() > most {
                return;
            }
        }
    }

    /// The two halves on either side of the line from corner `i` to the middle of its opposite edge.
    fn halves(self, i: usize) -> [Self; 2] {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let bit = |edge: usize, to: usize| (self.edges >> edge & 1) << to;
        let middle = [0, 1].map(|axis| 0.5 * (self.corners[j][axis] + self.corners[k][axis]));
        [
            Self {
                corners: [self.corners[i], self.corners[j], middle],
                edges: bit(i, 0) | bit(k, 2),
            },
            Self {
                corners: [self.corners[i], middle, self.corners[k]],
                edges: bit(i, 0) | bit(j, 1),
            },
        ]
    }
}

/// Arc length for comparison with a step, as in `steps_between` of lines.
fn length(a: PlanePoint, b: PlanePoint) -> f64 {
    let cos = a[1].cos().max(b[1].cos()).max(0.0);
    let along_parallel = (b[0] - a[0]).abs() * cos.sqrt();
    along_parallel.max((b[1] - a[1]).abs())
}

#[cfg(test)]
mod tests {
    use super::super::plane::flatten;
    use super::*;
    use std::collections::HashMap;
    use terrella_frames::Geodetic;

    fn triangles(rings: &[&[(f64, f64)]]) -> (Vec<GroundTriangle>, bool) {
        let place = |(lon, lat): &(f64, f64)| Geodetic::from_degrees(*lat, *lon, 0.0);
        let rings: Vec<Vec<_>> = rings
            .iter()
            .map(|ring| ring.iter().map(place).collect())
            .collect();
        let cut = [CutPolygon::new(&flatten(&rings))];
        let mut triangles = Vec::new();
        cut[0].subdivide(step_rad(&cut), &Ellipsoid::WGS84, 1_000_000, &mut triangles);
        (triangles, cut[0].is_sound)
    }

    fn area_m2(triangles: &[GroundTriangle]) -> f64 {
        let areas = triangles.iter().map(
            |GroundTriangle {
                 itrf_m: [a, b, c], ..
             }| { 0.5 * (*b - *a).cross(*c - *a).length() },
        );
        areas.sum()
    }

    /// Area of WGS 84 between two parallels within some degrees of longitude: the closed form with artanh (Snyder 1987, 3-12).
    fn zone_m2(south_deg: f64, north_deg: f64, width_deg: f64) -> f64 {
        let (a, f) = (6_378_137.0_f64, 1.0 / 298.257_223_563_f64);
        let b = a * (1.0 - f);
        let e = (f * (2.0 - f)).sqrt();
        let to_equator = |lat_deg: f64| {
            let sin = lat_deg.to_radians().sin();
            sin / (1.0 - (e * sin).powi(2)) + (e * sin).atanh() / e
        };
        0.5 * b * b * width_deg.to_radians() * (to_equator(north_deg) - to_equator(south_deg))
    }

    fn close(triangles: &[GroundTriangle], expected: f64) {
        let area = area_m2(triangles);
        // Chords of at most 1.3°.
        assert!((area / expected - 1.0).abs() < 3e-4, "{area} {expected}");
    }

    #[test]
    fn areas_are_those_of_the_ellipsoid_wherever_a_polygon_lies() {
        let rectangle = |west: f64, east: f64, south: f64, north: f64| {
            [
                (west, south),
                (east, south),
                (east, north),
                (west, north),
                (west, south),
            ]
        };
        let simple = rectangle(10.0, 30.0, 40.0, 50.0);
        close(&triangles(&[&simple]).0, zone_m2(40.0, 50.0, 20.0));
        // The other winding, across the date line, with a hole of either winding.
        let mut across = rectangle(170.0, -170.0, 40.0, 50.0);
        let hole = rectangle(-179.0, -174.0, 42.0, 47.0);
        for _ in 0..2 {
            let (with_hole, is_sound) = triangles(&[&across, &hole]);
            assert!(is_sound);
            close(
                &with_hole,
                zone_m2(40.0, 50.0, 20.0) - zone_m2(42.0, 47.0, 5.0),
            );
            across.reverse();
        }
        // Around both poles, and between two rings around one.
        let parallel = |lat: f64| [0.0, 90.0, 180.0, -90.0].map(|lon| (lon, lat));
        for south in [parallel(-60.0), parallel(60.0)] {
            close(&triangles(&[&south]).0, zone_m2(60.0, 90.0, 360.0));
        }
        let belt = triangles(&[&parallel(60.0), &parallel(70.0)]).0;
        close(&belt, zone_m2(60.0, 70.0, 360.0));
        // The whole map.
        let whole = [
            (-180.0, -90.0),
            (0.0, -90.0),
            (180.0, -90.0),
            (180.0, 90.0),
            (0.0, 90.0),
            (-180.0, 90.0),
        ];
        let (whole, _) = triangles(&[&whole]);
        assert!(whole.len() < 200_000, "{}", whole.len());
        close(&whole, zone_m2(-90.0, 90.0, 360.0));
    }

    /// Each inner edge has two triangles with identical end points, each polygon edge one: there are no gaps.
    #[test]
    fn triangles_meet_without_gaps() {
        let star: Vec<_> = (0..20)
            .map(|k| {
                let radius = if k % 2 == 0 { 9.0 } else { 3.5 };
                let (sin, cos) = (0.1 + PI * f64::from(k) / 10.0).sin_cos();
                (175.0 + radius * cos, 50.0 + radius * sin)
            })
            .collect();
        let hole = [(174.0, 49.0), (176.0, 49.0), (175.0, 51.0)];
        let (found, is_sound) = triangles(&[&star, &hole]);
        assert!(is_sound && found.len() > 500, "{}", found.len());
        let mut edges: HashMap<_, (u32, u32)> = HashMap::new();
        let bits = |point: DVec3| point.to_array().map(f64::to_bits);
        for triangle in &found {
            for k in 0..3 {
                let ends = [(k + 1) % 3, (k + 2) % 3].map(|end| bits(triangle.itrf_m[end]));
                let key = (ends[0].min(ends[1]), ends[0].max(ends[1]));
                let entry = edges.entry(key).or_default();
                entry.0 += 1;
                entry.1 += triangle.edges >> k & 1;
            }
        }
        for (count, at_edge) in edges.values() {
            assert!(
                [(2, 0), (1, 1)].contains(&(*count, *at_edge)),
                "{count} {at_edge}"
            );
        }
    }

    /// By latitude and longitude: a corner on the rectangle's edge is on such an edge of its triangle, or marked.
    #[test]
    fn corners_on_edges_are_marked() {
        let rectangle = [(10.0, 40.0), (14.0, 40.0), (14.0, 43.0), (10.0, 43.0)];
        let (found, _) = triangles(&[&rectangle]);
        let mut marked = 0;
        for triangle in &found {
            for k in 0..3 {
                let place = Ellipsoid::WGS84.geodetic_from_itrf(triangle.itrf_m[k]);
                let (lat, lon) = (place.lat_rad.to_degrees(), place.lon_rad.to_degrees());
                let on = |value: f64, bounds: [f64; 2]| {
                    bounds.iter().any(|bound| (value - bound).abs() < 1e-9)
                };
                let is_on_edge = on(lat, [40.0, 43.0]) || on(lon, [10.0, 14.0]);
                let has_edge = triangle.edges & 0b111 & !(1 << k) != 0;
                let is_marked = triangle.edges >> (3 + k) & 1 == 1;
                assert_eq!(is_marked, is_on_edge && !has_edge, "{lat} {lon}");
                marked += u32::from(is_marked);
            }
        }
        assert!(marked > 10, "{marked} of {}", found.len());
    }

    #[test]
    fn rings_that_cross_are_noticed_and_degenerate_ones_draw_nothing() {
        let bow_tie = [(0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (0.0, 8.0)];
        assert!(!triangles(&[&bow_tie]).1);
        for ring in [
            &[][..],
            &[(0.0, 0.0)],
            &[(0.0, 0.0), (1.0, 1.0)],
            &[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)],
        ] {
            let (found, is_sound) = triangles(&[ring]);
            assert!(found.is_empty() && is_sound, "{ring:?}");
        }
    }
}
