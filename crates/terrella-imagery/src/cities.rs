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
//! | `by_cell.rs` | the points of a cell, by fineness and brightness |

mod by_cell;
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
use by_cell::{COARSEST_TEXELS, CellEnds, CellPoints, LightSource};
pub use lamps::{LAMP_COLOR, LAMP_GLOW};
use map_light::MapLight;
pub use places::{MAX_PLACES, PLACES_FILE, Place, PlacesError, read_places};
use point::EARTH_M;
pub use point::{CITY_CELLS, CityCell, CityLight, LEAST_LIGHT};
use std::f64::consts::PI;
use std::fmt;
use std::ops::Range;
use std::sync::{Arc, LazyLock, OnceLock};
use terrella_files::parallel;

/// All points, by cells of some 600 km: in a cell the finest level of detail first, each level from bright to faint.
///
/// Every level of detail has all of the light of the map's texels above [`LEAST_LIGHT`]. Points are never outside the texel whose light they have;
/// a point for a sum is at the centre of its light.
///
/// The points of a cell are computed on first use: a view at night needs some per cent of all, one by day none.
pub struct CityLights {
    source: LazyLock<LightSource, Box<dyn FnOnce() -> LightSource + Send>>,
    cells: Box<[OnceLock<CellPoints>]>,
}

impl fmt::Debug for CityLights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let made = self.cells.iter().filter(|cell| cell.get().is_some());
        f.debug_struct("CityLights")
            .field("cells_made", &made.count())
            .finish_non_exhaustive()
    }
}

/// How finely the light is divided: points; one for each texel of the map; one for each 4 × 4 texels.
pub const FINENESSES: usize = 3;

impl CityLights {
    /// Divides the light of a map of night lights among places, roads between them, and where a lit texel has neither, among points that
    /// are made up.
    ///
    /// The map's values are a picture's, their fourth power is light. The same map and places give the same points.
    pub fn new(map: &LayerImage, places: &[Place]) -> Self {
        let places = places.to_vec();
        let source = LightSource::new(MapLight::new(map), Box::new(move || places.clone()));
        Self::of(Box::new(move || source))
    }

    fn of(source: Box<dyn FnOnce() -> LightSource + Send>) -> Self {
        Self {
            source: LazyLock::new(source),
            cells: (0..CITY_CELLS).map(|_| OnceLock::new()).collect(),
        }
    }

