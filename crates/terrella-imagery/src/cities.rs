//! City lights as points: the light of a map of night lights, gathered where people live.
//!
//! | file | what |
//! |---|---|
//! | `point.rs` | points, and the cells that they are sorted into |
//! | `places.rs` | populated places, from a file |
//! | `lamps.rs` | the colours of lamps, by country |
//! | `map_light.rs` | the light of each texel of the map |
//! | `roads.rs` | roads between places |
//! | `noise.rs` | numbers without a pattern |
//! | `gather.rs` | how a texel's light is divided among its points |

mod gather;
mod lamps;
mod map_light;
mod noise;
mod places;
mod point;
mod roads;

use super::error::ImageryError;
use super::layer::LayerImage;
use super::map_folder::MapFolder;
use gather::{Texel, gather, light_of_point_m2};
use glam::Vec3;
pub use lamps::LAMP_COLOR;
use map_light::MapLight;
pub use places::{MAX_PLACES, PLACES_FILE, Place, PlacesError, read_places};
use point::EARTH_M;
pub use point::{CITY_CELLS, CityCell, CityLight, LEAST_LIGHT};
use roads::Roads;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;
use terrella_files::parallel;

/// All points, the finest first, each fineness by cells of some 600 km, and in a cell from bright to faint.
///
/// Every fineness has all of the light of the map's texels above [`LEAST_LIGHT`]; points never lie outside the texel whose light they
/// have, and those of sums lie in the middle of that light.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CityLights {
    points: Vec<CityLight>,
    /// For each fineness where each cell begins, and where the last ends.
    starts: [Vec<u32>; FINENESSES],
    /// Height of the map's texels, metres.
    texel_m: f64,
}

/// How finely the light is divided: points; one for each texel of the map; one for each 4 × 4 texels.
pub const FINENESSES: usize = 3;
/// Texels that are divided at a time.
const PART: usize = 1024;
/// Texels along each side of what has one point of the coarsest fineness.
const COARSEST_TEXELS: usize = 4;
impl CityLights {
    /// Divides the light of a map of night lights among places, roads between them, and where a lit texel has neither, among points that
    /// are made up.
    ///
    /// The map's values are a picture's, their fourth power is light. The same map and places give the same points.
    pub fn new(map: &LayerImage, places: &[Place]) -> Self {
        let light = MapLight::new(map);
        let (width, height) = light.size();
        let placed = light.places_by_texel(places);
        let roads = Roads::between(&light, &placed);
        let light_of_point_m2 = light_of_point_m2(&light);
        let parts = parallel::map(light.lit().len().div_ceil(PART), |part| {
            let mut points = Vec::new();
            for (number, mean) in light.lit().iter().skip(PART * part).take(PART) {
                let (row, column) = (*number as usize / width, *number as usize % width);
                let texel = Texel {
                    row,
                    column,
                    light: *mean,
                    area: light.area(row),
                };
                if texel.light >= LEAST_LIGHT {
                    let places = placed.of(*number);
                    gather(
                        &texel,
                        &light,
                        places,
                        &roads,
                        light_of_point_m2,
                        &mut points,
                    );
                }
            }
            points
        });
        let fine: Vec<_> = parts.into_iter().flatten().collect();
        let sums = |side: usize| {
            let columns = width.div_ceil(side) as u32;
            let group = move |texel: u32| {
                let (row, column) = (texel as usize / width, texel as usize % width);
                (row / side) as u32 * columns + (column / side) as u32
            };
            summed(&fine, group)
        };
        let (texels, groups) = (sums(1), sums(COARSEST_TEXELS));
        let mut points = Vec::with_capacity(fine.len() + texels.len() + groups.len());
        let mut starts: [Vec<u32>; FINENESSES] = Default::default();
        for (starts, mut list) in starts.iter_mut().zip([fine, texels, groups]) {
            // The last two make the order one alone.
            list.sort_unstable_by(|(cell_a, texel_a, a), (cell_b, texel_b, b)| {
                let by_light = || b.light.total_cmp(&a.light);
                let by_place = || a.up.x.total_cmp(&b.up.x);
                cell_a
                    .cmp(cell_b)
                    .then_with(by_light)
                    .then(texel_a.cmp(texel_b))
                    .then_with(by_place)
            });
            starts.extend((0..=CITY_CELLS as u32).map(|cell| {
                let before = list.partition_point(|(of, ..)| *of < cell);
                (points.len() + before) as u32
            }));
            points.extend(list.into_iter().map(|(.., point)| point));
        }
        let texel_m = PI * EARTH_M / height as f64;
        Self {
            points,
            starts,
            texel_m,
        }
    }

