//! Replaces `surface/` without the feature `terrain`: there is no terrain to draw.

pub use super::surface_stats::SurfaceStats;
use std::convert::Infallible;
use std::marker::PhantomData;

/// A way to draw terrain. Nothing implements it without the feature `terrain`.
pub trait Surface: Send {
    /// How it is drawn.
    fn draw_kind(&self) -> DrawKind<'_>;

    /// Whether patches may span several blocks.
    fn crosses_blocks(&self) -> bool;
}

/// How a surface is drawn; impossible without the feature `terrain`.
#[derive(Clone, Copy, Debug)]
pub struct DrawKind<'a>(pub Infallible, PhantomData<&'a ()>);
