//! The unfull quadtree of the 2005 paper over one grid of heights of any size, as its Table 1 measures it.
//!
//! | file | what |
//! |---|---|
//! | `tree.rs` | the tree and how it is built |
//! | `order.rs` | in which order its nodes stand in memory |
//! | `select.rs` | the leaves of a view, and their triangles |
//!
//! What draws the Earth is [`Quadtree`](terrella_ground::globe::quadtree::Quadtree); both share the squares and the bound on a leaf's error.

mod order;
mod select;
#[cfg(test)]
mod tests;
mod tree;

pub use order::Order;
pub use select::{ErrorMetric, SelectedLeaves, TreeView};
pub use tree::{GridQuadtree, MAX_POSTS, Merge, Posts, TreeError, TreeNode, TreeOptions};