    /// Reads the places and the night map of a folder; `None` if it lacks one of them. The files stay in memory unchanged until points are
    /// requested.
    ///
    /// # Errors
    /// A file that exists and cannot be used.
    pub fn load<'f>(folder: impl Into<MapFolder<'f>>) -> Result<Option<Arc<Self>>, ImageryError> {
        let folder = folder.into();
        if !folder.has(super::load::NIGHT_LIGHTS_NAME) {
            return Ok(None);
        }
        let night = super::load::night_file(folder)?;
        night.check()?;
        if !folder.has(PLACES_FILE) {
            return Ok(None);
        }
        let contents = folder.read(PLACES_FILE, "places")?.into_owned();
        read_places(&contents).map_err(|error| ImageryError::Places {
            path: folder.path(PLACES_FILE),
            error,
        })?;
        let night = night.into_owned();
        let make = move || {
            // The same bytes were found good above.
            let map = night.level_0().map(|map| MapLight::new(&map));
            let light = map.unwrap_or_else(|error| {
                tracing::error!("{error}; no city lights are drawn");
                MapLight::default()
            });
            let places = move || read_places(&contents).unwrap_or_default();
            LightSource::new(light, Box::new(places))
        };
        Ok(Some(Arc::new(Self::of(Box::new(make)))))
    }

    /// All points as bytes, for another part of the same program that shares no memory with this one, as a page and its workers:
    /// [`Self::from_bytes`]. The starter map has 8 MB.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.make_all();
        let cells = (0..CITY_CELLS).filter_map(|cell| self.cell(cell));
        let mut bytes = Vec::from((self.source.rows() as u32).to_ne_bytes());
        let ends = cells.clone().flat_map(CellPoints::ends);
        bytes.extend(ends.flat_map(|end| end.to_ne_bytes()));
        let points = cells.flat_map(|cell| bytemuck::cast_slice::<_, u8>(cell.all()));
        bytes.extend(points);
        bytes
    }

    /// The points of [`Self::to_bytes`]; `None` for other bytes.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (rows, rest) = bytes.split_first_chunk()?;
        let rows = u32::from_ne_bytes(*rows) as usize;
        let (ends, mut rest) = rest.split_at_checked(CITY_CELLS * size_of::<CellEnds>())?;
        let mut cells = Vec::with_capacity(CITY_CELLS);
        for ends in ends.chunks_exact(size_of::<CellEnds>()) {
            let ends: CellEnds = bytemuck::pod_read_unaligned(ends);
            let length = (*ends.last()? as usize).checked_mul(size_of::<CityLight>())?;
            let (points, others) = rest.split_at_checked(length)?;
            rest = others;
            let points = points.chunks_exact(size_of::<CityLight>());
            let points = points.map(bytemuck::pod_read_unaligned).collect();
            cells.push(OnceLock::from(CellPoints::of(points, ends)?));
        }
        let light = MapLight::unlit(rows);
        let source = LightSource::new(light, Box::new(Vec::new));
        let lights = Self {
            cells: cells.into(),
            ..Self::of(Box::new(move || source))
        };
        (rows > 0 && rest.is_empty()).then_some(lights)
    }

    /// Computes the points of all cells, on all cores.
    pub fn make_all(&self) {
        parallel::map(CITY_CELLS, |cell| {
            self.cell(cell);
        });
    }

    fn cell(&self, cell: usize) -> Option<&CellPoints> {
        let points = self.cells.get(cell)?;
        Some(points.get_or_init(|| self.source.cell(cell)))
    }

    /// All points of a cell, at all levels of detail; none for an invalid index.
    pub fn points(&self, cell: usize) -> &[CityLight] {
        self.cell(cell).map_or(&[], CellPoints::all)
    }

    /// The required level of detail for the smallest pixel size, metres: the points of a texel of one or two pixels would overlap.
    pub fn fineness(&self, pixel_m: f64) -> usize {
        let texel_m = PI * EARTH_M / self.source.rows() as f64;
        let texels = [1.0, COARSEST_TEXELS as f64];
        texels
            .iter()
            .filter(|side| 2.0 * pixel_m > **side * texel_m)
            .count()
    }

    /// Those of [`Self::points`] that are of a fineness and have at least so much light, from bright to faint: fineness 0 is the finest, [`FINENESSES`] − 1 the coarsest. Empty
    /// beyond.
    pub fn of_cell(&self, cell: usize, fineness: usize, least_light: f32) -> Range<u32> {
        let points = self.cell(cell);
        points.map_or(0..0, |points| points.of_fineness(fineness, least_light))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lamps::LIGHT_OF_MAP;

    /// A map with lights of all intensities, and places in some of them.
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
                    let point = lights.points(cell)[point as usize];
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
            let lights = &lights;
            let light = |cell: usize| {
                let points = lights.of_cell(cell, fineness, 0.0);
                points.map(move |point| f64::from(lights.points(cell)[point as usize].light))
            };
            (0..CITY_CELLS).flat_map(light).sum()
        };
        assert!((total(2) / total(0) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn cells_hold_their_points_from_bright_to_faint() {
        let (.., lights) = lights();
        for fineness in 0..FINENESSES {
            for cell in CityCell::all() {
                let range = lights.of_cell(cell.index, fineness, 0.0);
                let points = lights.points(cell.index);
                let points = &points[range.start as usize..range.end as usize];
                assert!(points.is_sorted_by(|a, b| a.light >= b.light));
                for point in points {
                    let off_rad = point.up.as_dvec3().angle_between(cell.up);
                    // The centre of a sum's light may be outside its first texel.
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
        let count: usize = (0..CITY_CELLS).map(|cell| lights.points(cell).len()).sum();
        assert!(count < 2_000_000, "{count}");
    }

    #[test]
    fn only_cells_that_are_asked_for_are_made() {
        let starter = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../textures");
        let lights = CityLights::load(starter.as_path()).expect("good files");
        let lights = lights.expect("places and a night map");
        let made = || lights.cells.iter().filter(|cell| cell.get().is_some());
        assert_eq!(made().count(), 0);
        // The Alps.
        let cell = 7 * point::CELL_COLUMNS + 33;
        assert!(!lights.points(cell).is_empty());
        assert!(!lights.of_cell(cell, 0, 0.0).is_empty());
        assert_eq!(made().count(), 1);
        lights.make_all();
        assert_eq!(made().count(), CITY_CELLS);
    }

    #[test]
    fn the_same_files_give_the_same_points() {
        let (map, places, lights) = lights();
        let again = CityLights::new(&map, &places);
        again.make_all();
        // In another order.
        for cell in (0..CITY_CELLS).rev() {
            assert_eq!(again.points(cell), lights.points(cell), "{cell}");
        }
    }

    #[test]
    fn bytes_give_the_same_points_and_damaged_ones_give_none() {
        let (.., lights) = lights();
        let bytes = lights.to_bytes();
        let again = CityLights::from_bytes(&bytes).expect("whole");
        for cell in 0..CITY_CELLS {
            assert_eq!(again.points(cell), lights.points(cell));
            for fineness in 0..FINENESSES {
                let range = again.of_cell(cell, fineness, 1e-9);
                assert_eq!(range, lights.of_cell(cell, fineness, 1e-9));
            }
        }
        assert_eq!(again.fineness(1e5), lights.fineness(1e5));
        let counts = 4 + CITY_CELLS * 4 * FINENESSES;
        for cut in [0, 3, 4, counts - 1, counts, bytes.len() - 1] {
            assert!(CityLights::from_bytes(&bytes[..cut]).is_none(), "{cut}");
        }
        let longer = [&bytes[..], &[0]].concat();
        assert!(CityLights::from_bytes(&longer).is_none());
        for at in (0..counts).step_by(97) {
            let mut faulty = bytes.clone();
            faulty[at] ^= 0xFF;
            // It may have other points, but only in the number that it says.
            if let Some(lights) = CityLights::from_bytes(&faulty) {
                for cell in 0..CITY_CELLS {
                    let count = lights.points(cell).len() as u32;
                    assert!(lights.of_cell(cell, FINENESSES - 1, 0.0).end <= count);
                }
            }
        }
    }

    #[test]
    fn a_folder_without_places_has_none_and_a_damaged_file_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let starter = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../textures");
        assert!(CityLights::load(folder.path()).expect("no file").is_none());
        let map = "night_lights.png";
        std::fs::copy(starter.join(map), folder.path().join(map)).expect("a copy");
        assert!(
            CityLights::load(folder.path())
                .expect("no places")
                .is_none()
        );
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
