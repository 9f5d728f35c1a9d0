//! Forces on a satellite, each of which can be switched on and off.
//!
//! | file | content |
//! |---|---|
//! | `gravity.rs`, `egm96.rs` | the Earth's field |
//! | `atmosphere.rs` | density of the air |
//! | `shadow.rs` | sunlight behind the Earth |
//! | `sun_moon_axes.rs` | Sun, Moon and the Earth's axes over a span |
//!
//! Neglected: tides of the solid Earth and the oceans (1e-7 m/s² in low orbit), general relativity (1e-8), radiation from the Earth (1e-8 for usual
//! spacecraft), lift, winds, other planets (1e-10), and the effect of solar activity on the air.

mod atmosphere;
mod egm96;
mod gravity;
mod shadow;
mod sun_moon_axes;

pub use atmosphere::AtmosphereModel;
use egm96::EGM96_DEGREE;
pub use shadow::Shadow;
pub(super) use shadow::sun_above_limb_rad;
pub(super) use sun_moon_axes::SunMoonAxes;

use super::NumericalError;
use super::integrate::Equations;
use crate::StartError;
use crate::constants::{EARTH_GM_M3_S2, MOON_GM_M3_S2, SUN_GM_M3_S2, SUNLIGHT_PRESSURE_N_M2};
use glam::{DMat3, DVec3};
use gravity::Field;
use terrella_frames::{ASTRONOMICAL_UNIT_M, Ellipsoid, Epoch, Orientation};

/// Models of the Earth's gravity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gravity {
    /// A point mass.
    #[default]
    Point,
    /// Zonal harmonics J2…J`degree` of EGM96 about the axis z of ITRF; `degree` from 2 to 20.
    Zonal {
        /// The highest degree.
        degree: usize,
    },
    /// The same about the z axis of GCRF, the pole of J2000 (within 0.14° in the first half of this century): then energy and
    /// the momentum about z are kept exactly.
    ZonalOfJ2000 {
        /// The highest degree.
        degree: usize,
    },
    /// EGM96 to a degree from 2 to 20 and an order up to it, turning with the Earth.
    Field {
        /// The highest degree.
        degree: usize,
        /// The highest order.
        order: usize,
    },
}

/// A constant thrust from one epoch to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thrust {
    /// When it begins.
    pub first: Epoch,
    /// When it ends.
    pub last: Epoch,
    /// Acceleration, m/s².
    pub acceleration_m_s2: DVec3,
    /// The axes that the acceleration is given in.
    pub axes: ThrustAxes,
}

/// Axes of a thrust.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThrustAxes {
    /// Those of the stars.
    Gcrf,
    /// x along the velocity, z along the angular momentum, y = z × x.
    Flight,
    /// x away from the Earth's centre, z along the angular momentum, y = z × x.
    Radial,
}

impl ThrustAxes {
    /// Rotation from these axes to GCRF, for a satellite at `r` with velocity `v`.
    pub(crate) fn gcrf_from(self, r: DVec3, v: DVec3) -> DMat3 {
        let x = match self {
            Self::Gcrf => return DMat3::IDENTITY,
            Self::Flight => v.normalize_or_zero(),
            Self::Radial => r.normalize_or_zero(),
        };
        let z = r.cross(v).normalize_or_zero();
        DMat3::from_cols(x, z.cross(x), z)
    }
}

/// Which forces act.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ForceModel {
    /// The Earth's gravity.
    pub gravity: Gravity,
    /// The air's drag, its air turning with the Earth.
    pub drag: Option<AtmosphereModel>,
    /// The Sun's gravity, as a point's.
    pub sun: bool,
    /// The Moon's gravity, as a point's.
    pub moon: bool,
    /// The pressure of sunlight, with this shadow.
    pub sunlight: Option<Shadow>,
    /// Thrusts, each over its own time.
    pub thrusts: Vec<Thrust>,
    /// The Earth's orientation at the start.
    pub orientation: Orientation,
}

