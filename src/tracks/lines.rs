//! Earth-fixed polylines: a graticule, coast lines, borders, and those of a host.

use super::TracksError;
use super::limits::is_width;
use super::projection::EyeProjection;
use crate::gpu::{LinePoint, TRACK_FROM_PREVIOUS, TRACK_ON_GROUND, TRACK_UNCASED};
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use terrella_frames::{Ellipsoid, Geodetic};

/// Largest number of points of all polylines of one [`Tracks`](super::Tracks), after the subdivision of long segments.
pub const MAX_LINE_POINTS: usize = 1_000_000;

/// Longest segment on the ground, radians of arc: its chord is at most 60 m below the ellipsoid.
const STEP_RAD: f64 = 0.5 * PI / 180.0;
/// Largest number of segments, and largest angular extent, radians, of the parts that are culled and simplified as a whole.
const PART_SEGMENTS: usize = 128;
const PART_RAD: f64 = 10.0 * PI / 180.0;
/// Largest deviation of a simplified line from the original, metres, by level of detail.
const LEVEL_ERRORS_M: [f64; 11] = [
    0.0, 125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0, 16_000.0, 32_000.0, 64_000.0,
];
/// Longest segment of a simplified line on the ground, metres, or this many times the line's deviation: 2.5° of arc or 63 pixels, along which the
/// light of the air is nearly linear.
const LONGEST_M: f64 = 280_000.0;
const LONGEST_DEVIATIONS: f64 = 70.0;
/// Largest deviation on screen, pixels.
const MAX_ERROR_PX: f64 = 0.9;
/// A line that fits into a circle of this diameter, pixels, is left out: a small island seen from afar.
const LEAST_PX: f64 = 1.5;

/// How lines are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineStyle {
    /// Display values (sRGB).
    pub color: [u8; 3],
    /// Above 0 to 1.
    pub opacity: f64,
    /// Width on screen, pixels: above 0 to 64.
    pub width_px: f32,
    /// Whether a dark outline separates the lines from bright ground.
    pub is_cased: bool,
}

impl LineStyle {
    /// Thin lines of this colour and opacity: a pixel wide, without outline.
    pub const fn thin(color: [u8; 3], opacity: f64) -> Self {
        Self {
            color,
            opacity,
            width_px: 1.0,
            is_cased: false,
        }
    }

    pub(super) fn check(&self) -> Result<(), TracksError> {
        if !(self.opacity > 0.0 && self.opacity <= 1.0) {
            let what = "the opacity must be above 0 and at most 1";
            return Err(TracksError::Lines { what });
        }
        if !is_width(self.width_px) {
            let what = "the width must be above 0 and at most 64 pixels";
            return Err(TracksError::Lines { what });
        }
        Ok(())
    }
}

/// Polylines of one style, Earth-fixed, for [`Tracks::set_lines`](super::Tracks::set_lines). Clones share their points.
///
/// Long lines are divided into parts. In each frame the parts in sight are drawn at the coarsest level of detail that is within 0.9 pixels of the
/// original line.
///
/// ```
/// use terrella::frames::{Ellipsoid, Geodetic};
/// use terrella::tracks::{LineStyle, Polylines};
///
/// let style = LineStyle::thin([255, 196, 46], 0.8);
/// let vienna_tokyo = [(48.2, 16.4), (35.7, 139.7)].map(|(lat, lon)| Geodetic::from_degrees(lat, lon, 0.0));
/// let lines = Polylines::on_ground(style, &Ellipsoid::WGS84, [vienna_tokyo])?;
/// // tracks.set_lines(vec![lines])?;
/// # Ok::<(), terrella::tracks::TracksError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Polylines {
    style: LineStyle,
    lies_on_ground: bool,
    points_itrf_m: Arc<[DVec3]>,
    parts: Arc<[Part]>,
}

/// A part of a line.
#[derive(Clone, Debug)]
struct Part {
    center_itrf_m: DVec3,
    radius_m: f64,
    /// Whether it is a complete line, which may be left out if it is small.
    is_whole: bool,
    /// Range of its points, first and end, by level of detail.
    levels: [(u32, u32); LEVEL_ERRORS_M.len()],
}

