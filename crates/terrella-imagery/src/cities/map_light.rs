//! The light of each texel of a map of night lights.

use super::places::Place;
use super::point::LEAST_LIGHT;
use crate::layer::LayerImage;
use std::f64::consts::{PI, TAU};
use std::ops::Range;
use terrella_files::parallel;

/// Nodes and weights of Gauss–Legendre on 0…½, half a texel: exact for the fourth power of a function that is linear between texels.
const NODES: [(f32, f32); 3] = [
    (0.056_350_83, 0.138_888_9),
    (0.25, 0.222_222_22),
    (0.443_649_17, 0.138_888_9),
];

/// Some texels of a map.
pub struct TexelRegion {
    pub rows: Range<usize>,
    pub columns: Range<usize>,
}

/// Light of a map, texel by texel.
#[derive(Default)]
pub struct MapLight {
    width: usize,
    height: usize,
    /// The numbers of texels that have any, row by row, with their light.
    lit: Vec<(u32, f32)>,
}

/// Most columns that light is kept in: finer maps are averaged.
const MOST_COLUMNS: usize = 2048;

impl MapLight {
    /// The mean over each texel of the fourth power of the map's value, which is linear between the middles of texels.
    pub fn new(map: &LayerImage) -> Self {
        let (width, height) = (map.width as usize, map.height as usize);
        let texels = map.levels.first().map_or(&[][..], Vec::as_slice);
        // With the last column before the first and the first after the last.
        let row_of = |row: usize| {
            let row = texels.get(row * width..(row + 1) * width).unwrap_or(&[]);
            let [first, last] = [row.first(), row.last()].map(|end| end.copied().unwrap_or(0));
            let mut around = vec![0; width + 2];
            around[0] = last;
            around[1..]
                .iter_mut()
                .zip(row)
                .for_each(|(to, from)| *to = *from);
            around[width + 1] = first;
            around
        };
        // Side of the group of texels that becomes one.
        let divides = |side: &usize| width.is_multiple_of(*side) && height.is_multiple_of(*side);
        let side = (width.div_ceil(MOST_COLUMNS)..=height).find(divides);
        let side = side.unwrap_or(1).max(1);
        let columns = width / side;
        let rows = parallel::map(height / side, |group| {
            let mut sums = vec![0.0; columns];
            for row in group * side..(group + 1) * side {
                let (above, below) = (row.saturating_sub(1), (row + 1).min(height - 1));
                let [above, row, below] = [above, row, below].map(row_of);
                let any = above.iter().zip(&row).zip(&below);
                let any: Vec<u8> = any.map(|((a, b), c)| a | b | c).collect();
                for (column, near) in any.windows(3).enumerate() {
                    if near != [0; 3] {
                        let around = [column, column + 1, column + 2];
                        let around = around.map(|x| [above[x], row[x], below[x]]);
                        sums[column / side] += mean_fourth_power(around);
                    }
                }
            }
            let first = (group * columns) as u32;
            let lit = (first..).zip(sums).filter(|(_, sum)| *sum > 0.0);
            let texels = (side * side) as f32;
            lit.map(|(texel, sum)| (texel, sum / texels))
                .collect::<Vec<_>>()
        });
        Self {
            width: columns,
            height: height / side,
            lit: rows.concat(),
        }
    }

    /// None, of a map with so many rows.
    pub fn unlit(rows: usize) -> Self {
        Self {
            height: rows,
            ..Self::default()
        }
    }

    /// Light of all texels, in square equatorial radii of ground at the brightness of the brightest.
    pub fn total(&self) -> f64 {
        let lit = self.lit.iter();
        let of = |(texel, light): &(u32, f32)| light * self.area(*texel as usize / self.width);
        lit.map(|lit| f64::from(of(lit))).sum()
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The texels that have light, by number, with its mean of 0…1.
    #[cfg(test)]
    pub fn lit(&self) -> &[(u32, f32)] {
        &self.lit
    }

    /// The texels of a row that have light, in some columns, by number with its mean of 0…1.
    pub fn lit_of_row(&self, row: usize, columns: &Range<usize>) -> &[(u32, f32)] {
        let [first, end] = [columns.start, columns.end].map(|column| {
            let number = (row * self.width + column) as u32;
            self.lit.partition_point(|(texel, _)| *texel < number)
        });
        &self.lit[first..end.max(first)]
    }

    /// Places in texels with light of some account, by texels.
    pub fn lit_places(&self, placed: &ByTexel<Place>) -> Vec<Place> {
        let mut lit = self.lit.iter().peekable();
        let is_lit = |(number, _): &&(u32, Place)| {
            while lit.next_if(|(texel, _)| texel < number).is_some() {}
            let here = lit.peek().filter(|(texel, _)| texel == number);
            here.is_some_and(|(_, light)| *light >= LEAST_LIGHT)
        };
        let places = placed.0.iter().filter(is_lit);
        places.map(|(_, place)| *place).collect()
    }

    /// Area of a texel in a row, square equatorial radii.
    pub fn area(&self, row: usize) -> f32 {
        let (north, south) = (self.lat_rad(row as f64), self.lat_rad(row as f64 + 1.0));
        (TAU / self.width as f64 * (north.sin() - south.sin())) as f32
    }

    /// Latitude of a place so many rows from the north pole, radians.
    fn lat_rad(&self, rows: f64) -> f64 {
        (0.5 - rows / self.height as f64) * PI
    }

    /// Row and column of the texel that contains a place.
    pub fn texel_at(&self, lat_deg: f64, lon_deg: f64) -> (usize, usize) {
        let row = (0.5 - lat_deg / 180.0) * self.height as f64;
        let column = (lon_deg / 360.0 + 0.5).rem_euclid(1.0) * self.width as f64;
        (
            (row.max(0.0) as usize).min(self.height - 1),
            (column as usize).min(self.width - 1),
        )
    }

    /// Number of the texel that contains a place.
    pub fn number_at(&self, lat_deg: f64, lon_deg: f64) -> u32 {
        let (row, column) = self.texel_at(lat_deg, lon_deg);
        (row * self.width + column) as u32
    }

    /// Places grouped by the texels that contain them.
    pub fn places_by_texel(&self, places: &[Place]) -> ByTexel<Place> {
        let located = places.iter();
        let located = located.map(|place| (self.number_at(place.lat_deg, place.lon_deg), *place));
        ByTexel::new(&located.collect::<Vec<_>>())
    }
}

/// Items grouped by the texels of a map that contain them.
pub struct ByTexel<T>(Vec<(u32, T)>);

impl<T: Copy> ByTexel<T> {
    /// From items with the numbers of their texels; items of one texel keep their order.
    pub fn new(located: &[(u32, T)]) -> Self {
        // Sorting numbers is faster than sorting items.
        let keys = (0_u64..).zip(located);
        let keys = keys.map(|(number, (texel, _))| u64::from(*texel) << 32 | number);
        let mut keys: Vec<u64> = keys.collect();
        keys.sort_unstable();
        let sorted = keys.iter().map(|key| located[*key as u32 as usize]);
        Self(sorted.collect())
    }

