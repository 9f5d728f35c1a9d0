//! Rings on the globe as polygons in the plane of longitude and latitude: unwrapped across the date line, cut open at a pole.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use terrella_frames::Geodetic;

/// Tolerance for longitudes of the date line and latitudes of the poles, radians.
const ROUNDING_RAD: f64 = 1e-9;

/// Longitude and latitude, radians. Longitudes may lie beyond ±π.
pub(super) type PlanePoint = [f64; 2];

/// A polygon in the plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct FlatPolygon {
    /// Corners of all rings; no ring repeats its first corner.
    pub points: Vec<PlanePoint>,
    /// Index of each ring's first corner; the first ring is the outer one.
    pub rings: Vec<usize>,
    /// For each corner, whether the edge to the next corner is an edge on the globe and not a cut of the map.
    pub is_edge: Vec<bool>,
}

/// An unwrapped ring.
struct Unrolled {
    points: Vec<PlanePoint>,
    /// Angle by which it winds around the poles, radians: 0, or ±2π to the east or west.
    turn: f64,
}

/// The polygon of these rings. Rings with fewer than three corners are left out; with such an outer ring, the whole polygon.
pub(super) fn flatten(rings: &[Vec<Geodetic>]) -> FlatPolygon {
    let mut flat = FlatPolygon::default();
    let mut unrolled = rings.iter().map(|ring| unroll(ring));
    let Some(outer) = unrolled.next().filter(|outer| outer.points.len() > 2) else {
        return flat;
    };
    let (about_pole, holes): (Vec<_>, Vec<_>) = unrolled
        .filter(|hole| hole.points.len() > 2)
        .partition(|hole| hole.turn != 0.0);
    let middle = middle_of(&outer.points);
    match outer.turn == 0.0 {
        true => flat.add(outer.points),
        false => {
            let cut = outer.points.len();
            flat.add(strip(outer, about_pole.into_iter().next()));
            flat.is_edge[cut] = false;
            flat.is_edge
                .last_mut()
                .into_iter()
                .for_each(|last| *last = false);
        }
    }
    for mut hole in holes {
        // Shifted by full turns into its outer ring.
        let [lon, _] = middle_of(&hole.points);
        let shift = TAU * ((middle[0] - lon) / TAU).round();
        hole.points.iter_mut().for_each(|point| point[0] += shift);
        flat.add(hole.points);
    }
    flat
}

impl FlatPolygon {
    fn add(&mut self, ring: Vec<PlanePoint>) {
        self.rings.push(self.points.len());
        let next = ring.iter().cycle().skip(1);
        let edges = ring.iter().zip(next);
        self.is_edge
            .extend(edges.map(|(from, to)| !is_cut(*from, *to)));
        self.points.extend(ring);
    }
}

/// Whether an edge runs along the date line or a pole, where a map is cut and the globe is not.
fn is_cut(from: PlanePoint, to: PlanePoint) -> bool {
    let on_date_line = |point: PlanePoint| {
        let off = (point[0] - PI) / TAU;
        (off - off.round()).abs() * TAU < ROUNDING_RAD
    };
    let at_pole = |point: PlanePoint| FRAC_PI_2 - point[1].abs() < ROUNDING_RAD;
    (on_date_line(from) && on_date_line(to) && (from[0] - to[0]).abs() < ROUNDING_RAD)
        || (at_pole(from) && at_pole(to))
}

/// The middle of a ring's bounds.
fn middle_of(points: &[PlanePoint]) -> PlanePoint {
    [0, 1].map(|axis| {
        let values = points.iter().map(|point| point[axis]);
        let least = values.clone().fold(f64::INFINITY, f64::min);
        0.5 * (least + values.fold(f64::NEG_INFINITY, f64::max))
    })
}

fn unroll(ring: &[Geodetic]) -> Unrolled {
    let mut points: Vec<PlanePoint> = Vec::with_capacity(ring.len());
    for place in ring {
        let lon = match points.last() {
            Some([before, _]) => before + shorter_way(place.lon_rad - before),
            None => place.lon_rad,
        };
        let point = [lon, place.lat_rad.clamp(-FRAC_PI_2, FRAC_PI_2)];
        if points.last() != Some(&point) {
            points.push(point);
        }
    }
    let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
        return Unrolled { points, turn: 0.0 };
    };
    let end = last[0] + shorter_way(first[0] - last[0]);
    // All steps take the shorter way, so that they add up to full turns.
    let turn = TAU * ((end - first[0]) / TAU).round();
    if points.len() > 1 && (end - last[0]).abs() < ROUNDING_RAD && first[1] == last[1] {
        points.pop();
    }
    Unrolled { points, turn }
}

