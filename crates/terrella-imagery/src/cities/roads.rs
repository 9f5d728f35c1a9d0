//! Roads between places: lamps along the way from each place to the nearest larger one. Ways that lead to something larger never close to
//! a loop.

use super::map_light::{ByTexel, MapLight};
use super::noise::Noise;
use super::places::Place;
use super::point::LEAST_LIGHT;
use terrella_files::parallel;

/// Longest way, metres.
const LONGEST_M: f64 = 40_000.0;
/// Way between lamps, or what stands for them, metres.
const SPACING_M: f64 = 5_000.0;
/// How far lamps are off the straight way, metres.
const WINDING_M: f64 = 500.0;
/// Metres of a degree of latitude.
const DEGREE_M: f64 = 111_195.0;
/// Most places of a cell that are looked at.
const MOST_LOOKED_AT: usize = 256;
/// Side of the cells in which neighbours are looked for, degrees.
const CELL_DEG: f64 = 0.2;

/// Lamps along a road.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoadLamp {
    pub lat_deg: f64,
    pub lon_deg: f64,
    pub country: [u8; 2],
}

/// All roads.
pub struct Roads(ByTexel<RoadLamp>);

impl Roads {
    /// Between places, by their texels, where those have light.
    pub fn between(light: &MapLight, placed: &ByTexel<Place>) -> Self {
        let lit = light
            .lit()
            .iter()
            .filter(|(_, light)| *light >= LEAST_LIGHT);
        let lit = lit.flat_map(|(texel, _)| placed.of(*texel));
        let lit: Vec<Place> = lit.map(|(_, place)| *place).collect();
        let neighbours = Neighbours::new(&lit);
        let ways = parallel::map(lit.len().div_ceil(1024), |part| {
            let mut lamps = Vec::new();
            for (number, place) in lit.iter().enumerate().skip(1024 * part).take(1024) {
                if let Some(larger) = neighbours.nearest_larger(place) {
                    line(place, larger, number as u64, &mut lamps);
                }
            }
            lamps
        });
        let lamps = ways.into_iter().flatten();
        let lamps = lamps.map(|lamp: RoadLamp| (light.number_at(lamp.lat_deg, lamp.lon_deg), lamp));
        Self(ByTexel::new(lamps.collect()))
    }

    /// The lamps in a texel, each with its number.
    pub fn of(&self, texel: u32) -> &[(u32, RoadLamp)] {
        self.0.of(texel)
    }
}

/// Lamps along the way from one place to another.
fn line(from: &Place, to: &Place, seed: u64, lamps: &mut Vec<RoadLamp>) {
    let (east_m, north_m) = offset_m(from, to);
    let length_m = east_m.hypot(north_m);
    let count = (length_m / SPACING_M) as usize;
    let mut noise = Noise::new(seed);
    for number in 0..count {
        let along = (number as f64 + 0.5 + 0.8 * (noise.next() - 0.5)) / count as f64;
        let aside = WINDING_M * (noise.next() + noise.next() - 1.0) / length_m;
        let (east, north) = (
            along * east_m - aside * north_m,
            along * north_m + aside * east_m,
        );
        lamps.push(RoadLamp {
            lat_deg: from.lat_deg + north / DEGREE_M,
            lon_deg: from.lon_deg + east / (DEGREE_M * cos_lat(from)),
            country: from.country,
        });
    }
}

fn cos_lat(place: &Place) -> f64 {
    place.lat_deg.to_radians().cos().max(0.05)
}

/// From one place to another near it, metres east and north.
fn offset_m(from: &Place, to: &Place) -> (f64, f64) {
    let mut east_deg = to.lon_deg - from.lon_deg;
    if east_deg.abs() > 180.0 {
        east_deg -= 360.0_f64.copysign(east_deg);
    }
    (
        east_deg * cos_lat(from) * DEGREE_M,
        (to.lat_deg - from.lat_deg) * DEGREE_M,
    )
}

/// Places by cells of a grid.
struct Neighbours<'p> {
    columns: i64,
    rows: i64,
    starts: Vec<u32>,
    places: Vec<&'p Place>,
}

