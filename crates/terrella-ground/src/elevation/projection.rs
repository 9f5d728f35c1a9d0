//! Map projections of the ellipsoid of WGS84: transverse Mercator (UTM), polar stereographic, Lambert's conformal conic, Web Mercator.
//!
//! Sources: Karney, "Transverse Mercator with an accuracy of a few nanometers", J. Geodesy 85 (2011), Krüger's series to the fourth
//! order; Snyder, "Map Projections – A Working Manual", USGS 1395 (1987), formulas 15 and 21; IOGP 373-7-2 for the others. Codes and
//! parameters are those of the EPSG registry.

use std::f64::consts::{FRAC_PI_2, PI};

const EQUATOR_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// A projection to metres of easting and northing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    kind: Kind,
    lon_0_rad: f64,
    false_east_m: f64,
    false_north_m: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Radius of the rectified sphere times the scale, and the origin's northing.
    Transverse {
        radius_m: f64,
        origin: f64,
    },
    /// The cone's constant, the radius at isometric latitude 0, and that of the origin. Constants of ±1 are stereographic.
    Conic {
        constant: f64,
        radius_m: f64,
        origin_m: f64,
    },
    WebMercator,
}

fn eccentricity() -> f64 {
    (FLATTENING * (2.0 - FLATTENING)).sqrt()
}

/// Isometric latitude; infinite at the poles.
fn isometric(lat_rad: f64) -> f64 {
    let (e, sine) = (eccentricity(), lat_rad.sin());
    match lat_rad.abs() >= FRAC_PI_2 - 1e-12 {
        true => f64::INFINITY.copysign(lat_rad),
        false => sine.atanh() - e * (e * sine).atanh(),
    }
}

/// Latitude of an isometric latitude; each iteration gains two digits.
fn latitude_rad(isometric: f64) -> f64 {
    let e = eccentricity();
    let mut sine = isometric.tanh();
    for _ in 0..8 {
        sine = (isometric + e * (e * sine).atanh()).tanh();
    }
    sine.asin()
}

/// Radius of a parallel, in equatorial radii.
fn parallel(lat_rad: f64) -> f64 {
    let e_sine = eccentricity() * lat_rad.sin();
    lat_rad.cos() / (1.0 - e_sine * e_sine).sqrt()
}

/// Krüger's coefficients, to rectified latitudes and back.
fn series() -> ([f64; 4], [f64; 4]) {
    let n = FLATTENING / (2.0 - FLATTENING);
    let (n2, n3, n4) = (n * n, n * n * n, n * n * n * n);
    let there = [
        n / 2.0 - 2.0 / 3.0 * n2 + 5.0 / 16.0 * n3 + 41.0 / 180.0 * n4,
        13.0 / 48.0 * n2 - 3.0 / 5.0 * n3 + 557.0 / 1440.0 * n4,
        61.0 / 240.0 * n3 - 103.0 / 140.0 * n4,
        49_561.0 / 161_280.0 * n4,
    ];
    let back = [
        n / 2.0 - 2.0 / 3.0 * n2 + 37.0 / 96.0 * n3 - n4 / 360.0,
        n2 / 48.0 + n3 / 15.0 - 437.0 / 1440.0 * n4,
        17.0 / 480.0 * n3 - 37.0 / 840.0 * n4,
        4397.0 / 161_280.0 * n4,
    ];
    (there, back)
}

/// Sums of a series: sine times hyperbolic cosine, and cosine times hyperbolic sine.
fn sums(coefficients: [f64; 4], xi: f64, eta: f64) -> (f64, f64) {
    let mut sums = (0.0, 0.0);
    for (coefficient, j) in coefficients.into_iter().zip([2.0, 4.0, 6.0, 8.0]) {
        sums.0 += coefficient * (j * xi).sin() * (j * eta).cosh();
        sums.1 += coefficient * (j * xi).cos() * (j * eta).sinh();
    }
    sums
}

