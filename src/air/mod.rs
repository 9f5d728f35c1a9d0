//! The atmosphere as numbers: density profiles, single and multiple scattering tables, the paper's billboard. No GPU here.

/// How the air is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Atmosphere {
    /// The paper's camera-facing square of side 2√(L1·L2), enlarged for the thickness of the air.
    #[default]
    Billboard,
    /// No air: nothing of it is computed, uploaded or compiled.
    None,
}
