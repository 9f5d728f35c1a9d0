//! The kinds of draws of the surface, each with its own pipeline.

use crate::plan::DrawLight;

/// A kind of draw: which part of the surface, under which light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PassKind {
    /// Everything, by day and by night.
    Everything,
    /// Without the layers that are visible only at night.
    Daylit,
    /// Without sunlight.
    Night,
    /// Cells in daylight that interpolate the air's light between vertices.
    Interpolated,
    /// Interpolated cells that have only land.
    Land,
    /// Interpolated cells that have only open sea.
    OpenSea,
    /// Everything, in frames with the Moon's shadow.
    Eclipsed,
    /// City lights as points, over the whole surface.
    CityLights,
    /// Clouds overhead, for an eye below them.
    CloudsOverhead,
    /// Clouds around an eye within them.
    CloudsAround,
    /// Clouds above the edge of the ground, for an eye outside the air.
    CloudsAtLimb,
    /// The same in frames with the Moon's shadow.
    EclipsedCloudsAtLimb,
}

impl PassKind {
    pub const COUNT: usize = 12;
    pub const ALL: [Self; Self::COUNT] = [
        Self::Everything,
        Self::Daylit,
        Self::Night,
        Self::Interpolated,
        Self::Land,
        Self::OpenSea,
        Self::Eclipsed,
        Self::CityLights,
        Self::CloudsOverhead,
        Self::CloudsAround,
        Self::CloudsAtLimb,
        Self::EclipsedCloudsAtLimb,
    ];

    /// The kind for a draw of a frame.
    pub fn of(light: DrawLight, has_moon_shadow: bool) -> Self {
        match light {
            _ if has_moon_shadow => Self::Eclipsed,
            DrawLight::Everything => Self::Everything,
            DrawLight::Daylit => Self::Daylit,
            DrawLight::Night => Self::Night,
            DrawLight::Interpolated => Self::Interpolated,
            DrawLight::Land => Self::Land,
            DrawLight::OpenSea => Self::OpenSea,
        }
    }

    /// Whether its pixels are those of the kind that replaces it, which takes longer.
    pub fn only_saves_time(self) -> bool {
        match self {
            Self::Daylit | Self::Night | Self::Interpolated | Self::Land | Self::OpenSea => true,
            Self::Everything
            | Self::Eclipsed
            | Self::CityLights
            | Self::CloudsOverhead
            | Self::CloudsAround
            | Self::CloudsAtLimb
            | Self::EclipsedCloudsAtLimb => false,
        }
    }

    /// Whether it draws clouds above the edge of the ground.
    pub fn is_at_limb(self) -> bool {
        matches!(self, Self::CloudsAtLimb | Self::EclipsedCloudsAtLimb)
    }

    /// The kind that replaces this one if it is not available.
    pub fn instead(self) -> Option<Self> {
        match self {
            Self::Everything
            | Self::CityLights
            | Self::CloudsOverhead
            | Self::CloudsAround
            | Self::CloudsAtLimb => None,
            Self::Daylit | Self::Night | Self::Eclipsed => Some(Self::Everything),
            Self::Interpolated => Some(Self::Daylit),
            Self::Land | Self::OpenSea => Some(Self::Interpolated),
            Self::EclipsedCloudsAtLimb => Some(Self::CloudsAtLimb),
        }
    }
}
