//! Metering of the exposure for a view on the CPU. Nothing is read back from the GPU, so equal frames have equal
//! exposures.
//!
//! A grid of rays is cast at the ellipsoid. For a ray that hits the ground, the luminance is the coarse albedo there times the irradiance, plus an
//! estimate of the inscattered light. For a ray that passes through the atmosphere beside the ground, it is that of the sky over its lowest point. At
//! night, lamps and airglow are added. Rays into space have no weight. The mean luminance of the brightest [`BRIGHTEST`] of the weighted rays is
//! displayed as [`SHOWN`], or darker if it is dark.

use super::Exposure;
use super::neighbourhoods::{Lamps, between};
use crate::air::{AirTables, LUMINANCE};
use glam::{DMat4, DVec3, Vec3, Vec4};
use std::sync::Arc;
use terrella_frames::{MoonShadow, SUN_RADIUS_RAD};

/// Rays horizontally and vertically.
const RAYS: [u32; 2] = [32, 18];
/// Number of rays of [`view_rays`].
pub const VIEW_RAYS: usize = (RAYS[0] * RAYS[1]) as usize;
/// Fraction of the visible scene, the brightest, whose mean luminance is metered.
const BRIGHTEST: f64 = 0.1;
/// Display light of that mean.
const SHOWN: f64 = 0.7;
/// Exposure up to which the mean is displayed as [`SHOWN`], EV, and the part of each further step that is exposed. A night is not shown as bright as
/// a day: photographers, and models of the eye's adaptation (Krawczyk, Myszkowski and Seidel 2005), lower the target with the luminance.
const FULL_EV: f64 = 1.0;
const FURTHER: f64 = 0.5;
/// Range of results, EV. Snow in full sunlight needs more than the minimum; the maximum shows airglow.
const RANGE_EV: [f64; 2] = [-4.0, 6.0];
/// Largest factor by which the airglow layer is brighter along it than from below, on one side of a
/// ray.
const MOST_SLANT: f64 = 12.0;
/// Scale height of the air at the limb, equatorial radii.
const AIR_SCALE: f64 = 8e3 / 6.378e6;

/// A grid of rays from the eye, one per equal part of the image: a sparse sampling of the view. `clip_from_eye`
/// transforms the rays' space to clip space.
pub fn view_rays(clip_from_eye: &DMat4) -> impl Iterator<Item = DVec3> + use<> {
    let eye_from_clip = clip_from_eye.inverse();
    (0..RAYS[0] * RAYS[1]).map(move |n| {
        let [x, y] = [n % RAYS[0], n / RAYS[0]];
        let across = (f64::from(x) + 0.5) / f64::from(RAYS[0]) * 2.0 - 1.0;
        let up = 1.0 - (f64::from(y) + 0.5) / f64::from(RAYS[1]) * 2.0;
        // Any depth between the planes is in front of the eye.
        eye_from_clip.project_point3(DVec3::new(across, up, 0.5))
    })
}

/// Input of the meter.
pub struct MeterView<'a> {
    /// The eye, scaled space.
    pub eye_scaled: DVec3,
    /// Diagonal of the ellipsoid's matrix: transforms scaled space to metres.
    pub itrf_from_scaled: DVec3,
    /// Transforms eye-relative ITRF metres to clip space.
    pub clip_from_eye: &'a DMat4,
    /// Sun and Moon: ITRF unit vectors towards them, and their light as drawn, with the Sun at 1.
    pub lights: [(DVec3, f32); 2],
    /// The Moon's shadow, if it covers the Sun.
    pub shadow: Option<MoonShadow>,
    /// Light sources of the night.
    pub night: NightLight,
}

/// Lights of the night as drawn. A white sheet that faces the Sun in space is 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NightLight {
    /// Light of the brightest lamps; 0 if none are drawn.
    pub lamps: f64,
    /// Sines of the Sun's elevation at which all lamps are on, and at which all are off.
    pub lamp_sins: [f64; 2],
    /// Luminance of the airglow seen from directly below; 0 if none is drawn.
    pub airglow: f64,
    /// Sines of the Sun's elevation at which it is fully visible, and at which twilight outshines
    /// it.
    pub airglow_sins: [f64; 2],
    /// Height of the airglow layer, equatorial radii.
    pub airglow_height: f64,
}

/// Meters views of one Earth.
pub struct Meter {
    /// Albedo of the ground with its clouds, RGB, by neighbourhoods.
    albedo: Vec<Vec4>,
    lamps: Arc<Lamps>,
    /// The atmosphere, if there is one.
    air: Option<Arc<AirTables>>,
}

