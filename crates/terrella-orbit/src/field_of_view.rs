//! Fields of view of sensors, conical and rectangular, at any off-nadir angle: the ground inside them.
//!
//! In scaled space (x/a, y/a, z/b) the ellipsoid is the unit sphere. Rays, planes and tangents are preserved.

use super::one_dimension::{bisect, greatest};
use glam::DVec3;
use std::convert::Infallible;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use terrella_frames::Ellipsoid;

/// Points of a field's edge that are tried for its outline.
pub const EDGE_POINTS: usize = 128;
/// Points of a whole horizon circle.
const HORIZON_POINTS: f64 = 256.0;
/// Widest half angle of a field, radians: a cone of a right angle is no cone.
const WIDEST_RAD: f64 = 89.999 * PI / 180.0;
/// How exactly the edge's place is found where it leaves the Earth, parts of the edge.
const EXACT: f64 = 1e-15;

/// The form of a field of view about its boresight; angles are half angles, radians, above 0 to π/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldShape {
    /// A cone.
    Cone {
        /// Between boresight and edge.
        half_angle_rad: f64,
    },
    /// A pyramid.
    Rectangle {
        /// In the plane of flight, for a boresight that is not turned forwards or back.
        along_rad: f64,
        /// Across it.
        across_rad: f64,
    },
}

/// A field of view as it is mounted on a satellite that flies level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldOfView {
    /// Its form.
    pub shape: FieldShape,
    /// Angle between the boresight and straight down, which is along the ellipsoid's normal, radians, 0 to π/2.
    pub off_nadir_rad: f64,
    /// Direction that the boresight is turned to, clockwise from the direction of flight as seen from above, radians: π/2 is the right.
    pub azimuth_rad: f64,
}

impl FieldOfView {
    /// A cone about nadir.
    pub fn nadir(half_angle_rad: f64) -> Self {
        Self {
            shape: FieldShape::Cone { half_angle_rad },
            off_nadir_rad: 0.0,
            azimuth_rad: FRAC_PI_2,
        }
    }

    /// The requirement that its angles violate, if any.
    pub fn fault(&self) -> Option<&'static str> {
        let is_half = |angle: f64| angle > 0.0 && angle <= FRAC_PI_2;
        let is_sound = match self.shape {
            FieldShape::Cone { half_angle_rad } => is_half(half_angle_rad),
            FieldShape::Rectangle {
                along_rad,
                across_rad,
            } => is_half(along_rad) && is_half(across_rad),
        };
        if !is_sound {
            return Some("half angles of a sensor must be above 0 and at most π/2");
        }
        let is_turned = (0.0..=FRAC_PI_2).contains(&self.off_nadir_rad);
        (!is_turned || !self.azimuth_rad.is_finite())
            .then_some("a sensor's boresight must be from 0 to π/2 off nadir, in a finite azimuth")
    }

    /// The field at a satellite's position, ITRF metres, with a direction of motion relative to the stars, ITRF axes.
    ///
    /// The axes of the field are those of a level satellite, rotated with the boresight by the shortest way. `None` below the ground, and for
    /// vertical motion.
    pub fn aimed(
        &self,
        satellite_itrf_m: DVec3,
        flight_itrf: DVec3,
        ellipsoid: &Ellipsoid,
    ) -> Option<AimedField> {
        let eye = ellipsoid.scaled_from_itrf() * satellite_itrf_m;
        let above = (eye.length() - 1.0) * (eye.length() + 1.0);
        // Also false for a place that is no number.
        if !(above > 0.0 && eye.is_finite()) {
            return None;
        }
        let place = ellipsoid.geodetic_from_itrf(satellite_itrf_m);
        let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let ahead = (flight_itrf - flight_itrf.dot(up) * up).try_normalize()?;
        let right = ahead.cross(up);
        let (sin_azimuth, cos_azimuth) = self.azimuth_rad.sin_cos();
        let toward = cos_azimuth * ahead + sin_azimuth * right;
        let aside = cos_azimuth * right - sin_azimuth * ahead;
        let (sin, cos) = self.off_nadir_rad.sin_cos();
        let boresight = sin * toward - cos * up;
        // Straight down turned to the boresight takes `toward` along and leaves `aside`.
        let turned = cos * toward + sin * up;
        Some(AimedField {
            shape: self.shape,
            boresight,
            along: cos_azimuth * turned - sin_azimuth * aside,
            across: sin_azimuth * turned + cos_azimuth * aside,
            eye,
            above,
            ellipsoid: *ellipsoid,
        })
    }
}

