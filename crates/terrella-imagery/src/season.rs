//! Snow and sea ice of a time of year, painted into the maps of the ground.

mod paint;

use super::error::ImageryError;
use super::grey::GreyFile;
use super::layer::LayerImage;
use super::map_folder::MapFolder;
use super::map_rows::{MapRows, MapSink};
use super::texel::TexelFormat;
use super::tile::MapLayer;
use paint::{ICE, paint_texel, smooth};
use std::ops::Range;

/// The file of a folder with the snow and ice of each month.
pub const SEASONS_FILE: &str = "seasons.png";

const MONTHS: usize = 12;
/// Maps in a row of the file, and rows of them: it is twice as wide as high, as each of them is.
const ACROSS: usize = 5;

/// Ice between these means of many years is drawn as none to all: in one year it has an edge. Areas change by 3 % at most.
const ICE_EDGE: [f32; 2] = [0.25, 0.75];
/// Snow on land and ice on the sea at one time of year.
#[derive(Clone, Debug, PartialEq)]
pub struct Season {
    snow: Cover,
    ice: Cover,
}

/// Covered fraction, on an equirectangular map, north row first, from 180° W.
#[derive(Clone, Debug, PartialEq)]
struct Cover {
    width: usize,
    values: Vec<f32>,
}

impl Season {
    /// Reads `seasons.png` of a folder, 8-bit grey: five by five maps of the whole Earth, row by row. The first twelve are the cover of land with
    /// snow, 0…1, in the middles of the months from January on, the next twelve that of the sea with ice. Months pass into each other.
    /// `year_fraction` is the time since the start of the year, as a fraction of it.
    ///
    /// # Errors
    /// An invalid map, with its path, the cause and the remedy. `None` if there is no file.
    pub fn load<'f>(
        folder: impl Into<MapFolder<'f>>,
        year_fraction: f64,
    ) -> Result<Option<Self>, ImageryError> {
        let folder = folder.into();
        if !folder.has(SEASONS_FILE) {
            return Ok(None);
        }
        let maps = GreyFile::read(folder, SEASONS_FILE, "seasons")?.level_0()?;
        let (width, height) = (maps.width, maps.height);
        if [width, height]
            .iter()
            .any(|side| !side.is_multiple_of(ACROSS as u32))
        {
            return Err(ImageryError::Seasons {
                path: folder.path(SEASONS_FILE),
                width,
                height,
            });
        }
        Ok(Some(Self {
            snow: Cover::between(&maps, 0, year_fraction),
            ice: Cover::between(&maps, MONTHS, year_fraction).between_edges(ICE_EDGE),
        }))
    }

    /// A sink that gives this one maps of open water without ice. Maps that are kept in memory still have it.
    pub(super) fn open_water_of<'a>(&'a self, sink: &'a dyn MapSink) -> OpenWater<'a> {
        OpenWater { season: self, sink }
    }

    /// A map of open water without ice, where it is in memory.
    pub(super) fn open_water(&self, map: LayerImage) -> LayerImage {
        let mut levels = map.levels.to_vec();
        for (level, texels) in levels.iter_mut().enumerate() {
            self.thaw_rows(map.level_size(level), 0, texels);
        }
        LayerImage {
            levels: levels.into(),
            ..map
        }
    }

    /// Takes the ice from rows of a map of water of this size. Ice varies over many texels, so smaller levels are right too.
    fn thaw_rows(&self, (width, height): (u32, u32), first: u32, water: &mut [u8]) {
        let size = (width as usize, height as usize);
        for (row, water) in water.chunks_exact_mut(size.0).enumerate() {
            let row = first as usize + row;
            if self.ice.is_bare(row, size) {
                continue;
            }
            for run in self.ice.runs(row, size) {
                let water = &mut water[run.columns.clone()];
                match (run.first, run.last) {
                    (0.0, 0.0) => {}
                    (1.0, 1.0) => water.fill(0),
                    _ => {
                        for (water, ice) in water.iter_mut().zip(run.values()) {
                            *water = (f32::from(*water) * (1.0 - ice) + 0.5) as u8;
                        }
                    }
                }
            }
        }
    }

    /// Paints snow and ice into the colours of a map, RGBA texels `width` to a row. `water` has its size, and says how much of each is water.
    pub(super) fn paint(&self, rgba: &mut [u8], width: usize, water: &[u8]) {
        let size = (width, water.len() / width.max(1));
        let rows = rgba
            .chunks_exact_mut(4 * width)
            .zip(water.chunks_exact(width));
        for (row, (texels, water)) in rows.enumerate() {
            if self.snow.is_bare(row, size) && self.ice.is_bare(row, size) {
                continue;
            }
            let (texels, _) = texels.as_chunks_mut::<4>();
            for (snow, ice) in self.snow.runs(row, size).zip(self.ice.runs(row, size)) {
                if [&snow, &ice].map(|run| run.first + run.last) == [0.0; 2] {
                    continue;
                }
                let texels = texels[snow.columns.clone()].iter_mut();
                let texels = texels.zip(&water[snow.columns.clone()]);
                let covers = snow.values().zip(ice.values());
                for ((texel, water), (snow, ice)) in texels.zip(covers) {
                    match *water {
                        // Most of the sea.
                        u8::MAX if ice == 0.0 => {}
                        u8::MAX => texel[..3].copy_from_slice(&ICE.map(|code| code as u8)),
                        water => paint_texel(texel, f32::from(water) / 255.0, snow, ice),
                    }
                }
            }
        }
    }
}

