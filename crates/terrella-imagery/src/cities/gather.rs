//! How a texel's light is divided among its points.

use super::lamps::{LIGHT_OF_MAP, lamp_of};
use super::map_light::MapLight;
use super::noise::Noise;
use super::places::Place;
use super::point::{CityLight, EARTH_M, cell_of, up_at};
use super::roads::RoadLamp;
use std::f64::consts::{PI, TAU};

/// Part of the light of a texel with places that its roads have.
const ROAD_SHARE: f64 = 0.15;
/// Most lamps of roads in a texel.
const MOST_ROAD_LAMPS: usize = 4;
/// Light grows with the population to this power.
const LIGHT_BY_POPULATION: f64 = 0.85;
/// A place of so many people is one point; larger ones have districts, their number growing with the power.
const DISTRICT_POPULATION: f64 = 20_000.0;
const DISTRICTS_BY_POPULATION: f64 = 0.6;
const MOST_DISTRICTS: f64 = 40.0;
/// Spacing of the districts of a place of 100 000 people, metres, and the exponent of its growth.
const TOWN_M: f64 = 1_500.0;
const TOWN_BY_POPULATION: f64 = 0.42;
/// Limits of the brightness of a point's middle, relative to the map's brightest texels.
const BRIGHTEST_POINT: f64 = 2.0;
const DIMMEST_POINT: f64 = 0.15;
/// Standard deviation of a district's lamps relative to the spacing of districts and their number, and of synthetic points relative to the
/// radius of their part of the texel: they overlap, as built-up ground has no gaps.
const DISTRICT_FILLS: f64 = 0.8;
const MADE_UP_FILLS: f64 = 0.5;
/// Smallest standard deviation of a point, metres.
const LEAST_RADIUS_M: f64 = 100.0;
/// How much wider than others the widest points of the same light are.
const RADIUS_VARIES: f64 = 2.0;
/// Points that a texel with light has, one for so many square metres of ground as bright as the brightest lamps, and at most so many. Where
/// places and roads are fewer, points are made up between them: villages that the list lacks, flares, ships.
const LIGHT_OF_POINT_M2: f64 = 1.4e7;
const MOST_POINTS: f64 = 32.0;
/// Most points of a map that are made for its light: of a brighter map each has more.
const MOST_POINTS_OF_MAP: f64 = 1e6;
/// Limit of districts of all places of a texel; each place has at least one.
const MOST_DISTRICTS_OF_TEXEL: usize = 4096;
/// Part of the lamps of a place that are of its one kind.
const OF_ONE_KIND: f64 = 0.75;
/// No country.
const UNKNOWN_COUNTRY: [u8; 2] = *b"--";

/// A texel of the map.
pub struct Texel {
    pub row: usize,
    pub column: usize,
    /// Its mean light.
    pub light: f32,
    /// Square equatorial radii.
    pub area: f32,
}

/// A point before the light of its texel is known to be divided among all.
struct Part {
    /// Rows from the north pole and columns from 180° W.
    at: (f64, f64),
    weight: f64,
    color: [f32; 3],
    /// How far its built-up ground reaches (standard deviation), metres.
    built_m: f64,
}

/// Light that each point of a map has about, square metres as above.
pub fn light_of_point_m2(map: &MapLight) -> f64 {
    let total_m2 = f64::from(LIGHT_OF_MAP) * map.total() * EARTH_M * EARTH_M;
    LIGHT_OF_POINT_M2.max(total_m2 / MOST_POINTS_OF_MAP)
}

