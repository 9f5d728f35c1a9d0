//! What of a satellite stands in a frame: points of lines, marks, fills and labels, made eye-relative for the GPU.

use super::curve::TimeWindow;
use super::footprint::{WIDEST_HALF_ANGLE_RAD, footprint_outline, is_hidden};
use super::ink::Ink;
use super::projection::EyeProjection;
use super::satellite::{Axes, Satellite, subpoint};
use crate::gpu::{Fill, LinePoint, Mark, Triangle};
use crate::gpu::{TRACK_FROM_PREVIOUS, TRACK_ON_GROUND};
use glam::DVec3;
use terrella_frames::Ellipsoid;

/// Nearer than this a satellite is no dot, metres: it is then the eye's own, or a craft that is seen.
pub const NEAREST_MARKER_M: f64 = 1000.0;

/// What is lower than this is marked as a place on the ground, by a ring about a point, metres.
const GROUND_MARKER_M: f64 = 10_000.0;

/// Radii of a marker and of the ring on the ground, pixels, for lines 2 pixels wide.
const MARKER_PX: f32 = 4.0;
pub(super) const RING_PX: f32 = 6.0;
/// Opacity of a trail's oldest point, of the first after now, and of the last.
const OLDEST: f64 = 0.12;
const AHEAD: f64 = 0.6;
const LATEST: f64 = 0.15;
/// Opacity of a footprint's outline and of its fill.
pub(super) const OUTLINE_OPACITY: f64 = 0.863;
const FILL_OPACITY: f64 = 0.173;

/// Where a satellite's name belongs: beside its dot, which is in the picture and not hidden.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackLabel {
    /// The satellite's place among the styles.
    pub satellite: usize,
    /// The dot's middle, pixels from the viewport's upper left corner.
    pub at_px: [f32; 2],
    /// Its colour, display values.
    pub color: [u8; 3],
}

/// Where a station's name belongs: beside its mark, which is in the picture and not hidden.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StationLabel {
    /// The station's place in the list that was set.
    pub station: usize,
    /// The mark's middle, pixels from the viewport's upper left corner.
    pub at_px: [f32; 2],
    /// Its colour, display values.
    pub color: [u8; 3],
}

/// Where the name of a marked place belongs, which is in the picture and not hidden.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceLabel {
    /// The place's index in the list that was set.
    pub place: usize,
    /// Its middle, pixels from the viewport's upper left corner.
    pub at_px: [f32; 2],
    /// Its colour, display values.
    pub color: [u8; 3],
    /// How many pixels a metre across the line of sight is long at its distance.
    pub pixels_per_m: f32,
}

/// What is written to the GPU, kept from frame to frame for its room.
#[derive(Default)]
pub(super) struct TrackBuffers {
    pub points: Vec<LinePoint>,
    pub marks: Vec<Mark>,
    pub fills: Vec<Fill>,
    pub triangles: Vec<Triangle>,
    pub labels: Vec<TrackLabel>,
    pub station_labels: Vec<StationLabel>,
    pub place_labels: Vec<PlaceLabel>,
    pub outline: Vec<DVec3>,
    /// Satellites that stations look for, ITRF metres.
    pub satellites: Vec<DVec3>,
}

impl TrackBuffers {
    pub fn clear(&mut self) {
        self.points.clear();
        self.marks.clear();
        self.fills.clear();
        self.triangles.clear();
        self.labels.clear();
        self.station_labels.clear();
        self.place_labels.clear();
        self.satellites.clear();
    }
}

impl Satellite {
    /// Adds what is to be drawn of it in this frame.
    pub fn write(
        &self,
        index: usize,
        eye: &EyeProjection<'_>,
        axes: &mut Axes,
        buffers: &mut TrackBuffers,
    ) {
        let Some(reference) = self.reference.filter(|_| !self.style.is_nothing()) else {
            return;
        };
        let itrf_from_inertial = axes.itrf_from(reference.frame);
        let place_itrf_m = self.now_m.map(|place| itrf_from_inertial * place);
        // Of thousands of satellites only markers are drawn: what those do not need is not computed.
        let has_foot = self.style.subpoint || self.style.ground_track.is_some();
        let subpoint_itrf_m = place_itrf_m
            .filter(|_| has_foot)
            .map(|place| subpoint(place, eye.ellipsoid));
        if let (Some(footprint), Some(place)) = (self.style.footprint, place_itrf_m) {
            let half_angle_rad = footprint.half_angle_rad.unwrap_or(WIDEST_HALF_ANGLE_RAD);
            self.write_footprint(place, half_angle_rad, footprint.is_filled, eye, buffers);
        }
        if let (Some(curve), Some(span)) = (&self.ground, self.style.ground_track) {
            let window = reference.window(span, self.now_s);
            let mut line = self.line(TRACK_ON_GROUND, eye, &mut buffers.points);
            curve.walk(window, subpoint_itrf_m, |t_s, place| {
                line.add(place, opacity(t_s, window));
            });
        }
        if let (Some(curve), Some(span)) = (&self.trail, self.style.trail) {
            let window = reference.window(span, self.now_s);
            let mut line = self.line(0, eye, &mut buffers.points);
            curve.walk(window, self.now_m, |t_s, place| {
                line.add(itrf_from_inertial * place, opacity(t_s, window));
            });
        }
        let scale = 0.5 * self.style.width_px;
        let mut mark = |place: DVec3, flags, radius_px: f32| {
            buffers.marks.push(Mark {
                from_eye_m: (place - eye.itrf_m).as_vec3().to_array(),
                flags,
                colors: self.ink.at(1.0),
                radius_px: radius_px * scale,
            });
        };
        if let Some(subpoint) = subpoint_itrf_m.filter(|_| self.style.subpoint) {
            mark(subpoint, TRACK_ON_GROUND, RING_PX);
        }
        if let Some(place) = place_itrf_m.filter(|_| self.style.marker)
            && place.distance(eye.itrf_m) >= NEAREST_MARKER_M
        {
            // The slope of the ground would cut a dot on it.
            let is_low = place.length() < eye.ellipsoid.equatorial_radius_m + GROUND_MARKER_M
                && eye.ellipsoid.geodetic_from_itrf(place).height_m < GROUND_MARKER_M;
            match is_low {
                true => mark(place, TRACK_ON_GROUND, RING_PX),
                false => mark(place, 0, MARKER_PX),
            }
            let at_px = eye
                .pixel(place)
                .filter(|_| !is_hidden(eye.itrf_m, place, eye.ellipsoid));
            buffers.labels.extend(at_px.map(|at_px| TrackLabel {
                satellite: index,
                at_px,
                color: self.style.color,
            }));
        }
    }