impl<'p> Neighbours<'p> {
    fn new(places: &'p [Place]) -> Self {
        let (columns, rows) = ((360.0 / CELL_DEG) as i64, (180.0 / CELL_DEG) as i64);
        let mut cells: Vec<(usize, &Place)> = places
            .iter()
            .map(|place| {
                let (row, column) = cell_of(place);
                (
                    (row.clamp(0, rows - 1) * columns + column.rem_euclid(columns)) as usize,
                    place,
                )
            })
            .collect();
        // From large to small: of a crowded cell the largest are looked at.
        cells.sort_by(|(cell_a, a), (cell_b, b)| {
            cell_a
                .cmp(cell_b)
                .then(b.population.total_cmp(&a.population))
        });
        let mut starts = vec![0; (rows * columns) as usize + 1];
        for (cell, _) in &cells {
            starts[cell + 1] += 1;
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        Self {
            columns,
            rows,
            starts,
            places: cells.into_iter().map(|(_, place)| place).collect(),
        }
    }

    /// The nearest place with more people, no farther than [`LONGEST_M`].
    fn nearest_larger(&self, place: &Place) -> Option<&'p Place> {
        let (row, column) = cell_of(place);
        // Metres of a cell from west to east, the shorter side.
        let cell_m = DEGREE_M * CELL_DEG * cos_lat(place);
        let mut nearest = None;
        let mut nearest_m = LONGEST_M;
        // Cells farther and farther away, until none can hold a nearer one.
        for away in 0.. {
            if f64::from(away - 1) * cell_m >= nearest_m {
                break;
            }
            for (north, east) in ring(away) {
                let row = row + i64::from(north);
                if !(0..self.rows).contains(&row) {
                    continue;
                }
                let column = (column + i64::from(east)).rem_euclid(self.columns);
                let cell = (row * self.columns + column) as usize;
                let cell = self.starts[cell] as usize..self.starts[cell + 1] as usize;
                let largest = self.places[cell].iter().take(MOST_LOOKED_AT);
                for other in largest.take_while(|other| other.population > place.population) {
                    let (east_m, north_m) = offset_m(place, other);
                    let distance_m = (east_m * east_m + north_m * north_m).sqrt();
                    if distance_m < nearest_m {
                        (nearest, nearest_m) = (Some(*other), distance_m);
                    }
                }
            }
        }
        nearest
    }
}

/// Steps to the cells that are so many cells away.
fn ring(away: i32) -> impl Iterator<Item = (i32, i32)> {
    (-away..=away).flat_map(move |north| {
        // All of the first and the last row, and the ends of the others.
        let step = if north.abs() == away { 1 } else { 2 * away };
        (-away..=away)
            .step_by(step.max(1) as usize)
            .map(move |east| (north, east))
    })
}

fn cell_of(place: &Place) -> (i64, i64) {
    (
        ((90.0 - place.lat_deg) / CELL_DEG) as i64,
        ((place.lon_deg + 180.0) / CELL_DEG) as i64,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(lat_deg: f64, lon_deg: f64, population: f64) -> Place {
        Place {
            lat_deg,
            lon_deg,
            population,
            country: *b"FR",
        }
    }

    /// Beside a search of all pairs by the angle between directions.
    #[test]
    fn ways_lead_to_the_nearest_larger_place_and_over_the_date_line() {
        let mut noise = Noise::new(7);
        let mut places: Vec<Place> = (0..400)
            .map(|_| {
                place(
                    60.0 + 3.0 * noise.next(),
                    176.0 + 8.0 * noise.next(),
                    1e3 + 1e6 * noise.next(),
                )
            })
            .collect();
        for place in &mut places {
            place.lon_deg -= if place.lon_deg >= 180.0 { 360.0 } else { 0.0 };
        }
        let direction = |place: &Place| {
            let (sin, cos) = place.lat_deg.to_radians().sin_cos();
            let (y, x) = place.lon_deg.to_radians().sin_cos();
            glam::DVec3::new(cos * x, cos * y, sin)
        };
        let neighbours = Neighbours::new(&places);
        let (mut found, mut over) = (0, 0);
        for place in &places {
            let angle = |other: &&Place| direction(place).distance(direction(other));
            let larger = places
                .iter()
                .filter(|other| other.population > place.population);
            let nearest = larger.min_by(|a, b| angle(a).total_cmp(&angle(b)));
            let nearest = nearest.filter(|other| angle(other) * 6.371e6 < 0.98 * LONGEST_M);
            if let Some(nearest) = nearest {
                let way = neighbours
                    .nearest_larger(place)
                    .expect("one is near enough");
                assert!(
                    angle(&way) < 1.02 * angle(&nearest),
                    "{place:?}: {way:?}, {nearest:?}"
                );
                found += 1;
                over += usize::from((place.lon_deg - way.lon_deg).abs() > 180.0);
            }
        }
        assert!(found > 300 && over > 5, "{found}, {over}");
    }

    #[test]
    fn lamps_stand_along_the_way() {
        let (from, to) = (place(48.0, 2.0, 1e4), place(48.0, 2.4, 1e5));
        let mut lamps = Vec::new();
        line(&from, &to, 3, &mut lamps);
        // 29.8 km.
        assert_eq!(lamps.len(), 5);
        assert!(lamps.is_sorted_by(|a, b| a.lon_deg < b.lon_deg));
        for lamp in lamps {
            assert!(
                (lamp.lat_deg - 48.0).abs() * DEGREE_M <= WINDING_M,
                "{lamp:?}"
            );
            assert!((2.0..2.4).contains(&lamp.lon_deg), "{lamp:?}");
        }
    }
}
