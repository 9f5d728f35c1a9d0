//! A satellite's sensor: its footprint, its field of view as lines in space, and its swath.

use super::buffers::{FILL_OPACITY, OUTLINE_OPACITY, TrackBuffers};
use super::footprint::{WIDEST_HALF_ANGLE_RAD, footprint_outline};
use super::projection::EyeProjection;
use super::satellite::{Axes, Satellite, subpoint, swath_edges};
use super::style::Footprint;
use crate::gpu::{Fill, TRACK_ON_GROUND, Triangle};
use glam::DVec3;
use terrella_frames::Ellipsoid;
use terrella_orbit::{AimedField, FieldOfView, FieldShape};

/// Number of lines that show a cone in space.
const CONE_LINES: usize = 12;
/// Opacity of these lines.
const EDGE_OPACITY: f64 = 0.6;
/// Longest edge of a swath's triangle across the track, radians about the Earth's centre.
const ACROSS_RAD: f64 = 1.3 * std::f64::consts::PI / 180.0;
/// Largest number of triangles across the track.
const MOST_ACROSS: f64 = 64.0;

/// Field of view for the fill's shader: a cone, or with a second tangent a pyramid.
struct FillField {
    axis: DVec3,
    across: DVec3,
    tangents: [f64; 2],
}

impl Satellite {
    /// Adds the ground that is visible from `place`.
    pub(super) fn write_footprint(
        &self,
        place_itrf_m: DVec3,
        flight_itrf: DVec3,
        footprint: Footprint,
        eye: &EyeProjection<'_>,
        buffers: &mut TrackBuffers,
    ) {
        let outline = &mut buffers.outline;
        outline.clear();
        let add = |point| outline.push(point);
        // About nadir the outline has a closed form, which does not need the direction of motion.
        let nadir_rad = match footprint.field {
            None => Some(WIDEST_HALF_ANGLE_RAD),
            Some(field) => nadir_cone(&field),
        };
        let aimed = self
            .style
            .field()
            .aimed(place_itrf_m, flight_itrf, eye.ellipsoid);
        match (nadir_rad, &aimed) {
            (Some(half_rad), _) => footprint_outline(place_itrf_m, half_rad, eye.ellipsoid, add),
            (None, Some(aimed)) => aimed.outline(add),
            (None, None) => {}
        }
        if outline.is_empty() {
            return;
        }
        let mut line = self.line(TRACK_ON_GROUND, eye, &mut buffers.points);
        for point in outline.iter().chain(outline.first()) {
            line.add(*point, OUTLINE_OPACITY);
        }
        if let Some(aimed) = aimed.filter(|_| footprint.has_edges) {
            for direction in aimed.edges(CONE_LINES) {
                let end = aimed.ground(direction);
                let end = end.unwrap_or_else(|| aimed.horizon(direction));
                let mut line = self.line(0, eye, &mut buffers.points);
                line.add(place_itrf_m, EDGE_OPACITY);
                line.add(end, EDGE_OPACITY);
            }
        }
        if footprint.is_filled {
            let field = match (nadir_rad, aimed) {
                (None, Some(aimed)) => FillField::of(&aimed),
                _ => FillField::nadir(place_itrf_m, nadir_rad, eye.ellipsoid),
            };
            buffers
                .fills
                .extend(self.fill(place_itrf_m, &field, outline, eye));
        }
    }

    /// `None` if none of it can be on screen.
    fn fill(
        &self,
        place_itrf_m: DVec3,
        field: &FillField,
        outline: &[DVec3],
        eye: &EyeProjection<'_>,
    ) -> Option<Fill> {
        // The area lies inside the sphere around its middle that reaches its outline.
        let middle = outline.iter().sum::<DVec3>() / outline.len() as f64;
        let center = subpoint(middle, eye.ellipsoid);
        let reach = outline.iter().map(|point| point.distance_squared(center));
        let radius_m = reach.fold(0.0, f64::max).sqrt();
        let bounds = eye.bounds(center, radius_m)?;
        let nearest_m = (center.distance(eye.itrf_m) - radius_m).max(0.0);
        let toward = (center - eye.itrf_m).normalize_or(field.axis);
        let clip = eye.clip(eye.itrf_m + toward * nearest_m.max(1.0));
        let [tangent, side_tangent] = field.tangents;
        Some(Fill {
            bounds,
            apex: (eye.ellipsoid.scaled_from_itrf() * place_itrf_m)
                .as_vec3()
                .to_array(),
            depth: (clip.z / clip.w).clamp(0.0, 1.0) as f32,
            axis: field.axis.as_vec3().to_array(),
            tangent: tangent as f32,
            side: field.across.as_vec3().to_array(),
            side_tangent: side_tangent as f32,
            color: self.ink.at(FILL_OPACITY)[0],
        })
    }

