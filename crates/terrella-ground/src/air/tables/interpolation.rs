//! Where atmospheric light may be interpolated between mesh vertices instead of sampled per pixel.
//!
//! At a point of the ground the light depends on two directions: to the eye and to the Sun. It consists of inscattered light, transmittance, and
//! sunlight and skylight on the ground. Along a side of a cell the normal rotates by β, the side's length over the Earth's radius. The view ray
//! rotates by at most α, the side's length over the eye's distance. A second derivative along the side is then A α² + 2 B αβ + C β². Linear
//! interpolation over half a square cell has at most a quarter of that as error: half the squared radius of its circumcircle. A, B and C are the
//! largest over all azimuths of the Sun and three directions of the side. They are central differences on the tables themselves. How visible an error
//! is depends on the ground's albedo. Over the sea the image is dark and shows inscattered light; white ground shows transmittance.

use super::{RAYS, SCATTERING, SUNLIGHT, sun_coordinate, sun_cosine};
use glam::{Vec3, Vec4};
use std::f32::consts::{FRAC_1_SQRT_2, PI};

/// Nodes, evenly spaced in the tables' own coordinates: the square root of the view cosine, and the
/// Sun coordinate.
const VIEWS: usize = 17;
const SUNS: usize = 33;
/// Azimuths of the Sun relative to the view, 0 to π.
const AZIMUTHS: usize = 5;
/// Steps of the differences, radians: about the span of a cell seen from near by, and from the Earth's
/// centre.
const VIEW_STEP: f32 = 0.12;
const GROUND_STEP: f32 = 0.03;
/// Ground albedos for which errors are judged, from open sea to white.
const ALBEDOS: [f32; GROUNDS] = [0.02, 0.1, 0.35, 1.0];
const GROUNDS: usize = 4;
/// Albedo of the surrounding ground that lights the atmosphere: the Earth's with its clouds. It is sampled per pixel, and its factor
/// is interpolated.
const NEIGHBOURHOOD: f32 = 0.3;
/// Light reflected between ground and atmosphere adds at most a quarter to the irradiance.
const TO_AND_FRO: f32 = 1.25;
/// Largest invisible error: half a step of 8 bits.
const HALF_A_CODE: f32 = 0.5 / 255.0;

/// Bounds of the interpolation error.
pub struct InterpolationBound {
    cells: Vec<[Curvature; GROUNDS]>,
}

/// The bounds for one exposure, in units of the largest invisible error.
pub struct InterpolationLimits {
    cells: Vec<[f32; 3]>,
    exposure: f32,
}

/// Largest second derivatives of light in a cell of nodes, RGB per radian squared.
#[derive(Clone, Copy)]
struct Curvature {
    view: Vec3,
    both: Vec3,
    ground: Vec3,
    /// Smallest light.
    light: Vec3,
}

/// Tables of light over the ground, or over clouds in place of the ground, for an eye outside the
/// atmosphere.
#[derive(Clone, Copy)]
pub(super) struct LitFromOutside<'t> {
    /// Ray count along x; rays that meet the ground come first.
    pub rays: u32,
    pub scattering: &'t [Vec4],
    pub bounce: &'t [Vec4],
    pub through: &'t [Vec4],
    pub sunlight: &'t [Vec4],
    pub sky_albedo: Vec3,
}

/// Effect of the atmosphere at one point.
pub(super) struct Sample {
    light: Vec3,
    through: Vec3,
    /// Irradiance on level ground.
    falls: Vec3,
}

impl InterpolationBound {
    /// Computes the bounds of these tables; takes some milliseconds.
    pub(super) fn new(tables: &LitFromOutside<'_>) -> Self {
        let nodes: Vec<_> = (0..SUNS * VIEWS)
            .map(|n| Curvature::at_node(tables, n % VIEWS, n / VIEWS))
            .collect();
        let cells = (0..SUNS - 1).flat_map(|y| (0..VIEWS - 1).map(move |x| y * VIEWS + x));
        let cells = cells.map(|first| {
            let corners = [0, 1, VIEWS, VIEWS + 1].map(|n| nodes[first + n]);
            corners.into_iter().fold([Curvature::NONE; GROUNDS], worse)
        });
        Self {
            cells: cells.collect(),
        }
    }

    /// Limits for light without an exposure yet; see [`Self::set_shown`].
    pub fn limits(&self) -> InterpolationLimits {
        InterpolationLimits {
            cells: vec![[f32::INFINITY; 3]; self.cells.len()],
            exposure: f32::NAN,
        }
    }

