//! The light of the sunlit Earth on a spacecraft: the mean light of the disc below, and how much of it a tilted sheet gets.

use glam::{DVec3, Vec3, Vec4};
use std::f64::consts::{PI, TAU};
use terrella::frames::Ellipsoid;
use terrella_imagery::NEIGHBOURHOODS;

/// Columns and rows of the map of albedo.
const CELLS: [usize; 2] = [NEIGHBOURHOODS as usize, NEIGHBOURHOODS as usize / 2];

/// Rings of the disc, of equal weight for a sheet that faces it, and rays of each.
const RINGS: u32 = 8;
const RAYS: u32 = 12;

/// The Earth's disc as a craft sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EarthDisc {
    /// Mean light, linear; a white diffuse sheet that faces the Sun is 1.
    pub light: Vec3,
    /// Sine of the angle between the Earth's centre and its limb, 0…1.
    pub limb_sine: f64,
}

impl EarthDisc {
    /// The disc seen from a position. `albedo` is what neighbourhoods of the ground reflect with their clouds, as
    /// `NeighbourhoodAlbedo::texels` has them; the air's own light is left out.
    ///
    /// L = (1/sin²φ) ∫ a(P) max(N·S, 0) cos θ dω/π over the disc of angular radius φ, by equal parts of sin²θ.
    pub fn seen_from(
        position_itrf_m: DVec3,
        ellipsoid: &Ellipsoid,
        sun_itrf: DVec3,
        albedo: &[Vec4],
    ) -> Self {
        let scale = ellipsoid.itrf_from_scaled();
        let eye = position_itrf_m / scale;
        let limb_sine = 1.0 / eye.length().max(1.0);
        let down = -position_itrf_m.normalize_or(DVec3::X);
        let (across, ahead) = down.any_orthonormal_pair();
        let (mut light, mut count) = (Vec3::ZERO, 0.0);
        for n in 0..RINGS * RAYS {
            let [ring, ray] = [n / RAYS, n % RAYS].map(f64::from);
            let sine = limb_sine * ((ring + 0.5) / f64::from(RINGS)).sqrt();
            let turn = TAU * (ray + 0.5 * ring) / f64::from(RAYS);
            let cosine = (1.0 - sine * sine).max(0.0).sqrt();
            let direction = cosine * down + sine * (turn.cos() * across + turn.sin() * ahead);
            let Some(ground) = meets(eye, direction / scale) else {
                continue;
            };
            let normal = (ground / scale).normalize_or_zero();
            let height = normal.dot(sun_itrf).max(0.0) as f32;
            light += height * albedo_at(normal, albedo);
            count += 1.0;
        }
        Self {
            light: light / f32::max(count, 1.0),
            limb_sine,
        }
    }
}

/// First intersection of a ray with the unit sphere; `None` if it misses.
fn meets(eye: DVec3, direction: DVec3) -> Option<DVec3> {
    let direction = direction.normalize_or_zero();
    let ahead = -eye.dot(direction);
    let beside = eye + ahead * direction;
    let left = 1.0 - beside.length_squared();
    (ahead > 0.0 && left >= 0.0).then(|| beside - left.sqrt() * direction)
}

/// The texel of a place by the vertical there. The map has its last column before the first, and its first after the last.
fn albedo_at(normal: DVec3, albedo: &[Vec4]) -> Vec3 {
    let [columns, rows] = CELLS;
    let east = (normal.y.atan2(normal.x) + PI) / TAU;
    let south = (0.5 * PI - normal.z.clamp(-1.0, 1.0).asin()) / PI;
    let column = ((east * columns as f64) as usize).min(columns - 1);
    let row = ((south * rows as f64) as usize).min(rows - 1);
    let texel = albedo.get(row * (columns + 2) + column + 1);
    texel.map_or(Vec3::ZERO, |texel| texel.truncate())
}