impl Polylines {
    /// Lines on the ellipsoid through positions whose heights are ignored. A segment is straight in latitude and longitude, as in GeoJSON (RFC
    /// 7946, 3.1.1), and takes the shorter way around the Earth; it is subdivided so that it follows the ellipsoid.
    ///
    /// # Errors
    /// A style out of range, a position that is not finite, or more than [`MAX_LINE_POINTS`].
    pub fn on_ground<L>(
        style: LineStyle,
        ellipsoid: &Ellipsoid,
        lines: impl IntoIterator<Item = L>,
    ) -> Result<Self, TracksError>
    where
        L: IntoIterator<Item = Geodetic>,
    {
        let mut builder = Builder::new(style, LONGEST_M)?;
        for line in lines {
            let mut before: Option<Geodetic> = None;
            for place in line {
                if !(place.lat_rad.is_finite() && place.lon_rad.is_finite()) {
                    let what = "a latitude or longitude is not finite";
                    return Err(TracksError::Lines { what });
                }
                let steps = before.map_or(1, |before| steps_between(before, place));
                for k in 1..=steps {
                    let at = match before {
                        Some(before) if k < steps => {
                            between(before, place, f64::from(k) / f64::from(steps))
                        }
                        _ => place,
                    };
                    builder
                        .add(ellipsoid.surface_point(Ellipsoid::normal(at.lat_rad, at.lon_rad)))?;
                }
                before = Some(place);
            }
            builder.end_line();
        }
        Ok(builder.finish(true))
    }

    /// Lines in space through Earth-fixed positions, ITRF metres, with straight segments. Parts behind the globe are hidden.
    ///
    /// # Errors
    /// As [`Self::on_ground`].
    pub fn in_space<L>(
        style: LineStyle,
        lines: impl IntoIterator<Item = L>,
    ) -> Result<Self, TracksError>
    where
        L: IntoIterator<Item = DVec3>,
    {
        let mut builder = Builder::new(style, f64::INFINITY)?;
        for line in lines {
            for place in line {
                builder.add(place)?;
            }
            builder.end_line();
        }
        Ok(builder.finish(false))
    }

    /// Meridians and parallels at multiples of `step_deg`, 1 to 90 degrees. Meridians end at the last parallel, except those of 0°, 90°, 180° and
    /// 270°, which reach the poles, so that lines do not crowd there.
    ///
    /// # Errors
    /// A step out of range, or those of [`Self::on_ground`].
    pub fn graticule(
        style: LineStyle,
        ellipsoid: &Ellipsoid,
        step_deg: f64,
    ) -> Result<Self, TracksError> {
        if !(1.0..=90.0).contains(&step_deg) {
            let what = "the step of a graticule must be from 1 to 90 degrees";
            return Err(TracksError::Lines { what });
        }
        // Multiples of the step up to `limit`, on both sides of 0.
        let multiples = |limit: f64| {
            let count = (limit / step_deg + 1e-9).floor() as i32;
            (-count..=count).map(move |k| f64::from(k) * step_deg)
        };
        let place = |lat: f64, lon: f64| Geodetic::from_degrees(lat, lon, 0.0);
        let last_parallel = multiples(90.0 - 0.5 * step_deg.min(1.0)).next_back();
        let meridians = multiples(180.0).filter(|lon| *lon > -180.0).map(|lon| {
            let end = match lon.rem_euclid(90.0) < 1e-9 {
                true => 90.0,
                false => last_parallel.filter(|lat| *lat > 0.0).unwrap_or(90.0),
            };
            vec![place(-end, lon), place(end, lon)]
        });
        let parallels = multiples(90.0).filter(|lat| lat.abs() < 90.0 - 1e-9);
        let quarters = [-180.0, -90.0, 0.0, 90.0, 180.0];
        let parallels = parallels.map(|lat| quarters.map(|lon| place(lat, lon)).to_vec());
        Self::on_ground(style, ellipsoid, meridians.chain(parallels))
    }

