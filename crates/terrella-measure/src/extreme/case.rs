//! An extreme view, and its expected result.

use glam::DVec3;
use terrella::{Exposure, EyeView, Sky, Subdivision};

/// Expected lit pixels. A pixel that is not finite fails in every case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lit {
    /// Every pixel is black.
    Nothing,
    Pixels(usize, usize),
    /// Fraction of lit pixels, from and to.
    Share(f64, f64),
    /// No image: an error that contains this text.
    Rejected(&'static str),
}

/// One side of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Pixels(u32),
    /// As many as the device's textures have at most.
    Max,
}

/// One picture.
#[derive(Clone, Debug)]
pub struct ExtremeCase {
    /// Its name.
    pub name: &'static str,
    /// The expected result, as text for the report.
    pub expected: &'static str,
    /// The expected result, as a number of pixels.
    pub lit: Lit,
    /// The eye. Its projection is for a square picture, whatever the picture's sides.
    pub view: EyeView,
    /// The Sun.
    pub sky: Sky,
    /// Width and height.
    pub sides: [Side; 2],
    /// Whether the air is drawn.
    pub has_air: bool,
    /// [`terrella::EarthOptions::exposure`]. Where it is not the default, the picture is drawn as it is shown, on 8 bits a
    /// channel; else as light.
    pub exposure: Exposure,
    /// [`terrella::EarthOptions::subdivision`].
    pub subdivision: Subdivision,
}

impl ExtremeCase {
    /// Width and height on a device with textures of at most `max` pixels a side.
    pub fn size(&self, max: u32) -> (u32, u32) {
        let [width, height] = self.sides.map(|side| match side {
            Side::Pixels(n) => n,
            Side::Max => max,
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
            sky: Sky::new(overhead),
            sides: [Side::Pixels(64); 2],
            has_air: true,
            exposure: Exposure::default(),
            subdivision: Subdivision::Cells(24),
        }
    }

    pub(super) fn sun(self, sun_itrf: DVec3) -> Self {
        Self {
            sky: Sky::new(sun_itrf),
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
