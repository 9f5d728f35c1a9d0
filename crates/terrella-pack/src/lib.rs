//! Building packs from maps of any size in bounded memory.
//!
//! | file | content |
//! |---|---|
//! | `source/` | PNG, JPEG and TIFF read a row at a time |
//! | `mosaic/` | several maps as one |
//! | `input.rs` | a map of either kind |
//! | `values.rs` | texels as linear light, cover or slopes |
//! | `resample.rs` | rows at another size |
//! | `bands.rs` | rows gathered into rows of blocks with borders |
//! | `cut.rs`, `codes.rs` | tiles with mip levels; values as bytes |
//! | `bc.rs` | block compression of tiles |
//! | `ladder.rs` | the levels of a map |
//! | `plan.rs`, `memory.rs` | passes, and their memory budget |
//! | `heights/` | elevation data |
//! | `folder.rs`, `journal.rs`, `locked_journal.rs` | complete files, and continuing after an interruption |
//! | `shares.rs` | a build that several processes share |
//! | `run.rs` | one map, from its file to its tiles |
//!
//! A source is read once for all levels. If the bands of all levels do not fit into the allowed memory, it is read several times, for some columns
//! of blocks each. The output does not depend on that, nor on the number of threads.

// docs.rs shows the required feature of each item.
#![cfg_attr(docsrs, feature(doc_cfg))]

mod bands;
mod bc;
mod codes;
mod cut;
mod error;
#[cfg(feature = "fetch")]
pub mod fetch;
mod fingerprint;
mod folder;
mod heights;
mod input;
mod journal;
mod ladder;
mod locked_journal;
mod memory;
pub mod mosaic;
mod plan;
mod preview;
mod resample;
mod run;
mod shares;
pub mod source;
#[cfg(test)]
mod tests;
mod tile_name;
mod values;

pub use error::BuildError;
pub use preview::preview;
pub use shares::{BuildShare, SharesPlan, begin_shares, build_share};
pub use terrella_ground::elevation::geoid::VerticalDatum;
pub use terrella_imagery::SLOPE_EXAGGERATION;

use folder::{BuildFolder, Disk, Writer};
use heights::BuiltHeights;
use input::MapInput;
use plan::{Means, Plan};
use run::Job;
use source::{Opacity, SourceInfo, SourceLimits};
use std::ops::Range;
use std::path::{Path, PathBuf};
use terrella_ground::globe::{Block, COLUMNS};
use terrella_imagery::pack::{LayerEntry, LevelEntry, Manifest, TileFile};
use terrella_imagery::tile::{MAX_PART_PIXELS, MapLayer, Storage, TileShape};
use tile_name::TileName;
use values::{Meaning, ValueRows};

/// Memory that a build takes by default, bytes.
pub const DEFAULT_MEMORY_BYTES: u64 = 512_000_000;

/// Source of terrain slopes.
#[derive(Clone, Debug, PartialEq)]
pub enum Relief {
    /// A tangent-space normal map: red east, green north, blue up. A slope up to the east has red below its middle
    /// (128 of 255), one up to the north green below its middle.
    Normals(PathBuf),
    /// Elevations in metres.
    Elevation {
        /// 16-bit PNG, or TIFF of 16-bit or float samples.
        path: PathBuf,
        /// Offset that is subtracted from the samples, metres. By default 11 000 for PNG, which cannot store negative values, and 0 for TIFF.
        offset_m: Option<f64>,
        /// How many times steeper than the truth slopes are stored.
        exaggeration: f64,
    },
}

