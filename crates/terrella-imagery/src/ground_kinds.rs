//! Where the maps show nothing but land, or nothing but open sea: what is drawn there needs no other part of the shader.

use super::layer::{EarthLayers, LayerImage};
use super::tile::MapLayer;
use std::ops::Range;

/// Kind of a cell of the Earth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum GroundKind {
    /// Both, or not known.
    Mixed,
    /// No water at all.
    Land,
    /// Nothing but water, so deep that its floor does not show.
    OpenSea,
}

/// The kinds of cells, [`CELLS_AROUND`] from west to east and half as many from north to south.
pub struct GroundKinds {
    cells: Vec<GroundKind>,
}

/// Cells around the Earth: 48 for each of 16 blocks.
pub const CELLS_AROUND: u32 = 768;

const WIDTH: usize = CELLS_AROUND as usize;
const HEIGHT: usize = WIDTH / 2;
/// Cells to each side that must be alike: a hundred kilometres, farther than a pixel of [`MOST_PIXEL_M`] looks in a mip level.
const MARGIN: usize = 2;
/// Largest pixel that kinds are used for, metres on the ground.
pub const MOST_PIXEL_M: f64 = 8_000.0;
/// Least texels around the Earth of the level that is looked at.
const LEAST_TEXELS: u32 = 2048;

const HAS_WATER: u8 = 1;
const HAS_LAND: u8 = 2;

/// Kinds of the cells according to one map.
#[derive(Clone, Debug)]
pub struct MapGroundKinds(Vec<u8>);

impl MapGroundKinds {
    /// From a map; `None` for one without information about land and sea.
    pub fn of(layer: MapLayer, map: &LayerImage) -> Option<Self> {
        let mut rows = GroundKindRows::new(layer, map)?;
        let texels = map.levels.get(rows.level).map_or(&[][..], Vec::as_slice);
        rows.rows(rows.level, 0, texels);
        Some(rows.finish())
    }
}

impl GroundKinds {
    /// From maps of the whole Earth; `None` without a map of water.
    pub fn new(layers: &EarthLayers) -> Option<Self> {
        let part = |layer| MapGroundKinds::of(layer, layers.get(layer)?);
        Some(Self::of_parts(
            &part(MapLayer::Water)?,
            &part(MapLayer::Day)?,
        ))
    }

    /// From the kinds according to a map of water and a day map.
    pub fn of_parts(water: &MapGroundKinds, day: &MapGroundKinds) -> Self {
        let pairs = water.0.iter().zip(&day.0);
        let found: Vec<u8> = pairs.map(|(water, day)| water | day).collect();
        let cells = spread(&found).into_iter().map(|found| match found {
            HAS_LAND => GroundKind::Land,
            HAS_WATER => GroundKind::OpenSea,
            _ => GroundKind::Mixed,
        });
        Self {
            cells: cells.collect(),
        }
    }

    /// The common kind of a cell, for this many cells a block edge, the `column`th from 180° W and the `row`th from the north.
    pub fn of(&self, cells_per_block: u32, (column, row): (u32, u32)) -> GroundKind {
        let finest = CELLS_AROUND / 16;
        if cells_per_block == 0 || !finest.is_multiple_of(cells_per_block) {
            return GroundKind::Mixed;
        }
        let side = (finest / cells_per_block) as usize;
        let (x, y) = (column as usize * side, row as usize * side);
        let rows = (y..y + side).map(|y| self.cells.get(y * WIDTH + x..y * WIDTH + x + side));
        let mut cells = rows.flat_map(Option::unwrap_or_default);
        let first = cells.next().copied().unwrap_or(GroundKind::Mixed);
        match cells.all(|kind| *kind == first) {
            true => first,
            false => GroundKind::Mixed,
        }
    }
}

/// Notes in each cell what texels of a map are in it or reach into it when they are filtered, as rows of the map come in.
pub(super) struct GroundKindRows {
    kind: fn(&[u8]) -> u8,
    /// The level that is looked at, and its height.
    level: usize,
    height: usize,
    texel_bytes: usize,
    /// The cells that each texel of a row reaches.
    columns: Vec<Range<usize>>,
    found: Vec<u8>,
}

impl GroundKindRows {
    /// For a map of this size and format; `None` for one without information about land and sea.
    pub fn new(layer: MapLayer, map: &LayerImage) -> Option<Self> {
        let kind: fn(&[u8]) -> u8 = match layer {
            MapLayer::Water => |texel| match texel.first() {
                Some(0) => HAS_LAND,
                Some(255) => HAS_WATER,
                _ => HAS_LAND | HAS_WATER,
            },
            // Where the floor is visible it is not the open sea.
            MapLayer::Day => |texel| match texel.get(3) {
                Some(255) => 0,
                _ => HAS_LAND,
            },
            MapLayer::Clouds | MapLayer::Normals | MapLayer::NightLights => return None,
        };
        let level = map.level_of_width(LEAST_TEXELS as usize);
        let (width, height) = map.level_size(level);
        let width = width as usize;
        Some(Self {
            kind,
            level,
            height: height as usize,
            texel_bytes: map.format.texel_bytes(),
            columns: (0..width).map(|x| reach(x, width, WIDTH)).collect(),
            found: vec![0; WIDTH * HEIGHT],
        })
    }

