//! Elements of a satellite in a frame: points of lines, marks, fills and labels, made eye-relative for the GPU.

use super::curve::TimeWindow;
use super::ink::Ink;
use super::projection::EyeProjection;
use super::satellite::{Axes, Satellite, subpoint};
use crate::gpu::{Fill, LinePoint, Mark, Triangle};
use crate::gpu::{TRACK_FROM_PREVIOUS, TRACK_ON_GROUND};
use glam::DVec3;

/// Distance below which a satellite has no marker, metres: it is then the eye's own or a visible spacecraft.
pub const NEAREST_MARKER_M: f64 = 1000.0;

/// Height below which a satellite is marked as a place on the ground, by a ring around a point, metres.
const GROUND_MARKER_M: f64 = 10_000.0;

/// Radii of a marker and of the ring on the ground, pixels, for lines of width 2 pixels.
const MARKER_PX: f32 = 4.0;
pub(super) const RING_PX: f32 = 6.0;
/// Generous limit of the width of a mark's edge, pixels.
const MARK_EDGE_PX: f64 = 4.0;
/// Opacity of a trail's oldest point, of the first after now, and of the last.
const OLDEST: f64 = 0.12;
const AHEAD: f64 = 0.6;
const LATEST: f64 = 0.15;
/// Opacity of a footprint's outline and of its fill.
pub(super) const OUTLINE_OPACITY: f64 = 0.863;
pub(super) const FILL_OPACITY: f64 = 0.173;

/// Position of a satellite's name: beside its dot, which is inside the image and not hidden.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackLabel {
    /// Index of the satellite's style.
    pub satellite: usize,
    /// Centre of the dot, pixels from the viewport's upper left corner.
    pub at_px: [f32; 2],
    /// Its colour, display values.
    pub color: [u8; 3],
}

/// Position of a station's name: beside its mark, which is inside the image and not hidden.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StationLabel {
    /// Index of the station in the list that was set.
    pub station: usize,
    /// Centre of the mark, pixels from the viewport's upper left corner.
    pub at_px: [f32; 2],
    /// Its colour, display values.
    pub color: [u8; 3],
}

/// Position of the name of a marked place, which is inside the image and not hidden.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceLabel {
    /// The place's index in the list that was set.
    pub place: usize,
    /// Centre of its mark, pixels from the viewport's upper left corner.
    pub at_px: [f32; 2],
    /// Its colour, display values.
    pub color: [u8; 3],
    /// Length in pixels of a metre across the line of sight at its distance.
    pub pixels_per_m: f32,
}

/// Data for the GPU, kept between frames for its capacity.
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
    /// Satellites for the stations, ITRF metres.
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
    /// Adds the satellite's elements of this frame.
    pub fn write(
        &self,
        index: usize,
        eye: &EyeProjection<'_>,
        axes: &mut Axes,
        buffers: &mut TrackBuffers,
    ) {
        let Some(reference) = &self.reference else {
            return;
        };
        if self.style.is_nothing() {
            return;
        }
        let itrf_from_inertial = axes.itrf_from(reference.frame);
        let place_itrf_m = self.now_m.map(|place| itrf_from_inertial * place);
        // With thousands of satellites only markers are drawn: nothing else is computed.
        let has_foot = self.style.subpoint || self.style.ground_track.is_some();
        let subpoint_itrf_m = place_itrf_m
            .filter(|_| has_foot)
            .map(|place| subpoint(place, eye.ellipsoid));
        if let (Some(footprint), Some(place)) = (self.style.footprint, place_itrf_m) {
            let flight_itrf = itrf_from_inertial * self.flight;
            self.write_footprint(place, flight_itrf, footprint, eye, buffers);
        }
        self.write_swath(eye, axes, buffers);
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
        if let Some(subpoint) = subpoint_itrf_m.filter(|_| self.style.subpoint) {
            let ring = self.mark(subpoint, TRACK_ON_GROUND, RING_PX, eye);
            buffers.marks.push(ring);
        }
        if let Some(place) = place_itrf_m.filter(|_| self.style.marker) {
            self.write_marker(index, place, eye, buffers);
        }
    }

    fn mark(
        &self,
        place_itrf_m: DVec3,
        flags: u32,
        radius_px: f32,
        eye: &EyeProjection<'_>,
    ) -> Mark {
        Mark {
            from_eye_m: (place_itrf_m - eye.itrf_m).as_vec3().to_array(),
            flags,
            colors: self.ink.opaque(),
            radius_px: radius_px * 0.5 * self.style.width_px,
        }
    }

    /// Adds the dot and the position of its name. Of thousands of satellites most are out of sight: they cost the GPU nothing.
    fn write_marker(
        &self,
        index: usize,
        place_itrf_m: DVec3,
        eye: &EyeProjection<'_>,
        buffers: &mut TrackBuffers,
    ) {
        if place_itrf_m.distance_squared(eye.itrf_m) < NEAREST_MARKER_M * NEAREST_MARKER_M {
            return;
        }
        let reach_px = f64::from(RING_PX * 0.5 * self.style.width_px) + MARK_EDGE_PX;
        let Some(at_px) = eye.pixel_near(place_itrf_m, reach_px) else {
            return;
        };
        // Sloped ground would cut a dot that lies on it.
        let is_low = place_itrf_m.length() < eye.ellipsoid.equatorial_radius_m + GROUND_MARKER_M
            && eye.ellipsoid.geodetic_from_itrf(place_itrf_m).height_m < GROUND_MARKER_M;
        if !is_low && eye.hides_disc(place_itrf_m, reach_px) {
            return;
        }
        let (flags, radius_px) = match is_low {
            true => (TRACK_ON_GROUND, RING_PX),
            false => (0, MARKER_PX),
        };
        let mark = self.mark(place_itrf_m, flags, radius_px, eye);
        buffers.marks.push(mark);
        if eye.is_inside(at_px) && !eye.is_hidden(place_itrf_m) {
            buffers.labels.push(TrackLabel {
                satellite: index,
                at_px,
                color: self.style.color,
            });
        }
    }

    pub(super) fn line<'l>(
        &'l self,
        flags: u32,
        eye: &EyeProjection<'_>,
        points: &'l mut Vec<LinePoint>,
    ) -> LineWriter<'l> {
        LineWriter::new(&self.ink, 0.5 * self.style.width_px, flags, eye, points)
    }
}

