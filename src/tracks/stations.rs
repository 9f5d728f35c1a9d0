//! Ground stations: a mark with the position of its name, the visibility circle of a satellite, and access lines.

use super::TracksError;
use super::buffers::{LineWriter, OUTLINE_OPACITY, RING_PX, StationLabel, TrackBuffers};
use super::ink::Ink;
use super::limits::{is_place, is_width};
use super::projection::EyeProjection;
use super::satellite::subpoint;
use crate::gpu::{Mark, PassFormat, TRACK_ON_GROUND};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};
use terrella_frames::{Ellipsoid, Epoch, Geodetic, Orientation};
use terrella_orbit::{Frame, Observer, OrbitState};

/// Largest number of stations.
pub const MAX_STATIONS: usize = 1000;
/// Number of points of a visibility circle; the first is not repeated.
pub const CIRCLE_POINTS: usize = 128;
/// Opacity of an access line.
const ACCESS_OPACITY: f64 = 0.9;

/// A ground station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// Its position; the height is above the ellipsoid.
    pub place: Geodetic,
    /// Elevation mask: the least elevation angle of a satellite in view, radians, 0 to below π/2.
    pub min_elevation_rad: f64,
    /// Display values (sRGB).
    pub color: [u8; 3],
    /// Width of lines, pixels: above 0 to 64.
    pub width_px: f32,
}

impl Station {
    pub(super) fn check(&self) -> Result<(), TracksError> {
        let what = if !is_place(&self.place) {
            "a station's place must be finite, its latitude from −π/2 to π/2"
        } else if !(0.0..FRAC_PI_2).contains(&self.min_elevation_rad) {
            "a station's elevation mask must be from 0 to below π/2"
        } else if !is_width(self.width_px) {
            "the width of a station's lines must be above 0 and at most 64 pixels"
        } else {
            return Ok(());
        };
        Err(TracksError::Lines { what })
    }

    /// Whether a satellite at an Earth-fixed position, ITRF metres, is in view: as for the [`Observer`] of passes, without refraction and terrain.
    pub fn sees(&self, satellite_itrf_m: DVec3, ellipsoid: &Ellipsoid) -> bool {
        // In Earth-fixed axes neither time nor orientation is used.
        let orientation = |_: Epoch| Orientation::default();
        let observer = Observer::new(self.place, ellipsoid, self.min_elevation_rad, &orientation);
        let state = OrbitState {
            epoch: Epoch::default(),
            frame: Frame::Itrf,
            position_m: satellite_itrf_m,
            velocity_m_s: DVec3::ZERO,
        };
        observer.look_angles(&state).elevation_rad >= self.min_elevation_rad
    }

    /// The ground below the positions at `height_m` above the ellipsoid where a satellite is exactly at the elevation mask: [`CIRCLE_POINTS`]
    /// points on the ellipsoid, ITRF metres, clockwise from the north. Empty if the station is at least as high.
    pub fn visibility_circle(
        &self,
        height_m: f64,
        ellipsoid: &Ellipsoid,
        mut give: impl FnMut(DVec3),
    ) {
        // Also false for NaN.
        if !(height_m > self.place.height_m && height_m.is_finite()) {
            return;
        }
        let place = ellipsoid.itrf_from_geodetic(self.place);
        let up = Ellipsoid::normal(self.place.lat_rad, self.place.lon_rad);
        let (sin, cos) = self.place.lon_rad.sin_cos();
        let east = DVec3::new(-sin, cos, 0.0);
        let north = up.cross(east);
        let (sin_mask, cos_mask) = self.min_elevation_rad.sin_cos();
        // An approximation of the surface of that height: the ellipsoid with longer axes.
        let shell = Ellipsoid {
            equatorial_radius_m: ellipsoid.equatorial_radius_m + height_m,
            polar_radius_m: ellipsoid.polar_radius_m + height_m,
        };
        let scale = shell.scaled_from_itrf();
        let p = scale * place;
        let inside = (1.0 - p.length()) * (1.0 + p.length());
        for k in 0..CIRCLE_POINTS {
            let (sin, cos) = (TAU * k as f64 / CIRCLE_POINTS as f64).sin_cos();
            let direction = cos_mask * (cos * north + sin * east) + sin_mask * up;
            let d = scale * direction;
            // |p + s d| = 1, the positive solution in the form without cancellation.
            let (square, half_linear) = (d.length_squared(), p.dot(d));
            let root = (half_linear * half_linear + square * inside)
                .max(0.0)
                .sqrt();
            let mut along_m = match half_linear >= 0.0 {
                true => inside / (half_linear + root),
                false => (root - half_linear) / square,
            };
            // Refined to the exact height by Newton's method: the height changes by the sine of the elevation angle.
            for _ in 0..2 {
                let at = ellipsoid.geodetic_from_itrf(place + along_m * direction);
                let slope = direction.dot(Ellipsoid::normal(at.lat_rad, at.lon_rad));
                along_m -= (at.height_m - height_m) / slope.max(1e-3);
            }
            give(subpoint(place + along_m * direction, ellipsoid));
        }
    }
}

/// A station, and its colour as the target stores it.
#[derive(Clone)]
pub(super) struct InkedStation {
    pub station: Station,
    ink: Ink,
}

impl InkedStation {
    pub fn new(station: Station, format: &PassFormat) -> Self {
        let ink = Ink::new(format, station.color, true);
        Self { station, ink }
    }

    /// Adds its elements of a frame: `followed` is the satellite whose altitude sets the circle. Returns the number of satellites in view.
    pub fn write(
        &self,
        index: usize,
        satellites_itrf_m: &[DVec3],
        followed_itrf_m: Option<DVec3>,
        eye: &EyeProjection<'_>,
        buffers: &mut TrackBuffers,
    ) -> u32 {
        let station = &self.station;
        let half_width_px = 0.5 * station.width_px;
        let place = eye.ellipsoid.itrf_from_geodetic(Geodetic {
            height_m: station.place.height_m.max(0.0),
            ..station.place
        });
        buffers.marks.push(Mark {
            from_eye_m: (place - eye.itrf_m).as_vec3().to_array(),
            flags: TRACK_ON_GROUND,
            colors: self.ink.at(1.0),
            radius_px: RING_PX * half_width_px,
        });
        let at_px = eye.pixel(place).filter(|_| !eye.is_hidden(place));
        buffers
            .station_labels
            .extend(at_px.map(|at_px| StationLabel {
                station: index,
                at_px,
                color: station.color,
            }));
        if let Some(followed) = followed_itrf_m {
            let height_m = eye.ellipsoid.geodetic_from_itrf(followed).height_m;
            let outline = &mut buffers.outline;
            outline.clear();
            station.visibility_circle(height_m, eye.ellipsoid, |point| outline.push(point));
            let flags = TRACK_ON_GROUND;
            let mut line =
                LineWriter::new(&self.ink, half_width_px, flags, eye, &mut buffers.points);
            for point in outline.iter().chain(outline.first()) {
                line.add(*point, OUTLINE_OPACITY);
            }
        }
        let mut in_view = 0;
        for satellite in satellites_itrf_m {
            if station.sees(*satellite, eye.ellipsoid) {
                let mut line =
                    LineWriter::new(&self.ink, half_width_px, 0, eye, &mut buffers.points);
                line.add(place, ACCESS_OPACITY);
                line.add(*satellite, ACCESS_OPACITY);
                in_view += 1;
            }
        }
        in_view
    }
}

#[cfg(test)]
#[path = "stations_tests.rs"]
mod tests;
