//! The recorded runs.

use super::printed::Printed;

/// A recorded run.
pub struct Recording {
    /// Its name for `--measure`.
    pub name: &'static str,
    /// Its file in `docs/recorded`, `.csv` or `.json`.
    pub file: &'static str,
    /// The source of its numbers.
    pub source: Source,
}

/// The source of a recorded run's numbers.
pub enum Source {
    /// Measured by commands of this workspace.
    Measured {
        /// What is measured, and how, in one sentence.
        method: &'static str,
        /// Whether it renders; if so, adapter and driver are recorded.
        draws: bool,
        /// The place of the numbers.
        found: Found,
    },
    /// The file was written by hand, or by a command of its own, and describes how its numbers were measured.
    Kept {
        /// Reason why it is not measured here.
        why: &'static str,
    },
}

/// Where to find a measurement's numbers. A command starts with `cargo`, or with `terrella`, which is built for release.
pub enum Found {
    /// In the output of a command.
    Printed {
        /// The command, with words separated by spaces.
        command: &'static str,
        /// The recorded part of its output.
        what: Printed,
    },
    /// Single figures in the output of commands: the file has a line `name,value,command` for each, and a page has its value between the markers
    /// `<!-- numbers RECORDING NAME -->` and `<!-- end numbers -->`.
    Figures(&'static [Figures]),
    /// In a file that a command writes into the folder `{out}`.
    Written {
        /// The command, with words separated by spaces.
        command: &'static str,
        /// The file's name in the folder.
        file: &'static str,
    },
}

/// Figures in the output of one command.
pub struct Figures {
    /// The command, with words separated by spaces.
    pub command: &'static str,
    /// The template of their lines, as for [`Printed::Lines`]: a column is a figure's name, and its value is the largest of all lines.
    pub lines: &'static str,
}

/// A recording that is not measured again.
const fn kept(name: &'static str, file: &'static str, why: &'static str) -> Recording {
    Recording {
        name,
        file,
        source: Source::Kept { why },
    }
}

/// Renders and computes all rows of the tables in `../shared/oracle`. Without them it prints nothing, which is an error here.
const CLEAR_AIR: &str = "cargo test --release --locked --workspace --test accuracy -- clear_air::clear clear_air::hazy everywhere \
    --include-ignored --nocapture --test-threads=1";

/// All recordings.
pub const RECORDINGS: &[Recording] = &[
    Recording {
        name: "bench",
        file: "bench.json",
        source: Source::Measured {
            method: "whole frames at 1280 × 720, each beside its floor and a bare clear, interleaved; medians; features switched off \
                in turn along the scene's flight",
            draws: true,
            found: Found::Written {
                command: "terrella bench config/iss.toml --json {out}/bench.json --quiet",
                file: "bench.json",
            },
        },
    },
    Recording {
        name: "orbits",
        file: "orbits.csv",
        source: Source::Measured {
            method: "perigee at 7000 km, i = 63.4°; error: the largest of 24 places, against extrapolation of order 22 in 32 digits; \
                time: processor time of the thread for one run with 24 places read, nine times, the methods interleaved",
            draws: false,
            found: Found::Printed {
                command: "cargo test --release --locked --workspace --lib print_orbits -- --ignored --nocapture",
                what: Printed::Csv,
            },
        },
    },
    Recording {
        name: "interpolation",
        file: "interpolation.csv",
        source: Source::Measured {
            method: "largest error of the position, metres, over one revolution of an unperturbed orbit, perigee included, in the \
                inner part of an ephemeris",
            draws: false,
            found: Found::Printed {
                command: "cargo test --release --locked --workspace --lib print_interpolations -- --ignored --nocapture",
                what: Printed::Csv,
            },
        },
    },
    Recording {
        name: "stability",
        file: "stability.csv",
        source: Source::Measured {
            method: "each form of a formula against arithmetic of 320 bits over its range",
            draws: false,
            found: Found::Printed {
                command: "cargo test --release --locked --workspace --lib print_stability -- --ignored --nocapture",
                what: Printed::Csv,
            },
        },
    },
    Recording {
        name: "extreme_views",
        file: "extreme_views.csv",
        source: Source::Measured {
            method: "each case of `measure::extreme` drawn, colours in linear light, 64 × 64 pixels where nothing else is said",
            draws: true,
            found: Found::Printed {
                command: "cargo test --release --locked --workspace --test accuracy extreme::pictures -- --nocapture",
                what: Printed::Lines("ok {view} | {must show} | {drawn} | {} not finite | {} s"),
            },
        },
    },
    Recording {
        name: "exactness",
        file: "exactness.csv",
        source: Source::Measured {
            method: "largest errors that tests find, each against something computed otherwise",
            draws: true,
            found: Found::Figures(&[
                Figures {
                    command: "cargo test --release --locked --workspace --test render precision -- --nocapture",
                    lines: "n = {}, {} m: worst {vertices_px} px over {} vertices",
                },
                Figures {
                    command: "cargo test --release --locked --workspace --test render picture -- --nocapture",
                    lines: "{}: worst {picture_255} of 255 over {} pixels",
                },
                Figures {
                    command: "cargo test --release --locked --workspace --test model globe -- --nocapture",
                    lines: "{blocks_not_needed} of {blocks_drawn} drawn blocks were not needed",
                },
                Figures {
                    command: "cargo test --release --locked --workspace --test orbit verification -- --nocapture",
                    lines: "{sgp4_states} states; worst {sgp4_km} km, {} km/s",
                },
            ]),
        },
    },
    Recording {
        name: "clear_air",
        file: "clear_air.csv",
        source: Source::Measured {
            method: "|found/true − 1|, %, of light that `Earth` draws into a float target and that the reference renderer finds, against \
                tables of SASKTRAN2",
            draws: true,
            found: Found::Printed {
                command: CLEAR_AIR,
                what: Printed::Csv,
            },
        },
    },
    Recording {
        name: "clear_air_colors",
        file: "clear_air_colors.csv",
        source: Source::Measured {
            method: "mean ΔE2000 of all views at an exposure of 1.4",
            draws: true,
            found: Found::Printed {
                command: CLEAR_AIR,
                what: Printed::Lines("mean ΔE2000 of set {set} {by}: {mean}"),
            },
        },
    },
    Recording {
        name: "surfaces",
        file: "surfaces.json",
        source: Source::Measured {
            method: "four flights at 60 frames a second over three grounds, 1280 × 720; errors of all frames, a hundredth of their \
                pixels in each; frames timed beside frames of blocks and their floor, interleaved, in 12 places of each flight",
            draws: true,
            found: Found::Written {
                command: "terrella report config/relief.toml --surfaces -o {out} --quiet",
                file: "surfaces.json",
            },
        },
    },
    Recording {
        name: "composition",
        file: "composition.csv",
        source: Source::Measured {
            method: "frames of a sunlit horizon with all maps of the starter pack, 1280 × 720, ways interleaved, medians of 60 frames and of \
                the quotients of frames that follow each other; development build",
            draws: true,
            found: Found::Printed {
                command: "cargo test --locked --workspace --test render composition_and_bloom -- --ignored --nocapture",
                what: Printed::Csv,
            },
        },
    },
    Recording {
        name: "start",
        file: "start.csv",
        source: Source::Measured {
            method: "the scene that comes with the program, drawn once by a process of its own, which reads its maps, compiles its \
                shaders and writes a picture; development build, with maps, files and the driver's code in memory",
            draws: true,
            found: Found::Figures(&[Figures {
                command: "cargo test --locked --workspace --test command memory -- --nocapture",
                lines: "a still took {frame_mb} MB; of 64 × 36 pixels {small_mb} MB and {small_s} s of processor time",
            }]),
        },
    },
    Recording {
        name: "peers",
        file: "peers.csv",
        source: Source::Measured {
            method: "1280 × 720 without multisampling, straight down with a field of view of 45°; 8 frames a turn as a satellite moves, \
                ended by reading all pixels back; the renderers draw by turns; medians of 16 rounds, quartiles of the ratio",
            draws: true,
            found: Found::Printed {
                command: "cargo xtask peers",
                what: Printed::Csv,
            },
        },
    },
    kept(
        "report_defaults",
        "report_defaults.csv",
        "a report of all heights takes an hour, and limb and place are of two runs",
    ),
    kept(
        "report_settings",
        "report_settings.csv",
        "a report of all heights takes an hour",
    ),
    kept("by_hand", "by_hand.csv", "criterion prints for people"),
    kept(
        "web_peers",
        "web-peers.csv",
        "`cargo xtask web peers` measures it and records the browser's adapter",
    ),
    kept("streaming", "streaming.csv", "it needs a pack of 3 GB"),
    kept(
        "farm",
        "farm.csv",
        "it is Python's: crates/terrella-py/benches/farm_growth.py makes it of its runs",
    ),
    kept(
        "farm_growth",
        "farm_growth.csv",
        "crates/terrella-py/benches/farm_growth.py computes it",
    ),
    kept(
        "sky_places",
        "sky_places.csv",
        "its numbers stand in the output of several tests",
    ),
    kept(
        "sky_costs",
        "sky_costs.csv",
        "pairs of stills, timed by hand on a quiet machine",
    ),
    kept(
        "light_costs",
        "light_costs.csv",
        "it needs the program as it was before",
    ),
    kept(
        "air_schemes",
        "air_schemes.csv",
        "the schemes that were left are no longer in the program",
    ),
    kept(
        "truth_errors",
        "truth_errors.csv",
        "its numbers stand in the output of several tests",
    ),
    kept(
        "terrain_quadtree",
        "terrain_quadtree.csv",
        "a run takes a quarter of an hour and writes a table for each ground",
    ),
    kept(
        "terrain_storage",
        "terrain_storage.csv",
        "a run takes a quarter of an hour and writes a table for each ground",
    ),
    kept(
        "terrain_building",
        "terrain_building.csv",
        "a run takes a quarter of an hour and writes a table for each ground",
    ),
    kept(
        "terrain_orders",
        "terrain_orders.csv",
        "a run takes a quarter of an hour and writes a table for each ground",
    ),
    kept(
        "terrain_conditions",
        "terrain_conditions.csv",
        "a run takes a quarter of an hour and writes a table for each ground",
    ),
];
