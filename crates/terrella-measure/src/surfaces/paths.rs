//! Four flights over the same ground.

use glam::DVec3;
use terrella::EyeView;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella_ground::elevation::Elevation;

/// A flight that surfaces are compared on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SurfacePath {
    /// 400 km high at 7.7 km/s, straight down.
    Orbit,
    /// From 400 km to 2 km above the ground in 30 s, the same part of the way each second, 40° below the horizontal.
    Descent,
    /// 500 m above the highest ground near by at 250 m/s, 8° below the horizontal.
    #[serde(rename = "low flight")]
    Low,
    /// 3 km above the ground, turning by 6° a second, the horizon in the middle.
    Horizon,
}

/// Vertical field of view of all flights, radians.
const FOV_RAD: f64 = 50.0 * std::f64::consts::PI / 180.0;
/// Ends of the descent above the ground, metres.
const DESCENT_M: (f64, f64) = (4e5, 2e3);
/// Height of the low flight above the highest ground near by, metres.
const LOW_M: f64 = 500.0;
/// Distance of nearby terrain, radians of latitude: 3 km.
const NEAR_RAD: f64 = 3000.0 / 6.371e6;

impl SurfacePath {
    /// All four.
    pub const ALL: [Self; 4] = [Self::Orbit, Self::Descent, Self::Low, Self::Horizon];

    /// As in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Orbit => "orbit",
            Self::Descent => "descent",
            Self::Low => "low flight",
            Self::Horizon => "horizon",
        }
    }

    /// How long it lasts, seconds.
    pub fn duration_s(self) -> f64 {
        match self {
            Self::Orbit => 5.0,
            Self::Descent => 30.0,
            Self::Low => 15.0,
            Self::Horizon => 10.0,
        }
    }

    /// The view at a time of the flight, seconds, which has its middle at `site`. `aspect` is width over height.
    pub fn view(
        self,
        time_s: f64,
        site: Geodetic,
        figure: &Ellipsoid,
        ground: &dyn Elevation,
        aspect: f64,
    ) -> EyeView {
        let from_middle_s = time_s - 0.5 * self.duration_s();
        let (speed_m_s, pitch_deg) = match self {
            Self::Orbit => (7700.0, -90.0_f64),
            Self::Descent => (0.0, -40.0),
            Self::Low => (250.0, -8.0),
            Self::Horizon => (0.0, 0.0),
        };
        let radius_m = figure.equatorial_radius_m;
        // Eastwards along the site's parallel.
        let lon_rad =
            site.lon_rad + from_middle_s * speed_m_s / (radius_m * site.lat_rad.cos().max(0.01));
        let lat_rad = site.lat_rad;
        let under_m = ground.height_m(lat_rad, lon_rad, 0.0);
        let height_m = match self {
            Self::Orbit => 4e5,
            Self::Descent => {
                let part = (time_s / self.duration_s()).clamp(0.0, 1.0);
                under_m + DESCENT_M.0 * (DESCENT_M.1 / DESCENT_M.0).powf(part)
            }
            Self::Low => {
                let aside_rad = NEAR_RAD / lat_rad.cos().max(0.01);
                // Smoothed by its own spacing, so that the eye does not jump over cliffs.
                let near =
                    (-3..=3).flat_map(|i| (-3..=3).map(move |j| (f64::from(i), f64::from(j))));
                let highest = near
                    .map(|(i, j)| {
                        let (lat, lon) =
                            (lat_rad + i / 3.0 * NEAR_RAD, lon_rad + j / 3.0 * aside_rad);
                        ground.height_m(lat, lon, NEAR_RAD / 3.0)
                    })
                    .fold(under_m, f64::max);
                highest + LOW_M
            }
            Self::Horizon => under_m + 3e3,
        };
        let place = Geodetic {
            lat_rad,
            lon_rad,
            height_m,
        };
        let azimuth_rad = match self {
            Self::Orbit | Self::Low => 0.5 * std::f64::consts::PI,
            Self::Descent => 0.0,
            Self::Horizon => (6.0 * time_s).to_radians(),
        };
        let pitch_rad = match self {
            // The geometric horizon in the middle of the picture.
            Self::Horizon => -(2.0 * height_m.max(0.0) / radius_m).sqrt(),
            _ => pitch_deg.to_radians(),
        };
        let up = Ellipsoid::normal(lat_rad, lon_rad);
        let east = DVec3::new(-lon_rad.sin(), lon_rad.cos(), 0.0);
        let north = up.cross(east);
        let level = north * azimuth_rad.cos() + east * azimuth_rad.sin();
        let forward = level * pitch_rad.cos() + up * pitch_rad.sin();
        let upwards = up * pitch_rad.cos() - level * pitch_rad.sin();
        let eye_itrf_m = figure.itrf_from_geodetic(place);
        EyeView::itrf(eye_itrf_m, forward, upwards, FOV_RAD, aspect)
    }
}
