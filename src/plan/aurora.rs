//! The aurora: position and brightness of its oval, and its uniforms.

use super::glow::{GREEN_LINE, Line, RED_LINE, line, shown};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3, Vec4};
use std::f64::consts::TAU;
use terrella_frames::Epoch;

/// First Gauss coefficients of the geomagnetic field, nT: year, g₁⁰, g₁¹, h₁¹. IGRF-14 (Alken et al. 2021 describe its generation before,
/// Earth Planets Space 73, 49); that of 2030 by its secular variation.
const DIPOLE_NT: [[f64; 4]; 8] = [
    [1900.0, -31_543.0, -2_298.0, 5_922.0],
    [1950.0, -30_554.0, -2_250.0, 5_815.0],
    [1985.0, -29_873.0, -1_905.0, 5_500.0],
    [2000.0, -29_619.4, -1_728.2, 5_186.1],
    [2010.0, -29_496.6, -1_586.4, 4_944.3],
    [2020.0, -29_403.4, -1_451.4, 4_653.4],
    [2025.0, -29_350.0, -1_410.3, 4_545.5],
    [2030.0, -29_287.0, -1_360.3, 4_438.0],
];
/// Year of the geomagnetic pole if no date is known.
const USUAL_YEAR: f64 = 2025.0;

/// Geomagnetic latitude of the oval's equatorward boundary at midnight for Kp 0, and its decrease per step of Kp: NOAA's Space Weather Prediction
/// Center, Tips on Viewing the Aurora.
const EQUATORWARD_DEG: [f64; 2] = [66.5, 2.04];
/// Geomagnetic latitude of the poleward boundary, which varies little (Starkov 1994, Geomagn. Aeron. 34, 36).
const POLEWARD_DEG: f64 = 71.0;
/// Distance of the oval's centre from the geomagnetic pole, towards midnight: the oval of Feldstein 1963 (Geomagn. Aeron. 3, 183) reaches 67° at
/// midnight and 77° at noon.
const CENTER_DEG: f64 = 5.0;

/// Radius at which the oval's area is computed, metres: 110 km altitude.
const OVAL_RADIUS_M: f64 = 6.481e6;
/// Approximate zenith emission of the green line per energy flux of electrons of some keV, R per W/m²: Steele and McEwen 1990 (J. Geophys. Res. 95,
/// 10321) give 1 to 2 kR per mW/m².
const GREEN_R_M2_W: f64 = 1.5e6;
/// Ratio of the emission at 630.0 nm to that at 557.7 nm, for electrons of 1 to 2 keV (Rees and Luckey 1974, J. Geophys. Res. 79, 5181).
const RED_PER_GREEN: f64 = 0.25;
/// First negative bands of ionised nitrogen, relative to the emission at 557.7 nm. Electrons of some keV give 0.23 kR of 427.8 nm per mW/m² (Rees and
/// Luckey 1974), and the bands 0–0, 0–1 and 0–2 have the ratio 1 : 0.31 : 0.065 (Vallance Jones 1974, Aurora).
const NITROGEN_PER_GREEN: [Line; 3] = [
    line(391.4, [0.0052, 0.0002, 0.0246], 0.49),
    line(427.8, [0.2534, 0.0097, 1.2330], 0.153),
    line(470.9, [0.1858, 0.0949, 1.2434], 0.032),
];

/// Angular frequencies of structures that drift along the oval, rad/s: folds of curtains at some hundred metres a second, rays at a kilometre.
const FOLDS_RAD_S: [f64; 4] = [2e-4, -8e-4, 4.1e-3, 2.6e-2];
const RAYS_RAD_S: [f64; 4] = [0.15, -0.27, 0.51, 0.06];

/// `AuroraUniforms` of `shaders/common/air/aurora.wgsl`. ITRF axes, radians.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct AuroraUniforms {
    /// Unit vector to the northern geomagnetic pole.
    pub pole: Vec3,
    /// Angle of the oval's poleward boundary from its centre.
    pub inner: f32,
    /// Unit vector perpendicular to the pole's, towards the Sun.
    pub noon: Vec3,
    /// Angle of its equatorward boundary.
    pub outer: f32,
    /// Mean radiance of the green line from directly below, linear sRGB, relative to a white sheet that faces the Sun.
    pub green: Vec3,
    /// Sine of the angle between the oval's centre and the pole.
    pub center_sin: f32,
    /// Mean radiance of the red line, likewise.
    pub red: Vec3,
    /// Cosine of that angle.
    pub center_cos: f32,
    /// Phases of the curtains' folds.
    pub folds: Vec4,
    /// Phases of their rays.
    pub rays: Vec4,
}

