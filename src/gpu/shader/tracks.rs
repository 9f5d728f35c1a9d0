//! Variants of the shader of satellite tracks.

use super::variant::{ShaderVariant, TargetColor};
use crate::plan::AirSide;

/// Variant of the tracks shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TracksVariant {
    /// Lines, marks, fills or polygons.
    pub kind: TrackKind,
    /// What the target stores.
    pub target: TargetColor,
    /// The side of the air that the eye is on; `None` without air.
    pub air: Option<AirSide>,
}

/// A kind of track element, each with its own shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TrackKind {
    /// Trails and ground tracks.
    Lines,
    /// Lines on the ground with short segments: the air before them is computed at their vertices.
    GroundLines,
    /// Dots, and rings on the ground.
    Marks,
    /// Footprints.
    Fills,
    /// Polygons on the ground.
    Polygons,
}

impl TrackKind {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Lines,
        Self::GroundLines,
        Self::Marks,
        Self::Fills,
        Self::Polygons,
    ];
}

impl ShaderVariant for TracksVariant {
    const ENTRY: &'static str = "tracks.wgsl";

    fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for kind in TrackKind::ALL {
            for air in AirSide::OR_NONE {
                if kind == TrackKind::GroundLines && air.is_none() {
                    // They are drawn as other lines.
                    continue;
                }
                all.extend(TargetColor::USUAL.map(|target| Self { kind, target, air }));
            }
        }
        all
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        let mut conditions = vec![
            (
                "lines",
                matches!(self.kind, TrackKind::Lines | TrackKind::GroundLines),
            ),
            ("at_vertices", self.kind == TrackKind::GroundLines),
            ("marks", self.kind == TrackKind::Marks),
            ("fills", self.kind == TrackKind::Fills),
            ("polygons", self.kind == TrackKind::Polygons),
            ("air", self.air.is_some()),
            ("inside", self.air == Some(AirSide::Inside)),
            // Spacecraft in moonlit air are drawn as in a night without the Moon.
            ("moonlight", false),
        ];
        conditions.extend(self.target.conditions());
        conditions
    }
}