/// Northing and easting on the rectified sphere.
fn transverse(lat_rad: f64, lon_rad: f64) -> (f64, f64) {
    let tangent = isometric(lat_rad).sinh();
    let (xi, eta) = match tangent.is_finite() {
        true => (
            tangent.atan2(lon_rad.cos()),
            (lon_rad.sin() / tangent.hypot(lon_rad.cos())).asinh(),
        ),
        false => (lat_rad, 0.0),
    };
    let more = sums(series().0, xi, eta);
    (xi + more.0, eta + more.1)
}

/// Parameters of a projection, degrees and metres.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parameters {
    /// Latitude of the origin.
    pub lat_0_deg: f64,
    /// Longitude of the origin.
    pub lon_0_deg: f64,
    /// Easting of the origin.
    pub false_east_m: f64,
    /// Northing of the origin.
    pub false_north_m: f64,
}

impl Projection {
    fn of(kind: Kind, parameters: Parameters) -> Self {
        Self {
            kind,
            lon_0_rad: parameters.lon_0_deg.to_radians(),
            false_east_m: parameters.false_east_m,
            false_north_m: parameters.false_north_m,
        }
    }

    /// Transverse Mercator with this scale on its central meridian.
    pub fn transverse_mercator(parameters: Parameters, scale: f64) -> Self {
        let n = FLATTENING / (2.0 - FLATTENING);
        let rectified_m = EQUATOR_M / (1.0 + n) * (1.0 + n * n / 4.0 + n.powi(4) / 64.0);
        let kind = Kind::Transverse {
            radius_m: scale * rectified_m,
            origin: transverse(parameters.lat_0_deg.to_radians(), 0.0).0,
        };
        Self::of(kind, parameters)
    }

    /// Lambert conformal conic with one or two standard parallels, times a scale.
    pub fn lambert(parameters: Parameters, parallels_deg: [f64; 2], scale: f64) -> Self {
        let [one, two] = parallels_deg.map(f64::to_radians);
        let constant = match (one - two).abs() < 1e-10 {
            true => one.sin(),
            false => (parallel(one) / parallel(two)).ln() / (isometric(two) - isometric(one)),
        };
        let radius_m =
            scale * EQUATOR_M * parallel(one) / constant * (constant * isometric(one)).exp();
        let kind = Kind::Conic {
            constant,
            radius_m,
            origin_m: radius_m * (-constant * isometric(parameters.lat_0_deg.to_radians())).exp(),
        };
        Self::of(kind, parameters)
    }

    /// Polar stereographic at the pole given by the sign of this latitude. The scale is true at that latitude; at the
    /// pole itself it is `scale`.
    pub fn polar(parameters: Parameters, true_lat_deg: f64, scale: f64) -> Self {
        let e = eccentricity();
        let sign = 1_f64.copysign(true_lat_deg);
        let lat_rad = true_lat_deg.abs().to_radians();
        let radius_m = scale
            * EQUATOR_M
            * match true_lat_deg.abs() > 90.0 - 1e-9 {
                true => 2.0 / ((1.0 + e).powf(1.0 + e) * (1.0 - e).powf(1.0 - e)).sqrt(),
                false => parallel(lat_rad) * isometric(lat_rad).exp(),
            };
        let kind = Kind::Conic {
            constant: sign,
            radius_m: sign * radius_m,
            origin_m: 0.0,
        };
        Self::of(kind, parameters)
    }

