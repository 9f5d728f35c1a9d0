//! Variants of the shader of satellites' tracks.

use super::variant::{ShaderVariant, TargetColor};

/// What a shader of tracks is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TracksVariant {
    /// Lines, marks or fills.
    pub kind: TrackKind,
    /// What the target stores.
    pub target: TargetColor,
}

/// What of tracks is drawn, each with a shader of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TrackKind {
    /// Trails and ground tracks.
    Lines,
    /// Dots, and rings on the ground.
    Marks,
    /// Footprints.
    Fills,
}

impl TrackKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Lines, Self::Marks, Self::Fills];
}

impl ShaderVariant for TracksVariant {
    const ENTRY: &'static str = "tracks.wgsl";

    fn all() -> Vec<Self> {
        let of_kind = |kind| TargetColor::ALL.map(|target| Self { kind, target });
        TrackKind::ALL.into_iter().flat_map(of_kind).collect()
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        vec![
            ("lines", self.kind == TrackKind::Lines),
            ("marks", self.kind == TrackKind::Marks),
            ("fills", self.kind == TrackKind::Fills),
            ("encode", self.target == TargetColor::Display),
        ]
    }
}