/// Inputs, outputs and settings of a build. Maps are files of the whole Earth or mosaics: see [`mosaic`].
#[derive(Clone, Debug, PartialEq)]
pub struct BuildOptions {
    /// Surface colour, sRGB.
    pub day: PathBuf,
    /// Cloud cover: grey, or the luminance of colour.
    pub clouds: Option<PathBuf>,
    /// Terrain slopes.
    pub relief: Option<Relief>,
    /// City lights: grey, or the luminance of colour.
    pub night_lights: Option<PathBuf>,
    /// Open water: white where there is some.
    pub water: Option<PathBuf>,
    /// Elevation files of a part of the Earth or all of it, finer ones layered over coarser ones: see
    /// [`elevation::read`](terrella_ground::elevation::read).
    pub heights: Vec<PathBuf>,
    /// Vertical datum of `heights` in files that do not name one, nor their sidecars; `None` is the sea.
    pub heights_above: Option<VerticalDatum>,
    /// The pack's folder: new, empty, or of the same build stopped before.
    pub out: PathBuf,
    /// Name of the pack; by default that of its folder.
    pub name: Option<String>,
    /// Whose data it is, a line each.
    pub attribution: Vec<String>,
    /// How tiles are kept, each kind once.
    pub storages: Vec<Storage>,
    /// Levels of a map, texels per block, the finest first; by default the paper's up to the first that holds all
    /// detail of the map, and finer ones that are cut into parts where the map has more. Levels of more than
    /// [`MAX_PART_PIXELS`] are cut: they are the finest other level times 2, 4, 8 or 16.
    pub pixels: Vec<(MapLayer, Vec<u32>)>,
    /// Most memory of the process, bytes.
    pub memory_bytes: u64,
    /// Encoder threads; by default one a processor.
    pub threads: Option<usize>,
    /// Throw away what the folder holds of another build or a finished pack.
    pub restart: bool,
}

impl BuildOptions {
    /// Of a day map alone, everything else as it is by default.
    pub fn new(day: impl Into<PathBuf>, out: impl Into<PathBuf>) -> Self {
        Self {
            day: day.into(),
            clouds: None,
            relief: None,
            night_lights: None,
            water: None,
            heights: Vec::new(),
            heights_above: None,
            out: out.into(),
            name: None,
            attribution: Vec::new(),
            storages: Storage::ALL.to_vec(),
            pixels: Vec::new(),
            memory_bytes: DEFAULT_MEMORY_BYTES,
            threads: None,
            restart: false,
        }
    }

    /// The maps with their files, in the order of the manifest.
    fn maps(&self) -> Vec<(MapLayer, &Path, Meaning)> {
        let relief = self.relief.as_ref().map(|relief| match relief {
            Relief::Normals(path) => (path, Meaning::Normals),
            Relief::Elevation {
                path,
                offset_m,
                exaggeration,
            } => (
                path,
                Meaning::Elevation {
                    offset_m: *offset_m,
                    exaggeration: *exaggeration,
                },
            ),
        });
        let amount = |path| Some((path, Meaning::Amount));
        let all = [
            (MapLayer::Day, Some((&self.day, Meaning::Colour))),
            (MapLayer::Clouds, self.clouds.as_ref().and_then(amount)),
            (MapLayer::Normals, relief),
            (
                MapLayer::NightLights,
                self.night_lights.as_ref().and_then(amount),
            ),
            (MapLayer::Water, self.water.as_ref().and_then(amount)),
        ];
        all.into_iter()
            .filter_map(|(layer, map)| map.map(|(path, meaning)| (layer, path.as_path(), meaning)))
            .collect()
    }

    /// Rejects what can be recognised as wrong without reading the maps.
    fn check(&self) -> Result<(), BuildError> {
        let reject = |option, cause: &str| {
            Err(BuildError::Option {
                option,
                cause: cause.to_string(),
            })
        };
        if self.storages.is_empty()
            || (1..self.storages.len()).any(|n| self.storages[..n].contains(&self.storages[n]))
        {
            return reject("--storage", "give plain, bc or both, each once");
        }
        if let Some(Relief::Elevation {
            offset_m,
            exaggeration,
            ..
        }) = &self.relief
        {
            if !(0.01..=1000.0).contains(exaggeration) {
                return reject("--exaggeration", "must be from 0.01 to 1000");
            }
            if !offset_m.is_none_or(|offset_m| offset_m.abs() <= 100_000.0) {
                return reject(
                    "--elevation-offset",
                    "must be from -100000 to 100000 metres",
                );
            }
        }
        if let Some((layer, _)) = self.pixels.iter().find(|(layer, _)| {
            self.maps().iter().all(|(present, ..)| present != layer)
                || self
                    .pixels
                    .iter()
                    .filter(|(other, _)| other == layer)
                    .count()
                    > 1
        }) {
            return reject(
                "--pixels",
                &format!("{} is not among the maps, or given twice", layer.name()),
            );
        }
        Ok(())
    }

