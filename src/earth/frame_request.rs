//! The request that a frame is prepared for.

use super::{EarthView, EyeView, Sky, Viewport};

/// The request that [`Earth::prepare`](super::Earth::prepare) and [`Earth::prepare_complete`](super::Earth::prepare_complete) prepare a frame for.
pub struct FrameRequest<'a, 'v> {
    /// The camera.
    pub eye: &'a EyeView,
    /// Sun, Moon and stars.
    pub sky: &'a Sky,
    /// The target's width and height in pixels, or the part of it that the pass draws to.
    pub target: Viewport,
    /// Further images of the same frame.
    pub views: &'a mut [ViewFrame<'v>],
}

impl<'a, 'v> FrameRequest<'a, 'v> {
    /// Requests one image. `target` is the target's width and height in pixels, or the [`Viewport`] that the pass sets.
    pub fn new(eye: &'a EyeView, sky: &'a Sky, target: impl Into<Viewport>) -> Self {
        Self {
            eye,
            sky,
            target: target.into(),
            views: &mut [],
        }
    }

    /// Requests further images. All images that are submitted together must be prepared by one call: tiles that one of them is drawn with are then
    /// not overwritten for another.
    pub fn with_views(self, views: &'a mut [ViewFrame<'v>]) -> Self {
        Self { views, ..self }
    }
}

/// A further image of a frame.
pub struct ViewFrame<'a> {
    /// The view to draw.
    pub view: &'a mut EarthView,
    /// The camera.
    pub eye: &'a EyeView,
    /// Sun, Moon and stars of this image.
    pub sky: &'a Sky,
    /// Its target's width and height in pixels, or the part of it that the pass draws to.
    pub target: Viewport,
}
