//! Atmosphere tables that shaders sample, computed on the CPU.
//!
//! | table | coordinates | texel |
//! |---|---|---|
//! | scattering | ray, Sun cosine, azimuth | light scattered into a ray that comes from outside, over black ground, fourth root of RGB; 1 − the luminance of its transmittance, A |
//! | bounce | ray, Sun cosine | the same of light that the ground sends up, for albedo 1 and one reflection, fourth root of RGB |
//! | through | ray | transmittance of the ray, from space to the ground or right through, RGB |
//! | sunlight | Sun cosine | first row: transmittance of the Sun's light to the ground, RGB; second: the sky's irradiance on black ground, RGB; third, of shaders alone: transmittance to the clouds |
//! | transmittance | cosine above the horizon, height | fraction of light that reaches the upper boundary, RGB |
//! | sources | Sun cosine, 7 × height | source function of light scattered more than once, per scattering coefficient, RGB |
//! | profile | height | molecules relative to the ground over e^(−h/8 km), R; ozone relative to its peak, G |
//!
//! A ray is described by its reference point: where it meets the ground or passes nearest to it. `Sun cosine` and `azimuth` are those of the Sun
//! there; azimuth is measured from the ray's horizontal direction. All light is relative to the Sun's irradiance at the top, times π: a white sheet
//! that faces the Sun in space is 1. For ground of albedo A and s = [`AirTables::sky_albedo`], the sum along a ray is
//! `scattering + A/(1 − A·s)·bounce`. On the ground it is `(direct·cos + sky)/(1 − A·s)`.
//!
//! [`AirAboveClouds`] repeats the tables of outside rays and of sunlight with a cloud layer in place of the ground.
//!
//! Single scattering is integrated along each ray. Higher orders use successive orders of scattering on the sphere; see `sources`.

mod above_clouds;
mod interpolation;
mod path;
mod quadrature;
mod shipped;
mod source_table;
mod sources;
mod transmittance;

use super::model::{AirModel, AirOptions, RADIUS_M, TOP};
use super::profile;
use super::spectrum::Spectrum;
pub use above_clouds::AirAboveClouds;
use glam::{DVec3, Vec3, Vec4};
use interpolation::LitFromOutside;
pub use interpolation::{InterpolationBound, InterpolationLimits};
use path::{Light, Path, Ray};
pub use shipped::{AirFileError, supply};
use source_table::{COEFFICIENTS, HEIGHTS, SUNS, SourceFunction};
use sources::Sources;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock, Mutex, OnceLock, PoisonError};
use terrella_files::parallel;
use terrella_frames::SUN_RADIUS_RAD;
use transmittance::{SunRow, TransmittanceTable, horizon_cosine, to_top};

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

    pub const fn texels(self) -> usize {
        (self.x * self.y * self.z) as usize
    }
}

pub const TRANSMITTANCE: TableSize = TableSize::new(128, 64, 1);
/// Columns per kind of ray in the outside tables: rays that meet the ground, rays that pass it, and rays that
/// meet clouds.
pub const RAYS: u32 = 48;
/// Size of the scattering table. Along x: rays that meet the ground, then rays that pass it.
pub const SCATTERING: TableSize = TableSize::new(2 * RAYS, 64, 24);
/// Size of the table of light reflected by the ground.
pub const BOUNCE: TableSize = TableSize::new(SCATTERING.x, SCATTERING.y, 1);
/// Size of the table of ray transmittance.
pub const THROUGH: TableSize = TableSize::new(SCATTERING.x, 1, 1);
/// Size of the sunlight table: a row of transmittance and a row of skylight.
pub const SUNLIGHT: TableSize = TableSize::new(256, 2, 1);
/// Size of the sunlight table with two more rows for a scene's clouds: transmittance to them and skylight on them.
pub const SUNLIGHT_AND_CLOUDS: TableSize = TableSize::new(SUNLIGHT.x, SUNLIGHT.y + 2, 1);
/// [`SCATTERING`] with extra columns for rays that meet clouds. The last quarter is empty, so that coordinates can be
/// halved exactly.
pub const SCATTERING_AND_CLOUDS: TableSize = TableSize::new(4 * RAYS, SCATTERING.y, SCATTERING.z);
/// [`BOUNCE`] with the cloud columns.
pub const BOUNCE_AND_CLOUDS: TableSize = TableSize::new(4 * RAYS, BOUNCE.y, 1);
/// [`THROUGH`] with the cloud columns.
pub const THROUGH_AND_CLOUDS: TableSize = TableSize::new(4 * RAYS, 1, 1);
/// Size of the source table: one band of heights for each of six coefficients and for the isotropic source of ground
/// light.
pub const SOURCES: TableSize = TableSize::new(SUNS as u32, (SOURCE_BANDS * HEIGHTS) as u32, 1);
pub const PROFILE: TableSize = TableSize::new(128, 1, 1);
/// Bands of the source table.
pub const SOURCE_BANDS: usize = COEFFICIENTS + 1;