    /// Their style.
    pub fn style(&self) -> LineStyle {
        self.style
    }

    /// Whether they lie on the ground: then their segments are short at all levels of detail.
    pub(super) fn lies_on_ground(&self) -> bool {
        self.lies_on_ground
    }

    /// Number of points at the finest level of detail.
    pub fn point_count(&self) -> usize {
        let counts = self
            .parts
            .iter()
            .map(|part| part.levels[0].1 - part.levels[0].0);
        counts.map(|count| count as usize).sum()
    }

    /// Adds the points of a frame, with these colours.
    pub(super) fn write(
        &self,
        colors: [[u16; 4]; 2],
        eye: &EyeProjection<'_>,
        points: &mut Vec<LinePoint>,
    ) {
        let mut flags = match self.lies_on_ground {
            true => TRACK_ON_GROUND,
            false => 0,
        };
        if !self.style.is_cased {
            flags |= TRACK_UNCASED;
        }
        let half_width_px = 0.5 * self.style.width_px;
        let px_per_rad = eye.pixels_per_radian();
        for part in self.parts.iter() {
            if self.lies_on_ground && eye.faces_away(part.center_itrf_m, part.radius_m) {
                continue;
            }
            let distance_m = part.center_itrf_m.distance(eye.itrf_m) - part.radius_m;
            let px_per_m = px_per_rad / distance_m.max(1.0);
            if part.is_whole && 2.0 * part.radius_m * px_per_m < LEAST_PX {
                continue;
            }
            if eye.bounds(part.center_itrf_m, part.radius_m).is_none() {
                continue;
            }
            let fits = |error_m: &f64| error_m * px_per_m <= MAX_ERROR_PX;
            let level = LEVEL_ERRORS_M.iter().rposition(fits).unwrap_or(0);
            let (first, end) = part.levels[level];
            let mut flags = flags;
            for point in &self.points_itrf_m[first as usize..end as usize] {
                points.push(LinePoint {
                    from_eye_m: (*point - eye.itrf_m).as_vec3().to_array(),
                    flags,
                    colors,
                    half_width_px,
                });
                flags |= TRACK_FROM_PREVIOUS;
            }
        }
    }
}

/// Number of pieces that a segment on the ground is drawn in. The chord of a piece of a parallel deviates from it by R cos φ Δλ²/8.
fn steps_between(a: Geodetic, b: Geodetic) -> u32 {
    let cos = a.lat_rad.cos().max(b.lat_rad.cos()).max(0.0);
    let along_parallel = shorter_way(b.lon_rad - a.lon_rad).abs() * cos.sqrt();
    let along_meridian = (b.lat_rad - a.lat_rad).abs();
    (along_parallel.max(along_meridian) / STEP_RAD)
        .ceil()
        .max(1.0) as u32
}

/// A point on a segment that is straight in latitude and longitude.
fn between(a: Geodetic, b: Geodetic, part: f64) -> Geodetic {
    Geodetic {
        lat_rad: a.lat_rad + part * (b.lat_rad - a.lat_rad),
        lon_rad: a.lon_rad + part * shorter_way(b.lon_rad - a.lon_rad),
        height_m: 0.0,
    }
}

/// A difference of longitudes, −π…π.
fn shorter_way(difference_rad: f64) -> f64 {
    difference_rad - TAU * (difference_rad / TAU).round()
}

/// Collects lines and their levels of detail.
struct Builder {
    style: LineStyle,
    /// Longest segment of simplified lines, metres.
    longest_m: f64,
    /// Points of all levels of detail, part after part.
    points: Vec<DVec3>,
    parts: Vec<Part>,
    line: Vec<DVec3>,
    /// Number of points at the finest level.
    count: usize,
}

impl Builder {
    fn new(style: LineStyle, longest_m: f64) -> Result<Self, TracksError> {
        style.check()?;
        Ok(Self {
            style,
            longest_m,
            points: Vec::new(),
            parts: Vec::new(),
            line: Vec::new(),
            count: 0,
        })
    }

