//! The cases and what each must show.

use super::{places, settings};
use crate::frames::{Ellipsoid, Geodetic};
use crate::{EyeView, Sky};
use glam::DVec3;

/// What must be lit. A pixel that is not finite fails in every case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lit {
    /// Every pixel is black.
    Nothing,
    /// From so many pixels to so many.
    Pixels(usize, usize),
    /// From this part of all pixels to that.
    Share(f64, f64),
    /// No picture: an error that says this.
    Refused(&'static str),
}

/// One side of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// So many pixels.
    Pixels(u32),
    /// As many as the device's textures have at most.
    Most,
}

/// One picture.
#[derive(Clone, Debug)]
pub struct ExtremeCase {
    /// What is extreme about it.
    pub name: &'static str,
    /// What must be seen, in words.
    pub expected: &'static str,
    /// The same as a number.
    pub lit: Lit,
    /// The eye. Its projection is for a square picture, whatever the picture's sides.
    pub view: EyeView,
    /// The Sun.
    pub sky: Sky,
    /// Width and height.
    pub sides: [Side; 2],
    /// Whether the air is drawn.
    pub has_air: bool,
    /// [`crate::EarthOptions::exposure`].
    pub exposure: f32,
    /// [`crate::EarthOptions::subdivision`].
    pub subdivision: u32,
}

impl ExtremeCase {
    /// Width and height on a device with textures of at most `most` pixels a side.
    pub fn size(&self, most: u32) -> (u32, u32) {
        let [width, height] = self.sides.map(|side| match side {
            Side::Pixels(n) => n,
            Side::Most => most,
        });
        (width, height)
    }

    pub(super) fn new(name: &'static str, expected: &'static str, lit: Lit, view: EyeView) -> Self {
        let overhead = view.eye_world.try_normalize().unwrap_or(DVec3::X);
        Self {
            name,
            expected,
            lit,
            view,
            sky: Sky { sun_itrf: overhead },
            sides: [Side::Pixels(64); 2],
            has_air: true,
            exposure: 1.4,
            subdivision: 24,
        }
    }

    pub(super) fn sun(self, sun_itrf: DVec3) -> Self {
        Self {
            sky: Sky { sun_itrf },
            ..self
        }
    }

    pub(super) fn sides(self, width: Side, height: Side) -> Self {
        Self {
            sides: [width, height],
            ..self
        }
    }

    pub(super) fn airless(self) -> Self {
        Self {
            has_air: false,
            ..self
        }
    }
}

/// Every pixel.
pub(super) const ALL: Lit = Lit::Share(1.0, 1.0);
/// No particular direction, of length 1.
pub(super) const TOWARDS: DVec3 = DVec3::new(0.36, -0.48, 0.8);

/// An eye at `height_m` over 37° N, 52° W that looks along `forward`.
pub(super) fn over(height_m: f64, forward: impl Fn(DVec3) -> DVec3, fov_deg: f64) -> EyeView {
    let place = Geodetic::from_degrees(37.0, -52.0, height_m);
    let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let eye = Ellipsoid::WGS84.itrf_from_geodetic(place);
    EyeView::itrf(eye, forward(up), DVec3::Z, fov_deg.to_radians(), 1.0)
}

/// An eye that looks at the Earth's centre.
pub(super) fn centred(eye: DVec3, fov_deg: f64) -> EyeView {
    EyeView::itrf(eye, -eye, DVec3::Z, fov_deg.to_radians(), 1.0)
}

/// Straight down.
pub(super) fn down(up: DVec3) -> DVec3 {
    -up
}

/// West along the ground.
pub(super) fn level(up: DVec3) -> DVec3 {
    up.cross(DVec3::Z).normalize_or_zero()
}

/// Every case.
pub fn cases() -> Vec<ExtremeCase> {
    let mut all = places::cases();
    all.extend(settings::cases());
    all
}