/// Gives a sink maps of water without the season's ice.
pub(super) struct OpenWater<'a> {
    season: &'a Season,
    sink: &'a dyn MapSink,
}

impl MapSink for OpenWater<'_> {
    fn begin(
        &self,
        layer: MapLayer,
        size: (u32, u32),
        format: TexelFormat,
    ) -> Option<Box<dyn MapRows + '_>> {
        let rows = self.sink.begin(layer, size, format)?;
        let (width, height) = size;
        Some(Box::new(OpenRows {
            season: self.season,
            map: LayerImage {
                width,
                height,
                format,
                levels: [].into(),
            },
            rows,
        }))
    }
}

struct OpenRows<'a> {
    season: &'a Season,
    /// Size and format.
    map: LayerImage,
    rows: Box<dyn MapRows + 'a>,
}

impl MapRows for OpenRows<'_> {
    fn rows(&mut self, level: usize, first: u32, texels: &[u8]) {
        let mut open = texels.to_vec();
        self.season
            .thaw_rows(self.map.level_size(level), first, &mut open);
        self.rows.rows(level, first, &open);
    }

    fn finish(self: Box<Self>) {
        self.rows.finish();
    }
}

/// Columns between the middles of two neighbouring texels of a cover, and the values there.
struct Run {
    columns: Range<usize>,
    first: f32,
    last: f32,
    /// Position of the first column between the middles, 0…1, and the distance of columns.
    at: f32,
    step: f32,
}

impl Run {
    fn values(&self) -> impl Iterator<Item = f32> {
        let (first, rise) = (self.first, self.last - self.first);
        let (at, step) = (self.at, self.step);
        (0..self.columns.len()).map(move |column| first + rise * (at + column as f32 * step))
    }
}

impl Cover {
    /// At a fraction of a year, between maps of the middles of months, the first of which has this number.
    fn between(maps: &LayerImage, first: usize, year_fraction: f64) -> Self {
        let all = maps.width as usize;
        let (width, rows) = (all / ACROSS, maps.height as usize / ACROSS);
        let at = year_fraction.rem_euclid(1.0) * MONTHS as f64 - 0.5;
        let part = (at - at.floor()) as f32;
        let [before, after] = [0, 1].map(|more| {
            let map = first + (at.floor() as i64 + more).rem_euclid(MONTHS as i64) as usize;
            let corner = map / ACROSS * rows * all + map % ACROSS * width;
            (0..rows).flat_map(move |row| corner + row * all..corner + row * all + width)
        });
        let texels = &maps.levels[0];
        let values = before.zip(after).map(|(before, after)| {
            let [before, after] = [before, after].map(|at| f32::from(texels[at]) / 255.0);
            before + part * (after - before)
        });
        Self {
            width,
            values: values.collect(),
        }
    }