    /// The projection of an EPSG code, for systems in metres within a few metres of WGS84.
    pub fn of_code(code: u16) -> Option<Self> {
        let utm = |zone: u16, is_south: bool| {
            let parameters = Parameters {
                lon_0_deg: 6.0 * f64::from(zone) - 183.0,
                false_east_m: 500_000.0,
                false_north_m: if is_south { 10_000_000.0 } else { 0.0 },
                ..Parameters::default()
            };
            Self::transverse_mercator(parameters, 0.9996)
        };
        let polar = |lat_deg: f64, lon_0_deg: f64| {
            let parameters = Parameters {
                lon_0_deg,
                ..Parameters::default()
            };
            Self::polar(parameters, lat_deg, 1.0)
        };
        let ups = |lat_deg: f64| {
            let parameters = Parameters {
                false_east_m: 2_000_000.0,
                false_north_m: 2_000_000.0,
                ..Parameters::default()
            };
            Self::polar(parameters, lat_deg, 0.994)
        };
        let lambert =
            |parallels_deg: [f64; 2], [lat_0_deg, lon_0_deg]: [f64; 2], [east, north]: [f64; 2]| {
                let parameters = Parameters {
                    lat_0_deg,
                    lon_0_deg,
                    false_east_m: east,
                    false_north_m: north,
                };
                Self::lambert(parameters, parallels_deg, 1.0)
            };
        Some(match code {
            3857 => Self::of(Kind::WebMercator, Parameters::default()),
            // WGS84, ETRS89, NAD83, NAD83(CSRS) in parts, NAD83(2011), GDA94 and GDA2020.
            32_601..=32_660 => utm(code - 32_600, false),
            32_701..=32_760 => utm(code - 32_700, true),
            25_828..=25_838 => utm(code - 25_800, false),
            26_901..=26_923 => utm(code - 26_900, false),
            6328 | 6329 => utm(code - 6269, false),
            6330..=6348 => utm(code - 6329, false),
            28_348..=28_358 => utm(code - 28_300, true),
            7846..=7859 => utm(code - 7800, true),
            3413 => polar(70.0, -45.0),
            3031 => polar(-71.0, 0.0),
            3995 => polar(71.0, 0.0),
            3976 => polar(-70.0, 0.0),
            5041 | 32_661 => ups(90.0),
            5042 | 32_761 => ups(-90.0),
            // Europe, France, Canada.
            3034 => lambert([35.0, 65.0], [52.0, 10.0], [4_000_000.0, 2_800_000.0]),
            2154 => lambert([49.0, 44.0], [46.5, 3.0], [700_000.0, 6_600_000.0]),
            3978 | 3979 => lambert([49.0, 77.0], [49.0, -95.0], [0.0, 0.0]),
            _ => return None,
        })
    }

    /// Easting and northing of a place, metres.
    pub fn forward_m(&self, lat_rad: f64, lon_rad: f64) -> (f64, f64) {
        let turns = (lon_rad - self.lon_0_rad) / (2.0 * PI);
        let lon_rad = 2.0 * PI * (turns - turns.round());
        let (east, north) = match self.kind {
            Kind::Transverse { radius_m, origin } => {
                let (xi, eta) = transverse(lat_rad, lon_rad);
                (radius_m * eta, radius_m * (xi - origin))
            }
            Kind::Conic {
                constant,
                radius_m,
                origin_m,
            } => {
                let of_place_m = radius_m * (-constant * isometric(lat_rad)).exp();
                let (sine, cosine) = (constant * lon_rad).sin_cos();
                (of_place_m * sine, origin_m - of_place_m * cosine)
            }
            Kind::WebMercator => (EQUATOR_M * lon_rad, EQUATOR_M * lat_rad.tan().asinh()),
        };
        (east + self.false_east_m, north + self.false_north_m)
    }

