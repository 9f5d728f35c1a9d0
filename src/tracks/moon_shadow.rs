//! The Moon's shadow on the ground: the outlines of umbra and penumbra.

use super::buffers::LineWriter;
use super::ink::Ink;
use super::lines::LineStyle;
use super::projection::EyeProjection;
use crate::gpu::{LinePoint, PassFormat, TRACK_ON_GROUND, TRACK_UNCASED};
use glam::DVec3;
use std::f64::consts::TAU;
use terrella_frames::{Ellipsoid, MOON_RADIUS_M, MoonShadow, SUN_RADIUS_M};

/// Number of rays of a shadow cone; the first is not repeated.
pub const SHADOW_POINTS: usize = 360;
/// Bisections of the angle between a ray that meets the ground and one that misses it: accurate to a metre on the ground.
const HALVINGS: usize = 40;
/// Opacity of the penumbra's outline, relative to that of the style.
const PENUMBRA_OPACITY: f64 = 0.6;

/// A part of the Moon's shadow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShadowPart {
    /// Where the Moon covers the Sun; beyond the tip of the umbra, where the Sun is a ring around the Moon (the antumbra).
    Umbra,
    /// Where the Moon covers a part of the Sun.
    Penumbra,
}

/// The outline of a part of the Moon's shadow on the sunlit side of the ellipsoid: its points in order, ITRF metres, each with a flag that it is
/// connected with the one before. The outline is closed, or ends where the shadow leaves the Earth.
///
/// The rays are tangent to Sun and Moon. With the distance D of their centres the cone has the half angle α, sin α = (R☉ ∓ R☾)/D.
pub fn shadow_outline(
    shadow: &MoonShadow,
    part: ShadowPart,
    ellipsoid: &Ellipsoid,
    mut give: impl FnMut(DVec3, bool),
) {
    let axis = shadow.axis();
    if axis == DVec3::ZERO {
        return;
    }
    let distance_m = shadow.spread() * SUN_RADIUS_M;
    // Rays of the penumbra cross the axis between Sun and Moon, and diverge from it behind the Moon.
    let sin = match part {
        ShadowPart::Umbra => (MOON_RADIUS_M - SUN_RADIUS_M) / distance_m,
        ShadowPart::Penumbra => (MOON_RADIUS_M + SUN_RADIUS_M) / distance_m,
    };
    let cos = ((1.0 - sin) * (1.0 + sin)).max(0.0).sqrt();
    let (u, v) = axis.any_orthonormal_pair();
    let ground = |turn: f64| {
        let (across, along) = turn.sin_cos();
        let out = along * u + across * v;
        let tangent = shadow.moon_itrf_m() + MOON_RADIUS_M * (cos * out - sin * axis);
        ray_on_ground(tangent, cos * axis + sin * out, ellipsoid)
    };
    let turn = |k: usize| TAU * k as f64 / SHADOW_POINTS as f64;
    let mut before = ground(turn(0));
    if let Some(first) = before {
        give(first, false);
    }
    for k in 1..=SHADOW_POINTS {
        let point = ground(turn(k));
        match (before, point) {
            (Some(_), Some(point)) => give(point, true),
            (Some(_), None) => give_end(&ground, turn(k - 1), turn(k), |end| give(end, true)),
            (None, Some(point)) => {
                give_end(&ground, turn(k), turn(k - 1), |end| give(end, false));
                give(point, true);
            }
            (None, None) => {}
        }
        before = point;
    }
}

/// The last point between a ray that meets the ground and one that misses it.
fn give_end(
    ground: &impl Fn(f64) -> Option<DVec3>,
    mut hit: f64,
    mut miss: f64,
    give: impl FnOnce(DVec3),
) {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (hit + miss);
        match ground(middle) {
            Some(_) => hit = middle,
            None => miss = middle,
        }
    }
    if let Some(end) = ground(hit) {
        give(end);
    }
}

/// Where a ray first meets the ellipsoid, ITRF metres.
fn ray_on_ground(from: DVec3, direction: DVec3, ellipsoid: &Ellipsoid) -> Option<DVec3> {
    let scale = ellipsoid.scaled_from_itrf();
    let (from, along) = (scale * from, (scale * direction).try_normalize()?);
    let nearest = -from.dot(along);
    let off = from.cross(along).length();
    let half_chord = ((1.0 - off) * (1.0 + off)).sqrt();
    // Also false for NaN.
    let is_met = nearest > half_chord;
    let point = (from + (nearest - half_chord) * along).normalize();
    is_met.then(|| ellipsoid.itrf_from_scaled() * point)
}

/// The outlines, and their colour as the target of the pass stores it.
#[derive(Clone)]
pub(super) struct InkedShadow {
    pub style: LineStyle,
    ink: Ink,
}

