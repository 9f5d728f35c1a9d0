//! A folder of maps, read.

use super::colour::Said;
use super::decode::{FileKind, TexelKind};
use super::error::ImageryError;
use super::grey::GreyFile;
use super::layer::{EarthLayers, LayerImage};
use super::map_file::{MapFile, read_file};
use super::map_folder::MapFolder;
use super::map_rows::{KeptInMemory, MapBuilder, MapSink};
use super::sea::{SeaFloor, grow_land, water_at};
use super::season::Season;
use super::slopes::{ELEVATION_OFFSET_M, SLOPE_EXAGGERATION, slopes_from_elevation};
use super::texel::TexelFormat;
use super::tile::MapLayer;
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use terrella_files::{self as files, parallel};

/// Names of the day map, first come first taken.
pub(super) const DAY_NAMES: [&str; 2] = ["day.jpg", "day.png"];

/// Which maps are wanted beside the day map, which always is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerSelection {
    /// Cloud cover.
    pub clouds: bool,
    /// Terrain normals, from the elevation map.
    pub normals: bool,
    /// City lights.
    pub night_lights: bool,
    /// Open water, and with it the depth of the sea from the elevation map. A folder without it is still valid: its sea
    /// has the day map's colours.
    pub water: bool,
}

/// Names of the cloud map, first come first taken.
const CLOUD_NAMES: [&str; 2] = ["clouds.png", "clouds.jpg"];

/// Files of the maps that may be left out, under their names in a folder: first come first taken.
const OPTIONAL_FILES: [(MapLayer, &[&str]); 4] = [
    (MapLayer::Clouds, &CLOUD_NAMES),
    (MapLayer::Normals, &[ELEVATION_NAME]),
    (MapLayer::NightLights, &[NIGHT_LIGHTS_NAME]),
    (MapLayer::Water, &[WATER_NAME]),
];

/// The file of the map of night lights.
pub(super) const NIGHT_LIGHTS_NAME: &str = "night_lights.png";

/// The file of the map of open water.
pub(super) const WATER_NAME: &str = "water.png";

/// The file of the elevation map.
const ELEVATION_NAME: &str = "elevation.png";

/// The first of these files that a folder has.
fn first_in(dir: &Path, names: &[&str]) -> Option<PathBuf> {
    let name = MapFolder::Disk(dir).first(names)?;
    Some(dir.join(name))
}

impl LayerSelection {
    /// Whether it has a map; the day map always.
    pub fn has(self, layer: MapLayer) -> bool {
        match layer {
            MapLayer::Day => true,
            MapLayer::Clouds => self.clouds,
            MapLayer::Normals => self.normals,
            MapLayer::NightLights => self.night_lights,
            MapLayer::Water => self.water,
        }
    }

