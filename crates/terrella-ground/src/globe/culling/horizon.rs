//! Occlusion by the Earth itself: the horizon of ground between two heights, for any ellipsoid of revolution.
//!
//! All computations are in *scaled space*, (x/a, y/a, z/b): there the ellipsoid is the unit sphere, straight lines stay straight and
//! tangents stay tangents. L is the eye's distance from the centre. ρ is the radius of a sphere below all ground (the *occluder*), R that
//! of a sphere above all ground. Ground is visible only within this angle of the eye's radius:
//!
//! ```text
//! θ ≤ acos(ρ/L) + acos(ρ/R)
//! ```
//!
//! There a line of sight that grazes the occluder leaves the highest ground behind it. For flat ground (ρ = R = 1) the limit is the plane
//! of the limb, P·e ≥ 1.

use super::rect::ScaledRect;
use crate::height::HeightRange;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};
use terrella_frames::Ellipsoid;

/// Generous bound of the rounding of radii in scaled space: 0.6 mm.
const ROUNDING: f64 = 1e-10;

/// Ground between two heights, as a shell in scaled space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundShell {
    /// No ground is below this radius.
    pub lowest: f64,
    /// No ground is above this radius.
    pub highest: f64,
    /// Largest distance, on the unit sphere, between the direction of a point from the centre and its foot on the ellipsoid: heights are
    /// along the ellipsoid's normal.
    pub lean: f64,
}

impl GroundShell {
    /// The ellipsoid itself.
    pub const SMOOTH: Self = Self {
        lowest: 1.0,
        highest: 1.0,
        lean: 0.0,
    };

    /// All points at these heights.
    pub fn new(ellipsoid: &Ellipsoid, range: HeightRange) -> Self {
        let lowest = lowest_radius(ellipsoid, range.low_m).max(0.0);
        let most_m = range.low_m.abs().max(range.high_m.abs());
        Self {
            lowest,
            highest: highest_radius(ellipsoid, range.high_m).max(lowest),
            // A chord is shorter than its arc, and the arc shorter than its tangent. Two points are never farther apart than 2.
            lean: (sideways(ellipsoid, most_m) / lowest).min(2.0),
        }
    }
}

/// Largest displacement of a point at a height (either sign) across its foot's direction.
///
/// The foot p of scaled space has the normal n ∝ D⁻¹p. A height h moves it by h D⁻²p/|D⁻¹p|, and across p by
/// h |sin β cos β| |1/b² − 1/a²| / |D⁻¹p|.
fn sideways(ellipsoid: &Ellipsoid, height_m: f64) -> f64 {
    let (a, b) = (ellipsoid.equatorial_radius_m, ellipsoid.polar_radius_m);
    let apart = (a - b).abs() * (a + b) / (a * b).powi(2);
    0.5 * height_m.abs() * apart * a.max(b)
}

/// Lower bound of the radius, in scaled space, of points at this height.
///
/// With p a unit vector of scaled space and n the ellipsoid's normal there, |p + h D⁻¹n| is at least |1 + h p·D⁻¹n|, and
/// p·D⁻¹n = |D⁻¹p| is 1/a…1/b.
pub fn lowest_radius(ellipsoid: &Ellipsoid, height_m: f64) -> f64 {
    let (a, b) = (ellipsoid.equatorial_radius_m, ellipsoid.polar_radius_m);
    1.0 + height_m / if height_m < 0.0 { b.min(a) } else { a.max(b) } - ROUNDING
}

/// Upper bound of the radius, in scaled space, of points at this height.
///
/// |p + h D⁻¹n| is at most 1 + |h D⁻¹n| with |D⁻¹n| in 1/a…1/b. For negative heights it is the root of the sum of squares
/// of two parts: what remains along p, and the displacement across p.
pub fn highest_radius(ellipsoid: &Ellipsoid, height_m: f64) -> f64 {
    let (a, b) = (ellipsoid.equatorial_radius_m, ellipsoid.polar_radius_m);
    if height_m < 0.0 {
        return (1.0 + height_m / a.max(b)).hypot(sideways(ellipsoid, height_m)) + ROUNDING;
    }
    1.0 + height_m / b.min(a) + ROUNDING
}

