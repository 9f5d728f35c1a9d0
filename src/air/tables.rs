//! The tables that the air's shaders read, computed on the CPU once per process.
//!
//! | table | coordinates | texel |
//! |---|---|---|
//! | transmittance | cosine above the horizon, height | fraction of light that reaches the upper boundary, RGB |
//! | multiple | Sun cosine, height | light scattered more than once, per unit irradiance, RGB, 1/sr |
//! | scattering | ray, Sun cosine, azimuth | light scattered into a ray seen from outside, times π, RGB; 1 − its transmittance, A |
//! | sunlight | Sun cosine | first row: transmittance of the Sun's light to the ground, RGB; second: mean skylight on the ground, RGB |
//!
//! Single scattering is integrated along the ray; higher orders follow Hillaire 2020 ("A Scalable and Production Ready
//! Sky and Atmosphere Rendering Technique", section 5): isotropic after the second bounce, as a geometric series.
//! Light is relative to the Sun's irradiance at the top, times π, so that a white sheet facing the Sun in space is 1.

use super::model::{AirModel, EARTH_AIR};
use crate::frames::SUN_RADIUS_RAD;
use glam::{DVec3, Vec4};
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Texels along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableSize {
    /// First axis.
    pub x: u32,
    /// Second axis.
    pub y: u32,
    /// Third axis.
    pub z: u32,
}

impl TableSize {
    const fn new(x: u32, y: u32, z: u32) -> Self {
        Self { x, y, z }
    }

    /// All texels.
    pub const fn texels(self) -> usize {
        (self.x * self.y * self.z) as usize
    }
}

/// Size of the transmittance table.
pub const TRANSMITTANCE: TableSize = TableSize::new(128, 64, 1);
/// Size of the multiple-scattering table.
pub const MULTIPLE: TableSize = TableSize::new(32, 32, 1);
/// Size of the scattering table: along x 48 rays that meet the ground, then 48 that pass it.
pub const SCATTERING: TableSize = TableSize::new(96, 64, 16);
/// Size of the sunlight table: a row of transmittance and one of skylight.
pub const SUNLIGHT: TableSize = TableSize::new(256, 2, 1);

/// Lowest Sun cosine that the scattering and sunlight tables hold; below it the night is black.
pub(crate) const LOWEST_SUN: f64 = -0.36;

/// All tables, texels in x, y, z order.
pub struct AirTables {
    /// Fraction of light that reaches the upper boundary; coordinates in the module's table.
    pub transmittance: Vec<Vec4>,
    /// Light scattered more than once; coordinates in the module's table.
    pub multiple: Vec<Vec4>,
    /// Light scattered into a ray that is seen from outside; coordinates in the module's table.
    pub scattering: Vec<Vec4>,
    /// Sunlight and mean skylight on the ground; coordinates in the module's table.
    pub sunlight: Vec<Vec4>,
}

impl AirTables {
    /// The Earth's tables; the first call computes them (about 0.2 s in a release build), later ones are free.
    pub fn earth() -> &'static Self {
        static TABLES: OnceLock<AirTables> = OnceLock::new();
        TABLES.get_or_init(|| Self::compute(&EARTH_AIR))
    }

    /// Computes the tables of any air. Uses all cores.
    pub fn compute(air: &AirModel) -> Self {
        let builder = Builder {
            air,
            transmittance: Vec::new(),
            multiple: Vec::new(),
        };
        let transmittance = fill(TRANSMITTANCE, |x, y, _| {
            let r = builder.height_radius(y);
            let horizon = horizon_cosine(r);
            builder.integrate_transmittance(r, horizon + (1.0 - horizon) * x * x)
        });
        let builder = Builder {
            transmittance,
            ..builder
        };
        let multiple = fill(MULTIPLE, |x, y, _| {
            builder.multiple(builder.height_radius(y), -1.0 + 2.0 * x)
        });
        let builder = Builder {
            multiple,
            ..builder
        };
        let half = SCATTERING.x / 2;
        let scattering = fill_texels(SCATTERING, |i, j, k| {
            let along = f64::from(i % half) / f64::from(half - 1);
            let ray = if i < half {
                Ray::Ground { mu: along * along }
            } else {
                Ray::Limb {
                    lift: along * along,
                }
            };
            let mu_s = sun_cosine(f64::from(j) / f64::from(SCATTERING.y - 1));
            let azimuth = PI * f64::from(k) / f64::from(SCATTERING.z - 1);
            builder.outside(ray, mu_s, azimuth.cos())
        });
        let sunlight = fill(SUNLIGHT, |x, y, _| match y > 0.5 {
            false => builder.sunlight(sun_cosine(x)),
            true => builder.skylight(sun_cosine(x)),
        });
        let Builder {
            transmittance,
            multiple,
            ..
        } = builder;
        let vec4 = |v: Vec<DVec3>| v.into_iter().map(|c| c.as_vec3().extend(1.0)).collect();
        Self {
            transmittance: vec4(transmittance),
            multiple: vec4(multiple),
            scattering,
            sunlight: vec4(sunlight),
        }
    }
}