    /// Sets the limits for light that is multiplied by `exposure` and then displayed with a curve. Display values rise by
    /// `display_slope` per unit of multiplied light. Use one set of limits for one curve.
    pub fn set_shown(
        &self,
        limits: &mut InterpolationLimits,
        exposure: f32,
        display_slope: impl Fn(Vec3) -> Vec3,
    ) {
        if limits.exposure == exposure {
            return;
        }
        limits.exposure = exposure;
        for (limit, grounds) in limits.cells.iter_mut().zip(&self.cells) {
            *limit = grounds.iter().fold([0.0; 3], |most: [f32; 3], ground| {
                let slope = display_slope(ground.light * exposure) * exposure;
                let seen = slope * (0.25 / HALF_A_CODE);
                let here = [ground.view, 2.0 * ground.both, ground.ground];
                std::array::from_fn(|n| most[n].max((seen * here[n]).max_element()))
            });
        }
    }
}

impl InterpolationLimits {
    /// Whether interpolation is accurate enough around a vertex. `cosines` are of the zenith angles of the eye and the Sun there.
    /// `spans_rad` is the angle of a cell's side, seen from the eye and from the Earth's centre.
    pub fn allow(&self, cosines: (f32, f32), spans_rad: (f32, f32)) -> bool {
        self.error(cosines, spans_rad) <= 1.0
    }

    /// Bound of the error, in units of the largest invisible error.
    fn error(&self, (mu, mu_s): (f32, f32), (view_rad, ground_rad): (f32, f32)) -> f32 {
        let x = (mu.max(0.0).sqrt() * (VIEWS - 1) as f32) as usize;
        let y = (sun_coordinate(mu_s) * (SUNS - 1) as f32) as usize;
        let [view, both, ground] = self.cells[y.min(SUNS - 2) * (VIEWS - 1) + x.min(VIEWS - 2)];
        view_rad * (view * view_rad + both * ground_rad) + ground * ground_rad * ground_rad
    }
}

fn worse(a: [Curvature; GROUNDS], b: [Curvature; GROUNDS]) -> [Curvature; GROUNDS] {
    std::array::from_fn(|n| Curvature {
        view: a[n].view.max(b[n].view),
        both: a[n].both.max(b[n].both),
        ground: a[n].ground.max(b[n].ground),
        light: a[n].light.min(b[n].light),
    })
}

impl Curvature {
    const NONE: Self = Self {
        view: Vec3::ZERO,
        both: Vec3::ZERO,
        ground: Vec3::ZERO,
        light: Vec3::INFINITY,
    };

    fn at_node(tables: &LitFromOutside<'_>, x: usize, y: usize) -> [Self; GROUNDS] {
        let root = x as f32 / (VIEWS - 1) as f32;
        let mu = root * root;
        let mu_s = sun_cosine(y as f64 / (SUNS - 1) as f64) as f32;
        let view = Vec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
        let flat = (1.0 - mu_s * mu_s).max(0.0).sqrt();
        let sides = [
            Vec3::X,
            Vec3::Y,
            Vec3::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0),
        ];
        let all = (0..AZIMUTHS).flat_map(|azimuth| {
            let (sin, cos) = (azimuth as f32 * PI / (AZIMUTHS - 1) as f32).sin_cos();
            let sun = Vec3::new(flat * cos, flat * sin, mu_s);
            sides.map(|side| Self::along(tables, (view, sun), side))
        });
        all.fold([Self::NONE; GROUNDS], worse)
    }

    /// Differences along a side, at a point whose normal is z.
    fn along(
        tables: &LitFromOutside<'_>,
        (view, sun): (Vec3, Vec3),
        side: Vec3,
    ) -> [Self; GROUNDS] {
        let across = side - side.dot(view) * view;
        let at = |of_view: f32, of_ground: f32| {
            let view = (view - VIEW_STEP * of_view * across).normalize();
            let up = (Vec3::Z + GROUND_STEP * of_ground * side).normalize();
            tables.sample(up, view, sun)
        };
        let here = at(0.0, 0.0);
        let second = |x: f32, y: f32| here.second_differences(&at(x, y), &at(-x, -y));
        let (of_view, of_ground, of_all) = (second(1.0, 0.0), second(0.0, 1.0), second(1.0, 1.0));
        std::array::from_fn(|n| {
            // The second derivative of f(t, t) is the sum of all terms.
            let both = 0.5 * (of_all[n] - of_view[n] - of_ground[n]);
            Self {
                view: of_view[n].abs() / (VIEW_STEP * VIEW_STEP),
                both: both.abs() / (VIEW_STEP * GROUND_STEP),
                ground: of_ground[n].abs() / (GROUND_STEP * GROUND_STEP),
                light: here.seen(ALBEDOS[n]),
            }
        })
    }
}

