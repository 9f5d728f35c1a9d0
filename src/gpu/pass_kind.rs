//! The ways that the surface is drawn, each by a pipeline of its own.

use crate::plan::DrawLight;

/// What part of the surface is drawn, and when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PassKind {
    /// All, by day and by night.
    Everything,
    /// Without what shows by night alone, if there is any.
    Daylit,
    /// Cells by day that take the air's light from their vertices.
    Interpolated,
    /// Those of them where there is nothing but land.
    Land,
    /// Those where there is nothing but open sea.
    OpenSea,
    /// All, in frames that the Moon's shadow is in.
    Eclipsed,
    /// City lights as points, over all of it.
    CityLights,
    /// Clouds in the sky over an eye below them.
    CloudsOverhead,
}

impl PassKind {
    pub const COUNT: usize = 8;
    pub const ALL: [Self; Self::COUNT] = [
        Self::Everything,
        Self::Daylit,
        Self::Interpolated,
        Self::Land,
        Self::OpenSea,
        Self::Eclipsed,
        Self::CityLights,
        Self::CloudsOverhead,
    ];

    /// What a draw of a frame is drawn by.
    pub fn of(light: DrawLight, has_moon_shadow: bool) -> Self {
        match light {
            _ if has_moon_shadow => Self::Eclipsed,
            DrawLight::Everything => Self::Everything,
            DrawLight::Daylit => Self::Daylit,
            DrawLight::Interpolated => Self::Interpolated,
            DrawLight::Land => Self::Land,
            DrawLight::OpenSea => Self::OpenSea,
        }
    }

    /// What draws the same where that is not to be had.
    pub fn instead(self) -> Option<Self> {
        match self {
            Self::Everything | Self::CityLights | Self::CloudsOverhead => None,
            Self::Daylit | Self::Eclipsed => Some(Self::Everything),
            Self::Interpolated => Some(Self::Daylit),
            Self::Land | Self::OpenSea => Some(Self::Interpolated),
        }
    }
}
