//! Exposure of frames: fixed, or metered from the view.

use super::daylight::{daylight_in_sight, gain_beside, gain_by_night, lamps_in_sight};
use super::view::ItrfView;
use super::{Appearance, EarthOptions, EyeView, Sky, SurfaceLight, Viewport};
use crate::gpu::{LAMPS_FULL_SIN, LAMPS_OUT_SIN};
use crate::plan::{AIRGLOW_LUMINANCE, GLOW_DAY_SIN, GLOW_NIGHT_SIN, LAYER_HEIGHTS};
use glam::DVec3;
use std::sync::Arc;
use terrella_frames::{Ellipsoid, MoonShadow};
use terrella_ground::air::{AirOptions, AirTables, Atmosphere};
use terrella_ground::light::{Exposure, Lamps, Meter, MeterView, NightLight};
use terrella_imagery::NeighbourhoodAlbedo;
use terrella_imagery::tile::MAP_LAYERS;

/// Chooses the exposure of the frames of one view. Clones share the meter.
#[derive(Clone)]
pub(super) struct ExposureControl {
    exposure: Exposure,
    light: SurfaceLight,
    /// Whether there are city lights.
    has_lamps: bool,
    /// Created when exposure is first metered; an Earth that never meters has none.
    meter: Option<Arc<Meter>>,
    /// Inputs of the meter.
    albedo: Arc<NeighbourhoodAlbedo>,
    lamps: Arc<Lamps>,
    air: Option<AirOptions>,
    air_options: AirOptions,
}

impl ExposureControl {
    /// Exposure control for an Earth with these options.
    pub fn new(options: &EarthOptions, atmosphere: Atmosphere) -> Self {
        let albedo = albedo_of(options);
        let mut control = Self {
            exposure: options.exposure,
            light: options.light,
            has_lamps: has_lamps(options),
            lamps: Arc::new(Lamps::new(albedo.lamps())),
            albedo: Arc::new(albedo),
            air: None,
            air_options: options.air,
            meter: None,
        };
        control.set_air(atmosphere);
        control
    }

    /// Uses this exposure from now on.
    pub fn set(&mut self, exposure: Exposure) {
        self.exposure = exposure;
        self.make_ready();
    }

    /// Uses this air from now on.
    pub fn set_air(&mut self, atmosphere: Atmosphere) {
        let air = (atmosphere != Atmosphere::None).then_some(self.air_options);
        if self.air != air {
            self.air = air;
            self.meter = None;
        }
        self.make_ready();
    }

    /// Uses this light from now on, and these contents of the air from the next [`Self::set_air`] on.
    pub fn set_appearance(&mut self, appearance: &Appearance) {
        self.light = appearance.light;
        self.air_options = appearance.air;
    }

    /// Shares the meter and its inputs with another control from now on.
    pub fn share(&mut self, other: &Self) {
        let exposure = self.exposure;
        *self = other.clone();
        self.set(exposure);
    }

    /// Mean albedo of the maps' neighbourhoods.
    pub fn albedo(&self) -> &Arc<NeighbourhoodAlbedo> {
        &self.albedo
    }

    /// Meters over ground of this albedo from now on.
    pub fn set_albedo(&mut self, albedo: &Arc<NeighbourhoodAlbedo>) {
        if !Arc::ptr_eq(&self.albedo, albedo) {
            self.albedo = albedo.clone();
            self.lamps = Arc::new(Lamps::new(albedo.lamps()));
            self.meter = None;
            self.make_ready();
        }
    }

    fn make_ready(&mut self) {
        if self.exposure == Exposure::Auto {
            self.meter();
        }
    }

    fn meter(&mut self) -> &Meter {
        let (albedo, lamps, air) = (&self.albedo, &self.lamps, &self.air);
        self.meter.get_or_insert_with(|| {
            let air = air.as_ref().map(AirTables::shared);
            let texels = albedo.texels(&[true; MAP_LAYERS]);
            Arc::new(Meter::new(texels, lamps.clone(), air))
        })
    }

    /// The light of a frame, with the gain of night lights reduced by the daylight in it. Allocates nothing.
    pub fn light_in(&self, view: &ItrfView, sky: &Sky, ellipsoid: &Ellipsoid) -> SurfaceLight {
        let lamps = self.has_lamps.then_some(&*self.lamps);
        light_beside(&self.light, lamps, view, sky, ellipsoid)
    }

    /// The exposure of a frame with this light, EV.
    pub fn ev(
        &mut self,
        view: &ItrfView,
        sky: &Sky,
        ellipsoid: &Ellipsoid,
        light: &SurfaceLight,
    ) -> f64 {
        match self.exposure {
            Exposure::Ev(ev) => ev,
            Exposure::Auto => self.metered(view, sky, ellipsoid, light),
        }
    }

