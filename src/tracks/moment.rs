//! When and from where a frame's tracks are seen.

use super::EarthTurn;
use crate::earth::{EyeView, Viewport};
use terrella_frames::{Epoch, Orientation};

/// Time, eye and orientation of a frame.
#[derive(Clone, Copy, Debug)]
pub struct TrackMoment<'m> {
    /// The epoch that the frame shows.
    pub epoch: Epoch,
    /// The Earth's present orientation, which transforms states to Earth-fixed axes.
    pub orientation: Orientation,
    /// Orientation and rotation rate of the Earth if they differ from those of the epoch: in a simulation with its own.
    pub turn: Option<EarthTurn>,
    /// The view from the eye.
    pub view: &'m EyeView,
    /// The part of the target that the pass draws to.
    pub target: Viewport,
}

impl<'m> TrackMoment<'m> {
    /// With the Earth's orientation of this epoch without measured corrections.
    pub fn new(epoch: Epoch, view: &'m EyeView, target: impl Into<Viewport>) -> Self {
        Self {
            epoch,
            orientation: Orientation::default(),
            turn: None,
            view,
            target: target.into(),
        }
    }
}
