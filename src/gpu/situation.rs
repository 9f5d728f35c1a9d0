//! What the choice of a pipeline of the surface depends on besides the kind of draw.

use crate::plan::{DetailScales, FramePlan};

/// Where a frame is seen from, and what its pixels can show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Situation {
    /// Index of the side of the air: 0 without air; otherwise 0 for an eye outside it and 1 for an eye inside.
    pub side: usize,
    pub scales: DetailScales,
}

impl Situation {
    /// That of a plan, with these scales.
    pub fn of(plan: &FramePlan, scales: DetailScales) -> Self {
        let side = plan.air.as_ref().map_or(0, |air| air.side() as usize);
        Self { side, scales }
    }

    /// All with so many sides of the air.
    pub fn all(sides: usize) -> impl Iterator<Item = Self> {
        (0..sides).flat_map(|side| DetailScales::ALL.map(|scales| Self { side, scales }))
    }
}
