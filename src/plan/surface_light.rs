//! Options of the light on the surface.

use bytemuck::{Pod, Zeroable};
use std::ops::RangeInclusive;
use terrella_ground::air::THICKNESS_M;
use terrella_ground::step::smooth_step;
use terrella_imagery::SLOPE_EXAGGERATION;

/// Options of the light on the surface, with [`terrella_ground::globe::Shading::Sunlit`]. Options that belong to a map have no effect if the Earth
/// is made without it.
///
/// With the feature `serde` it is read and written under the names of its fields. A missing field has its default.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct SurfaceLight {
    /// Wind over the sea, metres a second at 12.5 m height, 0…30. By Cox and Munk 1954 the mean square slope of the waves that reflect the Sun is
    /// 0.003 + 0.00512 W; foam covers 2.95e-6 W^3.52 of the sea (Monahan and O'Muircheartaigh 1980).
    pub wind_m_s: f64,
    /// Exaggeration of the normal map's slopes in shading, 0…20; 1 is true. The map is assumed to be stored [`SLOPE_EXAGGERATION`] times too steep,
    /// as [`terrella_imagery::load_layers`] and packs do. For a map stored otherwise, scale the value.
    pub relief_exaggeration: f64,
    /// Height of the cloud layer, metres, 100…20 000.
    pub cloud_height_m: f64,
    /// Height of the tops of the thickest clouds above their thinnest edges, metres, 0…20 000.
    pub cloud_relief_m: f64,
    /// Whether clouds cast shadows on the ground: one more texture sample for each pixel.
    pub cloud_shadows: bool,
    /// Whether synthetic detail is added below the maps' texel size: the distribution of clouds, coasts, land and city lights within texels. It is
    /// fixed to the ground and approximately preserves the maps' means, but it is not data: leave it off for measurements.
    pub detail: bool,
    /// Whether the reflectance of land and clouds depends on direction: more light goes back to the Sun, where shadows are hidden, and clouds
    /// scatter forward at a low Sun. Otherwise they are Lambertian. The light over all directions is the same.
    pub directional_reflectance: bool,
    /// Whether the Moon lights land, sea, clouds and air, according to its phase.
    pub moonlight: bool,
    /// Whether the Moon's shadow falls on ground, clouds and air. Frames without the shadow are drawn without its cost.
    pub eclipses: bool,
    /// Whether airglow is drawn at night: see [`AIRGLOW_LUMINANCE`](super::AIRGLOW_LUMINANCE).
    pub airglow: bool,
    /// Planetary index of geomagnetic activity, 0…9, which sets position and brightness of the aurora; `None` draws none.
    pub kp: Option<f64>,
    /// Brightness of night lights relative to the true one, 0…1e6: of cities, Moon and airglow alike. The true radiance of the brightest cities is
    /// some 4e-6 of a white sheet in sunlight (see [`CITY_RADIANCE`]), twice that of one in the light of the full Moon. In an image exposed for
    /// daylight they are invisible.
    pub night_gain: f64,
    /// Whether that gain falls to 1 in images of sunlit ground or air: a camera exposed for daylight shows no lamps. With moonlight and without an aurora
    /// it also rises to ten times itself where the Moon is new or down. This is independent of the exposure: a fixed exposure also shows sunlit
    /// objects equally bright by day and by night.
    pub night_fades_by_day: bool,
}

