//! Position of a pixel on the ground, in f32: `surface_point` of `shaders/earth/surface_point/ray_on_ellipsoid.wgsl`, line by line.
//!
//! `tests/accuracy/extreme` runs the shader itself on the adapter and compares, so that the two stay the same.

use super::formula::{AnyFormula, ErrorMeasure, Form, Formula};
use super::method::log_spaced;
use super::oracle::{Real, Real3, along, dot, real3, scaled};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_8, PI};
use terrella::frames::{Ellipsoid, Geodetic};
use terrella_ground::globe::{Block, COLUMNS, ROWS};

const FIGURE: Ellipsoid = Ellipsoid::WGS84;

/// An eye, a ray and the block that the ray meets.
#[derive(Clone, Copy, Debug)]
pub struct PixelRay {
    pub eye_itrf_m: DVec3,
    /// The pixel's ray, ITRF axes, of any length.
    pub ray: DVec3,
    pub block: Block,
}

/// Input of the shader.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaderInput {
    /// The eye in scaled space.
    pub eye_scaled: Vec3,
    /// |`eye_scaled`|² − 1, computed in f64.
    pub above: f32,
    pub ray: Vec3,
    /// a/b.
    pub polar_stretch: f32,
    /// (cos, sin) of the longitude of the block's centre.
    pub center_lon: Vec2,
    /// (cos, sin) of its latitude.
    pub center_lat: Vec2,
}

/// Result of the shader.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Outward normal.
    pub up: Vec3,
    /// Unit vector east.
    pub east: Vec3,
    /// Texture coordinates on the whole map, from the block's centre.
    pub uv: Vec2,
}

impl PixelRay {
    /// The pixel that sees `place` (height 0) from an eye, in the block that holds it.
    pub fn toward(eye_itrf_m: DVec3, place: Geodetic) -> Self {
        let index = |steps: f64, count: u32| (steps.floor().max(0.0) as u32).min(count - 1);
        Self {
            eye_itrf_m,
            ray: (FIGURE.itrf_from_geodetic(place) - eye_itrf_m).normalize_or_zero(),
            block: Block {
                column: index((place.lon_rad + PI) / FRAC_PI_8, COLUMNS),
                row: index((FRAC_PI_2 - place.lat_rad) / FRAC_PI_8, ROWS),
            },
        }
    }

    /// As `Earth::prepare` makes it.
    pub fn shader_input(&self) -> ShaderInput {
        let eye_scaled = self.eye_itrf_m / FIGURE.itrf_from_scaled();
        let distance = eye_scaled.length();
        let cos_sin = |angle: f64| Vec2::new(angle.cos() as f32, angle.sin() as f32);
        ShaderInput {
            eye_scaled: eye_scaled.as_vec3(),
            above: ((distance - 1.0) * (distance + 1.0)) as f32,
            ray: self.ray.as_vec3(),
            polar_stretch: (FIGURE.equatorial_radius_m / FIGURE.polar_radius_m) as f32,
            center_lon: cos_sin(self.block.center_lon_rad()),
            center_lat: cos_sin(self.block.center_lat_rad()),
        }
    }

    /// Outward normal and the place, exactly: cosine and sine of latitude, and of longitude, as a vector. `None` where the
    /// ray misses.
    fn exact(&self) -> Option<Real3> {
        let scale: Real3 = FIGURE.itrf_from_scaled().to_array().map(Real::from);
        let inverse: Real3 = std::array::from_fn(|k| Real::from(1.0) / &scale[k]);
        let e = scaled(&real3(self.eye_itrf_m), &inverse);
        let d = scaled(&real3(self.ray), &inverse);
        let one = Real::from(1.0);
        let (a, half_b, c) = (dot(&d, &d), dot(&e, &d), dot(&e, &e) - &one);
        let square = half_b.squared() - &a * c;
        if square.is_negative() {
            return None;
        }
        let t = (-half_b - square.sqrt()) / a;
        let normal = scaled(&along(&e, &t, &d), &inverse);
        let length = dot(&normal, &normal).sqrt();
        Some(std::array::from_fn(|k| &normal[k] / &length))
    }
}

/// atan(y/x) for |y/x| ≤ 0.6.
fn atan_near(y: f32, x: f32) -> f32 {
    let t = y / x;
    let s = t * t;
    let far = -0.142_857_14 + s * (0.111_111_11 - s * 0.090_909_09);
    t * (1.0 + s * (-0.333_333_33 + s * (0.2 + s * far)))
}