    fn add(&mut self, place_itrf_m: DVec3) -> Result<(), TracksError> {
        if !place_itrf_m.is_finite() {
            let what = "a position is not finite";
            return Err(TracksError::Lines { what });
        }
        self.count += 1;
        if self.count > MAX_LINE_POINTS {
            let what = "they have more than 1 000 000 points; leave some out";
            return Err(TracksError::Lines { what });
        }
        self.line.push(place_itrf_m);
        Ok(())
    }

    /// Divides the line into parts, which share their end points.
    fn end_line(&mut self) {
        let line = std::mem::take(&mut self.line);
        let mut first = 0;
        while first + 1 < line.len() {
            let reach = PART_RAD * line[first].length();
            let mut last = first + 1;
            let mut length_m = line[first].distance(line[last]);
            while last + 1 < line.len() && last - first < PART_SEGMENTS {
                length_m += line[last].distance(line[last + 1]);
                if length_m > reach {
                    break;
                }
                last += 1;
            }
            let is_whole = first == 0 && last + 1 == line.len();
            self.add_part(&line[first..=last], is_whole);
            first = last;
        }
        self.line = line;
        self.line.clear();
    }

    fn add_part(&mut self, line: &[DVec3], is_whole: bool) {
        let least = line.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let greatest = line.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let center_itrf_m = 0.5 * (least + greatest);
        let reach = line
            .iter()
            .map(|point| point.distance_squared(center_itrf_m));
        let radius_m = reach.fold(0.0, f64::max).sqrt();
        let mut levels = [(0, 0); LEVEL_ERRORS_M.len()];
        let mut before = usize::MAX;
        for (k, error_m) in LEVEL_ERRORS_M.into_iter().enumerate() {
            let longest_m = self.longest_m.max(LONGEST_DEVIATIONS * error_m);
            let kept = kept_points(line, error_m, longest_m);
            let count = kept.iter().filter(|is_kept| **is_kept).count();
            // A level that saves nothing reuses the one before.
            if count == before {
                levels[k] = levels[k - 1];
                continue;
            }
            before = count;
            let first = self.points.len();
            let kept = line.iter().zip(kept).filter(|(_, is_kept)| *is_kept);
            self.points.extend(kept.map(|(point, _)| *point));
            levels[k] = (first as u32, self.points.len() as u32);
        }
        self.parts.push(Part {
            center_itrf_m,
            radius_m,
            is_whole,
            levels,
        });
    }

    fn finish(self, lies_on_ground: bool) -> Polylines {
        Polylines {
            style: self.style,
            lies_on_ground,
            points_itrf_m: self.points.into(),
            parts: self.parts.into(),
        }
    }
}

/// The points that remain when a line is simplified to within `error_m` in space (Douglas and Peucker 1973), with no segment longer than
/// `longest_m` where the line has shorter ones; both ends remain.
fn kept_points(line: &[DVec3], error_m: f64, longest_m: f64) -> Vec<bool> {
    let last = line.len() - 1;
    let mut kept = vec![error_m == 0.0; line.len()];
    (kept[0], kept[last]) = (true, true);
    let mut spans = vec![(0, last)];
    while let Some((first, end)) = spans.pop().filter(|_| error_m > 0.0) {
        let farthest = (first + 1..end)
            .map(|k| (k, distance_to_segment(line[k], line[first], line[end])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((k, distance_m)) = farthest
            && (distance_m > error_m || line[first].distance(line[end]) > longest_m)
        {
            kept[k] = true;
            spans.extend([(first, k), (k, end)]);
        }
    }
    kept
}

fn distance_to_segment(point: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let square = along.length_squared();
    let part = match square > 0.0 {
        true => ((point - a).dot(along) / square).clamp(0.0, 1.0),
        // A closed line.
        false => 0.0,
    };
    point.distance(a + part * along)
}

#[cfg(test)]
#[path = "lines_tests.rs"]
mod tests;