    /// The metered exposure of a view, EV.
    fn metered(
        &mut self,
        view: &ItrfView,
        sky: &Sky,
        ellipsoid: &Ellipsoid,
        light: &SurfaceLight,
    ) -> f64 {
        let itrf_from_scaled = ellipsoid.itrf_from_scaled();
        let (moon_itrf, moon_light) = sky.moonlight();
        let moon_light = (light.moon_gain() * moon_light) as f32;
        let shadow = self.shadow_of(sky, ellipsoid);
        let night = self.night(light);
        self.meter().ev(&MeterView {
            eye_scaled: view.eye_itrf_m / itrf_from_scaled,
            itrf_from_scaled,
            clip_from_eye: &view.clip_from_eye,
            lights: [(sky.sun_itrf, 1.0), (moon_itrf, moon_light)],
            shadow,
            night,
        })
    }

    /// Light of the night side, as it is drawn.
    fn night(&self, light: &SurfaceLight) -> NightLight {
        let airglow = match light.airglow && self.air.is_some() {
            true => AIRGLOW_LUMINANCE * light.night_gain,
            false => 0.0,
        };
        NightLight {
            lamps: light.lamp_light(),
            lamp_sins: [LAMPS_FULL_SIN, LAMPS_OUT_SIN],
            airglow,
            airglow_sins: [GLOW_NIGHT_SIN, GLOW_DAY_SIN],
            // Green oxygen emits more than half of the airglow.
            airglow_height: LAYER_HEIGHTS.y,
        }
    }

    /// The Moon's shadow, if it reaches the Earth and is drawn.
    fn shadow_of(&self, sky: &Sky, ellipsoid: &Ellipsoid) -> Option<MoonShadow> {
        let shadow = sky.moon_shadow().filter(|_| self.light.eclipses)?;
        let reaches = shadow.reaches(DVec3::ZERO, ellipsoid.equatorial_radius_m);
        reaches.then_some(shadow)
    }

    /// As [`Self::metered`], for a view as a host passes it; `None` if the view has no image.
    pub fn metered_view(
        &mut self,
        view: &EyeView,
        sky: &Sky,
        ellipsoid: &Ellipsoid,
    ) -> Option<f64> {
        let view = view.in_itrf(Viewport::from((1, 1))).ok();
        let (view, sky) = view.zip(sky.with_unit_sun())?;
        let light = self.light_in(&view, &sky, ellipsoid);
        Some(self.metered(&view, &sky, ellipsoid, &light))
    }
}

/// The exposure that an Earth with these options would meter for a view, EV; `None` if the view has no image. It needs no GPU.
pub fn metered_ev(options: &EarthOptions, view: &EyeView, sky: &Sky) -> Option<f64> {
    let mut control = ExposureControl::new(options, options.atmosphere);
    control.metered_view(view, sky, &options.figure.ellipsoid())
}

/// The [`FrameStats::night_gain`](super::FrameStats::night_gain) of an Earth with these options for a view; `None` if the view has no image. It
/// needs no GPU.
pub fn night_gain_in(options: &EarthOptions, view: &EyeView, sky: &Sky) -> Option<f64> {
    let view = view.in_itrf(Viewport::from((1, 1))).ok();
    let (view, sky) = view.zip(sky.with_unit_sun())?;
    let ellipsoid = options.figure.ellipsoid();
    let lamps = Lamps::new(albedo_of(options).lamps());
    let lamps = has_lamps(options).then_some(&lamps);
    let light = light_beside(&options.light, lamps, &view, &sky, &ellipsoid);
    Some(light.night_gain)
}

fn albedo_of(options: &EarthOptions) -> NeighbourhoodAlbedo {
    NeighbourhoodAlbedo::of_parts(|layer| options.map_albedo(layer))
}

fn has_lamps(options: &EarthOptions) -> bool {
    options.layers.night_lights.is_some() || options.tiles.is_some()
}

/// `lamps` is `None` without city lights.
fn light_beside(
    light: &SurfaceLight,
    lamps: Option<&Lamps>,
    view: &ItrfView,
    sky: &Sky,
    ellipsoid: &Ellipsoid,
) -> SurfaceLight {
    let mut light = *light;
    let has_lights = lamps.is_some() || light.moonlight || light.glow_gain().is_some();
    if light.night_fades_by_day && has_lights {
        let daylight = daylight_in_sight(view, sky.sun_itrf, ellipsoid);
        // Aurora lights a night as a Moon does. By day no gain of the night matters.
        let by_night = match light.moonlight && light.kp.is_none() && daylight < 1.0 {
            true => {
                let (eye, moon) = (view.eye_itrf_m, sky.moonlight());
                let lamps = lamps.map_or(0.0, |lamps| {
                    lamps_in_sight(view, sky.sun_itrf, ellipsoid, lamps)
                });
                gain_by_night(light.night_gain, eye, moon, lamps, ellipsoid)
            }
            false => light.night_gain,
        };
        light.night_gain = gain_beside(by_night, daylight);
    }
    light
}
