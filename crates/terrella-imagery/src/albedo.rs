//! Mean albedo of the ground and its clouds over neighbourhoods of some hundred kilometres: the air scatters light from all of them, not only from
//! the pixel behind it.

use super::layer::{EarthLayers, LayerImage};
use super::mips::level_count;
use super::srgb::LINEAR_FROM_SRGB;
use super::texel::TexelFormat;
use super::tile::{MAP_LAYERS, MapLayer};
use glam::{Vec3, Vec4};

/// Neighbourhoods around the Earth; half as many from pole to pole.
pub const NEIGHBOURHOODS: u32 = 64;
/// Part of the light that whole cloud cover reflects.
pub const CLOUD_ALBEDO: f64 = 0.8;
/// Part of the light that open water reflects, the sky's mirror image included.
const SEA_ALBEDO: f32 = 0.05;

const WIDTH: usize = NEIGHBOURHOODS as usize;
const HEIGHT: usize = WIDTH / 2;

/// Means over all neighbourhoods, row by row from the north, from 180° W.
#[derive(Clone, Debug)]
pub struct NeighbourhoodAlbedo {
    day: Vec<Vec3>,
    water: Option<Vec<Vec3>>,
    cloud_cover: Option<Vec<Vec3>>,
    lamps: Option<Vec<Vec3>>,
}

impl NeighbourhoodAlbedo {
    /// From these maps. The day map serves as the land's albedo.
    pub fn new(layers: &EarthLayers) -> Self {
        let part = |layer| {
            let map = layers.get(layer)?;
            MapAlbedo::of(layer, map)
        };
        Self::of_parts(part)
    }

    /// From the contribution of each map; black land without a day map.
    pub fn of_parts(part: impl Fn(MapLayer) -> Option<MapAlbedo>) -> Self {
        let means = |layer| part(layer).map(|part| part.means);
        Self {
            day: means(MapLayer::Day).unwrap_or_else(|| vec![Vec3::ZERO; WIDTH * HEIGHT]),
            water: means(MapLayer::Water),
            cloud_cover: means(MapLayer::Clouds),
            lamps: means(MapLayer::NightLights),
        }
    }

    /// Takes another map's part from now on.
    pub fn set(&mut self, part: &MapAlbedo) {
        match part.layer {
            MapLayer::Day => self.day.clone_from(&part.means),
            MapLayer::Clouds => self.cloud_cover = Some(part.means.clone()),
            MapLayer::Water => self.water = Some(part.means.clone()),
            MapLayer::NightLights => self.lamps = Some(part.means.clone()),
            MapLayer::Normals => {}
        }
    }

    /// Whether there are clouds.
    pub fn has_clouds(&self) -> bool {
        self.cloud_cover.is_some()
    }

    /// Linear RGB, row by row, with the last column before the first and the first after the last. Water and clouds count where
    /// they are `shown`, maps by [`MapLayer::index`].
    pub fn texels(&self, shown: &[bool; MAP_LAYERS]) -> Vec<Vec4> {
        let map = |map: &Option<Vec<Vec3>>, layer: MapLayer, cell: usize| {
            let map = map.as_ref().filter(|_| shown[layer.index()]);
            map.map_or(0.0, |map| map[cell].x)
        };
        let albedo = |cell: usize| {
            let sea = map(&self.water, MapLayer::Water, cell);
            let cover = map(&self.cloud_cover, MapLayer::Clouds, cell);
            let ground = self.day[cell].lerp(Vec3::splat(SEA_ALBEDO), sea);
            ground.lerp(Vec3::splat(CLOUD_ALBEDO as f32), cover)
        };
        cells_around()
            .map(|cell| albedo(cell).extend(1.0))
            .collect()
    }