/// acos(radius/length) without cancellation: the angle between a point's radius and the tangent points on a sphere. 0 for a point inside.
pub fn tangent_angle_rad(length: f64, radius: f64) -> f64 {
    let above = (length - radius).max(0.0) * (length + radius);
    above.sqrt().atan2(radius)
}

/// Whether the angle between two unit vectors is at most `angle_rad`. It uses the chord 2 sin(θ/2), which is exact for small angles too.
pub fn is_within_angle(a: DVec3, b: DVec3, angle_rad: f64) -> bool {
    a.distance(b) <= 2.0 * (0.5 * angle_rad.min(PI)).sin()
}

/// The horizon of an eye over ground between two heights.
///
/// An eye below the occluder has none: nothing is certainly hidden from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    ellipsoid: Ellipsoid,
    shell: GroundShell,
    /// Scaled space from ITRF metres, and the largest of its three factors.
    scale: DVec3,
    most_scale: f64,
    /// The eye in scaled space.
    eye: DVec3,
    /// The eye's direction from the centre.
    up: DVec3,
    /// L.
    distance: f64,
    /// ρ/L: sine of the occluder's angular radius, and cosine of the angle at the centre where tangents touch it.
    sin_radius: f64,
    /// √(L² − ρ²)/L: cosine of that radius, and sine of that angle.
    cos_radius: f64,
}

impl Horizon {
    pub fn new(ellipsoid: &Ellipsoid, eye_itrf_m: DVec3, shell: GroundShell) -> Self {
        let scale = ellipsoid.scaled_from_itrf();
        let eye = eye_itrf_m * scale;
        let distance = eye.length();
        let above = (distance - shell.lowest).max(0.0) * (distance + shell.lowest);
        Self {
            ellipsoid: *ellipsoid,
            shell,
            scale,
            most_scale: scale.max_element(),
            eye,
            up: eye / distance,
            distance,
            sin_radius: shell.lowest / distance,
            cos_radius: above.sqrt() / distance,
        }
    }

    /// The eye in scaled space.
    pub fn eye_scaled(&self) -> DVec3 {
        self.eye
    }

    /// Whether the eye is on or above the occluder; otherwise nothing is hidden.
    pub fn is_eye_above(&self) -> bool {
        self.distance >= self.shell.lowest
    }

    /// θ of the occluder's limb, radians of scaled space.
    pub fn limb_rad(&self) -> f64 {
        tangent_angle_rad(self.distance, self.shell.lowest)
    }

    /// θ of the farthest ground that can be visible. An eye below the occluder is treated as on its surface.
    pub fn far_rad(&self) -> f64 {
        self.limb_rad() + tangent_angle_rad(self.shell.highest, self.shell.lowest)
    }

    /// Lowest height that can be visible at an angle from the eye's radius, metres, at most a millimetre too low. Anything lower is behind
    /// the occluder.
    pub fn lowest_visible_m(&self, theta_rad: f64) -> f64 {
        let beyond = theta_rad - self.limb_rad();
        if beyond <= 0.0 {
            return f64::NEG_INFINITY;
        }
        if beyond >= FRAC_PI_2 {
            return f64::INFINITY;
        }
        let over = self.shell.lowest / beyond.cos() - 1.0;
        let (a, b) = (
            self.ellipsoid.equatorial_radius_m,
            self.ellipsoid.polar_radius_m,
        );
        over * if over > 0.0 { b.min(a) } else { a.max(b) } - 1e-3
    }

    /// Whether the occluder is between the eye and a point, ITRF metres. Exact if neither eye nor point is inside the occluder. From
    /// inside, points beyond the middle of the ray's chord are hidden.
    pub fn hides_point(&self, point_itrf_m: DVec3) -> bool {
        self.hides_around(point_itrf_m, 0.0)
    }

