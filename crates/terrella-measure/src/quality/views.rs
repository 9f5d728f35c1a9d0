//! Views for the comparison of quality reductions.

use crate::GroundPath;
use terrella::{EyeView, Sky};
use terrella_play::Flight;
use terrella_play::scene::CameraMode;

/// Heights of the eye, kilometres, with the camera that looks from there.
const HEIGHTS: [(f64, CameraMode); 3] = [
    (408.0, CameraMode::Nadir),
    (408.0, CameraMode::Horizon),
    (10_000.0, CameraMode::Nadir),
];
/// Places on the path, parts of one turn: a quarter apart, so that noon, night and both twilights are among them.
const PLACES: [f64; 4] = [0.0, 0.25, 0.5, 0.75];

/// Views of pictures with this width over height, by day, by night and at dusk: what is not in sight by day has its weight too.
pub fn views(flight: &Flight, aspect: f64) -> (Vec<EyeView>, Sky) {
    let figure = flight.scene().earth.figure.ellipsoid();
    let fov_rad = flight.scene().camera.fov_deg.to_radians();
    let views = HEIGHTS.iter().flat_map(|(height_km, mode)| {
        PLACES.map(|part| {
            GroundPath::Inclined.view(&figure, height_km * 1e3, part, *mode, fov_rad, aspect)
        })
    });
    (views.collect(), flight.sky_at(flight.scene().time.start))
}