    /// Adds the ground that is swept in the swath's time.
    pub(super) fn write_swath(
        &self,
        eye: &EyeProjection<'_>,
        axes: &mut Axes,
        buffers: &mut TrackBuffers,
    ) {
        let (Some(curve), Some(span), Some(reference)) =
            (&self.swath, self.style.swath(), self.reference)
        else {
            return;
        };
        let itrf = axes.itrf_from(reference.frame);
        let now = self.now_m.and_then(|place| {
            let field = self.style.field();
            swath_edges(&field, itrf * place, itrf * self.flight, eye.ellipsoid)
        });
        let mut strip = Strip {
            colors: self.ink.at(FILL_OPACITY),
            before: None,
            eye,
            first: buffers.triangles.len(),
            row: 0,
            triangles: &mut buffers.triangles,
        };
        let window = reference.window(span, self.now_s);
        curve.walk(window, now, |_, edges| strip.add(edges));
        strip.end();
    }
}

/// The half angle of a cone about nadir.
fn nadir_cone(field: &FieldOfView) -> Option<f64> {
    match field.shape {
        FieldShape::Cone { half_angle_rad } if field.off_nadir_rad == 0.0 => Some(half_angle_rad),
        _ => None,
    }
}

impl FillField {
    fn of(aimed: &AimedField) -> Self {
        Self {
            axis: aimed.boresight,
            across: aimed.across,
            tangents: aimed.tangents(),
        }
    }

    fn nadir(place_itrf_m: DVec3, half_rad: Option<f64>, ellipsoid: &Ellipsoid) -> Self {
        let place = ellipsoid.geodetic_from_itrf(place_itrf_m);
        let half_rad = half_rad.unwrap_or(WIDEST_HALF_ANGLE_RAD);
        Self {
            axis: -Ellipsoid::normal(place.lat_rad, place.lon_rad),
            across: DVec3::ZERO,
            tangents: [half_rad.min(WIDEST_HALF_ANGLE_RAD).tan(), 0.0],
        }
    }
}

/// Triangles between consecutive pairs of edges.
struct Strip<'s> {
    colors: [[u16; 4]; 2],
    before: Option<[DVec3; 2]>,
    eye: &'s EyeProjection<'s>,
    /// Index of its first triangle.
    first: usize,
    /// Number of triangles in the last row.
    row: usize,
    triangles: &'s mut Vec<Triangle>,
}

/// Edges of a triangle opposite to its second and third corner.
const SECOND: u32 = 2;
const THIRD: u32 = 4;

impl Strip<'_> {
    fn add(&mut self, edges: [DVec3; 2]) {
        let Some(before) = self.before.replace(edges) else {
            return;
        };
        let is_first = self.triangles.len() == self.first;
        let ([a, b], [c, d]) = (before, edges);
        self.row = 0;
        let center = 0.25 * (a + b + c + d);
        let reach = [a, b, c, d].map(|corner| corner.distance(center));
        let radius_m = reach.into_iter().fold(0.0, f64::max);
        let (ellipsoid, eye) = (self.eye.ellipsoid, self.eye);
        if eye.faces_away(center, radius_m) {
            return;
        }
        let width_rad = a.angle_between(b).max(c.angle_between(d));
        let columns = (width_rad / ACROSS_RAD).ceil().clamp(1.0, MOST_ACROSS);
        let on_ground = |[left, right]: [DVec3; 2], column: f64| {
            let scaled = ellipsoid.scaled_from_itrf() * left.lerp(right, column / columns);
            let place = ellipsoid.itrf_from_scaled() * scaled.normalize();
            (place - eye.itrf_m).as_vec3().to_array()
        };
        for column in 0..columns as usize {
            let column = column as f64;
            let [near_left, near_right] = [0.0, 1.0].map(|on| on_ground(before, column + on));
            let [far_left, far_right] = [0.0, 1.0].map(|on| on_ground(edges, column + on));
            let left = if column == 0.0 { SECOND } else { 0 };
            let right = if column + 1.0 == columns { SECOND } else { 0 };
            let begin = if is_first { THIRD } else { 0 };
            let corners = [
                (near_left, near_right, far_left, left | begin),
                (far_right, far_left, near_right, right),
            ];
            self.triangles
                .extend(corners.map(|(a_m, b_m, c_m, edges)| Triangle {
                    a_m,
                    edges,
                    b_m,
                    c_m,
                    colors: self.colors,
                }));
        }
        self.row = 2 * columns as usize;
    }

    /// Antialiases the end of the last row.
    fn end(self) {
        let row = self.triangles.len() - self.row;
        // The second triangle of each pair has its first two corners there.
        for triangle in self.triangles[row..].iter_mut().skip(1).step_by(2) {
            triangle.edges |= THIRD;
        }
    }
}
