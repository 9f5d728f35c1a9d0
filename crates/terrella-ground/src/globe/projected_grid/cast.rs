//! Maps a view direction to a place on the ground and back.
//!
//! All computations are on the unit sphere of scaled space, (x/a, y/a, z/b), about the eye's own radius û, with angles. L is the eye's
//! distance from the centre. s is the radius of the sphere that rays are cast on (the *base*: the ellipsoid, raised to the ground under the
//! eye). A ray at η from straight down grazes the base at η_b = asin(s/L). With δ = η_b − η, it meets the base at
//!
//! ```text
//! t/L = cos²η_b / (cos η + √(sin δ sin(η_b + η)))        sin θ = (t/L) sin η / sin η_b
//! ```
//!
//! where θ is the angle at the centre between eye and place. It is the root t = c/(−e·d + √(s² − |e × d|²)) of c = L² − s² with s² − L²
//! sin²η = L² sin(η_b − η) sin(η_b + η). Nothing cancels, at any height or at the limb.

use super::screen::ScreenPlane;
use glam::DVec3;
use terrella_frames::Ellipsoid;

/// Where a ray meets a sphere about the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cast {
    /// Distance along the ray, in lengths of its direction.
    Hit(f64),
    /// The ray misses, or the sphere is behind the eye: the point of the limb nearest to the ray's plane through the centre.
    Limb(DVec3),
}

/// Casts a ray from `eye`, outside the sphere, along a unit vector.
///
/// t = c/(−e·d + √(s² − |e × d|²)) with c = |e|² − s²: Lagrange's identity in place of b² − c. The limb is the circle
/// where tangents touch, s²/L from the centre along the eye's radius.
pub fn cast(eye: DVec3, direction: DVec3, radius: f64) -> Cast {
    let length = eye.length();
    let across = eye.cross(direction);
    let inside = radius * radius - across.length_squared();
    let ahead = -eye.dot(direction);
    if inside >= 0.0 && ahead > 0.0 {
        let c = (length - radius) * (length + radius);
        return Cast::Hit(c / (ahead + inside.sqrt()));
    }
    let up = eye / length;
    let aside = (direction - up * up.dot(direction)).normalize_or(up.any_orthonormal_vector());
    let cos = (radius / length).min(1.0);
    Cast::Limb((up * cos + aside * ((1.0 - cos) * (1.0 + cos)).sqrt()) * radius)
}

/// The place on the ground that a direction maps to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Position on the unit sphere of scaled space.
    pub place: DVec3,
    /// Change of θ with the ray's angle, away from the eye, and the same across.
    pub stretch: (f64, f64),
}

/// Maps directions to places, for one eye.
///
/// With `spread` = 0, a ray that hits the base maps to its intersection. Otherwise rays are first pulled towards the limb, δ → δ²g/(δ + κ)
/// with κ = `spread` and g = 1 + κ/η_b. This keeps nadir and limb in place, and removes the limb's square root from the spacing. It also
/// adds rows where steep terrain is visible although its ground is seen edge on. The κ above the limb map to the ground behind it, evenly
/// in θ, as far as terrain can be visible over it. Higher rays map to the far edge of that ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Caster {
    /// Semi-axes, metres.
    pub radii_m: DVec3,
    /// Reciprocals of the semi-axes.
    pub per_radius: DVec3,
    /// The eye's direction in scaled space, û.
    pub up: DVec3,
    /// L − 1, so that the ellipsoid itself is 0.
    pub above: f64,
    /// Angle from straight down to the base's limb, and its sine and cosine.
    pub limb_rad: f64,
    /// s/L.
    pub sin_limb: f64,
    /// √(L² − s²)/L.
    pub cos_limb: f64,
    /// θ of the base's limb.
    pub near_rad: f64,
    /// θ of the farthest ground that can be visible.
    pub far_rad: f64,
    /// κ, radians.
    pub spread_rad: f64,
}

impl Caster {
    /// A caster for an eye, ITRF metres, over a base `clearance_m` (more than 0) below it along its radius.
    pub fn new(ellipsoid: &Ellipsoid, eye_itrf_m: DVec3, clearance_m: f64) -> Self {
        let radii_m = ellipsoid.itrf_from_scaled();
        let eye = eye_itrf_m * ellipsoid.scaled_from_itrf();
        let length = eye.length();
        let up = eye.normalize_or(DVec3::Z);
        let below = (clearance_m / (radii_m * up).length()).min(0.999 * length);
        let base = length - below;
        // c = (L − s)(L + s).
        let cos_limb = (below * (length + base)).sqrt() / length;
        let sin_limb = base / length;
        let limb_rad = sin_limb.atan2(cos_limb);
        let near_rad = cos_limb.atan2(sin_limb);
        Self {
            radii_m,
            per_radius: ellipsoid.scaled_from_itrf(),
            up,
            above: length - 1.0,
            limb_rad,
            sin_limb,
            cos_limb,
            near_rad,
            far_rad: near_rad,
            spread_rad: 0.0,
        }
    }