    /// Names that its files may have in a folder, the day map's among them: for programs that fetch the files themselves and give them as
    /// [`MapFolder::Memory`]. Of the names of one map the first that exists is read.
    pub fn file_names(self) -> Vec<&'static str> {
        let wanted = OPTIONAL_FILES.into_iter();
        let wanted = wanted.filter(|(layer, _)| self.has(*layer));
        // The depth of the sea is read from elevations.
        let elevation = (self.water && !self.normals).then_some(ELEVATION_NAME);
        let names = wanted.flat_map(|(_, names)| names.iter().copied());
        DAY_NAMES
            .into_iter()
            .chain(names)
            .chain(elevation)
            .collect()
    }

    /// The maps of it whose files a folder has not, with the names of these files.
    pub fn missing_in(self, dir: &Path) -> Vec<(MapLayer, &'static str)> {
        let wanted = OPTIONAL_FILES.into_iter();
        wanted
            .filter(|(layer, names)| self.has(*layer) && first_in(dir, names).is_none())
            .map(|(layer, names)| (layer, names[0]))
            .collect()
    }

    /// The existing files that [`load_layers`] reads from a folder for these maps.
    pub fn files_in(self, dir: &Path) -> Vec<PathBuf> {
        // The depth of the sea is from the elevation map too.
        let is_read = |layer| self.has(layer) || layer == MapLayer::Normals && self.water;
        let optional = OPTIONAL_FILES.into_iter();
        let optional = optional.filter(|(layer, _)| is_read(*layer));
        let optional = optional.filter_map(|(_, names)| first_in(dir, names));
        day_file(dir).into_iter().chain(optional).collect()
    }

    /// The same without some maps.
    pub fn without(mut self, layers: &[(MapLayer, &'static str)]) -> Self {
        for (layer, _) in layers {
            match layer {
                MapLayer::Clouds => self.clouds = false,
                MapLayer::Normals => self.normals = false,
                MapLayer::NightLights => self.night_lights = false,
                MapLayer::Water => self.water = false,
                MapLayer::Day => {}
            }
        }
        self
    }
}

impl Default for LayerSelection {
    /// Everything.
    fn default() -> Self {
        Self {
            clouds: true,
            normals: true,
            night_lights: true,
            water: true,
        }
    }
}

/// Reads the selected maps of a folder, two at a time, and computes their mip levels. Files of other maps are not opened.
///
/// | map | file | texels |
/// |---|---|---|
/// | day | `day.jpg`, else `day.png` | 8-bit colour or grey, sRGB |
/// | clouds | `clouds.png`, else `clouds.jpg` | 8-bit grey, cover 0…1, or with the cover in alpha |
/// | night lights | `night_lights.png` | the same, intensity 0…1 |
/// | normals | `elevation.png` | 16-bit grey, metres + [`ELEVATION_OFFSET_M`] |
/// | water | `water.png`, which may be missing | 8-bit grey: open water 0…1, the coast where it is one half |
///
/// All are equirectangular maps of the whole Earth, north row first, left edge at 180° W, [`MIN_HEIGHT`](super::MIN_HEIGHT) to
/// [`MAX_HEIGHT`](super::MAX_HEIGHT) texels high and twice as wide. Slopes are stored [`SLOPE_EXAGGERATION`] times too steep.
///
/// With a water map the day map's colours are the land's, extended some way over the coast, and its alpha is the depth of the sea's floor (see
/// [`EarthLayers::day`]), from `elevation.png` if it exists.
///
/// # Errors
/// The first invalid map, in the order of the table, with its path, the cause and the remedy.
pub fn load_layers(dir: &Path, selection: LayerSelection) -> Result<EarthLayers, ImageryError> {
    let (layers, damaged) = load_whole_layers(dir, selection)?;
    match damaged.into_iter().next() {
        None => Ok(layers),
        Some(damaged) => Err(damaged.error),
    }
}

/// A map that is left out because its file is damaged.
#[derive(Debug)]
pub struct DamagedLayer {
    /// The map; the terrain's also where the sea alone is without its floor.
    pub layer: MapLayer,
    /// The error in its file.
    pub error: ImageryError,
}

/// As [`load_layers`], without the maps whose files are corrupt. The day map must be valid.
///
/// # Errors
/// As [`load_layers`], except corrupt maps other than the day map.
pub fn load_whole_layers(
    dir: &Path,
    selection: LayerSelection,
) -> Result<(EarthLayers, Vec<DamagedLayer>), ImageryError> {
    load_layers_to(dir, selection, &KeptInMemory)
}

/// As [`load_whole_layers`], from a folder or from files in memory, with maps that are passed to a sink while they are read: maps that it accepts
/// have no texels in the result ([`LayerImage::without_texels`]). No map is in memory as a whole except the day map, and that only until it is
/// passed on.
///
/// # Errors
/// As [`load_whole_layers`]; the sink may then have received some of the maps.
pub fn load_layers_to<'f>(
    folder: impl Into<MapFolder<'f>>,
    selection: LayerSelection,
    sink: &dyn MapSink,
) -> Result<(EarthLayers, Vec<DamagedLayer>), ImageryError> {
    load_seasonal_layers(folder, selection, None, sink)
}