/// A field of view at an instant.
#[derive(Clone, Copy, Debug)]
pub struct AimedField {
    shape: FieldShape,
    /// Direction of the boresight, unit, ITRF axes.
    pub boresight: DVec3,
    /// Axis of the field that points in the direction of motion if the boresight is not rotated, unit.
    pub along: DVec3,
    /// The axis across, unit: to the right.
    pub across: DVec3,
    /// The satellite, scaled space, and |eye|² − 1.
    eye: DVec3,
    above: f64,
    ellipsoid: Ellipsoid,
}

impl AimedField {
    /// Angular distance of a direction from the edge of the field, radians; negative outside.
    pub fn margin_rad(&self, ray: DVec3) -> f64 {
        let ahead = ray.dot(self.boresight);
        let off = |axis: DVec3| ray.dot(axis).abs().atan2(ahead);
        match self.shape {
            FieldShape::Cone { half_angle_rad } => {
                half_angle_rad - ray.cross(self.boresight).length().atan2(ahead)
            }
            FieldShape::Rectangle {
                along_rad,
                across_rad,
            } => (along_rad - off(self.along)).min(across_rad - off(self.across)),
        }
    }

    /// Tangents of the half angles along and across; of a cone the one, and 0.
    pub fn tangents(&self) -> [f64; 2] {
        let tangent = |angle: f64| angle.min(WIDEST_RAD).tan();
        match self.shape {
            FieldShape::Cone { half_angle_rad } => [tangent(half_angle_rad), 0.0],
            FieldShape::Rectangle {
                along_rad,
                across_rad,
            } => [tangent(along_rad), tangent(across_rad)],
        }
    }

    /// Directions of lines that show the field in space: of a pyramid its four edges, of a cone `count`.
    pub fn edges(&self, count: usize) -> impl Iterator<Item = DVec3> {
        let (count, first) = match self.shape {
            FieldShape::Cone { .. } => (count, 0.0),
            FieldShape::Rectangle { .. } => (4, 0.125),
        };
        (0..count).map(move |k| self.edge(first + k as f64 / count as f64))
    }

    /// Where a direction from the satellite meets the ground, ITRF metres; `None` if it misses the Earth.
    pub fn ground(&self, direction: DVec3) -> Option<DVec3> {
        let d = (self.ellipsoid.scaled_from_itrf() * direction).normalize();
        let nearest = -self.eye.dot(d);
        // 1 − |e × d|² is the square of half the chord.
        let q = self.eye.cross(d).length();
        if !(nearest > 0.0 && q <= 1.0) {
            return None;
        }
        let half_chord = ((1.0 - q) * (1.0 + q)).sqrt();
        let along = self.above / (nearest + half_chord);
        Some(self.itrf(self.eye + along * d))
    }

    /// Where the horizon is on the side that a direction points to, ITRF metres.
    pub fn horizon(&self, direction: DVec3) -> DVec3 {
        let d = self.ellipsoid.scaled_from_itrf() * direction;
        let up = self.eye.normalize();
        let level = (d - d.dot(up) * up).normalize_or(up.any_orthonormal_vector());
        self.horizon_point(up, level)
    }

    /// The outline of the visible ground in the field, points on the ellipsoid, ITRF metres, clockwise from above: where the edge of the field
    /// meets the ground, or the horizon where the edge misses the Earth. Empty if the field contains no ground.
    pub fn outline(&self, mut give: impl FnMut(DVec3)) {
        let at = |k: usize| k as f64 / EDGE_POINTS as f64;
        let meets = |s: f64| self.ground(self.edge(s));
        let Some(first) = (0..EDGE_POINTS).find(|k| meets(at(*k)).is_some()) else {
            // All of the Earth is inside the field, or none of it.
            if self.margin_rad(-(self.ellipsoid.itrf_from_scaled() * self.eye)) > 0.0 {
                self.horizon_arc(0.0, TAU, &mut give);
            }
            return;
        };
        // Where the edge left the Earth, as an angle of the horizon.
        let mut left: Option<f64> = None;
        let mut before = at(first);
        for k in first..=first + EDGE_POINTS {
            let s = at(k);
            match (meets(s), left) {
                (Some(point), None) => {
                    if k < first + EDGE_POINTS {
                        give(point);
                    }
                }
                (Some(point), Some(from)) => {
                    let crossing = self.crossing(before, s, true);
                    self.horizon_arc(from, self.horizon_angle(crossing), &mut give);
                    if k < first + EDGE_POINTS {
                        give(point);
                    }
                    left = None;
                }
                (None, None) => {
                    let crossing = self.crossing(before, s, false);
                    left = Some(self.horizon_angle(crossing));
                }
                (None, Some(_)) => {}
            }
            before = s;
        }
    }