    /// Takes rows of a level from a number on; all but one level are ignored.
    pub fn rows(&mut self, level: usize, first: u32, texels: &[u8]) {
        if level != self.level {
            return;
        }
        let rows = texels.chunks_exact(self.columns.len() * self.texel_bytes);
        for (y, row) in (first as usize..).zip(rows) {
            let mut line = [0_u8; WIDTH];
            for (texel, columns) in row.chunks_exact(self.texel_bytes).zip(&self.columns) {
                let kind = (self.kind)(texel);
                line[columns.clone()].iter_mut().for_each(|at| *at |= kind);
            }
            // Around the Earth.
            (line[0], line[WIDTH - 1]) = (line[0] | line[WIDTH - 1], line[0] | line[WIDTH - 1]);
            for y in reach(y, self.height, HEIGHT) {
                let cells = self.found[y * WIDTH..(y + 1) * WIDTH].iter_mut();
                cells.zip(&line).for_each(|(at, here)| *at |= here);
            }
        }
    }

    pub fn finish(self) -> MapGroundKinds {
        MapGroundKinds(self.found)
    }
}

/// The cells of a line that a texel affects: up to one and a half of its size from its centre on both sides.
fn reach(texel: usize, texels: usize, cells: usize) -> Range<usize> {
    let (low, high) = ((2 * texel).saturating_sub(1), 2 * texel + 3);
    low * cells / (2 * texels)..(high * cells).div_ceil(2 * texels).min(cells)
}

/// The kinds found in each cell and in [`MARGIN`] cells around it.
fn spread(found: &[u8]) -> Vec<u8> {
    let margin = MARGIN as isize;
    let around = |x: usize, by: isize| (x as isize + by).rem_euclid(WIDTH as isize) as usize;
    let mut across = vec![0; found.len()];
    for (row, out) in found
        .chunks_exact(WIDTH)
        .zip(across.chunks_exact_mut(WIDTH))
    {
        for (x, out) in out.iter_mut().enumerate() {
            let near = (-margin..=margin).map(|by| row[around(x, by)]);
            *out = near.fold(0, |all, here| all | here);
        }
    }
    let mut all = vec![0; found.len()];
    for y in 0..HEIGHT {
        for near in y.saturating_sub(MARGIN)..(y + MARGIN + 1).min(HEIGHT) {
            let (out, row) = (&mut all[y * WIDTH..], &across[near * WIDTH..]);
            let pairs = out.iter_mut().zip(row).take(WIDTH);
            pairs.for_each(|(at, here)| *at |= here);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(width: usize, is_water: impl Fn(usize, usize) -> bool, depth: u8) -> GroundKinds {
        let texel = |at: usize| is_water(at % width, at / width);
        let count = width * width / 2;
        let (w, h) = (width as u32, width as u32 / 2);
        let water = (0..count).map(|at| if texel(at) { 255 } else { 0 });
        let day = [0, 0, 0, depth].repeat(count);
        GroundKinds::new(&EarthLayers {
            day: LayerImage::from_rgba8(w, h, day).expect("a map"),
            clouds: None,
            normals: None,
            night_lights: None,
            water: Some(LayerImage::from_r8(w, h, water.collect()).expect("a map")),
        })
        .expect("a map of water")
    }

    #[test]
    fn a_sea_is_open_a_hundred_kilometres_off_its_coasts_where_its_floor_does_not_show() {
        for width in [64, 512, 2048, 4096] {
            // Water in the western half.
            let is_water = |x, _| x < width / 2;
            let all = kinds(width, is_water, 255);
            let texel = (CELLS_AROUND as usize).div_ceil(width) as u32 * 3 / 2;
            let away = texel + MARGIN as u32 + 1;
            for row in [0, 100, 383] {
                for (column, kind) in [
                    (384 - away, GroundKind::OpenSea),
                    (384 + away, GroundKind::Land),
                    (384, GroundKind::Mixed),
                    (383, GroundKind::Mixed),
                    (382, GroundKind::Mixed),
                    (385, GroundKind::Mixed),
                    // The other coast is at 180°.
                    (0, GroundKind::Mixed),
                    (767, GroundKind::Mixed),
                    (away, GroundKind::OpenSea),
                    (767 - away, GroundKind::Land),
                ] {
                    assert_eq!(all.of(48, (column, row)), kind, "{width}: {column}");
                }
            }
            // Coarser cells are of a kind if all of theirs are; sizes that do not fit are not known.
            assert_eq!(all.of(2, (8, 4)), GroundKind::OpenSea);
            assert_eq!(all.of(2, (15, 4)), GroundKind::Mixed);
            assert_eq!(all.of(5, (20, 20)), GroundKind::Mixed);
            assert_eq!(all.of(0, (0, 0)), GroundKind::Mixed);
            let shallow = kinds(width, is_water, 254);
            assert_eq!(shallow.of(48, (100, 100)), GroundKind::Mixed);
            assert_eq!(shallow.of(48, (600, 100)), GroundKind::Land);
        }
    }

    #[test]
    fn a_single_texel_is_found() {
        for at in [(0, 0), (2047, 1023), (1000, 500), (1, 700)] {
            let island = kinds(2048, |x, y| (x, y) != at, 255);
            let lake = kinds(2048, |x, y| (x, y) == at, 255);
            let cell = ((at.0 * 3 / 8) as u32, (at.1 * 3 / 8) as u32);
            for kinds in [island, lake] {
                assert_eq!(kinds.of(48, cell), GroundKind::Mixed, "{at:?}");
                let beside = (cell.0 + 767) % 768;
                assert_eq!(kinds.of(48, (beside, cell.1)), GroundKind::Mixed);
            }
        }
    }
}