/// Lowest Sun cosine of the tables, 27° below the horizon. There the light is below 1e-10 of a white sheet in sunlight. Lower Suns use
/// the same value.
pub const LOWEST_SUN: f64 = -0.45;
/// Sine of the Sun's elevation within which Sun cosines are evenly spaced. Beyond it the spacing grows in proportion.
pub const SUN_SPACING: f64 = 0.05;
/// Scale height of the molecule profile, metres.
pub const MOLECULE_SCALE_HEIGHT_M: f64 = 8_000.0;

/// All tables, texels in x, y, z order.
pub struct AirTables {
    /// Light that the atmosphere scatters into a ray, over black ground.
    pub scattering: Vec<Vec4>,
    /// Light from the ground that the atmosphere scatters into a ray.
    pub bounce: Vec<Vec4>,
    /// Transmittance of a ray.
    pub through: Vec<Vec4>,
    /// Sunlight on the ground and irradiance of the sky.
    pub sunlight: Vec<Vec4>,
    /// Transmittance from points in the atmosphere to the Sun.
    pub transmittance: Vec<Vec4>,
    /// Source functions.
    pub sources: Vec<Vec4>,
    /// Density profiles.
    pub profile: Vec<Vec4>,
    /// Fraction of the ground's light that the atmosphere returns to the ground, RGB.
    pub sky_albedo: Vec3,
    interpolation: OnceLock<InterpolationBound>,
}

impl AirTables {
    /// The tables for these options. The default tables ship with the crate. Others are computed on first use in the process, which takes
    /// half a second on two cores.
    pub fn shared(options: &AirOptions) -> Arc<Self> {
        MADE.get(options, || {
            let is_default = *options == AirOptions::default();
            let shipped = is_default.then(shipped::default_tables).flatten();
            shipped.unwrap_or_else(|| {
                if is_default {
                    tracing::warn!(
                        "the air's tables are computed: the feature `tables` compiles them in"
                    );
                }
                Self::compute(options)
            })
        })
    }

    /// Computes the tables; uses all cores.
    pub fn compute(options: &AirOptions) -> Self {
        let builder = Builder::new(AirModel::new(options));
        let Outside {
            scattering,
            bounce,
            through,
        } = builder.outside(SCATTERING.x);
        Self {
            scattering,
            bounce,
            through,
            sunlight: builder.sunlight(),
            transmittance: builder
                .transmittance
                .texels
                .iter()
                .map(|t| texel(*t))
                .collect(),
            sources: builder.sources(),
            profile: fill(PROFILE, |x, _, _| {
                let h = (height_radius(x) - 1.0) * RADIUS_M;
                let exponential = (-h / MOLECULE_SCALE_HEIGHT_M).exp();
                let molecules = (profile::molecules(h) / exponential) as f32;
                Vec4::new(molecules, profile::ozone(h) as f32, 0.0, 1.0)
            }),
            sky_albedo: builder.sources.sky_albedo.rgb(),
            interpolation: OnceLock::new(),
        }
    }