    /// The same cover with all of the rise from none to whole between two values.
    fn between_edges(mut self, edges: [f32; 2]) -> Self {
        for value in &mut self.values {
            *value = smooth(edges, *value);
        }
        self
    }

    /// The two rows that a row of a map of this height lies between, and its place between them, 0…1.
    fn rows_about(&self, row: usize, height: usize) -> ([&[f32]; 2], f32) {
        let rows = self.values.len() / self.width;
        let at = (row as f32 + 0.5) * rows as f32 / height as f32 - 0.5;
        let about = [0.0, 1.0].map(|more| {
            let row = (at.floor() + more).clamp(0.0, rows as f32 - 1.0) as usize;
            &self.values[row * self.width..][..self.width]
        });
        (about, at - at.floor())
    }

    /// Whether nothing is covered along a row of a map of this size.
    fn is_bare(&self, row: usize, (_, height): (usize, usize)) -> bool {
        let (about, _) = self.rows_about(row, height);
        about
            .iter()
            .all(|row| row.iter().all(|value| *value == 0.0))
    }

    /// Values along a row of a map of this size.
    fn runs(&self, row: usize, (width, height): (usize, usize)) -> impl Iterator<Item = Run> {
        let ([upper, lower], part) = self.rows_about(row, height);
        let value = move |texel: usize| {
            let [upper, lower] = [upper, lower].map(|row| row[texel % self.width]);
            upper + part * (lower - upper)
        };
        let step = self.width as f32 / width as f32;
        // The first column whose middle is at least so many texels from the western edge.
        let column = move |texels: f32| {
            let exact = (texels / step - 0.5).max(0.0);
            // Rounded up without a call.
            let whole = exact as usize;
            (whole + usize::from((whole as f32) < exact)).min(width)
        };
        (0..=self.width).map(move |texel| {
            let middle = texel as f32 - 0.5;
            let columns = column(middle)..column(middle + 1.0);
            Run {
                at: (columns.start as f32 + 0.5) * step - middle,
                step,
                columns,
                first: value(texel + self.width - 1),
                last: value(texel),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ImageryError, KeptInMemory, LayerSelection, load_layers, load_seasonal_layers};
    use std::path::Path;
    use tempfile::TempDir;

    /// Side of a month's map.
    const SIDE: (u32, u32) = (32, 16);
    const SELECTED: LayerSelection = LayerSelection {
        clouds: false,
        normals: false,
        night_lights: false,
        water: true,
    };
    /// The middles of months.
    const JANUARY: f64 = 0.5 / 12.0;
    const JULY: f64 = 6.5 / 12.0;

    /// Land in the east and sea in the west; snow in the north in January and December, ice in the south in January, both whole.
    fn folder() -> TempDir {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        write(&path("day.png"), (256, 128), |_, _| vec![120, 110, 90]);
        write(&path("water.png"), (256, 128), |x, _| {
            vec![if x < 128 { 255 } else { 0 }]
        });
        write(&path(SEASONS_FILE), (5 * SIDE.0, 5 * SIDE.1), |x, y| {
            let number = y / SIDE.1 * 5 + x / SIDE.0;
            let is_north = y % SIDE.1 < SIDE.1 / 2;
            vec![match (number, is_north) {
                (0 | 11, true) | (12, false) => 255,
                _ => 0,
            }]
        });
        folder
    }

    /// Writes a PNG file of grey or colours.
    fn write(path: &Path, (width, height): (u32, u32), texel: impl Fn(u32, u32) -> Vec<u8>) {
        let file = std::fs::File::create(path).expect("a file");
        let mut encoder = png::Encoder::new(file, width, height);
        encoder.set_color(match texel(0, 0).len() {
            1 => png::ColorType::Grayscale,
            _ => png::ColorType::Rgb,
        });
        let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let texels: Vec<_> = texels.flat_map(|(x, y)| texel(x, y)).collect();
        let mut writer = encoder.write_header().expect("a header");
        writer.write_image_data(&texels).expect("writes");
    }

    /// The colour and the water of the maps at a time of year, at a texel.
    fn at(folder: &Path, years: f64) -> impl Fn(usize, usize) -> ([u8; 3], u8) {
        let season = Season::load(folder, years).expect("valid").expect("there");
        let loaded = load_seasonal_layers(folder, SELECTED, Some(&season), &KeptInMemory);
        let (layers, damaged) = loaded.expect("valid maps");
        assert!(damaged.is_empty());
        let (day, water) = (layers.day, layers.water.expect("selected"));
        move |x, y| {
            let at = y * 256 + x;
            let color = &day.levels[0][4 * at..];
            ([color[0], color[1], color[2]], water.levels[0][at])
        }
    }

    #[test]
    fn snow_and_ice_are_those_of_the_month() {
        let folder = folder();
        let january = at(folder.path(), JANUARY);
        let (snow, water) = january(200, 20);
        assert!(
            snow.iter().all(|code| *code > 230) && water == 0,
            "{snow:?}"
        );
        let (ice, water) = january(50, 100);
        assert!(
            ice[2] > 230 && ice[0] < ice[2] && water == 0,
            "{ice:?} {water}"
        );
        // The sea beside snow is open, and the land beside ice has none.
        assert_eq!(january(50, 20).1, 255);
        assert_eq!(january(200, 100), ([120, 110, 90], 0));
        // All mip levels are those of the changed maps.
        let summer = at(folder.path(), JULY);
        let plain = load_layers(folder.path(), SELECTED).expect("valid maps");
        for (x, y) in [(200, 20), (50, 100), (50, 20), (200, 100)] {
            let texel = 4 * (y * 256 + x);
            assert_eq!(summer(x, y).0, plain.day.levels[0][texel..texel + 3]);
        }
    }

    #[test]
    fn months_pass_into_each_other_round_the_year() {
        let folder = folder();
        let cover = |years: f64| {
            let season = Season::load(folder.path(), years);
            let season = season.expect("valid").expect("there");
            season.snow.values[3 * SIDE.0 as usize]
        };
        assert_eq!([cover(JANUARY), cover(JULY), cover(0.0)], [1.0, 0.0, 1.0]);
        assert!((cover(1.0 / 12.0) - 0.5).abs() < 1e-6);
        assert!((cover(0.95 + 7.0) - cover(0.95)).abs() < 1e-4);
    }

    #[test]
    fn a_map_in_a_sink_is_the_same() {
        let folder = folder();
        let season = Season::load(folder.path(), 0.0).expect("valid");
        let loaded = |sink: &dyn MapSink| {
            let loaded = load_seasonal_layers(folder.path(), SELECTED, season.as_ref(), sink);
            loaded.expect("valid maps").0
        };
        let kept = loaded(&KeptInMemory);
        let elsewhere = WaterElsewhere::default();
        assert!(kept.day == loaded(&elsewhere).day);
        let water = kept.water.expect("selected");
        let levels = elsewhere.0.into_inner().expect("no panic");
        assert_eq!(water.levels.to_vec(), levels);
    }

    /// Takes the levels of the water map alone.
    #[derive(Default)]
    struct WaterElsewhere(std::sync::Mutex<Vec<Vec<u8>>>);

    impl MapSink for WaterElsewhere {
        fn begin(
            &self,
            layer: MapLayer,
            _: (u32, u32),
            _: TexelFormat,
        ) -> Option<Box<dyn MapRows + '_>> {
            (layer == MapLayer::Water).then(|| Box::new(Levels(self)) as Box<dyn MapRows>)
        }
    }

    struct Levels<'a>(&'a WaterElsewhere);

    impl MapRows for Levels<'_> {
        fn rows(&mut self, level: usize, _: u32, texels: &[u8]) {
            let mut levels = self.0.0.lock().expect("no panic");
            let count = levels.len().max(level + 1);
            levels.resize(count, Vec::new());
            levels[level].extend_from_slice(texels);
        }

        fn finish(self: Box<Self>) {}
    }

