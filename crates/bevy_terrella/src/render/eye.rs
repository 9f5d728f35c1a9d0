//! Converts a Bevy camera to the library's view.

use crate::{EarthFault, EarthFrame};
use bevy::camera::MainPassResolutionOverride;
use bevy::math::{DMat4, Vec3, Vec4Swizzles};
use bevy::render::camera::TemporalJitter;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::ExtractedView;
use terrella::{EyeView, Viewport};

/// The smallest and the largest axis scale of a transform may differ only by rounding.
const SCALE_TOLERANCE: f32 = 1e-4;

/// The view, and the part of the target that it covers.
///
/// # Errors
/// Cameras without a defined image.
pub(super) fn eye(
    view: &ExtractedView,
    jitter: Option<&TemporalJitter>,
    resolution: Option<&MainPassResolutionOverride>,
    frame: &EarthFrame,
) -> Result<(EyeView, Viewport), EarthFault> {
    check_format(view.target_format)?;
    let mut clip_from_view = view.clip_from_view;
    if let Some(jitter) = jitter {
        jitter.jitter_projection(&mut clip_from_view, view.viewport.zw().as_vec2());
    }
    let mut clip_from_view = clip_from_view.as_dmat4();
    if !is_perspective(&clip_from_view) {
        return Err(EarthFault::Projection);
    }
    let (scale, rotation, eye) = view.world_from_view.to_scale_rotation_translation();
    // The view's unit is `scale` units of the world. s · P · diag(1/s, 1/s, 1/s, 1) draws in the world's unit with the same depths.
    clip_from_view.w_axis *= f64::from(uniform(scale)?);
    let size = resolution.map_or(view.viewport.zw(), |size| **size);
    Ok((
        EyeView {
            eye_world: eye.as_dvec3(),
            view_from_world: rotation.inverse().as_dquat().normalize(),
            clip_from_view,
            itrf_from_world: frame.itrf_from_world,
        },
        Viewport {
            origin: (view.viewport.x as f32, view.viewport.y as f32),
            size: (size.x, size.y),
        },
    ))
}

/// Eight-bit light needs an encoding: Bevy writes linear values to formats without one.
fn check_format(format: TextureFormat) -> Result<(), EarthFault> {
    let is_float = matches!(
        format,
        TextureFormat::Rgba16Float | TextureFormat::Rgba32Float | TextureFormat::Rg11b10Ufloat
    );
    match is_float || format.is_srgb() {
        true => Ok(()),
        false => Err(EarthFault::Format(format)),
    }
}

/// Whether the projection is a perspective: sizes at depth d scale by 1/d, so w = −z.
fn is_perspective(clip_from_view: &DMat4) -> bool {
    let w = clip_from_view.row(3);
    w.x == 0.0 && w.y == 0.0 && w.z == -1.0 && w.w == 0.0
}

/// The common scale of all three axes.
fn uniform(scale: Vec3) -> Result<f32, EarthFault> {
    let (least, greatest) = (scale.min_element(), scale.max_element());
    if least > 0.0 && greatest - least <= SCALE_TOLERANCE * greatest {
        Ok(greatest)
    } else {
        Err(EarthFault::Transform)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::{Mat4, Quat, UVec4};
    use bevy::render::sync_world::MainEntity;
    use bevy::render::view::{ColorGrading, RetainedViewEntity};
    use bevy::transform::components::{GlobalTransform, Transform};

    fn view(transform: Transform, clip_from_view: Mat4) -> ExtractedView {
        let entity = MainEntity::from(bevy::ecs::entity::Entity::PLACEHOLDER);
        ExtractedView {
            retained_view_entity: RetainedViewEntity::new(entity, None, 0),
            clip_from_view,
            world_from_view: GlobalTransform::from(transform),
            clip_from_world: None,
            target_format: TextureFormat::Rgba16Float,
            viewport: UVec4::new(20, 10, 320, 180),
            color_grading: ColorGrading::default(),
            invert_culling: false,
        }
    }

    fn perspective() -> Mat4 {
        Mat4::from_cols_array_2d(&[
            [1.2, 0.0, 0.0, 0.0],
            [0.0, 2.1, 0.0, 0.0],
            [0.1, -0.2, 0.0, -1.0],
            [0.0, 0.0, 0.1, 0.0],
        ])
    }

    #[test]
    fn points_come_out_where_bevy_has_them_in_scaled_views_too() {
        for scale in [1.0, 0.01, 7.5] {
            let transform = Transform {
                translation: Vec3::new(3.0, -2.0, 5.0),
                rotation: Quat::from_euler(bevy::math::EulerRot::XYZ, 0.3, -1.1, 2.0),
                scale: Vec3::splat(scale),
            };
            let view = view(transform, perspective());
            let frame = EarthFrame::default();
            let (eye, target) = eye(&view, None, None, &frame).expect("a perspective");
            assert_eq!((target.origin, target.size), ((20.0, 10.0), (320, 180)));
            let world = (transform.rotation * Vec3::new(0.4, 0.3, -2.0)) * 50.0;
            let bevy_clip = view.clip_from_view
                * view.world_from_view.to_matrix().inverse()
                * world.extend(1.0);
            let (eye_itrf_m, clip_from_eye) = eye.to_itrf();
            let clip = clip_from_eye * (world.as_dvec3() - eye_itrf_m).extend(1.0);
            let (bevy, ours) = (
                (bevy_clip / bevy_clip.w).truncate(),
                (clip / clip.w).truncate().as_vec3(),
            );
            assert!((bevy - ours).abs().max_element() < 1e-5, "{bevy} {ours}");
            assert!((bevy.z / ours.z - 1.0).abs() < 1e-5, "{bevy} {ours}");
        }
    }

    #[test]
    fn what_has_no_picture_is_rejected() {
        let frame = EarthFrame::default();
        let fault = |view: &ExtractedView| eye(view, None, None, &frame).map(drop);
        let flat = Mat4::from_scale(Vec3::splat(0.1));
        assert!(matches!(
            fault(&view(Transform::IDENTITY, flat)),
            Err(EarthFault::Projection)
        ));
        for scale in [
            Vec3::new(-1.0, 1.0, 1.0),
            Vec3::new(1.0, 2.0, 1.0),
            Vec3::ZERO,
            Vec3::NAN,
        ] {
            let view = view(Transform::from_scale(scale), perspective());
            let found = fault(&view);
            assert!(matches!(found, Err(EarthFault::Transform)), "{found:?}");
        }
        let linear = ExtractedView {
            target_format: TextureFormat::Rgba8Unorm,
            ..view(Transform::IDENTITY, perspective())
        };
        assert!(matches!(fault(&linear), Err(EarthFault::Format(_))));
    }

    #[test]
    fn a_picture_drawn_smaller_and_a_shaken_one_are_drawn_so() {
        let view = view(Transform::IDENTITY, perspective());
        let smaller = MainPassResolutionOverride(bevy::math::UVec2::new(160, 90));
        let jitter = TemporalJitter {
            offset: bevy::math::Vec2::new(0.25, -0.5),
        };
        let frame = EarthFrame::default();
        let found = eye(&view, Some(&jitter), Some(&smaller), &frame);
        let (eye, target) = found.expect("a perspective");
        assert_eq!(target.size, (160, 90));
        let shift = eye.clip_from_view.z_axis - perspective().as_dmat4().z_axis;
        assert!((shift.x - 0.5 / 320.0).abs() < 1e-7, "{shift}");
        assert!((shift.y - 1.0 / 180.0).abs() < 1e-7, "{shift}");
    }
}
