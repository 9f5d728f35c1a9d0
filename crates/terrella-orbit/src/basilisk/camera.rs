//! Pose of a camera on a spacecraft.

use super::attitude::rotation_of_mrp;
use super::message::Camera;
use super::world::CraftState;
use glam::{DMat3, DVec3};

/// Where a camera is and how it looks, in inertial axes about the Earth's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraPose {
    /// Metres.
    pub position_m: DVec3,
    /// Viewing direction, unit.
    pub forward: DVec3,
    /// Up direction of its image, unit, perpendicular to `forward`.
    pub up: DVec3,
}

/// The pose of a camera on a spacecraft. `None` if its numbers are not finite.
///
/// Basilisk writes the attitude of axes that are rotated relative to the camera's own: with D the rotation of `cameraDir_B`, the camera looks along
/// −D's first row; its second row is to the right and its third upwards, in the body's axes.
pub fn camera_pose(camera: &Camera, craft: &CraftState) -> Option<CameraPose> {
    let inertial_from_body = craft.inertial_from_body;
    let inertial_from_camera = inertial_from_body * rotation_of_mrp(camera.mrp)?;
    let axes = DMat3::from_quat(inertial_from_camera);
    let pose = CameraPose {
        position_m: craft.position_m + inertial_from_body * camera.position_b_m,
        forward: -axes.x_axis,
        up: axes.z_axis,
    };
    pose.position_m.is_finite().then_some(pose)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn craft() -> CraftState {
        CraftState {
            name: "sat".into(),
            position_m: DVec3::new(7e6, 0.0, 0.0),
            velocity_m_s: DVec3::Y,
            inertial_from_body: DQuat::IDENTITY,
        }
    }

    /// The table of Basilisk's own camera axes, worked by hand: x right, y down, z ahead.
    #[test]
    fn cameras_look_where_basilisk_points_them() {
        let third = 1.0 / 3.0;
        let cases = [
            // σ_CB = 0: along +z_B, +x_B to the right, −y_B up.
            (
                DVec3::new(third, third, -third),
                DVec3::Z,
                DVec3::X,
                DVec3::NEG_Y,
            ),
            // σ_CB = (−⅓, ⅓, −⅓).
            (DVec3::NEG_Z, DVec3::X, DVec3::NEG_Y, DVec3::Z),
            // σ_CB = (0, tan 22.5°, 0).
            (
                DVec3::new(0.0, 0.5_f64.sqrt(), -(0.5_f64.sqrt())),
                DVec3::X,
                DVec3::NEG_Z,
                DVec3::NEG_Y,
            ),
        ];
        for (mrp, forward, right, up) in cases {
            let camera = Camera {
                mrp,
                position_b_m: DVec3::Z,
                ..Camera::default()
            };
            let pose = camera_pose(&camera, &craft()).expect("a pose");
            assert!((pose.forward - forward).length() < 1e-12, "{pose:?}");
            assert!((pose.up - up).length() < 1e-12, "{pose:?}");
            let its_right = pose.forward.cross(pose.up);
            assert!((its_right - right).length() < 1e-12, "{pose:?}");
            assert_eq!(pose.position_m, DVec3::new(7e6, 0.0, 1.0));
        }
    }
}