    fn asked_pixels(&self, layer: MapLayer) -> Option<&[u32]> {
        let asked = self.pixels.iter().find(|(of, _)| *of == layer);
        asked.map(|(_, pixels)| pixels.as_slice())
    }

    /// The requested name, else the folder's.
    fn pack_name(&self) -> String {
        let folder = || {
            self.out
                .file_name()
                .map(|name| name.to_string_lossy().into_owned())
        };
        self.name
            .clone()
            .or_else(folder)
            .unwrap_or_else(|| "pack".to_string())
    }
}

/// Receives the progress of a build, and decides whether to continue. The command shows progress bars; `()` shows nothing and never stops.
pub trait BuildProgress: Sync {
    /// A pass over a map begins, of so many rows.
    fn begin(&self, what: &str, steps: Option<u64>);
    /// A row is done.
    fn step(&self);
    /// The pass is over.
    fn end(&self);
    /// Something worth knowing that is no error.
    fn note(&self, _text: &str) {}
    /// True once the work is no longer wanted: it stops at the next row, and the same build can go on later.
    fn cancelled(&self) -> bool {
        false
    }
}

impl BuildProgress for () {
    fn begin(&self, _what: &str, _steps: Option<u64>) {}
    fn step(&self) {}
    fn end(&self) {}
}

/// A map that has been looked at: all that decides what is built from it.
struct Map<'a> {
    layer: MapLayer,
    path: &'a Path,
    input: MapInput,
    meaning: Meaning,
    info: SourceInfo,
    levels: Vec<TileShape>,
    plan: Plan,
}

/// Builds a pack, or continues an interrupted build. The folder has a manifest only when the build is complete.
///
/// # Errors
/// [`BuildError`] with the error and the remedy. Finished tiles stay for the next run.
pub fn build(options: &BuildOptions, progress: &dyn BuildProgress) -> Result<Manifest, BuildError> {
    build_with(options, progress, &Disk, Division::default())
}

/// How work and maps are divided; differs from the default in tests.
#[derive(Clone, Copy, Debug)]
struct Division {
    /// Columns of blocks a pass; by default what the memory allows.
    columns: Option<u32>,
    /// Most texels of a tile's side before a level is cut into parts.
    most_pixels: u32,
}

impl Default for Division {
    fn default() -> Self {
        Self {
            columns: None,
            most_pixels: MAX_PART_PIXELS,
        }
    }
}

/// The build with other means of writing.
fn build_with(
    options: &BuildOptions,
    progress: &dyn BuildProgress,
    writer: &dyn Writer,
    division: Division,
) -> Result<Manifest, BuildError> {
    let prepared = Prepared::of(options, progress, division)?;
    let folder = BuildFolder::open(&options.out, &prepared.fingerprint, options.restart, writer)?;
    // First, and freed before the maps need the memory.
    let heights = match options.heights.as_slice() {
        [] => None,
        paths => {
            let above = options.heights_above;
            Some(heights::build(
                paths,
                above,
                prepared.means,
                &folder,
                progress,
            )?)
        }
    };
    prepared.check(options, heights.as_ref())?;
    for map in &prepared.maps {
        let job = prepared.job(map, 0..COLUMNS, &options.storages, &folder, progress);
        let saturated_texels = run(&job)?;
        if saturated_texels > 0 {
            progress.note(&format!(
                "{saturated_texels} of {} slopes are steeper than can be stored and drawn less steep; a smaller \
                 --exaggeration keeps them",
                u64::from(map.info.width) * u64::from(map.info.height)
            ));
        }
    }
    let heights = heights.as_ref();
    let done = manifest(options, &prepared.maps, heights, |name| folder.tile(name));
    folder.finish(&done)?;
    Ok(done)
}