impl Meter {
    /// `albedo` has a texel for each neighbourhood, as [`Lamps::new`] takes them.
    pub fn new(albedo: Vec<Vec4>, lamps: Arc<Lamps>, air: Option<Arc<AirTables>>) -> Self {
        Self { albedo, lamps, air }
    }

    /// The exposure for a view, EV; the default where neither ground nor atmosphere is visible. Allocates
    /// nothing.
    pub fn ev(&self, view: &MeterView<'_>) -> f64 {
        let mut seen = [(0.0, 0.0); VIEW_RAYS];
        for (seen, ray) in seen.iter_mut().zip(view_rays(view.clip_from_eye)) {
            *seen = self.luminance(view, ray / view.itrf_from_scaled);
        }
        let Some(luminance) = mean_of_brightest(&mut seen, BRIGHTEST) else {
            return Exposure::DEFAULT_EV;
        };
        let full = (SHOWN / luminance.max(1e-9)).log2();
        let further = FURTHER * (full - FULL_EV).max(0.0);
        (full.min(FULL_EV) + further).clamp(RANGE_EV[0], RANGE_EV[1])
    }

    /// Luminance along a ray of scaled space, and its weight.
    fn luminance(&self, view: &MeterView<'_>, ray: DVec3) -> (f64, f64) {
        let Some(d) = ray.try_normalize() else {
            return (0.0, 0.0);
        };
        let eye = view.eye_scaled;
        let along = -eye.dot(d);
        let q = eye.cross(d).length();
        let above = (eye.length() - 1.0).max(0.0);
        if along > 0.0 && q < 1.0 {
            let root = ((1.0 - q) * (1.0 + q)).sqrt();
            let ground = (eye + d * (along - root)).normalize_or_zero();
            let up = self.up(view, ground);
            let albedo = self.albedo_at(up);
            let [falls, sky] = self.light(view, up, albedo);
            // The atmosphere sends about as much light up as down, and more along a slanted view.
            let before = sky * (0.5 / root.max(0.25)) as f32;
            let (night, sun_sin) = (&view.night, up.dot(view.lights[0].0));
            let lamps = night.lamps * self.lamps.at(up) * on(night.lamp_sins, sun_sin);
            let glow = match above > night.airglow_height {
                true => night.airglow_along(q) * on(night.airglow_sins, sun_sin),
                false => 0.0,
            };
            return (luminance(albedo * falls + before) + lamps + glow, 1.0);
        }
        // The ray misses the ground: take its lowest point, or the eye if the ray rises.
        let (lowest, height) = match along > 0.0 {
            true => (eye + d * along, q - 1.0),
            false => (eye, above),
        };
        let up = self.up(view, lowest.normalize_or_zero());
        let [_, sky] = self.light(view, up, Vec3::ZERO);
        let part = match self.air {
            Some(_) => (-height / AIR_SCALE).exp(),
            None => 0.0,
        };
        let night = &view.night;
        let seen = on(night.airglow_sins, up.dot(view.lights[0].0));
        if night.airglow <= 0.0 || seen <= 0.0 || height > night.airglow_height {
            return (luminance(sky) * part, part);
        }
        // An eye above the layer sees it on both sides of the lowest point.
        let sides = if above > night.airglow_height {
            2.0
        } else {
            1.0
        };
        let glow = sides * night.airglow_along(q) * seen;
        (luminance(sky) * part + glow, part.max(seen))
    }

    /// Outward normal of the ellipsoid, ITRF axes, at a direction of scaled space.
    fn up(&self, view: &MeterView<'_>, scaled: DVec3) -> DVec3 {
        (scaled / view.itrf_from_scaled).normalize_or_zero()
    }

    /// Irradiance of all lights on level ground with this normal, RGB, and of the sky alone, which equals the sky's light. A
    /// sheet that faces the Sun in space has 1.
    fn light(&self, view: &MeterView<'_>, up: DVec3, albedo: Vec3) -> [Vec3; 2] {
        let mut sum = [Vec3::ZERO; 2];
        let place = || {
            let scaled = (up * view.itrf_from_scaled).normalize_or_zero();
            scaled * view.itrf_from_scaled
        };
        let past_moon = view.shadow.map_or(1.0, |shadow| shadow.sun_left(place()));
        for ((towards, brightness), left) in view.lights.into_iter().zip([past_moon, 1.0]) {
            let brightness = brightness * left as f32;
            if brightness > 0.0 {
                let [falls, sky] = self.light_of_one(up.dot(towards), albedo);
                sum[0] += brightness * falls;
                sum[1] += brightness * sky;
            }
        }
        sum
    }

