//! Light of Sun and sky on the ground, and its part that reaches the eye.

use super::air::{Air, Sight};
use super::all_orders::air_of_all_orders;
use super::grid::Table1d;
use super::matter::Matter;
use super::spectrum::{BANDS, Colors, Spectrum};
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::{Arc, Mutex, PoisonError};
use terrella::frames::Ellipsoid;

/// Sine of the Sun's angular radius, 0.27°.
const SUN_RADIUS: f64 = 0.004_65;

/// Light on the ground as a fraction of the Sun's irradiance in space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Light {
    /// Irradiance of a sheet that faces the Sun.
    pub sun: DVec3,
    /// Irradiance of level ground by the sky.
    pub sky: DVec3,
    /// Light emitted by the ground that reaches the eye.
    pub own: DVec3,
}

impl Light {
    /// The same, each part this many times as bright.
    pub fn times(&self, factors: &Self) -> Self {
        Self {
            sun: self.sun * factors.sun,
            sky: self.sky * factors.sky,
            own: self.own * factors.own,
        }
    }

    /// All parts as they are.
    pub const WHOLE: Self = Self {
        sun: DVec3::ONE,
        sky: DVec3::ONE,
        own: DVec3::ONE,
    };
}

/// An Earth's air with the light that it leaves on the ground.
#[derive(Debug)]
pub(super) struct EarthAir {
    pub air: Air,
    colors: Colors,
    /// Over black ground, as an eye sees it: for places that differ little in the Sun's height.
    sun: ByZenith,
    sky: ByZenith,
}

/// Values of both tables.
const SUN_VALUES: usize = 2048;
const SKY_VALUES: usize = 256;

/// Light by the zenith cosine of the Sun's middle, cubics between values that are densest at the terminator.
#[derive(Debug)]
pub(super) struct ByZenith(Table1d);

/// How much finer the Sun's cosines are divided at the terminator, as the parameter of a sinh: 3e-5 apart there, of 2048.
const SUN_SPREAD: f64 = 6.0;

impl ByZenith {
    fn fill(count: usize, light: impl Fn(f64) -> DVec3 + Sync) -> Self {
        Self(Table1d::fill(count, |x| {
            light((SUN_SPREAD * (2.0 * x - 1.0)).sinh() / SUN_SPREAD.sinh())
        }))
    }

    pub fn at(&self, mu: f64) -> DVec3 {
        let x = 0.5 + 0.5 * (mu * SUN_SPREAD.sinh()).asinh() / SUN_SPREAD;
        // Cubics may swing below nothing where night begins.
        self.0.at(x).max(DVec3::ZERO)
    }
}

impl EarthAir {
    /// The Earth's air with an aerosol of this optical depth at 550 nm. Made once per process.
    pub fn of(aerosol_optical_depth: f64) -> Arc<Self> {
        Self::above(0.0, aerosol_optical_depth)
    }

    /// Its part above a height, metres, as if the ground were there. Made once per process.
    pub fn above(height_m: f64, aerosol_optical_depth: f64) -> Arc<Self> {
        type Made = ([f64; 2], Arc<EarthAir>);
        static MADE: Mutex<Vec<Made>> = Mutex::new(Vec::new());
        let wanted = [height_m, aerosol_optical_depth];
        // A value left by another thread that panicked is complete.
        let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        let found = made.iter().find(|(of, _)| *of == wanted);
        if let Some((_, air)) = found {
            return air.clone();
        }
        let radius_m = Ellipsoid::WGS84.equatorial_radius_m;
        let matter = Matter::new(aerosol_optical_depth).above(height_m);
        let air = Arc::new(Self::new(air_of_all_orders(matter, radius_m + height_m)));
        made.push((wanted, air.clone()));
        air
    }

    /// Computes the tables of an air.
    pub fn new(air: Air) -> Self {
        let colors = Colors::new();
        let sun = ByZenith::fill(SUN_VALUES, |mu| colors.rgb(&disc(0.0, mu, &air)));
        let sky = ByZenith::fill(SKY_VALUES, |mu| colors.rgb(&air.skylight_on_ground(mu)));
        Self {
            air,
            colors,
            sun,
            sky,
        }
    }

    /// The light over black ground for the Sun's centre at zenith cosine `mu`, before it is reflected.
    pub fn at(&self, mu: f64) -> Light {
        Light {
            sun: self.sun.at(mu),
            sky: self.sky.at(mu),
            own: DVec3::ONE,
        }
    }

    /// The Sun's light at a height, radii, on a sheet that faces it.
    pub fn sun_at(&self, height: f64) -> ByZenith {
        ByZenith::fill(SUN_VALUES, |mu| {
            self.colors.rgb(&disc(height, mu, &self.air))
        })
    }

