//! One picture of a reference: rays, and how finely each looks at the maps.

use super::geometry::{Rays, ScaledRay, half_chord};
use super::light::smooth_step;
use super::path::Path;
use super::relief::{relief_distance_m, slope};
use super::shading::{AirFactors, CloudFactors, GroundShader};
use super::shading_point::ShadingPoint;
use glam::DVec3;
use std::f64::consts::PI;
use terrella::frames::Ellipsoid;
use terrella::{EyeView, Sky};
use terrella_ground::elevation::Elevation;

/// Most taps along each side of a ray's part of the pixel.
pub const MAX_TAPS: u32 = 512;

/// Taps for each texel that a ray's part of the pixel is long: at one, a map of stripes of a texel would beat with them.
const TAPS_PER_TEXEL: f64 = 2.0;

/// Height of the air, metres. Clouds above the edge of the ground are seen from outside it.
const AIR_M: f64 = 100_000.0;

/// Lower bound of the texel width, as cosine of the latitude (84°): at the pole itself all columns of a map meet, and none of them has a meaning.
const MIN_COS_LATITUDE: f64 = 0.1;

/// The rays of one image, and their targets.
pub(super) struct RayCaster<'r> {
    ground: &'r GroundShader,
    relief: Option<&'r dyn Elevation>,
    exposure: f64,
    rays: Rays,
    figure: Ellipsoid,
    /// Its diagonal (a, a, b), metres.
    scale: DVec3,
    /// The eye in scaled space, and the eye for the air: lifted to the ground if it is below.
    eye: DVec3,
    eye_in_air: DVec3,
    /// Height of the clouds over the eye, equatorial radii; `None` if it is above them or there are none.
    clouds_overhead: Option<f64>,
    /// Fraction of the clouds that is seen above the edge of the ground.
    clouds_at_limb: f64,
    sun: DVec3,
    sun_scaled: DVec3,
    /// Texels of the finest map per radian of longitude and of latitude.
    texels_per_rad: (f64, f64),
}

/// Targets of rays.
#[derive(Clone, Copy)]
pub(super) struct CastEarth<'r> {
    pub ground: &'r GroundShader,
    /// Heights, if they are drawn.
    pub relief: Option<&'r dyn Elevation>,
    /// As [`super::ReferenceOptions::exposure`].
    pub exposure: f64,
    pub figure: Ellipsoid,
}

/// Intersection of a ray with the ground.
struct Hit {
    /// Distance in scaled space.
    distance: f64,
    /// Whether it is on terrain.
    is_relief: bool,
}

/// The light of one ray.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RaySample {
    /// Linear light, as bright as it is.
    pub light: DVec3,
    /// Whether it met the ground.
    pub is_ground: bool,
}

/// A part of the picture, pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelPart {
    /// Upper left corner.
    pub x: f64,
    /// Upper left corner.
    pub y: f64,
    pub side: f64,
}

impl<'r> RayCaster<'r> {
    /// `None` if view or sky are not finite: such an image is black.
    pub fn new(earth: &CastEarth<'r>, view: &EyeView, sky: &Sky, size: (u32, u32)) -> Option<Self> {
        let CastEarth {
            ground,
            relief,
            exposure,
            figure,
        } = *earth;
        let scale = figure.itrf_from_scaled();
        let rays = Rays::new(view, size)?;
        let sun_scaled = (sky.sun_itrf / scale).try_normalize()?;
        let eye = rays.eye_m / scale;
        let eye_in_air = match eye.length() {
            0.0 => DVec3::X,
            radius if radius < 1.0 => eye / radius,
            _ => eye,
        };
        let (width, height) = ground.maps.finest();
        Some(Self {
            ground,
            relief,
            exposure,
            rays,
            figure,
            scale,
            eye,
            eye_in_air,
            clouds_overhead: ground
                .cloud_height()
                .filter(|height| eye.length() < 1.0 + height),
            clouds_at_limb: smooth_step(1.0, 1.5, (eye.length() - 1.0) * scale.x / AIR_M),
            sun: sky.sun_itrf,
            sun_scaled,
            texels_per_rad: (f64::from(width) / (2.0 * PI), f64::from(height) / PI),
        })
    }