/// A ray that comes from outside the air, by where it passes nearest to the ground.
#[derive(Clone, Copy, Debug)]
enum Ray {
    /// Meets the ground at zenith cosine `mu`, 0…1.
    Ground { mu: f64 },
    /// Passes above it at `lift` of the air's thickness, 0…1.
    Limb { lift: f64 },
}

/// Sun cosine of a table coordinate 0…1: quadratic about 0, so that twilight is finely divided.
pub(super) fn sun_cosine(coordinate: f64) -> f64 {
    let low = -(-LOWEST_SUN).sqrt();
    let root = low + coordinate * (1.0 - low);
    root * root.abs()
}

/// Cosine of the horizon's zenith angle at radius `r`: −√(r² − 1)/r.
fn horizon_cosine(r: f64) -> f64 {
    -((r - 1.0).max(0.0) * (r + 1.0)).sqrt() / r
}

struct Builder<'a> {
    air: &'a AirModel,
    transmittance: Vec<DVec3>,
    multiple: Vec<DVec3>,
}

impl Builder<'_> {
    /// Radius of a height coordinate 0…1, finely divided near the ground.
    fn height_radius(&self, y: f64) -> f64 {
        1.0 + (self.air.top() - 1.0) * y * y
    }

    fn height_coordinate(&self, r: f64) -> f64 {
        ((r - 1.0) / (self.air.top() - 1.0)).clamp(0.0, 1.0).sqrt()
    }

    /// Distance along a ray to the upper boundary.
    fn to_top(&self, r: f64, mu: f64) -> f64 {
        let top = self.air.top();
        // −rμ + √(r²μ² + (top − r)(top + r)), without cancellation for rays that go up.
        let half = r * mu;
        let c = (top - r).max(0.0) * (top + r);
        let root = (half * half + c).sqrt();
        if half > 0.0 {
            c / (half + root)
        } else {
            root - half
        }
    }

    /// Transmittance from radius `r` to the upper boundary at zenith cosine `mu`, which must clear the ground.
    fn integrate_transmittance(&self, r: f64, mu: f64) -> DVec3 {
        const STEPS: u32 = 64;
        let length = self.to_top(r, mu);
        let step = length / f64::from(STEPS);
        let depth: DVec3 = (0..STEPS)
            .map(|i| {
                let t = (f64::from(i) + 0.5) * step;
                self.air
                    .medium((r * r + t * t + 2.0 * r * mu * t).sqrt())
                    .extinction
                    * step
            })
            .sum();
        exp(-depth)
    }

    /// Transmittance from radius `r` to the Sun at cosine `mu`; zero where the Earth is in between.
    fn to_sun(&self, r: f64, mu: f64) -> DVec3 {
        let horizon = horizon_cosine(r);
        if mu < horizon {
            return DVec3::ZERO;
        }
        let x = ((mu - horizon) / (1.0 - horizon)).sqrt();
        bilinear(
            &self.transmittance,
            TRANSMITTANCE,
            x,
            self.height_coordinate(r),
        )
    }

    fn multiple_at(&self, r: f64, mu_s: f64) -> DVec3 {
        bilinear(
            &self.multiple,
            MULTIPLE,
            0.5 + 0.5 * mu_s,
            self.height_coordinate(r),
        )
    }

    /// Walks from `start` along `direction` for `length`, steps crowded where `crowd` (0…1 of the length) says.
    /// Returns scattered light, per unit irradiance and steradian, and transmittance.
    fn march(
        &self,
        start: DVec3,
        direction: DVec3,
        length: f64,
        crowd: f64,
        steps: u32,
        sun: DVec3,
    ) -> (DVec3, DVec3) {
        let nu = direction.dot(sun);
        let (phase_r, phase_m) = (AirModel::molecule_phase(nu), self.air.aerosol_phase(nu));
        let mut light = DVec3::ZERO;
        let mut through = DVec3::ONE;
        // Positions t(s) = crowd + signed square on each side: dense near the lowest point.
        let place = |s: f64| {
            let signed = |x: f64| x * x.abs();
            let (low, high) = (-crowd.sqrt(), (1.0 - crowd).sqrt());
            length * (crowd + signed(low + s * (high - low)))
        };
        let mut from = 0.0;
        for i in 0..steps {
            let to = place(f64::from(i + 1) / f64::from(steps));
            let (step, t) = (to - from, 0.5 * (from + to));
            from = to;
            let p = start + direction * t;
            let r = p.length();
            let mu_s = p.dot(sun) / r;
            let medium = self.air.medium(r);
            let mut source =
                self.to_sun(r, mu_s) * (medium.molecules * phase_r + medium.aerosol * phase_m);
            if !self.multiple.is_empty() {
                source += self.multiple_at(r, mu_s) * (medium.molecules + medium.aerosol);
            }
            // ∫ source·e^(−σt) over the step, exact for constant values.
            let fade = exp(-medium.extinction * step);
            light +=
                through * source * (DVec3::ONE - fade) / medium.extinction.max(DVec3::splat(1e-12));
            through *= fade;
        }
        (light, through)
    }

    /// Light scattered more than once at radius `r`, isotropic, per unit irradiance (Hillaire 2020, eqs. 5–10).
    fn multiple(&self, r: f64, mu_s: f64) -> DVec3 {
        const SIDE: u32 = 8;
        let sun = DVec3::new((1.0 - mu_s * mu_s).max(0.0).sqrt(), 0.0, mu_s);
        let start = DVec3::new(0.0, 0.0, r.max(1.0 + 1e-7));
        let (mut second, mut fraction) = (DVec3::ZERO, DVec3::ZERO);
        for i in 0..SIDE {
            for j in 0..SIDE {
                let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(SIDE);
                let turn = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(SIDE);
                let flat = (1.0 - z * z).sqrt();
                let direction = DVec3::new(flat * turn.cos(), flat * turn.sin(), z);
                let (length, ground) = self.reach(start, direction);
                const STEPS: u32 = 20;
                let step = length / f64::from(STEPS);
                let mut through = DVec3::ONE;
                for k in 0..STEPS {
                    let p = start + direction * ((f64::from(k) + 0.5) * step);
                    let radius = p.length();
                    let medium = self.air.medium(radius);
                    let scattering = medium.molecules + medium.aerosol;
                    let fade = exp(-medium.extinction * step);
                    let weight =
                        through * (DVec3::ONE - fade) / medium.extinction.max(DVec3::splat(1e-12));
                    second +=
                        weight * scattering * self.to_sun(radius, p.dot(sun) / radius) / (4.0 * PI);
                    fraction += weight * scattering;
                    through *= fade;
                }
                if ground {
                    let p = (start + direction * length).normalize();
                    let cos = p.dot(sun);
                    second += through
                        * self.to_sun(1.0, cos)
                        * (cos.max(0.0) * self.air.ground_albedo / PI);
                }
            }
        }
        let samples = f64::from(SIDE * SIDE);
        // Uniform directions: the mean over the sphere is the integral with the isotropic phase 1/4π.
        (second / samples) / (DVec3::ONE - (fraction / samples).min(DVec3::splat(0.99)))
    }

    /// Distance to the ground or to the upper boundary, and which it is.
    fn reach(&self, start: DVec3, direction: DVec3) -> (f64, bool) {
        let r = start.length();
        let mu = start.dot(direction) / r;
        let q2 = start.cross(direction).length_squared();
        if mu < 0.0 && q2 < 1.0 {
            let c = (r - 1.0) * (r + 1.0);
            return (c / (-r * mu + (1.0 - q2).sqrt()), true);
        }
        (self.to_top(r, mu), false)
    }

    /// One texel of the scattering table: light (× π) and 1 − transmittance of a ray from outside.
    fn outside(&self, ray: Ray, mu_s: f64, cos_azimuth: f64) -> Vec4 {
        let top = self.air.top();
        // The reference point is (0, 0, r); the ray comes down in the x–z plane.
        let (r, mu) = match ray {
            Ray::Ground { mu } => (1.0, mu),
            Ray::Limb { lift } => (1.0 + (top - 1.0) * lift, 0.0),
        };
        let direction = DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, -mu);
        let reference = DVec3::new(0.0, 0.0, r);
        let before = self.to_top(r, mu);
        let (length, crowd) = match ray {
            Ray::Ground { .. } => (before, 1.0),
            Ray::Limb { .. } => (2.0 * before, 0.5),
        };
        let flat = (1.0 - mu_s * mu_s).max(0.0).sqrt();
        let sun = DVec3::new(
            flat * cos_azimuth,
            flat * (1.0 - cos_azimuth * cos_azimuth).max(0.0).sqrt(),
            mu_s,
        );
        let (light, through) = self.march(
            reference - direction * before,
            direction,
            length,
            crowd,
            40,
            sun,
        );
        (light * PI)
            .as_vec3()
            .extend((1.0 - luminance(through)) as f32)
    }

    /// Transmittance of the Sun's light to the ground.
    fn sunlight(&self, mu_s: f64) -> DVec3 {
        // The Sun is a disc of 0.27° radius: average over it, so that it sets gradually.
        const CHORDS: u32 = 9;
        let mut direct = DVec3::ZERO;
        let mut area = 0.0;
        for i in 0..CHORDS {
            let x = -1.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(CHORDS);
            let weight = (1.0 - x * x).sqrt();
            direct += self.to_sun(1.0, (mu_s + x * SUN_RADIUS_RAD).clamp(-1.0, 1.0)) * weight;
            area += weight;
        }
        direct / area
    }

    /// Mean skylight on the ground as a fraction of the Sun's irradiance.
    fn skylight(&self, mu_s: f64) -> DVec3 {
        let sun = DVec3::new((1.0 - mu_s * mu_s).max(0.0).sqrt(), 0.0, mu_s);
        let start = DVec3::new(0.0, 0.0, 1.0 + 1e-7);
        const UP: u32 = 6;
        const AROUND: u32 = 8;
        let mut sky = DVec3::ZERO;
        for i in 0..UP {
            for j in 0..AROUND {
                // Cosine-weighted directions.
                let z2 = (f64::from(i) + 0.5) / f64::from(UP);
                let turn = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(AROUND);
                let direction = DVec3::new(
                    (1.0 - z2).sqrt() * turn.cos(),
                    (1.0 - z2).sqrt() * turn.sin(),
                    z2.sqrt(),
                );
                let length = self.to_top(1.0, direction.z);
                sky += self.march(start, direction, length, 0.0, 20, sun).0;
            }
        }
        sky * PI / f64::from(UP * AROUND)
    }
}