impl AuroraUniforms {
    /// The aurora for a planetary index of geomagnetic activity Kp, 0…9, at a time, under a Sun in this direction.
    pub(crate) fn new(kp: f64, epoch: Option<Epoch>, sun_itrf: DVec3) -> Self {
        let seconds = epoch.map(seconds_since_2000);
        let year = seconds.map_or(USUAL_YEAR, |s| 2000.0 + s / (365.25 * 86_400.0));
        let pole = geomagnetic_pole(year);
        let noon = sun_itrf - pole * sun_itrf.dot(pole);
        let oval = Oval::new(kp);
        let rayleighs = oval.rayleighs(kp);
        // Nitrogen shines where electrons stop, a little below the green light.
        let [violet, indigo, blue] = NITROGEN_PER_GREEN.map(|band| band.times(rayleighs));
        let green = [GREEN_LINE.of_rayleighs(rayleighs), violet, indigo, blue];
        let red = RED_LINE.of_rayleighs(RED_PER_GREEN * rayleighs);
        let (center_sin, center_cos) = CENTER_DEG.to_radians().sin_cos();
        // Phases are computed in f64: seconds since 2000 have no fractions left in f32.
        let phases = |rad_s: [f64; 4]| {
            let of = |rad_s: f64| (rad_s * seconds.unwrap_or(0.0)).rem_euclid(TAU) as f32;
            Vec4::from_array(rad_s.map(of))
        };
        Self {
            pole: pole.as_vec3(),
            inner: oval.inner_rad as f32,
            noon: noon
                .try_normalize()
                .unwrap_or_else(|| pole.any_orthonormal_vector())
                .as_vec3(),
            outer: oval.outer_rad as f32,
            green: shown(&green).as_vec3(),
            center_sin: center_sin as f32,
            red: shown(&[red]).as_vec3(),
            center_cos: center_cos as f32,
            folds: phases(FOLDS_RAD_S),
            rays: phases(RAYS_RAD_S),
        }
    }
}

/// Angles of the oval's boundaries from its centre.
struct Oval {
    inner_rad: f64,
    outer_rad: f64,
}

impl Oval {
    fn new(kp: f64) -> Self {
        let [quiet_deg, per_kp_deg] = EQUATORWARD_DEG;
        // At midnight, towards which the centre is shifted.
        let from_center = |lat_deg: f64| (90.0 - lat_deg - CENTER_DEG).to_radians();
        Self {
            inner_rad: from_center(POLEWARD_DEG),
            outer_rad: from_center(quiet_deg - per_kp_deg * kp),
        }
    }

    /// Mean zenith emission of the green line: from the hemispheric power, spread over the oval.
    fn rayleighs(&self, kp: f64) -> f64 {
        let sphere_m2 = TAU * OVAL_RADIUS_M * OVAL_RADIUS_M;
        let area_m2 = sphere_m2 * (self.inner_rad.cos() - self.outer_rad.cos());
        GREEN_R_M2_W * hemispheric_power_w(kp) / area_m2
    }
}

/// Hemispheric power of precipitating electrons, Zhang and Paxton 2008 (J. Atmos. Sol.-Terr. Phys. 70, 1231): HP = 38.66 exp(0.1967 Kp) − 33.99 GW
/// to Kp 5, and 4.592 exp(0.4731 Kp) + 20.47 GW beyond.
fn hemispheric_power_w(kp: f64) -> f64 {
    let gigawatts = if kp <= 5.0 {
        38.66 * (0.1967 * kp).exp() - 33.99
    } else {
        4.592 * (0.4731 * kp).exp() + 20.47
    };
    1e9 * gigawatts
}

