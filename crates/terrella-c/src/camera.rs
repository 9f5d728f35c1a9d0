//! Cameras: plain values.

use crate::failure::{Failure, TerrellaStatus, answer};
use crate::pointers::{check_out, read, write};
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use terrella::EyeView;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella_play::camera::Pose;

/// Position, attitude and projection of a camera. Fill it with `terrella_camera_geodetic` or `terrella_camera_look`, or yourself.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TerrellaCamera {
    /// The eye: Earth-fixed axes (ITRF: x to 0° E on the equator, z to the north pole), metres; at least 6 000 000 m from the centre.
    pub eye_itrf_m: [f64; 3],
    /// Rotation from Earth-fixed axes to those of the view (x right, y up, −z forward), row by row.
    pub view_from_itrf: [f64; 9],
    /// Projection from view to clip space as Vulkan has it (z from 0 to 1) but y upwards, row by row. Depth reversed: nearer is larger.
    pub clip_from_view: [f64; 16],
}

impl TerrellaCamera {
    fn of(view: &EyeView) -> Self {
        Self {
            eye_itrf_m: view.eye_world.to_array(),
            view_from_itrf: DMat3::from_quat(view.view_from_world)
                .transpose()
                .to_cols_array(),
            clip_from_view: view.clip_from_view.transpose().to_cols_array(),
        }
    }

    pub(crate) fn view(&self, name: &str) -> Result<EyeView, Failure> {
        let wrong = |what: &str| Failure::argument(format!("{name}: {what}"));
        let eye = DVec3::from_array(self.eye_itrf_m);
        let rotation = DMat3::from_cols_array(&self.view_from_itrf).transpose();
        let clip_from_view = DMat4::from_cols_array(&self.clip_from_view).transpose();
        if !(eye.is_finite() && rotation.is_finite() && clip_from_view.is_finite()) {
            return Err(wrong("a number is not finite"));
        }
        check_eye(eye).map_err(|words| wrong(&format!("eye_itrf_m: {words}")))?;
        let off = (rotation * rotation.transpose() - DMat3::IDENTITY).to_cols_array();
        if off.iter().any(|off| off.abs() > 1e-6) || rotation.determinant() < 0.0 {
            return Err(wrong(
                "view_from_itrf is not a rotation: its rows must be unit vectors at right angles, right-handed",
            ));
        }
        if clip_from_view.determinant() == 0.0 {
            return Err(wrong("clip_from_view has no inverse"));
        }
        Ok(EyeView {
            eye_world: eye,
            view_from_world: DQuat::from_mat3(&rotation),
            clip_from_view,
            itrf_from_world: DAffine3::IDENTITY,
        })
    }
}

/// Least distance of an eye from the Earth's centre, metres: below every place on the ground.
const LEAST_EYE_M: f64 = 6e6;

/// Rejects eyes deep inside the Earth, as from a program that counts in kilometres.
fn check_eye(eye_itrf_m: DVec3) -> Result<(), String> {
    let distance_m = eye_itrf_m.length();
    match distance_m < LEAST_EYE_M {
        false => Ok(()),
        true => Err(format!(
            "{distance_m:.0} m from the Earth's centre is inside the Earth; give metres, not kilometres"
        )),
    }
}

fn within(value: f64, name: &str, least: f64, most: f64) -> Result<f64, Failure> {
    match (least..=most).contains(&value) {
        true => Ok(value),
        false => Err(Failure::argument(format!(
            "{name}: {value} is not from {least} to {most}"
        ))),
    }
}

/// The lens of a camera: vertical field of view, and width over height.
fn lens(fov_deg: f64, aspect: f64) -> Result<(f64, f64), Failure> {
    let fov_rad = within(fov_deg, "fov_deg", 1e-3, 179.0)?.to_radians();
    Ok((fov_rad, within(aspect, "aspect", 1e-3, 1e3)?))
}

/// A camera above a place: latitude and longitude in degrees (geodetic, WGS84), height in metres. With heading 0 and pitch −90 it looks
/// straight down, north upwards; heading turns it clockwise from north, pitch raises it, 0 is level. `fov_deg` is the vertical field of
/// view, `aspect` width over height.
///
/// # Safety
/// `camera` points to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_camera_geodetic(
    lat_deg: f64,
    lon_deg: f64,
    height_m: f64,
    heading_deg: f64,
    pitch_deg: f64,
    fov_deg: f64,
    aspect: f64,
    camera: *mut TerrellaCamera,
) -> TerrellaStatus {
    answer(|| {
        let place = Geodetic::from_degrees(
            within(lat_deg, "lat_deg", -90.0, 90.0)?,
            within(lon_deg, "lon_deg", -360.0, 360.0)?,
            within(height_m, "height_m", -1e4, 1e12)?,
        );
        let heading_rad = within(heading_deg, "heading_deg", -360.0, 360.0)?.to_radians();
        let pitch_rad = within(pitch_deg, "pitch_deg", -90.0, 90.0)?.to_radians();
        let (fov_rad, aspect) = lens(fov_deg, aspect)?;
        let pose = Pose::geodetic(place, &Ellipsoid::WGS84).facing(heading_rad, pitch_rad);
        // SAFETY: the caller's promise.
        unsafe {
            write(
                camera,
                "camera",
                TerrellaCamera::of(&pose.view(fov_rad, aspect)),
            )
        }
    })
}