/// Makes the tiles of a map that lack. Gives the number of slopes beyond what can be stored.
fn run(job: &Job<'_>) -> Result<u64, BuildError> {
    match job.meaning.channels() {
        3 => job.run::<3>(),
        2 => job.run::<2>(),
        _ => job.run::<1>(),
    }
}

/// A build whose maps have been looked at.
struct Prepared<'a> {
    maps: Vec<Map<'a>>,
    means: Means,
    limits: SourceLimits,
    fingerprint: String,
}

impl<'a> Prepared<'a> {
    /// Looks at the maps, and divides the work.
    fn of(
        options: &'a BuildOptions,
        progress: &dyn BuildProgress,
        division: Division,
    ) -> Result<Self, BuildError> {
        options.check()?;
        let processors = || std::thread::available_parallelism().map_or(1, usize::from);
        let means = Means {
            memory_bytes: options.memory_bytes,
            threads: options.threads.unwrap_or_else(processors).clamp(1, 64),
        };
        let limits = SourceLimits {
            buffer_bytes: means.source_bytes(),
        };
        let mut maps = Vec::new();
        for (layer, path, meaning) in options.maps() {
            let what = (layer, path, meaning);
            let mut map = look(options, what, means, limits, division.most_pixels, progress)?;
            map.plan.columns = division.columns.unwrap_or(map.plan.columns);
            maps.push(map);
        }
        let fingerprint = fingerprint::of(options, &maps)?;
        let prepared = Self {
            maps,
            means,
            limits,
            fingerprint,
        };
        prepared.check(options, None)?;
        Ok(prepared)
    }

    /// Rejects texts that no manifest may have.
    fn check(
        &self,
        options: &BuildOptions,
        heights: Option<&BuiltHeights>,
    ) -> Result<(), BuildError> {
        let draft = manifest(options, &self.maps, heights, |_| {
            Some(TileFile::of(b"draft"))
        });
        let read = Manifest::from_toml(&draft.to_toml(), Path::new("manifest"));
        read.map(drop).map_err(|error| BuildError::Option {
            option: "--name, --attribution",
            cause: error.to_string(),
        })
    }

    /// The work on some columns of a map.
    fn job<'j>(
        &'j self,
        map: &'j Map<'_>,
        columns: Range<u32>,
        storages: &'j [Storage],
        folder: &'j BuildFolder<'j>,
        progress: &'j dyn BuildProgress,
    ) -> Job<'j> {
        Job {
            layer: map.layer,
            path: map.path,
            input: &map.input,
            meaning: map.meaning,
            info: map.info,
            limits: self.limits,
            levels: &map.levels,
            storages,
            plan: map.plan,
            columns,
            folder,
            progress,
        }
    }
}