/// Unit vector to the northern pole of the centred dipole, ITRF axes; for a year outside the table, that of its first or last year.
fn geomagnetic_pole(year: f64) -> DVec3 {
    let first = DIPOLE_NT[0];
    let mut dipole = DVec3::new(first[2], first[3], first[1]);
    for pair in DIPOLE_NT.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let part = ((year - from[0]) / (to[0] - from[0])).clamp(0.0, 1.0);
        let moved = DVec3::new(to[2] - from[2], to[3] - from[3], to[1] - from[1]);
        dipole += part * moved;
    }
    -dipole.normalize()
}

fn seconds_since_2000(epoch: Epoch) -> f64 {
    (epoch - Epoch::from_gregorian_tai_at_noon(2000, 1, 1)).to_seconds()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn degrees(pole: DVec3) -> (f64, f64) {
        let lat = pole.z.asin().to_degrees();
        (lat, pole.y.atan2(pole.x).to_degrees())
    }

    #[test]
    fn the_geomagnetic_pole_is_where_the_field_s_tables_have_it() {
        // World Data Center for Geomagnetism, Kyoto: 80.65° N 72.68° W in 2020, 78.68° N 68.79° W in 1900, geodetic: 0.06° and 0.07°
        // further north than geocentric.
        for (year, lat_deg, lon_deg) in [(2020.0, 80.59, -72.68), (1900.0, 78.61, -68.79)] {
            let (lat, lon) = degrees(geomagnetic_pole(year));
            assert!((lat - lat_deg).abs() < 0.05, "{year}: {lat}");
            assert!((lon - lon_deg).abs() < 0.1, "{year}: {lon}");
        }
        assert_eq!(geomagnetic_pole(1000.0), geomagnetic_pole(1900.0));
        assert_eq!(geomagnetic_pole(2090.0), geomagnetic_pole(2030.0));
    }

    #[test]
    fn the_oval_grows_and_brightens_with_activity() {
        let ovals = [0.0, 3.0, 5.0, 5.01, 9.0].map(|kp| (Oval::new(kp), kp));
        for pair in ovals.windows(2) {
            assert!(pair[1].0.outer_rad > pair[0].0.outer_rad);
            let [less, more] = [&pair[0], &pair[1]].map(|(_, kp)| hemispheric_power_w(*kp));
            assert!(more > less);
        }
        // One or two kilorayleighs in quiet times, some tens in a great storm.
        let mean = |kp: f64| Oval::new(kp).rayleighs(kp) / 1e3;
        assert!((0.2..2.0).contains(&mean(0.0)), "{}", mean(0.0));
        assert!((2.0..5.0).contains(&mean(3.0)), "{}", mean(3.0));
        assert!((8.0..30.0).contains(&mean(9.0)), "{}", mean(9.0));
    }

    /// Linear sRGB of these four lines by colour-science 0.4.7, which weighs photons by their energy: 0.2315, 1, 0.1263.
    #[test]
    fn green_light_is_paled_by_nitrogen() {
        let light = AuroraUniforms::new(4.0, None, DVec3::X).green.as_dvec3();
        let [red, blue] = [light.x, light.z].map(|channel| channel / light.y);
        assert!(
            (red - 0.2315).abs() < 5e-3 && (blue - 0.1263).abs() < 5e-3,
            "{light}"
        );
    }

    #[test]
    fn it_is_the_same_at_the_same_time_and_moves_meanwhile() {
        let at = |text: &str| {
            let epoch = text.parse().expect("a date");
            AuroraUniforms::new(4.0, Some(epoch), DVec3::X)
        };
        let [begin, later] = ["2024-05-10T22:00:00Z", "2024-05-10T22:00:01Z"].map(at);
        assert_eq!(begin, at("2024-05-10T22:00:00Z"));
        let moved = |a: Vec4, b: Vec4| (b - a).abs().min((b - a).abs() - TAU as f32);
        assert!(moved(begin.folds, later.folds).abs().max_element() < 7.0);
        assert_ne!(begin.rays, later.rays);
        assert_eq!(begin.pole.distance(later.pole), 0.0);
        let timeless = AuroraUniforms::new(4.0, None, DVec3::X);
        assert_eq!(timeless.folds, Vec4::ZERO);
        assert!(timeless.pole.dot(timeless.noon).abs() < 1e-6);
    }
}