/// The shader's `surface_point`.
pub fn place(input: &ShaderInput) -> Placed {
    let to_scaled = Vec3::new(1.0, 1.0, input.polar_stretch);
    let scaled = input.ray * to_scaled;
    let d = scaled.normalize();
    let across_ray = input.eye_scaled.cross(d);
    let root = (1.0 - across_ray.dot(across_ray)).max(0.0).sqrt();
    let t = (input.above / (root - input.eye_scaled.dot(d)).max(1e-9)).max(0.0);
    let p = input.eye_scaled + t * d;
    let up = (p * to_scaled).normalize();
    let across = up.truncate().length().max(1e-7);
    let east = Vec3::new(-up.y, up.x, 0.0) / across;
    let x = input.center_lon.dot(up.truncate()).max(1e-7);
    let y = input.center_lon.x * up.y - input.center_lon.y * up.x;
    let beside = x + across;
    let longitude = atan_near(y.clamp(-0.6 * beside, 0.6 * beside), beside);
    let latitude = atan_near(
        input.center_lat.x * up.z - input.center_lat.y * across,
        input.center_lat.x * across + input.center_lat.y * up.z + 1.0,
    );
    const PI: f32 = std::f32::consts::PI;
    Placed {
        up,
        east,
        uv: Vec2::new(longitude / PI, -2.0 * latitude / PI),
    }
}

/// The same by the usual formulas in f32: −b − √(b² − c), u = ½ + atan2(y, x)/2π and v = ½ − asin(z)/π.
fn usual(input: &ShaderInput, center_uv: Vec2) -> Placed {
    let to_scaled = Vec3::new(1.0, 1.0, input.polar_stretch);
    let d = (input.ray * to_scaled).normalize();
    let b = input.eye_scaled.dot(d);
    let c = input.eye_scaled.length_squared() - 1.0;
    let t = -b - (b * b - c).sqrt();
    let up = ((input.eye_scaled + t * d) * to_scaled).normalize();
    const PI: f32 = std::f32::consts::PI;
    Placed {
        up,
        east: Vec3::new(-up.y, up.x, 0.0).normalize_or_zero(),
        uv: Vec2::new(
            0.5 + up.y.atan2(up.x) / (2.0 * PI),
            0.5 - up.z.clamp(-1.0, 1.0).asin() / PI,
        ) - center_uv,
    }
}

/// The mended ray with the usual texture coordinates: what the block's centre gains.
fn whole_map(input: &ShaderInput, center_uv: Vec2) -> Placed {
    const PI: f32 = std::f32::consts::PI;
    let placed = place(input);
    let uv = Vec2::new(
        0.5 + placed.up.y.atan2(placed.up.x) / (2.0 * PI),
        0.5 - placed.up.z.clamp(-1.0, 1.0).asin() / PI,
    );
    Placed {
        uv: uv - center_uv,
        ..placed
    }
}

/// Distance of the texel from the ray, metres: distance on the ground, times the sine of the angle at which the ray meets it. It is the shift on
/// screen, in terms of pixel size and distance.
fn off_across_m(pixel: &PixelRay, placed: &Placed) -> f64 {
    let Some(up) = pixel.exact() else {
        return 0.0;
    };
    let (u, v) = (f64::from(placed.uv.x), f64::from(placed.uv.y));
    if !(u.is_finite() && v.is_finite()) {
        return f64::INFINITY;
    }
    let rho = (up[0].squared() + up[1].squared()).sqrt();
    let (lat, lon) = (up[2].atan2(&rho), up[1].atan2(&up[0]));
    let pi = Real::pi();
    let center = Real::from(i64::from(pixel.block.column)) - Real::from(7.5);
    let turns = center / Real::from(16.0) + Real::from(u) - lon / (&pi + &pi);
    let turns = &turns - (&turns + Real::from(0.5)).floor();
    let east = turns * (&pi + &pi) * rho;
    let center = Real::from(3.5) - Real::from(i64::from(pixel.block.row));
    let north = (center / Real::from(8.0) - Real::from(v)) * pi - lat;
    let ray = pixel.ray.normalize_or_zero();
    let facing = dot(&up, &real3(ray)).abs();
    let ground = (east.squared() + north.squared()).sqrt() * facing;
    ground.to_f64() * FIGURE.equatorial_radius_m
}

/// Angle of the normal from the exact one, radians.
fn normal_off_rad(pixel: &PixelRay, placed: &Placed) -> f64 {
    let Some(up) = pixel.exact() else {
        return 0.0;
    };
    if !placed.up.is_finite() || !placed.east.is_finite() {
        return f64::INFINITY;
    }
    let off: Real3 = std::array::from_fn(|k| Real::from(placed.up.to_array()[k]) - &up[k]);
    dot(&off, &off).sqrt().to_f64()
}

/// Pixels from one height, over several places: towards the ground below, to the side, and towards the limb where the ray meets the ground at 12°.
fn pixels_from(height_m: f64) -> Vec<PixelRay> {
    // Sine of the angle at the centre between the eye and where a ray meets the ground at that slope.
    let ratio = 1.0 / (1.0 + height_m / FIGURE.equatorial_radius_m);
    let slope = 12f64.to_radians();
    let reach = FRAC_PI_2 - slope - (ratio * slope.cos()).asin();
    let places = [(0.0, 0.0), (48.0, 11.3), (-33.0, 179.99), (89.95, -70.0)];
    places
        .into_iter()
        .flat_map(|(lat, lon)| {
            let below = Geodetic::from_degrees(lat, lon, height_m);
            let eye = FIGURE.itrf_from_geodetic(below);
            let up = Ellipsoid::normal(below.lat_rad, below.lon_rad);
            let side = up.any_orthonormal_vector();
            [0.0, 0.3, 0.7, 1.0].into_iter().map(move |part| {
                let angle = reach * part;
                let n = up * angle.cos() + (side + 0.3 * up.cross(side)).normalize() * angle.sin();
                let mut target = FIGURE.geodetic_from_itrf(FIGURE.surface_point(n));
                target.height_m = 0.0;
                PixelRay::toward(eye, target)
            })
        })
        .collect()
}

