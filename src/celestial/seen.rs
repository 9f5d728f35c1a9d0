//! The sky as seen from an eye, and its brightness.

use super::moon::{MoonLaw, earthshine};
use super::projection::{Projection, disc_axes};
use super::stars::StarCatalogue;
use crate::earth::{ItrfView, moonlight};
use crate::gpu::{CelestialUniforms, Disc, StarPoint};
use bytemuck::Zeroable;
use glam::{DMat3, DVec3};
use std::f64::consts::PI;
use terrella_frames::{Ellipsoid, MOON_RADIUS_M, MoonShadow, Observer, illumination};

/// Upper limit of stars' displacement since the catalogue's date, radians: 200 years of the fastest proper motion, and aberration, with a margin.
const MOVED_RAD: f64 = 0.02;

/// The sky as seen from an eye, in ITRF axes.
pub(super) struct Seen {
    observer: Observer,
    pub sun_m: DVec3,
    pub moon_m: DVec3,
    earth_m: DVec3,
    moon_from_itrf: DMat3,
    pub sun_seen: f64,
    pub phase_rad: f64,
}

impl Seen {
    pub fn new(observer: &Observer, view: &ItrfView, ellipsoid: &Ellipsoid) -> Self {
        let (sun_m, moon_m) = (observer.sun_m(), observer.moon_m());
        let eye = view.eye_itrf_m;
        let (_, past_earth) = illumination(eye, eye + sun_m, ellipsoid);
        let past_moon = MoonShadow::new(sun_m, moon_m).sun_left(DVec3::ZERO);
        Self {
            observer: *observer,
            sun_m,
            moon_m,
            earth_m: -eye,
            moon_from_itrf: observer.moon_from_itrf(),
            sun_seen: past_earth * past_moon,
            phase_rad: (sun_m - moon_m).angle_between(-moon_m),
        }
    }

    /// Moonlight at the eye, as a fraction of sunlight at the Earth.
    pub fn moonlight(&self) -> f64 {
        moonlight(self.phase_rad, self.moon_m.length())
    }

    /// Stars in the image that neither Earth nor Moon hides, at a time in Julian years after the catalogue's epoch, with this gain.
    pub fn stars(
        &self,
        (catalogue, years, gain): (&StarCatalogue, f64, f32),
        projection: &Projection<'_>,
        ellipsoid: &Ellipsoid,
        points: &mut Vec<StarPoint>,
    ) {
        let itrf_from_gcrf = self.observer.itrf_from_gcrf();
        let axis = itrf_from_gcrf.transpose() * projection.axis;
        let least = match projection.half_angle_rad + MOVED_RAD {
            angle if angle < PI => angle.cos(),
            _ => -1.0,
        };
        let moon = self.moon_m.normalize_or_zero();
        let moon_sine = MOON_RADIUS_M / self.moon_m.length();
        for star in catalogue.stars() {
            if star.direction.dot(axis) < least {
                continue;
            }
            let seen = itrf_from_gcrf * self.observer.seen(star.direction_at(years));
            if seen.dot(moon) > 0.0 && seen.cross(moon).length() < moon_sine {
                continue;
            }
            let point = projection.point(seen, gain * star.light);
            points.extend(point.filter(|_| !projection.is_behind(ellipsoid, seen)));
        }
    }

    pub fn uniforms(
        &self,
        sun: &Disc,
        moon: &Disc,
        projection: &Projection<'_>,
        ellipsoid: &Ellipsoid,
    ) -> CelestialUniforms {
        let stars = self.observer.itrf_from_gcrf().transpose().as_mat3();
        let law = MoonLaw::at_phase(self.phase_rad);
        let disc_from_itrf = disc_axes(self.moon_m).transpose();
        let moon_from_disc = (self.moon_from_itrf * disc_from_itrf.transpose()).as_mat3();
        let moon_to_earth = self.earth_m - self.moon_m;
        let moon_to_sun = (self.sun_m - self.moon_m).normalize_or_zero();
        let at_earth = (-moon_to_earth).angle_between(self.sun_m - self.earth_m);
        let earth_radius_m = ellipsoid.equatorial_radius_m;
        CelestialUniforms {
            size_px: projection.size.as_vec2(),
            origin_px: projection.origin.as_vec2(),
            stars_x: stars.x_axis,
            stars_y: stars.y_axis,
            stars_z: stars.z_axis,
            sun_seen: self.sun_seen as f32,
            sun: *sun,
            moon: *moon,
            moon_x: moon_from_disc.x_axis,
            moon_y: moon_from_disc.y_axis,
            moon_z: moon_from_disc.z_axis,
            moon_albedo: law.albedo as f32,
            moon_lambert: law.lambert as f32,
            moon_to_sun: (disc_from_itrf * moon_to_sun).as_vec3(),
            earthshine: earthshine(at_earth, earth_radius_m / moon_to_earth.length()) as f32,
            moon_to_earth: (disc_from_itrf * moon_to_earth / MOON_RADIUS_M).as_vec3(),
            earth_radius: (earth_radius_m / MOON_RADIUS_M) as f32,
            ..CelestialUniforms::zeroed()
        }
    }
}