    #[test]
    fn a_folder_without_seasons_has_none_and_a_damaged_file_is_named() {
        let folder = folder();
        let path = folder.path().join(SEASONS_FILE);
        let bytes = std::fs::read(&path).expect("there");
        std::fs::write(&path, &bytes[..bytes.len() / 2]).expect("writes");
        let error = Season::load(folder.path(), 0.0).expect_err("truncated");
        assert!(matches!(error, ImageryError::Damaged { .. }), "{error}");
        assert!(error.to_string().contains(SEASONS_FILE), "{error}");
        write(&path, (80, 80), |_, _| vec![0]);
        assert!(matches!(
            Season::load(folder.path(), 0.0),
            Err(ImageryError::Size { .. })
        ));
        for size in [(4, 2), (64, 32)] {
            write(&path, size, |_, _| vec![0]);
            let error = Season::load(folder.path(), 0.0).expect_err("no 5 x 5 maps");
            assert!(matches!(error, ImageryError::Seasons { .. }), "{error}");
        }
        write(&path, (10, 5), |_, _| vec![255]);
        assert_eq!(at(folder.path(), 0.0)(50, 100).1, 0);
        std::fs::remove_file(&path).expect("there");
        assert_eq!(Season::load(folder.path(), 0.0).expect("valid"), None);
    }