/// As [`load_layers_to`], with the snow and the sea's ice of a season; the latter only with the water map, which is then of open water.
///
/// # Errors
/// As [`load_layers_to`].
pub fn load_seasonal_layers<'f>(
    folder: impl Into<MapFolder<'f>>,
    selection: LayerSelection,
    season: Option<&Season>,
    sink: &dyn MapSink,
) -> Result<(EarthLayers, Vec<DamagedLayer>), ImageryError> {
    let folder = folder.into();
    let (send, terrain) = mpsc::channel();
    let others = move || {
        // The day map waits for it.
        let _ = send.send(load_terrain(folder, selection, season, sink));
        let load = |wanted: bool, load: fn(_, _) -> _| wanted.then(|| load(folder, sink));
        [
            load(selection.clouds, load_clouds),
            load(selection.night_lights, load_night_lights),
        ]
    };
    // The largest map is read by the calling thread. Errors are looked at when both threads have ended.
    let (others, (terrain, day)) = parallel::join(others, || {
        let day = read_day(folder);
        match terrain.recv() {
            Ok(Ok(mut terrain)) => {
                let day = day.and_then(|day| day.image(&mut terrain, season, sink));
                (Ok(terrain), day)
            }
            Ok(Err(error)) => (Err(error), day.map(DayTexels::description)),
            // The thread panicked, and so does this one when it is joined.
            Err(mpsc::RecvError) => (Ok(Terrain::default()), day.map(DayTexels::description)),
        }
    });
    let [clouds, night_lights] = others;
    let (day, mut damaged) = (day?, Vec::new());
    let clouds = whole(clouds, MapLayer::Clouds, &mut damaged)?;
    let night_lights = whole(night_lights, MapLayer::NightLights, &mut damaged)?;
    let terrain = terrain?;
    let layers = EarthLayers {
        day,
        clouds,
        night_lights,
        normals: terrain.normals,
        water: terrain.water,
    };
    damaged.extend(terrain.damaged);
    Ok((layers, damaged))
}

/// The map, unless its file is corrupt.
fn whole<T>(
    read: Option<Result<T, ImageryError>>,
    layer: MapLayer,
    damaged: &mut Vec<DamagedLayer>,
) -> Result<Option<T>, ImageryError> {
    match read.transpose() {
        Err(error @ ImageryError::Damaged { .. }) => {
            damaged.push(DamagedLayer { layer, error });
            Ok(None)
        }
        read => read,
    }
}

/// The day map's texels before they are made a map.
struct DayTexels {
    width: u32,
    height: u32,
    rgba: Vec<u8>,
}

/// How the colours of a map differ from sRGB, by its header. Reading the file reports what is wrong with it.
pub fn colour_note(path: &Path) -> Option<String> {
    let mut file = files::open(path).ok()?;
    let magic = files::first_bytes(&mut file).ok()?;
    let said = match FileKind::of(&magic)? {
        FileKind::Png => {
            let decoder = png::Decoder::new(std::io::BufReader::new(file));
            Said::of_png(decoder.read_info().ok()?.info())
        }
        FileKind::Jpeg => super::jpeg::said(file).ok()?,
    };
    said.note()
}

/// The file of a folder's day map, if one is there.
pub fn day_file(dir: &Path) -> Option<PathBuf> {
    first_in(dir, &DAY_NAMES)
}

fn read_day(folder: MapFolder<'_>) -> Result<DayTexels, ImageryError> {
    let name = folder.first(&DAY_NAMES).unwrap_or(DAY_NAMES[0]);
    color_texels(&folder.path(name), &folder.read(name, "day")?, "day")
}

/// Loads a colour map (8 bits, sRGB) of the whole Earth, as [`load_layers`] does the day map; `layer` is its name in messages.
///
/// # Errors
/// An invalid map, with its path, the cause and the remedy.
pub fn load_color_map(path: &Path, layer: &'static str) -> Result<LayerImage, ImageryError> {
    let texels = read_color(path, layer)?;
    LayerImage::from_rgba8(texels.width, texels.height, texels.rgba)
}

/// The same of a file by its name in a folder, or in memory.
///
/// # Errors
/// As [`load_color_map`].
pub fn load_color_map_in<'f>(
    folder: impl Into<MapFolder<'f>>,
    name: &str,
    layer: &'static str,
) -> Result<LayerImage, ImageryError> {
    let folder = folder.into();
    let texels = color_texels(&folder.path(name), &folder.read(name, layer)?, layer)?;
    LayerImage::from_rgba8(texels.width, texels.height, texels.rgba)
}

fn read_color(path: &Path, layer: &'static str) -> Result<DayTexels, ImageryError> {
    color_texels(path, &read_file(path, layer)?, layer)
}

fn color_texels(
    path: &Path,
    contents: &[u8],
    layer: &'static str,
) -> Result<DayTexels, ImageryError> {
    let needed = "8-bit colour (sRGB)";
    let file = MapFile::open(path, contents, layer, needed, |texels| texels.bits == 8)?;
    if let Some(note) = file.said.note() {
        tracing::warn!("{} {note}", path.display());
    }
    let ((width, height), channels) = (file.size(), file.texel_kind().channels);
    let texels = file.texels()?;
    let rgba = match channels {
        4 => without_alpha(texels),
        3 => to_rgba(&texels, |rgb: &[u8; 3]| *rgb),
        2 => to_rgba(&texels, |[grey, alpha]: &[u8; 2]| {
            [grey * u8::from(*alpha > 0); 3]
        }),
        _ => to_rgba(&texels, |grey: &[u8; 1]| [grey[0]; 3]),
    };
    Ok(DayTexels {
        width,
        height,
        rgba,
    })
}

