//! Elevation files, layered over one another.

use super::budget::Budget;
use super::layout::{MOST_SIDE, is_finer, levels_for};
use crate::folder::{BuildFolder, ScratchFolder};
use crate::plan::Means;
use crate::{BuildError, BuildProgress};
use std::borrow::Cow;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use terrella_ground::elevation::geoid::VerticalDatum;
use terrella_ground::elevation::spool::{HeightSpool, HeightWindow, SpoolHost};
use terrella_ground::elevation::{
    Bounds, GridError, GridLimits, HeightFileError, HeightGrid, HeightRange, Joins, PlacedBounds,
    Placement, open_heights_above,
};
use terrella_imagery::pack::{HeightKind, HeightsEntry, TileFile};

/// Steps of 16-bit samples that are used: a few are left for rounding.
const STEPS: f64 = 65_500.0;

/// Most that rounding may take from a file that is finer, metres.
const MOST_LOSS_M: f64 = 0.05;

/// Heights of a file.
enum Heights {
    Held(HeightGrid),
    Spooled(HeightSpool),
}

/// A file.
struct HeightSource {
    /// File name and size.
    name: String,
    attribution: Option<String>,
    heights: Heights,
    bounds: Bounds,
    range: HeightRange,
    /// Step between elevations, metres; 0 for floats.
    quantum_m: f64,
    /// The angle between its samples along a meridian or a parallel, whichever is less, radians.
    step_rad: f64,
    /// [`HeightGrid::finest_spacing_rad`].
    finest_rad: f64,
}

pub(super) struct HeightFiles {
    /// Threads that memory is kept for.
    pub threads: usize,
    /// As they were given.
    sources: Vec<HeightSource>,
    /// Their numbers, from the top down.
    order: Vec<usize>,
    /// How each joins the others, in the same order.
    joins: Vec<Joins>,
    /// Their bounds, in the same order.
    placed: PlacedBounds,
    /// Of files that are read in parts. Declared after them: it is removed after they are closed.
    _scratch: Option<ScratchFolder>,
}

impl HeightFiles {
    /// Reads all of them: those that fit into the memory allowed are held, the others go into scratch files.
    pub(super) fn open(
        paths: &[PathBuf],
        above: Option<VerticalDatum>,
        means: Means,
        folder: &BuildFolder<'_>,
        progress: &dyn BuildProgress,
    ) -> Result<Self, BuildError> {
        let mut budget = Budget::of(paths, means)?;
        let (mut sources, mut scratch) = (Vec::new(), None);
        for path in paths {
            if progress.cancelled() {
                return Err(BuildError::Cancelled);
            }
            progress.begin(&file_name(path), Some(1));
            let held = held(path, &budget.limits(), above);
            progress.step();
            progress.end();
            let heights = match held? {
                Some((grid, attribution)) => {
                    budget.hold(grid.stats().bytes);
                    HeightSource::held(path, grid, attribution)
                }
                None => {
                    let scratch = match &mut scratch {
                        Some(scratch) => scratch,
                        none => none.insert(folder.scratch()?),
                    };
                    let name = scratch.path().join(format!("heights-{}", sources.len()));
                    let host = Host {
                        path,
                        folder,
                        progress,
                    };
                    let spool = HeightSpool::read(path, &name, above, &host)?;
                    progress.note(&format!(
                        "{}: does not fit into --memory and is read part by part",
                        path.display()
                    ));
                    HeightSource::spooled(path, spool)
                }
            };
            sources.push(heights);
        }
        let mut order: Vec<usize> = (0..sources.len()).collect();
        // Stable: of equal ones the first stays first.
        let finest_rad = |n: &usize| sources[*n].finest_rad;
        order.sort_by(|a, b| finest_rad(a).total_cmp(&finest_rad(b)));
        let placements: Vec<_> = order.iter().map(|n| sources[*n].placement()).collect();
        let joins = Joins::of(&placements);
        let placed = PlacedBounds::new(order.iter().map(|n| sources[*n].bounds));
        Ok(Self {
            threads: budget.threads,
            sources,
            joins,
            placed,
            order,
            _scratch: scratch,
        })
    }