    /// The light of a part: the air along the ray through its centre, and the mean light of the ground in it, if that ray meets the ground.
    pub fn sample(&self, part: &PixelPart) -> RaySample {
        let half = 0.5 * part.side;
        let direction = self.rays.at(part.x + half, part.y + half);
        let Some(scaled) = (direction / self.scale).try_normalize() else {
            return RaySample::default();
        };
        let line = ScaledRay::new(self.eye, scaled);
        let hit = self.hit(&line, direction);
        let in_air = ScaledRay::new(self.eye_in_air, scaled);
        let mut light = DVec3::ZERO;
        let mut factors = AirFactors {
            sees_clouds: self.clouds_overhead.is_none(),
            ..AirFactors::NONE
        };
        let until = match &hit {
            Some(hit) if hit.is_relief => hit.distance,
            _ => f64::INFINITY,
        };
        if let Some(earth) = self.ground.air()
            && let Some(path) = Path::until(&in_air, earth.air.top, until)
        {
            let sight = earth.air.sight_along(&path, self.sun_scaled);
            // The ground that lights this air: where the ray ends, or else passes nearest.
            let near = match &hit {
                Some(hit) => line.point(hit.distance),
                None => in_air.point(in_air.along.max(0.0)),
            };
            let up = (near / self.scale).normalize();
            let albedo = self.ground.albedo_about(up);
            let added = earth.light(&sight, albedo);
            light = added * self.exposure;
            factors.ground = earth.factors(up.dot(self.sun), &sight.transmittance, albedo);
            factors.clouds = hit
                .as_ref()
                .and_then(|_| self.before_clouds(scaled, added, albedo));
        }
        if let Some(hit) = &hit {
            light += self.ground_light(part, direction, &line, hit, &factors);
        } else if let Some(height) = self.clouds_overhead {
            light = self.behind_clouds(light, height, &in_air, direction);
        } else if self.clouds_at_limb > 0.0 {
            light = self.behind_clouds_at_limb(light, &line, scaled, direction);
        }
        RaySample {
            light,
            is_ground: hit.is_some(),
        }
    }

    /// The sky's light in a direction with the clouds before a part of it.
    fn behind_clouds(&self, sky: DVec3, height: f64, ray: &ScaledRay, direction: DVec3) -> DVec3 {
        let top = 1.0 + height;
        let distance = ray.along + half_chord(top, ray.nearest);
        let up = (ray.point(distance) / self.scale).normalize();
        let albedo = self.ground.albedo_about(up);
        let direction = direction.normalize();
        let Some(cloud) = self.ground.clouds_from_below(up, direction, self.sun) else {
            return sky;
        };
        let mut before = (DVec3::ONE, DVec3::ZERO);
        if let Some(earth) = self.ground.air()
            && let Some(path) = Path::until(ray, earth.air.top, distance)
        {
            let sight = earth.air.sight_along(&path, self.sun_scaled);
            let added = earth.light(&sight, albedo) * self.exposure;
            let factors = earth.factors(up.dot(self.sun), &sight.transmittance, albedo);
            before = (factors.own, added);
        }
        let (left, added) = before;
        added + left * cloud.light * self.exposure + cloud.through * (sky - added)
    }

    /// The sky's light in a direction beside the ground, with the clouds before a part of it that the ray enters from above. Of their tops, fewer and
    /// fewer are above a ray that passes higher.
    fn behind_clouds_at_limb(
        &self,
        sky: DVec3,
        ray: &ScaledRay,
        scaled: DVec3,
        direction: DVec3,
    ) -> DVec3 {
        let Some(top) = self.ground.cloud_height().map(|height| 1.0 + height) else {
            return sky;
        };
        if ray.nearest >= top || ray.along <= 0.0 {
            return sky;
        }
        let distance = ray.along - half_chord(top, ray.nearest);
        let up = (ray.point(distance) / self.scale).normalize();
        let air = self.before_clouds(scaled, DVec3::ZERO, self.ground.albedo_about(up));
        let to_eye = -direction.normalize();
        let Some((light, albedo)) =
            self.ground
                .clouds_from_above(up, to_eye, self.sun, air.as_ref())
        else {
            return sky;
        };
        let square = ray.nearest * ray.nearest;
        let higher = self.clouds_at_limb * (1.0 - smooth_step(1.0, top * top, square));
        sky * (1.0 - higher * albedo) + light * (higher * self.ground.exposure(self.exposure))
    }

    /// Factors of the air on the light of clouds in a direction of scaled space, if the air in front of the ground adds `added` and clouds and
    /// ground have `albedo` all around: as if their layer were the ground. `None` without clouds and below them.
    fn before_clouds(&self, direction: DVec3, added: DVec3, albedo: DVec3) -> Option<CloudFactors> {
        let (above, height) = self.ground.above_clouds()?;
        let line = ScaledRay::new(self.eye_in_air / (1.0 + height), direction);
        let path = Path::new(&line, above.air.top).filter(|path| path.meets_ground)?;
        let sight = above.air.sight_along(&path, self.sun_scaled);
        let up = (path.end() / self.scale).normalize();
        Some(CloudFactors {
            factors: above.factors(up.dot(self.sun), &sight.transmittance, albedo),
            more: above.light(&sight, albedo) - added,
        })
    }

