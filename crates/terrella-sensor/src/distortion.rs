//! Lens distortion: maps a ray to the image plane, and a point of that plane to its ray.
//!
//! Both models map x = X/Z and y = Y/Z of a direction (x right, y down, z ahead) to distorted coordinates in the plane at unit focal length.
//! Coefficients are in OpenCV's order.

use glam::{DMat2, DVec2};

/// A model of distortion with its coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distortion {
    /// k1, k2, p1, p2, k3, k4, k5, k6; those not used are 0. Brown 1966, with the rational radial term of OpenCV's `projectPoints`.
    BrownConrady([f64; 8]),
    /// k1, k2, k3, k4 of Kannala and Brandt 2006, as in OpenCV's `fisheye::projectPoints`.
    Fisheye([f64; 4]),
}

/// Most Newton steps to an inverse. From a start on the radial curve five are usual.
const NEWTON_STEPS: usize = 40;
/// Residual of an inverse, in the unit of the plane: 1e-7 pixels at a focal length of 100 000 pixels.
const RESIDUAL: f64 = 1e-12;

impl Distortion {
    /// No distortion.
    pub const NONE: Self = Self::BrownConrady([0.0; 8]);

    /// The same with all coefficients multiplied.
    pub fn scaled(&self, scale: f64) -> Self {
        match self {
            Self::BrownConrady(k) => Self::BrownConrady(k.map(|k| k * scale)),
            Self::Fisheye(k) => Self::Fisheye(k.map(|k| k * scale)),
        }
    }

    /// The radial factor g and its derivative by s = r².
    fn radial(&self, s: f64) -> (f64, f64) {
        match *self {
            // g = (1 + k1 s + k2 s² + k3 s³) / (1 + k4 s + k5 s² + k6 s³)
            Self::BrownConrady([k1, k2, _, _, k3, k4, k5, k6]) => {
                let over = 1.0 + s * (k1 + s * (k2 + s * k3));
                let under = 1.0 + s * (k4 + s * (k5 + s * k6));
                let d_over = k1 + s * (2.0 * k2 + s * 3.0 * k3);
                let d_under = k4 + s * (2.0 * k5 + s * 3.0 * k6);
                let g = over / under;
                (g, (d_over - g * d_under) / under)
            }
            // g = θ_d / r, θ = atan r, θ_d = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸)
            Self::Fisheye([k1, k2, k3, k4]) => {
                // θ/r = 1 − s/3 + …: below this, rounding of the quotient outweighs the next term.
                if s < 1e-10 {
                    return (1.0 + (k1 - 1.0 / 3.0) * s, k1 - 1.0 / 3.0);
                }
                let r = s.sqrt();
                let theta = r.atan();
                let t = theta * theta;
                let distorted = theta * (1.0 + t * (k1 + t * (k2 + t * (k3 + t * k4))));
                let slope = 1.0 + t * (3.0 * k1 + t * (5.0 * k2 + t * (7.0 * k3 + t * 9.0 * k4)));
                let by_r = slope / (1.0 + s);
                (distorted / r, (by_r - distorted / r) / (2.0 * s))
            }
        }
    }

    fn tangential(&self) -> [f64; 2] {
        match *self {
            Self::BrownConrady([_, _, p1, p2, ..]) => [p1, p2],
            Self::Fisheye(_) => [0.0; 2],
        }
    }

    /// The distorted point of an undistorted one.
    pub fn distort(&self, point: DVec2) -> DVec2 {
        let [p1, p2] = self.tangential();
        let DVec2 { x, y } = point;
        let s = point.length_squared();
        let (g, _) = self.radial(s);
        // x' = x g + 2 p1 x y + p2 (r² + 2 x²),  y' = y g + p1 (r² + 2 y²) + 2 p2 x y
        DVec2::new(
            x * g + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x),
            y * g + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y,
        )
    }

    /// The derivative of [`Self::distort`].
    pub fn jacobian(&self, point: DVec2) -> DMat2 {
        let [p1, p2] = self.tangential();
        let DVec2 { x, y } = point;
        let (g, dg) = self.radial(point.length_squared());
        let across = 2.0 * x * y * dg + 2.0 * p1 * x + 2.0 * p2 * y;
        DMat2::from_cols(
            DVec2::new(g + 2.0 * x * x * dg + 2.0 * p1 * y + 6.0 * p2 * x, across),
            DVec2::new(across, g + 2.0 * y * y * dg + 6.0 * p1 * y + 2.0 * p2 * x),
        )
    }

    /// Undistorted and distorted distance from the axis up to which the radial curve increases: at most to `distorted`, or as far as the curve can
    /// be followed.
    pub(crate) fn rising(&self, distorted: f64, farthest: f64) -> (f64, f64) {
        /// Number of steps to `distorted` without distortion.
        const STEPS: f64 = 1024.0;
        let step = distorted.max(1e-9) / STEPS;
        let (mut r, mut at) = (0.0, 0.0);
        while at < distorted && r < farthest {
            let next = r + step;
            let s = next * next;
            let (g, dg) = self.radial(s);
            let value = next * g;
            if !(value > at && g + 2.0 * s * dg > 0.0) {
                break;
            }
            (r, at) = (next, value);
        }
        (r, at)
    }

    /// The undistorted point of a distorted one, on the branch that contains the axis; `reach` is the undistorted distance up to which the radial
    /// curve increases. `None` if no point of that branch is found.
    ///
    /// A result has a residual below 1e-12 and a positive Jacobian determinant, however it was found.
    pub fn undistort(&self, distorted: DVec2, reach: f64) -> Option<DVec2> {
        let length = distorted.length();
        if length == 0.0 && self.tangential() == [0.0; 2] {
            return Some(DVec2::ZERO);
        }
        let mut point = match length > 0.0 {
            true => distorted * (self.undistorted_radius(length, reach) / length),
            false => DVec2::ZERO,
        };
        let mut residual = self.distort(point) - distorted;
        for _ in 0..NEWTON_STEPS {
            if residual.length() <= 0.01 * RESIDUAL {
                break;
            }
            let step = self.jacobian(point).inverse() * residual;
            let (mut part, before) = (1.0, residual.length());
            // Halved until the residual falls: Newton's method then cannot leave the branch by one long step.
            loop {
                let next = point - part * step;
                let left = self.distort(next) - distorted;
                if left.length() < before && self.jacobian(next).determinant() > 0.0 {
                    (point, residual) = (next, left);
                    break;
                }
                part *= 0.5;
                if part < 1e-4 {
                    break;
                }
            }
            if part < 1e-4 {
                break;
            }
        }
        let is_found = residual.length() <= RESIDUAL
            && self.jacobian(point).determinant() > 0.0
            && point.length() <= reach * 1.5 + 1e-9;
        is_found.then_some(point)
    }

    /// r of r g(r²) = `distorted`, by bisection on the part that rises and Newton steps that stay inside the bracket.
    fn undistorted_radius(&self, distorted: f64, reach: f64) -> f64 {
        let (mut low, mut high) = (0.0, reach);
        let mut r = distorted.min(reach);
        for _ in 0..60 {
            let s = r * r;
            let (g, dg) = self.radial(s);
            let off = r * g - distorted;
            match off > 0.0 {
                true => high = r,
                false => low = r,
            }
            if off.abs() <= RESIDUAL {
                break;
            }
            let next = r - off / (g + 2.0 * s * dg);
            r = match next > low && next < high {
                true => next,
                false => 0.5 * (low + high),
            };
        }
        r
    }
}