fn exp(v: DVec3) -> DVec3 {
    DVec3::new(v.x.exp(), v.y.exp(), v.z.exp())
}

/// Luminance of linear red, green and blue (Rec. 709).
pub(crate) const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

fn luminance(v: DVec3) -> f64 {
    v.dot(LUMINANCE)
}

fn bilinear(table: &[DVec3], size: TableSize, x: f64, y: f64) -> DVec3 {
    let place = |c: f64, n: u32| {
        let at = c.clamp(0.0, 1.0) * f64::from(n - 1);
        let low = (at as u32).min(n - 2);
        (low as usize, at - f64::from(low))
    };
    let ((i, fx), (j, fy)) = (place(x, size.x), place(y, size.y));
    let row = |j: usize| {
        let at = j * size.x as usize + i;
        table[at].lerp(table[at + 1], fx)
    };
    row(j).lerp(row(j + 1), fy)
}

/// Fills a table by coordinates 0…1, texel centres on both ends.
fn fill<T: Send + Copy + Default>(
    size: TableSize,
    f: impl Fn(f64, f64, f64) -> T + Sync,
) -> Vec<T> {
    let coordinate = |i: u32, n: u32| {
        if n > 1 {
            f64::from(i) / f64::from(n - 1)
        } else {
            0.0
        }
    };
    fill_texels(size, |i, j, k| {
        f(
            coordinate(i, size.x),
            coordinate(j, size.y),
            coordinate(k, size.z),
        )
    })
}

/// Fills a table by texel index, rows shared out over the cores.
fn fill_texels<T: Send + Copy + Default>(
    size: TableSize,
    f: impl Fn(u32, u32, u32) -> T + Sync,
) -> Vec<T> {
    let mut out = vec![T::default(); size.texels()];
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let rows = (size.y * size.z) as usize;
    let share = rows.div_ceil(threads);
    std::thread::scope(|scope| {
        for (part, chunk) in out.chunks_mut(share * size.x as usize).enumerate() {
            let f = &f;
            scope.spawn(move || {
                for (offset, texel) in chunk.iter_mut().enumerate() {
                    let index = part * share * size.x as usize + offset;
                    let (x, row) = (index as u32 % size.x, index as u32 / size.x);
                    *texel = f(x, row % size.y, row / size.y);
                }
            });
        }
    });
    out
}