    /// Latitude and longitude of an easting and northing, radians.
    pub fn inverse_rad(&self, east_m: f64, north_m: f64) -> (f64, f64) {
        let (east, north) = (east_m - self.false_east_m, north_m - self.false_north_m);
        let (lat_rad, lon_rad) = match self.kind {
            Kind::Transverse { radius_m, origin } => {
                let (xi, eta) = (north / radius_m + origin, east / radius_m);
                let less = sums(series().1, xi, eta);
                let (xi, eta) = (xi - less.0, eta - less.1);
                let tangent = xi.sin() / eta.sinh().hypot(xi.cos());
                (latitude_rad(tangent.asinh()), eta.sinh().atan2(xi.cos()))
            }
            Kind::Conic {
                constant,
                radius_m,
                origin_m,
            } => {
                let sign = constant.signum();
                let down = origin_m - north;
                let of_place_m = sign * east.hypot(down);
                let isometric = -(of_place_m / radius_m).ln() / constant;
                (
                    latitude_rad(isometric),
                    (sign * east).atan2(sign * down) / constant,
                )
            }
            Kind::WebMercator => ((north / EQUATOR_M).sinh().atan(), east / EQUATOR_M),
        };
        (lat_rad, lon_rad + self.lon_0_rad)
    }

    /// The pole that is a point of the map, as the sign of its latitude, and its position.
    pub(super) fn pole_m(&self) -> Option<(f64, (f64, f64))> {
        match self.kind {
            Kind::Conic { constant, .. } if constant.abs() == 1.0 => {
                Some((constant, (self.false_east_m, self.false_north_m)))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference values of PROJ 9.5.
    #[test]
    fn places_are_those_of_proj() {
        for (code, lat_deg, lon_deg, east_m, north_m) in [
            (32633, 47.5, 13.2, 364437.742, 5262299.945),
            (32633, 0.5, 10.1, -45896.933, 55469.119),
            (32633, 83.9, 17.9, 534390.831, 9317795.753),
            (32760, -45.25, 179.5, 696179.043, 4986236.625),
            (25832, 51.0, 7.0, 359666.704, 5651728.683),
            (6339, 40.0, -123.5, 457320.055, 4427876.924),
            (6330, 52.0, -179.2, 348977.752, 5763323.481),
            (7855, -37.8, 145.0, 323920.551, 5814491.019),
            (3413, 75.0, -30.0, 422879.131, -1578206.404),
            (3413, 61.5, 170.0, -1806782.646, 2580353.035),
            (3031, -75.0, -30.0, -819391.619, 1419227.916),
            (3031, -62.0, 100.0, 3054726.227, -538630.653),
            (3995, 80.0, 15.0, 281900.387, -1052066.566),
            (5041, 85.0, 30.0, 2277728.696, 1518959.788),
            (5042, -85.0, 30.0, 2277728.696, 2481040.212),
            (3034, 48.2, 16.37, 4457153.486, 2411462.559),
            (3034, 38.0, -9.0, 2368722.764, 1497588.751),
            (2154, 48.8566, 2.3522, 652469.023, 6862035.259),
            (2154, 43.3, 5.4, 894829.409, 6247498.204),
            (3978, 60.0, -120.0, -1321312.294, 1467353.031),
            (3857, 45.0, 10.0, 1113194.908, 5621521.486),
        ] {
            let projection = Projection::of_code(code).expect("known");
            let (lat_rad, lon_rad) = (f64::to_radians(lat_deg), f64::to_radians(lon_deg));
            let (east, north) = projection.forward_m(lat_rad, lon_rad);
            assert!(
                (east - east_m).hypot(north - north_m) < 0.002,
                "{code}: {east} {north}"
            );
            let (lat, lon) = projection.inverse_rad(east, north);
            let turn = (lon - lon_rad + PI).rem_euclid(2.0 * PI) - PI;
            assert!(
                (lat - lat_rad).abs() < 1e-10 && turn.abs() < 1e-9,
                "{code}: {lat} {lon}"
            );
        }
        assert_eq!(Projection::of_code(27_700), None);
        let polar = Projection::of_code(3413).expect("known");
        assert_eq!(polar.forward_m(FRAC_PI_2, 1.0), (0.0, 0.0));
        assert_eq!(polar.pole_m(), Some((1.0, (0.0, 0.0))));
    }
}
