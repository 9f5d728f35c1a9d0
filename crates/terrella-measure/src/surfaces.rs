//! Surfaces with relief against each other: the same ground, the same flights, error beside run time.
//!
//! Every flight is flown in simulated time, a frame each sixtieth of a second. Surfaces bound the work of a frame by counts,
//! not by a clock, so what they draw in a frame is the same on every machine; errors are of those frames, and only times
//! belong to a machine. Times are taken apart, in some places of each flight.
//!
//! | file | what |
//! |---|---|
//! | `paths.rs` | four flights |
//! | `test_grounds.rs` | what is flown over |
//! | `candidates.rs` | which surfaces, with which settings |
//! | `run.rs` | what all measurements share |
//! | `flight_errors.rs` | errors, popping and `prepare`, frame by frame |
//! | `frame_times.rs` | frames beside their floor and frames of blocks |
//! | `settling.rs` | how a surface becomes fine after a jump |
//! | `rows.rs` | what is found, and its tables |
//! | `study.rs` | all tables together, and which surface to choose |
//! | `markdown.rs` | tables and sentences of docs/surfaces.md |
//! | `plots.rs`, `page.rs` | charts, and a page |

mod candidates;
mod flight_errors;
mod frame_times;
pub mod markdown;
mod page;
mod paths;
mod plots;
mod rows;
mod run;
mod settling;
mod study;
mod test_grounds;

pub use candidates::{Candidate, candidates};
pub use paths::SurfacePath;
pub use rows::{ErrorRow, Setting, SettlingRow, TimeRow, csv_of, rows_of};
pub use study::{EXACT_PX, FlightSummary, SAME_COST, Score, SurfaceStudy, WORST};
pub use test_grounds::{TestGround, test_grounds};

use super::ChartError;
use super::html::PageError;
use super::output::OutputFolder;
use rows::replace;
use run::FlightMeter;
use std::path::Path;
use terrella::{GpuContext, Sky};
use terrella_ground::elevation::GridError;
use terrella_ground::globe::SurfaceKind;
use terrella_play::{Flight, OutputError, PlayError, Progress};

/// Parts of the comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfacesPart {
    /// Errors, popping and `prepare` of whole flights.
    Errors,
    /// Times of frames; nothing else should be at work meanwhile.
    Times,
    /// How they become fine after a jump.
    Settling,
}

impl SurfacesPart {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Errors, Self::Times, Self::Settling];

    /// As the command line names it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Errors => "errors",
            Self::Times => "times",
            Self::Settling => "settling",
        }
    }

    /// The file of its table.
    pub fn file(self) -> &'static str {
        match self {
            Self::Errors => "surfaces_errors.csv",
            Self::Times => "surfaces_times.csv",
            Self::Settling => "surfaces_settling.csv",
        }
    }
}

/// Which settings of surfaces are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingsWanted {
    /// Those of [`Setting::is_shown`].
    Shown,
    /// These everywhere, and all on the low flight over the scene's own ground: what docs/surfaces.md has.
    Documented,
    /// All everywhere.
    All,
}

impl SettingsWanted {
    /// Whether a setting is compared; without a flight it counts for all together.
    fn takes(self, setting: &Setting, ground: &TestGround, path: Option<SurfacePath>) -> bool {
        let is_documented = ground.name == test_grounds::SCENE && path == Some(SurfacePath::Low);
        match self {
            Self::All => true,
            Self::Documented if is_documented => true,
            _ => setting.is_shown(),
        }
    }
}

/// How a comparison is wanted.
#[derive(Clone, Debug)]
pub struct SurfacesRequest<'r> {
    /// Output folder; created if it does not exist. In existing tables, measured rows are replaced and others kept.
    pub folder: &'r Path,
    pub settings: SettingsWanted,
    /// The surfaces; empty means all.
    pub only: &'r [SurfaceKind],
    /// The measured parts.
    pub parts: &'r [SurfacesPart],
    /// The test terrains by name; empty means all.
    pub grounds: &'r [String],
    /// The flights; empty means all.
    pub flights: &'r [SurfacePath],
    /// Frames of each flight that are timed, 1 or more.
    pub places: u32,
    /// Width and height of all images, pixels.
    pub size: (u32, u32),
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
}

