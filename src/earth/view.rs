//! The eye: its position, its view, the viewport on the host's target, and the projection to reversed depth.

use crate::plan::FrameUniforms;
use bytemuck::Zeroable;
use glam::DVec2;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3, DVec4};
use terrella_frames::Ellipsoid;

/// A view that cannot be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ViewError {
    /// Numbers out of range.
    #[error(
        "the view has a number that is not finite or leaves the range of f32, or its eye is beyond 1e24 m"
    )]
    NotFinite,
    /// Another projection, such as an orthographic one.
    #[error(
        "clip_from_view is no perspective projection: the rows of x and y may scale and shift, and that of w must be 0, 0, -1, 0"
    )]
    Projection,
    /// A projection that mirrors.
    #[error(
        "clip_from_view mirrors the image: its scales of x and y must be positive; mirror the finished image instead"
    )]
    Mirrored,
    /// A world that is distorted or mirrored.
    #[error(
        "itrf_from_world must be a rotation with one scale and no mirror; a left-handed program negates one axis of its positions first"
    )]
    World,
}

/// The eye's position and view, in the host's world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyeView {
    /// Position of the eye in the host's world and unit.
    pub eye_world: DVec3,
    /// Rotation from world axes to view axes: x right, y up, −z forward.
    pub view_from_world: DQuat,
    /// The host's perspective projection from view space (host's unit) to wgpu clip space, z in 0…1; off-centre too, reversed or not.
    pub clip_from_view: DMat4,
    /// Transform from the host's world to ITRF metres: a rotation, a uniform scale and a translation.
    pub itrf_from_world: DAffine3,
}

impl EyeView {
    /// An eye in ITRF metres that looks along `forward` with `up` upwards on screen; infinite reversed-Z projection.
    ///
    /// `fov_y_rad` is the vertical field of view, `aspect` width over height. Defined for every direction: a zero
    /// `forward` looks down, an `up` along `forward` is replaced by any direction across it.
    pub fn itrf(eye_itrf_m: DVec3, forward: DVec3, up: DVec3, fov_y_rad: f64, aspect: f64) -> Self {
        let down = (-eye_itrf_m).normalize_or(DVec3::NEG_Z);
        let forward = forward.normalize_or(down);
        let right = forward
            .cross(up)
            .try_normalize()
            .unwrap_or_else(|| forward.any_orthonormal_vector());
        let world_from_view = DMat3::from_cols(right, right.cross(forward), -forward);
        Self {
            eye_world: eye_itrf_m,
            view_from_world: DQuat::from_mat3(&world_from_view).inverse(),
            clip_from_view: infinite_reversed_z(fov_y_rad, aspect, Self::NEAR_M),
            itrf_from_world: DAffine3::IDENTITY,
        }
    }

    /// Near plane of [`Self::itrf`], metres.
    pub const NEAR_M: f64 = 0.1;

