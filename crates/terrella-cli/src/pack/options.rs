//! Options shared by the commands that build packs.

use crate::progress::Bars;
use clap::{Args, ValueEnum};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use terrella_imagery::tile::{MapLayer, Storage};
use terrella_pack::{BuildOptions, BuildProgress, DEFAULT_MEMORY_BYTES};
use terrella_play::Progress;

/// How a pack is built, whatever it is built from.
#[derive(Debug, Args)]
pub struct PackOptions {
    /// Name of the pack [default: its folder's]
    #[arg(long)]
    name: Option<String>,
    /// Attribution of the data, in addition to that of the maps; repeatable
    #[arg(long, value_name = "TEXT")]
    attribution: Vec<String>,
    /// Format of the tiles: plain for software adapters, bc for graphics cards
    #[arg(long, value_enum, default_value_t = StorageArg::Both)]
    storage: StorageArg,
    /// Memory limit, megabytes
    #[arg(long, value_name = "MB", default_value_t = DEFAULT_MEMORY_BYTES / 1_000_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    memory: u64,
    /// Levels of a map in pixels per block (a 16th of its width), finest first, for example day=5400,2700,1350,256; repeatable, once for
    /// each map. Levels of more than 2040 are cut into parts and must be 2, 4, 8 or 16 times the finest other one [default: the paper's
    /// levels up to the map's size; for finer maps, these times 2, 4, 8 and 16]
    #[arg(long, value_name = "LAYER=N,N", value_parser = parse_pixels)]
    pixels: Vec<(MapLayer, Vec<u32>)>,
    /// Discard an unfinished build or a finished pack in the folder
    #[arg(long)]
    restart: bool,
    /// Exit with an error if there is any note: for example of missing or damaged files, or of colour profiles. A pack that is
    /// built is still written, and lacks only what the notes name; of fetched files with notes none is built
    #[arg(long)]
    strict: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum StorageArg {
    Plain,
    Bc,
    Both,
}

impl PackOptions {
    /// Build options for a pack of this day map in this folder.
    pub fn build_options(&self, day: &Path, output: &Path) -> BuildOptions {
        BuildOptions {
            name: self.name.clone(),
            attribution: self.attribution.clone(),
            storages: match self.storage {
                StorageArg::Plain => vec![Storage::Plain],
                StorageArg::Bc => vec![Storage::Bc],
                StorageArg::Both => Storage::ALL.to_vec(),
            },
            pixels: self.pixels.clone(),
            memory_bytes: self.memory_bytes(),
            restart: self.restart,
            ..BuildOptions::new(day, output)
        }
    }

    /// Whether all pack options have their defaults.
    pub fn is_default(&self) -> bool {
        self.name.is_none()
            && self.attribution.is_empty()
            && self.storage == StorageArg::Both
            && self.pixels.is_empty()
            && !self.restart
    }

    /// With --strict, returns an error if there are notes.
    pub fn check_notes(&self, shown: &Shown) -> anyhow::Result<()> {
        let notes = shown.notes.load(Ordering::Relaxed);
        if self.strict && notes > 0 {
            let see = if shown.quiet {
                "run it without --quiet to see them"
            } else {
                "see above"
            };
            anyhow::bail!("--strict: {notes} notes; {see}");
        }
        Ok(())
    }

    /// Memory limit, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.memory * 1_000_000
    }
}

/// `day=1350,675` as a layer and its levels.
fn parse_pixels(text: &str) -> Result<(MapLayer, Vec<u32>), String> {
    let layers = || MapLayer::ALL.map(MapLayer::name).join(", ");
    let Some((name, list)) = text.split_once('=') else {
        return Err("must be LAYER=N,N, for example day=1350,675,256".to_string());
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
pub struct Shown {
    bars: Bars,
    quiet: bool,
    notes: AtomicU64,
}

impl Shown {
    /// Creates the bars; with `quiet` nothing is shown.
    pub fn new(quiet: bool) -> Self {
        Self {
            bars: Bars::new(quiet),
            quiet,
            notes: AtomicU64::new(0),
        }
    }
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
        self.notes.fetch_add(1, Ordering::Relaxed);
        if !self.quiet {
            eprintln!("note: {text}");
        }
    }

    fn cancelled(&self) -> bool {
        self.bars.cancelled()
    }
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
