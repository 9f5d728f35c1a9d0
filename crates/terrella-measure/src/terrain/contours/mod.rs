//! Contours of a whole elevation grid, of which [`ContourPages`](terrella_ground::globe::contours::ContourPages) draws many small ones: their tree,
//! built on threads, and its selection for a view.

mod build;
mod select;
#[cfg(test)]
mod tests;

pub use build::build_on;
pub use select::{screen_error_px, select, world_error_m};
pub use terrella_ground::globe::contours::cast::{Hit, Ray};
pub use terrella_ground::globe::contours::dem::{Dem, DemError, DemFrame};
pub use terrella_ground::globe::contours::tree::{BudgetError, ContourTree, Node, TreeStats};
