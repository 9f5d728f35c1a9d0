//! Ground as an unfull quadtree (the 2005 paper): large leaves where the data are flat or far, small ones elsewhere.
//!
//! [`Quadtree`] draws the Earth. Its grid of squares (`Node`), the rule that keeps edges whole (`ring`) and the bound on
//! what a leaf is off by (`leaf_error`) serve the tree over one grid of heights that `measure::terrain` measures too.
//!
//! A leaf is drawn as a fan from its centre to its corners and to every point that finer leaves beside have on its edges. So
//! leaves of any two levels may meet, every edge has the same points on both sides, and no point is ever moved.
//!
//! The publication merges squares of one height in Morton order and keeps its nodes interleaved. The forest that is drawn does
//! neither, since it is never whole in memory; `measure::terrain` measures both over one grid.
//!
//! The Earth is a forest of 128 trees, one to a block of 22.5°. It is read lazily, square by square, as the eye comes
//! near: a whole tree over fine data would not fit in memory, small maps would be missed by looking from afar, and what is
//! read is forgotten again within a budget. A frame changes as many leaves as its own budget allows, and then builds
//! every patch that a change touches: what is drawn is whole at all times, and at most late.

mod bound;
mod changed;
mod forest;
mod lod;
mod node;
mod page;
mod partition;
mod patch;
mod surface;
#[cfg(test)]
mod tests;

pub use bound::{LeafError, leaf_error};
pub use lod::SplitRule;
pub use node::{Among, Cut, Domain, Node, Point, Side, Square, among, child_among, ring};
pub use surface::{Quadtree, QuadtreeOptions};