    fn line<'l>(
        &'l self,
        flags: u32,
        eye: &EyeProjection<'_>,
        points: &'l mut Vec<LinePoint>,
    ) -> LineWriter<'l> {
        LineWriter::new(&self.ink, 0.5 * self.style.width_px, flags, eye, points)
    }

    fn write_footprint(
        &self,
        place_itrf_m: DVec3,
        half_angle_rad: f64,
        is_filled: bool,
        eye: &EyeProjection<'_>,
        buffers: &mut TrackBuffers,
    ) {
        let outline = &mut buffers.outline;
        outline.clear();
        footprint_outline(place_itrf_m, half_angle_rad, eye.ellipsoid, |point| {
            outline.push(point);
        });
        let mut line = self.line(TRACK_ON_GROUND, eye, &mut buffers.points);
        for point in outline.iter().chain(outline.first()) {
            line.add(*point, OUTLINE_OPACITY);
        }
        if is_filled && !outline.is_empty() {
            buffers
                .fills
                .extend(self.fill(place_itrf_m, half_angle_rad, outline, eye));
        }
    }

    /// `None` where none of it can be on screen.
    fn fill(
        &self,
        place_itrf_m: DVec3,
        half_angle_rad: f64,
        outline: &[DVec3],
        eye: &EyeProjection<'_>,
    ) -> Option<Fill> {
        let geodetic = eye.ellipsoid.geodetic_from_itrf(place_itrf_m);
        let down = -Ellipsoid::normal(geodetic.lat_rad, geodetic.lon_rad);
        // The cap lies in the ball about its foot that reaches its outline.
        let center = subpoint(place_itrf_m, eye.ellipsoid);
        let reach = outline.iter().map(|point| point.distance_squared(center));
        let radius_m = reach.fold(0.0, f64::max).sqrt();
        let bounds = eye.bounds(center, radius_m)?;
        let nearest_m = (center.distance(eye.itrf_m) - radius_m).max(0.0);
        let toward = (center - eye.itrf_m).normalize_or(down);
        let clip = eye.clip(eye.itrf_m + toward * nearest_m.max(1.0));
        Some(Fill {
            bounds,
            apex: (eye.ellipsoid.scaled_from_itrf() * place_itrf_m)
                .as_vec3()
                .to_array(),
            depth: (clip.z / clip.w).clamp(0.0, 1.0) as f32,
            down: down.as_vec3().to_array(),
            tangent: half_angle_rad.min(WIDEST_HALF_ANGLE_RAD).tan() as f32,
            color: self.ink.at(FILL_OPACITY)[0],
        })
    }
}

/// Fading with age, and with what is not yet.
fn opacity(t_s: f64, window: TimeWindow) -> f64 {
    let part = |of: f64, whole: f64| if whole > 0.0 { of / whole } else { 0.0 };
    if t_s <= window.now_s {
        1.0 + (OLDEST - 1.0) * part(window.now_s - t_s, window.now_s - window.from_s)
    } else {
        AHEAD + (LATEST - AHEAD) * part(t_s - window.now_s, window.to_s - window.now_s)
    }
}

/// Writes the points of one line.
pub(super) struct LineWriter<'l> {
    points: &'l mut Vec<LinePoint>,
    eye_itrf_m: DVec3,
    ink: &'l Ink,
    half_width_px: f32,
    /// Of the next point.
    flags: u32,
}

impl<'l> LineWriter<'l> {
    pub fn new(
        ink: &'l Ink,
        half_width_px: f32,
        flags: u32,
        eye: &EyeProjection<'_>,
        points: &'l mut Vec<LinePoint>,
    ) -> Self {
        Self {
            points,
            eye_itrf_m: eye.itrf_m,
            ink,
            half_width_px,
            flags,
        }
    }

    /// The next point is joined to none before it.
    pub fn begin(&mut self) {
        self.flags &= !TRACK_FROM_PREVIOUS;
    }

    pub fn add(&mut self, place_itrf_m: DVec3, opacity: f64) {
        self.points.push(LinePoint {
            from_eye_m: (place_itrf_m - self.eye_itrf_m).as_vec3().to_array(),
            flags: self.flags,
            colors: self.ink.at(opacity),
            half_width_px: self.half_width_px,
        });
        self.flags |= TRACK_FROM_PREVIOUS;
    }
}