/// Properties of the spacecraft for drag and radiation pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacecraft {
    /// Mass, kilograms.
    pub mass_kg: f64,
    /// Area against the air, m².
    pub drag_area_m2: f64,
    /// Drag coefficient, about 2.2 in free molecular flow.
    pub drag_coefficient: f64,
    /// Area against the sunlight, m².
    pub sunlit_area_m2: f64,
    /// 1 where light is taken up, 2 where it is thrown back.
    pub reflectivity: f64,
}

impl Default for Spacecraft {
    /// 1000 kg behind 10 m²: 100 kg/m² before coefficients of 2.2 and 1.3.
    fn default() -> Self {
        Self {
            mass_kg: 1000.0,
            drag_area_m2: 10.0,
            drag_coefficient: 2.2,
            sunlit_area_m2: 10.0,
            reflectivity: 1.3,
        }
    }
}

/// Most thrusts in one model.
const MAX_THRUSTS: usize = 10_000;

impl ForceModel {
    /// Whether the forces are valid together with the spacecraft's properties.
    pub fn check(&self, craft: &Spacecraft) -> Result<(), NumericalError> {
        let range = |field, value, expected| {
            Err(NumericalError::from(StartError::Range {
                field,
                value,
                expected,
            }))
        };
        let (degree, order) = match self.gravity {
            Gravity::Point => (2, 0),
            Gravity::Zonal { degree } | Gravity::ZonalOfJ2000 { degree } => (degree, 0),
            Gravity::Field { degree, order } => (degree, order),
        };
        if !(2..=EGM96_DEGREE).contains(&degree) {
            return range("degree of the field", degree as f64, "2…20");
        }
        if order > degree {
            return range("order of the field", order as f64, "0…its degree");
        }
        let numbers = [
            ("mass, kg,", craft.mass_kg, f64::MIN_POSITIVE),
            ("drag area, m²,", craft.drag_area_m2, 0.0),
            ("drag coefficient", craft.drag_coefficient, 0.0),
            ("sunlit area, m²,", craft.sunlit_area_m2, 0.0),
            ("reflectivity", craft.reflectivity, 0.0),
        ];
        for (field, value, least) in numbers {
            if !(least..1e12).contains(&value) {
                return range(field, value, "a number from 0 to 1e12, a mass above 0");
            }
        }
        if self.thrusts.len() > MAX_THRUSTS {
            return range(
                "number of thrusts",
                self.thrusts.len() as f64,
                "at most 10 000",
            );
        }
        if !self.thrusts.iter().all(|t| t.acceleration_m_s2.is_finite()) {
            let field = "the acceleration of a thrust";
            return Err(StartError::NotFinite { field }.into());
        }
        match self.thrusts.iter().find(|t| t.first > t.last) {
            Some(t) => {
                let seconds = (t.last - t.first).to_seconds();
                range("duration of a thrust, s,", seconds, "0 or more")
            }
            None => Ok(()),
        }
    }

    pub(super) fn needs_axes(&self) -> bool {
        self.drag.is_some()
            || self.sun
            || self.moon
            || self.sunlight.is_some()
            || matches!(self.gravity, Gravity::Zonal { .. } | Gravity::Field { .. })
    }
}

/// The equations of motion: six unknowns, position (m) and velocity (m/s) in GCRF, over seconds from an epoch.
#[derive(Clone, Debug)]
pub(super) struct EquationsOfMotion {
    model: ForceModel,
    field: Option<Field>,
    /// C_D A/m, m²/kg.
    ballistic: f64,
    /// C_R A/m, m²/kg.
    sail: f64,
    pub axes: SunMoonAxes,
    relative: f64,
    /// Thrusts that act through the present stretch.
    pub acting: Vec<usize>,
}

/// Lower limit of the speed for relative tolerances, m/s.
const SPEED_FLOOR_M_S: f64 = 100.0;

