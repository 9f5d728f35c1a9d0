//! Contours of a whole grid of heights, of which [`ContourPages`](crate::globe::contours::ContourPages) draw many small ones:
//! their tree built on threads, selected from by a view, and as bytes.

mod build;
mod select;
mod serialize;
#[cfg(test)]
mod tests;

pub use crate::globe::contours::cast::{Hit, Ray};
pub use crate::globe::contours::dem::{Dem, DemError, DemFrame};
pub use crate::globe::contours::tree::{BudgetError, ContourTree, Node, TreeStats};
pub use select::{screen_error_px, world_error_m};