    /// Those in a texel, each with its number.
    pub fn of(&self, texel: u32) -> &[(u32, T)] {
        let first = self.0.partition_point(|(of, _)| *of < texel);
        let rest = self.0.get(first..).unwrap_or(&[]);
        &rest[..rest.partition_point(|(of, _)| *of == texel)]
    }
}

/// Over a texel, given it and the eight about it, three columns of three.
fn mean_fourth_power(around: [[u8; 3]; 3]) -> f32 {
    let around = around.map(|column| column.map(|value| f32::from(value) / 255.0));
    // Of the four quarters, all at a time.
    let here = around[1][1];
    let beside = [0, 0, 2, 2].map(|x: usize| around[x][1]);
    let over = [0, 2, 0, 2].map(|y: usize| around[1][y]);
    let corner = [around[0][0], around[0][2], around[2][0], around[2][2]];
    let mut sums = [0.0; 4];
    for (a, weight_x) in NODES {
        for (b, weight_y) in NODES {
            for quarter in 0..4 {
                let near = (1.0 - a) * here + a * beside[quarter];
                let far = (1.0 - a) * over[quarter] + a * corner[quarter];
                let square = ((1.0 - b) * near + b * far) * ((1.0 - b) * near + b * far);
                sums[quarter] += weight_x * weight_y * square * square;
            }
        }
    }
    sums.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_texel_keeps_what_the_filter_shows_of_it() {
        let mut texels = vec![0; 8 * 4];
        texels[8 + 3] = 255;
        let map = LayerImage::from_r8(8, 4, texels).expect("a map");
        let light = MapLight::new(&map);
        // ∫ (1 − |x|)⁴ is 2/5 over both texels beside, in both directions.
        let total: f32 = light.lit().iter().map(|(_, light)| light).sum();
        assert!((total - 0.16).abs() < 1e-6, "{total}");
        let of = |row: u32, column: u32| {
            let lit = light
                .lit()
                .iter()
                .find(|(texel, _)| *texel == 8 * row + column);
            lit.expect("it is lit").1
        };
        assert!(of(1, 3) > 10.0 * of(1, 2));
        assert_eq!(of(1, 2), of(1, 4));
        assert_eq!(light.lit().len(), 9);
        let areas: f32 = (0..4).map(|row| 8.0 * light.area(row)).sum();
        assert!((f64::from(areas) - 2.0 * TAU).abs() < 1e-5, "{areas}");
    }

    #[test]
    fn a_fine_map_is_averaged_and_keeps_its_light() {
        let (width, height) = (6 * 1024, 3 * 1024);
        let mut texels = vec![51; width * height];
        texels[width / 2..width].fill(0);
        let map = LayerImage::from_r8(width as u32, height as u32, texels).expect("a map");
        let light = MapLight::new(&map);
        assert_eq!(light.size(), (2048, 1024));
        // A fifth to the fourth power, and in the east of the first row two thirds of it and a little of what lies between.
        let of = |texel: usize| light.lit()[texel].1;
        assert!((of(2048 * 500) - 0.0016).abs() < 1e-6);
        assert!(
            (of(1500) / 0.0016 - (2.0 / 3.0 - 0.8 * 0.5 / 3.0)).abs() < 0.1,
            "{}",
            of(1500)
        );
        assert!((light.total() / (0.0016 * 2.0 * TAU) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn texels_and_places_agree() {
        let map = LayerImage::from_r8(64, 32, vec![0; 64 * 32]).expect("a map");
        let light = MapLight::new(&map);
        for (row, column) in [(0, 0), (31, 63), (7, 40)] {
            let lat = 90.0 - 180.0 * (row as f64 + 0.3) / 32.0;
            let lon = 360.0 * (column as f64 + 0.9) / 64.0 - 180.0;
            assert_eq!(light.texel_at(lat, lon), (row, column));
        }
        assert_eq!(light.texel_at(-90.0, 180.0), (31, 0));
    }
}
