//! A lens in front of a sensor: pixels to rays and back.
//!
//! Pixels are counted as OpenCV counts them: the centre of the upper left pixel is (0, 0).

use crate::distortion::Distortion;
use crate::error::{SensorError, check_range};
use crate::limits;
use glam::DVec2;
use std::ops::Range;

/// Farthest ray from the axis, degrees. A picture is drawn on one plane, whose pixels there are 33 times as many as at the axis.
const MOST_FIELD_DEG: f64 = 80.0;
/// Pixels between the points at which the inverse is looked for before a picture is made; each pixel is checked again when it is.
const CHECK_STEP_PX: f64 = 16.0;

/// Focal length, principal point and distortion of a checked lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    size: [u32; 2],
    focal_length_mm: f64,
    pixel_pitch_um: f64,
    focal_px: f64,
    principal_point_px: DVec2,
    distortion: Distortion,
    /// Undistorted distance from the axis up to which the radial curve increases, as far as the image needs it.
    reach: f64,
}

/// A rectangle of the plane at unit focal length: x right, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneRect {
    /// Upper left corner.
    pub least: DVec2,
    /// Lower right corner.
    pub most: DVec2,
}

impl Lens {
    /// Checks a lens over its whole image. The default principal point is the middle of the image.
    ///
    /// # Errors
    /// Numbers out of range; coefficients that fold the image over itself; a field of view that is too wide.
    pub fn new(
        size: [u32; 2],
        focal_length_mm: f64,
        pixel_pitch_um: f64,
        principal_point_px: Option<[f64; 2]>,
        distortion: Distortion,
    ) -> Result<Self, SensorError> {
        check_range(
            "focal_length_mm",
            focal_length_mm,
            limits::FOCAL_LENGTH_MM,
            " mm",
        )?;
        check_range(
            "pixel_pitch_um",
            pixel_pitch_um,
            limits::PIXEL_PITCH_UM,
            " µm",
        )?;
        for side in size {
            check_range("size", f64::from(side), limits::SIDE_PX, " pixels")?;
        }
        let [width, height] = size.map(f64::from);
        check_range("size", width * height, limits::PIXELS, " pixels in all")?;
        let middle = [0.5 * (width - 1.0), 0.5 * (height - 1.0)];
        let principal = principal_point_px.unwrap_or(middle);
        for (at, side) in principal.into_iter().zip([width, height]) {
            check_range("principal_point_px", at, -side..=2.0 * side, " pixels")?;
        }
        let mut lens = Self {
            size,
            focal_length_mm,
            pixel_pitch_um,
            focal_px: 1000.0 * focal_length_mm / pixel_pitch_um,
            principal_point_px: principal.into(),
            distortion,
            reach: 0.0,
        };
        lens.reach = lens.find_reach();
        if let Some(at) = lens.first_fold() {
            return Err(lens.too_wide().unwrap_or(SensorError::Folds {
                x: at.x,
                y: at.y,
                scale: lens.greatest_scale(),
            }));
        }
        Ok(lens)
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Focal length, millimetres.
    pub fn focal_length_mm(&self) -> f64 {
        self.focal_length_mm
    }

    /// Distance of pixel centres, micrometres.
    pub fn pixel_pitch_um(&self) -> f64 {
        self.pixel_pitch_um
    }

    /// Focal length, pixels.
    pub fn focal_px(&self) -> f64 {
        self.focal_px
    }

    /// Where the optical axis meets the sensor, pixels.
    pub fn principal_point_px(&self) -> DVec2 {
        self.principal_point_px
    }

    /// The distortion.
    pub fn distortion(&self) -> &Distortion {
        &self.distortion
    }

    /// The pixel that shows a direction (X/Z, Y/Z).
    pub fn project(&self, direction: DVec2) -> DVec2 {
        self.principal_point_px + self.focal_px * self.distortion.distort(direction)
    }

    /// The direction (X/Z, Y/Z) that a point of the sensor shows, given in pixels.
    ///
    /// # Errors
    /// A point without a unique inverse. Inside the image of a checked lens there is none.
    pub fn direction(&self, pixel: DVec2) -> Result<DVec2, SensorError> {
        let found = self.find_direction(pixel);
        found.ok_or_else(|| SensorError::Folds {
            x: pixel.x,
            y: pixel.y,
            scale: self.greatest_scale(),
        })
    }

    fn find_direction(&self, pixel: DVec2) -> Option<DVec2> {
        let distorted = (pixel - self.principal_point_px) / self.focal_px;
        let direction = self.distortion.undistort(distorted, self.reach)?;
        (direction.length() <= MOST_FIELD_DEG.to_radians().tan()).then_some(direction)
    }

    /// Half a pixel beyond the outermost centres.
    fn edges(&self) -> (DVec2, DVec2) {
        let [width, height] = self.size.map(f64::from);
        (DVec2::splat(-0.5), DVec2::new(width - 0.5, height - 0.5))
    }

    /// The nearest point of the sensor's area.
    pub fn clamped(&self, pixel: DVec2) -> DVec2 {
        let (least, most) = self.edges();
        pixel.clamp(least, most)
    }

    fn find_reach(&self) -> f64 {
        let (least, most) = self.edges();
        let corners = [
            least,
            most,
            DVec2::new(least.x, most.y),
            DVec2::new(most.x, least.y),
        ];
        let farthest = corners
            .map(|corner| (corner - self.principal_point_px).length())
            .into_iter()
            .fold(0.0, f64::max);
        // Tangential terms move points along the radial curve: a fifth more than the corners.
        let distorted = 1.2 * farthest / self.focal_px;
        let (reach, _) = self
            .distortion
            .rising(distorted, MOST_FIELD_DEG.to_radians().tan());
        reach
    }

    /// A point of the picture that has no inverse, the nearest to the axis of those looked at.
    fn first_fold(&self) -> Option<DVec2> {
        let mut first: Option<(f64, DVec2)> = None;
        for pixel in self.checked_points() {
            let distance = pixel.distance_squared(self.principal_point_px);
            if first.is_some_and(|(nearest, _)| nearest <= distance) {
                continue;
            }
            if self.find_direction(pixel).is_none() {
                first = Some((distance, pixel));
            }
        }
        first.map(|(_, pixel)| pixel)
    }

    fn checked_points(&self) -> impl Iterator<Item = DVec2> {
        let (least, most) = self.edges();
        let steps = ((most - least) / CHECK_STEP_PX)
            .ceil()
            .clamp(DVec2::ONE, DVec2::splat(64.0));
        let (across, down) = (steps.x as u32, steps.y as u32);
        (0..=down).flat_map(move |j| {
            (0..=across).map(move |i| {
                let part = DVec2::new(f64::from(i), f64::from(j)) / steps;
                least + part * (most - least)
            })
        })
    }

    /// Whether it is the field that is too wide, and not the coefficients.
    fn too_wide(&self) -> Option<SensorError> {
        let most = MOST_FIELD_DEG.to_radians().tan();
        if self.reach < most * (1.0 - 1e-3) {
            return None;
        }
        let (least, far) = self.edges();
        let corner = (least - self.principal_point_px)
            .abs()
            .max((far - self.principal_point_px).abs())
            .length();
        let (_, reached) = self.distortion.rising(corner / self.focal_px, most);
        let half_field = match self.distortion {
            Distortion::BrownConrady(_) => (corner / self.focal_px).atan(),
            Distortion::Fisheye(_) => corner / self.focal_px,
        };
        Some(SensorError::FieldTooWide {
            half_field_deg: half_field.to_degrees(),
            most_deg: MOST_FIELD_DEG,
            focal_mm: 1.01 * self.focal_length_mm * corner / self.focal_px / reached,
        })
    }

    /// The largest scale of all coefficients without folding.
    fn greatest_scale(&self) -> f64 {
        let works = |scale: f64| {
            let mut lens = self.clone();
            lens.distortion = self.distortion.scaled(scale);
            lens.reach = lens.find_reach();
            lens.first_fold().is_none()
        };
        let (mut good, mut bad) = (0.0, 1.0);
        while bad - good > 5e-4 {
            let middle = 0.5 * (good + bad);
            match works(middle) {
                true => good = middle,
                false => bad = middle,
            }
        }
        // Rounded down, as it is printed.
        (good * 1000.0_f64).floor() / 1000.0
    }

    /// How many times larger than on the axis the lens shows a part of the picture at most, 1 or more.
    pub fn magnification(&self) -> f64 {
        let found = self.checked_points().filter_map(|pixel| {
            let jacobian = self.distortion.jacobian(self.find_direction(pixel)?);
            // The larger singular value of a matrix whose halves of trace and difference are these.
            let half = |a: f64, b: f64| 0.5 * a.hypot(b);
            let (a, b) = (jacobian.x_axis, jacobian.y_axis);
            Some(half(a.x + b.y, b.x - a.y) + half(a.x - b.y, b.x + a.y))
        });
        found.fold(1.0, f64::max)
    }

    /// The part of the plane that some rows show, extended by `margin_px` rows and columns as far as the image reaches.
    ///
    /// # Errors
    /// As [`Self::direction`].
    pub fn bounds(&self, rows: Range<u32>, margin_px: f64) -> Result<PlaneRect, SensorError> {
        let (least, most) = self.edges();
        let top = (f64::from(rows.start) - 0.5 - margin_px).max(least.y);
        let bottom = (f64::from(rows.end) - 0.5 + margin_px).min(most.y);
        let mut rect = PlaneRect {
            least: DVec2::INFINITY,
            most: DVec2::NEG_INFINITY,
        };
        // Straight lines bulge: all rows and columns of a coarse grid, not the outline's corners alone.
        let lines = |from: f64, to: f64, step: f64| {
            let count = ((to - from) / step).ceil().max(1.0) as u32;
            (0..=count).map(move |k| from + (to - from) * f64::from(k) / f64::from(count))
        };
        for y in lines(top, bottom, 4.0 * CHECK_STEP_PX) {
            for x in lines(least.x, most.x, 4.0) {
                let direction = self.direction(DVec2::new(x, y))?;
                rect.least = rect.least.min(direction);
                rect.most = rect.most.max(direction);
            }
        }
        for x in [
            least.x,
            most.x,
            self.principal_point_px.x.clamp(least.x, most.x),
        ] {
            for y in lines(top, bottom, 4.0) {
                let direction = self.direction(DVec2::new(x, y))?;
                rect.least = rect.least.min(direction);
                rect.most = rect.most.max(direction);
            }
        }
        Ok(rect)
    }
}

#[cfg(test)]
#[path = "lens_tests.rs"]
mod tests;
