//! Values of constants that shaders and Rust share.

use glam::DVec3;

/// A constant's value in single precision.
pub(super) enum Value {
    U32(u32),
    F32(f64),
    Vec3(DVec3),
}

impl Value {
    /// The line that declares it.
    pub fn declaration(&self, name: &str) -> String {
        match self {
            // `{:?}` always writes a decimal point or an exponent, and enough digits for an exact round trip.
            Self::U32(value) => format!("const {name}: u32 = {value}u;"),
            Self::F32(value) => format!("const {name}: f32 = {:?};", *value as f32),
            Self::Vec3(value) => {
                let [x, y, z] = value.as_vec3().to_array();
                format!("const {name}: vec3f = vec3f({x:?}, {y:?}, {z:?});")
            }
        }
    }
}