    /// Whom to name for them.
    pub(super) fn attribution(&self) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for line in self.sources.iter().flat_map(|file| &file.attribution) {
            if !lines.contains(line) {
                lines.push(line.clone());
            }
        }
        lines
    }

    /// Bounds of each file, and the angle between its samples.
    pub(super) fn steps(&self) -> Vec<(Bounds, f64)> {
        let files = self.sources.iter();
        files.map(|file| (file.bounds, file.step_rad)).collect()
    }

    /// Elevation lookup inside the bounds for samples at this spacing. Finer files have finer tiles there.
    pub(super) fn view(&self, bounds: &Bounds, spacing_rad: f64) -> Result<View<'_>, BuildError> {
        let mut parts = Vec::new();
        for n in self.placed.near(bounds) {
            let (file, joins) = (&self.sources[self.order[n]], &self.joins[n]);
            if is_finer(file.step_rad, spacing_rad) || !file.bounds.overlaps(bounds) {
                continue;
            }
            let heights = match &file.heights {
                Heights::Held(grid) => HeightPart::Held(grid),
                Heights::Spooled(spool) => HeightPart::Window(spool.window(bounds)?),
            };
            let reach = file.placement().reach();
            parts.push(Part {
                heights,
                joins,
                latitudes_rad: (reach.south_rad, reach.north_rad),
            });
        }
        Ok(View {
            of_row: Vec::new(),
            lat_rad: f64::NAN,
            parts,
        })
    }

    /// Levels fine enough for the finest file, and how samples are kept. Index and number of tiles are not known yet.
    pub(super) fn layout(&self) -> Result<HeightsEntry, BuildError> {
        let steps = self.sources.iter().map(|file| file.step_rad);
        let finest = steps.fold(TAU, f64::min);
        let (levels, side) = levels_for(finest).ok_or_else(|| BuildError::Option {
            option: "--heights",
            cause: format!(
                "samples {:.1e}° apart are finer than a pack of heights can be, 2^30 round the Earth in tiles of {MOST_SIDE}; make them coarser",
                finest.to_degrees()
            ),
        })?;
        Ok(HeightsEntry {
            // As many as a manifest may name.
            sources: self
                .sources
                .iter()
                .take(64)
                .map(|file| file.name.clone())
                .collect(),
            levels,
            columns: 16,
            side,
            border: 1,
            kind: self.kind(),
            tiles: 0,
            index: TileFile {
                bytes: 0,
                checksum: [0; 16],
            },
        })
    }

    /// Steps of 16 bits where they lose nothing that a file holds but 5 cm, else floats.
    fn kind(&self) -> HeightKind {
        let ranges = || self.sources.iter().map(|file| file.range);
        // The sea is beneath all files.
        let low_m = ranges().map(|range| range.low_m).fold(0.0, f64::min);
        let high_m = ranges().map(|range| range.high_m).fold(0.0, f64::max);
        // Parts of a metre, so that whole metres come through as they are; a metre more for an offset of whole metres.
        let parts = (STEPS / (high_m - low_m + 1.0)).floor().clamp(1.0, 1000.0);
        let scale_m = 1.0 / parts;
        let is_kept = |quantum_m: f64| 0.5 * scale_m <= MOST_LOSS_M || quantum_m >= scale_m;
        if self.sources.iter().all(|file| is_kept(file.quantum_m)) {
            HeightKind::I16 {
                offset_m: (0.5 * (low_m + high_m)).round(),
                scale_m,
            }
        } else {
            HeightKind::F32
        }
    }
}

