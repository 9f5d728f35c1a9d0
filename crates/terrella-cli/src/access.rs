//! `terrella access`

use super::scene_args::{SceneArgs, SelectionArgs};
use super::{Common, print, values};
use clap::Args;
use terrella::frames::{Duration, Geodetic};
use terrella_orbit::AccessRule;
use terrella_play::{AccessRequest, AccessTable, Layout};

/// Arguments of `terrella access`.
#[derive(Debug, Args)]
pub struct AccessArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    satellites: SelectionArgs,
    /// Add a ground station: latitude and longitude in degrees, south and west negative, optionally the height in metres above the ellipsoid, and a name; repeatable
    #[arg(long, value_name = "LAT,LON[,HEIGHT][,NAME]", value_parser = values::station, allow_hyphen_values = true)]
    place: Vec<(Geodetic, String)>,
    /// With --place: minimum elevation above the horizon, degrees; [[station]] tables have their own
    #[arg(long, value_name = "DEGREES", value_parser = values::elevation_deg, default_value = "5", requires = "place")]
    min_elevation: f64,
    /// Also print when satellites have access to each other: when the line between them does not meet the Earth
    #[arg(long)]
    crosslinks: bool,
    /// With --crosslinks: minimum height of that line above the ellipsoid, km
    #[arg(long, value_name = "KM", value_parser = values::grazing_height_km, default_value = "0", requires = "crosslinks")]
    grazing_height: f64,
    /// Maximum range, km
    #[arg(long, value_name = "KM", value_parser = values::range_km)]
    max_range: Option<f64>,
    /// Only while the satellite is outside the Earth's umbra; with --crosslinks: the second satellite of the two
    #[arg(long)]
    sunlit: bool,
    /// Number of days from the scene's start, as far as the orbits are valid [default: to the scene's end]
    #[arg(long, value_name = "N", value_parser = values::days)]
    days: Option<f64>,
    /// Print CSV
    #[arg(long, conflicts_with = "json")]
    csv: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Prints the accesses of a scene.
pub fn run(args: &AccessArgs, _: &Common) -> anyhow::Result<()> {
    let flight = args.satellites.open_with(&args.scene, |scene| {
        for (place, name) in &args.place {
            scene.add_station(name, *place, args.min_elevation);
        }
    })?;
    let satellites = args.satellites.select(&flight)?;
    let request = AccessRequest {
        rule: AccessRule {
            max_range_m: args.max_range.map_or(f64::INFINITY, |km| 1e3 * km),
            min_height_m: 1e3 * args.grazing_height,
            needs_sunlight: args.sunlit,
        },
        has_crosslinks: args.crosslinks,
        length: args.days.map(Duration::from_days),
    };
    let layout = Layout::of(args.csv, args.json);
    let tables = AccessTable::all(&flight, &satellites, &request)?;
    print(&AccessTable::print(&tables, layout))
}
