//! The paper's square that faces the eye and carries the halo.
//!
//! It stands on the line from the eye to the Earth's centre O, at distance L1 from O, where the cone of tangents
//! touches the sphere: L1 = R²/L, L2 = L − L1, side S = 2√(L1·L2). For the air it is enlarged to the tangent cone of
//! the air's upper boundary.

use glam::{DMat4, DVec3, DVec4};

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
/// With L = R + h: L1 = R²/L, L2 = h(L + R)/L and S = 2R√(h(L + R))/L. The printed L2 = L − R²/L cancels near the
/// ground; here every factor is a sum of positive numbers, so all three are good to a few units in the last place.
/// `None` at and below the surface, where there is no horizon circle.
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

/// What part of the screen the air is drawn on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Screen {
    /// The paper's square, enlarged.
    Square,
    /// The whole screen: the eye is so near the air, or in it, that the square would be seen almost edge on.
    Whole,
}

/// The square of one frame, ready for the GPU.
///
/// The *billboard frame* has its origin at the eye and its third axis towards O; lengths are in scaled space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Billboard {
    /// Part of the screen that the air covers.
    pub screen: Screen,
    /// Corners in clip space, triangle-strip order.
    pub clip: [DVec4; 4],
    /// The same corners as vectors from the eye, billboard frame. They vary linearly over the square.
    pub ray: [DVec3; 4],
    /// Distance of the eye from O, scaled space, at least 1: an eye below the surface sees the air from the surface.
    pub eye_distance: f64,
    /// Billboard axes in scaled space: two across, one towards O.
    pub axes: [DVec3; 3],
    /// Takes billboard-frame vectors to clip space.
    pub clip_from_billboard: DMat4,
}

/// Beyond this half angle of the air's cone the square gives way to the whole screen: tan 80°.
const WIDEST_TANGENT: f64 = 5.671;

impl Billboard {
    /// The square for an eye in scaled space, `air_top` being the air's upper boundary there (1 + H/a).
    ///
    /// `clip_from_eye` takes eye-relative ITRF metres to clip space and `itrf_from_scaled` is diag(a, a, b). Defined for
    /// every eye: exactly at the centre the third axis is −x.
    pub fn new(
        eye_scaled: DVec3,
        air_top: f64,
        clip_from_eye: &DMat4,
        itrf_from_scaled: DVec3,
    ) -> Self {
        let toward_center = (-eye_scaled).try_normalize().unwrap_or(DVec3::NEG_X);
        let across = toward_center.any_orthonormal_vector();
        let axes = [across, toward_center.cross(across), toward_center];
        let column = |axis: DVec3| (itrf_from_scaled * axis).extend(0.0);
        let itrf_from_billboard =
            DMat4::from_cols(column(axes[0]), column(axes[1]), column(axes[2]), DVec4::W);
        let clip_from_billboard = *clip_from_eye * itrf_from_billboard;
        let height = eye_scaled.length() - 1.0;
        let eye_distance = 1.0 + height.max(0.0);
        // Half side of the enlarged square: L2·tan α with sin α = R_top/L.
        let square = horizon_square(1.0, height).and_then(|square| {
            let above = eye_distance - air_top;
            let tangent = air_top / (above * (eye_distance + air_top)).sqrt();
            (above > 0.0 && tangent < WIDEST_TANGENT).then_some((square.l2, square.l2 * tangent))
        });
        let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        let (screen, clip, ray) = match square {
            Some((l2, half)) => {
                let ray = corners.map(|(x, y)| DVec3::new(x * half, y * half, l2));
                (
                    Screen::Square,
                    ray.map(|r| clip_from_billboard * r.extend(1.0)),
                    ray,
                )
            }
            None => {
                // Rays through the screen's corners, made equally deep so that they vary linearly over the screen.
                let billboard_from_clip = clip_from_billboard.inverse();
                let clip = corners.map(|(x, y)| DVec4::new(x, y, 0.5, 1.0));
                let ray = clip.map(|c| {
                    let at = billboard_from_clip * c;
                    at.truncate() / at.w
                });
                (Screen::Whole, clip, ray)
            }
        };
        Self {
            screen,
            clip,
            ray,
            eye_distance,
            axes,
            clip_from_billboard,
        }
    }
}