macro_rules! effects {
    ($($(#[$doc:meta])* $effect:ident: $field:ident),* $(,)?) => {
        /// An effect of [`SurfaceLight`] that is on or off.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum LightEffect {
            $($(#[$doc])* $effect),*
        }

        impl LightEffect {
            /// All effects.
            pub const ALL: &[Self] = &[$(Self::$effect),*];

            /// The name of its field, its key in scenes and its condition in shaders.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$effect => stringify!($field)),*
                }
            }
        }

        impl SurfaceLight {
            /// The effects that are on.
            pub fn effects(&self) -> LightEffects {
                let mut on = LightEffects::NONE;
                $(if self.$field {
                    on = on.with(LightEffect::$effect);
                })*
                on
            }

            /// Switches an effect on or off.
            pub fn set_effect(&mut self, effect: LightEffect, is_on: bool) {
                match effect {
                    $(LightEffect::$effect => self.$field = is_on),*
                }
            }
        }
    };
}

effects! {
    /// [`SurfaceLight::cloud_shadows`].
    CloudShadows: cloud_shadows,
    /// [`SurfaceLight::detail`].
    Detail: detail,
    /// [`SurfaceLight::directional_reflectance`].
    DirectionalReflectance: directional_reflectance,
    /// [`SurfaceLight::moonlight`].
    Moonlight: moonlight,
    /// [`SurfaceLight::eclipses`].
    Eclipses: eclipses,
    /// [`SurfaceLight::airglow`].
    Airglow: airglow,
}

impl LightEffect {
    /// The effects of the surface's shader variants. An eclipse is in few frames, and airglow is above the surface.
    pub const OF_SURFACE: &[Self] = &[
        Self::CloudShadows,
        Self::Detail,
        Self::DirectionalReflectance,
        Self::Moonlight,
    ];
}

/// A set of effects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct LightEffects(u32);

impl LightEffects {
    pub const NONE: Self = Self(0);

    /// The set of these effects.
    pub const fn of(effects: &[LightEffect]) -> Self {
        let (mut set, mut i) = (Self::NONE, 0);
        while i < effects.len() {
            set = set.with(effects[i]);
            i += 1;
        }
        set
    }

    /// Whether the set has an effect.
    pub const fn has(self, effect: LightEffect) -> bool {
        self.0 >> effect as u32 & 1 == 1
    }

    /// The set with one more effect.
    pub const fn with(self, effect: LightEffect) -> Self {
        Self(self.0 | 1 << effect as u32)
    }

    pub const fn without(self, effect: LightEffect) -> Self {
        Self(self.0 & !(1 << effect as u32))
    }

    /// The effects in both sets.
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

/// Half the thickness of the clouds for an eye near them, metres, unless they are low.
const CLOUDS_REACH_M: f64 = 500.0;

/// Radiance of the brightest texels of the night map, relative to a white sheet that faces the Sun in space.
///
/// The Day/Night Band of VIIRS (0.5 to 0.9 µm) measures 50 to 150 nW/(cm² sr) over the centres of large cities at a scale of some kilometres
/// (Miller et al. 2013, Remote Sens. 5, 6717; Elvidge et al. 2017, Int. J. Remote Sens. 38, 5860); we use 80, that is 8e-4 W/(m² sr). In that band
/// the Sun's irradiance is some 620 W/m², and the radiance of a white sheet 620/π = 197 W/(m² sr).
pub const CITY_RADIANCE: f64 = 4.1e-6;

/// Equatorial radius that altitudes of clouds count from, metres.
const RADIUS_M: f64 = 6_378_137.0;
/// Height of the clouds above which they are drawn above the edge of the ground, pixels.
const LEAST_AT_LIMB_PX: f64 = 0.1;
/// Reflectance of foam, Koepke 1984.
const FOAM_REFLECTANCE: f64 = 0.22;

impl Default for SurfaceLight {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl SurfaceLight {
    /// A steady breeze, true slopes, clouds at 6 km, synthetic detail, directional reflectance, and city lights that are visible at a daylight
    /// exposure.
    pub const DEFAULT: Self = Self {
        wind_m_s: 7.0,
        relief_exaggeration: 1.0,
        cloud_height_m: 6_000.0,
        cloud_relief_m: 4_000.0,
        cloud_shadows: false,
        detail: true,
        directional_reflectance: true,
        moonlight: false,
        eclipses: false,
        airglow: false,
        kp: None,
        night_gain: 1.5e5,
        night_fades_by_day: true,
    };

    /// The default without any effect: Lambertian, without synthetic detail, and with one gain for all views. For measurements.
    pub const PLAIN: Self = Self {
        detail: false,
        directional_reflectance: false,
        night_fades_by_day: false,
        ..Self::DEFAULT
    };

    /// Range of [`Self::wind_m_s`].
    pub const WIND_M_S: RangeInclusive<f64> = 0.0..=30.0;
    /// Range of [`Self::relief_exaggeration`].
    pub const RELIEF_EXAGGERATION: RangeInclusive<f64> = 0.0..=20.0;
    /// Range of [`Self::cloud_height_m`].
    pub const CLOUD_HEIGHT_M: RangeInclusive<f64> = 100.0..=20_000.0;
    /// Range of [`Self::cloud_relief_m`].
    pub const CLOUD_RELIEF_M: RangeInclusive<f64> = 0.0..=20_000.0;
    /// Range of [`Self::kp`].
    pub const KP: RangeInclusive<f64> = 0.0..=9.0;
    /// Range of [`Self::night_gain`].
    pub const NIGHT_GAIN: RangeInclusive<f64> = 0.0..=1e6;

    /// The first number out of its range: name, value and range.
    pub(crate) fn out_of_range(&self) -> Option<(&'static str, f64, RangeInclusive<f64>)> {
        // Packs may store less steep slopes than maps: the compensating factor is included here.
        let relief = 0.0..=RELIEF_GAIN_MAX;
        [
            ("wind_m_s", self.wind_m_s, Self::WIND_M_S),
            ("relief_exaggeration", self.relief_exaggeration, relief),
            ("cloud_height_m", self.cloud_height_m, Self::CLOUD_HEIGHT_M),
            ("cloud_relief_m", self.cloud_relief_m, Self::CLOUD_RELIEF_M),
            ("kp", self.kp.unwrap_or(0.0), Self::KP),
            ("night_gain", self.night_gain, Self::NIGHT_GAIN),
        ]
        .into_iter()
        .find(|(_, value, range)| !range.contains(value))
    }

    /// Gain of airglow and aurora; `None` if neither is drawn.
    pub(crate) fn glow_gain(&self) -> Option<f64> {
        (self.airglow || self.kp.is_some()).then_some(self.night_gain)
    }

    /// Whether the air is drawn in the same way.
    pub(crate) fn has_air_of(&self, other: &Self) -> bool {
        self.moonlight == other.moonlight
            && self.eclipses == other.eclipses
            && self.airglow == other.airglow
            && self.kp.is_some() == other.kp.is_some()
    }

    /// Gain of moonlight; 0 if it is not drawn.
    pub(crate) fn moon_gain(&self) -> f64 {
        match self.moonlight {
            true => self.night_gain,
            false => 0.0,
        }
    }

    /// Radiance of the brightest city lights.
    pub(crate) fn lamp_light(&self) -> f64 {
        CITY_RADIANCE * self.night_gain
    }

    /// Fraction of the clouds that is in front of the ground for an eye at this height: 1 above them, 0 below. Between, the eye is within them.
    pub(crate) fn clouds_before(&self, eye_height_m: f64) -> f64 {
        let reach_m = self.clouds_reach_m();
        let within_m = [-reach_m, reach_m].map(|by_m| self.cloud_height_m + by_m);
        smooth_step(within_m, eye_height_m)
    }

    /// Fraction of the clouds that is drawn around an eye at this height: all for an eye within them, none at their thickness from their middle.
    pub(crate) fn clouds_around(&self, eye_height_m: f64) -> f64 {
        let from_middle_m = (eye_height_m - self.cloud_height_m).abs();
        let reach_m = self.clouds_reach_m();
        1.0 - smooth_step([reach_m, 2.0 * reach_m], from_middle_m)
    }

    /// Half the thickness of the clouds for an eye near them, metres: a tenth of their height if they are low.
    pub(crate) fn clouds_reach_m(&self) -> f64 {
        CLOUDS_REACH_M.min(0.1 * self.cloud_height_m)
    }

    /// Fraction of the clouds that is drawn above the edge of the ground for an eye at this height: 0 in the air, 1 from one and a half times its
    /// height, and 0 where the clouds are lower than a tenth of a pixel.
    pub(crate) fn clouds_at_limb(&self, eye_height_m: f64, pixel_rad: f64) -> f64 {
        let to_limb_m = (eye_height_m * (2.0 * RADIUS_M + eye_height_m))
            .max(0.0)
            .sqrt();
        if self.cloud_height_m < LEAST_AT_LIMB_PX * pixel_rad * to_limb_m {
            return 0.0;
        }
        smooth_step([THICKNESS_M, 1.5 * THICKNESS_M], eye_height_m)
    }

    /// Its uniforms.
    pub(crate) fn uniforms(&self) -> SurfaceLightUniforms {
        let wave_slope_squared = 0.003 + 0.00512 * self.wind_m_s;
        // Root mean square along one axis.
        let sigma = (0.5 * wave_slope_squared).sqrt();
        let cloud_height = self.cloud_height_m / RADIUS_M;
        SurfaceLightUniforms {
            wave_slope_squared: wave_slope_squared as f32,
            foam: (FOAM_REFLECTANCE * 2.95e-6 * self.wind_m_s.powf(3.52)) as f32,
            mirror_power: (5.0 * (-2.69 * sigma).exp()) as f32,
            mirror_scale: (1.0 / (1.0 + 22.7 * sigma.powf(1.5))) as f32,
            slope_gain: (self.relief_exaggeration / SLOPE_EXAGGERATION) as f32,
            cloud_height: cloud_height as f32,
            cloud_relief: (self.cloud_relief_m / RADIUS_M) as f32,
            cloud_dip: ((cloud_height * (2.0 + cloud_height)).sqrt() / (1.0 + cloud_height)) as f32,
        }
    }
}

/// `SurfaceLightUniforms` of `shaders/earth/bindings.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SurfaceLightUniforms {
    /// Mean square slope of the sea's waves.
    pub wave_slope_squared: f32,
    /// Reflectance of the sea's foam.
    pub foam: f32,
    /// Exponent of 1 − cos θ in the reflectance of waves for sky light.
    pub mirror_power: f32,
    /// Factor of that power.
    pub mirror_scale: f32,
    /// Factor of the normal map's slopes.
    pub slope_gain: f32,
    /// Height of the clouds, equatorial radii.
    pub cloud_height: f32,
    /// Height of the tops of thick clouds above thin ones, equatorial radii.
    pub cloud_relief: f32,
    /// Sine of the Sun's depression at which it sets at cloud height.
    pub cloud_dip: f32,
}

/// Largest factor of slopes, relative to a map that is stored [`SLOPE_EXAGGERATION`] times too steep: allows a map that is stored a hundred times
/// too flat.
const RELIEF_GAIN_MAX: f64 = 8_000.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_switch_their_own_fields_and_no_others() {
        for effect in LightEffect::ALL {
            let mut light = SurfaceLight::PLAIN;
            assert_eq!(light.effects(), LightEffects::NONE);
            light.set_effect(*effect, true);
            assert_eq!(light.effects(), LightEffects::of(&[*effect]));
            let others = LightEffect::ALL.iter().filter(|other| *other != effect);
            assert!(others.into_iter().all(|other| !light.effects().has(*other)));
            light.set_effect(*effect, false);
            assert_eq!(light, SurfaceLight::PLAIN);
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn it_is_read_by_the_names_of_its_fields_and_default_where_left_out() {
        let text = r#"{"wind_m_s": 3.5, "moonlight": true}"#;
        let light: SurfaceLight = serde_json::from_str(text).unwrap();
        let expected = SurfaceLight {
            wind_m_s: 3.5,
            moonlight: true,
            ..SurfaceLight::DEFAULT
        };
        assert_eq!(light, expected);
        let written = serde_json::to_string(&light).unwrap();
        assert_eq!(
            serde_json::from_str::<SurfaceLight>(&written).unwrap(),
            light
        );
        let error = serde_json::from_str::<SurfaceLight>(r#"{"wind": 3.5}"#).unwrap_err();
        assert!(
            error.to_string().contains("unknown field `wind`"),
            "{error}"
        );
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let good = SurfaceLight::default();
        assert_eq!(good.out_of_range(), None);
        for (light, name) in [
            (
                SurfaceLight {
                    wind_m_s: -1.0,
                    ..good
                },
                "wind_m_s",
            ),
            (
                SurfaceLight {
                    wind_m_s: f64::NAN,
                    ..good
                },
                "wind_m_s",
            ),
            (
                SurfaceLight {
                    relief_exaggeration: -1.0,
                    ..good
                },
                "relief_exaggeration",
            ),
            (
                SurfaceLight {
                    cloud_height_m: 0.0,
                    ..good
                },
                "cloud_height_m",
            ),
            (
                SurfaceLight {
                    cloud_relief_m: 1e5,
                    ..good
                },
                "cloud_relief_m",
            ),
            (
                SurfaceLight {
                    kp: Some(9.5),
                    ..good
                },
                "kp",
            ),
            (
                SurfaceLight {
                    night_gain: 2e6,
                    ..good
                },
                "night_gain",
            ),
        ] {
            let found = light.out_of_range().map(|(name, _, _)| name);
            assert_eq!(found, Some(name));
        }
    }

    #[test]
    fn clouds_see_the_sun_set_at_their_own_horizon() {
        // cos of the dip is R/(R + h).
        let light = SurfaceLight::default();
        let dip = (RADIUS_M / (RADIUS_M + light.cloud_height_m)).acos();
        assert!((f64::from(light.uniforms().cloud_dip) - dip.sin()).abs() < 1e-7);
        assert!((dip.to_degrees() - 2.48).abs() < 0.01);
    }
}