/// Pixels that see a parallel at so many degrees from either pole, from 100 km.
fn pixels_at_the_poles(off_deg: f64) -> Vec<PixelRay> {
    [1.0, -1.0]
        .into_iter()
        .flat_map(|sign: f64| {
            (0..9).map(move |k| {
                let lon_deg = -180.0 + 43.7 * f64::from(k);
                // From the pole's own height in f64: 90° − 1e-12° is a latitude of its own.
                let lat_rad = sign * (FRAC_PI_2 - off_deg.to_radians());
                let eye = Geodetic::from_degrees(sign * 89.7, 20.0, 1e5);
                let place = Geodetic {
                    lat_rad,
                    lon_rad: lon_deg.to_radians(),
                    height_m: 0.0,
                };
                PixelRay::toward(FIGURE.itrf_from_geodetic(eye), place)
            })
        })
        .collect()
}

/// Pixels that see a meridian at so many degrees on either side of ±180°, from 100 km.
fn pixels_at_the_seam(off_deg: f64) -> Vec<PixelRay> {
    [1.0, -1.0]
        .into_iter()
        .flat_map(|side: f64| {
            [-75.0, -22.5, 0.0, 10.0, 60.0].into_iter().map(move |lat| {
                let eye = Geodetic::from_degrees(lat + 0.2, 179.8, 1e5);
                let place = Geodetic::from_degrees(lat, side * (180.0 - off_deg), 0.0);
                PixelRay::toward(FIGURE.itrf_from_geodetic(eye), place)
            })
        })
        .collect()
}

fn center_uv(pixel: &PixelRay) -> Vec2 {
    pixel.block.center_uv().as_vec2()
}

/// The same as an angle seen from the eye, radians.
fn off_seen_rad(pixel: &PixelRay, placed: &Placed) -> f64 {
    off_across_m(pixel, placed) / pixel.eye_itrf_m.length()
}

fn forms(bound: f64) -> Vec<Form<PixelRay, Placed>> {
    vec![
        Form {
            name: "as usual, f32: −b − √(b² − c), atan2 and asin",
            bound: None,
            value: |pixel| usual(&pixel.shader_input(), center_uv(pixel)),
        },
        Form {
            name: "half mended, f32: c/(−b + √(1 − |e × d|²)), atan2 and asin",
            bound: None,
            value: |pixel| whole_map(&pixel.shader_input(), center_uv(pixel)),
        },
        Form {
            name: "stable, f32: the shader's, angles from the block's centre",
            bound: Some(bound),
            value: |pixel| place(&pixel.shader_input()),
        },
    ]
}

pub(super) fn formulas() -> Vec<Box<dyn AnyFormula>> {
    let across = || ErrorMeasure::by("m across the ray", off_across_m);
    let degrees = || log_spaced(1e-12, 0.3, 2);
    vec![
        Box::new(Formula {
            name: "texture coordinates of a pixel",
            range: "heights from 1 m to 1e8 m, slopes of 12° and more",
            parameter: "height_m",
            values: log_spaced(1.0, 1e8, 2),
            inputs: pixels_from,
            error_measure: across(),
            forms: forms(15.0),
        }),
        Box::new(Formula {
            name: "texture coordinates of a pixel, far away",
            range: "heights from 1e8 m to 1e12 m, slopes of 12° and more",
            parameter: "height_m",
            values: log_spaced(1e8, 1e12, 2),
            inputs: pixels_from,
            error_measure: ErrorMeasure::by("rad seen from the eye", off_seen_rad),
            forms: forms(2e-7),
        }),
        Box::new(Formula {
            name: "texture coordinates at the poles",
            range: "1e-12° to 0.3° from either pole, from 100 km",
            parameter: "off_deg",
            values: degrees(),
            inputs: pixels_at_the_poles,
            error_measure: across(),
            forms: forms(2.0),
        }),
        Box::new(Formula {
            name: "texture coordinates at ±180°",
            range: "1e-12° to 0.3° on either side, from 100 km",
            parameter: "off_deg",
            values: degrees(),
            inputs: pixels_at_the_seam,
            error_measure: across(),
            forms: forms(1.0),
        }),
        Box::new(Formula {
            name: "normal at the poles",
            range: "1e-12° to 0.3° from either pole, from 100 km",
            parameter: "off_deg",
            values: degrees(),
            inputs: pixels_at_the_poles,
            error_measure: ErrorMeasure::by("rad", normal_off_rad),
            forms: forms(2e-7).split_off(2),
        }),
    ]
}