    /// Light of lamps in the same texels, that of the brightest being 1; empty without a map of them. It is the fourth root of the mean fourth
    /// power, which is dominated by the centres of towns: the dark remainder has a larger area.
    pub fn lamps(&self) -> Vec<f32> {
        let lamps = self.lamps.as_deref();
        lamps.map_or_else(Vec::new, |lamps| {
            cells_around()
                .map(|cell| lamps[cell].x.sqrt().sqrt())
                .collect()
        })
    }
}

/// The contribution of one map.
#[derive(Clone, Debug)]
pub struct MapAlbedo {
    layer: MapLayer,
    means: Vec<Vec3>,
}

impl MapAlbedo {
    /// That of a map; `None` of one that has no part in it.
    pub fn of(layer: MapLayer, map: &LayerImage) -> Option<Self> {
        let level = Self::level(layer, map);
        let texels = map.levels.get(level).map_or(&[][..], Vec::as_slice);
        Self::of_texels(layer, texels, map.level_size(level), map.format)
    }

    /// The mip level that it is computed from: the smallest with a texel for each neighbourhood. For lamps a larger one, as their light is not
    /// linear in the texels' values.
    pub(super) fn level(layer: MapLayer, map: &LayerImage) -> usize {
        let finer = if layer == MapLayer::NightLights { 8 } else { 1 };
        let is_large = |level: &usize| {
            let (width, height) = map.level_size(*level);
            width as usize >= finer * WIDTH && height as usize >= finer * HEIGHT
        };
        let levels = 0..level_count(map.width, map.height);
        levels.take_while(is_large).last().unwrap_or(0)
    }

    /// The same from the texels of that level.
    pub(super) fn of_texels(
        layer: MapLayer,
        texels: &[u8],
        size: (u32, u32),
        format: TexelFormat,
    ) -> Option<Self> {
        let bytes = format.texel_bytes();
        let means = match layer {
            MapLayer::Day => means(texels, size, bytes, color),
            MapLayer::Clouds | MapLayer::Water => means(texels, size, bytes, cover),
            MapLayer::NightLights => means(texels, size, bytes, lamp),
            MapLayer::Normals => return None,
        };
        Some(Self { layer, means })
    }

    /// Blend of two contributions: `weight` 0 is `from`, 1 is `to`.
    pub fn between(from: &Self, to: &Self, weight: f32) -> Self {
        let pairs = from.means.iter().zip(&to.means);
        Self {
            layer: from.layer,
            means: pairs.map(|(from, to)| from.lerp(*to, weight)).collect(),
        }
    }
}

fn color(texel: &[u8]) -> Vec3 {
    let linear = |code: u8| LINEAR_FROM_SRGB[usize::from(code)];
    Vec3::from_array([0, 1, 2].map(|c| linear(texel[c])))
}

fn cover(texel: &[u8]) -> Vec3 {
    Vec3::splat(f32::from(texel[0]) / 255.0)
}

/// The fourth power of lamps' light: maps hold its fourth root.
fn lamp(texel: &[u8]) -> Vec3 {
    Vec3::splat((f32::from(texel[0]) / 255.0).powi(16))
}

/// Cells row by row, with the last column before the first and the first after the last.
fn cells_around() -> impl Iterator<Item = usize> {
    let row = |row: usize| {
        let columns = (0..WIDTH + 2).map(|column| (column + WIDTH - 1) % WIDTH);
        columns.map(move |column| row * WIDTH + column)
    };
    (0..HEIGHT).flat_map(row)
}