impl DayTexels {
    /// The map; where there is water, of land alone and with the depth of the sea, for which what is known of the sea is used up.
    fn image(
        mut self,
        terrain: &mut Terrain,
        season: Option<&Season>,
        sink: &dyn MapSink,
    ) -> Result<LayerImage, ImageryError> {
        let (size, width) = ((self.width, self.height), self.width as usize);
        if let Some(shares) = terrain.shares.take() {
            grow_land(&mut self.rgba, width, &shares);
            if let Some(season) = season {
                let water = water_at(&shares, width, self.height as usize);
                season.paint(&mut self.rgba, width, &water);
            }
            match terrain.floor.take() {
                Some(floor) => floor.write_alpha(&mut self.rgba, width),
                None => self
                    .rgba
                    .chunks_exact_mut(4)
                    .for_each(|texel| texel[3] = 255),
            }
        }
        let mut map = MapBuilder::new(sink, MapLayer::Day, size, TexelFormat::Rgba8Srgb);
        if map.is_in_memory() {
            return LayerImage::from_rgba8(self.width, self.height, self.rgba);
        }
        map.push_all(self.rgba);
        Ok(map.finish().0)
    }

    /// The description that remains if the texels are not needed.
    fn description(self) -> LayerImage {
        LayerImage {
            width: self.width,
            height: self.height,
            format: TexelFormat::Rgba8Srgb,
            levels: [].into(),
        }
    }
}

/// Transparent texels become black.
fn without_alpha(mut rgba: Vec<u8>) -> Vec<u8> {
    let (texels, _) = rgba.as_chunks_mut::<4>();
    for texel in texels {
        let is_there = u8::from(texel[3] > 0);
        *texel = [
            texel[0] * is_there,
            texel[1] * is_there,
            texel[2] * is_there,
            255,
        ];
    }
    rgba
}

fn to_rgba<const N: usize>(texels: &[u8], rgb_of: impl Fn(&[u8; N]) -> [u8; 3]) -> Vec<u8> {
    let (texels, _) = texels.as_chunks::<N>();
    let mut rgba = Vec::with_capacity(texels.len() * 4);
    for texel in texels {
        let [red, green, blue] = rgb_of(texel);
        rgba.extend_from_slice(&[red, green, blue, 255]);
    }
    rgba
}

/// Loads a day map from a separate file instead of that of a folder: with the sea of the folder's water map and elevations, if they are selected.
///
/// # Errors
/// An invalid map, with its path, the cause and the remedy.
pub fn load_day_map(
    path: &Path,
    dir: &Path,
    selection: LayerSelection,
) -> Result<LayerImage, ImageryError> {
    let sea = LayerSelection {
        normals: false,
        ..selection
    };
    let day = read_color(path, "day")?;
    let mut terrain = load_terrain(MapFolder::Disk(dir), sea, None, &KeptInMemory)?;
    match terrain.damaged.pop() {
        Some(damaged) => Err(damaged.error),
        None => day.image(&mut terrain, None, &KeptInMemory),
    }
}

fn load_clouds(folder: MapFolder<'_>, sink: &dyn MapSink) -> Result<LayerImage, ImageryError> {
    let name = folder.first(&CLOUD_NAMES).unwrap_or(CLOUD_NAMES[0]);
    let file = GreyFile::read(folder, name, "clouds")?;
    Ok(file.map((MapLayer::Clouds, sink), None)?.0)
}

fn load_night_lights(
    folder: MapFolder<'_>,
    sink: &dyn MapSink,
) -> Result<LayerImage, ImageryError> {
    let file = night_file(folder)?;
    Ok(file.map((MapLayer::NightLights, sink), None)?.0)
}

