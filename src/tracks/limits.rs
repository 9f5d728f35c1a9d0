//! Valid ranges of the parameters of tracks.

use std::f64::consts::FRAC_PI_2;
use terrella_frames::Geodetic;

/// Whether a position is valid: finite, its latitude from −π/2 to π/2.
pub(super) fn is_place(place: &Geodetic) -> bool {
    place.lat_rad.abs() <= FRAC_PI_2 && place.lon_rad.is_finite() && place.height_m.is_finite()
}

/// Whether a line width is valid: above 0 to 64 pixels.
pub(super) fn is_width(width_px: f32) -> bool {
    width_px > 0.0 && width_px <= 64.0
}