impl LitFromOutside<'_> {
    /// Sample at a normal `up`, with directions to the eye and to the Sun, all of length 1.
    fn sample(&self, up: Vec3, view: Vec3, sun: Vec3) -> Sample {
        let (mu, mu_s) = (view.dot(up).clamp(0.0, 1.0), sun.dot(up).clamp(-1.0, 1.0));
        let flat = ((1.0 - mu * mu) * (1.0 - mu_s * mu_s)).max(1e-12).sqrt();
        let azimuth = ((mu * mu_s - view.dot(sun)) / flat).clamp(-1.0, 1.0).acos();
        self.at(mu, mu_s, azimuth)
    }

    /// The light of an Earth with this albedo, by the zenith cosines of the eye and the Sun and by the Sun's azimuth.
    #[cfg(test)]
    pub fn over(&self, albedo: f32, (mu, mu_s, azimuth): (f32, f32, f32)) -> Vec3 {
        let sample = self.over_neighbourhood(albedo, (mu, mu_s, azimuth));
        let sent_up = albedo / (1.0 - albedo * self.sky_albedo) * sample.falls;
        sample.light + sample.through * sent_up
    }

    /// Sample by the zenith cosines of the eye and the Sun, and the Sun's azimuth from the ray.
    pub fn at(&self, mu: f32, mu_s: f32, azimuth: f32) -> Sample {
        self.over_neighbourhood(NEIGHBOURHOOD, (mu, mu_s, azimuth))
    }

    /// The same for surrounding ground of a given albedo.
    fn over_neighbourhood(&self, albedo: f32, (mu, mu_s, azimuth): (f32, f32, f32)) -> Sample {
        let x = mu.sqrt() * (RAYS - 1) as f32;
        let y = sun_coordinate(mu_s) * (SCATTERING.y - 1) as f32;
        let z = (azimuth / PI).sqrt() * (SCATTERING.z - 1) as f32;
        let plane = (self.rays * SCATTERING.y) as usize;
        let layer = (z as usize).min(SCATTERING.z as usize - 2);
        let slice = |n: usize| bilinear(&self.scattering[n * plane..][..plane], self.rays, x, y);
        let black = fourth_power(slice(layer).lerp(slice(layer + 1), z - layer as f32));
        let bounce = fourth_power(bilinear(self.bounce, self.rays, x, y));
        let column = (x as usize).min(RAYS as usize - 2);
        let through = self.through[column].lerp(self.through[column + 1], x - column as f32);
        let light_on = sun_coordinate(mu_s) * (SUNLIGHT.x - 1) as f32;
        let row = |n: usize| bilinear(self.sunlight, SUNLIGHT.x, light_on, n as f32).truncate();
        Sample {
            light: black + albedo / (1.0 - albedo * self.sky_albedo) * bounce,
            through: through.truncate(),
            falls: row(0) * mu_s.max(0.0) + row(1),
        }
    }
}

impl Sample {
    /// Light that the eye sees over ground of this albedo.
    pub fn seen(&self, albedo: f32) -> Vec3 {
        self.light + albedo * self.through * self.falls
    }

    /// Second differences of the light of each ground, with its parts interpolated separately.
    fn second_differences(&self, before: &Self, after: &Self) -> [Vec3; GROUNDS] {
        let second = |of: fn(&Self) -> Vec3| of(before) + of(after) - 2.0 * of(self);
        let light = second(|sample| sample.light);
        let through = self.falls * second(|sample| sample.through);
        let falls = self.through * second(|sample| sample.falls);
        ALBEDOS.map(|albedo| light + TO_AND_FRO * albedo * (through + falls))
    }
}

/// Bilinear sample of a table stored row by row.
fn bilinear(texels: &[Vec4], width: u32, x: f32, y: f32) -> Vec4 {
    let width = width as usize;
    let column = (x as usize).min(width - 2);
    let row = (y as usize).min(texels.len() / width - 2);
    let line = |row: usize| {
        let start = row * width + column;
        texels[start].lerp(texels[start + 1], x - column as f32)
    };
    line(row).lerp(line(row + 1), y - row as f32)
}