    /// Transmittance of sunlight to clouds at this height, as a row of [`Self::sunlight`]. Sunlight leaves clouds later than the ground.
    pub fn sunlight_on_clouds(&self, height_m: f64) -> Vec<Vec4> {
        let r = (1.0 + height_m / RADIUS_M).min(TOP);
        let horizon = horizon_cosine(r);
        let row = row_at(&self.transmittance, TRANSMITTANCE, r);
        let row = SunRow::new(row, horizon);
        let clouds = (0..SUNLIGHT.x).map(|x| {
            let mu_s = sun_cosine(f64::from(x) / f64::from(SUNLIGHT.x - 1));
            of_disc(mu_s, |mu| row.at(mu))
        });
        clouds.collect()
    }

    /// Where the light may be interpolated; computed on first use.
    pub fn interpolation(&self) -> &InterpolationBound {
        self.interpolation
            .get_or_init(|| InterpolationBound::new(&self.lit_from_outside()))
    }

    fn lit_from_outside(&self) -> LitFromOutside<'_> {
        LitFromOutside {
            rays: SCATTERING.x,
            scattering: &self.scattering,
            bounce: &self.bounce,
            through: &self.through,
            sunlight: &self.sunlight,
            sky_albedo: self.sky_albedo,
        }
    }

    /// Transmittance of sunlight to the ground, and irradiance of the sky on black ground. RGB, relative to the Sun's
    /// irradiance, by the cosine of the Sun's zenith angle.
    pub fn sunlight_at(&self, mu_s: f64) -> [Vec3; 2] {
        let width = SUNLIGHT.x as usize;
        let at = sun_coordinate(mu_s as f32) * (width - 1) as f32;
        let low = (at as usize).min(width - 2);
        [0, width].map(|row| {
            let (a, b) = (self.sunlight[row + low], self.sunlight[row + low + 1]);
            a.lerp(b, at - low as f32).truncate()
        })
    }
}

impl AirAboveClouds {
    /// The tables for these options and a cloud height in metres. The tables of the default atmosphere and height ship with the crate.
    /// Others are computed on first use in the process, which takes a third of a second on two cores.
    pub fn shared(options: &AirOptions, height_m: f64) -> Arc<Self> {
        let key = (*options, height_m);
        MADE_ABOVE_CLOUDS.get(&key, || {
            let is_shipped = key == (AirOptions::default(), above_clouds::SHIPPED_M);
            let shipped = is_shipped.then(shipped::above_clouds).flatten();
            shipped.unwrap_or_else(|| Self::compute(options, height_m))
        })
    }
}

/// Tables that the process has computed or was supplied with.
static MADE: Kept<AirOptions, AirTables> = Kept::none();
static MADE_ABOVE_CLOUDS: Kept<(AirOptions, f64), AirAboveClouds> = Kept::none();

/// Tables by key.
struct Kept<K, T>(Mutex<Vec<(K, Arc<T>)>>);

impl<K: Copy + PartialEq, T> Kept<K, T> {
    /// Number of tables kept. A host that needs more computes some of them again.
    const COUNT: usize = 4;

    const fn none() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    /// The tables of a key; computes them if they are not cached.
    fn get(&self, key: &K, make: impl FnOnce() -> T) -> Arc<T> {
        let mut made = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, tables)) = made.iter().find(|(of, _)| of == key) {
            return tables.clone();
        }
        let tables = Arc::new(make());
        made.truncate(Self::COUNT - 1);
        made.insert(0, (*key, tables.clone()));
        tables
    }

    /// Keeps tables that were made elsewhere.
    fn set(&self, key: K, tables: Arc<T>) {
        let mut made = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        made.retain(|(of, _)| *of != key);
        made.truncate(Self::COUNT - 1);
        made.insert(0, (key, tables));
    }
}

/// Builds tables from an atmosphere whose sources are known everywhere.
struct Builder {
    air: AirModel,
    transmittance: TransmittanceTable,
    sources: Sources,
}

/// Tables of rays that come from outside.
struct Outside {
    scattering: Vec<Vec4>,
    bounce: Vec<Vec4>,
    through: Vec<Vec4>,
}

impl Builder {
    fn new(air: AirModel) -> Self {
        let transmittance = TransmittanceTable::compute(&air);
        let sources = Sources::compute(&air, &transmittance);
        Self {
            air,
            transmittance,
            sources,
        }
    }

