//! Ellipsoids of revolution and geodetic coordinates.

use glam::{DVec2, DVec3};

/// An ellipsoid of revolution about the z axis, or a sphere where both radii are equal.
///
/// Horizon and limb mathematics is that of the unit sphere in *scaled space*, (x/a, y/a, z/b):
/// straight lines stay straight and tangents stay tangent, so it is written only once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    /// Equatorial radius a, metres.
    pub equatorial_radius_m: f64,
    /// Polar radius b, metres.
    pub polar_radius_m: f64,
}

/// Geodetic latitude and longitude, radians, and height above the ellipsoid, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Geodetic {
    /// Geodetic latitude, −π/2 … π/2.
    pub lat_rad: f64,
    /// Longitude east of Greenwich, −π … π.
    pub lon_rad: f64,
    /// Height above the ellipsoid along its normal, metres.
    pub height_m: f64,
}

impl Geodetic {
    /// From degrees and metres.
    pub fn from_degrees(lat_deg: f64, lon_deg: f64, height_m: f64) -> Self {
        Self {
            lat_rad: lat_deg.to_radians(),
            lon_rad: lon_deg.to_radians(),
            height_m,
        }
    }
}

impl Ellipsoid {
    /// WGS84: a = 6 378 137 m, 1/f = 298.257 223 563 (NIMA TR8350.2).
    pub const WGS84: Self = Self {
        equatorial_radius_m: 6_378_137.0,
        polar_radius_m: 6_356_752.314_245_179,
    };

    /// The sphere of the 2011 paper, R = 6 378 164 m.
    pub const PAPER_SPHERE: Self = Self {
        equatorial_radius_m: 6_378_164.0,
        polar_radius_m: 6_378_164.0,
    };

    /// The diagonal (1/a, 1/a, 1/b) that takes the ellipsoid to the unit sphere.
    pub fn scaled_from_itrf(&self) -> DVec3 {
        DVec3::new(
            1.0 / self.equatorial_radius_m,
            1.0 / self.equatorial_radius_m,
            1.0 / self.polar_radius_m,
        )
    }

    /// The diagonal (a, a, b), the inverse of [`Self::scaled_from_itrf`].
    pub fn itrf_from_scaled(&self) -> DVec3 {
        DVec3::new(
            self.equatorial_radius_m,
            self.equatorial_radius_m,
            self.polar_radius_m,
        )
    }

    /// First eccentricity squared, e² = (a² − b²)/a², in the form that does not cancel.
    pub fn eccentricity_squared(&self) -> f64 {
        let (a, b) = (self.equatorial_radius_m, self.polar_radius_m);
        (a - b) * (a + b) / (a * a)
    }

    /// Outward unit normal at a geodetic latitude and longitude (it does not depend on the figure).
    pub fn normal(lat_rad: f64, lon_rad: f64) -> DVec3 {
        let (sin_lat, cos_lat) = lat_rad.sin_cos();
        let (sin_lon, cos_lon) = lon_rad.sin_cos();
        DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat)
    }

    /// Position in ITRF metres. Exact to rounding at every latitude, poles included.
    pub fn itrf_from_geodetic(&self, g: Geodetic) -> DVec3 {
        let n = Self::normal(g.lat_rad, g.lon_rad);
        self.surface_point(n) + n * g.height_m
    }

    /// The surface point whose outward unit normal is `n`: D²n / |Dn| with D = diag(a, a, b).
    pub fn surface_point(&self, n: DVec3) -> DVec3 {
        let d = self.itrf_from_scaled();
        let dn = d * n;
        d * dn / dn.length()
    }

    /// Geodetic coordinates of an ITRF position, metres.
    ///
    /// Bowring's iteration for the parametric latitude, with his starting value of 1985, to the last digit: the error is a few roundings of the
    /// coordinates (2e-9 m near the surface) from 100 km off the centre to beyond the planets. On the axis the longitude is 0. Within 43 km of the
    /// centre several normals of the ellipsoid pass through a point. The result is then finite but not unique, and at the centre itself it is the
    /// north pole with height −b.
    pub fn geodetic_from_itrf(&self, p: DVec3) -> Geodetic {
        let (a, b) = (self.equatorial_radius_m, self.polar_radius_m);
        let rho = DVec2::new(p.x, p.y).length();
        let lon_rad = if rho > 0.0 { p.y.atan2(p.x) } else { 0.0 };
        let e2 = self.eccentricity_squared();
        let second_e2 = e2 * (a * a) / (b * b);
        let radius = p.length();
        if radius == 0.0 {
            return Geodetic {
                lat_rad: std::f64::consts::FRAC_PI_2,
                lon_rad: 0.0,
                height_m: -b,
            };
        }
        // Parametric latitude β as (cos β, sin β); start: tan β = (b/a)(z/ρ)(1 + e'² b / r).
        let mut beta = DVec2::new(a * rho, b * p.z * (1.0 + second_e2 * b / radius))
            .normalize_or(DVec2::new(1.0, 0.0));
        let mut phi = beta;
        // Two rounds do near and above the surface, thirty at a tenth of its radius.
        for _ in 0..Self::MAX_ITERATIONS {
            // tan φ = (z + e'² b sin³ β)/(ρ − e² a cos³ β); the denominator is negative only inside the evolute.
            phi = DVec2::new(
                (rho - e2 * a * beta.x * beta.x * beta.x).max(0.0),
                p.z + second_e2 * b * beta.y * beta.y * beta.y,
            )
            .normalize_or(DVec2::new(1.0, 0.0));
            let next = DVec2::new(a * phi.x, b * phi.y).normalize_or(beta);
            let done = next.distance_squared(beta) < f64::EPSILON * f64::EPSILON;
            beta = next;
            if done {
                break;
            }
        }
        // h = ρ cos φ + z sin φ − a √(1 − e² sin² φ): no division, so no trouble at poles or equator.
        Geodetic {
            lat_rad: phi.y.atan2(phi.x),
            lon_rad,
            height_m: rho * phi.x + p.z * phi.y - a * (1.0 - e2 * phi.y * phi.y).sqrt(),
        }
    }

    /// Bound on the iteration of [`Self::geodetic_from_itrf`], reached only close to the centre.
    const MAX_ITERATIONS: usize = 100;
}
