//! What an eye sees of a ball of ground, and how finely it must be drawn.

use super::page::Info;
use crate::frames::Ellipsoid;
use crate::globe::surface::GroundView;
use glam::{DVec3, DVec4};

/// When a leaf is divided.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Refine {
    /// Where it may be off by more pixels than the view allows: the paper's e_max·λ > d (its formula 1) with
    /// λ = 1 / (pixel_rad · tolerance_px).
    #[default]
    Tolerance,
    /// The same with a λ of its own, whatever the view allows; the paper's table has λ = 300.
    Paper {
        /// λ: metres of distance for a metre of error.
        lambda: f64,
    },
    /// The paper's full form (its formula 2), k·l·L·λ·e_max / (2 tan(α/2)·d·ε) > 1. It is read so that all units cancel:
    /// L / (2 tan(α/2)·d) is a pixel for each metre at d, so l·L / (2 tan(α/2)·d) is the side of the square in pixels, λ·e_max
    /// its error in pixels, and ε the pixels that the view allows. Small squares may then be off by more.
    Full {
        /// k, of one pixel of the square's side.
        k: f64,
    },
}

/// How much of a ball lies in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sight {
    /// All.
    Whole,
    /// Perhaps some.
    Part,
    /// None.
    Outside,
    /// None, and none would be if the eye turned: the Earth is before it.
    Hidden,
}

/// A leaf outside the picture may be off by so much more: the eye may turn to it.
const OUTSIDE: f64 = 0.1;
/// No distance is taken for less, metres.
const LEAST_DISTANCE_M: f64 = 1e-3;

/// The Earth as what hides ground: an ellipsoid inside all that is drawn.
struct Horizon {
    scaled_from_itrf: DVec3,
    eye: DVec3,
    length: f64,
    /// Sine of the Earth's angular radius.
    sine: f64,
    largest: f64,
}

/// An eye and what it asks for.
pub struct Eye {
    itrf_m: DVec3,
    /// Above the ellipsoid, metres.
    height_m: f64,
    planes: [DVec4; 6],
    horizon: Option<Horizon>,
    pixel_rad: f64,
    /// Ratio of the rule is error / distance times this; for the full form, times the side's pixels too.
    factor: f64,
    full: Option<f64>,
    /// Whether anything may be left out.
    is_culled: bool,
}

impl Eye {
    /// An eye over ground that nowhere lies deeper than `lowest_m` below the ellipsoid (a negative height); `None` where
    /// the view is not of numbers.
    pub fn new(
        view: &GroundView,
        rule: Refine,
        ellipsoid: &Ellipsoid,
        lowest_m: f64,
        is_culled: bool,
    ) -> Option<Self> {
        let is_sound = view.eye_itrf_m.is_finite()
            && view.clip_from_eye.is_finite()
            && view.pixel_rad.is_finite()
            && view.pixel_rad > 0.0
            && !view.tolerance_px.is_nan();
        if !is_sound {
            return None;
        }
        let rows = [0, 1, 2, 3].map(|i| view.clip_from_eye.row(i));
        let [x, y, z, w] = rows;
        let planes = [w + x, w - x, w + y, w - y, z, w - z].map(|plane| {
            let length = plane.truncate().length();
            // A plane at infinity cuts nothing off.
            if length > 0.0 {
                plane / length
            } else {
                DVec4::W
            }
        });
        let tolerance_px = view.tolerance_px.max(1e-3);
        let per_px = 1.0 / view.pixel_rad;
        let (factor, full) = match rule {
            Refine::Tolerance => (per_px / tolerance_px, None),
            Refine::Paper { lambda } => (lambda, None),
            Refine::Full { k } => (per_px / tolerance_px, Some(k * per_px)),
        };
        Some(Self {
            itrf_m: view.eye_itrf_m,
            height_m: ellipsoid.geodetic_from_itrf(view.eye_itrf_m).height_m,
            planes,
            horizon: Horizon::new(view.eye_itrf_m, ellipsoid, lowest_m),
            pixel_rad: view.pixel_rad,
            factor,
            full,
            is_culled,
        })
    }

    /// From the eye to what is drawn of a square, metres; at least a millimetre. No nearer than the ball about it, nor than its
    /// highest lies below the eye: a large square's ball may hold an eye that is kilometres above it.
    pub fn distance_m(&self, info: &Info) -> f64 {
        let center_m = info.center_itrf_m.distance(self.itrf_m);
        let above_m = self.height_m - f64::from(info.high_m);
        (center_m - f64::from(info.radius_m))
            .max(above_m)
            .max(LEAST_DISTANCE_M)
    }