    /// The place that a direction, in ITRF axes and of any length, maps to.
    pub fn foot(&self, direction: DVec3) -> Foot {
        let (nadir_rad, sin, aside) = self.lean(direction);
        let below = self.limb_rad - nadir_rad;
        let (place, along) = if below > 0.0 {
            let (sin, cos, along) = self.hit(below);
            (self.up * cos + aside * sin, along)
        } else {
            let (theta, along) = self.behind(below);
            let (sin, cos) = theta.sin_cos();
            (self.up * cos + aside * sin, along)
        };
        let across = if sin > 1e-6 {
            let beyond = below < -self.spread_rad;
            let shown = if beyond {
                (self.limb_rad + self.spread_rad).sin()
            } else {
                sin
            };
            place.dot(aside) / shown
        } else {
            along
        };
        Foot {
            place,
            stretch: (along, across),
        }
    }

    /// Angle between a direction, ITRF axes, and straight down, in scaled space.
    pub fn nadir(&self, direction: DVec3) -> f64 {
        self.lean(direction).0
    }

    /// That angle, its sine, and the level unit vector that the direction leans towards.
    fn lean(&self, direction: DVec3) -> (f64, f64, DVec3) {
        let ray = direction * self.per_radius;
        let down = -self.up.dot(ray);
        let level = ray + self.up * down;
        // Project once more: the remainder of a ray that points almost straight down has rounding errors.
        let level = level - self.up * self.up.dot(level);
        let across = level.length();
        let aside = if across > 0.0 {
            level * (1.0 / across)
        } else {
            self.up.any_orthonormal_vector()
        };
        let length = (across * across + down * down).sqrt();
        (across.atan2(down), across / length, aside)
    }

    /// sin θ, cos θ and dθ/dη of a ray `below` > 0 radians under the limb.
    fn hit(&self, below: f64) -> (f64, f64, f64) {
        let gain = self.gain();
        let sum = below + self.spread_rad;
        let pulled = below * below * gain / sum;
        let (sin_pulled, cos_pulled) = pulled.sin_cos();
        let sin = (self.sin_limb * cos_pulled - self.cos_limb * sin_pulled).max(0.0);
        let cos = self.cos_limb * cos_pulled + self.sin_limb * sin_pulled;
        // sin(η_b + η).
        let sin_sum = (self.sin_limb * cos + self.cos_limb * sin).max(0.0);
        let root = (sin_pulled * sin_sum).max(0.0).sqrt();
        let t = self.cos_limb * self.cos_limb / (cos + root);
        // dθ/dη = (t/L)/root, times the slope of the pull. δ is divided out of both, so that the limb is not a pole.
        let unit = sin_pulled / pulled.max(1e-300) * sin_sum;
        let along = t * gain.sqrt() * (below + 2.0 * self.spread_rad)
            / (sum * sum.sqrt() * unit.max(1e-30).sqrt());
        (
            t * sin / self.sin_limb,
            // cos(i − η) with the incidence i: sin i = sin η / sin η_b, cos i = root / sin η_b.
            (root * cos + sin * sin) / self.sin_limb,
            along,
        )
    }

    /// θ and dθ/dη of a ray that passes the limb, `below` ≤ 0.
    fn behind(&self, below: f64) -> (f64, f64) {
        if self.spread_rad <= 0.0 {
            return (self.far_rad, 1.0);
        }
        let part = (-below / self.spread_rad).min(1.0);
        let width = self.far_rad - self.near_rad;
        (self.near_rad + width * part, width / self.spread_rad)
    }

    /// Keeps nadir in place when rays are pulled towards the limb.
    fn gain(&self) -> f64 {
        1.0 + self.spread_rad / self.limb_rad
    }

    /// The direction, ITRF axes, that [`Self::foot`] maps to the place at `theta` from the eye's radius, towards the level unit vector
    /// `aside` of scaled space. It is the inverse of [`Self::foot`], up to [`Self::far_rad`].
    pub fn direction(&self, theta: f64, aside: DVec3) -> DVec3 {
        let nadir_rad = if theta < self.near_rad {
            let (sin, cos) = theta.sin_cos();
            let cast = (self.sin_limb * sin).atan2(1.0 - self.sin_limb * cos);
            let pulled = (self.limb_rad - cast).max(0.0);
            let gain = self.gain();
            let root = (pulled * (pulled + 4.0 * gain * self.spread_rad)).sqrt();
            self.limb_rad - 0.5 * (pulled + root) / gain
        } else {
            let width = self.far_rad - self.near_rad;
            let part = (theta - self.near_rad) / width.max(1e-300);
            self.limb_rad + self.spread_rad * part.clamp(0.0, 1.0)
        };
        let (sin, cos) = nadir_rad.sin_cos();
        (aside * sin - self.up * cos) * self.radii_m
    }

    /// Two unit vectors perpendicular to the eye's radius, right-handed with it.
    pub fn level_axes(&self) -> (DVec3, DVec3) {
        let first = self.up.any_orthonormal_vector();
        (first, self.up.cross(first))
    }

    /// The point of the grid's plane that maps to the place at `theta` towards `aside`.
    pub fn on_screen(&self, screen: &ScreenPlane, theta: f64, aside: DVec3) -> glam::DVec2 {
        screen.place_of(self.direction(theta, aside))
    }
}