    /// Whether the view can be drawn: [`Earth::prepare`](crate::Earth::prepare) draws nothing of one that cannot.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn check(&self) -> Result<(), ViewError> {
        self.in_itrf(Viewport::from((1, 1))).map(|_| ())
    }

    /// Checks the projection and the world, as far as their numbers are finite.
    fn check_transforms(&self) -> Result<(), ViewError> {
        let (p, world) = (&self.clip_from_view, &self.itrf_from_world);
        let is_finite = self.eye_world.is_finite()
            && self.view_from_world.is_finite()
            && p.is_finite()
            && world.is_finite();
        if !is_finite {
            return Err(ViewError::NotFinite);
        }
        let zeros = [p.x_axis.y, p.x_axis.w, p.y_axis.x, p.y_axis.w]
            .into_iter()
            .chain([p.z_axis.w + 1.0, p.w_axis.x, p.w_axis.y, p.w_axis.w]);
        if zeros.into_iter().any(|zero| zero.abs() > 1e-6) {
            return Err(ViewError::Projection);
        }
        if p.x_axis.x < 0.0 || p.y_axis.y < 0.0 {
            return Err(ViewError::Mirrored);
        }
        let axes = world.matrix3;
        let scale = axes.x_axis.length();
        let skew = axes.transpose() * axes - DMat3::from_diagonal(DVec3::splat(scale * scale));
        let is_skew = skew
            .abs()
            .to_cols_array()
            .iter()
            .any(|part| *part > 1e-3 * scale * scale);
        match is_skew || axes.determinant() <= 0.0 {
            true => Err(ViewError::World),
            false => Ok(()),
        }
    }

    /// The eye in ITRF metres, and the matrix from eye-relative ITRF metres to clip space.
    pub fn to_itrf(&self) -> (DVec3, DMat4) {
        let eye_itrf_m = self.itrf_from_world.transform_point3(self.eye_world);
        let world_from_itrf = self.itrf_from_world.matrix3.inverse();
        let view_from_itrf = DMat3::from_quat(self.view_from_world) * world_from_itrf;
        (
            eye_itrf_m,
            self.clip_from_view * DMat4::from_mat3(view_from_itrf),
        )
    }

    /// The view as it is drawn to a target.
    pub(crate) fn in_itrf(&self, target: Viewport) -> Result<ItrfView, ViewError> {
        self.check_transforms()?;
        let (eye_itrf_m, clip_from_eye) = self.to_itrf();
        let rays = self.pixel_rays(target);
        let (x, y) = (f64::from(target.origin.0), f64::from(target.origin.1));
        let (width, height) = (
            f64::from(target.size.0.max(1)),
            f64::from(target.size.1.max(1)),
        );
        let view = ItrfView {
            eye_itrf_m,
            clip_from_eye,
            rays,
            picture: PixelRays {
                corner: rays.corner + rays.right * x + rays.down * y,
                right: rays.right * width,
                down: rays.down * height,
            },
        };
        // It maps the world to a line or a point, and a pixel's ray is undefined.
        if clip_from_eye.determinant() == 0.0 {
            return Err(ViewError::Projection);
        }
        match view.is_in_range() {
            true => Ok(view),
            false => Err(ViewError::NotFinite),
        }
    }

    /// The rays of a target's pixels, ITRF axes.
    pub fn pixel_rays(&self, viewport: Viewport) -> PixelRays {
        let itrf_from_view =
            self.itrf_from_world.matrix3 * DMat3::from_quat(self.view_from_world.inverse());
        let axes = [
            itrf_from_view.x_axis,
            itrf_from_view.y_axis,
            itrf_from_view.z_axis,
        ]
        .map(DVec3::normalize_or_zero);
        let p = &self.clip_from_view;
        let (width, height) = (
            f64::from(viewport.size.0.max(1)),
            f64::from(viewport.size.1.max(1)),
        );
        let right = axes[0] * (2.0 / (p.x_axis.x * width));
        let down = axes[1] * (-2.0 / (p.y_axis.y * height));
        // Upper left: x_clip = −w, y_clip = w at one unit ahead; the third column shifts an off-centre projection.
        let upper_left = axes[0] * ((p.z_axis.x - 1.0) / p.x_axis.x)
            + axes[1] * ((p.z_axis.y + 1.0) / p.y_axis.y)
            - axes[2];
        let (x, y) = (f64::from(viewport.origin.0), f64::from(viewport.origin.1));
        PixelRays {
            corner: upper_left - right * x - down * y,
            right,
            down,
        }
    }
}

/// The part of the target that the host's pass draws to, pixels. A size alone is a viewport at the corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewport {
    /// Upper left corner, as given to `set_viewport`.
    pub origin: (f32, f32),
    /// Width and height.
    pub size: (u32, u32),
}

impl From<(u32, u32)> for Viewport {
    fn from(size: (u32, u32)) -> Self {
        Self {
            origin: (0.0, 0.0),
            size,
        }
    }
}

/// Rays on the plane one unit in front of the eye, ITRF axes.
#[derive(Clone, Copy, Debug)]
pub struct PixelRays {
    /// Through the upper left corner of pixel (0, 0).
    pub corner: DVec3,
    /// Increment to the next pixel right.
    pub right: DVec3,
    /// Increment to the next pixel down.
    pub down: DVec3,
}

