//! A sensor's frame in bands of rows, each drawn at its own instant by a pinhole camera whose picture holds what the band shows.
//!
//! A rolling shutter has as many bands as keep the motion within half a band below [`MOST_MOTION_PX`]. Large sensors have more, so that each
//! picture fits the device.

use super::error::PlayError;
use super::flight::{Flight, Moment};
use glam::{DMat4, DVec2, DVec3, DVec4};
use hifitime::Unit;
use std::ops::Range;
use terrella::frames::{Ellipsoid, Epoch};
use terrella::{EyeView, GpuContext};
use terrella_sensor::{PinholeFrame, PlaneRect, Sensor, Shutter, bands};

/// Rows that are exposed at one instant.
pub struct SensorBand {
    /// The rows.
    pub rows: Range<u32>,
    /// The instant; its view is of the whole scene's camera.
    pub moment: Moment,
    /// The picture that holds what the rows show.
    pub frame: PinholeFrame,
}

impl SensorBand {
    /// The instant with the view of the band's picture.
    pub fn pinhole(&self) -> Moment {
        Moment {
            view: through(&self.moment.view, self.frame.rect),
            ..self.moment
        }
    }

    /// Width and height of the picture, pixels.
    pub fn size(&self) -> (u32, u32) {
        self.frame.size.into()
    }
}

/// All rows of a frame.
pub struct SensorBands {
    /// From the top down.
    pub bands: Vec<SensorBand>,
    /// Largest image motion between the time of a row and that of its band, pixels.
    pub motion_px: f64,
}

/// A sensor and the bands of its frame.
pub struct SensorView {
    /// The sensor.
    pub sensor: Sensor,
    /// Its bands.
    pub bands: SensorBands,
}

/// Motion that rows may have within their band, pixels.
const MOST_MOTION_PX: f64 = 0.05;
/// Pixels of a picture: 64 MiB of light.
const MOST_PIXELS: usize = 4 << 20;

impl SensorBands {
    /// The bands of a frame whose first row is exposed at a moment. `aspect` is that of the scene's image.
    ///
    /// # Errors
    /// Times at which the satellite has no state; a simulator's time with a rolling shutter; rows that are wider than the device supports.
    pub fn new(
        flight: &Flight,
        sensor: &Sensor,
        moment: &Moment,
        aspect: f64,
        gpu: &GpuContext,
    ) -> Result<Self, PlayError> {
        // Pictures in memory, which need no window, are never of live scenes.
        #[cfg(feature = "window")]
        if matches!(sensor.shutter, Shutter::Rolling { .. }) {
            flight.reject_live(
                "rows cannot be exposed one after the other",
                "write shutter = \"global\" in [sensor]",
            )?;
        }
        let at = |epoch| flight.at(epoch, aspect);
        Self::along(&at, flight.ellipsoid(), sensor, moment, gpu)
    }

    /// The bands for a camera whose moments a function returns.
    ///
    /// # Errors
    /// Errors of the function; rows that are wider than the device supports.
    pub fn along(
        moment_at: &dyn Fn(Epoch) -> Result<Moment, PlayError>,
        ellipsoid: &Ellipsoid,
        sensor: &Sensor,
        moment: &Moment,
        gpu: &GpuContext,
    ) -> Result<Self, PlayError> {
        let height = sensor.lens.size()[1];
        let at = |row: f64| {
            let after_s = sensor.shutter.row_time_s(row, height);
            match after_s == 0.0 {
                true => Ok(*moment),
                false => moment_at(moment.epoch + after_s * Unit::Second),
            }
        };
        let motion_px = match sensor.shutter {
            Shutter::Global => 0.0,
            Shutter::Rolling { .. } => {
                let ends = [at(0.0)?, at(f64::from(height) - 1.0)?];
                motion_px(sensor, &ends, ellipsoid)
            }
        };
        let needed = (0.5 * motion_px / MOST_MOTION_PX).ceil();
        let mut count = needed.clamp(1.0, f64::from(height)) as u32;
        loop {
            let frames = bands(height, count).map(|rows| {
                let frame = sensor.pinhole(rows.clone())?;
                Ok((rows, frame))
            });
            let frames = frames.collect::<Result<Vec<_>, PlayError>>()?;
            let limit = gpu.device.limits().max_texture_dimension_2d;
            let is_too_large = |frame: &PinholeFrame| {
                frame.size.iter().any(|side| *side > limit) || frame.len() > MOST_PIXELS
            };
            let too_large = frames.iter().find(|(_, frame)| is_too_large(frame));
            if let Some((_, frame)) = too_large {
                if count < height {
                    count = (2 * count).min(height);
                    continue;
                }
                if frame.size.iter().any(|side| *side > limit) {
                    return Err(too_wide(sensor, frame, limit, gpu));
                }
            }
            let drawn = frames.into_iter().map(|(rows, frame)| {
                let middle = 0.5 * f64::from(rows.start + rows.end - 1);
                Ok(SensorBand {
                    moment: at(middle)?,
                    rows,
                    frame,
                })
            });
            return Ok(Self {
                bands: drawn.collect::<Result<_, PlayError>>()?,
                motion_px: match count == height {
                    true => 0.0,
                    false => 0.5 * motion_px / f64::from(count),
                },
            });
        }
    }
}

