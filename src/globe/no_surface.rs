//! In place of `surface.rs` where the feature `terrain` is off: there is no ground with relief to draw.

pub use super::surface_stats::SurfaceStats;
use std::convert::Infallible;
use std::marker::PhantomData;

/// A way to draw ground that has relief. Nothing implements it without the feature `terrain`.
pub trait Surface: Send {
    /// In what form it is drawn.
    fn form(&self) -> GroundForm<'_>;

    /// Whether it has patches that lie in several blocks.
    fn crosses_blocks(&self) -> bool;
}

/// In what form a surface hands over what is drawn: without the feature `terrain` in none.
#[derive(Clone, Copy, Debug)]
pub struct GroundForm<'a>(pub Infallible, PhantomData<&'a ()>);
