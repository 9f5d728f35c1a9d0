//! Modified Rodrigues parameters.

use glam::{DQuat, DVec3};

/// The rotation whose modified Rodrigues parameters are σ: for σ_BN it takes components along the body's axes to components
/// along the inertial ones. σ = e·tan(φ/4): w = (1 − σ²)/(1 + σ²), (x, y, z) = 2σ/(1 + σ²) (Schaub & Junkins, 3.152).
/// `None` where σ is not finite.
pub fn rotation_of_mrp(sigma: DVec3) -> Option<DQuat> {
    let square = sigma.length_squared();
    if !square.is_finite() {
        return None;
    }
    let scale = 1.0 / (1.0 + square);
    let vector = 2.0 * scale * sigma;
    Some(DQuat::from_xyzw(vector.x, vector.y, vector.z, (1.0 - square) * scale).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_and_their_shadows_are_the_same_rotation() {
        let t = (std::f64::consts::FRAC_PI_8).tan();
        // A quarter turn about z, σ = tan(22.5°): the body's x axis is the inertial y axis.
        let quarter = rotation_of_mrp(DVec3::Z * t).expect("finite");
        assert!((quarter * DVec3::X - DVec3::Y).length() < 1e-12);
        // The shadow set, −σ/σ², is the same rotation.
        let shadow = rotation_of_mrp(DVec3::Z * (-1.0 / t)).expect("finite");
        assert!(quarter.angle_between(shadow) < 1e-7);
        assert_eq!(rotation_of_mrp(DVec3::NAN), None);
        assert_eq!(rotation_of_mrp(DVec3::splat(1e200)), None);
    }
}
