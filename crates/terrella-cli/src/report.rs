//! `terrella report`

use super::interruption::stop_by_itself;
use super::progress::Bars;
use super::scene_args::SettingArgs;
use super::{Common, print, values};
use clap::Args;
use std::path::PathBuf;
use terrella::SurfaceKind;
use terrella_measure::quality::{QualityError, QualityRequest, study_quality};
use terrella_measure::report::{PARAMETERS, ReportError, ReportRequest, report};
use terrella_measure::surfaces::{
    SettingsWanted, SurfacePath, SurfacesError, SurfacesPart, SurfacesRequest, compare_surfaces,
};
use terrella_play::Flight;
use terrella_play::scene::Scene;

/// Arguments of `terrella report`.
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// Scene file
    scene: PathBuf,
    #[command(flatten)]
    settings: SettingArgs,
    /// Folder to write to: index.html, tables, charts, images
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Three altitudes and fewer values: minutes instead of an hour
    #[arg(long)]
    quick: bool,
    /// Change only these settings, for example subdivision,shading; no formulas, propagators and extreme views
    #[arg(long, value_name = "NAME,…", conflicts_with_all = ["surfaces", "quality"], value_delimiter = ',', value_parser = sweep)]
    sweeps: Vec<&'static str>,
    /// Compare terrain surfaces instead: errors, holes, popping and cost on four flights at 60 frames a second
    #[arg(long, conflicts_with_all = ["repeats", "samples", "heights"])]
    surfaces: bool,
    /// With --surfaces: every setting on every flight, not only those that docs/surfaces.md shows; takes hours
    #[arg(long, requires = "surfaces", conflicts_with = "quick")]
    all_settings: bool,
    /// Measure instead how much time each reduction of quality saves on this adapter, and its error: quality.csv, and ladder.csv for
    /// `ladder` under [quality] in a scene
    #[arg(long, conflicts_with_all = ["quick", "surfaces", "samples", "heights"])]
    quality: bool,
    /// With --surfaces: compare only these, for example quadtree,clipmap
    #[arg(long, value_name = "NAME,…", requires = "surfaces", value_delimiter = ',', value_parser = values::surface)]
    only: Vec<SurfaceKind>,
    /// With --surfaces: measure only these parts of errors,times,settling; other rows of tables in the folder are kept
    #[arg(long, value_name = "NAME,…", requires = "surfaces", value_delimiter = ',', value_parser = surfaces_part)]
    parts: Vec<SurfacesPart>,
    /// With --surfaces: fly only over these of globe,scene
    #[arg(
        long,
        value_name = "NAME,…",
        requires = "surfaces",
        value_delimiter = ','
    )]
    grounds: Vec<String>,
    /// With --surfaces: fly only these of orbit,descent,low,horizon
    #[arg(long, value_name = "NAME,…", requires = "surfaces", value_delimiter = ',', value_parser = surface_path)]
    flights: Vec<SurfacePath>,
    /// With --surfaces: number of frames of each flight that are timed [default: 12, with --quick 3]
    #[arg(long, value_name = "N", requires = "surfaces", value_parser = clap::value_parser!(u32).range(1..=1000))]
    places: Option<u32>,
    /// Width and height of the images in pixels [default: 640x360, with --surfaces 1280x720]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<(u32, u32)>,
    /// Number of times that each frame is timed [default: 9, with --quick 5]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeats: Option<u32>,
    /// N × N rays per pixel of the reference images [default: 4, with --quick 3]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16))]
    samples: Option<u32>,
    /// Altitudes of the camera in kilometres, for example 400,36000 [default: twelve from 1 km to the Moon]
    #[arg(long, value_name = "KM,…", value_delimiter = ',', value_parser = values::height_km)]
    heights: Option<Vec<f64>>,
}