/// Divides the light of a texel and appends its points, each with its cell and its texel.
pub fn gather(
    texel: &Texel,
    map: &MapLight,
    places: &[(u32, Place)],
    lamps: &[(u32, RoadLamp)],
    light_of_point_m2: f64,
    points: &mut Vec<(u32, u32, CityLight)>,
) {
    let (width, height) = map.size();
    let number = (texel.row * width + texel.column) as u32;
    let mut noise = Noise::new(u64::from(number));
    let mut parts = Vec::new();
    let most = (MOST_DISTRICTS_OF_TEXEL / places.len().max(1)).max(1);
    for (_, place) in places {
        districts(texel, map, (place, most), &mut noise, &mut parts);
    }
    let of_places: f64 = parts.iter().map(|part| part.weight).sum();
    let of_roads = match parts.is_empty() {
        true => 1.0,
        false => of_places * ROAD_SHARE / (1.0 - ROAD_SHARE),
    };
    road_lamps(map, lamps, of_roads, &mut noise, &mut parts);
    let texel_light = f64::from(LIGHT_OF_MAP * texel.light * texel.area);
    let wanted = texel_light * EARTH_M * EARTH_M / light_of_point_m2;
    made_up(texel, wanted, &mut noise, &mut parts);
    let total: f64 = parts.iter().map(|part| part.weight).sum();
    let light = texel_light / total;
    points.extend(parts.into_iter().map(|part| {
        let (row, column) = within(part.at, texel);
        let (v, u) = (row / height as f64, column / width as f64);
        let light = light * part.weight;
        let radius_m = radius_of(light, part.built_m);
        let radius_m = radius_m * RADIUS_VARIES.powf(noise.next() - 0.5);
        let radius_m = radius_m.clamp(LEAST_RADIUS_M, CityLight::MOST_RADIUS_M);
        let up = up_at(u, v).as_vec3();
        let point = CityLight::new(up, light as f32, part.color.into(), radius_m);
        (cell_of(u, v), number, point)
    }));
}

/// How far lamps of so much light (square equatorial radii) are spread (standard deviation), metres: over their built-up ground, unless that is
/// brighter or darker than towns are.
fn radius_of(light: f64, built_m: f64) -> f64 {
    let at_brightness = |brightness: f64| EARTH_M * (light / (TAU * brightness)).sqrt();
    built_m.clamp(at_brightness(BRIGHTEST_POINT), at_brightness(DIMMEST_POINT))
}

/// A place as one point or as its districts, at most this many, as far as they are inside the texel.
fn districts(
    texel: &Texel,
    map: &MapLight,
    (place, most): (&Place, usize),
    noise: &mut Noise,
    parts: &mut Vec<Part>,
) {
    let (width, height) = map.size();
    let weight = place.population.powf(LIGHT_BY_POPULATION);
    let count = (place.population / DISTRICT_POPULATION)
        .powf(DISTRICTS_BY_POPULATION)
        .clamp(1.0, MOST_DISTRICTS) as usize;
    let count = count.min(most);
    let own = lamp_of(place.country, noise.next() as f32);
    let middle = (
        (0.5 - place.lat_deg / 180.0) * height as f64,
        (place.lon_deg / 360.0 + 0.5) * width as f64,
    );
    let spread_m = TOWN_M * (place.population / 1e5).powf(TOWN_BY_POPULATION);
    // Rows and columns of a metre.
    let row_m = height as f64 / (PI * EARTH_M);
    let cos_lat = place.lat_deg.to_radians().cos().max(0.05);
    let column_m = width as f64 / (TAU * EARTH_M * cos_lat);
    let first = parts.len();
    for district in 0..count {
        let mut at = middle;
        let mut off = 0.0;
        if district > 0 {
            let angle = TAU * noise.next();
            // Normal in both directions, without the few that are far away.
            off = (-2.0 * (1.0 - 0.98 * noise.next()).ln()).sqrt();
            let moved = (
                middle.0 + off * spread_m * row_m * angle.sin(),
                middle.1 + off * spread_m * column_m * angle.cos(),
            );
            if (moved.0 as usize, moved.1 as usize) == (texel.row, texel.column) {
                at = moved;
            }
        }
        let is_own = noise.next() < OF_ONE_KIND;
        let other = lamp_of(place.country, noise.next() as f32);
        parts.push(Part {
            at,
            weight: (0.5 + noise.next()) / (1.0 + off),
            color: if is_own { own } else { other }.color(),
            built_m: DISTRICT_FILLS * spread_m / (count as f64).sqrt(),
        });
    }
    let sum: f64 = parts[first..].iter().map(|part| part.weight).sum();
    for part in &mut parts[first..] {
        part.weight *= weight / sum;
    }
}

/// A place of a texel, a little within its edges: rounding must not move it to the next.
fn within((row, column): (f64, f64), texel: &Texel) -> (f64, f64) {
    const EDGE: f64 = 1e-4;
    let inside = |at: f64, first: usize| at.clamp(first as f64 + EDGE, (first + 1) as f64 - EDGE);
    (inside(row, texel.row), inside(column, texel.column))
}

