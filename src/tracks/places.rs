//! Marked places on the ground: a ring, and the position of its name.

use super::TracksError;
use super::buffers::{PlaceLabel, RING_PX, TrackBuffers};
use super::ink::Ink;
use super::limits::{is_place, is_width};
use super::projection::EyeProjection;
use crate::gpu::{Mark, PassFormat, TRACK_ON_GROUND};
use glam::DVec3;
use terrella_frames::{Ellipsoid, Geodetic};

/// Largest number of marked places.
pub const MAX_PLACES: usize = 20_000;

/// A place on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundMark {
    /// Position; a place below the ellipsoid is marked on it.
    pub place: Geodetic,
    /// Display values (sRGB).
    pub color: [u8; 3],
    /// Above 0 to 1.
    pub opacity: f64,
    /// Width of the ring's line, pixels: above 0 to 64. The ring has the size of a station's with lines of that width.
    pub width_px: f32,
    /// Whether a ring is drawn.
    pub is_marked: bool,
    /// Whether it has a name, whose position is in [`Tracks::place_labels`](super::Tracks::place_labels).
    pub is_named: bool,
}

impl GroundMark {
    pub(super) fn check(&self) -> Result<(), TracksError> {
        let what = if !is_place(&self.place) {
            "a marked place must be finite, its latitude from −π/2 to π/2"
        } else if !(self.opacity > 0.0 && self.opacity <= 1.0) {
            "the opacity of a mark must be above 0 and at most 1"
        } else if !is_width(self.width_px) {
            "the width of a mark's line must be above 0 and at most 64 pixels"
        } else {
            return Ok(());
        };
        Err(TracksError::Lines { what })
    }
}

/// A marked place, ITRF metres, and its colour as the target stores it.
#[derive(Clone)]
pub(super) struct InkedPlace {
    pub mark: GroundMark,
    itrf_m: DVec3,
    colors: [[u16; 4]; 2],
}

impl InkedPlace {
    pub fn new(mark: GroundMark, ellipsoid: &Ellipsoid, format: &PassFormat) -> Self {
        let height_m = mark.place.height_m.max(0.0);
        let place = Geodetic {
            height_m,
            ..mark.place
        };
        Self {
            mark,
            itrf_m: ellipsoid.itrf_from_geodetic(place),
            colors: Ink::new(format, mark.color, true).at(mark.opacity),
        }
    }

    /// Adds its elements of a frame.
    pub fn write(
        &self,
        index: usize,
        pixels_per_radian: f64,
        eye: &EyeProjection<'_>,
        buffers: &mut TrackBuffers,
    ) {
        if eye.is_hidden(self.itrf_m) {
            return;
        }
        let mark = &self.mark;
        if mark.is_marked {
            buffers.marks.push(Mark {
                from_eye_m: (self.itrf_m - eye.itrf_m).as_vec3().to_array(),
                flags: TRACK_ON_GROUND,
                colors: self.colors,
                radius_px: 0.5 * RING_PX * mark.width_px,
            });
        }
        if mark.is_named
            && let Some(at_px) = eye.pixel(self.itrf_m)
        {
            buffers.place_labels.push(PlaceLabel {
                place: index,
                at_px,
                color: mark.color,
                pixels_per_m: (pixels_per_radian / self.itrf_m.distance(eye.itrf_m).max(1.0))
                    as f32,
            });
        }
    }
}