impl PixelRays {
    /// Rays through the corners of the first pixel.
    fn corners(&self) -> [DVec3; 4] {
        let Self {
            corner,
            right,
            down,
        } = *self;
        [corner, corner + right, corner + down, corner + right + down]
    }

    /// Whether all are finite in f32.
    fn are_finite(&self) -> bool {
        [self.corner, self.right, self.down]
            .iter()
            .all(|ray| ray.as_vec3().is_finite())
    }
}

/// Farthest eye that the Earth is drawn for, metres: beyond it squares of lengths in Earth radii leave the range of f32.
const FARTHEST_M: f64 = 1e24;

/// A view that has an image, in ITRF axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ItrfView {
    pub eye_itrf_m: DVec3,
    /// Transform from eye-relative metres to clip space.
    pub clip_from_eye: DMat4,
    /// The rays of the target's pixels.
    pub rays: PixelRays,
    /// The rays of the whole image as one pixel.
    pub picture: PixelRays,
}

impl ItrfView {
    /// Angular size of a pixel in the middle of the image.
    pub fn pixel_rad(&self) -> f64 {
        self.rays.down.length()
    }

    /// Lower bound of the size of a pixel, the larger one of its sides, on a surface at distance 1 or farther.
    ///
    /// Let a pixel at the angle θ from the axis, at (x, y) of the plane one metre in front, show the distance r. To the next pixel, p farther right,
    /// the surface moves by D with |D_x − x D_z| = p r cos θ, so that |D| ≥ p r cos θ/√(1 + x²); the same applies downwards. Of x² and y² the
    /// smaller one is at most tan²θ/2. The margin is for geodetic latitudes.
    pub fn least_pixel_rad(&self) -> f64 {
        const MARGIN: f64 = 0.99;
        let corners = self.picture.corners().map(DVec3::length_squared);
        let square = corners.into_iter().fold(1.0, f64::max);
        let pixel = self.rays.right.length().min(self.rays.down.length());
        MARGIN * pixel / (square * (1.0 + 0.5 * (square - 1.0))).sqrt()
    }

    /// Uniforms of the view, without light: Sun, exposure and the air below the eye are zero.
    pub fn uniforms(&self, ellipsoid: &Ellipsoid) -> FrameUniforms {
        let eye_scaled = self.eye_itrf_m / ellipsoid.itrf_from_scaled();
        let distance = eye_scaled.length();
        FrameUniforms {
            clip_from_eye: self.clip_from_eye.as_mat4(),
            eye_scaled: eye_scaled.as_vec3(),
            above: ((distance - 1.0) * (distance + 1.0)) as f32,
            radius_m: ellipsoid.equatorial_radius_m as f32,
            corner_ray: self.rays.corner.as_vec3(),
            polar_stretch: (ellipsoid.equatorial_radius_m / ellipsoid.polar_radius_m) as f32,
            pixel_right: self.rays.right.as_vec3(),
            pixel_down: self.rays.down.as_vec3(),
            ..FrameUniforms::zeroed()
        }
    }

    /// Whether a part of the image may be beside the ground. The ground's outline is convex: an image whose corners show ground shows nothing else.
    pub fn may_see_limb(&self, ellipsoid: &Ellipsoid) -> bool {
        let scale = ellipsoid.itrf_from_scaled();
        let eye = self.eye_itrf_m / scale;
        let above = (eye.length() - 1.0) * (eye.length() + 1.0);
        !self.picture.corners().into_iter().all(|ray| {
            let ray = ray / scale;
            let along = eye.dot(ray);
            along < 0.0 && along * along >= above * ray.length_squared()
        })
    }

    /// Whether its numbers are in the range that shaders can use.
    fn is_in_range(&self) -> bool {
        // A comparison with NaN is false.
        self.eye_itrf_m.length() < FARTHEST_M
            && self.clip_from_eye.as_mat4().is_finite()
            && self.rays.are_finite()
    }
}