/// Measures the scene, or compares surfaces, and prints a summary and the page's path.
pub fn run(args: &ReportArgs, common: &Common) -> anyhow::Result<()> {
    let flight =
        Flight::open_without_listening(Scene::load_with(&args.scene, &args.settings.set)?)?;
    flight.reject_live(
        "images are compared at times of the scene",
        "use a scene with another source",
    )?;
    if args.surfaces {
        return surfaces(args, common, &flight);
    }
    if args.quality {
        return quality(args, common, &flight);
    }
    let pick = |given: Option<u32>, full: u32, quick: u32| {
        given.unwrap_or(if args.quick { quick } else { full })
    };
    let request = ReportRequest {
        folder: &args.output,
        quick: args.quick,
        sweeps: args.sweeps.clone(),
        size: args.size.unwrap_or((640, 360)),
        repeats: pick(args.repeats, 9, 5),
        samples: pick(args.samples, 4, 3),
        heights_km: args.heights.clone(),
        adapter: common.adapter.as_deref(),
    };
    stop_by_itself();
    let print_line = |text: &str| {
        if !common.quiet {
            // A reader that has gone away is no reason to stop measuring.
            let _ = print(&format!("{}\n", text.trim_end()));
        }
    };
    let study = match report(&flight, &request, &Bars::new(common.quiet), &print_line) {
        Ok(study) => study,
        // So that a bad scene has its own exit code.
        Err(ReportError::Play(error)) => return Err(error.into()),
        Err(error) => return Err(error.into()),
    };
    if common.quiet {
        return Ok(());
    }
    let page = args.output.join("index.html");
    print(&format!("{}{}\n", study.summary(), page.display()))
}

/// Measures reductions of quality.
fn quality(args: &ReportArgs, common: &Common, flight: &Flight) -> anyhow::Result<()> {
    let request = QualityRequest {
        folder: &args.output,
        size: args.size.unwrap_or((640, 360)),
        repeats: args.repeats.unwrap_or(9),
        adapter: common.adapter.as_deref(),
    };
    stop_by_itself();
    let study = match study_quality(flight, &request, &Bars::new(common.quiet)) {
        Ok(study) => study,
        // So that a bad scene has its own exit code.
        Err(QualityError::Play(error)) => return Err(error.into()),
        Err(error) => return Err(error.into()),
    };
    if common.quiet {
        return Ok(());
    }
    let ladder = args.output.join("ladder.csv");
    print(&format!("{}{}\n", study.summary(), ladder.display()))
}

/// Runs the comparison of surfaces.
fn surfaces(args: &ReportArgs, common: &Common, flight: &Flight) -> anyhow::Result<()> {
    let request = SurfacesRequest {
        folder: &args.output,
        settings: match (args.quick, args.all_settings) {
            (_, true) => SettingsWanted::All,
            (true, _) => SettingsWanted::Shown,
            _ => SettingsWanted::Documented,
        },
        only: &args.only,
        parts: match args.parts.as_slice() {
            [] => &SurfacesPart::ALL,
            some => some,
        },
        grounds: &args.grounds,
        flights: &args.flights,
        places: args.places.unwrap_or(if args.quick { 3 } else { 12 }),
        size: args.size.unwrap_or((1280, 720)),
        adapter: common.adapter.as_deref(),
    };
    stop_by_itself();
    let study = match compare_surfaces(flight, &request, &Bars::new(common.quiet)) {
        Ok(study) => study,
        // So that a bad scene has its own exit code.
        Err(SurfacesError::Play(error)) => return Err(error.into()),
        Err(error) => return Err(error.into()),
    };
    if common.quiet {
        return Ok(());
    }
    let page = args.output.join("surfaces.html");
    print(&format!("{}{}\n", study.summary(), page.display()))
}

/// A setting that reports change.
fn sweep(text: &str) -> Result<&'static str, String> {
    let found = PARAMETERS.into_iter().find(|name| *name == text);
    found.ok_or_else(|| format!("unknown setting; must be one of {}", PARAMETERS.join(", ")))
}

/// A part of the comparison of surfaces.
fn surfaces_part(text: &str) -> Result<SurfacesPart, String> {
    let found = SurfacesPart::ALL
        .into_iter()
        .find(|part| part.name() == text);
    found.ok_or_else(|| {
        let names = SurfacesPart::ALL.map(SurfacesPart::name);
        format!("unknown part; must be one of {}", names.join(", "))
    })
}

/// A flight of the comparison of surfaces, by the first word of its name.
fn surface_path(text: &str) -> Result<SurfacePath, String> {
    let word = |path: &SurfacePath| path.name().split(' ').next().unwrap_or_default();
    let found = SurfacePath::ALL.into_iter().find(|path| word(path) == text);
    found.ok_or_else(|| {
        let names: Vec<_> = SurfacePath::ALL.iter().map(word).collect();
        format!("unknown flight; must be one of {}", names.join(", "))
    })
}