/// Means of a map's texels over the cells, each texel weighted by the area that it shares with a cell. Cells are as wide on the ground as at the
/// equator, and each pole has one: narrower ones would converge there as wedges.
fn means(
    texels: &[u8],
    (width, height): (u32, u32),
    bytes: usize,
    value: impl Fn(&[u8]) -> Vec3,
) -> Vec<Vec3> {
    let (width, height) = (width as usize, height as usize);
    let mut means = Vec::with_capacity(WIDTH * HEIGHT);
    for y in 0..HEIGHT {
        let mut row = vec![(Vec3::ZERO, 0.0); WIDTH];
        for (texel_row, tall) in shares(y, HEIGHT, height) {
            let area = tall * latitude_rad(texel_row, height).cos();
            for (x, (sum, weight)) in row.iter_mut().enumerate() {
                for (column, wide) in shares(x, WIDTH, width) {
                    let at = (texel_row * width + column) * bytes;
                    if let Some(texel) = texels.get(at..at + bytes) {
                        *sum += area * wide * value(texel);
                        *weight += area * wide;
                    }
                }
            }
        }
        let row = row
            .iter()
            .map(|(sum, weight)| *sum / weight.max(f32::MIN_POSITIVE));
        means.extend(widened(&row.collect::<Vec<_>>(), cells_wide(y)));
    }
    means
}

/// Texels of a line that share a length with a cell, and that length.
fn shares(cell: usize, cells: usize, texels: usize) -> impl Iterator<Item = (usize, f32)> {
    let edge = |cell: usize| (cell * texels) as f32 / cells as f32;
    let (from, to) = (edge(cell), edge(cell + 1));
    let all = cell * texels / cells..((cell + 1) * texels).div_ceil(cells);
    all.map(move |texel| {
        let shared = to.min(texel as f32 + 1.0) - from.max(texel as f32);
        (texel, shared.max(0.0))
    })
}

/// Latitude of the middle of a row of so many.
fn latitude_rad(row: usize, rows: usize) -> f32 {
    std::f32::consts::PI * (0.5 - (row as f32 + 0.5) / rows as f32)
}

/// How many cells of a row are as wide on the ground as one at the equator.
fn cells_wide(row: usize) -> f32 {
    if row == 0 || row == HEIGHT - 1 {
        return WIDTH as f32;
    }
    1.0 / latitude_rad(row, HEIGHT).cos()
}