    /// First intersection of a ray with the ground.
    fn hit(&self, line: &ScaledRay, direction: DVec3) -> Option<Hit> {
        let Some(relief) = self.relief else {
            let distance = line.ground()?;
            return Some(Hit {
                distance,
                is_relief: false,
            });
        };
        let direction = direction.normalize();
        let distance_m = relief_distance_m(&self.figure, relief, self.rays.eye_m, direction)?;
        Some(Hit {
            distance: distance_m * (direction / self.scale).length(),
            is_relief: true,
        })
    }

    /// Mean light of the ground in a part. `line` is the ray through its centre, which meets the ground at `hit`.
    ///
    /// The part is divided into equal parts such that the rays through their centres, the taps, are no farther apart on the ground than half a
    /// texel of the finest map, as far as [`MAX_TAPS`] allows. The spacing is that at the part's centre: if the limb crosses the part, it is wider
    /// beyond. Terrain is sampled along the one ray only.
    fn ground_light(
        &self,
        part: &PixelPart,
        direction: DVec3,
        line: &ScaledRay,
        hit: &Hit,
        factors: &AirFactors,
    ) -> DVec3 {
        let point = line.point(hit.distance);
        if hit.is_relief {
            return self.shade(point, direction, factors);
        }
        let (across, down) = self.taps(part, direction, point, hit.distance);
        if across == 1 && down == 1 {
            return self.shade(point, direction, factors);
        }
        let (step_x, step_y) = (part.side / f64::from(across), part.side / f64::from(down));
        let (mut sum, mut count) = (DVec3::ZERO, 0_u32);
        for j in 0..down {
            let y = part.y + step_y * (f64::from(j) + 0.5);
            for i in 0..across {
                let x = part.x + step_x * (f64::from(i) + 0.5);
                let direction = self.rays.at(x, y);
                let line = ScaledRay::new(self.eye, (direction / self.scale).normalize_or_zero());
                if let Some(distance) = line.ground() {
                    sum += self.shade(line.point(distance), direction, factors);
                    count += 1;
                }
            }
        }
        if count == 0 {
            return self.shade(point, direction, factors);
        }
        sum / f64::from(count)
    }

    /// Number of taps across and down.
    fn taps(&self, part: &PixelPart, direction: DVec3, point: DVec3, distance: f64) -> (u32, u32) {
        let up = point / self.scale;
        let length = up.length();
        let up = up / length;
        let across = up.x.hypot(up.y).max(1e-9);
        let east = DVec3::new(-up.y, up.x, 0.0) / across;
        let north = up.cross(east);
        // Metres per unit of the unscaled ray.
        let reach = distance / (direction / self.scale).length();
        let facing = up.dot(direction).min(-1e-6 * direction.length());
        // Both radii of curvature are at most 0.7 % larger.
        let radius = self.scale.z;
        let (per_lon, per_lat) = self.texels_per_rad;
        let count = |step: DVec3| {
            // The neighbour's ray on the tangent plane, for a step of the whole part.
            let moved = (step - direction * (up.dot(step) / facing)) * (reach * part.side);
            let u = moved.dot(east).abs() / (radius * across.max(MIN_COS_LATITUDE)) * per_lon;
            let v = moved.dot(north).abs() / radius * per_lat;
            ((TAPS_PER_TEXEL * u.max(v)).ceil() as u32).clamp(1, MAX_TAPS)
        };
        (count(self.rays.right), count(self.rays.down))
    }

    /// Light of a place in scaled space, the exposure in it.
    fn shade(&self, point: DVec3, direction: DVec3, factors: &AirFactors) -> DVec3 {
        let mut place = ShadingPoint {
            up: (point / self.scale).normalize(),
            to_eye: -direction.normalize(),
            slope: None,
        };
        if let Some(relief) = self.relief {
            let at = self.figure.geodetic_from_itrf(point * self.scale);
            place.up = Ellipsoid::normal(at.lat_rad, at.lon_rad);
            place.slope = Some(slope(&self.figure, relief, &at));
        }
        let light = self.ground.shade(&place, self.sun, factors);
        light * self.ground.exposure(self.exposure)
    }
}