    /// How far a leaf is from being fine enough: it is to be divided above 1. `side_m` is the side of its square.
    pub fn ratio(&self, info: &Info, side_m: f64, sight: Sight) -> f64 {
        let distance_m = self.distance_m(info);
        let mut ratio = f64::from(info.error_m) / distance_m * self.factor;
        if let Some(k) = self.full {
            ratio *= k * side_m / distance_m;
        }
        match sight {
            Sight::Whole | Sight::Part => ratio,
            Sight::Outside => ratio * OUTSIDE,
            Sight::Hidden => 0.0,
        }
    }

    /// A leaf's error as it appears, pixels.
    pub fn error_px(&self, info: &Info) -> f64 {
        f64::from(info.error_m) / (self.distance_m(info) * self.pixel_rad)
    }

    /// What is seen of a ball. Never [`Sight::Outside`] nor [`Sight::Hidden`] where a point of it can be seen.
    pub fn sight(&self, info: &Info) -> Sight {
        if !self.is_culled {
            return Sight::Whole;
        }
        let radius_m = f64::from(info.radius_m);
        let from_eye = info.center_itrf_m - self.itrf_m;
        if let Some(horizon) = &self.horizon
            && horizon.hides(from_eye, radius_m)
        {
            return Sight::Hidden;
        }
        let mut sight = Sight::Whole;
        for plane in &self.planes {
            let inside_m = plane.truncate().dot(from_eye) + plane.w;
            if inside_m < -radius_m {
                return Sight::Outside;
            }
            if inside_m < radius_m {
                sight = Sight::Part;
            }
        }
        sight
    }

    /// Whether a patch is drawn: its ball may be seen, and one of its faces, whose normals lie in a cone about an axis, may
    /// face the eye.
    pub fn draws(&self, info: &Info, cone: (DVec3, f64)) -> bool {
        let is_seen = matches!(self.sight(info), Sight::Whole | Sight::Part);
        is_seen && !(self.is_culled && self.faces_away(info, cone))
    }

    /// Whether all faces of a ball whose normals lie in a cone face away.
    fn faces_away(&self, info: &Info, (axis, half_angle): (DVec3, f64)) -> bool {
        let to_eye = self.itrf_m - info.center_itrf_m;
        let (distance_m, radius_m) = (to_eye.length(), f64::from(info.radius_m));
        if distance_m <= radius_m {
            return false;
        }
        let angle = (to_eye.dot(axis) / distance_m).clamp(-1.0, 1.0).acos();
        // Every face away: normal · (eye − point) < 0, for the least tilted normal and the point most in favour.
        let slack = half_angle + (radius_m / distance_m).asin();
        angle - slack > 0.5 * std::f64::consts::PI + 1e-6
    }
}

impl Horizon {
    fn new(eye_itrf_m: DVec3, ellipsoid: &Ellipsoid, lowest_m: f64) -> Option<Self> {
        // An ellipsoid with shorter axes lies within the surface at that depth but for some metres at most.
        let depth_m = lowest_m.min(0.0) * 1.01 - 50.0;
        let axes = ellipsoid.itrf_from_scaled() + DVec3::splat(depth_m);
        let scaled_from_itrf = axes.recip();
        let eye = eye_itrf_m * scaled_from_itrf;
        let length = eye.length();
        // An error as large as the Earth leaves nothing that hides.
        let is_solid = axes.min_element() > 1e6;
        (is_solid && length > 1.0).then(|| Self {
            scaled_from_itrf,
            eye,
            length,
            sine: 1.0 / length,
            largest: scaled_from_itrf.max_element(),
        })
    }

    /// The ball lies wholly in the shadow of the Earth: beyond the plane of the limb, and within the cone to the limb.
    fn hides(&self, from_eye_m: DVec3, radius_m: f64) -> bool {
        let (to_ball, radius) = (from_eye_m * self.scaled_from_itrf, radius_m * self.largest);
        let inwards = -to_ball.dot(self.eye) / self.length;
        let distance = to_ball.length();
        let to_limb_plane = self.length - self.sine;
        if inwards - radius <= to_limb_plane || radius >= distance {
            return false;
        }
        // angle to the ball's middle + the ball's < the Earth's
        let angle = (inwards / distance).clamp(-1.0, 1.0).acos() + (radius / distance).asin();
        angle < self.sine.asin()
    }
}