/// Means of a closed row over so many cells around each.
fn widened(row: &[Vec3], cells: f32) -> Vec<Vec3> {
    if cells >= row.len() as f32 {
        let mean = row.iter().sum::<Vec3>() / row.len() as f32;
        return vec![mean; row.len()];
    }
    let beside = 0.5 * (cells - 1.0);
    let whole = beside as usize;
    let at = |x: usize| row[x % row.len()];
    let mean = |x: usize| {
        let x = x + row.len();
        let inner: Vec3 = (x - whole..=x + whole).map(at).sum();
        let ends = at(x - whole - 1) + at(x + whole + 1);
        (inner + (beside - whole as f32) * ends) / cells
    };
    (0..row.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layers(day: LayerImage, clouds: Option<LayerImage>) -> EarthLayers {
        EarthLayers {
            day,
            clouds,
            normals: None,
            night_lights: None,
            water: None,
        }
    }

    #[test]
    fn a_uniform_map_gives_its_colour_and_clouds_cover_it() {
        for size in [1, 2, 64, 100, 256] {
            let texels = [188, 0, 255, 255].repeat((2 * size * size) as usize);
            let day = LayerImage::from_rgba8(2 * size, size, texels).expect("a map");
            let half = vec![128; 8];
            let clouds = LayerImage::from_r8(4, 2, half).expect("a map");
            let albedo = NeighbourhoodAlbedo::new(&layers(day, Some(clouds)));
            let (red, cover) = (LINEAR_FROM_SRGB[188], 128.0 / 255.0);
            for (shown, cover) in [([false; MAP_LAYERS], 0.0), ([true; MAP_LAYERS], cover)] {
                let texels = albedo.texels(&shown);
                assert_eq!(texels.len(), (WIDTH + 2) * HEIGHT);
                for texel in texels {
                    let expected =
                        Vec3::new(red, 0.0, 1.0).lerp(Vec3::splat(CLOUD_ALBEDO as f32), cover);
                    assert!(texel.truncate().distance(expected) < 1e-5, "{texel}");
                }
            }
        }
    }

    #[test]
    fn the_brightest_lamps_decide() {
        // Every second texel is at half of the scale: light of 1/16.
        let texels = (0..512 * 256).map(|at| if at % 2 == 0 { 128 } else { 0 });
        let night = LayerImage::from_r8(512, 256, texels.collect()).expect("a map");
        let mut maps = layers(
            LayerImage::from_rgba8(2, 1, vec![9; 8]).expect("a map"),
            None,
        );
        assert!(NeighbourhoodAlbedo::new(&maps).lamps().is_empty());
        maps.night_lights = Some(night);
        let lamps = NeighbourhoodAlbedo::new(&maps).lamps();
        assert_eq!(lamps.len(), (WIDTH + 2) * HEIGHT);
        let wanted = 0.5_f32.powf(0.25) * (128.0_f32 / 255.0).powi(4);
        let off = lamps.iter().map(|lamp| (lamp / wanted - 1.0).abs());
        assert!(off.fold(0.0, f32::max) < 1e-3, "{lamps:?}");
    }

    /// The first channel of a map of 128 x 64 texels, as from [`NeighbourhoodAlbedo::texels`], given its white texels.
    fn of_white(is_white: impl Fn(usize, usize) -> bool) -> Vec<f32> {
        let white = |at: usize| [if is_white(at % 128, at / 128) { 255 } else { 0 }; 4];
        let texels = (0..128 * 64).flat_map(white).collect();
        let day = LayerImage::from_rgba8(128, 64, texels).expect("a map");
        let texels = NeighbourhoodAlbedo::new(&layers(day, None)).texels(&[true; MAP_LAYERS]);
        texels.iter().map(|texel| texel.x).collect()
    }

    #[test]
    fn cells_stand_where_the_map_does_and_go_round() {
        // White south of the equator at the western edge, one cell wide.
        let texels = of_white(|column, row| column < 2 && (32..34).contains(&row));
        let lit: Vec<_> = (0..texels.len()).filter(|at| texels[*at] > 0.5).collect();
        let row = HEIGHT / 2 * (WIDTH + 2);
        assert_eq!(lit, [row + 1, row + WIDTH + 1]);
    }

    #[test]
    fn a_pole_has_one_value_and_rows_near_it_keep_their_mean() {
        // A white wedge of an eighth of the circle, from pole to pole.
        let texels = of_white(|column, _| column < 16);
        for (y, row) in texels.chunks_exact(WIDTH + 2).enumerate() {
            let row = &row[1..=WIDTH];
            let mean = row.iter().sum::<f32>() / WIDTH as f32;
            assert!((mean - 0.125).abs() < 1e-5, "row {y}: {mean}");
            let steepest = (0..WIDTH).map(|x| (row[x] - row[(x + 1) % WIDTH]).abs());
            let steepest = steepest.fold(0.0, f32::max);
            // A cell of the ground's size goes from black to white, whatever its number of columns.
            let latitude = latitude_rad(y, HEIGHT);
            let bound = if y == 0 || y == HEIGHT - 1 {
                1e-6
            } else {
                1.001 * latitude.cos()
            };
            assert!(steepest <= bound, "row {y}: {steepest} of {bound}");
        }
    }

    #[test]
    fn texels_on_the_edge_of_two_cells_count_in_both_by_their_parts() {
        // 96 columns: of three texels the middle one is split between two cells.
        let texels = (0..96 * 48).flat_map(|at| [if at % 96 == 1 { 255 } else { 0 }; 4]);
        let found = means(&texels.collect::<Vec<u8>>(), (96, 48), 4, color);
        let row = &found[HEIGHT / 2 * WIDTH..][..WIDTH];
        let third = 1.0 / 3.0;
        assert!(
            (row[0].x - third).abs() < 2e-3 && (row[1].x - third).abs() < 2e-3,
            "{row:?}"
        );
        assert!(row[2].x < 2e-3, "{row:?}");
    }
}