/// A file that is held, unless it does not fit.
fn held(
    path: &Path,
    limits: &GridLimits,
    above: Option<VerticalDatum>,
) -> Result<Option<(HeightGrid, Option<String>)>, BuildError> {
    let file = match open_heights_above(path, limits, above) {
        Ok(file) => file,
        Err(HeightFileError::Grid {
            source: GridError::Memory { .. },
            ..
        }) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let quantum_m = file.grid.stats().quantum_m;
    // Rounded so as to fit: no reason to lose any of them.
    let is_rounded = quantum_m > 0.0 && quantum_m != 1.0;
    Ok((!is_rounded).then_some((file.grid, file.attribution)))
}

impl HeightSource {
    fn placement(&self) -> &Placement {
        match &self.heights {
            Heights::Held(grid) => grid.placement(),
            Heights::Spooled(spool) => spool.placement(),
        }
    }

    fn held(path: &Path, grid: HeightGrid, attribution: Option<String>) -> Self {
        let (stats, size) = (grid.stats(), grid.size());
        let flat_rad = grid.is_flat().then(|| grid.detail_rad());
        Self {
            name: source_text(path, size),
            attribution,
            bounds: grid.bounds(),
            range: stats.range,
            quantum_m: stats.quantum_m,
            step_rad: step_rad(size, &grid.sample_bounds(), flat_rad),
            finest_rad: grid.finest_spacing_rad(),
            heights: Heights::Held(grid),
        }
    }

    fn spooled(path: &Path, spool: HeightSpool) -> Self {
        let flat_rad = spool.is_flat().then(|| spool.detail_rad());
        Self {
            name: source_text(path, spool.size()),
            attribution: spool.attribution().map(str::to_string),
            bounds: spool.bounds(),
            range: spool.range(),
            quantum_m: spool.quantum_m(),
            step_rad: step_rad(spool.size(), &spool.sample_bounds(), flat_rad),
            finest_rad: spool.finest_spacing_rad(),
            heights: Heights::Spooled(spool),
        }
    }
}

fn step_rad((columns, rows): (u32, u32), bounds: &Bounds, flat_rad: Option<f64>) -> f64 {
    let step = |width_rad: f64, samples: u32| match samples {
        0 | 1 => f64::INFINITY,
        samples => width_rad / f64::from(samples - 1),
    };
    let along = step(bounds.width_rad, columns);
    let step_rad = along.min(step(bounds.north_rad - bounds.south_rad, rows));
    // A file of constant elevation has no more detail than its edge.
    step_rad.max(flat_rad.unwrap_or(0.0))
}

fn file_name(path: &Path) -> Cow<'_, str> {
    path.file_name().unwrap_or_default().to_string_lossy()
}

/// Progress reports while a file is read into a scratch file.
struct Host<'a> {
    path: &'a Path,
    folder: &'a BuildFolder<'a>,
    progress: &'a dyn BuildProgress,
}

impl SpoolHost for Host<'_> {
    fn free_bytes(&self, folder: &Path) -> Option<u64> {
        self.folder.free_bytes(folder)
    }

    fn begin(&self, rows: u64) {
        let what = format!("{}, part by part", file_name(self.path));
        self.progress.begin(&what, Some(rows));
    }

    fn step(&self) {
        self.progress.step();
    }

    fn end(&self) {
        self.progress.end();
    }

    fn cancelled(&self) -> bool {
        self.progress.cancelled()
    }
}

/// The files about a tile, from the top down, over a sea at height 0.
pub(super) struct View<'a> {
    parts: Vec<Part<'a>>,
    /// The last latitude, and the parts that reach it: samples are requested row by row, and a coarse tile overlaps thousands of parts.
    lat_rad: f64,
    of_row: Vec<usize>,
}

struct Part<'a> {
    heights: HeightPart<'a>,
    joins: &'a Joins,
    /// Beyond these its weight is 0.
    latitudes_rad: (f64, f64),
}

enum HeightPart<'a> {
    Held(&'a HeightGrid),
    Window(HeightWindow<'a>),
}

impl View<'_> {
    /// The height of a place inside the bounds, metres, from the files' own samples.
    pub(super) fn height_m(&mut self, lat_rad: f64, lon_rad: f64) -> f64 {
        if self.lat_rad != lat_rad {
            let reaches = |part: &Part<'_>| {
                let (south_rad, north_rad) = part.latitudes_rad;
                (south_rad..=north_rad).contains(&lat_rad)
            };
            let parts = self.parts.iter().enumerate();
            let of_row = parts.filter(|(_, part)| reaches(part)).map(|(n, _)| n);
            self.of_row.clear();
            self.of_row.extend(of_row);
            self.lat_rad = lat_rad;
        }
        let (mut height_m, mut beneath) = (0.0, 1.0);
        for n in &self.of_row {
            let Part { heights, joins, .. } = &self.parts[*n];
            let weighted = match heights {
                HeightPart::Held(grid) => grid.weighted(lat_rad, lon_rad, 0.0, joins),
                HeightPart::Window(window) => window.weighted(lat_rad, lon_rad, joins),
            };
            if let Some((of_part_m, weight)) = weighted {
                height_m += beneath * weight * of_part_m;
                beneath *= 1.0 - weight;
                if beneath <= 0.0 {
                    break;
                }
            }
        }
        height_m
    }
}

/// Name and size, in characters that a manifest can hold.
fn source_text(path: &Path, (columns, rows): (u32, u32)) -> String {
    let name: String = file_name(path)
        .chars()
        .map(|c| if c.is_control() { '?' } else { c })
        .take(500)
        .collect();
    format!("{name}, {columns} x {rows}")
}
