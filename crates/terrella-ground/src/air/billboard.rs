//! The paper's eye-facing square, and the ring that replaces it and carries the halo.
//!
//! The square is centred on the line from the eye to the Earth's centre O, at distance L1 from O. There the tangent cone touches the sphere: L1 =
//! R²/L, L2 = L − L1, side S = 2√(L1·L2). The inscribed circle of the square is the limb. The ground inside it is drawn with its own atmosphere, so
//! only a ring of the enlarged square remains. The ring reaches from just inside the limb to the tangent cone of the atmosphere's upper boundary. It
//! is drawn where rays leave the atmosphere. All ground is therefore in front of it, and objects behind the Earth are behind it. For an eye inside
//! the atmosphere, the ring covers the whole sky.

use glam::{DMat4, DVec3, DVec4};
use std::f64::consts::{PI, TAU};

/// The paper's three lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HorizonSquare {
    /// Distance of the square from O.
    pub l1: f64,
    /// Distance of the square from the eye.
    pub l2: f64,
    /// Side of the square: the horizon circle's diameter.
    pub side: f64,
}

/// L1, L2 and S for a sphere of radius `radius` and an eye at `height` above it, in the unit of both.
///
/// With L = R + h: L1 = R²/L, L2 = h(L + R)/L and S = 2R√(h(L + R))/L. The paper's L2 = L − R²/L loses digits near
/// the ground. Here every factor is a sum of positive numbers, so all three are accurate to a few units in the
/// last place. `None` at and below the surface, where no horizon circle exists.
pub fn horizon_square(radius: f64, height: f64) -> Option<HorizonSquare> {
    if !(radius > 0.0 && height > 0.0 && height.is_finite()) {
        return None;
    }
    let l = radius + height;
    let tangent = height.sqrt() * (l + radius).sqrt();
    Some(HorizonSquare {
        l1: radius * (radius / l),
        l2: height * ((l + radius) / l),
        side: 2.0 * radius * (tangent / l),
    })
}

/// Vertices on each circle of the ring.
const AROUND: usize = 64;
/// Circles of the ring for an eye inside the atmosphere.
const CIRCLES: usize = 7;
/// Angles of the circles above the limb, except the first and the last, radians.
const SKY_RAD: [f64; CIRCLES - 2] = [0.03, 0.1, 0.25, 0.5, 1.0];
/// Smallest distance from the eye to a ring vertex, radii. For an eye at the top of the atmosphere, rays leave
/// it at once.
const NEAREST: f64 = 0.005;

/// The ring of one frame, ready for the GPU.
///
/// The *billboard frame* has its origin at the eye and its third axis towards O; lengths are in scaled space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Billboard {
    /// Distance of the eye from O, scaled space, at least 1. An eye below the surface sees the atmosphere as from
    /// the surface.
    pub eye_distance: f64,
    /// Billboard axes in scaled space: two across, one towards O.
    pub axes: [DVec3; 3],
    /// Transforms billboard-frame vectors to clip space.
    pub clip_from_billboard: DMat4,
    air_top: f64,
    /// Angles at the eye between O and the circles of the ring, innermost first.
    circles_rad: [f64; CIRCLES],
    circle_count: usize,
}

/// A vertex of the ring's triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingVertex {
    /// Position in clip space.
    pub clip: DVec4,
    /// Vector from the eye, billboard frame.
    pub ray: DVec3,
}

impl Billboard {
    /// Maximum vertex count of a ring.
    pub const MAX_VERTICES: usize = AROUND * CIRCLES;