    /// The tables of this many rays from outside, rays that meet the ground first.
    fn outside(&self, rays: u32) -> Outside {
        const STEPS: u32 = 32;
        let (suns, azimuths) = (SCATTERING.y, SCATTERING.z);
        let all_light = Light {
            sun: true,
            sources: Some(&self.sources.black),
        };
        let of_ground = Light {
            sun: false,
            sources: Some(&self.sources.bounce),
        };
        let columns = parallel::map(rays as usize, |x| {
            let ray = outside_ray(x as u32);
            let path = |light| Path::new(&self.air, &self.transmittance, ray, STEPS, light);
            let (path, of_ground) = (path(all_light), path(of_ground));
            let through = path.through.rgb();
            let alpha = 1.0 - luminance(through.as_dvec3()) as f32;
            let flat = (1.0 - ray.mu * ray.mu).max(0.0).sqrt();
            let mut scattering = Vec::with_capacity((suns * azimuths) as usize);
            let mut bounce = Vec::with_capacity((suns * BOUNCE.z) as usize);
            for y in 0..suns {
                let mu_s = sun_cosine(f64::from(y) / f64::from(suns - 1));
                let sun_flat = (1.0 - mu_s * mu_s).max(0.0).sqrt();
                let nu = |azimuth: f64| ray.mu * mu_s + flat * sun_flat * azimuth.cos();
                for z in 0..azimuths {
                    let root = f64::from(z) / f64::from(azimuths - 1);
                    let light = path.radiance(mu_s as f32, nu(PI * root * root) as f32);
                    scattering.push(fourth_root(radiance(light)).extend(alpha));
                }
                // Light from the ground depends on the Sun only by its height along the ray, so one azimuth (Sun abeam) is enough.
                let light = of_ground.radiance(mu_s as f32, nu(0.5 * PI) as f32);
                bounce.push(fourth_root(radiance(light)).extend(1.0));
            }
            Column {
                scattering,
                bounce,
                through: through.max(Vec3::ZERO).extend(1.0),
            }
        });
        let texels = |size: TableSize, of: fn(&Column) -> &Vec<Vec4>| {
            let mut texels = Vec::with_capacity(columns.len() * (size.y * size.z) as usize);
            for z in 0..size.z {
                for y in 0..size.y {
                    let index = (y * size.z + z) as usize;
                    texels.extend(columns.iter().map(|column| of(column)[index]));
                }
            }
            texels
        };
        Outside {
            scattering: texels(SCATTERING, |column| &column.scattering),
            bounce: texels(BOUNCE, |column| &column.bounce),
            through: columns.iter().map(|column| column.through).collect(),
        }
    }

    fn sunlight(&self) -> Vec<Vec4> {
        let sky = self.sky_on_ground();
        fill(SUNLIGHT, |x, y, _| {
            texel(match y > 0.5 {
                false => self.direct(sun_cosine(x)),
                true => sky[(x * f64::from(SUNLIGHT.x - 1)).round() as usize],
            })
        })
    }

    /// Transmittance of sunlight to the ground.
    fn direct(&self, mu_s: f64) -> Spectrum {
        let row = self.transmittance.row(1.0, true);
        of_disc(mu_s, |mu| row.at(mu))
    }

    /// Irradiance of the sky on black ground for the Suns of the sunlight table.
    fn sky_on_ground(&self) -> Vec<Spectrum> {
        const AZIMUTHS: u32 = 8;
        let light = Light {
            sun: true,
            sources: Some(&self.sources.black),
        };
        let looks = quadrature::gauss_legendre_10().map(|(x, w)| (0.5 + 0.5 * x, 0.5 * w));
        let rows = parallel::map(looks.len(), |n| {
            let (mu, weight) = looks[n];
            let ray = Ray {
                r: 1.0,
                mu,
                from: 0.0,
                to: to_top(1.0, mu),
                crowd: 0.0,
            };
            let path = Path::new(&self.air, &self.transmittance, ray, 40, light);
            let flat = (1.0 - mu * mu).sqrt();
            let weight = (weight * mu * 2.0 * PI / f64::from(AZIMUTHS)) as f32;
            let of_sun = |x: u32| {
                let mu_s = sun_cosine(f64::from(x) / f64::from(SUNLIGHT.x - 1));
                let sun_flat = (1.0 - mu_s * mu_s).max(0.0).sqrt();
                let turns = (0..AZIMUTHS).map(|turn| {
                    let azimuth = PI * (f64::from(turn) + 0.5) / f64::from(AZIMUTHS);
                    let nu = mu * mu_s + flat * sun_flat * azimuth.cos();
                    path.radiance(mu_s as f32, nu as f32) * weight
                });
                turns.sum::<Spectrum>()
            };
            (0..SUNLIGHT.x).map(of_sun).collect::<Vec<_>>()
        });
        let sum = |x: usize| rows.iter().map(|row| row[x]).sum();
        (0..SUNLIGHT.x as usize).map(sum).collect()
    }