/// The lamps of roads in a texel, which share `weight` evenly; of many every so manyth.
fn road_lamps(
    map: &MapLight,
    lamps: &[(u32, RoadLamp)],
    weight: f64,
    noise: &mut Noise,
    parts: &mut Vec<Part>,
) {
    let (width, height) = map.size();
    let step = lamps.len().div_ceil(MOST_ROAD_LAMPS).max(1);
    let count = lamps.len().div_ceil(step);
    for (_, lamp) in lamps.iter().step_by(step) {
        let column = (lamp.lon_deg / 360.0 + 0.5).rem_euclid(1.0);
        parts.push(Part {
            at: (
                (0.5 - lamp.lat_deg / 180.0) * height as f64,
                column * width as f64,
            ),
            weight: weight / count as f64,
            color: lamp_of(lamp.country, noise.next() as f32).color(),
            built_m: 0.0,
        });
    }
}

/// Adds synthetic points up to the requested number, at least one in total. Their mean light is that of the others.
fn made_up(texel: &Texel, wanted: f64, noise: &mut Noise, parts: &mut Vec<Part>) {
    let there = parts.len();
    let count = (wanted.min(MOST_POINTS).ceil() as usize).max(1);
    let sum: f64 = parts.iter().map(|part| part.weight).sum();
    let texel_m2 = f64::from(texel.area) * EARTH_M * EARTH_M;
    let built_m = MADE_UP_FILLS * (texel_m2 / (PI * count as f64)).sqrt();
    let mean = if there == 0 { 1.0 } else { sum / there as f64 };
    for _ in there..count {
        let at = (
            texel.row as f64 + noise.next(),
            texel.column as f64 + noise.next(),
        );
        let nearest = parts[..there].get((noise.next() * there as f64) as usize);
        let color = match nearest {
            Some(part) => part.color,
            None => lamp_of(UNKNOWN_COUNTRY, noise.next() as f32).color(),
        };
        parts.push(Part {
            at,
            // Few are bright; the mean of this is 1.
            weight: mean * (0.2 + 3.2 * noise.next().powi(3)),
            color,
            built_m,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layer::LayerImage;

    /// In square metres, as the formula of a normal distribution has it: its middle is light / (2π σ²) bright.
    #[test]
    fn lamps_cover_built_up_ground_between_bounds_of_brightness() {
        let brightness = |light_m2: f64, built_m: f64| {
            let radius_m = radius_of(light_m2 / (EARTH_M * EARTH_M), built_m);
            (light_m2 / (2.0 * PI * radius_m * radius_m), radius_m)
        };
        let (middle, radius_m) = brightness(1e6, 600.0);
        assert!((middle - 0.442).abs() < 1e-3 && (radius_m - 600.0).abs() < 1e-9);
        // A stadium, and a village in a wide valley.
        assert!((brightness(1e6, 10.0).0 - BRIGHTEST_POINT).abs() < 1e-9);
        assert!((brightness(1e4, 5e3).0 - DIMMEST_POINT).abs() < 1e-9);
    }

    /// The points of a lone town in a texel 20 km wide.
    #[test]
    fn districts_of_a_town_overlap() {
        let map = LayerImage::from_r8(2048, 1024, vec![200; 2048 * 1024]).expect("a map");
        let map = MapLight::new(&map);
        let town = Place {
            lat_deg: 0.09,
            lon_deg: 0.09,
            population: 1e6,
            country: *b"DE",
        };
        let (row, column) = map.texel_at(town.lat_deg, town.lon_deg);
        let texel = Texel {
            row,
            column,
            light: 0.03,
            area: map.area(row),
        };
        let mut points = Vec::new();
        let places = [(map.number_at(town.lat_deg, town.lon_deg), town)];
        gather(&texel, &map, &places, &[], 1e9, &mut points);
        assert!(points.len() > 8, "{}", points.len());
        let radius_m =
            |point: &CityLight| f64::from(point.radius) / 255.0 * CityLight::MOST_RADIUS_M;
        let gap = |(n, point): (usize, &CityLight)| {
            let others = points.iter().enumerate().filter(|(m, _)| *m != n);
            let off_m = others.map(|(_, (.., other))| {
                let off_m = EARTH_M * f64::from(point.up.angle_between(other.up));
                off_m / (radius_m(point) + radius_m(other))
            });
            off_m.fold(f64::INFINITY, f64::min)
        };
        let gaps = points.iter().map(|(.., point)| point).enumerate().map(gap);
        let wide = gaps.filter(|gap| *gap > 1.5).count();
        assert!(wide <= points.len() / 4, "{wide} of {}", points.len());
    }
}
