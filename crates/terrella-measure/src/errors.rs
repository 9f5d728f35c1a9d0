//! Errors of an image: its colours, the geolocation of its pixels, and the position of its limb.
//!
//! | file | content |
//! |---|---|
//! | `difference.rs` | colours compared with the true image: FLIP, and the root mean square error in linear light |
//! | `geolocation.rs` | the geolocation buffer: the place of each pixel, and its distance from that of the exact ray |
//! | `relief.rs` | drawn terrain compared with its elevation data: metres, pixels, holes |
//! | `silhouette.rs` | the drawn limb compared with the analytic one, to 1/64 pixel |

mod difference;
mod geolocation;
mod relief;
mod silhouette;

pub use difference::{Difference, flip_mean};
pub use geolocation::{GeolocationBuffer, GeolocationErrors, GeolocationRenderer, geolocation};
pub use relief::{GroundErrors, GroundPicture};
pub use silhouette::{DrawGeolocation, SilhouetteErrors, silhouette};

use glam::{DMat4, DVec2, DVec3};
use terrella::EyeView;

/// Where a picture of `size` shows a direction from the eye (ITRF axes, any length): pixels right and down of its upper
/// left corner. `None` behind the eye.
fn pixel_of(view: &EyeView, size: (u32, u32), direction: DVec3) -> Option<DVec2> {
    pixel_at(&view.to_itrf().1, size, direction)
}

/// The same by the view's matrix from eye-relative ITRF metres to clip space.
fn pixel_at(clip_from_eye: &DMat4, size: (u32, u32), direction: DVec3) -> Option<DVec2> {
    let clip = *clip_from_eye * direction.extend(0.0);
    let half = DVec2::new(f64::from(size.0), f64::from(size.1)) * 0.5;
    (clip.w > 0.0).then(|| DVec2::new(1.0 + clip.x / clip.w, 1.0 - clip.y / clip.w) * half)
}

/// Angle of a pixel in the middle of the picture, upwards, radians.
fn pixel_rad(view: &EyeView, size: (u32, u32)) -> f64 {
    2.0 / (view.clip_from_view.y_axis.y * f64::from(size.1.max(1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella::frames::{Ellipsoid, Geodetic};

    #[test]
    fn directions_fall_on_their_pixels() {
        let eye = Ellipsoid::WGS84.itrf_from_geodetic(Geodetic::from_degrees(10.0, 20.0, 1e6));
        let (forward, up) = (-eye.normalize(), DVec3::Z);
        let view = EyeView::itrf(eye, forward, up, 0.8, 2.0);
        let size = (200, 100);
        let middle = pixel_of(&view, size, forward).expect("ahead");
        assert!(middle.distance(DVec2::new(100.0, 50.0)) < 1e-9);
        assert_eq!(pixel_of(&view, size, -forward), None);
        // A pixel of the middle, upwards.
        let above = up.reject_from_normalized(forward).normalize();
        let step = forward + above * pixel_rad(&view, size);
        let above = pixel_of(&view, size, step).expect("ahead");
        assert!(above.distance(DVec2::new(100.0, 49.0)) < 1e-9, "{above}");
    }
}
