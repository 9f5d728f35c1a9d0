//! The outline of the smooth globe's mesh. Facets are inscribed, so an eye near the ground would see the mesh end far below the horizon.
//! Points beyond the limb are lifted onto the cone of tangents. Mesh and ellipsoid then have the same outline, and no visible point moves.

use glam::DVec3;
use terrella_frames::Ellipsoid;

/// Lowest eye height for the outline, metres; a lower eye uses this height. From the ground itself the mesh would be seen edge on.
const LOWEST_EYE_M: f64 = 1.0;

/// The cone of tangents from one eye.
#[derive(Clone, Copy, Debug)]
pub struct TangentCone {
    /// Unit vector from the centre towards the eye, scaled space.
    toward_eye: DVec3,
    /// Cosine and sine of the angle at the centre between the eye and the limb: cos θ = 1/L.
    cos_limb: f64,
    sin_limb: f64,
    scaled_from_itrf: DVec3,
}

impl TangentCone {
    /// The cone of an eye. An eye below the ground uses the point above it.
    pub fn new(eye_itrf_m: DVec3, ellipsoid: &Ellipsoid) -> Self {
        let scaled_from_itrf = ellipsoid.scaled_from_itrf();
        let eye = eye_itrf_m * scaled_from_itrf;
        let lowest = LOWEST_EYE_M / ellipsoid.equatorial_radius_m;
        let height = (eye.length() - 1.0).max(lowest);
        let distance = 1.0 + height;
        Self {
            toward_eye: eye.normalize_or(DVec3::X),
            cos_limb: 1.0 / distance,
            // √(L² − 1)/L without cancellation.
            sin_limb: (height * (distance + 1.0)).sqrt() / distance,
            scaled_from_itrf,
        }
    }

    /// A point of the ellipsoid, ITRF metres, lifted onto the cone if it is beyond the limb.
    pub fn lifted(&self, point_itrf_m: DVec3) -> DVec3 {
        let along = (point_itrf_m * self.scaled_from_itrf).dot(self.toward_eye);
        if along >= self.cos_limb {
            return point_itrf_m;
        }
        // In the plane of centre, eye and point the tangent is x cos θ + y sin θ = 1. No visible facet reaches 60° beyond the limb.
        let across = ((1.0 - along) * (1.0 + along)).max(0.0).sqrt();
        let beyond = along * self.cos_limb + across * self.sin_limb;
        point_itrf_m / beyond.max(0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella_frames::Geodetic;

    #[test]
    fn what_is_in_sight_stays_and_what_is_beyond_is_seen_at_the_limb() {
        let ellipsoid = Ellipsoid::WGS84;
        let itrf = |lat, lon, height_m| {
            ellipsoid.itrf_from_geodetic(Geodetic::from_degrees(lat, lon, height_m))
        };
        for height_m in [1.0, 300.0, 4e5, 3.6e7] {
            let eye = itrf(41.0, 12.0, height_m);
            let cone = TangentCone::new(eye, &ellipsoid);
            let scale = ellipsoid.scaled_from_itrf();
            let (mut kept, mut moved) = (0, 0);
            for k in 0..2000 {
                let turn = 0.7 * f64::from(k);
                let away_deg = 0.02 + 0.05 * f64::from(k);
                let point = itrf(
                    (41.0 + away_deg * turn.cos()).clamp(-89.0, 89.0),
                    12.0 + away_deg * turn.sin(),
                    0.0,
                );
                // p·e < 1: beyond the limb.
                let is_beyond = (point * scale).dot(eye * scale) < 1.0;
                let lifted = cone.lifted(point);
                let ray = ((lifted - eye) * scale).normalize();
                let q = (eye * scale).cross(ray).length();
                let along = (point * scale).dot((eye * scale).normalize());
                let limb = (eye * scale).length().recip().min(1.0).acos();
                if is_beyond && along > (limb + 1.0).cos() {
                    assert!((q - 1.0).abs() < 1e-9, "{height_m} m, {k}: {q}");
                    moved += 1;
                } else if !is_beyond {
                    assert_eq!(lifted, point);
                    kept += 1;
                }
            }
            assert!(
                moved > 100 && (kept > 0 || height_m < 1e3),
                "{kept} {moved}"
            );
        }
    }

    #[test]
    fn every_eye_has_a_cone() {
        let surface = DVec3::new(0.0, 6_378_137.0, 0.0);
        for eye in [
            DVec3::ZERO,
            DVec3::X,
            surface,
            0.3 * surface,
            1e18 * surface,
        ] {
            let cone = TangentCone::new(eye, &Ellipsoid::WGS84);
            for point in [surface, -surface, DVec3::new(6_378_137.0, 0.0, 0.0)] {
                assert!(cone.lifted(point).is_finite(), "{eye} {point}");
            }
        }
    }
}
