//! The points of one cell of the Earth, at all levels of detail.

use super::FINENESSES;
use super::gather::{Texel, gather, light_of_point_m2};
use super::map_light::{ByTexel, MapLight, TexelRegion};
use super::places::Place;
use super::point::{CELL_COLUMNS, CELL_ROWS, CityLight, LEAST_LIGHT};
use super::roads::Roads;
use glam::Vec3;
use std::ops::Range;
use std::sync::OnceLock;

/// Input of the points of all cells.
pub struct LightSource {
    light: MapLight,
    light_of_point_m2: f64,
    places: Places,
    /// Of these places, when a cell first has light to divide.
    inhabited: OnceLock<Inhabited>,
}

/// Loads the places when they are needed: a list of them is five times as large as its file.
pub type Places = Box<dyn Fn() -> Vec<Place> + Send + Sync>;

/// Populated places within the light of a map.
struct Inhabited {
    placed: ByTexel<Place>,
    roads: Roads,
}

/// End of each level of detail among the points of a cell.
pub type CellEnds = [u32; FINENESSES];

/// The points of a cell, the finest first, each fineness from bright to faint.
#[derive(Default)]
pub struct CellPoints {
    points: Box<[CityLight]>,
    ends: CellEnds,
}

/// Side of the group of texels that has one point at the coarsest level, texels.
pub const COARSEST_TEXELS: usize = 4;

/// A point with its cell and texel.
type InTexel = (u32, u32, CityLight);

impl LightSource {
    pub fn new(light: MapLight, places: Places) -> Self {
        Self {
            light_of_point_m2: light_of_point_m2(&light),
            light,
            places,
            inhabited: OnceLock::new(),
        }
    }

    fn inhabited(&self) -> &Inhabited {
        self.inhabited.get_or_init(|| {
            let placed = self.light.places_by_texel(&(self.places)());
            let roads = Roads::between(self.light.lit_places(&placed));
            Inhabited { placed, roads }
        })
    }

    /// Rows of the map's texels.
    pub fn rows(&self) -> usize {
        self.light.size().1
    }

    /// Divides the light of a cell.
    pub fn cell(&self, cell: usize) -> CellPoints {
        let (width, height) = self.light.size();
        let (row, column) = (cell / CELL_COLUMNS, cell % CELL_COLUMNS);
        // With all texels of the groups that are summed.
        let texels = |number: usize, cells: usize, size: usize| {
            let (first, end) = (number * size / cells, ((number + 1) * size).div_ceil(cells));
            let first = first / COARSEST_TEXELS * COARSEST_TEXELS;
            first..end.next_multiple_of(COARSEST_TEXELS).min(size)
        };
        let region = TexelRegion {
            rows: texels(row, CELL_ROWS, height),
            columns: texels(column, CELL_COLUMNS, width),
        };
        let fine = self.region(&region);
        let side_columns = region.columns.len().div_ceil(COARSEST_TEXELS);
        let place = |texel: u32| {
            let (row, column) = (texel as usize / width, texel as usize % width);
            (row - region.rows.start, column - region.columns.start)
        };
        let texels = summed(&fine, region.rows.len() * region.columns.len(), |texel| {
            let (row, column) = place(texel);
            row * region.columns.len() + column
        });
        let groups = region.rows.len().div_ceil(COARSEST_TEXELS) * side_columns;
        let groups = summed(&fine, groups, |texel| {
            let (row, column) = place(texel);
            row / COARSEST_TEXELS * side_columns + column / COARSEST_TEXELS
        });
        let mut points = Vec::new();
        let ends = [fine, texels, groups].map(|list| {
            let mut own: Vec<_> = list
                .into_iter()
                .filter(|(of, ..)| *of as usize == cell)
                .map(|(.., point)| point)
                .collect();
            // Points of equal brightness keep their order.
            own.sort_by(|a, b| b.light.total_cmp(&a.light));
            points.append(&mut own);
            points.len() as u32
        });
        CellPoints {
            points: points.into(),
            ends,
        }
    }

    /// The points of some texels, row by row.
    fn region(&self, region: &TexelRegion) -> Vec<InTexel> {
        let width = self.light.size().0;
        let bright = |lit: &&(u32, f32)| lit.1 >= LEAST_LIGHT;
        let lit = region.rows.clone().flat_map(|row| {
            let lit = self.light.lit_of_row(row, &region.columns);
            lit.iter().filter(bright).map(move |lit| (row, lit))
        });
        let mut lit = lit.peekable();
        let mut points = Vec::new();
        if lit.peek().is_none() {
            return points;
        }
        let Inhabited { placed, roads } = self.inhabited();
        let lamps = roads.lamps_in(&self.light, region);
        for (row, (number, mean)) in lit {
            let texel = Texel {
                row,
                column: *number as usize % width,
                light: *mean,
                area: self.light.area(row),
            };
            gather(
                &texel,
                &self.light,
                placed.of(*number),
                lamps.of(*number),
                self.light_of_point_m2,
                &mut points,
            );
        }
        points
    }
}

impl CellPoints {
    /// Of these points; `None` unless the levels follow each other up to the last point.
    pub fn of(points: Box<[CityLight]>, ends: CellEnds) -> Option<Self> {
        let fits = ends.is_sorted() && ends.last().copied() == u32::try_from(points.len()).ok();
        fits.then_some(Self { points, ends })
    }

    /// End of each level of detail.
    pub fn ends(&self) -> CellEnds {
        self.ends
    }

    /// All of them.
    pub fn all(&self) -> &[CityLight] {
        &self.points
    }

    /// The points of a level of detail with at least this light; none for an invalid level.
    pub fn of_fineness(&self, fineness: usize, least_light: f32) -> Range<u32> {
        let Some(end) = self.ends.get(fineness) else {
            return 0..0;
        };
        let start = fineness.checked_sub(1).map_or(0, |finer| self.ends[finer]);
        let points = self.points.get(start as usize..*end as usize);
        let bright = points.map_or(0, |points| {
            points.partition_point(|point| point.light >= least_light)
        });
        start..start + bright as u32
    }
}

/// Sum over a group of texels.
struct Sum {
    /// Cell of its first point.
    cell: u32,
    texel: u32,
    light: f32,
    /// The largest light of one point.
    brightest: f32,
    up: Vec3,
    color: Vec3,
}

/// One point for all that is in the same of so many groups of texels, at the brightest of them: their middles would be the lattice of the groups.
fn summed(fine: &[InTexel], groups: usize, group: impl Fn(u32) -> usize) -> Vec<InTexel> {
    let mut places: Vec<Option<usize>> = vec![None; groups];
    let mut sums: Vec<Sum> = Vec::new();
    for (cell, texel, point) in fine {
        let place = *places[group(*texel)].get_or_insert_with(|| {
            sums.push(Sum {
                cell: *cell,
                texel: *texel,
                light: 0.0,
                brightest: 0.0,
                up: Vec3::Z,
                color: Vec3::ZERO,
            });
            sums.len() - 1
        });
        let sum = &mut sums[place];
        sum.light += point.light;
        if point.light > sum.brightest {
            (sum.brightest, sum.up, sum.cell) = (point.light, point.up, *cell);
        }
        sum.color += point.light * Vec3::from(point.color.map(f32::from)) / 255.0;
    }
    let point = |sum: Sum| {
        let point = CityLight::new(sum.up, sum.light, sum.color / sum.light, 0.0);
        (sum.cell, sum.texel, point)
    };
    sums.into_iter().map(point).collect()
}