    /// Factors by which the parts of [`Self::at`] reach the eye through `transmittance`, for a Sun at `mu` and ground of `albedo` all around, which
    /// lights the sky and is lit by it.
    pub fn factors(&self, mu: f64, transmittance: &Spectrum, albedo: DVec3) -> Light {
        let direct = disc(0.0, mu, &self.air);
        let sky = self.air.skylight_on_ground(mu);
        let back = self.air.sky_albedo();
        let albedo = albedo.to_array();
        let own = self.colors.rgb(transmittance);
        let of_sun = self.colors.rgb_of(|_, i| transmittance[i] * direct[i]);
        let of_sky = self.colors.rgb_of(|channel, i| {
            let again = albedo[channel] * back[i];
            let all = direct[i] * mu.max(0.0) + sky[i];
            transmittance[i] * (sky[i] + all * again / (1.0 - again))
        });
        let before = self.at(mu);
        let ratio = |light: DVec3, before: DVec3| {
            let parts = [0, 1, 2].map(|i| match before[i] > 1e-12 {
                true => light[i] / before[i],
                false => own[i],
            });
            DVec3::from(parts)
        };
        Light {
            sun: ratio(of_sun, before.sun),
            sky: ratio(of_sky, before.sky),
            own,
        }
    }

    /// The light of the air itself in a ray, 1 being a white sheet that faces the Sun in space, over ground of `albedo` all about.
    pub fn light(&self, sight: &Sight, albedo: DVec3) -> DVec3 {
        let back = self.air.sky_albedo();
        let albedo = albedo.to_array();
        self.colors.rgb_of(|channel, i| {
            let returned = albedo[channel] / (1.0 - albedo[channel] * back[i]);
            PI * (sight.black[i] + returned * sight.bounced[i])
        })
    }
}

/// Sunlight at a height, 0 being the ground, averaged over the Sun's disc by chords of equal height: Chebyshev's rule of the second kind,
/// whose weight √(1 − x²) is the chord's length.
fn disc(height: f64, mu: f64, air: &Air) -> Spectrum {
    const CHORDS: u32 = 12;
    let across = ((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt();
    let mut light = [0.0; BANDS];
    // High up the disc is as its middle.
    if mu > 0.2 {
        return air.sunlight(height, mu);
    }
    for i in 1..=CHORDS {
        let angle = PI * f64::from(i) / f64::from(CHORDS + 1);
        let (sin, cos) = (SUN_RADIUS * angle.cos()).sin_cos();
        let weight = angle.sin().powi(2) * 2.0 / f64::from(CHORDS + 1);
        let chord = air.sunlight(height, mu * cos + across * sin);
        light
            .iter_mut()
            .zip(chord)
            .for_each(|(sum, chord)| *sum += weight * chord);
    }
    light
}

/// The light of a Sun without air: its disc sets gradually, by the cubic 3x² − 2x³ between its first and last edge.
pub(super) fn without_air(mu: f64) -> Light {
    Light {
        sun: DVec3::splat(smooth_step(-SUN_RADIUS, SUN_RADIUS, mu)),
        sky: DVec3::ZERO,
        own: DVec3::ONE,
    }
}

/// 0 below `from`, 1 above `to`, between them 3x² − 2x³.
pub(super) fn smooth_step(from: f64, to: f64, x: f64) -> f64 {
    let x = ((x - from) / (to - from)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_between_the_values_of_a_table_is_that_of_the_disc() {
        let earth = EarthAir::of(0.0);
        for height in [0.0, 0.001] {
            let table = earth.sun_at(height);
            let off = |mu: f64| {
                let exact = earth.colors.rgb(&disc(height, mu, &earth.air));
                let off = table.at(mu) - exact.max(DVec3::ZERO);
                off.abs().max_element()
            };
            let offs = |from: f64, to: f64| -> Vec<f64> {
                let place = |i: i32| from + (to - from) * (f64::from(i) + 0.37) / 1000.0;
                (0..1000).map(|i| off(place(i))).collect()
            };
            let day = offs(0.03, 1.0).into_iter().fold(0.0, f64::max);
            let dusk = offs(-0.07, 0.03).iter().sum::<f64>() / 1000.0;
            println!("{height}: {dusk:.1e} at dusk, {day:.1e} at most by day");
            // The disc's chords set one by one, each instantly: there a cubic is between before and after.
            assert!(dusk < 5e-5 && day < 5e-5, "{height}: {dusk}, {day}");
        }
    }
}
