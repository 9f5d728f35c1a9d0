//! The ring of the halo: its inner and outer edge, and its distance.

use glam::{DMat4, DVec3};
use terrella::frames::Ellipsoid;
use terrella_ground::air::{Billboard, TOP, horizon_square};

fn ring(eye_scaled: DVec3, inside: f64, clip_from_eye: &DMat4) -> Billboard {
    let scale = Ellipsoid::WGS84.itrf_from_scaled();
    Billboard::new(eye_scaled, TOP, inside, clip_from_eye, scale)
}

/// Distance of a ray's line from the centre.
fn passes(billboard: &Billboard, ray: DVec3) -> f64 {
    billboard.eye_distance * ray.truncate().length() / ray.length()
}

#[test]
fn from_outside_the_ring_just_holds_the_air_and_not_the_disc() {
    for eye in [
        DVec3::new(1.016, 0.0, 0.0),
        DVec3::new(1.06, 0.0, 0.0),
        DVec3::new(0.0, -0.9, 0.9),
        DVec3::new(0.0, 0.0, 6.0),
        DVec3::new(0.1, 60.0, 3.0),
        DVec3::new(0.0, 1e5, 3.0),
    ] {
        let billboard = ring(eye, 1e-3, &DMat4::IDENTITY);
        assert!(!billboard.is_inside());
        let l = eye.length();
        assert!((billboard.eye_distance - l).abs() < 1e-12 * l);
        let (sin, cos) = billboard.limb();
        assert!(
            (sin * l - 1.0).abs() < 1e-12 && (sin.hypot(cos) - 1.0).abs() < 1e-9,
            "{eye}"
        );
        // The limb is the circle in the paper's square.
        let square = horizon_square(1.0, l - 1.0).expect("a square");
        assert!((0.5 * square.side / square.l2 * cos / sin - 1.0).abs() < 1e-9);
        let vertices: Vec<_> = billboard.vertices().collect();
        let (inner, outer) = vertices.split_at(vertices.len() / 2);
        for (n, (a, b)) in inner.iter().zip(outer).enumerate() {
            assert!((passes(&billboard, a.ray) - (1.0 - 1e-3)).abs() < 1e-9 * l);
            // The middle of an outer edge touches the air's upper boundary.
            let next = outer[(n + 1) % outer.len()];
            let middle = passes(&billboard, b.ray + next.ray);
            assert!((middle - TOP).abs() < 1e-9 * l, "{eye}: {middle}");
            // It is beyond the point nearest to the centre, where terrain can still be.
            let along = l * a.ray.z / a.ray.length();
            assert!(a.ray.length() > along + 0.15, "{eye}");
        }
        assert_eq!(billboard.triangles() as usize, 2 * inner.len());
        let [a, b, c] = billboard.axes;
        assert!(a.dot(b).abs() + a.dot(c).abs() + b.dot(c).abs() < 1e-14);
        assert!(c.distance(-eye / l) < 1e-14);
    }
}

#[test]
fn of_an_eye_in_the_air_the_ring_is_the_sky() {
    for height in [0.0, 1e-10, 1e-3, 0.015] {
        let billboard = ring(DVec3::new(0.0, 0.0, 1.0 + height), 2e-3, &DMat4::IDENTITY);
        assert!(billboard.is_inside());
        let vertices: Vec<_> = billboard.vertices().collect();
        let zenith = vertices[vertices.len() - 1].ray;
        assert!(
            zenith.z < 0.0 && zenith.truncate().length() < 1e-9,
            "{zenith}"
        );
        // No hole: circles follow each other from below the limb upwards.
        let angles: Vec<_> = vertices
            .iter()
            .map(|v| v.ray.angle_between(DVec3::Z))
            .collect();
        assert!(angles.windows(2).all(|pair| pair[1] >= pair[0] - 1e-9));
        assert!(angles[0] < billboard.limb().0.asin());
        let most = *Billboard::indices().iter().max().expect("indices");
        assert_eq!(usize::from(most) + 1, vertices.len());
    }
}

#[test]
fn every_eye_has_a_ring() {
    let eye_m = DVec3::new(6.5e6, 0.0, 0.0);
    let view = terrella::EyeView::itrf(eye_m, DVec3::NEG_X, DVec3::Z, 0.8, 1.5);
    let (_, clip_from_eye) = view.to_itrf();
    for eye in [
        DVec3::ZERO,
        DVec3::X,
        DVec3::new(0.0, 0.0, 1.0 + 1e-12),
        DVec3::new(0.2, 0.1, 0.0),
        DVec3::new(1.01, 0.0, 0.0),
        DVec3::new(1e6, 0.0, 0.0),
    ] {
        for inside in [0.0, 1e-6, 2e-3, 0.05] {
            let billboard = ring(eye, inside, &clip_from_eye);
            assert!(billboard.eye_distance >= 1.0);
            for vertex in billboard.vertices() {
                assert!(vertex.clip.is_finite() && vertex.ray.is_finite(), "{eye}");
                assert!(vertex.clip.w <= 0.0 || vertex.clip.z <= vertex.clip.w);
            }
        }
    }
}
