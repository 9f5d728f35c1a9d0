//! `terrella pack build`: an imagery pack from maps of any size.

use crate::cli::Common;
use crate::cli::progress::{Bars, stop_on_interrupt};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use terrella::internals::imagery::SLOPE_EXAGGERATION;
use terrella::internals::imagery::build::{
    BuildOptions, BuildProgress, DEFAULT_MEMORY_BYTES, Relief, build,
};
use terrella::internals::imagery::tile::{MapLayer, Storage};
use terrella::internals::play::Progress;

/// Arguments of `terrella pack build`.
#[derive(Debug, Args)]
#[command(
    after_help = "Maps are equirectangular PNG, JPEG or (Geo)TIFF files of the whole Earth, twice as wide as \
    high, north up, left edge at 180° W. A build that was stopped goes on when the same command is run again."
)]
pub struct BuildArgs {
    /// Surface colour by day, sRGB
    #[arg(long, value_name = "MAP")]
    day: PathBuf,
    /// Cloud cover: grey, or the luminance of colour
    #[arg(long, value_name = "MAP")]
    clouds: Option<PathBuf>,
    /// Normal map in tangent space: red east, green north, blue up, middle 128
    #[arg(long, value_name = "MAP", conflicts_with = "elevation")]
    normals: Option<PathBuf>,
    /// Elevations in metres, from which slopes are computed: 16-bit PNG, or TIFF of 16-bit or float samples
    #[arg(long, value_name = "MAP")]
    elevation: Option<PathBuf>,
    /// City lights: grey, or the luminance of colour
    #[arg(long, value_name = "MAP")]
    night: Option<PathBuf>,
    /// Open water: white where there is some
    #[arg(long, value_name = "MAP")]
    water: Option<PathBuf>,
    /// The pack's folder
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Name of the pack [default: its folder's]
    #[arg(long)]
    name: Option<String>,
    /// Attribution of the data; may be given several times
    #[arg(long, value_name = "TEXT")]
    attribution: Vec<String>,
    /// Format of the tiles: plain for software adapters, bc for graphics cards
    #[arg(long, value_enum, default_value_t = StorageArg::Both)]
    storage: StorageArg,
    /// Memory limit, megabytes
    #[arg(long, value_name = "MB", default_value_t = DEFAULT_MEMORY_BYTES / 1_000_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    memory: u64,
    /// Levels of a map in pixels per block (a 16th of its width), the finest first, as in day=5400,2700,1350,256; may
    /// be given for each map [default: the paper's up to the map's own size]
    #[arg(long, value_name = "LAYER=N,N", value_parser = parse_pixels)]
    pixels: Vec<(MapLayer, Vec<u32>)>,
    /// How many times steeper than the truth slopes are, with --elevation
    #[arg(long, value_name = "TIMES", default_value_t = SLOPE_EXAGGERATION, requires = "elevation")]
    exaggeration: f64,
    /// Metres to subtract from elevations [default: 11000 for PNG, 0 for TIFF]
    #[arg(
        long,
        value_name = "METRES",
        requires = "elevation",
        allow_negative_numbers = true
    )]
    elevation_offset: Option<f64>,
    /// Discard an unfinished build or a finished pack in the folder
    #[arg(long)]
    restart: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum StorageArg {
    Plain,
    Bc,
    Both,
}

/// `day=1350,675` as a layer and its levels.
fn parse_pixels(text: &str) -> Result<(MapLayer, Vec<u32>), String> {
    let layers = || MapLayer::ALL.map(MapLayer::name).join(", ");
    let Some((name, list)) = text.split_once('=') else {
        return Err("write it as in day=1350,675,256".to_string());
    };
    let layer = MapLayer::from_name(name)
        .ok_or_else(|| format!("there is no map {name:?}; it is one of {}", layers()))?;
    let pixels = list.split(',').map(|word| {
        word.trim()
            .parse()
            .map_err(|_| format!("{word:?} is not a number of pixels"))
    });
    Ok((layer, pixels.collect::<Result<_, _>>()?))
}

/// Bars of the command, with notes on standard error.
struct Shown {
    bars: Bars,
    quiet: bool,
}

impl BuildProgress for Shown {
    fn begin(&self, what: &str, steps: Option<u64>) {
        self.bars.begin(what, steps);
    }

    fn step(&self) {
        self.bars.step();
    }

    fn end(&self) {
        self.bars.end();
    }

    fn note(&self, text: &str) {
        if !self.quiet {
            eprintln!("note: {text}");
        }
    }

    fn cancelled(&self) -> bool {
        self.bars.cancelled()
    }
}

/// Builds the pack.
pub fn run(args: &BuildArgs, common: &Common) -> anyhow::Result<()> {
    let elevation = args.elevation.as_ref().map(|path| Relief::Elevation {
        path: path.clone(),
        offset_m: args.elevation_offset,
        exaggeration: args.exaggeration,
    });
    let options = BuildOptions {
        clouds: args.clouds.clone(),
        relief: elevation.or_else(|| args.normals.clone().map(Relief::Normals)),
        night_lights: args.night.clone(),
        water: args.water.clone(),
        name: args.name.clone(),
        attribution: args.attribution.clone(),
        storages: match args.storage {
            StorageArg::Plain => vec![Storage::Plain],
            StorageArg::Bc => vec![Storage::Bc],
            StorageArg::Both => Storage::ALL.to_vec(),
        },
        pixels: args.pixels.clone(),
        memory_bytes: args.memory * 1_000_000,
        restart: args.restart,
        ..BuildOptions::new(&args.day, &args.output)
    };
    stop_on_interrupt();
    let shown = Shown {
        bars: Bars::new(common.quiet),
        quiet: common.quiet,
    };
    let manifest = build(&options, &shown)?;
    tracing::info!(pack = %args.output.display(), name = manifest.name, "built");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ladders_are_read() {
        assert_eq!(
            parse_pixels("night_lights=1350, 256"),
            Ok((MapLayer::NightLights, vec![1350, 256]))
        );
        for (bad, word) in [
            ("1350", "day=1350"),
            ("moon=1", "night_lights"),
            ("day=", "not a number"),
            ("day=1,-2", "\"-2\""),
        ] {
            let error = parse_pixels(bad).expect_err("bad");
            assert!(error.contains(word), "{error}");
        }
    }
}
