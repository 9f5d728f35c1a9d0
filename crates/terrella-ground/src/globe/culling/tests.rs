//! Nothing visible is culled, and little that is hidden is kept. Results are compared with single points of ground and lines of sight.

mod context;
mod frustum;
mod horizon;

use super::horizon::{highest_radius, lowest_radius};
use super::*;
use crate::globe::surface::GroundView;
use crate::height::HeightRange;
use glam::dcamera::rh::{self, proj::directx};
use glam::{DMat4, DVec2, DVec3, DVec4};
use std::f64::consts::{PI, TAU};
use terrella_frames::{Ellipsoid, Geodetic};

/// The Earth, the paper's sphere, and figures far flatter and longer than any planet's.
const FIGURES: [Ellipsoid; 4] = [
    Ellipsoid::WGS84,
    Ellipsoid::PAPER_SPHERE,
    Ellipsoid {
        equatorial_radius_m: 6.4e6,
        polar_radius_m: 4.8e6,
    },
    Ellipsoid {
        equatorial_radius_m: 6.0e6,
        polar_radius_m: 6.9e6,
    },
];

/// Lowest and highest ground: flat, the Earth's, all below the ellipsoid, all above it, and far larger.
const RANGES: [(f64, f64); 5] = [
    (0.0, 0.0),
    (-11e3, 9e3),
    (-9e3, -2e3),
    (1e3, 6e3),
    (-1e5, 1e5),
];

/// Heights above the highest ground, from a metre to the Moon. Negative ones are fractions of the way down to the lowest ground.
const EYES_M: [f64; 9] = [1.0, 100.0, 3e3, 4e4, 4e5, 4e6, 3.8e8, -0.5, -0.95];

/// Pseudorandom numbers, the same in each run.
struct Random(u64);

impl Random {
    fn part(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.part()
    }

    fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = self.between(0.0, TAU).sin_cos();
        (DVec2::new(cos, sin) * (1.0 - z * z).sqrt()).extend(z)
    }
}

struct World {
    figure: Ellipsoid,
    range: HeightRange,
    eye: DVec3,
    horizon: Horizon,
}

impl World {
    /// Worlds of every figure, range and eye, in several directions.
    fn all(random: &mut Random, mut check: impl FnMut(&mut Random, &Self)) {
        for figure in FIGURES {
            for (low_m, high_m) in RANGES {
                let range = HeightRange { low_m, high_m };
                for eye_m in EYES_M {
                    let height_m = match eye_m < 0.0 {
                        true => high_m + eye_m * (low_m - high_m).abs(),
                        false => high_m + eye_m,
                    };
                    for _ in 0..4 {
                        let up = random.direction();
                        let eye = figure.surface_point(up) + up * height_m;
                        let shell = GroundShell::new(&figure, range);
                        let horizon = Horizon::new(&figure, eye, shell);
                        check(
                            random,
                            &Self {
                                figure,
                                range,
                                eye,
                                horizon,
                            },
                        );
                    }
                }
            }
        }
    }

    /// A foot, mostly near the horizon, its normal, and a point of ground above it.
    fn ground(&self, random: &mut Random) -> (DVec3, DVec3, DVec3) {
        let up = (self.eye * self.figure.scaled_from_itrf()).normalize();
        let aside = up.cross(random.direction()).normalize();
        let far = self.horizon.far_rad().max(1e-3);
        let theta = match random.part() < 0.7 {
            true => far * random.between(0.6, 1.4),
            false => random.between(0.0, PI),
        };
        let foot = up * theta.cos() + aside * theta.sin();
        let normal = (foot * self.figure.scaled_from_itrf()).normalize();
        // The highest ground is decisive, so most points are high.
        let part = random.part().sqrt();
        let height_m = self.range.low_m + (self.range.high_m - self.range.low_m) * part;
        let point = self.figure.surface_point(normal) + normal * height_m;
        (foot, normal, point)
    }

    /// Clearance of the line of sight to a point above the lowest ground, metres; negative if that ground hides the point.
    ///
    /// Height is the distance from a convex body, and so convex along the line: ternary search finds its minimum.
    fn clearance_m(&self, point: DVec3) -> f64 {
        let along = point - self.eye;
        let above = |t: f64| {
            let place = self.figure.geodetic_from_itrf(self.eye + along * t);
            place.height_m - self.range.low_m
        };
        let (mut from, mut to) = (0.0, 1.0);
        let mut least = above(0.0).min(above(1.0));
        for _ in 0..70 {
            if least < 0.0 {
                break;
            }
            let (one, other) = ((2.0 * from + to) / 3.0, (from + 2.0 * to) / 3.0);
            let (one_m, other_m) = (above(one), above(other));
            least = least.min(one_m).min(other_m);
            match one_m < other_m {
                true => to = other,
                false => from = one,
            }
        }
        least
    }
}

/// A view of the given kind in a random direction.
fn projection(random: &mut Random, kind: u32) -> DMat4 {
    let view_from_eye = rh::view::look_to_mat4(DVec3::ZERO, random.direction(), random.direction());
    let (fov, aspect) = (random.between(0.05, 2.5), random.between(0.3, 3.0));
    let near = 10_f64.powf(random.between(-1.0, 3.0));
    let clip_from_view = match kind {
        0 => directx::perspective_infinite_reverse(fov, aspect, near),
        1 => directx::perspective(fov, aspect, near, near * 1e3),
        2 => directx::perspective_infinite(fov, aspect, near),
        _ => directx::orthographic(-near, near * aspect, -near, near, -near, 10.0 * near),
    };
    clip_from_view * view_from_eye
}
