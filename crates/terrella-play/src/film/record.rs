//! What the page of a film says of a frame.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use terrella::EyeView;
use terrella::frames::{Epoch, TimeScale, ccsds_time};

/// A frame on the page of its film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameRecord {
    /// Its number in the film, from 0.
    pub index: u64,
    /// Its file, in the folder of the page.
    pub file: String,
    /// Length of the file.
    pub bytes: u64,
    /// BLAKE3 of the file.
    pub blake3: String,
    /// The instant that was drawn, UTC, to the nanosecond.
    pub utc: String,
    /// The same in TAI.
    pub tai: String,
    /// The same as nanoseconds after the scene's start, exactly.
    pub elapsed_ns: i64,
    /// When the shutter was opened and closed, nanoseconds after the scene's start; absent where an instant was drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shutter_ns: Option<[i64; 2]>,
    /// What the light was multiplied by before it was shown: 2 to the power of it.
    pub exposure_ev: f64,
    /// Where the eye is and where it looks.
    pub camera: CameraRecord,
}

/// The camera of a frame, at its instant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraRecord {
    /// The eye, ITRF, metres.
    pub eye_itrf_m: [f64; 3],
    /// Unit, ITRF axes.
    pub forward: [f64; 3],
    /// Unit, ITRF axes, upwards in the picture.
    pub up: [f64; 3],
    /// Field of view from the bottom to the top of the picture, degrees.
    pub fov_y_deg: f64,
}

impl FrameRecord {
    /// A frame that is not written yet.
    pub fn new(index: u64, start: Epoch, epoch: Epoch, view: &EyeView, exposure_ev: f64) -> Self {
        let elapsed_ns = (epoch - start).total_nanoseconds();
        Self {
            index,
            file: String::new(),
            bytes: 0,
            blake3: String::new(),
            utc: ccsds_time(epoch, TimeScale::Utc) + "Z",
            tai: ccsds_time(epoch, TimeScale::Tai),
            // Scenes reach over two hundred years, 6.3e18 ns.
            elapsed_ns: i64::try_from(elapsed_ns).unwrap_or(i64::MAX),
            shutter_ns: None,
            exposure_ev,
            camera: CameraRecord::of(view),
        }
    }
}

impl CameraRecord {
    fn of(view: &EyeView) -> Self {
        let itrf_from_world = &view.itrf_from_world;
        let itrf_from_view =
            itrf_from_world.matrix3 * glam::DMat3::from_quat(view.view_from_world.inverse());
        let unit = |axis: DVec3| axis.normalize_or_zero().to_array();
        Self {
            eye_itrf_m: itrf_from_world.transform_point3(view.eye_world).to_array(),
            forward: unit(-itrf_from_view.z_axis),
            up: unit(itrf_from_view.y_axis),
            fov_y_deg: 2.0 * (1.0 / view.clip_from_view.y_axis.y).atan().to_degrees(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::frame_epoch;
    use crate::scene::Scene;
    use terrella::frames::utc_from_rfc3339;

    #[test]
    fn an_instant_and_a_camera_are_reported_exactly() {
        let text = "[time]\nstart = \"2016-12-31T23:59:59Z\"\nspeed = 1\nframe_rate_hz = 3\nduration_s = 10\n";
        let scene = Scene::from_toml(text, "a.toml".as_ref()).expect("good");
        let start = utc_from_rfc3339("2016-12-31T23:59:59Z").expect("a date");
        let eye = DVec3::new(7e6, 1.0, -2.0);
        let (forward, up) = (DVec3::new(-0.6, 0.8, 0.0), DVec3::Z);
        let view = EyeView::itrf(eye, forward, up, 1.0, 1.5);
        let record = |index| {
            let epoch = frame_epoch(&scene.time, index);
            FrameRecord::new(index, start, epoch, &view, -1.5)
        };
        // Through the leap second.
        assert_eq!(record(1).utc, "2016-12-31T23:59:59.333333333Z");
        assert_eq!(record(4).utc, "2016-12-31T23:59:60.333333333Z");
        assert_eq!(record(4).tai, "2017-01-01T00:00:36.333333333");
        assert_eq!(record(7).utc, "2017-01-01T00:00:00.333333333Z");
        assert_eq!(record(4).elapsed_ns, 1_333_333_333);
        let camera = record(4).camera;
        assert_eq!(camera.eye_itrf_m, eye.to_array());
        assert!((DVec3::from(camera.forward) - forward).length() < 1e-15);
        assert!((DVec3::from(camera.up) - up).length() < 1e-15);
        assert!((camera.fov_y_deg - 1_f64.to_degrees()).abs() < 1e-12);
    }
}