/// A ring around a pole, cut open: from its first corner around to the same corner, and back along the pole or along a hole around the pole. The
/// cut, which is the edge after that corner and the last edge, is the same meridian or segment on both sides, so that there is no gap.
fn strip(outer: Unrolled, hole: Option<Unrolled>) -> Vec<PlanePoint> {
    let Unrolled { mut points, turn } = outer;
    let first = points[0];
    let lats = points.iter().map(|point| point[1]).sum::<f64>();
    points.push([first[0] + turn, first[1]]);
    match hole {
        None => {
            let pole = FRAC_PI_2.copysign(lats);
            points.extend([[first[0] + turn, pole], [first[0], pole]]);
        }
        Some(mut hole) => {
            if hole.turn.signum() == turn.signum() {
                hole.points.reverse();
            }
            // From the end of the outer ring back by a full turn.
            let shift = TAU * ((first[0] + turn - hole.points[0][0]) / TAU).round();
            let start = [hole.points[0][0] + shift, hole.points[0][1]];
            points.extend(hole.points.iter().map(|[lon, lat]| [lon + shift, *lat]));
            points.push([start[0] - turn, start[1]]);
        }
    }
    points
}

/// A difference of longitudes, −π…π.
fn shorter_way(difference_rad: f64) -> f64 {
    difference_rad - TAU * (difference_rad / TAU).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(rings: &[&[(f64, f64)]]) -> FlatPolygon {
        let place = |(lon, lat): &(f64, f64)| Geodetic::from_degrees(*lat, *lon, 0.0);
        let rings: Vec<Vec<_>> = rings
            .iter()
            .map(|ring| ring.iter().map(place).collect())
            .collect();
        flatten(&rings)
    }

    fn degrees(flat: &FlatPolygon) -> Vec<[f64; 2]> {
        let point = |point: &PlanePoint| point.map(|angle| angle.to_degrees().round());
        flat.points.iter().map(point).collect()
    }

    #[test]
    fn rings_go_on_across_the_date_line_and_holes_lie_in_them() {
        let area = [
            (170.0, 0.0),
            (-170.0, 0.0),
            (-170.0, 10.0),
            (170.0, 10.0),
            (170.0, 0.0),
        ];
        let hole = [(-179.0, 2.0), (-175.0, 2.0), (-175.0, 4.0)];
        let flat = flat(&[&area, &hole]);
        assert_eq!(flat.rings, [0, 4]);
        let expected = [
            [170.0, 0.0],
            [190.0, 0.0],
            [190.0, 10.0],
            [170.0, 10.0],
            [181.0, 2.0],
            [185.0, 2.0],
            [185.0, 4.0],
        ];
        assert_eq!(degrees(&flat), expected);
        assert!(flat.is_edge.iter().all(|is_edge| *is_edge));
    }

    #[test]
    fn rings_about_a_pole_are_cut_open_and_cuts_are_no_edges() {
        let south: Vec<_> = [0.0, 120.0, -120.0].map(|lon| (lon, -60.0)).into();
        let flat_south = flat(&[&south]);
        let expected = [
            [0.0, -60.0],
            [120.0, -60.0],
            [240.0, -60.0],
            [360.0, -60.0],
            [360.0, -90.0],
            [0.0, -90.0],
        ];
        assert_eq!(degrees(&flat_south), expected);
        assert_eq!(flat_south.is_edge, [true, true, true, false, false, false]);
        // The edge of a map: along 180° and the pole.
        let half = flat(&[&[(90.0, -70.0), (90.0, -90.0), (180.0, -90.0), (180.0, -70.0)]]);
        assert_eq!(half.is_edge, [true, false, false, true]);
        // Around a pole with a hole around it, with the same winding.
        let hole: Vec<_> = [10.0, 130.0, -110.0].map(|lon| (lon, -80.0)).into();
        let flat = flat(&[&south, &hole]);
        let expected = [
            [0.0, -60.0],
            [120.0, -60.0],
            [240.0, -60.0],
            [360.0, -60.0],
            [250.0, -80.0],
            [130.0, -80.0],
            [10.0, -80.0],
            [-110.0, -80.0],
        ];
        assert_eq!(degrees(&flat), expected);
        assert_eq!(
            flat.is_edge,
            [true, true, true, false, true, true, true, false]
        );
    }
}