    /// The ring for an eye in scaled space. `air_top` is the upper boundary of the atmosphere there (1 + H/a).
    ///
    /// The ring begins where rays pass at 1 − `inside` from O. Choose `inside` as the distance by which the drawn ground may end short of the limb.
    /// `clip_from_eye` transforms eye-relative ITRF metres to clip space, and `itrf_from_scaled` is diag(a, a, b). Defined for every eye: exactly at
    /// the centre the third axis is −x.
    pub fn new(
        eye_scaled: DVec3,
        air_top: f64,
        inside: f64,
        clip_from_eye: &DMat4,
        itrf_from_scaled: DVec3,
    ) -> Self {
        let toward_center = (-eye_scaled).try_normalize().unwrap_or(DVec3::NEG_X);
        let across = toward_center.any_orthonormal_vector();
        let axes = [across, toward_center.cross(across), toward_center];
        let column = |axis: DVec3| (itrf_from_scaled * axis).extend(0.0);
        let itrf_from_billboard =
            DMat4::from_cols(column(axes[0]), column(axes[1]), column(axes[2]), DVec4::W);
        let eye_distance = 1.0 + (eye_scaled.length() - 1.0).max(0.0);
        let inner = ((1.0 - inside) / eye_distance).asin();
        let mut circles_rad = [inner; CIRCLES];
        let circle_count = if eye_distance > air_top {
            // The chords of the outer circle stay outside the atmosphere.
            let outer = (air_top / eye_distance).asin();
            circles_rad[1] = (outer.tan() / (PI / AROUND as f64).cos()).atan();
            2
        } else {
            let limb = (1.0 / eye_distance).asin();
            for (circle, above) in circles_rad[1..].iter_mut().zip(SKY_RAD) {
                *circle = limb + above;
            }
            circles_rad[CIRCLES - 1] = PI;
            CIRCLES
        };
        Self {
            eye_distance,
            axes,
            clip_from_billboard: *clip_from_eye * itrf_from_billboard,
            air_top,
            circles_rad,
            circle_count,
        }
    }

    /// Whether the eye is inside the atmosphere.
    pub fn is_inside(&self) -> bool {
        self.eye_distance <= self.air_top
    }

    /// Sine and cosine of the angle at the eye between O and the limb.
    pub fn limb(&self) -> (f64, f64) {
        // The square is L2 away, and half its side is the radius of the limb circle. On the surface the limb
        // is level.
        let sine = 1.0 / self.eye_distance;
        let square = horizon_square(1.0, self.eye_distance - 1.0);
        (sine, square.map_or(0.0, |s| s.l2 / (0.5 * s.side) * sine))
    }

    /// Vertices of the ring, circle by circle.
    pub fn vertices(&self) -> impl Iterator<Item = RingVertex> + '_ {
        self.circles_rad[..self.circle_count]
            .iter()
            .flat_map(move |angle| (0..AROUND).map(move |k| self.vertex(*angle, k)))
    }

    fn vertex(&self, angle_rad: f64, k: usize) -> RingVertex {
        let (sin, cos) = angle_rad.sin_cos();
        let (turn_sin, turn_cos) = (TAU * k as f64 / AROUND as f64).sin_cos();
        // The point where the ray leaves the atmosphere, or passes nearest to it if it misses it.
        let (q, along) = (self.eye_distance * sin, self.eye_distance * cos);
        let leaves = along + ((self.air_top - q) * (self.air_top + q)).max(0.0).sqrt();
        let ray = DVec3::new(sin * turn_cos, sin * turn_sin, cos) * leaves.max(NEAREST);
        let mut clip = self.clip_from_billboard * ray.extend(1.0);
        // A far plane in front of the ring must not clip it.
        if clip.w > 0.0 {
            clip.z = clip.z.clamp(0.0, clip.w);
        }
        RingVertex { clip, ray }
    }

    /// Triangle count of the ring: it uses the first triangles of [`Self::indices`].
    pub fn triangles(&self) -> u32 {
        (2 * AROUND * (self.circle_count - 1)) as u32
    }

    /// Triangle indices of the largest ring, innermost circles first.
    pub fn indices() -> Vec<u16> {
        let quad = |band: usize, k: usize| {
            let next = (k + 1) % AROUND;
            let [a, b] = [k, next].map(|k| band * AROUND + k);
            [a, b, a + AROUND, a + AROUND, b, b + AROUND].map(|n| n as u16)
        };
        (0..CIRCLES - 1)
            .flat_map(|band| (0..AROUND).flat_map(move |k| quad(band, k)))
            .collect()
    }
}