    /// Reads the places and the night map of a folder; `None` where it lacks one of them.
    ///
    /// # Errors
    /// A file that is there and cannot be used.
    pub fn load<'f>(folder: impl Into<MapFolder<'f>>) -> Result<Option<Arc<Self>>, ImageryError> {
        let folder = folder.into();
        let Some(map) = super::load::night_map(folder)? else {
            return Ok(None);
        };
        if !folder.has(PLACES_FILE) {
            return Ok(None);
        }
        let contents = folder.read(PLACES_FILE, "places")?;
        let places = read_places(&contents).map_err(|error| ImageryError::Places {
            path: folder.path(PLACES_FILE),
            error,
        })?;
        Ok(Some(Arc::new(Self::new(&map, &places))))
    }

    /// All points, of all finenesses.
    pub fn points(&self) -> &[CityLight] {
        &self.points
    }

    /// How finely the light has to be divided where the smallest pixel is so wide, metres: points of a texel that is as large as a pixel or
    /// two lie in each other's place.
    pub fn fineness(&self, pixel_m: f64) -> usize {
        let texels = [1.0, COARSEST_TEXELS as f64];
        texels
            .iter()
            .filter(|side| 2.0 * pixel_m > **side * self.texel_m)
            .count()
    }

    /// Those of a cell that have at least so much light, from bright to faint: fineness 0 is the finest, [`FINENESSES`] − 1 the coarsest. Empty
    /// beyond.
    pub fn of_cell(&self, cell: usize, fineness: usize, least_light: f32) -> Range<u32> {
        let starts = self.starts.get(fineness);
        let Some([start, end]) = starts.and_then(|starts| starts.get(cell..cell + 2)) else {
            return 0..0;
        };
        let points = self.points.get(*start as usize..*end as usize);
        let bright = points.map_or(0, |points| {
            points.partition_point(|point| point.light >= least_light)
        });
        *start..*start + bright as u32
    }
}

