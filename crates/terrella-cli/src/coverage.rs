//! `terrella coverage`

use super::scene_args::{SceneArgs, SelectionArgs};
use super::{Common, print, values};
use clap::Args;
use std::f64::consts::FRAC_PI_2;
use std::path::PathBuf;
use terrella::frames::Duration;
use terrella_orbit::{FieldOfView, FieldShape, GroundSensor};
use terrella_play::{CoverageMap, CoverageRequest, PendingFile};

/// Arguments of `terrella coverage`.
#[derive(Debug, Args)]
pub struct CoverageArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    satellites: SelectionArgs,
    /// Half angle of the sensors' conical field of view, degrees [default: all ground in sight]
    #[arg(long, value_name = "DEGREES", value_parser = values::half_angle_deg)]
    half_angle: Option<f64>,
    /// Half angles of rectangular fields of view along and across the flight, degrees
    #[arg(long, value_name = "ALONG,ACROSS", value_parser = values::half_angles_deg, conflicts_with = "half_angle")]
    rectangle: Option<[f64; 2]>,
    /// Angle of the sensors' boresight off nadir, degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::off_nadir_deg, default_value = "0")]
    off_nadir: f64,
    /// Direction of the boresight off nadir, degrees clockwise from the direction of flight
    #[arg(long, value_name = "DEGREES", value_parser = values::azimuth_deg, allow_hyphen_values = true, default_value = "90")]
    azimuth: f64,
    /// Minimum elevation of the satellite above the ground's horizon, degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::elevation_deg, default_value = "5")]
    min_elevation: f64,
    /// Side of a cell of the ground, degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::cell_deg, default_value = "5")]
    step: f64,
    /// Region: west, south, east and north in degrees
    #[arg(long, value_name = "W,S,E,N", value_parser = values::region_deg, allow_hyphen_values = true, default_value = "-180,-90,180,90")]
    region: [f64; 4],
    /// Number of days from the scene's start [default: to the scene's end]
    #[arg(long, value_name = "N", value_parser = values::days)]
    days: Option<f64>,
    /// Print a row of CSV for each cell
    #[arg(long)]
    csv: bool,
    /// Write a map of the longest gaps, which a scene draws with [[geojson]]
    #[arg(long, value_name = "FILE")]
    geojson: Option<PathBuf>,
}

impl CoverageArgs {
    fn field(&self) -> FieldOfView {
        let shape = match self.rectangle.map(|angles| angles.map(f64::to_radians)) {
            Some([along_rad, across_rad]) => FieldShape::Rectangle {
                along_rad,
                across_rad,
            },
            None => FieldShape::Cone {
                half_angle_rad: self.half_angle.map_or(FRAC_PI_2, f64::to_radians),
            },
        };
        FieldOfView {
            shape,
            off_nadir_rad: self.off_nadir.to_radians(),
            azimuth_rad: self.azimuth.to_radians(),
        }
    }
}

/// Prints the coverage of a region and writes the map.
pub fn run(args: &CoverageArgs, _: &Common) -> anyhow::Result<()> {
    // Create the file before any computation, so that a file that cannot be written fails at once.
    let map_file = args
        .geojson
        .as_ref()
        .map(|path| PendingFile::create(path, "maps of coverage", "geojson"))
        .transpose()?;
    let flight = args.satellites.open(&args.scene)?;
    let satellites = args.satellites.select(&flight)?;
    let sensor = GroundSensor {
        field: args.field(),
        min_elevation_rad: args.min_elevation.to_radians(),
    };
    let sensors: Vec<_> = satellites.iter().map(|one| (*one, sensor)).collect();
    let request = CoverageRequest {
        step_deg: args.step,
        region_deg: args.region,
        length: args.days.map(Duration::from_days),
    };
    let map = CoverageMap::new(&flight, &sensors, &request)?;
    if let Some(file) = map_file {
        file.write_whole(map.geojson().as_bytes())?;
    }
    print(&match args.csv {
        true => map.csv(),
        false => map.text(),
    })
}