/// Opens a map, and decides its levels and how its work is divided.
fn look<'a>(
    options: &BuildOptions,
    (layer, path, meaning): (MapLayer, &'a Path, Meaning),
    means: Means,
    limits: SourceLimits,
    most_pixels: u32,
    progress: &dyn BuildProgress,
) -> Result<Map<'a>, BuildError> {
    let input = MapInput::open(path, meaning, limits)?;
    for note in input.notes() {
        progress.note(note);
    }
    let source = input.rows(limits)?;
    let info = source.info();
    input.check_place(&info)?;
    if meaning == Meaning::Colour {
        for note in input.colour_notes(&*source) {
            progress.note(&note);
        }
    }
    // Rejects texels of the wrong kind.
    drop(ValueRows::new(source, meaning, path)?);
    if matches!(meaning, Meaning::Elevation { .. }) {
        input.check_metres(path)?;
    }
    if meaning == Meaning::Amount && info.channels >= 3 {
        progress.note(&format!(
            "{}: is in colour; its luminance is taken for the {} map",
            path.display(),
            layer.name()
        ));
    }
    if meaning == Meaning::Amount && info.opacity == Some(Opacity::Alpha) {
        progress.note(&format!(
            "{}: has alpha; what it shows times its alpha is taken for the {} map",
            path.display(),
            layer.name()
        ));
    }
    let asked = options.asked_pixels(layer);
    let ladder = ladder::ladder(layer, info.width, asked, most_pixels)?;
    if !ladder.left_out.is_empty() {
        let finest = ladder
            .levels
            .first()
            .map_or(0, |shape| shape.block_pixels());
        let left_out: Vec<_> = ladder.left_out.iter().map(u32::to_string).collect();
        progress.note(&format!(
            "{}: {finest} pixels per block hold all its detail; the {} levels {} are left out (--pixels forces them)",
            path.display(),
            layer.name(),
            left_out.join(", ")
        ));
    }
    if let Some(dropped) = &ladder.dropped {
        progress.note(&format!("{}: {dropped}", path.display()));
    }
    let levels = ladder.levels;
    let plan = match meaning.channels() {
        3 => plan::plan::<3>(layer, &info, &levels, &options.storages, means),
        2 => plan::plan::<2>(layer, &info, &levels, &options.storages, means),
        _ => plan::plan::<1>(layer, &info, &levels, &options.storages, means),
    }?;
    tracing::debug!(layer = layer.name(), ?info, ?plan, "planned");
    Ok(Map {
        layer,
        path,
        input,
        meaning,
        info,
        levels,
        plan,
    })
}

fn manifest(
    options: &BuildOptions,
    maps: &[Map<'_>],
    heights: Option<&BuiltHeights>,
    file: impl Fn(TileName) -> Option<TileFile>,
) -> Manifest {
    let tiles = |layer: MapLayer, shape: TileShape, storage: Storage| {
        let of_block = |block: Block| {
            (0..shape.tiles_of_block()).map(move |part| TileName {
                storage,
                layer,
                pixels: shape.block_pixels(),
                parts: shape.parts,
                // 0…127.
                block: block.index() as u8,
                part,
            })
        };
        Block::all().flat_map(of_block).map(&file).collect()
    };
    let layers = maps.iter().map(|map| LayerEntry {
        layer: map.layer,
        source: source_text(map),
        exaggeration: match map.meaning {
            Meaning::Elevation { exaggeration, .. } => Some(exaggeration),
            _ => None,
        },
        levels: map
            .levels
            .iter()
            .map(|shape| LevelEntry {
                shape: *shape,
                tiles: options
                    .storages
                    .iter()
                    .map(|storage| tiles(map.layer, *shape, *storage))
                    .collect(),
            })
            .collect(),
    });
    Manifest {
        name: options.pack_name(),
        attribution: attribution(options, maps, heights),
        storages: options.storages.clone(),
        layers: layers.collect(),
        heights: heights.map(|heights| heights.entry.clone()),
    }
}

/// The requested lines, then those of the maps, each once.
fn attribution(
    options: &BuildOptions,
    maps: &[Map<'_>],
    heights: Option<&BuiltHeights>,
) -> Vec<String> {
    let mut lines = options.attribution.clone();
    let of_maps = maps.iter().flat_map(|map| map.input.attribution());
    let of_heights = heights.iter().flat_map(|heights| &heights.attribution);
    for line in of_maps.chain(of_heights) {
        if !lines.contains(line) {
            lines.push(line.clone());
        }
    }
    lines
}

/// Name and size, in characters that a manifest can hold.
fn source_text(map: &Map<'_>) -> String {
    let name = map.input.name(map.path);
    let name: String = name
        .chars()
        .map(|c| if c.is_control() { '?' } else { c })
        .take(500)
        .collect();
    format!("{name}, {} x {}", map.info.width, map.info.height)
}