/// One point for all that is in the same group of texels, in the middle of its light. Points carry their cell and their texel.
fn summed(
    fine: &[(u32, u32, CityLight)],
    group: impl Fn(u32) -> u32,
) -> Vec<(u32, u32, CityLight)> {
    let mut order: Vec<(u32, usize)> = fine
        .iter()
        .map(|(_, texel, _)| group(*texel))
        .zip(0..)
        .collect();
    order.sort_unstable();
    let mut sums: Vec<(u32, u32, CityLight)> = Vec::new();
    for same in order.chunk_by(|a, b| a.0 == b.0) {
        let (mut light, mut up, mut color) = (0.0, Vec3::ZERO, Vec3::ZERO);
        for (_, place) in same {
            let point = &fine[*place].2;
            light += point.light;
            up += point.light * point.up;
            color += point.light * Vec3::from(point.color.map(f32::from)) / 255.0;
        }
        let (cell, texel, _) = fine[same[0].1];
        sums.push((
            cell,
            texel,
            CityLight::new(up.normalize_or(Vec3::Z), light, color / light, 0.0),
        ));
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use lamps::LIGHT_OF_MAP;

    /// A map with lights of all strengths, and places in some of them.
    fn lights() -> (LayerImage, Vec<Place>, CityLights) {
        let (width, height) = (256, 128);
        let mut noise = noise::Noise::new(1);
        let texels: Vec<u8> = (0..width * height)
            .map(|_| {
                if noise.next() < 0.3 {
                    (255.0 * noise.next()) as u8
                } else {
                    0
                }
            })
            .collect();
        let map = LayerImage::from_r8(width, height, texels).expect("a good map");
        let places: Vec<Place> = (0..2000)
            .map(|_| Place {
                lat_deg: 180.0 * noise.next() - 90.0,
                lon_deg: 360.0 * noise.next() - 180.0,
                population: 1e3 * 1e4_f64.powf(noise.next()),
                country: *b"US",
            })
            .collect();
        let lights = CityLights::new(&map, &places);
        (map, places, lights)
    }

    #[test]
    fn points_have_the_light_of_their_texels_and_lie_in_them() {
        let (map, _, lights) = lights();
        let of_map = MapLight::new(&map);
        let (width, height) = of_map.size();
        for fineness in 0..2 {
            let mut sums = vec![0.0; width * height];
            for cell in 0..CITY_CELLS {
                for point in lights.of_cell(cell, fineness, 0.0) {
                    let point = lights.points()[point as usize];
                    let up = point.up.as_dvec3();
                    let lat_deg = up.z.asin().to_degrees();
                    let (row, column) = of_map.texel_at(lat_deg, up.y.atan2(up.x).to_degrees());
                    sums[row * width + column] += f64::from(point.light);
                }
            }
            for (texel, light) in of_map.lit() {
                let sum = std::mem::take(&mut sums[*texel as usize]);
                let area = of_map.area(*texel as usize / width);
                let wanted = if *light < LEAST_LIGHT {
                    0.0
                } else {
                    LIGHT_OF_MAP * light * area
                };
                let wanted = f64::from(wanted);
                assert!(
                    (sum - wanted).abs() <= 1e-4 * wanted,
                    "{texel}: {sum}, {wanted}"
                );
            }
            assert!(
                sums.iter().all(|sum| *sum == 0.0),
                "light where the map has none"
            );
        }
        let total = |fineness| -> f64 {
            let cells = (0..CITY_CELLS).flat_map(|cell| lights.of_cell(cell, fineness, 0.0));
            cells
                .map(|point| f64::from(lights.points()[point as usize].light))
                .sum()
        };
        assert!((total(2) / total(0) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn cells_hold_their_points_from_bright_to_faint() {
        let (.., lights) = lights();
        for fineness in 0..FINENESSES {
            for cell in CityCell::all() {
                let range = lights.of_cell(cell.index, fineness, 0.0);
                let points = &lights.points()[range.start as usize..range.end as usize];
                assert!(points.is_sorted_by(|a, b| a.light >= b.light));
                for point in points {
                    let off_rad = point.up.as_dvec3().angle_between(cell.up);
                    // The middle of a sum's light may lie beside its first texel.
                    let room_rad = [1e-6, 1e-6, 0.1][fineness];
                    assert!(
                        off_rad <= cell.radius_rad + room_rad,
                        "{fineness}: {off_rad}"
                    );
                }
                if let Some(third) = points.get(2) {
                    let brighter = lights.of_cell(cell.index, fineness, third.light);
                    assert!((3..points.len() + 1).contains(&brighter.len()));
                    assert!(points[brighter.len() - 1].light >= third.light);
                }
            }
        }
        assert!(lights.of_cell(CITY_CELLS, 0, 0.0).is_empty());
        assert!(lights.of_cell(0, FINENESSES, 0.0).is_empty());
    }

    /// All of the Earth as bright as a map can be, and as many places as a file may have in one spot.
    #[test]
    fn hostile_files_make_no_more_points_than_fit() {
        let map = LayerImage::from_r8(512, 256, vec![255; 512 * 256]).expect("a map");
        let places: Vec<Place> = (0..MAX_PLACES)
            .map(|n| Place {
                lat_deg: 10.0,
                lon_deg: 10.0,
                population: 1e3 + n as f64,
                country: *b"AA",
            })
            .collect();
        let lights = CityLights::new(&map, &places);
        assert!(
            lights.points().len() < 2_000_000,
            "{}",
            lights.points().len()
        );
    }

    #[test]
    fn the_same_files_give_the_same_points() {
        let (map, places, lights) = lights();
        assert_eq!(CityLights::new(&map, &places), lights);
    }

    #[test]
    fn a_folder_without_places_has_none_and_a_damaged_file_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let starter = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../textures");
        assert_eq!(CityLights::load(folder.path()).expect("no file"), None);
        let map = "night_lights.png";
        std::fs::copy(starter.join(map), folder.path().join(map)).expect("a copy");
        assert_eq!(CityLights::load(folder.path()).expect("no places"), None);
        let places = std::fs::read(starter.join(PLACES_FILE)).expect("starter places");
        let path = folder.path().join(PLACES_FILE);
        std::fs::write(&path, &places[..places.len() - 1]).expect("written");
        let error = CityLights::load(folder.path())
            .expect_err("cut off")
            .to_string();
        assert!(
            error.starts_with(&format!("{}: its header announces", path.display())),
            "{error}"
        );
    }
}
