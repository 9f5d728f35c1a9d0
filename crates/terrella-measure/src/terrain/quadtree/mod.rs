//! The unfull quadtree of the 2005 paper over one elevation grid of any size, as in its Table 1.
//!
//! | file | content |
//! |---|---|
//! | `tree.rs` | the tree and its construction |
//! | `order.rs` | order of its nodes in memory |
//! | `select.rs` | the leaves of a view, and their triangles |
//!
//! The Earth is drawn with [`Quadtree`](terrella_ground::globe::quadtree::Quadtree); both share the squares and the bound on a leaf's error.

mod order;
mod select;
#[cfg(test)]
mod tests;
mod tree;

pub use order::Order;
pub use select::{ErrorMetric, SelectedLeaves, TreeView};
pub use tree::{GridQuadtree, MAX_POSTS, Merge, Posts, TreeError, TreeNode, TreeOptions};
