//! The block sphere: which blocks there are, which are seen. No GPU here.

/// Which blocks are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Visibility {
    /// Never loses a block of which anything can be seen.
    #[default]
    Conservative,
    /// The 2011 paper's rule: a block is drawn if (e − v)·n > 0 at one of its four corners. Loses blocks near the ground.
    Paper,
}

/// The figure of the Earth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Figure {
    /// The WGS84 ellipsoid.
    #[default]
    Wgs84,
    /// The paper's sphere, R = 6 378 164 m.
    Sphere,
}