    /// The source table in RGB. Shaders multiply it by RGB coefficients, so it is divided by the coefficients of
    /// its height.
    fn sources(&self) -> Vec<Vec4> {
        let mut out = vec![Vec4::ZERO; SOURCES.texels()];
        for height in 0..HEIGHTS {
            let r = height_radius(height as f64 / (HEIGHTS - 1) as f64);
            let scattering = self.air.medium(r).scattering();
            let per = self.air.scattering_rgb(r);
            for sun in 0..SUNS {
                let at = height * SUNS + sun;
                let colors =
                    |source: &SourceFunction| source.0.map(|c| radiance(c * scattering) / per);
                let black = colors(&self.sources.black.texels[at]);
                // Mean of the ground's light over all directions: the mean of a squared component is a third.
                let bounce = colors(&self.sources.bounce.texels[at]);
                let mean = bounce[0] + (bounce[3] + bounce[4]) / 3.0;
                for (band, color) in black.into_iter().chain([mean]).enumerate() {
                    out[(band * HEIGHTS + height) * SUNS + sun] = color.extend(1.0);
                }
            }
        }
        out
    }
}

/// Mean over the solar disc of a function of the ray's cosine; `None` where the Earth blocks the ray. The disc has a radius of
/// 0.27°, so the Sun sets gradually.
fn of_disc<T>(mu_s: f64, ray: impl Fn(f32) -> Option<T>) -> T
where
    T: Default
        + std::ops::AddAssign
        + std::ops::Mul<f32, Output = T>
        + std::ops::Div<f32, Output = T>,
{
    const CHORDS: u32 = 9;
    let (mut light, mut area) = (T::default(), 0.0);
    for n in 0..CHORDS {
        let x = -1.0 + 2.0 * (f64::from(n) + 0.5) / f64::from(CHORDS);
        let weight = (1.0 - x * x).sqrt() as f32;
        let mu = (mu_s + x * SUN_RADIUS_RAD).clamp(-1.0, 1.0) as f32;
        light += ray(mu).unwrap_or_default() * weight;
        area += weight;
    }
    light / area
}

/// Table column of one ray from outside: Suns and azimuths in sequence.
struct Column {
    scattering: Vec<Vec4>,
    bounce: Vec<Vec4>,
    through: Vec4,
}

/// The ray of a column of the outside tables, by its reference point.
fn outside_ray(x: u32) -> Ray {
    let along = f64::from(x % RAYS) / f64::from(RAYS - 1);
    let squared = along * along;
    match x < RAYS {
        // Meets the ground at zenith cosine `squared`. The ray is followed from its entry, and the ground is its lowest
        // point.
        true => Ray {
            r: 1.0,
            mu: -squared,
            from: -to_top(1.0, squared),
            to: 0.0,
            crowd: 0.0,
        },
        false => {
            let r = 1.0 + (TOP - 1.0) * squared;
            let reach = to_top(r, 0.0).max(1e-9);
            Ray {
                r,
                mu: 0.0,
                from: -reach,
                to: reach,
                crowd: 0.0,
            }
        }
    }
}

/// Radiance per unit irradiance as a fraction of a white sheet's, RGB.
fn radiance(light: Spectrum) -> Vec3 {
    light.rgb() * std::f32::consts::PI
}

/// Encodes light that falls exponentially with height and with twilight. Over a factor of e, linear interpolation is then
/// accurate to 3 %, against 13 % for the light itself. Half floats keep the whole range.
fn fourth_root(light: Vec3) -> Vec3 {
    light.max(Vec3::ZERO).powf(0.25)
}