impl EquationsOfMotion {
    pub fn new(model: &ForceModel, craft: &Spacecraft, epoch: Epoch, relative: f64) -> Self {
        let field = match model.gravity {
            Gravity::Point => None,
            Gravity::Zonal { degree } | Gravity::ZonalOfJ2000 { degree } => {
                Some(Field::new(degree, 0))
            }
            Gravity::Field { degree, order } => Some(Field::new(degree, order)),
        };
        Self {
            field,
            ballistic: craft.drag_coefficient * craft.drag_area_m2 / craft.mass_kg,
            sail: craft.reflectivity * craft.sunlit_area_m2 / craft.mass_kg,
            axes: SunMoonAxes::new(epoch, &model.orientation),
            model: model.clone(),
            relative,
            acting: Vec::new(),
        }
    }

    /// Acceleration, m/s².
    fn acceleration(&mut self, t: f64, r: DVec3, v: DVec3) -> DVec3 {
        let distance = r.length();
        let mut a = DVec3::ZERO;
        if let Some(shadow) = self.model.sunlight {
            let sun = self.axes.sun_m(t);
            let away = r - sun;
            let au = ASTRONOMICAL_UNIT_M / away.length();
            let pressure = SUNLIGHT_PRESSURE_N_M2 * au * au * shadow.sunlight(r, sun);
            a += away.normalize_or_zero() * (pressure * self.sail);
        }
        if self.model.sun {
            a += third_body(SUN_GM_M3_S2, r, self.axes.sun_m(t));
        }
        if self.model.moon {
            a += third_body(MOON_GM_M3_S2, r, self.axes.moon_m(t));
        }
        for &k in &self.acting {
            if let Some(thrust) = self.model.thrusts.get(k) {
                a += thrust.axes.gcrf_from(r, v) * thrust.acceleration_m_s2;
            }
        }
        if let Some(air) = self.model.drag
            && distance < Ellipsoid::WGS84.equatorial_radius_m + atmosphere::TOP_M
        {
            let density = air.density_kg_m3(self.height_m(t, r));
            let through_air = v - self.axes.rotation_rad_s(t).cross(r);
            a -= through_air * (0.5 * density * self.ballistic * through_air.length());
        }
        if let Some(field) = &mut self.field {
            let axes = match self.model.gravity {
                Gravity::Zonal { .. } | Gravity::Field { .. } => Some(self.axes.itrf_from_gcrf(t)),
                Gravity::Point | Gravity::ZonalOfJ2000 { .. } => None,
            };
            a += match axes {
                Some(axes) => axes.transpose() * field.acceleration(axes * r),
                None => field.acceleration(r),
            };
        }
        a - r * (EARTH_GM_M3_S2 / (distance * distance * distance))
    }

    /// Height over WGS84, metres, at a position in GCRF. A model without Earth-fixed forces takes the pole of J2000.
    pub fn height_m(&mut self, t: f64, r: DVec3) -> f64 {
        let position = match self.model.needs_axes() {
            true => self.axes.intermediate_from_gcrf(t) * r,
            false => r,
        };
        Ellipsoid::WGS84.geodetic_from_itrf(position).height_m
    }

    /// Potential of the Earth's field, m²/s², positive; for models that keep the energy.
    #[cfg(test)]
    pub fn potential(&mut self, r: DVec3) -> f64 {
        let field = self.field.as_mut().map_or(0.0, |field| field.potential(r));
        EARTH_GM_M3_S2 / r.length() + field
    }
}

impl Equations<6> for EquationsOfMotion {
    fn derivative(&mut self, t: f64, y: &[f64; 6]) -> [f64; 6] {
        let [x, y, z, vx, vy, vz] = *y;
        let a = self.acceleration(t, DVec3::new(x, y, z), DVec3::new(vx, vy, vz));
        [vx, vy, vz, a.x, a.y, a.z]
    }

    fn norm(&self, error: &[f64; 6], y: &[f64; 6]) -> f64 {
        let length = |y: &[f64; 6], first: usize| {
            (y[first] * y[first] + y[first + 1] * y[first + 1] + y[first + 2] * y[first + 2]).sqrt()
        };
        let position = length(error, 0) / (self.relative * length(y, 0));
        let velocity = length(error, 3) / (self.relative * (length(y, 3) + SPEED_FLOOR_M_S));
        (0.5 * (position * position + velocity * velocity)).sqrt()
    }

