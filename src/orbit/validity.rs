//! The span that a feed answers for, and the ground that may cut it short.

use super::OrbitError;
use crate::frames::{Epoch, rfc3339};

/// Refuses an epoch outside `first` to `last`.
pub(super) fn check_span(
    satellite: &str,
    epoch: Epoch,
    (first, last): (Epoch, Epoch),
) -> Result<(), OrbitError> {
    if first <= epoch && epoch <= last {
        return Ok(());
    }
    Err(OrbitError::OutsideValidity {
        satellite: satellite.to_owned(),
        epoch: rfc3339(epoch),
        first: rfc3339(first),
        last: rfc3339(last),
    })
}

/// When a satellite left the ground and when it meets it, if it does in its span.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ground {
    pub left: Option<Epoch>,
    pub met: Option<Epoch>,
}

impl Ground {
    /// What it leaves of a span.
    pub fn cut(&self, (first, last): (Epoch, Epoch)) -> (Epoch, Epoch) {
        (self.left.unwrap_or(first), self.met.unwrap_or(last))
    }

    /// The impact that `epoch` is on the far side of.
    pub fn between(&self, epoch: Epoch) -> Option<Epoch> {
        let left = self.left.filter(|at| epoch < *at);
        left.or(self.met.filter(|at| epoch > *at))
    }
}