/// A camera at `eye_itrf_m` (three numbers, metres) that looks along `forward` with `up` upwards on screen (three numbers each, of any
/// length). If `up` is parallel to `forward`, the roll is the library's choice, always the same one for the same `forward`. An eye less than
/// 6 000 000 m from the Earth's centre is an error.
///
/// # Safety
/// Each points to three numbers; `camera` points to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_camera_look(
    eye_itrf_m: *const f64,
    forward: *const f64,
    up: *const f64,
    fov_deg: f64,
    aspect: f64,
    camera: *mut TerrellaCamera,
) -> TerrellaStatus {
    answer(|| {
        check_out(camera, "camera")?;
        let vector = |pointer: *const f64, name: &str| -> Result<DVec3, Failure> {
            // SAFETY: the caller's promise: three numbers.
            let numbers = unsafe { read(pointer.cast::<[f64; 3]>(), name) }?;
            let vector = DVec3::from_array(*numbers);
            match vector.is_finite() {
                true => Ok(vector),
                false => Err(Failure::argument(format!("{name}: a number is not finite"))),
            }
        };
        let direction = |pointer, name: &str| -> Result<DVec3, Failure> {
            let direction = vector(pointer, name)?.try_normalize();
            direction.ok_or_else(|| Failure::argument(format!("{name}: no direction")))
        };
        let eye = vector(eye_itrf_m, "eye_itrf_m")?;
        check_eye(eye).map_err(|words| Failure::argument(format!("eye_itrf_m: {words}")))?;
        let (forward, up) = (direction(forward, "forward")?, direction(up, "up")?);
        let (fov_rad, aspect) = lens(fov_deg, aspect)?;
        let view = EyeView::itrf(eye, forward, up, fov_rad, aspect);
        // SAFETY: the caller's promise.
        unsafe { write(camera, "camera", TerrellaCamera::of(&view)) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(eye_m: DVec3, forward: DVec3, up: DVec3) -> Result<TerrellaCamera, TerrellaStatus> {
        let mut camera = std::mem::MaybeUninit::uninit();
        let [eye_m, forward, up] = [eye_m, forward, up].map(|vector| vector.to_array());
        // SAFETY: three numbers each, and writable memory, which a call that succeeds fills.
        unsafe {
            let status = terrella_camera_look(
                eye_m.as_ptr(),
                forward.as_ptr(),
                up.as_ptr(),
                45.0,
                1.0,
                camera.as_mut_ptr(),
            );
            match status {
                TerrellaStatus::TERRELLA_OK => Ok(camera.assume_init()),
                status => Err(status),
            }
        }
    }

    #[test]
    fn an_eye_in_kilometres_is_rejected() {
        let down = DVec3::NEG_X;
        assert!(look(DVec3::X * 6_778e3, down, DVec3::Z).is_ok());
        // The pole is nearest to the centre.
        assert!(look(DVec3::Z * 6_356_752.0, down, DVec3::X).is_ok());
        let status = look(DVec3::X * 6_778.0, down, DVec3::Z).expect_err("kilometres");
        assert_eq!(status, TerrellaStatus::TERRELLA_ARGUMENT);
        let mut camera = look(DVec3::X * 6_778e3, down, DVec3::Z).expect("above the ground");
        camera.eye_itrf_m = [6_778.0, 0.0, 0.0];
        let failure = camera.view("camera").expect_err("kilometres");
        let words = failure.words;
        assert!(
            words.contains("camera: eye_itrf_m: 6778 m") && words.contains("metres"),
            "{words}"
        );
    }

    #[test]
    fn up_along_forward_gives_a_view_all_the_same() {
        let (eye_m, down) = (DVec3::X * 2e7, DVec3::NEG_X);
        for up in [down, -down] {
            let camera = look(eye_m, down, up).expect("a view");
            assert!(camera.view("camera").is_ok());
            assert_eq!(Ok(camera), look(eye_m, down, up * 3.0));
            let back = DVec3::from_slice(&camera.view_from_itrf[6..]);
            assert!((back - DVec3::X).length() < 1e-12, "{back}");
        }
    }
}
