//! `terrella terrain`

use super::progress::Bars;
use super::{Common, print};
use clap::Args;
use std::path::PathBuf;
use terrella_measure::terrain::{SyntheticGround, TerrainRequest, measure_terrain};

/// Arguments of `terrella terrain`.
#[derive(Debug, Args)]
#[command(
    after_help = "Tables are printed to standard output as Markdown, or with --csv as CSV. Elevation files are those that scenes read: \
    GeoTIFF (LZW, deflate, PackBits, ZSTD, LERC or JPEG), NetCDF, SRTM (.hgt), ASCII grids (.asc), DTED, or PNG with a TOML sidecar."
)]
pub struct TerrainArgs {
    /// Elevation files
    #[arg(value_name = "FILE", required_unless_present = "fractal")]
    files: Vec<PathBuf>,
    /// Also measure fractal terrain of N x N posts, 90 m apart; N is 129, 257, … up to 8193
    #[arg(long, value_name = "N", value_parser = side)]
    fractal: Option<u32>,
    /// Seed of the fractal terrain
    #[arg(long, value_name = "NUMBER", default_value_t = 1, requires = "fractal")]
    seed: u64,
    /// Tolerances of contours and patches, metres
    #[arg(long, value_name = "M,…", value_delimiter = ',', value_parser = tolerance_m, default_value = "0,1,5,20,50", allow_hyphen_values = true)]
    tolerances: Vec<f64>,
    /// Numbers of threads to build with
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_value = "1,2", value_parser = clap::value_parser!(u32).range(1..=64))]
    threads: Vec<u32>,
    /// Memory limit for building one tree, megabytes
    #[arg(long, value_name = "MB", default_value_t = 2000, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    memory: u64,
    /// Print the tables as CSV
    #[arg(long)]
    csv: bool,
    /// Write the tables as CSV and images of the quadtree's triangles to this folder
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
}

/// Measures the terrain and prints each table when it is complete.
pub fn run(args: &TerrainArgs, common: &Common) -> anyhow::Result<()> {
    let threads: Vec<usize> = args.threads.iter().map(|n| *n as usize).collect();
    let request = TerrainRequest {
        files: &args.files,
        synthetic: args.fractal.map(|side| SyntheticGround {
            side,
            seed: args.seed,
        }),
        tolerances_m: &args.tolerances,
        threads: &threads,
        memory_bytes: args.memory * 1_000_000,
        output: args.output.as_deref(),
        adapter: common.adapter.as_deref(),
    };
    let mut printed = Ok(());
    measure_terrain(&request, &Bars::new(common.quiet), &mut |table| {
        let text = match args.csv {
            true => table.to_csv(),
            false => table.to_text(),
        };
        if printed.is_ok() {
            printed = print(&format!("{text}\n"));
        }
    })?;
    printed
}

/// One more than a power of two.
fn side(text: &str) -> Result<u32, String> {
    let side = text.trim().parse::<u32>().ok();
    side.filter(|side| (129..=8193).contains(side) && (side - 1).is_power_of_two())
        .ok_or_else(|| {
            "must be one more than a power of two, from 129 to 8193, for example 2049".to_owned()
        })
}

/// A tolerance in metres, not negative.
fn tolerance_m(text: &str) -> Result<f64, String> {
    let metres = text.trim().parse::<f64>().ok();
    metres
        .filter(|metres| (0.0..=100_000.0).contains(metres))
        // Minus nought too.
        .map(f64::abs)
        .ok_or_else(|| "must be from 0 to 100000 metres, for example 5".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_and_tolerances_are_read() {
        for good in ["129", " 2049", "8193"] {
            assert!(side(good).is_ok());
        }
        for bad in ["65", "128", "2048", "16385", "-129", "x", ""] {
            assert!(side(bad).is_err(), "{bad}");
        }
        assert_eq!(tolerance_m("2.5"), Ok(2.5));
        for bad in ["-1", "nan", "inf", "1e9", ""] {
            assert!(tolerance_m(bad).is_err(), "{bad}");
        }
    }
}