    fn increment(&self, index: usize, _: &[f64; 6]) -> f64 {
        // 10 m is small against the air's scale height, 1 mm/s against any speed of fall; both leave eight digits.
        if index < 3 { 10.0 } else { 1e-3 }
    }
}

/// Acceleration by a body at `s` of a satellite at `r` against the Earth's own, m/s² (Battin 1999, 8.62): the difference of
/// two nearly equal pulls, without taking it.
fn third_body(gm_m3_s2: f64, r: DVec3, s: DVec3) -> DVec3 {
    let q = r.dot(r - 2.0 * s) / s.length_squared();
    let f = q * (3.0 + 3.0 * q + q * q) / (1.0 + (1.0 + q) * (1.0 + q).sqrt());
    let d = (r - s).length();
    (r + s * f) * (-gm_m3_s2 / (d * d * d))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_body_pulls_by_the_difference() {
        let (r, s) = (DVec3::new(3e7, -2e7, 1e7), DVec3::new(-2e8, 3e8, 1e8));
        let d = s - r;
        let direct = MOON_GM_M3_S2 * (d / d.length().powi(3) - s / s.length().powi(3));
        let found = third_body(MOON_GM_M3_S2, r, s);
        assert!((found - direct).length() < 1e-12 * direct.length());
        // Near the centre it is the tide: GM/s³ (3 (r·ŝ) ŝ − r).
        let r = r * 1e-6;
        let tide =
            MOON_GM_M3_S2 / s.length().powi(3) * (3.0 * r.dot(s.normalize()) * s.normalize() - r);
        assert!((third_body(MOON_GM_M3_S2, r, s) - tide).length() < 1e-6 * tide.length());
    }

    #[test]
    fn forces_have_the_sizes_that_are_known() {
        // Montenbruck & Gill 2000, figure 3.1, at 1000 km height and at the geostationary radius, m/s².
        let epoch = terrella_frames::utc_from_rfc3339("2018-01-15T12:00:00Z").unwrap();
        let size = |model: ForceModel, km: f64| {
            let r = DVec3::new(km * 1e3, 0.0, 0.0);
            let v = DVec3::new(0.0, (EARTH_GM_M3_S2 / r.length()).sqrt(), 0.0);
            let craft = Spacecraft {
                drag_coefficient: 2.3,
                sunlit_area_m2: 1.0,
                mass_kg: 100.0,
                drag_area_m2: 1.0,
                reflectivity: 1.3,
            };
            let point = -r * (EARTH_GM_M3_S2 / r.length().powi(3));
            let a = EquationsOfMotion::new(&model, &craft, epoch, 1e-9).acceleration(0.0, r, v);
            (a - point).length()
        };
        let none = ForceModel::default();
        let j2 = ForceModel {
            gravity: Gravity::Zonal { degree: 2 },
            ..none.clone()
        };
        let moon = ForceModel {
            moon: true,
            ..none.clone()
        };
        let sun = ForceModel {
            sun: true,
            ..none.clone()
        };
        let light = ForceModel {
            sunlight: Some(Shadow::None),
            ..none.clone()
        };
        let drag = ForceModel {
            drag: Some(AtmosphereModel::Standard1976),
            ..none.clone()
        };
        for (name, found, least, most) in [
            ("J2 at 1000 km", size(j2.clone(), 7378.0), 5e-3, 1.2e-2),
            ("J2 at 42 164 km", size(j2, 42_164.0), 5e-6, 1e-5),
            ("Moon at 42 164 km", size(moon, 42_164.0), 2e-6, 1e-5),
            ("Sun at 42 164 km", size(sun, 42_164.0), 1e-6, 4e-6),
            ("sunlight", size(light, 42_164.0), 5.5e-8, 6.5e-8),
            ("drag at 300 km", size(drag, 6678.0), 1e-5, 2e-5),
        ] {
            assert!((least..most).contains(&found), "{name}: {found:e}");
        }
    }
}
