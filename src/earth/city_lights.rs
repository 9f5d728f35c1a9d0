//! Which city lights may be in sight.

use super::view::ItrfView;
use super::{EarthOptions, Sky, SurfaceLight};
use crate::gpu::{LAMPS_OUT_SIN, TargetColor};
use crate::plan::{CityDraw, FramePlan};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;
use terrella_frames::Ellipsoid;
use terrella_imagery::{CityCell, CityLights};

/// Margin for the ellipsoid's flattening, in angles, radians.
const ROOM_RAD: f64 = 0.01;
/// Displayed light of a whole pixel, linear, below which a city light is left out: a fifth of an 8-bit code.
const LEAST_SHOWN: f64 = 6e-5;
/// Least cosine between the line of sight and the vertical that is assumed for visible ground.
const LEAST_FACING: f64 = 0.02;

/// Selects city lights for the views of an Earth.
#[derive(Clone)]
pub(super) struct CityLightDriver {
    lights: Option<Arc<CityLights>>,
    /// Where the lights are: no cells without lights.
    cells: &'static [CityCell],
    /// Exposed light of a pixel below which a light is left out; 0 if all light counts.
    least_shown: f64,
}

impl CityLightDriver {
    pub fn new(options: &EarthOptions) -> Self {
        let shown = DVec3::splat(LEAST_SHOWN);
        let mut driver = Self {
            lights: None,
            cells: &[],
            least_shown: match options.pass_format().target_color() {
                TargetColor::Radiance => 0.0,
                _ => {
                    let least = options.tone.light_shown_as(shown).min_element();
                    least / options.grade.largest_gain()
                }
            },
        };
        driver.set_lights(options.city_lights.clone());
        driver
    }

    /// What it selects from.
    pub fn lights(&self) -> Option<&Arc<CityLights>> {
        self.lights.as_ref()
    }

    /// Selects from these from now on.
    pub fn set_lights(&mut self, lights: Option<Arc<CityLights>>) {
        self.cells = lights.as_ref().map_or(&[], |_| CityCell::all());
        self.lights = lights;
    }

    /// Lists the lights of cells that are partly in the dark and in sight, at the level of detail that their nearest place needs. Without `detail`
    /// or without city lights there are none.
    pub fn list(
        &self,
        view: &ItrfView,
        sky: &Sky,
        exposure: f32,
        light: &SurfaceLight,
        plan: &mut FramePlan,
    ) {
        let full = light.lamp_light() * f64::from(exposure);
        let Some(lights) = self.lights.as_ref().filter(|_| light.detail && full > 0.0) else {
            return;
        };
        let ellipsoid = plan.ellipsoid;
        let radius_m = ellipsoid.equatorial_radius_m;
        for cell in self.cells {
            let from_sun_rad = cell.up.angle_between(sky.sun_itrf) + cell.radius_rad + ROOM_RAD;
            if from_sun_rad < FRAC_PI_2 - LAMPS_OUT_SIN.asin() {
                continue;
            }
            let Some(seen) = Seen::of(cell, view, &ellipsoid) else {
                continue;
            };
            let pixel_m = seen.distance_m * view.pixel_rad();
            let fineness = lights.fineness(pixel_m / seen.facing.sqrt());
            // Ground area of a pixel, square radii.
            let ground = (pixel_m / radius_m).powi(2) / seen.facing;
            let least_light = self.least_shown / full * ground;
            let points = lights.of_cell(cell.index, fineness, least_light as f32);
            plan.add_city_lights(CityDraw {
                cell: cell.index,
                points,
            });
        }
    }
}

/// Bounds of how a cell is seen.
struct Seen {
    /// Lower bound of the distance of all its places, metres.
    distance_m: f64,
    /// Upper bound of the cosine between line of sight and vertical at all its places; at least [`LEAST_FACING`].
    facing: f64,
}