fn fourth_power(root: Vec4) -> Vec3 {
    let square = root.truncate() * root.truncate();
    square * square
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::{AirOptions, AirTables};

    /// Random numbers 0…1, the same on every machine.
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f32 {
            self.0 = self.0.wrapping_mul(0x5851_F42D_4C95_7F2D).wrapping_add(1);
            (self.0 >> 40) as f32 / (1 << 24) as f32
        }

        fn unit(&mut self) -> Vec3 {
            let z = 2.0 * self.next() - 1.0;
            let (sin, cos) = (2.0 * PI * self.next()).sin_cos();
            let flat = (1.0 - z * z).sqrt();
            Vec3::new(flat * cos, flat * sin, z)
        }
    }

    /// Slope of the sRGB encoding.
    fn display_slope(linear: Vec3) -> Vec3 {
        linear.map(slope_of_channel)
    }

    fn slope_of_channel(linear: f32) -> f32 {
        if linear <= 0.003_130_8 {
            12.92
        } else {
            1.055 / 2.4 * linear.powf(1.0 / 2.4 - 1.0)
        }
    }

    fn encoded(linear: f32) -> f32 {
        if linear <= 0.003_130_8 {
            12.92 * linear
        } else {
            1.055 * linear.powf(1.0 / 2.4) - 0.055
        }
    }

    /// Cells on a sphere, seen from anywhere above the atmosphere under any Sun. Compares the value interpolated at the middle of the
    /// longest side with the exact value.
    #[test]
    fn errors_stay_within_the_bound() {
        let tables = AirTables::shared(&AirOptions::default());
        let lit = tables.lit_from_outside();
        let bound = tables.interpolation();
        let (mut limits, mut random) = (bound.limits(), Random(1));
        let exposure = 1.3;
        bound.set_shown(&mut limits, exposure, display_slope);
        let (mut allowed, mut worst) = (0, 0.0_f32);
        for _ in 0..200_000 {
            let height = 0.03 * (200.0_f32).powf(random.next());
            let eye = (1.0 + height) * Vec3::Z;
            let sun = random.unit();
            let side = 0.03 * random.next();
            let place = random.unit();
            let along = place.any_orthonormal_vector();
            let ends = [-0.5, 0.5]
                .map(|t| (place + t * side * std::f32::consts::SQRT_2 * along).normalize());
            let mut is_allowed = true;
            let mut bound = 0.0_f32;
            for up in ends {
                let to_eye = eye - up;
                let cosines = (to_eye.normalize().dot(up), sun.dot(up));
                let spans = (side / to_eye.length(), side);
                is_allowed &= cosines.0 > 0.0 && cosines.1 > 0.0 && limits.allow(cosines, spans);
                bound = bound.max(limits.error(cosines, spans));
            }
            if !is_allowed {
                continue;
            }
            allowed += 1;
            let at = |up: Vec3| lit.sample(up, (eye - up).normalize(), sun);
            let ([a, b], right) = (ends.map(at), at(place));
            let mean = Sample {
                light: 0.5 * (a.light + b.light),
                through: 0.5 * (a.through + b.through),
                falls: 0.5 * (a.falls + b.falls),
            };
            for albedo in [0.02, 0.1, 0.2, 0.35, 0.6, 1.0] {
                let codes = |sample: &Sample| (exposure * sample.seen(albedo)).map(encoded) * 255.0;
                let error = (codes(&mean) - codes(&right)).abs().max_element();
                worst = worst.max(error);
                assert!(
                    error <= 0.5,
                    "{error} codes over {albedo}, {bound} of what is not seen"
                );
            }
        }
        // Both enough cells and measurable errors occurred.
        assert!(allowed > 5_000 && worst > 0.1, "{allowed} {worst}");
    }

    #[test]
    fn the_limb_and_the_terminator_are_never_interpolated_in_large_cells() {
        let tables = AirTables::shared(&AirOptions::default());
        let mut limits = tables.interpolation().limits();
        let bound = tables.interpolation();
        bound.set_shown(&mut limits, 1.0, display_slope);
        let side = 0.0164;
        let near = (side / 0.1, side);
        assert!(limits.allow((0.9, 0.8), (side / 0.3, side)));
        for (mu, mu_s) in [
            (0.01, 0.8),
            (0.9, 0.01),
            (0.9, 0.001),
            (0.0, 0.0),
            (f32::NAN, 0.5),
        ] {
            assert!(!limits.allow((mu, mu_s), near), "{mu} {mu_s}");
        }
        assert!(!limits.allow((0.9, 0.8), (f32::NAN, side)));
        // Nothing is interpolated before the exposure is known.
        assert!(
            !tables
                .interpolation()
                .limits()
                .allow((0.9, 0.8), (1e-3, 1e-3))
        );
    }
}