fn too_wide(sensor: &Sensor, frame: &PinholeFrame, limit: u32, gpu: &GpuContext) -> PlayError {
    let wide = frame.size[0].max(frame.size[1]);
    let fits = u64::from(sensor.oversampling) * u64::from(limit) / u64::from(wide);
    PlayError::SensorTooWide {
        oversampling: sensor.oversampling,
        wide,
        adapter: gpu.adapter.get_info().name,
        limit,
        remedy: match fits {
            0 => "a smaller size or a longer focal length would work".to_owned(),
            fits => format!("{fits} would work"),
        },
    }
}

/// A view of the same eye and axes that shows a part of the plane one unit ahead: x right, y down.
pub fn through(view: &EyeView, rect: PlaneRect) -> EyeView {
    let (least, most) = (rect.least, rect.most);
    let scale = 2.0 / (most - least);
    let shift = (most + least) / (most - least);
    EyeView {
        clip_from_view: DMat4::from_cols(
            DVec4::new(scale.x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, scale.y, 0.0, 0.0),
            // y of the plane is down, y of the view up.
            DVec4::new(shift.x, -shift.y, 0.0, -1.0),
            DVec4::new(0.0, 0.0, EyeView::NEAR_M, 0.0),
        ),
        ..*view
    }
}

/// The camera's axes in ITRF: right, down and ahead.
pub fn axes(view: &EyeView) -> [DVec3; 3] {
    let whole = PlaneRect {
        least: DVec2::NEG_ONE,
        most: DVec2::ONE,
    };
    let rays = through(view, whole).pixel_rays((1, 1).into());
    let (right, down) = (0.5 * rays.right, 0.5 * rays.down);
    [right, down, rays.corner + right + down]
}

/// Motion on the sensor between two times, of points of the ground, or of directions where there is none, pixels.
fn motion_px(sensor: &Sensor, [first, last]: &[Moment; 2], ellipsoid: &Ellipsoid) -> f64 {
    let [width, height] = sensor.lens.size().map(f64::from);
    let (eye, _) = first.view.to_itrf();
    let (later_eye, _) = last.view.to_itrf();
    let ([right, down, ahead], later) = (axes(&first.view), axes(&last.view));
    let mut most = 0.0_f64;
    for k in 0..25 {
        let part = DVec2::new(f64::from(k % 5), f64::from(k / 5)) / 4.0;
        let pixel = part * DVec2::new(width - 1.0, height - 1.0);
        let Ok(direction) = sensor.lens.direction(pixel) else {
            continue;
        };
        let ray = direction.x * right + direction.y * down + ahead;
        let to = match range(ellipsoid, eye, ray) {
            Some(range) => eye + range * ray - later_eye,
            None => ray,
        };
        let [x, y, z] = later.map(|axis| axis.dot(to));
        // A point that moves behind the camera leaves the image.
        let moved = match z > 0.0 {
            true => pixel.distance(sensor.lens.project(DVec2::new(x, y) / z)),
            false => f64::INFINITY,
        };
        most = most.max(moved);
    }
    // Half of the widest motion of the 25 points more, for those between.
    1.5 * most.min(height * 100.0)
}

/// How many times a ray's length the ellipsoid is away.
fn range(ellipsoid: &Ellipsoid, eye: DVec3, ray: DVec3) -> Option<f64> {
    let scale = ellipsoid.scaled_from_itrf();
    let (e, d) = (eye * scale, ray * scale);
    let above = (e.length() - 1.0) * (e.length() + 1.0);
    let (half, square) = (-e.dot(d), d.length_squared());
    // |e × d|² = |d|² − (what the discriminant is), by Lagrange's identity.
    let root = square - e.cross(d).length_squared();
    let range = above / (half + root.max(0.0).sqrt());
    (root >= 0.0 && half > 0.0 && range > 0.0).then_some(range)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners of the image are those of the rectangle.
    #[test]
    fn a_view_shows_its_rectangle() {
        let eye = DVec3::new(7e6, 1e6, -2e6);
        let view = EyeView::itrf(eye, DVec3::new(-1.0, 0.2, 0.1), DVec3::Z, 1.0, 1.5);
        let [right, down, ahead] = axes(&view);
        assert!(right.cross(down).distance(ahead) < 1e-12 && (ahead.length() - 1.0).abs() < 1e-12);
        assert!(down.z < -0.9, "{down}");
        let rect = PlaneRect {
            least: DVec2::new(-0.3, -0.7),
            most: DVec2::new(0.5, -0.2),
        };
        let rays = through(&view, rect).pixel_rays((80, 50).into());
        let ray = rays.corner + 20.0 * rays.right + 10.0 * rays.down;
        let wanted = -0.1 * right - 0.6 * down + ahead;
        assert!(ray.distance(wanted) < 1e-12, "{ray} {wanted}");
    }

    #[test]
    fn the_range_to_the_ground_is_the_height_straight_down() {
        let ellipsoid = Ellipsoid::WGS84;
        let eye = DVec3::X * (ellipsoid.equatorial_radius_m + 4e5);
        let range_m = range(&ellipsoid, eye, DVec3::NEG_X).expect("the ground");
        assert!((range_m - 4e5).abs() < 1e-6, "{range_m}");
        assert_eq!(range(&ellipsoid, eye, DVec3::X), None);
        assert_eq!(range(&ellipsoid, eye, DVec3::Y), None);
    }
}
