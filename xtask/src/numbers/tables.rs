//! The generated texts and their recorded runs.

use super::markdown::{as_recorded, whereabouts};
use super::record::Recorded;
use super::{air, bench, orbits, peers, report, stability, surfaces, terrain};

/// A generated text between markers.
pub struct Table {
    /// Name in the marker.
    pub name: &'static str,
    /// Name of the recorded run.
    pub recording: &'static str,
    /// Generates the text; [`as_recorded`] if the table's columns are the recorded ones.
    pub text: fn(&Recorded) -> anyhow::Result<String>,
}

/// Shortens the entries.
const fn table(
    name: &'static str,
    recording: &'static str,
    text: fn(&Recorded) -> anyhow::Result<String>,
) -> Table {
    Table {
        name,
        recording,
        text,
    }
}

/// All tables.
pub const TABLES: &[Table] = &[
    table("clear_air_clear", "clear_air", |run| {
        air::errors(run, "clear")
    }),
    table("clear_air_hazy", "clear_air", |run| {
        air::errors(run, "hazy")
    }),
    table("clear_air_colors_clear", "clear_air_colors", |run| {
        air::colors(run, "A")
    }),
    table("clear_air_colors_hazy", "clear_air_colors", |run| {
        air::colors(run, "B")
    }),
    table("readme_air_from_space", "clear_air", |run| {
        air::largest_median(run, "ground")
    }),
    table("readme_air_in_the_sky", "clear_air", |run| {
        air::largest_median(run, "sky")
    }),
    table("report_defaults", "report_defaults", as_recorded),
    table("report_range", "report_defaults", report::range),
    table("report_settings", "report_settings", as_recorded),
    table("table_2", "bench", bench::table_2),
    table("bench_heights", "bench", bench::heights),
    table("bench_in_the_air", "bench", bench::in_the_air),
    table("bench_features", "bench", bench::features),
    table("bench_fixed", "bench", bench::fixed),
    table("bench_least", "bench", bench::least),
    table("bench_run", "bench", whereabouts),
    table("stability", "stability", stability::forms),
    table("surfaces_globe", "surfaces", |run| {
        surfaces::section(run, "globe")
    }),
    table("surfaces_scene", "surfaces", |run| {
        surfaces::section(run, "scene")
    }),
    table("surfaces_worst_case", "surfaces", |run| {
        surfaces::section(run, "worst_case")
    }),
    table("surfaces_settings", "surfaces", |run| {
        surfaces::section(run, "settings")
    }),
    table("surfaces_settling", "surfaces", |run| {
        surfaces::section(run, "settling")
    }),
    table("surfaces_default", "surfaces", |run| {
        surfaces::section(run, "default")
    }),
    table("surfaces_findings", "surfaces", |run| {
        surfaces::section(run, "findings")
    }),
    table("surfaces_published", "surfaces", |run| {
        surfaces::section(run, "published")
    }),
    table("surfaces_run", "surfaces", whereabouts),
    table("farm", "farm", as_recorded),
    table("farm_growth", "farm_growth", as_recorded),
    table("peers", "peers", |run| {
        peers::heights(run, "VTK", "ratio_to_vtk")
    }),
    table("peers_ratios", "peers", peers::ratios),
    table("peers_run", "peers", whereabouts),
    table("web_peers", "web_peers", |run| {
        peers::heights(run, "CesiumJS", "ratio_to_cesiumjs")
    }),
    table("web_peers_ratios", "web_peers", peers::web_ratios),
    table("web_peers_run", "web_peers", whereabouts),
    table("streaming", "streaming", as_recorded),
    table("sky_places", "sky_places", as_recorded),
    table("light_costs", "light_costs", as_recorded),
    table("composition", "composition", as_recorded),
    table("composition_run", "composition", whereabouts),
    table("air_schemes", "air_schemes", as_recorded),
    table("truth_errors", "truth_errors", as_recorded),
    table("extreme_views", "extreme_views", as_recorded),
    table("interpolation_low", "interpolation", |run| {
        orbits::interpolation(run, "low")
    }),
    table("interpolation_molniya", "interpolation", |run| {
        orbits::interpolation(run, "Molniya")
    }),
    table("orbit_errors", "orbits", orbits::errors),
    table("orbit_times", "orbits", orbits::times),
    table("orbit_spread", "orbits", orbits::spread),
    table("orbit_drifts", "orbits", orbits::drifts),
    table("orbits_run", "orbits", whereabouts),
    table("terrain_quadtree", "terrain_quadtree", as_recorded),
    table("terrain_storage", "terrain_storage", as_recorded),
    table("terrain_building", "terrain_building", as_recorded),
    table("terrain_orders", "terrain_orders", terrain::orders),
    table("terrain_conditions", "terrain_conditions", as_recorded),
];