/// Clips a colour outside the sRGB gamut, as the last red of a sunset.
fn texel(spectrum: Spectrum) -> Vec4 {
    spectrum.rgb().max(Vec3::ZERO).extend(1.0)
}

/// Sun cosine of a table coordinate 0…1: dense around the terminator, where light falls by powers of
/// ten.
pub(super) fn sun_cosine(coordinate: f64) -> f64 {
    let [low, high] = [LOWEST_SUN, 1.0].map(|mu: f64| (mu / SUN_SPACING).asinh());
    SUN_SPACING * (low + coordinate * (high - low)).sinh()
}

/// The inverse of [`sun_cosine`], 0…1.
pub(super) fn sun_coordinate(mu_s: f32) -> f32 {
    // A lookup table, because every step of every ray needs this. Accurate to 1e-5.
    const CELLS: usize = 2048;
    static COORDINATES: LazyLock<Vec<f32>> = LazyLock::new(|| {
        let coordinate = |n: usize| {
            let mu = LOWEST_SUN + (1.0 - LOWEST_SUN) * n as f64 / CELLS as f64;
            let [low, high, at] = [LOWEST_SUN, 1.0, mu].map(|mu: f64| (mu / SUN_SPACING).asinh());
            ((at - low) / (high - low)) as f32
        };
        (0..=CELLS).map(coordinate).collect()
    });
    let low = LOWEST_SUN as f32;
    let at = ((mu_s - low) * (CELLS as f32 / (1.0 - low))).clamp(0.0, CELLS as f32);
    let cell = (at as usize).min(CELLS - 1);
    let (a, b) = (COORDINATES[cell], COORDINATES[cell + 1]);
    a + (b - a) * (at - cell as f32)
}

/// Radius of a height coordinate 0…1, with fine steps near the ground.
fn height_radius(y: f64) -> f64 {
    1.0 + (TOP - 1.0) * y * y
}

fn height_coordinate(r: f64) -> f64 {
    ((r - 1.0) / (TOP - 1.0)).clamp(0.0, 1.0).sqrt()
}

/// Luminance of linear red, green and blue (Rec. 709).
pub const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

fn luminance(v: DVec3) -> f64 {
    v.dot(LUMINANCE)
}

/// The row of a table whose second axis is the height, at radius `r`.
fn row_at<T: Lerp>(table: &[T], size: TableSize, r: f64) -> Vec<T> {
    let at = height_coordinate(r) * f64::from(size.y - 1);
    let low = (at as usize).min(size.y as usize - 2);
    let part = (at - low as f64) as f32;
    let width = size.x as usize;
    let row = |n: usize| &table[n * width..(n + 1) * width];
    let pairs = row(low).iter().zip(row(low + 1));
    pairs.map(|(a, b)| a.between(*b, part)).collect()
}

/// Types stored in tables: a spectrum or its colour.
trait Lerp: Copy {
    /// Interpolates to another value, by fraction `part`.
    fn between(self, other: Self, part: f32) -> Self;
}

impl Lerp for Spectrum {
    fn between(self, other: Self, part: f32) -> Self {
        self.lerp(other, part)
    }
}

impl Lerp for Vec4 {
    fn between(self, other: Self, part: f32) -> Self {
        self.lerp(other, part)
    }
}

/// Fills a table from coordinates 0…1, with the end texels at 0 and 1. Rows are shared among the
/// cores.
fn fill<T: Send>(size: TableSize, f: impl Fn(f64, f64, f64) -> T + Sync) -> Vec<T> {
    let coordinate = |i: u32, n: u32| f64::from(i) / f64::from(n.max(2) - 1);
    let rows = parallel::map((size.y * size.z) as usize, |row| {
        let (y, z) = (row as u32 % size.y, row as u32 / size.y);
        let (y, z) = (coordinate(y, size.y), coordinate(z, size.z));
        let texels = (0..size.x).map(|x| f(coordinate(x, size.x), y, z));
        texels.collect::<Vec<_>>()
    });
    rows.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests;