    /// Cover of the shipped maps at a place, degrees.
    fn shipped(season: &Season, latitude: f32, longitude: f32) -> [f32; 2] {
        [&season.snow, &season.ice].map(|cover| {
            let rows = cover.values.len() / cover.width;
            let row = ((90.0 - latitude) / 180.0 * rows as f32) as usize;
            let column = ((longitude + 180.0) / 360.0 * cover.width as f32) as usize;
            cover.values[row * cover.width + column]
        })
    }

    #[test]
    fn shipped_maps_freeze_what_freezes() {
        let textures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../textures");
        let load = |month: f64| {
            let season = Season::load(textures.as_path(), (month - 0.5) / 12.0);
            season.expect("sound maps").expect("shipped")
        };
        let (january, march, august) = (load(1.0), load(3.0), load(8.0));
        let ice = |season: &Season, latitude, longitude| shipped(season, latitude, longitude)[1];
        // The north of the Gulf of Bothnia, Hudson Bay, Lake Superior, the Kara Sea and the strait north of Baffin Island.
        for (latitude, longitude) in [
            (65.0, 23.5),
            (60.0, -85.0),
            (47.5, -87.5),
            (73.0, 75.0),
            (74.0, -85.0),
        ] {
            let found = ice(&march, latitude, longitude);
            assert!(found > 0.6, "{latitude} {longitude}: {found}");
        }
        // Off Norway and the Kola Peninsula, the Black Sea, the south of the Baltic, the Sea of Japan and the Gulf of Alaska.
        for (latitude, longitude) in [
            (68.0, 12.0),
            (62.0, 4.0),
            (70.0, 35.0),
            (43.0, 34.0),
            (55.5, 17.0),
            (39.0, 134.0),
            (57.0, -145.0),
        ] {
            let found = ice(&march, latitude, longitude);
            assert!(found < 0.1, "{latitude} {longitude}: {found}");
        }
        for (latitude, longitude) in [(65.0, 23.5), (60.0, -85.0), (47.5, -87.5)] {
            assert_eq!(ice(&august, latitude, longitude), 0.0);
        }
        let snow = |season: &Season, latitude, longitude| shipped(season, latitude, longitude)[0];
        // Ukraine, Minnesota and the Ob; Spain and Texas.
        for (latitude, longitude) in [(51.0, 33.0), (46.0, -95.0), (62.0, 72.0)] {
            assert!(
                snow(&january, latitude, longitude) > 0.7,
                "{latitude} {longitude}"
            );
            assert_eq!(snow(&august, latitude, longitude), 0.0);
        }
        for (latitude, longitude) in [(39.0, -5.0), (31.0, -98.0)] {
            assert!(
                snow(&january, latitude, longitude) < 0.1,
                "{latitude} {longitude}"
            );
        }
        // Winters become colder towards the east of Europe by and by.
        let along: Vec<f32> = (10..40)
            .map(|east| snow(&january, 52.5, east as f32 + 0.5))
            .collect();
        for pair in along.windows(2) {
            assert!((pair[1] - pair[0]).abs() < 0.15, "{along:?}");
        }
    }
}
