//! In place of `surface/` where the feature `terrain` is off: there is no terrain to draw.

pub use super::surface_stats::SurfaceStats;
use std::convert::Infallible;
use std::marker::PhantomData;

/// A way to draw ground that has relief. Nothing implements it without the feature `terrain`.
pub trait Surface: Send {
    /// How it is drawn.
    fn draw_kind(&self) -> DrawKind<'_>;

    /// Whether it has patches that lie in several blocks.
    fn crosses_blocks(&self) -> bool;
}

/// How a surface is drawn, and what with: without the feature `terrain` in no way.
#[derive(Clone, Copy, Debug)]
pub struct DrawKind<'a>(pub Infallible, PhantomData<&'a ()>);