    /// Whether the same is true of everything seen within `angle_rad` of a point. Valid for points more than 10 km above the occluder and
    /// angles of less than a tenth of a radian.
    #[inline]
    pub fn hides_around(&self, point_itrf_m: DVec3, angle_rad: f64) -> bool {
        let point = point_itrf_m * self.scale;
        let along = point - self.eye;
        // Angles in scaled space are larger by less than a hundredth.
        let radius = self.shell.lowest - self.distance * 1.01 * angle_rad;
        let aside = self.eye.cross(along).length_squared();
        // The sphere is in front of the eye, and the point beyond the middle of the ray's chord.
        radius > 0.0
            && aside < radius * radius * along.length_squared()
            && self.eye.dot(along) < 0.0
            && point.dot(along) > 0.0
    }

    /// Whether all ground of the shell with feet in a rectangle is hidden.
    pub fn hides_rect(&self, rect: &ScaledRect) -> bool {
        // P·e < L cos(acos(ρ/L) + acos(ρ/R)). For flat ground the right-hand side is 1 to the last bit.
        let (sin, cos) = self.behind_limb(self.shell.highest);
        let least = self.shell.lowest * cos - self.distance * self.cos_radius * sin;
        self.is_eye_above() && rect.max_dot(self.eye) + self.shell.lean * self.distance < least
    }

    /// Whether all ground of the shell with feet in a cap is hidden. The cap is all points within `half_angle_rad` of `axis`, a unit vector
    /// of scaled space.
    pub fn hides_cap(&self, axis: DVec3, half_angle_rad: f64) -> bool {
        let lean_rad = 2.0 * (0.5 * self.shell.lean).asin();
        let up = self.eye / self.distance;
        self.is_eye_above()
            && !is_within_angle(axis, up, half_angle_rad + lean_rad + self.far_rad())
    }

    /// Whether all ground in a ball is hidden, if none of it is higher than `high_m`. The ground may be as low as the shell, and the
    /// terrain drawn there may be lower.
    ///
    /// It is hidden if the whole ball is in the occluder's shadow. It is also hidden behind the cone about the eye's radius beyond which no
    /// ground of that height is visible. The first test is tighter for small balls, the second for large ones, which bulge out of the
    /// ground.
    pub fn hides_ball(&self, center_itrf_m: DVec3, radius_m: f64, high_m: f64) -> bool {
        if !self.is_eye_above() {
            return false;
        }
        // A ball becomes an ellipsoid inside a ball.
        let (center, radius) = (center_itrf_m * self.scale, radius_m * self.most_scale);
        let up = self.up;
        let along = center.dot(up);
        // The shadow begins at the plane of the limb, √(L² − ρ²) cos α from the eye. From there on it is the inside of a cone.
        let inwards = self.distance - along;
        let to_limb_plane = self.distance * self.cos_radius * self.cos_radius;
        // Early exit for most near balls: they are before that plane, with the centre inside the limb's cone about the eye's radius. No
        // square roots are needed.
        let is_before_limb = inwards - radius <= to_limb_plane;
        let limb_along = center.length_squared() * self.sin_radius * self.sin_radius;
        if is_before_limb && along > 0.0 && along * along >= limb_along {
            return false;
        }
        let aside = (center - up * along).length();
        let is_in_shadow = inwards - radius > to_limb_plane
            && inwards * self.sin_radius - aside * self.cos_radius > radius;
        if is_in_shadow {
            return true;
        }
        let highest = highest_radius(&self.ellipsoid, high_m).max(self.shell.lowest);
        let (sin, cos) = self.behind_limb(highest);
        let (cos_far, sin_far) = (
            self.sin_radius * cos - self.cos_radius * sin,
            self.cos_radius * cos + self.sin_radius * sin,
        );
        // |center| sin(θ − far) is the distance of the ball's centre outside the cone. |center| cos(θ − far) is its
        // distance from the apex along the cone.
        let (across, ahead) = (
            aside * cos_far - along * sin_far,
            aside * sin_far + along * cos_far,
        );
        let to_cone = if ahead > 0.0 { across } else { center.length() };
        across > 0.0 && to_cone > radius
    }

    /// Sine and cosine of acos(ρ/R): the angle behind the limb within which ground up to R is visible.
    fn behind_limb(&self, highest: f64) -> (f64, f64) {
        let lowest = self.shell.lowest;
        let above = (highest - lowest).max(0.0) * (highest + lowest);
        (above.sqrt() / highest, lowest / highest)
    }
}
