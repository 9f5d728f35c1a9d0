//! Stars, the Milky Way, Sun and Moon behind the Earth.

use crate::EarthFault;
use bevy::ecs::component::Component;
use bevy::ecs::reflect::ReflectComponent;
use bevy::reflect::Reflect;
use bevy::reflect::std_traits::ReflectDefault;
use terrella::MapFolder;
use terrella::celestial::{CelestialOptions, CelestialSelection};

/// Draws the sky beyond the Earth for all of the Earth's cameras. Put it on the entity of the [`Earth`](crate::Earth). Without it, space has the
/// clear colour of Bevy's camera.
///
/// The star catalogue and the maps of Milky Way and Moon come from the Earth's map folder. For [`EarthMaps::Memory`](crate::EarthMaps::Memory) they
/// come from the starter maps. After a change the Earth is rebuilt.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Clone, Debug, Default, PartialEq)]
pub struct EarthCelestial {
    /// Stars of the Hipparcos catalogue.
    pub stars: bool,
    /// The Milky Way.
    pub milky_way: bool,
    /// The Sun's disc.
    pub sun: bool,
    /// The Moon.
    pub moon: bool,
    /// Glare: sunlight that lens and eye scatter around the Sun.
    pub glare: bool,
    /// Brightness gain of stars and Milky Way, 0 or more; 1 is realistic.
    pub star_gain: f64,
    /// Whether that gain falls to 1 where the camera shows sunlit ground or atmosphere.
    pub stars_fade_by_day: bool,
}

impl Default for EarthCelestial {
    /// Everything enabled, with the library's defaults.
    fn default() -> Self {
        Self {
            stars: true,
            milky_way: true,
            sun: true,
            moon: true,
            glare: true,
            star_gain: CelestialOptions::STAR_GAIN,
            stars_fade_by_day: true,
        }
    }
}

impl From<EarthCelestial> for CelestialSelection {
    fn from(sky: EarthCelestial) -> Self {
        Self {
            stars: sky.stars,
            milky_way: sky.milky_way,
            sun: sky.sun,
            moon: sky.moon,
            glare: sky.glare,
        }
    }
}

impl EarthCelestial {
    /// A comparison key; a NaN gain equals itself.
    pub(crate) fn key(self) -> (CelestialSelection, u64, bool) {
        (
            self.into(),
            self.star_gain.to_bits(),
            self.stars_fade_by_day,
        )
    }

    /// The library's options, with maps from a folder.
    pub(crate) fn options(self, folder: MapFolder<'_>) -> Result<CelestialOptions, EarthFault> {
        Ok(CelestialOptions {
            star_gain: self.star_gain,
            stars_fade_by_day: self.stars_fade_by_day,
            ..CelestialOptions::load(folder, self.into())?
        })
    }
}
