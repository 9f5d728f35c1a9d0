//! Formulas and pictures compared with `terrella_measure`: arithmetic of 320 bits, the reference renderer, the places that pixels show.

mod clear_air;
#[path = "../common/mod.rs"]
mod common;
mod contour_cast;
mod crossing;
mod extreme;
mod floor;
mod grid_forms;
mod hills;
mod picture_points;
mod reference;
mod reference_air;
mod reference_gpu;
mod relief_extremes;
mod report_sees;
mod surfaces_page;
mod whole_disc;

/// The repository's root.
const REPOSITORY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
