//! Terrain as an unfull quadtree (the 2005 paper): large leaves where the data are flat or far, small ones elsewhere.
//!
//! [`Quadtree`] draws the Earth. It shares three parts with the tree over one grid of heights that `measure::terrain` measures: the grid of
//! squares (`Node`), the rule that keeps edges closed (`ring`) and the error bound of a leaf (`leaf_error`).
//!
//! A leaf is drawn as a fan from its centre to its corners and to every point that adjacent finer leaves have on its edges. Leaves of any
//! two levels may therefore meet, every edge has the same points on both sides, and no point is ever moved.
//!
//! The publication merges squares of one height in Morton order and keeps its nodes interleaved. The drawn forest does neither, since it is
//! never whole in memory; `measure::terrain` measures both over one grid.
//!
//! The Earth is a forest of 128 trees, one for each block of 22.5°. It is read lazily, square by square, as the eye comes near. A whole
//! tree over fine data would not fit in memory, and small maps would be missed from afar. Squares are evicted within a budget. A frame
//! changes as many leaves as its own budget allows, and then builds every patch that a change touches. The drawn surface is always closed,
//! and at worst late.

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