    /// The same for a Sun at this zenith cosine.
    fn light_of_one(&self, mu_s: f64, albedo: Vec3) -> [Vec3; 2] {
        let Some(air) = &self.air else {
            let risen = ((mu_s + SUN_RADIUS_RAD) / (2.0 * SUN_RADIUS_RAD)).clamp(0.0, 1.0);
            return [Vec3::splat((mu_s.max(0.0) * risen) as f32), Vec3::ZERO];
        };
        let [direct, sky] = air.sunlight_at(mu_s);
        let falls = direct * mu_s.max(0.0) as f32 + sky;
        // The atmosphere returns a part of the light reflected by the ground.
        [falls / (1.0 - albedo * air.sky_albedo), sky]
    }

    /// The albedo at a place, interpolated between texel centres.
    fn albedo_at(&self, up: DVec3) -> Vec3 {
        let texel = |at: usize| self.albedo.get(at).copied().unwrap_or_default();
        between(up, texel).truncate()
    }
}

impl NightLight {
    /// Luminance of the airglow on one side of a ray that passes the centre at this distance, scaled space.
    fn airglow_along(&self, q: f64) -> f64 {
        let sine = (q / (1.0 + self.airglow_height)).min(1.0);
        let cosine = ((1.0 - sine) * (1.0 + sine)).sqrt();
        self.airglow / cosine.max(1.0 / MOST_SLANT)
    }
}