impl InkedShadow {
    pub fn new(style: LineStyle, format: &PassFormat) -> Self {
        let ink = Ink::new(format, style.color, true);
        Self { style, ink }
    }

    pub fn write(&self, shadow: &MoonShadow, eye: &EyeProjection<'_>, points: &mut Vec<LinePoint>) {
        let radius_m = eye.ellipsoid.equatorial_radius_m;
        if !shadow.reaches(DVec3::ZERO, radius_m) {
            return;
        }
        let casing = match self.style.is_cased {
            true => 0,
            false => TRACK_UNCASED,
        };
        for (part, opacity) in [
            (ShadowPart::Penumbra, PENUMBRA_OPACITY),
            (ShadowPart::Umbra, 1.0),
        ] {
            let flags = TRACK_ON_GROUND | casing;
            let half_width_px = 0.5 * self.style.width_px;
            let mut line = LineWriter::new(&self.ink, half_width_px, flags, eye, points);
            let opacity = opacity * self.style.opacity;
            shadow_outline(shadow, part, eye.ellipsoid, |point, is_joined| {
                if !is_joined {
                    line.begin();
                }
                line.add(point, opacity);
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella_frames::ASTRONOMICAL_UNIT_M;

    /// Angular distance of the centres of Sun and Moon from a position, and the sum and the difference of their radii there, radians.
    fn angles(shadow: &MoonShadow, place: DVec3) -> (f64, f64, f64) {
        let moon = shadow.moon_itrf_m();
        let sun = moon - shadow.axis() * shadow.spread() * SUN_RADIUS_M;
        let (to_sun, to_moon) = (sun - place, moon - place);
        let apart = to_sun.cross(to_moon).length().atan2(to_sun.dot(to_moon));
        let radii = [(SUN_RADIUS_M, to_sun), (MOON_RADIUS_M, to_moon)];
        let [sun, moon] = radii.map(|(radius, to)| (radius / to.length()).asin());
        (apart, moon + sun, (moon - sun).abs())
    }

    /// At every point of an outline the discs touch, externally for the penumbra and internally for the umbra, whether the eclipse is total,
    /// annular or leaves the Earth.
    #[test]
    fn discs_touch_where_the_shadow_begins() {
        let sun = DVec3::new(0.9, 0.1, 0.35).normalize() * ASTRONOMICAL_UNIT_M;
        let (across, _) = sun.normalize().any_orthonormal_pair();
        for (moon_m, off_m, is_whole) in [
            (3.6e8, 1e5, [true, true]),
            (4.0e8, 1e5, [true, true]),
            (3.7e8, 5e6, [true, false]),
            (3.7e8, 8e6, [false, false]),
            (3.7e8, 2e7, [false, false]),
        ] {
            let shadow = MoonShadow::new(sun, sun.normalize() * moon_m + across * off_m);
            for (part, is_whole) in [ShadowPart::Umbra, ShadowPart::Penumbra]
                .into_iter()
                .zip(is_whole)
            {
                let (mut count, mut breaks, mut ends) = (0, 0, Vec::new());
                shadow_outline(&shadow, part, &Ellipsoid::WGS84, |point, is_joined| {
                    let (apart, sum, difference) = angles(&shadow, point);
                    let limit = match part {
                        ShadowPart::Umbra => difference,
                        ShadowPart::Penumbra => sum,
                    };
                    assert!(
                        (apart - limit).abs() < 1e-11,
                        "{part:?} {moon_m} {off_m}: {apart} {limit}"
                    );
                    let up = Ellipsoid::WGS84.scaled_from_itrf() * point;
                    assert!((up.length() - 1.0).abs() < 1e-12);
                    let to_sun = (sun - point).normalize();
                    let normal = (Ellipsoid::WGS84.scaled_from_itrf() * up).normalize();
                    ends.push(to_sun.dot(normal));
                    count += 1;
                    breaks += usize::from(!is_joined);
                });
                match (is_whole, part) {
                    (true, _) => assert_eq!((count, breaks), (SHADOW_POINTS + 1, 1)),
                    (false, ShadowPart::Penumbra) if off_m < 1e7 => {
                        // The outline ends at sunrise and sunset, to half a degree: the Sun's disc and the slope of the cone.
                        assert!(count > 50 && (1..=2).contains(&breaks), "{count} {breaks}");
                        let lowest = ends.iter().copied().fold(1.0, f64::min);
                        assert!(lowest < 0.01, "{lowest}");
                    }
                    _ => assert_eq!(count, 0, "{part:?} {moon_m} {off_m}"),
                }
            }
        }
    }
}