/// Whether the Earth hides a distant direction.
pub fn hides(position_itrf_m: DVec3, direction: DVec3, ellipsoid: &Ellipsoid) -> bool {
    let scale = ellipsoid.itrf_from_scaled();
    meets(position_itrf_m / scale, direction / scale).is_some()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// As `tilted_view_factor` in shaders/craft_model.wgsl.
    fn tilted_view_factor(c: f64, limb_sine: f64) -> f64 {
        let limb_cosine = (1.0 - limb_sine * limb_sine).max(0.0).sqrt();
        let k = limb_sine * limb_sine;
        if c >= limb_sine {
            return c * k;
        }
        if c <= -limb_sine {
            return 0.0;
        }
        let s = (1.0 - c * c).sqrt();
        let turned = (-limb_cosine * c / (limb_sine * s)).clamp(-1.0, 1.0).acos();
        let cut = (limb_cosine / s).clamp(-1.0, 1.0).asin();
        let edge = limb_cosine * (k - c * c).max(0.0).sqrt();
        (0.5 - cut / PI + (k * c * turned - edge) / PI).max(0.0)
    }

    /// ∫ max(N·ω, 0) dω/π over a cap of directions about the axis, by the middles of `parts` × `parts` parts.
    pub fn integrated(c: f64, limb_sine: f64, parts: u32) -> f64 {
        let limb_cosine = (1.0 - limb_sine * limb_sine).sqrt();
        let s = (1.0 - c * c).sqrt();
        let (rings, turns) = (parts, parts);
        let mut sum = 0.0;
        for ring in 0..rings {
            let z = 1.0 - (1.0 - limb_cosine) * (f64::from(ring) + 0.5) / f64::from(rings);
            let r = (1.0 - z * z).sqrt();
            for turn in 0..turns {
                let x = r * (TAU * (f64::from(turn) + 0.5) / f64::from(turns)).cos();
                sum += (c * z + s * x).max(0.0);
            }
        }
        sum * TAU * (1.0 - limb_cosine) / f64::from(rings * turns) / PI
    }

    #[test]
    fn a_tilted_sheet_gets_what_integration_says() {
        for limb_sine in [0.15, 0.6, 0.94] {
            for degrees in [0.0_f64, 30.0, 60.0, 85.0, 95.0, 120.0, 150.0] {
                let c = degrees.to_radians().cos();
                let (formula, sum) = (
                    tilted_view_factor(c, limb_sine),
                    integrated(c, limb_sine, 1000),
                );
                assert!(
                    (formula - sum).abs() < 2e-5,
                    "{limb_sine} {degrees}: {formula} {sum}"
                );
            }
        }
    }

    /// Under an even albedo and far away the disc is a sphere of Lambert: its light is ⅔ of the albedo at full phase, times
    /// (sin α + (π − α) cos α)/π at the phase angle α.
    #[test]
    fn from_afar_the_disc_has_the_phases_of_a_sphere_of_lambert() {
        let [columns, rows] = CELLS;
        let even = vec![Vec4::new(0.3, 0.3, 0.3, 1.0); (columns + 2) * rows];
        let far_m = DVec3::new(1e12, 0.0, 0.0);
        for phase_deg in [0.0_f64, 45.0, 90.0, 135.0] {
            let a = phase_deg.to_radians();
            let sun = DVec3::new(a.cos(), a.sin(), 0.0);
            let disc = EarthDisc::seen_from(far_m, &Ellipsoid::WGS84, sun, &even);
            let expected = 0.3 * 2.0 / 3.0 * (a.sin() + (PI - a) * a.cos()) / PI;
            let got = f64::from(disc.light.x);
            assert!(
                (got - expected).abs() < 0.004,
                "{phase_deg}: {got} {expected}"
            );
        }
    }

    #[test]
    fn the_ground_below_counts_where_it_is() {
        let [columns, rows] = CELLS;
        let mut albedo = vec![Vec4::ZERO; (columns + 2) * rows];
        // Around 90° E on the equator.
        for row in rows / 2 - 4..rows / 2 + 4 {
            for column in columns * 3 / 4 - 4..columns * 3 / 4 + 4 {
                albedo[row * (columns + 2) + column + 1] = Vec4::ONE;
            }
        }
        let from = |position: DVec3| {
            let disc = EarthDisc::seen_from(position, &Ellipsoid::WGS84, DVec3::Y, &albedo);
            disc.light.x
        };
        assert!(from(DVec3::Y * 6.8e6) > 0.9);
        assert_eq!(from(DVec3::NEG_Y * 6.8e6), 0.0);
        assert!(from(DVec3::X * 6.8e6) < 0.05);
        assert!(hides(DVec3::X * 7e6, DVec3::NEG_X, &Ellipsoid::WGS84));
        assert!(!hides(DVec3::X * 7e6, DVec3::Z, &Ellipsoid::WGS84));
    }
}
