//! Roads between places: lamps along the way from each place to the nearest larger one. Ways that lead to something larger never close to
//! a loop.

use super::map_light::{ByTexel, MapLight, TexelRegion};
use super::noise::Noise;
use super::places::Place;

/// Longest way, metres.
const LONGEST_M: f64 = 40_000.0;
/// Spacing of lamps, or of points that represent several, metres.
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

/// All roads: those of an area are computed when its lamps are requested.
pub struct Roads(Neighbours);

impl Roads {
    /// Between places.
    pub fn between(places: Vec<Place>) -> Self {
        Self(Neighbours::new(places))
    }

    /// The lamps in some texels of a map, by texels.
    pub fn lamps_in(&self, light: &MapLight, region: &TexelRegion) -> ByTexel<RoadLamp> {
        let (width, height) = light.size();
        let lat_deg = |row: usize| 90.0 - 180.0 * row as f64 / height as f64;
        let lon_deg = |column: usize| 360.0 * column as f64 / width as f64 - 180.0;
        let from_deg = (lat_deg(region.rows.end), lon_deg(region.columns.start));
        let to_deg = (lat_deg(region.rows.start), lon_deg(region.columns.end));
        let reach_deg = (LONGEST_M + WINDING_M) / DEGREE_M;
        let mut numbers = self.0.numbers_about(from_deg, to_deg, reach_deg);
        numbers.sort_unstable();
        let (mut lamps, mut located) = (Vec::new(), Vec::new());
        for number in numbers {
            let place = self.0.place(number);
            if let Some(larger) = self.0.nearest_larger(place) {
                lamps.clear();
                line(place, larger, u64::from(number), &mut lamps);
                located.extend(lamps.iter().filter_map(|lamp| {
                    let (row, column) = light.texel_at(lamp.lat_deg, lamp.lon_deg);
                    let is_in = region.rows.contains(&row) && region.columns.contains(&column);
                    is_in.then_some(((row * width + column) as u32, *lamp))
                }));
            }
        }
        ByTexel::new(&located)
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
            lon_deg: from.lon_deg + east / (DEGREE_M * cos_lat(from.lat_deg)),
            country: from.country,
        });
    }
}

fn cos_lat(lat_deg: f64) -> f64 {
    lat_deg.to_radians().cos().max(0.05)
}

/// From one place to another near it, metres east and north.
fn offset_m(from: &Place, to: &Place) -> (f64, f64) {
    let mut east_deg = to.lon_deg - from.lon_deg;
    if east_deg.abs() > 180.0 {
        east_deg -= 360.0_f64.copysign(east_deg);
    }
    (
        east_deg * cos_lat(from.lat_deg) * DEGREE_M,
        (to.lat_deg - from.lat_deg) * DEGREE_M,
    )
}

/// Places by cells of a grid.
struct Neighbours {
    columns: i64,
    rows: i64,
    starts: Vec<u32>,
    places: Vec<Place>,
    /// Numbers of places, by cells.
    numbers: Vec<u32>,
}

impl Neighbours {
    fn new(places: Vec<Place>) -> Self {
        let (columns, rows) = ((360.0 / CELL_DEG) as i64, (180.0 / CELL_DEG) as i64);
        let cells: Vec<usize> = places
            .iter()
            .map(|place| {
                let (row, column) = cell_of(place);
                (row.clamp(0, rows - 1) * columns + column.rem_euclid(columns)) as usize
            })
            .collect();
        let mut starts = vec![0; (rows * columns) as usize + 1];
        for cell in &cells {
            starts[cell + 1] += 1;
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        // Each start is moved on to the end of its cell, where the next begins.
        let mut numbers = vec![0; places.len()];
        for (number, cell) in (0..).zip(&cells) {
            numbers[starts[*cell] as usize] = number;
            starts[*cell] += 1;
        }
        starts.rotate_right(1);
        starts[0] = 0;
        // In order of decreasing population: of a crowded cell only the largest are considered.
        let population = |number: &u32| places[*number as usize].population;
        let mut first = 0;
        while first < numbers.len() {
            let cell = cells[numbers[first] as usize];
            let end = starts[cell + 1] as usize;
            let cell = &mut numbers[first..end];
            cell.sort_by(|a, b| population(b).total_cmp(&population(a)));
            first = end;
        }
        Self {
            columns,
            rows,
            starts,
            places,
            numbers,
        }
    }

    fn place(&self, number: u32) -> &Place {
        &self.places[number as usize]
    }

    /// Numbers of the places of a cell, from large to small.
    fn of_cell(&self, cell: usize) -> &[u32] {
        &self.numbers[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// Numbers of all places between two corners, latitude and longitude in degrees, or closer than `reach_deg` of a great circle.
    fn numbers_about(&self, from_deg: (f64, f64), to_deg: (f64, f64), reach_deg: f64) -> Vec<u32> {
        let rows = [to_deg.0 + reach_deg, from_deg.0 - reach_deg].map(row_of);
        let rows = rows[0].max(0)..=rows[1].min(self.rows - 1);
        // A degree of longitude is shortest where it is nearest to a pole.
        let farthest_deg = from_deg.0.abs().max(to_deg.0.abs()) + reach_deg;
        let reach_deg = reach_deg / cos_lat(farthest_deg.min(90.0));
        let [west, east] = [from_deg.1 - reach_deg, to_deg.1 + reach_deg].map(column_of);
        let columns = west..(east + 1).min(west + self.columns);
        let cells = rows.flat_map(|row| columns.clone().map(move |column| (row, column)));
        let cells = cells
            .map(|(row, column)| (row * self.columns + column.rem_euclid(self.columns)) as usize);
        cells.flat_map(|cell| self.of_cell(cell)).copied().collect()
    }

    /// The nearest place with more people, no farther than [`LONGEST_M`].
    fn nearest_larger(&self, place: &Place) -> Option<&Place> {
        let (row, column) = cell_of(place);
        // Metres of a cell from west to east, the shorter side.
        let cell_m = DEGREE_M * CELL_DEG * cos_lat(place.lat_deg);
        let mut nearest = None;
        let mut nearest_m = LONGEST_M;
        // Rings of cells at increasing distance, until none can contain a nearer one.
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
                let all = self.of_cell(cell).iter().map(|number| self.place(*number));
                let largest = all.take(MOST_LOOKED_AT);
                for other in largest.take_while(|other| other.population > place.population) {
                    let (east_m, north_m) = offset_m(place, other);
                    let distance_m = (east_m * east_m + north_m * north_m).sqrt();
                    if distance_m < nearest_m {
                        (nearest, nearest_m) = (Some(other), distance_m);
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
    (row_of(place.lat_deg), column_of(place.lon_deg))
}

fn row_of(lat_deg: f64) -> i64 {
    ((90.0 - lat_deg) / CELL_DEG) as i64
}

/// Beyond 180° W and 180° E it goes on.
fn column_of(lon_deg: f64) -> i64 {
    ((lon_deg + 180.0) / CELL_DEG).floor() as i64
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

    /// Compared with a search of all pairs by the angle between directions.
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
        let neighbours = Neighbours::new(places.clone());
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