/// Bounds on screen of a ball, given by its centre relative to the eye: least x and y, greatest x and y, −1…1; `None` if it is off screen.
pub(crate) fn ball_bounds(
    clip_from_eye: &DMat4,
    center_from_eye_m: DVec3,
    radius_m: f64,
) -> Option<[f32; 4]> {
    let corners = (0..8).map(|k| {
        let side = |bit: u32| match k >> bit & 1 {
            1 => radius_m,
            _ => -radius_m,
        };
        let corner = DVec3::new(side(0), side(1), side(2));
        *clip_from_eye * (center_from_eye_m + corner).extend(1.0)
    });
    let behind = corners.clone().filter(|clip| clip.w <= 0.0).count();
    if behind > 0 {
        return (behind < 8).then_some([-1.0, -1.0, 1.0, 1.0]);
    }
    let (mut least, mut greatest) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for clip in corners {
        let at = DVec2::new(clip.x, clip.y) / clip.w;
        (least, greatest) = (least.min(at), greatest.max(at));
    }
    let on_screen = |at: DVec2| at.clamp(DVec2::NEG_ONE, DVec2::ONE).as_vec2();
    let (least, greatest) = (on_screen(least), on_screen(greatest));
    let is_seen = least.x < greatest.x && least.y < greatest.y;
    is_seen.then_some([least.x, least.y, greatest.x, greatest.y])
}

/// Perspective projection to wgpu clip space with reversed depth (reversed Z): the near plane at 1 and infinity at 0.
pub fn infinite_reversed_z(fov_y_rad: f64, aspect: f64, near: f64) -> DMat4 {
    let f = 1.0 / (0.5 * fov_y_rad).tan();
    DMat4::from_cols(
        DVec4::new(f / aspect, 0.0, 0.0, 0.0),
        DVec4::new(0.0, f, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 0.0, -1.0),
        DVec4::new(0.0, 0.0, near, 0.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS_M: f64 = 6_378_137.0;

    /// Where a ray meets a sphere of this radius.
    fn hit(eye: DVec3, ray: DVec3) -> Option<DVec3> {
        let ray = ray.normalize();
        let along = eye.dot(ray);
        let root = along * along - eye.length_squared() + RADIUS_M * RADIUS_M;
        (root > 0.0 && along < 0.0).then(|| eye - (along + root.sqrt()) * ray)
    }

    #[test]
    fn no_pixel_on_the_ground_is_smaller_than_the_bound() {
        let (mut seen, mut closest) = (0, f64::INFINITY);
        for (height_m, fov_deg, tilt_deg) in [4e5, 8e6, 4e7].into_iter().flat_map(|height_m| {
            let fovs = [10.0, 45.0, 110.0].into_iter();
            fovs.flat_map(move |fov| [0.0, 15.0, 50.0].map(|tilt| (height_m, fov, tilt)))
        }) {
            let eye = DVec3::X * (RADIUS_M + height_m);
            let (sin, cos) = f64::to_radians(tilt_deg).sin_cos();
            let forward = DVec3::new(-cos, 0.6 * sin, 0.8 * sin);
            let view = EyeView::itrf(eye, forward, DVec3::Z, f64::to_radians(fov_deg), 16.0 / 9.0);
            let view = view.in_itrf(Viewport::from((64, 36))).expect("a view");
            let least_m = view.least_pixel_rad() * height_m;
            let PixelRays {
                corner,
                right,
                down,
            } = view.rays;
            for (x, y) in (0..63).flat_map(|x| (0..35).map(move |y| (x, y))) {
                let ray = corner + (f64::from(x) + 0.5) * right + (f64::from(y) + 0.5) * down;
                let places = [ray, ray + right, ray + down].map(|ray| hit(eye, ray));
                if let [Some(at), Some(east), Some(south)] = places {
                    let pixel_m = at.distance(east).max(at.distance(south));
                    assert!(
                        pixel_m >= least_m,
                        "{height_m} {fov_deg} {tilt_deg}: {pixel_m}"
                    );
                    closest = closest.min(pixel_m / least_m);
                    seen += 1;
                }
            }
        }
        assert!(seen > 10_000 && closest < 1.1, "{seen} {closest}");
    }
}
