//! What a frame is prepared for.

use super::{EarthView, EyeView, Sky, Viewport};

/// What [`Earth::prepare`](super::Earth::prepare) and [`Earth::prepare_complete`](super::Earth::prepare_complete) prepare a frame for.
pub struct FrameRequest<'a, 'v> {
    /// The camera.
    pub eye: &'a EyeView,
    /// What lights the Earth.
    pub sky: &'a Sky,
    /// The target's width and height in pixels, or the part of it that the pass draws to.
    pub target: Viewport,
    /// Further pictures of the same frame.
    pub views: &'a mut [ViewFrame<'v>],
}

impl<'a, 'v> FrameRequest<'a, 'v> {
    /// Asks for one picture. `target` is the target's width and height in pixels, or the [`Viewport`] that the pass sets.
    pub fn new(eye: &'a EyeView, sky: &'a Sky, target: impl Into<Viewport>) -> Self {
        Self {
            eye,
            sky,
            target: target.into(),
            views: &mut [],
        }
    }

    /// Asks for these pictures besides. All that is submitted together must be prepared by one call: tiles that one picture
    /// is drawn with are then not overwritten for another.
    pub fn with_views(self, views: &'a mut [ViewFrame<'v>]) -> Self {
        Self { views, ..self }
    }
}

/// A further picture of a frame.
pub struct ViewFrame<'a> {
    /// What it is drawn by.
    pub view: &'a mut EarthView,
    /// The camera.
    pub eye: &'a EyeView,
    /// What lights the Earth in it.
    pub sky: &'a Sky,
    /// Its target's width and height in pixels, or the part of it that the pass draws to.
    pub target: Viewport,
}
