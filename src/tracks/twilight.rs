//! The terminator and the ends of twilight: lines on the ground of equal elevation of the Sun.

use super::buffers::LineWriter;
use super::ink::Ink;
use super::lines::LineStyle;
use super::projection::EyeProjection;
use crate::gpu::{LinePoint, PassFormat, TRACK_ON_GROUND, TRACK_UNCASED};
use glam::DVec3;
use std::f64::consts::TAU;
use terrella_frames::Ellipsoid;

/// Elevations of the Sun's centre at which [`Tracks::set_twilight`](super::Tracks::set_twilight) draws lines, degrees: the terminator, and
/// the ends of civil, nautical and astronomical twilight.
pub const TWILIGHT_DEG: [f64; 4] = [0.0, -6.0, -12.0, -18.0];
/// Number of points of a line; the first is not repeated.
pub const TWILIGHT_POINTS: usize = 720;
/// Opacity of these lines, relative to that of their style.
const OPACITIES: [f64; 4] = [1.0, 0.7, 0.5, 0.35];

/// The points where the Sun's centre is `elevation_rad` above the plane normal to the ellipsoid's normal: [`TWILIGHT_POINTS`] points on the
/// ellipsoid, ITRF metres. `sun_itrf` is the direction to the Sun, unit. Without refraction and parallax.
///
/// With the Sun's direction s the normals of these places are n·s = sin h: a circle about s, whatever the figure.
pub fn twilight_line(
    sun_itrf: DVec3,
    elevation_rad: f64,
    ellipsoid: &Ellipsoid,
    mut give: impl FnMut(DVec3),
) {
    let (u, v) = sun_itrf.any_orthonormal_pair();
    let (sin, cos) = elevation_rad.sin_cos();
    for k in 0..TWILIGHT_POINTS {
        let (across, along) = (TAU * k as f64 / TWILIGHT_POINTS as f64).sin_cos();
        give(ellipsoid.surface_point(sin * sun_itrf + cos * (along * u + across * v)));
    }
}

/// The lines, and their colour as the target stores it.
#[derive(Clone)]
pub(super) struct InkedTwilight {
    pub style: LineStyle,
    ink: Ink,
}

impl InkedTwilight {
    pub fn new(style: LineStyle, format: &PassFormat) -> Self {
        let ink = Ink::new(format, style.color, true);
        Self { style, ink }
    }

    pub fn write(&self, sun_itrf: DVec3, eye: &EyeProjection<'_>, points: &mut Vec<LinePoint>) {
        let casing = if self.style.is_cased {
            0
        } else {
            TRACK_UNCASED
        };
        let half_width_px = 0.5 * self.style.width_px;
        for (elevation_deg, opacity) in TWILIGHT_DEG.into_iter().zip(OPACITIES) {
            let flags = TRACK_ON_GROUND | casing;
            let mut line = LineWriter::new(&self.ink, half_width_px, flags, eye, points);
            let mut first = None;
            let opacity = opacity * self.style.opacity;
            twilight_line(
                sun_itrf,
                elevation_deg.to_radians(),
                eye.ellipsoid,
                |point| {
                    first.get_or_insert(point);
                    line.add(point, opacity);
                },
            );
            if let Some(first) = first {
                line.add(first, opacity);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// sin h = sin φ sin δ + cos φ cos δ cos H (Meeus 1998, 13.6), φ by tan φ = z / ((1 − e²) ρ).
    #[test]
    fn the_sun_stands_at_the_elevation_of_each_line() {
        let flattening = 1.0 / 298.257_223_563;
        let e2 = flattening * (2.0 - flattening);
        for (declination_deg, lon_deg) in [(0.0_f64, 0.0_f64), (23.44, -120.0), (-17.3, 179.9)] {
            let (declination, sun_lon) = (declination_deg.to_radians(), lon_deg.to_radians());
            let sun = DVec3::new(
                declination.cos() * sun_lon.cos(),
                declination.cos() * sun_lon.sin(),
                declination.sin(),
            );
            for elevation_deg in TWILIGHT_DEG {
                let mut count = 0;
                let mut before: Option<DVec3> = None;
                twilight_line(
                    sun,
                    elevation_deg.to_radians(),
                    &Ellipsoid::WGS84,
                    |point| {
                        let lat = point.z.atan2((1.0 - e2) * point.x.hypot(point.y));
                        let hour_angle = sun_lon - point.y.atan2(point.x);
                        let sine = lat.sin() * declination.sin()
                            + lat.cos() * declination.cos() * hour_angle.cos();
                        let off_deg = sine.asin().to_degrees() - elevation_deg;
                        assert!(off_deg.abs() < 1e-9, "{off_deg}°");
                        let (a, b) = (6_378_137.0_f64, 6_356_752.314_245_179_f64);
                        let sum = (point.x.powi(2) + point.y.powi(2)) / (a * a)
                            + point.z.powi(2) / (b * b);
                        assert!((sum - 1.0).abs() < 1e-12);
                        assert!(before.is_none_or(|before| before.distance(point) < 60e3));
                        before = Some(point);
                        count += 1;
                    },
                );
                assert_eq!(count, TWILIGHT_POINTS);
            }
        }
    }
}