impl Seen {
    /// `None` for a cell behind the limb or outside the image.
    fn of(cell: &CityCell, view: &ItrfView, ellipsoid: &Ellipsoid) -> Option<Self> {
        let (a, b) = (ellipsoid.equatorial_radius_m, ellipsoid.polar_radius_m);
        let eye_m = view.eye_itrf_m.length();
        // Height of the eye above the horizon of the cell's nearest place, on the smallest sphere.
        let angle_rad = view.eye_itrf_m.angle_between(cell.up) - cell.radius_rad - ROOM_RAD;
        let over_m = eye_m * angle_rad.max(0.0).cos() - b;
        if over_m < 0.0 {
            return None;
        }
        let squares = DVec3::new(a * a, a * a, b * b);
        let middle_m = squares * cell.up / (squares * cell.up * cell.up).element_sum().sqrt();
        let from_eye_m = middle_m - view.eye_itrf_m;
        let reach_m = (cell.radius_rad + ROOM_RAD) * a;
        let [x, y, w] = [0, 1, 3].map(|row| view.clip_from_eye.row(row));
        let is_inside = [w + x, w - x, w + y, w - y].into_iter().all(|plane| {
            let normal = plane.truncate();
            normal.dot(from_eye_m) + plane.w > -reach_m * normal.length()
        });
        let distance_m = (from_eye_m.length() - reach_m).max(eye_m - a).max(1.0);
        is_inside.then(|| Self {
            distance_m,
            facing: (over_m / distance_m).clamp(LEAST_FACING, 1.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::earth::{EyeView, Viewport};
    use terrella_frames::Geodetic;

    /// For every place of a grid that the eye sees in the image: its cell is listed as seen, at most as far away and at least as much from above.
    #[test]
    fn no_cell_in_sight_is_left_out() {
        let ellipsoid = Ellipsoid::WGS84;
        for (lat_deg, lon_deg, height_m, aim_deg) in [
            (41.0, 8.0, 4.1e5, 25.0),
            (0.0, 179.0, 2e6, 10.0),
            (88.0, 30.0, 4e5, 40.0),
            (-30.0, -60.0, 3.6e7, 2.0),
            (50.0, 10.0, 1e5, 5.0),
        ] {
            let eye = Geodetic::from_degrees(lat_deg, lon_deg, height_m);
            let eye_m = ellipsoid.itrf_from_geodetic(eye);
            let aim = Geodetic::from_degrees(lat_deg - aim_deg, lon_deg, 0.0);
            let aim_m = ellipsoid.itrf_from_geodetic(aim);
            let view = EyeView::itrf(eye_m, aim_m - eye_m, eye_m, 0.8, 1.6);
            let view = view.in_itrf(Viewport::from((640, 400))).expect("a picture");
            let (mut in_sight, mut listed) = (0, 0);
            for cell in CityCell::all() {
                let seen = Seen::of(cell, &view, &ellipsoid);
                listed += usize::from(seen.is_some());
                let (row, column) = (cell.index / 64, cell.index % 64);
                for place in 0..36 {
                    let lat_deg = 90.0 - 5.625 * (row as f64 + f64::from(place / 6) / 5.0);
                    let lon_deg = 5.625 * (column as f64 + f64::from(place % 6) / 5.0) - 180.0;
                    let place = Geodetic::from_degrees(lat_deg, lon_deg, 0.0);
                    let from_eye_m = ellipsoid.itrf_from_geodetic(place) - eye_m;
                    let facing = -from_eye_m
                        .normalize()
                        .dot(Ellipsoid::normal(place.lat_rad, place.lon_rad));
                    let clip = view.clip_from_eye * from_eye_m.extend(1.0);
                    if facing <= 0.0
                        || clip.w <= 0.0
                        || clip.truncate().truncate().abs().max_element() > clip.w
                    {
                        continue;
                    }
                    in_sight += 1;
                    let seen = seen.as_ref().expect("a place of it is in sight");
                    assert!(seen.distance_m <= from_eye_m.length() + 1.0, "{cell:?}");
                    assert!(
                        seen.facing >= facing - 1e-3,
                        "{cell:?}: {} {facing}",
                        seen.facing
                    );
                }
            }
            assert!(
                in_sight > 0 && listed < 1200,
                "{height_m}: {in_sight}, {listed}"
            );
        }
    }
}
