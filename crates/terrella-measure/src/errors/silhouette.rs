//! The drawn limb against the analytic one, to a small part of a pixel.

use super::geolocation::GeolocationBuffer;
use super::{pixel_of, pixel_rad};
use crate::SortedSample;
use glam::DVec3;
use std::f64::consts::TAU;
use terrella::EyeView;
use terrella::frames::Ellipsoid;
use terrella_play::PlayError;

/// How far the drawn limb is from the true one, in pixels of the picture across the limb.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SilhouetteErrors {
    /// Largest of the places that were looked at.
    pub max_px: f64,
    /// Median of them.
    pub median_px: f64,
    /// Number of places on the limb that were measured.
    pub places: usize,
    /// Whether they are inside the image. If it shows no limb, the points go around the whole horizon, with pixels as large as in the middle of the
    /// image.
    pub in_view: bool,
}

/// Draws where the pixels of a view and size look.
pub type DrawGeolocation<'d> =
    dyn FnMut(&EyeView, (u32, u32)) -> Result<GeolocationBuffer, PlayError> + 'd;

/// Places of the limb that are tried; those in the picture are kept.
const CANDIDATES: usize = 720;
/// Most places that are looked at.
const MAX_PLACES: usize = 64;
/// Width and height of the strip across the limb, its own pixels.
const STRIP: (u32, u32) = (4, 1024);
/// Initial half height, pixels of the image: its own pixels are 1/64 of that.
const WINDOW_PX: f64 = 8.0;
/// Most of half its height, on a plane ahead of the eye.
const MAX_HALF_HEIGHT: f64 = 2.0;

/// A point of the analytic limb.
struct LimbPoint {
    /// From the eye, unit.
    direction: DVec3,
    /// The ground's normal there, at right angles to the direction: towards space.
    outward: DVec3,
}

/// Samples up to 64 points of a view's limb.
///
/// At each, the same eye looks straight at the limb's point and renders a strip across it, at 64 times the resolution of the image. The mesh
/// depends on the position of the eye and not on its direction, so the edge found there is that of the image. `draw` renders such a strip; it gets
/// the view and the size.
///
/// Nothing is sampled from inside the figure.
///
/// # Errors
/// Errors of `draw`.
pub fn silhouette(
    view: &EyeView,
    figure: &Ellipsoid,
    size: (u32, u32),
    draw: &mut DrawGeolocation<'_>,
) -> Result<SilhouetteErrors, PlayError> {
    let (eye_itrf_m, _) = view.to_itrf();
    let all = limb(eye_itrf_m, figure);
    let (width, height) = (f64::from(size.0), f64::from(size.1));
    let in_view: Vec<_> = all
        .iter()
        .filter(|point| {
            pixel_of(view, size, point.direction)
                .is_some_and(|at| (0.0..width).contains(&at.x) && (0.0..height).contains(&at.y))
        })
        .collect();
    let shows_limb = !in_view.is_empty();
    let looked_at = if shows_limb {
        in_view
    } else {
        all.iter().collect()
    };
    let step = looked_at.len().div_ceil(MAX_PLACES).max(1);
    let mut errors = Vec::new();
    for point in looked_at.into_iter().step_by(step) {
        let lift = edge_above(view, point, eye_itrf_m, size, draw)?;
        let edge = point.direction + lift * point.outward;
        let apart = match (
            pixel_of(view, size, point.direction),
            pixel_of(view, size, edge),
        ) {
            (Some(limb), Some(edge)) if shows_limb => limb.distance(edge),
            _ => lift.abs() / pixel_rad(view, size),
        };
        errors.push(apart);
    }
    let errors = SortedSample::new(errors);
    Ok(SilhouetteErrors {
        max_px: errors.max(),
        median_px: errors.median(),
        places: errors.len(),
        in_view: shows_limb,
    })
}

/// Points of the analytic limb, evenly spaced in scaled space; none from inside.
fn limb(eye_itrf_m: DVec3, figure: &Ellipsoid) -> Vec<LimbPoint> {
    let scale = figure.itrf_from_scaled();
    let eye = eye_itrf_m / scale;
    let distance = eye.length();
    if !(distance.is_finite() && distance > 1.0) {
        return Vec::new();
    }
    // Tangents touch the unit sphere at P·e = 1: e/|e|² and √(|e|² − 1)/|e| across.
    let middle = eye / (distance * distance);
    let radius = ((distance - 1.0) * (distance + 1.0)).sqrt() / distance;
    let right = eye.normalize().any_orthonormal_vector();
    let above = eye.normalize().cross(right);
    let points = (0..CANDIDATES).map(|n| {
        let (sin, cos) = (TAU * n as f64 / CANDIDATES as f64).sin_cos();
        let touch = middle + radius * (cos * right + sin * above);
        LimbPoint {
            direction: (touch * scale - eye_itrf_m).normalize(),
            outward: (touch / scale).normalize(),
        }
    });
    points.collect()
}

/// How far outside the analytic limb the drawn ground ends, on a plane one unit ahead of the eye; negative inside.
fn edge_above(
    view: &EyeView,
    point: &LimbPoint,
    eye_itrf_m: DVec3,
    size: (u32, u32),
    draw: &mut DrawGeolocation<'_>,
) -> Result<f64, PlayError> {
    let (columns, rows) = STRIP;
    let aspect = f64::from(columns) / f64::from(rows);
    let mut half = (WINDOW_PX * pixel_rad(view, size)).min(MAX_HALF_HEIGHT);
    loop {
        let fov_rad = 2.0 * half.atan();
        let strip = EyeView::itrf(eye_itrf_m, point.direction, point.outward, fov_rad, aspect);
        let places = draw(&strip, STRIP)?;
        // The highest row that is ground; space is above it.
        let edge = (0..rows).find(|row| places.is_ground(columns / 2, *row));
        let row = edge.unwrap_or(rows);
        if (1..rows).contains(&row) || half >= MAX_HALF_HEIGHT {
            return Ok((1.0 - 2.0 * f64::from(row) / f64::from(rows)) * half);
        }
        half = (8.0 * half).min(MAX_HALF_HEIGHT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella::frames::Geodetic;

    #[test]
    fn the_limb_is_where_rays_graze() {
        for (figure, height_m) in [
            (Ellipsoid::WGS84, 1e5),
            (Ellipsoid::WGS84, 4e8),
            (Ellipsoid::PAPER_SPHERE, 2e6),
        ] {
            let place = Geodetic::from_degrees(50.0, 20.0, height_m);
            let eye = figure.itrf_from_geodetic(place);
            let points = limb(eye, &figure);
            assert_eq!(points.len(), CANDIDATES);
            for point in points {
                assert!(point.direction.dot(point.outward).abs() < 1e-9);
                // |e × d| of the scaled ray is its closest approach to the centre.
                let scale = figure.scaled_from_itrf();
                let across = (eye * scale).cross((point.direction * scale).normalize());
                assert!((across.length() - 1.0).abs() < 1e-9, "{height_m}");
            }
        }
        assert!(limb(DVec3::X, &Ellipsoid::WGS84).is_empty());
    }
}
