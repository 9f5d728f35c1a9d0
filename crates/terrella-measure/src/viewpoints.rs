//! Viewpoints of the harness: the heights of the paper's Table 2 and beyond, along two ground paths.

use std::f64::consts::TAU;
use terrella::EyeView;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella_play::camera::{OrbitalMotion, Pose};
use terrella_play::scene::{CameraMode, CameraUp};

/// A height at which frames are measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyeHeight {
    /// Height of the eye above the ellipsoid, kilometres.
    pub height_km: f64,
    /// The paper's frames per second there (Table 2, GeForce 6800, 2011), where it gives any.
    pub paper_frames_per_s: Option<f64>,
}

const fn eye_height(height_km: f64, paper_frames_per_s: Option<f64>) -> EyeHeight {
    EyeHeight {
        height_km,
        paper_frames_per_s,
    }
}

/// Two heights in the air, the eight of Table 2, the geostationary orbit, and the Moon's mean distance (384 400 km from the centre).
pub const EYE_HEIGHTS: [EyeHeight; 12] = [
    eye_height(1.0, None),
    eye_height(30.0, None),
    eye_height(100.0, Some(57.0)),
    eye_height(200.0, Some(49.0)),
    eye_height(600.0, Some(45.0)),
    eye_height(1_000.0, Some(47.0)),
    eye_height(2_000.0, Some(51.0)),
    eye_height(7_000.0, Some(62.0)),
    eye_height(10_000.0, Some(75.0)),
    eye_height(20_000.0, Some(78.0)),
    eye_height(35_786.0, None),
    eye_height(378_022.0, None),
];

/// A great circle over the ground that an eye flies along. The Earth does not turn meanwhile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GroundPath {
    /// Along the equator, eastwards.
    Equatorial,
    /// Inclined by 51.6°, as the space station's, northwards over 0° E.
    Inclined,
}

impl GroundPath {
    /// Both paths.
    pub const ALL: [Self; 2] = [Self::Equatorial, Self::Inclined];

    pub fn inclination_deg(self) -> f64 {
        match self {
            Self::Equatorial => 0.0,
            Self::Inclined => 51.6,
        }
    }

    /// As in reports: the inclination with its unit.
    pub fn name(self) -> &'static str {
        match self {
            Self::Equatorial => "equatorial",
            Self::Inclined => "51.6 deg",
        }
    }

    /// Place and direction of flight after a part (0…1) of one turn. Heights are geodetic; the speed is one radian of
    /// the path a second.
    pub fn motion(self, ellipsoid: &Ellipsoid, height_m: f64, part: f64) -> OrbitalMotion {
        let (sin_i, cos_i) = self.inclination_deg().to_radians().sin_cos();
        let (sin, cos) = (TAU * part).sin_cos();
        // The normal of the ellipsoid goes round a great circle.
        let normal = glam::DVec3::new(cos, sin * cos_i, sin * sin_i);
        let place = Geodetic {
            lat_rad: normal.z.atan2(normal.x.hypot(normal.y)),
            lon_rad: normal.y.atan2(normal.x),
            height_m,
        };
        let position_itrf_m = ellipsoid.itrf_from_geodetic(place);
        OrbitalMotion {
            position_itrf_m,
            velocity_m_s: glam::DVec3::new(-sin, cos * cos_i, cos * sin_i)
                * position_itrf_m.length(),
        }
    }

    /// The view from there with a camera of this mode: `Nadir` and `Horizon` as in a scene, `Chase` as `Horizon` (there is no spacecraft),
    /// `Geodetic` as `Nadir` with north upwards.
    pub fn view(
        self,
        ellipsoid: &Ellipsoid,
        height_m: f64,
        part: f64,
        mode: CameraMode,
        fov_rad: f64,
        aspect: f64,
    ) -> EyeView {
        let motion = self.motion(ellipsoid, height_m, part);
        let pose = match mode {
            CameraMode::Nadir => Pose::nadir(&motion, CameraUp::Flight, ellipsoid),
            CameraMode::Geodetic => Pose::nadir(&motion, CameraUp::North, ellipsoid),
            CameraMode::Horizon | CameraMode::Chase => Pose::horizon(&motion, ellipsoid, fov_rad),
        };
        pose.view(fov_rad, aspect)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_keeps_its_height_and_reaches_its_inclination() {
        let ellipsoid = Ellipsoid::WGS84;
        for path in GroundPath::ALL {
            let mut highest: f64 = 0.0;
            for step in 0..64 {
                let motion = path.motion(&ellipsoid, 4e5, f64::from(step) / 64.0);
                let place = ellipsoid.geodetic_from_itrf(motion.position_itrf_m);
                assert!((place.height_m - 4e5).abs() < 1e-6, "{place:?}");
                highest = highest.max(place.lat_rad.to_degrees());
                let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
                let climb = motion.velocity_m_s.normalize().dot(up);
                assert!(climb.abs() < 1e-12, "{climb}");
            }
            assert!((highest - path.inclination_deg()).abs() < 1e-9, "{highest}");
        }
    }

    #[test]
    fn the_paths_start_over_the_gulf_of_guinea_and_go_east() {
        for path in GroundPath::ALL {
            let motion = path.motion(&Ellipsoid::WGS84, 0.0, 0.0);
            let place = Ellipsoid::WGS84.geodetic_from_itrf(motion.position_itrf_m);
            assert_eq!((place.lat_rad, place.lon_rad), (0.0, 0.0));
            assert!(motion.velocity_m_s.y > 0.0);
        }
    }
}
