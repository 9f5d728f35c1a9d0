//! What the ground and its clouds reflect, averaged over neighbourhoods of some hundred kilometres: the air scatters light that
//! comes from all of them, not from the pixel behind it.

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
    /// Of these maps. The day map is taken for the land's albedo.
    pub fn new(layers: &EarthLayers) -> Self {
        let part = |layer| {
            let map = layers.get(layer)?;
            MapAlbedo::of(layer, map)
        };
        Self::of_parts(part)
    }

    /// Of what each map contributes; black land without a day map.
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
    /// power, which the hearts of towns decide: what is dark between them is larger.
    pub fn lamps(&self) -> Vec<f32> {
        let lamps = self.lamps.as_deref();
        lamps.map_or_else(Vec::new, |lamps| {
            cells_around()
                .map(|cell| lamps[cell].x.sqrt().sqrt())
                .collect()
        })
    }
}

/// What one map has a part in it with.
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

    /// The level of a map that it is found from: the smallest with a texel for each neighbourhood. Of lamps, whose light is no mean of what
    /// texels hold, one of many.
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

    /// What lies between two: `weight` 0 is `from`, 1 is `to`.
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

/// Means of a map's texels over the cells.
fn means(
    texels: &[u8],
    (width, height): (u32, u32),
    bytes: usize,
    value: impl Fn(&[u8]) -> Vec3,
) -> Vec<Vec3> {
    let (width, height) = (width as usize, height as usize);
    let part = |cell: usize, cells: usize, size: usize| {
        let first = cell * size / cells;
        first..((cell + 1) * size).div_ceil(cells).max(first + 1)
    };
    let cells = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
    let mean = |(x, y)| {
        let places = part(y, HEIGHT, height)
            .flat_map(|row| part(x, WIDTH, width).map(move |column| row * width + column));
        let found = places.filter_map(|at| texels.get(at * bytes..(at + 1) * bytes));
        let (sum, count) = found.fold((Vec3::ZERO, 0.0), |(sum, count), texel| {
            (sum + value(texel), count + 1.0)
        });
        sum / f32::max(count, 1.0)
    };
    cells.map(mean).collect()
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

    #[test]
    fn cells_stand_where_the_map_does_and_go_round() {
        // White in the south-west corner, one cell wide.
        let is_white = |at: usize| at % 128 < 2 && at / 128 >= 62;
        let texels = (0..128 * 64)
            .flat_map(|at| [if is_white(at) { 255 } else { 0 }; 4])
            .collect();
        let day = LayerImage::from_rgba8(128, 64, texels).expect("a map");
        let texels = NeighbourhoodAlbedo::new(&layers(day, None)).texels(&[true; MAP_LAYERS]);
        let lit: Vec<_> = (0..texels.len()).filter(|at| texels[*at].x > 0.5).collect();
        let last_row = (HEIGHT - 1) * (WIDTH + 2);
        assert_eq!(lit, [last_row + 1, last_row + WIDTH + 1]);
    }
}