/// Why there is no comparison.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SurfacesError {
    /// Drawing.
    #[error(transparent)]
    Play(#[from] PlayError),
    /// Heights that are made here.
    #[error(transparent)]
    Grid(#[from] GridError),
    #[error("no ground is named {name:?}; there are {known}")]
    NoGround {
        name: String,
        /// The names that there are.
        known: String,
    },
    /// An invalid table in the folder.
    #[error("{file} in the output folder: {source}; move it away, or give another folder")]
    Table {
        /// Its name.
        file: &'static str,
        source: csv::Error,
    },
    /// Writing.
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error(transparent)]
    Chart(#[from] ChartError),
    #[error(transparent)]
    Page(#[from] PageError),
}

/// Makes the requested measurements and writes tables, charts, `surfaces.json` and `surfaces.html`. The scene sets maps, air and date.
///
/// # Errors
/// A folder that cannot be written to, before anything is drawn; all errors of drawing.
pub fn compare_surfaces(
    flight: &Flight,
    request: &SurfacesRequest<'_>,
    progress: &dyn Progress,
) -> Result<SurfaceStudy, SurfacesError> {
    let folder = OutputFolder::open(request.folder)?;
    let mut study = SurfaceStudy::read(|file| Ok(folder.read(file)?.unwrap_or_default()))?;
    let gpu = pollster::block_on(GpuContext::open(request.adapter)).map_err(PlayError::from)?;
    progress.begin("loading maps and heights", None);
    let options = flight.earth_options(gpu.bc_support())?;
    let grounds = grounds(flight, request.grounds)?;
    progress.end();
    let candidates = candidates(request.only);
    let meter = FlightMeter {
        gpu: &gpu,
        options: &options,
        sky: Sky::at(flight.scene().time.start),
        size: request.size,
        places: request.places.max(1),
        progress,
    };
    let info = gpu.adapter.get_info();
    study.adapter = format!("{} ({})", info.name, info.backend);
    study.size = request.size;
    let paths = match request.flights {
        [] => &SurfacePath::ALL,
        some => some,
    };
    let wanted = |ground: &TestGround, path: Option<SurfacePath>| -> Vec<&Candidate> {
        let all = candidates.iter();
        all.filter(|candidate| request.settings.takes(&candidate.setting, ground, path))
            .collect()
    };
    for part in SurfacesPart::ALL {
        if !request.parts.contains(&part) {
            continue;
        }
        let of_part: Vec<Option<SurfacePath>> = match part {
            SurfacesPart::Settling => vec![None],
            _ => paths.iter().copied().map(Some).collect(),
        };
        let steps: usize = grounds
            .iter()
            .flat_map(|ground| of_part.iter().map(|path| wanted(ground, *path).len()))
            .sum();
        progress.begin(part.name(), Some(steps as u64));
        for ground in &grounds {
            let is_whole = measure(part, &meter, ground, &of_part, &wanted, &mut study)?;
            // Complete rows are saved immediately.
            folder.write(part.file(), study.csv(part).as_bytes())?;
            if !is_whole {
                study.is_partial = true;
                break;
            }
        }
        progress.end();
        if study.is_partial {
            break;
        }
    }
    folder.write("surfaces.json", markdown::json(&study).as_bytes())?;
    let plots = plots::plots(&study)?;
    for plot in &plots {
        folder.write(&format!("plots/{}.svg", plot.name), plot.svg.as_bytes())?;
    }
    folder.write("surfaces.html", page::page(&study, &plots)?.as_bytes())?;
    Ok(study)
}

/// Measures a part over one ground; `false` if that was stopped.
fn measure<'c>(
    part: SurfacesPart,
    meter: &FlightMeter<'_>,
    ground: &TestGround,
    paths: &[Option<SurfacePath>],
    wanted: &dyn Fn(&TestGround, Option<SurfacePath>) -> Vec<&'c Candidate>,
    study: &mut SurfaceStudy,
) -> Result<bool, SurfacesError> {
    let mut blocks = match part {
        SurfacesPart::Times => Some(meter.blocks_timer(ground)?),
        _ => None,
    };
    for path in paths {
        let exact = path.filter(|_| part == SurfacesPart::Errors);
        let exact = exact.map(|path| meter.exact(ground, path));
        for candidate in wanted(ground, *path) {
            let is_whole = match (path, &mut blocks, &exact) {
                (Some(path), Some(blocks), _) => meter
                    .times(ground, *path, candidate, blocks)?
                    .map(|rows| replace(&mut study.times, rows)),
                (Some(path), _, Some(exact)) => meter
                    .errors(ground, *path, candidate, exact)?
                    .map(|row| replace(&mut study.errors, vec![row])),
                _ => meter
                    .settling(ground, candidate)?
                    .map(|row| replace(&mut study.settling, vec![row])),
            };
            if is_whole.is_none() {
                return Ok(false);
            }
            meter.progress.step();
        }
    }
    Ok(true)
}

fn grounds(flight: &Flight, wanted: &[String]) -> Result<Vec<TestGround>, SurfacesError> {
    let all = test_grounds(flight.scene())?;
    for name in wanted {
        if !all.iter().any(|ground| ground.name == name) {
            let known: Vec<_> = all.iter().map(|ground| ground.name).collect();
            return Err(SurfacesError::NoGround {
                name: name.clone(),
                known: known.join(", "),
            });
        }
    }
    let is_wanted =
        |ground: &TestGround| wanted.is_empty() || wanted.iter().any(|name| name == ground.name);
    Ok(all.into_iter().filter(is_wanted).collect())
}
