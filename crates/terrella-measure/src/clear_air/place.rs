//! A row's eye, line of sight and Sun over a figure of the Earth.

use super::{AirRow, AirTable};
use glam::DVec3;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{EyeView, Sky};

/// Height of the eye that looks at the ground from close by and of the eye on the ground, metres: so little air changes nothing.
const CLOSE_M: f64 = 2.0;
/// Height of the eye in space, metres. It changes nothing but the distance.
const SPACE_M: f64 = 400_000.0;

/// An eye, what it looks at and the Sun, in ITRF axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedView {
    pub eye_m: DVec3,
    /// Unit vector along the line of sight.
    pub look: DVec3,
    /// Unit vector to the Sun.
    pub sun: DVec3,
}

impl PlacedView {
    /// Places a row so that its point is over a point of the ground and azimuth 0 is `heading_rad` from north.
    ///
    /// The angles are relative to the figure's normal, and heights to its surface; on a sphere, the views are exactly the tables' except for the
    /// radius.
    pub fn new(row: &AirRow, figure: &Ellipsoid, point: Geodetic, heading_rad: f64) -> Self {
        let point = Geodetic {
            height_m: 0.0,
            ..point
        };
        let ground = figure.itrf_from_geodetic(point);
        let up = Ellipsoid::normal(point.lat_rad, point.lon_rad);
        let east = DVec3::new(-point.lon_rad.sin(), point.lon_rad.cos(), 0.0);
        let ahead = up.cross(east) * heading_rad.cos() + east * heading_rad.sin();
        let (sin, cos) = row.sun_zenith_deg.to_radians().sin_cos();
        let sun = up * cos + ahead * sin;
        let (sin, cos) = row.azimuth_deg.to_radians().sin_cos();
        let flat = ahead * cos + up.cross(ahead) * sin;
        let (sin, cos) = row.place.to_radians().sin_cos();
        let radius = ground.length();
        let (eye_m, look) = match row.table {
            AirTable::Nadir => {
                let look = flat * sin - up * cos;
                // Along the sphere through the point: √(r² cos² + (R + h)² − R²) − r cos, in a form that does not cancel.
                let rise = SPACE_M * (2.0 * radius + SPACE_M);
                let way = rise / (radius * cos + ((radius * cos).powi(2) + rise).sqrt());
                (ground - look * way, look)
            }
            AirTable::Limb => {
                let tangent = radius + row.place * 1e3;
                let (low, high) = (radius + SPACE_M - tangent, radius + SPACE_M + tangent);
                let eye = ground + up * (row.place * 1e3) - flat * (low * high).sqrt();
                (eye, flat)
            }
            AirTable::Sky => {
                let height_m = (row.eye_km * 1e3).max(CLOSE_M);
                (ground + up * height_m, flat * sin + up * cos)
            }
            AirTable::Ground => (ground + up * CLOSE_M, -up),
        };
        Self { eye_m, look, sun }
    }

    /// The view of a picture of this height in radians whose middle is the line of sight.
    pub fn eye_view(&self, fov_rad: f64) -> EyeView {
        let upwards = self.look.any_orthonormal_vector();
        EyeView::itrf(self.eye_m, self.look, upwards, fov_rad, 1.0)
    }

    /// Its Sun.
    pub fn sky(&self) -> Sky {
        Sky::new(self.sun)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(table: AirTable, place: f64) -> AirRow {
        AirRow {
            table,
            sun_zenith_deg: 70.0,
            azimuth_deg: 40.0,
            place,
            eye_km: 10.0,
            albedo: 0.3,
            light: [0.0; 3],
            albedo_slope: [0.0; 3],
        }
    }

    #[test]
    fn views_stand_where_their_rows_say() {
        let figure = Ellipsoid::PAPER_SPHERE;
        let radius = figure.equatorial_radius_m;
        let point = Geodetic::from_degrees(35.0, -120.0, 0.0);
        let up = Ellipsoid::normal(point.lat_rad, point.lon_rad);
        let placed = |row| PlacedView::new(&row, &figure, point, 0.7);
        let near = |a: f64, b: f64, by: f64| assert!((a - b).abs() < by, "{a} for {b}");
        for table in AirTable::ALL {
            let view = placed(row(table, 20.0));
            near(view.sun.dot(up), f64::to_radians(70.0).cos(), 1e-12);
            near(view.look.length(), 1.0, 1e-12);
            if matches!(table, AirTable::Nadir | AirTable::Limb) {
                near(view.eye_m.length(), radius + SPACE_M, 1e-6);
            }
        }
        let nadir = placed(row(AirTable::Nadir, 60.0));
        let at = up * radius;
        near((at - nadir.eye_m).normalize().dot(nadir.look), 1.0, 1e-12);
        near((nadir.eye_m - at).normalize().dot(up), 0.5, 1e-12);
        let limb = placed(row(AirTable::Limb, 25.0));
        near(limb.eye_m.cross(limb.look).length(), radius + 25e3, 1e-6);
        let sky = placed(row(AirTable::Sky, 60.0));
        near(sky.eye_m.length(), radius + 10e3, 1e-6);
        near(sky.look.dot(up), 0.5, 1e-12);
        // Azimuth 0 has the Sun ahead.
        let ahead = AirRow {
            azimuth_deg: 0.0,
            ..row(AirTable::Sky, 70.0)
        };
        near(placed(ahead).look.dot(placed(ahead).sun), 1.0, 1e-12);
    }
}