    /// The place of the ground in the field that is farthest to the right of the plane of flight, ITRF metres, or with `side` −1 to the left:
    /// an edge of the swath. `None` where no ground is in the field.
    pub fn swath_edge(&self, flight_itrf: DVec3, side: f64) -> Option<DVec3> {
        let up = (self.ellipsoid.itrf_from_scaled() * self.eye).normalize();
        let right = side * flight_itrf.cross(up).try_normalize()?;
        // A quarter of the edge to each side of its middle on that side.
        let middle = if side > 0.0 { 0.25 } else { 0.75 };
        let place = |s: f64| {
            let direction = self.edge(s);
            self.ground(direction).ok_or(direction)
        };
        let value = |s: f64| {
            let at = place(s).unwrap_or_else(|direction| self.horizon(direction));
            Ok::<_, Infallible>(at.dot(right))
        };
        let (s, _) = greatest(middle - 0.2, middle + 0.2, 1e-6, value, |_| false)
            .unwrap_or_else(|never| match never {});
        match place(s) {
            Ok(point) => Some(point),
            // Past the Earth the horizon bounds what is seen, if any of the ground is.
            Err(direction) => {
                let down = -up;
                let is_seen = self.margin_rad(down) > 0.0
                    || (0..8).any(|k| self.ground(self.edge(f64::from(k) / 8.0)).is_some());
                is_seen.then(|| self.horizon(direction))
            }
        }
    }

    /// A direction of the edge, unit: once around from 0 to 1, clockwise from above, ahead at 0.
    fn edge(&self, s: f64) -> DVec3 {
        let (sin, cos) = (TAU * s).sin_cos();
        let [along, across] = self.tangents();
        let (u, v) = match self.shape {
            FieldShape::Cone { .. } => (along * cos, along * sin),
            // A circle mapped to the square: its corners are halfway between its sides.
            FieldShape::Rectangle { .. } => {
                let most = cos.abs().max(sin.abs());
                (along * cos / most, across * sin / most)
            }
        };
        (self.boresight + u * self.along + v * self.across).normalize()
    }

    /// Where the edge crosses the limb between two of its points; `meets` is whether the second one meets the ground.
    fn crossing(&self, from: f64, to: f64, meets: bool) -> DVec3 {
        let has_turned = |s: f64| Ok::<_, Infallible>(self.ground(self.edge(s)).is_some() == meets);
        let (_, s) = bisect(from, to, EXACT, has_turned).unwrap_or_else(|never| match never {});
        self.edge(s)
    }

    /// Axes of the horizon's circle: towards the satellite, and two across, of which the first turns into the second as the field's edge goes.
    fn horizon_axes(&self) -> [DVec3; 3] {
        let up = self.eye.normalize();
        let level = up.any_orthonormal_vector();
        [up, level, level.cross(up)]
    }

    fn horizon_angle(&self, direction: DVec3) -> f64 {
        let [_, a, b] = self.horizon_axes();
        let d = self.ellipsoid.scaled_from_itrf() * direction;
        d.dot(b).atan2(d.dot(a))
    }

    /// The horizon from one angle on to another, both included, in the direction of the edge.
    fn horizon_arc(&self, from: f64, to: f64, give: &mut impl FnMut(DVec3)) {
        let [up, a, b] = self.horizon_axes();
        let turn = match to - from == TAU {
            true => TAU,
            false => (to - from).rem_euclid(TAU),
        };
        let steps = (turn / TAU * HORIZON_POINTS).ceil().max(1.0);
        let last = if turn == TAU { steps - 1.0 } else { steps };
        for k in 0..=last as usize {
            let (sin, cos) = (from + turn * k as f64 / steps).sin_cos();
            give(self.horizon_point(up, cos * a + sin * b));
        }
    }

    /// p·e = 1 on the unit sphere.
    fn horizon_point(&self, up: DVec3, level: DVec3) -> DVec3 {
        let away = self.eye.length().recip();
        let aside = ((1.0 - away) * (1.0 + away)).sqrt();
        self.itrf(away * up + aside * level)
    }

    /// A place of scaled space, onto the ellipsoid to the last digit.
    fn itrf(&self, scaled: DVec3) -> DVec3 {
        self.ellipsoid.itrf_from_scaled() * scaled.normalize()
    }
}

#[cfg(test)]
#[path = "field_of_view_tests.rs"]
mod tests;
