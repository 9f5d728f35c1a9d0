//! The measured part of the Earth's rotation, which cannot be computed in advance: UT1 − UTC and polar motion.

/// The Earth's orientation at an instant, as the IERS publishes it. The default is zero in all.
///
/// Left at zero, points on the ground are up to 420 m (UT1 − UTC below 0.9 s) and 20 m (polar motion, 0.6″) from where they
/// are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Orientation {
    /// UT1 − UTC, seconds.
    pub ut1_minus_utc_s: f64,
    /// The pole's coordinate x, towards 0° E, radians.
    pub x_pole_rad: f64,
    /// The pole's coordinate y, towards 90° W, radians.
    pub y_pole_rad: f64,
}