/// The file of the map of night lights of a folder.
pub(super) fn night_file(folder: MapFolder<'_>) -> Result<GreyFile<'_>, ImageryError> {
    GreyFile::read(folder, NIGHT_LIGHTS_NAME, "night lights")
}

/// Maps computed from elevations and the water map.
#[derive(Default)]
struct Terrain {
    normals: Option<LayerImage>,
    water: Option<LayerImage>,
    /// The levels of the water map that the day map is made with.
    shares: Option<LayerImage>,
    floor: Option<SeaFloor>,
    damaged: Vec<DamagedLayer>,
}

fn load_terrain(
    folder: MapFolder<'_>,
    selection: LayerSelection,
    season: Option<&Season>,
    sink: &dyn MapSink,
) -> Result<Terrain, ImageryError> {
    // Explicitly requested normals must exist; the sea can be drawn without its floor.
    let is_needed = selection.normals || selection.water && folder.has(ELEVATION_NAME);
    let mut damaged = Vec::new();
    // In the order in which errors are reported; but the largest map is read first.
    let water = selection.water.then(|| load_water(folder, season, sink));
    let elevation = is_needed.then(|| Elevation::read(folder));
    let elevation = whole(elevation, MapLayer::Normals, &mut damaged)?;
    let water = whole(water, MapLayer::Water, &mut damaged)?.flatten();
    let shares = water.as_ref().map(|water| &water.shares);
    let floor = shares.zip(elevation.as_ref());
    let floor = floor.map(|(shares, elevation)| elevation.sea_floor(shares));
    let normals = match elevation.filter(|_| selection.normals) {
        Some(elevation) => Some(elevation.slopes()?.given_to(sink, MapLayer::Normals)),
        None => None,
    };
    let (water, shares) = water.map(|water| (water.map, water.shares)).unzip();
    Ok(Terrain {
        normals,
        water,
        shares,
        floor,
        damaged,
    })
}

/// A water map, and the levels of it that other maps are made with.
struct Water {
    map: LayerImage,
    /// Without ice.
    shares: LayerImage,
}

fn load_water(
    folder: MapFolder<'_>,
    season: Option<&Season>,
    sink: &dyn MapSink,
) -> Result<Option<Water>, ImageryError> {
    // Other maps are made with levels at least as wide as they are themselves.
    let day = folder.first(&DAY_NAMES).into_iter();
    let widths = day.chain([ELEVATION_NAME]);
    let widths = widths.filter_map(|name| folder.width(name));
    let widest = widths.max().unwrap_or(0) as usize;
    let file = match GreyFile::read(folder, WATER_NAME, "water") {
        Err(ImageryError::Missing { path, .. }) => {
            tracing::info!(
                "{} is missing: the sea has the day map's colours",
                path.display()
            );
            return Ok(None);
        }
        file => file?,
    };
    let Some(season) = season else {
        let (map, shares) = file.map((MapLayer::Water, sink), Some(widest))?;
        return Ok(Some(Water { map, shares }));
    };
    let (map, shares) = file.map((MapLayer::Water, &season.open_water_of(sink)), Some(widest))?;
    Ok(Some(Water {
        map: season.open_water(map),
        shares,
    }))
}

/// Heights of the whole Earth, metres + [`ELEVATION_OFFSET_M`].
struct Elevation {
    path: PathBuf,
    width: u32,
    height: u32,
    values: Vec<u16>,
}

impl Elevation {
    fn read(folder: MapFolder<'_>) -> Result<Self, ImageryError> {
        let path = folder.path(ELEVATION_NAME);
        let contents = folder.read(ELEVATION_NAME, "elevation")?;
        let needed = "16-bit grey (metres + 11000)";
        let file = MapFile::open(&path, &contents, "elevation", needed, |texels| {
            texels == TexelKind::grey(16)
        })?;
        let (width, height) = file.size();
        let mut values = Vec::with_capacity(width as usize * height as usize);
        file.rows(|row| {
            let (pairs, _) = row.as_chunks::<2>();
            values.extend(pairs.iter().map(|pair| u16::from_be_bytes(*pair)));
        })?;
        Ok(Self {
            path,
            width,
            height,
            values,
        })
    }

    fn slopes(&self) -> Result<LayerImage, ImageryError> {
        let slopes =
            slopes_from_elevation(self.width, self.height, &self.values, SLOPE_EXAGGERATION)?;
        tracing::debug!(
            path = %self.path.display(),
            saturated_texels = slopes.saturated_texels,
            "slopes made, stored {SLOPE_EXAGGERATION} times too steep"
        );
        Ok(slopes.image)
    }

    fn sea_floor(&self, water: &LayerImage) -> SeaFloor {
        let (width, height) = (self.width as usize, self.height as usize);
        SeaFloor::new(width, height, &self.values, ELEVATION_OFFSET_M, water)
    }
}