/// Visible fraction of a night light: full below the first sine of the Sun's elevation, none above the second.
fn on([full, out]: [f64; 2], sun_sin: f64) -> f64 {
    let t = ((out - sun_sin) / (out - full).max(1e-9)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn luminance(light: Vec3) -> f64 {
    light.as_dvec3().dot(LUMINANCE)
}

/// Mean of the largest values that have `part` of the weight, so that it varies smoothly with values and weights. `None`
/// without weight. Sorts `values`.
fn mean_of_brightest(values: &mut [(f64, f64)], part: f64) -> Option<f64> {
    values.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    let total: f64 = values.iter().map(|(_, weight)| weight).sum();
    if total <= 1e-6 {
        return None;
    }
    let wanted = part * total;
    let (mut sum, mut left) = (0.0, wanted);
    for (value, weight) in values.iter() {
        let taken = weight.min(left);
        sum += value * taken;
        left -= taken;
    }
    Some(sum / wanted)
}

#[cfg(test)]
mod tests {
    use super::super::neighbourhoods::{COLUMNS, ROWS};
    use super::*;
    use glam::dcamera;
    use terrella_frames::Ellipsoid;

    const RADII: DVec3 = DVec3::new(6_378_137.0, 6_378_137.0, 6_356_752.314);

    fn meter(albedo: f32) -> Meter {
        Meter::new(
            vec![Vec4::splat(albedo); COLUMNS * ROWS],
            Arc::default(),
            None,
        )
    }

    /// View from above longitude 0, straight down.
    fn ev(meter: &Meter, height_m: f64, sun_itrf: DVec3) -> f64 {
        ev_under(meter, height_m, [(sun_itrf, 1.0), (DVec3::ZERO, 0.0)])
    }

    fn ev_under(meter: &Meter, height_m: f64, lights: [(DVec3, f32); 2]) -> f64 {
        ev_with(meter, height_m, lights, NightLight::default())
    }

    fn ev_with(meter: &Meter, height_m: f64, lights: [(DVec3, f32); 2], night: NightLight) -> f64 {
        let eye = DVec3::X * (RADII.x + height_m);
        let view = dcamera::rh::view::look_at_mat4(DVec3::ZERO, -DVec3::X, DVec3::Z);
        let clip_from_eye = dcamera::rh::proj::directx::perspective(0.8, 1.6, 1.0, 1e9) * view;
        meter.ev(&MeterView {
            eye_scaled: eye / Ellipsoid::WGS84.itrf_from_scaled(),
            itrf_from_scaled: Ellipsoid::WGS84.itrf_from_scaled(),
            clip_from_eye: &clip_from_eye,
            lights,
            shadow: None,
            night,
        })
    }

    #[test]
    fn what_is_metered_is_shown_at_its_value() {
        // Near the ground under the Sun every ray has the albedo.
        let ev = ev(&meter(0.35), 1e5, DVec3::X);
        assert!((ev - (0.7_f64 / 0.35).log2()).abs() < 0.01, "{ev}");
    }

    #[test]
    fn a_darker_earth_is_shown_brighter_within_limits() {
        let sun = DVec3::X;
        assert!(ev(&meter(0.35), 4e5, sun) > ev(&meter(0.7), 4e5, sun) + 0.95);
        // From here on, half of each step.
        let [dark, darker] = [0.1, 0.05].map(|albedo| ev(&meter(albedo), 4e5, sun));
        assert!((darker - dark - 0.5).abs() < 0.01, "{dark}, {darker}");
        assert_eq!(ev(&meter(0.5), 4e5, -sun), RANGE_EV[1]);
        assert_eq!(ev(&meter(1000.0), 4e5, sun), RANGE_EV[0]);
    }

    #[test]
    fn a_night_is_metered_by_its_moon() {
        let under = |moon| ev_under(&meter(0.35), 1e5, [(-DVec3::X, 1.0), (DVec3::X, moon)]);
        assert_eq!(under(0.0), RANGE_EV[1]);
        // Half the light of the Sun, a step less than in `what_is_metered_is_shown_at_its_value`.
        assert!((under(0.5) - 1.5).abs() < 0.01, "{}", under(0.5));
    }

    #[test]
    fn a_night_without_a_moon_is_metered_by_lamps_and_airglow() {
        let night = NightLight {
            lamps: 0.6,
            lamp_sins: [-0.1, 0.0],
            airglow: 0.0,
            airglow_sins: [-0.2, -0.1],
            airglow_height: 0.015,
        };
        let lit = Meter {
            lamps: Arc::new(Lamps::new(vec![0.1; COLUMNS * ROWS])),
            ..meter(0.0)
        };
        let ev = |meter: &Meter, sun: DVec3, night| {
            ev_with(meter, 4e5, [(sun, 1.0), (DVec3::ZERO, 0.0)], night)
        };
        let found = ev(&lit, -DVec3::X, night);
        // Fully exposed, it would be log₂(0.7/0.06) = 3.54.
        assert!((found - 2.27).abs() < 0.01, "{found}");
        // By day lamps are off, and without a map there are none.
        assert_eq!(ev(&lit, DVec3::X, night), RANGE_EV[1]);
        assert_eq!(ev(&meter(0.0), -DVec3::X, night), RANGE_EV[1]);
        let glowing = NightLight {
            lamps: 0.0,
            airglow: 0.05,
            ..night
        };
        // It is brighter towards the corners than straight down.
        let found = ev(&lit, -DVec3::X, glowing);
        // Fully exposed, straight down would be log₂(0.7/0.05) = 3.81.
        assert!((2.2..2.4).contains(&found), "{found}");
        assert_eq!(ev(&lit, DVec3::X, glowing), RANGE_EV[1]);
    }

    #[test]
    fn space_alone_gets_the_default() {
        let meter = meter(0.3);
        let view = dcamera::rh::view::look_at_mat4(DVec3::ZERO, DVec3::X, DVec3::Z);
        let clip_from_eye = dcamera::rh::proj::directx::perspective(0.8, 1.6, 1.0, 1e9) * view;
        let ev = meter.ev(&MeterView {
            eye_scaled: DVec3::X * 3.0,
            itrf_from_scaled: RADII,
            clip_from_eye: &clip_from_eye,
            lights: [(DVec3::Y, 1.0), (DVec3::ZERO, 0.0)],
            shadow: None,
            night: NightLight::default(),
        });
        assert_eq!(ev, Exposure::DEFAULT_EV);
    }

    #[test]
    fn a_moving_eye_meters_without_jumps() {
        let meter = meter(0.3);
        let sun = DVec3::new(0.3, 0.9, 0.1).normalize();
        let mut before = None;
        for step in 0..2000 {
            // From farther away so few rays hit the disc that a single one at its edge matters.
            let height_m = 1e5 * (f64::from(step) / 2000.0 * 100_f64.ln()).exp();
            let ev = ev(&meter, height_m, sun);
            let jump = before.map_or(0.0, |before: f64| (ev - before).abs());
            assert!(jump < 0.3, "{jump} EV at {height_m} m");
            before = Some(ev);
        }
    }

    #[test]
    fn the_brightest_are_taken_by_weight() {
        let mut values = [(3.0, 1.0), (1.0, 1.0), (9.0, 0.0), (2.0, 2.0)];
        assert_eq!(mean_of_brightest(&mut values, 0.25), Some(3.0));
        assert_eq!(mean_of_brightest(&mut values, 0.5), Some(2.5));
        assert_eq!(mean_of_brightest(&mut values, 1.0), Some(2.0));
        assert_eq!(mean_of_brightest(&mut [(1.0, 0.0)], 0.5), None);
    }
}