/// Opacity that decreases with age and with time into the future.
fn opacity(t_s: f64, window: TimeWindow) -> f64 {
    let part = |of: f64, whole: f64| if whole > 0.0 { of / whole } else { 0.0 };
    if t_s <= window.now_s {
        1.0 + (OLDEST - 1.0) * part(window.now_s - t_s, window.now_s - window.from_s)
    } else {
        AHEAD + (LATEST - AHEAD) * part(t_s - window.now_s, window.to_s - window.now_s)
    }
}

/// Appends the points of one line.
pub(super) struct LineWriter<'l> {
    points: &'l mut Vec<LinePoint>,
    eye_itrf_m: DVec3,
    ink: &'l Ink,
    half_width_px: f32,
    /// Flags of the next point.
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

    /// Starts a line: the next point has no segment from the one before.
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

#[cfg(test)]
mod tests {
    use super::super::style::TrackStyle;
    use super::*;
    use crate::earth::infinite_reversed_z;
    use crate::gpu::{Development, FrameTargets, PassFormat};
    use glam::{DVec2, dcamera};
    use terrella_frames::Ellipsoid;

    /// No ray of a pixel of an omitted mark passes the globe, and few other marks are written.
    #[test]
    fn markers_are_left_out_where_nothing_of_them_is_seen() {
        let format = PassFormat {
            color: FrameTargets::COLOR,
            further: &[],
            samples: 1,
            depth: FrameTargets::REVERSED_DEPTH,
            development: Development::InPass,
            tone: Default::default(),
            bloom: Default::default(),
            grade: Default::default(),
        };
        let style = TrackStyle {
            marker: true,
            ..TrackStyle::new(0)
        };
        let satellite = Satellite::new(&style, &format, 0);
        let ellipsoid = Ellipsoid::WGS84;
        let scale = ellipsoid.scaled_from_itrf();
        let (width, height) = (640.0, 360.0);
        for (eye_m, toward) in [
            (DVec3::new(7.2e6, 0.0, 0.0), DVec3::new(-1.0, 2.0, 0.3)),
            (DVec3::new(9e6, 2e7, 5e6), DVec3::new(-9.0, -20.0, -5.0)),
        ] {
            let look = dcamera::rh::view::look_to_mat4(DVec3::ZERO, toward.normalize(), DVec3::Z);
            let clip = infinite_reversed_z(0.8, width / height, 1.0) * look;
            let eye = EyeProjection::new(eye_m, clip, (640, 360), &ellipsoid);
            let from_clip = clip.inverse();
            let ray = |px: DVec2| {
                let [x, y] = [2.0 * px.x / width - 1.0, 1.0 - 2.0 * px.y / height];
                from_clip.project_point3(DVec3::new(x, y, 0.5)).normalize()
            };
            let is_seen = |place: DVec3| {
                let at = clip * (place - eye_m).extend(1.0);
                if at.w <= 0.0 {
                    return false;
                }
                let at = DVec2::new(at.x / at.w + 1.0, 1.0 - at.y / at.w);
                let at = at * DVec2::new(0.5 * width, 0.5 * height);
                // The dot, its dark outline, and half a pixel more.
                let rim = (0..32).map(|k| at + 5.5 * DVec2::from_angle(f64::from(k) * 0.2));
                let in_picture =
                    |px: &DVec2| (0.0..width).contains(&px.x) && (0.0..height).contains(&px.y);
                rim.filter(in_picture).any(|px| {
                    let (from, along) = (scale * eye_m, (scale * ray(px)).normalize());
                    let is_behind = (scale * place).dot(along) > 0.0 && from.dot(along) < 0.0;
                    from.cross(along).length() >= 1.0 || !is_behind
                })
            };
            let (mut seen, mut written) = (0, 0);
            for k in 0..20_000 {
                let z = 1.0 - f64::from(k) * 1e-4;
                let (sin, cos) = (2.4 * f64::from(k)).sin_cos();
                let around = (1.0 - z * z).sqrt();
                let place = 6.9e6 * DVec3::new(around * cos, around * sin, z);
                let mut buffers = TrackBuffers::default();
                satellite.write_marker(0, place, &eye, &mut buffers);
                let is_written = !buffers.marks.is_empty();
                assert!(is_written || !is_seen(place), "{place}");
                assert!(is_written || buffers.labels.is_empty());
                written += u32::from(is_written);
                seen += u32::from(is_seen(place));
            }
            assert!(
                seen > 100 && written < seen + seen / 3,
                "{written} for {seen}"
            );
        }
    }
}
